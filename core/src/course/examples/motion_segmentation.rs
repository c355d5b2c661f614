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
    Example {
        id: "camera-motion",
        title: "The camera zooms",
        of: &["motion-clustering", "trajectory-clustering"],
        cause: Some(Cause::CameraMotion),
        clip: "rigid-layers,scale-change=3",
        settings: &[],
        frame: 0,
        says: "The zoom adds a displacement that grows with the distance from the centre, so the motions within the table differ more than \
               those of the objects. The flow still jumps at the outlines, where a segmentation along jumps cuts it.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.15)),
        instead: Some(Alternative { id: "flow-segmentation", settings: &[], limit: Limit::AtLeast(0.9) }),
    },
    Example {
        id: "slow-motion",
        title: "Motions within one bandwidth",
        of: &["motion-clustering"],
        cause: Some(Cause::SlowMotion),
        clip: "rigid-layers,speed=0.2",
        settings: &[("method", "mean-shift")],
        frame: 0,
        says: "All displacements lie within the bandwidth of 0.75 px of one another, so every start of mean shift climbs to the same mode. A \
               bandwidth of 0.2 px separates them.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.1)),
        instead: Some(Alternative {
            id: "motion-clustering",
            settings: &[("method", "mean-shift"), ("bandwidth", "0.2")],
            limit: Limit::AtLeast(0.9),
        }),
    },
    Example {
        id: "slow-motion",
        title: "Layers that are merged",
        of: &["motion-layers"],
        cause: Some(Cause::SlowMotion),
        clip: "rigid-layers,speed=0.2",
        settings: &[],
        frame: 0,
        says: "The motions of the layers differ by less than the 0.5 px below which layers are merged, so one layer is left for the \
               whole picture. Limits that fit this motion keep all three.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.1)),
        instead: Some(Alternative {
            id: "motion-layers",
            settings: &[("merge-below", "0.1"), ("tolerance", "0.2")],
            limit: Limit::AtLeast(0.9),
        }),
    },
    Example {
        id: "slow-motion",
        title: "A region that grows over everything",
        of: &["flow-segmentation"],
        cause: Some(Cause::SlowMotion),
        clip: "rigid-layers,speed=0.2",
        settings: &[("method", "region-growing")],
        frame: 0,
        says: "No pixel differs from the mean of the first region by more than the tolerance of 0.75 px, so it grows over the whole \
               picture. Graph-based merging compares a jump with the differences inside the regions.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.1)),
        instead: Some(Alternative { id: "flow-segmentation", settings: &[], limit: Limit::AtLeast(0.9) }),
    },
    Example {
        id: "light-change",
        title: "Layers in rising light",
        of: &["motion-layers", "flow-segmentation"],
        cause: Some(Cause::LightChange),
        clip: "rigid-layers,offset=10",
        settings: &[],
        frame: 0,
        says: "TV-L1 takes the brighter light for motion along the gradients, so the flow of each object varies with its texture and is cut \
               into pieces. The flow of Farnebäck does not depend on an offset of the gray levels.",
        claim: ("adjusted_rand_index", Limit::AtMost(0.3)),
        instead: Some(Alternative {
            id: "motion-layers",
            settings: &[("flow", "farneback")],
            limit: Limit::AtLeast(0.85),
        }),
    },
];
