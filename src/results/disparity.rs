//! A disparity for each pixel, as a field.

use motionscope_core::base::Error;
use motionscope_core::data::Disparity;
use motionscope_core::products::{DisparityField, Output, Product};

use super::{EncodedFiles, Export, Format};
use crate::media::export::{kitti_disparity_result, npy_of, pfm};

pub const EXPORT: Export = Export {
    flag: "disparity",
    value: "FILE",
    help: "Save the disparities as .pfm, KITTI .png or .npy; `-` is a .pfm on standard output",
    name: "Disparity",
    explained: "The disparities: one shift to the right view per pixel, in px.",
    takes: &[DisparityField::KIND],
    folder: None,
    or_file: false,
    formats: &[
        Format {
            ending: "pfm",
            doc: "PFM, exact",
            encode: |output| field(output).map(|map| EncodedFiles::file(pfm(map))),
        },
        Format { ending: "png", doc: "KITTI 16-bit PNG", encode: as_kitti },
        Format {
            ending: "npy",
            doc: "NPY, an array for NumPy",
            encode: |output| field(output).map(|map| EncodedFiles::file(npy(map))),
        },
    ],
};

/// The disparities of a result.
fn field(output: &Output) -> Result<&Disparity, Error> {
    let missing = || Error::new("this result has no disparities; choose an estimator of stereo");
    output.get().map(|field: &DisparityField| &field.map).ok_or_else(missing)
}

fn as_kitti(output: &Output) -> Result<EncodedFiles, Error> {
    let made = kitti_disparity_result(field(output)?)?;
    let lost = made.out_of_range;
    let message =
        format!("{lost} pixels are outside the 0.004 to 255.996 px of a KITTI disparity and are marked as unknown");
    Ok(EncodedFiles { lost: (lost > 0).then_some(message), ..EncodedFiles::file(made.bytes) })
}

/// An array of little-endian f32 of shape (height, width) in px; NaN is unknown.
fn npy(Disparity(map): &Disparity) -> Vec<u8> {
    let (width, height) = map.size();
    npy_of("<f4", &format!("{height}, {width}"), map.cells().iter().flat_map(|d| d.to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use motionscope_core::data::Flow;
    use motionscope_core::geometry::Grid;
    use motionscope_core::products::DenseField;

    use super::*;

    #[test]
    fn each_format_writes_its_own_and_says_what_it_loses() {
        let cells = vec![300.0, 1.5, Disparity::UNKNOWN, 0.0];
        let map = Disparity(Grid::from_vec(2, 2, cells).unwrap());
        let output = Output::of(DisparityField { map, calibration: None, candidates: 64, filled: None });
        for (ending, start, is_reported) in [("pfm", "Pf", false), ("png", "PNG", true), ("npy", "NUMPY", false)] {
            let format = EXPORT.formats.iter().find(|format| format.ending == ending).unwrap();
            let EncodedFiles { files, lost } = (format.encode)(&output).unwrap();
            assert!(String::from_utf8_lossy(&files[0].1[..6]).contains(start));
            assert_eq!(lost.is_some_and(|lost| lost.starts_with("2 pixels")), is_reported, "{ending}");
        }
        let flow = Output::of(DenseField { flow: Flow(Grid::new(2, 2, [0.0; 2])), confidence: None });
        assert!(field(&flow).unwrap_err().to_string().contains("stereo"));
    }
}
