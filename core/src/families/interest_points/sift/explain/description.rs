//! The descriptor of a keypoint: its cells, their histograms, and the limit of the entries.

use super::super::{Event, Oriented, Sift, Stage, State};
use super::orientation::arrow;
use super::{BLOB_RADIUS, is_over};
use crate::base::words::{self, gray};
use crate::methods::scale_space::{BINS, CELLS, CLAMP, Descriptor, SIDE};
use crate::run::Seen;
use crate::scene::{Arrow, Canvas, Fact, Picture, Readout, Role, Scene, Sentence, Series, Shape};

impl Sift {
    pub(super) fn cell_said(&self, state: &State, cell: usize) -> Sentence {
        let Some(oriented) = state.oriented.get(state.next) else { return Sentence::default() };
        let bins = self.gathered(&state.space, oriented).0;
        let bins = &bins[cell * BINS..][..BINS];
        let strongest = (0..BINS).max_by(|a, b| bins[*a].total_cmp(&bins[*b])).unwrap_or_default();
        let degrees = oriented.angle_rad.to_degrees();
        Sentence::default().text(format!(
            "Cell {} of {CELLS}, turned by the orientation {}° and {} px of the octave wide: gradients relative to the orientation fill 8 bins \
             of 45°. The strongest is {}°.",
            cell + 1,
            words::fixed(degrees.into(), 0),
            gray(self.place(oriented).cell_px()),
            45 * strongest
        ))
    }

    pub(super) fn norm_said(&self, state: &State) -> Sentence {
        let Some(oriented) = state.oriented.get(state.next) else { return Sentence::default() };
        let raw = self.gathered(&state.space, oriented);
        let length = raw.0.iter().map(|v| v * v).sum::<f32>().sqrt();
        Sentence::default().text(format!(
            "The {} entries have the length {}; divided by it they no longer depend on the contrast of the picture.",
            CELLS * BINS,
            gray(length)
        ))
    }

    pub(super) fn clamp_said(&self, state: &State) -> Sentence {
        let Some(oriented) = state.oriented.get(state.next) else { return Sentence::default() };
        let entries = self.gathered(&state.space, oriented).normalised().0;
        let count = entries.iter().filter(|v| **v > CLAMP).count();
        let what = match count {
            0 => "No entry exceeds 0.2.".to_owned(),
            1 => "1 entry exceeds 0.2 and is limited to it.".to_owned(),
            count => format!("{count} entries exceed 0.2 and are limited to it."),
        };
        Sentence::default().text(format!(
            "{what} The limit keeps single large gradients, as at a highlight, from outweighing all others. Normalised again, this is \
             the descriptor."
        ))
    }

    pub(super) fn descriptor_readouts(&self, seen: &Seen<Self>, event: Event) -> Vec<Readout> {
        let state = seen.before;
        let Some(oriented) = state.oriented.get(state.next) else { return Vec::new() };
        let raw = self.gathered(&state.space, oriented);
        let (shown, label, filled) = match event {
            Event::Cell(cell) => (raw, "weight", cell + 1),
            Event::Normalised => (raw.normalised(), "entry of length 1", CELLS),
            _ => (raw.finished(), "entry of length 1", CELLS),
        };
        let (at, sigma_px) = self.in_frame(&oriented.refined);
        let facts = vec![
            Fact::new("Keypoint", format!("{} of {}", state.next + 1, state.oriented.len()), None),
            Fact::new("Position", format!("{} px", words::place(at)), Some(Role::Reference)),
            Fact::new("σ in px of the frame", gray(sigma_px), None),
            Fact::new("Orientation", format!("{}°", words::fixed(oriented.angle_rad.to_degrees().into(), 1)), None),
        ];
        let series = descriptor_series(&shown, label, filled, matches!(event, Event::Normalised));
        vec![Readout::Facts(facts), Readout::Series(series), Readout::Tiles(vec![self.patch(state, &oriented.refined)])]
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
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::Points(points));
                scene.legend(Role::Candidate, "other keypoint");
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
            scene.mark(Picture::CURRENT, Role::Result, Shape::Path { points: vec![from, to], closed: false });
        }
    }

    /// The rotated grid of cells, each filled one with the directions of its histogram.
    pub(super) fn draw_window(&self, seen: &Seen<Self>, oriented: &Oriented, scene: &mut Scene) {
        let (place, pixel_px) = (self.place(oriented), self.shape().pixel_px(oriented.refined.at.octave));
        let at = |cells: [f32; 2]| place.at_cells(cells).map(|c| c * pixel_px);
        let half = SIDE as f32 / 2.0;
        for i in 0..=SIDE {
            let k = i as f32 - half;
            for ends in [[[-half, k], [half, k]], [[k, -half], [k, half]]] {
                let points = ends.map(at).to_vec();
                scene.mark(Picture::CURRENT, Role::Window, Shape::Path { points, closed: false });
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
            let rays =
                arrows.into_iter().map(|Arrow { from, to }| Shape::Path { points: vec![from, to], closed: false });
            rays.for_each(|ray| scene.mark(Picture::CURRENT, Role::Best, ray));
            scene.legend(Role::Best, "weights of the 8 directions of a cell");
        }
    }
}

/// The 128 entries of a descriptor, those of the first `filled` cells.
pub(super) fn descriptor_series(
    descriptor: &Descriptor,
    y_label: &'static str,
    filled: usize,
    shows_clamp: bool,
) -> Series {
    let points = Series::bars(descriptor.0.iter().take(filled * BINS).copied());
    Series {
        title: "Descriptor",
        x_label: "entry: 8 directions of each of 16 cells",
        y_label,
        x_max: CELLS * BINS,
        x_ticks: (0..=SIDE).map(|row| (row * SIDE * BINS).max(1) as f32).collect(),
        sections: Series::cells(SIDE, BINS),
        columns: Some(SIDE),
        lines: vec![("entries", Role::Result, points)],
        thresholds: if shows_clamp { vec![("limit".to_owned(), CLAMP)] } else { Vec::new() },
        is_sweep: true,
        ..Series::default()
    }
}

/// The smallest rectangle around corners, as min and max.
pub(super) fn around_all(corners: [[f32; 2]; 4]) -> [[f32; 2]; 2] {
    let along = |i: usize, pick: fn(f32, f32) -> f32| corners.iter().map(|at| at[i]).fold(corners[0][i], pick);
    [f32::min, f32::max].map(|pick| [along(0, pick), along(1, pick)])
}
