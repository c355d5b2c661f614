//! Scene flow: for each pixel its position in space and its displacement to the next frame.

mod error;

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::{Assessment, Cell, Measure, Motion, Product, ProductKind, Reference, Table};
use crate::base::Error;
use crate::base::words::{fixed, grouped};
use crate::data::{Calibration, Disparity, Flow, Frame, Mask, Measured, Pose, Sigma, SpaceMotion};
use crate::geometry::Grid;
use crate::scene::Fact;

pub use error::{SceneFlowError, depth_error, scene_flow_error};

/// The motion of the scene that the cameras cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EgoMotion {
    /// The rigid motion of all that is at rest from frame t to frame t + 1, in the coordinates of the left camera at each of them.
    pub pose: Pose,
    /// Number of points that agree with it.
    pub inliers: usize,
    /// Number of points on which it was estimated.
    pub points: usize,
    /// Root mean square reprojection error of the inliers in px.
    pub residual_px: f64,
}

impl EgoMotion {
    /// Whether at least half of the points agree with it. Otherwise it may be the motion of a large object.
    pub fn is_of_majority(&self) -> bool {
        2 * self.inliers >= self.points
    }

    /// The displacement of the left camera in its own coordinates of frame t, in m.
    pub fn camera_m(&self) -> [f64; 3] {
        self.pose.inverse().translation
    }
}

/// The measurements of both views at each pixel at two times, and the resulting motion in space.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFlowField {
    /// Frame t of the left view.
    pub picture: Arc<Frame>,
    /// Disparities of frame t in px.
    pub disparity: Arc<Disparity>,
    /// Flow from frame t to frame t + 1 in px.
    pub flow: Arc<Flow>,
    /// For each pixel of frame t, the disparity of its point in frame t + 1 in px.
    pub next_disparity: Arc<Disparity>,
    /// The calibration of the cameras; without it there are no positions in m.
    pub calibration: Option<Calibration>,
    /// Standard deviations of disparities and flow.
    pub sigma: Sigma,
    /// The motion of the cameras, once it is estimated.
    pub ego: Option<EgoMotion>,
    /// The pixels with a motion of their own, once they are found.
    pub moving: Option<Arc<Mask>>,
}

impl SceneFlowField {
    /// Width and height in px.
    pub fn size(&self) -> (usize, usize) {
        self.picture.size()
    }

    /// The measurements at a pixel; `None` unless all are known.
    pub fn measured(&self, (x, y): (usize, usize)) -> Option<Measured> {
        Some(Measured {
            pixel: [x as f64, y as f64],
            disparity: self.disparity.at(x, y)?.into(),
            flow: self.flow.at(x, y)?.map(f64::from),
            next_disparity: self.next_disparity.at(x, y)?.into(),
        })
    }

    /// The motion of a pixel in space, if it is known.
    pub fn motion(&self, pixel: (usize, usize)) -> Option<SpaceMotion> {
        self.measured(pixel)?.in_space(self.calibration.as_ref()?)
    }

    /// The position of a pixel in frame t in m, if it is known.
    pub fn position(&self, (x, y): (usize, usize)) -> Option<[f64; 3]> {
        self.calibration.as_ref()?.point_m([x as f64, y as f64], self.disparity.at(x, y)?.into())
    }

    /// All pixels in raster order.
    pub fn pixels(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (width, height) = self.size();
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    /// The median depth in m of the pixels of frame t of known depth.
    pub fn typical_depth_m(&self) -> Option<f64> {
        let mut depths: Vec<f64> = self.pixels().filter_map(|pixel| Some(self.position(pixel)?[2])).collect();
        let middle = depths.len() / 2;
        (!depths.is_empty()).then(|| *depths.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Number of pixels of known motion, in space if the cameras are calibrated.
    pub fn known(&self) -> usize {
        let is_known = |pixel: &(usize, usize)| match self.calibration {
            Some(_) => self.motion(*pixel).is_some(),
            None => self.measured(*pixel).is_some(),
        };
        self.pixels().filter(is_known).count()
    }

    /// The values of `of` at all pixels; NaN where there is none.
    pub fn grid(&self, of: impl Fn((usize, usize)) -> Option<f64>) -> Grid<f32> {
        let (width, height) = self.size();
        Grid::from_fn(width, height, |x, y| of((x, y)).map_or(f32::NAN, |value| value as f32))
    }

    fn own_facts(&self) -> Vec<Fact> {
        let (known, all) = (self.known(), self.picture.luma().cells().len());
        let share = 100.0 * known as f64 / all.max(1) as f64;
        let mut facts =
            vec![fact("Scene flow", format!("{} of {} pixels, {share:.1} %", grouped(known), grouped(all)))];
        if self.calibration.is_none() {
            facts.push(fact("Metres", "unknown: they need the focal length and the baseline of the cameras; open their calibration or type it"));
        }
        if let Some(ego) = &self.ego {
            let [x, y, z] = ego.camera_m().map(|c| fixed(c, 3));
            facts.push(fact(
                "Motion of the camera",
                format!("({x}, {y}, {z}) m, {}°", fixed(ego.pose.angle_rad().to_degrees(), 3)),
            ));
            let share = 100.0 * ego.inliers as f64 / ego.points.max(1) as f64;
            facts.push(fact(
                "Inliers",
                format!("{} of {} points, {share:.1} %", grouped(ego.inliers), grouped(ego.points)),
            ));
            facts.push(fact("Reprojection error (RMS)", format!("{} px", fixed(ego.residual_px, 3))));
        }
        let is_told = self.ego.is_none_or(|ego| ego.is_of_majority());
        if let Some(moving) = self.moving.as_ref().filter(|_| is_told) {
            let share = 100.0 * moving.count() as f64 / all.max(1) as f64;
            facts.push(fact("Motion of its own", format!("{} pixels, {share:.1} %", grouped(moving.count()))));
        } else if self.moving.is_some() {
            facts.push(fact(
                "Motion of its own",
                "unknown: less than half of the points agree with the motion of the cameras",
            ));
        }
        facts
    }
}

const MEASURES: [Measure; 8] = [
    Measure::new("scene_flow_epe_m", "Mean endpoint error of the scene flow in m over the pixels with known truth and an estimate.")
        .in_column("EPE m", 4).smaller_is_better()
        .against_truth(),
    Measure::new(
        "scene_flow_median_percent",
        "Median endpoint error of the scene flow in percent of the true depth, over the pixels with known truth and an estimate.",
    )
    .in_column("median error %", 2).smaller_is_better()
    .against_truth(),
    Measure::new(
        "sf_percent",
        "SF of the KITTI benchmark: percentage of the pixels with known truth at which a disparity or the flow is wrong by more than 3 px \
         and by more than 5 % of the truth, or has no estimate.",
    )
    .in_column("SF %", 2).smaller_is_better()
    .against_truth(),
    Measure::new("ego_translation_error_m", "Length of the error of the camera's displacement in m.")
        .in_column("ego m", 4).smaller_is_better()
        .against_truth(),
    Measure::new("ego_rotation_error_deg", "Angle of the error of the camera's rotation in degrees.")
        .in_column("ego °", 4).smaller_is_better()
        .against_truth(),
    Measure::new(
        "own_motion_f1",
        "F-measure of the pixels with a motion of their own against the true foreground: the harmonic mean of precision and recall. A pixel \
         without scene flow counts as one at rest.",
    )
    .in_column("own motion F", 3).larger_is_better()
    .against_truth(),
    Measure::new("ego_residual_px", "Root mean square reprojection error of the points that agree with the motion of the cameras, in px.")
        .in_column("reprojection px", 3),
    Measure::new("scene_flow_coverage", "Share of the pixels that have a scene flow.").in_percent("scene flow coverage %", "scene_flow_coverage_percent"),
];

impl Product for SceneFlowField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "scene-flow",
        name: "Scene flow",
        summary: "For each pixel its position in space, and its displacement in space to the next frame.",
        motion: Motion::Nowhere,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&MEASURES],
    };

    /// The measurements at the pixels of known motion in raster order, and with calibrated cameras position, displacement, the standard
    /// deviation of the depth, and whether the pixel has a motion of its own.
    fn table(&self) -> Option<Table> {
        let own = |pixel: (usize, usize)| self.moving.as_ref().map(|moving| usize::from(moving.get(pixel.0, pixel.1)));
        let measured = |(x, y): (usize, usize), m: &Measured| -> [Cell; 6] {
            let [u, v] = m.flow;
            [x.into(), y.into(), Cell::Real(m.disparity), Cell::Real(u), Cell::Real(v), Cell::Real(m.next_disparity)]
        };
        let known = self.pixels().filter_map(|pixel| Some((pixel, self.measured(pixel)?)));
        let columns = ["x_px", "y_px", "disparity_px", "u_px", "v_px", "next_disparity_px"];
        let Some(rig) = &self.calibration else {
            return Some(Table::new(columns, known.map(|(pixel, m)| measured(pixel, &m))));
        };
        let [x, y, d, u, v, next] = columns;
        let columns = [x, y, d, u, v, next, "x_m", "y_m", "z_m", "dx_m", "dy_m", "dz_m", "sigma_z_m", "own_motion"];
        let row = |(pixel, m): ((usize, usize), Measured)| -> Option<[Cell; 14]> {
            let motion = m.in_space(rig)?;
            let [a, b, c, d, e, f] = measured(pixel, &m);
            let ([x, y, z], [u, v, w]) = (motion.from, motion.displacement());
            let sigma = rig.depth_sigma_m(z, self.sigma.disparity_px);
            let own = own(pixel).map_or(Cell::Empty, Into::into);
            let [x, y, z, u, v, w, sigma] = [x, y, z, u, v, w, sigma].map(Cell::Real);
            Some([a, b, c, d, e, f, x, y, z, u, v, w, sigma, own])
        };
        Some(Table::new(columns, known.filter_map(row)))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let coverage = self.known() as f64 / self.picture.luma().cells().len().max(1) as f64;
        let compared = scene_flow_error(self, reference);
        let (error, truth_error) = match compared {
            Ok(error) => (error, None),
            Err(error) => (SceneFlowError::default(), Some(error)),
        };
        let values = [
            error.epe_m.into(),
            error.median_percent.into(),
            error.sf.map(|share| 100.0 * share).into(),
            error.ego.map(|ego| ego[1]).into(),
            error.ego.map(|ego| ego[0].to_degrees()).into(),
            error.own_motion_f1.into(),
            self.ego.map(|ego| ego.residual_px).into(),
            coverage.into(),
        ];
        let mut facts = Vec::new();
        facts.extend(error.epe_m.map(|epe| fact("Mean error of the scene flow", format!("{} m", fixed(epe, 3)))));
        facts.extend(
            error.median_percent.map(|share| fact("Median error", format!("{} % of the depth", fixed(share, 2)))),
        );
        facts.extend(error.sf.map(|share| fact("SF", format!("{} %", fixed(100.0 * share, 1)))));
        facts.extend(error.ego.map(|[angle, length]| {
            fact("Error of the camera's motion", format!("{} m, {}°", fixed(length, 4), fixed(angle.to_degrees(), 4)))
        }));
        facts.extend(error.own_motion_f1.map(|f1| fact("Own motion, F-measure", fixed(f1, 3))));
        if error == SceneFlowError::default() {
            facts.push(fact("Scene flow error", "unknown: no true scene flow for this pair of frames"));
        }
        let headline = match (error.median_percent, &self.ego) {
            (Some(share), _) => format!("median error {} % of the depth", fixed(share, 2)),
            (None, Some(ego)) => {
                format!("camera moved {} m", fixed(ego.camera_m().iter().map(|c| c * c).sum::<f64>().sqrt(), 3))
            }
            (None, None) => format!("{:.1} % of the pixels", 100.0 * coverage),
        };
        let assessment = Assessment { headline, truth_error, ..Assessment::default() };
        Ok(assessment.with(scores(&MEASURES, values), facts).with(Vec::new(), self.own_facts()))
    }
}
