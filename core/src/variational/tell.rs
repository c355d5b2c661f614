//! How an iteration of a variational method is told and drawn.

use super::model::{Looked, Model, Told};
use super::run::{Event, Note, State, Variational};
use crate::differential::tell;
use crate::scene::{Fact, Picture, Plane, Readout, Sentence, Series, Shape};
use crate::{Estimator, Role, Scene, Seen, Step};

impl<M: Model> Looked<'_, M> {
    /// The iteration at a cursor, at the pixel pointed at, or else the one that changes most; `None` before its first step.
    fn at<'a>(seen: &'a Seen<Variational<M>>) -> Option<Looked<'a, M>> {
        let Some(Event::Step(_, iteration)) = seen.events.last() else { return None };
        let state = seen.before;
        let ((width, height), scale) = (state.level_size(state.level), state.scale(state.level));
        let pointed_at = seen.focus.and_then(|point| state.fixed.given.pixel_at(point)).map(|(x, y)| {
            let on_level = |c: usize, scale: f32, extent: usize| (((c as f32 + 0.5) / scale) as usize).min(extent - 1);
            (on_level(x, scale[0], width), on_level(y, scale[1], height))
        });
        Some(Looked { iteration, place: pointed_at.unwrap_or(iteration.most) })
    }
}

impl<M: Model> Variational<M> {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let (line, sentence, mut readouts) = match (seen.events.last(), Looked::at(seen)) {
            (None, _) => {
                return Step { line: 0, sentence: Sentence::default().text(M::OPENING), readouts: Vec::new() };
            }
            (Some(Event::Step(step, _)), Some(looked)) => {
                let Told { sentence, facts, equation, points, lines } = self.0.told(*step, &looked);
                let facts = self.facts(seen, Some((&looked, facts)));
                let plane = plane(seen.before, &looked, points, lines);
                (M::LINES.1[*step], sentence, vec![Readout::Facts(facts), Readout::Equation(equation), plane])
            }
            _ => (M::LINES.0, self.warped(seen.before), vec![Readout::Facts(self.facts(seen, None))]),
        };
        readouts.extend(self.series(seen).into_iter().map(Readout::Series));
        Step { line, sentence, readouts }
    }

    /// What is said when a warp begins.
    fn warped(&self, state: &State<M>) -> Sentence {
        let (width, height) = state.level_size(state.level);
        let warp = format!("{} of {}", state.warp + 1, self.settings().warps);
        Sentence::default().text(format!(
            "Level {} of the pyramid is {width}×{height} px large. Warp {warp}: frame t+1 is brought back by what was \
             found so far, and the derivatives are taken of what is left.",
            state.level
        ))
    }

    fn facts(&self, seen: &Seen<Self>, looked: Option<(&Looked<M>, Vec<Fact>)>) -> Vec<Fact> {
        let state = seen.before;
        let fact = |label, value, role| Fact { label, value, role };
        let (width, height) = state.level_size(state.level);
        let of = state.levels() - 1;
        let mut facts = vec![
            fact("Level", format!("{} of {of} to 0, {width}×{height} px", state.level), None),
            fact("Iteration", format!("{} of {}", state.iteration + 1, self.settings().iterations), None),
        ];
        if let Some((looked, more)) = looked {
            let (x, y) = looked.place;
            facts.push(fact("Pixel", format!("({x}, {y}) of the level"), Some(Role::Reference)));
            facts.push(looked.iteration.warp.linear.fact(looked.place));
            facts.push(fact("Before", format!("{} px", tell::vector(looked.from())), Some(Role::Best)));
            facts.extend(more);
        }
        if let Some(note) = seen.after.and_then(|after| after.notes.last()) {
            let [data, smoothness] = [note.data, note.smoothness].map(tell::number);
            facts.push(fact("Energy per pixel", format!("{data} data + {smoothness} smoothness"), None));
            facts.push(fact("Mean change", format!("{:.5} px", note.change), None));
            if note.error.is_finite() {
                facts.push(fact("Mean error", format!("{:.3} px", note.error), Some(Role::Truth)));
            }
        }
        facts
    }

    /// Marks the pixel that is explained.
    pub(super) fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(Looked { place: (x, y), .. }) = Looked::at(seen) else { return };
        let scale = seen.before.scale(seen.before.level);
        let edge = |i: usize, scale: f32| i as f32 * scale - 0.5;
        let min = [edge(x, scale[0]), edge(y, scale[1])];
        let max = [edge(x + 1, scale[0]), edge(y + 1, scale[1])];
        scene.mark(Picture::Current, Role::Reference, Shape::Rect { min, max });
        scene.legend(Role::Reference, "pixel that is explained");
    }

    /// What became of the energy, of the change and of the error, iteration by iteration.
    fn series(&self, seen: &Seen<Self>) -> Vec<Series> {
        let notes = &seen.after.unwrap_or(seen.before).notes;
        if notes.is_empty() {
            return Vec::new();
        }
        let line = |of: fn(&Note) -> f32| -> Vec<[f32; 2]> {
            notes.iter().enumerate().map(|(i, note)| [(i + 1) as f32, of(note)]).collect()
        };
        // Twice as far at most as the run has come, so that the beginning can be read as well.
        let near = std::iter::successors(Some(16), |end| Some(2 * end)).find(|end| *end >= notes.len()).unwrap_or(16);
        let x_max = self.units(seen.before).unwrap_or(notes.len()).min(near);
        let series =
            |title, y_label, lines| Series { title, x_label: "iteration", y_label, x_max, events: Vec::new(), lines };
        let energy = vec![
            ("energy", Role::Result, line(|note| note.data + note.smoothness)),
            ("data", Role::Reference, line(|note| note.data)),
            ("smoothness", Role::Predicted, line(|note| note.smoothness)),
        ];
        let mut all = vec![
            series("Energy per pixel", M::ENERGY_UNIT, energy),
            series("Mean change", "px", vec![("change", Role::Best, line(|note| note.change))]),
        ];
        if notes.iter().all(|note| note.error.is_finite()) {
            all.push(series("Mean endpoint error", "px", vec![("error", Role::Error, line(|note| note.error))]));
        }
        all
    }
}

/// The constraint of the pixel, where the iteration takes it, and where it truly goes.
fn plane<M: Model>(
    state: &State<M>,
    looked: &Looked<M>,
    points: Vec<(&'static str, Role, [f32; 2])>,
    lines: Vec<crate::scene::Constraint>,
) -> Readout {
    let scale = state.scale(state.level);
    let mut all = vec![("before", Role::Best, looked.from())];
    all.extend(points);
    let truth = state.truth(looked.place, scale);
    all.extend(truth.map(|[u, v]| ("truth", Role::Truth, [u / scale[0], v / scale[1]])));
    Readout::Plane(Plane {
        title: "Constraint and smoothness",
        reach: tell::reach(all.iter().map(|(.., point)| *point)),
        lines,
        points: all,
        ellipse: None,
    })
}
