//! The steps of multiple hypothesis tracking in words, matrices and marks.

use std::sync::Arc;

use super::expand::{Expansion, Gates};
use super::forest::{Claim, Origin, Scan, Track};
use super::{Event, Leading, MultipleHypothesis, Pruning, Revision, State, line};
use crate::base::words::percent;
use crate::geometry::{Bounds, Grid};
use crate::methods::differential::numbers::factor;
use crate::methods::{
    kalman::ellipse,
    multi_object::{
        density::TrackDensity,
        explain::{self, Names, count},
        selected::Selected,
        tracking::{self, MultiTracking, errors, selected},
        truth,
    },
    numbers::{RATIO_DECIMALS, SQUARED_DECIMALS, fixed, ratio, squared},
};
use crate::run::Seen;
use crate::scene::{Arrow, Diagram, Fact, Math, Matrix, Picture, Readout, Role, Scene, Sentence, Shape, Step};

/// The most detections of a hypothesis that a sentence lists.
const LISTED: usize = 3;
/// The most hypotheses in a matrix.
const ROWS: usize = 12;

impl MultipleHypothesis {
    pub(super) fn explained_step(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let line = match seen.events.last() {
            None | Some(Event::Done(..)) => line::EACH_FRAME,
            Some(Event::Detected(..)) => line::DETECT,
            Some(Event::Predicted(_)) => line::PREDICT,
            Some(Event::Gated(_)) => line::GATE,
            Some(Event::Expanded(..)) => line::EXPAND,
            Some(Event::Pruned(_)) => line::PRUNE,
            Some(Event::Led(_)) => line::LEAD,
            Some(Event::Revised(_)) => line::REVISE,
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<MultiTracking<Self>>) -> Sentence {
        let said = Sentence::default();
        let frame = seen.before.run.frame();
        let Some(event) = seen.events.last() else {
            return said
                .text("A hypothesis explains the origin of every detection. In each frame hypotheses branch, because a ")
                .ink(Role::Measured, "detection")
                .text(" may come from a track, a new track, or be a false alarm. Later frames decide which branch survives.");
        };
        match event {
            Event::Detected(all, discarded) => {
                explain::detected((all.len(), "detection"), frame, (*discarded, self.settings.min_score))
            }
            Event::Predicted(tracks) => predicted(tracks),
            Event::Gated(gates) => self.gated(gates),
            Event::Expanded(gates, expansion) => self.expanded(gates, expansion),
            Event::Pruned(pruning) => self.pruned(pruning),
            Event::Led(leading) => self.led(leading, frame),
            Event::Revised(revisions) => revised(revisions),
            Event::Done(done, conclusion) => tracking::done(seen, (done, conclusion)),
        }
    }

    fn gated(&self, gates: &Gates) -> Sentence {
        let [all, merged] = gates.clusters;
        let pairs = gates.tracks.len() * gates.detections.len();
        Sentence::default().text(format!(
            "Gating leaves {} of {}: the gate is d² ≤ {} (χ², 2 dof, {}). Tracks with a common detection compete and form a cluster: {}, {merged} merged in this frame. Clusters are independent, so their hypotheses do not multiply.",
            gates.distances.len(),
            count(pairs, "pair"),
            squared(gates.limit),
            percent(self.chances.gate),
            count(all, "cluster"),
        ))
        .text(explain::crowded(gates.crowded))
    }

    fn expanded(&self, gates: &Gates, expansion: &Expansion) -> Sentence {
        let mut ids: Vec<u32> = expansion.tracks.iter().map(|track| track.id).collect();
        ids.dedup();
        let about = match (&ids[..], expansion.detections.len()) {
            ([], detections) => format!("{} in no gate.", count(detections, "detection")),
            ([id], 0) => format!("Track {id} has no detection in its gates."),
            ([id], detections) => format!("Track {id} has {} in its gates.", count(detections, "detection")),
            (ids, detections) => {
                format!("{} compete for {}.", count(ids.len(), "track"), count(detections, "detection"))
            }
        };
        let mut all = expansion.branches.iter();
        let said = match all.next() {
            Some(best) => Sentence::default()
                .text(format!("{about} Most probable, "))
                .ink(Role::Best, format!("P = {}", ratio(best.probability)))
                .text(format!(": {}.", claims(&best.scan.claims, gates.frame))),
            None => Sentence::default().text(about),
        };
        let said = match all.next() {
            Some(next) => said
                .text(" Next, ")
                .ink(Role::Candidate, format!("P = {}", ratio(next.probability)))
                .text(format!(": {}.", claims(&next.scan.claims, gates.frame))),
            None if expansion.has_more || expansion.is_exhausted => said,
            None if self.min_ratio > 0.0 => said.text(format!(
                " No other explanation has at least {} times its probability.",
                ratio(self.min_ratio.into())
            )),
            None => said.text(" There is no other explanation."),
        };
        let said = match (all.len(), self.min_ratio) {
            (0, _) => said,
            (1, 0.0) => said.text(" 1 more is less probable."),
            (others, 0.0) => said.text(format!(" {others} more are less probable.")),
            (others, least) => said.text(format!(
                " {others} more {} at least {} times the highest probability.",
                if others == 1 { "has" } else { "have" },
                ratio(least.into())
            )),
        };
        match (expansion.is_exhausted, expansion.has_more) {
            (true, _) => said.text(" The cluster is too large to rank all of its branches: some may be missing."),
            (false, true) => said.text(format!(
                " The maximum number of hypotheses, {}, leaves out less probable ones.",
                self.max_hypotheses
            )),
            (false, false) => said,
        }
    }

    fn pruned(&self, pruning: &Pruning) -> Sentence {
        let later = count(self.n_scan, "later frame");
        let Pruning { frame, clusters, removed, probability, .. } = *pruning;
        Sentence::default().text(match removed {
            0 => format!("Frame {frame} is decided after {later}: all hypotheses explain it alike."),
            _ => format!(
                "Frame {frame} is decided after {later} as the leading hypothesis explains it. N-scan pruning deletes {} with another explanation in {}, with a probability of {} in all.",
                hypotheses(removed),
                count(clusters, "cluster"),
                ratio(probability)
            ),
        })
    }

    fn led(&self, leading: &Leading, frame: usize) -> Sentence {
        let Leading { probability, clusters, hypotheses: all, scans, second, .. } = leading;
        let explained: Vec<Claim> = scans.iter().flat_map(|scan| scan.claims.iter().copied()).collect();
        let said = Sentence::default().ink(Role::Best, "Leading hypothesis").text(format!(
            " of {} in {}: P = {}, the product over clusters. {}.",
            hypotheses(*all),
            count(*clusters, "cluster"),
            ratio(*probability),
            crate::base::words::capital(&claims(&explained, frame))
        ));
        let Some(second) = second else {
            return said.text(" There is no second one: all frames are decided.");
        };
        let [one, other] = second.scans.each_ref().map(|scan| &scan.claims);
        let differing = one.iter().zip(other).find(|(a, b)| a != b);
        let said =
            said.text(" The ").ink(Role::Reference, "second").text(format!(", P = {}", ratio(second.probability)));
        match differing {
            Some((a, b)) => said.text(format!(
                ", says of frame {} that {} where the leading one says {}. Frame {} decides.",
                second.frame,
                claim(b),
                origin(a.origin),
                second.frame + self.n_scan
            )),
            None => said.text(", explains other detections."),
        }
    }

    fn readouts(&self, seen: &Seen<MultiTracking<Self>>) -> Vec<Readout> {
        let state = seen.before;
        let after = seen.after.unwrap_or(state);
        let of = |clusters: &[super::Cluster]| clusters.iter().map(|cluster| cluster.hypotheses.len()).sum::<usize>();
        let mut facts = vec![
            Fact::new("Frame", state.run.frame().to_string(), None),
            // Those of this frame are known at its end.
            Fact::new(
                if seen.after.is_some() { "Clusters" } else { "Clusters before" },
                after.tracks.len().to_string(),
                None,
            ),
            Fact::new(
                if seen.after.is_some() { "Hypotheses" } else { "Hypotheses before" },
                of(&after.tracks).to_string(),
                None,
            ),
        ];
        let (mut tables, mut equation) = (Vec::new(), None);
        match seen.events.last() {
            Some(Event::Gated(gates)) => tables.extend(distances(gates)),
            Some(Event::Expanded(gates, expansion)) => {
                tables = branch_tables(expansion);
                equation = Some(self.equation(gates, expansion));
                facts.push(Fact::new("Branching hypotheses", expansion.parents.len().to_string(), None));
                facts.push(Fact::new("Branches", expansion.branches.len().to_string(), Some(Role::Candidate)));
            }
            Some(Event::Led(leading)) => {
                facts.push(Fact::new("Leading probability", ratio(leading.probability), Some(Role::Best)));
                let second = leading.second.as_ref().map_or(0.0, |second| second.probability);
                facts.push(Fact::new("Second probability", ratio(second), Some(Role::Reference)));
            }
            Some(Event::Revised(revisions)) => {
                facts.push(Fact::new("Revised detections", revisions.len().to_string(), None));
            }
            _ => {}
        }
        facts.extend(errors(seen).iter().flat_map(truth::facts));
        facts.extend(selected(seen).iter().flat_map(Selected::facts));
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend(equation.map(Readout::Equation));
        readouts.extend(self.tree(seen).map(Readout::Diagram));
        readouts.extend((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        readouts.extend(explain::series(&after.run));
        readouts.extend(density(seen).and_then(|density| density.landscape()));
        readouts
    }

    /// The tree of the hypotheses before and after the decision of an earlier frame.
    fn tree(&self, seen: &Seen<MultiTracking<Self>>) -> Option<Diagram> {
        let tree = match seen.events.last()? {
            Event::Pruned(pruning) => pruning.tree.as_ref()?,
            Event::Led(leading) => leading.tree.as_ref()?,
            _ => return None,
        };
        let of_tree = seen.events.iter().find_map(|event| match event {
            Event::Expanded(_, expansion) => {
                expansion.branches.iter().any(|branch| tree.has(&branch.scan)).then_some(expansion)
            }
            _ => None,
        });
        let mut notes = Vec::new();
        if of_tree.is_some_and(|expansion| expansion.has_more) {
            notes.push(format!("k best: branches beyond the first {} are left out", self.max_hypotheses));
        }
        if self.min_ratio > 0.0 {
            notes.push(format!("ratio: branches below {} times the best are left out", ratio(self.min_ratio.into())));
        }
        Some(tree.drawn(&notes))
    }

    /// The probability of the leading branch: its formula, the logarithm of the product with the numbers of the step, and of the normalised one.
    fn equation(&self, gates: &Gates, expansion: &Expansion) -> Vec<Math> {
        let terms = expansion.terms;
        let [found, missed, wrong, new] = terms.counts;
        let [ln_detected, ln_missed] = [self.chances.detected(), self.chances.missed()].map(f64::ln);
        let [false_density, new_density] = self.densities(gates.size());
        let symbol = |base: &'static str, index: &str, power: &str| {
            Math::power(Math::indexed(Math::Var(base), Math::text(index)), Math::text(power))
        };
        // Between factors a narrow formula breaks.
        let by = || Math::text(" · ");
        let formula = vec![
            Math::Var("P"),
            Math::text(" = "),
            Math::power(Math::Var("c"), Math::text("−1")),
            by(),
            symbol("P", "parent", ""),
            by(),
            symbol("P", "D", "DT"),
            by(),
            Math::text("(1 − "),
            Math::indexed(Math::Var("P"), Math::text("D")),
            Math::indexed(Math::Var("P"), Math::text("G")),
            Math::power(Math::text(")"), Math::text("missed")),
            by(),
            symbol("β", "FT", "FT"),
            by(),
            symbol("β", "NT", "NT"),
            by(),
            Math::text("∏ "),
            Math::Var("N"),
            Math::text("(ν; 0, S) "),
            Math::indexed(Math::Var("L"), Math::text("size")),
        ];
        let number = |value: f64| fixed(value, RATIO_DECIMALS);
        let counts = format!("with DT = {found}, missed = {missed}, FT = {wrong}, NT = {new}");
        let product = terms.ln_parent
            + found as f64 * ln_detected
            + missed as f64 * ln_missed
            + wrong as f64 * false_density.ln()
            + new as f64 * new_density.ln()
            + terms.ln_innovations
            + terms.ln_sizes;
        let probability = expansion.branches.first().map_or(0.0, |best| best.probability);
        // In parts, so that a narrow formula breaks before a sign.
        let of_count = |count: usize, ln: f64| format!("{count}·{}", factor(number(ln)));
        let summands = [
            of_count(found, ln_detected),
            of_count(missed, ln_missed),
            of_count(wrong, false_density.ln()),
            of_count(new, new_density.ln()),
            factor(number(terms.ln_innovations)),
            factor(number(terms.ln_sizes)),
        ];
        let mut numbers = vec![Math::text(format!("ln (c P) = {}", number(terms.ln_parent)))];
        numbers.extend(summands.into_iter().flat_map(|summand| [Math::text(" + "), Math::text(summand)]));
        numbers.extend([Math::text(" = "), Math::text(number(product))]);
        let normalised = vec![
            Math::text("ln P = ln (c P)"),
            Math::text(" − ln c = "),
            Math::text(number(product)),
            Math::text(" − "),
            Math::text(factor(number(product - probability.ln()))),
            Math::text(format!(" = {}, ", number(probability.ln()))),
            Math::Var("P"),
            Math::text(" = "),
            Math::ink(Role::Best, ratio(probability)),
        ];
        let constant = Math::Row(vec![Math::Var("c"), Math::text(": sum over the branches")]);
        vec![Math::Row(formula), Math::text(counts), constant, Math::Row(numbers), Math::Row(normalised)]
    }

    pub(super) fn drawn(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected =
            seen.events.iter().find_map(|event| if let Event::Detected(all, _) = event { Some(all) } else { None });
        explain::draw_detections(scene, detected.into_iter().flat_map(|all| all.iter()));
        scene.is_overview = seen.after.is_some() && seen.point().is_none();
        if let Some(after) = seen.after {
            errors(seen).iter().for_each(|errors| truth::draw(scene, errors));
            return draw_leading(scene, after, seen);
        }
        for (i, found) in detected.into_iter().flat_map(|all| all.iter()).enumerate() {
            let Bounds { min, max } = found.bounds;
            explain::label(scene, Role::Measured, [min[0], max[1]], format!("d{}", i + 1));
        }
        match seen.events.last() {
            None | Some(Event::Detected(..)) => draw_leading(scene, seen.before, seen),
            Some(Event::Predicted(tracks)) => tracks.iter().for_each(|track| draw_prediction(scene, track)),
            Some(Event::Gated(gates)) => gates.tracks.iter().for_each(|track| draw_prediction(scene, track)),
            Some(Event::Expanded(gates, expansion)) => draw_branches(scene, gates, expansion),
            Some(Event::Led(leading)) => draw_second(scene, leading, seen.before.run.frame()),
            Some(Event::Revised(revisions)) => draw_revisions(scene, seen, revisions),
            Some(Event::Pruned(_) | Event::Done(..)) => {
                let led = seen.events.iter().find_map(|event| match event {
                    Event::Led(leading) => Some(leading),
                    _ => None,
                });
                let scans = led.into_iter().flat_map(|leading| &leading.scans);
                scans.flat_map(|scan| &scan.tracks).for_each(|track| draw_track(scene, track));
            }
        }
    }
}

/// The density of the selected track in the leading hypothesis; of a cluster without it, of its first track.
fn density<'a>(seen: &Seen<'a, MultiTracking<MultipleHypothesis>>) -> Option<TrackDensity<'a>> {
    let selected = selected(seen).map(|selected| selected.id);
    let estimated = |track: &'a Arc<Track>| TrackDensity::estimated(&track.filter);
    match seen.events.last() {
        Some(Event::Predicted(tracks)) => {
            let row = leading_row(seen.before, selected?)?;
            Some(TrackDensity::predicted(&tracks.get(row)?.filter))
        }
        Some(Event::Gated(gates)) => gated_track(gates, leading_row(seen.before, selected?)?),
        Some(Event::Expanded(gates, expansion)) => {
            let ids = || expansion.tracks.iter().map(|track| track.id);
            let chosen = ids().filter(|id| Some(*id) == selected);
            gated_track(gates, chosen.chain(ids()).find_map(|id| leading_row(seen.before, id))?)
        }
        None | Some(Event::Detected(..)) => {
            let row = leading_row(seen.before, selected?)?;
            seen.before.tracks.iter().flat_map(|cluster| &cluster.tracks).nth(row).map(estimated)
        }
        Some(Event::Pruned(_) | Event::Led(_) | Event::Revised(_) | Event::Done(..)) => {
            let led = seen.events.iter().find_map(|event| match event {
                Event::Led(leading) => Some(leading),
                _ => None,
            });
            let mut tracks = led?.scans.iter().flat_map(|scan| &scan.tracks);
            tracks.find(|track| Some(track.id) == selected).map(estimated)
        }
    }
}

/// The place of a track of the leading hypotheses among the tracks of all clusters.
fn leading_row(state: &State, id: u32) -> Option<usize> {
    let mut first = 0;
    state.tracks.iter().find_map(|cluster| {
        let leading = cluster.hypotheses.first().map_or(&[][..], |leader| &leader.tracks);
        let found = leading.iter().find(|track| cluster.tracks[**track].id == id).map(|track| first + track);
        first += cluster.tracks.len();
        found
    })
}

/// A predicted track with the detections in its gate.
fn gated_track(gates: &Gates, row: usize) -> Option<TrackDensity<'_>> {
    let mut near: Vec<_> = gates.distances.row(row).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    Some(TrackDensity {
        measured: near.into_iter().map(|(column, _)| gates.measured[column]).collect(),
        limit: Some(gates.limit),
        ..TrackDensity::predicted(&gates.tracks.get(row)?.filter)
    })
}

/// A number of hypotheses in words.
fn hypotheses(all: usize) -> String {
    if all == 1 { "1 hypothesis".into() } else { format!("{all} hypotheses") }
}

fn predicted(tracks: &[Arc<Track>]) -> Sentence {
    let said = Sentence::default();
    match tracks.len() {
        0 => said.text("No hypothesis has a track to predict yet."),
        all => said.text("Prediction of ").ink(Role::Predicted, count(all, "track")).text(
            " in all hypotheses. Hypotheses that explain the past of a track alike share it, so it is predicted once.",
        ),
    }
}

/// An origin in words.
fn origin(of: Origin) -> String {
    match of {
        Origin::Track(id) => format!("track {id}"),
        Origin::New(id) => format!("the new track {id}"),
        Origin::False => "a false alarm".into(),
    }
}

fn claim(Claim { detection, origin: of }: &Claim) -> String {
    format!("detection {} is {}", detection + 1, origin(*of))
}

/// What a hypothesis says of the detections of a frame, those of tracks first.
fn claims(all: &[Claim], frame: usize) -> String {
    let is_false = |claim: &&Claim| claim.origin == Origin::False;
    let tracks = all.iter().filter(|claim| !is_false(claim));
    let mut told: Vec<String> = tracks.clone().take(LISTED).map(claim).collect();
    let others = tracks.count().saturating_sub(LISTED);
    if others > 0 {
        told.push(format!("{} belong to tracks", count(others, "other")));
    }
    match all.iter().filter(is_false).count() {
        0 => {}
        1 => told.push("1 detection is a false alarm".into()),
        wrong => told.push(format!("{wrong} detections are false alarms")),
    }
    if told.is_empty() { format!("no detection to explain in frame {frame}") } else { told.join(", ") }
}

fn revised(revisions: &[Revision]) -> Sentence {
    let named = |id: Option<u32>| id.map_or_else(|| "a false alarm".into(), |id| format!("track {id}"));
    let said = Sentence::default();
    let Some(first) = revisions.first() else { return said.text("No earlier decision has changed.") };
    let rest = match revisions.len() {
        1 => String::new(),
        all => format!(" {} of earlier frames in all have another origin now.", count(all, "detection")),
    };
    said.text(format!(
        "Deferred decision: in frame {}, detection {} was {} and is ",
        first.frame,
        first.detection + 1,
        named(first.before)
    ))
    .ink(Role::Estimate, named(first.now))
    .text(format!(
        " now. The detections since then have made another hypothesis the most probable, and the frames not decided yet are rewritten.{rest}"
    ))
}

/// The squared Mahalanobis distances in the gates.
fn distances(gates: &Gates) -> Option<Matrix> {
    let named = gates.tracks.iter().enumerate().map(|(i, track)| {
        let before = gates.tracks[..i].iter().filter(|other| other.id == track.id).count();
        // Tracks of one object with different pasts.
        if before == 0 { track.id.to_string() } else { format!("{}, past {}", track.id, before + 1) }
    });
    let names = Names::new(named, 0..gates.detections.len());
    let distance = |row, column| gates.distances.get(row, column).unwrap_or(f64::INFINITY);
    names
        .table(("d²", "squared Mahalanobis distance in the gate: tracks (rows), detections (columns)"), distance, &[])
        .map(|table| table.with_decimals(SQUARED_DECIMALS))
}

/// Reid's matrix: the origin of each detection in each branch, with the probabilities.
fn branch_tables(expansion: &Expansion) -> Vec<Matrix> {
    let all = &expansion.branches[..expansion.branches.len().min(ROWS)];
    let names = Names::new((1..=all.len()).map(|i| format!("H{i}")), expansion.detections.iter().copied());
    let entry = |row: usize, column: usize| match all[row].scan.claims.get(column).map(|claim| claim.origin) {
        Some(Origin::Track(id) | Origin::New(id)) => f64::from(id),
        _ => 0.0,
    };
    let is_new = |row: usize, column: usize| {
        matches!(all[row].scan.claims.get(column), Some(Claim { origin: Origin::New(_), .. }))
    };
    let cells = (0..all.len()).flat_map(|row| (0..expansion.detections.len()).map(move |column| (row, column)));
    let lit: Vec<(usize, usize)> = cells.filter(|(row, column)| is_new(*row, *column)).collect();
    let name = "track of each detection (columns) in each branch (rows); 0: false alarm, lit: new track";
    let column = |symbol, name, of: &dyn Fn(usize) -> f64| Matrix {
        symbol,
        name,
        role: Some(Role::Best),
        entries: Grid::from_fn(1, all.len(), |_, y| of(y)),
        rows: names.rows.clone(),
        columns: Vec::new(),
        changed: None,
        decimals: None,
    };
    let table = names.table(("Ω", name), entry, &lit).map(|table| table.with_decimals(0));
    let probability = column("P", "probability of the branch", &|y| all[y].probability);
    let parent = column("P₀", "probability of its parent", &|y| expansion.parents[all[y].parent]);
    table.into_iter().chain((!all.is_empty()).then_some([probability, parent]).into_iter().flatten()).collect()
}

/// Draws a prediction with its 95 % ellipse.
fn draw_prediction(scene: &mut Scene, track: &Track) {
    draw_box(scene, track, (Role::Predicted, "prediction"));
}

fn draw_box(scene: &mut Scene, track: &Track, (role, meaning): (Role, &'static str)) {
    let bounds = track.bounds();
    explain::rect(scene, role, bounds);
    if let Some(shape) = ellipse(track.filter.place(), track.filter.place_covariance(), 0.95) {
        scene.mark(Picture::CURRENT, role, shape);
    }
    explain::label(scene, role, bounds.min, track.id.to_string());
    scene.legend(role, meaning);
}

fn draw_track(scene: &mut Scene, track: &Track) {
    draw_box(scene, track, explain::role(track.age.status));
}

/// Draws the tracks of the leading hypotheses with their trajectories.
fn draw_leading(scene: &mut Scene, state: &State, seen: &Seen<MultiTracking<MultipleHypothesis>>) {
    let run = &seen.after.unwrap_or(seen.before).run;
    for cluster in &state.tracks {
        for track in cluster.hypotheses.first().iter().flat_map(|leader| &leader.tracks) {
            let track = &cluster.tracks[*track];
            explain::trail(scene, run, explain::role(track.age.status).0, (track.id, track.filter.place()));
            draw_track(scene, track);
        }
    }
}

/// The arrows of a branch, from the predictions to the detections.
fn arrows(gates: &Gates, expansion: &Expansion, scan: &Scan) -> Vec<Arrow> {
    let of = |claim: &Claim| {
        let Origin::Track(id) = claim.origin else { return None };
        let track = expansion.tracks.iter().find(|track| track.id == id)?;
        Some(Arrow { from: track.filter.place().map(|c| c as f32), to: gates.detections[claim.detection].center })
    };
    scan.claims.iter().filter_map(of).collect()
}

fn draw_branches(scene: &mut Scene, gates: &Gates, expansion: &Expansion) {
    expansion.tracks.iter().for_each(|track| draw_prediction(scene, track));
    let mut all = expansion.branches.iter().map(|branch| arrows(gates, expansion, &branch.scan));
    let best = all.next().unwrap_or_default();
    let others: Vec<Arrow> = all.take(ROWS).flatten().filter(|arrow| !best.contains(arrow)).collect();
    for (role, meaning, arrows) in
        [(Role::Candidate, "other branches", others), (Role::Best, "most probable branch", best)]
    {
        if !arrows.is_empty() {
            scene.mark(Picture::CURRENT, role, Shape::Arrows(arrows));
            scene.legend(role, meaning);
        }
    }
    for detection in &expansion.detections {
        explain::rect(scene, Role::Window, gates.detections[*detection].bounds);
        scene.legend(Role::Window, "detection of the cluster");
    }
    let detections = expansion.detections.iter().map(|detection| gates.detections[*detection].bounds);
    explain::work_on(scene, expansion.tracks.iter().map(|track| track.bounds()).chain(detections));
}

/// Draws the leading hypothesis, and the boxes of the second where it explains this frame otherwise.
fn draw_second(scene: &mut Scene, leading: &Leading, frame: usize) {
    let tracks = leading.scans.iter().flat_map(|scan| &scan.tracks);
    tracks.clone().for_each(|track| draw_track(scene, track));
    let Some(second) = leading.second.as_ref().filter(|second| second.frame == frame) else { return };
    for track in &second.scans[1].tracks {
        if !tracks.clone().any(|other| Arc::ptr_eq(other, track)) {
            draw_box(scene, track, (Role::Reference, "second hypothesis"));
        }
    }
}

/// Draws where the revised detections were.
fn draw_revisions(scene: &mut Scene, seen: &Seen<MultiTracking<MultipleHypothesis>>, revisions: &[Revision]) {
    let first = seen.before.run.span.first;
    for revision in revisions {
        let frame = revision.frame.checked_sub(first).and_then(|i| seen.before.run.frames().get(i));
        let Some(found) = frame.and_then(|frame| frame.detections.get(revision.detection)) else { continue };
        explain::rect(scene, Role::Reference, found.bounds);
        scene.legend(Role::Reference, "revised detection of an earlier frame");
    }
}
