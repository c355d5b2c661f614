//! A block search at a cursor: its marks on the pictures.

use super::{Displacement, Event, Match, Neighbours, Pair, Rate, Settings, Stage, Window};
use crate::data::{Counted, Truth};
use crate::geometry::Grid;
use crate::products::Block;
use crate::scene::{Arrow, Picture, Role, Scene, Shape};

/// The block at a cursor with the events so far: everything drawn and explained follows from this.
pub(crate) struct Probe<'a> {
    /// The pair of frames.
    pub pair: &'a Pair,
    /// The parameters of the search, on this picture.
    pub settings: Settings,
    /// The rate term of displacements.
    pub rate: Rate,
    /// Index of the block.
    pub index: usize,
    /// The way in which blocks are counted in the histogram.
    pub counted: Counted,
    /// The search window of the block.
    pub window: Window,
    /// The matches of earlier blocks.
    pub found: &'a [Match],
    /// Whether the candidates surround motion vectors of a coarser level.
    pub is_refinement: bool,
    /// The ground truth and frame t, where the blocks are those of the clip.
    pub truth: Option<(&'a dyn Truth, usize)>,
    /// The candidates skipped for each of them; empty for a search that skips none.
    pub skipped: &'a [u32],
    /// The events of this block up to the cursor.
    pub events: &'a [Event],
    /// The pixel pointed at.
    pub focus: Option<[f32; 2]>,
}

impl<'a> Probe<'a> {
    /// The block after those in `found`, with its events up to the cursor and the pixel pointed at.
    pub fn new(
        pair: &'a Pair,
        settings: Settings,
        found: &'a [Match],
        (events, focus): (&'a [Event], Option<[f32; 2]>),
    ) -> Self {
        let index = found.len();
        let window = pair.window(pair.blocks.block(index), settings.matching.search_range);
        let neighbours = Neighbours::of(index, pair.blocks.counts().0, |i| found[i], [None; 2]);
        let rate = Rate::new(&settings, &neighbours);
        Self {
            pair,
            settings,
            rate,
            index,
            counted: Counted::default(),
            window,
            found,
            is_refinement: false,
            truth: None,
            skipped: &[],
            events,
            focus,
        }
    }
}

impl Probe<'_> {
    pub(super) fn block(&self) -> Block {
        self.pair.blocks.block(self.index)
    }

    /// The candidates that were tested, each with the rows summed.
    pub(super) fn candidates(&self) -> impl DoubleEndedIterator<Item = (Match, usize)> {
        self.events.iter().filter_map(|event| match event {
            &Event::Candidate { tested, rows } => Some((tested, rows)),
            _ => None,
        })
    }

    /// The candidate that was tested last.
    pub(super) fn candidate(&self) -> Option<(Match, usize)> {
        self.candidates().next_back()
    }

    /// The best candidate so far.
    pub fn best(&self) -> Option<Match> {
        let newest = self.events.iter().rposition(|event| matches!(event, Event::NewBest { .. }))?;
        let (best, _) = Probe { events: &self.events[..newest], ..*self }.candidate()?;
        let fitted = self.events[newest..].iter().find_map(|event| match event {
            Event::Fit(fit) => Some(fit.fraction),
            _ => None,
        });
        Some(Match { fraction: fitted.unwrap_or(best.fraction), ..best })
    }

    pub(super) fn tested(&self) -> usize {
        self.candidates().count()
    }

    pub(super) fn skipped_here(&self) -> usize {
        self.events.iter().filter(|event| matches!(event, Event::Skipped(_))).count()
    }

    pub fn is_over(&self) -> bool {
        matches!(self.events.last(), Some(Event::Found(_)))
    }

    /// Whether a refinement between pixels is announced or fitted: no candidate is under test.
    fn is_refining(&self) -> bool {
        matches!(self.events.last(), Some(Event::Refine(_) | Event::Fit(_)))
    }

    /// The candidate under test, if the step tests one.
    pub(super) fn at_hand(&self) -> Option<(Match, usize)> {
        self.candidate().filter(|_| !self.is_over() && !self.is_refining())
    }

    /// Marks on the stage.
    pub fn draw(&self, scene: &mut Scene) {
        let blocks = &self.pair.blocks;
        let arrow = |block: Block, found: &Match| {
            let ([x, y], [u, v]) = (block.center(), found.vector());
            Arrow { from: [x, y], to: [x + u, y + v] }
        };
        let done = self.found.iter().enumerate();
        let arrows: Vec<_> = done.map(|(i, found)| arrow(blocks.block(i), found)).collect();
        if !arrows.is_empty() {
            scene.draw(Picture::CURRENT, (Role::Result, "motion vector"), Shape::Arrows(arrows));
        }
        // As an arrow of its own, so that it is drawn even if arrows are thinned out.
        if let Some(Event::Found(found)) = self.events.last() {
            let found = arrow(self.block(), found);
            scene.draw(Picture::CURRENT, (Role::Result, "motion vector"), Shape::Arrows(vec![found]));
        }
        if self.events.is_empty() {
            return;
        }
        let block = self.block();
        let at = |[u, v]: [f32; 2]| {
            let min = [block.x as f32 + u - 0.5, block.y as f32 + v - 0.5];
            Shape::Rect { min, max: [min[0] + block.width as f32, min[1] + block.height as f32] }
        };
        scene.draw(Picture::CURRENT, (Role::Reference, "block of frame t"), at([0.0; 2]));
        // At the end of the run only the vectors and the last match remain.
        if !self.is_over() || self.index + 1 < blocks.len() {
            self.draw_window(block, scene);
        }
        self.draw_stage(block, scene);
        if let Some(best) = self.best() {
            scene.mark(Picture::NEXT, Role::Best, at(best.vector()));
            scene.draw(
                Picture::NEXT,
                (Role::Best, if self.is_over() { "best match" } else { "best match so far" }),
                Shape::Arrows(vec![arrow(block, &best)]),
            );
        }
        // On top: a new best is the candidate under test.
        if let Some(displacement) = self.passed_over() {
            scene.draw(
                Picture::NEXT,
                (Role::Candidate, "skipped candidate"),
                at(Match::whole(displacement, 0.0).vector()),
            );
        } else if let Some((candidate, _)) = self.at_hand() {
            scene.draw(Picture::NEXT, (Role::Candidate, "candidate"), at(candidate.vector()));
        }
    }

    /// The candidate skipped by the last event.
    pub(super) fn passed_over(&self) -> Option<Displacement> {
        let Some(Event::Skipped(skipped)) = self.events.last() else { return None };
        Some(skipped.displacement)
    }

    fn draw_window(&self, block: Block, scene: &mut Scene) {
        let (min, size) = (self.window.min, self.window.size);
        let reach = (block.width + size.0 - 1, block.height + size.1 - 1);
        let corner = (block.x as i32 + min[0], block.y as i32 + min[1]);
        if self.tested() > 0 {
            let center = block.center();
            let origin = [center[0] + min[0] as f32, center[1] + min[1] as f32];
            scene.mark(Picture::NEXT, Role::Candidate, Shape::Heat { origin, values: self.costs() });
            scene.heat_scale = self.scale();
        }
        scene.draw(Picture::NEXT, (Role::Window, "search window"), Shape::pixels(corner.0, corner.1, reach.0, reach.1));
    }

    /// The number of the event that tested each displacement, from 1.
    pub(super) fn tests(&self) -> Grid<Option<usize>> {
        let mut tests = Grid::new(self.window.size.0, self.window.size.1, None);
        for (i, event) in self.events.iter().enumerate() {
            if let Event::Candidate { tested, .. } = event
                && tested.fraction == [0.0; 2]
            {
                tests[self.window.place(tested.displacement)] = Some(i + 1);
            }
        }
        tests
    }

    /// The candidates of the current stage: those tested, and the next ones.
    fn draw_stage(&self, block: Block, scene: &mut Scene) {
        let mut stages = self.events.iter().enumerate().rev();
        let Some((last, stage)) = stages.find_map(|(i, event)| Some((i, Stage::of(event)?))) else {
            return;
        };
        let (since, [x, y]) = (&self.events[last + 1..], block.center());
        if let Some(part) = stage.narrowed.filter(|_| !self.is_over()) {
            let corner = [x + part.min[0] as f32 - 0.5, y + part.min[1] as f32 - 0.5];
            let far = [corner[0] + part.size.0 as f32, corner[1] + part.size.1 as f32];
            scene.mark(Picture::NEXT, Role::Window, Shape::Rect { min: corner, max: far });
        }
        let is_tested = |point: [f32; 2]| {
            since.iter().any(|event| matches!(event, Event::Candidate { tested, .. } if tested.vector() == point))
        };
        let (tested, waiting): (Vec<_>, Vec<_>) = stage.points.iter().copied().partition(|&point| is_tested(point));
        for (role, points, meaning) in
            [(Role::Rejected, tested, "tested in this stage"), (Role::Predicted, waiting, "next candidates")]
        {
            if !points.is_empty() && !self.is_over() {
                let places = points.iter().map(|[u, v]| [x + u, y + v]).collect();
                scene.draw(Picture::NEXT, (role, meaning), Shape::Points(places));
            }
        }
    }

    /// The costs so far, by displacement; a candidate rejected early has none.
    pub(super) fn costs(&self) -> Grid<f32> {
        let mut costs = Grid::new(self.window.size.0, self.window.size.1, f32::NAN);
        let height = self.block().height;
        for (tested, _) in self.candidates().filter(|(tested, rows)| *rows == height && tested.fraction == [0.0; 2]) {
            costs[self.window.place(tested.displacement)] = tested.cost as f32;
        }
        costs
    }
}
