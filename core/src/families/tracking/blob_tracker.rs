//! Blob tracking by overlap, for the blobs of a background model: tracks continue, merge into groups and split.

mod correspond;
mod explain;
mod marks;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::geometry::{Bounds, Grid};
use crate::methods::multi_object::{
    self,
    lifecycle::{Rules, TrackAge},
    partial::WholeSize,
    tracker_run::{self, Conclusion},
    tracking::{MultiTracker, MultiTracking},
};
use crate::products::{
    Object, ObjectFrame, TrackStatus,
    objects::{
        assignment::{WorkBudget, least_cost},
        pairs::Pairs,
    },
};
use crate::run::{Info, Need, Progress, Seen};
use crate::scene::{Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};
use correspond::{Blob, Correspondence};

choices! {
    /// The feature that restores identities after a split.
    pub enum Identity {
        /// Appearance: mean gray level and area before the merge.
        Appearance = "appearance" "Appearance",
        /// Position: extrapolated with the velocity before the merge.
        Place = "place" "Predicted position",
    }
}

params! {
    /// Multi-object tracking of blobs by the overlap of their boxes.
    pub struct BlobTracker {
        /// The frames of the run and the source of the detections.
        settings: tracker_run::Settings = tracker_run::Settings::default();
        /// Predict each position from the mean displacement per frame. Off: the last position is the prediction.
        predict: bool = true;
        /// Number of frames over which the velocity of a track is averaged. Frames within a group do not count.
        velocity_frames: usize = 5, 1..=50;
        /// Minimum intersection of two boxes as a share of the smaller one. Pairs with less do not correspond.
        min_overlap: f32 = 0.3, 0.01..=1.0;
        /// Maximum centre distance of the nearest-blob fallback, for tracks that overlap no blob.
        max_distance: f32 = 30.0, 0.0..=1000.0, "px";
        /// Criterion that restores identities after a split.
        identity: Identity = Identity::Appearance;
        /// Partial observation: where one side of a blob is hidden, its visible edges and the size of the track give its box. Off: boxes
        /// shrink with what is visible.
        partial: bool = true;
        /// Track management.
        rules: Rules = Rules::default();
    }
    advanced { "velocity-frames", "max-distance", "partial" }
    when {
        "velocity-frames": |p| p.predict, "The frames of the velocity have no effect without prediction.";
    }
}

/// The gray level difference that costs as much as a factor of two in area.
const GRAY_LEVELS: f64 = 20.0;

/// The maximum number of pairs visited by the assignment after a split, a few tenths of a second; beyond it the assignment is
/// greedy.
const MOST_WORK: u64 = 20_000_000;

type State = multi_object::tracking::State<Vec<TrackedBlob>>;

/// The tracks of one blob: a single track, or several that have merged into a group.
#[derive(Clone, Debug)]
pub struct TrackedBlob {
    /// The last box, or the predicted one.
    bounds: Bounds,
    /// The recent blob centres, the oldest first.
    centers: Vec<[f64; 2]>,
    /// At least one track, by identity.
    members: Vec<Member>,
}

/// A track, single or within a group.
#[derive(Clone, Debug)]
struct Member {
    id: u32,
    age: TrackAge,
    /// Its appearance as a single track: mean gray level, where known, and area in px.
    gray: Option<f64>,
    area_px: f64,
    /// Its size when no side is hidden.
    size: WholeSize,
    /// Its box and centre in px, and its last velocity as a single track in px/frame.
    bounds: Bounds,
    center: [f64; 2],
    velocity: Option<[f64; 2]>,
}

/// An event of a frame.
#[derive(Clone, Debug)]
pub struct Event(EventKind);

#[derive(Clone, Debug)]
enum EventKind {
    /// The detected blobs, and the number discarded by the minimum score.
    Detected(Arc<Vec<Blob>>, usize),
    /// The predicted tracks.
    Predicted(Arc<Vec<TrackedBlob>>),
    /// The correspondences of tracks and blobs.
    Corresponded(Arc<Correspondence>),
    /// The update of tracks by their blobs.
    Decided(Arc<Decision>),
    /// A track or a group without a blob.
    Missed(Arc<TrackedBlob>),
    /// A deleted track or group.
    Deleted(Arc<TrackedBlob>),
    /// A track that starts with an unmatched blob.
    Begun(Arc<TrackedBlob>),
    /// The finished frame and its conclusion.
    Done(Arc<ObjectFrame>, Box<Conclusion>),
}

/// The update of corresponding tracks and blobs: continuation, merge or split.
#[derive(Clone, Debug)]
struct Decision {
    table: Arc<Correspondence>,
    /// The rows (tracks) and columns (blobs) concerned.
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// The updated tracks, each with the column of its blob.
    after: Vec<(usize, TrackedBlob)>,
    /// The costs of a split: tracks by identity, and blobs.
    dissimilarity: Option<Grid<f64>>,
}

impl Decision {
    fn is_merge(&self) -> bool {
        self.rows.len() > 1 && self.columns.len() == 1
    }

    fn is_split(&self) -> bool {
        self.columns.len() > 1
    }

    /// Returns the tracks concerned, by identity.
    fn members(&self) -> Vec<Member> {
        members_of(&self.table, &self.rows)
    }
}

/// Returns the tracks of some rows, by identity.
fn members_of(table: &Correspondence, rows: &[usize]) -> Vec<Member> {
    let mut members: Vec<Member> =
        rows.iter().flat_map(|&row| table.tracked_blobs[row].members.iter().cloned()).collect();
    members.sort_by_key(|member| member.id);
    members
}

impl Member {
    fn move_by(&mut self, by: [f64; 2]) {
        self.center = [0, 1].map(|i| self.center[i] + by[i]);
        self.bounds = self.bounds.moved(by.map(|c| c as f32));
    }

    fn object(&self, detection: Option<usize>) -> Object {
        let Self { id, bounds, center, velocity, age, .. } = *self;
        Object { id, bounds, status: age.status, position: center, velocity, covariance: None, detection }
    }
}

impl TrackedBlob {
    /// Returns the velocity in px/frame: the mean displacement of the blob; of a new group the mean of its tracks' velocities.
    fn velocity(&self) -> Option<[f64; 2]> {
        if let [first, .., last] = &self.centers[..] {
            let frames = (self.centers.len() - 1) as f64;
            return Some([0, 1].map(|i| (last[i] - first[i]) / frames));
        }
        let known: Vec<[f64; 2]> = self.members.iter().filter_map(|member| member.velocity).collect();
        let mean = |i: usize| known.iter().map(|velocity| velocity[i]).sum::<f64>() / known.len() as f64;
        (!known.is_empty()).then(|| [0, 1].map(mean))
    }

    fn has(&self, id: u32) -> bool {
        self.members.iter().any(|member| member.id == id)
    }

    fn is_group(&self) -> bool {
        self.members.len() > 1
    }

    /// Predicts the next frame.
    fn predicted(mut self) -> Self {
        let velocity = self.velocity().unwrap_or_default();
        self.bounds = self.bounds.moved(velocity.map(|c| c as f32));
        let is_group = self.is_group();
        for member in &mut self.members {
            // Within a group each track keeps its own velocity.
            member.move_by(if is_group { member.velocity.unwrap_or(velocity) } else { velocity });
        }
        self
    }

    /// Updates a single track with its blob; the appearance moves half way to the new one.
    fn update_alone(&mut self, blob: &Blob) {
        let (velocity, found) = (self.velocity(), &blob.detection);
        for member in &mut self.members {
            let gray = [member.gray, blob.gray].into_iter().flatten();
            let (sum, count) = gray.fold((0.0, 0), |(sum, count), gray| (sum + gray, count + 1));
            member.gray = (count > 0).then(|| sum / f64::from(count));
            if !blob.is_completed {
                member.area_px = (member.area_px + blob.area_px) / 2.0;
            }
            member.size = member.size.seen(found, blob.is_completed);
            (member.bounds, member.center, member.velocity) = (found.bounds, blob.center(), velocity);
        }
    }

    /// Updates a group with its blob, keeping the box of each track inside.
    fn update_as_group(&mut self, blob: &Blob) {
        let all = blob.detection.bounds;
        for member in &mut self.members {
            let own = member.bounds;
            let into = |i: usize| {
                let (low, high) = (all.min[i] - own.min[i], all.max[i] - own.max[i]);
                if low <= high { 0.0_f32.max(low).min(high) } else { all.center()[i] - own.center()[i] }
            };
            member.move_by([0, 1].map(|i| f64::from(into(i))));
        }
    }
}

impl BlobTracker {
    /// Returns the whole blob of a single track, if one of its sides is hidden.
    fn completed(&self, members: &[Member], blob: &Blob, picture: (usize, usize)) -> Option<Blob> {
        let [member] = members else { return None };
        let is_possible = self.partial
            && blob.detection.blob.is_some()
            && member.age.status != TrackStatus::Tentative
            && member.size.hidden_frames < self.rules.max_age;
        let bounds = is_possible.then(|| member.size.completed(&blob.detection.bounds, &member.bounds, picture))??;
        // The centroid keeps its place in the box.
        let (own, whole) = (member.bounds.center(), bounds.center());
        let center = [0, 1].map(|i| whole[i] + (member.center[i] as f32 - own[i]));
        Some(Blob { detection: Detection { bounds, center, ..blob.detection }, is_completed: true, ..*blob })
    }

    /// Continues tracks in one blob; `before` is their state, if they were together.
    fn seen(&self, before: Option<&TrackedBlob>, members: Vec<Member>, blob: &Blob) -> TrackedBlob {
        // The velocity is reset after a gap.
        let before = before.filter(|tracked| tracked.members.iter().all(|member| member.age.missed == 0));
        let mut centers = before.map_or(Vec::new(), |tracked| tracked.centers.clone());
        centers.push(blob.center());
        // A displacement needs two frames.
        let surplus = centers.len().saturating_sub(self.velocity_frames + 1);
        centers.drain(..surplus);
        let rules = self.rules;
        let members = members
            .into_iter()
            .map(|member| Member { age: rules.seen(member.age, &blob.detection), ..member })
            .collect();
        let mut tracked = TrackedBlob { bounds: blob.detection.bounds, centers, members };
        if tracked.is_group() {
            tracked.update_as_group(blob)
        } else {
            tracked.update_alone(blob)
        }
        tracked
    }

    fn begun(&self, blob: &Blob, id: u32) -> TrackedBlob {
        let member = Member {
            id,
            age: self.rules.begun(&blob.detection),
            gray: blob.gray,
            area_px: blob.area_px,
            size: WholeSize::of(&blob.detection),
            bounds: blob.detection.bounds,
            center: blob.center(),
            velocity: None,
        };
        TrackedBlob { bounds: blob.detection.bounds, centers: vec![blob.center()], members: vec![member] }
    }

    /// Returns a track or group after a missed frame; `None` if it is deleted.
    fn missed(&self, tracked: &TrackedBlob) -> Option<TrackedBlob> {
        let rules = self.rules;
        let left = tracked
            .members
            .iter()
            .filter_map(|member| Some(Member { age: rules.missed(member.age)?, ..member.clone() }));
        let members: Vec<Member> = left.collect();
        (!members.is_empty()).then(|| TrackedBlob { members, ..tracked.clone() })
    }

    /// Returns the dissimilarity of tracks (rows) and blobs (columns).
    fn dissimilarity(&self, members: &[Member], blobs: &[&Blob]) -> Grid<f64> {
        Grid::from_fn(blobs.len(), members.len(), |x, y| {
            let (blob, member) = (blobs[x], &members[y]);
            match self.identity {
                Identity::Appearance => {
                    let gray = blob.gray.zip(member.gray).map_or(0.0, |(a, b)| (a - b).abs());
                    gray / GRAY_LEVELS + (blob.area_px.max(1.0) / member.area_px.max(1.0)).log2().abs()
                }
                Identity::Place => {
                    let center = blob.center();
                    (center[0] - member.center[0]).hypot(center[1] - member.center[1])
                }
            }
        })
    }

    /// Updates corresponding tracks and blobs.
    ///
    /// # Errors
    /// If the work is cancelled.
    fn decide(
        &self,
        clip: &Clip,
        table: &Arc<Correspondence>,
        (rows, columns): (Vec<usize>, Vec<usize>),
    ) -> Result<Decision, Error> {
        let members = members_of(table, &rows);
        let blobs: Vec<&Blob> = columns.iter().map(|&column| &table.blobs[column]).collect();
        let before = if rows.len() == 1 { rows.first().map(|&row| &table.tracked_blobs[row]) } else { None };
        let seen = |before, members: Vec<Member>, blob: &Blob| {
            let completed = self.completed(&members, blob, clip.size());
            self.seen(before, members, completed.as_ref().unwrap_or(blob))
        };
        if let [blob] = blobs[..] {
            let after = vec![(columns[0], seen(before, members, blob))];
            return Ok(Decision { table: Arc::clone(table), rows, columns, after, dissimilarity: None });
        }
        let dissimilarity = self.dissimilarity(&members, &blobs);
        let pairs =
            least_cost(&Pairs::of(&dissimilarity), &mut WorkBudget::limited(MOST_WORK, &|| clip.wanted()))?.columns;
        // With fewer blobs than tracks, the tracks left over join the most similar blob.
        let alike = |row: usize| {
            let costs = (0..blobs.len()).map(|x| dissimilarity[(x, row)]).enumerate();
            costs.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(x, _)| x)
        };
        let mut shares = vec![Vec::new(); blobs.len()];
        for (row, member) in members.into_iter().enumerate() {
            shares[pairs[row].unwrap_or_else(|| alike(row))].push(member);
        }
        // A single track from which something splits off keeps its history.
        let before = before.filter(|tracked| !tracked.is_group());
        let all = shares.into_iter().zip(&columns).filter(|(members, _)| !members.is_empty());
        let after = all.map(|(members, &column)| (column, seen(before, members, &table.blobs[column]))).collect();
        Ok(Decision { table: Arc::clone(table), rows, columns, after, dissimilarity: Some(dissimilarity) })
    }

    /// Updates, deletes and starts tracks; returns the objects of this frame.
    fn assign(
        &self,
        clip: &Clip,
        state: &mut State,
        table: &Arc<Correspondence>,
        observer: &mut impl Observer<Event>,
    ) -> Result<Vec<Object>, Error> {
        let mut objects = Vec::new();
        let mut is_taken = vec![false; table.blobs.len()];
        for (rows, columns) in table.parts() {
            if columns.is_empty() {
                let before = &table.tracked_blobs[rows[0]];
                let missed = self.missed(before);
                observer.see(|| match &missed {
                    Some(tracked) => Event(EventKind::Missed(Arc::new(tracked.clone()))),
                    None => Event(EventKind::Deleted(Arc::new(before.clone()))),
                });
                objects
                    .extend(missed.iter().flat_map(|tracked| tracked.members.iter().map(|member| member.object(None))));
                state.tracks.extend(missed);
                continue;
            }
            let decision = Arc::new(self.decide(clip, table, (rows, columns))?);
            observer.see(|| Event(EventKind::Decided(Arc::clone(&decision))));
            let was = decision.members();
            for (column, tracked) in &decision.after {
                is_taken[*column] = true;
                for member in &tracked.members {
                    let object = member.object(Some(*column));
                    if let Ok(place) = was.binary_search_by_key(&member.id, |was| was.id) {
                        state.run.look_back(self.rules, &object, was[place].age);
                    }
                    objects.push(object);
                }
            }
            state.tracks.extend(decision.after.iter().map(|(_, tracked)| tracked.clone()));
        }
        for (column, blob) in table.blobs.iter().enumerate().filter(|(column, _)| !is_taken[*column]) {
            let tracked = self.begun(blob, state.run.next_id());
            observer.see(|| Event(EventKind::Begun(Arc::new(tracked.clone()))));
            objects.extend(tracked.members.iter().map(|member| member.object(Some(column))));
            state.tracks.push(tracked);
        }
        objects.sort_by_key(|object| object.id);
        Ok(objects)
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    DETECT: "  detect blobs",
    PREDICT: "  predict each track with its mean displacement",
    COMPUTE_OVERLAPS: "  O(i, j) ← overlap of track i and blob j: intersection / area of the smaller box",
    TAKE_NEAREST: "  i, j correspond if O(i, j) ≥ min-overlap; else nearest blob within max-distance",
    GO_ON: "  one track, one blob: update the track",
    MERGE: "  several tracks, one blob: merge into a group, identities are kept",
    SPLIT: "  several blobs: split; assign identities by appearance or position",
    COAST_OR_END: "  no blob: the track coasts; deleted if tentative or missed > max-age frames",
    BEGIN_OBJECT: "  no track: start one, tentative until min-hits frames are matched",
}

impl MultiTracker for BlobTracker {
    const INFO: Info = Info {
        id: "blob-tracker",
        name: "Blob tracker",
        family: "Tracking",
        summary: "Tracks blobs of a background model by the overlap of their boxes: they continue, merge and split. For blobs that fuse, not for the detections of a person detector in a crowd.",
        source: "I. Haritaoglu, D. Harwood and L. S. Davis, W4: real-time surveillance of people and their activities, PAMI 2000; \
                 correspondence matrix and identities after a merge: A. Senior, A. Hampapur, Y.-L. Tian, L. Brown, S. Pankanti and \
                 R. Bolle, Appearance models for occlusion handling, 2nd IEEE workshop on performance evaluation of tracking and \
                 surveillance, 2001; partial observation: M. Xu and T. Ellis, BMVC 2002",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "associated",
        "What becomes of the next track?",
        &[
            Reply::at(line::GO_ON, "It is updated with a blob it overlaps"),
            Reply::at(line::TAKE_NEAREST, "It takes the nearest blob"),
            Reply::at(line::MERGE, "It merges into a group"),
            Reply::at(line::SPLIT, "Its group splits"),
            Reply::at(line::COAST_OR_END, "It has no blob"),
        ],
    )];
    type Tracks = Vec<TrackedBlob>;
    type Event = Event;

    fn settings(&self) -> &tracker_run::Settings {
        &self.settings
    }

    fn rules(&self) -> Rules {
        self.rules
    }

    fn track(
        &self,
        clip: &Clip,
        state: &mut State,
        (found, discarded): (Vec<Detection>, usize),
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        let is_gray_needed = self.identity == Identity::Appearance;
        let blobs = Blob::all((clip, state.run.frame()), found, is_gray_needed)?;
        observer.see(|| Event(EventKind::Detected(Arc::new(blobs.clone()), discarded)));
        let tracked_blobs = std::mem::take(&mut state.tracks).into_iter();
        let tracked_blobs: Vec<TrackedBlob> =
            tracked_blobs.map(|tracked| if self.predict { tracked.predicted() } else { tracked }).collect();
        observer.see(|| Event(EventKind::Predicted(Arc::new(tracked_blobs.clone()))));
        let table = Arc::new(Correspondence::new(clip, (tracked_blobs, blobs), (self.min_overlap, self.max_distance))?);
        observer.see(|| Event(EventKind::Corresponded(Arc::clone(&table))));
        let objects = self.assign(clip, state, &table, observer)?;
        let detections: Vec<Detection> = table.blobs.iter().map(|blob| blob.detection).collect();
        let frame = state.run.finished(self.rules, detections, objects);
        observer.see(|| {
            Event(EventKind::Done(Arc::clone(&frame), Box::new(state.run.conclusion(clip, &frame, (self.rules, None)))))
        });
        Ok(state.run.note(clip, self.rules, frame))
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match &event.0 {
            EventKind::Begun(_) => Some(Role::Reference),
            EventKind::Deleted(_) => Some(Role::Rejected),
            EventKind::Decided(decision) if decision.is_merge() => Some(Role::Window),
            EventKind::Decided(decision) if decision.is_split() => Some(Role::Best),
            _ => None,
        }
    }

    fn need(&self, clip: &Clip) -> Need {
        super::need(clip)
    }

    fn tracks_bytes(&self, tracks: &Vec<TrackedBlob>) -> usize {
        let of = |tracked: &TrackedBlob| size_of_val(&tracked.centers[..]) + size_of_val(&tracked.members[..]);
        size_of_val(&tracks[..]) + tracks.iter().map(of).sum::<usize>()
    }

    fn step(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }
}
