//! Examples of motion segmentation.

use super::{Alternative, Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "A disc and a card over a drifting table",
        of: &["motion-clustering", "motion-layers", "flow-segmentation", "trajectory-clustering"],
        cause: None,
        clip: "rigid-layers",
        settings: &[],
        frame: 0,
        says: "Each object is shifted as a whole, so one displacement describes all of its pixels. Wrong labels lie along the outlines, where the flow is \
               blurred or occluded.",
        claim: ("adjusted_rand_index", Limit::AtLeast(0.85)),
        instead: None,
    },
    Example {
        id: "rotation",
        title: "A turning record",
        of: &["motion-clustering"],
        cause: Some(Cause::Rotation),
        clip: "turntable",
        settings: &[],
        frame: 0,
        says: "On an object that turns, each pixel has another displacement, so its parts join other clusters. An affine motion describes the whole \
               record.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.6)),
        instead: Some(Alternative { id: "motion-layers", settings: &[], limit: Limit::AtLeast(0.95) }),
    },
    Example {
        id: "noise",
        title: "Noise in two frames",
        of: &["motion-layers", "flow-segmentation"],
        cause: Some(Cause::Noise),
        clip: "rigid-layers,noise=30",
        settings: &[],
        frame: 0,
        says: "The flow of a single pair of frames is as noisy as the differences of the motions. Trajectory clustering compares points over eight \
               frames, in which two objects separate by several pixels while the noise of a position stays the same.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.3)),
        instead: Some(Alternative { id: "trajectory-clustering", settings: &[], limit: Limit::AtLeast(0.75) }),
    },
    Example {
        id: "low-texture",
        title: "Hardly any texture to follow",
        of: &["trajectory-clustering"],
        cause: Some(Cause::LowTexture),
        clip: "rigid-layers,low-texture=97",
        settings: &[],
        frame: 0,
        says: "Points are followed only where the texture fixes their position, so whole objects have no trajectory. A dense flow is filled in from the \
               outlines by its smoothness term.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.3)),
        instead: Some(Alternative { id: "motion-layers", settings: &[], limit: Limit::AtLeast(0.9) }),
    },
];
