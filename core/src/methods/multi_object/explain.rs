//! How trackers of many objects are told and drawn, as far as they share it.

use std::ops::Range;

use super::course::Course;
pub(crate) use crate::base::words::{counted as count, number_64 as short};
use crate::base::words::{heading, number};
use crate::data::Detection;
use crate::geometry::Bounds;
use crate::geometry::Grid;
use crate::products::{ObjectFrame, TrackStatus};
use crate::scene::{Fact, Matrix, Picture, Readout, Sentence, Series, Shape};
use crate::scene::{Role, Scene};

/// So many frames back a trail reaches.
const TRAIL_FRAMES: usize = 40;
/// So many rows and columns of a table are shown.
const SHOWN: usize = 12;

/// What was detected in a frame, in words; so many detections have a score below `min_score`.
pub(crate) fn looked((all, one): (usize, &str), frame: usize, (left_out, min_score): (usize, f32)) -> Sentence {
    Sentence::default().ink(Role::Measured, format!("{} in frame {frame}", count(all, one))).text(match left_out {
        0 => ".".into(),
        _ => format!("; {left_out} more with a score below {} left out.", number(min_score)),
    })
}

/// A velocity in words.
pub(crate) fn speed([u, v]: [f64; 2]) -> String {
    format!("{} px/frame towards {}", short(u.hypot(v)), heading([u, v]))
}

/// What stands for the rows and columns of a table of objects, a row each, beside detections.
pub(crate) struct Names {
    pub rows: Vec<String>,
    pub columns: Vec<String>,
}

impl Names {
    /// Objects by what they are called, and detections by their numbers from 1.
    pub fn new(rows: impl IntoIterator<Item = String>, columns: impl IntoIterator<Item = usize>) -> Self {
        let columns = columns.into_iter().map(|column| (column + 1).to_string()).collect();
        Self { rows: rows.into_iter().collect(), columns }
    }

    /// How much of the table is shown, where that is not all.
    pub fn shown(&self) -> Option<Fact> {
        let shown = |names: &[String]| format!("{} of {}", names.len().min(SHOWN), names.len());
        let is_larger = self.rows.len().max(self.columns.len()) > SHOWN;
        is_larger.then(|| {
            let text = format!("{} rows, {} columns", shown(&self.rows), shown(&self.columns));
            Fact::new("Shown of the table", text, None)
        })
    }

    /// A table of what `entry` gives for a row and a column; where there is not room for all of it, the part around what is lit.
    /// `None` where rows or columns are missing.
    pub fn table(
        &self,
        (symbol, name): (&'static str, &'static str),
        entry: impl Fn(usize, usize) -> f64,
        lit: &[(usize, usize)],
    ) -> Option<Matrix> {
        let rows = window(self.rows.len(), lit.iter().map(|(row, _)| *row));
        let columns = window(self.columns.len(), lit.iter().map(|(_, column)| *column));
        if columns.is_empty() || rows.is_empty() {
            return None;
        }
        let mut changed = Grid::new(columns.len(), rows.len(), false);
        for (row, column) in lit.iter().filter(|(row, column)| rows.contains(row) && columns.contains(column)) {
            changed[(column - columns.start, row - rows.start)] = true;
        }
        Some(Matrix {
            symbol,
            name,
            role: None,
            entries: Grid::from_fn(columns.len(), rows.len(), |x, y| entry(rows.start + y, columns.start + x)),
            rows: self.rows[rows].to_vec(),
            columns: self.columns[columns].to_vec(),
            changed: Some(changed),
        })
    }
}

/// As many of `all` rows or columns as are shown: those that are lit in their middle if there is room for them.
fn window(all: usize, lit: impl Iterator<Item = usize>) -> Range<usize> {
    let [low, high] = lit.fold([usize::MAX, 0], |[low, high], i| [low.min(i), high.max(i)]);
    let spare = SHOWN.saturating_sub((high + 1).saturating_sub(low));
    let first = if low > high { 0 } else { low.saturating_sub(spare / 2) };
    let first = first.min(all.saturating_sub(SHOWN));
    first..all.min(first + SHOWN)
}

pub(crate) fn rect(scene: &mut Scene, role: Role, Bounds { min, max }: Bounds) {
    scene.mark(Picture::CURRENT, role, Shape::Rect { min, max });
}

/// What was detected.
pub(crate) fn draw_detections<'a>(scene: &mut Scene, all: impl IntoIterator<Item = &'a Detection>) {
    all.into_iter().for_each(|found| rect(scene, Role::Measured, found.bounds));
    scene.legend(Role::Measured, "detected");
}

/// What an object is called, above its box.
pub(crate) fn label(scene: &mut Scene, role: Role, at: [f32; 2], text: String) {
    let text = Shape::Text { at, text };
    if text.is_finite() {
        scene.mark(Picture::CURRENT, role, text);
    }
}

/// The role of an object, and what that means.
pub(crate) fn role(life: TrackStatus) -> (Role, &'static str) {
    match life {
        TrackStatus::Tentative => (Role::Candidate, "tentative"),
        TrackStatus::Confirmed => (Role::Estimate, "tracked"),
        TrackStatus::Coasting => (Role::Predicted, "predicted"),
    }
}

/// Where an object was in the frames before, up to where it is now.
pub(crate) fn trail(scene: &mut Scene, course: &Course, role: Role, (id, now): (u32, [f64; 2])) {
    let recent = course.frames().len().saturating_sub(TRAIL_FRAMES);
    let places = course.frames()[recent..]
        .iter()
        .filter_map(|frame| frame.object(id).map(|object| object.position.map(|c| c as f32)));
    let points: Vec<[f32; 2]> = places.chain([now.map(|c| c as f32)]).collect();
    if points.len() > 1 {
        scene.mark_of(id, Picture::CURRENT, role, Shape::Path { points, closed: false });
    }
}

/// How many objects there are from frame to frame.
pub(crate) fn series(course: &Course) -> Option<Readout> {
    let frames = course.frames();
    let line = |of: &dyn Fn(&ObjectFrame) -> usize| -> Vec<[f32; 2]> {
        frames.iter().enumerate().map(|(i, frame)| [(course.span.first + i) as f32, of(frame) as f32]).collect()
    };
    let with = |life: TrackStatus| line(&move |frame| of_life(frame, life));
    let lines = vec![
        ("detected", Role::Measured, line(&|frame| frame.detections.len())),
        ("tracked", Role::Estimate, with(TrackStatus::Confirmed)),
        ("coasting", Role::Predicted, with(TrackStatus::Coasting)),
    ];
    let x_max = course.span.first + course.span.frames().map_or(frames.len(), |frames| frames - 1);
    let series = Series { title: "Objects", x_label: "frame", y_label: "objects", x_max, lines, ..Series::default() };
    (frames.len() > 1).then_some(Readout::Series(series))
}

fn of_life(frame: &ObjectFrame, life: TrackStatus) -> usize {
    frame.objects.iter().filter(|object| object.life == life).count()
}

/// What a frame came to, in words.
pub(crate) fn done(number: usize, frame: &ObjectFrame) -> String {
    let of = |life| of_life(frame, life);
    let [seen, coasting, tentative] = [TrackStatus::Confirmed, TrackStatus::Coasting, TrackStatus::Tentative].map(of);
    format!("Frame {number} is over: {seen} seen, {coasting} coasting, {tentative} tentative.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_table_shows_what_it_is_about_with_its_names() {
        let entry = |row: usize, column: usize| (100 * row + column) as f64;
        let names = Names::new((0..15).map(|i| (i + 200).to_string()), 0..40);
        let table = names.table(("C", "costs"), entry, &[(13, 30)]).expect("there is one");
        assert_eq!(table.entries.size(), (12, 12));
        let lit = table.changed.expect("lit");
        let (x, y) = (0..144).map(|i| (i % 12, i / 12)).find(|&place| lit[place]).expect("the pair");
        assert_eq!((table.entries[(x, y)], &*table.rows[y], &*table.columns[x]), (1330.0, "213", "31"));
        assert_eq!(names.shown().expect("not all").value, "12 of 15 rows, 12 of 40 columns");
        assert_eq!([window(5, [4].into_iter()), window(40, [].into_iter()), window(40, 0..40)], [0..5, 0..12, 0..12]);
    }
}
