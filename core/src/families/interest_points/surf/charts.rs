//! The charts of a keypoint of SURF.

use super::probe::Described;
use crate::geometry::Grid;
use crate::methods::features::haar::{SIDE, dominant, sector_start};
use crate::scene::{Readout, Role, Series, Step, Tile};

pub(super) fn add_charts(step: Step, of: &Described<'_>) -> Step {
    if of.subregions.is_empty() {
        return if of.sums.is_empty() { step } else { step.show(Readout::Series(wheel_series(of))) };
    }
    let most = of.subregions.iter().flatten().fold(1.0f32, |most, value| most.max(value.abs()));
    let tile = |(i, label): (usize, &'static str)| {
        let value = |x: usize, y: usize| {
            of.subregions.get(y * SIDE + x).map_or(f32::NAN, |sums| (10.0 * sums[i]).round() / 10.0)
        };
        Tile::new(label, Grid::from_fn(SIDE, SIDE, value), [-most, most])
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
        x_ticks: (0..=SIDE).map(|row| (row * 4 * SIDE).max(1) as f32).collect(),
        sections: Series::cells(SIDE, 4),
        columns: Some(SIDE),
        is_sweep: true,
        ..Series::new(
            "Descriptor",
            ["entry, 4 for each subregion", y_label],
            4 * SIDE * SIDE,
            vec![("entries", Role::Result, Series::bars(entries))],
        )
    }
}

/// The length of the sums over the direction of the sector.
fn wheel_series(of: &Described<'_>) -> Series {
    let point = |(k, [x, y]): (usize, &[f32; 2])| [sector_start(k).to_degrees(), x.hypot(*y)];
    let points: Vec<[f32; 2]> = of.sums.iter().enumerate().map(point).collect();
    let best = points[dominant(&of.sums).0];
    Series {
        is_sweep: true,
        ..Series::new(
            "Sum of the wavelet responses in a sector",
            ["first direction of the sector, degrees", "length, gray levels"],
            360,
            vec![("sector of 60°", Role::Candidate, points), ("longest", Role::Result, vec![best])],
        )
    }
}
