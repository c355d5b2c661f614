//! The steps of flow segmentation in words, numbers and marks.

use std::sync::Arc;

use super::{Absorbed, Comparison, Data, Event, FlowSegmentation, Growth, PARTS, Part, Region, line};
use crate::geometry::Grid;
use crate::methods::differential::field;
use crate::methods::segmentation::explain::{
    case as shared_case, conclude, draw_labels, draw_segments, plane, value as shared,
};
use crate::methods::segmentation::forest::Forest;
use crate::methods::segmentation::{Place, Points, SegmentationRun};
use crate::run::Seen;
use crate::scene::{Name, Picture, Readout, Role, Scene, Series, Shape, Step, Unit};
use crate::{cases, variables};

/// A difference of displacements or a limit of it.
const DIFFERENCE_UNIT: Unit = Unit::new("px/frame", 4);

variables! {
    /// The number of edges between neighbouring pixels.
    EDGES: "Edges", "", Unit::count("edge"), Role::Measured;
    /// The largest difference of displacements in a part of the edges.
    UP_TO: "Differences up to", "", DIFFERENCE_UNIT;
    /// The number of merges in a part of the edges.
    MERGES: "Merges", "", Unit::count("merge"), Role::Best;
    /// The number of merges refused in a part of the edges.
    REFUSALS: "Refusals", "", Unit::count(""), Role::Rejected;
    /// The number of regions.
    REGIONS: "Regions", "", Unit::count("region"), Role::Result;
    /// The area of the one region in px.
    AREA_A: "", "|A|", Unit::count("");
    /// The area of the other region in px.
    AREA_B: "", "|B|", Unit::count("");
    /// The difference of the displacements across the edge.
    DIFFERENCE: "Difference", r"|\Delta w|", DIFFERENCE_UNIT;
    /// The largest edge merged within the one region.
    INTERNAL_A: "", r"\text{Int}(A)", DIFFERENCE_UNIT;
    /// The largest edge merged within the other region.
    INTERNAL_B: "", r"\text{Int}(B)", DIFFERENCE_UNIT;
    /// The scale of graph-based merging.
    SCALE: "Scale", "k", Unit::new("", 1);
    /// The limit of the difference for the one region.
    LIMIT_A: "", "", DIFFERENCE_UNIT;
    /// The limit of the difference for the other region.
    LIMIT_B: "", "", DIFFERENCE_UNIT;
    /// The smaller of both limits.
    LIMIT: "Limit", "", DIFFERENCE_UNIT;
    /// The first pixel of a growing region.
    SEED: "First pixel", "", Unit::WHOLE;
    /// The area of a region that has grown.
    AREA: "Area", "", Unit::new("px", 0), Role::Result;
    /// The mean displacement of a region.
    MEAN: "Mean displacement", "", Unit::SPEED, Role::Measured;
    /// The largest difference of a pixel from the mean of its region.
    TOLERANCE: "Tolerance", "", Unit::SPEED;
    /// The number of comparisons with a neighbour that was too different.
    COMPARISONS: "Comparisons refused", "", Unit::count("comparison");
    /// The number of merges of small regions.
    ABSORBED: "Merges of small regions", "", Unit::count("merge"), Role::Rejected;
    /// The smallest share of the picture that a region covers.
    MIN_AREA: "Smallest area", "", Unit::PERCENT;
}

cases! { pub(super) over value, shared;
    OPENING: "Within a rigid surface the flow changes smoothly from pixel to pixel; at its outline it jumps. Regions between the \
              jumps are segments, whatever the shape of their motion.",
    SORTED: "{edges} between neighbours are sorted by the difference of their displacements, so that similar pixels are merged \
             before a jump is met.",
    MERGED: "Edges up to {up_to}: {merges}, {refusals} refused, {regions}.",
    REFUSAL: "The largest refusal: regions of {area_a} and {area_b} px differ by {difference:bare} across their edge, above the \
              smaller limit {limit:bare}, so this is a jump.",
    MERGE: "The largest merge: regions of {area_a} and {area_b} px differ by {difference:bare} across their edge, within the \
            smaller limit {limit:bare}.",
    WITHIN: "All of these edges lie within regions.",
    GROWN: "From pixel {seed} a region grows to {area} with the mean displacement {mean}. It stops where neighbours differ from \
            the mean by more than {tolerance}, in {comparisons}.",
    ABSORBED: "{absorbed} of a region of less than {min_area} of the picture with a neighbour; such regions lie along jumps that \
               the flow smooths. {regions} in all.",
    LABELLED: "Frame {frame} is segmented along its jumps:",
    CONNECTED: "Regions are connected, so parts of one object on both sides of another are two segments.",
}

/// The frame's flow and edges, once they are computed.
fn data<'a>(seen: &'a Seen<SegmentationRun<FlowSegmentation>>) -> Option<&'a Arc<Data>> {
    let new = seen.events.iter().find_map(|event| match event {
        Event::Flow(data) => Some(data),
        _ => None,
    });
    new.or(seen.before.data.as_ref())
}

/// The regions at the cursor.
fn forest<'a>(seen: &'a Seen<SegmentationRun<FlowSegmentation>>) -> &'a Forest {
    let merged = seen.events.iter().rev().find_map(|event| match event {
        Event::Merged(_, forest) | Event::Absorbed(Absorbed { forest, .. }) => Some(&**forest),
        _ => None,
    });
    merged.unwrap_or(&seen.before.forest)
}

/// The regions that have grown in this unit, up to the cursor.
fn grown<'a>(seen: &'a Seen<SegmentationRun<FlowSegmentation>>) -> impl DoubleEndedIterator<Item = &'a Region> {
    seen.events.iter().filter_map(|event| match event {
        Event::Grown(region) => Some(&**region),
        _ => None,
    })
}

fn pixel_of(data: &Data, pixel: usize) -> (usize, usize) {
    (pixel % data.flow.0.width(), pixel / data.flow.0.width())
}

impl FlowSegmentation {
    pub(super) fn explain_step(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        let Some(event) = seen.events.last() else { return Step::at(line::EACH_FRAME).say(case::OPENING) };
        let (step, data) = (self.tell_event(seen, event), data(seen));
        let point = data.and_then(|data| {
            let (x, y) = data.flow.0.cell_at(seen.point()?)?;
            Some(((x, y), data.flow.at(x, y)?))
        });
        let step = step.fact_if(shared::PIXEL, point.map(|(pixel, _)| pixel));
        let step = step.fact_if(shared::DISPLACEMENT, point.map(|(_, uv)| uv));
        step.show_all(data.map(|data| displacements(seen, data, point.map(|(_, uv)| uv)))).show_all(self.plot(seen))
    }

    fn tell_event(&self, seen: &Seen<SegmentationRun<Self>>, event: &Event) -> Step {
        let t = seen.before.record.frame();
        let at = |line: Name| Step::at(line).fact(shared::FRAME, t);
        let edges = data(seen).map_or(0, |data| data.edges.len());
        match event {
            Event::Flow(_) => {
                let step = at(line::FIND_FLOW).fact(value::EDGES, edges).put(shared::METHOD, self.input.name());
                step.put(shared::NEXT_FRAME, t + 1).say(shared_case::FLOW)
            }
            Event::Sorted(count) => at(line::SORT).fact(value::EDGES, *count).say(case::SORTED),
            Event::Merged(part, _) => self.tell_merges(at(line::MERGE), part),
            Event::Grown(region) => {
                let seed = data(seen).map_or((0, 0), |data| pixel_of(data, region.seed));
                let step = at(line::GROW).fact(value::AREA, region.pixels.len()).put(value::SEED, seed);
                let step = step.put(value::MEAN, region.mean).put(value::TOLERANCE, self.tolerance);
                step.put(value::COMPARISONS, region.refused).say(case::GROWN)
            }
            Event::Absorbed(Absorbed { merges, left, .. }) => {
                let step = at(line::ABSORB).fact(value::REGIONS, *left).put(value::ABSORBED, *merges);
                step.put(value::MIN_AREA, self.min_area).say(case::ABSORBED)
            }
            Event::Labelled(frame) => {
                conclude(at(line::LABEL).say(case::LABELLED), seen.clip, t, frame).say(case::CONNECTED)
            }
        }
    }

    /// Tells the result of a part of the edges, with the numbers of the largest refusal, or else of the largest merge.
    fn tell_merges(&self, step: Step, part: &Part) -> Step {
        let step = step.fact(value::MERGES, part.merged).fact(value::REFUSALS, part.refused);
        let step = step.fact(value::REGIONS, part.regions).put(value::UP_TO, part.up_to).say(case::MERGED);
        let (Comparison { weight, areas, limits }, role, sign, said) = match (&part.refusal, &part.merge) {
            (Some(refusal), _) => (refusal, Role::Rejected, ">", case::REFUSAL),
            (None, Some(merge)) => (merge, Role::Best, r"\le", case::MERGE),
            (None, None) => return step.say(case::WITHIN),
        };
        let internal = |i: usize| limits[i] - self.scale / areas[i] as f32;
        let step = step.put(value::AREA_A, areas[0]).put(value::AREA_B, areas[1]).put(value::SCALE, self.scale);
        let step = step.put(value::INTERNAL_A, internal(0)).put(value::INTERNAL_B, internal(1));
        let step = step.put(value::LIMIT_A, limits[0]).put(value::LIMIT_B, limits[1]);
        let step = step.put_value(value::DIFFERENCE.is(*weight).inked(role));
        let step = step.put(value::LIMIT, limits[0].min(limits[1])).say(said);
        let terms = r"{internal_a} + {scale} \, / \, {area_a}, {internal_b} + {scale} \, / \, {area_b}";
        step.formula(format!(r"|\Delta w| = {{difference}} {sign} \text{{min}}({terms})"))
            .formula(r"\text{min}({limit_a}, {limit_b})")
    }

    fn plot(&self, seen: &Seen<SegmentationRun<Self>>) -> Option<Readout> {
        let merged = match seen.events.last() {
            Some(Event::Merged(part, _)) => Some(part.regions as u32),
            _ => None,
        };
        let areas = grown(seen).map(|region| region.pixels.len() as u32);
        let values = seen.before.counts.iter().copied().chain(merged).chain(areas);
        let points: Vec<[f32; 2]> = values.enumerate().map(|(i, value)| [(i + 1) as f32, value as f32]).collect();
        if points.is_empty() {
            return None;
        }
        let (title, x_label, y_label, x_max) = match self.method {
            Growth::Graph => ("Number of regions", "part of the edges", "regions", PARTS),
            Growth::Growing => ("Area of the regions", "region", "px", points.len()),
        };
        let lines = vec![(title, Role::Result, points)];
        Some(Readout::Series(Series {
            is_logarithmic: true,
            decimals: Some(0),
            ..Series::new(title, [x_label, y_label], x_max, lines)
        }))
    }

    pub(super) fn draw_marks(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
        let Some((event, data)) = seen.events.last().zip(data(seen)) else { return };
        match event {
            Event::Flow(_) => field::draw(data.flow.0.clone(), scene),
            Event::Sorted(_) => {
                draw_jumps(scene, data);
            }
            Event::Merged(_, forest) | Event::Absorbed(Absorbed { forest, .. }) => draw_regions(scene, data, forest),
            Event::Grown(region) => {
                let mut earlier = Forest::clone(&seen.before.forest);
                grown(seen).rev().skip(1).for_each(|region| region.join(&mut earlier));
                draw_regions(scene, data, &earlier);
                let mut pixels = vec![false; data.flow.0.cells().len()];
                region.pixels.iter().for_each(|pixel| pixels[*pixel as usize] = true);
                let (width, height) = data.flow.0.size();
                let mask = crate::data::Mask::from_fn(width, height, |x, y| pixels[y * width + x]);
                scene.mark(Picture::CURRENT, Role::Result, Shape::Mask(Arc::new(mask)));
                let (x, y) = pixel_of(data, region.seed);
                scene.mark(Picture::CURRENT, Role::Candidate, Shape::Points(vec![[x as f32, y as f32]]));
                scene.legend(Role::Result, "new region");
                scene.legend(Role::Candidate, "its first pixel");
            }
            Event::Labelled(frame) => draw_segments(scene, frame),
        }
    }
}

/// Draws the regions of more than one pixel.
fn draw_regions(scene: &mut Scene, data: &Data, forest: &Forest) {
    let (width, height) = data.flow.0.size();
    // A region keeps its colour while its root stays.
    let label = |pixel: usize| {
        let root = forest.root_of(pixel as u32);
        if forest.area(root) > 1 && data.is_known(pixel) { root + 1 } else { 0 }
    };
    let labels = Grid::from_fn(width, height, |x, y| label(y * width + x));
    draw_labels(scene, Arc::new(labels), "regions of more than one pixel, one colour each");
}

/// Draws the difference of each pixel from its neighbours to the right and below.
fn draw_jumps(scene: &mut Scene, data: &Data) {
    let (width, height) = data.flow.0.size();
    let mut values = Grid::new(width, height, 0.0f32);
    for edge in &data.edges {
        let at = pixel_of(data, edge.ends[0] as usize);
        values[at] = values[at].max(edge.weight);
    }
    scene.mark(Picture::CURRENT, Role::Measured, Shape::heat(values));
    scene.heat = Some("|Δw|");
    scene.legend(Role::Measured, "difference from the neighbours in px/frame");
}

/// The displacements of the pixels in the colours of their regions.
fn displacements(seen: &Seen<SegmentationRun<FlowSegmentation>>, data: &Data, inspected: Option<[f32; 2]>) -> Readout {
    let cells = data.flow.0.cells();
    let forest = forest(seen);
    let step = (cells.len() / 4000).max(1);
    let known = (0..cells.len()).filter(|pixel| data.is_known(*pixel)).step_by(step);
    let (pixels, uv): (Vec<usize>, Vec<[f32; 2]>) = known.map(|pixel| (pixel, cells[pixel])).unzip();
    let points = Points::new([0, 1].map(|i| uv.iter().map(|uv| uv[i]).collect()).into());
    let named: Vec<(&'static str, Role, Place)> =
        inspected.into_iter().map(|[u, v]| ("inspected pixel", Role::Reference, [u, v, 0.0, 0.0, 0.0, 0.0])).collect();
    let labels = seen.events.iter().rev().find_map(|event| match event {
        Event::Labelled(frame) => Some(&frame.labels),
        _ => None,
    });
    let group = |point: usize| {
        let pixel = pixels[point];
        match labels {
            Some(labels) => labels.cells()[pixel],
            None if forest.is_empty() => 0,
            None => forest.root_of(pixel as u32) + 1,
        }
    };
    plane((&points, 0), group, &named, &[])
}
