//! Flow magnitude: pixels with large optical flow are foreground.

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Threads};
use crate::data::{Clip, Flow, Frame, Mask};
use crate::geometry::{Border, Grid, filter};
use crate::methods::subtraction::{
    self, Background, Cases, Explanation, Found, Probe, Settings, Setup, class, subtraction_pseudocode,
};
use crate::run::{DenseFlow, Info, Need, Stage, StageView};
use crate::scene::{Canvas, Picture, Role, Step, Unit, Value};
use crate::{cases, params, variables};

params! {
    /// Foreground by the magnitude of the optical flow.
    pub struct FlowMagnitude {
        /// Method of the dense optical flow.
        method: Stage<DenseFlow> = Stage::named("farneback");
        /// Threshold on the flow magnitude |w|. Pixels above it are foreground if the flow reduces the residual.
        threshold: f32 = 1.0, 0.0..=50.0, "px/frame";
        /// Radius of the window over which the residuals with and without motion compensation are compared. This comparison removes
        /// flow that a smooth field spreads beyond the edges of objects.
        window_radius: usize = 1, 0..=15, "px";
        /// The parameters of all background subtractions.
        settings: Settings = Settings { opening: 1, closing: 3, ..Settings::default() };
    }
}

/// The previous frame, and its comparison with the current one once that is computed.
#[derive(Clone)]
pub struct Model {
    before: Arc<Frame>,
    compared: OnceLock<Arc<FramePair>>,
}

/// The flow and the residuals between a frame and the previous one.
struct FramePair {
    /// The flow from the frame back to the previous one; unknown flow counts as zero.
    back: Flow,
    /// The mean absolute residuals over the window around each pixel in gray levels: without and with motion
    /// compensation.
    at_rest: Grid<f32>,
    moved: Grid<f32>,
}

impl FramePair {
    /// Returns the flow magnitude at a pixel in px.
    fn length(&self, (x, y): (usize, usize)) -> f32 {
        let [u, v] = self.displacement((x, y));
        u.hypot(v)
    }

    fn displacement(&self, (x, y): (usize, usize)) -> [f32; 2] {
        self.back.at(x, y).unwrap_or_default()
    }
}

impl FlowMagnitude {
    /// Returns the comparison of a frame with the previous one.
    fn compared<'a>(&self, model: &'a Model, frame: &Frame) -> &'a FramePair {
        model.compared.get_or_init(|| {
            let (width, height) = frame.size();
            Arc::new(self.compare([frame, &model.before], Flow(Grid::new(width, height, [0.0; 2])), &Threads::single()))
        })
    }

    /// Compares a frame with the previous one, given the flow `back` to that.
    fn compare(&self, frames: [&Frame; 2], back: Flow, threads: &Threads) -> FramePair {
        let [now, before] = frames.map(|frame| frame.luma());
        let (width, height) = now.size();
        let gray = |x: usize, y: usize| f32::from(now[(x, y)]);
        let off = |place: &dyn Fn(usize, usize) -> [f32; 2]| {
            let off = Grid::from_fn(width, height, |x, y| {
                let [u, v] = place(x, y);
                (gray(x, y) - before.sample(x as f32 + u, y as f32 + v)).abs()
            });
            let side = 2 * self.window_radius + 1;
            let weights = vec![1.0 / side as f32; side];
            filter::separable(&off, (&weights, &weights), Border::Replicate, threads)
        };
        let at_rest = off(&|_, _| [0.0; 2]);
        let moved = off(&|x, y| back.at(x, y).unwrap_or_default());
        FramePair { at_rest, moved, back }
    }

    fn limit(&self) -> Value {
        subtraction::value::THRESHOLD.is(self.threshold).in_unit(Unit::SPEED)
    }

    /// Whether the flow of a pixel exceeds the threshold, and whether motion compensation reduces the residual around it: together they
    /// make it foreground.
    fn tests(&self, pair: &FramePair, place: (usize, usize)) -> [bool; 2] {
        [pair.length(place) > self.threshold, pair.moved[place] < pair.at_rest[place]]
    }
}

variables! {
    /// The optical flow of the pixel back to the previous frame.
    FLOW: "Flow to frame t−1", r"\mathbf{w}", Unit::PX, Role::Measured;
    /// The magnitude of the flow.
    MAGNITUDE: "Flow magnitude", r"|\mathbf{w}|", Unit::SPEED;
    /// The mean absolute residual around the pixel after motion compensation.
    MOVED: "Residual with motion", "", Unit::GRAY;
    /// The mean absolute residual around the pixel without motion compensation.
    AT_REST: "Residual without motion", "", Unit::GRAY;
}

cases! { over value, subtraction::value;
    RULE: "the flow magnitude exceeds {threshold}, and motion compensation lowers the residual.",
    SHORT: ": flow magnitude {magnitude} is within the threshold {threshold}: background.",
    EXPLAINED: ": flow magnitude {magnitude} exceeds the threshold {threshold}. Motion compensation lowers the residual to \
                {moved} from {at_rest:bare}: foreground.",
    SPREAD: ": flow magnitude {magnitude} exceeds the threshold {threshold}, but motion compensation leaves a residual of \
             {moved}, not below the {at_rest:bare} without it. The flow has spread from a neighbouring object: background.",
    REPLACES: "this frame, with gray level {gray_level} here, becomes the reference of the next flow.",
}

subtraction_pseudocode! {
    begin: "frame 0 is the reference of frame 1",
    compare: "  w ← optical flow from frame t back to frame t−1",
    decide: "  foreground if |w| > threshold and Σ |I(x, t) − I(x + w, t−1)| < Σ |I(x, t) − I(x, t−1)|",
    update: "  frame t becomes the reference of frame t+1",
}

impl Background for FlowMagnitude {
    const INFO: Info = Info {
        id: "flow-magnitude",
        name: "Flow magnitude",
        family: "Moving objects",
        summary: "Thresholds the magnitude of the optical flow between consecutive frames. Needs texture and a static camera, but no background model.",
        source: "Threshold on the flow magnitude: S. Denman, V. Chandran and S. Sridharan, An adaptive optical flow technique \
                 for person tracking systems, Pattern Recognition Letters 28, 2007; displaced and plain frame \
                 difference: A. M. Tekalp, Digital video processing, 1995",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|w| in px/frame";
    const COMPARED: &'static str = "magnitude of the optical flow";
    type Model = Model;

    /// Each frame is compared with the previous one alone.
    fn earlier_frames(&self) -> Option<usize> {
        Some(1)
    }

    fn setup(&self) -> Setup {
        Setup { settings: self.settings, initial: None, steady: None }
    }

    /// The flow leads from a frame to the previous one.
    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        clip.reversed(now.saturating_sub(1)).map(|clip| Some(StageView { clip, set: Vec::new() }))
    }

    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.method.need(clip);
        // The flow and two residuals are kept of a frame.
        Need { run, ..Need::per_pixel(clip, [0.0, 20.0]) }.and([0.0, run as f64 / 4.0])
    }

    fn begin(&self, first: &Arc<Frame>) -> Model {
        Model { before: Arc::clone(first), compared: OnceLock::new() }
    }

    fn look(&self, clip: &Clip, model: &Model, frame: &Frame, threads: &Threads) -> Result<(), Error> {
        if model.compared.get().is_some() {
            return Ok(());
        }
        let back = self.method.between(clip, [frame, &model.before], threads)?;
        model.compared.get_or_init(|| Arc::new(self.compare([frame, &model.before], back, threads)));
        Ok(())
    }

    fn subtract(&self, model: &mut Model, frame: &Arc<Frame>, _: &Threads) -> Found {
        let pair = self.compared(model, frame);
        let (width, height) = frame.size();
        let mask = Mask::from_fn(width, height, |x, y| self.tests(pair, (x, y)) == [true; 2]);
        *model = self.begin(frame);
        Found { mask, shadows: None }
    }

    fn expected(&self, model: &Model, place: (usize, usize)) -> f32 {
        f32::from(model.before.luma()[place])
    }

    fn pictures(&self, _model: &Arc<Model>, _size: (usize, usize)) -> Vec<Canvas> {
        [Picture::PREVIOUS, Picture::CURRENT].map(Canvas::of_clip).into()
    }

    fn explains(&self, picture: Picture) -> bool {
        [Picture::PREVIOUS, Picture::CURRENT].contains(&picture)
    }

    fn difference(&self, model: &Model, frame: &Frame, place: (usize, usize)) -> f32 {
        self.compared(model, frame).length(place)
    }

    fn explain(&self, step: Step, probe: &Probe<Model>) -> Explanation {
        let &Probe { before, after, frame, place } = probe;
        let pair = self.compared(before, frame);
        let [is_long, is_explained] = self.tests(pair, place);
        let [(long, longer), (explained, _)] = [is_long, is_explained].map(class);
        let lower = if is_explained { "<" } else { r"\ge" };
        let step = step
            .fact(value::FLOW, pair.displacement(place))
            .fact_of(value::MAGNITUDE.is(pair.length(place)).inked(long))
            .fact_of(self.limit())
            .fact_of(value::MOVED.is(pair.moved[place]).inked(explained))
            .fact(value::AT_REST, pair.at_rest[place])
            .put(subtraction::value::GRAY_LEVEL, frame.luma()[place])
            .formula(format!("|{{flow}}| = {{magnitude}} {longer} {{threshold}}"))
            .formula(format!(
                r"\text{{mean |I(x, t) − I(x + w, t−1)|}} = {{moved}} {lower} {{at_rest}} = \text{{mean |I(x, t) − I(x, t−1)|}}"
            ));
        let verdict = match (is_long, is_explained) {
            (false, _) => case::SHORT,
            (true, true) => case::EXPLAINED,
            (true, false) => case::SPREAD,
        };
        let update = after.map(|_| case::REPLACES).into_iter().collect();
        Explanation { step, verdict: vec![verdict], update }
    }

    fn rule(&self, step: Step) -> (Step, Cases) {
        (step.put_value(self.limit()), vec![case::RULE])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        let pixels = model.before.luma().cells().len();
        model.before.bytes() + pixels * (size_of::<[f32; 2]>() + 2 * size_of::<f32>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_of_the_flow_method_is_passed_on() {
        let frame = Arc::new(Frame::gray(Grid::new(64, 48, 7)));
        let clip = Clip::from_frames("gray", vec![Frame::clone(&frame); 2]).expect("frames of one size");
        let (magnitude, threads) = (FlowMagnitude::default(), Threads::single());
        let look = |clip: &Clip| magnitude.look(clip, &magnitude.begin(&frame), &frame, &threads);
        assert_eq!(look(&clip), Ok(()));
        let refusal = look(&clip.within(1)).expect_err("there is no memory for it").to_string();
        assert!(refusal.contains("needs about"), "{refusal}");
    }
}
