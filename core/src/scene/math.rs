//! Formulas as trees, and their text on one line.

use super::Role;
use super::value::{Value, ValueStyle};

/// A typeset formula.
#[derive(Clone, Debug, PartialEq)]
pub enum Math {
    /// Upright numbers and operators, in a role's colour if it has one.
    Text(String, Option<Role>),
    /// A value of the step.
    Value(Box<Value>, ValueStyle),
    /// An italic variable.
    Var(&'static str),
    /// A vector or a matrix, in bold type.
    Bold(&'static str),
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
    /// Under a root whose bar reaches to its end.
    Sqrt(Box<Math>),
    /// Under a bar, as the mean of u is written.
    Bar(Box<Math>),
    /// Under a circumflex, as an estimate of x is written.
    Hat(Box<Math>),
    /// A matrix in brackets, row by row; a column vector has rows of one entry.
    Matrix(Vec<Vec<Math>>),
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

    /// `base` squared.
    pub fn squared(base: Math) -> Self {
        Math::power(base, Math::text("2"))
    }

    /// `top` over `bottom`.
    pub fn over(top: Math, bottom: Math) -> Self {
        Math::Frac(Box::new(top), Box::new(bottom))
    }

    /// `inner` between vertical bars.
    pub fn abs(inner: Math) -> Self {
        Math::Abs(Box::new(inner))
    }

    /// The square root of `inner`.
    pub fn root(inner: Math) -> Self {
        Math::Sqrt(Box::new(inner))
    }

    /// The mean of `inner`, a bar above it.
    pub fn mean(inner: Math) -> Self {
        Math::Bar(Box::new(inner))
    }

    /// A column vector in brackets.
    pub fn column(entries: impl IntoIterator<Item = Math>) -> Self {
        Math::Matrix(entries.into_iter().map(|entry| vec![entry]).collect())
    }

    /// Its values and how each is written, from left to right.
    pub fn values(&self) -> Vec<(&Value, ValueStyle)> {
        match self {
            Math::Value(value, style) => vec![(value, *style)],
            Math::Text(..) | Math::Var(_) | Math::Bold(_) => Vec::new(),
            Math::Row(parts) => parts.iter().flat_map(Math::values).collect(),
            Math::Matrix(rows) => rows.iter().flatten().flat_map(Math::values).collect(),
            Math::Sub(first, second) | Math::Sup(first, second) | Math::Frac(first, second) => {
                [first.values(), second.values()].concat()
            }
            Math::Sum(of) | Math::Abs(of) | Math::Sqrt(of) | Math::Bar(of) | Math::Hat(of) => of.values(),
        }
    }

    /// The name of a symbol with a minus sign as exponent, as of a predicted covariance: `P⁻`.
    pub fn prediction(&self) -> Option<String> {
        match self {
            Math::Sup(base, sign) if sign.plain() == "−" => Some(base.plain() + "⁻"),
            _ => None,
        }
    }

    /// The formula on one line, for a screen reader or the clipboard.
    pub fn plain(&self) -> String {
        match self {
            Math::Text(text, _) => text.clone(),
            Math::Value(value, style) => style.text(value),
            Math::Var(name) | Math::Bold(name) => (*name).into(),
            Math::Row(parts) => {
                let words = parts.iter().map(Math::plain).enumerate().map(|(i, word)| {
                    // Without a space the letter would be a part of the index before it.
                    let is_apart =
                        i > 0 && matches!(parts[i - 1], Math::Sub(..)) && word.starts_with(char::is_alphabetic);
                    if is_apart { format!(" {word}") } else { word }
                });
                words.collect()
            }
            Math::Sub(base, index) => format!("{}_{}", base.plain(), index.plain()),
            Math::Sup(base, exponent) => {
                self.prediction().unwrap_or_else(|| format!("{}^{}", base.plain(), exponent.plain()))
            }
            Math::Frac(top, bottom) => format!("({})/({})", top.plain(), bottom.plain()),
            Math::Sum(index) if index.plain().is_empty() => "Σ ".into(),
            Math::Sum(index) => format!("Σ_{} ", index.plain()),
            Math::Abs(inner) => format!("|{}|", inner.plain()),
            Math::Sqrt(inner) => format!("√({})", inner.plain()),
            Math::Bar(inner) => match inner.as_ref() {
                Math::Sub(base, index) => format!("{}_{}", overlined(&base.plain()), index.plain()),
                inner => overlined(&inner.plain()),
            },
            Math::Hat(inner) => match inner.as_ref() {
                Math::Sub(base, index) => format!("{}\u{302}_{}", base.plain(), index.plain()),
                inner => format!("{}\u{302}", inner.plain()),
            },
            Math::Matrix(rows) => {
                let row = |row: &Vec<Math>| row.iter().map(Math::plain).collect::<Vec<_>>().join(", ");
                format!("[{}]", rows.iter().map(row).collect::<Vec<_>>().join("; "))
            }
        }
    }
}

/// A letter with a macron, `ū`; of more than a letter, the mean in words.
fn overlined(plain: &str) -> String {
    match plain.chars().count() {
        1 => format!("{plain}\u{304}"),
        _ => format!("mean({plain})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_formula_is_read_on_one_line() {
        let u = || Math::Var("u");
        let root = Math::root(Math::Row(vec![Math::squared(u()), Math::text(" + "), Math::squared(Math::Var("v"))]));
        assert_eq!(root.plain(), "√(u^2 + v^2)");
        assert_eq!(Math::mean(u()).plain(), "u\u{304}");
        assert_eq!(Math::mean(Math::indexed(u(), Math::text("0"))).plain(), "u\u{304}_0");
        assert_eq!(Math::mean(Math::Row(vec![u(), Math::Var("v")])).plain(), "mean(uv)");
        let entry = |shown: &str| Math::text(shown);
        let matrix = Math::Matrix(vec![vec![entry("a"), entry("b")], vec![entry("c"), entry("d")]]);
        assert_eq!(matrix.plain(), "[a, b; c, d]");
        assert_eq!(Math::column([u(), Math::Var("v")]).plain(), "[u; v]");
        assert_eq!(Math::Bold("T").plain(), "T");
    }
}
