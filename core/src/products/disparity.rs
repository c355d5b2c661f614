//! Disparity: the shift of each pixel of the left view to the right view.

mod swapped;

use super::assessment::{fact, scores};
use super::{
    Assessment, Cell, Figure, FlowError, Measure, Motion, Product, ProductKind, Reference, Score, Table, metrics,
};
use crate::base::Error;
use crate::base::words::{fixed, grouped};
use crate::data::{Calibration, Disparity, Flow, Mask, Viewpoint};
use crate::geometry::Grid;
use crate::scene::Fact;

pub use swapped::{Signs, signs};

/// The disparities of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct DisparityField {
    /// Disparities in px; unknown where there is no estimate, or none yet.
    pub map: Disparity,
    /// The calibration of the cameras, if it is known.
    pub calibration: Option<Calibration>,
    /// Number of disparities searched, from 0 px up.
    pub candidates: usize,
    /// The pixels whose disparity was filled in from others around them; the rest was measured.
    pub filled: Option<Mask>,
}

/// Errors of disparities against the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisparityError {
    /// Mean absolute error in px over the pixels with known truth and an estimate.
    pub epe_px: f64,
    /// Share of the pixels with known truth that are wrong by more than 1 px, or have no estimate.
    pub bad1: f64,
    /// Share of the pixels with known truth that are wrong by more than 3 px, or have no estimate.
    pub bad3: f64,
    /// Share of the pixels with known truth that are wrong by more than 3 px and by more than 5 % of the truth, or have no estimate.
    pub d1: f64,
    /// Number of pixels with known truth and an estimate.
    pub compared: usize,
    /// Number of pixels with known truth.
    pub known: usize,
    /// Number of pixels with known truth whose partner lies beside the right view, which no method can match: x < d.
    pub without_partner: usize,
    /// Share of the other pixels with known truth that are wrong by more than 3 px, or have no estimate; `None` if there are none.
    pub bad3_with_partner: Option<f64>,
    /// Share of the pixels with known truth and an estimate that are wrong by more than 3 px.
    pub bad3_compared: f64,
}

const MEASURES: [Measure; 8] = [
    Measure::new("epe_px", "Mean absolute error of the disparity in px over the pixels with known truth and an estimate.")
        .in_column("EPE px", 3).smaller_is_better()
        .against_truth(),
    Measure::new(
        "bad1",
        "Share of the pixels with known truth whose disparity is wrong by more than 1 px; a pixel without an estimate counts as wrong.",
    )
    .in_percent("bad 1 %", "bad1_percent").smaller_is_better()
    .against_truth(),
    Measure::new(
        "bad3_percent",
        "Percentage of the pixels with known truth whose disparity is wrong by more than 3 px; a pixel without an estimate counts as wrong.",
    )
    .in_column("bad 3 %", 1).smaller_is_better()
    .against_truth(),
    Measure::new(
        "d1_percent",
        "D1 of the KITTI benchmark: percentage of the pixels with known truth whose disparity is wrong by more than 3 px and by more than \
         5 % of the truth; a pixel without an estimate counts as wrong.",
    )
    .in_column("D1 %", 1).smaller_is_better()
    .against_truth(),
    Measure::new(
        "bad3_with_partner_percent",
        "The same of the pixels whose partner lies inside the right view: those at the left border have none.",
    )
    .in_column("bad 3 % with partner", 1).smaller_is_better()
    .against_truth(),
    Measure::new(
        "bad3_measured_percent",
        "Percentage of the measured pixels with known truth whose disparity is wrong by more than 3 px: pixels without an estimate and filled \
         ones do not count. It belongs to the share of measured pixels.",
    )
    .in_column("bad 3 % measured", 1).smaller_is_better()
    .against_truth(),
    Measure::new("measured_share", "Share of the pixels that have a measured disparity; filled ones are not measured."),
    Measure::new("disparity_coverage", "Share of the pixels that have a disparity, measured or filled.").in_percent("disparity coverage %", "disparity_coverage_percent"),
];

/// Compares disparities with the truth; `None` if no pixel is known in both.
///
/// # Errors
/// If the sizes differ.
pub fn disparity_error(found: &Disparity, truth: &Disparity) -> Result<Option<DisparityError>, Error> {
    if found.0.size() != truth.0.size() {
        let ((w, h), (tw, th)) = (found.0.size(), truth.0.size());
        return Err(Error::new(format!(
            "the disparities are {w}×{h} px and the true ones {tw}×{th} px; both must have one size"
        )));
    }
    let (mut sum, mut compared, mut known) = (0.0, 0, 0);
    let [mut bad1, mut bad3, mut d1, mut without_partner, mut bad3_with_partner, mut bad3_compared] = [0; 6];
    let width = truth.0.width().max(1);
    for (place, (&found, &truth)) in found.0.cells().iter().zip(truth.0.cells()).enumerate() {
        if !truth.is_finite() {
            continue;
        }
        let (found, truth) = (f64::from(found), f64::from(truth));
        let error = if found.is_finite() { (found - truth).abs() } else { f64::INFINITY };
        known += 1;
        bad1 += usize::from(error > 1.0);
        bad3 += usize::from(error > 3.0);
        // The right view begins at −0.5 px, the edge of its first pixel.
        if (place % width) as f64 - truth < -0.5 {
            without_partner += 1;
        } else {
            bad3_with_partner += usize::from(error > 3.0);
        }
        d1 += usize::from(error > 3.0 && error > 0.05 * truth.abs());
        if error.is_finite() {
            sum += error;
            compared += 1;
            bad3_compared += usize::from(error > 3.0);
        }
    }
    if compared == 0 {
        return Ok(None);
    }
    let share = |count: usize| count as f64 / known as f64;
    let (bad1, bad3, d1) = (share(bad1), share(bad3), share(d1));
    let with_partner = known - without_partner;
    let bad3_with_partner = (with_partner > 0).then(|| bad3_with_partner as f64 / with_partner as f64);
    let epe_px = sum / compared as f64;
    let bad3_compared = bad3_compared as f64 / compared as f64;
    Ok(Some(DisparityError {
        epe_px,
        bad1,
        bad3,
        d1,
        compared,
        known,
        without_partner,
        bad3_with_partner,
        bad3_compared,
    }))
}

impl DisparityField {
    /// The depth of every pixel in m; NaN where the disparity is unknown or the point at infinity.
    ///
    /// # Errors
    /// If the calibration is missing: a sentence with the way to get it.
    pub fn depth_m(&self) -> Result<Grid<f32>, Error> {
        let calibration = self.calibration.ok_or_else(|| {
            Error::new("depths in metres need the focal length and the baseline of the cameras; open their calibration or type it")
        })?;
        let depth = |d: &f32| calibration.depth_m(f64::from(*d)).map_or(f32::NAN, |depth| depth as f32);
        Ok(self.map.0.map(|d| if d.is_finite() { depth(d) } else { f32::NAN }))
    }

    /// The measured disparities alone: unknown where one was filled in.
    fn measured(&self) -> Disparity {
        let Some(filled) = &self.filled else { return self.map.clone() };
        let (width, height) = self.map.0.size();
        let of = |x, y| if filled.get(x, y) { Disparity::UNKNOWN } else { self.map.0[(x, y)] };
        Disparity(Grid::from_fn(width, height, of))
    }

    /// The disparities as displacements (−d, 0) from the left to the right view.
    fn shifts(map: &Disparity) -> Flow {
        Flow(map.0.map(|&d| if d.is_finite() { [-d, 0.0] } else { Flow::UNKNOWN }))
    }

    /// The facts that do not need the truth.
    fn own_facts(&self, reference: &Reference<'_>) -> Result<Vec<Fact>, Error> {
        let (known, all) = (self.map.known(), self.map.0.cells().len());
        let share = 100.0 * known as f64 / all.max(1) as f64;
        let filled = match self.filled.as_ref().map_or(0, Mask::count) {
            0 => String::new(),
            filled => {
                format!("; {:.1} % measured, the rest filled", 100.0 * (known - filled) as f64 / all.max(1) as f64)
            }
        };
        let mut facts =
            vec![fact("Disparities", format!("{} of {} pixels, {share:.1} %{filled}", grouped(known), grouped(all)))];
        facts.push(match self.depth_m() {
            Ok(depths) => fact("Range of depth", depth_range(&depths)),
            Err(reason) => fact("Range of depth", format!("unknown: {reason}")),
        });
        if reference.clip.right().is_some() {
            let [left, right] = [Viewpoint::Left, Viewpoint::Right]
                .map(|viewpoint| reference.clip.frame_from(viewpoint, reference.frame));
            let signs = signs([left?.luma(), right?.luma()], self.candidates);
            facts.extend(signs.warning().map(|warning| fact("Views", warning)));
        }
        Ok(facts)
    }
}

/// The 5th and 95th percentile of the depths, which single outliers do not decide.
fn depth_range(depths: &Grid<f32>) -> String {
    let mut known: Vec<f32> = depths.cells().iter().copied().filter(|depth| depth.is_finite()).collect();
    known.sort_by(f32::total_cmp);
    let at = |percent: usize| known.get(known.len().saturating_sub(1) * percent / 100);
    match (at(5), at(95)) {
        (Some(&near), Some(&far)) => {
            format!("{} to {} m (5th to 95th percentile)", fixed(near.into(), 2), fixed(far.into(), 2))
        }
        _ => "unknown: no pixel has a disparity".into(),
    }
}

impl Product for DisparityField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "disparity",
        name: "Disparity",
        summary: "For each pixel of the left view, its shift to the right view.",
        motion: Motion::Nowhere,
        is_of_single_frames: false,
        has_pictures: true,
        measures: &[&MEASURES],
    };

    /// Position and disparity of the pixels of known disparity in raster order, with the depth if the cameras are calibrated.
    fn table(&self) -> Option<Table> {
        let (width, height) = self.map.0.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let known = places.filter_map(|(x, y)| Some((x, y, self.map.at(x, y)?)));
        Some(match &self.calibration {
            None => Table::new(["x_px", "y_px", "disparity_px"], known.map(|(x, y, d)| [x.into(), y.into(), d.into()])),
            Some(calibration) => {
                let depth = |d: f32| Cell::from(calibration.depth_m(f64::from(d)));
                let row = |(x, y, d): (usize, usize, f32)| [x.into(), y.into(), d.into(), depth(d)];
                Table::new(["x_px", "y_px", "disparity_px", "depth_m"], known.map(row))
            }
        })
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let (known, all) = (self.map.known(), self.map.0.cells().len().max(1) as f64);
        let coverage = known as f64 / all;
        let measured = (known - self.filled.as_ref().map_or(0, Mask::count)) as f64 / all;
        let unscored = |why: String, truth_error: Option<Error>| {
            let [.., own, share] = &MEASURES;
            let own = Score { measure: own, value: measured.into() };
            let share = Score { measure: share, value: coverage.into() };
            Assessment { truth_error, ..Assessment::default() }
                .with(vec![own, share], vec![fact("Disparity error", why)])
        };
        let truth = reference.clip.truth().map(|truth| truth.disparity(reference.frame)).transpose();
        let compared = truth.and_then(|truth| {
            let Some(truth) = truth.flatten() else { return Ok(None) };
            let shifts = [&self.map, &*truth].map(Self::shifts);
            let flow: Option<FlowError> = metrics::flow_error(&shifts[0], &shifts[1])?;
            let distribution = match flow {
                Some(flow) => Some(metrics::distribution(&metrics::endpoint_errors(&shifts[0], &shifts[1])?, &flow)),
                None => None,
            };
            let measured = disparity_error(&self.measured(), &truth)?;
            Ok(disparity_error(&self.map, &truth)?.map(|error| (error, measured, distribution)))
        });
        let own = self.own_facts(reference)?;
        Ok(match compared {
            Err(error) => unscored(format!("unknown: {error}"), Some(error)),
            Ok(None) => unscored("unknown: no true disparity for this frame; open one to see errors".into(), None),
            Ok(Some((error, measured_error, errors))) => {
                let DisparityError { epe_px, bad1, bad3, d1, without_partner, bad3_with_partner, .. } = error;
                let with_partner = bad3_with_partner.map(|share| 100.0 * share);
                let measured_bad3 = measured_error.map(|error| 100.0 * error.bad3_compared);
                let values: [Figure; 8] = [
                    epe_px.into(),
                    bad1.into(),
                    (100.0 * bad3).into(),
                    (100.0 * d1).into(),
                    with_partner.into(),
                    measured_bad3.into(),
                    measured.into(),
                    coverage.into(),
                ];
                let mut facts = vec![
                    fact("Mean disparity error", format!("{epe_px:.3} px")),
                    fact("Wrong by more than 1, 3 px", format!("{:.1} %, {:.1} %", 100.0 * bad1, 100.0 * bad3)),
                    fact("D1", format!("{:.1} %", 100.0 * d1)),
                    fact("Compared", format!("{} of {} pixels", grouped(error.compared), grouped(error.known))),
                ];
                if let Some(share) = with_partner.filter(|_| without_partner > 0) {
                    let without = format!("{share:.1} % wrong by more than 3 px");
                    facts.push(fact("Without the left border", without));
                }
                facts.extend(measured_error.zip(measured_bad3).map(|(error, share)| {
                    let of = grouped(error.compared);
                    fact("Measured alone", format!("{share:.1} % of {of} pixels wrong by more than 3 px"))
                }));
                let headline = format!("{:.1} % wrong by more than 3 px", 100.0 * bad3);
                Assessment { headline, errors, ..Assessment::default() }.with(scores(&MEASURES, values), facts)
            }
        }
        .with(Vec::new(), own))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(cells: &[f32]) -> Disparity {
        Disparity(Grid::from_fn(cells.len(), 1, |x, _| cells[x]))
    }

    #[test]
    fn errors_agree_with_hand_made_figures() {
        let unknown = f32::NAN;
        let truth = map(&[10.0, 10.0, 10.0, 100.0, 100.0, 10.0, unknown, 4.0]);
        let found = map(&[10.5, 12.0, 14.0, 104.0, 106.0, unknown, 5.0, 4.0]);
        let error = disparity_error(&found, &truth).unwrap().unwrap();
        // Wrong by 0.5, 2, 4, 4, 6, without an estimate, without a truth, and 0. 4 of 100 px are less than 5 %.
        assert_eq!((error.compared, error.known), (6, 7));
        assert_eq!([error.bad1, error.bad3, error.d1], [5.0 / 7.0, 4.0 / 7.0, 3.0 / 7.0]);
        assert!((error.epe_px - 16.5 / 6.0).abs() < 1e-12);
        // Partners lie inside the right view from x = 10 px on, but that of the last pixel.
        assert_eq!((error.without_partner, error.bad3_with_partner), (6, Some(0.0)));
        assert_eq!(error.bad3_compared, 3.0 / 6.0);
        assert_eq!(disparity_error(&map(&[unknown]), &map(&[3.0])).unwrap(), None);
        assert!(disparity_error(&map(&[1.0]), &map(&[1.0, 2.0])).is_err());
    }

    #[test]
    fn metres_are_refused_without_a_calibration() {
        let field =
            DisparityField { map: map(&[18.0, f32::NAN, 0.0]), calibration: None, candidates: 64, filled: None };
        let reason = field.depth_m().unwrap_err().to_string();
        assert!(reason.contains("focal length") && reason.contains("baseline"), "{reason}");
        assert_eq!(field.table().unwrap().columns(), ["x_px", "y_px", "disparity_px"]);
        let calibration = Calibration::new(300.0, 0.12, [0.0; 2]).ok();
        let known = DisparityField { calibration, ..field };
        let depths = known.depth_m().unwrap();
        assert!(depths[(0, 0)] == 2.0 && depths[(1, 0)].is_nan() && depths[(2, 0)].is_nan());
        assert_eq!(known.table().unwrap().columns().len(), 4);
    }
}
