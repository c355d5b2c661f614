//! The sign of the disparities: whether the right view is the right one.

use crate::geometry::Gray;

/// Half a side of the windows in px.
const RADIUS: usize = 4;
/// The least mean absolute horizontal difference of a window with texture, in gray levels.
const LEAST_TEXTURE: u32 = 4;
/// The largest shift tried in px.
const MOST_SHIFT: usize = 96;

/// Number of distinctive windows of the left view by the direction in which they are found in the right view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signs {
    /// Found further left, as in a right view: positive disparity.
    pub positive: usize,
    /// Found further right: negative disparity.
    pub negative: usize,
}

impl Signs {
    /// Whether nearly all windows have a negative disparity, so that the views are swapped.
    pub fn are_swapped(self) -> bool {
        self.negative >= 8 && self.negative >= 4 * self.positive
    }

    /// The warning where the views are swapped.
    pub fn warning(self) -> Option<String> {
        let Self { positive, negative } = self;
        let all = positive + negative;
        self.are_swapped().then(|| {
            format!("probably swapped: {negative} of {all} distinctive windows have a negative disparity; exchange left and right")
        })
    }
}

/// The directions in which distinctive windows on a lattice of the left view are found in the right view, up to `disparities` px away.
pub fn signs([left, right]: [&Gray; 2], disparities: usize) -> Signs {
    /// Windows along each side of the picture.
    const ALONG: usize = 16;
    let (width, height) = left.size();
    let side = 2 * RADIUS + 1;
    let mut signs = Signs::default();
    if width < side || height < side || left.size() != right.size() {
        return signs;
    }
    let places = |extent: usize| {
        let span = extent - side;
        (0..ALONG).map(move |i| span * (2 * i + 1) / (2 * ALONG))
    };
    for (x, y) in places(height).flat_map(|y| places(width).map(move |x| (x, y))) {
        match shift([left, right], (x, y), disparities.min(MOST_SHIFT)) {
            Some(shift) if shift < 0 => signs.positive += 1,
            Some(shift) if shift > 0 => signs.negative += 1,
            _ => {}
        }
    }
    signs
}

/// The shift along x of the window with its first pixel at a place, if it has texture and one minimum is clearly the lowest.
fn shift([left, right]: [&Gray; 2], (x, y): (usize, usize), most: usize) -> Option<isize> {
    let side = 2 * RADIUS + 1;
    let rows = || (y..y + side).map(|y| &left.row(y)[x..x + side]);
    let texture: u32 = rows().flat_map(|row| row.windows(2).map(|pair| u32::from(pair[0].abs_diff(pair[1])))).sum();
    if texture < LEAST_TEXTURE * (side * (side - 1)) as u32 {
        return None;
    }
    let cost = |at: usize| -> u32 {
        let other = (y..y + side).map(|y| &right.row(y)[at..at + side]);
        rows().zip(other).flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| u32::from(a.abs_diff(*b))).sum()
    };
    let (first, last) = (x.saturating_sub(most), (x + most).min(left.width() - side));
    let costs: Vec<u32> = (first..=last).map(cost).collect();
    let best = (0..costs.len()).min_by_key(|i| costs[*i])?;
    let rival = (0..costs.len()).filter(|i| i.abs_diff(best) > 1).map(|i| costs[i]).min()?;
    (10 * rival > 13 * costs[best]).then(|| (first + best) as isize - x as isize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    /// Texture without repetition, shifted to the left by `shift` px.
    fn view(shift: usize) -> Gray {
        let hash = |x: usize, y: usize| {
            ((x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B)).wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56
        };
        Grid::from_fn(120, 80, |x, y| hash(x + shift, y) as u8)
    }

    #[test]
    fn swapped_views_are_recognised_by_the_sign() {
        let (left, right) = (view(0), view(7));
        let sound = signs([&left, &right], 64);
        assert!(sound.positive > 100 && sound.negative == 0 && sound.warning().is_none(), "{sound:?}");
        let swapped = signs([&right, &left], 64);
        assert!(swapped.are_swapped(), "{swapped:?}");
        assert!(swapped.warning().is_some_and(|warning| warning.contains("exchange left and right")));
        // Without texture nothing is known.
        let flat = Grid::new(120, 80, 90u8);
        assert_eq!(signs([&flat, &flat], 64), Signs::default());
        assert_eq!(signs([&Grid::new(4, 4, 1u8), &Grid::new(4, 4, 1u8)], 64), Signs::default());
    }
}
