//! What a run says of the motion of every pixel: layers of colours, streaklines, and the check with the reverse pair.
//!
//! The window, exported pictures and the command line show the same, made here.

use std::cell::OnceCell;
use std::sync::Arc;

use motionscope_core::products::Motion as Known;
use motionscope_core::scene::{Fact, Shape};
use motionscope_core::{
    Agreement, AnyEstimator, Clip, Confidence, Consistency, Error, Flow, Grid, Output, Scene, Streaks, Threads, Walk,
    metrics, scene,
};

use crate::paint::{FlowLayer, LayerStyle, Pictures, Scalars, Tint, grouped};
use crate::view::look::Look;
use crate::view::tile::Tile;

/// Which layers there are where a run stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AvailableLayers {
    known: Known,
    at_end: bool,
    /// Whether there are several estimators.
    several: bool,
    /// Whether the run looks at two frames and no more.
    is_pair: bool,
    /// Whether the end of the run tells how far its field is trusted.
    has_confidence: bool,
    has_truth: bool,
}

impl AvailableLayers {
    /// Which there are at `site`.
    pub fn at(site: Site<'_>) -> Self {
        Found::at(site).available(site)
    }

    /// Whether there is a field at all.
    pub fn has_field(&self) -> bool {
        self.known.is_field()
    }

    /// Whether the end of the run knows how far off it is.
    pub fn has_errors(&self) -> bool {
        self.has_truth
    }

    /// Why there is no such layer at any step of this run, as part of a sentence; `None` if there is.
    pub fn why_never(&self, layer: FlowLayer) -> Option<&'static str> {
        match layer {
            FlowLayer::None => None,
            _ if !self.has_field() => Some("only single points are known to move here"),
            FlowLayer::Error if !self.has_truth => Some("no true flow is known for this clip"),
            FlowLayer::Consistency if self.several => Some("only an estimator by itself is run on the reverse pair"),
            FlowLayer::Consistency if !self.is_pair => Some("this estimator looks at more than two frames"),
            FlowLayer::Confidence if self.several => Some("these estimators tell no confidence"),
            FlowLayer::Confidence if !self.has_confidence => Some("this estimator tells no confidence"),
            _ => None,
        }
    }

    /// Why there is no such layer here, as part of a sentence; `None` if there is.
    pub fn why_not(&self, layer: FlowLayer) -> Option<&'static str> {
        let of_the_end = "it needs the whole field, which is there at the end of a run";
        self.why_never(layer).or((layer.is_of_the_end() && !self.at_end).then_some(of_the_end))
    }

    /// What is wanted and comes with the end of the run, where that is not reached.
    pub fn awaited(&self, wanted: Option<FlowLayer>) -> Option<FlowLayer> {
        wanted.filter(|layer| self.why_never(*layer).is_none() && self.why_not(*layer).is_some())
    }

    /// The layer that is chosen where `wanted` is wanted: the one that is shown, or awaited.
    pub fn chosen(&self, wanted: Option<FlowLayer>) -> FlowLayer {
        self.awaited(wanted).unwrap_or(self.layer(wanted))
    }

    /// The layer that is shown where `wanted` is wanted: that, or what suits the estimator.
    pub fn layer(&self, wanted: Option<FlowLayer>) -> FlowLayer {
        let usual = if self.known == Known::Pixels { FlowLayer::Wheel } else { FlowLayer::None };
        wanted.filter(|layer| self.why_not(*layer).is_none()).unwrap_or(usual)
    }
}

/// A run where it stands.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    /// The run.
    pub walk: &'a dyn Walk,
    /// What it runs on.
    pub clip: &'a Clip,
    /// What it shows there.
    pub scene: &'a Scene,
}

/// What is seen of motion.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Which layers there are.
    pub available: AvailableLayers,
    /// The layer of colours: one, or one for each of several estimators.
    pub layers: Vec<Arc<Tint>>,
    /// What is wanted in their place and comes with the end of the run.
    pub awaited: Option<FlowLayer>,
    /// The particles of each.
    pub streaks: Vec<Arc<Streaks>>,
    /// What the check with the reverse pair has found.
    pub check: Option<Check>,
    /// Why there is none, if the flow of the reverse pair could not be had.
    pub unchecked: Option<Error>,
}

impl Motion {
    /// What `look` shows of it at `site`. Where the check is to be seen, `backward` is asked for the flow of the reverse
    /// pair; without it there is none.
    ///
    /// # Errors
    /// If the truth or the reverse pair that it needs cannot be had.
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
            FlowLayer::None => return Ok(motion),
            FlowLayer::Wheel => Tint::wheel(&flows, style),
            FlowLayer::Magnitude => {
                let length = |flow: &Arc<Flow>| flow.0.map(|[u, v]| u.hypot(*v));
                Tint::scale(scalars("length of motion", "px/frame", flows.iter().map(length).collect()), colors, style)
            }
            FlowLayer::Error => {
                let truth = true_flow(site)?;
                let errors = flows.iter().map(|flow| metrics::endpoint_errors(flow, &truth));
                let values = errors.collect::<Result<_, _>>()?;
                Tint::scale(scalars("endpoint error", "px", values), colors, style)
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
                let scalars = scalars("there and back, off by", "px", vec![distance_px]);
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
            (None, Some(error)) => vec![Fact { label: "Reverse pair", value: error.to_string(), role: None }],
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

/// The particles of streaklines stand closer than arrows: only some are seen at any moment.
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
            Err(Error::new("nothing is known of the true flow of this frame; choose another frame or another layer"))
        }
    }
}

/// What is known of motion where a run stands.
enum Found<'a> {
    /// A field that is drawn, and at the end all that is known of it.
    Drawn(&'a Grid<[f32; 2]>, Option<Output>),
    /// What the run amounts to.
    Output(Output),
    /// What each of several amounts to.
    Several(Vec<Output>),
}

impl<'a> Found<'a> {
    fn at(Site { walk, scene, .. }: Site<'a>) -> Self {
        let beside = walk.beside(None);
        if !beside.is_empty() {
            return Self::Several(beside.into_iter().map(|member| member.output).collect());
        }
        let drawn = scene.marks.iter().find_map(|mark| match &mark.shape {
            Shape::Flow { values, .. } => Some(values),
            _ => None,
        });
        match drawn {
            Some(values) => Self::Drawn(values, walk.at_end().then(|| walk.output())),
            None => Self::Output(walk.output()),
        }
    }

    fn available(&self, Site { walk, clip, .. }: Site<'_>) -> AvailableLayers {
        let known = match self {
            Self::Drawn(..) => Known::Pixels,
            Self::Output(output) => output.motion(),
            Self::Several(outputs) => outputs.iter().map(Output::motion).min().unwrap_or_default(),
        };
        AvailableLayers {
            known,
            at_end: walk.at_end(),
            several: matches!(self, Self::Several(_)),
            is_pair: walk.info().frames == 2,
            has_confidence: walk.tells_confidence(),
            has_truth: clip.truth().is_some_and(|truth| truth.kinds().contains(&"flow")),
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
            Self::Several(outputs) => outputs.iter().filter_map(Output::flow).map(Arc::new).collect(),
        }
    }
}

/// The flow that the same estimator finds on frames `t + 1` and `t` of `clip`, in this order.
///
/// # Errors
/// If a frame cannot be read, or the estimator cannot run.
pub fn backward(estimator: &dyn AnyEstimator, clip: &Clip, t: usize) -> Result<Flow, Error> {
    let flow = estimator.run(&clip.reversed(t)?, 0, &Threads::all()?)?.flow();
    flow.ok_or_else(|| Error::new(format!("{} makes no flow that could be checked", estimator.info().id)))
}

/// The same, worked out when it is first asked for.
pub struct Reverse<'a> {
    estimator: &'a dyn AnyEstimator,
    clip: &'a Clip,
    t: usize,
    flow: OnceCell<Flow>,
}

impl<'a> Reverse<'a> {
    /// That of a pair whose first frame is `t`.
    pub fn new(estimator: &'a dyn AnyEstimator, clip: &'a Clip, t: usize) -> Self {
        Self { estimator, clip, t, flow: OnceCell::new() }
    }

    /// The flow.
    ///
    /// # Errors
    /// As [`backward`].
    pub fn flow(&self) -> Result<&Flow, Error> {
        if let Some(flow) = self.flow.get() {
            return Ok(flow);
        }
        let flow = backward(self.estimator, self.clip, self.t)?;
        Ok(self.flow.get_or_init(|| flow))
    }
}

/// What the check with the reverse pair has found, in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// Pixels that fail it.
    pub inconsistent: usize,
    /// All pixels.
    pub pixels: usize,
    /// How well they are those that are truly hidden, where that is known.
    pub agreement: Option<Agreement>,
}

impl Check {
    /// The numbers of `check` on the pair of `clip` whose first frame is `t`.
    ///
    /// # Errors
    /// If the truth cannot be read.
    pub fn of(check: &Consistency, clip: &Clip, t: usize) -> Result<Self, Error> {
        let truth = clip.truth().map(|truth| truth.occlusion(t)).transpose()?.flatten();
        let agreement = truth.map(|truth| check.against(&truth)).transpose()?;
        Ok(Self { inconsistent: check.count(), pixels: check.inconsistent.cells().len(), agreement })
    }

    /// The same for a person.
    pub fn facts(&self) -> Vec<Fact> {
        let fact = |label, value| Fact { label, value, role: None };
        let percent = 100.0 * self.inconsistent as f64 / self.pixels.max(1) as f64;
        let mut facts = vec![fact("Fail the check", format!("{} pixels, {percent:.1} %", grouped(self.inconsistent)))];
        facts.push(fact("They fail where", Consistency::criterion()));
        if let Some(Agreement { precision, recall }) = self.agreement {
            let share = |share: Option<f64>| share.map_or("–".into(), |share| format!("{:.0} %", 100.0 * share));
            let told = format!("precision {}, recall {}", share(precision), share(recall));
            facts.push(fact("Truly hidden", told));
        }
        facts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_shown_is_told_why_and_something_else_is_shown() {
        let dense = AvailableLayers { known: Known::Pixels, is_pair: true, ..AvailableLayers::default() };
        let why = |available: AvailableLayers, layer| available.why_not(layer).unwrap_or_default();
        assert_eq!((dense.layer(None), dense.layer(Some(FlowLayer::Error))), (FlowLayer::Wheel, FlowLayer::Wheel));
        assert!(why(dense, FlowLayer::Error).contains("no true flow"));
        let known = AvailableLayers { has_truth: true, ..dense };
        assert!(why(known, FlowLayer::Error).contains("end of a run"));
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
        assert!(why(ended, FlowLayer::Confidence).contains("tells no confidence"));
        assert!(why(AvailableLayers { several: true, ..ended }, FlowLayer::Consistency).contains("by itself"));
        assert!(
            why(AvailableLayers { is_pair: false, ..ended }, FlowLayer::Consistency).contains("more than two frames")
        );
        let blocks = AvailableLayers { known: Known::Blocks, ..ended };
        assert_eq!((blocks.layer(None), blocks.layer(Some(FlowLayer::Wheel))), (FlowLayer::None, FlowLayer::Wheel));
        let points = AvailableLayers { known: Known::Points, ..ended };
        assert!(!points.has_field() && why(points, FlowLayer::Wheel).contains("single points"));
        assert_eq!(points.layer(Some(FlowLayer::Wheel)), FlowLayer::None);
    }
}
