//! Everything else, through the user's own ffmpeg as a child process.
//!
//! ffprobe tells what the file is, ffmpeg pipes its frames as portable pixmaps. Neither sees a shell or the network.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::ChildStdout;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{ClipInfo, Frame};
use motionscope_core::geometry::Grid;
use serde::Deserialize;
use web_time::{Duration, Instant};

use super::FfmpegReason;
use crate::files::{self, IN_PAGE};
use crate::media::helper::{self, Failure, Limits, Running, program};
use crate::media::names::file_name;
use crate::media::{Decoder, Open, Source, check_size};

/// Frames that are decoded before the one sought, so that stepping back is at hand.
const RUN_UP_FRAMES: usize = 24;
/// Frames that are rather decoded than skipped.
const MOST_FRAMES_AHEAD: usize = 250;
/// Frames before the first one wanted at which ffmpeg is set: those next to a key frame may need what lies before it.
const MARGIN_FRAMES: usize = 32;
/// How often a waiting thread asks whether it should stop.
const POLL: Duration = Duration::from_millis(10);
/// The limits of ffprobe where it reads the header of a file.
const HEADER: Limits = Limits { time: Duration::from_secs(60), bytes: 4 << 20 };
/// Its limits where it lists the packets of the whole file, which may come over a slow network.
const PACKETS: Limits = Limits { time: Duration::from_secs(30 * 60), bytes: 256 << 20 };
/// Its limits where it decodes the whole file to count its frames.
const COUNTING: Limits = Limits { time: Duration::from_secs(6 * 60 * 60), bytes: 4 << 20 };
/// The longest that ffmpeg may take for a frame, with those that it decodes and throws away before it.
const FRAME: Duration = Duration::from_secs(120);
/// Formats of text in colours, of which ffmpeg makes the screen of an old terminal.
const SCREENS: [&str; 5] = ["tty", "bin", "xbin", "adf", "idf"];
/// Containers without an index, where packets are no frames.
const STREAMS: [&str; 4] = ["mpegts", "mpeg", "mpegvideo", "h264"];

/// Opens the video at `path` by ffmpeg; `why` tells what keeps us from doing it ourselves.
///
/// # Errors
/// One sentence, without the file's name, with `why` in it.
pub(super) fn open(path: &Path, options: &Open, why: &FfmpegReason) -> Result<Source, Error> {
    // A pipe has been read to its end already.
    if path == Path::new("-") || !files::is_file(path) {
        return Err(Error::new(format!("{}; save what the pipe holds to a file and open that", why.error)));
    }
    if !options.ffmpeg || files::is_in_memory(path) {
        return Err(Failed::Absent.explained(why));
    }
    let probe = Probe::run(path, options, why)?;
    let times = probe.times(path, options)?;
    let mut warnings = vec![format!("{} video is decoded by the ffmpeg of this computer", probe.stream.codec_name)];
    warnings.extend(probe.stream.shape());
    let frames = match (&times, probe.stream.nb_frames.as_deref().and_then(|n| n.parse().ok())) {
        (Some(times), _) => Some(times.len()),
        (None, Some(explained)) => Some(explained),
        (None, None) if options.count => Some(probe.count(path, options)?),
        (None, None) => None,
    };
    let mut decoder = Ffmpeg {
        path: path.to_owned(),
        old: probe.old(),
        // Without distinct times only the beginning can be found again.
        times: times.filter(|times| times.windows(2).all(|pair| pair[0] < pair[1])),
        running: None,
        next: 0,
        first: None,
        patience: FRAME,
    };
    decoder.start(0)?;
    let first = decoder.read(&|| options.report(0.0));
    options.report(0.0)?;
    let first = first.ok().flatten().ok_or_else(|| Failed::Refused.explained(why))?;
    if probe.varies() {
        warnings.push("the frame rate varies; one frame is taken as one step of time".into());
    }
    let (width, height) = first.size();
    decoder.first = Some(first);
    let info = ClipInfo {
        name: file_name(path),
        width,
        height,
        frames,
        fps: probe.stream.rate(),
        container: probe.format.container(path),
        codec: probe.stream.codec_name,
        warnings,
    };
    Ok(Source::new(info, decoder))
}

#[derive(Deserialize)]
struct Answer {
    #[serde(default)]
    streams: Vec<Stream>,
    #[serde(default)]
    packets: Vec<Packet>,
    format: Option<Format>,
    program_version: Option<Version>,
}

#[derive(Deserialize)]
struct Stream {
    #[serde(default)]
    codec_name: String,
    avg_frame_rate: Option<String>,
    r_frame_rate: Option<String>,
    nb_frames: Option<String>,
    nb_read_frames: Option<String>,
    sample_aspect_ratio: Option<String>,
    field_order: Option<String>,
}

impl Stream {
    /// The warnings about fields and about pixels that are not square.
    fn shape(&self) -> Vec<String> {
        let is_interlaced = self.field_order.as_deref().is_some_and(|order| ["tt", "bb", "tb", "bt"].contains(&order));
        let pixel = self.sample_aspect_ratio.as_deref().and_then(|ratio| {
            let (width, height) = ratio.split_once(':')?;
            Some([width.parse().ok()?, height.parse().ok()?])
        });
        is_interlaced.then(super::interlaced).into_iter().chain(pixel.and_then(super::pixel_aspect)).collect()
    }

    fn rate(&self) -> Option<f64> {
        self.avg_frame_rate.as_deref().and_then(ratio).or_else(|| self.r_frame_rate.as_deref().and_then(ratio))
    }
}

#[derive(Deserialize)]
struct Packet {
    pts_time: Option<String>,
    #[serde(default)]
    flags: String,
}

#[derive(Deserialize)]
struct Format {
    #[serde(default)]
    format_name: String,
}

impl Format {
    /// The one name, of several that ffprobe has for the format, that the file has too; else the first.
    fn container(&self, path: &Path) -> String {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        let names = || self.format_name.split(',');
        names().find(|name| name.eq_ignore_ascii_case(extension)).or(names().next()).unwrap_or_default().to_owned()
    }
}

#[derive(Deserialize)]
struct Version {
    version: String,
}

/// `30000/1001` as a number; `None` if it is unknown (`0/0`).
fn ratio(text: &str) -> Option<f64> {
    let (n, d) = text.split_once('/')?;
    let rate = n.parse::<f64>().ok()? / d.parse::<f64>().ok()?;
    (rate.is_finite() && rate > 0.0).then_some(rate)
}

/// What ffprobe tells of a file.
struct Probe {
    stream: Stream,
    format: Format,
    version: String,
}

impl Probe {
    fn run(path: &Path, options: &Open, why: &FfmpegReason) -> Result<Self, Error> {
        let entries = "stream=codec_name,avg_frame_rate,r_frame_rate,nb_frames,sample_aspect_ratio,field_order:format=format_name";
        let what = ["-show_program_version", "-show_entries", entries];
        let answer = ask(path, &what, HEADER, options).map_err(|failed| failed.explained(why))?;
        let version = answer.program_version.map(|version| version.version).unwrap_or_default();
        match (answer.streams.into_iter().next(), answer.format) {
            (_, Some(format)) if SCREENS.contains(&format.format_name.as_str()) => Err(Failed::Refused.explained(why)),
            (Some(stream), Some(format)) => Ok(Self { stream, format, version }),
            (None, Some(_)) if !why.is_known => Err(Error::new("it holds no video; open a clip with pictures")),
            _ => Err(Failed::Refused.explained(why)),
        }
    }

    /// When each frame is shown, in seconds, by the container alone; `None` where it does not tell.
    fn times(&self, path: &Path, options: &Open) -> Result<Option<Vec<f64>>, Error> {
        if self.format.format_name.split(',').any(|name| STREAMS.contains(&name)) {
            return Ok(None);
        }
        let answer = match ask(path, &["-show_entries", "packet=pts_time,flags"], PACKETS, options) {
            Ok(answer) => answer,
            Err(Failed::Stopped(error)) => return Err(error),
            Err(_) => return Ok(None),
        };
        // Packets flagged D are decoded but not shown.
        let shown = answer.packets.iter().filter(|packet| !packet.flags.contains('D'));
        let times: Option<Vec<f64>> = shown.map(|packet| packet.pts_time.as_deref()?.parse().ok()).collect();
        Ok(times.filter(|times| !times.is_empty()).map(|mut times| {
            times.sort_by(f64::total_cmp);
            times
        }))
    }

    /// The number of frames, by decoding them all.
    fn count(&self, path: &Path, options: &Open) -> Result<usize, Error> {
        let answer = ask(path, &["-count_frames", "-show_entries", "stream=nb_read_frames"], COUNTING, options);
        let read = answer.ok().and_then(|answer| answer.streams.into_iter().next()?.nb_read_frames?.parse().ok());
        options.report(1.0)?;
        read.ok_or_else(|| Error::new("its frames cannot be counted; open it without counting"))
    }

    fn varies(&self) -> bool {
        let rates =
            [&self.stream.avg_frame_rate, &self.stream.r_frame_rate].map(|rate| rate.as_deref().and_then(ratio));
        matches!(rates, [Some(mean), Some(finest)] if finest > 1.1 * mean)
    }

    /// As [`is_old`].
    fn old(&self) -> bool {
        is_old(&self.version)
    }
}

/// Whether an ffmpeg of this version knows only the old name of `-fps_mode`, which came with 5.1.
pub(in crate::media) fn is_old(version: &str) -> bool {
    let mut numbers = version.split(|c: char| !c.is_ascii_digit()).map(str::parse::<u32>);
    match (numbers.next(), numbers.next()) {
        (Some(Ok(major)), Some(Ok(minor))) => (major, minor) < (5, 1),
        // Versions built from its repository begin with a letter.
        _ => false,
    }
}

enum Failed {
    /// There is no ffprobe.
    Absent,
    /// It found nothing to tell.
    Refused,
    /// It was told to stop.
    Stopped(Error),
    /// It took too long, or printed too much, and was ended.
    Ended(&'static str),
}

impl Failed {
    /// In words, where `why` tells what keeps us from opening the file ourselves.
    fn explained(self, FfmpegReason { error, is_known }: &FfmpegReason) -> Error {
        Error::new(match self {
            // Where it says what to do, another program would not do better.
            Failed::Absent if *is_known && error.to_string().contains("; ") => return error.clone(),
            Failed::Absent if IN_PAGE => {
                format!("{error}; convert the clip to MP4 with H.264, or open it in the desktop edition")
            }
            Failed::Absent => format!(
                "{error}; if you install ffmpeg (ffmpeg.org), it is used by itself, or convert the clip to MP4 with H.264"
            ),
            // Whoever knows the format tells best what is wrong.
            Failed::Refused if *is_known && !error.to_string().contains("ffmpeg") => return error.clone(),
            Failed::Refused => {
                format!("{error}, and the ffmpeg of this computer cannot read it; convert it, or copy it again")
            }
            Failed::Ended(why) => {
                format!("{error}, and the ffprobe of this computer {why}; convert it, or copy it again")
            }
            Failed::Stopped(error) => return error,
        })
    }
}

/// What ffprobe answers about the first video stream of the file at `path`.
fn ask(path: &Path, what: &[&str], limits: Limits, options: &Open) -> Result<Answer, Failed> {
    let mut command = program("ffprobe");
    command.args(["-v", "error", "-protocol_whitelist", "file,pipe", "-select_streams", "V:0", "-of", "json"]);
    command.args(what).arg(url(path));
    let printed = helper::output(command, limits, &|| options.report(0.0)).map_err(|failure| match failure {
        Failure::Unstarted(_) => Failed::Absent,
        Failure::Stopped(error) => Failed::Stopped(error),
        Failure::Late => Failed::Ended("does not answer"),
        Failure::Flooded => Failed::Ended("answers without end"),
    })?;
    serde_json::from_slice(&printed.output).map_err(|_| Failed::Refused)
}

/// A local file, whatever its name looks like.
fn url(path: &Path) -> OsString {
    let mut url = OsString::from("file:");
    url.push(path);
    url
}

struct Ffmpeg {
    path: std::path::PathBuf,
    old: bool,
    times: Option<Vec<f64>>,
    running: Option<(Running, Receiver<Result<Frame, Error>>)>,
    next: usize,
    first: Option<Frame>,
    /// The longest that it may take for a frame.
    patience: Duration,
}

impl Ffmpeg {
    /// Starts a process whose first frame is `index`.
    fn start(&mut self, index: usize) -> Result<(), Error> {
        self.running = None;
        let mut command = program("ffmpeg");
        command.args(["-v", "quiet", "-nostdin", "-protocol_whitelist", "file,pipe"]);
        let times = self.times.as_deref().unwrap_or_default();
        if let Some(seconds) = index.checked_sub(MARGIN_FRAMES).and_then(|early| between(times, early)) {
            command.args(["-seek_timestamp", "1", "-ss", &format!("{seconds:.6}")]);
        }
        command.args(["-copyts", "-i"]).arg(url(&self.path)).args(["-map", "0:V:0"]);
        if let Some(seconds) = between(times, index) {
            command.args(["-vf", &format!("trim=start={seconds:.6}")]);
        }
        command.args(if self.old { ["-vsync", "passthrough"] } else { ["-fps_mode", "passthrough"] });
        command.args(["-sws_flags", "accurate_rnd", "-f", "image2pipe", "-c:v", "ppm", "-pix_fmt", "rgb24", "-"]);
        let mut child =
            Running(command.spawn().map_err(|error| Error::new(format!("ffmpeg does not start ({error})")))?);
        let pipe = child.0.stdout.take().ok_or_else(|| Error::new("ffmpeg does not answer"))?;
        self.running = Some((child, frames(BufReader::with_capacity(1 << 20, pipe))));
        self.next = index;
        Ok(())
    }

    /// The next frame; `None` at the end. An error of `go_on`, which is asked again and again, ends the process.
    fn read(&mut self, go_on: &dyn Fn() -> Result<(), Error>) -> Result<Option<Frame>, Error> {
        let Some((child, frames)) = self.running.take() else { return Ok(None) };
        let begun = Instant::now();
        let frame = loop {
            go_on()?;
            match frames.recv_timeout(POLL) {
                Ok(frame) => break frame?,
                Err(RecvTimeoutError::Timeout) if begun.elapsed() > self.patience => {
                    let seconds = self.patience.as_secs_f32();
                    return Err(Error::new(format!(
                        "the ffmpeg of this computer sent no frame for {seconds:.0} s; convert the clip to MP4 with H.264"
                    )));
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
            }
        };
        self.next += 1;
        self.running = Some((child, frames));
        Ok(Some(frame))
    }
}

impl Decoder for Ffmpeg {
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        if let Some(first) = self.first.take() {
            keep(0, first);
            if index == 0 {
                return Ok(());
            }
        }
        let seekable = self.times.is_some();
        if self.running.is_none() || index < self.next || (seekable && index > self.next + MOST_FRAMES_AHEAD) {
            self.start(if seekable { index.saturating_sub(RUN_UP_FRAMES) } else { 0 })?;
        }
        let from = self.next;
        while self.next <= index {
            let number = self.next;
            stop.report(number - from, index + 1 - from);
            let Some(frame) = self.read(&|| stop.check())? else { return Ok(()) };
            keep(number, frame);
        }
        Ok(())
    }
}

/// A time in seconds after the frame before `index` and before `index` itself.
fn between(times: &[f64], index: usize) -> Option<f64> {
    let before = index.checked_sub(1)?;
    Some(0.5 * (times.get(before)? + times.get(index)?))
}

/// The frames in `pipe`, read on a thread of its own, so that nobody has to wait for them. It ends with the process.
fn frames(mut pipe: BufReader<ChildStdout>) -> Receiver<Result<Frame, Error>> {
    let (sender, frames) = sync_channel(1);
    thread::spawn(move || {
        while let Some(frame) = read_pixmap(&mut pipe).transpose() {
            let is_last = frame.is_err();
            if sender.send(frame).is_err() || is_last {
                break;
            }
        }
    });
    frames
}

/// One binary portable pixmap; `None` at the end.
fn read_pixmap(pipe: &mut impl BufRead) -> Result<Option<Frame>, Error> {
    let stopped = || Error::new("ffmpeg stopped in the middle of it");
    let mut numbers = [0_usize; 3];
    let mut word = Vec::new();
    if pipe.by_ref().take(3).read_until(b'\n', &mut word).map_err(|_| stopped())? == 0 {
        return Ok(None);
    }
    for number in &mut numbers {
        word.clear();
        // Numbers end with a blank or a line's end, the way ffmpeg writes them.
        for byte in pipe.by_ref().take(12).bytes() {
            match byte.map_err(|_| stopped())? {
                b' ' | b'\n' => break,
                digit => word.push(digit),
            }
        }
        *number = std::str::from_utf8(&word).ok().and_then(|word| word.parse().ok()).ok_or_else(stopped)?;
    }
    let [width, height, _] = numbers;
    check_size(width, height)?;
    let mut cells = vec![[0_u8; 3]; width * height];
    pipe.read_exact(bytemuck::cast_slice_mut(&mut cells)).map_err(|_| stopped())?;
    Grid::from_vec(width, height, cells).map(|rgb| Some(Frame::rgb(rgb)))
}

#[cfg(test)]
mod tests {
    use std::process::Stdio;

    use super::*;

    fn probe(version: &str) -> Probe {
        let stream = serde_json::from_str("{}").unwrap();
        Probe { stream, format: Format { format_name: "avi".into() }, version: version.into() }
    }

    #[test]
    fn pixmaps_are_read_one_after_the_other() {
        let mut pipe: &[u8] = b"P6\n2 1\n255\nabcdefP6\n1 1\n255\nxyz";
        let first = read_pixmap(&mut pipe).unwrap().unwrap();
        assert_eq!(first.color().unwrap().cells(), [*b"abc", *b"def"]);
        assert_eq!(read_pixmap(&mut pipe).unwrap().unwrap().size(), (1, 1));
        assert!(read_pixmap(&mut pipe).unwrap().is_none());
        for bad in ["P6\n2 1\n255\nabc", "P6\n99999 99999\n255\n", "P6\n2 x\n255\n", "P6\n2", "P"] {
            assert!(read_pixmap(&mut bad.as_bytes()).is_err(), "{bad}");
        }
    }

    #[cfg(unix)]
    fn ffmpeg(running: Option<(Running, Receiver<Result<Frame, Error>>)>, patience: Duration) -> Ffmpeg {
        Ffmpeg { path: "clip".into(), old: false, times: None, running, next: 7, first: None, patience }
    }

    #[cfg(unix)]
    #[test]
    fn a_process_that_sends_nothing_is_ended_in_time() {
        let mut child = Running(program("sleep").arg("600").spawn().unwrap());
        let process = std::path::PathBuf::from(format!("/proc/{}", child.0.id()));
        let pipe = child.0.stdout.take().unwrap();
        let running = Some((child, frames(BufReader::new(pipe))));
        let mut silent = ffmpeg(running, Duration::from_millis(200));
        let why = silent.decode(7, &Stop::default(), &mut |_, _| {}).unwrap_err().to_string();
        assert!(why.contains("no frame") && silent.running.is_none() && !process.exists(), "{why}");
    }

    #[cfg(unix)]
    #[test]
    fn a_process_that_nobody_waits_for_is_ended() {
        let mut command = program("sleep");
        let mut child = Running(command.arg("600").stdout(Stdio::piped()).spawn().unwrap());
        let process = std::path::PathBuf::from(format!("/proc/{}", child.0.id()));
        let pipe = child.0.stdout.take().unwrap();
        let running = Some((child, frames(BufReader::new(pipe))));
        let mut silent = ffmpeg(running, FRAME);
        let stop = Stop::default();
        let asker = stop.clone();
        let asked = thread::spawn(move || {
            thread::sleep(3 * POLL);
            asker.set(true);
        });
        assert!(silent.decode(7, &stop, &mut |_, _| {}).is_err());
        assert!(asked.join().is_ok() && silent.running.is_none() && !process.exists());
    }

    #[test]
    fn the_container_has_the_name_a_person_knows() {
        let format = Format { format_name: "mov,mp4,m4a".into() };
        assert_eq!(["a.MP4", "a.m4v", "a"].map(|path| format.container(path.as_ref())), ["mp4", "mov", "mov"]);
    }

    #[test]
    fn versions_differ_in_an_option() {
        for (version, old) in [("4.4.2-0ubuntu0", true), ("5.0", true), ("5.1.9-0+deb12u1", false), ("N-1234-g", false)]
        {
            assert_eq!(probe(version).old(), old, "{version}");
        }
    }

    #[test]
    fn a_frame_is_sought_just_before_its_time() {
        let times = [0.0, 0.04, 0.1];
        assert_eq!([0, 1, 2, 3].map(|i| between(&times, i)), [None, Some(0.02), Some(0.07), None]);
        assert_eq!((ratio("30000/1001").map(f64::round), ratio("0/0"), ratio("x")), (Some(30.0), None, None));
    }
}
