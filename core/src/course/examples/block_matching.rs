//! Examples of block matching.

use super::{Alternative, Cause, Example, Limit};

/// The searches that test every displacement of the search window.
const EXHAUSTIVE: &[&str] = &["full-search", "successive-elimination"];

pub(super) const EXAMPLES: &[Example] = &[
    Example {
        id: "works",
        title: "A picture that moves as a whole",
        of: EXHAUSTIVE,
        cause: None,
        clip: "translation",
        settings: &[],
        frame: 0,
        says: "One displacement explains every block, and the texture has no second minimum nearby.",
        claim: ("epe_px", Limit::AtMost(0.5)),
        instead: None,
    },
    Example {
        id: "large-motion",
        title: "Motion beyond the search range",
        of: EXHAUSTIVE,
        cause: Some(Cause::LargeMotion),
        clip: "translation,speed=4",
        settings: &[("search-range", "8")],
        frame: 0,
        says: "The true displacement lies outside the search window, so the minimum inside it is a chance match.",
        claim: ("epe_px", Limit::AtLeast(6.0)),
        instead: Some(Alternative { id: "hierarchical", settings: &[], limit: Limit::AtMost(2.0) }),
    },
    Example {
        id: "low-texture",
        title: "A wall without texture",
        of: EXHAUSTIVE,
        cause: Some(Cause::LowTexture),
        clip: "flat-wall",
        settings: &[],
        frame: 0,
        says: "On the plain wall all costs are nearly the same, and noise decides which of them is the minimum.",
        claim: ("epe_px", Limit::AtLeast(5.0)),
        instead: Some(Alternative { id: "horn-schunck", settings: &[], limit: Limit::AtMost(0.5) }),
    },
    Example {
        id: "repetition",
        title: "A pattern that repeats",
        of: EXHAUSTIVE,
        cause: Some(Cause::Repetition),
        clip: "wallpaper",
        settings: &[("search-range", "32")],
        frame: 0,
        says: "The cost has a minimum at every period of the pattern; the lowest of them need not be the true one.",
        claim: ("epe_px", Limit::AtLeast(1.0)),
        instead: Some(Alternative { id: "horn-schunck", settings: &[], limit: Limit::AtMost(0.1) }),
    },
    Example {
        id: "rotation",
        title: "A picture that turns and grows",
        of: EXHAUSTIVE,
        cause: Some(Cause::Rotation),
        clip: "spin-zoom",
        settings: &[],
        frame: 0,
        says: "A block is displaced as a whole, but here its pixels move in different directions: no displacement matches all of them.",
        claim: ("epe_px", Limit::AtLeast(1.2)),
        instead: Some(Alternative { id: "tv-l1", settings: &[], limit: Limit::AtMost(0.2) }),
    },
    Example {
        id: "light-change",
        title: "Light that flickers",
        of: EXHAUSTIVE,
        cause: Some(Cause::LightChange),
        clip: "flicker",
        settings: &[],
        frame: 0,
        says: "SAD compares gray levels as they are, so a block matches where the gray levels are nearest. Normalised cross-correlation \
               is independent of gain and offset.",
        claim: ("epe_px", Limit::AtLeast(0.6)),
        instead: Some(Alternative { id: "full-search", settings: &[("cost", "ncc")], limit: Limit::AtMost(0.4) }),
    },
];
