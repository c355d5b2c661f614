//! Parameters and pseudocode shared by all background subtractions.

use super::vocabulary::value;
use crate::data::Connectivity;
use crate::params;
use crate::scene::{Question, Role};

params! {
    /// The parameters of all background subtractions.
    #[derive(Copy)]
    pub struct Settings {
        /// Radius r of the opening (erosion, then dilation with a (2r + 1)×(2r + 1) square). It removes regions narrower than the square;
        /// 0 turns it off.
        opening: usize = 1, 0..=15, "px";
        /// Area of the area opening: connected components of fewer pixels are removed before the closing joins them. Unlike the opening it
        /// removes single pixels of noise and keeps lines that are 1 px wide; 0 turns it off.
        area_opening: usize = 0, 0..=1000, "px";
        /// Radius r of the closing (dilation, then erosion with a (2r + 1)×(2r + 1) square). It fills gaps narrower than the square; 0
        /// turns it off.
        closing: usize = 2, 0..=15, "px";
        /// Minimum area of a blob. Smaller connected components are rejected as noise. 0 chooses 1/2560 of the picture: 30 px at 320×240.
        min_area: usize = 0, 0..=100_000, "px";
        /// Connectivity of components: 4 (shared edge) or 8 (shared edge or corner).
        connectivity: Connectivity = Connectivity::Eight;
        /// Maximum number of frames, the first included.
        frames: usize = 300, 2..=100_000;
    }
    advanced { "area-opening", "connectivity" }
}

/// The share of the picture that a blob covers at least, where no minimum area is set.
const LEAST_SHARE: usize = 2560;

impl Settings {
    /// Whether anything is removed from the mask before the closing.
    pub(super) fn is_opened(&self) -> bool {
        self.opening > 0 || self.area_opening > 1
    }

    /// Returns the minimum area of a blob in px.
    pub fn least_area(&self, (width, height): (usize, usize)) -> usize {
        if self.min_area > 0 { self.min_area } else { (width * height / LEAST_SHARE).max(1) }
    }
}

/// Names of the lines of the pseudocode. `REMOVE_SHADOWS` exists only where shadows are detected, `FOLLOW_CAMERA`, `REGISTER`,
/// `CORRECT_EXPOSURE` and `SUPPRESS_SHAKE` only in models of the background.
pub(super) mod line {
    crate::line_names!(
        BEGIN_MODEL,
        FOLLOW_CAMERA,
        CORRECT_EXPOSURE,
        REGISTER,
        COMPARE,
        DECIDE,
        REMOVE_SHADOWS,
        SUPPRESS_SHAKE,
        OPEN,
        CLOSE,
        LABEL,
        KEEP_BLOBS,
        UPDATE_MODEL
    );
}

/// The questions of all of them.
pub(super) const QUESTIONS: &[Question] = &[
    Question::place("object", "Where is a blob of the foreground?", line::UPDATE_MODEL, Role::Result),
    Question::value("share", "Which share of the frame is foreground?", line::DECIDE, value::FOREGROUND_SHARE),
    Question::value("blobs", "How many blobs remain after the minimum area?", line::KEEP_BLOBS, value::BLOBS),
];

/// The pseudocode of a background subtraction: initialisation, comparison, classification, shadow removal if there is one,
/// and update of the model.
macro_rules! subtraction_pseudocode {
    (
        begin: $begin:literal, $(camera: $camera:literal,)? $(register: $register:literal,)?
        compare: $compare:literal, decide: $decide:literal,
        $(shadows: $shadows:literal,)? $(shake: $shake:literal,)? update: $update:literal $(,)?
    ) => {
        $crate::pseudocode! {
            BEGIN_MODEL: $begin,
            EACH_FRAME: "for each later frame t, at each pixel",
            $(FOLLOW_CAMERA: $camera, CORRECT_EXPOSURE: "  correct the exposure of the frame to that of the background",)?
            $(REGISTER: $register,)?
            COMPARE: $compare,
            DECIDE: $decide,
            $(REMOVE_SHADOWS: $shadows,)?
            $(SUPPRESS_SHAKE: $shake,)?
            OPEN: "  opening of the mask: erosion, then dilation; without components below area-opening",
            CLOSE: "  closing of the mask: dilation, then erosion",
            LABEL: "  label the connected components",
            KEEP_BLOBS: "  blobs ← components with area ≥ min-area",
            UPDATE_MODEL: $update,
        }
    };
}
pub(crate) use subtraction_pseudocode;
