//! The values that explain phase correlation, and its cases.

use crate::scene::{Role, Unit};

/// A ratio with one decimal.
const COARSE: Unit = Unit::new("", 1);

crate::variables! { pub(super) mod value;
    /// The name of the frame.
    PICTURE: "", "", Unit::WHOLE;
    /// The mean gray level of the frame.
    MEAN: "", r"\bar{I}", Unit::GRAY;
    /// The name of the spectrum of the frame.
    SPECTRUM: "", "", Unit::WHOLE;
    /// The width of a frame, which is the number of its columns.
    WIDTH: "", "", Unit::WHOLE;
    /// The height of a frame, which is the number of its rows.
    HEIGHT: "", "", Unit::WHOLE;
    /// The number of frequencies.
    FREQUENCIES: "Frequencies", "", Unit::WHOLE;
    /// The number of frequencies that are not left out.
    KEPT: "Kept", "n", Unit::WHOLE;
    /// The smallest ratio of a frequency's cross power to that of rounding with which it is kept.
    MIN_SNR: "", "", COARSE;
    /// The largest ratio of a frequency's cross power to that of rounding.
    HIGHEST_SNR: "", "", COARSE;
    /// The displacement of the highest peak of the phase correlation.
    PEAK: "Highest peak", r"\mathbf{d}", Unit::DISPLACEMENT, Role::Best;
    /// The phase correlation at the highest peak.
    PEAK_HEIGHT: "", "r(d)", Unit::RATIO, Role::Best;
    /// The standard deviation of the phase correlation over all displacements.
    SIGMA: "", r"\sigma_r", Unit::RATIO;
    /// The height of the peak in standard deviations of the phase correlation.
    SIGMAS: "Peak / σ of r", "", COARSE;
    /// The smallest accepted peak in standard deviations: that of random phases in 1 % of all pairs.
    LEAST_SIGMAS: "", "", COARSE;
    /// The displacement of the second-highest peak.
    SECOND: "Second peak", "", Unit::DISPLACEMENT, Role::Rejected;
    /// The phase correlation at the second-highest peak.
    SECOND_HEIGHT: "", "", Unit::RATIO, Role::Rejected;
    /// The ratio of the highest peak to the second.
    RATIO: "Peak ratio", "", Unit::FINE;
    /// The ratio from which on the highest peak is distinct.
    DISTINCT: "", "", Unit::FINE;
    /// Another displacement, which fits better or as well.
    OTHER: "", "", Unit::DISPLACEMENT;
    /// The mean absolute difference of the frames, displaced by the highest peak.
    RESIDUAL: "", "", Unit::GRAY;
    /// The mean absolute difference of the frames, displaced by the other displacement.
    OTHER_RESIDUAL: "", "", Unit::GRAY;
    /// The direction of all gradients, as a unit vector.
    ACROSS: "", "", Unit::FINE;
    /// The period of the pattern across its edges.
    PERIOD: "", "", Unit::new("px", 0);
    /// The axis along which the peak is refined.
    AXIS: "", "", Unit::WHOLE;
    /// The phase correlation one pixel before the peak.
    HEIGHT_BEFORE: "", "", Unit::RATIO;
    /// The phase correlation at the whole displacement of the peak.
    HEIGHT_AT: "", "", Unit::RATIO;
    /// The phase correlation one pixel behind the peak.
    HEIGHT_BEHIND: "", "", Unit::RATIO;
    /// The height of the larger neighbour, without the part that the window adds to both sides.
    SIDE: "", "", Unit::RATIO;
    /// The sub-pixel offset of the peak along an axis.
    OFFSET: "", r"\delta", Unit::SUBPIXEL, Role::Estimate;
    /// The translation so far.
    DISPLACEMENT: "Displacement", r"\mathbf{d}", Unit::SUBPIXEL, Role::Result;
    /// The true displacement in the middle of the picture.
    TRUE_DISPLACEMENT: "True displacement in the middle", "", Unit::SUBPIXEL, Role::Truth;
    /// The mean distance of the translation from the true flow over all pixels.
    ENDPOINT_ERROR: "", "", Unit::SUBPIXEL;
    /// The share of the picture that the translation does not explain.
    UNEXPLAINED: "", "", Unit::PERCENT;
}

crate::cases! { pub(super) over value;
    OPENING: "Phase correlation finds one translation for the whole picture: a displacement only turns the phases of the frequencies, \
              and the inverse transform of the phase difference has its peak at the displacement.",
    SIZE: "{width} × {height}",
    PEAK_AT: "r = {peak_height} at {peak}",
    SECOND_AT: "r = {second_height} at {second}",
    SIGMAS_OF: "{sigmas}, at least {least_sigmas} needed",
    CENTRED: "The mean of {picture}, {mean}, is subtracted.",
    WINDOWED: "The Hann window fades to 0 at the border, because the transform continues it periodically and a jump there would count \
               as an edge at rest.",
    NOT_WINDOWED: "Without a window, the jump from one border to the opposite one counts as an edge at rest and raises the correlation \
                   at zero displacement.",
    ROWS: "The fast Fourier transform of each of the {height} rows of {picture}: each row gives {width} frequencies.",
    COLUMNS: "The transform of each of the {width} columns completes the spectrum {spectrum}. Its magnitude is the strength of a \
              frequency, its phase the position.",
    CROSS: "The cross-power spectrum multiplies each frequency of G₂ by the conjugate of G₁: magnitudes are multiplied, and phases \
            subtracted. A translation makes the phase difference a plane.",
    NORMALISED: "Division by the magnitude leaves only the phase difference, so that every frequency counts alike. {kept} of \
                 {frequencies} frequencies are kept; the others have less than {min_snr} times the cross power of rounding to whole \
                 gray levels.",
    INVERSE_COLUMNS: "The inverse transform of each of the {width} columns.",
    INVERSE_ROWS: "The inverse transform of each of the {height} rows gives the phase correlation r. A pure translation of all pixels \
                   would give 1 at the displacement and 0 elsewhere.",
    PEAK: "The highest peak is r = {peak_height} at displacement {peak}: 1 would mean that all phases agree. The standard deviation of \
           r is 1/√{kept} = {sigma}, so this is {sigmas} standard deviations;",
    ACCEPTED: "random phases reach {least_sigmas} in 1 % of all pairs, so the peak is accepted.",
    REJECTED: "random phases reach {least_sigmas} in 1 % of all pairs, so the peak is rejected and the displacement unknown.",
    NO_PEAK: "No frequency rises above the noise: the strongest has {highest_snr} times the cross power of rounding, and more than \
              {min_snr} times is needed. There is no texture in common, and no peak; the displacement remains unknown.",
    NO_SECOND: "Without a peak beside the highest one there is nothing to compare it with.",
    SECOND: "The second-highest peak is r = {second_height} at {second}.",
    RATIO_BELOW: "The highest is only {ratio} times as high, less than {distinct}:",
    AMBIGUOUS: "the peak is ambiguous",
    POSSIBLE_CAUSES: ", because the motion is no pure translation, or the frames have little in common.",
    RATIO_ABOVE: "The highest is {ratio} times as high, at least {distinct}:",
    NOT_POSITIVE: "It is not above 0, so",
    IS_DISTINCT: "the peak is distinct.",
    CONTRADICTED: "The pictures contradict the highest peak: displaced by it they differ by {residual} on average, displaced by \
                   {other} by {other_residual:bare}. The peak comes from a part of the picture that moves otherwise, such as a border \
                   at rest, or from few phases that agree.",
    APERTURE: "All gradients have the direction {across}: the displacement along the edges is undetermined (aperture problem).",
    PERIODIC: "Across the edges the pattern repeats every {period}, so multiples of it fit as well.",
    REPEATS: "The pattern repeats: the displacement {other} leaves as small a residual, so",
    END: ".",
    NO_NEIGHBOURS: "Along {axis} no neighbours of a peak are known, so there is no sub-pixel offset.",
    NEIGHBOURS: "Along {axis} the peak and its neighbours have the heights {height_before}, {height_at} and {height_behind}.",
    WHOLE: "Sub-pixel refinement is off, so the displacement stays whole.",
    BY_RATIO: "A fraction of a pixel spreads the peak to one side. The share of the higher neighbour in the sum with the peak, without \
               what the window adds to both sides, is the offset, {offset}.",
    BY_PARABOLA: "The parabola through them has its vertex at {offset} from the peak.",
    UNKNOWN: "The translation remains unknown.",
    WITHOUT_TEXTURE: "No frequency is kept, because the strongest has {highest_snr} times the cross power of rounding, and more than \
                      {min_snr} times is needed. Without texture no method finds a displacement.",
    ADVISE_OUTLIERS: "Crop a part at rest, or use global motion, which tells such parts apart as outliers.",
    ADVISE_TEXTURE: "No method finds more in this texture alone; a larger picture with corners or an end of the pattern would tell.",
    INSIGNIFICANT: "The translation remains unknown: the peak is {rejected|rejected}, because {sigmas} standard deviations of r are \
                    less than {least_sigmas}. The phases of most frequencies do not agree: the frames share no translation, as with \
                    rotation, zoom or several motions, or noise covers a smooth texture. Image alignment or matched features need no \
                    common phase.",
    TRANSLATION: "Translation of the whole picture: {displacement}.",
    ERROR: "Mean endpoint error over all pixels: {endpoint_error}.",
    BROAD: "The peak is high but broad, because few frequencies are kept: the pictures have little fine texture.",
    LOW: "A peak of only {peak_height} means that few phases agree: rotation, zoom or several motions need image alignment or matched \
          features.",
    STANDS_OUT: "The peak of {peak_height} stands out,",
    EXPLAINS_PART: "but one translation explains only a part of the picture:",
    EXPLAINS_MOST: "so one translation explains the motion of most of the picture;",
    BY_TRUTH: "by the ground truth {unexplained} of the pixels move otherwise by more than 1 px.",
    BY_PICTURES: "{unexplained} of the 8×8 blocks still differ clearly after the displacement: they move otherwise, are hidden or have \
                  changed.",
    EXPLAINS_ALL: "so one translation explains the motion.",
    TOO_LITTLE_IN_COMMON: "but the frames have too small a part in common to tell how much of the picture it explains.",
}
