//! Trackers that weigh several explanations of the detections, against plain references that enumerate all of them.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common::{self, Objects, numbers};
use crate::crossing::{Dice, HEIGHT, OF_CROSSING, PICTURE, SEEDS, crossing, crossings, found, rows, run, scored};
use motionscope_core::base::Error;
use motionscope_core::data::{Clip, ObjectBox};
use motionscope_core::geometry::Bounds;
use motionscope_core::products::ObjectField;
use motionscope_core::products::objects::assignment::WorkBudget;
use motionscope_core::products::objects::k_best::{Choice, Problem, Row, k_best};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move};
use motionscope_core::scene::{Math, Readout};
use motionscope_core::synth::{self, Difficulty};

/// A tracker with the noise of the detections here, and with further parameters.
fn set(id: &str, settings: &[(&str, &str)]) -> Box<dyn AnyEstimator> {
    let noise = [("measurement-noise-from", "box-height"), ("measurement-noise", "0.1"), ("process-noise", "0.02")];
    common::set(id, &[&noise[..], settings].concat())
}

/// All assignments of a problem with their costs.
fn enumerated(problem: &Problem) -> Vec<(Vec<Choice>, f64)> {
    let mut all = vec![(Vec::new(), problem.base)];
    for row in &problem.rows {
        let columns = row.columns.iter().map(|(column, cost)| (Choice::Column(*column), *cost));
        let alone = row.alone.iter().enumerate().map(|(way, cost)| (Choice::Alone(way), *cost));
        let choices: Vec<_> = columns.chain(alone).filter(|(_, cost)| cost.is_finite()).collect();
        let extended = all.iter().flat_map(|(before, sum): &(Vec<Choice>, f64)| {
            let free =
                choices.iter().filter(|(choice, _)| matches!(choice, Choice::Alone(_)) || !before.contains(choice));
            free.map(|(choice, cost)| ([&before[..], &[*choice]].concat(), sum + cost)).collect::<Vec<_>>()
        });
        all = extended.collect();
    }
    all
}

fn problem(dice: &mut Dice, rows: usize, columns: usize) -> Problem {
    let mut row = || {
        let all = (0..columns).map(|column| (column, (20.0 * dice.roll() - 5.0, dice.roll() < 0.7)));
        let kept = all.filter(|(_, (_, is_kept))| *is_kept).map(|(column, (cost, _))| (column, cost)).collect();
        let mut alone = || if dice.roll() < 0.75 { 12.0 * dice.roll() } else { f64::INFINITY };
        Row { columns: kept, alone: [alone(), alone()] }
    };
    let rows = (0..rows).map(|_| row()).collect();
    Problem { base: 3.0 * dice.roll(), columns, rows }
}

#[test]
fn the_k_best_assignments_are_those_of_full_enumeration() {
    let (mut dice, mut ranked, mut impossible) = (Dice(7), 0, 0);
    for case in 0..400 {
        let sizes = (0..1 + case % 3).map(|i| ((case / 3 + i) % 5, (case / 7 + 2 * i) % 5));
        let problems: Vec<Problem> = sizes.map(|(rows, columns)| problem(&mut dice, rows, columns)).collect();
        let mut expected: Vec<f64> =
            problems.iter().flat_map(|problem| enumerated(problem).into_iter().map(|(_, cost)| cost)).collect();
        expected.sort_by(f64::total_cmp);
        let (count, excess) = ([1, 7, 40, 5000][case % 4], [f64::INFINITY, 9.0][case / 4 % 2]);
        let all = expected.len();
        expected.retain(|cost| *cost <= expected_limit(&problems, excess));
        let is_longer = expected.len() > count;
        expected.truncate(count);
        let go_on = || Ok::<_, Error>(());
        let found = k_best(&problems, (count, excess), &mut WorkBudget::endless(&go_on)).expect("it is wanted");
        let costs: Vec<f64> = found.solutions.iter().map(|solution| solution.cost).collect();
        assert_eq!(costs.len(), expected.len(), "case {case}: {costs:?} of {expected:?}");
        for (cost, expected) in costs.iter().zip(&expected) {
            assert!((cost - expected).abs() < 1e-9, "case {case}: {costs:?}, not {expected:?}");
        }
        assert_eq!((found.has_more, found.is_exhausted), (is_longer, false), "case {case}");
        for (i, solution) in found.solutions.iter().enumerate() {
            let known = enumerated(&problems[solution.problem]);
            let same = known.iter().find(|(choices, _)| *choices == solution.choices).expect("one that is allowed");
            assert!((same.1 - solution.cost).abs() < 1e-9, "case {case}");
            let is_other = |other: &motionscope_core::products::objects::k_best::Solution| {
                (other.problem, &other.choices) != (solution.problem, &solution.choices)
            };
            assert!(found.solutions[..i].iter().all(is_other), "case {case}: one twice");
        }
        ranked += found.solutions.len();
        impossible += usize::from(all == 0);
    }
    assert!(ranked > 3000 && impossible > 5, "{ranked} ranked, {impossible} without a solution");
}

/// The largest cost within the excess over the best.
fn expected_limit(problems: &[Problem], excess: f64) -> f64 {
    let all = problems.iter().flat_map(|problem| enumerated(problem).into_iter().map(|(_, cost)| cost));
    all.fold(f64::INFINITY, f64::min) + excess
}

#[test]
fn a_ranking_without_work_left_is_an_assignment_that_is_allowed() {
    let (mut dice, go_on) = (Dice(3), || Ok::<_, Error>(()));
    let mut large = problem(&mut dice, 60, 50);
    large.rows.iter_mut().for_each(|row| row.alone = [40.0, 41.0]);
    let found = k_best(&[large.clone()], (20, f64::INFINITY), &mut WorkBudget::limited(2000, &go_on)).expect("wanted");
    assert!(found.is_exhausted && !found.solutions.is_empty());
    let mut columns: Vec<usize> = found.solutions[0]
        .choices
        .iter()
        .filter_map(|choice| match choice {
            Choice::Column(column) => Some(*column),
            Choice::Alone(_) => None,
        })
        .collect();
    let all = columns.len();
    columns.sort_unstable();
    columns.dedup();
    assert!(all > 30 && columns.len() == all, "{} of {all} columns once", columns.len());
    let whole = k_best(&[large], (20, f64::INFINITY), &mut WorkBudget::endless(&go_on)).expect("wanted");
    assert!(whole.solutions[0].cost <= found.solutions[0].cost && whole.solutions.len() == 20);
}

#[test]
fn the_budget_of_a_ranking_counts_the_pairs_that_its_subproblems_visit_and_copy() {
    // Each of the 200 solutions is parted into subproblems of 60 rows with up to 60 × 50 pairs, so that thousands of pairs are visited for a
    // solution: as many as a frame has at most are enough, but 5 000 for a solution are not.
    let (mut dice, go_on) = (Dice(9), || Ok::<_, Error>(()));
    let mut large = problem(&mut dice, 60, 50);
    large.rows.iter_mut().for_each(|row| row.alone = [8.0, 9.0]);
    let ranked = |pairs| {
        let mut budget = WorkBudget::limited(pairs, &go_on);
        k_best(&[large.clone()], (200, f64::INFINITY), &mut budget).expect("wanted")
    };
    let (all, few) = (ranked(20_000_000), ranked(1_000_000));
    assert_eq!((all.solutions.len(), all.is_exhausted), (200, false));
    assert!(few.is_exhausted);
    assert!(few.solutions.len() <= 200 && few.solutions[0].cost == all.solutions[0].cost);
}

/// The tracks after the fact and in real time.
fn both(id: &str, settings: &[(&str, &str)], clip: &Clip) -> [ObjectField; 2] {
    let estimator = set(id, settings);
    let mut walk = estimator.walk(clip, 0).expect("a run");
    walk.jump(Move::End);
    let causal = walk.causal().expect("it decides later");
    [run(&*estimator, clip), causal.get::<ObjectField>().expect("objects").clone()]
}

/// Everything that the steps of a run say, with the line of each.
fn steps(estimator: &dyn AnyEstimator, clip: &Clip) -> Vec<(String, String)> {
    let (mut walk, mut told) = (estimator.walk(clip, 0).expect("a run"), Vec::new());
    while !walk.at_end() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let step = walk.step(None);
        told.push((step.line.as_str().to_owned(), step.sentence.plain()));
    }
    told
}

/// A plain Kalman filter of position and velocity along both axes, which are independent and alike.
#[derive(Clone, Debug)]
struct Plain {
    /// Position and velocity by axis.
    state: [[f64; 2]; 2],
    /// Variance of the position, covariance, variance of the velocity.
    covariance: [f64; 3],
}

/// Noise as the parameters of the trackers give it for a box of this height.
const NOISE: f64 = 0.02 * HEIGHT as f64;
const SIGMA: f64 = 0.1 * HEIGHT as f64;

impl Plain {
    fn begun(at: [f64; 2]) -> Self {
        let speed = f64::from(HEIGHT) / 4.0;
        Self { state: at.map(|c| [c, 0.0]), covariance: [SIGMA * SIGMA, 0.0, speed * speed] }
    }

    fn predicted(&self) -> Self {
        let ([a, b, c], q) = (self.covariance, NOISE * NOISE);
        let state = self.state.map(|[x, v]| [x + v, v]);
        Self { state, covariance: [a + 2.0 * b + c + q / 4.0, b + c + q / 2.0, c + q] }
    }

    /// The squared Mahalanobis distance and the density of a measurement.
    fn weighed(&self, at: [f64; 2]) -> (f64, f64) {
        let s = self.covariance[0] + SIGMA * SIGMA;
        let squared = (0..2).map(|i| (at[i] - self.state[i][0]).powi(2)).sum::<f64>() / s;
        (squared, (-squared / 2.0).exp() / (std::f64::consts::TAU * s))
    }

    fn updated(&self, at: [f64; 2]) -> Self {
        let [a, b, c] = self.covariance;
        let s = a + SIGMA * SIGMA;
        let gain = [a / s, b / s];
        let state = [0, 1].map(|i| {
            let off = at[i] - self.state[i][0];
            [self.state[i][0] + gain[0] * off, self.state[i][1] + gain[1] * off]
        });
        Self { state, covariance: [a - gain[0] * a, b - gain[0] * b, c - gain[1] * b] }
    }
}

/// A hypothesis of the reference: its tracks by the detection that each began with, and the origin of each detection by frame.
#[derive(Clone, Debug)]
struct Explained {
    weight: f64,
    tracks: Vec<Plain>,
    /// The track of each detection; `None` for false alarms.
    origins: Vec<Vec<Option<usize>>>,
}

/// The detection probability that the trackers have by default.
fn detected() -> f64 {
    f64::from(0.9f32)
}

/// The gating threshold of d² in two dimensions.
fn limit(probability: f32) -> f64 {
    -2.0 * (1.0 - f64::from(probability)).ln()
}

/// The probability that a track has no detection in its gate.
fn missed(gate: f32) -> f64 {
    1.0 - detected() * f64::from(gate)
}

/// The likelihood ratio of a size that is that of the track: normal in the logarithms of width and height with a deviation of 0.2, against
/// even over a factor of 4 in each.
fn same_size() -> f64 {
    let deviation = f64::from(0.2f32);
    4f64.ln().powi(2) / (std::f64::consts::TAU * deviation * deviation)
}

/// Reid's hypotheses by full enumeration; those with another explanation of the frame `n_scan` before than the best are deleted.
fn all_hypotheses(frames: &[Vec<[f64; 2]>], n_scan: usize, gate: f32) -> Vec<Explained> {
    let area = (PICTURE.0 * PICTURE.1) as f64;
    let mut all = vec![Explained { weight: 1.0, tracks: Vec::new(), origins: Vec::new() }];
    for (t, detections) in frames.iter().enumerate() {
        let mut next = Vec::new();
        for one in &all {
            let expected: Vec<Plain> = one.tracks.iter().map(Plain::predicted).collect();
            // The track of each detection, or `count` and `count + 1` for a new track and a false alarm.
            let count = expected.len();
            let mut choices = vec![Vec::new()];
            for at in detections {
                let allowed: Vec<usize> =
                    (0..count + 2).filter(|i| *i >= count || expected[*i].weighed(*at).0 <= limit(gate)).collect();
                choices = choices
                    .iter()
                    .flat_map(|before: &Vec<usize>| {
                        let free = allowed.iter().filter(|i| **i >= count || !before.contains(i));
                        free.map(|i| [&before[..], &[*i]].concat()).collect::<Vec<_>>()
                    })
                    .collect();
            }
            for choice in choices {
                let (mut tracks, mut weight, mut origins) = (expected.clone(), one.weight, Vec::new());
                let is_found = |track: usize| choice.contains(&track);
                weight *= (0..count).map(|i| if is_found(i) { detected() } else { missed(gate) }).product::<f64>();
                for (i, at) in choice.iter().zip(detections) {
                    if *i < count {
                        weight *= expected[*i].weighed(*at).1 * same_size();
                        tracks[*i] = expected[*i].updated(*at);
                        origins.push(Some(*i));
                    } else if *i == count {
                        weight *= 0.1 / area;
                        tracks.push(Plain::begun(*at));
                        origins.push(Some(tracks.len() - 1));
                    } else {
                        weight *= 1.0 / area;
                        origins.push(None);
                    }
                }
                let origins = one.origins.iter().cloned().chain([origins]).collect();
                next.push(Explained { weight, tracks, origins });
            }
        }
        next.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        if let Some(decided) = t.checked_sub(n_scan) {
            let best = next[0].origins[decided].clone();
            next.retain(|one| one.origins[decided] == best);
        }
        let sum: f64 = next.iter().map(|one| one.weight).sum();
        next.iter_mut().for_each(|one| one.weight /= sum);
        all = next;
    }
    all
}

#[test]
fn the_leading_hypotheses_are_those_of_full_enumeration() {
    let (mut dice, mut decided_otherwise, mut of_tracks) = (Dice(11), 0, 0);
    for case in 0..60 {
        let walk = |t: usize| [100.0 + 4.0 * t as f64, 120.0];
        let mut near = |t: usize, far: f64| [0, 1].map(|i| walk(t)[i] + far * dice.normal());
        let frames = vec![vec![near(0, 1.0)], vec![near(1, 2.0), near(1, 12.0)], vec![near(2, 2.0), near(2, 9.0)]];
        let clip = rows(frames.iter().map(|all| all.iter().map(|at| found(*at)).collect()).collect());
        let mut leaders = Vec::new();
        // A narrow gate leaves out many detections of the object.
        let (gate, gate_text) = if case % 2 == 0 { (0.9999, "0.9999") } else { (0.9, "0.9") };
        for (n_scan, text) in [(9, "9"), (1, "1"), (0, "0")] {
            let settings = [
                ("source", "detections"),
                ("n-scan", text),
                ("max-hypotheses", "300"),
                ("min-ratio", "0"),
                ("gate", gate_text),
                ("min-hits", "1"),
                ("max-age", "500"),
                ("interpolate", "off"),
            ];
            let tracker = set("multiple-hypothesis", &settings);
            let expected = all_hypotheses(&frames, n_scan, gate);
            let field = run(&*tracker, &clip);
            for (t, frame) in field.frames.iter().enumerate() {
                let track = |i: usize| frame.objects.iter().find(|object| object.detection == Some(i));
                let is_alike =
                    expected[0].origins[t].iter().enumerate().all(|(i, origin)| origin.is_some() == track(i).is_some());
                assert!(is_alike, "case {case}, N = {n_scan}, frame {t}: {:?}, not {:?}", frame.objects, expected[0]);
                // Tracks go by other numbers here.
                for (s, earlier) in field.frames[..t].iter().enumerate() {
                    for (i, j) in (0..frames[t].len()).flat_map(|i| (0..frames[s].len()).map(move |j| (i, j))) {
                        let of = |t: usize, i: usize| expected[0].origins[t][i];
                        let before = earlier.objects.iter().find(|object| object.detection == Some(j));
                        let is_same = track(i).zip(before).is_some_and(|(a, b)| a.id == b.id);
                        assert_eq!(is_same, of(t, i).is_some() && of(t, i) == of(s, j), "case {case}, N = {n_scan}");
                        of_tracks += usize::from(is_same);
                    }
                }
            }
            for (plain, id) in expected[0].tracks.iter().zip(field.frames[2].objects.iter()) {
                let off = (0..2).map(|i| (plain.state[i][0] - id.position[i]).abs()).fold(0.0, f64::max);
                assert!(off < 1e-3, "case {case}: {off} px");
            }
            let told = steps(&*tracker, &clip);
            let (_, led) = told.iter().rfind(|(line, _)| line == "lead").expect("a step");
            let [first, second] = ["P = ", "second, P = "].map(|before| {
                let after = led.split(before).nth(1);
                after.and_then(|text| numbers(text).first().copied())
            });
            assert!(
                (first.expect("told") - expected[0].weight).abs() < 6e-4,
                "case {case}: {led}, {}",
                expected[0].weight
            );
            if let Some(other) = expected.get(1) {
                assert!((second.expect("told") - other.weight).abs() < 6e-4, "case {case}: {led}, {}", other.weight);
            }
            leaders.push(expected[0].origins.clone());
        }
        decided_otherwise += usize::from(leaders[0] != leaders[2]);
    }
    assert!(decided_otherwise > 5 && of_tracks > 100, "{decided_otherwise} decided otherwise, {of_tracks} links");
}

#[test]
fn several_hypotheses_switch_identities_less_than_one_in_a_crossing_with_clutter() {
    let single = crossings("kalman-tracker", &[("cost", "mahalanobis"), ("recover", "off")], SEEDS);
    let default = crossings("kalman-tracker", &[], SEEDS);
    let several = crossings("multiple-hypothesis", &[("false-alarms", "3")], SEEDS);
    let soft = crossings("joint-probabilistic", &[("false-alarms", "3")], SEEDS);
    // Decided at once, a detection is never the start of a track unless that is the more probable origin.
    let at_once =
        crossings("multiple-hypothesis", &[("false-alarms", "3"), ("new-tracks", "4"), ("n-scan", "0")], SEEDS);
    println!(
        "switches and IDF1: {single:?}, {default:?}, several {several:?}, decided at once {at_once:?}, soft {soft:?}"
    );
    assert!(several.0 < single.0.min(default.0), "{} of several, {} and {} of one", several.0, single.0, default.0);
    assert!(
        several.1 > single.1.max(default.1),
        "IDF1 {} of several, {} and {} of one",
        several.1,
        single.1,
        default.1
    );
    assert!(several.0 <= at_once.0 && several.1 > at_once.1, "{several:?}, decided at once {at_once:?}");
}

#[test]
fn a_decision_is_deferred_and_revised() {
    let mut revised = 0;
    for seed in 1..=5 {
        let clip = crossing(seed);
        let settings =
            [&OF_CROSSING[..], &[("false-alarms", "3"), ("backdate", "off"), ("interpolate", "off")]].concat();
        let [later, causal] = both("multiple-hypothesis", &settings, &clip);
        let ids = |field: &ObjectField, t: usize| -> Vec<(u32, Option<usize>)> {
            field.frames[t].objects.iter().map(|object| (object.id, object.detection)).collect()
        };
        let changed = (0..40).filter(|t| ids(&later, *t) != ids(&causal, *t)).count();
        let told = steps(&*set("multiple-hypothesis", &settings), &clip);
        let steps = told.iter().filter(|(line, _)| line == "revise").count();
        assert_eq!(changed > 0, steps > 0, "seed {seed}: {changed} frames, {steps} steps");
        revised += steps;
        // Where each frame is decided at once there is nothing to revise.
        let at_once = set("multiple-hypothesis", &[&settings[..], &[("n-scan", "0")]].concat());
        assert!(self::steps(&*at_once, &clip).iter().all(|(line, _)| line != "revise"), "seed {seed}");
        let mut walk = at_once.walk(&clip, 0).expect("a run");
        walk.jump(Move::End);
        assert!(walk.causal().is_none(), "real time is all there is");
    }
    assert!(revised > 5, "{revised} revisions");
}

#[test]
fn stars_that_cross_keep_their_identities() {
    let clip =
        synth::make("crossing-stars", &synth::scene("crossing-stars").expect("a scene").difficulty()).expect("a clip");
    for seed in ["1", "2", "3", "4", "5"] {
        let of = scored(&run(&*common::set("multiple-hypothesis", &[("seed", seed)]), &clip), &clip);
        assert!(of.switches == 0 && of.idf1 > 0.9 && of.precision > 0.95, "noise {seed}: {of:?}");
    }
}

/// Two objects that meet, are one detection for `together` frames and turn back or go on.
fn meeting(together: usize, turns_back: bool) -> Clip {
    meeting_at(5.0, together, turns_back)
}

/// The same at this speed in px/frame.
fn meeting_at(speed: f64, together: usize, turns_back: bool) -> Clip {
    const MEET: usize = 15;
    let frames = 2 * MEET + together;
    let place = |id: u32, t: usize| {
        let t = t as f64;
        let (meet, part) = (MEET as f64, (MEET + together) as f64);
        // How far it is from the middle; while they are together they stay.
        let off = if t < meet {
            t - meet
        } else if t < part {
            0.0
        } else {
            t - part + 1.0
        };
        let off = if turns_back { -off.abs() } else { off };
        [160.0 + if id == 1 { speed * off } else { -speed * off }, 120.0]
    };
    let object = |id: u32, t: usize| {
        let [x, y] = place(id, t).map(|c| c as f32 - HEIGHT / 2.0);
        ObjectBox { id, x, y, width: HEIGHT, height: HEIGHT, visibility: 1.0 }
    };
    let detected = |t: usize| match (MEET..MEET + together).contains(&t) {
        true => vec![found(place(1, t))],
        false => vec![found(place(1, t)), found(place(2, t))],
    };
    let truth = (0..frames).map(|t| vec![object(1, t), object(2, t)]).collect();
    rows((0..frames).map(detected).collect()).with_truth(Arc::new(Objects(truth)))
}

#[test]
fn objects_that_turn_back_while_they_are_one_detection_exchange_their_tracks() {
    // Only their motion tells them apart, and all hypotheses have the same motion model.
    let of = |together: usize, turns_back: bool| {
        let clip = meeting(together, turns_back);
        scored(&run(&*set("multiple-hypothesis", &[("source", "detections")]), &clip), &clip)
    };
    let (through, back) = (of(1, false), of(1, true));
    assert!(through.switches == 0 && through.idf1 > 0.95, "{through:?}");
    assert!(back.switches == 2 || back.idf1 < 0.8, "{back:?}");
}

/// Asserts that no detection is reported for two tracks of a frame.
fn assert_each_once(field: &ObjectField, case: &str) {
    for (t, frame) in field.frames.iter().enumerate() {
        let mut taken: Vec<usize> = frame.objects.iter().filter_map(|object| object.detection).collect();
        let all = taken.len();
        taken.sort_unstable();
        taken.dedup();
        assert_eq!(taken.len(), all, "{case}, frame {t}: {:?}", frame.objects);
    }
}

#[test]
fn one_detection_belongs_to_one_track_in_each_hypothesis() {
    let clip = meeting(3, false);
    assert_each_once(&run(&*set("multiple-hypothesis", &[("source", "detections")]), &clip), "meeting");
    let told = steps(&*set("multiple-hypothesis", &[("source", "detections")]), &clip);
    assert!(told.iter().any(|(_, said)| said.starts_with("2 tracks compete for 1 detection")), "{told:?}");
}

/// Two objects 1 px apart, which soft association draws together; in the last frame one detection is on both, the other 7.5 px away.
fn coalesced() -> Clip {
    const LAST: usize = 9;
    let across = |t: usize| if t == LAST { [120.0, 127.5] } else { [119.5, 120.5] };
    rows((0..=LAST).map(|t| across(t).map(|y| found([60.0 + 4.0 * t as f64, y])).to_vec()).collect())
}

#[test]
fn tracks_with_the_same_most_probable_detection_report_different_ones() {
    // So many false alarms that one of the tracks may well have been missed.
    let tracker = set("joint-probabilistic", &[("source", "detections"), ("false-alarms", "1000")]);
    let clip = coalesced();
    assert_each_once(&run(&*tracker, &clip), "coalesced");
    let told = steps(&*tracker, &clip);
    assert!(told.iter().any(|(_, said)| said.contains("counts for another track")), "{told:?}");
}

/// Two objects that meet, are one detection for a frame and turn back so slowly that each stays in its gate; the second of this height.
fn meeting_of_sizes(height: f32) -> Clip {
    let alike = meeting_at(3.0, 1, true);
    let resized =
        |bounds: Bounds, center: [f32; 2]| Bounds::around(center, bounds.size().map(|side| side * height / HEIGHT));
    let frames = alike.info().frames.unwrap_or(0);
    let detections = (0..frames).map(|t| {
        let mut all = alike.detections(t).unwrap_or_default().to_vec();
        all.iter_mut().skip(1).for_each(|second| second.bounds = resized(second.bounds, second.center));
        all
    });
    let truth = alike.truth().expect("exact");
    let boxes = (0..frames).map(|t| {
        let mut all = truth.objects(t).expect("readable").unwrap_or_default();
        for second in all.iter_mut().skip(1) {
            let bounds = Bounds::from(&*second);
            let [x, y] = resized(bounds, bounds.center()).min;
            *second = ObjectBox { x, y, width: height, height, ..*second };
        }
        all
    });
    let boxes = boxes.collect();
    rows(detections.collect()).with_truth(Arc::new(Objects(boxes)))
}

#[test]
fn objects_of_other_sizes_keep_their_tracks_where_motion_would_exchange_them() {
    let of = |size_noise: &str| {
        let clip = meeting_of_sizes(2.0 * HEIGHT);
        let settings = [("source", "detections"), ("size-noise", size_noise)];
        scored(&run(&*set("multiple-hypothesis", &settings), &clip), &clip)
    };
    let (known, ignored) = (of("0.2"), of("2"));
    assert!(known.switches == 0 && known.idf1 > 0.95, "{known:?}");
    assert!(ignored.switches == 2 || ignored.idf1 < 0.8, "{ignored:?}");
}

#[test]
fn a_hundred_frames_without_detections_end_all_tracks() {
    let walk = |t: usize| if (10..110).contains(&t) { vec![] } else { vec![found([60.0 + t as f64, 120.0])] };
    let clip = rows((0..120).map(walk).collect());
    for id in ["multiple-hypothesis", "joint-probabilistic"] {
        let field = run(&*set(id, &[("source", "detections")]), &clip);
        let alive = |t: usize| field.frames[t].objects.len();
        assert_eq!([alive(5), alive(20), alive(60), alive(109), alive(119)], [1, 1, 0, 0, 1], "{id}");
        assert_ne!(field.frames[5].objects[0].id, field.frames[119].objects[0].id, "{id}");
        let nothing = rows(vec![vec![]; 100]);
        assert!(
            run(&*set(id, &[("source", "detections")]), &nothing).frames.iter().all(|frame| frame.objects.is_empty())
        );
        assert!(!steps(&*set(id, &[("source", "detections")]), &nothing).is_empty());
    }
}

/// So many detections anywhere in a small square in each frame.
fn heap(count: usize, frames: usize) -> Clip {
    let mut dice = Dice(5);
    let mut frame = |_| (0..count).map(|_| found([140.0 + 40.0 * dice.roll(), 100.0 + 40.0 * dice.roll()])).collect();
    rows((0..frames).map(&mut frame).collect())
}

#[test]
fn an_explosion_of_hypotheses_is_bounded_and_said() {
    let begun = Instant::now();
    for (count, new, expected) in
        [(12, "0.1", "The maximum number of hypotheses, 30, leaves out"), (400, "1000", "too large to rank")]
    {
        let tracker = set("multiple-hypothesis", &[("source", "detections"), ("new-tracks", new)]);
        let clip = heap(count, 5);
        let told = steps(&*tracker, &clip);
        assert!(told.iter().any(|(_, said)| said.contains(expected)), "{count}");
        let mut walk = tracker.walk(&clip, 0).expect("a run");
        walk.jump(Move::To(Cursor { unit: 5, event: 0 }));
        assert!(walk.failure().is_none());
    }
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
}

/// A tracker of the detections of the clip that expects this number of new tracks, if it expects any number.
fn several(id: &str, new_tracks: &str) -> Box<dyn AnyEstimator> {
    let mut tracker = set(id, &[("source", "detections")]);
    tracker.set("new-tracks", new_tracks).ok();
    tracker
}

#[test]
fn an_explosion_in_one_place_leaves_the_work_for_others() {
    // A pair far from the heap: its few branches are ranked in full in each frame.
    for id in ["multiple-hypothesis", "joint-probabilistic"] {
        let frames = (0..3).map(|t| {
            let crowd = heap(300, 3).detections(t).unwrap_or_default().to_vec();
            crowd.into_iter().chain([found([20.0, 20.0]), found([26.0, 20.0])]).collect()
        });
        let clip = rows(frames.collect());
        let told = steps(&*several(id, "1000"), &clip);
        let exhausted = |said: &str| said.contains("too large to rank");
        assert!(told.iter().any(|(_, said)| exhausted(said)), "{id}: the heap is not large enough");
        let small = told.iter().filter(|(_, said)| {
            said.contains("2 tracks compete for 2 detections") || said.starts_with("2 tracks and 2 detections")
        });
        let small: Vec<_> = small.collect();
        assert!(!small.is_empty() && small.iter().all(|(_, said)| !exhausted(said)), "{id}: {small:?}");
    }
}

#[test]
fn detections_beyond_the_nearest_are_said_to_be_left_out() {
    let dense = heap(900, 1).detections(0).unwrap_or_default().to_vec();
    let clip = rows(vec![vec![found([160.0, 120.0])], dense]);
    for id in ["multiple-hypothesis", "joint-probabilistic"] {
        let told = steps(&*several(id, "10"), &clip);
        let gated = told.iter().filter(|(line, _)| line == "gate" || line == "validate");
        let said = gated.filter(|(_, said)| said.contains("only the 500 nearest detections are compared")).count();
        assert_eq!(said, 1, "{id}");
    }
}

#[test]
fn without_a_minimum_ratio_no_ratio_is_said_and_their_number_alone_bounds_hypotheses() {
    let clip = heap(4, 3);
    for (ratio, is_said) in [("0", false), ("0.001", true)] {
        let told = steps(&*set("multiple-hypothesis", &[("source", "detections"), ("min-ratio", ratio)]), &clip);
        let expanded = told.iter().filter(|(line, _)| line == "expand");
        let said = expanded.filter(|(_, said)| said.contains("times the highest probability")).count();
        assert_eq!(said > 0, is_said, "{told:?}");
    }
}

/// β by enumeration of all joint events of all tracks: tracks by detections, with β₀ at the end.
fn enumerated_weights(tracks: &[Plain], detections: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let (gate, density) = (0.999f32, 1.0 / (PICTURE.0 * PICTURE.1) as f64);
    let missed = missed(gate);
    let none = tracks.len();
    let mut events: Vec<Vec<usize>> = vec![Vec::new()];
    for at in detections {
        let allowed: Vec<usize> =
            (0..=none).filter(|i| *i == none || tracks[*i].weighed(*at).0 <= limit(gate)).collect();
        let extended = events.iter().flat_map(|before| {
            let free = allowed.iter().filter(|i| **i == none || !before.contains(i));
            free.map(|i| [&before[..], &[*i]].concat()).collect::<Vec<_>>()
        });
        events = extended.collect();
    }
    let weight = |event: &Vec<usize>| {
        let of_detections = event.iter().zip(detections).map(|(i, at)| match *i == none {
            true => density,
            false => detected() * tracks[*i].weighed(*at).1 * same_size(),
        });
        of_detections.product::<f64>()
            * (0..none).map(|i| if event.contains(&i) { 1.0 } else { missed }).product::<f64>()
    };
    let sum: f64 = events.iter().map(weight).sum();
    let share =
        |counts: &dyn Fn(&Vec<usize>) -> bool| events.iter().filter(|e| counts(e)).map(weight).sum::<f64>() / sum;
    let of = |track: usize| {
        let own = (0..detections.len()).map(|j| share(&|event| event[j] == track));
        own.chain([share(&|event| !event.contains(&track))]).collect()
    };
    (0..tracks.len()).map(of).collect()
}

impl Plain {
    /// The mixture of the updates by each detection and of the prediction, as a Gaussian with its mean and covariance.
    fn mixed(&self, detections: &[[f64; 2]], weights: &[f64]) -> ([[f64; 2]; 2], [[f64; 4]; 4]) {
        let parts: Vec<Plain> = detections.iter().map(|at| self.updated(*at)).chain([self.clone()]).collect();
        // As x, y, u, v.
        let vector = |part: &Plain| [part.state[0][0], part.state[1][0], part.state[0][1], part.state[1][1]];
        let mut mean = [0.0; 4];
        for (part, weight) in parts.iter().zip(weights) {
            (0..4).for_each(|i| mean[i] += weight * vector(part)[i]);
        }
        let mut covariance = [[0.0; 4]; 4];
        for (part, weight) in parts.iter().zip(weights) {
            let [a, b, c] = part.covariance;
            let own = [[a, 0.0, b, 0.0], [0.0, a, 0.0, b], [b, 0.0, c, 0.0], [0.0, b, 0.0, c]];
            for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                covariance[i][j] += weight * (own[i][j] + (vector(part)[i] - mean[i]) * (vector(part)[j] - mean[j]));
            }
        }
        ([[mean[0], mean[2]], [mean[1], mean[3]]], covariance)
    }
}

#[test]
fn association_probabilities_and_updates_are_those_of_all_joint_events() {
    let (mut dice, mut ambiguous) = (Dice(23), 0);
    for case in 0..40 {
        let mut near =
            |x: f64, far: f64| [x + far * dice.normal(), 120.0 + far * dice.normal()].map(|c| f64::from(c as f32));
        let first = vec![near(150.0, 1.0), near(162.0, 1.0), near(178.0, 1.0)];
        let second: Vec<[f64; 2]> = (0..2 + case % 4).map(|i| near(150.0 + 9.0 * i as f64, 7.0)).collect();
        let frames = [first.clone(), second.clone()];
        let clip = rows(frames.iter().map(|all| all.iter().map(|at| found(*at)).collect()).collect());
        let settings = [
            ("source", "detections"),
            ("min-hits", "1"),
            ("max-age", "500"),
            ("max-events", "5000"),
            ("interpolate", "off"),
        ];
        let tracker = set("joint-probabilistic", &settings);
        let predicted: Vec<Plain> = first.iter().map(|at| Plain::begun(*at).predicted()).collect();
        let expected = enumerated_weights(&predicted, &second);
        let mut walk = tracker.walk(&clip, 0).expect("a run");
        let (mut seen, unit) = (vec![false; 3], 1);
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        for event in 1..=walk.events() {
            walk.jump(Move::To(Cursor { unit, event }));
            let step = walk.step(None);
            if step.line.as_str() != "weigh" {
                continue;
            }
            let tables =
                step.readouts.iter().find_map(|r| if let Readout::Matrices(all) = r { Some(all) } else { None });
            let table = &tables.expect("matrices")[0];
            for (y, row) in table.rows.iter().enumerate() {
                let track = row.parse::<usize>().expect("a number") - 1;
                seen[track] = true;
                for (x, column) in table.columns.iter().enumerate() {
                    let detection = column.parse::<usize>().map_or(second.len(), |number| number - 1);
                    let (found, known) = (table.entries[(x, y)], expected[track][detection]);
                    assert!(
                        (found - known).abs() < 1e-6,
                        "case {case}, track {row}, detection {column}: {found}, {known}"
                    );
                    ambiguous += usize::from(known > 0.1 && known < 0.9);
                }
            }
        }
        for (track, weights) in expected.iter().enumerate() {
            assert!(seen[track] || weights[second.len()] > 1.0 - 1e-9, "case {case}: track {track} has no detection");
        }
        let field = run(&*tracker, &clip);
        for (i, (plain, weights)) in predicted.iter().zip(&expected).enumerate() {
            let object = field.frames[1].object(i as u32 + 1).expect("it is kept");
            let (state, covariance) = plain.mixed(&second, weights);
            let speed = object.velocity.expect("known");
            let spread = object.covariance.expect("known");
            for k in 0..2 {
                assert!((object.position[k] - state[k][0]).abs() < 1e-4, "case {case}: {object:?}, {state:?}");
                assert!((speed[k] - state[k][1]).abs() < 1e-4, "case {case}: {object:?}, {state:?}");
                for l in 0..2 {
                    assert!((spread[k][l] - covariance[k][l]).abs() < 1e-3, "case {case}: {spread:?}, {covariance:?}");
                }
            }
        }
    }
    assert!(ambiguous > 100, "{ambiguous} ambiguous pairs");
}

/// Two objects side by side, 8 px apart, with noise.
fn side_by_side(seed: u64) -> Clip {
    const FRAMES: usize = 60;
    let mut dice = Dice(seed);
    let place = |id: usize, t: usize| [20.0 + 4.0 * t as f64, 116.0 + 8.0 * id as f64];
    let mut frame = |t: usize| (0..2).map(|id| found(place(id, t).map(|c| c + 3.0 * dice.normal()))).collect();
    rows((0..FRAMES).map(&mut frame).collect())
}

#[test]
fn soft_association_draws_tracks_side_by_side_together() {
    // The mean distance across of the two tracks that are there from the first frame on.
    let apart = |id: &str| {
        let settings = [("source", "detections"), ("measurement-noise", "0.15")];
        let distances = (1..=10).flat_map(|seed| {
            let field = run(&*set(id, &settings), &side_by_side(seed));
            let of = |frame: &motionscope_core::products::ObjectFrame| {
                let [a, b] = [1, 2].map(|id| frame.object(id).map(|object| object.position[1]));
                Some((a? - b?).abs())
            };
            field.frames[10..].iter().filter_map(|frame| of(frame)).collect::<Vec<_>>()
        });
        let all: Vec<f64> = distances.collect();
        assert!(all.len() > 250, "{id}: {} frames with both tracks", all.len());
        all.iter().sum::<f64>() / all.len() as f64
    };
    let (soft, hard) = (apart("joint-probabilistic"), apart("multiple-hypothesis"));
    println!("apart: soft {soft:.2}, hard {hard:.2} px of 8");
    assert!(soft < hard - 1.0, "{soft:.2} px of 8 by JPDA, {hard:.2} px by hypotheses");
}

#[test]
fn the_end_of_a_run_says_whether_tracks_were_drawn_together() {
    let end = |scene: &str, settings: &[(&str, &str)]| {
        let sample = synth::scene(scene).expect("it is bundled");
        let clip = sample.clip(&sample.difficulty()).expect("a clip");
        let mut walk = common::set("joint-probabilistic", settings).walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    let together = end(
        "formation",
        &[("added-noise", "3"), ("measurement-noise-from", "box-height"), ("measurement-noise", "0.6")],
    );
    assert!(together.starts_with("Coalescence: neighbouring objects were 10.00 px apart"), "{together}");
    let apart = end("crossing-stars", &[]);
    assert!(apart.starts_with("No coalescence:"), "{apart}");
}

#[test]
fn more_hypotheses_do_not_replace_the_model_of_the_motion() {
    let sample = synth::scene("crossing-stars").expect("it is bundled");
    let turning = Difficulty { rotation: 4.0, ..sample.difficulty() };
    let clip = sample.clip(&turning).expect("a clip");
    let idf1 =
        |settings: &[(&str, &str)]| scored(&run(&*common::set("multiple-hypothesis", settings), &clip), &clip).idf1;
    let [few, many] = [idf1(&[]), idf1(&[("max-hypotheses", "300"), ("n-scan", "12"), ("min-ratio", "0")])];
    assert!(few < 0.7 && many < 0.7 && idf1(&[("motion", "turn")]) > 0.95, "{few}, {many}");
}

#[test]
fn many_joint_events_are_bounded_and_said() {
    let begun = Instant::now();
    for (count, expected) in [(9, "The maximum number of joint events, 500, leaves out"), (400, "too large to rank")] {
        let tracker = set("joint-probabilistic", &[("source", "detections")]);
        let told = steps(&*tracker, &heap(count, 4));
        assert!(told.iter().any(|(_, said)| said.contains(expected)), "{count}");
    }
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
}

#[test]
fn the_formula_of_a_branch_ends_in_the_probability_of_the_sentence() {
    let clip = crossing(3);
    let (mut walk, mut count) = (set("multiple-hypothesis", &[]).walk(&clip, 0).expect("a run"), 0);
    while !walk.at_end() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let step = walk.step(None);
        let said = step.sentence.plain();
        let Some(told) = said.split_once("Most probable, P = ").map(|(_, rest)| rest[..5].to_owned()) else { continue };
        let lines = step.readouts.iter().find_map(|readout| match readout {
            Readout::Equation(lines) => Some(lines.iter().map(Math::plain).collect::<Vec<_>>()),
            _ => None,
        });
        let last = lines.and_then(|lines| lines.last().cloned()).expect("an equation");
        assert!(last.ends_with(&format!("P = {told}")), "{said}\n{last}");
        // ln (c P) − ln c = ln P, but for rounding.
        let [product, constant, logarithm, probability] = numbers(&last)[..] else { panic!("four numbers in {last}") };
        assert!((product - constant - logarithm).abs() < 2e-3, "{last}");
        assert!((logarithm.exp() - probability).abs() < 2e-3, "{last}");
        count += 1;
    }
    assert!(count > 20, "{count}");
}
