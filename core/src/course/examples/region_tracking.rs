//! Examples of trackers of a region.

use super::{Alternative, Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "A balloon before a plain sky",
        of: &["mean-shift", "camshift", "correlation-filter", "template-tracker"],
        cause: None,
        clip: "balloon",
        settings: &[],
        frame: 0,
        says: "Nothing around the object looks like it, and nothing covers it.",
        claim: ("mean_overlap", Limit::AtLeast(0.85)),
        instead: None,
    },
    Example {
        id: "occlusion",
        title: "A ball rolls through a tunnel",
        of: &["mean-shift", "camshift", "correlation-filter", "template-tracker"],
        cause: Some(Cause::Occlusion),
        clip: "tunnel",
        settings: &[],
        frame: 0,
        says: "While the ball is covered the tracker has nothing to follow, and it stays where the ball was last seen. Particles \
               keep moving as the ball did, and some of them are there when it comes out.",
        claim: ("mean_overlap", Limit::AtMost(0.55)),
        instead: Some(Alternative { id: "particle-filter", settings: &[], limit: Limit::AtLeast(0.75) }),
    },
    Example {
        id: "clutter",
        title: "Leaves of the same colour",
        of: &["camshift"],
        cause: Some(Cause::Clutter),
        clip: "leaves",
        settings: &[],
        frame: 0,
        says: "The window takes the size of everything of that colour, and grows over the leaves around it.",
        claim: ("mean_overlap", Limit::AtMost(0.6)),
        instead: Some(Alternative { id: "mean-shift", settings: &[], limit: Limit::AtLeast(0.85) }),
    },
    Example {
        id: "works",
        title: "A box with a known model",
        of: &["rapid"],
        cause: None,
        clip: "turning-box",
        settings: &[],
        frame: 0,
        says: "Edges in three directions determine all six parameters of the pose, and the prediction keeps them near their control points.",
        claim: ("mean_overlap", Limit::AtLeast(0.97)),
        instead: None,
    },
    Example {
        id: "large-motion",
        title: "Edges move beyond the search range",
        of: &["rapid"],
        cause: Some(Cause::LargeMotion),
        clip: "turning-box,speed=2",
        settings: &[("search-range", "4"), ("pose-prediction", "none"), ("weighting", "equal"), ("iterations", "1")],
        frame: 0,
        says: "From the last pose, one iteration reaches the edges within 4 px alone, and the box turns by up to 6° a frame. \
               A prediction by constant velocity leaves a small error to the same search range.",
        claim: ("mean_overlap", Limit::AtMost(0.75)),
        instead: Some(Alternative { id: "rapid", settings: &[("search-range", "4")], limit: Limit::AtLeast(0.97) }),
    },
];
