//! What is estimated: a clip, a pair of its frames, and an estimator with its parameters.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use motionscope_core::{AnyEstimator, Clip, Cursor, Error, estimator};

use super::args::{LookArgs, TaskArgs};
use super::set_all;
use crate::media::Open;
use crate::paint::View;
use crate::session::Session;
use crate::shot::Look;
use crate::source::Source;

/// What a person called a clip: the clip itself, or a session that leads to it.
pub struct Named {
    /// Where the clip comes from.
    pub source: Source,
    /// Its truth, if that was given by hand.
    pub truth: Option<PathBuf>,
    /// The rest of the session.
    pub session: Option<Session>,
}

impl Named {
    /// What `name` stands for; `truth` overrides that of a session.
    ///
    /// # Errors
    /// If it is a session that cannot be read, or a scene that does not exist.
    pub fn find(name: &OsStr, truth: Option<PathBuf>) -> Result<Self, Error> {
        if !Session::is_named(Path::new(name)) {
            return Ok(Self { source: Source::parse(name)?, truth, session: None });
        }
        let session = Session::load(Path::new(name))?;
        let truth = truth.or_else(|| session.truth.clone());
        Ok(Self { source: session.source.clone(), truth, session: Some(session) })
    }
}

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
        let Named { source, truth, session } = Named::find(&args.clip, args.truth.clone())?;
        let missing = || Error::new("which estimator? Give --estimator ID; `motionscope list` names them");
        let chosen = args.estimator.as_deref().map(estimator).transpose()?;
        let clip = || source.open(&Open { truth, ..Open::default() });
        let mut task = match session {
            Some(Session { estimator, frame, cursor, look, .. }) => {
                let estimator = chosen.unwrap_or(estimator);
                Self { name: source.to_string(), clip: clip()?, estimator, frame, cursor, look }
            }
            None => {
                let estimator = chosen.ok_or_else(missing)?;
                let (name, look) = (source.to_string(), Look::default());
                Self { name, clip: clip()?, estimator, frame: 0, cursor: None, look }
            }
        };
        task.frame = args.frame.unwrap_or(task.frame);
        set_all(&mut *task.estimator, &args.set)?;
        Ok(task)
    }

    /// The look that `args` ask for, over that of the session.
    ///
    /// # Errors
    /// If the share of a blend is given where nothing is blended.
    pub fn look(&self, args: &LookArgs) -> Result<Look, Error> {
        let view = args.view.or(self.look.view);
        if args.blend.is_some() && view != Some(View::Blend) {
            return Err(Error::new("--blend is the share of frame t+1 in a blend; give --view blend as well"));
        }
        Ok(Look {
            view,
            share: args.blend.unwrap_or(self.look.share),
            theme: args.theme.unwrap_or(self.look.theme),
            colors: args.colors.unwrap_or(self.look.colors),
            lengthen: self.look.lengthen,
            legend: args.legend || self.look.legend,
            caption: args.caption || self.look.caption,
        })
    }
}
