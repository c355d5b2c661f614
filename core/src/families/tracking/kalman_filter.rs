//! The Kalman filter on one object: prediction, gating and update in each frame, then smoothing backward (RTS).

mod consistent;
mod explain;
mod matrices;
mod modes;
mod restart;
mod sensors;

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{is_far_outside, object_of};
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::methods::{
    kalman::{Filter, Measurement, MotionModel, Noises, Nonlinear, chi_square, vocabulary::value as known},
    multi_object::{
        Extent,
        source::{Detector, Noise, Source, SourceSettings, center, default_detector, truth_of},
    },
};
use crate::params::Spots;
use crate::products::{Followed, Object, ObjectField, ObjectFrame, Output, Product, ProductKind, TrackStatus, Watched};
use crate::run::{Estimator, Footprint, Foreground, Granularity, Guarantee, Info, Need, Progress, Seen, Span, Stage};
use crate::scene::{Chart, Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};

use restart::Retry;
pub use sensors::Sensors;
use sensors::{Observations, SensorReading};

choices! {
    /// The probability inside a covariance ellipse.
    pub enum Confidence {
        /// One standard deviation along each axis: 39 % of a 2-D normal distribution.
        One = "1-sigma" "1 σ",
        /// Two standard deviations along each axis: 86 %.
        Two = "2-sigma" "2 σ",
        /// 95 %: 2.45 standard deviations along each axis.
        NinetyFive = "95-percent" "95 %",
    }
}

impl Confidence {
    /// Returns the share of a 2-D normal distribution inside.
    fn share(self) -> f64 {
        match self {
            Self::One => chi_square::share(1.0, 2),
            Self::Two => chi_square::share(4.0, 2),
            Self::NinetyFive => 0.95,
        }
    }
}

params! {
    /// Kalman filter on one object.
    pub struct KalmanFilter {
        /// Maximum number of frames, the first included.
        frames: usize = 300, 2..=10_000;
        /// Motion model of the filter.
        motion: MotionModel = MotionModel::Velocity;
        /// Standard deviation of the acceleration; with the constant acceleration model, of its change per frame. Raise it if NIS lies
        /// above its band.
        process_noise: f32 = 3.0, 0.0..=50.0, "px/frame²";
        /// Standard deviation of the change of the turn rate. Used where the motion is a coordinated turn or has one as a mode.
        turn_noise: f32 = 0.5, 0.0..=45.0, "°/frame²";
        /// Probability that the object changes its mode from one frame to the next. Small values trust the present mode and react late to a
        /// turn. Used with motion = imm only.
        mode_switch: f32 = 0.05, 0.001..=0.5;
        /// Standard deviation of a measured position along each axis: the root of the diagonal of R. Lower values trust measurements more.
        measurement_noise: f32 = 2.0, 0.01..=100.0, "px";
        /// Source of the detections.
        source: Source = Source::Auto;
        /// Detector of moving objects. Used with source = moving, or where there are neither clicks, detections nor truth.
        detector: Stage<Foreground> = default_detector();
        /// Clicked positions. Clicks in several frames are the measurements, and the gate rejects none of them. A click in one frame, or with
        /// another source, selects the object and the first frame of its track, which starts at the click where nothing is detected.
        clicks: Spots = Spots::default();
        /// Number of the tracked object in the first frame with detections. Detections are ranked by score; true objects, blobs and
        /// clicks in their order. Of blobs, 1 is the one that moves most consistently over the next frames.
        object: usize = 1, 1..=1000;
        /// Standard deviation of the noise added to true positions (source = truth).
        added_noise: f32 = 2.0, 0.0..=100.0, "px";
        /// Random seed. The same seed gives the same noise.
        seed: u32 = 1, 0..=9999;
        /// Sensors that measure the object, fused by one update each. Where the first is occluded, the second continues.
        sensors: Sensors = Sensors::One;
        /// Standard deviation of the second sensor's position. Used with two sensors only.
        second_noise: f32 = 4.0, 0.01..=100.0, "px";
        /// Standard deviation of the second sensor's velocity. Used with sensors = position-and-velocity only.
        velocity_noise: f32 = 1.0, 0.01..=100.0, "px/frame";
        /// Gate probability: share of the true measurements inside the gate. It sets the gating threshold of d² by the χ² distribution.
        gate: f32 = 0.99, 0.5..=0.9999;
        /// First frame of a simulated occlusion of the first sensor, counted from 0 in the run.
        occlusion_start: usize = 0, 0..=10_000;
        /// Number of frames of the simulated occlusion; 0 for none.
        occlusion_frames: usize = 0, 0..=1000;
        /// Missed frames in a row before the track is deleted; the next measurement starts a new track. A track far outside the picture is deleted at once.
        max_age: usize = 30, 1..=1000;
        /// Filter the detections of a diverged track again with the other motion models, and restart it with the one that accepts them. A track
        /// has diverged when the gate has rejected most of its latest measurements, at least 3.
        restart: bool = true;
        /// Initial standard deviation of each velocity component; the initial velocity is 0.
        initial_speed: f32 = 30.0, 0.1..=500.0, "px/frame";
        /// Probability inside the drawn covariance ellipses.
        confidence: Confidence = Confidence::NinetyFive;
        /// Smooth backward at the end (RTS smoother), so that each estimate uses later measurements too. With hindsight (non-causal). Not with
        /// motion = imm.
        smooth: bool = true;
    }
    advanced { "seed", "gate", "occlusion-start", "occlusion-frames", "max-age", "restart", "initial-speed" }
    when {
        "turn-noise": |p| p.motion.turns(),
            "Turn noise has no effect unless the motion is a coordinated turn.";
        "mode-switch": |p| p.motion == MotionModel::Interacting,
            "The probability of a switch has no effect unless the motion has modes.";
        "smooth": |p| p.motion != MotionModel::Interacting,
            "Smoothing has no effect on interacting modes: the smoother has one motion model.";
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
        "restart": |p| p.source != Source::Clicks, "Restarting has no effect on clicks: the gate rejects none.";
        "restart": |p| p.sensors == Sensors::One, "Restarting has no effect with two sensors.";
        "occlusion-start": |p| p.occlusion_frames > 0,
            "The start of the occlusion has no effect without occluded frames.";
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    span: Span,
    detector: Detector,
    /// The true identity of the tracked object, where there is truth.
    truth_id: Option<u32>,
    /// The true identities of all objects tracked so far.
    truth_ids: BTreeSet<u32>,
    /// The motion model of the track: the chosen one, or that of the last restart.
    motion: MotionModel,
    /// The last attempt to restart a diverged track.
    retry: Option<Arc<Retry>>,
    /// The number of latest results that the last frame has made: after a restart those of the whole track.
    fresh: usize,
    /// The current state estimate, if there is a track.
    filter: Option<Filter>,
    /// Frames in a row without a measurement.
    missed: usize,
    /// The number of tracks so far, and the identity of the last one.
    begun: u32,
    /// The box of the track.
    extent: Option<Extent>,
    /// The results of the frames so far.
    records: Vec<Arc<FrameRecord>>,
    /// The number of smoothed frames, from the last backward; `None` while frames are filtered.
    back: Option<usize>,
    picture: (usize, usize),
}

/// The result of a frame.
#[derive(Clone, Debug, Default)]
struct FrameRecord {
    detections: Arc<Vec<Detection>>,
    /// The gated measurements, accepted or rejected, in their order.
    gated: Vec<Gated>,
    /// The filtered estimate.
    filtered: Option<Filter>,
    /// The smoothed estimate.
    smoothed: Option<Filter>,
    /// Whether a track starts in this frame.
    begins: bool,
    truth: Option<[f64; 2]>,
    object: Option<Object>,
}

impl FrameRecord {
    /// Memory of its own in bytes.
    fn own_bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.gated[..])
    }

    fn bytes(&self) -> usize {
        self.own_bytes() + size_of_val(&self.detections[..])
    }

    fn of_sensor(&self, sensor: usize) -> Option<&Gated> {
        self.gated.iter().find(|gated| gated.reading.sensor == sensor)
    }
}

/// An event of a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// The interacting modes before they are mixed.
    Mixed(Box<Filter>),
    /// The estimate from which sigma points are drawn.
    Drawn(Box<Filter>),
    /// The estimate before and after the prediction.
    Predicted(Box<[Filter; 2]>),
    /// The detections and the measurements of the object.
    Observed(Arc<Observations>),
    /// A measurement is tested against the gate.
    Gated(Box<Gated>),
    /// An accepted measurement and the updated estimate.
    Updated(Box<(Gated, Filter)>),
    /// The same with interacting modes: their probabilities.
    Weighed(Box<(Gated, Filter)>),
    /// A track starts with a measurement, one of this many detections.
    Begun(Box<Filter>, usize),
    /// The detections of a diverged track are filtered again.
    Retried(Arc<Retry>),
    /// No accepted measurement: the prediction, if there is a track.
    Missed(Option<Box<Filter>>),
    /// A deleted track.
    Lost(Box<Filter>, Loss),
    /// The filtered and the smoothed estimate of a frame.
    Smoothed(Box<[Filter; 2]>),
    /// A frame without a successor to smooth with.
    Kept(Option<Box<Filter>>),
}

/// The reason for the deletion of a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// Missed for more than the max age.
    Missed,
    /// Predicted far outside the picture.
    Outside,
}

/// A measurement and its gate.
#[derive(Clone, Copy, Debug)]
pub struct Gated {
    /// The estimate before the measurement.
    expected: Filter,
    /// Whether that estimate is updated with another measurement of the frame.
    is_updated: bool,
    reading: SensorReading,
    /// Squared Mahalanobis distance d² of the innovation: the NIS.
    squared_distance: f64,
    /// The gating threshold of d².
    limit: f64,
}

impl Gated {
    /// Whether the measurement is accepted: within the gate, or clicked.
    fn is_inside(&self) -> bool {
        self.reading.is_clicked || !self.is_beyond()
    }

    /// Whether the measurement is outside the gate.
    fn is_beyond(&self) -> bool {
        self.squared_distance > self.limit
    }

    fn measurement(&self) -> &Measurement {
        &self.reading.measurement
    }
}

impl KalmanFilter {
    /// Whether frames are smoothed backward.
    fn smooths(&self) -> bool {
        self.smooth && self.motion != MotionModel::Interacting
    }

    /// Gates a measurement and updates the filter if it is accepted.
    fn take(
        &self,
        (expected, is_updated): (Filter, bool),
        reading: SensorReading,
        record: &mut FrameRecord,
        observer: &mut impl Observer<Event>,
    ) -> Option<Filter> {
        let (updated, squared_distance) = expected.updated(&reading.measurement)?;
        let limit = chi_square::quantile(f64::from(self.gate), reading.measurement.numbers());
        let gated = Gated { expected, is_updated, reading, squared_distance, limit };
        record.gated.push(gated);
        observer.see(|| Event::Gated(Box::new(gated)));
        if !gated.is_inside() {
            return None;
        }
        observer.see(|| Event::Updated(Box::new((gated, updated))));
        if updated.modes().is_some() {
            observer.see(|| Event::Weighed(Box::new((gated, updated))));
        }
        Some(updated)
    }

    fn filter_frame(
        &self,
        clip: &Clip,
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<FrameRecord, Error> {
        let t = state.span.first + state.records.len();
        let predicted = state.filter.map(|before| {
            match before {
                Filter::Interacting(..) => observer.see(|| Event::Mixed(Box::new(before))),
                Filter::Turn(turn, _) if turn.prediction == Nonlinear::Unscented => {
                    observer.see(|| Event::Drawn(Box::new(before)));
                }
                _ => {}
            }
            let predicted = before.predicted();
            observer.see(|| Event::Predicted(Box::new([before, predicted])));
            predicted
        });
        let observed = Arc::new(self.observe((clip, t), state, predicted.as_ref())?);
        observer.see(|| Event::Observed(Arc::clone(&observed)));
        let mut record = FrameRecord {
            detections: Arc::clone(&observed.detections),
            truth: observed.truth,
            ..FrameRecord::default()
        };
        let mut taken = None;
        match predicted {
            None => taken = self.begin((clip, t), state, (&mut record, &observed), observer)?,
            Some(predicted) => {
                let (mut filter, mut is_seen) = (predicted, false);
                for reading in &observed.measured {
                    if let Some(updated) = self.take((filter, is_seen), *reading, &mut record, observer) {
                        (filter, is_seen, taken) = (updated, true, taken.or(reading.detection));
                    }
                }
                if !is_seen && let Some((retry, restarted)) = self.retried(clip, state, &record)? {
                    let retry = Arc::new(retry);
                    observer.see(|| Event::Retried(Arc::clone(&retry)));
                    if let Some((followed, record)) = restarted {
                        *state = State { retry: Some(retry), ..followed };
                        return Ok(record);
                    }
                    state.retry = Some(retry);
                }
                self.go_on(state, (filter, is_seen), observer);
            }
        }
        if let Some(found) = taken.map(|i| &observed.detections[i]) {
            state.extent = Some(state.extent.map_or(Extent::of(found), |extent| extent.towards(found)));
        }
        record.filtered = state.filter;
        let status = if state.missed == 0 { TrackStatus::Confirmed } else { TrackStatus::Coasting };
        record.object = state.filter.zip(state.extent).map(|(filter, extent)| Object {
            detection: taken,
            ..object_of(&filter, state.begun, extent.around(filter.place()), status)
        });
        Ok(record)
    }

    /// Starts a track with the first measurement, if there is one; returns its detection.
    fn begin(
        &self,
        (clip, t): (&Clip, usize),
        state: &mut State,
        (record, observed): (&mut FrameRecord, &Observations),
        observer: &mut impl Observer<Event>,
    ) -> Result<Option<usize>, Error> {
        let Some(first) = observed.measured.first() else {
            observer.see(|| Event::Missed(None));
            return Ok(None);
        };
        let model = state.motion.model(Noises {
            acceleration: self.process_noise,
            turn_deg: self.turn_noise,
            switch: self.mode_switch,
        });
        let filter = Filter::begun(model, &first.measurement, f64::from(self.initial_speed));
        observer.see(|| Event::Begun(Box::new(filter), observed.detections.len()));
        (state.filter, state.missed, state.extent, record.begins) = (Some(filter), 0, None, true);
        state.begun += 1;
        state.truth_id = nearest_object(clip, t, first.measurement.place)?;
        state.truth_ids.extend(state.truth_id);
        record.truth = state.truth_id.map(|id| truth_of(clip, t, id)).transpose()?.flatten();
        Ok(first.detection)
    }

    /// Keeps the estimate, or deletes the track if it is too old or far outside the picture.
    fn go_on(&self, state: &mut State, (filter, is_seen): (Filter, bool), observer: &mut impl Observer<Event>) {
        state.filter = Some(filter);
        state.missed = if is_seen { 0 } else { state.missed + 1 };
        let loss = match is_seen {
            true => None,
            false if state.missed > self.max_age => Some(Loss::Missed),
            false => is_far_outside(filter.place(), state.picture).then_some(Loss::Outside),
        };
        if let Some(loss) = loss {
            observer.see(|| Event::Lost(Box::new(filter), loss));
            (state.filter, state.truth_id) = (None, None);
        } else if !is_seen {
            observer.see(|| Event::Missed(Some(Box::new(filter))));
        }
    }

    /// Smooths the next frame backward.
    fn smooth_frame(&self, state: &mut State, done: usize, observer: &mut impl Observer<Event>) {
        let index = state.records.len() - 1 - done;
        let next = state.records.get(index + 1).filter(|next| !next.begins).and_then(|next| next.smoothed);
        let record = Arc::make_mut(&mut state.records[index]);
        let filtered = record.filtered;
        record.smoothed = match (filtered, next) {
            (Some(filtered), Some(next)) => filtered.smoothed(&next).or(Some(filtered)),
            (filtered, _) => filtered,
        };
        let smoothed = record.smoothed;
        observer.see(|| match (filtered, next, smoothed) {
            (Some(filtered), Some(_), Some(smoothed)) => Event::Smoothed(Box::new([filtered, smoothed])),
            (filtered, ..) => Event::Kept(filtered.map(Box::new)),
        });
        record.object = record.object.zip(smoothed).map(|(object, smoothed)| {
            let moved = [0, 1].map(|i| (smoothed.place()[i] - object.position[i]) as f32);
            let bounds = object.bounds.moved(moved);
            Object { detection: object.detection, ..object_of(&smoothed, object.id, bounds, object.status) }
        });
    }
}

/// Returns the true object nearest to a position, if there is truth.
fn nearest_object(clip: &Clip, t: usize, place: [f64; 2]) -> Result<Option<u32>, Error> {
    let Some(truth) = clip.truth() else { return Ok(None) };
    let objects = truth.objects(t)?.unwrap_or_default();
    let far = |at: [f64; 2]| (at[0] - place[0]).hypot(at[1] - place[1]);
    let nearest = objects.iter().min_by(|a, b| far(center(a)).total_cmp(&far(center(b))));
    Ok(nearest.map(|object| object.id))
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    MIX: "  motion = imm: mix the modes, μ(i|j) ← p(ij) μ(i) / Σ p(ij) μ(i), x(j), P(j) ← moments of all modes with these weights",
    DRAW: "  motion = unscented-turn: sigma points χ ← x, x ± c columns of L with P = L L^T; x, P ← moments of f(χ), plus Q",
    PREDICT: "  predict by the motion model: x ← f(x), P ← F P F^T + Q",
    MEASURE: "  z ← measurement of frame t, if there is one",
    BEGIN_OBJECT: "  no track: start one, x ← z with velocity 0, P ← diag(σ²) of measurement and initial-speed",
    GATE: "  gate: innovation ν ← z − H x, S ← H P H^T + R; accept if d² = ν^T S⁻¹ ν ≤ γ",
    UPDATE: "  update: K ← P H^T S⁻¹, x ← x + K ν, P ← (I − K H) P (I − K H)^T + K R K^T (Joseph form)",
    WEIGH_MODES: "  motion = imm: μ(j) ← μ(j) N(ν(j); 0, S(j)), to a sum of 1; x, P ← moments of the modes with weights μ",
    RESTART: "  diverged (most of the latest z rejected): filter the track again with each other motion model; restart with the one that accepts them",
    COAST_OR_END: "  no measurement accepted: coast with the predicted x, P; delete if missed > max-age frames",
    EACH_FRAME_BACK: "for each frame t, backward",
    SMOOTH: "  smooth: C ← P F^T P⁻¹(t+1|t), x ← x + C (x(t+1) − x(t+1|t)), P ← P + C (P(t+1) − P(t+1|t)) C^T",
}

impl Estimator for KalmanFilter {
    const INFO: Info = Info {
        id: "kalman-filter",
        name: "Kalman filter",
        family: "Tracking",
        summary: "Estimates position and velocity of one object: predicts with a motion model and updates with measurements inside the gate.",
        source: "R. E. Kalman, A new approach to linear filtering and prediction problems, Journal of Basic Engineering 82, 1960; \
                 models, gate and consistency: Y. Bar-Shalom, X. R. Li and T. Kirubarajan, Estimation with applications to \
                 tracking and navigation, 2001; smoothing: H. E. Rauch, F. Tung and C. T. Striebel, AIAA Journal 3, 1965; sigma points: S. J. Julier and \
                 J. K. Uhlmann, Proceedings of the IEEE 92, 2004; interacting modes: H. A. P. Blom and Y. Bar-Shalom, IEEE Transactions on \
                 Automatic Control 33, 1988",
        pseudocode: line::ALL,
        granularities: &["clip", "pass", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::place("predicted", "Where does the filter predict the object?", line::PREDICT, Role::Predicted),
        Question::choice(
            "gate",
            "Is the measurement inside the gate?",
            &[
                Reply::told(line::GATE, explain::case::REJECTED, "No: rejected"),
                Reply::told(line::GATE, explain::case::ACCEPTED, "Yes: accepted"),
            ],
        )
        .unless_told(&[explain::case::CLICKED])
        .with_given(&[known::INNOVATION, known::INNOVATION_COVARIANCE, known::GATE]),
        Question::place("updated", "Where is the estimate after the update?", line::UPDATE, Role::Estimate),
    ];
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const NEEDS_PICTURES: bool = false;
    const CONTRASTS: Option<&'static str> = Some("motion");
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ObjectField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let span = Span::new(clip, frame, self.frames)?;
        if self.sensors != Sensors::One && clip.truth().is_none_or(|truth| !truth.kinds().contains(&"objects")) {
            return Err(Error::new(format!(
                "the second sensor measures true positions with noise, and {} has no true objects; set sensors to one",
                clip.info().name
            )));
        }
        let noise = Noise { deviation_px: f64::from(self.added_noise), seed: u64::from(self.seed) };
        let detector = Detector::new(
            self.source,
            clip,
            &span,
            SourceSettings { noise, clicks: self.clicks.clone(), click_chooses: true, stage: self.detector.clone() },
        )?;
        Ok(State {
            span,
            detector,
            truth_id: None,
            truth_ids: BTreeSet::new(),
            motion: self.motion,
            retry: None,
            fresh: 0,
            filter: None,
            missed: 0,
            begun: 0,
            extent: None,
            records: Vec::new(),
            back: None,
            picture: clip.size(),
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        if let Some(done) = state.back {
            self.smooth_frame(state, done, observer);
            state.back = Some(done + 1);
            return Ok(if done + 1 < state.records.len() { Progress::More } else { Progress::Done });
        }
        state.fresh = 1;
        let record = self.filter_frame(clip, state, observer)?;
        state.records.push(Arc::new(record));
        if !state.span.is_over(clip, state.span.first + state.records.len()) {
            return Ok(Progress::More);
        }
        state.back = self.smooths().then_some(0);
        Ok(if self.smooths() { Progress::More } else { Progress::Done })
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.span.frames().map(|frames| if self.smooths() { 2 * frames } else { frames })
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let passes = Some(if self.smooths() { 2 } else { 1 });
        let (pass, done) = state.back.map_or((0, state.records.len()), |done| (1, done));
        let clip = Granularity { index: 0, of: Some(1) };
        vec![clip, Granularity { index: pass, of: passes }, Granularity { index: done, of: state.span.frames() }]
    }

    fn units_of(&self, _picture: (usize, usize), frames: usize) -> Option<usize> {
        Some(frames)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        let count = state.records.len();
        let index = state.back.map_or(count, |done| count.saturating_sub(done + 1));
        Some(state.span.first + index)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Gated(gated) if !gated.is_inside() => Some(Role::Rejected),
            Event::Lost(..) => Some(Role::Error),
            Event::Retried(_) => Some(Role::Result),
            Event::Missed(Some(_)) => Some(Role::Predicted),
            _ => None,
        }
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let frame = |record: &Arc<FrameRecord>| {
            let objects = record.object.into_iter().collect();
            Arc::new(ObjectFrame { mask: None, detections: Vec::clone(&record.detections), objects })
        };
        let frames = state.records.iter().map(frame).collect();
        Output::of(ObjectField {
            // A click has no size to compare with a true box.
            followed: Followed::One(match state.detector.is_clicked() {
                true => BTreeSet::new(),
                false => state.truth_ids.clone(),
            }),
            picture: state.picture,
            first: state.span.first,
            frames,
            trajectories: Vec::new(),
            watched: Watched::default(),
        })
    }
}

impl Footprint<State> for KalmanFilter {
    fn need(&self, clip: &Clip) -> Need {
        super::need(clip)
    }

    fn state_bytes(&self, state: &State) -> usize {
        // Earlier frames are shared with earlier states; smoothed and restarted ones are copied.
        let copies = state.back.unwrap_or(0).max(state.fresh);
        let copies = state.records.iter().rev().take(copies).map(|record| record.own_bytes());
        let last = state.records.last().map_or(0, |record| record.bytes());
        size_of::<State>() + size_of_val(&state.records[..]) + last + copies.sum::<usize>()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let earlier: usize = state.records.iter().map(|record| record.bytes()).sum();
        self.state_bytes(state) + state.detector.bytes() + earlier
    }
}
