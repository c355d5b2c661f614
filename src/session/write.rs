//! The writer of sessions.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::course;
use motionscope_core::params::Value;
use motionscope_core::run::AnyEstimator;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::{Session, VERSION, VisiblePart, ink, key};
use crate::experiment::side_by_side;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Position};
use crate::files::{self, given};
use crate::media::{Given, GivenCalibration};
use crate::paint::Freehand;
use crate::view::look::{Changes, Look};

/// The session file.
#[derive(Serialize)]
struct Text<'a> {
    motionscope: u32,
    clip: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    detections: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    right: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    calibration: Option<String>,
    #[serde(rename = "disparity-scale", skip_serializing_if = "Option::is_none")]
    disparity_scale: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    depths: Option<String>,
    #[serde(rename = "depth-scale", skip_serializing_if = "Option::is_none")]
    depth_scale: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contrast: Option<String>,
    estimator: String,
    frame: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pixel: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    object: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pace: Option<String>,
    set: BTreeMap<String, toml::Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    beside: Vec<Companion>,
    picture: Picture<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sight: Option<VisiblePart>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ink: Vec<ink::Line>,
}

/// An estimator in lockstep with the first, and the parameters in which it does not follow that.
#[derive(Serialize)]
struct Companion {
    estimator: String,
    set: BTreeMap<String, toml::Value>,
}

impl Companion {
    fn of(companion: &side_by_side::Companion, leader: &dyn AnyEstimator) -> Self {
        let set = companion.own_values(leader).into_iter().map(|(name, value)| (name, toml_value(&value))).collect();
        Self { estimator: companion.estimator.info().id.into(), set }
    }
}

/// The view options, in the order of declaration.
struct Picture<'a>(&'a Changes);

impl Serialize for Picture<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(None)?;
        self.0.entries().try_for_each(|(spec, value)| map.serialize_entry(key(&spec.name), &toml_value(value)))?;
        map.end()
    }
}

/// Returns the text of `session` for a file in `folder`.
pub(super) fn text(session: &Session, folder: &Path) -> Result<String, Error> {
    with_paths(session, &|path| relative(path, folder))
}

/// Returns the text of `session` with `named` applied to the path of each file.
fn with_paths(session: &Session, named: &dyn Fn(&Path) -> PathBuf) -> Result<String, Error> {
    let Session { experiment, position: Position { cursor, held }, look, sight, freehand } = session;
    let Experiment { source, given, estimator, side_by_side, frame } = experiment;
    let Given { truth, detections, right, calibration, disparity_scale, depths, depth_scale, contrast } =
        given.clone().map_path(named);
    let path = |path: &PathBuf| slashed(path);
    let text = Text {
        motionscope: VERSION,
        clip: match source.clone().map_path(named) {
            Source::File(path) => slashed(&path)?,
            Source::Pair(files) => {
                let [first, second] = [slashed(&files[0])?, slashed(&files[1])?];
                Source::Pair([first, second].map(PathBuf::from)).to_string()
            }
            synth => synth.to_string(),
        },
        truth: truth.as_ref().map(path).transpose()?,
        detections: detections.as_ref().map(path).transpose()?,
        right: right.as_ref().map(|view| slashed(view.path())).transpose()?,
        calibration: match &calibration {
            Some(GivenCalibration::File(file)) => Some(slashed(file)?),
            typed => typed.as_ref().map(ToString::to_string),
        },
        disparity_scale,
        depths: depths.as_ref().map(path).transpose()?,
        depth_scale,
        contrast: contrast.map(|contrast| contrast.to_string()),
        estimator: estimator.info().id.into(),
        frame: *frame,
        step: cursor.map(|cursor| cursor.to_string()),
        pixel: held.map(|held| held.pixel.to_string()),
        object: held.and_then(|held| held.object),
        pace: (!side_by_side.is_empty()).then(|| side_by_side.pace.name().to_owned()),
        set: estimator.all_values().into_iter().map(|(name, value)| (name, toml_value(&value))).collect(),
        beside: side_by_side.beside.iter().map(|one| Companion::of(one, &**estimator)).collect(),
        picture: Picture(look),
        sight: *sight,
        ink: freehand.lines.iter().map(ink::Line::from).collect(),
    };
    toml::to_string(&text).map_err(|error| Error::new(format!("the session cannot be written: {error}")))
}

/// Returns the keys of `session` with `named` applied to the path of each file, without those that a new run of its estimator on its clip
/// has anyway. The theme is left out as well: it is that of the room.
pub(super) fn differing(session: &Session, named: &dyn Fn(&Path) -> PathBuf) -> Result<toml::Table, Error> {
    let unwritten = |why: toml::de::Error| Error::new(format!("the session cannot be written: {why}"));
    let estimator = &*session.experiment.estimator;
    let usual = Session {
        experiment: Experiment::new(session.experiment.source.clone(), course::estimator(estimator.info().id)?),
        position: Position::default(),
        look: Look::opening(estimator.shows_frame_alone()).into(),
        sight: None,
        freehand: Freehand::default(),
    };
    let table = |session: &Session| with_paths(session, named)?.parse::<toml::Table>().map_err(unwritten);
    let (mut keys, usual) = (table(session)?, table(&usual)?);
    keys.remove("motionscope");
    keys.insert("set".into(), changed_values(estimator)?.into());
    let is_usual = |name: &str, value: &toml::Value| usual.get(name) == Some(value);
    keys.retain(|name, value| matches!(name, "clip" | "estimator") || !is_usual(name, value));
    if let Some(toml::Value::Table(picture)) = keys.get_mut("picture") {
        picture
            .retain(|name, value| name != "theme" && usual.get("picture").and_then(|of| of.get(name)) != Some(value));
    }
    keys.retain(|_, value| value.as_table().is_none_or(|section| !section.is_empty()));
    Ok(keys)
}

/// The parameters of `estimator` and its stages that differ from their defaults.
fn changed_values(estimator: &dyn AnyEstimator) -> Result<toml::Table, Error> {
    let mut fresh = course::estimator(estimator.info().id)?;
    let mut changed = toml::Table::new();
    for (name, value) in estimator.all_values() {
        if fresh.get(&name).ok().as_ref() != Some(&value) {
            fresh.set(&name, &value.to_string())?;
            changed.insert(name, toml_value(&value));
        }
    }
    Ok(changed)
}

/// Returns `path` relative to `folder`, with `..` where needed; absolute if they have no common root. A file that was given to a page
/// keeps its name: the session is given together with it.
pub(super) fn relative(path: &Path, folder: &Path) -> PathBuf {
    if let Some(name) = given::name_of(path) {
        return name;
    }
    // What exists is looked up, so that links and `..` lead where they lead; the rest is told by its parts.
    let whole = |path: &Path| {
        let whole = files::canonicalize(path).unwrap_or_else(|_| files::absolute(path));
        whole.components().fold(PathBuf::new(), |mut whole, part| {
            match part {
                Component::ParentDir => drop(whole.pop()),
                Component::CurDir => {}
                part => whole.push(part),
            }
            whole
        })
    };
    let (path, folder) = (whole(path), whole(folder));
    let (parts, folders): (Vec<_>, Vec<_>) = (path.components().collect(), folder.components().collect());
    let common = parts.iter().zip(&folders).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return path;
    }
    let up = folders[common..].iter().map(|_| Component::ParentDir);
    up.chain(parts[common..].iter().copied()).collect()
}

/// Returns the path with forward slashes on every system.
pub(super) fn slashed(path: &Path) -> Result<String, Error> {
    let text = path.to_str().ok_or_else(|| {
        Error::new(format!("a session cannot hold the path {}, which is not Unicode; rename the file", path.display()))
    })?;
    Ok(if std::path::MAIN_SEPARATOR == '\\' { text.replace('\\', "/") } else { text.into() })
}

fn toml_value(value: &Value) -> toml::Value {
    match value {
        Value::Int(v) => (*v).into(),
        Value::Real(v) => (*v).into(),
        Value::Switch(v) => (*v).into(),
        Value::Choice(v) => (*v).into(),
        Value::Placed(v) => v.to_string().into(),
        Value::Stage(v) => v.id().into(),
    }
}
