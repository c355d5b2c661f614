//! The steps of the blob tracker in words and tables.

use super::correspond::MOST_NEAR;
use super::vocabulary::{case, value};
use super::{BlobTracker, Correspondence, Decision, EventKind, Identity, Member, TrackedBlob, line};
use crate::geometry::Grid;
use crate::methods::multi_object::{
    explain::{self, Names},
    partial::WholeSize,
    tracking::{self, MultiTracking, errors, selected},
    truth,
    vocabulary::{case as shared_case, value as shared},
};
use crate::products::TrackStatus;
use crate::run::Seen;
use crate::scene::{Case, Matrix, Name, Number, Readout, Step, Unit};

/// The maximum number of tracks listed in a sentence.
const LISTED: usize = 12;

/// `1`, `1+2`.
pub(super) fn ids(members: &[Member]) -> String {
    members.iter().map(|member| member.id.to_string()).collect::<Vec<_>>().join("+")
}

/// The number of tracks, single or in groups.
fn tracks_of(tracked_blobs: &[TrackedBlob]) -> usize {
    tracked_blobs.iter().map(|tracked| tracked.members.len()).sum()
}

impl BlobTracker {
    pub(super) fn explanation(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let run = &seen.after.unwrap_or(seen.before).run;
        let decision = match seen.events.last().map(|event| &event.0) {
            Some(EventKind::Decided(decision)) => Some(&**decision),
            _ => None,
        };
        let mut tables: Vec<Matrix> =
            decision.and_then(|decision| self.dissimilarity_table(decision)).into_iter().collect();
        let table = seen.events.iter().find_map(|event| match &event.0 {
            EventKind::Corresponded(table) => Some(table),
            _ => None,
        });
        let step = match table {
            Some(table) => {
                let names =
                    Names::new(table.tracked_blobs.iter().map(|tracked| ids(&tracked.members)), 0..table.blobs.len());
                tables.extend(correspondence(table, &names, decision));
                names.add_shown_part(self.tell_event(seen))
            }
            None => self.tell_event(seen),
        };
        step.show_all((!tables.is_empty()).then_some(Readout::Matrices(tables))).show_all(explain::series(run))
    }

    fn tell_event(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let (frame, tracks) = (seen.before.run.frame(), &seen.after.unwrap_or(seen.before).tracks);
        let limits = |line: Name| {
            let step = Step::at(line).fact(shared::FRAME, frame).put(value::MIN_OVERLAP, 100.0 * self.min_overlap);
            step.put(shared::MIN_HITS, self.rules.min_hits).put(shared::MAX_AGE, self.rules.max_age)
        };
        let at = |line: Name| {
            let groups = tracks.iter().filter(|tracked| tracked.is_group()).count();
            let step = limits(line).fact(shared::TRACKS, tracks_of(tracks)).fact(value::GROUPS, groups);
            let step = errors(seen).iter().fold(step, truth::add_errors);
            selected(seen).filter(|_| seen.after.is_some()).iter().fold(step, |step, selected| selected.add_to(step))
        };
        match seen.events.last().map(|event| &event.0) {
            None => at(line::EACH_FRAME).say(case::OPENING),
            Some(EventKind::Detected(all, discarded)) => {
                let discarded = (*discarded, self.settings.min_score);
                explain::tell_detections(at(line::DETECT), (all.len(), Unit::count("blob")), discarded)
            }
            Some(EventKind::Predicted(all)) => {
                let step = at(line::PREDICT).put(shared::TRACKS, tracks_of(all)).put(value::TRACKED_BLOBS, all.len());
                step.put(value::VELOCITY_FRAMES, self.velocity_frames).say(match all.is_empty() {
                    true => shared_case::NONE_TO_PREDICT,
                    false if self.predict => case::PREDICTED,
                    false => case::KEPT,
                })
            }
            Some(EventKind::Corresponded(table)) => {
                let step = at(line::COMPUTE_OVERLAPS).put(value::CORRESPONDING, table.corresponding);
                let step =
                    step.put(shared::PAIRS, table.tracked_blobs.len() * table.blobs.len()).say(case::CORRESPONDING);
                let step = step.put(shared::CROWDED, table.crowded).put(shared::MOST_NEAR, MOST_NEAR);
                step.say_if(table.crowded > 0, case::CROWDED)
            }
            Some(EventKind::Decided(decision)) => match &decision.dissimilarity {
                Some(dissimilarity) => {
                    self.split(tell_decision(limits(line::SPLIT), decision), decision, dissimilarity)
                }
                None if decision.is_merge() => tell_decision(limits(line::MERGE), decision).say(case::MERGES),
                None if self.is_nearest(decision) => {
                    self.tell_update(limits(line::TAKE_NEAREST), decision, case::NEAREST)
                }
                None => self.tell_update(limits(line::GO_ON), decision, case::UPDATED),
            },
            Some(EventKind::Missed(tracked)) => {
                let missed = tracked.members.iter().map(|member| member.age.missed).max().unwrap_or(0);
                let step =
                    with_track(limits(line::COAST_OR_END), tracked).put(shared::MISSED, missed).say(name(tracked));
                explain::tell_misses(step.say(case::COASTS), missed)
            }
            Some(EventKind::Deleted(tracked)) => {
                let is_tentative = tracked.members.iter().all(|of| of.age.status == TrackStatus::Tentative);
                let step = with_track(limits(line::COAST_OR_END), tracked).say(name(tracked));
                step.say(if is_tentative { case::DELETED_TENTATIVE } else { case::DELETED_OLD })
            }
            Some(EventKind::Begun(tracked)) => {
                let step = with_track(limits(line::BEGIN_OBJECT), tracked).say(case::BEGUN);
                let statuses = tracked.members.iter().map(|member| member.age.status);
                statuses.fold(step, |step, status| explain::tell_tentative(step, status, self.rules))
            }
            Some(EventKind::Done(done, conclusion)) => {
                // The detections of a file have no shape: boxes of a person detector overlap where persons do.
                let are_boxes = !done.detections.is_empty() && done.detections.iter().all(|found| found.blob.is_none());
                let is_run = conclusion.run.is_some() && selected(seen).is_none();
                let step = tracking::tell_end(at(line::EACH_FRAME), seen, (done, conclusion));
                step.say_if(are_boxes && is_run, case::BOXES)
            }
        }
    }

    /// Returns whether the update is by the nearest-blob fallback.
    fn is_nearest(&self, decision: &Decision) -> bool {
        let is_enough = |share: f64| share > 0.0 && share >= f64::from(self.min_overlap);
        let is_linked =
            |&row: &usize| decision.columns.iter().any(|&column| is_enough(decision.table.share(row, column)));
        !decision.rows.iter().any(is_linked)
    }

    fn split(&self, step: Step, decision: &Decision, dissimilarity: &Grid<f64>) -> Step {
        let members = decision.members();
        let gray = |gray: Option<f64>| gray.map_or("unknown".into(), Number::from);
        let step = members.iter().fold(step, |step, member| {
            let step = step.put(shared::TRACK, member.id).put(value::GRAY, gray(member.gray));
            step.fact_as(value::AREA_BEFORE.is(member.area_px), case::LOOK_BEFORE)
        });
        let step = decision.columns.iter().fold(step, |step, column| {
            let blob = &decision.table.blobs[*column];
            let step = step.put(value::BLOB, column + 1).put(value::GRAY, gray(blob.gray));
            step.fact_as(value::AREA_AFTER.is(blob.area_px), case::LOOK_AFTER)
        });
        let step = match members.len() {
            1 => step.say(case::TRACK).say(case::SPLITS_OFF),
            _ => group(step, &members).say(case::GROUP).say(case::SPLITS),
        };
        let (criterion, unit) = match self.identity {
            Identity::Appearance => (case::BY_APPEARANCE, Unit::RATIO),
            Identity::Place => (case::BY_PLACE, Unit::PX),
        };
        let identified = pairs(decision, &members).into_iter().take(LISTED).enumerate();
        let step = identified.fold(step.say(criterion), |step, (i, (row, column))| {
            let step = step.say_if(i > 0, case::SEMICOLON).put(shared::TRACK, members[row].id);
            let step = step.put(value::BLOB, decision.columns[column] + 1);
            step.put_value(value::COST.is(dissimilarity[(column, row)]).in_unit(unit)).say(case::IDENTIFIED)
        });
        let others = members.len().saturating_sub(LISTED);
        step.put(value::OTHER_TRACKS, others).say(if others > 0 { case::OTHER_TRACKS } else { shared_case::END })
    }

    fn tell_update(&self, step: Step, decision: &Decision, case: &'static Case) -> Step {
        let step = tell_decision(step, decision);
        let ([row], [(column, tracked)]) = (&decision.rows[..], &decision.after[..]) else { return step };
        let table = &decision.table;
        let step = step.put(value::OVERLAP, 100.0 * table.share(*row, *column)).put(value::CENTER, tracked.center());
        let step = step.put(value::PREDICTED, table.tracked_blobs[*row].center());
        let step = step.put(value::DISTANCE, table.distance(*row, *column)).put(value::MAX_DISTANCE, self.max_distance);
        let step = step.say(name(tracked)).say(case);
        let is_hidden = matches!(tracked.members[..], [Member { size: WholeSize { hidden_frames: 1.., .. }, .. }]);
        let (step, members) = (step.say_if(is_hidden, case::HIDDEN), decision.members());
        match members.iter().zip(&tracked.members).find(|(was, is)| was.age.status != is.age.status) {
            Some((was, is)) if was.age.status == TrackStatus::Tentative => {
                step.put(shared::HITS, is.age.hits).say(case::CONFIRMED)
            }
            Some((was, _)) => step.put(shared::MISSED, was.age.missed).say(case::MATCHED_AGAIN),
            None => step,
        }
    }

    /// The costs of a split, with the assignment lit.
    fn dissimilarity_table(&self, decision: &Decision) -> Option<Matrix> {
        let (members, dissimilarity) = (decision.members(), decision.dissimilarity.as_ref()?);
        let name = match self.identity {
            Identity::Appearance => "cost |Δ gray| / 20 + |log₂ area ratio|: tracks (rows), blobs (columns)",
            Identity::Place => "distance from the predicted position in px: tracks (rows), blobs (columns)",
        };
        let names = Names::new(members.iter().map(|member| member.id.to_string()), decision.columns.iter().copied());
        names.table(("D", name), |row, column| dissimilarity[(column, row)], &pairs(decision, &members))
    }
}

fn name(tracked: &TrackedBlob) -> &'static Case {
    if tracked.is_group() { case::GROUP } else { case::TRACK }
}

/// Adds a track or a group among the facts.
fn with_track(step: Step, tracked: &TrackedBlob) -> Step {
    let step = match &tracked.members[..] {
        [member] => {
            let step = step.fact(shared::TRACK, member.id).fact(shared::STATUS, member.age.status.name());
            step.fact(shared::HITS, member.age.hits)
        }
        members => group(step, members),
    };
    tracked.velocity().into_iter().fold(step, explain::add_velocity)
}

/// Adds the track after an update and its blobs among the facts.
fn tell_decision(step: Step, decision: &Decision) -> Step {
    let step = match &decision.after[..] {
        [(_, tracked)] => with_track(step, tracked),
        _ => step,
    };
    match decision.columns[..] {
        [column] => step.fact(value::BLOB, column + 1),
        ref all => step.fact(value::BLOBS, all.iter().map(|column| column + 1).collect::<Number>()),
    }
}

fn group(step: Step, members: &[Member]) -> Step {
    step.fact(value::MEMBERS, members.iter().map(|member| member.id).collect::<Number>())
}

/// The row and the column of each track of a split in the table of its costs.
fn pairs(decision: &Decision, members: &[Member]) -> Vec<(usize, usize)> {
    let row = |id: u32| members.binary_search_by_key(&id, |member| member.id).ok();
    let all = decision.after.iter().flat_map(|(column, tracked)| {
        let column = decision.columns.binary_search(column).ok();
        tracked.members.iter().filter_map(move |member| Some((row(member.id)?, column?)))
    });
    all.collect()
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
