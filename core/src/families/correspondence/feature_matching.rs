//! Matching of keypoints by their descriptors.

mod charts;
mod explain;
mod marks;

use std::sync::Arc;

use crate::base::{Error, Mapped, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::methods::differential::truth;
use crate::methods::features::value as features;
use crate::methods::matching::{self, Outcome, Pair, Settings};
use crate::products::{Match, MatchField, MatchStatus, Output, Product, ProductKind};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Picture, Question, Reply, Role, Scene, Step, Unit};
use crate::{cases, params, pseudocode, variables};

params! {
    /// Keypoints of frame t matched with those of frame t + 1 by the distances of their descriptors.
    pub struct FeatureMatching {
        /// Detector, descriptor and tests.
        settings: Settings = Settings::default();
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// The outcome of each keypoint compared so far.
    found: Vec<Option<Outcome>>,
}

/// The constant part of a run.
struct Fixed {
    pair: Pair,
    truth: Option<Arc<Flow>>,
    /// Whether the truth holds for a single plane of the scene only.
    is_of_plane: bool,
}

/// An event of a keypoint.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// Frame t has no keypoints.
    Nothing,
    /// A step of its comparison.
    Of(matching::Event),
}

impl State {
    fn count(&self) -> usize {
        self.fixed.pair.sides[0].points.len()
    }

    /// The match of a keypoint, if it has a candidate.
    fn match_of(&self, index: usize, outcome: &Outcome) -> Match {
        let [here, there] = &self.fixed.pair.sides;
        outcome.matched(here, index, there)
    }

    fn matches(&self) -> impl Iterator<Item = Match> {
        let outcomes = self.found.iter().enumerate();
        outcomes.filter_map(|(index, outcome)| Some(self.match_of(index, outcome.as_ref()?)))
    }
}

impl FeatureMatching {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let fixed = Fixed {
            pair: self.settings.pair(clip, frame, threads)?,
            truth: truth(clip, frame),
            is_of_plane: clip.truth().is_some_and(|truth| truth.is_of_plane(frame)),
        };
        Ok(State { fixed: Arc::new(fixed), found: Vec::new() })
    }

    fn compare(&self, fixed: &Fixed, index: usize, observer: &mut impl Observer<Event>) -> Option<Outcome> {
        self.settings.candidates(&fixed.pair).compare(index, &mut Mapped { observer, map: Event::Of })
    }
}

pseudocode! {
    DETECT: "detect and describe the keypoints of frames t and t+1",
    EACH_KEYPOINT: "for each keypoint of frame t, with the descriptor a",
    EACH_CANDIDATE: "  for each keypoint of frame t+1 within the search radius: d ← |a − b|, b its descriptor",
    KEEP_NEAREST: "  d₁, d₂ ← the smallest and the second smallest distance",
    RATIO_TEST: "  reject it if d₁ / d₂ is not below the ratio limit",
    CROSS_CHECK: "  reject it if the nearest neighbour of b in frame t is not a",
    ACCEPT: "  else a and b are a match",
}

variables! {
    /// The keypoints of frame t + 1.
    KEYPOINTS_THERE: "", "", Unit::count("");
    /// The candidates of the keypoint.
    CANDIDATES: "", "", Unit::count("");
    /// The candidate that is nearer than all before it.
    CANDIDATE: "", r"\mathbf{b}", Unit::PX, Role::Candidate;
    /// The distance of the descriptors of the keypoint and the candidate.
    DISTANCE: "", "d", Unit::RATIO;
    /// The nearest neighbour of the keypoint.
    NEAREST: "Nearest", "", Unit::PX, Role::Best;
    /// The second nearest neighbour of the keypoint.
    SECOND: "Second nearest", "", Unit::PX, Role::Rejected;
    /// The smallest distance of the descriptors.
    D_1: "Distance d₁", "d_1", Unit::RATIO, Role::Best;
    /// The second smallest distance of the descriptors.
    D_2: "Distance d₂", "d_2", Unit::RATIO, Role::Rejected;
    /// The ratio of both distances.
    RATIO: "", r"\frac{d_1}{d_2}", Unit::FINE;
    /// The ratio limit: the largest accepted ratio.
    LIMIT: "", "", Unit::FINE;
    /// The search radius.
    RADIUS: "", "", Unit::new("px", 0);
    /// The nearest neighbour of the nearest neighbour in frame t.
    BACK: "", "", Unit::PX, Role::Rejected;
    /// The displacement of the match.
    DISPLACEMENT: "", r"(u, v)", Unit::PX;
    /// The matches so far.
    MATCHES: "Matches so far", "", Unit::count(""), Role::Result;
    /// The matches that the ratio test rejected.
    REJECTED_BY_RATIO: "", "", Unit::count("");
    /// The matches that the cross-check rejected.
    REJECTED_BY_CROSS_CHECK: "", "", Unit::count("");
    /// The matches that passed without a ratio test.
    UNTESTED: "", "", Unit::count("match");
    /// The correct matches.
    RIGHT: "", "", Unit::count("");
    /// The matches with a known true displacement.
    KNOWN: "", "", Unit::count("");
    /// The share of these matches that are correct.
    PRECISION: "", "", Unit::PERCENT;
    /// The smallest ratio of all keypoints.
    SMALLEST_RATIO: "", "", Unit::FINE;
}

cases! { over value, features;
    OPENING: "A keypoint is found again by its descriptor. {keypoints:bare} keypoints of frame t are compared with \
              {keypoints_there} of frame t+1; a match is a nearest neighbour that passes two tests.",
    NO_KEYPOINTS: "Frame t has 0 keypoints, and a match needs at least 1. A lower threshold of the detector finds weaker ones.",
    NEARER: "{candidate:bare} in frame t+1: descriptor distance d = {distance} from keypoint {position:bare}, the nearest so \
             far.",
    NO_CANDIDATE: "Keypoint {position:bare} has no candidate in the whole frame.",
    NO_CANDIDATE_NEAR: "Keypoint {position:bare} has no candidate within the search radius of {radius}.",
    COMPARED: "Keypoint {position:bare} was compared with all {candidates} candidates in the whole frame.",
    COMPARED_NEAR: "Keypoint {position:bare} was compared with all {candidates} candidates within the search radius of \
                    {radius}.",
    TWO: "Nearest neighbour {nearest:bare}, d₁ = {d_1}; second nearest {second:bare}, d₂ = {d_2}.",
    ONE: "The only candidate is {nearest:bare}, d₁ = {d_1}: without a second one there is no ratio to test.",
    NONE: "Without a candidate there is no nearest neighbour.",
    MEASURED: "Ratio test: d₁ / d₂ = {ratio}",
    IS_UNDEFINED: "Ratio test: d₁ and d₂ are both 0, so d₁ / d₂ is undefined and",
    IS_BELOW: "is below the limit {limit}, so the match is distinctive.",
    IS_NOT_BELOW: "is not below the limit {limit}",
    ALIKE: ": two candidates look alike, so the nearest may be wrong. Rejected.",
    EQUAL: ": two candidates match exactly, and neither is nearer. Rejected.",
    MUTUAL: "Cross-check: the nearest neighbour of b in frame t is the keypoint itself, so both choose each other.",
    NOT_MUTUAL: "Cross-check: the nearest neighbour of b in frame t is {back:bare}, another keypoint: rejected.",
    NO_OUTCOME: "No candidate, so no match.",
    MATCH: "{result|Match} with the displacement {displacement}",
    FAILS_RATIO: "{rejected|No match} after the ratio test",
    FAILS_CROSS_CHECK: "{rejected|No match} after the cross-check",
    IS_RIGHT: ": correct, within 3 px of the true displacement.",
    IS_WRONG: ": wrong, more than 3 px from the true displacement.",
    WAS_RIGHT: ", although the nearest neighbour is correct.",
    WAS_WRONG: "; the nearest neighbour is wrong.",
    IS_UNKNOWN: ".",
    WAS_ALONE: "It was the only candidate, so there was no ratio to test.",
    NO_MATCHES: "End of the run without matches.",
    END: "End of the run: {matches} of {keypoints:bare} keypoints matched; the ratio test rejected {rejected_by_ratio}, the \
          cross-check {rejected_by_cross_check}.",
    ONE_UNTESTED: "{untested} had a single candidate, so it passed without a ratio test.",
    SOME_UNTESTED: "{untested} had a single candidate, so they passed without a ratio test.",
    QUALITY: "{right} of {known} with known true displacement are correct, {precision}.",
    OFF_PLANE: "The truth is a homography, which holds for one plane: a correct match of a point off the plane counts as \
                wrong.",
    NOTHING_THERE: "Frame t+1 has 0 keypoints, and a match needs at least 1.",
    ALL_UNDEFINED: "All ratios are undefined: each keypoint has two candidates at distance 0.",
    RAISE_LIMIT: "The smallest ratio is {smallest_ratio}, and the limit is {limit}; a higher one accepts more.",
    SET_LIMIT: "A ratio limit below 1 rejects nearest neighbours that are hardly nearer than the second.",
    LOWER_LIMIT: "A lower ratio limit rejects more wrong matches, but on repeating texture correct ones too.",
}

impl Estimator for FeatureMatching {
    const INFO: Info = Info {
        id: "feature-matching",
        name: "Feature matching",
        family: "Correspondence",
        summary: "Correspondences of keypoints: nearest neighbours among descriptors, with ratio test and cross-check.",
        source: "D. G. Lowe, Distinctive image features from scale-invariant keypoints, International Journal of Computer Vision 60(2), 2004, \
                 section 7.1",
        pseudocode: line::ALL,
        granularities: &["frame", "keypoint", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "distinctive",
            "Does the match pass the ratio test?",
            &[
                Reply::told(line::RATIO_TEST, case::IS_NOT_BELOW, "No: two candidates look alike"),
                Reply::told(line::RATIO_TEST, case::IS_BELOW, "Yes: the nearest is much nearer than the second"),
            ],
        ),
        Question::place(
            "nearest",
            "Where is the keypoint with the nearest descriptor?",
            line::KEEP_NEAREST,
            Role::Best,
        ),
    ];
    const GUARANTEE: Guarantee = Guarantee::Better;
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[MatchField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        if state.count() == 0 {
            observer.see(|| Event::Nothing);
            return Ok(Progress::Done);
        }
        let fixed = Arc::clone(&state.fixed);
        let outcome = self.compare(&fixed, state.found.len(), observer);
        state.found.push(outcome);
        Ok(if state.found.len() == state.count() { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.count().max(1))
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let keypoints = Granularity { index: state.found.len(), of: self.units(state) };
        vec![Granularity { index: 0, of: Some(1) }, keypoints]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Of(matching::Event::Outcome(Some(Outcome { status: MatchStatus::Match, .. }))) => Some(Role::Result),
            _ => None,
        }
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(MatchField { picture: state.fixed.pair.frames[0].size(), matches: state.matches().collect() })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        let (fixed, count) = (Arc::clone(&state.fixed), state.count());
        tally.add_units(count.max(1));
        tally.add_events(u64::from(count == 0));
        let compare = |index| self.compare(&fixed, index, &mut tally.counter());
        state.found = threads.map_while(count, || clip.wanted(), compare)?;
        Ok(state)
    }
}

impl Footprint<State> for FeatureMatching {
    fn need(&self, clip: &Clip) -> Need {
        self.settings.need(clip)
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.found[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + state.fixed.pair.bytes()
    }
}

impl Pointed<State> for FeatureMatching {
    fn takes(&self, picture: Picture) -> bool {
        [Picture::CURRENT, Picture::NEXT].contains(&picture)
    }

    /// The unit that compares the keypoint nearest to a position.
    fn unit_at(&self, state: &State, Focus { on, at, .. }: Focus) -> Option<usize> {
        if on != Picture::CURRENT {
            return None;
        }
        let far = |point: [f32; 2]| (point[0] - at[0]).hypot(point[1] - at[1]);
        let points = state.fixed.pair.sides[0].points.iter().enumerate();
        points.min_by(|(_, a), (_, b)| far(a.at).total_cmp(&far(b.at))).map(|(index, _)| index)
    }
}
