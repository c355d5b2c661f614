//! Following one point from the coarsest level of a pyramid to the picture: J.-Y. Bouguet's algorithm.

use super::tracker::{Level, Mismatch, Template};
use crate::base::{Mapped, Observer};
use crate::methods::differential::{Tensor, Texture};
use crate::products::Status;

/// How points are followed.
#[derive(Clone, Copy, Debug)]
pub struct Follow {
    /// How far a window reaches from its middle, in px of any level.
    pub reach: usize,
    /// At most so many updates on each level.
    pub iterations: usize,
    /// An update shorter than this, in px of its level, is the last there.
    pub epsilon: f32,
    /// The least that the smaller eigenvalue of a window's tensor must be, in (gray levels per px)².
    pub threshold: f32,
    /// How much a window may differ on average where it led to, in gray levels.
    pub max_residual: f32,
}

/// What happens to a point on one level; displacements are in px of the level.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// Its window in frame t has this tensor.
    Window(Tensor),
    /// Its window was laid at `from` in frame t + 1, and moves by `update`.
    Iteration {
        /// The displacement before.
        from: [f32; 2],
        /// How the window fits there.
        mismatch: Mismatch,
        /// What is added to the displacement.
        update: [f32; 2],
    },
    /// A coarse level is done: with this displacement, which is the guess where the level can say nothing, and why it cannot.
    Handed([f32; 2], Option<Status>),
    /// The picture itself is done: with this displacement, and with the residual or why the point is lost.
    End([f32; 2], Result<f32, Status>),
}

/// What a point has come to on a level.
#[derive(Clone, Copy, Debug)]
pub enum LevelResult {
    /// On a coarse one: the guess for the next finer, in px of that.
    Guess([f32; 2]),
    /// On the picture itself: the displacement, and the residual or why the point is lost.
    Done([f32; 2], Result<f32, Status>),
}

impl Follow {
    /// Whether an update is so short that it is the last one on its level.
    pub fn converges(&self, update: [f32; 2]) -> bool {
        update[0].hypot(update[1]) < self.epsilon
    }

    /// Follows the point at `at`, in px of the picture, on one level of both frames, beginning with a guess.
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
        let (displacement, is_told) = self.iterate((&template, next), (at, guess), observer);
        if level > 0 {
            let displacement = if is_told.is_ok() { displacement } else { guess };
            observer.see(|| Event::Handed(displacement, is_told.err()));
            return LevelResult::Guess(displacement.map(|c| 2.0 * c));
        }
        let result = is_told.and_then(|()| {
            let residual = template.mismatch(next, [0, 1].map(|i| at[i] + displacement[i])).residual;
            if residual > self.max_residual { Err(Status::Unlike) } else { Ok(residual) }
        });
        observer.see(|| Event::End(displacement, result));
        LevelResult::Done(displacement, result)
    }

    /// Whether the gradients of a window say too little in one direction.
    fn is_flat(&self, tensor: &Tensor) -> bool {
        tensor.texture(self.threshold) != Texture::Corner
    }

    /// Moves the window until it fits.
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
            // What is left of a window that lies partly outside may say too little.
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

    /// Follows the point at `at` through all levels before the eyes of `observer`, beginning without a guess.
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
        // A pyramid has at least the picture.
        (guess, Err(Status::Flat))
    }
}
