//! The values that explain robust estimation, and the cases of all robust estimators.

use crate::scene::{Decimals, Role, Unit};

/// A sum of limited squared distances.
const COST: Unit = Unit::new("px²", 3);

crate::variables! { pub(crate) mod value;
    /// The number of matches that passed the tests of the matching.
    MATCHES: "Matches", "", Unit::count("match");
    /// The number of matches at distinct positions.
    DISTINCT: "", "", Unit::count("match");
    /// The name of the model.
    MODEL: "", "", Unit::WHOLE;
    /// The symbol of its matrix.
    SYMBOL: "", "", Unit::WHOLE;
    /// The number of matches of a sample, which determine the model.
    SAMPLE_SIZE: "", "n", Unit::count("match");
    /// The number of iterations, the current one included.
    ITERATIONS: "Iterations", "k", Unit::count("iteration");
    /// The number of samples of which none determined the model.
    SAMPLES: "", "", Unit::count("sample");
    /// The number of iterations that are needed with the best hypothesis so far.
    NEEDED: "Iterations needed", "N", Unit::count("iteration");
    /// The largest number of iterations.
    MAX_ITERATIONS: "", "", Unit::WHOLE;
    /// The probability with which a sample without outliers is drawn.
    CONFIDENCE: "", "p", Unit { name: "", decimals: Decimals::AtMost(6) };
    /// The same probability in percent.
    CONFIDENCE_PERCENT: "", "", Unit::PERCENT;
    /// The share of inliers of the best hypothesis.
    SHARE: "", "w", Unit::RATIO, Role::Best;
    /// The probability that a sample has no outliers.
    PURITY: "", "w^n", Unit::RATIO;
    /// The name of the distance of a match from the model.
    DISTANCE: "", "", Unit::WHOLE;
    /// The largest distance of an inlier.
    THRESHOLD: "", "", Unit::PX;
    /// The number of inliers of the model of the step.
    INLIERS: "", "", Unit::count("inlier"), Role::Result;
    /// The root-mean-square distance of the inliers of the model of the step.
    RMS: "", "", Unit::SUBPIXEL;
    /// The cost of the model of the step: its squared distances, each at most the squared threshold.
    MODEL_COST: "", "", COST;
    /// The number of inliers of the best model so far.
    BEST_INLIERS: "Inliers of the best", "", Unit::count("inlier"), Role::Best;
    /// The root-mean-square distance of the inliers of the best model so far.
    BEST_RMS: "RMS distance", "", Unit::SUBPIXEL;
    /// The lowest cost so far.
    BEST_COST: "", "", COST;
    /// The number of models through samples of the inliers.
    RESAMPLED: "", "", Unit::count("model");
    /// The number of inliers of each of these samples.
    RESAMPLE_SIZE: "", "", Unit::WHOLE;
    /// The number of inliers that support the model.
    SUPPORT: "", "", Unit::count("inlier");
    /// The number of inliers that would exclude chance.
    NEEDED_SUPPORT: "", "", Unit::count("inlier");
    /// The root-mean-square distance of the inliers from the line that fits them best.
    SPREAD: "", "", Unit::PX;
    /// The smallest such distance with which the model is determined.
    LEAST_SPREAD: "", "", Unit::PX;
    /// The unknown of the linear system.
    UNKNOWN: "", "", Unit::WHOLE;
    /// The number of equations of the linear system.
    EQUATIONS: "Linear system", "", Unit::WHOLE;
}

crate::cases! { pub(crate) over value;
    OPENING: "{matches} passed the ratio test and the cross-check. Some are still wrong, so least squares over all would be wrong too: \
              RANSAC seeks the {model} with the most inliers.",
    BEST_OF: "{best_inliers:bare} of {matches:bare}",
    LINEAR_SYSTEM: "A {unknown} = 0 with {equations}×9 entries",
    TOO_FEW: "{matches:bare} of the needed {sample_size}: too few for this model ({model}).",
    TOO_FEW_POSITIONS: "{distinct:bare} of the needed {sample_size:bare} distinct positions: the {matches} are too few for this model \
                        ({model}), as keypoints with several orientations at one point count once.",
    ADVISE_MATCHES: "A higher ratio limit, a detector with a lower threshold or a simpler model helps.",
    ALL_DEGENERATE: "0 of {samples} of {sample_size} determined this model ({model}): the points lie on a line or at one place. A \
                     simpler model helps.",
    SAMPLE: "Iteration {iterations:bare}: a random sample of {sample_size}.",
    DEGENERATE: "{rejected|The sample determines no model}:",
    SAME_POSITION: "some of its matches share a position.",
    COLLINEAR: "its points lie on a line or at one place.",
    SKIPPED: "It is skipped.",
    HYPOTHESIS: "The {model} through the sample is the hypothesis {symbol}; it is right if all of the sample are inliers.",
    SCORED: "{inliers} of {matches} have a {distance} of at most {threshold}",
    COST: ", MSAC cost {model_cost}",
    FIRST: ": the first hypothesis, so the best so far.",
    MORE_INLIERS: ": better than {best_inliers:bare} so far.",
    NOT_MORE_INLIERS: ": not better than the best, {best_inliers:bare} so far.",
    LOWER_COST: ": lower than {best_cost} so far, so better.",
    NOT_LOWER_COST: ": not below the lowest cost so far, {best_cost}.",
    DISCARDED: "Discarded.",
    LOCAL: "Local optimisation: fitted to its inliers, the model has {inliers} with an RMS distance of {rms}.",
    BEST: "New best hypothesis: with a share of inliers w = {share}, a sample of {sample_size:bare} has no outliers with probability \
           wⁿ = {purity}, so",
    NEEDED_AT_MOST: "the maximum of {needed} is kept.",
    NEEDED: "a sample without outliers is drawn in {needed} with probability {confidence_percent}.",
    RESAMPLED: "Local optimisation of the best hypothesis: {resampled} fitted to {resample_size} of its inliers each, then to their \
                own inliers. The best of all has {inliers} and a cost of {model_cost}.",
    REFIT: "Least squares over all inliers:",
    KEPT: "Least squares over all inliers finds no smaller distances, so the model stays:",
    FITTED: "{inliers:bare} of {matches} are inliers, RMS distance {rms}.",
    DOUBTED: "{rejected|The model is rejected}:",
    ON_LINE: "its {support} lie on a line, with an RMS distance of {spread} from it, and the {model} needs at least {least_spread}. A \
              similarity or a translation is determined by them.",
    BY_CHANCE: "{support:bare} of {distinct}",
    AT_DISTINCT_POSITIONS: "at distinct positions",
    AS_RANDOM: "are inliers, and random matches may have as many (number of false alarms at least 1). At least {needed_support} are \
                needed; more keypoints, better matches or a simpler model help.",
    ENDED: "End of the run after {iterations}:",
}
