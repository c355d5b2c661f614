//! What an estimator found, as a table and as a dense field.

use std::path::Path;
use std::sync::Arc;

use motionscope_core::{BlockField, Confidence, Error, Feature, Flow, Output, PointField, Status, Track, TrackField};

use super::{Cell, Table, flo, kitti_result, npy};
use crate::media::names::extension;

/// `output` as CSV, one row per feature, or per block or pixel without those that have no result.
pub fn csv(output: &Output) -> String {
    match output {
        Output::Blocks(field) => blocks(field).csv(),
        Output::Points(field) if field.responses.is_empty() => points(field).csv(),
        Output::Points(field) => corners(field).csv(),
        Output::Tracks(field) => tracks(field).csv(),
        Output::Objects(field) => super::objects::csv(field),
        Output::Dense(field) => match &field.confidence {
            Some(Confidence { name, values }) => {
                let rows = pixels(&field.flow).map(|([x, y], [u, v])| {
                    [Cell::Int(x as i64), Cell::Int(y as i64), u, v, Cell::Single(values[(x, y)])]
                });
                Table { columns: ["x_px", "y_px", "u_px", "v_px", name], rows: rows.collect() }.csv()
            }
            None => {
                let rows = pixels(&field.flow).map(|([x, y], [u, v])| [Cell::Int(x as i64), Cell::Int(y as i64), u, v]);
                Table { columns: ["x_px", "y_px", "u_px", "v_px"], rows: rows.collect() }.csv()
            }
        },
    }
}

/// The flow that `output` amounts to, to be written as a field.
///
/// # Errors
/// If it has none: features that were only found move nowhere, and objects are boxes.
pub fn flow(output: &Output) -> Result<Flow, Error> {
    match (output, output.points()) {
        (Output::Objects(_), _) => Err(Error::new("objects are no flow; write them as tracks or as a table")),
        (_, Some(field)) if field.count(|status| status == Status::Found) == field.points.len() => Err(Error::new(
            "features that are found and not tracked have no flow; write them as a table, or track them",
        )),
        _ => Ok(output.flow()),
    }
}

/// Place and displacement of the pixels whose motion is known, row by row.
fn pixels(flow: &Flow) -> impl Iterator<Item = ([usize; 2], [Cell; 2])> + '_ {
    let places = (0..flow.0.height()).flat_map(|y| (0..flow.0.width()).map(move |x| [x, y]));
    places.filter_map(|[x, y]| Some(([x, y], flow.at(x, y)?.map(Cell::Single))))
}

/// Centre and size of each block, its displacement per frame, and what that costs.
fn blocks(field: &BlockField) -> Table<7> {
    let found = field.vectors.iter().enumerate().filter_map(|(i, vector)| Some((field.blocks.block(i), (*vector)?)));
    let rows = found.map(|(block, vector)| {
        let [x, y] = block.center().map(Cell::Single);
        let [width, height] = [block.width, block.height].map(|side| Cell::Int(side as i64));
        let [u, v] = vector.displacement.map(Cell::Single);
        [x, y, width, height, u, v, Cell::Real(vector.cost)]
    });
    let columns = ["x_px", "y_px", "width_px", "height_px", "u_px", "v_px", "cost"];
    Table { columns, rows: rows.collect() }
}

fn row(point: &Feature) -> [Cell; 6] {
    let [x, y] = point.at.map(Cell::Single);
    let [u, v] = point.displacement.map_or([Cell::Empty; 2], |displacement| displacement.map(Cell::Single));
    [x, y, u, v, Cell::Word(point.status.name()), point.residual.map_or(Cell::Empty, Cell::Single)]
}

/// Place of each feature, its displacement per frame if it has one, and what became of it.
fn points(field: &PointField) -> Table<6> {
    let columns = ["x_px", "y_px", "u_px", "v_px", "status", "residual"];
    Table { columns, rows: field.points.iter().map(row).collect() }
}

/// The same with the response that each was chosen by.
fn corners(field: &PointField) -> Table<7> {
    let row = |(point, response): (&Feature, &f32)| {
        let [x, y, u, v, status, residual] = row(point);
        [x, y, u, v, status, residual, Cell::Single(*response)]
    };
    let columns = ["x_px", "y_px", "u_px", "v_px", "status", "residual", "response"];
    Table { columns, rows: field.points.iter().zip(&field.responses).map(row).collect() }
}

/// Place of each track in each frame, its displacement to the next if it has one, and what became of it.
fn tracks(field: &TrackField) -> Table<8> {
    let row = |(number, frame): (usize, usize), point: &Feature| {
        let [id, frame] = [number + 1, frame].map(|v| Cell::Int(v as i64));
        let [x, y, u, v, status, residual] = row(point);
        [id, frame, x, y, u, v, status, residual]
    };
    let of_track = |(number, track): (usize, &Arc<Track>)| {
        let points = track.points.iter().enumerate();
        points.map(|(i, point)| row((number, track.first + i), point)).collect::<Vec<_>>()
    };
    let columns = ["track", "frame", "x_px", "y_px", "u_px", "v_px", "status", "residual"];
    Table { columns, rows: field.tracks.iter().enumerate().flat_map(of_track).collect() }
}

/// How a dense flow is kept in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlowFormat {
    /// Middlebury's `.flo`.
    Flo,
    /// KITTI's 16-bit PNG.
    Kitti,
    /// A NumPy array.
    Npy,
}

impl FlowFormat {
    /// The format that the extension of `path` asks for; `-` is a `.flo`.
    ///
    /// # Errors
    /// A sentence that tells which extensions there are.
    pub fn of(path: &Path) -> Result<Self, Error> {
        match extension(path).as_str() {
            "flo" => Ok(Self::Flo),
            "png" => Ok(Self::Kitti),
            "npy" => Ok(Self::Npy),
            _ if path == Path::new("-") => Ok(Self::Flo),
            _ => Err(Error::new(format!("{}: a flow is written as .flo, .png (KITTI) or .npy", path.display()))),
        }
    }

    /// `flow` in this format, and what it could not keep.
    ///
    /// # Errors
    /// If the field has no pixels.
    pub fn encode(self, flow: &Flow) -> Result<(Vec<u8>, Option<String>), Error> {
        match self {
            Self::Flo => Ok((flo(flow), None)),
            Self::Npy => Ok((npy(flow), None)),
            Self::Kitti => kitti_result(flow).map(|made| {
                let lost = made.out_of_range;
                let told =
                    format!("{lost} pixels move farther than the ±512 px of a KITTI flow and are marked unknown");
                (made.bytes, (lost > 0).then_some(told))
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::{BlockGrid, BlockVector, Border, DenseField, Grid};

    use super::*;

    #[test]
    fn a_block_is_a_row() {
        let vector = |u, cost| Some(BlockVector { displacement: [u, -1.0], cost, candidates: 9 });
        let output = Output::Blocks(BlockField {
            blocks: BlockGrid { picture: (40, 16), size: 16, step: 16 },
            vectors: vec![vector(2.0, 12.0), None, vector(0.5, 3.25)],
            cost: "SAD",
            border: Border::Replicate,
            filter: motionscope_core::Interpolation::Bilinear,
        });
        let golden = "x_px,y_px,width_px,height_px,u_px,v_px,cost\n7.5,7.5,16,16,2,-1,12\n35.5,7.5,8,16,0.5,-1,3.25\n";
        assert_eq!(csv(&output), golden);
    }

    #[test]
    fn a_pixel_of_known_motion_is_a_row() {
        let flow = Flow(Grid::from_fn(2, 2, |x, y| if x == y { [0.5, -1.0] } else { Flow::UNKNOWN }));
        let table = |confidence| csv(&Output::Dense(DenseField { flow: flow.clone(), confidence }));
        assert_eq!(table(None), "x_px,y_px,u_px,v_px\n0,0,0.5,-1\n1,1,0.5,-1\n");
        let confidence = Confidence { name: "gradient", values: Grid::from_fn(2, 2, |x, _| x as f32) };
        assert_eq!(table(Some(confidence)), "x_px,y_px,u_px,v_px,gradient\n0,0,0.5,-1,0\n1,1,0.5,-1,1\n");
    }

    #[test]
    fn a_feature_is_a_row_whatever_became_of_it() {
        let feature = |at, displacement, status, residual| Feature { at, displacement, status, residual };
        let points = vec![
            feature([3.0, 2.0], Some([0.25, -1.5]), Status::Tracked, Some(0.5)),
            feature([1.5, 0.0], None, Status::Outside, None),
            feature([4.0, 4.0], None, Status::Found, None),
        ];
        let golden =
            "x_px,y_px,u_px,v_px,status,residual\n3,2,0.25,-1.5,tracked,0.5\n1.5,0,,,lost-outside,\n4,4,,,found,\n";
        let table = |points, responses| csv(&Output::Points(PointField { picture: (8, 8), points, responses }));
        assert_eq!(table(points, Vec::new()), golden);
        let corner = vec![feature([4.0, 4.0], None, Status::Found, None)];
        let golden = "x_px,y_px,u_px,v_px,status,residual,response\n4,4,,,found,,812.5\n";
        assert_eq!(table(corner, vec![812.5]), golden);
    }

    #[test]
    fn a_track_is_a_row_for_each_frame() {
        let feature = |at, displacement, status| Feature { at, displacement, status, residual: None };
        let points =
            vec![feature([3.0, 2.0], Some([0.5, 0.0]), Status::Tracked), feature([3.5, 2.0], None, Status::Changed)];
        let tracks = vec![Arc::new(Track { first: 4, points })];
        let golden =
            "track,frame,x_px,y_px,u_px,v_px,status,residual\n1,4,3,2,0.5,0,tracked,\n1,5,3.5,2,,,lost-changed,\n";
        assert_eq!(csv(&Output::Tracks(TrackField { picture: (8, 8), first: 4, last: 6, tracks })), golden);
    }

    #[test]
    fn the_extension_chooses() {
        let flow = Flow(Grid::new(2, 2, [600.0, 0.0]));
        for (name, start, told) in [("a.FLO", "PIEH", false), ("b.png", "PNG", true), ("c.npy", "NUMPY", false)] {
            let (bytes, lost) = FlowFormat::of(Path::new(name)).unwrap().encode(&flow).unwrap();
            assert!(String::from_utf8_lossy(&bytes[..6]).contains(start));
            assert_eq!(lost.is_some_and(|lost| lost.starts_with("4 pixels")), told);
        }
        assert_eq!(FlowFormat::of(Path::new("-")), Ok(FlowFormat::Flo));
        assert!(FlowFormat::of(Path::new("a.csv")).unwrap_err().to_string().contains(".npy"));
    }
}
