//! Sentences with roles, and formulas.

use super::Role;

/// A sentence in which some words carry a role's colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sentence(pub Vec<(String, Option<Role>)>);

impl Sentence {
    /// Adds plain words.
    #[must_use]
    pub fn text(mut self, words: impl Into<String>) -> Self {
        self.0.push((words.into(), None));
        self
    }

    /// Adds words that carry a role's colour.
    #[must_use]
    pub fn ink(mut self, role: Role, words: impl Into<String>) -> Self {
        self.0.push((words.into(), Some(role)));
        self
    }

    /// The sentence without colours, with plain spaces.
    pub fn plain(&self) -> String {
        self.0.iter().map(|(words, _)| words.replace('\u{a0}', " ")).collect()
    }
}

/// A typeset formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Math {
    /// Upright numbers and operators, in a role's colour if it has one.
    Text(String, Option<Role>),
    /// An italic variable.
    Var(&'static str),
    /// One after the other.
    Row(Vec<Math>),
    /// A base with an index below right.
    Sub(Box<Math>, Box<Math>),
    /// A base with an exponent above right.
    Sup(Box<Math>, Box<Math>),
    /// A fraction.
    Frac(Box<Math>, Box<Math>),
    /// A sum sign with its running index below.
    Sum(Box<Math>),
    /// Between vertical bars.
    Abs(Box<Math>),
}

impl Math {
    /// Upright text.
    pub fn text(text: impl Into<String>) -> Self {
        Math::Text(text.into(), None)
    }

    /// Upright text in a role's colour.
    pub fn ink(role: Role, text: impl Into<String>) -> Self {
        Math::Text(text.into(), Some(role))
    }

    /// `base` with `index` below right.
    pub fn indexed(base: Math, index: Math) -> Self {
        Math::Sub(Box::new(base), Box::new(index))
    }

    /// `base` with `exponent` above right.
    pub fn power(base: Math, exponent: Math) -> Self {
        Math::Sup(Box::new(base), Box::new(exponent))
    }

    /// The formula on one line, for a screen reader or the clipboard.
    pub fn plain(&self) -> String {
        match self {
            Math::Text(text, _) => text.clone(),
            Math::Var(name) => (*name).into(),
            Math::Row(parts) => parts.iter().map(Math::plain).collect(),
            Math::Sub(base, index) => format!("{}_{}", base.plain(), index.plain()),
            Math::Sup(base, exponent) => format!("{}^{}", base.plain(), exponent.plain()),
            Math::Frac(top, bottom) => format!("({})/({})", top.plain(), bottom.plain()),
            Math::Sum(index) => format!("Σ_{} ", index.plain()),
            Math::Abs(inner) => format!("|{}|", inner.plain()),
        }
    }
}
