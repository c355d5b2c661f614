//! Coarse-to-fine: a pair of frames on the levels of a pyramid, and the mapping between level and full resolution.

use std::sync::OnceLock;

use super::{Field, FramePair, explain};
use crate::base::{
    Error, LANES, Threads, effort,
    wide::{lane, widest},
};
use crate::data::{Clip, Flow};
use crate::geometry::{Grid, pyramid};
use crate::scene::{Step, Unit, Value};

/// Scale factor from one level to the next coarser.
const FACTOR: f32 = 0.5;

/// The pyramids of both frames. Level 0 is full resolution; all levels cover the same area.
pub struct Multiscale {
    /// The frames at full resolution, with their ground truth.
    pub frame_pair: FramePair,
    /// Frames t and t + 1 on the levels above 0.
    coarser: [Vec<Grid<f32>>; 2],
    /// The true flow at the pixels of each level in px of level 0, NaN where it is unknown; computed when an error is needed.
    truths: Vec<OnceLock<Option<Field>>>,
    /// The pixel of level 0 that is explained by default.
    default_pixel: OnceLock<(usize, usize)>,
}

impl Multiscale {
    /// Builds pyramids of at most `count` levels over frames `frame` and `frame + 1` of `clip`, first smoothed by a Gaussian of
    /// standard deviation `sigma_px`.
    ///
    /// # Errors
    /// As [`FramePair::new`].
    pub fn new((clip, frame): (&Clip, usize), sigma_px: f32, count: usize, threads: &Threads) -> Result<Self, Error> {
        let frame_pair = FramePair::new(clip, frame, sigma_px, threads)?;
        let coarser = frame_pair.pictures.each_ref().map(|picture| pyramid::coarser(picture, FACTOR, count, threads));
        let truths = (0..=coarser[0].len()).map(|_| OnceLock::new()).collect();
        Ok(Self { frame_pair, coarser, truths, default_pixel: OnceLock::new() })
    }

    /// Returns the number of levels.
    pub fn count(&self) -> usize {
        1 + self.coarser[0].len()
    }

    /// Returns frames t and t + 1 on a level.
    pub fn pair(&self, level: usize) -> [&Grid<f32>; 2] {
        [0, 1].map(|i| if level == 0 { &self.frame_pair.pictures[i] } else { &self.coarser[i][level - 1] })
    }

    /// Returns width and height of a level in its own px.
    pub fn size(&self, level: usize) -> (usize, usize) {
        self.pair(level)[0].size()
    }

    /// Returns the size of a pixel of a level in px of level 0, horizontally and vertically.
    pub fn scale(&self, level: usize) -> [f32; 2] {
        let ((width, height), (w, h)) = (self.size(0), self.size(level));
        [width as f32 / w as f32, height as f32 / h as f32]
    }

    /// Returns the pixel of a level that covers a position in level 0, if that lies in the frame.
    pub fn pixel_at(&self, level: usize, point: [f32; 2]) -> Option<(usize, usize)> {
        let (x, y) = self.frame_pair.pixel_at(point)?;
        let ((width, height), scale) = (self.size(level), self.scale(level));
        let on_level = |c: usize, scale: f32, extent: usize| (((c as f32 + 0.5) / scale) as usize).min(extent - 1);
        Some((on_level(x, scale[0], width), on_level(y, scale[1], height)))
    }

    /// Returns the pixel of a level that is explained by default: the one with the strongest constraint of the frames,
    /// the same for all iterations.
    pub fn default_pixel(&self, level: usize) -> (usize, usize) {
        let (x, y) = *self.default_pixel.get_or_init(|| self.frame_pair.strongest_constraint());
        self.pixel_at(level, [x as f32, y as f32]).unwrap_or_default()
    }

    /// Returns the rectangle in level 0 that the pixels of a level from `min` to before `max` cover.
    pub fn on_picture(&self, level: usize, min: [f32; 2], max: [f32; 2]) -> [[f32; 2]; 2] {
        let scale = self.scale(level);
        [min, max].map(|corner| [0, 1].map(|i| corner[i] * scale[i] - 0.5))
    }

    /// Returns the true displacement of a pixel of a level, in px of the level, if it is known.
    pub fn truth(&self, level: usize, (x, y): (usize, usize)) -> Option<[f32; 2]> {
        let scale = self.scale(level);
        let place = |i: usize, scale: f32| ((i as f32 + 0.5) * scale) as usize;
        let truth = self.frame_pair.true_displacement((place(x, scale[0]), place(y, scale[1])))?;
        Some([0, 1].map(|i| truth[i] / scale[i]))
    }

    /// Returns the field of any level at full resolution.
    pub fn flow(&self, field: &Field) -> Flow {
        if field.u.size() == self.size(0) {
            field.flow()
        } else {
            field.resized(self.size(0), &Threads::single()).flow()
        }
    }

    /// Returns the mean endpoint error of a field on `level`, in px of level 0, over the pixels with known true motion; NaN
    /// without any.
    pub fn error(&self, level: usize, field: &Field) -> f32 {
        let Some(truth) = self.truths[level].get_or_init(|| self.true_field(level)) else { return f32::NAN };
        effort::add(field.u.cells().len());
        let scale = self.scale(level);
        let (mut sum, mut known) = (0.0, 0.0);
        for y in 0..field.u.height() {
            let [of_row, known_in_row] =
                error_row([field.u.row(y), field.v.row(y)], [truth.u.row(y), truth.v.row(y)], scale);
            sum += f64::from(of_row);
            known += f64::from(known_in_row);
        }
        (sum / known) as f32
    }

    /// Returns the true flow at the pixels of a level in px of level 0, if there is any.
    fn true_field(&self, level: usize) -> Option<Field> {
        self.frame_pair.truth.as_ref()?;
        let (scale, mut field) = (self.scale(level), Field::new(self.size(level), [f32::NAN; 2]));
        let (width, height) = field.u.size();
        for place in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            if let Some([u, v]) = self.truth(level, place) {
                (field.u[place], field.v[place]) = (u * scale[0], v * scale[1]);
            }
        }
        Some(field)
    }

    /// Puts a level, and the iteration on it out of the `iterations` of a level or of a warp.
    pub fn put(&self, step: Step, level: usize, (iteration, iterations): (usize, usize)) -> Step {
        let (width, height) = self.size(level);
        let step = step
            .put(explain::value::COARSEST_LEVEL, self.count() - 1)
            .put(explain::value::WIDTH, width)
            .put(explain::value::HEIGHT, height);
        let step = step
            .fact_as(explain::value::LEVEL.is(level), explain::case::LEVEL)
            .put(explain::value::ITERATIONS, iterations);
        step.fact_as(explain::value::ITERATION.is(iteration), explain::case::ITERATION)
    }

    /// Returns the size of all levels in memory, in bytes.
    pub fn bytes(&self) -> usize {
        let truths = self.truths.iter().filter_map(OnceLock::get).flatten().map(Field::bytes).sum::<usize>();
        truths
            + self.frame_pair.bytes()
            + self.coarser.iter().flatten().map(|level| size_of_val(level.cells())).sum::<usize>()
    }
}

/// The mean change of an iteration on a level, in px of level 0.
pub fn mean_change(level: usize, change: f32) -> Value {
    let unit = if level == 0 { "px" } else { "px of level 0" };
    explain::value::MEAN_CHANGE.is(change).in_unit(Unit::new(unit, 3))
}

/// The unit of displacements on a level.
pub fn unit_of(level: usize) -> Unit {
    const NAMES: [&str; 10] = [
        "px",
        "px of level 1",
        "px of level 2",
        "px of level 3",
        "px of level 4",
        "px of level 5",
        "px of level 6",
        "px of level 7",
        "px of level 8",
        "px of level 9",
    ];
    Unit::new(NAMES[level.min(NAMES.len() - 1)], 3)
}

widest! {
    fn error_row(field: [&[f32]; 2], truth: [&[f32]; 2], scale: [f32; 2]) -> [f32; 2] = error_of_row
}

/// The sum of the endpoint errors of a row in px of level 0, and the number of pixels with known true flow.
#[inline(always)]
fn error_of_row([u, v]: [&[f32]; 2], [true_u, true_v]: [&[f32]; 2], scale: [f32; 2]) -> [f32; 2] {
    let error = |u: f32, v: f32, true_u: f32, true_v: f32| {
        let (off_u, off_v) = (u * scale[0] - true_u, v * scale[1] - true_v);
        let error = (off_u * off_u + off_v * off_v).sqrt();
        // NaN is not finite.
        if error.is_finite() { [error, 1.0] } else { [0.0; 2] }
    };
    let (mut sums, mut counts, mut x) = ([0.0; LANES], [0.0; LANES], 0);
    while let (Some(u), Some(v), Some(true_u), Some(true_v)) =
        (lane(u, x), lane(v, x), lane(true_u, x), lane(true_v, x))
    {
        for i in 0..LANES {
            let [error, known] = error(u[i], v[i], true_u[i], true_v[i]);
            sums[i] += error;
            counts[i] += known;
        }
        x += LANES;
    }
    let (mut sum, mut known) = (sums.iter().sum::<f32>(), counts.iter().sum::<f32>());
    for x in x..u.len() {
        let [error, is_known] = error(u[x], v[x], true_u[x], true_v[x]);
        (sum, known) = (sum + error, known + is_known);
    }
    [sum, known]
}
