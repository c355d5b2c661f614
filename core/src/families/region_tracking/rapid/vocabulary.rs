//! The values and cases of RAPiD.

use crate::methods::region::vocabulary::value as region;
use crate::scene::{Role, Unit};
use crate::{cases, variables};

/// A side or a coordinate in the space of the camera.
const METRES: Unit = Unit::new("m", 3);
/// An error or deviation of a translation.
const MM: Unit = Unit::new("mm", 1);
/// An angle of a pose.
const ANGLE: Unit = Unit::new("°", 2);

variables! { pub mod value;
    /// The solid of the model.
    SOLID: "Solid", "", Unit::WHOLE;
    /// The width of the model.
    MODEL_WIDTH: "Width of the model", "", METRES;
    /// The height of the model.
    MODEL_HEIGHT: "Height of the model", "", METRES;
    /// The depth of the model.
    MODEL_DEPTH: "Depth of the model", "", METRES;
    /// The focal length of the camera.
    FOCAL_LENGTH: "Focal length", "f", Unit::PX;
    /// The rotation of the model about its vertical axis.
    TURN: "Turn", "", ANGLE, Role::Estimate;
    /// The tilt of the model towards the camera.
    TILT: "Tilt", "", ANGLE, Role::Estimate;
    /// The rotation of the model about the optical axis.
    ROLL: "Roll", "", ANGLE, Role::Estimate;
    /// The rotation of the model by its three angles.
    ANGLES: "Turn, tilt, roll", "", ANGLE, Role::Estimate;
    /// The place of the model in the coordinates of the camera.
    TRANSLATION: "Translation", r"\mathbf{T}", METRES, Role::Estimate;
    /// The angle of a motion.
    ROTATION: "Rotation", r"|\theta|", ANGLE, Role::Estimate;
    /// The translation of a motion.
    SHIFT: "Shift", r"\Delta", METRES, Role::Estimate;
    /// The number of the iteration in the frame.
    ITERATION: "Iteration", "", Unit::WHOLE;
    /// The number of control points with an edge.
    MATCHED: "Control points with an edge", "", Unit::WHOLE, Role::Measured;
    /// The number of control points.
    CONTROL_POINTS: "Control points", "", Unit::count("control point"), Role::Measured;
    /// The share of the control points with an edge.
    SHARE: "Share", "", Unit::RATIO;
    /// The share below which the object is lost.
    MIN_SHARE: "Smallest share", "", Unit::RATIO;
    /// The search range on both sides of a control point.
    SEARCH_RANGE: "Search range", "", Unit::new("px", 0);
    /// The root mean square distance of the edges from their control points.
    RMS: "Distance of the edges (RMS)", "", Unit::PX, Role::Error;
    /// The median distance of the edges from their control points.
    RESIDUAL: "Distance of the edges (median)", "", Unit::PX, Role::Error;
    /// The median distance above which the object is lost.
    MAX_RESIDUAL: "Largest residual", "", Unit::PX;
    /// The farthest motion of a control point in the iteration.
    MOVED: "Farthest motion", "", Unit::PX;
    /// The motion of a control point below which the iterations end.
    EPSILON: "Stopping criterion", r"\epsilon", Unit::SUBPIXEL;
    /// The standard deviations of the rotation about X, Y and Z.
    ROTATION_SIGMA: "σ of the rotation about X, Y, Z", "", ANGLE;
    /// The standard deviations of the translation along X, Y and Z.
    TRANSLATION_SIGMA: "σ of the translation along X, Y, Z", "", MM;
    /// The standard deviation of the translation along the optical axis.
    DEPTH_SIGMA: "σ along the optical axis", "", MM;
    /// The larger standard deviation of the translation across the optical axis.
    LATERAL_SIGMA: "σ across the optical axis", "", MM;
    /// The state of the rotation about the axis of the cylinder, which no edge shows.
    AXIS: "Rotation about the axis of the cylinder", "", Unit::WHOLE;
    /// The angle between the pose and the true one.
    ROTATION_ERROR: "Error of the rotation", "", ANGLE, Role::Error;
    /// The distance of the pose from the true one.
    TRANSLATION_ERROR: "Error of the translation", "", MM, Role::Error;
    /// That distance as a share of the distance from the camera.
    ERROR_SHARE: "Error by the distance", "", Unit::PERCENT;
    /// The number of frames with a true pose.
    TRUE_POSES: "True poses", "", Unit::count("frame");
    /// The number of these frames with a wrong pose.
    WRONG_POSES: "Wrong poses", "", Unit::WHOLE;
    /// The number of wrong poses that are not reported as lost.
    UNREPORTED: "Wrong poses not reported", "", Unit::WHOLE;
    /// The angle from which on a pose is wrong.
    WRONG_ANGLE: "Angle of a wrong pose", "", ANGLE;
    /// The share of the distance from which on a pose is wrong.
    WRONG_SHARE: "Translation of a wrong pose", "", Unit::PERCENT;
    /// The mean share of the control points with an edge.
    MEAN_SHARE: "Mean share", "", Unit::PERCENT;
    /// The mean of the median distances of the edges.
    MEAN_RESIDUAL: "Mean distance of the edges", "", Unit::PX;
}

cases! { pub over value, region;
    OPENING: "RAPiD is given the shape of an object: its wireframe model fits the region in the first frame at the initial rotation, and follows the \
              edges in at most {frames}.",
    REFUSED: "{matched} of {control_points} of the model have an edge within {search_range}, and they do not determine the 6 parameters of a pose.",
    ANGLES: "{turn}, {tilt}, {roll}",
    MATCHED: "{matched} of {control_points:bare}",
    PLACED: "{reference|The model}, a {solid} of {model_width:bare}×{model_height:bare}×{model_depth}, fills the region at the initial rotation when its \
             centre lies at {translation}. The focal length of {focal_length} relates size and distance: one camera knows only their ratio, the model \
             gives the scale.",
    NO_MOTION: "Constant velocity: after the start or a loss there is no last motion, so the search starts at the last pose.",
    PREDICTED: "Constant velocity: the pose is predicted with the last motion, a rotation by {rotation} and a translation by {shift}. The search range \
                must cover the error of the prediction alone.",
    SEARCHED: "Iteration {iteration}: {matched} of {control_points} have an edge within {search_range} of their projection, at an RMS distance of \
               {rms}.",
    NO_EDGES: "Iteration {iteration}: {matched} of {control_points} have an edge within {search_range} of their projection.",
    UNDETERMINED: "These edges do not determine a pose, so the iterations end.",
    EQUAL: "Least squares over",
    ROBUST: "Weighted least squares over",
    FREE: "6 parameters:",
    HELD: "5 parameters, the rotation about the axis being held:",
    SOLVED: "rotation by {rotation}, translation by {shift}.",
    CONVERGED: "No control point moves by more than ε = {epsilon}: converged.",
    EXHAUSTED: "The maximum number of iterations is reached.",
    MOVED: "The control points move by up to {moved}. A distance along the normal constrains one direction alone (aperture problem); edges of several \
            directions together determine the pose.",
    POSE: "Pose: turn {turn}, tilt {tilt}, translation {translation}. {matched} of {control_points} have an edge.",
    COVARIANCE: "The covariance is the variance of the residuals times the inverse of the normal matrix, for independent errors of the edges: σ is \
                 {depth_sigma} along the optical axis and {lateral_sigma} across it",
    DEPTH: ", since a change of distance moves the edges least.",
    LOST_UNDETERMINED: "The edges do not determine a pose: {error|the object is lost}.",
    LOST_BEHIND: "A corner of the model lies behind the camera: {error|the object is lost}.",
    LOST_EDGES: "Share {share} < {min_share}: {error|the object is lost}.",
    LOST_FIT: "Median distance of the edges {residual} > {max_residual}, so they do not fit one pose: {error|the object is lost}.",
    WHY_UNDETERMINED: ": the edges do not determine its pose",
    WHY_BEHIND: ": a corner of its model lies behind the camera",
    WHY_EDGES: ": too few control points have an edge",
    WHY_FIT: ": the edges do not fit one pose",
    WRONG_POSE: "But the pose differs from the true one by {rotation_error} and {translation_error}, {error_share} of the distance: wrong edges were \
                 matched, which the rectangle around the model does not show.",
    NEVER_WRONG: "In {true_poses} the pose never differs from the true one by more than {wrong_angle} or {wrong_share} of the distance.",
    POSE_FAILURES: "The pose differs from the true one by more than {wrong_angle} or {wrong_share} of the distance in {wrong_poses} of {true_poses:bare} \
                    frames: pose failures,",
    ALL_REPORTED: "all of them reported as lost.",
    SOME_UNREPORTED: "{unreported} of them not reported as lost.",
    BY_EDGES: "Where it is not lost, {mean_share} of the control points have an edge, at a median distance of {mean_residual} (means over the frames). \
               Edges of something else may fit as closely: no true pose is known.",
    FOLLOWED: "The edges of the object stayed within the search range, so each frame determined the pose anew: errors do not add up.",
    UNPREDICTED: "The edges left the search range between two frames, or edges of something else were nearer. Constant velocity predicts the motion, so \
                  that the edges are near their control points.",
    MISPREDICTED: "The prediction missed by more than the search range, or edges of something else were nearer. Robust weights take influence from \
                   single wrong edges; a wrong pose that many of them support is not corrected.",
    LAST_POSE: "The last pose differs from the true one by {rotation_error} and {translation_error}.",
}
