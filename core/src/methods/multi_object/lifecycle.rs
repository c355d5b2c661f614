//! Track management: confirmation, coasting and deletion of tracks.

use crate::data::Detection;
use crate::params;
use crate::products::TrackStatus;

params! {
    /// The parameters of track management.
    #[derive(Copy)]
    pub struct Rules {
        /// Matched frames before a tentative track is confirmed. Higher values suppress false tracks, but delay new ones.
        min_hits: usize = 3, 1..=50;
        /// Minimum travel: the distance from its first position, as a share of the longer side of its box, that confirms the track of a blob.
        /// At least half of its path must lead away. Flicker persists in place, objects move consistently; detections that are not blobs
        /// need no travel.
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
    pub journey: Option<Journey>,
}

/// The motion of a blob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Journey {
    /// Its first and its last position in px.
    start: [f64; 2],
    last: [f64; 2],
    /// The length of its path in px.
    path_px: f64,
    /// The longer side of its last box in px.
    side_px: f64,
}

/// The least share of a path that leads away from its start, where motion is consistent.
const LEAST_STRAIGHT: f64 = 0.5;

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl Journey {
    fn begun(found: &Detection) -> Option<Self> {
        let at = found.center.map(f64::from);
        found.blob.map(|_| Self { start: at, last: at, path_px: 0.0, side_px: side_px(found) })
    }

    fn seen(self, found: &Detection) -> Self {
        let at = found.center.map(f64::from);
        Self { last: at, path_px: self.path_px + apart(self.last, at), side_px: side_px(found), ..self }
    }

    /// Returns the distance from the first position in px.
    pub fn net_px(&self) -> f64 {
        apart(self.start, self.last)
    }

    /// Returns the distance that confirms the track in px.
    pub fn least_px(&self, min_travel: f32) -> f64 {
        if min_travel <= 0.0 { 0.0 } else { (f64::from(min_travel) * self.side_px).max(LEAST_STRAIGHT * self.path_px) }
    }
}

fn side_px(found: &Detection) -> f64 {
    let [width, height] = found.bounds.size();
    f64::from(width.max(height))
}

impl Rules {
    /// Whether later frames change the tracks of earlier ones.
    pub(crate) fn looks_back(&self) -> bool {
        self.backdate || self.interpolate
    }

    /// Starts a track with its first detection.
    pub(crate) fn begun(&self, found: &Detection) -> TrackAge {
        let status = if self.min_hits <= 1 { TrackStatus::Confirmed } else { TrackStatus::Tentative };
        TrackAge { hits: 1, missed: 0, status, journey: Journey::begun(found) }
    }

    /// Counts a match with a detection.
    pub(crate) fn seen(&self, age: TrackAge, found: &Detection) -> TrackAge {
        let (hits, journey) = (age.hits + 1, age.journey.map(|journey| journey.seen(found)));
        let is_far = journey.is_none_or(|journey| journey.net_px() >= journey.least_px(self.min_travel));
        let is_confirmed = hits >= self.min_hits && is_far || age.status != TrackStatus::Tentative;
        let status = if is_confirmed { TrackStatus::Confirmed } else { TrackStatus::Tentative };
        TrackAge { hits, missed: 0, status, journey }
    }

    /// Counts a miss; `None` where the track is deleted.
    pub(crate) fn missed(&self, age: TrackAge) -> Option<TrackAge> {
        let missed = age.missed + 1;
        let is_over = missed > self.max_age || age.status == TrackStatus::Tentative;
        (!is_over).then_some(TrackAge { missed, status: TrackStatus::Coasting, ..age })
    }
}
