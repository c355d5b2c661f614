//! The steps of the labelling in values, words and marks.

use std::sync::Arc;

use super::{ConnectedComponents, Event, MaskedFrame, State, forest, line};
use crate::data::{LabelEvent, Run};
use crate::geometry::Grid;
use crate::methods::subtraction::{self, MaskHistory, plots, put_blobs};
use crate::run::Seen;
use crate::scene::{Arrow, Number, Picture, Readout, Role, Scene, Shape, Step, Unit};

/// The maximum number of labels listed with their parents.
const LISTED: usize = 24;

crate::variables! {
    /// The runs of foreground pixels labelled so far.
    RUNS: "Runs", "", Unit::count("run");
    /// The provisional labels so far.
    LABELS: "Labels", "", Unit::count("provisional label");
    /// The labels that are no child of another.
    ROOTS: "Roots", "", Unit::count("root"), Role::Result;
    /// The label of the pixel that is pointed at.
    LABEL_THERE: "Label", "", Unit::WHOLE, Role::Reference;
    /// The root of that label.
    ROOT_THERE: "Root", "", Unit::WHOLE, Role::Reference;
    /// The parent of each label.
    FOREST: "Label → parent", "", Unit::WHOLE;
    /// The current row.
    ROW: "", "", Unit::WHOLE;
    /// The foreground pixels of the current row.
    ROW_PIXELS: "", "", Unit::count("foreground pixel");
    /// The first of the rows above that have no foreground.
    FIRST_EMPTY_ROW: "", "", Unit::WHOLE;
    /// The last of the rows above that have no foreground.
    LAST_EMPTY_ROW: "", "", Unit::WHOLE;
    /// The first pixel of the current run.
    START: "", "", Unit::WHOLE, Role::Candidate;
    /// The last pixel of the current run.
    END: "", "", Unit::WHOLE, Role::Candidate;
    /// The first pixel of the touching run above.
    START_ABOVE: "", "", Unit::WHOLE, Role::Reference;
    /// The last pixel of the touching run above.
    END_ABOVE: "", "", Unit::WHOLE, Role::Reference;
    /// The row above.
    ROW_ABOVE: "", "", Unit::WHOLE, Role::Reference;
    /// The label of the current run.
    LABEL: "", "", Unit::WHOLE, Role::Best;
    /// The label of the run above.
    LABEL_ABOVE: "", "", Unit::WHOLE, Role::Best;
    /// The root of a union.
    ROOT: "", "", Unit::WHOLE, Role::Measured;
    /// The root that becomes a child.
    CHILD: "", "", Unit::WHOLE, Role::Measured;
}

crate::cases! { over value;
    OPENING: "Each run of foreground pixels takes the label of a run that it touches in the row above. Where two labels meet, \
              union–find makes them equivalent.",
    ROW_PASSED: "Row {first_empty_row} has no foreground pixels.",
    ROWS_PASSED: "Rows {first_empty_row} to {last_empty_row} have no foreground pixels.",
    EMPTY_ROW: "Row {row} has no foreground pixels.",
    ROW: "Row {row} has {row_pixels}.",
    RUN: "{candidate|Pixels} {start} {candidate|to} {end} {candidate|of row} {row} touch",
    PIXEL: "{candidate|Pixel} {start} {candidate|of row} {row} touches",
    RUN_ABOVE: "{reference|pixels} {start_above} {reference|to} {end_above} {reference|of row} {row_above}",
    PIXEL_ABOVE: "{reference|pixel} {start_above} {reference|of row} {row_above}",
    NEW_LABEL: "no run of the row above, so a new label starts: {best|label} {label}.",
    TAKE: "and take {best|label} {label}",
    TAKES: "and takes {best|label} {label}",
    ROOT_OF: ", the root of label {label_above}.",
    SAME_ROOT: "too. Both have the same root, so no union is needed.",
    UNION: "too, which have another root. Union: {measured|label} {child} {measured|becomes a child of label} {root}.",
    NUMBERED: "{labels} with {roots}. Each root is a connected component, numbered in raster order of its first pixel.",
}

/// Tells the rows without foreground directly above the current one: moves pass them.
fn tell_empty_rows(step: Step, state: &State) -> Step {
    let first = state.labelling.runs().last().map_or(0, |run| run.y as usize + 1);
    let last = state.row.saturating_sub(1);
    let step = step.put(value::ROW, state.row).put(value::FIRST_EMPTY_ROW, first).put(value::LAST_EMPTY_ROW, last);
    match state.row.saturating_sub(first) {
        0 => step,
        1 => step.say(case::ROW_PASSED),
        _ => step.say(case::ROWS_PASSED),
    }
}

/// Whether a run is a single pixel.
fn is_one(run: &Run) -> bool {
    run.end - run.start == 1
}

fn touches(step: Step, run: &Run) -> Step {
    let step = step
        .put(value::START, run.start)
        .put(value::END, run.end - 1)
        .put_value(value::ROW.is(run.y).inked(Role::Candidate));
    step.put(value::LABEL, run.label + 1).say(if is_one(run) { case::PIXEL } else { case::RUN })
}

/// Tells that the current run touches a run of the row above.
fn touches_above(step: Step, run: &Run, above: &Run) -> Step {
    let step = touches(step, run).put(value::START_ABOVE, above.start).put(value::END_ABOVE, above.end - 1);
    let step = step.put(value::ROW_ABOVE, above.y).put(value::LABEL_ABOVE, above.label + 1);
    step.say(if is_one(above) { case::PIXEL_ABOVE } else { case::RUN_ABOVE })
}

/// The labelling up to the cursor.
struct Labels {
    runs: Vec<Run>,
    parents: Vec<u32>,
}

impl Labels {
    fn new(seen: &Seen<ConnectedComponents>) -> Self {
        let before = &seen.before.labelling;
        let (mut runs, mut parents) = (before.runs().to_vec(), before.parents().to_vec());
        for event in seen.events {
            let Event::Run(event) = event else { continue };
            match event {
                LabelEvent::Made(run) => {
                    parents.push(run.label);
                    runs.push(*run);
                }
                LabelEvent::Took(run, _) => runs.push(*run),
                LabelEvent::Met(..) => {}
                LabelEvent::Merged(_, _, [root, child]) => parents[*child as usize] = *root,
            }
        }
        Self { runs, parents }
    }

    fn root(&self, mut label: u32) -> u32 {
        while self.parents[label as usize] != label {
            label = self.parents[label as usize];
        }
        label
    }

    /// The root of each labelled pixel, from 1.
    fn labels(&self, (width, height): (usize, usize)) -> Grid<u32> {
        let mut grid = Grid::new(width, height, 0);
        for run in &self.runs {
            grid.row_mut(run.y as usize)[run.start as usize..run.end as usize].fill(self.root(run.label) + 1);
        }
        grid
    }

    fn roots(&self) -> usize {
        self.parents.iter().enumerate().filter(|(label, parent)| *label == **parent as usize).count()
    }

    /// Puts the labelling, and the label and the root of the pixel that is pointed at.
    fn put(&self, step: Step, seen: &Seen<ConnectedComponents>) -> Step {
        let step = step.fact(subtraction::value::FRAME, seen.before.frame).fact(value::RUNS, self.runs.len());
        let step = step.fact(value::LABELS, self.parents.len()).fact(value::ROOTS, self.roots());
        let (width, height) = seen.before.picture;
        let point = seen.point().map(|point| point.map(|c| (c + 0.5).floor()));
        let inside = point.filter(|[x, y]| (0.0..width as f32).contains(x) && (0.0..height as f32).contains(y));
        let step = match inside.map(|point| point.map(|c| c as u32)) {
            None => step,
            Some([x, y]) => {
                let run = self.runs.iter().find(|run| run.y == y && (run.start..run.end).contains(&x));
                let label = run.map_or(Number::from("none"), |run| (run.label + 1).into());
                let root = run.map(|run| self.root(run.label) + 1);
                step.fact(subtraction::value::PIXEL, [x, y])
                    .fact(value::LABEL_THERE, label)
                    .fact_if(value::ROOT_THERE, root)
            }
        };
        step.fact(value::FOREST, self.forest())
    }

    /// The parent of each label; of many labels, the last ones.
    fn forest(&self) -> String {
        let skipped = self.parents.len().saturating_sub(LISTED);
        let of = |(label, parent): (usize, &u32)| match label == *parent as usize {
            true => format!("{}", label + 1),
            false => format!("{} → {}", label + 1, parent + 1),
        };
        let all: Vec<_> = self.parents.iter().enumerate().skip(skipped).map(of).collect();
        match (&all[..], skipped) {
            ([], _) => "none".into(),
            (all, 0) => all.join(", "),
            (all, _) => format!("…, {}", all.join(", ")),
        }
    }
}

impl ConnectedComponents {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let (state, labels) = (seen.before, Labels::new(seen));
        let Some(event) = seen.events.last() else { return Step::at(line::EACH_ROW).say(case::OPENING) };
        let at = |line| labels.put(Step::at(line), seen);
        let mut union = None;
        let step = match event {
            Event::Row(_, 0) => at(line::EACH_ROW).put(value::ROW, state.row).say(case::EMPTY_ROW),
            Event::Row(_, count) => {
                tell_empty_rows(at(line::EACH_ROW), state).put(value::ROW_PIXELS, *count).say(case::ROW)
            }
            Event::Run(LabelEvent::Made(run)) => touches(at(line::NEW_LABEL), run).say(case::NEW_LABEL),
            Event::Run(LabelEvent::Took(run, above)) => {
                let is_root = run.label == above.label;
                let step = touches_above(at(line::TAKE_ROOT), run, above);
                let step = step.say(if is_one(run) { case::TAKES } else { case::TAKE });
                step.say(if is_root { subtraction::case::END } else { case::ROOT_OF })
            }
            Event::Run(LabelEvent::Met(run, other)) => {
                touches_above(at(line::EACH_OTHER_RUN), run, other).say(case::SAME_ROOT)
            }
            Event::Run(LabelEvent::Merged(run, other, roots)) => {
                union = Some(*roots);
                let step = touches_above(at(line::MERGE_ROOTS), run, other);
                step.put(value::ROOT, roots[0] + 1).put(value::CHILD, roots[1] + 1).say(case::UNION)
            }
            Event::Final(_, _, count) => {
                tell_empty_rows(at(line::LABEL_BY_ROOT), state).put(value::ROOTS, *count).say(case::NUMBERED)
            }
            Event::Kept(_, blobs) => {
                let least = self.settings.least_area(state.picture);
                put_blobs(at(line::KEEP_BLOBS), blobs, least).say(subtraction::case::KEPT)
            }
        };
        let forest = forest::drawn(&labels.parents, union).map(Readout::Diagram);
        step.show_all(forest).show_all(plots(&seen.after.unwrap_or(state).record, &state.span))
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        match seen.events.last() {
            None => return,
            Some(Event::Final(_, labels, _)) => draw_labels(scene, Arc::clone(labels), "components, one colour each"),
            Some(Event::Kept(_, blobs)) => {
                let events = [subtraction::Event::Kept(Arc::clone(blobs))];
                MaskHistory::new(&events).draw(scene);
            }
            Some(Event::Row(..) | Event::Run(_)) => {
                let masked = seen
                    .events
                    .iter()
                    .find_map(|event| if let Event::Row(masked, _) = event { Some(masked) } else { None });
                masked.into_iter().for_each(|masked| draw_unlabelled(scene, masked, state.row));
                let labels = Labels::new(seen);
                draw_labels(scene, Arc::new(labels.labels(state.picture)), "provisional labels, one colour per root");
                draw_forest(scene, &labels);
                let (x, width) = (0, state.picture.0);
                scene.draw(
                    Picture::CURRENT,
                    (Role::Window, "current row"),
                    Shape::pixels(x, state.row as i32, width, 1),
                );
            }
        }
        let Some(Event::Run(event)) = seen.events.last() else { return };
        let (run, other) = match event {
            LabelEvent::Made(run) => (run, None),
            LabelEvent::Took(run, other) | LabelEvent::Met(run, other) | LabelEvent::Merged(run, other, _) => {
                (run, Some(other))
            }
        };
        let mut mark = |run: &Run, role, meaning| {
            let shape = Shape::pixels(run.start as i32, run.y as i32, (run.end - run.start) as usize, 1);
            scene.draw(Picture::CURRENT, (role, meaning), shape);
        };
        other.into_iter().for_each(|other| mark(other, Role::Reference, "touching run above"));
        mark(run, Role::Candidate, "current run");
    }
}

fn draw_labels(scene: &mut Scene, labels: Arc<Grid<u32>>, meaning: &'static str) {
    scene.draw(Picture::CURRENT, (Role::Best, meaning), Shape::Labels(labels));
}

/// Draws the equivalence forest: an arrow from the first run of each label that is no root to the first run of its parent.
fn draw_forest(scene: &mut Scene, labels: &Labels) {
    let mut first: Vec<Option<[f32; 2]>> = vec![None; labels.parents.len()];
    for run in &labels.runs {
        let middle = [(run.start + run.end - 1) as f32 / 2.0, run.y as f32];
        first[run.label as usize].get_or_insert(middle);
    }
    let edge = |(label, parent): (usize, &u32)| {
        let (from, to) = (first[label]?, first[*parent as usize]?);
        (label != *parent as usize).then_some(Arrow { from, to })
    };
    let edges: Vec<Arrow> = labels.parents.iter().enumerate().filter_map(edge).collect();
    if !edges.is_empty() {
        // Not a displacement: it must reach its parent.
        scene.draw(Picture::CURRENT, (Role::Measured, "union–find forest: label → parent"), Shape::Arrows(edges));
    }
}

/// Draws the foreground of the rows to come.
fn draw_unlabelled(scene: &mut Scene, masked: &MaskedFrame, row: usize) {
    let mut mask = masked.mask.clone();
    (0..row).for_each(|y| mask.write_row(y, |words| words.fill(0)));
    scene.draw(Picture::CURRENT, (Role::Rejected, "foreground not yet labelled"), Shape::Mask(Arc::new(mask)));
}
