//! Connected-component labelling by runs, with a union–find forest of labels.
//!
//! The two passes of A. Rosenfeld and J. L. Pfaltz (Sequential operations in digital picture processing, J. ACM 13, 1966)
//! over runs instead of pixels, as in L. He, Y. Chao and K. Suzuki (A run-based two-scan labeling algorithm, IEEE
//! Transactions on Image Processing 17, 2008).

use super::{Blob, Detection, Mask};
use crate::base::Observer;
use crate::choices;
use crate::geometry::{Bounds, Gray, Grid};

choices! {
    /// The neighbourhood of a pixel.
    pub enum Connectivity {
        /// The 4 pixels that share an edge.
        Four = "4" "4",
        /// The 8 pixels that share an edge or a corner.
        Eight = "8" "8",
    }
}

/// A run: adjacent set pixels of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The row.
    pub y: u32,
    /// The first column.
    pub start: u32,
    /// The column after the last.
    pub end: u32,
    /// Its provisional label, from 0.
    pub label: u32,
}

/// The labelling of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// No run above touches it: a new label.
    Made(Run),
    /// It takes the root of the first run above that it touches.
    Took(Run, Run),
    /// It touches another run of the same root.
    Met(Run, Run),
    /// It touches another run of another root: the second label becomes a child of the first.
    Merged(Run, Run, [u32; 2]),
}

/// The runs of the rows so far and the forest of their labels.
#[derive(Clone, Debug, PartialEq)]
pub struct Labelling {
    connectivity: Connectivity,
    /// The runs in raster order.
    runs: Vec<Run>,
    /// The first run of the last row.
    last_row: usize,
    /// The parent of each label; a root is its own.
    parents: Vec<u32>,
}

impl Labelling {
    /// Creates an empty labelling.
    pub fn new(connectivity: Connectivity) -> Self {
        Self { connectivity, runs: Vec::new(), last_row: 0, parents: Vec::new() }
    }

    /// Labels all rows of `mask`.
    pub fn of(mask: &Mask, connectivity: Connectivity) -> Self {
        let mut labelling = Self::new(connectivity);
        (0..mask.height()).for_each(|y| labelling.row(mask, y, &mut ()));
        labelling
    }

    /// The runs so far, in raster order.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// The parent of each provisional label; a root is its own.
    pub fn parents(&self) -> &[u32] {
        &self.parents
    }

    /// Labels row `y`, the next one.
    pub fn row(&mut self, mask: &Mask, y: usize, observer: &mut impl Observer<Event>) {
        let (above, here) = (self.last_row..self.runs.len(), self.runs.len());
        runs(mask.row(y), mask.width(), |start, end| self.runs.push(Run { y: y as u32, start, end, label: 0 }));
        self.last_row = here;
        // Diagonal neighbours are one column further.
        let reach = u32::from(self.connectivity == Connectivity::Eight);
        let mut first = above.start;
        for index in here..self.runs.len() {
            let mut run = self.runs[index];
            while first < above.end && self.runs[first].end + reach <= run.start {
                first += 1;
            }
            let touches = |other: &Run| other.start < run.end + reach;
            let mut other = first;
            match self.runs[first..above.end].first().filter(|other| touches(other)) {
                None => {
                    run.label = self.parents.len() as u32;
                    self.parents.push(run.label);
                    observer.see(|| Event::Made(run));
                }
                Some(&above) => {
                    run.label = self.root(above.label);
                    observer.see(|| Event::Took(run, above));
                    other += 1;
                }
            }
            while other < above.end && touches(&self.runs[other]) {
                let above = self.runs[other];
                self.merge(run, above, observer);
                other += 1;
            }
            self.runs[index] = run;
        }
    }

    /// Unites the labels of two touching runs. The smaller root becomes the root of both, the label of the first run.
    fn merge(&mut self, run: Run, other: Run, observer: &mut impl Observer<Event>) {
        let (a, b) = (self.root(run.label), self.root(other.label));
        let (root, child) = (a.min(b), a.max(b));
        if root == child {
            return observer.see(|| Event::Met(run, other));
        }
        self.parents[child as usize] = root;
        observer.see(|| Event::Merged(run, other, [root, child]));
    }

    /// Finds the root of a label, with path halving.
    fn root(&mut self, mut label: u32) -> u32 {
        while self.parents[label as usize] != label {
            let parent = self.parents[label as usize];
            self.parents[label as usize] = self.parents[parent as usize];
            label = self.parents[label as usize];
        }
        label
    }

    /// The final label of each provisional one: from 1, in raster order of the components' first pixels.
    pub fn finals(&self) -> Finals {
        let mut labels: Vec<u32> = Vec::with_capacity(self.parents.len());
        let mut count = 0;
        // A parent is smaller than its child, so it is known before.
        for (label, &parent) in self.parents.iter().enumerate() {
            labels.push(if parent as usize == label {
                count += 1;
                count
            } else {
                labels[parent as usize]
            });
        }
        Finals { labels, count }
    }

    /// Heap memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.runs[..]) + size_of_val(&self.parents[..])
    }
}

/// Returns `mask` without its connected components of fewer than `least` pixels: its area opening (L. Vincent, Morphological area
/// openings and closings for grayscale images, Shape in Picture, 1992).
pub(crate) fn area_opened(mut mask: Mask, connectivity: Connectivity, least: usize) -> Mask {
    let labelling = Labelling::of(&mask, connectivity);
    let finals = labelling.finals();
    let label = |run: &Run| finals.labels[run.label as usize] as usize - 1;
    let mut areas = vec![0; finals.count as usize];
    labelling.runs.iter().for_each(|run| areas[label(run)] += (run.end - run.start) as usize);
    for run in labelling.runs.iter().filter(|run| areas[label(run)] < least) {
        mask.write_row(run.y as usize, |words| {
            (run.start as usize..run.end as usize).for_each(|x| words[x / 64] &= !(1 << (x % 64)));
        });
    }
    mask
}

/// The components' labels.
#[derive(Clone, Debug, PartialEq)]
pub struct Finals {
    /// The final label of each provisional one.
    pub labels: Vec<u32>,
    /// The number of components.
    pub count: u32,
}

impl Finals {
    /// Returns the component of each pixel, 0 for none.
    pub fn grid(&self, labelling: &Labelling, (width, height): (usize, usize)) -> Grid<u32> {
        let mut grid = Grid::new(width, height, 0);
        for run in &labelling.runs {
            let label = self.labels[run.label as usize];
            grid.row_mut(run.y as usize)[run.start as usize..run.end as usize].fill(label);
        }
        grid
    }

    /// Returns each component as a detection, by label; `picture` gives the mean gray level.
    pub fn detections(&self, labelling: &Labelling, picture: &Gray) -> Vec<Detection> {
        let mut sums = vec![Sums::default(); self.count as usize];
        for run in &labelling.runs {
            let gray = &picture.row(run.y as usize)[run.start as usize..run.end as usize];
            sums[self.labels[run.label as usize] as usize - 1].add(run, gray);
        }
        sums.iter().zip(1..).map(|(sums, label)| sums.detection(label)).collect()
    }
}

/// The raw moments of a component; all sums are exact.
#[derive(Clone)]
struct Sums {
    pixels: u64,
    x: u64,
    y: u64,
    xx: u64,
    xy: u64,
    yy: u64,
    gray: u64,
    /// First and last column, first and last row.
    columns: [u32; 2],
    rows: [u32; 2],
}

impl Default for Sums {
    fn default() -> Self {
        let none = [u32::MAX, 0];
        Self { pixels: 0, x: 0, y: 0, xx: 0, xy: 0, yy: 0, gray: 0, columns: none, rows: none }
    }
}

impl Sums {
    fn add(&mut self, run: &Run, gray: &[u8]) {
        let (start, end, y) = (u64::from(run.start), u64::from(run.end), u64::from(run.y));
        let count = end - start;
        let x = count * (start + end - 1) / 2;
        // The squares of 0 to n − 1 add up to this.
        let squares = |n: u64| n * n.saturating_sub(1) * (2 * n).saturating_sub(1) / 6;
        self.pixels += count;
        self.x += x;
        self.y += count * y;
        self.xx += squares(end) - squares(start);
        self.xy += x * y;
        self.yy += count * y * y;
        self.gray += gray.iter().map(|gray| u64::from(*gray)).sum::<u64>();
        self.columns = [self.columns[0].min(run.start), self.columns[1].max(run.end - 1)];
        self.rows = [self.rows[0].min(run.y), self.rows[1].max(run.y)];
    }

    fn detection(&self, label: u32) -> Detection {
        let count = self.pixels as f64;
        let [x, y] = [self.x, self.y].map(|sum| sum as f64 / count);
        // The variance of a square pixel is 1/12.
        let xx = self.xx as f64 / count - x * x + 1.0 / 12.0;
        let yy = self.yy as f64 / count - y * y + 1.0 / 12.0;
        let xy = self.xy as f64 / count - x * y;
        let (half, root) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
        let radii = [half + root, (half - root).max(0.0)].map(|variance| 2.0 * variance.sqrt() as f32);
        let angle_rad = if root == 0.0 { 0.0 } else { 0.5 * (2.0 * xy).atan2(xx - yy) } as f32;
        let blob = Blob {
            label,
            area_px: self.pixels as u32,
            radii,
            angle_rad,
            gray: (self.gray as f64 / count) as f32,
            background_px: [0.0; 2],
        };
        let bounds = Bounds {
            min: [self.columns[0], self.rows[0]].map(|c| c as f32 - 0.5),
            max: [self.columns[1], self.rows[1]].map(|c| c as f32 + 0.5),
        };
        Detection { bounds, center: [x as f32, y as f32], score: 1.0, blob: Some(blob), deviation_px: None }
    }
}

/// Calls `found` with the first column of each run of a row and the one after its last.
fn runs(words: &[u64], width: usize, mut found: impl FnMut(u32, u32)) {
    let (mut open, mut last) = (None, 0);
    for (w, &word) in words.iter().enumerate() {
        // A bit for each pixel that differs from the one before.
        let mut edges = word ^ (word << 1 | last);
        last = word >> 63;
        while edges != 0 {
            let column = 64 * w as u32 + edges.trailing_zeros();
            match open.take() {
                None => open = Some(column),
                Some(start) => found(start, column),
            }
            edges &= edges - 1;
        }
    }
    if let Some(start) = open {
        found(start, width as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::super::mask::tests::scattered;
    use super::*;

    fn gray(width: usize, height: usize) -> Gray {
        Grid::from_fn(width, height, |x, y| (x * 31 + y * 17) as u8)
    }

    /// Labels by filling one component after the other from its first pixel.
    fn flooded(mask: &Mask, connectivity: Connectivity) -> (Grid<u32>, u32) {
        let (mut labels, mut count) = (Grid::new(mask.width(), mask.height(), 0), 0);
        for (x, y) in (0..mask.height()).flat_map(|y| (0..mask.width()).map(move |x| (x, y))) {
            if !mask.get(x, y) || labels[(x, y)] > 0 {
                continue;
            }
            count += 1;
            let mut waiting = vec![(x as isize, y as isize)];
            while let Some((x, y)) = waiting.pop() {
                let (Ok(u), Ok(v)) = (usize::try_from(x), usize::try_from(y)) else { continue };
                if !mask.get(u, v) || labels[(u, v)] > 0 {
                    continue;
                }
                labels[(u, v)] = count;
                let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
                let near = around.filter(|(dx, dy)| connectivity == Connectivity::Eight || dx * dy == 0);
                waiting.extend(near.map(|(dx, dy)| (x + dx, y + dy)));
            }
        }
        (labels, count)
    }

    #[test]
    fn an_area_opening_keeps_thin_lines_and_removes_specks() {
        let is_line = |x: usize, y: usize| x == 70 && (10..20).contains(&y) || x == y + 20 && (20..29).contains(&y);
        let is_speck = |x: usize, y: usize| {
            y.is_multiple_of(4) && x.is_multiple_of(9) && y > 32 || y == 2 && (60..68).contains(&x)
        };
        let mask = Mask::from_fn(100, 40, |x, y| is_line(x, y) || is_speck(x, y));
        let kept = area_opened(mask.clone(), Connectivity::Eight, 9);
        assert!(kept == Mask::from_fn(100, 40, is_line) && kept != mask);
        assert!(area_opened(mask.clone(), Connectivity::Eight, 1) == mask);
    }

    #[test]
    fn components_are_those_of_a_flood() {
        for (width, height) in [(1, 1), (1, 30), (30, 1), (64, 20), (65, 33), (130, 40)] {
            for share in [0, 10, 45, 60, 95, 100] {
                for connectivity in [Connectivity::Four, Connectivity::Eight] {
                    let mask = scattered(width, height, share);
                    let labelling = Labelling::of(&mask, connectivity);
                    let finals = labelling.finals();
                    let found = (finals.grid(&labelling, mask.size()), finals.count);
                    assert_eq!(found, flooded(&mask, connectivity), "{width}×{height}, {share} %");
                }
            }
        }
    }

    #[test]
    fn statistics_are_those_of_the_pixels() {
        let (mask, picture) = (scattered(130, 60, 40), gray(130, 60));
        let labelling = Labelling::of(&mask, Connectivity::Eight);
        let finals = labelling.finals();
        let labels = finals.grid(&labelling, mask.size());
        for found in finals.detections(&labelling, &picture) {
            let blob = found.blob.expect("a shape");
            let places = (0..60).flat_map(|y| (0..130).map(move |x| (x, y)));
            let pixels: Vec<_> = places.filter(|place| labels[*place] == blob.label).collect();
            let mean = |of: &dyn Fn((f64, f64)) -> f64| {
                pixels.iter().map(|&(x, y)| of((x as f64, y as f64))).sum::<f64>() / pixels.len() as f64
            };
            let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
            let covariance = [
                mean(&|p| (p.0 - x).powi(2)) + 1.0 / 12.0,
                mean(&|p| (p.0 - x) * (p.1 - y)),
                mean(&|p| (p.1 - y).powi(2)) + 1.0 / 12.0,
            ];
            // The ellipse has the covariance R diag(r²/4) Rᵀ.
            let [a, b] = blob.radii.map(|radius| f64::from(radius).powi(2) / 4.0);
            let (sin, cos) = f64::from(blob.angle_rad).sin_cos();
            let again = [a * cos * cos + b * sin * sin, (a - b) * sin * cos, a * sin * sin + b * cos * cos];
            assert_eq!(blob.area_px as usize, pixels.len());
            assert!(blob.radii[0] >= blob.radii[1] && blob.angle_rad.abs() <= std::f32::consts::FRAC_PI_2 + 1e-6);
            covariance.iter().zip(again).for_each(|(c, a)| assert!((c - a).abs() < 1e-3, "{covariance:?}, {again:?}"));
            let [cx, cy] = found.center.map(f64::from);
            assert!((cx - x).abs() < 1e-4 && (cy - y).abs() < 1e-4);
            let bright = pixels.iter().map(|p| f64::from(picture[*p])).sum::<f64>() / pixels.len() as f64;
            assert!((f64::from(blob.gray) - bright).abs() < 1e-3);
            let ends = |of: fn(&(usize, usize)) -> usize| {
                let all = || pixels.iter().map(of);
                (all().min().expect("a pixel") as f32 - 0.5, all().max().expect("a pixel") as f32 + 0.5)
            };
            let ((left, right), (top, bottom)) = (ends(|p| p.0), ends(|p| p.1));
            assert_eq!(found.bounds, Bounds { min: [left, top], max: [right, bottom] });
        }
    }

    #[test]
    fn rectangles_and_ellipses_are_measured_exactly() {
        let one = |mask: &Mask| {
            let labelling = Labelling::of(mask, Connectivity::Four);
            let finals = labelling.finals();
            assert_eq!(finals.count, 1);
            finals.detections(&labelling, &Grid::new(mask.width(), mask.height(), 7))[0]
        };
        let found = one(&Mask::from_fn(90, 40, |x, y| (10..34).contains(&x) && (5..15).contains(&y)));
        let blob = found.blob.expect("a shape");
        assert_eq!((found.center, blob.area_px, blob.angle_rad, blob.gray), ([21.5, 9.5], 240, 0.0, 7.0));
        // A rectangle of w × h px has the variances w²/12 and h²/12.
        let [a, b] = [24.0, 10.0].map(|side: f32| side / 3.0f32.sqrt());
        assert!((blob.radii[0] - a).abs() < 1e-5 && (blob.radii[1] - b).abs() < 1e-5);
        for angle in [0.0f32, 0.4, -0.9, 1.3] {
            let inside = |x: f32, y: f32| {
                let (dx, dy) = (x - 80.0, y - 70.5);
                let (along, across) = (dx * angle.cos() + dy * angle.sin(), dy * angle.cos() - dx * angle.sin());
                (along / 40.0).powi(2) + (across / 22.0).powi(2) < 1.0
            };
            let found = one(&Mask::from_fn(160, 140, |x, y| inside(x as f32, y as f32)));
            let blob = found.blob.expect("a shape");
            // Its pixels lie symmetrically around its middle.
            assert!((found.center[0] - 80.0).abs() < 1e-3 && (found.center[1] - 70.5).abs() < 1e-3);
            assert!((blob.radii[0] - 40.0).abs() < 0.1 && (blob.radii[1] - 22.0).abs() < 0.1, "{blob:?}");
            assert!((blob.angle_rad - angle).abs() < 0.01, "{blob:?}");
        }
    }

    #[test]
    fn merges_are_reported_where_labels_meet() {
        // A U: two labels until its bottom row.
        let mask = Mask::from_fn(5, 3, |x, y| y == 2 || x == 0 || x == 4);
        let mut labelling = Labelling::new(Connectivity::Eight);
        let mut events = Vec::new();
        (0..3).for_each(|y| labelling.row(&mask, y, &mut events));
        let merged: Vec<_> = events
            .iter()
            .filter_map(|e| if let Event::Merged(_, _, labels) = e { Some(*labels) } else { None })
            .collect();
        assert_eq!((merged, labelling.parents(), labelling.finals().count), (vec![[0, 1]], &[0, 0][..], 1));
        assert_eq!(events.iter().filter(|event| matches!(event, Event::Made(_))).count(), 2);
    }
}
