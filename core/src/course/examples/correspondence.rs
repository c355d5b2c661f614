//! Examples of feature matching and of the motion that explains the matches.

use super::{Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "Keypoints on a textured scene",
        of: &["feature-matching"],
        cause: None,
        clip: "pillar",
        settings: &[],
        frame: 0,
        says: "The nearest descriptor is much nearer than the second nearest wherever the texture is distinctive.",
        claim: ("match_precision", Limit::AtLeast(0.95)),
        instead: None,
    },
    Example {
        id: "repetition",
        title: "A wallpaper",
        of: &["feature-matching"],
        cause: Some(Cause::Repetition),
        clip: "wallpaper",
        settings: &[],
        frame: 0,
        says: "Each keypoint has equally good matches one period apart, so the ratio test rejects them all.",
        claim: ("matches", Limit::AtMost(10.0)),
        instead: None,
    },
    Example {
        id: "works",
        title: "A camera in the hand",
        of: &["global-motion"],
        cause: None,
        clip: "hand-held",
        settings: &[],
        frame: 0,
        says: "Most matches lie on the background, so that the consensus is the motion of the camera, and objects are outliers.",
        claim: ("epe_median_px", Limit::AtMost(0.1)),
        instead: None,
    },
    Example {
        id: "large-object",
        title: "A bus fills most of the picture",
        of: &["global-motion"],
        cause: Some(Cause::Clutter),
        clip: "passing-bus",
        settings: &[],
        frame: 0,
        says: "Most matches lie on the bus, and the consensus of RANSAC is the motion of the majority, whatever it belongs to.",
        claim: ("epe_median_px", Limit::AtLeast(0.5)),
        instead: None,
    },
];
