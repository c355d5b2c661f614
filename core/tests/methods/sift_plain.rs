//! SIFT against the plainest implementation of Lowe's paper (2004) in double precision: extrema, refinement, orientations, descriptors.

use std::f64::consts::TAU;

use crate::common::{set, waves};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Border, Gray, Grid};
use motionscope_core::products::{Descriptor, Keypoint, PointField};
use nalgebra::{Matrix3, Vector3};

type Image = Grid<f64>;

/// Blobs of many sizes.
fn picture() -> Gray {
    Grid::from_fn(132, 110, |x, y| {
        let (x, y) = (x as f64, y as f64);
        let value = 128.0 + 0.7 * (waves(x, y) - 128.0) + 0.8 * (waves(0.4 * x + 9.0, 0.45 * y) - 128.0);
        value.clamp(0.0, 255.0) as u8
    })
}

fn found(picture: &Gray) -> PointField {
    let clip = Clip::from_frames("made", vec![Frame::gray(picture.clone())]).expect("a frame");
    let output = set("sift", &[("max-points", "100000")]).run(&clip, 0, &Threads::single()).expect("a run");
    output.get::<PointField>().expect("keypoints").clone()
}

/// Convolution with a Gaussian, pixel by pixel.
fn blurred(image: &Image, sigma: f64) -> Image {
    let radius = ((4.0 * sigma).round() as isize).max(1);
    let weight = |i: isize| (-0.5 * (i as f64 / sigma).powi(2)).exp();
    let total: f64 = (-radius..=radius).map(weight).sum();
    let along = |image: &Image, [dx, dy]: [isize; 2]| {
        Grid::from_fn(image.width(), image.height(), |x, y| {
            let at = |i: isize| image.at(x as isize + i * dx, y as isize + i * dy, Border::Mirror);
            (-radius..=radius).map(|i| weight(i) / total * at(i)).sum()
        })
    };
    along(&along(image, [1, 0]), [0, 1])
}

/// The Gaussian images of each octave, six of them.
fn octaves(picture: &Gray) -> Vec<Vec<Image>> {
    // Twice the resolution: pixel x of the picture is pixel 2 x.
    let doubled = Grid::from_fn(2 * picture.width(), 2 * picture.height(), |x, y| {
        let at = |i: usize, j: usize| f64::from(picture.at(i as isize, j as isize, Border::Replicate));
        let corners = [(x / 2, y / 2), (x.div_ceil(2), y / 2), (x / 2, y.div_ceil(2)), (x.div_ceil(2), y.div_ceil(2))];
        corners.iter().map(|(i, j)| at(*i, *j)).sum::<f64>() / 4.0
    });
    let sigma = |level: usize| 1.6 * 2f64.powf(level as f64 / 3.0);
    let mut first = blurred(&doubled, (1.6f64.powi(2) - 1.0).sqrt());
    let mut all = Vec::new();
    loop {
        let mut images = vec![first];
        for level in 1..6 {
            images.push(blurred(&images[level - 1], (sigma(level).powi(2) - sigma(level - 1).powi(2)).sqrt()));
        }
        let next = Grid::from_fn(images[3].width().div_ceil(2), images[3].height().div_ceil(2), |x, y| {
            images[3][(2 * x, 2 * y)]
        });
        all.push(images);
        if next.width().min(next.height()) < 12 || all.len() == 8 {
            return all;
        }
        first = next;
    }
}

/// A refined extremum: octave, its pixel and level, and the offset from there.
#[derive(Clone, Copy, Debug)]
struct Extremum {
    octave: usize,
    pixel: [usize; 3],
    offset: Vector3<f64>,
    response: f64,
}

impl Extremum {
    fn sigma(&self) -> f64 {
        1.6 * 2f64.powf((self.pixel[2] as f64 + self.offset[2]) / 3.0)
    }

    fn at(&self) -> [f64; 2] {
        [0, 1].map(|i| self.pixel[i] as f64 + self.offset[i])
    }

    /// Side of a pixel of its octave in px of the picture.
    fn pixel_px(&self) -> f64 {
        0.5 * 2f64.powi(self.octave as i32)
    }
}

const CONTRAST: f64 = 0.04 * 255.0 / 3.0;
const BORDER: usize = 5;

fn extrema(octave: usize, gaussians: &[Image]) -> Vec<Extremum> {
    let (width, height) = gaussians[0].size();
    let difference = |[x, y, s]: [usize; 3]| gaussians[s + 1][(x, y)] - gaussians[s][(x, y)];
    let mut all: Vec<Extremum> = Vec::new();
    for s in 1..4 {
        for y in BORDER..height.saturating_sub(BORDER) {
            for x in BORDER..width.saturating_sub(BORDER) {
                let here = difference([x, y, s]);
                let around =
                    (0..27).filter(|k| *k != 13).map(|k| difference([x + k % 3 - 1, y + k / 3 % 3 - 1, s + k / 9 - 1]));
                let mut others = around.map(|other| other * here.signum());
                if here.abs() > 0.5 * CONTRAST && others.all(|other| other <= here.abs()) {
                    all.extend(refined(&difference, (octave, [x, y, s]), (width, height)));
                }
            }
        }
    }
    // Neighbours may be refined to the same one.
    all.sort_by_key(|extremum| extremum.pixel);
    all.dedup_by_key(|extremum| extremum.pixel);
    all
}

fn refined(
    difference: &impl Fn([usize; 3]) -> f64,
    (octave, mut pixel): (usize, [usize; 3]),
    (width, height): (usize, usize),
) -> Option<Extremum> {
    for _ in 0..5 {
        let at = |by: [isize; 3]| {
            difference([0, 1, 2].map(|i| pixel[i].checked_add_signed(by[i]).expect("inside the border")))
        };
        let step = |i: usize, by: isize| {
            let mut steps = [0; 3];
            steps[i] = by;
            steps
        };
        let gradient = Vector3::from_fn(|i, _| (at(step(i, 1)) - at(step(i, -1))) / 2.0);
        let hessian = Matrix3::from_fn(|i, j| {
            if i == j {
                return at(step(i, 1)) + at(step(i, -1)) - 2.0 * at([0; 3]);
            }
            let both = |a: isize, b: isize| {
                let mut steps = step(i, a);
                steps[j] = b;
                at(steps)
            };
            (both(1, 1) - both(-1, 1) - both(1, -1) + both(-1, -1)) / 4.0
        });
        let offset = -(hessian.try_inverse()? * gradient);
        if offset.iter().all(|c| c.abs() < 0.5) {
            let response = (at([0; 3]) + 0.5 * gradient.dot(&offset)).abs();
            let (trace, determinant) =
                (hessian[(0, 0)] + hessian[(1, 1)], hessian[(0, 0)] * hessian[(1, 1)] - hessian[(0, 1)].powi(2));
            let is_edge = determinant <= 0.0 || trace * trace / determinant >= 11.0 * 11.0 / 10.0;
            return (response >= CONTRAST && !is_edge).then_some(Extremum { octave, pixel, offset, response });
        }
        let moved = [0, 1, 2].map(|i| pixel[i] as f64 + offset[i].round());
        let highest = [(width - BORDER - 1) as f64, (height - BORDER - 1) as f64, 3.0];
        let lowest = [BORDER as f64, BORDER as f64, 1.0];
        if (0..3).any(|i| !(lowest[i]..=highest[i]).contains(&moved[i])) {
            return None;
        }
        pixel = moved.map(|c| c as usize);
    }
    None
}

/// Gradient of a Gaussian image: magnitude and direction.
fn gradient(image: &Image, x: usize, y: usize) -> (f64, f64) {
    let (gx, gy) = (image[(x + 1, y)] - image[(x - 1, y)], image[(x, y + 1)] - image[(x, y - 1)]);
    (gx.hypot(gy), gy.atan2(gx))
}

/// The peaks of the orientation histogram in radians.
fn orientations(image: &Image, of: &Extremum) -> Vec<f64> {
    let (spread, [x, y, _]) = (1.5 * of.sigma(), of.pixel);
    let radius = (3.0 * spread).round() as isize;
    let mut raw = [0.0; 36];
    for (i, j) in (-radius..=radius).flat_map(|j| (-radius..=radius).map(move |i| (i, j))) {
        let (u, v) = (x as isize + i, y as isize + j);
        if u < 1 || v < 1 || u + 1 >= image.width() as isize || v + 1 >= image.height() as isize {
            continue;
        }
        let (magnitude, direction) = gradient(image, u as usize, v as usize);
        let bin = (direction * 36.0 / TAU).round().rem_euclid(36.0) as usize;
        raw[bin % 36] += magnitude * (-0.5 * ((i * i + j * j) as f64) / (spread * spread)).exp();
    }
    let smooth: Vec<f64> = (0..36)
        .map(|k| [1.0, 4.0, 6.0, 4.0, 1.0].iter().enumerate().map(|(i, w)| w / 16.0 * raw[(k + 34 + i) % 36]).sum())
        .collect();
    let highest = smooth.iter().copied().fold(0.0, f64::max);
    let peak = |k: usize| {
        let [left, here, right] = [k + 35, k, k + 1].map(|i| smooth[i % 36]);
        let is_peak = here > left && here > right && here >= 0.8 * highest;
        is_peak.then(|| ((k as f64 + 0.5 * (left - right) / (left - 2.0 * here + right)) * TAU / 36.0).rem_euclid(TAU))
    };
    (0..36).filter_map(peak).collect()
}

/// The 128 values, normalised, limited to 0.2 and normalised again.
fn descriptor(image: &Image, of: &Extremum, angle: f64) -> Vec<f64> {
    let (cell, at, (sin, cos)) = (3.0 * of.sigma(), of.at(), angle.sin_cos());
    let mut values = vec![0.0; 128];
    for (x, y) in (1..image.height() - 1).flat_map(|y| (1..image.width() - 1).map(move |x| (x, y))) {
        let [dx, dy] = [x as f64 - at[0], y as f64 - at[1]];
        let (c, r) = ((cos * dx + sin * dy) / cell, (cos * dy - sin * dx) / cell);
        if c.abs() >= 2.5 || r.abs() >= 2.5 {
            continue;
        }
        let (magnitude, direction) = gradient(image, x, y);
        let weight = magnitude * (-(c * c + r * r) / 8.0).exp();
        let bin = (direction - angle).rem_euclid(TAU) / TAU * 8.0;
        for (i, value) in values.iter_mut().enumerate() {
            let near = |distance: f64| (1.0 - distance.abs()).max(0.0);
            let turn = (bin - (i % 8) as f64 + 4.0).rem_euclid(8.0) - 4.0;
            *value += weight * near(c - (i / 8 % 4) as f64 + 1.5) * near(r - (i / 32) as f64 + 1.5) * near(turn);
        }
    }
    let normalised = |values: Vec<f64>| {
        let length = values.iter().map(|v| v * v).sum::<f64>().sqrt();
        values.into_iter().map(|v| v / length).collect::<Vec<_>>()
    };
    normalised(normalised(values).into_iter().map(|v| v.min(0.2)).collect())
}

#[test]
fn keypoints_orientations_and_descriptors_are_those_of_the_paper() {
    let picture = picture();
    let field = found(&picture);
    let octaves = octaves(&picture);
    let plain: Vec<Extremum> = octaves.iter().enumerate().flat_map(|(i, images)| extrema(i, images)).collect();
    let mut taken = vec![false; field.points.len()];
    let mut missed = Vec::new();
    for extremum in &plain {
        let image = &octaves[extremum.octave][extremum.pixel[2]];
        let place = extremum.at().map(|c| c * extremum.pixel_px());
        for angle in orientations(image, extremum) {
            let is_same = |(i, keypoint): (usize, &Keypoint)| {
                let [x, y] = field.points[i].at.map(f64::from);
                let turned =
                    (f64::from(keypoint.angle_rad.expect("oriented")) - angle + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
                let scale = f64::from(keypoint.scale_px.expect("a scale")) / (extremum.sigma() * extremum.pixel_px());
                // A direction on the border of two bins of 10° may be rounded into either, which turns the peak a little.
                let near =
                    (x - place[0]).hypot(y - place[1]) < 0.01 && (scale - 1.0).abs() < 0.01 && turned.abs() < 0.02;
                near && (f64::from(keypoint.response) / extremum.response - 1.0).abs() < 0.01
            };
            let Some((i, keypoint)) = field.keypoints.iter().enumerate().find(|pair| is_same(*pair)) else {
                missed.push((place, extremum.sigma(), angle));
                continue;
            };
            taken[i] = true;
            let Some(Descriptor::Reals(values)) = &keypoint.descriptor else { panic!("128 values") };
            let plain = descriptor(image, extremum, f64::from(keypoint.angle_rad.expect("oriented")));
            let off = values.iter().zip(&plain).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
            assert!(values.len() == 128 && off < 2e-3, "descriptor at {place:?}: {off}");
        }
    }
    assert!(plain.len() > 40, "{} extrema", plain.len());
    assert!(missed.is_empty(), "{missed:?}");
    assert!(
        taken.iter().all(|taken| *taken),
        "{} of {} are not those of the paper",
        taken.iter().filter(|t| !**t).count(),
        taken.len()
    );
}
