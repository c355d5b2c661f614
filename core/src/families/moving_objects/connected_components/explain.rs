//! The steps of the labelling in words, numbers and marks.

use std::sync::Arc;

use super::{ConnectedComponents, Event, MaskedFrame, State, forest, line};
use crate::base::words;
use crate::data::{LabelEvent, Run};
use crate::geometry::Grid;
use crate::methods::subtraction::{self, MaskHistory, plots};
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Picture, Readout, Role, Scene, Sentence, Shape, Step};

/// The maximum number of labels listed with their parents.
const LISTED: usize = 24;

/// A run of pixels as text.
fn name(run: Run) -> String {
    match run.end - run.start {
        1 => format!("pixel {} of row {}", run.start, run.y),
        _ => format!("pixels {} to {} of row {}", run.start, run.end - 1, run.y),
    }
}

/// A verb in the number of its run: pixels touch, a pixel touches.
fn verb(run: &Run, many: &'static str, one: &'static str) -> &'static str {
    if run.end - run.start == 1 { one } else { many }
}

/// A label as text, counted from 1 like components.
fn label(label: u32) -> String {
    format!("label {}", label + 1)
}

/// The rows without foreground directly above the current one: moves pass them.
fn passed(state: &State) -> String {
    let first = state.labelling.runs().last().map_or(0, |run| run.y as usize + 1);
    match state.row.saturating_sub(first) {
        0 => String::new(),
        1 => format!("Row {first} has no foreground pixels. "),
        _ => format!("Rows {first} to {} have no foreground pixels. ", state.row - 1),
    }
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

    /// The number of labels that are roots.
    fn roots(&self) -> usize {
        self.parents.iter().enumerate().filter(|(label, parent)| *label == **parent as usize).count()
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
    pub(super) fn explained_step(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Row(..)) => line::EACH_ROW,
            Some(Event::Run(LabelEvent::Made(_))) => line::NEW_LABEL,
            Some(Event::Run(LabelEvent::Took(..))) => line::TAKE_ROOT,
            Some(Event::Run(LabelEvent::Met(..))) => line::EACH_OTHER_RUN,
            Some(Event::Run(LabelEvent::Merged(..))) => line::MERGE_ROOTS,
            Some(Event::Final(..)) => line::LABEL_BY_ROOT,
            Some(Event::Kept(..)) => line::KEEP_BLOBS,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let (state, said) = (seen.before, Sentence::default());
        match seen.events.last() {
            None => said.text(
                "Each run of foreground pixels takes the label of a run that it touches in the row above. Where two labels meet, \
                 union–find makes them equivalent.",
            ),
            Some(Event::Row(_, count)) => said.text(match count {
                0 => format!("Row {} has no foreground pixels.", state.row),
                1 => format!("{}Row {} has 1 foreground pixel.", passed(state), state.row),
                _ => format!("{}Row {} has {count} foreground pixels.", passed(state), state.row),
            }),
            Some(Event::Run(LabelEvent::Made(run))) => said
                .ink(Role::Candidate, words::capital(&name(*run)))
                .text(format!(" {} no run of the row above, so a new label starts: ", verb(run, "touch", "touches")))
                .ink(Role::Best, label(run.label))
                .text("."),
            Some(Event::Run(LabelEvent::Took(run, above))) => said
                .ink(Role::Candidate, words::capital(&name(*run)))
                .text(format!(" {} ", verb(run, "touch", "touches")))
                .ink(Role::Reference, name(*above))
                .text(format!(" and {} ", verb(run, "take", "takes")))
                .ink(Role::Best, label(run.label))
                .text(match run.label == above.label {
                    true => ".".into(),
                    false => format!(", the root of {}.", label(above.label)),
                }),
            Some(Event::Run(LabelEvent::Met(run, other))) => said
                .ink(Role::Candidate, words::capital(&name(*run)))
                .text(format!(" {} ", verb(run, "touch", "touches")))
                .ink(Role::Reference, name(*other))
                .text(" too. Both have the same root, so no union is needed."),
            Some(Event::Run(LabelEvent::Merged(run, other, [root, child]))) => said
                .ink(Role::Candidate, words::capital(&name(*run)))
                .text(format!(" {} ", verb(run, "touch", "touches")))
                .ink(Role::Reference, name(*other))
                .text(" too, which have another root. Union: ")
                .ink(Role::Measured, format!("{} becomes a child of {}", label(*child), label(*root)))
                .text("."),
            Some(Event::Final(_, _, count)) => said
                .text(format!("{}{} with ", passed(state), words::counted(state.labelling.parents().len(), "provisional label")))
                .ink(Role::Result, words::counted(*count as usize, "root"))
                .text(". Each root is a connected component, numbered in raster order of its first pixel."),
            Some(Event::Kept(_, blobs)) => {
                let events = [subtraction::Event::Kept(Arc::clone(blobs))];
                MaskHistory::new(&events).sentence(self.settings, seen.before.picture).unwrap_or(said)
            }
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.before;
        if seen.events.is_empty() {
            return Vec::new();
        }
        let labels = Labels::new(seen);
        let mut facts: Vec<Fact> = vec![
            Fact::new("Frame", state.frame.to_string(), None),
            Fact::new("Runs", labels.runs.len().to_string(), None),
            Fact::new("Labels", labels.parents.len().to_string(), None),
            Fact::new("Roots", labels.roots().to_string(), Some(Role::Result)),
        ];
        if let Some(root) = self.focused(seen, &labels) {
            facts.push(Fact::new("Pixel", root, Some(Role::Reference)));
        }
        facts.push(Fact::new("Label → parent", labels.forest(), None));
        let now = seen.after.unwrap_or(state);
        let mut readouts = vec![Readout::Facts(facts)];
        let union = match seen.events.last() {
            Some(Event::Run(LabelEvent::Merged(.., union))) => Some(*union),
            _ => None,
        };
        readouts.extend(forest::drawn(&labels.parents, union).map(Readout::Diagram));
        readouts.extend(plots(&now.record, &state.span));
        readouts
    }

    /// The label and the root of the pixel that is pointed at.
    fn focused(&self, seen: &Seen<Self>, labels: &Labels) -> Option<String> {
        let (width, height) = seen.before.picture;
        let [x, y] = seen.point()?.map(|c| c + 0.5);
        let is_inside = (0.0..width as f32).contains(&x) && (0.0..height as f32).contains(&y);
        let (x, y) = is_inside.then_some((x as u32, y as u32))?;
        let run = labels.runs.iter().find(|run| run.y == y && (run.start..run.end).contains(&x));
        Some(match run {
            None => format!("{}, no label", words::pixel((x as usize, y as usize))),
            Some(run) => format!(
                "{}, {}, root {}",
                words::pixel((x as usize, y as usize)),
                label(run.label),
                labels.root(run.label) + 1
            ),
        })
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
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
                scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x, state.row as i32, width, 1));
                scene.legend(Role::Window, "current row");
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
            scene.mark(Picture::CURRENT, role, shape);
            scene.legend(role, meaning);
        };
        other.into_iter().for_each(|other| mark(other, Role::Reference, "touching run above"));
        mark(run, Role::Candidate, "current run");
    }
}

fn draw_labels(scene: &mut Scene, labels: Arc<Grid<u32>>, meaning: &'static str) {
    scene.mark(Picture::CURRENT, Role::Best, Shape::Labels(labels));
    scene.legend(Role::Best, meaning);
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
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(edges));
        scene.legend(Role::Measured, "union–find forest: label → parent");
    }
}

/// Draws the foreground of the rows to come.
fn draw_unlabelled(scene: &mut Scene, masked: &MaskedFrame, row: usize) {
    let mut mask = masked.mask.clone();
    (0..row).for_each(|y| mask.write_row(y, |words| words.fill(0)));
    scene.mark(Picture::CURRENT, Role::Rejected, Shape::Mask(Arc::new(mask)));
    scene.legend(Role::Rejected, "foreground not yet labelled");
}
