//! `motionscope export`: saves a range of steps as pictures or as an animation.

use motionscope_core::{Error, Info};

use super::args::ExportArgs;
use super::outputs::{check_folder, refuse_losses};
use super::say;
use super::task;
use crate::media::export::{AnimationFormat, Target, Timing};
use crate::view::panes::Selection;
use crate::view::steps::{self, Medium, Range, Steps};

/// Saves the pictures that `args` ask for, each file atomically.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn export(args: &ExportArgs) -> Result<(), Error> {
    if let Some(file) = &args.animation {
        // Before anything runs.
        AnimationFormat::of(file)?;
        check_folder(file)?;
    }
    let session = task::session(&args.task, &args.picture)?;
    let (look, pixel) = (task::look(&session), task::pixel(session.position, &args.picture));
    let prepared = task::prepare(&args.task, session.experiment)?;
    let info = prepared.experiment.info();
    let granularity = args.every.as_deref().map(|name| granularity(info, name)).transpose()?;
    let (from, to) = args.steps;
    let steps = Steps {
        range: Range { from, to, granularity: granularity.unwrap_or(info.granularities.len() - 1) },
        scale: args.picture.scale,
        look,
        panes: Selection::of(&args.sheet.panes),
        pixel,
        must_have_layer: args.picture.look.0.has("layer"),
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
        1 => eprintln!("1 picture is saved into {to}"),
        count => eprintln!("{count} pictures are saved into {to}"),
    };
    let written = steps.write(&prepared, medium, None, Some(&tell))?;
    say(&format!("{} in {to}{}", written.pictures(), written.without()))
}

/// Returns the index of the granularity `name`; the run as a whole is none.
fn granularity(info: &Info, name: &str) -> Result<usize, Error> {
    let granularities = &info.granularities[1..];
    let found = granularities.iter().position(|granularity| *granularity == name);
    let message = || Error::new(format!("{} has no granularity {name}; it has {}", info.id, granularities.join(", ")));
    found.map(|index| index + 1).ok_or_else(message)
}
