//! What is open and how it is set: the clip, the estimator, the frame, and the past of all parameters.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::stage::{self, Opened};
use motionscope_core::synth::{self, Difficulty, Sample};
use motionscope_core::{AnyEstimator, Clip, Cursor, Error, Info, Params, Value, estimators};

use super::history::History;
use super::snapshot::{Job, Place, Snapshot, Subject};
use crate::experiment::company::Company;
use crate::experiment::source::Source;
use crate::media::export::Inputs;

/// Where a clip comes from.
enum Origin {
    /// A file or folder.
    File(PathBuf),
    /// A scene that is made on the fly.
    Sample(&'static Sample),
}

/// Everything that undo takes back.
pub struct Setup {
    /// The estimator with its parameters.
    pub estimator: Box<dyn AnyEstimator>,
    /// Who goes in lockstep with it.
    pub company: Company,
    /// What makes the clip hard, if it is synthetic.
    pub difficulty: Option<Difficulty>,
    /// The estimators of which it is a stage, one of the other, while that is walked by itself: the outermost first.
    pub parents: Vec<Parent>,
    /// The frame that the stage at work runs on, where it is one.
    pub stage_frame: Option<usize>,
    /// The clip that it looks at, where that is not the one that is open.
    pub stage_clip: Option<Clip>,
}

/// An estimator that waits while one of its stages is walked by itself.
pub struct Parent {
    estimator: Box<dyn AnyEstimator>,
    company: Company,
    /// The parameter that the stage is.
    index: usize,
    /// The frame that its run begins on, and where that stands.
    frame: usize,
    cursor: Cursor,
    /// The clip that it looks at, where that is not the one that is open.
    clip: Option<Clip>,
}

impl Clone for Parent {
    fn clone(&self) -> Self {
        let Self { estimator, company, index, frame, cursor, clip } = self;
        let (estimator, company, clip) = (estimator.boxed_clone(), company.clone(), clip.clone());
        Self { estimator, company, index: *index, frame: *frame, cursor: *cursor, clip }
    }
}

impl PartialEq for Parent {
    fn eq(&self, other: &Self) -> bool {
        let Self { estimator, company, index, frame, cursor, .. } = self;
        is_same(&**estimator, &*other.estimator)
            && *company == other.company
            && (*index, *frame, *cursor) == (other.index, other.frame, other.cursor)
    }
}

/// Whether both are the same estimator with the same parameters.
fn is_same(a: &dyn AnyEstimator, b: &dyn AnyEstimator) -> bool {
    a.info().id == b.info().id && a.values() == b.values()
}

impl Clone for Setup {
    fn clone(&self) -> Self {
        let Self { estimator, company, difficulty, parents, stage_frame, stage_clip } = self;
        let (company, difficulty, parents) = (company.clone(), difficulty.clone(), parents.clone());
        let (estimator, stage_clip) = (estimator.boxed_clone(), stage_clip.clone());
        Self { estimator, company, difficulty, parents, stage_frame: *stage_frame, stage_clip }
    }
}

impl PartialEq for Setup {
    fn eq(&self, other: &Self) -> bool {
        // The clip of a stage follows from the others.
        let Self { estimator, company, difficulty, parents, stage_frame, .. } = self;
        is_same(&**estimator, &*other.estimator)
            && *company == other.company
            && *difficulty == other.difficulty
            && *parents == other.parents
            && *stage_frame == other.stage_frame
    }
}

/// Which of the two sets of parameters one belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The estimator.
    Estimator,
    /// The synthetic clip.
    Difficulty,
}

/// What is open and how it is set.
pub struct Document {
    clip: Option<(Clip, Origin)>,
    setup: History<Setup>,
    frame: usize,
    /// Truth given by hand.
    truth: Option<PathBuf>,
    /// All files that the clip is read from.
    inputs: Arc<Inputs>,
    /// The sliders that the clip was made with, if it is synthetic.
    made: Option<Difficulty>,
    /// Why the clip could not be made with these sliders.
    refused: Option<Error>,
    /// What was run last, and where that run is to stand.
    run: Option<Arc<Subject>>,
    place: Place,
}

impl Default for Document {
    fn default() -> Self {
        let estimator = estimators().swap_remove(0);
        let setup = History::new(Setup {
            estimator,
            company: Company::default(),
            difficulty: None,
            parents: Vec::new(),
            stage_frame: None,
            stage_clip: None,
        });
        Self {
            clip: None,
            setup,
            frame: 0,
            truth: None,
            inputs: Arc::default(),
            made: None,
            refused: None,
            run: None,
            place: Place::default(),
        }
    }
}

impl Document {
    /// The clip, if one is open.
    pub fn clip(&self) -> Option<&Clip> {
        let (clip, _) = self.clip.as_ref()?;
        Some(self.setup.now().stage_clip.as_ref().unwrap_or(clip))
    }

    /// The synthetic scene, if the clip is one.
    pub fn sample(&self) -> Option<&'static Sample> {
        match self.clip {
            Some((_, Origin::Sample(sample))) => Some(sample),
            _ => None,
        }
    }

    /// Where the clip comes from, with its sliders if it is synthetic.
    pub fn source(&self) -> Option<Source> {
        match &self.clip.as_ref()?.1 {
            Origin::File(path) => Some(Source::File(path.clone())),
            Origin::Sample(sample) => {
                let difficulty = self.setup.now().difficulty.clone().unwrap_or_else(|| sample.difficulty());
                Some(Source::Synth { id: sample.id, difficulty })
            }
        }
    }

    /// The estimator and the difficulty.
    pub fn setup(&self) -> &Setup {
        self.setup.now()
    }

    /// The estimator with its parameters.
    pub fn estimator(&self) -> &dyn AnyEstimator {
        self.setup.now().estimator.as_ref()
    }

    /// Who goes in lockstep with it.
    pub fn company(&self) -> &Company {
        &self.setup.now().company
    }

    /// The parameters of one owner, if it has any.
    pub fn params(&self, owner: Owner) -> Option<&dyn Params> {
        match owner {
            Owner::Estimator => Some(self.estimator()),
            Owner::Difficulty => self.setup.now().difficulty.as_ref().map(|d| d as &dyn Params),
        }
    }

    /// The first frame of the pair that is run on.
    pub fn frame(&self) -> usize {
        self.frame
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

    /// Truth that was given by hand.
    pub fn truth(&self) -> Option<&Path> {
        self.truth.as_deref()
    }

    /// Opens a clip with the truth that was given for it; the estimator keeps its parameters.
    pub fn open(&mut self, clip: Clip, source: Source, truth: Option<PathBuf>) {
        let (origin, difficulty) = match source {
            Source::File(path) => (Origin::File(path), None),
            Source::Synth { id, difficulty } => match synth::scene(id) {
                Ok(sample) => (Origin::Sample(sample), Some(difficulty)),
                Err(_) => (Origin::File(id.into()), None),
            },
        };
        self.clip = Some((clip, origin));
        self.frame = 0;
        (self.truth, self.refused) = (truth, None);
        self.inputs = Arc::default();
        self.made = difficulty.clone();
        self.setup = History::new(Setup {
            difficulty,
            parents: Vec::new(),
            stage_frame: None,
            stage_clip: None,
            ..self.setup.now().clone()
        });
    }

    /// Notes the files that the clip is read from, so that nothing is written over them.
    pub fn read_from(&mut self, inputs: Inputs) {
        self.inputs = Arc::new(inputs);
    }

    /// Takes an estimator with its parameters, its company and a frame, as a session has them: without a past.
    pub fn restore(&mut self, estimator: Box<dyn AnyEstimator>, company: Company, frame: usize) {
        let difficulty = self.setup.now().difficulty.clone();
        self.setup = History::new(Setup {
            estimator,
            company,
            difficulty,
            parents: Vec::new(),
            stage_frame: None,
            stage_clip: None,
        });
        self.go_to_frame(frame);
    }

    /// Takes another estimator with its default parameters; undo brings the old one back.
    pub fn choose(&mut self, estimator: Box<dyn AnyEstimator>) {
        let mut next = self.setup.now().clone();
        let before = std::mem::replace(&mut next.estimator, estimator);
        next.company.relieve(&*before, &*next.estimator);
        next.parents.clear();
        (next.stage_frame, next.stage_clip) = (None, None);
        self.setup.settle();
        self.setup.change("estimator", next);
        self.setup.settle();
        self.go_to_frame(self.frame);
    }

    /// Has `estimator` go in lockstep with `company` from now on, or alone; undo brings back what was before.
    pub fn keep_company(&mut self, estimator: Box<dyn AnyEstimator>, company: Company) {
        let next = Setup {
            estimator,
            company,
            parents: Vec::new(),
            stage_frame: None,
            stage_clip: None,
            ..self.setup.now().clone()
        };
        self.setup.settle();
        self.setup.change("company", next);
        self.setup.settle();
    }

    /// The estimators of which the one at work is a stage, the outermost first.
    pub fn parents(&self) -> impl ExactSizeIterator<Item = &'static Info> {
        self.setup.now().parents.iter().map(|parent| parent.estimator.info())
    }

    /// Walks the stage that is parameter `index` of the estimator by itself, where `shown` stands; gives where that is in the
    /// run of the stage.
    pub fn enter(&mut self, index: usize, shown: &Snapshot) -> Option<Place> {
        let now = self.setup.now();
        let opened = stage::open(&*now.estimator, index, self.clip()?, (self.frame, shown.frame));
        let Opened { estimator, clip: own_clip, frame, cursor } = opened.ok().flatten()?;
        // A parent may stand at the last frame, of which there is no pair.
        let frames = own_clip.as_ref().unwrap_or(self.clip()?).info().frames;
        let frame = frame.min(frames.map_or(usize::MAX, |frames| frames.saturating_sub(estimator.info().frames)));
        let stage_frame = Some(frame);
        let stage_clip = own_clip.or_else(|| now.stage_clip.clone());
        let mut next = Setup { estimator, company: Company::default(), stage_frame, stage_clip, ..now.clone() };
        next.parents.push(Parent {
            estimator: now.estimator.boxed_clone(),
            company: now.company.clone(),
            index,
            frame: self.frame,
            cursor: shown.leader(),
            clip: now.stage_clip.clone(),
        });
        self.setup.settle();
        self.setup.change("stage", next);
        self.setup.settle();
        self.frame = frame;
        Some(Place { cursor, ..Place::default() })
    }

    /// Goes back to the estimator of which the one at work is a stage, which has become what it is now; gives where that stands.
    pub fn leave(&mut self) -> Option<Place> {
        let mut next = self.setup.now().clone();
        let Parent { mut estimator, company, index, frame, cursor, clip } = next.parents.pop()?;
        // How many frames it goes through is its parent's to say.
        let looked_at = clip.as_ref().or(self.clip.as_ref().map(|(clip, _)| clip))?;
        let opened = stage::open(&*estimator, index, looked_at, (frame, frame)).ok().flatten();
        let is_as_it_was = opened.is_some_and(|opened| is_same(&*opened.estimator, &*next.estimator));
        if !is_as_it_was {
            // What was opened as this stage can be one.
            estimator.set_value(index, stage::value_of(&*next.estimator)).ok()?;
        }
        (next.estimator, next.company, next.stage_clip) = (estimator, company, clip);
        next.stage_frame = (!next.parents.is_empty()).then_some(frame);
        self.setup.settle();
        self.setup.change("stage", next);
        self.setup.settle();
        self.frame = frame;
        Some(Place { cursor, ..Place::default() })
    }

    /// Sets one parameter; the changes of one drag count as one.
    ///
    /// # Errors
    /// A sentence with the range if the value is not allowed; then nothing changes.
    pub fn set(&mut self, owner: Owner, index: usize, value: Value) -> Result<(), Error> {
        let mut next = self.setup.now().clone();
        match (owner, &mut next.difficulty) {
            (Owner::Estimator, _) => {
                next.estimator.set_value(index, value)?;
                next.company.follow(&*next.estimator);
            }
            (Owner::Difficulty, Some(difficulty)) => difficulty.set_value(index, value)?,
            (Owner::Difficulty, None) => {}
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
        match owner {
            Owner::Estimator => {
                let id = next.estimator.info().id;
                if let Some(fresh) = estimators().into_iter().find(|e| e.info().id == id) {
                    next.estimator = fresh;
                    next.company.follow(&*next.estimator);
                }
            }
            Owner::Difficulty => next.difficulty = self.sample().map(Sample::difficulty),
        }
        self.setup.settle();
        self.setup.change("reset", next);
        self.setup.settle();
        self.remake();
    }

    /// What a parameter is at first: as declared, or as the scene wants it.
    pub fn default_of(&self, owner: Owner, index: usize) -> Option<Value> {
        match (owner, self.sample()) {
            (Owner::Difficulty, Some(sample)) => Some(sample.difficulty().value(index)),
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
        let outer = self.outer_frame();
        let done = self.setup.undo();
        self.frame_of_stage(outer);
        self.remake();
        // What looks at one frame may have stood at the last.
        self.go_to_frame(self.frame);
        done
    }

    /// Makes the change again that was taken back; gives whether there was one.
    pub fn redo(&mut self) -> bool {
        let outer = self.outer_frame();
        let done = self.setup.redo();
        self.frame_of_stage(outer);
        self.remake();
        // What looks at one frame may have stood at the last.
        self.go_to_frame(self.frame);
        done
    }

    /// The frame that the outermost estimator runs on, while one of its stages is walked by itself.
    fn outer_frame(&self) -> Option<usize> {
        self.setup.now().parents.first().map(|parent| parent.frame)
    }

    /// Goes to the frame of the stage that is at work now, or from a stage, `outer` being that of its parent, back to this one.
    fn frame_of_stage(&mut self, outer: Option<usize>) {
        self.frame = self.setup.now().stage_frame.or(outer).unwrap_or(self.frame);
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
        std::mem::replace(&mut self.frame, frame) != frame
    }

    /// The run of what is set now, from `place` on.
    pub fn job_at(&mut self, place: Place) -> Option<Job> {
        let subject = Arc::new(Subject {
            clip: self.clip()?.clone(),
            source: self.source()?,
            truth: self.truth.clone(),
            inputs: Arc::clone(&self.inputs),
            estimator: self.estimator().boxed_clone(),
            company: self.company().clone(),
            frame: self.frame,
        });
        (self.run, self.place) = (Some(Arc::clone(&subject)), place);
        Some(Job { subject, place })
    }

    /// The run of what is set now, from where the last one stands: as `shown` shows it, or on its way there.
    pub fn job(&mut self, shown: Option<&Snapshot>) -> Option<Job> {
        let place = shown.filter(|shown| self.is_run(shown)).map_or(self.place, |shown| {
            let (before, now) = (&shown.subject.company, self.company());
            match (before.is_empty(), now.is_empty()) {
                (false, true) => Place::alone(shown),
                (true, false) => Place::in_lockstep(shown, now.pace),
                (false, false) if before.pace != now.pace => Place::in_lockstep(shown, now.pace),
                _ => Place::of(shown),
            }
        });
        self.job_at(place)
    }

    /// Whether `shown` is of the run that was started last.
    fn is_run(&self, shown: &Snapshot) -> bool {
        self.run.as_ref().is_some_and(|run| Arc::ptr_eq(run, &shown.subject))
    }

    /// Whether `shown` is of this clip, if maybe with other parameters.
    pub fn is_of_clip(&self, shown: &Snapshot) -> bool {
        match (&shown.subject.source, self.source()) {
            (Source::Synth { id, .. }, Some(Source::Synth { id: now, .. })) => *id == now,
            (source, now) => now.as_ref() == Some(source),
        }
    }

    /// Makes a synthetic clip again after its sliders moved. The truth that was given for it is read only once.
    fn remake(&mut self) {
        let (Some(sample), Some(difficulty)) = (self.sample(), self.setup.now().difficulty.clone()) else { return };
        let Some((clip, _)) = &mut self.clip else { return };
        if self.made.as_ref() == Some(&difficulty) {
            self.refused = None;
            return;
        }
        let given = self.truth.is_some().then(|| clip.truth().cloned()).flatten();
        match synth::make(sample.id, &difficulty) {
            Ok(made) if given.is_some() && made.size() != clip.size() => {
                let (width, height) = clip.size();
                let error = format!("the truth given for this clip is for {width}×{height} px; set that size again");
                self.refused = Some(Error::new(error));
            }
            Ok(made) => {
                *clip = given.map_or_else(|| made.clone(), |truth| made.clone().with_truth(truth));
                (self.refused, self.made) = (None, Some(difficulty));
            }
            Err(error) => self.refused = Some(error),
        }
        self.go_to_frame(self.frame);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::media::Open;

    fn document() -> Document {
        let mut document = Document::default();
        let source = Source::synth(synth::SCENES[0].id).unwrap();
        document.open(source.open(&Open::default()).unwrap(), source, None);
        document
    }

    #[test]
    fn parameters_change_and_come_back() {
        let mut document = document();
        let at = |d: &Document| d.estimator().get("block").unwrap();
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
