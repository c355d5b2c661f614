//! The path of a camera through a clip: the motions of consecutive pairs of frames, chained, and pictures made with them.

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::model::{IDENTITY, Matrix3, inverse, mapped, normalised, product};
use super::registration::{Window, inside, registered};
use super::{Assessment, Cell, Figure, Measure, Motion, Product, ProductKind, Reference, Table};
use crate::base::{Error, words};
use crate::data::{Clip, Frame};

/// The apparent motion of the background through a clip, as a moving camera causes it.
#[derive(Clone, Debug, PartialEq)]
pub struct PathField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame.
    pub first: usize,
    /// The map from each frame to the next.
    pub motions: Vec<Matrix3>,
    /// The map from each frame to its stabilised one; one entry for each frame that is stabilised already.
    pub corrections: Vec<Matrix3>,
    /// The pictures made with it.
    pub views: Views,
}

/// Pictures made with a path.
#[derive(Clone, Debug, Default)]
pub enum Views {
    /// None yet.
    #[default]
    None,
    /// The frames of a clip, warped by the corrections when they are asked for.
    Stabilized(Clip),
    /// One picture of all frames.
    Mosaic(Arc<Frame>),
}

/// Two are equal if they show the same: the clip of a run is always the same.
impl PartialEq for Views {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::None, Self::None) | (Self::Stabilized(_), Self::Stabilized(_)) => true,
            (Self::Mosaic(a), Self::Mosaic(b)) => a == b,
            _ => false,
        }
    }
}

/// The maps from the first frame to each frame, given those from each frame to the next.
pub fn chained(motions: &[Matrix3]) -> Vec<Matrix3> {
    let mut all = vec![IDENTITY];
    for motion in motions {
        let before = all[all.len() - 1];
        all.push(normalised(&product(motion, &before)).unwrap_or(before));
    }
    all
}

/// The middle of a picture.
pub fn middle((width, height): (usize, usize)) -> [f64; 2] {
    [width, height].map(|extent| (extent as f64 - 1.0) / 2.0)
}

/// The path of the middle of the picture in the coordinates of the first frame, given the maps from the first frame to each: where the
/// camera looks at. Unknown places are those of the frame before.
pub fn track(to_frames: &[Matrix3], size: (usize, usize)) -> Vec<[f64; 2]> {
    let mut all: Vec<[f64; 2]> = Vec::with_capacity(to_frames.len());
    for map in to_frames {
        let place = inverse(map).and_then(|back| mapped(&back, middle(size)));
        all.push(place.or(all.last().copied()).unwrap_or(middle(size)));
    }
    all
}

/// The jitter of a path: root mean square of its second differences in px; `None` for fewer than three places.
pub fn jitter(path: &[[f64; 2]]) -> Option<f64> {
    let squared = |i: usize| (0..2).map(|c| (path[i + 1][c] - 2.0 * path[i][c] + path[i - 1][c]).powi(2)).sum::<f64>();
    let inner = 1..path.len().saturating_sub(1);
    let count = inner.len();
    (count > 0).then(|| (inner.map(squared).sum::<f64>() / count as f64).sqrt())
}

/// The share of a picture that a frame warped by `correction` leaves empty, sampled on a lattice.
pub(crate) fn empty_share(correction: &Matrix3, size: (usize, usize)) -> f64 {
    const CELLS: usize = 48;
    let Some(back) = inverse(correction) else { return 1.0 };
    let at = |i: usize, extent: usize| (i as f64 + 0.5) / CELLS as f64 * extent as f64 - 0.5;
    let cells = (0..CELLS * CELLS).map(|cell| [at(cell % CELLS, size.0), at(cell / CELLS, size.1)]);
    // The lattice reaches half a pixel beyond the middles of the border's pixels.
    let limits = [size.0, size.1].map(|extent| extent as f64 - 1.0);
    let clamped = |at: [f64; 2]| [0, 1].map(|i| at[i].clamp(0.0, limits[i].max(0.0)));
    let empty = cells.filter(|cell| inside(&back, clamped(*cell), size).is_none()).count();
    empty as f64 / (CELLS * CELLS) as f64
}

/// The largest distance, at the corners of a picture, between the places to which two maps from it lead; infinite beyond a horizon.
pub fn corner_error([a, b]: [&Matrix3; 2], (width, height): (usize, usize)) -> f64 {
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    let apart = |corner: [f64; 2]| match (mapped(a, corner), mapped(b, corner)) {
        (Some([x, y]), Some([u, v])) => (x - u).hypot(y - v),
        _ => f64::INFINITY,
    };
    [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]].into_iter().map(apart).fold(0.0, f64::max)
}

/// The largest distance, at the corners of a picture, of a map from the similarity nearest to it there in px; infinite beyond a horizon.
pub fn bend(map: &Matrix3, (width, height): (usize, usize)) -> f64 {
    let [right, bottom] = middle((width, height));
    // About the middle of the picture and about the mean of their places.
    let corners = [[-right, -bottom], [right, -bottom], [right, bottom], [-right, bottom]];
    let [Some(a), Some(b), Some(c), Some(d)] = corners.map(|[x, y]| mapped(map, [x + right, y + bottom])) else {
        return f64::INFINITY;
    };
    let mean = [0, 1].map(|i| (a[i] + b[i] + c[i] + d[i]) / 4.0);
    let places = [a, b, c, d].map(|[u, v]| [u - mean[0], v - mean[1]]);
    let pairs = || corners.iter().zip(&places);
    let spread = (4.0 * (right * right + bottom * bottom)).max(f64::MIN_POSITIVE);
    let along = pairs().map(|([x, y], [u, v])| x * u + y * v).sum::<f64>() / spread;
    let across = pairs().map(|([x, y], [u, v])| x * v - y * u).sum::<f64>() / spread;
    let off = |[x, y]: &[f64; 2], [u, v]: &[f64; 2]| (u - along * x + across * y).hypot(v - across * x - along * y);
    pairs().map(|(corner, place)| off(corner, place)).fold(0.0, f64::max)
}

/// The true motions of the background from frame `first` on, for `count` pairs; `None` where they are not known.
///
/// # Errors
/// If the truth is there but cannot be read.
pub fn true_motions(clip: &Clip, (first, count): (usize, usize)) -> Result<Option<Vec<Matrix3>>, Error> {
    let Some(truth) = clip.truth() else { return Ok(None) };
    (first..first + count).map(|t| truth.background(t).transpose()).collect::<Option<_>>().transpose()
}

/// The measures of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathErrors {
    /// Jitter of the estimated path in px.
    pub before_px: Option<f64>,
    /// Jitter of the stabilised path in px, by the estimated motions.
    pub after_px: Option<f64>,
    /// Largest error at the corners of the picture after chaining all motions, in px.
    pub drift_px: Option<f64>,
    /// Largest error at the corners of the picture of a single motion, in px.
    pub motion_px: Option<f64>,
    /// Jitter of the stabilised frames by the true motions, in px.
    pub residual_px: Option<f64>,
    /// Mean share of the stabilised frames that is empty.
    pub empty: Option<f64>,
}

impl PathField {
    /// The maps from the first frame to each frame.
    pub fn to_frames(&self) -> Vec<Matrix3> {
        chained(&self.motions)
    }

    /// The corrected maps: from the first frame to each stabilised frame, where there is one, given the maps to the frames.
    fn corrected(&self, to_frames: &[Matrix3]) -> Vec<Matrix3> {
        self.corrections.iter().zip(to_frames).map(|(correction, map)| product(correction, map)).collect()
    }

    /// The measures of the path, against the true motion of the background where `clip` has it.
    ///
    /// # Errors
    /// If the truth is there but cannot be read.
    pub fn errors(&self, clip: &Clip) -> Result<PathErrors, Error> {
        Ok(self.errors_against(true_motions(clip, self.pairs())?))
    }

    /// The first frame and the number of pairs.
    fn pairs(&self) -> (usize, usize) {
        (self.first, self.motions.len())
    }

    /// The measures of the path, against the true motions where these are known.
    fn errors_against(&self, truth: Option<Vec<Matrix3>>) -> PathErrors {
        let to_frames = self.to_frames();
        let of = |maps: &[Matrix3]| jitter(&track(maps, self.picture));
        let mut errors = PathErrors { before_px: of(&to_frames), ..PathErrors::default() };
        let is_done = self.corrections.len() == to_frames.len();
        if is_done {
            let empty: f64 = self.corrections.iter().map(|map| empty_share(map, self.picture)).sum();
            errors.after_px = of(&self.corrected(&to_frames));
            errors.empty = Some(empty / self.corrections.len() as f64);
        }
        let Some(truth) = truth.filter(|truth| !truth.is_empty()) else {
            return errors;
        };
        let true_maps = chained(&truth);
        let ends = [to_frames.last(), true_maps.last()];
        errors.drift_px = ends[0].zip(ends[1]).map(|(found, truth)| corner_error([found, truth], self.picture));
        let each = self.motions.iter().zip(&truth).map(|(found, truth)| corner_error([found, truth], self.picture));
        errors.motion_px = each.reduce(f64::max);
        errors.residual_px = is_done.then(|| of(&self.corrected(&true_maps))).flatten();
        errors
    }

    /// The pictures made with it, each with the name of its kind and the number of its frame.
    ///
    /// # Errors
    /// If a frame cannot be read.
    pub fn pictures(&self) -> Result<Vec<(&'static str, usize, Frame)>, Error> {
        match &self.views {
            Views::None => Ok(Vec::new()),
            Views::Mosaic(frame) => Ok(vec![("mosaic", self.first, Frame::clone(frame))]),
            Views::Stabilized(clip) => (0..self.corrections.len())
                .map(|i| {
                    clip.wanted()?;
                    let frame = clip.frame(self.first + i)?;
                    Ok(("stabilized", self.first + i, self.stabilized(&frame, i)))
                })
                .collect(),
        }
    }

    /// A frame warped by correction `i`.
    fn stabilized(&self, frame: &Frame, i: usize) -> Frame {
        let back = self.corrections.get(i).and_then(inverse).unwrap_or(IDENTITY);
        registered(frame, &back, &Window::of(self.picture))
    }
}

const MEASURES: [Measure; 6] = [
    Measure::new(
        "jitter_px",
        "Jitter of the camera's path by the estimated motions: root mean square of the second differences of the middle of the picture, in px; \
         larger with a homography as the motion model than with a similarity, as it follows more of the noise.",
    )
    .in_column("jitter px", 3),
    Measure::new("jitter_after_px", "The same after stabilisation, by the estimated motions.")
        .in_column("jitter after px", 3),
    Measure::new("empty_share", "Mean share of the stabilised frames that no pixel of the frame covers.")
        .in_percent("empty %", "empty_percent").smaller_is_better(),
    Measure::new(
        "motion_error_px",
        "Largest error of the motion of a pair at the corners of the picture, against the true motion of the background, in px.",
    )
    .in_column("motion error px", 3).smaller_is_better()
    .against_truth(),
    Measure::new(
        "drift_px",
        "Error at the corners of the picture after all motions are chained, against the true motion of the background, in px.",
    )
    .in_column("drift px", 3).smaller_is_better()
    .against_truth(),
    Measure::new("residual_jitter_px", "Jitter of the stabilised frames by the true motion of the background, in px.")
        .in_column("residual jitter px", 3).smaller_is_better()
        .against_truth(),
];

impl Product for PathField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "camera-path",
        name: "Camera path",
        summary: "The motion of the background from frame to frame, chained, with the pictures that it registers.",
        motion: Motion::Nowhere,
        is_of_single_frames: true,
        has_pictures: true,
        measures: &[&MEASURES],
    };

    /// The place of the camera at each frame, before and after stabilisation, and the matrix of the motion to the next.
    fn table(&self) -> Option<Table> {
        let to_frames = self.to_frames();
        let path = track(&to_frames, self.picture);
        let smooth = track(&self.corrected(&to_frames), self.picture);
        let row = |i: usize| -> [Cell; 14] {
            let smooth = smooth.get(i).map_or([None; 2], |at| at.map(Some));
            let entries = self.motions.get(i).map(|matrix| matrix.as_flattened().to_vec());
            let entry = |k: usize| Cell::from(entries.as_ref().map(|all| all[k]));
            let places = [path[i][0].into(), path[i][1].into(), smooth[0].into(), smooth[1].into()];
            let [x, y, u, v] = places;
            [
                (self.first + i).into(),
                x,
                y,
                u,
                v,
                entry(0),
                entry(1),
                entry(2),
                entry(3),
                entry(4),
                entry(5),
                entry(6),
                entry(7),
                entry(8),
            ]
        };
        let columns = [
            "frame",
            "x_px",
            "y_px",
            "stable_x_px",
            "stable_y_px",
            "m11",
            "m12",
            "m13",
            "m21",
            "m22",
            "m23",
            "m31",
            "m32",
            "m33",
        ];
        Some(Table::new(columns, (0..path.len()).map(row)))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let (truth, truth_error) = match true_motions(reference.clip, self.pairs()) {
            Ok(truth) => (truth, None),
            Err(error) => (None, Some(error)),
        };
        let PathErrors { before_px, after_px, drift_px, motion_px, residual_px, empty } = self.errors_against(truth);
        let finite = |value: Option<f64>| Figure::from(value.filter(|value| value.is_finite()));
        let values = [before_px, after_px, empty, motion_px, drift_px, residual_px].map(finite);
        let px = |value: f64| format!("{} px", words::fixed(value, 2));
        let mut facts = Vec::new();
        facts.extend(before_px.map(|jitter| fact("Jitter", px(jitter))));
        facts.extend(after_px.map(|jitter| fact("Jitter after stabilisation", px(jitter))));
        facts.extend(motion_px.map(|error| fact("Largest error of a motion", px(error))));
        facts.extend(drift_px.map(|error| fact("Drift of the chained path, at the corners", px(error))));
        let headline = match (before_px, after_px) {
            (Some(before), Some(after)) => format!("jitter {} → {}", words::fixed(before, 2), px(after)),
            (Some(before), None) => format!("jitter {}", px(before)),
            _ => String::new(),
        };
        Ok(Assessment { headline, truth_error, ..Assessment::default() }.with(scores(&MEASURES, values), facts))
    }

    fn last_frame(&self) -> Option<usize> {
        Some(self.first + self.motions.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shift(u: f64, v: f64) -> Matrix3 {
        [[1.0, 0.0, u], [0.0, 1.0, v], [0.0, 0.0, 1.0]]
    }

    #[test]
    fn motions_are_chained_in_their_order() {
        let turn = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let all = chained(&[shift(3.0, 0.0), turn]);
        assert_eq!(all.len(), 3);
        assert_eq!(mapped(&all[2], [1.0, 2.0]), Some([-2.0, 4.0]), "first the shift, then the turn");
    }

    #[test]
    fn a_similarity_bends_nothing() {
        let similarity = [[1.1, -0.3, 7.0], [0.3, 1.1, -2.0], [0.0, 0.0, 1.0]];
        assert!(bend(&similarity, (64, 48)) < 1e-9);
        // Corners (±4, ±3) go to (±4, ±6): the scale of the nearest similarity is (16 + 18) / 25.
        let stretched = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]];
        let expected = (4.0f64 * 0.36).hypot(3.0 * 0.64);
        assert!((bend(&stretched, (9, 7)) - expected).abs() < 1e-12, "{}", bend(&stretched, (9, 7)));
        assert_eq!(bend(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.5, 0.0, 1.0]], (9, 7)), f64::INFINITY);
    }

    #[test]
    fn a_steady_pan_has_no_jitter() {
        let pan: Vec<_> = (0..6).map(|_| shift(-2.0, 0.5)).collect();
        let path = track(&chained(&pan), (11, 7));
        assert_eq!(path[3], [5.0 + 6.0, 3.0 - 1.5], "the camera goes against the picture");
        assert!(jitter(&path).is_some_and(|jitter| jitter < 1e-12));
        assert_eq!(jitter(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]), Some(2.0));
        assert_eq!(jitter(&path[..2]), None);
    }

    #[test]
    fn the_empty_share_is_that_of_the_strip_which_a_shift_uncovers() {
        assert_eq!(empty_share(&IDENTITY, (96, 48)), 0.0);
        let quarter = empty_share(&shift(24.0, 0.0), (96, 48));
        assert!((quarter - 0.25).abs() < 0.02, "{quarter}");
        assert_eq!(empty_share(&shift(200.0, 0.0), (96, 48)), 1.0);
    }

    #[test]
    fn the_error_is_the_largest_at_a_corner() {
        let turned = [[1.0, -0.01, 0.0], [0.01, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let error = corner_error([&IDENTITY, &turned], (101, 51));
        assert!((error - 0.01 * 100f64.hypot(50.0)).abs() < 1e-9, "{error}");
    }
}
