//! The charts of a keypoint of SURF.

use super::probe::Described;
use crate::geometry::Grid;
use crate::methods::features::haar::{SIDE, dominant, sector_start};
use crate::scene::{Readout, Role, Series, Step, Tile};

/// Adds the charts of a keypoint.
pub(super) fn charted(step: Step, of: &Described<'_>) -> Step {
    if of.subregions.is_empty() {
        return if of.sums.is_empty() { step } else { step.show(Readout::Series(wheel_series(of))) };
    }
    let most = of.subregions.iter().flatten().fold(1.0f32, |most, value| most.max(value.abs()));
    let tile = |(i, label): (usize, &'static str)| {
        let value = |x: usize, y: usize| {
            of.subregions.get(y * SIDE + x).map_or(f32::NAN, |sums| (10.0 * sums[i]).round() / 10.0)
        };
        Tile { label, role: None, values: Grid::from_fn(SIDE, SIDE, value), range: [-most, most], framed: Vec::new() }
    };
    let tiles = ["Σ dx", "Σ dy", "Σ |dx|", "Σ |dy|"].into_iter().enumerate().map(tile).collect();
    step.show(Readout::Series(descriptor_series(of))).show(Readout::Tiles(tiles))
}

/// The entries of the descriptor so far, four for each subregion.
fn descriptor_series(of: &Described<'_>) -> Series {
    let (scale, y_label) = match of.length.filter(|length| *length > 0.0) {
        Some(length) => (1.0 / length, "entry of length 1"),
        None => (1.0, "sum, gray levels"),
    };
    let entries = of.subregions.iter().flatten().map(|sum| sum * scale);
    Series {
        title: "Descriptor",
        x_label: "entry, 4 for each subregion",
        y_label,
        x_max: 4 * SIDE * SIDE,
        x_ticks: (0..=SIDE).map(|row| (row * 4 * SIDE).max(1) as f32).collect(),
        sections: Series::cells(SIDE, 4),
        columns: Some(SIDE),
        lines: vec![("entries", Role::Result, Series::bars(entries))],
        is_sweep: true,
        ..Series::default()
    }
}

/// The length of the sums over the direction of the sector.
fn wheel_series(of: &Described<'_>) -> Series {
    let point = |(k, [x, y]): (usize, &[f32; 2])| [sector_start(k).to_degrees(), x.hypot(*y)];
    let points: Vec<[f32; 2]> = of.sums.iter().enumerate().map(point).collect();
    let best = points[dominant(&of.sums).0];
    Series {
        title: "Sum of the wavelet responses in a sector",
        x_label: "first direction of the sector, degrees",
        y_label: "length, gray levels",
        x_max: 360,
        lines: vec![("sector of 60°", Role::Candidate, points), ("longest", Role::Result, vec![best])],
        is_sweep: true,
        ..Series::default()
    }
}
