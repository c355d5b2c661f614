//! Synthetic clips with exact ground truth, rendered on demand from moving layers.
//!
//! A *scene* ([`SCENES`]) is a list of layers from front to back. Each has a shape, a texture defined at every real
//! coordinate, and an invertible motion, so that frames and true motion are exact at any time. Scenes for stereo consist of planes
//! and spheres in space instead; they have a right view, a calibration, and true disparities. [`Difficulty`] holds one slider for each
//! difficulty of the course.
//!
//! The same scene and sliders give the same bytes on every platform, in any order of frames: random numbers are hashes of
//! seed and position, and all elementary functions are our own.
//!
//! ```
//! use motionscope_core::synth;
//! use motionscope_core::params::Params;
//! let scene = synth::scene("pillar")?;
//! let mut difficulty = scene.difficulty();
//! difficulty.set("noise", "5")?;
//! let clip = scene.clip(&difficulty)?;
//! assert_eq!(clip.frame(3)?.size(), (320, 240));
//! # Ok::<(), motionscope_core::base::Error>(())
//! ```

mod camera;
mod compression;
mod difficulty;
pub(crate) mod disturb;
mod layer;
mod maths;
mod motion;
mod path;
pub(crate) mod random;
mod recent;
mod scenes;
mod shape;
mod space;
mod stage;
mod texture;
mod truth;

use std::sync::Arc;

use crate::base::{Error, Stop, words};
use crate::data::{Clip, ClipInfo, Frame, FrameSource, Viewpoint};
use layer::{Layer, reach, scale};
use path::Path;
use recent::Recent;
use space::{Body, Rig, Space};
use stage::Stage;
use truth::ExactTruth;

pub use difficulty::Difficulty;
pub use scenes::SCENES;

/// A synthetic scene, named after the problem it demonstrates.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Kebab-case name, for scripts.
    pub id: &'static str,
    /// Name in the window.
    pub title: &'static str,
    /// The lesson in one or two sentences.
    pub teaches: &'static str,
    /// Sets the scene's own defaults of the sliders.
    tune: fn(&mut Difficulty),
    /// What it consists of.
    scenery: Scenery,
    /// The motion of its camera over layers.
    path: Path,
}

/// What a scene consists of.
#[derive(Clone, Copy, Debug)]
enum Scenery {
    /// Layers, front to back.
    Flat(fn(&Setting) -> Vec<Layer>),
    /// Bodies in space, seen by two cameras.
    Deep(fn(&Setting) -> Vec<Body>, Rig),
}

/// Parameters of a scene's layers.
struct Setting {
    /// Random seed of the textures.
    seed: u32,
    /// Pixels of the picture per unit of the scene.
    scale: f64,
    /// Largest visible distance from the centre, in units of the scene.
    reach: f64,
    /// Factor on all velocities.
    speed: f64,
}

impl Setting {
    fn new(d: &Difficulty, path: &Path) -> Self {
        let speed = f64::from(d.speed);
        let reach = reach(d) + path.reach(speed * d.frames as f64);
        Self { seed: d.seed.wrapping_mul(1000), scale: scale(d), reach, speed }
    }
}

impl Sample {
    /// The default sliders of this scene.
    pub fn difficulty(&self) -> Difficulty {
        let mut difficulty = Difficulty::default();
        (self.tune)(&mut difficulty);
        difficulty
    }

    /// Its layers and its camera.
    fn stage(&self, difficulty: &Difficulty) -> Stage {
        let setting = Setting::new(difficulty, &self.path);
        match self.scenery {
            Scenery::Flat(layers) => {
                Stage::Flat(layer::Stage::new(layers(&setting), difficulty.clone()).seen_along(self.path))
            }
            Scenery::Deep(bodies, rig) => Stage::Deep(Space::new(bodies(&setting), rig, difficulty.clone())),
        }
    }

    /// The clip with its ground truth, and with its right view and calibration where two cameras see it; frames are rendered on demand.
    ///
    /// # Errors
    /// If a slider is out of range: a sentence with the range.
    pub fn clip(&self, difficulty: &Difficulty) -> Result<Clip, Error> {
        difficulty.check()?;
        let stage = Arc::new(self.stage(difficulty));
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
        let view = |viewpoint| {
            let studio = Studio::new((Arc::clone(&stage), viewpoint), difficulty.clone());
            Clip::new(info.clone(), Arc::new(studio))
        };
        let mut clip = view(Viewpoint::Left).with_truth(Arc::new(truth));
        if stage.is_stereo() {
            clip = clip.with_right(view(Viewpoint::Right))?;
        }
        Ok(stage.calibration().into_iter().fold(clip, Clip::with_calibration))
    }
}

/// The scene called `id`.
///
/// # Errors
/// If there is none: a sentence with all names.
pub fn scene(id: &str) -> Result<&'static Sample, Error> {
    // A title is a name, and what the scene teaches behind a colon.
    let name = |scene: &Sample| scene.title.split(':').next().unwrap_or(scene.title);
    let is_called = |scene: &&Sample| scene.id == id || words::is_name(id, name(scene));
    SCENES.iter().find(is_called).ok_or_else(|| {
        let ids: Vec<_> = SCENES.iter().map(|scene| scene.id).collect();
        Error::new(words::there_is_no("synthetic scene", id, &ids))
    })
}

/// The clip of the scene called `id`.
///
/// # Errors
/// If there is no such scene, or a slider is out of range.
pub fn make(id: &str, difficulty: &Difficulty) -> Result<Clip, Error> {
    scene(id)?.clip(difficulty)
}

/// The source of a synthetic clip: renders frames on demand.
struct Studio {
    stage: Arc<Stage>,
    viewpoint: Viewpoint,
    difficulty: Difficulty,
    kept: Recent<Frame>,
}

impl Studio {
    /// A source that caches as many frames as fit into 32 MiB, but at least two.
    fn new((stage, viewpoint): (Arc<Stage>, Viewpoint), difficulty: Difficulty) -> Self {
        const BUDGET_BYTES: usize = 32 << 20;
        const BYTES_PER_PIXEL: usize = 4;
        let most = (BUDGET_BYTES / (difficulty.width * difficulty.height * BYTES_PER_PIXEL)).max(2);
        Self { stage, viewpoint, difficulty, kept: Recent::new(most) }
    }
}

impl FrameSource for Studio {
    fn frame(&self, index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        if index >= self.difficulty.frames {
            return Err(Error::new(format!("there is no frame {index}")));
        }
        Ok(self.kept.get(index, || camera::take((&self.stage, self.viewpoint), &self.difficulty, index)))
    }

    fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        self.kept.peek(index)
    }
}

#[cfg(test)]
mod tests;
