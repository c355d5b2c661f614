//! Parameters declared once: default, range, unit and doc comment.
//!
//! Sliders, tooltips, `--set` flags, `motionscope list`, sessions and the property tests all read the
//! same declaration, made with [`params!`](crate::params!) and [`choices!`](crate::choices!).
//!
//! Shared parameters are declared once: a field of a `params!` struct may be another such struct, whose parameters are inserted
//! in its place with the field's defaults (`settings: Settings = Settings { opening: 1, ..Settings::default() }`). Behind the
//! struct, `advanced { "name" }` names parameters that are seldom changed, and `when { "name": |p| condition, "Sentence."; }`
//! says when one has an effect and why it has none otherwise; both reach into shared declarations. [`Params::idle`] gives the
//! reason for the present values. A law changes each idle parameter and requires the same result.

mod field;
mod part;
mod placed;

use std::fmt;

pub use field::{Declared, Field};
pub use part::{Part, PartKind, StageValue};
pub use placed::{Contour, Figure, Line, Lines, Placed, Spot, Spots, Zones};

use crate::base::{Error, words};

/// The value of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A whole number.
    Int(i64),
    /// A real number.
    Real(f64),
    /// A switch.
    Switch(bool),
    /// One of a few named choices, by its kebab-case name.
    Choice(&'static str),
    /// A figure placed on the picture.
    Placed(Placed),
    /// A stage with parameters of its own, by its id.
    Stage(StageValue),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Int(v) => write!(f, "{v}"),
            Value::Real(v) => write!(f, "{v}"),
            Value::Switch(v) => f.write_str(if *v { "on" } else { "off" }),
            Value::Choice(v) => f.write_str(v),
            Value::Placed(v) => write!(f, "{v}"),
            Value::Stage(v) => f.write_str(v.id()),
        }
    }
}

/// A number with thin spaces between its thousands.
fn grouped(value: i64) -> String {
    let sign = if value < 0 { "−" } else { "" };
    format!("{sign}{}", words::spaced(&value.unsigned_abs().to_string()))
}

/// The type and range of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A whole number from `min` to `max`, both allowed.
    Int {
        /// Smallest value.
        min: i64,
        /// Largest value.
        max: i64,
    },
    /// A real number from `min` to `max`, both allowed.
    Real {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
    /// On or off.
    Switch,
    /// One of several choices.
    Choice(Vec<Choice>),
    /// A figure placed on the picture.
    Placed(Figure),
    /// A stage with parameters of its own.
    Stage(PartKind),
    /// A value of kind `of`, or a word for automatic.
    Optional {
        /// The kind of an explicit value.
        of: Box<Kind>,
        /// The word for no explicit value: `auto`.
        word: &'static str,
    },
}

impl Kind {
    /// The allowed values in words, with `unit` after numbers.
    fn allowed(&self, unit: &str) -> String {
        match self {
            Kind::Int { min, max } => format!("{} to {}{unit}", grouped(*min), grouped(*max)),
            Kind::Real { min, max } => format!("{} to {}{unit}", limit(*min), limit(*max)),
            Kind::Switch => "on or off".into(),
            Kind::Placed(figure) => figure.allowed().into(),
            Kind::Stage(kind) => one_of(&kind.ids()),
            Kind::Choice(all) => one_of(&names(all)),
            Kind::Optional { of, word } => match &**of {
                Kind::Choice(all) => one_of(&[names(all), vec![word]].concat()),
                of => format!("{} or {word}", of.allowed(unit)),
            },
        }
    }

    /// Whether `value` is allowed.
    fn fits(&self, value: &Value) -> bool {
        match (self, value) {
            (Kind::Int { min, max }, Value::Int(v)) => (*min..=*max).contains(v),
            (Kind::Real { min, max }, Value::Real(v)) => (*min..=*max).contains(v),
            (Kind::Switch, Value::Switch(_)) => true,
            (Kind::Choice(all), Value::Choice(v)) => all.iter().any(|c| c.name == *v),
            (Kind::Placed(figure), Value::Placed(v)) => v.figure() == *figure && v.is_sound(),
            (Kind::Stage(kind), Value::Stage(v)) => kind.ids().contains(&v.id()),
            (Kind::Optional { word, .. }, Value::Choice(v)) if v == word => true,
            (Kind::Optional { of, .. }, value) => of.fits(value),
            _ => false,
        }
    }

    /// The value of `text`, if it can be parsed; the range is not checked.
    fn read(&self, text: &str) -> Option<Value> {
        match self {
            Kind::Int { .. } => text.parse().ok().map(Value::Int),
            Kind::Real { .. } => text.parse().ok().map(Value::Real),
            Kind::Switch => match text {
                "on" | "true" | "yes" | "1" => Some(Value::Switch(true)),
                "off" | "false" | "no" | "0" => Some(Value::Switch(false)),
                _ => None,
            },
            Kind::Choice(all) => all.iter().find(|c| c.name == text).map(|c| Value::Choice(c.name)),
            Kind::Placed(figure) => figure.parse(text).map(Value::Placed),
            Kind::Stage(kind) => kind.parse(text).map(Value::Stage).ok(),
            Kind::Optional { word, .. } if text == *word => Some(Value::Choice(word)),
            Kind::Optional { of, .. } => of.read(text),
        }
    }

    /// Whether an explicit value is a whole number.
    fn is_whole(&self) -> bool {
        match self {
            Kind::Optional { of, .. } => of.is_whole(),
            kind => matches!(kind, Kind::Int { .. }),
        }
    }
}

/// The names of choices.
fn names(all: &[Choice]) -> Vec<&'static str> {
    all.iter().map(|choice| choice.name).collect()
}

/// One of a few named values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Kebab-case name, for scripts.
    pub name: &'static str,
    /// Short label, for the window.
    pub label: &'static str,
    /// Its meaning in one or two sentences.
    pub doc: &'static str,
}

/// The declaration of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Kebab-case name, for scripts: `early-exit`.
    pub name: String,
    /// Name in the window: `Early exit`.
    pub label: String,
    /// Its meaning, from the doc comment: the tooltip and the help.
    pub doc: String,
    /// Unit, or empty: `px`.
    pub unit: &'static str,
    /// Type and range.
    pub kind: Kind,
    /// Default value.
    pub default: Value,
    /// Whether it is one of those that are seldom changed.
    pub advanced: bool,
    /// Why it has no effect where the values of other parameters leave it none: a sentence for each such case.
    pub idle: Vec<&'static str>,
}

impl Spec {
    /// Makes a declaration from the parts that [`params!`](crate::params!) collects.
    #[doc(hidden)]
    pub fn declare(field: &str, docs: &[&str], unit: &'static str, kind: Kind, default: Value) -> Self {
        let words: Vec<_> = field.split('_').map(|word| if word == "iou" { "IoU" } else { word }).collect();
        let words = words.join(" ");
        let label = words.chars().take(1).flat_map(char::to_uppercase).chain(words.chars().skip(1)).collect();
        let doc = docs.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
        Self { name: field.replace('_', "-"), label, doc, unit, kind, default, advanced: false, idle: Vec::new() }
    }

    /// Whether it has an effect only with some values of other parameters.
    pub fn is_conditional(&self) -> bool {
        !self.idle.is_empty()
    }

    /// Whether it is a number of frames, by its unit or the last word of its name.
    pub fn counts_frames(&self) -> bool {
        let word = self.name.rsplit(['-', '.']).next().unwrap_or_default();
        self.unit == "frames" || ["frames", "start", "age", "hits"].contains(&word)
    }

    /// The allowed values in words: `4 to 64 px`, `on or off`, `sad, ssd or mse`.
    pub fn allowed(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        self.kind.allowed(&unit)
    }

    /// Checks that `value` is allowed.
    ///
    /// # Errors
    /// A sentence that names the range.
    pub fn check(&self, value: Value) -> Result<Value, Error> {
        if self.kind.fits(&value) { Ok(value) } else { Err(self.refusal(&value.to_string())) }
    }

    /// Parses a value: `16`, `0.5`, `on`, `sad`.
    ///
    /// # Errors
    /// A sentence with the allowed values.
    pub fn parse(&self, text: &str) -> Result<Value, Error> {
        let text = text.trim();
        let value = match &self.kind {
            // The one that is declared comes as it is declared.
            Kind::Stage(_) if matches!(&self.default, Value::Stage(usual) if usual.id() == text) => {
                Some(self.default.clone())
            }
            Kind::Stage(kind) => return kind.parse(text).map(Value::Stage).map_err(|error| self.stage_refusal(error)),
            kind => kind.read(text),
        };
        value.ok_or_else(|| self.refusal(text)).and_then(|value| self.check(value))
    }

    fn stage_refusal(&self, error: Error) -> Error {
        Error::new(format!("{}: {error}", self.name))
    }

    fn refusal(&self, given: &str) -> Error {
        if self.kind.is_whole() && given.parse::<f64>().is_ok_and(|v| v.fract() != 0.0) {
            return Error::new(format!("{} must be a whole number, {}, not {given}", self.name, self.allowed()));
        }
        if let Kind::Placed(figure) = self.kind
            && let Some(size) = figure.parse(given).and_then(|placed| placed.too_small())
        {
            return Error::new(format!("{} has {size}: its corners must differ in x and in y", self.name));
        }
        Error::new(format!("{} must be {}, not {given}", self.name, self.allowed()))
    }
}

/// A set of declared parameters.
pub trait Params {
    /// The declarations, in display order.
    fn specs(&self) -> &'static [Spec];

    /// The value of parameter `index` of [`Params::specs`].
    ///
    /// # Panics
    /// If there is no such parameter.
    fn value(&self, index: usize) -> Value;

    /// Sets parameter `index` of [`Params::specs`].
    ///
    /// # Errors
    /// A sentence with the range if `value` is not allowed; then nothing changes.
    ///
    /// # Panics
    /// If there is no such parameter.
    fn set_value(&mut self, index: usize, value: Value) -> Result<(), Error>;

    /// Why parameter `index` of [`Params::specs`] has no effect with the values that the others have now, in a sentence;
    /// `None` where it has one.
    fn idle(&self, _index: usize) -> Option<&'static str> {
        None
    }

    /// Why the parameter called `name` has no effect now, in a sentence; `stage.name` where the stage has none either.
    /// `None` where it has one, or there is no such parameter.
    fn why_idle(&self, name: &str) -> Option<&'static str> {
        let (head, inner) = name.split_once('.').map_or((name, None), |(head, inner)| (head, Some(inner)));
        let index = find(self.specs(), head).ok()?;
        self.idle(index).or_else(|| match self.value(index) {
            Value::Stage(stage) => stage.part().why_idle(inner?),
            _ => None,
        })
    }

    /// The value of the parameter called `name`.
    ///
    /// # Errors
    /// A sentence with the existing names.
    fn get(&self, name: &str) -> Result<Value, Error> {
        match name.split_once('.') {
            Some((stage, inner)) => stage_of(self, stage).and_then(|(_, stage)| stage.part().get(inner)),
            None => find(self.specs(), name).map(|index| self.value(index)),
        }
    }

    /// Sets the parameter called `name` from text; that of a stage is called `stage.name`.
    ///
    /// # Errors
    /// A sentence with the allowed values; then nothing changes.
    fn set(&mut self, name: &str, text: &str) -> Result<(), Error> {
        set_by_name(self, name, text)
    }

    /// Names and values, in declared order.
    fn values(&self) -> Vec<(&'static str, Value)> {
        self.specs().iter().enumerate().map(|(i, spec)| (spec.name.as_str(), self.value(i))).collect()
    }

    /// Names and values in declared order; each stage is followed by its own, called `stage.name`.
    fn all_values(&self) -> Vec<(String, Value)> {
        let mut all = Vec::new();
        for (name, value) in self.values() {
            let inner = match &value {
                Value::Stage(stage) => stage.part().all_values(),
                _ => Vec::new(),
            };
            all.push((name.to_owned(), value));
            all.extend(inner.into_iter().map(|(inner, value)| (format!("{name}.{inner}"), value)));
        }
        all
    }
}

/// As [`Params::set`].
pub(crate) fn set_by_name<P: Params + ?Sized>(params: &mut P, name: &str, text: &str) -> Result<(), Error> {
    if let Some((stage, inner)) = name.split_once('.') {
        let (index, mut stage) = stage_of(params, stage)?;
        stage.part_mut().set(inner, text)?;
        return params.set_value(index, Value::Stage(stage));
    }
    let index = find(params.specs(), name)?;
    let value = params.specs()[index].parse(text)?;
    params.set_value(index, value)
}

/// Names in words: `sad, ssd or mse`.
fn one_of(names: &[&str]) -> String {
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// The stage called `name` of `params`, with its index.
fn stage_of<P: Params + ?Sized>(params: &P, name: &str) -> Result<(usize, StageValue), Error> {
    let index = find(params.specs(), name)?;
    match params.value(index) {
        Value::Stage(stage) => Ok((index, stage)),
        _ => Err(Error::new(format!("{name} is not a stage and has no parameters of its own"))),
    }
}

fn find(specs: &'static [Spec], name: &str) -> Result<usize, Error> {
    specs.iter().position(|spec| spec.name == name).ok_or_else(|| {
        let names: Vec<_> = specs.iter().map(|spec| spec.name.as_str()).collect();
        Error::new(words::there_is_no("parameter", name, &names))
    })
}

/// Marks the parameters that are seldom changed.
#[doc(hidden)]
pub fn mark_advanced(specs: &mut [Spec], names: &[&str]) {
    names.iter().for_each(|name| marked(specs, name).advanced = true);
}

/// Notes why parameters have no effect now and then.
#[doc(hidden)]
pub fn mark_conditional(specs: &mut [Spec], names: &[(&str, &'static str)]) {
    names.iter().for_each(|(name, why)| marked(specs, name).idle.push(why));
}

/// The declaration called `name`, of which something is said.
fn marked<'a>(specs: &'a mut [Spec], name: &str) -> &'a mut Spec {
    let found = specs.iter_mut().find(|spec| spec.name == name);
    found.unwrap_or_else(|| panic!("{name} is said to be advanced or conditional, and is no parameter"))
}

/// Whether a condition on `params` holds.
#[doc(hidden)]
pub fn holds<P>(params: &P, when: impl Fn(&P) -> bool) -> bool {
    when(params)
}

/// Ends what asks for a parameter that was not declared.
#[doc(hidden)]
pub fn no_such_parameter() -> ! {
    panic!("there are not so many parameters")
}

/// A type that can be a parameter. Numbers need a range; switches and choices have their own.
pub trait Parameter: Sized {
    /// The range of allowed values, for types that need one.
    type Range;
    /// The word for none, for a parameter of type [`Option`].
    const NONE: &'static str = "auto";
    /// Type and range of the parameter.
    fn kind(range: Self::Range) -> Kind;
    /// As a value.
    fn to_value(&self) -> Value;
    /// From a value that was checked against the declaration.
    fn from_value(value: Value) -> Option<Self>;
}

macro_rules! whole_number {
    ($($t:ty),*) => {$(
        impl Parameter for $t {
            type Range = std::ops::RangeInclusive<$t>;
            fn kind(range: Self::Range) -> Kind {
                Kind::Int { min: *range.start() as i64, max: *range.end() as i64 }
            }
            fn to_value(&self) -> Value {
                Value::Int(*self as i64)
            }
            fn from_value(value: Value) -> Option<Self> {
                if let Value::Int(v) = value { v.try_into().ok() } else { None }
            }
        }
    )*};
}
whole_number!(usize, u32, u16, i32);

impl Parameter for f32 {
    type Range = std::ops::RangeInclusive<f32>;
    fn kind(range: Self::Range) -> Kind {
        Kind::Real { min: exact(*range.start()), max: exact(*range.end()) }
    }
    fn to_value(&self) -> Value {
        Value::Real(exact(*self))
    }
    fn from_value(value: Value) -> Option<Self> {
        if let Value::Real(v) = value { Some(v as f32) } else { None }
    }
}

/// A limit of a range as text, with spaces between thousands.
fn limit(v: f64) -> String {
    if v >= 10_000.0 && v.fract() == 0.0 { grouped(v as i64) } else { v.to_string() }
}

/// The real number that `v` is written as: 0.1, not 0.10000000149.
fn exact(v: f32) -> f64 {
    v.to_string().parse().unwrap_or(f64::from(v))
}

impl Parameter for bool {
    type Range = ();
    fn kind((): ()) -> Kind {
        Kind::Switch
    }
    fn to_value(&self) -> Value {
        Value::Switch(*self)
    }
    fn from_value(value: Value) -> Option<Self> {
        if let Value::Switch(v) = value { Some(v) } else { None }
    }
}

/// An optional parameter: a word stands for `None`.
impl<T: Parameter> Parameter for Option<T> {
    type Range = T::Range;
    fn kind(range: Self::Range) -> Kind {
        Kind::Optional { of: Box::new(T::kind(range)), word: T::NONE }
    }
    fn to_value(&self) -> Value {
        self.as_ref().map_or(Value::Choice(T::NONE), T::to_value)
    }
    fn from_value(value: Value) -> Option<Self> {
        if value == Value::Choice(T::NONE) { Some(None) } else { T::from_value(value).map(Some) }
    }
}

/// Gives a struct around parameters those that it holds: `inner_params!(Corners<M: Measure>)`.
macro_rules! inner_params {
    ($name:ident<$inner:ident: $bound:path>) => {
        impl<$inner: $bound> $crate::params::Params for $name<$inner> {
            fn specs(&self) -> &'static [$crate::params::Spec] {
                self.0.specs()
            }

            fn value(&self, index: usize) -> $crate::params::Value {
                self.0.value(index)
            }

            fn set_value(&mut self, index: usize, value: $crate::params::Value) -> Result<(), $crate::base::Error> {
                self.0.set_value(index, value)
            }

            fn idle(&self, index: usize) -> Option<&'static str> {
                self.0.idle(index)
            }
        }
    };
}
pub(crate) use inner_params;

/// Declares a struct of parameters with its [`Default`] and [`Params`]. What several structs have in common is declared once
/// and is a field of each: its parameters stand in the place of that field. Behind the struct, `advanced { "name" }` says
/// which are seldom changed, and `when { "name": |p| condition, "Sentence."; }` when a parameter has an effect, and why it has none
/// where the condition does not hold. Both take the parameters of fields that are structs as well, and stages.
///
/// ```
/// motionscope_core::params! {
///     /// What it is.
///     #[derive(PartialEq)]
///     pub struct Blur {
///         /// Standard deviation of the Gaussian.
///         sigma_px: f32 = 1.0, 0.5..=8.0, "px";
///         /// Whether to do it twice.
///         twice: bool = false;
///     }
/// }
/// use motionscope_core::params::Params;
/// let mut blur = Blur::default();
/// blur.set("twice", "on").unwrap();
/// assert_eq!(blur.set("sigma-px", "9").unwrap_err().to_string(), "sigma-px must be 0.5 to 8 px, not 9");
///
/// motionscope_core::params! {
///     /// What it is.
///     pub struct Edges {
///         /// How both pictures are smoothed first.
///         blur: Blur = Blur { sigma_px: 2.0, twice: true };
///         /// The least gradient of an edge.
///         least: f32 = 10.0, 0.0..=255.0;
///     }
/// }
/// let edges = Edges::default();
/// let names: Vec<_> = edges.specs().iter().map(|spec| spec.name.as_str()).collect();
/// assert_eq!(names, ["sigma-px", "twice", "least"]);
/// assert_eq!(edges.specs()[0].default.to_string(), "2");
///
/// motionscope_core::params! {
///     /// What it is.
///     pub struct Denoised {
///         /// Whether the picture is smoothed first.
///         smooth: bool = false;
///         /// How it is smoothed.
///         blur: Blur = Blur::default();
///     }
///     advanced { "twice" }
///     when {
///         "sigma-px": |p| p.smooth, "The standard deviation has no effect without smoothing.";
///     }
/// }
/// let mut denoised = Denoised::default();
/// assert!(denoised.specs()[2].advanced && denoised.specs()[1].is_conditional());
/// assert_eq!(denoised.why_idle("sigma-px"), Some("The standard deviation has no effect without smoothing."));
/// denoised.smooth = true;
/// assert_eq!(denoised.idle(1), None);
/// ```
#[macro_export]
macro_rules! params {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $field:ident: $ty:ty = $default:expr $(, $range:expr $(, $unit:literal)?)?;
            )*
        }
        $(advanced { $($advanced:literal),+ $(,)? })?
        $(when { $($conditional:literal: $when:expr, $why:literal;)+ })?
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug)]
        pub struct $name {
            $( $(#[doc = $doc])+ pub $field: $ty, )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $field: $default, )* }
            }
        }

        impl $crate::params::Field for $name {
            const COUNT: usize = 0 $(+ <$ty as $crate::params::Field>::COUNT)*;
            type Range = ();

            fn specs_of(_: &$crate::params::Declared, (): (), default: &Self) -> Vec<$crate::params::Spec> {
                let mut specs = Vec::new();
                $(
                    let declared = $crate::params::Declared {
                        name: stringify!($field),
                        docs: &[$($doc),+],
                        unit: concat!($($($unit)?)?),
                    };
                    specs.extend(<$ty as $crate::params::Field>::specs_of(&declared, ($($range)?), &default.$field));
                )*
                $crate::params::mark_advanced(&mut specs, &[$($($advanced),+)?]);
                $crate::params::mark_conditional(&mut specs, &[$($(($conditional, $why)),+)?]);
                specs
            }

            #[allow(unused_assignments, unused_mut, reason = "the last field has none behind it")]
            fn idle_of(&self, mut index: usize) -> Option<&'static str> {
                $(
                    let name = $crate::params::Params::specs(self)[index].name.as_str();
                    $(
                        if name == $conditional && !$crate::params::holds(self, $when) {
                            return Some($why);
                        }
                    )+
                )?
                $(
                    if index < <$ty as $crate::params::Field>::COUNT {
                        return $crate::params::Field::idle_of(&self.$field, index);
                    }
                    index -= <$ty as $crate::params::Field>::COUNT;
                )*
                $crate::params::no_such_parameter()
            }

            #[allow(unused_assignments, reason = "the last field has none behind it")]
            fn value_of(&self, mut index: usize) -> $crate::params::Value {
                $(
                    if index < <$ty as $crate::params::Field>::COUNT {
                        return $crate::params::Field::value_of(&self.$field, index);
                    }
                    index -= <$ty as $crate::params::Field>::COUNT;
                )*
                $crate::params::no_such_parameter()
            }

            #[allow(unused_assignments, reason = "the last field has none behind it")]
            fn put(&mut self, mut index: usize, value: $crate::params::Value) {
                $(
                    if index < <$ty as $crate::params::Field>::COUNT {
                        return $crate::params::Field::put(&mut self.$field, index, value);
                    }
                    index -= <$ty as $crate::params::Field>::COUNT;
                )*
                $crate::params::no_such_parameter()
            }
        }

        impl $crate::params::Params for $name {
            fn specs(&self) -> &'static [$crate::params::Spec] {
                static SPECS: std::sync::LazyLock<Vec<$crate::params::Spec>> = std::sync::LazyLock::new(|| {
                    let whole = $crate::params::Declared { name: "", docs: &[], unit: "" };
                    <$name as $crate::params::Field>::specs_of(&whole, (), &$name::default())
                });
                &SPECS
            }

            fn value(&self, index: usize) -> $crate::params::Value {
                $crate::params::Field::value_of(self, index)
            }

            fn set_value(&mut self, index: usize, value: $crate::params::Value) -> Result<(), $crate::base::Error> {
                let value = $crate::params::Params::specs(self)[index].check(value)?;
                $crate::params::Field::put(self, index, value);
                Ok(())
            }

            fn idle(&self, index: usize) -> Option<&'static str> {
                $crate::params::Field::idle_of(self, index)
            }
        }
    };
}

/// Declares an enum whose variants are named choices of a parameter.
///
/// ```
/// motionscope_core::choices! {
///     /// How to go.
///     pub enum Gait {
///         /// One foot after the other.
///         Walk = "walk" "Walk",
///         /// Both feet off the ground now and then.
///         Run = "run" "Run",
///     }
/// }
/// ```
#[macro_export]
macro_rules! choices {
    (
        $(#[$meta:meta])*
        pub enum $name:ident {
            $( $(#[doc = $doc:literal])+ $variant:ident = $id:literal $label:literal, )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $( $(#[doc = $doc])+ $variant, )+
        }

        impl $name {
            /// Short label, for the window.
            pub fn label(self) -> &'static str {
                match self { $( Self::$variant => $label, )+ }
            }
        }

        impl $crate::params::Parameter for $name {
            type Range = ();
            fn kind((): ()) -> $crate::params::Kind {
                $crate::params::Kind::Choice(vec![$(
                    $crate::params::Choice { name: $id, label: $label, doc: concat!($($doc),+).trim_ascii() },
                )+])
            }
            fn to_value(&self) -> $crate::params::Value {
                $crate::params::Value::Choice(match self { $( Self::$variant => $id, )+ })
            }
            fn from_value(value: $crate::params::Value) -> Option<Self> {
                match value {
                    $( $crate::params::Value::Choice($id) => Some(Self::$variant), )+
                    _ => None,
                }
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::choices! {
        /// A pace.
        pub enum Pace {
            /// Slowly.
            Slow = "slow" "Slow",
            /// In a hurry.
            Fast = "fast" "Fast",
        }
    }

    crate::params! {
        /// Everything a parameter can be.
        pub struct All {
            /// A whole number,
            /// told on two lines.
            whole_px: usize = 16, 4..=64, "px";
            /// A real number.
            real: f32 = 0.1, 0.0..=1.0;
            /// A switch.
            switch: bool = false;
            /// A choice.
            pace: Pace = Pace::Fast;
            /// A whole number that may be left open.
            room: Option<u16> = None, 1..=256, "px";
            /// A choice that may be left open.
            gait: Option<Pace> = Some(Pace::Slow);
        }
    }

    #[test]
    fn a_declaration_becomes_a_spec() {
        let spec = &All::default().specs()[0];
        assert_eq!((spec.name.as_str(), spec.label.as_str(), spec.unit), ("whole-px", "Whole px", "px"));
        assert_eq!(spec.doc, "A whole number, told on two lines.");
        assert_eq!((spec.allowed(), &spec.default), ("4 to 64 px".into(), &Value::Int(16)));
        assert_eq!(All::default().specs()[1].default, Value::Real(0.1));
        let allowed = [3, 4, 5].map(|index| All::default().specs()[index].allowed());
        assert_eq!(allowed, ["slow or fast", "1 to 256 px or auto", "slow, fast or auto"]);
    }

    #[test]
    fn setting_reads_back_and_refusing_changes_nothing() {
        let mut all = All::default();
        let open = [("room", "7"), ("room", "auto"), ("gait", "fast"), ("gait", "auto")];
        for (name, text) in
            [("whole-px", "64"), ("real", "0.25"), ("switch", "on"), ("pace", "slow")].into_iter().chain(open)
        {
            all.set(name, text).unwrap();
            assert_eq!(all.get(name).unwrap().to_string(), text);
        }
        assert_eq!((all.room, all.gait), (None, None));
        assert_eq!((Pace::Slow.label(), Pace::Fast.label()), ("Slow", "Fast"));
        let refused =
            [("whole-px", "65"), ("whole-px", "x"), ("real", "NaN"), ("switch", "2"), ("pace", "Slow"), ("gone", "1")];
        let open = [("room", "0"), ("room", "1.5"), ("room", "none"), ("gait", "on")];
        for (name, text) in refused.into_iter().chain(open) {
            let before = all.values();
            assert!(all.set(name, text).is_err(), "{name}={text}");
            assert_eq!(all.values(), before);
        }
    }
}
