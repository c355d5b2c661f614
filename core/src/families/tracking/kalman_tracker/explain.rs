//! How the tracker is told and drawn.

use std::collections::BTreeMap;

use super::association::{Costs, MOST_NEAR, MatchingStage};
use super::{Event, KalmanTracker, PairCost, Track, line};
use crate::methods::{
    kalman::ellipse,
    multi_object::explain::{self, Names, count, short},
};
use crate::products::TrackStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Matrix, Picture, Readout, Role, Scene, Sentence, Shape, Step};

fn named(track: &Track) -> String {
    format!("Object {}", track.id)
}

fn speed(track: &Track) -> String {
    explain::speed(track.filter.velocity())
}

impl KalmanTracker {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Done(_)) => line::EACH_FRAME,
            Some(Event::Looked(..)) => line::DETECT,
            Some(Event::Predicted(_)) => line::PREDICT,
            Some(Event::Costs(_)) => line::COMPUTE_COSTS,
            Some(Event::Paired(..)) => line::ASSIGN,
            Some(Event::Updated(..)) => line::UPDATE_TRACK,
            Some(Event::Missed(_) | Event::Ended(_)) => line::COAST_OR_END,
            Some(Event::Begun(_)) => line::BEGIN_TRACK,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let said = Sentence::default();
        let frame = seen.before.run.frame();
        let Some(event) = seen.events.last() else {
            return said
                .text("Each object has a filter that ")
                .ink(Role::Predicted, "predicts")
                .text(" where it will be. What is ")
                .ink(Role::Measured, "detected")
                .text(" in a frame is shared out among them, and each moves to its own.");
        };
        match event {
            Event::Looked(all, left_out) => {
                explain::looked((all.len(), "detection"), frame, (*left_out, self.settings.min_score))
            }
            Event::Predicted(tracks) if tracks.is_empty() => {
                said.text("There is no object yet whose place could be predicted.")
            }
            Event::Predicted(tracks) => said
                .text("Each of ")
                .ink(Role::Predicted, count(tracks.len(), "object"))
                .text(" goes on as it did, and is less sure of its place than before."),
            Event::Costs(costs) => said.text(format!(
                "Of {} pairs of objects and detections {} are allowed: {}.{}",
                costs.costs.rows() * costs.costs.columns(),
                costs.costs.len(),
                self.limits(costs),
                crowd(costs)
            )),
            Event::Paired(costs, [row, column]) => {
                let pair = costs.pairs[*row];
                let why = match pair.map(|pair| pair.stage) {
                    None | Some(MatchingStage::First) => "",
                    Some(MatchingStage::LowScore) => {
                        " The detection is less sure; it may only go on with an object seen in the frame before."
                    }
                    Some(MatchingStage::Tentative) => " Confirmed tracks have left it unassigned.",
                    Some(MatchingStage::LastBox) => {
                        " It is outside the gate of the prediction, but overlaps the track's last box."
                    }
                };
                said.ink(Role::Predicted, named(&costs.tracks[*row]))
                    .text(" is assigned to ")
                    .ink(Role::Measured, format!("detection {}", column + 1))
                    .text(format!(", at a cost of {}.{why}", short(pair.map_or(0.0, |pair| pair.cost))))
            }
            Event::Updated(both, _) => {
                let [before, after] = &**both;
                let said =
                    said.ink(Role::Estimate, named(after)).text(format!(" moves to its detection: {}.", speed(after)));
                match (before.age.status, after.age.status) {
                    (TrackStatus::Tentative, TrackStatus::Confirmed) => {
                        said.text(format!(" It was matched in {} frames and is confirmed.", after.age.hits))
                    }
                    (TrackStatus::Coasting, _) => {
                        said.text(format!(" It is back after {}.", count(before.age.missed, "frame")))
                    }
                    _ => said,
                }
            }
            Event::Missed(track) => said.ink(Role::Predicted, named(track)).text(format!(
                " was not seen for {} and coasts: its ellipse grows. After more than {} it is deleted.",
                count(track.age.missed, "frame"),
                count(self.rules.patience, "frame")
            )),
            Event::Ended(track) => said.ink(Role::Rejected, named(track)).text(match track.age.status {
                TrackStatus::Tentative => " was not seen again and is deleted: it was still tentative.",
                _ if track.age.missed < self.rules.patience => " is predicted far outside the picture and is deleted.",
                _ => " was not seen for too long and is deleted.",
            }),
            Event::Begun(track) => {
                said.text("An unassigned detection begins ").ink(Role::Reference, named(track).to_lowercase()).text(".")
            }
            Event::Done(frame_done) => said.text(explain::done(frame, frame_done)),
        }
    }

    fn limits(&self, costs: &Costs) -> String {
        let near = format!("their squared distance is at most {}", short(costs.limit));
        let shared = match self.min_overlap > 0.0 {
            true => format!("they have at least {} in common", short(f64::from(self.min_overlap))),
            false => "their boxes overlap".into(),
        };
        match self.cost {
            PairCost::Mahalanobis => near,
            PairCost::Overlap => shared,
            PairCost::Both => format!("{near}, and {shared}"),
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let state = seen.before;
        let mut facts = vec![Fact::new("Frame", state.run.frame().to_string(), None)];
        let objects = seen.after.unwrap_or(state).tracks.len();
        facts.push(Fact::new("Objects", objects.to_string(), None));
        if let Some(track) = track_of(seen) {
            let [[xx, _], [_, yy]] = track.filter.place_covariance();
            facts.push(Fact::new("Object", track.id.to_string(), None));
            facts.push(Fact::new("State", track.age.status.name(), None));
            facts.push(Fact::new("Seen", count(track.age.hits, "frame"), None));
            facts.push(Fact::new("Velocity", speed(track), None));
            facts.push(Fact::new(
                "Standard deviation",
                format!("{} by {} px", short(xx.sqrt()), short(yy.sqrt())),
                None,
            ));
        }
        let (mut tables, mut equation) = (Vec::new(), None);
        if let Some((costs, pair)) = costs_of(seen) {
            let names = Names::new(costs.tracks.iter().map(|track| track.id.to_string()), 0..costs.detections.len());
            facts.extend(names.shown());
            tables = self.tables(costs, &names, pair);
            equation = self.equation(costs, pair);
        }
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend(equation.map(Readout::Equation));
        readouts.extend((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        readouts.extend(explain::series(&seen.after.unwrap_or(state).run));
        readouts
    }

    /// What a pair costs, and for one pair with its numbers.
    fn equation(&self, costs: &Costs, pair: Option<[usize; 2]>) -> Option<Vec<Math>> {
        let cost = |shown: [Math; 4]| {
            let [distance, limit, overlap, least] = shown;
            let from_one = |math: Math| Math::Row(vec![Math::text("1 − "), math]);
            match self.cost {
                PairCost::Mahalanobis => distance,
                PairCost::Overlap => from_one(overlap),
                PairCost::Both => Math::Row(vec![
                    Math::text("½ ("),
                    Math::Frac(Box::new(distance), Box::new(limit)),
                    Math::text(" + "),
                    Math::Frac(Box::new(from_one(overlap)), Box::new(from_one(least))),
                    Math::text(")"),
                ]),
            }
        };
        let squared = Math::power(Math::Var("d"), Math::text("2"));
        let symbols = cost([squared, Math::text("limit"), Math::text("IoU"), Math::text("min-overlap")]);
        let mut lines = vec![Math::Row(vec![Math::Var("C"), Math::text(" = "), symbols])];
        if let Some([row, column]) = pair {
            // A pair of the last box has a cost of its own.
            let total = Math::ink(Role::Best, short(costs.costs.get(row, column)?));
            let (distance, overlap) = (self.distance(costs, row, column), costs.overlap(row, column));
            let shown = [distance, costs.limit, overlap, f64::from(self.min_overlap)].map(|v| Math::text(short(v)));
            lines.push(Math::Row(vec![Math::text("= "), cost(shown), Math::text(" = "), total]));
        }
        Some(lines)
    }

    /// The squared Mahalanobis distance of a detection from an object.
    fn distance(&self, costs: &Costs, row: usize, column: usize) -> f64 {
        let measured = self.measurement(&costs.detections[column]);
        costs.tracks[row].filter.squared_distance(&measured).unwrap_or(f64::INFINITY)
    }

    /// The tables of costs, the pairs that were chosen lit.
    fn tables(&self, costs: &Costs, names: &Names, pair: Option<[usize; 2]>) -> Vec<Matrix> {
        let lit: Vec<(usize, usize)> = match pair {
            Some([row, column]) => vec![(row, column)],
            None => {
                let pairs = costs.pairs.iter().enumerate();
                pairs.filter_map(|(row, pair)| pair.map(|pair| (row, pair.column))).collect()
            }
        };
        let cost = |row, column| costs.costs.get(row, column).unwrap_or(f64::INFINITY);
        let mut all = vec![names.table(("C", "costs: objects down, detections across"), cost, &lit)];
        if self.cost != PairCost::Overlap {
            let distance = |row, column| self.distance(costs, row, column);
            all.push(names.table(("d²", "squared Mahalanobis distances"), distance, &lit));
        }
        if self.cost != PairCost::Mahalanobis {
            all.push(names.table(("IoU", "overlaps"), |row, column| costs.overlap(row, column), &lit));
        }
        all.into_iter().flatten().collect()
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let looked =
            seen.events.iter().find_map(|event| if let Event::Looked(all, _) = event { Some(all) } else { None });
        explain::draw_detections(scene, looked.into_iter().flat_map(|all| all.iter()));
        let after = seen.after.map(|state| &state.tracks);
        match (after, seen.events.last()) {
            (Some(tracks), _) => tracks.iter().for_each(|track| draw_track(scene, track, seen)),
            (None, None) => seen.before.tracks.iter().for_each(|track| draw_track(scene, track, seen)),
            (None, Some(_)) => self.draw_work(seen, scene),
        }
    }

    /// The objects in the middle of a frame: predicted, and those that were done already as they are now.
    fn draw_work(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let predicted = seen.events.iter().find_map(|event| match event {
            Event::Predicted(tracks) => Some(tracks),
            _ => None,
        });
        let Some(predicted) = predicted else {
            return seen.before.tracks.iter().for_each(|track| draw_track(scene, track, seen));
        };
        let mut now: BTreeMap<u32, (&Track, bool)> = predicted.iter().map(|track| (track.id, (track, false))).collect();
        for event in seen.events {
            match event {
                Event::Updated(both, _) => _ = now.insert(both[1].id, (&both[1], true)),
                Event::Missed(track) | Event::Begun(track) => _ = now.insert(track.id, (track, true)),
                Event::Ended(track) => _ = now.remove(&track.id),
                _ => {}
            }
        }
        for (track, is_done) in now.into_values() {
            if is_done {
                draw_track(scene, track, seen);
            } else {
                draw(scene, track, (Role::Predicted, "predicted"));
            }
        }
        pairs(seen, scene);
    }
}

/// What was left out because so many compete, if anything was.
fn crowd(costs: &Costs) -> String {
    let crowded = match costs.crowded {
        0 => String::new(),
        all => format!(" Of {}, only the {MOST_NEAR} nearest detections are compared.", count(all, "object")),
    };
    match costs.greedy {
        0 => crowded,
        all => {
            format!("{crowded} Too many compete for one assignment: {} took the nearest left.", count(all, "object"))
        }
    }
}

/// The pairs chosen so far, each as a line from the object to its detection.
fn pairs(seen: &Seen<KalmanTracker>, scene: &mut Scene) {
    let chosen = seen.events.iter().filter_map(|event| match event {
        Event::Paired(costs, [row, column]) => {
            let from = costs.tracks[*row].filter.place().map(|c| c as f32);
            Some(Arrow { from, to: costs.detections[*column].center })
        }
        _ => None,
    });
    let arrows: Vec<Arrow> = chosen.collect();
    if !arrows.is_empty() {
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(arrows));
    }
}

/// The object that the step is about.
fn track_of<'a>(seen: &Seen<'a, KalmanTracker>) -> Option<&'a Track> {
    match seen.events.last()? {
        Event::Updated(both, _) => Some(&both[1]),
        Event::Missed(track) | Event::Ended(track) | Event::Begun(track) => Some(track),
        Event::Paired(costs, [row, _]) => costs.tracks.get(*row),
        _ => None,
    }
}

/// The table of costs, from when on there is one, and the pair that the step is about.
fn costs_of<'a>(seen: &Seen<'a, KalmanTracker>) -> Option<(&'a Costs, Option<[usize; 2]>)> {
    let pair = match seen.events.last()? {
        Event::Paired(_, pair) => Some(*pair),
        _ => None,
    };
    let costs = seen.events.iter().find_map(|event| if let Event::Costs(costs) = event { Some(costs) } else { None });
    costs.map(|costs| (&**costs, pair))
}

/// A box with its ellipse and its number.
fn draw(scene: &mut Scene, track: &Track, (role, meaning): (Role, &'static str)) {
    let bounds = track.bounds();
    explain::rect(scene, role, bounds);
    if let Some(shape) = ellipse(track.filter.place(), track.filter.place_covariance(), 0.95) {
        scene.mark(Picture::CURRENT, role, shape);
    }
    explain::label(scene, role, bounds.min, track.id.to_string());
    scene.legend(role, meaning);
}

/// An object with its trail, as its life has it.
fn draw_track(scene: &mut Scene, track: &Track, seen: &Seen<KalmanTracker>) {
    let role = explain::role(track.age.status);
    explain::trail(scene, &seen.after.unwrap_or(seen.before).run, role.0, (track.id, track.filter.place()));
    draw(scene, track, role);
}
