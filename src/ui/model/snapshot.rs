//! What a run is a run of, where to go in it, and everything there is to see at one place of it.

use std::ops::Deref;
use std::sync::Arc;

use motionscope_core::scene::{Focus, Picture, Shape};
use motionscope_core::{Cursor, Error, Granularity, Info, Pace, Role};

use crate::experiment::Prepared;
use crate::experiment::pixel::Pixel;
use crate::view::moment::Moment;

/// Which pixel is held where a run begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Hold {
    /// The one that was held before, in the same clip.
    #[default]
    Kept,
    /// This one, or none, as a session has it.
    Set(Option<Pixel>),
}

/// A place in a run that is there in runs with other parameters as well.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Where to go.
    pub cursor: Cursor,
    /// The pixel whose unit is meant, if that is known better than its number.
    pub near: Option<Focus>,
    /// The pixel that is held there.
    pub hold: Hold,
}

impl Place {
    /// The end of the run.
    pub const END: Self = Self { cursor: Cursor { unit: usize::MAX, event: usize::MAX }, near: None, hold: Hold::Kept };

    /// At `cursor`.
    pub fn at(cursor: Cursor) -> Self {
        Self { cursor, ..Self::default() }
    }

    /// Where `shown` stands: the end of the run or of a unit stays one.
    pub fn of(shown: &Snapshot) -> Self {
        if let Some(cursor) = shown.bound_for {
            return Self::at(cursor);
        }
        let Cursor { unit, event } = shown.cursor;
        if shown.at_end {
            return Self::END;
        }
        let event = if event > 0 && event == shown.events { usize::MAX } else { event };
        // What is pointed at is not where the run stands.
        let near = shown.reference().filter(|_| shown.pointed.is_none());
        Self { cursor: Cursor { unit, event }, near, ..Self::default() }
    }

    /// Where several go on in lockstep from what is `shown`: as many candidates into the same block.
    pub fn in_lockstep(shown: &Snapshot, pace: Pace) -> Self {
        let place = Self::of(shown);
        if place == Self::END {
            return place;
        }
        let event = match place.cursor.event {
            event @ (0 | usize::MAX) => event,
            _ => shown.tested.max(1),
        };
        // Where the budget counts, a unit is one of the leader, on whatever level.
        let near = place.near.filter(|_| pace == Pace::Block);
        Self { cursor: Cursor { unit: shown.leader().unit, event }, near, ..Self::default() }
    }

    /// Where the leader goes on alone from what is `shown` of several.
    pub fn alone(shown: &Snapshot) -> Self {
        if shown.at_end { Self::END } else { Self { cursor: shown.leader(), ..Self::default() } }
    }
}

/// What to walk through, and where to begin.
pub struct Job {
    /// What is run.
    pub subject: Arc<Prepared>,
    /// Where to go at once.
    pub place: Place,
}

/// A pixel that is explained in place of the one at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointed {
    /// The pixel.
    pub at: Focus,
    /// Whether it was clicked, and stays explained when the pointer leaves it.
    pub is_held: bool,
}

/// Everything there is to see at one cursor: a moment of the run, which it is read like, and what the window has around it.
#[derive(Clone)]
pub struct Snapshot {
    /// What is run.
    pub subject: Arc<Prepared>,
    /// What there is to say about the estimator.
    pub info: &'static Info,
    /// What the run shows.
    pub moment: Moment,
    /// Events of the unit at hand.
    pub events: usize,
    /// Units of the run, if that is known by now.
    pub units: Option<usize>,
    /// Where the unit stands on each granularity but the innermost.
    pub place: Vec<Granularity>,
    /// Events worth a mark, and their role.
    pub landmarks: Vec<(usize, Role)>,
    /// What ended the run early, if anything did.
    pub failure: Option<Error>,
    /// The pixel that is explained, where that is not the one at work.
    pub pointed: Option<Pointed>,
    /// The pictures of the step whose pixels can be pointed at.
    pub clickable: Vec<Picture>,
    /// Candidates of the unit that were tested.
    pub tested: usize,
    /// Where the run is on its way to, while it is shown how far it has come.
    pub bound_for: Option<Cursor>,
}

impl Deref for Snapshot {
    type Target = Moment;

    fn deref(&self) -> &Moment {
        &self.moment
    }
}

impl Snapshot {
    /// The centre of what is being matched in frame t; of several in lockstep, by the first.
    pub fn reference(&self) -> Option<Focus> {
        let scene = self.tiles.first().map_or(&self.scene, |tile| &tile.scene);
        let mut marks = scene.marks.iter().rev();
        marks.find_map(|mark| match (mark.on, mark.role, &mark.shape) {
            (Picture::CURRENT, Role::Reference, Shape::Rect { min, max }) => {
                Some(Focus::current([(min[0] + max[0]) / 2.0, (min[1] + max[1]) / 2.0]))
            }
            _ => None,
        })
    }

    /// Where to click in the place of `picture`, whose pixels cannot be pointed at.
    pub fn elsewhere(&self, picture: Picture) -> Option<Picture> {
        if self.clickable.contains(&picture) { None } else { self.clickable.first().copied() }
    }

    /// The pixel that was clicked and is explained.
    pub fn held(&self) -> Option<Pixel> {
        self.pointed.filter(|pointed| pointed.is_held).map(|pointed| Pixel::of(pointed.at))
    }

    /// Where the run of the estimator itself stands: the same place unless several go in lockstep.
    pub fn leader(&self) -> Cursor {
        self.tiles.first().map_or(self.cursor, |tile| tile.cursor)
    }

    /// Share of the work that was done, from 0 to 1, if the number of units is known.
    pub fn share(&self) -> Option<f32> {
        let inside = if self.events == 0 { 0.0 } else { self.cursor.event as f32 / self.events as f32 };
        self.units.map(|units| ((self.cursor.unit as f32 + inside) / units.max(1) as f32).min(1.0))
    }
}
