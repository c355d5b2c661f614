//! The Kalman filter on one object: predict, gate and update in each frame, and at the end a walk back.

mod explain;
mod matrices;
mod sensors;

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{is_far_outside, object_of};
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::methods::{
    kalman::{Filter, Measurement, MotionModel, chi_square},
    multi_object::{
        Extent,
        source::{Detector, Given, Noise, Source, center, truth_of, usual_detector},
    },
};
use crate::params::Spots;
use crate::products::{Followed, Object, ObjectField, ObjectFrame, Output, Product, ProductKind, TrackStatus};
use crate::run::{Estimator, Footprint, Foreground, Granularity, Guarantee, Info, Need, Progress, Seen, Span, Stage};
use crate::scene::{Chart, Role, Scene, Step};
use crate::{choices, params, pseudocode};

use sensors::{Look, Sensed, Sensors};

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
        /// Source of the detections.
        source: Source = Source::Auto;
        /// Detector of moving objects, for a source that is what moves.
        detector: Stage<Foreground> = usual_detector();
        /// Places in frames, clicked on the picture: what is measured, or where another source is chosen, which object is followed and from when on.
        clicks: Spots = Spots::default();
        /// Which object is followed, of those in the first frame that shows any: true ones by their number, detections by their score, all others as they were found or clicked.
        object: usize = 1, 1..=1000;
        /// Standard deviation of the noise that a true place is measured with.
        added_noise: f32 = 2.0, 0.0..=100.0, "px";
        /// Random seed. The same seed gives the same noise.
        seed: u32 = 1, 0..=9999;
        /// What measures the object, each sensor by itself: where the first sees nothing, the second goes on.
        sensors: Sensors = Sensors::One;
        /// Standard deviation of what the second sensor says of the place, if there is one.
        second_noise: f32 = 4.0, 0.01..=100.0, "px";
        /// Standard deviation of what it says of the velocity.
        velocity_noise: f32 = 1.0, 0.01..=100.0, "px/frame";
        /// A measurement is taken if it lies where this share of all measurements of the object would lie.
        gate: f32 = 0.99, 0.5..=0.9999;
        /// The first frame of the run, counted from 0, in which the first sensor sees nothing, if there are such.
        drop_from: usize = 0, 0..=10_000;
        /// In so many frames the first sensor sees nothing, as if something hid the object.
        drop_frames: usize = 0, 0..=1000;
        /// After more than so many frames in a row without a measurement the track is deleted and the filter begins anew; sooner where its estimate lies outside the picture by more than the picture's size.
        patience: usize = 30, 1..=1000;
        /// How fast the object may be at first.
        first_speed: f32 = 30.0, 0.1..=500.0, "px/frame";
        /// How much of what may be an ellipse holds.
        confidence: Confidence = Confidence::NinetyFive;
        /// Walk back at the end, so that each frame knows what came later.
        smooth: bool = true;
    }
    advanced { "seed", "gate", "drop-from", "drop-frames", "patience", "first-speed" }
    when {
        "turn-noise": |p| p.motion == MotionModel::Turn,
            "Turn noise has no effect unless the motion is a coordinated turn.";
        "detector": |p| matches!(p.source, Source::Auto | Source::Moving),
            "The detector has no effect with this source of detections.";
        "added-noise": |p| matches!(p.source, Source::Auto | Source::Truth),
            "Added noise has no effect unless the source is the truth with noise.";
        "seed": |p| p.sensors != Sensors::One || matches!(p.source, Source::Auto | Source::Truth),
            "The seed has no effect unless the truth is measured with noise.";
        "seed": |p| p.sensors != Sensors::One || p.added_noise > 0.0, "The seed has no effect without added noise.";
        "second-noise": |p| p.sensors != Sensors::One,
            "The noise of the second sensor has no effect with one sensor.";
        "velocity-noise": |p| p.sensors == Sensors::WithVelocity,
            "Velocity noise has no effect where no sensor measures the velocity.";
        "drop-from": |p| p.drop_frames > 0, "The first dropped frame has no effect where no frames are dropped.";
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    span: Span,
    detector: Detector,
    /// Who is followed, once that is known: its true identity, where there is truth.
    truth_id: Option<u32>,
    /// All who were followed so far.
    truth_ids: BTreeSet<u32>,
    /// The state estimate now, unless nothing was seen yet or the track was deleted.
    filter: Option<Filter>,
    /// Frames in a row without a measurement.
    missed: usize,
    /// How many objects there were before this one: its identity less 1.
    begun: u32,
    /// Its box, once it has begun.
    extent: Option<Extent>,
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
    /// What was measured beside what was expected, whether it was taken or not, in its order.
    gated: Vec<Gated>,
    /// The state estimate then.
    filtered: Option<Filter>,
    /// The smoothed state estimate, with all that came later.
    smoothed: Option<Filter>,
    /// Whether the object is another one than in the frame before.
    begins: bool,
    truth: Option<[f64; 2]>,
    object: Option<Object>,
}

impl Moment {
    /// Memory of its own, in bytes.
    fn own_bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.gated[..])
    }

    fn bytes(&self) -> usize {
        self.own_bytes() + size_of_val(&self.detections[..])
    }

    /// What a sensor measured.
    fn of_sensor(&self, sensor: usize) -> Option<&Gated> {
        self.gated.iter().find(|gated| gated.sensed.sensor == sensor)
    }
}

/// What happens in a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// A time step.
    Predicted(Box<[Filter; 2]>),
    /// What was detected, and what is measured of the object.
    Looked(Arc<Look>),
    /// A measurement is compared with what is expected.
    Gated(Box<Gated>),
    /// A measurement was taken, and the state estimate after it.
    Updated(Box<(Gated, Filter)>),
    /// The first measurement of an object, one of so many.
    Begun(Box<Filter>, usize),
    /// Nothing was taken: the prediction stands, or there is none.
    Missed(Option<Box<Filter>>),
    /// The object was given up.
    Lost(Box<Filter>, Loss),
    /// A frame, with what is known of the next one: the state estimate before, and now.
    Smoothed(Box<[Filter; 2]>),
    /// There is no next frame to learn from.
    Kept(Option<Box<Filter>>),
}

/// Why an object was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// It was not seen for too long.
    Unseen,
    /// Its estimate is far outside the picture.
    Outside,
}

/// A measurement beside what is expected.
#[derive(Clone, Copy, Debug)]
pub struct Gated {
    expected: Filter,
    /// Whether another measurement of the frame is part of what is expected.
    is_updated: bool,
    sensed: Sensed,
    /// Normalised innovation squared, NIS.
    squared_distance: f64,
    /// It is taken up to here.
    limit: f64,
}

impl Gated {
    fn is_inside(&self) -> bool {
        self.squared_distance <= self.limit
    }

    fn measurement(&self) -> &Measurement {
        &self.sensed.measurement
    }
}

impl KalmanFilter {
    /// Compares a measurement with what is expected, and takes it if it lies in the gate.
    fn take(
        &self,
        (expected, is_updated): (Filter, bool),
        sensed: Sensed,
        moment: &mut Moment,
        observer: &mut impl Observer<Event>,
    ) -> Option<Filter> {
        let (updated, squared_distance) = expected.updated(&sensed.measurement)?;
        let limit = chi_square::quantile(f64::from(self.gate), sensed.measurement.numbers());
        let gated = Gated { expected, is_updated, sensed, squared_distance, limit };
        moment.gated.push(gated);
        observer.see(|| Event::Gated(Box::new(gated)));
        if !gated.is_inside() {
            return None;
        }
        observer.see(|| Event::Updated(Box::new((gated, updated))));
        Some(updated)
    }

    fn filter_frame(
        &self,
        clip: &Clip,
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<Moment, Error> {
        let t = state.span.first + state.moments.len();
        let predicted = state.filter.map(|before| {
            let predicted = before.predicted();
            observer.see(|| Event::Predicted(Box::new([before, predicted])));
            predicted
        });
        let look = Arc::new(self.look((clip, t), state, predicted.as_ref())?);
        observer.see(|| Event::Looked(Arc::clone(&look)));
        let mut moment = Moment { detections: Arc::clone(&look.detections), truth: look.truth, ..Moment::default() };
        let mut taken = None;
        match predicted {
            None => taken = self.begin((clip, t), state, (&mut moment, &look), observer)?,
            Some(predicted) => {
                let (mut filter, mut is_seen) = (predicted, false);
                for sensed in &look.measured {
                    if let Some(updated) = self.take((filter, is_seen), *sensed, &mut moment, observer) {
                        (filter, is_seen, taken) = (updated, true, taken.or(sensed.detection));
                    }
                }
                self.go_on(state, (filter, is_seen), observer);
            }
        }
        if let Some(found) = taken.map(|i| &look.detections[i]) {
            state.extent = Some(state.extent.map_or(Extent::of(found), |extent| extent.towards(found)));
        }
        moment.filtered = state.filter;
        let life = if state.missed == 0 { TrackStatus::Confirmed } else { TrackStatus::Coasting };
        moment.object = state.filter.zip(state.extent).map(|(filter, extent)| Object {
            detection: taken,
            ..object_of(&filter, state.begun, extent.around(filter.place()), life)
        });
        Ok(moment)
    }

    /// Begins an object with its first measurement, if there is one; gives the detection that it is.
    fn begin(
        &self,
        (clip, t): (&Clip, usize),
        state: &mut State,
        (moment, look): (&mut Moment, &Look),
        observer: &mut impl Observer<Event>,
    ) -> Result<Option<usize>, Error> {
        let Some(first) = look.measured.first() else {
            observer.see(|| Event::Missed(None));
            return Ok(None);
        };
        let model = self.motion.model(self.process_noise, self.turn_noise);
        let filter = Filter::begun(model, &first.measurement, f64::from(self.first_speed));
        observer.see(|| Event::Begun(Box::new(filter), look.detections.len()));
        (state.filter, state.missed, state.extent, moment.begins) = (Some(filter), 0, None, true);
        state.begun += 1;
        state.truth_id = nearest_object(clip, t, first.measurement.place)?;
        state.truth_ids.extend(state.truth_id);
        moment.truth = state.truth_id.map(|id| truth_of(clip, t, id)).transpose()?.flatten();
        Ok(first.detection)
    }

    /// Keeps the state estimate, or deletes the track if it was not seen for too long or is far away.
    fn go_on(&self, state: &mut State, (filter, is_seen): (Filter, bool), observer: &mut impl Observer<Event>) {
        state.filter = Some(filter);
        state.missed = if is_seen { 0 } else { state.missed + 1 };
        let loss = match is_seen {
            true => None,
            false if state.missed > self.patience => Some(Loss::Unseen),
            false => is_far_outside(filter.place(), state.picture).then_some(Loss::Outside),
        };
        if let Some(loss) = loss {
            observer.see(|| Event::Lost(Box::new(filter), loss));
            (state.filter, state.truth_id) = (None, None);
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
        moment.object = moment.object.zip(smoothed).map(|(object, smoothed)| {
            let moved = [0, 1].map(|i| (smoothed.place()[i] - object.position[i]) as f32);
            let bounds = object.bounds.moved(moved);
            Object { detection: object.detection, ..object_of(&smoothed, object.id, bounds, object.life) }
        });
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

pseudocode! {
    EACH_FRAME: "for each frame t",
    PREDICT: "  predict: x ← f(x), P ← F P F^T + Q",
    MEASURE: "  z ← what is measured in frame t, if anything is",
    BEGIN_OBJECT: "  without an object: begin one, x ← z with velocity 0, P ← what is uncertain of both",
    GATE: "  gate: ν ← z − H x, S ← H P H^T + R; taken if ν^T S⁻¹ ν ≤ limit",
    UPDATE: "  update: K ← P H^T S⁻¹, x ← x + K ν, P ← (I − K H) P (I − K H)^T + K R K^T",
    COAST_OR_END: "  without a measurement x and P stay as predicted; the object ends if it was not seen for too long",
    EACH_FRAME_BACK: "for each frame t, backwards",
    SMOOTH: "  smooth: C ← P F^T P⁻¹(t+1|t), x ← x + C (x(t+1) − x(t+1|t)), P ← P + C (P(t+1) − P(t+1|t)) C^T",
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
        pseudocode: line::ALL,
        granularities: &["clip", "pass", "frame", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const NEEDS_PICTURES: bool = false;
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ObjectField::KIND];
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
        let detector = Detector::new(
            self.source,
            clip,
            &span,
            Given { noise, clicks: self.clicks.clone(), stage: self.detector.clone() },
        )?;
        Ok(State {
            span,
            detector,
            truth_id: None,
            truth_ids: BTreeSet::new(),
            filter: None,
            missed: 0,
            begun: 0,
            extent: None,
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

    fn place(&self, state: &State) -> Vec<Granularity> {
        let passes = Some(if self.smooth { 2 } else { 1 });
        let (pass, done) = state.back.map_or((0, state.moments.len()), |done| (1, done));
        let clip = Granularity { index: 0, of: Some(1) };
        vec![clip, Granularity { index: pass, of: passes }, Granularity { index: done, of: state.span.frames() }]
    }

    fn units_of(&self, _picture: (usize, usize), frames: usize) -> Option<usize> {
        Some(frames)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        let count = state.moments.len();
        let index = state.back.map_or(count, |done| count.saturating_sub(done + 1));
        Some(state.span.first + index)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Gated(gated) if !gated.is_inside() => Some(Role::Rejected),
            Event::Lost(..) => Some(Role::Error),
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
        Output::of(ObjectField {
            // A click has no size that could be compared with a true box.
            followed: Followed::One(match state.detector.takes_clicks() {
                true => BTreeSet::new(),
                false => state.truth_ids.clone(),
            }),
            picture: state.picture,
            first: state.span.first,
            frames,
            trajectories: Vec::new(),
        })
    }
}

impl Footprint<State> for KalmanFilter {
    fn need(&self, clip: &Clip) -> Need {
        super::need(clip)
    }

    fn state_bytes(&self, state: &State) -> usize {
        // What earlier frames came to is shared with the states before, up to where it was smoothed: then it is a copy.
        let smoothed = state.moments.iter().rev().take(state.back.unwrap_or(0)).map(|moment| moment.own_bytes());
        let last = state.moments.last().map_or(0, |moment| moment.bytes());
        size_of::<State>() + size_of_val(&state.moments[..]) + last + smoothed.sum::<usize>()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let earlier: usize = state.moments.iter().map(|moment| moment.bytes()).sum();
        self.state_bytes(state) + state.detector.bytes() + earlier
    }
}
