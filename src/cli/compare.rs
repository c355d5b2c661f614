//! `motionscope compare`: several estimators on one pair of frames, in one table.

use motionscope_core::{AnyEstimator, Error, Threads};

use super::args::CompareArgs;
use super::say;
use super::task::Named;
use crate::comparison::{self, Arena, Contender, Row};
use crate::media::{Open, export};
use crate::source::Source;

/// Compares what `args` name.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn compare(args: &CompareArgs) -> Result<(), Error> {
    let Named { source, truth, session } = Named::find(&args.clip, args.truth.clone())?;
    let frame = args.frame.or(session.map(|session| session.frame)).unwrap_or(0);
    let estimators = comparison::contenders(&args.estimators, &args.set)?;
    let threads = Threads::new(args.threads as usize)?;
    let mut rows = Vec::new();
    for (source, contenders) in rounds(&source, &estimators, args.sweep.as_deref())? {
        let clip = source.open(&Open { truth: truth.clone(), ..Open::default() })?;
        let arena = Arena { clip: &clip, frame, threads: &threads, repeat: args.repeat };
        for contender in &contenders {
            rows.push(Row::of(contender, &arena)?);
        }
    }
    if let Some(path) = &args.csv {
        export::save(path, comparison::csv(&rows).as_bytes())?;
    }
    match (args.json, args.markdown, &args.csv) {
        (true, ..) => say(&comparison::json(&rows).to_string()),
        (_, true, _) => say(&comparison::markdown(&rows)),
        (_, _, Some(path)) if path.as_os_str() == "-" => Ok(()),
        _ => say(&comparison::text(&rows)),
    }
}

/// Each clip with what runs on it: one round, or one for each value that is swept.
fn rounds(
    source: &Source,
    estimators: &[Box<dyn AnyEstimator>],
    sweep: Option<&str>,
) -> Result<Vec<(Source, Vec<Contender>)>, Error> {
    let copies = || estimators.iter().map(|estimator| estimator.boxed_clone()).collect::<Vec<_>>();
    let round = |source: Source, estimators: Vec<Box<dyn AnyEstimator>>, swept: Option<(String, String)>| {
        let contender = |estimator| Contender { estimator, swept: swept.clone() };
        (source, estimators.into_iter().map(contender).collect())
    };
    let Some(sweep) = sweep else { return Ok(vec![round(source.clone(), copies(), None)]) };
    let (name, values) = sweep
        .split_once('=')
        .ok_or_else(|| Error::new(format!("a sweep is written NAME=V1,V2,.. as in range=4,8,16, not {sweep}")))?;
    let is_parameter = estimators.iter().any(|estimator| estimator.get(name).is_ok());
    let one = |value: &str| {
        let (mut source, mut estimators) = (source.clone(), copies());
        if is_parameter {
            comparison::set_all(&mut estimators, name, value)?;
        } else {
            source.set(&format!("{name}={value}"))?;
        }
        Ok(round(source, estimators, Some((name.to_owned(), value.to_owned()))))
    };
    values.split(',').map(|value| one(value.trim())).collect()
}
