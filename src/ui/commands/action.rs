//! Actions requested while the window is drawn, executed after the frame.

use std::ffi::OsString;
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::course::examples::Example;
use motionscope_core::params::Value;
use motionscope_core::run::{Cursor, Pace};
use motionscope_core::scene::Focus;
use motionscope_core::synth::Sample;

use super::{Command, Order};
use crate::experiment::comparison::Row;
use crate::media::camera::Kept;
use crate::paint::{FreehandLine, PenColor};
use crate::search::Target;
use crate::session::lesson::Address;

/// The purpose of a system file dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Browse {
    /// A file to open.
    File,
    /// A folder to open.
    Folder,
    /// A right view in a file.
    RightFile,
    /// A right view in a folder.
    RightFolder,
    /// A file to save.
    SaveFile,
    /// A folder to save in.
    SaveFolder,
}

/// The target within a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The start, before its first event.
    Start,
    /// The end, with its result.
    End,
}

/// Which set of parameters one belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Owner {
    /// The estimator.
    Estimator,
    /// The estimator in lockstep with it that has this index.
    Beside(usize),
    /// The synthetic clip.
    Difficulty,
}

/// What is asked of the pen on the line below the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PenWish {
    /// Another colour.
    Color(PenColor),
    /// Undo the last line.
    Undo,
    /// Remove all lines of the step.
    Clear,
    /// Lay the pen down.
    Done,
}

/// An action.
#[derive(Clone)]
pub enum Action {
    /// Execute a command.
    Command(Command),
    /// Open a clip or a session by its path, or a scene as `synth:pillar,noise=5`.
    Open(OsString),
    /// Open the right view of the clip by its path, or `side-by-side`.
    OpenRightView(OsString),
    /// Open the palette or the dialog that a command stands for, with something typed in it already, and whether Enter
    /// came behind it.
    Type(Command, String, bool),
    /// Open a bundled sample.
    OpenSample(&'static Sample),
    /// Open an example of the estimator with this id.
    OpenExample(&'static str, &'static Example),
    /// Open a page of a lesson.
    OpenPage(Address),
    /// Open what the search has found.
    Show(Target),
    /// Show the start page at each start, or no more.
    ShowAtStart(bool),
    /// Open a recording of a camera with the estimator of this id, and tell why the camera ended, if it did.
    OpenRecording(Arc<Kept>, Option<&'static str>, Option<Error>),
    /// Cancel opening a clip.
    CancelOpening,
    /// Open the system's file dialog.
    Browse(Browse),
    /// Save a file.
    Write(Box<Order>),
    /// Cancel saving.
    CancelWriting,
    /// Choose the estimator of this id.
    Choose(&'static str),
    /// Show the estimators that can be added to the lockstep.
    ChooseBeside,
    /// Go to the first block whose global minimum an estimator of a comparison missed.
    Visit(Arc<Row>),
    /// Run these estimators in lockstep.
    Lockstep(Vec<&'static str>),
    /// Add an estimator to the lockstep.
    AddBeside(&'static str),
    /// Take the estimator with this index out of the lockstep.
    RemoveBeside(usize),
    /// Set the pace of the lockstep.
    Pace(Pace),
    /// Set a parameter.
    Set(Owner, usize, Value),
    /// Open the stage that is this parameter.
    Enter(usize),
    /// End a slider drag.
    Settle,
    /// Start or stop placing a parameter on the picture.
    Place(Option<usize>),
    /// Set all parameters to their defaults.
    ResetAll(Owner),
    /// Go to a position in the run.
    Seek(Cursor),
    /// Go to the step of this unit that tests a displacement in px, or to the end of the unit if none does.
    SeekCandidate([i32; 2]),
    /// Go to the unit at a pixel, or hold that pixel to explain it.
    SeekAt(Focus, Side),
    /// Open the whole window at this step, in a new tab.
    OpenWhole,
    /// Show the chart with this index of those of the step.
    Chart(usize),
    /// Add a line drawn by hand to its step.
    Draw(Box<FreehandLine>),
    /// Change the pen or the ink.
    Pen(PenWish),
    /// Explain a pixel.
    Focus(Option<Focus>),
    /// Release the held pixel.
    Release,
    /// Choose the pair that starts with this frame.
    Frame(usize),
    /// Play at this speed.
    Speed(usize),
    /// Count a hand for the answer of this index to the open question, or take one away.
    Vote(usize, bool),
    /// Guess a number.
    Guess(f64),
    /// Show the result that is asked for.
    Reveal,
    /// Show a hint for a moment.
    Hint(&'static str),
    /// The error was read.
    Dismiss,
    /// Open the session or lesson that was refused since it names files outside of its folder.
    Trust,
}

/// The actions of a frame, in order.
#[derive(Default)]
pub struct Actions(pub Vec<Action>);

impl Actions {
    /// Requests an action.
    pub fn ask(&mut self, action: Action) {
        self.0.push(action);
    }

    /// Requests a command.
    pub fn command(&mut self, command: Command) {
        self.ask(Action::Command(command));
    }
}
