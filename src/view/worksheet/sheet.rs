//! A worksheet on paper: the task, what is given, and room to write.

use std::sync::Arc;

use motionscope_core::scene::{Mark, Math, Matrix, Role, Scene, Sentence, Shape, Step};

use super::About;
use super::blanks::{Exercise, Part as Place};
use super::decision::Decision;
use super::grids::{Captioned, Costs};
use super::numbers::{of, tells};
use super::settings::settings;
use super::windows::{Pixels, Windows};
use crate::paint::charts::explanation::{self, Block, Density, Light, equation};
use crate::paint::charts::formula::{has_blank, typeset};
use crate::paint::charts::prose::{Part, Prose, lay_out};
use crate::paint::charts::{Canvas, ChartStyle, Type, matrices, plane, regions};
use crate::paint::primitive::Rect;
use crate::paint::{Face, Figure, FlowLayer, Layer, Sheet};
use crate::view::moment::Moment;
use crate::view::page::Stand;
use crate::view::panes::Selection;
use crate::view::paper::{Around, Paper, THEME, lines, ruled};
use crate::view::rendering::Rendering;

/// Points of paper for each point of a block.
const SCALE: f32 = 0.75;
/// Marks are as fine as in other pictures for print.
const DENSITY: u32 = 2;
/// Between two blocks, between the blocks of a task, and between two tables beside each other.
const GAP: f32 = 16.0;
const WITHIN: f32 = 8.0;
const TABLE_GAP: f32 = 12.0;
/// Size of the picture at most, and of a chart to draw into.
const PICTURE: [f32; 2] = [410.0, 250.0];
const CHART: [f32; 2] = [560.0, 300.0];
/// Lines to calculate on: at least, for each number that is asked for, at most; and how far they are apart.
const LINES: usize = 3;
const LINES_EACH: usize = 2;
const MOST_LINES: usize = 14;
const APART: f32 = 27.0;
/// Why a calculation with the numbers on the sheet may end in another digit than its answer.
pub(super) const PRECISION: &str = "The program computes with more digits than it prints: the last digit may differ.";

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

    /// Puts the `blocks` of a task. As many of the last ones as one sheet has room for stay on a sheet with what `follows`, of this
    /// height.
    fn put_task(&mut self, blocks: Vec<Block>, follows: Option<f32>) {
        let heights: Vec<f32> = blocks.iter().map(|block| block.size[1] + WITHIN).collect();
        let left_from = |from: usize| heights[from..].iter().sum::<f32>() + GAP - WITHIN;
        let whole = Paper::room().size()[1] / SCALE;
        let fits = |from: &usize| follows.is_some_and(|follows| left_from(*from) + follows <= whole);
        let first = (0..heights.len()).find(fits);
        for (index, block) in blocks.into_iter().enumerate() {
            if first == Some(index) {
                self.keep(left_from(index) + follows.unwrap_or_default());
            }
            self.put(block, WITHIN);
        }
        self.y += (GAP - WITHIN) * SCALE;
    }
}

impl Content<'_> {
    pub fn sheets(&self) -> Vec<Sheet> {
        let mut flow = Flow::new(Paper::new(self.around()));
        let width = flow.width();
        flow.put(self.intro(width), GAP);
        self.put_picture(&mut flow);
        if self.exercise.asks_decimals() {
            flow.put(paragraph(PRECISION, width), GAP);
        }
        let tasks: Vec<_> = self.tasks(width).into_iter().zip(1..).map(|task| numbered(task, width)).collect();
        let last = tasks.len();
        for (blocks, number) in tasks.into_iter().zip(1..) {
            // No sheet has nothing but lines: the last task goes with them.
            let has_lines = number == last && !self.about.answers;
            flow.put_task(blocks, has_lines.then(|| self.room_to_write(0.0, width).size[1]));
        }
        self.put_end(&mut flow, width);
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
        let on = format!("{name} on {}, frame {}", self.moment.clip, self.moment.frame);
        let parts = [on, settings(estimator)];
        let told: Vec<&str> = parts.iter().map(String::as_str).filter(|part| !part.is_empty()).collect();
        block.put_below(paragraph(&told.join(" · "), width), 4.0);
        if let Some(prose) = self.about.prose {
            block.put_below(lay_out(&self.untelling(prose), width, THEME.sizes().body, THEME).block, 8.0);
        }
        block
    }

    /// The parts of a text that have none of the answers. What has the numbers of this step tells what is decided of it.
    fn untelling(&self, prose: &Prose) -> Prose {
        let answers = self.exercise.answers.iter().map(|answer| answer.number.clone());
        let decision = self.exercise.decision.as_ref();
        let decisive = self.step.facts().iter().filter(|_| decision.is_some()).flat_map(|fact| of(&fact.value));
        let telling: Vec<String> = answers.chain(decisive).collect();
        let is_given = |part: &&Part| {
            let text = Prose(vec![(*part).clone()]).plain();
            let is_told = decision.is_some_and(|decision| decision.is_told_by(&text));
            !is_told && !of(&text).iter().any(|number| tells(number, &telling))
        };
        Prose(prose.0.iter().filter(is_given).cloned().collect())
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
                false => {
                    equation(in_lines(fact, (self.density().math, width)).as_slice(), (width, self.density()), THEME)
                }
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
        moment.scene = Arc::new(given(&moment.scene, self.exercise.decision.is_some()));
        let mut look = self.stand.look;
        look.layer = Some(FlowLayer::None);
        let panes = Selection::default();
        let estimator = self.stand.estimator();
        Rendering { moment: &moment, estimator, look: &look, panes: &panes }.stage_in(PICTURE, DENSITY)
    }

    /// Each task with what it is about.
    fn tasks(&self, width: f32) -> Vec<(String, Vec<Block>)> {
        let Exercise { equation: formulas, matrices, before, grids, decision, .. } = self.exercise;
        let mut tasks = Vec::new();
        tasks.extend(grids.tiles.as_ref().map(|pixels| self.pixels(pixels, width)));
        if !formulas.lines.is_empty() {
            let density = Density { math: THEME.sizes().heading, ..Density::close(THEME) };
            let task =
                if self.asks_for(Place::Equation) { "Complete the formula." } else { "The formula of this step" };
            tasks.push((task.into(), vec![equation(&formulas.lines, (width, density), THEME)]));
        }
        if !matrices.is_empty() {
            tasks.push(self.matrices((matrices, before), width));
        }
        if let Some(Costs { costs, best, task }) = &grids.surface {
            let mut block = captioned(costs, width);
            if let Some(best) = best {
                block.put_below(equation(std::slice::from_ref(best), (width, self.density()), THEME), 8.0);
            }
            tasks.push(((*task).into(), vec![block]));
        }
        tasks.extend(self.drawings());
        tasks.extend(decision.as_ref().map(|decision| self.decision(decision, width)));
        if self.exercise.asks_line {
            tasks.push(("Which line of the algorithm is this step? Mark it.".into(), vec![self.algorithm(width)]));
        }
        tasks
    }

    /// What is to be drawn.
    fn drawings(&self) -> Vec<(String, Vec<Block>)> {
        let Exercise { plane, regions, .. } = self.exercise;
        let mut tasks = Vec::new();
        if let Some((data, names)) = plane {
            let data = plane::Shown { plane: data, whose: "", window: None, has_names_beside: true };
            let layers = plane::draw(data, Rect::new([0.0; 2], CHART), self.style()).into_layers();
            tasks.push((format!("Draw {} into the plane.", points(names)), vec![chart(layers)]));
        }
        if let Some((data, names)) = regions {
            let data = regions::Shown { regions: data, whose: "" };
            let layers = regions::draw(data, Rect::new([0.0; 2], CHART), self.style()).into_layers();
            tasks.push((format!("Mark {} in the diagram.", points(names)), vec![chart(layers)]));
        }
        tasks
    }

    /// Whether a part of the sheet has numbers to be computed.
    fn asks_for(&self, part: Place) -> bool {
        self.exercise.answers.iter().any(|answer| answer.part == part)
    }

    /// The question that the step answers, with its answers to tick.
    fn decision(&self, decision: &Decision, width: f32) -> (String, Vec<Block>) {
        let mut block = Block::default();
        for (index, words) in decision.choices.iter().enumerate() {
            let is_ticked = self.about.answers && index == decision.right;
            block.put_below(choice(words, is_ticked, width), 5.0);
        }
        (decision.text.clone(), vec![block])
    }

    /// The lines of the algorithm; the one at work is lit in the answers.
    fn algorithm(&self, width: f32) -> Block {
        let info = self.stand.estimator().info();
        if self.about.answers {
            return explanation::pseudocode(info, self.step, (0..info.pseudocode.len(), width), THEME);
        }
        let mut block = Block::default();
        for line in info.pseudocode {
            block.put_below(explanation::code_line(line.text, Light::Other, width, THEME), 0.0);
        }
        block
    }

    fn style(&self) -> ChartStyle {
        ChartStyle { theme: THEME, colors: self.stand.look.colors, density: DENSITY as f32 }
    }

    fn pixels(&self, pixels: &Pixels, width: f32) -> (String, Vec<Block>) {
        let mut rows: Vec<Block> = Vec::new();
        for Windows { tables, rest } in &pixels.windows {
            rows.push(Block::default());
            for block in tables.iter().map(|table| table.draw(THEME)) {
                let row = rows.last().map_or([0.0; 2], |row| row.size);
                if row[0] > 0.0 && row[0] + TABLE_GAP + block.size[0] > width {
                    rows.push(Block::default());
                }
                if let Some(row) = rows.last_mut() {
                    beside(row, block);
                }
            }
            rows.extend(rest.iter().map(|rest| equation(std::slice::from_ref(rest), (width, self.density()), THEME)));
        }
        // The words stay with what they are about.
        if let (Some(part), Some(first)) = (&pixels.part, rows.first_mut()) {
            let mut block = paragraph(part, width);
            block.put_below(std::mem::take(first), 8.0);
            *first = block;
        }
        (pixels.task.clone(), rows)
    }

    fn matrices(&self, (all, before): (&[Matrix], &[Matrix]), width: f32) -> (String, Vec<Block>) {
        let draw = |title: Option<&str>, matrices: &[Matrix]| {
            let area = Rect::new([0.0; 2], [width, 900.0]);
            let drawing = matrices::draw_with_blanks(matrices, area, self.style());
            let size = drawing.place.iter().fold([0.0f32; 2], |size, rect| [0, 1].map(|i| size[i].max(rect.max[i])));
            let mut block = title.map(|title| heading(title, Face::Sans, width)).unwrap_or_default();
            let primitives = drawing.into_layers().into_iter().flat_map(|layer| layer.primitives).collect();
            let told = |matrix| (Rect::new([0.0; 2], size), matrices::plain_with_blanks(matrix));
            let lines = matrices.iter().map(told).collect();
            block.put_below(Block { size, primitives, lines, ..Block::default() }, 4.0);
            block
        };
        let mut blocks = Vec::new();
        if !before.is_empty() {
            blocks.push(draw(Some("Before the step"), before));
        }
        let after = (!before.is_empty()).then_some("After the step");
        blocks.push(draw(after, all));
        let task =
            if self.asks_for(Place::Matrices) { "Compute the empty entries." } else { "The matrices of this step" };
        (task.into(), blocks)
    }

    /// Room to write; or why, and the line of the algorithm.
    fn put_end(&self, flow: &mut Flow, width: f32) {
        if self.about.answers {
            flow.put(self.explanation(width), 0.0);
            return;
        }
        flow.keep(self.room_to_write(0.0, width).size[1]);
        flow.put(self.room_to_write(flow.left(), width), 0.0);
    }

    /// Why the result is what it is, and the line of the algorithm unless a task has it.
    fn explanation(&self, width: f32) -> Block {
        let mut block = heading("Why", Face::Bold, width);
        block.put_below(explanation::sentence(&self.step.sentence, (width, self.sentence()), THEME), 6.0);
        if !self.exercise.asks_line {
            let info = self.stand.estimator().info();
            let at_work = info.line(self.step.line).unwrap_or_default();
            let lines = at_work.saturating_sub(AROUND)..(at_work + AROUND + 1).min(info.pseudocode.len());
            block.put_below(explanation::pseudocode(info, self.step, (lines, width), THEME), GAP);
        }
        block
    }

    /// Room to calculate where numbers are asked for, and to explain, where so much is `left` of a sheet.
    fn room_to_write(&self, left: f32, width: f32) -> Block {
        let mut why = heading("Why? Explain the result in a sentence.", Face::Bold, width);
        why.put_below(ruled(2, width, APART), 0.0);
        let mut block = heading("Calculation", Face::Bold, width);
        let room = left - block.size[1] - GAP - why.size[1];
        let count = lines_for(self.exercise.count(), room);
        if count == 0 {
            return why;
        }
        block.put_below(ruled(count, width, APART), 0.0);
        block.put_below(why, GAP);
        block
    }

    fn sentence(&self) -> Density {
        Density { words: THEME.sizes().body, ..Density::close(THEME) }
    }
}

/// The lines for the calculation of this many numbers in the `room` that is left.
fn lines_for(numbers: usize, room: f32) -> usize {
    if numbers == 0 {
        return 0;
    }
    let wanted = (LINES_EACH * numbers).clamp(LINES, MOST_LINES);
    // The last line is as thick as others.
    (((room - 2.0) / APART).max(0.0) as usize).clamp(LINES, wanted)
}

/// A task with its number: its heading goes with what is below it.
fn numbered(((task, blocks), number): ((String, Vec<Block>), usize), width: f32) -> Vec<Block> {
    let mut head = heading(&format!("{number}  {task}"), Face::Bold, width);
    let mut rest = blocks.into_iter();
    if let Some(first) = rest.next() {
        head.put_below(first, WITHIN);
    }
    std::iter::once(head).chain(rest).collect()
}

/// The marks of a scene that are no results; where it `is_decided`, neither is what was rejected.
fn given(scene: &Scene, is_decided: bool) -> Scene {
    let is_given = |role: Role| match role {
        Role::Result | Role::Best | Role::Estimate | Role::Error | Role::Truth => false,
        Role::Rejected => !is_decided,
        _ => true,
    };
    let mut scene = scene.clone();
    // The ellipse of a gate shows what lies within it.
    let tells = |mark: &Mark| is_decided && mark.role == Role::Window && matches!(mark.shape, Shape::Ellipse { .. });
    scene.marks.retain(|mark| {
        !tells(mark) && is_given(mark.role) && !matches!(mark.shape, Shape::Text { .. } | Shape::Heat { .. })
    });
    scene.links.retain(|link| is_given(link.role));
    scene.legend.retain(|(role, _)| is_given(*role));
    scene
}

/// A label with its value; below each other where they are wider than `width` points in type of this size.
fn in_lines(fact: &Math, (size, width): (f32, f32)) -> Vec<Math> {
    match fact {
        Math::Row(parts) if typeset(fact, size, f32::INFINITY).size()[0] > width => match parts.split_first() {
            Some((label, value)) => vec![label.clone(), Math::Row(value.to_vec())],
            None => Vec::new(),
        },
        fact => vec![fact.clone()],
    }
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

/// A table below words of its own.
fn captioned(of: &Captioned, width: f32) -> Block {
    let mut block = paragraph(&of.caption, width);
    block.put_below(of.table.draw(THEME), 0.0);
    block
}

/// An answer to choose: a box, filled if it is ticked, and its words.
fn choice(words: &str, is_ticked: bool, width: f32) -> Block {
    let text = Type { size: THEME.sizes().body, ..Type::text(THEME) };
    let style = if is_ticked { text.face(Face::Bold).color(THEME.word(Role::Result)) } else { text };
    let (indent, side) = (1.8 * text.size, 0.9 * text.size);
    let square = Rect::new([1.0, 0.15 * text.size], [side; 2]);
    let mut canvas = Canvas::default();
    canvas.frame(square, 1.2, text.color);
    if is_ticked {
        canvas.fill(square.grown(-0.2 * side), style.color);
    }
    let words = lines(words, style, width - indent).moved([indent, 0.0]);
    let size = [width, words.size[1].max(1.3 * text.size)];
    let primitives = canvas.into_primitives().into_iter().chain(words.primitives).collect();
    Block { size, primitives, lines: words.lines, ..Block::default() }
}

/// Points of a chart by their names.
fn points(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("“{name}”")).collect();
    match quoted.split_last() {
        Some((last, [])) => format!("the point {last}"),
        Some((last, others)) => format!("the points {} and {last}", others.join(", ")),
        None => String::new(),
    }
}

/// A chart as a block.
fn chart(layers: Vec<Layer>) -> Block {
    let primitives = layers.into_iter().flat_map(|layer| layer.primitives).collect();
    Block { size: CHART, primitives, ..Block::default() }
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Picture;

    use super::*;

    #[test]
    fn there_are_lines_to_calculate_on_for_what_is_asked_and_no_more() {
        let sheet = Paper::room().size()[1] / SCALE;
        assert_eq!(lines_for(0, sheet), 0, "nothing is computed");
        assert_eq!([1, 3, 50].map(|numbers| lines_for(numbers, sheet)), [3, 6, MOST_LINES]);
        assert_eq!(lines_for(50, 0.0), LINES);
        assert_eq!(lines_for(50, 5.0 * APART + 3.0), 5, "as many as the sheet has room for");
    }

    #[test]
    fn a_task_is_kept_with_what_follows_as_far_as_a_sheet_has_room() {
        let around = Around { title: String::new(), beside: String::new(), foot: String::new() };
        let count = |heights: &[f32], follows: Option<f32>| {
            let mut flow = Flow::new(Paper::new(around.clone()));
            flow.y += 300.0;
            let block = |height: &f32| Block { size: [10.0, *height], ..Block::default() };
            flow.put_task(heights.iter().map(block).collect(), follows);
            flow.paper.into_sheets().len()
        };
        assert_eq!(count(&[500.0], None), 1, "the task alone has room");
        assert_eq!([count(&[100.0], Some(200.0)), count(&[500.0], Some(200.0))], [1, 2]);
        assert_eq!(count(&[500.0, 10.0], Some(500.0)), 2, "the last block at least");
    }

    #[test]
    fn what_was_rejected_is_not_shown_where_that_is_decided() {
        let mut scene = Scene::default();
        for role in [Role::Rejected, Role::Window, Role::Result] {
            scene.mark(Picture::CURRENT, role, Shape::Points(vec![[1.0, 2.0]]));
        }
        let roles = |is_decided| {
            let given = given(&scene, is_decided);
            given.marks.iter().map(|mark| mark.role).collect::<Vec<_>>()
        };
        assert_eq!(roles(false), [Role::Rejected, Role::Window]);
        assert_eq!(roles(true), [Role::Window]);
        scene.mark(
            Picture::CURRENT,
            Role::Window,
            Shape::Ellipse { center: [4.0; 2], radii: [2.0; 2], angle_rad: 0.0 },
        );
        assert_eq!([false, true].map(|is_decided| given(&scene, is_decided).marks.len()), [3, 1], "nor is a gate");
    }

    #[test]
    fn points_are_called_by_the_names_that_they_have_in_the_chart() {
        let named = |names: &[&str]| points(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!(named(&["after"]), "the point “after”");
        assert_eq!(named(&["mean 1", "mean 2", "mean 3"]), "the points “mean 1”, “mean 2” and “mean 3”");
    }
}
