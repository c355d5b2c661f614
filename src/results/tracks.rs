//! The tracks of objects, as MOTChallenge rows, as a table and as an array.

use std::borrow::Cow;

use motionscope_core::base::Error;
use motionscope_core::products::{Followed, Object, ObjectField, Output, Product, RegionField, TrackStatus};

use super::{EncodedFiles, Export, Format, table};
use crate::media::export::{mot_rect, npy_of};

pub const EXPORT: Export = Export {
    flag: "tracks",
    value: "FILE",
    help: "Save the tracks: .txt as MOTChallenge rows, .csv with units, or .npy; `-` is standard output",
    name: "Tracks",
    explained: "The tracks: position and box of each object in each frame.",
    takes: &[ObjectField::KIND, RegionField::KIND],
    folder: None,
    or_file: false,
    formats: &[
        Format {
            ending: "txt",
            doc: "MOTChallenge rows, for other evaluation programs",
            encode: |output| mot(&*field(output)?).map(EncodedFiles::file),
        },
        Format { ending: "csv", doc: "CSV, one row per object and frame", encode: as_csv },
        Format {
            ending: "npy",
            doc: "NPY, an array for NumPy",
            encode: |output| tracked(output).map(|field| EncodedFiles::file(npy(&field))),
        },
    ],
};

/// The objects of a result; a tracked region is one of them.
fn field(output: &Output) -> Result<Cow<'_, ObjectField>, Error> {
    let region = || output.get::<RegionField>().map(|field| Cow::Owned(field.objects()));
    let field = output.get().map(Cow::Borrowed).or_else(region);
    field.ok_or_else(|| Error::new("this result has no objects; choose a tracker"))
}

/// The objects, where these are tracked.
fn tracked(output: &Output) -> Result<Cow<'_, ObjectField>, Error> {
    let field = field(output)?;
    mot(&field).map(|_| field)
}

fn as_csv(output: &Output) -> Result<EncodedFiles, Error> {
    Ok(EncodedFiles::file(table::csv(&tracked(output)?.object_table())))
}

/// The objects seen in each frame as MOTChallenge's results: frame, id, left, top, width, height, 1, −1, −1, −1; frames and
/// pixels counted from 1. Tentative objects and those that coast are left out.
///
/// # Errors
/// If no object is followed.
fn mot(field: &ObjectField) -> Result<String, Error> {
    if field.followed == Followed::Nothing {
        return Err(Error::new(
            "each frame was processed by itself, so there are no tracks; choose a tracker, or --table",
        ));
    }
    let seen = |object: &&Object| object.status == TrackStatus::Confirmed;
    let row = |t: usize, object: &Object| {
        let ([x, y], [width, height]) = (object.bounds.min, object.bounds.size());
        let [left, top, width, height] = mot_rect([x, y, width, height]);
        format!("{},{},{left},{top},{width},{height},1,-1,-1,-1\n", t + 1, object.id)
    };
    let frames = field.frames.iter().enumerate();
    let rows = frames.flat_map(|(i, frame)| frame.objects.iter().filter(seen).map(move |o| row(field.first + i, o)));
    Ok(rows.collect())
}

/// How many numbers [`npy`] has of an object in a frame.
const NUMBERS: usize = 11;

/// The objects of each frame as an `.npy` of version 1.0: little-endian f64 of shape (rows, 11) with frame, identity, x, y, u, v,
/// left, top, width, height in px and px/frame, and track status: 0 tentative, 1 confirmed, 2 coasting. What is not
/// known is NaN.
fn npy(field: &ObjectField) -> Vec<u8> {
    let row = |frame: usize, object: &Object| -> [f64; NUMBERS] {
        let ([x, y], [u, v]) = (object.position, object.velocity.unwrap_or([f64::NAN; 2]));
        let ([left, top], [width, height]) = (object.bounds.min.map(f64::from), object.bounds.size().map(f64::from));
        let status = match object.status {
            TrackStatus::Tentative => 0.0,
            TrackStatus::Confirmed => 1.0,
            TrackStatus::Coasting => 2.0,
        };
        [frame as f64, f64::from(object.id), x, y, u, v, left, top, width, height, status]
    };
    let frames = field.frames.iter().enumerate();
    let rows: Vec<_> =
        frames.flat_map(|(i, frame)| frame.objects.iter().map(move |o| row(field.first + i, o))).collect();
    npy_of("<f8", &format!("{}, {NUMBERS}", rows.len()), rows.iter().flatten().flat_map(|c| c.to_le_bytes()))
}

#[cfg(test)]
mod tests;
