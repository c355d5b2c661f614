//! The commands and options, as clap parses them. Names are stable: scripts depend on them.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args as Group, Parser, Subcommand};
use motionscope_core::base::{Error, Threads};
use motionscope_core::run::{Cursor, Pace};

use super::examples;
use super::look::LookFlags;
use super::paper::{HandoutArgs, WorksheetArgs};
use crate::experiment::pixel::Pixel;
use crate::media::camera::Size;
use crate::media::export::Timing;
use crate::media::{Contrast, Given, GivenCalibration, RightView, depth_scale, disparity_scale};
use crate::results::Asked;
use crate::session;
use crate::view::panes::Named;
use crate::view::rendering::Format;

/// Step through the motion estimators of a computer-vision course, forwards and backwards.
#[derive(Parser)]
#[command(name = "motionscope", version, after_help = examples::ALL, args_conflicts_with_subcommands = true)]
pub struct Args {
    /// Clip, session or link to open in the window; the start page by default.
    pub clip: Option<OsString>,
    /// Second picture: CLIP and it are the two frames of the clip.
    #[arg(value_name = "PICTURE")]
    pub next: Option<OsString>,
    /// Open what a session or lesson names outside of its folder, or what needs ffmpeg.
    #[arg(long, global = true)]
    pub trust: bool,
    /// Address of the page that links lead to, without # and what follows; the window remembers it.
    #[arg(long, global = true, value_name = "URL", value_parser = link_base)]
    pub link_base: Option<String>,
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Subcommand)]
pub enum Command {
    /// List the estimators with parameters, ranges, defaults, units and source.
    #[command(after_help = examples::LIST)]
    List {
        /// Estimators to list with their pseudocode; all of them by default, without it.
        estimators: Vec<String>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Define the terms of the course.
    #[command(after_help = examples::GLOSSARY)]
    Glossary {
        /// Term to define; by default all terms are listed by chapter.
        #[arg(value_name = "TERM")]
        term: Vec<String>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Search lessons, glossary, estimators, parameters, charts and examples for words.
    #[command(after_help = examples::SEARCH)]
    Search {
        /// Words to find, or their beginnings; all of them must occur.
        #[arg(value_name = "WORD", required = true)]
        words: Vec<String>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// List the lessons, or the pages of one.
    #[command(after_help = examples::LESSONS)]
    Lessons {
        /// Lesson, as lesson:kalman-filter, or the path of a lesson's file; by default all lessons are listed.
        lesson: Option<OsString>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Describe a clip: size, frames, frame rate, codec, ground truth.
    #[command(after_help = examples::INFO)]
    Info {
        /// Clip to describe.
        clip: OsString,
        /// Second picture: CLIP and it are the two frames of the clip.
        #[arg(value_name = "PICTURE")]
        next: Option<OsString>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
        /// Count the frames by decoding the whole file if the container does not say.
        #[arg(long)]
        count: bool,
        /// Ground truth: .flo, KITTI .png, a disparity as .pfm or .png, a homography as .xml, masks of the foreground as .png, a folder of them, or a MOTChallenge gt.txt.
        #[arg(long, value_name = "FILE")]
        truth: Option<PathBuf>,
        #[command(flatten)]
        given: GivenArgs,
    },
    /// Render a synthetic clip: frames as PNG, true flow as .flo, occlusion masks and gt.txt.
    #[command(after_help = examples::SYNTH)]
    Synth {
        /// Scene to render; see --list.
        #[arg(required_unless_present = "list")]
        name: Option<String>,
        /// Output folder; only a synthetic clip rendered there earlier is replaced.
        #[arg(long, value_name = "DIR", required_unless_present = "list")]
        out: Option<PathBuf>,
        /// Set a slider, e.g. noise=5; may be repeated.
        #[arg(long, value_name = "K=V")]
        set: Vec<String>,
        /// List the scenes, their sliders and what they teach.
        #[arg(long)]
        list: bool,
    },
    /// List the cameras, or record a clip from one.
    #[command(after_help = examples::CAMERA)]
    Camera(CameraArgs),
    /// Run an estimator on a pair of frames, or through a clip, and report time and errors.
    #[command(after_help = examples::RUN)]
    Run(RunArgs),
    /// Save pictures of a range of steps.
    #[command(after_help = examples::EXPORT)]
    Export(ExportArgs),
    /// Compare estimators on the same pair of frames in one table.
    #[command(after_help = examples::COMPARE)]
    Compare(CompareArgs),
}

#[derive(Group)]
pub struct CameraArgs {
    /// List the cameras.
    #[arg(long)]
    pub list: bool,
    /// Camera to record from, by its name or a part of it; the first one by default.
    #[arg(long, value_name = "NAME", requires = "out")]
    pub device: Option<String>,
    /// Width and height of the frames in px.
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = size)]
    pub size: Size,
    /// Duration of the recording in seconds.
    #[arg(long, value_name = "S", default_value = "3", value_parser = seconds)]
    pub seconds: f32,
    /// Output file, .y4m; without it the cameras are listed.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Overwrite an earlier file.
    #[arg(long, requires = "out")]
    pub force: bool,
}

#[derive(Group)]
pub struct CompareArgs {
    /// Clip or session.
    pub clip: OsString,
    /// Second picture: CLIP and it are the two frames of the clip.
    #[arg(value_name = "PICTURE")]
    pub next: Option<OsString>,
    /// Ids of the estimators, separated by commas; see `motionscope list`.
    #[arg(
        long,
        help_heading = "Estimation",
        value_name = "A,B,..",
        required_unless_present = "course",
        value_delimiter = ',',
        num_args = 1
    )]
    pub estimators: Vec<String>,
    /// Measure the course's table of sequential, logarithmic and hierarchical search instead, and check its statements.
    #[arg(long, help_heading = "Estimation", conflicts_with_all = ["estimators", "set", "sweep", "csv", "truth"])]
    pub course: bool,
    /// Set a parameter of one estimator, e.g. diamond.block-size=8, or of all that have it, e.g. block-size=8; may be repeated.
    #[arg(long, help_heading = "Estimation", value_name = "A.K=V")]
    pub set: Vec<String>,
    /// Run all estimators with each of these values of a parameter, or of a slider of a synthetic clip.
    #[arg(long, help_heading = "Estimation", value_name = "K=V1,V2,..")]
    pub sweep: Option<String>,
    /// Frame t, from 0.
    #[arg(long, help_heading = "Estimation", value_name = "N")]
    pub frame: Option<usize>,
    /// Ground truth; by default it is searched for beside the clip.
    #[arg(long, help_heading = "Clip", value_name = "FILE")]
    pub truth: Option<PathBuf>,
    #[command(flatten)]
    pub given: GivenArgs,
    /// Runs of each estimator; the shortest time counts. By default 3, fewer if they take more than a second.
    #[arg(long, help_heading = "Execution", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub repeat: Option<u32>,
    /// Number of threads.
    #[arg(long, help_heading = "Execution", value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=Threads::MAX as i64))]
    pub threads: u32,
    /// Print a JSON array with one object per row.
    #[arg(long, help_heading = "Output", conflicts_with = "markdown")]
    pub json: bool,
    /// Save the table as CSV; `-` is standard output.
    #[arg(long, help_heading = "Output", value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Save the plot of a sweep as .png, .svg or .pdf: the error where truth is known, over the swept values.
    #[arg(long, help_heading = "Output", value_name = "FILE", requires = "sweep")]
    pub plot: Option<PathBuf>,
    /// Column to plot, as it is called in CSV, e.g. ms.
    #[arg(long, help_heading = "Output", value_name = "NAME", requires = "plot")]
    pub column: Option<String>,
    /// Overwrite input files.
    #[arg(long, help_heading = "Output")]
    pub force: bool,
    /// Print the table as Markdown.
    #[arg(long, help_heading = "Output")]
    pub markdown: bool,
}

/// The right view, calibration, depths and contrast of a clip.
#[derive(Clone, Debug, Default, Group)]
pub struct GivenArgs {
    /// Right view: a picture, a folder or a video, or side-by-side if each frame shows both views; by default it is searched for beside
    /// the clip.
    #[arg(long, help_heading = "Clip", value_name = "FILE|DIR")]
    pub right: Option<PathBuf>,
    /// Calibration of both views: a calib.txt of KITTI or Middlebury, or focal length in px and baseline in m as F,B, or with the
    /// principal point as F,B,CX,CY.
    #[arg(long, help_heading = "Clip", value_name = "FILE.txt|F,B")]
    pub calibration: Option<PathBuf>,
    /// Gray levels per px of a true disparity in an 8-bit PNG; by default that of Middlebury 2003 to 2006, by name and size.
    #[arg(long, help_heading = "Clip", value_name = "S", value_parser = scale)]
    pub disparity_scale: Option<f32>,
    /// Folder of depths that a sensor measured, 16-bit PNG; by default the folder depth in that of the frames or beside it.
    #[arg(long, help_heading = "Clip", value_name = "DIR")]
    pub depths: Option<PathBuf>,
    /// Units of these depths per m; by default 5000.
    #[arg(long, help_heading = "Clip", value_name = "N", value_parser = units)]
    pub depth_scale: Option<f32>,
    /// Samples of 16-bit pictures that are black and white; by default the range of the whole clip.
    #[arg(long, help_heading = "Clip", value_name = "LOW..HIGH", value_parser = contrast)]
    pub contrast: Option<Contrast>,
}

impl GivenArgs {
    /// What is given besides.
    pub fn with(&self, given: Given) -> Given {
        Given {
            right: self.right.as_deref().map(RightView::of),
            calibration: self.calibration.as_deref().map(GivenCalibration::of),
            disparity_scale: self.disparity_scale,
            depths: self.depths.clone(),
            depth_scale: self.depth_scale,
            contrast: self.contrast,
            ..given
        }
    }
}

/// What to estimate: clip, estimator, parameters and frames.
#[derive(Group)]
pub struct TaskArgs {
    /// Clip or session; optional with --detections.
    #[arg(required_unless_present = "detections")]
    pub clip: Option<OsString>,
    /// Second picture: CLIP and it are the two frames of the clip.
    #[arg(value_name = "PICTURE")]
    pub next: Option<OsString>,
    /// Id of the estimator; see `motionscope list`. A session has its own.
    #[arg(long, help_heading = "Estimation", value_name = "ID")]
    pub estimator: Option<String>,
    /// Frame t, from 0.
    #[arg(long, help_heading = "Estimation", value_name = "N")]
    pub frame: Option<usize>,
    /// Up to three more estimators in lockstep, separated by commas; each has its own picture. The same estimator may be there
    /// again, with other parameters.
    #[arg(long, help_heading = "Estimation", value_name = "B,C,..", value_delimiter = ',', num_args = 1)]
    pub beside: Vec<String>,
    /// Pace of the lockstep: block (same block, one candidate each) or budget (same number of candidates in total) for block
    /// searches; frame, iteration, level, stage or result for others.
    #[arg(long, help_heading = "Estimation", value_parser = pace)]
    pub pace: Option<Pace>,
    /// Set a parameter, e.g. block-size=8, or that of one estimator in lockstep, e.g. hierarchical.levels=4 or 2.levels=4 for the
    /// second; may be repeated.
    #[arg(long, help_heading = "Estimation", value_name = "K=V")]
    pub set: Vec<String>,
    /// Ground truth; by default it is searched for beside the clip.
    #[arg(long, help_heading = "Clip", value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Detections as MOTChallenge rows, as in det.txt.
    #[arg(long, help_heading = "Clip", value_name = "FILE.txt")]
    pub detections: Option<PathBuf>,
    #[command(flatten)]
    pub given: GivenArgs,
    /// First and last frame of a run through the clip, from 0; replaces --frame and --set frames.
    #[arg(long, help_heading = "Estimation", value_name = "A..B", value_parser = frames, conflicts_with = "frame")]
    pub frames: Option<(usize, usize)>,
}

/// The view options of pictures.
#[derive(Group)]
pub struct PictureArgs {
    /// Pixels of the picture per pixel of the clip.
    #[arg(long, help_heading = "Picture", value_name = "S", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub scale: u32,
    #[command(flatten, next_help_heading = "Picture")]
    pub look: LookFlags,
    /// Pixel to explain instead of the current one, from 0; `run` reports it. In another picture than frame t as t-1:X,Y or
    /// reference:X,Y.
    #[arg(long, help_heading = "Picture", value_name = "X,Y", value_parser = pixel)]
    pub pixel: Option<Pixel>,
}

/// The panes of a picture.
#[derive(Group)]
pub struct SheetArgs {
    /// Panes to arrange on one sheet, separated by commas: stage, explanation, surface, surface-3d, plane, regions, diagram,
    /// series, tiles, matrices, histogram, errors, pyramid or cloud; --scale then counts pixels per point of the sheet.
    #[arg(long, help_heading = "Picture", value_name = "A,B,..", value_delimiter = ',', num_args = 1, value_parser = pane)]
    pub panes: Vec<Named>,
}

#[derive(Group)]
pub struct RunArgs {
    #[command(flatten)]
    pub task: TaskArgs,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub sheet: SheetArgs,
    /// Step of the overlay and of --pixel: UNIT.EVENT as in 35.412, both counted from 1, UNIT for its end, 0 for the start, or end for the end of the run; end by default.
    #[arg(long, help_heading = "Picture", value_name = "CURSOR", value_parser = cursor, conflicts_with = "steps")]
    pub step: Option<Cursor>,
    /// Print the steps of a range as data, one JSON object a line, in place of the report.
    #[arg(long, help_heading = "Output", value_name = "A..B", value_parser = steps, requires = "json", conflicts_with_all = ["overlay", "repeat", "beside"])]
    pub steps: Option<(Cursor, Cursor)>,
    /// Print the link of the step in place of the report: it opens in a browser and as an argument of motionscope.
    #[arg(long, help_heading = "Output", conflicts_with_all = ["json", "overlay", "repeat", "steps"])]
    pub link: bool,
    /// Number of runs, for the timing.
    #[arg(long, help_heading = "Execution", value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub repeat: u32,
    /// Number of threads; all cores by default.
    #[arg(long, help_heading = "Execution", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=Threads::MAX as i64))]
    pub threads: Option<u32>,
    /// Save the picture of the step as .png, .svg or .pdf; `-` is standard output, a PNG unless --format is given.
    #[arg(long, help_heading = "Picture", value_name = "FILE")]
    pub overlay: Option<PathBuf>,
    /// Format of the overlay: png, svg or pdf; by its file extension by default.
    #[arg(long, help_heading = "Picture", value_parser = format, requires = "overlay")]
    pub format: Option<Format>,
    #[command(flatten)]
    pub paper: WorksheetArgs,
    #[command(flatten, next_help_heading = "Output")]
    pub results: Asked,
    /// Overwrite input files, or save among the frames of the clip.
    #[arg(long, help_heading = "Output")]
    pub force: bool,
    /// Print one JSON object; with --step, or a link or session at a step, the step is part of it.
    #[arg(long, help_heading = "Output")]
    pub json: bool,
}

#[derive(Group)]
pub struct ExportArgs {
    #[command(flatten)]
    pub task: TaskArgs,
    #[command(flatten)]
    pub picture: PictureArgs,
    #[command(flatten)]
    pub sheet: SheetArgs,
    /// First and last step, inclusive; without them the pages of a lesson.
    #[arg(long, help_heading = "Output", value_name = "A..B", value_parser = steps)]
    pub steps: Option<(Cursor, Cursor)>,
    /// Folder for numbered pictures.
    #[arg(long, help_heading = "Output", value_name = "DIR", required_unless_present_any = ["animation", "handout", "worksheet"])]
    pub out: Option<PathBuf>,
    /// Save the steps as one animation instead: .gif, .apng, .webp or, by ffmpeg, .mp4.
    #[arg(long, help_heading = "Output", value_name = "FILE", conflicts_with_all = ["out", "format"])]
    pub animation: Option<PathBuf>,
    /// Steps per second of the animation, 0.1 to 60.
    #[arg(long, help_heading = "Output", value_name = "HZ", default_value_t = Timing::default().rate_hz, value_parser = rate, requires = "animation")]
    pub rate: f32,
    /// Blended pictures that lead from each step of the animation to the next.
    #[arg(long, help_heading = "Output", value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=i64::from(Timing::MOST_BETWEEN)), requires = "animation")]
    pub between: u32,
    /// Pictures of each step in which a landscape, surface-3d, pyramid and cloud turn once around.
    #[arg(long, help_heading = "Output", value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=720), requires = "steps")]
    pub turntable: u32,
    /// Overwrite input files, or save among the frames of the clip.
    #[arg(long, help_heading = "Output")]
    pub force: bool,
    /// Save one picture per granularity of the estimator, e.g. block; one per event by default.
    #[arg(long, help_heading = "Output", value_name = "GRANULARITY")]
    pub every: Option<String>,
    /// Format of the pictures: png, svg or pdf.
    #[arg(long, help_heading = "Output", default_value = "png", value_parser = format)]
    pub format: Format,
    #[command(flatten)]
    pub paper: WorksheetArgs,
    #[command(flatten)]
    pub handout: HandoutArgs,
}

// clap shows the error of a value parser as text.

fn size(text: &str) -> Result<Size, String> {
    text.parse().map_err(|error: motionscope_core::base::Error| error.to_string())
}

fn seconds(text: &str) -> Result<f32, String> {
    let message = || format!("a recording takes 0.1 to 600 seconds, not {text}");
    text.parse().ok().filter(|seconds| (0.1..=600.0).contains(seconds)).ok_or_else(message)
}

fn pixel(text: &str) -> Result<Pixel, String> {
    text.parse().map_err(|error: motionscope_core::base::Error| error.to_string())
}

fn pane(id: &str) -> Result<Named, String> {
    id.parse().map_err(|error: motionscope_core::base::Error| error.to_string())
}

fn format(ending: &str) -> Result<Format, String> {
    ending.parse().map_err(|error: motionscope_core::base::Error| error.to_string())
}

fn pace(id: &str) -> Result<Pace, String> {
    session::pace(id).map_err(|error| error.to_string())
}

fn link_base(text: &str) -> Result<String, String> {
    let is_address = text.contains("://") && !text.contains(['#', ' ']);
    let message = || format!("an address has the form https://HOST/PATH/ without #, not {text}");
    is_address.then(|| text.to_owned()).ok_or_else(message)
}

fn rate(text: &str) -> Result<f32, String> {
    let range = Timing::RATE_HZ;
    let message = || format!("the rate is from {} to {} steps per second, not {text}", range.start(), range.end());
    text.parse().ok().filter(|rate| range.contains(rate)).ok_or_else(message)
}

fn scale(text: &str) -> Result<f32, String> {
    disparity_scale(text.parse().ok(), text).map_err(|error| error.to_string())
}

fn units(text: &str) -> Result<f32, String> {
    depth_scale(text.parse().ok(), text).map_err(|error| error.to_string())
}

fn contrast(text: &str) -> Result<Contrast, String> {
    text.parse().map_err(|error: Error| error.to_string())
}

fn cursor(text: &str) -> Result<Cursor, String> {
    text.parse().map_err(|error: motionscope_core::base::Error| error.to_string())
}

fn frames(text: &str) -> Result<(usize, usize), String> {
    let message = || format!("a range of frames has the form A..B, as in 0..99, not {text}");
    let (first, last) = text.split_once("..").ok_or_else(message)?;
    let number = |text: &str| text.trim().parse::<usize>().map_err(|_| message());
    let (first, last) = (number(first)?, number(last)?);
    if last <= first {
        return Err(format!("a range of frames A..B needs A < B, unlike {text}"));
    }
    Ok((first, last))
}

fn steps(text: &str) -> Result<(Cursor, Cursor), String> {
    let (from, to) = text.split_once("..").ok_or("a range of steps has the form A..B, as in 35..36 or 35.1..35.412")?;
    let from = match cursor(from)? {
        Cursor::END => return Err("a range of steps begins with a step, as in 35..end".into()),
        Cursor { unit, event: usize::MAX } => Cursor { unit, event: 1 },
        from => from,
    };
    let to = cursor(to)?;
    if to < from {
        return Err(format!("a range of steps A..B needs A ≤ B, unlike {text}"));
    }
    Ok((from, to))
}
