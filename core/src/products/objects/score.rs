//! Scores of tracks against the ground truth: CLEAR MOT, IDF1, HOTA.

use std::collections::BTreeMap;
use std::convert::Infallible;

use super::assignment::{WorkBudget, least_cost, most_worth};
use super::box_index::{BoxIndex, corners};
use super::pairs::{Pairs, Sums};
use crate::base::{Error, words::fixed};
use crate::data::{Clip, MaskErrors, ObjectBox, Truth};
use crate::geometry::Bounds;
use crate::products::{Followed, ObjectField, TrackStatus};

/// The minimum IoU of a match.
const MATCH_IOU: f64 = 0.5;

/// The boxes of one frame, each with its identity.
pub type Boxes = Vec<(u32, Bounds)>;

/// The scores of tracks over all frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores {
    /// True objects, counted in each frame.
    pub truths: usize,
    /// Confirmed tracks, counted in each frame.
    pub hypotheses: usize,
    /// True objects with a match.
    pub matches: usize,
    /// Identity switches: matches of a true object with another track than before.
    pub switches: usize,
    /// Multiple object tracking accuracy: 1 − (misses + false alarms + switches) / truths.
    pub mota: f64,
    /// Multiple object tracking precision: mean IoU of the matches.
    pub motp: f64,
    /// F₁ score of identities, under the pairing of true and estimated tracks that agrees in the most frames.
    pub idf1: f64,
    /// Share of the estimated boxes with a match.
    pub precision: f64,
    /// Share of the true boxes with a match.
    pub recall: f64,
    /// Higher order tracking accuracy: the mean of √(DetA · AssA) over limits of 0.05 to 0.95.
    pub hota: f64,
    /// The boxes and tracks matched greedily because the optimal assignment is too large: 0 except in extremely dense frames.
    pub greedy: usize,
}

/// The errors of confirmed tracks in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameErrors {
    /// The frame.
    pub frame: usize,
    /// The true boxes with a match.
    pub matches: Boxes,
    /// The true boxes without a match.
    pub misses: Boxes,
    /// The boxes of tracks without a match.
    pub false_alarms: Boxes,
    /// The identity switches.
    pub switches: Vec<Switch>,
}

/// An identity switch: a true object is matched with another track than before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switch {
    /// The identity of the true object.
    pub object: u32,
    /// The track that it was matched with last.
    pub before: u32,
    /// Its track now.
    pub now: u32,
    /// The true box.
    pub bounds: Bounds,
}

/// Estimates matched one to one with the truth: boxes at an IoU of at least 0.5, or pixels of a mask.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Matches {
    /// The true boxes or pixels.
    pub truths: usize,
    /// The estimated ones.
    pub estimates: usize,
    /// The pairs of both.
    pub pairs: usize,
}

impl Matches {
    /// The share of estimates with a match as text, or the word for an undefined one.
    pub fn text(share: Option<f64>, decimals: usize) -> String {
        share.map_or_else(|| "undefined".into(), |share| fixed(share, decimals))
    }

    /// Matches the true and the estimated boxes of a frame at the least cost 1 − IoU.
    pub fn of(frame: &(Boxes, Boxes)) -> Self {
        let (mut clear, go_on) = (Clear::default(), &|| Ok::<_, Infallible>(()));
        let Ok(()) = overlaps(frame, go_on).and_then(|overlaps| clear.see(frame, &overlaps, go_on).map(drop));
        Self { truths: frame.0.len(), estimates: frame.1.len(), pairs: clear.matches }
    }

    /// Counts the pixels of a mask that was compared with the truth.
    pub fn of_pixels(errors: &MaskErrors) -> Self {
        let pairs = errors.correct.count();
        Self { truths: pairs + errors.misses.count(), estimates: pairs + errors.false_positives.count(), pairs }
    }

    /// The sum over the frames of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let Self { truths, estimates, pairs } = other;
        Self { truths: self.truths + truths, estimates: self.estimates + estimates, pairs: self.pairs + pairs }
    }

    /// True boxes or pixels without a match: false negatives.
    pub fn misses(self) -> usize {
        self.truths - self.pairs
    }

    /// Estimates without a match: false positives.
    pub fn false_positives(self) -> usize {
        self.estimates - self.pairs
    }

    /// Share of the estimates that are matched; `None` without estimates.
    pub fn precision(self) -> Option<f64> {
        ratio(self.pairs as f64, self.estimates)
    }

    /// Share of the truth that is matched; `None` without true ones.
    pub fn recall(self) -> Option<f64> {
        ratio(self.pairs as f64, self.truths)
    }

    /// F₁ score: the harmonic mean of precision and recall; `None` with neither truth nor estimates.
    pub fn f1(self) -> Option<f64> {
        ratio(2.0 * self.pairs as f64, self.truths + self.estimates)
    }
}

/// Returns a ratio, `None` where the denominator is 0.
fn ratio(part: f64, whole: usize) -> Option<f64> {
    (whole > 0).then(|| part / whole as f64)
}

/// Returns a ratio, 0 where the denominator is 0.
fn share(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// The check for cancellation, which `E` reports.
type Wanted<'a, E> = &'a dyn Fn() -> Result<(), E>;

/// The number of rows between checks for cancellation.
const ROWS_AT_ONCE: usize = 64;

/// The maximum number of pairs visited by an assignment, about a second; beyond it the assignment is greedy.
const MOST_WORK: u64 = 100_000_000;

/// Returns the IoU of the overlapping true (rows) and estimated boxes (columns).
fn overlaps<E>((truth, hypotheses): &(Boxes, Boxes), wanted: Wanted<E>) -> Result<Pairs, E> {
    let near = BoxIndex::new(hypotheses.iter().map(|(_, bounds)| corners(bounds)));
    let (mut pairs, mut found) = (Pairs::new(hypotheses.len()), Vec::new());
    for (y, (_, bounds)) in truth.iter().enumerate() {
        if y.is_multiple_of(ROWS_AT_ONCE) {
            wanted()?;
        }
        let overlap = |x: usize| f64::from(bounds.iou(&hypotheses[x].1));
        near.touching(corners(bounds), &mut found, |x| Some(overlap(x)).filter(|overlap| *overlap > 0.0));
        pairs.push(found.iter().copied());
    }
    Ok(pairs)
}

/// Scores the confirmed tracks of a run against the truth, or against one true object if one was tracked; `None` where the truth
/// of a frame is unknown or nothing is tracked.
///
/// # Errors
/// If the truth cannot be read.
pub fn scores(field: &ObjectField, truth: &dyn Truth) -> Result<Option<Scores>, Error> {
    scores_while(field, truth, &|| Ok(()))
}

/// Scores a run on a clip against the clip's truth; `None` where it has none.
///
/// # Errors
/// If the truth cannot be read, or the work is cancelled (see [`Clip::until`]).
pub fn scores_on(clip: &Clip, field: &ObjectField) -> Result<Option<Scores>, Error> {
    let scored = clip.truth().map(|truth| scores_while(field, &**truth, &|| clip.wanted()));
    scored.transpose().map(Option::flatten)
}

/// Returns the errors of each frame of a run on a clip; `None` where the clip has no truth or nothing is tracked.
///
/// # Errors
/// If the truth cannot be read, or the work is cancelled (see [`Clip::until`]).
pub fn errors_on(clip: &Clip, field: &ObjectField) -> Result<Option<Vec<FrameErrors>>, Error> {
    let Some(truth) = clip.truth() else { return Ok(None) };
    let wanted: Wanted<Error> = &|| clip.wanted();
    let Some(frames) = boxes_of(field, &**truth)? else { return Ok(None) };
    let mut clear = Clear::default();
    let errors = frames.iter().enumerate().map(|(i, frame)| {
        let seen = clear.see(frame, &overlaps(frame, wanted)?, wanted)?;
        Ok(seen.errors(field.first + i, frame))
    });
    errors.collect::<Result<_, Error>>().map(Some)
}

/// Without a single true box in the frames there is nothing to score.
fn scores_while(field: &ObjectField, truth: &dyn Truth, wanted: Wanted<Error>) -> Result<Option<Scores>, Error> {
    let frames = boxes_of(field, truth)?.filter(|frames| frames.iter().any(|(known, _)| !known.is_empty()));
    frames.map(|frames| Scores::of_frames(&frames, wanted)).transpose()
}

/// Returns the true boxes and those of the confirmed tracks of each frame; `None` where the truth of a frame is unknown or nothing
/// is tracked.
fn boxes_of(field: &ObjectField, truth: &dyn Truth) -> Result<Option<Vec<(Boxes, Boxes)>>, Error> {
    let counts = |id: u32| match &field.followed {
        Followed::Nothing => false,
        Followed::One(ids) => ids.contains(&id),
        Followed::All => true,
    };
    let is_anyone = match &field.followed {
        Followed::Nothing => false,
        Followed::One(ids) => !ids.is_empty(),
        Followed::All => true,
    };
    if !is_anyone {
        return Ok(None);
    }
    let mut frames = Vec::new();
    for (i, frame) in field.frames.iter().enumerate() {
        let confirmed = frame.objects.iter().filter(|object| object.status == TrackStatus::Confirmed);
        let confirmed = confirmed.map(|object| (object.id, object.bounds)).collect();
        let Some((mut known, estimates)) = scored_boxes(truth, field.first + i, confirmed)? else { return Ok(None) };
        known.retain(|(id, _)| counts(*id));
        frames.push((known, estimates));
    }
    Ok(Some(frames))
}

/// Returns the true boxes of frame `t` and the estimates that count: an estimate is left out where it matches a box that the benchmark
/// does not score better than any other, as in TrackEval's preprocessing of MOTChallenge. `None` where the truth is unknown.
///
/// # Errors
/// If the truth cannot be read.
pub(crate) fn scored_boxes(truth: &dyn Truth, t: usize, estimates: Boxes) -> Result<Option<(Boxes, Boxes)>, Error> {
    let Some(objects) = truth.objects(t)? else { return Ok(None) };
    let boxes =
        |objects: &[ObjectBox]| objects.iter().map(|object| (object.id, Bounds::from(object))).collect::<Boxes>();
    let known = boxes(&objects);
    let ignored = boxes(&truth.ignored_objects(t)?);
    if ignored.is_empty() || estimates.is_empty() {
        return Ok(Some((known, estimates)));
    }
    let frame = ([known.clone(), ignored].concat(), estimates);
    let (mut clear, go_on) = (Clear::default(), &|| Ok::<_, Infallible>(()));
    let Ok(seen) = overlaps(&frame, go_on).and_then(|overlaps| clear.see(&frame, &overlaps, go_on));
    let left_out: Vec<usize> = seen.pairs[known.len()..].iter().flatten().copied().collect();
    let counted = frame.1.into_iter().enumerate().filter(|(column, _)| !left_out.contains(column));
    Ok(Some((known, counted.map(|(_, estimate)| estimate).collect())))
}

impl Scores {
    /// Returns the scores of frames of true and estimated boxes.
    ///
    /// MOTA and MOTP: K. Bernardin and R. Stiefelhagen, Evaluating multiple object tracking performance, 2008. IDF1: E. Ristani and
    /// others, Performance measures and a data set for multi-target, multi-camera tracking, 2016. HOTA: J. Luiten and others, 2021.
    pub fn of(frames: &[(Boxes, Boxes)]) -> Self {
        let Ok(scores) = Self::of_frames(frames, &|| Ok::<_, Infallible>(()));
        scores
    }

    /// Returns the same scores, unless cancelled.
    fn of_frames<E>(frames: &[(Boxes, Boxes)], wanted: Wanted<E>) -> Result<Self, E> {
        let (tracks, mut clear) = (Tracks::of(frames), Clear::default());
        let rows = tracks.truth.ids.len();
        let (mut agree, mut shared) = (Sums::new(rows), Sums::new(rows));
        for frame in frames {
            let overlaps = overlaps(frame, wanted)?;
            clear.see(frame, &overlaps, wanted)?;
            tracks.add_agreement(frame, &overlaps, &mut agree);
            tracks.add_shared(frame, &overlaps, &mut shared);
        }
        let columns = tracks.hypotheses.ids.len();
        let aligned = tracks.aligned(&shared.pairs(columns));
        let (matched, greedy) = tracks.matched(frames, &aligned, wanted)?;
        let (agree, hota) = (agree.pairs(columns), tracks.hota(&matched));
        let identities = most_worth(&agree, &mut WorkBudget::limited(MOST_WORK, wanted))?;
        clear.greedy += greedy + identities.greedy;
        let identities = paired(&agree, &identities.columns) as usize;
        Ok(Self::from_counts([tracks.truth.total, tracks.hypotheses.total], &clear, (identities, hota)))
    }

    fn from_counts([truths, hypotheses]: [usize; 2], clear: &Clear, (identities, hota): (usize, f64)) -> Self {
        let Clear { matches, switches, overlap, greedy, .. } = *clear;
        let wrong = (truths - matches) + (hypotheses - matches) + switches;
        let [all, found] = [truths, hypotheses].map(|count| count as f64);
        Self {
            truths,
            hypotheses,
            matches,
            switches,
            mota: if truths > 0 { 1.0 - wrong as f64 / all } else { 0.0 },
            motp: share(overlap, matches as f64),
            idf1: share(2.0 * identities as f64, all + found),
            precision: share(matches as f64, found),
            recall: share(matches as f64, all),
            hota,
            greedy,
        }
    }
}

/// Returns the sum over pairs.
fn paired(numbers: &Pairs, columns: &[Option<usize>]) -> f64 {
    let pairs = columns.iter().enumerate().filter_map(|(row, column)| numbers.get(row, (*column)?));
    pairs.sum()
}

/// The matches of a frame.
struct SeenFrame {
    /// The estimated box of each true one.
    pairs: Vec<Option<usize>>,
    switches: Vec<Switch>,
}

impl SeenFrame {
    /// Returns the errors of frame `t`.
    fn errors(self, t: usize, (truth, hypotheses): &(Boxes, Boxes)) -> FrameErrors {
        let of = |is_matched: bool| {
            let boxes = truth.iter().zip(&self.pairs).filter(move |(_, pair)| pair.is_some() == is_matched);
            boxes.map(|(found, _)| *found).collect()
        };
        let mut is_free = vec![true; hypotheses.len()];
        self.pairs.iter().flatten().for_each(|x| is_free[*x] = false);
        FrameErrors {
            frame: t,
            matches: of(true),
            misses: of(false),
            false_alarms: hypotheses
                .iter()
                .zip(is_free)
                .filter(|(_, is_free)| *is_free)
                .map(|(found, _)| *found)
                .collect(),
            switches: self.switches,
        }
    }
}

/// The counts of CLEAR MOT.
#[derive(Default)]
struct Clear {
    matches: usize,
    switches: usize,
    overlap: f64,
    /// True objects matched greedily.
    greedy: usize,
    /// The last matched track of each true object.
    found_as: BTreeMap<u32, u32>,
}

impl Clear {
    /// Adds a frame. Matches of the previous frame are kept where possible; the others are assigned anew.
    fn see<E>(
        &mut self,
        (truth, hypotheses): &(Boxes, Boxes),
        overlaps: &Pairs,
        wanted: Wanted<E>,
    ) -> Result<SeenFrame, E> {
        let mut first: BTreeMap<u32, usize> = BTreeMap::new();
        hypotheses.iter().enumerate().for_each(|(x, (id, _))| _ = first.entry(*id).or_insert(x));
        let (mut pairs, mut is_taken) = (vec![None; truth.len()], vec![false; hypotheses.len()]);
        for (y, (id, _)) in truth.iter().enumerate() {
            // Two true objects may have matched one track before: the first keeps it.
            let same = self.found_as.get(id).and_then(|other| first.get(other)).copied();
            let is_found = |x: &usize| overlaps.get(y, *x).is_some_and(|overlap| overlap >= MATCH_IOU);
            pairs[y] = same.filter(|x| is_found(x) && !std::mem::replace(&mut is_taken[*x], true));
        }
        let free = overlaps.filter_map(|y, x, overlap| {
            (pairs[y].is_none() && !is_taken[x] && overlap >= MATCH_IOU).then_some(1.0 - overlap)
        });
        let new = least_cost(&free, &mut WorkBudget::limited(MOST_WORK, wanted))?;
        self.greedy += new.greedy;
        for (pair, new) in pairs.iter_mut().zip(new.columns) {
            *pair = pair.or(new);
        }
        let mut switches = Vec::new();
        for (y, x) in pairs.iter().enumerate().filter_map(|(y, x)| Some((y, (*x)?))) {
            let ((object, bounds), now) = (truth[y], hypotheses[x].0);
            let before = self.found_as.insert(object, now).filter(|before| *before != now);
            switches.extend(before.map(|before| Switch { object, before, now, bounds }));
            self.matches += 1;
            self.overlap += overlaps.get(y, x).unwrap_or_default();
        }
        self.switches += switches.len();
        Ok(SeenFrame { pairs, switches })
    }
}

/// The identities of all frames, in order, with their numbers of boxes.
struct Identities {
    ids: Vec<u32>,
    counts: Vec<f64>,
    total: usize,
}

impl Identities {
    fn of<'a>(frames: impl Iterator<Item = &'a Boxes>) -> Self {
        let (mut counts, mut total) = (BTreeMap::<u32, f64>::new(), 0);
        for (id, _) in frames.flatten() {
            *counts.entry(*id).or_default() += 1.0;
            total += 1;
        }
        let (ids, counts) = counts.into_iter().unzip();
        Self { ids, counts, total }
    }

    /// Returns the indices of the objects of a frame.
    fn places(&self, boxes: &Boxes) -> Vec<usize> {
        boxes.iter().map(|(id, _)| self.ids.partition_point(|other| other < id)).collect()
    }
}

/// All true and all estimated tracks.
struct Tracks {
    truth: Identities,
    hypotheses: Identities,
}

/// A match in a frame: the true and the estimated track, and their IoU.
type Matched = ((usize, usize), f64);

impl Tracks {
    fn of(frames: &[(Boxes, Boxes)]) -> Self {
        let truth = Identities::of(frames.iter().map(|(truth, _)| truth));
        Self { truth, hypotheses: Identities::of(frames.iter().map(|(_, hypotheses)| hypotheses)) }
    }

    fn places(&self, (truth, hypotheses): &(Boxes, Boxes)) -> [Vec<usize>; 2] {
        [self.truth.places(truth), self.hypotheses.places(hypotheses)]
    }

    /// Counts the tracks that agree in a frame.
    fn add_agreement(&self, frame: &(Boxes, Boxes), overlaps: &Pairs, agree: &mut Sums) {
        let [rows, columns] = self.places(frame);
        for (y, x, _) in overlaps.iter().filter(|(.., overlap)| *overlap >= MATCH_IOU) {
            agree.add((rows[y], columns[x]), 1.0);
        }
    }

    /// Adds the similarity of tracks in a frame, normalised over all that overlap there.
    fn add_shared(&self, frame: &(Boxes, Boxes), overlaps: &Pairs, shared: &mut Sums) {
        let [rows, columns] = self.places(frame);
        let (mut of_truth, mut of_hypothesis) = (vec![0.0; rows.len()], vec![0.0; columns.len()]);
        for (y, x, overlap) in overlaps.iter() {
            of_truth[y] += overlap;
            of_hypothesis[x] += overlap;
        }
        for (y, x, overlap) in overlaps.iter() {
            shared.add((rows[y], columns[x]), share(overlap, of_truth[y] + of_hypothesis[x] - overlap));
        }
    }

    /// Returns the alignment of two tracks over the whole clip.
    fn aligned(&self, shared: &Pairs) -> Pairs {
        shared.map(|y, x, both| share(both, self.truth.counts[y] + self.hypotheses.counts[x] - both))
    }

    /// Returns the matches of each frame for all thresholds, by global alignment times IoU, and the number matched greedily.
    fn matched<E>(
        &self,
        frames: &[(Boxes, Boxes)],
        aligned: &Pairs,
        wanted: Wanted<E>,
    ) -> Result<(Vec<Matched>, usize), E> {
        let (mut matched, mut greedy) = (Vec::new(), 0);
        for frame in frames {
            let ([rows, columns], overlaps) = (self.places(frame), overlaps(frame, wanted)?);
            let worth = overlaps.map(|y, x, overlap| aligned.get(rows[y], columns[x]).unwrap_or_default() * overlap);
            let pairs = most_worth(&worth, &mut WorkBudget::limited(MOST_WORK, wanted))?;
            greedy += pairs.greedy;
            let pairs = pairs.columns.into_iter().enumerate().filter_map(|(y, x)| Some((y, x?)));
            matched.extend(pairs.map(|(y, x)| ((rows[y], columns[x]), overlaps.get(y, x).unwrap_or_default())));
        }
        matched.sort_by_key(|(place, _)| *place);
        Ok((matched, greedy))
    }

    /// Returns HOTA from the matches by tracks.
    fn hota(&self, matched: &[Matched]) -> f64 {
        let all = (self.truth.total + self.hypotheses.total) as f64;
        let of_limit = |limit: f64| {
            let (mut hits, mut association) = (0.0, 0.0);
            for of_pair in matched.chunk_by(|a, b| a.0 == b.0) {
                let count = of_pair.iter().filter(|(_, overlap)| *overlap >= limit - 1e-9).count() as f64;
                let (y, x) = of_pair[0].0;
                hits += count;
                association += count * share(count, self.truth.counts[y] + self.hypotheses.counts[x] - count);
            }
            (share(hits, all - hits) * share(association, hits)).sqrt()
        };
        (1..20).map(|i| of_limit(f64::from(i) * 0.05)).sum::<f64>() / 19.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(id: u32, x: f32) -> (u32, Bounds) {
        (id, Bounds { min: [x, 0.0], max: [x + 10.0, 10.0] })
    }

    #[test]
    fn the_errors_of_a_frame_are_those_that_are_counted() {
        // Object 1 is lost for a frame and found as another track; 9 is no object.
        let hypotheses = [vec![at(5, 0.0), at(9, 80.0)], vec![at(9, 80.0)], vec![at(6, 2.0)]];
        let frames: Vec<(Boxes, Boxes)> =
            hypotheses.into_iter().enumerate().map(|(t, hypotheses)| (vec![at(1, t as f32)], hypotheses)).collect();
        let (mut clear, go_on) = (Clear::default(), &|| Ok::<_, Infallible>(()));
        let errors: Vec<FrameErrors> = frames
            .iter()
            .enumerate()
            .map(|(t, frame)| {
                let Ok(seen) = overlaps(frame, go_on).and_then(|overlaps| clear.see(frame, &overlaps, go_on));
                seen.errors(t, frame)
            })
            .collect();
        let ids = |boxes: &Boxes| boxes.iter().map(|(id, _)| *id).collect::<Vec<_>>();
        let of = |errors: &FrameErrors| [&errors.matches, &errors.misses, &errors.false_alarms].map(ids);
        assert_eq!(of(&errors[0]), [vec![1], vec![], vec![9]]);
        assert_eq!(of(&errors[1]), [vec![], vec![1], vec![9]]);
        assert_eq!(of(&errors[2]), [vec![1], vec![], vec![]]);
        let switch = errors[2].switches[0];
        assert_eq!((switch.object, switch.before, switch.now), (1, 5, 6));
        let scores = Scores::of(&frames);
        let sum = |of: fn(&FrameErrors) -> usize| errors.iter().map(of).sum::<usize>();
        assert_eq!(scores.truths - scores.matches, sum(|of| of.misses.len()));
        assert_eq!(scores.hypotheses - scores.matches, sum(|of| of.false_alarms.len()));
        assert_eq!(scores.switches, sum(|of| of.switches.len()));
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
    fn matches_of_frames_add_up_to_precision_recall_and_f1() {
        let frames = [
            (vec![at(1, 0.0), at(2, 40.0)], vec![at(7, 1.0)]),
            (vec![at(1, 0.0)], vec![at(7, 0.0), at(8, 20.0), at(9, 60.0)]),
        ];
        let all = frames.iter().map(Matches::of).fold(Matches::default(), Matches::and);
        assert_eq!(all, Matches { truths: 3, estimates: 4, pairs: 2 });
        assert_eq!((all.misses(), all.false_positives()), (1, 2));
        assert_eq!((all.precision(), all.recall(), all.f1()), (Some(0.5), Some(2.0 / 3.0), Some(4.0 / 7.0)));
        // Undefined is not zero.
        let none = Matches::default();
        assert_eq!((none.precision(), none.recall(), none.f1()), (None, None, None));
        let alarm = Matches { estimates: 1, ..none };
        assert_eq!((alarm.precision(), alarm.recall(), alarm.f1()), (Some(0.0), None, Some(0.0)));
    }

    #[test]
    fn no_estimates_and_no_truth_are_no_division_by_zero() {
        let missed: Vec<(Boxes, Boxes)> = vec![(vec![at(1, 0.0)], vec![]); 3];
        let scores = Scores::of(&missed);
        assert_eq!((scores.mota, scores.idf1, scores.hota, scores.precision), (0.0, 0.0, 0.0, 0.0));
        let alarms: Vec<(Boxes, Boxes)> = vec![(vec![], vec![at(1, 0.0)]); 3];
        assert_eq!(Scores::of(&alarms).idf1, 0.0);
        assert!(Scores::of(&[]).hota.is_sign_positive() && scores.hota.is_sign_positive(), "no −0");
    }

    #[test]
    fn an_identity_switch_lowers_each_score() {
        let frames: Vec<_> = (0..10).map(|t| (vec![at(1, 0.0)], vec![at(if t < 5 { 7 } else { 8 }, 0.0)])).collect();
        let scores = Scores::of(&frames);
        assert_eq!((scores.switches, scores.mota), (1, 0.9));
        assert_eq!(scores.idf1, 0.5, "half of all frames belong to the better half");
        // DetA is 1; each half is associated to 5 of 10: AssA is ½.
        assert!((scores.hota - 0.5_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn no_track_is_matched_twice() {
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
