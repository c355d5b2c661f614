//! A whole run as a task: on threads on a desktop, between the frames of a page.

use motionscope_core::base::{Error, Threads};
use motionscope_core::data::Clip;
use motionscope_core::products::Output;
use motionscope_core::run::{AnyEstimator, AnyRun, Progress, RunSummary};
use web_time::{Duration, Instant};

use crate::work;

/// The products of a whole run, and the time that it took without pauses.
///
/// # Errors
/// As [`AnyEstimator::run`].
pub async fn output(
    estimator: &dyn AnyEstimator,
    (clip, frame): (&Clip, usize),
    threads: &Threads,
) -> Result<(Output, Duration), Error> {
    if work::IS_SLICED {
        let (run, time) = finished(|| estimator.begin(clip, frame)).await?;
        return Ok((run.output(), time));
    }
    let begun = Instant::now();
    estimator.run(clip, frame, threads).map(|output| (output, begun.elapsed()))
}

/// The products and the size of a whole run, and the time that it took without pauses.
///
/// # Errors
/// As [`AnyEstimator::run_counted`].
pub async fn summary(
    estimator: &dyn AnyEstimator,
    (clip, frame): (&Clip, usize),
    threads: &Threads,
) -> Result<(RunSummary, Duration), Error> {
    if work::IS_SLICED {
        let (run, time) = finished(|| estimator.begin_counted(clip, frame)).await?;
        return Ok((run.summary(), time));
    }
    let begun = Instant::now();
    estimator.run_counted(clip, frame, threads).map(|summary| (summary, begun.elapsed()))
}

/// A run at its end, done in slices, and the time of all of them.
async fn finished<R: AnyRun + ?Sized>(
    begin: impl FnOnce() -> Result<Box<R>, Error>,
) -> Result<(Box<R>, Duration), Error> {
    work::breathe().await;
    let begun = Instant::now();
    let mut run = begin()?;
    let mut time = begun.elapsed();
    loop {
        work::breathe().await;
        let begun = Instant::now();
        let progress = advance(&mut *run, begun)?;
        time += begun.elapsed();
        if progress == Progress::Done {
            return Ok((run, time));
        }
    }
}

/// Does the units of a slice that has `begun`.
fn advance(run: &mut (impl AnyRun + ?Sized), begun: Instant) -> Result<Progress, Error> {
    loop {
        let progress = run.advance()?;
        if progress == Progress::Done || begun.elapsed() >= work::SLICE {
            return Ok(progress);
        }
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::course::estimators;
    use motionscope_core::data::Clip;
    use motionscope_core::synth;

    use super::*;

    fn small_pillar() -> Clip {
        let scene = synth::scene("pillar").unwrap();
        let mut difficulty = scene.difficulty();
        (difficulty.width, difficulty.height) = (128, 96);
        scene.clip(&difficulty).unwrap()
    }

    #[test]
    fn a_run_in_slices_has_the_result_and_the_counts_of_one_on_threads() {
        let mut ran = 0;
        let clip = small_pillar();
        for estimator in estimators() {
            let id = estimator.info().id;
            // Few cannot run on any clip: one wants two views, others a region or a model.
            let Ok(run) = estimator.run_counted(&clip, 0, &Threads::all().unwrap()) else { continue };
            let (sliced, _) = work::finish(finished(|| estimator.begin_counted(&clip, 0))).unwrap();
            let sliced = sliced.summary();
            // A state that can be stepped may keep more than one that is run at once.
            let [counted, wanted] = [&sliced, &run].map(|ran| (ran.extent.units, ran.extent.events));
            assert_eq!(counted, wanted, "{id}");
            let [bytes, least] = [&sliced, &run].map(|ran| ran.extent.memory_bytes);
            assert!(if estimator.tests_candidates() { bytes == least } else { bytes >= least }, "{id}: {bytes}");
            let (plain, _) = work::finish(finished(|| estimator.begin(&clip, 0))).unwrap();
            assert!(sliced.output == run.output && plain.output() == run.output, "{id}");
            ran += 1;
        }
        assert!(ran >= 60, "{ran} ran");
    }
}
