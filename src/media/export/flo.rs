//! Middlebury's `.flo`.

use motionscope_core::data::Flow;

/// What a pixel of unknown motion holds in a `.flo`: any magnitude above 1e9 says so.
const UNKNOWN: f32 = 1e10;

/// `flow` as a `.flo`: `PIEH`, little-endian i32 width and height, then interleaved f32 u, v in px/frame, row by row
/// (Baker et al., A Database and Evaluation Methodology for Optical Flow, 2011).
pub fn flo(flow: &Flow) -> Vec<u8> {
    let (width, height) = flow.0.size();
    let mut bytes = Vec::with_capacity(12 + 8 * width * height);
    bytes.extend_from_slice(b"PIEH");
    for side in [width, height] {
        bytes.extend_from_slice(&i32::try_from(side).unwrap_or(i32::MAX).to_le_bytes());
    }
    for uv in flow.0.cells() {
        let [u, v] = if uv.iter().all(|c| c.is_finite()) { *uv } else { [UNKNOWN; 2] };
        bytes.extend_from_slice(&u.to_le_bytes());
        bytes.extend_from_slice(&v.to_le_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;

    use super::*;

    #[test]
    fn bytes_are_those_of_the_format() {
        let flow = Flow(Grid::from_vec(2, 1, vec![[1.0, -0.5], Flow::UNKNOWN]).unwrap());
        let mut golden = Vec::new();
        golden.extend_from_slice(&202_021.25_f32.to_le_bytes());
        golden.extend_from_slice(&[2, 0, 0, 0, 1, 0, 0, 0]);
        golden.extend_from_slice(&[0, 0, 0x80, 0x3f, 0, 0, 0, 0xbf]);
        golden.extend_from_slice(&[0xf9, 0x02, 0x15, 0x50, 0xf9, 0x02, 0x15, 0x50]);
        assert_eq!(flo(&flow), golden);
    }
}
