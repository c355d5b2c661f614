//! Flow magnitude: what moves is where the optical flow is long.

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Threads, words};
use crate::data::{Clip, Flow, Frame, Mask};
use crate::geometry::{Border, Grid, filter};
use crate::methods::subtraction::{Background, Explanation, Found, Settings, subtraction_pseudocode};
use crate::params;
use crate::run::{DenseFlow, Info, Need, Stage, StageView};
use crate::scene::{Canvas, Fact, Math, Picture, Role, Sentence};

params! {
    /// The length of the optical flow.
    pub struct FlowMagnitude {
        /// Method that estimates the optical flow.
        method: Stage<DenseFlow> = Stage::named("farneback");
        /// A pixel that has moved farther than this since the frame before is foreground, if the flow explains it.
        threshold: f32 = 1.0, 0.0..=50.0, "px/frame";
        /// How far the pixels around a pixel reach that have to fit better where the flow leads than at rest; a smooth flow goes on beyond the edges of what moves.
        reach: usize = 1, 0..=15, "px";
        /// What all background subtractions have.
        settings: Settings = Settings { open: 1, close: 3, ..Settings::default() };
    }
}

/// The frame before, and what is seen of the next one beside it as soon as somebody asks.
#[derive(Clone)]
pub struct Model {
    before: Arc<Frame>,
    seen: OnceLock<Arc<Seen>>,
}

/// A frame beside the one before.
struct Seen {
    /// Where each pixel was in the frame before; where nobody knows, it has not moved.
    back: Flow,
    /// How far pixels differ from those at their own place in the frame before, and from those where the flow leads, in gray
    /// levels, on average over the pixels around each.
    at_rest: Grid<f32>,
    moved: Grid<f32>,
}

impl Seen {
    /// How far a pixel has moved, in px.
    fn length(&self, (x, y): (usize, usize)) -> f32 {
        let [u, v] = self.displacement((x, y));
        u.hypot(v)
    }

    fn displacement(&self, (x, y): (usize, usize)) -> [f32; 2] {
        self.back.at(x, y).unwrap_or_default()
    }

    /// Whether the flow explains what is seen around a pixel better than no motion at all.
    fn is_explained(&self, place: (usize, usize)) -> bool {
        self.moved[place] < self.at_rest[place]
    }
}

impl FlowMagnitude {
    /// What is seen of a frame that was looked at.
    fn seen<'a>(&self, model: &'a Model, frame: &Frame) -> &'a Seen {
        model.seen.get_or_init(|| {
            let (width, height) = frame.size();
            Arc::new(self.beside([frame, &model.before], Flow(Grid::new(width, height, [0.0; 2])), &Threads::single()))
        })
    }

    /// A frame beside the one before, from which `back` leads to that.
    fn beside(&self, frames: [&Frame; 2], back: Flow, threads: &Threads) -> Seen {
        let [now, before] = frames.map(|frame| frame.luma());
        let (width, height) = now.size();
        let gray = |x: usize, y: usize| f32::from(now[(x, y)]);
        let off = |place: &dyn Fn(usize, usize) -> [f32; 2]| {
            let off = Grid::from_fn(width, height, |x, y| {
                let [u, v] = place(x, y);
                (gray(x, y) - before.sample(x as f32 + u, y as f32 + v)).abs()
            });
            let side = 2 * self.reach + 1;
            let weights = vec![1.0 / side as f32; side];
            filter::separable(&off, (&weights, &weights), Border::Replicate, threads)
        };
        let at_rest = off(&|_, _| [0.0; 2]);
        let moved = off(&|x, y| back.at(x, y).unwrap_or_default());
        Seen { at_rest, moved, back }
    }

    fn is_foreground(&self, seen: &Seen, place: (usize, usize)) -> bool {
        seen.length(place) > self.threshold && seen.is_explained(place)
    }
}

subtraction_pseudocode! {
    begin: "the first frame is the one before the second",
    compare: "  w ← optical flow from frame t back to frame t−1",
    decide: "  foreground if |w| > threshold, and around it Σ |I(x, t) − I(x + w, t−1)| < Σ |I(x, t) − I(x, t−1)|",
    update: "  frame t is the one before the next",
}

impl Background for FlowMagnitude {
    const INFO: Info = Info {
        id: "flow-magnitude",
        name: "Flow magnitude",
        family: "Moving objects",
        summary: "Takes for moving what has moved since the frame before, by optical flow: needs no background, but texture.",
        source: "Length of the flow over a threshold: S. Denman, V. Chandran and S. Sridharan, An adaptive optical flow technique \
                 for person tracking systems, Pattern Recognition Letters 28, 2007; displaced against undisplaced frame \
                 difference: A. M. Tekalp, Digital video processing, 1995",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|w| in px/frame";
    const COMPARED: &'static str = "length of the optical flow";
    type Model = Model;

    fn settings(&self) -> Settings {
        self.settings
    }

    /// The flow leads from a frame back to the one before.
    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        clip.reversed(now.saturating_sub(1)).map(|clip| Some(StageView { clip, set: Vec::new() }))
    }

    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.method.need(clip);
        // What is kept of a frame is the flow and two differences.
        Need { run, ..Need::per_pixel(clip, [0.0, 20.0]) }.and([0.0, run as f64 / 4.0])
    }

    fn begin(&self, first: &Arc<Frame>) -> Model {
        Model { before: Arc::clone(first), seen: OnceLock::new() }
    }

    fn look(&self, clip: &Clip, model: &Model, frame: &Frame, threads: &Threads) -> Result<(), Error> {
        if model.seen.get().is_some() {
            return Ok(());
        }
        let back = self.method.between(clip, [frame, &model.before], threads)?;
        model.seen.get_or_init(|| Arc::new(self.beside([frame, &model.before], back, threads)));
        Ok(())
    }

    fn subtract(&self, model: &mut Model, frame: &Arc<Frame>, _: &Threads) -> Found {
        let seen = self.seen(model, frame);
        let (width, height) = frame.size();
        let mask = Mask::from_fn(width, height, |x, y| self.is_foreground(seen, (x, y)));
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
        self.seen(model, frame).length(place)
    }

    fn explain(&self, [before, _]: [Option<&Model>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let seen = self.seen(before, frame);
        let (is_long, is_explained) = (seen.length(place) > self.threshold, seen.is_explained(place));
        let role = |holds: bool| if holds { Role::Result } else { Role::Rejected };
        let [length, limit] = [seen.length(place), self.threshold].map(words::number);
        let [moved, at_rest] = [seen.moved[place], seen.at_rest[place]].map(words::number);
        let vector = words::vector(seen.displacement(place));
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
                Math::text("off where it leads: "),
                Math::ink(role(is_explained), moved.clone()),
                compare(is_explained, [" < ", " ≥ "]),
                Math::text(format!("{at_rest}, off at rest")),
            ]),
        ];
        let said = Sentence::default()
            .text(" was ")
            .ink(role(is_long), format!("{length} px"))
            .text(" away in the frame before, ");
        let verdict = match (is_long, is_explained) {
            (false, _) => said.text(format!("not more than {limit} px: background.")),
            (true, true) => said
                .text(format!("more than {limit} px, and what is around it fits better there, "))
                .ink(role(true), format!("{moved} gray levels"))
                .text(format!(" off, than at rest, {at_rest} off: foreground.")),
            (true, false) => said
                .text(format!("more than {limit} px, but what is around it fits no better there, "))
                .ink(role(false), format!("{moved} gray levels"))
                .text(format!(
                    " off, than at rest, {at_rest} off: the flow of something beside it reaches over it, background."
                )),
        };
        Explanation {
            facts: vec![
                Fact::new("Flow back", format!("{vector} px"), Some(Role::Measured)),
                Fact::new("Speed", format!("{length} px/frame"), Some(role(is_long))),
                Fact::new("Threshold", format!("{limit} px/frame"), None),
                Fact::new("Off where it leads", format!("{moved} gray levels"), Some(role(is_explained))),
                Fact::new("Off at rest", format!("{at_rest} gray levels"), None),
            ],
            equation,
            matrices: Vec::new(),
            verdict,
        }
    }

    fn rule(&self) -> String {
        let limit = words::number(self.threshold);
        format!("have moved by more than {limit} px and fit better where they come from than at rest")
    }

    fn update(&self) -> String {
        "This frame is what the next one is compared with".into()
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
    fn a_refusal_of_the_method_is_told() {
        let frame = Arc::new(Frame::gray(Grid::new(64, 48, 7)));
        let clip = Clip::from_frames("gray", vec![Frame::clone(&frame); 2]).expect("frames of one size");
        let (magnitude, threads) = (FlowMagnitude::default(), Threads::single());
        let look = |clip: &Clip| magnitude.look(clip, &magnitude.begin(&frame), &frame, &threads);
        assert_eq!(look(&clip), Ok(()));
        let refusal = look(&clip.within(1)).expect_err("there is no memory for it").to_string();
        assert!(refusal.contains("would take about"), "{refusal}");
    }
}
