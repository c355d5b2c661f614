//! The charts and the drawing of phase correlation.

use super::{Event, PhaseCorrelation, Stage, State, spectrum};
use crate::geometry::Grid;
use crate::run::Seen;
use crate::scene::{BetweenPixels, Footing, Matrix, Picture, Readout, Role, Scene, Shape, Step, Surface, Tile};

/// Cells along a side of a tile, at most.
const CELLS: usize = 96;
/// Largest displacement on the chart from its middle, in px.
const REACH: i32 = 32;

impl PhaseCorrelation {
    pub(super) fn add_charts(&self, step: Step, stage: Stage, state: &State) -> Step {
        let is_correlation =
            matches!(stage, Stage::InverseRows | Stage::Peak | Stage::Second | Stage::Subpixel(_) | Stage::Result);
        let step = step.show(Readout::Tiles(self.tiles(stage, state)));
        let step = step.show_all(is_correlation.then(|| Readout::Surface(surface(stage, state))));
        let result = state.model().matrix.filter(|_| stage == Stage::Result);
        step.show_all(
            result.map(|of| Readout::Matrices(vec![Matrix::of_rows("H", "translation", &of).with_role(Role::Result)])),
        )
    }

    /// The picture of the stage.
    fn tiles(&self, stage: Stage, state: &State) -> Vec<Tile> {
        let shown = |label, values: Grid<f32>| {
            let values = spectrum::reduced(&values, CELLS);
            let known = values.cells().iter().copied().filter(|value| value.is_finite());
            let range = known.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
            let range = if range[0] < range[1] { range } else { [0.0, 1.0] };
            Tile::new(label, values, range)
        };
        let magnitude = |of: rustfft::num_complex::Complex<f64>| (1.0 + of.norm()).ln();
        let labels = |i: usize, labels: [&'static str; 2]| labels[i];
        match stage {
            Stage::Window(i) => {
                let label = labels(i, ["frame t, windowed", "frame t+1, windowed"]);
                state.spectra[i].iter().map(|picture| shown(label, picture.map(|value| value.re as f32))).collect()
            }
            Stage::Rows(i) => {
                let label = labels(i, ["rows of G₁, log magnitude", "rows of G₂, log magnitude"]);
                state.spectra[i].iter().map(|picture| shown(label, spectrum::centred(picture, magnitude))).collect()
            }
            Stage::Columns(i) => {
                let label = labels(i, ["|G₁|, logarithmic", "|G₂|, logarithmic"]);
                let picture = state.spectra[i].iter();
                picture.map(|picture| shown(label, spectrum::centred(picture, magnitude))).collect()
            }
            Stage::Cross => {
                let both = |picture| {
                    let phase = spectrum::centred(picture, |value| value.arg());
                    [shown("|C|, logarithmic", spectrum::centred(picture, magnitude)), shown("phase of C", phase)]
                };
                state.cross.iter().flat_map(|cross| both(cross)).collect()
            }
            Stage::Normalize => {
                let real = |picture| shown("real part of R", spectrum::centred(picture, |value| value.re));
                state.cross.iter().map(|cross| real(cross)).collect()
            }
            Stage::InverseColumns => {
                let picture = state.cross.iter();
                picture
                    .map(|cross| shown("columns of r, magnitude", spectrum::centred(cross, |value| value.norm())))
                    .collect()
            }
            _ => {
                let picture = state.cross.iter();
                picture
                    .map(|cross| shown("r, displacement 0 in the middle", spectrum::centred(cross, |value| value.re)))
                    .collect()
            }
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let (width, height) = seen.before.size();
        let Some(Event { stage, state }) = seen.events.last() else { return };
        let [width, height] = [width, height].map(|c| c as f32);
        if *stage == Stage::Result && state.is_accepted() {
            scene.draw(
                Picture::CURRENT,
                (Role::Result, "translation"),
                Shape::Flow { origin: [0.0; 2], values: state.model().displacements_of_pixels().0 },
            );
            return;
        }
        // The window reaches half its height here.
        let half = if self.hann { [0.25, 0.75] } else { [0.0, 1.0] };
        let edge = |share: f32| [share * width - 0.5, share * height - 0.5];
        let on = if matches!(stage, Stage::Window(1) | Stage::Rows(1) | Stage::Columns(1)) {
            Picture::NEXT
        } else {
            Picture::CURRENT
        };
        scene.draw(
            on,
            (Role::Window, if self.hann { "half height of the Hann window" } else { "window" }),
            Shape::Rect { min: edge(half[0]), max: edge(half[1]) },
        );
    }
}

/// The correlation around its peak.
fn surface(stage: Stage, state: &State) -> Surface {
    let (width, height) = state.size();
    let middle = state.peak.map_or([0, 0], |peak| state.wrapped(peak));
    let reach = [width, height].map(|extent| (extent as i32 / 2).min(REACH));
    // With the displacement 0, where there is room.
    let middle = [0, 1].map(|i| if middle[i].abs() <= reach[i] { 0 } else { middle[i] });
    let origin = [middle[0] - reach[0], middle[1] - reach[1]];
    let size = reach.map(|reach| (2 * reach + 1) as usize);
    let values =
        Grid::from_fn(size[0], size[1], |x, y| state.height_at([origin[0] + x as i32, origin[1] + y as i32]) as f32);
    let middle = state.fixed.truth.as_ref().and_then(|truth| truth.at(width / 2, height / 2));
    Surface {
        best: state.peak.map(|peak| state.wrapped(peak)),
        between: if matches!(stage, Stage::Subpixel(_) | Stage::Result) {
            vec![BetweenPixels::of_unknown(state.translation().map(|c| c as f32))]
        } else {
            Vec::new()
        },
        truth: middle.filter(|_| stage == Stage::Result),
        is_similarity: true,
        // A translation of the whole picture is shown from its middle.
        footing: Some(Footing::new(Picture::CURRENT, [width, height].map(|side| (side as f32 - 1.0) / 2.0))),
        ..Surface::new("r", origin, values, Grid::new(size[0], size[1], Some(1)))
    }
}
