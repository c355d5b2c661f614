//! A block search at a cursor: what it draws.

use super::{Cost, Displacement, Event, Match, Pair, Window};
use crate::scene::{Arrow, Picture, Shape};
use crate::{Block, Grid, Role, Scene};

/// The unit at a cursor as a block search sees it: what to draw and tell follows from this.
pub(crate) struct Probe<'a> {
    /// The pair of frames.
    pub pair: &'a Pair,
    /// Its cost.
    pub cost: Cost,
    /// Index of the block.
    pub index: usize,
    /// The block's window.
    pub window: Window,
    /// How far the window reaches where nothing cuts it, in px.
    pub range: usize,
    /// Blocks found before.
    pub found: &'a [Match],
    /// Events of this block that were seen.
    pub events: &'a [Event],
    /// The pixel pointed at.
    pub focus: Option<[f32; 2]>,
}

impl Probe<'_> {
    pub(super) fn block(&self) -> Block {
        self.pair.blocks.block(self.index)
    }

    /// The candidate under test.
    pub(super) fn candidate(&self) -> Option<(Match, usize)> {
        self.events.iter().rev().find_map(|event| match event {
            &Event::Candidate { displacement, cost, rows } => Some((Match { displacement, cost }, rows)),
            _ => None,
        })
    }

    /// The best candidate so far.
    pub(super) fn best(&self) -> Option<Match> {
        let newest = self.events.iter().rposition(|event| matches!(event, Event::NewBest { .. }))?;
        Probe { events: &self.events[..newest], ..*self }.candidate().map(|(found, _)| found)
    }

    pub(super) fn tested(&self) -> usize {
        self.events.iter().filter(|event| matches!(event, Event::Candidate { .. })).count()
    }

    pub(super) fn is_over(&self) -> bool {
        matches!(self.events.last(), Some(Event::Found(_)))
    }

    /// Marks on the stage.
    pub fn draw(&self, scene: &mut Scene) {
        let blocks = &self.pair.blocks;
        let arrow = |block: Block, [u, v]: Displacement| {
            let [x, y] = block.center();
            Arrow { from: [x, y], to: [x + u as f32, y + v as f32] }
        };
        let done = self.found.iter().enumerate();
        let arrows: Vec<_> = done.map(|(i, found)| arrow(blocks.block(i), found.displacement)).collect();
        if !arrows.is_empty() {
            scene.mark(Picture::Current, Role::Result, Shape::Arrows(arrows));
            scene.legend(Role::Result, "displacement found");
        }
        // By itself: where there is no room for all of them, this one is still seen.
        if let Some(Event::Found(found)) = self.events.last() {
            let found = arrow(self.block(), found.displacement);
            scene.mark(Picture::Current, Role::Result, Shape::Arrows(vec![found]));
            scene.legend(Role::Result, "displacement found");
        }
        if self.events.is_empty() {
            return;
        }
        let block = self.block();
        let at =
            |[u, v]: Displacement| Shape::pixels(block.x as i32 + u, block.y as i32 + v, block.width, block.height);
        scene.mark(Picture::Current, Role::Reference, at([0, 0]));
        scene.legend(Role::Reference, "block in frame t");
        // The end of the run shows what was found; nothing is searched any more.
        if !self.is_over() || self.index + 1 < blocks.len() {
            self.draw_window(block, scene);
        }
        self.draw_stage(block, scene);
        if let Some(best) = self.best() {
            scene.mark(Picture::Next, Role::Best, at(best.displacement));
            scene.mark(Picture::Next, Role::Best, Shape::Arrows(vec![arrow(block, best.displacement)]));
            scene.legend(Role::Best, if self.is_over() { "best match" } else { "best so far" });
        }
        // On top: a new best is the candidate under test.
        if let Some((candidate, _)) = self.candidate().filter(|_| !self.is_over()) {
            scene.mark(Picture::Next, Role::Candidate, at(candidate.displacement));
            scene.legend(Role::Candidate, "candidate");
        }
    }

    fn draw_window(&self, block: Block, scene: &mut Scene) {
        let (min, size) = (self.window.min, self.window.size);
        let reach = (block.width + size.0 - 1, block.height + size.1 - 1);
        let corner = (block.x as i32 + min[0], block.y as i32 + min[1]);
        if self.tested() > 0 {
            let center = block.center();
            let origin = [center[0] + min[0] as f32, center[1] + min[1] as f32];
            scene.mark(Picture::Next, Role::Candidate, Shape::Heat { origin, values: self.costs() });
        }
        scene.mark(Picture::Next, Role::Window, Shape::pixels(corner.0, corner.1, reach.0, reach.1));
        scene.legend(Role::Window, "search window");
    }

    /// The event that tested each displacement, counted from 1.
    pub(super) fn tests(&self) -> Grid<Option<usize>> {
        let mut tests = Grid::new(self.window.size.0, self.window.size.1, None);
        for (i, event) in self.events.iter().enumerate() {
            if let &Event::Candidate { displacement, .. } = event {
                tests[self.window.place(displacement)] = Some(i + 1);
            }
        }
        tests
    }

    /// The points of the stage at hand: those tested, and those still to test.
    fn draw_stage(&self, block: Block, scene: &mut Scene) {
        let last = self.events.iter().rposition(|event| matches!(event, Event::Stage(_)));
        let Some((Event::Stage(stage), since)) = last.and_then(|last| self.events[last..].split_first()) else {
            return;
        };
        let [x, y] = block.center();
        if let Some(part) = stage.narrowed.filter(|_| !self.is_over()) {
            let corner = [x + part.min[0] as f32 - 0.5, y + part.min[1] as f32 - 0.5];
            let far = [corner[0] + part.size.0 as f32, corner[1] + part.size.1 as f32];
            scene.mark(Picture::Next, Role::Window, Shape::Rect { min: corner, max: far });
        }
        let is_tested = |point: Displacement| {
            since.iter().any(|event| matches!(event, &Event::Candidate { displacement, .. } if displacement == point))
        };
        let (tested, waiting): (Vec<_>, Vec<_>) = stage.points.iter().copied().partition(|&point| is_tested(point));
        for (role, points, meaning) in
            [(Role::Rejected, tested, "tested in this stage"), (Role::Predicted, waiting, "still to test")]
        {
            if !points.is_empty() && !self.is_over() {
                let places = points.iter().map(|[u, v]| [x + *u as f32, y + *v as f32]).collect();
                scene.mark(Picture::Next, role, Shape::Points(places));
                scene.legend(role, meaning);
            }
        }
    }

    /// The costs known so far, by displacement; a candidate that was given up has none.
    pub(super) fn costs(&self) -> Grid<f32> {
        let mut costs = Grid::new(self.window.size.0, self.window.size.1, f32::NAN);
        for event in self.events {
            if let &Event::Candidate { displacement, cost, rows } = event
                && rows == self.block().height
            {
                costs[self.window.place(displacement)] = cost as f32;
            }
        }
        costs
    }
}
