//! Trajectory analysis: speed and heading, line crossings, dwell time in a zone, anomalous directions.

mod explain;
mod marks;

use std::sync::Arc;

use crate::base::{Error, Observer};
use crate::data::Clip;
use crate::methods::multi_object::directions::Directions;
use crate::params::{Lines, Zones};
use crate::products::{
    ObjectField, ObjectFrame, Output, Product, ProductKind, TrackStatus, Watched,
    objects::trajectory::{Crossing, DirectionAnomaly, Dwell, Places, Trajectory, TrajectoryEvents},
};
use crate::run::{
    Estimator, Explained, Footprint, Frames, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Span, Stage,
    Tracks, need,
};
use crate::scene::{Chart, Focus, Question, Role, Scene, Step};
use crate::{params, pseudocode};

params! {
    /// Analysis of the trajectories of tracks.
    pub struct TrajectoryAnalysis {
        /// Maximum number of frames, the first included.
        frames: usize = 300, 2..=10_000;
        /// Counting lines. Crossings of each are counted by direction: to its right and to its left.
        lines: Lines = Lines::default();
        /// Zones in which dwell time is measured. They may overlap.
        zones: Zones = Zones::default();
        /// Number of frames of the velocity estimate, the slope of the least-squares line through their positions.
        window: usize = 5, 2..=100, "frames";
        /// Minimum speed for a heading. Slower tracks have no heading, and no anomaly.
        min_speed: f32 = 0.5, 0.0..=100.0, "px/frame";
        /// Angle between a track's heading and the mean direction of the other tracks in its cell, above which the direction is
        /// anomalous.
        unusual_angle: f32 = 90.0, 10.0..=180.0, "°";
        /// Minimum number of other tracks in a cell for a direction to be anomalous.
        min_others: usize = 2, 1..=100;
        /// Side of the grid cells in which directions are averaged.
        cell_size: usize = 64, 8..=1000, "px";
        /// Tracker of the objects, by default in real time (causal), without hindsight.
        tracker: Stage<Tracks> = Stage::named("kalman-tracker");
    }
    advanced { "min-others", "cell-size" }
}

/// The minimum mean resultant length of directions with a meaningful mean.
const AGREEMENT: f64 = 0.7;
/// The number of tracks between checks for cancellation.
const TRACKS_PER_CHECK: usize = 64;
/// The maximum distance of the pointer from a trajectory that it selects, in px.
const NEAR_PX: f64 = 16.0;

/// The state of a run.
#[derive(Clone)]
pub struct State {
    span: Span,
    tracked: Frames,
    /// The finished frames, as they were known then.
    frames: Vec<Arc<ObjectFrame>>,
    /// By identity.
    trajectories: Vec<Arc<Trajectory>>,
    directions: Arc<Directions>,
    picture: (usize, usize),
}

/// An event of a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// The tracks of the frame.
    Tracked(Arc<ObjectFrame>),
    /// A trajectory has a new position.
    Moved(Arc<Trajectory>),
    /// A track crosses a line.
    Crossed(Arc<Trajectory>, Crossing),
    /// A track enters a zone.
    Entered(Arc<Trajectory>, Dwell),
    /// A track leaves a zone.
    Left(Arc<Trajectory>, Dwell),
    /// A track has an anomalous direction.
    Unusual(Arc<Trajectory>, DirectionAnomaly),
    /// The directions of the frame are added to the grid.
    Learned(Arc<Directions>),
}

impl Event {
    fn trajectory(&self) -> Option<&Arc<Trajectory>> {
        match self {
            Self::Moved(of) | Self::Crossed(of, _) | Self::Entered(of, _) | Self::Left(of, _) => Some(of),
            Self::Unusual(of, _) => Some(of),
            Self::Tracked(_) | Self::Learned(_) => None,
        }
    }
}

/// The direction of a track, a unit vector, at a position.
struct DirectionSample {
    id: u32,
    at: [f64; 2],
    direction: [f64; 2],
}

impl TrajectoryAnalysis {
    fn places(&self) -> Places {
        Places { lines: self.lines.clone(), zones: self.zones.clone(), window: self.window }
    }

    /// Adds the new positions of a track. Those of its tentative frames are added when it is confirmed.
    fn follow(&self, state: &mut State, id: u32, observer: &mut impl Observer<Event>) -> Vec<DirectionSample> {
        let (first, frames) = (state.span.first, &state.frames);
        let place = state.trajectories.binary_search_by_key(&id, |trajectory| trajectory.id);
        // Taken out, so that it is copied only if it is shared.
        let mut trajectory = match place {
            Ok(i) => std::mem::take(&mut state.trajectories[i]),
            Err(_) => Arc::new(Trajectory { id, ..Trajectory::default() }),
        };
        let begin = if place.is_ok() { frames.len() - 1 } else { 0 };
        let mut samples = Vec::new();
        for (i, frame) in frames.iter().enumerate().skip(begin) {
            let seen = frame.object(id).filter(|object| object.detection.is_some());
            let Some(object) = seen else { continue };
            let events = Arc::make_mut(&mut trajectory).add(first + i, object.position, &self.places());
            samples.extend(self.compare_direction(&mut trajectory, &state.directions));
            emit(&trajectory, events, observer);
        }
        match place {
            Ok(i) => state.trajectories[i] = trajectory,
            Err(i) => state.trajectories.insert(i, trajectory),
        }
        samples
    }

    /// Compares the heading of a track with the mean direction of the others; returns its direction.
    fn compare_direction(&self, trajectory: &mut Arc<Trajectory>, directions: &Directions) -> Option<DirectionSample> {
        let id = trajectory.id;
        let last = Arc::make_mut(trajectory).sightings.last_mut()?;
        let [u, v] = last.velocity?;
        let speed = u.hypot(v);
        if speed <= 0.0 || speed < f64::from(self.min_speed) {
            return None;
        }
        let direction = [u / speed, v / speed];
        let mean = directions.mean_of_others(id, last.at);
        let known = mean.filter(|mean| mean.others >= self.min_others && mean.agreement >= AGREEMENT);
        last.anomaly = known.and_then(|mean| {
            let cosine = direction[0] * mean.direction[0] + direction[1] * mean.direction[1];
            let angle_deg = cosine.clamp(-1.0, 1.0).acos().to_degrees();
            let unusual = DirectionAnomaly { angle_deg, mean: mean.direction, others: mean.others };
            (angle_deg > f64::from(self.unusual_angle)).then_some(unusual)
        });
        Some(DirectionSample { id, at: last.at, direction })
    }
}

fn emit(trajectory: &Arc<Trajectory>, events: TrajectoryEvents, observer: &mut impl Observer<Event>) {
    let of = || Arc::clone(trajectory);
    observer.see(|| Event::Moved(of()));
    events.crossed.into_iter().for_each(|crossing| observer.see(|| Event::Crossed(of(), crossing)));
    events.entered.into_iter().for_each(|dwell| observer.see(|| Event::Entered(of(), dwell)));
    events.left.into_iter().for_each(|dwell| observer.see(|| Event::Left(of(), dwell)));
    if let Some(unusual) = trajectory.sightings.last().and_then(|last| last.anomaly) {
        observer.see(|| Event::Unusual(of(), unusual));
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    TRACK: "  track the objects",
    EACH_OBJECT: "  for each confirmed track with position x(t)",
    MEASURE_VELOCITY: "    v ← slope of the least-squares line through its last positions",
    COUNT_CROSSING: "    count a crossing of each line that the segment from its last position to x(t) meets",
    NOTE_ZONE: "    update dwell times: note entry into and exit from each zone",
    IS_UNUSUAL: "    anomalous if the angle of v and the mean direction of the others > unusual-angle",
    LEARN_DIRECTIONS: "  add the directions of this frame to the grid cells",
}

impl Estimator for TrajectoryAnalysis {
    const INFO: Info = Info {
        id: "trajectory-analysis",
        name: "Trajectory analysis",
        family: "Tracking",
        summary: "Analyses the trajectories of tracks: speed and heading, line crossings, dwell time in zones, anomalous directions.",
        source: "Tracks: A. Bewley et al., Simple online and realtime tracking, ICIP 2016; typical directions: C. Stauffer and \
                 W. E. L. Grimson, Learning patterns of activity using real-time tracking, PAMI 22, 2000; circular means: \
                 K. V. Mardia and P. E. Jupp, Directional statistics, 2000",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] =
        &[Question::value("speed", "How fast is the next object?", line::MEASURE_VELOCITY, explain::value::SPEED)];
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const NEEDS_PICTURES: bool = false;
    const CHARTS: &'static [Chart] = &[Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ObjectField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let span = Span::new(clip, frame, self.frames)?;
        let tracked = self.tracker.frames(clip, span.first, span.most())?;
        let directions = Arc::new(Directions::new(clip.size(), self.cell_size));
        Ok(State { span, tracked, frames: Vec::new(), trajectories: Vec::new(), directions, picture: clip.size() })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        need::check_kept(clip, self.memory_bytes(state))?;
        let t = state.span.first + state.frames.len();
        let frame = state.tracked.at(t)?.unwrap_or_default();
        state.frames.push(Arc::clone(&frame));
        observer.see(|| Event::Tracked(Arc::clone(&frame)));
        let is_seen = |status: TrackStatus, has_detection: bool| status == TrackStatus::Confirmed && has_detection;
        let seen = frame.objects.iter().filter(|object| is_seen(object.status, object.detection.is_some()));
        let mut samples: Vec<DirectionSample> = Vec::new();
        for (i, object) in seen.enumerate() {
            if i.is_multiple_of(TRACKS_PER_CHECK) {
                clip.wanted()?;
            }
            samples.extend(self.follow(state, object.id, observer));
        }
        if !samples.is_empty() {
            let directions = Arc::make_mut(&mut state.directions);
            samples.into_iter().for_each(|DirectionSample { id, at, direction }| directions.learn(id, at, direction));
        }
        observer.see(|| Event::Learned(Arc::clone(&state.directions)));
        Ok(if state.span.is_over(clip, t + 1) { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.span.frames()
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.span.place(state.frames.len())
    }

    fn units_of(&self, _picture: (usize, usize), frames: usize) -> Option<usize> {
        Some(frames)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.span.first + state.frames.len())
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Crossed(..) => Some(Role::Best),
            Event::Unusual(..) => Some(Role::Error),
            _ => None,
        }
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(ObjectField {
            followed: state.tracked.followed(),
            picture: state.picture,
            first: state.span.first,
            frames: state.frames.clone(),
            trajectories: state.trajectories.clone(),
            watched: Watched { lines: self.lines.all().len(), zones: self.zones.all().len() },
        })
    }
}

impl Footprint<State> for TrajectoryAnalysis {
    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.tracker.need(clip);
        super::need(clip).and([run as f64; 2])
    }

    fn state_bytes(&self, state: &State) -> usize {
        // A trajectory that grows is copied; others are shared with the states before, as frames are.
        let next = state.span.first + state.frames.len();
        let grows =
            |trajectory: &&Arc<Trajectory>| trajectory.sightings.last().is_some_and(|seen| seen.frame + 1 >= next);
        let own: usize = state.trajectories.iter().filter(grows).map(|trajectory| bytes(trajectory)).sum();
        let last = state.frames.last().map_or(0, |frame| frame.bytes());
        size_of::<State>() + size_of_val(&state.frames[..]) + last + own + state.directions.bytes()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let trajectories: usize = state.trajectories.iter().map(|trajectory| bytes(trajectory)).sum();
        let own = size_of::<State>() + size_of_val(&state.frames[..]) + trajectories + state.directions.bytes();
        // The frames are shared with the tracker.
        own + state.tracked.bytes()
    }
}

impl Pointed<State> for TrajectoryAnalysis {
    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        near(&state.trajectories, point).map(|_| Explained::Always)
    }
}

fn bytes(trajectory: &Trajectory) -> usize {
    let Trajectory { sightings, crossings, dwells, .. } = trajectory;
    size_of::<Trajectory>() + size_of_val(&sightings[..]) + size_of_val(&crossings[..]) + size_of_val(&dwells[..])
}

/// Returns the trajectory nearest to a point, if it is near enough.
fn near(trajectories: &[Arc<Trajectory>], point: [f32; 2]) -> Option<&Arc<Trajectory>> {
    let far = |trajectory: &Trajectory| {
        let distances = trajectory
            .sightings
            .iter()
            .map(|seen| (seen.at[0] - f64::from(point[0])).hypot(seen.at[1] - f64::from(point[1])));
        distances.fold(f64::INFINITY, f64::min)
    };
    let nearest = trajectories.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
    (far(nearest) <= NEAR_PX).then_some(nearest)
}
