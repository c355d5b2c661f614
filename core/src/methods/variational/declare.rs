//! What every variational method declares, once.

use crate::methods::differential::Scheme;

/// What has the parameters of a variational method: every struct that [`variational_params!`] declares.
pub trait HasSettings {
    /// Their values.
    fn settings(&self) -> Settings;
}

/// The parameters that all variational methods have.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Iterations for each level and warp.
    pub iterations: usize,
    /// A warp is over when an iteration changes displacements by less on average, in px of the picture; 0 for never.
    pub tolerance: f32,
    /// The most levels of the pyramid.
    pub levels: usize,
    /// Warps on each level.
    pub warps: usize,
    /// How derivatives are estimated.
    pub derivatives: Scheme,
    /// Standard deviation of the Gaussian that smooths both frames first, in px.
    pub smoothing: f32,
}

/// Declares the parameters of a variational method: its own, and those that all have, with the defaults that suit it.
macro_rules! variational_params {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($own:tt)*
        }
        iterations = $iterations:literal, levels = $levels:literal, warps = $warps:literal, smoothing = $smoothing:literal
    ) => {
        $crate::params! {
            $(#[$meta])*
            pub struct $name {
                $($own)*
                /// Iterations for each level and warp.
                iterations: usize = $iterations, 1..=1000;
                /// Go on to the next warp when an iteration changes displacements by less on average, in px of the picture; 0 does all iterations.
                tolerance: f32 = 0.0, 0.0..=1.0, "px";
                /// Levels of the pyramid, each half as large as the one before; fewer where a side would be less than 16 px. 1 works on the picture alone.
                levels: usize = $levels, 1..=10;
                /// How often on each level frame t+1 is brought back by what was found, and its derivatives taken anew.
                warps: usize = $warps, 1..=20;
                /// How derivatives are estimated from pixels.
                derivatives: $crate::methods::differential::Scheme = $crate::methods::differential::Scheme::FivePoint;
                /// Standard deviation of the Gaussian that smooths both frames first; 0 leaves them as they are.
                smoothing: f32 = $smoothing, 0.0..=5.0, "px";
            }
        }

        impl $crate::methods::variational::HasSettings for $name {
            fn settings(&self) -> $crate::methods::variational::Settings {
                let Self { iterations, tolerance, levels, warps, derivatives, smoothing, .. } = *self;
                $crate::methods::variational::Settings { iterations, tolerance, levels, warps, derivatives, smoothing }
            }
        }
    };
}
pub(crate) use variational_params;
