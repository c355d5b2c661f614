//! The pixel aspect in an H.264 sequence parameter set (ITU-T H.264, 7.3.2.1.1 and E.1.1), which our decoder skips.

/// Profiles whose parameters tell chroma format and bit depth.
const HIGH_PROFILES: [u32; 12] = [100, 110, 122, 244, 44, 83, 86, 118, 128, 138, 139, 134];
/// Ratios by their number from 1 on (table E-1).
const RATIOS: [[u64; 2]; 16] = [
    [1, 1],
    [12, 11],
    [10, 11],
    [16, 11],
    [40, 33],
    [24, 11],
    [20, 11],
    [32, 11],
    [80, 33],
    [18, 11],
    [15, 11],
    [64, 33],
    [160, 99],
    [4, 3],
    [3, 2],
    [2, 1],
];
/// The number of a ratio that follows as two numbers.
const EXTENDED: u32 = 255;

/// Width and height of a pixel, as a ratio, in the payload of a parameter set; `None` if it does not tell or is damaged.
pub(crate) fn pixel_aspect(payload: &[u8]) -> Option<[u64; 2]> {
    let mut bits = Bits { bytes: payload, at: 0 };
    let profile = bits.take(8)?;
    bits.take(16)?;
    bits.unsigned()?;
    if HIGH_PROFILES.contains(&profile) {
        skip_format(&mut bits)?;
    }
    bits.unsigned()?;
    skip_order(&mut bits)?;
    bits.unsigned()?;
    bits.take(1)?;
    bits.unsigned()?;
    bits.unsigned()?;
    let is_frame_only = bits.take(1)? == 1;
    bits.take(if is_frame_only { 1 } else { 2 })?;
    if bits.take(1)? == 1 {
        for _ in 0..4 {
            bits.unsigned()?;
        }
    }
    if bits.take(1)? == 0 || bits.take(1)? == 0 {
        return None;
    }
    match bits.take(8)? {
        EXTENDED => Some([bits.take(16)?.into(), bits.take(16)?.into()]),
        number => RATIOS.get((number as usize).checked_sub(1)?).copied(),
    }
}

/// Skips chroma format, bit depths and scaling lists.
fn skip_format(bits: &mut Bits<'_>) -> Option<()> {
    let is_444 = bits.unsigned()? == 3;
    if is_444 {
        bits.take(1)?;
    }
    bits.unsigned()?;
    bits.unsigned()?;
    bits.take(1)?;
    if bits.take(1)? == 1 {
        for list in 0..if is_444 { 12 } else { 8 } {
            if bits.take(1)? == 1 {
                skip_scaling_list(bits, if list < 6 { 16 } else { 64 })?;
            }
        }
    }
    Some(())
}

fn skip_scaling_list(bits: &mut Bits<'_>, size: usize) -> Option<()> {
    let (mut last, mut next) = (8, 8);
    for _ in 0..size {
        if next != 0 {
            next = (last + bits.signed()?).rem_euclid(256);
        }
        last = if next == 0 { last } else { next };
    }
    Some(())
}

/// Skips how the order of pictures is told.
fn skip_order(bits: &mut Bits<'_>) -> Option<()> {
    match bits.unsigned()? {
        0 => bits.unsigned().map(drop),
        1 => {
            bits.take(1)?;
            bits.unsigned()?;
            bits.unsigned()?;
            let count = bits.unsigned()?;
            (0..count).try_for_each(|_| bits.unsigned().map(drop))
        }
        _ => Some(()),
    }
}

/// Bits that are read from the front.
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bits<'_> {
    /// The next `count` bits, at most 32.
    fn take(&mut self, count: usize) -> Option<u32> {
        (0..count).try_fold(0, |value: u32, _| {
            let byte = self.bytes.get(self.at / 8)?;
            let bit = byte >> (7 - self.at % 8) & 1;
            self.at += 1;
            Some(value << 1 | u32::from(bit))
        })
    }

    /// An unsigned Exp-Golomb code (9.1).
    fn unsigned(&mut self) -> Option<u32> {
        let mut zeros = 0;
        while self.take(1)? == 0 {
            zeros += 1;
        }
        if zeros > 31 {
            return None;
        }
        Some((1 << zeros) - 1 + self.take(zeros)?)
    }

    /// A signed Exp-Golomb code (9.1.1).
    fn signed(&mut self) -> Option<i64> {
        let code = i64::from(self.unsigned()?);
        Some(if code % 2 == 1 { (code + 1) / 2 } else { -code / 2 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_aspect_of_an_encoder_is_found() {
        // x264 on 64×48 px with setsar=2/1; without emulation prevention bytes.
        let payload = [
            0x64, 0x00, 0x0a, 0xac, 0xd9, 0x44, 0x7b, 0x10, 0x10, 0x00, 0x00, 0x00, 0x10, 0x00, 0x00, 0x03, 0x20, 0xf1,
            0x22, 0x59, 0x60,
        ];
        assert_eq!(pixel_aspect(&payload), Some([2, 1]));
        // Cut anywhere, it is unknown or the same, never a panic.
        assert!((0..payload.len()).all(|end| pixel_aspect(&payload[..end]).is_none_or(|ratio| ratio == [2, 1])));
        assert_eq!(pixel_aspect(&[0; 40]), None);
    }
}
