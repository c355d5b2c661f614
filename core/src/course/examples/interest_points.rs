//! Examples of detectors: how many keypoints they detect again in the next frame.

use super::{Alternative, Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "A texture with corners moves",
        of: &["fast"],
        cause: None,
        clip: "translation",
        settings: &[],
        frame: 0,
        says: "The same pixels lie on the circle in both frames, so nearly all corners are detected again; only noise decides otherwise at some.",
        claim: ("repeatability", Limit::AtLeast(0.95)),
        instead: None,
    },
    Example {
        id: "noise",
        title: "Noise as strong as the threshold",
        of: &["fast"],
        cause: Some(Cause::Noise),
        clip: "translation,noise=20",
        settings: &[],
        frame: 0,
        says: "FAST compares single pixels with a threshold of 20 gray levels. Noise with the same standard deviation makes arcs of its own, which the \
               next frame does not have. SURF sums over boxes, where noise averages out.",
        claim: ("repeatability", Limit::AtMost(0.2)),
        instead: Some(Alternative { id: "surf", settings: &[], limit: Limit::AtLeast(0.6) }),
    },
    Example {
        id: "works",
        title: "The picture turns and grows",
        of: &["sift"],
        cause: None,
        clip: "spin-zoom",
        settings: &[],
        frame: 0,
        says: "An extremum in position and scale turns and grows with its blob, so most keypoints are detected again.",
        claim: ("repeatability", Limit::AtLeast(0.75)),
        instead: None,
    },
    Example {
        id: "low-contrast",
        title: "A texture of little contrast",
        of: &["sift"],
        cause: Some(Cause::LowTexture),
        clip: "translation,low-texture=80",
        settings: &[],
        frame: 0,
        says: "A fifth of the contrast gives a fifth of |D|, which the contrast threshold rejects, although the frames have no noise that would move \
               the keypoints. A threshold of a fifth finds them.",
        claim: ("points", Limit::AtMost(20.0)),
        instead: Some(Alternative {
            id: "sift",
            settings: &[("contrast-threshold", "0.008")],
            limit: Limit::AtLeast(500.0),
        }),
    },
];
