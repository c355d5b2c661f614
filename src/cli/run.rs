//! `motionscope run`: runs an estimator, prints its report and saves its results.

use std::path::{Path, PathBuf};

use motionscope_core::base::{Error, Threads};
use motionscope_core::course::detection;
use motionscope_core::products::model::IDENTITY;
use motionscope_core::products::{Consistency, EpipolarField, ModelField, Output, PathField, Reference, TrackField};
use motionscope_core::run::{AnyEstimator, Cursor, Move, RunSummary};
use motionscope_core::scene::{Levels, Picture, Step};
use web_time::{Duration, Instant};

use super::args::RunArgs;
use super::link;
use super::outputs::{self, check_folder, refuse_losses};
use super::print::{remark, say, say_beside, say_json, to_json};
use super::report::{ExplainedPixel, Findings, Report, Timing};
use super::step::{StepReport, print_steps};
use super::task;
use crate::experiment::pixel::{Chosen, Pixel};
use crate::experiment::{Position, Prepared, is_of_pair, is_repeated, repeated_note};
use crate::media::export::{self, Target};
use crate::paint::primitive::Rect;
use crate::paint::{FlowLayer, Freehand, LevelShown};
use crate::results::{self, Export};
use crate::view::look::Look;
use crate::view::moment::{Moment, Viewer};
use crate::view::motion::{self, Check, Reverse, Site};
use crate::view::panes::Selection;
use crate::view::rendering::{Format, Rendering};

/// Runs the estimator of `args`. All results are encoded before the first file is saved.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn run(args: &RunArgs, link_base: Option<&str>) -> Result<(), Error> {
    let outputs = Outputs::new(args)?;
    args.paper.check()?;
    let session = task::session(&args.task, &args.picture)?;
    if args.link {
        return say(&link::link(args, session, link_base)?);
    }
    let (look, section) = (task::look(&session), task::section(&session));
    let place = Place { args, look, section, position: session.position, freehand: session.freehand };
    let prepared = task::prepare(&args.task, session.experiment)?;
    refuse_losses(&prepared.inputs, &places(args), args.force)?;
    if let Some(range) = args.steps {
        return print_steps(&prepared, range);
    }
    let Prepared { experiment, clip, .. } = &prepared;
    let (estimator, frame) = (&*experiment.estimator, experiment.frame);
    outputs.check(estimator)?;
    Selection::of(&args.sheet.panes).check(estimator)?;
    if !args.task.beside.is_empty() && outputs.overlay.is_none() {
        return Err(Error::new("--beside affects only the picture; add --overlay FILE, or use motionscope compare"));
    }
    if !args.sheet.panes.is_empty() && outputs.overlay.is_none() {
        return Err(Error::new("--panes affects only the picture; add --overlay FILE"));
    }
    let threads = args.threads.map_or_else(Threads::all, |n| Threads::new(n as usize))?;
    // Decoded here, so that the timing covers the estimation alone.
    clip.pair_or_last(frame)?;
    if is_of_pair(estimator) && is_repeated(clip, frame) == Some(true) {
        remark(&format!("warning: {}", repeated_note(frame)));
    }
    let (RunSummary { output, causal, extent }, times) = timed(&prepared, &threads, args.repeat)?;
    let step = args.step.or(place.position.cursor);
    if let Some(step) =
        step.filter(|step| experiment.side_by_side.is_empty() && *step != Cursor::END && step.unit >= extent.units)
    {
        return Err(Error::new(format!("there is no step {step}: the run ends at {}", extent.units)));
    }
    for why in clip.info().warnings.iter().filter(|why| why.starts_with("ground truth")) {
        remark(&format!("warning: {why}"));
    }
    let assessment = detection::assess(estimator, &output, &Reference { clip, frame }, &threads)?;
    if let Some(why) = &assessment.truth_warning {
        remark(&format!("warning: {why}"));
    }
    match &assessment.truth_error {
        Some(error) if experiment.given.truth.is_some() => return Err(error.clone()),
        Some(error) => remark(&format!("warning: {error}")),
        None => {}
    }
    let reverse = Reverse::new(estimator, clip, frame);
    let check = check(&prepared, args, &output, &reverse)?;
    let live = experiment.causal(clip, causal)?;
    let timing = Timing { threads: threads.count(), times };
    let shown = outputs.overlay.is_some() || args.picture.pixel.is_some();
    let seen = shown.then(|| place.seen(&prepared, &reverse)).transpose()?;
    let picture = match (outputs.overlay, &seen) {
        (Some((path, format)), Some(seen)) => Some((path, place.paint(seen, &*experiment.estimator, format)?)),
        _ => None,
    };
    let worksheet = args.paper.worksheet.as_ref().map(|path| Ok((path, place.worksheet(&prepared)?)));
    let worksheet = worksheet.transpose()?;
    let explain = |(pixel, Seen { moment, step, motion })| ExplainedPixel::new(pixel, moment.cursor, &step, motion);
    let pixel = args.picture.pixel.zip(seen).map(explain);
    let conclusion = conclusion(&prepared, &output);
    let step = step.filter(|_| args.json).map(|step| step_report(&prepared, step)).transpose()?;
    let findings = Findings { assessment, check, live, conclusion, pixel, step };
    let report = Report::new(&prepared, &output, findings, extent, timing);
    let encode = |(export, path, format): &(&'static Export, &PathBuf, &results::Format)| {
        let made = (format.encode)(&output)?;
        if let Some(lost) = &made.lost {
            remark(&format!("warning: {}: {lost}", path.display()));
        }
        Ok((*export, path.to_path_buf(), made))
    };
    let made = outputs.results.iter().map(encode).collect::<Result<Vec<_>, Error>>()?;
    if let Some((path, bytes)) = worksheet {
        export::save_result(path, &bytes)?;
    }
    if let Some((path, bytes)) = picture {
        export::save_result(path, &bytes)?;
    }
    made.iter().try_for_each(|(export, path, made)| export.save(path, made).map(drop))?;
    let is_piped = outputs.is_piped;
    match (args.json, is_piped) {
        (true, _) => say_json(&to_json(&report)?),
        (false, false) => say(&report.text()),
        (false, true) => {
            say_beside(&report.text());
            Ok(())
        }
    }
}

/// Where `args` want results.
fn places(args: &RunArgs) -> Vec<outputs::Place<'_>> {
    let overlay = args.overlay.iter().map(|path| ("overlay", Target::File(path)));
    let worksheet = args.paper.worksheet.iter().map(|path| ("worksheet", Target::File(path)));
    let results = args.results.0.iter().map(|(export, path)| (export.flag, export.target(path)));
    overlay.chain(worksheet).chain(results).collect()
}

/// The outputs of a run with their formats.
struct Outputs<'a> {
    overlay: Option<(&'a PathBuf, Format)>,
    results: Vec<(&'static Export, &'a PathBuf, &'static results::Format)>,
    /// Whether one of them goes to standard output.
    is_piped: bool,
}

impl<'a> Outputs<'a> {
    fn new(args: &'a RunArgs) -> Result<Self, Error> {
        let asked = &args.results.0;
        let files = asked.iter().filter(|(export, path)| export.folder_at(path).is_none()).map(|(_, path)| path);
        let files: Vec<_> = args.overlay.iter().chain(files).collect();
        let pipes = files.iter().filter(|path| path.as_path() == Path::new("-")).count();
        if pipes + usize::from(args.json) > 1 {
            return Err(Error::new("only one result can go to standard output; save the others to files"));
        }
        files.iter().try_for_each(|path| check_folder(path))?;
        let formats = asked.iter().map(|(export, path)| Ok((*export, path, export.format(path)?)));
        Ok(Self {
            overlay: args.overlay.as_ref().map(|path| Ok((path, Self::format(args, path)?))).transpose()?,
            results: formats.collect::<Result<_, Error>>()?,
            is_piped: pipes > 0,
        })
    }

    /// Returns the format of the overlay.
    fn format(args: &RunArgs, path: &Path) -> Result<Format, Error> {
        args.format.map_or_else(|| Format::of(path), Ok)
    }

    /// Refuses results that `estimator` does not produce.
    fn check(&self, estimator: &dyn AnyEstimator) -> Result<(), Error> {
        self.results.iter().try_for_each(|(export, ..)| export.check(estimator.info().id, estimator.produces()))
    }
}

/// Runs the estimator `repeat` times; gives the first run, and the time of each.
fn timed(
    Prepared { experiment, clip, .. }: &Prepared,
    threads: &Threads,
    repeat: u32,
) -> Result<(RunSummary, Vec<Duration>), Error> {
    let start = Instant::now();
    let ran = experiment.estimator.run_counted(clip, experiment.frame, threads)?;
    let first = start.elapsed();
    // Further runs are timed without an observer.
    let plain = || {
        let start = Instant::now();
        experiment.estimator.run(clip, experiment.frame, threads).map(|_| start.elapsed())
    };
    let rest = (1..repeat).map(|_| plain()).collect::<Result<Vec<_>, Error>>()?;
    Ok((ran, if rest.is_empty() { vec![first] } else { rest }))
}

/// Returns the sentence of the last step where a model of the motion was estimated, one point was tracked, or motions of a path were refused: it
/// says how far the result holds, or why there is none. Where there is not enough memory to walk through the run, there is none.
fn conclusion(Prepared { experiment, clip, .. }: &Prepared, output: &Output) -> Option<String> {
    // A motion that is refused counts as the identity. One that was estimated as that has a conclusion too.
    let is_refused = |path: &PathField| path.motions.contains(&IDENTITY);
    let is_model = output.get::<ModelField>().is_some() || output.get::<EpipolarField>().is_some();
    let is_one_track = output.get().is_some_and(|field: &TrackField| field.tracks.len() == 1);
    if !is_model && !is_one_track && !output.get().is_some_and(is_refused) {
        return None;
    }
    let mut walk = experiment.estimator.walk(clip, experiment.frame).ok()?;
    walk.jump(Move::End);
    Some(walk.step(None).sentence.plain()).filter(|_| walk.failure().is_none())
}

/// The step at a cursor as data.
fn step_report(Prepared { experiment, clip, .. }: &Prepared, cursor: Cursor) -> Result<StepReport, Error> {
    let mut walk = experiment.estimator.walk(clip, experiment.frame)?;
    walk.jump(if cursor == Cursor::END { Move::End } else { Move::To(cursor) });
    match walk.failure() {
        Some(why) => Err(why.clone()),
        None => Ok(StepReport::of(&*walk)),
    }
}

/// What `args` ask for themselves of how the picture looks: what a session asks for may be missing at some steps.
fn asked(args: &RunArgs) -> Look {
    args.picture.look.0.over(Look::default())
}

/// Computes the forward–backward check, if requested and possible.
fn check(
    Prepared { experiment, clip, .. }: &Prepared,
    args: &RunArgs,
    output: &Output,
    reverse: &Reverse<'_>,
) -> Result<Option<Check>, Error> {
    let is_checked = asked(args).layer == Some(FlowLayer::Consistency) && experiment.estimator.info().frames == 2;
    let Some(flow) = output.flow().filter(|_| is_checked && output.motion().is_field()) else { return Ok(None) };
    let consistency = Consistency::of(&flow, reverse.flow()?)?;
    Check::of(&consistency, clip, experiment.frame).map(Some)
}

/// The step that a picture shows, or at which a pixel is explained.
struct Place<'a> {
    args: &'a RunArgs,
    look: Look,
    /// The part of the pictures that the session shows.
    section: Option<Rect>,
    /// The position in the session.
    position: Position,
    /// What was drawn by hand in the session.
    freehand: Freehand,
}

/// What is seen at a step.
struct Seen {
    /// The step with its pictures.
    moment: Moment,
    /// The explanation of the step alone, without the assessment of the run.
    step: Step,
    /// The motion at the requested pixel, if it is known.
    motion: Option<[f32; 2]>,
}

impl Place<'_> {
    /// Makes the worksheet of the step.
    fn worksheet(&self, prepared: &Prepared) -> Result<Vec<u8>, Error> {
        let Self { args, look, position, .. } = self;
        let cursor = args.step.or(position.cursor).unwrap_or(Cursor::END);
        args.paper.encode(prepared, (cursor, task::pixel(*position, &args.picture)), *look)
    }

    /// Goes there.
    fn seen(&self, prepared: &Prepared, reverse: &Reverse<'_>) -> Result<Seen, Error> {
        let Self { args, look, position, freehand, .. } = self;
        let Prepared { experiment, clip, .. } = prepared;
        let mut viewer = Viewer::new(experiment, clip, look, reverse)?;
        viewer.freehand.clone_from(freehand);
        let walk = &mut *viewer.walk;
        let step = args.step.or(position.cursor).filter(|step| *step != Cursor::END);
        walk.jump(step.map_or(Move::End, Move::To));
        let focus = match task::pixel(*position, &args.picture) {
            // An estimator that explains blocks, at no chosen step: that of the pixel's block.
            Some(Chosen::Asked(pixel)) if args.step.is_none() && pixel.go_to_unit(walk, clip)? => None,
            Some(pixel) => pixel.here(walk, clip)?,
            None => None,
        };
        if let Some(failure) = walk.failure() {
            return Err(failure.clone());
        }
        if let Some(step) = step.filter(|step| step.unit > walk.cursor().unit) {
            return Err(Error::new(format!("there is no step {step}: the run ends at {}", walk.cursor())));
        }
        if let Some(step) = step.filter(|step| step.event != usize::MAX && step.event > walk.cursor().event) {
            remark(&format!("note: there is no step {step}; the last one of its unit is shown, {}", walk.cursor()));
        }
        if let Some(view) = look.view.filter(|view| view.is_of_the_end() && !walk.at_end()) {
            let view = view.id();
            return Err(Error::new(format!(
                "the {view} exists only at the end of the run; omit --step or choose another --view"
            )));
        }
        let moment = viewer.moment(focus)?;
        let walk = &*viewer.walk;
        let motion = args.picture.pixel.and_then(|pixel| motion_at(pixel, Site { walk, clip, scene: &moment.scene }));
        Ok(Seen { step: walk.step(focus), moment, motion })
    }

    /// Draws what is `seen`.
    fn paint(
        &self,
        Seen { moment, .. }: &Seen,
        estimator: &dyn AnyEstimator,
        format: Format,
    ) -> Result<Vec<u8>, Error> {
        let Self { args, look, section, .. } = self;
        let asked = asked(args);
        if let Some((layer, why)) = asked.layer.and_then(|layer| Some((layer, moment.available.why_not(layer)?))) {
            return Err(Error::new(format!("there is no layer {} here: {why}; choose another --layer", layer.id())));
        }
        if let LevelShown::Number(level) = asked.level {
            check_level(level, moment.levels(), estimator.info().id)?;
        }
        let panes = Selection::of(&args.sheet.panes).seeing(*section);
        panes.check_step(estimator.info(), &moment.step)?;
        Rendering { moment, estimator, look, panes: &panes }.encode(format, args.picture.scale)
    }
}

/// Returns the motion known at `pixel`, if it is one of frame t.
fn motion_at(pixel: Pixel, site: Site<'_>) -> Option<[f32; 2]> {
    let is_first = pixel.on == Picture::CURRENT;
    is_first.then(|| motion::known_at([pixel.x, pixel.y].map(|c| c as usize), site)).flatten()
}

/// Refuses a pyramid level that does not exist.
fn check_level(level: usize, levels: Option<&Levels>, id: &str) -> Result<(), Error> {
    match levels.map_or(0, |levels| levels.all.len()) {
        0 => Err(Error::new(format!("{id} uses no pyramid; omit --level"))),
        count if level >= count => Err(Error::new(format!("the pyramid has levels 0 to {}, not {level}", count - 1))),
        _ => Ok(()),
    }
}
