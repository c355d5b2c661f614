//! How the tracker is told and drawn.

use std::collections::BTreeSet;

use super::correspond::MOST_NEAR;
use super::{BlobTracker, TrackedBlob, Decision, Event, Identity, Member, State, Correspondence, EventKind, line};
use crate::geometry::Bounds;
use crate::methods::multi_object::explain::{self, Names, count, short};
use crate::products::TrackStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Matrix, Picture, Readout, Role, Scene, Sentence, Shape, Step};

/// So many are listed in a sentence; of others only the number is told.
const LISTED: usize = 12;

/// `1`, `1 and 2`, `1, 2 and 3`; of very many, the first ones and how many more there are.
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

/// `Object 3`, or `The group of objects 1 and 2`.
fn named(tracked: &TrackedBlob) -> String {
    if tracked.is_group() {
        format!("The group of objects {}", ids(&tracked.members))
    } else {
        format!("Object {}", ids(&tracked.members))
    }
}

fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

fn last(events: &[Event]) -> Option<&EventKind> {
    events.last().map(|event| &event.0)
}

fn gray(value: Option<f64>) -> String {
    value.map_or("unknown".into(), short)
}

impl BlobTracker {
    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let line = match last(seen.events) {
            None | Some(EventKind::Done(_)) => line::EACH_FRAME,
            Some(EventKind::Looked(..)) => line::DETECT,
            Some(EventKind::Expected(_)) => line::PREDICT,
            Some(EventKind::Corresponded(_)) => line::COMPUTE_OVERLAPS,
            Some(EventKind::Decided(decision)) if decision.is_split() => line::SPLIT,
            Some(EventKind::Decided(decision)) if decision.is_merge() => line::MERGE,
            Some(EventKind::Decided(decision)) if is_nearest(decision) => line::TAKE_NEAREST,
            Some(EventKind::Decided(_)) => line::GO_ON,
            Some(EventKind::Missed(_) | EventKind::Ended(_)) => line::COAST_OR_END,
            Some(EventKind::Begun(_)) => line::BEGIN_OBJECT,
        };
        Step { line, sentence: self.sentence(seen), readouts: self.readouts(seen) }
    }

    fn sentence(&self, seen: &Seen<Self>) -> Sentence {
        let said = Sentence::default();
        let frame = seen.before.run.frame();
        let Some(what) = last(seen.events) else {
            return said
                .text("What is ")
                .ink(Role::Measured, "detected")
                .text(" in a frame belongs to the objects with which its boxes overlap. Where that is one and one, an object goes on; \
                       otherwise objects merge or split.");
        };
        match what {
            EventKind::Looked(all, left_out) => {
                explain::looked((all.len(), "blob"), frame, (*left_out, self.settings.min_score))
            }
            EventKind::Expected(tracked_blobs) if tracked_blobs.is_empty() => {
                said.text("There is no object yet whose place could be expected.")
            }
            EventKind::Expected(tracked_blobs) if self.predict => {
                said.text("Each object is expected where its ").ink(Role::Predicted, "mean displacement").text(format!(
                    " over up to {} leads: {} in {}.",
                    count(self.velocity_frames, "frame"),
                    count(tracked_blobs.iter().map(|tracked| tracked.members.len()).sum(), "object"),
                    count(tracked_blobs.len(), "place")
                ))
            }
            EventKind::Expected(_) => said.text("Each object is expected where it was last."),
            EventKind::Corresponded(table) => said.text(format!(
                "Of {} {} have boxes that overlap enough: at least {} of the smaller one lies in the other.{}",
                count(table.tracked_blobs.len() * table.blobs.len(), "pair"),
                table.corresponding,
                percent(f64::from(self.min_overlap)),
                match table.crowded {
                    0 => String::new(),
                    all => format!(" Of {}, only the {MOST_NEAR} nearest blobs are compared.", count(all, "object")),
                }
            )),
            EventKind::Decided(decision) => self.decided(decision),
            EventKind::Missed(tracked) => said.ink(Role::Predicted, named(tracked)).text(format!(
                " has no blob and coasts for {}. After more than {} it is deleted.",
                count(tracked.members.iter().map(|member| member.age.missed).max().unwrap_or(0), "frame"),
                count(self.rules.patience, "frame")
            )),
            EventKind::Ended(tracked) => said.ink(Role::Rejected, named(tracked)).text(
                match tracked.members.iter().all(|member| member.age.status == TrackStatus::Tentative) {
                    true => " was not seen again and is deleted: it was still tentative.",
                    false => " was not seen for too long and is deleted.",
                },
            ),
            EventKind::Begun(tracked) => {
                said.text("An unassigned blob begins ").ink(Role::Reference, named(tracked).to_lowercase()).text(".")
            }
            EventKind::Done(done) => said.text(explain::done(frame, done)),
        }
    }

    fn decided(&self, decision: &Decision) -> Sentence {
        let said = Sentence::default();
        let blobs = listed(decision.columns.iter().map(|column| column + 1));
        let members = decision.members();
        if let Some(dissimilarity) = &decision.dissimilarity {
            let said = match &members[..] {
                [member] => said
                    .ink(Role::Window, format!("Object {}", member.id))
                    .text(format!(" overlaps blobs {blobs}: something parts from it.")),
                all => {
                    said.ink(Role::Window, format!("Objects {}", ids(all))).text(format!(" split into blobs {blobs}."))
                }
            };
            let mut said = said.text(match self.identity {
                Identity::Appearance => " By mean gray and area",
                Identity::Place => " By where each would be",
            });
            let order =
                decision.after.iter().flat_map(|(column, tracked)| tracked.members.iter().map(move |m| (m.id, *column)));
            for (i, (id, column)) in order.take(LISTED).enumerate() {
                let x = decision.columns.iter().position(|other| *other == column);
                let y = members.iter().position(|member| member.id == id);
                let cost = x.zip(y).map_or(0.0, |place| dissimilarity[place]);
                said = said
                    .text(if i == 0 { ", " } else { "; " })
                    .ink(Role::Estimate, format!("object {id}"))
                    .text(format!(" is blob {}, at a cost of {}", column + 1, short(cost)));
            }
            return match members.len().checked_sub(LISTED) {
                Some(more @ 1..) => said.text(format!("; and {more} more.")),
                _ => said.text("."),
            };
        }
        let Some((column, tracked)) = decision.after.first() else { return said };
        if decision.is_merge() {
            return said
                .ink(Role::Window, format!("Objects {}", ids(&members)))
                .text(format!(" have blob {blobs} in common: they merge into a group and keep their identities."));
        }
        let row = decision.rows.first().copied().unwrap_or(0);
        let table = &decision.table;
        let said = said.ink(Role::Estimate, named(tracked));
        let said = if is_nearest(decision) {
            said.text(format!(
                " overlaps no blob enough: it goes on with the nearest, blob {blobs}, {} px away.",
                short(table.distance(row, *column))
            ))
        } else {
            said.text(format!(
                " goes on in blob {blobs}: {} of the smaller box is in common.",
                percent(table.share(row, *column))
            ))
        };
        match members.iter().zip(&tracked.members).find(|(was, is)| was.age.status != is.age.status) {
            Some((was, is)) if was.age.status == TrackStatus::Tentative => {
                said.text(format!(" It was matched in {} and is confirmed.", count(is.age.hits, "frame")))
            }
            Some((was, _)) => said.text(format!(" It is back after {}.", count(was.age.missed, "frame"))),
            None => said,
        }
    }

    fn readouts(&self, seen: &Seen<Self>) -> Vec<Readout> {
        let run = &seen.after.unwrap_or(seen.before).run;
        let mut facts = vec![Fact::new("Frame", seen.before.run.frame().to_string(), None)];
        let mut tables = Vec::new();
        match last(seen.events) {
            Some(EventKind::Decided(decision)) => {
                facts.extend(decision_facts(decision));
                tables.extend(self.dissimilarity_table(decision));
            }
            Some(EventKind::Missed(tracked) | EventKind::Ended(tracked) | EventKind::Begun(tracked)) => facts.extend(tracked_facts(tracked)),
            _ => {
                let tracked_blobs = &seen.after.unwrap_or(seen.before).tracked_blobs;
                let objects: usize = tracked_blobs.iter().map(|tracked| tracked.members.len()).sum();
                facts.push(Fact::new("Objects", objects.to_string(), None));
                let groups = tracked_blobs.iter().filter(|tracked| tracked.is_group()).count();
                facts.push(Fact::new("Groups", groups.to_string(), None));
            }
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

    /// How dissimilarity the objects and blobs of a split are, with who is who lit.
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
            Identity::Appearance => {
                "how dissimilarity: |Δ gray| / 20 + |log₂ of the areas' ratio|, objects down, blobs across"
            }
            Identity::Place => "from where each would be, in px: objects down, blobs across",
        };
        let names = Names::new(members.iter().map(|member| member.id.to_string()), decision.columns.iter().copied());
        names.table(("D", name), |row, column| dissimilarity[(column, row)], &paired)
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let looked =
            seen.events.iter().find_map(|event| if let EventKind::Looked(all, _) = &event.0 { Some(all) } else { None });
        let blobs = looked.into_iter().flat_map(|all| all.iter());
        explain::draw_detections(scene, blobs.clone().map(|blob| &blob.detection));
        if seen.after.is_none() {
            for (i, blob) in blobs.enumerate() {
                let Bounds { min, max } = blob.detection.bounds;
                explain::label(scene, Role::Measured, [min[0], max[1]], format!("blob {}", i + 1));
            }
        }
        let state = seen.after.unwrap_or(seen.before);
        if seen.after.is_some() || seen.events.is_empty() {
            return state.tracked_blobs.iter().for_each(|tracked| draw_tracked(scene, tracked, state));
        }
        draw_work(seen, scene);
    }
}

/// Whether an object goes on with what is nearest.
fn is_nearest(decision: &Decision) -> bool {
    let is_linked = |&row: &usize| decision.columns.iter().any(|&column| decision.table.share(row, column) > 0.0);
    !decision.rows.iter().any(is_linked)
}

fn tracked_facts(tracked: &TrackedBlob) -> Vec<Fact> {
    let mut facts = vec![Fact::new(if tracked.is_group() { "Group" } else { "Object" }, ids(&tracked.members), None)];
    if let [member] = &tracked.members[..] {
        facts.push(Fact::new("State", member.age.status.name(), None));
        facts.push(Fact::new("Seen", count(member.age.hits, "frame"), None));
    }
    facts.extend(tracked.velocity().map(|velocity| Fact::new("Velocity", explain::speed(velocity), None)));
    facts
}

fn decision_facts(decision: &Decision) -> Vec<Fact> {
    let mut facts = match &decision.after[..] {
        [(_, tracked)] => tracked_facts(tracked),
        _ => Vec::new(),
    };
    facts.push(Fact::new("Blob", listed(decision.columns.iter().map(|column| column + 1)), Some(Role::Measured)));
    if decision.is_split() {
        let looks = |value: Option<f64>, area_px: f64| format!("gray {}, area {} px", gray(value), short(area_px));
        for member in decision.members() {
            let value = format!("{}: {}", member.id, looks(member.gray, member.area_px));
            facts.push(Fact::new("Object by itself", value, Some(Role::Predicted)));
        }
        for &column in &decision.columns {
            let blob = &decision.table.blobs[column];
            let value = format!("{}: {}", column + 1, looks(blob.gray, blob.area_px));
            facts.push(Fact::new("Blob now", value, Some(Role::Measured)));
        }
    }
    facts
}

/// The table, from when on there is one, and the decision that the step is about.
fn table_of<'a>(seen: &Seen<'a, BlobTracker>) -> Option<(&'a Correspondence, Option<&'a Decision>)> {
    let decision = match last(seen.events)? {
        EventKind::Decided(decision) => Some(&**decision),
        _ => None,
    };
    let table =
        seen.events.iter().find_map(|event| if let EventKind::Corresponded(all) = &event.0 { Some(all) } else { None });
    table.map(|table| (&**table, decision))
}

/// The overlaps of objects and blobs, with the correspondences lit.
fn correspondence(table: &Correspondence, names: &Names, decision: Option<&Decision>) -> impl Iterator<Item = Matrix> {
    let rows: Vec<usize> = decision.map_or_else(|| (0..table.tracked_blobs.len()).collect(), |decision| decision.rows.clone());
    let linked = rows.iter().flat_map(|&row| table.links(row).iter().map(move |column| (row, *column)));
    let lit: Vec<_> = linked.collect();
    let shares = ("O", "in common, as a share of the smaller box: objects down, blobs across");
    let overlaps = ("IoU", "intersection over union, by which pairs are chosen");
    let tables = [
        names.table(shares, |row, column| table.share(row, column), &lit),
        names.table(overlaps, |row, column| table.overlap(row, column), &lit),
    ];
    tables.into_iter().flatten()
}

/// The objects in the middle of a frame: those that were done already as they are now, the others where they are expected.
fn draw_work(seen: &Seen<BlobTracker>, scene: &mut Scene) {
    let before = seen.before;
    let expected =
        seen.events.iter().find_map(|event| if let EventKind::Expected(all) = &event.0 { Some(all) } else { None });
    let Some(expected) = expected else {
        return before.tracked_blobs.iter().for_each(|tracked| draw_tracked(scene, tracked, before));
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
            EventKind::Ended(tracked) => gone.extend(tracked.members.iter().map(|member| member.id)),
            EventKind::Begun(tracked) => done.push(&**tracked),
            _ => {}
        }
    }
    for tracked in expected.iter().filter(|tracked| !tracked.members.iter().any(|member| gone.contains(&member.id))) {
        explain::rect(scene, Role::Predicted, tracked.bounds);
        explain::label(scene, Role::Predicted, tracked.bounds.min, ids(&tracked.members));
        scene.legend(Role::Predicted, "predicted");
    }
    done.into_iter().for_each(|tracked| draw_tracked(scene, tracked, before));
    if !arrows.is_empty() {
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(arrows));
    }
}

/// From where objects are expected to the blobs in which they go on.
fn moves(decision: &Decision) -> impl Iterator<Item = Arrow> {
    let table = &decision.table;
    decision.after.iter().flat_map(move |(column, tracked)| {
        let to = table.blobs[*column].detection.center;
        let tracked_blobs = decision.rows.iter().map(|&row| &table.tracked_blobs[row]);
        let own = tracked_blobs.filter(|before| before.members.iter().any(|member| tracked.has(member.id)));
        own.map(move |before| Arrow { from: before.center().map(|c| c as f32), to })
    })
}

/// An object, or those of a group within its blob.
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
