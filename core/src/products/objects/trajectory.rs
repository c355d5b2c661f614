//! What the way of an object tells: how fast and where it goes, what it crosses, where it dwells, and whether others go that way.

use crate::base::words::heading_deg;
use crate::geometry::Bounds;
use crate::params::Line;

/// Where an object was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// The frame.
    pub frame: usize,
    /// The place in px.
    pub at: [f64; 2],
    /// Velocity in px/frame since it was seen before; none where it was not.
    pub step: Option<[f64; 2]>,
    /// Velocity in px/frame of the straight line that fits its last places best; none where there is only one.
    pub velocity: Option<[f64; 2]>,
    /// How the way others go differs from this one, where it does by more than is usual.
    pub anomaly: Option<DirectionAnomaly>,
}

/// A heading that others do not have there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionAnomaly {
    /// Between the heading and the mean of the others, 0 to 180°.
    pub angle_deg: f64,
    /// The direction of that mean, a unit vector.
    pub usual: [f64; 2],
    /// How many others there were.
    pub others: usize,
}

/// An object that goes over a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The frame in which it was seen on the other side.
    pub frame: usize,
    /// Where its way meets the line.
    pub at: [f64; 2],
    /// Whether it goes to the right of who looks from the beginning of the line to its end.
    pub is_forward: bool,
}

/// A stay of an object in a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dwell {
    /// The first frame in which it was seen there.
    pub entered: usize,
    /// The last one so far.
    pub last: usize,
    /// Whether it has been seen elsewhere since.
    pub is_over: bool,
}

impl TrackPoint {
    /// Where it goes, in degrees from right, against the clock, more than −180 up to 180; `None` where it stands or is seen for
    /// the first time.
    pub fn heading_deg(&self) -> Option<f64> {
        self.velocity.filter(|velocity| *velocity != [0.0; 2]).map(heading_deg)
    }
}

impl Dwell {
    /// Its frames, the first and the last counted in.
    pub fn frames(&self) -> usize {
        self.last - self.entered + 1
    }
}

/// The way of one object, as far as it was seen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// Its identity.
    pub id: u32,
    /// Where it was seen, by frame.
    pub sightings: Vec<TrackPoint>,
    /// Where it went over the line.
    pub crossings: Vec<Crossing>,
    /// When it was in the zone.
    pub dwells: Vec<Dwell>,
}

/// What [`Trajectory::see`] has found out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrajectoryEvents {
    /// It has gone over the line.
    pub crossed: Option<Crossing>,
    /// It has come into the zone.
    pub entered: Option<Dwell>,
    /// It has left the zone.
    pub left: Option<Dwell>,
}

/// Where trajectories are looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Places {
    /// The line at which is counted.
    pub line: Option<Line>,
    /// The zone in which time is taken.
    pub zone: Option<Bounds>,
    /// Velocity is taken over so many frames.
    pub window: usize,
}

impl Trajectory {
    /// Takes in where the object is seen next.
    pub fn see(&mut self, frame: usize, at: [f64; 2], places: &Places) -> TrajectoryEvents {
        let before = self.sightings.last().copied();
        let step = before.map(|before| {
            let frames = (frame - before.frame).max(1) as f64;
            [0, 1].map(|i| (at[i] - before.at[i]) / frames)
        });
        self.sightings.push(TrackPoint { frame, at, step, velocity: None, anomaly: None });
        let recent = self.sightings.iter().rev().take_while(|seen| seen.frame + places.window > frame);
        let velocity = slope(recent.map(|seen| (seen.frame as f64, seen.at)));
        if let Some(last) = self.sightings.last_mut() {
            // Seen again after longer than that, only the step is known.
            last.velocity = velocity.or(step);
        }
        let crossed = before.zip(places.line).and_then(|(before, line)| {
            let (at, is_forward) = crossing(&line, before.at, at)?;
            Some(Crossing { frame, at, is_forward })
        });
        self.crossings.extend(crossed);
        let (entered, left) = self.update_dwell(frame, places.zone.is_some_and(|zone| holds(&zone, at)));
        TrajectoryEvents { crossed, entered, left }
    }

    /// Takes in whether it is in the zone.
    fn update_dwell(&mut self, frame: usize, is_inside: bool) -> (Option<Dwell>, Option<Dwell>) {
        match self.dwells.last_mut().filter(|dwell| !dwell.is_over) {
            Some(dwell) if is_inside => dwell.last = frame,
            Some(dwell) => {
                dwell.is_over = true;
                return (None, Some(*dwell));
            }
            None if is_inside => {
                let dwell = Dwell { entered: frame, last: frame, is_over: false };
                self.dwells.push(dwell);
                return (Some(dwell), None);
            }
            None => {}
        }
        (None, None)
    }

    /// The length of its way in px.
    pub fn length_px(&self) -> f64 {
        self.sightings.windows(2).map(|pair| apart(pair[0].at, pair[1].at)).fold(0.0, |sum, step| sum + step)
    }

    /// From its first place to its last, as a share of the length of its way: 1 where it went straight on.
    pub fn straightness(&self) -> Option<f64> {
        let (first, last) = (self.sightings.first()?, self.sightings.last()?);
        let length = self.length_px();
        (length > 0.0).then(|| apart(first.at, last.at) / length)
    }

    /// Its mean speed in px/frame.
    pub fn speed(&self) -> Option<f64> {
        let (first, last) = (self.sightings.first()?, self.sightings.last()?);
        (last.frame > first.frame).then(|| self.length_px() / (last.frame - first.frame) as f64)
    }

    /// Frames in which it was in the zone.
    pub fn dwell_frames(&self) -> usize {
        self.dwells.iter().map(Dwell::frames).sum()
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Whether a place lies in a zone; its left and upper edge belong to it.
pub fn holds(zone: &Bounds, at: [f64; 2]) -> bool {
    (0..2).all(|i| (f64::from(zone.min[i])..f64::from(zone.max[i])).contains(&at[i]))
}

/// The slope of the straight line that fits places over time best, by least squares: px for each frame.
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

/// Where the way from one place to another meets a line, and whether it goes to the line's right. A place on the line counts as
/// on its right, so that who stops there is counted once.
pub fn crossing(line: &Line, from: [f64; 2], to: [f64; 2]) -> Option<([f64; 2], bool)> {
    let (begin, end) = (line.from.map(f64::from), line.to.map(f64::from));
    let along = [end[0] - begin[0], end[1] - begin[1]];
    // Positive to the right of who looks along the line, since y points down.
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

    fn followed(places: &Places, way: impl IntoIterator<Item = (usize, [f64; 2])>) -> (Trajectory, Vec<TrajectoryEvents>) {
        let mut trajectory = Trajectory::default();
        let news = way.into_iter().map(|(frame, at)| trajectory.see(frame, at, places)).collect();
        (trajectory, news)
    }

    #[test]
    fn the_right_of_a_line_is_that_of_who_walks_along_it() {
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
    fn who_stops_on_a_line_is_counted_once() {
        let places = Places { line: Some(line([10.0, 20.0], [10.0, 0.0])), zone: None, window: 5 };
        let (there, _) = followed(&places, (0..5).map(|t| (t, [8.0 + t as f64, 9.0])));
        assert_eq!(there.crossings.iter().map(|c| (c.frame, c.is_forward)).collect::<Vec<_>>(), [(2, true)]);
        let (back, _) =
            followed(&places, [9.0, 10.0, 9.0, 10.0, 11.0].into_iter().enumerate().map(|(t, x)| (t, [x, 9.0])));
        assert_eq!(back.crossings.iter().map(|c| c.is_forward).collect::<Vec<_>>(), [true, false, true]);
    }

    #[test]
    fn a_stay_lasts_from_the_first_frame_inside_to_the_last() {
        let zone = Bounds { min: [10.0, 0.0], max: [20.0, 9.0] };
        let places = Places { line: None, zone: Some(zone), window: 5 };
        let way = [(0, 5.0), (1, 10.0), (2, 15.0), (5, 19.0), (6, 20.0), (7, 12.0)].map(|(t, x)| (t, [x, 3.0]));
        let (trajectory, news) = followed(&places, way);
        let dwells: Vec<_> = trajectory.dwells.iter().map(|dwell| (dwell.entered, dwell.last, dwell.is_over)).collect();
        assert_eq!(dwells, [(1, 5, true), (7, 7, false)]);
        assert_eq!(
            (trajectory.dwell_frames(), news[1].entered.is_some(), news[4].left.map(|s| s.frames())),
            (6, true, Some(5))
        );
    }

    #[test]
    fn velocity_is_that_of_the_line_that_fits_best() {
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
