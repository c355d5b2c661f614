//! Mathematical morphology of masks with a square structuring element, 64 pixels at once.

use super::Mask;

/// The maximum radius of the structuring element in px.
pub const MAX_RADIUS_PX: usize = 30;

impl Mask {
    /// Dilation with a square of (2 `radius_px` + 1)² px.
    ///
    /// # Panics
    /// If the radius is larger than [`MAX_RADIUS_PX`].
    #[must_use]
    pub fn dilated(&self, radius_px: usize) -> Mask {
        assert!(radius_px <= MAX_RADIUS_PX, "a radius of {radius_px} px");
        let mut wide = self.clone();
        let mut before = vec![0; self.row(0).len()];
        for y in 0..self.height() {
            wide.write_row(y, |row| spread(row, radius_px, &mut before));
        }
        let mut out = Mask::new(self.width(), self.height());
        for y in 0..self.height() {
            out.write_row(y, |row| {
                for near in y.saturating_sub(radius_px)..(y + radius_px + 1).min(self.height()) {
                    row.iter_mut().zip(wide.row(near)).for_each(|(word, near)| *word |= near);
                }
            });
        }
        out
    }

    /// Erosion with a square of (2 `radius_px` + 1)² px. Pixels outside the picture count as set.
    ///
    /// # Panics
    /// If the radius is larger than [`MAX_RADIUS_PX`].
    #[must_use]
    pub fn eroded(&self, radius_px: usize) -> Mask {
        self.inverted().dilated(radius_px).inverted()
    }

    /// Opening: erosion, then dilation. Removes regions narrower than the square of (2 `radius_px` + 1)² px.
    ///
    /// # Panics
    /// If the radius is larger than [`MAX_RADIUS_PX`].
    #[must_use]
    pub fn opened(&self, radius_px: usize) -> Mask {
        self.eroded(radius_px).dilated(radius_px)
    }

    /// Closing: dilation, then erosion. Fills gaps narrower than the square.
    ///
    /// # Panics
    /// If the radius is larger than [`MAX_RADIUS_PX`].
    #[must_use]
    pub fn closed(&self, radius_px: usize) -> Mask {
        self.dilated(radius_px).eroded(radius_px)
    }

    /// Returns the complement.
    #[must_use]
    pub fn inverted(&self) -> Mask {
        let mut out = self.clone();
        out.write(|words, _| words.iter_mut().for_each(|word| *word = !*word));
        out
    }

    /// Returns the set difference with `other`, of the same size.
    #[must_use]
    pub fn without(&self, other: &Mask) -> Mask {
        let mut out = self.clone();
        for y in 0..self.height() {
            out.write_row(y, |row| row.iter_mut().zip(other.row(y)).for_each(|(word, other)| *word &= !other));
        }
        out
    }
}

/// Dilates a row by `radius` bits. `before` is a buffer for a row.
fn spread(row: &mut [u64], radius: usize, before: &mut [u64]) {
    let mut done = 0;
    while done < radius {
        // What reaches `done` leaves no gap when it is moved by one more, even where half of it was lost at the edge.
        let step = (done + 1).min(radius - done);
        before.copy_from_slice(row);
        for (w, word) in row.iter_mut().enumerate() {
            let (left, right) = (w.checked_sub(1).map_or(0, |w| before[w]), before.get(w + 1).copied().unwrap_or(0));
            let up = before[w] << step | left >> (64 - step);
            let down = before[w] >> step | right << (64 - step);
            *word |= up | down;
        }
        done += step;
    }
}

#[cfg(test)]
mod tests {
    use super::super::mask::tests::scattered;
    use super::*;

    /// Whether `is` holds for any of the pixels within `radius` px that lie in the picture.
    fn any_near(mask: &Mask, (x, y): (usize, usize), radius: usize, is: impl Fn(bool) -> bool) -> bool {
        let span = |c: usize, extent: usize| c.saturating_sub(radius)..(c + radius + 1).min(extent);
        span(y, mask.height()).any(|v| span(x, mask.width()).any(|u| is(mask.get(u, v))))
    }

    #[test]
    fn a_pixel_becomes_a_square_of_any_radius() {
        for (radius, x) in (0..=MAX_RADIUS_PX).flat_map(|radius| [0, 1, 63, 64, 129].map(|x| (radius, x))) {
            let square = Mask::from_fn(130, 70, |u, v| (u, v) == (x, 35)).dilated(radius);
            assert_eq!(square, Mask::from_fn(130, 70, |u, v| u.abs_diff(x).max(v.abs_diff(35)) <= radius));
        }
    }

    #[test]
    fn morphology_is_that_of_its_definition() {
        for (width, height) in [(1, 1), (1, 40), (40, 1), (63, 9), (64, 8), (65, 20), (140, 11)] {
            for (share, radius) in [(5, 0), (5, 1), (30, 2), (80, 3), (96, 7)] {
                let mask = scattered(width, height, share);
                let dilation =
                    |m: &Mask| Mask::from_fn(width, height, |x, y| any_near(m, (x, y), radius, |is_set| is_set));
                let erosion =
                    |m: &Mask| Mask::from_fn(width, height, |x, y| !any_near(m, (x, y), radius, |is_set| !is_set));
                assert_eq!(mask.dilated(radius), dilation(&mask));
                assert_eq!(mask.eroded(radius), erosion(&mask));
                let (opened, closed) = (mask.opened(radius), mask.closed(radius));
                assert_eq!(opened, dilation(&erosion(&mask)));
                assert_eq!(closed, erosion(&dilation(&mask)));
                assert_eq!((opened.opened(radius), closed.closed(radius)), (opened.clone(), closed.clone()));
                assert_eq!((opened.without(&mask).count(), mask.without(&closed).count()), (0, 0));
            }
        }
    }
}
