//! Parameters with parameters of their own: a part that is chosen by its id.

use std::any::Any;
use std::fmt;

use super::Params;
use crate::base::Error;

/// Something with parameters that can be chosen by its id.
pub trait Part: Params + Send + Sync {
    /// Kebab-case id.
    fn id(&self) -> &'static str;
    /// Its name in the window.
    fn name(&self) -> &'static str;
    /// Its method in one sentence.
    fn summary(&self) -> &'static str;
    /// The same with the same parameters.
    fn clone_part(&self) -> Box<dyn Part>;
    /// Itself, to be told what it is.
    fn as_any(&self) -> &dyn Any;
}

/// The kind of part that can be chosen.
#[derive(Clone, Copy)]
pub struct PartKind {
    /// The requirement in one word.
    pub asks: &'static str,
    /// The id of its product: `dense-flow`.
    pub product: &'static str,
    /// The product in words: `a dense flow`.
    pub makes: &'static str,
    /// All that can be chosen, with default parameters.
    pub all: fn() -> Vec<Box<dyn Part>>,
    /// The reason why an id cannot be chosen.
    pub refuse: fn(&str) -> Error,
}

/// Two are the same where the same can be chosen.
impl PartialEq for PartKind {
    fn eq(&self, other: &Self) -> bool {
        self.asks == other.asks
    }
}

impl fmt::Debug for PartKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("PartKind").field(&self.asks).finish()
    }
}

impl PartKind {
    /// The ids of all that can be chosen.
    pub fn ids(&self) -> Vec<&'static str> {
        (self.all)().iter().map(|part| part.id()).collect()
    }

    /// The part called `id`, with default parameters.
    ///
    /// # Errors
    /// A sentence with the possible choices.
    pub fn parse(&self, id: &str) -> Result<StageValue, Error> {
        let found = (self.all)().into_iter().find(|part| part.id() == id);
        found.map(StageValue).ok_or_else(|| (self.refuse)(id))
    }
}

/// A part with the values of its parameters.
pub struct StageValue(Box<dyn Part>);

impl StageValue {
    /// The value that `part` is.
    pub fn new(part: Box<dyn Part>) -> Self {
        Self(part)
    }

    /// Its id.
    pub fn id(&self) -> &'static str {
        self.0.id()
    }

    /// The part.
    pub fn part(&self) -> &dyn Part {
        &*self.0
    }

    /// The part, to be changed.
    pub fn part_mut(&mut self) -> &mut dyn Part {
        &mut *self.0
    }
}

impl Clone for StageValue {
    fn clone(&self) -> Self {
        Self(self.0.clone_part())
    }
}

/// Two are equal where they are the same part with the same values.
impl PartialEq for StageValue {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id() && self.0.values() == other.0.values()
    }
}

impl fmt::Debug for StageValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple(self.id()).field(&self.0.values()).finish()
    }
}
