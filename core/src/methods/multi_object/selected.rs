//! The track that is pointed at, explained by itself.

use super::tracker_run::TrackerRun;
use super::vocabulary::{case, value};
use crate::data::Clip;
use crate::geometry::Bounds;
use crate::products::{Object, ObjectFrame, TrackStatus};
use crate::scene::{Picture, Role, Scene, Shape, Step};

/// A track that ended is found at its places of this many last frames.
const RECENT_FRAMES: usize = 40;
/// Between the box of a track and the frame that marks it as selected, in px.
const AROUND_PX: f32 = 3.0;

/// A track with its values so far.
pub(crate) struct Selected {
    /// Its identity.
    pub id: u32,
    /// Its first frame, and its last so far.
    frames: [usize; 2],
    /// Whether it is in the last finished frame.
    is_live: bool,
    last: Object,
    /// Frames with a detection, and those without.
    hits: usize,
    missed: usize,
    length_px: f64,
    /// The true object that overlaps its last box most, and the IoU.
    truth: Option<(u32, f32)>,
}

/// Returns the identity of the track whose box is at `point`: in the last frame, or else in one of the frames before it.
pub(crate) fn track_at(run: &TrackerRun, point: [f32; 2]) -> Option<u32> {
    let holds = |bounds: &Bounds| (0..2).all(|i| bounds.min[i] <= point[i] && point[i] <= bounds.max[i]);
    let smallest = |frame: &ObjectFrame| {
        let there = frame.objects.iter().filter(|object| holds(&object.bounds));
        there.min_by(|a, b| a.bounds.area().total_cmp(&b.bounds.area())).map(|object| object.id)
    };
    run.frames().iter().rev().take(RECENT_FRAMES).find_map(|frame| smallest(frame))
}

impl Selected {
    /// Returns the track `id`, if there is or was one.
    pub fn of(run: &TrackerRun, clip: &Clip, id: u32) -> Option<Self> {
        let first = run.span.first;
        let frames = run.frames().iter().enumerate();
        let of_track: Vec<(usize, Object)> =
            frames.filter_map(|(i, frame)| Some((first + i, *frame.object(id)?))).collect();
        let (&(begun, _), &(t, last)) = (of_track.first()?, of_track.last()?);
        let hits = of_track.iter().filter(|(_, object)| object.detection.is_some()).count();
        let places: Vec<[f64; 2]> = of_track.iter().map(|(_, object)| object.position).collect();
        let step = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        let truth = clip.truth().and_then(|truth| truth.objects(t).ok().flatten()).unwrap_or_default();
        let overlaps = truth.iter().map(|object| (object.id, last.bounds.iou(&Bounds::from(object))));
        Some(Self {
            id,
            frames: [begun, t],
            is_live: t + 1 == run.frame(),
            last,
            hits,
            missed: places.len() - hits,
            length_px: places.windows(2).map(step).sum(),
            truth: overlaps.filter(|(_, iou)| *iou > 0.0).max_by(|a, b| a.1.total_cmp(&b.1)),
        })
    }

    /// Returns the mean speed along its path in px/frame, once it has one.
    fn speed(&self) -> Option<f64> {
        let [first, last] = self.frames;
        (last > first).then(|| self.length_px / (last - first) as f64)
    }

    /// Draws a frame around the box of the track, if it is in the last finished frame.
    pub fn draw(&self, scene: &mut Scene) {
        if self.is_live {
            let Bounds { min, max } = self.last.bounds;
            let shape = Shape::Rect { min: min.map(|c| c - AROUND_PX), max: max.map(|c| c + AROUND_PX) };
            scene.draw(Picture::CURRENT, (Role::Reference, "selected track"), shape);
        }
    }

    /// Adds the track among the facts.
    pub fn add_to(&self, step: Step) -> Step {
        let [first, last] = self.frames;
        let step = step.fact(value::SELECTED_TRACK, self.id).put(value::LAST_FRAME, last);
        let step = match self.is_live {
            true => step.fact(value::SELECTED_STATUS, self.last.status.name()),
            false => step.fact_as(value::SELECTED_STATUS.is("ended"), case::ENDED),
        };
        let step = step.fact_as(value::FIRST_FRAME.is(first), case::FRAMES).fact(value::MATCHED_FRAMES, self.hits);
        let step = step.fact(value::COASTED_FRAMES, self.missed).fact(value::PATH_LENGTH, self.length_px);
        let step = step.fact_if(value::MEAN_SPEED, self.speed());
        let Some((object, iou)) = self.truth else { return step };
        step.put(value::TRUE_OVERLAP, iou).fact_as(value::TRUE_OBJECT.is(object), case::OBJECT_OVERLAP)
    }

    /// Describes the track, with its values among the facts.
    pub fn tell(&self, step: Step) -> Step {
        let step = step.say(case::SELECTED).say(match (self.is_live, self.last.status) {
            (false, _) => case::ENDED,
            (true, TrackStatus::Tentative) => case::IS_TENTATIVE,
            (true, TrackStatus::Confirmed) => case::IS_CONFIRMED,
            (true, TrackStatus::Coasting) => case::COASTS,
        });
        let step = step.say(case::SINCE).say_if(self.speed().is_some(), case::PATH);
        let Some((_, iou)) = self.truth else { return step };
        step.say(case::OVERLAPS_TRUTH).say(match self.last.status {
            _ if iou < 0.5 => case::TOO_LITTLE,
            TrackStatus::Confirmed => case::ENOUGH,
            TrackStatus::Tentative => case::BUT_TENTATIVE,
            TrackStatus::Coasting => case::BUT_COASTING,
        })
    }
}
