//! The values and the cases of the correlation filter.

use crate::methods::region::vocabulary::value as region;
use crate::scene::{Role, Unit};

crate::variables! { pub(super) mod value;
    /// The width of the window of the filter.
    WIDTH: "Window", "", Unit::new("px", 0), Role::Window;
    /// The height of the window of the filter.
    HEIGHT: "Height of the window", "", Unit::new("px", 0), Role::Window;
    /// The standard deviation of the gray levels of the window, under the window function.
    DEVIATION: "Standard deviation", "", Unit::FINE;
    /// The smallest standard deviation of a window with texture.
    LEAST_DEVIATION: "Smallest standard deviation", "", Unit::FINE;
    /// The standard deviation of the Gaussian that the filter is to answer with.
    SIGMA: "Sigma", r"\sigma", Unit::new("px", 1);
    /// The number of turned and scaled copies of the first window.
    PERTURBATIONS: "Perturbations", "", Unit::count("perturbation");
    /// The largest rotation of a perturbation.
    ROTATION: "Rotation", "", Unit::DEGREES;
    /// The largest change of scale of a perturbation.
    SCALING: "Change of scale", "", Unit::WHOLE_PERCENT;
    /// The number of displacements with a response.
    DISPLACEMENTS: "Displacements", "", Unit::WHOLE;
    /// The highest response.
    PEAK: "Peak", r"g_{\max}", Unit::RATIO, Role::Best;
    /// The displacement of the peak.
    DISPLACEMENT: "Displacement", r"\mathbf{d}", Unit::PX, Role::Best;
    /// The distance of the peak from the mean of the sidelobes, in their standard deviations.
    PSR: "Peak-to-sidelobe ratio", r"\text{PSR}", Unit::FINE, Role::Measured;
    /// The peak-to-sidelobe ratio below which the object is lost.
    MIN_PSR: "Minimum PSR", "", Unit::FINE;
    /// The mean of the sidelobes: of the response outside 11×11 px around the peak.
    MEAN: "Mean of the sidelobes", r"\mu", Unit::RATIO;
    /// The standard deviation of the sidelobes.
    SPREAD: "Standard deviation of the sidelobes", "s", Unit::new("", 4);
    /// The zero-mean normalised cross-correlation of the region with that of the first frame.
    ZNCC: "ZNCC with the first region", "", Unit::RATIO;
    /// The Bhattacharyya coefficient of the gray levels of the region and those of the object in the first frame.
    OBJECT: "ρ of gray levels, object and surroundings", r"\rho", Unit::RATIO;
    /// The Bhattacharyya coefficient of the gray levels of the region and those around it.
    SURROUNDINGS: "ρ of gray levels, surroundings", r"\rho", Unit::RATIO;
    /// The share of the newest frame in the filter.
    LEARNING_RATE: "Learning rate", r"\eta", Unit::RATIO;
}

crate::cases! { pub(super) over value, region;
    SIZE: "{width:bare}×{height}",
    REFUSED: "the gray levels of its window of {width:bare}×{height} have a standard deviation of {deviation} under the window function, \
              below {least_deviation}, and without texture there is nothing to correlate with.",
    LEARNED: "The {reference|filter H*} is learned from a window of {width:bare}×{height} alone.",
    LEARNED_PERTURBED: "The {reference|filter H*} is learned from a window of {width:bare}×{height} and {perturbations} of it, turned by \
                        up to {rotation} and scaled by up to {scaling} at random, so that a turn between two frames does not lower the \
                        peak.",
    MINIMISES: "It minimises the squared difference of its response from a Gaussian of σ = {sigma} at the object.",
    CUT: "{window|The window of} {width:bare}×{height} around the last position: the logarithm of its gray levels, without their mean and \
          of norm 1, so that brightness and contrast do not matter, and under the Hann window, which fades to its border.",
    RESPONDED: "The product of the spectrum with the filter is transformed back: a response for all {displacements} displacements at once.",
    FOUND: "The highest response, {peak}, lies at a displacement of {displacement}, with parabolas along x and y. A perfect match would \
            give 1.",
    JUDGED: "Peak-to-sidelobe ratio: {psr}, from sidelobes of mean {mean} and standard deviation {spread} outside 11×11 px around the peak",
    LOW_PSR: ", below {min_psr}. The peak does not stand out, as under occlusion or a turn beyond the perturbations: the filter is not \
              updated.",
    HIGH_PSR: ", not below {min_psr}: the peak stands out",
    BUT: ". But the region there",
    ALTHOUGH: ", and the match is accepted, although the region there",
    ACCEPTED: ", and the match is accepted.",
    ZNCC: "has a ZNCC of {zncc} with that of the first frame",
    UNIFORM: "is uniform, or was in the first frame",
    LIKE_SURROUNDINGS: ", and its gray levels are those of its surroundings (Bhattacharyya coefficient {surroundings}) rather than those \
                        of the object ({object}). The filter answers to what is behind the object, so it is not updated.",
    NOT_GONE: ": its gray levels (Bhattacharyya coefficient {object} with the object, {surroundings} with the surroundings) do not tell \
               that the object is gone.",
    UPDATED: "The window at the new position is averaged into numerator and denominator of the filter with η = {learning_rate}, so that it \
              follows changes of appearance.",
    COEFFICIENTS: "{object} and {surroundings}",
    NO_PEAK: ": the peak does not stand out",
    BACKGROUND: ": the region holds its surroundings and not the object of the first frame",
    UNLIKE: "The region has a ZNCC of {zncc} with that of the first frame: the object has turned, changed or is covered, or the filter, \
             which adapts, follows something else. The peak-to-sidelobe ratio cannot tell these apart.",
    FOLLOWED: "The filter knows shape and texture, so colours of the background do not attract it; it has no scale, and a velocity is not \
               predicted.",
    REGAINED: "The overlap was low for a while: by a fast motion, a change of appearance, or a change of size, as the region keeps its \
               own. A template tracker follows a change of size.",
    RESIZED: "The region keeps the size of the first frame, and the object changed its own: this filter has no scale.",
    BESIDE: "The peak lies beside the object: windows that were off by some pixels, or of another pose, were averaged into the filter. \
             Where blur or light changed the appearance, mean shift keeps to the colours.",
    HIDDEN: "The object was hidden in {hidden}. The filter searches around the last position, and a velocity is not predicted.",
    LOST: "Between two frames the object left the window of the filter, turned farther than the perturbations, was hidden for long, or \
           changed faster than the learning rate follows. A larger window reaches farther, and a larger rotation recognises more poses.",
}
