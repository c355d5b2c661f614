//! The subject of a run, positions in it, and snapshots of one cursor.

use std::ops::Deref;
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::run::{Cursor, Granularity, Info, Move, Pace, Walk};
use motionscope_core::scene::{Focus, Picture, Readout, Role, Shape, Step, Surface};

use crate::experiment::Prepared;
use crate::experiment::pixel::Held;
use crate::view::moment::{Fault, Moment};

/// The held pixel at the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Hold {
    /// The pixel held before, in the same clip.
    #[default]
    Kept,
    /// The pixel or the object of a session, if any.
    Set(Option<Held>),
}

/// Which unit of another run is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Near {
    /// The one with the same number.
    #[default]
    Same,
    /// The one with its result at this pixel.
    Pixel(Focus),
    /// The one that a run opens with, because most moves there.
    Interest,
}

/// A position that is valid in runs with other parameters as well.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// The target of the move.
    pub cursor: Cursor,
    /// Which unit is meant, if not that of the cursor.
    pub near: Near,
    /// The candidate of that unit under test, `[u, v]` in px, if the step is about one.
    pub candidate: Option<[i32; 2]>,
    /// The held pixel.
    pub hold: Hold,
}

impl Place {
    /// The end of the run.
    pub const END: Self = Self { cursor: Cursor::END, near: Near::Same, candidate: None, hold: Hold::Kept };
    /// Where a run opens that was at no place before.
    pub const OPENING: Self =
        Self { cursor: Cursor { unit: 0, event: 0 }, near: Near::Interest, candidate: None, hold: Hold::Kept };

    /// At `cursor`.
    pub fn at(cursor: Cursor) -> Self {
        Self { cursor, ..Self::default() }
    }

    /// Returns the position of `shown`; the end of the run or of a unit stays an end.
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
        let near = shown.reference().filter(|_| shown.pointed.is_none()).map_or(Near::Same, Near::Pixel);
        // With another search window the same candidate is tested by another event; in lockstep events are counted anyway.
        let is_inside = event > 0 && event < usize::MAX && shown.tiles.is_empty();
        let candidate = surface(&shown.step).and_then(|surface| surface.probe).filter(|_| is_inside);
        Self { cursor: Cursor { unit, event }, near, candidate, ..Self::default() }
    }

    /// Returns the position in lockstep that corresponds to `shown`: the same candidate of the same block.
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
        let near = if pace == Pace::Block { place.near } else { Near::Same };
        Self { cursor: Cursor { unit: shown.leader().unit, event }, near, ..Self::default() }
    }

    /// Returns the position of the leader alone that corresponds to `shown` in lockstep.
    pub fn alone(shown: &Snapshot) -> Self {
        if shown.at_end { Self::END } else { Self { cursor: shown.leader(), ..Self::default() } }
    }
}

/// The cost surface of `step`, if it has one.
pub fn surface(step: &Step) -> Option<&Surface> {
    step.readouts.iter().find_map(|readout| if let Readout::Surface(surface) = readout { Some(surface) } else { None })
}

/// Returns the event that tests `candidate` of the unit at `cursor` of `walk`, which is moved to the end of that unit.
pub fn event_of(walk: &mut dyn Walk, cursor: Cursor, candidate: [i32; 2]) -> Option<usize> {
    walk.jump(Move::To(Cursor { event: usize::MAX, ..cursor }));
    let step = walk.step(None);
    let surface = surface(&step)?;
    let [column, row] = [0, 1].map(|i| usize::try_from(candidate[i] - surface.origin[i]).ok());
    surface.events.get(column?, row?).copied().flatten()
}

/// The subject of a walk, and its first position.
pub struct Job {
    /// What is run.
    pub subject: Arc<Prepared>,
    /// The first position.
    pub place: Place,
}

/// A pixel that is explained instead of the current one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointed {
    /// The pixel.
    pub at: Focus,
    /// Whether it is held by a click.
    pub is_held: bool,
}

/// A snapshot of one cursor: the moment of the run, and what the window shows around it.
#[derive(Clone)]
pub struct Snapshot {
    /// What is run.
    pub subject: Arc<Prepared>,
    /// The description of the estimator.
    pub info: &'static Info,
    /// The moment shown.
    pub moment: Moment,
    /// Number of events of the current unit.
    pub events: usize,
    /// Number of units of the run, if known.
    pub units: Option<usize>,
    /// The index of the unit on each granularity but the innermost.
    pub place: Vec<Granularity>,
    /// Events marked on the timeline, with their roles.
    pub landmarks: Vec<(usize, Role)>,
    /// The units with errors of tracks, once the run was at its end.
    pub faults: Arc<[(usize, Fault)]>,
    /// The error that ended the run early, if any.
    pub failure: Option<Error>,
    /// The explained pixel, if not the current one.
    pub pointed: Option<Pointed>,
    /// The pictures of the step whose pixels can be explained.
    pub clickable: Vec<Picture>,
    /// Number of tested candidates of the unit.
    pub tested: usize,
    /// The target of a long move in progress.
    pub bound_for: Option<Cursor>,
}

impl Deref for Snapshot {
    type Target = Moment;

    fn deref(&self) -> &Moment {
        &self.moment
    }
}

impl Snapshot {
    /// Returns the center of the block or window in frame t; in lockstep, that of the first estimator.
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

    /// Returns the picture to click instead of `picture`, whose pixels cannot be explained.
    pub fn elsewhere(&self, picture: Picture) -> Option<Picture> {
        if self.clickable.contains(&picture) { None } else { self.clickable.first().copied() }
    }

    /// Returns the held pixel or object that is explained.
    pub fn held(&self) -> Option<Held> {
        self.pointed.filter(|pointed| pointed.is_held).map(|pointed| Held::of(pointed.at))
    }

    /// Returns the cursor of the estimator's own run, which differs only in lockstep.
    pub fn leader(&self) -> Cursor {
        self.tiles.first().map_or(self.cursor, |tile| tile.cursor)
    }

    /// Returns the progress from 0 to 1, if the number of units is known.
    pub fn share(&self) -> Option<f32> {
        let inside = if self.events == 0 { 0.0 } else { self.cursor.event as f32 / self.events as f32 };
        self.units.map(|units| ((self.cursor.unit as f32 + inside) / units.max(1) as f32).min(1.0))
    }
}
