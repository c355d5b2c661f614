//! Multiple hypothesis tracking: every plausible explanation of the detections is kept as a hypothesis with a probability, and later
//! frames decide between them.
//!
//! D. B. Reid, An algorithm for tracking multiple targets, 1979, with the k best hypotheses of each scan by Murty's algorithm and
//! N-scan pruning (I. J. Cox and S. L. Hingorani, 1996).

mod charts;
mod expand;
mod explain;
mod forest;
mod tree;
mod vocabulary;

use std::sync::Arc;

use super::is_far_outside;
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::methods::multi_object::{
    self,
    chances::Chances,
    dynamics::Dynamics,
    lifecycle::Rules,
    tracker_run::{self, Conclusion},
    tracking::{MultiTracker, MultiTracking},
    vocabulary::{case as shared_case, value as shared},
};
use crate::products::{Object, ObjectFrame};
use crate::run::{Info, Need, Progress, Seen};
use crate::scene::{Chart, Question, Reply, Role, Scene, Step};
use crate::{params, pseudocode};
use expand::{Expansion, Gates};
use forest::{Cluster, Hypothesis, Scan, Track};
use tree::Tree;
use vocabulary::case;

/// The noise of boxes of person detectors, which deviate from the true ones by 0.04 heights (standard deviation):
/// hypotheses are weighed by their densities, whereas a gate only has to be wide enough.
const MEASUREMENT_NOISE: f32 = 0.05;
const PROCESS_NOISE: f32 = 0.004;

params! {
    /// Multi-object tracking with several hypotheses about the origins of the detections.
    pub struct MultipleHypothesis {
        /// The frames of the run and the source of the detections.
        settings: tracker_run::Settings = tracker_run::Settings::default();
        /// The filters of the tracks.
        dynamics: Dynamics = Dynamics { process_noise: PROCESS_NOISE, measurement_noise: MEASUREMENT_NOISE, ..Dynamics::default() };
        /// The probabilities of detections.
        chances: Chances = Chances::default();
        /// Expected number of new tracks per frame, anywhere in the picture. Over the area of the picture it is the density β_NT.
        new_tracks: f32 = 0.1, 0.001..=1000.0;
        /// Maximum number k of hypotheses of a cluster of tracks. With 1, each frame is decided at once, and tracks only start if more new
        /// tracks are expected than false alarms.
        max_hypotheses: usize = 30, 1..=300;
        /// Minimum probability of a hypothesis relative to the leading one. With 0 only their maximum number bounds them.
        min_ratio: f32 = 0.001, 0.0..=1.0;
        /// Number N of frames after which the leading hypothesis decides a frame (N-scan pruning). With 0, each frame is
        /// decided at once, and tracks only start if more new tracks are expected than false alarms.
        n_scan: usize = 4, 0..=20;
        /// Track management.
        rules: Rules = Rules::default();
    }
    when {
        "min-ratio": |p| p.max_hypotheses > 1, "The minimum ratio has no effect with a single hypothesis.";
        "n-scan": |p| p.max_hypotheses > 1, "N-scan pruning has no effect with a single hypothesis.";
    }
}

type State = multi_object::tracking::State<Vec<Cluster>>;

/// The leading global hypothesis, and the one that is second.
#[derive(Clone, Debug)]
pub struct Leading {
    /// The product of the probabilities of the leading hypotheses of all clusters.
    probability: f64,
    /// The number of clusters, and of their hypotheses in all.
    clusters: usize,
    hypotheses: usize,
    /// The scans of the frame in the leading hypotheses.
    scans: Vec<Arc<Scan>>,
    second: Option<Second>,
    /// The hypotheses of the largest cluster; none if each has a single one.
    tree: Option<Tree>,
}

/// The second global hypothesis: it differs from the leading one in a single cluster.
#[derive(Clone, Debug)]
pub struct Second {
    probability: f64,
    /// The last frame that it explains differently, with the scans of the leading hypothesis and of this one.
    frame: usize,
    scans: [Arc<Scan>; 2],
}

/// A detection that another track has now than before, in an earlier frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revision {
    frame: usize,
    detection: usize,
    /// The track before and now; `None` for a false alarm.
    before: Option<u32>,
    now: Option<u32>,
}

/// The hypotheses deleted by a decision.
#[derive(Clone, Debug, Default)]
pub struct Pruning {
    frame: usize,
    clusters: usize,
    removed: usize,
    /// The sum of their probabilities.
    probability: f64,
    /// The hypotheses of the largest cluster with those deleted; none if each cluster has a single one.
    tree: Option<Tree>,
}

/// An event of a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// The detections, and the number discarded by the minimum score.
    Detected(Arc<Vec<Detection>>, usize),
    /// The predicted tracks of all hypotheses.
    Predicted(Arc<Vec<Arc<Track>>>),
    /// The gates and the clusters.
    Gated(Arc<Gates>),
    /// The branches of a cluster.
    Expanded(Arc<Gates>, Arc<Expansion>),
    /// The leading hypothesis decides an earlier frame.
    Pruned(Arc<Pruning>),
    /// The leading and the second hypothesis.
    Led(Arc<Leading>),
    /// The leading hypothesis explains earlier frames differently from the previous leader.
    Revised(Arc<Vec<Revision>>),
    /// The finished frame and its conclusion.
    Done(Arc<ObjectFrame>, Box<Conclusion>),
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    DETECT: "  detect objects",
    PREDICT: "  predict the tracks of all hypotheses: x ← F x, P ← F P F^T + Q",
    GATE: "  gate by d²; merge the clusters of tracks that share detections",
    EACH_CLUSTER: "  for each cluster",
    EXPAND: "    k best branches (Murty): each detection from a track, a new track, or a false alarm",
    PRUNE: "  N-scan pruning: decide frame t − N as the leading hypothesis",
    LEAD: "  tracks of the leading hypothesis of each cluster",
    REVISE: "  rewrite the frames since t − N where they have changed",
}

impl MultiTracker for MultipleHypothesis {
    const INFO: Info = Info {
        id: "multiple-hypothesis",
        name: "Multiple hypothesis tracking",
        family: "Tracking",
        summary: "Tracks many objects: keeps the most probable explanations of ambiguous detections and decides between them some frames later.",
        source: "D. B. Reid, An algorithm for tracking multiple targets, IEEE Transactions on Automatic Control 1979; k best \
                 hypotheses and N-scan pruning: I. J. Cox and S. L. Hingorani, An efficient implementation of Reid's multiple hypothesis \
                 tracking algorithm, PAMI 1996; ranked assignments: K. G. Murty 1968, M. L. Miller, H. S. Stone and I. J. Cox 1997",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "pruned",
            "Does N-scan pruning delete hypotheses?",
            &[
                Reply::told(line::PRUNE, case::ALIKE, "No: all explain that frame alike"),
                Reply::told(line::PRUNE, case::PRUNED, "Yes"),
            ],
        ),
        Question::value(
            "gated",
            "How many pairs of a track and a detection does gating leave?",
            line::GATE,
            shared::GATED,
        )
        .unless_told(&[shared_case::NONE_TO_GATE]),
    ];
    const CHARTS: &'static [Chart] = &[Chart::Diagram, Chart::Matrices, Chart::Series];
    type Tracks = Vec<Cluster>;
    type Event = Event;

    fn settings(&self) -> &tracker_run::Settings {
        &self.settings
    }

    fn rules(&self) -> Rules {
        self.rules
    }

    fn is_deferred(&self) -> bool {
        self.n_scan > 0 && self.max_hypotheses > 1
    }

    fn track(
        &self,
        clip: &Clip,
        state: &mut State,
        (detections, discarded): (Vec<Detection>, usize),
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        let detections = Arc::new(detections);
        observer.see(|| Event::Detected(Arc::clone(&detections), discarded));
        let mut clusters = std::mem::take(&mut state.tracks);
        clusters.iter_mut().for_each(|cluster| self.predict(cluster));
        observer.see(|| Event::Predicted(Arc::new(tracks_of(&clusters))));
        self.expand(clip, state, (clusters, &detections), observer)?;
        self.prune(state, observer);
        let frame = state.run.frame();
        observer.see(|| Event::Led(Arc::new(leading(&state.tracks, frame))));
        Ok(self.finish(clip, state, &detections, observer))
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        matches!(event, Event::Revised(_)).then_some(Role::Reference)
    }

    fn need(&self, clip: &Clip) -> Need {
        // On average each cluster keeps a few hypotheses, and their tracks in each undecided frame.
        let frames = (self.n_scan + 1) as f64 * self.max_hypotheses.min(30) as f64;
        super::need(clip).and([super::most_objects(clip) * 200.0 * frames, super::most_objects(clip) * 800.0 * frames])
    }

    fn tracks_bytes(&self, tracks: &Vec<Cluster>) -> usize {
        tracks.iter().map(Cluster::bytes).sum()
    }

    fn step(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }
}

fn tracks_of(clusters: &[Cluster]) -> Vec<Arc<Track>> {
    clusters.iter().flat_map(|cluster| cluster.tracks.iter().cloned()).collect()
}

/// Returns the scans of a frame in the leading hypotheses.
fn scans_of(clusters: &[Cluster], frame: usize) -> impl Iterator<Item = &Arc<Scan>> {
    clusters.iter().filter_map(move |cluster| cluster.hypotheses.first()?.scan(frame))
}

/// Returns the leading global hypothesis and the second one, in which a single cluster has its second hypothesis.
fn leading(clusters: &[Cluster], frame: usize) -> Leading {
    let ratio = |cluster: &Cluster| {
        let [first, second] = [cluster.hypotheses.first()?, cluster.hypotheses.get(1)?];
        Some(second.ln_probability - first.ln_probability)
    };
    let ln_probability: f64 = clusters.iter().filter_map(|of| Some(of.hypotheses.first()?.ln_probability)).sum();
    let closest = clusters.iter().filter_map(|cluster| Some((ratio(cluster)?, cluster)));
    let second = closest.reduce(|a, b| if b.0 > a.0 { b } else { a });
    Leading {
        probability: ln_probability.exp(),
        clusters: clusters.len(),
        hypotheses: clusters.iter().map(|cluster| cluster.hypotheses.len()).sum(),
        scans: scans_of(clusters, frame).cloned().collect(),
        second: second.and_then(|(ratio, cluster)| second_of(cluster, (ln_probability + ratio).exp())),
        tree: Tree::largest(clusters, &[]),
    }
}

/// Returns the hypotheses that the decision of a frame has deleted from each cluster.
fn pruning(frame: usize, clusters: &[Cluster], deleted: &[Vec<Hypothesis>]) -> Pruning {
    let all = || deleted.iter().flatten();
    Pruning {
        frame,
        clusters: deleted.iter().filter(|of_cluster| !of_cluster.is_empty()).count(),
        removed: all().count(),
        probability: all().map(Hypothesis::probability).sum(),
        tree: Tree::largest(clusters, deleted),
    }
}

/// Returns where the second hypothesis of a cluster differs from the leading one last.
fn second_of(cluster: &Cluster, probability: f64) -> Option<Second> {
    let [first, second] = [cluster.hypotheses.first()?, cluster.hypotheses.get(1)?];
    let both = |scan: &Arc<Scan>| Some((Arc::clone(scan), Arc::clone(second.scan(scan.frame)?)));
    let differs = |(a, b): &(Arc<Scan>, Arc<Scan>)| a.claims != b.claims;
    let (one, other) = first.past.iter().rev().filter_map(both).find(differs)?;
    Some(Second { probability, frame: one.frame, scans: [one, other] })
}

impl MultipleHypothesis {
    fn predict(&self, cluster: &mut Cluster) {
        for track in &mut cluster.tracks {
            let filter = self.dynamics.predicted(&track.filter, &track.extent);
            *track = Arc::new(Track { filter, detection: None, ..Track::clone(track) });
        }
    }

    /// Returns a track after a missed frame; `None` if it is deleted.
    fn missed(&self, track: &Track, picture: (usize, usize)) -> Option<Track> {
        let age = self.rules.missed(track.age).filter(|_| !is_far_outside(track.filter.place(), picture))?;
        Some(Track { detection: None, before: track.age, age, ..track.clone() })
    }

    /// Branches the hypotheses of all clusters by the detections.
    fn expand(
        &self,
        clip: &Clip,
        state: &mut State,
        (clusters, detections): (Vec<Cluster>, &Arc<Vec<Detection>>),
        observer: &mut impl Observer<Event>,
    ) -> Result<(), Error> {
        let mut gates = self.gates(clip, state.run.frame(), (&clusters, Arc::clone(detections)))?;
        let groups = self.grouped(clusters, &mut gates);
        let gates = Arc::new(gates);
        observer.see(|| Event::Gated(Arc::clone(&gates)));
        let rankings = self.rankings(clip, &groups, &gates)?;
        for (group, ranking) in groups.iter().zip(&rankings) {
            let after = self.branched(group, &gates, ranking, || state.run.next_id());
            if !group.detections.is_empty() {
                observer.see(|| {
                    let expansion = self.expansion(group, &gates, ranking, &after);
                    Event::Expanded(Arc::clone(&gates), Arc::new(expansion))
                });
            }
            state.tracks.push(after);
        }
        Ok(())
    }

    /// Unites hypotheses with the same tracks, decides the frame N before this one, and splits clusters.
    fn prune(&self, state: &mut State, observer: &mut impl Observer<Event>) {
        let frame = state.run.frame();
        let last = frame.checked_sub(self.n_scan).filter(|last| *last >= state.run.span.first);
        if let Some(last) = last {
            let deleted: Vec<_> = state.tracks.iter_mut().map(|cluster| cluster.decide(last)).collect();
            observer.see(|| Event::Pruned(Arc::new(pruning(last, &state.tracks, &deleted))));
        }
        for cluster in &mut state.tracks {
            cluster.unite_equal();
            cluster.drop_unused();
        }
    }

    /// Writes the frames that are not decided as the leading hypotheses explain them, with this one.
    fn finish(
        &self,
        clip: &Clip,
        state: &mut State,
        detections: &Arc<Vec<Detection>>,
        observer: &mut impl Observer<Event>,
    ) -> Progress {
        let (first, last) = (state.run.span.first, state.run.frame());
        let mut revised = Vec::new();
        for old in state.run.rewind() {
            let frame = state.run.frame();
            let made = self.written(state, frame, old.detections.clone());
            revised.extend(revisions(frame, &old, &made));
            state.run.again(made);
            if frame + self.n_scan <= last {
                state.run.settle();
            }
        }
        if !revised.is_empty() {
            observer.see(|| Event::Revised(Arc::new(revised)));
        }
        let made = self.written(state, last, Vec::clone(detections));
        observer.see(|| {
            Event::Done(
                Arc::clone(&made),
                Box::new(state.run.conclusion(clip, &made, (self.rules, Some(&self.dynamics)))),
            )
        });
        let progress = state.run.note(clip, self.rules, made);
        if self.n_scan == 0 {
            state.run.settle();
        }
        if let Some(decided) = last.checked_sub(self.n_scan).filter(|decided| *decided >= first) {
            state.tracks.iter_mut().for_each(|cluster| cluster.forget(decided));
        }
        let clusters = std::mem::take(&mut state.tracks).into_iter().flat_map(Cluster::split);
        state.tracks = clusters.filter(|cluster| !cluster.is_over()).collect();
        progress
    }

    /// Returns a frame as the leading hypotheses explain it, and applies hindsight to the frames before.
    fn written(&self, state: &mut State, frame: usize, detections: Vec<Detection>) -> Arc<ObjectFrame> {
        let scans = scans_of(&state.tracks, frame);
        let mut tracks: Vec<Arc<Track>> = scans.flat_map(|scan| scan.tracks.iter().cloned()).collect();
        tracks.sort_unstable_by_key(|track| track.id);
        let objects: Vec<Object> = tracks.iter().map(|track| track.object()).collect();
        for (track, object) in tracks.iter().zip(&objects).filter(|(track, _)| track.detection.is_some()) {
            state.run.look_back(self.rules, object, track.before);
        }
        state.run.finished(self.rules, detections, objects)
    }
}

/// Returns the detections of a frame that other tracks have than before.
fn revisions(frame: usize, before: &ObjectFrame, now: &ObjectFrame) -> Vec<Revision> {
    let of = |frame: &ObjectFrame, detection: usize| {
        frame.objects.iter().find(|object| object.detection == Some(detection)).map(|object| object.id)
    };
    let ids = |frame: &ObjectFrame| -> Vec<(u32, Option<usize>)> {
        frame.objects.iter().map(|object| (object.id, object.detection)).collect()
    };
    if ids(before) == ids(now) {
        return Vec::new();
    }
    let all = (0..now.detections.len()).map(|detection| Revision {
        frame,
        detection,
        before: of(before, detection),
        now: of(now, detection),
    });
    all.filter(|revision| revision.before != revision.now).collect()
}
