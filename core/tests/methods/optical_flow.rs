//! Optical flow against motion that is known exactly, whoever estimates it; and normal flow.

use crate::common::{SIZE, error, explained_at, fact, flow, linear_motion, moving, set, waves};
use motionscope_core::data::{Clip, Flow, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::run::{Cursor, Move};
use motionscope_core::scene::{Focus, Readout};

/// A shift, a turn by 1.2°, a growth by 2 %, and a shear.
fn motions() -> [(&'static str, Clip, Flow); 4] {
    let of = |name, (clip, truth)| (name, clip, truth);
    [
        of("shift", linear_motion([[0.0; 2]; 2], [0.55, -0.35])),
        of("turn", linear_motion([[0.0, -0.021], [0.021, 0.0]], [0.0; 2])),
        of("growth", linear_motion([[0.02, 0.0], [0.0, 0.02]], [0.0; 2])),
        of("shear", linear_motion([[0.015, 0.02], [-0.005, -0.01]], [0.3, -0.6])),
    ]
}

/// How far off each may be on average. Over the windows of Lucas and Kanade and of Farnebäck displacements are taken to be
/// the same, which they are not in a turn.
const MOST_PX: [(&str, f64); 5] =
    [("horn-schunck", 0.05), ("lucas-kanade", 0.07), ("clg", 0.05), ("tv-l1", 0.05), ("farneback", 0.07)];

#[test]
fn shifts_turns_growths_and_shears_are_recovered() {
    for (name, clip, truth) in motions() {
        for (id, most_px) in MOST_PX {
            let off = error(&flow(id, &[], &clip), &truth, 8);
            assert!(off < most_px, "{id}: {off:.3} px off for a {name}");
        }
    }
}

#[test]
fn several_levels_find_what_one_cannot() {
    let (clip, truth) = linear_motion([[0.0; 2]; 2], [6.0, 4.5]);
    let off = |levels| error(&flow("horn-schunck", &[("levels", levels), ("warps", "5")], &clip), &truth, 16);
    let (one, many) = (off("1"), off("3"));
    assert!(many < 0.3 && one > 2.0, "{many:.2} px off with three levels, {one:.2} with one");
}

#[test]
fn normal_flow_is_the_point_of_the_line_nearest_to_zero() {
    let clip = moving(|[x, y]| [x - 0.4, y + 0.3]);
    let [a, b] = clip.pair(0).unwrap();
    let found = flow("normal-flow", &[("sigma", "0"), ("min-gradient", "0")], &clip);
    let at = |frame: &Frame, x: usize, y: usize| f64::from(frame.luma()[(x, y)]);
    for (x, y) in (1..79).flat_map(|y| (1..95).map(move |x| (x, y))) {
        let mean = |x: usize, y: usize| (at(&a, x, y) + at(&b, x, y)) / 2.0;
        let gradient = [(mean(x + 1, y) - mean(x - 1, y)) / 2.0, (mean(x, y + 1) - mean(x, y - 1)) / 2.0];
        let (change, squared) = (at(&b, x, y) - at(&a, x, y), gradient[0].powi(2) + gradient[1].powi(2));
        let Some(uv) = found.at(x, y) else {
            assert!(squared < 1e-6, "({x}, {y}) is left out");
            continue;
        };
        for i in 0..2 {
            let plain = -change * gradient[i] / squared;
            assert!((f64::from(uv[i]) - plain).abs() < 1e-4 * (1.0 + plain.abs()), "{uv:?} at ({x}, {y}), not {plain}");
        }
    }
}

#[test]
fn the_constraint_line_of_a_weak_gradient_is_faint() {
    // A ramp of 1 gray level per px.
    let ramp = |t: usize| Frame::gray(Grid::from_fn(40, 30, |x, _| (60 + x - t) as u8));
    let clip = Clip::from_frames("ramp", vec![ramp(0), ramp(1)]).unwrap();
    for (threshold, weight) in [("4", 0.25), ("0.5", 1.0)] {
        let estimator = set("normal-flow", &[("sigma", "0"), ("min-gradient", threshold)]);
        let readouts = explained_at(&*estimator, &clip, 0, [20.0, 15.0]).readouts;
        let plane = readouts.iter().find_map(|of| if let Readout::Plane(plane) = of { Some(plane) } else { None });
        let lines = &plane.expect("the plane of displacements").lines;
        assert!(lines.len() == 1 && (lines[0].weight - weight).abs() < 1e-3, "{threshold}: {lines:?}");
    }
}

#[test]
fn the_memory_of_a_run_counts_its_pictures() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.4, 0.2]);
    // At least both pictures, their derivatives and the result, in four bytes each.
    for (id, least) in [("normal-flow", 7), ("lucas-kanade", 9), ("horn-schunck", 9), ("harris", 1), ("shi-tomasi", 1)]
    {
        let bytes = set(id, &[]).extent(&clip, 0).unwrap().memory_bytes;
        assert!(bytes >= 4 * least * SIZE.0 * SIZE.1, "{id}: {bytes}");
    }
}

#[test]
fn windows_larger_than_the_picture_and_half_known_truth_show_no_nan() {
    struct HalfKnown;
    impl motionscope_core::data::Truth for HalfKnown {
        fn flow(&self, _: usize) -> Result<Option<std::sync::Arc<Flow>>, motionscope_core::base::Error> {
            let flow = Grid::from_fn(19, 17, |x, _| if x < 9 { [0.5, 0.0] } else { Flow::UNKNOWN });
            Ok(Some(std::sync::Arc::new(Flow(flow))))
        }

        fn kinds(&self) -> Vec<&'static str> {
            vec!["flow"]
        }
    }
    let frame = |t: f64| Frame::gray(Grid::from_fn(19, 17, |x, y| waves(x as f64 - 0.5 * t, y as f64) as u8));
    let clip = Clip::from_frames("small", vec![frame(0.0), frame(1.0)]).unwrap();
    let clip = clip.with_truth(std::sync::Arc::new(HalfKnown));
    let estimator = set("farneback", &[("window", "63"), ("poly-n", "15"), ("poly-sigma", "5")]);
    let mut walk = estimator.walk(&clip, 0).unwrap();
    walk.jump(Move::End);
    assert!(walk.output().flow().expect("a flow").0.cells().iter().flatten().all(|c| c.is_finite() && c.abs() < 3.0));
    for focus in [[3.0, 4.0], [15.0, 4.0]] {
        let step = format!("{:?}", walk.step(Some(Focus::current(focus))));
        assert!(step.contains("Mean endpoint error") && !step.contains("NaN"), "{step}");
    }
}

#[test]
fn a_pixel_without_a_constraint_is_reported_as_such() {
    let flat = Clip::from_frames("flat", vec![Frame::gray(Grid::new(40, 30, 77)); 2]).unwrap();
    let said =
        explained_at(&*set("horn-schunck", &[("solver", "gauss-seidel")]), &flat, 0, [20.0, 15.0]).sentence.plain();
    assert!(said.contains("has no gradient") && said.contains("takes the neighbourhood mean"), "{said}");
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.5, 0.0]);
    for (id, event) in [("horn-schunck", 2), ("tv-l1", 1)] {
        let estimator = set(id, &[("levels", "1"), ("warps", "2"), ("iterations", "40")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        walk.jump(Move::To(Cursor { unit: 50, event }));
        let step = walk.step(Some(Focus::current([95.0, 40.0])));
        assert!(step.sentence.plain().contains("leads out of frame t+1"), "{id}: {}", step.sentence.plain());
        assert_eq!(fact(&step, "I_x, I_y, I_t").as_deref(), Some("unknown: the flow leads out of frame t+1"), "{id}");
    }
}
