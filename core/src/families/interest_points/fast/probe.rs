//! The inspected pixel of FAST and the shades of its circle.

use super::{Event, Fast};
use crate::methods::features::Stage;
use crate::methods::features::segment::{Candidate, Circle, Shade};
use crate::run::Seen;
use crate::scene::Role;

/// The number of a pixel on the circle, as in the paper: 1 at the top.
pub(super) fn number(index: usize) -> usize {
    index % 16 + 1
}

/// The inspected pixel.
pub(super) struct Probe {
    pub place: (usize, usize),
    /// Whether it is the pixel pointed at rather than the current one.
    pub is_pointed_at: bool,
    /// Its circle; none near the border.
    pub circle: Option<Circle>,
}

impl Fast {
    /// Returns the pixel pointed at, or else the current one.
    pub(super) fn probe(&self, seen: &Seen<Self>) -> Option<Probe> {
        let state = seen.before;
        let at_work = seen.events.last().and_then(|event| match event {
            Event::Row | Event::Corners => None,
            Event::Tested(Candidate { x, .. }) => Some((*x, state.row)),
            Event::Compared(place, _) => Some(*place),
            Event::Ranked => state.strongest(),
            Event::Peak(peak, _) => Some(state.place(*peak)),
        });
        let pointed = seen.point().and_then(|point| state.map.cell_at(point)).filter(|_| !seen.events.is_empty());
        let place = pointed.or(at_work)?;
        let circle = Circle::of(state.picture.luma(), place, self.test());
        Some(Probe { place, is_pointed_at: Some(place) != at_work, circle })
    }
}

/// Whether the circle of the inspected pixel is shown; a corner that is kept or rejected has the minimum distance around it.
pub(super) fn shows_circle(seen: &Seen<Fast>) -> bool {
    !matches!(seen.events.last(), Some(Event::Peak(..))) || seen.point().is_some()
}

/// The shades with their roles and meanings, which no corner has.
pub(super) const SHADES: [(Shade, Role, &str); 3] = [
    (Shade::Similar, Role::Estimate, "similar to p"),
    (Shade::Brighter, Role::Measured, "brighter than the centre p by more than t"),
    (Shade::Darker, Role::Predicted, "darker than the centre p by more than t"),
];

/// Role and meaning of the longest run, different from those of the corners of `stage`.
pub(super) fn role_of_run(circle: &Circle, stage: Stage) -> (Role, &'static str) {
    match circle.arc {
        Some(_) if stage == Stage::Choice => (Role::Window, "longest run, an arc"),
        Some(_) => (Role::Result, "longest run, an arc"),
        None => (Role::Error, "longest run, too short"),
    }
}
