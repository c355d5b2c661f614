//! What trajectories tell: speed and heading, crossings of a line, dwell in a zone, unusual directions.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer};
use crate::data::Clip;
use crate::geometry::Bounds;
use crate::methods::multi_object::directions::Directions;
use crate::params::Line;
use crate::products::{
    ObjectField, ObjectFrame, Output, Product, ProductKind, TrackStatus,
    objects::trajectory::{Crossing, News, Places, Stay, Trajectory, Unusual},
};
use crate::run::{
    Estimator, Explained, Footprint, Frames, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Span, Stage,
    Tracks, need,
};
use crate::scene::{Chart, Focus, Role, Scene, Step};
use crate::{params, pseudocode};

params! {
    /// What trajectories tell.
    pub struct TrajectoryAnalysis {
        /// At most so many frames, the first one counted; fewer where the clip ends.
        frames: usize = 300, 2..=10_000;
        /// Whoever goes over this line is counted, on its right and on its left.
        line: Option<Line> = None::<Line>;
        /// In this zone time is taken.
        zone: Option<Bounds> = None::<Bounds>;
        /// Speed and heading are those of the straight line that fits the places of so many frames best.
        window: usize = 5, 2..=100, "frames";
        /// Slower objects have no heading.
        min_speed: f32 = 0.5, 0.0..=100.0, "px/frame";
        /// A heading that differs by more than this from that of the others is unusual.
        unusual_angle: f32 = 90.0, 10.0..=180.0, "°";
        /// So many others must have passed before a heading can be unusual.
        least_others: usize = 2, 1..=100;
        /// Side of the parts of the picture in which the headings of the others are taken together.
        part: usize = 64, 8..=1000, "px";
        /// Tracker of the objects. Unless set otherwise it has no hindsight: what is analysed is what was seen.
        tracker: Stage<Tracks> = Stage::named("kalman-tracker");
    }
    renamed {
        "source" => "tracker.source",
        "detector" => "tracker.detector",
        "clicks" => "tracker.clicks",
        "min-score" => "tracker.min-score",
        "added-noise" => "tracker.added-noise",
        "seed" => "tracker.seed",
    }
    advanced { "least-others", "part" }
}

/// Others have a common heading where their mean of unit vectors is at least so long.
const AGREEMENT: f64 = 0.7;
/// So many objects are followed before it is asked whether to go on.
const OBJECTS_AT_ONCE: usize = 64;
/// Who points so near to the way of an object, in px, hears of it.
const NEAR_PX: f64 = 16.0;

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    span: Span,
    tracked: Frames,
    /// The frames that are done, as they were known then.
    frames: Vec<Arc<ObjectFrame>>,
    /// By identity.
    trajectories: Vec<Arc<Trajectory>>,
    directions: Arc<Directions>,
    picture: (usize, usize),
}

/// What happens in a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// The objects are tracked into the frame.
    Tracked(Arc<ObjectFrame>),
    /// An object has gone on.
    Moved(Arc<Trajectory>),
    /// It has gone over the line.
    Crossed(Arc<Trajectory>, Crossing),
    /// It has come into the zone.
    Entered(Arc<Trajectory>, Stay),
    /// It has left the zone.
    Left(Arc<Trajectory>, Stay),
    /// It goes where the others do not.
    Unusual(Arc<Trajectory>, Unusual),
    /// The directions of this frame are taken in.
    Learned(Arc<Directions>),
}

impl Event {
    /// The object that it is about.
    fn trajectory(&self) -> Option<&Arc<Trajectory>> {
        match self {
            Self::Moved(of) | Self::Crossed(of, _) | Self::Entered(of, _) | Self::Left(of, _) => Some(of),
            Self::Unusual(of, _) => Some(of),
            Self::Tracked(_) | Self::Learned(_) => None,
        }
    }
}

/// That an object goes in a direction, a unit vector, at a place.
struct Lesson {
    id: u32,
    at: [f64; 2],
    direction: [f64; 2],
}

impl TrajectoryAnalysis {
    fn places(&self) -> Places {
        Places { line: self.line, zone: self.zone, window: self.window }
    }

    /// Takes in all places of an object up to now that are not known yet: that it was seen where it was not yet confirmed is
    /// known only once it is.
    fn follow(&self, state: &mut State, id: u32, observer: &mut impl Observer<Event>) -> Vec<Lesson> {
        let (first, frames) = (state.span.first, &state.frames);
        let place = state.trajectories.binary_search_by_key(&id, |trajectory| trajectory.id);
        // Taken out, so that it is not copied where nobody else holds it.
        let mut trajectory = match place {
            Ok(i) => std::mem::take(&mut state.trajectories[i]),
            Err(_) => Arc::new(Trajectory { id, ..Trajectory::default() }),
        };
        let begin = if place.is_ok() { frames.len() - 1 } else { 0 };
        let mut lessons = Vec::new();
        for (i, frame) in frames.iter().enumerate().skip(begin) {
            let seen = frame.object(id).filter(|object| object.detection.is_some());
            let Some(object) = seen else { continue };
            let news = Arc::make_mut(&mut trajectory).see(first + i, object.position, &self.places());
            lessons.extend(self.judge(&mut trajectory, &state.directions));
            tell(&trajectory, news, observer);
        }
        match place {
            Ok(i) => state.trajectories[i] = trajectory,
            Err(i) => state.trajectories.insert(i, trajectory),
        }
        lessons
    }

    /// Compares the heading of an object with that of the others; gives what they can learn from it.
    fn judge(&self, trajectory: &mut Arc<Trajectory>, directions: &Directions) -> Option<Lesson> {
        let id = trajectory.id;
        let last = Arc::make_mut(trajectory).sightings.last_mut()?;
        let [u, v] = last.velocity?;
        let speed = u.hypot(v);
        if speed <= 0.0 || speed < f64::from(self.min_speed) {
            return None;
        }
        let direction = [u / speed, v / speed];
        let usual = directions.usual(id, last.at);
        let known = usual.filter(|usual| usual.others >= self.least_others && usual.agreement >= AGREEMENT);
        last.unusual = known.and_then(|usual| {
            let cosine = direction[0] * usual.direction[0] + direction[1] * usual.direction[1];
            let angle_deg = cosine.clamp(-1.0, 1.0).acos().to_degrees();
            let unusual = Unusual { angle_deg, usual: usual.direction, others: usual.others };
            (angle_deg > f64::from(self.unusual_angle)).then_some(unusual)
        });
        Some(Lesson { id, at: last.at, direction })
    }
}

/// Tells what is new of an object.
fn tell(trajectory: &Arc<Trajectory>, news: News, observer: &mut impl Observer<Event>) {
    let of = || Arc::clone(trajectory);
    observer.see(|| Event::Moved(of()));
    if let Some(crossing) = news.crossed {
        observer.see(|| Event::Crossed(of(), crossing));
    }
    if let Some(stay) = news.entered {
        observer.see(|| Event::Entered(of(), stay));
    }
    if let Some(stay) = news.left {
        observer.see(|| Event::Left(of(), stay));
    }
    if let Some(unusual) = trajectory.sightings.last().and_then(|last| last.unusual) {
        observer.see(|| Event::Unusual(of(), unusual));
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    TRACK: "  track the objects",
    EACH_OBJECT: "  for each object that is seen, x(t) its place",
    MEASURE_VELOCITY: "    v ← slope of the line that fits its last places best",
    COUNT_CROSSING: "    count it if the way from where it was seen before to x(t) meets the line",
    NOTE_ZONE: "    note when it comes into the zone, and when it leaves",
    IS_UNUSUAL: "    unusual if v differs too much from the mean direction of others there",
    LEARN_DIRECTIONS: "  learn the directions of this frame",
}

impl Estimator for TrajectoryAnalysis {
    const INFO: Info = Info {
        id: "trajectory-analysis",
        name: "Trajectory analysis",
        family: "Tracking",
        summary: "Tracks objects and reads their ways: speed and heading, counts at a line, time in a zone, unusual directions.",
        source: "Tracks: A. Bewley et al., Simple online and realtime tracking, ICIP 2016; usual directions: C. Stauffer and \
                 W. E. L. Grimson, Learning patterns of activity using real-time tracking, PAMI 22, 2000; means of directions: \
                 K. V. Mardia and P. E. Jupp, Directional statistics, 2000",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const NEEDS_PICTURES: bool = false;
    const CHARTS: &'static [Chart] = &[Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ObjectField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let span = Span::new(clip, frame, self.frames)?;
        let tracked = self.tracker.frames(clip, span.first, span.most())?;
        let directions = Arc::new(Directions::new(clip.size(), self.part));
        Ok(State { span, tracked, frames: Vec::new(), trajectories: Vec::new(), directions, picture: clip.size() })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        need::check_kept(clip, self.memory_bytes(state))?;
        let t = state.span.first + state.frames.len();
        let frame = state.tracked.at(t)?.unwrap_or_default();
        state.frames.push(Arc::clone(&frame));
        observer.see(|| Event::Tracked(Arc::clone(&frame)));
        let is_seen = |life: TrackStatus, has_detection: bool| life == TrackStatus::Confirmed && has_detection;
        let seen = frame.objects.iter().filter(|object| is_seen(object.life, object.detection.is_some()));
        let mut lessons: Vec<Lesson> = Vec::new();
        for (i, object) in seen.enumerate() {
            if i.is_multiple_of(OBJECTS_AT_ONCE) {
                clip.wanted()?;
            }
            lessons.extend(self.follow(state, object.id, observer));
        }
        if !lessons.is_empty() {
            let directions = Arc::make_mut(&mut state.directions);
            lessons.into_iter().for_each(|Lesson { id, at, direction }| directions.learn(id, at, direction));
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
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(ObjectField {
            followed: state.tracked.followed(),
            picture: state.picture,
            first: state.span.first,
            frames: state.frames.clone(),
            trajectories: state.trajectories.clone(),
        })
    }
}

impl Footprint<State> for TrajectoryAnalysis {
    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.tracker.need(clip);
        super::need(clip).and([run as f64; 2])
    }

    fn state_bytes(&self, state: &State) -> usize {
        // A trajectory is copied where it goes on; others are shared with the states before, as frames are.
        let next = state.span.first + state.frames.len();
        let goes_on =
            |trajectory: &&Arc<Trajectory>| trajectory.sightings.last().is_some_and(|seen| seen.frame + 1 >= next);
        let own: usize = state.trajectories.iter().filter(goes_on).map(|trajectory| bytes(trajectory)).sum();
        let last = state.frames.last().map_or(0, |frame| frame.bytes());
        size_of::<State>() + size_of_val(&state.frames[..]) + last + own + state.directions.bytes()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let trajectories: usize = state.trajectories.iter().map(|trajectory| bytes(trajectory)).sum();
        let own = size_of::<State>() + size_of_val(&state.frames[..]) + trajectories + state.directions.bytes();
        // The frames are those of the tracker.
        own + state.tracked.bytes()
    }
}

impl Pointed<State> for TrajectoryAnalysis {
    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        near(&state.trajectories, point).map(|_| Explained::Always)
    }
}

fn bytes(trajectory: &Trajectory) -> usize {
    let Trajectory { sightings, crossings, stays, .. } = trajectory;
    size_of::<Trajectory>() + size_of_val(&sightings[..]) + size_of_val(&crossings[..]) + size_of_val(&stays[..])
}

/// The trajectory that comes nearest to a point, if one does.
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
