//! The result of a format's reader: facts about the clip, and a decoder of its frames.

use std::path::PathBuf;
use std::sync::Arc;

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{ClipInfo, Frame};

use super::picture::Contrast;

/// The decoder of one format. It caches nothing: the frame cache does.
pub(crate) trait Decoder: Send {
    /// Decodes frame `index` and gives `keep` every frame that is met on the way, by number; the wanted one comes last.
    ///
    /// Going on from the frame decoded last must be cheap where the format allows. After an error or a panic the next
    /// call starts afresh. A decoder that passes several frames on the way checks `stop` before each, and reports its
    /// progress there.
    ///
    /// # Errors
    /// One sentence, without the file's name, if there is no such frame, it is damaged, or `stop` is set.
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error>;
}

/// The result of a format's reader.
pub(crate) struct Source {
    /// Facts about the clip; the size has been checked with [`check_size`](super::check_size).
    pub info: ClipInfo,
    /// Delivers the frames.
    pub decoder: Box<dyn Decoder>,
    /// The file of each frame, where each has one of its own.
    pub files: Arc<[PathBuf]>,
    /// The range of samples that is shown, of pictures with 16 bits.
    pub contrast: Option<Contrast>,
}

impl Source {
    /// A source whose frames all lie in one file.
    pub(crate) fn new(info: ClipInfo, decoder: impl Decoder + 'static) -> Self {
        Self { info, decoder: Box::new(decoder), files: Arc::default(), contrast: None }
    }
}
