//! The last few results by frame number, so that going back and forth computes nothing twice.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Keeps the results that were asked for last.
pub struct Recent<T> {
    /// Most recent first.
    kept: Mutex<VecDeque<(usize, Arc<T>)>>,
    most: usize,
}

impl<T> Recent<T> {
    /// Keeps at most `most` results.
    pub fn new(most: usize) -> Self {
        Self { kept: Mutex::new(VecDeque::new()), most }
    }

    /// Result `index` if it is kept.
    pub fn peek(&self, index: usize) -> Option<Arc<T>> {
        let mut kept = self.lock();
        let place = kept.iter().position(|(i, _)| *i == index)?;
        let found = kept.remove(place)?;
        let result = Arc::clone(&found.1);
        kept.push_front(found);
        Some(result)
    }

    /// Result `index`, made by `make` unless it is kept. Others may use what is kept meanwhile.
    pub fn get(&self, index: usize, make: impl FnOnce() -> T) -> Arc<T> {
        if let Some(result) = self.peek(index) {
            return result;
        }
        let made = Arc::new(make());
        let mut kept = self.lock();
        // Another thread may have made the same meanwhile.
        kept.retain(|(i, _)| *i != index);
        kept.push_front((index, Arc::clone(&made)));
        kept.truncate(self.most);
        made
    }

    /// A thread that panicked cannot have left the list half changed, so it is used all the same.
    fn lock(&self) -> MutexGuard<'_, VecDeque<(usize, Arc<T>)>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_recent_goes_first() {
        let recent = Recent::new(2);
        assert_eq!((*recent.get(1, || 10), *recent.get(2, || 20), *recent.get(1, || 99)), (10, 20, 10));
        assert_eq!(*recent.get(3, || 30), 30);
        assert!(recent.peek(2).is_none() && recent.peek(1).is_some() && recent.peek(3).is_some());
    }
}
