//! The descriptor of a keypoint: its cells, their histograms, and the limit of the entries.

use super::super::{Event, Oriented, Sift, Stage, case, features, line, value};
use super::orientation::arrow;
use super::{BLOB_RADIUS, is_over};
use crate::methods::scale_space::{BINS, CELLS, CLAMP, Descriptor, SIDE};
use crate::run::Seen;
use crate::scene::{Arrow, Canvas, Picture, Readout, Role, Scene, Series, Shape, Step};

/// The label of the entries of a normalised descriptor.
const UNIT_LENGTH: &str = "entry of length 1";

impl Sift {
    /// Explains a cell, the normalisation or the limit of a descriptor.
    pub(super) fn tell_description(&self, seen: &Seen<Self>, event: Event) -> Step {
        let state = seen.before;
        let line = match event {
            Event::Cell(_) => line::FILL_CELL,
            Event::Normalised => line::NORMALISE,
            _ => line::CLAMP,
        };
        let Some(oriented) = state.oriented.get(state.next) else { return Step::at(line) };
        let (at, sigma_px) = self.in_frame(&oriented.refined);
        let step = Step::at(line).fact(features::KEYPOINT, state.next + 1);
        let step = step.fact(features::KEYPOINTS, state.oriented.len()).fact(features::POSITION, at);
        let step = step.fact(value::SIGMA_IN_FRAME, sigma_px);
        let step = step.fact(features::ORIENTATION, oriented.angle_rad.to_degrees());
        let raw = self.gathered(&state.space, oriented);
        let (step, series) = match event {
            Event::Cell(cell) => {
                let bins = &raw.0[cell * BINS..][..BINS];
                let strongest = (0..BINS).max_by(|a, b| bins[*a].total_cmp(&bins[*b])).unwrap_or_default();
                let step = step.put(value::CELL, cell + 1).put(value::CELL_WIDTH, self.place(oriented).cell_px());
                (
                    step.put(value::DIRECTION, 45 * strongest).say(case::CELL),
                    descriptor_series(&raw, "weight", cell + 1),
                )
            }
            Event::Normalised => {
                let length = raw.0.iter().map(|v| v * v).sum::<f32>().sqrt();
                let series = descriptor_series(&raw.normalised(), UNIT_LENGTH, CELLS);
                let thresholds = vec![("limit".to_owned(), CLAMP)];
                (step.put(value::LENGTH, length).say(case::NORMALISED), Series { thresholds, ..series })
            }
            _ => {
                let count = raw.normalised().0.iter().filter(|v| **v > CLAMP).count();
                let step = step.put(value::LARGE_ENTRIES, count).say(match count {
                    0 => case::NONE_LARGE,
                    1 => case::ONE_LARGE,
                    _ => case::SOME_LARGE,
                });
                (step.say(case::CLAMPED), descriptor_series(&raw.finished(), UNIT_LENGTH, CELLS))
            }
        };
        step.show(Readout::Series(series)).show(Readout::Tiles(vec![self.patch(state, &oriented.refined)]))
    }

    pub(super) fn draw_description(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (state, is_end) = (seen.before, seen.after.is_some_and(|after| is_over(self, after)));
        let shown = if state.stage == Stage::Selection { seen.after.unwrap_or(state) } else { state };
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT)];
        let current = state.oriented.get(state.next).filter(|_| state.stage == Stage::Description && !is_end);
        match current {
            Some(oriented) => {
                // Circles and radii of all would hide the cells.
                let others = shown.oriented.iter().filter(|other| *other != oriented);
                let points = others.map(|other| self.in_frame(&other.refined).0).collect();
                scene.draw(Picture::CURRENT, (Role::Candidate, "other keypoint"), Shape::Points(points));
                self.draw_keypoints(std::slice::from_ref(oriented), scene);
                self.draw_window(seen, oriented, scene);
            }
            None => self.draw_keypoints(&shown.oriented, scene),
        }
    }

    /// Circles with a radius in the direction of the orientation.
    fn draw_keypoints(&self, all: &[Oriented], scene: &mut Scene) {
        self.draw_circles(Picture::CURRENT, all.iter().map(|oriented| &oriented.refined), scene);
        for oriented in all {
            let (center, sigma_px) = self.in_frame(&oriented.refined);
            let Arrow { from, to } = arrow(center, oriented.angle_rad, BLOB_RADIUS * sigma_px);
            scene.mark(Picture::CURRENT, Role::Result, Shape::line(vec![from, to]));
        }
    }

    /// The rotated grid of cells, each filled one with the directions of its histogram.
    fn draw_window(&self, seen: &Seen<Self>, oriented: &Oriented, scene: &mut Scene) {
        let (place, pixel_px) = (self.place(oriented), self.shape().pixel_px(oriented.refined.at.octave));
        let at = |cells: [f32; 2]| place.at_cells(cells).map(|c| c * pixel_px);
        let half = SIDE as f32 / 2.0;
        for i in 0..=SIDE {
            let k = i as f32 - half;
            for ends in [[[-half, k], [half, k]], [[k, -half], [k, half]]] {
                let points = ends.map(at).to_vec();
                scene.mark(Picture::CURRENT, Role::Window, Shape::line(points));
            }
        }
        scene.legend(Role::Window, "cells of the descriptor");
        scene.work = Some(around_all([[-half, -half], [half, -half], [half, half], [-half, half]].map(at)));
        let filled = seen.events.iter().filter(|event| matches!(event, Event::Cell(_))).count();
        let entries = self.gathered(&seen.before.space, oriented).0;
        let most = entries.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let cell_px = place.cell_px() * pixel_px;
        let mut arrows = Vec::new();
        for cell in 0..filled {
            let middle = at([(cell % SIDE) as f32 + 0.5 - half, (cell / SIDE) as f32 + 0.5 - half]);
            for bin in 0..BINS {
                let angle = place.angle_rad + bin as f32 * std::f32::consts::FRAC_PI_4;
                arrows.push(arrow(middle, angle, 0.5 * cell_px * entries[cell * BINS + bin] / most));
            }
        }
        if !arrows.is_empty() {
            let rays = arrows.into_iter().map(|Arrow { from, to }| Shape::line(vec![from, to]));
            rays.for_each(|ray| scene.mark(Picture::CURRENT, Role::Best, ray));
            scene.legend(Role::Best, "weights of the 8 directions of a cell");
        }
    }
}

/// The 128 entries of a descriptor, those of the first `filled` cells.
fn descriptor_series(descriptor: &Descriptor, y_label: &'static str, filled: usize) -> Series {
    let points = Series::bars(descriptor.0.iter().take(filled * BINS).copied());
    Series {
        x_ticks: (0..=SIDE).map(|row| (row * SIDE * BINS).max(1) as f32).collect(),
        sections: Series::cells(SIDE, BINS),
        columns: Some(SIDE),
        is_sweep: true,
        ..Series::new(
            "Descriptor",
            ["entry: 8 directions of each of 16 cells", y_label],
            CELLS * BINS,
            vec![("entries", Role::Result, points)],
        )
    }
}

/// The smallest rectangle around corners, as min and max.
fn around_all(corners: [[f32; 2]; 4]) -> [[f32; 2]; 2] {
    let along = |i: usize, pick: fn(f32, f32) -> f32| corners.iter().map(|at| at[i]).fold(corners[0][i], pick);
    [f32::min, f32::max].map(|pick| [along(0, pick), along(1, pick)])
}
