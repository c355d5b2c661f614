//! MP4's sample tables and fragments, made into one list.

use motionscope_core::base::Error;

use super::bytes::Bytes;
use super::coded::{MAX_SAMPLES, Sample};
use super::mp4_boxes::{boxes, find};

/// What a sample of a fragment is unless it says otherwise.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fragment {
    /// Ticks until the next sample.
    pub duration: u32,
    /// Bytes.
    pub size: u32,
    /// ISO/IEC 14496-12's sample flags.
    pub flags: u32,
}

/// Bit of the sample flags: decoding cannot start here.
const NO_SYNC: u32 = 1 << 16;

/// The samples that have been read so far.
#[derive(Debug, Default)]
pub(crate) struct Table {
    /// In decoding order.
    pub samples: Vec<Sample>,
    /// When the next sample is decoded, in ticks.
    clock: i64,
}

fn damaged() -> Error {
    Error::new("the index of its video track is damaged; copy it again from its source")
}

/// The numbers of a table box: version and flags, a count, then `columns` numbers in each row.
fn rows(table: &[u8], columns: usize) -> impl Iterator<Item = &[u8]> {
    let count = Bytes(table.get(4..).unwrap_or_default()).be32().unwrap_or(0) as usize;
    table.get(8..).unwrap_or_default().chunks_exact(4 * columns).take(count)
}

fn number(row: &[u8], column: usize) -> u32 {
    Bytes(&row[4 * column..]).be32().unwrap_or(0)
}

impl Table {
    /// Reads the tables of a `stbl` box.
    ///
    /// # Errors
    /// If they contradict each other or claim too much.
    pub(crate) fn read(&mut self, stbl: &[u8]) -> Result<(), Error> {
        let sizes = sizes(stbl)?;
        self.samples = vec![Sample { offset: 0, size: 0, time: 0, key: false }; sizes.len()];
        for (sample, size) in self.samples.iter_mut().zip(&sizes) {
            sample.size = *size;
        }
        self.place(stbl)?;
        self.time(stbl);
        match find(stbl, b"stss") {
            Some(stss) => {
                for row in rows(stss, 1) {
                    let index = (number(row, 0) as usize).wrapping_sub(1);
                    if let Some(sample) = self.samples.get_mut(index) {
                        sample.key = true;
                    }
                }
            }
            None => self.samples.iter_mut().for_each(|sample| sample.key = true),
        }
        Ok(())
    }

    /// Offsets from the chunks' offsets and how many samples each chunk holds.
    fn place(&mut self, stbl: &[u8]) -> Result<(), Error> {
        let chunks: Vec<u64> = if let Some(stco) = find(stbl, b"stco") {
            rows(stco, 1).map(|row| u64::from(number(row, 0))).collect()
        } else {
            let co64 = find(stbl, b"co64").unwrap_or_default();
            rows(co64, 2).map(|row| u64::from(number(row, 0)) << 32 | u64::from(number(row, 1))).collect()
        };
        let runs: Vec<(usize, usize)> = rows(find(stbl, b"stsc").unwrap_or_default(), 3)
            .map(|row| (number(row, 0) as usize, number(row, 1) as usize))
            .collect();
        let mut run = 0;
        let mut unplaced = self.samples.iter_mut();
        for (chunk, &start) in chunks.iter().enumerate() {
            while runs.get(run + 1).is_some_and(|&(first, _)| first <= chunk + 1) {
                run += 1;
            }
            let mut offset = start;
            let count = runs.get(run).map_or(0, |&(_, count)| count);
            for sample in unplaced.by_ref().take(count) {
                sample.offset = offset;
                offset = offset.saturating_add(u64::from(sample.size));
            }
        }
        if unplaced.next().is_some() { Err(damaged()) } else { Ok(()) }
    }

    /// Times from the durations and, where pictures are reordered, their offsets.
    fn time(&mut self, stbl: &[u8]) {
        let mut durations = runs(find(stbl, b"stts"));
        let mut shifts = runs(find(stbl, b"ctts"));
        for sample in &mut self.samples {
            sample.time = self.clock + i64::from(shifts.next().unwrap_or(0) as i32);
            // Durations are unsigned but no sample lasts half of their range.
            self.clock += i64::from(durations.next().unwrap_or(0) as i32).max(0);
        }
    }

    /// Adds the samples of track `id` in the `moof` box that begins at `start`.
    ///
    /// # Errors
    /// If its tables claim too many samples.
    pub(crate) fn read_fragment(&mut self, start: u64, moof: &[u8], id: u32, trex: Fragment) -> Result<(), Error> {
        for (_, traf) in boxes(moof).filter(|(kind, _)| kind == b"traf") {
            let Some((track, mut at, defaults)) = find(traf, b"tfhd").and_then(|tfhd| header(tfhd, start, trex)) else {
                continue;
            };
            if track != id {
                continue;
            }
            if let Some(time) = find(traf, b"tfdt").and_then(decode_time) {
                self.clock = time;
            }
            let base = at;
            for (_, trun) in boxes(traf).filter(|(kind, _)| kind == b"trun") {
                self.read_run(trun, base, &mut at, defaults)?;
            }
        }
        Ok(())
    }

    fn read_run(&mut self, trun: &[u8], base: u64, at: &mut u64, defaults: Fragment) -> Result<(), Error> {
        let mut bytes = Bytes(trun);
        let flags = bytes.be32().ok_or_else(damaged)?;
        let count = bytes.be32().ok_or_else(damaged)?;
        let optional = |bit: u32, bytes: &mut Bytes| (flags & bit != 0).then(|| bytes.be32()).flatten();
        if let Some(offset) = optional(0x1, &mut bytes) {
            *at = base.saturating_add_signed(i64::from(offset as i32));
        }
        let mut first_flags = optional(0x4, &mut bytes);
        let columns = (flags & 0xF00).count_ones() as usize;
        // Rows that have columns take bytes; rows without could be claimed without end.
        let most = bytes.0.len().checked_div(4 * columns).unwrap_or(MAX_SAMPLES);
        for _ in 0..(count as usize).min(most) {
            if self.samples.len() >= MAX_SAMPLES {
                return Err(damaged());
            }
            let duration = optional(0x100, &mut bytes).unwrap_or(defaults.duration);
            let size = optional(0x200, &mut bytes).unwrap_or(defaults.size);
            let own_flags = optional(0x400, &mut bytes);
            let sample_flags = first_flags.take().or(own_flags).unwrap_or(defaults.flags);
            let shift = optional(0x800, &mut bytes).unwrap_or(0) as i32;
            let time = self.clock.saturating_add(i64::from(shift));
            self.samples.push(Sample { offset: *at, size, time, key: sample_flags & NO_SYNC == 0 });
            self.clock = self.clock.saturating_add(i64::from(duration));
            *at = at.saturating_add(u64::from(size));
        }
        Ok(())
    }
}

/// The bytes of each sample.
fn sizes(stbl: &[u8]) -> Result<Vec<u32>, Error> {
    if let Some(stsz) = find(stbl, b"stsz") {
        let mut bytes = Bytes(stsz.get(4..).unwrap_or_default());
        let (same, count) = bytes.be32().zip(bytes.be32()).ok_or_else(damaged)?;
        let count = believable(count)?;
        if same == 0 {
            return Ok(bytes.0.chunks_exact(4).take(count).map(|row| number(row, 0)).collect());
        }
        return Ok(vec![same; count]);
    }
    let mut bytes = Bytes(find(stbl, b"stz2").and_then(|stz2| stz2.get(4..)).ok_or_else(damaged)?);
    let (bits, count) = bytes.be32().zip(bytes.be32()).ok_or_else(damaged)?;
    let count = believable(count)?;
    match bits {
        4 => Ok(bytes.0.iter().flat_map(|&pair| [u32::from(pair >> 4), u32::from(pair & 15)]).take(count).collect()),
        8 => Ok(bytes.0.iter().take(count).map(|&size| u32::from(size)).collect()),
        16 => {
            let pairs = bytes.0.chunks_exact(2).take(count);
            Ok(pairs.map(|pair| u32::from(u16::from_be_bytes([pair[0], pair[1]]))).collect())
        }
        _ => Err(damaged()),
    }
}

/// A number of samples that a clip can have, before anything is allocated for them.
fn believable(count: u32) -> Result<usize, Error> {
    Some(count as usize).filter(|&count| count <= MAX_SAMPLES).ok_or_else(damaged)
}

/// The values of a table of runs, each `count` times `value`.
fn runs(table: Option<&[u8]>) -> impl Iterator<Item = u32> {
    rows(table.unwrap_or_default(), 2).flat_map(|row| std::iter::repeat_n(number(row, 1), number(row, 0) as usize))
}

/// Track, first byte and defaults out of a `tfhd` box.
fn header(tfhd: &[u8], moof: u64, trex: Fragment) -> Option<(u32, u64, Fragment)> {
    let mut bytes = Bytes(tfhd);
    let flags = bytes.be32()?;
    let track = bytes.be32()?;
    let start = if flags & 0x1 != 0 { bytes.be64()? } else { moof };
    if flags & 0x2 != 0 {
        bytes.be32()?;
    }
    let mut or = |bit: u32, default: u32| if flags & bit != 0 { bytes.be32() } else { Some(default) };
    let defaults =
        Fragment { duration: or(0x8, trex.duration)?, size: or(0x10, trex.size)?, flags: or(0x20, trex.flags)? };
    Some((track, start, defaults))
}

/// When the first sample of a fragment is decoded, from its `tfdt` box.
fn decode_time(tfdt: &[u8]) -> Option<i64> {
    let mut bytes = Bytes(tfdt);
    let long = bytes.u8()? == 1;
    bytes.take(3)?;
    let time = if long { bytes.be64()? } else { u64::from(bytes.be32()?) };
    i64::try_from(time).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(kind: &[u8; 4], numbers: &[u32]) -> Vec<u8> {
        let mut bytes = (12 + 4 * numbers.len() as u32).to_be_bytes().to_vec();
        bytes.extend(kind);
        bytes.extend([0; 4]);
        bytes.extend(numbers.iter().flat_map(|n| n.to_be_bytes()));
        bytes
    }

    #[test]
    fn a_number_of_samples_that_no_clip_has_is_refused_before_it_is_allocated() {
        assert_eq!(sizes(&table(b"stsz", &[7, 3])), Ok(vec![7; 3]));
        assert_eq!(sizes(&table(b"stsz", &[0, 2, 5, 6])), Ok(vec![5, 6]));
        assert_eq!(sizes(&table(b"stz2", &[8, 4, 0x0102_0304])), Ok(vec![1, 2, 3, 4]));
        for (kind, first) in [(b"stsz", 7), (b"stsz", 0), (b"stz2", 4), (b"stz2", 16)] {
            assert!(sizes(&table(kind, &[first, u32::MAX, 1])).is_err());
        }
    }
}
