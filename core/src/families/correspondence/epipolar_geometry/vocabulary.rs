//! The values that explain the epipolar geometry, and its cases.

use crate::methods::geometric::robust::value as shared;
use crate::scene::{Role, Unit};

/// A value of an information criterion.
const CRITERION: Unit = Unit::WHOLE;

crate::variables! { pub(super) mod value;
    /// The epipole of frame t: the image of the other camera's centre.
    EPIPOLE: "", r"\mathbf{e}", Unit::new("px", 1), Role::Best;
    /// The epipole of frame t+1.
    NEXT_EPIPOLE: "", r"\mathbf{e'}", Unit::new("px", 1), Role::Best;
    /// The share of the inliers that a homography explains.
    ON_PLANE: "Explained by a homography", "", Unit::PERCENT, Role::Rejected;
    /// The information criterion GRIC of the homography.
    HOMOGRAPHY_CRITERION: "", "", CRITERION;
    /// The information criterion GRIC of the fundamental matrix.
    FUNDAMENTAL_CRITERION: "", "", CRITERION;
    /// The number of inliers that the homography explains.
    EXPLAINED: "", "", Unit::WHOLE;
    /// The number of inliers that the homography does not explain.
    UNEXPLAINED: "", "", Unit::WHOLE;
    /// The number of matches that are clear outliers of the homography.
    OFF_PLANE: "", "", Unit::WHOLE;
    /// The number of inliers that are clear outliers of the homography.
    OFF_PLANE_INLIERS: "", "", Unit::WHOLE;
    /// The angle by which the camera turned.
    ROTATION: "", r"\alpha", Unit::new("°", 2);
    /// The unit vector along which the camera moved.
    DIRECTION: "", r"\mathbf{t}", Unit::FINE;
    /// The number of inliers in front of both cameras.
    IN_FRONT: "", "", Unit::WHOLE;
    /// The ratio of both singular values of the essential matrix, 1 with the right intrinsics.
    SINGULAR_RATIO: "", "", Unit::FINE;
    /// The smallest such ratio with which the intrinsics are accepted.
    LEAST_RATIO: "", "", Unit::FINE;
    /// The angle that the frame spans across.
    VIEW: "", "", Unit::new("°", 1);
    /// The narrowest field of view of a camera.
    NARROWEST_VIEW: "", "", Unit::DEGREES;
    /// The widest field of view of a camera.
    WIDEST_VIEW: "", "", Unit::DEGREES;
    /// The number of matches without guidance.
    UNGUIDED: "Unguided", "", Unit::count("match"), Role::Reference;
    /// The number of unguided matches that are right.
    UNGUIDED_RIGHT: "", "", Unit::WHOLE;
    /// The number of unguided matches with a known true displacement.
    UNGUIDED_KNOWN: "", "", Unit::WHOLE;
    /// The share of the unguided matches that are right.
    UNGUIDED_PRECISION: "", "", Unit::PERCENT;
    /// The number of guided matches.
    GUIDED: "Guided", "", Unit::count("match"), Role::Result;
    /// The number of guided matches that are right.
    GUIDED_RIGHT: "", "", Unit::WHOLE, Role::Result;
    /// The number of guided matches with a known true displacement.
    GUIDED_KNOWN: "", "", Unit::WHOLE, Role::Result;
    /// The share of the guided matches that are right.
    GUIDED_PRECISION: "", "", Unit::PERCENT;
    /// The number of guided matches without a second candidate.
    WITHOUT_SECOND: "", "", Unit::count("match");
    /// The number of candidates near the epipolar line.
    NEAR: "Candidates near the line", "", Unit::WHOLE, Role::Candidate;
    /// The number of keypoints of frame t+1.
    KEYPOINTS: "", "", Unit::WHOLE;
    /// The width of the rectified pictures.
    WIDTH: "Rectified pictures", "", Unit::new("px", 0);
    /// The height of the rectified pictures.
    HEIGHT: "", "", Unit::new("px", 0);
    /// The mean difference of the rows of corresponding points.
    ROW_ERROR: "Mean difference of rows", "", Unit::PX, Role::Result;
    /// The largest ratio of areas before and after rectification.
    STRETCH: "Largest ratio of areas", "", Unit::new("", 1);
    /// The symbol of the epipole that is near.
    SYMBOL: "", "", Unit::WHOLE;
    /// The name of its frame.
    PICTURE: "", "", Unit::WHOLE;
    /// The distance of the epipole from the frame.
    BESIDE: "", "", Unit::new("px", 0);
    /// The position of the epipole inside the frame.
    EPIPOLE_INSIDE: "Epipole inside", "", Unit::PX, Role::Rejected;
}

crate::cases! { pub(super) over value, shared;
    SEVEN_POINTS: "Each gives one equation; with det F = 0 the 7 degrees of freedom of F are determined up to three solutions.",
    EIGHT_POINTS: "Each gives one linear equation in the 9 entries of F, which is defined up to its scale.",
    DISTANCE: "RMS Sampson distance {best_rms}.",
    PLANAR: "But a homography explains {on_plane} of the inliers, and is the better model by the information criterion GRIC, \
             {homography_criterion} against {fundamental_criterion} of F;",
    NONE_OFF_PLANE: "no match is an outlier of the homography.",
    OFF_PLANE: "clear outliers of the homography: {off_plane}; agreeing with F: {off_plane_inliers}, no more than by chance.",
    ONE_PLANE: "So the scene is a plane, or the camera only rotated. F is not determined by such points; use the global motion with a \
                homography.",
    UNDETERMINED: "So F is not determined by these points. Whether the scene is a plane cannot be told either: {unexplained} of \
                   {best_inliers} do not follow the homography, as with several planes or several motions. Motion segmentation tells \
                   motions apart.",
    DOMINANT_PLANE: "Of the {best_inliers}, {explained} follow a homography, so F rests on the other {unexplained}. \
                     {off_plane_inliers} of these lie clearly off its plane and agree beyond chance: parallax, or an object with a \
                     motion of its own, for which F is wrong.",
    NEARLY_PLANE: "A homography explains {on_plane} of the inliers: most points lie near a plane, so F and its epipoles are poorly \
                   determined, and other random seeds give others.",
    NO_POSE: "With the focal length, the pose of the camera follows from F.",
    NO_POSE_DOUBTED: "With the focal length a pose of the camera would follow from F, as uncertain as F.",
    POSE: "The camera turned by {rotation} and moved along {direction}; {in_front} of the inliers lie in front of both cameras. Ratio \
           of the singular values of the essential matrix: {singular_ratio}.",
    POSE_DOUBTED: "This pose is as uncertain as F.",
    WRONG_VIEW: "The pose is rejected: with this focal length the frame would span {view}, and a camera spans {narrowest_view} to \
                 {widest_view}.",
    WRONG_RATIO: "The pose is rejected: the ratio of the singular values of the essential matrix is {singular_ratio}, and at least \
                  {least_ratio} is needed (1 with the right intrinsics). The focal length does not fit.",
    BEHIND: "The pose is rejected: only {in_front} of the {best_inliers} lie in front of both cameras, and more than half are needed.",
    MOVING_OBJECTS: "Points of moving objects violate F unless they move along their epipolar lines.",
    UNGUIDED: "{unguided}",
    UNGUIDED_OF: "{unguided}, {unguided_right} of {unguided_known} right",
    GUIDED: "{guided}",
    GUIDED_OF: "{guided}, {guided_right} of {guided_known} right",
    GUIDANCE: "Guided matching compares each keypoint only with those within {threshold} of its epipolar line:",
    WITHOUT_GUIDANCE: ". Without guidance there are",
    LESS_ALIKE: ". Fewer candidates look alike, so the ratio test rejects fewer correct matches; keypoints off the line are not \
                 matched at all.",
    LESS_PRECISE: "The share of right ones falls from {unguided_precision} to {guided_precision}: wrong candidates near the line pass \
                   more easily, and {without_second} had no second candidate, and so no ratio test.",
    NEAR_OF: "{near} of {keypoints}",
    SIZE: "{width:bare}×{height}",
    RECTIFIED: "Rectification: both frames are warped so that epipolar lines are horizontal and corresponding ones lie in the same row.",
    NO_ROW_ERROR: "none, as no inlier lies on both pictures",
    ROWS_DIFFER: "The rows of the inliers differ by {row_error} on average",
    NO_ROWS: "No inlier lies on both rectified pictures",
    BUT: ", but",
    AND: ";",
    SEARCH: "; the search for a match is along a row, as in stereo vision.",
    DISTORTED: "the epipole {symbol} lies only {beside} beside {picture}: areas next to it are magnified {stretch} times as much \
                as those far from it, so most of the picture is a sliver. Guided matching needs no rectification; a polar \
                rectification keeps the lengths of epipolar lines.",
    EPIPOLE_INSIDE: "{rejected|Rectification is impossible}: the epipole {symbol} lies inside {picture} at {epipole_inside:bare}. A \
                     homography that sends it to infinity tears the picture. So it is where a camera moves toward the scene, or where \
                     few points determine F. A polar rectification would be needed.",
    MEANINGLESS: "{rejected|Rectification would mean nothing}: the fundamental matrix is not determined where a homography is the better \
                  model.",
    IMPOSSIBLE: "{rejected|Rectification is impossible}: the fundamental matrix does not determine both homographies, or they tear a \
                 picture.",
}
