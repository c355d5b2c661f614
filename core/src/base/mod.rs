//! Foundations: errors, words and numbers, threads, cancellation, and observers.

pub mod effort;
pub(crate) mod entropy;
mod error;
pub mod heap;
mod observer;
mod stop;
pub(crate) mod threads;
pub(crate) mod wide;
pub mod words;

pub use error::{Error, is_command, printable};
pub(crate) use observer::Mapped;
pub use observer::{Count, Observer, Tally};
pub use stop::Stop;
pub(crate) use threads::Earlier;
pub use threads::Threads;
pub(crate) use wide::LANES;
