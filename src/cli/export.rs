//! `motionscope export`: saves a range of steps as pictures or as an animation.

use super::print::remark;
use motionscope_core::base::Error;
use motionscope_core::run::Info;

use super::args::ExportArgs;
use super::outputs::{check_folder, refuse_losses};
use super::paper;
use super::say;
use super::task;
use crate::experiment::Prepared;
use crate::experiment::pixel::Chosen;
use crate::media::Open;
use crate::media::export::{AnimationFormat, Target, Timing, fill_folder, save_result};
use crate::session::lesson::Address;
use crate::view::page::{Stand, Words};
use crate::view::panes::Selection;
use crate::view::steps::{self, Medium, Range, Steps};
use crate::work;

/// Saves the pictures that `args` ask for, each file atomically.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn export(args: &ExportArgs) -> Result<(), Error> {
    refuse_mixed(args)?;
    let Some((from, to)) = args.steps else { return pages(args) };
    if let Some(file) = &args.animation {
        // Before anything runs.
        AnimationFormat::of(file)?;
        check_folder(file)?;
    }
    let panes = Selection::of(&args.sheet.panes);
    let session = task::session(&args.task, &args.picture)?;
    let (look, pixel) = (task::look(&session), task::pixel(session.position, &args.picture));
    if args.turntable > 1 && !panes.is_in_space() && !look.landscape {
        let why = "--turntable turns what is in space; add --landscape, or --panes with surface-3d, pyramid or cloud";
        return Err(Error::new(why));
    }
    let panes = panes.seeing(task::section(&session));
    let prepared = task::prepare(&args.task, session.experiment)?;
    let info = prepared.experiment.info();
    let granularity = args.every.as_deref().map(|name| granularity(info, name)).transpose()?;
    let steps = Steps {
        range: Range { from, to, granularity: granularity.unwrap_or(info.granularities.len() - 1) },
        scale: args.picture.scale,
        look,
        panes,
        pixel,
        must_have_layer: args.picture.look.0.has("layer"),
        freehand: session.freehand,
        turntable: args.turntable,
    };
    let timing = Timing { rate_hz: args.rate, between: args.between };
    let (medium, place) = match (&args.animation, &args.out) {
        (Some(file), _) => (Medium::Animation(file, timing), ("animation", Target::File(file))),
        (None, Some(folder)) => (Medium::Pictures(folder, args.format), ("out", Target::Numbered(folder, steps::STEP))),
        (None, None) => return Err(Error::new("name a folder with --out or a file with --animation")),
    };
    refuse_losses(&prepared.inputs, &[place], args.force)?;
    let to = place.1.path().display();
    // Said before the first is painted, so that a range that is too long can be given up in time.
    let tell = |count: usize| match count {
        1 => remark(&format!("1 picture is saved into {to}")),
        count => remark(&format!("{count} pictures are saved into {to}")),
    };
    let written = work::finish(steps.write(&prepared, medium, None, Some(&tell)))?;
    say(&format!("{} in {to}{}", written.pictures(), written.without()))
}

/// Refuses paper together with pictures: a file is asked for, or a folder.
fn refuse_mixed(args: &ExportArgs) -> Result<(), Error> {
    let worksheet = args.paper.worksheet.is_some();
    if worksheet && args.steps.is_some() {
        return Err(Error::new(
            "a worksheet is of one step; use motionscope run CLIP --step CURSOR --worksheet FILE.pdf",
        ));
    }
    if worksheet && (args.out.is_some() || args.animation.is_some()) {
        return Err(Error::new("--worksheet saves one file; leave out --out and --animation"));
    }
    let answers = args.paper.answers && !worksheet && args.handout.handout.is_none();
    if answers { Err(Error::new("--answers needs --handout FILE.pdf or --worksheet FILE.pdf")) } else { Ok(()) }
}

/// Saves each page of the lesson that `args` name, its words beside its step.
fn pages(args: &ExportArgs) -> Result<(), Error> {
    let named = args.task.clip.as_deref().and_then(Address::parse);
    let why = match args.paper.worksheet {
        Some(_) => "name the page of a lesson, or use motionscope run CLIP --step CURSOR --worksheet FILE.pdf",
        None => "name the steps with --steps A..B, or a lesson as the clip",
    };
    let address = named.ok_or_else(|| Error::new(why))?;
    refuse_unused(args)?;
    let asked = paper::Asked { worksheet: &args.paper, handout: &args.handout, force: args.force };
    if paper::of_lesson(&asked, &address)? {
        return Ok(());
    }
    let folder = args.out.as_deref().ok_or_else(|| Error::new("the pages of a lesson need a folder: add --out DIR"))?;
    let lesson = address.load()?;
    lesson.check()?;
    let count = lesson.pages.len();
    // A page may be named by its number.
    let is_one = args.task.clip.as_ref() == Some(&address.name());
    let wanted = |index: &usize| !is_one || *index == address.page;
    let mut saved = 0;
    for (index, page) in lesson.pages.iter().enumerate().filter(|(index, _)| wanted(index)) {
        let (prose, mut session) = (page.words.as_ref().map_err(Clone::clone)?, page.session.clone()?);
        session.look = session.look.then(&args.picture.look.0);
        let position = session.position;
        let (cursor, look) = (position.cursor.unwrap_or_default(), task::look(&session));
        let prepared = Prepared::open(session.experiment, Open::default())?;
        refuse_losses(&prepared.inputs, &[("out", Target::Numbered(folder, "page-"))], args.force)?;
        let (pixel, freehand) = (position.held.map(Chosen::Held), session.freehand);
        let stand = Stand { prepared: &prepared, cursor, pixel, look, freehand };
        let words = Words { lesson: &lesson.title, title: &page.title, number: [index + 1, count], prose };
        let picture = work::finish(words.encode(&stand, args.format, args.picture.scale))?;
        let file = folder.join(format!("page-{:02}.{}", index + 1, args.format.extension()));
        fill_folder(folder, || save_result(&file, &picture))?;
        saved += 1;
    }
    match saved {
        0 => lesson.page(address.page).map(drop),
        1 => say(&format!("1 page in {}", folder.display())),
        _ => say(&format!("{saved} pages in {}", folder.display())),
    }
}

/// Refuses options that the pages of a lesson do not take: their headers say what is run.
fn refuse_unused(args: &ExportArgs) -> Result<(), Error> {
    let task = &args.task;
    let given = [
        ("--estimator", task.estimator.is_some()),
        ("--frame", task.frame.is_some()),
        ("--beside", !task.beside.is_empty()),
        ("--set", !task.set.is_empty()),
        ("--panes", !args.sheet.panes.is_empty()),
        ("--pixel", args.picture.pixel.is_some()),
        ("--every", args.every.is_some()),
        ("--animation", args.animation.is_some()),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(Error::new(format!(
            "the pages of a lesson say what is run; leave out {option}, or name the steps with --steps"
        ))),
        None => Ok(()),
    }
}

/// Returns the index of the granularity `name`; the run as a whole is none.
fn granularity(info: &Info, name: &str) -> Result<usize, Error> {
    let granularities = &info.granularities[1..];
    let found = granularities.iter().position(|granularity| *granularity == name);
    let message = || Error::new(format!("{} has no granularity {name}; it has {}", info.id, granularities.join(", ")));
    found.map(|index| index + 1).ok_or_else(message)
}
