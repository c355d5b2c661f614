//! The correspondence of tracks and blobs.

use std::ops::Range;

use super::TrackedBlob;
use crate::base::Error;
use crate::data::{Clip, Detection};
use crate::geometry::{Bounds, Gray, Grid};
use crate::products::{
    TrackStatus,
    objects::{
        assignment::nearest_first,
        box_index::{BoxIndex, corners, nearest},
        pairs::Pairs,
    },
};

/// A detection and its appearance.
#[derive(Clone, Debug)]
pub(super) struct Blob {
    pub detection: Detection,
    /// Mean gray level of its pixels, where known.
    pub gray: Option<f64>,
    pub area_px: f64,
    /// Whether one of its sides is hidden, and its box is completed by the size of its track.
    pub is_completed: bool,
}

impl Blob {
    /// Adds the appearance to the detections of frame `t`; that of a bare box is the mean of its pixels, if asked for.
    ///
    /// # Errors
    /// If the frame cannot be read.
    pub fn all((clip, t): (&Clip, usize), detections: Vec<Detection>, with_gray: bool) -> Result<Vec<Self>, Error> {
        let boxes =
            || detections.iter().filter(|detection| detection.blob.is_none()).map(|detection| &detection.bounds);
        let frame = if with_gray && boxes().next().is_some() { Some(clip.frame(t)?) } else { None };
        let grays = frame.as_ref().map(|frame| BoxMeans::new(frame.luma(), boxes()));
        let of = |detection: Detection| match (detection.blob, &grays) {
            (Some(blob), _) => Self::new(detection, Some(f64::from(blob.gray)), f64::from(blob.area_px)),
            (None, grays) => {
                let gray = grays.as_ref().and_then(|grays| grays.mean(&detection.bounds));
                Self::new(detection, gray, f64::from(detection.bounds.area()))
            }
        };
        Ok(detections.into_iter().map(of).collect())
    }

    fn new(detection: Detection, gray: Option<f64>, area_px: f64) -> Self {
        Self { detection, gray, area_px, is_completed: false }
    }

    pub fn center(&self) -> [f64; 2] {
        self.detection.center.map(f64::from)
    }
}

/// Mean gray levels of boxes of a picture.
struct BoxMeans<'a> {
    picture: &'a Gray,
    /// The integral image, where the boxes have enough pixels to pay for it.
    sums: Option<Grid<u64>>,
}

/// The integral image pays where the boxes have this many times the pixels of the picture.
const WORTH_SUMS: usize = 4;

impl<'a> BoxMeans<'a> {
    fn new<'b>(picture: &'a Gray, boxes: impl Iterator<Item = &'b Bounds>) -> Self {
        let own = Self { picture, sums: None };
        let asked = boxes.fold(0_usize, |sum, bounds| {
            let [columns, rows] = own.pixels(bounds);
            sum.saturating_add(columns.len() * rows.len())
        });
        let is_worth = asked > WORTH_SUMS.saturating_mul(picture.cells().len());
        Self { sums: is_worth.then(|| sums(picture)), ..own }
    }

    /// Returns the columns and rows of the pixels whose centres lie in a box.
    fn pixels(&self, bounds: &Bounds) -> [Range<usize>; 2] {
        // The cast saturates at the edge.
        let range = |i: usize, extent: usize| {
            let [start, end] = [bounds.min[i], bounds.max[i]].map(|c| (c.ceil() as usize).min(extent));
            start..end.max(start)
        };
        [range(0, self.picture.width()), range(1, self.picture.height())]
    }

    /// Returns the mean of the pixels in a box, if there are any.
    fn mean(&self, bounds: &Bounds) -> Option<f64> {
        let [columns, rows] = self.pixels(bounds);
        let count = columns.len() * rows.len();
        let sum = match &self.sums {
            Some(sums) => {
                let [right, left] = [columns.end, columns.start].map(|x| sums[(x, rows.end)] - sums[(x, rows.start)]);
                right - left
            }
            None => {
                let row =
                    |y: usize| self.picture.row(y)[columns.clone()].iter().map(|gray| u64::from(*gray)).sum::<u64>();
                rows.map(row).sum()
            }
        };
        (count > 0).then(|| sum as f64 / count as f64)
    }
}

/// Returns the integral image.
fn sums(picture: &Gray) -> Grid<u64> {
    let (width, height) = picture.size();
    let mut sums = Grid::new(width + 1, height + 1, 0);
    for y in 0..height {
        let mut of_row = 0;
        for x in 0..width {
            of_row += u64::from(picture[(x, y)]);
            sums[(x + 1, y + 1)] = sums[(x + 1, y)] + of_row;
        }
    }
    sums
}

/// The correspondence of tracks or groups (rows) and blobs (columns).
#[derive(Clone, Debug)]
pub(super) struct Correspondence {
    pub tracked_blobs: Vec<TrackedBlob>,
    pub blobs: Vec<Blob>,
    /// The number of pairs with sufficient overlap.
    pub corresponding: usize,
    /// The number of tracks with more than [`MOST_NEAR`] blobs nearby, of which only the nearest count.
    pub crowded: usize,
    /// The columns of each row and the rows of each column, in ascending order.
    links: [Vec<Vec<usize>>; 2],
}

/// The maximum number of blobs compared with a track, the nearest ones. It bounds the work in dense crowds.
pub(super) const MOST_NEAR: usize = 500;

/// The number of tracks between checks for cancellation.
const TRACKS_PER_CHECK: usize = 64;

impl Correspondence {
    /// Pairs tracks and blobs greedily by IoU. A track that overlaps blobs but is left without one merges into the blob of the
    /// largest overlap; a blob left in the same way is a split. Tracks and blobs without any overlap are paired with the nearest.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub fn new(
        clip: &Clip,
        (tracked_blobs, blobs): (Vec<TrackedBlob>, Vec<Blob>),
        (min_overlap, max_distance): (f32, f32),
    ) -> Result<Self, Error> {
        let links = [vec![Vec::new(); tracked_blobs.len()], vec![Vec::new(); blobs.len()]];
        let mut table = Self { tracked_blobs, blobs, corresponding: 0, crowded: 0, links };
        let shares = table.corresponding(clip, min_overlap)?;
        table.link(&shares);
        table.link_nearest(clip, f64::from(max_distance))?;
        Ok(table)
    }

    /// Returns the intersection of a track's and a blob's box as a share of the smaller one.
    pub fn share(&self, row: usize, column: usize) -> f64 {
        f64::from(self.tracked_blobs[row].bounds.shared(&self.blobs[column].detection.bounds))
    }

    /// Returns their intersection over union.
    pub fn overlap(&self, row: usize, column: usize) -> f64 {
        f64::from(self.tracked_blobs[row].bounds.iou(&self.blobs[column].detection.bounds))
    }

    /// Returns the distance of their centres in px.
    pub fn distance(&self, row: usize, column: usize) -> f64 {
        let (a, b) = (self.tracked_blobs[row].center(), self.blobs[column].center());
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    /// Returns the blobs of a track, in ascending order.
    pub fn links(&self, row: usize) -> &[usize] {
        &self.links[0][row]
    }

    /// Returns the overlaps of the pairs with sufficient overlap.
    fn corresponding(&mut self, clip: &Clip, min_overlap: f32) -> Result<Pairs, Error> {
        let detections: Vec<Detection> = self.blobs.iter().map(|blob| blob.detection).collect();
        let near = BoxIndex::new(detections.iter().map(|found| corners(&found.bounds)));
        let (mut shares, mut found) = (Pairs::new(self.blobs.len()), Vec::new());
        for (y, tracked) in self.tracked_blobs.iter().enumerate() {
            if y.is_multiple_of(TRACKS_PER_CHECK) {
                clip.wanted()?;
            }
            let share = |x: usize| f64::from(tracked.bounds.shared(&detections[x].bounds));
            let is_enough = |share: &f64| *share > 0.0 && *share >= f64::from(min_overlap);
            near.touching(corners(&tracked.bounds), &mut found, |x| Some(share(x)).filter(is_enough));
            self.crowded += usize::from(nearest(&mut found, tracked.center(), (&detections, MOST_NEAR)));
            shares.push(found.iter().copied());
        }
        self.corresponding = shares.len();
        Ok(shares)
    }

    fn link(&mut self, shares: &Pairs) {
        let pairs = nearest_first(&shares.map(|y, x, _| 1.0 - self.overlap(y, x)));
        let mut has_row = vec![false; self.blobs.len()];
        pairs.iter().flatten().for_each(|x| has_row[*x] = true);
        let most = |places: &mut dyn Iterator<Item = (usize, f64)>| {
            places.reduce(|best, place| if place.1 > best.1 { place } else { best }).map(|(place, _)| place)
        };
        let mut all: Vec<(usize, usize)> = pairs.iter().enumerate().filter_map(|(y, x)| Some((y, (*x)?))).collect();
        for y in (0..pairs.len()).filter(|&y| pairs[y].is_none() && self.tracked_blobs[y].may_merge()) {
            all.extend(most(&mut shares.row(y)).map(|x| (y, x)));
        }
        let by_blob = shares.turned();
        for x in (0..has_row.len()).filter(|&x| !has_row[x]) {
            all.extend(most(&mut by_blob.row(x)).map(|y| (y, x)));
        }
        self.add_links(all);
    }

    /// Links tracks that overlap nothing with the nearest unmatched blob.
    fn link_nearest(&mut self, clip: &Clip, max_distance: f64) -> Result<(), Error> {
        let left: Vec<usize> = (0..self.blobs.len()).filter(|x| self.links[1][*x].is_empty()).collect();
        let detections: Vec<Detection> = left.iter().map(|x| self.blobs[*x].detection).collect();
        let around = |at: [f64; 2]| [at.map(|c| c - max_distance), at.map(|c| c + max_distance)];
        let places = BoxIndex::new(detections.iter().map(|found| around(found.center.map(f64::from))));
        let (mut near, mut found) = (Pairs::new(left.len()), Vec::new());
        for (y, tracked) in self.tracked_blobs.iter().enumerate() {
            if y.is_multiple_of(TRACKS_PER_CHECK) {
                clip.wanted()?;
            }
            found.clear();
            if self.links[0][y].is_empty() {
                let far = |i: usize| Some(self.distance(y, left[i])).filter(|far| *far <= max_distance);
                places.touching([tracked.center(); 2], &mut found, far);
            }
            let is_cut = nearest(&mut found, tracked.center(), (&detections, MOST_NEAR));
            near.push(found.iter().copied());
            self.crowded += usize::from(is_cut);
        }
        let pairs = nearest_first(&near).into_iter().enumerate();
        self.add_links(pairs.filter_map(|(y, i)| Some((y, left[i?]))).collect());
        Ok(())
    }

    /// Adds links, each only once.
    fn add_links(&mut self, all: Vec<(usize, usize)>) {
        for (row, column) in all {
            let [rows, columns] = &mut self.links;
            for (links, other) in [(&mut rows[row], column), (&mut columns[column], row)] {
                if let Err(place) = links.binary_search(&other) {
                    links.insert(place, other);
                }
            }
        }
    }

    /// Returns the connected rows and columns, by their first row; a row without columns is alone.
    pub fn parts(&self) -> Vec<(Vec<usize>, Vec<usize>)> {
        let [of_row, of_column] = &self.links;
        let (mut is_done, mut is_seen, mut parts) =
            (vec![false; of_row.len()], vec![false; of_column.len()], Vec::new());
        for first in 0..of_row.len() {
            if is_done[first] {
                continue;
            }
            let (mut rows, mut columns) = (vec![first], Vec::new());
            is_done[first] = true;
            let mut next = 0;
            while let Some(&row) = rows.get(next) {
                next += 1;
                for &x in of_row[row].iter().filter(|x| !std::mem::replace(&mut is_seen[**x], true)) {
                    columns.push(x);
                    rows.extend(of_column[x].iter().filter(|y| !std::mem::replace(&mut is_done[**y], true)));
                }
            }
            rows.sort_unstable();
            columns.sort_unstable();
            parts.push((rows, columns));
        }
        parts
    }
}

impl TrackedBlob {
    /// Returns the centre in px: of a single track the predicted one, of a group that of its box.
    pub fn center(&self) -> [f64; 2] {
        match &self.members[..] {
            [member] => member.center,
            _ => self.bounds.center().map(f64::from),
        }
    }

    /// Returns whether it may merge: confirmed and matched in the previous frame.
    fn may_merge(&self) -> bool {
        self.members.iter().any(|member| member.age.status == TrackStatus::Confirmed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::tracking::blob_tracker::Member;
    use crate::methods::multi_object::{lifecycle::TrackAge, partial::WholeSize};

    fn bounds(x: f32, width: f32) -> Bounds {
        Bounds { min: [x, 0.0], max: [x + width, 10.0] }
    }

    fn tracked((x, width): (f32, f32)) -> TrackedBlob {
        let (bounds, age) =
            (bounds(x, width), TrackAge { hits: 9, missed: 0, status: TrackStatus::Confirmed, movement: None });
        let center = bounds.center().map(f64::from);
        let found = Detection { bounds, center: bounds.center(), score: 1.0, blob: None, deviation_px: None };
        let size = WholeSize::of(&found);
        let member = Member { id: 1, age, gray: None, area_px: 1.0, size, bounds, center, velocity: None };
        TrackedBlob { bounds, centers: vec![center], members: vec![member] }
    }

    fn blob((x, width): (f32, f32)) -> Blob {
        let bounds = bounds(x, width);
        let detection = Detection { bounds, center: bounds.center(), score: 1.0, blob: None, deviation_px: None };
        Blob::new(detection, None, 1.0)
    }

    fn table(tracked_blobs: Vec<TrackedBlob>, blobs: &[(f32, f32)]) -> Correspondence {
        let clip = Clip::blank("a row", (100, 10), 2);
        let blobs = blobs.iter().copied().map(blob).collect();
        Correspondence::new(&clip, (tracked_blobs, blobs), (0.3, 30.0)).expect("it is wanted")
    }

    /// The parts of boxes in a row, each given by its left edge and its width.
    fn parts(tracked_blobs: &[(f32, f32)], blobs: &[(f32, f32)]) -> Vec<(Vec<usize>, Vec<usize>)> {
        table(tracked_blobs.iter().copied().map(tracked).collect(), blobs).parts()
    }

    #[test]
    fn tracks_continue_merge_split_and_are_missed() {
        let (a, b) = ((0.0, 10.0), (12.0, 10.0));
        assert_eq!(parts(&[a, b], &[(13.0, 10.0), (1.0, 10.0)]), [(vec![0], vec![1]), (vec![1], vec![0])]);
        assert_eq!(parts(&[a, b], &[(0.0, 22.0)]), [(vec![0, 1], vec![0])]);
        assert_eq!(parts(&[(0.0, 22.0)], &[a, b]), [(vec![0], vec![0, 1])]);
        // Boxes that cross each other still have a blob each.
        assert_eq!(parts(&[a, (4.0, 10.0)], &[(3.0, 10.0), (1.0, 10.0)]), [(vec![0], vec![1]), (vec![1], vec![0])]);
        // Without overlap the nearest blob within 30 px is taken, each at most once.
        assert_eq!(parts(&[a, (70.0, 10.0)], &[(25.0, 10.0)]), [(vec![0], vec![0]), (vec![1], vec![])]);
        assert_eq!(parts(&[a], &[(45.0, 10.0)]), [(vec![0], vec![])]);
    }

    #[test]
    fn a_coasting_track_does_not_merge() {
        let mut coasting = tracked((2.0, 10.0));
        coasting.members[0].age = TrackAge { hits: 9, missed: 2, status: TrackStatus::Coasting, movement: None };
        let table = table(vec![tracked((0.0, 10.0)), coasting], &[(0.0, 10.0)]);
        assert_eq!(table.parts(), [(vec![0], vec![0]), (vec![1], vec![])]);
    }

    #[test]
    fn gray_is_the_mean_of_the_pixels_in_the_box() {
        let picture = Grid::from_fn(6, 4, |x, y| (10 * x + y) as u8);
        let all = Bounds { min: [-9.0; 2], max: [99.0; 2] };
        // A single box is summed directly; for many boxes the integral image is computed.
        for boxes in [vec![], vec![all; 9]] {
            let grays = BoxMeans::new(&picture, boxes.iter());
            let of = |min, max| grays.mean(&Bounds { min, max });
            assert_eq!(grays.sums.is_some(), !boxes.is_empty());
            assert_eq!(of([0.5, -0.5], [2.5, 1.5]), Some(15.5));
            assert_eq!(grays.mean(&all), Some(26.5));
            assert_eq!((of([7.0, 0.0], [9.0, 2.0]), of([-9.0, 0.0], [-1.0, 2.0])), (None, None));
        }
    }
}
