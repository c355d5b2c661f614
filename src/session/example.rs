//! Examples of estimators as sessions: `example:horn-schunck/filling-in`.

use std::ffi::OsStr;

use motionscope_core::base::Error;
use motionscope_core::course::estimator;
use motionscope_core::course::examples::{self, Example};

use super::Session;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Position};
use crate::paint::Freehand;
use crate::view::look::Changes;
use crate::view::rendering::said;

/// The prefix of an example's name.
pub(super) const EXAMPLE: &str = "example:";

/// Returns the name under which an `example` of the estimator `id` is opened.
pub fn name(id: &str, example: &Example) -> String {
    format!("{EXAMPLE}{id}/{}", example.id)
}

/// Returns what an `example` shows: whether the estimator works, why, and which one works instead.
pub fn description(example: &Example) -> String {
    let verdict = match example.cause {
        Some(cause) => format!("Fails: {}.", cause.name()),
        None => "Works.".to_owned(),
    };
    let instead = example.instead.as_ref().and_then(|other| {
        let mut estimator = estimator(other.id).ok()?;
        other.settings.iter().try_for_each(|(name, value)| estimator.set(name, value)).ok()?;
        // Of an estimator that fails the settings that make it fail are told as well: those have their defaults.
        let changed = example.settings.iter().filter(|_| example.of.contains(&other.id));
        let told: Vec<_> = other.settings.iter().chain(changed).map(|(name, _)| *name).collect();
        let all = estimator.specs().iter().zip(estimator.values());
        let set: Vec<_> =
            all.filter(|(spec, _)| told.contains(&&*spec.name)).map(|(spec, (_, value))| said(spec, value)).collect();
        let set = if set.is_empty() { String::new() } else { format!(" with {}", set.join(", ")) };
        Some(format!(" Works here: {}{set}.", estimator.info().name))
    });
    format!("{}. {verdict} {}{}", example.title, example.says, instead.unwrap_or_default())
}

/// Returns the session of an `example` of the estimator `id`.
///
/// # Errors
/// If the estimator or the scene does not have what the example sets.
pub fn session(id: &str, example: &Example) -> Result<Session, Error> {
    let mut estimator = estimator(id)?;
    example.settings.iter().try_for_each(|(name, value)| estimator.set(name, value))?;
    let source = Source::parse(format!("synth:{}", example.clip))?;
    let experiment = Experiment { frame: example.frame, ..Experiment::new(source, estimator) };
    Ok(Session {
        experiment,
        position: Position::default(),
        look: Changes::default(),
        sight: None,
        freehand: Freehand::default(),
    })
}

/// Returns the session of the example with this `name`; `None` where it does not begin as the name of one.
///
/// The error names the examples of the estimator if there is no such example.
pub(super) fn named(name: &OsStr) -> Option<Result<Session, Error>> {
    name.to_str()?.strip_prefix(EXAMPLE).map(find)
}

/// Returns the session of the example `name`, as `horn-schunck/filling-in`.
///
/// # Errors
/// If there is no such estimator, or it has no such example.
pub(super) fn find(name: &str) -> Result<Session, Error> {
    let (id, wanted) = name.split_once('/').unwrap_or((name, ""));
    estimator(id)?;
    let found = examples::of(id).find(|example| example.id == wanted);
    found.ok_or_else(|| unknown(id)).and_then(|example| session(id, example))
}

/// Returns the example of this whole `name`, as `example:horn-schunck/filling-in`; `None` where it names none.
pub fn of_name(name: &OsStr) -> Option<&'static Example> {
    let (id, wanted) = name.to_str()?.strip_prefix(EXAMPLE)?.split_once('/')?;
    examples::of(id).find(|example| example.id == wanted)
}

/// The error where an estimator has no such example.
fn unknown(id: &str) -> Error {
    let all: Vec<_> = examples::of(id).map(|example| name(id, example)).collect();
    Error::new(match all.as_slice() {
        [] => format!("{id} has no examples"),
        all => format!("the examples of {id} are {}", all.join(", ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimator_that_works_with_other_settings_is_named_with_them() {
        let described = |name: &str| description(of_name(OsStr::new(name)).expect("an example"));
        let filter = described("example:kalman-filter/manoeuvre");
        assert!(filter.ends_with(" Works here: Kalman filter with restart on."), "{filter}");
        let tree = described("example:multiple-hypothesis/manoeuvre");
        assert!(tree.ends_with("with motion Coordinated turn."), "{tree}");
        let another = described("example:joint-probabilistic/coalescence");
        assert!(another.contains("added noise 3 px"), "{another}");
    }
}
