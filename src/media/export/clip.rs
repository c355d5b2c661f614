//! A whole clip as numbered pictures with its truth beside them.

use std::path::Path;
use std::{fs, io};

use motionscope_core::{Clip, Error, Frame, Grid, Truth};

use super::{Pixels, flo, mot, png, save};
use crate::media::Progress;
use crate::media::names::file_name;
use crate::media::sequence::{Sequence, number};

/// Writes `clip` into `folder`: `frame_0000.png` …, and what is known about it as `flow/frame_0000.flo` …,
/// `occ/frame_0000.png` … and `gt.txt`, so that opening the folder finds all of it again. Of an earlier clip in the folder
/// these files are replaced, or removed where nothing is known of this clip; nothing else is touched.
///
/// # Errors
/// If a frame cannot be decoded, a file cannot be written or removed, the folder holds other pictures, or the work was cancelled.
pub fn clip(clip: &Clip, folder: &Path, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let name = &clip.info().name;
    let Some(frames) = clip.info().frames else {
        return Err(Error::new(format!("{name} cannot be written: count its frames first")));
    };
    make(folder)?;
    refuse_other_pictures(folder, frames)?;
    for t in 0..frames {
        if let Some(progress) = progress {
            if progress.cancelled() {
                return Err(Error::new(format!("writing {name} was cancelled after {t} of {frames} frames")));
            }
            progress.report(t as f32 / frames as f32);
        }
        save(&folder.join(format!("frame_{t:04}.png")), &frame(&*clip.frame(t)?)?)?;
        let [flow, mask] = match clip.truth() {
            Some(truth) => fields(truth.as_ref(), t)?,
            None => [None, None],
        };
        put(&folder.join("flow"), &format!("frame_{t:04}.flo"), flow)?;
        put(&folder.join("occ"), &format!("frame_{t:04}.png"), mask)?;
    }
    let rows = match clip.truth() {
        Some(truth) => tracks(truth.as_ref(), frames)?,
        None => None,
    };
    put(folder, "gt.txt", rows.map(String::into_bytes))
}

/// `frame` as a PNG: in colour where it has any, gray otherwise.
///
/// # Errors
/// If it has no pixels.
pub fn frame(frame: &Frame) -> Result<Vec<u8>, Error> {
    let (width, height) = frame.size();
    let pixels = match frame.color() {
        Some(rgb) => Pixels::Rgb(rgb.cells().as_flattened()),
        None => Pixels::Gray(frame.luma().cells()),
    };
    png(width, height, pixels)
}

fn make(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder)
        .map_err(|e| Error::new(format!("the folder {} cannot be made ({e}); choose another one", folder.display())))
}

/// Pictures of a longer clip would become part of this one.
fn refuse_other_pictures(folder: &Path, frames: usize) -> Result<(), Error> {
    let Ok(there) = Sequence::find(folder) else { return Ok(()) };
    let is_other = |name: &String| {
        let ours = number(name).filter(|&n| n < frames as u64).map(|n| format!("frame_{n:04}.png"));
        ours.as_ref() != Some(name)
    };
    match there.files.iter().map(|file| file_name(file)).find(is_other) {
        Some(other) => Err(Error::new(format!(
            "{} already holds {other}, which would be mixed with the clip; choose an empty folder",
            folder.display()
        ))),
        None => Ok(()),
    }
}

/// Writes the file called `name`, or removes that of an earlier clip, which would be read as the truth of this one.
fn put(folder: &Path, name: &str, bytes: Option<Vec<u8>>) -> Result<(), Error> {
    let path = folder.join(name);
    if let Some(bytes) = bytes {
        make(folder)?;
        return save(&path, &bytes);
    }
    match fs::remove_file(&path) {
        Err(e) if !matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Err(Error::new(
            format!("{} of an earlier clip cannot be removed ({e}); choose an empty folder", path.display()),
        )),
        _ => Ok(()),
    }
}

/// The files of flow and of occlusion at frame `t`, where they are known.
fn fields(truth: &dyn Truth, t: usize) -> Result<[Option<Vec<u8>>; 2], Error> {
    let flow = truth.flow(t)?.map(|flow| flo(&flow));
    let hidden = truth.occlusion(t)?.map(|hidden| mask(&hidden)).transpose()?;
    Ok([flow, hidden])
}

fn mask(hidden: &Grid<bool>) -> Result<Vec<u8>, Error> {
    let gray = hidden.map(|&hidden| if hidden { 255 } else { 0 });
    png(gray.width(), gray.height(), Pixels::Gray(gray.cells()))
}

fn tracks(truth: &dyn Truth, frames: usize) -> Result<Option<String>, Error> {
    let objects = (0..frames).map(|t| truth.objects(t)).collect::<Result<Vec<_>, _>>()?;
    let any = objects.iter().flatten().any(|frame| !frame.is_empty());
    Ok(any.then(|| mot(&objects.into_iter().map(Option::unwrap_or_default).collect::<Vec<_>>())))
}

#[cfg(test)]
mod tests {
    use motionscope_core::synth;

    use super::*;
    use crate::media::{Open, open};

    /// The first synthetic clip with objects in it.
    fn made(frames: usize) -> Clip {
        let clips = synth::SCENES.iter().map(|scene| {
            let mut difficulty = scene.difficulty();
            (difficulty.frames, difficulty.width, difficulty.height) = (frames, 96, 64);
            scene.clip(&difficulty).unwrap()
        });
        let has_objects = |clip: &Clip| clip.truth().unwrap().objects(0).unwrap().is_some_and(|all| !all.is_empty());
        clips.into_iter().find(has_objects).unwrap()
    }

    #[test]
    fn what_is_written_opens_again() {
        let folder = tempfile::tempdir().unwrap();
        let made = made(4);
        clip(&made, folder.path(), None).unwrap();
        // A second time over the first is fine.
        clip(&made, folder.path(), None).unwrap();
        let read = open(folder.path(), &Open::default()).unwrap();
        assert_eq!((read.size(), read.info().frames, read.info().warnings.len()), ((96, 64), Some(4), 0));
        let (wanted, found) = (made.truth().unwrap(), read.truth().unwrap());
        assert_eq!(found.kinds(), wanted.kinds());
        for t in 0..4 {
            assert_eq!(read.frame(t).unwrap(), made.frame(t).unwrap());
            assert_eq!(found.occlusion(t).unwrap(), wanted.occlusion(t).unwrap());
            let [a, b] = [&wanted, &found].map(|truth| truth.flow(t).unwrap().map(|flow| flo(&flow)));
            assert_eq!(a, b);
            let [a, b] = [&wanted, &found].map(|truth| truth.objects(t).unwrap().unwrap());
            assert_eq!(a.len(), b.len());
            assert!(a.iter().zip(&b).all(|(a, b)| a.id == b.id && (a.x - b.x).abs() < 1e-3));
        }
    }

    #[test]
    fn truth_of_an_earlier_clip_goes_and_nothing_else() {
        let (folder, source) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        clip(&made(4), folder.path(), None).unwrap();
        clip(&made(4), source.path(), None).unwrap();
        let others = ["notes.txt", "gt.txt.bak", "flow/notes.txt", "flow/frame_0009.flo", "occ/frame_0001.txt"];
        for other in others {
            fs::write(folder.path().join(other), other).unwrap();
        }
        let is_there = |name: &str| folder.path().join(name).is_file();

        // Without tracks, and without the flow of one frame.
        fs::remove_file(source.path().join("gt.txt")).unwrap();
        fs::remove_file(source.path().join("flow/frame_0001.flo")).unwrap();
        clip(&open(source.path(), &Open::default()).unwrap(), folder.path(), None).unwrap();
        assert!(!is_there("gt.txt") && !is_there("flow/frame_0001.flo"));
        assert!(is_there("flow/frame_0000.flo") && is_there("flow/frame_0002.flo") && is_there("occ/frame_0001.png"));

        // Without any truth.
        fs::remove_dir_all(source.path().join("flow")).unwrap();
        fs::remove_dir_all(source.path().join("occ")).unwrap();
        clip(&open(source.path(), &Open::default()).unwrap(), folder.path(), None).unwrap();
        assert!(open(folder.path(), &Open::default()).unwrap().truth().is_none());
        assert!((0..4).all(|t| is_there(&format!("frame_{t:04}.png"))));
        for other in others {
            assert_eq!(fs::read_to_string(folder.path().join(other)).unwrap(), other);
        }
    }

    #[test]
    fn other_pictures_are_not_mixed_in() {
        let folder = tempfile::tempdir().unwrap();
        clip(&made(4), folder.path(), None).unwrap();
        let told = clip(&made(3), folder.path(), None).unwrap_err().to_string();
        assert!(told.contains("frame_0003.png"), "{told}");
    }
}
