//! The life of a track: when it is confirmed, and when it is deleted.

use crate::params;
use crate::products::TrackStatus;

params! {
    /// What decides over lives.
    #[derive(Copy)]
    pub struct Rules {
        /// Min hits: matched frames before a tentative track is confirmed.
        confirm: usize = 3, 1..=50;
        /// Max age: missed frames in a row before a confirmed track is deleted; a tentative one is deleted at the first.
        patience: usize = 15, 0..=500;
        /// A track counts from its first detection once it is confirmed. With hindsight: in real time it is not known so early.
        backdate: bool = true;
        /// Frames in which a track coasted are filled in on a straight line once it is matched again. With hindsight: in real time there is a gap.
        bridge: bool = true;
    }
    advanced { "backdate", "bridge" }
}

/// How long an object has lived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Age {
    /// Frames in which it was seen.
    pub seen: usize,
    /// Frames in a row in which it was not.
    pub missed: usize,
    /// What it counts as.
    pub life: TrackStatus,
}

impl Rules {
    /// The same without hindsight, if there is any.
    pub(crate) fn without_hindsight(&self) -> Option<Self> {
        (self.backdate || self.bridge).then_some(Self { backdate: false, bridge: false, ..*self })
    }

    /// An object is seen for the first time.
    pub(crate) fn begun(&self) -> Age {
        let life = if self.confirm <= 1 { TrackStatus::Confirmed } else { TrackStatus::Tentative };
        Age { seen: 1, missed: 0, life }
    }

    /// It is seen once more.
    pub(crate) fn seen(&self, age: Age) -> Age {
        let seen = age.seen + 1;
        let is_believed = seen >= self.confirm || age.life != TrackStatus::Tentative;
        Age { seen, missed: 0, life: if is_believed { TrackStatus::Confirmed } else { TrackStatus::Tentative } }
    }

    /// It is not seen; `None` where it is given up.
    pub(crate) fn missed(&self, age: Age) -> Option<Age> {
        let missed = age.missed + 1;
        let is_over = missed > self.patience || age.life == TrackStatus::Tentative;
        (!is_over).then_some(Age { seen: age.seen, missed, life: TrackStatus::Coasting })
    }
}
