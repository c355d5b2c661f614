//! The values that explain a multi-object tracker, and the cases that all trackers share.

use crate::methods::kalman::vocabulary::PROBABILITY;
use crate::scene::{Role, Unit};

crate::variables! { pub(crate) mod value;
    /// The number of the frame.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The number of tracks.
    TRACKS: "Tracks", "", Unit::count("track"), Role::Predicted;
    /// The number of detections of the frame.
    DETECTIONS: "Detections", "", Unit::count("detection"), Role::Measured;
    /// The number of detections with a score below the minimum.
    DISCARDED: "Discarded", "", Unit::WHOLE;
    /// The score below which detections are discarded.
    MIN_SCORE: "Minimum score", "", Unit::FINE;
    /// The identity of the track.
    TRACK: "Track", "", Unit::WHOLE;
    /// The number of the detection in its frame, from 1.
    DETECTION: "Detection", "", Unit::WHOLE, Role::Measured;
    /// The identity of the track from which a detection comes.
    ORIGIN: "Origin", "", Unit::WHOLE;
    /// Whether the track is tentative, confirmed or coasting.
    STATUS: "Status", "", Unit::WHOLE;
    /// The number of frames with a detection of the track.
    HITS: "Hits", "", Unit::count("matched frame");
    /// The hits after which a tentative track is confirmed.
    MIN_HITS: "Minimum number of hits", "", Unit::count("match");
    /// The number of frames in a row without a detection of the track.
    MISSED: "Missed", "", Unit::count("missed frame");
    /// The number of missed frames in a row after which a track is deleted.
    MAX_AGE: "Maximum age", "", Unit::count("frame");
    /// The speed of the track.
    SPEED: "Velocity", r"|\mathbf{v}|", Unit::SPEED;
    /// The direction of the velocity, from right towards down.
    HEADING: "Heading", "", Unit::DEGREES;
    /// The position of the track.
    POSITION: "Position", r"\mathbf{p}", Unit::PX;
    /// The predicted position of the track, before its update.
    POSITION_BEFORE: "Predicted position", "", Unit::PX, Role::Predicted;
    /// The standard deviation of the position, along x and y where they differ.
    DEVIATION: "Standard deviation σ", r"\sigma", Unit::PX;
    /// The standard deviation of the predicted position.
    DEVIATION_BEFORE: "Standard deviation before", "", Unit::PX, Role::Predicted;
    /// The number of pairs of a track and a detection inside the gate.
    GATED: "Gated pairs", "", Unit::count("pair");
    /// The number of pairs of a track and a detection.
    PAIRS: "Pairs", "", Unit::count("pair");
    /// The largest squared Mahalanobis distance of a detection in the gate.
    GATE: "Gating threshold", r"\gamma", Unit::FINE;
    /// The share of the true measurements that are inside the gate.
    GATE_PROBABILITY: "Gate probability", "P_G", PROBABILITY;
    /// The number of tracks with more detections nearby than are compared.
    CROWDED: "Crowded", "", Unit::count("track");
    /// The largest number of detections that are compared with a track.
    MOST_NEAR: "Compared detections", "", Unit::WHOLE;
    /// The number of clusters: sets of tracks that compete for detections.
    CLUSTERS: "Clusters", "", Unit::count("cluster");
    /// The number of tracks of the cluster.
    CLUSTER_TRACKS: "Tracks of the cluster", "", Unit::count("track");
    /// The number of detections of the cluster.
    CLUSTER_DETECTIONS: "Detections of the cluster", "", Unit::count("detection");
    /// The number of detections of tracks that are not listed.
    OTHERS: "Other detections", "", Unit::count("detection");
    /// The number of detections that come from no track.
    CLUTTER: "False alarms", r"\text{FT}", Unit::count("false alarm");
    /// The number of shown rows of a table.
    SHOWN_ROWS: "Shown part of table", "", Unit::WHOLE;
    /// The number of rows of a table.
    ROWS: "Rows", "", Unit::WHOLE;
    /// The number of shown columns of a table.
    SHOWN_COLUMNS: "Shown columns", "", Unit::WHOLE;
    /// The number of columns of a table.
    COLUMNS: "Columns", "", Unit::WHOLE;
    /// The number of confirmed tracks of the frame.
    CONFIRMED: "Confirmed", "", Unit::WHOLE;
    /// The number of coasting tracks of the frame.
    COASTING: "Coasting", "", Unit::WHOLE;
    /// The number of tentative tracks of the frame.
    TENTATIVE: "Tentative", "", Unit::count("tentative track");
    /// The number of tracks that were confirmed in the run.
    RUN_TRACKS: "Tracks of the run", "", Unit::count("confirmed track");
    /// The number of true objects of the frame.
    TRUTHS: "True objects", "", Unit::count("true object");
    /// The number of true objects with a confirmed track at an IoU of at least 0.5.
    MATCHED: "Matched true objects", "", Unit::WHOLE, Role::Truth;
    /// The number of true objects without a track.
    MISSES: "Misses", "", Unit::count("miss"), Role::Error;
    /// The number of confirmed tracks without a true object.
    FALSE_ALARMS: "False alarms", "", Unit::count("false alarm"), Role::Rejected;
    /// The number of misses and false alarms of a frame with the most errors.
    ERRORS: "Errors", "", Unit::count("error");
    /// The number of misses of a frame with the most errors.
    WORST_MISSES: "Misses of the worst frame", "", Unit::count("miss"), Role::Error;
    /// The number of false alarms of a frame with the most errors.
    WORST_FALSE_ALARMS: "False alarms of the worst frame", "", Unit::count("false alarm"), Role::Rejected;
    /// The first frame with the most errors.
    WORST_FRAME: "Worst frame", "", Unit::WHOLE;
    /// The second frame with the most errors.
    SECOND_FRAME: "Second frame", "", Unit::WHOLE;
    /// The number of frames with the most errors.
    WORST_FRAMES: "Worst frames", "", Unit::count("frame");
    /// The multiple object tracking accuracy: 1 − (misses + false alarms + identity switches) / true objects.
    MOTA: "MOTA", r"\text{MOTA}", Unit::RATIO;
    /// The F₁ score of identities.
    IDF1: "IDF1", r"\text{IDF1}", Unit::RATIO;
    /// The number of matches of a true object with another track than before.
    SWITCHES: "Identity switches", "", Unit::count("identity switch");
    /// The MOTA in real time, without hindsight.
    LIVE_MOTA: "MOTA in real time", "", Unit::RATIO;
    /// The IDF1 in real time, without hindsight.
    LIVE_IDF1: "IDF1 in real time", "", Unit::RATIO;
    /// The number of identity switches in real time, without hindsight.
    LIVE_SWITCHES: "Identity switches in real time", "", Unit::count("identity switch");
    /// The share of the boxes of tracks with a true object.
    PRECISION: "Precision", "", Unit::FINE;
    /// The share of the true boxes with a track.
    RECALL: "Recall", "", Unit::FINE;
    /// The number of tracks that the minimum travel has kept tentative.
    STATIONARY: "Stationary", "", Unit::count("tentative track");
    /// The identity of the true object.
    TRUE_OBJECT: "True object", "", Unit::WHOLE, Role::Truth;
    /// The track of the true object before an identity switch.
    TRACK_BEFORE: "Identity switch", "", Unit::WHOLE, Role::Window;
    /// The track of the true object after an identity switch.
    TRACK_NOW: "Track now", "", Unit::WHOLE, Role::Window;
    /// The identity of the selected track.
    SELECTED_TRACK: "Selected track", "", Unit::WHOLE, Role::Estimate;
    /// The status of the selected track in the last finished frame.
    SELECTED_STATUS: "Status of track", "", Unit::WHOLE;
    /// The first frame of the selected track.
    FIRST_FRAME: "Frames", "", Unit::WHOLE;
    /// The last frame of the selected track so far.
    LAST_FRAME: "Last frame", "", Unit::WHOLE;
    /// The number of frames with a detection of the selected track.
    MATCHED_FRAMES: "Matched frames", "", Unit::count("frame");
    /// The number of frames in which the selected track coasted.
    COASTED_FRAMES: "Coasted frames", "", Unit::count("frame");
    /// The length of the path of the selected track.
    PATH_LENGTH: "Path length", "", Unit::PX;
    /// The mean speed of the selected track along its path.
    MEAN_SPEED: "Mean speed", "", Unit::SPEED;
    /// The intersection over union of the last box of the selected track and that of the true object.
    TRUE_OVERLAP: "IoU", "", Unit::RATIO;
}

crate::cases! { pub(crate) over value;
    END: ".",
    COMMA: ",",
    DETECTED: "{detections} in frame {frame}",
    DISCARDED: "; {discarded} more discarded with a score below the minimum of {min_score}",
    NONE_TO_PREDICT: "No tracks to predict yet.",
    GATED: "Gating leaves {gated:bare} of {pairs}.",
    NONE_TO_GATE: "There is no pair of a track and a detection.",
    GATE: "The gate is d² ≤ {gate} (χ², 2 dof, {gate_probability})",
    CROWDED: "Of {crowded}, only the {most_near} nearest detections are compared.",
    SHOWN_PART: "{shown_rows} of {rows} rows, {shown_columns} of {columns} columns",
    VELOCITY: "{speed}, heading {heading} (90° is down)",
    IN_A_ROW: " in a row",
    MAX_AGE: " (maximum age {max_age:bare}).",
    DELETED_TENTATIVE: "{rejected|Track} {track} is deleted: missed while tentative, before {min_hits} (the minimum number of hits).",
    DELETED_OUTSIDE: "{rejected|Track} {track} is deleted: its prediction {position} is far outside the picture.",
    DELETED_OLD: "{rejected|Track} {track} is deleted: missed for more than {max_age} (the maximum age).",
    TENTATIVE_UNTIL: "It is tentative until it has {min_hits}, the minimum number.",
    DETECTION_IS: "detection {detection} is",
    OF_TRACK: "track {origin}",
    OF_NEW_TRACK: "the new track {origin}",
    OF_NO_TRACK: "a false alarm",
    OTHERS: "{others} of other tracks",
    CLUTTER: "{clutter}",
    COUNTS: "Frame {frame}: {confirmed} confirmed, {coasting} coasting, {tentative}.",
    NO_TRUE_OBJECTS: "No true objects in this frame.",
    ALL_MATCHED: "Ground truth (IoU ≥ 0.5): all {truths:bare} true objects are matched.",
    SOME_MATCHED: "Ground truth (IoU ≥ 0.5): {matched} of {truths} matched, {false_alarms}.",
    RUN_TRACKS: "Run: {run_tracks}.",
    RUN: "Run: MOTA {mota}, IDF1 {idf1}, {switches}.",
    RUN_WITH_HINDSIGHT: "Run with hindsight: MOTA {mota}, IDF1 {idf1}, {switches}.",
    RATES: "Precision {precision}, recall {recall}.",
    IN_REAL_TIME: "In real time, without hindsight: MOTA {live_mota}, IDF1 {live_idf1}, {live_switches}.",
    WORST_FRAME: "Frame {worst_frame} has the most errors: {worst_misses}, {worst_false_alarms}.",
    TWO_WORST_FRAMES: "Frames {worst_frame} and {second_frame} have the most errors: {errors} each.",
    WORST_FRAMES: "The most errors in a frame are {errors:bare}, in {worst_frames}, first in frame {worst_frame}.",
    MOST_SWITCHES: "Identities are kept by a motion model that fits (turns need one), and through misses by a larger maximum age.",
    SMALL_GATES: "Too small gates reject detections of their own objects.",
    MISSES_OF_OCCLUDED: "Most errors are misses of occluded objects: there is no track before the first detection, and coasting \
                         tracks do not count as matches.",
    MISSES_INTERPOLATED: "Most errors are misses of occluded objects: there is no track before the first detection, and the boxes of \
                          a coasting track count only where a later match lets them be interpolated.",
    MISSES_OF_VISIBLE: "Most errors are misses of visible objects. The detections are the true boxes with noise, so the tracker loses \
                        them: compare process noise, gate and minimum number of hits.",
    MOST_MISSES: "Most errors are misses: lower the minimum number of hits or the score thresholds, or use another detector.",
    AS_MANY: "There are as many misses as false alarms: boxes may overlap the true ones by less than IoU 0.5.",
    MOST_FALSE_ALARMS: "Most errors are false alarms: raise the minimum number of hits or the score thresholds, or lower the maximum \
                        age.",
    STATIONARY: "{stationary} lasted without confirmation: the net displacement stayed below the minimum travel or half of the path. \
                 With a minimum travel of 0 all tracks that last are confirmed.",
    MATCHED_OF: "{matched} of {truths:bare}",
    SWITCHED: "Identity switch: true object {true_object} was track {track_before} and is track {track_now} now.",
    SWITCH: "object {true_object}: track {track_before} → {track_now}",
    SELECTED: "Selected: {estimate|track} {selected_track}",
    ENDED: "ended in frame {last_frame}",
    IS_TENTATIVE: "is tentative",
    IS_CONFIRMED: "is confirmed",
    COASTS: "coasts",
    SINCE: ". Since frame {first_frame} it was matched in {matched_frames} and coasted in {coasted_frames:bare}.",
    FRAMES: "{first_frame} to {last_frame}",
    PATH: "Its path is {path_length} long, {mean_speed} on average.",
    OVERLAPS_TRUTH: "Its box overlaps {truth|true object} {true_object} (IoU {true_overlap}),",
    TOO_LITTLE: "below 0.5, so they do not match.",
    ENOUGH: "at least 0.5, so they match.",
    BUT_TENTATIVE: "but a tentative track does not count as a match.",
    BUT_COASTING: "but a coasting track does not count as a match.",
    OBJECT_OVERLAP: "{true_object}, IoU {true_overlap}",
}
