//! The dense flow of a pair by a method of choice, for estimators that go on from one.

use crate::memory::Need;
use crate::optical_flow::{Farneback, HornSchunck, TvL1};
use crate::variational::Variational;
use crate::{Clip, Error, Estimator, Flow, Frame, Threads, choices};

choices! {
    /// Which method finds the optical flow; its own parameters have their defaults.
    pub enum FlowMethod {
        /// Neighbourhoods as polynomials: fast, and smooth beyond the edges of what moves.
        Farneback = "farneback" "Farnebäck",
        /// A field as smooth as can be, from coarse to fine.
        HornSchunck = "horn-schunck" "Horn–Schunck",
        /// A field that may jump, from coarse to fine: with the sharpest edges, and the slowest.
        TvL1 = "tv-l1" "TV-L1",
    }
}

impl FlowMethod {
    /// Where each pixel of frame `t` of a clip goes in frame `t + 1`.
    ///
    /// # Errors
    /// If there is no such pair, it cannot be read, or nobody wants it any more.
    pub fn flow(self, clip: &Clip, t: usize, threads: &Threads) -> Result<Flow, Error> {
        match self {
            Self::Farneback => flow_by(&Farneback::default(), clip, t, threads),
            Self::HornSchunck => flow_by(&Variational::<HornSchunck>::default(), clip, t, threads),
            Self::TvL1 => flow_by(&Variational::<TvL1>::default(), clip, t, threads),
        }
    }

    /// Memory that the flow of a pair takes while it is worked out, whoever goes on from it.
    pub fn need(self, clip: &Clip) -> Need {
        let Need { run, .. } = match self {
            Self::Farneback => Farneback::default().need(clip),
            Self::HornSchunck => Variational::<HornSchunck>::default().need(clip),
            Self::TvL1 => Variational::<TvL1>::default().need(clip),
        };
        Need { run, walk: run }
    }

    /// Where each pixel of the first of two frames of one size goes in the second; frames of `clip`, with which the work is given
    /// up.
    ///
    /// # Errors
    /// If the sizes differ, the frames are too small for the method, or nobody wants it any more.
    pub fn between(self, clip: &Clip, frames: [&Frame; 2], threads: &Threads) -> Result<Flow, Error> {
        let grays = frames.map(|frame| Frame::gray(frame.luma().clone()));
        let pair = Clip::from_frames("a pair of frames", grays.into())?;
        self.flow(&pair.as_part_of(clip), 0, threads)
    }
}

fn flow_by<E: Estimator>(method: &E, clip: &Clip, t: usize, threads: &Threads) -> Result<Flow, Error> {
    method.run(clip, t, threads).map(|state| method.output(&state).flow())
}
