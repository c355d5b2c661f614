//! The `[[ink]]` sections of a session: lines drawn by hand on its steps.

use motionscope_core::Error;
use motionscope_core::scene::Picture;
use serde::Serialize;

use super::toml_text::{Entry, Section};
use crate::paint::{Freehand, FreehandLine};

/// Largest coordinate of a point in px, in both directions.
const FARTHEST: f32 = 1e5;

/// A line as it is written.
#[derive(Serialize)]
pub(super) struct Line {
    step: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    estimator: Option<usize>,
    color: &'static str,
    points: String,
}

impl From<&FreehandLine> for Line {
    fn from(line: &FreehandLine) -> Self {
        let points: Vec<_> = line.points.iter().map(|[x, y]| format!("{x},{y}")).collect();
        Self {
            step: line.step.to_string(),
            picture: (line.on != Picture::CURRENT).then(|| line.on.to_string()),
            estimator: (line.member > 0).then_some(line.member + 1),
            color: line.color.id(),
            points: points.join(" "),
        }
    }
}

/// Takes the lines out of `top`, on the pictures of `count` estimators.
///
/// # Errors
/// A sentence with line and key if one of them cannot be read.
pub(super) fn read(top: &mut Section<'_>, count: usize) -> Result<Freehand, Error> {
    let sections = top.take("ink").map_or(Ok(Vec::new()), Entry::sections)?;
    let lines = sections.into_iter().map(|section| line(section, count)).collect::<Result<_, _>>()?;
    Ok(Freehand { lines })
}

fn line(mut section: Section<'_>, count: usize) -> Result<FreehandLine, Error> {
    let on = section.take("picture").map_or(Ok(Picture::CURRENT), |picture| picture.parsed(str::parse))?;
    let member = section.take("estimator").map_or(Ok(0), |number| member(&number, count))?;
    let line = FreehandLine {
        step: section.need("step")?.parsed(str::parse)?,
        member,
        on,
        color: section.take("color").map_or(Ok(Default::default()), |color| color.parsed(str::parse))?,
        points: section.need("points")?.parsed(points)?,
    };
    section.end()?;
    Ok(line)
}

/// The estimator in lockstep that has this number, counted from 1.
fn member(number: &Entry<'_>, count: usize) -> Result<usize, Error> {
    let wrong = || match count {
        1 => number.wrong("the session has one estimator; leave the key out"),
        _ => number.wrong(format!("the estimators of the session are numbered from 1 to {count}")),
    };
    number.count()?.checked_sub(1).filter(|index| *index < count).ok_or_else(wrong)
}

/// Points as they are written: `120.5,33 121,35.25`.
fn points(text: &str) -> Result<Vec<[f32; 2]>, Error> {
    let number = |text: &str| text.parse::<f32>().ok().filter(|c| c.abs() <= FARTHEST);
    let point = |text: &str| {
        let (x, y) = text.split_once(',')?;
        Some([number(x)?, number(y)?])
    };
    let read = |text| {
        point(text).ok_or_else(|| {
            let name = Error::short_name(text);
            Error::new(format!(
                "points have the form X,Y in px with spaces between them, as in 120.5,33 121,35, not {name}"
            ))
        })
    };
    let all = text.split_whitespace().map(read).collect::<Result<Vec<_>, _>>()?;
    if all.is_empty() { Err(Error::new("a line has at least one point, as in 120.5,33")) } else { Ok(all) }
}
