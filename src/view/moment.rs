//! Everything that a step shows, computed in one place for the window, for pictures and for sessions.

use std::sync::Arc;

use motionscope_core::base::{Error, Threads};
use motionscope_core::course::detection;
use motionscope_core::data::{Clip, Frame, Histogram};
use motionscope_core::products::objects::score::{FrameErrors, errors_on};
use motionscope_core::products::{Assessment, ObjectField, Output, Reference};
use motionscope_core::run::{Cursor, Walk};
use motionscope_core::scene::{Canvas, Fact, Focus, Levels, Picture, PictureRole, Readout, Role, Scene, Step};

use super::look::{Look, RunState};
use super::motion::{AvailableLayers, Motion, Reverse, Site};
use super::named::{LastNamed, Named};
use super::tile::{self, Ending, Tile, add_assessment, add_facts, endings, predicted, tiles};
use crate::experiment::Experiment;
use crate::paint::{FlowLayer, Freehand, FreehandLine, Pictures};

/// Everything that a run shows at its cursor.
#[derive(Clone)]
pub struct Moment {
    /// Name of the clip, as it is shown.
    pub clip: Arc<str>,
    /// Frame t of the pair at hand.
    pub frame: usize,
    /// The cursor.
    pub cursor: Cursor,
    /// Whether the cursor is at the end of the run.
    pub at_end: bool,
    /// The step; at the end with the assessment of the result.
    pub step: Arc<Step>,
    /// The step before, if it belongs to the same unit and to the same estimator: numbers that differ from it are lit.
    pub before: Option<Arc<Step>>,
    /// The marks to draw.
    pub scene: Arc<Scene>,
    /// Frames t and t + 1; at the end also prediction and residual.
    pub pictures: Pictures,
    /// The estimators in lockstep; empty for a single one.
    pub tiles: Vec<Tile>,
    /// The available flow layers.
    pub available: AvailableLayers,
    /// The error of a picture that the step asks for and that cannot be shown.
    pub missing: Option<Error>,
    /// What was drawn by hand on the step.
    pub freehand: Arc<[FreehandLine]>,
}

/// A run at its cursor, and what is to be shown of it.
#[derive(Clone, Copy)]
pub struct RunView<'a> {
    /// The run.
    pub walk: &'a dyn Walk,
    /// The clip.
    pub clip: &'a Clip,
    /// The frames of the current unit.
    pub pair: &'a Pictures,
    /// The pixel that is explained instead of the current one.
    pub focus: Option<Focus>,
    /// Whether the pictures of the step are shown side by side.
    pub beside: bool,
    /// The results at the end of the run, once computed.
    pub end: Option<&'a End>,
    /// The pictures of the step shown last.
    pub named: &'a LastNamed,
    /// The step before.
    pub before: Before<'a>,
}

/// The step before the one shown, whose numbers are compared with it.
#[derive(Clone, Copy)]
pub enum Before<'a> {
    /// Nothing is compared: no explanation is shown.
    NotShown,
    /// It is to be worked out.
    Unknown,
    /// It was shown last.
    Known(&'a Arc<Step>),
}

/// The results shown at the end of a run.
pub struct End {
    /// The motion-compensated prediction of frame t, if there is one.
    prediction: Option<Arc<Frame>>,
    /// The assessment of the result.
    assessment: Option<Assessment>,
    /// The score of the same estimator without hindsight, where it has any and the truth is known.
    causal: Option<String>,
    /// How often each displacement was found, where they are counted.
    histogram: Option<Histogram>,
    /// The results of the estimators in lockstep.
    beside: Vec<Ending>,
    /// The units with errors of tracks, by their worst.
    faults: Arc<[(usize, Fault)]>,
}

/// The worst error of the tracks of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// A true object without a track.
    Miss,
    /// A track without a true object.
    FalseAlarm,
    /// A true object with another track than before.
    IdentitySwitch,
}

impl Fault {
    /// Returns the role of its mark, as on the picture.
    pub fn role(self) -> Role {
        match self {
            Self::Miss => Role::Error,
            Self::FalseAlarm => Role::Rejected,
            Self::IdentitySwitch => Role::Window,
        }
    }

    /// Returns its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Miss => "miss",
            Self::FalseAlarm => "false alarm",
            Self::IdentitySwitch => "identity switch",
        }
    }

    /// Returns the worst error of a frame.
    fn of(errors: &FrameErrors) -> Option<Self> {
        let FrameErrors { misses, false_alarms, switches, .. } = errors;
        let all = [
            (Self::IdentitySwitch, switches.is_empty()),
            (Self::FalseAlarm, false_alarms.is_empty()),
            (Self::Miss, misses.is_empty()),
        ];
        all.into_iter().find(|(_, is_absent)| !is_absent).map(|(fault, _)| fault)
    }
}

/// Returns the units of `walk` with errors of tracks, where a unit is a frame and the truth is known.
fn faults(walk: &dyn Walk, clip: &Clip, output: &Output) -> Arc<[(usize, Fault)]> {
    let Some(field) = output.get::<ObjectField>().filter(|field| walk.units() == Some(field.frames.len())) else {
        return Arc::default();
    };
    let errors = errors_on(clip, field).ok().flatten().unwrap_or_default();
    errors.iter().filter_map(|of| Some((of.frame - field.first, Fault::of(of)?))).collect()
}

impl End {
    /// The units with errors of tracks, by their worst.
    pub fn faults(&self) -> &Arc<[(usize, Fault)]> {
        &self.faults
    }

    /// That of `walk`, the run of `experiment` on `clip`, whose last frames are `pair`; `None` where the run is not at its end.
    pub fn of(walk: &dyn Walk, experiment: &Experiment, clip: &Clip, pair: &Pictures) -> Option<Self> {
        let causal = || {
            let is_alone = experiment.side_by_side.is_empty();
            let causal = is_alone.then(|| experiment.causal(clip, walk.causal()).ok().flatten()).flatten();
            causal.map(|assessment| assessment.headline)
        };
        let assess = |output: &Output| {
            let reference = Reference { clip, frame: walk.frame() };
            let repeated = |threads| detection::assess(&*experiment.estimator, output, &reference, &threads);
            let is_alone = experiment.side_by_side.is_empty();
            let all = is_alone.then(|| Threads::all().and_then(repeated).ok()).flatten();
            // Without the next frame the rest is known.
            all.or_else(|| output.assess(&reference).ok())
        };
        walk.at_end().then(|| {
            let output = walk.output();
            Self {
                prediction: predicted(&output, pair),
                assessment: assess(&output),
                causal: causal(),
                histogram: output.histogram(),
                faults: if walk.beside(None).is_empty() { faults(walk, clip, &output) } else { Arc::default() },
                beside: endings(walk, clip, pair),
            }
        })
    }
}

impl Moment {
    /// What is shown at `standing`, with what `motion` makes of the motion there.
    ///
    /// # Errors
    /// Whatever `motion` fails with.
    pub fn of<E>(standing: RunView<'_>, motion: impl FnOnce(Site<'_>) -> Result<Motion, E>) -> Result<Self, E> {
        let RunView { walk, clip, pair, focus, beside, end, .. } = standing;
        let mut tiles = tiles(walk, focus, end.map_or(&[], |end| &end.beside));
        let scene = tile::scene(walk, focus, &tiles);
        let mut pictures = Pictures { prediction: end.and_then(|end| end.prediction.clone()), ..pair.clone() };
        let motion = motion(Site { walk, clip, scene: &scene })?;
        motion.put(&mut pictures, &mut tiles);
        let Named { frames, missing } =
            if beside || is_joined(&scene) { named(&scene, standing) } else { Named::default() };
        pictures.beside = frames;
        let measured = scene.pictures.iter().filter_map(|canvas| Some((canvas.picture, canvas.measured.clone()?)));
        pictures.measured = measured.collect();
        let missing = missing.map(|(picture, error)| {
            Error::new(format!("{} is not shown: {error}", picture.title(Some(walk.at_frame()))))
        });
        let step = explained_step(standing, &motion, missing.as_ref());
        let scene = Scene { spoken: step.sentence.roles(), ..scene };
        Ok(Self {
            clip: clip.info().name.as_str().into(),
            frame: walk.at_frame(),
            cursor: walk.cursor(),
            at_end: walk.at_end(),
            step: Arc::new(step),
            before: match standing.before {
                Before::NotShown => None,
                Before::Unknown => walk.step_before(focus).map(Arc::new),
                Before::Known(step) => Some(Arc::clone(step)),
            },
            scene: Arc::new(scene),
            pictures,
            tiles,
            available: motion.available,
            missing,
            freehand: Arc::default(),
        })
    }

    /// Where the run of an estimator that looks at single frames, or at pairs, stands for the choice of a view.
    pub fn stands(&self, shows_frame_alone: bool) -> RunState {
        let search = self.tiles.iter().any(|tile| tile.counts_candidates);
        RunState {
            shows_frame_alone,
            at_end: self.at_end,
            is_lockstep: !self.tiles.is_empty(),
            is_search: search,
            is_joined: is_joined(&self.scene),
        }
    }

    /// Returns why `layer` is not shown, as part of a sentence; `None` if it is.
    pub fn why_without(&self, layer: FlowLayer) -> Option<&'static str> {
        let mut shown = self.pictures.layer.iter().chain(self.tiles.iter().filter_map(|tile| tile.layer.as_ref()));
        let is_shown = shown.any(|tint| tint.kind == layer);
        (!is_shown).then(|| self.available.why_not(layer).unwrap_or("no motion is estimated yet"))
    }

    /// Returns the pyramid of the step, if there is one.
    pub fn levels(&self) -> Option<&Levels> {
        tile::levels(&self.scene, &self.tiles)
    }
}

/// The pictures that `scene` is about, where those are not frames t and t + 1.
fn named(scene: &Scene, RunView { walk, clip, pair, named, .. }: RunView<'_>) -> Named {
    let read = |picture: Picture| {
        if [Picture::CURRENT, Picture::NEXT].contains(&picture) {
            return Ok(Arc::clone(pair.frame_of(picture)));
        }
        let index = walk.at_frame().checked_add_signed(picture.time as isize);
        index.map_or_else(
            || Err(Error::new("the clip begins after it")),
            |index| clip.frame_from(picture.viewpoint, index),
        )
    };
    named.of(walk.cursor(), &scene.pictures, read)
}

/// What the step tells; at the end, also how good the estimate is.
fn explained_step(RunView { walk, focus, end, .. }: RunView<'_>, motion: &Motion, missing: Option<&Error>) -> Step {
    let mut step = walk.step(focus);
    if let Some(missing) = missing {
        add_facts(&mut step, vec![Fact::new("Missing picture", missing.to_string(), Some(Role::Rejected))]);
    }
    let Some(end) = end else { return step };
    if let Some(assessment) = &end.assessment {
        add_assessment(&mut step, assessment);
    }
    if let Some(causal) = &end.causal {
        add_facts(&mut step, vec![Fact::new("Without hindsight", causal.clone(), None)]);
    }
    let facts = motion.facts();
    if !facts.is_empty() {
        add_facts(&mut step, facts);
    }
    step.readouts.extend(end.histogram.clone().map(Readout::Histogram));
    step
}

/// Whether a step relates its pictures to each other, so that they are shown side by side.
fn is_joined(scene: &Scene) -> bool {
    let is_derived = |canvas: &Canvas| {
        canvas.picture.is_filtered() || matches!(canvas.picture.role, PictureRole::Warped | PictureRole::Mosaic)
    };
    !scene.links.is_empty() || scene.pictures.iter().any(is_derived)
}

/// Frames `t` and `t + 1` of `clip`, and what their files are called; the last frame stands beside itself.
///
/// # Errors
/// If there is no such frame, or it cannot be decoded.
pub fn pair(clip: &Clip, t: usize) -> Result<Pictures, Error> {
    Ok(Pictures { names: [t, t + 1].map(|frame| clip.frame_name(frame)), ..Pictures::of(clip.pair_or_last(t)?) })
}

/// The pair of frames that was shown last: most steps show the same as the one before.
#[derive(Default)]
pub struct LastPair(Option<(usize, Pictures)>);

impl LastPair {
    /// The frames that the unit at hand of `walk` works on.
    ///
    /// # Errors
    /// As [`pair`].
    pub fn of(&mut self, walk: &dyn Walk, clip: &Clip) -> Result<&Pictures, Error> {
        let t = walk.at_frame();
        let pictures = match self.0.take() {
            Some((frame, pictures)) if frame == t => pictures,
            _ => pair(clip, t)?,
        };
        Ok(&self.0.insert((t, pictures)).1)
    }
}

/// A run whose steps are looked at one after the other, without a window.
pub struct Viewer<'a> {
    /// The run: it goes wherever it is sent.
    pub walk: Box<dyn Walk>,
    /// What was drawn by hand in the run.
    pub freehand: Freehand,
    experiment: &'a Experiment,
    clip: &'a Clip,
    look: &'a Look,
    reverse: &'a Reverse<'a>,
    pairs: LastPair,
    named: LastNamed,
    beside: bool,
    is_explained: bool,
}

impl<'a> Viewer<'a> {
    /// The run of `experiment` on `clip`, at its start, seen with `look`; a check asks `reverse` for its flow.
    ///
    /// # Errors
    /// If it cannot run there.
    pub fn new(
        experiment: &'a Experiment,
        clip: &'a Clip,
        look: &'a Look,
        reverse: &'a Reverse<'a>,
    ) -> Result<Self, Error> {
        let beside = look.shows_beside(experiment.estimator.shows_frame_alone());
        Ok(Self {
            walk: experiment.walk(clip)?,
            freehand: Freehand::default(),
            experiment,
            clip,
            look,
            reverse,
            pairs: LastPair::default(),
            named: LastNamed::default(),
            beside,
            is_explained: true,
        })
    }

    /// The same where an explanation of the steps is shown, or not.
    #[must_use]
    pub fn with_explanation(self, is_explained: bool) -> Self {
        Self { is_explained, ..self }
    }

    /// What is shown where the run stands, with the pixel `focus` explained.
    ///
    /// # Errors
    /// If a frame, a picture that the step names, the truth or the reverse pair that it takes cannot be had.
    pub fn moment(&mut self, focus: Option<Focus>) -> Result<Moment, Error> {
        let Self { walk, freehand, experiment, clip, look, reverse, pairs, named, beside, is_explained } = self;
        let (walk, clip) = (&**walk, *clip);
        let pair = pairs.of(walk, clip)?;
        let end = End::of(walk, experiment, clip, pair);
        let before = if *is_explained { Before::Unknown } else { Before::NotShown };
        let standing = RunView { walk, clip, pair, focus, beside: *beside, end: end.as_ref(), named, before };
        let moment = Moment::of(standing, |site| Motion::of(site, look, || reverse.flow().map(Some)))?;
        let moment = Moment { freehand: freehand.at(moment.cursor).into(), ..moment };
        moment.missing.clone().map_or(Ok(moment), Err)
    }
}
