//! The explanation and the drawing of SIFT.

mod description;
mod extrema;
mod orientation;
mod refinement;

use std::f32::consts::SQRT_2;

use super::{Event, Row, Sift, Stage, State, line};
use crate::base::words::{self, gray};
use crate::methods::scale_space::{Extremum, Refined};
use crate::run::Seen;
use crate::scene::{Fact, Name, Picture, Readout, Role, Scene, Sentence, Shape, Step};
use extrema::{compared, neighbourhood};
use orientation::peak_said;
use refinement::last_iteration;

/// Radius of the blob to which a difference of Gaussians responds most, in standard deviations.
const BLOB_RADIUS: f32 = SQRT_2;

impl Sift {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last().copied() else {
            let sentence = "SIFT finds the same points at another scale or rotation: a blob gives an extremum of the difference of \
                            Gaussians in position and in scale. First the scale space is built.";
            return Step {
                line: line::BUILD_SPACE,
                sentence: Sentence::default().text(sentence),
                readouts: vec![Readout::Facts(self.plan(seen.before))],
            };
        };
        let (line, sentence) = self.said(seen, last);
        let sentence = if seen.after.is_some() { self.concluded(seen, sentence) } else { sentence };
        Step { line, sentence, readouts: self.readouts(seen, last) }
    }

    /// The dimensions of the scale space.
    fn plan(&self, state: &State) -> Vec<Fact> {
        let (shape, size) = (self.shape(), state.picture.size());
        let (width, height) = shape.size_of(0, size);
        vec![
            Fact::new("Octaves", shape.octaves_of(size).to_string(), None),
            Fact::new("Gaussian images per octave", format!("{} ({} scales + 3)", shape.levels(), shape.scales), None),
            Fact::new("First octave", format!("{width} × {height} px"), None),
        ]
    }

    fn said(&self, seen: &Seen<Self>, event: Event) -> (Name, Sentence) {
        let (state, said) = (seen.before, Sentence::default());
        match event {
            Event::Level(_) => (line::BUILD_SPACE, said.text(self.level_said(state))),
            Event::Row(_) => match seen.point().and_then(|point| self.pointed_at(state, point)) {
                Some(around) => (line::IS_EXTREMUM, compared(&around)),
                None => (line::EACH_PIXEL, said.text(self.row_said(state))),
            },
            Event::Extremum(x) => (line::IS_EXTREMUM, self.extremum_said(state, x)),
            Event::Iteration(iteration) => (line::FIT, self.iteration_said(&iteration)),
            Event::Verdict(verdict) => self.verdict_said(seen, verdict),
            Event::Histogram => (line::EACH_KEYPOINT, self.histogram_said(state)),
            Event::Peak(peak) => (line::ORIENT, peak_said(seen, peak)),
            Event::Selected => (line::SELECT, said.text(self.selection_said(state))),
            Event::Cell(cell) => (line::FILL_CELL, self.cell_said(state, cell)),
            Event::Normalised => (line::NORMALISE, self.norm_said(state)),
            Event::Clamped => (line::CLAMP, self.clamp_said(state)),
        }
    }

    fn level_said(&self, state: &State) -> String {
        let shape = self.shape();
        let (octave, level) = (state.next / shape.levels(), state.next % shape.levels());
        let sigma = gray(shape.sigma_of(level as f32));
        let pixel = shape.pixel_px(octave);
        match (octave, level) {
            (0, 0) => format!(
                "Octave 1{}: a Gaussian filter with σ = {} px raises the blur of the camera, assumed 0.50 px of the frame, to σ = {sigma} px.",
                if self.double { ", at twice the resolution of the frame" } else { "" },
                gray(shape.increment_px(0, 0)),
            ),
            (_, 0) => format!(
                "Octave {}: every second pixel of the image with twice the first σ. At half the resolution it has σ = {sigma} px again, \
                 {} px of the frame.",
                octave + 1,
                gray(shape.sigma_of(0.0) * pixel)
            ),
            _ => format!(
                "Gaussian image {}: filtering image {level} with σ = {} px gives σ = {sigma} px. Their difference responds most \
                 to blobs with a radius of about {} px of the frame.",
                level + 1,
                gray(shape.increment_px(octave, level)),
                gray(BLOB_RADIUS * shape.sigma_of(level as f32 - 1.0) * pixel)
            ),
        }
    }

    fn selection_said(&self, state: &State) -> String {
        let kept = self.select(state.oriented.clone());
        let all = words::grouped(state.oriented.len());
        let Some(last) = kept.last() else {
            return self.none_said(state);
        };
        match kept.len() == self.max_points && state.oriented.len() > self.max_points {
            true => format!(
                "Kept: the {} of {all} keypoints with the largest |D| (the maximum number of points); the weakest has |D| = {} gray levels.",
                words::grouped(kept.len()),
                gray(last.refined.response)
            ),
            false => format!(
                "All {} keypoints are kept, in order of decreasing |D|; the weakest has {} gray levels.",
                words::grouped(kept.len()),
                gray(last.refined.response)
            ),
        }
    }

    /// Why there are no keypoints.
    fn none_said(&self, state: &State) -> String {
        let (contrast, least) = (self.thresholds().contrast, self.least());
        let differences = state.space.octaves.iter().flat_map(|octave| &octave.differences);
        let largest = differences.flat_map(|image| image.cells()).fold(0.0, |most: f32, value| most.max(value.abs()));
        let at_extrema = state.extrema.iter().map(|at| {
            let difference = &state.space.octaves[at.octave].differences[at.level];
            difference[(at.x, at.y)].abs()
        });
        match at_extrema.fold(None, |most: Option<f32>, value| Some(most.map_or(value, |most| most.max(value)))) {
            Some(strongest) => format!(
                "No extremum passed the tests, so there are no keypoints: |D| is at most {} gray levels at the extrema ({}), the contrast threshold is \
                 {}, and none may lie on an edge. A lower contrast threshold keeps weaker ones.",
                gray(strongest),
                words::grouped(state.extrema.len()),
                gray(contrast)
            ),
            None if largest > least => "0 pixels exceed all of their 26 neighbours, so there are no keypoints: a blob has an extremum, edges and \
                                        ramps have none."
                .into(),
            None => format!(
                "|D| is at most {} gray levels, and an extremum needs more than {}, half the contrast threshold: the frame has no blobs of enough \
                 contrast, so there are no keypoints. A lower contrast threshold finds weaker ones.",
                gray(largest),
                gray(least)
            ),
        }
    }

    fn concluded(&self, seen: &Seen<Self>, sentence: Sentence) -> Sentence {
        let Some(after) = seen.after.filter(|after| is_over(self, after)) else { return sentence };
        let kept = &after.oriented;
        if kept.is_empty() {
            return sentence.text(" End of the run without keypoints.");
        }
        let mut sigmas: Vec<f32> = kept.iter().map(|oriented| self.in_frame(&oriented.refined).1).collect();
        sigmas.sort_by(f32::total_cmp);
        let help = match kept.len() == self.max_points {
            true => "The maximum number of points is reached; a larger value admits weaker keypoints.",
            false => {
                "A lower contrast threshold keeps weaker blobs; a lower edge threshold rejects more extrema on edges."
            }
        };
        sentence.text(format!(
            " End of the run: {} from {} extrema, σ from {} to {} px, half of them below {} px. {help}",
            words::counted(kept.len(), "keypoint"),
            words::grouped(after.extrema.len()),
            gray(sigmas[0]),
            gray(sigmas[sigmas.len() - 1]),
            gray(sigmas[sigmas.len() / 2])
        ))
    }
}

/// Whether the run ends with this state.
fn is_over(sift: &Sift, after: &State) -> bool {
    after.stage == Stage::Description && after.next >= sift.units_of_stage(after, Stage::Description)
}

/// The charts and numbers.
impl Sift {
    fn readouts(&self, seen: &Seen<Self>, event: Event) -> Vec<Readout> {
        let state = seen.before;
        match event {
            Event::Level(_) => {
                let mut all = vec![Readout::Facts(self.level_facts(state)), Readout::Tiles(self.octave_tiles(seen))];
                all.extend(self.stack(seen.after.unwrap_or(state)).map(Readout::Stack));
                all
            }
            Event::Row(_) => match seen.point().and_then(|point| self.pointed_at(state, point)) {
                Some(around) => vec![Readout::Tiles(neighbourhood(&around))],
                None => vec![Readout::Facts(self.row_facts(seen))],
            },
            Event::Extremum(x) => {
                let at = self.current_row(state).map(|Row { octave, level, y }| Extremum { octave, level, x, y });
                let around = at.and_then(|at| self.around(state, at));
                let mut all = vec![Readout::Facts(self.row_facts(seen))];
                all.extend(around.map(|around| Readout::Tiles(neighbourhood(&around))));
                all
            }
            Event::Iteration(iteration) => self.fit_readouts(state, &iteration),
            Event::Verdict(_) => last_iteration(seen).map_or_else(Vec::new, |last| self.verdict_readouts(state, &last)),
            Event::Histogram | Event::Peak(_) => self.orientation_readouts(state),
            Event::Selected => vec![Readout::Facts(vec![
                Fact::new("Extrema", words::grouped(state.extrema.len()), None),
                Fact::new("After the tests", words::grouped(state.refined.len()), None),
                Fact::new("With orientations", words::grouped(state.oriented.len()), None),
                Fact::new("Maximum number of points", words::grouped(self.max_points), None),
            ])],
            Event::Cell(_) | Event::Normalised | Event::Clamped => self.descriptor_readouts(seen, event),
        }
    }

    fn level_facts(&self, state: &State) -> Vec<Fact> {
        let shape = self.shape();
        let (octave, level) = (state.next / shape.levels(), state.next % shape.levels());
        let (width, height) = shape.size_of(octave, state.picture.size());
        let sigma = shape.sigma_of(level as f32);
        vec![
            Fact::new("Octave", format!("{}, {width} × {height} px", octave + 1), None),
            Fact::new("Gaussian image", format!("{} of {}", level + 1, shape.levels()), None),
            Fact::new("σ in px of the octave", gray(sigma), None),
            Fact::new("σ in px of the frame", gray(sigma * shape.pixel_px(octave)), None),
        ]
    }
}

/// The drawing.
impl Sift {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        match seen.before.stage {
            Stage::Space => self.draw_space(seen, scene),
            Stage::Extrema => self.draw_extrema(seen, scene),
            Stage::Refinement => self.draw_refinement(seen, scene),
            Stage::Orientation => self.draw_orientation(seen, scene),
            Stage::Selection | Stage::Description => self.draw_description(seen, scene),
        }
    }

    fn circle(&self, refined: &Refined) -> Shape {
        let (center, sigma_px) = self.in_frame(refined);
        Shape::Ellipse { center, radii: [BLOB_RADIUS * sigma_px; 2], angle_rad: 0.0 }
    }

    fn draw_circles<'a>(&self, on: Picture, all: impl Iterator<Item = &'a Refined>, scene: &mut Scene) {
        let mut is_any = false;
        for refined in all {
            scene.mark(on, Role::Result, self.circle(refined));
            is_any = true;
        }
        if is_any {
            scene.legend(Role::Result, "keypoint, radius √2 σ");
        }
    }
}
