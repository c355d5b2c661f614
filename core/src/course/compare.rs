//! The figures of a comparison of estimators on one pair of frames: memory, candidates, missed minima and robustness.

use std::sync::Arc;

use super::estimator;
use crate::base::Error;
use crate::data::{Clip, Frame};
use crate::geometry::Gray;
use crate::params::{Spec, Value};
use crate::products::{Output, Tested};
use crate::run::{AnyEstimator, RunSummary};
use crate::synth::disturb;

/// Standard deviation of the noise in the robustness test, in gray levels.
pub const NOISE_SIGMA: f64 = 10.0;
/// The change of illumination of frame t + 1 in the robustness test: gain, and offset in gray levels.
pub const LIGHT: (f64, f64) = (1.1, 8.0);

/// A change of the frames in the robustness test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// Gaussian noise of [`NOISE_SIGMA`] in both frames.
    Noise,
    /// The change of illumination [`LIGHT`] of frame t + 1.
    Light,
}

/// Returns frames `frame` and `frame + 1` of `clip` under a disturbance, as a clip of two gray frames.
///
/// # Errors
/// If a frame cannot be read.
pub fn disturbed(clip: &Clip, frame: usize, disturbance: Disturbance) -> Result<Clip, Error> {
    let [current, next] = clip.pair_or_last(frame)?;
    let noisy = |frame: &Frame, seed| Frame::gray(disturb::noise(frame.luma(), NOISE_SIGMA, seed));
    let pair = match disturbance {
        Disturbance::Noise => [noisy(&current, 1), noisy(&next, 2)],
        Disturbance::Light => [Frame::gray(current.luma().clone()), Frame::gray(disturb::light(next.luma(), LIGHT))],
    };
    Clip::from_frames("disturbed", pair.into())
}

/// The figures that only a comparison has; the assessment of the result is part of a single run.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Memory of the run without the two frames, in bytes.
    pub memory_bytes: usize,
    /// Share of the displacements that change by at most 1 px under noise of [`NOISE_SIGMA`] in both frames. `None` for features,
    /// because noise changes which are detected.
    pub kept_in_noise: Option<f64>,
    /// The same share under the change of illumination [`LIGHT`].
    pub kept_in_light: Option<f64>,
    /// Number of units of the run: blocks of all levels, rows, or iterations.
    pub units: usize,
    /// The figures of a block search; `None` for other estimators.
    pub blocks: Option<BlockFigures>,
}

/// The figures of a block search.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockFigures {
    /// Mean number of candidates per block.
    pub candidates_mean: f64,
    /// Largest number of candidates of a block.
    pub candidates_most: u32,
    /// Blocks for which full search with the same parameters finds a lower cost. `None` for rate–distortion costs, which depend on
    /// the vectors of the neighbors and cannot be compared.
    pub missed: Option<Vec<usize>>,
    /// Number of blocks.
    pub count: usize,
}

/// Runs an estimator on a pair of frames to its end: at once, or between other work.
pub trait Run: AsyncFn(&dyn AnyEstimator, &Clip, usize) -> Result<Output, Error> {}

impl<F: AsyncFn(&dyn AnyEstimator, &Clip, usize) -> Result<Output, Error>> Run for F {}

impl Figures {
    /// Computes the figures of `estimator`, whose run on frames `frame` and `frame + 1` of `clip` is `ran`; all other runs that they
    /// need are done by `run`.
    ///
    /// # Errors
    /// If the estimator cannot run there, or a frame cannot be read.
    pub async fn of(
        estimator: &dyn AnyEstimator,
        RunSummary { output, extent, .. }: &RunSummary,
        (clip, frame): (&Clip, usize),
        run: &impl Run,
    ) -> Result<Self, Error> {
        let has_displacements = output.displacements().is_some();
        let kept = async |disturbance| -> Result<Option<f64>, Error> {
            if !has_displacements {
                return Ok(None);
            }
            let disturbed = disturbed(clip, frame, disturbance)?;
            Ok(kept(output, &run(estimator, &disturbed, 0).await?, [0.0; 2]))
        };
        let blocks = match output.tested() {
            Some(tested) => Some(BlockFigures::of(estimator, &tested, (clip, frame), run).await?),
            None => None,
        };
        Ok(Self {
            memory_bytes: extent.memory_bytes,
            kept_in_noise: kept(Disturbance::Noise).await?,
            kept_in_light: kept(Disturbance::Light).await?,
            units: extent.units,
            blocks,
        })
    }

    /// Returns the first unit that missed a global minimum. The blocks of level 0 are the last units of a run.
    pub fn first_missed_unit(&self) -> Option<usize> {
        let blocks = self.blocks.as_ref()?;
        blocks.missed.as_ref()?.first().map(|block| self.units - blocks.count + block)
    }
}

impl BlockFigures {
    async fn of(
        estimator: &dyn AnyEstimator,
        tested: &[Option<Tested>],
        (clip, frame): (&Clip, usize),
        run: &impl Run,
    ) -> Result<Self, Error> {
        let missed = if has_price(estimator) {
            None
        } else {
            let best = run(&*full_search_like(estimator)?, clip, frame).await?;
            best.tested().map(|best| missed(tested, &best))
        };
        Ok(Self {
            candidates_mean: candidates_mean(tested),
            candidates_most: tested.iter().flatten().map(|part| part.candidates).max().unwrap_or(0),
            missed,
            count: tested.len(),
        })
    }

    /// Returns the share of the blocks whose global minimum was missed.
    pub fn missed_share(&self) -> Option<f64> {
        self.missed.as_ref().map(|missed| missed.len() as f64 / self.count.max(1) as f64)
    }
}

/// Returns the share of the blocks that `estimator` finds within 1 px under an additional camera pan of `pan_px` between frames
/// `frame` and `frame + 1` of `clip`, and the mean number of candidates per block. The reference is full search within ±16 px
/// without the pan. The runs are done by `run`.
///
/// # Errors
/// If the picture is not wider than the pan, or the estimator cannot run there.
pub async fn kept_in_pan(
    estimator: &dyn AnyEstimator,
    (clip, frame): (&Clip, usize),
    pan_px: usize,
    run: &impl Run,
) -> Result<(f64, f64), Error> {
    let [current, next] = clip.pair(frame)?;
    if current.size() != next.size() || current.size().0 <= pan_px {
        return Err(Error::new(format!(
            "the picture is not wider than the camera pan of {pan_px} px; choose a larger clip"
        )));
    }
    let clip_of = |pair: [&Gray; 2]| Clip::from_frames("pan", pair.map(|picture| Frame::gray(picture.clone())).into());
    let cut = |frame: &Arc<Frame>, left| disturb::cut(frame.luma(), left, current.size().0 - pan_px);
    let (here, still, panned) = (cut(&current, pan_px), cut(&next, pan_px), cut(&next, 0));
    let mut full = full_search_like(estimator)?;
    full.set("search-range", "16")?;
    let still = run(&*full, &clip_of([&here, &still])?, 0).await?;
    let moved = run(estimator, &clip_of([&here, &panned])?, 0).await?;
    let candidates = moved.tested().map_or(0.0, |tested| candidates_mean(&tested));
    let kept = kept(&still, &moved, [pan_px as f32, 0.0]).ok_or_else(|| {
        Error::new(format!(
            "{} tracks features, which have no displacements of blocks or pixels to compare",
            estimator.info().id
        ))
    })?;
    Ok((kept, candidates))
}

/// Returns `estimator` with the values of `other` for all parameters that both have and that allow them.
#[must_use]
pub fn alike(other: &dyn AnyEstimator, mut estimator: Box<dyn AnyEstimator>) -> Box<dyn AnyEstimator> {
    for (index, (name, _)) in estimator.values().into_iter().enumerate() {
        if let Ok(value) = other.get(name) {
            // A value that is not allowed here is skipped.
            estimator.set_value(index, value).ok();
        }
    }
    estimator
}

/// Returns `estimator` with the changed parameters of `other`, if both are of one family and declare the parameter alike.
/// Defaults of `other` are not taken over: `estimator` has its own.
pub fn changed_alike(other: &dyn AnyEstimator, mut estimator: Box<dyn AnyEstimator>) -> Box<dyn AnyEstimator> {
    if other.info().family != estimator.info().family {
        return estimator;
    }
    for (spec, (_, value)) in other.specs().iter().zip(other.values()) {
        let same = |own: &Spec| (&own.name, own.unit, &own.kind) == (&spec.name, spec.unit, &spec.kind);
        if let Some(index) = estimator.specs().iter().position(same).filter(|_| value != spec.default) {
            // It is in range, since the range is the same.
            estimator.set_value(index, value).ok();
        }
    }
    estimator
}

/// Whether the cost includes the rate of the motion vector.
fn has_price(estimator: &dyn AnyEstimator) -> bool {
    matches!(estimator.get("lambda"), Ok(Value::Real(lambda)) if lambda > 0.0)
}

fn full_search_like(other: &dyn AnyEstimator) -> Result<Box<dyn AnyEstimator>, Error> {
    Ok(alike(other, estimator("full-search")?))
}

/// Returns the mean number of candidates per part.
fn candidates_mean(tested: &[Option<Tested>]) -> f64 {
    let all: u64 = tested.iter().flatten().map(|part| u64::from(part.candidates)).sum();
    all as f64 / tested.len() as f64
}

/// Returns the parts whose cost in `found` is higher than in `best`.
fn missed(found: &[Option<Tested>], best: &[Option<Tested>]) -> Vec<usize> {
    let pairs = found.iter().zip(best).enumerate();
    let is_worse = |found: &Option<Tested>, best: &Option<Tested>| matches!((found, best), (Some(found), Some(best)) if found.cost > best.cost);
    pairs.filter(|(_, (found, best))| is_worse(found, best)).map(|(index, _)| index).collect()
}

/// Returns the share of the displacements of `a` that plus `shift` agree with `b` within 1 px.
fn kept(a: &Output, b: &Output, shift: [f32; 2]) -> Option<f64> {
    let (a, b) = (a.displacements()?, b.displacements()?);
    let close = |a: [f32; 2], b: [f32; 2]| (a[0] + shift[0] - b[0]).hypot(a[1] + shift[1] - b[1]) <= 1.0;
    let both = a.iter().zip(&b).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
    let same = both.filter(|(a, b)| close(*a, *b)).count();
    Some(same as f64 / a.iter().flatten().count().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use std::future::{Ready, ready};
    use std::task::{Context, Poll, Waker};

    use super::*;
    use crate::base::Threads;
    use crate::course::estimators;
    use crate::geometry::Grid;
    use crate::products::BlockField;
    use crate::run::{Cursor, Move};

    fn run(estimator: &dyn AnyEstimator, clip: &Clip, frame: usize) -> Ready<Result<Output, Error>> {
        ready(estimator.run(clip, frame, &Threads::single()))
    }

    /// The result of work that never waits.
    fn at_once<T>(work: impl Future<Output = T>) -> T {
        match std::pin::pin!(work).poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(done) => done,
            Poll::Pending => unreachable!("it runs at once"),
        }
    }

    fn figures(estimator: &dyn AnyEstimator, ran: &RunSummary, clip: &Clip) -> Figures {
        at_once(Figures::of(estimator, ran, (clip, 0), &run)).expect("figures")
    }

    fn clip() -> Clip {
        crate::synth::make(crate::synth::SCENES[0].id, &crate::synth::SCENES[0].difficulty()).expect("a scene")
    }

    #[test]
    fn only_what_was_changed_is_carried_over() {
        let of = |id: &str| estimator(id).expect("it exists");
        // Each keeps its own defaults.
        for (from, to) in
            [("lucas-kanade", "horn-schunck"), ("lucas-kanade", "harris"), ("full-search", "hierarchical")]
        {
            assert_eq!(changed_alike(&*of(from), of(to)).values(), of(to).values(), "{from} to {to}");
        }
        let changed = |id: &str, settings: &[(&str, &str)]| {
            let mut estimator = of(id);
            settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("in range"));
            estimator
        };
        let from = changed("full-search", &[("block-size", "8"), ("cost", "ssd")]);
        let to = changed_alike(&*from, of("diamond"));
        assert_eq!([to.get("block-size"), to.get("cost")], [Ok(Value::Int(8)), Ok(Value::Choice("ssd"))]);
        // Iterations of another kind, and another family.
        let from = changed("lucas-kanade", &[("iterations", "7"), ("sigma", "1.5"), ("derivatives", "sobel")]);
        let to = changed_alike(&*from, of("horn-schunck"));
        assert_eq!(to.get("iterations"), of("horn-schunck").get("iterations"));
        assert_eq!(to.get("sigma"), Ok(Value::Real(1.5)));
        assert_eq!(changed_alike(&*from, of("harris")).values(), of("harris").values());
    }

    #[test]
    fn full_search_misses_nothing_and_the_others_are_reported_where_they_do() {
        let (clip, threads) = (clip(), Threads::single());
        for estimator in estimators() {
            let run = estimator.run_counted(&clip, 0, &threads).expect("a run");
            let figures = figures(&*estimator, &run, &clip);
            let output = run.output;
            let id = estimator.info().id;
            for kept in [figures.kept_in_noise, figures.kept_in_light] {
                let is_sparse = !output.motion().is_field();
                assert_eq!(kept.is_none(), is_sparse, "{id}");
                assert!(kept.is_none_or(|kept| (0.0..=1.0).contains(&kept)), "{id}");
            }
            assert_eq!(figures.blocks.is_some(), estimator.info().family == "Block matching", "{id}");
            let Some(blocks) = &figures.blocks else { continue };
            if id == "full-search" {
                assert_eq!(blocks.missed_share(), Some(0.0));
                assert_eq!(blocks.candidates_most, 33 * 33);
            }
            assert!(f64::from(blocks.candidates_most) >= blocks.candidates_mean, "{id}");
            // The first block that is said to be missed has a better displacement indeed.
            let Some((&block, unit)) = blocks.missed.iter().flatten().next().zip(figures.first_missed_unit()) else {
                continue;
            };
            let result = |estimator: &dyn AnyEstimator, unit: usize| {
                let mut walk = estimator.walk(&clip, 0).expect("a walk");
                walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
                walk.output().get::<BlockField>().expect("blocks").vectors[block].expect("it was searched").cost
            };
            let full = full_search_like(&*estimator).expect("full search");
            assert!(result(&*estimator, unit) > result(&*full, block), "{id}");
        }
    }

    #[test]
    fn a_pan_is_found_by_whoever_looks_far_enough() {
        let clip = clip();
        let kept = |id: &str, range: &str, pan_px| {
            let mut search = estimator(id).expect("it");
            search.set("search-range", range).expect("in range");
            at_once(kept_in_pan(&*search, (&clip, 0), pan_px, &run)).map(|(share, _)| share)
        };
        assert_eq!(kept("full-search", "16", 0), Ok(1.0));
        assert_eq!(kept("full-search", "16", 40), Ok(0.0));
        assert!(kept("full-search", "64", 40).expect("a share") > 0.7);
        assert!(kept("full-search", "16", 5000).is_err());
    }

    #[test]
    fn nothing_is_said_to_be_missed_where_costs_have_a_price() {
        let (clip, threads) = (clip(), Threads::single());
        let mut diamond = estimator("diamond").expect("it");
        diamond.set("lambda", "4").expect("it has one");
        let run = diamond.run_counted(&clip, 0, &threads).expect("a run");
        let figures = figures(&*diamond, &run, &clip);
        let missed = figures.blocks.as_ref().and_then(BlockFigures::missed_share);
        assert_eq!((missed, figures.first_missed_unit()), (None, None));
    }

    #[test]
    fn a_flat_picture_has_nothing_to_miss_or_lose() {
        let flat = |v| Frame::gray(Grid::new(48, 32, v));
        let clip = Clip::from_frames("flat", vec![flat(90), flat(90)]).expect("a clip");
        let (full, threads) = (estimator("full-search").expect("it"), Threads::single());
        let run = full.run_counted(&clip, 0, &threads).expect("a run");
        let figures = figures(&*full, &run, &clip);
        let missed = figures.blocks.as_ref().and_then(BlockFigures::missed_share);
        assert_eq!((figures.kept_in_light, missed), (Some(1.0), Some(0.0)));
    }
}
