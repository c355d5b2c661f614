//! The description of a track for the browser's decoder: the string that names its codec, and the codec's parameters.

use crate::media::video::coded::Track;

/// The description of a track for the browser's decoder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Config {
    /// The codec with profile, level and depth, as in `av01.0.04M.08`.
    pub codec: String,
    /// The parameters of the codec, where it has them apart from the samples.
    pub description: Option<Vec<u8>>,
}

impl Config {
    /// The description of `track`, whose first sample is `first`; `None` if no browser decodes its codec, or it is damaged.
    pub(super) fn of(track: &Track, first: &[u8]) -> Option<Self> {
        let config = track.config.as_slice();
        let (codec, is_described) = match track.codec.as_str() {
            "h264" => (avc(config)?, true),
            "hevc" => (hevc(config)?, true),
            "av1" => (av1(config)?, false),
            "vp9" => (vp9(first)?, false),
            "vp8" => ("vp8".into(), false),
            _ => return None,
        };
        Some(Self { codec, description: is_described.then(|| config.to_vec()) })
    }
}

/// H.264, from its `avcC` record (RFC 6381, 3.3).
fn avc(record: &[u8]) -> Option<String> {
    let [_, profile, constraints, level, ..] = record else { return None };
    Some(format!("avc1.{profile:02x}{constraints:02x}{level:02x}"))
}

/// HEVC, from its `hvcC` record (ISO/IEC 14496-15, E.3).
fn hevc(record: &[u8]) -> Option<String> {
    let [_, profile, a, b, c, d, constraints @ .., level] = record.get(..13)? else { return None };
    let space = ["", "A", "B", "C"][usize::from(profile >> 6)];
    let tier = if profile & 0x20 == 0 { 'L' } else { 'H' };
    let compatible = u32::from_be_bytes([*a, *b, *c, *d]).reverse_bits();
    let used = constraints.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let constraints: String = constraints[..used].iter().map(|byte| format!(".{byte:X}")).collect();
    Some(format!("hvc1.{space}{}.{compatible:X}.{tier}{level}{constraints}", profile & 0x1F))
}

/// AV1, from its `av1C` record (AV1 in ISO base media, 2.3 and 5).
fn av1(record: &[u8]) -> Option<String> {
    let [_, profile_level, flags, ..] = *record else { return None };
    let tier = if flags & 0x80 == 0 { 'M' } else { 'H' };
    let depth = match (flags & 0x40 != 0, flags & 0x20 != 0) {
        (false, _) => 8,
        (true, false) => 10,
        (true, true) => 12,
    };
    Some(format!("av01.{}.{:02}{tier}.{depth:02}", profile_level >> 5, profile_level & 0x1F))
}

/// VP9, from the header of its first picture. A level does not matter to a decoder in software, and profiles from 2 on have 10 bits
/// unless they say 12.
fn vp9(sample: &[u8]) -> Option<String> {
    let header = *sample.first()?;
    let profile = header >> 5 & 1 | header >> 3 & 2;
    Some(format!("vp09.0{profile}.51.{}", if profile < 2 { "08" } else { "10" }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(codec: &str, config: &[u8], first: &[u8]) -> Option<String> {
        let track = Track { codec: codec.into(), config: config.to_vec(), ..Track::default() };
        Config::of(&track, first).map(|config| config.codec)
    }

    #[test]
    fn codecs_are_named_with_their_parameters() {
        let hevc = [1, 1, 0x60, 0, 0, 0, 0xB0, 0, 0, 0, 0, 0, 93, 0xF0];
        let main_10 = [1, 0x22, 0x20, 0, 0, 0, 0x90, 0, 0, 0, 0, 1, 150, 0xF0];
        for (codec, config, first, name) in [
            ("h264", &[1, 0x64, 0, 0x1F, 0xFF][..], &[][..], "avc1.64001f"),
            ("hevc", &hevc, &[], "hvc1.1.6.L93.B0"),
            ("hevc", &main_10, &[], "hvc1.2.4.H150.90.0.0.0.0.1"),
            ("av1", &[0x81, 0x04, 0x0C, 0], &[], "av01.0.04M.08"),
            ("av1", &[0x81, 0x2D, 0xE0, 0], &[], "av01.1.13H.12"),
            ("vp9", &[], &[0x82, 0x49], "vp09.00.51.08"),
            ("vp9", &[], &[0x92, 0x49], "vp09.02.51.10"),
            ("vp8", &[], &[], "vp8"),
        ] {
            assert_eq!(named(codec, config, first).as_deref(), Some(name));
        }
    }

    #[test]
    fn other_codecs_and_damaged_records_have_no_name() {
        for (codec, config) in
            [("mpeg4", &[1; 30][..]), ("hevc", &[1; 12]), ("av1", &[0x81]), ("h264", &[]), ("vp9", &[])]
        {
            assert_eq!(named(codec, config, &[]), None, "{codec}");
        }
    }
}
