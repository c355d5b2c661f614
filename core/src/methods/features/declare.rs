//! What every corner detector declares, once.

use super::Settings;

/// What has the parameters of a corner detector: every struct that [`corner_params!`] declares.
pub trait HasSettings {
    /// Their values.
    fn settings(&self) -> Settings;
}

/// Declares the parameters of a corner detector: its own, and those that all have.
macro_rules! corner_params {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($own:tt)*
        }
    ) => {
        $crate::params! {
            $(#[$meta])*
            pub struct $name {
                $($own)*
                /// Side of the window of the structure tensor; an even one reaches as far as the next odd one.
                window: usize = 5, 3..=31, "px";
                /// How much the pixels of the window count.
                weights: $crate::methods::differential::Weights = $crate::methods::differential::Weights::Gaussian;
                /// How derivatives are estimated from pixels.
                derivatives: $crate::methods::differential::Scheme = $crate::methods::differential::Scheme::Sobel;
                /// The least response of a corner, as a share of the largest in the picture.
                threshold: f32 = 0.01, 0.0..=1.0;
                /// From a corner to the next stronger one it is at least this far; 0 allows any distance.
                min_distance: usize = 7, 0..=100, "px";
                /// At most so many corners are kept, the strongest.
                max_points: usize = 500, 1..=5000;
            }
        }

        impl $crate::methods::features::HasSettings for $name {
            fn settings(&self) -> $crate::methods::features::Settings {
                let Self { window, weights, derivatives, threshold, min_distance, max_points, .. } = *self;
                $crate::methods::features::Settings { window, weights, derivatives, threshold, min_distance, max_points }
            }
        }
    };
}
pub(crate) use corner_params;

/// The lines that all corner detectors have.
pub(super) mod line {
    crate::line_names!(TAKE_DERIVATIVES, RESPOND, EACH_STRONG, SUPPRESS, EACH_PEAK, DROP_NEAR, KEEP);
}

/// The pseudocode of a corner detector, of which `response` is the line that gives the response R of a pixel.
macro_rules! corner_pseudocode {
    ($response:literal) => {
        $crate::pseudocode! {
            TAKE_DERIVATIVES: "I_x, I_y ← derivatives of frame t",
            EACH_PIXEL: "for each pixel: T ← Σ w (I_x², I_x I_y; I_x I_y, I_y²) over the window around it, Σ w = 1",
            RESPOND: $response,
            EACH_STRONG: "for each pixel with R ≥ threshold · largest R",
            SUPPRESS: "  if a neighbour is stronger, then suppress it",
            EACH_PEAK: "for each that is left, the strongest first",
            DROP_NEAR: "  if one nearer than min-distance was kept, then drop it",
            KEEP: "  else keep it, until there are max-points",
        }
    };
}
pub(crate) use corner_pseudocode;
