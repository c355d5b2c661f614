//! The track that is pointed at, explained by itself.

use super::explain::count;
use super::tracker_run::TrackerRun;
use crate::data::Clip;
use crate::geometry::Bounds;
use crate::methods::numbers::{px, ratio};
use crate::products::{Object, ObjectFrame, TrackStatus};
use crate::scene::{Fact, Picture, Role, Scene, Sentence, Shape};

/// A track that ended is found at its places of so many frames.
const RECENT_FRAMES: usize = 40;
/// Between the box of a track and the frame that marks it as selected, in px.
const AROUND_PX: f32 = 3.0;

/// A track, and what is known of it so far.
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
            scene.mark(Picture::CURRENT, Role::Reference, shape);
            scene.legend(Role::Reference, "selected track");
        }
    }

    /// Returns the track in words.
    pub fn sentence(&self) -> Sentence {
        let [first, last] = self.frames;
        let state = match (self.is_live, self.last.status) {
            (false, _) => format!("ended in frame {last}"),
            (true, TrackStatus::Tentative) => "is tentative".into(),
            (true, TrackStatus::Confirmed) => "is confirmed".into(),
            (true, TrackStatus::Coasting) => "coasts".into(),
        };
        let said =
            Sentence::default().text("Selected: ").ink(Role::Estimate, format!("track {}", self.id)).text(format!(
                " {state}. Since frame {first} it was matched in {} and coasted in {}.",
                count(self.hits, "frame"),
                self.missed
            ));
        let said = match self.speed() {
            Some(speed) => {
                said.text(format!(" Its path is {} px long, {} px/frame on average.", px(self.length_px), px(speed)))
            }
            None => said,
        };
        match self.truth {
            Some((object, iou)) => {
                let compared = match self.last.status {
                    _ if iou < 0.5 => "below 0.5, so they do not match",
                    TrackStatus::Confirmed => "at least 0.5, so they match",
                    TrackStatus::Tentative => "but a tentative track does not count as a match",
                    TrackStatus::Coasting => "but a coasting track does not count as a match",
                };
                said.text(" Its box overlaps ")
                    .ink(Role::Truth, format!("true object {object}"))
                    .text(format!(" (IoU {}), {compared}.", ratio(iou.into())))
            }
            None => said,
        }
    }

    /// Returns the track in numbers.
    pub fn facts(&self) -> Vec<Fact> {
        let [first, last] = self.frames;
        let status = if self.is_live { self.last.status.name().into() } else { format!("ended in frame {last}") };
        let mut facts = vec![
            Fact::new("Selected track", self.id.to_string(), Some(Role::Estimate)),
            Fact::new("Status of track", status, None),
            Fact::new("Frames", format!("{first} to {last}"), None),
            Fact::new("Matched", count(self.hits, "frame"), None),
            Fact::new("Coasted", count(self.missed, "frame"), None),
            Fact::new("Path length", format!("{} px", px(self.length_px)), None),
        ];
        facts.extend(self.speed().map(|speed| Fact::new("Mean speed", format!("{} px/frame", px(speed)), None)));
        facts.extend(self.truth.map(|(object, iou)| {
            Fact::new("True object", format!("{object}, IoU {}", ratio(iou.into())), Some(Role::Truth))
        }));
        facts
    }
}
