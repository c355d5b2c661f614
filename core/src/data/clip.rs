//! A clip: frames that come lazily, and the truth about them where it is known.

use std::fmt;
use std::sync::Arc;

use super::{Calibration, Detection, Disparity, Pose, TrueMask, Viewpoint};
use crate::base::{Error, Stop};
use crate::geometry::{Bounds, Gray, Grid};

/// One picture of a clip: its gray values, and its colours if it has any.
///
/// Gray is 0.299 R + 0.587 G + 0.114 B, rounded to 8 bits. Both grids have one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    gray: Gray,
    rgb: Option<Grid<[u8; 3]>>,
}

impl Frame {
    /// A frame without colour.
    pub fn gray(gray: Gray) -> Self {
        Self { gray, rgb: None }
    }

    /// A frame in colour; its gray values follow from it.
    pub fn rgb(rgb: Grid<[u8; 3]>) -> Self {
        // Weights in 1/2¹⁶ sum to exactly one, so that gray stays gray.
        let gray = rgb.map(|&[r, g, b]| {
            ((19_595 * u32::from(r) + 38_470 * u32::from(g) + 7_471 * u32::from(b) + 32_768) >> 16) as u8
        });
        Self { gray, rgb: Some(rgb) }
    }

    /// The gray values, 0 to 255.
    pub fn luma(&self) -> &Gray {
        &self.gray
    }

    /// The colours, if the picture has any.
    pub fn color(&self) -> Option<&Grid<[u8; 3]>> {
        self.rgb.as_ref()
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (usize, usize) {
        self.gray.size()
    }

    /// Memory that the pixels take.
    pub fn bytes(&self) -> usize {
        self.gray.cells().len() * if self.rgb.is_some() { 4 } else { 1 }
    }
}

/// A dense displacement field in px/frame from frame t to t+1; a pixel whose motion is not known holds NaN.
#[derive(Clone, Debug)]
pub struct Flow(pub Grid<[f32; 2]>);

/// Two are equal where both are unknown as well.
impl PartialEq for Flow {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&f32, &f32)| a == b || a.is_nan() && b.is_nan();
        let [cells, others] = [self, other].map(|flow| flow.0.cells().as_flattened());
        self.0.size() == other.0.size() && cells.iter().zip(others).all(same)
    }
}

impl Flow {
    /// What a pixel of unknown motion holds.
    pub const UNKNOWN: [f32; 2] = [f32::NAN; 2];

    /// The displacement `[u, v]` at `(x, y)` if it is known.
    pub fn at(&self, x: usize, y: usize) -> Option<[f32; 2]> {
        self.0.get(x, y).copied().filter(|uv| uv.iter().all(|c| c.is_finite()))
    }

    /// Whether a place in image pixels lies in the picture, whose pixels reach half a px around their centres.
    pub fn holds(&self, [x, y]: [f32; 2]) -> bool {
        let inside = |c: f32, extent: usize| (-0.5..=extent as f32 - 0.5).contains(&c);
        inside(x, self.0.width()) && inside(y, self.0.height())
    }

    /// The displacement at a place between pixels, bilinear; `None` outside, and where one that counts is not known.
    pub fn sample(&self, place: [f32; 2]) -> Option<[f32; 2]> {
        if !self.holds(place) {
            return None;
        }
        let (width, height) = self.0.size();
        let part = |c: f32, extent: usize| {
            let c = c.clamp(0.0, (extent - 1) as f32);
            (c as usize, c.fract())
        };
        let ((x, fx), (y, fy)) = (part(place[0], width), part(place[1], height));
        let mut sum = [0.0; 2];
        for (dx, dy, weight) in
            [(0, 0, (1.0 - fx) * (1.0 - fy)), (1, 0, fx * (1.0 - fy)), (0, 1, (1.0 - fx) * fy), (1, 1, fx * fy)]
        {
            if weight > 0.0 {
                let uv = self.at(x + dx, y + dy)?;
                sum = [0, 1].map(|i| sum[i] + weight * uv[i]);
            }
        }
        Some(sum)
    }
}

/// One object of the truth in one frame: MOTChallenge's row in our pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectBox {
    /// Identity, the same in every frame.
    pub id: u32,
    /// Left edge in px.
    pub x: f32,
    /// Top edge in px.
    pub y: f32,
    /// Width in px.
    pub width: f32,
    /// Height in px.
    pub height: f32,
    /// Share of the object that can be seen, 0 to 1.
    pub visibility: f32,
}

impl From<&ObjectBox> for Bounds {
    fn from(object: &ObjectBox) -> Self {
        let min = [object.x, object.y];
        Self { min, max: [min[0] + object.width, min[1] + object.height] }
    }
}

/// What is known about a clip beyond its pixels. `Ok(None)` where nothing is known for that frame.
pub trait Truth: Send + Sync {
    /// Where each pixel of frame `t` goes in frame `t + 1`.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn flow(&self, t: usize) -> Result<Option<Arc<Flow>>, Error>;

    /// Whether that flow is the one of a homography, which holds for one plane of the scene: what lies off it moves otherwise.
    fn is_of_plane(&self, _t: usize) -> bool {
        false
    }

    /// Pixels of frame `t` that are hidden in frame `t + 1`.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn occlusion(&self, _t: usize) -> Result<Option<Arc<Grid<bool>>>, Error> {
        Ok(None)
    }

    /// The objects in frame `t`, by identity.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn objects(&self, _t: usize) -> Result<Option<Vec<ObjectBox>>, Error> {
        Ok(None)
    }

    /// The boxes of frame `t` that a benchmark does not score: an estimate that matches one of them is neither right nor wrong.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn ignored_objects(&self, _t: usize) -> Result<Vec<ObjectBox>, Error> {
        Ok(Vec::new())
    }

    /// The pose of rigid object `id` in frame `t`, in the coordinates of the camera.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn pose(&self, _id: u32, _t: usize) -> Result<Option<Pose>, Error> {
        Ok(None)
    }

    /// The true foreground of frame `t`.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn foreground(&self, _t: usize) -> Result<Option<Arc<TrueMask>>, Error> {
        Ok(None)
    }

    /// The true label of each pixel of frame `t`, from 1 on; 0 where it is not known. Pixels of one label move together, and a label is
    /// the same in all frames.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn segments(&self, _t: usize) -> Result<Option<Arc<Grid<u32>>>, Error> {
        Ok(None)
    }

    /// The true map of the background from frame `t` to frame `t` + 1, a 3×3 matrix by rows in px: the apparent motion that the
    /// camera causes.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn background(&self, _t: usize) -> Result<Option<[[f64; 3]; 3]>, Error> {
        Ok(None)
    }

    /// The disparity of each pixel of frame `t` of the left view.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn disparity(&self, _t: usize) -> Result<Option<Arc<Disparity>>, Error> {
        Ok(None)
    }

    /// The disparity that the point at each pixel of frame `t` of the left view has in frame `t` + 1.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn next_disparity(&self, _t: usize) -> Result<Option<Arc<Disparity>>, Error> {
        Ok(None)
    }

    /// The rigid motion of all that is at rest from frame `t` to frame `t` + 1, in the coordinates of the left camera at each of them.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn ego_motion(&self, _t: usize) -> Result<Option<Pose>, Error> {
        Ok(None)
    }

    /// Pixels of frame `t` of the left view that the right view does not show: half-occluded, or beside its picture.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    fn half_occlusion(&self, _t: usize) -> Result<Option<Arc<Grid<bool>>>, Error> {
        Ok(None)
    }

    /// What kinds of truth there are, in words for a person: `flow`, `occlusion`, `segments`, `objects`, `foreground`, `disparity`.
    fn kinds(&self) -> Vec<&'static str>;

    /// What each of these kinds was read from, as `flow10.flo`; nothing for truth that is computed.
    fn names(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Where frames come from. Reading may take long: never call it on the window's thread.
pub trait FrameSource: Send + Sync {
    /// Frame `index`, all of the clip's size. Work that takes longer than a frame looks at `stop` now and then.
    ///
    /// # Errors
    /// One sentence if the frame does not exist, is damaged, or was given up because of `stop`.
    fn frame(&self, index: usize, stop: &Stop) -> Result<Arc<Frame>, Error>;

    /// Frame `index` if it is at hand without any work.
    fn cached(&self, index: usize) -> Option<Arc<Frame>>;

    /// Whether there is a frame `index`, for clips of which nobody knows how many frames they have.
    ///
    /// # Errors
    /// One sentence if that cannot be told: it is damaged, or was given up because of `stop`.
    fn has_frame(&self, index: usize, stop: &Stop) -> Result<bool, Error> {
        self.frame(index, stop).map(|_| true)
    }

    /// What frame `index` is called by itself, if it is more than a number.
    fn name(&self, _index: usize) -> Option<String> {
        None
    }

    /// Whether the frames are empty paper for what is known without pictures.
    fn is_blank(&self) -> bool {
        false
    }
}

/// Depths that a sensor measured, a picture for each frame of a clip.
pub trait DepthSource: Send + Sync {
    /// The depth Z of each pixel of frame `t` in m; NaN where it is not known. `None` if there is no such picture.
    ///
    /// # Errors
    /// If it cannot be read.
    fn depth_m(&self, t: usize) -> Result<Option<Arc<Grid<f32>>>, Error>;
}

/// Facts about a clip that are known when it is opened.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipInfo {
    /// Name to show: the file's or folder's.
    pub name: String,
    /// Width in pixels of every frame.
    pub width: usize,
    /// Height in pixels of every frame.
    pub height: usize,
    /// Number of frames; `None` where counting would need decoding the whole file.
    pub frames: Option<usize>,
    /// Mean frames per second, if the clip says.
    pub fps: Option<f64>,
    /// What holds the frames: `mp4`, `y4m`, `images`, `synthetic` …
    pub container: String,
    /// How the frames are coded: `h264`, `png`, `rgb24` …
    pub codec: String,
    /// What a person should know: lost frames, colours reduced …
    pub warnings: Vec<String>,
}

/// A clip of numbered frames, all of one size.
#[derive(Clone)]
pub struct Clip {
    info: Arc<ClipInfo>,
    frames: Arc<dyn FrameSource>,
    truth: Option<Arc<dyn Truth>>,
    detections: Option<Arc<Vec<Vec<Detection>>>>,
    right: Option<Arc<Clip>>,
    depths: Option<Arc<dyn DepthSource>>,
    calibration: Option<Calibration>,
    stop: Stop,
    budget: Option<u64>,
}

impl fmt::Debug for Clip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Clip").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Clip {
    /// A clip of frames that `frames` delivers.
    pub fn new(info: ClipInfo, frames: Arc<dyn FrameSource>) -> Self {
        Self {
            info: Arc::new(info),
            frames,
            truth: None,
            detections: None,
            right: None,
            depths: None,
            calibration: None,
            stop: Stop::default(),
            budget: None,
        }
    }

    /// A clip of frames in memory.
    ///
    /// # Errors
    /// If there is no frame, or not all have one size.
    pub fn from_frames(name: impl Into<String>, frames: Vec<Frame>) -> Result<Self, Error> {
        let name = name.into();
        let Some((width, height)) = frames.first().map(Frame::size) else {
            return Err(Error::new(format!("{name} has no frames")));
        };
        if let Some(odd) = frames.iter().position(|f| f.size() != (width, height)) {
            let (w, h) = frames[odd].size();
            return Err(Error::new(format!("{name}: frame {odd} is {w}×{h}, the first is {width}×{height}")));
        }
        let info = ClipInfo {
            name,
            width,
            height,
            frames: Some(frames.len()),
            fps: None,
            container: "memory".into(),
            codec: "raw".into(),
            warnings: Vec::new(),
        };
        Ok(Self::new(info, Arc::new(InMemory(frames.into_iter().map(Arc::new).collect()))))
    }

    /// A clip of empty pictures, for what is known without any: detections.
    ///
    /// # Panics
    /// If the pictures have no pixels.
    pub fn blank(name: impl Into<String>, (width, height): (usize, usize), frames: usize) -> Self {
        let info = ClipInfo {
            name: name.into(),
            width,
            height,
            frames: Some(frames),
            fps: None,
            container: "detections".into(),
            codec: "none".into(),
            warnings: Vec::new(),
        };
        Self::new(info, Arc::new(Blank(Arc::new(Frame::gray(Grid::new(width, height, PAPER))))))
    }

    /// The same clip with `truth` beside it.
    pub fn with_truth(mut self, truth: Arc<dyn Truth>) -> Self {
        self.truth = Some(truth);
        self
    }

    /// The same clip with detections in its frames beside it, from frame 0 on; in later ones nothing.
    pub fn with_detections(mut self, detections: Vec<Vec<Detection>>) -> Self {
        self.detections = Some(Arc::new(detections));
        self
    }

    /// The same clip with the detections of `other` in the place of its own.
    pub fn with_detections_of(mut self, other: &Clip) -> Self {
        self.detections.clone_from(&other.detections);
        self
    }

    /// The same clip as the left view of a rectified pair of cameras, with the frames of `right` as the right one.
    ///
    /// # Errors
    /// If both views differ in size, or in a known number of frames.
    pub fn with_right(mut self, right: Clip) -> Result<Self, Error> {
        if self.size() != right.size() {
            let ((w, h), (rw, rh)) = (self.size(), right.size());
            return Err(Error::new(format!(
                "the left view is {w}×{h} px and the right view {rw}×{rh} px; rectified views have one size"
            )));
        }
        if let (Some(left), Some(frames)) = (self.info.frames, right.info.frames)
            && left != frames
        {
            return Err(Error::new(format!(
                "the left view has {left} frames and the right view {frames}; both views must show the same moments"
            )));
        }
        self.right = Some(Arc::new(right));
        Ok(self)
    }

    /// The same clip with depths that were measured beside its frames.
    #[must_use]
    pub fn with_depths(mut self, depths: Arc<dyn DepthSource>) -> Self {
        self.depths = Some(depths);
        self
    }

    /// Whether depths were measured beside its frames.
    pub fn has_depths(&self) -> bool {
        self.depths.is_some()
    }

    /// The measured depth of each pixel of frame `t` in m, if it is known; NaN where it is not.
    ///
    /// # Errors
    /// If it cannot be read, or has another size than the frames.
    pub fn depth_m(&self, t: usize) -> Result<Option<Arc<Grid<f32>>>, Error> {
        let found = self.depths.as_ref().map(|depths| depths.depth_m(t)).transpose()?.flatten();
        match found {
            Some(depth) if depth.size() != self.size() => {
                let ((w, h), (dw, dh)) = (self.size(), depth.size());
                Err(Error::new(format!(
                    "the depths of frame {t} are {dw}×{dh} px and the frames {w}×{h} px; both must have one size"
                )))
            }
            found => Ok(found),
        }
    }

    /// The same clip with the calibration of its two cameras.
    #[must_use]
    pub fn with_calibration(mut self, calibration: Calibration) -> Self {
        self.calibration = Some(calibration);
        self
    }

    /// The same clip with other facts told about it.
    pub fn with_info(mut self, info: ClipInfo) -> Self {
        self.info = Arc::new(info);
        self
    }

    /// The same clip, whose frames, and runs on it, are given up while `stop` is set; other copies of the clip do not notice.
    pub fn until(mut self, stop: Stop) -> Self {
        self.stop = stop;
        self
    }

    /// The same clip, on which a run may take so many bytes of memory, whatever the machine has.
    #[must_use]
    pub fn within(mut self, bytes: u64) -> Self {
        self.budget = Some(bytes);
        self
    }

    /// The bytes of memory that a run on the clip may take: as many as it was given, or as are free.
    pub fn room(&self) -> u64 {
        self.budget.unwrap_or_else(crate::base::heap::free)
    }

    /// Whether the memory of runs was given.
    pub(crate) fn has_budget(&self) -> bool {
        self.budget.is_some()
    }

    /// The same clip, given up with another one, and with its memory.
    pub(crate) fn part_of(self, whole: &Clip) -> Self {
        Self { budget: whole.budget, ..self.until(whole.stop.clone()) }
    }

    /// Ends work on the clip with `?` when it is cancelled.
    ///
    /// # Errors
    /// If it was given up (see [`Clip::until`]).
    pub fn wanted(&self) -> Result<(), Error> {
        self.stop.check()
    }

    /// Facts about the clip.
    pub fn info(&self) -> &ClipInfo {
        &self.info
    }

    /// Whether there are no pictures, but only detections: see [`Clip::blank`].
    pub fn is_blank(&self) -> bool {
        self.frames.is_blank()
    }

    /// What is known about the clip beyond its pixels.
    pub fn truth(&self) -> Option<&Arc<dyn Truth>> {
        self.truth.as_ref()
    }

    /// The detections in frame `t`; `None` for a clip without detections.
    pub fn detections(&self, t: usize) -> Option<&[Detection]> {
        self.detections.as_ref().map(|frames| frames.get(t).map_or(&[][..], Vec::as_slice))
    }

    /// Width and height in pixels of every frame.
    pub fn size(&self) -> (usize, usize) {
        (self.info.width, self.info.height)
    }

    /// Frame `index`. May decode: never call it on the window's thread.
    ///
    /// # Errors
    /// One sentence if the frame does not exist, is damaged, or was given up (see [`Clip::until`]).
    pub fn frame(&self, index: usize) -> Result<Arc<Frame>, Error> {
        match self.info.frames {
            Some(n) if index >= n => Err(Error::new(format!(
                "{} has {n} frame{}, so there is no frame {index} (the first is 0)",
                self.info.name,
                if n == 1 { "" } else { "s" }
            ))),
            _ => self.frames.frame(index, &self.stop),
        }
    }

    /// Whether there is a frame `index`; one that is damaged is neither there nor not. May decode where the number of frames
    /// is not known.
    ///
    /// # Errors
    /// As [`Clip::frame`].
    pub fn has_frame(&self, index: usize) -> Result<bool, Error> {
        self.info.frames.map_or_else(|| self.frames.has_frame(index, &self.stop), |count| Ok(index < count))
    }

    /// The right view, if there is one.
    pub fn right(&self) -> Option<&Clip> {
        self.right.as_deref()
    }

    /// The calibration of the two cameras, if it is known.
    pub fn calibration(&self) -> Option<&Calibration> {
        self.calibration.as_ref()
    }

    /// Frame `index` from a viewpoint. May decode: never call it on the window's thread.
    ///
    /// # Errors
    /// As [`Clip::frame`], and if there is no right view.
    pub fn frame_from(&self, viewpoint: Viewpoint, index: usize) -> Result<Arc<Frame>, Error> {
        if viewpoint == Viewpoint::Left {
            return self.frame(index);
        }
        let missing = || Error::new(format!("{} has no right view; open one beside it", self.info.name));
        let right = self.right.as_deref().ok_or_else(missing)?;
        right.clone().until(self.stop.clone()).frame(index)
    }

    /// Frame `index` if it is at hand without any work.
    pub fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        self.frames.cached(index)
    }

    /// What frame `index` is called by itself, as a picture of a folder is; `None` if it is just a number.
    pub fn frame_name(&self, index: usize) -> Option<String> {
        self.frames.name(index)
    }

    /// Frames `t` and `t + 1`.
    ///
    /// # Errors
    /// As [`Clip::frame`]; a clip of a single frame is told so.
    pub fn pair(&self, t: usize) -> Result<[Arc<Frame>; 2], Error> {
        if self.info.frames.is_some_and(|n| n < 2) {
            return Err(Error::new(format!(
                "{} has a single frame or none, and motion needs two; open a clip or a folder of numbered pictures, or name both pictures",
                self.info.name
            )));
        }
        if let Some(n) = self.info.frames.filter(|&n| t >= n.saturating_sub(1)) {
            return Err(Error::new(format!(
                "{} has {n} frames, so a pair can start at frame 0 to {}, not {t}",
                self.info.name,
                n.saturating_sub(2)
            )));
        }
        Ok([self.frame(t)?, self.frame(t.saturating_add(1))?])
    }

    /// Frame `t` and the one that follows; the last one stands beside itself.
    ///
    /// # Errors
    /// As [`Clip::frame`].
    pub fn pair_or_last(&self, t: usize) -> Result<[Arc<Frame>; 2], Error> {
        let is_last = self.has_frame(t.saturating_add(1)) == Ok(false);
        if is_last { self.frame(t).map(|frame| [Arc::clone(&frame), frame]) } else { self.pair(t) }
    }

    /// A clip of frames `t + 1` and `t`, in this order, of which nothing more is known.
    ///
    /// # Errors
    /// As [`Clip::pair`].
    pub fn reversed(&self, t: usize) -> Result<Self, Error> {
        let [first, second] = self.pair(t)?;
        let info = ClipInfo { frames: Some(2), ..ClipInfo::clone(&self.info) };
        Ok(Self::new(info, Arc::new(InMemory(vec![second, first]))).part_of(self))
    }

    /// Frames `t` and `t + 1` as a clip of their own, from both viewpoints if there are two.
    ///
    /// # Errors
    /// As [`Clip::pair`].
    pub fn pair_from(&self, t: usize) -> Result<Self, Error> {
        let frames = self.pair(t)?;
        let info = ClipInfo { frames: Some(2), ..ClipInfo::clone(&self.info) };
        let mut pair = Self::new(info, Arc::new(InMemory(frames.into()))).part_of(self);
        if let Some(right) = &self.right {
            pair = pair.with_right(Clip::clone(right).until(self.stop.clone()).pair_from(t)?)?;
        }
        pair.calibration = self.calibration;
        Ok(pair)
    }
}

/// The gray of pictures that there are none of.
const PAPER: u8 = 48;

/// One picture for all frames.
struct Blank(Arc<Frame>);

impl FrameSource for Blank {
    fn frame(&self, _index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        Ok(Arc::clone(&self.0))
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        Some(Arc::clone(&self.0))
    }

    fn is_blank(&self) -> bool {
        true
    }
}

struct InMemory(Vec<Arc<Frame>>);

impl FrameSource for InMemory {
    fn frame(&self, index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        self.cached(index).ok_or_else(|| Error::new(format!("there is no frame {index}")))
    }

    fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        self.0.get(index).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gray_is_the_weighted_sum() {
        let frame = Frame::rgb(Grid::from_fn(256, 1, |x, _| [x as u8; 3]));
        assert!((0..256).all(|x| frame.luma()[(x, 0)] == x as u8));
        let primaries = Frame::rgb(Grid::from_fn(3, 1, |x, _| std::array::from_fn(|c| if c == x { 255 } else { 0 })));
        assert_eq!(primaries.luma().cells(), [76, 150, 29]);
    }

    #[test]
    fn a_flow_is_known_between_pixels_that_are() {
        let flow = Flow(Grid::from_fn(3, 2, |x, y| if x == 2 { Flow::UNKNOWN } else { [x as f32, 10.0 * y as f32] }));
        assert_eq!(flow.sample([0.25, 0.5]), Some([0.25, 5.0]));
        assert_eq!(flow.sample([1.0, 1.0]), Some([1.0, 10.0]), "what does not count need not be known");
        assert_eq!(flow.sample([-0.5, 1.5]), Some([0.0, 10.0]), "a pixel reaches to its edge");
        assert_eq!((flow.sample([1.25, 0.0]), flow.sample([-0.6, 0.0])), (None, None));
    }

    #[test]
    fn a_reversed_pair_has_its_frames_swapped() {
        let frame = |v| Frame::gray(Grid::new(2, 2, v));
        let clip = Clip::from_frames("three", vec![frame(1), frame(2), frame(3)]).unwrap();
        let reversed = clip.reversed(1).unwrap();
        let grays: Vec<_> = reversed.pair(0).unwrap().iter().map(|frame| frame.luma()[(0, 0)]).collect();
        assert_eq!((grays, reversed.info().frames), (vec![3, 2], Some(2)));
        assert!(clip.reversed(2).is_err());
    }

    #[test]
    fn a_right_view_goes_with_the_left_one() {
        let clip = |first: u8, width, frames: u8| {
            let frame = |t| Frame::gray(Grid::new(width, 2, first + t));
            Clip::from_frames("view", (0..frames).map(frame).collect()).unwrap()
        };
        let calibration = Calibration::new(300.0, 0.1, [1.0, 0.5]).unwrap();
        let both = clip(0, 4, 3).with_right(clip(100, 4, 3)).unwrap().with_calibration(calibration);
        let level = |clip: &Clip, viewpoint, t| clip.frame_from(viewpoint, t).unwrap().luma()[(0, 0)];
        assert_eq!([Viewpoint::Left, Viewpoint::Right].map(|viewpoint| level(&both, viewpoint, 2)), [2, 102]);
        let pair = both.pair_from(1).unwrap();
        assert_eq!((level(&pair, Viewpoint::Right, 0), pair.calibration()), (101, Some(&calibration)));
        assert!(
            clip(0, 4, 3)
                .with_right(clip(0, 5, 3))
                .unwrap_err()
                .to_string()
                .contains("4×2 px and the right view 5×2 px")
        );
        assert!(clip(0, 4, 3).with_right(clip(0, 4, 2)).unwrap_err().to_string().contains("3 frames"));
        let missing = clip(0, 4, 1).frame_from(Viewpoint::Right, 0).unwrap_err().to_string();
        assert!(missing.contains("no right view"), "{missing}");
    }

    #[test]
    fn a_clip_tells_what_it_lacks() {
        let frame = |w| Frame::gray(Grid::new(w, 2, 0));
        assert!(Clip::from_frames("none", vec![]).is_err());
        assert!(Clip::from_frames("odd", vec![frame(2), frame(3)]).is_err());
        let one = Clip::from_frames("one", vec![frame(2)]).expect("one frame is a clip");
        assert!(one.pair(0).unwrap_err().to_string().contains("single frame"));
        let two = Clip::from_frames("two", vec![frame(2), frame(2)]).expect("two frames are a clip");
        assert!(two.pair(0).is_ok());
        assert!(two.pair(1).is_err() && two.frame(2).is_err());
        assert!(two.pair(usize::MAX).is_err());
    }
}
