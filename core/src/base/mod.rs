//! Foundations: errors, words and numbers, threads, cancellation, and observers.

pub mod clock;
pub mod effort;
pub mod entropy;
mod error;
pub mod heap;
mod observer;
mod stop;
pub mod threads;
pub mod wide;
pub mod words;

pub use error::{Error, is_command, printable};
pub use observer::{Count, Mapped, Observer, Tally};
pub use stop::Stop;
pub(crate) use threads::Earlier;
pub use threads::Threads;
pub use wide::LANES;
