//! A block search as a part of another: its search pattern.

use std::sync::Arc;

use super::{BlockSearch, Event, Tester};
use crate::base::{Error, Observer};

/// Records events if an observer watches.
pub struct Relay(pub Option<Vec<Event>>);

impl Observer<Event> for Relay {
    fn see(&mut self, event: impl FnOnce() -> Event) {
        if let Some(seen) = &mut self.0 {
            seen.push(event());
        }
    }
}

/// A type-erased block search.
trait AnySearch: Send + Sync {
    fn search(&self, tester: &mut Tester<'_, Relay>);
    fn within(&self, range: usize) -> Result<Pattern, Error>;
}

impl<S: BlockSearch> AnySearch for S {
    fn search(&self, tester: &mut Tester<'_, Relay>) {
        BlockSearch::search(self, tester);
    }

    fn within(&self, range: usize) -> Result<Pattern, Error> {
        let mut search = self.clone();
        search.set("search-range", &range.to_string())?;
        Ok(Pattern::of(search))
    }
}

/// The search pattern of a block search, lent to the parent estimator.
#[derive(Clone)]
pub struct Pattern(Arc<dyn AnySearch>);

impl Pattern {
    /// The pattern of `search`.
    pub fn of(search: impl BlockSearch) -> Self {
        Self(Arc::new(search))
    }

    /// The pattern for a search range of ±`range` px.
    ///
    /// # Errors
    /// If the range is out of bounds.
    pub fn within(&self, range: usize) -> Result<Self, Error> {
        self.0.within(range)
    }

    /// Searches the tester's block.
    pub fn search(&self, tester: &mut Tester<'_, Relay>) {
        self.0.search(tester);
    }
}
