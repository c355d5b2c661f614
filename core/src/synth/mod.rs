//! Synthetic clips with exact truth, made on the fly from painted layers that move.
//!
//! A *scene* ([`SCENES`]) is a list of layers from front to back. Each has a shape, a paint that can be evaluated at any
//! real coordinate, and a motion that is exact in both directions; so a frame is rendered, and a pixel's true motion
//! known, at any moment. [`Difficulty`] holds one slider for each difficulty of the course.
//!
//! The same scene and sliders give the same bytes on every platform, in whichever order frames are asked for: all
//! randomness is hashed from the seed and the place, and all functions are our own.
//!
//! ```
//! use motionscope_core::{Params, synth};
//! let scene = synth::scene("pillar")?;
//! let mut difficulty = scene.difficulty();
//! difficulty.set("noise", "5")?;
//! let clip = scene.clip(&difficulty)?;
//! assert_eq!(clip.frame(3)?.size(), (320, 240));
//! # Ok::<(), motionscope_core::Error>(())
//! ```

mod camera;
mod compression;
mod difficulty;
pub(crate) mod disturb;
mod layer;
mod maths;
mod motion;
pub(crate) mod random;
mod recent;
mod scenes;
mod shape;
mod texture;
mod truth;

use std::sync::Arc;

use crate::base::{Error, Stop, words};
use crate::data::{Clip, ClipInfo, Frame, FrameSource};
use layer::{Layer, Stage, reach, scale};
use recent::Recent;
use truth::ExactTruth;

pub use difficulty::Difficulty;
pub use scenes::SCENES;

/// A synthetic scene, named for what it teaches.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Kebab-case name, for scripts.
    pub id: &'static str,
    /// Name to show.
    pub title: &'static str,
    /// One sentence: what there is to learn from it.
    pub teaches: &'static str,
    /// Changes the sliders from off to what the scene needs.
    tune: fn(&mut Difficulty),
    /// Its layers, front to back.
    layers: fn(&Setting) -> Vec<Layer>,
}

/// What a scene may want to know before it is built.
struct Setting {
    /// Other numbers give other textures.
    seed: u32,
    /// How many px of the picture a unit of the scene takes.
    scale: f64,
    /// How far from its middle anything can be seen, in the scene's units.
    reach: f64,
    /// How many times faster than usual everything moves.
    speed: f64,
}

impl Setting {
    fn new(d: &Difficulty) -> Self {
        Self { seed: d.seed.wrapping_mul(1000), scale: scale(d), reach: reach(d), speed: f64::from(d.speed) }
    }
}

impl Sample {
    /// The sliders as this scene is meant to be seen first.
    pub fn difficulty(&self) -> Difficulty {
        let mut difficulty = Difficulty::default();
        (self.tune)(&mut difficulty);
        difficulty
    }

    /// The clip, whose frames are rendered when they are asked for, with its truth.
    ///
    /// # Errors
    /// A sentence with the range of the first slider that is not within its range.
    pub fn clip(&self, difficulty: &Difficulty) -> Result<Clip, Error> {
        difficulty.check()?;
        let stage = Arc::new(Stage::new((self.layers)(&Setting::new(difficulty)), difficulty.clone()));
        let info = ClipInfo {
            name: self.title.into(),
            width: difficulty.width,
            height: difficulty.height,
            frames: Some(difficulty.frames),
            fps: Some(25.0),
            container: "synthetic".into(),
            codec: "rgb24".into(),
            warnings: Vec::new(),
        };
        let truth = ExactTruth::new(Arc::clone(&stage), difficulty.clone());
        Ok(Clip::new(info, Arc::new(Studio::new(stage, difficulty.clone()))).with_truth(Arc::new(truth)))
    }
}

/// The scene called `id`.
///
/// # Errors
/// A sentence with the names there are.
pub fn scene(id: &str) -> Result<&'static Sample, Error> {
    SCENES.iter().find(|scene| scene.id == id).ok_or_else(|| {
        let ids: Vec<_> = SCENES.iter().map(|scene| scene.id).collect();
        Error::new(words::there_is_no("synthetic scene", id, &ids))
    })
}

/// The clip of the scene called `id`.
///
/// # Errors
/// If there is no such scene, or a slider is not within its range.
pub fn make(id: &str, difficulty: &Difficulty) -> Result<Clip, Error> {
    scene(id)?.clip(difficulty)
}

/// Renders frames when they are asked for.
struct Studio {
    stage: Arc<Stage>,
    difficulty: Difficulty,
    kept: Recent<Frame>,
}

impl Studio {
    /// Keeps as many frames as fit into 32 MiB, but at least the two of a pair.
    fn new(stage: Arc<Stage>, difficulty: Difficulty) -> Self {
        const BUDGET_BYTES: usize = 32 << 20;
        const BYTES_PER_PIXEL: usize = 4;
        let most = (BUDGET_BYTES / (difficulty.width * difficulty.height * BYTES_PER_PIXEL)).max(2);
        Self { stage, difficulty, kept: Recent::new(most) }
    }
}

impl FrameSource for Studio {
    fn frame(&self, index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        if index >= self.difficulty.frames {
            return Err(Error::new(format!("there is no frame {index}")));
        }
        Ok(self.kept.get(index, || camera::take(&self.stage, &self.difficulty, index)))
    }

    fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        self.kept.peek(index)
    }
}

#[cfg(test)]
mod tests;
