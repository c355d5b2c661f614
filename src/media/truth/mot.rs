//! MOTChallenge's rows of objects, tracked or detected.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::ObjectBox;

use super::file_error;
use crate::media::numbers::{self, single};
use crate::media::{input, table};

/// More than any sequence of the benchmark by a factor of ten.
const MOST_BYTES: u64 = 256 << 20;

/// Largest coordinate and size of a box in px; larger values are errors.
const FARTHEST_PX: f64 = 1e6;
/// Frames beyond these cannot be shown.
const MOST_FRAMES: u32 = 1_000_000;
/// The left and top edge of our first pixel lie at −0.5, those of theirs at 1.
const FIRST_PX: f64 = 1.5;
/// The most boxes in a frame, about twenty times as many as in the densest sequence of the benchmark (MOT20). Assigning boxes to objects
/// takes memory with the square of their number.
pub(crate) const MOST_IN_A_FRAME: usize = 5_000;

/// One row of a table.
#[derive(Debug)]
pub(crate) struct Row {
    /// Its line in the file, counted from 1.
    pub line: usize,
    /// The frame, counted from 0.
    pub frame: usize,
    /// The identity; `None` for a detection, which has none.
    pub id: Option<u32>,
    /// Left and top edge in px, that of the first pixel at −0.5.
    pub min: [f32; 2],
    /// Width and height in px.
    pub size: [f32; 2],
    /// How sure the detector is.
    pub confidence: f32,
    /// Whether the benchmark scores it: neither marked by a confidence of 0 nor of a class that it leaves out.
    is_scored: bool,
    /// Share that can be seen, 0 to 1.
    visibility: f32,
}

/// The objects of each frame in the text of the `gt.txt` at `path`, by identity; frames counted from 0.
///
/// # Errors
/// A sentence that names the line if a row cannot be understood.
pub(super) fn of_text(path: &Path, text: &str) -> Result<Tracks, Error> {
    objects(text).map_err(|why| file_error(path, why))
}

/// The boxes of a truth, by frame.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Tracks {
    /// The objects that count.
    pub objects: BTreeMap<usize, Vec<ObjectBox>>,
    /// The boxes of what the benchmark does not score: a track that matches one is no false alarm.
    pub ignored: BTreeMap<usize, Vec<ObjectBox>>,
    /// Of values that are not taken over as they are in the file.
    pub warning: Option<&'static str>,
}

/// The detections in the table at `path`, in its order.
///
/// # Errors
/// As [`of_text`]; a detection without area is damaged.
pub(crate) fn detections(path: &Path) -> Result<Vec<Row>, Error> {
    let checked = |row: Row| match row.is_absent() {
        true => Err(format!("line {}: a box of {}×{} px has no area", row.line, row.size[0], row.size[1])),
        false => Ok(row),
    };
    let rows = parse(&text(path)?).and_then(|rows| rows.into_iter().map(checked).collect());
    rows.map_err(|why| file_error(path, why))
}

/// Whether the first row of a table is a detection of MOTChallenge, which has no identity.
pub(crate) fn is_detections(text: &str) -> bool {
    first(text).is_some_and(|row| row.id.is_none() && !row.is_absent())
}

/// Whether the first row of a table is a MOTChallenge row of an object with an identity.
pub(crate) fn is_objects(text: &str) -> bool {
    first(text).is_some_and(|row| row.id.is_some())
}

fn first(text: &str) -> Option<Row> {
    let (line, cells) = table::rows(text).next()?;
    row(line, cells).ok()
}

/// The text of a table, if it is not too large for one.
pub(super) fn text(path: &Path) -> Result<String, Error> {
    input::text_within(path, MOST_BYTES).map_err(|why| file_error(path, why))
}

fn parse(text: &str) -> Result<Vec<Row>, String> {
    check_header(text)?;
    table::rows(text).map(|(i, line)| row(i, line).map_err(|why| format!("line {i}: {why}"))).collect()
}

/// Classes of MOTChallenge that look like persons and are not scored: person on a vehicle, static person, distractor, reflection.
const DISTRACTORS: [f64; 4] = [2.0, 7.0, 8.0, 12.0];

/// The names that headers give the columns of a row.
const COLUMNS: [&[&str]; 6] = [
    &["frame", "frame_id", "frame_index", "frame_number", "frame_no", "t"],
    &["id", "track_id", "object_id", "target_id", "identity", "track", "object"],
    &["left", "bb_left", "x", "x1", "xmin", "x_min", "bb_x"],
    &["top", "bb_top", "y", "y1", "ymin", "y_min", "bb_y"],
    &["width", "bb_width", "w", "bb_w"],
    &["height", "bb_height", "h", "bb_h"],
];
/// The names of columns that a row does not have.
const OTHERS: [&str; 8] = ["right", "bottom", "x2", "y2", "xmax", "ymax", "x_max", "y_max"];

/// Refuses a table whose header names other columns than those of a row, or another order.
fn check_header(text: &str) -> Result<(), String> {
    let first = text.lines().find(|line| !line.trim().is_empty()).filter(|line| table::is_header(line));
    let names = first.map(table::cells).unwrap_or_default();
    for (at, name) in names.into_iter().enumerate().take(COLUMNS.len()) {
        let lower = name.trim_matches(['"', '#', ' ']).to_lowercase();
        let own = COLUMNS.iter().position(|column| column.contains(&lower.as_str()));
        if own.is_some_and(|own| own != at) || OTHERS.contains(&lower.as_str()) {
            let at = at + 1;
            return Err(format!(
                "its header has {name} in column {at}; the columns must be frame, id, left, top, width, height"
            ));
        }
    }
    Ok(())
}

fn objects(text: &str) -> Result<Tracks, String> {
    let mut tracks = Tracks::default();
    let mut lines = HashMap::new();
    for row in parse(text)?.into_iter().filter(|row| !row.is_absent()) {
        let Row { line, frame, id, min: [x, y], size: [width, height], visibility, .. } = row;
        let id = id.ok_or_else(|| format!("line {line}: identity -1 is a detection, not a track; give the gt.txt"))?;
        let object = ObjectBox { id, x, y, width, height, visibility };
        let kind = if row.is_scored { &mut tracks.objects } else { &mut tracks.ignored };
        let boxes = kind.entry(frame).or_default();
        if boxes.len() == MOST_IN_A_FRAME {
            let frame = frame + 1;
            return Err(format!(
                "line {line}: frame {frame} has more than {MOST_IN_A_FRAME} true boxes; leave some out"
            ));
        }
        boxes.push(object);
        if !row.is_scored {
            continue;
        }
        if let Some(before) = lines.insert((frame, id), line) {
            return Err(format!(
                "lines {before} and {line}: identity {id} is in frame {} twice; give each object an identity of its own",
                frame + 1
            ));
        }
    }
    if tracks.objects.is_empty() {
        return Err("it holds no objects; rows are frame, id, left, top, width, height, confidence …".into());
    }
    for objects in tracks.objects.values_mut() {
        objects.sort_by_key(|object| object.id);
    }
    Ok(tracks)
}

impl Row {
    /// Whether the object is not in the frame: a box without area, or of no numbers.
    fn is_absent(&self) -> bool {
        self.min.iter().any(|edge| edge.is_nan()) || self.size.iter().any(|side| side.is_nan() || *side <= 0.0)
    }
}

fn row(line: usize, text: &str) -> Result<Row, String> {
    let cells = table::cells(text).into_iter().map(table::number).collect::<Result<Vec<_>, _>>()?;
    let &[frame, id, left, top, width, height, ref rest @ ..] = cells.as_slice() else {
        return Err(format!(
            "{} values where at least 6 are needed (frame, id, left, top, width, height)",
            cells.len()
        ));
    };
    let frame = whole("frame", frame, 1.0)?;
    if frame > MOST_FRAMES {
        return Err(format!("frame {frame} is beyond {MOST_FRAMES}, the last that can be shown"));
    }
    let id = if id == -1.0 { None } else { Some(whole("identity", id, 0.0)?) };
    let far = [left, top, width, height].into_iter().find(|side| side.abs() > FARTHEST_PX);
    if let Some(far) = far {
        return Err(format!("{far} px is more than {FARTHEST_PX} px, the most that a box may have"));
    }
    // Nine columns end in the visibility; the older ten end in a place in the world.
    let visibility = match rest {
        &[_, _, visibility] if !visibility.is_nan() => single(visibility.clamp(0.0, 1.0)),
        _ => 1.0,
    };
    let confidence = rest.first().map_or(1.0, |&confidence| single(confidence));
    let min = [left, top].map(|edge| single(edge - FIRST_PX));
    let size = [width, height].map(single);
    // The class stands between confidence and visibility in the nine columns of a truth.
    let is_distractor = matches!(rest, &[_, class, _] if DISTRACTORS.contains(&class));
    let is_scored = confidence != 0.0 && !is_distractor;
    let row = Row { line, frame: frame as usize - 1, id, min, size, confidence, is_scored, visibility };
    if !confidence.is_finite() && !row.is_absent() {
        return Err(format!("confidence {} is no finite number", rest[0]));
    }
    Ok(row)
}

fn whole(what: &str, value: f64, least: f64) -> Result<u32, String> {
    let number = numbers::whole(value).filter(|_| value.fract() == 0.0 && value >= least);
    number.ok_or_else(|| format!("{what} {value} should be a whole number from {least} on"))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::media::export;

    #[test]
    fn both_generations_are_read() {
        let frames =
            objects("1,2,399,182,121,229,1,-1,-1,-1\n1,1,1,1,4,4,1\n\n2,1,2,1,4,4,1,1,0.25\n2,9,1,1,1,1,0,1,1\n");
        let Tracks { objects: frames, ignored, .. } = frames.unwrap();
        assert_eq!(ignored[&1].len(), 1);
        let ids = |t| frames[&t].iter().map(|o: &ObjectBox| o.id).collect::<Vec<_>>();
        assert_eq!((ids(0), ids(1)), (vec![1, 2], vec![1]));
        let object = ObjectBox { id: 1, x: 0.5, y: -0.5, width: 4.0, height: 4.0, visibility: 0.25 };
        assert_eq!(frames[&1], [object]);
        assert_eq!(frames[&0][1].visibility, 1.0);
    }

    #[test]
    fn a_header_with_other_columns_is_refused() {
        let rows = |header: &str| objects(&format!("{header}\n1,1,1,1,4,4\n"));
        for header in ["frame,id,bb_left,bb_top,bb_width,bb_height,conf,x,y,z", "Frame;Track_ID;X;Y;W;H"] {
            assert_eq!(rows(header).map(|tracks| tracks.objects.len()), Ok(1), "{header}");
        }
        for (header, name) in [("id,frame,x,y,w,h", "id in column 1"), ("frame,id,x1,y1,x2,y2", "x2 in column 5")] {
            let told = rows(header).unwrap_err();
            assert!(told.contains(name), "{told}");
        }
    }

    #[test]
    fn the_line_is_named() {
        let message = |row| objects(&format!("1,1,1,1,4,4,1\n{row}\n")).unwrap_err();
        for (row, why) in [
            ("1,1,1,1,4", "5 values"),
            ("0,1,1,1,4,4", "frame 0"),
            ("1.5,1,1,1,4,4", "frame 1.5"),
            ("1,-1,1,1,4,4,0.9", "give the gt.txt"),
            ("1,1,a,1,4,4", "“a”"),
            ("99999999999,1,1,1,4,4", "whole number"),
            ("2000000,1,1,1,4,4", "beyond 1000000"),
            ("1,1,-1e300,1,4,4", "more than 1000000 px"),
            ("1,1,1,1,1e300,4", "more than 1000000 px"),
            ("1,1,1,1,4,4,1e300", "confidence"),
        ] {
            assert!(message(row).starts_with("line 2: ") && message(row).contains(why), "{row}: {}", message(row));
        }
        let message = objects("1,1,1,1,4,4\n\n\n1,1,9,1,4,4,0\n1,-1,1,1,4,4\n").unwrap_err();
        let twice = objects("1,1,1,1,4,4\n1,2,1,1,4,4\n2,1,1,1,4,4\n1,1,9,1,4,4\n").unwrap_err();
        assert!(twice.starts_with("lines 1 and 4: identity 1 is in frame 1"), "{twice}");
        assert!(message.starts_with("line 5: identity"), "blank lines and those left out count: {message}");
        assert!(objects("").is_err());
    }

    #[test]
    fn a_frame_has_no_more_boxes_than_can_be_assigned() {
        let rows = |count: usize| (1..=count).map(|id| format!("7,{id},1,1,4,4,1\n")).collect::<String>();
        assert_eq!(objects(&rows(MOST_IN_A_FRAME)).unwrap().objects[&6].len(), MOST_IN_A_FRAME);
        let why = objects(&rows(100_000)).unwrap_err();
        assert!(why.starts_with(&format!("line {}: frame 7", MOST_IN_A_FRAME + 1)), "{why}");
    }

    #[test]
    fn what_the_benchmark_leaves_out_is_ignored() {
        let rows = "1,1,1,1,4,4,1,1,1\n1,2,9,1,4,4,1,7,1\n1,3,19,1,4,4,0,1,1\n1,4,29,1,4,4,1,3,1\n";
        let Tracks { objects, ignored, .. } = objects(rows).unwrap();
        let ids = |boxes: &[ObjectBox]| boxes.iter().map(|object| object.id).collect::<Vec<_>>();
        assert_eq!((ids(&objects[&0]), ids(&ignored[&0])), (vec![1, 4], vec![2, 3]));
    }

    #[test]
    fn an_absent_object_is_not_in_the_frame() {
        for absent in [
            "2,1,1,1,-1,-1",
            "2,1,1,1,0,0",
            "2,1,nan,nan,nan,nan",
            "2,1,nan,nan,nan,nan,nan,-1,-1,-1",
            "2,1,1,1,4,1e-300",
        ] {
            let objects = objects(&format!("1,1,1,1,4,4\n{absent}\n3,1,1,1,4,4\n")).unwrap().objects;
            assert_eq!(objects.into_keys().collect::<Vec<_>>(), [0, 2], "{absent}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn what_was_written_is_read(x in -50..50_i16, width in 1..99_u8, visibility in 0..=8_u8, t in 0..5_usize) {
            let object = ObjectBox {
                id: 3,
                x: f32::from(x) / 4.0,
                y: -0.5,
                width: f32::from(width) / 2.0,
                height: 1.25,
                visibility: f32::from(visibility) / 8.0,
            };
            let mut frames = vec![vec![]; t];
            frames.push(vec![object]);
            prop_assert_eq!(objects(&export::mot(&frames)).unwrap().objects, BTreeMap::from([(t, vec![object])]));
        }

        #[test]
        fn anything_is_read_as_finite_numbers_or_told(
            cells in prop::collection::vec("[1-9]|-1|0|-?[0-9]{1,3}(\\.[0-9])?(e-?[0-9]{1,3})?|", 5..10),
        ) {
            match parse(&cells.join(",")) {
                Err(message) => prop_assert!(message.starts_with("line 1: "), "{}", message),
                Ok(rows) => for row in rows {
                    let numbers = [row.min, row.size].concat();
                    if row.is_absent() { continue }
                    prop_assert!(numbers.iter().all(|v| v.is_finite()) && row.confidence.is_finite(), "{:?}", row);
                    let ends = [0, 1].map(|i| row.min[i] + row.size[i] - row.min[i]);
                    prop_assert!(ends.iter().all(|v| v.is_finite()) && row.size.iter().all(|v| *v > 0.0), "{:?}", row);
                },
            }
        }
    }
}
