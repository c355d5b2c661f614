//! Track management: confirmation, coasting and deletion of tracks.

use crate::params;
use crate::products::TrackStatus;

params! {
    /// The parameters of track management.
    #[derive(Copy)]
    pub struct Rules {
        /// Matched frames before a tentative track is confirmed. Higher values suppress false tracks, but delay new ones.
        min_hits: usize = 3, 1..=50;
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
}

impl Rules {
    /// Whether later frames change the tracks of earlier ones.
    pub(crate) fn looks_back(&self) -> bool {
        self.backdate || self.interpolate
    }

    /// Starts a track with its first detection.
    pub(crate) fn begun(&self) -> TrackAge {
        let status = if self.min_hits <= 1 { TrackStatus::Confirmed } else { TrackStatus::Tentative };
        TrackAge { hits: 1, missed: 0, status }
    }

    /// Counts a match.
    pub(crate) fn seen(&self, age: TrackAge) -> TrackAge {
        let hits = age.hits + 1;
        let is_confirmed = hits >= self.min_hits || age.status != TrackStatus::Tentative;
        TrackAge { hits, missed: 0, status: if is_confirmed { TrackStatus::Confirmed } else { TrackStatus::Tentative } }
    }

    /// Counts a miss; `None` where the track is deleted.
    pub(crate) fn missed(&self, age: TrackAge) -> Option<TrackAge> {
        let missed = age.missed + 1;
        let is_over = missed > self.max_age || age.status == TrackStatus::Tentative;
        (!is_over).then_some(TrackAge { hits: age.hits, missed, status: TrackStatus::Coasting })
    }
}
