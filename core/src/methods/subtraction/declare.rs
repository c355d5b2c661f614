//! What every background subtraction declares, once.

use crate::data::Connectivity;

/// The parameters that all have.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Radius of the square with which the mask is opened, in px.
    pub open: usize,
    /// Radius of the square with which it is closed after that, in px.
    pub close: usize,
    /// The least area of a blob that is kept, in px.
    pub min_area: usize,
    /// Which pixels are neighbours.
    pub connectivity: Connectivity,
    /// How many frames there are at most.
    pub frames: usize,
}

/// What has the parameters of a background subtraction: every struct that [`subtraction_params!`] declares.
pub trait HasSettings {
    /// Their values.
    fn settings(&self) -> Settings;
}

/// Declares the parameters of a background subtraction: its own, and those that all have.
macro_rules! subtraction_params {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($own:tt)*
        }
        open: $open:literal, close: $close:literal
    ) => {
        $crate::params! {
            $(#[$meta])*
            pub struct $name {
                $($own)*
                /// Regions in which a square of this radius does not fit go; 0 keeps all.
                open: usize = $open, 0..=15, "px";
                /// Gaps in which a square of this radius does not fit are filled; 0 leaves all open.
                close: usize = $close, 0..=15, "px";
                /// Smaller blobs are dropped.
                min_area: usize = 30, 1..=100_000, "px";
                /// Which pixels are neighbours: those with a common edge, or a common corner as well.
                connectivity: $crate::data::Connectivity = $crate::data::Connectivity::Eight;
                /// At most so many frames, the first one counted; fewer where the clip ends.
                frames: usize = 300, 2..=100_000;
            }
        }

        impl $crate::methods::subtraction::HasSettings for $name {
            fn settings(&self) -> $crate::methods::subtraction::Settings {
                let Self { open, close, min_area, connectivity, frames, .. } = *self;
                $crate::methods::subtraction::Settings { open, close, min_area, connectivity, frames }
            }
        }
    };
}
pub(crate) use subtraction_params;

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
