//! The explanation and the drawing of an iteration of a variational method.

use std::sync::Arc;

use super::Settings;
use super::model::Note;
use super::model::{Explanation, Model, Probe};
use super::run::{Event, State, Variational};
use super::vocabulary::{case, value};
use crate::geometry::Grid;
use crate::methods::differential::explain::{self, View};
use crate::methods::differential::{Conclusion, mean_change};
use crate::run::{Estimator, Seen};
use crate::scene::{
    Floor, Footing, Layer, Levels, Name, Picture, Plane, PlaneCost, Quantity, Readout, Role, Scene, Sentence, Series,
    Shape, Stack, Step, Unit, Variable,
};

/// The pseudocode lines that all methods share.
mod line {
    crate::line_names!(ENERGY, TAKE_MEDIANS, WARP);
}

impl<M: Model> Probe<'_, M> {
    /// Returns the iteration at the cursor, at the pixel pointed at or else at the default one; `None` before its first
    /// step.
    fn at<'a>(seen: &'a Seen<Variational<M>>) -> Option<Probe<'a, M>> {
        let Some(Event::Step(_, iteration)) = seen.events.last() else { return None };
        let (frames, level) = (&seen.before.fixed.frames, seen.before.level);
        let pointed_at = seen.point().and_then(|point| frames.pixel_at(level, point));
        Some(Probe {
            iteration,
            place: pointed_at.unwrap_or_else(|| frames.default_pixel(level)),
            level,
            scale: frames.scale(level),
        })
    }
}

impl<M: Model> Variational<M> {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let step = match (seen.events.last(), Probe::at(seen)) {
            (None, _) => return Step::at(line::ENERGY).say(M::OPENING),
            (Some(Event::Step(index, _)), Some(probe)) => self.tell_iteration(seen, *index, &probe),
            (Some(Event::Medians), _) => {
                self.step_at(line::TAKE_MEDIANS, state).say_if(state.warp == 0, case::UPSAMPLED).say(case::MEDIANS)
            }
            _ => {
                let step = self.step_at(line::WARP, state).put(value::WARP, state.warp + 1);
                let step = step.put(value::WARPS, self.settings().warps).say(case::WARP);
                step.say(if state.is_first_warp() { case::ZERO_FLOW } else { case::WARPED })
            }
        };
        let step = step.show_all(self.series(seen).into_iter().map(Readout::Series));
        step.show_all(self.stack(seen).map(Readout::Stack))
    }

    /// A step with its level and iteration.
    fn step_at(&self, line: Name, state: &State<M>) -> Step {
        state.fixed.frames.put(Step::at(line), state.level, (state.iteration + 1, self.settings().iterations))
    }

    /// The step `index` of an iteration at a pixel.
    fn tell_iteration(&self, seen: &Seen<Self>, index: usize, probe: &Probe<M>) -> Step {
        let step = probe.iteration.warp.linear.put(self.step_at(self.0.steps()[index], seen.before), probe.place);
        let step = match probe.start() {
            Some(start) => step.fact_of(probe.px(explain::value::START, start)),
            None => step,
        };
        let step = step.fact_of(probe.px(value::FLOW_BEFORE, probe.from()));
        let explanation = self.0.explanation(index, probe, step);
        let plane = plane(seen.before, probe, &explanation);
        let ([u, v], [across, down]) = (probe.to(), probe.scale);
        let is_coarse = seen.after.is_some() && probe.level > 0;
        let full_resolution_flow = is_coarse.then_some([u * across, v * down]);
        let step = explanation.step.fact_if(value::FULL_RESOLUTION_FLOW, full_resolution_flow);
        self.conclude(seen, step, probe.iteration.has_converged).show(plane)
    }

    /// Adds energy, change and error of an iteration, and the conclusion of the iteration and of the run, at the end of each.
    fn conclude(&self, seen: &Seen<Self>, step: Step, has_converged: Option<bool>) -> Step {
        let (Some(after), Some(note)) = (seen.after, self.noted(seen)) else { return step };
        let Settings { iterations, tolerance, .. } = self.settings();
        let is_last = seen.before.iteration + 1 == iterations;
        // Beside the tolerance the change has one more decimal: the tolerance may be smaller than the decimals of a displacement.
        let (told, further) = match has_converged {
            _ if seen.point().is_some() => (None, 0),
            Some(true) if !after.is_done => (Some(case::CONVERGED), 1),
            Some(false) if after.is_done => (Some(case::NOT_CONVERGED), 1),
            _ if after.is_done => (None, 0),
            _ if is_last => (Some(case::LAST_ITERATION), 0),
            Some(_) => (Some(case::NEXT_ITERATION), 1),
            None => (Some(explain::case::MEAN_CHANGE), 0),
        };
        let change = mean_change(seen.before.level, note.change);
        let unit = change.unit.finer(further);
        let energy = |of: &'static Variable, term: f32| of.is(term).in_unit(Unit::new(M::ENERGY_UNIT, 2));
        let step = step
            .put(value::TOLERANCE, tolerance)
            .put_value(energy(value::SMOOTHNESS_TERM, note.smoothness))
            .fact_as(energy(value::DATA_TERM, note.data), case::ENERGY)
            .fact_of(change.in_unit(unit))
            .fact_if(explain::value::ITERATION_ERROR, note.error.is_finite().then_some(note.error));
        let say = |step: Step| told.into_iter().fold(step, Step::say);
        if seen.point().is_some() || !after.is_done {
            return say(step);
        }
        let frames = &after.fixed.frames;
        let [across, down] = frames.scale(frames.count() - 1);
        let conclusion = Conclusion::new(&frames.frame_pair, &after.flow(), across.max(down));
        // The end of the run is about its result alone; the change in the last iteration is among the facts.
        let step = conclusion.tell(Step { sentence: Sentence::default(), ..step }, &M::ADVICE);
        // Where textured neighbours are advised, more iterations are as well.
        let is_advised = step.is(M::ADVICE.texture);
        let step = say(step);
        let is_open = step.is(case::NOT_CONVERGED);
        let step = step.say_if(is_open && !is_advised, case::MORE_ITERATIONS);
        step.put(value::FORMULA, self.0.last_formula()).say(case::FORMULA)
    }

    /// Returns energy, change and error of the iteration that ends at the cursor.
    fn noted(&self, seen: &Seen<Self>) -> Option<Note> {
        seen.after?;
        let Some(Event::Step(_, iteration)) = seen.events.last() else { return None };
        Some(self.note_of(seen.before, iteration))
    }

    /// Returns the pyramid, if it has several levels.
    pub(super) fn levels(&self, seen: &Seen<Self>) -> Option<Levels> {
        let at_work = if seen.events.is_empty() { 0 } else { seen.before.level };
        (seen.before.fixed.frames.count() > 1).then(|| Levels { all: seen.before.fixed.pictures(), at_work })
    }

    /// Returns the pyramid with the inspected pixel and the pixels at the same position on the other levels.
    fn stack(&self, seen: &Seen<Self>) -> Option<Stack> {
        let (levels, state) = (self.levels(seen)?, seen.before);
        let Some(probe) = Probe::at(seen) else {
            return Some(Stack { floors: vec![Floor::default(); levels.all.len()], levels });
        };
        let frames = &state.fixed.frames;
        let here = frames.scale(state.level);
        let floor = |level: usize| {
            let ((width, height), scale) = (frames.size(level), frames.scale(level));
            let on_level =
                |c: usize, i: usize, extent: usize| (((c as f32 + 0.5) * here[i] / scale[i]) as usize).min(extent - 1);
            let (x, y) = (on_level(probe.place.0, 0, width), on_level(probe.place.1, 1, height));
            let min = [x as f32 - 0.5, y as f32 - 0.5];
            let vector = match level == state.level {
                true => Some((if seen.after.is_some() { probe.to() } else { probe.from() }, Role::Best)),
                false => state.found(level).map(|found| (found.at(x, y), Role::Result)),
            };
            Floor { at_hand: Some([min, [min[0] + 1.0, min[1] + 1.0]]), vector }
        };
        Some(Stack { floors: (0..levels.all.len()).map(floor).collect(), levels })
    }

    /// Returns the share of the smoothness term at each pixel of frame t, on the level of the iteration.
    pub(super) fn layers(&self, seen: &Seen<Self>) -> Vec<Layer> {
        let Some(Event::Step(_, iteration)) = seen.events.last() else { return Vec::new() };
        if self.0.smoothness_share(&iteration.warp.linear, (0, 0)).is_none() {
            return Vec::new();
        }
        let (model, warp) = (self.0.clone(), Arc::clone(&iteration.warp));
        let [whole, level] = [0, seen.before.level].map(|level| seen.before.fixed.frames.size(level));
        vec![Layer::new(Quantity::SmoothnessShare, move || {
            let share = |x, y| model.smoothness_share(&warp.linear, (x * level.0 / whole.0, y * level.1 / whole.1));
            Grid::from_fn(whole.0, whole.1, |x, y| share(x, y).unwrap_or(f32::NAN))
        })]
    }

    /// Marks the inspected pixel.
    pub(super) fn draw_pixel(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(Probe { place: (x, y), level, .. }) = Probe::at(seen) else { return };
        let [x, y] = [x, y].map(|c| c as f32);
        let [min, max] = seen.before.fixed.frames.on_picture(level, [x, y], [x + 1.0, y + 1.0]);
        scene.draw(Picture::CURRENT, (Role::Reference, "inspected pixel"), Shape::Rect { min, max });
    }

    /// Returns the plots of energy, mean change and endpoint error over iterations.
    fn series(&self, seen: &Seen<Self>) -> Vec<Series> {
        let mut notes = seen.before.notes.clone();
        // The plotted iterations, and the current one.
        notes.extend(self.noted(seen));
        let Some(last) = notes.last().map(|note| note.number) else { return Vec::new() };
        let line = |of: fn(&Note) -> f32| -> Vec<[f32; 2]> {
            notes.iter().map(|note| [note.number as f32, of(note)]).collect()
        };
        // The axis ends at a power of two, so that the beginning stays readable.
        let near = std::iter::successors(Some(16), |end| Some(2 * end)).find(|end| *end >= last).unwrap_or(16);
        let x_max = self.units(seen.before).unwrap_or(last).min(near);
        let counts = (seen.before.fixed.frames.count(), self.settings().warps);
        let sections: Vec<_> = explain::sections(notes.iter().map(|note| (note.number, note.place)), counts).collect();
        let series = |title, y_label, lines| {
            let sections = sections.clone();
            Series { sections, ..Series::new(title, ["iteration", y_label], x_max, lines) }
        };
        let energy = vec![
            ("energy", Role::Result, line(|note| note.data + note.smoothness)),
            ("data term", Role::Reference, line(|note| note.data)),
            ("smoothness term", Role::Predicted, line(|note| note.smoothness)),
        ];
        let mut all = vec![
            series("Energy per pixel", M::ENERGY_UNIT, energy),
            Series {
                is_logarithmic: true,
                ..series("Mean change", "px", vec![("mean change", Role::Measured, line(|note| note.change))])
            },
        ];
        if notes.iter().all(|note| note.error.is_finite()) {
            all.push(series(
                "Mean endpoint error",
                "px",
                vec![("mean endpoint error", Role::Error, line(|note| note.error))],
            ));
        }
        all
    }
}

/// The (u, v) plane: constraint lines, the flow before and after the step, and the true flow. A single line has its name at its
/// displacement nearest to the neighbourhood mean, or else to the flow before the step: there the data term alone would lead.
fn plane<M: Model>(state: &State<M>, probe: &Probe<M>, explanation: &Explanation) -> Readout {
    let Explanation { points, lines, energy, .. } = explanation;
    let mut all = vec![("before", Role::Best, probe.from())];
    all.extend(points.iter().copied());
    let truth = state.fixed.frames.truth(probe.level, probe.place);
    all.extend(truth.map(|truth| ("true flow", Role::Truth, truth)));
    let shown: Vec<_> = all.iter().map(|(.., point)| *point).collect();
    let View { center, reach } = View::around(&shown, lines);
    if let [line] = &lines[..] {
        let mean = all.iter().find(|(name, ..)| *name == "mean");
        let from = mean.map_or(probe.from(), |(.., mean)| *mean);
        all.push(("nearest point of the line", line.role, explain::foot(line, from)));
    }
    Readout::Plane(Plane {
        title: "Constraint line and neighbourhood mean",
        unit: probe.unit().name.into(),
        reach,
        center,
        cost: energy.as_ref().map(|energy| {
            let (place, scale) = (<[usize; 2]>::from(probe.place), probe.scale);
            let at = [0, 1].map(|i| (place[i] as f32 + 0.5) * scale[i] - 0.5);
            let footing = Footing { px: scale[0], ..Footing::new(Picture::CURRENT, at) };
            PlaneCost::sampled(("energy up to a constant", M::ENERGY_UNIT), (center, reach), 1, energy).on(footing)
        }),
        path: Vec::new(),
        groups: Vec::new(),
        lines: lines.clone(),
        points: all,
        ellipse: None,
    })
}
