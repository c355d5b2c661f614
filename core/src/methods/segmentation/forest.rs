//! Regions of a picture that grow together: a union–find forest of its pixels.

/// A forest whose trees are regions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forest {
    parents: Vec<u32>,
    areas: Vec<u32>,
    /// The largest weight of an edge by which a region was merged: its internal difference.
    internal: Vec<f32>,
    regions: usize,
}

impl Forest {
    /// Creates a forest in which each of `count` pixels is a region.
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect(), areas: vec![1; count], internal: vec![0.0; count], regions: count }
    }

    /// Returns the root of a pixel, and shortens its path.
    pub fn root(&mut self, pixel: u32) -> u32 {
        let mut at = pixel;
        while self.parents[at as usize] != at {
            let above = self.parents[self.parents[at as usize] as usize];
            self.parents[at as usize] = above;
            at = above;
        }
        at
    }

    /// Returns the root of a pixel.
    pub fn root_of(&self, pixel: u32) -> u32 {
        let mut at = pixel;
        while self.parents[at as usize] != at {
            at = self.parents[at as usize];
        }
        at
    }

    /// Merges the regions of two different roots across an edge of this weight; the larger root stays, of equal ones the first.
    pub fn join(&mut self, a: u32, b: u32, weight: f32) {
        let (a, b) = if self.areas[b as usize] > self.areas[a as usize] { (b, a) } else { (a, b) };
        self.parents[b as usize] = a;
        self.areas[a as usize] += self.areas[b as usize];
        self.internal[a as usize] = self.internal[a as usize].max(self.internal[b as usize]).max(weight);
        self.regions -= 1;
    }

    /// Returns the area of the region of a root in px.
    pub fn area(&self, root: u32) -> u32 {
        self.areas[root as usize]
    }

    /// Returns the internal difference of the region of a root.
    pub fn internal(&self, root: u32) -> f32 {
        self.internal[root as usize]
    }

    /// Whether it has no pixels.
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// Returns the number of regions.
    pub fn regions(&self) -> usize {
        self.regions
    }

    /// Numbers the regions from 1 in the order of their first pixels, and leaves out pixels that do not count.
    pub fn labels(&self, counts: impl Fn(usize) -> bool) -> Vec<u32> {
        let (mut names, mut unused) = (vec![0; self.parents.len()], 1);
        (0..self.parents.len())
            .map(|pixel| {
                if !counts(pixel) {
                    return 0;
                }
                let name = &mut names[self.root_of(pixel as u32) as usize];
                if *name == 0 {
                    *name = unused;
                    unused += 1;
                }
                *name
            })
            .collect()
    }

    /// Returns the size in memory in bytes.
    pub fn bytes(&self) -> usize {
        12 * self.parents.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_are_merged_and_numbered() {
        let mut forest = Forest::new(6);
        forest.join(4, 5, 0.5);
        let root = forest.root(5);
        forest.join(3, root, 0.2);
        assert_eq!((forest.root(3), forest.area(root), forest.internal(root), forest.regions()), (root, 3, 0.5, 4));
        assert_eq!(forest.labels(|pixel| pixel != 1), [1, 0, 2, 3, 3, 3]);
    }
}
