//! Guesses, how they compare with the answer, and what the window shows of both.

use std::sync::Arc;

use motionscope_core::scene::{Answer, Asked, Focus, Picture, Question, Shape};
use motionscope_core::{Role, Scene, fixed};

use crate::ui::model::snapshot::Snapshot;
use crate::view::moment::Moment;

/// The quadrants around what is looked for, in the order of their keys.
pub const QUADRANTS: [&str; 4] = ["Upper left", "Upper right", "Lower left", "Lower right"];
/// Most guesses of one question that are kept.
const MOST: usize = 99;
/// The objects of guesses are numbered from here on, so that their colours are not those of tracks nearby.
const FIRST_ID: u32 = 40;

/// The guesses of a class.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guesses {
    /// The hands for each answer, or for each quadrant of a place; empty if nobody can be counted.
    pub hands: Vec<usize>,
    /// The places that were clicked.
    pub places: Vec<Focus>,
    /// The numbers that were typed.
    pub numbers: Vec<f64>,
    on: Option<Picture>,
    takes_numbers: bool,
}

/// How guesses compare with the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The answer in words: `No`, or `(12.0, 7.5)`.
    pub answer: String,
    /// The index of the answer that hands were counted for.
    pub index: Option<usize>,
    /// Right hands, and all hands.
    pub hands: [usize; 2],
    /// Number of guesses that are no hands.
    pub guesses: usize,
    /// The guess that is nearest, counted from 1, and its distance from the answer.
    pub nearest: Option<(usize, f64)>,
    /// The unit of the distance.
    pub unit: &'static str,
}

impl Guesses {
    /// Returns no guesses yet at a question with this answer.
    pub fn of(question: &Question, answer: &Answer) -> Self {
        let hands = match answer {
            Answer::Choice(_) => question.choices().len(),
            Answer::Place { from: Some(_), at, .. } if at.len() == 1 => QUADRANTS.len(),
            _ => 0,
        };
        let on = if let Answer::Place { on, .. } = answer { Some(*on) } else { None };
        Self { hands: vec![0; hands], on, takes_numbers: matches!(answer, Answer::Number { .. }), ..Self::default() }
    }

    /// Whether nothing was guessed.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty() && self.numbers.is_empty() && self.hands.iter().all(|hands| *hands == 0)
    }

    pub(super) fn vote(&mut self, index: usize, adds: bool) -> bool {
        let Some(hands) = self.hands.get_mut(index) else { return false };
        *hands = if adds { (*hands + 1).min(MOST * MOST) } else { hands.saturating_sub(1) };
        true
    }

    pub(super) fn point(&mut self, focus: Focus) -> bool {
        let is_taken = self.on.is_some_and(|on| on.is_aligned_with(focus.on)) && self.places.len() < MOST;
        if is_taken {
            self.places.push(focus);
        }
        is_taken
    }

    pub(super) fn number(&mut self, number: f64) -> bool {
        let is_taken = self.takes_numbers && number.is_finite() && self.numbers.len() < MOST;
        if is_taken {
            self.numbers.push(number);
        }
        is_taken
    }

    /// Returns how the guesses compare with the answer.
    pub fn verdict(&self, question: &Question, answer: &Answer) -> Verdict {
        let all = self.hands.iter().sum();
        let right = |index: Option<usize>| index.and_then(|index| self.hands.get(index)).copied().unwrap_or(0);
        let (index, told, nearest, unit) = match answer {
            Answer::Choice(index) => (Some(*index), question.choices()[*index].to_owned(), None, ""),
            Answer::Place { at, from, .. } => {
                let index = from.filter(|_| at.len() == 1).map(|from| quadrant(from, at[0]));
                let told = match &at[..] {
                    [[x, y]] => format!("({}, {})", fixed((*x).into(), 1), fixed((*y).into(), 1)),
                    all => format!("{} places", all.len()),
                };
                (index, told, nearest(self.places.iter().map(|guess| distance(guess.at, at))), "px")
            }
            Answer::Number { value, shown } => {
                let Asked::Number(reading) = question.asked else { unreachable!("a number was asked for") };
                let off = nearest(self.numbers.iter().map(|guess| (guess - value).abs()));
                (None, [shown, reading.unit].join(" ").trim_end().to_owned(), off, reading.unit)
            }
        };
        let guesses = self.places.len() + self.numbers.len();
        Verdict { answer: told, index, hands: [right(index), all], guesses, nearest, unit }
    }
}

impl Verdict {
    /// Returns it in words: `No: 9 of 13 hands`.
    pub fn text(&self) -> String {
        let [right, all] = self.hands;
        let quadrant = self.index.filter(|_| self.unit == "px").map(|index| QUADRANTS[index].to_lowercase());
        let mut said = self.answer.clone();
        if let Some((guess, off)) = self.nearest {
            let off = match self.unit {
                "px" => fixed(off, 1),
                _ if off.fract() == 0.0 => fixed(off, 0),
                _ => fixed(off, 2),
            };
            let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
            said += &match (off.as_str(), self.guesses) {
                ("0" | "0.0" | "0.00", 1) => ". The guess is exact".to_owned(),
                (_, 1) => format!(". The guess is {off}{unit} off"),
                _ => format!(". Guess {guess} of {} is nearest, {off}{unit} off", self.guesses),
            };
        }
        if all > 0 {
            let of = quadrant.map_or_else(String::new, |quadrant| format!(" for {quadrant}"));
            said += &format!(". {right} of {all} {}{of}", if all == 1 { "hand" } else { "hands" });
        }
        said + "."
    }
}

/// The index in [`QUADRANTS`] of the quadrant around `from` that `at` lies in.
fn quadrant(from: [f32; 2], at: [f32; 2]) -> usize {
    usize::from(at[0] >= from[0]) + 2 * usize::from(at[1] >= from[1])
}

fn distance(guess: [f32; 2], places: &[[f32; 2]]) -> f64 {
    let to = |place: &[f32; 2]| f64::from((guess[0] - place[0]).hypot(guess[1] - place[1]));
    places.iter().map(to).fold(f64::INFINITY, f64::min)
}

/// The guess that is the least distance off, counted from 1; the first of several.
fn nearest(distances: impl Iterator<Item = f64>) -> Option<(usize, f64)> {
    let numbered = distances.enumerate().map(|(i, off)| (i + 1, off));
    numbered.reduce(|best, other| if other.1 < best.1 { other } else { best })
}

/// What a question takes for granted: what the next step is about, without what it finds.
fn is_given(question: &Question, role: Role) -> bool {
    match question.asked {
        Asked::Place { role: asked, .. } => {
            role != asked && matches!(role, Role::Reference | Role::Window | Role::Measured)
        }
        _ => matches!(role, Role::Reference | Role::Window | Role::Candidate),
    }
}

/// What the window shows while a question is open: the step before, on the pictures and with the subject of the step after it.
pub(super) fn hidden(
    (before, after): (&Arc<Snapshot>, &Arc<Snapshot>),
    question: &Question,
    guesses: &Guesses,
) -> Snapshot {
    let is_same_frame = before.frame == after.frame;
    // Of another frame the old results tell nothing; a place must not be given away by an old one either.
    let is_place = matches!(question.asked, Asked::Place { .. });
    let gives_away = |role: Role| is_place && matches!(role, Role::Best | Role::Candidate | Role::Rejected);
    let stays = |role: Role| !is_given(question, role) && !gives_away(role);
    let old = before.scene.marks.iter().filter(|_| is_same_frame);
    let old = old.filter(|mark| if mark.shape.is_layer() { !is_place } else { stays(mark.role) });
    let new = after.scene.marks.iter().filter(|mark| is_given(question, mark.role) && !mark.shape.is_layer());
    let mut scene = Scene { marks: old.chain(new).cloned().collect(), ..after.scene.as_ref().clone() };
    scene.links.clear();
    scene.layers.clear();
    scene.legend.retain(|(role, _)| scene.marks.iter().any(|mark| mark.role == *role));
    // Pictures that the step computes, such as a response, are those of the step before.
    scene.pictures.clone_from(&before.scene.pictures);
    mark(&mut scene, guesses);
    let mut pictures = before.pictures.clone();
    pictures.pair.clone_from(&after.pictures.pair);
    pictures.names.clone_from(&after.pictures.names);
    let frame = after.frame;
    // The marks of the timeline would tell where the run finds something.
    let is_past = |(event, _): &&(usize, Role)| *event <= before.cursor.event;
    let landmarks: Vec<_> = before.landmarks.iter().filter(is_past).copied().collect();
    Snapshot {
        moment: Moment { scene: Arc::new(scene), pictures, frame, ..before.moment.clone() },
        landmarks,
        ..before.as_ref().clone()
    }
}

/// What the window shows once a question is answered: the step, with the guesses and their distances.
pub(super) fn revealed(after: &Arc<Snapshot>, answer: &Answer, guesses: &Guesses) -> Snapshot {
    let mut scene = after.scene.as_ref().clone();
    if let Answer::Place { at, .. } = answer {
        for (number, guess) in (FIRST_ID..).zip(&guesses.places) {
            let off = |place: &&[f32; 2]| distance(guess.at, &[**place]);
            let target = at.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
            let line = target.map(|target| Shape::Path { points: vec![guess.at, *target], closed: false });
            line.into_iter().for_each(|line| scene.mark_of(number, guess.on, Role::Measured, line));
        }
    }
    mark(&mut scene, guesses);
    Snapshot { moment: Moment { scene: Arc::new(scene), ..after.moment.clone() }, ..after.as_ref().clone() }
}

/// Marks the places that were clicked, with their numbers where there are several.
fn mark(scene: &mut Scene, guesses: &Guesses) {
    for (number, guess) in (1u32..).zip(&guesses.places) {
        let id = FIRST_ID + number - 1;
        scene.mark_of(id, guess.on, Role::Measured, Shape::Points(vec![guess.at]));
        if guesses.places.len() > 1 {
            let text = Shape::Text { at: [guess.at[0] + 1.5, guess.at[1] - 1.5], text: number.to_string() };
            scene.mark_of(id, guess.on, Role::Measured, text);
        }
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::{Case, Reading};

    use super::*;

    motionscope_core::pseudocode! {
        TEST: "test",
    }

    const CHOICE: Question =
        Question::choice("a", "A?", &[Case::says(line::TEST, "is", "Yes"), Case::at(line::TEST, "No")]);
    const PLACE: Question = Question::place("b", "B?", line::TEST, Role::Best);
    const NUMBER: Question =
        Question::number("c", "C?", Reading { line: line::TEST, after: "", before: " px", unit: "px" });

    #[test]
    fn hands_are_counted_for_the_answers() {
        assert_eq!(line::ALL.len(), 1);
        let answer = Answer::Choice(1);
        let mut guesses = Guesses::of(&CHOICE, &answer);
        assert!(guesses.is_empty() && !guesses.vote(2, true) && !guesses.point(Focus::current([1.0, 1.0])));
        assert!(guesses.vote(0, true) && guesses.vote(1, true) && guesses.vote(1, true) && guesses.vote(0, false));
        assert!(guesses.vote(0, false), "never below none");
        assert_eq!(guesses.hands, [0, 2]);
        assert_eq!(guesses.verdict(&CHOICE, &answer).text(), "No. 2 of 2 hands.");
        guesses.vote(0, true);
        assert_eq!(guesses.verdict(&CHOICE, &answer).hands, [2, 3]);
    }

    #[test]
    fn the_nearest_place_wins_and_quadrants_are_voted_for() {
        let answer = Answer::Place { on: Picture::NEXT, at: vec![[10.0, 4.0]], from: Some([8.0, 8.0]) };
        let mut guesses = Guesses::of(&PLACE, &answer);
        assert_eq!(guesses.hands.len(), 4);
        assert!(guesses.point(Focus::on(Picture::NEXT, [20.0, 4.0])) && guesses.point(Focus::current([13.0, 8.0])));
        assert!(guesses.vote(1, true) && guesses.vote(3, true));
        let verdict = guesses.verdict(&PLACE, &answer);
        assert_eq!((verdict.nearest, verdict.index, verdict.hands), (Some((2, 5.0)), Some(1), [1, 2]));
        assert_eq!(verdict.text(), "(10.0, 4.0). Guess 2 of 2 is nearest, 5.0 px off. 1 of 2 hands for upper right.");
    }

    #[test]
    fn numbers_are_compared_in_their_unit() {
        let answer = Answer::Number { value: 12.5, shown: "12.5".into() };
        let mut guesses = Guesses::of(&NUMBER, &answer);
        assert!(!guesses.number(f64::NAN) && guesses.number(14.0) && !guesses.vote(0, true));
        assert_eq!(guesses.verdict(&NUMBER, &answer).text(), "12.5 px. The guess is 1.5 px off.");
        assert!(guesses.number(12.5));
        assert_eq!(guesses.verdict(&NUMBER, &answer).text(), "12.5 px. Guess 2 of 2 is nearest, 0.0 px off.");
    }
}
