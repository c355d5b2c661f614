//! Which objects and blobs correspond.

use super::Body;
use crate::objects::assignment::nearest_first;
use crate::objects::{Bounds, Detection, Life};
use crate::{Clip, Error, Gray, Grid};

/// Something that was detected, and what it looks like.
#[derive(Clone, Debug)]
pub(super) struct Blob {
    pub detection: Detection,
    /// Mean gray value of its pixels, where it has some.
    pub gray: Option<f64>,
    pub area_px: f64,
}

impl Blob {
    /// What was detected in frame `t`; where only boxes are known and their gray is asked for, the pixels in them tell it.
    ///
    /// # Errors
    /// If the frame cannot be read.
    pub fn all((clip, t): (&Clip, usize), detections: Vec<Detection>, with_gray: bool) -> Result<Vec<Self>, Error> {
        let has_boxes = with_gray && detections.iter().any(|detection| detection.blob.is_none());
        let frame = if has_boxes { Some(clip.frame(t)?) } else { None };
        let of = |detection: Detection| match (detection.blob, &frame) {
            (Some(blob), _) => Self { detection, gray: Some(f64::from(blob.gray)), area_px: f64::from(blob.area_px) },
            (None, frame) => {
                let gray = frame.as_ref().and_then(|frame| mean_gray(frame.luma(), &detection.bounds));
                Self { detection, gray, area_px: f64::from(detection.bounds.area()) }
            }
        };
        Ok(detections.into_iter().map(of).collect())
    }

    pub fn center(&self) -> [f64; 2] {
        self.detection.center.map(f64::from)
    }
}

/// The mean gray value of the pixels in a box, if there are any.
fn mean_gray(picture: &Gray, bounds: &Bounds) -> Option<f64> {
    let (width, height) = picture.size();
    // Pixels whose centres lie in the box; a cast takes what lies outside to the edge.
    let range = |i: usize, extent: usize| {
        let [start, end] = [bounds.min[i], bounds.max[i]].map(|c| (c.ceil() as usize).min(extent));
        start..end.max(start)
    };
    let (columns, rows) = (range(0, width), range(1, height));
    let count = columns.len() * rows.len();
    let row = |y: usize| picture.row(y)[columns.clone()].iter().map(|gray| u64::from(*gray)).sum::<u64>();
    let sum: u64 = rows.map(row).sum();
    (count > 0).then(|| sum as f64 / count as f64)
}

/// Objects and groups, a row each, beside blobs.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub bodies: Vec<Body>,
    pub blobs: Vec<Blob>,
    /// What their boxes have in common, as a share of the smaller one.
    pub shares: Grid<f64>,
    /// The same as intersection over union.
    pub overlaps: Grid<f64>,
    /// From centre to centre, in px.
    pub distances: Grid<f64>,
    /// Who goes on with whom.
    pub links: Grid<bool>,
}

impl Table {
    /// Pairs are chosen by overlap, the largest first. An object that corresponds to some blob, but has none of its own, merges
    /// into the one that it has most in common with; a blob that is left in the same way is split off. Those that correspond to
    /// nothing are paired with what is nearest.
    pub fn new((bodies, blobs): (Vec<Body>, Vec<Blob>), min_overlap: f32, max_distance: f32) -> Self {
        let (width, height) = (blobs.len(), bodies.len());
        let of = |f: &dyn Fn(&Bounds, &Detection) -> f64| {
            Grid::from_fn(width, height, |x, y| f(&bodies[y].bounds, &blobs[x].detection))
        };
        let shares = of(&|bounds, found| f64::from(bounds.shared(&found.bounds)));
        let overlaps = of(&|bounds, found| f64::from(bounds.iou(&found.bounds)));
        let distances = Grid::from_fn(width, height, |x, y| {
            let (a, b) = (bodies[y].center(), blobs[x].center());
            (a[0] - b[0]).hypot(a[1] - b[1])
        });
        let links = Grid::new(width, height, false);
        let mut table = Self { bodies, blobs, shares, overlaps, distances, links };
        table.link(|share| share > 0.0 && share >= f64::from(min_overlap), f64::from(max_distance));
        table
    }

    fn link(&mut self, corresponds: impl Fn(f64) -> bool, max_distance: f64) {
        let (width, height) = self.shares.size();
        let is_linked = self.shares.map(|share| corresponds(*share));
        let unlike =
            Grid::from_fn(
                width,
                height,
                |x, y| if is_linked[(x, y)] { 1.0 - self.overlaps[(x, y)] } else { f64::INFINITY },
            );
        let pairs = nearest_first(&unlike);
        let mut has_row: Vec<bool> = pairs.iter().map(Option::is_some).collect();
        let mut has_column: Vec<bool> = (0..width).map(|x| pairs.contains(&Some(x))).collect();
        for (y, x) in pairs.iter().enumerate().filter_map(|(y, x)| Some((y, (*x)?))) {
            self.links[(x, y)] = true;
        }
        let shared = |place: &(usize, usize)| self.shares[*place];
        let most = |places: &mut dyn Iterator<Item = (usize, usize)>| {
            places.reduce(|best, place| if shared(&place) > shared(&best) { place } else { best })
        };
        let mut more = Vec::new();
        for y in (0..height).filter(|&y| pairs[y].is_none() && self.bodies[y].may_merge()) {
            more.extend(most(&mut (0..width).map(|x| (x, y)).filter(|place| is_linked[*place])));
        }
        for x in (0..width).filter(|&x| !has_column[x]) {
            more.extend(most(&mut (0..height).map(|y| (x, y)).filter(|place| is_linked[*place])));
        }
        for (x, y) in more {
            self.links[(x, y)] = true;
            (has_column[x], has_row[y]) = (true, true);
        }
        let near = Grid::from_fn(width, height, |x, y| {
            let is_near = !has_column[x] && !has_row[y] && self.distances[(x, y)] <= max_distance;
            if is_near { self.distances[(x, y)] } else { f64::INFINITY }
        });
        for (y, x) in nearest_first(&near).into_iter().enumerate().filter_map(|(y, x)| Some((y, x?))) {
            self.links[(x, y)] = true;
        }
    }

    /// The rows and columns that belong together, by their first row; rows without any column stand alone.
    pub fn parts(&self) -> Vec<(Vec<usize>, Vec<usize>)> {
        let (width, height) = self.links.size();
        let (mut is_done, mut parts) = (vec![false; height], Vec::new());
        for first in 0..height {
            if is_done[first] {
                continue;
            }
            let (mut rows, mut columns) = (vec![first], Vec::new());
            is_done[first] = true;
            let mut next = 0;
            while let Some(&row) = rows.get(next) {
                next += 1;
                for x in (0..width).filter(|&x| self.links[(x, row)]) {
                    if !columns.contains(&x) {
                        columns.push(x);
                    }
                    for y in (0..height).filter(|&y| self.links[(x, y)]) {
                        if !std::mem::replace(&mut is_done[y], true) {
                            rows.push(y);
                        }
                    }
                }
            }
            rows.sort_unstable();
            columns.sort_unstable();
            parts.push((rows, columns));
        }
        parts
    }
}

impl Body {
    /// The centre of its box in px; of an object by itself where it is expected.
    pub fn center(&self) -> [f64; 2] {
        match &self.members[..] {
            [member] => member.center,
            _ => self.bounds.center().map(f64::from),
        }
    }

    /// Whether it can be hidden behind another one: it was seen in the frame before, and is believed in.
    fn may_merge(&self) -> bool {
        self.members.iter().any(|member| member.age.life == Life::Confirmed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::lives::Age;
    use crate::tracking::blob_tracker::Member;

    fn bounds(x: f32, width: f32) -> Bounds {
        Bounds { min: [x, 0.0], max: [x + width, 10.0] }
    }

    fn body((x, width): (f32, f32)) -> Body {
        let (bounds, age) = (bounds(x, width), Age { seen: 9, missed: 0, life: Life::Confirmed });
        let center = bounds.center().map(f64::from);
        let member = Member { id: 1, age, gray: None, area_px: 1.0, bounds, center, velocity: None };
        Body { bounds, centers: vec![center], members: vec![member] }
    }

    fn blob((x, width): (f32, f32)) -> Blob {
        let bounds = bounds(x, width);
        let detection = Detection { bounds, center: bounds.center(), score: 1.0, blob: None };
        Blob { detection, gray: None, area_px: 1.0 }
    }

    /// The parts of boxes in a row, each given by its left edge and its width.
    fn parts(bodies: &[(f32, f32)], blobs: &[(f32, f32)]) -> Vec<(Vec<usize>, Vec<usize>)> {
        let all = (bodies.iter().copied().map(body).collect(), blobs.iter().copied().map(blob).collect());
        Table::new(all, 0.3, 30.0).parts()
    }

    #[test]
    fn objects_go_on_merge_split_and_are_missed() {
        let (a, b) = ((0.0, 10.0), (12.0, 10.0));
        assert_eq!(parts(&[a, b], &[(13.0, 10.0), (1.0, 10.0)]), [(vec![0], vec![1]), (vec![1], vec![0])]);
        assert_eq!(parts(&[a, b], &[(0.0, 22.0)]), [(vec![0, 1], vec![0])]);
        assert_eq!(parts(&[(0.0, 22.0)], &[a, b]), [(vec![0], vec![0, 1])]);
        // Boxes that overlap crosswise still have a blob each.
        assert_eq!(parts(&[a, (4.0, 10.0)], &[(3.0, 10.0), (1.0, 10.0)]), [(vec![0], vec![1]), (vec![1], vec![0])]);
        // Nothing overlaps: the nearest within 30 px, each once.
        assert_eq!(parts(&[a, (70.0, 10.0)], &[(25.0, 10.0)]), [(vec![0], vec![0]), (vec![1], vec![])]);
        assert_eq!(parts(&[a], &[(45.0, 10.0)]), [(vec![0], vec![])]);
    }

    #[test]
    fn who_was_not_seen_is_not_hidden_behind_another() {
        let mut coasting = body((2.0, 10.0));
        coasting.members[0].age = Age { seen: 9, missed: 2, life: Life::Coasting };
        let table = Table::new((vec![body((0.0, 10.0)), coasting], vec![blob((0.0, 10.0))]), 0.3, 30.0);
        assert_eq!(table.parts(), [(vec![0], vec![0]), (vec![1], vec![])]);
    }

    #[test]
    fn gray_is_the_mean_of_the_pixels_in_the_box() {
        let picture = Grid::from_fn(6, 4, |x, y| (10 * x + y) as u8);
        let of = |min, max| mean_gray(&picture, &Bounds { min, max });
        assert_eq!(of([0.5, -0.5], [2.5, 1.5]), Some(15.5));
        assert_eq!(of([-9.0, -9.0], [99.0, 99.0]), Some(26.5));
        assert_eq!((of([7.0, 0.0], [9.0, 2.0]), of([-9.0, 0.0], [-1.0, 2.0])), (None, None));
    }
}
