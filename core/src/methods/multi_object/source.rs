//! What is seen of objects in a frame, whoever detects them.

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
        /// What was clicked, or else the detections beside the clip, or else its truth unless a detector was chosen, or else what
        /// moves.
        Auto = "auto" "Whatever there is",
        /// Places that were clicked on the picture.
        Clicks = "clicks" "Clicks",
        /// The detections beside the clip.
        Detections = "detections" "Detections",
        /// The true boxes, measured with noise; what is hidden is not seen.
        Truth = "truth" "Truth with noise",
        /// Blobs of a detector of moving objects.
        Moving = "moving" "What moves",
    }
}

/// An object of which less can be seen is not detected.
const LEAST_VISIBLE: f32 = 0.3;
/// How wide and high the box around a click is.
const CLICK_PX: f32 = 16.0;
/// The detector of trackers, unless another is chosen.
pub fn usual_detector() -> Stage<Foreground> {
    Stage::named("mixture-of-gaussians").with("initial", "median")
}

/// How the truth is measured where it takes the place of a detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation in px of what is added to a true place along each axis.
    pub deviation_px: f64,
    /// What that depends on.
    pub seed: u64,
}

/// What a detector is given beside the clip.
#[derive(Clone, Debug)]
pub struct SourceSettings {
    /// How the truth is measured.
    pub noise: Noise,
    /// Places that were clicked.
    pub clicks: Spots,
    /// The detector of moving objects.
    pub stage: Stage<Foreground>,
}

/// A source of detections in frames, the same ones however often it is asked.
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
    /// Found by a detector of moving objects.
    Moving(Frames),
}

/// The centre of an object.
pub fn center(object: &ObjectBox) -> [f64; 2] {
    [object.x + object.width / 2.0, object.y + object.height / 2.0].map(f64::from)
}

impl Detector {
    /// The source of detections in the frames `span` of a clip, if `source` is wanted.
    ///
    /// # Errors
    /// If the clip has none of what is wanted, or a frame is damaged.
    pub fn new(source: Source, clip: &Clip, span: &Span, settings: SourceSettings) -> Result<Self, Error> {
        let SourceSettings { noise, clicks, stage } = settings;
        let has_detections = clip.detections(span.first).is_some();
        let has_truth = match clip.truth() {
            Some(truth) => truth.objects(span.first)?.is_some(),
            None => false,
        };
        let lacks = |what: &str| {
            let name = &clip.info().name;
            Err(Error::new(format!("{name} has no {what}; choose another source, or a clip that has some")))
        };
        let origin = match source {
            Source::Detections if !has_detections => return lacks("detections"),
            Source::Truth if !has_truth => return lacks("true objects"),
            Source::Clicks => Origin::Clicks(clicks),
            Source::Auto if !clicks.all().is_empty() => Origin::Clicks(clicks),
            Source::Detections => Origin::Detections,
            Source::Auto if has_detections => Origin::Detections,
            Source::Truth => Origin::Truth,
            // Whoever has chosen a detector wants to see it at work.
            Source::Auto if has_truth && stage.to_value() == usual_detector().to_value() => Origin::Truth,
            Source::Auto | Source::Moving => Origin::Moving(stage.frames(clip, span.first, span.most())?),
        };
        Ok(Self { origin, noise })
    }

    /// What is detected in frame `t`, in a fixed order.
    ///
    /// # Errors
    /// If the frame or the truth cannot be read.
    pub fn look(&self, clip: &Clip, t: usize) -> Result<Vec<Detection>, Error> {
        match &self.origin {
            Origin::Clicks(clicks) => Ok(clicks.of_frame(t).map(clicked).collect()),
            Origin::Detections => Ok(clip.detections(t).unwrap_or_default().to_vec()),
            Origin::Truth => {
                let objects = clip.truth().map(|truth| truth.objects(t)).transpose()?.flatten().unwrap_or_default();
                let seen = objects.iter().filter(|object| object.visibility >= LEAST_VISIBLE);
                Ok(seen.map(|object| self.measured(object, t)).collect())
            }
            Origin::Moving(frames) => Ok(frames.at(t)?.map_or_else(Vec::new, |frame| frame.detections.clone())),
        }
    }

    /// Four more numbers of chance for an object in a frame, of mean 0 and standard deviation 1.
    pub fn chances(&self, id: u32, t: usize) -> [f64; 4] {
        let of_object = hash(self.noise.seed, u64::from(id), t as u64);
        [2, 3, 4, 5].map(|stream| gaussian(hash(of_object, stream, 0)))
    }

    /// Whether the scores of what it detects tell how sure it is; they do in rows beside a clip.
    pub fn tells_scores(&self) -> bool {
        matches!(self.origin, Origin::Detections)
    }

    /// What its measurements are, to follow a place.
    pub fn told(&self) -> &'static str {
        match self.origin {
            Origin::Clicks(_) => "as clicked",
            Origin::Detections => "as the detector says",
            Origin::Truth => "the true place with noise added",
            Origin::Moving(_) => "the middle of what moves there",
        }
    }

    /// Whether places that were clicked are what it detects.
    pub fn takes_clicks(&self) -> bool {
        matches!(self.origin, Origin::Clicks(_))
    }

    /// Memory that it takes, in bytes; its copies share it.
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
        Detection { bounds, center, score: object.visibility, blob: None }
    }
}

fn clicked(center: [f32; 2]) -> Detection {
    Detection { bounds: Bounds::around(center, [CLICK_PX; 2]), center, score: 1.0, blob: None }
}

/// The true place of the object that is called `id` in frame `t`.
///
/// # Errors
/// If the truth cannot be read.
pub fn truth_of(clip: &Clip, t: usize, id: u32) -> Result<Option<[f64; 2]>, Error> {
    let Some(truth) = clip.truth() else { return Ok(None) };
    let objects = truth.objects(t)?.unwrap_or_default();
    Ok(objects.iter().find(|object| object.id == id).map(center))
}
