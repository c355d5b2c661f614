//! The nearest neighbours of a descriptor, and the tests of the nearest.

use crate::base::Observer;
use crate::base::wide::wide;
use crate::products::keypoints::{Descriptor, Keypoint};
use crate::products::{Match, MatchStatus};

use super::Described;

/// An event of the comparison of a keypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The number of candidates within the search radius.
    Candidates(usize),
    /// A candidate nearer than all before it.
    Nearer {
        /// The index of the candidate.
        index: usize,
        /// Its distance.
        distance: f32,
    },
    /// The nearest and the second nearest neighbour were found.
    Found(Neighbors),
    /// The ratio of both distances is compared with its limit.
    Ratio {
        /// The ratio; none where both distances are 0.
        ratio: Option<f32>,
        /// Whether it passes.
        passes: bool,
    },
    /// The nearest neighbour of the nearest neighbour is compared with the keypoint.
    CrossCheck {
        /// The index of that keypoint.
        back: usize,
        /// Whether it is the keypoint from which the search began.
        passes: bool,
    },
    /// The outcome.
    Outcome(Option<Outcome>),
}

/// The nearest neighbours of a descriptor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Neighbors {
    /// Index and distance of the nearest.
    pub first: Option<(usize, f32)>,
    /// Index and distance of the second nearest.
    pub second: Option<(usize, f32)>,
}

impl Neighbors {
    /// The ratio of both distances; none without a second neighbour, and undefined where both distances are 0.
    pub fn ratio(&self) -> Option<f32> {
        let ((_, first), (_, second)) = (self.first?, self.second?);
        (second > 0.0).then(|| first / second)
    }
}

/// The outcome of the comparison of a keypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The neighbours.
    pub neighbors: Neighbors,
    /// The index of the nearest.
    pub index: usize,
    /// Its distance.
    pub distance: f32,
    /// The result of the tests.
    pub status: MatchStatus,
}

impl Outcome {
    /// The match of keypoint `index` of `here` with its nearest neighbour in `there`.
    pub fn matched(&self, here: &Described, index: usize, there: &Described) -> Match {
        Match {
            from: here.points[index].at,
            to: there.points[self.index].at,
            distance: self.distance,
            ratio: self.neighbors.ratio(),
            status: self.status,
        }
    }
}

/// The keypoints of frame t + 1 with their descriptors, of which those within a radius are candidates.
pub struct Candidates<'a> {
    /// The keypoints of both frames.
    pub sides: [&'a Described; 2],
    /// Largest distance of positions in px; `None` for any.
    pub radius_px: Option<f32>,
    /// Largest accepted ratio of the distances of the nearest and the second nearest neighbour; 1 accepts all.
    pub ratio: f32,
    /// Whether the nearest neighbour must have the keypoint as its own.
    pub cross_check: bool,
    /// A further condition on a pair of positions in frames t and t + 1, for guided matching.
    pub admits: Option<&'a Admits<'a>>,
}

/// A condition on a pair of positions in frames t and t + 1.
pub type Admits<'a> = dyn Fn([f32; 2], [f32; 2]) -> bool + Sync + 'a;

impl Candidates<'_> {
    /// Whether two positions are within the radius.
    fn is_near(&self, a: [f32; 2], b: [f32; 2]) -> bool {
        self.radius_px.is_none_or(|radius| (a[0] - b[0]).hypot(a[1] - b[1]) <= radius)
    }

    /// The nearest neighbours of keypoint `index` of side `from` on the other side; calls `tell` with each that is nearer than all
    /// before it. Of equal distances the first counts.
    pub fn nearest(&self, (from, index): (usize, usize), mut tell: impl FnMut(usize, f32)) -> (Neighbors, usize) {
        let [here, there] = [self.sides[from], self.sides[1 - from]];
        let (at, descriptor) = (here.points[index].at, &here.keypoints[index].descriptor);
        let (mut found, mut count) = (Neighbors::default(), 0);
        let Some(descriptor) = descriptor else { return (found, count) };
        for (i, keypoint) in there.keypoints.iter().enumerate() {
            let other = there.points[i].at;
            let [first, second] = if from == 0 { [at, other] } else { [other, at] };
            if !self.is_near(at, other) || self.admits.is_some_and(|admits| !admits(first, second)) {
                continue;
            }
            let Some(distance) = distance(descriptor, keypoint) else { continue };
            count += 1;
            let is_less = |than: Option<(usize, f32)>| than.is_none_or(|(_, than)| distance < than);
            if is_less(found.first) {
                (found.second, found.first) = (found.first, Some((i, distance)));
                tell(i, distance);
            } else if is_less(found.second) {
                found.second = Some((i, distance));
            }
        }
        (found, count)
    }

    /// Compares keypoint `index` of frame t with its candidates; `None` if it has none.
    pub fn compare(&self, index: usize, observer: &mut impl Observer<Event>) -> Option<Outcome> {
        let (neighbors, count) = self.nearest((0, index), |index, distance| {
            observer.see(|| Event::Nearer { index, distance });
        });
        observer.see(|| Event::Candidates(count));
        observer.see(|| Event::Found(neighbors));
        let outcome = neighbors.first.map(|(nearest, distance)| {
            let status = self.judge(index, nearest, &neighbors, observer);
            Outcome { neighbors, index: nearest, distance, status }
        });
        observer.see(|| Event::Outcome(outcome));
        outcome
    }

    fn judge(&self, index: usize, nearest: usize, of: &Neighbors, observer: &mut impl Observer<Event>) -> MatchStatus {
        if self.ratio < 1.0 && of.second.is_some() {
            // Of two exact matches neither is nearer.
            let ratio = of.ratio();
            let passes = ratio.is_some_and(|ratio| ratio < self.ratio);
            observer.see(|| Event::Ratio { ratio, passes });
            if !passes {
                return MatchStatus::RejectedRatio;
            }
        }
        if self.cross_check {
            let back = self.nearest((1, nearest), |_, _| {}).0.first.map_or(index, |(back, _)| back);
            observer.see(|| Event::CrossCheck { back, passes: back == index });
            if back != index {
                return MatchStatus::RejectedCrossCheck;
            }
        }
        MatchStatus::Match
    }
}

fn distance(descriptor: &Descriptor, other: &Keypoint) -> Option<f32> {
    match (descriptor, other.descriptor.as_ref()?) {
        (Descriptor::Reals(a), Descriptor::Reals(b)) if a.len() == b.len() => Some(squared(a, b).sqrt()),
        (a, b) => a.distance(b),
    }
}

wide! {
    fn squared(a: &[f32], b: &[f32]) -> f32 = squared_body
}

/// The sum of squared differences, in lanes that the compiler keeps in registers.
#[inline(always)]
fn squared_body(a: &[f32], b: &[f32]) -> f32 {
    const LANES: usize = 32;
    let (chunks, others) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0f32; LANES];
    for (a, b) in chunks.0.iter().zip(others.0) {
        for i in 0..LANES {
            let difference = a[i] - b[i];
            sums[i] += difference * difference;
        }
    }
    let rest = chunks.1.iter().zip(others.1).map(|(a, b)| (a - b) * (a - b));
    sums.iter().copied().chain(rest).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::products::Feature;

    fn described(all: &[([f32; 2], [f32; 2])]) -> Described {
        let point = |at| Feature::found(at);
        let keypoint = |values: [f32; 2]| Keypoint {
            descriptor: Some(Descriptor::Reals(values.to_vec().into())),
            ..Keypoint::default()
        };
        Described {
            points: all.iter().map(|(at, _)| point(*at)).collect(),
            keypoints: all.iter().map(|(_, values)| keypoint(*values)).collect(),
        }
    }

    #[test]
    fn tests_reject_what_is_ambiguous_and_what_has_a_nearer_partner() {
        let here = described(&[([0.0, 0.0], [0.0, 0.0]), ([5.0, 0.0], [10.0, 0.0]), ([9.0, 0.0], [9.0, 0.0])]);
        let there = described(&[([1.0, 0.0], [0.0, 1.0]), ([0.0, 1.0], [1.0, 0.0]), ([6.0, 0.0], [10.5, 0.0])]);
        let candidates =
            Candidates { sides: [&here, &there], radius_px: None, ratio: 0.8, cross_check: true, admits: None };
        let status = |candidates: &Candidates, index| candidates.compare(index, &mut ()).map(|found| found.status);
        assert_eq!(status(&candidates, 0), Some(MatchStatus::RejectedRatio), "two are equally near");
        assert_eq!(status(&candidates, 1), Some(MatchStatus::Match));
        assert_eq!(status(&candidates, 2), Some(MatchStatus::RejectedCrossCheck), "1 is nearer to 2");
        let near = Candidates { radius_px: Some(2.0), ..candidates };
        assert_eq!(status(&near, 2), None);
        let free = Candidates { ratio: 1.0, cross_check: false, radius_px: None, ..near };
        assert_eq!(status(&free, 0), Some(MatchStatus::Match));
    }

    #[test]
    fn the_distance_is_euclidean_for_any_length() {
        for length in [1, 31, 32, 121, 128] {
            let [a, b]: [Vec<f32>; 2] = [7, 13].map(|k| (0..length).map(|i| ((i * k + 5) % 17) as f32).collect());
            let plain: f32 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
            assert!((squared(&a, &b) - plain).abs() <= 1e-5 * plain.max(1.0), "{length}");
        }
    }
}
