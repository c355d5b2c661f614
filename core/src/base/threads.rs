//! Work that is spread over threads, with the same result for any number of them.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use rayon::prelude::*;

use super::Error;

/// A number of threads to spread work over.
pub struct Threads(Option<rayon::ThreadPool>);

impl Threads {
    /// The most that may be asked for.
    pub const MAX: usize = 256;

    /// Work on the calling thread only.
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
            _ => Err(Error::new(format!("threads must be 1 to {}, not {count}", Self::MAX))),
        }
    }

    /// As many as there are cores.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn all() -> Result<Self, Error> {
        Self::new(std::thread::available_parallelism().map_or(1, usize::from).min(Self::MAX))
    }

    /// Number of threads.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or(1, rayon::ThreadPool::current_num_threads)
    }

    /// How many of `height` rows one thread takes at once where its first costs as much as all that lie under its window.
    pub(crate) fn rows_at_once(&self, height: usize) -> usize {
        match self.count() {
            1 => height,
            count => height.div_ceil(4 * count),
        }
    }

    /// `f` of 0, 1, … `n − 1`, in that order, computed in any.
    pub(crate) fn map<T: Send>(&self, n: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
        match &self.0 {
            None => (0..n).map(f).collect(),
            Some(pool) => {
                let results: Vec<Mutex<Option<T>>> = (0..n).map(|_| Mutex::default()).collect();
                spread(pool, n, &|i| *locked(&results[i]) = Some(f(i)));
                results.into_iter().filter_map(unlocked).collect()
            }
        }
    }

    /// The same as long as it is wanted, which is asked before each.
    ///
    /// # Errors
    /// Those of `wanted`.
    pub(crate) fn map_while<T: Send>(
        &self,
        n: usize,
        wanted: impl Fn() -> Result<(), Error> + Sync,
        f: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>, Error> {
        let refused = OnceLock::new();
        let one = |i| match refused.get() {
            None => wanted().map(|()| f(i)).map_err(|error| refused.get_or_init(|| error).clone()),
            Some(error) => Err(error.clone()),
        };
        match &self.0 {
            None => (0..n).map(one).collect(),
            Some(_) => self.map(n, one).into_iter().collect(),
        }
    }

    /// What `f` gives of each of `parts`, in their order; worked out in any.
    pub(crate) fn gather<T: Send, R: Send>(&self, parts: impl Iterator<Item = T>, f: impl Fn(T) -> R + Sync) -> Vec<R> {
        if self.0.is_none() {
            return parts.map(f).collect();
        }
        let parts: Vec<_> = parts.map(|part| Mutex::new(Some(part))).collect();
        let results = self.map(parts.len(), |i| {
            let part = locked(&parts[i]).take();
            part.map(&f)
        });
        results.into_iter().flatten().collect()
    }

    /// Has `f` write every stretch of `length` cells, given its number, in any order.
    pub(crate) fn chunks<T: Send>(&self, cells: &mut [T], length: usize, f: impl Fn(usize, &mut [T]) + Sync) {
        self.each(cells.chunks_exact_mut(length.max(1)).enumerate(), |(i, cells)| f(i, cells));
    }

    /// Has `f` work on each of `parts`, in any order.
    pub(crate) fn each<T: Send>(&self, parts: impl IntoIterator<Item = T>, f: impl Fn(T) + Sync) {
        match &self.0 {
            None => parts.into_iter().for_each(f),
            Some(pool) => {
                let parts: Vec<_> = parts.into_iter().map(|part| Mutex::new(Some(part))).collect();
                spread(pool, parts.len(), &|i| {
                    let part = locked(&parts[i]).take();
                    part.into_iter().for_each(&f);
                });
            }
        }
    }

    /// `f` of every place of a grid, row by row. Each thread takes the next row and works along it, with its own
    /// `desk` of buffers. `f` may ask [`Earlier`] for what it gave at a place before: in a row above, or to the left.
    /// It waits there until the other thread has come that far, so what it gets does not depend on their number. Whether it is
    /// still wanted is asked at each place.
    ///
    /// # Errors
    /// Those of `wanted`.
    pub(crate) fn sweep<T: Copy + Default + Send + Sync, D>(
        &self,
        ((columns, rows), wanted): ((usize, usize), impl Fn() -> Result<(), Error> + Sync),
        control: impl Fn() -> D + Sync,
        f: impl Fn(&mut D, usize, Earlier<T>) -> T + Sync,
    ) -> Result<Vec<T>, Error> {
        let Some(pool) = &self.0 else {
            let (mut done, mut control) = (Vec::with_capacity(columns * rows), control());
            for index in 0..columns * rows {
                wanted()?;
                done.push(f(&mut control, index, Earlier::All(&done)));
            }
            return Ok(done);
        };
        let cells: Vec<OnceLock<T>> = (0..columns * rows).map(|_| OnceLock::new()).collect();
        let (next_row, end) = (AtomicUsize::new(0), End::default());
        // Rows are taken in order, so the first that is not finished waits for nobody: there is always one that goes on.
        pool.broadcast(|_| {
            let _guard = OnPanic(&end.is_lost);
            let mut control = control();
            loop {
                let row = next_row.fetch_add(1, Ordering::Relaxed);
                if row >= rows {
                    return;
                }
                for index in row * columns..(row + 1) * columns {
                    if let Err(error) = wanted() {
                        // The first that notices says so for all.
                        let _ = end.given_up.set(error);
                    }
                    if end.given_up.get().is_some() {
                        return;
                    }
                    let value = f(&mut control, index, Earlier::SoFar { cells: &cells, columns, end: &end });
                    // Nobody else takes this row.
                    let _ = cells[index].set(value);
                }
            }
        });
        match end.given_up.into_inner() {
            Some(error) => Err(error),
            None => Ok(cells.into_iter().filter_map(OnceLock::into_inner).collect()),
        }
    }
}

/// Calls `work` with 0, 1, … `n − 1` on the pool, in any order. A trait object, so that the pool's code is compiled once.
fn spread(pool: &rayon::ThreadPool, n: usize, work: &(dyn Fn(usize) + Sync)) {
    pool.install(|| (0..n).into_par_iter().with_max_len(1).for_each(work));
}

fn locked<T>(cell: &Mutex<T>) -> MutexGuard<'_, T> {
    cell.lock().unwrap_or_else(PoisonError::into_inner)
}

fn unlocked<T>(cell: Mutex<Option<T>>) -> Option<T> {
    cell.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// The early end of a sweep.
#[derive(Default)]
pub(crate) struct End {
    /// Whether one of the threads has panicked.
    is_lost: AtomicBool,
    /// Why it is cancelled.
    given_up: OnceLock<Error>,
}

/// The results of a sweep at earlier positions.
#[derive(Clone, Copy)]
pub(crate) enum Earlier<'a, T> {
    /// One thread: all of them are done.
    All(&'a [T]),
    /// Several: some may not be done yet.
    SoFar {
        /// What is done.
        cells: &'a [OnceLock<T>],
        /// Places in a row.
        columns: usize,
        /// Whether it ends before that.
        end: &'a End,
    },
}

/// How far a thread that has to wait lets the row above get ahead. Two that work close behind each other would pass the
/// memory between them back and forth, which takes longer than a block does.
const LEAD: usize = 16;

impl<T: Copy + Default> Earlier<'_, T> {
    /// What was given at `index`; anything where the sweep is given up.
    ///
    /// # Panics
    /// If it lies neither in a row above nor to the left, or the thread that was to do it has panicked.
    pub fn at(&self, index: usize) -> T {
        match self {
            Earlier::All(done) => done[index],
            Earlier::SoFar { cells, columns, end } => {
                if let Some(value) = cells[index].get() {
                    return *value;
                }
                let end_of_row = index - index % columns + columns - 1;
                let ahead = (index + LEAD).min(end_of_row);
                loop {
                    for _ in 0..1000 {
                        if let Some(value) = cells[ahead].get().and(cells[index].get()) {
                            return *value;
                        }
                        std::hint::spin_loop();
                    }
                    if end.given_up.get().is_some() {
                        return T::default();
                    }
                    assert!(!end.is_lost.load(Ordering::Relaxed), "another thread of the sweep has panicked");
                    std::thread::yield_now();
                }
            }
        }
    }
}

/// Raises a flag when its thread panics, so that others do not wait for it.
struct OnPanic<'a>(&'a AtomicBool);

impl Drop for OnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let (columns, rows) = (37, 50);
        // Every place depends on the one to the left and the one above to the right: a mistake anywhere spreads.
        let sweep = |threads| {
            let swept = Threads::new(threads).unwrap().sweep(
                ((columns, rows), || Ok(())),
                || 0u64,
                |calls, index, earlier: Earlier<u64>| {
                    *calls += 1;
                    let left = if index % columns > 0 { earlier.at(index - 1) } else { 1u64 };
                    let above = if index >= columns {
                        earlier.at((index - columns + 1).min(index / columns * columns - 1))
                    } else {
                        2
                    };
                    left.wrapping_mul(0x9E37_79B9).wrapping_add(above) ^ index as u64
                },
            );
            swept.expect("it is wanted")
        };
        let squares = |n| Threads::new(n).unwrap().map(1000, |i| i * i);
        assert_eq!(squares(1), squares(3));
        assert_eq!(sweep(1).len(), columns * rows);
        assert_eq!(sweep(1), sweep(2));
        assert_eq!(sweep(1), sweep(5));
        assert!(Threads::new(0).is_err() && Threads::new(Threads::MAX + 1).is_err());
    }

    #[test]
    fn a_panic_in_one_thread_ends_the_sweep() {
        let sweep = || {
            Threads::new(2).unwrap().sweep(
                ((4, 4), || Ok(())),
                || (),
                |(), index, earlier: Earlier<usize>| {
                    assert!(index != 5, "as planned");
                    if index >= 4 { earlier.at(index - 4) + 1 } else { index }
                },
            )
        };
        assert!(std::panic::catch_unwind(sweep).is_err());
    }

    #[test]
    fn work_that_nobody_wants_any_more_ends_with_its_reason() {
        for threads in [1, 2, 4] {
            let threads = Threads::new(threads).unwrap();
            let asked = AtomicUsize::new(0);
            let wanted = || match asked.fetch_add(1, Ordering::Relaxed) {
                0..40 => Ok(()),
                _ => Err(Error::new("enough")),
            };
            let above = |(): &mut (), index: usize, earlier: Earlier<usize>| {
                if index >= 10 { earlier.at(index - 10) + 1 } else { index }
            };
            let swept = threads.sweep(((10, 10_000), wanted), || (), above);
            assert_eq!(swept.unwrap_err().to_string(), "enough");
            assert!(asked.swap(0, Ordering::Relaxed) < 60, "nobody goes on to the end");
            assert_eq!(threads.map_while(100_000, wanted, |i| i).unwrap_err().to_string(), "enough");
            assert!(asked.load(Ordering::Relaxed) < 60_000);
            assert_eq!(threads.map_while(9, || Ok(()), |i| i * i).unwrap(), threads.map(9, |i| i * i));
        }
    }
}
