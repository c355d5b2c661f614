//! The life of an object that is followed: when it is believed in, and when it is given up.

use crate::params;
use crate::products::Life;

params! {
    /// What decides over lives.
    #[derive(Copy)]
    pub struct Rules {
        /// An object is believed in once it was seen in so many frames.
        confirm: usize = 3, 1..=50;
        /// An object is given up once it was not seen in more than so many frames in a row; one that is not believed in after the first.
        patience: usize = 15, 0..=500;
        /// Once an object is believed in, it counts from where it was first seen. This looks back in time: a live camera could not tell so early.
        backdate: bool = true;
        /// Where an object comes back after some frames, it is put in between as well, on a straight line. This looks back in time: a live camera would have shown the gap.
        bridge: bool = true;
    }
}

/// How long an object has lived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Age {
    /// Frames in which it was seen.
    pub seen: usize,
    /// Frames in a row in which it was not.
    pub missed: usize,
    /// What it counts as.
    pub life: Life,
}

impl Rules {
    /// The same without hindsight, if there is any.
    pub(crate) fn without_hindsight(&self) -> Option<Self> {
        (self.backdate || self.bridge).then_some(Self { backdate: false, bridge: false, ..*self })
    }

    /// An object is seen for the first time.
    pub(crate) fn begun(&self) -> Age {
        let life = if self.confirm <= 1 { Life::Confirmed } else { Life::Tentative };
        Age { seen: 1, missed: 0, life }
    }

    /// It is seen once more.
    pub(crate) fn seen(&self, age: Age) -> Age {
        let seen = age.seen + 1;
        let is_believed = seen >= self.confirm || age.life != Life::Tentative;
        Age { seen, missed: 0, life: if is_believed { Life::Confirmed } else { Life::Tentative } }
    }

    /// It is not seen; `None` where it is given up.
    pub(crate) fn missed(&self, age: Age) -> Option<Age> {
        let missed = age.missed + 1;
        let is_over = missed > self.patience || age.life == Life::Tentative;
        (!is_over).then_some(Age { seen: age.seen, missed, life: Life::Coasting })
    }
}
