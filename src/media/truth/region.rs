//! The region of one object in every frame, as the benchmarks OTB and VOT have it: a line for each frame.

use std::collections::BTreeMap;
use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::ObjectBox;

use super::file_error;
use super::mot::Tracks;
use crate::media::numbers::single;
use crate::media::table;

/// Largest coordinate and size of a box in px; larger values are errors.
const FARTHEST_PX: f64 = 1e6;
/// The left and top edge of our first pixel lie at −0.5, those of theirs at 1.
const FIRST_PX: f64 = 1.5;
/// The identity of the object.
const ID: u32 = 1;

/// The box of the object in each frame, from the text that is in `path`; frames counted from 0. Four numbers are left, top, width and
/// height, eight the corners of a polygon, of which the box around it is taken; both count pixels from 1. In a frame with an empty
/// line, NaN or a box without area there is no object.
///
/// # Errors
/// A sentence that names the line if it cannot be understood.
pub(super) fn of_text(path: &Path, text: &str) -> Result<Tracks, Error> {
    let objects = boxes(text).map_err(|why| file_error(path, why))?;
    let is_turned = table::rows(text).any(|(_, line)| is_turned(line));
    let warning = is_turned.then_some("ground truth: rotated polygons are compared as the upright boxes around them");
    Ok(Tracks { objects, warning, ..Tracks::default() })
}

/// Whether a line is a polygon that is no upright box.
fn is_turned(line: &str) -> bool {
    let numbers: Vec<f64> = table::cells(line).into_iter().filter_map(|cell| table::number(cell).ok()).collect();
    let distinct = |first: usize| {
        let mut all: Vec<u64> = numbers.iter().skip(first).step_by(2).map(|number| number.to_bits()).collect();
        all.sort_unstable();
        all.dedup();
        all.len()
    };
    numbers.len() == 8 && (distinct(0) > 2 || distinct(1) > 2)
}

/// Whether the table in a text has a region in its first line.
pub(super) fn is_region(text: &str) -> bool {
    table::rows(text).next().is_some_and(|(_, line)| table::cells(line).len() == 4)
}

fn boxes(text: &str) -> Result<BTreeMap<usize, Vec<ObjectBox>>, String> {
    // Blank lines before a header belong to it; without one they are frames in which the object is absent.
    let first = text.lines().position(|line| !line.trim().is_empty());
    let header = first.filter(|at| text.lines().nth(*at).is_some_and(table::is_header)).map_or(0, |at| at + 1);
    let lines = text.trim_end().lines().skip(header).enumerate();
    let frames = lines.map(|(t, line)| {
        let found = object(line).map_err(|why| format!("line {}: {why}", t + header + 1))?;
        Ok((t, found.into_iter().collect()))
    });
    let frames: BTreeMap<usize, Vec<ObjectBox>> = frames.collect::<Result<_, String>>()?;
    if frames.values().all(Vec::is_empty) {
        return Err("it holds no region; a line for each frame is left, top, width, height, or four corners".into());
    }
    Ok(frames)
}

/// The object of a line, if there is one.
fn object(line: &str) -> Result<Option<ObjectBox>, String> {
    if line.trim().is_empty() {
        return Ok(None);
    }
    let numbers = table::cells(line).into_iter().map(table::number).collect::<Result<Vec<_>, _>>()?;
    if ![4, 8].contains(&numbers.len()) {
        let count = numbers.len();
        return Err(format!("{count} values where 4 (left, top, width, height) or 8 (four corners) are needed"));
    }
    if numbers.iter().any(|number| number.is_nan()) || numbers.iter().all(|number| *number == 0.0) {
        return Ok(None);
    }
    if let Some(far) = numbers.iter().find(|number| number.abs() > FARTHEST_PX) {
        return Err(format!("{far} px is more than {FARTHEST_PX} px, the most that a region may have"));
    }
    let [min, max] = match numbers[..] {
        [left, top, width, height] => [[left, top], [left + width, top + height]],
        _ => {
            let along = |first: usize| numbers.iter().skip(first).step_by(2).copied();
            let least = |first| along(first).fold(f64::INFINITY, f64::min);
            let most = |first| along(first).fold(f64::NEG_INFINITY, f64::max);
            [[least(0), least(1)], [most(0), most(1)]]
        }
    };
    let [width, height] = [0, 1].map(|i| single(max[i] - min[i]));
    if width <= 0.0 || height <= 0.0 {
        return Ok(None);
    }
    let [x, y] = min.map(|edge| single(edge - FIRST_PX));
    Ok(Some(ObjectBox { id: ID, x, y, width, height, visibility: 1.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_of_lines_are_read() {
        let frames =
            boxes("1,1,4,6\n3.5 2 5 5\nNaN,NaN,NaN,NaN\n0\t0\t0\t0\n\n-1,-1,-1,-1\n7,7,0,0\n10,2,14,4,12,9,8,7\n\n")
                .expect("regions");
        let object = |x, y, width, height| vec![ObjectBox { id: 1, x, y, width, height, visibility: 1.0 }];
        let expected = [
            object(-0.5, -0.5, 4.0, 6.0),
            object(2.0, 0.5, 5.0, 5.0),
            Vec::new(),
            Vec::new(),
            Vec::new(),
            Vec::new(),
            Vec::new(),
            object(6.5, 0.5, 6.0, 7.0),
        ];
        assert_eq!(frames.into_values().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn the_line_is_named() {
        for (line, why) in [
            ("1,2,3", "3 values"),
            ("1,2,3,4,5", "5 values"),
            ("1,2,a,4", "“a”"),
            ("1,2,3,1e9", "more than 1000000 px"),
            ("1,1,2,2,3,3,4,1,5", "9 values"),
        ] {
            let told = boxes(&format!("1,1,4,4\n{line}\n1,1,4,4\n")).expect_err("damaged");
            assert!(told.starts_with("line 2: ") && told.contains(why), "{line}: {told}");
        }
        assert!(boxes("0,0,0,0\n").is_err() && boxes("").is_err());
    }

    #[test]
    fn rotated_polygons_are_warned_of() {
        let warning = |text| of_text(Path::new("gt"), text).expect("regions").warning;
        assert!(warning("10,2,14,4,12,9,8,7\n").is_some());
        assert_eq!((warning("1,1,5,1,5,4,1,4\n"), warning("1,1,4,6\n")), (None, None));
    }

    #[test]
    fn a_table_of_tracks_is_no_region() {
        assert!(is_region("\n12,30,44,60\n") && is_region("12 30 44 60"));
        assert!(!is_region("1,1,12,30,44,60,1,-1,-1,-1\n") && !is_region(""));
    }
}
