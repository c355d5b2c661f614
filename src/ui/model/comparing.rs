//! A comparison as a task, which delivers rows one by one, and then a picture of each result.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use eframe::egui::{Context, TextureHandle, TextureOptions};
use motionscope_core::base::{Error, Stop, Threads};
use motionscope_core::data::Clip;
use motionscope_core::geometry::Grid;

use super::background::Background;
use super::color_image;
use crate::experiment::comparison::{Conditions, Repeats, Round, Row};
use crate::experiment::{Experiment, Prepared};
use crate::media::{Open, Progress};
use crate::view::look::Look;
use crate::view::still;

/// The plan of a comparison.
pub struct Plan {
    /// The open clip with its files, and frame t.
    pub prepared: Prepared,
    /// The clips with the estimators that run on them.
    pub rounds: Vec<Round>,
    /// How pictures look.
    pub look: Look,
}

/// The picture of a result, or why there is none.
pub type Picture = Result<TextureHandle, Error>;

/// What is there so far.
#[derive(Default)]
struct Made {
    rows: Vec<Arc<Row>>,
    /// The pictures of the first rows.
    pictures: Vec<Picture>,
}

/// A running or finished comparison.
pub struct Comparing {
    made: Arc<Mutex<Made>>,
    work: Background<()>,
    /// The estimators of all rows when finished.
    pub names: Vec<&'static str>,
}

impl Comparing {
    /// Starts the comparison; `ctx` is drawn anew after each row and picture.
    pub fn new(plan: Plan, ctx: Context) -> Self {
        let all = plan.rounds.iter().flat_map(|round| &round.compared_estimators);
        let names: Vec<_> = all.map(|compared| compared.estimator.info().name).collect();
        let total = names.len();
        let made = Arc::<Mutex<Made>>::default();
        let done = Arc::clone(&made);
        let changed = {
            let ctx = ctx.clone();
            move || ctx.request_repaint()
        };
        let work = Background::new("compare", changed, async move |control| {
            let add = |row| {
                let mut made = lock(&done);
                made.rows.push(Arc::new(row));
                control.report(made.rows.len() as f32 / total as f32);
            };
            compare(&plan, add, &control.stop).await?;
            let show = |picture: Result<Grid<[u8; 3]>, Error>| {
                let picture =
                    picture.map(|pixels| ctx.load_texture("result", color_image(&pixels), TextureOptions::LINEAR));
                lock(&done).pictures.push(picture);
                ctx.request_repaint();
            };
            pictures(&plan, show, &control.stop).await
        });
        Self { made, work, names }
    }

    /// Returns the rows so far.
    pub fn rows(&self) -> Vec<Arc<Row>> {
        lock(&self.made).rows.clone()
    }

    /// Whether all rows are there.
    pub fn has_all_rows(&self) -> bool {
        lock(&self.made).rows.len() == self.names.len()
    }

    /// Returns the pictures of the first rows, as far as they are made; a sweep has none.
    pub fn pictures(&self) -> Vec<Picture> {
        lock(&self.made).pictures.clone()
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

fn lock(made: &Mutex<Made>) -> MutexGuard<'_, Made> {
    made.lock().unwrap_or_else(PoisonError::into_inner)
}

async fn compare(plan: &Plan, add: impl Fn(Row), stop: &Stop) -> Result<(), Error> {
    // Times are told for one thread, as the command line does unless told otherwise.
    let threads = Threads::single();
    for round in &plan.rounds {
        let clip = clip(plan, round, stop)?;
        for compared in &round.compared_estimators {
            stop.check()?;
            let (frame, repeats) = (plan.prepared.experiment.frame, Repeats::AsUsual);
            add(Row::of(compared, &Conditions { clip: &clip, frame, threads: &threads, repeats }).await?);
        }
    }
    Ok(())
}

/// The clip of a round, which is read until `stop`.
fn clip(plan: &Plan, round: &Round, stop: &Stop) -> Result<Clip, Error> {
    let Prepared { experiment, clip: open, .. } = &plan.prepared;
    let clip = match round.source == experiment.source {
        true => open.clone(),
        false => round.source.open(&Open::from(experiment.given.clone()))?.clip,
    };
    Ok(clip.until(stop.clone()))
}

/// Makes the pictures of a comparison without a sweep.
async fn pictures(plan: &Plan, show: impl Fn(Result<Grid<[u8; 3]>, Error>), stop: &Stop) -> Result<(), Error> {
    let [round] = &plan.rounds[..] else { return Ok(()) };
    let clip = clip(plan, round, stop)?;
    for compared in round.compared_estimators.iter().filter(|compared| compared.swept.is_none()) {
        stop.check()?;
        let (estimator, given) = (compared.estimator.boxed_clone(), plan.prepared.experiment.given.clone());
        let alone = Experiment {
            given,
            frame: plan.prepared.experiment.frame,
            ..Experiment::new(round.source.clone(), estimator)
        };
        show(still::of_result(&alone, &clip, &plan.look, stop).await);
    }
    Ok(())
}
