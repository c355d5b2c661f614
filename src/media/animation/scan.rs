//! Counts an animation's pictures and reads how long each is shown, without decoding any.

use std::io::{BufReader, Read};
use std::path::Path;

use motionscope_core::base::Error;

use super::Format;
use crate::files::File;
use crate::media::{Open, cannot_read};

/// What the blocks of an animation tell.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Scan {
    /// Width and height in pixels of the composed pictures.
    pub size: (usize, usize),
    /// How long each picture that is all there is shown, in milliseconds.
    pub delays_ms: Vec<f64>,
    /// Whether the file reaches its end mark.
    pub whole: bool,
    /// Where each picture of a GIF lies, and what it takes to show it.
    pub pieces: Vec<Piece>,
    /// Bytes of a GIF before its first picture that all pictures need.
    pub head_bytes: u64,
}

/// One picture of a GIF, as its blocks tell of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Piece {
    /// First byte of its blocks in the file.
    pub start: u64,
    /// Pixels that are decoded for it.
    pub area_px: u64,
    /// Whether it looks the same whatever was shown before it.
    pub is_fresh: bool,
}

/// Pictures after which it is told how far the walk is.
const NEWS: usize = 64;

/// Walks over the blocks of the file at `path`.
///
/// # Errors
/// If it cannot be read, or opening was cancelled.
pub(super) fn scan(path: &Path, format: Format, options: &Open) -> Result<Scan, Error> {
    let file = File::open(path).map_err(|e| cannot_read(&e))?;
    let all = file.size().map_err(|e| cannot_read(&e))?;
    let mut walk = Walk { reader: BufReader::with_capacity(256 << 10, file), left: all, all, options, cancelled: None };
    let mut scan = Scan::default();
    let end = match format {
        Format::Gif => gif(&mut walk, &mut scan),
        Format::Png => png(&mut walk, &mut scan),
        Format::WebP => webp(&mut walk, &mut scan),
    };
    scan.whole = end.is_some();
    walk.cancelled.map_or(Ok(scan), Err)
}

/// A file from which bytes are taken until it ends.
struct Walk<'a> {
    reader: BufReader<File>,
    left: u64,
    all: u64,
    options: &'a Open,
    cancelled: Option<Error>,
}

impl Walk<'_> {
    /// Where the next byte lies.
    fn at(&self) -> u64 {
        self.all - self.left
    }

    /// Tells how far it is after `pictures`; `None` where it is to go no further.
    fn report(&mut self, pictures: usize) -> Option<()> {
        if pictures.is_multiple_of(NEWS) {
            let message = self.options.report(self.at() as f32 / self.all.max(1) as f32);
            self.cancelled = message.err();
        }
        self.cancelled.is_none().then_some(())
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        self.left = self.left.checked_sub(N as u64)?;
        self.reader.read_exact(&mut bytes).ok()?;
        Some(bytes)
    }

    fn skip(&mut self, bytes: u64) -> Option<()> {
        self.left = self.left.checked_sub(bytes)?;
        self.reader.seek_relative(i64::try_from(bytes).ok()?).ok()
    }

    /// Skips a GIF's chain of blocks; the first four bytes of the first block, if there are so many.
    fn chain(&mut self) -> Option<[u8; 4]> {
        let mut first = None;
        loop {
            let [length] = self.take()?;
            match (length, first) {
                (0, _) => return Some(first.unwrap_or_default()),
                (4.., None) => {
                    first = Some(self.take()?);
                    self.skip(u64::from(length) - 4)?;
                }
                _ => self.skip(length.into())?,
            }
        }
    }
}

/// GIF89a specification, W3C 1990.
fn gif(walk: &mut Walk<'_>, scan: &mut Scan) -> Option<()> {
    let head: [u8; 13] = walk.take()?;
    scan.size = (le(&head[6..8]), le(&head[8..10]));
    walk.skip(color_table(head[10]))?;
    scan.head_bytes = walk.at();
    let (mut control, mut start, mut is_cleared) = (Control::default(), walk.at(), true);
    loop {
        match walk.take()? {
            [0x21] => {
                let is_control = walk.take()? == [0xF9];
                let block = walk.chain()?;
                if is_control {
                    control = Control::of(block);
                }
            }
            [0x2C] => {
                let place: [u8; 9] = walk.take()?;
                walk.skip(color_table(place[8]))?;
                let [code_bits] = walk.take()?;
                walk.chain()?;
                let Control { delay_ms, disposal, has_clear } = std::mem::take(&mut control);
                let (covers, area_px) = (covers(&place, scan.size), (le(&place[4..6]) * le(&place[6..8])) as u64);
                let table = if place[8] & 0x80 == 0 { head[10] } else { place[8] };
                // A code without a colour is as good as a clear pixel.
                let is_opaque = covers && !has_clear && color_table(table) >= 3 << code_bits.min(60);
                let is_fresh = is_cleared || is_opaque && disposal != Control::RESTORE;
                scan.pieces.push(Piece { start, area_px, is_fresh });
                scan.delays_ms.push(delay_ms);
                (start, is_cleared) = (walk.at(), covers && disposal == Control::CLEAR);
                walk.report(scan.pieces.len())?;
            }
            [0x3B] => return Some(()),
            _ => return None,
        }
    }
}

/// What a GIF says of a picture before it comes.
#[derive(Default)]
struct Control {
    delay_ms: f64,
    /// What becomes of its place when the next picture comes.
    disposal: u8,
    /// Whether one of its colours stands for clear pixels.
    has_clear: bool,
}

impl Control {
    /// Its place is made clear.
    const CLEAR: u8 = 2;
    /// Its place is as it was before.
    const RESTORE: u8 = 3;

    fn of([flags, low, high, _]: [u8; 4]) -> Self {
        let delay_ms = 10.0 * f64::from(u16::from_le_bytes([low, high]));
        Self { delay_ms, disposal: flags >> 2 & 7, has_clear: flags & 1 == 1 }
    }
}

/// Whether a picture at `place`, as its block tells, takes up all of `size`.
fn covers(place: &[u8; 9], (width, height): (usize, usize)) -> bool {
    le(&place[0..4]) == 0 && le(&place[4..6]) >= width && le(&place[6..8]) >= height
}

/// Bytes of the colour table that `flags` announces.
fn color_table(flags: u8) -> u64 {
    if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) }
}

/// Portable Network Graphics, third edition, W3C 2025.
fn png(walk: &mut Walk<'_>, scan: &mut Scan) -> Option<()> {
    walk.skip(8)?;
    // A picture is all there when what follows its data begins.
    let mut pending_ms = None;
    loop {
        let [a, b, c, d, name @ ..] = walk.take::<8>()?;
        let mut rest = u64::from(u32::from_be_bytes([a, b, c, d])) + 4;
        match &name {
            b"IHDR" => {
                let [a, b, c, d, e, f, g, h] = walk.take()?;
                rest = rest.checked_sub(8)?;
                let side = |bytes| u32::from_be_bytes(bytes) as usize;
                scan.size = (side([a, b, c, d]), side([e, f, g, h]));
            }
            b"fcTL" => {
                scan.delays_ms.extend(pending_ms.take());
                walk.report(scan.delays_ms.len())?;
                let control: [u8; 24] = walk.take()?;
                rest = rest.checked_sub(24)?;
                let number = |at: usize| f64::from(u16::from_be_bytes([control[at], control[at + 1]]));
                // No denominator stands for hundredths.
                let per_second = if number(22) == 0.0 { 100.0 } else { number(22) };
                pending_ms = Some(1000.0 * number(20) / per_second);
            }
            b"IEND" => {
                scan.delays_ms.extend(pending_ms.take());
                return walk.skip(rest);
            }
            _ => {}
        }
        walk.skip(rest)?;
    }
}

/// WebP Container Specification, Google 2012; RFC 9649.
fn webp(walk: &mut Walk<'_>, scan: &mut Scan) -> Option<()> {
    walk.skip(12)?;
    while walk.left > 0 {
        let [name @ .., a, b, c, d] = walk.take::<8>()?;
        let length = u64::from(u32::from_le_bytes([a, b, c, d]));
        let mut rest = length + length % 2;
        match &name[..] {
            b"VP8X" => {
                let head: [u8; 10] = walk.take()?;
                rest = rest.checked_sub(10)?;
                scan.size = (le(&head[4..7]) + 1, le(&head[7..10]) + 1);
                walk.skip(rest)?;
            }
            b"ANMF" => {
                let head: [u8; 16] = walk.take()?;
                walk.skip(rest.checked_sub(16)?)?;
                scan.delays_ms.push(le(&head[12..15]) as f64);
                walk.report(scan.delays_ms.len())?;
            }
            _ => walk.skip(rest)?,
        }
    }
    Some(())
}

/// A little-endian number of up to four bytes.
fn le(bytes: &[u8]) -> usize {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | usize::from(byte))
}
