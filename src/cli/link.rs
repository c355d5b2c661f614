//! `motionscope run --link`: the link of a step.

use motionscope_core::base::Error;
use motionscope_core::run::Cursor;

use super::args::RunArgs;
use super::task;
use crate::experiment::Position;
use crate::experiment::pixel::{Chosen, Held};
use crate::session::Session;
use crate::session::lesson::Address;
use crate::session::link::{self, Link};

/// Returns the link of the step that `args` name, which leads to `base` or to the published page.
///
/// # Errors
/// If a clip, a parameter or a frame does not exist, or the clip has no name.
pub fn link(args: &RunArgs, session: Session, base: Option<&str>) -> Result<String, Error> {
    if args.paper.worksheet.is_some() || !args.results.0.is_empty() {
        return Err(Error::new("--link computes nothing; save results without it"));
    }
    let held = task::pixel(session.position, &args.picture).map(|chosen| match chosen {
        Chosen::Asked(pixel) => Held { pixel, object: None },
        Chosen::Held(held) => held,
    });
    let cursor = args.step.or(session.position.cursor).unwrap_or(Cursor::END);
    let position = Position { cursor: Some(cursor), held };
    let clip = args.task.clip.as_deref().unwrap_or_default();
    let of_link = || Link::is_one(clip).then(|| Link::parse(&clip.to_string_lossy()).0.page).flatten();
    let page = Address::parse(clip).or_else(of_link);
    let experiment = task::prepare(&args.task, session.experiment)?.experiment;
    let fragment = Link::of(&Session { experiment, position, ..session }, page.as_ref())?;
    Ok(format!("{}#{fragment}", base.unwrap_or(link::PUBLISHED)))
}
