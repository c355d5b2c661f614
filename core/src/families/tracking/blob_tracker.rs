//! Many objects without any filter: the blobs of a frame are matched with the objects by what they have in common.

mod correspond;
mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::geometry::{Bounds, Grid};
use crate::methods::multi_object::{
    course::{self, Course},
    lifecycle::{Age, Rules},
};
use crate::products::{
    Object, ObjectField, ObjectFrame, Output, Product, ProductKind,
    objects::{
        assignment::{Effort, least_cost},
        pairs::Pairs,
    },
};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen};
use crate::scene::{Chart, Role, Scene, Step};
use crate::{choices, params, pseudocode};
use correspond::{Blob, Table};

choices! {
    /// What tells who is who where a group splits.
    pub enum Identity {
        /// Mean gray and area, as they were before the objects merged.
        Appearance = "appearance" "Appearance",
        /// The place where each would be, had it gone on as before the objects merged.
        Place = "place" "Place",
    }
}

params! {
    /// Many objects, matched from frame to frame by overlap.
    pub struct BlobTracker {
        /// The frames of the run, and the source of the detections.
        given: course::Settings = course::Settings::default();
        /// Objects are expected where their velocity leads; otherwise where they were last.
        predict: bool = true;
        /// An object's velocity is its mean displacement over so many frames in which it was last seen by itself.
        velocity_frames: usize = 5, 1..=50;
        /// An object and a blob correspond if at least this share of the smaller of both boxes lies in the other.
        min_overlap: f32 = 0.3, 0.01..=1.0;
        /// An object that corresponds to no blob goes on with the nearest one that is left, if its centre is at most this far.
        max_distance: f32 = 30.0, 0.0..=1000.0, "px";
        /// What tells who is who where a group splits.
        identity: Identity = Identity::Appearance;
        /// When a track is confirmed, and when it is deleted.
        rules: Rules = Rules::default();
    }
    advanced { "velocity-frames", "max-distance" }
    when {
        "velocity-frames": |p| p.predict, "The frames of the velocity have no effect without prediction.";
    }
}

/// A difference of so many gray levels is as unlike as an area twice as large.
const GRAY_LEVELS: f64 = 20.0;

/// Who is who in a split is worked out from so many pairs at most, some tenths of a second long; then whoever is most alike goes
/// first.
const MOST_WORK: u64 = 20_000_000;

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    course: Course,
    bodies: Vec<Body>,
}

/// Whatever is one blob: an object by itself, or several that have merged into a group.
#[derive(Clone, Debug)]
struct Body {
    /// Its box, where it was last seen or is expected by now.
    bounds: Bounds,
    /// The centres of its blob in the frames in which it was last seen, the oldest first.
    centers: Vec<[f64; 2]>,
    /// At least one, by identity.
    members: Vec<Member>,
}

/// An object.
#[derive(Clone, Debug)]
struct Member {
    id: u32,
    age: Age,
    /// What it looks like by itself: mean gray, where that is known, and area in px.
    gray: Option<f64>,
    area_px: f64,
    /// Its box and its centre in px, and its velocity in px/frame as it was when it was last seen by itself.
    bounds: Bounds,
    center: [f64; 2],
    velocity: Option<[f64; 2]>,
}

/// What happens in a frame.
#[derive(Clone, Debug)]
pub struct Event(What);

#[derive(Clone, Debug)]
enum What {
    /// What was detected, and how much of it is left out.
    Looked(Arc<Vec<Blob>>, usize),
    /// Where all objects are expected.
    Expected(Arc<Vec<Body>>),
    /// Which objects and blobs correspond.
    Corresponded(Arc<Table>),
    /// What becomes of objects that have blobs.
    Decided(Arc<Decision>),
    /// An object or a group was not seen.
    Missed(Arc<Body>),
    /// It is given up.
    Ended(Arc<Body>),
    /// An unassigned blob begins a track.
    Begun(Arc<Body>),
    /// The frame is over.
    Done(Arc<ObjectFrame>),
}

/// What becomes of objects and blobs that correspond.
#[derive(Clone, Debug)]
struct Decision {
    table: Arc<Table>,
    /// The rows and columns of the table.
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// Those that go on, each with the column of its blob.
    after: Vec<(usize, Body)>,
    /// What each object of a split, by identity, and each blob would cost.
    unlike: Option<Grid<f64>>,
}

impl Decision {
    fn is_merge(&self) -> bool {
        self.rows.len() > 1 && self.columns.len() == 1
    }

    fn is_split(&self) -> bool {
        self.columns.len() > 1
    }

    /// The objects that it is about, by identity.
    fn members(&self) -> Vec<Member> {
        members_of(&self.table, &self.rows)
    }
}

/// The objects of some rows, by identity.
fn members_of(table: &Table, rows: &[usize]) -> Vec<Member> {
    let mut members: Vec<Member> = rows.iter().flat_map(|&row| table.bodies[row].members.iter().cloned()).collect();
    members.sort_by_key(|member| member.id);
    members
}

impl Member {
    fn moved(&mut self, by: [f64; 2]) {
        self.center = [0, 1].map(|i| self.center[i] + by[i]);
        self.bounds = self.bounds.moved(by.map(|c| c as f32));
    }

    fn object(&self, detection: Option<usize>) -> Object {
        let Self { id, bounds, center, velocity, age, .. } = *self;
        Object { id, bounds, life: age.life, position: center, velocity, covariance: None, detection }
    }
}

impl Body {
    /// Its velocity in px/frame: of an object the mean displacement of its blob, of a group that of all its objects until its
    /// own is known.
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

    /// Where it is expected in the next frame.
    fn expected(mut self) -> Self {
        let velocity = self.velocity().unwrap_or_default();
        self.bounds = self.bounds.moved(velocity.map(|c| c as f32));
        let is_group = self.is_group();
        for member in &mut self.members {
            // In a group everyone goes on as before.
            member.moved(if is_group { member.velocity.unwrap_or(velocity) } else { velocity });
        }
        self
    }

    /// What it looks like by itself becomes half of what is new.
    fn seen_alone(&mut self, blob: &Blob) {
        let (velocity, found) = (self.velocity(), &blob.detection);
        for member in &mut self.members {
            let gray = [member.gray, blob.gray].into_iter().flatten();
            let (sum, count) = gray.fold((0.0, 0), |(sum, count), gray| (sum + gray, count + 1));
            member.gray = (count > 0).then(|| sum / f64::from(count));
            member.area_px = (member.area_px + blob.area_px) / 2.0;
            (member.bounds, member.center, member.velocity) = (found.bounds, blob.center(), velocity);
        }
    }

    /// Everyone is somewhere in the blob.
    fn seen_as_group(&mut self, blob: &Blob) {
        let all = blob.detection.bounds;
        for member in &mut self.members {
            let own = member.bounds;
            let into = |i: usize| {
                let (low, high) = (all.min[i] - own.min[i], all.max[i] - own.max[i]);
                if low <= high { 0.0_f32.max(low).min(high) } else { all.center()[i] - own.center()[i] }
            };
            member.moved([0, 1].map(|i| f64::from(into(i))));
        }
    }
}

impl BlobTracker {
    /// Objects go on in one blob; `before` is the body that was there, if it was one.
    fn seen(&self, before: Option<&Body>, members: Vec<Member>, blob: &Blob) -> Body {
        // After a gap displacements begin anew.
        let before = before.filter(|body| body.members.iter().all(|member| member.age.missed == 0));
        let mut centers = before.map_or(Vec::new(), |body| body.centers.clone());
        centers.push(blob.center());
        // A displacement lies between two frames.
        let surplus = centers.len().saturating_sub(self.velocity_frames + 1);
        centers.drain(..surplus);
        let rules = self.rules;
        let members = members.into_iter().map(|member| Member { age: rules.seen(member.age), ..member }).collect();
        let mut body = Body { bounds: blob.detection.bounds, centers, members };
        if body.is_group() {
            body.seen_as_group(blob)
        } else {
            body.seen_alone(blob)
        }
        body
    }

    fn begun(&self, blob: &Blob, id: u32) -> Body {
        let member = Member {
            id,
            age: self.rules.begun(),
            gray: blob.gray,
            area_px: blob.area_px,
            bounds: blob.detection.bounds,
            center: blob.center(),
            velocity: None,
        };
        Body { bounds: blob.detection.bounds, centers: vec![blob.center()], members: vec![member] }
    }

    /// What is left of an object or a group that was not seen; `None` where it is given up.
    fn missed(&self, body: &Body) -> Option<Body> {
        let rules = self.rules;
        let left =
            body.members.iter().filter_map(|member| Some(Member { age: rules.missed(member.age)?, ..member.clone() }));
        let members: Vec<Member> = left.collect();
        (!members.is_empty()).then(|| Body { members, ..body.clone() })
    }

    /// How unlike each of `members` and of `blobs` are.
    fn unlike(&self, members: &[Member], blobs: &[&Blob]) -> Grid<f64> {
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

    /// What becomes of objects and blobs that correspond.
    ///
    /// # Errors
    /// If the work is cancelled.
    fn decide(
        &self,
        clip: &Clip,
        table: &Arc<Table>,
        (rows, columns): (Vec<usize>, Vec<usize>),
    ) -> Result<Decision, Error> {
        let members = members_of(table, &rows);
        let blobs: Vec<&Blob> = columns.iter().map(|&column| &table.blobs[column]).collect();
        let before = if rows.len() == 1 { rows.first().map(|&row| &table.bodies[row]) } else { None };
        if let [blob] = blobs[..] {
            let after = vec![(columns[0], self.seen(before, members, blob))];
            return Ok(Decision { table: Arc::clone(table), rows, columns, after, unlike: None });
        }
        let unlike = self.unlike(&members, &blobs);
        let pairs = least_cost(&Pairs::of(&unlike), &mut Effort::limited(MOST_WORK, &|| clip.wanted()))?.columns;
        // Who is left over where there are fewer blobs goes with the one that is most alike.
        let alike = |row: usize| {
            let costs = (0..blobs.len()).map(|x| unlike[(x, row)]).enumerate();
            costs.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(x, _)| x)
        };
        let mut shares = vec![Vec::new(); blobs.len()];
        for (row, member) in members.into_iter().enumerate() {
            shares[pairs[row].unwrap_or_else(|| alike(row))].push(member);
        }
        // An object by itself of which something has parted is still the one that it was.
        let before = before.filter(|body| !body.is_group());
        let all = shares.into_iter().zip(&columns).filter(|(members, _)| !members.is_empty());
        let after = all.map(|(members, &column)| (column, self.seen(before, members, &table.blobs[column]))).collect();
        Ok(Decision { table: Arc::clone(table), rows, columns, after, unlike: Some(unlike) })
    }

    /// Gives objects their blobs, ends and begins some; gives those there are in this frame.
    fn share_out(
        &self,
        clip: &Clip,
        state: &mut State,
        table: &Arc<Table>,
        observer: &mut impl Observer<Event>,
    ) -> Result<Vec<Object>, Error> {
        let mut objects = Vec::new();
        let mut is_taken = vec![false; table.blobs.len()];
        for (rows, columns) in table.parts() {
            if columns.is_empty() {
                let before = &table.bodies[rows[0]];
                let missed = self.missed(before);
                observer.see(|| match &missed {
                    Some(body) => Event(What::Missed(Arc::new(body.clone()))),
                    None => Event(What::Ended(Arc::new(before.clone()))),
                });
                objects.extend(missed.iter().flat_map(|body| body.members.iter().map(|member| member.object(None))));
                state.bodies.extend(missed);
                continue;
            }
            let decision = Arc::new(self.decide(clip, table, (rows, columns))?);
            observer.see(|| Event(What::Decided(Arc::clone(&decision))));
            let was = decision.members();
            for (column, body) in &decision.after {
                is_taken[*column] = true;
                for member in &body.members {
                    let object = member.object(Some(*column));
                    if let Ok(place) = was.binary_search_by_key(&member.id, |was| was.id) {
                        state.course.look_back(self.rules, &object, was[place].age);
                    }
                    objects.push(object);
                }
            }
            state.bodies.extend(decision.after.iter().map(|(_, body)| body.clone()));
        }
        for (column, blob) in table.blobs.iter().enumerate().filter(|(column, _)| !is_taken[*column]) {
            let body = self.begun(blob, state.course.next_id());
            observer.see(|| Event(What::Begun(Arc::new(body.clone()))));
            objects.extend(body.members.iter().map(|member| member.object(Some(column))));
            state.bodies.push(body);
        }
        objects.sort_by_key(|object| object.id);
        Ok(objects)
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    DETECT: "  detect blobs",
    PREDICT: "  expect every object where its mean displacement leads",
    COMPUTE_OVERLAPS: "  O(i, j) ← what the boxes of object i and blob j have in common, as a share of the smaller",
    TAKE_NEAREST: "  i and j correspond if O(i, j) ≥ min-overlap; else the nearest within max-distance",
    GO_ON: "  one object, one blob: the object goes on",
    MERGE: "  several objects, one blob: they merge into a group, and each keeps its identity",
    SPLIT: "  several blobs: the object or group splits, and appearance tells them apart",
    COAST_OR_END: "  no blob: the object coasts, or ends if it was not seen for too long",
    BEGIN_OBJECT: "  no object: a new one begins, tentative until it was seen often enough",
}

impl Estimator for BlobTracker {
    const INFO: Info = Info {
        id: "blob-tracker",
        name: "Blob tracker",
        family: "Tracking",
        summary: "Follows many objects by the overlap of their boxes from frame to frame: they go on, merge, split, come and go.",
        source: "I. Haritaoglu, D. Harwood and L. S. Davis, W4: real-time surveillance of people and their activities, PAMI 2000; \
                 correspondence matrix and identities after a merge: A. Senior, A. Hampapur, Y.-L. Tian, L. Brown, S. Pankanti and \
                 R. Bolle, Appearance models for occlusion handling, 2nd IEEE workshop on performance evaluation of tracking and \
                 surveillance, 2001",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const NEEDS_PICTURES: bool = false;
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ObjectField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State { course: Course::new(self.given.clone(), clip, frame)?, bodies: Vec::new() })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let is_gray_needed = self.identity == Identity::Appearance;
        let (found, left_out) = state.course.look(clip)?;
        let blobs = Blob::all((clip, state.course.frame()), found, is_gray_needed)?;
        observer.see(|| Event(What::Looked(Arc::new(blobs.clone()), left_out)));
        let bodies = std::mem::take(&mut state.bodies).into_iter();
        let bodies: Vec<Body> = bodies.map(|body| if self.predict { body.expected() } else { body }).collect();
        observer.see(|| Event(What::Expected(Arc::new(bodies.clone()))));
        let table = Arc::new(Table::new(clip, (bodies, blobs), (self.min_overlap, self.max_distance))?);
        observer.see(|| Event(What::Corresponded(Arc::clone(&table))));
        let objects = self.share_out(clip, state, &table, observer)?;
        let detections: Vec<Detection> = table.blobs.iter().map(|blob| blob.detection).collect();
        let frame = Arc::new(ObjectFrame { mask: None, detections, objects });
        observer.see(|| Event(What::Done(Arc::clone(&frame))));
        Ok(state.course.note(clip, frame))
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.course.span.frames()
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.course.place()
    }

    fn units_of(&self, _picture: (usize, usize), frames: usize) -> Option<usize> {
        Some(frames)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.course.frame())
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match &event.0 {
            What::Begun(_) => Some(Role::Reference),
            What::Ended(_) => Some(Role::Rejected),
            What::Decided(decision) if decision.is_merge() => Some(Role::Window),
            What::Decided(decision) if decision.is_split() => Some(Role::Best),
            _ => None,
        }
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn causal(&self) -> Option<Self> {
        self.rules.without_hindsight().map(|rules| Self { rules, ..self.clone() })
    }

    fn output(&self, state: &State) -> Output {
        Output::of(state.course.field())
    }
}

impl Footprint<State> for BlobTracker {
    fn need(&self, clip: &Clip) -> Need {
        super::need(clip)
    }

    fn state_bytes(&self, state: &State) -> usize {
        let bodies = state.bodies.iter().map(|body| size_of_val(&body.centers[..]) + size_of_val(&body.members[..]));
        state.course.own_bytes() + size_of_val(&state.bodies[..]) + bodies.sum::<usize>()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + state.course.shared_bytes()
    }
}
