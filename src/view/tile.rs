//! The tiles of estimators in lockstep: a picture for each, with a line of numbers above it.

use std::sync::Arc;

use motionscope_core::data::{Clip, Frame};
use motionscope_core::products::{Assessment, Output, Reference, Streaks};
use motionscope_core::run::{Beside, CandidateCount, Cursor, Info, Walk};
use motionscope_core::scene::{Fact, Focus, Levels, Readout, Role, Scene, Sentence, Step};

use crate::paint::{LevelShown, Pictures, Tint, View, grouped};

/// One of several estimators in lockstep.
#[derive(Clone)]
pub struct Tile {
    /// The estimator.
    pub info: &'static Info,
    /// Its name, which tells it from the others, whole and short.
    pub names: [String; 2],
    /// The cursor of its own run.
    pub cursor: Cursor,
    /// The step.
    pub step: Arc<Step>,
    /// The marks to draw.
    pub scene: Arc<Scene>,
    /// Whether it waits for others.
    pub is_done: bool,
    /// Whether it is a block search, whose candidates are counted.
    pub counts_candidates: bool,
    /// Its motion-compensated prediction, at the end of all runs.
    pub prediction: Option<Arc<Frame>>,
    /// Its flow layer.
    pub layer: Option<Arc<Tint>>,
    /// Its streaklines.
    pub streaks: Option<Arc<Streaks>>,
    /// The numbers above the picture, longest first; the first that fits is shown.
    pub words: Vec<Sentence>,
}

/// The names and steps of the estimators beside one of several.
pub fn beside(tiles: &[Tile], member: usize) -> impl Iterator<Item = (&'static str, &Arc<Step>)> {
    let others = tiles.iter().enumerate().filter(move |(other, _)| *other != member);
    others.map(|(_, tile)| (tile.info.name, &tile.step))
}

/// The result of one run when all end; with a common budget it may be incomplete.
pub struct Ending {
    /// The motion-compensated prediction of frame t, where there is one.
    pub prediction: Option<Arc<Frame>>,
    /// Its assessment.
    pub assessment: Option<Assessment>,
}

/// The motion-compensated prediction of frame t that `output` makes of the other frame of `pair`, if it makes one.
pub fn predicted(output: &Output, pair: &Pictures) -> Option<Arc<Frame>> {
    output.prediction(pair.pair[1].luma()).map(|picture| Arc::new(Frame::gray(picture)))
}

/// What each of the runs in lockstep amounts to, if `walk` stands at its end; `pair` are its frames.
pub fn endings(walk: &dyn Walk, clip: &Clip, pair: &Pictures) -> Vec<Ending> {
    let all = if walk.at_end() { walk.beside(None) } else { Vec::new() };
    let reference = Reference { clip, frame: walk.frame() };
    let ending =
        |output: &Output| Ending { prediction: predicted(output, pair), assessment: output.assess(&reference).ok() };
    all.iter().map(|member| ending(&member.output)).collect()
}

/// The estimators in lockstep where `walk` stands; none where there is but one. At the end each has its ending.
pub fn tiles(walk: &dyn Walk, focus: Option<Focus>, endings: &[Ending]) -> Vec<Tile> {
    let all = walk.beside(focus);
    let are_all_done = all.iter().all(|member| member.is_done);
    let tile = |(index, member): (usize, Beside)| {
        let ending = endings.get(index);
        let counts = member.candidates.map(|count| (counted(&count, member.info), grouped(count.in_all as usize)));
        let mut step = member.step;
        if let Some(assessment) = ending.and_then(|ending| ending.assessment.as_ref()) {
            add_assessment(&mut step, assessment);
        }
        let words = match (ending.and_then(|ending| ending.assessment.as_ref()), counts) {
            (Some(assessment), counts) => said_at_end(assessment, counts.map(|(_, in_all)| in_all)),
            (None, Some((counts, in_all))) => said(&step, &counts, &in_all),
            (None, None) => said_of_step(&step),
        };
        Tile {
            info: member.info,
            names: member.names,
            cursor: member.cursor,
            scene: Arc::new(Scene { spoken: step.sentence.roles(), ..member.scene }),
            step: Arc::new(step),
            is_done: member.is_done && !are_all_done,
            counts_candidates: member.candidates.is_some(),
            prediction: ending.and_then(|ending| ending.prediction.clone()),
            layer: None,
            streaks: None,
            words,
        }
    };
    all.into_iter().enumerate().map(tile).collect()
}

impl Tile {
    /// The longest name that fits; else the short one.
    pub fn name(&self, fits: impl Fn(&str) -> bool) -> &str {
        self.names.iter().find(|name| fits(name)).unwrap_or(&self.names[1])
    }

    /// What `view` shows beside the frames that all have in common; of a pyramid the level that is `shown`.
    pub fn pictures(&self, common: &Pictures, shown: LevelShown, view: View) -> Pictures {
        let (prediction, layer, streaks) = (self.prediction.clone(), self.layer.clone(), self.streaks.clone());
        let own = Pictures { prediction, layer, streaks, ..common.clone() };
        own.on_level(self.scene.levels.as_ref(), shown, view)
    }
}

/// What `walk` shows: of several in lockstep everything that is drawn in any of their `tiles`, so that all have one
/// legend, one scale of colours and one of arrows.
pub fn scene(walk: &dyn Walk, focus: Option<Focus>, tiles: &[Tile]) -> Scene {
    if tiles.is_empty() {
        return walk.scene(focus);
    }
    let mut all = Scene::default();
    tiles.iter().for_each(|tile| all.add_enlarged(Scene::clone(&tile.scene), 1));
    all
}

/// The pyramid on which a step works: its own, or that of the first of several in lockstep that has one.
pub fn levels<'a>(scene: &'a Scene, tiles: &'a [Tile]) -> Option<&'a Levels> {
    scene.levels.as_ref().or_else(|| tiles.iter().find_map(|tile| tile.scene.levels.as_ref()))
}

/// Adds to what `step` tells how good the estimate is.
pub fn add_assessment(step: &mut Step, assessment: &Assessment) {
    add_facts(step, assessment.facts.clone());
    if !assessment.conclusion.is_empty() {
        step.sentence = std::mem::take(&mut step.sentence).text(format!(" {}", assessment.conclusion));
    }
    step.readouts.extend(assessment.errors.clone().map(Readout::Distribution));
}

/// Adds `facts` to those that `step` tells, but for what it tells already.
pub fn add_facts(step: &mut Step, facts: Vec<Fact>) {
    match step.readouts.iter_mut().find_map(|r| if let Readout::Facts(facts) = r { Some(facts) } else { None }) {
        Some(known) => {
            let is_told =
                |fact: &Fact| known.iter().any(|other| (other.label, &other.value) == (fact.label, &fact.value));
            let new: Vec<Fact> = facts.into_iter().filter(|fact| !is_told(fact)).collect();
            known.extend(new);
        }
        None => step.readouts.push(Readout::Facts(facts)),
    }
}

/// The number that matters most in what a step tells: the best so far or the result.
pub fn best(step: &Step) -> Option<&Fact> {
    let facts = step.readouts.iter().find_map(|r| if let Readout::Facts(facts) = r { Some(facts) } else { None })?;
    facts.iter().rev().find(|fact| matches!(fact.role, Some(Role::Best | Role::Result | Role::Estimate)))
}

/// The candidates of the block at hand, from many words to few; where levels are gone through, of which.
fn counted(count: &CandidateCount, info: &Info) -> [String; 3] {
    let here = grouped(count.here);
    let (leg, of) = count.leg;
    let granularity = info.granularities.iter().rev().nth(2).filter(|_| of > 1);
    let at = granularity.map_or_else(String::new, |granularity| format!(", {granularity} {leg} of {of}"));
    [format!("{here} candidates{at}"), format!("candidate {here}{at}"), format!("candidate {here}")]
}

fn said(step: &Step, [long, short, shortest]: &[String; 3], in_all: &str) -> Vec<Sentence> {
    let Some(best) = best(step) else { return vec![Sentence::default().text(long.clone())] };
    let role = best.role.unwrap_or(Role::Best);
    // A search that is over may have missed the global minimum.
    let missed = step.readouts.iter().find_map(|readout| match readout {
        Readout::Surface(surface) => {
            surface.missed().map(|(_, cost)| format!(" (missed {})", grouped(cost.round() as usize)))
        }
        _ => None,
    });
    let marked = |line: Sentence| match &missed {
        Some(missed) => line.ink(Role::Error, missed.clone()),
        None => line,
    };
    let line = |before: String, after: String| {
        marked(Sentence::default().text(before).ink(role, best.value.clone())).text(after)
    };
    // In a narrow tile the cost alone: where it lies is seen in the picture.
    let cost = best.value.split_once(" px, ").map_or(&*best.value, |(_, cost)| cost);
    vec![
        line(format!("{long}  ·  "), format!("  ·  {in_all} in all")),
        line(format!("{long}  ·  "), String::new()),
        line(format!("{short}  ·  "), String::new()),
        line(format!("{shortest}  ·  "), String::new()),
        marked(Sentence::default().text(format!("{shortest}  ·  ")).ink(role, cost)),
        marked(Sentence::default().ink(role, cost)),
    ]
}

fn said_at_end(assessment: &Assessment, in_all: Option<String>) -> Vec<Sentence> {
    // Vectors of blocks are judged by their prediction, a dense flow by its error where the truth is known.
    let error = assessment.facts.iter().find(|fact| fact.label.starts_with("Mean endpoint error") && in_all.is_none());
    let (quality, value) = match error {
        Some(fact) => (format!("{} endpoint error", fact.value), Some(fact.value.clone())),
        None => (assessment.headline.clone(), None),
    };
    let line =
        |words: &str, after: &str| Sentence::default().ink(Role::Result, words.to_owned()).text(after.to_owned());
    let counts = in_all.map(|in_all| [format!("  ·  {in_all} candidates in all"), format!("  ·  {in_all} in all")]);
    let with_counts = counts.iter().flatten().map(|counts| line(&quality, counts));
    // In a narrow tile the first figures alone.
    let figures: Vec<&str> = quality.split(", ").collect();
    let fewer = (1..=figures.len()).rev().map(|count| line(&figures[..count].join(", "), ""));
    with_counts.chain(fewer).chain(value.map(|value| line(&value, ""))).collect()
}

/// The number that a step is about, with its name and without.
fn said_of_step(step: &Step) -> Vec<Sentence> {
    let facts = step.readouts.iter().find_map(|r| if let Readout::Facts(facts) = r { Some(facts) } else { None });
    let of_role = |fact: &&Fact| fact.role.is_some_and(|role| role != Role::Truth);
    let Some(fact) = best(step).or_else(|| facts.and_then(|facts| facts.iter().rev().find(of_role))) else {
        return vec![Sentence::default()];
    };
    let value =
        |before: String| Sentence::default().text(before).ink(fact.role.unwrap_or(Role::Result), fact.value.clone());
    vec![value(format!("{}: ", fact.label)), value(String::new())]
}
