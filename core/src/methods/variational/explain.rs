//! How an iteration of a variational method is told and drawn.

use super::model::{Looked, Model, Told};
use super::run::{Event, Note, State, Variational};
use crate::base::words;
use crate::methods::differential::explain;
use crate::run::{Estimator, Seen};
use crate::scene::{Fact, Floor, Levels, Picture, Plane, Readout, Role, Scene, Sentence, Series, Shape, Stack, Step};

/// The lines that all methods have.
mod line {
    crate::line_names!(ENERGY, TAKE_MEDIANS, WARP);
}

impl<M: Model> Looked<'_, M> {
    /// The iteration at a cursor, at the pixel pointed at, or else the one that changes most; `None` before its first step.
    fn at<'a>(seen: &'a Seen<Variational<M>>) -> Option<Looked<'a, M>> {
        let Some(Event::Step(_, iteration)) = seen.events.last() else { return None };
        let (frames, level) = (&seen.before.fixed.frames, seen.before.level);
        let pointed_at = seen.point().and_then(|point| frames.pixel_at(level, point));
        Some(Looked { iteration, place: pointed_at.unwrap_or(iteration.most), level, scale: frames.scale(level) })
    }
}

impl<M: Model> Variational<M> {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let (line, sentence, mut readouts) = match (seen.events.last(), Looked::at(seen)) {
            (None, _) => {
                return Step {
                    line: line::ENERGY,
                    sentence: Sentence::default().text(M::OPENING),
                    readouts: Vec::new(),
                };
            }
            (Some(Event::Step(step, _)), Some(looked)) => {
                let Told { sentence, facts, equation, points, lines } = self.0.told(*step, &looked);
                let facts = self.facts(seen, Some((&looked, facts)));
                let plane = plane(seen.before, &looked, points, lines);
                (M::STEPS[*step], sentence, vec![Readout::Facts(facts), Readout::Equation(equation), plane])
            }
            (Some(Event::Medians), _) => {
                (line::TAKE_MEDIANS, medians(seen.before), vec![Readout::Facts(self.facts(seen, None))])
            }
            _ => (line::WARP, self.warped(seen.before), vec![Readout::Facts(self.facts(seen, None))]),
        };
        readouts.extend(self.series(seen).into_iter().map(Readout::Series));
        readouts.extend(self.stack(seen).map(Readout::Stack));
        Step { line, sentence, readouts }
    }

    /// What is said when a warp begins.
    fn warped(&self, state: &State<M>) -> Sentence {
        let (width, height) = state.fixed.frames.size(state.level);
        let warp = format!("{} of {}", state.warp + 1, self.settings().warps);
        let what = if state.is_first_warp() {
            "nothing was found yet, so the derivatives are taken of both frames as they are."
        } else {
            "frame t+1 is brought back by what was found so far, and the derivatives are taken of what is left."
        };
        Sentence::default()
            .text(format!("Level {} of the pyramid is {width}×{height} px large. Warp {warp}: {what}", state.level))
    }

    fn facts(&self, seen: &Seen<Self>, looked: Option<(&Looked<M>, Vec<Fact>)>) -> Vec<Fact> {
        let state = seen.before;
        let fact = |label, value, role| Fact { label, value, role };
        let (width, height) = state.fixed.frames.size(state.level);
        let of = state.fixed.frames.count() - 1;
        let mut facts = vec![
            fact("Level", format!("{}, from {of} down to 0, {width}×{height} px", state.level), None),
            fact("Iteration", format!("{} of {}", state.iteration + 1, self.settings().iterations), None),
        ];
        if let Some((looked, more)) = looked {
            let (x, y) = looked.place;
            facts.push(fact("Pixel", format!("({x}, {y}) of the level"), Some(Role::Reference)));
            facts.push(looked.iteration.warp.linear.fact(looked.place));
            facts.extend(looked.start().map(|start| fact("Warp (u₀, v₀)", looked.px(start), None)));
            facts.push(fact("Before", looked.px(looked.from()), Some(Role::Best)));
            facts.extend(more);
            if seen.after.is_some() && looked.level > 0 {
                let ([u, v], [across, down]) = (looked.to(), looked.scale);
                let value = format!("{} px", words::vector([u * across, v * down]));
                facts.push(fact("On the picture", value, Some(Role::Result)));
            }
        }
        if let Some(note) = seen.after.and_then(|after| after.notes.last()) {
            let [data, smoothness] = [note.data, note.smoothness].map(words::number);
            facts.push(fact("Energy per pixel", format!("{data} data + {smoothness} smoothness"), None));
            facts.push(fact("Mean change", format!("{:.5} px", note.change), None));
            if note.error.is_finite() {
                facts.push(fact("Mean error", format!("{:.3} px", note.error), Some(Role::Truth)));
            }
        }
        facts
    }

    /// The pyramid, if it has more levels than the picture itself; that is what there is before anything was done.
    pub(super) fn levels(&self, seen: &Seen<Self>) -> Option<Levels> {
        let at_work = if seen.events.is_empty() { 0 } else { seen.before.level };
        (seen.before.fixed.frames.count() > 1).then(|| Levels { all: seen.before.fixed.pictures(), at_work })
    }

    /// The pyramid with the pixel that is explained, and with those of the other levels that lie where it does.
    fn stack(&self, seen: &Seen<Self>) -> Option<Stack> {
        let (levels, state) = (self.levels(seen)?, seen.before);
        let Some(looked) = Looked::at(seen) else {
            return Some(Stack { floors: vec![Floor::default(); levels.all.len()], levels });
        };
        let frames = &state.fixed.frames;
        let here = frames.scale(state.level);
        let floor = |level: usize| {
            let ((width, height), scale) = (frames.size(level), frames.scale(level));
            let on_level =
                |c: usize, i: usize, extent: usize| (((c as f32 + 0.5) * here[i] / scale[i]) as usize).min(extent - 1);
            let (x, y) = (on_level(looked.place.0, 0, width), on_level(looked.place.1, 1, height));
            let min = [x as f32 - 0.5, y as f32 - 0.5];
            let vector = match level == state.level {
                true => Some((if seen.after.is_some() { looked.to() } else { looked.from() }, Role::Best)),
                false => state.found(level).map(|found| (found.at(x, y), Role::Result)),
            };
            Floor { at_hand: Some([min, [min[0] + 1.0, min[1] + 1.0]]), vector }
        };
        Some(Stack { floors: (0..levels.all.len()).map(floor).collect(), levels })
    }

    /// Marks the pixel that is explained.
    pub(super) fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(Looked { place: (x, y), level, .. }) = Looked::at(seen) else { return };
        let [x, y] = [x, y].map(|c| c as f32);
        let [min, max] = seen.before.fixed.frames.on_picture(level, [x, y], [x + 1.0, y + 1.0]);
        scene.mark(Picture::CURRENT, Role::Reference, Shape::Rect { min, max });
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
        let counts = (seen.before.fixed.frames.count(), self.settings().warps);
        let sections: Vec<_> = explain::sections(notes.iter().map(|note| note.place), counts).collect();
        let series = |title, y_label, lines| {
            let sections = sections.clone();
            Series { title, x_label: "iteration", y_label, x_max, sections, lines, ..Series::default() }
        };
        let energy = vec![
            ("energy", Role::Result, line(|note| note.data + note.smoothness)),
            ("data", Role::Reference, line(|note| note.data)),
            ("smoothness", Role::Predicted, line(|note| note.smoothness)),
        ];
        let mut all = vec![
            series("Energy per pixel", M::ENERGY_UNIT, energy),
            Series {
                is_logarithmic: true,
                ..series("Mean change", "px", vec![("change", Role::Measured, line(|note| note.change))])
            },
        ];
        if notes.iter().all(|note| note.error.is_finite()) {
            all.push(series("Mean endpoint error", "px", vec![("error", Role::Error, line(|note| note.error))]));
        }
        all
    }
}

/// What is said before a warp that begins with what was found.
fn medians<M: Model>(state: &State<M>) -> Sentence {
    let from = if state.warp == 0 { "The field of the coarser level is enlarged to this one. " } else { "" };
    Sentence::default().text(format!(
        "{from}Each displacement becomes the median of those of the 3×3 px around it, u and v by themselves, so that nothing \
         astray is carried on."
    ))
}

/// The constraint of the pixel, where the iteration takes it, and where it truly goes.
fn plane<M: Model>(
    state: &State<M>,
    looked: &Looked<M>,
    points: Vec<(&'static str, Role, [f32; 2])>,
    lines: Vec<crate::scene::Constraint>,
) -> Readout {
    let mut all = vec![("before", Role::Best, looked.from())];
    all.extend(points);
    let truth = state.fixed.frames.truth(looked.level, looked.place);
    all.extend(truth.map(|truth| ("truth", Role::Truth, truth)));
    Readout::Plane(Plane {
        title: "Constraint and smoothness",
        unit: looked.unit(),
        reach: explain::reach(all.iter().map(|(.., point)| *point)),
        lines,
        points: all,
        ellipse: None,
    })
}
