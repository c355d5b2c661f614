//! Labels of marks, where they lie over no other one.

use motionscope_core::scene::Role;

use crate::paint::primitive::{Line, Point, Rect};

/// The side of a box on which its label stands where there is room.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    Above,
    Below,
}

/// A label and the starts of its baseline that come into question, the best first.
pub(super) struct Label {
    role: Role,
    line: Line,
    places: Vec<Point>,
}

impl Label {
    /// The label of a box, or one at a point, which stays there.
    pub(super) fn new(role: Role, line: Line, of: Option<(Rect, Side)>, room: Option<Rect>) -> Self {
        let ([x, y], size) = (line.at, line.size);
        let Some((rect, side)) = of else {
            // The name of a measurement stands below its place.
            let y = if role == Role::Measured { y + size + LABEL_RIM } else { y };
            return Self { role, line, places: vec![[x, y]] };
        };
        let width = line.width();
        let [left, right] = [rect.min[0], rect.max[0] - width];
        let [above, below] = [rect.min[1] - LABEL_RIM, rect.max[1] + LABEL_RIM + CAPITALS * size];
        let rows = if side == Side::Above { [above, below] } else { [below, above] };
        let beside = [rect.max[0] + LABEL_RIM, rect.min[0] - LABEL_RIM - width];
        let level = rect.min[1] + CAPITALS * size;
        let mut places = vec![[left, rows[0]], [right, rows[0]], [left, rows[1]], [right, rows[1]]];
        places.extend(beside.map(|x| [x, level]));
        // In a crowd, a line farther away.
        let farther = LINE * size;
        places.extend([[left, below + farther], [left, above - farther]]);
        let mut label = Self { role, line, places };
        if let Some(room) = room.filter(|room| room.meets(&rect)) {
            let first = label.places[0];
            let near = |at: Point| {
                let inside = moved_into(&room, &label.line, at);
                let is_near = (0..2).all(|i| (inside[i] - at[i]).abs() <= 2.0 * LABEL_RIM);
                is_near.then_some(inside)
            };
            label.places = label.places.iter().filter_map(|at| near(*at)).collect();
            if label.places.is_empty() {
                label.places.push(moved_into(&room, &label.line, first));
            }
        }
        label
    }
}

/// Height of capitals and figures as a share of the size of the type.
const CAPITALS: f32 = 0.75;
/// Distance of two lines of labels, as the same share.
const LINE: f32 = 1.3;

/// The rectangle of the letters of a label whose baseline starts at `[x, y]`, with half of their rim.
pub(super) fn letters(line: &Line, [x, y]: Point) -> Rect {
    let (up, down) = (CAPITALS * line.size, 0.2 * line.size);
    Rect::new([x, y - up], [line.width(), up + down]).grown(LABEL_RIM / 2.0)
}

/// The start of the baseline nearest to `at` with which all of a label lies in `room`.
fn moved_into(room: &Rect, line: &Line, at: Point) -> Point {
    let rect = letters(line, at);
    [0, 1].map(|i| {
        let by = (room.max[i] - rect.max[i]).min(0.0);
        // What is wider than the room begins in it.
        at[i] + by.max(room.min[i] - rect.min[i])
    })
}

/// The labels where they lie over no other one. Those of measurements give way: they are left out where there is no such place.
pub(super) fn apart_labels(labels: impl Iterator<Item = Label>) -> impl Iterator<Item = Line> {
    let (measured, others): (Vec<_>, Vec<_>) = labels.partition(|label| label.role == Role::Measured);
    let mut taken: Vec<Rect> = Vec::new();
    let mut free = |label: &Label, is_needed: bool| {
        let is_free = |at: &&Point| !taken.iter().any(|other| other.meets(&letters(&label.line, **at)));
        // More could not be read, and each is compared with all others.
        let place = if taken.len() < MOST_LABELS { label.places.iter().find(is_free) } else { None };
        let place = place.or(label.places.first().filter(|_| is_needed)).copied()?;
        taken.push(letters(&label.line, place));
        Some(place)
    };
    let mut lines = Vec::new();
    for (label, is_needed) in
        others.into_iter().map(|one| (one, true)).chain(measured.into_iter().map(|one| (one, false)))
    {
        lines.extend(free(&label, is_needed).map(|at| Line { at, ..label.line }));
    }
    lines.into_iter()
}

/// The width of a label's rim in points.
pub(super) const LABEL_RIM: f32 = 3.0;
/// Beyond this number labels of measurements are left out, and others stay in their first place.
pub(super) const MOST_LABELS: usize = 200;
