//! The numbers of a step that differ from those of the step before.
//!
//! `Walk::step_before` gives the explanation one event earlier; the values of formulas and facts are compared with it.

use motionscope_core::scene::{Fact, Math};

use super::super::primitive::Rect;
use super::formula::{Formula, Placed};

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

/// Whether `differing` of `all` numbers are lit: where each of them differs, there is nothing to tell apart.
fn is_told(differing: usize, all: usize) -> bool {
    (1..all).contains(&differing)
}

/// Where values of each formula stand that differ from those that the formulas `before` give to the same variables, from the left end of
/// the first baseline. There are none where all of them differ.
pub(super) fn of_formulas(now: &[Formula], before: &[Math]) -> Vec<Vec<Rect>> {
    let mut old: Vec<_> = before.iter().flat_map(Math::values).collect();
    let (mut all, mut differing) = (0, 0);
    let mut differs = |placed: &Placed| {
        // A variable that stands at several places had as many values before.
        let Some(at) = old.iter().position(|(value, _)| value.of == placed.of) else { return false };
        let (value, style) = old.remove(at);
        let is_other = style.text(value) != placed.shown;
        all += 1;
        differing += usize::from(is_other);
        is_other
    };
    let lit: Vec<Vec<Rect>> = now
        .iter()
        .map(|formula| formula.values.iter().filter(|placed| differs(placed)).map(|placed| placed.rect).collect())
        .collect();
    if is_told(differing, all) { lit } else { vec![Vec::new(); now.len()] }
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
    use motionscope_core::scene::{Name, Step, Unit};

    use super::super::formula::typeset;
    use super::*;

    motionscope_core::variables! {
        /// A summand.
        SUMMAND: "Summand", "a", Unit::WHOLE;
        /// A result.
        RESULT: "Result", "s", Unit::WHOLE;
    }

    fn sum(summand: i32, result: i32) -> Vec<Math> {
        let step = Step::at(Name::new(b"add")).put(value::SUMMAND, summand).put(value::RESULT, result);
        step.formula("s = 4 + {summand} = {result}").formulas().to_vec()
    }

    fn lit(now: &[Math], before: &[Math]) -> Vec<usize> {
        let now: Vec<_> = now.iter().map(|math| typeset(math, 20.0, 900.0)).collect();
        of_formulas(&now, before).iter().map(Vec::len).collect()
    }

    #[test]
    fn values_that_differ_are_lit_and_the_others_are_not() {
        let [now, before] = [[sum(1, 5), sum(2, 6)].concat(), [sum(1, 5), sum(3, 6)].concat()];
        assert_eq!(lit(&now, &before), [0, 1], "each is compared with that at its own place");
        assert_eq!(lit(&now, &now), [0, 0]);
        let [place] = of_formulas(&[typeset(&sum(1, 5)[0], 20.0, 900.0)], &sum(1, 7))[0][..] else { panic!("one") };
        let from = super::super::formula::typeset(&sum(1, 5)[0], 20.0, 900.0).values[1].rect;
        assert_eq!(place, from);
    }

    #[test]
    fn nothing_is_lit_where_all_values_are_others_or_the_formula_is() {
        assert_eq!(lit(&sum(1, 5), &sum(2, 6)), [0]);
        assert_eq!(lit(&sum(1, 5), &[Math::text("5 = 4 + 1")]), [0]);
        assert_eq!(lit(&sum(1, 5), &[]), [0]);
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
