//! Detections: MOTChallenge's rows, beside a clip or by themselves.

use std::io::Read;
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::data::{Clip, Detection};
use motionscope_core::geometry::Bounds;

use super::companion::{Companion, LeftView};
use super::export::InputKind;
use super::input::{self, Node};
use super::names::{extension, file_name};
use super::numbers::whole;
use super::truth::mot::{self, MOST_IN_A_FRAME};
use super::{Given, Open, about, check_size};
use crate::files::{self, File};

/// Margin around the boxes of a clip without images, in px.
const MARGIN_PX: f32 = 16.0;

/// The bytes in which the first row of a table is looked for.
const BEGINNING_BYTES: u64 = 4096;

/// Returns the detections of each frame, from frame 0 on, in the `det.txt` at `path`.
///
/// # Errors
/// A sentence that names the line if a row cannot be understood.
pub fn read(path: &Path) -> Result<Vec<Vec<Detection>>, Error> {
    let rows = mot::detections(path)?;
    let last = rows.iter().map(|row| row.frame).max().unwrap_or(0);
    let mut frames = vec![Vec::new(); last + 1];
    for row in rows {
        if frames[row.frame].len() == MOST_IN_A_FRAME {
            let why = format!(
                "line {}: frame {} has more than {MOST_IN_A_FRAME} detections; leave out those with low scores",
                row.line,
                row.frame + 1
            );
            return Err(about(path, &Error::new(why)));
        }
        let bounds = Bounds { min: row.min, max: [row.min[0] + row.size[0], row.min[1] + row.size[1]] };
        frames[row.frame].push(Detection {
            bounds,
            center: bounds.center(),
            score: row.confidence,
            blob: None,
            deviation_px: None,
        });
    }
    Ok(frames)
}

/// Whether the file at `path` is a table of detections by its name and its first row.
pub fn is(path: &Path) -> bool {
    let is_text = matches!(extension(path).as_str(), "txt" | "csv");
    is_text && beginning(path).is_some_and(|text| mot::is_detections(&text))
}

/// The detections of a clip, in this file.
pub struct Detections(PathBuf);

impl Companion for Detections {
    const KIND: InputKind = InputKind::Detections;
    const IGNORED: &'static str = "detections beside the clip are ignored";

    fn given(_left: &LeftView<'_>, given: &Given) -> Option<Self> {
        given.detections.clone().map(Self)
    }

    /// The table that lies where MOTChallenge puts it: `det.txt` or `det/det.txt` in the folder of the pictures, or beside that folder
    /// where it is called `img1`. One beside a video may be of another clip.
    fn beside(left: &LeftView<'_>, _given: &Given) -> Option<Self> {
        let folder = Some(left.path).filter(|path| files::is_dir(path) && *path != Path::new("-"))?;
        let above = if folder.ends_with("img1") { folder.parent() } else { None };
        let folders = [Some(folder), above].into_iter().flatten();
        let mut files = folders.flat_map(|folder| [folder.join("det.txt"), folder.join("det").join("det.txt")]);
        files.find(|file| is(file)).map(Self)
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.0.clone()]
    }

    fn attach(self, clip: Clip, _left: &LeftView<'_>, _options: &Open) -> Result<Clip, Error> {
        read(&self.0).map(|found| clip.with_detections(found))
    }
}

/// Whether the file at `path` is a table of true objects by its name and its first row: they have identities.
pub fn is_truth(path: &Path) -> bool {
    extension(path) == "txt" && beginning(path).is_some_and(|text| mot::is_objects(&text))
}

/// The whole lines at the beginning of the file at `path`.
fn beginning(path: &Path) -> Option<String> {
    // Of a pipe it would be gone.
    if Node::of(path) != Ok(Node::File) {
        return None;
    }
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(BEGINNING_BYTES).read_to_end(&mut bytes).ok()?;
    if bytes.len() as u64 == BEGINNING_BYTES {
        bytes.truncate(bytes.iter().rposition(|byte| *byte == b'\n')?);
    }
    input::text_of(bytes).ok()
}

/// A clip of empty pictures, just large enough, with the detections at `path`.
///
/// # Errors
/// As [`read`].
pub fn open(path: &Path) -> Result<Clip, Error> {
    let frames = read(path)?;
    let reach = frames
        .iter()
        .flatten()
        .fold([1.0_f32; 2], |reach, found| [0, 1].map(|i| reach[i].max(found.bounds.max[i] + MARGIN_PX)));
    let [width, height] = reach.map(|side| whole(side.ceil().into()).unwrap_or(usize::MAX));
    if check_size(width, height).is_err() {
        let why = format!("its boxes need a picture of {width}×{height} px, which is too large; see the farthest ones");
        return Err(about(path, &Error::new(why)));
    }
    let clip = Clip::blank(file_name(path), (width, height), frames.len().max(2));
    Ok(clip.with_detections(frames))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::media::{self, export};

    fn opened(text: &str) -> Result<Clip, Error> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("det.txt");
        fs::write(&path, text).unwrap();
        assert!(is(&path));
        media::open(&path, &media::Open::default()).map(|opened| opened.clip)
    }

    #[test]
    fn detections_are_a_clip_of_their_own() {
        let clip = opened("1,-1,11,21,40,80,0.9,-1,-1,-1\n3,-1,51.5,21,40,80,0.4,-1,-1,-1\n").unwrap();
        assert_eq!((clip.size(), clip.info().frames), ((106, 116), Some(3)));
        let found = clip.detections(2).unwrap()[0];
        assert_eq!((found.bounds.min, found.bounds.size(), found.score), ([50.0, 19.5], [40.0, 80.0], 0.4));
        assert_eq!(clip.detections(1).map(<[_]>::len), Some(0));
        assert!(clip.pair(1).is_ok());
    }

    #[test]
    fn pictures_have_the_detections_that_lie_beside_them() {
        let folder = tempfile::tempdir().unwrap();
        let [pictures, found] = ["img1", "det"].map(|name| folder.path().join(name));
        [&pictures, &found].into_iter().for_each(|path| fs::create_dir(path).unwrap());
        for t in 1..4 {
            let picture = export::png(8, 6, export::Pixels::Gray(&[t; 48])).unwrap();
            fs::write(pictures.join(format!("{t:06}.png")), picture).unwrap();
        }
        let opened = || media::open(&pictures, &media::Open::default()).unwrap().clip;
        assert_eq!(opened().detections(0), None);
        fs::write(found.join("det.txt"), "1,-1,1,1,4,4,0.9\n2,-1,2,1,4,4,0.9\n2,-1,5,1,2,4,0.9\n").unwrap();
        assert_eq!(opened().detections(1).map(<[_]>::len), Some(2));
        fs::write(found.join("det.txt"), "1,-1,1,1,4,4,0.9\n2,-1,x,1,4,4,0.9\n").unwrap();
        let clip = opened();
        assert!(clip.detections(0).is_none() && clip.info().warnings.iter().any(|w| w.contains("line 2")), "{clip:?}");
        // A picture by itself, or a video, may lie there by chance.
        fs::write(pictures.join("det.txt"), "1,-1,1,1,4,4,0.9\n").unwrap();
        let alone = media::open(&pictures.join("000001.png"), &media::Open::default()).unwrap().clip;
        assert_eq!(alone.detections(0), None);
    }

    #[test]
    fn the_line_is_named() {
        let message = opened("1,-1,11,21,40,80,0.9\n2,-1,1,1,-4,80,1\n").unwrap_err().to_string();
        assert!(message.contains("det.txt") && message.contains("line 2"), "{message}");
        let message = opened("1,-1,1,1,4,4,1\n1,-1,1,1,900000,80,1\n").unwrap_err().to_string();
        assert!(message.contains("its boxes need") && !message.contains("header"), "{message}");
        let message = opened(&"1,-1,1,1,4,4,1\n".repeat(5001)).unwrap_err().to_string();
        assert!(message.contains("line 5001") && message.contains("5000 detections"), "{message}");
    }
}
