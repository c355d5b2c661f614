//! Parameters declared once: default, range, unit and doc comment.
//!
//! Sliders, tooltips, `--set` flags, `motionscope list`, sessions and the property tests all read the
//! same declaration, made with [`params!`](crate::params!) and [`choices!`](crate::choices!).

mod part;
mod placed;

use std::fmt;

pub use part::{Part, PartKind, StageValue};
pub use placed::{Figure, Line, Placed, Spot, Spots};

use crate::base::Error;

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
    /// Something on the picture.
    Placed(Placed),
    /// Something with parameters of its own, by its id.
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

/// What a parameter may be.
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
    /// One of a few.
    Choice(Vec<Choice>),
    /// Something that is placed on the picture.
    Placed(Figure),
    /// Something with parameters of its own.
    Stage(PartKind),
}

/// One of a few named values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Kebab-case name, for scripts.
    pub name: &'static str,
    /// Short label, for the window.
    pub label: &'static str,
    /// One sentence that says what it means.
    pub doc: &'static str,
}

/// The declaration of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Kebab-case name, for scripts: `early-exit`.
    pub name: String,
    /// Name in the window: `Early exit`.
    pub label: String,
    /// What it does, from the doc comment: the tooltip and the help.
    pub doc: String,
    /// Unit, or nothing: `px`.
    pub unit: &'static str,
    /// What it may be.
    pub kind: Kind,
    /// What it is unless set.
    pub default: Value,
}

impl Spec {
    /// Makes a declaration from the parts that [`params!`](crate::params!) collects.
    #[doc(hidden)]
    pub fn declare(field: &str, docs: &[&str], unit: &'static str, kind: Kind, default: Value) -> Self {
        let words = field.replace('_', " ");
        let label = words.chars().take(1).flat_map(char::to_uppercase).chain(words.chars().skip(1)).collect();
        let doc = docs.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
        Self { name: field.replace('_', "-"), label, doc, unit, kind, default }
    }

    /// What may be given, in words: `4 to 64 px`, `on or off`, `sad, ssd or mse`.
    pub fn allowed(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        match &self.kind {
            Kind::Int { min, max } => format!("{min} to {max}{unit}"),
            Kind::Real { min, max } => format!("{min} to {max}{unit}"),
            Kind::Switch => "on or off".into(),
            Kind::Placed(figure) => figure.allowed().into(),
            Kind::Stage(kind) => one_of(&kind.ids()),
            Kind::Choice(all) => one_of(&all.iter().map(|c| c.name).collect::<Vec<_>>()),
        }
    }

    /// Checks that `value` is allowed.
    ///
    /// # Errors
    /// A sentence that names the range.
    pub fn check(&self, value: Value) -> Result<Value, Error> {
        let fits = match (&self.kind, &value) {
            (Kind::Int { min, max }, Value::Int(v)) => (*min..=*max).contains(v),
            (Kind::Real { min, max }, Value::Real(v)) => (*min..=*max).contains(v),
            (Kind::Switch, Value::Switch(_)) => true,
            (Kind::Choice(all), Value::Choice(v)) => all.iter().any(|c| c.name == *v),
            (Kind::Placed(figure), Value::Placed(v)) => v.figure() == *figure && v.is_sound(),
            (Kind::Stage(kind), Value::Stage(v)) => kind.ids().contains(&v.id()),
            _ => false,
        };
        if fits { Ok(value) } else { Err(self.refusal(&value.to_string())) }
    }

    /// Reads a value as a person types it: `16`, `0.5`, `on`, `sad`.
    ///
    /// # Errors
    /// A sentence that names what may be given.
    pub fn parse(&self, text: &str) -> Result<Value, Error> {
        let text = text.trim();
        let value = match &self.kind {
            Kind::Int { .. } => text.parse().ok().map(Value::Int),
            Kind::Real { .. } => text.parse().ok().map(Value::Real),
            Kind::Switch => match text {
                "on" | "true" | "yes" | "1" => Some(Value::Switch(true)),
                "off" | "false" | "no" | "0" => Some(Value::Switch(false)),
                _ => None,
            },
            Kind::Choice(all) => all.iter().find(|c| c.name == text).map(|c| Value::Choice(c.name)),
            Kind::Placed(figure) => figure.parse(text).map(Value::Placed),
            // The one that is declared comes as it is declared.
            Kind::Stage(_) if matches!(&self.default, Value::Stage(usual) if usual.id() == text) => {
                Some(self.default.clone())
            }
            Kind::Stage(kind) => return kind.parse(text).map(Value::Stage).map_err(|error| self.stage_refusal(error)),
        };
        value.ok_or_else(|| self.refusal(text)).and_then(|value| self.check(value))
    }

    fn stage_refusal(&self, error: Error) -> Error {
        Error::new(format!("{}: {error}", self.name))
    }

    fn refusal(&self, given: &str) -> Error {
        if matches!(self.kind, Kind::Int { .. }) && given.parse::<f64>().is_ok_and(|v| v.fract() != 0.0) {
            return Error::new(format!("{} can be a whole number, {}, not {given}", self.name, self.allowed()));
        }
        Error::new(format!("{} can be {}, not {given}", self.name, self.allowed()))
    }
}

/// A set of declared parameters.
pub trait Params {
    /// The declarations, in the order in which a person reads them.
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

    /// The value of the parameter called `name`.
    ///
    /// # Errors
    /// A sentence with the names there are.
    fn get(&self, name: &str) -> Result<Value, Error> {
        match name.split_once('.') {
            Some((stage, inner)) => stage_of(self, stage).and_then(|(_, stage)| stage.part().get(inner)),
            None => find(self.specs(), name).map(|index| self.value(index)),
        }
    }

    /// Sets the parameter called `name` from what a person typed; that of a stage is called `stage.name`.
    ///
    /// # Errors
    /// A sentence with what may be given; then nothing changes.
    fn set(&mut self, name: &str, text: &str) -> Result<(), Error> {
        if let Some((stage, inner)) = name.split_once('.') {
            let (index, mut stage) = stage_of(self, stage)?;
            stage.part_mut().set(inner, text)?;
            return self.set_value(index, Value::Stage(stage));
        }
        let index = find(self.specs(), name)?;
        let value = self.specs()[index].parse(text)?;
        self.set_value(index, value)
    }

    /// Names and values, in declared order.
    fn values(&self) -> Vec<(&'static str, Value)> {
        self.specs().iter().enumerate().map(|(i, spec)| (spec.name.as_str(), self.value(i))).collect()
    }

    /// Names and values, in declared order; behind each stage its own, called `stage.name`.
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
        _ => Err(Error::new(format!("{name} is no stage: it has no parameters of its own"))),
    }
}

fn find(specs: &'static [Spec], name: &str) -> Result<usize, Error> {
    specs.iter().position(|spec| spec.name == name).ok_or_else(|| {
        let names: Vec<_> = specs.iter().map(|spec| spec.name.as_str()).collect();
        Error::new(format!("there is no parameter {name}; there are {}", names.join(", ")))
    })
}

/// A type that can be a parameter. Numbers need a range, switches and choices bring their own.
pub trait Parameter: Sized {
    /// The smallest and largest value allowed where the type alone does not say.
    type Range;
    /// What the parameter may be.
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
whole_number!(usize, u32, i32);

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

            fn set_value(&mut self, index: usize, value: $crate::params::Value) -> Result<(), $crate::Error> {
                self.0.set_value(index, value)
            }
        }
    };
}
pub(crate) use inner_params;

/// Declares a struct of parameters with its [`Default`] and [`Params`].
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
/// use motionscope_core::Params;
/// let mut blur = Blur::default();
/// blur.set("twice", "on").unwrap();
/// assert_eq!(blur.set("sigma-px", "9").unwrap_err().to_string(), "sigma-px can be 0.5 to 8 px, not 9");
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

        impl $crate::params::Params for $name {
            fn specs(&self) -> &'static [$crate::params::Spec] {
                static SPECS: std::sync::LazyLock<Vec<$crate::params::Spec>> = std::sync::LazyLock::new(|| vec![$(
                    $crate::params::Spec::declare(
                        stringify!($field),
                        &[$($doc),+],
                        concat!($($($unit)?)?),
                        <$ty as $crate::params::Parameter>::kind(($($range)?)),
                        <$ty as $crate::params::Parameter>::to_value(&$default),
                    ),
                )*]);
                &SPECS
            }

            fn value(&self, index: usize) -> $crate::params::Value {
                let mut values = vec![$( $crate::params::Parameter::to_value(&self.$field), )*];
                values.swap_remove(index)
            }

            fn set_value(&mut self, index: usize, value: $crate::params::Value) -> Result<(), $crate::Error> {
                let value = $crate::params::Params::specs(self)[index].check(value)?;
                let setters: &[fn(&mut Self, $crate::params::Value)] = &[$(
                    |params, value| {
                        if let Some(value) = $crate::params::Parameter::from_value(value) {
                            params.$field = value;
                        }
                    },
                )*];
                setters[index](self, value);
                Ok(())
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
        }
    }

    #[test]
    fn a_declaration_becomes_a_spec() {
        let spec = &All::default().specs()[0];
        assert_eq!((spec.name.as_str(), spec.label.as_str(), spec.unit), ("whole-px", "Whole px", "px"));
        assert_eq!(spec.doc, "A whole number, told on two lines.");
        assert_eq!((spec.allowed(), &spec.default), ("4 to 64 px".into(), &Value::Int(16)));
        assert_eq!(All::default().specs()[1].default, Value::Real(0.1));
        assert_eq!(All::default().specs()[3].allowed(), "slow or fast");
    }

    #[test]
    fn setting_reads_back_and_refusing_changes_nothing() {
        let mut all = All::default();
        for (name, text) in [("whole-px", "64"), ("real", "0.25"), ("switch", "on"), ("pace", "slow")] {
            all.set(name, text).unwrap();
            assert_eq!(all.get(name).unwrap().to_string(), text);
        }
        assert_eq!((Pace::Slow.label(), Pace::Fast.label()), ("Slow", "Fast"));
        let refused =
            [("whole-px", "65"), ("whole-px", "x"), ("real", "NaN"), ("switch", "2"), ("pace", "Slow"), ("gone", "1")];
        for (name, text) in refused {
            let before = all.values();
            assert!(all.set(name, text).is_err(), "{name}={text}");
            assert_eq!(all.values(), before);
        }
    }
}
