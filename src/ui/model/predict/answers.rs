//! Guesses, how they compare with the answer, and what the window shows of both.

use std::sync::Arc;

use motionscope_core::base::words::fixed;
use motionscope_core::scene::{Answer, Asked, Focus, Mark, Picture, Question, Role, Scene, Shape};

use crate::ui::model::snapshot::Snapshot;
use crate::view::moment::Moment;

/// The directions from the reference to a place, in the order of their keys, which lie like this on a number pad.
pub const DIRECTIONS: [&str; 9] =
    ["Lower left", "Below", "Lower right", "Left", "Same place", "Right", "Upper left", "Above", "Upper right"];
/// The signs of [`DIRECTIONS`], for buttons.
pub const ARROWS: [&str; 9] = ["↙", "↓", "↘", "←", "•", "→", "↖", "↑", "↗"];
/// The index in [`DIRECTIONS`] of no direction.
pub const SAME_PLACE: usize = 4;
/// Directions within this angle in degrees of the true one are right, so between two both are.
const ALIKE_DEG: f32 = 30.0;
/// Distance in px along each axis up to which two places count as the same.
const SAME_PX: f32 = 0.5;
/// Most guesses of one question that are kept, and most hands for one answer.
const MOST: usize = 99;
const MOST_HANDS: usize = 9999;
/// The objects of guesses are numbered from here on, so that their colours are not those of tracks nearby.
const FIRST_ID: u32 = 40;

/// The guesses of a class.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guesses {
    /// The hands for each answer, or for each direction of a place; empty if the answer cannot be given by a show of hands.
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
    /// The answers that are right, of those that hands are counted for.
    pub right: Vec<&'static str>,
    /// Right hands, and all hands.
    pub hands: [usize; 2],
    /// Number of guesses that are no hands.
    pub guesses: usize,
    /// The guess that is nearest, counted from 1, and its distance from the answer.
    pub nearest: Option<(usize, f64)>,
    /// The unit of the distance.
    pub unit: String,
    /// Number of its decimals.
    pub decimals: usize,
}

impl Guesses {
    /// Returns no guesses yet at a question with this answer.
    pub fn of(question: &Question, answer: &Answer) -> Self {
        let hands = match answer {
            Answer::Choice(_) => question.choices().len(),
            Answer::Place { from: Some(_), at, .. } if at.len() == 1 => DIRECTIONS.len(),
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
        *hands = if adds { (*hands + 1).min(MOST_HANDS) } else { hands.saturating_sub(1) };
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
        let choices = question.choices();
        let (indices, names, told, nearest, (unit, decimals)) = match answer {
            Answer::Choice(index) => {
                (vec![*index], choices, question.choices()[*index].to_owned(), None, (String::new(), 0))
            }
            Answer::Place { at, from, .. } => {
                let directed = from.filter(|_| at.len() == 1).map_or_else(Vec::new, |from| directions(from, at[0]));
                let told = match &at[..] {
                    [[x, y]] => format!("({}, {})", fixed((*x).into(), 1), fixed((*y).into(), 1)),
                    all => format!("{} places", all.len()),
                };
                let off = nearest(self.places.iter().map(|guess| distance(guess.at, at)));
                (directed, DIRECTIONS.to_vec(), told, off, ("px".into(), 1))
            }
            Answer::Number { value, shown } => {
                let unit = question.unit();
                let decimals = shown.split_once('.').map_or(0, |(_, decimals)| decimals.len());
                let off = nearest(self.numbers.iter().map(|guess| (guess - value).abs()));
                (Vec::new(), choices, format!("{shown} {unit}").trim_end().to_owned(), off, (unit, decimals))
            }
        };
        let hands = indices.iter().filter_map(|index| self.hands.get(*index)).sum();
        let right = indices.iter().filter_map(|index| names.get(*index)).copied().collect();
        let guesses = self.places.len() + self.numbers.len();
        Verdict { answer: told, right, hands: [hands, all], guesses, nearest, unit, decimals }
    }
}

impl Verdict {
    /// Returns it in words: `No. 9 of 13 hands.`
    pub fn text(&self) -> String {
        let [right, all] = self.hands;
        let mut said = self.answer.clone();
        if let Some((guess, off)) = self.nearest {
            let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
            let off = if off == 0.0 { "exact".to_owned() } else { format!("{}{unit} off", fixed(off, self.decimals)) };
            said += &match self.guesses {
                1 => format!(". The guess is {off}"),
                all => format!(". Guess {guess} of {all} is nearest, {off}"),
            };
        }
        if all > 0 {
            let names: Vec<_> = self.right.iter().map(|name| name.to_lowercase()).collect();
            let of = if self.unit == "px" { format!(" for {}", names.join(" or ")) } else { String::new() };
            said += &format!(". {right} of {all} {}{of}", if all == 1 { "hand" } else { "hands" });
        }
        said + "."
    }
}

/// The indices in [`DIRECTIONS`] of the directions from `from` to `at`: one, or two where it lies between them.
fn directions(from: [f32; 2], at: [f32; 2]) -> Vec<usize> {
    let [x, y] = [0, 1].map(|i| at[i] - from[i]);
    if x.abs().max(y.abs()) <= SAME_PX {
        return vec![SAME_PLACE];
    }
    let is_alike = |index: &usize| {
        // The keys of a number pad go right and up, y goes down.
        let [u, v] = [(index % 3) as f32 - 1.0, 1.0 - (index / 3) as f32];
        (u * y - v * x).atan2(u * x + v * y).abs() <= ALIKE_DEG.to_radians()
    };
    (0..DIRECTIONS.len()).filter(|index| *index != SAME_PLACE).filter(is_alike).collect()
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
fn is_given(question: &Question, Mark { role, shape, .. }: &Mark) -> bool {
    match question.asked {
        Asked::Place { role: asked, .. } => {
            *role != asked && matches!(role, Role::Reference | Role::Window | Role::Measured)
        }
        // The ellipse of a gate shows what lies in it.
        _ if *role == Role::Window => !matches!(shape, Shape::Ellipse { .. }),
        _ => matches!(role, Role::Reference | Role::Candidate),
    }
}

/// What the window shows while a question is open: the step before, on the pictures and with the subject of the step after it.
pub(super) fn hidden(
    (before, after): (&Arc<Snapshot>, &Arc<Snapshot>),
    question: &Question,
    (answer, guesses): (&Answer, &Guesses),
) -> Snapshot {
    let is_same_frame = before.frame == after.frame;
    let is_place = matches!(question.asked, Asked::Place { .. });
    let size = after.pictures.pair[0].size();
    if is_place && !is_same_frame {
        // The place in a frame is predicted from the frames before it.
        let mut scene = before.scene.as_ref().clone();
        scene.work = searched(&scene, answer, size).or(scene.work);
        mark(&mut scene, guesses);
        let moment = Moment { scene: Arc::new(scene), ..before.moment.clone() };
        return Snapshot { moment, landmarks: landmarks_of(before), ..before.as_ref().clone() };
    }
    // Of another frame the old results tell nothing; a place must not be given away by an old one either.
    let gives_away = |role: Role| is_place && matches!(role, Role::Best | Role::Candidate | Role::Rejected);
    let stays = |mark: &Mark| !is_given(question, mark) && !gives_away(mark.role);
    let old = before.scene.marks.iter().filter(|_| is_same_frame);
    let old = old.filter(|mark| if mark.shape.is_layer() { !is_place } else { stays(mark) });
    // Marks with an identity are tracks: what becomes of them is asked.
    let is_new = |mark: &&Mark| is_given(question, mark) && mark.of.is_none() && !mark.shape.is_layer();
    let new = after.scene.marks.iter().filter(is_new);
    let mut scene = Scene { marks: old.chain(new).cloned().collect(), ..after.scene.as_ref().clone() };
    scene.links.clear();
    scene.layers.clear();
    scene.legend.retain(|(role, _)| scene.marks.iter().any(|mark| mark.role == *role));
    // Pictures that the step computes, such as a response, are those of the step before.
    scene.pictures.clone_from(&before.scene.pictures);
    scene.work = searched(&scene, answer, size).or(scene.work);
    mark(&mut scene, guesses);
    let mut pictures = before.pictures.clone();
    pictures.pair.clone_from(&after.pictures.pair);
    pictures.names.clone_from(&after.pictures.names);
    Snapshot {
        moment: Moment { scene: Arc::new(scene), pictures, frame: after.frame, ..before.moment.clone() },
        landmarks: landmarks_of(before),
        ..before.as_ref().clone()
    }
}

/// The part of a picture of `size` px in which a place is looked for, so that it can be clicked: the search window that is shown,
/// or else all of the picture; `None` if no place is.
fn searched(scene: &Scene, answer: &Answer, (width, height): (usize, usize)) -> Option<[[f32; 2]; 2]> {
    let Answer::Place { on, at, .. } = answer else { return None };
    if !on.is_aligned_with(Picture::CURRENT) {
        return None;
    }
    let windows = scene.marks.iter().filter(|mark| mark.role == Role::Window && mark.on.is_aligned_with(*on));
    let mut windows = windows.filter_map(|mark| match mark.shape {
        Shape::Rect { min, max } => Some([min, max]),
        _ => None,
    });
    let has_all =
        |[min, max]: &[[f32; 2]; 2]| at.iter().all(|place| (0..2).all(|i| (min[i]..=max[i]).contains(&place[i])));
    let whole = [[-0.5; 2], [width as f32 - 0.5, height as f32 - 0.5]];
    Some(windows.find(has_all).unwrap_or(whole))
}

/// The marks of the timeline up to a step: later ones would tell where the run finds something.
fn landmarks_of(before: &Snapshot) -> Vec<(usize, Role)> {
    before.landmarks.iter().filter(|(event, _)| *event <= before.cursor.event).copied().collect()
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
    use motionscope_core::scene::{Reply, Unit};

    use super::*;

    motionscope_core::pseudocode! {
        TEST: "test",
    }

    motionscope_core::variables! {
        /// A length.
        LENGTH: "Length", "d", Unit::new("px", 0);
    }

    const CHOICE: Question = Question::choice(
        "a",
        "A?",
        &[Reply::above(line::TEST, (value::LENGTH, 5.0), "Yes"), Reply::at(line::TEST, "No")],
    );
    const PLACE: Question = Question::place("b", "B?", line::TEST, Role::Best);
    const NUMBER: Question = Question::value("c", "C?", line::TEST, value::LENGTH);

    #[test]
    fn hands_are_counted_for_the_answers() {
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
    fn the_nearest_place_wins_and_directions_are_voted_for() {
        let answer = Answer::Place { on: Picture::NEXT, at: vec![[10.0, 4.0]], from: Some([8.0, 8.0]) };
        let mut guesses = Guesses::of(&PLACE, &answer);
        assert_eq!(guesses.hands.len(), 9);
        assert!(guesses.point(Focus::on(Picture::NEXT, [20.0, 4.0])) && guesses.point(Focus::current([13.0, 8.0])));
        assert!(guesses.vote(8, true) && guesses.vote(3, true));
        let verdict = guesses.verdict(&PLACE, &answer);
        assert_eq!((verdict.nearest, verdict.hands), (Some((2, 5.0)), [1, 2]));
        assert_eq!(verdict.right, ["Above", "Upper right"]);
        assert_eq!(
            verdict.text(),
            "(10.0, 4.0). Guess 2 of 2 is nearest, 5.0 px off. 1 of 2 hands for above or upper right."
        );
    }

    #[test]
    fn a_gate_is_not_given() {
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(2, 3, 4, 4));
        let gate = Shape::Ellipse { center: [4.0, 4.0], radii: [3.0, 2.0], angle_rad: 0.0 };
        scene.mark(Picture::CURRENT, Role::Window, gate);
        let given = |question| scene.marks.iter().map(|mark| is_given(question, mark)).collect::<Vec<_>>();
        assert_eq!((given(&CHOICE), given(&PLACE)), (vec![true, false], vec![true, true]));
    }

    #[test]
    fn a_place_is_looked_for_in_its_search_window_or_in_all_of_the_picture() {
        let place = |at| Answer::Place { on: Picture::NEXT, at, from: None };
        let mut scene = Scene::default();
        let whole = Some([[-0.5, -0.5], [63.5, 47.5]]);
        assert_eq!(searched(&scene, &place(vec![[9.0, 9.0]]), (64, 48)), whole);
        let (min, max) = ([3.5, 3.5], [19.5, 19.5]);
        scene.mark(Picture::NEXT, Role::Window, Shape::Rect { min, max });
        assert_eq!(searched(&scene, &place(vec![[9.0, 9.0]]), (64, 48)), Some([min, max]));
        assert_eq!(searched(&scene, &place(vec![[9.0, 9.0], [40.0, 9.0]]), (64, 48)), whole, "one lies outside");
        assert_eq!(searched(&scene, &Answer::Choice(0), (64, 48)), None);
    }

    #[test]
    fn a_direction_is_one_of_eight_or_between_two_of_them() {
        let named = |to| directions([8.0, 8.0], to).into_iter().map(|index| DIRECTIONS[index]).collect::<Vec<_>>();
        assert_eq!(named([8.3, 7.8]), ["Same place"]);
        assert_eq!(named([12.0, 8.0]), ["Right"]);
        assert_eq!(named([8.0, 3.0]), ["Above"]);
        assert_eq!(named([3.0, 12.0]), ["Lower left"]);
        assert_eq!(named([3.0, 10.0]), ["Lower left", "Left"]);
        for turn in 0..360_u16 {
            let (sin, cos) = f32::from(turn).to_radians().sin_cos();
            let all = directions([0.0; 2], [9.0 * cos, 9.0 * sin]);
            assert!((1..=2).contains(&all.len()), "{turn}°: {all:?}");
        }
    }

    #[test]
    fn numbers_are_compared_in_their_unit() {
        let answer = Answer::Number { value: 12.5, shown: "12.5".into() };
        let mut guesses = Guesses::of(&NUMBER, &answer);
        assert!(!guesses.number(f64::NAN) && guesses.number(14.0) && !guesses.vote(0, true));
        assert_eq!(guesses.verdict(&NUMBER, &answer).text(), "12.5 px. The guess is 1.5 px off.");
        assert!(guesses.number(12.5));
        assert_eq!(guesses.verdict(&NUMBER, &answer).text(), "12.5 px. Guess 2 of 2 is nearest, exact.");
    }
}
