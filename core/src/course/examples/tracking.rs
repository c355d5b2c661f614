//! Examples of filters and trackers of objects that are detected.

use super::{Alternative, Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "Two stars cross",
        of: &["kalman-filter", "kalman-tracker", "joint-probabilistic", "multiple-hypothesis", "blob-tracker"],
        cause: None,
        clip: "crossing-stars",
        settings: &[],
        frame: 0,
        says: "Both stars look alike, and their boxes overlap where they meet. The predicted velocities keep them apart.",
        claim: ("idf1", Limit::AtLeast(0.95)),
        instead: None,
    },
    Example {
        id: "occlusion",
        title: "Cars pass under a bridge",
        of: &["kalman-filter", "kalman-tracker", "joint-probabilistic", "multiple-hypothesis", "blob-tracker"],
        cause: Some(Cause::Occlusion),
        clip: "traffic",
        settings: &[("max-age", "1")],
        frame: 0,
        says: "With a maximum age of 1 frame a track ends under the bridge, and the car gets another identity behind it. With its \
               default the Kalman tracker predicts the car through the bridge.",
        claim: ("idf1", Limit::AtMost(0.85)),
        instead: Some(Alternative { id: "kalman-tracker", settings: &[], limit: Limit::AtLeast(0.9) }),
    },
];
