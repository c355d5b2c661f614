//! Estimators beside each other: the table of a comparison, as text, Markdown, CSV and JSON.

use std::borrow::Borrow;
use std::time::{Duration, Instant};

use motionscope_core::compare::{Figures, LIGHT, NOISE_SIGMA};
use motionscope_core::{AnyEstimator, Clip, Error, Threads, estimator};
use serde_json::{Map, Value, json};

use crate::quality::Quality;
use crate::source::Source;

/// One estimator with the parameters that it is to be compared with.
pub struct Contender {
    /// The estimator.
    pub estimator: Box<dyn AnyEstimator>,
    /// The parameter or slider that is swept, and its value here.
    pub swept: Option<(String, String)>,
}

/// Where estimators are compared, and how often each is run for its time.
pub struct Arena<'a> {
    /// The clip.
    pub clip: &'a Clip,
    /// Frame t.
    pub frame: usize,
    /// The threads to run on.
    pub threads: &'a Threads,
    /// How often each is run; the least time counts.
    pub repeat: u32,
}

/// One line of the table.
pub struct Row {
    /// The estimator, as it was run.
    pub estimator: Box<dyn AnyEstimator>,
    /// What was swept, and its value here.
    pub swept: Option<(String, String)>,
    /// The least time of a run.
    pub time: Duration,
    /// How good the result is, as a single run tells it.
    pub quality: Quality,
    /// What only a comparison has.
    pub figures: Figures,
}

impl Row {
    /// Runs `contender` in `arena`.
    ///
    /// # Errors
    /// If it cannot run there, or a frame cannot be read.
    pub fn of(contender: &Contender, arena: &Arena<'_>) -> Result<Self, Error> {
        let Arena { clip, frame, threads, repeat } = *arena;
        let estimator = &*contender.estimator;
        let run = || {
            let start = Instant::now();
            let output = estimator.run(clip, frame, threads)?;
            Ok::<_, Error>((output, start.elapsed()))
        };
        // Decoded here, so that the time is of the estimation alone.
        clip.pair_or_last(frame)?;
        let (output, mut time) = run()?;
        for _ in 1..repeat {
            time = time.min(run()?.1);
        }
        let figures = Figures::of(estimator, &output, (clip, frame), threads)?;
        let quality = Quality::of(clip, frame, &output)?;
        Ok(Self { estimator: estimator.boxed_clone(), swept: contender.swept.clone(), time, quality, figures })
    }

    /// The estimator's id.
    pub fn id(&self) -> &'static str {
        self.estimator.info().id
    }
}

/// A column of numbers.
pub struct Column {
    /// Its heading, for a person.
    pub heading: &'static str,
    /// Its name with the unit, for a script.
    pub name: &'static str,
    /// The number, if there is one.
    pub value: fn(&Row) -> Option<f64>,
    /// Digits behind the point, for a person.
    digits: usize,
}

impl Column {
    /// The number in `row` for a person. A perfect prediction has no PSNR.
    pub fn text(&self, row: &Row) -> String {
        match (self.value)(row) {
            Some(value) => format!("{value:.*}", self.digits),
            None if self.name == "psnr_db" && row.quality.prediction.is_some() => "perfect".to_owned(),
            None => NOTHING.to_owned(),
        }
    }
}

/// The columns behind the estimator's name and what is swept.
pub const COLUMNS: [Column; 20] = [
    Column {
        heading: "candidates",
        name: "candidates_mean",
        value: |r| r.figures.blocks.as_ref().map(|blocks| blocks.candidates_mean),
        digits: 1,
    },
    Column {
        heading: "most",
        name: "candidates_most",
        value: |r| r.figures.blocks.as_ref().map(|blocks| blocks.candidates_most.into()),
        digits: 0,
    },
    Column { heading: "ms", name: "ms", value: |r| Some(r.time.as_secs_f64() * 1e3), digits: 2 },
    Column { heading: "kB", name: "memory_kb", value: |r| Some(r.figures.memory_bytes as f64 / 1e3), digits: 1 },
    Column { heading: "PSNR dB", name: "psnr_db", value: |r| r.quality.prediction?.psnr_db, digits: 2 },
    Column { heading: "EPE px", name: "epe_px", value: |r| r.quality.truth.map(|e| e.epe_px), digits: 3 },
    Column { heading: "EPE of", name: "known", value: |r| r.quality.truth.map(|e| e.known as f64), digits: 0 },
    Column { heading: "features", name: "points", value: |r| r.quality.features.map(|f| f.points as f64), digits: 0 },
    Column {
        heading: "missed %",
        name: "missed_percent",
        value: |r| r.figures.blocks.as_ref().and_then(|blocks| percent(blocks.missed_share()?)),
        digits: 1,
    },
    Column {
        heading: "noise %",
        name: "kept_in_noise_percent",
        value: |r| r.figures.kept_in_noise.and_then(percent),
        digits: 1,
    },
    Column {
        heading: "light %",
        name: "kept_in_light_percent",
        value: |r| r.figures.kept_in_light.and_then(percent),
        digits: 1,
    },
    Column {
        heading: "residual kB",
        name: "residual_kb",
        value: |r| kilobytes(r.quality.prediction?.residual_bits),
        digits: 2,
    },
    Column {
        heading: "vectors kB",
        name: "vectors_kb",
        value: |r| r.quality.prediction?.vector_bits.and_then(kilobytes),
        digits: 2,
    },
    Column { heading: "anew kB", name: "frame_kb", value: |r| kilobytes(r.quality.prediction?.frame_bits), digits: 2 },
    Column { heading: "found", name: "detections", value: |r| Some(r.quality.objects?.detections as f64), digits: 0 },
    Column { heading: "objects", name: "objects", value: |r| Some(r.quality.objects?.objects as f64), digits: 0 },
    Column { heading: "MOTA", name: "mota", value: |r| Some(r.quality.objects?.scores?.mota), digits: 3 },
    Column { heading: "IDF1", name: "idf1", value: |r| Some(r.quality.objects?.scores?.idf1), digits: 3 },
    Column { heading: "HOTA", name: "hota", value: |r| Some(r.quality.objects?.scores?.hota), digits: 3 },
    Column {
        heading: "switches",
        name: "switches",
        value: |r| Some(r.quality.objects?.scores?.switches as f64),
        digits: 0,
    },
];

/// The columns in which at least one row has something, with their places among all: what a person looks at.
pub fn columns_of<R: Borrow<Row>>(rows: &[R]) -> Vec<(usize, &'static Column)> {
    let has_some = |column: &Column| rows.iter().any(|row| column.text(row.borrow()) != NOTHING);
    COLUMNS.iter().enumerate().filter(|(_, column)| rows.is_empty() || has_some(column)).collect()
}

/// What stands where there is no number.
const NOTHING: &str = "–";

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn percent(share: f64) -> Option<f64> {
    finite(100.0 * share)
}

fn kilobytes(bits: f64) -> Option<f64> {
    finite(bits / 8e3)
}

/// What the columns mean, under the table.
pub fn key() -> String {
    format!(
        "candidates, most: tested for a block, on average and at most (those of a coarser level once); kB: memory of the run beside the frames;\n\
         EPE of: pixels whose motion is known and was found; where these are not the same, EPEs are of different pixels, and one that\n\
         says less of a picture may look better; a still background makes it small for whoever leaves all in place; normal flow is only\n\
         the part of the motion along the gradient, which no EPE against the whole motion does justice; missed: blocks for which full search, set alike, finds a smaller cost (not told with lambda); noise, light: blocks\n\
         (or pixels) that keep their displacement within 1 px under noise of {NOISE_SIGMA} gray levels, and where frame t+1\n\
         is {} times as bright plus {}; residual, vectors, anew: zero-order entropy of what is sent with motion, and of the\n\
         frame without; found: detections in all frames; –: what only some have, or what is not known.\n",
        LIGHT.0, LIGHT.1
    )
}

/// Heading and cells of a table for a person.
fn cells(rows: &[Row]) -> Vec<Vec<String>> {
    let swept = rows.first().and_then(|row| row.swept.as_ref()).map(|(name, _)| name.clone());
    let mut heading = vec!["estimator".to_owned()];
    heading.extend(swept);
    let shown = columns_of(rows);
    heading.extend(shown.iter().map(|(_, column)| column.heading.to_owned()));
    let line = |row: &Row| {
        let mut line = vec![row.id().to_owned()];
        line.extend(row.swept.as_ref().map(|(_, value)| value.clone()));
        line.extend(shown.iter().map(|(_, column)| column.text(row)));
        line
    };
    std::iter::once(heading).chain(rows.iter().map(line)).collect()
}

/// The table in columns, and what they mean.
pub fn text(rows: &[Row]) -> String {
    columns(&cells(rows)) + "\n" + &key()
}

/// Lines of cells in columns, the first to the left, the others to the right.
pub fn columns(lines: &[Vec<String>]) -> String {
    let width = |i: usize| lines.iter().map(|line| line[i].chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for line in lines {
        for (i, cell) in line.iter().enumerate() {
            text += &if i == 0 { format!("{cell:<0$}", width(i)) } else { format!("  {cell:>0$}", width(i)) };
        }
        text += "\n";
    }
    text
}

/// The table as Markdown.
pub fn markdown(rows: &[Row]) -> String {
    markdown_table(&cells(rows))
}

/// Lines of cells as a table of Markdown, the first line its heading.
pub fn markdown_table(lines: &[Vec<String>]) -> String {
    let row = |line: &Vec<String>| format!("| {} |\n", line.join(" | "));
    let rule = lines.first().map_or(String::new(), |line| format!("| --- |{}\n", " ---: |".repeat(line.len() - 1)));
    let mut table = lines.iter().map(row);
    table.next().unwrap_or_default() + &rule + &table.collect::<String>()
}

/// The table as CSV; what is not known is left empty.
pub fn csv<R: Borrow<Row>>(rows: &[R]) -> String {
    let rows = || rows.iter().map(Borrow::borrow);
    let swept = rows().next().and_then(|row: &Row| row.swept.as_ref()).map(|(name, _)| name.replace('-', "_"));
    let names = ["estimator".to_owned()].into_iter().chain(swept);
    let names = names.chain(COLUMNS.iter().map(|column| column.name.to_owned())).collect::<Vec<_>>();
    let line = |row: &Row| {
        let first = [row.id().to_owned()].into_iter().chain(row.swept.as_ref().map(|(_, value)| value.clone()));
        let number = |column: &Column| (column.value)(row).map_or_else(String::new, |value| value.to_string());
        first.chain(COLUMNS.iter().map(number)).collect::<Vec<_>>().join(",") + "\n"
    };
    names.join(",") + "\n" + &rows().map(line).collect::<String>()
}

/// The table as JSON: an array of one object per row, with the blocks that were missed where there are blocks.
pub fn json(rows: &[Row]) -> Value {
    let object = |row: &Row| {
        let mut object = Map::new();
        object.insert("estimator".into(), row.id().into());
        if let Some((name, value)) = &row.swept {
            object.insert(name.clone(), value.parse::<f64>().map_or_else(|_| value.as_str().into(), |v| json!(v)));
        }
        for column in &COLUMNS {
            object.insert(column.name.into(), json!((column.value)(row)));
        }
        if let Some(blocks) = &row.figures.blocks {
            object.insert("blocks".into(), blocks.count.into());
            let missed = blocks.missed.as_ref();
            let numbers = missed.map(|missed| missed.iter().map(|block| block + 1).collect::<Vec<_>>());
            object.insert("missed".into(), json!(numbers));
        }
        Value::Object(object)
    };
    rows.iter().map(object).collect()
}

/// Each clip with what runs on it: one round, or one for each value that is swept. `sweep` is written `NAME=V1,V2,..`
/// and names a parameter of the estimators or of one of them, or a slider of the synthetic clip.
///
/// # Errors
/// If it is not written so, there is no such parameter or slider, or a value is out of range.
pub fn rounds(
    source: &Source,
    estimators: &[Box<dyn AnyEstimator>],
    sweep: Option<&str>,
) -> Result<Vec<(Source, Vec<Contender>)>, Error> {
    let copies = || estimators.iter().map(|estimator| estimator.boxed_clone()).collect::<Vec<_>>();
    let round = |source: Source, estimators: Vec<Box<dyn AnyEstimator>>, swept: Option<(String, String)>| {
        let contender = |estimator| Contender { estimator, swept: swept.clone() };
        (source, estimators.into_iter().map(contender).collect())
    };
    let Some(sweep) = sweep else { return Ok(vec![round(source.clone(), copies(), None)]) };
    let (name, values) = sweep
        .split_once('=')
        .ok_or_else(|| Error::new(format!("a sweep is written NAME=V1,V2,.. as in range=4,8,16, not {sweep}")))?;
    let is_parameter = name.contains('.') || estimators.iter().any(|estimator| estimator.get(name).is_ok());
    let one = |value: &str| {
        let (mut source, mut estimators) = (source.clone(), copies());
        if is_parameter {
            set(&mut estimators, name, value)?;
        } else {
            source.set(&format!("{name}={value}"))?;
        }
        Ok(round(source, estimators, Some((name.to_owned(), value.to_owned()))))
    };
    values.split(',').map(|value| one(value.trim())).collect()
}

/// The estimators called `ids`, with `settings` of the form `ESTIMATOR.NAME=VALUE`, or `NAME=VALUE` for all that have
/// such a parameter.
///
/// # Errors
/// If there is no such estimator or parameter, or a value is out of range.
pub fn contenders(ids: &[String], settings: &[String]) -> Result<Vec<Box<dyn AnyEstimator>>, Error> {
    let mut estimators = ids.iter().map(|id| estimator(id)).collect::<Result<Vec<_>, _>>()?;
    for setting in settings {
        let (name, value) = setting.split_once('=').ok_or_else(|| {
            Error::new(format!("a parameter is set as NAME=VALUE or ESTIMATOR.NAME=VALUE, not as {setting}"))
        })?;
        set(&mut estimators, name, value)?;
    }
    Ok(estimators)
}

/// Sets `ESTIMATOR.NAME` in that one of `estimators`, or `NAME` in all of them that have it.
fn set(estimators: &mut [Box<dyn AnyEstimator>], name: &str, value: &str) -> Result<(), Error> {
    let Some((id, name)) = name.split_once('.') else { return set_all(estimators, name, value) };
    let ids = estimators.iter().map(|estimator| estimator.info().id).collect::<Vec<_>>().join(", ");
    let mut found = estimators.iter_mut().filter(|estimator| estimator.info().id == id).peekable();
    if found.peek().is_none() {
        return Err(Error::new(format!("{id} is not compared; there are {ids}")));
    }
    found.try_for_each(|estimator| estimator.set(name, value))
}

/// Sets `name` in all of `estimators` that have it.
///
/// # Errors
/// If none has it, or the value is out of range.
pub fn set_all(estimators: &mut [Box<dyn AnyEstimator>], name: &str, value: &str) -> Result<(), Error> {
    let mut set = false;
    for estimator in estimators.iter_mut().filter(|estimator| estimator.get(name).is_ok()) {
        estimator.set(name, value)?;
        set = true;
    }
    if set { Ok(()) } else { Err(Error::new(format!("none of these estimators has a parameter {name}"))) }
}
