//! Rectangles by their outer edges.

/// An axis-parallel rectangle by its outer edges, in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Left and top edge; that of the first pixel lies at −0.5.
    pub min: [f32; 2],
    /// Right and bottom edge.
    pub max: [f32; 2],
}

impl Bounds {
    /// The rectangle of a width and height around a centre.
    pub fn around(center: [f32; 2], size: [f32; 2]) -> Self {
        Self { min: [0, 1].map(|i| center[i] - size[i] / 2.0), max: [0, 1].map(|i| center[i] + size[i] / 2.0) }
    }

    /// The centre.
    pub fn center(&self) -> [f32; 2] {
        [0, 1].map(|i| (self.min[i] + self.max[i]) / 2.0)
    }

    /// Width and height.
    pub fn size(&self) -> [f32; 2] {
        [0, 1].map(|i| self.max[i] - self.min[i])
    }

    /// The same rectangle elsewhere.
    #[must_use]
    pub fn moved(&self, by: [f32; 2]) -> Self {
        let add = |corner: [f32; 2]| [0, 1].map(|i| corner[i] + by[i]);
        Self { min: add(self.min), max: add(self.max) }
    }

    /// The area in px².
    pub fn area(&self) -> f32 {
        let [width, height] = self.size();
        width.max(0.0) * height.max(0.0)
    }

    /// The area in px² that both have in common.
    fn shared_area(&self, other: &Bounds) -> f32 {
        let both = Bounds {
            min: [0, 1].map(|i| self.min[i].max(other.min[i])),
            max: [0, 1].map(|i| self.max[i].min(other.max[i])),
        };
        both.area()
    }

    /// Intersection over union, 0 to 1.
    pub fn iou(&self, other: &Bounds) -> f32 {
        let (shared, all) = (self.shared_area(other), self.area() + other.area());
        if shared > 0.0 { shared / (all - shared) } else { 0.0 }
    }

    /// The intersection as a share of the smaller one, 0 to 1.
    pub fn shared(&self, other: &Bounds) -> f32 {
        let (shared, smaller) = (self.shared_area(other), self.area().min(other.area()));
        if shared > 0.0 { shared / smaller } else { 0.0 }
    }
}
