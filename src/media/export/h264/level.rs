//! Names of H.264 with a profile and a level (ITU-T H.264, Annex A) as browsers have them: `avc1.64001f`.

/// High, main and baseline with their constraints.
const PROFILES: [&str; 3] = ["6400", "4d00", "42e0"];
/// Side of a macroblock in px.
const BLOCK: u32 = 16;
/// Levels that decoders have, from small to large, each with its most macroblocks of a picture and in a second (Table A-1).
const LEVELS: [(u8, u32, f64); 6] = [
    (31, 3_600, 108_000.0),
    (40, 8_192, 245_760.0),
    (42, 8_704, 522_240.0),
    (51, 36_864, 983_040.0),
    (52, 36_864, 2_073_600.0),
    (62, 139_264, 16_711_680.0),
];

/// The names for a video of `size` in px, the best first: those of the smallest levels that it fits. None if it is too large.
pub fn codecs(size: [u32; 2], rate_hz: f64) -> impl Iterator<Item = String> {
    let blocks: u32 = size.map(|side| side.div_ceil(BLOCK)).into_iter().product();
    let level = LEVELS
        .into_iter()
        .find(|&(_, most, most_per_second)| blocks <= most && f64::from(blocks) * rate_hz <= most_per_second);
    level.into_iter().flat_map(|(level, ..)| PROFILES.map(|profile| format!("avc1.{profile}{level:02x}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_level_that_fits_is_named() {
        let first = |size, rate_hz| codecs(size, rate_hz).next();
        assert_eq!(first([1280, 720], 30.0).as_deref(), Some("avc1.64001f"), "3.1 was made for it");
        assert_eq!(first([1280, 720], 31.0).as_deref(), Some("avc1.640028"));
        assert_eq!(first([1920, 1080], 30.0).as_deref(), Some("avc1.640028"));
        assert_eq!(first([3840, 2160], 30.0).as_deref(), Some("avc1.640033"));
        assert_eq!(first([20_000, 20_000], 1.0), None);
    }
}
