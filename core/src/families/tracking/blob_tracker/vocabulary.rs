//! The values and the cases of the blob tracker.

use crate::methods::multi_object::vocabulary::value as shared;
use crate::scene::{Decimals, Role, Unit};

crate::variables! { pub(super) mod value;
    /// The number of groups of tracks that share a blob.
    GROUPS: "Groups", "", Unit::WHOLE;
    /// The number of blobs that have tracks.
    TRACKED_BLOBS: "Tracked blobs", "", Unit::count("blob");
    /// The number of frames over which the velocity is averaged.
    VELOCITY_FRAMES: "Frames of the velocity", "", Unit::count("frame");
    /// The smallest intersection with which a track and a blob correspond, as a share of the smaller box.
    MIN_OVERLAP: "Minimum overlap", "", Unit { name: "%", decimals: Decimals::AtMost(4) };
    /// The number of pairs of a track and a blob with enough overlap.
    CORRESPONDING: "Corresponding pairs", "", Unit::WHOLE;
    /// The identities of the tracks of the group.
    MEMBERS: "Group", "", Unit::WHOLE, Role::Window;
    /// The number of the blob in its frame, from 1.
    BLOB: "Blob", "", Unit::WHOLE, Role::Measured;
    /// The numbers of the blobs into which a track or a group splits.
    BLOBS: "Blobs", "", Unit::WHOLE, Role::Measured;
    /// The intersection of the boxes as a share of the smaller one.
    OVERLAP: "Overlap", "O", Unit::PERCENT;
    /// The predicted centre of the track.
    PREDICTED: "Predicted centre", "", Unit::PX, Role::Predicted;
    /// The centre of the track after its update.
    CENTER: "Centre", "", Unit::PX, Role::Estimate;
    /// The distance of the nearest blob from the predicted centre.
    DISTANCE: "Distance", "", Unit::PX;
    /// The largest distance of the nearest blob.
    MAX_DISTANCE: "Maximum distance", "", Unit::PX;
    /// The dissimilarity of a track and a blob after a split.
    COST: "Cost", "D", Unit::RATIO;
    /// The number of tracks of a split that are not listed.
    OTHER_TRACKS: "Other tracks", "", Unit::WHOLE;
    /// The mean gray level of the pixels.
    GRAY: "Gray level", "", Unit::new("", 1);
    /// The area of the track before the merge.
    AREA_BEFORE: "Before the merge", "", Unit::new("px", 0), Role::Predicted;
    /// The area of a blob after the split.
    AREA_AFTER: "After the split", "", Unit::new("px", 0), Role::Measured;
}

crate::cases! { pub(super) over value, shared;
    OPENING: "{measured|Blobs} are matched with {predicted|predicted tracks} by the overlap of their boxes. One to one is an update; \
              otherwise tracks merge or split.",
    PREDICTED: "Prediction of {tracks} in {tracked_blobs} by the mean displacement of up to {velocity_frames}.",
    KEPT: "Without prediction, the last position of {tracks} is kept.",
    CORRESPONDING: "Overlap of at least {min_overlap} of the smaller box (the minimum overlap): {corresponding} of {pairs}.",
    CROWDED: "Of {crowded}, only the {most_near} nearest blobs are compared.",
    TRACK: "{estimate|Track} {track}",
    GROUP: "{window|The group of tracks} {members}",
    MERGES: "{window|Tracks} {members} share blob {blob}: they merge into a group and keep their identities.",
    SPLITS_OFF: " overlaps blobs {blobs}, so a blob splits off.",
    SPLITS: " splits into blobs {blobs}.",
    BY_APPEARANCE: "Least cost by gray level and area:",
    BY_PLACE: "Least distance to the predicted position:",
    IDENTIFIED: "{estimate|track} {track} is blob {blob} (cost {cost})",
    SEMICOLON: ";",
    OTHER_TRACKS: "; and {other_tracks} more.",
    NEAREST: " overlaps no unmatched blob by {min_overlap} (the minimum overlap). The nearest, blob {blob}, is {distance} away, within \
              the maximum distance of {max_distance}.",
    UPDATED: " is updated with blob {blob}: overlap {overlap} ≥ {min_overlap}. Its centre moves from the predicted {predicted:bare} to \
              {center}.",
    HIDDEN: "One side of the blob is hidden: its visible edges and the size of the track give the box.",
    CONFIRMED: "Confirmed: {hits} reach the minimum number of hits, {min_hits:bare}.",
    MATCHED_AGAIN: "Matched again after {missed}.",
    COASTS: " has no blob and {predicted|coasts}: {missed}",
    DELETED_TENTATIVE: " is {rejected|deleted}: missed while tentative, before {min_hits} (the minimum number of hits).",
    DELETED_OLD: " is {rejected|deleted}: missed for more than {max_age} (the maximum age).",
    BEGUN: "An unmatched blob starts {reference|track} {track}.",
    BOXES: "These detections are boxes, not blobs: where they overlap, tracks merge. The Kalman tracker suits them.",
    LOOK_BEFORE: "track {track}: gray level {gray}, area {area_before}",
    LOOK_AFTER: "blob {blob}: gray level {gray}, area {area_after}",
}
