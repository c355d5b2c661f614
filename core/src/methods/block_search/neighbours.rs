//! Spatial and temporal predictors: the motion vectors of neighbouring blocks.

use super::{Displacement, Match};

/// The matches of neighbouring blocks that were searched before.
#[derive(Clone, Copy, Debug, Default)]
pub struct Neighbours {
    /// The block to the left.
    pub left: Option<Match>,
    /// The block above.
    pub above: Option<Match>,
    /// The block above and to the right.
    pub above_right: Option<Match>,
    /// The same block in the previous pair of frames (the collocated block).
    pub before: Option<Match>,
    /// The same block in the pair before that.
    pub earlier: Option<Match>,
}

impl Neighbours {
    /// The neighbours of block `index` in a grid of `columns`; `found` gives the match of an earlier block in raster order,
    /// `before` the matches of the previous pair of frames and of the one before that.
    pub(crate) fn of(
        index: usize,
        columns: usize,
        found: impl Fn(usize) -> Match,
        before: [Option<&[Match]>; 2],
    ) -> Self {
        let [before, earlier] = before.map(|before| before.and_then(|before| before.get(index).copied()));
        let (column, row) = (index % columns, index / columns);
        Self {
            left: (column > 0).then(|| found(index - 1)),
            above: (row > 0).then(|| found(index - columns)),
            above_right: (row > 0 && column + 1 < columns).then(|| found(index - columns + 1)),
            before,
            earlier,
        }
    }

    /// The neighbours in this pair that were searched.
    pub fn spatial(&self) -> impl Iterator<Item = Match> + Clone + use<> {
        [self.left, self.above, self.above_right].into_iter().flatten()
    }

    /// The motion vector of the collocated block and its change since the pair before, added once more; `None` without two
    /// earlier pairs.
    pub fn accelerated(&self) -> Option<Displacement> {
        let (before, earlier) = (self.before?.displacement, self.earlier?.displacement);
        Some([0, 1].map(|i| 2 * before[i] - earlier[i]))
    }

    /// The component-wise median of the three neighbours in this pair. A missing neighbour counts as zero; in the first row
    /// the left neighbour alone is the predictor.
    pub fn median(&self) -> Displacement {
        self.median_of(|found| found.displacement)
    }

    /// The component-wise median of `part` of each match.
    pub(crate) fn median_of(&self, part: impl Fn(Match) -> [i32; 2]) -> [i32; 2] {
        let [a, b, c] = [self.left, self.above, self.above_right].map(|found| found.map_or([0, 0], &part));
        if self.above.is_none() {
            return a;
        }
        [0, 1].map(|i| a[i].max(b[i]).min(c[i]).max(a[i].min(b[i])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(u: i32, v: i32) -> Option<Match> {
        Some(Match::whole([u, v], 0.0))
    }

    #[test]
    fn the_median_is_taken_column_and_row_apart() {
        for [a, b, c] in [[1, 5, 9], [9, 5, 1], [5, 9, 1], [5, 1, 9], [9, 1, 5], [1, 9, 5]] {
            let neighbours = Neighbours {
                left: at(a, -a),
                above: at(b, -b),
                above_right: at(c, -c),
                before: at(7, 7),
                earlier: None,
            };
            assert_eq!(neighbours.median(), [5, -5]);
        }
        let moved = Neighbours { before: at(5, -2), earlier: at(3, -3), ..Neighbours::default() };
        assert_eq!((moved.accelerated(), Neighbours { earlier: None, ..moved }.accelerated()), (Some([7, -1]), None));
        assert_eq!(Neighbours { left: at(3, 4), ..Neighbours::default() }.median(), [3, 4]);
        assert_eq!(Neighbours { left: at(3, 4), above: at(2, 6), ..Neighbours::default() }.median(), [2, 4]);
    }

    #[test]
    fn neighbours_are_those_that_were_searched_before() {
        let found = |i: usize| Match::whole([i as i32, 0], 0.0);
        let index = |found: Option<Match>| found.map(|found| found.displacement[0]);
        let of = |i| {
            let Neighbours { left, above, above_right, .. } = Neighbours::of(i, 4, found, [None; 2]);
            [left, above, above_right].map(index)
        };
        assert_eq!(of(0), [None, None, None]);
        assert_eq!(of(3), [Some(2), None, None]);
        assert_eq!(of(4), [None, Some(0), Some(1)]);
        assert_eq!(of(5), [Some(4), Some(1), Some(2)]);
        assert_eq!(of(7), [Some(6), Some(3), None]);
    }
}
