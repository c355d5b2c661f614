//! How good tracks are beside the true ones.

use std::collections::{BTreeMap, BTreeSet};

use super::assignment::least_cost;
use super::{Bounds, Followed, Life, ObjectField};
use crate::{Error, Grid, Truth};

/// From here on, as intersection over union, an object counts as found.
const FOUND: f64 = 0.5;

/// Objects in one frame, each with its identity.
pub type Boxes = Vec<(u32, Bounds)>;

/// Tracks beside the true ones, over all frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores {
    /// True objects, counted in each frame.
    pub truths: usize,
    /// Objects that were told, counted in each frame.
    pub told: usize,
    /// True objects that were found.
    pub matches: usize,
    /// How often a true object was found as another one than before.
    pub switches: usize,
    /// Multiple object tracking accuracy: 1 − (misses + false alarms + switches) / truths.
    pub mota: f64,
    /// Multiple object tracking precision: mean intersection over union of what was found.
    pub motp: f64,
    /// F₁ of identities: of pairs of true and told tracks that agree in the most frames.
    pub idf1: f64,
    /// Share of what was told that is true.
    pub precision: f64,
    /// Share of the true objects that were found.
    pub recall: f64,
    /// Higher order tracking accuracy: the mean of √(DetA · AssA) over limits of 0.05 to 0.95.
    pub hota: f64,
}

/// A share of nothing is 0.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// Overlaps of true objects, a row each, and told ones.
fn overlaps(truth: &Boxes, told: &Boxes) -> Grid<f64> {
    Grid::from_fn(told.len(), truth.len(), |x, y| f64::from(truth[y].1.iou(&told[x].1)))
}

/// Scores the confirmed objects of a run beside the truth, where one was followed beside that one; `None` where nothing is known
/// of its frames, or nobody is followed in them.
///
/// # Errors
/// If the truth cannot be read.
pub fn scores(field: &ObjectField, truth: &dyn Truth) -> Result<Option<Scores>, Error> {
    let counts = |id: u32| match &field.followed {
        Followed::Nobody => false,
        Followed::One(ids) => ids.contains(&id),
        Followed::All => true,
    };
    let is_anyone = match &field.followed {
        Followed::Nobody => false,
        Followed::One(ids) => !ids.is_empty(),
        Followed::All => true,
    };
    if !is_anyone {
        return Ok(None);
    }
    let mut frames = Vec::new();
    for (i, frame) in field.frames.iter().enumerate() {
        let Some(objects) = truth.objects(field.first + i)? else { return Ok(None) };
        let known = objects.iter().filter(|object| counts(object.id));
        let known = known.map(|object| (object.id, Bounds::from(object))).collect();
        let confirmed = frame.objects.iter().filter(|object| object.life == Life::Confirmed);
        frames.push((known, confirmed.map(|object| (object.id, object.bounds)).collect()));
    }
    Ok(Some(Scores::of(&frames)))
}

impl Scores {
    /// The scores of frames with their true and told objects.
    ///
    /// MOTA and MOTP: K. Bernardin and R. Stiefelhagen, Evaluating multiple object tracking performance, 2008. IDF1: E. Ristani and
    /// others, Performance measures and a data set for multi-target, multi-camera tracking, 2016. HOTA: J. Luiten and others, 2021.
    pub fn of(frames: &[(Boxes, Boxes)]) -> Self {
        let truths = frames.iter().map(|(truth, _)| truth.len()).sum();
        let told = frames.iter().map(|(_, told)| told.len()).sum();
        let Clear { matches, switches, overlap } = Clear::of(frames);
        let wrong = (truths - matches) + (told - matches) + switches;
        let [all, found] = [truths, told].map(|count| count as f64);
        Self {
            truths,
            told,
            matches,
            switches,
            mota: if truths > 0 { 1.0 - wrong as f64 / all } else { 0.0 },
            motp: share(overlap, matches as f64),
            idf1: share(2.0 * identities(frames) as f64, all + found),
            precision: share(matches as f64, found),
            recall: share(matches as f64, all),
            hota: hota(frames),
        }
    }
}

/// What CLEAR-MOT counts.
#[derive(Default)]
struct Clear {
    matches: usize,
    switches: usize,
    overlap: f64,
}

impl Clear {
    /// Who was found as whom stays so while it can; the others are paired anew in each frame.
    fn of(frames: &[(Boxes, Boxes)]) -> Self {
        let mut clear = Self::default();
        let mut found_as: BTreeMap<u32, u32> = BTreeMap::new();
        for (truth, told) in frames {
            let overlaps = overlaps(truth, told);
            let (mut pairs, mut taken) = (vec![None; truth.len()], BTreeSet::new());
            for (y, (id, _)) in truth.iter().enumerate() {
                // Two may have been found as the same one before: the first of them has it.
                let same = told.iter().position(|(other, _)| found_as.get(id) == Some(other));
                pairs[y] = same.filter(|&x| overlaps[(x, y)] >= FOUND && taken.insert(x));
            }
            let free = Grid::from_fn(told.len(), truth.len(), |x, y| {
                let is_free = pairs[y].is_none() && !taken.contains(&x) && overlaps[(x, y)] >= FOUND;
                if is_free { 1.0 - overlaps[(x, y)] } else { f64::INFINITY }
            });
            for (pair, new) in pairs.iter_mut().zip(least_cost(&free)) {
                *pair = pair.or(new);
            }
            for (y, x) in pairs.iter().enumerate().filter_map(|(y, x)| Some((y, (*x)?))) {
                let before = found_as.insert(truth[y].0, told[x].0);
                clear.switches += usize::from(before.is_some_and(|before| before != told[x].0));
                clear.matches += 1;
                clear.overlap += overlaps[(x, y)];
            }
        }
        clear
    }
}

/// The identities of all frames, in order, with how often each is there.
fn counted<'a>(frames: impl Iterator<Item = &'a Boxes>) -> (Vec<u32>, Vec<f64>) {
    let mut counts: BTreeMap<u32, f64> = BTreeMap::new();
    frames.flatten().for_each(|(id, _)| *counts.entry(*id).or_default() += 1.0);
    counts.into_iter().unzip()
}

/// The place of an identity that is there.
fn index(ids: &[u32], id: u32) -> usize {
    ids.partition_point(|&other| other < id)
}

/// In how many frames true and told tracks agree if each is paired with one other for good.
fn identities(frames: &[(Boxes, Boxes)]) -> usize {
    let (truths, _) = counted(frames.iter().map(|(truth, _)| truth));
    let (tolds, _) = counted(frames.iter().map(|(_, told)| told));
    let mut agree = Grid::new(tolds.len(), truths.len(), 0.0);
    for (truth, told) in frames {
        for (id, bounds) in truth {
            for (other, _) in told.iter().filter(|(_, other)| f64::from(bounds.iou(other)) >= FOUND) {
                agree[(index(&tolds, *other), index(&truths, *id))] += 1.0;
            }
        }
    }
    let pairs = least_cost(&agree.map(|&count: &f64| -count));
    let paired = pairs.iter().enumerate().filter_map(|(y, x)| x.map(|x| agree[(x, y)]));
    paired.sum::<f64>() as usize
}

fn hota(frames: &[(Boxes, Boxes)]) -> f64 {
    let (truths, truth_counts) = counted(frames.iter().map(|(truth, _)| truth));
    let (tolds, told_counts) = counted(frames.iter().map(|(_, told)| told));
    let aligned = alignment(frames, (&truths, &truth_counts), (&tolds, &told_counts));
    let place = |truth: u32, told: u32| (index(&tolds, told), index(&truths, truth));
    // One pairing for all limits: what aligns best over the whole clip, weighed by the overlap in the frame.
    let mut matched: Vec<((usize, usize), f64)> = Vec::new();
    for (truth, told) in frames {
        let overlaps = overlaps(truth, told);
        let scores =
            Grid::from_fn(told.len(), truth.len(), |x, y| -aligned[place(truth[y].0, told[x].0)] * overlaps[(x, y)]);
        let pairs = least_cost(&scores).into_iter().enumerate();
        matched.extend(pairs.filter_map(|(y, x)| x.map(|x| (place(truth[y].0, told[x].0), overlaps[(x, y)]))));
    }
    let all = truth_counts.iter().sum::<f64>() + told_counts.iter().sum::<f64>();
    let of_limit = |limit: f64| {
        let mut counts = Grid::new(tolds.len(), truths.len(), 0.0);
        matched.iter().filter(|(_, overlap)| *overlap >= limit - 1e-9).for_each(|(place, _)| counts[*place] += 1.0);
        // The sum of nothing is −0.
        let hits = counts.cells().iter().sum::<f64>() + 0.0;
        let mut association = 0.0;
        for (y, truth) in truth_counts.iter().enumerate() {
            for (x, told) in told_counts.iter().enumerate() {
                let count: f64 = counts[(x, y)];
                association += count * share(count, truth + told - count);
            }
        }
        (share(hits, all - hits) * share(association, hits)).sqrt()
    };
    (1..20).map(|i| of_limit(f64::from(i) * 0.05)).sum::<f64>() / 19.0
}

/// How much of two tracks is alike over the whole clip, each frame shared out among those that overlap in it.
fn alignment(
    frames: &[(Boxes, Boxes)],
    (truths, truth_counts): (&[u32], &[f64]),
    (tolds, told_counts): (&[u32], &[f64]),
) -> Grid<f64> {
    let mut shared: Grid<f64> = Grid::new(tolds.len(), truths.len(), 0.0);
    for (truth, told) in frames {
        let overlaps = overlaps(truth, told);
        let of_truth: Vec<f64> = (0..truth.len()).map(|y| (0..told.len()).map(|x| overlaps[(x, y)]).sum()).collect();
        let of_told: Vec<f64> = (0..told.len()).map(|x| (0..truth.len()).map(|y| overlaps[(x, y)]).sum()).collect();
        for (y, (id, _)) in truth.iter().enumerate() {
            for (x, (other, _)) in told.iter().enumerate() {
                let overlap: f64 = overlaps[(x, y)];
                let place = (index(tolds, *other), index(truths, *id));
                shared[place] += share(overlap, of_truth[y] + of_told[x] - overlap);
            }
        }
    }
    Grid::from_fn(tolds.len(), truths.len(), |x, y| {
        let both: f64 = shared[(x, y)];
        share(both, truth_counts[y] + told_counts[x] - both)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(id: u32, x: f32) -> (u32, Bounds) {
        (id, Bounds { min: [x, 0.0], max: [x + 10.0, 10.0] })
    }

    #[test]
    fn the_truth_itself_is_perfect() {
        let frame = |t: f32| vec![at(1, t), at(2, 50.0 - t)];
        let frames: Vec<_> = (0..10).map(|t| (frame(t as f32), frame(t as f32))).collect();
        let Scores { mota, motp, idf1, hota, switches, precision, recall, .. } = Scores::of(&frames);
        assert_eq!((mota, motp, idf1, switches, precision, recall), (1.0, 1.0, 1.0, 0, 1.0, 1.0));
        assert!((hota - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_told_and_nothing_true_are_no_division_by_zero() {
        let missed: Vec<(Boxes, Boxes)> = vec![(vec![at(1, 0.0)], vec![]); 3];
        let scores = Scores::of(&missed);
        assert_eq!((scores.mota, scores.idf1, scores.hota, scores.precision), (0.0, 0.0, 0.0, 0.0));
        let alarms: Vec<(Boxes, Boxes)> = vec![(vec![], vec![at(1, 0.0)]); 3];
        assert_eq!(Scores::of(&alarms).idf1, 0.0);
        assert!(Scores::of(&[]).hota.is_sign_positive() && scores.hota.is_sign_positive(), "no −0");
    }

    #[test]
    fn an_identity_that_changes_in_the_middle_is_told_by_each_score() {
        let frames: Vec<_> = (0..10).map(|t| (vec![at(1, 0.0)], vec![at(if t < 5 { 7 } else { 8 }, 0.0)])).collect();
        let scores = Scores::of(&frames);
        assert_eq!((scores.switches, scores.mota), (1, 0.9));
        assert_eq!(scores.idf1, 0.5, "half of all frames belong to the better half");
        // DetA is 1; each half is associated to 5 of 10: AssA is ½.
        assert!((scores.hota - 0.5_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn nobody_is_found_twice_as_the_same() {
        // Each true object was found as 9 once; then both stand where 9 is.
        let frames = vec![
            (vec![at(1, 0.0)], vec![at(9, 0.0)]),
            (vec![at(2, 0.0)], vec![at(9, 0.0)]),
            (vec![at(1, 0.0), at(2, 1.0)], vec![at(9, 0.0)]),
        ];
        assert_eq!(Scores::of(&frames).matches, 3);
    }

    #[test]
    fn misses_and_false_alarms_count_once_each() {
        // Of IoU 0.43: too little in common.
        let frames = vec![(vec![at(1, 0.0)], vec![at(3, 4.0)]), (vec![at(1, 0.0)], vec![at(3, 3.0)])];
        let scores = Scores::of(&frames);
        assert_eq!((scores.matches, scores.mota), (1, 0.0));
        assert!((scores.motp - 7.0 / 13.0).abs() < 1e-6);
    }
}
