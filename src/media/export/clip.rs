//! Export of a clip as numbered images with its ground truth.

use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::{Calibration, Clip, Frame, PixelClass, TrueMask, Truth, Viewpoint};
use motionscope_core::geometry::Grid;

use super::save::{NewFolder, not_made};
use super::written_files::WrittenFiles;
use super::{Pixels, flo, make_folder, mot, pfm, png, save};
use crate::files::{self, temporary};
use crate::media::Progress;
use crate::media::names::file_name;
use crate::media::sequence::{Sequence, number};
use crate::work;

/// Writes `clip` into `folder`: `frame_0000.png` …, and what is known about it as `flow/frame_0000.flo` …,
/// `occ/frame_0000.png` …, `foreground/frame_0000.png` …, `disparity/frame_0000.pfm` … and `gt.txt`, and of a second view
/// `right/frame_0000.png` … and `calib.txt`, so that opening the folder finds all of it again. A clip that was written there
/// earlier is replaced, once all of this one is made; what anybody else wrote or changed is not touched.
///
/// # Errors
/// If a frame cannot be decoded, a file cannot be written, the folder holds other pictures or files by these names, or
/// the work was cancelled. The folder is then as it was, unless the disk failed while files were moved into place.
pub async fn clip(clip: &Clip, folder: &Path, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let name = &clip.info().name;
    let Some(frames) = clip.info().frames else {
        return Err(Error::new(format!("{name} cannot be written: count its frames first")));
    };
    let made = NewFolder::make(folder)?;
    fill(clip, frames, folder, progress).await?;
    made.keep();
    Ok(())
}

/// Writes all `frames` of `clip` into `folder`, which is there.
async fn fill(clip: &Clip, frames: usize, folder: &Path, progress: Option<&dyn Progress>) -> Result<(), Error> {
    let name = &clip.info().name;
    refuse_other_pictures(folder, frames)?;
    let before = WrittenFiles::read(folder);
    refuse_foreign(folder, &before, frames)?;
    let mut draft = UnfinishedClip::new(folder)?;
    for t in 0..frames {
        if let Some(progress) = progress {
            if progress.cancelled() {
                return Err(Error::new(format!("saving {name} was cancelled after {t} of {frames} frames")));
            }
            progress.report(t as f32 / frames as f32);
        }
        work::breathe().await;
        let [picture, right, known @ ..] = names(t);
        draft.put(&picture, &frame(&*clip.frame(t)?)?)?;
        if clip.right().is_some() {
            draft.put(&right, &frame(&*clip.frame_from(Viewpoint::Right, t)?)?)?;
        }
        if let Some(truth) = clip.truth() {
            for (name, bytes) in known.iter().zip(fields(truth.as_ref(), t)?) {
                bytes.map_or(Ok(()), |bytes| draft.put(name, &bytes))?;
            }
        }
    }
    if let Some(truth) = clip.truth() {
        tracks(truth.as_ref(), frames)?.map_or(Ok(()), |rows| draft.put(TRACKS, rows.as_bytes()))?;
    }
    clip.calibration()
        .map_or(Ok(()), |cameras| draft.put(CALIBRATION, calibration(cameras, clip.size()).as_bytes()))?;
    draft.settle(folder, &before)
}

/// The file of all objects.
const TRACKS: &str = "gt.txt";

/// The file of the cameras.
const CALIBRATION: &str = "calib.txt";

/// The files of frame `t`: its picture, its right view, its flow, its mask of occlusion, its foreground, its disparity and that of its points in
/// the next frame.
fn names(t: usize) -> [String; 7] {
    let starts = [
        ("frame_", "png"),
        ("right/frame_", "png"),
        ("flow/frame_", "flo"),
        ("occ/frame_", "png"),
        ("foreground/frame_", "png"),
        ("disparity/frame_", "pfm"),
        ("next-disparity/frame_", "pfm"),
    ];
    starts.map(|(start, ending)| format!("{start}{t:04}.{ending}"))
}

/// The calibration as Middlebury has it: matrices by rows, baseline in mm.
fn calibration(cameras: &Calibration, (width, height): (usize, usize)) -> String {
    let Calibration { focal_px: f, baseline_m, principal_px: [x, y], offset_px } = cameras;
    let camera = |x: f64| format!("[{f} 0 {x}; 0 {f} {y}; 0 0 1]");
    let (left, right, baseline_mm) = (camera(*x), camera(x + offset_px), baseline_m * 1000.0);
    format!("cam0={left}\ncam1={right}\ndoffs={offset_px}\nbaseline={baseline_mm}\nwidth={width}\nheight={height}\n")
}

/// A clip in a folder of its own beside the place where it goes; gone if it does not get there.
struct UnfinishedClip {
    folder: temporary::Folder,
    written: WrittenFiles,
}

impl UnfinishedClip {
    fn new(folder: &Path) -> Result<Self, Error> {
        let made = temporary::folder(folder).map_err(|e| not_made(folder, &e))?;
        Ok(Self { folder: made, written: WrittenFiles::default() })
    }

    fn put(&mut self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let _at_work = temporary::at_work();
        let path = self.folder.path().join(name);
        path.parent().map_or(Ok(()), make_folder)?;
        save(&path, bytes)?;
        self.written.note(name, bytes);
        Ok(())
    }

    /// Takes the place of the clip `before` in `folder`.
    fn settle(self, folder: &Path, before: &WrittenFiles) -> Result<(), Error> {
        let _at_work = temporary::at_work();
        let places = || self.written.names().map(|name| (name, folder.join(name)));
        // Where a folder cannot be made, nothing is lost yet.
        places().try_for_each(|(_, path)| path.parent().map_or(Ok(()), make_folder))?;
        // Truth of an earlier clip would be read as the truth of this one.
        let old = before.names().filter(|name| !self.written.contains(name) && !before.is_foreign(folder, name));
        for name in old {
            // It may be gone already.
            _ = files::remove_file(&folder.join(name));
        }
        for (name, path) in places() {
            files::rename(&self.folder.path().join(name), &path).map_err(|e| {
                Error::new(format!("{} cannot be written ({e}); choose an empty folder", path.display()))
            })?;
        }
        self.written.save(folder)
    }
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

/// Refuses to overwrite files with the names of this clip's files that are not part of the clip `before`.
fn refuse_foreign(folder: &Path, before: &WrittenFiles, frames: usize) -> Result<(), Error> {
    let mut names = (0..frames).flat_map(names).chain([TRACKS, CALIBRATION].map(String::from));
    match names.find(|name| before.is_foreign(folder, name)) {
        Some(name) => Err(Error::new(format!(
            "{} already holds {name}, which is not part of an earlier synthetic clip; choose an empty folder",
            folder.display()
        ))),
        None => Ok(()),
    }
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

/// The files of flow, occlusion, foreground and both disparities at frame `t`, where they are known.
fn fields(truth: &dyn Truth, t: usize) -> Result<[Option<Vec<u8>>; 5], Error> {
    let flow = truth.flow(t)?.map(|flow| flo(&flow));
    let hidden = truth.occlusion(t)?.map(|hidden| mask(&hidden)).transpose()?;
    let foreground = truth.foreground(t)?.map(|classes| foreground(&classes)).transpose()?;
    let disparity = truth.disparity(t)?.map(|map| pfm(&map));
    let next = truth.next_disparity(t)?.map(|map| pfm(&map));
    Ok([flow, hidden, foreground, disparity, next])
}

fn mask(hidden: &Grid<bool>) -> Result<Vec<u8>, Error> {
    let gray = hidden.map(|&hidden| if hidden { 255 } else { 0 });
    png(gray.width(), gray.height(), Pixels::Gray(gray.cells()))
}

/// A true mask in the gray levels of changedetection.net.
fn foreground(TrueMask(classes): &TrueMask) -> Result<Vec<u8>, Error> {
    let gray = classes.map(|class| match class {
        PixelClass::Background => 0,
        PixelClass::Shadow => 50,
        PixelClass::Ignored => 170,
        PixelClass::Foreground => 255,
    });
    png(gray.width(), gray.height(), Pixels::Gray(gray.cells()))
}

fn tracks(truth: &dyn Truth, frames: usize) -> Result<Option<String>, Error> {
    let objects = (0..frames).map(|t| truth.objects(t)).collect::<Result<Vec<_>, _>>()?;
    let any = objects.iter().flatten().any(|frame| !frame.is_empty());
    Ok(any.then(|| mot(&objects.into_iter().map(Option::unwrap_or_default).collect::<Vec<_>>())))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use std::collections::BTreeMap;
    use std::path::PathBuf;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use motionscope_core::synth;

    use super::*;
    use crate::media::{Open, open};

    fn clip(clip: &Clip, folder: &Path, progress: Option<&dyn Progress>) -> Result<(), Error> {
        work::finish(super::clip(clip, folder, progress))
    }

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
        let read = open(folder.path(), &Open::default()).unwrap().clip;
        assert_eq!((read.size(), read.info().frames, read.info().warnings.len()), ((96, 64), Some(4), 0));
        let (wanted, found) = (made.truth().unwrap(), read.truth().unwrap());
        // Segments have no format of their own in a folder.
        let kinds: Vec<_> = wanted.kinds().into_iter().filter(|kind| *kind != "segments").collect();
        assert_eq!(found.kinds(), kinds);
        for t in 0..4 {
            assert_eq!(read.frame(t).unwrap(), made.frame(t).unwrap());
            assert_eq!(found.occlusion(t).unwrap(), wanted.occlusion(t).unwrap());
            assert_eq!(found.foreground(t).unwrap(), wanted.foreground(t).unwrap());
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
        clip(&open(source.path(), &Open::default()).unwrap().clip, folder.path(), None).unwrap();
        assert!(!is_there("gt.txt") && !is_there("flow/frame_0001.flo"));
        assert!(is_there("flow/frame_0000.flo") && is_there("flow/frame_0002.flo") && is_there("occ/frame_0001.png"));

        // Without any truth.
        fs::remove_dir_all(source.path().join("flow")).unwrap();
        fs::remove_dir_all(source.path().join("occ")).unwrap();
        fs::remove_dir_all(source.path().join("foreground")).unwrap();
        clip(&open(source.path(), &Open::default()).unwrap().clip, folder.path(), None).unwrap();
        assert!(open(folder.path(), &Open::default()).unwrap().clip.truth().is_none());
        assert!((0..4).all(|t| is_there(&format!("frame_{t:04}.png"))));
        for other in others {
            assert_eq!(fs::read_to_string(folder.path().join(other)).unwrap(), other);
        }
    }

    /// Every file below `folder`, with its bytes.
    fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files = entries.flat_map(|path| match path.is_dir() {
            true => contents(&path),
            false => BTreeMap::from([(path.clone(), fs::read(&path).unwrap())]),
        });
        files.collect()
    }

    #[test]
    fn what_others_wrote_is_refused_and_kept() {
        for name in ["gt.txt", "frame_0001.png", "flow/frame_0002.flo", "occ/frame_0003.png"] {
            // Made by hand in a new folder, and changed by hand in an earlier clip's.
            for earlier in [false, true] {
                let folder = tempfile::tempdir().unwrap();
                if earlier {
                    clip(&made(4), folder.path(), None).unwrap();
                }
                fs::create_dir_all(folder.path().join(name).parent().unwrap()).unwrap();
                fs::write(folder.path().join(name), "by hand").unwrap();
                let before = contents(folder.path());
                let message = clip(&made(4), folder.path(), None).unwrap_err().to_string();
                assert!(message.contains(name) && message.contains("empty folder"), "{message}");
                assert_eq!(contents(folder.path()), before);
            }
        }
    }

    #[test]
    fn a_clip_that_is_not_finished_leaves_the_earlier_one() {
        struct Late(AtomicUsize);
        impl Progress for Late {
            fn report(&self, _fraction: f32) {
                self.0.fetch_add(1, Ordering::Relaxed);
            }
            fn cancelled(&self) -> bool {
                self.0.load(Ordering::Relaxed) == 3
            }
        }
        let folder = tempfile::tempdir().unwrap();
        clip(&made(4), folder.path(), None).unwrap();
        let before = contents(folder.path());
        let mut other = synth::SCENES[0].difficulty();
        (other.frames, other.width, other.height) = (4, 96, 64);
        let other = synth::SCENES[0].clip(&other).unwrap();
        let message = clip(&other, folder.path(), Some(&Late(AtomicUsize::new(0)))).unwrap_err().to_string();
        assert!(message.contains("cancelled after 3"), "{message}");
        assert_eq!(contents(folder.path()), before);
    }

    #[test]
    fn other_pictures_are_not_mixed_in() {
        let folder = tempfile::tempdir().unwrap();
        clip(&made(4), folder.path(), None).unwrap();
        let message = clip(&made(3), folder.path(), None).unwrap_err().to_string();
        assert!(message.contains("frame_0003.png"), "{message}");
    }
}
