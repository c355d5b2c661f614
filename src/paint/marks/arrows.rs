//! How many of the arrows of a scene are drawn, and how long.

use std::collections::HashSet;
use std::sync::Arc;

use motionscope_core::scene::{self, Mark, Role, Scene, Shape};

use super::is_lengthened;

/// How near to each other displacements are drawn unless it is chosen, in points of the window and pixels of a file; closer, they would hide the picture and each other.
const CLOSEST: f32 = 5.0;
/// The same where it is chosen: closer, they cannot be told apart.
pub(super) const DISTINCT: f32 = 1.0;

/// Side of the cells, in px, of which each has room for one of `arrows` at `zoom`: a multiple of their spacing, and not
/// less than `wanted`.
pub(super) fn cell(arrows: &[scene::Arrow], zoom: f32, wanted: Option<f32>) -> f32 {
    let spacing = spacing(arrows);
    // Half a step more or less is nearest to what is wanted.
    let steps = match wanted {
        Some(wanted) => (wanted.max(DISTINCT / zoom) / spacing).round(),
        None => (CLOSEST / zoom / spacing).ceil(),
    };
    spacing * steps.max(1.0)
}

/// Whether some of `arrows` are left out at `zoom`, since there is no room for all or fewer are wanted.
pub fn is_thinned(arrows: &[scene::Arrow], zoom: f32, wanted: Option<f32>) -> bool {
    arrows.len() > 1 && cell(arrows, zoom, wanted) > spacing(arrows)
}

/// Those of `arrows` that are drawn at `zoom`: the first in each cell, so that a regular field stays regular.
pub(super) fn apart(arrows: &[scene::Arrow], zoom: f32, wanted: Option<f32>) -> Arc<[scene::Arrow]> {
    if !is_thinned(arrows, zoom, wanted) {
        return arrows.into();
    }
    let side = cell(arrows, zoom, wanted);
    let first = arrows.first().map_or([0.0; 2], |arrow| arrow.from);
    let mut taken = HashSet::new();
    // A quarter of a pixel keeps rounding from moving a place into the cell before.
    let place = |arrow: &scene::Arrow| [0, 1].map(|i| ((arrow.from[i] - first[i] + 0.25) / side).floor() as i32);
    arrows.iter().filter(|arrow| taken.insert(place(arrow))).copied().collect()
}

/// The power of two, ½ to 8, by which displacements are drawn so that few are longer than a step between them.
///
/// Where a window is searched its range decides, which stays the same from block to block; else what was found does.
pub(super) fn fitting(scene: &Scene, wanted: Option<f32>) -> Option<f32> {
    let searched = search(scene);
    let fit = |mark: &Mark| match (&mark.shape, searched) {
        _ if !is_lengthened(mark.role) => None,
        (Shape::Arrows(arrows), Some((block, range))) => {
            let room = if arrows.len() > 1 { block.max(spacing(arrows)) } else { block };
            Some(times(room / range).max(1.0))
        }
        (Shape::Arrows(arrows), None) => {
            let lengths = arrows.iter().map(|arrow| length(way(arrow)));
            Some(times(spacing(arrows).max(wanted.unwrap_or(0.0)) / typical(lengths)?))
        }
        (Shape::Flow { values, .. }, _) => {
            let step = scene::arrow_spacing(values.size());
            let along = |extent: usize| (step / 2..extent).step_by(step);
            let places = along(values.height()).flat_map(|y| along(values.width()).map(move |x| (x, y)));
            Some(times(wanted.unwrap_or(step as f32) / typical(places.map(|place| length(values[place])))?))
        }
        _ => None,
    };
    scene.marks.iter().filter_map(fit).min_by(f32::total_cmp)
}

fn times(room: f32) -> f32 {
    // A little beyond the neighbour is better than half the length.
    if room < 0.75 { 0.5 } else { [8.0, 4.0, 2.0].into_iter().find(|times| *times <= room).unwrap_or(1.0) }
}

/// Side of the block and range of the search in px, if a block is searched for in a window.
fn search(scene: &Scene) -> Option<(f32, f32)> {
    let rect = |role: Role| {
        scene.marks.iter().find_map(|mark| match mark.shape {
            Shape::Rect { min, max } if mark.role == role => Some((min, max)),
            _ => None,
        })
    };
    let ((min, max), (from, to)) = (rect(Role::Reference)?, rect(Role::Window)?);
    // At an edge of the picture the window is cut on that side alone.
    let range = (0..2).flat_map(|i| [min[i] - from[i], to[i] - max[i]]).fold(0.0, f32::max);
    let block = (max[0] - min[0]).max(max[1] - min[1]);
    (range > 0.0).then_some((block, range))
}

/// The length that one in ten displacements exceeds, of those that are any.
fn typical(lengths: impl Iterator<Item = f32>) -> Option<f32> {
    let mut lengths: Vec<f32> = lengths.filter(|length| *length > 0.0).collect();
    lengths.sort_by(f32::total_cmp);
    lengths.get(lengths.len().saturating_sub(1) * 9 / 10).copied()
}

pub(super) fn way(arrow: &scene::Arrow) -> [f32; 2] {
    [0, 1].map(|i| arrow.to[i] - arrow.from[i])
}

pub(super) fn length([x, y]: [f32; 2]) -> f32 {
    x.hypot(y)
}

/// Usual distance between neighbouring origins in px; 16 where there are no neighbours.
fn spacing(arrows: &[scene::Arrow]) -> f32 {
    let gap = |pair: &[scene::Arrow]| length([0, 1].map(|i| pair[1].from[i] - pair[0].from[i]));
    // The first tell it: there may be very many.
    let mut gaps: Vec<f32> = arrows.windows(2).take(64).map(gap).filter(|gap| *gap > 0.0).collect();
    gaps.sort_by(f32::total_cmp);
    gaps.get(gaps.len() / 2).copied().unwrap_or(16.0)
}
