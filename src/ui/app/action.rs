//! What the parts of the window ask for while they are drawn; it is done after the frame.

use std::ffi::OsString;
use std::sync::Arc;

use motionscope_core::scene::Focus;
use motionscope_core::synth::Sample;
use motionscope_core::{Cursor, Pace, Value};

use crate::experiment::comparison::Row;
use crate::ui::app::commands::Command;
use crate::ui::model::document::Owner;
use crate::ui::model::writer::Order;

/// What the system's dialog is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Browse {
    /// A file to open.
    File,
    /// A folder to open.
    Folder,
    /// A file to write.
    SaveFile,
    /// A folder to write into.
    SaveFolder,
}

/// Which side of a unit is gone to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Before its first event.
    Start,
    /// Its result.
    End,
}

/// Something asked for.
#[derive(Clone)]
pub enum Action {
    /// A command.
    Command(Command),
    /// Open a clip or a session by its path, or a scene as `synth:pillar,noise=5`.
    Open(OsString),
    /// Open the palette or the dialog that a command stands for, with something typed in it already.
    Type(Command, String),
    /// Open a bundled sample.
    OpenSample(&'static Sample),
    /// Give up opening a clip.
    CancelOpening,
    /// Ask the system for a path.
    Browse(Browse),
    /// Write a file.
    Write(Box<Order>),
    /// Give up writing.
    CancelWriting,
    /// Take the estimator of this id.
    Choose(&'static str),
    /// Go to the first block that an estimator of a comparison missed, with that estimator.
    Visit(Arc<Row>),
    /// Have these estimators go in lockstep.
    Lockstep(Vec<&'static str>),
    /// What estimators in lockstep have in common.
    Pace(Pace),
    /// Set a parameter.
    Set(Owner, usize, Value),
    /// Walk the stage by itself that is this parameter of the estimator.
    Enter(usize),
    /// A drag of a slider is over.
    Settle,
    /// Place a parameter of the estimator on the picture, or no more.
    Place(Option<usize>),
    /// Set all parameters as they were at first.
    ResetAll(Owner),
    /// Go to a place of the run.
    Seek(Cursor),
    /// Go to the end or to the start of what lies at a pixel, or explain that pixel from now on.
    SeekAt(Focus, Side),
    /// Explain a pixel.
    Focus(Option<Focus>),
    /// Explain the pixel that was clicked no longer.
    Release,
    /// Run on the pair that starts with this frame.
    Frame(usize),
    /// Play at this speed.
    Speed(usize),
    /// The error was read.
    Dismiss,
}

/// Everything asked for in a frame, in order.
#[derive(Default)]
pub struct Actions(pub Vec<Action>);

impl Actions {
    /// Asks for something.
    pub fn ask(&mut self, action: Action) {
        self.0.push(action);
    }

    /// Asks for a command.
    pub fn command(&mut self, command: Command) {
        self.ask(Action::Command(command));
    }
}
