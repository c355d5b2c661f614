//! The explanation and the drawing of feature matching.

use super::{Event, FeatureMatching, State, case, features, line, value};
use crate::methods::differential::explain;
use crate::methods::matching::{Event as Compared, Neighbors, Outcome};
use crate::products::keypoints::{Descriptor, Keypoint, WINDOW_SIGMAS};
use crate::products::{Match, MatchField, MatchStatus};
use crate::run::Seen;
use crate::scene::{Link, Picture, Readout, Role, Scene, Series, Shape, Step, Tile};

/// Number of ratio limits in the plot of precision.
const LIMITS: usize = 20;

impl FeatureMatching {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let [here, there] = state.fixed.pair.sides.each_ref().map(|side| side.points.len());
        let is_end = seen.after.is_some_and(|after| after.found.len() >= after.count());
        let step = match seen.events.last() {
            None => {
                let step = Step::at(line::DETECT).put(features::KEYPOINTS, here).put(value::KEYPOINTS_THERE, there);
                return step.say(case::OPENING);
            }
            Some(Event::Nothing) => Step::at(line::EACH_KEYPOINT).say(case::NO_KEYPOINTS),
            Some(Event::Of(event)) => self.compared(seen, *event, is_end),
        };
        if is_end { self.concluded(seen.after.unwrap_or(state), step) } else { step }
    }

    /// Explains an event of the comparison of a keypoint.
    fn compared(&self, seen: &Seen<Self>, event: Compared, is_end: bool) -> Step {
        let (state, index) = (seen.before, seen.before.found.len());
        let [here, there] = state.fixed.pair.sides.each_ref();
        let line = match event {
            Compared::Nearer { .. } => line::EACH_CANDIDATE,
            Compared::Candidates(_) => line::EACH_KEYPOINT,
            Compared::Found(_) => line::KEEP_NEAREST,
            Compared::Ratio { .. } => line::RATIO_TEST,
            Compared::CrossCheck { .. } => line::CROSS_CHECK,
            Compared::Outcome(outcome) => match outcome.map(|outcome| outcome.status) {
                None => line::KEEP_NEAREST,
                Some(MatchStatus::RejectedRatio) => line::RATIO_TEST,
                Some(MatchStatus::RejectedCrossCheck) => line::CROSS_CHECK,
                Some(MatchStatus::Match | MatchStatus::Outlier) => line::ACCEPT,
            },
        };
        let neighbors = neighbors(seen);
        let step = Step::at(line).fact(features::KEYPOINT, index + 1).fact(features::KEYPOINTS, here.points.len());
        let step = self.measured(step.fact(features::POSITION, here.points[index].at), &neighbors, state);
        let is_near = self.settings.radius > 0;
        let step = match event {
            Compared::Nearer { index, distance } => {
                step.put(value::CANDIDATE, there.points[index].at).put(value::DISTANCE, distance).say(case::NEARER)
            }
            Compared::Candidates(count) => step.put(value::CANDIDATES, count).say(match (count, is_near) {
                (0, false) => case::NO_CANDIDATE,
                (0, true) => case::NO_CANDIDATE_NEAR,
                (_, false) => case::COMPARED,
                (_, true) => case::COMPARED_NEAR,
            }),
            Compared::Found(Neighbors { first, second }) => step.say(match (first, second) {
                (Some(_), Some(_)) => case::TWO,
                (Some(_), None) => case::ONE,
                _ => case::NONE,
            }),
            Compared::Ratio { ratio: None, .. } => {
                step.say(case::IS_UNDEFINED).say(case::IS_NOT_BELOW).say(case::EQUAL)
            }
            Compared::Ratio { passes: true, .. } => step.say(case::MEASURED).say(case::IS_BELOW),
            Compared::Ratio { .. } => step.say(case::MEASURED).say(case::IS_NOT_BELOW).say(case::ALIKE),
            Compared::CrossCheck { passes: true, .. } => step.say(case::MUTUAL),
            Compared::CrossCheck { back, .. } => step.put(value::BACK, here.points[back].at).say(case::NOT_MUTUAL),
            Compared::Outcome(None) => step.say(case::NO_OUTCOME),
            Compared::Outcome(Some(outcome)) => self.decided(step, state, &outcome),
        };
        if is_end {
            let after = seen.after.unwrap_or(state);
            return step.show_all([distances(after), self.precision(after)].into_iter().flatten().map(Readout::Series));
        }
        let other = neighbors.first.map(|(index, _)| &there.keypoints[index]);
        let step = match (neighbors.second, neighbors.ratio()) {
            (None, _) => step,
            (_, Some(_)) => step.formula(r"\frac{d_1}{d_2} = \frac{{d_1}}{{d_2}} = {ratio}"),
            (_, None) => step.formula(r"\frac{d_1}{d_2} = \frac{{d_1}}{{d_2}}\text{ is undefined}"),
        };
        let step = step.show(Readout::Tiles(self.tiles(state, index, &neighbors)));
        step.show_all(descriptors(&here.keypoints[index], other).map(Readout::Series))
    }

    /// Puts the neighbours of a keypoint that are known, and the limits of the tests.
    fn measured(&self, step: Step, neighbors: &Neighbors, state: &State) -> Step {
        let at = |index: usize| state.fixed.pair.sides[1].points[index].at;
        let Neighbors { first, second } = neighbors;
        let step = step.fact_if(value::NEAREST, first.map(|(index, _)| at(index)));
        let step = step.fact_if(value::D_1, first.map(|(_, distance)| distance));
        let step = step.fact_if(value::SECOND, second.map(|(index, _)| at(index)));
        let step = step.fact_if(value::D_2, second.map(|(_, distance)| distance));
        let step = neighbors.ratio().into_iter().fold(step, |step, ratio| step.put(value::RATIO, ratio));
        let accepted = state.found.iter().flatten().filter(|outcome| outcome.status == MatchStatus::Match).count();
        let step = step.fact(value::MATCHES, accepted).put(value::LIMIT, self.settings.ratio);
        step.put(value::RADIUS, self.settings.radius)
    }

    /// Explains the outcome of the tests.
    fn decided(&self, step: Step, state: &State, outcome: &Outcome) -> Step {
        let found = state.match_of(state.found.len(), outcome);
        let step = step.put(value::DISPLACEMENT, found.displacement());
        let step = step.say(match found.status {
            MatchStatus::Match => case::MATCH,
            MatchStatus::RejectedRatio => case::FAILS_RATIO,
            _ => case::FAILS_CROSS_CHECK,
        });
        let is_right = state.fixed.truth.as_ref().and_then(|truth| MatchField::is_right(&found, truth));
        let step = step.say(match (is_right, found.status) {
            (Some(true), MatchStatus::Match) => case::IS_RIGHT,
            (Some(false), MatchStatus::Match) => case::IS_WRONG,
            (Some(true), _) => case::WAS_RIGHT,
            (Some(false), _) => case::WAS_WRONG,
            (None, _) => case::IS_UNKNOWN,
        });
        step.say_if(outcome.neighbors.second.is_none() && self.settings.ratio < 1.0, case::WAS_ALONE)
    }

    /// Adds the conclusion at the end of a run.
    fn concluded(&self, state: &State, step: Step) -> Step {
        let (all, limit): (Vec<Match>, f32) = (state.matches().collect(), self.settings.ratio);
        if state.count() == 0 {
            return step.say(case::NO_MATCHES);
        }
        let accepted = || all.iter().filter(|found| found.status == MatchStatus::Match);
        let count = |status| all.iter().filter(|found| found.status == status).count();
        let rejected = count(MatchStatus::RejectedRatio);
        let step = step.put(value::MATCHES, accepted().count()).put(value::REJECTED_BY_RATIO, rejected);
        let step = step.put(value::REJECTED_BY_CROSS_CHECK, count(MatchStatus::RejectedCrossCheck)).say(case::END);
        let untested = accepted().filter(|found| found.ratio.is_none()).count();
        let step = step.put(value::UNTESTED, untested);
        let step = match untested {
            _ if limit >= 1.0 => step,
            0 => step,
            1 => step.say(case::ONE_UNTESTED),
            _ => step.say(case::SOME_UNTESTED),
        };
        let errors = state.fixed.truth.as_ref().map(|truth| MatchField::compare(accepted(), truth));
        let step = match errors.and_then(|errors| Some((errors.precision()?, errors))) {
            Some((precision, errors)) => {
                let step = step.put(value::RIGHT, errors.right).put(value::KNOWN, errors.known);
                let step = step.put(value::PRECISION, 100.0 * precision).say(case::QUALITY);
                step.say_if(state.fixed.is_of_plane && errors.right < errors.known, case::OFF_PLANE)
            }
            None => step,
        };
        match (accepted().count(), rejected) {
            (0, 0) => step.say_if(state.fixed.pair.sides[1].points.is_empty(), case::NOTHING_THERE),
            (0, _) => match all.iter().filter_map(|found| found.ratio).reduce(f32::min) {
                Some(least) => step.put(value::SMALLEST_RATIO, least).say(case::RAISE_LIMIT),
                None => step.say(case::ALL_UNDEFINED),
            },
            _ => step.say(if limit >= 1.0 { case::SET_LIMIT } else { case::LOWER_LIMIT }),
        }
    }

    /// Precision and share of the nearest neighbours that limits of the ratio accept, where the truth is known; else the share alone.
    fn precision(&self, state: &State) -> Option<Series> {
        let is_tested = |found: &Match| found.ratio.is_some() || found.status == MatchStatus::RejectedRatio;
        let all: Vec<Match> = state.matches().filter(is_tested).collect();
        if all.is_empty() {
            return None;
        }
        let mut limits: Vec<f32> = (0..=LIMITS).map(|i| 0.5 + 0.5 * i as f32 / LIMITS as f32).collect();
        limits.retain(|limit| *limit != self.settings.ratio);
        limits.insert(limits.partition_point(|limit| *limit < self.settings.ratio), self.settings.ratio);
        let (mut shares, mut precisions) = (Vec::new(), Vec::new());
        for limit in limits {
            let accepted = || all.iter().filter(|found| found.ratio.is_some_and(|ratio| ratio < limit));
            shares.push([limit, accepted().count() as f32 / all.len() as f32]);
            let truth = state.fixed.truth.as_ref();
            let precision = truth.and_then(|truth| MatchField::compare(accepted(), truth).precision());
            precisions.push([limit, precision.map_or(f32::NAN, |share| share as f32)]);
        }
        let mut lines = vec![("accepted", Role::Reference, shares)];
        if precisions.iter().any(|point| point[1].is_finite()) {
            lines.push(("precision: right of accepted", Role::Result, precisions));
        }
        Some(Series {
            title: "Ratio test",
            x_label: "ratio limit",
            y_label: "share",
            x_max: 1,
            lines,
            is_sweep: true,
            chosen: Some(self.settings.ratio),
            ..Series::default()
        })
    }

    /// The neighbourhoods of the keypoint and of its neighbours.
    fn tiles(&self, state: &State, index: usize, neighbors: &Neighbors) -> Vec<Tile> {
        let reach = self.settings.reach().min(7);
        let tile = |side: usize, index: usize, label, role| {
            let luma = state.fixed.pair.frames[side].luma();
            let place = luma.cell_at(state.fixed.pair.sides[side].points[index].at)?;
            Some(Tile {
                label,
                role: Some(role),
                values: explain::around(luma, place, reach),
                range: [0.0, 255.0],
                framed: Vec::new(),
            })
        };
        let first = neighbors.first.and_then(|(index, _)| tile(1, index, "Nearest", Role::Best));
        let second = neighbors.second.and_then(|(index, _)| tile(1, index, "Second nearest", Role::Rejected));
        [tile(0, index, "Keypoint", Role::Reference), first, second].into_iter().flatten().collect()
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let [here, there] = state.fixed.pair.sides.each_ref();
        let is_end = seen.after.is_some_and(|after| after.found.len() >= after.count());
        let alone = if is_end { "keypoint without a match: rejected" } else { "keypoint; second nearest" };
        for (on, side) in [(Picture::CURRENT, here), (Picture::NEXT, there)] {
            let points: Vec<_> = side.points.iter().map(|point| point.at).collect();
            if !points.is_empty() {
                scene.mark(on, Role::Rejected, Shape::Points(points));
                scene.legend(Role::Rejected, alone);
            }
        }
        let shown = seen.after.unwrap_or(state);
        let truth = state.fixed.truth.as_deref();
        for found in shown.matches().filter(|found| found.status == MatchStatus::Match) {
            let (role, meaning) = match truth.map(|truth| MatchField::is_right(&found, truth)) {
                Some(Some(true)) if is_end => (Role::Best, "correct match"),
                Some(Some(true)) => (Role::Best, "correct match; nearest"),
                Some(Some(false)) => (Role::Error, "wrong match"),
                Some(None) => (Role::Result, "match, true displacement unknown"),
                None => (Role::Result, "match"),
            };
            scene.links.push(link(role, found.from, found.to));
            scene.legend(role, meaning);
        }
        if !is_end {
            self.draw_current(seen, scene);
        }
    }

    fn draw_current(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        let [here, there] = state.fixed.pair.sides.each_ref();
        let index = state.found.len();
        let (Some(point), false) = (here.points.get(index), seen.events.is_empty()) else { return };
        self.draw_keypoint((Picture::CURRENT, Role::Reference), point.at, &here.keypoints[index], scene);
        scene.legend(Role::Reference, "keypoint compared");
        if self.settings.radius > 0 {
            let radii = [self.settings.radius as f32; 2];
            scene.mark(Picture::NEXT, Role::Predicted, Shape::Ellipse { center: point.at, radii, angle_rad: 0.0 });
            scene.legend(Role::Predicted, "search radius");
        }
        let mut candidate = |index: usize, role, meaning| {
            let to = there.points[index].at;
            self.draw_keypoint((Picture::NEXT, role), to, &there.keypoints[index], scene);
            scene.links.push(link(role, point.at, to));
            scene.legend(role, meaning);
        };
        for event in seen.events {
            match event {
                Event::Of(Compared::Found(Neighbors { first, second })) => {
                    if let Some((index, _)) = second {
                        candidate(*index, Role::Rejected, "keypoint; second nearest");
                    }
                    if let Some((index, _)) = first {
                        candidate(*index, Role::Best, "nearest");
                    }
                }
                Event::Of(Compared::Nearer { index, .. })
                    if std::ptr::eq(event, seen.events.last().unwrap_or(event)) =>
                {
                    candidate(*index, Role::Candidate, "nearest so far");
                }
                _ => {}
            }
        }
    }

    /// A circle as large as the described neighbourhood, or the square of a patch.
    fn draw_keypoint(&self, (on, role): (Picture, Role), at: [f32; 2], keypoint: &Keypoint, scene: &mut Scene) {
        let shape = match keypoint.scale_px {
            Some(scale) => Shape::Ellipse { center: at, radii: [WINDOW_SIGMAS / 2.0 * scale; 2], angle_rad: 0.0 },
            None => {
                let reach = self.settings.reach() as f32 + 0.5;
                Shape::Rect { min: at.map(|c| c - reach), max: at.map(|c| c + reach) }
            }
        };
        scene.mark(on, role, shape);
    }
}

fn link(role: Role, from: [f32; 2], to: [f32; 2]) -> Link {
    Link { role, ends: [(Picture::CURRENT, from), (Picture::NEXT, to)] }
}

/// The neighbours of the keypoint found so far.
fn neighbors(seen: &Seen<FeatureMatching>) -> Neighbors {
    let found = seen.events.iter().rev().find_map(|event| match event {
        Event::Of(Compared::Found(neighbors)) => Some(*neighbors),
        _ => None,
    });
    let nearer = seen.events.iter().rev().find_map(|event| match event {
        Event::Of(Compared::Nearer { index, distance }) => Some((*index, *distance)),
        _ => None,
    });
    found.unwrap_or(Neighbors { first: nearer, second: None })
}

/// The entries of two descriptors of real values.
fn descriptors(keypoint: &Keypoint, other: Option<&Keypoint>) -> Option<Series> {
    let entries = |keypoint: &Keypoint| match keypoint.descriptor.as_ref()? {
        Descriptor::Reals(values) => {
            Some(values.iter().enumerate().map(|(i, v)| [(i + 1) as f32, *v]).collect::<Vec<_>>())
        }
        Descriptor::Bits(_) => None,
    };
    let own = entries(keypoint)?;
    let x_max = own.len();
    let mut lines = vec![("a, of the keypoint", Role::Reference, own)];
    lines.extend(other.and_then(entries).map(|values| ("b, of the nearest", Role::Best, values)));
    Some(Series {
        title: "Descriptors",
        x_label: "entry",
        y_label: "value",
        x_max,
        lines,
        is_sweep: true,
        fits_values: true,
        ..Series::default()
    })
}

/// Bins of the histogram of distances.
const BINS: usize = 16;

/// The histogram of the distances of all nearest neighbours: of right and of wrong ones where the truth is known.
fn distances(state: &State) -> Option<Series> {
    let all: Vec<Match> = state.matches().collect();
    let most = all.iter().map(|found| found.distance).fold(0.0, f32::max);
    if all.len() < 2 || most <= 0.0 {
        return None;
    }
    let line = |is_counted: &dyn Fn(&Match) -> bool| {
        let mut counts = [0.0f32; BINS];
        for found in all.iter().filter(|found| is_counted(found)) {
            counts[((found.distance / most * BINS as f32) as usize).min(BINS - 1)] += 1.0;
        }
        let middle = |i: usize| (i as f32 + 0.5) / BINS as f32 * most;
        counts.iter().enumerate().map(|(i, count)| [middle(i), *count]).collect::<Vec<_>>()
    };
    let lines = match state.fixed.truth.as_deref() {
        Some(truth) => vec![
            ("right", Role::Best, line(&|found| MatchField::is_right(found, truth) == Some(true))),
            ("wrong", Role::Error, line(&|found| MatchField::is_right(found, truth) == Some(false))),
        ],
        None => vec![("nearest neighbours", Role::Reference, line(&|_| true))],
    };
    Some(Series {
        title: "Distances of nearest neighbours",
        x_label: "distance of the descriptors",
        y_label: "keypoints",
        x_max: most.ceil() as usize,
        lines,
        is_sweep: true,
        ..Series::default()
    })
}
