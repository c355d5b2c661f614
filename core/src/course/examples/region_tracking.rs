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
];
