//! Examples of background subtraction.

use super::{Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "A camera at rest",
        of: &["running-average", "mixture-of-gaussians", "frame-difference"],
        cause: None,
        clip: "traffic",
        settings: &[],
        frame: 0,
        says: "The background stays as it is, so a pixel unlike it belongs to an object.",
        claim: ("mask_f1", Limit::AtLeast(0.8)),
        instead: None,
    },
    Example {
        id: "camera-motion",
        title: "A camera held by hand",
        of: &["running-average", "mixture-of-gaussians", "frame-difference"],
        cause: Some(Cause::CameraMotion),
        clip: "hand-held",
        settings: &[("camera", "still")],
        frame: 0,
        says: "A pixel is compared with earlier levels of the same pixel, but under a moving camera these show other places of the scene. The \
               motion of the camera has to be estimated first, as in the motion-compensated difference.",
        claim: ("mask_f1", Limit::AtMost(0.6)),
        instead: None,
    },
];
