//! Predict, then reveal: the next result is held back from the window until the class has answered a question about it.
//!
//! The walker has made the step already. [`Predict::pass`] stands between its view and the window: what the window shows while
//! a question is open is the step before it, with what the question takes for granted of the step after it.

mod answers;
mod score;

use std::sync::Arc;

use motionscope_core::run::Cursor;
use motionscope_core::scene::{Answer, Asked, Fact, Focus, Question, Shown, Step, asked};

pub use answers::{ARROWS, DIRECTIONS, Guesses, SAME_PLACE, Verdict};
pub use score::Score;

use super::snapshot::Snapshot;
use super::walker::View;
use crate::experiment::Prepared;

/// A question that is open, or that was just answered.
#[derive(Clone)]
pub struct Open {
    /// The question.
    pub question: &'static Question,
    /// What was guessed.
    pub guesses: Guesses,
    answer: Answer,
    before: Arc<Snapshot>,
    after: Arc<Snapshot>,
    /// What the window shows.
    seen: Arc<Snapshot>,
    is_revealed: bool,
}

/// How often the same question is asked in a row.
const ASKED_IN_A_ROW: usize = 3;
/// How often it is passed over then.
const PAUSE: usize = 2;

/// Whether results are held back, the question that is open, and what the class has scored.
#[derive(Default)]
pub struct Predict {
    is_on: bool,
    /// Whether a page of a lesson has turned it on.
    is_of_page: bool,
    /// A step forward was asked for, and is asked about if it answers a question.
    is_due: bool,
    last: Option<Arc<Snapshot>>,
    open: Option<Open>,
    /// A step whose question was taken back, and what is shown until the run has left it.
    leaving: Option<(Arc<Snapshot>, Arc<Snapshot>)>,
    /// A run, and its references about which what is asked once was asked.
    known: Option<(Arc<Prepared>, Vec<[f32; 2]>)>,
    /// The question that came up last, and how often it did so before in a row.
    in_a_row: Option<(&'static Question, usize)>,
    scores: Vec<Score>,
}

impl Open {
    fn new(question: &'static Question, answer: Answer, before: Arc<Snapshot>, after: Arc<Snapshot>) -> Self {
        let guesses = Guesses::of(question, &answer);
        let seen = Arc::clone(&before);
        let mut open = Self { question, guesses, answer, before, after, seen, is_revealed: false };
        open.look_again();
        open
    }

    /// Makes anew what the window shows.
    fn look_again(&mut self) {
        let Self { question, answer, guesses, before, after, is_revealed, .. } = self;
        self.seen = Arc::new(match is_revealed {
            true => answers::revealed(after, answer, guesses),
            false => answers::hidden((before, after), question, (answer, guesses)),
        });
    }

    /// Returns the step that it is about.
    pub fn cursor(&self) -> Cursor {
        self.after.cursor
    }

    /// Returns the step that it is about, of which nothing but its place in the run may be told.
    pub fn asked_of(&self) -> &Snapshot {
        &self.after
    }

    /// Returns the values without which the question cannot be answered.
    pub fn given(&self) -> Vec<Fact> {
        let known = self.question.given_by(&self.after.step).cloned();
        known.fold(Step::at(self.after.step.line), Step::fact_of).facts().to_vec()
    }

    /// Returns the unit of the number that is asked for; empty if none is.
    pub fn unit(&self) -> String {
        self.question.unit()
    }

    /// Returns how the guesses compare with the answer; `None` until it is revealed.
    pub fn verdict(&self) -> Option<Verdict> {
        self.is_revealed.then(|| self.guesses.verdict(self.question, &self.answer))
    }
}

impl Predict {
    /// Whether steps are asked about.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// The question that waits for its answer.
    pub fn open(&self) -> Option<&Open> {
        self.open.as_ref().filter(|open| !open.is_revealed)
    }

    /// The question that is open, or that was answered by the step shown.
    pub fn last(&self) -> Option<&Open> {
        self.open.as_ref()
    }

    /// The questions that were answered, in their order.
    pub fn scores(&self) -> &[Score] {
        &self.scores
    }

    /// Begins a new tally, for another class.
    pub fn clear_scores(&mut self) {
        self.scores.clear();
    }

    /// Turns the questions on or off. An open one is closed without its answer; returns the step that the run is to go back to.
    pub fn turn(&mut self, on: bool) -> Option<Cursor> {
        let back = self.withdraw();
        let Self { scores, leaving, .. } = std::mem::take(self);
        *self = Self { is_on: on, scores, leaving, ..Self::default() };
        back
    }

    /// Turns the questions on or off as a page of a lesson has it; what a person has turned on stays on.
    pub fn turn_for_page(&mut self, asks: bool) {
        // Where a page begins is no step to ask about.
        self.leave();
        (self.is_due, self.last) = (false, None);
        if asks != self.is_on && (asks || self.is_of_page) {
            self.turn(asks);
            self.is_of_page = asks;
        }
    }

    /// Notes that a step forward was asked for.
    pub fn expect(&mut self) {
        self.is_due = self.is_on;
    }

    /// Whether a step that may be asked about is on its way.
    pub fn is_due(&self) -> bool {
        self.is_due
    }

    /// Closes a question without its answer, which stays hidden until the run has left its step.
    fn leave(&mut self) -> Option<Arc<Snapshot>> {
        let open = self.open.take().filter(|open| !open.is_revealed)?;
        self.leaving = Some((open.after, open.seen));
        Some(open.before)
    }

    /// Puts a question between what the walker shows and the window, if there is one; returns whether it was opened now. While a
    /// clip `is_loading`, the run that is shown is about to be left.
    pub fn pass(&mut self, view: &mut View, is_loading: bool) -> bool {
        if self.is_left(view, is_loading) {
            return false;
        }
        let Some(now) = view.shown.clone().filter(|_| self.is_on) else {
            (self.open, self.last) = (None, None);
            return false;
        };
        if let Some(open) = &mut self.open {
            if is_same_step(&open.after, &now) {
                if !Arc::ptr_eq(&open.after, &now) {
                    open.after = now;
                    open.look_again();
                }
                view.shown = Some(Arc::clone(&open.seen));
                // A step forward that led nowhere is not waited for.
                self.is_due &= view.busy;
                return false;
            }
            let left = Arc::clone(if open.is_revealed { &open.after } else { &open.before });
            self.open = None;
            self.note(left);
        }
        let before = self.last.clone().filter(|last| Arc::ptr_eq(&last.subject, &now.subject) && now.tiles.is_empty());
        let Some(before) = before.filter(|_| self.is_due) else {
            self.is_due = false;
            self.note(now);
            return false;
        };
        if view.busy {
            // Nothing is seen of a move on its way, or it would show what is asked.
            view.shown = Some(before);
            return false;
        }
        self.is_due = false;
        let is_forward = (before.cursor.unit, before.cursor.event) < (now.cursor.unit, now.cursor.event);
        let opened = is_forward.then(|| self.question_between(&before, &now)).flatten();
        let opened = opened.filter(|(question, _)| self.takes_turn(question));
        self.last = Some(Arc::clone(&now));
        let Some((question, answer)) = opened else { return false };
        let open = Open::new(question, answer, before, now);
        view.shown = Some(Arc::clone(&open.seen));
        self.open = Some(open);
        true
    }

    /// Notes what is shown before the next step: the step itself, also where a pixel of it is pointed at.
    fn note(&mut self, now: Arc<Snapshot>) {
        let is_pointed = now.pointed.is_some_and(|pointed| !pointed.is_held);
        let is_itself = |last: &Arc<Snapshot>| is_same_step(last, &now) && last.pointed.is_none();
        if !is_pointed || !self.last.as_ref().is_some_and(is_itself) {
            self.last = Some(now);
        }
    }

    /// Keeps the snapshot of before while the run is on its way from a step whose question was taken back; returns whether it is.
    fn is_left(&mut self, view: &mut View, is_loading: bool) -> bool {
        let is_on_its_way = view.busy || is_loading;
        let stands_at = |after: &Snapshot| view.shown.as_deref().is_some_and(|now| is_same_step(after, now));
        self.leaving = self.leaving.take().filter(|(after, _)| is_on_its_way && stands_at(after));
        let Some((_, seen)) = &self.leaving else { return false };
        view.shown = Some(Arc::clone(seen));
        true
    }

    /// Adds one to the hands for the answer of this index, or takes one away; returns whether there is such an answer.
    pub fn vote(&mut self, index: usize, adds: bool) -> bool {
        self.guess(|guesses| guesses.vote(index, adds))
    }

    /// Adds a place that was clicked.
    pub fn point(&mut self, focus: Focus) -> bool {
        self.guess(|guesses| guesses.point(focus))
    }

    /// Adds a number that was typed.
    pub fn number(&mut self, number: f64) -> bool {
        self.guess(|guesses| guesses.number(number))
    }

    fn guess(&mut self, guess: impl FnOnce(&mut Guesses) -> bool) -> bool {
        let Some(open) = self.open.as_mut().filter(|open| !open.is_revealed) else { return false };
        let is_taken = guess(&mut open.guesses);
        if is_taken {
            open.look_again();
        }
        is_taken
    }

    /// Shows the result, and scores the guesses if there are any.
    pub fn reveal(&mut self) {
        let Some(open) = self.open.as_mut().filter(|open| !open.is_revealed) else { return };
        open.is_revealed = true;
        open.look_again();
        if !open.guesses.is_empty() {
            let verdict = open.guesses.verdict(open.question, &open.answer);
            self.scores.push(Score::new(&open.after, open.question, verdict));
        }
        if open.question.once {
            let after = &open.after;
            let run = self.known.take().filter(|(run, _)| Arc::ptr_eq(run, &after.subject));
            let (run, mut known) = run.unwrap_or_else(|| (Arc::clone(&after.subject), Vec::new()));
            known.extend(shown(after).reference());
            self.known = Some((run, known));
        }
    }

    /// Whether what is asked once was asked about the reference of a step already.
    fn knows(&self, after: &Snapshot) -> bool {
        let run = self.known.as_ref().filter(|(run, _)| Arc::ptr_eq(run, &after.subject));
        run.zip(shown(after).reference()).is_some_and(|((_, known), at)| known.contains(&at))
    }

    /// Returns the question that the step of `after` answers; none where a pixel is explained that was pointed at.
    fn question_between(&self, before: &Snapshot, after: &Snapshot) -> Option<(&'static Question, Answer)> {
        if before.pointed.is_some() || after.pointed.is_some() {
            return None;
        }
        let turn = after.cursor.unit.wrapping_add(after.cursor.event);
        let is_known = self.knows(after);
        let questions = after.subject.experiment.estimator.questions().iter();
        let questions = questions.filter(|of| of.is_asked_in(after.cursor.unit) && !(of.once && is_known));
        asked(questions, shown(before), shown(after), turn)
    }

    /// Whether a question that comes up is asked: one that comes up again and again pauses after some times.
    fn takes_turn(&mut self, question: &'static Question) -> bool {
        let before = match self.in_a_row {
            Some((last, before)) if last.id == question.id => before + 1,
            _ => 0,
        };
        self.in_a_row = Some((question, before));
        before % (ASKED_IN_A_ROW + PAUSE) < ASKED_IN_A_ROW
    }

    /// Closes the question without its answer; returns the step that the run is to go back to.
    pub fn withdraw(&mut self) -> Option<Cursor> {
        let before = self.leave()?;
        let cursor = before.cursor;
        self.last = Some(before);
        Some(cursor)
    }
}

/// Whether both show the same step of the same run.
fn is_same_step(a: &Snapshot, b: &Snapshot) -> bool {
    Arc::ptr_eq(&a.subject, &b.subject) && a.cursor == b.cursor
}

/// The step of a snapshot with its scene.
fn shown(of: &Snapshot) -> Shown<'_> {
    Shown { step: &of.step, scene: &of.scene }
}

/// Whether a question is answered by a click on the picture.
pub fn asks_for_place(question: &Question) -> bool {
    matches!(question.asked, Asked::Place { .. })
}

/// Whether a question is answered by a number.
pub fn asks_for_number(question: &Question) -> bool {
    matches!(question.asked, Asked::Value { .. })
}
