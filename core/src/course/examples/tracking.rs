//! Examples of filters and trackers of objects that are detected.

use super::{Alternative, Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "Two stars cross",
        of: &["kalman-filter", "kalman-tracker", "joint-probabilistic", "blob-tracker"],
        cause: None,
        clip: "crossing-stars",
        settings: &[],
        frame: 0,
        says: "Both stars look alike, and their boxes overlap where they meet. The predicted velocities keep them apart.",
        claim: ("idf1", Limit::AtLeast(0.95)),
        instead: None,
    },
    Example {
        id: "works",
        title: "Two stars cross, detected with noise",
        of: &["multiple-hypothesis"],
        cause: None,
        clip: "crossing-stars",
        settings: &[("added-noise", "8"), ("measurement-noise", "0.15")],
        frame: 6,
        says: "With noise of 8 px both detections may belong to either star where they cross, and the tree keeps several explanations. Four frames later \
               the leading one decides.",
        claim: ("idf1", Limit::AtLeast(0.95)),
        instead: None,
    },
    Example {
        id: "manoeuvre",
        title: "Stars that fly in turns",
        of: &["multiple-hypothesis"],
        cause: Some(Cause::Maneuver),
        clip: "crossing-stars,rotation=4",
        settings: &[],
        frame: 0,
        says: "Hypotheses differ in the origin of detections, not in the motion: all of them predict a constant velocity, and a star that turns leaves \
               its gate in each. The model of a coordinated turn predicts it.",
        claim: ("idf1", Limit::AtMost(0.7)),
        instead: Some(Alternative {
            id: "multiple-hypothesis",
            settings: &[("motion", "turn")],
            limit: Limit::AtLeast(0.95),
        }),
    },
    Example {
        id: "coalescence",
        title: "Two boats side by side",
        of: &["joint-probabilistic"],
        cause: Some(Cause::Proximity),
        clip: "formation",
        settings: &[("added-noise", "3"), ("measurement-noise", "0.6")],
        frame: 0,
        says: "Both detections lie in both gates, so each track is updated with their weighted mean, and both drift to the middle. Hypotheses assign each \
               detection to one track.",
        claim: ("idf1", Limit::AtMost(0.65)),
        instead: Some(Alternative {
            id: "multiple-hypothesis",
            settings: &[("added-noise", "3"), ("measurement-noise", "0.6")],
            limit: Limit::AtLeast(0.8),
        }),
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
