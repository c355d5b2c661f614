//! GIF: any picture is at hand, however many there are.
//!
//! Each picture is drawn over those before it. The blocks tell which ones need none of those, so that decoding can begin
//! there. Where there are none of these for long, what the pictures came to is kept from time to time when they are decoded
//! for the first time, packed and within a bound; from then on any picture is a short way off.

use std::collections::BTreeMap;
use std::io::{BufReader, Chain, Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use gif::{ColorOutput, DecodeOptions, DecodingError, DisposalMethod, MemoryLimit};
use motionscope_core::base::{Error, Stop};
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;

use super::scan::{Piece, Scan};
use crate::files::File;
use crate::media::{Decoder, MAX_AREA_PX, cannot_read, picture, reason};

/// Pictures before the one sought that are kept, so that stepping back is at hand.
const RUN_UP: usize = 24;
/// Pixels that are decoded from one kept canvas to the next: less than half a second's work.
const STRIDE_PX: u64 = 48 << 20;
/// What a picture costs, however small it is, in pixels.
const LEAST_PX: u64 = 1 << 13;
/// Bound on what kept canvases take, in bytes.
const KEPT_BYTES: usize = 192 << 20;
/// A way of more pictures tells how far it is.
const FAR: usize = 50;

/// The bytes that all pictures need, and then those from some picture on.
type Input = Chain<Cursor<Vec<u8>>, BufReader<File>>;

/// Decodes from a picture at hand on.
pub(super) struct Gif {
    path: PathBuf,
    size: (usize, usize),
    head_bytes: u64,
    pieces: Vec<Piece>,
    /// Before which pictures the canvas is kept.
    stops: Vec<usize>,
    kept: Kept,
    position: Option<Position>,
}

/// Where decoding goes on.
struct Position {
    /// The picture that comes next.
    next: usize,
    /// What stands where it is drawn.
    canvas: Canvas,
    decoder: gif::Decoder<Input>,
}

impl Gif {
    /// The pictures that `scan` found in the file at `path`.
    pub(super) fn new(path: &Path, scan: Scan) -> Self {
        let stops = stops(&scan.pieces);
        let kept = Kept { canvases: BTreeMap::new(), every: 1, bytes: 0 };
        let Scan { size, head_bytes, pieces, .. } = scan;
        Self { path: path.into(), size, head_bytes, pieces, stops, kept, position: None }
    }

    /// Whether pixels of the first picture are clear.
    ///
    /// # Errors
    /// If it is damaged.
    pub(super) fn is_clear(&mut self) -> Result<bool, Error> {
        let mut first = self.start(0, Canvas::new(self.size))?;
        first.draw()?;
        Ok(first.canvas.drawn_px < first.canvas.cells.len())
    }

    /// Keeps the canvas before every `n`th picture, for tests.
    #[cfg(test)]
    pub(super) fn keep_every(&mut self, n: usize) {
        self.stops = (n..self.pieces.len()).step_by(n).collect();
    }

    /// The nearest place from which `index` can be reached.
    fn enter(&mut self, index: usize) -> Result<Position, Error> {
        let here = self.position.take().filter(|position| position.next <= index);
        let fresh = self.pieces[..=index].iter().rposition(|piece| piece.is_fresh).unwrap_or(0);
        let kept = self.kept.canvases.range(..=index).next_back().map(|(&number, canvas)| (number, canvas));
        let at_hand = kept.map_or(fresh, |(number, _)| number.max(fresh));
        match (here, kept) {
            (Some(here), _) if here.next >= at_hand => Ok(here),
            (_, Some((number, packed))) if number > fresh => {
                self.start(number, Canvas::unpack(&packed.bytes, self.size)?)
            }
            _ => self.start(fresh, Canvas::new(self.size)),
        }
    }

    /// Decoding begins at picture `number`, which is drawn on `canvas`.
    fn start(&self, number: usize, canvas: Canvas) -> Result<Position, Error> {
        let mut file = File::open(&self.path).map_err(|e| cannot_read(&e))?;
        let mut head = Vec::new();
        Read::by_ref(&mut file).take(self.head_bytes).read_to_end(&mut head).map_err(|e| cannot_read(&e))?;
        file.seek(SeekFrom::Start(self.pieces[number].start)).map_err(|e| cannot_read(&e))?;
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::Indexed);
        options.set_memory_limit(
            std::num::NonZeroU64::new(MAX_AREA_PX as u64).map_or(MemoryLimit::Unlimited, MemoryLimit::Bytes),
        );
        let input = Cursor::new(head).chain(BufReader::with_capacity(64 << 10, file));
        let decoder = options.read_info(input).map_err(|e| damaged(&e))?;
        Ok(Position { next: number, canvas, decoder })
    }

    /// Keeps the canvas of `position` where that is due.
    fn keep(&mut self, position: &Position) -> Result<(), Error> {
        match self.stops.binary_search(&position.next) {
            Ok(place) => self.kept.available((position.next, place), &position.canvas),
            Err(_) => Ok(()),
        }
    }
}

impl Decoder for Gif {
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        if index >= self.pieces.len() {
            return Ok(());
        }
        // Taken out, so that after an error the next call starts afresh.
        let mut position = self.enter(index)?;
        let from = position.next;
        while position.next <= index {
            stop.check()?;
            if index - from > FAR {
                stop.report(position.next - from, index + 1 - from);
            }
            self.keep(&position)?;
            let number = position.next;
            let restored = position.draw()?;
            if number + RUN_UP > index {
                keep(number, position.canvas.frame()?);
            }
            position.dispose(restored);
        }
        self.position = Some(position);
        Ok(())
    }
}

/// The pictures before which the canvas is kept: those that are a long way from where decoding can begin.
pub(super) fn stops(pieces: &[Piece]) -> Vec<usize> {
    let mut work_px = 0;
    let mut stops = Vec::new();
    for (number, piece) in pieces.iter().enumerate() {
        if piece.is_fresh {
            work_px = 0;
        } else if work_px > STRIDE_PX {
            work_px = 0;
            stops.push(number);
        }
        work_px += piece.area_px + LEAST_PX;
    }
    stops
}

/// What becomes of the place of a picture when the next one comes.
enum Disposal {
    Stays,
    Cleared(Place),
    /// It is as it was before.
    Restored(Place, Vec<[u8; 3]>),
}

/// The part of the canvas where a picture lies, from its first column and row up to those after its last.
#[derive(Clone, Copy)]
struct Place {
    min: [usize; 2],
    max: [usize; 2],
}

impl Position {
    /// Draws the next picture; gives what is to become of it.
    fn draw(&mut self) -> Result<Disposal, Error> {
        let info = self.decoder.next_frame_info().map_err(|e| damaged(&e))?;
        let info = info.ok_or_else(|| Error::new("it is cut short; copy it again from its source"))?;
        let [left, top, width, height] = [info.left, info.top, info.width, info.height].map(usize::from);
        let (clear, disposal) = (info.transparent, info.dispose);
        let (columns, rows) = self.canvas.size();
        let place = Place {
            min: [left.min(columns), top.min(rows)],
            max: [(left + width).min(columns), (top + height).min(rows)],
        };
        let restored = match disposal {
            DisposalMethod::Any | DisposalMethod::Keep => Disposal::Stays,
            DisposalMethod::Background => Disposal::Cleared(place),
            DisposalMethod::Previous => Disposal::Restored(place, self.canvas.copy(place)),
        };
        super::super::check_size(width.max(1), height.max(1))?;
        if width > 0 && height > 0 {
            let mut codes = vec![0; width * height];
            self.decoder.read_into_buffer(&mut codes).map_err(|e| damaged(&e))?;
            let palette = self.decoder.palette().map_err(|e| damaged(&e))?.as_chunks::<3>().0;
            self.canvas.paint(place, &codes, width, &Inks::new(palette, clear));
        }
        self.next += 1;
        Ok(restored)
    }

    fn dispose(&mut self, disposal: Disposal) {
        match disposal {
            Disposal::Stays => {}
            Disposal::Cleared(place) => self.canvas.rows(place).for_each(|row| row.fill([0; 3])),
            Disposal::Restored(place, before) => {
                let width = (place.max[0] - place.min[0]).max(1);
                self.canvas.rows(place).zip(before.chunks(width)).for_each(|(row, before)| row.copy_from_slice(before));
            }
        }
    }
}

/// The colour of each code; none for those that are clear.
struct Inks([Option<[u8; 3]>; 256]);

impl Inks {
    fn new(palette: &[[u8; 3]], clear: Option<u8>) -> Self {
        let mut inks = [None; 256];
        inks.iter_mut().zip(palette).for_each(|(ink, color)| *ink = Some(*color));
        if let Some(clear) = clear {
            inks[usize::from(clear)] = None;
        }
        Self(inks)
    }
}

/// What is shown so far; what is clear is black.
struct Canvas {
    width: usize,
    cells: Vec<[u8; 3]>,
    /// Pixels that the last picture has drawn.
    drawn_px: usize,
}

impl Canvas {
    fn new((width, height): (usize, usize)) -> Self {
        Self { width, cells: vec![[0; 3]; width * height], drawn_px: 0 }
    }

    fn size(&self) -> (usize, usize) {
        (self.width, self.cells.len() / self.width.max(1))
    }

    /// The rows of `place`.
    fn rows(&mut self, Place { min, max }: Place) -> impl Iterator<Item = &mut [[u8; 3]]> {
        let rows = self.cells.chunks_mut(self.width.max(1)).take(max[1]).skip(min[1]);
        rows.map(move |row| &mut row[min[0]..max[0].max(min[0])])
    }

    fn copy(&mut self, place: Place) -> Vec<[u8; 3]> {
        self.rows(place).flat_map(|row| row.to_vec()).collect()
    }

    /// Draws a picture that is `width` pixels wide, as far as it lies on the canvas.
    fn paint(&mut self, place: Place, codes: &[u8], width: usize, inks: &Inks) {
        let mut drawn_px = 0;
        for (row, codes) in self.rows(place).zip(codes.chunks(width)) {
            for (cell, code) in row.iter_mut().zip(codes) {
                if let Some(color) = inks.0[usize::from(*code)] {
                    *cell = color;
                    drawn_px += 1;
                }
            }
        }
        self.drawn_px = drawn_px;
    }

    fn frame(&self) -> Result<Frame, Error> {
        let (width, height) = self.size();
        Grid::from_vec(width, height, self.cells.clone()).map(Frame::rgb)
    }

    fn pack(&self) -> std::io::Result<Vec<u8>> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(self.cells.as_flattened())?;
        encoder.finish()
    }

    fn unpack(packed: &[u8], size: (usize, usize)) -> Result<Self, Error> {
        let mut canvas = Self::new(size);
        ZlibDecoder::new(packed).read_exact(canvas.cells.as_flattened_mut()).map_err(|e| cannot_read(&e))?;
        Ok(canvas)
    }
}

/// A canvas that is kept.
struct Packed {
    /// Which of the places where one is due it is.
    place: usize,
    bytes: Vec<u8>,
}

/// Canvases by the number of the picture that is drawn next, packed.
struct Kept {
    canvases: BTreeMap<usize, Packed>,
    /// Only so many of the places where one is due are used: every second, every fourth …
    every: usize,
    bytes: usize,
}

impl Kept {
    /// Keeps the canvas before picture `number`, which is the one of `place` among those where that is due.
    fn available(&mut self, (number, place): (usize, usize), canvas: &Canvas) -> Result<(), Error> {
        if !place.is_multiple_of(self.every) || self.canvases.contains_key(&number) {
            return Ok(());
        }
        let bytes = canvas.pack().map_err(|e| cannot_read(&e))?;
        self.bytes += bytes.len();
        self.canvases.insert(number, Packed { place, bytes });
        while self.bytes > KEPT_BYTES && self.canvases.len() > 1 {
            self.every *= 2;
            self.canvases.retain(|_, canvas| canvas.place.is_multiple_of(self.every));
            self.bytes = self.canvases.values().map(|canvas| canvas.bytes.len()).sum();
        }
        Ok(())
    }
}

/// Says in our words what the decoder found.
fn damaged(error: &DecodingError) -> Error {
    match error {
        DecodingError::Io(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Error::new(picture::CUT_SHORT),
        DecodingError::Io(error) => cannot_read(error),
        _ => {
            let words = reason::bracketed(&error.to_string());
            Error::new(format!("it is damaged{words}; copy it again from its source"))
        }
    }
}
