//! The life of an object that is followed: when it is believed in, and when it is given up.

use crate::products::Life;

/// What decides over lives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rules {
    /// An object is believed in once it was seen in so many frames.
    pub confirm: usize,
    /// It is given up once it was not seen in more than so many frames in a row; one that is not believed in after the first.
    pub patience: usize,
    /// Once it is believed in, it counts from where it was first seen.
    pub backdate: bool,
    /// Where it comes back, it is put in between as well.
    pub bridge: bool,
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
    /// An object is seen for the first time.
    pub fn begun(&self) -> Age {
        let life = if self.confirm <= 1 { Life::Confirmed } else { Life::Tentative };
        Age { seen: 1, missed: 0, life }
    }

    /// It is seen once more.
    pub fn seen(&self, age: Age) -> Age {
        let seen = age.seen + 1;
        let is_believed = seen >= self.confirm || age.life != Life::Tentative;
        Age { seen, missed: 0, life: if is_believed { Life::Confirmed } else { Life::Tentative } }
    }

    /// It is not seen; `None` where it is given up.
    pub fn missed(&self, age: Age) -> Option<Age> {
        let missed = age.missed + 1;
        let is_over = missed > self.patience || age.life == Life::Tentative;
        (!is_over).then_some(Age { seen: age.seen, missed, life: Life::Coasting })
    }
}
