//! Pyramidal Lucas–Kanade for one point, coarse to fine: J.-Y. Bouguet's algorithm.

use super::tracker::{Level, Mismatch, Template};
use crate::base::{Mapped, Observer};
use crate::methods::differential::{Tensor, Texture};
use crate::products::Status;

/// The parameters of the tracking.
#[derive(Clone, Copy, Debug)]
pub struct Follow {
    /// Radius of the window, in px of any level.
    pub reach: usize,
    /// Largest number of iterations per level.
    pub iterations: usize,
    /// Stopping criterion: the iterations end with a shorter increment, in px of the level.
    pub epsilon: f32,
    /// Smallest accepted eigenvalue λ₂ of the window's structure tensor, in (gray levels per px)².
    pub threshold: f32,
    /// Largest accepted mean absolute difference of the windows, in gray levels.
    pub max_residual: f32,
}

/// An event of the tracking on one level; displacements are in px of the level.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// The structure tensor of its window in frame t.
    Window(Tensor),
    /// An iteration at displacement `from` with the increment `update`.
    Iteration {
        /// The displacement before.
        from: [f32; 2],
        /// The mismatch of the windows there.
        mismatch: Mismatch,
        /// The increment.
        update: [f32; 2],
    },
    /// The end of a coarse level: the displacement, or the unchanged guess with the reason.
    PassedDown([f32; 2], Option<Status>),
    /// The end of level 0: the displacement, with the residual or the reason of the loss.
    End([f32; 2], Result<f32, Status>),
}

/// The result of a level.
#[derive(Clone, Copy, Debug)]
pub enum LevelResult {
    /// Of a coarse level: the initial guess of the next finer, in its px.
    Guess([f32; 2]),
    /// Of level 0: the displacement, with the residual or the reason of the loss.
    Done([f32; 2], Result<f32, Status>),
}

impl Follow {
    /// Whether an increment meets the stopping criterion.
    pub fn converges(&self, update: [f32; 2]) -> bool {
        update[0].hypot(update[1]) < self.epsilon
    }

    /// Tracks the point at `at`, in px of level 0, on one level, from an initial guess.
    pub fn on_level(
        &self,
        pyramids: [&[Level]; 2],
        level: usize,
        (at, guess): ([f32; 2], [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> LevelResult {
        let [current, next] = pyramids.map(|levels| &levels[level]);
        let at = at.map(|c| c / (1u32 << level) as f32);
        let template = Template::new(current, at, self.reach);
        observer.see(|| Event::Window(template.tensor));
        let (displacement, outcome) = self.iterate((&template, next), (at, guess), observer);
        if level > 0 {
            let displacement = if outcome.is_ok() { displacement } else { guess };
            observer.see(|| Event::PassedDown(displacement, outcome.err()));
            return LevelResult::Guess(displacement.map(|c| 2.0 * c));
        }
        let result = outcome.and_then(|()| {
            let residual = template.mismatch(next, [0, 1].map(|i| at[i] + displacement[i])).residual;
            if residual > self.max_residual { Err(Status::Unlike) } else { Ok(residual) }
        });
        observer.see(|| Event::End(displacement, result));
        LevelResult::Done(displacement, result)
    }

    /// Whether a window is ill-conditioned: λ₂ below the threshold.
    pub fn is_flat(&self, tensor: &Tensor) -> bool {
        tensor.texture(self.threshold) != Texture::Corner
    }

    /// Iterates until convergence.
    fn iterate(
        &self,
        (template, next): (&Template, &Level),
        (at, guess): ([f32; 2], [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> ([f32; 2], Result<(), Status>) {
        if self.is_flat(&template.tensor) {
            return (guess, Err(Status::Flat));
        }
        let mut displacement = guess;
        for _ in 0..self.iterations {
            let place = [0, 1].map(|i| at[i] + displacement[i]);
            if !next.holds(place) {
                return (displacement, Err(Status::Outside));
            }
            let mismatch = template.mismatch(next, place);
            // The part of the window inside the frame may be ill-conditioned.
            if self.is_flat(&mismatch.tensor) {
                return (displacement, Err(Status::Outside));
            }
            let update = mismatch.update();
            let from = displacement;
            observer.see(|| Event::Iteration { from, mismatch, update });
            displacement = [0, 1].map(|i| from[i] + update[i]);
            if self.converges(update) {
                break;
            }
        }
        let is_inside = next.holds([0, 1].map(|i| at[i] + displacement[i]));
        (displacement, if is_inside { Ok(()) } else { Err(Status::Outside) })
    }

    /// Tracks the point at `at` through all levels, from zero displacement.
    pub fn through(
        &self,
        pyramids: [&[Level]; 2],
        at: [f32; 2],
        observer: &mut impl Observer<(usize, Event)>,
    ) -> ([f32; 2], Result<f32, Status>) {
        let mut guess = [0.0; 2];
        for level in (0..pyramids[0].len()).rev() {
            let mut on_level = Mapped { observer: &mut *observer, map: |event| (level, event) };
            match self.on_level(pyramids, level, (at, guess), &mut on_level) {
                LevelResult::Guess(finer) => guess = finer,
                LevelResult::Done(displacement, result) => return (displacement, result),
            }
        }
        // A pyramid has at least level 0.
        (guess, Err(Status::Flat))
    }
}
