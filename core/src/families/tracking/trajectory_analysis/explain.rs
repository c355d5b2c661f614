//! How trajectories are told and drawn.

use std::sync::Arc;

use super::{Event, State, TrajectoryAnalysis, line, near};
use crate::base::words::{counted, heading, heading_deg, number, number_64};
use crate::geometry::Bounds;
use crate::methods::multi_object::directions::Directions;
use crate::products::{
    Object, ObjectFrame, TrackStatus,
    objects::trajectory::{TrackPoint, Trajectory},
};
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// Trajectories of objects that were not seen for longer are not drawn.
const TRAIL_FRAMES: usize = 40;

impl TrajectoryAnalysis {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Tracked(_)) => line::TRACK,
            Some(Event::Moved(_)) => line::MEASURE_VELOCITY,
            Some(Event::Crossed(..)) => line::COUNT_CROSSING,
            Some(Event::Entered(..) | Event::Left(..)) => line::NOTE_ZONE,
            Some(Event::Unusual(..)) => line::IS_UNUSUAL,
            Some(Event::Learned(_)) => line::LEARN_DIRECTIONS,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let said = Sentence::default();
        let Some(event) = seen.events.last() else {
            return said
                .text("Objects are tracked, and their trajectories are analysed: ")
                .ink(Role::Result, "speed and heading")
                .text(", crossings of a ")
                .ink(Role::Window, "line")
                .text(", dwell time in a ")
                .ink(Role::Reference, "zone")
                .text(", and objects that go ")
                .ink(Role::Error, "where the others do not")
                .text(". Line and zone are placed on the picture from among the parameters.");
        };
        // What became of an object before it was confirmed is known only now.
        let name = |trajectory: &Trajectory| {
            let frame =
                trajectory.sightings.last().map(|last| last.frame).filter(|frame| *frame != frame_of(seen.before));
            let when = frame.map_or_else(String::new, |frame| format!("In frame {frame}, still tentative: "));
            format!("{when}Object {}", trajectory.id)
        };
        match event {
            Event::Tracked(frame) => {
                let seen = frame.objects.iter().filter(|object| object.life == TrackStatus::Confirmed).count();
                said.ink(Role::Estimate, counted(seen, "object")).text(" confirmed.")
            }
            Event::Moved(of) => self.moved(said.ink(Role::Estimate, name(of)), of),
            Event::Crossed(of, crossing) => {
                let side =
                    if crossing.is_forward { "right, the side with the +" } else { "left, the side with the −" };
                said.ink(Role::Estimate, name(of))
                    .text(" goes over the ")
                    .ink(Role::Window, "line")
                    .text(format!(" to its {side}. {}", told_counts(counts(seen))))
            }
            Event::Entered(of, _) => {
                said.ink(Role::Estimate, name(of)).text(" comes into the ").ink(Role::Reference, "zone").text(".")
            }
            Event::Left(of, stay) => {
                said.ink(Role::Estimate, name(of)).text(" has left the ").ink(Role::Reference, "zone").text(format!(
                    ": it was there from frame {} to {}, {}.",
                    stay.entered,
                    stay.last,
                    counted(stay.frames(), "frame")
                ))
            }
            Event::Unusual(of, unusual) => said
                .ink(Role::Estimate, name(of))
                .text(" goes ")
                .ink(
                    Role::Error,
                    format!(
                        "{}° off where {} went here",
                        number_64(unusual.angle_deg.round()),
                        counted(unusual.others, "other")
                    ),
                )
                .text(format!(": more than {}°, and so it is unusual.", number(self.unusual_angle))),
            Event::Learned(_) => {
                said.text("The headings of this frame are kept, so that later ones can be compared with them.")
            }
        }
    }

    fn moved(&self, said: Sentence, trajectory: &Trajectory) -> Sentence {
        let Some(last) = trajectory.sightings.last() else { return said };
        match last.velocity {
            None => said.text(" is seen for the first time."),
            Some(velocity) => {
                let speed = velocity[0].hypot(velocity[1]);
                let said = said.text(" moves at ").ink(Role::Result, format!("{} px/frame", number_64(speed)));
                if speed < f64::from(self.min_speed) {
                    return said.text(": too slow for a heading.");
                }
                said.text(format!(" towards {}, {}.", heading(velocity), self.over(trajectory)))
            }
        }
    }

    /// Over which frames the velocity of the last sighting is taken, in words.
    fn over(&self, trajectory: &Trajectory) -> String {
        let sightings = || trajectory.sightings.iter().rev();
        let last = sightings().next().map_or(0, |seen| seen.frame);
        match sightings().take_while(|seen| seen.frame + self.window > last).last() {
            Some(first) if first.frame < last => format!("over {}", counted(last - first.frame + 1, "frame")),
            _ => "since it was seen before".into(),
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.after.unwrap_or(seen.before);
        let mut facts = vec![Fact::new("Frame", frame_of(seen.before).to_string(), None)];
        if self.line.is_some() {
            let [forward, back] = counts(seen);
            facts.push(Fact::new("Counted", format!("{forward} to the right, {back} to the left"), Some(Role::Window)));
        }
        if self.zone.is_some() {
            let frame = frame_at(seen);
            let is_here = |of: &Trajectory| frame.is_some_and(|frame| frame.object(of.id).is_some());
            let is_inside = |of: &&Arc<Trajectory>| is_here(of) && of.stays.last().is_some_and(|stay| !stay.is_over);
            let inside = now(seen).iter().filter(is_inside).count();
            facts.push(Fact::new("In the zone", inside.to_string(), Some(Role::Reference)));
        }
        let subject = self.subject(seen);
        if let Some(trajectory) = &subject {
            facts.extend(self.facts(trajectory));
        }
        let mut readouts = vec![Readout::Facts(facts)];
        if let Some(trajectory) = subject {
            let x_max = state.span.first + state.span.frames().unwrap_or(state.frames.len()).saturating_sub(1);
            readouts.extend(series(&trajectory, x_max).into_iter().map(Readout::Series));
        }
        readouts
    }

    fn facts(&self, trajectory: &Trajectory) -> Vec<Fact> {
        let mut facts = vec![Fact::new("Object", trajectory.id.to_string(), Some(Role::Estimate))];
        if let Some(TrackPoint { velocity: Some(velocity), step: Some(step), .. }) = trajectory.sightings.last() {
            let speed = |v: &[f64; 2]| format!("{} px/frame", number_64(v[0].hypot(v[1])));
            facts.push(Fact::new("Speed", speed(velocity), Some(Role::Result)));
            facts.push(Fact::new("Since seen before", speed(step), Some(Role::Measured)));
            facts.push(Fact::new("Heading", heading(*velocity), None));
        }
        facts.push(Fact::new("Direction", format!("{} px", number_64(trajectory.length_px())), None));
        if let Some(straightness) = trajectory.straightness() {
            facts.push(Fact::new("Straightness", format!("{} %", number_64(100.0 * straightness)), None));
        }
        if self.zone.is_some() {
            facts.push(Fact::new(
                "Time in the zone",
                counted(trajectory.dwell_frames(), "frame"),
                Some(Role::Reference),
            ));
        }
        facts
    }

    /// The object that the step is about: its own, that which is pointed at, or the one that was seen most.
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
            scene.legend(Role::Best, "counted");
        }
        scene.legend(Role::Estimate, "tracked");
        if let Some(Event::Unusual(of, unusual)) = seen.events.last()
            && let Some(last) = of.sightings.last()
        {
            scene.mark(Picture::CURRENT, Role::Rejected, chevron(last.at, unusual.usual, self.part as f64));
            scene.legend(Role::Rejected, "where others go");
        }
    }

    /// Line and zone, with what was counted.
    fn draw_places(&self, seen: &Seen<Self>, scene: &mut Scene) {
        if let Some(Bounds { min, max }) = self.zone {
            scene.mark(Picture::CURRENT, Role::Reference, Shape::Rect { min, max });
            scene.legend(Role::Reference, "zone");
        }
        let Some(line) = self.line else { return };
        let path = Shape::Path { points: vec![line.from, line.to], closed: false };
        scene.mark(Picture::CURRENT, Role::Window, path);
        let [u, v] = [0, 1].map(|i| line.to[i] - line.from[i]);
        let length = u.hypot(v);
        // Near its end, where fewer go than in its middle.
        let middle = [0, 1].map(|i| line.to[i] - 0.12 * (line.to[i] - line.from[i]));
        let [forward, back] = counts(seen);
        // To the right of who looks along it, as y points down.
        for (side, text) in [(1.0, format!("+{forward}")), (-1.0, format!("−{back}"))] {
            let at = [middle[0] - side * 12.0 * v / length, middle[1] + side * 12.0 * u / length];
            scene.mark(Picture::CURRENT, Role::Window, Shape::Text { at, text });
        }
        scene.legend(Role::Window, "line, with what was counted");
    }

    fn draw_directions(&self, directions: &Directions, scene: &mut Scene) {
        for (at, usual) in directions.all(self.least_others) {
            let shape = chevron(at.map(f64::from), usual.direction, directions.side_px as f64 * usual.agreement);
            scene.mark(Picture::CURRENT, Role::Rejected, shape);
            scene.legend(Role::Rejected, "where others go");
        }
    }
}

/// The objects of the frame at hand, or of the one before it.
fn frame_at<'a>(seen: &Seen<'a, TrajectoryAnalysis>) -> Option<&'a Arc<ObjectFrame>> {
    let at_hand =
        seen.events.iter().find_map(|event| if let Event::Tracked(frame) = event { Some(frame) } else { None });
    at_hand.or(seen.before.frames.last())
}

/// All trajectories as they are at the step.
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

fn told_counts([forward, back]: [usize; 2]) -> String {
    format!("So far {forward} to the right and {back} to the left.")
}

/// How many have gone over the line to its right and to its left.
fn counts(seen: &Seen<TrajectoryAnalysis>) -> [usize; 2] {
    let all = now(seen);
    let of = |is_forward: bool| all.iter().flat_map(|of| &of.crossings).filter(|c| c.is_forward == is_forward).count();
    [of(true), of(false)]
}

fn frame_of(state: &State) -> usize {
    state.span.first + state.frames.len()
}

fn point(at: [f64; 2]) -> [f32; 2] {
    at.map(|c| c as f32)
}

/// A short line with a head that points along a direction, around a place.
fn chevron(at: [f64; 2], [u, v]: [f64; 2], size_px: f64) -> Shape {
    let place = |along: f64, across: f64| {
        point([at[0] + size_px * (along * u - across * v), at[1] + size_px * (along * v + across * u)])
    };
    let tip = place(0.3, 0.0);
    Shape::Path { points: vec![place(-0.3, 0.0), tip, place(0.18, 0.1), tip, place(0.18, -0.1)], closed: false }
}

/// An object with its box, its number and where it goes.
fn draw_object(scene: &mut Scene, object: &Object, last: Option<&TrackPoint>) {
    let is_unusual = last.is_some_and(|last| last.unusual.is_some());
    let (role, meaning) = match object.life {
        _ if is_unusual => (Role::Error, "unusual direction"),
        TrackStatus::Tentative => (Role::Candidate, "tentative"),
        TrackStatus::Confirmed => (Role::Estimate, "tracked"),
        TrackStatus::Coasting => (Role::Predicted, "not seen"),
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

/// The same broken where it goes through the left: from 180° to −180° is no turn.
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

/// Speed and heading from frame to frame.
fn series(trajectory: &Trajectory, x_max: usize) -> Vec<Series> {
    let line = |of: &dyn Fn(&TrackPoint) -> Option<f64>| -> Vec<[f32; 2]> {
        let known = trajectory.sightings.iter().filter_map(|seen| Some([seen.frame as f32, of(seen)? as f32]));
        known.collect()
    };
    let speed = |v: [f64; 2]| v[0].hypot(v[1]);
    let series = |title, y_label, lines| Series {
        title,
        x_label: "frame",
        y_label,
        x_max,
        lines,
        ..Series::default()
    };
    let speeds = vec![
        ("since seen before", Role::Measured, line(&|seen| seen.step.map(speed))),
        ("smoothed", Role::Result, line(&|seen| seen.velocity.map(speed))),
    ];
    let degrees = |v: [f64; 2]| (v != [0.0; 2]).then(|| heading_deg(v));
    let headings = vec![
        ("since seen before", Role::Measured, unwrapped(line(&|seen| seen.step.and_then(degrees)))),
        ("smoothed", Role::Result, unwrapped(line(&TrackPoint::heading_deg))),
    ];
    if trajectory.sightings.len() < 3 {
        return Vec::new();
    }
    vec![series("Speed", "px/frame", speeds), series("Heading", "° against the clock from right", headings)]
}
