//! A displacement for each pixel, as a field.

use motionscope_core::base::Error;
use motionscope_core::data::Flow;
use motionscope_core::products::{
    BlockField, DenseField, MatchField, ModelField, Output, PointField, Product, TrackField,
};

use super::{EncodedFiles, Export, Format};
use crate::media::export::{flo, kitti_result, npy};

pub const EXPORT: Export = Export {
    flag: "flow",
    value: "FILE",
    help: "Save the dense flow as Middlebury .flo, KITTI .png or .npy; `-` is a .flo on standard output",
    name: "Flow",
    explained: "The flow field: one displacement per pixel.",
    takes: &[
        BlockField::KIND,
        DenseField::KIND,
        PointField::KIND,
        TrackField::KIND,
        MatchField::KIND,
        ModelField::KIND,
    ],
    folder: None,
    or_file: false,
    formats: &[
        Format {
            ending: "flo",
            doc: "Middlebury .flo",
            encode: |output| field(output).map(|field| EncodedFiles::file(flo(&field))),
        },
        Format {
            ending: "npy",
            doc: "NPY, an array for NumPy",
            encode: |output| field(output).map(|field| EncodedFiles::file(npy(&field))),
        },
        Format { ending: "png", doc: "KITTI 16-bit PNG", encode: as_kitti },
    ],
};

/// The flow of a result.
///
/// # Errors
/// If it has none: features that were only found move nowhere.
fn field(output: &Output) -> Result<Flow, Error> {
    output.flow().ok_or_else(|| {
        Error::new("features that are detected but not tracked have no flow; save them as a table, or track them")
    })
}

fn as_kitti(output: &Output) -> Result<EncodedFiles, Error> {
    let made = kitti_result(&field(output)?)?;
    let lost = made.out_of_range;
    let message = format!("{lost} pixels exceed the ±512 px of a KITTI flow and are marked as unknown");
    Ok(EncodedFiles { lost: (lost > 0).then_some(message), ..EncodedFiles::file(made.bytes) })
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;

    use super::*;

    #[test]
    fn each_format_writes_its_own_and_says_what_it_loses() {
        let output = Output::of(DenseField { flow: Flow(Grid::new(2, 2, [600.0, 0.0])), confidence: None });
        for (ending, start, is_reported) in [("flo", "PIEH", false), ("png", "PNG", true), ("npy", "NUMPY", false)] {
            let format = EXPORT.formats.iter().find(|format| format.ending == ending).unwrap();
            let EncodedFiles { files, lost } = (format.encode)(&output).unwrap();
            assert!(String::from_utf8_lossy(&files[0].1[..6]).contains(start));
            assert_eq!(lost.is_some_and(|lost| lost.starts_with("4 pixels")), is_reported);
        }
    }

    #[test]
    fn features_that_were_only_found_have_no_flow() {
        let output = Output::of(PointField { picture: (4, 4), points: Vec::new(), keypoints: Vec::new() });
        assert!(field(&output).unwrap_err().to_string().contains("not tracked"));
    }
}
