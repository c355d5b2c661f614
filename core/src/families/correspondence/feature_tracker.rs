//! Feature tracking by matching: keypoints of consecutive frames are matched by their descriptors and linked to tracks.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::methods::differential::truth;
use crate::methods::features::value as features;
use crate::methods::matching::{Described, Outcome, Settings};
use crate::products::{Feature, MatchStatus, Output, Product, ProductKind, Status, Track, TrackField};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen, Span, need, run_counted};
use crate::scene::{Chart, Question, Reply, Role, Scene, Step, Unit};
use crate::{cases, params, pseudocode, variables};

params! {
    /// Feature tracking by matching keypoints from frame to frame.
    pub struct FeatureTracker {
        /// Number of frames, including the first; fewer at the end of the clip.
        frames: usize = 30, 2..=10_000;
        /// Detector, descriptor and tests.
        matching: Settings = Settings { radius: 60, ..Settings::default() };
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    span: Span,
    /// The first frame of the next pair.
    frame: usize,
    /// All tracks, in the order of their start.
    tracks: Vec<Arc<Track>>,
    /// The track of each keypoint of the first frame of the pair, if one ends there.
    live: Arc<Vec<Option<u32>>>,
    /// Number of tracks that each earlier pair continues or begins.
    counts: Arc<Vec<u32>>,
    picture: (usize, usize),
    /// The keypoints of the first frame of the pair; computed again where they are missing.
    side: Option<Arc<Described>>,
    /// Memory of the keypoints of a frame in bytes.
    side_bytes: usize,
}

/// The keypoints of a pair of frames.
pub struct Pair {
    sides: [Arc<Described>; 2],
    truth: Option<Arc<Flow>>,
}

/// The outcome for a keypoint of the first frame of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linked {
    /// Its index.
    index: usize,
    /// The comparison, if there was a candidate.
    outcome: Option<Outcome>,
    /// The track that ended at it.
    track: Option<u32>,
    /// The keypoint of the second frame, if it is linked to one.
    to: Option<usize>,
}

/// An event of a pair of frames.
#[derive(Clone)]
pub enum Event {
    /// The keypoints of both frames.
    Detected(Arc<Pair>),
    /// A keypoint continues a track, begins one, ends one, or remains alone.
    Linked(Arc<Pair>, Linked),
    /// The pair is done.
    Ended(Arc<Pair>),
}

impl FeatureTracker {
    /// The keypoints of the pair; those of its first frame are reused from the pair before.
    fn pair(&self, clip: &Clip, state: &mut State, threads: &Threads) -> Result<Arc<Pair>, Error> {
        clip.wanted()?;
        need::check_kept(clip, self.state_bytes(state))?;
        let first = match state.side.take() {
            Some(side) => side,
            None => Arc::new(self.matching.side(clip, state.frame, threads)?),
        };
        let second = Arc::new(self.matching.side(clip, state.frame + 1, threads)?);
        state.side_bytes = first.bytes();
        Ok(Arc::new(Pair { sides: [first, second], truth: truth(clip, state.frame) }))
    }

    /// The nearest neighbours of all keypoints of a pair, with their tests.
    fn compared(&self, clip: &Clip, pair: &Pair, threads: &Threads) -> Result<Vec<Option<Outcome>>, Error> {
        let candidates = self.matching.candidates_of(pair.sides.each_ref().map(|side| &**side));
        threads.map_while(pair.sides[0].points.len(), || clip.wanted(), |index| candidates.compare(index, &mut ()))
    }

    /// The keypoint of frame t with the smallest distance among those that match each keypoint of frame t + 1.
    fn winners(pair: &Pair, outcomes: &[Option<Outcome>]) -> Vec<Option<usize>> {
        let mut winners: Vec<Option<(usize, f32)>> = vec![None; pair.sides[1].points.len()];
        for (index, outcome) in outcomes.iter().enumerate() {
            let Some(Outcome { index: to, distance, status: MatchStatus::Match, .. }) = outcome else { continue };
            if winners[*to].is_none_or(|(_, least)| *distance < least) {
                winners[*to] = Some((index, *distance));
            }
        }
        winners.into_iter().map(|winner| winner.map(|(index, _)| index)).collect()
    }

    fn work(
        &self,
        clip: &Clip,
        state: &mut State,
        threads: &Threads,
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        let pair = self.pair(clip, state, threads)?;
        observer.see(|| Event::Detected(Arc::clone(&pair)));
        let outcomes = self.compared(clip, &pair, threads)?;
        let winners = Self::winners(&pair, &outcomes);
        let mut next: Vec<Option<u32>> = vec![None; pair.sides[1].points.len()];
        let mut tracked = 0;
        for (index, outcome) in outcomes.into_iter().enumerate() {
            let track = state.live.get(index).copied().flatten();
            let accepted = outcome.filter(|outcome| outcome.status == MatchStatus::Match);
            let to = accepted.map(|outcome| outcome.index).filter(|to| winners[*to] == Some(index));
            let linked = Linked { index, outcome, track, to };
            observer.see(|| Event::Linked(Arc::clone(&pair), linked));
            tracked += u32::from(to.is_some());
            if let Some(number) = Self::note(state, &pair, &linked) {
                to.into_iter().for_each(|to| next[to] = Some(number));
            }
        }
        observer.see(|| Event::Ended(Arc::clone(&pair)));
        Arc::make_mut(&mut state.counts).push(tracked);
        state.live = Arc::new(next);
        state.side = Some(Arc::clone(&pair.sides[1]));
        state.frame += 1;
        Ok(if state.span.is_over(clip, state.frame + 1) { Progress::Done } else { Progress::More })
    }

    /// Stores the outcome for a keypoint; returns its track, if it has one.
    fn note(state: &mut State, pair: &Pair, linked: &Linked) -> Option<u32> {
        let at = pair.sides[0].points[linked.index].at;
        let number = match (linked.track, linked.to) {
            (Some(number), _) => number,
            (None, None) => return None,
            (None, Some(_)) => {
                state.tracks.push(Arc::new(Track::begin(state.frame, at)));
                state.tracks.len() as u32 - 1
            }
        };
        let to = linked.to.map(|to| pair.sides[1].points[to].at);
        let displacement = to.map(|to| [to[0] - at[0], to[1] - at[1]]);
        let status = if to.is_some() { Status::Tracked } else { Status::Unmatched };
        let outcome = Feature { at, displacement, status, residual: None };
        Arc::make_mut(&mut state.tracks[number as usize]).record(outcome, to);
        Some(number)
    }
}

pseudocode! {
    EACH_PAIR: "for each pair of frames t, t+1",
    DETECT: "  detect and describe the keypoints of frame t+1; those of frame t are known",
    EACH_KEYPOINT: "  for each keypoint a of frame t: b ← its nearest neighbour that passes ratio test and cross-check",
    CONTINUE: "    if a is in a track and there is b: the track continues to b",
    BEGIN: "    if a is in no track and there is b: a new track begins with a, b",
    LOSE: "    if a is in a track and there is no b: the track is lost",
    REMAIN: "    else a remains alone",
    END_PAIR: "  the ends of the tracks in frame t+1 are those of the next pair",
}

variables! {
    /// The most frames of a track.
    FRAMES: "", "", Unit::count("");
    /// The first frame of the pair.
    FRAME: "Frame t", "t", Unit::WHOLE;
    /// The second frame of the pair.
    NEXT_FRAME: "Frame t+1", "t + 1", Unit::WHOLE;
    /// The detector of the keypoints.
    DETECTOR: "", "", Unit::WHOLE;
    /// The keypoints of the first frame.
    KEYPOINTS: "Keypoints", "", Unit::count("keypoint"), Role::Reference;
    /// The keypoints of the second frame.
    KEYPOINTS_THERE: "", "", Unit::count(""), Role::Candidate;
    /// The search radius.
    RADIUS: "", "", Unit::new("px", 0);
    /// The keypoint of the second frame that matches.
    MATCH: "", "", Unit::PX, Role::Result;
    /// The distance of the descriptors.
    DISTANCE: "Distance", "d", Unit::RATIO;
    /// The ratio of the distances of the nearest and the second nearest neighbour.
    RATIO: "Ratio", "", Unit::FINE;
    /// The displacement of the keypoint to the second frame.
    DISPLACEMENT: "Displacement", "(u, v)", Unit::SUBPIXEL, Role::Result;
    /// The true displacement of the keypoint.
    TRUE_DISPLACEMENT: "True displacement", "", Unit::SUBPIXEL, Role::Truth;
    /// The number of the track, from 1.
    TRACK: "", "", Unit::count("");
    /// The length of the track.
    LENGTH: "", "", Unit::count("frame");
    /// The tracks that the pair continues.
    CONTINUED: "Tracks continued", "", Unit::count(""), Role::Result;
    /// The tracks that the pair begins.
    BEGUN: "Tracks begun", "", Unit::count(""), Role::Best;
    /// The tracks that the pair loses.
    LOST: "Tracks lost", "", Unit::count(""), Role::Rejected;
    /// The number of tracks.
    TRACKS: "", "", Unit::count("track");
    /// The mean endpoint error of the matches of the pair.
    MEAN_ERROR: "", "", Unit::SUBPIXEL, Role::Error;
    /// The mean length of all tracks.
    MEAN_LENGTH: "", "", Unit::new("frames", 1);
}

cases! { over value, features;
    OPENING: "Keypoints are detected in every frame and matched with those of the next one by their descriptors. Consecutive \
              matches form a track, through at most {frames} frames. Unlike in KLT, the motion may be large, but a keypoint \
              must be detected again.",
    DETECTED: "{detector}: {keypoints} in frame {frame} and {keypoints_there} in frame {next_frame}. The candidates of a \
               keypoint are those in the whole frame.",
    DETECTED_NEAR: "{detector}: {keypoints} in frame {frame} and {keypoints_there} in frame {next_frame}. The candidates of a \
                    keypoint are those within {radius} of its position.",
    MATCHED: "{reference|Keypoint} {position:bare} matches {match:bare}, distance {distance}.",
    CONTINUES: "Track {track} continues: {length} so far.",
    BEGINS: "It is in no track, so a new one begins.",
    UNMATCHED: "{reference|Keypoint} {position:bare} {rejected|has no match}",
    NO_CANDIDATE: "(no candidate).",
    FAILS_RATIO: "(ratio test).",
    FAILS_CROSS_CHECK: "(cross-check).",
    IS_FARTHER: "(another keypoint is nearer to its neighbour).",
    IS_LOST: "Track {track} is lost after {length}.",
    REMAINS: "It is in no track and begins none.",
    PAIR_ENDED: "End of the pair of frames {frame} and {next_frame}: {continued} of {tracks} continued, {lost} lost without \
                 an accepted match, {begun} begun.",
    ERROR: "Mean endpoint error of this pair: {mean_error}.",
    END: "End of the run: {tracks} of {mean_length} on average. A track ends where its keypoint is not detected again or its \
          match is rejected: a lower threshold of the detector or a higher ratio limit makes tracks longer.",
}

impl Estimator for FeatureTracker {
    const INFO: Info = Info {
        id: "feature-tracker",
        name: "Feature tracking by matching",
        family: "Correspondence",
        summary: "Matches the keypoints of consecutive frames by their descriptors, and links the matches to tracks through the clip.",
        source: "D. G. Lowe, Distinctive image features from scale-invariant keypoints, International Journal of Computer Vision 60(2), 2004; \
                 H. Bay, A. Ess, T. Tuytelaars and L. Van Gool, Speeded-up robust features, CVIU 110(3), 2008",
        pseudocode: line::ALL,
        granularities: &["clip", "pair", "keypoint"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "continued",
        "What becomes of the next keypoint?",
        &[
            Reply::at(line::CONTINUE, "Its track continues"),
            Reply::at(line::BEGIN, "A new track begins"),
            Reply::at(line::LOSE, "Its track is lost"),
            Reply::at(line::REMAIN, "It is in no track and begins none"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::Better;
    const CHARTS: &'static [Chart] = &[Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[TrackField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State {
            span: Span::new(clip, frame, self.frames)?,
            frame,
            tracks: Vec::new(),
            live: Arc::default(),
            counts: Arc::default(),
            picture: clip.size(),
            side: None,
            side_bytes: 0,
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        self.work(clip, state, &Threads::single(), observer)
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.span.pairs()
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.span.place_of_pair(state.frame)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.frame)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Linked(_, Linked { track: Some(_), to: None, .. }) => Some(Role::Rejected),
            _ => None,
        }
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let (first, last) = (state.span.first, state.frame);
        Output::of(TrackField { picture: state.picture, first, last, tracks: state.tracks.clone() })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        run_counted(self, (clip, frame), tally, |state, counter| self.work(clip, state, threads, counter))
    }
}

impl Footprint<State> for FeatureTracker {
    fn need(&self, clip: &Clip) -> Need {
        self.matching.need(clip).and([1e6, 4e6])
    }

    fn at_rest(&self, state: &State) -> State {
        State { side: None, ..state.clone() }
    }

    fn state_bytes(&self, state: &State) -> usize {
        let tracks: usize = state.tracks.iter().map(|track| track.bytes()).sum();
        size_of::<State>() + tracks + size_of_val(&state.live[..]) + size_of_val(&state.counts[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + 2 * state.side_bytes
    }
}
