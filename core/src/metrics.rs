//! How good an estimate is: endpoint and angular error against truth, PSNR of a prediction.

use crate::{Error, Flow, Gray};

/// Errors of a flow against truth, over the pixels where both are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowError {
    /// Mean endpoint error in px (Baker et al. 2011).
    pub epe_px: f64,
    /// Median endpoint error in px.
    pub epe_median_px: f64,
    /// Mean angular error in degrees between (u, v, 1) and the truth (Barron, Fleet and Beauchemin 1994).
    pub aae_deg: f64,
    /// Pixels compared.
    pub known: usize,
}

/// Compares `flow` with `truth`; `None` if no pixel is known in both.
///
/// # Errors
/// If the sizes differ.
pub fn flow_error(flow: &Flow, truth: &Flow) -> Result<Option<FlowError>, Error> {
    if flow.0.size() != truth.0.size() {
        let ((w, h), (tw, th)) = (flow.0.size(), truth.0.size());
        return Err(Error::new(format!("the flow is {w}×{h} and its truth {tw}×{th}; they must have one size")));
    }
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
    Ok(Some(FlowError { epe_px, epe_median_px: median(&mut endpoints), aae_deg, known }))
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
    use crate::Grid;

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
    fn psnr_is_the_textbook_one() {
        let (a, b) = (Grid::new(4, 4, 10), Grid::new(4, 4, 15));
        let psnr = psnr_db(&a, &b).unwrap();
        assert!((psnr - 20.0 * (255.0f64 / 5.0).log10()).abs() < 1e-12);
        assert_eq!(psnr_db(&a, &a).unwrap(), f64::INFINITY);
    }
}
