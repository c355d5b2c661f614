//! The `[[ink]]` sections of a session: lines drawn by hand on its steps.

use motionscope_core::base::Error;
use motionscope_core::scene::Picture;
use serde::Serialize;

use super::toml_text::{Entry, Section};
use crate::paint::{Freehand, FreehandLine, Ground};
use crate::view::panes::{EXPLANATION, Named, PANES, Pane, STAGE};

/// Largest coordinate of a point in px, in both directions.
const FARTHEST: f32 = 1e5;
/// Least side of a chart in points.
const LEAST_SIDE: f32 = 1.0;

/// A line as it is written.
#[derive(Serialize)]
pub(super) struct Line {
    step: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chart: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    size: Option<[f32; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    view: Option<[f32; Ground::VIEW]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    estimator: Option<usize>,
    color: &'static str,
    points: String,
}

impl From<&FreehandLine> for Line {
    fn from(line: &FreehandLine) -> Self {
        let points: Vec<_> = line.points.iter().map(|[x, y]| format!("{x},{y}")).collect();
        let (chart, size, view) = match line.on {
            Ground::Picture(_) => (None, None, None),
            Ground::Chart { pane, size, view } => (Some(pane), Some(size), view),
        };
        Self {
            step: line.step.to_string(),
            picture: line.picture().filter(|picture| *picture != Picture::CURRENT).map(|picture| picture.to_string()),
            chart,
            size,
            view,
            estimator: (line.member > 0).then_some(line.member + 1),
            color: line.color.id(),
            points: points.join(" "),
        }
    }
}

/// Takes the lines out of `top`, on pictures and charts of `count` estimators.
///
/// # Errors
/// A sentence with line and key if one of them cannot be read.
pub(super) fn read(top: &mut Section<'_>, count: usize) -> Result<Freehand, Error> {
    let sections = top.take("ink").map_or(Ok(Vec::new()), Entry::sections)?;
    let lines = sections.into_iter().map(|section| line(section, count)).collect::<Result<_, _>>()?;
    Ok(Freehand { lines })
}

fn line(mut section: Section<'_>, count: usize) -> Result<FreehandLine, Error> {
    let on = ground(&mut section)?;
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

/// What a line lies on: a chart if one is named, or else a picture.
fn ground(section: &mut Section<'_>) -> Result<Ground, Error> {
    let picture = section.take("picture");
    let Some(chart) = section.take("chart") else {
        let picture: Picture = picture.map_or(Ok(Picture::CURRENT), |picture| picture.parsed(str::parse))?;
        return Ok(picture.into());
    };
    if let Some(picture) = picture {
        return Err(picture.wrong("a line lies on a picture or on a chart; leave out picture or chart"));
    }
    let pane = chart_pane(&chart)?.id;
    let entry = section.need("size")?;
    let size: [f32; 2] = entry.numbers()?;
    if !size.iter().all(|side| (LEAST_SIDE..=FARTHEST).contains(side)) {
        return Err(entry.wrong(format!("width and height of a chart are {LEAST_SIDE} to {FARTHEST} points")));
    }
    let view = section.take("view").map(|entry| view(&entry)).transpose()?;
    Ok(Ground::Chart { pane, size, view })
}

/// The pane that is named, if it is a chart.
fn chart_pane(name: &Entry<'_>) -> Result<&'static Pane, Error> {
    let Named(pane) = name.parsed(str::parse)?;
    let is_chart = |pane: &&Pane| **pane != STAGE && **pane != EXPLANATION;
    if is_chart(&pane) {
        return Ok(pane);
    }
    let charts: Vec<_> = PANES.into_iter().filter(is_chart).map(|pane| pane.id).collect();
    Err(name.wrong(format!("{} is no chart; the charts are {}", pane.id, charts.join(", "))))
}

/// Viewpoint, section or scroll position of a chart.
fn view(entry: &Entry<'_>) -> Result<[f32; Ground::VIEW], Error> {
    let numbers: [f32; Ground::VIEW] = entry.numbers()?;
    match numbers.iter().all(|number| number.is_finite()) {
        true => Ok(numbers),
        false => Err(entry.wrong("the view of a chart has finite numbers")),
    }
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
