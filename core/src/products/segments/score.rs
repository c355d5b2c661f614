//! The agreement of two segmentations of a picture.

use std::convert::Infallible;

use crate::geometry::Grid;
use crate::products::objects::assignment::{WorkBudget, most_worth};
use crate::products::objects::pairs::Pairs;

/// The contingency table of two segmentations: how many pixels each pair of labels shares.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// Pixels of each pair: a row for each label of the first, a column for each label of the second, which may be 0.
    counts: Grid<u64>,
}

impl Overlap {
    /// Counts the pixels of each pair of labels. Pixels with label 0 in `first` are left out.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn of(first: &Grid<u32>, second: &Grid<u32>) -> Self {
        assert_eq!(first.size(), second.size(), "segmentations of one size");
        let most = |labels: &Grid<u32>| labels.cells().iter().copied().max().unwrap_or(0) as usize + 1;
        let mut counts = Grid::new(most(second), most(first), 0);
        for (a, b) in first.cells().iter().zip(second.cells()).filter(|(a, _)| **a > 0) {
            counts[(*b as usize, *a as usize)] += 1;
        }
        Self { counts }
    }

    fn rows(&self) -> Vec<u64> {
        (0..self.counts.height()).map(|y| self.counts.row(y).iter().sum()).collect()
    }

    fn columns(&self) -> Vec<u64> {
        let sum = |x| (0..self.counts.height()).map(|y| self.counts[(x, y)]).sum();
        (0..self.counts.width()).map(sum).collect()
    }

    /// Pairs of labels other than 0, each label in one pair at most: those that share the most pixels first, of several the one of the
    /// smaller labels.
    pub fn pairs_by_shared_pixels(&self) -> Vec<(u32, u32)> {
        let (width, height) = self.counts.size();
        let places = (1..height).flat_map(|y| (1..width).map(move |x| (x, y)));
        let mut all: Vec<_> = places.filter(|place| self.counts[*place] > 0).collect();
        // A stable sort: the smaller labels stay first.
        all.sort_by_key(|place| std::cmp::Reverse(self.counts[*place]));
        let mut chosen: Vec<(u32, u32)> = Vec::new();
        for (x, y) in all.into_iter().map(|(x, y)| (x as u32, y as u32)) {
            if chosen.iter().all(|other| other.0 != y && other.1 != x) {
                chosen.push((y, x));
            }
        }
        chosen
    }
}

/// The number of pairs of `n` things.
fn pairs(n: u64) -> f64 {
    n as f64 * (n as f64 - 1.0) / 2.0
}

/// The adjusted Rand index (L. Hubert and P. Arabie, Comparing partitions, Journal of Classification 1985): 1 for equal segmentations, about 0
/// for independent ones. Two segmentations of a single segment each are equal.
pub fn adjusted_rand_index(overlap: &Overlap) -> f64 {
    let [rows, columns] = [overlap.rows(), overlap.columns()].map(|sums| sums.into_iter().map(pairs).sum::<f64>());
    let together: f64 = overlap.counts.cells().iter().map(|count| pairs(*count)).sum();
    let all = pairs(overlap.counts.cells().iter().sum());
    let expected = if all > 0.0 { rows * columns / all } else { 0.0 };
    let largest = (rows + columns) / 2.0;
    if largest == expected { 1.0 } else { (together - expected) / (largest - expected) }
}

/// The mean intersection over union of the segments of the first segmentation, each paired with one of the second at most, so that the
/// sum is largest; 0 without segments.
pub fn mean_overlap(overlap: &Overlap) -> f64 {
    let (rows, columns) = (overlap.rows(), overlap.columns());
    let count = rows.iter().skip(1).filter(|area| **area > 0).count();
    let mut worths = Pairs::new(columns.len());
    for (y, area) in rows.iter().enumerate() {
        let iou = |x: usize| overlap.counts[(x, y)] as f64 / (area + columns[x] - overlap.counts[(x, y)]) as f64;
        let shared = (1..columns.len()).filter(|x| y > 0 && overlap.counts[(*x, y)] > 0);
        worths.push(shared.map(|x| (x, iou(x))));
    }
    let Ok(assigned) = most_worth(&worths, &mut WorkBudget::<Infallible>::endless(&|| Ok(())));
    let worth = |(y, x): (usize, &Option<usize>)| x.and_then(|x| worths.get(y, x));
    let sum: f64 = assigned.columns.iter().enumerate().filter_map(worth).sum();
    if count == 0 { 0.0 } else { sum / count as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(labels: &[u32]) -> Grid<u32> {
        Grid::from_fn(labels.len(), 1, |x, _| labels[x])
    }

    /// The index from its definition, by going through all pairs of pixels.
    fn by_pairs(a: &[u32], b: &[u32]) -> f64 {
        let (mut both, mut first, mut second, mut all) = (0.0, 0.0, 0.0, 0.0);
        for (i, j) in (0..a.len()).flat_map(|j| (0..j).map(move |i| (i, j))) {
            let (in_a, in_b) = (a[i] == a[j], b[i] == b[j]);
            both += f64::from(u8::from(in_a && in_b));
            first += f64::from(u8::from(in_a));
            second += f64::from(u8::from(in_b));
            all += 1.0;
        }
        let expected = first * second / all;
        (both - expected) / ((first + second) / 2.0 - expected)
    }

    #[test]
    fn the_index_is_that_of_all_pairs() {
        let (a, b) = ([1, 1, 1, 2, 2, 2, 3, 3, 3, 3], [2, 2, 1, 1, 1, 1, 4, 4, 4, 1]);
        let index = adjusted_rand_index(&Overlap::of(&row(&a), &row(&b)));
        assert!((index - by_pairs(&a, &b)).abs() < 1e-12 && index > 0.2 && index < 0.9, "{index}");
        let renamed = a.map(|label| [0, 3, 1, 2][label as usize]);
        assert_eq!(adjusted_rand_index(&Overlap::of(&row(&a), &row(&renamed))), 1.0);
        let one = [1; 10];
        assert_eq!(adjusted_rand_index(&Overlap::of(&row(&a), &row(&one))), 0.0);
        assert_eq!(adjusted_rand_index(&Overlap::of(&row(&one), &row(&one))), 1.0);
    }

    #[test]
    fn pixels_without_a_true_label_are_left_out() {
        let truth = row(&[0, 1, 1, 2, 2, 0]);
        let overlap = Overlap::of(&truth, &row(&[7, 5, 5, 6, 6, 6]));
        assert_eq!((adjusted_rand_index(&overlap), mean_overlap(&overlap)), (1.0, 1.0));
    }

    #[test]
    fn overlaps_are_those_of_the_best_pairs() {
        let truth = row(&[1, 1, 1, 1, 2, 2, 2, 2]);
        let overlap = Overlap::of(&truth, &row(&[1, 1, 1, 3, 3, 3, 3, 3]));
        assert!((mean_overlap(&overlap) - (0.75 + 0.8) / 2.0).abs() < 1e-12);
        // A segment that is missing counts 0.
        let merged = Overlap::of(&truth, &row(&[1; 8]));
        assert!((mean_overlap(&merged) - 0.25).abs() < 1e-12);
        assert_eq!(merged.pairs_by_shared_pixels(), [(1, 1)]);
    }
}
