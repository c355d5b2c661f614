//! The source of a clip: a file, a pair of pictures, or a synthetic scene with its sliders.

use std::ffi::{OsStr, OsString};
use std::fmt;
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::params::Params;
use motionscope_core::synth::{self, Difficulty};

use crate::files;
use crate::media::{self, Open, OpenedClip};

/// The prefix of a synthetic scene: `synth:pillar`, `synth:pillar,noise=5,speed=2`.
const SYNTH: &str = "synth:";

/// The prefix of two pictures: `pair:a.png|b.png`.
const PAIR: &str = "pair:";
/// Stands between the two.
const BETWEEN: char = '|';

/// The source of a clip.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A file or folder, or `-` for standard input.
    File(PathBuf),
    /// Two pictures, frames 0 and 1.
    Pair([PathBuf; 2]),
    /// A synthetic scene.
    Synth {
        /// Its id.
        id: &'static str,
        /// Its sliders.
        difficulty: Difficulty,
    },
}

impl Source {
    /// Parses a path, `pair:` with two of them, or `synth:` with a scene and its sliders.
    ///
    /// # Errors
    /// If there is no such scene or slider, a value is out of range, or there are not two pictures.
    pub fn parse(name: impl AsRef<OsStr>) -> Result<Self, Error> {
        let name = name.as_ref();
        if let Some(pair) = name.to_str().and_then(|name| name.strip_prefix(PAIR)) {
            let message = || Error::new(format!("a pair of pictures has the form {PAIR}A{BETWEEN}B, not {PAIR}{pair}"));
            let [first, second] = two(pair).ok_or_else(message)?;
            return Ok(Self::Pair([first.into(), second.into()]));
        }
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

    /// Parses what a person types: as [`Source::parse`], and a scene by its name in the window unless a file is called so.
    ///
    /// # Errors
    /// As [`Source::parse`].
    pub fn typed(name: impl AsRef<OsStr>) -> Result<Self, Error> {
        let name = name.as_ref();
        let scene = name.to_str().filter(|_| !files::exists(Path::new(name))).and_then(|name| synth::scene(name).ok());
        scene.map_or_else(|| Self::parse(name), |scene| Self::synth(scene.id))
    }

    /// Returns the name of the clip of two pictures, as [`Source::parse`] reads it.
    ///
    /// # Errors
    /// If one of them cannot be part of such a name.
    pub fn pair(first: &OsStr, second: &OsStr) -> Result<OsString, Error> {
        let fault = |name: &OsStr| match name.to_str() {
            None => Some("its name is not UTF-8; rename the file".to_owned()),
            Some("") => Some("it has no name; name two picture files".to_owned()),
            Some(name) if name.contains(BETWEEN) => Some(format!("its name has a {BETWEEN} in it; rename the file")),
            Some(name) if name.starts_with(SYNTH) => Some("it is a synthetic clip; name two picture files".to_owned()),
            Some(_) => None,
        };
        if let Some((odd, why)) = [first, second].into_iter().find_map(|name| Some((name, fault(name)?))) {
            let odd = Error::short_name(&odd.display().to_string());
            return Err(Error::new(format!("{odd} cannot be one of two pictures: {why}")));
        }
        Ok(format!("{PAIR}{}{BETWEEN}{}", first.display(), second.display()).into())
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
            Self::Pair(_) => Err(Error::new("two pictures have no sliders")),
            Self::Synth { difficulty, .. } => set(difficulty, setting),
        }
    }

    /// Opens the clip. Call it off the window's thread.
    ///
    /// # Errors
    /// One sentence that names the file, the reason and a remedy.
    pub fn open(&self, options: &Open) -> Result<OpenedClip, Error> {
        match self {
            Self::File(path) => media::open(path, options),
            Self::Pair(files) => media::open_pair(files, options),
            Self::Synth { id, difficulty } => media::open_scene(synth::make(id, difficulty)?, options),
        }
    }

    /// Returns the paths of its files, without standard input.
    pub fn paths(&self) -> Vec<&Path> {
        match self {
            Self::Pair(files) => files.iter().map(PathBuf::as_path).collect(),
            Self::File(path) if path != Path::new("-") => vec![path.as_path()],
            Self::File(_) | Self::Synth { .. } => Vec::new(),
        }
    }

    /// Returns the same source with `f` applied to the path of each file.
    #[must_use]
    pub fn map_path(self, f: impl Fn(&Path) -> PathBuf) -> Self {
        match self {
            Self::Pair(files) => Self::Pair(files.map(|file| f(&file))),
            Self::File(path) if path != Path::new("-") => Self::File(f(&path)),
            other => other,
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Pair([first, second]) => write!(f, "{PAIR}{}{BETWEEN}{}", first.display(), second.display()),
            Self::Synth { id, difficulty } => {
                write!(f, "{SYNTH}{id}")?;
                let usual = synth::scene(id).map(|scene| scene.difficulty()).unwrap_or_default();
                let changed = difficulty.values().into_iter().zip(usual.values()).filter(|(now, then)| now != then);
                changed.map(|(now, _)| now).try_for_each(|(name, value)| write!(f, ",{name}={value}"))
            }
        }
    }
}

/// The two names in `pair`.
fn two(pair: &str) -> Option<[&str; 2]> {
    let (first, second) = pair.split_once(BETWEEN)?;
    let is_two = !first.is_empty() && !second.is_empty() && !second.contains(BETWEEN);
    is_two.then_some([first, second])
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
        for name in [
            format!("synth:{id}"),
            format!("synth:{id},speed=2,noise=5.5"),
            "clips/a,b=c.png".into(),
            "pair:clips/a.png|b.png".into(),
        ] {
            assert_eq!(Source::parse(&name).unwrap().to_string(), name);
        }
    }

    #[test]
    fn what_is_wrong_is_reported() {
        let id = synth::SCENES[0].id;
        for (name, message) in [
            ("synth:nowhere".to_string(), id),
            (format!("synth:{id},noise"), "NAME=VALUE"),
            (format!("synth:{id},noise=99"), "0 to 50"),
            (format!("synth:{id},nois=1"), "the nearest is noise"),
            ("pair:a.png".into(), "pair:A|B"),
            ("pair:a.png|b.png|c.png".into(), "pair:A|B"),
        ] {
            assert!(Source::parse(&name).unwrap_err().to_string().contains(message), "{name}");
        }
        assert!(Source::parse("a.mp4").unwrap().set("noise=1").is_err());
        assert!(Source::pair("a|b.png".as_ref(), "c.png".as_ref()).is_err());
    }
}
