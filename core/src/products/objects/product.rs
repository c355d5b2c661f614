//! The product of detectors and trackers: its tables, counts and scores.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::base::{Error, words::grouped};
use crate::data::Detection;
use crate::geometry::Bounds;
use crate::products::{
    Assessment, Cell, Figure, Followed, Measure, Motion, Object, ObjectField, ObjectFrame, Product, ProductKind,
    Reference, Table, TrackStatus, Watched,
    assessment::{fact, scores},
    objects::{
        score::{self, Matches, Scores},
        trajectory::{TrackPoint, Trajectory},
    },
};

const COUNTS: [Measure; 3] = [
    Measure::new("frames", "Frames that were processed."),
    Measure::new("detections", "Detections, counted in each frame.").in_column("detections", 0),
    Measure::new("objects", "Confirmed tracks.").in_column("objects", 0),
];

const WAYS: [Measure; 5] = [
    Measure::new("crossed_right", "Crossings of the lines to their right."),
    Measure::new("crossed_left", "Crossings of the lines to their left."),
    Measure::new("in_zone", "Objects that were in a zone."),
    Measure::new("dwell_frames", "Mean dwell time in the zones in frames, of the objects that were there."),
    Measure::new("unusual", "Objects with an anomalous direction of motion."),
];

const TRACKING: [Measure; 8] = [
    Measure::new("mota", "Multiple object tracking accuracy (CLEAR MOT).")
        .in_column("MOTA", 3)
        .larger_is_better()
        .against_truth(),
    Measure::new("motp", "Multiple object tracking precision, as mean intersection over union (CLEAR MOT)."),
    Measure::new("idf1", "F₁ score of identities.").in_column("IDF1", 3).larger_is_better(),
    Measure::new("hota", "Higher order tracking accuracy.").in_column("HOTA", 3).larger_is_better(),
    Measure::new("switches", "Identity switches.").in_column("switches", 0).smaller_is_better(),
    Measure::new("precision", "Share of the estimated boxes that match a true one at an IoU of 0.5."),
    Measure::new("recall", "Share of the true boxes that were matched at an IoU of 0.5."),
    Measure::new("true_objects", "True boxes, counted in each frame."),
];

impl Product for ObjectField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "objects",
        name: "Objects",
        summary: "Detections of each frame, and the tracks of objects.",
        motion: Motion::Nowhere,
        is_of_single_frames: true,
        has_pictures: false,
        measures: &[&COUNTS, &WAYS, &TRACKING],
    };

    /// One row for each position of a trajectory, if trajectories were analysed; else for each object in each frame, or for each
    /// detection if nothing is tracked. Velocities are in px/frame; the edge of the first pixel lies at −0.5 px.
    fn table(&self) -> Option<Table> {
        Some(if !self.trajectories.is_empty() {
            trajectories(self)
        } else if self.followed == Followed::Nothing {
            detections(self)
        } else {
            self.object_table()
        })
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let own = counted(self).and(ways(&self.trajectories, self.watched));
        let scored = score::scores_on(reference.clip, self);
        reference.clip.wanted()?;
        Ok(match scored {
            Ok(Some(scored)) => own.and(tracking(scored)),
            Ok(None) => own.and(self.unscored(reference)),
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

impl ObjectField {
    /// The reason why tracks have no scores although there is a truth of objects: it has no box in the frames of the run.
    fn unscored(&self, reference: &Reference<'_>) -> Assessment {
        let is_tracked = match &self.followed {
            Followed::Nothing => false,
            Followed::One(ids) => !ids.is_empty(),
            Followed::All => true,
        };
        let truth = reference.clip.truth().filter(|_| is_tracked);
        let has_truth = truth.is_some_and(|truth| truth.objects(self.first).is_ok_and(|objects| objects.is_some()));
        if !has_truth {
            return Assessment::default();
        }
        let last = self.first + self.frames.len().saturating_sub(1);
        let why = format!(
            "the ground truth has no box in frames {} to {last}, so the tracks are not scored; check that its frames are those of the clip",
            self.first
        );
        Assessment {
            facts: vec![fact("Scores", format!("undefined: {why}"))],
            truth_warning: Some(Error::new(why)),
            ..Assessment::default()
        }
    }
}

fn counted(field: &ObjectField) -> Assessment {
    let confirmed = |frame: &Arc<ObjectFrame>| {
        let confirmed = frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed);
        confirmed.map(|object| object.id).collect::<Vec<_>>()
    };
    let objects = field.frames.iter().flat_map(confirmed).collect::<BTreeSet<u32>>().len();
    let detections: usize = field.frames.iter().map(|frame| frame.detections.len()).sum();
    let frames = field.frames.len();
    let [tracks, from, of] = [objects, detections, frames].map(grouped);
    let text = format!("{tracks}, from {from} detections in {of} frames");
    // If frames are processed one by one, there are no tracks to count.
    let objects = (field.followed != Followed::Nothing).then_some(objects);
    let values = [frames.into(), detections.into(), objects.into()];
    let counted = match field.followed {
        Followed::Nothing => fact("Detections", format!("{from} in {of} frames")),
        _ => fact("Tracks", text),
    };
    Assessment::default().with(scores(&COUNTS, values), vec![counted])
}

/// The counts of lines, zones and anomalous directions, where trajectories were analysed.
fn ways(all: &[Arc<Trajectory>], Watched { lines, zones }: Watched) -> Assessment {
    if all.is_empty() && lines + zones == 0 {
        return Assessment::default();
    }
    let crossed = |to_right: bool| {
        all.iter().flat_map(|of| &of.crossings).filter(|crossing| crossing.is_forward == to_right).count()
    };
    let dwells: Vec<usize> = all.iter().map(|of| of.dwell_frames()).filter(|frames| *frames > 0).collect();
    let is_unusual = |of: &&Arc<Trajectory>| of.sightings.iter().any(|seen| seen.anomaly.is_some());
    let (right, left) = (crossed(true), crossed(false));
    let dwell = (!dwells.is_empty()).then(|| dwells.iter().sum::<usize>() as f64 / dwells.len() as f64);
    let unusual = all.iter().filter(is_unusual).count();
    let mut facts = Vec::new();
    if lines > 0 {
        facts.push(fact("Line crossings", crossings(all, lines)));
    }
    if let Some(frames) = dwell {
        let objects = if dwells.len() == 1 { "object" } else { "objects" };
        let told = format!("{} {objects}, {frames:.1} frames on average", grouped(dwells.len()));
        facts.push(fact(if zones > 1 { "Dwell in zones" } else { "Dwell in zone" }, told));
    }
    if unusual > 0 {
        facts.push(fact("Anomalous", format!("{} by direction", grouped(unusual))));
    }
    // Without a line or a zone the counts are undefined, not 0.
    let of_line = |count: usize| (lines > 0).then_some(count);
    let inside = (zones > 0).then_some(dwells.len());
    let values = [of_line(right).into(), of_line(left).into(), inside.into(), dwell.into(), unusual.into()];
    Assessment::default().with(scores(&WAYS, values), facts)
}

/// The crossings of each line in words; of the only one without its number.
fn crossings(all: &[Arc<Trajectory>], lines: usize) -> String {
    let of_line = |line: usize| {
        let crossed = |to_right: bool| {
            let of = all.iter().flat_map(|of| &of.crossings);
            grouped(of.filter(|crossing| crossing.line == line && crossing.is_forward == to_right).count())
        };
        let text = format!("{} to the right, {} to the left", crossed(true), crossed(false));
        if lines > 1 { format!("line {}: {text}", line + 1) } else { text }
    };
    (0..lines).map(of_line).collect::<Vec<_>>().join("; ")
}

fn tracking(of: Scores) -> Assessment {
    let Scores { truths, hypotheses, matches, switches, mota, idf1, recall, hota, greedy, .. } = of;
    // Undefined is not zero.
    let motp = (matches > 0).then_some(of.motp);
    let precision = (hypotheses > 0).then_some(of.precision);
    let values = [Some(mota), motp, Some(idf1), Some(hota)].map(Figure::from);
    let [a, b, c, d] = values;
    let values = [a, b, c, d, switches.into(), precision.into(), recall.into(), truths.into()];
    let motp = Matches::text(motp, 3);
    let precision = precision.map_or_else(|| "undefined".into(), |share| format!("{:.1} %", 100.0 * share));
    let mut facts = vec![
        fact("MOTA, MOTP", format!("{mota:.3}, {motp}")),
        fact("IDF1", format!("{idf1:.3}")),
        fact("HOTA", format!("{hota:.3}")),
        fact("Identity switches", grouped(switches)),
        fact("Precision, recall", format!("{precision}, {:.1} % of {} true boxes", 100.0 * recall, grouped(truths))),
    ];
    if greedy > 0 {
        let approximation =
            format!("{} boxes are matched greedily: the frame is too dense for an optimal assignment", grouped(greedy));
        facts.push(fact("Approximate", approximation));
    }
    let headline = format!("MOTA {mota:.3}, MOTP {motp}, IDF1 {idf1:.3}, HOTA {hota:.3}, {switches} switches");
    Assessment { headline, ..Assessment::default() }.with(scores(&TRACKING, values), facts)
}

/// The number and the results of each frame.
fn frames(field: &ObjectField) -> impl Iterator<Item = (Cell, &ObjectFrame)> {
    field.frames.iter().enumerate().map(|(i, frame)| ((field.first + i).into(), &**frame))
}

/// Upper left corner, width and height.
fn place(bounds: &Bounds) -> [Cell; 4] {
    let ([x, y], [width, height]) = (bounds.min, bounds.size());
    [x, y, width, height].map(Cell::Single)
}

impl ObjectField {
    /// One row for each object in each frame.
    pub fn object_table(&self) -> Table {
        let columns = [
            "frame",
            "id",
            "x_px",
            "y_px",
            "u_px_per_frame",
            "v_px_per_frame",
            "left_px",
            "top_px",
            "width_px",
            "height_px",
            "status",
            "sigma_x_px",
            "sigma_y_px",
        ];
        let row = |frame: Cell, object: &Object| {
            let [x, y] = object.position.map(Cell::Real);
            let [u, v] = object.velocity.map_or([Cell::Empty; 2], |velocity| velocity.map(Cell::Real));
            let [left, top, width, height] = place(&object.bounds);
            let sigma = |i: usize| object.covariance.map(|c| c[i][i].max(0.0).sqrt()).into();
            let status = Cell::Word(object.status.name());
            [frame, object.id.into(), x, y, u, v, left, top, width, height, status, sigma(0), sigma(1)]
        };
        Table::new(columns, frames(self).flat_map(|(t, frame)| frame.objects.iter().map(move |object| row(t, object))))
    }
}

/// The positions of each trajectory: `crossed` is the number of the first line that is crossed, positive to its right and negative to
/// its left, `in_zone` the number of the first zone that it is in; both count from 1, and 0 is none. `unusual_deg` is the angle to the
/// mean direction of the others where that is anomalous. Headings count from x (right) towards y (down).
fn trajectories(field: &ObjectField) -> Table {
    let columns = [
        "frame",
        "id",
        "x_px",
        "y_px",
        "speed_px_per_frame",
        "heading_deg",
        "step_px_per_frame",
        "crossed",
        "in_zone",
        "unusual_deg",
    ];
    let row = |of: &Trajectory, seen: &TrackPoint| {
        let [x, y] = seen.at.map(Cell::Real);
        let speed = |v: Option<[f64; 2]>| v.map(|[u, v]| u.hypot(v)).into();
        let crossing = of.crossings.iter().find(|crossing| crossing.frame == seen.frame);
        let inside = of.dwells.iter().filter(|dwell| (dwell.entered..=dwell.last).contains(&seen.frame));
        let zone = inside.map(|dwell| dwell.zone + 1).min().unwrap_or(0);
        [
            seen.frame.into(),
            of.id.into(),
            x,
            y,
            speed(seen.velocity),
            seen.heading_deg().into(),
            speed(seen.step),
            Cell::Int(crossing.map_or(0, |crossing| {
                let number = crossing.line as i64 + 1;
                if crossing.is_forward { number } else { -number }
            })),
            Cell::Int(zone as i64),
            seen.anomaly.map(|unusual| unusual.angle_deg).into(),
        ]
    };
    Table::new(columns, field.trajectories.iter().flat_map(|of| of.sightings.iter().map(move |seen| row(of, seen))))
}

fn detections(field: &ObjectField) -> Table {
    let columns = [
        "frame",
        "x_px",
        "y_px",
        "left_px",
        "top_px",
        "width_px",
        "height_px",
        "score",
        "area_px",
        "angle_deg",
        "elongation",
        "gray",
    ];
    let row = |frame: Cell, found: &Detection| {
        let [x, y] = found.center.map(Cell::Single);
        let [left, top, width, height] = place(&found.bounds);
        let blob = found.blob.map_or([Cell::Empty; 4], |blob| {
            let [long, short] = blob.radii;
            let angle = Cell::Single(blob.angle_rad.to_degrees());
            [blob.area_px.into(), angle, Cell::Single(long / short), Cell::Single(blob.gray)]
        });
        let [area, angle, elongation, gray] = blob;
        [frame, x, y, left, top, width, height, Cell::Single(found.score), area, angle, elongation, gray]
    };
    Table::new(columns, frames(field).flat_map(|(t, frame)| frame.detections.iter().map(move |found| row(t, found))))
}
