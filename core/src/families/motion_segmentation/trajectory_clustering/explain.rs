//! The explanation and the drawing of trajectory clustering.

use std::collections::BTreeSet;

use super::{Choice, Compared, EIGENVALUES, Event, TrajectoryClustering, line};
use crate::methods::segmentation::explain::{conclude, draw_segments, value as shared};
use crate::methods::segmentation::spectral::Spectrum;
use crate::products::Track;
use crate::run::Seen;
use crate::scene::{Canvas, Number, Picture, Readout, Role, Scene, Series, Shape, Step, Unit};
use crate::{cases, variables};

variables! { pub(super) mod value;
    /// The number of trajectories of at least three frames.
    TRAJECTORIES: "Trajectories", "", Unit::count("trajectory"), Role::Reference;
    /// The number of trajectories that are compared with each other.
    COMPARED: "Compared", "", Unit::count("");
    /// The number of the trajectory that is compared with all others.
    TRAJECTORY: "Trajectory", "A", Unit::count(""), Role::Reference;
    /// The number of the trajectory pointed at.
    OTHER: "Trajectory pointed at", "B", Unit::count("");
    /// The number of alike trajectories.
    ALIKE: "Alike", "", Unit::count(""), Role::Best;
    /// The affinity from which trajectories are alike.
    LEAST_AFFINITY: "Least affinity", "", Unit::new("", 1), Role::Best;
    /// The affinity to the trajectory pointed at.
    AFFINITY: "Affinity to the trajectory pointed at", "w(A, B)", Unit::RATIO, Role::Best;
    /// The number of the iteration.
    ITERATION: "Iteration", "", Unit::WHOLE;
    /// The largest eigenvalues.
    EIGENVALUES: "Eigenvalues", r"\lambda", Unit::RATIO, Role::Estimate;
    /// The largest change of an eigenvalue in the iteration.
    CHANGE: "Largest change of an eigenvalue", "", Unit::RESPONSE;
    /// The number of eigenvectors that are coordinates.
    EIGENVECTORS: "Eigenvectors", "", Unit::count("");
}

cases! { pub(super) over value, shared;
    OPENING: "Two frames hold little information about slow or resting objects. Trajectories over many frames are alike only if \
              they move alike in all of them, so a single frame of different motion separates two objects.",
    TRACKED: "{method} makes {trajectories} of at least 3 frames",
    SHORT_CLIP: ", as the clip has fewer. Choose a longer clip.",
    NOTHING: ", so there is nothing to compare. Choose another method, or a clip with more texture.",
    PART: ", of which {compared} are compared: the affinities of all pairs are a matrix with as many rows and columns.",
    ALL: ". The affinities of all pairs are a matrix with as many rows and columns.",
    COMPARED: "{reference|Trajectory} {trajectory} is compared with all others by the largest difference of their motions in any \
               frame, weighted by their distance. {alike} {best|of them with an affinity of at least} {least_affinity} may \
               belong to the same object.",
    ITERATED: "Iteration {iteration} of the subspace: eigenvalues {eigenvalues} …. Multiplying by N makes the entries of alike \
               trajectories equal.",
    CONVERGED: "Iteration {iteration} of the subspace: eigenvalues {eigenvalues} …. They have converged. Each eigenvalue near 1 \
                stands for a group that hardly any affinity joins to the others.",
    NO_TRAJECTORIES: "Without trajectories there are no segments.",
    FOUND: "Each trajectory has its entries in the first {eigenvectors} eigenvectors as coordinates. In them k-means finds \
            {segments}",
    FOUND_FEWER: "Each trajectory has its entries in the first {eigenvectors} eigenvectors as coordinates. In them k-means finds \
                  {segments:bare} of {eigenvectors} segments, as there are no more distinct motions",
    AS_POSSIBLE: ", as there are no more eigenvalues near 1: groups with weak affinities between them lie apart.",
    AS_SET: ", as set: groups with weak affinities between them lie apart.",
    BY_GAP: ", as the eigenvalues fall most after it: groups with weak affinities between them lie apart.",
    LABELLED: "Each pixel takes the segment of its nearest trajectory.",
}

/// Affinity from which two trajectories are drawn as similar.
const ALIKE: f32 = 0.5;

impl TrajectoryClustering {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        match seen.events.last() {
            None => Step::at(line::TRACK).say(case::OPENING),
            Some(Event::Tracked(compared)) => self.tell_tracks(seen, compared),
            Some(Event::Compared(index, weights)) => tell_affinity(seen, *index as usize, weights),
            Some(Event::Iterated(spectrum)) => {
                let largest: Number = spectrum.values.iter().take(4).copied().collect();
                let step = Step::at(line::ITERATE).fact(value::ITERATION, spectrum.iterations);
                let step = step.fact(value::CHANGE, spectrum.change).put(value::EIGENVALUES, largest);
                step.say(if spectrum.is_over() { case::CONVERGED } else { case::ITERATED }).show(eigenvalues(spectrum))
            }
            Some(Event::Clustered(labels, count)) => self.tell_clusters(seen, labels, *count),
            Some(Event::Labelled(frame)) => {
                let step = Step::at(line::LABEL).say(case::LABELLED);
                conclude(step, seen.clip, seen.before.record.frame(), frame)
            }
        }
    }

    fn tell_tracks(&self, seen: &Seen<Self>, compared: &Compared) -> Step {
        let step = Step::at(line::TRACK).fact(value::TRAJECTORIES, compared.all().count());
        let step = step.put(shared::METHOD, self.tracks.estimator().info().name);
        let step = step.put(value::COMPARED, compared.tracks.len()).say(case::TRACKED);
        step.say(match compared.tracks.len() {
            0 if seen.clip.info().frames.is_some_and(|frames| frames < 3) => case::SHORT_CLIP,
            0 => case::NOTHING,
            _ if !compared.others.is_empty() => case::PART,
            _ => case::ALL,
        })
    }

    fn tell_clusters(&self, seen: &Seen<Self>, labels: &[u32], count: usize) -> Step {
        let step = Step::at(line::CLUSTER).fact(value::TRAJECTORIES, labels.len());
        let step = step.show_all(seen.before.spectrum.as_ref().map(|spectrum| eigenvalues(spectrum)));
        if labels.is_empty() {
            return step.say(case::NO_TRAJECTORIES);
        }
        let found = labels.iter().collect::<BTreeSet<_>>().len();
        let step = step.put(value::EIGENVECTORS, count).put(shared::SEGMENTS, found);
        step.say(if found < count { case::FOUND_FEWER } else { case::FOUND }).say(match self.selection {
            Choice::Given if count < self.clusters => case::AS_POSSIBLE,
            Choice::Given => case::AS_SET,
            Choice::Gap => case::BY_GAP,
        })
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT)];
        let compared = seen.after.or(Some(seen.before)).and_then(|state| state.compared.as_ref());
        let (Some(event), Some(compared)) = (seen.events.last(), compared) else { return };
        match event {
            Event::Tracked(_) => {
                compared.tracks.iter().for_each(|track| draw_track(scene, track, Role::Reference, None));
                scene.legend(Role::Reference, "trajectory");
            }
            Event::Compared(index, weights) => draw_affinities(scene, compared, *index as usize, weights),
            Event::Iterated(spectrum) => draw_vector(scene, seen, compared, spectrum),
            Event::Clustered(labels, _) => {
                for (track, label) in compared.all().zip(labels.iter()) {
                    draw_track(scene, track, Role::Result, Some(*label));
                }
                scene.legend(Role::Result, "trajectories, one colour for each segment");
            }
            Event::Labelled(frame) => draw_segments(scene, frame),
        }
        scene.is_overview = true;
    }
}

fn tell_affinity(seen: &Seen<TrajectoryClustering>, index: usize, weights: &[f32]) -> Step {
    let alike = weights.iter().filter(|w| **w >= ALIKE).count().saturating_sub(1);
    let step = Step::at(line::COMPARE).fact(value::TRAJECTORY, index + 1).put(value::ALIKE, alike);
    let step = step.put(value::LEAST_AFFINITY, ALIKE).say(case::COMPARED).formula(
        r"w(A, B) = \exp(-\lambda d^2), \quad
          d^2 = \text{max over } t \text{ of } d_{\text{sp}}(A, B) \cdot |\Delta A - \Delta B|^2 \, / \, (5 \, \sigma^2)",
    );
    let compared = seen.before.compared.as_ref();
    let other = compared.zip(seen.point()).and_then(|(compared, point)| nearest(compared, point));
    let step = match other.and_then(|other| Some((other, *weights.get(other)?))) {
        Some((other, affinity)) => {
            let step = step.fact(value::AFFINITY, affinity).put(value::OTHER, other + 1);
            step.formula("w({trajectory}, {other}) = {affinity}")
        }
        None => step,
    };
    step.show(sorted(weights))
}

/// The affinities in descending order.
fn sorted(weights: &[f32]) -> Readout {
    let mut all = weights.to_vec();
    all.sort_by(|a, b| b.total_cmp(a));
    Readout::Series(Series {
        thresholds: vec![("drawn as alike".to_owned(), ALIKE)],
        is_sweep: true,
        decimals: Some(3),
        ..Series::new(
            "Affinities in descending order",
            ["trajectories", "affinity w"],
            all.len(),
            vec![("affinity", Role::Best, all.iter().enumerate().map(|(i, w)| [(i + 1) as f32, *w]).collect())],
        )
    })
}

fn eigenvalues(spectrum: &Spectrum) -> Readout {
    Readout::Series(Series {
        is_sweep: true,
        chosen: spectrum.is_over().then(|| spectrum.groups_by_gap() as f32),
        decimals: Some(3),
        ..Series::new(
            "Eigenvalues of the normalised affinities",
            ["number", "eigenvalue"],
            EIGENVALUES,
            vec![("eigenvalue", Role::Estimate, Series::bars(spectrum.values.iter().map(|value| *value as f32)))],
        )
    })
}

/// The trajectory that begins nearest to a point.
fn nearest(compared: &Compared, [x, y]: [f32; 2]) -> Option<usize> {
    let distance = |track: &Track| track.points.first().map_or(f32::INFINITY, |p| (p.at[0] - x).hypot(p.at[1] - y));
    (0..compared.tracks.len()).min_by(|a, b| distance(&compared.tracks[*a]).total_cmp(&distance(&compared.tracks[*b])))
}

fn path(track: &Track) -> Shape {
    Shape::line(track.points.iter().map(|point| point.at).collect())
}

fn draw_track(scene: &mut Scene, track: &Track, role: Role, label: Option<u32>) {
    match label {
        Some(label) => scene.mark_of(label, Picture::CURRENT, role, path(track)),
        None => scene.mark(Picture::CURRENT, role, path(track)),
    }
}

fn draw_affinities(scene: &mut Scene, compared: &Compared, index: usize, weights: &[f32]) {
    for (track, weight) in compared.tracks.iter().zip(weights) {
        draw_track(scene, track, if *weight >= ALIKE { Role::Best } else { Role::Rejected }, None);
    }
    scene.legend(Role::Best, "affinity of at least 0.5");
    scene.legend(Role::Rejected, "less");
    if let Some(point) = compared.tracks.get(index).and_then(|track| track.points.first()) {
        let ring = Shape::circle(point.at, 5.0);
        scene.draw(Picture::CURRENT, (Role::Reference, "trajectory that is compared"), ring);
    }
}

/// The second eigenvector, the first one that separates anything, at the pixels nearest to each trajectory.
fn draw_vector(scene: &mut Scene, seen: &Seen<TrajectoryClustering>, compared: &Compared, spectrum: &Spectrum) {
    let Some(vector) = spectrum.vectors.get(1).or(spectrum.vectors.first()) else { return };
    let record = &seen.before.record;
    let nearest = compared.nearest_at_start(record.picture(), record.frame());
    let values = nearest.map(|index| vector.get(*index as usize).map_or(f32::NAN, |entry| *entry as f32));
    scene.draw(Picture::CURRENT, (Role::Estimate, "second eigenvector at the nearest trajectory"), Shape::heat(values));
    scene.heat = Some("entry of the eigenvector");
}
