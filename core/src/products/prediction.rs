//! The motion-compensated prediction of frame t, and its quality.

use super::assessment::{fact, scores};
use super::{Assessment, Coding, Column, Figure, Measure, Reference, metrics};
use crate::base::Error;
use crate::data::{Flow, Interpolation};
use crate::geometry::{Border, Gray, Grid};

/// The motion-compensated prediction of frame t: each pixel is fetched from its displaced position in `next`.
///
/// Whole displacements copy pixels exactly, fractional ones interpolate; a pixel of unknown motion has zero displacement.
pub fn predict(flow: &Flow, next: &Gray, (border, filter): (Border, Interpolation)) -> Gray {
    Grid::from_fn(flow.0.width(), flow.0.height(), |x, y| {
        let [u, v] = flow.at(x, y).unwrap_or([0.0; 2]);
        if u.fract() == 0.0 && v.fract() == 0.0 {
            next.at(x as isize + u as isize, y as isize + v as isize, border)
        } else {
            filter.sample(next, [x as f32 + u, y as f32 + v], border)
        }
    })
}

/// Peak signal-to-noise ratio of the motion-compensated prediction.
pub const PSNR: Measure =
    Measure::new("psnr_db", "Peak signal-to-noise ratio of the motion-compensated prediction in dB.")
        .in_column("PSNR dB", 2)
        .larger_is_better()
        .or("perfect");

const fn in_kilobytes(measure: Measure, heading: &'static str, name: &'static str) -> Measure {
    measure.in_column_as(Column { heading, name, per: 8e3, digits: 2 })
}

pub(super) const MEASURES: [Measure; 4] = [
    PSNR,
    in_kilobytes(
        Measure::new(
            "residual_bits",
            "Zero-order entropy of the residual of the motion-compensated prediction, in bits (in comparisons in kB of 8000 bits).",
        )
        .smaller_is_better(),
        "residual kB",
        "residual_kb",
    ),
    in_kilobytes(
        Measure::new(
            "vector_bits",
            "Zero-order entropy of the motion vectors of blocks, in bits (in comparisons in kB of 8000 bits).",
        ),
        "vectors kB",
        "vectors_kb",
    ),
    in_kilobytes(
        Measure::new(
            "frame_bits",
            "Zero-order entropy of the frame without motion compensation, in bits (in comparisons in kB of 8000 bits).",
        ),
        "frame without prediction kB",
        "frame_kb",
    ),
];

/// The quality of `picture`, a prediction of the frame of `reference`; `vectors` are coded with it.
///
/// # Errors
/// If the frame cannot be read.
pub(super) fn assess(
    picture: &Gray,
    vectors: Option<&[[f32; 2]]>,
    reference: &Reference<'_>,
) -> Result<Assessment, Error> {
    let [frame, _] = reference.clip.pair_or_last(reference.frame)?;
    let psnr = Some(metrics::psnr_db(picture, frame.luma())?).filter(|psnr| psnr.is_finite());
    let Coding { frame_bits, residual_bits, vector_bits } = Coding::of(vectors, frame.luma(), picture)?;
    let values = [psnr.into(), residual_bits.into(), vector_bits.into(), Figure::Real(frame_bits)];
    let quality = psnr.map_or("perfect".into(), |psnr| format!("{psnr:.2} dB PSNR"));
    let headline = psnr.map_or("perfect prediction".into(), |_| quality.clone());
    let kilobytes = |bits: f64| format!("{:.1}", bits / 8000.0);
    let vectors = vector_bits.map_or_else(String::new, |bits| format!(" + {}", kilobytes(bits)));
    let coding = format!("{}{vectors} kB, without prediction {} kB", kilobytes(residual_bits), kilobytes(frame_bits));
    let sent = if vector_bits.is_some() { "Residual + vectors" } else { "Residual" };
    let facts = vec![fact("Prediction", quality), fact(sent, coding)];
    Ok(Assessment { headline, ..Assessment::default() }.with(scores(&MEASURES, values), facts))
}

/// The quality of a prediction where no motion was estimated: zero displacements would be those of no estimator.
pub(super) fn undefined() -> Assessment {
    let facts = vec![fact("Prediction", "undefined: no motion was estimated")];
    Assessment::default().with(scores(&MEASURES, [Figure::Undefined; 4]), facts)
}
