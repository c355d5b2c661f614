//! Reads a session, and says by line and key what is wrong in it.

use std::path::Path;

use motionscope_core::{AnyEstimator, Error, Pace, estimator};

use super::toml_text::{Entry, Section};
use super::{Session, Sight, VERSION, Wanted, colors, pace, spacing_px, stretch, theme, view};
use crate::experiment::company::Company;
use crate::experiment::source::Source;
use crate::paint::{Lengthen, LevelShown, Opacity, Phase, Share};

/// The session in `text`, whose paths are told from `folder`.
///
/// # Errors
/// A sentence that names line and key if the text is no session, or names what does not exist.
pub(super) fn session(text: &str, folder: &Path) -> Result<Session, Error> {
    let none = || Error::new(format!("it is no session of Motionscope, which has a line motionscope = {VERSION}"));
    let mut top = Section::parse(text).map_err(|why| if text.lines().any(is_version) { why } else { none() })?;
    let version = top.take("motionscope").ok_or_else(none)?;
    if version.count()? != VERSION as usize {
        let told = format!(
            "its format is {}, and this Motionscope reads {VERSION}; open it with its own version",
            version.plain()?
        );
        return Err(Error::new(told));
    }
    let source = top.need("clip")?.parsed(|clip| Source::parse(clip))?.map_path(|path| folder.join(path));
    let truth = top.take("truth").map(|truth| truth.text().map(|path| folder.join(path))).transpose()?;
    let mut leader = top.need("estimator")?.parsed(estimator)?;
    for (name, value) in section(&mut top, "set")?.all() {
        leader.set(&name, &value.plain()?).map_err(|why| value.wrong(why))?;
    }
    let pace = top.take("pace").map_or(Ok(Pace::Block), |entry| entry.parsed(pace))?;
    let company = company(&mut top, &mut *leader, pace)?;
    let session = Session {
        source,
        truth,
        estimator: leader,
        company,
        frame: top.take("frame").map_or(Ok(0), |frame| frame.count())?,
        cursor: top.take("step").map(|step| step.parsed(str::parse)).transpose()?,
        pixel: top.take("pixel").map(|pixel| pixel.parsed(str::parse)).transpose()?,
        look: look(section(&mut top, "picture")?)?,
        sight: sight(&mut top)?,
    };
    top.end()?;
    Ok(session)
}

/// Whether this line says which format a session has.
fn is_version(line: &str) -> bool {
    line.trim_start().strip_prefix("motionscope").is_some_and(|rest| rest.trim_start().starts_with('='))
}

fn section<'a>(of: &mut Section<'a>, key: &'static str) -> Result<Section<'a>, Error> {
    of.take(key).map_or_else(|| Ok(Section::empty()), Entry::section)
}

/// Those that go in lockstep with `leader`.
fn company(top: &mut Section<'_>, leader: &mut dyn AnyEstimator, pace: Pace) -> Result<Company, Error> {
    let Some(entry) = top.take("beside") else { return Ok(Company::default()) };
    let (mut ids, mut settings) = (Vec::new(), Vec::new());
    for mut one in entry.sections()? {
        let id = one.need("estimator")?;
        ids.push(id.text()?.to_owned());
        // One after the other, so that the line of the one that cannot be is known.
        Company::of(leader, &ids, pace).map_err(|why| id.wrong(why))?;
        settings.push(section(&mut one, "set")?.all());
        one.end()?;
    }
    let mut company = Company::of(leader, &ids, pace)?;
    for (id, settings) in ids.iter().zip(settings) {
        for (name, value) in settings {
            company.set(leader, &format!("{id}.{name}={}", value.plain()?)).map_err(|why| value.wrong(why))?;
        }
    }
    Ok(company)
}

fn look(mut picture: Section<'_>) -> Result<Wanted, Error> {
    let look = Wanted {
        view: picture.take("view").map(|entry| entry.parsed(view)).transpose()?,
        level: picture.take("level").map(|entry| level(&entry)).transpose()?,
        share: picture.take("blend").map(|entry| number(&entry, Share::new)).transpose()?,
        theme: picture.take("theme").map(|entry| entry.parsed(theme)).transpose()?,
        colors: picture.take("colors").map(|entry| entry.parsed(colors)).transpose()?,
        layer: picture.take("layer").map(|entry| entry.parsed(str::parse)).transpose()?,
        opacity: picture.take("layer-opacity").map(|entry| number(&entry, Opacity::new)).transpose()?,
        lengthen: picture.take("arrows").map(|entry| arrows(&entry)).transpose()?,
        spacing_px: picture.take("arrow-spacing").map(|entry| spacing(&entry)).transpose()?,
        streaks: picture.take("streaks").map(|entry| number(&entry, Phase::new)).transpose()?,
        legend: picture.take("legend").map(|entry| entry.switch()).transpose()?,
        caption: picture.take("caption").map(|entry| entry.switch()).transpose()?,
    };
    picture.end()?;
    Ok(look)
}

fn number<T>(entry: &Entry<'_>, make: impl FnOnce(f32) -> Result<T, Error>) -> Result<T, Error> {
    make(entry.number()?).map_err(|why| entry.wrong(why))
}

fn spacing(entry: &Entry<'_>) -> Result<u16, Error> {
    spacing_px(entry.whole()?).map_err(|why| entry.wrong(why))
}

/// A level of a pyramid by its number, or `at-work`.
fn level(entry: &Entry<'_>) -> Result<LevelShown, Error> {
    entry.plain()?.parse().map_err(|why: Error| entry.wrong(why))
}

/// How many times their length displacements are drawn, or `auto`.
fn arrows(entry: &Entry<'_>) -> Result<Lengthen, Error> {
    let lengthen = match entry.number_or_text()? {
        Ok(factor) => stretch(Some(factor)),
        Err("auto") => Ok(Lengthen::Auto),
        Err(_) => stretch(None),
    };
    lengthen.map_err(|why| entry.wrong(why))
}

fn sight(top: &mut Section<'_>) -> Result<Option<Sight>, Error> {
    let Some(entry) = top.take("sight") else { return Ok(None) };
    let mut section = entry.section()?;
    let sight = Sight { center: section.need("center")?.numbers()?, zoom: section.need("zoom")?.number()? };
    section.end()?;
    Ok(Some(sight).filter(Sight::is_sound))
}
