//! Quarter turns and mirrors, as a camera notes them beside upright pixels.

use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;

/// How a stored picture is turned to be shown: shown x = a·x + c·y, shown y = b·x + d·y, each of -1, 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Turn {
    a: i8,
    b: i8,
    c: i8,
    d: i8,
}

impl Default for Turn {
    fn default() -> Self {
        Self { a: 1, b: 0, c: 0, d: 1 }
    }
}

impl Turn {
    /// The nearest turn to the matrix `[a, b, c, d]`; `None` if that is no quarter turn or mirror.
    pub(crate) fn from_matrix(matrix: [i32; 4]) -> Option<Self> {
        let [a, b, c, d] = matrix.map(|v| v.signum() as i8);
        let straight = b == 0 && c == 0 && a != 0 && d != 0;
        let quarter = a == 0 && d == 0 && b != 0 && c != 0;
        (straight || quarter).then_some(Self { a, b, c, d })
    }

    /// The size of a shown picture whose stored size is given.
    pub(crate) fn size(self, (width, height): (usize, usize)) -> (usize, usize) {
        if self.a == 0 { (height, width) } else { (width, height) }
    }

    /// The picture as it is shown.
    pub(crate) fn apply(self, frame: Frame) -> Frame {
        if self == Self::default() {
            return frame;
        }
        match frame.color() {
            Some(rgb) => Frame::rgb(self.grid(rgb)),
            None => Frame::gray(self.grid(frame.luma())),
        }
    }

    fn grid<T: Copy>(self, stored: &Grid<T>) -> Grid<T> {
        let (width, height) = self.size(stored.size());
        let flip = |sign: i8, v: usize, len: usize| if sign < 0 { len - 1 - v } else { v };
        Grid::from_fn(width, height, |x, y| {
            if self.a == 0 {
                stored[(flip(self.b, y, height), flip(self.c, x, width))]
            } else {
                stored[(flip(self.a, x, width), flip(self.d, y, height))]
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_turn_puts_pixels_where_the_matrix_says() {
        let one = 1 << 16;
        // 1 2 3
        // 4 5 6
        let stored = Grid::from_vec(3, 2, vec![1, 2, 3, 4, 5, 6]).unwrap();
        let cases: [([i32; 4], &[u8], usize); 6] = [
            ([one, 0, 0, one], &[1, 2, 3, 4, 5, 6], 3),
            ([0, one, -one, 0], &[4, 1, 5, 2, 6, 3], 2),
            ([-one, 0, 0, -one], &[6, 5, 4, 3, 2, 1], 3),
            ([0, -one, one, 0], &[3, 6, 2, 5, 1, 4], 2),
            ([-one, 0, 0, one], &[3, 2, 1, 6, 5, 4], 3),
            ([0, one, one, 0], &[1, 4, 2, 5, 3, 6], 2),
        ];
        for (matrix, shown, width) in cases {
            let turned = Turn::from_matrix(matrix).unwrap().apply(Frame::gray(stored.clone()));
            assert_eq!((turned.luma().cells(), turned.size().0), (shown, width), "{matrix:?}");
        }
        assert_eq!(Turn::from_matrix([one, one, 0, one]), None);
        assert_eq!(Turn::from_matrix([0; 4]), None);
    }
}
