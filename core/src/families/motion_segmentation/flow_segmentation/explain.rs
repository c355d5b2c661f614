//! The steps of flow segmentation in words, numbers and marks.

use std::sync::Arc;

use super::{Absorbed, Comparison, Data, Event, FlowSegmentation, Growth, PARTS, Part, Region, line};
use crate::base::words;
use crate::geometry::Grid;
use crate::methods::differential::field;
use crate::methods::numbers::{fixed, percent, px};
use crate::methods::segmentation::explain::{conclusion, draw_labels, draw_segments, plane, segment_facts};
use crate::methods::segmentation::forest::Forest;
use crate::methods::segmentation::{Place, Points, SegmentationRun};
use crate::run::Seen;
use crate::scene::{Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// A difference of displacements or a limit of it, in px/frame.
fn difference(value: f32) -> String {
    fixed(value.into(), 4)
}

/// The frame's flow and edges, where they are there.
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
    pub(super) fn explained_step(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Flow(_)) => line::FIND_FLOW,
            Some(Event::Sorted(_)) => line::SORT,
            Some(Event::Merged(..)) => line::MERGE,
            Some(Event::Grown(_)) => line::GROW,
            Some(Event::Absorbed(_)) => line::ABSORB,
            Some(Event::Labelled(_)) => line::LABEL,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<SegmentationRun<Self>>) -> Sentence {
        let (said, t) = (Sentence::default(), seen.before.record.frame());
        match seen.events.last() {
            None => said.text(
                "Within a rigid surface the flow changes smoothly from pixel to pixel; at its outline it jumps. Regions between the jumps \
                 are segments, whatever the shape of their motion.",
            ),
            Some(Event::Flow(_)) => {
                said.text(format!("{} gives the flow from frame {t} to {}.", self.input.name(), t + 1))
            }
            Some(Event::Sorted(count)) => said
                .ink(Role::Measured, format!("{} edges", words::grouped(*count)))
                .text(" between neighbours are sorted by the difference of their displacements, so that similar pixels are merged before a jump is met."),
            Some(Event::Merged(part, _)) => self.merged(part),
            Some(Event::Grown(region)) => self.grown(seen, region),
            Some(Event::Absorbed(Absorbed { merges, left, .. })) => said
                .ink(Role::Rejected, words::counted(*merges, "merge"))
                .text(format!(
                    " of a region of less than {} of the picture with a neighbour; such regions lie along jumps that the flow smooths. ",
                    percent(f64::from(self.min_area) / 100.0)
                ))
                .ink(Role::Result, words::counted(*left, "region"))
                .text(" in all."),
            Some(Event::Labelled(frame)) => said.text(format!(
                "Frame {t} is segmented along its jumps: {} Regions are connected, so parts of one object on both sides of another are two segments.",
                conclusion(seen.clip, t, frame)
            )),
        }
    }

    fn merged(&self, part: &Part) -> Sentence {
        let said = Sentence::default()
            .text(format!("Edges up to {} px/frame: ", difference(part.up_to)))
            .ink(Role::Best, words::counted(part.merged, "merge"))
            .text(", ")
            .ink(Role::Rejected, format!("{} refused", words::grouped(part.refused)))
            .text(", ")
            .ink(Role::Result, words::counted(part.regions, "region"))
            .text(". ");
        match (&part.merge, &part.refusal) {
            (_, Some(Comparison { weight, areas, limits })) => said.text(format!(
                "The largest refusal: regions of {} and {} px differ by {} across their edge, above the smaller limit {}, so this is a jump.",
                words::grouped(areas[0] as usize),
                words::grouped(areas[1] as usize),
                difference(*weight),
                difference(limits[0].min(limits[1]))
            )),
            (Some(Comparison { weight, areas, limits }), None) => said.text(format!(
                "The largest merge: regions of {} and {} px differ by {} across their edge, within the smaller limit {}.",
                words::grouped(areas[0] as usize),
                words::grouped(areas[1] as usize),
                difference(*weight),
                difference(limits[0].min(limits[1]))
            )),
            (None, None) => said.text("All of these edges lie within regions."),
        }
    }

    fn grown(&self, seen: &Seen<SegmentationRun<Self>>, region: &Region) -> Sentence {
        let at = data(seen).map_or((0, 0), |data| pixel_of(data, region.seed));
        Sentence::default()
            .text(format!("From pixel {} a region grows to ", words::pixel(at)))
            .ink(Role::Result, format!("{} px", words::grouped(region.pixels.len())))
            .text(" with the mean displacement ")
            .ink(Role::Measured, words::place(region.mean.map(|c| c as f32)))
            .text(format!(
                " px/frame. It stops where neighbours differ from the mean by more than {} px/frame, in {}.",
                px(self.tolerance.into()),
                words::counted(region.refused, "comparison")
            ))
    }

    fn readouts(&self, seen: &Seen<SegmentationRun<Self>>) -> Vec<Readout> {
        let Some(event) = seen.events.last() else { return Vec::new() };
        let mut facts = vec![Fact::new("Frame", seen.before.record.frame().to_string(), None)];
        let mut readouts = Vec::new();
        match event {
            Event::Labelled(frame) => facts.extend(segment_facts(frame)),
            Event::Merged(part, _) => {
                facts.push(Fact::new("Merges", words::grouped(part.merged), Some(Role::Best)));
                facts.push(Fact::new("Refusals", words::grouped(part.refused), Some(Role::Rejected)));
                facts.push(Fact::new("Regions", words::grouped(part.regions), Some(Role::Result)));
                let shown = part.refusal.as_ref().or(part.merge.as_ref());
                readouts.extend(shown.map(|comparison| Readout::Equation(self.equation(comparison))));
            }
            Event::Grown(region) => {
                facts.push(Fact::new(
                    "Area",
                    format!("{} px", words::grouped(region.pixels.len())),
                    Some(Role::Result),
                ));
            }
            Event::Absorbed(Absorbed { left, .. }) => {
                facts.push(Fact::new("Regions", words::grouped(*left), Some(Role::Result)))
            }
            Event::Flow(_) | Event::Sorted(_) => {
                let edges = data(seen).map_or(0, |data| data.edges.len());
                facts.push(Fact::new("Edges", words::grouped(edges), None));
            }
        }
        let point = data(seen).and_then(|data| {
            let (x, y) = data.flow.0.cell_at(seen.point()?)?;
            Some(((x, y), data.flow.at(x, y)?))
        });
        if let Some((pixel, uv)) = point {
            facts.push(Fact::new("Pixel", words::pixel(pixel), Some(Role::Reference)));
            facts.push(Fact::new("Displacement", format!("{} px/frame", words::place(uv)), Some(Role::Measured)));
        }
        readouts.insert(0, Readout::Facts(facts));
        readouts.extend(data(seen).map(|data| displacements(seen, data, point.map(|(_, uv)| uv))));
        readouts.extend(self.plot(seen));
        readouts
    }

    /// The comparison of two regions in numbers.
    fn equation(&self, Comparison { weight, areas, limits }: &Comparison) -> Vec<Math> {
        let is_merged = *weight <= limits[0].min(limits[1]);
        let role = if is_merged { Role::Best } else { Role::Rejected };
        let internal = |i: usize| difference(limits[i] - self.scale / areas[i] as f32);
        let limit = |i: usize| {
            format!("{} + {} / {}", internal(i), fixed(self.scale.into(), 1), words::grouped(areas[i] as usize))
        };
        vec![
            Math::Row(vec![
                Math::abs(Math::Row(vec![Math::text("Δ"), Math::Var("w")])),
                Math::text(" = "),
                Math::ink(role, difference(*weight)),
                Math::text(if is_merged { " ≤ " } else { " > " }),
                Math::text(format!("min({}, {})", limit(0), limit(1))),
            ]),
            Math::Row(vec![Math::text(format!("min({}, {})", difference(limits[0]), difference(limits[1])))]),
        ]
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
            title,
            x_label,
            y_label,
            x_max,
            lines,
            is_logarithmic: true,
            decimals: Some(0),
            ..Series::default()
        }))
    }

    pub(super) fn drawn_step(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
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
    scene.mark(Picture::CURRENT, Role::Measured, Shape::Heat { origin: [0.0; 2], values });
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
