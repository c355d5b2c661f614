//! A block search as a part of another: which displacements it tests, and why.

use std::sync::Arc;

use super::{BlockSearch, Event, Tester};
use crate::base::{Error, Observer};

/// Keeps what it sees if anyone is to be told.
pub struct Relay(pub Option<Vec<Event>>);

impl Observer<Event> for Relay {
    fn see(&mut self, event: impl FnOnce() -> Event) {
        if let Some(seen) = &mut self.0 {
            seen.push(event());
        }
    }
}

/// Any block search, of which only the pattern matters.
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
        search.set("range", &range.to_string())?;
        Ok(Pattern::of(search))
    }
}

/// The pattern of a block search: what it lends where it is a stage.
#[derive(Clone)]
pub struct Pattern(Arc<dyn AnySearch>);

impl Pattern {
    /// That of a search.
    pub fn of(search: impl BlockSearch) -> Self {
        Self(Arc::new(search))
    }

    /// The same for displacements within ±`range` px.
    ///
    /// # Errors
    /// If no search reaches so far.
    pub fn within(&self, range: usize) -> Result<Self, Error> {
        self.0.within(range)
    }

    /// Searches the tester's block.
    pub fn search(&self, tester: &mut Tester<'_, Relay>) {
        self.0.search(tester);
    }
}
