//! The values and cases of the KLT tracker.

use crate::methods::features::{level_trace::value as tracking, value as features};
use crate::scene::{Role, Unit};
use crate::{cases, variables};

variables! { pub(super) mod value;
    /// The first frame of the pair.
    FRAME: "", "t", Unit::WHOLE;
    /// The second frame of the pair.
    NEXT_FRAME: "", "t+1", Unit::WHOLE;
    /// The largest number of frames.
    FRAMES: "", "", Unit::count("frame");
    /// The number of features that are tracked at present.
    TRACKED_FEATURES: "Tracked features", "", Unit::count("feature");
    /// The name of the detector.
    DETECTOR: "", "", Unit::WHOLE;
    /// The number of keypoints of the frame.
    KEYPOINTS: "Keypoints", "", Unit::count("keypoint"), Role::Best;
    /// The number of new features.
    NEW: "New features", "", Unit::count("new feature"), Role::Result;
    /// The number of the feature, from 1.
    FEATURE: "Feature", "", Unit::WHOLE, Role::Reference;
    /// The frame in which the feature was detected.
    FIRST_FRAME: "Detected in", "", Unit::WHOLE;
    /// The number of frames through which the feature is tracked.
    TRACK_LENGTH: "", "", Unit::count("frame");
    /// The position after tracking back.
    RETURNED: "", "", Unit::SUBPIXEL, Role::Predicted;
    /// The matrix of the affine map of the first view.
    MATRIX: "", r"\mathbf{A}", Unit::RATIO, Role::Estimate;
    /// The shift of the affine map from the tracked position.
    SHIFT: "", "s", Unit::SUBPIXEL, Role::Estimate;
    /// The length of the shift.
    SHIFT_LENGTH: "", "|s|", Unit::SUBPIXEL;
    /// The gain of the gray values of the first view.
    GAIN: "Gain λ, offset δ", r"\lambda", Unit::RATIO, Role::Estimate;
    /// The offset of the gray values of the first view.
    OFFSET: "", r"\delta", Unit::GRAY, Role::Estimate;
    /// The dissimilarity from the first view: the mean absolute difference after the affine fit.
    DISSIMILARITY: "Dissimilarity", "", Unit::GRAY, Role::Estimate;
    /// The largest accepted dissimilarity.
    MAX_DISSIMILARITY: "", "", Unit::GRAY;
    /// The correlation of the window with the first view.
    CORRELATION: "", r"\rho", Unit::FINE, Role::Estimate;
    /// The correlation at and above which a feature is kept.
    MIN_CORRELATION: "", "", Unit::FINE;
}

cases! { pub(super) over value, features, tracking;
    OPENING: "KLT detects features in frame {frame} and tracks them from frame to frame, through at most {frames}. Checks end tracks \
              that drift or are occluded.",
    ENOUGH: "No new features in frame {frame}: {tracked_features} {be} tracked, and the maximum number of points, {max_points}, is \
             reached.",
    REPLENISH_OFF: "No new features in frame {frame}: replenish is off, so lost features are not replaced.",
    FOUND: "{tracked_features:bare} of at most {max_points} features are tracked. {detector} in frame {frame}: {keypoints}",
    STRONGEST: ", the strongest with response {first_response}.",
    END: ".",
    TAKEN: "{new}, in order of decreasing response, each at least {min_distance} (the minimum distance) from all others. Their first \
            views are stored for the affine check.",
    FEATURE: "{reference|Feature} {feature}",
    FEATURE_AT: "{feature} at {position:bare}",
    FRAME: "frame {first_frame}",
    RETURNED: "Forward–backward check of {reference|feature} {feature}: tracking back ends at {returned:bare}. The forward–backward \
               error of {fb_error} is",
    ABOVE: "above the maximum of {max_fb_error}: {rejected|rejected}.",
    NOT_ABOVE: "not above the maximum of {max_fb_error}: {best|accepted}.",
    NOT_RETURNED: ": tracking back fails, so the forward–backward check is {rejected|not passed}.",
    FITTED: "Affine fit of the first view (frame {first_frame}) of {reference|feature} {feature}: A = {matrix}, shift {shift_length}",
    WITH_LIGHT: ", λ = {gain}, δ = {offset:bare}",
    LIGHT: "λ = {gain}, δ = {offset:bare}",
    DISSIMILARITY: ". Dissimilarity: {dissimilarity}, at most {max_dissimilarity:bare} is accepted.",
    UNEXPLAINED: "No affine map explains the window within the limit (last dissimilarity {dissimilarity}). Correlation with the first \
                  view:",
    RESEMBLES: "ρ = {correlation}, not below {min_correlation}: the feature has deformed, and is kept.",
    DIFFERS: "ρ = {correlation}, below {min_correlation}: it shows something else.",
    NO_CONTRAST: "{estimate|undefined, as the window has no contrast}.",
    IN_FIRST_PAIR: "in its first pair",
    AFTER: "after {track_length}",
    PASSED: " passes all checks: displacement {displacement}, track length {track_length}.",
    END_OF_PAIR: "End of the pair of frames {frame} and {next_frame}:",
}
