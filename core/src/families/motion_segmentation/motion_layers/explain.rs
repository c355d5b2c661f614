//! The steps of motion layers in words, numbers and marks.

use std::sync::Arc;

use super::vocabulary::{case, value};
use super::{Block, Event, Layer, MotionLayers, Note, hypotheses, line};
use crate::data::Flow;
use crate::geometry::Grid;
use crate::methods::segmentation::affine::Frame;
use crate::methods::segmentation::explain::{
    case as shared_case, conclude, draw_flow, draw_labels, draw_segments, plane, value as shared,
};
use crate::methods::segmentation::{Place, Points, SegmentationRun};
use crate::products::AffineMotion;
use crate::run::Seen;
use crate::scene::{Name, Picture, Readout, Role, Scene, Series, Shape, Step, ValueStyle};

/// Layers with an equation of their own.
const LISTED: usize = 6;

/// Everything that the steps of a unit show.
struct View<'a> {
    seen: &'a Seen<'a, SegmentationRun<MotionLayers>>,
    flow: Option<&'a Arc<Flow>>,
    layers: Vec<Layer>,
    labels: &'a Arc<Grid<u32>>,
    notes: Vec<Note>,
}

impl<'a> View<'a> {
    fn new(seen: &'a Seen<'a, SegmentationRun<MotionLayers>>) -> Self {
        let before = seen.before;
        let mut view = Self {
            seen,
            flow: before.flow.as_ref(),
            layers: before.layers.clone(),
            labels: &before.labels,
            notes: before.notes.clone(),
        };
        seen.events.iter().for_each(|event| view.follow(event));
        view
    }

    fn follow(&mut self, event: &'a Event) {
        match event {
            Event::Flow(flow) => self.flow = Some(flow),
            Event::Clustered(found) => {
                let layer = |motion: &Place| Layer { motion: *motion, moments: Default::default() };
                self.layers = found.means.iter().map(layer).collect();
            }
            Event::Merged { kept, gone, .. } => {
                let moments = self.layers[*kept].moments.and(&self.layers[*gone].moments);
                let motion = moments.fit().unwrap_or(self.layers[*kept].motion);
                self.layers[*kept] = Layer { motion, moments };
                self.layers.remove(*gone);
            }
            Event::Removed { index, .. } => {
                self.layers.remove(*index);
            }
            Event::Assigned { labels, unexplained, .. } => {
                self.labels = labels;
                let share = *unexplained as f64 / labels.cells().len() as f64;
                self.notes.push(Note { layers: self.layers.len(), unexplained: share });
            }
            Event::Split { layer, labels, .. } => {
                self.labels = labels;
                self.layers.push(layer.clone());
            }
            Event::Refitted { index, layer, .. } => self.layers[*index] = layer.clone(),
            Event::Fitted(_) | Event::Labelled(_) => {}
        }
    }

    fn frame(&self) -> Frame {
        Frame::of(self.seen.before.record.picture())
    }

    /// The blocks of the frame so far.
    fn blocks(&self) -> Vec<Block> {
        let fitted = self.seen.events.iter().filter_map(|event| match event {
            Event::Fitted(block) => Some(*block),
            _ => None,
        });
        let new: Vec<Block> = fitted.collect();
        if new.is_empty() { self.seen.before.blocks.to_vec() } else { new }
    }

    /// The known displacement of the pixel that is pointed at.
    fn point(&self) -> Option<((usize, usize), [f32; 2])> {
        let flow = self.flow?;
        let (x, y) = flow.0.cell_at(self.seen.point()?)?;
        Some(((x, y), flow.at(x, y)?))
    }
}

impl MotionLayers {
    pub(super) fn explain_step(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        let view = View::new(seen);
        let Some(event) = seen.events.last() else { return Step::at(line::EACH_FRAME).say(case::OPENING) };
        let step = self.tell_event(&view, event);
        let step = match view.point() {
            Some((pixel, uv)) => residuals(step, &view, pixel, uv),
            None => motions(step, &view),
        };
        step.show_all(displacements(&view)).show_all(plots(&view))
    }

    fn tell_event(&self, view: &View, event: &Event) -> Step {
        let t = view.seen.before.record.frame();
        let at = |line: Name| Step::at(line).fact(shared::FRAME, t);
        let blocks = |line: Name| {
            let blocks = view.blocks();
            let kept = blocks.iter().filter(|block| block.is_kept).count();
            at(line).fact(value::BLOCKS, blocks.len()).fact(value::HYPOTHESES, kept)
        };
        let layers = |line: Name| {
            let step = at(line).fact(value::LAYERS, view.layers.len());
            step.fact_if(value::UNEXPLAINED, view.notes.last().map(|note| 100.0 * note.unexplained))
        };
        let layer = |line: Name, index: usize| layers(line).put(value::LAYER, index + 1);
        match event {
            Event::Flow(_) => {
                let step = blocks(line::FIND_FLOW).put(shared::METHOD, self.input.name());
                step.put(shared::NEXT_FRAME, t + 1).say(shared_case::FLOW).say(case::HYPOTHESES)
            }
            Event::Fitted(block) => self.tell_fit(blocks(line::FIT_BLOCK), view, block),
            Event::Clustered(found) => {
                let step = layers(line::CLUSTER).put(value::CLUSTERS, found.means.len());
                step.put(value::HYPOTHESES, hypotheses(&view.seen.before.blocks).len()).say(case::CLUSTERED)
            }
            Event::Merged { kept, gone, difference } => {
                let step = layer(line::MERGE, *kept).put(value::OTHER, gone + 1).put(value::DIFFERENCE, *difference);
                step.put(value::MERGE_BELOW, self.merge_below).say(case::MERGED)
            }
            Event::Removed { index, area } => {
                let step = layer(line::REMOVE, *index).put(value::AREA, *area);
                step.put(value::MIN_AREA, self.min_area).say(case::REMOVED)
            }
            Event::Assigned { changed, unexplained, .. } => {
                let step = layers(line::ASSIGN).put(value::CHANGES, *changed).put(value::LEFT, *unexplained);
                step.put(value::TOLERANCE, self.tolerance).say(case::ASSIGNED)
            }
            Event::Split { index, layer: of, .. } => {
                layer(line::SPLIT, *index).put(value::SPLIT, of.moments.count).say(case::SPLIT)
            }
            Event::Refitted { index, from, layer: of } => tell_refit(layer(line::REFIT, *index), view, (from, of)),
            Event::Labelled(frame) => {
                let step = at(line::LABEL).put(value::ITERATIONS, view.notes.len().saturating_sub(1));
                conclude(step.say(case::LABELLED), view.seen.clip, t, frame)
            }
        }
    }

    fn tell_fit(&self, step: Step, view: &View, block: &Block) -> Step {
        let (x, y) = block.at;
        let center = (x + block.size.0 / 2, y + block.size.1 / 2);
        let step = step.put(value::BLOCK, block.at).put(value::RESIDUAL, block.residual);
        let step = step.put(value::MOTION, view.frame().displacement(&block.motion, center));
        let step = step.put(value::MAX_RESIDUAL, self.max_residual).say(case::FITTED);
        step.say(if block.is_kept { case::HYPOTHESIS } else { case::ACROSS })
    }

    pub(super) fn draw_marks(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
        let view = View::new(seen);
        match seen.events.last() {
            None => {}
            Some(Event::Flow(flow)) => draw_flow(scene, flow),
            Some(Event::Fitted(block)) => draw_blocks(scene, &view.blocks(), Some(block)),
            Some(Event::Clustered(_)) => draw_blocks(scene, &seen.before.blocks, None),
            Some(Event::Labelled(frame)) => draw_segments(scene, frame),
            Some(_) => draw_labels(scene, Arc::clone(view.labels), "layers, one colour each; clear without a layer"),
        }
    }
}

fn draw_blocks(scene: &mut Scene, blocks: &[Block], now: Option<&Block>) {
    let mut mark = |role, block: &Block, meaning| {
        let shape = Shape::pixels(block.at.0 as i32, block.at.1 as i32, block.size.0, block.size.1);
        scene.draw(Picture::CURRENT, (role, meaning), shape);
    };
    for block in blocks {
        match block.is_kept {
            true => mark(Role::Result, block, "block with an affine motion"),
            false => mark(Role::Rejected, block, "block across a motion boundary"),
        }
    }
    if let Some(block) = now {
        mark(Role::Candidate, block, "current block");
    }
}

fn tell_refit(step: Step, view: &View, (from, layer): (&Place, &Layer)) -> Step {
    if layer.moments.count == 0 {
        return step.say(case::EMPTY);
    }
    let [a, b, c, d, e, f] = view.frame().in_pixels(&layer.motion);
    let written = |offset: f64, slopes: [f64; 2]| {
        let slope = |i: usize| ValueStyle::Signed.text(&value::SLOPE_X.is(slopes[i]));
        format!("{}{} x{} y", value::OFFSET.is(offset).bare(), slope(0), slope(1))
    };
    let step = step.put(value::PIXELS, layer.moments.count).put(value::U, written(a, [b, c]));
    let step = step.put(value::V, written(d, [e, f])).put(value::RESIDUAL, layer.moments.residual(&layer.motion));
    step.put(value::RESIDUAL_BEFORE, layer.moments.residual(from)).say(case::REFITTED)
}

/// Adds the affine motion of the layer that is fitted, or else those of the first layers.
fn motions(step: Step, view: &View) -> Step {
    let fitted = match view.seen.events.last() {
        Some(Event::Refitted { index, .. }) => Some(*index),
        _ => None,
    };
    let is_listed = |(index, _): &(usize, &Layer)| fitted.is_none_or(|fitted| fitted == *index);
    let row = |step: Step, name: String, [offset, x, y]: [f64; 3]| {
        let step = step.put(value::OFFSET, offset).put(value::SLOPE_X, x).put(value::SLOPE_Y, y);
        step.formula(name + r" = {offset} {slope_x:signed} \, x {slope_y:signed} \, y")
    };
    view.layers.iter().enumerate().filter(is_listed).take(LISTED).fold(step, |step, (index, layer)| {
        let [a, b, c, d, e, f]: AffineMotion = view.frame().in_pixels(&layer.motion);
        let step = row(step, format!("u_{{{}}}", index + 1), [a, b, c]);
        row(step, format!("v_{{{}}}", index + 1), [d, e, f])
    })
}

/// Adds the displacement of a pixel and its residuals in all layers.
fn residuals(step: Step, view: &View, pixel: (usize, usize), uv: [f32; 2]) -> Step {
    let residual = |layer: &Layer| {
        let [u, v] = view.frame().displacement(&layer.motion, pixel);
        (f64::from(uv[0]) - u).hypot(f64::from(uv[1]) - v)
    };
    let all: Vec<f64> = view.layers.iter().map(residual).collect();
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let step = step.fact(shared::PIXEL, pixel).fact(shared::DISPLACEMENT, uv);
    all.iter().enumerate().take(LISTED).fold(step, |step, (index, residual)| {
        let role = if *residual == least { Role::Best } else { Role::Candidate };
        let step = step.put_value(value::PIXEL_RESIDUAL.is(*residual).inked(role));
        step.formula(format!("|w - A_{{{}}} x| = {{pixel_residual:unit}}", index + 1))
    })
}

/// The displacements of the pixels in the colours of their layers.
fn displacements(view: &View) -> Option<Readout> {
    let flow = view.flow?;
    let known = flow.0.cells().iter().enumerate().filter(|(_, uv)| uv.iter().all(|c| c.is_finite()));
    // Only a sample of the pixels is shown.
    let step = (flow.0.cells().len() / 4000).max(1);
    let (pixels, uv): (Vec<usize>, Vec<[f32; 2]>) = known.step_by(step).map(|(i, uv)| (i, *uv)).unzip();
    let points = Points::new([0, 1].map(|i| uv.iter().map(|uv| uv[i]).collect()).into());
    let cells = view.labels.cells();
    let named: Vec<(&'static str, Role, Place)> = match view.point() {
        Some((_, [u, v])) => vec![("inspected pixel", Role::Reference, [u, v, 0.0, 0.0, 0.0, 0.0])],
        None => Vec::new(),
    };
    Some(plane((&points, 0), |point| cells.get(pixels[point]).copied().unwrap_or(0), &named, &[]))
}

fn plots(view: &View) -> Vec<Readout> {
    let plot = |title, y_label, role, value: &dyn Fn(&Note) -> f64, decimals| {
        let points: Vec<[f32; 2]> =
            view.notes.iter().enumerate().map(|(i, note)| [(i + 1) as f32, value(note) as f32]).collect();
        let x_max = points.len();
        let lines = vec![(title, role, points)];
        Readout::Series(Series {
            decimals: Some(decimals),
            ..Series::new(title, ["assignment", y_label], x_max, lines)
        })
    };
    if view.notes.is_empty() {
        return Vec::new();
    }
    vec![
        plot("Layers", "layers", Role::Result, &|note| note.layers as f64, 0),
        plot("Pixels without a layer", "%", Role::Error, &|note| 100.0 * note.unexplained, 1),
    ]
}
