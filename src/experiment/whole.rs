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
        if let Some(summary) = run.summary() {
            return Ok((summary, time));
        }
    }
    let begun = Instant::now();
    estimator.run_counted(clip, frame, threads).map(|summary| (summary, begun.elapsed()))
}

/// A run at its end, done in slices, and the time of all of them.
async fn finished(
    begin: impl FnOnce() -> Result<Box<dyn AnyRun>, Error>,
) -> Result<(Box<dyn AnyRun>, Duration), Error> {
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
fn advance(run: &mut dyn AnyRun, begun: Instant) -> Result<Progress, Error> {
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

    use super::*;
    use crate::experiment::source::Source;
    use crate::media::Open;

    #[test]
    fn a_run_in_slices_has_the_result_and_the_size_of_one_on_threads() {
        let clip = Source::synth("pillar").unwrap().open(&Open::default()).unwrap().clip;
        for estimator in estimators().into_iter().filter(|estimator| estimator.tests_candidates()) {
            let run = estimator.run_counted(&clip, 0, &Threads::all().unwrap()).unwrap();
            let (sliced, _) = work::finish(finished(|| estimator.begin_counted(&clip, 0))).unwrap();
            let sliced = sliced.summary().unwrap();
            assert_eq!(sliced.extent, run.extent, "{}", estimator.info().id);
            assert_eq!(sliced.output.displacements(), run.output.displacements());
            let (plain, _) = work::finish(finished(|| estimator.begin(&clip, 0))).unwrap();
            assert_eq!(plain.output().displacements(), run.output.displacements());
            assert!(plain.summary().is_none(), "nothing was counted");
        }
    }
}
