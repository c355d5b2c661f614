//! Flow magnitude: pixels with large optical flow are foreground.

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Threads, words};
use crate::data::{Clip, Flow, Frame, Mask};
use crate::geometry::{Border, Grid, filter};
use crate::methods::numbers::{gray, level, px};
use crate::methods::subtraction::{Background, Explanation, Found, Settings, subtraction_pseudocode};
use crate::params;
use crate::run::{DenseFlow, Info, Need, Stage, StageView};
use crate::scene::{Canvas, Fact, Math, Picture, Role, Sentence};

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
    renamed { "reach" => "window-radius", "open" => "opening", "close" => "closing" }
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
    /// The mean absolute residuals over the window around each pixel in gray levels: without and with motion compensation.
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

    /// Returns whether motion compensation reduces the residual around a pixel.
    fn is_explained(&self, place: (usize, usize)) -> bool {
        self.moved[place] < self.at_rest[place]
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

    fn is_foreground(&self, pair: &FramePair, place: (usize, usize)) -> bool {
        pair.length(place) > self.threshold && pair.is_explained(place)
    }
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

    fn settings(&self) -> Settings {
        self.settings
    }

    /// The flow leads from a frame back to the one before.
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
        let mask = Mask::from_fn(width, height, |x, y| self.is_foreground(pair, (x, y)));
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

    fn explain(&self, [before, _]: [Option<&Model>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let pair = self.compared(before, frame);
        let (is_long, is_explained) = (pair.length(place) > self.threshold, pair.is_explained(place));
        let role = |holds: bool| if holds { Role::Result } else { Role::Rejected };
        let [length, limit] = [pair.length(place), self.threshold].map(|length| px(length.into()));
        let [moved, at_rest] = [pair.moved[place], pair.at_rest[place]].map(gray);
        let vector = words::place(pair.displacement(place));
        let compare = |holds: bool, signs: [&str; 2]| Math::text(signs[usize::from(!holds)]);
        let equation = vec![
            Math::Row(vec![
                Math::Abs(Box::new(Math::ink(Role::Measured, vector.clone()))),
                Math::text(" = "),
                Math::ink(role(is_long), length.clone()),
                compare(is_long, [" > ", " ≤ "]),
                Math::text(limit.clone()),
            ]),
            Math::Row(vec![
                Math::text("mean |I(x, t) − I(x + w, t−1)| = "),
                Math::ink(role(is_explained), moved.clone()),
                compare(is_explained, [" < ", " ≥ "]),
                Math::text(format!("{at_rest} = mean |I(x, t) − I(x, t−1)|")),
            ]),
        ];
        let said = Sentence::default().text(": flow magnitude ").ink(role(is_long), format!("{length} px/frame"));
        let verdict = match (is_long, is_explained) {
            (false, _) => said.text(format!(" is within the threshold {limit} px/frame: background.")),
            (true, true) => said
                .text(format!(" exceeds the threshold {limit} px/frame. Motion compensation lowers the residual to "))
                .ink(role(true), format!("{moved} gray levels"))
                .text(format!(" from {at_rest}: foreground.")),
            (true, false) => said
                .text(format!(" exceeds the threshold {limit} px/frame, but motion compensation leaves a residual of "))
                .ink(role(false), format!("{moved} gray levels"))
                .text(format!(
                    ", not below the {at_rest} without it. The flow has spread from a neighbouring object: background."
                )),
        };
        let update = Sentence::default().text(format!(
            "this frame, with gray level {} here, becomes the reference of the next flow.",
            level(f32::from(frame.luma()[place]))
        ));
        Explanation {
            facts: vec![
                Fact::new("Flow to frame t−1", format!("{vector} px"), Some(Role::Measured)),
                Fact::new("Flow magnitude", format!("{length} px/frame"), Some(role(is_long))),
                Fact::new("Threshold", format!("{limit} px/frame"), None),
                Fact::new("Residual with motion", format!("{moved} gray levels"), Some(role(is_explained))),
                Fact::new("Residual without motion", format!("{at_rest} gray levels"), None),
            ],
            equation,
            matrices: Vec::new(),
            verdict,
            update,
        }
    }

    fn rule(&self) -> String {
        let limit = px(self.threshold.into());
        format!("the flow magnitude exceeds {limit} px/frame, and motion compensation lowers the residual")
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
