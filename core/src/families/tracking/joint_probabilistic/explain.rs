//! The steps of joint probabilistic data association in words, matrices and marks.

use std::collections::BTreeMap;

use super::coalescence::Neighbors;
use super::events::{Joint, JointEvent, Validation};
use super::{Event, JointProbabilistic, State, Track, Weights, line};
use crate::base::words::{capital, percent, place};
use crate::geometry::{Bounds, Grid};
use crate::methods::{
    kalman::{Measurement, ellipse},
    multi_object::{
        density::TrackDensity,
        explain::{self, Names, count},
        selected::Selected,
        tracker_run::Conclusion,
        tracking::{self, MultiTracking, errors, selected},
        truth,
    },
    numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, SQUARED_DECIMALS, px, ratio, squared},
};
use crate::products::TrackStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Math, Matrix, Picture, Readout, Role, Scene, Sentence, Shape, Step};

/// The most detections of a track, or of a joint event, that a sentence lists.
const LISTED: usize = 4;
/// The most joint events in a matrix.
const ROWS: usize = 12;

fn named(track: &Track) -> String {
    format!("Track {}", track.id)
}

/// The standard deviations of the position along x and y.
fn deviations(track: &Track) -> String {
    let [[xx, _], [_, yy]] = track.filter.place_covariance();
    let [x, y] = [xx, yy].map(|variance| px(variance.max(0.0).sqrt()));
    if x == y { x } else { format!("({x},\u{a0}{y})") }
}

impl JointProbabilistic {
    pub(super) fn explained_step(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Done(..)) => line::EACH_FRAME,
            Some(Event::Detected(..)) => line::DETECT,
            Some(Event::Predicted(_)) => line::PREDICT,
            Some(Event::Validated(_)) => line::VALIDATE,
            Some(Event::Enumerated(..)) => line::ENUMERATE,
            Some(Event::Weighed(..)) => line::WEIGH,
            Some(Event::Updated(..)) => line::UPDATE_TRACK,
            Some(Event::Missed(..) | Event::Deleted(_)) => line::COAST_OR_END,
            Some(Event::Begun(..)) => line::BEGIN_TRACK,
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<MultiTracking<Self>>) -> Sentence {
        let said = Sentence::default();
        let frame = seen.before.run.frame();
        let Some(event) = seen.events.last() else {
            return said
                .text("No assignment is made: each track is updated with all ")
                .ink(Role::Measured, "detections")
                .text(" in its gate, weighted by the probability that each is its own. Within a joint event no detection is used twice; β sums over the events, so a detection between two tracks still updates both.");
        };
        match event {
            Event::Detected(all, discarded) => {
                explain::detected((all.len(), "detection"), frame, (*discarded, self.settings.min_score))
            }
            Event::Predicted(tracks) => match tracks.len() {
                0 => said.text("There is no track to predict yet."),
                all => said
                    .text("Prediction of ")
                    .ink(Role::Predicted, count(all, "track"))
                    .text(": the predicted covariance decides how many detections the gate contains."),
            },
            Event::Validated(validation) => said.text(format!(
                "Validation matrix: {} of {} inside the gate, d² ≤ {} (χ², 2 dof, {}). Tracks with a common detection form a cluster, because their associations exclude each other: {}.",
                validation.distances.len(),
                count(validation.tracks.len() * validation.detections.len(), "pair"),
                squared(validation.limit),
                percent(self.chances.gate),
                count(validation.clusters.len(), "cluster")
            ))
            .text(explain::crowded(validation.crowded)),
            Event::Enumerated(validation, joint) => self.enumerated(validation, joint),
            Event::Weighed(validation, joint) => weighed(validation, joint),
            Event::Updated(both, weights) => updated(both, weights),
            Event::Missed(track, missed) => said.ink(Role::Predicted, named(track)).text(format!(
                " coasts: β₀ = {} ≥ 0.5, so more probably none of the detections is its own. {} (maximum age {}).",
                ratio(*missed),
                capital(&explain::missed_in_a_row(track.age.missed)),
                self.rules.max_age
            )),
            Event::Deleted(track) => said.ink(Role::Rejected, named(track)).text(match track.age.status {
                TrackStatus::Tentative => format!(
                    " is deleted: missed while tentative, before {} matches (the minimum number of hits).",
                    self.rules.min_hits
                ),
                _ if track.age.missed < self.rules.max_age => {
                    let [x, y] = track.filter.place();
                    format!(" is deleted: its prediction {} px is far outside the picture.", place([x as f32, y as f32]))
                }
                _ => {
                    format!(" is deleted: missed for more than {} (the maximum age).", count(self.rules.max_age, "frame"))
                }
            }),
            Event::Begun(track, share) => said
                .ink(Role::Reference, named(track))
                .text(format!(
                    " starts: its detection belongs to the known tracks with Σ β = {} < 0.5. It is tentative until it has {} hits, the minimum number.",
                    ratio(*share),
                    self.rules.min_hits
                )),
            Event::Done(done, conclusion) => {
                let mut said = said.text(concluded(seen, conclusion).unwrap_or_default());
                said = said.then(tracking::done(seen, (done, conclusion)));
                said
            }
        }
    }

    fn enumerated(&self, validation: &Validation, joint: &Joint) -> Sentence {
        let said = Sentence::default().text(format!(
            "{} and {} have {}: in each, a detection has one origin and a track at most one detection.",
            count(joint.tracks.len(), "track"),
            count(joint.detections.len(), "detection"),
            count(joint.events.len(), "feasible joint event")
        ));
        let said = match joint.events.first() {
            Some(best) => said
                .text(" The most probable one, ")
                .ink(Role::Best, format!("P(θ) = {}", ratio(best.probability)))
                .text(format!(": {}.", told(validation, joint, best))),
            None => said,
        };
        match (joint.is_exhausted, joint.has_more) {
            (true, _) => said.text(" The cluster is too large to rank all of its events: some may be missing."),
            (false, true) => said.text(format!(
                " The maximum number of joint events, {}, leaves out less probable ones.",
                self.max_events
            )),
            (false, false) => said,
        }
    }

    fn readouts(&self, seen: &Seen<MultiTracking<Self>>) -> Vec<Readout> {
        let state = seen.before;
        let mut facts = vec![Fact::new("Frame", state.run.frame().to_string(), None)];
        facts.push(Fact::new("Tracks", seen.after.unwrap_or(state).tracks.len().to_string(), None));
        if let Some(track) = track_of(seen) {
            facts.push(Fact::new("Track", track.id.to_string(), None));
            facts.push(Fact::new("Status", track.age.status.name(), None));
            facts.push(Fact::new("Velocity", explain::velocity(track.filter.velocity()), None));
            facts.push(Fact::new("Standard deviation σ", format!("{} px", deviations(track)), None));
        }
        let (mut tables, mut equation) = (Vec::new(), None);
        match seen.events.last() {
            Some(Event::Validated(validation)) => tables.extend(validation_table(validation)),
            Some(Event::Enumerated(validation, joint)) => {
                facts.push(Fact::new("Joint events", joint.events.len().to_string(), None));
                tables = event_tables(validation, joint);
            }
            Some(Event::Weighed(validation, joint)) => {
                tables.extend(weight_table(validation, joint));
                equation = Some(weight_equation());
            }
            Some(Event::Updated(both, weights)) => {
                facts.push(Fact::new("Not detected β₀", ratio(weights.missed()), None));
                (tables, equation) = (update_tables(&both[0], weights), Some(update_equation(&both[0], weights)));
            }
            _ => {}
        }
        facts.extend(errors(seen).iter().flat_map(truth::facts));
        facts.extend(selected(seen).filter(|_| track_of(seen).is_none()).iter().flat_map(Selected::facts));
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend(equation.map(Readout::Equation));
        readouts.extend((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        readouts.extend(explain::series(&seen.after.unwrap_or(state).run));
        readouts.extend(self.density(seen).and_then(|density| density.landscape()));
        readouts
    }

    /// The density of the track of the step, or else of the selected one; of a cluster without it, of its first track.
    fn density<'a>(&self, seen: &Seen<'a, MultiTracking<Self>>) -> Option<TrackDensity<'a>> {
        let selected = selected(seen).map(|selected| selected.id);
        let of = |tracks: &'a [Track]| tracks.iter().find(|track| Some(track.id) == selected);
        match seen.events.last() {
            Some(Event::Updated(both, weights)) => {
                let measured =
                    |&(place, _): &_| Measurement { place, place_deviation: weights.deviation, velocity: None };
                Some(TrackDensity {
                    updated: Some(&both[1].filter),
                    measured: weights.measured.iter().map(measured).collect(),
                    ..TrackDensity::predicted(&both[0].filter)
                })
            }
            Some(Event::Validated(validation)) => {
                let row = validation.tracks.iter().position(|track| Some(track.id) == selected)?;
                Some(self.validated_track(validation, row))
            }
            Some(Event::Enumerated(validation, joint) | Event::Weighed(validation, joint)) => {
                let mut rows = joint.tracks.iter();
                let found = rows.find(|row| Some(validation.tracks[**row].id) == selected);
                Some(self.validated_track(validation, *found.or(joint.tracks.first())?))
            }
            Some(Event::Predicted(tracks)) => of(tracks).map(|track| TrackDensity::predicted(&track.filter)),
            Some(Event::Missed(track, _) | Event::Deleted(track)) => Some(TrackDensity::predicted(&track.filter)),
            Some(Event::Begun(track, _)) => Some(TrackDensity::estimated(&track.filter)),
            None | Some(Event::Detected(..) | Event::Done(..)) => {
                of(&seen.after.unwrap_or(seen.before).tracks).map(|track| TrackDensity::estimated(&track.filter))
            }
        }
    }

    /// A predicted track with the detections in its gate.
    fn validated_track<'a>(&self, validation: &'a Validation, row: usize) -> TrackDensity<'a> {
        let track = &validation.tracks[row];
        let mut near: Vec<_> = validation.distances.row(row).collect();
        near.sort_by(|a, b| a.1.total_cmp(&b.1));
        let measured = |(column, _): (usize, f64)| self.measurement(track, &validation.detections[column]);
        TrackDensity {
            measured: near.into_iter().map(measured).collect(),
            limit: Some(validation.limit),
            ..TrackDensity::predicted(&track.filter)
        }
    }

    pub(super) fn drawn(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected =
            seen.events.iter().find_map(|event| if let Event::Detected(all, _) = event { Some(all) } else { None });
        explain::draw_detections(scene, detected.into_iter().flat_map(|all| all.iter()));
        scene.is_overview = seen.after.is_some() && seen.point().is_none();
        if let Some(after) = seen.after {
            errors(seen).iter().for_each(|errors| truth::draw(scene, errors));
            return draw_tracks(scene, after, seen);
        }
        for (i, found) in detected.into_iter().flat_map(|all| all.iter()).enumerate() {
            let Bounds { min, max } = found.bounds;
            explain::label(scene, Role::Measured, [min[0], max[1]], format!("d{}", i + 1));
        }
        draw_work(scene, seen);
        match seen.events.last() {
            Some(Event::Enumerated(validation, joint) | Event::Weighed(validation, joint)) => {
                let tracks = joint.tracks.iter().map(|track| validation.tracks[*track].bounds());
                let detections = joint.detections.iter().map(|found| validation.detections[*found].bounds);
                explain::work_on(scene, tracks.chain(detections));
            }
            _ => track_of(seen).into_iter().for_each(|track| explain::work_at(scene, track.bounds())),
        }
    }
}

/// A joint event in words.
fn told(validation: &Validation, joint: &Joint, event: &JointEvent) -> String {
    let pairs = event.tracks.iter().zip(&joint.detections).filter_map(|(track, detection)| {
        let id = validation.tracks[joint.tracks[(*track)?]].id;
        Some(format!("detection {} is track {id}", detection + 1))
    });
    let mut all: Vec<String> = pairs.collect();
    let others = all.len().saturating_sub(LISTED);
    all.truncate(LISTED);
    if others > 0 {
        all.push(format!("{} more belong to tracks", count(others, "detection")));
    }
    match event.tracks.iter().filter(|track| track.is_none()).count() {
        0 => {}
        1 => all.push("1 detection is a false alarm".into()),
        wrong => all.push(format!("{wrong} detections are false alarms")),
    }
    all.join(", ")
}

/// What became of neighbours, at the end of a run.
fn concluded(seen: &Seen<MultiTracking<JointProbabilistic>>, conclusion: &Conclusion) -> Option<String> {
    let run = &seen.after.filter(|_| conclusion.run.is_some() && selected(seen).is_none())?.run;
    Neighbors::of(run, seen.clip).map(|neighbors| neighbors.sentence())
}

fn weighed(validation: &Validation, joint: &Joint) -> Sentence {
    let all = (0..joint.tracks.len()).flat_map(|track| (0..joint.detections.len()).map(move |at| (track, at)));
    let largest =
        all.map(|(track, at)| (joint.weight(track, at), track, at)).reduce(|a, b| if b.0 > a.0 { b } else { a });
    let said = Sentence::default()
        .text("β of a track and a detection is the sum of P(θ) over the joint events with that pair. ");
    match largest {
        Some((weight, track, at)) => {
            let (id, detection) = (validation.tracks[joint.tracks[track]].id, joint.detections[at] + 1);
            let missed = ratio(joint.missed(track));
            said.text("The largest is ").ink(Role::Best, format!("β = {}", ratio(weight))).text(format!(
                " of track {id} and detection {detection}. The probability that track {id} is not detected is β₀ = {missed}."
            ))
        }
        None => said,
    }
}

fn updated([before, after]: &[Track; 2], weights: &Weights) -> Sentence {
    let at = |track: &Track| place(track.filter.place().map(|c| c as f32));
    let (number, likeliest) = (weights.detections.len(), weights.likeliest());
    let most = likeliest.map_or_else(String::new, |(detection, weight)| {
        format!(", most of all detection {} (β = {})", detection + 1, ratio(weight))
    });
    let reported = match (weights.own, likeliest) {
        (Some((own, _)), Some((likeliest, _))) if own != likeliest => {
            format!(" Detection {} counts for another track, and detection {} for this one.", likeliest + 1, own + 1)
        }
        (None, Some(_)) if weights.is_detected() => " Its detections count for other tracks.".into(),
        _ => String::new(),
    };
    let why = match number {
        1 => " The part β₀ for no detection keeps its covariance larger than a certain update would.",
        _ => " Their spread adds to its covariance, because only one of them can be right.",
    };
    Sentence::default().ink(Role::Estimate, named(after)).text(format!(
        ": combined innovation of {}{most} moves the position from {} to {} px, its standard deviation from {} to {} \
         px.{why}{reported}",
        count(number, "detection"),
        at(before),
        at(after),
        deviations(before),
        deviations(after)
    ))
}

fn validation_table(validation: &Validation) -> Option<Matrix> {
    let names = Names::new(validation.tracks.iter().map(|track| track.id.to_string()), 0..validation.detections.len());
    let distance = |row, column| validation.distances.get(row, column).unwrap_or(f64::INFINITY);
    names
        .table(("d²", "squared Mahalanobis distance in the gate: tracks (rows), detections (columns)"), distance, &[])
        .map(|table| table.with_decimals(SQUARED_DECIMALS))
}

/// The joint events with their probabilities.
fn event_tables(validation: &Validation, joint: &Joint) -> Vec<Matrix> {
    let all = &joint.events[..joint.events.len().min(ROWS)];
    let names = Names::new((1..=all.len()).map(|i| format!("θ{i}")), joint.detections.iter().copied());
    let entry = |row: usize, column: usize| match all[row].tracks[column] {
        Some(track) => f64::from(validation.tracks[joint.tracks[track]].id),
        None => 0.0,
    };
    let name = "track of each detection (columns) in each joint event (rows); 0: false alarm";
    let probability = Matrix {
        symbol: "P(θ)",
        name: "probability of the joint event",
        role: Some(Role::Best),
        entries: Grid::from_fn(1, all.len(), |_, y| all[y].probability),
        rows: names.rows.clone(),
        columns: Vec::new(),
        changed: None,
        decimals: Some(RATIO_DECIMALS),
    };
    let origins = names.table(("θ", name), entry, &[]).map(|table| table.with_decimals(0));
    origins.into_iter().chain((!all.is_empty()).then_some(probability)).collect()
}

/// β of each track and detection, with β₀ in the last column.
fn weight_table(validation: &Validation, joint: &Joint) -> Option<Matrix> {
    let mut names = Names::new(
        joint.tracks.iter().map(|track| validation.tracks[*track].id.to_string()),
        joint.detections.iter().copied(),
    );
    names.columns.push("none".into());
    let entry = |row: usize, column: usize| match column < joint.detections.len() {
        true => joint.weight(row, column),
        false => joint.missed(row),
    };
    names
        .table(("β", "probability of the association: tracks (rows), detections (columns)"), entry, &[])
        .map(|table| table.with_decimals(RATIO_DECIMALS))
}

fn weight_equation() -> Vec<Math> {
    let of_pair = || Math::indexed(Math::Var("β"), Math::text("tj"));
    let event = || Math::Row(vec![Math::Var("P"), Math::text("(θ)")]);
    vec![
        Math::Row(vec![of_pair(), Math::text(" = "), Math::Sum(Box::new(Math::text("θ ∋ (t, j)"))), event()]),
        Math::Row(vec![
            Math::indexed(Math::Var("β"), Math::text("t0")),
            Math::text(" = 1 − "),
            Math::Sum(Box::new(Math::text("j"))),
            of_pair(),
        ]),
    ]
}

/// The combined innovation, its covariance, the spread of the innovations and the gain.
fn update_tables(before: &Track, weights: &Weights) -> Vec<Matrix> {
    let Some(numbers) = before.filter.association_numbers(weights.deviation, &weights.measured) else {
        return Vec::new();
    };
    let axes: Vec<String> = ["x", "y"].map(String::from).into();
    let states: Vec<String> = before.filter.names().iter().map(|name| (*name).into()).collect();
    let matrix = |symbol, name, role, entries: Grid<f64>, rows: &[String]| Matrix {
        symbol,
        name,
        role: Some(role),
        columns: if entries.width() > 1 { axes.clone() } else { Vec::new() },
        rows: rows.to_vec(),
        changed: None,
        decimals: None,
        entries,
    };
    let innovation = Grid::from_fn(1, 2, |_, y| numbers.innovation[y]);
    vec![
        matrix("ν", "combined innovation", Role::Measured, innovation, &axes).with_decimals(LENGTH_DECIMALS),
        matrix("S", "innovation covariance", Role::Predicted, numbers.covariance, &axes),
        matrix("K", "Kalman gain", Role::Estimate, numbers.gain, &states),
        matrix("V", "spread of the innovations", Role::Candidate, numbers.spread, &axes),
    ]
}

fn update_equation(before: &Track, weights: &Weights) -> Vec<Math> {
    let origin = before.filter.place();
    let listed = weights.measured.iter().take(LISTED).map(|(at, weight)| {
        let off = [0, 1].map(|i| px(at[i] - origin[i]));
        format!("{}·({}, {})", ratio(*weight), off[0], off[1])
    });
    let mut terms: Vec<String> = listed.collect();
    if weights.measured.len() > LISTED {
        terms.push("…".into());
    }
    vec![
        Math::Row(vec![
            Math::Bold("ν"),
            Math::text(" = "),
            Math::Sum(Box::new(Math::text("j"))),
            Math::indexed(Math::Var("β"), Math::Var("j")),
            Math::text(" "),
            Math::indexed(Math::Bold("ν"), Math::text("j")),
            Math::text(format!(" = {}", terms.join(" + "))),
        ]),
        covariance_formula(),
        spread_formula(),
        Math::Row(vec![missed(), Math::text(format!(" = {}", ratio(weights.missed())))]),
    ]
}

/// β₀, the probability that the track is missed.
fn missed() -> Math {
    Math::indexed(Math::Var("β"), Math::text("0"))
}

fn transposed(name: &'static str) -> Math {
    Math::power(Math::Bold(name), Math::text("T"))
}

/// The covariance after the update, with the spread V of the innovations.
fn covariance_formula() -> Math {
    Math::Row(vec![
        Math::Bold("P"),
        Math::text(" ← "),
        missed(),
        Math::text(" "),
        Math::Bold("P"),
        Math::text(" + (1 − "),
        missed(),
        Math::text(") ("),
        Math::Bold("P"),
        Math::text(" − "),
        Math::Bold("K"),
        Math::Bold("S"),
        transposed("K"),
        Math::text(") + "),
        Math::Bold("K"),
        Math::Bold("V"),
        transposed("K"),
    ])
}

/// V = Σ β ν νᵀ − ν νᵀ.
fn spread_formula() -> Math {
    let nu = || Math::indexed(Math::Bold("ν"), Math::Var("j"));
    Math::Row(vec![
        Math::Bold("V"),
        Math::text(" = "),
        Math::Sum(Box::new(Math::Var("j"))),
        Math::indexed(Math::Var("β"), Math::Var("j")),
        Math::text(" "),
        nu(),
        Math::power(nu(), Math::text("T")),
        Math::text(" − "),
        Math::Bold("ν"),
        transposed("ν"),
    ])
}

/// The track of the step.
fn track_of<'a>(seen: &Seen<'a, MultiTracking<JointProbabilistic>>) -> Option<&'a Track> {
    match seen.events.last()? {
        Event::Updated(both, _) => Some(&both[1]),
        Event::Missed(track, _) | Event::Deleted(track) | Event::Begun(track, _) => Some(track),
        _ => None,
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

fn draw_track(scene: &mut Scene, track: &Track, seen: &Seen<MultiTracking<JointProbabilistic>>) {
    let role = explain::role(track.age.status);
    explain::trail(scene, &seen.after.unwrap_or(seen.before).run, role.0, (track.id, track.filter.place()));
    draw(scene, track, role);
}

fn draw_tracks(scene: &mut Scene, state: &State, seen: &Seen<MultiTracking<JointProbabilistic>>) {
    state.tracks.iter().for_each(|track| draw_track(scene, track, seen));
}

/// Draws the tracks within a frame: updated, or else predicted.
fn draw_work(scene: &mut Scene, seen: &Seen<MultiTracking<JointProbabilistic>>) {
    let predicted = seen.events.iter().find_map(|event| match event {
        Event::Predicted(tracks) => Some(tracks),
        _ => None,
    });
    let Some(predicted) = predicted else { return draw_tracks(scene, seen.before, seen) };
    let mut now: BTreeMap<u32, (&Track, bool)> = predicted.iter().map(|track| (track.id, (track, false))).collect();
    for event in seen.events {
        match event {
            Event::Updated(both, _) => _ = now.insert(both[1].id, (&both[1], true)),
            Event::Missed(track, _) | Event::Begun(track, _) => _ = now.insert(track.id, (track, true)),
            Event::Deleted(track) => _ = now.remove(&track.id),
            _ => {}
        }
    }
    for (track, is_done) in now.into_values() {
        match is_done {
            true => draw_track(scene, track, seen),
            false => draw(scene, track, (Role::Predicted, "prediction")),
        }
    }
    match seen.events.last() {
        Some(Event::Enumerated(validation, joint) | Event::Weighed(validation, joint)) => {
            draw_associations(scene, validation, joint);
        }
        Some(Event::Updated(both, weights)) => {
            let from = both[0].filter.place().map(|c| c as f32);
            let to = weights.measured.iter().map(|(at, _)| at.map(|c| c as f32));
            let arrows = to.map(|to| Arrow { from, to }).collect();
            scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(arrows));
        }
        _ => {}
    }
}

/// Draws the possible associations of a cluster, and those of its most probable event.
fn draw_associations(scene: &mut Scene, validation: &Validation, joint: &Joint) {
    let arrow = |track: usize, at: usize| Arrow {
        from: validation.tracks[joint.tracks[track]].filter.place().map(|c| c as f32),
        to: validation.detections[joint.detections[at]].center,
    };
    let best: Vec<Arrow> = joint.events.first().map_or_else(Vec::new, |event| {
        event.tracks.iter().enumerate().filter_map(|(at, track)| Some(arrow((*track)?, at))).collect()
    });
    let pairs = (0..joint.tracks.len()).flat_map(|track| (0..joint.detections.len()).map(move |at| (track, at)));
    let is_possible =
        |&(track, at): &(usize, usize)| validation.distances.get(joint.tracks[track], joint.detections[at]).is_some();
    let possible = pairs.filter(is_possible).map(|(track, at)| arrow(track, at));
    let others: Vec<Arrow> = possible.filter(|arrow| !best.contains(arrow)).collect();
    for (role, meaning, arrows) in
        [(Role::Candidate, "possible association", others), (Role::Best, "most probable joint event", best)]
    {
        if !arrows.is_empty() {
            scene.mark(Picture::CURRENT, role, Shape::Arrows(arrows));
            scene.legend(role, meaning);
        }
    }
}
