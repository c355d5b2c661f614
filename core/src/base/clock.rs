//! The time that work takes, behind one door: a target without a clock, such as a browser, measures none.

use std::time::Duration;

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
mod measured {
    pub type Start = std::time::Instant;

    pub fn start() -> Start {
        Start::now()
    }

    pub fn since(start: Start) -> super::Duration {
        start.elapsed()
    }
}

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod measured {
    pub type Start = ();

    pub fn start() -> Start {}

    pub fn since(_: Start) -> super::Duration {
        super::Duration::ZERO
    }
}

/// The time since it was started. It decides what is kept for speed, never what is computed.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(measured::Start);

impl Stopwatch {
    /// Starts to measure.
    pub fn start() -> Self {
        Self(measured::start())
    }

    /// Returns the time so far; zero where there is no clock.
    pub fn elapsed(self) -> Duration {
        measured::since(self.0)
    }
}
