//! The pen: what is drawn by hand on the steps of each run, with undo.

use std::sync::Arc;

use motionscope_core::run::Cursor;

use crate::experiment::Prepared;
use crate::paint::{Freehand, FreehandLine, PenColor};

/// Runs whose ink is kept; that of the run that was drawn on longest ago goes first.
const RUNS: usize = 16;
/// Changes of a step that can be undone.
const CHANGES: usize = 64;

/// The pen and everything that was drawn with it.
#[derive(Default)]
pub struct Pen {
    /// Whether the mouse draws.
    pub is_on: bool,
    /// Its colour.
    pub color: PenColor,
    runs: Vec<Run>,
}

/// What was drawn in a run.
struct Run {
    subject: Arc<Prepared>,
    steps: Vec<Step>,
}

/// What was drawn on a step, before each change and after those that were undone.
#[derive(Default)]
struct Step {
    at: Cursor,
    lines: Vec<FreehandLine>,
    before: Vec<Vec<FreehandLine>>,
    undone: Vec<Vec<FreehandLine>>,
}

impl Step {
    fn change(&mut self, change: impl FnOnce(&mut Vec<FreehandLine>)) {
        if self.before.len() >= CHANGES {
            self.before.remove(0);
        }
        self.before.push(self.lines.clone());
        self.undone.clear();
        change(&mut self.lines);
    }

    /// Goes back to what was there before the last change, or forward again.
    fn turn_back(&mut self, is_forward: bool) {
        let (from, to) = match is_forward {
            false => (&mut self.before, &mut self.undone),
            true => (&mut self.undone, &mut self.before),
        };
        if let Some(lines) = from.pop() {
            to.push(std::mem::replace(&mut self.lines, lines));
        }
    }
}

impl Pen {
    /// Returns what was drawn on step `at` of the run of `subject`.
    pub fn lines(&self, subject: &Arc<Prepared>, at: Cursor) -> &[FreehandLine] {
        self.step(subject, at).map_or(&[], |step| &step.lines)
    }

    /// Returns everything that was drawn in the run of `subject`.
    pub fn freehand(&self, subject: &Arc<Prepared>) -> Freehand {
        let steps = self.run(subject).map_or(&[][..], |run| &run.steps);
        Freehand { lines: steps.iter().flat_map(|step| step.lines.iter().cloned()).collect() }
    }

    /// Takes over what was drawn in the run of `subject` before, in place of what is known of it.
    pub fn restore(&mut self, subject: &Arc<Prepared>, freehand: Freehand) {
        self.runs.retain(|run| !is_same(&run.subject, subject));
        for line in freehand.lines {
            self.change(subject, line.step, |step| step.lines.push(line));
        }
    }

    /// Adds ink to the steps that had none before: where it was drawn on or cleared from since, a step stays as it is.
    pub fn complete(&mut self, subject: &Arc<Prepared>, freehand: Freehand) {
        let is_new = |line: &FreehandLine| self.step(subject, line.step).is_none();
        let new: Vec<FreehandLine> = freehand.lines.into_iter().filter(is_new).collect();
        for line in new {
            self.change(subject, line.step, |step| step.lines.push(line));
        }
    }

    /// Adds a line to the step on which it was drawn.
    pub fn draw(&mut self, subject: &Arc<Prepared>, line: FreehandLine) {
        self.change(subject, line.step, |step| step.change(|lines| lines.push(line)));
    }

    /// Removes what was drawn on step `at`; it can be undone.
    pub fn clear(&mut self, subject: &Arc<Prepared>, at: Cursor) {
        self.change(subject, at, |step| step.change(Vec::clear));
    }

    /// Undoes the last change of step `at`.
    pub fn undo(&mut self, subject: &Arc<Prepared>, at: Cursor) {
        self.change(subject, at, |step| step.turn_back(false));
    }

    /// Redoes the change of step `at` that was undone last.
    pub fn redo(&mut self, subject: &Arc<Prepared>, at: Cursor) {
        self.change(subject, at, |step| step.turn_back(true));
    }

    /// Whether there is a change of step `at` to undo, and one to redo.
    pub fn history(&self, subject: &Arc<Prepared>, at: Cursor) -> [bool; 2] {
        self.step(subject, at).map_or([false; 2], |step| [!step.before.is_empty(), !step.undone.is_empty()])
    }

    fn run(&self, subject: &Arc<Prepared>) -> Option<&Run> {
        self.runs.iter().find(|run| is_same(&run.subject, subject))
    }

    fn step(&self, subject: &Arc<Prepared>, at: Cursor) -> Option<&Step> {
        self.run(subject)?.steps.iter().find(|step| step.at == at)
    }

    /// Changes a step; its run is now the one that was drawn on last.
    fn change(&mut self, subject: &Arc<Prepared>, at: Cursor, change: impl FnOnce(&mut Step)) {
        let known = self.runs.iter().position(|run| is_same(&run.subject, subject));
        let new = || Run { subject: Arc::clone(subject), steps: Vec::new() };
        let mut run = known.map_or_else(new, |place| self.runs.remove(place));
        match run.steps.iter_mut().find(|step| step.at == at) {
            Some(step) => change(step),
            None => {
                let mut step = Step { at, ..Step::default() };
                change(&mut step);
                run.steps.push(step);
            }
        }
        if self.runs.len() >= RUNS {
            self.runs.remove(0);
        }
        self.runs.push(run);
    }
}

/// Whether both are the same run: another one with the same settings on the same clip has the same steps.
fn is_same(a: &Arc<Prepared>, b: &Arc<Prepared>) -> bool {
    Arc::ptr_eq(a, b) || a.experiment == b.experiment && a.clip.info().name == b.clip.info().name
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Picture;

    use super::*;
    use crate::experiment::Experiment;
    use crate::experiment::source::Source;
    use crate::media::Open;

    fn run(frame: usize) -> Arc<Prepared> {
        let source = Source::parse("synth:pillar,width=64,height=48,frames=4").expect("a scene");
        let experiment = Experiment { frame, ..Experiment::first(source) };
        Arc::new(Prepared::open(experiment, Open::default()).unwrap_or_else(|why| panic!("{why}")))
    }

    fn line(event: usize, x: f32) -> FreehandLine {
        let step = Cursor { unit: 0, event };
        FreehandLine {
            step,
            member: 0,
            on: Picture::CURRENT.into(),
            color: PenColor::Vermilion,
            points: vec![[x, 1.0]],
        }
    }

    #[test]
    fn ink_belongs_to_its_step_of_its_run() {
        let (mut pen, one, other) = (Pen::default(), run(0), run(1));
        pen.draw(&one, line(3, 1.0));
        pen.draw(&one, line(4, 2.0));
        let at = |event| Cursor { unit: 0, event };
        assert_eq!(pen.lines(&one, at(3)), [line(3, 1.0)]);
        assert!(pen.lines(&one, at(5)).is_empty() && pen.lines(&other, at(3)).is_empty());
        assert_eq!(pen.lines(&run(0), at(4)), [line(4, 2.0)], "the same run once more");
        let all = pen.freehand(&one);
        assert_eq!(all.lines.len(), 2);
        let mut copy = Pen::default();
        copy.restore(&one, all.clone());
        assert_eq!(copy.freehand(&one), all);
    }

    #[test]
    fn ink_that_was_cleared_is_not_completed() {
        let (mut pen, run) = (Pen::default(), run(0));
        let at = |event| Cursor { unit: 0, event };
        let page = Freehand { lines: vec![line(3, 1.0), line(3, 2.0)] };
        pen.complete(&run, page.clone());
        assert_eq!(pen.freehand(&run), page, "both lines of a step");
        pen.clear(&run, at(3));
        pen.complete(&run, page);
        assert!(pen.lines(&run, at(3)).is_empty(), "what was cleared comes back");
        pen.complete(&run, Freehand { lines: vec![line(4, 1.0)] });
        assert_eq!(pen.lines(&run, at(4)), [line(4, 1.0)], "another page of the same run");
    }

    #[test]
    fn changes_of_a_step_are_undone_one_by_one() {
        let (mut pen, run) = (Pen::default(), run(0));
        let at = Cursor { unit: 0, event: 3 };
        let count = |pen: &Pen| pen.lines(&run, at).len();
        pen.draw(&run, line(3, 1.0));
        pen.draw(&run, line(3, 2.0));
        pen.clear(&run, at);
        assert_eq!((count(&pen), pen.history(&run, at)), (0, [true, false]));
        let mut counts = Vec::new();
        for _ in 0..4 {
            pen.undo(&run, at);
            counts.push(count(&pen));
        }
        assert_eq!((counts, pen.history(&run, at)), (vec![2, 1, 0, 0], [false, true]));
        pen.redo(&run, at);
        assert_eq!(count(&pen), 1);
        pen.draw(&run, line(3, 5.0));
        assert_eq!((count(&pen), pen.history(&run, at)), (2, [true, false]));
    }

    #[test]
    fn only_the_last_runs_are_kept() {
        let mut pen = Pen::default();
        let runs: Vec<_> = (0..2).map(run).collect();
        for _ in 0..2 * RUNS {
            runs.iter().for_each(|run| pen.draw(run, line(1, 1.0)));
        }
        assert_eq!(pen.runs.len(), 2);
    }
}
