//! What trackers of many objects have beside their tracks: parameters, a detector, and the frames that are done.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::lifecycle::{Age, Rules};
use super::source::{Detector, Given, Noise, Source, usual_detector};
use crate::base::Error;
use crate::data::{Clip, Detection};
use crate::geometry::Bounds;
use crate::params;
use crate::params::Spots;
use crate::products::{Followed, Object, ObjectField, ObjectFrame, TrackStatus};
use crate::run::{Foreground, Granularity, Progress, Span, Stage, need};

params! {
    /// The parameters that all trackers have and a run is begun with.
    pub struct Settings {
        /// At most so many frames, the first one counted; fewer where the clip ends.
        frames: usize = 300, 2..=10_000;
        /// Source of the detections.
        source: Source = Source::Auto;
        /// Detector of moving objects, for a source that is what moves.
        detector: Stage<Foreground> = usual_detector();
        /// Places in frames, clicked on the picture, that stand for what a detector finds.
        clicks: Spots = Spots::default();
        /// Detections beside the clip with a lower score are left out.
        min_score: f32 = 0.3, -1000.0..=1000.0;
        /// Standard deviation of the noise that a true place is measured with.
        added_noise: f32 = 2.0, 0.0..=100.0, "px";
        /// Which noise that is.
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
    /// Whether the source of the detections may tell how sure they are.
    pub fn may_have_scores(&self) -> bool {
        matches!(self.source, Source::Auto | Source::Detections)
    }
}

/// The frames of a run, those that are done and what is detected in those that follow.
#[derive(Clone)]
pub(crate) struct Course {
    /// All of them.
    pub span: Span,
    detector: Detector,
    min_score: f32,
    /// How many objects there have been.
    begun: u32,
    frames: Vec<Arc<ObjectFrame>>,
    /// The first of the frames that are done which the last unit has changed.
    changed_from: usize,
    picture: (usize, usize),
}

impl Course {
    /// No frame is done yet.
    ///
    /// # Errors
    /// If the clip has no pair there, or none of what is to be detected.
    pub fn new(settings: Settings, clip: &Clip, frame: usize) -> Result<Self, Error> {
        let Settings { frames, source, detector, clicks, min_score, added_noise, seed } = settings;
        let span = Span::new(clip, frame, frames)?;
        let noise = Noise { deviation_px: f64::from(added_noise), seed: u64::from(seed) };
        let detector = Detector::new(source, clip, &span, Given { noise, clicks, stage: detector })?;
        let picture = clip.size();
        Ok(Self { span, detector, min_score, begun: 0, frames: Vec::new(), changed_from: 0, picture })
    }

    /// The frame that comes next.
    pub fn frame(&self) -> usize {
        self.span.first + self.frames.len()
    }

    /// The frames that are done.
    pub fn frames(&self) -> &[Arc<ObjectFrame>] {
        &self.frames
    }

    /// What is detected in the frame that comes next, and how much of it is left out because of its score.
    ///
    /// # Errors
    /// If the frame or the truth cannot be read, or there is no room for more.
    pub fn look(&mut self, clip: &Clip) -> Result<(Vec<Detection>, usize), Error> {
        self.changed_from = self.frames.len();
        need::check_kept(clip, self.own_bytes() + self.shared_bytes())?;
        let mut detections = self.detector.look(clip, self.frame())?;
        let found = detections.len();
        if self.detector.tells_scores() {
            detections.retain(|detection| detection.score >= self.min_score);
        }
        let left_out = found - detections.len();
        Ok((detections, left_out))
    }

    /// Whether the scores of what is detected tell how sure that is.
    pub fn tells_scores(&self) -> bool {
        self.detector.tells_scores()
    }

    /// Width and height of the picture in px.
    pub fn picture(&self) -> (usize, usize) {
        self.picture
    }

    /// The identity of a new object.
    pub fn next_id(&mut self) -> u32 {
        self.begun += 1;
        self.begun
    }

    /// A frame is done.
    pub fn note(&mut self, clip: &Clip, frame: Arc<ObjectFrame>) -> Progress {
        self.frames.push(frame);
        if self.span.is_over(clip, self.frame()) { Progress::Done } else { Progress::More }
    }

    /// Tells earlier frames of an object that is seen what became of it: that it is confirmed, and where it was while it was
    /// not seen; `was` is its age before.
    pub fn look_back(&mut self, rules: Rules, object: &Object, was: Age) {
        if rules.backdate && was.life == TrackStatus::Tentative && object.life == TrackStatus::Confirmed {
            for (t, frame) in self.frames.iter_mut().enumerate().rev() {
                let Some(i) = frame.place(object.id) else { break };
                Arc::make_mut(frame).objects[i].life = TrackStatus::Confirmed;
                self.changed_from = self.changed_from.min(t);
            }
        }
        if rules.bridge && was.missed > 0 {
            self.bridge(object, was.missed);
        }
    }

    /// Puts an object that was not seen for some frames on the straight line to where it is now.
    fn bridge(&mut self, object: &Object, missed: usize) {
        let (now, count) = (object.bounds, self.frames.len());
        let Some(before) = count.checked_sub(missed + 1).map(|i| Arc::clone(&self.frames[i])) else { return };
        let Some(from) = before.object(object.id) else { return };
        self.changed_from = self.changed_from.min(count - missed);
        for (step, frame) in self.frames[count - missed..].iter_mut().enumerate() {
            let share = (step + 1) as f32 / (missed + 1) as f32;
            let between = |a: [f32; 2], b: [f32; 2]| [0, 1].map(|i| a[i] + (b[i] - a[i]) * share);
            let bounds = Bounds { min: between(from.bounds.min, now.min), max: between(from.bounds.max, now.max) };
            if let Some(i) = frame.place(object.id) {
                let other = &mut Arc::make_mut(frame).objects[i];
                // Where it was is known by now, but how it moved and how sure that is was only predicted.
                *other = Object {
                    bounds,
                    life: TrackStatus::Confirmed,
                    position: bounds.center().map(f64::from),
                    velocity: None,
                    covariance: None,
                    ..*other
                };
            }
        }
    }

    /// Where the run stands.
    pub fn place(&self) -> Vec<Granularity> {
        self.span.place(self.frames.len())
    }

    /// Memory that it takes by itself, in bytes: what earlier frames came to is shared with the states before, as far as the last
    /// unit has not changed it.
    pub fn own_bytes(&self) -> usize {
        let changed: usize = self.frames[self.changed_from..].iter().map(|frame| frame.bytes()).sum();
        size_of::<Self>() + size_of_val(&self.frames[..]) + changed
    }

    /// Memory of the detector and of all frames, in bytes.
    pub fn shared_bytes(&self) -> usize {
        let frames: usize = self.frames.iter().map(|frame| frame.bytes()).sum();
        self.detector.bytes() + frames
    }

    /// What all frames came to.
    pub fn field(&self) -> ObjectField {
        ObjectField {
            // A click has no size that could be compared with a true box.
            followed: if self.detector.takes_clicks() { Followed::One(BTreeSet::new()) } else { Followed::All },
            picture: self.picture,
            first: self.span.first,
            frames: self.frames.clone(),
            trajectories: Vec::new(),
        }
    }
}
