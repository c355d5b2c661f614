//! `motionscope compare`: compares estimators on one pair of frames in one table.

use std::io::{IsTerminal, Write, stderr};
use std::path::Path;

use motionscope_core::base::{Error, Stop, Threads};
use motionscope_core::data::Clip;
use motionscope_core::run::AnyEstimator;

use super::args::CompareArgs;
use super::outputs::{Place, check_folder, refuse_losses};
use super::print::{remark, say, say_json};
use super::task;
use crate::experiment::comparison::{self, Conditions, Repeats, Round, Row};
use crate::experiment::source::Source;
use crate::experiment::{course_table, is_of_pair, sweeps};
use crate::media::export::{self, InputKind, Target};
use crate::media::{Given, Open, OpenedClip};
use crate::paint::Theme;
use crate::session::{Named, Session};
use crate::view::rendering::Format;
use crate::view::sweep_plot;
use crate::work;

/// Pixels per point of a plot as PNG.
const PLOT_SCALE: u32 = 2;

/// Runs the comparison that `args` describe.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn compare(args: &CompareArgs) -> Result<(), Error> {
    let given = args.given.with(Given { truth: args.truth.clone(), ..Given::default() });
    let Named { source, given, session, faults } =
        Named::find(&task::clip_name(args.clip.clone(), args.next.clone())?, given)?;
    task::warn_of_faults(&faults);
    let opened = session.map(|session| session.experiment);
    let chosen = args.frame.or(opened.as_ref().map(|opened| opened.frame));
    if args.course {
        return course(args, &source, chosen);
    }
    let estimators =
        comparison::compared_estimators(&args.estimators, opened.as_ref().map(|of| &*of.estimator), &args.set)?;
    task::warn_of_idle(&estimators.iter().map(|estimator| &**estimator).collect::<Vec<_>>(), &args.set);
    let threads = Threads::new(args.threads as usize)?;
    args.csv.as_deref().filter(|path| *path != Path::new("-")).map_or(Ok(()), check_folder)?;
    let plot =
        args.plot.as_deref().map(|path| Ok::<_, Error>((path, Format::of(path)?, plotted(args)?))).transpose()?;
    args.plot.as_deref().filter(|path| *path != Path::new("-")).map_or(Ok(()), check_folder)?;
    let mut rows = Vec::new();
    let given = Open::from(given);
    let rounds = comparison::rounds(&source, &estimators, args.sweep.as_deref())?;
    let (total, repeats) = (rounds.iter().map(|round| round.compared_estimators.len()).sum(), repeats(args));
    if let (Some(sweep), Some(first)) = (&args.sweep, rounds.first()) {
        let id = |estimator: &dyn AnyEstimator| estimator.info().id;
        let is_left_out = |own: &str| first.compared_estimators.iter().all(|other| id(&*other.estimator) != own);
        let left_out = estimators.iter().map(|estimator| id(&**estimator)).filter(|own| is_left_out(own));
        left_out.for_each(|id| remark(&format!("note: --sweep {sweep}: {id} has no such parameter and is left out")));
    }
    let mut frame = chosen;
    for Round { source, compared_estimators } in rounds {
        let OpenedClip { clip, mut inputs } = source.open(&given)?;
        let is_of_pair = compared_estimators.iter().any(|compared| is_of_pair(&*compared.estimator));
        let frame = *frame.get_or_insert_with(|| task::initial_frame(&clip, is_of_pair));
        if rows.is_empty() {
            if Session::is_named(Path::new(&args.clip)) {
                inputs.add(InputKind::Session, &args.clip);
            }
            refuse_losses(&inputs, &places(args), args.force)?;
            tell_truth(&clip);
            for compared in &compared_estimators {
                task::warn_of_unplaced(&*compared.estimator, (&source, &clip), frame);
            }
        }
        let conditions = Conditions { clip: &clip, frame, threads: &threads, repeats };
        for compared in &compared_estimators {
            let status = Status::new((rows.len(), total), compared.estimator.info().name);
            let row = work::finish(Row::of(compared, &conditions))?;
            drop(status);
            if let Some(why) = &row.assessment.truth_warning {
                remark(&format!("warning: {why}"));
            }
            match &row.assessment.truth_error {
                Some(error) if args.truth.is_some() => return Err(error.clone()),
                Some(error) => remark(&format!("warning: {error}")),
                None => {}
            }
            rows.push(row);
        }
    }
    if let Some((path, format, column)) = plot {
        let columns = comparison::all_columns();
        let column = columns[column.unwrap_or_else(|| comparison::telling(&rows)).min(columns.len() - 1)];
        let name = args.sweep.as_deref().and_then(|sweep| sweep.split_once('=')).map_or("", |(name, _)| name);
        let sliders = if let Source::Synth { difficulty, .. } = &source { Some(difficulty) } else { None };
        let axis = sweeps::label(name, &estimators, sliders).unwrap_or("Swept parameter");
        let series = sweep_plot::series(&rows, &column, axis);
        export::save_result(path, &sweep_plot::encode(&series, Theme::default(), format, PLOT_SCALE)?)?;
    }
    if let Some(path) = &args.csv {
        export::save(path, comparison::csv(&rows).as_bytes())?;
    }
    match (args.json, args.markdown, &args.csv) {
        (true, ..) => say_json(&comparison::json(&rows).to_string()),
        (_, true, _) => say(&comparison::markdown(&rows)),
        (_, _, Some(path)) if path.as_os_str() == "-" => Ok(()),
        _ if args.plot.as_deref() == Some(Path::new("-")) => Ok(()),
        _ => say(&comparison::text(&rows)),
    }
}

/// How often each estimator runs.
fn repeats(args: &CompareArgs) -> Repeats {
    args.repeat.map_or(Repeats::AsUsual, Repeats::Exactly)
}

/// A line on a terminal that says which estimator runs, as long as it does.
struct Status(bool);

impl Status {
    fn new((done, total): (usize, usize), name: &str) -> Self {
        let mut to = stderr();
        // Progress that cannot be shown is no reason to stop.
        let is_shown =
            to.is_terminal() && write!(to, "{} of {total}: {name}", done + 1).and_then(|()| to.flush()).is_ok();
        Self(is_shown)
    }
}

impl Drop for Status {
    fn drop(&mut self) {
        if self.0 {
            // Back to the start of the line, which is emptied.
            eprint!("\r\x1b[K");
        }
    }
}

/// Returns the output files of `args`.
fn places(args: &CompareArgs) -> Vec<Place<'_>> {
    let plot = args.plot.iter().map(|path| ("plot", Target::File(path)));
    args.csv.iter().map(|path| ("csv", Target::File(path))).chain(plot).collect()
}

/// Returns the index of the column that `args` want to be plotted, if they name one.
///
/// # Errors
/// If there is no such column.
fn plotted(args: &CompareArgs) -> Result<Option<usize>, Error> {
    let columns = comparison::all_columns();
    let Some(name) = &args.column else { return Ok(None) };
    let found = columns.iter().position(|column| column.name == name);
    found
        .map(Some)
        .ok_or_else(|| Error::new(format!("there is no column {name}; --csv - shows the names of all columns")))
}

/// Prints the ground-truth files to standard error.
fn tell_truth(clip: &Clip) {
    let names = clip.truth().map(|truth| truth.names()).unwrap_or_default();
    if !names.is_empty() {
        remark(&format!("truth: {}", names.join(", ")));
    }
}

/// Measures and prints the course's table.
fn course(args: &CompareArgs, source: &Source, frame: Option<usize>) -> Result<(), Error> {
    let clip = source.open(&Open::default())?.clip;
    let frame = frame.unwrap_or_else(|| task::initial_frame(&clip, true));
    let threads = Threads::new(args.threads as usize)?;
    let conditions = Conditions { clip: &clip, frame, threads: &threads, repeats: repeats(args) };
    let course_table = work::finish(course_table::course_table(&conditions, &Stop::default()))?;
    match (args.json, args.markdown) {
        (true, _) => say_json(&course_table::json(&course_table).to_string()),
        (_, true) => say(&course_table::markdown(&course_table)),
        _ => say(&course_table::text(&course_table)),
    }
}
