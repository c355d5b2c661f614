//! A feed of Y4M video that comes through a pipe.

use std::io::{BufRead, BufReader, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;

use motionscope_core::base::{Error, Stop};
use web_time::{Duration, Instant};

use super::Format;
use crate::media::video::y4m::MAX_LINE_BYTES;

/// How often a waiting thread asks whether it should stop.
const POLL: Duration = Duration::from_millis(10);
/// Time that a camera may take until its first frame.
const FIRST: Duration = Duration::from_secs(12);
/// Time after which a camera that sends no frame has stopped.
const STALLED: Duration = Duration::from_secs(3);
/// Frames that wait between the pipe and their reader.
const WAITING: usize = 4;

/// A part of the video in the pipe.
enum Item {
    Format(Format),
    Frame(Vec<u8>),
}

/// Y4M video from a pipe, read on a thread of its own, so that waiting for a frame has an end.
pub struct Stream {
    items: Receiver<Result<Item, Error>>,
    stalled: Duration,
}

impl Stream {
    /// The video in `pipe`.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(pipe: impl Read + Send + 'static) -> Result<Self, Error> {
        let (sender, items) = sync_channel(WAITING);
        let read = move || {
            let mut pipe = BufReader::with_capacity(1 << 20, pipe);
            let mut format = None;
            while let Some(item) = read_item(&mut pipe, &mut format).transpose() {
                let is_last = item.is_err();
                if sender.send(item).is_err() || is_last {
                    break;
                }
            }
        };
        let thread = thread::Builder::new().name("camera pipe".into()).spawn(read);
        thread.map_err(|error| Error::new(format!("no thread could be started to read the camera ({error})")))?;
        Ok(Self { items, stalled: STALLED })
    }

    /// The same with another time after which silence is taken for the end.
    #[must_use]
    pub fn with_patience(self, stalled: Duration) -> Self {
        Self { stalled, ..self }
    }

    /// Receives the next part; `None` at the end of the pipe.
    fn receive(&self, stop: &Stop, patience: Duration) -> Result<Option<Item>, Error> {
        let begun = Instant::now();
        loop {
            stop.check()?;
            match self.items.recv_timeout(POLL) {
                Ok(item) => return item.map(Some),
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
                Err(RecvTimeoutError::Timeout) if begun.elapsed() > patience => {
                    let seconds = patience.as_secs_f32();
                    return Err(Error::new(format!(
                        "no frame came for {seconds:.0} s; plug the camera in again, or choose another one"
                    )));
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }
}

impl Stream {
    /// As [`super::CameraFeed::begin`], on this thread.
    pub(super) fn format(&self, stop: &Stop) -> Result<Format, Error> {
        match self.receive(stop, FIRST.max(self.stalled))? {
            Some(Item::Format(format)) => Ok(format),
            _ => Err(Error::new("no frame came; plug the camera in again, or choose another one")),
        }
    }

    /// As [`super::CameraFeed::next`], on this thread.
    pub(super) fn frame(&self, stop: &Stop) -> Result<Option<Vec<u8>>, Error> {
        match self.receive(stop, self.stalled)? {
            Some(Item::Frame(samples)) => Ok(Some(samples)),
            _ => Ok(None),
        }
    }
}

/// The format, or after it a frame; `None` at the end. A frame that is cut off is none.
fn read_item(pipe: &mut impl BufRead, format: &mut Option<Format>) -> Result<Option<Item>, Error> {
    let Some(line) = read_line(pipe)? else { return Ok(None) };
    let Some(known) = format else {
        return Ok(Some(Item::Format(format.insert(Format::parse(&line)?).clone())));
    };
    if !line.starts_with(b"FRAME") {
        return Err(Error::new("ffmpeg sent a damaged frame; open the camera again"));
    }
    let mut samples = vec![0; known.frame_bytes()];
    Ok(pipe.read_exact(&mut samples).ok().map(|()| Item::Frame(samples)))
}

/// A line without its end; `None` at the end of the pipe.
fn read_line(pipe: &mut impl BufRead) -> Result<Option<Vec<u8>>, Error> {
    let mut line = Vec::new();
    let read = pipe.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut line);
    match (read, line.pop()) {
        (Ok(_), Some(b'\n')) => Ok(Some(line)),
        (Ok(_), None) | (Err(_), _) => Ok(None),
        (Ok(_), Some(_)) => Err(Error::new("ffmpeg sent no Y4M video; install a current ffmpeg")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(bytes: &'static [u8]) -> Stream {
        Stream::new(bytes).unwrap()
    }

    #[test]
    fn frames_come_until_the_pipe_ends() {
        let stream = stream(b"YUV4MPEG2 W2 H1 Cmono\nFRAME\nabFRAME Ip\ncdFRAME\ne");
        let stop = Stop::default();
        assert_eq!(stream.format(&stop).unwrap().size(), (2, 1));
        assert_eq!(stream.frame(&stop), Ok(Some(b"ab".to_vec())));
        assert_eq!(stream.frame(&stop), Ok(Some(b"cd".to_vec())));
        assert_eq!(stream.frame(&stop), Ok(None), "half a frame is none");
    }

    #[test]
    fn what_is_no_video_is_told() {
        for bytes in [&b""[..], b"YUV4MPEG2 W2", b"<html>\n", b"YUV4MPEG2 W0 H0\n"] {
            assert!(stream(bytes).format(&Stop::default()).is_err(), "{}", String::from_utf8_lossy(bytes));
        }
        let stream = stream(b"YUV4MPEG2 W2 H1 Cmono\nFRAMES?\nnoise");
        stream.format(&Stop::default()).unwrap();
        assert_eq!(stream.frame(&Stop::default()), Ok(Some(b"no".to_vec())), "parameters may follow the word");
        assert!(stream.frame(&Stop::default()).is_err(), "ise is no frame");
    }

    /// A pipe into which nothing is written.
    struct Silent;

    impl Read for Silent {
        fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
            thread::sleep(Duration::from_secs(600));
            Ok(0)
        }
    }

    #[test]
    fn silence_has_an_end() {
        let head: &[u8] = b"YUV4MPEG2 W2 H1 Cmono\nFRAME\nab";
        let stream = Stream::new(head.chain(Silent)).unwrap().with_patience(Duration::from_millis(50));
        let stop = Stop::default();
        stream.format(&stop).unwrap();
        assert!(stream.frame(&stop).is_ok_and(|frame| frame.is_some()));
        assert!(stream.frame(&stop).unwrap_err().to_string().contains("plug the camera in again"));
        stop.set(true);
        assert!(stream.frame(&stop).unwrap_err().to_string().contains("cancelled"));
    }
}
