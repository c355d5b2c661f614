//! The task of a run or an export: a session from a file, or one put together from flags.

use super::print::remark;
use std::ffi::OsString;
use std::path::Path;
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::course::estimator;
use motionscope_core::data::Clip;
use motionscope_core::run::{AnyEstimator, FRAMES};

use super::args::{PictureArgs, TaskArgs};
use crate::experiment::comparison;
use crate::experiment::pixel::Chosen;
use crate::experiment::side_by_side::SideBySide;
use crate::experiment::source::Source;
use crate::experiment::{
    Experiment, Position, Prepared, first_known_pair, is_of_pair, told_of_pair, told_of_unplaced, unplaced,
};
use crate::media::export::{InputKind, Inputs};
use crate::media::{self, Given, Open};
use crate::paint::primitive::Rect;
use crate::paint::{Freehand, View};
use crate::session::{Named, Session};
use crate::view::look::{Changes, Look};

/// The session that `args` name, with what they and `picture` set in the place of what it says; without one, what they say.
///
/// # Errors
/// If a session, an estimator or a parameter that is named does not exist.
pub fn session(args: &TaskArgs, picture: &PictureArgs) -> Result<Session, Error> {
    let Named { source, given, session, faults } = named(args)?;
    warn_of_faults(&faults);
    let missing = || Error::new("no estimator is given; choose one with --estimator ID, see `motionscope list`");
    let chosen = args.estimator.as_deref().map(estimator).transpose()?;
    let mut session = match (session, &chosen) {
        (Some(session), _) => session,
        (None, None) => return Err(missing()),
        (None, Some(chosen)) => {
            let experiment = Experiment { given, ..Experiment::new(source, chosen.boxed_clone()) };
            Session {
                experiment,
                position: Position::default(),
                look: Changes::default(),
                sight: None,
                freehand: Freehand::default(),
            }
        }
    };
    let Experiment { estimator, side_by_side, frame, .. } = &mut session.experiment;
    // Its own estimator once more, with the parameters that it gives, or another one.
    if let Some(other) = chosen.filter(|chosen| chosen.info().id != estimator.info().id) {
        let before = std::mem::replace(estimator, other);
        side_by_side.relieve(&*before, &**estimator);
    }
    set_lockstep(args, &**estimator, side_by_side)?;
    *frame = args.frame.unwrap_or(*frame);
    session.look = session.look.then(&picture.look.0);
    if picture.look.0.has("focus") {
        session.sight = None;
    }
    if picture.look.0.has("blend") && look(&session).view != Some(View::Blend) {
        return Err(Error::new("--blend needs --view blend"));
    }
    Ok(session)
}

/// Returns the clip or the session that `args` name.
fn named(args: &TaskArgs) -> Result<Named, Error> {
    let given = Given { truth: args.truth.clone(), detections: args.detections.clone(), ..Given::default() };
    let given = args.given.with(given);
    match (&args.clip, &args.detections) {
        (Some(clip), _) => Named::find(&clip_name(clip.clone(), args.next.clone())?, given),
        // Detections by themselves are a clip of empty pictures.
        (None, Some(detections)) => {
            // What is meant as detections is told about as such, not as a clip that it is not.
            media::check_detections(detections)?;
            Named::find(detections.as_os_str(), Given { detections: None, ..given })
        }
        (None, None) => Err(Error::new("no clip is given; name one, or give --detections FILE")),
    }
}

/// Says what is wrong with a link, the rest of which is opened.
pub fn warn_of_faults(faults: &[Error]) {
    faults.iter().for_each(|why| remark(&format!("warning: the link is opened without this: {why}")));
}

/// Returns the name of the clip `clip`, or of the two pictures `clip` and `next`.
///
/// # Errors
/// If they cannot be two pictures.
pub fn clip_name(clip: OsString, next: Option<OsString>) -> Result<OsString, Error> {
    next.map_or(Ok(clip.clone()), |next| Source::pair(&clip, &next))
}

/// Adds the estimators of --beside in lockstep with `leader`.
fn set_lockstep(args: &TaskArgs, leader: &dyn AnyEstimator, side_by_side: &mut SideBySide) -> Result<(), Error> {
    let pace = args.pace.unwrap_or(side_by_side.pace);
    if !args.beside.is_empty() {
        *side_by_side = SideBySide::of(leader, &args.beside, pace)?;
    }
    if args.pace.is_some() && side_by_side.is_empty() {
        return Err(Error::new("--pace needs several estimators in lockstep; add --beside"));
    }
    if args.pace.is_some() {
        side_by_side.pace = pace;
    }
    Ok(())
}

/// Returns the view options of `session` for the command line.
pub fn look(session: &Session) -> Look {
    session.look.over(Look::default())
}

/// Returns the part of the pictures that `session` shows, if one was chosen by hand; --focus chooses another.
pub fn section(session: &Session) -> Option<Rect> {
    session.sight.and_then(|sight| sight.section())
}

/// Returns the pixel of --pixel, or the one held in the session.
pub fn pixel(position: Position, picture: &PictureArgs) -> Option<Chosen> {
    picture.pixel.map(Chosen::Asked).or(position.held.map(Chosen::Held))
}

/// Returns `experiment` with the settings of `args` and its clip open.
///
/// # Errors
/// If the clip cannot be opened, or a parameter or a frame is out of range.
pub fn prepare(args: &TaskArgs, experiment: Experiment) -> Result<Prepared, Error> {
    let mut prepared = Prepared::open(experiment, Open::default())?;
    begin_where_known(args, &mut prepared);
    if let Some(session) = args.clip.as_deref().map(Path::new).filter(|path| Session::is_named(path)) {
        let mut inputs = Inputs::clone(&prepared.inputs);
        inputs.add(InputKind::Session, session);
        prepared.inputs = Arc::new(inputs);
    }
    let Prepared { experiment: Experiment { source, estimator, side_by_side, frame, .. }, clip, .. } = &mut prepared;
    if let Some((first, last)) = args.frames {
        if let Some(count) = clip.info().frames.filter(|&count| last >= count) {
            let end = count.saturating_sub(1);
            return Err(Error::new(format!("--frames {first}..{last} exceeds the last frame, {end}")));
        }
        *frame = first;
        if !estimator.values().iter().any(|(name, _)| *name == FRAMES) {
            return Err(Error::new(format!(
                "{} works on one pair of frames; use --frame instead of --frames",
                estimator.info().id
            )));
        }
        estimator.set(FRAMES, &(last - first + 1).to_string())?;
    }
    for setting in &args.set {
        side_by_side.set(&mut **estimator, setting)?;
    }
    side_by_side.check(&**estimator)?;
    warn_of_idle(&side_by_side.all(&**estimator), &args.set);
    for estimator in side_by_side.all(&**estimator) {
        warn_of_unplaced(estimator, (&*source, clip), *frame);
    }
    Ok(prepared)
}

/// Asks for the rectangle that a run on a clip of one's own begins with, where none is placed.
pub fn warn_of_unplaced(estimator: &dyn AnyEstimator, opened: (&Source, &Clip), frame: usize) {
    if let Some(spec) = unplaced(estimator, opened, frame) {
        remark(&format!("warning: {}; give --set {}=LEFT,TOP,RIGHT,BOTTOM", told_of_unplaced(spec), spec.name));
    }
}

/// Begins with the first pair whose true flow is known, as the window does, unless a frame or a session is named.
fn begin_where_known(args: &TaskArgs, prepared: &mut Prepared) {
    let is_asked =
        args.frame.is_some() || args.frames.is_some() || named(args).is_ok_and(|named| named.session.is_some());
    if !is_asked {
        let is_of_pair = is_of_pair(&*prepared.experiment.estimator);
        prepared.experiment.frame = initial_frame(&prepared.clip, is_of_pair);
    }
}

/// The frame on which a run begins where none is named: the first, or that of the first pair whose true flow is known, with a note.
pub fn initial_frame(clip: &Clip, is_of_pair: bool) -> usize {
    let Some(frame) = is_of_pair.then(|| first_known_pair(clip, || true)).flatten() else { return 0 };
    remark(&format!("note: {} Choose another one with --frame.", told_of_pair(frame)));
    frame
}

/// Says of each of `settings` that has no effect on `estimators` why it has none.
pub fn warn_of_idle(estimators: &[&dyn AnyEstimator], settings: &[String]) {
    for setting in settings {
        if let Some(why) = comparison::why_idle(estimators, setting) {
            remark(&format!("warning: --set {}: {why}", Error::short_name(setting)));
        }
    }
}
