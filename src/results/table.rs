//! The table of any product, as CSV.

use motionscope_core::base::Error;
use motionscope_core::products::table::Table;
use motionscope_core::products::{
    BlockField, DenseField, DisparityField, EpipolarField, MaskField, MatchField, ModelField, ObjectField, Output,
    PathField, PointField, Product, RegionField, SceneFlowField, SegmentField, TrackField,
};

use super::{EncodedFiles, Export, Format};

pub const EXPORT: Export = Export {
    flag: "table",
    value: "FILE.csv",
    help: "Save motion vectors, features, matches, disparities, objects, detections or segments as CSV; `-` is standard output",
    name: "Table",
    explained: "A table with units in its headings.",
    takes: &[
        BlockField::KIND,
        DenseField::KIND,
        DisparityField::KIND,
        SceneFlowField::KIND,
        PointField::KIND,
        TrackField::KIND,
        MatchField::KIND,
        ModelField::KIND,
        EpipolarField::KIND,
        PathField::KIND,
        ObjectField::KIND,
        MaskField::KIND,
        SegmentField::KIND,
        RegionField::KIND,
    ],
    folder: None,
    or_file: false,
    formats: &[Format { ending: "csv", doc: "CSV", encode }],
};

fn encode(output: &Output) -> Result<EncodedFiles, Error> {
    let table = output.table().ok_or_else(|| Error::new("this result has no table; save it as pictures"))?;
    Ok(EncodedFiles::file(csv(&table)))
}

/// `table` as CSV: commas, points for decimals, one line of names, lines that end in a newline.
pub(super) fn csv(table: &Table) -> String {
    let mut text = table.columns().join(",");
    text.push('\n');
    for row in table.rows() {
        for (i, cell) in row.iter().enumerate() {
            if i > 0 {
                text.push(',');
            }
            text += &cell.to_string();
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests;
