//! Words, tables and marks shared by the steps of multi-object trackers.

use std::ops::Range;

use super::gating::MOST_NEAR;
use super::tracker_run::{Conclusion, TrackerRun};
pub(crate) use crate::base::words::counted as count;
use crate::base::words::{grouped, heading};
use crate::data::Detection;
use crate::geometry::Bounds;
use crate::geometry::Grid;
use crate::methods::numbers::{fixed, px, ratio};
use crate::products::{
    ObjectFrame, TrackStatus,
    objects::score::{Matches, Scores},
};
use crate::scene::{Fact, Matrix, Picture, Readout, Sentence, Series, Shape};
use crate::scene::{Role, Scene};

/// The length of a drawn trail in frames.
const TRAIL_FRAMES: usize = 40;
/// The maximum number of rows and columns of a shown table.
const SHOWN: usize = 12;

/// The detections of a frame in words, and those discarded by the minimum score.
pub(crate) fn detected((all, one): (usize, &str), frame: usize, (discarded, min_score): (usize, f32)) -> Sentence {
    Sentence::default().ink(Role::Measured, format!("{} in frame {frame}", count(all, one))).text(match discarded {
        0 => ".".into(),
        _ => format!("; {discarded} more discarded with a score below the minimum of {}.", fixed(min_score.into(), 2)),
    })
}

/// The limit of the number of detections that are compared with a track, in words for the tracks that reached it.
pub(crate) fn crowded(tracks: usize) -> String {
    match tracks {
        0 => String::new(),
        all => format!(" Of {}, only the {MOST_NEAR} nearest detections are compared.", count(all, "track")),
    }
}

/// A velocity as speed and heading.
pub(crate) fn speed([u, v]: [f64; 2]) -> String {
    format!("{} px/frame, heading {}", px(u.hypot(v)), heading([u, v]))
}

/// The same with how a heading is counted.
pub(crate) fn velocity(velocity: [f64; 2]) -> String {
    format!("{} (90° is down)", speed(velocity))
}

/// The names of rows and columns of a table of tracks (rows) and detections (columns).
pub(crate) struct Names {
    pub rows: Vec<String>,
    pub columns: Vec<String>,
}

impl Names {
    /// Names tracks as given, and detections by their numbers from 1.
    pub fn new(rows: impl IntoIterator<Item = String>, columns: impl IntoIterator<Item = usize>) -> Self {
        let columns = columns.into_iter().map(|column| (column + 1).to_string()).collect();
        Self { rows: rows.into_iter().collect(), columns }
    }

    /// Returns the shown part of a table that is too large.
    pub fn shown(&self) -> Option<Fact> {
        let shown = |names: &[String]| format!("{} of {}", names.len().min(SHOWN), names.len());
        let is_larger = self.rows.len().max(self.columns.len()) > SHOWN;
        is_larger.then(|| {
            let text = format!("{} rows, {} columns", shown(&self.rows), shown(&self.columns));
            Fact::new("Shown part of table", text, None)
        })
    }

    /// Returns the table of `entry` by row and column, of a large one the part around the lit cells; `None` if it is empty.
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
            decimals: None,
        })
    }
}

/// Returns the shown range of `all` rows or columns, with the lit ones in its middle if they fit.
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

/// Room around the objects of a step, in sizes of the largest box: their surroundings are seen too.
const AROUND: f32 = 2.5;

/// Makes the surroundings of an object the place where the step works: what the sentence is about is what the stage shows.
pub(crate) fn work_at(scene: &mut Scene, bounds: Bounds) {
    work_on(scene, [bounds]);
}

/// The same of several objects, such as the tracks and the detections of a cluster.
pub(crate) fn work_on(scene: &mut Scene, all: impl IntoIterator<Item = Bounds>) {
    let side = |bounds: &Bounds| bounds.size().into_iter().fold(0.0, f32::max);
    let around = |(one, largest): (Bounds, f32), (other, side): (Bounds, f32)| {
        let min = [0, 1].map(|i| one.min[i].min(other.min[i]));
        let max = [0, 1].map(|i| one.max[i].max(other.max[i]));
        (Bounds { min, max }, largest.max(side))
    };
    let hull = all.into_iter().map(|bounds| (bounds, side(&bounds))).reduce(around);
    let room = |(Bounds { min, max }, largest): (Bounds, f32)| {
        let room = AROUND * largest;
        [min.map(|c| c - room), max.map(|c| c + room)]
    };
    scene.work = hull.map(room);
}

/// Draws the boxes of detections.
pub(crate) fn draw_detections<'a>(scene: &mut Scene, all: impl IntoIterator<Item = &'a Detection>) {
    all.into_iter().for_each(|found| rect(scene, Role::Measured, found.bounds));
    scene.legend(Role::Measured, "detection");
}

/// Writes the name of a track above its box.
pub(crate) fn label(scene: &mut Scene, role: Role, at: [f32; 2], text: String) {
    let text = Shape::Text { at, text };
    if text.is_finite() {
        scene.mark(Picture::CURRENT, role, text);
    }
}

/// The role of a track in the picture, and its meaning in the legend.
pub(crate) fn role(status: TrackStatus) -> (Role, &'static str) {
    match status {
        TrackStatus::Tentative => (Role::Candidate, "tentative track"),
        TrackStatus::Confirmed => (Role::Estimate, "confirmed track"),
        TrackStatus::Coasting => (Role::Predicted, "coasting track"),
    }
}

/// Draws the recent trajectory of a track.
pub(crate) fn trail(scene: &mut Scene, run: &TrackerRun, role: Role, (id, now): (u32, [f64; 2])) {
    let recent = run.frames().len().saturating_sub(TRAIL_FRAMES);
    let places = run.frames()[recent..]
        .iter()
        .filter_map(|frame| frame.object(id).map(|object| object.position.map(|c| c as f32)));
    let points: Vec<[f32; 2]> = places.chain([now.map(|c| c as f32)]).collect();
    if points.len() > 1 {
        scene.mark_of(id, Picture::CURRENT, role, Shape::Path { points, closed: false });
    }
}

/// The plot of detections and tracks of each frame.
pub(crate) fn series(run: &TrackerRun) -> Option<Readout> {
    let frames = run.frames();
    let line = |of: &dyn Fn(&ObjectFrame) -> usize| -> Vec<[f32; 2]> {
        frames.iter().enumerate().map(|(i, frame)| [(run.span.first + i) as f32, of(frame) as f32]).collect()
    };
    let with = |status: TrackStatus| line(&move |frame| of_status(frame, status));
    let lines = vec![
        ("detections", Role::Measured, line(&|frame| frame.detections.len())),
        ("confirmed tracks", Role::Estimate, with(TrackStatus::Confirmed)),
        ("coasting tracks", Role::Predicted, with(TrackStatus::Coasting)),
    ];
    let x_max = run.span.first + run.span.frames().map_or(frames.len(), |frames| frames - 1);
    let series = Series {
        title: "Detections and tracks of finished frames",
        x_label: "frame",
        y_label: "number per frame",
        x_max,
        lines,
        decimals: Some(0),
        ..Series::default()
    };
    (frames.len() > 1).then_some(Readout::Series(series))
}

fn of_status(frame: &ObjectFrame, status: TrackStatus) -> usize {
    frame.objects.iter().filter(|object| object.status == status).count()
}

/// The conclusion of a frame, and at its end of the run: counts, scores, the kind of error and the remedy.
pub(crate) fn done(number: usize, frame: &ObjectFrame, conclusion: &Conclusion) -> String {
    let of = |status| of_status(frame, status);
    let [seen, coasting, tentative] = [TrackStatus::Confirmed, TrackStatus::Coasting, TrackStatus::Tentative].map(of);
    let tentative = count(tentative, "tentative track");
    let counts = format!("Frame {number}: {seen} confirmed, {coasting} coasting, {tentative}.");
    let overconfidence = conclusion.overconfidence().map(|test| test.verdict(false)).unwrap_or_default();
    let stationary = stationary(conclusion.stationary);
    let Some(run) = conclusion.run.filter(|run| run.truths > 0) else {
        let tracks = conclusion.tracks.map(|all| format!(" Run: {}.", count(all, "confirmed track")));
        let frame = conclusion.frame.map_or_else(String::new, of_frame);
        return counts + &frame + &tracks.unwrap_or_default() + &overconfidence + &stationary;
    };
    let figures = |of: Scores| {
        let [mota, idf1] = [of.mota, of.idf1].map(ratio);
        format!("MOTA {mota}, IDF1 {idf1}, {}", plural(of.switches, "identity switch", "es"))
    };
    let (scores, live) = (figures(run), conclusion.live.map(figures));
    // Both names appear only where the figures differ.
    let live = live.filter(|live| *live != scores);
    let when = if live.is_some() { "Run with hindsight" } else { "Run" };
    let scores = format!(" {when}: {scores}.");
    let rates = format!(" Precision {}, recall {}.", fixed(run.precision, 2), fixed(run.recall, 2));
    let live = live.map_or_else(String::new, |live| format!(" In real time, without hindsight: {live}."));
    let worst = most_errors(&conclusion.worst);
    let (misses, alarms) = (run.truths - run.matches, run.hypotheses - run.matches);
    let advice = match run.switches {
        0 if misses + alarms == 0 => "",
        switches if switches > misses.max(alarms) => {
            " Identities are kept by a motion model that fits (turns need one), and through misses by a larger maximum age."
        }
        _ if !overconfidence.is_empty() => " Too small gates reject detections of their own objects.",
        _ if misses > alarms && 2 * conclusion.hidden.unwrap_or(0) > misses => match conclusion.is_interpolated {
            true => {
                " Most errors are misses of occluded objects: there is no track before the first detection, and the boxes of a coasting track count only where a later match lets them be interpolated."
            }
            false => {
                " Most errors are misses of occluded objects: there is no track before the first detection, and coasting tracks do not count as matches."
            }
        },
        _ if misses > alarms && conclusion.hidden.is_some() => {
            " Most errors are misses of visible objects. The detections are the true boxes with noise, so the tracker loses them: compare process noise, gate and minimum number of hits."
        }
        _ if misses > alarms => {
            " Most errors are misses: lower the minimum number of hits or the score thresholds, or use another detector."
        }
        _ if misses == alarms => {
            " There are as many misses as false alarms: boxes may overlap the true ones by less than IoU 0.5."
        }
        _ => {
            " Most errors are false alarms: raise the minimum number of hits or the score thresholds, or lower the maximum age."
        }
    };
    counts + &scores + &rates + &live + &worst + &overconfidence + advice + &stationary
}

/// The tracks that the minimum travel has kept tentative in words, or nothing.
fn stationary(tracks: usize) -> String {
    if tracks == 0 {
        return String::new();
    }
    let was = if tracks == 1 { "was" } else { "were" };
    format!(
        " {} lasted, but {was} not confirmed: the net displacement stayed below the minimum travel or half of the path. With a minimum travel of 0 all tracks that last are confirmed.",
        count(tracks, "tentative track")
    )
}

/// The frames with the most errors in words.
fn most_errors(worst: &[(usize, Matches)]) -> String {
    let kinds = |all: &Matches| {
        format!("{}, {}", plural(all.misses(), "miss", "es"), plural(all.false_positives(), "false alarm", "s"))
    };
    let Some((first, all)) = worst.first() else { return String::new() };
    let errors = plural(all.misses() + all.false_positives(), "error", "s");
    match worst {
        [_] => format!(" Frame {first} has the most errors: {}.", kinds(all)),
        [_, (second, _)] => format!(" Frames {first} and {second} have the most errors: {errors} each."),
        _ => format!(
            " The most errors in a frame are {}, in {}, first in frame {first}.",
            all.misses() + all.false_positives(),
            count(worst.len(), "frame")
        ),
    }
}

/// The missed frames in a row.
pub(crate) fn missed_in_a_row(missed: usize) -> String {
    match missed {
        1 => "1 missed frame".to_owned(),
        _ => format!("{} in a row", count(missed, "missed frame")),
    }
}

/// The matches of a frame in words.
fn of_frame(all: Matches) -> String {
    match all.misses() + all.false_positives() {
        0 if all.truths == 0 => " No true objects in this frame.".into(),
        0 => format!(" Ground truth (IoU ≥ 0.5): all {} true objects are matched.", grouped(all.truths)),
        _ => format!(
            " Ground truth (IoU ≥ 0.5): {} of {} {}, {}.",
            grouped(all.pairs),
            plural(all.truths, "true object", "s"),
            if all.pairs == 1 { "is matched" } else { "are matched" },
            plural(all.false_positives(), "false alarm", "s")
        ),
    }
}

fn plural(count: usize, one: &str, ending: &str) -> String {
    format!("{} {one}{}", grouped(count), if count == 1 { "" } else { ending })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_frames_with_the_most_errors_are_named() {
        let two = Matches { truths: 5, estimates: 3, pairs: 3 };
        assert_eq!(most_errors(&[]), "");
        assert_eq!(most_errors(&[(21, two)]), " Frame 21 has the most errors: 2 misses, 0 false alarms.");
        assert_eq!(most_errors(&[(21, two), (23, two)]), " Frames 21 and 23 have the most errors: 2 errors each.");
        let said = most_errors(&[(21, two), (22, two), (23, two)]);
        assert_eq!(said, " The most errors in a frame are 2, in 3 frames, first in frame 21.");
    }

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
