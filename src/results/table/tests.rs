use std::sync::Arc;

use motionscope_core::data::Flow;
use motionscope_core::geometry::{Border, Grid};
use motionscope_core::products::table::Cell;
use motionscope_core::products::{BlockGrid, BlockVector, Confidence, Feature, Keypoint, Status, Track};

use super::*;

fn csv(output: &Output) -> String {
    let made = encode(output).expect("a table");
    String::from_utf8(made.files[0].1.clone()).expect("text")
}

#[test]
fn numbers_are_brief_and_exact() {
    let row = [Cell::Int(-3), Cell::Real(1.0 / 3.0), Cell::Single(0.1), Cell::Empty];
    let rows = [row, [Cell::Int(0), Cell::Real(f64::NAN), Cell::Single(-7.0), Cell::Single(f32::INFINITY)]];
    let text = super::csv(&Table::new(["x_px", "cost", "u_px", "v_px"], rows));
    assert_eq!(text, "x_px,cost,u_px,v_px\n-3,0.3333333333333333,0.1,\n0,,-7,\n");
    assert_eq!(super::csv(&Table::new(["cost"], [])), "cost\n");
}

#[test]
fn a_block_is_a_row() {
    let vector = |u, cost| Some(BlockVector { displacement: [u, -1.0], cost, candidates: 9 });
    let output = Output::of(BlockField {
        blocks: BlockGrid { picture: (40, 16), size: 16, step: 16 },
        vectors: vec![vector(2.0, 12.0), None, vector(0.5, 3.25)],
        cost: "SAD",
        border: Border::Replicate,
        filter: motionscope_core::data::Interpolation::Bilinear,
    });
    let golden = "x_px,y_px,width_px,height_px,u_px,v_px,cost\n7.5,7.5,16,16,2,-1,12\n35.5,7.5,8,16,0.5,-1,3.25\n";
    assert_eq!(csv(&output), golden);
}

#[test]
fn a_pixel_of_known_motion_is_a_row() {
    let flow = Flow(Grid::from_fn(2, 2, |x, y| if x == y { [0.5, -1.0] } else { Flow::UNKNOWN }));
    let table = |confidence| csv(&Output::of(DenseField { flow: flow.clone(), confidence }));
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
    let table = |points, keypoints| csv(&Output::of(PointField { picture: (8, 8), points, keypoints }));
    assert_eq!(table(points, Vec::new()), golden);
    let corner = vec![feature([4.0, 4.0], None, Status::Found, None)];
    let golden = "x_px,y_px,u_px,v_px,status,residual,response\n4,4,,,found,,812.5\n";
    assert_eq!(table(corner, vec![Keypoint::of_response(812.5)]), golden);
}

#[test]
fn a_track_is_a_row_for_each_frame() {
    let feature = |at, displacement, status| Feature { at, displacement, status, residual: None };
    let points =
        vec![feature([3.0, 2.0], Some([0.5, 0.0]), Status::Tracked), feature([3.5, 2.0], None, Status::Changed)];
    let tracks = vec![Arc::new(Track { first: 4, points })];
    let golden = "track,frame,x_px,y_px,u_px,v_px,status,residual\n1,4,3,2,0.5,0,tracked,\n1,5,3.5,2,,,lost-changed,\n";
    assert_eq!(csv(&Output::of(TrackField { picture: (8, 8), first: 4, last: 6, tracks })), golden);
}
