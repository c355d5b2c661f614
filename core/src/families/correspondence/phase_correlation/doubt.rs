//! Evidence in the pictures against the highest peak: another displacement that fits better, or as well.

use super::State;
use crate::data::Mask;
use crate::geometry::Gray;

/// Peaks that are compared, the highest first.
const PEAKS: usize = 8;
/// A displacement is compared where the displaced frame still covers this share of the other.
const LEAST_OVERLAP: f64 = 0.25;
/// Another displacement fits clearly better if its residual is below this share of the peak's.
const BETTER: f64 = 0.6;
/// Residuals that differ by less than this share of the contrast are equal.
const EQUAL: f64 = 0.05;
/// The edge of a border at rest is as wide as this, in px.
const EDGE_PX: usize = 2;
/// A displacement fits if its residual is below this share of the contrast.
const FITS: f64 = 0.5;
/// Texture of one direction has a structure tensor with a smaller ratio of eigenvalues.
const ONE_DIRECTION: f64 = 0.02;

/// Why the highest peak is not the translation of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Doubt {
    /// Another peak leaves a much smaller residual: the highest one stands for a part of the picture, such as a border at rest.
    Contradicted {
        /// The displacement of the other peak in px.
        other: [i32; 2],
        /// Mean absolute residual in gray levels at the highest peak and at the other.
        residuals: [f64; 2],
    },
    /// All gradients have one direction: the displacement along the edges is free (aperture problem).
    Aperture {
        /// The unit vector across the edges.
        across: [f64; 2],
        /// The period of the pattern across the edges in px, if it repeats.
        period_px: Option<i32>,
    },
    /// The pattern repeats: another peak is nearly as high and fits as well. The highest one may still be right.
    Repeats {
        /// That displacement in px.
        other: [i32; 2],
    },
}

impl Doubt {
    /// Whether the highest peak cannot be taken for the translation.
    pub(super) fn is_refuting(&self) -> bool {
        !matches!(self, Self::Repeats { .. })
    }

    /// Compares the highest peak with the pictures.
    pub(super) fn of(state: &State) -> Option<Self> {
        let [from, to] = state.fixed.pair.each_ref().map(|frame| frame.luma());
        let at = state.wrapped(state.peak?);
        let counts = informative([from, to]);
        let residual = |by: [i32; 2]| residual([from, to], &counts, by);
        let own = residual(at)?;
        let contrast = contrast(from, state.fixed.means[0]);
        let is_equal = |other: f64| other <= own + EQUAL * contrast;
        if let Some(across) = one_direction(from, &counts) {
            let longest = from.width().max(from.height()) as i32;
            let period_px = period(residual, longest, at, (across, own + EQUAL * contrast));
            return Some(Self::Aperture { across, period_px });
        }
        let others = peaks(state).into_iter().filter(|other| *other != at);
        let others: Vec<_> = others.filter_map(|other| Some((other, residual(other)?))).collect();
        let best = others.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((other, least)) = best.filter(|(_, least)| *least < BETTER * own && own - least > EQUAL * contrast)
        {
            return Some(Self::Contradicted { other, residuals: [own, least] });
        }
        let is_far = |other: [i32; 2]| (0..2).any(|i| (other[i] - at[i]).abs() > 2);
        let is_high = |other: [i32; 2]| 2.0 * state.height_at(other) > state.height_at(at);
        // Where nothing fits, that another displacement fits as badly tells of no pattern.
        let repeats = others.into_iter().filter(|_| own < FITS * contrast);
        let repeats = { repeats }.find(|(other, residual)| is_far(*other) && is_high(*other) && is_equal(*residual));
        repeats.map(|(other, _)| Self::Repeats { other })
    }
}

/// The displacements of the highest local maxima of the correlation, the highest first.
fn peaks(state: &State) -> Vec<[i32; 2]> {
    let Some(cross) = &state.cross else { return Vec::new() };
    let (width, height) = cross.size();
    let mut peaks: Vec<(f64, (usize, usize))> = Vec::new();
    for place in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let value = cross[place].re;
        let is_low = peaks.len() == PEAKS && value <= peaks[PEAKS - 1].0;
        if value <= 0.0 || is_low {
            continue;
        }
        let [u, v] = state.wrapped(place);
        let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| [u + i, v + j]));
        if around.map(|at| state.height_at(at)).all(|near| near <= value) {
            let rank = peaks.partition_point(|(higher, _)| *higher >= value);
            peaks.insert(rank, (value, place));
            peaks.truncate(PEAKS);
        }
    }
    peaks.into_iter().map(|(_, place)| state.wrapped(place)).collect()
}

/// The pixels that tell of motion: all but those that are the same in both frames and flat, as a border or a caption at rest is.
fn informative([from, to]: [&Gray; 2]) -> Mask {
    let (width, height) = from.size();
    let is_idle = |x: usize, y: usize| {
        let around = |at: usize, extent: usize| at.saturating_sub(1)..(at + 2).min(extent);
        let mut near = around(y, height).flat_map(|v| around(x, width).map(move |u| (u, v)));
        from[(x, y)] == to[(x, y)] && near.all(|place| from[place] == from[(x, y)])
    };
    let idle = Mask::from_fn(width, height, is_idle);
    // The edge of a border at rest is its own, too.
    Mask::from_fn(width, height, |x, y| {
        let around = |at: usize, extent: usize| at.saturating_sub(EDGE_PX)..(at + EDGE_PX + 1).min(extent);
        !around(y, height).any(|v| around(x, width).any(|u| idle.get(u, v)))
    })
}

/// The mean absolute difference in gray levels of frame t and frame t + 1 where the one displaced by `by` covers the other, over the pixels
/// that count in both; `None` where they hardly overlap.
fn residual([from, to]: [&Gray; 2], counts: &Mask, [u, v]: [i32; 2]) -> Option<f64> {
    let (width, height) = (from.width() as i32, from.height() as i32);
    let (columns, rows) = ((-u).max(0)..width - u.max(0), (-v).max(0)..height - v.max(0));
    let (mut sum, mut count) = (0_u64, 0_u64);
    for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
        let [here, there] = [(x as usize, y as usize), ((x + u) as usize, (y + v) as usize)];
        if counts.get(here.0, here.1) && counts.get(there.0, there.1) {
            sum += u64::from(from[here].abs_diff(to[there]));
            count += 1;
        }
    }
    (count as f64 >= LEAST_OVERLAP * counts.count().max(1) as f64).then(|| sum as f64 / count.max(1) as f64)
}

/// The mean absolute deviation of a picture from its mean, in gray levels.
fn contrast(picture: &Gray, mean: f64) -> f64 {
    let sum: f64 = picture.cells().iter().map(|&pixel| (f64::from(pixel) - mean).abs()).sum();
    sum / picture.cells().len().max(1) as f64
}

/// The unit vector along the gradients of a picture if they all have one direction: the eigenvector of the structure tensor.
fn one_direction(picture: &Gray, counts: &Mask) -> Option<[f64; 2]> {
    let (width, height) = picture.size();
    let [mut xx, mut xy, mut yy] = [0.0; 3];
    for y in 1..height.saturating_sub(1) {
        for x in (1..width.saturating_sub(1)).filter(|x| counts.get(*x, y)) {
            let difference = |a: (usize, usize), b: (usize, usize)| f64::from(picture[a]) - f64::from(picture[b]);
            let (dx, dy) = (difference((x + 1, y), (x - 1, y)), difference((x, y + 1), (x, y - 1)));
            (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
        }
    }
    let (half, root) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    (half > 0.0 && half - root < ONE_DIRECTION * (half + root)).then(|| [angle.cos(), angle.sin()])
}

/// The smallest further displacement across the edges, below `longest`, at which the residual is as small as `most` again, after a rise.
fn period(
    residual: impl Fn([i32; 2]) -> Option<f64>,
    longest: i32,
    at: [i32; 2],
    (across, most): ([f64; 2], f64),
) -> Option<i32> {
    let mut has_risen = false;
    (1..longest).find(|&step| {
        let moved = [0, 1].map(|i| at[i] + (across[i] * f64::from(step)).round() as i32);
        let Some(residual) = residual(moved) else { return false };
        has_risen |= residual > 2.0 * most;
        has_risen && residual <= most
    })
}
