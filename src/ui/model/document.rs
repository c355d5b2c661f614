//! What is open and how it is set: the clip, the estimator, the frame, and the past of all parameters.

use std::cmp::Ordering;
use std::path::PathBuf;
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::course::estimators;
use motionscope_core::data::Clip;
use motionscope_core::params::{Params, Value};
use motionscope_core::run::{AnyEstimator, Cursor, Info};
use motionscope_core::synth::{self, Difficulty, Sample};

use super::history::History;
use super::nested::Nested;
use super::snapshot::{Job, Place, Snapshot};
use crate::experiment::side_by_side::SideBySide;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Prepared};
use crate::media::Given;
use crate::media::export::Inputs;
use crate::ui::commands::Owner;

/// What is open and how it is set.
pub struct Document {
    /// The clip of the experiment, if it is open.
    clip: Option<Clip>,
    setup: History<Nested>,
    /// All files that the clip is read from.
    inputs: Arc<Inputs>,
    /// The sliders that the clip was made with, if it is synthetic.
    made: Option<Difficulty>,
    /// Why the clip could not be made with these sliders.
    refused: Option<Error>,
    /// What was run last, and where that run is to stand.
    run: Option<Arc<Prepared>>,
    place: Place,
    /// Where the run began before [`Document::begin_near`] let it begin later, and where it begins now.
    shortened: Option<(usize, usize)>,
}

impl Default for Document {
    fn default() -> Self {
        let experiment = Experiment::first(Source::File(PathBuf::new()));
        Self {
            clip: None,
            setup: History::new(Nested::alone(experiment)),
            inputs: Arc::default(),
            made: None,
            refused: None,
            run: None,
            place: Place::default(),
            shortened: None,
        }
    }
}

impl Document {
    /// The clip, if one is open.
    pub fn clip(&self) -> Option<&Clip> {
        Some(self.setup.now().clip.as_ref().unwrap_or(self.clip.as_ref()?))
    }

    /// Whether a stage is walked on pictures that its parent makes, and not on the clip that is open.
    pub fn has_own_clip(&self) -> bool {
        self.setup.now().clip.is_some()
    }

    /// What is run, if a clip is open.
    pub fn experiment(&self) -> &Experiment {
        &self.setup.now().experiment
    }

    /// The synthetic scene, if the clip is one.
    pub fn sample(&self) -> Option<&'static Sample> {
        match self.source()? {
            Source::Synth { id, .. } => synth::scene(id).ok(),
            Source::File(_) | Source::Pair(_) => None,
        }
    }

    /// Where the clip comes from, with its sliders if it is synthetic.
    pub fn source(&self) -> Option<&Source> {
        self.clip.as_ref().map(|_| &self.experiment().source)
    }

    /// The estimator with its parameters.
    pub fn estimator(&self) -> &dyn AnyEstimator {
        &*self.experiment().estimator
    }

    /// Who goes in lockstep with it.
    pub fn side_by_side(&self) -> &SideBySide {
        &self.experiment().side_by_side
    }

    /// The parameters of one owner, if it has any.
    pub fn params(&self, owner: Owner) -> Option<&dyn Params> {
        match (owner, self.source()) {
            (Owner::Estimator, _) => Some(self.estimator()),
            (Owner::Beside(index), _) => {
                self.side_by_side().beside.get(index).map(|companion| &*companion.estimator as &dyn Params)
            }
            (Owner::Difficulty, Some(Source::Synth { difficulty, .. })) => Some(difficulty),
            (Owner::Difficulty, _) => None,
        }
    }

    /// The first frame of the pair that is run on.
    pub fn frame(&self) -> usize {
        self.experiment().frame
    }

    /// The last frame that a run can start on, if the clip's length is known.
    pub fn last_frame(&self) -> Option<usize> {
        let frames = self.clip()?.info().frames?;
        Some(frames.saturating_sub(self.estimator().info().frames))
    }

    /// Why the clip could not be made, if it could not.
    pub fn refused(&self) -> Option<&Error> {
        self.refused.as_ref()
    }

    /// Opens a clip with what was given for it; the estimator keeps its parameters. Out of a stage it comes back to the outermost
    /// estimator; gives that if it does.
    pub fn open(&mut self, clip: Clip, source: Source, given: Given) -> Option<&'static Info> {
        let mut next = self.setup.now().clone();
        let left = !next.parents.is_empty();
        while next.leave().is_some() {}
        next.experiment = Experiment { source, given, frame: 0, ..next.experiment };
        self.clip = Some(clip);
        self.refused = None;
        self.inputs = Arc::default();
        self.setup = History::new(Nested::alone(next.experiment));
        self.made = self.difficulty().cloned();
        left.then(|| self.estimator().info())
    }

    /// The sliders of the clip, if it is synthetic.
    fn difficulty(&self) -> Option<&Difficulty> {
        match self.source()? {
            Source::Synth { difficulty, .. } => Some(difficulty),
            Source::File(_) | Source::Pair(_) => None,
        }
    }

    /// Notes the files that the clip is read from, so that nothing is written over them.
    pub fn read_from(&mut self, inputs: Inputs) {
        self.inputs = Arc::new(inputs);
    }

    /// Takes what `experiment` runs on the clip that is open, as a session has it: without a past.
    pub fn restore(&mut self, experiment: Experiment) {
        let Experiment { source, given, .. } = self.experiment().clone();
        let frame = experiment.frame;
        let experiment = Experiment { source, given, ..experiment };
        self.setup = History::new(Nested::alone(experiment));
        self.go_to_frame(frame);
    }

    /// Takes another estimator with its default parameters, on the clip that is open; undo brings the old one back.
    pub fn choose(&mut self, estimator: Box<dyn AnyEstimator>) {
        let mut next = self.alone();
        let before = std::mem::replace(&mut next.estimator, estimator);
        next.side_by_side.relieve(&*before, &*next.estimator);
        self.take("estimator", Nested::alone(next));
        self.go_to_frame(self.frame());
    }

    /// What is run, as it would be on the clip that is open.
    fn alone(&self) -> Experiment {
        Experiment { frame: self.setup.now().outermost().frame, ..self.experiment().clone() }
    }

    /// Has `estimator` go in lockstep with `the estimators side by side` from now on, or alone; undo brings back what was before.
    pub fn set_lockstep(&mut self, estimator: Box<dyn AnyEstimator>, side_by_side: SideBySide) {
        let experiment = Experiment { estimator, side_by_side, ..self.alone() };
        self.take("side_by_side", Nested::alone(experiment));
    }

    /// Makes a change that is none of a gesture.
    fn take(&mut self, key: &str, next: Nested) {
        self.setup.settle();
        self.setup.change(key, next);
        self.setup.settle();
    }

    /// The estimators of which the one at work is a stage, the outermost first.
    pub fn parents(&self) -> impl ExactSizeIterator<Item = &'static Info> {
        self.setup.now().parents.iter().map(|parent| parent.experiment.estimator.info())
    }

    /// Walks the stage that is parameter `index` of the estimator by itself, where `shown` stands; gives where that is in the
    /// run of the stage. `None` if that is no stage, or another run is on its way.
    ///
    /// # Errors
    /// If a picture that the stage looks at cannot be had.
    pub fn enter(&mut self, index: usize, shown: &Snapshot) -> Result<Option<Place>, Error> {
        let Some(clip) = self.clip().filter(|_| self.is_run(shown)) else { return Ok(None) };
        let Some((next, place)) = self.setup.now().enter(index, shown, clip)? else { return Ok(None) };
        self.take("stage", next);
        Ok(Some(place))
    }

    /// Goes back to the estimator of which the one at work is a stage, which has become what it is now; gives where that stands.
    pub fn leave(&mut self) -> Option<Place> {
        let mut next = self.setup.now().clone();
        let cursor = next.leave()?;
        self.take("stage", next);
        self.go_to_frame(self.frame());
        Some(Place::at(cursor))
    }

    /// Sets one parameter; the changes of one drag count as one.
    ///
    /// # Errors
    /// A sentence with the range if the value is not allowed; then nothing changes.
    pub fn set(&mut self, owner: Owner, index: usize, value: Value) -> Result<(), Error> {
        let mut next = self.setup.now().clone();
        let Experiment { estimator, side_by_side, source, .. } = &mut next.experiment;
        match (owner, source) {
            (Owner::Estimator, _) => {
                estimator.set_value(index, value)?;
                side_by_side.follow(&**estimator);
            }
            (Owner::Beside(companion), _) => {
                side_by_side.beside.get_mut(companion).map_or(Ok(()), |companion| companion.set_value(index, value))?;
            }
            (Owner::Difficulty, Source::Synth { difficulty, .. }) => difficulty.set_value(index, value)?,
            (Owner::Difficulty, Source::File(_) | Source::Pair(_)) => {}
        }
        self.setup.change(&format!("{owner:?} {index}"), next);
        self.remake();
        Ok(())
    }

    /// The drag is over: the next change is another one.
    pub fn settle(&mut self) {
        self.setup.settle();
    }

    /// Sets every parameter of `owner` as it was at first.
    pub fn reset(&mut self, owner: Owner) {
        let mut next = self.setup.now().clone();
        let Experiment { estimator, side_by_side, source, .. } = &mut next.experiment;
        match (owner, source) {
            (Owner::Estimator, _) => {
                let id = estimator.info().id;
                if let Some(fresh) = estimators().into_iter().find(|e| e.info().id == id) {
                    *estimator = fresh;
                    side_by_side.follow(&**estimator);
                }
            }
            (Owner::Beside(index), _) => side_by_side.reset(index, &**estimator),
            (Owner::Difficulty, Source::Synth { id, difficulty }) => {
                synth::scene(id).into_iter().for_each(|scene| *difficulty = scene.difficulty());
            }
            (Owner::Difficulty, Source::File(_) | Source::Pair(_)) => {}
        }
        self.take("reset", next);
        self.remake();
    }

    /// What a parameter is at first: as declared, or as the scene wants it.
    pub fn default_of(&self, owner: Owner, index: usize) -> Option<Value> {
        match (owner, self.sample()) {
            (Owner::Difficulty, Some(sample)) => Some(sample.difficulty().value(index)),
            (Owner::Beside(companion), _) => {
                let companion = self.side_by_side().beside.get(companion)?;
                Some(companion.followed(index, self.estimator()))
            }
            _ => self.params(owner)?.specs().get(index).map(|spec| spec.default.clone()),
        }
    }

    /// Whether any parameter of `owner` is not as it was at first.
    pub fn is_tuned(&self, owner: Owner) -> bool {
        let Some(params) = self.params(owner) else { return false };
        (0..params.specs().len()).any(|index| self.default_of(owner, index) != Some(params.value(index)))
    }

    /// Takes the last change back; gives whether there was one.
    pub fn undo(&mut self) -> bool {
        self.travel(History::undo)
    }

    /// Makes the change again that was taken back; gives whether there was one.
    pub fn redo(&mut self) -> bool {
        self.travel(History::redo)
    }

    /// Goes to another place of the past. The frame stays, which is no change of what is set, unless a stage is entered or left.
    fn travel(&mut self, to: impl FnOnce(&mut History<Nested>) -> bool) -> bool {
        let (before, frame) = (self.setup.now().clone(), self.frame());
        let done = to(&mut self.setup);
        let (depth, now) = (before.parents.len(), self.setup.now().parents.len());
        let frame = if now == depth { frame } else { self.frame() };
        // Into a stage or out of one, a run goes on where that stood, and not where the other does.
        let cursor = match now.cmp(&depth) {
            Ordering::Less => before.parents.get(now).map(|parent| parent.cursor),
            Ordering::Greater => self.setup.now().opened_at(),
            Ordering::Equal => None,
        };
        if let Some(cursor) = cursor {
            (self.run, self.place) = (None, Place::at(cursor));
        }
        self.remake();
        if let Some(clip) = &self.clip {
            self.setup.now_mut().look_at(clip);
        }
        // What looks at one frame may have stood at the last.
        self.go_to_frame(frame);
        done
    }

    /// Whether there is a change to take back.
    pub fn can_undo(&self) -> bool {
        self.setup.can_undo()
    }

    /// Whether there is a change to make again.
    pub fn can_redo(&self) -> bool {
        self.setup.can_redo()
    }

    /// Runs on another pair of frames, as far as the clip goes; gives whether that is another one.
    pub fn go_to_frame(&mut self, frame: usize) -> bool {
        let frame = frame.min(self.last_frame().unwrap_or(usize::MAX));
        std::mem::replace(&mut self.setup.now_mut().experiment.frame, frame) != frame
    }

    /// What is set now, with the clip that is open.
    pub fn prepared(&self) -> Option<Prepared> {
        let (experiment, clip) = (self.experiment().clone(), self.clip()?.clone());
        Some(Prepared { experiment, clip, inputs: Arc::clone(&self.inputs) })
    }

    /// The same on the clip that is open, whatever a stage looks at.
    pub fn prepared_alone(&self) -> Option<Prepared> {
        let (experiment, clip) = (self.alone(), self.clip.clone()?);
        Some(Prepared { experiment, clip, inputs: Arc::clone(&self.inputs) })
    }

    /// The run of what is set now, from `place` on.
    pub fn job_at(&mut self, place: Place) -> Option<Job> {
        let subject = Arc::new(self.prepared()?);
        (self.run, self.place) = (Some(Arc::clone(&subject)), place);
        Some(Job { subject, place })
    }

    /// Lets the run of another estimator, whose units are frames, begin so near to `place` that no frames are worked on that it does
    /// not depend on, and where it began before if it depends on all. Gives that place in the run.
    pub fn begin_near(&mut self, place: Place) -> Place {
        let shortened = self.shortened.take().filter(|(_, now)| *now == self.frame());
        let whole = shortened.map_or(self.frame(), |(whole, _)| whole);
        let is_end = place.cursor.unit == usize::MAX;
        let frame = place.cursor.unit.saturating_add(self.frame());
        let earlier = self.estimator().earlier_frames().filter(|_| !is_end && self.side_by_side().is_empty());
        self.go_to_frame(earlier.map_or(whole, |earlier| whole.max(frame.saturating_sub(earlier))));
        self.shortened = Some((whole, self.frame())).filter(|(whole, now)| whole < now);
        let unit = if is_end { place.cursor.unit } else { frame - self.frame() };
        Place { cursor: Cursor { unit, ..place.cursor }, ..place }
    }

    /// The run of what is set now, from where the last one stands: as `shown` shows it, or on its way there.
    pub fn job(&mut self, shown: Option<&Snapshot>) -> Option<Job> {
        let place = self.place(shown);
        self.job_at(place)
    }

    /// Where the last run stands: as `shown` shows it, or on its way there.
    pub fn place(&self, shown: Option<&Snapshot>) -> Place {
        shown.filter(|shown| self.is_run(shown)).map_or(self.place, |shown| {
            let (before, now) = (&shown.subject.experiment.side_by_side, self.side_by_side());
            match (before.is_empty(), now.is_empty()) {
                (false, true) => Place::alone(shown),
                (true, false) => Place::in_lockstep(shown, now.pace),
                (false, false) if before.pace != now.pace => Place::in_lockstep(shown, now.pace),
                _ => Place::of(shown),
            }
        })
    }

    /// Whether `shown` is of the run that was started last.
    fn is_run(&self, shown: &Snapshot) -> bool {
        self.run.as_ref().is_some_and(|run| Arc::ptr_eq(run, &shown.subject))
    }

    /// Whether `shown` is of this clip, if maybe with other parameters.
    pub fn is_of_clip(&self, shown: &Snapshot) -> bool {
        match (&shown.subject.experiment.source, self.source()) {
            (Source::Synth { id, .. }, Some(Source::Synth { id: now, .. })) => id == now,
            (source, now) => now == Some(source),
        }
    }

    /// Makes a synthetic clip again after its sliders moved. What was given for it by hand is read only once.
    fn remake(&mut self) {
        let (Some(sample), Some(difficulty)) = (self.sample(), self.difficulty().cloned()) else { return };
        let Some(clip) = &mut self.clip else { return };
        if self.made.as_ref() == Some(&difficulty) {
            self.refused = None;
            return;
        }
        let Given { truth, detections, .. } = &self.setup.now().experiment.given;
        let given = truth.is_some().then(|| clip.truth().cloned()).flatten();
        match synth::make(sample.id, &difficulty) {
            Ok(made) if given.is_some() && made.size() != clip.size() => {
                let (width, height) = clip.size();
                let error =
                    format!("the ground truth given for this clip has {width}×{height} px; set this size again");
                self.refused = Some(Error::new(error));
            }
            Ok(mut made) => {
                if let Some(truth) = given {
                    made = made.with_truth(truth);
                }
                if detections.is_some() {
                    made = made.with_detections_of(clip);
                }
                *clip = made;
                self.setup.now_mut().look_at(clip);
                (self.refused, self.made) = (None, Some(difficulty));
            }
            Err(error) => self.refused = Some(error),
        }
        self.go_to_frame(self.frame());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Open;

    fn document() -> Document {
        let mut document = Document::default();
        let source = Source::synth(synth::SCENES[0].id).unwrap();
        document.open(source.open(&Open::default()).unwrap().clip, source, Given::default());
        document
    }

    #[test]
    fn parameters_change_and_come_back() {
        let mut document = document();
        let at = |d: &Document| d.estimator().get("block-size").unwrap();
        assert!(!document.is_tuned(Owner::Estimator));
        document.set(Owner::Estimator, 0, Value::Int(20)).unwrap();
        document.set(Owner::Estimator, 0, Value::Int(24)).unwrap();
        assert!(document.is_tuned(Owner::Estimator) && at(&document) == Value::Int(24));
        assert!(document.set(Owner::Estimator, 0, Value::Int(999)).is_err() && at(&document) == Value::Int(24));
        assert!(document.undo() && at(&document) == Value::Int(16) && !document.can_undo());
        assert!(document.redo() && at(&document) == Value::Int(24));
        document.reset(Owner::Estimator);
        assert!(!document.is_tuned(Owner::Estimator));
        assert!(document.undo() && at(&document) == Value::Int(24));
    }

    #[test]
    fn a_source_keeps_its_sliders() {
        let mut document = document();
        let specs = document.params(Owner::Difficulty).unwrap().specs();
        let noise = specs.iter().position(|spec| spec.name == "noise").unwrap();
        document.set(Owner::Difficulty, noise, Value::Real(7.5)).unwrap();
        assert!(document.source().unwrap().to_string().ends_with("noise=7.5"));
    }

    #[test]
    fn a_parameter_of_the_estimator_leaves_the_clip() {
        let mut document = document();
        let first = |d: &Document| d.clip().unwrap().frame(0).unwrap();
        let before = first(&document);
        document.set(Owner::Estimator, 0, Value::Int(20)).unwrap();
        assert!(Arc::ptr_eq(&before, &first(&document)));
    }

    #[test]
    fn a_slider_of_the_clip_makes_another_clip() {
        let mut document = document();
        let frames = |d: &Document| d.clip().and_then(|clip| clip.info().frames).unwrap();
        let before = frames(&document);
        let specs = document.params(Owner::Difficulty).unwrap().specs();
        let index = specs.iter().position(|spec| spec.name == "frames").unwrap();
        document.go_to_frame(before);
        assert_eq!(document.frame(), before - 2);
        document.set(Owner::Difficulty, index, Value::Int(5)).unwrap();
        assert_eq!((frames(&document), document.frame()), (5, 3));
        document.undo();
        assert_eq!(frames(&document), before);
    }
}
