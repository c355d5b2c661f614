//! The combined local-global method and TV-L1, against plain references, exact motion and what is known of their energies.

use std::sync::Arc;

use crate::common::{SIZE, central, error, flow, plane, plotted, set, waves};
use motionscope_core::base::Error;
use motionscope_core::data::{Clip, Flow, Frame, Truth};
use motionscope_core::geometry::Grid;
use motionscope_core::run::{AnyEstimator, Cursor, Move};
use motionscope_core::scene::{self, Focus, Step};

/// Waves of which pixel (x, y) of frame t + 1 shows what lay at `before(x, y)` in frame t, and noise of so many gray levels.
fn moving(before: impl Fn(f64, f64) -> (f64, f64), noise: f64) -> Clip {
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1u32 << 31)
    };
    let mut frame = |place: &dyn Fn(f64, f64) -> (f64, f64)| {
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (x, y) = place(x as f64, y as f64);
            // Four of them are nearly normal.
            let normal = (0..4).map(|_| random()).sum::<f64>() - 2.0;
            (waves(x, y) + noise * 3f64.sqrt() * normal + 0.5).clamp(0.0, 255.0) as u8
        }))
    };
    let frames = vec![frame(&|x, y| (x, y)), frame(&before)];
    Clip::from_frames("waves", frames).expect("frames of one size")
}

fn even(motion: [f32; 2]) -> Flow {
    Flow(Grid::new(SIZE.0, SIZE.1, motion))
}

/// One level, one warp, derivatives that are easily written down.
const PLAIN: [(&str, &str); 4] = [("levels", "1"), ("warps", "1"), ("sigma", "0"), ("derivatives", "central")];

/// Plain pictures: a value for each place, beyond the edge that at the edge.
struct Plain {
    width: isize,
    height: isize,
    values: Vec<f64>,
}

impl Plain {
    fn new(f: impl Fn(isize, isize) -> f64) -> Self {
        let (width, height) = (SIZE.0 as isize, SIZE.1 as isize);
        let values = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| f(x, y)).collect();
        Self { width, height, values }
    }

    fn at(&self, x: isize, y: isize) -> f64 {
        self.values[(y.clamp(0, self.height - 1) * self.width + x.clamp(0, self.width - 1)) as usize]
    }

    /// Beyond the edge what lies as far inside it, the edge once.
    fn mirrored(&self, x: isize, y: isize) -> f64 {
        let inside = |i: isize, n: isize| {
            if i < 0 {
                -i
            } else if i >= n {
                2 * (n - 1) - i
            } else {
                i
            }
        };
        self.at(inside(x, self.width), inside(y, self.height))
    }
}

/// I_x, I_y and I_t by central differences, of the mean of both frames; at the edge, to one side.
fn derivatives(clip: &Clip) -> [Plain; 3] {
    let [a, b] = clip.pair(0).expect("a pair");
    let value = |frame: &Frame, x: isize, y: isize| f64::from(frame.luma()[(x as usize, y as usize)]);
    let mean = Plain::new(|x, y| (value(&a, x, y) + value(&b, x, y)) / 2.0);
    [
        Plain::new(|x, y| central(|x| mean.at(x, y), x, SIZE.0)),
        Plain::new(|x, y| central(|y| mean.at(x, y), y, SIZE.1)),
        Plain::new(|x, y| value(&b, x, y) - value(&a, x, y)),
    ]
}

fn far_off(found: &Flow, plain: &[Plain; 2]) -> f64 {
    let parts = found.0.cells().iter().enumerate();
    let off = parts.map(|(i, uv)| (0..2).map(|k| (f64::from(uv[k]) - plain[k].values[i]).abs()).fold(0.0, f64::max));
    off.fold(0.0, f64::max)
}

/// The combined local-global method as plainly as can be: tensors by a double sum over the window, Jacobi iterations by Cramer's
/// rule, all in f64.
fn plain_clg(clip: &Clip, (alpha, rho): (f64, f64), iterations: usize) -> [Plain; 2] {
    let of = derivatives(clip);
    let reach = (3.0 * rho).ceil() as isize;
    let weight = |i: isize| (-(i * i) as f64 / (2.0 * rho * rho)).exp();
    let total: f64 = (-reach..=reach).map(weight).sum();
    let tensor = |a: usize, b: usize| {
        Plain::new(|x, y| {
            let window = (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j)));
            let product = |x, y| of[a].mirrored(x, y) * of[b].mirrored(x, y);
            window.map(|(i, j)| weight(i) * weight(j) / (total * total) * product(x + i, y + j)).sum()
        })
    };
    let [xx, xy, yy, xt, yt] = [tensor(0, 0), tensor(0, 1), tensor(1, 1), tensor(0, 2), tensor(1, 2)];
    let mut field = [Plain::new(|_, _| 0.0), Plain::new(|_, _| 0.0)];
    for _ in 0..iterations {
        let solved = |x: isize, y: isize| {
            let [u, v] = field.each_ref().map(|part| {
                let at = |i: isize, j: isize| part.at(x + i, y + j);
                (at(1, 0) + at(-1, 0) + at(0, 1) + at(0, -1)) / 6.0
                    + (at(1, 1) + at(-1, 1) + at(1, -1) + at(-1, -1)) / 12.0
            });
            let s = alpha * alpha;
            let (a, b, d) = (xx.at(x, y) + s, xy.at(x, y), yy.at(x, y) + s);
            let (e, f) = (s * u - xt.at(x, y), s * v - yt.at(x, y));
            [(e * d - b * f) / (a * d - b * b), (a * f - b * e) / (a * d - b * b)]
        };
        field = [Plain::new(|x, y| solved(x, y)[0]), Plain::new(|x, y| solved(x, y)[1])];
    }
    field
}

#[test]
fn clg_agrees_with_a_plain_one() {
    let clip = moving(|x, y| (x - 0.3 + 0.01 * (y - 40.0), y + 0.2), 0.0);
    let settings =
        [&PLAIN[..], &[("alpha", "10"), ("rho", "1.3"), ("solver", "jacobi"), ("iterations", "23")]].concat();
    let off = far_off(&flow("clg", &settings, &clip), &plain_clg(&clip, (10.0, 1.3), 23));
    assert!(off < 1e-4, "{off} px apart");
}

#[test]
fn clg_without_a_window_is_horn_schunck() {
    let clip = moving(|x, y| (x - 1.3 + 0.01 * (y - 40.0), y + 0.7), 0.0);
    for solver in ["jacobi", "gauss-seidel", "sor"] {
        let settings = [("solver", solver), ("iterations", "30")];
        let horn_schunck = flow("horn-schunck", &settings, &clip);
        let clg = flow("clg", &[&settings[..], &[("rho", "0")]].concat(), &clip);
        let pairs = clg.0.cells().iter().flatten().zip(horn_schunck.0.cells().iter().flatten());
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{solver}: {off} px apart");
    }
}

#[test]
fn all_solvers_of_clg_come_to_the_same_field() {
    let clip = moving(|x, y| (x - 0.02 * (x - 48.0) - 0.3, y - 0.02 * (y - 40.0)), 0.0);
    let solve = |solver, iterations| {
        let more = [("alpha", "10"), ("solver", solver), ("iterations", iterations), ("relaxation", "1.7")];
        flow("clg", &[&PLAIN[..], &more].concat(), &clip)
    };
    let end = solve("jacobi", "1000");
    for (solver, iterations) in [("gauss-seidel", "600"), ("sor", "300")] {
        let other = solve(solver, iterations);
        let pairs = other.0.cells().iter().flatten().zip(end.0.cells().iter().flatten());
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{solver}: {off} px apart");
    }
}

#[test]
fn a_window_takes_noise_away() {
    let clip = moving(|x, y| (x - 0.4, y + 0.3), 12.0);
    let truth = even([0.4, -0.3]);
    let settings = [("alpha", "4"), ("sigma", "0")];
    let [alone, together] =
        ["0", "2"].map(|rho| error(&flow("clg", &[&settings[..], &[("rho", rho)]].concat(), &clip), &truth, 8));
    assert!(together < 0.7 * alone, "{together} px off with a window, {alone} without");
}

/// TV-L1 as plainly as can be: three cases, forward differences and their divergence, all in f64.
fn plain_tv_l1(clip: &Clip, [lambda, theta, tau]: [f64; 3], iterations: usize) -> [Plain; 2] {
    let [ix, iy, it] = derivatives(clip);
    let zero = || Plain::new(|_, _| 0.0);
    let (mut field, mut p) = ([zero(), zero()], [[zero(), zero()], [zero(), zero()]]);
    for _ in 0..iterations {
        let fitted = |x: isize, y: isize| {
            let gradient = [ix.at(x, y), iy.at(x, y)];
            let squared = gradient[0] * gradient[0] + gradient[1] * gradient[1];
            let rho = gradient[0] * field[0].at(x, y) + gradient[1] * field[1].at(x, y) + it.at(x, y);
            [0, 1].map(|i| {
                let before = field[i].at(x, y);
                if rho < -lambda * theta * squared {
                    before + lambda * theta * gradient[i]
                } else if rho > lambda * theta * squared {
                    before - lambda * theta * gradient[i]
                } else if squared > 0.0 {
                    before - rho * gradient[i] / squared
                } else {
                    before
                }
            })
        };
        let inside = |x: isize, y: isize, part: &Plain| if x < 0 || y < 0 { 0.0 } else { part.at(x, y) };
        let smoothed = [0, 1].map(|i| {
            Plain::new(|x, y| {
                let [across, down] = &p[i];
                let divergence = across.at(x, y) - inside(x - 1, y, across) + down.at(x, y) - inside(x, y - 1, down);
                fitted(x, y)[i] + theta * divergence
            })
        });
        field = smoothed;
        p = [0, 1].map(|i| {
            let gradient = |x: isize, y: isize| {
                let here = field[i].at(x, y);
                [field[i].at(x + 1, y) - here, field[i].at(x, y + 1) - here]
            };
            [0, 1].map(|along| {
                Plain::new(|x, y| {
                    let g = gradient(x, y);
                    let length = (g[0] * g[0] + g[1] * g[1]).sqrt();
                    (p[i][along].at(x, y) + tau / theta * g[along]) / (1.0 + tau / theta * length)
                })
            })
        });
    }
    field
}

#[test]
fn tv_l1_agrees_with_a_plain_one() {
    let clip = moving(|x, y| (x - 0.3 + 0.01 * (y - 40.0), y + 0.2), 0.0);
    let settings = [&PLAIN[..], &[("lambda", "0.1"), ("theta", "0.3"), ("tau", "0.2"), ("iterations", "31")]].concat();
    let off = far_off(&flow("tv-l1", &settings, &clip), &plain_tv_l1(&clip, [0.1, 0.3, 0.2], 31));
    assert!(off < 1e-4, "{off} px apart");
}

#[test]
fn tv_l1_keeps_a_border_of_motion_sharp() {
    // The left half goes up, the right half down.
    let motion = |x: f64| if x < 48.0 { -0.8 } else { 0.8 };
    let clip = moving(|x, y| (x, y - motion(x)), 0.0);
    let truth = Flow(Grid::from_fn(SIZE.0, SIZE.1, |x, _| {
        if (44..52).contains(&x) { [0.0, motion(x as f64) as f32] } else { Flow::UNKNOWN }
    }));
    let [sharp, smooth] = ["tv-l1", "horn-schunck"].map(|id| error(&flow(id, &[], &clip), &truth, 8));
    assert!(sharp < 0.5 * smooth && sharp < 0.25, "{sharp} px off at the border, Horn and Schunck's method {smooth}");
}

/// Step `event` of the unit `unit` at a pixel.
fn step(estimator: &dyn AnyEstimator, clip: &Clip, cursor: Cursor, focus: [f32; 2]) -> Step {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    walk.jump(Move::To(cursor));
    walk.step(Some(Focus::current(focus)))
}

#[test]
fn what_fits_is_the_best_that_the_data_and_the_field_allow() {
    let clip = moving(|x, y| (x - 0.5 + 0.02 * (x - 48.0), y + 0.4), 4.0);
    let (lambda, theta) = (0.1, 0.3);
    let estimator = set("tv-l1", &[&PLAIN[..], &[("lambda", "0.1"), ("theta", "0.3"), ("iterations", "9")]].concat());
    let (mut near, mut far) = (0, 0);
    for unit in [0, 3, 8] {
        for place in [[20, 20], [40, 31], [55, 60], [70, 12], [33, 47], [80, 70]] {
            let step =
                step(&*estimator, &clip, Cursor { unit, event: 1 + usize::from(unit == 0) }, place.map(|c| c as f32));
            let plane = plane(&step);
            let point = |name: &str| plane.points.iter().find(|(known, ..)| *known == name).expect("a point").2;
            let ([u, v], [fit_u, fit_v], [a, b, c]) =
                (point("before"), point("auxiliary flow f"), plane.lines[0].factors);
            let coupled = |x: f32, y: f32| {
                lambda * (a * x + b * y + c).abs() + ((x - u).powi(2) + (y - v).powi(2)) / (2.0 * theta)
            };
            let least = coupled(fit_u, fit_v);
            for (i, j) in (-20..=20).flat_map(|j| (-20..=20).map(move |i| (i, j))) {
                let other = coupled(fit_u + i as f32 * 0.05, fit_v + j as f32 * 0.05);
                assert!(least <= other + 1e-4, "{least} at what fits, {other} beside it");
            }
            // What is said of the pixel is what happens to it.
            let is_near = (a * fit_u + b * fit_v + c).abs() < 1e-2;
            let said = step.sentence.plain();
            assert_eq!(said.contains("all the way to the constraint line"), is_near, "{said}");
            *(if is_near { &mut near } else { &mut far }) += 1;
        }
    }
    assert!(near > 2 && far > 2, "{near} go to the line, {far} as far as they may");
}

#[test]
fn the_energy_of_clg_never_rises() {
    let clip = moving(|x, y| (x - 0.4, y + 0.02 * (x - 48.0)), 4.0);
    for solver in ["jacobi", "gauss-seidel", "sor"] {
        let settings = [&PLAIN[..2], &[("iterations", "60"), ("solver", solver)]].concat();
        let energy = plotted(&*set("clg", &settings), &clip, "Energy per pixel", "energy");
        assert_eq!(energy.len(), 60);
        assert!(energy.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-5)), "{solver}: {energy:?}");
    }
}

#[test]
fn the_energy_of_tv_l1_settles_at_its_least_whatever_the_step() {
    // From one iteration to the next it may rise, since field and dual take turns. It ends at its least, which is the same
    // for any step size: there is but one.
    let clip = moving(|x, y| (x - 0.4, y + 0.02 * (x - 48.0)), 4.0);
    let energy = |tau, iterations| {
        let settings = [&PLAIN[..], &[("tau", tau), ("theta", "0.05"), ("iterations", iterations)]].concat();
        plotted(&*set("tv-l1", &settings), &clip, "Energy per pixel", "energy")
    };
    let long = energy("0.25", "800");
    let (end, least) = (long[799], long.iter().copied().fold(f32::MAX, f32::min));
    assert!(end <= 1.001 * least && end < 0.7 * long[0], "{} at first, at least {least}, {end} at the end", long[0]);
    let other = energy("0.1", "1000")[999];
    assert!((other - end).abs() < 0.005 * end, "{end} and {other}");
}

/// A truth that is not known everywhere.
struct Holes;

impl Truth for Holes {
    fn flow(&self, _: usize) -> Result<Option<Arc<Flow>>, Error> {
        let known = |x: usize, y: usize| !(x + y).is_multiple_of(3) && x > 10;
        let flow = Grid::from_fn(SIZE.0, SIZE.1, |x, y| if known(x, y) { [0.4, -0.3] } else { Flow::UNKNOWN });
        Ok(Some(Arc::new(Flow(flow))))
    }

    fn kinds(&self) -> Vec<&'static str> {
        vec!["flow"]
    }
}

#[test]
fn pixels_of_unknown_truth_are_left_out_of_the_error() {
    let clip = moving(|x, y| (x - 0.4, y + 0.3), 0.0).with_truth(Arc::new(Holes));
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "2"), ("warps", "2"), ("iterations", "20")]);
        let error = plotted(&*estimator, &clip, "Mean endpoint error", "mean endpoint error");
        assert_eq!(error.len(), 80);
        assert!(error.iter().all(|e| e.is_finite()) && error[79] < 0.3 * error[0], "{id}: {error:?}");
        let step = step(&*estimator, &clip, Cursor { unit: 70, event: usize::MAX }, [3.0, 0.0]);
        assert!(plane(&step).points.iter().all(|(name, ..)| *name != "true flow"), "{id} knows what nobody knows");
    }
}

#[test]
fn every_level_shows_what_was_found_where_the_pixel_lies() {
    let clip = moving(|x, y| (x - 2.5, y + 1.5), 0.0);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "3"), ("warps", "2"), ("iterations", "30")]);
        let mut walk = estimator.walk(&clip, 0).expect("a walk");
        let levels = walk.scene(None).levels.expect("a pyramid");
        assert_eq!((levels.at_work, levels.size(0), levels.size(1), levels.size(2)), (0, SIZE, (48, 40), (24, 20)));
        assert_eq!(levels.pair(0)[0], clip.frame(0).expect("a frame"), "the picture itself");
        // A walk to the second level's last iteration, and one that comes back to it.
        for cursor in [119, 179, 119].map(|unit| Cursor { unit, event: usize::MAX }) {
            walk.jump(Move::To(cursor));
            let (level, focus) = (if cursor.unit == 119 { 1 } else { 0 }, [41.0, 30.0]);
            assert_eq!(walk.scene(Some(Focus::current(focus))).levels.expect("a pyramid").at_work, level);
            let step = walk.step(Some(Focus::current(focus)));
            let stack = step.readouts.iter().find_map(|readout| match readout {
                scene::Readout::Stack(stack) => Some(stack),
                _ => None,
            });
            for (n, floor) in stack.expect("a stack").floors.iter().enumerate() {
                let [min, max] = floor.at_hand.expect("a pixel");
                let scale = (1 << n) as f32;
                // In the picture the pixel of the level reaches over that which is pointed at; on a finer level than that at
                // work it is one of those that make up the one that is explained.
                let (place, beside) = (focus.map(|c| (c + 0.5) / scale - 0.5), if n < level { 1.0 } else { 0.0 });
                let inside = |i: usize| min[i] - beside <= place[i] && place[i] <= max[i] + beside;
                assert!((0..2).all(inside), "{id}: {min:?} on level {n}");
                assert_eq!(floor.vector.is_some(), n >= level, "{id}: level {n}");
                let Some(([u, v], _)) = floor.vector else { continue };
                let off = (u * scale - 2.5).hypot(v * scale + 1.5);
                assert!(off < 0.5, "{id}: ({u}, {v}) on level {n}");
            }
        }
        let alone = set(id, &[("levels", "1"), ("iterations", "1")]);
        assert_eq!(alone.walk(&clip, 0).expect("a walk").scene(None).levels, None, "one level is no pyramid");
    }
}
