//! What every background subtraction declares, once.

use crate::data::Connectivity;
use crate::params;

params! {
    /// The parameters that all have.
    #[derive(Copy)]
    pub struct Settings {
        /// Regions in which a square of this radius does not fit go; 0 keeps all.
        open: usize = 1, 0..=15, "px";
        /// Gaps in which a square of this radius does not fit are filled; 0 leaves all open.
        close: usize = 2, 0..=15, "px";
        /// Smaller blobs are dropped.
        min_area: usize = 30, 1..=100_000, "px";
        /// Which pixels are neighbours: those with a common edge, or a common corner as well.
        connectivity: Connectivity = Connectivity::Eight;
        /// At most so many frames, the first one counted; fewer where the clip ends.
        frames: usize = 300, 2..=100_000;
    }
    advanced { "connectivity" }
}

/// The lines that all background subtractions have; shadows are not looked for by all.
pub(super) mod line {
    crate::line_names!(BEGIN_MODEL, COMPARE, DECIDE, REMOVE_SHADOWS, OPEN, CLOSE, LABEL, KEEP_BLOBS, UPDATE_MODEL);
}

/// The pseudocode of a background subtraction: how the model begins, how a pixel is compared and decided, the line that
/// finds shadows where there is one, and how the model takes the frame in.
macro_rules! subtraction_pseudocode {
    (
        begin: $begin:literal, compare: $compare:literal, decide: $decide:literal,
        $(shadows: $shadows:literal,)? update: $update:literal $(,)?
    ) => {
        $crate::pseudocode! {
            BEGIN_MODEL: $begin,
            EACH_FRAME: "for each frame t that follows, and each of its pixels",
            COMPARE: $compare,
            DECIDE: $decide,
            $(REMOVE_SHADOWS: $shadows,)?
            OPEN: "  open the mask: what is smaller than the square goes",
            CLOSE: "  close it: gaps smaller than the square are filled",
            LABEL: "  label its connected components",
            KEEP_BLOBS: "  keep those of min-area px or more as blobs",
            UPDATE_MODEL: $update,
        }
    };
}
pub(crate) use subtraction_pseudocode;
