//! A comparison at work on a thread of its own: rows come one by one.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use motionscope_core::{Clip, Error, Stop, Threads};

use crate::comparison::{Arena, Contender, Row};
use crate::media::Open;
use crate::source::Source;

/// What is compared, and where.
pub struct Plan {
    /// The clip that is open.
    pub clip: Clip,
    /// Where it comes from.
    pub source: Source,
    /// Frame t.
    pub frame: usize,
    /// Each clip with what runs on it.
    pub rounds: Vec<(Source, Vec<Contender>)>,
}

/// A comparison at work, or done.
pub struct Comparing {
    shared: Arc<Shared>,
    stop: Stop,
    /// Rows that there will be.
    pub total: usize,
}

/// How far it has come.
#[derive(Default)]
struct Progress {
    rows: Vec<Arc<Row>>,
    failure: Option<Error>,
}

struct Shared {
    progress: Mutex<Progress>,
    changed: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Comparing {
    /// Begins; `changed` is called from another thread whenever there is a row more.
    pub fn new(plan: Plan, changed: impl Fn() + Send + Sync + 'static) -> Self {
        let shared = Arc::new(Shared { progress: Mutex::default(), changed: Box::new(changed) });
        let total = plan.rounds.iter().map(|(_, contenders)| contenders.len()).sum();
        let stop = Stop::default();
        let (worker, stopped) = (Arc::clone(&shared), stop.clone());
        let work = move || {
            if let Err(error) = compare(&plan, &worker, &stopped) {
                worker.progress().failure = Some(error);
            }
            (worker.changed)();
        };
        if let Err(error) = std::thread::Builder::new().name("comparison".into()).spawn(work) {
            shared.progress().failure = Some(Error::new(format!("no thread could be started to compare: {error}")));
        }
        Self { shared, stop, total }
    }

    /// The rows so far.
    pub fn rows(&self) -> Vec<Arc<Row>> {
        self.shared.progress().rows.clone()
    }

    /// Why it ended early, if it did.
    pub fn failure(&self) -> Option<Error> {
        self.shared.progress().failure.clone()
    }

    /// Whether there is more to come.
    pub fn is_busy(&self) -> bool {
        let progress = self.shared.progress();
        progress.failure.is_none() && progress.rows.len() < self.total
    }
}

impl Drop for Comparing {
    fn drop(&mut self) {
        self.stop.set(true);
    }
}

fn compare(plan: &Plan, shared: &Shared, stop: &Stop) -> Result<(), Error> {
    // Times are told for one thread, as the command line does unless told otherwise.
    let threads = Threads::single();
    for (source, contenders) in &plan.rounds {
        let clip = if *source == plan.source { plan.clip.clone() } else { source.open(&Open::default())? };
        let clip = clip.until(stop.clone());
        for contender in contenders {
            stop.check()?;
            let row = Row::of(contender, &Arena { clip: &clip, frame: plan.frame, threads: &threads, repeat: 3 })?;
            shared.progress().rows.push(Arc::new(row));
            (shared.changed)();
        }
    }
    Ok(())
}
