//! Sources of detections.

use std::collections::BTreeSet;

use crate::base::Error;
use crate::choices;
use crate::data::{Clip, Detection, ObjectBox};
use crate::geometry::Bounds;
use crate::params::Parameter as _;
use crate::params::Spots;
use crate::run::{Foreground, Frames, Span, Stage};
use crate::synth::random::{gaussian, hash};

choices! {
    /// The source of the detections.
    pub enum Source {
        /// The first available: clicks, the detections of the clip, its ground truth unless a detector was chosen, moving objects.
        Auto = "auto" "Automatic",
        /// Positions clicked on the frames.
        Clicks = "clicks" "Clicks",
        /// The detections of the clip's file (det.txt).
        Detections = "detections" "Detections",
        /// The true boxes with Gaussian noise added. Occluded objects are not detected.
        Truth = "truth" "Ground truth with noise",
        /// Blobs of a detector of moving objects, such as background subtraction.
        Moving = "moving" "Moving objects",
    }
}

/// The minimum visible share of a detected true object.
const LEAST_VISIBLE: f32 = 0.3;
/// The side of the box around a click in px.
const CLICK_PX: f32 = 16.0;
/// Returns the default detector of trackers.
pub fn default_detector() -> Stage<Foreground> {
    Stage::named("mixture-of-gaussians").with("initial", "median")
}

/// The measurement noise of true positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation along each axis in px.
    pub deviation_px: f64,
    /// The random seed.
    pub seed: u64,
}

/// The parameters of a source of detections.
#[derive(Clone, Debug)]
pub struct SourceSettings {
    /// The measurement noise of true positions.
    pub noise: Noise,
    /// The clicked positions.
    pub clicks: Spots,
    /// Whether clicks in a single frame choose an object among the detections, instead of being the only measurement.
    pub click_chooses: bool,
    /// The detector of moving objects.
    pub stage: Stage<Foreground>,
}

/// A source of detections. Repeated queries of a frame give the same detections.
#[derive(Clone, Debug)]
pub struct Detector {
    origin: Origin,
    noise: Noise,
}

#[derive(Clone, Debug)]
enum Origin {
    Clicks(Spots),
    Detections,
    Truth,
    /// Blobs of a detector of moving objects.
    Moving(Frames),
}

/// Returns the centre of a true box in px.
pub fn center(object: &ObjectBox) -> [f64; 2] {
    [object.x + object.width / 2.0, object.y + object.height / 2.0].map(f64::from)
}

impl Detector {
    /// Opens a source of detections for the frames `span` of a clip.
    ///
    /// # Errors
    /// If the clip lacks the source, or a frame is damaged.
    pub fn new(source: Source, clip: &Clip, span: &Span, settings: SourceSettings) -> Result<Self, Error> {
        let SourceSettings { noise, clicks, click_chooses, stage } = settings;
        let clicked_frames = clicks.all().iter().map(|spot| spot.frame).collect::<BTreeSet<_>>().len();
        let is_clicked = clicked_frames > usize::from(click_chooses);
        let has_detections = clip.detections(span.first).is_some();
        let has_truth = match clip.truth() {
            Some(truth) => truth.objects(span.first)?.is_some(),
            None => false,
        };
        let lacks = |what: &str| {
            let name = &clip.info().name;
            Err(Error::new(format!("{name} has no {what}; choose another source, or a clip with {what}")))
        };
        let origin = match source {
            Source::Detections if !has_detections => return lacks("detections"),
            Source::Truth if !has_truth => return lacks("true objects"),
            Source::Clicks => Origin::Clicks(clicks),
            Source::Auto if is_clicked => Origin::Clicks(clicks),
            Source::Detections => Origin::Detections,
            Source::Auto if has_detections => Origin::Detections,
            Source::Truth => Origin::Truth,
            // A chosen detector has precedence over the truth.
            Source::Auto if has_truth && stage.to_value() == default_detector().to_value() => Origin::Truth,
            Source::Auto | Source::Moving => Origin::Moving(stage.frames(clip, span.first, span.most())?),
        };
        Ok(Self { origin, noise })
    }

    /// Returns the detections of frame `t` in a fixed order.
    ///
    /// # Errors
    /// If the frame or the truth cannot be read.
    pub fn look(&self, clip: &Clip, t: usize) -> Result<Vec<Detection>, Error> {
        match &self.origin {
            Origin::Clicks(clicks) => Ok(clicks.of_frame(t).map(clicked).collect()),
            Origin::Detections => Ok(clip.detections(t).unwrap_or_default().to_vec()),
            Origin::Truth => {
                let objects = clip.truth().map(|truth| truth.objects(t)).transpose()?.flatten().unwrap_or_default();
                let seen = objects.iter().filter(|object| is_detected(object));
                Ok(seen.map(|object| self.measured(object, t)).collect())
            }
            Origin::Moving(frames) => Ok(frames.at(t)?.map_or_else(Vec::new, |frame| frame.detections.clone())),
        }
    }

    /// Returns the true object of the detection with this index in frame `t`, where the source knows it: only true boxes name their object.
    ///
    /// # Errors
    /// If the truth cannot be read.
    pub fn object_of(&self, clip: &Clip, t: usize, index: usize) -> Result<Option<u32>, Error> {
        let (Origin::Truth, Some(truth)) = (&self.origin, clip.truth()) else { return Ok(None) };
        let objects = truth.objects(t)?.unwrap_or_default();
        Ok(objects.iter().filter(|object| is_detected(object)).nth(index).map(|object| object.id))
    }

    /// Returns four standard normal random numbers for an object in a frame.
    pub fn chances(&self, id: u32, t: usize) -> [f64; 4] {
        let of_object = hash(self.noise.seed, u64::from(id), t as u64);
        [2, 3, 4, 5].map(|stream| gaussian(hash(of_object, stream, 0)))
    }

    /// Returns whether detections have scores of a detector, as those of a file do.
    pub fn has_scores(&self) -> bool {
        matches!(self.origin, Origin::Detections)
    }

    /// Returns the name of its measurements.
    pub fn measurement(&self) -> &'static str {
        match self.origin {
            Origin::Clicks(_) => "clicked position",
            Origin::Detections => "detection of the file",
            Origin::Truth => "true position with noise",
            Origin::Moving(_) => "centroid of a blob",
        }
    }

    /// Returns whether its detections are blobs of moving objects.
    pub fn is_moving(&self) -> bool {
        matches!(self.origin, Origin::Moving(_))
    }

    /// Returns whether its detections are the true boxes with noise.
    pub fn is_truth(&self) -> bool {
        matches!(self.origin, Origin::Truth)
    }

    /// Returns whether it detects a true object in frame `t`; `None` where only the truth could tell and it is another source.
    pub fn detects(&self, object: &ObjectBox) -> Option<bool> {
        self.is_truth().then(|| is_detected(object))
    }

    /// Returns whether its detections are clicks.
    pub fn is_clicked(&self) -> bool {
        matches!(self.origin, Origin::Clicks(_))
    }

    /// Memory in bytes; copies share it.
    pub fn bytes(&self) -> usize {
        match &self.origin {
            Origin::Moving(frames) => frames.bytes(),
            Origin::Clicks(clicks) => size_of_val(clicks.all()),
            Origin::Detections | Origin::Truth => 0,
        }
    }

    fn measured(&self, object: &ObjectBox, t: usize) -> Detection {
        let of_object = hash(self.noise.seed, u64::from(object.id), t as u64);
        let off = [0, 1].map(|axis| self.noise.deviation_px * gaussian(hash(of_object, axis, 0)));
        let place = center(object);
        let center = [0, 1].map(|i| (place[i] + off[i]) as f32);
        let bounds = Bounds::around(center, [object.width, object.height]);
        let deviation_px = Some(self.noise.deviation_px as f32);
        Detection { bounds, center, score: object.visibility, blob: None, deviation_px }
    }
}

/// Returns whether enough of a true object is visible to be detected.
fn is_detected(object: &ObjectBox) -> bool {
    object.visibility >= LEAST_VISIBLE
}

fn clicked(center: [f32; 2]) -> Detection {
    Detection { bounds: Bounds::around(center, [CLICK_PX; 2]), center, score: 1.0, blob: None, deviation_px: None }
}

/// Returns the true position of object `id` in frame `t`.
///
/// # Errors
/// If the truth cannot be read.
pub fn truth_of(clip: &Clip, t: usize, id: u32) -> Result<Option<[f64; 2]>, Error> {
    let Some(truth) = clip.truth() else { return Ok(None) };
    let objects = truth.objects(t)?.unwrap_or_default();
    Ok(objects.iter().find(|object| object.id == id).map(center))
}
