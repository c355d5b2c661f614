//! How good an estimate is: endpoint and angular error against truth, PSNR of a prediction.

use crate::{Error, Flow, Gray};

/// Errors of a flow against truth, over the pixels where both are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowError {
    /// Mean endpoint error in px (Baker et al. 2011).
    pub epe_px: f64,
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
    let (mut endpoint, mut angle, mut known) = (0.0, 0.0, 0);
    for (&[u, v], &[tu, tv]) in flow.0.cells().iter().zip(truth.0.cells()) {
        if ![u, v, tu, tv].iter().all(|c| c.is_finite()) {
            continue;
        }
        let [u, v, tu, tv] = [u, v, tu, tv].map(f64::from);
        endpoint += (u - tu).hypot(v - tv);
        // atan2 of cross and dot product: exact also for small angles.
        let cross = [v - tv, tu - u, u * tv - v * tu];
        let dot = u * tu + v * tv + 1.0;
        angle += cross.iter().map(|c| c * c).sum::<f64>().sqrt().atan2(dot);
        known += 1;
    }
    let mean = |sum: f64| sum / known as f64;
    Ok((known > 0).then(|| FlowError { epe_px: mean(endpoint), aae_deg: mean(angle).to_degrees(), known }))
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
    fn psnr_is_the_textbook_one() {
        let (a, b) = (Grid::new(4, 4, 10), Grid::new(4, 4, 15));
        let psnr = psnr_db(&a, &b).unwrap();
        assert!((psnr - 20.0 * (255.0f64 / 5.0).log10()).abs() < 1e-12);
        assert_eq!(psnr_db(&a, &a).unwrap(), f64::INFINITY);
    }
}
