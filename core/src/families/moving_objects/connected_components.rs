//! Connected-component labelling, row by row, with a union–find forest of labels.

mod explain;
mod forest;

use std::sync::Arc;

use crate::base::{Error, Mapped, Observer, Threads};
use crate::data::{Clip, Detection, Frame, LabelEvent, Labelling, Mask, PackedMask};
use crate::geometry::Grid;
use crate::methods::subtraction::{Channels, Settings, cleaned, need_of_blobs, sifted};
use crate::products::{MaskField, ObjectField, ObjectFrame, Output, Product, ProductKind, Record};
use crate::run::{
    Estimator, Footprint, Frames, Granularity, Guarantee, Info, Masks, Need, Pointed, Progress, Seen, Span, Stage, need,
};
use crate::scene::{Chart, Focus, Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};

use super::FrameDifference;

choices! {
    /// The mask that is labelled.
    pub enum Pixels {
        /// Frame difference: pixels that differ from the previous frame; in the first frame from the next one.
        Moving = "moving" "Frame difference",
        /// Pixels brighter than the threshold.
        Bright = "bright" "Bright",
        /// Pixels darker than the threshold.
        Dark = "dark" "Dark",
        /// The foreground mask of a background subtraction.
        Foreground = "foreground" "Foreground",
    }
}

params! {
    /// Connected components of a mask of each frame.
    pub struct ConnectedComponents {
        /// Mask that is labelled.
        pixels: Pixels = Pixels::Moving;
        /// Detector of the foreground mask. Used with pixels = foreground only.
        mask: Stage<Masks> = Stage::named("mixture-of-gaussians").with("initial", "median");
        /// Threshold on the difference or on the brightness, in gray levels. Not used with pixels = foreground.
        threshold: usize = 8, 0..=255;
        /// The parameters of all background subtractions.
        settings: Settings = Settings { opening: 0, area_opening: 9, closing: 4, ..Settings::default() };
    }
    when {
        "mask": |p| p.pixels == Pixels::Foreground, "The detector has no effect unless its foreground is labelled.";
        "threshold": |p| p.pixels != Pixels::Foreground,
            "The threshold has no effect on the foreground of a detector.";
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    span: Span,
    /// The current frame.
    frame: usize,
    /// The next row; after the last one the labels become final.
    row: usize,
    picture: (usize, usize),
    labelling: Arc<Labelling>,
    record: Record,
    /// The masks of the detector, where one is used.
    foreground: Option<Frames>,
    /// The current frame and its mask; recomputed where missing.
    masked: Option<Arc<MaskedFrame>>,
}

/// A frame and the mask that is labelled.
pub struct MaskedFrame {
    frame: Arc<Frame>,
    mask: Mask,
}

/// The events of a unit.
#[derive(Clone)]
pub enum Event {
    /// A row starts, with this number of foreground pixels.
    Row(Arc<MaskedFrame>, u32),
    /// The labelling of a run of pixels.
    Run(LabelEvent),
    /// The final label of each pixel and the number of components.
    Final(Arc<MaskedFrame>, Arc<Grid<u32>>, u32),
    /// The components of at least the minimum area, and the others.
    Kept(Arc<MaskedFrame>, Arc<[Vec<Detection>; 2]>),
}

impl ConnectedComponents {
    fn masked(&self, clip: &Clip, state: &mut State) -> Result<Arc<MaskedFrame>, Error> {
        if let Some(masked) = &state.masked {
            return Ok(Arc::clone(masked));
        }
        need::check_kept(clip, state.record.bytes() + state.foreground.as_ref().map_or(0, Frames::bytes))?;
        let frame = clip.frame(state.frame)?;
        let (width, height) = frame.size();
        let mask = match self.pixels {
            Pixels::Moving => {
                let other = if state.frame > state.span.first { state.frame - 1 } else { state.frame + 1 };
                let (threshold, channels) = (self.threshold, Channels::Gray);
                let difference = FrameDifference { threshold, channels, ..FrameDifference::default() };
                difference.differs(&[clip.frame(other)?], &frame, &Threads::single())
            }
            Pixels::Foreground => {
                let found = state.foreground.as_ref().map(|frames| frames.at(state.frame)).transpose()?.flatten();
                let mask = found.and_then(|found| found.mask.as_ref().map(PackedMask::unpacked));
                mask.unwrap_or_else(|| Mask::new(width, height))
            }
            Pixels::Bright => Mask::from_fn(width, height, |x, y| usize::from(frame.luma()[(x, y)]) > self.threshold),
            Pixels::Dark => Mask::from_fn(width, height, |x, y| usize::from(frame.luma()[(x, y)]) < self.threshold),
        };
        let masked = Arc::new(MaskedFrame { frame, mask: cleaned(self.settings, mask, &mut ()) });
        state.masked = Some(Arc::clone(&masked));
        Ok(masked)
    }

    /// Measures the components and moves on to the next frame.
    fn finish(
        &self,
        clip: &Clip,
        state: &mut State,
        masked: &Arc<MaskedFrame>,
        observer: &mut impl Observer<Event>,
    ) -> Progress {
        let finals = state.labelling.finals();
        observer.see(|| {
            let labels = finals.grid(&state.labelling, state.picture);
            Event::Final(Arc::clone(masked), Arc::new(labels), finals.count)
        });
        let [kept, dropped] =
            sifted(self.settings, state.picture, finals.detections(&state.labelling, masked.frame.luma()));
        observer.see(|| Event::Kept(Arc::clone(masked), Arc::new([kept.clone(), dropped])));
        let found = ObjectFrame { mask: Some(PackedMask::new(&masked.mask)), detections: kept, objects: Vec::new() };
        state.record.note(found);
        (state.frame, state.row, state.masked) = (state.frame + 1, 0, None);
        state.labelling = Arc::new(Labelling::new(self.settings.connectivity));
        if state.span.is_over(clip, state.frame) { Progress::Done } else { Progress::More }
    }
}

pseudocode! {
    EACH_ROW: "for each row of the mask",
    EACH_RUN: "  for each run of foreground pixels",
    NEW_LABEL: "    if it touches no run of the row above: new label",
    TAKE_ROOT: "    else label ← root of the first run that it touches",
    EACH_OTHER_RUN: "    for each further run above that it touches",
    MERGE_ROOTS: "      if the roots differ: union, the larger root becomes a child of the smaller",
    LABEL_BY_ROOT: "final label of each run ← number of its root, in raster order",
    KEEP_BLOBS: "blobs ← area, box, centroid, moments of components with area ≥ min-area",
}

impl Estimator for ConnectedComponents {
    const INFO: Info = Info {
        id: "connected-components",
        name: "Connected components",
        family: "Moving objects",
        summary: "Labels connected foreground pixels row by row and merges equivalent labels in a union–find forest.",
        source: "A. Rosenfeld and J. L. Pfaltz, Sequential operations in digital picture processing, J. ACM 1966; by runs: L. He, \
                 Y. Chao and K. Suzuki, A run-based two-scan labeling algorithm, IEEE Trans. Image Processing 2008",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "row", "run"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "label",
            "Which label does the next run of foreground pixels take?",
            &[
                Reply::at(line::NEW_LABEL, "A new one: it touches no run above"),
                Reply::at(line::TAKE_ROOT, "That of a run above"),
            ],
        ),
        Question::choice(
            "union",
            "Do the two runs above have the same root?",
            &[Reply::at(line::EACH_OTHER_RUN, "Yes: no union is needed"), Reply::at(line::MERGE_ROOTS, "No: union")],
        ),
    ];
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const CHARTS: &'static [Chart] = &[Chart::Diagram, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[MaskField::KIND, ObjectField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let span = Span::new(clip, frame, self.settings.frames)?;
        let foreground = match self.pixels {
            Pixels::Foreground => Some(self.mask.frames(clip, span.first, span.most())?),
            Pixels::Moving | Pixels::Bright | Pixels::Dark => None,
        };
        Ok(State {
            span,
            foreground,
            frame,
            row: 0,
            picture: clip.size(),
            labelling: Arc::new(Labelling::new(self.settings.connectivity)),
            record: Record::default(),
            masked: None,
        })
    }

    fn earlier_frames(&self) -> Option<usize> {
        match self.pixels {
            Pixels::Foreground => self.mask.estimator().earlier_frames(),
            Pixels::Moving | Pixels::Bright | Pixels::Dark => Some(1),
        }
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let masked = self.masked(clip, state)?;
        if state.row == state.picture.1 {
            return Ok(self.finish(clip, state, &masked, observer));
        }
        let row = masked.mask.row(state.row);
        observer.see(|| Event::Row(Arc::clone(&masked), row.iter().map(|word| word.count_ones()).sum()));
        let labelling = Arc::make_mut(&mut state.labelling);
        labelling.row(&masked.mask, state.row, &mut Mapped { observer, map: Event::Run });
        state.row += 1;
        Ok(Progress::More)
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.span.frames().map(|frames| frames * (state.picture.1 + 1))
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let mut place = state.span.place(state.frame - state.span.first);
        place.push(Granularity { index: state.row, of: Some(state.picture.1 + 1) });
        place
    }

    fn units_of(&self, (_, height): (usize, usize), frames: usize) -> Option<usize> {
        Some(frames * (height + 1))
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.frame)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        matches!(event, Event::Run(LabelEvent::Merged(..))).then_some(Role::Result)
    }

    fn is_idle(&self, event: &Event) -> bool {
        matches!(event, Event::Row(_, 0))
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        state.record.output(state.picture, state.span.first)
    }
}

impl Footprint<State> for ConnectedComponents {
    fn need(&self, clip: &Clip) -> Need {
        let own = need_of_blobs(clip, self.settings, Need::per_pixel(clip, [2.0, 8.0]));
        match self.pixels {
            Pixels::Foreground => own.and([self.mask.need(clip).run as f64; 2]),
            Pixels::Moving | Pixels::Bright | Pixels::Dark => own,
        }
    }

    fn at_rest(&self, state: &State) -> State {
        State { masked: None, ..state.clone() }
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + state.labelling.bytes() + state.record.own_bytes()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + state.record.shared_bytes() + state.foreground.as_ref().map_or(0, Frames::bytes)
    }
}

impl Pointed<State> for ConnectedComponents {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        let y = point[1] + 0.5;
        let row = (0.0..state.picture.1 as f32).contains(&y).then_some(y as usize)?;
        Some((state.frame - state.span.first) * (state.picture.1 + 1) + row)
    }
}
