//! `motionscope export`: saves pictures of a range of steps.

use motionscope_core::{Error, Info};

use super::args::ExportArgs;
use super::outputs::refuse_losses;
use super::say;
use super::task;
use crate::media::export::Target;
use crate::view::panes::Selection;
use crate::view::steps::{self, Steps};

/// Saves the pictures that `args` ask for, each file atomically.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn export(args: &ExportArgs) -> Result<(), Error> {
    let session = task::session(&args.task, &args.picture)?;
    let (look, pixel) = (task::look(&session), task::pixel(session.position, &args.picture));
    let prepared = task::prepare(&args.task, session.experiment)?;
    let info = prepared.experiment.info();
    let granularity = args.every.as_deref().map(|name| granularity(info, name)).transpose()?;
    let steps = Steps {
        from: args.steps.0,
        to: args.steps.1,
        granularity: granularity.unwrap_or(info.granularities.len() - 1),
        format: args.format,
        scale: args.picture.scale,
        look,
        panes: Selection::of(&args.sheet.panes),
        pixel,
        must_have_layer: args.picture.look.0.has("layer"),
    };
    let out = [("out", Target::Numbered(&args.out, steps::STEP))];
    refuse_losses(&prepared.inputs, &out, args.force)?;
    // Told before the first is written, so that a range that is too long can be given up in time.
    let tell = |count: usize| match count {
        1 => eprintln!("1 picture is saved into {}", args.out.display()),
        count => eprintln!("{count} pictures are saved into {}", args.out.display()),
    };
    let written = steps.write_counted(&prepared, &args.out, None, Some(&tell))?;
    say(&format!("{} in {}{}", written.pictures(), args.out.display(), written.without()))
}

/// Returns the index of the granularity `name`; the run as a whole is none.
fn granularity(info: &Info, name: &str) -> Result<usize, Error> {
    let granularities = &info.granularities[1..];
    let found = granularities.iter().position(|granularity| *granularity == name);
    let message = || Error::new(format!("{} has no granularity {name}; it has {}", info.id, granularities.join(", ")));
    found.map(|index| index + 1).ok_or_else(message)
}
