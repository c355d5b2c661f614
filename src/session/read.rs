//! The parser of sessions; errors name line and key.

use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::course::estimator;
use motionscope_core::run::{AnyEstimator, Pace};

use super::toml_text::{Entry, Section};
use super::{Session, VERSION, VisiblePart, ink, key, pace};
use crate::experiment::pixel::Held;
use crate::experiment::side_by_side::SideBySide;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Position};
use crate::files::given;
use crate::media::{self, Given, GivenCalibration, RightView};
use crate::view::look::{Changes, Look};

/// Parses the session in `text`, whose paths are relative to `folder`.
///
/// # Errors
/// A sentence with line and key if the text is no session, or names an unknown estimator, parameter or scene.
pub(super) fn session(text: &str, folder: &Path) -> Result<Session, Error> {
    let none = || Error::new(format!("it is no Motionscope session: the line motionscope = {VERSION} is missing"));
    let mut top = Section::parse(text).map_err(|why| if text.lines().any(is_version) { why } else { none() })?;
    let version = top.take("motionscope").ok_or_else(none)?;
    if version.count()? != VERSION as usize {
        let message = format!(
            "its format version is {}, but this Motionscope reads version {VERSION}; open it with the version that wrote it",
            version.plain()?
        );
        return Err(Error::new(message));
    }
    let session = keys(&mut top, None, folder)?;
    top.end()?;
    Ok(session)
}

/// Takes the keys of a session out of `top`. What they do not name is that of `base`, if there is one: without a clip its clip, and
/// without any key of the run its step.
///
/// # Errors
/// The same as of [`session`].
pub(super) fn keys(top: &mut Section<'_>, base: Option<Session>, folder: &Path) -> Result<Session, Error> {
    let source = match (top.take("clip"), &base) {
        (Some(clip), _) => {
            Some(clip.parsed(|clip| Source::parse(clip))?.map_path(|path| given::find(folder.join(path), folder)))
        }
        (None, Some(_)) => None,
        (None, None) => return Err(top.lacks("clip")),
    };
    let mut path = |key| top.take(key).map(|entry| entry.text().map(PathBuf::from)).transpose();
    let given = Given {
        truth: path("truth")?,
        detections: path("detections")?,
        right: path("right")?.map(|path| RightView::of(&path)),
        calibration: path("calibration")?.map(|path| GivenCalibration::of(&path)),
        depths: path("depths")?,
        disparity_scale: scale(top, "disparity-scale", |scale| media::disparity_scale(Some(scale), scale))?,
        depth_scale: scale(top, "depth-scale", |scale| media::depth_scale(Some(scale), scale))?,
        contrast: top.take("contrast").map(|entry| entry.parsed(str::parse)).transpose()?,
    };
    let given = given.map_path(|path| given::find(folder.join(path), folder));
    let mut leader = match (top.take("estimator"), &base) {
        (Some(id), _) => id.parsed(estimator)?,
        (None, Some(base)) => base.experiment.estimator.boxed_clone(),
        (None, None) => return Err(top.lacks("estimator")),
    };
    let (of_others, own): (Vec<_>, Vec<_>) =
        section(top, "set")?.all().into_iter().partition(|(name, _)| has_number(name));
    for (name, value) in own {
        leader.set(&name, &value.plain()?).map_err(|why| value.wrong(why))?;
    }
    let pace = top.take("pace").map_or(Ok(Pace::Block), |entry| entry.parsed(pace))?;
    let mut side_by_side = side_by_side(top, &mut *leader, pace)?;
    for (name, value) in of_others {
        let setting = format!("{name}={}", value.plain()?);
        side_by_side.set(&mut *leader, &setting).map_err(|why| value.wrong(why))?;
    }
    let frame = top.take("frame").map(|frame| frame.count()).transpose()?;
    let experiment = match (source, &base) {
        (None, Some(base)) => Experiment {
            given: base.experiment.given.clone().then(given),
            estimator: leader,
            side_by_side,
            frame: frame.unwrap_or(base.experiment.frame),
            source: base.experiment.source.clone(),
        },
        (source, _) => {
            let source = source.ok_or_else(|| top.lacks("clip"))?;
            Experiment { source, given, estimator: leader, side_by_side, frame: frame.unwrap_or(0) }
        }
    };
    let goes_on = base.filter(|base| base.experiment == experiment).map(|base| base.position);
    let step = top.take("step").map(|step| step.parsed(str::parse)).transpose()?;
    let position =
        Position { cursor: step.or(goes_on.as_ref().and_then(|position| position.cursor)), held: held(top)? };
    let look = look(section(top, "picture")?)?;
    let freehand = ink::read(top, experiment.side_by_side.beside.len() + 1)?;
    Ok(Session { experiment, position, look, sight: sight(top)?, freehand })
}

/// A scale, if its key is there and it is a possible one.
fn scale(
    top: &mut Section<'_>,
    key: &'static str,
    checked: impl Fn(f32) -> Result<f32, Error>,
) -> Result<Option<f32>, Error> {
    let read = |entry: Entry<'_>| checked(entry.number()?).map_err(|why| entry.wrong(why));
    top.take(key).map(read).transpose()
}

/// The held pixel, or the object that was there.
fn held(top: &mut Section<'_>) -> Result<Option<Held>, Error> {
    let (pixel, object) = (top.take("pixel"), top.take("object"));
    let Some(pixel) = pixel else {
        let why = |object: Entry<'_>| object.wrong("an object is held at the key pixel, which is missing");
        return object.map_or(Ok(None), |object| Err(why(object)));
    };
    let id = |object: Entry<'_>| u32::try_from(object.count()?).map_err(|_| object.wrong("there is no such identity"));
    Ok(Some(Held { pixel: pixel.parsed(str::parse)?, object: object.map(id).transpose()? }))
}

/// Whether this line states the version of the format.
fn is_version(line: &str) -> bool {
    line.trim_start().strip_prefix("motionscope").is_some_and(|rest| rest.trim_start().starts_with('='))
}

fn section<'a>(of: &mut Section<'a>, key: &'static str) -> Result<Section<'a>, Error> {
    of.take(key).map_or_else(|| Ok(Section::empty()), Entry::section)
}

/// Whether a parameter is that of an estimator in lockstep, as `2.levels`.
fn has_number(name: &str) -> bool {
    name.split_once('.').is_some_and(|(number, _)| number.parse::<usize>().is_ok())
}

/// Parses the estimators in lockstep with `leader`.
fn side_by_side(top: &mut Section<'_>, leader: &mut dyn AnyEstimator, pace: Pace) -> Result<SideBySide, Error> {
    let Some(entry) = top.take("beside") else { return Ok(SideBySide::default()) };
    if let Ok(ids) = entry.text() {
        let ids: Vec<&str> = ids.split(',').collect();
        return SideBySide::of(leader, &ids, pace).map_err(|why| entry.wrong(why));
    }
    let (mut ids, mut settings) = (Vec::new(), Vec::new());
    for mut one in entry.sections()? {
        let id = one.need("estimator")?;
        ids.push(id.text()?.to_owned());
        // One after the other, so that an error names the line of the estimator that is wrong.
        SideBySide::of(leader, &ids, pace).map_err(|why| id.wrong(why))?;
        settings.push(section(&mut one, "set")?.all());
        one.end()?;
    }
    let mut side_by_side = SideBySide::of(leader, &ids, pace)?;
    // The leader is number 1.
    for (number, settings) in (2..).zip(settings) {
        for (name, value) in settings {
            side_by_side.set(leader, &format!("{number}.{name}={}", value.plain()?)).map_err(|why| value.wrong(why))?;
        }
    }
    Ok(side_by_side)
}

/// Parses the view options that `picture` sets.
fn look(mut picture: Section<'_>) -> Result<Changes, Error> {
    let mut look = Changes::default();
    for (index, spec) in Look::entries().iter().enumerate() {
        if let Some(entry) = picture.take(key(&spec.name)) {
            look.set(index, &entry.value_of(&spec.kind)?).map_err(|why| entry.wrong(why))?;
        }
    }
    picture.end()?;
    Ok(look)
}

fn sight(top: &mut Section<'_>) -> Result<Option<VisiblePart>, Error> {
    let Some(entry) = top.take("sight") else { return Ok(None) };
    let mut section = entry.section()?;
    let (center, zoom) = (section.need("center")?.numbers()?, section.need("zoom")?.number()?);
    let size = section.take("size").map(|size| size.numbers()).transpose()?;
    let sight = VisiblePart { center, zoom, size };
    section.end()?;
    Ok(Some(sight).filter(VisiblePart::is_sound))
}
