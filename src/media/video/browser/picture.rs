//! The pictures of the browser's decoder in the layouts of Y4M.

/// A decoded picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Picture {
    /// Width and height in px.
    pub size: (usize, usize),
    /// The colour space of Y4M.
    pub space: &'static str,
    /// The matrix, as ISO/IEC 23091-2 numbers it.
    pub matrix: u32,
    /// Whether black is 0 and white 255, not 16 and 235.
    pub is_full_range: bool,
    /// The planes, one behind the other.
    pub samples: Vec<u8>,
}

/// The number that says nothing of a matrix.
const UNKNOWN: u32 = 2;
/// The number of the matrix that browsers take where a stream says nothing.
const ASSUMED: u32 = 1;

/// The colours of a picture, where they are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct KnownColors {
    /// The number of the matrix.
    pub matrix: Option<u32>,
    /// Whether values are full range.
    pub is_full_range: Option<bool>,
}

impl KnownColors {
    /// These colours, which a browser reports, beside those of the container. A matrix that the browser may only have assumed counts
    /// as unknown.
    pub(super) fn beside(self, container: Option<(u32, bool)>) -> Self {
        let told = container.map(|(matrix, _)| matrix).filter(|matrix| *matrix != UNKNOWN);
        let is_full = container.is_some_and(|(_, is_full)| is_full);
        Self {
            matrix: told.or(self.matrix.filter(|matrix| *matrix != ASSUMED)),
            is_full_range: if is_full { Some(true) } else { self.is_full_range },
        }
    }
}

/// The number of the matrix that a browser calls `name`.
pub(super) fn matrix(name: &str) -> Option<u32> {
    match name {
        "rgb" => Some(0),
        "bt709" => Some(1),
        "bt470bg" => Some(5),
        "smpte170m" => Some(6),
        "bt2020-ncl" => Some(9),
        _ => None,
    }
}

impl Picture {
    /// The picture whose `bytes` are in the pixel `format` of WebCodecs, without gaps; `None` if that format is not known, or there are too few.
    pub(super) fn new(format: &str, size: (usize, usize), mut bytes: Vec<u8>, colors: KnownColors) -> Option<Self> {
        let (width, height) = size;
        let [half_width, half_height] = [width.div_ceil(2), height.div_ceil(2)];
        let (luma, all) = (width * height, 4 * width * height);
        let (space, count) = match format {
            "I420" | "NV12" | "I420A" => ("420jpeg", luma + 2 * half_width * half_height),
            "I420P10" => ("420p10", 2 * (luma + 2 * half_width * half_height)),
            "I420P12" => ("420p12", 2 * (luma + 2 * half_width * half_height)),
            "I422" => ("422", luma + 2 * half_width * height),
            "I422P10" => ("422p10", 2 * (luma + 2 * half_width * height)),
            "I422P12" => ("422p12", 2 * (luma + 2 * half_width * height)),
            "I444" => ("444", 3 * luma),
            "I444P10" => ("444p10", 6 * luma),
            "I444P12" => ("444p12", 6 * luma),
            "RGBA" | "RGBX" | "BGRA" | "BGRX" => ("444", all),
            _ => return None,
        };
        // Alpha, if any, comes last and is left out.
        bytes.truncate(count);
        if bytes.len() < count || count == 0 {
            return None;
        }
        let (matrix, is_full_range) = (colors.matrix.unwrap_or(UNKNOWN), colors.is_full_range.unwrap_or(false));
        let picture = |samples| Self { size, space, matrix, is_full_range, samples };
        Some(match format {
            "NV12" => picture(split_chroma(bytes, luma)),
            "RGBA" | "RGBX" => Self { matrix: 0, is_full_range: true, ..picture(channels(&bytes, [1, 2, 0])) },
            "BGRA" | "BGRX" => Self { matrix: 0, is_full_range: true, ..picture(channels(&bytes, [1, 0, 2])) },
            _ => picture(bytes),
        })
    }

    /// Whether `other` can follow in the same file.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let form = |picture: &Self| (picture.size, picture.space, picture.samples.len());
        form(self) == form(other)
    }
}

/// Luma, and behind it U and V, which alternate in `bytes`, apart.
fn split_chroma(mut bytes: Vec<u8>, luma: usize) -> Vec<u8> {
    let pairs = bytes.split_off(luma);
    bytes.extend(pairs.iter().step_by(2));
    bytes.extend(pairs.iter().skip(1).step_by(2));
    bytes
}

/// A plane for each of three channels of pixels with four.
fn channels(bytes: &[u8], order: [usize; 3]) -> Vec<u8> {
    order.into_iter().flat_map(|channel| bytes.iter().skip(channel).step_by(4)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(format: &str, size: (usize, usize), bytes: &[u8]) -> Option<(&'static str, Vec<u8>)> {
        let picture = Picture::new(format, size, bytes.to_vec(), KnownColors::default())?;
        Some((picture.space, picture.samples))
    }

    #[test]
    fn every_layout_becomes_planes() {
        assert_eq!(samples("I420", (2, 2), &[1, 2, 3, 4, 5, 6]), Some(("420jpeg", vec![1, 2, 3, 4, 5, 6])));
        let odd = samples("NV12", (3, 1), &[1, 2, 3, 10, 20, 11, 21]);
        assert_eq!(odd, Some(("420jpeg", vec![1, 2, 3, 10, 11, 20, 21])));
        assert_eq!(samples("I420A", (1, 1), &[1, 2, 3, 255]), Some(("420jpeg", vec![1, 2, 3])));
        assert_eq!(samples("RGBX", (2, 1), &[1, 2, 3, 0, 4, 5, 6, 0]), Some(("444", vec![2, 5, 3, 6, 1, 4])));
        assert_eq!(samples("BGRA", (1, 1), &[3, 2, 1, 9]), Some(("444", vec![2, 3, 1])));
        assert_eq!(samples("I420P10", (1, 1), &[1, 0, 2, 0, 3, 0]), Some(("420p10", vec![1, 0, 2, 0, 3, 0])));
        for (format, bytes) in [("I420", &[1, 2][..]), ("NV21", &[1; 9]), ("", &[1; 9])] {
            assert_eq!(samples(format, (1, 1), bytes), None, "{format}");
        }
        assert_eq!(samples("I420", (0, 4), &[]), None);
    }

    #[test]
    fn colours_are_those_that_something_tells() {
        let colors = |name: &str| KnownColors { matrix: matrix(name), is_full_range: Some(false) };
        for (name, container, expected) in [
            ("bt709", None, (None, false)),
            ("smpte170m", None, (Some(6), false)),
            ("bt709", Some((1, true)), (Some(1), true)),
            ("smpte170m", Some((UNKNOWN, false)), (Some(6), false)),
            ("other", Some((9, false)), (Some(9), false)),
        ] {
            let KnownColors { matrix, is_full_range } = colors(name).beside(container);
            assert_eq!((matrix, is_full_range), (expected.0, Some(expected.1)), "{name}, {container:?}");
        }
    }
}
