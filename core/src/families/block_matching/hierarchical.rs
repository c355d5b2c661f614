//! Hierarchical search: coarse-to-fine block matching on a Gaussian pyramid.
//!
//! ```text
//!        ┌───┐
//!        │ ↗ │         coarsest level: a search within ±search range / 2^level px
//!       ┌┴───┴┐
//!       │  ↗  │        next level: the doubled vector, refined within ±refinement range px
//!      ┌┴─────┴┐       . . . . .
//!      │       │       . 3 3 3 .     1  (0, 0)
//!      │   ↗   │       . 3 2 3 .     2  doubled vectors of the nearest block of the coarser level and its neighbours
//!      │       │       1 3 3 3 2     3  all candidates within ±refinement range px of the best of them
//!      └───────┘       . . . . .
//! ```
//!
//! All levels have one block size, so a level has a quarter of the blocks of the next finer one; the search range is in px of
//! level 0. A unit is a block of a level, and `unit_at` maps a block of the result to its unit.

use std::cmp::Ordering;
use std::sync::Arc;

use crate::base::{Earlier, Error, Observer, Tally, Threads};
use crate::data::{Clip, Counted, Frame, Truth};
use crate::geometry::pyramid;
use crate::methods::block_search::{
    Displacement, Event, HasSettings, Match, Matching, Neighbours, Pair, Pattern, Probe, QUESTIONS, Refinement, Relay,
    Settings, Subpixel, Tester, Workspace, block_search_params, need, value,
};
use crate::params::{Parameter as _, Value};
use crate::products::{Block, BlockField, BlockGrid, Output, Product, ProductKind};
use crate::run::{
    BlockVectors, Estimator, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Stage, StageView,
    TestsCandidates,
};
use crate::scene::{Chart, Floor, Focus, Level, Levels, Question, Readout, Role, Scene, Stack, Step};
use crate::{cases, pseudocode};

block_search_params! {
    /// Hierarchical search: block matching on the coarsest level of a Gaussian pyramid, refined level by level.
    pub struct Hierarchical {
        /// Number of pyramid levels, the picture included. Each halves width and height, so large motion becomes small; too many
        /// levels blur small objects away.
        levels: usize = 3, 2..=6;
        /// Block search on the coarsest level.
        coarse: Stage<BlockVectors> = Stage::named("full-search");
        /// Largest correction of the doubled motion vector on each finer level.
        refinement_range: usize = 1, 1..=4, "px";
    }
}

/// The state of a hierarchical search.
#[derive(Clone)]
pub struct State {
    /// The two frames and their blocks, level by level; the picture itself is level 0.
    levels: Arc<[Pair]>,
    /// The same frames, for display.
    pictures: Arc<[Level]>,
    /// The matches with the number of candidates tested, by level and block.
    found: Vec<Vec<(Match, u32)>>,
    /// The level of the next block.
    level: usize,
    /// The search pattern of the coarsest level.
    coarse: Pattern,
    /// The ground truth of the clip, and frame t, for explanations.
    truth: Option<Arc<dyn Truth>>,
    frame: usize,
}

impl State {
    fn pair(&self) -> &Pair {
        &self.levels[self.level]
    }

    /// The next block of the level.
    fn index(&self) -> usize {
        self.found[self.level].len()
    }

    fn is_coarsest(&self) -> bool {
        self.level + 1 == self.levels.len()
    }

    /// Column and row of the block of the coarser level that is nearest to block `index` of `level`.
    fn parent(&self, level: usize, index: usize) -> (usize, usize) {
        let coarser = &self.levels[level + 1].blocks;
        let [x, y] = self.levels[level].blocks.block(index).center().map(|c| (c / 2.0) as usize);
        coarser.nearest(x.min(coarser.picture.0 - 1), y.min(coarser.picture.1 - 1))
    }

    /// Block `index` of `level`, and on each coarser level the block that initialises the one below.
    fn line(&self, level: usize, index: usize) -> Vec<usize> {
        let mut line = vec![index];
        for coarser in level + 1..self.levels.len() {
            let (column, row) = self.parent(coarser - 1, line[line.len() - 1]);
            line.push(row * self.levels[coarser].blocks.counts().0 + column);
        }
        line
    }

    /// The block of each level that lies where the next block does, from level 0 on.
    fn column(&self) -> Vec<usize> {
        let center = self.pair().blocks.block(self.index()).center();
        let finer = (0..self.level).map(|level| {
            let blocks = &self.levels[level].blocks;
            let [x, y] = center.map(|c| (c * (1u32 << (self.level - level)) as f32) as usize);
            let (column, row) = blocks.nearest(x.min(blocks.picture.0 - 1), y.min(blocks.picture.1 - 1));
            row * blocks.counts().0 + column
        });
        finer.chain(self.line(self.level, self.index())).collect()
    }

    fn first_unit(&self, level: usize) -> usize {
        self.levels[level + 1..].iter().map(|pair| pair.blocks.len()).sum()
    }

    /// The doubled vectors of the coarser block nearest to block `index`, and of its neighbours.
    fn inherited(&self, index: usize) -> Vec<Displacement> {
        let (coarser, found) = (&self.levels[self.level + 1].blocks, &self.found[self.level + 1]);
        let (columns, rows) = coarser.counts();
        let (column, row) = self.parent(self.level, index);
        let around = [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)];
        let places =
            around.iter().filter_map(|(i, j)| Some((column.checked_add_signed(*i)?, row.checked_add_signed(*j)?)));
        let inside = places.filter(|(column, row)| *column < columns && *row < rows);
        inside.map(|(column, row)| found[row * columns + column].0.displacement.map(|c| 2 * c)).collect()
    }

    /// The matches so far on the current level.
    fn matches(&self) -> Vec<Match> {
        self.found[self.level].iter().map(|(found, _)| *found).collect()
    }

    /// The pyramid after these events; before the first one the picture itself is shown.
    fn shown(&self, events: &[Event]) -> Levels {
        let at_work = if events.is_empty() { 0 } else { self.level };
        Levels { all: self.pictures.clone(), at_work }
    }

    /// Pixels of the picture per pixel of the current level.
    fn scale(&self) -> f32 {
        (1u32 << self.level) as f32
    }

    fn push(&mut self, (found, tested): (Match, usize)) -> Progress {
        self.found[self.level].push((found, tested as u32));
        if self.index() < self.pair().blocks.len() {
            return Progress::More;
        }
        if self.level == 0 {
            return Progress::Done;
        }
        self.level -= 1;
        Progress::More
    }
}

impl Hierarchical {
    /// The settings on a level: the search range in the level's pixels. Sub-pixel refinement and the rate term apply to
    /// level 0 only.
    fn settings_on(&self, level: usize) -> Settings {
        let matching = Matching { search_range: self.matching.search_range.div_ceil(1 << level), ..self.matching };
        let settings = Settings { matching, ..self.settings() };
        match level {
            0 => settings,
            _ => {
                let refinement = Refinement { subpixel: Subpixel::None, lambda: 0.0, ..settings.refinement };
                Settings { refinement, ..settings }
            }
        }
    }

    /// The pattern of the search of the coarsest level.
    fn pattern(&self) -> Result<Pattern, Error> {
        let stage = self.coarse.estimator();
        let lent = stage.lends().and_then(|lent| lent.downcast::<Pattern>().ok());
        lent.map(|pattern| *pattern).ok_or_else(|| {
            Error::new(format!("{} has no search pattern; choose a block search as the coarse search", stage.info().id))
        })
    }

    /// The state before the first block.
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let pair = Pair::new(clip, frame, self.matching.block_size, self.refinement.spacing, self.refinement.border)?;
        let (width, height) = pair.blocks.picture;
        let fits =
            |level: usize| width.div_ceil(1 << level).min(height.div_ceil(1 << level)) >= self.matching.block_size;
        if !fits(self.levels - 1) {
            let most = (1..self.levels).take_while(|&level| fits(level)).count() + 1;
            return Err(Error::new(format!(
                "with {} levels the coarsest is smaller than a block of {} px, for a picture of {width}×{height} px; {}",
                self.levels,
                self.matching.block_size,
                if most > 1 {
                    format!("choose {most} levels or fewer, or a smaller block size")
                } else {
                    "choose a smaller block size".into()
                }
            )));
        }
        let frames = [&pair.current, &pair.next];
        let [current, next] =
            <[_; 2]>::try_from(threads.map(2, |i| self.coarser_levels(frames[i]))).unwrap_or_default();
        let coarser = current.into_iter().zip(next).map(|(current, next)| {
            let blocks = BlockGrid { picture: current.size(), ..pair.blocks };
            Pair { current, next, blocks, rule: pair.rule }
        });
        let levels: Vec<_> = [pair.clone()].into_iter().chain(coarser).collect();
        let pictures = levels.iter().map(|pair| Level::new([pair.current.clone(), pair.next.clone()])).collect();
        let (found, level) = (vec![Vec::new(); levels.len()], levels.len() - 1);
        let coarse = self.pattern()?.within(self.settings_on(level).matching.search_range)?;
        Ok(State { found, level, levels: levels.into(), pictures, coarse, truth: clip.truth().cloned(), frame })
    }

    /// The levels of the pyramid over `frame`.
    fn coarser_levels(&self, frame: &Arc<Frame>) -> Vec<Arc<Frame>> {
        let mut levels: Vec<Arc<Frame>> = Vec::new();
        while levels.len() + 1 < self.levels {
            let finest = levels.last().unwrap_or(frame);
            levels.push(Arc::new(Frame::gray(pyramid::halve(finest.luma()))));
        }
        levels
    }

    /// Searches block `index` of the current level, `found` being the matches of earlier blocks.
    fn search_block<O: Observer<Event>>(
        &self,
        state: &State,
        (index, found): (usize, impl Fn(usize) -> Match),
        work: &mut Workspace,
        observer: &mut O,
    ) -> (Match, usize) {
        observer.see(|| Event::Window);
        let (pair, settings) = (state.pair(), self.settings_on(state.level));
        let neighbours = match state.is_coarsest() || settings.refinement.lambda > 0.0 {
            true => Neighbours::of(index, pair.blocks.counts().0, found, [None; 2]),
            false => Neighbours::default(),
        };
        if !state.is_coarsest() {
            let mut tester = Tester::new((pair, index), settings, neighbours, work, observer);
            self.refine(&state.inherited(index), &mut tester);
            return tester.finish();
        }
        let mut relay = Relay(O::WATCHES.then(Vec::new));
        let mut tester = Tester::new((pair, index), settings, neighbours, work, &mut relay);
        state.coarse.search(&mut tester);
        let result = tester.finish();
        relay.0.into_iter().flatten().for_each(|event| observer.see(|| event));
        result
    }

    /// Refines the vectors of the coarser level on the finer one.
    fn refine(&self, inherited: &[Displacement], tester: &mut Tester<impl Observer<Event>>) {
        tester.stage(inherited.iter().copied().chain([[0, 0]]), || {
            let first = inherited.first().copied().unwrap_or_default();
            Step::at(line::TEST_COARSER).put(value::DOUBLED, first).say(case::INHERITED)
        });
        let (best, reach) = (tester.best(), self.refinement_range as i32);
        let row = move |v| (-reach..=reach).map(move |u| [best[0] + u, best[1] + v]);
        tester.stage((-reach..=reach).flat_map(row), || {
            let step = Step::at(line::TEST_AROUND).put(value::BEST, best).put(value::REFINEMENT_RANGE, reach);
            step.say(case::REFINED)
        });
    }

    /// The pyramid with the block and its vector on every level.
    fn stack(&self, seen: &Seen<Self>, probe: &Probe) -> Stack {
        let state = seen.before;
        let floor = |(level, index): (usize, usize)| {
            let Block { x, y, width, height } = state.levels[level].blocks.block(index);
            let min = [x as f32 - 0.5, y as f32 - 0.5];
            let vector = match level.cmp(&state.level) {
                Ordering::Less => None,
                Ordering::Equal => {
                    let role = if probe.is_over() { Role::Result } else { Role::Best };
                    probe.best().map(|best| (best.vector(), role))
                }
                Ordering::Greater => Some((state.found[level][index].0.vector(), Role::Result)),
            };
            Floor { at_hand: Some([min, [min[0] + width as f32, min[1] + height as f32]]), vector }
        };
        // Before the first event there is no current block.
        let floors = match seen.events {
            [] => vec![Floor::default(); state.levels.len()],
            _ => state.column().into_iter().enumerate().map(floor).collect(),
        };
        Stack { levels: state.shown(seen.events), floors }
    }

    fn probe<'a>(&self, seen: &'a Seen<Self>, found: &'a [Match]) -> Probe<'a> {
        let Seen { before, events, .. } = *seen;
        let focus = seen.point().map(|point| point.map(|c| c / before.scale()));
        let probe = Probe::new(before.pair(), self.settings_on(before.level), found, (events, focus));
        let counted = Counted { first_unit: before.first_unit(before.level), level: Some(before.level) };
        // The blocks of coarser levels are not those of the clip.
        let truth = before.truth.as_deref().filter(|_| before.level == 0).map(|truth| (truth, before.frame));
        Probe { counted, truth, is_refinement: !before.is_coarsest(), ..probe }
    }
}

cases! { over value;
    ON_LEVEL: "Level {level} of the pyramid, {width}×{height} px.",
    INHERITED: "Initial candidates: twice the vector of the nearest block on the coarser level, {doubled}, those of its \
                neighbours, and (0, 0).",
    REFINED: "One pixel of the coarser level is two pixels of this level, so the motion vector is refined within \
              ±{refinement_range} of {best:bare}.",
    ON_PICTURE: "On level 0 this motion vector is {on_picture}.",
}

pseudocode! {
    MAKE_PYRAMIDS: "build Gaussian pyramids of frames t and t+1",
    EACH_LEVEL: "for each level, from the coarsest to level 0 (the picture)",
    EACH_BLOCK: "  for each block B of the level",
    IS_COARSEST: "    if the level is the coarsest, then",
    SEARCH_COARSEST: "      search B within ±search range / 2^level px with the coarse search",
    IS_FINER: "    else",
    TEST_COARSER: "      test the doubled vectors of the nearest coarser blocks, and (0, 0)",
    TEST_AROUND: "      test all candidates within ±refinement range of best",
    REFINE_BEST: "    refine best to sub-pixel accuracy (on level 0, if subpixel is set)",
    SET_DISPLACEMENT: "    motion vector of B ← best",
    TEST: "to test candidate (u, v), if it is new and inside the search window",
    COMPUTE_COST: "  c ← cost of B and the block of frame t+1 displaced by (u, v) [+ λR(u, v) on level 0]",
    COMPARE_COST: "  if c < minimum, or c = minimum and (u, v) is shorter than best",
    KEEP_BEST: "    minimum ← c; best ← (u, v)",
}

impl Estimator for Hierarchical {
    const INFO: Info = Info {
        id: "hierarchical",
        name: "Hierarchical search",
        family: "Block matching",
        summary: "Matches blocks on the coarsest level of a pyramid, and refines the motion vectors level by level.",
        source: "M. Bierling, Displacement estimation by hierarchical blockmatching, Proc. SPIE 1001, Visual \
                 Communications and Image Processing, 1988; pyramid: P. J. Burt and E. H. Adelson, The Laplacian pyramid \
                 as a compact image code, IEEE Trans. Communications 31(4), 1983",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "block", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = QUESTIONS;
    const GUARANTEE: Guarantee = Guarantee::SmoothTranslation { off_px: 0 };
    const CHARTS: &'static [Chart] = &[Chart::Surface, Chart::Stack, Chart::Series, Chart::Tiles, Chart::Histogram];
    const PRODUCES: &'static [&'static ProductKind] = &[BlockField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let so_far = (state.index(), |i: usize| state.found[state.level][i].0);
        let result = self.search_block(state, so_far, &mut Workspace::default(), observer);
        Ok(state.push(result))
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.levels.iter().map(|pair| pair.blocks.len()).sum())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let count = state.levels.len();
        let level = Granularity { index: count - 1 - state.level, of: Some(count) };
        let block = Granularity { index: state.index(), of: Some(state.pair().blocks.len()) };
        vec![Granularity { index: 0, of: Some(1) }, level, block]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        event.landmark()
    }

    /// The coarse search works on the coarsest level.
    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        let pair = clip.pair(now)?;
        let coarsest = |frame| self.coarser_levels(frame).pop().unwrap_or_else(|| Arc::clone(frame));
        let frames = pair.each_ref().map(|frame| Frame::clone(&coarsest(frame)));
        let name = format!("{}, level {}", clip.info().name, self.levels - 1);
        let level = Clip::from_frames(name, frames.into())?.part_of(clip);
        let settings = self.settings_on(self.levels - 1);
        let set = vec![
            ("search-range", Value::Int(settings.matching.search_range as i64)),
            ("subpixel", settings.refinement.subpixel.to_value()),
            ("lambda", Value::Real(0.0)),
        ];
        Ok(Some(StageView { clip: level, set }))
    }

    fn tests(&self) -> Option<&dyn TestsCandidates<Self::State, Self::Event>> {
        Some(self)
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let found = state.matches();
        let (probe, (width, height)) = (self.probe(seen, &found), state.pair().blocks.picture);
        let lead = Step::at(line::MAKE_PYRAMIDS)
            .fact(value::LEVEL, state.level)
            .fact(value::COARSEST, state.levels.len() - 1)
            .put(value::WIDTH, width)
            .put(value::HEIGHT, height)
            .say_if(matches!(seen.events, [Event::Window]), case::ON_LEVEL);
        let mut step = probe.step(lead);
        match seen.events.last() {
            None => step.line = line::MAKE_PYRAMIDS,
            Some(Event::Window) => step.line = line::EACH_BLOCK,
            Some(Event::Stage(_)) if state.is_coarsest() => step.line = line::SEARCH_COARSEST,
            Some(Event::Candidate { .. } | Event::Skipped(_)) => step.line = line::COMPUTE_COST,
            Some(Event::Found(found)) if state.level > 0 => {
                let on_picture = found.displacement.map(|c| c << state.level);
                step = step.put(value::ON_PICTURE, on_picture).say(case::ON_PICTURE);
            }
            Some(_) => {}
        }
        for readout in &mut step.readouts {
            if let Readout::Surface(surface) = readout {
                // A finer level tests few candidates of a wide search window: only the part around them is shown.
                if !state.is_coarsest() {
                    *surface = surface.around_tested(self.refinement_range + 1);
                }
                let factor = (1 << state.level) as f32;
                surface.footing = surface.footing.take().map(|footing| footing.enlarged(factor));
            }
        }
        step.show(Readout::Stack(self.stack(seen, &probe)))
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let found = seen.before.matches();
        let mut level = Scene::default();
        self.probe(seen, &found).draw(&mut level);
        scene.add_enlarged(level, 1 << seen.before.level);
        scene.levels = Some(seen.before.shown(seen.events));
    }

    fn output(&self, state: &State) -> Output {
        let blocks = state.levels[0].blocks;
        let vector = |(found, candidates): &(Match, u32)| Some(found.result(*candidates));
        let mut vectors: Vec<_> = state.found[0].iter().map(vector).collect();
        vectors.resize(blocks.len(), None);
        // Candidates of a coarser level count for the block of level 0 at the same place.
        for (level, found) in state.found.iter().enumerate().skip(1) {
            for (i, (_, candidates)) in found.iter().enumerate() {
                let place = state.levels[level].blocks.block(i).center().map(|c| c * (1u32 << level) as f32);
                if let Some(Some(vector)) = blocks.at(place).map(|index| &mut vectors[index]) {
                    vector.candidates += candidates;
                }
            }
        }
        Output::of(self.settings().field(blocks, vectors))
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        loop {
            let search = |work: &mut Workspace, index, earlier: Earlier<(Match, usize)>| {
                self.search_block(&state, (index, |i| earlier.at(i).0), work, &mut tally.counter())
            };
            let mut progress = Progress::More;
            tally.add_units(state.pair().blocks.len());
            let blocks = (state.pair().blocks.counts(), || clip.wanted());
            for result in threads.sweep(blocks, Workspace::default, search)? {
                progress = state.push(result);
            }
            if progress == Progress::Done {
                return Ok(state);
            }
        }
    }
}

impl Footprint<State> for Hierarchical {
    fn need(&self, clip: &Clip) -> Need {
        let (width, height) = clip.size();
        let of_level = |level: usize| self.settings().grid((width.div_ceil(1 << level), height.div_ceil(1 << level)));
        // Plus the levels of both frames.
        need(clip, (0..self.levels).map(|level| of_level(level).len()).sum()).and([(width * height) as f64; 2])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + state.found.iter().map(|found| found.len() * size_of::<(Match, u32)>()).sum::<usize>()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let pixels = |frame: &Frame| frame.luma().cells().len();
        let pyramid: usize = state.levels[1..].iter().map(|pair| pixels(&pair.current) + pixels(&pair.next)).sum();
        self.state_bytes(state) + pyramid
    }
}

impl TestsCandidates<State, Event> for Hierarchical {
    /// The nearest block of each level, from the coarsest on; each initialises the block below it.
    fn way_to(&self, state: &State, block: usize) -> Vec<usize> {
        let line = state.line(0, block).into_iter().enumerate();
        line.map(|(level, index)| state.first_unit(level) + index).rev().collect()
    }

    fn is_evaluation(&self, event: &Event) -> bool {
        event.is_candidate()
    }

    fn evaluations(&self, state: &State) -> Vec<u32> {
        state.found.iter().rev().flatten().map(|(_, candidates)| *candidates).collect()
    }
}

impl Pointed<State> for Hierarchical {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        let index = state.pair().blocks.at(point.map(|c| c / state.scale()))?;
        Some(state.first_unit(state.level) + index)
    }
}
