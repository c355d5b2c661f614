//! Trajectory clustering: long-term trajectories of points grouped by their affinity, by spectral clustering.
//!
//! ```text
//!   trajectories A, B        w(A, B) = exp(−λ d²)        N = D^(−1/2) W D^(−1/2)
//!     ╱  ╱   ╲                d² = max over t of          first eigenvectors:
//!    ╱  ╱     ╲                    d_sp |ΔA − ΔB|²/(5σ²)   coordinates of each trajectory
//! ```

mod explain;

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::segmentation::explain::value::SEGMENTS;
use crate::methods::segmentation::kmeans::Clustering;
use crate::methods::segmentation::spectral::{Spectrum, normalized};
use crate::methods::segmentation::{Points, Record};
use crate::products::{Output, Product, ProductKind, SegmentField, SegmentFrame, Track, TrackField};
use crate::run::{
    Estimator, Explained, FeatureTracks, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Stage,
    run_counted,
};
use crate::scene::{Chart, Focus, Name, Question, Role, Scene, Step};
use crate::{choices, params, pseudocode};

choices! {
    /// The choice of the number of segments.
    pub enum Choice {
        /// The number that is set.
        Given = "given" "Given",
        /// The number before the largest gap of the eigenvalues.
        Gap = "gap" "Largest gap",
    }
}

params! {
    /// Segments of long-term point trajectories.
    pub struct TrajectoryClustering {
        /// Method that makes the trajectories.
        tracks: Stage<FeatureTracks> = Stage::named("point-trajectories").with("method", "tv-l1").with("spacing", "8");
        /// Number of frames of the trajectories, including the first.
        frames: usize = 8, 3..=200;
        /// Number of segments; with the largest gap it is not used.
        clusters: usize = 3, 1..=6;
        /// Choice of the number of segments.
        selection: Choice = Choice::Given;
        /// Difference of two motions that counts as noise.
        sigma: f32 = 0.3, 0.01..=20.0, "px/frame";
        /// Factor λ of the affinity: larger values separate more.
        lambda: f32 = 0.1, 0.001..=10.0;
        /// Largest number of trajectories that are compared with each other; of more, the others join the segment of the most alike.
        max_tracks: usize = 400, 20..=1000;
        /// Random seed of the start vectors and of k-means++.
        seed: usize = 1, 0..=9999;
    }
    advanced { "lambda", "max-tracks", "seed" }
    when {
        "clusters": |p| p.selection == Choice::Given, "The number has no effect on the largest gap, where it follows from the eigenvalues.";
    }
}

/// Frames over which the motion of a trajectory is compared.
const INTERVAL: usize = 5;
/// Eigenvalue above which its vector may separate a group from the others.
const LEAST_EIGENVALUE: f64 = 0.3;
/// Number of computed eigenvalues: two more than there can be segments, for the gap after the last and because the last
/// converges most slowly.
const EIGENVALUES: usize = 8;

/// The trajectories that are compared.
pub struct Compared {
    tracks: Vec<Arc<Track>>,
    /// The others of at least three frames, which join the most similar ones.
    others: Vec<Arc<Track>>,
    /// The index of the nearest trajectory of each pixel in the first frame, once a step shows it; `u32::MAX` without any.
    nearest: OnceLock<Grid<u32>>,
}

impl Compared {
    /// All trajectories, first those that are compared.
    fn all(&self) -> impl Iterator<Item = &Arc<Track>> {
        self.tracks.iter().chain(&self.others)
    }

    /// The index of the nearest trajectory of each pixel of the first frame.
    fn nearest_at_start(&self, picture: (usize, usize), first: usize) -> &Grid<u32> {
        self.nearest.get_or_init(|| {
            let there: Vec<_> = self.tracks.iter().map(|track| track.at(first).map(|point| point.at)).collect();
            nearest(&there, picture, &Threads::single())
        })
    }
}

/// The index of the nearest of these points to each pixel; `u32::MAX` if there is none.
fn nearest(points: &[Option<[f32; 2]>], (width, height): (usize, usize), threads: &Threads) -> Grid<u32> {
    let there: Vec<_> = (0u32..).zip(points).filter_map(|(index, at)| Some((index, (*at)?))).collect();
    let mut found = Grid::new(width, height, u32::MAX);
    threads.rows(&mut found, |y, row| {
        for (x, cell) in row.iter_mut().enumerate() {
            let squared = |at: [f32; 2]| (at[0] - x as f32).powi(2) + (at[1] - y as f32).powi(2);
            let all = there.iter().map(|(index, at)| (squared(*at), *index));
            *cell = all.reduce(|a, b| if b.0 < a.0 { b } else { a }).map_or(u32::MAX, |(_, index)| index);
        }
    });
    found
}

/// A part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Tracks,
    Affinities,
    Spectrum,
    Clusters,
    Labels,
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    part: Part,
    record: Record,
    compared: Option<Arc<Compared>>,
    affinities: Option<Arc<Grid<f32>>>,
    spectrum: Option<Arc<Spectrum>>,
    /// The segment of each trajectory, from 1 on.
    labels: Option<Arc<Vec<u32>>>,
    done: usize,
}

/// An event of a unit.
#[derive(Clone)]
pub enum Event {
    /// The trajectories are there.
    Tracked(Arc<Compared>),
    /// The affinities of a trajectory to all others are known.
    Compared(u32, Arc<Vec<f32>>),
    /// An iteration of the eigenvectors.
    Iterated(Arc<Spectrum>),
    /// The trajectories are clustered.
    Clustered(Arc<Vec<u32>>, usize),
    /// The pixels of a frame have the labels of their nearest trajectories.
    Labelled(Arc<SegmentFrame>),
}

impl TrajectoryClustering {
    fn track(&self, clip: &Clip, first: usize, threads: &Threads) -> Result<Compared, Error> {
        let field: TrackField = self.tracks.tracks(clip, (first, self.frames), threads)?;
        let long: Vec<_> = field.tracks.iter().filter(|track| track.points.len() >= 3).cloned().collect();
        let (all, kept) = (long.len(), long.len().min(self.max_tracks));
        // The first of each of as many equal parts of their order.
        let part = |i: usize| i * kept / all.max(1);
        let is_compared = |(i, _): &(usize, Arc<Track>)| *i == 0 || part(*i) != part(*i - 1);
        let (tracks, others): (Vec<_>, Vec<_>) = long.into_iter().enumerate().partition(is_compared);
        let bare = |tracks: Vec<(usize, Arc<Track>)>| tracks.into_iter().map(|(_, track)| track).collect();
        Ok(Compared { tracks: bare(tracks), others: bare(others), nearest: OnceLock::new() })
    }

    /// The affinity of two trajectories (T. Brox and J. Malik 2010, equations 1 to 3, with one σ for all).
    fn affinity(&self, a: &Track, b: &Track) -> f32 {
        let from = a.first.max(b.first);
        let until = (a.first + a.points.len()).min(b.first + b.points.len());
        if until < from + 2 {
            return 0.0;
        }
        let interval = INTERVAL.min(until - from - 1);
        let at = |track: &Track, t: usize| track.points[t - track.first].at.map(f64::from);
        let frames = (until - from) as f64;
        let apart = |t: usize| {
            let (p, q) = (at(a, t), at(b, t));
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let spatial = (from..until).map(apart).sum::<f64>() / frames;
        let difference = |t: usize| -> f64 {
            let motion = |track: &Track| {
                let (p, q) = (at(track, t), at(track, t + interval));
                [0, 1].map(|i| (q[i] - p[i]) / interval as f64)
            };
            let (p, q) = (motion(a), motion(b));
            (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)
        };
        let largest = (from..until - interval).map(difference).fold(0.0, f64::max);
        let squared = spatial * largest / (5.0 * f64::from(self.sigma).powi(2));
        (-f64::from(self.lambda) * squared).exp() as f32
    }

    fn compare(
        &self,
        clip: &Clip,
        compared: &Compared,
        observer: &mut impl Observer<Event>,
    ) -> Result<Grid<f32>, Error> {
        let count = compared.tracks.len();
        let mut all = Grid::new(count, count, 0.0);
        for y in 0..count {
            clip.wanted()?;
            for x in 0..count {
                all[(x, y)] = if x < y { all[(y, x)] } else { self.affinity(&compared.tracks[y], &compared.tracks[x]) };
            }
            observer.see(|| Event::Compared(y as u32, Arc::new(all.row(y).to_vec())));
        }
        Ok(all)
    }

    /// The segment of each trajectory, compared ones first, and the number of segments sought.
    fn cluster(&self, compared: &Compared, spectrum: &Spectrum) -> (Vec<u32>, usize) {
        let count = match self.selection {
            // An eigenvalue far below 1 belongs to no group of its own.
            Choice::Given => {
                self.clusters.min(spectrum.values.iter().filter(|value| **value > LEAST_EIGENVALUE).count()).max(1)
            }
            Choice::Gap => spectrum.groups_by_gap(),
        };
        let points = Points::new(spectrum.embedding(count));
        let found = Clustering::of(&points, count, self.seed);
        let mut labels: Vec<u32> = found.nearest.iter().map(|index| u32::from(*index) + 1).collect();
        let most_alike = |other: &Arc<Track>| {
            let all = compared.tracks.iter().zip(&labels).map(|(track, label)| (self.affinity(other, track), *label));
            all.reduce(|best, next| if next.0 > best.0 { next } else { best }).map_or(0, |(_, label)| label)
        };
        let others: Vec<u32> = compared.others.iter().map(most_alike).collect();
        labels.extend(others);
        (labels, count)
    }

    /// The labels of the pixels of frame `t`, and the motion of their nearest trajectories.
    fn label(
        compared: &Compared,
        labels: &[u32],
        (picture, t): ((usize, usize), usize),
        threads: &Threads,
    ) -> (Grid<u32>, Flow) {
        let there: Vec<_> = compared.all().map(|track| track.at(t)).collect();
        let places: Vec<_> = there.iter().map(|point| point.map(|point| point.at)).collect();
        let nearest = nearest(&places, picture, threads);
        let label = nearest.map(|index| labels.get(*index as usize).copied().unwrap_or(0));
        let displacement = |index: &u32| there.get(*index as usize).copied().flatten()?.displacement;
        (label, Flow(nearest.map(|index| displacement(index).unwrap_or(Flow::UNKNOWN))))
    }

    fn work(
        &self,
        (clip, threads): (&Clip, &Threads),
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        match (state.part, &state.compared, &state.affinities, &state.spectrum) {
            (Part::Tracks, ..) => {
                let compared = Arc::new(self.track(clip, state.record.frame(), threads)?);
                observer.see(|| Event::Tracked(Arc::clone(&compared)));
                state.compared = Some(compared);
                state.part = Part::Affinities;
            }
            (Part::Affinities, Some(compared), ..) => {
                if compared.tracks.is_empty() {
                    observer.see(|| Event::Clustered(Arc::default(), 0));
                    return Ok(Progress::Done);
                }
                let all = self.compare(clip, compared, observer)?;
                state.spectrum = Some(Arc::new(Spectrum::begin(compared.tracks.len(), EIGENVALUES, self.seed as u64)));
                state.affinities = Some(Arc::new(all));
                state.part = Part::Spectrum;
            }
            (Part::Spectrum, _, Some(affinities), Some(spectrum)) => {
                let (matrix, mut spectrum) = (normalized(affinities), Spectrum::clone(spectrum));
                while !spectrum.is_over() {
                    clip.wanted()?;
                    spectrum.iterate(&matrix);
                    observer.see(|| Event::Iterated(Arc::new(spectrum.clone())));
                }
                state.spectrum = Some(Arc::new(spectrum));
                state.part = Part::Clusters;
            }
            (Part::Clusters, Some(compared), _, Some(spectrum)) => {
                let (labels, count) = self.cluster(compared, spectrum);
                let labels = Arc::new(labels);
                observer.see(|| Event::Clustered(Arc::clone(&labels), count));
                state.labels = Some(labels);
                state.part = Part::Labels;
            }
            _ => {
                let (Some(compared), Some(labels)) = (&state.compared, &state.labels) else {
                    return Ok(Progress::Done);
                };
                state.record.check(clip)?;
                let at = (state.record.picture(), state.record.frame());
                let (found, flow) = Self::label(compared, labels, at, threads);
                let frame = state.record.add_as_labelled(found, flow);
                observer.see(|| Event::Labelled(frame));
                state.done += 1;
                return Ok(state.record.progress(clip));
            }
        }
        state.done += 1;
        Ok(Progress::More)
    }
}

pseudocode! {
    TRACK: "follow points through the frames: trajectories A, B, …",
    COMPARE: "w(A, B) ← exp(−λ d²), d² = max over t of d_sp(A, B) · |ΔA − ΔB|² / (5 σ²), ΔA = motion of A in px/frame",
    ITERATE: "N ← D^(−1/2) W D^(−1/2); its first eigenvectors by subspace iteration",
    CLUSTER: "each trajectory ← its entries in the first k eigenvectors, scaled to length 1; cluster them by k-means",
    LABEL: "each pixel of each frame but the last ← segment of its nearest trajectory",
}

impl Estimator for TrajectoryClustering {
    const INFO: Info = Info {
        id: "trajectory-clustering",
        name: "Trajectory clustering",
        family: "Motion segmentation",
        summary: "Groups trajectories of points over many frames by the largest difference of their motions, by spectral clustering.",
        source: "T. Brox and J. Malik, Object segmentation by long term analysis of point trajectories, ECCV 2010; spectral clustering: A. Ng, \
                 M. Jordan and Y. Weiss, NIPS 2001",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::value(
            "alike",
            "How many trajectories have an affinity of at least 0.5 with the next one?",
            line::COMPARE,
            explain::value::ALIKE,
        ),
        Question::value("segments", "How many segments will there be?", line::CLUSTER, SEGMENTS)
            .unless_told(&[explain::case::FOUND_FEWER]),
    ];
    const GUARANTEE: Guarantee = Guarantee::Trajectories;
    const CHARTS: &'static [Chart] = &[Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[SegmentField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let record = Record::new(clip, frame, self.frames)?;
        Ok(State {
            part: Part::Tracks,
            record,
            compared: None,
            affinities: None,
            spectrum: None,
            labels: None,
            done: 0,
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        self.work((clip, &Threads::single()), state, observer)
    }

    fn units(&self, _: &State) -> Option<usize> {
        None
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.done, of: None }]
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.record.frame())
    }

    fn stage(&self, event: &Event) -> Option<Name> {
        Some(match event {
            Event::Tracked(_) => line::TRACK,
            Event::Compared(..) => line::COMPARE,
            Event::Iterated(_) => line::ITERATE,
            Event::Clustered(..) => line::CLUSTER,
            Event::Labelled(_) => line::LABEL,
        })
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        matches!(event, Event::Clustered(..)).then_some(Role::Result)
    }

    fn pointed(&self) -> Option<&dyn Pointed<State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        state.record.output()
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        run_counted(self, (clip, frame), tally, |state, counter| self.work((clip, threads), state, counter))
    }
}

impl Footprint<State> for TrajectoryClustering {
    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.tracks.need(clip);
        let matrices = 20.0 * (self.max_tracks * self.max_tracks) as f64;
        Need::per_pixel(clip, [40.0, 80.0]).and([run as f64 + matrices, run as f64 + 2.0 * matrices])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + 8 * state.record.frames.len()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let tracks = state.compared.iter().flat_map(|compared| compared.all()).map(|track| track.bytes());
        let affinities = state.affinities.as_ref().map_or(0, |all| size_of_val(all.cells()));
        self.state_bytes(state) + state.record.bytes() + affinities + tracks.sum::<usize>()
    }
}

impl Pointed<State> for TrajectoryClustering {
    fn explained(&self, state: &State, Focus { at: [x, y], .. }: Focus) -> Option<Explained> {
        let (width, height) = state.record.picture();
        let is_inside = |c: f32, extent: usize| (0.0..extent as f32).contains(&(c + 0.5));
        (is_inside(x, width) && is_inside(y, height)).then_some(Explained::Always)
    }
}
