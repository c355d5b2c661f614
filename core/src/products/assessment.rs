//! Quality of a product: figures for scripts and tables, facts for display.

use crate::base::Error;
use crate::data::Clip;
use crate::scene::{Distribution, Fact};

/// The reference of a comparison: the clip with its ground truth, at the first frame of the run.
#[derive(Clone, Copy)]
pub struct Reference<'a> {
    /// The clip.
    pub clip: &'a Clip,
    /// The first frame of the run.
    pub frame: usize,
}

/// The declaration of a quality measure.
#[derive(Debug, PartialEq)]
pub struct Measure {
    /// Its name in JSON: letters, digits, underscores and points.
    pub key: &'static str,
    /// Its definition with the unit, in one sentence.
    pub doc: &'static str,
    /// The word for a value that is not a number; empty where it is unknown.
    pub otherwise: &'static str,
    /// Its column in a comparison, if any.
    pub column: Option<Column>,
    /// Whether it compares with ground truth: what a comparison shows first.
    pub is_against_truth: bool,
    /// Which of two values is better, unless it counts something or trades one quality for another.
    pub better: Option<Better>,
}

/// Which of two different numbers is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The smaller one: costs and errors.
    Smaller,
    /// The larger one: scores.
    Larger,
}

/// A column of a comparison.
#[derive(Debug, PartialEq)]
pub struct Column {
    /// Its heading in the window.
    pub heading: &'static str,
    /// Its name with the unit, for scripts.
    pub name: &'static str,
    /// Units of the measure per unit of the column.
    pub per: f64,
    /// Decimals in the window.
    pub digits: usize,
}

impl Measure {
    /// A measure without a column.
    pub const fn new(key: &'static str, doc: &'static str) -> Self {
        Self { key, doc, otherwise: "", column: None, is_against_truth: false, better: None }
    }

    /// The same with a column of the same name and unit.
    #[must_use]
    pub const fn in_column(self, heading: &'static str, digits: usize) -> Self {
        let name = self.key;
        self.in_column_as(Column { heading, name, per: 1.0, digits })
    }

    /// The same share with a column in percent.
    #[must_use]
    pub const fn in_percent(self, heading: &'static str, name: &'static str) -> Self {
        self.in_column_as(Column { heading, name, per: 0.01, digits: 1 })
    }

    /// The same with a column.
    #[must_use]
    pub const fn in_column_as(self, column: Column) -> Self {
        Self { column: Some(column), ..self }
    }

    /// The same as a measure that compares with ground truth.
    #[must_use]
    pub const fn against_truth(self) -> Self {
        Self { is_against_truth: true, ..self }
    }

    /// The same with a word for a value that is not a number.
    #[must_use]
    pub const fn or(self, otherwise: &'static str) -> Self {
        Self { otherwise, ..self }
    }

    /// The same as a cost or an error.
    #[must_use]
    pub const fn smaller_is_better(self) -> Self {
        Self { better: Some(Better::Smaller), ..self }
    }

    /// The same as a score.
    #[must_use]
    pub const fn larger_is_better(self) -> Self {
        Self { better: Some(Better::Larger), ..self }
    }
}

/// The value of a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Figure {
    /// A count.
    Count(u64),
    /// A real number.
    Real(f64),
    /// No number: the case that [`Measure::otherwise`] names, or unknown.
    None,
    /// No number: there is nothing to measure.
    Undefined,
}

impl Figure {
    /// The value as a real number, if it is one.
    pub fn real(self) -> Option<f64> {
        match self {
            Figure::Count(count) => Some(count as f64),
            Figure::Real(value) => Some(value).filter(|value| value.is_finite()),
            Figure::None | Figure::Undefined => None,
        }
    }
}

impl From<usize> for Figure {
    fn from(count: usize) -> Self {
        Figure::Count(count as u64)
    }
}

impl From<f64> for Figure {
    fn from(value: f64) -> Self {
        if value.is_finite() { Figure::Real(value) } else { Figure::None }
    }
}

impl<T: Into<Figure>> From<Option<T>> for Figure {
    fn from(value: Option<T>) -> Self {
        value.map_or(Figure::None, Into::into)
    }
}

/// A measure with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// The measure.
    pub measure: &'static Measure,
    /// Its value.
    pub value: Figure,
}

/// The scores of all `measures`, one for each of `values`.
pub(super) fn scores<const N: usize>(measures: &'static [Measure; N], values: [Figure; N]) -> Vec<Score> {
    measures.iter().zip(values).map(|(measure, value)| Score { measure, value }).collect()
}

/// The quality of a product.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assessment {
    /// Figures for scripts and tables.
    pub scores: Vec<Score>,
    /// Facts for display.
    pub facts: Vec<Fact>,
    /// A phrase: `31.20 dB PSNR`; empty if there is none.
    pub headline: String,
    /// A sentence for the conclusion of the run; empty if there is none.
    pub conclusion: String,
    /// The distribution of errors, if there are any.
    pub errors: Option<Distribution>,
    /// The reason why ground truth cannot be read, if it cannot.
    pub truth_error: Option<Error>,
    /// The reason why ground truth that can be read scores nothing, if it does not.
    pub truth_warning: Option<Error>,
}

impl Assessment {
    /// Both assessments joined.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        let Self { scores, facts, headline, conclusion, errors, truth_error, truth_warning } = other;
        self.scores.extend(scores);
        self.facts.extend(facts);
        if self.headline.is_empty() {
            self.headline = headline;
        }
        if self.conclusion.is_empty() {
            self.conclusion = conclusion;
        }
        self.errors = self.errors.or(errors);
        self.truth_error = self.truth_error.or(truth_error);
        self.truth_warning = self.truth_warning.or(truth_warning);
        self
    }

    /// The same with the scores of `measures` and `facts`.
    #[must_use]
    pub(super) fn with(mut self, scores: Vec<Score>, facts: Vec<Fact>) -> Self {
        self.scores.extend(scores);
        self.facts.extend(facts);
        self
    }

    /// The score of `measure`, if this product has it.
    pub fn score(&self, measure: &Measure) -> Option<&Score> {
        self.scores.iter().find(|score| score.measure.key == measure.key)
    }

    /// The value of `measure` as a real number, if it is known.
    pub fn value(&self, measure: &Measure) -> Option<f64> {
        self.score(measure)?.value.real()
    }
}

/// A fact without a role.
pub(super) fn fact(label: &'static str, value: impl Into<String>) -> Fact {
    Fact::new(label, value, None)
}
