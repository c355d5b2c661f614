//! Evidence in the pictures against the highest peak: another displacement that fits better, or equally well.

use super::State;
use crate::data::Mask;
use crate::geometry::Gray;
use crate::synth::random::hash;

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
/// Texture of one direction has a structure tensor with a smaller ratio of eigenvalues, noise included.
const ONE_DIRECTION: f64 = 0.7;
/// A texture with an even smaller ratio has no other gradients.
const PURE: f64 = 0.02;
/// Texture of one direction changes along its edges by less than this share of its change across them.
const ALONG: f64 = 0.5;
/// A displacement along the edges is compared from this length on, and up to that, in px.
const ALONG_PX: [i32; 2] = [4, 24];
/// A displacement lies along the edges if its component across them is smaller, in px.
const ON_EDGE_PX: f64 = 0.1;
/// Displacements along the edges fit equally well if their residuals differ by less than this share.
const ALIKE: f64 = 0.1;
/// A pattern repeats after a displacement if the residual rises between by more than this share of the contrast.
const RISE: f64 = 0.25;
/// Displacements this near to the highest peak are compared with it, at this distance from each other, in px.
const NEAR_PX: [i32; 2] = [16, 2];

/// Maximum number of pixels at which pictures are compared, so that the comparison does not take longer than the correlation.
const MOST_PLACES: usize = 1 << 13;

/// Why the highest peak is not the translation of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Doubt {
    /// Another peak leaves a much smaller residual: the highest one belongs to a part of the picture, such as a border at rest.
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
    /// Whether it refutes that the highest peak is the translation.
    pub(super) fn is_refuting(&self) -> bool {
        !matches!(self, Self::Repeats { .. })
    }

    /// Compares the highest peak with the pictures. Edges of a single direction also count against a rejected peak.
    pub(super) fn of(state: &State) -> Option<Self> {
        let [from, to] = state.fixed.pair.each_ref().map(|frame| frame.luma());
        let at = state.wrapped(state.peak?);
        let informative = Informative::of([from, to]);
        let contrast = contrast(from, &informative);
        let residual = |by: [i32; 2]| informative.residual([from, to], by);
        if let Some(edges) = Edges::of(from, &informative) {
            let own = residual(at);
            let is_free = |along: &[i32; 2]| {
                let other = residual([0, 1].map(|i| at[i] + along[i]));
                own.zip(other).is_none_or(|(own, other)| other <= (1.0 + ALIKE) * own + EQUAL * contrast)
            };
            if edges.is_pure || !state.is_significant() || edges.along.iter().all(is_free) {
                return Some(Self::Aperture { across: edges.across, period_px: edges.period(from, &informative) });
            }
        }
        let own = residual(at).filter(|_| state.is_significant())?;
        let is_equal = |other: f64| other <= own + EQUAL * contrast;
        let others = peaks(state).into_iter().filter(|other| *other != at);
        let others: Vec<_> = others.filter_map(|other| Some((other, residual(other)?))).collect();
        // A smooth texture has no peak of its own where few of its frequencies are kept.
        let [reach, step] = NEAR_PX;
        let grid = |reach: i32, step: i32| {
            let along = move || (-reach..=reach).step_by(step as usize);
            along().flat_map(move |v| along().map(move |u| [at[0] + u, at[1] + v]))
        };
        let around = grid(reach, step).chain(grid(step, 1));
        let around = around.filter_map(|other| Some((other, residual(other)?)));
        let best = others.iter().copied().chain(around).min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((other, least)) = best.filter(|(_, least)| *least < BETTER * own && own - least > EQUAL * contrast)
        {
            return Some(Self::Contradicted { other, residuals: [own, least] });
        }
        let is_far = |other: [i32; 2]| (0..2).any(|i| (other[i] - at[i]).abs() > 2);
        let is_high = |other: [i32; 2]| 2.0 * state.height_at(other) > state.height_at(at);
        // A smooth texture fits nearly as well near its match, and never worse in between.
        let on_the_way = |other: [i32; 2], part: f64| {
            residual([0, 1].map(|i| at[i] + (part * f64::from(other[i] - at[i])).round() as i32))
        };
        let rises = |other| {
            [0.25, 0.5, 0.75]
                .into_iter()
                .filter_map(|part| on_the_way(other, part))
                .any(|way| way > own + RISE * contrast)
        };
        let goes_on = |other| [-1.0, 2.0].into_iter().filter_map(|part| on_the_way(other, part)).all(is_equal);
        // If nothing fits, another displacement that fits as badly is no evidence of a repeating pattern.
        let repeats = others.into_iter().filter(|_| own < FITS * contrast);
        let mut repeats = repeats.filter(|(other, residual)| is_far(*other) && is_high(*other) && is_equal(*residual));
        repeats.find(|(other, _)| rises(*other) && goes_on(*other)).map(|(other, _)| Self::Repeats { other })
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

/// The pixels informative about motion: all except flat ones that are equal in both frames, such as a border or caption at rest.
fn informative_mask([from, to]: [&Gray; 2]) -> Mask {
    let (width, height) = from.size();
    let is_idle = |x: usize, y: usize| {
        let around = |at: usize, extent: usize| at.saturating_sub(1)..(at + 2).min(extent);
        let mut near = around(y, height).flat_map(|v| around(x, width).map(move |u| (u, v)));
        from[(x, y)] == to[(x, y)] && near.all(|place| from[place] == from[(x, y)])
    };
    let idle = Mask::from_fn(width, height, is_idle);
    // The edge of a border at rest belongs to the border.
    Mask::from_fn(width, height, |x, y| {
        let around = |at: usize, extent: usize| at.saturating_sub(EDGE_PX)..(at + EDGE_PX + 1).min(extent);
        !around(y, height).any(|v| around(x, width).any(|u| idle.get(u, v)))
    })
}

/// The informative pixels of frame t, and those among them at which pictures are compared.
struct Informative {
    mask: Mask,
    places: Vec<(usize, usize)>,
}

impl Informative {
    /// Samples one pixel at random in each square of a grid, so that no pattern is met at its own period.
    fn of(pair: [&Gray; 2]) -> Self {
        let mask = informative_mask(pair);
        let (width, height) = pair[0].size();
        let side = ((width * height).div_ceil(MOST_PLACES) as f64).sqrt().ceil() as usize;
        let cells = (0..height).step_by(side).flat_map(|y| (0..width).step_by(side).map(move |x| (x, y)));
        let sampled = cells.map(|(x, y)| {
            let random = hash(0, x as u64, y as u64) as usize;
            (x + random % side, y + random / side % side)
        });
        let places = sampled.filter(|&(x, y)| x < width && y < height && mask.get(x, y)).collect();
        Self { mask, places }
    }

    /// The mean absolute difference in gray levels of two pictures where the one displaced by `by` covers the other,
    /// over the places that are informative in both; `None` where they hardly overlap.
    fn residual(&self, [from, to]: [&Gray; 2], [u, v]: [i32; 2]) -> Option<f64> {
        let (mut sum, mut count) = (0_u64, 0_usize);
        for &here in &self.places {
            let there = (here.0.wrapping_add_signed(u as isize), here.1.wrapping_add_signed(v as isize));
            if there.0 < to.width() && there.1 < to.height() && self.mask.get(there.0, there.1) {
                sum += u64::from(from[here].abs_diff(to[there]));
                count += 1;
            }
        }
        (count as f64 >= LEAST_OVERLAP * self.places.len().max(1) as f64).then(|| sum as f64 / count.max(1) as f64)
    }
}

/// The mean absolute deviation of the informative pixels from their mean, in gray levels.
fn contrast(picture: &Gray, Informative { places, .. }: &Informative) -> f64 {
    let count = places.len().max(1) as f64;
    let mean = places.iter().map(|place| f64::from(picture[*place])).sum::<f64>() / count;
    places.iter().map(|place| (f64::from(picture[*place]) - mean).abs()).sum::<f64>() / count
}

/// The edges of a texture that all have one direction.
struct Edges {
    /// The unit vector across them.
    across: [f64; 2],
    /// Whether there is hardly a gradient in another direction, not even of noise.
    is_pure: bool,
    /// Displacements along them, in px.
    along: Vec<[i32; 2]>,
    /// The mean absolute difference of the picture from itself in gray levels: displaced along them, and at most when displaced across them.
    changes: [f64; 2],
}

impl Edges {
    /// Returns the edges of a picture if they have one direction: displaced along them, the picture differs from itself by its noise alone.
    fn of(picture: &Gray, informative: &Informative) -> Option<Self> {
        let ([x, y], ratio) = main_gradient(picture, &informative.mask)?;
        let change = |by: [i32; 2]| informative.residual([picture, picture], by);
        let far = (picture.width().min(picture.height()) as i32 / 3).min(ALONG_PX[1]);
        let along = (ALONG_PX[0]..=far).map(|length| [-y, x].map(|c| (c * f64::from(length)).round() as i32));
        let mut along: Vec<_> =
            along.filter(|[u, v]| (f64::from(*u) * x + f64::from(*v) * y).abs() < ON_EDGE_PX).collect();
        along.dedup();
        let changes: Vec<f64> = along.iter().filter_map(|by| change(*by)).collect();
        let (first, most) = (*changes.first()?, changes.iter().copied().fold(0.0, f64::max));
        let steps = 1..=far;
        let across = steps.filter_map(|step| change([x, y].map(|c| (c * f64::from(step)).round() as i32)));
        let most_across = across.fold(0.0, f64::max);
        let is_one = most < ALONG * most_across && most <= (1.0 + ALIKE) * first + EQUAL * most_across;
        let is_pure = ratio < PURE;
        (is_pure || is_one).then_some(Self { across: [x, y], is_pure, along, changes: [most, most_across] })
    }

    /// The period of the picture across the edges in px, if it repeats: after it, and after twice as much, the picture differs from itself by
    /// little more than its noise, and by much between.
    fn period(&self, picture: &Gray, informative: &Informative) -> Option<i32> {
        let change = |step: i32| {
            let by = self.across.map(|c| (c * f64::from(step)).round() as i32);
            informative.residual([picture, picture], by).unwrap_or(f64::INFINITY)
        };
        let [noise, most] = self.changes;
        let is_low = |step: i32| change(step) < noise + RISE * (most - noise);
        let mut has_risen = false;
        let longest = picture.width().max(picture.height()) as i32 / 2;
        let period = (1..longest).find(|&step| {
            let now = change(step);
            has_risen |= now > 0.5 * (noise + most);
            has_risen && is_low(step) && now <= change(step + 1)
        })?;
        (2 * period >= longest || (-1..=1).any(|off| is_low(2 * period + off))).then_some(period)
    }
}

/// The unit vector along most gradients of a picture, the eigenvector of its structure tensor, and the ratio of the eigenvalues, if the
/// gradients prefer a direction.
fn main_gradient(picture: &Gray, counts: &Mask) -> Option<([f64; 2], f64)> {
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
    let ratio = (half - root) / (half + root);
    (half > 0.0 && ratio < ONE_DIRECTION).then(|| ([angle.cos(), angle.sin()], ratio))
}
