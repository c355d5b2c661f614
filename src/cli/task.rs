//! What is estimated: a clip, a pair of its frames, and an estimator with its parameters.

use std::path::Path;

use motionscope_core::{AnyEstimator, Clip, Cursor, Error, estimator};

use super::args::{LookArgs, TaskArgs};
use super::set_all;
use crate::media::Open;
use crate::session::Session;
use crate::shot::Look;
use crate::source::Source;

/// A clip with the estimator to run on it.
pub struct Task {
    /// What the clip was called.
    pub name: String,
    /// The clip.
    pub clip: Clip,
    /// The estimator with its parameters.
    pub estimator: Box<dyn AnyEstimator>,
    /// Frame t.
    pub frame: usize,
    /// Where a session stands.
    pub cursor: Option<Cursor>,
    /// How a session is looked at.
    pub look: Look,
}

impl Task {
    /// Opens what `args` names: a clip, or a session whose settings the other arguments override.
    ///
    /// # Errors
    /// If anything that is named does not exist or cannot be opened.
    pub fn open(args: &TaskArgs) -> Result<Self, Error> {
        let named = args.estimator.as_deref().map(estimator).transpose()?;
        let mut task = if Session::is_named(Path::new(&args.clip)) {
            let session = Session::load(Path::new(&args.clip))?;
            let options = Open { truth: args.truth.clone().or(session.truth), ..Open::default() };
            Self {
                name: session.source.to_string(),
                clip: session.source.open(&options)?,
                estimator: named.unwrap_or(session.estimator),
                frame: session.frame,
                cursor: session.cursor,
                look: session.look,
            }
        } else {
            let missing = || Error::new("which estimator? Give --estimator ID; `motionscope list` names them");
            let estimator = named.ok_or_else(missing)?;
            let options = Open { truth: args.truth.clone(), ..Open::default() };
            let clip = Source::parse(&args.clip)?.open(&options)?;
            Self { name: args.clip.clone(), clip, estimator, frame: 0, cursor: None, look: Look::default() }
        };
        task.frame = args.frame.unwrap_or(task.frame);
        set_all(&mut *task.estimator, &args.set)?;
        Ok(task)
    }

    /// The look that `args` ask for, over that of the session.
    pub fn look(&self, args: &LookArgs) -> Look {
        Look {
            view: args.view.or(self.look.view),
            theme: args.theme.unwrap_or(self.look.theme),
            colors: args.colors.unwrap_or(self.look.colors),
            lengthen: self.look.lengthen,
            legend: args.legend || self.look.legend,
            caption: args.caption || self.look.caption,
        }
    }
}
