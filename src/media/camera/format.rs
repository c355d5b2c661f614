//! The format of the frames of a feed.

use motionscope_core::base::Error;
use motionscope_core::data::Frame;

use crate::media::check_size;
use crate::media::video::y4m::Header;

/// The format of all frames of a feed: the first line of Y4M video.
#[derive(Clone, Debug)]
pub struct Format {
    line: String,
    header: Header,
}

impl Format {
    /// The format in the first line of Y4M video, without its end.
    ///
    /// # Errors
    /// If it is none, or claims a size that no picture has.
    pub fn parse(line: &[u8]) -> Result<Self, Error> {
        if !line.starts_with(b"YUV4MPEG2 ") {
            return Err(Error::new("ffmpeg sent no Y4M video; install a current ffmpeg"));
        }
        let header = Header::parse(line)?;
        check_size(header.width, header.height)?;
        Ok(Self { line: String::from_utf8_lossy(line).into_owned(), header })
    }

    /// Width and height in px.
    pub fn size(&self) -> (usize, usize) {
        (self.header.width, self.header.height)
    }

    /// Bytes of the samples of a frame.
    pub fn frame_bytes(&self) -> usize {
        usize::try_from(self.header.frame_bytes()).unwrap_or(usize::MAX)
    }

    /// The frame with these samples.
    ///
    /// # Errors
    /// If they are too few.
    pub fn frame(&self, samples: Vec<u8>) -> Result<Frame, Error> {
        self.header.frame(samples)
    }

    /// The first line of a file of such frames, with its end, at the rate that was measured, in frames per second.
    pub(super) fn head(&self, measured: Option<f64>) -> String {
        /// Share by which a camera may miss its rate before that is written.
        const TOLERANCE: f64 = 0.05;
        let is_off = |rate: &f64| self.header.fps.is_none_or(|told| (rate / told - 1.0).abs() > TOLERANCE);
        let Some(rate) = measured.filter(|rate| rate.is_finite() && *rate >= 0.001).filter(is_off) else {
            return format!("{}\n", self.line);
        };
        let kept: Vec<_> = self.line.split_ascii_whitespace().filter(|token| !token.starts_with('F')).collect();
        format!("{} F{}:1000\n", kept.join(" "), (rate * 1000.0).round())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_measured_rate_is_written_where_it_is_another() {
        let format = Format::parse(b"YUV4MPEG2 W4 H2 F30:1 Ip C420jpeg").unwrap();
        assert_eq!((format.size(), format.frame_bytes()), ((4, 2), 12));
        assert_eq!(format.head(Some(29.5)), "YUV4MPEG2 W4 H2 F30:1 Ip C420jpeg\n");
        assert_eq!(format.head(Some(15.0)), "YUV4MPEG2 W4 H2 Ip C420jpeg F15000:1000\n");
        assert_eq!(format.head(None), "YUV4MPEG2 W4 H2 F30:1 Ip C420jpeg\n");
    }

    #[test]
    fn what_is_no_video_is_refused() {
        for line in ["", "<html>", "YUV4MPEG2 W0 H2", "YUV4MPEG2 W99999 H99999", "YUV4MPEG2 W4 H4 C999"] {
            assert!(Format::parse(line.as_bytes()).is_err(), "{line}");
        }
        let format = Format::parse(b"YUV4MPEG2 W4 H2 Cmono").unwrap();
        assert!(format.frame(vec![0; 7]).is_err() && format.frame(vec![9; 8]).is_ok());
    }
}
