//! The explanation and the drawing of an iteration of a variational method.

use std::sync::Arc;

use super::Settings;
use super::model::{Explanation, Model, Probe};
use super::run::{Event, Note, State, TESTED, Variational};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::differential::explain::{self, View};
use crate::methods::differential::{Conclusion, numbers};
use crate::run::{Estimator, Seen};
use crate::scene::{
    Fact, Floor, Footing, Layer, Levels, Picture, Plane, PlaneCost, Quantity, Readout, Role, Scene, Sentence, Series,
    Shape, Stack, Step,
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
        let (line, sentence, mut readouts) = match (seen.events.last(), Probe::at(seen)) {
            (None, _) => {
                return Step {
                    values: Vec::new(),
                    line: line::ENERGY,
                    sentence: Sentence::default().text(M::OPENING),
                    readouts: Vec::new(),
                };
            }
            (Some(Event::Step(step, _)), Some(probe)) => {
                let explanation = self.0.explanation(*step, &probe);
                let plane = plane(seen.before, &probe, &explanation);
                let Explanation { sentence, facts, equation, .. } = explanation;
                let facts = self.facts(seen, Some((&probe, facts)));
                (
                    self.0.steps()[*step],
                    self.concluded(seen, sentence),
                    vec![Readout::Facts(facts), Readout::Equation(equation), plane],
                )
            }
            (Some(Event::Medians), _) => {
                (line::TAKE_MEDIANS, medians(seen.before), vec![Readout::Facts(self.facts(seen, None))])
            }
            _ => (line::WARP, self.warped(seen.before), vec![Readout::Facts(self.facts(seen, None))]),
        };
        readouts.extend(self.series(seen).into_iter().map(Readout::Series));
        readouts.extend(self.stack(seen).map(Readout::Stack));
        Step { values: Vec::new(), line, sentence, readouts }
    }

    /// Adds the conclusion of an iteration and of the run, at the end of each.
    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let (Some(after), None) = (seen.after, seen.point()) else { return sentence };
        let Settings { iterations, tolerance, .. } = self.settings();
        let Some(note) = self.noted(seen) else { return sentence };
        let number = seen.before.iteration + 1;
        let is_tested = tolerance > 0.0 && number.is_multiple_of(TESTED);
        // The tolerance may be smaller than the decimals of a displacement.
        // The change is that of the displacements in the frame.
        let unit = if seen.before.level == 0 { "px" } else { "px of level 0" };
        let (change, precise) = (numbers::px(note.change), numbers::fixed(note.change, 4));
        let said = match is_tested && note.change < tolerance {
            true => format!(
                " The mean change of {precise} {unit} is below the tolerance of {} px: converged.",
                numbers::fixed(tolerance, 4)
            ),
            false if number == iterations => {
                format!(" Mean change of iteration {iterations}, the last of this warp: {change} {unit}.")
            }
            false if is_tested => format!(
                " The mean change of {precise} {unit} is not below the tolerance of {} px: next iteration.",
                numbers::fixed(tolerance, 4)
            ),
            false => format!(" Mean change of the iteration: {change} {unit}."),
        };
        if !after.is_done {
            return sentence.text(said);
        }
        let frames = &after.fixed.frames;
        let [across, down] = frames.scale(frames.count() - 1);
        let conclusion = Conclusion::new(&frames.frame_pair, &after.flow(), across.max(down));
        // The end of the run is about its result alone; what the last iteration changed stands in the facts.
        let said = conclusion.tell(Step::at(line::WARP), &M::ADVICE).sentence;
        let said = match is_tested && note.change >= tolerance {
            true => said.text(format!(
                " Not converged: the last iteration still changed the flow by {precise} px on average. More iterations \
                 carry it on from the gradients into areas without any."
            )),
            false => said,
        };
        match Probe::at(seen) {
            Some(probe) => said
                .text(format!(" The formula is the {} of ", self.0.last_formula()))
                .ink(Role::Reference, probe.pixel())
                .text("."),
            None => said,
        }
    }

    /// Returns energy, change and error of the iteration that ends at the cursor.
    fn noted(&self, seen: &Seen<Self>) -> Option<Note> {
        seen.after?;
        let Some(Event::Step(_, iteration)) = seen.events.last() else { return None };
        Some(self.note_of(seen.before, iteration))
    }

    /// The sentence at the start of a warp.
    fn warped(&self, state: &State<M>) -> Sentence {
        let (width, height) = state.fixed.frames.size(state.level);
        let warp = format!("{} of {}", state.warp + 1, self.settings().warps);
        let what = if state.is_first_warp() {
            "the flow is still 0, so the derivatives are taken from both frames without warping."
        } else {
            "frame t+1 is warped toward frame t by the current flow (u₀, v₀), and brightness constancy is linearised again. \
             I_t is now the residual that the current flow leaves."
        };
        Sentence::default().text(format!("Level {} ({width}×{height} px), warp {warp}: {what}", state.level))
    }

    fn facts(&self, seen: &Seen<Self>, probe: Option<(&Probe<M>, Vec<Fact>)>) -> Vec<Fact> {
        let state = seen.before;
        let fact = |label, value: String, role| Fact::new(label, value, role);
        let (width, height) = state.fixed.frames.size(state.level);
        let of = state.fixed.frames.count() - 1;
        let mut facts = vec![
            fact("Level", format!("{} ({of} is the coarsest), {width}×{height} px", state.level), None),
            fact("Iteration", format!("{} of {}", state.iteration + 1, self.settings().iterations), None),
        ];
        if let Some((probe, more)) = probe {
            let (x, y) = probe.place;
            facts.push(fact("Pixel", words::pixel((x, y)), Some(Role::Reference)));
            facts.push(probe.iteration.warp.linear.fact(probe.place));
            facts.extend(probe.start().map(|start| fact("Linearised at (u₀, v₀)", probe.px(start), None)));
            facts.push(fact("Flow before", probe.px(probe.from()), Some(Role::Best)));
            facts.extend(more);
            if seen.after.is_some() && probe.level > 0 {
                let ([u, v], [across, down]) = (probe.to(), probe.scale);
                let value = format!("{} px", numbers::vector([u * across, v * down]));
                facts.push(fact("At full resolution", value, Some(Role::Result)));
            }
        }
        if let Some(note) = self.noted(seen) {
            let [data, smoothness] = [note.data, note.smoothness].map(numbers::gray);
            facts.push(fact(
                "Energy per pixel",
                format!("{data} data term + {smoothness} smoothness term, in {}", M::ENERGY_UNIT),
                None,
            ));
            facts.push(fact("Mean change", format!("{} px", numbers::px(note.change)), None));
            if note.error.is_finite() {
                facts.push(fact("Mean endpoint error", format!("{} px", numbers::px(note.error)), Some(Role::Truth)));
            }
        }
        facts
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
        scene.mark(Picture::CURRENT, Role::Reference, Shape::Rect { min, max });
        scene.legend(Role::Reference, "inspected pixel");
    }

    /// Returns the plots of energy, mean change and endpoint error over iterations.
    fn series(&self, seen: &Seen<Self>) -> Vec<Series> {
        let mut notes = seen.before.notes.clone();
        // Those plotted, and the current one.
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
            Series { title, x_label: "iteration", y_label, x_max, sections, lines, ..Series::default() }
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

/// The sentence of the median filter, before every warp but the first.
fn medians<M: Model>(state: &State<M>) -> Sentence {
    let from = match state.warp {
        0 => {
            "The flow of the coarser level is upsampled to this level, and its vectors are scaled by the same factor. "
        }
        _ => "",
    };
    Sentence::default().text(format!(
        "{from}A 3×3 median filter on u and v removes outliers, so that they do not enter the next linearisation."
    ))
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
        unit: probe.unit(),
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
