//! One region that is tracked through a clip, and its scores against the true box of the object.

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::{
    Assessment, Cell, Figure, Followed, Measure, Motion, Object, ObjectField, ObjectFrame, Product, ProductKind,
    Reference, Table, TrackStatus, Watched,
};
use crate::base::{
    Error,
    words::{counted, grouped},
};
use crate::data::Clip;
use crate::geometry::Bounds;

/// An ellipse, or an upright box where it is not turned, in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Region {
    /// Its centre in px.
    pub center: [f32; 2],
    /// Its extent along both axes in px.
    pub size: [f32; 2],
    /// Angle of the first axis, from x towards y, in radians.
    pub angle_rad: f32,
}

impl From<Bounds> for Region {
    fn from(bounds: Bounds) -> Self {
        Self { center: bounds.center(), size: bounds.size(), angle_rad: 0.0 }
    }
}

impl Region {
    /// The box around its ellipse.
    pub fn bounds(&self) -> Bounds {
        let (sin, cos) = self.angle_rad.sin_cos();
        let [a, b] = self.size;
        Bounds::around(self.center, [(a * cos).hypot(b * sin), (a * sin).hypot(b * cos)])
    }

    /// The same region elsewhere.
    #[must_use]
    pub fn at(self, center: [f32; 2]) -> Self {
        Self { center, ..self }
    }

    /// The same region `factor` times as large.
    #[must_use]
    pub fn scaled(self, factor: f32) -> Self {
        Self { size: self.size.map(|side| factor * side), ..self }
    }
}

/// The result of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RegionFrame {
    /// The region.
    pub region: Region,
    /// Its similarity to the model, a quantity of the tracker.
    pub similarity: f32,
    /// Whether the tracker reports the object as lost, so that the region is not an estimate of this frame.
    pub is_lost: bool,
}

/// A region in every frame of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame, in which the region was given.
    pub first: usize,
    /// The identity of the true object that it was given on, where that is known.
    pub object: Option<u32>,
    /// The regions of the first frame and of those that follow.
    pub frames: Vec<RegionFrame>,
}

/// How much of a true object can be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sight {
    /// This share of it, above 0.
    Seen(f32),
    /// Nothing: it has a box, but is hidden.
    Hidden,
    /// The truth has no box of it.
    Absent,
}

/// The comparison of a region with the true box in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionError {
    /// The frame.
    pub frame: usize,
    /// The true box.
    pub truth: Bounds,
    /// The box around the region.
    pub bounds: Bounds,
    /// Intersection over union of both boxes.
    pub overlap: f64,
    /// Distance of their centres in px.
    pub center_px: f64,
    /// Whether the tracker reports the object as lost there: the region is only where it was last.
    pub is_lost: bool,
}

impl RegionError {
    /// The overlap that counts: a region that the tracker itself disowns has none.
    pub fn scored_overlap(&self) -> f64 {
        if self.is_lost { 0.0 } else { self.overlap }
    }
}

/// The scores of all frames (Wu, Lim and Yang 2013).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionScores {
    /// Number of frames with a true box that is not hidden, without the first.
    pub frames: usize,
    /// Number of those in which the object is not reported as lost.
    pub held: usize,
    /// Mean overlap.
    pub overlap: f64,
    /// Area under the success curve.
    pub success: f64,
    /// Share of the frames with a centre error of at most [`NEAR_PX`].
    pub precision: f64,
    /// Mean centre error in px over the frames in which the object is not reported as lost; NaN without any.
    pub center_px: f64,
    /// Number of times that the overlap of the box fell to 0, whether it is reported as lost or not.
    pub failures: usize,
}

/// The largest centre error of a precise frame, in px.
pub const NEAR_PX: f64 = 20.0;
/// Steps of the overlap threshold of the success curve from 0 to 1.
const STEPS: usize = 20;

const OWN: [Measure; 2] = [
    Measure::new("frames", "Frames that were processed."),
    Measure::new("lost_frames", "Frames in which the tracker reports the object as lost.").in_column("lost frames", 0),
];

const SCORES: [Measure; 6] = [
    Measure::new(
        "mean_overlap",
        "Mean intersection over union with the true box; 0 in frames in which the object is reported as lost.",
    )
    .in_column("mean IoU", 3)
    .larger_is_better()
    .against_truth(),
    Measure::new(
        "success_auc",
        "Area under the success curve: the mean share of frames whose overlap exceeds a threshold of 0 to 1.",
    )
    .in_column("success", 3)
    .larger_is_better(),
    Measure::new("precision_20_px", "Share of the frames with a centre error of at most 20 px.")
        .in_column("precision", 3)
        .larger_is_better(),
    Measure::new(
        "center_error_px",
        "Mean distance of the centre from that of the true box in px, where the object is not reported as lost.",
    )
    .in_column("centre error px", 2)
    .smaller_is_better(),
    Measure::new("failures", "How often the overlap of the box with the true one fell to 0, reported as lost or not.")
        .in_column("failures", 0)
        .smaller_is_better(),
    Measure::new("judged_frames", "Frames with a true box that is at least partly visible, without the first."),
];

impl RegionField {
    /// The comparison with the true boxes, without the first frame; empty where the object is not known.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    pub fn errors(&self, clip: &Clip) -> Result<Vec<RegionError>, Error> {
        let all = (1..self.frames.len()).map(|index| self.error_of(clip, index));
        all.filter_map(Result::transpose).collect()
    }

    /// The comparison of frame `index` of the run with its true box, if the object is known and visible there.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    pub fn error_of(&self, clip: &Clip, index: usize) -> Result<Option<RegionError>, Error> {
        let Some((truth, id)) = clip.truth().zip(self.object) else { return Ok(None) };
        clip.wanted()?;
        let t = self.first + index;
        let objects = truth.objects(t)?.unwrap_or_default();
        let visible = objects.iter().find(|object| object.id == id && object.visibility > 0.0);
        Ok(visible.zip(self.frames.get(index)).map(|(object, frame)| error(t, frame, object.into())))
    }

    /// How much of the object can be seen in frame `index` of the run, if the truth says so.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    pub fn sight(&self, clip: &Clip, index: usize) -> Result<Option<Sight>, Error> {
        let Some((truth, id)) = clip.truth().zip(self.object) else { return Ok(None) };
        clip.wanted()?;
        let Some(objects) = truth.objects(self.first + index)? else { return Ok(None) };
        Ok(Some(match objects.iter().find(|object| object.id == id) {
            Some(object) if object.visibility > 0.0 => Sight::Seen(object.visibility),
            Some(_) => Sight::Hidden,
            None => Sight::Absent,
        }))
    }

    /// The region as a track of one object, with the same boxes in each frame.
    pub fn objects(&self) -> ObjectField {
        let object = |frame: &RegionFrame| Object {
            id: 1,
            bounds: frame.region.bounds(),
            status: if frame.is_lost { TrackStatus::Coasting } else { TrackStatus::Confirmed },
            position: frame.region.center.map(f64::from),
            velocity: None,
            covariance: None,
            detection: None,
        };
        let frame = |frame| Arc::new(ObjectFrame { objects: vec![object(frame)], ..ObjectFrame::default() });
        ObjectField {
            followed: Followed::One(self.object.into_iter().collect()),
            picture: self.picture,
            first: self.first,
            frames: self.frames.iter().map(frame).collect(),
            trajectories: Vec::new(),
            watched: Watched::default(),
        }
    }
}

fn error(frame: usize, RegionFrame { region, is_lost, .. }: &RegionFrame, truth: Bounds) -> RegionError {
    let (bounds, at) = (region.bounds(), truth.center());
    let off = [0, 1].map(|i| f64::from(region.center[i] - at[i]));
    RegionError {
        frame,
        truth,
        bounds,
        overlap: bounds.iou(&truth).into(),
        center_px: off[0].hypot(off[1]),
        is_lost: *is_lost,
    }
}

/// The area of the box around a region as a multiple of the true box.
pub(crate) fn area_ratio(of: &RegionError) -> f64 {
    f64::from(of.bounds.area()) / f64::from(of.truth.area())
}

/// The share of the true box that a region covers.
pub fn covered(of: &RegionError) -> f64 {
    // From the overlap I / (A + B − I) with the areas A and B.
    let both = f64::from(of.bounds.area()) + f64::from(of.truth.area());
    of.overlap * both / (1.0 + of.overlap) / f64::from(of.truth.area())
}

impl RegionScores {
    /// The scores of compared frames; `None` without any.
    pub fn of(errors: &[RegionError]) -> Option<Self> {
        if errors.is_empty() {
            return None;
        }
        let mean = |of: &dyn Fn(&RegionError) -> f64| errors.iter().map(of).sum::<f64>() / errors.len() as f64;
        let curve = success(errors);
        let held: Vec<f64> = errors.iter().filter(|error| !error.is_lost).map(|error| error.center_px).collect();
        // The region starts on the object.
        let overlaps = std::iter::once(1.0).chain(errors.iter().map(|error| error.overlap));
        let fell = |(before, now): &(f64, f64)| *before > 0.0 && *now == 0.0;
        Some(Self {
            frames: errors.len(),
            held: held.len(),
            overlap: mean(&RegionError::scored_overlap),
            success: curve.iter().map(|[_, share]| share).sum::<f64>() / curve.len() as f64,
            precision: mean(&|error| f64::from(u8::from(!error.is_lost && error.center_px <= NEAR_PX))),
            center_px: held.iter().sum::<f64>() / held.len() as f64,
            failures: overlaps.clone().zip(overlaps.skip(1)).filter(fell).count(),
        })
    }
}

/// The success curve: for overlap thresholds from 0 to 1, the share of frames above them.
pub fn success(errors: &[RegionError]) -> Vec<[f64; 2]> {
    let share = |threshold: f64| {
        errors.iter().filter(|error| error.scored_overlap() > threshold).count() as f64 / errors.len().max(1) as f64
    };
    (0..=STEPS).map(|i| i as f64 / STEPS as f64).map(|threshold| [threshold, share(threshold)]).collect()
}

impl Product for RegionField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "region",
        name: "Tracked region",
        summary: "The region of one object in every frame.",
        motion: Motion::Nowhere,
        is_of_single_frames: true,
        has_pictures: false,
        measures: &[&OWN, &SCORES],
    };

    /// One row for each frame; the edge of the first pixel lies at −0.5 px.
    fn table(&self) -> Option<Table> {
        let columns = [
            "frame",
            "x_px",
            "y_px",
            "axis_px",
            "other_axis_px",
            "angle_deg",
            "left_px",
            "top_px",
            "width_px",
            "height_px",
            "similarity",
            "status",
        ];
        let row = |(i, frame): (usize, &RegionFrame)| -> [Cell; 12] {
            let Region { center: [x, y], size: [a, b], angle_rad } = frame.region;
            let bounds = frame.region.bounds();
            let ([left, top], [width, height]) = (bounds.min, bounds.size());
            let numbers = [x, y, a, b, angle_rad.to_degrees(), left, top, width, height, frame.similarity];
            let [x, y, a, b, angle, left, top, width, height, similarity] = numbers.map(Cell::Single);
            let status = Cell::Word(if frame.is_lost { "lost" } else { "tracked" });
            [(self.first + i).into(), x, y, a, b, angle, left, top, width, height, similarity, status]
        };
        Some(Table::new(columns, self.frames.iter().enumerate().map(row)))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let lost = self.frames.iter().filter(|frame| frame.is_lost).count();
        let values = [self.frames.len(), lost].map(Figure::from);
        let facts =
            vec![fact("Frames", format!("{}, reported as lost in {}", grouped(self.frames.len()), grouped(lost)))];
        let own = Assessment::default().with(scores(&OWN, values), facts);
        let compared = self.errors(reference.clip);
        reference.clip.wanted()?;
        Ok(match compared {
            Ok(errors) => own.and(RegionScores::of(&errors).map(told).unwrap_or_default()),
            Err(error) => own.and(Assessment {
                facts: vec![fact("Scores", format!("unknown: {error}"))],
                truth_error: Some(error),
                ..Assessment::default()
            }),
        })
    }

    fn last_frame(&self) -> Option<usize> {
        Some(self.first + self.frames.len().saturating_sub(1))
    }
}

fn told(of: RegionScores) -> Assessment {
    let RegionScores { frames, held, overlap, success, precision, center_px, failures } = of;
    let values =
        [overlap.into(), success.into(), precision.into(), center_px.into(), failures.into(), Figure::from(frames)];
    // A loss that is reported counts as an overlap of 0 and as imprecise, but has no centre.
    let over = format!("over {}", counted(frames, "frame"));
    let lost = match frames - held {
        0 => over.clone(),
        1 => format!("{over}; 1 reported as lost counts as 0"),
        lost => format!("{over}; {} reported as lost count as 0", grouped(lost)),
    };
    let center = match held {
        0 => "undefined: all frames are reported as lost".into(),
        _ if held < frames => {
            format!("{center_px:.2} px over {}, without those reported as lost", counted(held, "frame"))
        }
        _ => format!("{center_px:.2} px {over}"),
    };
    let facts = vec![
        fact("Mean overlap (IoU)", format!("{overlap:.3} {lost}")),
        fact("Success (area under the curve)", format!("{success:.3} {lost}")),
        fact("Precision at 20 px", format!("{precision:.3} {lost}")),
        fact("Mean centre error", center),
        fact("Failures", grouped(failures)),
    ];
    let headline = format!("mean overlap {overlap:.3}, success {success:.3}, precision {precision:.3} at 20 px");
    Assessment { headline, ..Assessment::default() }.with(scores(&SCORES, values), facts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_at(x: f32) -> Bounds {
        Bounds { min: [x, 0.0], max: [x + 10.0, 10.0] }
    }

    fn found(bounds: Bounds) -> RegionFrame {
        RegionFrame { region: bounds.into(), similarity: 1.0, is_lost: false }
    }

    #[test]
    fn a_region_that_is_reported_as_lost_has_no_overlap() {
        let lost = RegionFrame { is_lost: true, ..found(box_at(0.0)) };
        let errors = [error(1, &found(box_at(0.0)), box_at(0.0)), error(2, &lost, box_at(0.0))];
        let of = RegionScores::of(&errors).expect("frames");
        assert_eq!((of.overlap, of.precision, of.center_px, of.failures), (0.5, 0.5, 0.0, 0));
        let facts = told(of).facts;
        assert!(facts[1].value.ends_with("over 2 frames; 1 reported as lost counts as 0"), "{facts:?}");
        assert!(facts[3].value.ends_with("over 1 frame, without those reported as lost"), "{facts:?}");
        assert!(RegionScores::of(&errors[1..]).is_some_and(|of| of.center_px.is_nan() && of.overlap == 0.0));
    }

    #[test]
    fn scores_are_those_of_the_definition() {
        // Overlaps of 1, 1/3 and 0, and 0 again, which is one failure.
        let errors: Vec<_> =
            [0.0, 5.0, 10.0, 40.0].map(|x| error(1, &found(box_at(x)), box_at(0.0))).into_iter().collect();
        let of = RegionScores::of(&errors).expect("frames");
        assert!((of.overlap - (1.0 + 1.0 / 3.0) / 4.0).abs() < 1e-6);
        assert_eq!((of.frames, of.failures, of.precision, of.center_px), (4, 1, 0.75, 13.75));
        // Above 0 to 0.30 are two frames (7 thresholds), above 0.35 to 0.95 one (13), above 1 none.
        assert!((of.success - (7.0 * 0.5 + 13.0 * 0.25) / 21.0).abs() < 1e-9, "{}", of.success);
        assert_eq!(RegionScores::of(&[]), None);
    }

    #[test]
    fn an_overlap_is_told_apart_by_areas() {
        let large = Bounds { min: [-10.0, -10.0], max: [20.0, 20.0] };
        let around = error(1, &found(large), box_at(0.0));
        assert!((area_ratio(&around) - 9.0).abs() < 1e-6 && (covered(&around) - 1.0).abs() < 1e-6, "{around:?}");
        let beside = error(1, &found(box_at(7.0)), box_at(0.0));
        assert!((area_ratio(&beside) - 1.0).abs() < 1e-6 && (covered(&beside) - 0.3).abs() < 1e-6, "{beside:?}");
    }

    #[test]
    fn a_turned_ellipse_has_the_box_around_it() {
        let upright = Region { center: [5.0, 6.0], size: [8.0, 4.0], angle_rad: 0.0 };
        assert_eq!(Region::from(upright.bounds()), upright);
        let quarter = Region { angle_rad: std::f32::consts::FRAC_PI_2, ..upright }.bounds().size();
        assert!((quarter[0] - 4.0).abs() < 1e-4 && (quarter[1] - 8.0).abs() < 1e-4);
        let circle = Region { size: [6.0; 2], angle_rad: 0.7, ..upright }.bounds().size();
        assert!(circle.iter().all(|side| (side - 6.0).abs() < 1e-4), "a circle has no direction");
    }
}
