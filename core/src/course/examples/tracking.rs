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
        says: "Both stars look alike, and their boxes overlap where they meet. The predicted velocity leads each track to its own star.",
        claim: ("idf1", Limit::AtLeast(0.95)),
        instead: None,
    },
    Example {
        id: "works",
        title: "Two stars cross, detected with noise",
        of: &["multiple-hypothesis"],
        cause: None,
        clip: "crossing-stars",
        settings: &[("added-noise", "8"), ("measurement-noise-from", "box-height"), ("measurement-noise", "0.15")],
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
        settings: &[("added-noise", "3"), ("measurement-noise-from", "box-height"), ("measurement-noise", "0.6")],
        frame: 0,
        says: "Both detections lie in both gates, so each track is updated with their weighted mean, and both drift to the middle. Hypotheses assign each \
               detection to one track.",
        claim: ("idf1", Limit::AtMost(0.65)),
        instead: Some(Alternative {
            id: "multiple-hypothesis",
            settings: &[("added-noise", "3"), ("measurement-noise-from", "box-height"), ("measurement-noise", "0.6")],
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
    Example {
        id: "works",
        title: "Two stars and their paths",
        of: &["trajectory-analysis"],
        cause: None,
        clip: "crossing-stars",
        settings: &[],
        frame: 0,
        says: "Each star has one track from the first frame to the last, so speed, heading and crossings are counted for the right \
               object.",
        claim: ("idf1", Limit::AtLeast(0.9)),
        instead: None,
    },
    Example {
        id: "occlusion",
        title: "A ball that is counted twice",
        of: &["trajectory-analysis"],
        cause: Some(Cause::Occlusion),
        clip: "tunnel",
        settings: &[("tracker.max-age", "1")],
        frame: 0,
        says: "With a maximum age of 1 frame the track ends at the entrance of the tunnel and another begins at the exit: one ball has \
               two trajectories. The default age of 15 frames predicts the ball through the tunnel.",
        claim: ("idf1", Limit::AtMost(0.6)),
        instead: Some(Alternative { id: "trajectory-analysis", settings: &[], limit: Limit::AtLeast(0.75) }),
    },
    Example {
        id: "manoeuvre",
        title: "Headings of stars that turn",
        of: &["trajectory-analysis"],
        cause: Some(Cause::Maneuver),
        clip: "crossing-stars,rotation=10",
        settings: &[],
        frame: 0,
        says: "The model of constant velocity predicts each star along its tangent, so the tracks exchange the stars where they meet. A \
               coordinated turn predicts the circle.",
        claim: ("idf1", Limit::AtMost(0.6)),
        instead: Some(Alternative {
            id: "trajectory-analysis",
            settings: &[("tracker.motion", "turn")],
            limit: Limit::AtLeast(0.85),
        }),
    },
    Example {
        id: "proximity",
        title: "Paths of two boats side by side",
        of: &["trajectory-analysis"],
        cause: Some(Cause::Proximity),
        clip: "formation",
        settings: &[
            ("tracker.added-noise", "3"),
            ("tracker.measurement-noise-from", "box-height"),
            ("tracker.measurement-noise", "0.6"),
        ],
        frame: 0,
        says: "Noise of 3 px brings each detection into the gates of both tracks, so tracks end, change boats and begin anew. \
               Multiple hypotheses decide after some frames, by the whole path.",
        claim: ("idf1", Limit::AtMost(0.55)),
        instead: Some(Alternative {
            id: "trajectory-analysis",
            settings: &[
                ("tracker", "multiple-hypothesis"),
                ("tracker.added-noise", "3"),
                ("tracker.measurement-noise-from", "box-height"),
                ("tracker.measurement-noise", "0.6"),
            ],
            limit: Limit::AtLeast(0.75),
        }),
    },
    Example {
        id: "manoeuvre",
        title: "Stars that turn by 10° a frame",
        of: &["kalman-filter", "kalman-tracker", "joint-probabilistic", "blob-tracker"],
        cause: Some(Cause::Maneuver),
        clip: "crossing-stars,rotation=10",
        settings: &[],
        frame: 0,
        says: "A prediction along the tangent leaves the circle by several pixels a frame, so a track takes the other star or is lost where the \
               stars are close. With the turn rate in the state the prediction follows the circle.",
        claim: ("idf1", Limit::AtMost(0.7)),
        instead: Some(Alternative {
            id: "kalman-tracker",
            settings: &[("motion", "turn")],
            limit: Limit::AtLeast(0.9),
        }),
    },
];
