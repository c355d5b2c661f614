//! The values that explain the global motion, and its cases.

use crate::methods::geometric::robust::value as shared;
use crate::scene::{Role, Unit};

crate::variables! { pub(super) mod value;
    /// The number of degrees of freedom of the model.
    FREEDOM: "", "", Unit::WHOLE;
    /// The number of points of the sample that the homography maps beyond the horizon line.
    BEYOND: "", "", Unit::WHOLE;
    /// The mean absolute difference of the frames, registered by H.
    REGISTERED: "", "", Unit::GRAY, Role::Result;
    /// The mean absolute difference of the frames as they are.
    AT_REST: "", "", Unit::GRAY;
    /// The angle of the rotation.
    ROTATION: "", r"\alpha", Unit::new("°", 2);
    /// The factor of the scale.
    SCALE: "", "s", Unit::RATIO;
    /// The translation, of a model without a single one that of the origin.
    TRANSLATION: "", r"\mathbf{t}", Unit::PX;
    /// The mean distance of the model's displacements from the true flow.
    ENDPOINT_ERROR: "", "", Unit::SUBPIXEL;
    /// The share of the inliers on the true foreground.
    FOREGROUND: "", "", Unit::PERCENT;
    /// The share of the picture in the convex hull of the inliers.
    HULL: "", "", Unit::PERCENT;
    /// The centre of frame t.
    CENTRE: "", r"\mathbf{x}", Unit::PX;
    /// The position to which the model maps the centre.
    MAPPED_CENTRE: "", r"\mathbf{x'}", Unit::PX;
}

crate::cases! { pub(super) over value, shared;
    COUNTING: "Each gives two equations, and the {model} has {freedom} degrees of freedom.",
    BEYOND_HORIZON: "the homography through it maps {beyond} of its {sample_size:bare} points beyond the horizon line of the plane, \
                     which a camera cannot see.",
    TRANSLATION: "translation {translation}.",
    RIGID: "rotation {rotation}, translation {translation}.",
    SIMILARITY: "rotation {rotation}, scale {scale}, translation {translation}.",
    WITH_ORIGIN: "{model} with the translation {translation} at the origin.",
    WITHOUT_ORIGIN: "{model} that maps the origin beyond its horizon line.",
    ERROR: "Mean endpoint error {endpoint_error}.",
    ON_FOREGROUND: "By the ground truth, {foreground} of the inliers lie on foreground objects: the consensus is the motion of an \
                    object and not that of the background, as RANSAC follows the majority of the matches.",
    REPLACED: "Fewer than half of the matches agree, because a share of them was replaced by random ones.",
    FEW: "Fewer than half of the matches agree: many are wrong, or parallax and moving objects need local motion.",
    FEW_FOR_MODEL: "Fewer than half of the matches agree: many are wrong, or parallax and moving objects need a model with more \
                    freedom.",
    OUTLIERS: "Outliers are wrong matches, moving objects, or parallax the model cannot explain.",
    SMALL_HULL: "The convex hull of the inliers covers {hull} of the picture: they may lie on a single object, and the model is \
                 extrapolated elsewhere.",
    REGISTERED: "Registered by H, both frames differ by {registered} on average where they overlap, and by {at_rest:bare} as they are.",
    NO_OVERLAP: "Registered by H, the frames do not overlap.",
    HARMFUL: "Registration makes the difference larger, so the model does not hold for the picture as a whole.",
    USELESS: "Registration does not reduce the difference, so the pictures give no evidence for the model.",
    REMAINING: "The remaining difference is noise and motion that the model does not have.",
}
