//! `motionscope export`: pictures of a range of steps.

use motionscope_core::{Error, Info};

use super::args::ExportArgs;
use super::say;
use super::task::Task;
use crate::shot::{Format, Steps};

/// Writes what `args` ask for; each file whole or not at all.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn export(args: &ExportArgs) -> Result<(), Error> {
    let task = Task::open(&args.task)?;
    let info = task.company.info(&*task.estimator);
    let rung = args.every.as_deref().map(|name| rung(info, name)).transpose()?;
    let steps = Steps {
        from: args.steps.0,
        to: args.steps.1,
        rung: rung.unwrap_or(info.rungs.len() - 1),
        format: if args.format == "svg" { Format::Svg } else { Format::Png },
        scale: args.look.scale,
        look: task.look(&args.look)?,
        pixel: task.pixel(&args.look),
    };
    let written = steps.write((&*task.estimator, &task.company), &task.clip, task.frame, &args.out, None)?;
    let pictures = if written == 1 { "picture" } else { "pictures" };
    say(&format!("{written} {pictures} in {}", args.out.display()))
}

/// The rung called `name`; the run as a whole has but one stop.
fn rung(info: &Info, name: &str) -> Result<usize, Error> {
    let rungs = &info.rungs[1..];
    let found = rungs.iter().position(|rung| *rung == name);
    let told = || Error::new(format!("{} has no rung {name}; its steps are {}", info.id, rungs.join(", ")));
    found.map(|index| index + 1).ok_or_else(told)
}
