//! The one door behind which threads are.

use rayon::prelude::*;

use crate::Error;

/// A number of threads to spread independent work over.
pub struct Threads(Option<rayon::ThreadPool>);

impl Threads {
    /// The most that may be asked for.
    pub const MAX: usize = 256;

    /// Everything on the calling thread.
    pub fn single() -> Self {
        Self(None)
    }

    /// `count` threads.
    ///
    /// # Errors
    /// If `count` is not 1 to [`Threads::MAX`], or the system refuses.
    pub fn new(count: usize) -> Result<Self, Error> {
        match count {
            1 => Ok(Self::single()),
            2..=Self::MAX => rayon::ThreadPoolBuilder::new()
                .num_threads(count)
                .build()
                .map(|pool| Self(Some(pool)))
                .map_err(|e| Error::new(format!("{count} threads could not be started: {e}"))),
            _ => Err(Error::new(format!("threads can be 1 to {}, not {count}", Self::MAX))),
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or(1, rayon::ThreadPool::current_num_threads)
    }

    /// `f` of 0, 1, … `n − 1`, in that order, computed in any.
    pub fn map<T: Send>(&self, n: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
        match &self.0 {
            None => (0..n).map(f).collect(),
            Some(pool) => pool.install(|| (0..n).into_par_iter().with_max_len(1).map(f).collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_does_not_depend_on_the_number_of_threads() {
        let squares = |n| Threads::new(n).unwrap().map(1000, |i| i * i);
        assert_eq!(squares(1), squares(3));
        assert!(Threads::new(0).is_err() && Threads::new(Threads::MAX + 1).is_err());
    }
}
