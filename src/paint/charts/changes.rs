//! The numbers of a step that differ from those of the step before.

use std::ops::Range;

use motionscope_core::scene::Fact;

use super::super::primitive::Rect;
use super::super::{Face, fonts, places};
use super::formula::{Formula, Piece};

/// What a step shows, and what the step before it showed; empty where nothing is compared.
#[derive(Debug)]
pub struct Since<'a, T> {
    /// That of the step.
    pub now: &'a [T],
    /// That of the step before.
    pub before: &'a [T],
}

impl<T> Clone for Since<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Since<'_, T> {}

impl<T> Since<'_, T> {
    /// Whether the step shows nothing.
    pub fn is_empty(&self) -> bool {
        self.now.is_empty()
    }

    /// How many things the step shows.
    pub fn len(&self) -> usize {
        self.now.len()
    }

    /// The first `count` of them, beside all of the step before.
    #[must_use]
    pub fn first(self, count: usize) -> Self {
        Self { now: &self.now[..count.min(self.now.len())], ..self }
    }

    /// Those before the one at `index`, and those from it on.
    pub fn split_at(self, index: usize) -> (Self, Self) {
        let (now, before) = (self.now.split_at(index), self.before.split_at_checked(index).unwrap_or_default());
        (Self { now: now.0, before: before.0 }, Self { now: now.1, before: before.1 })
    }
}

impl<'a, T> From<&'a [T]> for Since<'a, T> {
    fn from(now: &'a [T]) -> Self {
        Self { now, before: &[] }
    }
}

impl<'a, T> From<&'a Vec<T>> for Since<'a, T> {
    fn from(now: &'a Vec<T>) -> Self {
        Self::from(&now[..])
    }
}

impl<'a, T, const N: usize> From<&'a [T; N]> for Since<'a, T> {
    fn from(now: &'a [T; N]) -> Self {
        Self::from(&now[..])
    }
}

/// Numbers that stand in the same words as before: how many there are, and where those are that differ.
#[derive(Debug, Default, PartialEq)]
struct Compared {
    count: usize,
    differing: Vec<Range<usize>>,
}

impl Compared {
    /// All numbers of words that stand nowhere in the formula before.
    fn new(words: &str) -> Self {
        let differing = places(words);
        Self { count: differing.len(), differing }
    }
}

/// The numbers of `now` beside those of `before`; `None` where the words between them differ.
fn compared(now: &str, before: &str) -> Option<Compared> {
    let (places, old) = (places(now), places(before));
    let are_same_words = places.len() == old.len() && between(now, &places).eq(between(before, &old));
    let differs = |(place, old): &(Range<usize>, Range<usize>)| now[place.clone()] != before[old.clone()];
    are_same_words.then(|| Compared {
        count: places.len(),
        differing: places.into_iter().zip(old).filter(differs).map(|(place, _)| place).collect(),
    })
}

/// The words around the numbers of a text.
fn between<'t>(text: &'t str, numbers: &'t [Range<usize>]) -> impl Iterator<Item = &'t str> {
    let starts = std::iter::once(0).chain(numbers.iter().map(|place| place.end));
    let ends = numbers.iter().map(|place| place.start).chain([text.len()]);
    starts.zip(ends).map(|(start, end)| &text[start..end])
}

/// Whether `differing` of `all` numbers are lit: where each of them differs, there is nothing to tell apart.
fn is_told(differing: usize, all: usize) -> bool {
    (1..all).contains(&differing)
}

/// Where numbers of each formula stand that differ from those of the formulas `before`, from the left end of the first baseline.
/// There are none where all numbers differ, or the formulas are others.
pub(super) fn of_formulas(now: &[Formula], before: &[Formula]) -> Vec<Vec<Rect>> {
    let none = || vec![Vec::new(); now.len()];
    if now.len() != before.len() {
        return none();
    }
    let (mut all, mut lit) = (0, Vec::new());
    for (now, before) in now.iter().zip(before) {
        let (count, rects) = of_formula(now, before).unwrap_or_default();
        all += count;
        lit.push(rects);
    }
    if is_told(lit.iter().map(Vec::len).sum(), all) { lit } else { none() }
}

/// The count of numbers of a formula, and the places of those that differ; `None` if it is another formula. Its parts are compared from
/// both ends on: those in the middle without a counterpart, such as the 1 of x + 1 after x, have changed.
fn of_formula(now: &Formula, before: &Formula) -> Option<(usize, Vec<Rect>)> {
    let [now, before] = [now, before].map(|formula| formula.pieces.iter().filter_map(Text::of).collect::<Vec<_>>());
    let from_start = || now.iter().zip(&before).map_while(|(now, old)| compared(now.words, old.words));
    let start = from_start().count();
    let (middle, old) = (&now[start..], &before[start..]);
    let from_end = || middle.iter().rev().zip(old.iter().rev()).map_while(|(now, old)| compared(now.words, old.words));
    let end = middle.len() - from_end().count();
    if 2 * (end.max(old.len() + end - middle.len())) > now.len() {
        return None;
    }
    let mut all: Vec<(&Text<'_>, Compared)> = now.iter().zip(from_start()).collect();
    all.extend(middle[..end].iter().map(|text| (text, Compared::new(text.words))));
    all.extend(middle.iter().rev().zip(from_end()));
    let count = all.iter().map(|(_, compared)| compared.count).sum();
    Some((
        count,
        all.iter().flat_map(|(text, compared)| compared.differing.iter().map(|place| text.rect(place))).collect(),
    ))
}

/// A run of text of a formula.
struct Text<'f> {
    words: &'f str,
    at: [f32; 2],
    size_pt: f32,
    face: Face,
}

impl<'f> Text<'f> {
    fn of(piece: &'f Piece) -> Option<Self> {
        let Piece::Text { text, at, size_pt, face, .. } = piece else { return None };
        Some(Self { words: text, at: *at, size_pt: *size_pt, face: *face })
    }

    /// Where these bytes of it stand.
    fn rect(&self, place: &Range<usize>) -> Rect {
        let Self { words, at: [left, y], size_pt, face } = *self;
        let width = |text: &str| fonts::width(text, face, size_pt);
        let corner = [left + width(&words[..place.start]), y - 0.85 * size_pt];
        Rect::new(corner, [width(&words[place.clone()]), 1.12 * size_pt])
    }
}

/// Which facts have another value than the fact of the same name `before`; none where all of them have.
pub(super) fn of_facts(facts: Since<'_, Fact>) -> Vec<bool> {
    let value_before = |label| facts.before.iter().find(|fact| fact.label == label).map(|fact| &fact.value);
    let known: Vec<_> = facts.now.iter().map(|fact| value_before(fact.label).map(|old| *old != fact.value)).collect();
    let differing = known.iter().filter(|known| **known == Some(true)).count();
    let is_told = is_told(differing, known.iter().flatten().count());
    known.into_iter().map(|known| is_told && known == Some(true)).collect()
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Math;

    use super::super::formula::typeset;
    use super::*;

    fn lit(now: &[Math], before: &[Math]) -> Vec<usize> {
        let [now, before] = [now, before].map(|all| all.iter().map(|m| typeset(m, 20.0, 900.0)).collect::<Vec<_>>());
        of_formulas(&now, &before).iter().map(Vec::len).collect()
    }

    fn sum(first: &str, second: &str, result: &str) -> Math {
        let words = [first, " + ", second, " = ", result];
        Math::Row(words.into_iter().map(Math::text).collect())
    }

    #[test]
    fn numbers_that_differ_are_lit_and_the_others_are_not() {
        assert_eq!(lit(&[sum("1", "2", "3")], &[sum("1", "4", "5")]), [2]);
        assert_eq!(lit(&[sum("1", "2", "3"), Math::text("7")], &[sum("1", "2", "3"), Math::text("8")]), [0, 1]);
        assert_eq!(lit(&[sum("1", "2", "3")], &[sum("1", "2", "3")]), [0]);
    }

    #[test]
    fn a_number_without_a_counterpart_has_changed() {
        let moved = |by: &str, v: &str| {
            let words = ["SAD(", v, ") = ", "I(", "x", by, ", y) of ", "16", " px"];
            Math::Row(words.into_iter().filter(|words| !words.is_empty()).map(Math::text).collect())
        };
        assert_eq!(lit(&[moved(" + 1", "1, −1")], &[moved("", "0, −1")]), [2], "the 1 of (1, −1) and that of x + 1");
        assert_eq!(lit(&[moved(" − 1", "−1, −1")], &[moved(" + 1", "1, −1")]), [2]);
        assert_eq!(lit(&[moved("", "0, −1")], &[moved(" + 1", "1, −1")]), [1], "the 1 is gone");
    }

    #[test]
    fn nothing_is_lit_where_all_numbers_are_others_or_the_formula_is() {
        assert_eq!(lit(&[sum("1", "2", "3")], &[sum("4", "5", "9")]), [0]);
        assert_eq!(lit(&[sum("1", "2", "3")], &[Math::text("1 = 2 − 1")]), [0]);
        assert_eq!(lit(&[sum("1", "2", "3")], &[]), [0]);
    }

    #[test]
    fn the_place_is_that_of_the_number_in_its_words() {
        let formula = |value: &str| [typeset(&Math::text(format!("SAD = {value} + 4")), 20.0, 900.0)];
        let rects = of_formulas(&formula("812"), &formula("7"));
        let from = fonts::width("SAD = ", super::super::super::Face::Sans, 20.0);
        assert!((rects[0][0].min[0] - from).abs() < 0.01 && rects[0].len() == 1, "{rects:?}");
    }

    #[test]
    fn facts_are_compared_by_name() {
        let fact = |label, value: &str| Fact::new(label, value, None);
        let now = [fact("Candidate", "9"), fact("Best so far", "5"), fact("New", "1")];
        let before = [fact("Best so far", "5"), fact("Candidate", "8")];
        assert_eq!(of_facts(Since { now: &now, before: &before }), [true, false, false]);
        assert_eq!(of_facts(Since { now: &now[..1], before: &before }), [false], "nothing stays");
        assert_eq!(of_facts(Since::from(&now)), [false; 3]);
        // The first of four facts, where the step before had fewer.
        let four = [fact("Candidate", "9"), fact("Best so far", "5"), fact("New", "1"), fact("Last", "2")];
        assert_eq!(of_facts(Since { now: &four, before: &before }.first(3)), [true, false, false]);
    }
}
