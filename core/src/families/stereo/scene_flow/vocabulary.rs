//! The values and cases of scene flow.

use crate::methods::stereo::WHOLE_PX;
use crate::scene::{Role, Unit};
use crate::{cases, variables};

/// A length in space, to a millimetre.
const METRES: Unit = Unit::new("m", 3);

variables! { pub(super) mod value;
    /// The focal length of the cameras.
    FOCAL: "Focal length", "f", WHOLE_PX;
    /// The distance of the cameras.
    BASELINE: "Baseline", "B", METRES;
    /// The method that estimates a map, or the ground truth.
    METHOD: "Method", "", Unit::WHOLE;
    /// The share of the pixels with a disparity or a scene flow.
    DENSITY: "Density", "", Unit::PERCENT;
    /// The disparity of the pixel in frame t.
    DISPARITY: "Disparity d", "d", Unit::PX, Role::Best;
    /// The disparity minus that of points at infinity.
    SHIFT: "", "", Unit::PX;
    /// The depth Z = f B / d of the pixel.
    DEPTH: "Depth", "Z", Unit::new("m", 2), Role::Result;
    /// The optical flow of the pixel.
    FLOW: "Flow (u, v)", "(u, v)", Unit::PX, Role::Measured;
    /// The place of the point in frame t + 1.
    TARGET: "Place in frame t + 1", "", Unit::PX;
    /// The disparity in frame t + 1 at the place to which the flow leads.
    NEXT_DISPARITY: "Disparity d′ there", "d'", Unit::PX, Role::Measured;
    /// The distance of the pixel from the principal point along x.
    OFFSET_X: "", "x - c_x", Unit::PX;
    /// The distance of the pixel from the principal point along y.
    OFFSET_Y: "", "y - c_y", Unit::PX;
    /// The position of the point in frame t.
    POSITION: "Position in frame t", r"\mathbf{P}", METRES, Role::Reference;
    /// The position of the point in frame t + 1.
    NEXT_POSITION: "Position in frame t + 1", r"\mathbf{P}'", METRES, Role::Measured;
    /// The scene flow: the displacement of the point in space.
    SCENE_FLOW: "Scene flow", r"\mathbf{V}", METRES, Role::Result;
    /// The standard deviation of the scene flow along the depth.
    SIGMA_Z: "σ along the depth", r"\sigma_V", METRES;
    /// The number of points on which the motion of the cameras is estimated.
    POINTS: "Points", "", Unit::count(""), Role::Error;
    /// The number of points that determine a rigid motion.
    FEWEST_POINTS: "Points needed", "", Unit::count("point"), Role::Error;
    /// The number of samples drawn.
    SAMPLES: "Samples", "", Unit::count("sample");
    /// The number of samples that is enough with the best fit so far.
    NEEDED: "Samples needed", "", Unit::count("sample");
    /// The largest number of samples.
    ALLOWED: "Samples allowed", "", Unit::count("sample");
    /// The angle of the rotation.
    ROTATION: "Rotation", "", Unit::new("°", 3);
    /// The translation of the scene.
    TRANSLATION: "Translation", r"\mathbf{t}", METRES;
    /// The number of points that agree with the motion.
    INLIERS: "Inliers", "", Unit::count("point"), Role::Best;
    /// The largest reprojection error of an inlier.
    THRESHOLD: "Threshold", "", Unit::PX;
    /// The root mean square reprojection error of the inliers.
    RMS: "Reprojection error (RMS)", "", Unit::SUBPIXEL;
    /// The number of points that agree with the best motion so far.
    BEST_INLIERS: "Inliers of the best so far", "", Unit::count("point");
    /// The displacement of the cameras.
    CAMERAS: "Motion of the cameras", "", METRES;
    /// The share of the points that agree with the motion of the cameras.
    AGREEING: "Agreeing points", "", Unit::PERCENT;
    /// The position in frame t + 1 of a point at rest.
    PREDICTION: "Prediction", r"\mathbf{R} \mathbf{P} + \mathbf{t}", METRES, Role::Predicted;
    /// The motion that remains without that of the cameras.
    REMAINDER: "Remaining motion", r"\mathbf{r}", METRES, Role::Error;
    /// The length of the motion that remains without that of the cameras.
    REMAINING: "Remaining motion", r"|\mathbf{r}|", METRES, Role::Error;
    /// The squared Mahalanobis distance of the remaining motion.
    DISTANCE: "Squared Mahalanobis distance", "d^2", Unit::FINE;
    /// The squared Mahalanobis distance beyond which a pixel has a motion of its own.
    GATE: "Gate", "", Unit::FINE;
    /// The side of the square of the opening.
    SIDE: "Side", "", WHOLE_PX;
    /// The number of pixels beyond the gate.
    BEYOND: "Beyond the gate", "", Unit::count("pixel");
    /// The number of pixels that the opening keeps.
    KEPT: "Kept", "", Unit::count("pixel"), Role::Result;
    /// The share of the pixels with a motion of their own.
    MOVING: "Moving", "", Unit::PERCENT;
    /// The median error of the scene flow relative to the depth.
    MEDIAN_ERROR: "Median error", "", Unit::new("%", 2);
    /// The mean error of the scene flow.
    MEAN_ERROR: "Mean error", "", METRES;
    /// The error of the displacement of the camera.
    CAMERA_ERROR: "Error of the camera", "", Unit::new("m", 4);
}

cases! { pub(super) over value, crate::methods::stereo::value;
    NO_DEPTHS: "{error|The clip has no right view, so depths are not known and only the optical flow is estimated. Open a right \
                view, or put measured depths into a folder depth beside the frames.}",
    NOT_CALIBRATED: "{error|The cameras are not calibrated: disparities and flow are known, positions in metres are not. Open \
                     their calibration, or type focal length and baseline.}",
    NO_FOCAL_LENGTH: "{error|Depths are known, but not the focal length that positions need, so only the optical flow is \
                      estimated. Type the calibration, focal length and a baseline: the baseline sets the assumed error of a \
                      depth.}",
    TWO_VIEWS: "Two views give a point its position: with focal length {focal} and baseline {baseline} the depth is Z = f B / d. \
                The optical flow leads to the same point in frame t + 1, where its disparity gives the next position. The \
                difference is the scene flow.",
    DEPTH_SENSOR: "A depth and the focal length, {focal}, give a point its position. The optical flow leads to the same point in \
                   frame t + 1, where the depth gives the next position. The difference is the scene flow. Depths are given as \
                   disparities at a baseline of {baseline}, which sets their assumed error.",
    DISPARITIES: "{method} has a disparity for {density} of the pixels of frame t.",
    TRUTH_UNKNOWN: "{reference|Pixel} {pixel} has none: its true disparity is not known.",
    NOT_SENSED: "{reference|Pixel} {pixel} has none: the sensor measured no depth there.",
    NOT_MATCHED: "{reference|Pixel} {pixel} has none: it is ambiguous, or the right camera does not see it.",
    MATCHED: "{reference|Pixel} {pixel}: d = {disparity}.",
    AT_DEPTH: "{reference|Pixel} {pixel}: d = {disparity}, so its depth is Z = f B / d = {depth}.",
    NEXT_TRUTH: "{method} has the disparity in frame t + 1 of the points at {density} of the pixels of frame t.",
    NEXT_DISPARITIES: "{method} has a disparity for {density} of the pixels of frame t + 1. The flow leads from each point of \
                       frame t to its disparity there.",
    MOVES: "{reference|Pixel} {pixel} moves by (u, v) = {flow} to {target:bare} in frame t + 1 ({method}). Near the principal \
            point a motion along the depth leaves hardly any flow; the change of the disparity measures it.",
    NO_FLOW: "{reference|Pixel} {pixel} has no flow.",
    ENDS: "{error|Without positions there is no scene flow, and the run ends here.}",
    SKIP_DISPARITY: "{reference|Pixel} {pixel} has no disparity in frame t, so it has no scene flow.",
    SKIP_FLOW: "{reference|Pixel} {pixel} has no flow, so it has no scene flow.",
    SKIP_NEXT: "{reference|Pixel} {pixel} has no disparity in frame t + 1, or leaves the picture, so it has no scene flow.",
    BOTH_DISPARITIES: "{reference|Pixel} {pixel}: disparity {disparity} in frame t, {next_disparity} in frame t + 1.",
    WITHOUT_DEPTH: "Without the calibration of the cameras the change of the disparity is all that is known of the motion along \
                    the depth.",
    AT_INFINITY: "The point is at infinity, so it has no position.",
    DISPLACED: "{reference|Pixel} {pixel} is at P = {position} in frame t and at P′ = {next_position} in frame t + 1. Scene flow \
                V = P′ − P = {scene_flow}. Along the depth its standard deviation is {sigma_z}: the error of a depth grows with \
                its square.",
    TOO_FEW_POINTS: "{error|A rigid motion needs} {fewest_points} {error|with known positions in both frames, and the grid has} \
                     {points}{error|. A smaller spacing gives more.}",
    EGO_UNKNOWN: "{error|The motion of the cameras is not determined, so motions of its own are unknown.}",
    NO_MOTION: "Sample {samples:bare}: its three points determine no rigid motion, as they lie on a line or one of them is \
                wrong.",
    SAMPLE: "Sample {samples:bare}: the rigid motion through {reference|three points} turns the scene by {rotation} and shifts \
             it by {translation}. {inliers} agree with it to {threshold}",
    BEST_OF_ALL: ": the best so far. All {allowed} that are allowed are drawn.",
    BEST: ": the best so far, so {needed:bare} samples are enough to draw one without outliers with a probability of 99.9 %.",
    WORSE: ", fewer or with larger errors than the {best_inliers:bare} of the best.",
    REFITTED: "Gauss–Newton steps over all inliers of the best sample: RMS reprojection error {rms}, {inliers:bare} inliers. \
               More points than three average their noise.",
    CONVERGED: "Another round over the inliers does not lower the cost, so the fit has converged.",
    NO_REFIT: "The inliers determine no better fit, so that of the sample is kept.",
    EGO: "The cameras moved by {cameras} and turned by {rotation}; {agreeing} of the points agree.",
    MINORITY: "Less than half of the points agree, so it may be the motion of a large object instead.",
    NOT_JUDGED: "{reference|Pixel} {pixel} has no scene flow, so it is not judged.",
    WITHOUT_EGO: "{reference|Pixel} {pixel}: without the motion of the cameras, a motion of its own cannot be distinguished from \
                  theirs.",
    REMAINS: "{reference|Pixel} {pixel}: the motion of the cameras predicts R P + t = {prediction}. r = P′ − (R P + t) = \
              {remainder} remains. Squared Mahalanobis distance {distance} against a gate of {gate}:",
    AGAINST_MINORITY: "the pixel does not move with the points that determine the motion of the cameras. They are less than half \
                       of all, so either may be at rest.",
    OWN_MOTION: "{result|the pixel has a motion of its own}.",
    AT_REST: "consistent with a point at rest. A motion smaller than its uncertainty would not be detected.",
    NOT_OPENED: "{kept:bare} of {beyond} keep a motion of their own, as the opening has a radius of 0 px.",
    OPENED: "Opening with a {side:bare}×{side:bare} square keeps {kept:bare} of {beyond} with a motion of their own. Groups \
             narrower than the square are mostly errors at depth edges.",
    KNOWN: "{density} of the pixels have a scene flow",
    DOUBTFUL: ". Less than half of the points agree with the motion of the cameras, so it cannot be told which pixels have a \
               motion of their own.",
    SOME_MOVE: "; {moving} have a motion of their own.",
    NONE_MOVES: "; none has a significant motion of its own.",
    STOP: ".",
    ERRORS: "Against the truth: median error {median_error} of the depth. The mean, {mean_error}, is dominated by far points and \
             depth edges.",
    CAMERA_ERROR: "The displacement of the camera is wrong by {camera_error}.",
}
