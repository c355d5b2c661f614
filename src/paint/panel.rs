//! The pictures that are looked at: a frame, or what becomes of two.

use std::sync::{Arc, LazyLock};

use motionscope_core::base::Error;
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;
use motionscope_core::products::Streaks;
use motionscope_core::scene::{Levels, Measured, Picture};

use super::{FlowLayer, Tint};

/// As many pictures stand side by side at most.
const MOST_BESIDE: usize = 4;

/// What can be looked at: the frames, and what a run has made of them.
#[derive(Clone, Debug)]
pub struct Pictures {
    /// Frames t and t + 1.
    pub pair: [Arc<Frame>; 2],
    /// What the files of the two are called, where each is a file of its own, or which level of a pyramid they are.
    pub names: [Option<String>; 2],
    /// The motion-compensated prediction of frame t, at the end of a run.
    pub prediction: Option<Arc<Frame>>,
    /// The colours that stand over frame t and tell of its motion.
    pub layer: Option<Arc<Tint>>,
    /// The colours that are wanted in their place, where only the end of the run has them.
    pub awaited: Option<FlowLayer>,
    /// Particles carried along by the motion, where they are wanted.
    pub streaks: Option<Arc<Streaks>>,
    /// The pictures that stand side by side, up to four, where those are not frames t and t + 1.
    pub beside: Vec<(Picture, Arc<Frame>)>,
    /// The quantities that the grays of some of them stand for.
    pub measured: Vec<(Picture, Measured)>,
}

impl Pictures {
    /// Two frames of which nothing has been made yet.
    pub fn of(pair: [Arc<Frame>; 2]) -> Self {
        Self {
            pair,
            names: [const { None }; 2],
            prediction: None,
            layer: None,
            awaited: None,
            streaks: None,
            beside: Vec::new(),
            measured: Vec::new(),
        }
    }

    /// The quantity that the grays of `picture` stand for, if they are not gray levels of a frame.
    pub fn measured(&self, picture: Picture) -> Option<&Measured> {
        self.measured.iter().find(|(other, _)| *other == picture).map(|(_, measured)| measured)
    }

    /// What stands above `shown` if frame t has the number `frame`; without names of files and definitions unless it `is_whole`.
    pub fn title(&self, shown: Shown, frame: Option<usize>, is_whole: bool) -> String {
        let measured = if let Panel::Of(picture) = shown.panel { self.measured(picture) } else { None };
        match (measured, is_whole) {
            (Some(measured), true) => measured.title.clone(),
            (Some(measured), false) => measured.symbol.clone(),
            (None, _) => shown.title(frame, if is_whole { &self.names } else { &[const { None }; 2] }),
        }
    }

    /// The pixels of `picture`; of one that is not there, a black one, because no frame stands under the name of another.
    pub fn frame_of(&self, picture: Picture) -> &Arc<Frame> {
        static NONE: LazyLock<Arc<Frame>> = LazyLock::new(|| Arc::new(Frame::gray(Grid::new(1, 1, 0))));
        let [t, next] = &self.pair;
        match picture {
            Picture::CURRENT => t,
            Picture::NEXT => next,
            other => self.beside.iter().find(|(picture, _)| *picture == other).map_or(&*NONE, |(_, frame)| frame),
        }
    }

    /// Whether the step shows what filters made of frame t and not the frame: then these pictures stand in its place.
    pub fn are_filtered(&self) -> bool {
        !self.beside.is_empty() && self.beside.iter().all(|(picture, _)| picture.is_filtered())
    }

    /// What `view` shows where the step works on `levels` of a pyramid: the frames of the level that is `shown`, each of its
    /// pixels as large as it is in the picture. A prediction is of the picture itself.
    #[must_use]
    pub fn on_level(&self, levels: Option<&Levels>, shown: LevelShown, view: View) -> Self {
        let level = levels.map_or(0, |levels| shown.of(levels));
        let Some(levels) = levels.filter(|_| level > 0 && !view.is_of_the_end()) else { return self.clone() };
        let (width, height) = levels.size(level);
        let name = || Some(format!("level {level}, {width}×{height} px"));
        Self { pair: levels.pair(level), names: [name(), name()], ..self.clone() }
    }
}

/// Which level of a pyramid is looked at, where a step works on one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LevelShown {
    /// The one at work: what the search really sees.
    #[default]
    AtWork,
    /// Always this one, or the coarsest if there are fewer; 0 is the picture itself.
    Number(usize),
}

impl LevelShown {
    /// Which of `levels` that is.
    pub fn of(self, levels: &Levels) -> usize {
        match self {
            Self::AtWork => levels.at_work,
            Self::Number(level) => level.min(levels.all.len() - 1),
        }
    }
}

/// The share of frame t + 1 in a blend, 0 to 1; half unless chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share(f32);

impl Default for Share {
    fn default() -> Self {
        Self(0.5)
    }
}

impl Share {
    /// This share, if it is one.
    ///
    /// # Errors
    /// If it does not lie between 0 and 1.
    pub fn new(share: f32) -> Result<Self, Error> {
        let message =
            || Error::new(format!("a blend has a share of frame t+1 from 0 to 1, as in 0.8, and not {share}"));
        (0.0..=1.0).contains(&share).then_some(Self(share)).ok_or_else(message)
    }

    /// Its number.
    pub fn get(self) -> f32 {
        self.0
    }

    /// So much of `next`, and the rest of `current`.
    pub fn mix(self, current: u8, next: u8) -> u8 {
        (f32::from(current) + (f32::from(next) - f32::from(current)) * self.0).round() as u8
    }
}

/// The moment at which streaklines are seen, a share of a particle's life from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phase(f32);

impl Phase {
    /// This moment, if it is one.
    ///
    /// # Errors
    /// If it does not lie between 0 and 1.
    pub fn new(phase: f32) -> Result<Self, Error> {
        let message = || {
            Error::new(format!(
                "streaklines are seen at a moment from 0 to 1 of a particle's life, as 0.5, and not {phase}"
            ))
        };
        (0.0..=1.0).contains(&phase).then_some(Self(phase)).ok_or_else(message)
    }

    /// Its number.
    pub fn get(self) -> f32 {
        self.0
    }
}

/// How the pair of frames is looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum View {
    /// Frame t.
    Current,
    /// Frame t + 1.
    Next,
    /// Both, side by side.
    #[default]
    SideBySide,
    /// How much each pixel changes.
    Difference,
    /// One over the other.
    Blend,
    /// Both in turn. A picture cannot blink, so it shows them side by side.
    Blink,
    /// Frame t put together from where its pixels went in frame t + 1.
    Prediction,
    /// What the prediction lacks.
    Residual,
}

impl View {
    /// Every view.
    pub const ALL: [View; 8] = [
        View::Current,
        View::Next,
        View::SideBySide,
        View::Difference,
        View::Blend,
        View::Blink,
        View::Prediction,
        View::Residual,
    ];

    /// This view where each of several estimators has one picture: during a search of blocks frame t + 1, else frame t.
    #[must_use]
    pub fn alone(self, is_searching: bool) -> Self {
        match self {
            View::SideBySide | View::Blink if is_searching => View::Next,
            View::SideBySide | View::Blink => View::Current,
            view => view,
        }
    }

    /// Stable name, for sessions and the command line.
    pub const fn id(self) -> &'static str {
        match self {
            View::Current => "current",
            View::Next => "next",
            View::SideBySide => "side-by-side",
            View::Difference => "difference",
            View::Blend => "blend",
            View::Blink => "blink",
            View::Prediction => "prediction",
            View::Residual => "residual",
        }
    }

    /// Name as shown.
    pub const fn name(self) -> &'static str {
        match self {
            View::Current => "Frame t",
            View::Next => "Frame t+1",
            View::SideBySide => "Both frames",
            View::Difference => "Difference",
            View::Blend => "Blend",
            View::Blink => "Blink",
            View::Prediction => "Prediction",
            View::Residual => "Residual",
        }
    }

    /// What it shows, in one sentence.
    pub const fn tip(self) -> &'static str {
        match self {
            View::Current => "Frame t alone, the first of the two.",
            View::Next => "Frame t+1 alone, the second of the two.",
            View::SideBySide => "Frame t and frame t+1; the pointer is at the same pixel in both.",
            View::Difference => {
                "How much each pixel changes: black where nothing does, brightened if all change little."
            }
            View::Blend => "One frame over the other, each with an adjustable share: moving objects appear twice.",
            View::Blink => "Both frames by turns in one place: moving objects jump.",
            View::Prediction => {
                "Frame t put together from where its pixels went in frame t+1; there is one at the end of a run."
            }
            View::Residual => {
                "What the prediction of frame t lacks: black where it is right; there is one at the end of a run."
            }
        }
    }

    /// The panels of a still picture of `pictures`, left to right.
    pub fn panels(self, pictures: &Pictures) -> Vec<Panel> {
        match self {
            View::Current if pictures.are_filtered() => View::SideBySide.panels(pictures),
            View::Current => vec![Panel::CURRENT],
            View::Next => vec![Panel::NEXT],
            View::SideBySide | View::Blink if pictures.beside.is_empty() => vec![Panel::CURRENT, Panel::NEXT],
            View::SideBySide | View::Blink => {
                pictures.beside.iter().map(|(picture, _)| Panel::Of(*picture)).take(MOST_BESIDE).collect()
            }
            View::Difference => vec![Panel::Difference],
            View::Blend => vec![Panel::Blend],
            View::Prediction => vec![Panel::Prediction],
            View::Residual => vec![Panel::Residual],
        }
    }

    /// Whether it shows what only the end of a run has.
    pub fn is_of_the_end(self) -> bool {
        matches!(self, View::Prediction | View::Residual)
    }

    /// The view itself, or frame t where what it shows has not been made yet.
    pub fn or_current(self, pictures: &Pictures) -> View {
        if self.is_of_the_end() && pictures.prediction.is_none() { View::Current } else { self }
    }
}

/// One picture on the stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Panel {
    /// A picture by its name: a frame, or what it is compared with.
    Of(Picture),
    /// |frame t+1 − frame t| in gray, brightened so that it can be seen.
    Difference,
    /// One frame over the other.
    Blend,
    /// The motion-compensated prediction of frame t.
    Prediction,
    /// |frame t − prediction| in gray, brightened like a difference.
    Residual,
}

impl Panel {
    /// Frame t.
    pub const CURRENT: Self = Self::Of(Picture::CURRENT);
    /// Frame t + 1.
    pub const NEXT: Self = Self::Of(Picture::NEXT);

    /// The picture whose pixels these are: what is made of two lies where frame t does.
    pub fn picture(self) -> Picture {
        if let Panel::Of(picture) = self { picture } else { Picture::CURRENT }
    }

    /// Whether marks on `picture` are shown here.
    pub fn shows(self, picture: Picture) -> bool {
        match self {
            Panel::Of(own) => picture == own,
            Panel::Difference | Panel::Blend => [Picture::CURRENT, Picture::NEXT].contains(&picture),
            Panel::Prediction | Panel::Residual => picture == Picture::CURRENT,
        }
    }

    /// Whether the colours that tell of motion lie over it: what is made of two frames has to be seen itself.
    pub fn is_tinted(self) -> bool {
        self == Panel::CURRENT
    }

    /// The two frames that it is made of: the one shown, and the one that it is compared or mixed with.
    pub fn frames(self, pictures: &Pictures) -> [&Arc<Frame>; 2] {
        let [t, next] = &pictures.pair;
        let prediction = pictures.prediction.as_ref().unwrap_or(t);
        match self {
            Panel::Of(picture) => [pictures.frame_of(picture), t],
            Panel::Difference | Panel::Blend => [t, next],
            Panel::Prediction => [prediction, t],
            Panel::Residual => [t, prediction],
        }
    }

    /// Its width and height in px, those of its [`pixels`](Self::pixels).
    pub fn size(self, pictures: &Pictures) -> (usize, usize) {
        let [size, other] = self.frames(pictures).map(|frame| frame.size());
        match self {
            Panel::Of(_) | Panel::Prediction => size,
            // What two frames have in common.
            Panel::Difference | Panel::Blend | Panel::Residual => (size.0.min(other.0), size.1.min(other.1)),
        }
    }

    /// Its pixels, opaque, and how many times brighter than the numbers say they are; `share` is for a blend.
    pub fn pixels(self, pictures: &Pictures, share: Share) -> (Grid<[u8; 4]>, u16) {
        let [frame, other] = self.frames(pictures);
        match self {
            Panel::Of(_) | Panel::Prediction => (colors(frame), 1),
            Panel::Difference | Panel::Residual => difference([frame, other]),
            Panel::Blend => {
                let (a, b) = (colors(frame), colors(other));
                let mix = |p: [u8; 4], q: [u8; 4]| std::array::from_fn(|i| share.mix(p[i], q[i]));
                (both(&a, &b, mix), 1)
            }
        }
    }
}

/// A panel as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Which one.
    pub panel: Panel,
    /// The share of frame t + 1, in a blend.
    pub share: Share,
    /// How many times brighter it is than its numbers say.
    pub gain: u16,
}

impl Shown {
    /// What stands above it: `Frame t = 12 · wave_12.png`, without the number where none is known.
    pub fn title(&self, frame: Option<usize>, names: &[Option<String>; 2]) -> String {
        let [t, next] = match frame {
            Some(t) => [t.to_string(), t.saturating_add(1).to_string()],
            None => ["t".into(), "t+1".into()],
        };
        let number = |number: &str| if frame.is_some() { format!(" = {number}") } else { String::new() };
        let name = |i: usize| names[i].as_ref().map_or_else(String::new, |name| format!(" · {name}"));
        // Two files have names of their own, a level is that of both frames.
        let both = if names[0] == names[1] { name(0) } else { String::new() };
        let gain = if self.gain > 1 { format!(" × {}", self.gain) } else { String::new() };
        match self.panel {
            Panel::Of(Picture::NEXT) => format!("{}{}", Picture::NEXT.title(frame), name(1)),
            Panel::Of(picture) => {
                let file = if picture == Picture::CURRENT { name(0) } else { String::new() };
                format!("{}{file}", picture.title(frame))
            }
            Panel::Difference => format!("|frame {next} − frame {t}|{gain}{both}"),
            Panel::Blend if self.share == Share::default() => format!("Mean of frames {t} and {next}{both}"),
            Panel::Blend => {
                let percent = (self.share.get() * 100.0).round();
                format!("{} % frame {t} + {percent} % frame {next}{both}", 100.0 - percent)
            }
            Panel::Prediction => format!("Prediction of frame t{}{}", number(&t), name(0)),
            Panel::Residual => format!("|frame {t} − its prediction|{gain}"),
        }
    }
}

fn colors(frame: &Frame) -> Grid<[u8; 4]> {
    match frame.color() {
        Some(rgb) => rgb.map(|&[r, g, b]| [r, g, b, 255]),
        None => frame.luma().map(|&v| [v, v, v, 255]),
    }
}

/// Cell by cell, over what the two have in common.
fn both<T: Copy, U>(a: &Grid<T>, b: &Grid<T>, f: impl Fn(T, T) -> U) -> Grid<U> {
    Grid::from_fn(a.width().min(b.width()), a.height().min(b.height()), |x, y| f(a[(x, y)], b[(x, y)]))
}

/// The absolute difference of the gray values, times the power of two that brings all but one in a hundred to at most white.
fn difference(frames: [&Arc<Frame>; 2]) -> (Grid<[u8; 4]>, u16) {
    let plain = both(frames[0].luma(), frames[1].luma(), u8::abs_diff);
    let mut counts = [0usize; 256];
    for &v in plain.cells() {
        counts[v as usize] += 1;
    }
    let mut brighter = plain.cells().len() / 100;
    let top = (0..256).rev().find(|&v| {
        let among = counts[v] > brighter;
        brighter = brighter.saturating_sub(counts[v]);
        among
    });
    let gain = [8u16, 4, 2].into_iter().find(|gain| top.is_some_and(|top| top as u16 * gain <= 255)).unwrap_or(1);
    let gray = |&v: &u8| {
        let v = (u16::from(v) * gain).min(255) as u8;
        [v, v, v, 255]
    };
    (plain.map(gray), gain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(value: impl Fn(usize) -> u8) -> Arc<Frame> {
        Arc::new(Frame::gray(Grid::from_fn(200, 1, |x, _| value(x))))
    }

    #[test]
    fn what_filters_make_of_a_frame_stands_in_its_place() {
        let mut pictures = Pictures::of([frame(|_| 0), frame(|_| 1)]);
        assert_eq!(View::Current.panels(&pictures), [Panel::CURRENT]);
        pictures.beside = [Picture::SMOOTHED, Picture::RESPONSE].map(|picture| (picture, frame(|_| 2))).to_vec();
        assert_eq!(View::Current.panels(&pictures), [Picture::SMOOTHED, Picture::RESPONSE].map(Panel::Of));
        assert_eq!(View::Next.panels(&pictures), [Panel::NEXT]);
        pictures.beside.insert(0, (Picture::CURRENT, frame(|_| 0)));
        assert_eq!(View::Current.panels(&pictures), [Panel::CURRENT], "the frame is there itself");
    }

    #[test]
    fn a_difference_is_brightened_until_it_can_be_seen() {
        let shown = |pair| Panel::Difference.pixels(&Pictures::of(pair), Share::default());
        let gain = |change: u8| shown([frame(|_| 0), frame(|x| if x < 100 { change } else { 0 })]).1;
        assert_eq!([gain(3), gain(40), gain(100), gain(200)], [8, 4, 2, 1]);
        let (pixels, gain) = shown([frame(|_| 9), frame(|x| if x == 0 { 250 } else { 19 })]);
        assert_eq!((gain, pixels[(1, 0)][0], pixels[(0, 0)][0]), (8, 80, 255));
    }

    #[test]
    fn a_blend_has_the_share_that_is_asked_for() {
        let blend = |share| Panel::Blend.pixels(&Pictures::of([frame(|_| 10), frame(|_| 20)]), share).0[(0, 0)];
        assert_eq!(blend(Share::default()), [15, 15, 15, 255]);
        let shown = [0.0, 0.8, 1.0].map(|share| blend(Share::new(share).expect("a share")));
        assert_eq!(shown, [[10, 10, 10, 255], [18, 18, 18, 255], [20, 20, 20, 255]]);
        for wrong in [-0.1, 1.01, f32::NAN] {
            let message = Share::new(wrong).expect_err("no share").to_string();
            assert!(message.contains("from 0 to 1"), "{message}");
        }
    }

    #[test]
    fn a_title_tells_place_number_and_file() {
        let names = [Some("a_12.png".to_owned()), Some("a_13.png".to_owned())];
        let title = |panel, share, frame| Shown { panel, share, gain: 8 }.title(frame, &names);
        let half = Share::default();
        assert_eq!(title(Panel::CURRENT, half, Some(12)), "Frame t = 12 · a_12.png");
        assert_eq!(title(Panel::NEXT, half, Some(12)), "Frame t+1 = 13 · a_13.png");
        assert_eq!(title(Panel::Prediction, half, None), "Prediction of frame t · a_12.png");
        assert_eq!(title(Panel::Difference, half, Some(12)), "|frame 13 − frame 12| × 8");
        assert_eq!(title(Panel::Blend, half, None), "Mean of frames t and t+1");
        assert_eq!(title(Panel::Blend, Share(0.8), Some(12)), "20 % frame 12 + 80 % frame 13");
        let level = ["level 2, 80×60 px"; 2].map(|name| Some(name.to_owned()));
        let shown = Shown { panel: Panel::Difference, share: half, gain: 8 };
        assert_eq!(shown.title(Some(12), &level), "|frame 13 − frame 12| × 8 · level 2, 80×60 px");
    }

    #[test]
    fn pictures_beside_each_other_go_by_their_names() {
        let pictures = Pictures {
            beside: vec![(Picture::PREVIOUS, frame(|_| 5)), (Picture::CURRENT, frame(|_| 1))],
            ..Pictures::of([frame(|_| 1), frame(|_| 2)])
        };
        let panels = View::SideBySide.panels(&pictures);
        assert_eq!(panels, [Panel::Of(Picture::PREVIOUS), Panel::CURRENT]);
        assert_eq!(panels[0].pixels(&pictures, Share::default()).0[(0, 0)][0], 5);
        let unknown = Panel::Of(Picture::REFERENCE).pixels(&pictures, Share::default()).0;
        assert_eq!(unknown.size(), (1, 1), "no frame stands under the name of another");
        assert!(panels[0].shows(Picture::PREVIOUS) && !panels[0].shows(Picture::CURRENT));
        let shown = Shown { panel: panels[0], share: Share::default(), gain: 1 };
        assert_eq!(shown.title(Some(12), &[const { None }; 2]), "Frame t−1 = 11");
        assert_eq!(View::Next.panels(&pictures), [Panel::NEXT]);
    }

    #[test]
    fn a_residual_is_what_the_prediction_lacks() {
        let pair = [frame(|_| 100), frame(|_| 7)];
        let without = Pictures::of(pair);
        assert_eq!(View::Residual.or_current(&without), View::Current);
        let pictures = Pictures { prediction: Some(frame(|_| 90)), ..without };
        assert_eq!(View::Residual.or_current(&pictures), View::Residual);
        assert_eq!(Panel::Prediction.pixels(&pictures, Share::default()).0[(3, 0)][0], 90);
        let (pixels, gain) = Panel::Residual.pixels(&pictures, Share::default());
        assert_eq!((pixels[(3, 0)][0], gain), (80, 8));
    }

    #[test]
    fn every_mark_is_seen_in_every_view_of_both() {
        let pictures = Pictures::of([frame(|_| 1), frame(|_| 2)]);
        for view in [View::SideBySide, View::Difference, View::Blend, View::Blink] {
            for picture in [Picture::CURRENT, Picture::NEXT] {
                assert_eq!(view.panels(&pictures).iter().filter(|panel| panel.shows(picture)).count(), 1, "{view:?}");
            }
        }
    }
}
