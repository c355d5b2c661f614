//! The motion of every pixel as shown: flow layers, streaklines, and the forward–backward check.
//!
//! The window, exported pictures and the command line share this code.
//!
//! `Motion::of` computes the chosen layer as a `Tint`: pixels with a legend, blended over frame t. `AvailableLayers` says which
//! layers exist at a step, and why others do not. The backward flow for the forward–backward check is computed on a thread of
//! its own when it is first needed.

use std::cell::OnceCell;
use std::sync::Arc;

use motionscope_core::base::{Error, Threads};
use motionscope_core::data::{Clip, Flow};
use motionscope_core::geometry::Grid;
use motionscope_core::products::{Agreement, Confidence, Consistency, Motion as Known, Output, Streaks, metrics};
use motionscope_core::run::{AnyEstimator, Beside, Walk};
use motionscope_core::scene::{self, Fact, Quantity, Scene, Shape};

use crate::experiment::whole;
use crate::paint::{FlowLayer, LayerStyle, Pictures, Scalars, Tint, grouped};
use crate::view::look::Look;
use crate::view::tile::Tile;

/// The flow layers that are available at a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AvailableLayers {
    known: Known,
    at_end: bool,
    /// Whether several estimators run in lockstep.
    several: bool,
    /// Whether the run uses exactly two frames.
    is_pair: bool,
    /// Whether the result has a confidence.
    has_confidence: bool,
    has_truth: bool,
    /// Whether lines between the pictures would lie over the colours.
    has_links: bool,
    /// Whether the step has each of [`Quantity::ALL`].
    quantities: [bool; Quantity::ALL.len()],
}

impl AvailableLayers {
    /// Returns the layers available at `site`.
    pub fn at(site: Site<'_>) -> Self {
        Found::at(site).available(site)
    }

    /// Whether there is a dense flow.
    pub fn has_field(&self) -> bool {
        self.known.is_field()
    }

    /// Whether the true flow is known.
    pub fn has_errors(&self) -> bool {
        self.has_truth
    }

    /// Whether the step has a quantity of a model.
    fn has_quantity(&self, quantity: Quantity) -> bool {
        Quantity::ALL.iter().zip(self.quantities).any(|(one, has)| has && *one == quantity)
    }

    /// Whether the layer is offered: quantities of a model where there is one, those of a flow elsewhere.
    pub fn offers(&self, layer: FlowLayer) -> bool {
        let has_model = self.quantities.contains(&true);
        match (layer, layer.quantity()) {
            (FlowLayer::None, _) => true,
            (_, Some(quantity)) => self.has_quantity(quantity),
            (_, None) => self.has_field() || !has_model,
        }
    }

    /// Whether there are colours to choose at all.
    pub fn has_colors(&self) -> bool {
        self.has_field() || self.quantities.contains(&true)
    }

    /// Returns why no step of this run has the layer, as part of a sentence; `None` if some step has it.
    pub fn why_never(&self, layer: FlowLayer) -> Option<&'static str> {
        if let Some(quantity) = layer.quantity() {
            return (!self.has_quantity(quantity)).then_some("this step has no model with this quantity");
        }
        match layer {
            FlowLayer::None => None,
            _ if !self.has_field() => Some("this estimator tracks single points, so there is no dense flow to colour"),
            FlowLayer::Error if !self.has_truth => Some("there is no true flow for this clip"),
            FlowLayer::Consistency if self.several => Some("the forward–backward check needs a single estimator"),
            FlowLayer::Consistency if !self.is_pair => Some("this estimator uses more than two frames"),
            FlowLayer::Difference if !self.several => Some("it compares estimators in lockstep"),
            FlowLayer::Confidence if self.several => Some("these estimators report no confidence"),
            FlowLayer::Confidence if !self.has_confidence => Some("this estimator reports no confidence"),
            _ => None,
        }
    }

    /// Returns why this step does not have the layer, as part of a sentence; `None` if it has.
    pub fn why_not(&self, layer: FlowLayer) -> Option<&'static str> {
        let of_the_end = "it needs the complete flow field, at the end of the run";
        self.why_never(layer).or((layer.is_of_the_end() && !self.at_end).then_some(of_the_end))
    }

    /// Returns the requested layer if it appears only at the end of the run and the end is not reached.
    pub fn awaited(&self, wanted: Option<FlowLayer>) -> Option<FlowLayer> {
        wanted.filter(|layer| self.why_never(*layer).is_none() && self.why_not(*layer).is_some())
    }

    /// Returns the layer that is selected for the request `wanted`: the shown or the awaited one.
    pub fn chosen(&self, wanted: Option<FlowLayer>) -> FlowLayer {
        self.awaited(wanted).unwrap_or(self.layer(wanted))
    }

    /// Returns the layer that is shown for the request `wanted`, or the estimator's default.
    pub fn layer(&self, wanted: Option<FlowLayer>) -> FlowLayer {
        let usual = if self.known == Known::Pixels && !self.has_links { FlowLayer::Wheel } else { FlowLayer::None };
        wanted.filter(|layer| self.why_not(*layer).is_none()).unwrap_or(usual)
    }
}

/// A run at its cursor.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    /// The run.
    pub walk: &'a dyn Walk,
    /// The clip.
    pub clip: &'a Clip,
    /// The marks of the step.
    pub scene: &'a Scene,
}

/// The flow layers, streaklines and checks of a step.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// The available layers.
    pub available: AvailableLayers,
    /// The flow layer: one, or one for each estimator in lockstep.
    pub layers: Vec<Arc<Tint>>,
    /// The requested layer that appears at the end of the run.
    pub awaited: Option<FlowLayer>,
    /// The streaklines of each.
    pub streaks: Vec<Arc<Streaks>>,
    /// The result of the forward–backward check.
    pub check: Option<Check>,
    /// The error if the backward flow could not be computed.
    pub unchecked: Option<Error>,
}

impl Motion {
    /// Computes what `look` shows at `site`. For the forward–backward check, `backward` returns the flow from frame t + 1 to t, or
    /// `None` while it is not computed.
    ///
    /// # Errors
    /// If the true flow or the backward flow cannot be read or computed.
    pub fn of<'a>(
        site: Site<'_>,
        look: &Look,
        backward: impl FnOnce() -> Result<Option<&'a Flow>, Error>,
    ) -> Result<Self, Error> {
        let found = Found::at(site);
        let available = found.available(site);
        let layer = available.layer(look.layer);
        let shows_streaks = look.streaks.is_some() && available.has_field();
        let mut motion = Self { available, awaited: available.awaited(look.layer), ..Self::default() };
        if layer == FlowLayer::None && !shows_streaks {
            return Ok(motion);
        }
        if let Some(layer) = layer.quantity().and_then(|one| site.scene.layers.iter().find(|of| of.quantity == one)) {
            let (kind, label) = (available.layer(look.layer), layer.quantity.name().into());
            let scalars =
                Scalars { kind, label, unit: layer.quantity.unit(), values: vec![layer.values()], marks: None };
            let style = LayerStyle { opacity: look.layer_opacity, high: None };
            motion.layers = Tint::scale(scalars, look.colors, style).into_iter().map(Arc::new).collect();
            return Ok(motion);
        }
        let flows = found.flows();
        // Before anything has moved colours would be a veil that says nothing.
        let is_still = |flow: &Arc<Flow>| !flow.0.cells().iter().any(|[u, v]| u.hypot(*v) > 0.0);
        if !site.walk.at_end() && matches!(layer, FlowLayer::Wheel | FlowLayer::Magnitude) && flows.iter().all(is_still)
        {
            return Ok(motion);
        }
        if shows_streaks {
            let spacing = |flow: &Flow| look.arrow_spacing.map_or_else(|| usual_spacing(flow), usize::from);
            motion.streaks = flows.iter().map(|flow| Arc::new(Streaks::new(flow, spacing(flow)))).collect();
        }
        let Look { colors, layer_opacity: opacity, color_scale: high, .. } = *look;
        let style = LayerStyle { opacity, high };
        let scalars =
            |label: &str, unit, values| Scalars { kind: layer, label: label.into(), unit, values, marks: None };
        let shown = match layer {
            FlowLayer::None | FlowLayer::Model(_) => return Ok(motion),
            FlowLayer::Wheel => Tint::wheel(&flows, style),
            FlowLayer::Magnitude => {
                let length = |flow: &Arc<Flow>| flow.0.map(|[u, v]| u.hypot(*v));
                Tint::scale(
                    scalars("magnitude of motion", "px/frame", flows.iter().map(length).collect()),
                    colors,
                    style,
                )
            }
            FlowLayer::Error => {
                let truth = true_flow(site)?;
                let errors = flows.iter().map(|flow| metrics::endpoint_errors(flow, &truth));
                let values = errors.collect::<Result<_, _>>()?;
                Tint::scale(scalars("endpoint error", "px", values), colors, style)
            }
            FlowLayer::Difference => {
                let Some((first, others)) = flows.split_first() else { return Ok(motion) };
                let unknown = || Grid::new(first.0.width(), first.0.height(), f32::NAN);
                // Flows on levels of different size are not comparable.
                let difference = |flow| metrics::endpoint_errors(flow, first).unwrap_or_else(|_| unknown());
                let values = std::iter::once(unknown()).chain(others.iter().map(|flow| difference(flow)));
                Tint::scale(scalars("difference from the first flow", "px", values.collect()), colors, style)
            }
            FlowLayer::Confidence => {
                let Some(Confidence { name, values }) = found.confidence() else { return Ok(motion) };
                Tint::scale(
                    scalars(&format!("confidence: {}", name.replace('_', " ")), "", vec![values.clone()]),
                    colors,
                    // A scale in px says nothing of it.
                    LayerStyle { high: None, ..style },
                )
            }
            FlowLayer::Consistency => {
                let (Some(flow), Some(backward)) = (flows.first(), backward()?) else { return Ok(motion) };
                let check = Consistency::of(flow, backward)?;
                motion.check = Some(Check::of(&check, site.clip, site.walk.at_frame())?);
                let Consistency { distance_px, inconsistent } = check;
                let scalars = scalars("forward–backward error", "px", vec![distance_px]);
                Tint::scale(Scalars { marks: Some(inconsistent), ..scalars }, colors, style)
            }
        };
        motion.layers = shown.into_iter().map(Arc::new).collect();
        Ok(motion)
    }

    /// What the check has found, or why there is none, for a person.
    pub fn facts(&self) -> Vec<Fact> {
        match (&self.check, &self.unchecked) {
            (Some(check), _) => check.facts(),
            (None, Some(error)) => vec![Fact::new("Reverse pair", error.to_string(), None)],
            (None, None) => Vec::new(),
        }
    }

    /// Puts it into the pictures that are looked at, those of all and those of each.
    pub fn put(&self, pictures: &mut Pictures, tiles: &mut [Tile]) {
        (pictures.layer, pictures.streaks) = (self.layers.first().cloned(), self.streaks.first().cloned());
        pictures.awaited = self.awaited;
        for (i, tile) in tiles.iter_mut().enumerate() {
            (tile.layer, tile.streaks) = (self.layers.get(i).cloned(), self.streaks.get(i).cloned());
        }
    }
}

/// The spacing of streakline particles, denser than arrows because only some are visible at a time.
fn usual_spacing(flow: &Flow) -> usize {
    (scene::arrow_spacing(flow.0.size()) * 3 / 4).max(4)
}

fn true_flow(site: Site<'_>) -> Result<Arc<Flow>, Error> {
    let truth = site.clip.truth().map(|truth| truth.flow(site.walk.at_frame())).transpose()?.flatten();
    let truth = truth
        .ok_or_else(|| Error::new("there is no true flow for this frame; choose another frame or another layer"))?;
    match truth.0.cells().iter().any(|uv| uv.iter().all(|c| c.is_finite())) {
        true => Ok(truth),
        false => {
            Err(Error::new("the true flow of this frame has no valid pixel; choose another frame or another layer"))
        }
    }
}

/// Returns the displacement of pixel `at` of frame t that is known at `site`, in px; of estimators in lockstep that of the first.
pub fn known_at(at: [usize; 2], site: Site<'_>) -> Option<[f32; 2]> {
    let flow = Found::at(site).flows().into_iter().next()?;
    // A flow of a pyramid level has other pixels.
    let is_whole = flow.0.size() == site.clip.size();
    let known = flow.0.get(at[0], at[1]).filter(|uv| uv.iter().all(|c| c.is_finite()));
    known.filter(|_| is_whole).copied()
}

/// The motion known at a step.
enum Found<'a> {
    /// The flow that the step draws, and at the end the output.
    Drawn(&'a Grid<[f32; 2]>, Option<Output>),
    /// The output so far.
    Output(Output),
    /// The outputs of several estimators, and the flow that each draws.
    Several(Vec<(Output, Option<Flow>)>),
}

impl<'a> Found<'a> {
    fn at(Site { walk, scene, .. }: Site<'a>) -> Self {
        let beside = walk.beside(None);
        if !beside.is_empty() {
            let at_end = walk.at_end();
            let found = |member: Beside| {
                let drawn = drawn_flow(&member.scene).filter(|_| !at_end).map(|values| Flow(Grid::clone(values)));
                (member.output, drawn)
            };
            return Self::Several(beside.into_iter().map(found).collect());
        }
        match drawn_flow(scene) {
            Some(values) => Self::Drawn(values, walk.at_end().then(|| walk.output())),
            None => Self::Output(walk.output()),
        }
    }

    fn available(&self, Site { walk, clip, scene }: Site<'_>) -> AvailableLayers {
        let known = match self {
            Self::Drawn(..) => Known::Pixels,
            Self::Output(output) => output.motion(),
            Self::Several(all) => {
                let known = |(output, drawn): &(Output, Option<Flow>)| match drawn {
                    Some(_) => Known::Pixels,
                    None => output.motion(),
                };
                all.iter().map(known).min().unwrap_or_default()
            }
        };
        AvailableLayers {
            known,
            at_end: walk.at_end(),
            several: matches!(self, Self::Several(_)),
            is_pair: walk.info().frames == 2,
            has_confidence: walk.tells_confidence(),
            quantities: Quantity::ALL.map(|one| scene.layers.iter().any(|layer| layer.quantity == one)),
            has_truth: clip.truth().is_some_and(|truth| truth.kinds().contains(&"flow")),
            has_links: !scene.links.is_empty(),
        }
    }

    fn confidence(&self) -> Option<&Confidence> {
        match self {
            Self::Drawn(_, output) => output.as_ref()?.confidence(),
            Self::Output(output) => output.confidence(),
            Self::Several(_) => None,
        }
    }

    fn flows(&self) -> Vec<Arc<Flow>> {
        match self {
            Self::Drawn(values, output) => {
                let whole = output.as_ref().and_then(Output::flow);
                vec![Arc::new(whole.unwrap_or_else(|| Flow(Grid::clone(values))))]
            }
            Self::Output(output) => output.flow().map(Arc::new).into_iter().collect(),
            Self::Several(all) => {
                let flow = |(output, drawn): &(Output, Option<Flow>)| drawn.clone().or_else(|| output.flow());
                all.iter().filter_map(flow).map(Arc::new).collect()
            }
        }
    }
}

/// The flow that a step draws, if it draws one.
fn drawn_flow(scene: &Scene) -> Option<&Grid<[f32; 2]>> {
    scene.marks.iter().find_map(|mark| match &mark.shape {
        Shape::Flow { values, .. } => Some(values),
        _ => None,
    })
}

/// Returns the backward flow: the same estimator on frames `t + 1` and `t` of `clip`, in this order.
///
/// # Errors
/// If a frame cannot be read, or the estimator cannot run.
pub async fn backward(estimator: &dyn AnyEstimator, clip: &Clip, t: usize) -> Result<Flow, Error> {
    let (output, _) = whole::output(estimator, (&clip.reversed(t)?, 0), &Threads::all()?).await?;
    checked_with(estimator, output)
}

/// The flow of the reverse pair.
fn checked_with(estimator: &dyn AnyEstimator, reverse: Output) -> Result<Flow, Error> {
    reverse
        .flow()
        .ok_or_else(|| Error::new(format!("{} produces no flow for the forward–backward check", estimator.info().id)))
}

/// The backward flow, computed on first use.
pub struct Reverse<'a> {
    estimator: &'a dyn AnyEstimator,
    clip: &'a Clip,
    t: usize,
    flow: OnceCell<Flow>,
}

impl<'a> Reverse<'a> {
    /// The backward flow of the pair whose first frame is `t`.
    pub fn new(estimator: &'a dyn AnyEstimator, clip: &'a Clip, t: usize) -> Self {
        Self { estimator, clip, t, flow: OnceCell::new() }
    }

    /// Returns the flow.
    ///
    /// # Errors
    /// As [`backward`].
    pub fn flow(&self) -> Result<&Flow, Error> {
        if let Some(flow) = self.flow.get() {
            return Ok(flow);
        }
        let output = self.estimator.run(&self.clip.reversed(self.t)?, 0, &Threads::all()?)?;
        let flow = checked_with(self.estimator, output)?;
        Ok(self.flow.get_or_init(|| flow))
    }
}

/// The result of the forward–backward check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// Number of inconsistent pixels.
    pub inconsistent: usize,
    /// Number of pixels.
    pub pixels: usize,
    /// Precision and recall of the inconsistent pixels as a detector of occlusion, if the true occlusions are known.
    pub agreement: Option<Agreement>,
}

impl Check {
    /// Evaluates `check` on the pair of `clip` whose first frame is `t`.
    ///
    /// # Errors
    /// If the truth cannot be read.
    pub fn of(check: &Consistency, clip: &Clip, t: usize) -> Result<Self, Error> {
        let truth = clip.truth().map(|truth| truth.occlusion(t)).transpose()?.flatten();
        let agreement = truth.map(|truth| check.against(&truth)).transpose()?;
        Ok(Self { inconsistent: check.count(), pixels: check.inconsistent.cells().len(), agreement })
    }

    /// Returns the result as facts.
    pub fn facts(&self) -> Vec<Fact> {
        let fact = |label, value: String| Fact::new(label, value, None);
        let percent = 100.0 * self.inconsistent as f64 / self.pixels.max(1) as f64;
        let mut facts = vec![fact("Inconsistent", format!("{} pixels, {percent:.1} %", grouped(self.inconsistent)))];
        facts.push(fact("Criterion", Consistency::criterion()));
        if let Some(Agreement { precision, recall }) = self.agreement {
            let share = |share: Option<f64>| share.map_or("–".into(), |share| format!("{:.0} %", 100.0 * share));
            let message = format!("precision {}, recall {}", share(precision), share(recall));
            facts.push(fact("Occlusion", message));
        }
        facts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_shown_is_reported_why_and_something_else_is_shown() {
        let dense = AvailableLayers { known: Known::Pixels, is_pair: true, ..AvailableLayers::default() };
        let why = |available: AvailableLayers, layer| available.why_not(layer).unwrap_or_default();
        assert_eq!((dense.layer(None), dense.layer(Some(FlowLayer::Error))), (FlowLayer::Wheel, FlowLayer::Wheel));
        assert!(why(dense, FlowLayer::Error).contains("no true flow"));
        let known = AvailableLayers { has_truth: true, ..dense };
        assert!(why(known, FlowLayer::Error).contains("end of the run"));
        let ended = AvailableLayers { at_end: true, ..known };
        assert_eq!(ended.layer(Some(FlowLayer::Error)), FlowLayer::Error);
        for (available, awaited) in [(dense, None), (known, Some(FlowLayer::Error)), (ended, None)] {
            assert_eq!(available.awaited(Some(FlowLayer::Error)), awaited, "only what will be there is awaited");
        }
        let wheel = Some(FlowLayer::Wheel);
        assert_eq!([known.chosen(Some(FlowLayer::Error)), known.chosen(wheel)], [FlowLayer::Error, FlowLayer::Wheel]);
        assert_eq!(
            [dense.chosen(Some(FlowLayer::Error)), known.awaited(wheel).unwrap_or_default()],
            [FlowLayer::Wheel, FlowLayer::None]
        );
        assert!(why(ended, FlowLayer::Confidence).contains("reports no confidence"));
        assert!(why(AvailableLayers { several: true, ..ended }, FlowLayer::Consistency).contains("single estimator"));
        assert!(
            why(AvailableLayers { is_pair: false, ..ended }, FlowLayer::Consistency).contains("more than two frames")
        );
        let linked = AvailableLayers { has_links: true, ..ended };
        assert_eq!((linked.layer(None), linked.layer(wheel)), (FlowLayer::None, FlowLayer::Wheel));
        let blocks = AvailableLayers { known: Known::Blocks, ..ended };
        assert_eq!((blocks.layer(None), blocks.layer(Some(FlowLayer::Wheel))), (FlowLayer::None, FlowLayer::Wheel));
        let points = AvailableLayers { known: Known::Points, ..ended };
        assert!(!points.has_field() && why(points, FlowLayer::Wheel).contains("single points"));
        assert_eq!(points.layer(Some(FlowLayer::Wheel)), FlowLayer::None);
    }
}
