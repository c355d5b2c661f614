//! A run of a multi-object tracker: its parameters, detections, finished frames and conclusions.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::Extent;
use super::dynamics::Dynamics;
use super::lifecycle::{Rules, TrackAge};
use super::source::{Detector, Noise, Source, SourceSettings, default_detector};
use crate::base::Error;
use crate::data::{Clip, Detection, ObjectBox};
use crate::geometry::Bounds;
use crate::methods::kalman::{ConsistencyTest, Filter};
use crate::params;
use crate::params::Spots;
use crate::products::{
    Followed, Object, ObjectField, ObjectFrame, TrackStatus, Watched,
    objects::score::{Matches, Scores, errors_on, scored_boxes, scores_on},
};
use crate::run::{Foreground, Granularity, Progress, Span, Stage, need};

params! {
    /// The parameters of all trackers that a run starts with.
    pub struct Settings {
        /// Maximum number of frames, the first included.
        frames: usize = 300, 2..=10_000;
        /// Source of the detections.
        source: Source = Source::Auto;
        /// Detector of moving objects. Used with source = moving, or where there are neither clicks, detections nor truth.
        detector: Stage<Foreground> = default_detector();
        /// Positions clicked on the frames, used as detections.
        clicks: Spots = Spots::default();
        /// Minimum score of a detection of the clip's file. Those with a lower score are discarded.
        min_score: f32 = 0.3, -1000.0..=1000.0;
        /// Standard deviation of the noise added to true positions (source = truth).
        added_noise: f32 = 2.0, 0.0..=100.0, "px";
        /// Random seed. The same seed gives the same noise.
        seed: u32 = 1, 0..=9999;
    }
    advanced { "seed" }
    when {
        "detector": |p| matches!(p.source, Source::Auto | Source::Moving),
            "The detector has no effect with this source of detections.";
        "clicks": |p| matches!(p.source, Source::Auto | Source::Clicks),
            "Clicks have no effect with this source of detections.";
        "added-noise": |p| matches!(p.source, Source::Auto | Source::Truth),
            "Added noise has no effect unless the source is the truth with noise.";
        "seed": |p| matches!(p.source, Source::Auto | Source::Truth),
            "The seed has no effect unless the source is the truth with noise.";
        "seed": |p| p.added_noise > 0.0, "The seed has no effect without added noise.";
    }
}

impl Settings {
    /// Whether the source of the detections may have scores.
    pub fn may_have_scores(&self) -> bool {
        matches!(self.source, Source::Auto | Source::Detections)
    }
}

/// The confirmed tracks of a frame and of the run beside the ground truth.
#[derive(Clone, Debug, Default)]
pub struct Conclusion {
    /// The matches of the frame.
    pub frame: Option<Matches>,
    /// The number of tracks that were confirmed in the run, at its end.
    pub tracks: Option<usize>,
    /// The scores of the run, at its end: with hindsight, where the rules use it.
    pub run: Option<Scores>,
    /// The scores of the same run in real time, where hindsight has changed its tracks.
    pub live: Option<Scores>,
    /// Whether the boxes of coasted frames are interpolated once a track is matched again, and then count.
    pub is_interpolated: bool,
    /// The frames of the run with the most misses and false alarms, at its end.
    pub worst: Vec<(usize, Matches)>,
    /// The misses of the run that the source did not detect, at its end; `None` where the source is not the truth.
    pub hidden: Option<usize>,
    /// The test of the mean NIS of the detections of confirmed tracks, at its end.
    pub consistency: Option<ConsistencyTest>,
    /// The tracks of the run that lasted, but were never confirmed because of their small net displacement, at its end.
    pub stationary: usize,
}

impl Conclusion {
    /// The test of the mean NIS, where it is clearly above its expectation: the band alone is narrow in long runs.
    pub fn overconfidence(&self) -> Option<&ConsistencyTest> {
        self.consistency.as_ref().filter(|test| test.is_above() && test.mean > CLEARLY_ABOVE * test.dof as f64)
    }
}

/// The share of its expectation above which a mean NIS is clearly too large. The gate cuts off the largest values: measurement noise of
/// twice the assumed standard deviation leaves one and a half times the expectation or more.
const CLEARLY_ABOVE: f64 = 1.4;

/// The finished frames of a run, and the detector of those to come.
#[derive(Clone)]
pub(crate) struct TrackerRun {
    /// All frames of the run.
    pub span: Span,
    detector: Detector,
    min_score: f32,
    /// The number of tracks so far.
    begun: u32,
    frames: Vec<Arc<ObjectFrame>>,
    /// The same frames as they were in real time, without hindsight; shared with `frames` as long as they are equal.
    live: Vec<Arc<ObjectFrame>>,
    /// The number of finished frames that are settled: a tracker that decides later writes those after them anew.
    settled: usize,
    /// Settled frames that hindsight from frames after them has changed, as they were before.
    before: Vec<(usize, Arc<ObjectFrame>)>,
    /// The first finished frame that the last unit has changed.
    changed_from: usize,
    picture: (usize, usize),
}

impl TrackerRun {
    /// Starts a run.
    ///
    /// # Errors
    /// If the clip has no pair there, or lacks the source of detections.
    pub fn new(settings: Settings, clip: &Clip, frame: usize) -> Result<Self, Error> {
        let Settings { frames, source, detector, clicks, min_score, added_noise, seed } = settings;
        let span = Span::new(clip, frame, frames)?;
        let noise = Noise { deviation_px: f64::from(added_noise), seed: u64::from(seed) };
        let detector = Detector::new(
            source,
            clip,
            &span,
            SourceSettings { noise, clicks, click_chooses: false, stage: detector },
        )?;
        let picture = clip.size();
        Ok(Self {
            span,
            detector,
            min_score,
            begun: 0,
            frames: Vec::new(),
            live: Vec::new(),
            settled: 0,
            before: Vec::new(),
            changed_from: 0,
            picture,
        })
    }

    /// Returns the next frame.
    pub fn frame(&self) -> usize {
        self.span.first + self.frames.len()
    }

    /// Returns the finished frames.
    pub fn frames(&self) -> &[Arc<ObjectFrame>] {
        &self.frames
    }

    /// Returns the detections of the next frame, and the number discarded by the minimum score.
    ///
    /// # Errors
    /// If the frame or the truth cannot be read, or there is no room for more.
    pub fn look(&mut self, clip: &Clip) -> Result<(Vec<Detection>, usize), Error> {
        self.changed_from = self.frames.len();
        need::check_kept(clip, self.own_bytes() + self.shared_bytes())?;
        let mut detections = self.detector.look(clip, self.frame())?;
        let count = detections.len();
        if self.detector.has_scores() {
            detections.retain(|detection| detection.score >= self.min_score);
        }
        let discarded = count - detections.len();
        Ok((detections, discarded))
    }

    /// Returns whether detections have scores of a detector.
    pub fn has_scores(&self) -> bool {
        self.detector.has_scores()
    }

    /// Width and height of the picture in px.
    pub fn picture(&self) -> (usize, usize) {
        self.picture
    }

    /// Returns the identity of a new track.
    pub fn next_id(&mut self) -> u32 {
        self.begun += 1;
        self.begun
    }

    /// Returns the frame of these detections and objects, with the early confirmations of a run without hindsight.
    pub fn finished(&self, rules: Rules, detections: Vec<Detection>, objects: Vec<Object>) -> Arc<ObjectFrame> {
        let mut frame = ObjectFrame { mask: None, detections, objects };
        if !rules.backdate {
            rules.confirm_early(self.frames.len(), &mut frame);
        }
        Arc::new(frame)
    }

    /// Goes back to the settled frames, as they were settled, for trackers that decide later; returns the frames after them.
    pub fn rewind(&mut self) -> Vec<Arc<ObjectFrame>> {
        for (t, frame) in self.before.drain(..) {
            self.changed_from = self.changed_from.min(t);
            self.frames[t] = frame;
        }
        self.changed_from = self.changed_from.min(self.settled);
        self.frames.split_off(self.settled)
    }

    /// Settles the finished frames.
    pub fn settle(&mut self) {
        self.settled = self.frames.len();
        self.before.clear();
    }

    /// Returns a finished frame to be changed.
    fn changed(&mut self, t: usize) -> &mut ObjectFrame {
        self.changed_from = self.changed_from.min(t);
        if t < self.settled && self.before.iter().all(|(other, _)| *other != t) {
            self.before.push((t, Arc::clone(&self.frames[t])));
        }
        Arc::make_mut(&mut self.frames[t])
    }

    /// Adds a finished frame that was there before, as it is known now.
    pub fn again(&mut self, frame: Arc<ObjectFrame>) {
        self.frames.push(frame);
    }

    /// Adds a finished frame.
    pub fn note(&mut self, clip: &Clip, rules: Rules, frame: Arc<ObjectFrame>) -> Progress {
        self.live.push(self.in_real_time(rules, &frame));
        self.frames.push(frame);
        if self.span.is_over(clip, self.frame()) { Progress::Done } else { Progress::More }
    }

    /// Returns a frame that is not noted yet as it is in real time.
    fn in_real_time(&self, rules: Rules, frame: &Arc<ObjectFrame>) -> Arc<ObjectFrame> {
        let mut live = Arc::clone(frame);
        if rules.backdate && self.frames.len() < rules.min_hits {
            rules.confirm_early(self.frames.len(), Arc::make_mut(&mut live));
        }
        live
    }

    /// Applies hindsight to the earlier frames of a matched track: confirms its tentative frames and interpolates its coasted
    /// ones; `was` is its age before the match.
    pub fn look_back(&mut self, rules: Rules, object: &Object, was: TrackAge) {
        if rules.backdate && was.status == TrackStatus::Tentative && object.status == TrackStatus::Confirmed {
            for t in (0..self.frames.len()).rev() {
                let Some(i) = self.frames[t].place(object.id) else { break };
                self.changed(t).objects[i].status = TrackStatus::Confirmed;
            }
        }
        if rules.interpolate && was.missed > 0 {
            self.interpolate(object, was.missed);
        }
    }

    /// Interpolates the boxes of the missed frames linearly.
    fn interpolate(&mut self, object: &Object, missed: usize) {
        let (now, count) = (object.bounds, self.frames.len());
        let Some(before) = count.checked_sub(missed + 1).map(|i| Arc::clone(&self.frames[i])) else { return };
        let Some(from) = before.object(object.id) else { return };
        for (step, t) in (count - missed..count).enumerate() {
            let share = (step + 1) as f32 / (missed + 1) as f32;
            let between = |a: [f32; 2], b: [f32; 2]| [0, 1].map(|i| a[i] + (b[i] - a[i]) * share);
            let bounds = Bounds { min: between(from.bounds.min, now.min), max: between(from.bounds.max, now.max) };
            if let Some(i) = self.frames[t].place(object.id) {
                let other = &mut self.changed(t).objects[i];
                // Only the box is interpolated: velocity and covariance were predictions.
                *other = Object {
                    bounds,
                    status: TrackStatus::Confirmed,
                    position: bounds.center().map(f64::from),
                    velocity: None,
                    covariance: None,
                    ..*other
                };
            }
        }
    }

    /// Scores a frame, and at the end of the run all of them.
    pub fn conclusion(
        &self,
        clip: &Clip,
        frame: &Arc<ObjectFrame>,
        (rules, dynamics): (Rules, Option<&Dynamics>),
    ) -> Conclusion {
        if self.detector.is_clicked() {
            return Conclusion::default();
        }
        let is_last = self.span.is_over(clip, self.frame() + 1);
        if !is_last {
            return Conclusion { frame: matches(clip, self.frame(), frame), ..Conclusion::default() };
        }
        let mut field = self.field();
        field.frames.push(Arc::clone(frame));
        let mut live = self.live_field();
        live.frames.push(self.in_real_time(rules, frame));
        let all = field.frames.iter().enumerate().filter_map(|(i, frame)| {
            let t = self.span.first + i;
            Some((t, matches(clip, t, frame)?))
        });
        let errors = |all: &Matches| all.misses() + all.false_positives();
        let all: Vec<(usize, Matches)> = all.collect();
        let most = all.iter().map(|(_, all)| errors(all)).max().unwrap_or(0);
        let objects = field.frames.iter().flat_map(|frame| &frame.objects);
        let confirmed = objects.filter(|object| object.status == TrackStatus::Confirmed).map(|object| object.id);
        Conclusion {
            frame: matches(clip, self.frame(), frame),
            tracks: Some(confirmed.collect::<BTreeSet<u32>>().len()),
            run: scores_on(clip, &field).ok().flatten(),
            live: Some(live).filter(|live| *live != field).and_then(|live| scores_on(clip, &live).ok().flatten()),
            is_interpolated: rules.interpolate,
            worst: all.into_iter().filter(|(_, all)| most > 0 && errors(all) == most).collect(),
            hidden: self.hidden(clip, &field),
            consistency: dynamics.and_then(|dynamics| consistency(&field, dynamics)),
            stationary: stationary(&field, rules),
        }
    }

    /// The misses of all frames that the source did not detect. Hindsight matches some of the boxes that it did not detect.
    fn hidden(&self, clip: &Clip, field: &ObjectField) -> Option<usize> {
        let truth = clip.truth().filter(|_| self.detector.is_truth())?;
        let errors = errors_on(clip, field).ok().flatten()?;
        let undetected = errors.iter().map(|errors| {
            let objects = truth.objects(errors.frame).ok().flatten().unwrap_or_default();
            let is_missed = |object: &ObjectBox| errors.misses.iter().any(|(id, _)| *id == object.id);
            objects.iter().filter(|object| is_missed(object) && self.detector.detects(object) == Some(false)).count()
        });
        Some(undetected.sum())
    }

    /// Returns the position of the run.
    pub fn place(&self) -> Vec<Granularity> {
        self.span.place(self.frames.len())
    }

    /// Memory of its own in bytes. Earlier frames are shared with the states before, unless the last unit has changed them.
    pub fn own_bytes(&self) -> usize {
        let changed: usize = self.frames[self.changed_from..].iter().map(|frame| frame.bytes()).sum();
        let before: usize = self.before.iter().map(|(_, frame)| frame.bytes()).sum();
        size_of::<Self>() + 2 * size_of_val(&self.frames[..]) + changed + before
    }

    /// Memory of the detector and of all frames, in bytes.
    pub fn shared_bytes(&self) -> usize {
        let frames: usize = self.frames.iter().map(|frame| frame.bytes()).sum();
        let changed = self.live.iter().zip(&self.frames).filter(|(live, frame)| !Arc::ptr_eq(live, frame));
        self.detector.bytes() + frames + changed.map(|(live, _)| live.bytes()).sum::<usize>()
    }

    /// Returns the tracks of all frames.
    pub fn field(&self) -> ObjectField {
        ObjectField {
            // A click has no size to compare with a true box.
            followed: if self.detector.is_clicked() { Followed::One(BTreeSet::new()) } else { Followed::All },
            picture: self.picture,
            first: self.span.first,
            frames: self.frames.clone(),
            trajectories: Vec::new(),
            watched: Watched::default(),
        }
    }

    /// Returns the tracks of all frames as they were in real time.
    pub fn live_field(&self) -> ObjectField {
        ObjectField { frames: self.live.clone(), ..self.field() }
    }
}

/// Matched frames from which a tentative track counts as lasting.
const LASTING_FRAMES: usize = 10;

/// Returns the number of tracks that only the minimum travel has kept tentative, although they lasted.
fn stationary(field: &ObjectField, rules: Rules) -> usize {
    let mut tentative = BTreeMap::<u32, usize>::new();
    let mut confirmed = BTreeSet::new();
    for object in field.frames.iter().flat_map(|frame| &frame.objects) {
        match object.status {
            TrackStatus::Tentative => *tentative.entry(object.id).or_default() += 1,
            _ => drop(confirmed.insert(object.id)),
        }
    }
    let least = LASTING_FRAMES.max(rules.min_hits);
    tentative.into_iter().filter(|(id, frames)| *frames >= least && !confirmed.contains(id)).count()
}

/// Returns the test of the mean NIS: the detections of each confirmed track, filtered with the dynamics of the run. Boxes at the border of
/// the picture show a part of an object, so their centres say nothing about the noise.
fn consistency(field: &ObjectField, dynamics: &Dynamics) -> Option<ConsistencyTest> {
    let objects = || {
        field
            .frames
            .iter()
            .enumerate()
            .flat_map(|(t, frame)| frame.objects.iter().map(move |object| (t, frame, object)))
    };
    let confirmed: BTreeSet<u32> = objects()
        .filter(|(.., object)| object.status == TrackStatus::Confirmed)
        .map(|(.., object)| object.id)
        .collect();
    let is_whole = |bounds: &Bounds| {
        let (width, height) = field.picture;
        (0..2).all(|i| bounds.min[i] > 0.0 && bounds.max[i] < [width, height][i] as f32 - 1.0)
    };
    let (mut tracks, mut nis) = (BTreeMap::<u32, (usize, Filter, Extent)>::new(), Vec::new());
    for (t, frame, object) in objects().filter(|(.., object)| confirmed.contains(&object.id)) {
        let Some(found) = object.detection.and_then(|i| frame.detections.get(i)) else { continue };
        if !is_whole(&found.bounds) {
            tracks.remove(&object.id);
            continue;
        }
        let track = tracks.entry(object.id).or_insert_with(|| (t, dynamics.begun(found), Extent::of(found)));
        let (last, filter, extent) = *track;
        if t == last {
            continue;
        }
        let predicted = (last..t).fold(filter, |filter, _| dynamics.predicted(&filter, &extent));
        let Some((updated, squared)) = predicted.updated(&dynamics.measurement(found)) else { continue };
        nis.push(squared);
        *track = (t, updated, extent.towards(found));
    }
    ConsistencyTest::of(&nis, 2)
}

/// Matches the confirmed tracks of a frame with the true boxes, if these are known.
fn matches(clip: &Clip, t: usize, frame: &ObjectFrame) -> Option<Matches> {
    let confirmed = frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed);
    let confirmed = confirmed.map(|object| (object.id, object.bounds)).collect();
    scored_boxes(&**clip.truth()?, t, confirmed).ok().flatten().as_ref().map(Matches::of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settled_frames_are_as_they_were_settled_after_a_rewind() {
        let found = Detection {
            bounds: Bounds::around([9.0; 2], [8.0; 2]),
            center: [9.0; 2],
            score: 1.0,
            blob: None,
            deviation_px: None,
        };
        let clip = Clip::blank("rows", (64, 48), 9).with_detections(vec![vec![found]; 9]);
        let (rules, settings) = (Rules { min_hits: 4, ..Rules::default() }, Settings::default());
        let mut run = TrackerRun::new(settings, &clip, 0).expect("it has detections");
        let object = |status| Object {
            id: 1,
            bounds: found.bounds,
            status,
            position: [9.0; 2],
            velocity: None,
            covariance: None,
            detection: Some(0),
        };
        let note = |run: &mut TrackerRun, object| {
            let frame = run.finished(rules, vec![found], vec![object]);
            run.note(&clip, rules, frame);
        };
        let statuses = |run: &TrackerRun| run.frames().iter().map(|frame| frame.objects[0].status).collect::<Vec<_>>();
        let (tentative, confirmed) = (object(TrackStatus::Tentative), object(TrackStatus::Confirmed));
        (0..3).for_each(|_| note(&mut run, tentative));
        run.settle();
        let settled = run.frames().to_vec();
        note(&mut run, tentative);
        let age = TrackAge { status: TrackStatus::Tentative, ..rules.begun(&found) };
        run.look_back(rules, &confirmed, age);
        note(&mut run, confirmed);
        assert_eq!(statuses(&run), [TrackStatus::Confirmed; 5]);
        assert_eq!(run.rewind().len(), 2);
        assert_eq!(statuses(&run), [TrackStatus::Tentative; 3]);
        assert!(run.frames().iter().zip(&settled).all(|(now, then)| Arc::ptr_eq(now, then)), "none was copied");
    }

    #[test]
    fn only_tracks_that_last_without_being_confirmed_are_stationary() {
        let object = |id, status| Object {
            id,
            bounds: Bounds::around([9.0; 2], [8.0; 2]),
            status,
            position: [9.0; 2],
            velocity: None,
            covariance: None,
            detection: Some(0),
        };
        // The first lasts in place, the second is seen briefly, the third travels in the end.
        let objects = |t: usize| {
            let third = if t < 14 { TrackStatus::Tentative } else { TrackStatus::Confirmed };
            let of_frame = [(1, TrackStatus::Tentative), (2, TrackStatus::Tentative), (3, third)];
            of_frame.into_iter().filter(|(id, _)| *id != 2 || t < 4).map(|(id, status)| object(id, status)).collect()
        };
        let frame = |t| Arc::new(ObjectFrame { objects: objects(t), ..ObjectFrame::default() });
        let field = ObjectField {
            followed: Followed::All,
            picture: (64, 48),
            first: 0,
            frames: (0..15).map(frame).collect(),
            trajectories: Vec::new(),
            watched: Watched::default(),
        };
        assert_eq!(stationary(&field, Rules::default()), 1);
        assert_eq!(stationary(&field, Rules { min_hits: 20, ..Rules::default() }), 0, "more matches would confirm it");
    }
}
