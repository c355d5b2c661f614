//! The values that explain the Kalman tracker, and its cases.

use crate::methods::multi_object::vocabulary::value as shared;
use crate::scene::{Role, Unit};

crate::variables! { pub(super) mod value;
    /// The track with the least certain position.
    WIDEST: "Least certain track", "", Unit::WHOLE;
    /// The number of tracks with the largest uncertainty of the position.
    AS_WIDE: "Least certain tracks", "", Unit::count("track");
    /// The squared Mahalanobis distance of the detection from the predicted measurement.
    D_SQUARED: "Squared Mahalanobis distance", "d^2", Unit::FINE, Role::Measured;
    /// The innovation: the detection without the predicted measurement, in px.
    INNOVATION: "Innovation", r"\mathbf{\nu}", Unit::PX, Role::Measured;
    /// The covariance of the innovation, in px².
    INNOVATION_COVARIANCE: "Innovation covariance", r"\mathbf{S}", Unit::FINE, Role::Predicted;
    /// The intersection over union of the predicted box and the detection.
    OVERLAP: "IoU", r"\text{IoU}", Unit::RATIO;
    /// The intersection over union of the last box of the track and the detection.
    LAST_OVERLAP: "IoU of the last box", "", Unit::RATIO;
    /// The smallest intersection over union of a pair.
    IOU_THRESHOLD: "IoU threshold", "", Unit::RATIO;
    /// The score from which on a detection starts tracks.
    SCORE_THRESHOLD: "Score threshold", "", Unit::FINE;
    /// The cost of the pair.
    COST: "Cost", "C", Unit::RATIO, Role::Best;
    /// The number of tracks that are assigned greedily.
    GREEDY: "Greedily assigned", "", Unit::count("track");
    /// The Kalman gain along x.
    GAIN: "Gain", "K", Unit::RATIO;
    /// The predicted position along x.
    X_PREDICTED: "Predicted x", "x^-", Unit::PX, Role::Predicted;
    /// The detected position along x.
    X_DETECTED: "Detected x", "z", Unit::PX, Role::Measured;
    /// The updated position along x.
    X_UPDATED: "Updated x", "x", Unit::PX, Role::Estimate;
    /// The distance of the blob from its start.
    TRAVEL: "Travel", "", Unit::PX;
    /// The travel that confirms a track.
    MIN_TRAVEL: "Minimum travel", "", Unit::PX;
    /// The standard deviation of the velocity of a new track.
    SPEED_DEVIATION: "Standard deviation of the velocity", "", Unit::SPEED;
}

crate::cases! { pub(super) over value, shared;
    OPENING: "Each track has a Kalman filter. In every frame the filters {predicted|predict}, data association assigns the \
              {measured|detections}, and each track is updated with its own.",
    PREDICTED: "Prediction of {tracks}: process noise Q increases each covariance. Track {widest} is the least certain, \
                σ = {deviation}.",
    PREDICTED_ALIKE: "Prediction of {tracks}: process noise Q increases each covariance. {as_wide} are the least certain, with the same \
                      σ = {deviation}.",
    AND_THRESHOLD: ", and the IoU threshold is {iou_threshold}.",
    AND_OVERLAP: ", and boxes have to overlap.",
    THRESHOLD: "The IoU threshold is {iou_threshold}.",
    OVERLAP: "Boxes have to overlap.",
    GREEDY: "The optimal assignment is too large: {greedy} assigned greedily.",
    ASSIGNED: "{predicted|Track} {track} is assigned to {measured|detection} {detection}, cost {cost}.",
    BY_LAST_BOX: "The prediction is outside the gate or the IoU threshold; IoU with the last box {last_overlap}",
    IN_GATE: "d² = {d_squared} ≤ {gate}",
    AND_IOU: ", IoU {overlap}",
    IOU: "IoU {overlap}",
    AT_LEAST: " ≥ {iou_threshold}.",
    ABOVE_ZERO: " > 0.",
    LOW_SCORE: "The detection's score is below the score threshold ({score_threshold}), so it can only continue a track.",
    LEFT_BY_CONFIRMED: "No confirmed track matched the detection.",
    BY_GAIN: "{estimate|Track} {track}: the update with gain K = {gain}",
    HALF_WAY: "{estimate|Track} {track}: the update with gain K = {gain}, half of the way to the detection,",
    BY_BOTH_MODES: "{estimate|Track} {track}: the update of both modes",
    UPDATED: " moves the position from {position_before:bare} to {position}. The standard deviation of the position falls from \
              {deviation_before:bare} to {deviation}; velocity {speed}, heading {heading} (90° is down).",
    HIDDEN: "One side of the blob is hidden: its visible edges and the size of the track give the box.",
    CONFIRMED: "Confirmed: {hits} reach the minimum number of hits, {min_hits:bare}",
    TRAVELLED: ", and the blob has travelled {travel}, at least {min_travel}",
    STILL_TENTATIVE: "Still tentative: it has travelled {travel} from its start and needs {min_travel} (the minimum travel).",
    MATCHED_AGAIN: "Matched again after {missed}.",
    COASTS: "{predicted|Track} {track} is unassigned and coasts: {missed}",
    GROWN: "Without an update the standard deviation of the position grows to {deviation}.",
    BEGUN: "An unassigned detection starts {reference|track} {track} with velocity 0, standard deviation {speed_deviation}.",
}
