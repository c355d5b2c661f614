//! The Kalman filter on one object: predict, gate and update in each frame, and at the end a walk back.

mod matrices;
mod tell;

use std::sync::Arc;

use crate::kalman::{Filter, Measurement, MotionModel, chi_square};
use crate::objects::source::{Detector, Given, Noise, Source, center, truth_of};
use crate::objects::{Detection, Life, Object, ObjectField, ObjectFrame};
use crate::params::Spots;
use crate::scene::Chart;
use crate::span::Span;
use crate::{
    Clip, Error, Estimator, Info, Observer, Output, Progress, Promise, Role, Rung, Scene, Seen, Step, choices, params,
};

choices! {
    /// What measures the object.
    pub enum Sensors {
        /// One that tells where it is.
        One = "one" "One position",
        /// Two that tell where it is, each with its own noise.
        Two = "two-positions" "Two positions",
        /// One that tells where it is, and one that tells where it is and how it moves.
        WithVelocity = "position-and-velocity" "Position, and position with velocity",
    }
}

choices! {
    /// How much of what may be an ellipse holds.
    pub enum Confidence {
        /// One standard deviation along each of its axes: 39 %.
        One = "1-sigma" "1 σ",
        /// Two standard deviations: 86 %.
        Two = "2-sigma" "2 σ",
        /// 95 %, which takes 2.45 standard deviations.
        NinetyFive = "95-percent" "95 %",
    }
}

impl Confidence {
    /// The share of a normal distribution in the plane.
    fn share(self) -> f64 {
        match self {
            Self::One => chi_square::share(1.0, 2),
            Self::Two => chi_square::share(4.0, 2),
            Self::NinetyFive => 0.95,
        }
    }
}

params! {
    /// The Kalman filter on one object.
    pub struct KalmanFilter {
        /// At most so many frames, the first one counted; fewer where the clip ends.
        frames: usize = 300, 2..=10_000;
        /// How the object is thought to move.
        motion: MotionModel = MotionModel::Velocity;
        /// Standard deviation of what disturbs the motion: an acceleration, or in constant acceleration its change in a frame.
        process_noise: f32 = 0.5, 0.0..=50.0, "px/frame²";
        /// Standard deviation of what disturbs the rate of a coordinated turn.
        turn_noise: f32 = 0.5, 0.0..=45.0, "°/frame²";
        /// Standard deviation of a measured place along each axis, as the filter takes it to be.
        measurement_noise: f32 = 2.0, 0.01..=100.0, "px";
        /// Who detects the object.
        source: Source = Source::Auto;
        /// Places in frames, clicked on the picture, that stand for what a detector finds.
        clicks: Spots = Spots::default();
        /// Which object is followed, in the order in which they stand in the first frame that shows any; detections are ranked by their score and their size.
        object: usize = 1, 1..=1000;
        /// Standard deviation of the noise that a true place is measured with.
        added_noise: f32 = 2.0, 0.0..=100.0, "px";
        /// Which noise that is.
        seed: u32 = 1, 0..=9999;
        /// What measures the object.
        sensors: Sensors = Sensors::One;
        /// Standard deviation of what the second sensor says of the place, if there is one.
        second_noise: f32 = 4.0, 0.01..=100.0, "px";
        /// Standard deviation of what it says of the velocity.
        velocity_noise: f32 = 1.0, 0.01..=100.0, "px/frame";
        /// A measurement is taken if it lies where this share of all measurements of the object would lie.
        gate: f32 = 0.99, 0.5..=0.9999;
        /// The first frame of the run, counted from 0, in which nothing is measured, if there are such.
        drop_from: usize = 0, 0..=10_000;
        /// In so many frames nothing is measured, as if something hid the object.
        drop_frames: usize = 0, 0..=1000;
        /// The filter gives the object up after so many frames in a row without a measurement, and begins anew.
        patience: usize = 30, 1..=1000;
        /// How fast the object may be at first.
        first_speed: f32 = 30.0, 0.1..=500.0, "px/frame";
        /// How much of what may be an ellipse holds.
        confidence: Confidence = Confidence::NinetyFive;
        /// Walk back at the end, so that each frame knows what came later.
        smooth: bool = true;
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    span: Span,
    detector: Detector,
    /// Who is followed, once that is known: its true identity, where there is truth.
    truth_id: Option<u32>,
    /// What is believed now, unless nothing was seen yet or the object was given up.
    filter: Option<Filter>,
    /// Frames in a row without a measurement.
    missed: usize,
    /// How many objects there were before this one: its identity less 1.
    begun: u32,
    /// Size of its box, if boxes are detected.
    size: [f32; 2],
    /// What each frame came to.
    moments: Vec<Arc<Moment>>,
    /// Frames that are smoothed, counted from the last; `None` while frames are filtered.
    back: Option<usize>,
    picture: (usize, usize),
}

/// What a frame came to.
#[derive(Clone, Debug, Default)]
struct Moment {
    detections: Arc<Vec<Detection>>,
    /// What was measured of the object.
    measured: Vec<[f64; 2]>,
    /// What was expected.
    predicted: Option<Filter>,
    /// What was believed then.
    filtered: Option<Filter>,
    /// What is believed with all that came later.
    smoothed: Option<Filter>,
    /// Whether the object is another one than in the frame before.
    begins: bool,
    /// Normalised innovation squared of each measurement that was taken, with its degrees of freedom.
    nis: Vec<(f64, usize)>,
    truth: Option<[f64; 2]>,
    object: Option<Object>,
}

impl Moment {
    fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.detections[..])
    }
}

/// What happens in a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// What was detected, and of that what is measured of the object.
    Looked(Arc<Vec<Detection>>, Vec<Measurement>, Option<[f64; 2]>),
    /// The frame is one of those in which the object is not to be seen.
    Hidden(Option<[f64; 2]>),
    /// A time step.
    Predicted(Box<[Filter; 2]>),
    /// A measurement is compared with what is expected: which sensor's, its squared distance and the limit of that.
    Gated(Box<Gated>),
    /// A measurement was taken: what was believed before and is believed after it.
    Updated(Box<(Gated, Filter)>),
    /// The first measurement of an object.
    Begun(Box<Filter>),
    /// Nothing was measured: the prediction stands, or there is none.
    Missed(Option<Box<Filter>>),
    /// The object was given up.
    Lost(Box<Filter>),
    /// A frame, with what is known of the next one: what was believed, and what is now.
    Smoothed(Box<[Filter; 2]>),
    /// There is no next frame to learn from.
    Kept(Option<Box<Filter>>),
}

/// A measurement beside what is expected.
#[derive(Clone, Copy, Debug)]
pub struct Gated {
    expected: Filter,
    measurement: Measurement,
    /// 0 or 1.
    sensor: usize,
    squared_distance: f64,
    limit: f64,
}

impl Gated {
    fn is_inside(&self) -> bool {
        self.squared_distance <= self.limit
    }
}

impl KalmanFilter {
    fn is_dropped(&self, index: usize) -> bool {
        index.checked_sub(self.drop_from).is_some_and(|index| index < self.drop_frames)
    }

    /// What the first sensor says of a detection.
    fn first(&self, detection: &Detection) -> Measurement {
        let place = detection.center.map(f64::from);
        Measurement { place, place_deviation: f64::from(self.measurement_noise), velocity: None }
    }

    /// What the second sensor says, of a true place: it has a noise of its own.
    fn second(&self, clip: &Clip, state: &State, t: usize) -> Result<Option<Measurement>, Error> {
        let (Some(id), false) = (state.truth_id, self.sensors == Sensors::One) else { return Ok(None) };
        let places = [t.checked_sub(1), Some(t), t.checked_add(1)].map(|t| match t {
            Some(t) => truth_of(clip, t, id),
            None => Ok(None),
        });
        let [before, now, after] = places;
        let (before, Some(now), after) = (before?, now?, after?) else { return Ok(None) };
        let [x, y, u, v] = state.detector.chances(id, t);
        let deviation = f64::from(self.second_noise);
        let place = [now[0] + deviation * x, now[1] + deviation * y];
        let velocity = match (self.sensors, before, after) {
            (Sensors::WithVelocity, Some(before), _) => Some([0, 1].map(|i| now[i] - before[i])),
            (Sensors::WithVelocity, None, Some(after)) => Some([0, 1].map(|i| after[i] - now[i])),
            _ => None,
        };
        let deviation_v = f64::from(self.velocity_noise);
        let velocity = velocity.map(|[tu, tv]| ([tu + deviation_v * u, tv + deviation_v * v], deviation_v));
        Ok(Some(Measurement { place, place_deviation: deviation, velocity }))
    }

    /// The detection that is nearest to what is expected.
    fn nearest(&self, expected: &Filter, detections: &[Detection]) -> Option<Measurement> {
        let all = detections.iter().map(|detection| self.first(detection));
        let far = |measurement: &Measurement| expected.squared_distance(measurement).unwrap_or(f64::INFINITY);
        all.min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// The detection that the object begins with.
    fn begin_with<'a>(&self, detections: &'a [Detection]) -> Option<&'a Detection> {
        let mut ranked: Vec<&Detection> = detections.iter().collect();
        // Of a stable order: those of one score keep theirs.
        let rank = |found: &Detection| (found.score, found.bounds.area());
        ranked.sort_by(|a, b| rank(b).partial_cmp(&rank(a)).unwrap_or(std::cmp::Ordering::Equal));
        ranked.get(self.object - 1).or(ranked.last()).copied()
    }

    /// Compares a measurement with what is expected, and takes it if it lies in the gate.
    fn take(
        &self,
        (expected, sensor, measurement): (Filter, usize, Measurement),
        moment: &mut Moment,
        observer: &mut impl Observer<Event>,
    ) -> Option<Filter> {
        let (updated, squared_distance) = expected.updated(&measurement)?;
        let limit = chi_square::quantile(f64::from(self.gate), measurement.numbers());
        let gated = Gated { expected, measurement, sensor, squared_distance, limit };
        observer.see(|| Event::Gated(Box::new(gated)));
        if !gated.is_inside() {
            return None;
        }
        moment.nis.push((squared_distance, measurement.numbers()));
        observer.see(|| Event::Updated(Box::new((gated, updated))));
        Some(updated)
    }

    fn filter_frame(
        &self,
        clip: &Clip,
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<Moment, Error> {
        let (index, t) = (state.moments.len(), state.span.first + state.moments.len());
        let mut moment = Moment::default();
        if let Some(before) = state.filter {
            let predicted = before.predicted();
            observer.see(|| Event::Predicted(Box::new([before, predicted])));
            moment.predicted = Some(predicted);
        }
        moment.truth = state.truth_id.map(|id| truth_of(clip, t, id)).transpose()?.flatten();
        let measurements = if self.is_dropped(index) {
            observer.see(|| Event::Hidden(moment.truth));
            Vec::new()
        } else {
            moment.detections = Arc::new(state.detector.look(clip, t)?);
            let first = match moment.predicted {
                Some(expected) => self.nearest(&expected, &moment.detections),
                None => self.begin_with(&moment.detections).map(|detection| self.first(detection)),
            };
            let second = first.and(self.second(clip, state, t)?);
            let all: Vec<Measurement> = first.into_iter().chain(second).collect();
            observer.see(|| Event::Looked(Arc::clone(&moment.detections), all.clone(), moment.truth));
            all
        };
        moment.measured = measurements.iter().map(|measurement| measurement.place).collect();
        match moment.predicted {
            None => self.begin((clip, t), state, (&mut moment, measurements.first()), observer)?,
            Some(predicted) => {
                let mut filter = predicted;
                for (sensor, measurement) in measurements.into_iter().enumerate() {
                    filter = self.take((filter, sensor, measurement), &mut moment, observer).unwrap_or(filter);
                }
                self.go_on(state, (filter, !moment.nis.is_empty()), observer);
            }
        }
        moment.filtered = state.filter;
        let life = if state.missed == 0 { Life::Confirmed } else { Life::Coasting };
        moment.object = state.filter.map(|filter| filter.object(state.begun, state.size, life));
        Ok(moment)
    }

    /// Begins an object with its first measurement, if there is one.
    fn begin(
        &self,
        (clip, t): (&Clip, usize),
        state: &mut State,
        (moment, first): (&mut Moment, Option<&Measurement>),
        observer: &mut impl Observer<Event>,
    ) -> Result<(), Error> {
        let Some(first) = first else {
            observer.see(|| Event::Missed(None));
            return Ok(());
        };
        let filter =
            Filter::begun(self.motion.model(self.process_noise, self.turn_noise), first, f64::from(self.first_speed));
        observer.see(|| Event::Begun(Box::new(filter)));
        (state.filter, state.missed, moment.begins) = (Some(filter), 0, true);
        state.begun += 1;
        state.truth_id = nearest_object(clip, t, first.place)?;
        moment.truth = state.truth_id.map(|id| truth_of(clip, t, id)).transpose()?.flatten();
        if let Some(found) = moment.detections.iter().find(|found| found.center.map(f64::from) == first.place) {
            state.size = found.bounds.size();
        }
        Ok(())
    }

    /// Keeps what is believed, or gives the object up if it was not seen for too long.
    fn go_on(&self, state: &mut State, (filter, is_seen): (Filter, bool), observer: &mut impl Observer<Event>) {
        state.filter = Some(filter);
        state.missed = if is_seen { 0 } else { state.missed + 1 };
        if state.missed > self.patience {
            observer.see(|| Event::Lost(Box::new(filter)));
            state.filter = None;
        } else if !is_seen {
            observer.see(|| Event::Missed(Some(Box::new(filter))));
        }
    }

    /// Smooths the frame whose turn it is, going back.
    fn smooth_frame(&self, state: &mut State, done: usize, observer: &mut impl Observer<Event>) {
        let index = state.moments.len() - 1 - done;
        let next = state.moments.get(index + 1).filter(|next| !next.begins).and_then(|next| next.smoothed);
        let moment = Arc::make_mut(&mut state.moments[index]);
        let filtered = moment.filtered;
        moment.smoothed = match (filtered, next) {
            (Some(filtered), Some(next)) => filtered.smoothed(&next).or(Some(filtered)),
            (filtered, _) => filtered,
        };
        let smoothed = moment.smoothed;
        observer.see(|| match (filtered, next, smoothed) {
            (Some(filtered), Some(_), Some(smoothed)) => Event::Smoothed(Box::new([filtered, smoothed])),
            (filtered, ..) => Event::Kept(filtered.map(Box::new)),
        });
        moment.object = moment
            .object
            .zip(smoothed)
            .map(|(object, smoothed)| smoothed.object(object.id, object.bounds.size(), object.life));
    }
}

/// The true object nearest to a place, if there is truth.
fn nearest_object(clip: &Clip, t: usize, place: [f64; 2]) -> Result<Option<u32>, Error> {
    let Some(truth) = clip.truth() else { return Ok(None) };
    let objects = truth.objects(t)?.unwrap_or_default();
    let far = |at: [f64; 2]| (at[0] - place[0]).hypot(at[1] - place[1]);
    let nearest = objects.iter().min_by(|a, b| far(center(a)).total_cmp(&far(center(b))));
    Ok(nearest.map(|object| object.id))
}

impl Estimator for KalmanFilter {
    const INFO: Info = Info {
        id: "kalman-filter",
        name: "Kalman filter",
        family: "Tracking",
        summary: "Predicts where one object will be, compares that with what is measured, and moves to what is likeliest.",
        source: "R. E. Kalman, A new approach to linear filtering and prediction problems, Journal of Basic Engineering 82, 1960; \
                 models, gate and consistency: Y. Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with applications to \
                 tracking and navigation, 2001; smoothing: H. E. Rauch, F. Tung and C. T. Striebel, AIAA Journal 3, 1965",
        pseudocode: &[
            "for each frame t",
            "  predict: x ← f(x), P ← F P F^T + Q",
            "  z ← what is measured in frame t, if anything is",
            "  gate: ν ← z − H x, S ← H P H^T + R; taken if ν^T S⁻¹ ν ≤ limit",
            "  update: K ← P H^T S⁻¹, x ← x + K ν",
            "    P ← (I − K H) P (I − K H)^T + K R K^T",
            "  without a measurement x and P stay as predicted",
            "for each frame t, backwards",
            "  smooth: C ← P F^T P⁻¹(t+1|t), x ← x + C (x(t+1) − x(t+1|t))",
            "    P ← P + C (P(t+1) − P(t+1|t)) C^T",
        ],
        rungs: &["clip", "frame", "step"],
        frames: 2,
    };
    const PROMISE: Promise = Promise::Objects;
    const NEEDS_PICTURES: bool = false;
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let span = Span::new(clip, frame, self.frames)?;
        if self.sensors != Sensors::One && clip.truth().is_none_or(|truth| !truth.kinds().contains(&"objects")) {
            return Err(Error::new(format!(
                "a second sensor measures the truth with noise, and {} has no true objects; set sensors to one",
                clip.info().name
            )));
        }
        let noise = Noise { deviation_px: f64::from(self.added_noise), seed: u64::from(self.seed) };
        let detector = Detector::new(self.source, clip, &span, Given { noise, clicks: self.clicks.clone() })?;
        Ok(State {
            span,
            detector,
            truth_id: None,
            filter: None,
            missed: 0,
            begun: 0,
            size: [8.0; 2],
            moments: Vec::new(),
            back: None,
            picture: clip.size(),
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        if let Some(done) = state.back {
            self.smooth_frame(state, done, observer);
            state.back = Some(done + 1);
            return Ok(if done + 1 < state.moments.len() { Progress::More } else { Progress::Done });
        }
        let moment = self.filter_frame(clip, state, observer)?;
        state.moments.push(Arc::new(moment));
        if !state.span.is_over(clip, state.span.first + state.moments.len()) {
            return Ok(Progress::More);
        }
        state.back = self.smooth.then_some(0);
        Ok(if self.smooth { Progress::More } else { Progress::Done })
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.span.frames().map(|frames| if self.smooth { 2 * frames } else { frames })
    }

    fn place(&self, state: &State) -> Vec<Rung> {
        let done = state.moments.len() + state.back.unwrap_or(0);
        vec![Rung { index: 0, of: Some(1) }, Rung { index: done, of: self.units(state) }]
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        let count = state.moments.len();
        let index = state.back.map_or(count, |done| count.saturating_sub(done + 1));
        Some(state.span.first + index)
    }

    fn state_bytes(&self, state: &State) -> usize {
        // What earlier frames came to is shared with the states before.
        size_of::<State>() + size_of_val(&state.moments[..]) + state.moments.last().map_or(0, |moment| moment.bytes())
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let earlier: usize = state.moments.iter().map(|moment| moment.bytes()).sum();
        self.state_bytes(state) + state.detector.bytes() + earlier
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Gated(gated) if !gated.is_inside() => Some(Role::Rejected),
            Event::Lost(_) => Some(Role::Error),
            Event::Missed(Some(_)) => Some(Role::Predicted),
            _ => None,
        }
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let frame = |moment: &Arc<Moment>| {
            let objects = moment.object.into_iter().collect();
            Arc::new(ObjectFrame { mask: None, detections: Vec::clone(&moment.detections), objects })
        };
        let frames = state.moments.iter().map(frame).collect();
        Output::Objects(ObjectField {
            picture: state.picture,
            first: state.span.first,
            frames,
            trajectories: Vec::new(),
        })
    }
}
