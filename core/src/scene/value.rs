//! Named values of a step: declared once, filled when a step is explained, read by everything that needs a number.

use std::fmt::Write as _;

use super::Role;
use crate::base::words::{fixed, grouped, plural, rounded, with_power};
use crate::geometry::Grid;

/// The declaration of a value, made with [`variables!`](crate::variables!).
#[derive(Debug, PartialEq)]
pub struct Variable {
    /// Its name in templates and data: `kalman-gain` is `{kalman_gain}` in a template.
    pub name: &'static str,
    /// Its label in a list: `Kalman gain`.
    pub label: &'static str,
    /// Its symbol in LaTeX; empty if it has none.
    pub symbol: &'static str,
    /// How it is written.
    pub unit: Unit,
    /// The role of its marks, whose colour it carries.
    pub role: Option<Role>,
    /// Its definition in one sentence.
    pub definition: &'static str,
}

impl Variable {
    /// The value of the variable at a step.
    pub fn is(&'static self, number: impl Into<Number>) -> Value {
        Value { of: self, number: number.into(), unit: self.unit, role: self.role }
    }

    /// Whether `name`, as a template writes it, is the name of this variable.
    pub const fn is_called(&self, name: &str) -> bool {
        is_same_name(self.name.as_bytes(), name.as_bytes())
    }
}

/// Whether a letter of a template is one of a name: `_` stands for `-`.
const fn is_same_letter(a: u8, b: u8) -> bool {
    a.eq_ignore_ascii_case(&b) || matches!((a, b), (b'-', b'_') | (b'_', b'-'))
}

/// Whether both spell one name.
pub(super) const fn is_same_name(a: &[u8], b: &[u8]) -> bool {
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if !is_same_letter(a[i], b[i]) {
            return false;
        }
        i += 1;
    }
    true
}

/// A unit with the decimals of its quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// The unit as it stands behind a number; empty for a pure number. Of a count, what is counted: `candidate`.
    pub name: &'static str,
    /// The decimals.
    pub decimals: Decimals,
}

/// The decimals of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decimals {
    /// Always this many.
    Fixed(u8),
    /// This many, but none where all components are whole.
    WholeOr(u8),
    /// This many, with a plus sign before what is not negative.
    Signed(u8),
    /// At most this many, without zeros at the end.
    AtMost(u8),
    /// This many, none from 100 000 on, where an `f32` has no more digits, but two digits and a power of ten where decimals would be
    /// zeros.
    OrPower(u8),
    /// None, but two digits and a power of ten from a million on.
    WholeOrPower,
    /// A count of things.
    Count,
}

impl Unit {
    /// A length or position in px.
    pub const PX: Self = Self::new("px", 2);
    /// A displacement in px that is whole unless it lies between pixels.
    pub const DISPLACEMENT: Self = Self { name: "px", decimals: Decimals::WholeOr(2) };
    /// A position or flow of a sub-pixel method, in px.
    pub const SUBPIXEL: Self = Self::new("px", 3);
    /// A velocity in px/frame.
    pub const SPEED: Self = Self::new("px/frame", 2);
    /// A difference, gradient or deviation in gray levels.
    pub const GRAY: Self = Self::new("gray levels", 2);
    /// The gray level of a pixel.
    pub const LEVEL: Self = Self::new("gray levels", 0);
    /// A squared difference in gray levels.
    pub const SQUARED_GRAY: Self = Self::new("gray levels²", 2);
    /// A share, weight, overlap or similarity without unit.
    pub const RATIO: Self = Self::new("", 3);
    /// A pure number with two decimals, as a squared Mahalanobis distance.
    pub const FINE: Self = Self::new("", 2);
    /// An eigenvalue or a response, which may be tiny.
    pub const RESPONSE: Self = Self { name: "", decimals: Decimals::OrPower(2) };
    /// A cost that is a sum of whole numbers.
    pub const WHOLE: Self = Self::new("", 0);
    /// A measured share in percent.
    pub const PERCENT: Self = Self::new("%", 1);
    /// A share in whole percent.
    pub const WHOLE_PERCENT: Self = Self::new("%", 0);
    /// An angle in degrees.
    pub const DEGREES: Self = Self::new("°", 0);
    /// A parameter without unit, as it was set.
    pub const SET: Self = Self { name: "", decimals: Decimals::AtMost(4) };

    /// A unit with a fixed number of decimals.
    pub const fn new(name: &'static str, decimals: u8) -> Self {
        Self { name, decimals: Decimals::Fixed(decimals) }
    }

    /// The count of things called `one` in the singular.
    pub const fn count(one: &'static str) -> Self {
        Self { name: one, decimals: Decimals::Count }
    }

    /// The same unit with further decimals of a number that is no count.
    #[must_use]
    pub const fn finer(self, further: u8) -> Self {
        let decimals = match self.decimals {
            Decimals::Fixed(decimals) => Decimals::Fixed(decimals + further),
            Decimals::Signed(decimals) => Decimals::Signed(decimals + further),
            Decimals::WholeOr(decimals) => Decimals::WholeOr(decimals + further),
            Decimals::AtMost(decimals) => Decimals::AtMost(decimals + further),
            Decimals::OrPower(decimals) => Decimals::OrPower(decimals + further),
            whole @ (Decimals::Count | Decimals::WholeOrPower) => whole,
        };
        Self { decimals, ..self }
    }

    /// The decimals that a number with these components is written with.
    fn decimals_of(self, components: &[f64]) -> usize {
        match self.decimals {
            Decimals::WholeOr(_) if components.iter().all(|c| c.fract() == 0.0) => 0,
            Decimals::OrPower(decimals) if components.iter().any(|c| c.abs() >= 1e5) => {
                decimals.saturating_sub(2).into()
            }
            Decimals::Fixed(decimals)
            | Decimals::Signed(decimals)
            | Decimals::AtMost(decimals)
            | Decimals::OrPower(decimals)
            | Decimals::WholeOr(decimals) => decimals.into(),
            Decimals::Count | Decimals::WholeOrPower => 0,
        }
    }

    /// Whether a number is written with a power of ten.
    fn has_power(self, number: f64) -> bool {
        match self.decimals {
            Decimals::OrPower(decimals) => number != 0.0 && number.abs() < 0.5 * 0.1f64.powi(decimals.into()),
            Decimals::WholeOrPower => number.abs() >= 1e6,
            _ => false,
        }
    }

    /// A number without its unit.
    fn digits(self, number: f64, decimals: usize) -> String {
        let digits = fixed(number, decimals);
        match self.decimals {
            _ if self.has_power(number) => with_power(number),
            Decimals::Signed(_) if !digits.starts_with('−') => format!("+{digits}"),
            Decimals::AtMost(_) if digits.contains('.') => digits.trim_end_matches('0').trim_end_matches('.').into(),
            _ => digits,
        }
    }
}

/// The content of a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Number {
    /// A real number or a count; a percentage is of 100.
    Real(f64),
    /// The components of a vector, or a place.
    Vector(Vec<f64>),
    /// The entries of a matrix.
    Matrix(Grid<f64>),
    /// A name from the clip, or one of several words that the estimator declares.
    Word(String),
    /// Several values of one kind.
    List(Vec<Number>),
}

macro_rules! reals {
    ($($of:ty),+) => {$(
        impl From<$of> for Number {
            fn from(number: $of) -> Self {
                Number::Real(number as f64)
            }
        }

        impl<const N: usize> From<[$of; N]> for Number {
            fn from(components: [$of; N]) -> Self {
                Number::Vector(components.map(|c| c as f64).into())
            }
        }

        impl From<($of, $of)> for Number {
            fn from((x, y): ($of, $of)) -> Self {
                Number::Vector(vec![x as f64, y as f64])
            }
        }
    )+};
}

reals!(f32, f64, usize, u64, u32, i32, u8);

impl From<&str> for Number {
    fn from(word: &str) -> Self {
        Number::Word(word.into())
    }
}

impl From<String> for Number {
    fn from(word: String) -> Self {
        Number::Word(word)
    }
}

impl From<Grid<f64>> for Number {
    fn from(entries: Grid<f64>) -> Self {
        Number::Matrix(entries)
    }
}

impl<T: Into<Number>> FromIterator<T> for Number {
    fn from_iter<I: IntoIterator<Item = T>>(all: I) -> Self {
        Number::List(all.into_iter().map(Into::into).collect())
    }
}

/// A value of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Its declaration.
    pub of: &'static Variable,
    /// The number at full precision.
    pub number: Number,
    /// How it is written.
    pub unit: Unit,
    /// The role whose colour it carries.
    pub role: Option<Role>,
}

/// How many values of a list are written.
const LISTED: usize = 6;

impl Value {
    /// The same value in another unit or with other decimals, where these depend on a parameter.
    #[must_use]
    pub fn in_unit(self, unit: Unit) -> Self {
        Self { unit, ..self }
    }

    /// The same value with another role, where that depends on a decision.
    #[must_use]
    pub fn inked(self, role: Role) -> Self {
        Self { role: Some(role), ..self }
    }

    /// The component `i` of a vector, from 1.
    pub(super) fn component(&self, i: usize) -> Option<Self> {
        let Number::Vector(all) = &self.number else { return None };
        Some(Self { number: Number::Real(*all.get(i.checked_sub(1)?)?), ..self.clone() })
    }

    /// The number without its unit, as it stands in a formula: `−1 234.50`, `(3, −2)`.
    pub fn bare(&self) -> String {
        self.written(&self.number)
    }

    /// The number with its unit, as it stands in a sentence: `5.53 gray levels`, `3 candidates`, `1, 2 and 3`.
    pub fn text(&self) -> String {
        let bare = match (self.bare(), &self.number) {
            (listed, Number::List(all)) if all.len() <= LISTED => match listed.rsplit_once(", ") {
                Some((first, last)) => format!("{first} and {last}"),
                None => listed,
            },
            (bare, _) => bare,
        };
        match (&self.number, self.unit) {
            (Number::Word(_), _) => bare,
            (_, Unit { name: "", .. }) => bare,
            (Number::Real(1.0), Unit { name, decimals: Decimals::Count }) => format!("1 {name}"),
            (Number::Real(_), Unit { name, decimals: Decimals::Count }) => format!("{bare} {}", plural(name)),
            (_, Unit { name, .. }) if name.starts_with('°') => bare + name,
            (_, Unit { name, .. }) => bare + " " + name,
        }
    }

    /// The number as it is written, read back: the true answer to a question for it.
    pub fn rounded(&self) -> Option<f64> {
        let Number::Real(number) = self.number else { return None };
        if self.unit.has_power(number) {
            return format!("{number:.1e}").parse().ok();
        }
        Some(rounded(number, self.unit.decimals_of(&[number])))
    }

    fn sum(&self) -> String {
        let Number::List(all) = &self.number else { return self.bare() };
        let terms = all.iter().take(LISTED).map(|number| self.written(number));
        let more = (all.len() > LISTED).then(|| "…".to_owned());
        terms.chain(more).collect::<Vec<_>>().join(" + ").replace("+ −", "− ")
    }

    fn written(&self, number: &Number) -> String {
        let unit = self.unit;
        match number {
            Number::Real(count) if unit.decimals == Decimals::Count => grouped(*count as usize),
            Number::Real(number) => unit.digits(*number, unit.decimals_of(&[*number])),
            Number::Vector(components) => {
                let decimals = unit.decimals_of(components);
                let components: Vec<_> = components.iter().map(|c| unit.digits(*c, decimals)).collect();
                // A no-break space.
                format!("({})", components.join(",\u{a0}"))
            }
            Number::Matrix(entries) => {
                let row = |y: usize| {
                    let entries = (0..entries.width()).map(|x| unit.digits(entries[(x, y)], unit.decimals_of(&[])));
                    entries.collect::<Vec<_>>().join(", ")
                };
                format!("[{}]", (0..entries.height()).map(row).collect::<Vec<_>>().join("; "))
            }
            Number::Word(word) => word.clone(),
            Number::List(all) => {
                let listed: Vec<_> = all.iter().take(LISTED).map(|number| self.written(number)).collect();
                let mut text = listed.join(", ");
                if all.len() > LISTED {
                    let _ = write!(text, " and {} more", grouped(all.len() - LISTED));
                }
                text
            }
        }
    }

    /// Whether it stands in parentheses behind a sign or below an exponent.
    pub(super) fn needs_parentheses(&self) -> bool {
        self.bare().starts_with('−') || self.bare().contains('·')
    }
}

/// How a formula shows a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueStyle {
    /// The number alone.
    Bare,
    /// The number with its unit: `{flow:unit}`.
    WithUnit,
    /// The number as a further summand, behind its sign: `{change:signed}` is `− 3.10`.
    Signed,
    /// The numbers of a list as the beginning of a sum: `{terms:sum}` is `3 + 5 + …` where more follow.
    Sum,
    /// The number in parentheses.
    InParentheses,
}

impl ValueStyle {
    /// The style of a word behind the name of a value; `None` for an unknown one.
    pub(super) fn called(word: &str) -> Option<Self> {
        match word {
            "" => Some(Self::Bare),
            "unit" => Some(Self::WithUnit),
            "signed" => Some(Self::Signed),
            "sum" => Some(Self::Sum),
            _ => None,
        }
    }

    /// The text of `value` in a formula.
    pub fn text(self, value: &Value) -> String {
        match self {
            Self::Bare => value.bare(),
            Self::WithUnit => value.text(),
            Self::Sum => value.sum(),
            Self::InParentheses => format!("({})", value.bare()),
            Self::Signed => match value.bare().strip_prefix('−') {
                Some(size) => format!(" − {size}"),
                None => format!(" + {}", value.bare()),
            },
        }
    }
}

/// Declares the values of a step: a module `value` with a [`Variable`] for each, and all of them as `value::ALL`.
///
/// Each has a definition (its doc comment), a label, a symbol in LaTeX, a unit, and a role if it has marks.
///
/// ```
/// use motionscope_core::scene::{Role, Unit};
/// motionscope_core::variables! {
///     /// The number of candidates tested so far.
///     TESTED: "Tested", "", Unit::count("candidate");
///     /// The lowest cost so far.
///     LOWEST_COST: "Minimum so far", r"c_{\min}", Unit::WHOLE, Role::Best;
/// }
///
/// # fn main() {
/// assert_eq!(value::TESTED.is(3_usize).text(), "3 candidates");
/// assert_eq!(value::ALL[1].name, "lowest-cost");
/// # }
/// ```
#[macro_export]
macro_rules! variables {
    (@ $vis:vis, $($(#[doc = $definition:literal])+ $name:ident: $label:literal, $symbol:literal, $unit:expr $(, $role:expr)?;)+) => {
        /// The values of a step by name.
        $vis mod value {
            #[allow(unused_imports, reason = "not every unit or role is needed everywhere")]
            use super::*;

            $(
                $(#[doc = $definition])+
                pub const $name: &$crate::scene::Variable = &$crate::scene::Variable {
                    name: $crate::scene::pseudocode::name_of(
                        &$crate::scene::pseudocode::kebab::<{ stringify!($name).len() }>(stringify!($name)),
                    ),
                    label: $label,
                    symbol: $symbol,
                    unit: $unit,
                    role: $crate::variables!(@role $($role)?),
                    definition: concat!($($definition),+),
                };
            )+

            /// All of them.
            #[allow(dead_code, reason = "cases of other modules may be over them")]
            pub const ALL: &[&$crate::scene::Variable] = &[$($name),+];
        }
    };
    (@role) => { None };
    (@role $role:expr) => { Some($role) };
    ($vis:vis mod value; $($rest:tt)+) => { $crate::variables!(@ $vis, $($rest)+); };
    ($($rest:tt)+) => { $crate::variables!(@ , $($rest)+); };
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::variables! {
        /// The displacement under test.
        CANDIDATE: "Candidate", r"\mathbf{d}", Unit::DISPLACEMENT, Role::Candidate;
        /// The matches found so far.
        MATCHES: "Matches", "", Unit::count("match");
        /// A threshold.
        LIMIT: "Threshold", "t", Unit::SET;
    }

    #[test]
    fn a_value_is_written_by_its_unit() {
        let text = |value: Value| value.text();
        assert_eq!(text(value::CANDIDATE.is([3.0, -2.0])), "(3,\u{a0}−2) px");
        assert_eq!(text(value::CANDIDATE.is([3.0, -2.5])), "(3.00,\u{a0}−2.50) px");
        assert_eq!(
            [1_usize, 3, 12_345].map(|n| text(value::MATCHES.is(n))),
            ["1 match", "3 matches", "12\u{202f}345 matches"]
        );
        assert_eq!([0.25, 2.0].map(|limit| text(value::LIMIT.is(limit))), ["0.25", "2"]);
        assert_eq!(text(value::LIMIT.is(0.5).in_unit(Unit::new("%", 1))), "0.5 %");
        assert_eq!(text(value::LIMIT.is(12.0).in_unit(Unit::DEGREES)), "12°");
        assert_eq!(text(value::LIMIT.is("none")), "none");
        let signed = Unit { decimals: Decimals::Signed(1), ..Unit::GRAY };
        assert_eq!(
            [2.0, -2.0].map(|by| text(value::LIMIT.is(by).in_unit(signed))),
            ["+2.0 gray levels", "−2.0 gray levels"]
        );
    }

    #[test]
    fn a_long_list_is_cut_and_says_so() {
        let costs = |count: i32| value::LIMIT.is((0..count).map(|cost| -cost).collect::<Number>());
        assert_eq!([3, 8].map(|count| ValueStyle::Sum.text(&costs(count))), ["0 − 1 − 2", "0 − 1 − 2 − 3 − 4 − 5 + …"]);
        let places: Number = (0..8).map(|x| [x, 1]).collect();
        assert!(value::CANDIDATE.is(places).bare().ends_with("(5,\u{a0}1) and 2 more"));
        assert_eq!([1, 2, 3].map(|count| costs(count).text()), ["0", "0 and −1", "0, −1 and −2"]);
    }

    #[test]
    fn the_number_of_a_question_is_the_one_that_is_shown() {
        let response = |number: f64| value::LIMIT.is(number).in_unit(Unit::RESPONSE);
        assert_eq!([0.000_264, -2.126].map(|number| response(number).rounded()), [0.00026, -2.13].map(Some));
        let written = [-219_023.4, -0.00026, 0.0, 0.08].map(|number| response(number).bare());
        assert_eq!(written, ["−219\u{202f}023", "−2.6·10⁻⁴", "0.00", "0.08"]);
        assert_eq!(response(0.002_644).in_unit(Unit::RESPONSE.finer(1)).bare(), "0.003");
        let ratio = Unit { decimals: Decimals::WholeOrPower, ..Unit::WHOLE };
        let written = [1.0, 12_345.0, 1.2e7, 80.0f64.exp()].map(|number| value::LIMIT.is(number).in_unit(ratio).bare());
        assert_eq!(written, ["1", "12\u{202f}345", "1.2·10⁷", "5.5·10³⁴"]);
        assert_eq!(value::LIMIT.is(0.123_46).rounded(), Some(0.1235));
        assert_eq!(value::LIMIT.is(2.5).in_unit(Unit::WHOLE).rounded(), Some(2.0), "as 2 is shown");
        assert_eq!(value::CANDIDATE.is([1.0, 2.0]).rounded(), None);
    }
}
