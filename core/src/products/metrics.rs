//! Quality measures: endpoint and angular error against the true flow, PSNR of a prediction.

use crate::base::Error;
use crate::data::Flow;
use crate::geometry::{Gray, Grid};
use crate::scene::Distribution;

/// Errors of a flow against the true flow, over the pixels where both are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowError {
    /// Mean endpoint error in px (Baker et al. 2011).
    pub epe_px: f64,
    /// Median endpoint error in px.
    pub epe_median_px: f64,
    /// 95th percentile of the endpoint error in px.
    pub epe_p95_px: f64,
    /// Shares of the pixels with an endpoint error above each of [`LIMITS_PX`].
    pub beyond: [f64; 3],
    /// Mean angular error in degrees between (u, v, 1) and the truth (Barron, Fleet and Beauchemin 1994).
    pub aae_deg: f64,
    /// Number of pixels compared.
    pub known: usize,
}

/// Thresholds of the endpoint error in px: R0.5, R1.0 and R2.0 of the Middlebury benchmark.
pub const LIMITS_PX: [f64; 3] = [0.5, 1.0, 2.0];

fn check_sizes(flow: &Flow, truth: &Flow) -> Result<(), Error> {
    if flow.0.size() != truth.0.size() {
        let ((w, h), (tw, th)) = (flow.0.size(), truth.0.size());
        return Err(Error::new(format!(
            "the flow is {w}×{h} px and the true flow {tw}×{th} px; both must have one size"
        )));
    }
    Ok(())
}

/// The endpoint error of `flow` at every pixel in px; NaN where it or the true flow is unknown.
///
/// # Errors
/// If the sizes differ.
pub fn endpoint_errors(flow: &Flow, truth: &Flow) -> Result<Grid<f32>, Error> {
    check_sizes(flow, truth)?;
    let (width, height) = flow.0.size();
    Ok(Grid::from_fn(width, height, |x, y| match (flow.at(x, y), truth.at(x, y)) {
        (Some([u, v]), Some([tu, tv])) => (u - tu).hypot(v - tv),
        _ => f32::NAN,
    }))
}

/// The distribution of the endpoint errors of a flow, with the figures of `error`.
pub fn distribution(errors: &Grid<f32>, error: &FlowError) -> Distribution {
    /// Number of bins.
    const BINS: usize = 48;
    let known = || errors.cells().iter().copied().filter(|v| v.is_finite());
    // Somewhat above the 95th percentile, so that outliers do not squeeze the bars.
    let top = nice((1.6 * error.epe_p95_px as f32).max(0.02));
    let mut counts = vec![0u32; BINS];
    let mut beyond = 0;
    for v in known() {
        match counts.get_mut((v / top * BINS as f32) as usize) {
            Some(count) => *count += 1,
            None => beyond += 1,
        }
    }
    let figures = [("mean", error.epe_px), ("median", error.epe_median_px), ("95th percentile", error.epe_p95_px)]
        .map(|(n, v)| (n, v as f32));
    Distribution {
        title: "Endpoint error",
        unit: "px",
        top,
        counts,
        beyond,
        figures: figures.to_vec(),
        shares: LIMITS_PX.iter().zip(error.beyond).map(|(limit, share)| (*limit as f32, share as f32)).collect(),
    }
}

/// The next of 1, 1.5, 2, 3, 5 or 7 times a power of ten.
fn nice(v: f32) -> f32 {
    let power = 10f32.powf(v.log10().floor());
    [1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0].into_iter().map(|step| step * power).find(|top| *top >= v).unwrap_or(v)
}

/// Compares `flow` with `truth`; `None` if no pixel is known in both.
///
/// # Errors
/// If the sizes differ.
pub fn flow_error(flow: &Flow, truth: &Flow) -> Result<Option<FlowError>, Error> {
    check_sizes(flow, truth)?;
    let (mut endpoints, mut angle) = (Vec::new(), 0.0);
    for (&[u, v], &[tu, tv]) in flow.0.cells().iter().zip(truth.0.cells()) {
        if ![u, v, tu, tv].iter().all(|c| c.is_finite()) {
            continue;
        }
        let [u, v, tu, tv] = [u, v, tu, tv].map(f64::from);
        endpoints.push((u - tu).hypot(v - tv));
        // atan2 of cross and dot product: exact also for small angles.
        let cross = [v - tv, tu - u, u * tv - v * tu];
        let dot = u * tu + v * tv + 1.0;
        angle += cross.iter().map(|c| c * c).sum::<f64>().sqrt().atan2(dot);
    }
    let known = endpoints.len();
    if known == 0 {
        return Ok(None);
    }
    let mean = |sum: f64| sum / known as f64;
    let (epe_px, aae_deg) = (mean(endpoints.iter().sum()), mean(angle).to_degrees());
    let beyond = LIMITS_PX.map(|limit| mean(endpoints.iter().filter(|error| **error > limit).count() as f64));
    let (epe_p95_px, epe_median_px) = (percentile_95(&mut endpoints), median(&mut endpoints));
    Ok(Some(FlowError { epe_px, epe_median_px, epe_p95_px, beyond, aae_deg, known }))
}

/// The value in the middle, or the mean of the two there.
fn median(values: &mut [f64]) -> f64 {
    let (middle, is_odd) = (values.len() / 2, values.len() % 2 == 1);
    let (below, &mut at, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    match is_odd {
        false => (below.iter().copied().fold(f64::NEG_INFINITY, f64::max) + at) / 2.0,
        true => at,
    }
}

/// The smallest value that at least 95 of 100 do not exceed (nearest rank).
fn percentile_95(values: &mut [f64]) -> f64 {
    let rank = (values.len() * 95).div_ceil(100).max(1);
    *values.select_nth_unstable_by(rank - 1, f64::total_cmp).1
}

/// Peak signal-to-noise ratio in dB of `prediction` for `actual`; infinite if they are equal.
///
/// # Errors
/// If the sizes differ.
pub fn psnr_db(prediction: &Gray, actual: &Gray) -> Result<f64, Error> {
    if prediction.size() != actual.size() {
        return Err(Error::new("a prediction must have the size of its picture"));
    }
    let squares: u64 =
        prediction.cells().iter().zip(actual.cells()).map(|(&a, &b)| u64::from(a.abs_diff(b)).pow(2)).sum();
    let mse = squares as f64 / prediction.cells().len() as f64;
    Ok(10.0 * (255.0 * 255.0 / mse).log10())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn errors_agree_with_hand_made_figures() {
        let flow = Flow(Grid::new(2, 1, [1.0, 0.0]));
        let mut truth = Flow(Grid::new(2, 1, [0.0, 0.0]));
        let error = flow_error(&flow, &truth).unwrap().unwrap();
        assert_eq!((error.epe_px, error.known), (1.0, 2));
        assert!((error.aae_deg - 45.0).abs() < 1e-12);
        truth.0[(0, 0)] = Flow::UNKNOWN;
        assert_eq!(flow_error(&flow, &truth).unwrap().unwrap().known, 1);
        truth.0[(1, 0)] = Flow::UNKNOWN;
        assert_eq!(flow_error(&flow, &truth).unwrap(), None);
        assert!(flow_error(&flow, &Flow(Grid::new(1, 1, [0.0; 2]))).is_err());
    }

    #[test]
    fn the_median_is_in_the_middle() {
        let truth = Flow(Grid::new(4, 1, [0.0; 2]));
        let error = |lengths: [f32; 4]| {
            let flow = Flow(Grid::from_fn(4, 1, |x, _| [lengths[x], 0.0]));
            flow_error(&flow, &truth).unwrap().unwrap().epe_median_px
        };
        assert_eq!((error([9.0, 1.0, 3.0, 2.0]), error([9.0, f32::NAN, 3.0, 2.0])), (2.5, 3.0));
    }

    #[test]
    fn shares_and_the_distribution_count_every_known_pixel() {
        let truth = Flow(Grid::new(100, 1, [0.0; 2]));
        let flow = Flow(Grid::from_fn(100, 1, |x, _| if x == 0 { Flow::UNKNOWN } else { [x as f32 / 40.0, 0.0] }));
        let error = flow_error(&flow, &truth).unwrap().unwrap();
        // Of 1/40 … 99/40: more than 20, 40 and 80 fortieths.
        assert_eq!(error.beyond, [79.0 / 99.0, 59.0 / 99.0, 19.0 / 99.0]);
        assert_eq!((error.known, error.epe_p95_px), (99, f64::from(95.0f32 / 40.0)));
        let errors = endpoint_errors(&flow, &truth).unwrap();
        assert!(errors[(0, 0)].is_nan() && errors[(40, 0)] == 1.0);
        let distribution = distribution(&errors, &error);
        assert_eq!((distribution.counts.iter().sum::<u32>() + distribution.beyond, distribution.top), (99, 5.0));
        assert_eq!(distribution.figures[1], ("median", 1.25));
    }

    #[test]
    fn psnr_is_the_textbook_one() {
        let (a, b) = (Grid::new(4, 4, 10), Grid::new(4, 4, 15));
        let psnr = psnr_db(&a, &b).unwrap();
        assert!((psnr - 20.0 * (255.0f64 / 5.0).log10()).abs() < 1e-12);
        assert_eq!(psnr_db(&a, &a).unwrap(), f64::INFINITY);
    }
}
