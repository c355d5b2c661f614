//! The explanation of Farnebäck's method.

use super::{Event, Farneback, Note};
use crate::cases;
use crate::methods::differential::{Advice, Conclusion, explain, mean_change};
use crate::methods::polynomial::{ExpansionPair, Inspected, Probe, WindowSolver};
use crate::run::Seen;
use crate::scene::{Role, Series, Step};

cases! { pub(super)
    OPENING: "Polynomial expansion approximates each neighbourhood by x · A x + b · x + c. If the image shifts by d, the linear term \
              becomes b − 2 A d, so the change of b determines d where A is invertible.",
    ADVISE_TEXTURE: "A larger window may contain other gradients; the smoothness term of Horn–Schunck fills such areas.",
    ADVISE_BOUNDARY: "The window mixes the motions of both sides; a smaller window or TV-L1 mixes them less.",
    ADVISE_MOTION: "More pyramid levels would reach this motion.",
}

/// Remedies where Farnebäck's method fails.
const ADVICE: Advice =
    Advice { texture: case::ADVISE_TEXTURE, boundary: case::ADVISE_BOUNDARY, motion: case::ADVISE_MOTION };

impl Farneback {
    /// Returns the iteration at the pixel pointed at, or else at the default one.
    pub(super) fn probe<'a>(&self, seen: &Seen<'a, Self>) -> Option<Probe<'a>> {
        let Event { part, iteration } = seen.events.last()?;
        let (frames, level) = (&*seen.before.frames, seen.before.level);
        let pointed_at = seen.point().and_then(|point| frames.pixel_at(level, point));
        let place = pointed_at.unwrap_or_else(|| frames.default_pixel(level));
        let expansions = ExpansionPair { pair: iteration.polynomials.each_ref(), from: &iteration.from };
        let solver = WindowSolver { window: self.window(), damping: self.damping };
        let inspected = Inspected { expansions, to: &iteration.to, place };
        Some(Probe::new(*part, (frames, level), inspected, solver, self.poly_n / 2))
    }

    /// Adds change and error of an iteration, and the conclusion of the iteration and of the run, at the end of each.
    pub(super) fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after else { return step };
        let Some(note) = after.notes.last() else { return step };
        let step = step.fact_of(mean_change(note.level, note.change));
        let step = step.fact_if(explain::value::ITERATION_ERROR, note.error.is_finite().then_some(note.error));
        if seen.point().is_some() {
            return step;
        }
        let step = step.say(explain::case::MEAN_CHANGE);
        if !after.is_done {
            return step;
        }
        let [across, down] = after.frames.scale(after.frames.count() - 1);
        let flow = after.frames.flow(&after.field);
        Conclusion::new(&after.frames.frame_pair, &flow, across.max(down)).tell(step, &ADVICE)
    }

    /// Returns the plots of mean change and endpoint error over iterations.
    pub(super) fn series(&self, seen: &Seen<Self>) -> Vec<Series> {
        let notes = &seen.after.unwrap_or(seen.before).notes;
        let line = |of: fn(&Note) -> f32| -> Vec<[f32; 2]> {
            notes.iter().enumerate().map(|(i, note)| [(i + 1) as f32, of(note)]).collect()
        };
        let x_max = seen.before.frames.count() * self.iterations;
        let counts = (seen.before.frames.count(), 1);
        let sections: Vec<_> =
            explain::sections(notes.iter().enumerate().map(|(i, note)| (i + 1, (note.level, 0))), counts).collect();
        let series = |title, lines| {
            let sections = sections.clone();
            Series { sections, ..Series::new(title, ["iteration", "px"], x_max, lines) }
        };
        let mut all = Vec::new();
        if !notes.is_empty() {
            let change = series("Mean change", vec![("mean change", Role::Best, line(|note| note.change))]);
            all.push(Series { is_logarithmic: true, ..change });
            if notes.iter().all(|note| note.error.is_finite()) {
                all.push(series(
                    "Mean endpoint error",
                    vec![("mean endpoint error", Role::Error, line(|note| note.error))],
                ));
            }
        }
        all
    }
}
