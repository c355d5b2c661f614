//! Examples of estimators as sessions: `example:horn-schunck/filling-in`.

use std::ffi::OsStr;

use motionscope_core::examples::{self, Example};
use motionscope_core::{Error, estimator};

use super::Session;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Position};
use crate::view::look::Changes;

/// The prefix of an example's name.
const EXAMPLE: &str = "example:";

/// Returns the session of an `example` of the estimator `id`.
///
/// # Errors
/// If the estimator or the scene does not have what the example sets.
pub(super) fn session(id: &str, example: &Example) -> Result<Session, Error> {
    let mut estimator = estimator(id)?;
    example.settings.iter().try_for_each(|(name, value)| estimator.set(name, value))?;
    let source = Source::parse(format!("synth:{}", example.clip))?;
    let experiment = Experiment { frame: example.frame, ..Experiment::new(source, estimator) };
    Ok(Session { experiment, position: Position::default(), look: Changes::default(), sight: None })
}

/// Returns the session of the example with this `name`; `None` where it does not begin as the name of one.
///
/// The error names the examples of the estimator if there is no such example.
pub(super) fn named(name: &OsStr) -> Option<Result<Session, Error>> {
    let name = name.to_str()?.strip_prefix(EXAMPLE)?;
    let (id, wanted) = name.split_once('/').unwrap_or((name, ""));
    let Err(error) = estimator(id) else {
        let found = examples::of(id).find(|example| example.id == wanted);
        return Some(found.ok_or_else(|| unknown(id)).and_then(|example| session(id, example)));
    };
    Some(Err(error))
}

/// The error where an estimator has no such example.
fn unknown(id: &str) -> Error {
    let all: Vec<_> = examples::of(id).map(|example| format!("{EXAMPLE}{id}/{}", example.id)).collect();
    Error::new(match all.as_slice() {
        [] => format!("{id} has no examples"),
        all => format!("the examples of {id} are {}", all.join(", ")),
    })
}
