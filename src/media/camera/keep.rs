//! Frames of a camera as a clip: Y4M video, the samples as they came.

use std::io::{self, BufWriter, Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use motionscope_core::base::{Error, Stop};
use web_time::{Duration, Instant};

use super::reading::{belongs, rate};
use super::{CameraFeed, Format, Shot};
use crate::files::{self, temporary};
use crate::media::names::file_name;
use crate::media::{Progress, export};

/// The line before each frame.
const FRAME: &[u8] = b"FRAME\n";
/// Room for the measured rate in the first line of a file.
const RATE_ROOM: usize = 24;
/// The shortest recording of which the rate is measured.
const MEASURED: Duration = Duration::from_millis(100);

/// A clip that was recorded and is not saved yet; dropping it removes its file.
#[derive(Debug)]
pub struct Kept {
    // Removed when it is dropped.
    _folder: temporary::Folder,
    path: PathBuf,
    frames: usize,
    rate: Option<f64>,
}

impl Kept {
    /// The file, which has the name of the clip.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Frames per second that were measured.
    pub fn rate(&self) -> Option<f64> {
        self.rate
    }
}

/// Whether the file at `path` is a recording that was not saved yet.
pub fn is_unsaved(path: &Path) -> bool {
    temporary::is_temporary(path)
}

/// Makes a clip called `name` of `shots`, in a temporary file.
///
/// # Errors
/// If there are fewer than two frames, or the file cannot be written. Nothing is left of it then.
pub fn keep(format: &Format, shots: &[Shot], name: &str) -> Result<Kept, Error> {
    if shots.len() < 2 {
        return Err(Error::new("the camera sent fewer than two frames, and motion needs two; record again"));
    }
    let place = temporary::place();
    let cannot = |error: io::Error| {
        Error::new(format!("the recording cannot be kept in {} ({error}); make room there", place.display()))
    };
    let _at_work = temporary::at_work();
    // In a page it may be the first file of all.
    let folder = files::create_dir_all(&place).and_then(|()| temporary::folder(&place)).map_err(cannot)?;
    let (path, rate) = (folder.path().join(format!("{name}.y4m")), rate(shots));
    let frames = shots.iter().flat_map(|shot| [FRAME, shot.samples()]);
    let mut video = Cursor::new(format.head(rate)).chain(Pieces { pieces: frames, piece: &[] });
    files::write_from(&path, &mut video).map_err(cannot)?;
    Ok(Kept { _folder: folder, path, frames: shots.len(), rate })
}

/// Pieces of bytes, read one behind the other.
struct Pieces<'a, I> {
    pieces: I,
    piece: &'a [u8],
}

impl<'a, I: Iterator<Item = &'a [u8]>> Read for Pieces<'a, I> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.piece.is_empty() {
            let Some(piece) = self.pieces.next() else { return Ok(0) };
            self.piece = piece;
        }
        self.piece.read(buffer)
    }
}

/// The first line of a file of frames, filled with spaces to `width` bytes with its end.
fn padded(head: &str, width: usize) -> String {
    format!("{:<1$}\n", head.trim_end(), width.saturating_sub(1))
}

/// Writes the measured rate into the first line of `file`, which has `width` bytes.
fn put_rate(file: &mut (impl Write + Seek), format: &Format, (times, width): (&[Duration], usize)) -> io::Result<()> {
    let time = length(times);
    let rate = (times.len() > 2 && time >= MEASURED).then(|| (times.len() - 1) as f64 / time.as_secs_f64());
    let line = padded(&format.head(rate), width);
    if line.len() != width {
        return Ok(());
    }
    file.seek(SeekFrom::Start(0))?;
    file.write_all(line.as_bytes())
}

/// The time from the first frame to the last.
fn length(times: &[Duration]) -> Duration {
    times.first().zip(times.last()).map_or(Duration::ZERO, |(first, last)| last.saturating_sub(*first))
}

fn put(file: &mut impl Write, samples: &[u8]) -> io::Result<()> {
    file.write_all(FRAME)?;
    file.write_all(samples)
}

/// The outcome of [`record`].
#[derive(Debug)]
pub struct Recorded {
    /// Number of frames.
    pub frames: usize,
    /// Width and height in px.
    pub size: (usize, usize),
    /// The time from the first frame to the last.
    pub time: Duration,
    /// Why the camera ended before its time, if it did.
    pub ended: Option<Error>,
}

/// Records `feed` for `time` into the file `out`, which is there only once it is whole. If the camera ends before, the frames so far
/// are kept.
///
/// # Errors
/// If the camera sends fewer than two frames, the file cannot be written, or the work was cancelled.
pub async fn record(
    mut feed: Box<dyn CameraFeed>,
    time: Duration,
    out: &Path,
    progress: Option<&dyn Progress>,
) -> Result<Recorded, Error> {
    let stop = Stop::default();
    let cannot = |error: io::Error| export::cannot_write(out, &error);
    // A link keeps pointing where it points.
    let target = files::canonicalize(out).unwrap_or_else(|_| out.to_owned());
    // Before the camera is switched on.
    let draft = files::draft(&target).map_err(cannot)?;
    let format = feed.begin(&stop).await?;
    let (mut file, mut times) = (BufWriter::new(draft), Vec::<Duration>::new());
    let head = format.head(None);
    let width = head.len() + RATE_ROOM;
    file.write_all(padded(&head, width).as_bytes()).map_err(cannot)?;
    let begun = Instant::now();
    let ended = loop {
        if progress.is_some_and(Progress::cancelled) {
            return Err(Error::new("recording was cancelled"));
        }
        let samples = match feed.next(&stop).await {
            Ok(Some(samples)) => samples,
            Ok(None) => break Some(Error::new("the camera sends no more frames")),
            Err(error) => break Some(error),
        };
        let at = begun.elapsed();
        let gone = times.first().map_or(Duration::ZERO, |first| at.saturating_sub(*first));
        if !belongs(times.len(), gone, time) {
            break None;
        }
        times.push(at);
        put(&mut file, &samples).map_err(cannot)?;
        progress.into_iter().for_each(|progress| progress.report(gone.as_secs_f32() / time.as_secs_f32()));
    };
    if times.len() < 2 {
        let why = ended.unwrap_or_else(|| Error::new("the camera sent fewer than two frames; record longer"));
        return Err(Error::new(format!("{} was not recorded: {why}", file_name(out))));
    }
    let mut draft = file.into_inner().map_err(|error| cannot(error.into_error()))?;
    put_rate(draft.as_file_mut(), &format, (times.as_slice(), width)).map_err(cannot)?;
    let _at_work = temporary::at_work();
    draft.persist(&target).map_err(|error| cannot(error.error))?;
    Ok(Recorded { frames: times.len(), size: format.size(), time: length(&times), ended })
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::future::ready;

    use super::super::{Camera, Size, TestPicture};
    use super::*;
    use crate::media::{Open, open};
    use crate::work::{Boxed, finish};

    fn recorded(
        feed: Box<dyn CameraFeed>,
        time: Duration,
        out: &Path,
        progress: Option<&dyn Progress>,
    ) -> Result<Recorded, Error> {
        finish(record(feed, time, out, progress))
    }

    #[test]
    fn what_is_kept_is_a_clip_until_it_is_dropped() {
        let feed = Box::new(TestPicture::new(Size::new(64, 48)));
        let camera = Camera::start(feed, || {}).unwrap();
        finish(camera.wait_for(4, Duration::from_secs(10))).expect("frames");
        let (format, shots) = (camera.format().unwrap(), camera.last(Duration::from_secs(5)));
        assert!(keep(&format, &shots[..1], "camera").is_err());
        let kept = keep(&format, &shots, "camera-1").unwrap();
        assert!(is_unsaved(kept.path()) && !is_unsaved(Path::new("/home/ada/camera-1.y4m")));
        let clip = open(kept.path(), &Open::default()).unwrap().clip;
        assert_eq!(
            (clip.info().name.as_str(), clip.info().frames, clip.size()),
            ("camera-1.y4m", Some(shots.len()), (64, 48))
        );
        assert_eq!(*clip.frame(2).unwrap(), shots[2].frame(&format).unwrap(), "the frame as it was seen");
        let path = kept.path().to_owned();
        drop(kept);
        assert!(!path.exists() && path.parent().is_some_and(|folder| !folder.exists()));
    }

    /// Frames as fast as they are asked for, and then an error.
    struct Some3(usize);

    impl CameraFeed for Some3 {
        fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
            Box::pin(ready(Format::parse(b"YUV4MPEG2 W2 H1 F30:1 Cmono")))
        }

        fn next<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
            let left = self.0.checked_sub(1).ok_or_else(|| Error::new("it was unplugged"));
            self.0 = self.0.saturating_sub(1);
            Box::pin(ready(left.map(|_| Some(vec![7; 2]))))
        }
    }

    /// A camera with a frame after each pause, which claims another rate.
    struct Paced {
        fps: u32,
        pause: Duration,
    }

    impl CameraFeed for Paced {
        fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
            Box::pin(ready(Format::parse(format!("YUV4MPEG2 W2 H1 F{}:1 Cmono", self.fps).as_bytes())))
        }

        fn next<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
            std::thread::sleep(self.pause);
            Box::pin(ready(Ok(Some(vec![7; 2]))))
        }
    }

    #[test]
    fn the_measured_rate_is_in_the_recording() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a.y4m");
        let done = recorded(
            Box::new(Paced { fps: 240, pause: Duration::from_millis(20) }),
            Duration::from_millis(200),
            &out,
            None,
        )
        .unwrap();
        let clip = open(&out, &Open::default()).unwrap().clip;
        let measured = (done.frames - 1) as f64 / done.time.as_secs_f64();
        assert!(clip.info().fps.is_some_and(|fps| (fps - measured).abs() < 0.1), "{:?}, {measured}", clip.info().fps);
        assert_eq!((clip.info().frames, clip.frame(1).unwrap().luma().cells()), (Some(done.frames), &[7, 7][..]));
    }

    #[test]
    fn a_recording_ends_with_the_frame_before_its_time_is_over() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a.y4m");
        let done = recorded(
            Box::new(Paced { fps: 30, pause: Duration::from_millis(60) }),
            Duration::from_millis(300),
            &out,
            None,
        )
        .unwrap();
        // A loaded computer may sleep longer, never shorter.
        assert!((2..=5).contains(&done.frames), "{done:?}");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_keeps_pointing_where_it_points() {
        let folder = tempfile::tempdir().unwrap();
        let [target, link] = ["target.y4m", "link.y4m"].map(|name| folder.path().join(name));
        fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        recorded(Box::new(Some3(3)), Duration::from_secs(9), &link, None).unwrap();
        assert!(link.is_symlink() && fs::read(&target).unwrap().starts_with(b"YUV4MPEG2"));
    }

    #[test]
    fn a_camera_that_ends_leaves_what_came() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a.y4m");
        let done = recorded(Box::new(Some3(3)), Duration::from_secs(9), &out, None).unwrap();
        assert_eq!((done.frames, done.ended), (3, Some(Error::new("it was unplugged"))));
        assert_eq!(open(&out, &Open::default()).unwrap().clip.info().frames, Some(3));
        let none = recorded(Box::new(Some3(1)), Duration::from_secs(9), &folder.path().join("b.y4m"), None);
        assert!(none.unwrap_err().to_string().contains("b.y4m was not recorded: it was unplugged"));
        let nowhere = folder.path().join("no/c.y4m");
        assert!(recorded(Box::new(Some3(3)), Duration::from_secs(9), &nowhere, None).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left");
    }
}
