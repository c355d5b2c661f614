//! Counts an animation's pictures and reads how long each is shown, without decoding any.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use super::Format;

/// What the blocks of an animation tell.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Scan {
    /// Width and height in pixels of the composed pictures.
    pub size: (usize, usize),
    /// How long each picture that is all there is shown, in milliseconds.
    pub delays_ms: Vec<f64>,
    /// Whether the file reaches its end mark.
    pub whole: bool,
}

/// Walks over the blocks of the file at `path`.
///
/// # Errors
/// If it cannot be read.
pub(super) fn scan(path: &Path, format: Format) -> io::Result<Scan> {
    let file = File::open(path)?;
    let left = file.metadata()?.len();
    let mut walk = Walk { reader: BufReader::new(file), left };
    let mut scan = Scan::default();
    let end = match format {
        Format::Gif => gif(&mut walk, &mut scan),
        Format::Png => png(&mut walk, &mut scan),
        Format::WebP => webp(&mut walk, &mut scan),
    };
    scan.whole = end.is_some();
    Ok(scan)
}

/// A file from which bytes are taken until it ends.
struct Walk {
    reader: BufReader<File>,
    left: u64,
}

impl Walk {
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
fn gif(walk: &mut Walk, scan: &mut Scan) -> Option<()> {
    let head: [u8; 13] = walk.take()?;
    scan.size = (le(&head[6..8]), le(&head[8..10]));
    walk.skip(color_table(head[10]))?;
    let mut delay_ms = 0.0;
    loop {
        match walk.take()? {
            [0x21] => {
                let is_control = walk.take()? == [0xF9];
                let block = walk.chain()?;
                if is_control {
                    delay_ms = 10.0 * f64::from(u16::from_le_bytes([block[1], block[2]]));
                }
            }
            [0x2C] => {
                let place: [u8; 9] = walk.take()?;
                walk.skip(color_table(place[8]) + 1)?;
                walk.chain()?;
                scan.delays_ms.push(std::mem::take(&mut delay_ms));
            }
            [0x3B] => return Some(()),
            _ => return None,
        }
    }
}

/// Bytes of the colour table that `flags` announces.
fn color_table(flags: u8) -> u64 {
    if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) }
}

/// Portable Network Graphics, third edition, W3C 2025.
fn png(walk: &mut Walk, scan: &mut Scan) -> Option<()> {
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
fn webp(walk: &mut Walk, scan: &mut Scan) -> Option<()> {
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
