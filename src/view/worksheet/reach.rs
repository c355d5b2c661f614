//! What can be computed by hand: from numbers that are printed, in few operations.

use std::collections::BTreeSet;

use motionscope_core::scene::{Fact, Math, Matrix};

use super::numbers::has_values;

/// A product of larger matrices is no work by hand, unless its result is as narrow as a vector.
const MOST_SIDE: usize = 3;
const NARROW: usize = 2;

/// What is printed of a step, from which its results can be computed.
#[derive(Clone, Debug, Default)]
pub struct Printed {
    /// Symbols whose values are printed.
    pub names: BTreeSet<String>,
    /// Sums of windows of which enough pixels are printed.
    pub totals: Vec<String>,
}

impl Printed {
    /// The symbols of labelled numbers and matrices, and `defined` ones.
    pub fn names(facts: &[Fact], matrices: &[Matrix], defined: impl IntoIterator<Item = String>) -> BTreeSet<String> {
        let around = |letter: char| "(),²|".contains(letter);
        let of_label = |fact: &Fact| -> Vec<String> {
            fact.label.split_whitespace().map(|word| lowered(word.trim_matches(around))).collect()
        };
        let of_matrices = matrices.iter().map(|matrix| matrix.symbol.replace(' ', ""));
        facts.iter().flat_map(of_label).chain(of_matrices).chain(defined).filter(|name| !name.is_empty()).collect()
    }

    /// Whether a value of these `numbers` can be computed from `side`, to which it is equal.
    pub fn reaches(&self, side: &Math, numbers: &[String]) -> bool {
        if numbers.iter().any(|number| self.totals.contains(number)) {
            return true;
        }
        let mut symbols = Vec::new();
        symbols_of(side, &mut symbols);
        let is_named = || symbols.iter().all(|name| self.names.contains(name));
        !has_sum(side) && !side.plain().contains('…') && (has_values(side) || is_named())
    }
}

/// Whether a matrix of this size can be computed by hand.
pub fn is_small((width, height): (usize, usize)) -> bool {
    width.min(height) <= NARROW || width.max(height) <= MOST_SIDE
}

/// Whether a formula runs over terms that it does not write out.
pub fn has_sum(math: &Math) -> bool {
    math.plain().contains(['Σ', '∏'])
}

/// The vectors, matrices and symbols with an index in a formula, in plain letters.
fn symbols_of(math: &Math, symbols: &mut Vec<String>) {
    if let Some(name) = math.prediction() {
        return symbols.push(name);
    }
    match math {
        Math::Bold(name) => symbols.push((*name).to_owned()),
        Math::Sub(..) => symbols.push(math.plain()),
        Math::Row(parts) => parts.iter().for_each(|part| symbols_of(part, symbols)),
        Math::Matrix(rows) => rows.iter().flatten().for_each(|entry| symbols_of(entry, symbols)),
        Math::Frac(top, bottom) => [top, bottom].into_iter().for_each(|part| symbols_of(part, symbols)),
        Math::Sup(inner, _) | Math::Abs(inner) | Math::Sqrt(inner) | Math::Bar(inner) | Math::Hat(inner) => {
            symbols_of(inner, symbols);
        }
        Math::Text(..) | Math::Value(..) | Math::Var(_) | Math::Sum(_) => {}
    }
}

/// A word in which digits below the line stand behind a low line, as in the plain letters of formulas.
fn lowered(word: &str) -> String {
    let mut plain = String::new();
    let mut is_low = false;
    for letter in word.chars() {
        match u32::from(letter).checked_sub(u32::from('₀')).and_then(|digit| char::from_digit(digit, 10)) {
            Some(digit) => {
                plain.extend((!is_low).then_some('_'));
                plain.push(digit);
                is_low = true;
            }
            None => {
                plain.push(letter);
                is_low = false;
            }
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::super::tests::formula;
    use super::*;

    fn indexed(name: &'static str, index: &str) -> Math {
        Math::indexed(Math::Var(name), Math::text(index))
    }

    /// Whether a value is reached from a side where these are printed.
    fn reaches(printed: &Printed, side: Vec<Math>) -> bool {
        printed.reaches(&Math::Row(side), &["12.50".to_owned()])
    }

    #[test]
    fn a_value_is_reached_from_numbers_and_from_printed_symbols() {
        let facts = [Fact::new("I_x, I_y, I_t", "1, 2, 3", None), Fact::new("Zeroth moment M₀₀", "25.4", None)];
        let printed = Printed { names: Printed::names(&facts, &[], ["ρ".to_owned()]), ..Printed::default() };
        assert!(reaches(&printed, vec![formula("{a} / {b}")]));
        assert!(reaches(&printed, vec![indexed("I", "x"), Math::Var("u"), Math::text(" + "), indexed("I", "t")]));
        assert!(reaches(&printed, vec![indexed("M", "00")]));
        assert!(!reaches(&printed, vec![Math::over(indexed("M", "10"), indexed("M", "00"))]), "M_10 is not printed");
        assert!(!reaches(&printed, vec![Math::Bold("S")]), "a matrix that is not printed");
        assert!(!reaches(&printed, vec![formula(r"{a} + \dots + {b}")]), "terms are left out");
    }

    #[test]
    fn a_sum_is_reached_where_all_but_a_few_of_its_terms_are_printed() {
        let sum = || vec![Math::Sum(Box::new(Math::text("x"))), indexed("I", "x")];
        let totals = Printed { totals: vec!["12.50".into()], ..Printed::default() };
        assert!(reaches(&totals, sum()) && !reaches(&Printed::default(), sum()));
    }

    #[test]
    fn large_matrices_are_no_work_by_hand() {
        let small = [(3, 3), (1, 6), (2, 4)];
        assert!(small.into_iter().all(is_small) && !is_small((4, 4)) && !is_small((6, 6)));
    }
}
