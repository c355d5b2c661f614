//! Examples of stereo and scene flow.

use super::{Alternative, Cause, Example, Limit};

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "Textured surfaces near the cameras",
        of: &["block-stereo", "semi-global-matching"],
        cause: None,
        clip: "still-life",
        settings: &[],
        frame: 0,
        says: "All surfaces have a texture that does not repeat, so each window has one best match. Wrong pixels lie beside the balls, where the right \
               camera sees other parts of the wall, and at the left border, where the match lies beside the right view.",
        claim: ("bad3_percent", Limit::AtMost(10.0)),
        instead: None,
    },
    Example {
        id: "noise",
        title: "Noise in both views",
        of: &["block-stereo"],
        cause: Some(Cause::Noise),
        clip: "still-life,noise=15",
        settings: &[],
        frame: 0,
        says: "Noise makes several disparities cost nearly the same, so many matches fail the uniqueness test. Semi-global matching sums costs along \
               paths through the whole picture, where noise averages out.",
        claim: ("bad3_percent", Limit::AtLeast(14.0)),
        instead: Some(Alternative { id: "semi-global-matching", settings: &[], limit: Limit::AtMost(8.0) }),
    },
    Example {
        id: "repetition",
        title: "A texture that repeats along the epipolar line",
        of: &["block-stereo", "semi-global-matching"],
        cause: Some(Cause::Repetition),
        clip: "still-life,repeating-texture=100",
        settings: &[],
        frame: 0,
        says: "The texture repeats within the disparities searched, so several matches have the same cost, and smoothness does not decide which of them is \
               right: a whole surface may take a wrong one.",
        claim: ("bad3_percent", Limit::AtLeast(30.0)),
        instead: None,
    },
    Example {
        id: "large-motion",
        title: "Balls nearer than the search reaches",
        of: &["block-stereo", "semi-global-matching"],
        cause: Some(Cause::LargeMotion),
        clip: "still-life",
        settings: &[("disparities", "16")],
        frame: 0,
        says: "The nearer a point, the larger its displacement between the views, and 15 px are the largest that 16 disparities contain. The \
               true matches of the balls and of the table before them are never tested; 64 disparities reach them.",
        claim: ("bad3_percent", Limit::AtLeast(25.0)),
        instead: Some(Alternative { id: "semi-global-matching", settings: &[], limit: Limit::AtMost(8.0) }),
    },
    Example {
        id: "noise",
        title: "Path costs without penalties",
        of: &["semi-global-matching"],
        cause: Some(Cause::Noise),
        clip: "still-life,noise=50",
        settings: &[("p1", "0"), ("p2", "0")],
        frame: 0,
        says: "Without penalties the disparity may change freely from pixel to pixel, so a path adds nothing to the census cost of each, \
               which the noise scrambles. The default penalties carry the evidence of many pixels along the paths.",
        claim: ("bad3_percent", Limit::AtLeast(30.0)),
        instead: Some(Alternative { id: "semi-global-matching", settings: &[], limit: Limit::AtMost(15.0) }),
    },
    Example {
        id: "works",
        title: "A car and a pedestrian, seen from a moving car",
        of: &["scene-flow"],
        cause: None,
        clip: "drive",
        settings: &[],
        frame: 0,
        says: "The motion of the cameras is found from the street and the houses, to less than 15 mm. The pedestrian stands out by a motion across the \
               view; the car ahead hardly moves in the picture, and only the change of its disparity shows that it drives.",
        claim: ("ego_translation_error_m", Limit::AtMost(0.015)),
        instead: None,
    },
    Example {
        id: "noise",
        title: "Noise in all pictures",
        of: &["scene-flow"],
        cause: Some(Cause::Noise),
        clip: "drive,noise=20",
        settings: &[],
        frame: 0,
        says: "Noise in the disparities becomes an error that grows with the square of the depth, and the difference of two depths is what scene flow is. \
               The motion of the cameras survives, as it averages hundreds of points.",
        claim: ("scene_flow_median_percent", Limit::AtLeast(3.5)),
        instead: None,
    },
    Example {
        id: "large-motion",
        title: "Three times as fast",
        of: &["scene-flow"],
        cause: Some(Cause::LargeMotion),
        clip: "drive,speed=3",
        settings: &[],
        frame: 0,
        says: "Near the cameras the flow is larger than its method can follow. There the scene flow is wrong, and the street seems to move by itself.",
        claim: ("own_motion_f1", Limit::AtMost(0.45)),
        instead: None,
    },
];
