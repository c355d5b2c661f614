//! The steps of the trajectory analysis in words and plots.

use std::sync::Arc;

use super::{Event, State, TrajectoryAnalysis, line, near};
use crate::base::words::{heading_deg, whole_heading_deg};
use crate::products::{
    ObjectFrame, TrackStatus,
    objects::trajectory::{TrackPoint, Trajectory},
};
use crate::run::Seen;
use crate::scene::{Case, Readout, Role, Series, Step, Unit};
use crate::{cases, variables};

variables! { pub(super) mod value;
    /// The current frame.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The number of the track.
    TRACK: "Track", "", Unit::WHOLE, Role::Estimate;
    /// The frame of the last position of the track.
    SIGHTED: "Last position in frame", "", Unit::WHOLE;
    /// The number of confirmed tracks in the frame.
    CONFIRMED: "Confirmed tracks", "", Unit::count("confirmed track"), Role::Estimate;
    /// The last position of the track.
    POSITION: "Position", r"\mathbf{x}", Unit::PX;
    /// The velocity of the track: the slope of the least-squares line through its last positions.
    VELOCITY: "Velocity", r"\mathbf{v}", Unit::SPEED, Role::Result;
    /// The velocity along x.
    V_X: "Velocity along x", "v_x", Unit::SPEED;
    /// The velocity along y.
    V_Y: "Velocity along y", "v_y", Unit::SPEED;
    /// The magnitude of the velocity.
    SPEED: "Speed", r"|\mathbf{v}|", Unit::SPEED, Role::Result;
    /// The speed from the last position but one to the last.
    LAST_SPEED: "Speed since last position", "", Unit::SPEED, Role::Measured;
    /// The smallest speed with a heading.
    MIN_SPEED: "Minimum speed", "", Unit::SPEED;
    /// The direction of the velocity, from the x axis towards the y axis.
    HEADING: "Heading", "", Unit::DEGREES, Role::Result;
    /// The number of frames of the velocity estimate.
    FITTED: "Frames of the velocity", "", Unit::count("frame");
    /// The length of the path of the track.
    PATH_LENGTH: "Path length", "", Unit::PX;
    /// The distance of the last position from the first as a share of the path length.
    STRAIGHTNESS: "Straightness", "", Unit::PERCENT;
    /// The number of the counting line.
    LINE: "Line", "", Unit::WHOLE, Role::Window;
    /// The number of crossings of the line so far.
    CROSSINGS: "Crossings", "", Unit::WHOLE, Role::Window;
    /// The number of crossings to the right of the line so far.
    RIGHT: "Crossings to the right", "", Unit::count("crossing");
    /// The number of crossings to the left of the line so far.
    LEFT: "Crossings to the left", "", Unit::count("crossing");
    /// The intersection of the path with the line.
    CROSSING: "Crossing", "", Unit::PX;
    /// The number of the zone.
    ZONE: "Zone", "", Unit::WHOLE, Role::Reference;
    /// The number of tracks of the frame that are in the zone.
    INSIDE: "Tracks inside", "", Unit::WHOLE, Role::Reference;
    /// The number of frames that the track was in the zone.
    DWELL: "Dwell time", "", Unit::count("frame"), Role::Reference;
    /// The first frame of the track in the zone.
    ENTERED: "Entered in frame", "", Unit::WHOLE;
    /// The last frame of the track in the zone.
    LAST_INSIDE: "Last frame inside", "", Unit::WHOLE;
    /// The angle between the heading and the mean direction of the other tracks.
    ANGLE: "Angle", "", Unit::DEGREES, Role::Error;
    /// The number of other tracks in the cell.
    OTHERS: "Other tracks", "", Unit::count("other track"), Role::Error;
    /// The angle above which a direction is anomalous.
    UNUSUAL_ANGLE: "Unusual angle", "", Unit::DEGREES;
    /// The number of cells with enough tracks for a comparison.
    CELLS: "Cells", "", Unit::count("cell");
    /// The number of other tracks in a cell that a comparison needs.
    MIN_OTHERS: "Minimum number of others", "", Unit::WHOLE;
    /// The number of trajectories of the run.
    TRAJECTORIES: "Trajectories", "", Unit::count("trajectory");
    /// The number of trajectories with an anomalous direction.
    ANOMALIES: "Anomalous directions", "", Unit::WHOLE;
    /// The number of trajectories that were in a zone.
    DWELT: "Tracks with a dwell time", "", Unit::WHOLE;
}

cases! { pub(super) over value;
    OPENING: "The trajectories of tracks give {result|speed and heading} (from the x axis towards the y axis, so 90° is down), \
              crossings of {window|lines}, dwell times in {reference|zones} and {error|anomalous directions}. Place lines and zones on \
              the picture with their buttons among the parameters.",
    TRACKED: "{confirmed} in this frame.",
    TRACK: "{estimate|Track} {track}",
    TENTATIVE_TRACK: "{estimate|Track} {track} {estimate|(tentative, frame} {sighted}{estimate|)}",
    STARTS: " starts at {position}; velocity needs a second position.",
    SLOW: ": speed {speed} is below the minimum speed of {min_speed}, so it has no heading.",
    FITTED: ": speed {speed}, heading {heading}, by least squares over {fitted}.",
    APART: ": speed {speed}, heading {heading}, by the last two positions, which are farther apart than the window.",
    CROSSES: " crosses",
    THE_LINE: "{window|the line}",
    LINE: "{window|line} {line}",
    TO_RIGHT: " to its right (+) at {crossing}.",
    TO_LEFT: " to its left (−) at {crossing}.",
    SO_FAR: "Crossings so far: {right:bare} to the right, {left:bare} to the left.",
    ENTERS: " enters",
    LEAVES: " leaves",
    THE_ZONE: "{reference|the zone}",
    ZONE: "{reference|zone} {zone}",
    DWELLS: "; dwell time counts from frame {entered}.",
    DWELT: ": dwell time {dwell}, from frame {entered} to {last_inside}.",
    UNUSUAL: " has an anomalous direction: {angle} {error|from the mean of} {others} in this cell, above {unusual_angle} (the unusual \
              angle).",
    LEARNED: "The directions of this frame are added to the grid. It has {cells} with the tracks that a comparison needs, at least \
              {min_others}.",
    RUN: "Run: {trajectories}, {anomalies} with an anomalous direction",
    RUN_CROSSINGS: "; {right} of",
    BOTH_WAYS: " to the right and {left:bare} to the left",
    RUN_ZONE: "; {dwelt} in the zone",
    RUN_ZONES: "; {dwelt} in zones",
    RUN_END: ".",
    COUNTED: "{right:bare} to the right, {left:bare} to the left",
    COUNTED_AT_LINE: "line {line}: {right:bare} to the right, {left:bare} to the left",
    INSIDE_ZONE: "{inside} in zone {zone}",
    DWELL_IN_ZONE: "{dwell} in zone {zone}",
    HEADING: "{heading} (90° is down)",
}

impl TrajectoryAnalysis {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let (state, t, subject) = (seen.after.unwrap_or(seen.before), frame_of(seen.before), self.subject(seen));
        let at = |line| {
            let step = self.put_counts(Step::at(line).fact(value::FRAME, t), seen);
            subject.iter().fold(step, |step, of| self.tell_following(step, of))
        };
        // The tentative frames of a track are added when it is confirmed.
        let track = |line, of: &Trajectory| {
            let sighted = of.sightings.last().map_or(t, |last| last.frame);
            at(line).put(value::SIGHTED, sighted).say(if sighted == t { case::TRACK } else { case::TENTATIVE_TRACK })
        };
        let step = match seen.events.last() {
            None => at(line::EACH_FRAME).say(case::OPENING),
            Some(Event::Tracked(frame)) => {
                let confirmed = frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed).count();
                at(line::TRACK).put(value::CONFIRMED, confirmed).say(case::TRACKED)
            }
            Some(Event::Moved(of)) => self.tell_motion(track(line::MEASURE_VELOCITY, of), of),
            Some(Event::Crossed(of, crossing)) => {
                let step = put_line(track(line::COUNT_CROSSING, of).say(case::CROSSES), seen, crossing.line);
                let step = step.put(value::CROSSING, crossing.at).say(self.line_case());
                step.say(if crossing.is_forward { case::TO_RIGHT } else { case::TO_LEFT }).say(case::SO_FAR)
            }
            Some(Event::Entered(of, dwell) | Event::Left(of, dwell)) => {
                let step =
                    track(line::NOTE_ZONE, of).put(value::ZONE, dwell.zone + 1).put(value::ENTERED, dwell.entered);
                let step = step.put(value::DWELL, dwell.frames()).put(value::LAST_INSIDE, dwell.last);
                let [way, times] =
                    if dwell.is_over { [case::LEAVES, case::DWELT] } else { [case::ENTERS, case::DWELLS] };
                step.say(way).say(self.zone_case()).say(times)
            }
            Some(Event::Unusual(of, anomaly)) => {
                let step = track(line::IS_UNUSUAL, of).put(value::ANGLE, anomaly.angle_deg);
                let step = step.put(value::OTHERS, anomaly.others).put(value::UNUSUAL_ANGLE, self.unusual_angle);
                step.say(case::UNUSUAL)
            }
            Some(Event::Learned(directions)) => {
                let step = at(line::LEARN_DIRECTIONS).put(value::CELLS, directions.all(self.min_others).len());
                self.conclude(step.put(value::MIN_OTHERS, self.min_others).say(case::LEARNED), seen)
            }
        };
        let x_max = state.span.first + state.span.frames().unwrap_or(state.frames.len()).saturating_sub(1);
        step.show_all(subject.iter().flat_map(|of| series(of, x_max)).map(Readout::Series))
    }

    fn conclude(&self, step: Step, seen: &Seen<Self>) -> Step {
        let Some(state) = seen.after.filter(|after| after.span.frames() == Some(after.frames.len())) else {
            return step;
        };
        let trajectories = || state.trajectories.iter();
        let anomalies = trajectories().filter(|of| of.sightings.iter().any(|seen| seen.anomaly.is_some())).count();
        let step = step.put(value::TRAJECTORIES, trajectories().len()).put(value::ANOMALIES, anomalies).say(case::RUN);
        let step = (0..self.lines.all().len()).fold(step, |step, line| {
            put_line(step, seen, line).say(case::RUN_CROSSINGS).say(self.line_case()).say(case::BOTH_WAYS)
        });
        let (zones, dwelt) = (self.zones.all().len(), trajectories().filter(|of| !of.dwells.is_empty()).count());
        let step = step.put(value::DWELT, dwelt).say_if(zones == 1, case::RUN_ZONE).say_if(zones > 1, case::RUN_ZONES);
        step.say(case::RUN_END)
    }

    fn tell_motion(&self, step: Step, trajectory: &Trajectory) -> Step {
        let Some(last) = trajectory.sightings.last() else { return step };
        let Some([u, v]) = last.velocity else { return step.put(value::POSITION, last.at).say(case::STARTS) };
        let sightings = trajectory.sightings.iter().rev();
        let first = sightings.take_while(|seen| seen.frame + self.window > last.frame).last().unwrap_or(last);
        let step = step.put(value::MIN_SPEED, self.min_speed).put(value::FITTED, last.frame - first.frame + 1);
        step.say(match first.frame < last.frame {
            _ if u.hypot(v) < f64::from(self.min_speed) => case::SLOW,
            true => case::FITTED,
            false => case::APART,
        })
    }

    /// Adds the counts of lines and zones.
    fn put_counts(&self, step: Step, seen: &Seen<Self>) -> Step {
        let (lines, zones) = (self.lines.all().len(), self.zones.all().len());
        let step = (0..lines).fold(step, |step, line| {
            let (step, [right, left]) = (put_line(step, seen, line), counts(seen, line));
            let case = if lines > 1 { case::COUNTED_AT_LINE } else { case::COUNTED };
            step.fact_as(value::CROSSINGS.is(right + left), case)
        });
        (0..zones).fold(step, |step, zone| match zones {
            1 => step.fact(value::INSIDE, inside(seen, zone)),
            _ => step.put(value::ZONE, zone + 1).fact_as(value::INSIDE.is(inside(seen, zone)), case::INSIDE_ZONE),
        })
    }

    /// Adds the facts of a trajectory, and the formulas of velocity, speed and heading.
    fn tell_following(&self, step: Step, trajectory: &Trajectory) -> Step {
        let step = step.fact(value::TRACK, trajectory.id);
        let step = match trajectory.sightings.last() {
            Some(TrackPoint { velocity: Some([u, v]), step: Some(last), .. }) => {
                let step = step.put(value::VELOCITY, [*u, *v]).put(value::V_X, *u).put(value::V_Y, *v);
                let step = step.fact(value::SPEED, u.hypot(*v)).fact(value::LAST_SPEED, last[0].hypot(last[1]));
                let step = step.fact_as(value::HEADING.is(whole_heading_deg([*u, *v])), case::HEADING);
                let step = step
                    .formula(r"\mathbf{v} = \frac{\sum_i (t_i - \bar{t}) (\mathbf{x}_i - \bar{\mathbf{x}})}{\sum_i (t_i - \bar{t})^2} = {velocity:unit}")
                    .formula(r"|\mathbf{v}| = \sqrt{v_x^2 + v_y^2} = \sqrt{{v_x}^2 + {v_y}^2} = {speed:unit}");
                match u.hypot(*v) >= f64::from(self.min_speed) {
                    true => step.formula(
                        r"\text{heading} = \text{atan2}(v_y, v_x) = \text{atan2}({v_y}, {v_x}) = {heading:unit}",
                    ),
                    false => step,
                }
            }
            _ => step,
        };
        let step = step.fact(value::PATH_LENGTH, trajectory.length_px());
        let step = step.fact_if(value::STRAIGHTNESS, trajectory.straightness().map(|share| 100.0 * share));
        let (zones, dwell) = (self.zones.all().len(), |zone| value::DWELL.is(trajectory.dwell_frames_in(zone)));
        (0..zones).fold(step, |step, zone| match zones {
            1 => step.fact_of(dwell(zone)),
            _ => step.put(value::ZONE, zone + 1).fact_as(dwell(zone), case::DWELL_IN_ZONE),
        })
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

    fn line_case(&self) -> &'static Case {
        if self.lines.all().len() > 1 { case::LINE } else { case::THE_LINE }
    }

    fn zone_case(&self) -> &'static Case {
        if self.zones.all().len() > 1 { case::ZONE } else { case::THE_ZONE }
    }
}

/// Puts a line with its crossings.
fn put_line(step: Step, seen: &Seen<TrajectoryAnalysis>, line: usize) -> Step {
    let [right, left] = counts(seen, line);
    step.put(value::LINE, line + 1).put(value::RIGHT, right).put(value::LEFT, left)
}

/// The objects of the current frame, or of the one before it.
pub(super) fn frame_at<'a>(seen: &Seen<'a, TrajectoryAnalysis>) -> Option<&'a Arc<ObjectFrame>> {
    let at_hand =
        seen.events.iter().find_map(|event| if let Event::Tracked(frame) = event { Some(frame) } else { None });
    at_hand.or(seen.before.frames.last())
}

/// All trajectories up to the step.
pub(super) fn now(seen: &Seen<TrajectoryAnalysis>) -> Vec<Arc<Trajectory>> {
    let mut all = seen.after.unwrap_or(seen.before).trajectories.clone();
    for of in seen.events.iter().filter_map(Event::trajectory) {
        match all.binary_search_by_key(&of.id, |trajectory| trajectory.id) {
            Ok(i) => all[i] = Arc::clone(of),
            Err(i) => all.insert(i, Arc::clone(of)),
        }
    }
    all
}

fn inside(seen: &Seen<TrajectoryAnalysis>, zone: usize) -> usize {
    let frame = frame_at(seen);
    let is_here = |of: &Trajectory| frame.is_some_and(|frame| frame.object(of.id).is_some());
    let is_inside = |of: &Trajectory| of.dwells.iter().any(|dwell| dwell.zone == zone && !dwell.is_over);
    now(seen).iter().filter(|of| is_here(of) && is_inside(of)).count()
}

/// The crossings of a line to its right and to its left.
pub(super) fn counts(seen: &Seen<TrajectoryAnalysis>, line: usize) -> [usize; 2] {
    let all = now(seen);
    let crossings = || all.iter().flat_map(|of| &of.crossings).filter(|crossing| crossing.line == line);
    let of = |is_forward: bool| crossings().filter(|crossing| crossing.is_forward == is_forward).count();
    [of(true), of(false)]
}

pub(super) fn frame_of(state: &State) -> usize {
    state.span.first + state.frames.len()
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
    let series = |title, y_label, lines| Series::new(title, ["frame", y_label], x_max, lines);
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
