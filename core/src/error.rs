//! What went wrong, in one sentence.

/// One helpful sentence: what was wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Error(String);

impl Error {
    /// An error that reads as `sentence` (no final full stop).
    pub fn new(sentence: impl Into<String>) -> Self {
        Self(sentence.into())
    }
}
