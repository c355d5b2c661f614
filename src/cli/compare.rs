//! `motionscope compare`: several estimators on one pair of frames, in one table.

use motionscope_core::{Error, Stop, Threads};

use super::args::CompareArgs;
use super::say;
use crate::claims;
use crate::comparison::{self, Arena, Row};
use crate::media::{Open, export};
use crate::session::Named;
use crate::source::Source;

/// Compares what `args` name.
///
/// # Errors
/// One sentence if anything named does not exist, cannot run or cannot be written.
pub fn compare(args: &CompareArgs) -> Result<(), Error> {
    let Named { source, truth, session } = Named::find(&args.clip, args.truth.clone())?;
    let frame = args.frame.or(session.map(|session| session.frame)).unwrap_or(0);
    if args.course {
        return course(args, &source, frame);
    }
    let estimators = comparison::contenders(&args.estimators, &args.set)?;
    let threads = Threads::new(args.threads as usize)?;
    let mut rows = Vec::new();
    for (source, contenders) in comparison::rounds(&source, &estimators, args.sweep.as_deref())? {
        let clip = source.open(&Open { truth: truth.clone(), ..Open::default() })?;
        let arena = Arena { clip: &clip, frame, threads: &threads, repeat: args.repeat };
        for contender in &contenders {
            let row = Row::of(contender, &arena)?;
            match &row.assessment.truth_error {
                Some(error) if args.truth.is_some() => return Err(error.clone()),
                Some(error) => eprintln!("warning: {error}"),
                None => {}
            }
            rows.push(row);
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

/// The course's table, measured.
fn course(args: &CompareArgs, source: &Source, frame: usize) -> Result<(), Error> {
    let clip = source.open(&Open::default())?;
    let threads = Threads::new(args.threads as usize)?;
    let claims =
        claims::claims(&Arena { clip: &clip, frame, threads: &threads, repeat: args.repeat }, &Stop::default())?;
    match (args.json, args.markdown) {
        (true, _) => say(&claims::json(&claims).to_string()),
        (_, true) => say(&claims::markdown(&claims)),
        _ => say(&claims::text(&claims)),
    }
}
