//! Rectification: homographies that make epipolar lines horizontal and corresponding ones equal rows.
//!
//! R. I. Hartley, Theory and practice of projective rectification, International Journal of Computer Vision 35(2), 1999.

use nalgebra::{Matrix3 as Square, Vector3};

use super::Correspondence;
use super::epipolar::epipoles;
use crate::products::model::{Matrix3, inverse, mapped, product};
use crate::products::registration::Window;

/// The rectification of a pair of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Rectification {
    /// The maps from frames t and t + 1 to their rectified pictures.
    pub maps: [Matrix3; 2],
    /// Width and height of both rectified pictures in px.
    pub size: (usize, usize),
}

/// Why a pair cannot be rectified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The epipole lies inside a picture, here in frame t + `frame`.
    EpipoleInside {
        /// 0 for frame t, 1 for frame t + 1.
        frame: usize,
        /// Its position in px.
        at: [f64; 2],
    },
    /// The matches lie on a plane, so the fundamental matrix is not determined; the share of the inliers that a homography explains.
    Planar(f64),
    /// The maps are singular, or tear a picture.
    Degenerate,
}

fn rows(matrix: &Square<f64>) -> Matrix3 {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]))
}

fn corners((width, height): (usize, usize)) -> [[f64; 2]; 4] {
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]]
}

/// The position of an epipole that lies inside a picture of this size.
fn inside([x, y, w]: [f64; 3], (width, height): (usize, usize)) -> Option<[f64; 2]> {
    let at = [x / w, y / w];
    let is_inside = (0..2).all(|i| at[i] >= -0.5 && at[i] <= [width, height][i] as f64 - 0.5);
    is_inside.then_some(at)
}

/// Rectifies a pair of frames by its fundamental matrix, so that `matches` differ little in x.
///
/// # Errors
/// If an epipole lies inside a picture, or the matrix does not determine the maps.
pub fn rectify(matrix: &Matrix3, matches: &[Correspondence], size: (usize, usize)) -> Result<Rectification, Refusal> {
    let both = epipoles(matrix).ok_or(Refusal::Degenerate)?;
    for (frame, epipole) in both.into_iter().enumerate() {
        if let Some(at) = inside(epipole, size) {
            return Err(Refusal::EpipoleInside { frame, at });
        }
    }
    let second = to_infinity(both[1], size);
    let first = matching(matrix, (both[1], &second), matches).ok_or(Refusal::Degenerate)?;
    framed([first, second], size).ok_or(Refusal::Degenerate)
}

/// The map of frame t + 1 that sends its epipole to infinity along x; about the middle of the picture it is nearly a rotation.
fn to_infinity([x, y, w]: [f64; 3], (width, height): (usize, usize)) -> Matrix3 {
    let middle = [(width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0];
    let [along, across] = [x - w * middle[0], y - w * middle[1]];
    // The smaller of both rotations that bring it onto the x axis.
    let sign = if along < 0.0 { -1.0 } else { 1.0 };
    let length = sign * along.hypot(across);
    let (cos, sin) = (along / length, across / length);
    let shift = [[1.0, 0.0, -middle[0]], [0.0, 1.0, -middle[1]], [0.0, 0.0, 1.0]];
    let turn = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
    let away = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-w / length, 0.0, 1.0]];
    product(&away, &product(&turn, &shift))
}

/// The map of frame t whose rows match those of `second`, with the least squared difference of the x coordinates of `matches`.
fn matching(matrix: &Matrix3, (epipole, second): ([f64; 3], &Matrix3), matches: &[Correspondence]) -> Option<Matrix3> {
    let e = Vector3::from(epipole);
    let fundamental = Square::from_fn(|i, j| matrix[i][j]);
    // F = [e′]× M; adding a multiple of e′ vᵀ makes M regular.
    let scale = fundamental.norm();
    let m = e.cross_matrix() * fundamental / scale + e * Vector3::new(1.0, 1.0, 1.0).transpose();
    let plain = product(second, &rows(&m));
    let plain = oriented(&plain, matches)?;
    let (mut normal, mut right) = (Square::zeros(), Vector3::zeros());
    for of in matches {
        let (Some([x, y]), Some([to, _])) = (mapped(&plain, of.from), mapped(second, of.to)) else { continue };
        let row = Vector3::new(x, y, 1.0);
        normal += row * row.transpose();
        right += row * to;
    }
    let shear = normal.lu().solve(&right)?;
    let shear = [[shear[0], shear[1], shear[2]], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Some(product(&shear, &plain))
}

/// The map with the sign by which matched points lie before the horizon.
fn oriented(map: &Matrix3, matches: &[Correspondence]) -> Option<Matrix3> {
    let [x, y] = matches.first()?.from;
    let w = map[2][0] * x + map[2][1] * y + map[2][2];
    (w.abs() > 1e-12).then(|| map.map(|row| row.map(|entry| entry / w)))
}

/// The maps moved and scaled so that both outlines fit into pictures of about the size of the frames, in common rows.
fn framed(maps: [Matrix3; 2], size: (usize, usize)) -> Option<Rectification> {
    /// A rectified picture is at most this many times as wide or high as a frame.
    const MOST: f64 = 2.0;
    let mut outlines = [[[0.0; 2]; 4]; 2];
    for (outline, map) in outlines.iter_mut().zip(&maps) {
        inverse(map)?;
        for (at, corner) in outline.iter_mut().zip(corners(size)) {
            *at = mapped(map, corner)?;
        }
    }
    let range = |outline: &[[f64; 2]; 4], axis: usize| {
        let ends = outline.iter().map(|at| at[axis]);
        [ends.clone().fold(f64::INFINITY, f64::min), ends.fold(f64::NEG_INFINITY, f64::max)]
    };
    let across = outlines.each_ref().map(|outline| range(outline, 0));
    let down = outlines.each_ref().map(|outline| range(outline, 1));
    let (top, bottom) = (down[0][0].min(down[1][0]), down[0][1].max(down[1][1]));
    let width = across.iter().map(|[left, right]| right - left).fold(0.0, f64::max);
    // Scales the second outline to the area of a frame, without enlarging anything much.
    let area = |outline: &[[f64; 2]; 4]| {
        let next = |i: usize| outline[(i + 1) % 4];
        (0..4).map(|i| outline[i][0] * next(i)[1] - outline[i][1] * next(i)[0]).sum::<f64>().abs() / 2.0
    };
    let scale = ((size.0 * size.1) as f64 / area(&outlines[1])).sqrt();
    let scale = scale.min(MOST * size.0 as f64 / width).min(MOST * size.1 as f64 / (bottom - top));
    if !scale.is_finite() || scale <= 0.0 {
        return None;
    }
    let moved = |i: usize| {
        let place = [[scale, 0.0, -scale * across[i][0]], [0.0, scale, -scale * top], [0.0, 0.0, 1.0]];
        product(&place, &maps[i])
    };
    let pixels = |length: f64| ((scale * length).ceil() as usize + 1).max(1);
    Some(Rectification { maps: [moved(0), moved(1)], size: (pixels(width), pixels(bottom - top)) })
}

impl Rectification {
    /// The pixels of both rectified pictures.
    pub fn window(&self) -> Window {
        Window { origin: [0; 2], size: self.size }
    }

    /// A match in the rectified pictures.
    pub fn of(&self, matched: &Correspondence) -> Option<Correspondence> {
        let [first, second] = &self.maps;
        Some(Correspondence { from: mapped(first, matched.from)?, to: mapped(second, matched.to)? })
    }

    /// The ratio of the magnifications of an area at two corners of a frame, the larger of frames t and t + 1 of this
    /// size; and which of them it is. The map of a pixel at depth w of its horizon magnifies areas by det H / w³.
    pub fn stretch(&self, size: (usize, usize)) -> (usize, f64) {
        let ratio = |map: &Matrix3| {
            let depths = corners(size).map(|[x, y]| (map[2][0] * x + map[2][1] * y + map[2][2]).abs());
            let [least, most] = [f64::min, f64::max].map(|pick| depths.into_iter().fold(depths[0], pick));
            (most / least).powi(3)
        };
        let [first, second] = self.maps.each_ref().map(ratio);
        if first > second { (0, first) } else { (1, second) }
    }

    /// The mean difference of the rows of matches in px.
    pub fn row_error_px(&self, matches: &[Correspondence]) -> Option<f64> {
        let off: Vec<f64> = matches.iter().filter_map(|m| self.of(m)).map(|m| (m.to[1] - m.from[1]).abs()).collect();
        (!off.is_empty()).then(|| off.iter().sum::<f64>() / off.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::super::epipolar::{eight_point, least_sampson, line};
    use super::*;
    use crate::synth::random::{hash, unit};

    const SIZE: (usize, usize) = (640, 480);

    /// Points of a cloud seen by two cameras, the second one turned a little and moved by `t`.
    fn views(t: [f64; 3]) -> Vec<Correspondence> {
        let (sin, cos) = 0.06f64.sin_cos();
        let seen = |p: Vector3<f64>| [500.0 * p[0] / p[2] + 320.0, 500.0 * p[1] / p[2] + 240.0];
        let one = |i: usize| {
            let random = |k: u64| unit(hash(7, i as u64, k)) - 0.5;
            let point = Vector3::new(5.0 * random(0), 4.0 * random(1), 7.0 + 4.0 * random(2));
            let turn = Square::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
                * Square::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos);
            Correspondence { from: seen(point), to: seen(turn * point + Vector3::from(t)) }
        };
        (0..80).map(one).collect()
    }

    #[test]
    fn matches_come_to_equal_rows() {
        for t in [[1.0, 0.1, 0.05], [-0.8, 0.3, 0.1], [0.2, 0.9, -0.1]] {
            let all = views(t);
            let matrix = least_sampson(&all).expect("points in general position");
            let found = rectify(&matrix, &all, SIZE).expect("the epipoles are far outside");
            let off = found.row_error_px(&all).expect("points before the horizon");
            assert!(off < 1e-3, "{t:?}: {off} px");
            assert!(found.size.0 <= 2 * SIZE.0 + 2 && found.size.1 <= 2 * SIZE.1 + 2, "{:?}", found.size);
            // Every point of an epipolar line is mapped to the same row.
            let [a, b, c] = line(&matrix, all[3].from);
            let row = mapped(&found.maps[0], all[3].from).expect("before the horizon")[1];
            for x in [100.0, 300.0, 500.0] {
                let at = if b.abs() > a.abs() { [x, -(a * x + c) / b] } else { [-(b * x + c) / a, x] };
                let to = mapped(&found.maps[1], at).expect("before the horizon");
                assert!((to[1] - row).abs() < 1e-3, "{t:?}: {to:?}, row {row}");
            }
        }
    }

    #[test]
    fn areas_are_stretched_as_an_epipole_comes_near() {
        // Sideways, and so far forward that the epipole 500 t_x / t_z + 320 px lies at 733 px, 94 px beside the picture.
        for (t, least, most) in [([1.0, 0.1, 0.05], 1.0, 2.0), ([0.85, 0.0, 1.0], 8.0, f64::INFINITY)] {
            let all = views(t);
            let matrix = least_sampson(&all).expect("points in general position");
            let found = rectify(&matrix, &all, SIZE).expect("both epipoles are outside");
            let (frame, stretch) = found.stretch(SIZE);
            assert!((least..most).contains(&stretch), "{t:?}: {stretch}");
            // The areas of small squares around two corners.
            let area = |[x, y]: [f64; 2]| {
                let at = |dx: f64, dy: f64| mapped(&found.maps[frame], [x + dx, y + dy]).expect("before the horizon");
                let [a, b, c] = [at(0.0, 0.0), at(0.01, 0.0), at(0.0, 0.01)];
                ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
            };
            let areas = corners(SIZE).map(area);
            let ratio = areas.iter().fold(0.0, |most: f64, a| most.max(*a))
                / areas.iter().fold(f64::INFINITY, |least: f64, a| least.min(*a));
            assert!((ratio / stretch - 1.0).abs() < 0.01, "{t:?}: {stretch}, measured {ratio}");
        }
    }

    #[test]
    fn an_epipole_inside_the_picture_is_refused() {
        let all = views([0.0, 0.05, 1.0]);
        let matrix = eight_point(&all).expect("points in general position");
        let refused = rectify(&matrix, &all, SIZE);
        assert!(matches!(refused, Err(Refusal::EpipoleInside { .. })), "{refused:?}");
    }
}
