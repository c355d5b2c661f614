//! What trajectory clustering tells and draws.

use std::sync::Arc;

use super::{Choice, Compared, EIGENVALUES, Event, TrajectoryClustering, line};
use crate::base::words::{counted, fixed, grouped};
use crate::methods::numbers::ratio;
use crate::methods::segmentation::explain::{conclusion, draw_segments, segment_facts};
use crate::methods::segmentation::spectral::Spectrum;
use crate::products::{SegmentFrame, Track};
use crate::run::Seen;
use crate::scene::{Canvas, Fact, Math, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step};

/// Affinity from which two trajectories are drawn as alike.
const ALIKE: f32 = 0.5;

impl TrajectoryClustering {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        match seen.events.last() {
            None => Step {
                line: line::TRACK,
                sentence: Sentence::default().text(
                    "Two frames hold little information about slow or resting objects. Trajectories over many frames are alike only if they move alike in all \
                     of them, so a single frame of different motion separates two objects.",
                ),
                readouts: Vec::new(),
            },
            Some(Event::Tracked(compared)) => self.told_tracks(seen, compared),
            Some(Event::Compared(index, weights)) => self.told_affinity(seen, *index as usize, weights),
            Some(Event::Iterated(spectrum)) => told_spectrum(spectrum),
            Some(Event::Clustered(labels, count)) => self.told_clusters(seen, labels, *count),
            Some(Event::Labelled(frame)) => told_labels(seen, frame),
        }
    }

    fn told_tracks(&self, seen: &Seen<Self>, compared: &Compared) -> Step {
        let name = self.tracks.estimator().info().name;
        let sentence = Sentence::default()
            .text(format!("{name} makes "))
            .ink(Role::Reference, counted(compared.all().count(), "trajectory"))
            .text(match compared.tracks.len() {
                0 if seen.clip.info().frames.is_some_and(|frames| frames < 3) => {
                    " of at least 3 frames, as the clip has fewer. Choose a longer clip.".to_owned()
                }
                0 => " of at least 3 frames, so there is nothing to compare. Choose another method, or a clip with more texture.".to_owned(),
                kept if !compared.others.is_empty() => format!(
                    " of at least 3 frames, of which {} are compared: the affinities of all pairs are a matrix with as many rows and columns.",
                    grouped(kept)
                ),
                _ => " of at least 3 frames. The affinities of all pairs are a matrix with as many rows and columns.".to_owned(),
            });
        let facts = vec![Fact::new("Trajectories", grouped(compared.all().count()), Some(Role::Reference))];
        Step { line: line::TRACK, sentence, readouts: vec![Readout::Facts(facts)] }
    }

    fn told_affinity(&self, seen: &Seen<Self>, index: usize, weights: &[f32]) -> Step {
        let alike = weights.iter().filter(|w| **w >= ALIKE).count().saturating_sub(1);
        let sentence = Sentence::default()
            .ink(Role::Reference, format!("Trajectory {}", grouped(index + 1)))
            .text(" is compared with all others by the largest difference of their motions in any frame, weighted by their distance. ")
            .ink(Role::Best, format!("{} of them with an affinity of at least {}", grouped(alike), fixed(ALIKE.into(), 1)))
            .text(" may belong to the same object.");
        let mut facts = vec![Fact::new("Trajectory", grouped(index + 1), Some(Role::Reference))];
        let compared = seen.before.compared.as_ref();
        let other = compared.zip(seen.point()).and_then(|(compared, point)| nearest(compared, point));
        let mut lines = vec![formula()];
        if let (Some(other), Some(weight)) = (other, other.and_then(|other| weights.get(other))) {
            facts.push(Fact::new("Affinity to the trajectory pointed at", ratio((*weight).into()), Some(Role::Best)));
            lines.push(Math::Row(vec![
                Math::text(format!("w({}, {}) = ", index + 1, other + 1)),
                Math::ink(Role::Best, ratio((*weight).into())),
            ]));
        }
        Step {
            line: line::COMPARE,
            sentence,
            readouts: vec![Readout::Facts(facts), Readout::Equation(lines), sorted(weights)],
        }
    }

    fn told_clusters(&self, seen: &Seen<Self>, labels: &[u32], count: usize) -> Step {
        let spectrum = seen.before.spectrum.as_ref();
        let sentence = match (labels.is_empty(), self.selection) {
            (true, _) => Sentence::default().text("Without trajectories there are no segments."),
            (false, choice) => {
                let why = match choice {
                    Choice::Given if count < self.clusters => "as there are no more eigenvalues near 1",
                    Choice::Given => "as set",
                    Choice::Gap => "as the eigenvalues fall most after it",
                };
                Sentence::default()
                    .text(format!("Each trajectory has its entries in the first {count} eigenvectors as coordinates. In them k-means finds "))
                    .ink(Role::Result, found_of(labels, count))
                    .text(format!(", {why}: groups with weak affinities between them lie apart."))
            }
        };
        let facts = vec![Fact::new("Trajectories", grouped(labels.len()), None)];
        let plot = spectrum.map(|spectrum| eigenvalues(spectrum));
        let readouts = [Readout::Facts(facts)].into_iter().chain(plot).collect();
        Step { line: line::CLUSTER, sentence, readouts }
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
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

/// The number of segments that were found, and of those asked for where there are not as many distinct trajectories.
fn found_of(labels: &[u32], count: usize) -> String {
    let mut distinct = labels.to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    match distinct.len() {
        found if found < count => format!("{found} of {count} segments, as there are no more distinct motions"),
        found => counted(found, "segment"),
    }
}

fn formula() -> Math {
    Math::Row(vec![
        Math::text("w(A, B) = exp(−λ d²),   d² = max over t of "),
        Math::indexed(Math::Var("d"), Math::text("sp")),
        Math::text("(A, B) · |ΔA − ΔB|² / (5 σ²)"),
    ])
}

fn told_spectrum(spectrum: &Spectrum) -> Step {
    let values: Vec<_> = spectrum.values.iter().take(4).map(|value| ratio(*value)).collect();
    let sentence = Sentence::default()
        .text(format!("Iteration {} of the subspace: eigenvalues ", spectrum.iterations))
        .ink(Role::Estimate, values.join(", "))
        .text(" …. ")
        .text(match spectrum.is_over() {
            false => "Multiplying by N makes the entries of alike trajectories equal.",
            true => "They have converged. Each eigenvalue near 1 stands for a group that hardly any affinity joins to the others.",
        });
    let facts = vec![
        Fact::new("Iteration", spectrum.iterations.to_string(), None),
        Fact::new("Largest change of an eigenvalue", crate::base::words::with_power(spectrum.change), None),
    ];
    Step { line: line::ITERATE, sentence, readouts: vec![Readout::Facts(facts), eigenvalues(spectrum)] }
}

fn told_labels(seen: &Seen<TrajectoryClustering>, frame: &Arc<SegmentFrame>) -> Step {
    let t = seen.before.record.frame();
    let sentence = Sentence::default()
        .text("Each pixel takes the segment of its nearest trajectory. ")
        .text(conclusion(seen.clip, t, frame));
    Step { line: line::LABEL, sentence, readouts: vec![Readout::Facts(segment_facts(frame))] }
}

/// The affinities in descending order.
fn sorted(weights: &[f32]) -> Readout {
    let mut all = weights.to_vec();
    all.sort_by(|a, b| b.total_cmp(a));
    Readout::Series(Series {
        title: "Affinities in descending order",
        x_label: "trajectories",
        y_label: "affinity w",
        x_max: all.len(),
        lines: vec![("affinity", Role::Best, all.iter().enumerate().map(|(i, w)| [(i + 1) as f32, *w]).collect())],
        thresholds: vec![("drawn as alike".to_owned(), ALIKE)],
        is_sweep: true,
        decimals: Some(3),
        ..Series::default()
    })
}

fn eigenvalues(spectrum: &Spectrum) -> Readout {
    Readout::Series(Series {
        title: "Eigenvalues of the normalised affinities",
        x_label: "number",
        y_label: "eigenvalue",
        x_max: EIGENVALUES,
        lines: vec![("eigenvalue", Role::Estimate, Series::bars(spectrum.values.iter().map(|value| *value as f32)))],
        is_sweep: true,
        chosen: spectrum.is_over().then(|| spectrum.groups_by_gap() as f32),
        decimals: Some(3),
        ..Series::default()
    })
}

/// The trajectory that begins nearest to a point.
fn nearest(compared: &Compared, [x, y]: [f32; 2]) -> Option<usize> {
    let distance = |track: &Track| track.points.first().map_or(f32::INFINITY, |p| (p.at[0] - x).hypot(p.at[1] - y));
    (0..compared.tracks.len()).min_by(|a, b| distance(&compared.tracks[*a]).total_cmp(&distance(&compared.tracks[*b])))
}

fn path(track: &Track) -> Shape {
    Shape::Path { points: track.points.iter().map(|point| point.at).collect(), closed: false }
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
        let ring = Shape::Ellipse { center: point.at, radii: [5.0; 2], angle_rad: 0.0 };
        scene.mark(Picture::CURRENT, Role::Reference, ring);
        scene.legend(Role::Reference, "trajectory that is compared");
    }
}

/// The second eigenvector, the first one that separates anything, at the pixels nearest to each trajectory.
fn draw_vector(scene: &mut Scene, seen: &Seen<TrajectoryClustering>, compared: &Compared, spectrum: &Spectrum) {
    let Some(vector) = spectrum.vectors.get(1).or(spectrum.vectors.first()) else { return };
    let record = &seen.before.record;
    let nearest = compared.nearest_at_start(record.picture(), record.frame());
    let values = nearest.map(|index| vector.get(*index as usize).map_or(f32::NAN, |entry| *entry as f32));
    scene.mark(Picture::CURRENT, Role::Estimate, Shape::Heat { origin: [0.0; 2], values });
    scene.legend(Role::Estimate, "second eigenvector at the nearest trajectory");
    scene.heat = Some("entry of the eigenvector");
}
