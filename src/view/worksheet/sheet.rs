//! A worksheet on paper: the task, what is given, and room to write.

use std::sync::Arc;

use motionscope_core::scene::{Math, Matrix, Sentence, Shape};
use motionscope_core::{Role, Scene, Step};

use super::About;
use super::blanks::Exercise;
use super::grids::{Costs, Pixels};
use super::numbers::{is_telling, of};
use crate::paint::charts::explanation::{self, Block, Density, equation};
use crate::paint::charts::formula::has_blank;
use crate::paint::charts::prose::{Part, Prose, lay_out};
use crate::paint::charts::{ChartStyle, Type, matrices, plane, regions};
use crate::paint::primitive::Rect;
use crate::paint::{Face, Figure, FlowLayer, Layer, Sheet};
use crate::view::moment::Moment;
use crate::view::page::Stand;
use crate::view::panes::Selection;
use crate::view::paper::{Around, Paper, THEME, lines, ruled};
use crate::view::rendering::{Rendering, settings_text};

/// Points of paper for each point of a block.
const SCALE: f32 = 0.75;
/// Marks are as fine as in other pictures for print.
const DENSITY: u32 = 2;
/// Between two blocks, and between two tables beside each other.
const GAP: f32 = 16.0;
const TABLE_GAP: f32 = 12.0;
/// Size of the picture at most, and of a chart to draw into.
const PICTURE: [f32; 2] = [410.0, 250.0];
const CHART: [f32; 2] = [420.0, 300.0];
/// Lines to write on, and how far they are apart.
const LINES: usize = 3;
const APART: f32 = 27.0;

/// Lines of the algorithm before and behind the one at work.
const AROUND: usize = 3;

/// What a worksheet is made of.
pub(super) struct Content<'a> {
    pub about: About<'a>,
    pub stand: &'a Stand<'a>,
    pub moment: &'a Moment,
    pub step: &'a Step,
    pub exercise: &'a Exercise,
}

/// Blocks that are put below each other, on as many sheets as they need.
struct Flow {
    paper: Paper,
    room: Rect,
    y: f32,
}

impl Flow {
    fn new(mut paper: Paper) -> Self {
        let room = paper.begin();
        Self { paper, room, y: room.min[1] }
    }

    fn width(&self) -> f32 {
        self.room.size()[0] / SCALE
    }

    /// What is left of the sheet, in points of a block.
    fn left(&self) -> f32 {
        (self.room.max[1] - self.y) / SCALE
    }

    /// Begins another sheet unless a block of this height has room.
    fn keep(&mut self, height: f32) {
        if height > self.left() && self.y > self.room.min[1] {
            self.room = self.paper.begin();
            self.y = self.room.min[1];
        }
    }

    fn put(&mut self, block: Block, gap: f32) {
        if block.size[1] <= 0.0 {
            return;
        }
        self.keep(block.size[1]);
        let height = block.size[1];
        self.paper.put_block(block, [self.room.min[0], self.y], SCALE);
        self.y += (height + gap) * SCALE;
    }
}

impl Content<'_> {
    pub fn sheets(&self) -> Vec<Sheet> {
        let mut flow = Flow::new(Paper::new(self.around()));
        let width = flow.width();
        flow.put(self.intro(width), GAP);
        self.put_picture(&mut flow);
        let mut number = 0;
        for (task, blocks) in self.tasks(width) {
            number += 1;
            let mut head = heading(&format!("{number}  {task}"), Face::Bold, width);
            // A heading goes with what is below it.
            let mut rest = blocks.into_iter();
            if let Some(first) = rest.next() {
                head.put_below(first, 8.0);
            }
            flow.put(head, 8.0);
            rest.for_each(|block| flow.put(block, 8.0));
            flow.y += (GAP - 8.0) * SCALE;
        }
        self.end(&mut flow, width);
        flow.paper.into_sheets()
    }

    fn around(&self) -> Around {
        let Moment { cursor, clip, .. } = self.moment;
        let beside = if self.about.answers { "Answers" } else { "Name ____________________  Date ____________" };
        Around {
            title: if self.about.answers { "Worksheet with answers" } else { "Worksheet" }.into(),
            beside: beside.into(),
            foot: format!("Motionscope · {} · {clip}, step {cursor}", self.about.title),
        }
    }

    /// What the sheet is about: title, settings, and the words of the page that tell no result.
    fn intro(&self, width: f32) -> Block {
        let mut block = heading(self.about.title, Face::Bold, width);
        let estimator = self.stand.estimator();
        let name = estimator.info().name;
        let settings =
            format!("{name} on {}, frame {}. {}.", self.moment.clip, self.moment.frame, settings_text(estimator));
        block.put_below(paragraph(&settings, width), 4.0);
        if let Some(prose) = self.about.prose {
            block.put_below(lay_out(&self.untelling(prose), width, THEME.sizes().body, THEME).block, 8.0);
        }
        block
    }

    /// The parts of a text that have none of the answers.
    fn untelling(&self, prose: &Prose) -> Prose {
        let tells = |part: &&Part| {
            let text = Prose(vec![(*part).clone()]).plain();
            let numbers = of(&text);
            let mut answers = self.exercise.answers.iter().map(|answer| &answer.number);
            !answers.any(|answer| is_telling(answer) && numbers.contains(answer))
        };
        Prose(prose.0.iter().filter(tells).cloned().collect())
    }

    /// The picture, and the labelled numbers beside it.
    fn put_picture(&self, flow: &mut Flow) {
        let figure = self.picture();
        let size = figure.size;
        let beside = flow.width() - size[0] - GAP;
        let facts = self.facts(beside);
        flow.keep(size[1].max(facts.size[1]));
        let [x, y] = [flow.room.min[0], flow.y];
        let height = size[1].max(facts.size[1]);
        flow.paper.put(figure, [x, y], SCALE);
        flow.paper.put_block(facts, [x + (size[0] + GAP) * SCALE, y], SCALE);
        flow.y += (height + GAP) * SCALE;
    }

    /// The labelled numbers; those that are whole break into lines as words do.
    fn facts(&self, width: f32) -> Block {
        let mut block = Block::default();
        for fact in &self.exercise.facts {
            let is_whole = matches!(fact, Math::Row(parts) if parts.iter().all(|part| matches!(part, Math::Text(_, None))))
                && !has_blank(fact);
            let line = match is_whole {
                true => explanation::sentence(&Sentence::default().text(fact.plain()), (width, self.sentence()), THEME),
                false => equation(std::slice::from_ref(fact), (width, self.density()), THEME),
            };
            block.put_below(line, 2.0);
        }
        block
    }

    /// Formulas among words.
    fn density(&self) -> Density {
        Density { math: THEME.sizes().body, ..Density::close(THEME) }
    }

    /// The pictures of the step with the marks that are given.
    fn picture(&self) -> Figure {
        let mut moment = self.moment.clone();
        moment.scene = Arc::new(given(&moment.scene));
        let mut look = self.stand.look;
        look.layer = Some(FlowLayer::None);
        let panes = Selection::default();
        let estimator = self.stand.estimator();
        Rendering { moment: &moment, estimator, look: &look, panes: &panes }.stage_in(PICTURE, DENSITY)
    }

    /// Each task with what it is about.
    fn tasks(&self, width: f32) -> Vec<(String, Vec<Block>)> {
        let Exercise { equation: formulas, matrices, before, grids, plane, regions, .. } = self.exercise;
        let mut tasks = Vec::new();
        if let Some(pixels) = &grids.tiles {
            tasks.push(self.pixels(pixels, width));
        }
        if !formulas.is_empty() {
            let density = Density { math: THEME.sizes().heading, ..Density::close(THEME) };
            let has_blanks = self.exercise.answers.iter().any(|answer| answer.part == super::blanks::Part::Equation);
            let task = if has_blanks { "Complete the formula." } else { "The formula of this step" };
            tasks.push((task.into(), vec![equation(formulas, (width, density), THEME)]));
        }
        if let Some(histogram) = &grids.histogram {
            tasks.push(("The histograms of this step".into(), vec![histogram.draw(THEME)]));
        }
        if !matrices.is_empty() {
            tasks.push(self.matrices((matrices, before), width));
        }
        if let Some(Costs { table, best }) = &grids.surface {
            let mut block = table.draw(THEME);
            if let Some(best) = best {
                block.put_below(equation(std::slice::from_ref(best), (width, self.density()), THEME), 8.0);
            }
            tasks.push(("Enter the missing costs and find the displacement of minimum cost.".into(), vec![block]));
        }
        if let Some((data, names)) = plane {
            let data = plane::Shown { plane: data, whose: "", window: None };
            let layers = plane::draw(data, Rect::new([0.0; 2], CHART), self.style()).into_layers();
            tasks.push((format!("Draw into the plane: {}.", names.join(", ")), vec![chart(layers)]));
        }
        if let Some((data, names)) = regions {
            let data = regions::Shown { regions: data, whose: "" };
            let layers = regions::draw(data, Rect::new([0.0; 2], CHART), self.style()).into_layers();
            tasks.push((format!("Mark in the diagram: {}.", names.join(", ")), vec![chart(layers)]));
        }
        tasks
    }

    fn style(&self) -> ChartStyle {
        ChartStyle { theme: THEME, colors: self.stand.look.colors, density: DENSITY as f32 }
    }

    fn pixels(&self, Pixels { tables, rest, has_blanks }: &Pixels, width: f32) -> (String, Vec<Block>) {
        let mut rows = vec![Block::default()];
        for table in tables {
            let block = table.draw(THEME);
            let row = rows.last().map_or([0.0; 2], |row| row.size);
            let fits = row[0] == 0.0 || row[0] + TABLE_GAP + block.size[0] <= width;
            if !fits {
                rows.push(Block::default());
            }
            if let Some(row) = rows.last_mut() {
                beside(row, block);
            }
        }
        rows.extend(rest.iter().map(|rest| equation(std::slice::from_ref(rest), (width, self.density()), THEME)));
        let has_sums = tables.iter().any(|table| !table.columns.is_empty());
        let task = match (has_blanks, has_sums) {
            (true, true) => "Compute the differences of the last row, and the sum of their magnitudes.",
            (true, false) => "Compute the differences of the last row.",
            (false, _) => "Gray levels of the windows",
        };
        (task.into(), rows)
    }

    fn matrices(&self, (all, before): (&[Matrix], &[Matrix]), width: f32) -> (String, Vec<Block>) {
        let draw = |title: &str, matrices: &[Matrix]| {
            let area = Rect::new([0.0; 2], [width, 900.0]);
            let drawing = matrices::draw_with_blanks(matrices, area, self.style());
            let size = drawing.place.iter().fold([0.0f32; 2], |size, rect| [0, 1].map(|i| size[i].max(rect.max[i])));
            let mut block = heading(title, Face::Sans, width);
            let primitives = drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect();
            let told = |matrix| (Rect::new([0.0; 2], size), matrices::plain_with_blanks(matrix));
            let lines = matrices.iter().map(told).collect();
            block.put_below(Block { size, primitives, lines, ..Block::default() }, 4.0);
            block
        };
        let mut blocks = Vec::new();
        if !before.is_empty() {
            blocks.push(draw("Before the step", before));
        }
        let title = if before.is_empty() { "In this step" } else { "After the step" };
        blocks.push(draw(title, all));
        let has_blanks = self.exercise.answers.iter().any(|answer| answer.part == super::blanks::Part::Matrices);
        let task = if has_blanks { "Compute the empty entries." } else { "The matrices of this step" };
        (task.into(), blocks)
    }

    /// Room to write; or why, and the line of the algorithm.
    fn end(&self, flow: &mut Flow, width: f32) {
        if self.about.answers {
            let mut why = heading("Why", Face::Bold, width);
            why.put_below(explanation::sentence(&self.step.sentence, (width, self.sentence()), THEME), 6.0);
            flow.put(why, GAP);
            let info = self.stand.estimator().info();
            let at_work = info.line(self.step.line).unwrap_or_default();
            let lines = at_work.saturating_sub(AROUND)..(at_work + AROUND + 1).min(info.pseudocode.len());
            flow.put(explanation::pseudocode(info, self.step, (lines, width), THEME), 0.0);
            return;
        }
        let mut why = heading("Why? Explain the result in a sentence.", Face::Bold, width);
        why.put_below(ruled(2, width, APART), 0.0);
        let why_height = why.size[1] + GAP;
        let mut space = heading("Calculation", Face::Bold, width);
        flow.keep(why_height + APART * (LINES + 1) as f32);
        // As many as the sheet has room for.
        let count = ((flow.left() - why_height - 2.0 * GAP - space.size[1]) / APART).max(LINES as f32) as usize;
        space.put_below(ruled(count, width, APART), 0.0);
        flow.put(space, GAP);
        flow.put(why, 0.0);
    }

    fn sentence(&self) -> Density {
        Density { words: THEME.sizes().body, ..Density::close(THEME) }
    }
}

/// The marks of a scene that are no results.
fn given(scene: &Scene) -> Scene {
    let is_given = |role: Role| !matches!(role, Role::Result | Role::Best | Role::Estimate | Role::Error | Role::Truth);
    let mut scene = scene.clone();
    scene.marks.retain(|mark| is_given(mark.role) && !matches!(mark.shape, Shape::Text { .. } | Shape::Heat { .. }));
    scene.links.retain(|link| is_given(link.role));
    scene.legend.retain(|(role, _)| is_given(*role));
    scene
}

/// Words above a part of the sheet.
fn heading(text: &str, face: Face, width: f32) -> Block {
    lines(text, Type { face, size: THEME.sizes().body, ..Type::text(THEME) }, width)
}

/// A paragraph.
fn paragraph(text: &str, width: f32) -> Block {
    let sentence = Sentence::default().text(text);
    let density = Density { words: THEME.sizes().small, ..Density::close(THEME) };
    explanation::sentence(&sentence, (width, density), THEME)
}

/// Puts `other` right of what `row` has.
fn beside(row: &mut Block, other: Block) {
    let x = if row.size[0] > 0.0 { row.size[0] + TABLE_GAP } else { 0.0 };
    let Block { size, primitives, lines, .. } = other.moved([x, 0.0]);
    row.size = [x + size[0], row.size[1].max(size[1])];
    row.primitives.extend(primitives);
    row.lines.extend(lines);
}

/// A chart as a block.
fn chart(layers: Vec<Layer>) -> Block {
    let primitives = layers.into_iter().flat_map(|layer| layer.primitives).collect();
    Block { size: CHART, primitives, ..Block::default() }
}
