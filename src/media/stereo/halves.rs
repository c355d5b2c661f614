//! Frames that show both views beside each other.

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{ClipInfo, Frame};
use motionscope_core::geometry::Grid;

use crate::media::{Decoder, Source};

/// One of the halves of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    /// The left view.
    Left,
    /// The right view.
    Right,
}

/// The source of one half of each frame.
///
/// # Errors
/// If the frames cannot be halved.
pub(crate) fn half(source: Source, half: Half) -> Result<Source, Error> {
    let width = source.info.width;
    if !width.is_multiple_of(2) {
        return Err(Error::new(format!(
            "its frames are {width} px wide; two views beside each other need an even width"
        )));
    }
    let info = ClipInfo { width: width / 2, ..source.info };
    Ok(Source { info, decoder: Box::new(Halves { whole: source.decoder, half }), ..source })
}

/// Decodes whole frames and cuts them.
struct Halves {
    whole: Box<dyn Decoder>,
    half: Half,
}

impl Decoder for Halves {
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        let half = self.half;
        self.whole.decode(index, stop, &mut |number, frame| keep(number, cut(&frame, half)))
    }
}

fn cut(frame: &Frame, half: Half) -> Frame {
    match frame.color() {
        Some(color) => Frame::rgb(cut_grid(color, half)),
        None => Frame::gray(cut_grid(frame.luma(), half)),
    }
}

fn cut_grid<T: Copy>(whole: &Grid<T>, half: Half) -> Grid<T> {
    let width = whole.width() / 2;
    let from = if half == Half::Left { 0 } else { width };
    Grid::from_fn(width, whole.height(), |x, y| whole[(from + x, y)])
}
