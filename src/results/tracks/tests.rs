use std::sync::Arc;

use motionscope_core::data::{Blob, Detection};
use motionscope_core::geometry::Bounds;
use motionscope_core::params::{Line, Zones};
use motionscope_core::products::objects::trajectory::{Places, Trajectory};
use motionscope_core::products::{ObjectFrame, Region, RegionFrame, Watched};

use super::*;

fn csv_of(field: ObjectField) -> String {
    table::csv(&Product::table(&field).expect("a table"))
}

fn field() -> ObjectField {
    let bounds = Bounds { min: [-0.5, 9.5], max: [3.5, 12.0] };
    let blob = Blob { label: 1, area_px: 10, radii: [2.0, 1.0], angle_rad: 0.0, gray: 90.0, background_px: [0.0; 2] };
    let found = Detection { bounds, center: bounds.center(), score: 0.5, blob: Some(blob), deviation_px: None };
    let object = |id, status| Object {
        id,
        bounds,
        status,
        position: [1.5, 10.75],
        velocity: Some([1.0, -0.5]),
        covariance: Some([[4.0, 0.0], [0.0, 2.25]]),
        detection: None,
    };
    let all =
        vec![object(3, TrackStatus::Confirmed), object(4, TrackStatus::Coasting), object(5, TrackStatus::Tentative)];
    let frames = vec![
        Arc::new(ObjectFrame { mask: None, detections: vec![found], objects: Vec::new() }),
        Arc::new(ObjectFrame { mask: None, detections: Vec::new(), objects: all }),
    ];
    ObjectField {
        followed: Followed::All,
        picture: (32, 24),
        first: 4,
        frames,
        trajectories: Vec::new(),
        watched: Watched::default(),
    }
}

#[test]
fn results_count_frames_and_pixels_from_one() {
    assert_eq!(mot(&field()), Ok("6,3,1,11,4,2.5,1,-1,-1,-1\n".into()));
    let nobody = ObjectField { followed: Followed::Nothing, ..field() };
    assert!(mot(&nobody).unwrap_err().to_string().contains("choose a tracker"));
}

#[test]
fn a_tracked_region_is_one_object() {
    let at = |x: f32, is_lost| {
        let region = Region { center: [x, 8.0], size: [6.0, 4.0], angle_rad: 0.0 };
        RegionFrame { region, similarity: 0.9, is_lost }
    };
    let frames = vec![at(5.0, false), at(6.5, false), at(6.5, true)];
    let output = Output::of(RegionField { picture: (32, 24), first: 2, object: Some(7), frames });
    let rows = mot(&super::field(&output).expect("a track")).expect("a track");
    assert_eq!(rows, "3,1,3.5,7.5,6,4,1,-1,-1,-1\n4,1,5,7.5,6,4,1,-1,-1,-1\n", "where it is lost is no result");
}

#[test]
fn a_table_of_trajectories_tells_what_became_of_each() {
    let lines = [Line { from: [10.0, 9.0], to: [10.0, 0.0] }].into_iter().collect();
    let places = Places { lines, zones: Zones::default(), window: 3 };
    let mut of = Trajectory { id: 4, ..Trajectory::default() };
    for (t, x) in [(6, 8.0), (7, 9.0), (8, 12.0)] {
        of.add(t, [x, 5.0], &places);
    }
    let all = csv_of(ObjectField { trajectories: vec![Arc::new(of)], ..field() });
    let rows: Vec<_> = all.lines().collect();
    assert_eq!(rows[1..], ["6,4,8,5,,,,0,0,", "7,4,9,5,1,0,1,0,0,", "8,4,12,5,2,0,3,1,0,"]);
}

#[test]
fn a_table_tells_of_objects_or_else_of_detections() {
    let all = csv_of(field());
    assert!(all.contains("\n5,4,1.5,10.75,1,-0.5,-0.5,9.5,4,2.5,coasting,2,1.5\n"), "{all}");
    let mut found = field();
    found.frames.truncate(1);
    assert!(
        csv_of(found.clone()).starts_with("frame,id,x_px,y_px,u_px_per_frame,"),
        "whoever tracks nobody has the same columns"
    );
    found.followed = Followed::Nothing;
    let all = csv_of(found);
    assert!(all.contains("\n4,1.5,10.75,-0.5,9.5,4,2.5,0.5,10,0,2,90\n"), "{all}");
}

#[test]
fn objects_are_rows_of_numbers() {
    let bytes = npy(&field());
    let header = std::str::from_utf8(&bytes[10..128]).unwrap();
    assert!(header.starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 11), }"), "{header}");
    let numbers: Vec<f64> = bytes[128..].chunks(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect();
    assert_eq!(numbers[..11], [5.0, 3.0, 1.5, 10.75, 1.0, -0.5, -0.5, 9.5, 4.0, 2.5, 1.0]);
    assert_eq!(numbers.chunks(11).map(|row| row[10]).collect::<Vec<_>>(), [1.0, 2.0, 0.0]);
}
