//! NumPy arrays.

use motionscope_core::{Flow, Life, Object, ObjectField};

/// `flow` as an `.npy` of version 1.0: little-endian f32 of shape (height, width, 2), u before v in px/frame, NaN where
/// the motion is not known.
pub fn npy(flow: &Flow) -> Vec<u8> {
    let (width, height) = flow.0.size();
    file("<f4", &format!("{height}, {width}, 2"), flow.0.cells().iter().flatten().flat_map(|c| c.to_le_bytes()))
}

/// How many numbers [`objects_npy`] has of an object in a frame.
const NUMBERS: usize = 11;

/// The objects of each frame as an `.npy` of version 1.0: little-endian f64 of shape (rows, 11) with frame, identity, x, y, u, v,
/// left, top, width, height in px and px/frame, and where it stands in its life: 0 tentative, 1 seen, 2 coasting. What is not
/// known is NaN.
pub fn objects_npy(field: &ObjectField) -> Vec<u8> {
    let row = |frame: usize, object: &Object| -> [f64; NUMBERS] {
        let ([x, y], [u, v]) = (object.position, object.velocity.unwrap_or([f64::NAN; 2]));
        let ([left, top], [width, height]) = (object.bounds.min.map(f64::from), object.bounds.size().map(f64::from));
        let life = match object.life {
            Life::Tentative => 0.0,
            Life::Confirmed => 1.0,
            Life::Coasting => 2.0,
        };
        [frame as f64, f64::from(object.id), x, y, u, v, left, top, width, height, life]
    };
    let frames = field.frames.iter().enumerate();
    let rows: Vec<_> =
        frames.flat_map(|(i, frame)| frame.objects.iter().map(move |o| row(field.first + i, o))).collect();
    file("<f8", &format!("{}, {NUMBERS}", rows.len()), rows.iter().flatten().flat_map(|c| c.to_le_bytes()))
}

fn file(kind: &str, shape: &str, data: impl Iterator<Item = u8>) -> Vec<u8> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    // Magic, version, length, header and its newline fill a multiple of 64 bytes.
    let spaces = (64 - (10 + header.len() + 1) % 64) % 64;
    header.extend(std::iter::repeat_n(' ', spaces));
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    // At most 118 characters: two sizes of up to 20 digits each.
    bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use motionscope_core::Grid;

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

    #[test]
    fn objects_are_rows_of_numbers() {
        let bytes = objects_npy(&super::super::objects::tests::field());
        let header = std::str::from_utf8(&bytes[10..128]).unwrap();
        assert!(header.starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 11), }"), "{header}");
        let numbers: Vec<f64> = bytes[128..].chunks(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect();
        assert_eq!(numbers[..11], [5.0, 3.0, 1.5, 10.75, 1.0, -0.5, -0.5, 9.5, 4.0, 2.5, 1.0]);
        assert_eq!(numbers.chunks(11).map(|row| row[10]).collect::<Vec<_>>(), [1.0, 2.0, 0.0]);
    }
}
