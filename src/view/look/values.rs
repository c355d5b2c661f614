//! The types of the view options as parameter values.

use motionscope_core::choices;
use motionscope_core::params::{Choice, Kind, Parameter, Value};

use crate::paint::{
    Backdrop, ColorMap, FlowLayer, FocusMode, Lengthen, LevelShown, Opacity, Phase, Share, Theme, View,
};

/// A choice, each value with a stable name, a label and a sentence.
macro_rules! named {
    ($($name:ident),+) => {$(
        impl Parameter for $name {
            type Range = ();
            fn kind((): ()) -> Kind {
                let choice = |one: Self| Choice { name: one.id(), label: one.name(), doc: one.tip() };
                Kind::Choice(Self::ALL.map(choice).into())
            }
            fn to_value(&self) -> Value {
                Value::Choice(self.id())
            }
            fn from_value(value: Value) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.to_value() == value)
            }
        }
    )+};
}
named!(View, Theme, ColorMap, FlowLayer, FocusMode, Backdrop);

/// A fraction from 0 to 1, and the word for none.
macro_rules! share {
    ($($name:ident = $none:literal),+) => {$(
        impl Parameter for $name {
            type Range = ();
            const NONE: &'static str = $none;
            fn kind((): ()) -> Kind {
                f32::kind(0.0..=1.0)
            }
            fn to_value(&self) -> Value {
                self.get().to_value()
            }
            fn from_value(value: Value) -> Option<Self> {
                Self::new(f32::from_value(value)?).ok()
            }
        }
    )+};
}
share!(Share = "auto", Opacity = "auto", Phase = "off");

choices! {
    /// The words around the pictures that are written.
    pub enum CaptionWords {
        /// No words.
        Off = "off" "No caption",
        /// Clip, estimator, parameters, step and the sentence of the step.
        On = "on" "Caption",
        /// The same with the formula of the step and its numbers.
        Full = "full" "Caption with formula",
    }
}

/// The level at work, as it is written.
const AT_WORK: &str = "at-work";
/// Pyramid levels that can be asked for.
const LEVELS: std::ops::RangeInclusive<usize> = 0..=99;

impl Parameter for LevelShown {
    type Range = ();
    fn kind((): ()) -> Kind {
        Kind::Optional { of: Box::new(usize::kind(LEVELS)), word: AT_WORK }
    }
    fn to_value(&self) -> Value {
        match self {
            Self::AtWork => Value::Choice(AT_WORK),
            Self::Number(level) => level.to_value(),
        }
    }
    fn from_value(value: Value) -> Option<Self> {
        if value == Value::Choice(AT_WORK) { Some(Self::AtWork) } else { usize::from_value(value).map(Self::Number) }
    }
}

/// The range of arrow scale factors.
const TIMES: std::ops::RangeInclusive<f32> = 0.01..=100.0;

impl Parameter for Lengthen {
    type Range = ();
    fn kind((): ()) -> Kind {
        Option::<f32>::kind(TIMES)
    }
    fn to_value(&self) -> Value {
        match self {
            Self::Auto => None::<f32>.to_value(),
            Self::Times(factor) => factor.to_value(),
        }
    }
    fn from_value(value: Value) -> Option<Self> {
        Option::<f32>::from_value(value).map(|factor| factor.map_or(Self::Auto, Self::Times))
    }
}
