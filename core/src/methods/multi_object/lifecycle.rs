//! Track management: confirmation, coasting and deletion of tracks.

use crate::data::Detection;
use crate::geometry::Bounds;
use crate::params;
use crate::products::{ObjectFrame, TrackStatus};

params! {
    /// The parameters of track management.
    #[derive(Copy)]
    pub struct Rules {
        /// Matched frames before a tentative track is confirmed. Higher values suppress false tracks, but delay new ones. In real time the
        /// tracks of the first min-hits frames of a run count as confirmed, as in SORT.
        min_hits: usize = 3, 1..=50;
        /// Net displacement of a blob over the background that confirms its track, as a share of the longer side of its box. It must be
        /// at least half of the path as well: flicker stays in place, objects travel. Other detections need no travel.
        min_travel: f32 = 0.4, 0.0..=10.0;
        /// Missed frames in a row before a confirmed track is deleted; a tentative one is deleted at the first miss. Higher values bridge longer occlusions, but keep lost tracks.
        max_age: usize = 15, 0..=500;
        /// Count the tentative frames of a track once it is confirmed. With hindsight (non-causal): in real time a track starts when it is
        /// confirmed.
        backdate: bool = true;
        /// Interpolate the boxes of coasted frames linearly once the track is matched again. With hindsight (non-causal): in real time there is a gap.
        interpolate: bool = true;
    }
    advanced { "backdate", "interpolate" }
}

/// The hits and misses of a track, and its status.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TrackAge {
    /// Matched frames in all.
    pub hits: usize,
    /// Missed frames in a row.
    pub missed: usize,
    /// Tentative, confirmed or coasting.
    pub status: TrackStatus,
    /// The motion of a blob since the start of its track; none of other detections.
    pub movement: Option<Movement>,
}

/// The motion of a blob relative to the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Movement {
    /// Its first and its last box in px, in coordinates of the background.
    first: Bounds,
    last: Bounds,
    /// The length of its path in px, without growth and shrinkage.
    path_px: f64,
}

/// The least share of a path that leads away from its start, for consistent motion.
const LEAST_STRAIGHT: f64 = 0.5;

/// Returns the box of a detection in coordinates of the background, in px.
fn placed(found: &Detection) -> Option<Bounds> {
    found.blob.map(|blob| found.bounds.moved(blob.background_px.map(|c| -c)))
}

fn side_px(bounds: &Bounds) -> f64 {
    let [width, height] = bounds.size();
    f64::from(width.max(height))
}

/// Returns the distance in px that the whole box has moved: along each axis the distance that both edges have moved in
/// the same direction. A blob that only grows or shrinks, as noise makes them do, moves one of them.
fn moved_px([from, to]: [&Bounds; 2]) -> f64 {
    let along = [0, 1].map(|axis| {
        let [low, high] = [to.min[axis] - from.min[axis], to.max[axis] - from.max[axis]];
        if low * high > 0.0 { f64::from(low.abs().min(high.abs())) } else { 0.0 }
    });
    along[0].hypot(along[1])
}

impl Movement {
    fn begun(found: &Detection) -> Option<Self> {
        placed(found).map(|first| Self { first, last: first, path_px: 0.0 })
    }

    fn seen(self, found: &Detection) -> Self {
        let last = placed(found).unwrap_or(self.last);
        Self { last, path_px: self.path_px + moved_px([&self.last, &last]), ..self }
    }

    /// Returns the distance in px that the centre of the box has moved from its first place.
    pub fn net_px(&self) -> f64 {
        let [from, to] = [self.first, self.last].map(|bounds| bounds.center());
        f64::from((to[0] - from[0]).hypot(to[1] - from[1]))
    }

    /// Returns the distance that confirms the track in px.
    pub fn least_px(&self, min_travel: f32) -> f64 {
        let longest = side_px(&self.first).max(side_px(&self.last));
        if min_travel <= 0.0 { 0.0 } else { (f64::from(min_travel) * longest).max(LEAST_STRAIGHT * self.path_px) }
    }
}

impl Rules {
    /// Whether later frames change the tracks of earlier ones.
    pub(crate) fn looks_back(&self) -> bool {
        self.backdate || self.interpolate
    }

    /// Confirms the matched tracks of one of the first frames of a run, of which `earlier` came before: within the first min-hits frames none
    /// can have as many hits (SORT). Blobs have to travel all the same.
    pub(crate) fn confirm_early(&self, earlier: usize, frame: &mut ObjectFrame) {
        if earlier >= self.min_hits {
            return;
        }
        let detections = &frame.detections;
        let is_box = |i: usize| detections.get(i).is_some_and(|found| found.blob.is_none());
        for object in frame.objects.iter_mut().filter(|object| object.detection.is_some_and(is_box)) {
            object.status = TrackStatus::Confirmed;
        }
    }

    /// Starts a track with its first detection.
    pub(crate) fn begun(&self, found: &Detection) -> TrackAge {
        let status = if self.min_hits <= 1 { TrackStatus::Confirmed } else { TrackStatus::Tentative };
        TrackAge { hits: 1, missed: 0, status, movement: Movement::begun(found) }
    }

    /// Counts a match with a detection.
    pub(crate) fn seen(&self, age: TrackAge, found: &Detection) -> TrackAge {
        let (hits, movement) = (age.hits + 1, age.movement.map(|movement| movement.seen(found)));
        let is_far = movement.is_none_or(|movement| movement.net_px() >= movement.least_px(self.min_travel));
        let is_confirmed = hits >= self.min_hits && is_far || age.status != TrackStatus::Tentative;
        let status = if is_confirmed { TrackStatus::Confirmed } else { TrackStatus::Tentative };
        TrackAge { hits, missed: 0, status, movement }
    }

    /// Counts a miss; `None` where the track is deleted.
    pub(crate) fn missed(&self, age: TrackAge) -> Option<TrackAge> {
        let missed = age.missed + 1;
        let is_over = missed > self.max_age || age.status == TrackStatus::Tentative;
        (!is_over).then_some(TrackAge { missed, status: TrackStatus::Coasting, ..age })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Blob;
    use crate::products::Object;

    fn found(min: [f32; 2], size: [f32; 2], background_px: [f32; 2]) -> Detection {
        let bounds = Bounds { min, max: [min[0] + size[0], min[1] + size[1]] };
        let blob = Blob { label: 1, area_px: 9, radii: [3.0; 2], angle_rad: 0.0, gray: 90.0, background_px };
        Detection { bounds, center: bounds.center(), score: 1.0, blob: Some(blob), deviation_px: None }
    }

    fn status(all: &[Detection]) -> TrackStatus {
        let rules = Rules::default();
        let age = all[1..].iter().fold(rules.begun(&all[0]), |age, found| rules.seen(age, found));
        age.status
    }

    #[test]
    fn the_first_frames_of_a_run_need_no_hits_but_blobs_need_to_travel() {
        let rules = Rules::default();
        let blob = found([0.0, 5.0], [20.0, 10.0], [0.0; 2]);
        let object = |detection| Object {
            id: 1,
            bounds: blob.bounds,
            status: TrackStatus::Tentative,
            position: [10.0; 2],
            velocity: None,
            covariance: None,
            detection,
        };
        let status = |earlier, detection, blob| {
            let detections = vec![Detection { blob, ..self::found([0.0, 5.0], [20.0, 10.0], [0.0; 2]) }];
            let mut frame = ObjectFrame { detections, objects: vec![object(detection)], ..ObjectFrame::default() };
            rules.confirm_early(earlier, &mut frame);
            frame.objects[0].status
        };
        assert_eq!(status(0, Some(0), None), TrackStatus::Confirmed);
        assert_eq!(status(2, Some(0), None), TrackStatus::Confirmed);
        assert_eq!(status(3, Some(0), None), TrackStatus::Tentative, "it can have three hits by then");
        assert_eq!(status(0, Some(0), blob.blob), TrackStatus::Tentative);
        assert_eq!(status(0, None, None), TrackStatus::Tentative);
    }

    #[test]
    fn what_moves_is_confirmed() {
        let all = [0.0, 4.0, 8.0, 12.0].map(|x| found([x, 5.0], [20.0, 10.0], [0.0; 2]));
        assert_eq!(status(&all), TrackStatus::Confirmed);
    }

    #[test]
    fn what_grows_or_shrinks_in_place_is_not() {
        let growing = [40.0, 50.0, 60.0, 80.0].map(|width| found([0.0, 5.0], [width, 10.0], [0.0; 2]));
        assert_eq!(status(&growing), TrackStatus::Tentative);
        let shrinking = [60.0, 40.0, 20.0].map(|width| found([60.0 - width, 5.0], [width, 10.0], [0.0; 2]));
        assert_eq!(status(&shrinking), TrackStatus::Tentative);
    }

    #[test]
    fn what_comes_from_behind_a_cover_is_confirmed() {
        let all = [10.0, 30.0, 50.0, 70.0].map(|width| found([0.0, 5.0], [width, 10.0], [0.0; 2]));
        assert_eq!(status(&all), TrackStatus::Confirmed);
    }

    #[test]
    fn what_moves_with_the_background_is_not() {
        let all = [0.0, 4.0, 8.0, 12.0].map(|x| found([x, 5.0], [20.0, 10.0], [x, 0.0]));
        assert_eq!(status(&all), TrackStatus::Tentative);
        let against = [0.0, 4.0, 8.0, 12.0].map(|x| found([50.0, 5.0], [20.0, 10.0], [x, 0.0]));
        assert_eq!(status(&against), TrackStatus::Confirmed, "it stays where the background goes");
    }
}
