//! What is seen of objects in a frame, whoever detects them.

use super::{Bounds, Detection};
use crate::synth::random::{gaussian, hash};
use crate::{Clip, Error, ObjectBox, choices};

choices! {
    /// Who detects the objects.
    pub enum Source {
        /// The detections beside the clip, or else its truth.
        Auto = "auto" "Whatever there is",
        /// The detections beside the clip.
        Detections = "detections" "Detections",
        /// The true boxes, measured with noise; what is hidden is not seen.
        Truth = "truth" "Truth with noise",
    }
}

/// An object of which less can be seen is not detected.
const LEAST_VISIBLE: f32 = 0.25;

/// Someone who detects objects in frames, the same ones however often they are asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detector {
    /// Who they are; never [`Source::Auto`].
    pub source: Source,
    /// Standard deviation in px of what is added to a true place along each axis.
    pub noise_px: f64,
    /// What that depends on.
    pub seed: u64,
}

/// The centre of an object.
pub fn center(object: &ObjectBox) -> [f64; 2] {
    [object.x + object.width / 2.0, object.y + object.height / 2.0].map(f64::from)
}

impl Source {
    /// Who is meant for `clip` by that.
    ///
    /// # Errors
    /// If the clip has none of what is wanted.
    pub fn of(self, clip: &Clip, frame: usize) -> Result<Self, Error> {
        let has_detections = clip.detections(frame).is_some();
        let has_truth = match clip.truth() {
            Some(truth) => truth.objects(frame)?.is_some(),
            None => false,
        };
        let lacks = |what: &str| {
            Err(Error::new(format!(
                "{} has no {what}; choose another source, or a clip that has some",
                clip.info().name
            )))
        };
        match self {
            Self::Auto if has_detections => Ok(Self::Detections),
            Self::Auto if has_truth => Ok(Self::Truth),
            Self::Auto => lacks("detections and no true objects"),
            Self::Detections if !has_detections => lacks("detections"),
            Self::Truth if !has_truth => lacks("true objects"),
            other => Ok(other),
        }
    }
}

impl Detector {
    /// What is detected in frame `t`, in the order in which it was given.
    ///
    /// # Errors
    /// If the truth cannot be read.
    pub fn look(&self, clip: &Clip, t: usize) -> Result<Vec<Detection>, Error> {
        match (self.source, clip.truth()) {
            (Source::Truth, Some(truth)) => {
                let objects = truth.objects(t)?.unwrap_or_default();
                let seen = objects.iter().filter(|object| object.visibility >= LEAST_VISIBLE);
                Ok(seen.map(|object| self.measured(object, t)).collect())
            }
            _ => Ok(clip.detections(t).unwrap_or_default().to_vec()),
        }
    }

    /// Four more numbers of chance for an object in a frame, of mean 0 and standard deviation 1.
    pub fn chances(&self, id: u32, t: usize) -> [f64; 4] {
        let of_object = hash(self.seed, u64::from(id), t as u64);
        [2, 3, 4, 5].map(|stream| gaussian(hash(of_object, stream, 0)))
    }

    fn measured(&self, object: &ObjectBox, t: usize) -> Detection {
        let of_object = hash(self.seed, u64::from(object.id), t as u64);
        let off = [0, 1].map(|axis| self.noise_px * gaussian(hash(of_object, axis, 0)));
        let place = center(object);
        let center = [0, 1].map(|i| (place[i] + off[i]) as f32);
        let bounds = Bounds::around(center, [object.width, object.height]);
        Detection { bounds, center, score: object.visibility, blob: None }
    }
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
