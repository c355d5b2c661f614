//! Explanations and drawings shared by all motion segmentations: labels, segments, the plane of displacements, conclusions.

use std::sync::Arc;

use super::points::{Place, Points};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::products::segments::{Overlap, adjusted_rand_index, mean_overlap};
use crate::products::{Segment, SegmentFrame};
use crate::scene::{Arrow, Picture, Plane, Readout, Role, Scene, Shape, Step, Unit};

crate::variables! { pub mod value;
    /// The frame that is segmented.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The frame to which the flow leads.
    NEXT_FRAME: "", "t + 1", Unit::WHOLE;
    /// The method that gives the flow or the trajectories.
    METHOD: "Method", "", Unit::WHOLE;
    /// The inspected pixel.
    PIXEL: "Pixel", "", Unit::WHOLE, Role::Reference;
    /// The displacement of the inspected pixel.
    DISPLACEMENT: "Displacement", "(u, v)", Unit::SPEED, Role::Measured;
    /// The number of segments.
    SEGMENTS: "Segments", "", Unit::count("segment"), Role::Result;
    /// A segment: its label, mean displacement and area.
    SEGMENT: "Segment", "", Unit::WHOLE, Role::Result;
    /// The label of the segment of the most pixels.
    DOMINANT: "Dominant segment", "", Unit::WHOLE;
    /// The mean displacement of the dominant segment.
    DOMINANT_MOTION: "Dominant motion", "", Unit::SPEED;
    /// The share of the picture that the dominant segment covers.
    DOMINANT_SHARE: "Share of the dominant segment", "", Unit::PERCENT;
    /// The adjusted Rand index against the true labels.
    RAND_INDEX: "Adjusted Rand index", "", Unit::RATIO;
    /// The mean overlap with the true segments.
    OVERLAP: "Mean overlap", "", Unit::RATIO;
}

crate::cases! { pub over value;
    FLOW: "{method} gives the flow from frame {frame} to {next_frame}.",
    NO_SEGMENT: "No pixel has a known flow, so there is no segment.",
    ONE_SEGMENT: "One segment holds all pixels of known flow and moves by {dominant_motion}: no other motion stands out in this \
                  flow.",
    SEGMENTS: "{segments}. The dominant motion is that of segment {dominant}: {dominant_motion}, {dominant_share} of the \
               picture, usually the background.",
    AGAINST_TRUTH: "Against the true labels: adjusted Rand index {rand_index}, mean overlap {overlap}.",
}

/// Points shown in the plane of displacements at most.
const SHOWN: usize = 400;
/// Segments listed at most.
const LISTED: usize = 8;

/// Draws the flow that is segmented.
pub fn draw_flow(scene: &mut Scene, flow: &Flow) {
    scene.draw(
        Picture::CURRENT,
        (Role::Result, "flow to frame t+1"),
        Shape::Flow { origin: [0.0; 2], values: flow.0.clone() },
    );
}

/// Draws labels, each in its colour.
pub fn draw_labels(scene: &mut Scene, labels: Arc<Grid<u32>>, meaning: &'static str) {
    scene.draw(Picture::CURRENT, (Role::Best, meaning), Shape::Labels(labels));
}

/// Draws segments with their numbers and the arrows of their mean displacements, which the facts give in numbers.
pub fn draw_segments(scene: &mut Scene, frame: &SegmentFrame) {
    draw_labels(scene, Arc::clone(&frame.labels), "segments, one colour each");
    let places = innermost(&frame.labels);
    for Segment { label, center, displacement, .. } in &frame.segments {
        let from = places.get(*label as usize).copied().unwrap_or(*center);
        let to = [0, 1].map(|i| from[i] + displacement[i]);
        scene.mark_of(*label, Picture::CURRENT, Role::Result, Shape::Arrows(vec![Arrow { from, to }]));
        scene.mark_of(*label, Picture::CURRENT, Role::Result, Shape::Text { at: from, text: label.to_string() });
    }
    scene.legend(Role::Result, "mean displacement of a segment");
}

/// The pixel of each label that is farthest from other labels, by the city-block distance: the centre of a segment may lie outside it.
fn innermost(labels: &Grid<u32>) -> Vec<[f32; 2]> {
    let (width, height) = labels.size();
    let mut distances = Grid::new(width, height, 0u32);
    let nearer = |distances: &Grid<u32>, (x, y): (usize, usize), neighbours: [(usize, usize); 2]| {
        let of = |place: (usize, usize)| match labels.get(place.0, place.1) {
            Some(label) if *label == labels[(x, y)] => distances[place],
            _ => 0,
        };
        1 + neighbours.map(of).into_iter().min().unwrap_or(0)
    };
    for y in 0..height {
        for x in 0..width {
            distances[(x, y)] = nearer(&distances, (x, y), [(x.wrapping_sub(1), y), (x, y.wrapping_sub(1))]);
        }
    }
    let most = labels.cells().iter().copied().max().unwrap_or(0) as usize;
    let mut best = vec![(0, [0.0; 2]); most + 1];
    for y in (0..height).rev() {
        for x in (0..width).rev() {
            let distance = nearer(&distances, (x, y), [(x + 1, y), (x, y + 1)]).min(distances[(x, y)]);
            distances[(x, y)] = distance;
            let of_label = &mut best[labels[(x, y)] as usize];
            if distance > of_label.0 {
                *of_label = (distance, [x as f32, y as f32]);
            }
        }
    }
    best.into_iter().map(|(_, place)| place).collect()
}

/// Adds the result of frame `t`: its segments, the largest first, the dominant motion, and the agreement with the true labels.
pub fn conclude(step: Step, clip: &Clip, t: usize, frame: &SegmentFrame) -> Step {
    let mut step = step.fact(value::SEGMENTS, frame.segments.len());
    let mut all: Vec<&Segment> = frame.segments.iter().collect();
    all.sort_by_key(|segment| std::cmp::Reverse(segment.area));
    for segment in all.iter().take(LISTED) {
        step = step.fact(value::SEGMENT, format!("{}: {}", segment.label, segment.described()));
        if let Some(Readout::Facts(facts)) = step.readouts.first_mut()
            && let Some(fact) = facts.last_mut()
        {
            fact.of = Some(segment.label);
        }
    }
    let Some(dominant) = frame.segments.iter().find(|segment| segment.is_dominant) else {
        return step.say(case::NO_SEGMENT);
    };
    let share = 100.0 * dominant.area as f64 / frame.labels.cells().len() as f64;
    let step = step.put(value::DOMINANT, dominant.label).put(value::DOMINANT_SHARE, share);
    let step = step.put(value::DOMINANT_MOTION, dominant.displacement);
    let step = step.say(if frame.segments.len() == 1 { case::ONE_SEGMENT } else { case::SEGMENTS });
    match scores(clip, t, frame) {
        Some([index, overlap]) => {
            step.put(value::RAND_INDEX, index).put(value::OVERLAP, overlap).say(case::AGAINST_TRUTH)
        }
        None => step,
    }
}

/// Adjusted Rand index and mean overlap against the true labels of frame `t`, if they are known.
pub fn scores(clip: &Clip, t: usize, frame: &SegmentFrame) -> Option<[f64; 2]> {
    // Unreadable truth is reported where the product is assessed.
    let truth = clip.truth()?.segments(t).ok().flatten()?;
    let overlap = (truth.size() == frame.labels.size()).then(|| Overlap::of(&truth, &frame.labels))?;
    Some([adjusted_rand_index(&overlap), mean_overlap(&overlap)])
}

/// The names of means in the plane of displacements, by their index.
pub fn mean_name(index: usize) -> &'static str {
    const NAMES: [&str; 16] = [
        "mean 1", "mean 2", "mean 3", "mean 4", "mean 5", "mean 6", "mean 7", "mean 8", "mean 9", "mean 10", "mean 11",
        "mean 12", "mean 13", "mean 14", "mean 15", "mean 16",
    ];
    NAMES.get(index).copied().unwrap_or("a further mean")
}

/// The plane of displacements with a sample of the points, each in the colour of its group, and places with names. `first` is the coordinate
/// that is u.
pub fn plane(
    (points, first): (&Points, usize),
    group: impl Fn(usize) -> u32,
    named: &[(&'static str, Role, Place)],
    path: &[Place],
) -> Readout {
    let (sample, indices) = points.sampled(SHOWN);
    let displacement = |place: &Place| [place[first], place[first + 1]];
    let groups: Vec<(u32, [f32; 2])> =
        indices.iter().enumerate().map(|(i, index)| (group(*index), displacement(&sample.at(i)))).collect();
    let points: Vec<_> = named.iter().map(|(name, role, place)| (*name, *role, displacement(place))).collect();
    let path: Vec<[f32; 2]> = path.iter().map(displacement).collect();
    let (center, reach) = window(groups.iter().map(|(_, uv)| *uv), points.iter().map(|(.., uv)| *uv));
    Readout::Plane(Plane {
        title: "Displacements",
        unit: "px/frame".into(),
        center,
        reach,
        cost: None,
        groups,
        lines: Vec::new(),
        path,
        points,
        ellipse: None,
    })
}

/// The middle and the reach of a window on all named displacements and on all of the sample but its farthest hundredth.
fn window(sample: impl Iterator<Item = [f32; 2]>, named: impl Iterator<Item = [f32; 2]>) -> ([f32; 2], f32) {
    const LEAST: f32 = 0.5;
    let sample: Vec<[f32; 2]> = sample.collect();
    let named: Vec<[f32; 2]> = named.collect();
    let ends = [0, 1].map(|i| {
        let mut values: Vec<f32> = sample.iter().map(|uv| uv[i]).collect();
        values.sort_by(f32::total_cmp);
        let out = values.len() / 100;
        let inner = values.get(out..values.len() - out).unwrap_or_default();
        let all = inner.first().into_iter().chain(inner.last()).copied().chain(named.iter().map(|uv| uv[i]));
        all.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    });
    if !ends.iter().flatten().all(|end| end.is_finite()) {
        return ([0.0; 2], LEAST);
    }
    let reach = ends.iter().map(|[low, high]| (high - low) / 2.0).fold(LEAST, f32::max);
    (ends.map(|[low, high]| (low + high) / 2.0), 1.15 * reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_stands_inside_its_segment_where_the_centre_is_outside() {
        // A frame of label 1 around a square of label 2.
        let labels = Grid::from_fn(21, 21, |x, y| if (6..15).contains(&x) && (6..15).contains(&y) { 2 } else { 1 });
        let places = innermost(&labels);
        let label_at = |[x, y]: [f32; 2]| labels[(x as usize, y as usize)];
        assert_eq!([label_at(places[1]), label_at(places[2])], [1, 2]);
        assert_eq!(places[2], [10.0, 10.0]);
    }
}
