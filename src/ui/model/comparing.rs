//! A comparison at work on a thread of its own: rows come one by one.

use std::sync::{Arc, Mutex, PoisonError};

use motionscope_core::{Error, Stop, Threads};

use super::background::Background;
use crate::experiment::Prepared;
use crate::experiment::comparison::{Arena, Round, Row};
use crate::media::{Open, Progress};

/// What is compared, and where.
pub struct Plan {
    /// The clip that is open, what is given for it, and frame t.
    pub prepared: Prepared,
    /// Each clip with what runs on it.
    pub rounds: Vec<Round>,
}

/// A comparison at work, or done.
pub struct Comparing {
    rows: Arc<Mutex<Vec<Arc<Row>>>>,
    work: Background<()>,
    /// Rows that there will be.
    pub total: usize,
}

impl Comparing {
    /// Begins; `changed` is called from another thread whenever there is a row more.
    pub fn new(plan: Plan, changed: impl Fn() + Send + Sync + 'static) -> Self {
        let total = plan.rounds.iter().map(|round| round.contenders.len()).sum();
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
        Self { rows, work, total }
    }

    /// The rows so far.
    pub fn rows(&self) -> Vec<Arc<Row>> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Why it ended early, if it did.
    pub fn failure(&self) -> Option<Error> {
        self.work.look(|outcome| outcome.and_then(|outcome| outcome.as_ref().err().cloned()))
    }

    /// Whether there is more to come.
    pub fn is_busy(&self) -> bool {
        self.work.look(|outcome| outcome.is_none())
    }
}

fn compare(plan: &Plan, add: impl Fn(Row), stop: &Stop) -> Result<(), Error> {
    // Times are told for one thread, as the command line does unless told otherwise.
    let threads = Threads::single();
    let Prepared { experiment, clip: open, .. } = &plan.prepared;
    for Round { source, contenders } in &plan.rounds {
        let clip = match *source == experiment.source {
            true => open.clone(),
            false => source.open(&Open::from(experiment.given.clone()))?,
        };
        let clip = clip.until(stop.clone());
        for contender in contenders {
            stop.check()?;
            add(Row::of(contender, &Arena { clip: &clip, frame: experiment.frame, threads: &threads, repeat: 3 })?);
        }
    }
    Ok(())
}
