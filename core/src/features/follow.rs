//! Following one point from the coarsest level of a pyramid to the picture: J.-Y. Bouguet's algorithm.

use super::tracker::{Level, Mismatch, Template};
use crate::differential::Tensor;
use crate::estimator::Mapped;
use crate::{Observer, Status};

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
    /// The level is done: with this displacement, which the finer level takes twice, or on the finest with this result.
    End([f32; 2], Result<f32, Status>),
}

/// What a point has come to on a level: its displacement, and its residual or why it is lost.
pub type Followed = ([f32; 2], Result<f32, Status>);

impl Follow {
    /// Follows the point at `at`, in px of the picture, on one level of both frames, beginning with a guess.
    pub fn on_level(
        &self,
        pyramids: [&[Level]; 2],
        level: usize,
        (at, guess): ([f32; 2], [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> Followed {
        let [current, next] = pyramids.map(|levels| &levels[level]);
        let at = at.map(|c| c / (1u32 << level) as f32);
        let template = Template::new(current, at, self.reach);
        observer.see(|| Event::Window(template.tensor));
        let (displacement, is_told) = self.iterate((&template, next), (at, guess), observer);
        let (displacement, result) = match is_told {
            Ok(()) if level > 0 => (displacement, Ok(f32::NAN)),
            // Where a coarse level says nothing, its guess is handed on.
            Err(_) if level > 0 => (guess, Ok(f32::NAN)),
            Err(why) => (displacement, Err(why)),
            Ok(()) => {
                let residual = template.mismatch(next, [0, 1].map(|i| at[i] + displacement[i])).residual;
                (displacement, if residual > self.max_residual { Err(Status::Unlike) } else { Ok(residual) })
            }
        };
        observer.see(|| Event::End(displacement, result));
        (displacement, result)
    }

    /// Moves the window until it fits.
    fn iterate(
        &self,
        (template, next): (&Template, &Level),
        (at, guess): ([f32; 2], [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> ([f32; 2], Result<(), Status>) {
        let [large, small] = template.tensor.eigenvalues();
        // Even without a threshold, two lines that are one do not cross.
        if small <= 1e-5 * large || small < self.threshold {
            return (guess, Err(Status::Flat));
        }
        let mut displacement = guess;
        for _ in 0..self.iterations {
            let place = [0, 1].map(|i| at[i] + displacement[i]);
            if !next.holds(place) {
                return (displacement, Err(Status::Outside));
            }
            let mismatch = template.mismatch(next, place);
            let update = template.update(mismatch);
            let from = displacement;
            observer.see(|| Event::Iteration { from, mismatch, update });
            displacement = [0, 1].map(|i| from[i] + update[i]);
            if update[0].hypot(update[1]) < self.epsilon {
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
    ) -> Followed {
        let (mut guess, mut result) = ([0.0; 2], Ok(0.0));
        for level in (0..pyramids[0].len()).rev() {
            let mut on_level = Mapped { observer: &mut *observer, map: |event| (level, event) };
            let (displacement, told) = self.on_level(pyramids, level, (at, guess), &mut on_level);
            (guess, result) = (displacement.map(|c| if level > 0 { 2.0 * c } else { c }), told);
        }
        (guess, result)
    }
}
