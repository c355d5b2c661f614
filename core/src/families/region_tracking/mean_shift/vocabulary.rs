//! The values and cases of mean shift.

use crate::methods::region::vocabulary::value as region;
use crate::scene::{Role, Unit};

crate::variables! { pub(super) mod value;
    /// The largest share of a bin.
    FULLEST: "", "", Unit::RATIO;
    /// The share of the histogram of the object in bins that the surroundings have too.
    SHARED: "", "", Unit::RATIO, Role::Rejected;
    /// The share of these bins in the background-weighted histogram.
    KEPT: "", "", Unit::RATIO, Role::Reference;
    /// The size that is tried.
    SIZE: "Size", "h", Unit::WHOLE;
    /// The number of the shift.
    ITERATION: "Shift", "", Unit::WHOLE;
    /// The number of shifts until the iteration has converged.
    SHIFTS: "", "", Unit::count("shift");
    /// The centre of the ellipse.
    CENTER: "", r"\mathbf{y}", Unit::PX;
    /// The Bhattacharyya coefficient of the histograms of ellipse and model.
    COEFFICIENT: "Bhattacharyya coefficient", r"\rho", Unit::RATIO, Role::Candidate;
    /// The shares of the largest bins of the model.
    MODEL_SHARES: "", "q_u", Unit::RATIO, Role::Reference;
    /// The shares of these bins in the histogram of the ellipse.
    CANDIDATE_SHARES: "", "p_u", Unit::RATIO, Role::Candidate;
    /// The part of the Bhattacharyya coefficient that all other bins have.
    OTHER_BINS: "", "", Unit::RATIO;
    /// The Bhattacharyya coefficient before the last shift.
    COEFFICIENT_BEFORE: "", r"\rho", Unit::RATIO;
    /// The sum of the weights of the pixels of the ellipse.
    WEIGHTS: "Sum of weights", r"\sum_i w_i", Unit::new("", 1);
    /// The weighted mean of the pixels.
    MEAN: "", r"\mathbf{y}", Unit::PX, Role::Best;
    /// The length of the shift.
    SHIFT_LENGTH: "", "", Unit::PX;
    /// The length of a shift below which the iteration has converged.
    EPSILON: "", r"\epsilon", Unit::PX;
    /// The largest number of shifts.
    ITERATIONS: "", "", Unit::count("shift");
    /// The Bhattacharyya coefficient with the present size.
    PRESENT: "ρ, present size", r"\rho", Unit::RATIO;
    /// The Bhattacharyya coefficient with the smaller size.
    SMALLER: "ρ, smaller", r"\rho", Unit::RATIO;
    /// The Bhattacharyya coefficient with the larger size.
    LARGER: "ρ, larger", r"\rho", Unit::RATIO;
    /// The size with the largest Bhattacharyya coefficient.
    BEST_SIZE: "", "", Unit::WHOLE, Role::Best;
    /// The part of the way to the best size that is taken.
    RATE: "", "", Unit::new("", 1);
    /// The Bhattacharyya coefficient below which the object is lost.
    MIN_COEFFICIENT: "", "", Unit::RATIO;
    /// That coefficient as a share of the one in the first frame.
    MIN_SHARE: "", "", Unit::WHOLE_PERCENT;
}

crate::cases! { pub(super) over value, region;
    MODELLED: "The {reference|model q} is the {binning} histogram of the ellipse: {filled} of {bins} bins are filled, the fullest with a \
               share of {fullest}. The Epanechnikov kernel gives pixels near the border little weight, where the background may be seen.",
    WEIGHTED: "The surroundings have colours of the object with a share of {shared} in its histogram. Each such bin is multiplied by the \
               ratio of the smallest share of the surroundings to its own there, so that these colours keep a share of {kept}: a \
               background-weighted histogram of the model alone.",
    WEIGHED: "With the {size}, {candidate|ρ} = {coefficient} at {center}",
    NOT_FALLEN: "; before the last shift it was {coefficient_before}, so it has not fallen.",
    FALLEN: "; before the last shift it was {coefficient_before}, so it has fallen: the weights were linearised there.",
    WEIGHT: "A pixel weighs √(q/p) of its bin: above 1 where its colour is rarer in the ellipse than in the model, 0 where the model lacks \
             its colour.",
    NO_WEIGHT: "All weights are 0: none of the pixels of the ellipse has a colour of the model, so there is no shift.",
    SHIFTED: "The weighted mean of the pixels lies at {mean}: a shift of {shift_length},",
    CONVERGED: "shorter than ε = {epsilon}. Converged after {shifts}.",
    EXHAUSTED: "not shorter than ε = {epsilon}, but the limit of {iterations} is reached.",
    NOT_CONVERGED: "not shorter than ε = {epsilon}, so the ellipse moves there and the weights are computed anew.",
    SIZES: "ρ is {present} with the present size, {smaller} with the smaller and {larger} with the larger one. The best is the {best_size}",
    SAME_SIZE: ", so the size stays {width:bare}×{height}",
    NEW_SIZE: ", and the size moves {rate} of the way to it: {width:bare}×{height}",
    SMALLEST: ", the smallest that is allowed",
    UNIFORM: "All pixels of the ellipse lie in the one bin of the model and have the same weight: nothing distinguishes this position \
              from others on the flat region.",
    LOST_COLOURS: ": none of the pixels of the ellipse has a colour of the model",
    LOW_COEFFICIENT: ": ρ is below {min_coefficient}, {min_share} of that in the first frame",
    FOLLOWED: "The colours of the object led the ellipse. Mean shift follows the colours, not the shape: a background of like colour \
               attracts it, which the background-weighted histogram resists.",
    FOLLOWED_WEIGHTED: "The colours that only the object has led the ellipse; they were learned in the first frame and are not updated.",
    REGAINED: "The ellipse left the object and met it again. Mean shift predicts no velocity, so it finds only what comes back into the \
               ellipse.",
    GROWN: "The ellipse grew over a background with colours of the model.",
    SHRUNK: "The ellipse shrank to a part of the object: its commonest colours alone have the larger ρ. Without an adapted scale the size \
             stays.",
    BESIDE: "The ellipse holds a part of the object only: colours of the background in the model attract it too.",
    REMEDY: "The background-weighted histogram gives them little weight.",
    HIDDEN: "The object was hidden in {hidden}, and mean shift predicts no velocity; a particle filter does.",
    LOST: "The object left the picture or, between two frames, the ellipse, or passed a background of like colour. A particle filter keeps \
           several hypotheses and a velocity, which mean shift has not.",
}
