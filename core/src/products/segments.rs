//! Segments: the pixels of each frame that move together.

mod score;

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::{Assessment, Cell, Figure, Measure, Motion, Product, ProductKind, Reference, Table};
use crate::base::{Error, words};
use crate::data::Flow;
use crate::geometry::Grid;

pub use score::{Overlap, adjusted_rand_index, mean_overlap};

/// The measures of segments against the truth: of each frame, averaged over frames.
const MEASURES: [Measure; 2] = [
    Measure::new(
        "adjusted_rand_index",
        "Adjusted Rand index of the labels: the share of pairs of pixels on whose being together both agree, corrected for chance. 1 is \
         the true segmentation, 0 a random one. Pixels without a true label are left out.",
    )
    .in_column("ARI", 3).larger_is_better()
    .against_truth(),
    Measure::new(
        "mean_overlap",
        "Mean intersection over union of the true segments and the found ones, paired one to one so that the sum is largest. A true \
         segment without a partner counts 0.",
    )
    .in_column("mean overlap", 3).larger_is_better()
    .against_truth(),
];

/// The affine motion of a segment: a pixel (x, y) moves by (a₁ + a₂ x + a₃ y, a₄ + a₅ x + a₆ y) px/frame.
pub type AffineMotion = [f64; 6];

/// A segment of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Its label, from 1 on; the same in every frame in which it is found again.
    pub label: u32,
    /// Number of its pixels.
    pub area: usize,
    /// Centre of its pixels in px.
    pub center: [f32; 2],
    /// Mean displacement of its pixels in px/frame.
    pub displacement: [f32; 2],
    /// Its affine motion, if the method fits one.
    pub affine: Option<AffineMotion>,
    /// Whether its motion is the dominant one, that of the most pixels: usually the background.
    pub is_dominant: bool,
}

/// The segments of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentFrame {
    /// The label of each pixel; 0 for pixels of none, such as those of unknown flow.
    pub labels: Arc<Grid<u32>>,
    /// The segments in ascending order of their labels.
    pub segments: Vec<Segment>,
}

/// The segments of frame after frame.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame.
    pub first: usize,
    /// The results frame by frame.
    pub frames: Vec<Arc<SegmentFrame>>,
}

impl SegmentFrame {
    /// Measures the segments of `labels` in a flow. `affine` gives the affine motion of a label, if there is one.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn measure(labels: Grid<u32>, flow: &Flow, affine: impl Fn(u32) -> Option<AffineMotion>) -> Self {
        assert_eq!(labels.size(), flow.0.size(), "labels and flow of one size");
        let most = labels.cells().iter().copied().max().unwrap_or(0) as usize;
        let mut sums = vec![(0usize, [0.0f64; 4]); most + 1];
        for y in 0..labels.height() {
            for (x, (label, [u, v])) in labels.row(y).iter().zip(flow.0.row(y)).enumerate() {
                let (count, sum) = &mut sums[*label as usize];
                *count += 1;
                let uv = [*u, *v].map(|c| if c.is_finite() { f64::from(c) } else { 0.0 });
                [x as f64, y as f64, uv[0], uv[1]].iter().zip(sum).for_each(|(value, sum)| *sum += value);
            }
        }
        let mut segments: Vec<Segment> = (1..=most)
            .filter(|label| sums[*label].0 > 0)
            .map(|label| {
                let (area, sum) = sums[label];
                let [x, y, u, v] = sum.map(|sum| (sum / area as f64) as f32);
                let affine = affine(label as u32);
                let (center, displacement) = ([x, y], [u, v]);
                Segment { label: label as u32, area, center, displacement, affine, is_dominant: false }
            })
            .collect();
        // The first of several of one size.
        if let Some(largest) = (0..segments.len()).rev().max_by_key(|i| segments[*i].area) {
            segments[largest].is_dominant = true;
        }
        Self { labels: Arc::new(labels), segments }
    }

    /// The segment with a label, if there is one.
    pub fn segment(&self, label: u32) -> Option<&Segment> {
        self.segments.iter().find(|segment| segment.label == label)
    }

    /// Size in memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(self.labels.cells()) + size_of_val(&self.segments[..])
    }
}

impl Segment {
    /// Its motion and area as text: `(2.00, −1.00) px/frame, 4321 px`.
    pub fn described(&self) -> String {
        let dominant = if self.is_dominant { ", dominant" } else { "" };
        format!("{} px/frame, {} px{dominant}", words::place(self.displacement), words::grouped(self.area))
    }
}

/// Renames the labels of a frame so that each segment keeps the label that it has in the previous frame: the pixels of `before` are
/// moved by their flow, and labels are paired so that they share the most pixels. Segments without a partner get labels that no
/// segment had so far, from `*unused` on.
///
/// # Panics
/// If the sizes differ.
pub(crate) fn relabel(labels: &Grid<u32>, before: Option<(&Grid<u32>, &Flow)>, unused: &mut u32) -> Grid<u32> {
    let most = labels.cells().iter().copied().max().unwrap_or(0) as usize;
    let mut names = vec![0u32; most + 1];
    if let Some((known, flow)) = before {
        let moved = carried(known, flow);
        let overlap = Overlap::of(labels, &moved);
        for (label, partner) in overlap.pairs_by_shared_pixels() {
            names[label as usize] = partner;
        }
    }
    let is_used = |label: usize| labels.cells().contains(&(label as u32));
    for (label, name) in names.iter_mut().enumerate().skip(1) {
        if *name == 0 && is_used(label) {
            *name = *unused;
            *unused += 1;
        }
    }
    labels.map(|label| names[*label as usize])
}

/// The labels of a frame, each moved by the flow of its pixel to the nearest pixel of the next frame; 0 where none arrives.
fn carried(labels: &Grid<u32>, flow: &Flow) -> Grid<u32> {
    let (width, height) = labels.size();
    let mut moved = Grid::new(width, height, 0);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let Some([u, v]) = flow.at(x, y) else { continue };
        if let Some(to) = moved.cell_at([x as f32 + u, y as f32 + v]) {
            moved[to] = labels[(x, y)];
        }
    }
    moved
}

impl SegmentField {
    /// The mean of both measures over the frames with true labels; `None` where there are none.
    fn scored(&self, reference: &Reference<'_>) -> Result<Option<[f64; 2]>, Error> {
        let Some(truth) = reference.clip.truth() else { return Ok(None) };
        let (mut sums, mut count) = ([0.0; 2], 0usize);
        for (i, frame) in self.frames.iter().enumerate() {
            reference.clip.wanted()?;
            let Some(truth) = truth.segments(self.first + i)?.filter(|truth| truth.size() == self.picture) else {
                continue;
            };
            let overlap = Overlap::of(&truth, &frame.labels);
            sums[0] += adjusted_rand_index(&overlap);
            sums[1] += mean_overlap(&overlap);
            count += 1;
        }
        Ok((count > 0).then(|| sums.map(|sum| sum / count as f64)))
    }
}

impl Product for SegmentField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "segments",
        name: "Motion segments",
        summary: "The pixels of each frame that move together, with the motion of each segment.",
        motion: Motion::Nowhere,
        is_of_single_frames: true,
        has_pictures: false,
        measures: &[&MEASURES],
    };

    /// A row for each segment of each frame: label, area, centre, mean displacement, affine motion.
    fn table(&self) -> Option<Table> {
        let numbered = self.frames.iter().enumerate();
        let all = numbered.flat_map(|(i, frame)| frame.segments.iter().map(move |segment| (self.first + i, segment)));
        let row = |(t, segment): (usize, &Segment)| -> [Cell; 14] {
            let ([x, y], [u, v]) = (segment.center, segment.displacement);
            let affine = [0, 1, 2, 3, 4, 5].map(|i| Cell::from(segment.affine.map(|affine| affine[i])));
            let [a, b, c, d, e, f] = affine;
            let dominant = Cell::from(usize::from(segment.is_dominant));
            let (label, area) = (segment.label.into(), segment.area.into());
            [t.into(), label, area, x.into(), y.into(), u.into(), v.into(), a, b, c, d, e, f, dominant]
        };
        let columns = [
            "frame", "label", "area_px", "x_px", "y_px", "u_px", "v_px", "a1_px", "a2", "a3", "a4_px", "a5", "a6",
            "dominant",
        ];
        Some(Table::new(columns, all.map(row)))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let scored = self.scored(reference);
        reference.clip.wanted()?;
        let count = self.frames.last().map_or(0, |frame| frame.segments.len());
        let own = Assessment {
            headline: words::counted(count, "segment"),
            facts: vec![fact("Segments", count.to_string())],
            ..Assessment::default()
        };
        Ok(match scored {
            Ok(None) => own,
            Ok(Some(values)) => {
                let [index, overlap] = values.map(|value| words::fixed(value, 3));
                let facts = vec![fact("Adjusted Rand index", index.clone()), fact("Mean overlap", overlap)];
                let headline = format!("{}, adjusted Rand index {index}", own.headline);
                Assessment { headline, ..own }.with(scores(&MEASURES, values.map(Figure::from)), facts)
            }
            Err(error) => Assessment { truth_error: Some(error), ..own },
        })
    }

    fn last_frame(&self) -> Option<usize> {
        Some(self.first + self.frames.len().saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn halves(width: usize, at: usize, labels: [u32; 2]) -> Grid<u32> {
        Grid::from_fn(width, 4, |x, _| labels[usize::from(x >= at)])
    }

    #[test]
    fn a_segment_keeps_its_label_while_its_pixels_move_on() {
        let still = Flow(Grid::new(12, 4, [0.0; 2]));
        let mut unused = 1;
        let first = relabel(&halves(12, 5, [1, 2]), None, &mut unused);
        assert_eq!((unused, first[(0, 0)], first[(11, 0)]), (3, 1, 2));
        // The method numbers them the other way round.
        let next = relabel(&halves(12, 6, [2, 1]), Some((&first, &still)), &mut unused);
        assert_eq!((unused, next[(0, 0)], next[(11, 0)]), (3, 1, 2));
        // A third segment has a new label, and a pixel of none stays so.
        let thirds = Grid::from_fn(12, 4, |x, _| [3, 1, 2, 0][x / 3]);
        let third = relabel(&thirds, Some((&next, &still)), &mut unused);
        assert_eq!(unused, 4);
        assert_eq!([third[(7, 0)], third[(11, 0)]], [2, 0]);
        // Two of them share equally many pixels with the first.
        let mut halves = [third[(0, 0)], third[(4, 0)]];
        halves.sort_unstable();
        assert_eq!(halves, [1, 3]);
    }

    #[test]
    fn labels_travel_with_their_flow() {
        let flow = Flow(Grid::new(6, 4, [2.0, 0.0]));
        let moved = carried(&halves(6, 3, [1, 2]), &flow);
        assert_eq!(moved.row(1), [0, 0, 1, 1, 1, 2]);
    }

    #[test]
    fn a_segment_is_measured_by_its_pixels() {
        let flow = Flow(Grid::from_fn(8, 4, |x, _| if x < 2 { [3.0, -1.0] } else { [0.5, 0.0] }));
        let frame = SegmentFrame::measure(halves(8, 2, [1, 2]), &flow, |_| None);
        let [small, large] = &frame.segments[..] else { panic!("two segments") };
        assert_eq!((small.area, small.center, small.displacement), (8, [0.5, 1.5], [3.0, -1.0]));
        assert_eq!((large.area, large.displacement), (24, [0.5, 0.0]));
        assert_eq!((small.is_dominant, large.is_dominant), (false, true));
    }
}
