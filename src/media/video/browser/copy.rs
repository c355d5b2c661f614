//! The frames of a video as a Y4M file that is made in memory.

use motionscope_core::base::Error;

use super::picture::Picture;
use crate::media::check_size;
use crate::media::video::y4m;

/// The line before each frame.
const FRAME: &[u8] = b"FRAME\n";

/// A Y4M file with a place for each frame.
pub(super) struct Copy {
    first: Picture,
    bytes: Vec<u8>,
    /// Bytes of the first line.
    head: usize,
    is_filled: Vec<bool>,
}

impl Copy {
    /// A file for `frames` pictures like `first`, or for as many as fit into `most_bytes` bytes.
    ///
    /// # Errors
    /// If there is no room for one of them, or they have a size that no picture has.
    pub(super) fn new(first: &Picture, frames: usize, most_bytes: u64) -> Result<Self, Error> {
        let (width, height) = first.size;
        check_size(width, height)?;
        let range = if first.is_full_range { "FULL" } else { "LIMITED" };
        let (space, matrix) = (first.space, first.matrix);
        let head = format!("YUV4MPEG2 W{width} H{height} C{space} XCOLORRANGE={range} X{}{matrix}\n", y4m::MATRIX);
        let stride = FRAME.len() + first.samples.len();
        let most = usize::try_from(most_bytes).unwrap_or(usize::MAX).saturating_sub(head.len()) / stride;
        let frames = frames.min(most);
        let full = || Error::new("the page has no memory left for its frames; close other pages, or scale it down");
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(head.len() + frames * stride).map_err(|_| full())?;
        if frames == 0 {
            return Err(full());
        }
        bytes.extend_from_slice(head.as_bytes());
        bytes.resize(head.len() + frames * stride, 0);
        let first = Picture { samples: vec![0; first.samples.len()], ..*first };
        Ok(Self { first, bytes, head: head.len(), is_filled: vec![false; frames] })
    }

    /// Whether `picture` can be one of its frames.
    pub(super) fn takes(&self, picture: &Picture) -> bool {
        self.first.is_like(picture)
    }

    /// Puts a picture that it takes at a place; one behind the last is left out.
    pub(super) fn put(&mut self, place: usize, picture: &Picture) {
        let Some(is_filled) = self.is_filled.get_mut(place).filter(|_| self.first.is_like(picture)) else { return };
        *is_filled = true;
        let start = self.head + place * self.stride();
        self.bytes[start..][..FRAME.len()].copy_from_slice(FRAME);
        self.bytes[start + FRAME.len()..][..picture.samples.len()].copy_from_slice(&picture.samples);
    }

    /// Number of places.
    pub(super) fn places(&self) -> usize {
        self.is_filled.len()
    }

    /// Number of places with a picture.
    pub(super) fn filled(&self) -> usize {
        self.is_filled.iter().filter(|is_filled| **is_filled).count()
    }

    fn stride(&self) -> usize {
        FRAME.len() + self.first.samples.len()
    }

    /// The file, without the places that stayed empty.
    pub(super) fn into_file(mut self) -> Vec<u8> {
        let stride = self.stride();
        let mut end = self.head;
        for (place, _) in self.is_filled.iter().enumerate().filter(|(_, is_filled)| **is_filled) {
            let start = self.head + place * stride;
            self.bytes.copy_within(start..start + stride, end);
            end += stride;
        }
        self.bytes.truncate(end);
        self.bytes.shrink_to_fit();
        self.bytes
    }
}

/// The warnings about a copy of a video of `wanted` frames that was coded as `codec`; `failure` is the reason why the decoder stopped before
/// its end, if it did.
pub(super) fn notes(codec: &str, copy: &Copy, wanted: usize, failure: Option<&str>) -> Vec<String> {
    let (places, filled) = (copy.places(), copy.filled());
    let mut notes = vec![format!("{codec} video is decoded by this browser")];
    if places < wanted {
        let size = copy.bytes.len() >> 20;
        notes.push(format!(
            "only the first {places} of {wanted} frames are there, because decoded they take {size} MiB of the page's memory; cut or \
             scale down the clip to see all"
        ));
    }
    match (failure, places - filled) {
        (Some(why), _) => notes.push(format!("the browser decodes only {filled} of {places} frames ({why})")),
        (None, 0) => {}
        (None, missing) => {
            notes.push(format!("the browser shows no picture for {missing} of {places} frames, which are left out"))
        }
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(value: u8) -> Picture {
        Picture { size: (2, 1), space: "420jpeg", matrix: 2, is_full_range: false, samples: vec![value; 4] }
    }

    #[test]
    fn frames_come_in_any_order_and_gaps_close() {
        let mut copy = Copy::new(&gray(0), 4, 1000).unwrap();
        [(2, 7), (0, 5), (9, 1)].into_iter().for_each(|(place, value)| copy.put(place, &gray(value)));
        let other = Picture { size: (1, 1), samples: vec![0; 3], ..gray(0) };
        assert!(copy.takes(&gray(1)) && !copy.takes(&other));
        assert_eq!((copy.places(), copy.filled()), (4, 2));
        let notes = notes("vp8", &copy, 4, None);
        assert_eq!(notes[1], "the browser shows no picture for 2 of 4 frames, which are left out");
        let head = b"YUV4MPEG2 W2 H1 C420jpeg XCOLORRANGE=LIMITED XMATRIX=2\n".as_slice();
        assert_eq!(copy.into_file(), [head, b"FRAME\n", &[5; 4], b"FRAME\n", &[7; 4]].concat());
    }

    #[test]
    fn as_many_frames_are_kept_as_fit() {
        let copy = Copy::new(&gray(0), 900, 100).unwrap();
        assert_eq!(copy.places(), 4);
        let notes = notes("hevc", &copy, 900, Some("it is damaged"));
        assert!(
            notes[1].contains("the first 4 of 900 frames") && notes[2].contains("0 of 4 frames (it is damaged)"),
            "{notes:?}"
        );
        assert!(Copy::new(&gray(0), 900, 60).is_err());
    }
}
