//! Interpolation of pixels without a disparity (Hirschmüller 2008, section 2.6).

use crate::methods::stereo::Kept;

/// Why a pixel has no disparity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gap {
    /// No pixel of the right view is matched with it: it is half-occluded.
    Occluded,
    /// One is, so that the match is wrong.
    Mismatched,
}

/// The disparity for a gap from the nearest ones around it: the second lowest for a half-occluded pixel, since the background continues there,
/// and the median for a mismatch (the lower of two in the middle). NaN where there are none.
pub fn value(gap: Gap, around: [f32; 8]) -> f32 {
    let mut known: Vec<f32> = around.into_iter().filter(|d| d.is_finite()).collect();
    known.sort_by(f32::total_cmp);
    let last = known.len().saturating_sub(1);
    let index = match gap {
        Gap::Occluded => last.min(1),
        Gap::Mismatched => last / 2,
    };
    known.get(index).copied().unwrap_or(f32::NAN)
}

/// For each pixel without a disparity, in the order of rows, its index and the nearest disparities in eight directions; NaN where there is none
/// up to the border.
pub fn nearest(kept: &[Kept], width: usize) -> Vec<(usize, [f32; 8])> {
    let holes = kept.iter().enumerate().filter(|(_, kept)| kept.disparity.is_nan());
    let mut all: Vec<_> = holes.map(|(index, _)| (index, [f32::NAN; 8])).collect();
    let last = kept.len().saturating_sub(1);
    let mut next = 0;
    sweep(kept.iter().map(|kept| kept.disparity), width, |around| {
        all[next].1[..4].copy_from_slice(&around);
        next += 1;
    });
    // The other four directions are the same, seen from the last pixel backwards.
    let backwards = (0..kept.len()).map(|index| kept[last - index].disparity);
    sweep(backwards, width, |around| {
        next -= 1;
        all[next].1[4..].copy_from_slice(&around);
    });
    all
}

/// Calls `found` for each pixel without a disparity with the nearest ones to the left, above left, above and above right.
fn sweep(disparities: impl Iterator<Item = f32>, width: usize, mut found: impl FnMut([f32; 4])) {
    // The values passed on along each direction by the pixels of the row above and of this row, with one outside on either side.
    let mut rows = [(); 2].map(|()| vec![[f32::NAN; 4]; width + 2]);
    for (index, disparity) in disparities.enumerate() {
        let x = index % width + 1;
        if x == 1 {
            rows.swap(0, 1);
        }
        let around = [rows[1][x - 1][0], rows[0][x - 1][1], rows[0][x][2], rows[0][x + 1][3]];
        if disparity.is_nan() {
            found(around);
            rows[1][x] = around;
        } else {
            rows[1][x] = [disparity; 4];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::stereo::Verdict;

    #[test]
    fn the_nearest_disparities_are_found_in_all_directions() {
        let (width, height) = (9, 7);
        let value = |x: i32, y: i32| if (x * 5 + y * 3) % 7 < 4 { f32::NAN } else { (x + 10 * y) as f32 };
        let cells: Vec<_> = (0..height).flat_map(|y| (0..width).map(move |x| value(x, y))).collect();
        let kept: Vec<_> = cells.iter().map(|&disparity| Kept { disparity, verdict: Verdict::Accepted }).collect();
        let found = nearest(&kept, width as usize);
        assert_eq!(found.len(), cells.iter().filter(|d| d.is_nan()).count());
        let steps = [(-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1)];
        for (index, around) in found {
            let (x, y) = (index as i32 % width, index as i32 / width);
            for ((dx, dy), found) in steps.into_iter().zip(around) {
                let mut at = (x + dx, y + dy);
                while (0..width).contains(&at.0) && (0..height).contains(&at.1) && value(at.0, at.1).is_nan() {
                    at = (at.0 + dx, at.1 + dy);
                }
                let inside = (0..width).contains(&at.0) && (0..height).contains(&at.1);
                let expected = if inside { value(at.0, at.1) } else { f32::NAN };
                assert!(found == expected || found.is_nan() && expected.is_nan(), "({x}, {y}) {dx} {dy}: {found}");
            }
        }
    }

    #[test]
    fn half_occluded_pixels_take_the_background_and_others_the_median() {
        let none = f32::NAN;
        let around = [30.0, 12.0, 11.0, none, 29.0, 31.0, none, 10.0];
        assert_eq!(value(Gap::Occluded, around), 11.0);
        assert_eq!(value(Gap::Mismatched, around), 12.0);
        assert_eq!(value(Gap::Occluded, [none, none, 7.0, none, none, none, none, none]), 7.0);
        assert!(value(Gap::Mismatched, [none; 8]).is_nan());
    }
}
