//! Errors of a scene flow against the truth.

use std::sync::Arc;

use super::SceneFlowField;
use crate::base::Error;
use crate::data::{Disparity, Flow, Measured, PixelClass, TrueMask};
use crate::products::Reference;

/// Errors of a scene flow; unknown where there is no truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SceneFlowError {
    /// Mean endpoint error in m over the pixels with known truth and an estimate.
    pub epe_m: Option<f64>,
    /// Median endpoint error in percent of the true depth.
    pub median_percent: Option<f64>,
    /// Share of the pixels with known truth at which a disparity or the flow is wrong by more than 3 px and by more than 5 %.
    pub sf: Option<f64>,
    /// Errors of rotation in rad and translation of the camera in m.
    pub ego: Option<[f64; 2]>,
    /// F-measure of the pixels with a motion of their own.
    pub own_motion_f1: Option<f64>,
}

/// The true disparities and flow of a pair of frames.
struct Known {
    disparity: Arc<Disparity>,
    flow: Arc<Flow>,
    next: Arc<Disparity>,
}

impl Known {
    /// The truth of the size of `field`, if there is one.
    fn of(field: &SceneFlowField, reference: &Reference<'_>) -> Result<Option<Self>, Error> {
        let (Some(truth), t) = (reference.clip.truth(), reference.frame) else { return Ok(None) };
        let all = (truth.disparity(t)?, truth.flow(t)?, truth.next_disparity(t)?);
        let (Some(disparity), Some(flow), Some(next)) = all else { return Ok(None) };
        let fits = [disparity.0.size(), flow.0.size(), next.0.size()].iter().all(|size| *size == field.size());
        Ok(fits.then_some(Self { disparity, flow, next }))
    }

    fn measured(&self, (x, y): (usize, usize)) -> Option<Measured> {
        Some(Measured {
            pixel: [x as f64, y as f64],
            disparity: self.disparity.at(x, y)?.into(),
            flow: self.flow.at(x, y)?.map(f64::from),
            next_disparity: self.next.at(x, y)?.into(),
        })
    }
}

/// Whether a value of this error is an outlier of the KITTI benchmark.
fn is_outlier(error: f64, truth: f64) -> bool {
    error > 3.0 && error > 0.05 * truth.abs()
}

/// The endpoint error of the scene flow of a pixel in m with the true depth in m.
fn endpoint(field: &SceneFlowField, known: &Known, pixel: (usize, usize)) -> Option<[f64; 2]> {
    let truth = known.measured(pixel)?.in_space(field.calibration.as_ref()?)?;
    let (found, expected) = (field.motion(pixel)?.displacement(), truth.displacement());
    let squared: f64 = (0..3).map(|i| (found[i] - expected[i]).powi(2)).sum();
    Some([squared.sqrt(), truth.from[2]])
}

/// Compares a scene flow with the known truth of its pair of frames.
///
/// # Errors
/// If the truth is there but cannot be read.
pub fn scene_flow_error(field: &SceneFlowField, reference: &Reference<'_>) -> Result<SceneFlowError, Error> {
    let Some(truth) = reference.clip.truth() else { return Ok(SceneFlowError::default()) };
    let mut error = SceneFlowError::default();
    if let (Some(found), Some(expected)) = (&field.ego, truth.ego_motion(reference.frame)?) {
        let [rotation, translation] = expected.motion_to(&found.pose);
        error.ego = Some([rotation, translation].map(|c| c.iter().map(|c| c * c).sum::<f64>().sqrt()));
    }
    if let (Some(moving), Some(mask)) = (&field.moving, truth.foreground(reference.frame)?) {
        error.own_motion_f1 = f_measure(field, &mask, |x, y| moving.get(x, y));
    }
    let Some(known) = Known::of(field, reference)? else { return Ok(error) };
    let ends: Vec<_> = field.pixels().filter_map(|pixel| endpoint(field, &known, pixel)).collect();
    if !ends.is_empty() {
        error.epe_m = Some(ends.iter().map(|[off, _]| off).sum::<f64>() / ends.len() as f64);
        let mut shares: Vec<f64> = ends.iter().map(|[off, depth]| 100.0 * off / depth).collect();
        let middle = shares.len() / 2;
        error.median_percent = Some(*shares.select_nth_unstable_by(middle, f64::total_cmp).1);
    }
    let compared: Vec<_> = field.pixels().filter_map(|pixel| Some((pixel, known.measured(pixel)?))).collect();
    let is_wrong = |(pixel, truth): &((usize, usize), Measured)| {
        field.measured(*pixel).is_none_or(|found| {
            let off = (0..2).map(|i| (found.flow[i] - truth.flow[i]).powi(2)).sum::<f64>().sqrt();
            is_outlier(off, truth.flow[0].hypot(truth.flow[1]))
                || is_outlier((found.disparity - truth.disparity).abs(), truth.disparity)
                || is_outlier((found.next_disparity - truth.next_disparity).abs(), truth.next_disparity)
        })
    };
    let wrong = compared.iter().filter(|pixel| is_wrong(pixel)).count();
    error.sf = (!compared.is_empty()).then(|| wrong as f64 / compared.len() as f64);
    Ok(error)
}

/// The F-measure of the pixels chosen by `is_found`; `None` without any foreground in either.
fn f_measure(field: &SceneFlowField, truth: &TrueMask, is_found: impl Fn(usize, usize) -> bool) -> Option<f64> {
    if truth.0.size() != field.size() {
        return None;
    }
    let [mut hits, mut either] = [0u64; 2];
    for (x, y) in field.pixels() {
        if truth.0[(x, y)] == PixelClass::Ignored {
            continue;
        }
        let (found, expected) = (is_found(x, y), truth.0[(x, y)] == PixelClass::Foreground);
        hits += u64::from(found && expected);
        either += u64::from(found) + u64::from(expected);
    }
    (either > 0).then(|| 2.0 * hits as f64 / either as f64)
}

/// For ranges of depth of equal numbers of pixels: the mean depth in m, the root mean square error of the scene flow along the depth, and
/// its standard deviation by theory for disparities with one of `sigma_px`, σ_ΔZ² = σ_Z² + σ_Z′², both in m; nothing without truth.
pub fn depth_error(
    field: &SceneFlowField,
    reference: &Reference<'_>,
    (sigma_px, ranges): (f64, usize),
) -> Vec<[f64; 3]> {
    let known = Known::of(field, reference).ok().flatten();
    let (Some(known), Some(rig)) = (known, &field.calibration) else { return Vec::new() };
    let one = |pixel: (usize, usize)| {
        let truth = known.measured(pixel)?.in_space(rig)?;
        let off = field.motion(pixel)?.displacement()[2] - truth.displacement()[2];
        let [now, next] = [truth.from[2], truth.to[2]].map(|z| rig.depth_sigma_m(z, sigma_px));
        Some([truth.from[2], off * off, now * now + next * next])
    };
    let mut all: Vec<[f64; 3]> = field.pixels().filter_map(one).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let each = all.len().div_ceil(ranges.max(1)).max(1);
    let mean = |part: &[[f64; 3]], i: usize| part.iter().map(|row| row[i]).sum::<f64>() / part.len() as f64;
    all.chunks(each).map(|part| [mean(part, 0), mean(part, 1).sqrt(), mean(part, 2).sqrt()]).collect()
}
