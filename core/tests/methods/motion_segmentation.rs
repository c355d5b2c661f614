//! Motion segmentation: true and estimated flow of rigid layers, a plain reference, and what it cannot do.

use std::sync::Arc;

use crate::common::{self, fact, set};
use motionscope_core::base::{Error, Threads};
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, Flow, Frame, Truth};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::SegmentField;
use motionscope_core::products::segments::{Overlap, adjusted_rand_index, mean_overlap};
use motionscope_core::run::{Cursor, Direction, Guarantee, Move};
use motionscope_core::scene::{Readout, Step};
use motionscope_core::synth;

fn clip(scene: &str, settings: &[(&str, &str)]) -> Clip {
    let scene = synth::scene(scene).expect("a bundled scene");
    let mut difficulty = scene.difficulty();
    settings.iter().for_each(|(name, value)| difficulty.set(name, value).expect("in range"));
    scene.clip(&difficulty).expect("a clip")
}

fn small(scene: &str) -> Clip {
    clip(scene, &[("width", "160"), ("height", "120"), ("frames", "5")])
}

/// A flow that is known, of frames without pictures of it.
struct Known(Flow);

impl Truth for Known {
    fn flow(&self, _: usize) -> Result<Option<Arc<Flow>>, Error> {
        Ok(Some(Arc::new(self.0.clone())))
    }

    fn kinds(&self) -> Vec<&'static str> {
        vec!["flow"]
    }
}

fn with_flow(flow: Grid<[f32; 2]>) -> Clip {
    let frames = vec![Frame::gray(Grid::new(flow.width(), flow.height(), 90)); 2];
    Clip::from_frames("known", frames).expect("frames of one size").with_truth(Arc::new(Known(Flow(flow))))
}

/// The segments that the estimator `id` finds from frame 0 on.
fn segments(id: &str, settings: &[(&str, &str)], clip: &Clip) -> SegmentField {
    let output = set(id, settings).run(clip, 0, &Threads::single()).expect("a run");
    output.get::<SegmentField>().expect("segments").clone()
}

/// Adjusted Rand index and mean overlap of frame `index`.
fn scores(field: &SegmentField, clip: &Clip, index: usize) -> [f64; 2] {
    let truth = clip.truth().expect("truth").segments(field.first + index).expect("readable").expect("labels");
    let overlap = Overlap::of(&truth, &field.frames[index].labels);
    [adjusted_rand_index(&overlap), mean_overlap(&overlap)]
}

/// The steps of a run.
fn steps(id: &str, settings: &[(&str, &str)], clip: &Clip) -> Vec<Step> {
    let mut walk = set(id, settings).walk(clip, 0).expect("a walk");
    let event = walk.info().granularities.len() - 1;
    let mut steps = Vec::new();
    while !walk.at_end() {
        walk.jump(Move::Granularity(event, Direction::Forward));
        steps.push(walk.step(None));
    }
    steps
}

fn said(steps: &[Step], line: &str) -> Vec<String> {
    steps.iter().filter(|step| step.line.as_str() == line).map(|step| step.sentence.plain()).collect()
}

const TRUE_FLOW: (&str, &str) = ("flow-source", "truth");

#[test]
fn clusters_of_the_true_flow_are_the_rigid_layers() {
    let clip = clip("rigid-layers", &[("frames", "2")]);
    for method in ["k-means", "gaussian-mixture", "mean-shift"] {
        let found = segments("motion-clustering", &[("method", method), TRUE_FLOW], &clip);
        let [index, overlap] = scores(&found, &clip, 0);
        assert!(index >= 0.95 && overlap >= 0.95, "{method}: {index}, {overlap}");
    }
}

#[test]
fn clusters_of_an_estimated_flow_are_nearly_the_rigid_layers() {
    let clip = clip("rigid-layers", &[("frames", "2")]);
    for method in ["k-means", "gaussian-mixture", "mean-shift"] {
        let found = segments("motion-clustering", &[("method", method)], &clip);
        let [index, overlap] = scores(&found, &clip, 0);
        assert!(index >= 0.85, "{method}: {index}, {overlap}");
    }
}

#[test]
fn layers_of_the_true_flow_are_the_rigid_motions() {
    for scene in ["rigid-layers", "turntable"] {
        let clip = clip(scene, &[("frames", "2")]);
        let found = segments("motion-layers", &[TRUE_FLOW], &clip);
        let [index, overlap] = scores(&found, &clip, 0);
        assert!(index >= 0.95 && overlap >= 0.95, "{scene}: {index}, {overlap}, {:?}", found.frames[0].segments);
    }
}

#[test]
fn layers_of_an_estimated_flow_are_nearly_the_rigid_motions() {
    for scene in ["rigid-layers", "turntable"] {
        let clip = clip(scene, &[("frames", "2")]);
        let found = segments("motion-layers", &[], &clip);
        let [index, overlap] = scores(&found, &clip, 0);
        assert!(index >= 0.85, "{scene}: {index}, {overlap}");
    }
}

#[test]
fn layers_cut_a_waving_flag_into_pieces() {
    // The cloth is the second layer from the front.
    const CLOTH: u32 = 2;
    let clip = clip("flag", &[("frames", "2")]);
    let found = segments("motion-layers", &[TRUE_FLOW], &clip);
    let truth = clip.truth().expect("truth").segments(0).expect("readable").expect("labels");
    let of_cloth = truth.cells().iter().zip(found.frames[0].labels.cells()).filter(|(truth, _)| **truth == CLOTH);
    let labels: Vec<u32> = of_cloth.map(|(_, label)| *label).collect();
    let most =
        found.frames[0].segments.iter().map(|segment| labels.iter().filter(|label| **label == segment.label).count());
    let share = most.max().expect("segments") as f64 / labels.len() as f64;
    assert!(labels.len() > 20_000 && share < 0.7, "{share} of {} px", labels.len());
}

#[test]
fn trajectories_are_clustered_by_their_motion_over_many_frames() {
    let clip = clip("rigid-layers", &[("seed", "9")]);
    for settings in [&[("selection", "given")][..], &[("selection", "gap")], &[("tracks", "klt"), ("frames", "6")]] {
        let field = segments("trajectory-clustering", settings, &clip);
        let frames = if settings[0].0 == "tracks" { 6 } else { 8 };
        assert_eq!((field.first, field.frames.len()), (0, frames - 1));
        // The last eigenvalue near 1 is the third.
        assert_eq!(field.frames[0].segments.len(), 3, "{settings:?}");
        let [index, _] = scores(&field, &clip, 0);
        assert!(index >= if settings[0].0 == "tracks" { 0.7 } else { 0.85 }, "{settings:?}: {index}");
    }
}

#[test]
fn more_segments_than_distinct_motions_are_refused_in_words() {
    let still = Clip::from_frames("still", vec![(*clip("rigid-layers", &[]).frame(0).expect("a frame")).clone(); 5]);
    let still = still.expect("frames of one size");
    let mut walk = set("trajectory-clustering", &[("clusters", "5")]).walk(&still, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit: 3, event: 1 }));
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("k-means finds"), "{said}");
    let one = segments("trajectory-clustering", &[("clusters", "1")], &still);
    assert_eq!(one.frames[0].segments.len(), 1);
    let pair = clip("rigid-layers", &[("frames", "2")]);
    let output = set("trajectory-clustering", &[]).run(&pair, 0, &Threads::single()).expect("a run");
    assert!(output.get::<SegmentField>().expect("segments").frames.is_empty(), "two frames have no trajectories");
}

#[test]
fn without_trajectories_there_are_no_segments_but_a_sentence() {
    let blank = Clip::from_frames("gray", vec![Frame::gray(Grid::new(64, 48, 120)); 4]).expect("frames");
    let mut walk = estimator("trajectory-clustering").expect("an estimator").walk(&blank, 0).expect("a walk");
    walk.jump(Move::To(Cursor::END));
    assert!(walk.failure().is_none(), "{:?}", walk.failure());
    assert_eq!(walk.step(None).sentence.plain(), "Without trajectories there are no segments.");
}

#[test]
fn every_motion_segmentation_separates_rigid_motions() {
    let clip = clip("rigid-layers", &[("frames", "2")]);
    let mut ran = 0;
    for mut estimator in estimators().into_iter().filter(|estimator| estimator.guarantee() == Guarantee::Segments) {
        estimator.set("flow-source", "truth").expect("a choice");
        let output = estimator.run(&clip, 0, &Threads::new(2).expect("threads")).expect("a run");
        let field = output.get::<SegmentField>().expect("segments");
        let [index, _] = scores(field, &clip, 0);
        assert!(index >= 0.95, "{}: {index}", estimator.info().id);
        ran += 1;
    }
    assert_eq!(ran, 3);
}

/// A turning and growing square before a shearing background, as affine motions.
const SQUARE: [f64; 6] = [3.0, 0.02, -0.04, -2.0, 0.04, 0.02];
const BEHIND: [f64; 6] = [-1.0, 0.0, 0.01, 0.5, 0.0, 0.0];

fn moved(a: [f64; 6], (x, y): (usize, usize)) -> [f64; 2] {
    let (x, y) = (x as f64, y as f64);
    [a[0] + a[1] * x + a[2] * y, a[3] + a[4] * x + a[5] * y]
}

#[test]
fn layers_have_the_affine_motions_of_a_plain_reference() {
    let is_square = |x: usize, y: usize| (30..80).contains(&x) && (20..70).contains(&y);
    let flow =
        Grid::from_fn(120, 100, |x, y| moved(if is_square(x, y) { SQUARE } else { BEHIND }, (x, y)).map(|c| c as f32));
    let clip = with_flow(flow.clone());
    let field = segments("motion-layers", &[TRUE_FLOW, ("block-size", "10")], &clip);
    let frame = &field.frames[0];
    assert_eq!(frame.segments.len(), 2, "{:?}", frame.segments);
    for (truth, at) in [(SQUARE, (50, 40)), (BEHIND, (5, 5))] {
        let segment = frame.segment(frame.labels[at]).expect("a segment");
        let affine = segment.affine.expect("an affine motion");
        assert!(affine.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-3), "{affine:?}, not {truth:?}");
        assert_eq!(segment.is_dominant, at == (5, 5), "the background is dominant");
    }
    // Each pixel has the layer of the smallest residual.
    for (x, y) in (0..100).flat_map(|y| (0..120).map(move |x| (x, y))) {
        let residual = |segment: &motionscope_core::products::Segment| {
            let [u, v] = moved(segment.affine.expect("an affine motion"), (x, y));
            (u - f64::from(flow[(x, y)][0])).hypot(v - f64::from(flow[(x, y)][1]))
        };
        let own = residual(frame.segment(frame.labels[(x, y)]).expect("a segment"));
        assert!(frame.segments.iter().all(|other| own <= residual(other) + 1e-4), "({x}, {y})");
    }
}

#[test]
fn layers_answer_bad_input_in_words() {
    let still = with_flow(Grid::new(64, 48, [0.0; 2]));
    let all = steps("motion-layers", &[TRUE_FLOW], &still);
    assert!(said(&all, "label")[0].contains("no other motion stands out"));
    let clip = clip("rigid-layers", &[("frames", "2")]);
    for clusters in ["1", "32"] {
        let field = segments("motion-layers", &[TRUE_FLOW, ("clusters", clusters)], &clip);
        assert_eq!(field.frames[0].segments.len(), 3, "clusters = {clusters}: splits and merges find the motions");
    }
    let all = steps("motion-layers", &[TRUE_FLOW, ("clusters", "1")], &clip);
    assert!(!said(&all, "split").is_empty(), "one cluster is not enough");
    let unknown = with_flow(Grid::new(32, 24, Flow::UNKNOWN));
    assert!(segments("motion-layers", &[TRUE_FLOW], &unknown).frames[0].segments.is_empty());
}

#[test]
fn clusters_cut_a_rotating_object_into_pieces() {
    let clip = clip("turntable", &[("frames", "2")]);
    let found = segments("motion-clustering", &[TRUE_FLOW], &clip);
    let [index, _] = scores(&found, &clip, 0);
    assert!(index < 0.6, "{index}");
}

#[test]
fn labels_stay_from_frame_to_frame() {
    let clip = small("rigid-layers");
    for id in ["motion-clustering", "motion-layers", "flow-segmentation"] {
        let found = segments(id, &[TRUE_FLOW, ("frames", "5")], &clip);
        assert_eq!(found.frames.len(), 4);
        let name = |index: usize, label: u32| {
            let truth = clip.truth().expect("truth").segments(index).expect("readable").expect("labels");
            let overlap = Overlap::of(&truth, &found.frames[index].labels);
            overlap.pairs_by_shared_pixels().into_iter().find(|(truth, _)| *truth == label).map(|(_, label)| label)
        };
        for label in 1..=3 {
            let names: Vec<_> = (0..4).map(|index| name(index, label)).collect();
            assert!(names.iter().all(|name| name.is_some() && *name == names[0]), "{id}: {names:?}");
        }
    }
}

/// Lloyd's iteration with sums in double precision, from these means on.
fn lloyd(points: &[[f32; 2]], mut means: Vec<[f64; 2]>) -> Vec<usize> {
    let squared = |p: &[f32; 2], m: &[f64; 2]| (f64::from(p[0]) - m[0]).powi(2) + (f64::from(p[1]) - m[1]).powi(2);
    let mut labels = vec![usize::MAX; points.len()];
    loop {
        let nearest = |p: &[f32; 2]| {
            (0..means.len()).min_by(|a, b| squared(p, &means[*a]).total_cmp(&squared(p, &means[*b]))).expect("a mean")
        };
        let next: Vec<usize> = points.iter().map(nearest).collect();
        if next == labels {
            return labels;
        }
        labels = next;
        for (j, mean) in means.iter_mut().enumerate() {
            let own: Vec<_> = points.iter().zip(&labels).filter(|(_, label)| **label == j).map(|(p, _)| p).collect();
            *mean = [0, 1].map(|i| own.iter().map(|p| f64::from(p[i])).sum::<f64>() / own.len() as f64);
        }
    }
}

#[test]
fn k_means_is_that_of_a_plain_reference() {
    // Displacements that fill a square, so that many iterations are needed.
    let value = |x: usize, y: usize, k: usize| ((x * 31 + y * k) % 97) as f32 / 24.0;
    let flow = Grid::from_fn(60, 40, |x, y| [value(x, y, 57), value(x, y, 83) + x as f32 / 30.0]);
    let clip = with_flow(flow.clone());
    let settings = [TRUE_FLOW, ("clusters", "4"), ("iterations", "200")];
    let all = steps("motion-clustering", &settings, &clip);
    let last_seed = all.iter().rfind(|step| step.line.as_str() == "pick-seed").expect("seeds");
    let seeds: Vec<[f64; 2]> = common::plane(last_seed).points.iter().map(|(.., uv)| uv.map(f64::from)).collect();
    assert_eq!(seeds.len(), 4);
    assert!(said(&all, "assign").len() > 5, "it takes a while");
    let expected = lloyd(flow.cells(), seeds);
    let found = segments("motion-clustering", &settings, &clip);
    let labels = found.frames[0].labels.cells();
    // Labels are numbers of clusters in a first frame.
    let mut names = [0; 4];
    labels.iter().zip(&expected).for_each(|(label, cluster)| names[*cluster] = *label);
    let off = labels.iter().zip(&expected).filter(|(label, cluster)| **label != names[**cluster]).count();
    assert_eq!(off, 0, "of {}", labels.len());
}

#[test]
fn the_log_likelihood_of_a_mixture_never_falls() {
    let clip = small("rigid-layers");
    let settings = [("method", "gaussian-mixture"), ("clusters", "4"), ("flow", "horn-schunck")];
    let all = steps("motion-clustering", &settings, &clip);
    let values: Vec<f64> = all
        .iter()
        .filter(|step| step.line.as_str() == "expect")
        .map(|step| common::numbers(&fact(step, "Log-likelihood per pixel").expect("a number"))[0])
        .collect();
    assert!(values.len() > 4 && values.windows(2).all(|pair| pair[1] >= pair[0]), "{values:?}");
}

#[test]
fn the_silhouette_finds_the_number_of_motions() {
    let clip = small("rigid-layers");
    let settings = [("selection", "silhouette"), ("clusters", "8"), TRUE_FLOW];
    let found = segments("motion-clustering", &settings, &clip);
    assert_eq!(found.frames[0].segments.len(), 3);
    let all = steps("motion-clustering", &settings, &clip);
    let has_elbow = |step: &Step| {
        let title =
            |readout: &Readout| matches!(readout, Readout::Series(series) if series.title.contains("by number"));
        step.readouts.iter().filter(|readout| title(readout)).count() == 2
    };
    assert!(all.last().is_some_and(has_elbow), "distances and silhouettes over k");
}

#[test]
fn bad_input_is_answered_in_words() {
    let still = with_flow(Grid::new(32, 24, [0.0; 2]));
    let clip = small("rigid-layers");
    let k = |k: &'static str| [("clusters", k), TRUE_FLOW];
    // No motion at all.
    for method in ["k-means", "gaussian-mixture", "mean-shift"] {
        let settings = [("method", method), TRUE_FLOW];
        assert_eq!(segments("motion-clustering", &settings, &still).frames[0].segments.len(), 1, "{method}");
        let all = steps("motion-clustering", &settings, &still);
        assert!(said(&all, "label")[0].contains("no other motion stands out"), "{method}");
    }
    // One cluster.
    let all = steps("motion-clustering", &k("1"), &clip);
    assert!(said(&all, "label")[0].contains("A single cluster was asked for"));
    // More clusters than distinct motions.
    let all = steps("motion-clustering", &k("7"), &clip);
    assert!(said(&all, "pick-seed").last().is_some_and(|said| said.contains("only 3 distinct motions")));
    assert_eq!(segments("motion-clustering", &k("7"), &clip).frames[0].segments.len(), 3);
    // No flow is known.
    let unknown = with_flow(Grid::new(32, 24, Flow::UNKNOWN));
    let field = segments("motion-clustering", &k("3"), &unknown);
    assert!(field.frames[0].segments.is_empty() && field.frames[0].labels.cells().iter().all(|label| *label == 0));
    // There is no truth.
    let blind = Clip::from_frames("blind", vec![Frame::gray(Grid::new(32, 24, 90)); 2]).expect("frames");
    let refused = set("motion-clustering", &k("3")).walk(&blind, 0).err().expect("no truth").to_string();
    assert!(refused.contains("set flow-source to estimated"), "{refused}");
}

#[test]
fn a_pixel_is_explained_by_its_distances() {
    let clip = small("rigid-layers");
    let estimator = set("motion-clustering", &[TRUE_FLOW]);
    let step = common::explained_at(&*estimator, &clip, 1, [43.0, 46.0]);
    let equation = common::equation(&step);
    assert_eq!(equation.len(), 3, "{equation:?}");
    let distances: Vec<f64> = equation.iter().map(|row| *common::numbers(row).last().expect("a number")).collect();
    assert!(distances.contains(&0.0), "{distances:?}");
    assert!(fact(&step, "Displacement").is_some_and(|text| text.contains('(')));
}

const METHODS: [&str; 2] = ["graph", "region-growing"];

#[test]
fn regions_of_the_true_flow_are_the_rigid_motions() {
    for scene in ["rigid-layers", "turntable"] {
        let clip = clip(scene, &[("frames", "2")]);
        let found = segments("flow-segmentation", &[TRUE_FLOW], &clip);
        let [index, overlap] = scores(&found, &clip, 0);
        assert!(index >= 0.95 && overlap >= 0.95, "{scene}: {index}, {overlap}, {:?}", found.frames[0].segments);
    }
    let clip = clip("rigid-layers", &[("frames", "2")]);
    let found = segments("flow-segmentation", &[TRUE_FLOW, ("method", "region-growing")], &clip);
    let [index, overlap] = scores(&found, &clip, 0);
    assert!(index >= 0.95 && overlap >= 0.95, "{index}, {overlap}");
}

#[test]
fn regions_of_an_estimated_flow_are_nearly_the_rigid_layers() {
    let clip = clip("rigid-layers", &[("frames", "2")]);
    for method in METHODS {
        let found = segments("flow-segmentation", &[("method", method)], &clip);
        let [index, overlap] = scores(&found, &clip, 0);
        assert!(index >= 0.85, "{method}: {index}, {overlap}");
    }
}

/// A flow with smooth parts, jumps and noise, as a plain function of the place.
fn uneven() -> Grid<[f32; 2]> {
    Grid::from_fn(18, 13, |x, y| {
        let noise = ((x * 37 + y * 101 + x * y * 13) % 17) as f32 / 40.0;
        let jump = if x > 7 && y > 4 { 3.0 } else { 0.0 };
        [jump + x as f32 * 0.05 + noise, noise - y as f32 * 0.03]
    })
}

/// Whether two partitions of the same pixels are the same, whatever their labels.
fn is_same_partition(a: &[u32], b: &[u32]) -> bool {
    let pairs: std::collections::BTreeSet<(u32, u32)> = a.iter().copied().zip(b.iter().copied()).collect();
    let count = |all: &[u32]| all.iter().collect::<std::collections::BTreeSet<_>>().len();
    a.len() == b.len() && pairs.len() == count(a) && pairs.len() == count(b)
}

/// Neighbouring pixels with the length of the difference of their displacements, in raster order.
fn differences(flow: &Grid<[f32; 2]>) -> Vec<(f32, [usize; 2])> {
    let (width, height) = flow.size();
    let cells = flow.cells();
    let pixels = 0..width * height;
    let right = |i: usize| (i % width + 1 < width).then_some(i + 1);
    let below = |i: usize| (i / width + 1 < height).then_some(i + width);
    let pairs = pixels.flat_map(|i| [right(i), below(i)].into_iter().flatten().map(move |j| [i, j]));
    pairs.map(|[i, j]| ((cells[i][0] - cells[j][0]).hypot(cells[i][1] - cells[j][1]), [i, j])).collect()
}

/// The largest edge of the minimum spanning tree of the pixels of one label, by Prim's algorithm.
fn internal_difference(labels: &[u32], label: u32, edges: &[(f32, [usize; 2])]) -> f32 {
    let mut reached = vec![false; labels.len()];
    reached[labels.iter().position(|l| *l == label).expect("a pixel")] = true;
    let mut largest = 0.0f32;
    loop {
        let crossing =
            edges.iter().filter(|(_, [i, j])| labels[*i] == label && labels[*j] == label && reached[*i] != reached[*j]);
        let Some((weight, ends)) = crossing.min_by(|a, b| a.0.total_cmp(&b.0)) else { return largest };
        largest = largest.max(*weight);
        ends.iter().for_each(|end| reached[*end] = true);
    }
}

/// Algorithm 1 of Felzenszwalb and Huttenlocher (2004), with their definition of the internal difference.
fn felzenszwalb(flow: &Grid<[f32; 2]>, scale: f32) -> Vec<u32> {
    let edges = differences(flow);
    let mut sorted = edges.clone();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut labels: Vec<u32> = (0..flow.cells().len() as u32).collect();
    for (weight, [i, j]) in sorted {
        let (a, b) = (labels[i], labels[j]);
        let area = |label: u32| labels.iter().filter(|l| **l == label).count() as f32;
        let limit = |label: u32| internal_difference(&labels, label, &edges) + scale / area(label);
        if a != b && weight <= limit(a).min(limit(b)) {
            labels.iter_mut().filter(|label| **label == b).for_each(|label| *label = a);
        }
    }
    labels
}

/// Region growing from the first pixel of no region, breadth first, with a mean over the region so far.
fn grown(flow: &Grid<[f32; 2]>, tolerance: f64) -> Vec<u32> {
    let (width, height) = flow.size();
    let uv = |i: usize| flow.cells()[i].map(f64::from);
    let mut labels = vec![0u32; width * height];
    let mut label = 0;
    while let Some(seed) = labels.iter().position(|label| *label == 0) {
        label += 1;
        labels[seed] = label;
        let (mut queue, mut sum, mut count) = (std::collections::VecDeque::from([seed]), uv(seed), 1.0);
        while let Some(i) = queue.pop_front() {
            let (x, y) = (i % width, i / width);
            let around = [
                (x > 0).then(|| i - 1),
                (x + 1 < width).then_some(i + 1),
                (y > 0).then(|| i - width),
                (y + 1 < height).then_some(i + width),
            ];
            for j in around.into_iter().flatten() {
                let off = [0, 1].map(|c| uv(j)[c] - sum[c] / count);
                if labels[j] == 0 && off[0].hypot(off[1]) <= tolerance {
                    labels[j] = label;
                    (sum, count) = ([sum[0] + uv(j)[0], sum[1] + uv(j)[1]], count + 1.0);
                    queue.push_back(j);
                }
            }
        }
    }
    labels
}

#[test]
fn regions_are_those_of_plain_references() {
    let flow = uneven();
    let clip = with_flow(flow.clone());
    for scale in ["0.5", "2", "8"] {
        let settings = [TRUE_FLOW, ("scale", scale), ("min-area", "0")];
        let found = segments("flow-segmentation", &settings, &clip);
        let expected = felzenszwalb(&flow, scale.parse().expect("a number"));
        let regions = found.frames[0].segments.len();
        assert!((2..200).contains(&regions), "scale {scale}: {regions} regions");
        assert!(is_same_partition(found.frames[0].labels.cells(), &expected), "scale {scale}");
    }
    for tolerance in ["0.2", "0.5", "1"] {
        let settings = [TRUE_FLOW, ("method", "region-growing"), ("tolerance", tolerance), ("min-area", "0")];
        let found = segments("flow-segmentation", &settings, &clip);
        let expected = grown(&flow, tolerance.parse().expect("a number"));
        assert!(found.frames[0].segments.len() > 1);
        assert!(is_same_partition(found.frames[0].labels.cells(), &expected), "tolerance {tolerance}");
    }
}

#[test]
fn regions_are_connected_so_an_object_behind_another_is_cut() {
    // A bar before the middle of a background.
    let flow = Grid::from_fn(90, 60, |x, _| if (40..50).contains(&x) { [5.0, 0.0] } else { [1.0, 0.5] });
    let clip = with_flow(flow);
    for method in METHODS {
        let found = segments("flow-segmentation", &[TRUE_FLOW, ("method", method)], &clip);
        assert_eq!(found.frames[0].segments.len(), 3, "{method}: both sides of the bar are segments");
    }
    assert_eq!(segments("motion-clustering", &[TRUE_FLOW, ("clusters", "2")], &clip).frames[0].segments.len(), 2);
    let all = steps("flow-segmentation", &[TRUE_FLOW], &clip);
    assert!(said(&all, "label")[0].contains("parts of one object on both sides of another are two segments"));
}

#[test]
fn small_regions_are_merged_across_their_smallest_edge() {
    // One deviant pixel, nearer to the right side.
    let flow = Grid::from_fn(40, 20, |x, y| match (x, y) {
        (19, 10) => [2.0, 0.0],
        _ if x < 20 => [0.0, 0.0],
        _ => [3.0, 0.0],
    });
    let clip = with_flow(flow);
    let settings = |area: &'static str| [TRUE_FLOW, ("scale", "1"), ("min-area", area)];
    assert_eq!(segments("flow-segmentation", &settings("0"), &clip).frames[0].segments.len(), 3);
    let merged = segments("flow-segmentation", &settings("1"), &clip);
    let labels = &merged.frames[0].labels;
    assert_eq!(merged.frames[0].segments.len(), 2);
    assert_eq!((labels[(19, 10)], labels[(19, 9)]), (labels[(30, 10)], labels[(5, 5)]));
}

#[test]
fn flow_segmentation_answers_bad_input_in_words() {
    let still = with_flow(Grid::new(64, 48, [0.0; 2]));
    let unknown = with_flow(Grid::new(32, 24, Flow::UNKNOWN));
    for method in METHODS {
        let settings = [TRUE_FLOW, ("method", method)];
        assert_eq!(segments("flow-segmentation", &settings, &still).frames[0].segments.len(), 1);
        let all = steps("flow-segmentation", &settings, &still);
        assert!(said(&all, "label")[0].contains("no other motion stands out"), "{method}");
        assert!(segments("flow-segmentation", &settings, &unknown).frames[0].segments.is_empty());
    }
}
