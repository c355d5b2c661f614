//! Input: videos, animations, image sequences, ground truth and detections.
//!
//! [`open`] detects the format from the content, chooses the decoder and puts the frame cache in front of it. A `Decoder`
//! handles one format and nothing of caching, threads or ground truth.

mod animation;
mod cache;
pub mod camera;
mod catch_panic;
mod depths;
mod detect_format;
mod detections;
pub mod export;
mod helper;
mod info;
pub(crate) mod input;
pub(crate) mod names;
mod picture;
mod reason;
mod sequence;
mod stereo;
mod stills;
pub(crate) mod table;
pub mod temporary;
mod tiff;
mod truth;
mod unsupported;
mod video;

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::base::{Error, Stop, heap};
use motionscope_core::data::{Clip, ClipInfo, Frame, Truth};

use detect_format::Kind;
use export::{InputKind, Inputs};
pub use info::Info;
use input::{Input, Node};
pub use picture::Contrast;
use sequence::Sequence;
pub use stereo::{GivenCalibration, RightView};
use stereo::{Half, LeftView};

/// The progress of a long computation, and its cancellation.
pub trait Progress: Send + Sync {
    /// Reports the fraction done, from 0 to 1.
    fn report(&self, fraction: f32);

    /// Whether the computation was cancelled.
    fn cancelled(&self) -> bool;
}

/// Ground truth, detections and a right view given explicitly for a clip, instead of files found beside it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    /// The ground truth.
    pub truth: Option<PathBuf>,
    /// The detections, as MOTChallenge rows.
    pub detections: Option<PathBuf>,
    /// The right view of a rectified pair of cameras.
    pub right: Option<RightView>,
    /// The calibration of both cameras.
    pub calibration: Option<GivenCalibration>,
    /// Gray levels per px of disparity of a true disparity in 8 bits.
    pub disparity_scale: Option<f32>,
    /// The folder of measured depths.
    pub depths: Option<PathBuf>,
    /// Units of a measured depth per m.
    pub depth_scale: Option<f32>,
    /// The range of 16-bit samples that is shown; by default that of the whole clip.
    pub contrast: Option<Contrast>,
}

impl Given {
    /// Returns these files with those of `later` in their place.
    #[must_use]
    pub fn then(self, later: Self) -> Self {
        Self {
            truth: later.truth.or(self.truth),
            detections: later.detections.or(self.detections),
            right: later.right.or(self.right),
            calibration: later.calibration.or(self.calibration),
            disparity_scale: later.disparity_scale.or(self.disparity_scale),
            depths: later.depths.or(self.depths),
            depth_scale: later.depth_scale.or(self.depth_scale),
            contrast: later.contrast.or(self.contrast),
        }
    }

    /// The paths of these files.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        let Self { truth, detections, right, calibration, depths, .. } = self;
        let right = right.as_ref().filter(|view| **view != RightView::SideBySide).map(RightView::path);
        let calibration = calibration.as_ref().and_then(GivenCalibration::path);
        [truth.as_deref(), detections.as_deref(), right, calibration, depths.as_deref()].into_iter().flatten()
    }

    /// The same with `f` applied to the path of each file.
    #[must_use]
    pub fn map_path(self, f: impl Fn(&Path) -> PathBuf) -> Self {
        let Self { truth, detections, right, calibration, disparity_scale, depths, depth_scale, contrast } = self;
        Self {
            truth: truth.map(|path| f(&path)),
            detections: detections.map(|path| f(&path)),
            right: right.map(|view| view.map_path(&f)),
            calibration: calibration.map(|given| given.map_path(&f)),
            disparity_scale,
            depths: depths.map(|path| f(&path)),
            depth_scale,
            contrast,
        }
    }
}

/// The units of a depth per m that were `written`, and read as `scale`.
///
/// # Errors
/// One sentence if it is no positive number.
pub fn depth_scale(scale: Option<f32>, written: impl Display) -> Result<f32, Error> {
    let why = || Error::new(format!("the scale of depths is a positive number of units per m, not {written}"));
    scale.filter(|scale| scale.is_finite() && *scale > 0.0).ok_or_else(why)
}

/// The gray levels per px of a disparity that were `written`, and read as `scale`.
///
/// # Errors
/// One sentence if it is no positive number.
pub fn disparity_scale(scale: Option<f32>, written: impl Display) -> Result<f32, Error> {
    let why =
        || Error::new(format!("the scale of a disparity is a positive number of gray levels per px, not {written}"));
    scale.filter(|scale| scale.is_finite() && *scale > 0.0).ok_or_else(why)
}

/// Options for opening a clip.
#[derive(Clone)]
pub struct Open {
    /// Limit of the frame cache in bytes, shared by both views; the frame requested last of each is always kept.
    pub cache_bytes: usize,
    /// Whether to decode the whole file to count its frames where the container does not say.
    pub count: bool,
    /// Whether formats without a built-in decoder may be decoded by an installed ffmpeg.
    pub ffmpeg: bool,
    /// Files given explicitly.
    pub given: Given,
    /// Receives the progress.
    pub progress: Option<Arc<dyn Progress>>,
}

impl Default for Open {
    fn default() -> Self {
        Self { cache_bytes: 512 << 20, count: false, ffmpeg: true, given: Given::default(), progress: None }
    }
}

impl From<Given> for Open {
    fn from(given: Given) -> Self {
        Self { given, ..Self::default() }
    }
}

impl Open {
    /// Reports the progress.
    ///
    /// # Errors
    /// If the operation was cancelled.
    pub(crate) fn report(&self, fraction: f32) -> Result<(), Error> {
        match &self.progress {
            Some(progress) if progress.cancelled() => Err(Error::new("opening was cancelled")),
            Some(progress) => {
                progress.report(fraction);
                Ok(())
            }
            None => Ok(()),
        }
    }
}

/// The decoder of one format. It caches nothing: the frame cache does.
pub(crate) trait Decoder: Send {
    /// Decodes frame `index` and gives `keep` every frame that is met on the way, by number; the wanted one comes last.
    ///
    /// Going on from the frame decoded last must be cheap where the format allows. After an error or a panic the next
    /// call starts afresh. Whoever decodes more than one frame on the way looks at `stop` before each, and tells it how far
    /// it is.
    ///
    /// # Errors
    /// One sentence, without the file's name, if there is no such frame, it is damaged, or `stop` is set.
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error>;
}

/// What a format's reader makes of a file.
pub(crate) struct Source {
    /// Facts about the clip; the size has been checked with [`check_size`].
    pub info: ClipInfo,
    /// Delivers the frames.
    pub decoder: Box<dyn Decoder>,
    /// The file of each frame, where each has one of its own.
    pub files: Arc<[PathBuf]>,
    /// The range of samples that is shown, of pictures with 16 bits.
    pub contrast: Option<Contrast>,
}

impl Source {
    /// A source whose frames all lie in one file.
    fn new(info: ClipInfo, decoder: impl Decoder + 'static) -> Self {
        Self { info, decoder: Box::new(decoder), files: Arc::default(), contrast: None }
    }
}

/// Largest width or height of a frame, in pixels.
const MAX_SIDE_PX: usize = 16_384;
/// Largest area of a frame, in pixels.
const MAX_AREA_PX: usize = 128 << 20;

/// Refuses sizes that no picture can have, before anything is allocated.
///
/// # Errors
/// A sentence, without the file's name, that tells the size and what is allowed.
pub(crate) fn check_size(width: usize, height: usize) -> Result<(), Error> {
    if width == 0 || height == 0 {
        return Err(Error::new(format!("its pictures are {width}×{height} px, so it shows nothing")));
    }
    if width > MAX_SIDE_PX || height > MAX_SIDE_PX || width.saturating_mul(height) > MAX_AREA_PX {
        return Err(Error::new(format!(
            "its header claims pictures of {width}×{height} px; up to {MAX_SIDE_PX} px a side and 128 megapixels can \
             be opened, so the file is damaged or must be scaled down first"
        )));
    }
    check_memory(width * height)
}

/// Bytes per pixel that decoding takes: the decoded picture, its copy in eight bits, and the frame in gray and in colour.
const DECODING: u64 = 4 + 3 + 1 + 3;
/// Smaller pictures are decoded without asking for the free memory, which takes about as long as decoding them.
const SMALL_BYTES: u64 = 64 << 20;

/// Refuses pictures for which there is not enough memory.
fn check_memory(pixels: usize) -> Result<(), Error> {
    let need = DECODING.saturating_mul(pixels as u64);
    if need < SMALL_BYTES || need <= heap::free() {
        return Ok(());
    }
    let [need, free] = [need, heap::free()].map(|bytes| bytes >> 20);
    Err(Error::new(format!(
        "decoding a picture of it takes about {need} MiB of memory, but {free} MiB are free; close other programs, or scale it down"
    )))
}

/// Refuses a path at which a pipe or a device lies instead of a file or a folder: opening one could block, or do something.
///
/// # Errors
/// One sentence with the path.
pub fn check_is_file(path: &Path) -> Result<(), Error> {
    // What is not there is told when it is opened.
    let node = if path.exists() { Node::of(path) } else { Ok(Node::File) };
    match node {
        Ok(Node::File | Node::Folder) => Ok(()),
        Ok(Node::Stream) => Err(about(path, &Error::new("it is a named pipe; sessions and lessons name files"))),
        Err(error) => Err(about(path, &error)),
    }
}

/// Opens any clip: a picture or a folder of pictures, an animation, a video file, or `-` for standard input.
///
/// The content decides, not the name: a mislabelled file opens with a warning. Call it off the window's thread.
///
/// # Errors
/// One sentence that names the file, tells what is wrong and what to do.
pub fn open(path: &Path, options: &Open) -> Result<Clip, Error> {
    // Before anything is opened that never ends.
    if path.exists() {
        Node::of(path).map_err(|error| about(path, &error))?;
    }
    let clip = open_clip(path, options)?;
    // What is told of names and by others' decoders is one sentence as well.
    let warnings = clip.info().warnings.iter().map(|message| Error::new(message.as_str()).to_string()).collect();
    let info = ClipInfo { warnings, ..clip.info().clone() };
    Ok(clip.with_info(info))
}

fn open_clip(path: &Path, options: &Open) -> Result<Clip, Error> {
    if detections::is(path) {
        let clip = detections::open(path)?;
        let subject = truth::Subject::new(path, clip.info(), &[]);
        let found = match &options.given.truth {
            Some(given) => truth::Found { truth: Some(truth::open(given, &subject)?), warnings: Vec::new() },
            None => truth::beside(&subject),
        };
        let mut info = clip.info().clone();
        info.warnings.extend(found.warnings);
        let clip = clip.with_info(info);
        return Ok(match found.truth {
            Some(truth) => clip.with_truth(truth),
            None => clip,
        });
    }
    let source = guarded(|| open_source(path, options)).map_err(|error| about(path, &error))?;
    let clip = with_given(path, options, source)?;
    if options.given.detections.is_none() && path != Path::new("-") {
        return Ok(with_detections_beside(clip, path));
    }
    with_detections(clip, options)
}

/// Opens two pictures as a clip of two frames. Call it off the window's thread.
///
/// # Errors
/// One sentence that names the file, tells what is wrong and what to do.
pub fn open_pair(files: &[PathBuf; 2], options: &Open) -> Result<Clip, Error> {
    for file in files {
        let kind = guarded(|| picture_kind(file)).map_err(|error| about(file, &error))?;
        if !matches!(kind, Kind::Still) {
            let why = "it is no picture; two files are a clip only if both are pictures";
            return Err(about(file, &Error::new(why)));
        }
    }
    let source = guarded(|| stills::pair(files, options)).map_err(|error| about(&files[0], &error))?;
    with_detections(with_given(&files[0], options, source)?, options)
}

/// The kind of the file at `path`.
fn picture_kind(path: &Path) -> Result<Kind, Error> {
    if path.is_dir() {
        return Err(Error::new("it is a folder; name two picture files"));
    }
    detect_format::kind(&mut Input::open(path)?)
}

/// What `read` gives; a panic in a decoder is an error.
fn guarded<T>(read: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    catch_panic::catch_panic(read).unwrap_or_else(|panic| {
        Err(Error::new(format!("it is damaged and cannot be decoded{}", reason::bracketed(&panic))))
    })
}

/// The clip of `source`, read from `path`, with its ground truth, its right view and its calibration.
fn with_given(path: &Path, options: &Open, source: Source) -> Result<Clip, Error> {
    let source = match options.given.right {
        Some(RightView::SideBySide) => stereo::half(source, Half::Left).map_err(|why| about(path, &why))?,
        _ => source,
    };
    let files = Arc::clone(&source.files);
    let left = LeftView { path, files: &files };
    let views = if stereo::has_right_view(&left, options) { 2 } else { 1 };
    let mut source = source;
    if options.given.contrast.is_some() && source.contrast.is_none() {
        source.info.warnings.push("the contrast is not used: the clip has no 16-bit pictures".into());
    }
    // Both views are shown alike, or the same point would have two brightnesses.
    let given = Given { contrast: source.contrast.or(options.given.contrast), ..options.given.clone() };
    let options = &Open { cache_bytes: options.cache_bytes / views, given, ..options.clone() };
    let clip = with_given_truth(path, options, source)?;
    let clip = depths::with_depths(clip, &left, options)?;
    stereo::with_right_view(clip, &left, options)
}

/// The clip of `source`, read from `path`, behind the frame cache and with its ground truth.
fn with_given_truth(path: &Path, options: &Open, mut source: Source) -> Result<Clip, Error> {
    let truth = catch_panic::catch_panic(|| find_truth(path, options, &mut source)).unwrap_or_else(|panic| {
        let why = format!("its ground truth is damaged and cannot be decoded{}", reason::bracketed(&panic));
        Err(about(path, &Error::new(why)))
    })?;
    let info = source.info.clone();
    let clip = Clip::new(info, Arc::new(cache::Lazy::new(source, options.cache_bytes)));
    Ok(match truth {
        Some(truth) => clip.with_truth(truth),
        None => clip,
    })
}

/// The same clip with the detections that lie beside it, if there are any; with a warning if they cannot be read.
fn with_detections_beside(clip: Clip, path: &Path) -> Clip {
    // What lies beside a video may be of another one.
    let Some(file) = Some(path).filter(|path| path.is_dir()).and_then(detections::beside) else { return clip };
    match detections::read(&file) {
        Ok(found) => clip.with_detections(found),
        Err(error) => {
            let mut info = clip.info().clone();
            info.warnings.push(format!("detections beside the clip are ignored: {error}"));
            clip.with_info(info)
        }
    }
}

/// Whether the file at `path` can be read as a table of detections, whatever its name and first line.
///
/// # Errors
/// A sentence that names the line that cannot be understood.
pub fn check_detections(path: &Path) -> Result<(), Error> {
    if Node::of(path) == Ok(Node::Stream) {
        let why =
            "it is a pipe, and detections by themselves are read more than once; save them to a file and give that";
        return Err(about(path, &Error::new(why)));
    }
    detections::read(path).map(drop)
}

/// The files that `clip` is read from, which nothing must be written over: those that `path` stands for, if it is no synthetic
/// clip, and the truth and the detections that `options` name or that lie beside it.
pub fn inputs(path: Option<&Path>, clip: &Clip, options: &Open) -> Inputs {
    let path = path.filter(|path| *path != Path::new("-"));
    let pictures = path.filter(|_| clip.info().container == stills::CONTAINER).map(Sequence::find);
    let mut pictures = pictures.and_then(Result::ok).unwrap_or_default();
    stereo::keep_left(&mut pictures, &options.given);
    let pictures = pictures.files;
    let mut inputs = truth_inputs(path, &pictures, clip, options);
    if let Some(path) = path {
        add_right_view(&mut inputs, &LeftView { path, files: &pictures }, options);
    }
    let beside = || path.filter(|path| path.is_dir()).and_then(detections::beside);
    options
        .given
        .detections
        .clone()
        .or_else(beside)
        .into_iter()
        .for_each(|file| inputs.add(InputKind::Detections, file));
    match path {
        Some(path) if clip.is_blank() => inputs.add(InputKind::Detections, path),
        Some(path) if pictures.is_empty() => inputs.add(InputKind::Clip, path),
        Some(path) => inputs.add_pictures(path, pictures),
        None => {}
    }
    inputs
}

/// The files that `clip`, opened from the two pictures `files` with `options`, is read from.
pub fn inputs_of_pair(files: &[PathBuf; 2], clip: &Clip, options: &Open) -> Inputs {
    let mut inputs = truth_inputs(Some(&files[0]), files, clip, options);
    add_right_view(&mut inputs, &LeftView { path: &files[0], files }, options);
    options.given.detections.iter().for_each(|file| inputs.add(InputKind::Detections, file));
    files.iter().for_each(|file| inputs.add(InputKind::Frame, file));
    inputs
}

/// Adds the files of the right view and of the calibration.
fn add_right_view(inputs: &mut Inputs, left: &LeftView<'_>, options: &Open) {
    let (right, calibration) = stereo::files(left, options);
    depths::files(left, options).into_iter().for_each(|file| inputs.add(InputKind::Depths, file));
    right.into_iter().for_each(|file| inputs.add(InputKind::RightView, file));
    calibration.into_iter().for_each(|file| inputs.add(InputKind::Calibration, file));
}

/// The files of ground truth of `clip`, which is opened from `path` and made of `pictures`, if it is.
fn truth_inputs(path: Option<&Path>, pictures: &[PathBuf], clip: &Clip, options: &Open) -> Inputs {
    let mut inputs = Inputs::default();
    let subject = truth::Subject::new(path.unwrap_or(Path::new(&clip.info().name)), clip.info(), pictures);
    let subject = subject.with_scale(options.given.disparity_scale);
    let truth = match &options.given.truth {
        Some(given) => truth::TruthFiles::given(given, &subject),
        None if path.is_some() => truth::TruthFiles::beside(&subject),
        None => truth::TruthFiles::default(),
    };
    truth.into_files().for_each(|file| inputs.add(InputKind::Truth, file));
    inputs
}

/// The text in the file at `path`.
///
/// # Errors
/// A sentence, without the path, if it cannot be read, is no text, or too large for one.
pub fn read_text(path: &Path) -> Result<String, Error> {
    input::text(path)
}

/// Whether the file at `path` is a table of detections without identities, as `det.txt` is.
pub fn is_detections(path: &Path) -> bool {
    detections::is(path)
}

/// Whether the file at `path` tells what is true of a clip, and holds no pictures: true objects, a flow, or disparities.
pub fn is_truth(path: &Path) -> bool {
    matches!(names::extension(path).as_str(), "flo" | "pfm") || detections::is_truth(path)
}

/// The same clip with the detections that `options` name, if they do.
///
/// # Errors
/// One sentence if they cannot be read.
pub fn with_detections(clip: Clip, options: &Open) -> Result<Clip, Error> {
    match &options.given.detections {
        Some(path) => Ok(clip.with_detections(detections::read(path)?)),
        None => Ok(clip),
    }
}

/// The same synthetic clip with the truth that is given in place of its own.
///
/// # Errors
/// One sentence if it cannot be read or does not fit the clip, or if a right view is given, which a scene has of its own.
pub fn with_given_files(clip: Clip, options: &Open) -> Result<Clip, Error> {
    let Given { truth, disparity_scale, .. } = &options.given;
    let clip = match truth {
        Some(path) => {
            let subject = truth::Subject::new(Path::new(&clip.info().name), clip.info(), &[]);
            let truth = truth::open(path, &subject.with_scale(*disparity_scale))?;
            clip.with_truth(truth)
        }
        None => clip,
    };
    if options.given.right.is_some() || options.given.calibration.is_some() {
        let why = "a synthetic scene has the views and the calibration of its own cameras; open it without another right view and \
                   calibration, or render it with motionscope synth and open the folder";
        return Err(Error::new(why));
    }
    Ok(clip)
}

/// Whether `path` is a picture, a folder of pictures or a pattern.
fn is_still_or_folder(path: &Path) -> bool {
    let is_still = || Input::open(path).and_then(|mut input| detect_format::kind(&mut input));
    path.is_dir() || sequence::is_pattern(path) || matches!(is_still(), Ok(Kind::Still))
}

/// Whether the video at `path`, or the right view beside it, is given to an installed ffmpeg, because no built-in decoder shows it.
pub(crate) fn needs_ffmpeg(path: &Path) -> bool {
    let built_in = Open { ffmpeg: false, cache_bytes: 0, ..Open::default() };
    let is_foreign = |path: &Path| {
        path.is_file()
            && matches!(picture_kind(path), Ok(Kind::Video(_)))
            && guarded(|| open_source(path, &built_in)).is_err()
    };
    let (right, _) = stereo::files(&LeftView { path, files: &[] }, &Open::default());
    is_foreign(path) || right.iter().any(|path| is_foreign(path))
}

fn open_source(path: &Path, options: &Open) -> Result<Source, Error> {
    if path.is_dir() || sequence::is_pattern(path) {
        return stills::open(path, options);
    }
    let mut input = Input::open(path)?;
    let kind = detect_format::kind(&mut input)?;
    let mut source = match kind {
        Kind::Still | Kind::Animation if path == Path::new("-") || Node::of(path) == Ok(Node::Stream) => {
            return Err(Error::new("pictures cannot come from a pipe; save them to files and open those"));
        }
        Kind::Still => stills::open(path, options)?,
        Kind::Animation => animation::open(path, options)?,
        Kind::Video(format) => video::open(path, format, input, options)?,
    };
    source.info.warnings.extend(detect_format::mislabelled(path, kind));
    Ok(source)
}

fn find_truth(path: &Path, options: &Open, source: &mut Source) -> Result<Option<Arc<dyn Truth>>, Error> {
    let subject = truth::Subject::new(path, &source.info, &source.files).with_scale(options.given.disparity_scale);
    if let Some(given) = &options.given.truth {
        return truth::open(given, &subject).map(Some);
    }
    // What was not asked for must not stand in the way of the clip.
    let found = truth::beside(&subject);
    source.info.warnings.extend(found.warnings);
    Ok(found.truth)
}

/// Puts the file's name in front of what is wrong with it.
fn about(path: &Path, error: &Error) -> Error {
    Error::new(format!("cannot open {}: {error}", Error::short_name(&path.display().to_string())))
}

/// Why a file cannot be read, without its name.
pub(crate) fn cannot_read(error: &io::Error) -> Error {
    Error::new(match error.kind() {
        io::ErrorKind::NotFound => "there is no such file; check the path".into(),
        io::ErrorKind::PermissionDenied => "you may not read this file; ask its owner".into(),
        io::ErrorKind::InvalidData => "it is not a text file; give another file".into(),
        _ => format!("it cannot be read ({error})"),
    })
}

/// The name to show for `path`: its last part.
pub(crate) fn name_of(path: &Path) -> String {
    match path.file_name() {
        Some(name) => name.to_string_lossy().into_owned(),
        None => path.display().to_string(),
    }
}
