//! The source of a clip: a file, or a synthetic scene with its sliders.

use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

use motionscope_core::synth::{self, Difficulty};
use motionscope_core::{Clip, Error, Params};

use crate::media::export::Inputs;
use crate::media::{self, Open};

/// The prefix of a synthetic scene: `synth:pillar`, `synth:pillar,noise=5,speed=2`.
const SYNTH: &str = "synth:";

/// The source of a clip.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A file or folder, or `-` for standard input.
    File(PathBuf),
    /// A synthetic scene.
    Synth {
        /// Its id.
        id: &'static str,
        /// Its sliders.
        difficulty: Difficulty,
    },
}

impl Source {
    /// Parses a path, or `synth:` with a scene and its sliders.
    ///
    /// # Errors
    /// If there is no such scene or slider, or a value is out of range.
    pub fn parse(name: impl AsRef<OsStr>) -> Result<Self, Error> {
        let name = name.as_ref();
        let Some(scene) = name.to_str().and_then(|name| name.strip_prefix(SYNTH)) else {
            return Ok(Self::File(name.into()));
        };
        let mut parts = scene.split(',');
        let mut source = Self::synth(parts.next().unwrap_or_default())?;
        for setting in parts {
            source.set(setting)?;
        }
        Ok(source)
    }

    /// Returns the scene `id` with its default sliders.
    ///
    /// # Errors
    /// If there is no such scene.
    pub fn synth(id: &str) -> Result<Self, Error> {
        let scene = synth::scene(id)?;
        Ok(Self::Synth { id: scene.id, difficulty: scene.difficulty() })
    }

    /// Sets a slider of a synthetic scene from `NAME=VALUE`.
    ///
    /// # Errors
    /// If this is a file, or there is no such slider, or the value is out of range.
    pub fn set(&mut self, setting: &str) -> Result<(), Error> {
        match self {
            Self::File(path) => Err(Error::new(format!("{} is a file and has no sliders", path.display()))),
            Self::Synth { difficulty, .. } => set(difficulty, setting),
        }
    }

    /// Opens the clip. Call it off the window's thread.
    ///
    /// # Errors
    /// One sentence that names the file, the reason and a remedy.
    pub fn open(&self, options: &Open) -> Result<Clip, Error> {
        match self {
            Self::File(path) => media::open(path, options),
            Self::Synth { id, difficulty } => {
                let clip = synth::make(id, difficulty)?;
                let clip = match &options.given.truth {
                    Some(truth) => media::with_truth(clip, truth)?,
                    None => clip,
                };
                media::with_detections(clip, options)
            }
        }
    }

    /// Returns the files from which `clip`, opened with `options`, is read.
    pub fn inputs(&self, clip: &Clip, options: &Open) -> Inputs {
        let path = match self {
            Self::File(path) => Some(path.as_path()),
            Self::Synth { .. } => None,
        };
        media::inputs(path, clip, options)
    }

    /// Returns the same source with `f` applied to the path of a file.
    #[must_use]
    pub fn map_path(self, f: impl FnOnce(&Path) -> PathBuf) -> Self {
        match self {
            Self::File(path) if path != Path::new("-") => Self::File(f(&path)),
            other => other,
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Synth { id, difficulty } => {
                write!(f, "{SYNTH}{id}")?;
                let usual = synth::scene(id).map(|scene| scene.difficulty()).unwrap_or_default();
                let changed = difficulty.values().into_iter().zip(usual.values()).filter(|(now, then)| now != then);
                changed.map(|(now, _)| now).try_for_each(|(name, value)| write!(f, ",{name}={value}"))
            }
        }
    }
}

/// Sets a parameter from `NAME=VALUE`.
///
/// # Errors
/// If `setting` has another form, there is no such parameter, or the value is out of range.
pub fn set<P: Params + ?Sized>(params: &mut P, setting: &str) -> Result<(), Error> {
    let (name, value) = setting
        .split_once('=')
        .ok_or_else(|| Error::new(format!("a parameter is set by NAME=VALUE, not by {setting}")))?;
    params.set(name.trim(), value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_read_as_it_is_written() {
        let id = synth::SCENES[0].id;
        for name in [format!("synth:{id}"), format!("synth:{id},speed=2,noise=5.5"), "clips/a,b=c.png".into()] {
            assert_eq!(Source::parse(&name).unwrap().to_string(), name);
        }
    }

    #[test]
    fn what_is_wrong_is_told() {
        let id = synth::SCENES[0].id;
        for (name, told) in [
            ("synth:nowhere".to_string(), id),
            (format!("synth:{id},noise"), "NAME=VALUE"),
            (format!("synth:{id},noise=99"), "0 to 50"),
            (format!("synth:{id},nois=1"), "the nearest is noise"),
        ] {
            assert!(Source::parse(&name).unwrap_err().to_string().contains(told), "{name}");
        }
        assert!(Source::parse("a.mp4").unwrap().set("noise=1").is_err());
    }
}
