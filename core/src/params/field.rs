//! What stands in one place of a declaration: a parameter, or all those of another declaration.

use super::{Parameter, Spec, Value};

/// What a declaration says of a field beside its type, range and default.
#[doc(hidden)]
pub struct Declared {
    /// Its name in the code.
    pub name: &'static str,
    /// The lines of its doc comment.
    pub docs: &'static [&'static str],
    /// Its unit, or nothing.
    pub unit: &'static str,
}

/// A field of a declaration: a [`Parameter`], or a struct that [`params!`](crate::params!) declares. The parameters of
/// such a struct stand where the field stands, as if they were declared there, with the values of the field's default.
pub trait Field {
    /// How many parameters it is.
    const COUNT: usize;
    /// The smallest and largest value allowed where the type alone does not say.
    type Range;

    /// Their declarations.
    #[doc(hidden)]
    fn specs_of(declared: &Declared, range: Self::Range, default: &Self) -> Vec<Spec>;

    /// The value of one of them.
    #[doc(hidden)]
    fn value_of(&self, index: usize) -> Value;

    /// Why one of them has no effect beside the values of the others, or `None` where it has one.
    #[doc(hidden)]
    fn idle_of(&self, _index: usize) -> Option<&'static str> {
        None
    }

    /// Sets one of them to a value that was checked against its declaration.
    #[doc(hidden)]
    fn put(&mut self, index: usize, value: Value);
}

impl<P: Parameter> Field for P {
    const COUNT: usize = 1;
    type Range = P::Range;

    fn specs_of(declared: &Declared, range: P::Range, default: &P) -> Vec<Spec> {
        let Declared { name, docs, unit } = *declared;
        vec![Spec::declare(name, docs, unit, P::kind(range), default.to_value())]
    }

    fn value_of(&self, _index: usize) -> Value {
        self.to_value()
    }

    fn put(&mut self, _index: usize, value: Value) {
        if let Some(value) = P::from_value(value) {
            *self = value;
        }
    }
}
