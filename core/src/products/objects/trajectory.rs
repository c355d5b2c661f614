//! Trajectories: velocity, line crossings, dwell time in a zone, and anomalous directions of a track.
//!
//! They are counted from the confirmation of a track on.

use crate::base::words::heading_deg;
use crate::geometry::Bounds;
use crate::params::{Line, Lines, Zones};

/// A position of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// The frame.
    pub frame: usize,
    /// The position in px.
    pub at: [f64; 2],
    /// Velocity in px/frame since the last position; none at the first one.
    pub step: Option<[f64; 2]>,
    /// Velocity in px/frame by least squares over the last positions; none at the first one.
    pub velocity: Option<[f64; 2]>,
    /// The anomaly of the direction, if there is one.
    pub anomaly: Option<DirectionAnomaly>,
}

/// A direction far from the mean of the other tracks in its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionAnomaly {
    /// Angle to the mean direction, 0 to 180°.
    pub angle_deg: f64,
    /// The mean direction of the others, a unit vector.
    pub mean: [f64; 2],
    /// The number of other tracks.
    pub others: usize,
}

/// A crossing of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The index of the line.
    pub line: usize,
    /// The first frame on the other side.
    pub frame: usize,
    /// The intersection with the line in px.
    pub at: [f64; 2],
    /// Whether the crossing is to the right as seen from the beginning of the line to its end.
    pub is_forward: bool,
}

/// A visit of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dwell {
    /// The index of the zone.
    pub zone: usize,
    /// The first frame inside.
    pub entered: usize,
    /// The last frame inside so far.
    pub last: usize,
    /// Whether the track has left.
    pub is_over: bool,
}

impl TrackPoint {
    /// Returns the heading in degrees from x (right) towards y (down), more than −180 up to 180; `None` at rest or at the first
    /// position.
    pub fn heading_deg(&self) -> Option<f64> {
        self.velocity.filter(|velocity| *velocity != [0.0; 2]).map(heading_deg)
    }
}

impl Dwell {
    /// Returns the dwell time in frames, the first and the last included.
    pub fn frames(&self) -> usize {
        self.last - self.entered + 1
    }
}

/// The trajectory of a track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// Its identity.
    pub id: u32,
    /// Its positions, by frame.
    pub sightings: Vec<TrackPoint>,
    /// Its crossings of lines.
    pub crossings: Vec<Crossing>,
    /// Its visits of zones.
    pub dwells: Vec<Dwell>,
}

/// The events of a new position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrajectoryEvents {
    /// The crossings, by line.
    pub crossed: Vec<Crossing>,
    /// The entries, by zone.
    pub entered: Vec<Dwell>,
    /// The exits, by zone.
    pub left: Vec<Dwell>,
}

/// The lines, the zones and the window of an analysis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Places {
    /// The counting lines.
    pub lines: Lines,
    /// The zones of dwell times.
    pub zones: Zones,
    /// The frames that a velocity is fitted to.
    pub window: usize,
}

impl Trajectory {
    /// Adds the next position.
    pub fn add(&mut self, frame: usize, at: [f64; 2], places: &Places) -> TrajectoryEvents {
        let before = self.sightings.last().copied();
        let step = before.map(|before| {
            let frames = (frame - before.frame).max(1) as f64;
            [0, 1].map(|i| (at[i] - before.at[i]) / frames)
        });
        self.sightings.push(TrackPoint { frame, at, step, velocity: None, anomaly: None });
        let recent = self.sightings.iter().rev().take_while(|seen| seen.frame + places.window > frame);
        let velocity = slope(recent.map(|seen| (seen.frame as f64, seen.at)));
        if let Some(last) = self.sightings.last_mut() {
            // After a gap longer than the window only the step is known.
            last.velocity = velocity.or(step);
        }
        let lines =
            before.iter().flat_map(|before| places.lines.all().iter().enumerate().map(move |line| (before, line)));
        let crossed: Vec<Crossing> = lines
            .filter_map(|(before, (line, of))| {
                let (at, is_forward) = crossing(of, before.at, at)?;
                Some(Crossing { line, frame, at, is_forward })
            })
            .collect();
        self.crossings.extend(&crossed);
        let mut events = TrajectoryEvents { crossed, ..TrajectoryEvents::default() };
        for (zone, of) in places.zones.all().iter().enumerate() {
            self.update_dwell(frame, (zone, holds(of, at)), &mut events);
        }
        events
    }

    /// Updates the visits of a zone, of which it is known whether the track is inside.
    fn update_dwell(&mut self, frame: usize, (zone, is_inside): (usize, bool), events: &mut TrajectoryEvents) {
        match self.dwells.iter_mut().rev().find(|dwell| dwell.zone == zone && !dwell.is_over) {
            Some(dwell) if is_inside => dwell.last = frame,
            Some(dwell) => {
                dwell.is_over = true;
                events.left.push(*dwell);
            }
            None if is_inside => {
                let dwell = Dwell { zone, entered: frame, last: frame, is_over: false };
                self.dwells.push(dwell);
                events.entered.push(dwell);
            }
            None => {}
        }
    }

    /// Returns the path length in px.
    pub fn length_px(&self) -> f64 {
        self.sightings.windows(2).map(|pair| apart(pair[0].at, pair[1].at)).fold(0.0, |sum, step| sum + step)
    }

    /// Returns the straightness: distance from the first to the last position over the path length, at most 1.
    pub fn straightness(&self) -> Option<f64> {
        let (first, last) = (self.sightings.first()?, self.sightings.last()?);
        let length = self.length_px();
        (length > 0.0).then(|| apart(first.at, last.at) / length)
    }

    /// Returns the mean speed in px/frame.
    pub fn speed(&self) -> Option<f64> {
        let (first, last) = (self.sightings.first()?, self.sightings.last()?);
        (last.frame > first.frame).then(|| self.length_px() / (last.frame - first.frame) as f64)
    }

    /// Returns the total dwell time in frames, of all zones.
    pub fn dwell_frames(&self) -> usize {
        self.dwells.iter().map(Dwell::frames).sum()
    }

    /// Returns the total dwell time in a zone in frames.
    pub fn dwell_frames_in(&self, zone: usize) -> usize {
        self.dwells.iter().filter(|dwell| dwell.zone == zone).map(Dwell::frames).sum()
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Returns whether a position is in a zone; its left and upper edges belong to it.
pub fn holds(zone: &Bounds, at: [f64; 2]) -> bool {
    (0..2).all(|i| (f64::from(zone.min[i])..f64::from(zone.max[i])).contains(&at[i]))
}

/// Returns the slope of the least-squares line through positions over time in px/frame.
fn slope(places: impl Iterator<Item = (f64, [f64; 2])> + Clone) -> Option<[f64; 2]> {
    let count = places.clone().count() as f64;
    let mean = |of: &dyn Fn((f64, [f64; 2])) -> f64| places.clone().map(of).sum::<f64>() / count;
    let (t, x, y) = (mean(&|(t, _)| t), mean(&|(_, at)| at[0]), mean(&|(_, at)| at[1]));
    let spread: f64 = places.clone().map(|(time, _)| (time - t).powi(2)).sum();
    if spread <= 0.0 {
        return None;
    }
    let along = |i: usize, middle: f64| places.clone().map(|(time, at)| (time - t) * (at[i] - middle)).sum::<f64>();
    Some([along(0, x) / spread, along(1, y) / spread])
}

/// Returns the intersection of a segment with a line, and whether the crossing is to the line's right. A position on the line
/// counts as right of it, so that a track that stops there is counted once.
pub fn crossing(line: &Line, from: [f64; 2], to: [f64; 2]) -> Option<([f64; 2], bool)> {
    let (begin, end) = (line.from.map(f64::from), line.to.map(f64::from));
    let along = [end[0] - begin[0], end[1] - begin[1]];
    // Positive to the right as seen along the line, since y points down.
    let side = |at: [f64; 2]| along[0] * (at[1] - begin[1]) - along[1] * (at[0] - begin[0]);
    let (before, after) = (side(from), side(to));
    if (before >= 0.0) == (after >= 0.0) {
        return None;
    }
    let share = before / (before - after);
    let at = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
    let length = along[0] * along[0] + along[1] * along[1];
    let place = ((at[0] - begin[0]) * along[0] + (at[1] - begin[1]) * along[1]) / length;
    (0.0..=1.0).contains(&place).then_some((at, after >= 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: [f32; 2], to: [f32; 2]) -> Line {
        Line { from, to }
    }

    fn followed(
        places: &Places,
        way: impl IntoIterator<Item = (usize, [f64; 2])>,
    ) -> (Trajectory, Vec<TrajectoryEvents>) {
        let mut trajectory = Trajectory::default();
        let events = way.into_iter().map(|(frame, at)| trajectory.add(frame, at, places)).collect();
        (trajectory, events)
    }

    #[test]
    fn right_of_a_line_is_as_seen_along_it() {
        // Up the picture: right is where x grows.
        let up = line([10.0, 20.0], [10.0, 0.0]);
        assert_eq!(crossing(&up, [8.0, 10.0], [12.0, 10.0]), Some(([10.0, 10.0], true)));
        assert_eq!(crossing(&up, [12.0, 4.0], [8.0, 8.0]), Some(([10.0, 6.0], false)));
        assert_eq!(crossing(&up, [8.0, 30.0], [12.0, 30.0]), None, "beyond its end");
        assert_eq!(crossing(&up, [2.0, 10.0], [8.0, 10.0]), None, "not reached");
        // To the right: right is down, where y grows.
        assert_eq!(crossing(&line([0.0, 5.0], [9.0, 5.0]), [3.0, 1.0], [3.0, 9.0]), Some(([3.0, 5.0], true)));
    }

    #[test]
    fn a_stop_on_a_line_is_counted_once() {
        let lines = [line([10.0, 20.0], [10.0, 0.0])].into_iter().collect();
        let places = Places { lines, zones: Zones::default(), window: 5 };
        let (there, _) = followed(&places, (0..5).map(|t| (t, [8.0 + t as f64, 9.0])));
        assert_eq!(there.crossings.iter().map(|c| (c.frame, c.is_forward)).collect::<Vec<_>>(), [(2, true)]);
        let (back, _) =
            followed(&places, [9.0, 10.0, 9.0, 10.0, 11.0].into_iter().enumerate().map(|(t, x)| (t, [x, 9.0])));
        assert_eq!(back.crossings.iter().map(|c| c.is_forward).collect::<Vec<_>>(), [true, false, true]);
    }

    #[test]
    fn dwell_time_lasts_from_the_first_frame_inside_to_the_last() {
        let zone = Bounds { min: [10.0, 0.0], max: [20.0, 9.0] };
        let places = Places { lines: Lines::default(), zones: [zone].into_iter().collect(), window: 5 };
        let way = [(0, 5.0), (1, 10.0), (2, 15.0), (5, 19.0), (6, 20.0), (7, 12.0)].map(|(t, x)| (t, [x, 3.0]));
        let (trajectory, events) = followed(&places, way);
        let dwells: Vec<_> = trajectory.dwells.iter().map(|dwell| (dwell.entered, dwell.last, dwell.is_over)).collect();
        assert_eq!(dwells, [(1, 5, true), (7, 7, false)]);
        assert_eq!(
            (trajectory.dwell_frames(), events[1].entered.len(), events[4].left.iter().map(|s| s.frames()).next()),
            (6, 1, Some(5))
        );
    }

    #[test]
    fn lines_and_zones_are_counted_each_for_itself() {
        let lines = [10.0, 20.0].map(|x| line([x, 20.0], [x, 0.0])).into_iter().collect();
        // The second zone overlaps the first.
        let zones = [[5.0, 16.0], [14.0, 30.0]].map(|[a, b]| Bounds { min: [a, 0.0], max: [b, 9.0] });
        let places = Places { lines, zones: zones.into_iter().collect(), window: 5 };
        let (found, events) = followed(&places, (0..12).map(|t| (t, [3.0 * t as f64, 5.0])));
        let crossed: Vec<_> = found.crossings.iter().map(|c| (c.line, c.frame, c.is_forward)).collect();
        assert_eq!(crossed, [(0, 4, true), (1, 7, true)]);
        let dwells: Vec<_> = found.dwells.iter().map(|dwell| (dwell.zone, dwell.entered, dwell.last)).collect();
        assert_eq!(dwells, [(0, 2, 5), (1, 5, 9)]);
        assert_eq!([0, 1].map(|zone| found.dwell_frames_in(zone)), [4, 5]);
        // A long step over both lines is a crossing of each.
        let (fast, of_step) = followed(&places, [(0, [0.0, 5.0]), (1, [40.0, 5.0])]);
        assert_eq!((fast.crossings.len(), of_step[1].crossed.len(), events.len()), (2, 2, 12));
    }

    #[test]
    fn velocity_is_fitted_by_least_squares() {
        let places = Places { window: 4, ..Places::default() };
        // A constant velocity is found exactly, also over a gap.
        let way = [0, 1, 2, 5, 6].map(|t| (t, [3.0 * t as f64 - 7.0, -0.5 * t as f64]));
        let (steady, _) = followed(&places, way);
        for seen in &steady.sightings[1..] {
            let [u, v] = seen.velocity.expect("it was seen before");
            assert!((u - 3.0).abs() < 1e-12 && (v + 0.5).abs() < 1e-12, "{seen:?}");
            assert_eq!(seen.step, Some([3.0, -0.5]));
        }
        assert_eq!((steady.sightings[0].velocity, steady.straightness()), (None, Some(1.0)));
        // Against the formula for evenly spaced frames: Σ (t − t̄) x / Σ (t − t̄)².
        let (shaken, _) = followed(&places, [0.0, 4.0, 5.0, 9.0].into_iter().enumerate().map(|(t, x)| (t, [x, 0.0])));
        let expected = (-1.5 * 0.0 - 0.5 * 4.0 + 0.5 * 5.0 + 1.5 * 9.0) / 5.0;
        assert!((shaken.sightings[3].velocity.expect("four places")[0] - expected).abs() < 1e-12);
        assert_eq!((shaken.length_px(), shaken.speed()), (9.0, Some(3.0)));
    }
}
