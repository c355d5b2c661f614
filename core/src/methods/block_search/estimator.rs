//! How each block search is an estimator.

use std::any::Any;
use std::sync::Arc;

use super::probe::Probe;
use super::tester::Workspace;
use super::vocabulary::line;
use super::{BlockSearch, BorderRule, Event, Match, Neighbours, Pair, Pattern, QUESTIONS, Tester};
use crate::base::{Earlier, Error, Observer, Tally, Threads};
use crate::data::{Clip, Truth};
use crate::methods::cost::bounds::PartSums;
use crate::products::{BlockField, Output, Product, ProductKind};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, TestsCandidates};
use crate::scene::{Chart, Focus, Question, Role, Scene, Step};

/// The matches of the previous pair of frames and of the one before that, by block, where there are such pairs.
type Before = [Option<Arc<[Match]>>; 2];

/// The state of a block search.
#[derive(Clone)]
pub struct State {
    pair: Pair,
    /// The matches of the previous pair of frames and of the one before, by block; `None` without temporal prediction.
    before: Before,
    found: Vec<Match>,
    /// Number of candidates tested for each block.
    tested: Vec<u32>,
    /// Number of candidates skipped for each block.
    skipped: Vec<u32>,
    /// The sums of parts of frame t + 1, for a search that asks for them.
    sums: Option<Arc<PartSums>>,
    /// The ground truth of the clip, and frame t, for explanations.
    truth: Option<Arc<dyn Truth>>,
    frame: usize,
}

/// The result of the search of a block.
#[derive(Clone, Copy, Default)]
struct Outcome {
    found: Match,
    /// Number of candidates tested and skipped.
    tested: u32,
    skipped: u32,
}

/// Searches block `index`, `found` being the matches before it.
fn search_block<S: BlockSearch>(
    search: &S,
    State { pair, before, sums, .. }: &State,
    (index, found): (usize, impl Fn(usize) -> Match),
    work: &mut Workspace,
    observer: &mut impl Observer<Event>,
) -> Outcome {
    observer.see(|| Event::Window);
    let settings = search.settings();
    // The rate of a displacement is that of its difference from the median predictor.
    let neighbours = match search.predicts() || settings.refinement.lambda > 0.0 {
        true => Neighbours::of(index, pair.blocks.counts().0, found, before.each_ref().map(|before| before.as_deref())),
        false => Neighbours::default(),
    };
    let mut tester = Tester::new((pair, index), settings, neighbours, work, observer);
    tester.sums.clone_from(sums);
    search.search(&mut tester);
    let skipped = tester.skipped as u32;
    let (found, tested) = tester.finish();
    Outcome { found, tested: tested as u32, skipped }
}

/// The state before the first block, `before` being the matches of the previous pair of frames.
fn start<S: BlockSearch>(search: &S, clip: &Clip, frame: usize, before: Before) -> Result<State, Error> {
    let settings = search.settings();
    let pair =
        Pair::new(clip, frame, settings.matching.block_size, settings.refinement.spacing, settings.refinement.border)?;
    let sides = search.part_sides();
    let margin = if pair.rule == BorderRule::Inside { 0 } else { settings.matching.search_range };
    let sums = || Arc::new(PartSums::of_picture(pair.next.luma(), margin, pair.rule.border(), &sides));
    let sums = (!sides.is_empty()).then(sums);
    Ok(State {
        pair,
        before,
        found: Vec::new(),
        tested: Vec::new(),
        skipped: Vec::new(),
        sums,
        truth: clip.truth().cloned(),
        frame,
    })
}

/// The state before the first block; with temporal prediction the two previous pairs of frames are searched first.
fn prepare<S: BlockSearch>(search: &S, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
    let mut before = Before::default();
    let first = if search.predicts_in_time() { frame.saturating_sub(2) } else { frame };
    for earlier in first..frame {
        let state = start(search, clip, earlier, before.clone())?;
        let found = finish(search, clip, state, (threads, &()))?.found.into();
        before = [Some(found), before[0].take()];
    }
    start(search, clip, frame, before)
}

/// Searches all blocks.
///
/// # Errors
/// If the work is cancelled.
fn finish<S: BlockSearch>(
    search: &S,
    clip: &Clip,
    mut state: State,
    (threads, tally): (&Threads, &impl Tally<Event>),
) -> Result<State, Error> {
    tally.add_units(state.pair.blocks.len());
    let blocks = threads.sweep(
        (state.pair.blocks.counts(), || clip.wanted()),
        Workspace::default,
        |work, index, earlier: Earlier<Outcome>| {
            search_block(search, &state, (index, |i| earlier.at(i).found), work, &mut tally.counter())
        },
    )?;
    state.found = blocks.iter().map(|block| block.found).collect();
    state.tested = blocks.iter().map(|block| block.tested).collect();
    state.skipped = blocks.iter().map(|block| block.skipped).collect();
    Ok(state)
}

impl<S: BlockSearch> Estimator for S {
    const INFO: Info = <S as BlockSearch>::INFO;
    const QUESTIONS: &'static [Question] = QUESTIONS;
    const GUARANTEE: Guarantee = <S as BlockSearch>::GUARANTEE;
    const CHARTS: &'static [Chart] = &[Chart::Surface, Chart::Series, Chart::Tiles, Chart::Histogram];
    const PRODUCES: &'static [&'static ProductKind] = &[BlockField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        prepare(self, clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let so_far = (state.found.len(), |i: usize| state.found[i]);
        let block = search_block(self, state, so_far, &mut Workspace::default(), observer);
        state.found.push(block.found);
        state.tested.push(block.tested);
        state.skipped.push(block.skipped);
        Ok(if state.found.len() == state.pair.blocks.len() { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.pair.blocks.len())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let block = Granularity { index: state.found.len(), of: Some(state.pair.blocks.len()) };
        vec![Granularity { index: 0, of: Some(1) }, block]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        event.landmark()
    }

    fn lends(&self) -> Option<Box<dyn Any>> {
        Some(Box::new(Pattern::of(self.clone())))
    }

    fn tests(&self) -> Option<&dyn TestsCandidates<Self::State, Self::Event>> {
        Some(self)
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        probe(self, seen).step(Step::at(line::EACH_BLOCK))
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        probe(self, seen).draw(scene);
    }

    fn output(&self, state: &State) -> Output {
        let settings = self.settings();
        let vector = |(found, &candidates): (&Match, &u32)| Some(found.result(candidates));
        let mut vectors: Vec<_> = state.found.iter().zip(&state.tested).map(vector).collect();
        vectors.resize(state.pair.blocks.len(), None);
        Output::of(settings.field(state.pair.blocks, vectors))
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        prepare(self, clip, frame, threads).and_then(|state| finish(self, clip, state, (threads, tally)))
    }
}

impl<S: BlockSearch> Footprint<State> for S {
    fn need(&self, clip: &Clip) -> Need {
        let settings = self.settings();
        // With the search window beyond the border.
        let [width, height] = [clip.size().0, clip.size().1].map(|side| side + 2 * settings.matching.search_range);
        let sums = (self.part_sides().len() * width * height * size_of::<u32>()) as f64;
        need(clip, settings.grid(clip.size()).len()).and([sums; 2])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + state.found.len() * (size_of::<Match>() + 2 * size_of::<u32>())
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let sums = state.sums.as_ref().map_or(0, |sums| sums.bytes());
        self.state_bytes(state)
            + sums
            + state.before.iter().flatten().map(|before| size_of_val(&**before)).sum::<usize>()
    }
}

impl<S: BlockSearch> TestsCandidates<State, Event> for S {
    fn is_evaluation(&self, event: &Event) -> bool {
        event.is_candidate()
    }

    fn evaluations(&self, state: &State) -> Vec<u32> {
        state.tested.clone()
    }
}

impl<S: BlockSearch> Pointed<State> for S {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.pair.blocks.at(point)
    }
}

/// Memory for a search of this many blocks: a sweep holds each four times until it is done, a state that is walked through
/// once.
pub(crate) fn need(clip: &Clip, blocks: usize) -> Need {
    const BLOCK: f64 = size_of::<Outcome>() as f64;
    let blocks = blocks as f64;
    Need::per_pixel(clip, [1.0, 2.0]).and([blocks * 7.0 * BLOCK, blocks * 9.0 * BLOCK]).and([0.0, EVENTS])
}

/// The events of a block with the largest search window, in bytes.
const EVENTS: f64 = 8e6;

fn probe<'a, S: BlockSearch>(search: &S, seen: &'a Seen<S>) -> Probe<'a> {
    let Seen { before: State { pair, found, skipped, truth, frame, .. }, events, .. } = *seen;
    let truth = truth.as_deref().map(|truth| (truth, *frame));
    Probe { skipped, truth, ..Probe::new(pair, search.settings(), found, (events, seen.point())) }
}
