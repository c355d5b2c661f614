//! The memory that a run needs, and the check against what is free.

use crate::base::Error;
use crate::data::Clip;

/// Estimated peak memory of a run without the frames of the clip, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Need {
    /// Of a run to its end.
    pub run: u64,
    /// Of a run that is stepped through, with the events of a unit and one checkpoint.
    pub walk: u64,
}

/// Allowance for every run in bytes: buffers of each thread, events of a small unit.
const BASE: u64 = 4 << 20;

/// Reserve in bytes for other work: decoding a frame, painting a picture.
const RESERVE: u64 = 64 << 20;

impl Need {
    /// This many bytes per pixel of the clip's frames, for a run to its end and for one that is stepped through.
    pub fn per_pixel(clip: &Clip, [run, walk]: [f64; 2]) -> Self {
        let (width, height) = clip.size();
        let pixels = width as f64 * height as f64;
        Self { run: BASE + (pixels * run) as u64, walk: BASE + (pixels * walk) as u64 }
    }

    /// The same plus this many bytes.
    #[must_use]
    pub fn and(self, [run, walk]: [f64; 2]) -> Self {
        Self { run: self.run.saturating_add(run as u64), walk: self.walk.saturating_add(walk as u64) }
    }
}

/// Bytes per pixel of the frames of a pair, each in gray and in colour.
const PAIR: u64 = 2 * (1 + 3);

/// Checks that `bytes`, the need of estimator `who`, are free; without a given memory, also those of the frames that it has decoded.
pub(crate) fn check(clip: &Clip, who: &str, bytes: u64) -> Result<(), Error> {
    let (free, (width, height)) = (clip.room(), clip.size());
    let pair = if clip.has_budget() || clip.is_blank() { 0 } else { PAIR.saturating_mul((width * height) as u64) };
    let bytes = bytes.saturating_add(pair);
    if bytes <= free {
        return Ok(());
    }
    Err(Error::new(format!(
        "{who} needs about {} of memory for frames of {width}×{height} px, but {} are free; open a smaller clip, or choose an \
         estimator that needs less",
        size(bytes),
        size(free)
    )))
}

/// Checks that a run with `kept` bytes of results has memory to continue.
pub(crate) fn check_kept(clip: &Clip, kept: usize) -> Result<(), Error> {
    let (kept, free) = (kept as u64, clip.room());
    let is_room = if clip.has_budget() { kept <= free } else { free >= RESERVE };
    if is_room {
        return Ok(());
    }
    Err(Error::new(format!("the results so far take {} of memory and no more is free; run fewer frames", size(kept))))
}

/// A number of bytes as text.
fn size(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    let (mut value, mut unit) = (bytes as f64 / 1024.0, 0);
    while value >= 1023.95 && unit + 1 < UNITS.len() {
        (value, unit) = (value / 1024.0, unit + 1);
    }
    format!("{value:.1} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_reported_in_the_unit_that_suits_them() {
        let sizes = [0, 1536, 5 << 20, (1 << 30) - 1, 13 << 30, 1 << 52].map(size);
        assert_eq!(sizes, ["0.0 KiB", "1.5 KiB", "5.0 MiB", "1.0 GiB", "13.0 GiB", "4096.0 TiB"]);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_figures() {
        let clip = Clip::blank("paper", (16_000, 8000), 2).within(3 << 30);
        let need = Need::per_pixel(&clip, [69.0, 120.0]).and([0.0, 1e9]);
        assert_eq!(need.run, BASE + 69 * 128_000_000);
        assert!(check(&clip, "Nobody", 3 << 30).is_ok() && check_kept(&clip, 3 << 30).is_ok());
        let refused = check(&clip, "Horn–Schunck", need.run).unwrap_err().to_string();
        assert!(refused.starts_with(
            "Horn–Schunck needs about 8.2 GiB of memory for frames of 16000×8000 px, but 3.0 GiB are free"
        ));
        assert!(check_kept(&clip, 4 << 30).unwrap_err().to_string().contains("4.0 GiB"));
        assert!(Need::default().and([f64::MAX; 2]).run == u64::MAX);
    }
}
