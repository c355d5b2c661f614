//! The explanation and the drawing of SIFT.

mod description;
mod extrema;
mod orientation;
mod refinement;

use std::f32::consts::SQRT_2;

use super::{Event, Row, Sift, Stage, State, case, features, line, value};
use crate::methods::scale_space::{Extremum, Refined};
use crate::run::Seen;
use crate::scene::{Picture, Readout, Role, Scene, Shape, Step};

/// Radius of the blob to which a difference of Gaussians responds most, in standard deviations.
const BLOB_RADIUS: f32 = SQRT_2;

impl Sift {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let Some(last) = seen.events.last().copied() else { return self.tell_dimensions(state) };
        let step = match last {
            Event::Level(_) => self.tell_blurring(seen),
            Event::Row(_) => match seen.point().and_then(|point| self.pointed_at(state, point)) {
                Some(around) => around.tell_comparison(Step::at(line::IS_EXTREMUM)),
                None => self.tell_search(seen, line::EACH_PIXEL).say(case::ROW),
            },
            Event::Extremum(x) => {
                let at = self.current_row(state).map(|Row { octave, level, y }| Extremum { octave, level, x, y });
                let (step, around) =
                    (self.tell_search(seen, line::IS_EXTREMUM), at.and_then(|at| self.around(state, at)));
                around.into_iter().fold(step, |step, around| around.tell_comparison(step))
            }
            Event::Iteration(iteration) => self.tell_fit(state, &iteration),
            Event::Verdict(verdict) => self.tell_verdict(seen, verdict),
            Event::Histogram | Event::Peak(_) => self.tell_orientation(seen, last),
            Event::Selected => self.tell_selection(state),
            Event::Cell(_) | Event::Normalised | Event::Clamped => self.tell_description(seen, last),
        };
        self.conclude(seen, step)
    }

    /// The dimensions of the scale space.
    fn tell_dimensions(&self, state: &State) -> Step {
        let (shape, size) = (self.shape(), state.picture.size());
        let (width, height) = shape.size_of(0, size);
        let step = Step::at(line::BUILD_SPACE).fact(value::OCTAVES, shape.octaves_of(size));
        let step = step.fact(value::SCALES, shape.scales).fact(value::IMAGES, shape.levels());
        step.fact(features::WIDTH, width).fact(features::HEIGHT, height).say(case::OPENING)
    }

    fn tell_blurring(&self, seen: &Seen<Self>) -> Step {
        let (state, shape) = (seen.before, self.shape());
        let (octave, level) = (state.next / shape.levels(), state.next % shape.levels());
        let ((width, height), pixel) = (shape.size_of(octave, state.picture.size()), shape.pixel_px(octave));
        let sigma = shape.sigma_of(level as f32);
        let step = Step::at(line::BUILD_SPACE).fact(value::OCTAVE, octave + 1);
        let step = step.fact(features::WIDTH, width).fact(features::HEIGHT, height).fact(value::IMAGE, level + 1);
        let step = step.fact(value::IMAGES, shape.levels()).fact(value::SIGMA, sigma);
        let step = step.fact(value::SIGMA_IN_FRAME, sigma * pixel).put(value::IMAGE_BEFORE, level);
        let radius = BLOB_RADIUS * shape.sigma_of(level as f32 - 1.0) * pixel;
        let step = step.put(value::INCREMENT, shape.increment_px(octave, level)).put(value::BLOB_RADIUS, radius);
        let step = step.say(match (octave, level) {
            (0, 0) if self.double => case::FIRST_DOUBLED,
            (0, 0) => case::FIRST,
            (_, 0) => case::HALVED,
            _ => case::BLURRED,
        });
        let step = step.show(Readout::Tiles(self.octave_tiles(seen)));
        step.show_all(self.stack(seen.after.unwrap_or(state)).map(Readout::Stack))
    }

    fn tell_selection(&self, state: &State) -> Step {
        let all = state.oriented.len();
        let step = Step::at(line::SELECT).fact(value::EXTREMA, state.extrema.len());
        let step = step.fact(value::AFTER_TESTS, state.refined.len()).fact(value::WITH_ORIENTATIONS, all);
        let step = step.fact(features::MAX_POINTS, self.max_points);
        let kept = self.select(state.oriented.clone());
        let Some(last) = kept.last() else { return self.none_kept(state, step) };
        let step = step.put(features::KEYPOINTS, kept.len()).put(value::WEAKEST, last.refined.response);
        let is_full = kept.len() == self.max_points && all > self.max_points;
        step.say(if is_full { case::SELECTED } else { case::ALL_SELECTED })
    }

    /// Explains why there are no keypoints.
    fn none_kept(&self, state: &State, step: Step) -> Step {
        let differences = state.space.octaves.iter().flat_map(|octave| &octave.differences);
        let largest = differences.flat_map(|image| image.cells()).fold(0.0, |most: f32, value| most.max(value.abs()));
        let at_extrema = state.extrema.iter().map(|at| {
            let difference = &state.space.octaves[at.octave].differences[at.level];
            difference[(at.x, at.y)].abs()
        });
        let step = step.put(value::LARGEST, largest).put(value::LEAST, self.least());
        let step = step.put(value::CONTRAST_THRESHOLD, self.thresholds().contrast);
        match at_extrema.reduce(f32::max) {
            Some(strongest) => step.put(value::STRONGEST, strongest).say(case::NONE_PASSED),
            None => step.say(if largest > self.least() { case::NO_EXTREMA } else { case::NO_CONTRAST }),
        }
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after.filter(|after| is_over(self, after)) else { return step };
        let kept = &after.oriented;
        let mut sigmas: Vec<f32> = kept.iter().map(|oriented| self.in_frame(&oriented.refined).1).collect();
        sigmas.sort_by(f32::total_cmp);
        let (Some(smallest), Some(largest)) = (sigmas.first(), sigmas.last()) else {
            return step.say(case::NO_KEYPOINTS);
        };
        let step = step.put(features::KEYPOINTS, kept.len()).put(value::EXTREMA, after.extrema.len());
        let step = step.put(value::SMALLEST_SIGMA, *smallest).put(value::LARGEST_SIGMA, *largest);
        let step = step.put(value::MEDIAN_SIGMA, sigmas[sigmas.len() / 2]).say(case::END);
        step.say(if kept.len() == self.max_points { case::AT_MOST } else { case::FURTHER_BLOBS })
    }
}

fn is_over(sift: &Sift, after: &State) -> bool {
    after.stage == Stage::Description && after.next >= sift.units_of_stage(after, Stage::Description)
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
        Shape::circle(center, BLOB_RADIUS * sigma_px)
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
