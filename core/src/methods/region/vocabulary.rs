//! The values and cases that all trackers of a region share.

use crate::scene::{Role, Unit};

/// A share or factor with one decimal.
const TENTHS: Unit = Unit::new("", 1);

crate::variables! { pub(crate) mod value;
    /// The name of the estimator.
    ESTIMATOR: "", "", Unit::WHOLE;
    /// The frame.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The number of frames of the run, or of its frames that are scored.
    FRAMES: "", "", Unit::count("frame");
    /// The centre of the region.
    PLACE: "Region", r"\mathbf{y}", Unit::PX, Role::Reference;
    /// The width of a region or window.
    WIDTH: "", "", Unit::PX;
    /// The height of a region or window.
    HEIGHT: "", "", Unit::PX;
    /// The angle by which the region is turned.
    ANGLE: "", "", Unit::DEGREES;
    /// The motion of the centre of the region since the last frame.
    MOTION: "", "", Unit::PX, Role::Estimate;
    /// The number of the restart.
    RESTART: "", "", Unit::WHOLE, Role::Reference;
    /// The number of restarts.
    RESTARTS: "", "", Unit::count("time");
    /// The quantity by which the tracker judges its match.
    SIMILARITY: "Similarity", "", Unit::RATIO, Role::Estimate;
    /// The similarity in the last frame before a loss.
    SIMILARITY_BEFORE: "", "", Unit::RATIO;
    /// The similarity in the frame after a loss.
    SIMILARITY_AFTER: "", "", Unit::RATIO;
    /// The name of the similarity.
    MEASURE: "", "", Unit::WHOLE;
    /// The name of the similarity at the beginning of a sentence.
    MEASURE_LABEL: "", "", Unit::WHOLE;
    /// Something else that has a high similarity.
    LOOKALIKE: "", "", Unit::WHOLE;
    /// The number of frames in a row in which the object was lost.
    LOST_FRAMES: "", "", Unit::count("frame");
    /// The frame in which the region was found again.
    FRAME_AFTER: "", "", Unit::WHOLE;
    /// The distance of the region from that before the loss.
    DISTANCE: "", "", Unit::PX;
    /// The overlap of the bounding box of the region with the true box: intersection over union.
    OVERLAP: "Overlap (IoU)", "", Unit::RATIO, Role::Truth;
    /// The overlap from which on a region follows the object.
    FAIR: "", "", TENTHS;
    /// The distance of the centre of the region from that of the true box.
    CENTER_ERROR: "Centre error", "", Unit::PX, Role::Error;
    /// The area of the region as a multiple of that of the true box.
    TIMES_AS_LARGE: "", "", TENTHS;
    /// The share of the true box that the region covers.
    COVERED: "", "", Unit::WHOLE_PERCENT;
    /// The overlap with the true box, averaged over the frames.
    MEAN_OVERLAP: "", "", Unit::RATIO;
    /// The area under the success curve.
    SUCCESS: "", "", Unit::RATIO;
    /// The largest centre error of a precise region.
    NEAR: "", "", Unit::new("px", 0);
    /// The share of the frames with a precise region.
    PRECISION: "", "", Unit::RATIO;
    /// The number of times at which the overlap fell to 0.
    FAILURES: "", "", Unit::count("failure");
    /// The number of frames in which the tracker reports the object as lost.
    REPORTED: "", "", Unit::count("frame");
    /// The number of frames in which the object was hidden after the region had been on it.
    HIDDEN: "", "", Unit::count("frame");
    /// The first of the last frames in which the object is not wholly visible.
    DISAPPEARING: "", "", Unit::WHOLE;
    /// The first of the last frames in which no part of the object can be seen.
    GONE: "", "", Unit::WHOLE;
    /// The first frame in which the contour was no longer on the object.
    FRAME_OFF: "", "", Unit::WHOLE;
    /// The share of the inside of the contour that is not the object.
    FOREIGN: "", "", Unit::PERCENT;
    /// The mean gray level of that part.
    FOREIGN_LEVEL: "", "", Unit::GRAY;
    /// The mean gray level of the object.
    OBJECT_LEVEL: "", "", Unit::GRAY;
    /// The share of the object outside the contour.
    LEFT_OUT: "", "", Unit::PERCENT;
    /// The colour space of a histogram.
    BINNING: "", "", Unit::WHOLE;
    /// The number of bins with a share.
    FILLED: "", "", Unit::WHOLE;
    /// The number of bins.
    BINS: "", "", Unit::WHOLE;
}

crate::cases! { pub(crate) over value;
    OPENING: "{estimator} learns an object from its region in the first frame, and finds it in at most {frames}.",
    REGION: "{place}, {width:bare}×{height}",
    REGION_TURNED: "{place}, {width:bare}×{height}, turned by {angle}",
    RESTART: "{reference|Restart} {restart}: in frame {frame} the region is the true box, and the object is learnt again.",
    CHOSEN: "{reference|Region} of {width:bare}×{height} around {place} in frame {frame},",
    PLACED: "as placed on the frame.",
    OF_TRUTH: "the box of a true object. Place another region to track something else.",
    IN_MIDDLE: "in the middle of the frame, because no region is placed and no true object is known. Place the region on an object.",
    REFUSED: "{error|The region cannot be tracked}: ",
    RUN_ENDS: "The run ends.",
    WAITING: "Frame {frame}: {error|failure}, as the region and the true box had nothing in common. The tracker restarts from the true \
              box 5 frames later, once the object is wholly visible.",
    LOST: "In frame {frame} the object is {error|lost}",
    STAYS: " ({measure} {similarity}). The region stays at {place}.",
    MOVED: "Frame {frame}: the region moves by {motion} to {place} and measures {width:bare}×{height}",
    TURNED: ", turned by {angle}",
    MEASURED: ". {measure_label} {similarity}.",
    REGAINED: "After a loss of {lost_frames} the region is found again",
    REGAINED_UNREPORTED: "After a loss of {lost_frames} that is not reported the region is found again",
    WAS_REGAINED: "In frame {frame_after}, after a loss of {lost_frames}, the region was found again",
    WAS_REGAINED_UNREPORTED: "In frame {frame_after}, after a loss of {lost_frames} that is not reported, the region was found again",
    AFTER_LOSS: "{distance} from its position before the loss, with a {measure} of {similarity_after} against {similarity_before} then.",
    DOUBTFUL: "But {lookalike} has a high {measure} too, so this may be another object.",
    ON_ANOTHER: "Its overlap with the true box there is 0, so another object or the background was found.",
    OVERLAP: "Overlap with the true box (IoU) {overlap}",
    NO_OVERLAP: ":",
    BELOW_FAIR: ", below {fair}:",
    NOT_ON: "the region is not on the object",
    TOO_LARGE: "the region is {times_as_large} times as large as the true box",
    COVERS: "the region covers {covered} of the true box",
    CENTER_ERROR: ". Centre error {center_error}.",
    FRAME_HIDDEN: "By the ground truth the object is wholly hidden, so this frame is not scored.",
    FRAME_ABSENT: "By the ground truth the object is not in the picture, so this frame is not scored.",
    UNSCORED: "End of the run: the object is reported as lost in {reported:bare} of {frames}.",
    SCORED: "End of the run over {frames}: mean overlap {mean_overlap}, success (AUC) {success}, precision at {near} {precision}, \
             {failures}",
    NO_LOSS: ", no loss reported.",
    LOSSES: ", a loss reported in {reported}.",
    LAST: "In the last frame",
    LAST_LOST: "In the last frame it is {error|lost}",
    RESTARTED_ONCE: "The tracker was restarted once.",
    RESTARTED: "The tracker was restarted {restarts}.",
    CONTOUR_SHRANK: "The contour shrank into the object in frame {frame_off}: {left_out} of the object lies outside.",
    CONTOUR_LEFT: "The contour left the object in frame {frame_off}: {foreign} of its inside is not the object, with a mean gray level \
                   of {foreign_level:bare} against {object_level:bare} on the object, and {left_out} of the object lies outside.",
    BY_TRUTH: "By the ground truth the object",
    DISAPPEARS: "disappears from frame {disappearing} on and",
    IS_ABSENT: "is not in the picture",
    IS_HIDDEN: "is wholly hidden",
    UNSEEN: "from frame {gone} on, where no tracker can see it and no frame is scored.",
    UNJUDGED: "Without true boxes, only the pictures show whether the region is on the object: {lookalike} has a high {measure} too.",
    FLAT: "A flat region in one bin stands out only where its surroundings have other bins.",
    END: ".",
}
