//! A comparison on a thread of its own, which delivers rows one by one.

use std::sync::{Arc, Mutex, PoisonError};

use motionscope_core::{Error, Stop, Threads};

use super::background::Background;
use crate::experiment::Prepared;
use crate::experiment::comparison::{Conditions, Repeats, Round, Row};
use crate::media::{Open, Progress};

/// The plan of a comparison.
pub struct Plan {
    /// The open clip with its files, and frame t.
    pub prepared: Prepared,
    /// The clips with the estimators that run on them.
    pub rounds: Vec<Round>,
}

/// A running or finished comparison.
pub struct Comparing {
    rows: Arc<Mutex<Vec<Arc<Row>>>>,
    work: Background<()>,
    /// The estimators of all rows when finished.
    pub names: Vec<&'static str>,
}

impl Comparing {
    /// Starts the comparison; `changed` is called from another thread after each row.
    pub fn new(plan: Plan, changed: impl Fn() + Send + Sync + 'static) -> Self {
        let all = plan.rounds.iter().flat_map(|round| &round.compared_estimators);
        let names: Vec<_> = all.map(|compared| compared.estimator.info().name).collect();
        let total = names.len();
        let rows = Arc::<Mutex<Vec<_>>>::default();
        let done = Arc::clone(&rows);
        let work = Background::new("compare", changed, move |control| {
            let add = |row| {
                let mut rows = done.lock().unwrap_or_else(PoisonError::into_inner);
                rows.push(Arc::new(row));
                control.report(rows.len() as f32 / total as f32);
            };
            compare(&plan, add, &control.stop)
        });
        Self { rows, work, names }
    }

    /// Returns the rows so far.
    pub fn rows(&self) -> Vec<Arc<Row>> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the error that ended it early, if any.
    pub fn failure(&self) -> Option<Error> {
        self.work.look(|outcome| outcome.and_then(|outcome| outcome.as_ref().err().cloned()))
    }

    /// Whether it is running.
    pub fn is_busy(&self) -> bool {
        self.work.look(|outcome| outcome.is_none())
    }
}

fn compare(plan: &Plan, add: impl Fn(Row), stop: &Stop) -> Result<(), Error> {
    // Times are told for one thread, as the command line does unless told otherwise.
    let threads = Threads::single();
    let Prepared { experiment, clip: open, .. } = &plan.prepared;
    for Round { source, compared_estimators } in &plan.rounds {
        let clip = match *source == experiment.source {
            true => open.clone(),
            false => source.open(&Open::from(experiment.given.clone()))?,
        };
        let clip = clip.until(stop.clone());
        for compared in compared_estimators {
            stop.check()?;
            let (frame, repeats) = (experiment.frame, Repeats::AsUsual);
            add(Row::of(compared, &Conditions { clip: &clip, frame, threads: &threads, repeats })?);
        }
    }
    Ok(())
}
