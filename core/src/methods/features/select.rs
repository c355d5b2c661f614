//! Selection of features from a response map: threshold, non-maximum suppression, minimum distance.

use super::declare::case;
use crate::geometry::Grid;
use crate::methods::differential::{Scheme, Weights};
use crate::params;
use crate::products::PointField;
use crate::scene::Case;

params! {
    /// Limits that all detectors of points share.
    #[derive(Copy)]
    pub struct Selection {
        /// Smallest distance between two corners; the stronger one is kept. 0 allows any distance.
        min_distance: usize = 7, 0..=100, "px";
        /// Largest number of corners; the strongest are kept.
        max_points: usize = 500, 1..=100_000;
    }
}

impl Selection {
    /// Advice on keeping more points, at the end of a run that kept `kept` of `candidates`.
    pub fn advice(&self, kept: usize, candidates: usize) -> &'static Case {
        match kept < candidates {
            false => case::ALL_KEPT,
            true if kept >= self.max_points => case::AT_MOST,
            true => case::APART,
        }
    }
}

params! {
    /// Parameters that the corner detectors with a structure tensor share.
    #[derive(Copy)]
    pub struct Settings {
        /// Side of the window of the structure tensor; an even side is rounded up.
        window: usize = 5, 3..=31, "px";
        /// Weights w of the pixels in the window.
        weights: Weights = Weights::Gaussian;
        /// Kernel that estimates the derivatives I_x and I_y.
        derivatives: Scheme = Scheme::Sobel;
        /// Smallest response of a corner, relative to the largest response in the frame (quality level). Lower values find more and weaker corners.
        threshold: f32 = 0.01, 0.0..=1.0;
        /// Limits of distance and number.
        selection: Selection = Selection::default();
    }
    advanced { "weights", "derivatives" }
}

/// A response map with its threshold.
#[derive(Clone, Copy)]
pub struct Peaks<'a> {
    /// The responses.
    pub map: &'a Grid<f32>,
    /// The threshold.
    pub limit: f32,
}

impl Peaks<'_> {
    /// Whether `(x, y)` reaches the threshold. Border pixels lack neighbours and never do.
    #[inline(always)]
    pub fn is_over(&self, x: usize, y: usize) -> bool {
        let (width, height) = self.map.size();
        let is_inside = x > 0 && y > 0 && x + 1 < width && y + 1 < height;
        is_inside && self.reaches(self.map[(x, y)])
    }

    #[inline(always)]
    fn reaches(&self, response: f32) -> bool {
        (response > 0.0) & (response >= self.limit)
    }

    /// Returns the pixels of row `y` that reach the threshold.
    pub fn over(&self, y: usize) -> impl Iterator<Item = usize> {
        let (width, height) = self.map.size();
        let inner = if y > 0 && y + 1 < height && width > 2 { &self.map.row(y)[1..width - 1] } else { &[] };
        inner.iter().enumerate().filter(|(_, response)| self.reaches(**response)).map(|(i, _)| i + 1)
    }

    /// Calls `tell` with each local maximum of row `y`: pixels that reach the threshold and have no larger neighbour, nor an equal
    /// one earlier in raster order.
    #[inline(always)]
    pub fn peaks(&self, y: usize, mut tell: impl FnMut(usize)) {
        const LANES: usize = 16;
        let (width, height) = self.map.size();
        if y == 0 || y + 1 >= height || width < 3 {
            return;
        }
        let rows = [y - 1, y, y + 1].map(|y| self.map.row(y));
        let mut start = 1;
        while start + LANES < width {
            // Whole chunks become vector instructions.
            let lanes = |row: usize, x: usize| &rows[row][x..x + LANES];
            let [above, here, below] = [0, 1, 2].map(|row| [start - 1, start, start + 1].map(|x| lanes(row, x)));
            let mut is_peak = [false; LANES];
            for i in 0..LANES {
                let response = here[1][i];
                let beats_earlier = above.iter().fold(response > here[0][i], |all, row| all & (response > row[i]));
                let beats_all = below.iter().fold(response >= here[2][i], |all, row| all & (response >= row[i]));
                is_peak[i] = self.reaches(response) & beats_earlier & beats_all;
            }
            if is_peak != [false; LANES] {
                is_peak.iter().enumerate().filter(|(_, is_peak)| **is_peak).for_each(|(i, _)| tell(start + i));
            }
            start += LANES;
        }
        (start..width - 1).filter(|&x| self.reaches(rows[1][x]) && self.is_peak((x, y))).for_each(tell);
    }

    /// Whether `(x, y)` is a local maximum of its 3×3 neighbourhood; of equal neighbours the first in raster order is.
    #[inline(always)]
    pub fn is_peak(&self, (x, y): (usize, usize)) -> bool {
        let [above, here, below] = [y - 1, y, y + 1].map(|y| &self.map.row(y)[x - 1..x + 2]);
        let response = here[1];
        let beats_earlier = response > here[0] && above.iter().all(|other| response > *other);
        beats_earlier && response >= here[2] && below.iter().all(|other| response >= *other)
    }

    /// Returns the largest neighbour that suppresses `(x, y)`, if it is no local maximum.
    pub fn suppressed_by(&self, (x, y): (usize, usize)) -> Option<(usize, usize)> {
        let here = self.map[(x, y)];
        let around = (y - 1..=y + 1).flat_map(|j| (x - 1..=x + 1).map(move |i| (i, j)));
        let wins = |place: &(usize, usize)| {
            let is_earlier = (place.1, place.0) < (y, x);
            let there = self.map[*place];
            there > here || (is_earlier && there == here)
        };
        around.filter(wins).reduce(|best, place| if self.map[place] > self.map[best] { place } else { best })
    }
}

/// Local maxima in order of decreasing response, equal ones in raster order.
pub fn rank(map: &Grid<f32>, peaks: &[u32]) -> Vec<u32> {
    let mut ranked: Vec<(f32, u32)> = peaks.iter().map(|&peak| (map.cells()[peak as usize], peak)).collect();
    ranked.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    ranked.into_iter().map(|(_, peak)| peak).collect()
}

/// Selects from `ranked` places of a picture of this size, the strongest first, and calls `see` with each that is tested and the
/// chosen place within the minimum distance that rejects it, if there is one.
pub fn choose(
    ranked: &[u32],
    size: (usize, usize),
    Selection { min_distance, max_points }: Selection,
    mut see: impl FnMut(u32, Option<u32>),
) -> Vec<u32> {
    // Local maxima are at least 2 px apart anyway.
    let mut chosen = (min_distance > 1).then(|| Chosen::new(size, min_distance));
    let mut kept = Vec::new();
    for &place in ranked {
        if kept.len() == max_points {
            break;
        }
        let near = chosen.as_mut().and_then(|chosen| chosen.take(place));
        see(place, near);
        if near.is_none() {
            kept.push(place);
        }
    }
    kept
}

/// The chosen points in a grid of buckets, for fast distance tests.
pub struct Chosen {
    min_distance: usize,
    width: usize,
    /// The chosen points in buckets as wide as the minimum distance.
    squares: Grid<Vec<u32>>,
}

impl Chosen {
    /// Returns no points, for an image of this size.
    pub fn new((width, height): (usize, usize), min_distance: usize) -> Self {
        let side = min_distance.max(1);
        let squares = Grid::new(width.div_ceil(side), height.div_ceil(side), Vec::new());
        Self { min_distance, width, squares }
    }

    /// Adds a point regardless of its distance to others.
    pub fn hold(&mut self, place: u32) {
        let (side, place_of) = (self.min_distance.max(1), place as usize);
        self.squares[(place_of % self.width / side, place_of / self.width / side)].push(place);
    }

    /// Adds `peak`, or returns a chosen point within the minimum distance.
    pub fn take(&mut self, peak: u32) -> Option<u32> {
        // Even without a minimum distance each position is taken once.
        let side = self.min_distance.max(1);
        let place = |peak: u32| (peak as usize % self.width, peak as usize / self.width);
        let (x, y) = place(peak);
        let (column, row) = (x / side, y / side);
        let (columns, rows) = self.squares.size();
        let near = |other: &u32| {
            let (a, b) = place(*other);
            a.abs_diff(x).pow(2) + b.abs_diff(y).pow(2) < side.pow(2)
        };
        let around = (row.saturating_sub(1)..(row + 2).min(rows))
            .flat_map(|j| (column.saturating_sub(1)..(column + 2).min(columns)).map(move |i| (i, j)));
        let found = around.flat_map(|square| &self.squares[square]).copied().find(near);
        if found.is_none() {
            self.squares[(column, row)].push(peak);
        }
        found
    }
}

/// The first `most` of `points` with a minimum distance, in px, from each other and from the positions `taken`.
pub fn spread(
    points: &PointField,
    taken: impl Iterator<Item = [f32; 2]>,
    (min_distance, most): (usize, usize),
) -> Vec<[f32; 2]> {
    let (width, height) = points.picture;
    let last = [width, height].map(|side| side.saturating_sub(1) as f32);
    let nearest = |at: [f32; 2]| {
        let [x, y] = [0, 1].map(|i| at[i].clamp(0.0, last[i]).round() as usize);
        (y * width + x) as u32
    };
    let mut chosen = Chosen::new(points.picture, min_distance);
    taken.for_each(|at| chosen.hold(nearest(at)));
    let places = points.points.iter().map(|point| point.at);
    places.filter(|at| chosen.take(nearest(*at)).is_none()).take(most).collect()
}

/// The largest of `values`; 0 if there is none.
pub fn largest(values: &[f32]) -> f32 {
    const LANES: usize = 8;
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut most = [0.0f32; LANES];
    for chunk in chunks {
        for (most, value) in most.iter_mut().zip(chunk) {
            *most = if *value > *most { *value } else { *most };
        }
    }
    most.iter().chain(rest).fold(0.0, |most, value| if *value > most { *value } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_limit_that_was_reached_is_to_be_raised() {
        let advice = |kept, candidates| Selection { min_distance: 0, max_points: 5 }.advice(kept, candidates).text;
        assert!(advice(5, 9).contains("maximum number") && !advice(5, 9).contains("distance"));
        assert!(advice(5, 5).contains("All local maxima") && advice(3, 9).contains("minimum distance"));
    }

    #[test]
    fn a_plateau_has_one_peak() {
        let map = Grid::from_fn(7, 6, |x, y| if (2..4).contains(&x) && (2..4).contains(&y) { 5.0 } else { 1.0 });
        let peaks = Peaks { map: &map, limit: 2.0 };
        let found: Vec<_> =
            (0..6).flat_map(|y| peaks.over(y).map(move |x| (x, y))).filter(|place| peaks.is_peak(*place)).collect();
        assert_eq!(found, [(2, 2)]);
        assert_eq!(peaks.suppressed_by((3, 2)), Some((2, 2)));
        assert_eq!((0..6).flat_map(|y| Peaks { limit: 1.0, ..peaks }.over(y).collect::<Vec<_>>()).count(), 5 * 4);
        let noise = Grid::from_fn(30, 20, |x, y| ((x * 37 + y * 101 + x * y * 13) % 11) as f32);
        let peaks = Peaks { map: &noise, limit: 0.0 };
        for place in (1..19).flat_map(|y| (1..29).map(move |x| (x, y))) {
            assert_eq!(peaks.is_peak(place), peaks.suppressed_by(place).is_none(), "{place:?}");
        }
        for width in [1, 2, 3, 17, 18, 19, 40] {
            let noise = Grid::from_fn(width, 9, |x, y| ((x * 37 + y * 101 + x * y * 13) % 23) as f32 - 4.0);
            let peaks = Peaks { map: &noise, limit: 3.0 };
            for y in 0..9 {
                let mut found = Vec::new();
                peaks.peaks(y, |x| found.push(x));
                assert_eq!(found, peaks.over(y).filter(|&x| peaks.is_peak((x, y))).collect::<Vec<_>>(), "{width}, {y}");
            }
        }
    }

    #[test]
    fn the_chosen_keep_their_distance_and_the_order_is_by_strength() {
        let map = Grid::from_fn(40, 30, |x, y| ((x * 37 + y * 101 + x * y * 13) % 251) as f32);
        let all: Vec<u32> = (0..40 * 30).collect();
        let ranked = rank(&map, &all);
        assert!(ranked.windows(2).all(|pair| {
            let [a, b] = [0, 1].map(|i| map.cells()[pair[i] as usize]);
            a > b || (a == b && pair[0] < pair[1])
        }));
        for least in [0, 1, 5, 9] {
            let mut chosen = Chosen::new((40, 30), least);
            let kept: Vec<u32> = ranked.iter().copied().filter(|peak| chosen.take(*peak).is_none()).collect();
            let far = |a: u32, b: u32| {
                let [(ax, ay), (bx, by)] = [a, b].map(|p| (p % 40, p / 40));
                ax.abs_diff(bx).pow(2) + ay.abs_diff(by).pow(2) >= (least * least) as u32
            };
            let is_free = |peak: u32| kept.iter().all(|other| *other == peak || far(*other, peak));
            assert!(kept.iter().all(|peak| is_free(*peak)), "{least}");
            assert!(
                all.iter().all(|peak| kept.contains(peak) || !is_free(*peak)),
                "{least}: there is room for one more"
            );
        }
    }

    #[test]
    fn the_largest_is_found_anywhere() {
        for i in 0..21 {
            let values: Vec<f32> = (0..21).map(|k| if k == i { 7.0 } else { -1.0 }).collect();
            assert_eq!(largest(&values), 7.0);
        }
        assert_eq!((largest(&[]), largest(&[-3.0; 9])), (0.0, 0.0));
    }
}
