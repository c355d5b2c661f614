//! What all block searches share: the pair of frames, the window, the events, and how they are told and drawn.

use std::sync::Arc;

use crate::cost::{Cut, Sum};
use crate::scene::{Arrow, Fact, Math, Picture, Readout, Sentence, Series, Shape, Surface, Tile};
use crate::{
    Block, BlockField, BlockGrid, BlockVector, Border, Clip, Error, Frame, Grid, Output, Role, Scene, choices,
};

choices! {
    /// How unlike two blocks are.
    pub enum Cost {
        /// Sum of absolute differences, Σ |Iₜ − Iₜ₊₁|.
        Sad = "sad" "SAD",
        /// Sum of squared differences, Σ (Iₜ − Iₜ₊₁)²; large differences weigh more.
        Ssd = "ssd" "SSD",
        /// Mean squared error: SSD divided by the number of pixels N of the block, so it chooses the same vectors.
        Mse = "mse" "MSE",
    }
}

impl Cost {
    /// What is summed.
    pub(crate) fn sum(self) -> Sum {
        match self {
            Cost::Sad => Sum::Absolute,
            Cost::Ssd | Cost::Mse => Sum::Squared,
        }
    }

    /// The cost that a sum over `block` amounts to.
    fn of(self, sum: u32, block: Block) -> f32 {
        match self {
            Cost::Sad | Cost::Ssd => sum as f32,
            Cost::Mse => sum as f32 / (block.width * block.height) as f32,
        }
    }

    fn show(self, sum: u32, block: Block) -> String {
        match self {
            Cost::Sad | Cost::Ssd => sum.to_string(),
            Cost::Mse => format!("{:.2}", self.of(sum, block)),
        }
    }
}

choices! {
    /// What happens where the window leaves the picture.
    pub enum BorderRule {
        /// Only candidates that lie wholly inside the picture are tested: the window is cut.
        Inside = "inside" "Stay inside",
        /// The edge pixel is repeated outwards, as video coders do.
        Replicate = "replicate" "Repeat the edge",
        /// The picture is mirrored at its edge.
        Mirror = "mirror" "Mirror",
    }
}

impl BorderRule {
    /// How pixels outside are read.
    pub fn border(self) -> Border {
        match self {
            BorderRule::Inside | BorderRule::Replicate => Border::Replicate,
            BorderRule::Mirror => Border::Mirror,
        }
    }
}

/// A displacement `[u, v]` in whole px from frame t to t + 1.
pub type Displacement = [i32; 2];

/// The displacements that may be tested for a block: a rectangle, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Smallest displacement, both ways.
    pub min: Displacement,
    /// Number of columns and rows.
    pub size: (usize, usize),
}

impl Window {
    /// Number of candidates.
    pub fn count(&self) -> usize {
        self.size.0 * self.size.1
    }

    /// Candidate `index`, row by row.
    #[inline(always)]
    pub fn displacement(&self, index: usize) -> Displacement {
        [self.min[0] + (index % self.size.0) as i32, self.min[1] + (index / self.size.0) as i32]
    }

    /// Column and row of a displacement.
    fn place(&self, displacement: Displacement) -> (usize, usize) {
        ((displacement[0] - self.min[0]) as usize, (displacement[1] - self.min[1]) as usize)
    }
}

/// Which of two equally good displacements is chosen: the shorter, then the first in raster order.
#[inline]
pub fn shorter(a: Displacement, b: Displacement) -> bool {
    let rank = |[u, v]: Displacement| (u * u + v * v, v, u);
    rank(a) < rank(b)
}

/// The two frames, and the blocks of the first.
#[derive(Clone)]
pub struct Pair {
    /// Frame t.
    pub current: Arc<Frame>,
    /// Frame t + 1.
    pub next: Arc<Frame>,
    /// The blocks of frame t.
    pub blocks: BlockGrid,
    /// What happens at the border.
    pub rule: BorderRule,
}

impl Pair {
    /// Frames `frame` and `frame + 1` of `clip`, with blocks of `size` px every `step` px (0: edge to edge).
    ///
    /// # Errors
    /// If there is no such pair, or the picture is smaller than a block.
    pub fn new(clip: &Clip, frame: usize, size: usize, step: usize, rule: BorderRule) -> Result<Self, Error> {
        let [current, next] = clip.pair(frame)?;
        let (width, height) = current.size();
        if next.size() != (width, height) {
            return Err(Error::new(format!("frames {frame} and {} differ in size", frame + 1)));
        }
        if width < size || height < size {
            return Err(Error::new(format!(
                "a block of {size} px does not fit into a picture of {width}×{height} px; choose a smaller block"
            )));
        }
        let step = if step == 0 { size } else { step };
        Ok(Self { current, next, blocks: BlockGrid { picture: (width, height), size, step }, rule })
    }

    /// The window of ±`range` px around `block`, cut where the border rule says so.
    pub fn window(&self, block: Block, range: usize) -> Window {
        let (width, height) = self.blocks.picture;
        let span = |start: usize, length: usize, extent: usize| match self.rule {
            BorderRule::Inside => (range.min(start), range.min(extent - start - length)),
            BorderRule::Replicate | BorderRule::Mirror => (range, range),
        };
        let (left, right) = span(block.x, block.width, width);
        let (up, down) = span(block.y, block.height, height);
        Window { min: [-(left as i32), -(up as i32)], size: (left + right + 1, up + down + 1) }
    }
}

/// The pixels of one block and of all that its window reaches.
#[derive(Default)]
pub(crate) struct Patch {
    /// The block in frame t.
    pub block: Cut,
    /// The pixels under the window in frame t + 1.
    pub area: Cut,
}

impl Patch {
    /// Copies them out of the pair.
    pub fn take(&mut self, pair: &Pair, block: Block, window: Window) {
        let border = pair.rule.border();
        let size = (block.width, block.height);
        let (x, y) = (block.x as isize, block.y as isize);
        self.block.take(pair.current.luma(), (x, y), size, border);
        let reach = (size.0 + window.size.0 - 1, size.1 + window.size.1 - 1);
        let start = (x + window.min[0] as isize, y + window.min[1] as isize);
        self.area.take(pair.next.luma(), start, reach, border);
    }
}

/// What happens while a block is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The window was laid out.
    Window,
    /// A candidate was tested.
    Candidate {
        /// Its displacement.
        displacement: Displacement,
        /// The sum over the rows that were looked at.
        sum: u32,
        /// The rows that were looked at; fewer than the block has if it was given up early.
        rows: usize,
    },
    /// That candidate is the best so far.
    NewBest {
        /// The best before, if there was one.
        before: Option<Match>,
    },
    /// The block is done.
    Found(Match),
}

/// A displacement and its sum of differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Match {
    /// The displacement.
    pub displacement: Displacement,
    /// Sum of differences over the block.
    pub sum: u32,
}

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
    /// Blocks found before.
    pub found: &'a [Match],
    /// Events of this block that were seen.
    pub events: &'a [Event],
    /// The pixel pointed at.
    pub focus: Option<[f32; 2]>,
}

/// A number with a true minus sign.
pub fn signed(v: i32) -> String {
    if v < 0 { format!("−{}", v.unsigned_abs()) } else { v.to_string() }
}

fn vector([u, v]: Displacement) -> String {
    format!("({}, {})", signed(u), signed(v))
}

impl Probe<'_> {
    fn block(&self) -> Block {
        self.pair.blocks.block(self.index)
    }

    /// The candidate under test.
    fn candidate(&self) -> Option<(Match, usize)> {
        self.events.iter().rev().find_map(|event| match *event {
            Event::Candidate { displacement, sum, rows } => Some((Match { displacement, sum }, rows)),
            _ => None,
        })
    }

    /// The best candidate so far.
    fn best(&self) -> Option<Match> {
        let newest = self.events.iter().rposition(|event| matches!(event, Event::NewBest { .. }))?;
        Probe { events: &self.events[..newest], ..*self }.candidate().map(|(found, _)| found)
    }

    fn tested(&self) -> usize {
        self.events.iter().filter(|event| matches!(event, Event::Candidate { .. })).count()
    }

    fn is_over(&self) -> bool {
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
        let mut arrows: Vec<_> = done.map(|(i, found)| arrow(blocks.block(i), found.displacement)).collect();
        if let Some(Event::Found(found)) = self.events.last() {
            arrows.push(arrow(self.block(), found.displacement));
        }
        if !arrows.is_empty() {
            scene.mark(Picture::Current, Role::Result, Shape::Arrows(arrows));
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
        self.draw_window(block, scene);
        if let Some((candidate, _)) = self.candidate().filter(|_| !self.is_over()) {
            scene.mark(Picture::Next, Role::Candidate, at(candidate.displacement));
            scene.legend(Role::Candidate, "candidate");
        }
        if let Some(best) = self.best() {
            scene.mark(Picture::Next, Role::Best, at(best.displacement));
            scene.mark(Picture::Next, Role::Best, Shape::Arrows(vec![arrow(block, best.displacement)]));
            scene.legend(Role::Best, "best so far");
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

    /// The costs tested so far, by displacement.
    fn costs(&self) -> Grid<f32> {
        let mut costs = Grid::new(self.window.size.0, self.window.size.1, f32::NAN);
        for event in self.events {
            if let Event::Candidate { displacement, sum, .. } = *event {
                costs[self.window.place(displacement)] = self.cost.of(sum, self.block());
            }
        }
        costs
    }

    /// Why the last event happened.
    pub fn sentence(&self) -> Sentence {
        let block = self.block();
        let place = format!("{}×{} px at ({}, {})", block.width, block.height, block.x, block.y);
        let show = |found: Match| self.cost.show(found.sum, block);
        let said = Sentence::default();
        match (self.events.last(), self.candidate()) {
            (Some(Event::Window), _) | (Some(Event::Candidate { .. } | Event::NewBest { .. }), None) => {
                let (columns, rows) = self.window.size;
                let of = format!("{columns}×{rows} = {} candidates", self.window.count());
                let full = self.window.size.0 == self.window.size.1 && self.window.min[0] == self.window.min[1];
                let cut = if full { "." } else { "; the picture's border cuts it." };
                said.ink(Role::Reference, format!("Block {}", self.index + 1))
                    .text(format!(" is the {place} of frame t. Its "))
                    .ink(Role::Window, "search window")
                    .text(format!(" in frame t+1 holds {of}{cut}"))
            }
            (Some(Event::Candidate { .. }), Some((candidate, rows))) => self.why_candidate(candidate, rows),
            (Some(Event::NewBest { before }), Some((best, _))) => {
                let said = said.ink(Role::Best, format!("{} at {}", show(best), vector(best.displacement)));
                match *before {
                    None => said.text(" is the first cost, so it is the best so far."),
                    Some(old) if old.sum == best.sum => said.text(format!(
                        " equals the best so far at {}, and the displacement is shorter: it is preferred.",
                        vector(old.displacement)
                    )),
                    Some(old) => {
                        said.text(format!(" is less than {} at {}: the new best.", show(old), vector(old.displacement)))
                    }
                }
            }
            (Some(Event::Found(found)), _) => said
                .ink(Role::Reference, format!("Block {}", self.index + 1))
                .text(" moves by ")
                .ink(Role::Result, format!("{} px", vector(found.displacement)))
                .text(format!(": {} {} is the smallest of {} tested.", self.cost.label(), show(*found), self.tested())),
            (None, _) => said.text(format!(
                "Nothing has been searched yet: {} blocks of {} px wait. Step into the first.",
                self.pair.blocks.len(),
                self.pair.blocks.size
            )),
        }
    }

    fn why_candidate(&self, candidate: Match, rows: usize) -> Sentence {
        let block = self.block();
        let show = |found: Match| self.cost.show(found.sum, block);
        let said = Sentence::default()
            .text("Candidate ")
            .ink(Role::Candidate, vector(candidate.displacement))
            .text(format!(" costs {}", show(candidate)));
        let Some(best) = self.best() else {
            return said.text(", the first cost of this block.");
        };
        let best_shown = format!("{} at {}", show(best), vector(best.displacement));
        if rows < block.height {
            let given_up = format!(" after {rows} of {} rows, already more than the best, ", block.height);
            return said.text(given_up).ink(Role::Best, best_shown).text(": given up early.");
        }
        let verdict = match candidate.sum.cmp(&best.sum) {
            std::cmp::Ordering::Less => ", less than the best so far, ",
            std::cmp::Ordering::Equal => ", the same as the best so far, ",
            std::cmp::Ordering::Greater => ", more than the best so far, ",
        };
        let tie = candidate.sum == best.sum && !shorter(candidate.displacement, best.displacement);
        said.text(verdict).ink(Role::Best, best_shown).text(if tie { ", which is shorter and stays." } else { "." })
    }

    /// The numbers of the step.
    pub fn readouts(&self) -> Vec<Readout> {
        if self.events.is_empty() {
            return Vec::new();
        }
        let mut readouts = vec![Readout::Facts(self.facts())];
        if let Some((candidate, rows)) = self.shown() {
            readouts.push(Readout::Equation(self.equation(candidate, rows)));
            readouts.push(Readout::Tiles(self.tiles(candidate, rows)));
        }
        readouts.push(Readout::Surface(Surface {
            title: self.cost.label(),
            origin: self.window.min,
            values: self.costs(),
            probe: self.candidate().filter(|_| !self.is_over()).map(|(candidate, _)| candidate.displacement),
            best: self.best().map(|best| best.displacement),
        }));
        readouts.push(Readout::Series(self.series()));
        readouts
    }

    /// The candidate whose numbers are shown: the one under test, at the end the one that won.
    fn shown(&self) -> Option<(Match, usize)> {
        match self.events.last() {
            Some(Event::Found(found)) => Some((*found, self.block().height)),
            _ => self.candidate(),
        }
    }

    fn facts(&self) -> Vec<Fact> {
        let block = self.block();
        let mut facts = vec![
            Fact {
                label: "Block",
                value: format!("{} of {}, at ({}, {})", self.index + 1, self.pair.blocks.len(), block.x, block.y),
                role: Some(Role::Reference),
            },
            Fact { label: "Tested", value: format!("{} of {}", self.tested(), self.window.count()), role: None },
        ];
        let of = |found: Match| format!("{} at {} px", self.cost.show(found.sum, block), vector(found.displacement));
        if let Some((candidate, _)) = self.candidate().filter(|_| !self.is_over()) {
            facts.push(Fact { label: "Candidate", value: of(candidate), role: Some(Role::Candidate) });
        }
        if let Some(best) = self.best() {
            let label = if self.is_over() { "Displacement" } else { "Best so far" };
            let role = if self.is_over() { Role::Result } else { Role::Best };
            facts.push(Fact { label, value: of(best), role: Some(role) });
        }
        facts
    }

    /// The pixels of the block and of the candidate: `(frame t, frame t + 1)`.
    fn patches(&self, displacement: Displacement) -> (Cut, Cut) {
        let mut patch = Patch::default();
        patch.take(self.pair, self.block(), Window { min: displacement, size: (1, 1) });
        (patch.block, patch.area)
    }

    fn equation(&self, candidate: Match, rows: usize) -> Vec<Math> {
        let block = self.block();
        let (a, b) = self.patches(candidate.displacement);
        let [u, v] = candidate.displacement.map(signed);
        let name = || Math::text(format!("{}({u}, {v}) ", self.cost.label()));
        let sum = self.cost.sum();
        let (open, close) = if self.cost == Cost::Mse { ("1/N · ", "") } else { ("", "") };
        let difference = Math::Row(vec![
            Math::sub(Math::Var("I"), Math::Var("t")),
            Math::text("(x, y) − "),
            Math::sub(Math::Var("I"), Math::text("t+1")),
            Math::text(format!("(x {}, y {})", offset(candidate.displacement[0]), offset(candidate.displacement[1]))),
        ]);
        let general = vec![
            name(),
            Math::text(format!("= {open}")),
            Math::Sum(Box::new(Math::text("x, y"))),
            term(sum, difference),
            Math::text(close),
        ];
        let numbers = |x: usize, y: usize| {
            let pair = vec![
                Math::ink(Role::Reference, a.pixel(x, y).to_string()),
                Math::text(" − "),
                Math::ink(Role::Candidate, b.pixel(x, y).to_string()),
            ];
            term(sum, Math::Row(pair))
        };
        let last = (block.width - 1, rows - 1);
        let mut terms = vec![Math::text("= "), numbers(0, 0)];
        if block.width > 1 {
            terms.extend([Math::text(" + "), numbers(1, 0)]);
        }
        if last.0 > 1 || last.1 > 0 {
            terms.extend([Math::text(" + … + "), numbers(last.0, last.1)]);
        }
        let mut result = vec![Math::text(format!("= {}", candidate.sum))];
        if self.cost == Cost::Mse {
            let n = block.width * block.height;
            terms.insert(1, Math::text("1/N · ("));
            terms.push(Math::text(")"));
            result = vec![
                Math::text("= "),
                Math::Frac(Box::new(Math::text(candidate.sum.to_string())), Box::new(Math::text(n.to_string()))),
                Math::text(format!(" = {}", self.cost.show(candidate.sum, block))),
            ];
        }
        if rows < block.height {
            result.push(Math::text(format!("   (first {rows} of {} rows)", block.height)));
        }
        let mut lines = vec![Math::Row(general), Math::Row(terms), Math::Row(result)];
        lines.extend(self.focused_term(&a, &b));
        lines
    }

    /// The term of the pixel pointed at, if it lies in the block.
    fn focused_term(&self, a: &Cut, b: &Cut) -> Option<Math> {
        let block = self.block();
        let [x, y] = self.focus?.map(|c| c.round() as isize);
        let (i, j) = (x - block.x as isize, y - block.y as isize);
        let inside = (0..block.width as isize).contains(&i) && (0..block.height as isize).contains(&j);
        let (i, j) = inside.then_some((i as usize, j as usize))?;
        let (p, q) = (a.pixel(i, j), b.pixel(i, j));
        let sum = self.cost.sum();
        let numbers = vec![
            Math::ink(Role::Reference, p.to_string()),
            Math::text(" − "),
            Math::ink(Role::Candidate, q.to_string()),
        ];
        Some(Math::Row(vec![
            Math::text(format!("at pixel ({x}, {y}):  ")),
            term(sum, Math::Row(numbers)),
            Math::text(format!(" = {}", sum.term(p, q))),
        ]))
    }

    fn tiles(&self, candidate: Match, rows: usize) -> Vec<Tile> {
        let block = self.block();
        let (a, b) = self.patches(candidate.displacement);
        let sum = self.cost.sum();
        let grid = |f: &dyn Fn(usize, usize) -> f32| Grid::from_fn(block.width, block.height, f);
        let (label, top) = match sum {
            Sum::Absolute => ("|difference|", 255.0),
            Sum::Squared => ("difference²", 255.0 * 255.0),
        };
        let differences = grid(&|x, y| {
            if y < rows { sum.term(a.pixel(x, y), b.pixel(x, y)) as f32 } else { f32::NAN }
        });
        let tile = |label, role, values, top| Tile { label, role, values, range: [0.0, top] };
        vec![
            tile("block", Some(Role::Reference), grid(&|x, y| f32::from(a.pixel(x, y))), 255.0),
            tile("candidate", Some(Role::Candidate), grid(&|x, y| f32::from(b.pixel(x, y))), 255.0),
            tile(label, Some(Role::Error), differences, top),
        ]
    }

    fn series(&self) -> Series {
        let (mut tested, mut best) = (Vec::new(), Vec::new());
        for event in self.events {
            let last = tested.last().copied();
            match (*event, last) {
                (Event::Candidate { sum, .. }, _) => {
                    tested.push([tested.len() as f32 + 1.0, self.cost.of(sum, self.block())]);
                }
                (Event::NewBest { .. }, Some(point)) => best.push(point),
                _ => {}
            }
        }
        // The best stays what it is up to the last candidate.
        if let (Some([x, _]), Some([_, y])) = (tested.last().copied(), best.last().copied()) {
            best.push([x, y]);
        }
        Series {
            title: "Cost by candidate",
            x_label: "candidate",
            y_label: self.cost.label(),
            x_max: self.window.count(),
            lines: vec![("candidate", Role::Candidate, tested), ("best so far", Role::Best, best)],
        }
    }
}

fn offset(v: i32) -> String {
    let sign = if v < 0 { '−' } else { '+' };
    format!("{sign} {}", v.unsigned_abs())
}

fn term(sum: Sum, difference: Math) -> Math {
    match sum {
        Sum::Absolute => Math::Abs(Box::new(difference)),
        Sum::Squared => {
            let bracketed = Math::Row(vec![Math::text("("), difference, Math::text(")")]);
            Math::sup(bracketed, Math::text("2"))
        }
    }
}

/// The result so far of a search that found `found`, block by block.
pub(crate) fn output(pair: &Pair, cost: Cost, found: &[Match], candidates: u64) -> Output {
    let vector = |(i, found): (usize, &Match)| BlockVector {
        displacement: found.displacement.map(|c| c as f32),
        cost: cost.of(found.sum, pair.blocks.block(i)),
    };
    let mut vectors: Vec<_> = found.iter().enumerate().map(|entry| Some(vector(entry))).collect();
    vectors.resize(pair.blocks.len(), None);
    Output::Blocks(BlockField {
        blocks: pair.blocks,
        vectors,
        cost: cost.label(),
        candidates,
        border: pair.rule.border(),
    })
}
