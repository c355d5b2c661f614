//! What is estimated: a clip, a pair of its frames, and an estimator with its parameters.

use std::path::PathBuf;

use motionscope_core::{AnyEstimator, Clip, Cursor, Error, estimator};

use super::args::{LookArgs, TaskArgs};
use crate::experiment::company::Company;
use crate::experiment::pixel::{Chosen, Pixel};
use crate::experiment::source::Source;
use crate::media::export::{Inputs, What};
use crate::media::{self, Open};
use crate::paint::View;
use crate::session::{Named, Session, Wanted};
use crate::view::shot::Look;

/// A clip with the estimator to run on it.
pub struct Task {
    /// What the clip was called.
    pub name: String,
    /// The clip.
    pub clip: Clip,
    /// Where it comes from.
    source: Source,
    /// The truth and the detections that it was opened with.
    given: Open,
    /// The session that named it.
    session: Option<PathBuf>,
    /// The estimator with its parameters.
    pub estimator: Box<dyn AnyEstimator>,
    /// Who goes in lockstep with it.
    pub company: Company,
    /// Frame t.
    pub frame: usize,
    /// Whether its truth was given by hand, and so has to be right.
    pub truth_by_hand: bool,
    /// Where a session stands.
    pub cursor: Option<Cursor>,
    /// The pixel that a session holds.
    pub held: Option<Pixel>,
    /// How a session is looked at.
    pub look: Look,
}

impl Task {
    /// Opens what `args` names: a clip, or a session whose settings the other arguments override.
    ///
    /// # Errors
    /// If anything that is named does not exist or cannot be opened.
    pub fn open(args: &TaskArgs) -> Result<Self, Error> {
        // Detections by themselves are a clip of empty pictures.
        let (clip, detections) = match (&args.clip, &args.detections) {
            (Some(clip), detections) => (clip.clone(), detections.clone()),
            (None, Some(detections)) => {
                // What is meant as detections is told about as such, not as a clip that it is not.
                media::check_detections(detections)?;
                (detections.clone().into_os_string(), None)
            }
            (None, None) => return Err(Error::new("what clip? Name one, or give --detections FILE")),
        };
        let Named { source, truth, session } = Named::find(&clip, args.truth.clone())?;
        let named_by = session.as_ref().map(|_| PathBuf::from(&clip));
        let missing = || Error::new("which estimator? Give --estimator ID; `motionscope list` names them");
        let chosen = args.estimator.as_deref().map(estimator).transpose()?;
        let (estimator, mut company, frame, (cursor, held), look) = match session {
            Some(Session { estimator, mut company, frame, cursor, pixel, look, .. }) => {
                // Its own estimator once more, with the parameters that it gives, or another one.
                let other = chosen.filter(|chosen| chosen.info().id != estimator.info().id);
                let leader = other.unwrap_or_else(|| estimator.boxed_clone());
                company.relieve(&*estimator, &*leader);
                (leader, company, frame, (cursor, pixel), look)
            }
            None => (chosen.ok_or_else(missing)?, Company::default(), 0, (None, None), Wanted::default()),
        };
        let pace = args.pace.unwrap_or(company.pace);
        if !args.beside.is_empty() {
            company = Company::of(&*estimator, &args.beside, pace)?;
        }
        if args.pace.is_some() && company.is_empty() {
            return Err(Error::new("--pace is that of several estimators in lockstep; give --beside as well"));
        }
        company.pace = pace;
        let (name, look, truth_by_hand) = (source.to_string(), look.over(Look::default()), truth.is_some());
        let given = Open { truth, detections, ..Open::default() };
        let (clip, session) = (source.open(&given)?, named_by);
        let mut task =
            Self { name, clip, source, given, session, estimator, company, frame, truth_by_hand, cursor, held, look };
        task.frame = args.frame.unwrap_or(task.frame);
        if let Some((first, last)) = args.frames {
            let info = task.estimator.info();
            if let Some(count) = task.clip.info().frames.filter(|&count| last >= count) {
                let end = count.saturating_sub(1);
                return Err(Error::new(format!("--frames {first}..{last} goes beyond {}, the last frame", end)));
            }
            task.frame = first;
            if !task.estimator.values().iter().any(|(name, _)| *name == "frames") {
                return Err(Error::new(format!(
                    "{} works on one pair of frames; give --frame in the place of --frames",
                    info.id
                )));
            }
            task.estimator.set("frames", &(last - first + 1).to_string())?;
        }
        for setting in &args.set {
            task.company.set(&mut *task.estimator, setting)?;
        }
        task.company.check(&*task.estimator)?;
        Ok(task)
    }

    /// All files that a run of it reads.
    pub fn inputs(&self) -> Inputs {
        let mut inputs = self.source.inputs(&self.clip, &self.given);
        self.session.iter().for_each(|session| inputs.add(What::Session, session));
        inputs
    }

    /// The pixel that `args` ask for, or else that which the session holds.
    pub fn pixel(&self, args: &LookArgs) -> Option<Chosen> {
        args.pixel.map(Chosen::Asked).or(self.held.map(Chosen::Held))
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
            level: args.level.unwrap_or(self.look.level),
            share: args.blend.unwrap_or(self.look.share),
            theme: args.theme.unwrap_or(self.look.theme),
            colors: args.colors.unwrap_or(self.look.colors),
            layer: args.layer.or(self.look.layer),
            opacity: args.layer_opacity.or(self.look.opacity),
            lengthen: args.arrow_scale.unwrap_or(self.look.lengthen),
            spacing_px: args.arrow_spacing.or(self.look.spacing_px),
            streaks: args.streaks.or(self.look.streaks),
            legend: args.legend || self.look.legend,
            caption: args.caption || self.look.caption,
        })
    }
}
