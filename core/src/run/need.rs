//! The memory that a run needs, and whether there is so much.

use crate::base::Error;
use crate::data::Clip;

/// Memory that a run takes at most, about, beside the frames of the clip, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Need {
    /// Of a run to its end.
    pub run: u64,
    /// Of a run that is walked through, with all that is told of a unit, but only one of the states that are kept to go back to.
    pub walk: u64,
}

/// What every run may take beside that: buffers of each thread, the events of a small unit.
const BASE: u64 = 4 << 20;

/// What is left for others: a frame that is decoded, a picture that is painted.
const RESERVE: u64 = 64 << 20;

impl Need {
    /// So many bytes for each pixel of the clip's frames, of a run to its end and of one that is walked through.
    pub fn per_pixel(clip: &Clip, [run, walk]: [f64; 2]) -> Self {
        let (width, height) = clip.size();
        let pixels = width as f64 * height as f64;
        Self { run: BASE + (pixels * run) as u64, walk: BASE + (pixels * walk) as u64 }
    }

    /// The same and so many bytes more.
    #[must_use]
    pub fn and(self, [run, walk]: [f64; 2]) -> Self {
        Self { run: self.run.saturating_add(run as u64), walk: self.walk.saturating_add(walk as u64) }
    }
}

/// Refuses what `who` would need `bytes` for, if there are not so many free.
pub(crate) fn check(clip: &Clip, who: &str, bytes: u64) -> Result<(), Error> {
    let (free, (width, height)) = (clip.room(), clip.size());
    if bytes <= free {
        return Ok(());
    }
    Err(Error::new(format!(
        "{who} would take about {} of memory on pictures of {width}×{height} px, and {} are free; make the clip smaller before \
         it is opened, or choose an estimator that takes less",
        size(bytes),
        size(free)
    )))
}

/// Ends a run that keeps `kept` bytes of what it has found, if there is no room for more.
pub(crate) fn check_kept(clip: &Clip, kept: usize) -> Result<(), Error> {
    let (kept, free) = (kept as u64, clip.room());
    let is_room = if clip.has_budget() { kept <= free } else { free >= RESERVE };
    if is_room {
        return Ok(());
    }
    Err(Error::new(format!(
        "what was found so far takes {} of memory, and there is no room for more; let the run go through fewer frames",
        size(kept)
    )))
}

/// A number of bytes as a person reads it.
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
    fn sizes_are_told_in_the_unit_that_suits_them() {
        let told = [0, 1536, 5 << 20, (1 << 30) - 1, 13 << 30, 1 << 52].map(size);
        assert_eq!(told, ["0.0 KiB", "1.5 KiB", "5.0 MiB", "1.0 GiB", "13.0 GiB", "4096.0 TiB"]);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_figures() {
        let clip = Clip::blank("paper", (16_000, 8000), 2).within(3 << 30);
        let need = Need::per_pixel(&clip, [69.0, 120.0]).and([0.0, 1e9]);
        assert_eq!(need.run, BASE + 69 * 128_000_000);
        assert!(check(&clip, "Nobody", 3 << 30).is_ok() && check_kept(&clip, 3 << 30).is_ok());
        let refused = check(&clip, "Horn–Schunck", need.run).unwrap_err().to_string();
        assert!(
            refused.starts_with(
                "Horn–Schunck would take about 8.2 GiB of memory on pictures of 16000×8000 px, and 3.0 GiB"
            )
        );
        assert!(check_kept(&clip, 4 << 30).unwrap_err().to_string().contains("4.0 GiB"));
        assert!(Need::default().and([f64::MAX; 2]).run == u64::MAX);
    }
}
