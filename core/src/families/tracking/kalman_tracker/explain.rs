//! The steps of the Kalman tracker in words, matrices and marks.

use std::collections::BTreeMap;

use super::association::{Costs, MatchingStage};
use super::{Event, KalmanTracker, PairCost, Track, line};
use crate::base::words;
use crate::geometry::{Bounds, Grid};
use crate::methods::{
    kalman::{Filter, Measurement, ellipse},
    multi_object::{
        density::TrackDensity,
        explain::{self, Names, count},
        tracking::{self, MultiTracking, errors, selected},
        truth,
    },
    numbers::{RATIO_DECIMALS, SQUARED_DECIMALS, fixed, px, ratio, squared},
};
use crate::products::TrackStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Matrix, Picture, Readout, Role, Scene, Sentence, Shape, Step};

fn named(track: &Track) -> String {
    format!("Track {}", track.id)
}

fn speed(track: &Track) -> String {
    explain::velocity(track.filter.velocity())
}

/// The larger variance of the position in px².
fn variance(track: &Track) -> f64 {
    let [[xx, _], [_, yy]] = track.filter.place_covariance();
    xx.max(yy)
}

/// The track with the least certain position.
fn widest(tracks: &[Track]) -> Option<&Track> {
    tracks.iter().max_by(|a, b| variance(a).total_cmp(&variance(b)))
}

/// The standard deviations of the position along x and y.
fn deviations(track: &Track) -> String {
    let [[xx, _], [_, yy]] = track.filter.place_covariance();
    let [x, y] = [xx, yy].map(|variance| px(variance.max(0.0).sqrt()));
    if x == y { x } else { format!("({x},\u{a0}{y})") }
}

/// The state and the covariance of a filter, with the entries that differ from those of `before` lit.
fn estimate_matrices(
    filter: &Filter,
    before: Option<&Filter>,
    role: Role,
    named: [(&'static str, &'static str); 2],
) -> [Matrix; 2] {
    let names: Vec<String> = filter.names().iter().map(|name| (*name).into()).collect();
    let state = |filter: &Filter| Grid::from_fn(1, names.len(), |_, y| filter.state()[y]);
    let matrix = |(symbol, name), entries: Grid<f64>, old: Option<Grid<f64>>| Matrix {
        symbol,
        name,
        role: Some(role),
        decimals: None,
        rows: names.clone(),
        columns: if entries.width() > 1 { names.clone() } else { Vec::new() },
        changed: old.map(|old| Grid::from_fn(old.width(), old.height(), |x, y| entries[(x, y)] != old[(x, y)])),
        entries,
    };
    [
        matrix(named[0], state(filter), before.map(state)).with_decimals(filter.decimals()),
        matrix(named[1], filter.covariance(), before.map(Filter::covariance)),
    ]
}

/// State and covariance of a prediction.
fn prediction_matrices(predicted: &Filter) -> [Matrix; 2] {
    let named = [("x⁻", "predicted state"), ("P⁻", "predicted covariance")];
    estimate_matrices(predicted, None, Role::Predicted, named)
}

/// State and covariance before and after an update.
fn update_matrices(predicted: &Filter, updated: &Filter) -> Vec<Matrix> {
    let [state, covariance] = prediction_matrices(predicted);
    let named = [("x", "updated state"), ("P", "updated covariance")];
    let [new_state, new_covariance] = estimate_matrices(updated, Some(predicted), Role::Estimate, named);
    vec![state, new_state, covariance, new_covariance]
}

/// The update of the state with the numbers of x; nothing where several modes have a gain of their own.
fn update_equation([before, after]: &[Track; 2], measurement: &Measurement) -> Option<Vec<Math>> {
    if before.filter.modes().is_some() {
        return None;
    }
    let numbers = before.filter.update_numbers(measurement)?;
    let [from, to] = [before, after].map(|track| px(track.filter.place()[0]));
    let predicted = || Math::Bold("x⁻");
    let symbols = vec![
        Math::Bold("x"),
        Math::text(" = "),
        predicted(),
        Math::text(" + "),
        Math::Bold("K"),
        Math::text(" ("),
        Math::Bold("z"),
        Math::text(" − "),
        Math::Bold("H"),
        predicted(),
        Math::text(")"),
    ];
    let along_x = vec![
        Math::Var("x"),
        Math::text(" = "),
        Math::ink(Role::Predicted, from.clone()),
        Math::text(format!(" + {} · (", ratio(numbers.gain[(0, 0)]))),
        Math::ink(Role::Measured, px(measurement.place[0])),
        Math::text(" − "),
        Math::ink(Role::Predicted, from),
        Math::text(") = "),
        Math::ink(Role::Estimate, to),
    ];
    Some(vec![Math::Row(symbols), Math::Row(along_x)])
}

/// The matrices of a track in a frame: of its update, of its start, or of the prediction alone.
fn matrices_of(id: u32, events: &[Event]) -> Vec<Matrix> {
    let of_track = events.iter().rev().find_map(|event| match event {
        Event::Updated(both, _) if both[1].id == id => Some(update_matrices(&both[0].filter, &both[1].filter)),
        Event::Missed(track) | Event::Deleted(track) if track.id == id => {
            Some(prediction_matrices(&track.filter).to_vec())
        }
        Event::Begun(track) if track.id == id => {
            let named = [("x", "initial state"), ("P", "initial covariance")];
            Some(estimate_matrices(&track.filter, None, Role::Reference, named).to_vec())
        }
        _ => None,
    });
    of_track.unwrap_or_default()
}

impl KalmanTracker {
    pub(super) fn explained_step(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Done(..)) => line::EACH_FRAME,
            Some(Event::Detected(..)) => line::DETECT,
            Some(Event::Predicted(_)) => line::PREDICT,
            Some(Event::Costs(_)) => line::COMPUTE_COSTS,
            Some(Event::Assigned(..)) => line::ASSIGN,
            Some(Event::Updated(..)) => line::UPDATE_TRACK,
            Some(Event::Missed(_) | Event::Deleted(_)) => line::COAST_OR_END,
            Some(Event::Begun(_)) => line::BEGIN_TRACK,
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<MultiTracking<Self>>) -> Sentence {
        let said = Sentence::default();
        let frame = seen.before.run.frame();
        let Some(event) = seen.events.last() else {
            return said
                .text("Each track has a Kalman filter. In every frame the filters ")
                .ink(Role::Predicted, "predict")
                .text(", data association assigns the ")
                .ink(Role::Measured, "detections")
                .text(", and each track is updated with its own.");
        };
        match event {
            Event::Detected(all, discarded) => {
                explain::detected((all.len(), "detection"), frame, (*discarded, self.settings.min_score))
            }
            Event::Predicted(tracks) => self.predicted(tracks),
            Event::Costs(costs) => said.text(format!(
                "Gating leaves {} of {}. {}{}",
                costs.costs.len(),
                count(costs.costs.rows() * costs.costs.columns(), "pair"),
                self.limits(costs),
                crowd(costs)
            )),
            Event::Assigned(costs, [row, column]) => self.assigned(costs, [*row, *column]),
            Event::Updated(both, measurement) => self.updated_track(both, measurement),
            Event::Missed(track) => said.ink(Role::Predicted, named(track)).text(format!(
                " is unassigned and coasts: {} (maximum age {}). Without an update the standard deviation of the position grows to {} px.",
                explain::missed_in_a_row(track.age.missed),
                self.rules.max_age,
                deviations(track)
            )),
            Event::Deleted(track) => {
                let limit = self.rules.max_age;
                said.ink(Role::Rejected, named(track)).text(match track.age.status {
                    TrackStatus::Tentative => {
                        let least = self.rules.min_hits;
                        format!(" is deleted: missed while tentative, before {least} matches (the minimum number of hits).")
                    }
                    _ if track.age.missed < limit => {
                        let [x, y] = track.filter.place();
                        let at = words::place([x as f32, y as f32]);
                        format!(" is deleted: its prediction {at} px is far outside the picture.")
                    }
                    _ => format!(" is deleted: missed for more than {} (the maximum age).", count(limit, "frame")),
                })
            }
            Event::Begun(track) => said
                .text("An unassigned detection starts ")
                .ink(Role::Reference, named(track).to_lowercase())
                .text(format!(
                    " with velocity 0, standard deviation {} px/frame. It is tentative until it has {} hits, the minimum number.",
                    px(track.filter.covariance()[(2, 2)].max(0.0).sqrt()),
                    self.rules.min_hits
                )),
            Event::Done(done, conclusion) => tracking::done(seen, (done, conclusion)),
        }
    }

    fn predicted(&self, tracks: &[Track]) -> Sentence {
        let said = Sentence::default();
        let Some(widest) = widest(tracks) else {
            return said.text("No tracks to predict yet.");
        };
        said.text("Prediction of ").ink(Role::Predicted, count(tracks.len(), "track")).text(format!(
            ": process noise Q increases each covariance. Track {} is the least certain, σ = {} px.",
            widest.id,
            deviations(widest)
        ))
    }

    fn assigned(&self, costs: &Costs, [row, column]: [usize; 2]) -> Sentence {
        let pair = costs.pairs[row];
        let overlap = ratio(costs.overlap(row, column));
        let compared = match pair.map(|pair| pair.stage) {
            Some(MatchingStage::LastBox) => format!(
                "The prediction is outside the gate or the IoU threshold; IoU with the last box {} {}.",
                ratio(1.0 - pair.map_or(1.0, |pair| pair.cost)),
                self.iou_limit()
            ),
            stage => {
                let distance =
                    format!("d² = {} ≤ {}", squared(self.distance(costs, row, column)), squared(costs.limit));
                let iou = format!("IoU {overlap} {}", self.iou_limit());
                let decided = match self.cost {
                    PairCost::Mahalanobis => distance,
                    PairCost::Overlap => iou,
                    PairCost::Both => format!("{distance}, {iou}"),
                };
                let why = match stage {
                    Some(MatchingStage::LowScore) => format!(
                        " The detection's score is below the score threshold ({}), so it can only continue a track.",
                        fixed(self.score_threshold.into(), 2)
                    ),
                    Some(MatchingStage::Tentative) => " No confirmed track matched the detection.".to_owned(),
                    _ => String::new(),
                };
                format!("{decided}.{why}")
            }
        };
        Sentence::default()
            .ink(Role::Predicted, named(&costs.tracks[row]))
            .text(" is assigned to ")
            .ink(Role::Measured, format!("detection {}", column + 1))
            .text(format!(", cost {}. {compared}", ratio(pair.map_or(0.0, |pair| pair.cost))))
    }

    /// The update of the state and its standard deviation, with the gain along x.
    fn updated_track(&self, [before, after]: &[Track; 2], measurement: &Measurement) -> Sentence {
        let at = |track: &Track| words::place(track.filter.place().map(|c| c as f32));
        let by = match before.filter.modes() {
            // Each has a gain of its own.
            Some(_) => "of both modes".to_owned(),
            None => {
                let numbers = before.filter.update_numbers(measurement);
                format!("with gain K = {}", ratio(numbers.map_or(0.0, |numbers| numbers.gain[(0, 0)])))
            }
        };
        let said = Sentence::default().ink(Role::Estimate, named(after)).text(format!(
            ": the update {by} moves the position from {} to {} px. The standard deviation of the position falls from {} to {} px; velocity {}.",
            at(before),
            at(after),
            deviations(before),
            deviations(after),
            speed(after)
        ));
        let said = match after.size.hidden_frames {
            0 => said,
            _ => {
                said.text(" One side of the blob is hidden: its visible edges and the size of the track give the box.")
            }
        };
        match (before.age.status, after.age.status) {
            (TrackStatus::Tentative, TrackStatus::Confirmed) => said.text(format!(
                " Confirmed: {} reach the minimum number of hits, {}{}.",
                count(after.age.hits, "matched frame"),
                self.rules.min_hits,
                after.age.movement.map_or_else(String::new, |movement| format!(
                    ", and the blob has travelled {} px, at least {} px",
                    px(movement.net_px()),
                    px(movement.least_px(self.rules.min_travel))
                ))
            )),
            (TrackStatus::Tentative, TrackStatus::Tentative) if after.age.hits >= self.rules.min_hits => {
                let movement = after
                    .age
                    .movement
                    .map_or([0.0; 2], |movement| [movement.net_px(), movement.least_px(self.rules.min_travel)]);
                let [net, least] = movement.map(px);
                said.text(format!(
                    " Still tentative: it has travelled {net} px from its start and needs {least} px (the minimum travel)."
                ))
            }
            (TrackStatus::Coasting, _) => {
                said.text(format!(" Matched again after {}.", count(before.age.missed, "missed frame")))
            }
            _ => said,
        }
    }

    /// The gating thresholds in words.
    fn limits(&self, costs: &Costs) -> String {
        let near = format!("the gate is d² ≤ {} (χ², 2 dof, {})", squared(costs.limit), words::percent(self.gate));
        let shared = match self.iou_threshold > 0.0 {
            true => format!("the IoU threshold is {}", ratio(self.iou_threshold.into())),
            false => "boxes have to overlap".into(),
        };
        let all = match self.cost {
            PairCost::Mahalanobis => near,
            PairCost::Overlap => shared,
            PairCost::Both => format!("{near}, and {shared}"),
        };
        format!("{}.", words::capital(&all))
    }

    fn readouts(&self, seen: &Seen<MultiTracking<Self>>) -> Vec<Readout> {
        let state = seen.before;
        let mut facts = vec![Fact::new("Frame", state.run.frame().to_string(), None)];
        let objects = seen.after.unwrap_or(state).tracks.len();
        facts.push(Fact::new("Tracks", objects.to_string(), None));
        if let Some(track) = track_of(seen) {
            facts.push(Fact::new("Track", track.id.to_string(), None));
            facts.push(Fact::new("Status", track.age.status.name(), None));
            facts.push(Fact::new("Hits", count(track.age.hits, "matched frame"), None));
            facts.push(Fact::new("Velocity", explain::velocity(track.filter.velocity()), None));
            facts.push(Fact::new("Standard deviation σ", format!("{} px", deviations(track)), None));
        }
        let (mut tables, mut equation) = (Vec::new(), None);
        if let Some((costs, pair)) = costs_of(seen) {
            let names = Names::new(costs.tracks.iter().map(|track| track.id.to_string()), 0..costs.detections.len());
            facts.extend(names.shown());
            tables = self.tables(costs, &names, &lit(seen, costs));
            equation = self.equation(costs, pair);
        }
        if let Some(Event::Updated(both, measurement)) = seen.events.last() {
            (tables, equation) =
                (update_matrices(&both[0].filter, &both[1].filter), update_equation(both, measurement));
        }
        facts.extend(errors(seen).iter().flat_map(truth::facts));
        if let Some(selected) = selected(seen).filter(|_| track_of(seen).is_none()) {
            facts.extend(selected.facts());
            let of_track = matrices_of(selected.id, seen.events);
            if seen.after.is_some() && !of_track.is_empty() {
                (tables, equation) = (of_track, None);
            }
        }
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend(equation.map(Readout::Equation));
        readouts.extend((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        readouts.extend(explain::series(&seen.after.unwrap_or(state).run));
        readouts.extend(self.density(seen).and_then(|density| density.landscape()));
        readouts
    }

    /// The density of the track of the step, or else of the selected one.
    fn density<'a>(&self, seen: &Seen<'a, MultiTracking<Self>>) -> Option<TrackDensity<'a>> {
        let selected = || selected(seen).map(|selected| selected.id);
        let of = |tracks: &'a [Track]| selected().and_then(|id| tracks.iter().find(|track| track.id == id));
        match seen.events.last() {
            Some(Event::Updated(both, measurement)) => Some(TrackDensity {
                updated: Some(&both[1].filter),
                measured: vec![*measurement],
                ..TrackDensity::predicted(&both[0].filter)
            }),
            Some(Event::Assigned(costs, [row, column])) => Some(self.compared(costs, *row, &[*column])),
            Some(Event::Costs(costs)) => {
                let id = selected()?;
                let row = costs.tracks.iter().position(|track| track.id == id)?;
                let columns: Vec<_> = costs.costs.row(row).map(|(column, _)| column).collect();
                Some(self.compared(costs, row, &columns))
            }
            Some(Event::Predicted(tracks)) => {
                let track = of(tracks).or_else(|| widest(tracks))?;
                Some(TrackDensity::predicted(&track.filter))
            }
            Some(Event::Missed(track) | Event::Deleted(track)) => Some(TrackDensity::predicted(&track.filter)),
            Some(Event::Begun(track)) => Some(TrackDensity::estimated(&track.filter)),
            None | Some(Event::Detected(..) | Event::Done(..)) => {
                of(&seen.after.unwrap_or(seen.before).tracks).map(|track| TrackDensity::estimated(&track.filter))
            }
        }
    }

    /// A predicted track with the detections of these columns.
    fn compared<'a>(&self, costs: &'a Costs, row: usize, columns: &[usize]) -> TrackDensity<'a> {
        let near = |column: &usize| (self.distance(costs, row, *column), self.measurement(costs, row, *column));
        let mut all: Vec<_> = columns.iter().map(near).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        TrackDensity {
            measured: all.into_iter().map(|(_, measured)| measured).collect(),
            limit: (self.cost != PairCost::Overlap).then_some(costs.limit),
            ..TrackDensity::predicted(&costs.tracks[row].filter)
        }
    }

    /// The formula of the cost with its conditions, and for one pair with its numbers.
    fn equation(&self, costs: &Costs, pair: Option<[usize; 2]>) -> Option<Vec<Math>> {
        let found = pair.and_then(|[row, column]| costs.pairs[row].filter(|found| found.column == column));
        if let Some(found) = found.filter(|found| found.stage == MatchingStage::LastBox) {
            return Some(self.last_box_equation(found.cost));
        }
        let d_squared = Math::power(Math::Var("d"), Math::text("2"));
        let symbols = self.cost([d_squared, Math::text("gate"), Math::text("IoU"), Math::text("IoU threshold")]);
        let mut lines = vec![Math::Row(vec![Math::Var("C"), Math::text(" = "), symbols])];
        if let Some([row, column]) = pair {
            let total = Math::ink(Role::Best, ratio(costs.costs.get(row, column)?));
            let (distance, overlap) = (self.distance(costs, row, column), costs.overlap(row, column));
            let [distance, limit] = [distance, costs.limit].map(|v| Math::text(squared(v)));
            let [overlap, least] = [overlap, f64::from(self.iou_threshold)].map(|v| Math::text(ratio(v)));
            let mut numbers = vec![Math::text("= "), self.cost([distance, limit, overlap, least])];
            // d² is its own result.
            if self.cost != PairCost::Mahalanobis {
                numbers.extend([Math::text(" = "), total]);
            }
            lines.push(Math::Row(numbers));
        }
        lines.push(self.conditions(costs, pair));
        Some(lines)
    }

    /// The cost of d², the gate, the IoU and its threshold.
    fn cost(&self, [distance, limit, overlap, least]: [Math; 4]) -> Math {
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
    }

    /// The formula of a pair that the last detected box has joined, at its `cost`.
    fn last_box_equation(&self, cost: f64) -> Vec<Math> {
        let iou = ratio(1.0 - cost);
        vec![
            Math::Row(vec![Math::Var("C"), Math::text(" = 1 − IoU of the last box")]),
            Math::Row(vec![Math::text(format!("= 1 − {iou} = ")), Math::ink(Role::Best, ratio(cost))]),
            Math::text(format!("with IoU = {iou} {}", self.iou_limit())),
        ]
    }

    /// The conditions under which a pair may be assigned, with its numbers: every pair with a cost meets them.
    fn conditions(&self, costs: &Costs, pair: Option<[usize; 2]>) -> Math {
        let equals = |text: String| if pair.is_some() { format!(" = {text}") } else { String::new() };
        let distance = || {
            let value = pair.map_or_else(String::new, |[row, column]| squared(self.distance(costs, row, column)));
            let compared = format!("{} ≤ gate {}", equals(value), squared(costs.limit));
            Math::Row(vec![Math::power(Math::Var("d"), Math::text("2")), Math::text(compared)])
        };
        let overlap = || {
            let value = pair.map_or_else(String::new, |[row, column]| ratio(costs.overlap(row, column)));
            Math::text(format!("IoU{} {}", equals(value), self.iou_limit()))
        };
        let all = match self.cost {
            PairCost::Mahalanobis => vec![distance()],
            PairCost::Overlap => vec![overlap()],
            PairCost::Both => vec![distance(), Math::text(", "), overlap()],
        };
        let before = if pair.is_some() { "with " } else { "C = ∞ unless " };
        Math::Row(std::iter::once(Math::text(before)).chain(all).collect())
    }

    /// What the IoU of a pair has to meet: boxes that do not overlap are never a pair.
    fn iou_limit(&self) -> String {
        match self.iou_threshold > 0.0 {
            true => format!("≥ {}", ratio(self.iou_threshold.into())),
            false => "> 0".to_owned(),
        }
    }

    /// Returns the squared Mahalanobis distance of a detection from a track.
    fn distance(&self, costs: &Costs, row: usize, column: usize) -> f64 {
        let measured = self.measurement(costs, row, column);
        costs.tracks[row].filter.squared_distance(&measured).unwrap_or(f64::INFINITY)
    }

    /// Returns the measurement by a detection that is compared with a track.
    fn measurement(&self, costs: &Costs, row: usize, column: usize) -> Measurement {
        let (track, detection) = (&costs.tracks[row], &costs.detections[column]);
        match self.cost {
            PairCost::Mahalanobis => self.dynamics.measurement(detection),
            PairCost::Overlap | PairCost::Both => self.measured(track, detection, costs.picture),
        }
    }

    /// The cost matrices, with the pairs in `lit` lit.
    fn tables(&self, costs: &Costs, names: &Names, lit: &[(usize, usize)]) -> Vec<Matrix> {
        let cost = |row, column| costs.costs.get(row, column).unwrap_or(f64::INFINITY);
        // The Mahalanobis distance is its own cost.
        let decimals = if self.cost == PairCost::Mahalanobis { SQUARED_DECIMALS } else { RATIO_DECIMALS };
        let in_decimals = |table: Matrix| table.with_decimals(decimals);
        let mut all =
            vec![names.table(("C", "cost matrix: tracks (rows), detections (columns)"), cost, lit).map(in_decimals)];
        if self.cost != PairCost::Overlap {
            let distance = |row, column| self.distance(costs, row, column);
            let table = names.table(("d²", "squared Mahalanobis distance"), distance, lit);
            all.push(table.map(|table| table.with_decimals(SQUARED_DECIMALS)));
        }
        if self.cost != PairCost::Mahalanobis {
            let overlap = |row, column| costs.overlap(row, column);
            let table = names.table(("IoU", "intersection over union"), overlap, lit);
            all.push(table.map(|table| table.with_decimals(RATIO_DECIMALS)));
        }
        all.into_iter().flatten().collect()
    }

    pub(super) fn drawn(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected =
            seen.events.iter().find_map(|event| if let Event::Detected(all, _) = event { Some(all) } else { None });
        explain::draw_detections(scene, detected.into_iter().flat_map(|all| all.iter()));
        let after = seen.after.map(|state| &state.tracks);
        if after.is_none() {
            for (i, found) in detected.into_iter().flat_map(|all| all.iter()).enumerate() {
                let Bounds { min, max } = found.bounds;
                explain::label(scene, Role::Measured, [min[0], max[1]], format!("d{}", i + 1));
            }
        }
        scene.is_overview = after.is_some() && seen.point().is_none();
        match (after, seen.events.last()) {
            (Some(tracks), _) => {
                errors(seen).iter().for_each(|errors| truth::draw(scene, errors));
                tracks.iter().for_each(|track| draw_track(scene, track, seen));
            }
            (None, None) => seen.before.tracks.iter().for_each(|track| draw_track(scene, track, seen)),
            (None, Some(_)) => self.draw_work(seen, scene),
        }
        if let Some(track) = track_of(seen) {
            explain::work_at(scene, track.bounds());
        }
    }

    /// Draws the tracks within a frame: updated, or else predicted.
    fn draw_work(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
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
                Event::Deleted(track) => _ = now.remove(&track.id),
                _ => {}
            }
        }
        for (track, is_done) in now.into_values() {
            if is_done {
                draw_track(scene, track, seen);
            } else {
                draw(scene, track, (Role::Predicted, "prediction"));
            }
        }
        pairs(seen, scene);
    }
}

/// The limits of the work in dense crowds, if they were reached.
fn crowd(costs: &Costs) -> String {
    let crowded = explain::crowded(costs.crowded);
    match costs.greedy {
        0 => crowded,
        all => {
            format!("{crowded} The optimal assignment is too large: {} assigned greedily.", count(all, "track"))
        }
    }
}

/// Draws the assigned pairs as arrows from prediction to detection.
fn pairs(seen: &Seen<MultiTracking<KalmanTracker>>, scene: &mut Scene) {
    let chosen = seen.events.iter().filter_map(|event| match event {
        Event::Assigned(costs, [row, column]) => {
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

/// The track of the step.
fn track_of<'a>(seen: &Seen<'a, MultiTracking<KalmanTracker>>) -> Option<&'a Track> {
    match seen.events.last()? {
        Event::Updated(both, _) => Some(&both[1]),
        Event::Missed(track) | Event::Deleted(track) | Event::Begun(track) => Some(track),
        Event::Assigned(costs, [row, _]) => costs.tracks.get(*row),
        _ => None,
    }
}

/// The cost matrix, once it is computed, and the pair of the step.
fn costs_of<'a>(seen: &Seen<'a, MultiTracking<KalmanTracker>>) -> Option<(&'a Costs, Option<[usize; 2]>)> {
    let pair = match seen.events.last()? {
        Event::Assigned(_, pair) => Some(*pair),
        _ => None,
    };
    let costs = seen.events.iter().find_map(|event| if let Event::Costs(costs) = event { Some(costs) } else { None });
    costs.map(|costs| (&**costs, pair))
}

/// The pairs of track and detection that a step is about: those inside the gate, the assigned one, or after the assignment all of it.
fn lit(seen: &Seen<MultiTracking<KalmanTracker>>, costs: &Costs) -> Vec<(usize, usize)> {
    match seen.events.last() {
        Some(Event::Costs(_)) => {
            let row = |row| (0..costs.costs.columns()).map(move |column| (row, column));
            let all = (0..costs.costs.rows()).flat_map(row);
            all.filter(|(row, column)| costs.costs.get(*row, *column).is_some()).collect()
        }
        Some(Event::Assigned(_, [row, column])) => vec![(*row, *column)],
        _ => {
            let pairs = costs.pairs.iter().enumerate();
            pairs.filter_map(|(row, pair)| pair.map(|pair| (row, pair.column))).collect()
        }
    }
}

/// Draws a track's box, 95 % ellipse and number.
fn draw(scene: &mut Scene, track: &Track, (role, meaning): (Role, &'static str)) {
    let bounds = track.bounds();
    explain::rect(scene, role, bounds);
    if let Some(shape) = ellipse(track.filter.place(), track.filter.place_covariance(), 0.95) {
        scene.mark(Picture::CURRENT, role, shape);
    }
    explain::label(scene, role, bounds.min, track.id.to_string());
    scene.legend(role, meaning);
}

/// Draws a track and its trajectory by its status.
fn draw_track(scene: &mut Scene, track: &Track, seen: &Seen<MultiTracking<KalmanTracker>>) {
    let role = explain::role(track.age.status);
    explain::trail(scene, &seen.after.unwrap_or(seen.before).run, role.0, (track.id, track.filter.place()));
    draw(scene, track, role);
}
