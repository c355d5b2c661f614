//! The steps of motion layers in words, numbers and marks.

use std::sync::Arc;

use super::{Block, Event, Layer, MotionLayers, Note, hypotheses, line};
use crate::base::words;
use crate::data::Flow;
use crate::geometry::Grid;
use crate::methods::numbers::{fixed, percent, px};
use crate::methods::segmentation::affine::Frame;
use crate::methods::segmentation::explain::{conclusion, draw_flow, draw_labels, draw_segments, plane, segment_facts};
use crate::methods::segmentation::{Place, Points, SegmentationRun};
use crate::products::AffineMotion;
use crate::run::Seen;
use crate::scene::{Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

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

    /// Brings it up to an event.
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

/// An affine motion as two equations: slopes to four decimals.
fn written([a, b, c, d, e, f]: AffineMotion) -> [String; 2] {
    let term = |value: f64, name: &str| {
        let sign = if value < 0.0 { "−" } else { "+" };
        format!(" {sign} {} {name}", fixed(value.abs(), 4))
    };
    [(a, b, c), (d, e, f)].map(|(a, b, c)| format!("{}{}{}", px(a), term(b, "x"), term(c, "y")))
}

impl MotionLayers {
    pub(super) fn explained_step(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        let view = View::new(seen);
        let line = match seen.events.last() {
            None => line::EACH_FRAME,
            Some(Event::Flow(_)) => line::FIND_FLOW,
            Some(Event::Fitted(_)) => line::FIT_BLOCK,
            Some(Event::Clustered(_)) => line::CLUSTER,
            Some(Event::Merged { .. }) => line::MERGE,
            Some(Event::Removed { .. }) => line::REMOVE,
            Some(Event::Assigned { .. }) => line::ASSIGN,
            Some(Event::Split { .. }) => line::SPLIT,
            Some(Event::Refitted { .. }) => line::REFIT,
            Some(Event::Labelled(_)) => line::LABEL,
        };
        Step { line, sentence: self.sentence(&view), readouts: self.readouts(&view) }
    }

    fn sentence(&self, view: &View) -> Sentence {
        let said = Sentence::default();
        let t = view.seen.before.record.frame();
        match view.seen.events.last() {
            None => said.text(
                "A rigid surface that moves in front of the camera has, to a good approximation, an affine flow: six parameters for all its pixels. \
                 Layers are such affine motions, each with the pixels that it explains.",
            ),
            Some(Event::Flow(_)) => said.text(format!(
                "{} gives the flow from frame {t} to {}. Affine motions of its blocks are the first hypotheses.",
                self.input.name(),
                t + 1
            )),
            Some(Event::Fitted(block)) => self.fitted(view, block),
            Some(Event::Clustered(found)) => said
                .text(format!(
                    "The {} of blocks form ",
                    words::counted(hypotheses(&view.seen.before.blocks).len(), "affine motion")
                ))
                .ink(Role::Result, words::counted(found.means.len(), "cluster"))
                .text(
                    " in the space of their parameters. These are scaled so that the squared distance of two motions is their mean \
                     squared difference over the picture.",
                ),
            Some(Event::Merged { kept, gone, difference }) => said
                .text(format!("Layers {} and {} differ by ", kept + 1, gone + 1))
                .ink(Role::Measured, px(*difference))
                .text(format!(
                    " px/frame over their pixels, below {}: one motion explains both, so they are merged.",
                    px(self.merge_below.into())
                )),
            Some(Event::Removed { index, area }) => said.text(format!("Layer {} has only ", index + 1)).ink(
                Role::Rejected,
                format!("{} px", words::grouped(*area)),
            ).text(format!(
                ", less than {} of the picture. So small a support does not determine an affine motion, and the layer is removed.",
                percent(f64::from(self.min_area) / 100.0)
            )),
            Some(Event::Assigned { changed, unexplained, .. }) => said
                .text("Each pixel goes to the layer of the smallest residual: ")
                .ink(Role::Candidate, format!("{} pixels", words::grouped(*changed)))
                .text(" change their layer, and ")
                .ink(Role::Error, format!("{} pixels", words::grouped(*unexplained)))
                .text(format!(" have a residual above {} px/frame in all layers.", px(self.tolerance.into()))),
            Some(Event::Split { index, layer, .. }) => said
                .ink(Role::Result, format!("{} connected pixels", words::grouped(layer.moments.count)))
                .text(format!(
                    " that no layer explains are split off as layer {}: a motion that the blocks or the clusters have missed.",
                    index + 1
                )),
            Some(Event::Refitted { index, from, layer }) => self.refitted(view, *index, (from, layer)),
            Some(Event::Labelled(frame)) => {
                let rounds = view.notes.len().saturating_sub(1);
                let count = words::counted(rounds, "iteration");
                said.text(format!("The layers of frame {t} no longer change after {count}. {}", conclusion(view.seen.clip, t, frame)))
            }
        }
    }

    fn fitted(&self, view: &View, block: &Block) -> Sentence {
        let (x, y) = block.at;
        let center = (x + block.size.0 / 2, y + block.size.1 / 2);
        let [u, v] = view.frame().displacement(&block.motion, center).map(|c| c as f32);
        let said = Sentence::default()
            .text(format!("Block at {}: affine motion by least squares, ", words::pixel((x, y))))
            .ink(Role::Measured, words::place([u, v]))
            .text(" px/frame in its middle, with a residual of ")
            .ink(Role::Error, px(block.residual))
            .text(" px/frame. ");
        match block.is_kept {
            true => said.text(format!("At most {}: a hypothesis.", px(self.max_residual.into()))),
            false => said
                .text(format!(
                    "Above {}: the block lies across a motion boundary, where no single affine motion fits, so it is ",
                    px(self.max_residual.into())
                ))
                .ink(Role::Rejected, "rejected")
                .text("."),
        }
    }

    fn refitted(&self, view: &View, index: usize, (from, layer): (&Place, &Layer)) -> Sentence {
        let said = Sentence::default().text(format!("Layer {}", index + 1));
        if layer.moments.count == 0 {
            return said.text(" has no pixels, so its motion stays as it is.");
        }
        let [u, v] = written(view.frame().in_pixels(&layer.motion));
        said.text(format!(", fitted to its {} pixels: ", words::grouped(layer.moments.count)))
            .ink(Role::Result, format!("u = {u}, v = {v}"))
            .text(" px/frame. Residual ")
            .ink(Role::Error, px(layer.moments.residual(&layer.motion)))
            .text(format!(", before {}.", px(layer.moments.residual(from))))
    }

    fn readouts(&self, view: &View) -> Vec<Readout> {
        let seen = view.seen;
        let Some(event) = seen.events.last() else { return Vec::new() };
        let mut facts = vec![Fact::new("Frame", seen.before.record.frame().to_string(), None)];
        match event {
            Event::Labelled(frame) => facts.extend(segment_facts(frame)),
            Event::Flow(_) | Event::Fitted(_) => {
                let blocks = view.blocks();
                let kept = blocks.iter().filter(|block| block.is_kept).count();
                facts.push(Fact::new("Blocks", blocks.len().to_string(), None));
                facts.push(Fact::new("Hypotheses", kept.to_string(), Some(Role::Measured)));
            }
            _ => {
                facts.push(Fact::new("Layers", view.layers.len().to_string(), None));
                if let Some(note) = view.notes.last() {
                    facts.push(Fact::new("Unexplained", percent(note.unexplained), Some(Role::Error)));
                }
            }
        }
        let mut readouts = Vec::new();
        match view.point() {
            Some((pixel, uv)) => {
                facts.push(Fact::new("Pixel", words::pixel(pixel), Some(Role::Reference)));
                facts.push(Fact::new("Displacement", format!("{} px/frame", words::place(uv)), Some(Role::Measured)));
                readouts.extend(residuals(view, pixel, uv).map(Readout::Equation));
            }
            None => readouts.extend(motions(view).map(Readout::Equation)),
        }
        readouts.insert(0, Readout::Facts(facts));
        readouts.extend(displacements(view));
        readouts.extend(plots(view));
        readouts
    }

    pub(super) fn drawn_step(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
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
        scene.mark(Picture::CURRENT, role, shape);
        scene.legend(role, meaning);
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

/// The affine motion of the layer that is fitted, or else those of the first layers.
fn motions(view: &View) -> Option<Vec<Math>> {
    if view.layers.is_empty() {
        return None;
    }
    let fitted = match view.seen.events.last() {
        Some(Event::Refitted { index, .. }) => Some(*index),
        _ => None,
    };
    let is_listed = |(index, _): &(usize, &Layer)| fitted.is_none_or(|fitted| fitted == *index);
    let row = |(index, layer): (usize, &Layer)| {
        let [u, v] = written(view.frame().in_pixels(&layer.motion));
        let name = |name| Math::indexed(Math::Var(name), Math::text((index + 1).to_string()));
        [
            Math::Row(vec![name("u"), Math::text(" = "), Math::ink(Role::Result, u)]),
            Math::Row(vec![name("v"), Math::text(" = "), Math::ink(Role::Result, v)]),
        ]
    };
    Some(view.layers.iter().enumerate().filter(is_listed).take(LISTED).flat_map(row).collect())
}

/// The residuals of all layers at a pixel.
fn residuals(view: &View, pixel: (usize, usize), uv: [f32; 2]) -> Option<Vec<Math>> {
    let residual = |layer: &Layer| {
        let [u, v] = view.frame().displacement(&layer.motion, pixel);
        (f64::from(uv[0]) - u).hypot(f64::from(uv[1]) - v)
    };
    let all: Vec<f64> = view.layers.iter().map(residual).collect();
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let row = |(index, value): (usize, &f64)| {
        let role = if *value == least { Role::Best } else { Role::Candidate };
        let motion = Math::indexed(Math::Var("A"), Math::text((index + 1).to_string()));
        let off = Math::abs(Math::Row(vec![Math::Var("w"), Math::text(" − "), motion, Math::Var("x")]));
        Math::Row(vec![off, Math::text(" = "), Math::ink(role, format!("{} px/frame", px(*value)))])
    };
    let rows: Vec<Math> = all.iter().enumerate().take(LISTED).map(row).collect();
    (!rows.is_empty()).then_some(rows)
}

/// The displacements of the pixels in the colours of their layers.
fn displacements(view: &View) -> Option<Readout> {
    let flow = view.flow?;
    let known = flow.0.cells().iter().enumerate().filter(|(_, uv)| uv.iter().all(|c| c.is_finite()));
    // A sample of the pixels is shown.
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
            title,
            x_label: "assignment",
            y_label,
            x_max,
            lines,
            decimals: Some(decimals),
            ..Series::default()
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
