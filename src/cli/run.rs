//! `motionscope run`: one run, its numbers, and what it leaves behind.

use std::path::{Path, PathBuf};
use std::time::Instant;

use motionscope_core::params::Value;
use motionscope_core::{Consistency, Error, Levels, Move, ObjectField, Output, Threads};

use super::args::RunArgs;
use super::outputs::{Place, check_folder, refuse_losses};
use super::report::{Report, Timing, to_json};
use super::say;
use super::task::Task;
use crate::media::export::{self, FlowFormat, Target, TrackFormat};
use crate::motion::{Check, Reverse};
use crate::paint::{FlowLayer, LevelShown};
use crate::quality::{Quality, TrackScores};
use crate::shot::{self, Format, Still};

/// Runs what `args` ask for. Files are made in full before the first is written.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn run(args: &RunArgs) -> Result<(), Error> {
    let outputs = Outputs::new(args)?;
    let task = Task::open(&args.task)?;
    refuse_losses(|| task.inputs(), &places(args), args.force)?;
    if !args.task.beside.is_empty() && outputs.overlay.is_none() {
        return Err(Error::new("--beside is for the picture; give --overlay FILE, or use motionscope compare"));
    }
    if args.look.pixel.is_some() && outputs.overlay.is_none() {
        return Err(Error::new("--pixel is for the picture; give --overlay FILE as well"));
    }
    let threads = args.threads.map_or_else(Threads::all, |n| Threads::new(n as usize))?;
    // Decoded here, so that the time is of the estimation alone.
    task.clip.pair_or_last(task.frame)?;
    let (output, times) = timed(&task, &threads, args.repeat)?;
    let extent = task.estimator.extent(&task.clip, task.frame)?;
    if let Some(step) = args.step.filter(|step| task.company.is_empty() && step.unit >= extent.units) {
        return Err(Error::new(format!("there is no step {step}: the run ends at {}", extent.units)));
    }
    let quality = Quality::of(&task.clip, task.frame, &output)?;
    match &quality.truth_error {
        Some(error) if task.truth_by_hand => return Err(error.clone()),
        Some(error) => eprintln!("warning: {error}"),
        None => {}
    }
    let reverse = Reverse::new(&*task.estimator, &task.clip, task.frame);
    let check = check(&task, args, &output, &reverse)?;
    let live = live_scores(&task, &threads, &quality)?;
    let timing = Timing { threads: threads.count(), times };
    let report = Report::new(&task, &output, (quality, check, live), extent, timing);
    let mut files = Vec::new();
    if let Some((path, format)) = outputs.overlay {
        files.push((path, overlay(&task, args, format, &reverse)?));
    }
    if let Some((path, format)) = outputs.flow {
        let (bytes, lost) = format.encode(&export::flow(&output)?)?;
        if let Some(lost) = lost {
            eprintln!("warning: {}: {lost}", path.display());
        }
        files.push((path, bytes));
    }
    if let Some(path) = &args.table {
        files.push((path, export::csv(&output).into_bytes()));
    }
    if let Some((path, format)) = outputs.tracks {
        files.push((path, format.encode(objects(&output, &task)?)?));
    }
    let masks = args.masks.as_ref().map(|_| export::masks(objects(&output, &task)?)).transpose()?;
    let is_piped = files.iter().any(|(path, _)| *path == Path::new("-"));
    files.into_iter().try_for_each(|(path, bytes)| export::save_result(path, &bytes))?;
    if let (Some(folder), Some(masks)) = (&args.masks, masks) {
        export::write_masks(folder, &masks)?;
    }
    match (args.json, is_piped) {
        (true, _) => say(&to_json(&report)?),
        (false, false) => say(&report.text()),
        (false, true) => {
            eprint!("{}", report.text());
            Ok(())
        }
    }
}

/// Where `args` want results.
fn places(args: &RunArgs) -> Vec<Place<'_>> {
    let files =
        [("--overlay", &args.overlay), ("--flow", &args.flow), ("--table", &args.table), ("--tracks", &args.tracks)];
    let files = files.into_iter().filter_map(|(flag, path)| Some((flag, Target::File(path.as_deref()?))));
    files.chain(args.masks.iter().map(|folder| ("--masks", Target::Numbered(folder, export::MASK)))).collect()
}

/// The formats of results, told from their names.
struct Outputs<'a> {
    overlay: Option<(&'a PathBuf, Format)>,
    flow: Option<(&'a PathBuf, FlowFormat)>,
    tracks: Option<(&'a PathBuf, TrackFormat)>,
}

impl<'a> Outputs<'a> {
    fn new(args: &'a RunArgs) -> Result<Self, Error> {
        let files = [&args.overlay, &args.flow, &args.table, &args.tracks];
        let pipes = files.into_iter().flatten().filter(|path| path.as_path() == Path::new("-")).count();
        if pipes + usize::from(args.json) > 1 {
            return Err(Error::new("only one result fits into standard output; give the others a file"));
        }
        files.into_iter().flatten().try_for_each(|path| check_folder(path))?;
        if let Some(path) = args.table.as_ref().filter(|path| !is_csv(path)) {
            return Err(Error::new(format!("{} is no name of a table; one ends in .csv, or is -", path.display())));
        }
        Ok(Self {
            overlay: args.overlay.as_ref().map(|path| Format::of(path).map(|format| (path, format))).transpose()?,
            flow: args.flow.as_ref().map(|path| FlowFormat::of(path).map(|format| (path, format))).transpose()?,
            tracks: args.tracks.as_ref().map(|path| TrackFormat::of(path).map(|format| (path, format))).transpose()?,
        })
    }
}

/// The objects of a run.
fn objects<'a>(output: &'a Output, task: &Task) -> Result<&'a ObjectField, Error> {
    let id = task.estimator.info().id;
    output.objects().ok_or_else(|| Error::new(format!("{id} looks for no objects; leave --tracks and --masks away")))
}

fn is_csv(path: &Path) -> bool {
    path == Path::new("-") || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"))
}

fn timed(task: &Task, threads: &Threads, repeat: u32) -> Result<(Output, Vec<std::time::Duration>), Error> {
    let run = || {
        let start = Instant::now();
        let output = task.estimator.run(&task.clip, task.frame, threads)?;
        Ok((output, start.elapsed()))
    };
    let (output, first) = run()?;
    let rest = (1..repeat).map(|_| run().map(|(_, time)| time)).collect::<Result<Vec<_>, Error>>()?;
    Ok((output, [vec![first], rest].concat()))
}

/// The scores of the same tracker with a live camera, where it was scored and has looked back in time.
fn live_scores(task: &Task, threads: &Threads, quality: &Quality) -> Result<Option<TrackScores>, Error> {
    let is_scored = quality.objects.is_some_and(|objects| objects.scores.is_some());
    let looks_back = ["bridge", "backdate"].map(|name| (name, Value::Switch(true)));
    let looks_back = looks_back.map(|value| task.estimator.values().contains(&value).then_some(value.0));
    if !is_scored || looks_back == [None; 2] {
        return Ok(None);
    }
    let mut tracker = task.estimator.boxed_clone();
    looks_back.into_iter().flatten().try_for_each(|name| tracker.set(name, "off"))?;
    let output = tracker.run(&task.clip, task.frame, threads)?;
    Ok(Quality::of(&task.clip, task.frame, &output)?.objects.and_then(|objects| objects.scores))
}

/// The check with the reverse pair, if it is asked for of a flow that has one.
fn check(task: &Task, args: &RunArgs, output: &Output, reverse: &Reverse<'_>) -> Result<Option<Check>, Error> {
    let is_field = matches!(output, Output::Blocks(_) | Output::Dense(_));
    let is_checked = args.look.layer == Some(FlowLayer::Consistency) && is_field;
    if !is_checked || task.estimator.info().frames != 2 {
        return Ok(None);
    }
    let consistency = Consistency::of(&output.flow(), reverse.flow()?)?;
    Check::of(&consistency, &task.clip, task.frame).map(Some)
}

fn overlay(task: &Task, args: &RunArgs, format: Format, reverse: &Reverse<'_>) -> Result<Vec<u8>, Error> {
    let mut walk = task.company.walk(&*task.estimator, &task.clip, task.frame)?;
    let step = args.step.or(task.cursor);
    walk.jump(step.map_or(Move::End, Move::To));
    if let Some(failure) = walk.failure() {
        return Err(failure.clone());
    }
    if let Some(step) = step.filter(|step| step.unit > walk.cursor().unit) {
        return Err(Error::new(format!("there is no step {step}: the run ends at {}", walk.cursor())));
    }
    let look = task.look(&args.look)?;
    if let Some(view) = look.view.filter(|view| view.is_of_the_end() && !walk.at_end()) {
        let view = view.id();
        return Err(Error::new(format!(
            "the {view} is made at the end of the run; leave --step away or choose another --view"
        )));
    }
    let pair = shot::pair(&task.clip, walk.at_frame())?;
    let focus = task.pixel(&args.look).map_or(Ok(None), |pixel| pixel.here(&*walk, &task.clip))?;
    let still = Still::of((&*walk, focus), (&task.clip, &pair), &look.want(), reverse)?;
    if let Some((layer, why)) = args.look.layer.and_then(|layer| Some((layer, still.offer().why_not(layer)?))) {
        return Err(Error::new(format!("there is no layer {} here: {why}; choose another --layer", layer.id())));
    }
    if let Some(LevelShown::Number(level)) = args.look.level {
        check_level(level, still.levels(), task.estimator.info().id)?;
    }
    still.moment(&*task.estimator).encode(&look, format, args.look.scale)
}

/// Refuses a level that there is not.
fn check_level(level: usize, levels: Option<&Levels>, id: &str) -> Result<(), Error> {
    match levels.map_or(0, |levels| levels.all.len()) {
        0 => Err(Error::new(format!("{id} works on no pyramid; leave --level away"))),
        count if level >= count => {
            Err(Error::new(format!("the pyramid has levels 0 to {}, and not {level}", count - 1)))
        }
        _ => Ok(()),
    }
}
