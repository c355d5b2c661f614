//! The steps of the blob tracker in words, tables and marks.

use std::collections::BTreeSet;

use super::correspond::MOST_NEAR;
use super::{BlobTracker, Correspondence, Decision, Event, EventKind, Identity, Member, State, TrackedBlob, line};
use crate::base::words;
use crate::geometry::Bounds;
use crate::methods::multi_object::{
    explain::{self, Names, count},
    partial::WholeSize,
    selected::Selected,
    tracking::{MultiTracking, errors, selected},
    truth,
};
use crate::methods::numbers::{fixed, percent, px, ratio};
use crate::products::TrackStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Matrix, Picture, Readout, Role, Scene, Sentence, Shape, Step};

/// The maximum number of tracks or blobs listed in a sentence.
const LISTED: usize = 12;

/// `1`, `1 and 2`, `1, 2 and 3`; of a long list, the first ones and the number of the others.
fn listed(all: impl IntoIterator<Item = usize>) -> String {
    let mut names: Vec<String> = all.into_iter().map(|number| number.to_string()).collect();
    if let Some(more) = names.len().checked_sub(LISTED).filter(|more| *more > 0) {
        names.truncate(LISTED);
        names.push(format!("{more} more"));
    }
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

fn ids<'a>(members: impl IntoIterator<Item = &'a Member>) -> String {
    listed(members.into_iter().map(|member| member.id as usize))
}

/// `1`, `1+2`.
fn ids_short(members: &[Member]) -> String {
    members.iter().map(|member| member.id.to_string()).collect::<Vec<_>>().join("+")
}

/// `Track 3`, or `The group of tracks 1 and 2`.
fn named(tracked: &TrackedBlob) -> String {
    if tracked.is_group() {
        format!("The group of tracks {}", ids(&tracked.members))
    } else {
        format!("Track {}", ids(&tracked.members))
    }
}

/// The number of tracks, single or in groups.
fn tracks_of(tracked_blobs: &[TrackedBlob]) -> usize {
    tracked_blobs.iter().map(|tracked| tracked.members.len()).sum()
}

fn frames(number: usize) -> String {
    count(number, "frame")
}

fn hits(number: usize) -> String {
    count(number, "matched frame")
}

fn missed(number: usize) -> String {
    count(number, "missed frame")
}

fn last(events: &[Event]) -> Option<&EventKind> {
    events.last().map(|event| &event.0)
}

fn gray(value: Option<f64>) -> String {
    value.map_or("unknown".into(), |value| fixed(value, 1))
}

impl BlobTracker {
    pub(super) fn explained_step(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let line = match last(seen.events) {
            None | Some(EventKind::Done(..)) => line::EACH_FRAME,
            Some(EventKind::Detected(..)) => line::DETECT,
            Some(EventKind::Predicted(_)) => line::PREDICT,
            Some(EventKind::Corresponded(_)) => line::COMPUTE_OVERLAPS,
            Some(EventKind::Decided(decision)) if decision.is_split() => line::SPLIT,
            Some(EventKind::Decided(decision)) if decision.is_merge() => line::MERGE,
            Some(EventKind::Decided(decision)) if self.is_nearest(decision) => line::TAKE_NEAREST,
            Some(EventKind::Decided(_)) => line::GO_ON,
            Some(EventKind::Missed(_) | EventKind::Deleted(_)) => line::COAST_OR_END,
            Some(EventKind::Begun(_)) => line::BEGIN_OBJECT,
        };
        Step { values: Vec::new(), line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    /// Returns whether the update is by the nearest-blob fallback.
    fn is_nearest(&self, decision: &Decision) -> bool {
        let is_enough = |share: f64| share > 0.0 && share >= f64::from(self.min_overlap);
        let is_linked =
            |&row: &usize| decision.columns.iter().any(|&column| is_enough(decision.table.share(row, column)));
        !decision.rows.iter().any(is_linked)
    }

    fn sentence(&self, seen: &Seen<MultiTracking<Self>>) -> Sentence {
        let said = Sentence::default();
        let frame = seen.before.run.frame();
        let Some(event) = last(seen.events) else {
            return said
                .ink(Role::Measured, "Blobs")
                .text(" are matched with ")
                .ink(Role::Predicted, "predicted tracks")
                .text(" by the overlap of their boxes. One to one is an update; otherwise tracks merge or split.");
        };
        match event {
            EventKind::Detected(all, discarded) => {
                explain::detected((all.len(), "blob"), frame, (*discarded, self.settings.min_score))
            }
            EventKind::Predicted(tracked_blobs) if tracked_blobs.is_empty() => said.text("No tracks to predict yet."),
            EventKind::Predicted(tracked_blobs) if self.predict => said
                .text("Prediction of ")
                .ink(Role::Predicted, count(tracks_of(tracked_blobs), "track"))
                .text(format!(
                    " in {} by the mean displacement of up to {}.",
                    count(tracked_blobs.len(), "blob"),
                    count(self.velocity_frames, "frame")
                )),
            EventKind::Predicted(tracked_blobs) => said.text(format!(
                "Without prediction, the last position of {} is kept.",
                count(tracks_of(tracked_blobs), "track")
            )),
            EventKind::Corresponded(table) => said.text(format!(
                "Overlap of at least {} of the smaller box (the minimum overlap): {} of {}.{}",
                words::percent(self.min_overlap),
                table.corresponding,
                count(table.tracked_blobs.len() * table.blobs.len(), "pair"),
                match table.crowded {
                    0 => String::new(),
                    all => format!(" Of {}, only the {MOST_NEAR} nearest blobs are compared.", count(all, "track")),
                }
            )),
            EventKind::Decided(decision) => self.decided(decision),
            EventKind::Missed(tracked) => {
                let missed = tracked.members.iter().map(|member| member.age.missed).max().unwrap_or(0);
                said.ink(Role::Predicted, named(tracked)).text(format!(
                    " has no blob and coasts: {} (maximum age {}).",
                    explain::missed_in_a_row(missed),
                    self.rules.max_age
                ))
            }
            EventKind::Deleted(tracked) => said.ink(Role::Rejected, named(tracked)).text(
                match tracked.members.iter().all(|member| member.age.status == TrackStatus::Tentative) {
                    true => format!(
                        " is deleted: missed while tentative, before {} matches (the minimum number of hits).",
                        self.rules.min_hits
                    ),
                    false => {
                        format!(" is deleted: missed for more than {} (the maximum age).", frames(self.rules.max_age))
                    }
                },
            ),
            EventKind::Begun(tracked) => said
                .text("An unmatched blob starts ")
                .ink(Role::Reference, named(tracked).to_lowercase())
                .text(format!(". It is tentative until it has {} hits, the minimum number.", self.rules.min_hits)),
            EventKind::Done(done, conclusion) => {
                // The detections of a file have no shape: boxes of a person detector overlap where persons do.
                let are_boxes = !done.detections.is_empty() && done.detections.iter().all(|found| found.blob.is_none());
                if let Some(selected) = selected(seen) {
                    return selected.sentence();
                }
                let switches = errors(seen).as_ref().map(truth::switches).unwrap_or_default();
                said.text(explain::done(frame, done, conclusion) + &switches).text(match are_boxes && conclusion.run.is_some() {
                    true => " These detections are boxes, not blobs: where they overlap, tracks merge. The Kalman tracker suits them.",
                    false => "",
                })
            }
        }
    }

    fn decided(&self, decision: &Decision) -> Sentence {
        let said = Sentence::default();
        let blobs = listed(decision.columns.iter().map(|column| column + 1));
        let members = decision.members();
        if let Some(dissimilarity) = &decision.dissimilarity {
            let said = match &members[..] {
                [member] => said
                    .ink(Role::Window, format!("Track {}", member.id))
                    .text(format!(" overlaps blobs {blobs}, so a blob splits off.")),
                all => said
                    .ink(Role::Window, format!("The group of tracks {}", ids(all)))
                    .text(format!(" splits into blobs {blobs}.")),
            };
            let mut said = said.text(match self.identity {
                Identity::Appearance => " Least cost by gray level and area:",
                Identity::Place => " Least distance to the predicted position:",
            });
            let order = decision
                .after
                .iter()
                .flat_map(|(column, tracked)| tracked.members.iter().map(move |m| (m.id, *column)));
            for (i, (id, column)) in order.take(LISTED).enumerate() {
                let x = decision.columns.iter().position(|other| *other == column);
                let y = members.iter().position(|member| member.id == id);
                let cost = x.zip(y).map_or(0.0, |place| dissimilarity[place]);
                said = said
                    .text(if i == 0 { " " } else { "; " })
                    .ink(Role::Estimate, format!("track {id}"))
                    .text(format!(" is blob {} (cost {})", column + 1, self.cost(cost)));
            }
            return match members.len().checked_sub(LISTED) {
                Some(more @ 1..) => said.text(format!("; and {more} more.")),
                _ => said.text("."),
            };
        }
        let Some((column, tracked)) = decision.after.first() else { return said };
        if decision.is_merge() {
            return said
                .ink(Role::Window, format!("Tracks {}", ids(&members)))
                .text(format!(" share blob {blobs}: they merge into a group and keep their identities."));
        }
        let row = decision.rows.first().copied().unwrap_or(0);
        let table = &decision.table;
        let said = said.ink(Role::Estimate, named(tracked));
        let said = if self.is_nearest(decision) {
            said.text(format!(
                " overlaps no unmatched blob by {} (the minimum overlap). The nearest, blob {blobs}, is {} px away, within the maximum distance of {} px.",
                words::percent(self.min_overlap),
                px(table.distance(row, *column)),
                px(self.max_distance.into())
            ))
        } else {
            let from = table.tracked_blobs[row].center();
            let to = tracked.center();
            said.text(format!(
                " is updated with blob {blobs}: overlap {} ≥ {}. Its centre moves from the predicted {} to {} px.",
                percent(table.share(row, *column)),
                words::percent(self.min_overlap),
                words::place(from.map(|c| c as f32)),
                words::place(to.map(|c| c as f32))
            ))
        };
        let said = match tracked.members[..] {
            [Member { size: WholeSize { hidden_frames: 1.., .. }, .. }] => {
                said.text(" One side of the blob is hidden: its visible edges and the size of the track give the box.")
            }
            _ => said,
        };
        match members.iter().zip(&tracked.members).find(|(was, is)| was.age.status != is.age.status) {
            Some((was, is)) if was.age.status == TrackStatus::Tentative => said.text(format!(
                " Confirmed: {} reach the minimum number of hits, {}.",
                hits(is.age.hits),
                self.rules.min_hits
            )),
            Some((was, _)) => said.text(format!(" Matched again after {}.", missed(was.age.missed))),
            None => said,
        }
    }

    /// The cost of a track and a blob after a split as text.
    fn cost(&self, cost: f64) -> String {
        match self.identity {
            Identity::Appearance => ratio(cost),
            Identity::Place => format!("{} px", px(cost)),
        }
    }

    fn readouts(&self, seen: &Seen<MultiTracking<Self>>) -> Vec<Readout> {
        let run = &seen.after.unwrap_or(seen.before).run;
        let mut facts = vec![Fact::new("Frame", seen.before.run.frame().to_string(), None)];
        let mut tables = Vec::new();
        match last(seen.events) {
            Some(EventKind::Decided(decision)) => {
                facts.extend(decision_facts(decision));
                tables.extend(self.dissimilarity_table(decision));
            }
            Some(EventKind::Missed(tracked) | EventKind::Deleted(tracked) | EventKind::Begun(tracked)) => {
                facts.extend(tracked_facts(tracked))
            }
            _ => {
                let tracked_blobs = &seen.after.unwrap_or(seen.before).tracks;
                facts.push(Fact::new("Tracks", tracks_of(tracked_blobs).to_string(), None));
                let groups = tracked_blobs.iter().filter(|tracked| tracked.is_group()).count();
                facts.push(Fact::new("Groups", groups.to_string(), None));
            }
        }
        facts.extend(errors(seen).iter().flat_map(truth::facts));
        if seen.after.is_some() {
            facts.extend(selected(seen).iter().flat_map(Selected::facts));
        }
        if let Some((table, decision)) = table_of(seen) {
            let rows = table.tracked_blobs.iter().map(|tracked| ids_short(&tracked.members));
            let names = Names::new(rows, 0..table.blobs.len());
            facts.extend(names.shown());
            tables.extend(correspondence(table, &names, decision));
        }
        let mut readouts = vec![Readout::Facts(facts)];
        readouts.extend((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        readouts.extend(explain::series(run));
        readouts
    }

    /// The costs of a split, with the assignment lit.
    fn dissimilarity_table(&self, decision: &Decision) -> Option<Matrix> {
        let members = decision.members();
        let dissimilarity = decision.dissimilarity.as_ref()?;
        let paired = decision.after.iter().flat_map(|(column, tracked)| {
            let column = decision.columns.binary_search(column).ok();
            tracked.members.iter().map(move |member| Some((member.id, column?)))
        });
        let row = |id: u32| members.binary_search_by_key(&id, |member| member.id).ok();
        let paired: Vec<_> = paired.flatten().filter_map(|(id, column)| Some((row(id)?, column))).collect();
        let name = match self.identity {
            Identity::Appearance => "cost |Δ gray| / 20 + |log₂ area ratio|: tracks (rows), blobs (columns)",
            Identity::Place => "distance from the predicted position in px: tracks (rows), blobs (columns)",
        };
        let names = Names::new(members.iter().map(|member| member.id.to_string()), decision.columns.iter().copied());
        names.table(("D", name), |row, column| dissimilarity[(column, row)], &paired)
    }

    pub(super) fn drawn(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected = seen
            .events
            .iter()
            .find_map(|event| if let EventKind::Detected(all, _) = &event.0 { Some(all) } else { None });
        let blobs = detected.into_iter().flat_map(|all| all.iter());
        explain::draw_detections(scene, blobs.clone().map(|blob| &blob.detection));
        if seen.after.is_none() {
            for (i, blob) in blobs.enumerate() {
                let Bounds { min, max } = blob.detection.bounds;
                explain::label(scene, Role::Measured, [min[0], max[1]], format!("blob {}", i + 1));
            }
        }
        scene.is_overview = seen.after.is_some() && seen.point().is_none();
        errors(seen).iter().for_each(|errors| truth::draw(scene, errors));
        let state = seen.after.unwrap_or(seen.before);
        if seen.after.is_some() || seen.events.is_empty() {
            return state.tracks.iter().for_each(|tracked| draw_tracked(scene, tracked, state));
        }
        draw_work(seen, scene);
    }
}

fn tracked_facts(tracked: &TrackedBlob) -> Vec<Fact> {
    let mut facts = vec![Fact::new(if tracked.is_group() { "Group" } else { "Track" }, ids(&tracked.members), None)];
    if let [member] = &tracked.members[..] {
        facts.push(Fact::new("Status", member.age.status.name(), None));
        facts.push(Fact::new("Hits", hits(member.age.hits), None));
    }
    facts.extend(tracked.velocity().map(|velocity| Fact::new("Velocity", explain::velocity(velocity), None)));
    facts
}

fn decision_facts(decision: &Decision) -> Vec<Fact> {
    let mut facts = match &decision.after[..] {
        [(_, tracked)] => tracked_facts(tracked),
        _ => Vec::new(),
    };
    facts.push(Fact::new("Blob", listed(decision.columns.iter().map(|column| column + 1)), Some(Role::Measured)));
    if decision.is_split() {
        let looks =
            |value: Option<f64>, area_px: f64| format!("gray level {}, area {} px", gray(value), fixed(area_px, 0));
        for member in decision.members() {
            let value = format!("track {}: {}", member.id, looks(member.gray, member.area_px));
            facts.push(Fact::new("Before the merge", value, Some(Role::Predicted)));
        }
        for &column in &decision.columns {
            let blob = &decision.table.blobs[column];
            let value = format!("blob {}: {}", column + 1, looks(blob.gray, blob.area_px));
            facts.push(Fact::new("Blob", value, Some(Role::Measured)));
        }
    }
    facts
}

/// The correspondence, once it is computed, and the update of the step.
fn table_of<'a>(seen: &Seen<'a, MultiTracking<BlobTracker>>) -> Option<(&'a Correspondence, Option<&'a Decision>)> {
    let decision = match last(seen.events)? {
        EventKind::Decided(decision) => Some(&**decision),
        _ => None,
    };
    let table =
        seen.events.iter().find_map(|event| if let EventKind::Corresponded(all) = &event.0 { Some(all) } else { None });
    table.map(|table| (&**table, decision))
}

/// The overlaps of tracks and blobs, with the correspondences lit.
fn correspondence(table: &Correspondence, names: &Names, decision: Option<&Decision>) -> impl Iterator<Item = Matrix> {
    let rows: Vec<usize> =
        decision.map_or_else(|| (0..table.tracked_blobs.len()).collect(), |decision| decision.rows.clone());
    let linked = rows.iter().flat_map(|&row| table.links(row).iter().map(move |column| (row, *column)));
    let lit: Vec<_> = linked.collect();
    let shares = ("O", "intersection / smaller box: tracks (rows), blobs (columns)");
    let overlaps = ("IoU", "intersection over union, which orders the pairs");
    let tables = [
        names.table(shares, |row, column| table.share(row, column), &lit),
        names.table(overlaps, |row, column| table.overlap(row, column), &lit),
    ];
    tables.into_iter().flatten()
}

/// Draws the tracks within a frame: updated, or else predicted.
fn draw_work(seen: &Seen<MultiTracking<BlobTracker>>, scene: &mut Scene) {
    let before = seen.before;
    let predicted =
        seen.events.iter().find_map(|event| if let EventKind::Predicted(all) = &event.0 { Some(all) } else { None });
    let Some(predicted) = predicted else {
        return before.tracks.iter().for_each(|tracked| draw_tracked(scene, tracked, before));
    };
    let (mut gone, mut done, mut arrows) = (BTreeSet::new(), Vec::new(), Vec::new());
    for event in seen.events {
        match &event.0 {
            EventKind::Decided(decision) => {
                arrows.extend(moves(decision));
                done.extend(decision.after.iter().map(|(_, tracked)| tracked));
                gone.extend(decision.members().iter().map(|member| member.id));
            }
            EventKind::Missed(tracked) => {
                done.push(&**tracked);
                gone.extend(tracked.members.iter().map(|member| member.id));
            }
            EventKind::Deleted(tracked) => gone.extend(tracked.members.iter().map(|member| member.id)),
            EventKind::Begun(tracked) => done.push(&**tracked),
            _ => {}
        }
    }
    for tracked in predicted.iter().filter(|tracked| !tracked.members.iter().any(|member| gone.contains(&member.id))) {
        explain::rect(scene, Role::Predicted, tracked.bounds);
        explain::label(scene, Role::Predicted, tracked.bounds.min, ids(&tracked.members));
        scene.legend(Role::Predicted, "prediction");
    }
    done.into_iter().for_each(|tracked| draw_tracked(scene, tracked, before));
    if !arrows.is_empty() {
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(arrows));
    }
}

/// Arrows from the predictions to the blobs of their tracks.
fn moves(decision: &Decision) -> impl Iterator<Item = Arrow> {
    let table = &decision.table;
    decision.after.iter().flat_map(move |(column, tracked)| {
        let to = table.blobs[*column].detection.center;
        let tracked_blobs = decision.rows.iter().map(|&row| &table.tracked_blobs[row]);
        let own = tracked_blobs.filter(|before| before.members.iter().any(|member| tracked.has(member.id)));
        own.map(move |before| Arrow { from: before.center().map(|c| c as f32), to })
    })
}

/// Draws a track, or those of a group within its blob.
fn draw_tracked(scene: &mut Scene, tracked: &TrackedBlob, state: &State) {
    if tracked.is_group() {
        explain::rect(scene, Role::Window, tracked.bounds);
        explain::label(
            scene,
            Role::Window,
            [tracked.bounds.min[0], tracked.bounds.max[1]],
            format!("group {}", ids(&tracked.members)),
        );
        scene.legend(Role::Window, "group");
    }
    for member in &tracked.members {
        let (role, meaning) = explain::role(member.age.status);
        explain::trail(scene, &state.run, role, (member.id, member.center));
        explain::rect(scene, role, member.bounds);
        explain::label(scene, role, member.bounds.min, member.id.to_string());
        scene.legend(role, meaning);
    }
}
