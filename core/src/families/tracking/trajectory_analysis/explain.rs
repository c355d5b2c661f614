//! The steps of the trajectory analysis in words, plots and marks.

use std::sync::Arc;

use super::{Event, State, TrajectoryAnalysis, line, near};
use crate::base::words::{counted, heading, heading_deg, place};
use crate::geometry::Bounds;
use crate::methods::multi_object::directions::Directions;
use crate::methods::numbers::{fixed, percent, px};
use crate::products::{
    Object, ObjectFrame, TrackStatus,
    objects::trajectory::{TrackPoint, Trajectory},
};
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// The frames after which an ended trajectory is no longer drawn.
const TRAIL_FRAMES: usize = 40;

impl TrajectoryAnalysis {
    pub(super) fn explained_step(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Tracked(_)) => line::TRACK,
            Some(Event::Moved(_)) => line::MEASURE_VELOCITY,
            Some(Event::Crossed(..)) => line::COUNT_CROSSING,
            Some(Event::Entered(..) | Event::Left(..)) => line::NOTE_ZONE,
            Some(Event::Unusual(..)) => line::IS_UNUSUAL,
            Some(Event::Learned(_)) => line::LEARN_DIRECTIONS,
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let said = Sentence::default();
        let Some(event) = seen.events.last() else {
            return said
                .text("The trajectories of tracks give ")
                .ink(Role::Result, "speed and heading")
                .text(" (from the x axis towards the y axis, so 90° is down), crossings of ")
                .ink(Role::Window, "lines")
                .text(", dwell times in ")
                .ink(Role::Reference, "zones")
                .text(" and ")
                .ink(Role::Error, "anomalous directions")
                .text(". Place lines and zones on the picture with their buttons among the parameters.");
        };
        // The tentative frames of a track are added when it is confirmed.
        let name = |trajectory: &Trajectory| {
            let frame =
                trajectory.sightings.last().map(|last| last.frame).filter(|frame| *frame != frame_of(seen.before));
            let when = frame.map_or_else(String::new, |frame| format!(" (tentative, frame {frame})"));
            format!("Track {}{when}", trajectory.id)
        };
        match event {
            Event::Tracked(frame) => {
                let seen = frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed).count();
                said.ink(Role::Estimate, counted(seen, "confirmed track")).text(" in this frame.")
            }
            Event::Moved(of) => self.moved(said.ink(Role::Estimate, name(of)), of),
            Event::Crossed(of, crossing) => {
                let side = if crossing.is_forward { "right (+)" } else { "left (−)" };
                said.ink(Role::Estimate, name(of)).text(" crosses ").ink(Role::Window, self.line_name(crossing.line)).text(
                    format!(
                        " to its {side} at {} px. {}",
                        place(point(crossing.at)),
                        crossings_so_far(counts(seen, crossing.line))
                    ),
                )
            }
            Event::Entered(of, dwell) => said
                .ink(Role::Estimate, name(of))
                .text(" enters ")
                .ink(Role::Reference, self.zone_name(dwell.zone))
                .text(format!("; dwell time counts from frame {}.", dwell.entered)),
            Event::Left(of, dwell) => {
                said.ink(Role::Estimate, name(of)).text(" leaves ").ink(Role::Reference, self.zone_name(dwell.zone)).text(
                    format!(
                        ": dwell time {}, from frame {} to {}.",
                        counted(dwell.frames(), "frame"),
                        dwell.entered,
                        dwell.last
                    ),
                )
            }
            Event::Unusual(of, anomaly) => said
                .ink(Role::Estimate, name(of))
                .text(" has an anomalous direction: ")
                .ink(
                    Role::Error,
                    format!(
                        "{}° from the mean of {}",
                        fixed(anomaly.angle_deg, 0),
                        counted(anomaly.others, "other track")
                    ),
                )
                .text(format!(" in this cell, above {}° (the unusual angle).", fixed(self.unusual_angle.into(), 0))),
            Event::Learned(directions) => said.text(format!(
                "The directions of this frame are added to the grid. {} the tracks that a comparison needs, at least {}.{}",
                match directions.all(self.min_others).len() {
                    1 => "1 cell has".to_owned(),
                    cells => format!("{cells} cells have"),
                },
                self.min_others,
                self.conclusion(seen)
            )),
        }
    }

    /// The counts of the run, at its end.
    fn conclusion(&self, seen: &Seen<Self>) -> String {
        let Some(state) = seen.after.filter(|after| after.span.frames() == Some(after.frames.len())) else {
            return String::new();
        };
        let (dwelt, unusual) = state.trajectories.iter().fold((0, 0), |(dwelt, unusual), of| {
            let is_unusual = of.sightings.iter().any(|seen| seen.anomaly.is_some());
            (dwelt + usize::from(!of.dwells.is_empty()), unusual + usize::from(is_unusual))
        });
        let all = counted(state.trajectories.len(), "trajectory").replace("ys", "ies");
        let mut said = format!(" Run: {all}, {unusual} with an anomalous direction");
        for line in 0..self.lines.all().len() {
            let [right, left] = counts(seen, line);
            said += &format!(
                "; {} of {} to the right and {left} to the left",
                counted(right, "crossing"),
                self.line_name(line)
            );
        }
        if !self.zones.all().is_empty() {
            said += &format!("; {dwelt} in {}", if self.zones.all().len() > 1 { "zones" } else { "the zone" });
        }
        said + "."
    }

    fn moved(&self, said: Sentence, trajectory: &Trajectory) -> Sentence {
        let Some(last) = trajectory.sightings.last() else { return said };
        match last.velocity {
            None => said.text(format!(" starts at {} px; velocity needs a second position.", place(point(last.at)))),
            Some(velocity) => {
                let speed = velocity[0].hypot(velocity[1]);
                let said = said.text(": speed ").ink(Role::Result, format!("{} px/frame", px(speed)));
                if speed < f64::from(self.min_speed) {
                    let least = px(self.min_speed.into());
                    return said
                        .text(format!(" is below the minimum speed of {least} px/frame, so it has no heading."));
                }
                said.text(format!(", heading {}, by {}.", heading(velocity), self.over(trajectory)))
            }
        }
    }

    /// The positions that the velocity is fitted to, in words.
    fn over(&self, trajectory: &Trajectory) -> String {
        let sightings = || trajectory.sightings.iter().rev();
        let last = sightings().next().map_or(0, |seen| seen.frame);
        match sightings().take_while(|seen| seen.frame + self.window > last).last() {
            Some(first) if first.frame < last => {
                format!("least squares over {}", counted(last - first.frame + 1, "frame"))
            }
            _ => "the last two positions, which are farther apart than the window".into(),
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.after.unwrap_or(seen.before);
        let mut facts = vec![Fact::new("Frame", frame_of(seen.before).to_string(), None)];
        let lines = self.lines.all().len();
        if lines > 0 {
            let of_line = |line: usize| {
                let [forward, back] = counts(seen, line);
                let counted = format!("{forward} to the right, {back} to the left");
                if lines > 1 { format!("line {}: {counted}", line + 1) } else { counted }
            };
            let told = (0..lines).map(of_line).collect::<Vec<_>>().join("; ");
            facts.push(Fact::new("Crossings", told, Some(Role::Window)));
        }
        let zones = self.zones.all().len();
        if zones > 0 {
            let of_zone = |zone: usize| {
                let inside = inside(seen, zone);
                if zones > 1 { format!("{inside} in zone {}", zone + 1) } else { inside.to_string() }
            };
            let told = (0..zones).map(of_zone).collect::<Vec<_>>().join(", ");
            let label = if zones > 1 { "Tracks in zones" } else { "Tracks in the zone" };
            facts.push(Fact::new(label, told, Some(Role::Reference)));
        }
        let subject = self.subject(seen);
        if let Some(trajectory) = &subject {
            facts.extend(self.facts(trajectory));
        }
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend(subject.as_ref().and_then(|of| self.equation(of)).map(Readout::Equation));
        if let Some(trajectory) = subject {
            let x_max = state.span.first + state.span.frames().unwrap_or(state.frames.len()).saturating_sub(1);
            readouts.extend(series(&trajectory, x_max).into_iter().map(Readout::Series));
        }
        readouts
    }

    /// The formulas of velocity, speed and heading with the numbers of the last position.
    fn equation(&self, trajectory: &Trajectory) -> Option<Vec<Math>> {
        let [x, y] = trajectory.sightings.last()?.velocity?;
        let ((bold, var), mean) = ((Math::Bold, Math::Var), |name| Math::mean(Math::Var(name)));
        let of = |name: Math| Math::indexed(name, var("i"));
        let late = || Math::Row(vec![Math::text("("), of(var("t")), Math::text(" − "), mean("t"), Math::text(")")]);
        let away = vec![Math::text(" ("), of(bold("x")), Math::text(" − "), Math::mean(bold("x")), Math::text(")")];
        let sum = || Math::Sum(Box::new(var("i")));
        let along = Math::Row([vec![sum(), late()], away].concat());
        let spread = Math::Row(vec![sum(), Math::squared(late())]);
        let slope = Math::ink(Role::Result, format!("({}, {}) px/frame", px(x), px(y)));
        let part = |name| Math::indexed(var("v"), Math::text(name));
        let squares =
            |x: Math, y: Math| Math::root(Math::Row(vec![Math::squared(x), Math::text(" + "), Math::squared(y)]));
        let bracketed = |v: f64| Math::text(if v < 0.0 { format!("({})", px(v)) } else { px(v) });
        let speed = Math::ink(Role::Result, format!("{} px/frame", px(x.hypot(y))));
        let mut lines = vec![
            Math::Row(vec![bold("v"), Math::text(" = "), Math::over(along, spread), Math::text(" = "), slope]),
            Math::Row(vec![
                Math::abs(bold("v")),
                Math::text(" = "),
                squares(part("x"), part("y")),
                Math::text(" = "),
                squares(bracketed(x), bracketed(y)),
                Math::text(" = "),
                speed,
            ]),
        ];
        if x.hypot(y) >= f64::from(self.min_speed) {
            lines.push(Math::Row(vec![
                Math::text("heading = atan2("),
                part("y"),
                Math::text(", "),
                part("x"),
                Math::text(format!(") = atan2({}, {}) = ", px(y), px(x))),
                Math::ink(Role::Result, heading([x, y])),
            ]));
        }
        Some(lines)
    }

    fn facts(&self, trajectory: &Trajectory) -> Vec<Fact> {
        let mut facts = vec![Fact::new("Track", trajectory.id.to_string(), Some(Role::Estimate))];
        if let Some(TrackPoint { velocity: Some(velocity), step: Some(step), .. }) = trajectory.sightings.last() {
            let speed = |v: &[f64; 2]| format!("{} px/frame", px(v[0].hypot(v[1])));
            facts.push(Fact::new("Speed", speed(velocity), Some(Role::Result)));
            facts.push(Fact::new("Speed since last position", speed(step), Some(Role::Measured)));
            facts.push(Fact::new("Heading", format!("{} (90° is down)", heading(*velocity)), None));
        }
        facts.push(Fact::new("Path length", format!("{} px", px(trajectory.length_px())), None));
        if let Some(straightness) = trajectory.straightness() {
            facts.push(Fact::new("Straightness", percent(straightness), None));
        }
        let zones = self.zones.all().len();
        if zones > 0 {
            let in_zone = |zone: usize| {
                let frames = counted(trajectory.dwell_frames_in(zone), "frame");
                if zones > 1 { format!("{frames} in zone {}", zone + 1) } else { frames }
            };
            let told = (0..zones).map(in_zone).collect::<Vec<_>>().join(", ");
            facts.push(Fact::new("Dwell time", told, Some(Role::Reference)));
        }
        facts
    }

    /// The trajectory that the facts are about: that of the step, the one pointed at, or the longest.
    fn subject(&self, seen: &Seen<Self>) -> Option<Arc<Trajectory>> {
        if let Some(of) = seen.events.last().and_then(Event::trajectory) {
            return Some(Arc::clone(of));
        }
        let all = now(seen);
        let pointed = seen.point().and_then(|at| near(&all, at));
        let most = || all.iter().rev().max_by_key(|trajectory| trajectory.sightings.len());
        pointed.or_else(most).map(Arc::clone)
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        scene.is_overview = seen.after.is_some() && seen.point().is_none();
        let all = now(seen);
        if let Some(Event::Learned(directions)) = seen.events.last() {
            self.draw_directions(directions, scene);
        }
        self.draw_places(seen, scene);
        let t = frame_of(seen.before);
        for trajectory in &all {
            let is_recent = trajectory.sightings.last().is_some_and(|last| last.frame + TRAIL_FRAMES >= t);
            let points: Vec<[f32; 2]> = trajectory.sightings.iter().map(|seen| point(seen.at)).collect();
            if is_recent && points.len() > 1 {
                let path = Shape::Path { points, closed: false };
                scene.mark_of(trajectory.id, Picture::CURRENT, Role::Estimate, path);
            }
        }
        for object in frame_at(seen).iter().flat_map(|frame| &frame.objects) {
            let of = all.binary_search_by_key(&object.id, |trajectory| trajectory.id).ok();
            let last = of.and_then(|i| all[i].sightings.last()).filter(|seen| seen.frame == t);
            draw_object(scene, object, last);
        }
        let crossings: Vec<[f32; 2]> = all.iter().flat_map(|of| of.crossings.iter().map(|c| point(c.at))).collect();
        if !crossings.is_empty() {
            scene.mark(Picture::CURRENT, Role::Best, Shape::Points(crossings));
            scene.legend(Role::Best, "crossing");
        }
        scene.legend(Role::Estimate, "trajectory of a track");
        if let Some(Event::Unusual(of, anomaly)) = seen.events.last()
            && let Some(last) = of.sightings.last()
        {
            scene.mark(Picture::CURRENT, Role::Rejected, chevron(last.at, anomaly.mean, self.cell_size as f64));
            scene.legend(Role::Rejected, "mean direction of tracks");
        }
    }

    /// Draws lines and zones with their counts, and with their numbers where there are several.
    fn draw_places(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let zones = self.zones.all();
        for (i, Bounds { min, max }) in zones.iter().enumerate() {
            scene.mark(Picture::CURRENT, Role::Reference, Shape::Rect { min: *min, max: *max });
            scene.legend(Role::Reference, "zone");
            if zones.len() > 1 {
                let text = Shape::Text { at: [min[0], max[1]], text: format!("zone {}", i + 1) };
                scene.mark(Picture::CURRENT, Role::Reference, text);
            }
        }
        (0..self.lines.all().len()).for_each(|line| self.draw_line(seen, scene, line));
    }

    fn draw_line(&self, seen: &Seen<Self>, scene: &mut Scene, index: usize) {
        let lines = self.lines.all();
        let line = lines[index];
        let path = Shape::Path { points: vec![line.from, line.to], closed: false };
        scene.mark(Picture::CURRENT, Role::Window, path);
        let [u, v] = [0, 1].map(|i| line.to[i] - line.from[i]);
        let length = u.hypot(v);
        // Near its end, where fewer tracks cross than in its middle.
        let at = |share: f32, side: f32| {
            let along = [0, 1].map(|i| line.from[i] + share * (line.to[i] - line.from[i]));
            [along[0] - side * 12.0 * v / length, along[1] + side * 12.0 * u / length]
        };
        let [forward, back] = counts(seen, index);
        // Right as seen along the line, since y points down.
        for (side, text) in [(1.0, format!("+{forward}")), (-1.0, format!("−{back}"))] {
            scene.mark(Picture::CURRENT, Role::Window, Shape::Text { at: at(0.88, side), text });
        }
        if lines.len() > 1 {
            let text = format!("line {}", index + 1);
            scene.mark(Picture::CURRENT, Role::Window, Shape::Text { at: at(0.12, 1.0), text });
        }
        scene.legend(Role::Window, "counting line with crossings");
    }

    /// The name of a line in a sentence: the line, or line 2 of several.
    fn line_name(&self, index: usize) -> String {
        if self.lines.all().len() > 1 { format!("line {}", index + 1) } else { "the line".into() }
    }

    fn zone_name(&self, index: usize) -> String {
        if self.zones.all().len() > 1 { format!("zone {}", index + 1) } else { "the zone".into() }
    }

    fn draw_directions(&self, directions: &Directions, scene: &mut Scene) {
        for (at, mean) in directions.all(self.min_others) {
            let shape = chevron(at.map(f64::from), mean.direction, directions.side_px as f64 * mean.agreement);
            scene.mark(Picture::CURRENT, Role::Rejected, shape);
            scene.legend(Role::Rejected, "mean direction of tracks");
        }
    }
}

/// The objects of the current frame, or of the one before it.
fn frame_at<'a>(seen: &Seen<'a, TrajectoryAnalysis>) -> Option<&'a Arc<ObjectFrame>> {
    let at_hand =
        seen.events.iter().find_map(|event| if let Event::Tracked(frame) = event { Some(frame) } else { None });
    at_hand.or(seen.before.frames.last())
}

/// All trajectories up to the step.
fn now(seen: &Seen<TrajectoryAnalysis>) -> Vec<Arc<Trajectory>> {
    let mut all = seen.after.unwrap_or(seen.before).trajectories.clone();
    for of in seen.events.iter().filter_map(Event::trajectory) {
        match all.binary_search_by_key(&of.id, |trajectory| trajectory.id) {
            Ok(i) => all[i] = Arc::clone(of),
            Err(i) => all.insert(i, Arc::clone(of)),
        }
    }
    all
}

fn crossings_so_far([forward, back]: [usize; 2]) -> String {
    format!("Crossings so far: {forward} to the right, {back} to the left.")
}

/// The tracks of the frame that are in a zone.
fn inside(seen: &Seen<TrajectoryAnalysis>, zone: usize) -> usize {
    let frame = frame_at(seen);
    let is_here = |of: &Trajectory| frame.is_some_and(|frame| frame.object(of.id).is_some());
    let is_inside = |of: &Trajectory| of.dwells.iter().any(|dwell| dwell.zone == zone && !dwell.is_over);
    now(seen).iter().filter(|of| is_here(of) && is_inside(of)).count()
}

/// The crossings of a line to its right and to its left.
fn counts(seen: &Seen<TrajectoryAnalysis>, line: usize) -> [usize; 2] {
    let all = now(seen);
    let crossings = || all.iter().flat_map(|of| &of.crossings).filter(|crossing| crossing.line == line);
    let of = |is_forward: bool| crossings().filter(|crossing| crossing.is_forward == is_forward).count();
    [of(true), of(false)]
}

fn frame_of(state: &State) -> usize {
    state.span.first + state.frames.len()
}

fn point(at: [f64; 2]) -> [f32; 2] {
    at.map(|c| c as f32)
}

/// A short arrow in a direction around a position.
fn chevron(at: [f64; 2], [u, v]: [f64; 2], size_px: f64) -> Shape {
    let place = |along: f64, across: f64| {
        point([at[0] + size_px * (along * u - across * v), at[1] + size_px * (along * v + across * u)])
    };
    let tip = place(0.3, 0.0);
    Shape::Path { points: vec![place(-0.3, 0.0), tip, place(0.18, 0.1), tip, place(0.18, -0.1)], closed: false }
}

/// Draws a track's box, number and velocity.
fn draw_object(scene: &mut Scene, object: &Object, last: Option<&TrackPoint>) {
    let is_unusual = last.is_some_and(|last| last.anomaly.is_some());
    let (role, meaning) = match object.status {
        _ if is_unusual => (Role::Error, "anomalous direction"),
        TrackStatus::Tentative => (Role::Candidate, "tentative track"),
        TrackStatus::Confirmed => (Role::Estimate, "confirmed track"),
        TrackStatus::Coasting => (Role::Predicted, "coasting track"),
    };
    let Bounds { min, max } = object.bounds;
    scene.mark(Picture::CURRENT, role, Shape::Rect { min, max });
    scene.mark_of(object.id, Picture::CURRENT, role, Shape::Text { at: min, text: object.id.to_string() });
    scene.legend(role, meaning);
    if let Some(TrackPoint { at, velocity: Some(velocity), .. }) = last {
        let (from, to) = (point(*at), point([0, 1].map(|i| at[i] + velocity[i])));
        scene.mark(Picture::CURRENT, Role::Result, Shape::Arrows(vec![Arrow { from, to }]));
        scene.legend(Role::Result, "velocity in px/frame");
    }
}

/// Breaks a line of headings where it wraps from 180° to −180°.
fn unwrapped(points: Vec<[f32; 2]>) -> Vec<[f32; 2]> {
    let mut broken: Vec<[f32; 2]> = Vec::with_capacity(points.len());
    for point in points {
        if let Some(last) = broken.last().filter(|last| (point[1] - last[1]).abs() > 180.0).copied() {
            broken.push([(last[0] + point[0]) / 2.0, f32::NAN]);
        }
        broken.push(point);
    }
    broken
}

/// The plots of speed and heading.
fn series(trajectory: &Trajectory, x_max: usize) -> Vec<Series> {
    let line = |of: &dyn Fn(&TrackPoint) -> Option<f64>| -> Vec<[f32; 2]> {
        let known = trajectory.sightings.iter().filter_map(|seen| Some([seen.frame as f32, of(seen)? as f32]));
        known.collect()
    };
    let speed = |v: [f64; 2]| v[0].hypot(v[1]);
    let series = |title, y_label, lines| Series { title, x_label: "frame", y_label, x_max, lines, ..Series::default() };
    let speeds = vec![
        ("since last position", Role::Measured, line(&|seen| seen.step.map(speed))),
        ("least squares", Role::Result, line(&|seen| seen.velocity.map(speed))),
    ];
    let degrees = |v: [f64; 2]| (v != [0.0; 2]).then(|| heading_deg(v));
    let headings = vec![
        ("since last position", Role::Measured, unwrapped(line(&|seen| seen.step.and_then(degrees)))),
        ("least squares", Role::Result, unwrapped(line(&TrackPoint::heading_deg))),
    ];
    if trajectory.sightings.len() < 3 {
        return Vec::new();
    }
    vec![series("Speed", "px/frame", speeds), series("Heading", "°, 90° is down", headings)]
}
