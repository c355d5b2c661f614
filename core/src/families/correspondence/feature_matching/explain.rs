//! The explanation and the drawing of feature matching.

use super::{Event, FeatureMatching, State, line};
use crate::base::words::{self, grouped};
use crate::methods::differential::explain;
use crate::methods::matching::{Event as Compared, Neighbors, Outcome};
use crate::products::keypoints::{Descriptor, Keypoint, WINDOW_SIGMAS};
use crate::products::{Match, MatchField, MatchStatus};
use crate::run::Seen;
use crate::scene::{Fact, Link, Math, Name, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

/// Distances of descriptors have three decimals.
fn apart(distance: f32) -> String {
    words::fixed(distance.into(), 3)
}

/// Number of ratio limits in the plot of precision.
const LIMITS: usize = 20;

impl FeatureMatching {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let counts = state.fixed.pair.sides.each_ref().map(|side| grouped(side.points.len()));
        let Some(last) = seen.events.last().copied() else {
            let sentence = format!(
                "A keypoint is found again by its descriptor. {} keypoints of frame t are compared with {} of frame t+1; a match is a nearest \
                 neighbour that passes two tests.",
                counts[0], counts[1]
            );
            return Step { line: line::DETECT, sentence: Sentence::default().text(sentence), readouts: Vec::new() };
        };
        let (line, sentence) = match last {
            Event::Nothing => {
                let why = "Frame t has 0 keypoints, and a match needs at least 1. A lower threshold of the detector finds weaker ones.";
                (line::EACH_KEYPOINT, Sentence::default().text(why))
            }
            Event::Of(event) => self.said(seen, event),
        };
        let is_end = seen.after.is_some_and(|after| after.found.len() >= after.count());
        let sentence =
            if is_end { concluded(seen.after.unwrap_or(state), self.settings.ratio, sentence) } else { sentence };
        Step { line, sentence, readouts: self.readouts(seen, is_end) }
    }

    fn said(&self, seen: &Seen<Self>, event: Compared) -> (Name, Sentence) {
        let (state, said) = (seen.before, Sentence::default());
        let [here, there] = state.fixed.pair.sides.each_ref();
        let at = |index: usize| words::place(there.points[index].at);
        let from = words::place(here.points[state.found.len().min(here.points.len() - 1)].at);
        match event {
            Compared::Nearer { index, distance } => {
                let sentence = said.ink(Role::Candidate, at(index)).text(format!(
                    " in frame t+1: descriptor distance d = {} from keypoint {from}, the nearest so far.",
                    apart(distance)
                ));
                (line::EACH_CANDIDATE, sentence)
            }
            Compared::Candidates(count) => {
                let within = match self.settings.radius {
                    0 => "in the whole frame".to_owned(),
                    radius => format!("within the search radius of {radius} px"),
                };
                let sentence = match count {
                    0 => format!("Keypoint {from} has no candidate {within}."),
                    count => format!("Keypoint {from} was compared with all {} candidates {within}.", grouped(count)),
                };
                (line::EACH_KEYPOINT, said.text(sentence))
            }
            Compared::Found(Neighbors { first, second }) => {
                let sentence = match (first, second) {
                    (Some((a, first)), Some((b, second))) => said
                        .text("Nearest neighbour ")
                        .ink(Role::Best, at(a))
                        .text(format!(", d₁ = {}; second nearest ", apart(first)))
                        .ink(Role::Rejected, at(b))
                        .text(format!(", d₂ = {}.", apart(second))),
                    (Some((a, first)), None) => said
                        .text("The only candidate is ")
                        .ink(Role::Best, at(a))
                        .text(format!(", d₁ = {}: without a second one there is no ratio to test.", apart(first))),
                    _ => said.text("Without a candidate there is no nearest neighbour."),
                };
                (line::KEEP_NEAREST, sentence)
            }
            Compared::Ratio { ratio, passes } => (line::RATIO_TEST, said.text(self.ratio_said(ratio, passes))),
            Compared::CrossCheck { back, passes } => {
                let sentence = match passes {
                    true => said.text("Cross-check: the nearest neighbour of b in frame t is the keypoint itself, so both choose each other."),
                    false => said
                        .text("Cross-check: the nearest neighbour of b in frame t is ")
                        .ink(Role::Rejected, words::place(here.points[back].at))
                        .text(", another keypoint: rejected."),
                };
                (line::CROSS_CHECK, sentence)
            }
            Compared::Outcome(outcome) => {
                let line = match outcome.map(|outcome| outcome.status) {
                    None => line::KEEP_NEAREST,
                    Some(MatchStatus::RejectedRatio) => line::RATIO_TEST,
                    Some(MatchStatus::RejectedCrossCheck) => line::CROSS_CHECK,
                    Some(MatchStatus::Match | MatchStatus::Outlier) => line::ACCEPT,
                };
                (line, self.outcome_said(state, outcome))
            }
        }
    }

    fn ratio_said(&self, ratio: Option<f32>, passes: bool) -> String {
        let limit = words::fine(self.settings.ratio);
        let Some(ratio) = ratio else {
            return format!(
                "Ratio test: d₁ and d₂ are both 0, so d₁ / d₂ is undefined and is not below the limit {limit}: two candidates match exactly, and \
                 neither is nearer. Rejected."
            );
        };
        match passes {
            true => format!(
                "Ratio test: d₁ / d₂ = {} is below the limit {limit}, so the match is distinctive.",
                words::fine(ratio)
            ),
            false => format!(
                "Ratio test: d₁ / d₂ = {} is not below the limit {limit}: two candidates look alike, so the nearest may be wrong. Rejected.",
                words::fine(ratio)
            ),
        }
    }

    fn outcome_said(&self, state: &State, outcome: Option<Outcome>) -> Sentence {
        let said = Sentence::default();
        let Some(outcome) = outcome else { return said.text("No candidate, so no match.") };
        let found = state.match_of(state.found.len(), &outcome);
        let [u, v] = found.displacement().map(words::fine);
        let sentence = match found.status {
            MatchStatus::Match => said.ink(Role::Result, "Match").text(format!(" with the displacement ({u}, {v}) px")),
            MatchStatus::RejectedRatio => said.ink(Role::Rejected, "No match").text(" after the ratio test"),
            _ => said.ink(Role::Rejected, "No match").text(" after the cross-check"),
        };
        let is_right = state.fixed.truth.as_ref().and_then(|truth| MatchField::is_right(&found, truth));
        let sentence = match (is_right, found.status) {
            (Some(true), MatchStatus::Match) => sentence.text(": correct, within 3 px of the true displacement."),
            (Some(false), MatchStatus::Match) => sentence.text(": wrong, more than 3 px from the true displacement."),
            (Some(true), _) => sentence.text(", although the nearest neighbour is correct."),
            (Some(false), _) => sentence.text("; the nearest neighbour is wrong."),
            (None, _) => sentence.text("."),
        };
        match outcome.neighbors.second {
            None if self.settings.ratio < 1.0 => {
                sentence.text(" It was the only candidate, so there was no ratio to test.")
            }
            _ => sentence,
        }
    }

    fn readouts(&self, seen: &Seen<Self>, is_end: bool) -> Vec<Readout> {
        let state = seen.before;
        let index = state.found.len();
        let [here, there] = state.fixed.pair.sides.each_ref();
        let Some(keypoint) = here.keypoints.get(index) else { return Vec::new() };
        let found = seen.events.iter().rev().find_map(|event| match event {
            Event::Of(Compared::Found(neighbors)) => Some(*neighbors),
            _ => None,
        });
        let nearer = seen.events.iter().rev().find_map(|event| match event {
            Event::Of(Compared::Nearer { index, distance }) => Some((*index, *distance)),
            _ => None,
        });
        let neighbors = found.unwrap_or(Neighbors { first: nearer, second: None });
        let mut facts = vec![
            Fact::new("Keypoint", format!("{} of {}", index + 1, here.points.len()), None),
            Fact::new("Position", format!("{} px", words::place(here.points[index].at)), Some(Role::Reference)),
        ];
        let neighbor = |label, role, (index, distance): (usize, f32)| {
            Fact::new(label, format!("{} at {} px", apart(distance), words::place(there.points[index].at)), Some(role))
        };
        facts.extend(neighbors.first.map(|first| neighbor("Nearest, d₁", Role::Best, first)));
        facts.extend(neighbors.second.map(|second| neighbor("Second nearest, d₂", Role::Rejected, second)));
        let accepted = state.found.iter().flatten().filter(|outcome| outcome.status == MatchStatus::Match).count();
        facts.push(Fact::new("Matches so far", grouped(accepted), Some(Role::Result)));
        let mut all = vec![Readout::Facts(facts)];
        // The end sums up all keypoints.
        if !is_end {
            all.extend(Self::ratio_equation(&neighbors).map(Readout::Equation));
            all.push(Readout::Tiles(self.tiles(state, index, &neighbors)));
        }
        let after = seen.after.unwrap_or(state);
        all.extend(match is_end {
            true => {
                [distances(after), self.precision(after)].into_iter().flatten().map(Readout::Series).collect::<Vec<_>>()
            }
            false => {
                let other = neighbors.first.map(|(index, _)| &there.keypoints[index]);
                descriptors(keypoint, other).into_iter().map(Readout::Series).collect()
            }
        });
        all
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

    fn ratio_equation(neighbors: &Neighbors) -> Option<Vec<Math>> {
        let ((_, first), (_, second)) = (neighbors.first?, neighbors.second?);
        let ratio = neighbors.ratio();
        let index = |i: &'static str| Math::indexed(Math::Var("d"), Math::text(i));
        Some(vec![Math::Row(vec![
            Math::over(index("1"), index("2")),
            Math::text(" = "),
            Math::over(Math::ink(Role::Best, apart(first)), Math::ink(Role::Rejected, apart(second))),
            Math::text(ratio.map_or_else(|| " is undefined".into(), |ratio| format!(" = {}", words::fine(ratio)))),
        ])])
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

/// What the truth of a plane leaves open.
const OFF_PLANE: &str =
    " The truth is a homography, which holds for one plane: a correct match of a point off the plane counts as wrong.";

fn concluded(state: &State, limit: f32, sentence: Sentence) -> Sentence {
    if state.count() == 0 {
        return sentence.text(" End of the run without matches.");
    }
    let all: Vec<Match> = state.matches().collect();
    let count = |status| all.iter().filter(|found| found.status == status).count();
    let accepted = count(MatchStatus::Match);
    let errors = state
        .fixed
        .truth
        .as_ref()
        .map(|truth| MatchField::compare(all.iter().filter(|found| found.status == MatchStatus::Match), truth));
    let quality = match errors.and_then(|errors| Some((errors, errors.precision()?))) {
        Some((errors, precision)) => format!(
            " {} of {} with known true displacement are correct, {:.1} %.{}",
            errors.right,
            errors.known,
            100.0 * precision,
            if state.fixed.is_of_plane && errors.right < errors.known { OFF_PLANE } else { "" }
        ),
        None => String::new(),
    };
    let rejected = [count(MatchStatus::RejectedRatio), count(MatchStatus::RejectedCrossCheck)];
    let advice = match (accepted, rejected[0]) {
        (0, 0) if state.fixed.pair.sides[1].points.is_empty() => {
            " Frame t+1 has 0 keypoints, and a match needs at least 1.".to_owned()
        }
        (0, 0) => String::new(),
        (0, _) => {
            let least = all.iter().filter_map(|found| found.ratio).reduce(f32::min);
            least.map_or_else(
                || " All ratios are undefined: each keypoint has two candidates at distance 0.".into(),
                |least| {
                    format!(
                        " The smallest ratio is {}, and the limit is {}; a higher one accepts more.",
                        words::fine(least),
                        words::fine(limit)
                    )
                },
            )
        }
        _ if limit >= 1.0 => {
            " A ratio limit below 1 rejects nearest neighbours that are hardly nearer than the second.".to_owned()
        }
        _ => " A lower ratio limit rejects more wrong matches, but on repeating texture correct ones too.".to_owned(),
    };
    let alone = all.iter().filter(|found| found.status == MatchStatus::Match && found.ratio.is_none()).count();
    let untested = match alone {
        0 => String::new(),
        _ if limit >= 1.0 => String::new(),
        1 => " 1 match had a single candidate, so it passed without a ratio test.".to_owned(),
        count => format!(" {} matches had a single candidate, so they passed without a ratio test.", grouped(count)),
    };
    sentence.text(format!(
        " End of the run: {} of {} keypoints matched; the ratio test rejected {}, the cross-check {}.{untested}{quality}{advice}",
        grouped(accepted),
        grouped(state.count()),
        grouped(rejected[0]),
        grouped(rejected[1])
    ))
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
