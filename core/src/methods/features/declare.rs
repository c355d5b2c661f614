//! The pseudocode that every corner detector has, declared once.

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
