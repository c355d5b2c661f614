//! Smaller copies of pictures.

use std::borrow::Cow;

use motionscope_core::geometry::Grid;

/// The mean of every `factor × factor` pixels; colours count by how opaque they are.
pub fn reduced(pixels: &Grid<[u8; 4]>, factor: usize) -> Cow<'_, Grid<[u8; 4]>> {
    if factor == 1 {
        return Cow::Borrowed(pixels);
    }
    let (width, height) = pixels.size();
    Cow::Owned(Grid::from_fn(width.div_ceil(factor), height.div_ceil(factor), |x, y| {
        let columns = x * factor..((x + 1) * factor).min(width);
        let (mut sums, mut alpha, mut count) = ([0u32; 3], 0, 0);
        for row in y * factor..((y + 1) * factor).min(height) {
            for &[r, g, b, a] in &pixels.row(row)[columns.clone()] {
                let a = u32::from(a);
                sums = [sums[0] + a * u32::from(r), sums[1] + a * u32::from(g), sums[2] + a * u32::from(b)];
                (alpha, count) = (alpha + a, count + 1);
            }
        }
        let [r, g, b] = sums.map(|sum| (sum / alpha.max(1)) as u8);
        [r, g, b, (alpha / count.max(1)) as u8]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reduced_picture_keeps_its_mean_and_its_edge() {
        let picture = Grid::from_fn(5, 3, |x, _| [if x == 4 { 200 } else { 10 }; 4]);
        let small = reduced(&picture, 2);
        assert_eq!(small.size(), (3, 2));
        assert_eq!((small[(0, 0)], small[(2, 1)]), ([10; 4], [200; 4]));
    }
}
