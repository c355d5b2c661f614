//! NumPy arrays.

use motionscope_core::data::Flow;

/// `flow` as an `.npy` of version 1.0: little-endian f32 of shape (height, width, 2), u before v in px/frame, NaN where
/// the motion is not known.
pub fn npy(flow: &Flow) -> Vec<u8> {
    let (width, height) = flow.0.size();
    npy_of("<f4", &format!("{height}, {width}, 2"), flow.0.cells().iter().flatten().flat_map(|c| c.to_le_bytes()))
}

/// An `.npy` of version 1.0 of `data`, little-endian numbers of `kind` such as `<f4`.
pub fn npy_of(kind: &str, shape: &str, data: impl Iterator<Item = u8>) -> Vec<u8> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    // Magic, version, length, header and its newline fill a multiple of 64 bytes.
    let spaces = (64 - (10 + header.len() + 1) % 64) % 64;
    header.extend(std::iter::repeat_n(' ', spaces));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    // At most 118 characters: two sizes of up to 20 digits each.
    bytes.extend_from_slice(&u16::try_from(header.len()).unwrap_or(u16::MAX).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;

    use super::*;

    #[test]
    fn bytes_are_those_of_the_format() {
        let bytes = npy(&Flow(Grid::from_vec(3, 1, vec![[1.0, -0.5], [0.0, 0.0], Flow::UNKNOWN]).unwrap()));
        assert_eq!(&bytes[..10], b"\x93NUMPY\x01\x00\x76\x00");
        let header = std::str::from_utf8(&bytes[10..128]).unwrap();
        assert_eq!(header.trim_end(), "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 3, 2), }");
        assert!(header.ends_with(" \n"));
        assert_eq!(&bytes[128..136], &[0, 0, 0x80, 0x3f, 0, 0, 0, 0xbf]);
        assert_eq!(bytes.len(), 128 + 3 * 8);
        assert!(f32::from_le_bytes(bytes[144..148].try_into().unwrap()).is_nan());
    }
}
