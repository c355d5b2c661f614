//! What can be asked for, as clap reads it. Names are stable: scripts depend on them.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args as Group, Parser, Subcommand};
use motionscope_core::{Cursor, Pace, Threads};

use super::examples;
use super::look::LookFlags;
use crate::experiment::pixel::Pixel;
use crate::results::Asked;
use crate::session;
use crate::view::panes::Named;
use crate::view::shot::Format;

/// Walk through any motion estimator of a computer-vision course, step by step, forwards and backwards.
#[derive(Parser)]
#[command(name = "motionscope", version, after_help = examples::ALL, args_conflicts_with_subcommands = true)]
pub struct Args {
    /// What to open in the window: a clip or a session; without it, a bundled clip.
    pub clip: Option<OsString>,
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Subcommand)]
pub enum Command {
    /// Estimators with their parameters, ranges, defaults, units and source.
    #[command(after_help = examples::LIST)]
    List {
        /// As JSON.
        #[arg(long)]
        json: bool,
    },
    /// What a clip is: size, frames, rate, codec, truth.
    #[command(after_help = examples::INFO)]
    Info {
        /// The clip.
        clip: OsString,
        /// As JSON.
        #[arg(long)]
        json: bool,
        /// Decode the whole file where nothing else tells how many frames there are.
        #[arg(long)]
        count: bool,
        /// Truth given by hand: .flo, KITTI .png, a folder of them, or a MOTChallenge gt.txt.
        #[arg(long, value_name = "FILE")]
        truth: Option<PathBuf>,
    },
    /// Writes a synthetic clip: frames as PNG, truth as .flo, occlusion masks and gt.txt.
    #[command(after_help = examples::SYNTH)]
    Synth {
        /// The scene; --list names them.
        #[arg(required_unless_present = "list")]
        name: Option<String>,
        /// Folder to write to; of what is in it, only a synthetic clip written earlier is replaced.
        #[arg(long, value_name = "DIR", required_unless_present = "list")]
        out: Option<PathBuf>,
        /// Sets a slider, e.g. noise=5; may be repeated.
        #[arg(long, value_name = "K=V")]
        set: Vec<String>,
        /// Names the scenes, their sliders and what they teach.
        #[arg(long)]
        list: bool,
    },
    /// Runs an estimator on a pair of frames, or through several, and tells its time and errors.
    #[command(after_help = examples::RUN)]
    Run(RunArgs),
    /// Writes pictures of a range of steps.
    #[command(after_help = examples::EXPORT)]
    Export(ExportArgs),
    /// Several estimators on the same pair of frames, in one table.
    #[command(after_help = examples::COMPARE)]
    Compare(CompareArgs),
}

#[derive(Group)]
pub struct CompareArgs {
    /// The clip or session.
    pub clip: OsString,
    /// Ids of estimators, with commas between them; `motionscope list` names them.
    #[arg(long, value_name = "A,B,..", required_unless_present = "course", value_delimiter = ',', num_args = 1)]
    pub estimators: Vec<String>,
    /// Measures the course's table of sequential, logarithmic and hierarchical search instead, and says what of it holds.
    #[arg(long, conflicts_with_all = ["estimators", "set", "sweep", "csv", "truth"])]
    pub course: bool,
    /// Sets a parameter of one, e.g. diamond.block=8, or of all that have it, e.g. block=8; may be repeated.
    #[arg(long, value_name = "A.K=V")]
    pub set: Vec<String>,
    /// Runs all with each of these values of a parameter, or of a slider of a synthetic clip.
    #[arg(long, value_name = "K=V1,V2,..")]
    pub sweep: Option<String>,
    /// Frame t, from 0.
    #[arg(long, value_name = "N")]
    pub frame: Option<usize>,
    /// Truth given by hand; otherwise it is looked for beside the clip.
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// How often to run each, for the time; the least counts.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub repeat: u32,
    /// Threads to run on.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=Threads::MAX as i64))]
    pub threads: u32,
    /// Prints a JSON array with an object for each row.
    #[arg(long, conflicts_with = "markdown")]
    pub json: bool,
    /// Writes the table as CSV; `-` is standard output.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Writes the table even over a file that is read.
    #[arg(long)]
    pub force: bool,
    /// Prints the table as Markdown.
    #[arg(long)]
    pub markdown: bool,
}

/// What is estimated.
#[derive(Group)]
pub struct TaskArgs {
    /// The clip or session; may be left out where --detections are given.
    #[arg(required_unless_present = "detections")]
    pub clip: Option<OsString>,
    /// The estimator's id; `motionscope list` names them. A session brings its own.
    #[arg(long, value_name = "ID")]
    pub estimator: Option<String>,
    /// Frame t, from 0.
    #[arg(long, value_name = "N")]
    pub frame: Option<usize>,
    /// Up to three more estimators that go in lockstep with it, with commas between them; each has its own picture.
    #[arg(long, value_name = "B,C,..", value_delimiter = ',', num_args = 1)]
    pub beside: Vec<String>,
    /// What they have in common at every step: block (the same block, one candidate each) or budget (as many candidates in all).
    #[arg(long, value_parser = pace)]
    pub pace: Option<Pace>,
    /// Sets a parameter, e.g. block=8, for all that have it; of one beside it, e.g. hierarchical.levels=4; may be repeated.
    #[arg(long, value_name = "K=V")]
    pub set: Vec<String>,
    /// Truth given by hand; otherwise it is looked for beside the clip.
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// The detections in the clip: MOTChallenge rows, as det.txt.
    #[arg(long, value_name = "FILE.txt")]
    pub detections: Option<PathBuf>,
    /// First and last frame of a run through the clip, from 0, in the place of --frame and --set frames.
    #[arg(long, value_name = "A..B", value_parser = frames, conflicts_with = "frame")]
    pub frames: Option<(usize, usize)>,
}

/// How a picture looks.
#[derive(Group)]
pub struct PictureArgs {
    /// Pixels of the picture for each pixel of the clip.
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub scale: u32,
    #[command(flatten)]
    pub look: LookFlags,
    /// The pixel that is explained, from 0, in the place of the one at work, by estimators that explain single pixels; of another
    /// picture than frame t as t-1:X,Y or reference:X,Y.
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: Option<Pixel>,
}

/// What stands on a picture.
#[derive(Group)]
pub struct SheetArgs {
    /// Panes that are arranged on one sheet, the stage largest, with commas between them: stage, explanation, surface,
    /// surface-3d, plane, series, tiles, matrices, histogram, errors or pyramid; --scale is then pixels per point of the sheet.
    #[arg(long, value_name = "A,B,..", value_delimiter = ',', num_args = 1, value_parser = pane)]
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
    /// The step that the overlay shows: UNIT.EVENT as in 35.412, both counted from 1, UNIT for its end, or 0 for the start; the end of the run unless given.
    #[arg(long, value_name = "CURSOR", value_parser = cursor)]
    pub step: Option<Cursor>,
    /// How often to run, for the time.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub repeat: u32,
    /// Threads to run on; all cores unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=Threads::MAX as i64))]
    pub threads: Option<u32>,
    /// Writes the picture of the step, .png, .svg or .pdf; `-` is standard output, a PNG unless --format says otherwise.
    #[arg(long, value_name = "FILE")]
    pub overlay: Option<PathBuf>,
    /// What the overlay is written as, png, svg or pdf; as its ending says unless given.
    #[arg(long, value_parser = format, requires = "overlay")]
    pub format: Option<Format>,
    #[command(flatten)]
    pub results: Asked,
    /// Writes results even over files that the run reads, or among the frames.
    #[arg(long)]
    pub force: bool,
    /// Prints one JSON object.
    #[arg(long)]
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
    /// First and last step, both written.
    #[arg(long, value_name = "A..B", value_parser = steps)]
    pub steps: (Cursor, Cursor),
    /// Folder to write to.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Writes pictures even over files that the run reads, or among the frames.
    #[arg(long)]
    pub force: bool,
    /// The granularity whose stops are written, by the estimator's own name, e.g. block; every event unless given.
    #[arg(long, value_name = "RUNG")]
    pub every: Option<String>,
    /// png, svg or pdf.
    #[arg(long, default_value = "png", value_parser = format)]
    pub format: Format,
}

// What clap calls may fail with any error; the sentence is what counts.

fn pixel(text: &str) -> Result<Pixel, String> {
    text.parse().map_err(|error: motionscope_core::Error| error.to_string())
}

fn pane(id: &str) -> Result<Named, String> {
    id.parse().map_err(|error: motionscope_core::Error| error.to_string())
}

fn format(ending: &str) -> Result<Format, String> {
    ending.parse().map_err(|error: motionscope_core::Error| error.to_string())
}

fn pace(id: &str) -> Result<Pace, String> {
    session::pace(id).map_err(|error| error.to_string())
}

fn cursor(text: &str) -> Result<Cursor, String> {
    text.parse().map_err(|error: motionscope_core::Error| error.to_string())
}

fn frames(text: &str) -> Result<(usize, usize), String> {
    let told = || format!("a range of frames is written A..B, as in 0..99, and not {text}");
    let (first, last) = text.split_once("..").ok_or_else(told)?;
    let number = |text: &str| text.trim().parse::<usize>().map_err(|_| told());
    let (first, last) = (number(first)?, number(last)?);
    if last <= first {
        return Err(format!("a range of frames has two at least and runs forwards, and {text} does not"));
    }
    Ok((first, last))
}

fn steps(text: &str) -> Result<(Cursor, Cursor), String> {
    let (from, to) = text.split_once("..").ok_or("a range of steps is written A..B, as in 35..36 or 35.1..35.412")?;
    let from = match cursor(from)? {
        Cursor { unit, event: usize::MAX } => Cursor { unit, event: 1 },
        from => from,
    };
    let to = cursor(to)?;
    if to < from {
        return Err(format!("a range of steps runs forwards, and {text} does not"));
    }
    Ok((from, to))
}
