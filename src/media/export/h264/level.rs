//! Names of H.264 with a profile and a level (ITU-T H.264, Annex A) as browsers have them: `avc1.64001f`.

/// High, main and baseline with their constraints.
const PROFILES: [&str; 3] = ["6400", "4d00", "42e0"];
/// Side of a macroblock in px.
const BLOCK: u32 = 16;

/// Limits of a level (Table A-1).
struct Level {
    /// Ten times the number of the level.
    idc: u8,
    /// `MaxFS`: macroblocks of a picture.
    blocks: u32,
    /// `MaxMBPS`: macroblocks per second.
    blocks_per_second: f64,
    /// `MaxBR` of main and baseline: bits per second.
    bits_per_second: f64,
}

/// Common levels, from small to large.
const LEVELS: [Level; 6] = [
    Level { idc: 31, blocks: 3_600, blocks_per_second: 108_000.0, bits_per_second: 14e6 },
    Level { idc: 40, blocks: 8_192, blocks_per_second: 245_760.0, bits_per_second: 20e6 },
    Level { idc: 42, blocks: 8_704, blocks_per_second: 522_240.0, bits_per_second: 50e6 },
    Level { idc: 51, blocks: 36_864, blocks_per_second: 983_040.0, bits_per_second: 240e6 },
    Level { idc: 52, blocks: 36_864, blocks_per_second: 2_073_600.0, bits_per_second: 240e6 },
    Level { idc: 62, blocks: 139_264, blocks_per_second: 16_711_680.0, bits_per_second: 800e6 },
];

/// The names for a video of `size` in px, the best first: the smallest level that it fits, then larger ones, in case an encoder
/// has no smaller. Empty if the video is too large.
pub fn codecs(size: [u16; 2], rate_hz: f64, bits_per_second: f64) -> impl Iterator<Item = String> {
    let blocks: u32 = size.map(|side| u32::from(side).div_ceil(BLOCK)).into_iter().product();
    let fits = move |level: &Level| {
        let is_fast = f64::from(blocks) * rate_hz <= level.blocks_per_second;
        blocks <= level.blocks && is_fast && bits_per_second <= level.bits_per_second
    };
    LEVELS.into_iter().filter(fits).flat_map(|level| PROFILES.map(|profile| format!("avc1.{profile}{:02x}", level.idc)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_level_that_fits_comes_first() {
        let first = |size, rate_hz, bits| codecs(size, rate_hz, bits).next();
        assert_eq!(first([1280, 720], 30.0, 1e6).as_deref(), Some("avc1.64001f"), "3.1 was made for it");
        assert_eq!(first([1280, 720], 31.0, 1e6).as_deref(), Some("avc1.640028"), "faster");
        assert_eq!(first([1280, 720], 30.0, 28e6).as_deref(), Some("avc1.64002a"), "with more bits");
        assert_eq!(first([3840, 2160], 30.0, 1e6).as_deref(), Some("avc1.640033"), "larger");
        assert_eq!(first([20_000, 20_000], 1.0, 1e6), None);
        assert_eq!(codecs([640, 480], 30.0, 1e6).count(), 18, "every level in every profile");
    }
}
