//! What the parts of the window ask for while they are drawn; it is done after the frame.

use std::path::PathBuf;

use motionscope_core::synth::Sample;
use motionscope_core::{Cursor, Value};

use super::commands::Command;
use super::document::Owner;
use crate::paint::Theme;

/// Something asked for.
#[derive(Clone)]
pub enum Action {
    /// A command.
    Command(Command),
    /// Open a clip or a session.
    Open(PathBuf),
    /// Open a bundled sample.
    OpenSample(&'static Sample),
    /// Give up opening a clip.
    CancelOpening,
    /// Ask the system for a clip to open: a file, or a folder.
    Browse {
        /// Whether a folder is wanted.
        folder: bool,
    },
    /// Take the estimator of this id.
    Choose(&'static str),
    /// Set a parameter.
    Set(Owner, usize, Value),
    /// A drag of a slider is over.
    Settle,
    /// Set all parameters as they were at first.
    ResetAll(Owner),
    /// Go to a place of the run.
    Seek(Cursor),
    /// Go to what lies at a pixel.
    SeekAt([f32; 2]),
    /// Explain a pixel.
    Focus(Option<[f32; 2]>),
    /// Run on the pair that starts with this frame.
    Frame(usize),
    /// Play at this speed.
    Speed(usize),
    /// Take this theme.
    Theme(Theme),
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
