//! The comparison of estimators: its rows, its columns, and the table as text, Markdown, CSV and JSON.
//!
//! `compare::Figures` of the core has the figures that only a comparison needs; time and assessment are added here. Command
//! line and window show the same rows. A measure declares which of two of its values is better, from which `best.rs` finds the
//! best rows, and `conclusion.rs` compares them with a reference in sentences.

mod best;
pub mod conclusion;

use std::borrow::Borrow;

use motionscope_core::base::words::{fixed, grouped};
use motionscope_core::base::{Error, Threads};
use motionscope_core::course::compare::{Figures, Run};
use motionscope_core::course::{detection, estimator};
use motionscope_core::data::Clip;
use motionscope_core::params::Value;
use motionscope_core::products::{self, Assessment, Better, Figure, KINDS, Measure, Reference};
use motionscope_core::run::{AnyEstimator, FRAMES};
use serde_json::{Map, json};
use web_time::{Duration, Instant};

use crate::experiment::source::Source;
use crate::experiment::whole;
use crate::work;

/// One estimator of a comparison, with its parameters.
pub struct ComparedEstimator {
    /// The estimator.
    pub estimator: Box<dyn AnyEstimator>,
    /// The swept parameter or slider, and its value here.
    pub swept: Option<(String, String)>,
}

/// Estimators that run on the same clip.
pub struct Round {
    /// The source of the clip.
    pub source: Source,
    /// The estimators that run on it.
    pub compared_estimators: Vec<ComparedEstimator>,
}

/// The conditions of a comparison: clip, frame, threads and repetitions.
pub struct Conditions<'a> {
    /// The clip.
    pub clip: &'a Clip,
    /// Frame t.
    pub frame: usize,
    /// The threads to run on.
    pub threads: &'a Threads,
    /// Runs of each estimator; the shortest time counts.
    pub repeats: Repeats,
}

/// How often an estimator runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeats {
    /// This often.
    Exactly(u32),
    /// Three times, or less often where the runs take longer than [`Repeats::SHORT`]: long times vary little.
    AsUsual,
}

impl Repeats {
    /// The time within which an estimator runs again.
    pub const SHORT: Duration = Duration::from_secs(1);

    /// Whether another run follows after `done` of them, which have taken `spent`.
    fn go_on(self, done: u32, spent: Duration) -> bool {
        match self {
            Self::Exactly(runs) => done < runs,
            Self::AsUsual => done < 3 && spent < Self::SHORT,
        }
    }
}

/// One row of the table.
pub struct Row {
    /// The estimator with the parameters of this run.
    pub estimator: Box<dyn AnyEstimator>,
    /// The swept parameter or slider, and its value here.
    pub swept: Option<(String, String)>,
    /// The shortest time of a run.
    pub time: Duration,
    /// The assessment of the result, as for a single run.
    pub assessment: Assessment,
    /// The figures that only a comparison has.
    pub figures: Figures,
}

impl Row {
    /// Runs `compared` in `conditions`.
    ///
    /// # Errors
    /// If it cannot run there, or a frame cannot be read.
    pub async fn of(compared: &ComparedEstimator, conditions: &Conditions<'_>) -> Result<Self, Error> {
        let Conditions { clip, frame, threads, repeats } = *conditions;
        let estimator = &*compared.estimator;
        decode(estimator, (clip, frame))?;
        let begun = Instant::now();
        let (ran, mut time) = whole::summary(estimator, (clip, frame), threads).await?;
        let mut done = 1;
        // Counted once; further runs are timed without an observer.
        while repeats.go_on(done, begun.elapsed()) {
            let (_, again) = whole::output(estimator, (clip, frame), threads).await?;
            (time, done) = (time.min(again), done + 1);
        }
        let figures = Figures::of(estimator, &ran, (clip, frame), &run_on(threads)).await?;
        work::breathe().await;
        let assessment = detection::assess(estimator, &ran.output, &Reference { clip, frame }, threads)?;
        Ok(Self { estimator: estimator.boxed_clone(), swept: compared.swept.clone(), time, assessment, figures })
    }

    /// The estimator's id.
    pub fn id(&self) -> &'static str {
        self.estimator.info().id
    }
}

/// Does the runs that figures need in addition.
pub(super) fn run_on(threads: &Threads) -> impl Run {
    async |estimator: &dyn AnyEstimator, clip: &Clip, frame: usize| {
        whole::output(estimator, (clip, frame), threads).await.map(|(output, _)| output)
    }
}

/// Frames are decoded before a run if they take no more memory than this: a cache keeps them.
const DECODED_BYTES: usize = 400 << 20;

/// Decodes the frames of a run of `estimator`, so that its time is of the estimation alone.
fn decode(estimator: &dyn AnyEstimator, (clip, frame): (&Clip, usize)) -> Result<(), Error> {
    let [first, _] = clip.pair_or_last(frame)?;
    let Ok(Value::Int(count)) = estimator.get(FRAMES) else { return Ok(()) };
    let most = clip.info().frames.map_or(usize::MAX, |frames| frames.saturating_sub(frame));
    let count = usize::try_from(count).unwrap_or(0).min(most);
    if count.saturating_mul(first.bytes()) <= DECODED_BYTES {
        // A damaged frame is reported by the run; a clip of unknown length may end earlier.
        (frame..frame + count).try_for_each(|t| clip.frame(t).map(drop)).or_else(|_| clip.wanted())?;
    }
    Ok(())
}

/// A column of numbers: a figure of the comparison, or a measure of a product.
#[derive(Clone, Copy)]
pub struct Column {
    /// The heading, with the unit.
    pub heading: &'static str,
    /// The key in CSV and JSON, with the unit.
    pub name: &'static str,
    /// The definition, in one sentence.
    pub doc: &'static str,
    /// Decimals shown.
    digits: usize,
    /// Which of two numbers is better, unless it counts something or trades one quality for another.
    pub better: Option<Better>,
    /// Whether it is a time, which differs from run to run.
    is_time: bool,
    from: From,
}

/// The source of a column's numbers.
#[derive(Clone, Copy)]
enum From {
    Row(fn(&Row) -> Option<f64>, Of),
    Assessment(&'static Measure, f64),
}

/// The estimators that have a figure of the comparison.
#[derive(Clone, Copy)]
enum Of {
    All,
    BlockSearches,
    Fields,
}

impl Of {
    fn has(self, estimator: &dyn AnyEstimator) -> bool {
        match self {
            Of::All => true,
            Of::BlockSearches => estimator.tests_candidates(),
            Of::Fields => estimator.produces().iter().any(|kind| kind.motion.is_field()),
        }
    }
}

impl Column {
    /// Whether it compares with ground truth.
    pub fn is_against_truth(&self) -> bool {
        matches!(self.from, From::Assessment(Measure { is_against_truth: true, .. }, _))
    }

    /// Returns the number in `row`, if there is one.
    pub fn value(&self, row: &Row) -> Option<f64> {
        match self.from {
            From::Row(value, _) => value(row),
            From::Assessment(measure, per) => row.assessment.value(measure).map(|value| value / per),
        }
    }

    /// Returns the number in `row` with the decimals that are shown.
    pub fn shown(&self, row: &Row) -> Option<f64> {
        self.value(row).map(|value| match self.digits {
            0 => value.round(),
            digits => format!("{value:.digits$}").parse().unwrap_or(value),
        })
    }

    /// Returns the number in `row` as shown, or the word that stands for it.
    pub fn text(&self, row: &Row) -> String {
        match (self.value(row), self.from) {
            (Some(value), _) if self.digits == 0 && value >= 0.0 => grouped(value.round() as usize),
            (Some(value), _) => fixed(value, self.digits),
            (None, From::Assessment(measure, _))
                if row.assessment.score(measure).is_some_and(|score| score.value == Figure::None) =>
            {
                match measure.otherwise {
                    "" => NOTHING.to_owned(),
                    word => word.to_owned(),
                }
            }
            (None, _) => NOTHING.to_owned(),
        }
    }

    const fn of_row(
        (heading, name): (&'static str, &'static str),
        digits: usize,
        (value, of): (fn(&Row) -> Option<f64>, Of),
        doc: &'static str,
    ) -> Self {
        Self { heading, name, doc, digits, better: None, is_time: false, from: From::Row(value, of) }
    }

    const fn better(self, better: Better) -> Self {
        Self { better: Some(better), ..self }
    }

    const fn of_time(self) -> Self {
        Self { is_time: true, ..self }
    }

    /// Whether the result of `estimator` may have the number.
    fn may_be_of(&self, estimator: &dyn AnyEstimator) -> bool {
        match self.from {
            From::Row(_, of) => of.has(estimator),
            From::Assessment(measure, _) => {
                let mut own = estimator.produces().iter().flat_map(|kind| kind.measures.iter().copied().flatten());
                own.any(|other| other.key == measure.key)
            }
        }
    }

    fn of_measure(measure: &'static Measure) -> Option<Self> {
        let &products::Column { heading, name, per, digits } = measure.column.as_ref()?;
        let from = From::Assessment(measure, per);
        Some(Self { heading, name, doc: measure.doc, digits, better: measure.better, is_time: false, from })
    }
}

/// Figures of the comparison, before the measures of products.
const COSTS: [Column; 4] = [
    Column::of_row(
        ("candidates", "candidates_mean"),
        1,
        (|r| r.figures.blocks.as_ref().map(|blocks| blocks.candidates_mean), Of::BlockSearches),
        "Mean number of candidates per block; a candidate on a coarser level counts once.",
    )
    .better(Better::Smaller),
    Column::of_row(
        ("max candidates", "candidates_most"),
        0,
        (|r| r.figures.blocks.as_ref().map(|blocks| blocks.candidates_most.into()), Of::BlockSearches),
        "Largest number of candidates of a block.",
    )
    .better(Better::Smaller),
    Column::of_row(
        ("time ms", "ms"),
        2,
        (|r| Some(r.time.as_secs_f64() * 1e3), Of::All),
        "Shortest time of a run, in ms.",
    )
    .better(Better::Smaller)
    .of_time(),
    Column::of_row(
        ("memory kB", "memory_kb"),
        1,
        (|r| Some(r.figures.memory_bytes as f64 / 1e3), Of::All),
        "Memory of the run without the frames, in kB.",
    )
    .better(Better::Smaller),
];

/// Figures of the comparison, after the measures of products.
const ROBUSTNESS: [Column; 3] = [
    Column::of_row(
        ("minimum missed %", "missed_percent"),
        1,
        (|r| r.figures.blocks.as_ref().and_then(|blocks| percent(blocks.missed_share()?)), Of::BlockSearches),
        "Share of the blocks with a cost above the global minimum, which full search finds; undefined with λ > 0.",
    )
    .better(Better::Smaller),
    Column::of_row(
        ("stable under noise %", "kept_in_noise_percent"),
        1,
        (|r| r.figures.kept_in_noise.and_then(percent), Of::Fields),
        "Share of the displacements that change by at most 1 px when Gaussian noise of σ = 10 gray levels is added to both frames.",
    )
    .better(Better::Larger),
    Column::of_row(
        ("stable under brightness change %", "kept_in_light_percent"),
        1,
        (|r| r.figures.kept_in_light.and_then(percent), Of::Fields),
        "Share of the displacements that change by at most 1 px when the gray levels I of frame t + 1 become 1.1 I + 8.",
    )
    .better(Better::Larger),
];

/// Returns all columns after the estimator and the swept value: the figures of a comparison, and every measure of a product that
/// declares a column.
pub fn all_columns() -> Vec<Column> {
    let mut columns = COSTS.to_vec();
    for measure in KINDS.iter().flat_map(|kind| kind.measures.iter().copied().flatten()) {
        if let Some(column) = Column::of_measure(measure).filter(|new| columns.iter().all(|old| old.name != new.name)) {
            columns.push(column);
        }
    }
    columns.extend(ROBUSTNESS);
    columns
}

/// Returns the columns in which at least one row has a number, with their indices among all columns.
pub fn columns_of<R: Borrow<Row>>(rows: &[R]) -> Vec<(usize, Column)> {
    let has_some = |column: &Column| rows.iter().any(|row| column.text(row.borrow()) != NOTHING);
    all_columns().into_iter().enumerate().filter(|(_, column)| rows.is_empty() || has_some(column)).collect()
}

/// Returns the columns that the results of `estimators` may have numbers for, before any of them has run, with their indices among all
/// columns. Errors are left out unless there is ground truth.
pub fn columns_before(estimators: &[Box<dyn AnyEstimator>], has_truth: bool) -> Vec<(usize, Column)> {
    let is_of_some = |column: &Column| estimators.iter().any(|estimator| column.may_be_of(&**estimator));
    let all = all_columns().into_iter().enumerate();
    all.filter(|(_, column)| is_of_some(column) && (has_truth || !column.is_against_truth())).collect()
}

/// Returns the index of the column that answers which row is best: the first that compares with ground truth, or else the
/// first measure of a result; the first of all where there is none.
pub fn telling<R: Borrow<Row>>(rows: &[R]) -> usize {
    let shown = columns_of(rows);
    let measured = |(_, column): &&(usize, Column)| matches!(column.from, From::Assessment(..));
    let best = shown.iter().find(|(_, column)| column.is_against_truth()).or_else(|| shown.iter().find(measured));
    best.or(shown.first()).map_or(0, |(i, _)| *i)
}

/// Returns the columns of [`columns_of`] that tell the rows apart, with their indices among all columns, and those that have the same
/// number in every row. The telling column and the time are always among the first.
pub fn told_apart<R: Borrow<Row>>(rows: &[R]) -> (Vec<(usize, Column)>, Vec<Column>) {
    let best = telling(rows);
    let is_alike = |(i, column): &(usize, Column)| {
        let mut texts = rows.iter().map(|row| column.text(row.borrow()));
        let first = texts.next();
        rows.len() > 1 && *i != best && column.name != "ms" && texts.all(|text| Some(text) == first)
    };
    let (alike, apart) = columns_of(rows).into_iter().partition::<Vec<_>, _>(is_alike);
    (apart, alike.into_iter().map(|(_, column)| column).collect())
}

/// Stands for a missing number.
const NOTHING: &str = "–";

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn percent(share: f64) -> Option<f64> {
    finite(100.0 * share)
}

/// Returns the definitions of the columns shown, one per line.
fn key(rows: &[Row]) -> String {
    let mut text = String::new();
    for (_, Column { heading, doc, .. }) in columns_of(rows) {
        text += &format!("{heading:<18}  {doc}\n");
    }
    text
}

/// Returns the headings and cells of the table.
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

/// Returns the table as text, followed by the comparison in sentences and the definitions of its columns.
pub fn text(rows: &[Row]) -> String {
    columns(&cells(rows)) + "\n" + &paragraph(rows) + &key(rows)
}

/// The sentences of the comparison, one per line, and an empty line; nothing where there is nothing to say.
fn paragraph(rows: &[Row]) -> String {
    let lines: String = conclusion::sentences(rows).iter().map(|sentence| format!("{sentence}\n")).collect();
    if lines.is_empty() { lines } else { lines + "\n" }
}

/// Returns `lines` aligned in columns: the first left-aligned, the others right-aligned.
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

/// Returns the table as Markdown, followed by the comparison in sentences.
pub fn markdown(rows: &[Row]) -> String {
    let sentences = conclusion::sentences(rows).into_iter().map(|sentence| format!("\n{sentence}\n"));
    markdown_table(&cells(rows)) + &sentences.collect::<String>()
}

/// Returns `lines` as a Markdown table; the first line is the heading.
pub fn markdown_table(lines: &[Vec<String>]) -> String {
    let row = |line: &Vec<String>| format!("| {} |\n", line.join(" | "));
    let rule = lines.first().map_or(String::new(), |line| format!("| --- |{}\n", " ---: |".repeat(line.len() - 1)));
    let mut table = lines.iter().map(row);
    table.next().unwrap_or_default() + &rule + &table.collect::<String>()
}

/// Returns the table as CSV; missing numbers are empty.
pub fn csv<R: Borrow<Row>>(rows: &[R]) -> String {
    let all = all_columns();
    let rows = || rows.iter().map(Borrow::borrow);
    let swept = rows().next().and_then(|row: &Row| row.swept.as_ref()).map(|(name, _)| name.replace('-', "_"));
    let names = ["estimator".to_owned()].into_iter().chain(swept);
    let names = names.chain(all.iter().map(|column| column.name.to_owned())).collect::<Vec<_>>();
    let line = |row: &Row| {
        let first = [row.id().to_owned()].into_iter().chain(row.swept.as_ref().map(|(_, value)| value.clone()));
        let number = |column: &Column| column.value(row).map_or_else(String::new, |value| value.to_string());
        first.chain(all.iter().map(number)).collect::<Vec<_>>().join(",") + "\n"
    };
    names.join(",") + "\n" + &rows().map(line).collect::<String>()
}

/// Returns the table as JSON: one object per row, with the numbers of the blocks whose minimum was missed, and unless something was
/// swept with the reference and the comparison with it in words.
pub fn json(rows: &[Row]) -> serde_json::Value {
    let all = all_columns();
    let reference = rows.get(conclusion::reference(rows)).filter(|row| row.swept.is_none());
    let object = |row: &Row| {
        let mut object = Map::new();
        object.insert("estimator".into(), row.id().into());
        if let Some((name, value)) = &row.swept {
            object.insert(name.clone(), value.parse::<f64>().map_or_else(|_| value.as_str().into(), |v| json!(v)));
        }
        for column in &all {
            object.insert(column.name.into(), json!(column.value(row)));
        }
        if let Some(blocks) = &row.figures.blocks {
            object.insert("blocks".into(), blocks.count.into());
            let missed = blocks.missed.as_ref();
            let numbers = missed.map(|missed| missed.iter().map(|block| block + 1).collect::<Vec<_>>());
            object.insert("missed".into(), json!(numbers));
        }
        if let Some(reference) = reference.filter(|reference| !std::ptr::eq(*reference, row)) {
            object.insert("reference".into(), reference.id().into());
            object.insert("comparison".into(), conclusion::against(row, reference).into());
        }
        serde_json::Value::Object(object)
    };
    rows.iter().map(object).collect()
}

/// Returns the rounds of a comparison: one, or one for each value of `sweep`. `sweep` has the form `NAME=V1,V2,..` and names a
/// parameter of the estimators or of one of them, or a slider of the synthetic clip.
///
/// # Errors
/// If `sweep` has another form, there is no such parameter or slider, or a value is out of range.
pub fn rounds(source: &Source, estimators: &[Box<dyn AnyEstimator>], sweep: Option<&str>) -> Result<Vec<Round>, Error> {
    let copies = || estimators.iter().map(|estimator| estimator.boxed_clone()).collect::<Vec<_>>();
    let round = |source: Source, estimators: Vec<Box<dyn AnyEstimator>>, swept: Option<(String, String)>| {
        let compared = |estimator| ComparedEstimator { estimator, swept: swept.clone() };
        Round { source, compared_estimators: estimators.into_iter().map(compared).collect() }
    };
    let Some(sweep) = sweep else { return Ok(vec![round(source.clone(), copies(), None)]) };
    let (name, values) = sweep.split_once('=').ok_or_else(|| {
        Error::new(format!("a sweep has the form NAME=V1,V2,.. as in search-range=4,8,16, not {sweep}"))
    })?;
    let is_parameter = name.contains('.') || estimators.iter().any(|estimator| estimator.get(name).is_ok());
    let one = |value: &str| {
        let (mut source, mut estimators) = (source.clone(), copies());
        if is_parameter {
            // One without the parameter would be the same in all rounds.
            if estimators.iter().any(|estimator| estimator.get(name).is_ok()) {
                estimators.retain(|estimator| estimator.get(name).is_ok());
            }
            set(&mut estimators, name, value)?;
        } else {
            source.set(&format!("{name}={value}"))?;
        }
        Ok(round(source, estimators, Some((name.to_owned(), value.to_owned()))))
    };
    values.split(',').map(|value| one(value.trim())).collect()
}

/// Returns the estimators `ids`, that of an `opened` session or example with the parameters that it has there, with `settings` of the form
/// `ESTIMATOR.NAME=VALUE`, or `NAME=VALUE` for all that have such a parameter.
///
/// # Errors
/// If there is no such estimator or parameter, or a value is out of range.
pub fn compared_estimators(
    ids: &[String],
    opened: Option<&dyn AnyEstimator>,
    settings: &[String],
) -> Result<Vec<Box<dyn AnyEstimator>>, Error> {
    let called = |id: &String| match opened.filter(|opened| opened.info().id == id) {
        Some(opened) => Ok(opened.boxed_clone()),
        None => estimator(id),
    };
    let mut estimators = ids.iter().map(called).collect::<Result<Vec<_>, _>>()?;
    for setting in settings {
        let (name, value) = setting.split_once('=').ok_or_else(|| {
            Error::new(format!("a parameter is set by NAME=VALUE or ESTIMATOR.NAME=VALUE, not by {setting}"))
        })?;
        set(&mut estimators, name, value)?;
    }
    Ok(estimators)
}

/// Sets `ESTIMATOR.NAME` in that one of `estimators`, or `NAME` in all of them that have it.
fn set(estimators: &mut [Box<dyn AnyEstimator>], name: &str, value: &str) -> Result<(), Error> {
    // `detector.learning-rate` is a parameter of a stage, `diamond.block` one of an estimator.
    let is_shared = |name: &str| estimators.iter().any(|estimator| estimator.get(name).is_ok());
    let Some((id, name)) = name.split_once('.').filter(|_| !is_shared(name)) else {
        return set_all(estimators, name, value);
    };
    let ids = estimators.iter().map(|estimator| estimator.info().id).collect::<Vec<_>>().join(", ");
    let mut found = estimators.iter_mut().filter(|estimator| estimator.info().id == id).peekable();
    if found.peek().is_none() {
        return Err(Error::new(format!("{id} is not compared; the estimators of this comparison are {ids}")));
    }
    found.try_for_each(|estimator| estimator.set(name, value))
}

/// Why `setting`, `NAME=VALUE` or `ESTIMATOR.NAME=VALUE`, has no effect on any of `estimators` that has the parameter, once all
/// is set; `None` where it has one.
pub fn why_idle(estimators: &[&dyn AnyEstimator], setting: &str) -> Option<&'static str> {
    let name = setting.split_once('=')?.0.trim();
    let of = |estimator: &dyn AnyEstimator| match name.split_once('.') {
        Some((id, inner)) if id == estimator.info().id => inner.to_owned(),
        _ => name.to_owned(),
    };
    let mut having = estimators.iter().filter(|estimator| estimator.get(&of(**estimator)).is_ok()).peekable();
    let first = having.peek()?.why_idle(&of(**having.peek()?));
    if having.all(|estimator| estimator.why_idle(&of(*estimator)).is_some()) { first } else { None }
}

/// Sets `name` in all of `estimators` that have it.
///
/// # Errors
/// If none has it, or the value is out of range.
pub fn set_all(estimators: &mut [Box<dyn AnyEstimator>], name: &str, value: &str) -> Result<(), Error> {
    let mut set = false;
    for estimator in estimators.iter_mut().filter(|estimator| estimator.get(name).is_ok()) {
        let id = estimator.info().id;
        estimator.set(name, value).map_err(|error| Error::new(format!("{id}: {error}")))?;
        set = true;
    }
    if set { Ok(()) } else { Err(Error::new(format!("none of these estimators has a parameter {name}"))) }
}

#[cfg(test)]
mod tests {
    use motionscope_core::course::compare::{BlockFigures, LIGHT, NOISE_SIGMA};
    use motionscope_core::products::Score;

    use super::*;

    /// The column of this name.
    pub(super) fn column(name: &str) -> Column {
        all_columns().into_iter().find(|column| column.name == name).expect("there is such a column")
    }

    /// A row of an estimator with a mean number of candidates, unless that is undefined, and scores.
    pub(super) fn row(id: &str, candidates: f64, scores: &[(&'static Measure, f64)]) -> Row {
        let blocks = BlockFigures { candidates_mean: candidates, candidates_most: 9, missed: None, count: 4 };
        let blocks = Some(blocks).filter(|blocks| blocks.candidates_mean.is_finite());
        let figures = Figures { memory_bytes: 9, kept_in_noise: None, kept_in_light: None, units: 4, blocks };
        let scores = scores.iter().map(|(measure, value)| Score { measure, value: (*value).into() }).collect();
        Row {
            estimator: estimator(id).expect("it exists"),
            swept: None,
            time: Duration::from_millis(5),
            assessment: Assessment { scores, ..Assessment::default() },
            figures,
        }
    }

    #[test]
    fn a_value_out_of_range_names_its_estimator() {
        let mut estimators =
            [estimator("horn-schunck").expect("it exists"), estimator("hierarchical").expect("it exists")];
        let error = set_all(&mut estimators, "levels", "1").expect_err("one level is no hierarchy").to_string();
        assert!(error.starts_with("hierarchical: levels must be 2 to"), "{error}");
    }

    #[test]
    fn columns_follow_the_products_of_the_estimators() {
        let names = |id: &str| -> Vec<_> {
            let chosen = [estimator(id).expect("it exists")];
            columns_before(&chosen, true).iter().map(|(_, column)| column.name).collect()
        };
        let (search, background, flow) = (names("diamond"), names("mixture-of-gaussians"), names("horn-schunck"));
        assert!(
            ["candidates_mean", "missed_percent", "epe_px", "ms"].iter().all(|name| search.contains(name)),
            "{search:?}"
        );
        assert!(["mask_f1", "detections", "ms"].iter().all(|name| background.contains(name)), "{background:?}");
        for others in ["candidates_mean", "missed_percent", "psnr_db", "kept_in_noise_percent"] {
            assert!(!background.contains(&others), "{background:?}");
        }
        assert!(flow.contains(&"kept_in_noise_percent") && !flow.contains(&"candidates_mean"), "{flow:?}");
        let blind = columns_before(&[estimator("diamond").expect("it exists")], false);
        assert!(blind.iter().all(|(_, column)| column.name != "epe_px"));
    }

    #[test]
    fn every_column_has_a_definition_with_the_settings_of_its_measurement() {
        let doc = |name: &str| all_columns().into_iter().find(|column| column.name == name).map(|column| column.doc);
        assert!(
            doc("kept_in_noise_percent").is_some_and(|doc| doc.contains(&format!("σ = {NOISE_SIGMA} gray levels")))
        );
        let (gain, offset) = LIGHT;
        assert!(doc("kept_in_light_percent").is_some_and(|doc| doc.contains(&format!("{gain} I + {offset}"))));
        for Column { heading, doc, .. } in all_columns() {
            assert!(doc.ends_with('.') && doc.len() > 10, "{heading}: {doc}");
        }
    }
}
