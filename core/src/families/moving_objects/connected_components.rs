//! Connected components, row by row: labels that grow, and labels that meet.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Mapped, Observer, Threads};
use crate::data::{Clip, Detection, Frame, LabelEvent, Labelling, Mask, PackedMask};
use crate::geometry::Grid;
use crate::methods::subtraction::{Settings, cleaned, need_of_blobs, sifted};
use crate::products::{MaskField, ObjectField, ObjectFrame, Output, Product, ProductKind, Record};
use crate::run::{
    Estimator, Footprint, Frames, Granularity, Guarantee, Info, Masks, Need, Pointed, Progress, Seen, Span, Stage, need,
};
use crate::scene::{Chart, Focus, Scene, Step};
use crate::{choices, params, pseudocode};

use super::FrameDifference;

choices! {
    /// Which pixels are labelled.
    pub enum Pixels {
        /// Those that differ from the frame before; in the first frame, from the one after it.
        Moving = "moving" "Moving",
        /// Those that are brighter than the threshold.
        Bright = "bright" "Bright",
        /// Those that are darker than the threshold.
        Dark = "dark" "Dark",
        /// The foreground that a detector of moving objects finds.
        Foreground = "foreground" "Foreground",
    }
}

params! {
    /// Connected components of each frame.
    pub struct ConnectedComponents {
        /// Which pixels are labelled.
        pixels: Pixels = Pixels::Moving;
        /// Detector whose foreground is labelled, where that is chosen.
        mask: Stage<Masks> = Stage::named("mixture-of-gaussians").with("initial", "median");
        /// By how much they differ, or how bright or dark they are, in gray levels.
        threshold: usize = 8, 0..=255;
        /// What all background subtractions have.
        settings: Settings = Settings { open: 0, close: 4, ..Settings::default() };
    }
    when {
        "mask": |p| p.pixels == Pixels::Foreground, "The detector has no effect unless its foreground is labelled.";
        "threshold": |p| p.pixels != Pixels::Foreground,
            "The threshold has no effect on the foreground of a detector.";
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    span: Span,
    /// The frame at work.
    frame: usize,
    /// The row that comes next; after the last one the labels become final.
    row: usize,
    picture: (usize, usize),
    labelling: Arc<Labelling>,
    record: Record,
    /// The foreground, where a detector finds it.
    foreground: Option<Frames>,
    /// What is made again where it is missing.
    given: Option<Arc<Given>>,
}

/// A frame and its pixels that are labelled.
pub struct Given {
    frame: Arc<Frame>,
    mask: Mask,
}

/// What happens inside a unit.
#[derive(Clone)]
pub enum Event {
    /// A row begins.
    Row(Arc<Given>),
    /// A run of it.
    Run(LabelEvent),
    /// The labels are final: which component each pixel belongs to, and how many there are.
    Final(Arc<Given>, Arc<Grid<u32>>, u32),
    /// The components that are large enough, and the others.
    Kept(Arc<Given>, Arc<[Vec<Detection>; 2]>),
}

impl ConnectedComponents {
    fn given(&self, clip: &Clip, state: &mut State) -> Result<Arc<Given>, Error> {
        if let Some(given) = &state.given {
            return Ok(Arc::clone(given));
        }
        need::check_kept(clip, state.record.bytes() + state.foreground.as_ref().map_or(0, Frames::bytes))?;
        let frame = clip.frame(state.frame)?;
        let (width, height) = frame.size();
        let mask = match self.pixels {
            Pixels::Moving => {
                let other = if state.frame > state.span.first { state.frame - 1 } else { state.frame + 1 };
                let difference = FrameDifference { threshold: self.threshold, ..FrameDifference::default() };
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
        let given = Arc::new(Given { frame, mask: cleaned(self.settings, mask, &mut ()) });
        state.given = Some(Arc::clone(&given));
        Ok(given)
    }

    /// Measures the components, and goes on to the next frame.
    fn finish(
        &self,
        clip: &Clip,
        state: &mut State,
        given: &Arc<Given>,
        observer: &mut impl Observer<Event>,
    ) -> Progress {
        let finals = state.labelling.finals();
        observer.see(|| {
            let labels = finals.grid(&state.labelling, state.picture);
            Event::Final(Arc::clone(given), Arc::new(labels), finals.count)
        });
        let [kept, dropped] = sifted(self.settings, finals.detections(&state.labelling, given.frame.luma()));
        observer.see(|| Event::Kept(Arc::clone(given), Arc::new([kept.clone(), dropped])));
        let found = ObjectFrame { mask: Some(PackedMask::new(&given.mask)), detections: kept, objects: Vec::new() };
        state.record.note(found);
        (state.frame, state.row, state.given) = (state.frame + 1, 0, None);
        state.labelling = Arc::new(Labelling::new(self.settings.connectivity));
        if state.span.is_over(clip, state.frame) { Progress::Done } else { Progress::More }
    }
}

pseudocode! {
    EACH_ROW: "for each row of the mask",
    EACH_RUN: "  for each run of pixels that are set",
    NEW_LABEL: "    if no run of the row above touches it: a new label",
    TAKE_ROOT: "    else take the root of the label of the first that does",
    EACH_OTHER_RUN: "    for each other run that touches it",
    MERGE_ROOTS: "      if its root is another one: hang the larger root below the smaller one",
    LABEL_BY_ROOT: "label each run by its root, in raster order",
    KEEP_BLOBS: "measure area, box, centroid and moments; keep those of min-area px or more",
}

impl Estimator for ConnectedComponents {
    const INFO: Info = Info {
        id: "connected-components",
        name: "Connected components",
        family: "Moving objects",
        summary: "Gives pixels that touch a common label, row by row, and keeps a book of the labels that have met.",
        source: "A. Rosenfeld and J. L. Pfaltz, Sequential operations in digital picture processing, J. ACM 1966; by runs: L. He, \
                 Y. Chao and K. Suzuki, A run-based two-scan labeling algorithm, IEEE Trans. Image Processing 2008",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "row", "run"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const CHARTS: &'static [Chart] = &[Chart::Series];
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
            given: None,
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let given = self.given(clip, state)?;
        if state.row == state.picture.1 {
            return Ok(self.finish(clip, state, &given, observer));
        }
        observer.see(|| Event::Row(Arc::clone(&given)));
        let labelling = Arc::make_mut(&mut state.labelling);
        labelling.row(&given.mask, state.row, &mut Mapped { observer, map: Event::Run });
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

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
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
        State { given: None, ..state.clone() }
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
