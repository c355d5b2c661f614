//! The bounding box of a track.

use crate::data::Detection;
use crate::geometry::Bounds;

/// A box relative to the position of an object, which is not its centre where the position is a centroid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Offset of the box centre from the position in px.
    offset: [f64; 2],
    /// Width and height in px.
    size: [f64; 2],
}

impl Extent {
    /// Returns the box of a detection relative to its position.
    pub fn of(found: &Detection) -> Self {
        let (place, center) = (found.center.map(f64::from), found.bounds.center().map(f64::from));
        Self { offset: [0, 1].map(|i| center[i] - place[i]), size: found.bounds.size().map(f64::from) }
    }

    /// Returns the mean with the box of a new detection. Boxes change slowly, and the filter's state has no size.
    #[must_use]
    pub fn towards(&self, found: &Detection) -> Self {
        let found = Self::of(found);
        let half = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| (a[i] + b[i]) / 2.0);
        Self { offset: half(self.offset, found.offset), size: half(self.size, found.size) }
    }

    /// Returns the box of an object at `place`.
    pub fn around(&self, place: [f64; 2]) -> Bounds {
        let center = [0, 1].map(|i| (place[i] + self.offset[i]) as f32);
        Bounds::around(center, self.size.map(|side| side as f32))
    }

    /// Returns the squared distance of the size of a detection: of the logarithms of width and height, in standard deviations.
    pub fn size_distance(&self, found: &Detection, deviation: f64) -> f64 {
        let size = found.bounds.size().map(f64::from);
        let off = [0, 1].map(|i| (size[i].max(1.0) / self.size[i].max(1.0)).ln() / deviation);
        off[0] * off[0] + off[1] * off[1]
    }

    /// Returns the position of an object with this box.
    pub fn place_in(&self, bounds: &Bounds) -> [f32; 2] {
        let center = bounds.center();
        [0, 1].map(|i| center[i] - self.offset[i] as f32)
    }

    /// Height in px, at least 1.
    pub fn height_px(&self) -> f64 {
        self.size[1].max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_stays_where_it_is_around_a_centroid() {
        let bounds = Bounds { min: [10.0, 20.0], max: [30.0, 60.0] };
        let found = Detection { bounds, center: [14.0, 50.0], score: 1.0, blob: None, deviation_px: None };
        let extent = Extent::of(&found);
        assert_eq!(extent.around([14.0, 50.0]), bounds);
        let larger = Detection { bounds: Bounds { min: [10.0, 20.0], max: [38.0, 60.0] }, ..found };
        let half = extent.towards(&larger);
        assert_eq!(half.around([14.0, 50.0]), Bounds { min: [10.0, 20.0], max: [34.0, 60.0] });
        assert_eq!(half.height_px(), 40.0);
    }
}
