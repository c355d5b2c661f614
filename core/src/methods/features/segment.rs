//! The segment test of FAST: contiguous pixels of a circle that are all brighter or all darker than its centre.

#[cfg(target_arch = "x86_64")]
mod x86;

use std::ops::Range;

use crate::base::Observer;
use crate::geometry::{Gray, Grid};

/// The radius of the circle in px: pixels closer to the border have no circle.
pub const RADIUS: usize = 3;

/// The 16 pixels of the circle relative to its centre, clockwise from the top. Pixels 1, 5, 9 and 13 are its compass points.
///
/// ```text
///       16  1  2
///    15           3
/// 14                 4
/// 13        p        5
/// 12                 6
///    11           7
///       10  9  8
/// ```
pub const CIRCLE: [[isize; 2]; 16] = [
    [0, -3],
    [1, -3],
    [2, -2],
    [3, -1],
    [3, 0],
    [3, 1],
    [2, 2],
    [1, 3],
    [0, 3],
    [-1, 3],
    [-2, 2],
    [-3, 1],
    [-3, 0],
    [-3, -1],
    [-2, -2],
    [-1, -3],
];

/// The indices of the compass points in [`CIRCLE`].
pub const COMPASS: [usize; 4] = [0, 4, 8, 12];

/// Pixels that are tested at once: as many as the widest register of AVX2 has bytes.
const LANES: usize = 32;

/// A gray level for each pixel that is tested at once.
type Lanes = [u8; LANES];

/// Threshold and length of the arc.
#[derive(Clone, Copy, Debug)]
pub struct SegmentTest {
    /// The threshold t in gray levels, 1 to 254.
    pub threshold: u8,
    /// The length n of the arc in pixels, 9 to 12.
    pub arc: usize,
}

/// A pixel that passes the high-speed test, and its score V: 0 if it is no corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Candidate {
    /// Its column.
    pub x: usize,
    /// The largest threshold for which it is a corner.
    pub score: u8,
}

impl SegmentTest {
    /// The number of adjacent compass points that any arc contains: 2 of an arc of 9 to 11 pixels, 3 of one of 12.
    pub fn compass_points(self) -> usize {
        self.arc / 4
    }

    /// The highest score of all pixels of a picture, whatever the threshold: the largest threshold with a corner, 0 without one.
    pub fn highest_score(self, picture: &Gray) -> u8 {
        let (test, mut scores) = (Self { threshold: 0, ..self }, vec![0; picture.width()]);
        let of_row = |y| {
            test.row(picture, y, &mut scores, &mut ());
            scores.iter().copied().max().unwrap_or(0)
        };
        (0..picture.height()).map(of_row).max().unwrap_or(0)
    }

    /// Computes the scores of a row, 0 where there is no corner, with the widest registers available; all give the same result.
    /// `observer` sees the candidates.
    pub fn row(self, picture: &Gray, y: usize, scores: &mut [u8], observer: &mut impl Observer<Candidate>) {
        match self.arc {
            12 => self.row_with::<12, 3>(picture, y, scores, observer),
            11 => self.row_with::<11, 2>(picture, y, scores, observer),
            10 => self.row_with::<10, 2>(picture, y, scores, observer),
            _ => self.row_with::<9, 2>(picture, y, scores, observer),
        }
    }

    fn row_with<const ARC: usize, const COMPASS_POINTS: usize>(
        self,
        picture: &Gray,
        y: usize,
        scores: &mut [u8],
        observer: &mut impl Observer<Candidate>,
    ) {
        let threshold = self.threshold;
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            #[target_feature(enable = "avx2")]
            fn row<const ARC: usize, const COMPASS_POINTS: usize>(
                segment: SegmentTest,
                (picture, y): (&Gray, usize),
                scores: &mut [u8],
                observer: &mut impl Observer<Candidate>,
            ) {
                let test = |rows: &Rows, x| x86::test::<ARC, COMPASS_POINTS>(rows, x, segment.threshold);
                each_chunk((picture, y), scores, observer, test);
            }
            // SAFETY: the processor has AVX2.
            return unsafe { row::<ARC, COMPASS_POINTS>(self, (picture, y), scores, observer) };
        }
        each_chunk((picture, y), scores, observer, |rows, x| {
            Chunk { rows, x, threshold }.test::<ARC, COMPASS_POINTS>()
        });
    }
}

/// A row with three more above and below.
type Rows<'a> = [&'a [u8]; 2 * RADIUS + 1];

/// The result for the pixels that are tested at once.
struct Tested {
    /// A bit for each pixel that passes the high-speed test.
    passes: u32,
    /// The scores.
    scores: Lanes,
}

/// Goes through the pixels of row `y` with a circle; `test` gives nothing where none passes the high-speed test.
#[inline(always)]
fn each_chunk<O: Observer<Candidate>>(
    (picture, y): (&Gray, usize),
    scores: &mut [u8],
    observer: &mut O,
    test: impl Fn(&Rows, usize) -> Option<Tested>,
) {
    let (width, height) = picture.size();
    scores.fill(0);
    if y < RADIUS || y + RADIUS >= height || width <= 2 * RADIUS {
        return;
    }
    let mut rows: Rows = std::array::from_fn(|k| picture.row(y + k - RADIUS));
    // Narrow rows are padded with zeros.
    let mut padded = [[0; LANES + 2 * RADIUS]; 2 * RADIUS + 1];
    if width < LANES + 2 * RADIUS {
        padded.iter_mut().zip(rows).for_each(|(padded, row)| padded[..width].copy_from_slice(row));
        rows = padded.each_ref().map(|row| &row[..]);
    }
    let end = width - RADIUS;
    let mut x = RADIUS;
    while x < end {
        // The last pixels are tested with some before them once more.
        let start = x.min(end.saturating_sub(LANES).max(RADIUS));
        let count = (end - start).min(LANES);
        if let Some(Tested { passes, scores: found }) = test(&rows, start) {
            scores[start..start + count].copy_from_slice(&found[..count]);
            if O::WATCHES {
                for i in (x - start..count).filter(|i| passes >> i & 1 == 1) {
                    observer.see(|| Candidate { x: start + i, score: found[i] });
                }
            }
        }
        x = start + count;
    }
}

/// Neighbouring pixels of a row that are tested at once.
struct Chunk<'a> {
    rows: &'a Rows<'a>,
    /// The first of them.
    x: usize,
    threshold: u8,
}

impl Chunk<'_> {
    /// The pixels at an offset from those tested.
    #[inline(always)]
    fn at(&self, [i, j]: [isize; 2]) -> Lanes {
        let start = (self.x as isize + i) as usize;
        lanes(self.rows[(j + RADIUS as isize) as usize], start)
    }

    #[inline(always)]
    fn test<const ARC: usize, const COMPASS_POINTS: usize>(&self) -> Option<Tested> {
        let passes = self.passes::<COMPASS_POINTS>();
        (passes != 0).then(|| Tested { passes, scores: self.scores::<ARC>() })
    }

    /// The high-speed test: a bit for each pixel where enough adjacent compass points are all brighter or all darker.
    #[inline(always)]
    fn passes<const COMPASS_POINTS: usize>(&self) -> u32 {
        let center = self.at([0, 0]);
        let threshold = [self.threshold; LANES];
        let high = each(&center, &threshold, u8::saturating_add);
        let low = each(&center, &threshold, u8::saturating_sub);
        let compass = COMPASS.map(|k| self.at(CIRCLE[k]));
        let brighter = compass.map(|pixels| each(&pixels, &high, |pixel, high| u8::from(pixel > high)));
        let darker = compass.map(|pixels| each(&pixels, &low, |pixel, low| u8::from(pixel < low)));
        let [brighter, darker] = [brighter, darker].map(|compass| is_run::<COMPASS_POINTS>(&compass));
        bits(&each(&brighter, &darker, |a, b| a | b))
    }

    /// The scores: for each arc the smallest difference that all of its pixels reach, for each pixel the largest of any arc, less
    /// 1, since a difference has to exceed the threshold.
    #[inline(always)]
    fn scores<const ARC: usize>(&self) -> Lanes {
        let center = self.at([0, 0]);
        let circle = CIRCLE.map(|offset| self.at(offset));
        let brighter = circle.map(|pixels| each(&pixels, &center, u8::saturating_sub));
        let darker = circle.map(|pixels| each(&center, &pixels, u8::saturating_sub));
        let [brighter, darker] = [brighter, darker].map(|differences| of_best_arc::<ARC>(&differences));
        let most = each(&brighter, &darker, u8::max);
        most.map(|most| if most > self.threshold { most - 1 } else { 0 })
    }
}

#[inline(always)]
fn lanes(row: &[u8], start: usize) -> Lanes {
    let mut lanes = [0; LANES];
    lanes.copy_from_slice(&row[start..start + LANES]);
    lanes
}

#[inline(always)]
fn each(a: &Lanes, b: &Lanes, f: impl Fn(u8, u8) -> u8) -> Lanes {
    let mut lanes = [0; LANES];
    for i in 0..LANES {
        lanes[i] = f(a[i], b[i]);
    }
    lanes
}

/// A bit for each lane that is not 0.
#[inline(always)]
fn bits(lanes: &Lanes) -> u32 {
    lanes.iter().enumerate().fold(0, |bits, (i, lane)| bits | u32::from(*lane != 0) << i)
}

/// 1 where this many adjacent ones of the four compass points hold.
#[inline(always)]
fn is_run<const COMPASS_POINTS: usize>([a, b, c, d]: &[Lanes; 4]) -> Lanes {
    let mut is_run = [0; LANES];
    for i in 0..LANES {
        is_run[i] = match COMPASS_POINTS {
            3 => (a[i] & c[i] & (b[i] | d[i])) | (b[i] & d[i] & (a[i] | c[i])),
            // Two adjacent ones: one of each pair of opposite ones.
            _ => (a[i] | c[i]) & (b[i] | d[i]),
        };
    }
    is_run
}

/// The largest, over all arcs, of the smallest of the differences in an arc. Two arcs that begin beside each other share all pixels
/// but their ends.
#[inline(always)]
fn of_best_arc<const ARC: usize>(differences: &[Lanes; 16]) -> Lanes {
    let both = |a: &Lanes, b: &Lanes| each(a, b, u8::min);
    let at = |k: usize| &differences[k % 16];
    // The smallest of 2, 4 and 8 in a row each come from two of half as many; index k begins at pixel 2k + 1.
    let two: [Lanes; 8] = std::array::from_fn(|k| both(at(2 * k + 1), at(2 * k + 2)));
    let four: [Lanes; 8] = std::array::from_fn(|k| both(&two[k], &two[(k + 1) % 8]));
    let mut best = [0; LANES];
    for k in 0..8 {
        let eight = both(&four[k], &four[(k + 2) % 8]);
        let shared = match ARC {
            9 => eight,
            10 => both(&eight, at(2 * k + 9)),
            11 => both(&eight, &two[(k + 4) % 8]),
            _ => both(&eight, &both(&two[(k + 4) % 8], at(2 * k + 11))),
        };
        let ends = each(at(2 * k), at(2 * k + ARC), u8::max);
        best = each(&best, &both(&shared, &ends), u8::max);
    }
    best
}

/// Calls `tell` with each pixel of row `y` whose score exceeds those of its eight neighbours. Of equal neighbours none is kept, as
/// in OpenCV.
pub fn maxima(scores: &Grid<u8>, y: usize, mut tell: impl FnMut(usize)) {
    let (width, height) = scores.size();
    if y < RADIUS || y + RADIUS >= height || width <= 2 * RADIUS {
        return;
    }
    let rows = [y - 1, y, y + 1].map(|y| scores.row(y));
    let end = width - RADIUS;
    let rest = wide_maxima(rows, RADIUS..end, &mut tell);
    rest.filter(|&x| rows[1][x] > 0 && is_maximum(rows, x)).for_each(tell);
}

/// Calls `tell` with the maxima of `columns`, as far as wide registers reach, and returns the remaining columns.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn wide_maxima(rows: [&[u8]; 3], mut columns: Range<usize>, tell: &mut impl FnMut(usize)) -> Range<usize> {
    if is_x86_feature_detected!("avx2") {
        while columns.start + LANES < columns.end {
            // SAFETY: the processor has AVX2.
            let mut maxima = unsafe { x86::maxima(rows, columns.start) };
            while maxima != 0 {
                tell(columns.start + maxima.trailing_zeros() as usize);
                maxima &= maxima - 1;
            }
            columns.start += LANES;
        }
    }
    columns
}

/// Without wide registers all columns are left.
#[cfg(not(target_arch = "x86_64"))]
fn wide_maxima(_: [&[u8]; 3], columns: Range<usize>, _: &mut impl FnMut(usize)) -> Range<usize> {
    columns
}

/// Whether the middle of three rows exceeds all its neighbours at column `x`.
fn is_maximum(rows: [&[u8]; 3], x: usize) -> bool {
    let here = rows[1][x];
    let [above, beside, below] = rows.map(|row| &row[x - 1..=x + 1]);
    beside[0] < here && beside[2] < here && above.iter().chain(below).all(|other| *other < here)
}

/// Returns the neighbour of the largest score, the first of equal ones, if that score is not below the score at a corner: it
/// suppresses the corner.
///
/// # Panics
/// If the corner lies at the border.
pub fn suppressed_by(scores: &Grid<u8>, (x, y): (usize, usize)) -> Option<(usize, usize)> {
    let around = (y - 1..=y + 1).flat_map(|j| (x - 1..=x + 1).map(move |i| (i, j))).filter(|place| *place != (x, y));
    let largest = around.reduce(|best, place| if scores[place] > scores[best] { place } else { best })?;
    (scores[largest] >= scores[(x, y)]).then_some(largest)
}

/// A circle pixel compared with its centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shade {
    /// Above I_p + t.
    Brighter,
    /// Below I_p − t.
    Darker,
    /// Neither.
    Similar,
}

/// The circle of a pixel as it is explained.
#[derive(Clone, Debug)]
pub struct Circle {
    /// The pixel.
    pub center: (usize, usize),
    /// Its gray level I_p.
    pub level: u8,
    /// The differences I_k − I_p.
    pub differences: [i16; 16],
    /// The shades of the pixels compared with the threshold.
    pub shades: [Shade; 16],
    /// The longest run of brighter or of darker pixels, if there is any: its first index and its length.
    pub run: Option<(usize, usize)>,
    /// The largest number of adjacent compass points that are all brighter or all darker.
    pub compass: usize,
    /// The arc that decides the score: the index of its first pixel, if the pixel is a corner.
    pub arc: Option<usize>,
    /// The score; 0 if the pixel is no corner.
    pub score: u8,
}

impl Circle {
    /// The circle of a pixel; `None` where a part of it lies outside the picture.
    pub fn of(picture: &Gray, (x, y): (usize, usize), test: SegmentTest) -> Option<Self> {
        let level = *picture.get(x, y)?;
        let mut differences = [0; 16];
        for (difference, [i, j]) in differences.iter_mut().zip(CIRCLE) {
            let pixel = picture.get(x.checked_add_signed(i)?, y.checked_add_signed(j)?)?;
            *difference = i16::from(*pixel) - i16::from(level);
        }
        let limit = i16::from(test.threshold);
        let shades = differences.map(|difference| match difference {
            _ if difference > limit => Shade::Brighter,
            _ if difference < -limit => Shade::Darker,
            _ => Shade::Similar,
        });
        let (arc, least) = best_arc(&differences, test.arc);
        let is_corner = least > limit;
        Some(Self {
            center: (x, y),
            level,
            differences,
            shades,
            run: longest_run(&shades),
            compass: longest_run(&COMPASS.map(|k| shades[k])).map_or(0, |(_, length)| length),
            arc: is_corner.then_some(arc),
            score: if is_corner { (least - 1) as u8 } else { 0 },
        })
    }

    /// The number of pixels of a shade.
    pub fn count(&self, shade: Shade) -> usize {
        self.shades.iter().filter(|other| **other == shade).count()
    }
}

/// The first index of the arc whose smallest difference is largest, and that difference.
fn best_arc(differences: &[i16; 16], arc: usize) -> (usize, i16) {
    let least = |start: usize, sign: i16| (0..arc).map(|k| sign * differences[(start + k) % 16]).min().unwrap_or(0);
    let all = (0..16).map(|start| (start, least(start, 1).max(least(start, -1))));
    all.reduce(|best, other| if other.1 > best.1 { other } else { best }).unwrap_or((0, 0))
}

/// First index and length of the longest run of one shade that is not similar, on a circle.
fn longest_run(shades: &[Shade]) -> Option<(usize, usize)> {
    let count = shades.len();
    let length = |start: usize| (0..count).take_while(|k| shades[(start + k) % count] == shades[start]).count();
    let runs = (0..count).filter(|&start| shades[start] != Shade::Similar).map(|start| (start, length(start)));
    runs.reduce(|best, other| if other.1 > best.1 { other } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(width: usize, height: usize) -> Gray {
        Grid::from_fn(width, height, |x, y| {
            let hash = (x as u64 / 2 * 0x9E37_79B9) ^ (y as u64 / 3 * 0x85EB_CA6B);
            (hash.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56) as u8
        })
    }

    #[test]
    fn lanes_give_what_a_single_circle_gives() {
        for (arc, threshold) in [(9, 20), (10, 1), (11, 35), (12, 60)] {
            let test = SegmentTest { threshold, arc };
            for width in [1, 6, 7, 20, 38, 39, 75, 103] {
                let picture = noise(width, 17);
                let mut corners = 0;
                for y in 0..17 {
                    let mut row = vec![9; width];
                    let mut seen = Vec::new();
                    test.row(&picture, y, &mut row, &mut seen);
                    let mut plain = Vec::new();
                    for (x, score) in row.iter().enumerate() {
                        let circle = Circle::of(&picture, (x, y), test);
                        assert_eq!(*score, circle.as_ref().map_or(0, |circle| circle.score), "({x}, {y}) of {width}");
                        let passes = circle.is_some_and(|circle| circle.compass >= test.compass_points());
                        plain.extend(passes.then_some(Candidate { x, score: *score }));
                        assert!(passes || *score == 0, "a corner passes the high-speed test");
                        corners += usize::from(*score > 0);
                    }
                    assert_eq!(seen, plain, "row {y} of {width}");
                }
                assert!(width < 75 || arc > 9 || corners > 10, "{corners} corners");
            }
        }
    }

    #[test]
    fn the_highest_score_is_the_largest_threshold_with_a_corner() {
        let picture = noise(71, 40).map(|level| 100 + level / 4);
        let has_corner = |threshold: u8| {
            let test = SegmentTest { threshold, arc: 9 };
            (0..40).any(|y| (0..71).any(|x| Circle::of(&picture, (x, y), test).is_some_and(|c| c.arc.is_some())))
        };
        let highest = SegmentTest { threshold: 200, arc: 9 }.highest_score(&picture);
        assert!(highest > 10 && has_corner(highest) && !has_corner(highest + 1), "{highest}");
        assert_eq!(SegmentTest { threshold: 20, arc: 9 }.highest_score(&Grid::new(30, 20, 90)), 0);
    }

    #[test]
    fn maxima_exceed_all_their_neighbours() {
        for width in [3, 7, 39, 40, 71] {
            let scores = Grid::from_fn(width, 12, |x, y| match (x * 37 + y * 101 + x * y * 13) % 11 {
                _ if x < RADIUS || y < RADIUS || x + RADIUS >= width || y + RADIUS >= 12 => 0,
                value => value as u8,
            });
            for y in 0..12 {
                let mut found = Vec::new();
                maxima(&scores, y, |x| found.push(x));
                let is_maximum = |x: &usize| scores[(*x, y)] > 0 && suppressed_by(&scores, (*x, y)).is_none();
                assert_eq!(found, (0..width).filter(is_maximum).collect::<Vec<_>>(), "row {y} of {width}");
            }
        }
    }

    #[test]
    fn a_run_goes_on_over_the_first_pixel() {
        let mut shades = [Shade::Similar; 16];
        for k in [14, 15, 0, 1, 2] {
            shades[k] = Shade::Darker;
        }
        shades[7] = Shade::Brighter;
        assert_eq!(longest_run(&shades), Some((14, 5)));
        assert_eq!(longest_run(&[Shade::Similar; 16]), None);
        assert_eq!(longest_run(&[Shade::Brighter; 16]), Some((0, 16)));
    }
}
