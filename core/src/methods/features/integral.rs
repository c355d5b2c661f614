//! Integral images: the sum of any box of pixels from four values.

use crate::base::effort;
use crate::geometry::Gray;

/// The integral image of a picture: at each corner of a pixel the sum of all pixels above it and to its left.
#[derive(Clone, Debug)]
pub struct Integral {
    size: (usize, usize),
    /// A row and a column more than the picture has. Sums of large pictures wrap around; differences of four do not.
    sums: Vec<u32>,
}

/// A box of pixels by its first column and row, and the first behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBox {
    /// First column and row.
    pub min: [i32; 2],
    /// First column and row behind it.
    pub max: [i32; 2],
}

impl PixelBox {
    /// The box of this size whose first pixel is `min`.
    pub const fn new(min: [i32; 2], [width, height]: [i32; 2]) -> Self {
        Self { min, max: [min[0] + width, min[1] + height] }
    }

    /// The same box moved by an offset.
    pub const fn moved(self, [x, y]: [i32; 2]) -> Self {
        let Self { min, max } = self;
        Self { min: [min[0] + x, min[1] + y], max: [max[0] + x, max[1] + y] }
    }

    /// Its number of pixels.
    pub const fn area(self) -> i32 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }
}

impl Integral {
    /// Computes the integral image of a picture.
    pub fn of(picture: &Gray) -> Self {
        let (width, height) = picture.size();
        effort::add(width * height);
        let stride = width + 1;
        let mut sums = vec![0u32; stride * (height + 1)];
        for y in 0..height {
            let (above, below) = sums.split_at_mut((y + 1) * stride);
            let above = &above[y * stride..];
            let mut of_row = 0u32;
            for ((sum, above), pixel) in below[1..stride].iter_mut().zip(&above[1..]).zip(picture.row(y)) {
                of_row = of_row.wrapping_add((*pixel).into());
                *sum = above.wrapping_add(of_row);
            }
        }
        Self { size: (width, height), sums }
    }

    /// Width and height of the picture.
    pub fn size(&self) -> (usize, usize) {
        self.size
    }

    /// Its memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.sums[..])
    }

    /// The values at the corners of a box: upper left, upper right, lower left, lower right. The part of the box outside the picture
    /// counts as 0.
    #[inline(always)]
    pub fn corners(&self, PixelBox { min, max }: PixelBox) -> [u32; 4] {
        let column = |x: i32| x.clamp(0, self.size.0 as i32) as usize;
        let row = |y: i32| y.clamp(0, self.size.1 as i32) as usize * (self.size.0 + 1);
        let (top, bottom, left, right) = (row(min[1]), row(max[1]), column(min[0]), column(max[0]));
        [top + left, top + right, bottom + left, bottom + right].map(|index| self.sums[index])
    }

    /// The sum of the pixels in a box: lower right − upper right − lower left + upper left.
    #[inline(always)]
    pub fn sum(&self, of: PixelBox) -> u32 {
        let [a, b, c, d] = self.corners(of);
        d.wrapping_sub(b).wrapping_sub(c).wrapping_add(a)
    }

    /// The values at the corners of the four boxes of side `half` around a corner of pixels, in rows.
    #[inline(always)]
    pub fn around(&self, [x, y]: [i32; 2], half: i32) -> [[u32; 3]; 3] {
        let columns = [x - half, x, x + half].map(|x| x.clamp(0, self.size.0 as i32) as usize);
        [y - half, y, y + half].map(|y| {
            let row = self.row(y.clamp(0, self.size.1 as i32) as usize);
            columns.map(|x| row[x])
        })
    }

    /// The values above row `y`, one for each column and one more.
    #[inline(always)]
    pub fn row(&self, y: usize) -> &[u32] {
        let stride = self.size.0 + 1;
        &self.sums[y * stride..(y + 1) * stride]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn a_box_sum_is_that_of_its_pixels_inside_the_picture() {
        let picture = Grid::from_fn(9, 7, |x, y| ((x * 37 + y * 101 + x * y * 13) % 256) as u8);
        let integral = Integral::of(&picture);
        for (min, size) in [([0, 0], [9, 7]), ([2, 1], [3, 4]), ([-3, 5], [6, 6]), ([8, 6], [1, 1]), ([4, 4], [0, 2])] {
            let of = PixelBox::new(min, size);
            let is_in = |x: i32, y: i32| (min[0]..of.max[0]).contains(&x) && (min[1]..of.max[1]).contains(&y);
            let places = (0..7).flat_map(|y| (0..9).map(move |x| (x, y)));
            let plain: u32 =
                places.filter(|(x, y)| is_in(*x, *y)).map(|(x, y)| u32::from(picture[(x as usize, y as usize)])).sum();
            assert_eq!(integral.sum(of), plain, "{of:?}");
        }
    }

    #[test]
    fn sums_that_wrap_around_still_give_small_boxes() {
        let mut integral = Integral::of(&Grid::new(6, 5, 255));
        // As if more than 2³² had been added to the left of column 3.
        for (i, sum) in integral.sums.iter_mut().enumerate() {
            if i % 7 >= 3 {
                *sum = sum.wrapping_add(u32::MAX - 100);
            }
        }
        assert_eq!(integral.sum(PixelBox::new([3, 1], [2, 3])), 6 * 255);
    }
}
