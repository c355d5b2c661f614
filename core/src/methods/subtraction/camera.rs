//! The displacement of the camera, so that a background model can follow it.
//!
//! The displacement is the median over textured blocks of the picture (block matching on a pyramid): an object that covers less
//! than half of them does not change it. Whole pixels of it shift the model. The remaining fraction of a pixel is suppressed
//! as in A. Elgammal, D. Harwood and L. Davis, Non-parametric model for background subtraction, ECCV 2000: a foreground pixel that
//! the background of a neighbor explains is background that the camera has displaced.

use std::sync::Arc;

use super::exposure::Exposure;
use crate::base::Error;
use crate::data::{Clip, Frame, Mask};
use crate::geometry::{Gray, Grid, pyramid};
use crate::{choices, params};

choices! {
    /// The treatment of camera motion.
    pub enum CameraMotion {
        /// The camera is at rest: each pixel is compared with the background at the same position.
        Still = "still" "At rest",
        /// The model follows the camera: it is shifted by the median displacement of textured blocks, in whole pixels.
        Followed = "followed" "Followed",
    }
}

params! {
    /// The parameters of a background model for a camera that is not quite at rest.
    #[derive(Copy)]
    pub struct Steadiness {
        /// Treatment of camera motion. A shifted model keeps the background while the camera drifts or tilts slowly; a pan that leaves
        /// little of the first picture, zoom and parallax need optical flow.
        camera: CameraMotion = CameraMotion::Followed;
        /// Radius of the shake suppression. A foreground pixel that fits the background of a pixel within this radius is displaced
        /// background; 0 turns it off.
        shake: usize = 1, 0..=3, "px";
        /// Treatment of changes of the exposure: automatic exposure and slow changes of the light make the whole picture brighter or
        /// darker. Fast changes of a part of the picture, such as shadows, do not count.
        exposure: Exposure = Exposure::Compensated;
    }
}

/// Side of a block in px.
const BLOCK_PX: usize = 16;
/// The greatest number of blocks along a side of the picture.
const BLOCKS: usize = 14;
/// The least number of textured blocks, along each axis, whose median is a displacement.
const LEAST_BLOCKS: usize = 8;
/// The levels of the pyramid.
const LEVELS: usize = 3;
/// The search range in px on the coarsest level and on the finer ones.
const RANGE_PX: [i32; 2] = [5, 2];
/// The displacement in px at which the reference is replaced by the present frame.
const ANCHOR_PX: f32 = 4.0;

/// The greatest displacement of a frame that is aligned with the first one, as a share of the longer side of the picture.
const ALIGNED_SHARE: f32 = 0.05;

/// The camera during a run.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    /// The pyramid of the reference, and the displacement of that.
    anchor: Arc<Vec<Gray>>,
    anchor_at: [f32; 2],
    /// The displacement of the background since the first frame in px.
    pub at: [f32; 2],
    /// The displacement of the model in px.
    pub model_at: [f32; 2],
    /// Whether the displacements of the last frame disagree.
    pub is_lost: bool,
}

/// A displacement below this length is no movement, in px: interpolation is no more accurate.
const AT_REST_PX: f32 = 0.1;

impl Camera {
    pub fn new(first: &Frame) -> Self {
        let anchor = Arc::new(pyramid::halvings(first.luma(), LEVELS));
        Self { anchor, anchor_at: [0.0; 2], at: [0.0; 2], model_at: [0.0; 2], is_lost: false }
    }

    /// Follows the camera to the next frame; returns the shift of the model in px, in whole px unless `is_fine`.
    pub fn follow(&mut self, frame: &Frame, is_fine: bool) -> [f32; 2] {
        let levels = pyramid::halvings(frame.luma(), LEVELS);
        let guess = [0, 1].map(|i| self.at[i] - self.anchor_at[i]);
        let found = displacement([&self.anchor, &levels], guess);
        self.is_lost = found.is_none();
        let found = found.filter(|by| explains([&self.anchor[0], &levels[0]], guess, *by));
        if let Some(by) = found {
            // Without enough texture the camera is taken to be at rest.
            self.at = [0, 1].map(|i| self.anchor_at[i] + by[i]);
        }
        let is_far = found.is_some_and(|by| by[0].hypot(by[1]) > ANCHOR_PX);
        if is_far || self.is_lost {
            (self.anchor, self.anchor_at) = (Arc::new(levels), self.at);
        }
        if is_fine {
            let by = [0, 1].map(|i| self.at[i] - self.model_at[i]);
            if by[0].hypot(by[1]) < AT_REST_PX {
                return [0.0; 2];
            }
            self.model_at = self.at;
            return by;
        }
        // A displacement of half a pixel must not shift the model to and fro.
        let shift = [0, 1].map(|i| {
            let off = self.at[i] - self.model_at[i];
            if off.abs() > 0.6 { off.round() } else { 0.0 }
        });
        self.model_at = [0, 1].map(|i| self.model_at[i] + shift[i]);
        shift
    }

    pub fn bytes(&self) -> usize {
        self.anchor.iter().map(|level| level.cells().len()).sum()
    }
}

/// Returns whether the background has moved by `by` px, rather than by `guess`: more of the whole picture matches. Where only
/// objects are textured, the median of the blocks is their motion.
fn explains(pictures: [&Gray; 2], guess: [f32; 2], by: [f32; 2]) -> bool {
    let [old, new] = [guess, by].map(|by| by.map(|c| c.round() as isize));
    // An object changes the sum the less, the smaller it is, however different it is.
    let [old, new] = [old, new].map(|by| (by, truncated_difference(pictures, by)));
    old.0 == new.0 || new.1 < old.1
}

/// Difference in gray levels from which a pixel belongs to something else.
const OTHER: u8 = 20;

/// The mean truncated difference of a picture and the displaced one, at every second pixel of every second row.
fn truncated_difference([from, to]: [&Gray; 2], by: [isize; 2]) -> f64 {
    let (width, height) = from.size();
    let (mut sum, mut count) = (0u64, 0u64);
    for y in (0..height).step_by(2) {
        let Some(v) = y.checked_add_signed(by[1]).filter(|v| *v < height) else { continue };
        for x in (0..width).step_by(2) {
            let Some(u) = x.checked_add_signed(by[0]).filter(|u| *u < width) else { continue };
            sum += u64::from(from[(x, y)].abs_diff(to[(u, v)]).min(OTHER));
            count += 1;
        }
    }
    sum as f64 / count.max(1) as f64
}

/// The displacements in px beside that of a frame whose misfit is compared with its own.
const BESIDE_PX: [[isize; 2]; 4] = [[8, 0], [-8, 0], [0, 8], [0, -8]];
/// The greatest misfit of an aligned frame, as a share of that beside.
const ALIGNED_MISFIT: f64 = 0.85;
/// A neighbouring misfit below this means too little texture to decide, in gray levels.
const LEAST_MISFIT: f64 = 6.0;

/// Returns whether a picture fits another one better at a displacement than some px beside. A camera that was lost for a frame has a
/// displacement that is none.
fn is_aligned(pictures: [&Gray; 2], at: [f32; 2]) -> bool {
    let at = at.map(|c| c.round() as isize);
    let beside: f64 = BESIDE_PX.iter().map(|by| misfit(pictures, [at[0] + by[0], at[1] + by[1]])).sum();
    let beside = beside / BESIDE_PX.len() as f64;
    beside < LEAST_MISFIT || misfit(pictures, at) <= ALIGNED_MISFIT * beside
}

/// The mean truncated deviation from the median difference of a picture and the displaced one, at every second pixel of every second
/// row, in gray levels: the exposure may have changed.
fn misfit([from, to]: [&Gray; 2], by: [isize; 2]) -> f64 {
    let (width, height) = from.size();
    let mut counts = [0u32; 511];
    for y in (0..height).step_by(2) {
        let Some(v) = y.checked_add_signed(by[1]).filter(|v| *v < height) else { continue };
        for x in (0..width).step_by(2) {
            let Some(u) = x.checked_add_signed(by[0]).filter(|u| *u < width) else { continue };
            counts[255 + usize::from(to[(u, v)]) - usize::from(from[(x, y)])] += 1;
        }
    }
    let all: u32 = counts.iter().sum();
    let mut below = 0;
    let median = counts.iter().position(|count| {
        below += count;
        2 * below >= all
    });
    let median = median.unwrap_or_default();
    let deviations = counts.iter().enumerate();
    let sum: f64 =
        deviations.map(|(i, count)| f64::from(*count) * i.abs_diff(median).min(usize::from(OTHER)) as f64).sum();
    sum / f64::from(all.max(1))
}

/// Returns the displacement of the picture between two pyramids in px, near a guess; `None` where the blocks disagree. Along an axis
/// without enough texture it is the guess.
pub(crate) fn displacement([from, to]: [&[Gray]; 2], guess: [f32; 2]) -> Option<[f32; 2]> {
    let mut by = guess;
    let top = from.len().min(to.len());
    for level in (0..top).rev() {
        let scale = (1 << level) as f32;
        let near = by.map(|c| c / scale);
        // Coarse levels are small, so their blocks are.
        let search = if level == 0 { (BLOCK_PX, RANGE_PX[1]) } else { (BLOCK_PX / 2, RANGE_PX[0]) };
        match median_displacement([&from[level], &to[level]], near, search) {
            Some(found) => by = found.map(|c| c * scale),
            // A coarse level may be ambiguous; the finest one decides.
            None if level > 0 => {}
            None => return None,
        }
    }
    Some(by)
}

/// Returns the median displacement of the textured blocks, if most of them agree.
fn median_displacement([from, to]: [&Gray; 2], guess: [f32; 2], (block, range): (usize, i32)) -> Option<[f32; 2]> {
    let ((width, height), near) = (from.size(), guess.map(|c| c.round() as i32));
    let side = block.min(width.min(height) / 6).max(4);
    let mut along = [Vec::new(), Vec::new()];
    let starts = |length: usize, reach: usize| {
        let room = length.saturating_sub(2 * reach + side);
        let count = (room / side + 1).min(BLOCKS);
        (0..count).map(move |i| reach + i * room / (count - 1).max(1))
    };
    let reach = [0, 1].map(|i| (near[i].abs() + range + 1) as usize);
    if width < 2 * reach[0] + side || height < 2 * reach[1] + side {
        return Some(guess);
    }
    for y in starts(height, reach[1]) {
        for x in starts(width, reach[0]) {
            let found = match_block([from, to], Block { first: [x, y], side }, near, range);
            for (values, value) in along.iter_mut().zip(found) {
                values.extend(value);
            }
        }
    }
    let [x, y] = [0, 1].map(|axis| {
        let mut values = std::mem::take(&mut along[axis]);
        values.sort_by(f32::total_cmp);
        let Some(median) = values.get(values.len() / 2).filter(|_| values.len() >= LEAST_BLOCKS) else {
            return Some(guess[axis]);
        };
        let agreeing = values.iter().filter(|value| (*value - median).abs() <= 1.0).count();
        (2 * agreeing > values.len()).then_some(*median)
    });
    Some([x?, y?])
}

/// A square block by its first pixel and its side in px.
#[derive(Clone, Copy)]
struct Block {
    first: [usize; 2],
    side: usize,
}

/// Returns the displacement of a block along each axis on which it has enough texture.
fn match_block(pictures: [&Gray; 2], block: Block, near: [i32; 2], range: i32) -> [Option<f32>; 2] {
    let cost = |by: [i32; 2]| sad(pictures, block, by);
    let (mut best, mut least) = (near, cost(near));
    for v in -range..=range {
        for u in -range..=range {
            let by = [near[0] + u, near[1] + v];
            if let Some(sum) = sad_below(pictures, block, by, least) {
                (best, least) = (by, sum);
            }
        }
    }
    // The minimum must stand out from its neighbors by more than noise: two gray levels on average.
    let textured = least + least / 4 + 2 * (block.side * block.side) as u32;
    [0, 1].map(|axis| {
        let is_inside = (best[axis] - near[axis]).abs() < range;
        let beside = [-1, 1].map(|step| {
            let mut by = best;
            by[axis] += step;
            cost(by)
        });
        // Squares of smooth texture form a parabola around the minimum, absolute differences do not.
        let squares = |step: i32| {
            let mut by = best;
            by[axis] += step;
            ssd(pictures, block, by) as f32
        };
        let is_known = is_inside && beside.iter().all(|sum| *sum > textured);
        let [low, middle, high] = [-1, 0, 1].map(squares);
        let curve = low - 2.0 * middle + high;
        (is_known && curve > 0.0).then(|| best[axis] as f32 + (0.5 * (low - high) / curve).clamp(-0.5, 0.5))
    })
}

/// Sums `difference` over the pixels of each row of a block and of the displaced one.
#[inline(always)]
fn summed(
    [from, to]: [&Gray; 2],
    Block { first: [x, y], side }: Block,
    [u, v]: [i32; 2],
    difference: impl Fn(u8, u8) -> u32,
) -> impl Iterator<Item = u32> {
    let start = (x as i32 + u) as usize;
    let rows =
        (y..y + side).map(move |y| (&from.row(y)[x..x + side], &to.row((y as i32 + v) as usize)[start..start + side]));
    rows.map(move |(a, b)| a.iter().zip(b).map(|(a, b)| difference(*a, *b)).sum::<u32>())
}

/// The sum of absolute differences of a block and the displaced one.
fn sad(pictures: [&Gray; 2], block: Block, by: [i32; 2]) -> u32 {
    summed(pictures, block, by, |a, b| u32::from(a.abs_diff(b))).sum()
}

/// The sum of absolute differences if it is below `limit`; the rows that are left once it is not are not read.
fn sad_below(pictures: [&Gray; 2], block: Block, by: [i32; 2], limit: u32) -> Option<u32> {
    let mut sum = 0;
    let mut rows = summed(pictures, block, by, |a, b| u32::from(a.abs_diff(b)));
    let is_below = rows.all(|row| {
        sum += row;
        sum < limit
    });
    is_below.then_some(sum)
}

/// The sum of squared differences of a block and the displaced one.
fn ssd(pictures: [&Gray; 2], block: Block, by: [i32; 2]) -> u32 {
    summed(pictures, block, by, |a, b| u32::from(a.abs_diff(b)).pow(2)).sum()
}

/// Returns a grid displaced by `by` px; `beyond` fills the uncovered pixels.
pub(crate) fn shifted<T: Copy>(grid: &Grid<T>, by: [f32; 2], beyond: impl Fn(usize, usize) -> T) -> Grid<T> {
    let ((width, height), by) = (grid.size(), by.map(|c| c.round() as i32));
    Grid::from_fn(width, height, |x, y| {
        let [from_x, from_y] = [x as i32 - by[0], y as i32 - by[1]];
        let is_inside = (0..width as i32).contains(&from_x) && (0..height as i32).contains(&from_y);
        if is_inside { grid[(from_x as usize, from_y as usize)] } else { beyond(x, y) }
    })
}

/// Returns a frame displaced by `by` px, interpolated between pixels and completed with another one.
pub(crate) fn resampled(frame: &Frame, by: [f32; 2], beyond: &Frame) -> Frame {
    let (width, height) = frame.size();
    let from = |x: usize, y: usize| {
        let from = [x as f32 - by[0], y as f32 - by[1]];
        let is_inside = (0.0..=width as f32 - 1.0).contains(&from[0]) && (0.0..=height as f32 - 1.0).contains(&from[1]);
        is_inside.then_some(from)
    };
    match (frame.color(), beyond.color()) {
        (Some(color), Some(other)) => {
            Frame::rgb(Grid::from_fn(width, height, |x, y| from(x, y).map_or(other[(x, y)], |from| mixed(color, from))))
        }
        _ => Frame::gray(Grid::from_fn(width, height, |x, y| {
            from(x, y).map_or(beyond.luma()[(x, y)], |[x, y]| frame.luma().sample(x, y).round() as u8)
        })),
    }
}

/// The color of a picture between pixels, bilinear.
fn mixed(color: &Grid<[u8; 3]>, [x, y]: [f32; 2]) -> [u8; 3] {
    let (left, top) = (x as usize, y as usize);
    let (right, bottom) = ((left + 1).min(color.width() - 1), (top + 1).min(color.height() - 1));
    let (across, down) = (x - left as f32, y - top as f32);
    let row = |y: usize, c: usize| {
        let [a, b] = [color[(left, y)][c], color[(right, y)][c]].map(f32::from);
        a + (b - a) * across
    };
    [0, 1, 2].map(|c| (row(top, c) + (row(bottom, c) - row(top, c)) * down).round() as u8)
}

/// Returns the foreground pixels that the background of another pixel within the radius of the shake suppression explains: `fits` tells
/// whether the background of its second pixel explains the value of the frame at its first.
pub(crate) fn displaced(
    mask: &Mask,
    steady: Option<Steadiness>,
    fits: impl Fn((usize, usize), (usize, usize)) -> bool,
) -> Option<Mask> {
    let (reach, (width, height)) = (steady?.shake, mask.size());
    let around = |c: usize, length: usize| c.saturating_sub(reach)..(c + reach + 1).min(length);
    let is_displaced = |x: usize, y: usize| {
        let mut near = around(y, height).flat_map(|v| around(x, width).map(move |u| (u, v)));
        mask.get(x, y) && near.any(|of| of != (x, y) && fits((x, y), of))
    };
    (reach > 0).then(|| Mask::from_fn(width, height, is_displaced))
}

/// A frame with its displacement from the first in px.
pub(crate) type Displaced = (Arc<Frame>, [f32; 2]);

/// Follows the camera through the frames of a clip at intervals; returns each with its displacement from the first in whole px, as long as
/// that is small: perspective changes with a larger one. Frames that do not fit the first one there are left out.
///
/// # Errors
/// If a frame cannot be read.
pub(crate) fn aligned(clip: &Clip, times: &[usize]) -> Result<Vec<Displaced>, Error> {
    let mut camera: Option<Camera> = None;
    let mut all: Vec<Displaced> = Vec::new();
    for t in times {
        clip.wanted()?;
        let frame = clip.frame(*t)?;
        match &mut camera {
            Some(camera) => _ = camera.follow(&frame, false),
            None => camera = Some(Camera::new(&frame)),
        }
        let at = camera.as_ref().map_or([0.0; 2], |camera| camera.model_at);
        let (width, height) = frame.size();
        let is_near = at[0].hypot(at[1]) <= ALIGNED_SHARE * width.max(height) as f32;
        let fits = all.first().is_none_or(|(first, _)| is_aligned([first.luma(), frame.luma()], at));
        if is_near && fits {
            all.push((frame, at));
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves of several directions and lengths at any place.
    fn waves(x: f32, y: f32) -> f32 {
        128.0 + 40.0 * (0.21 * x + 0.07 * y).sin() + 35.0 * (0.11 * x - 0.19 * y).sin() + 30.0 * (0.31 * y).cos()
    }

    fn picture(at: [f32; 2], object: usize) -> Frame {
        Frame::gray(Grid::from_fn(160, 120, |x, y| {
            let is_object = (30..30 + object).contains(&x) && (30..90).contains(&y);
            if is_object { (40 + 7 * x % 90) as u8 } else { waves(x as f32 - at[0], y as f32 - at[1]) as u8 }
        }))
    }

    #[test]
    fn the_camera_is_followed_past_an_object() {
        // An object of up to 30×60 px at rest in a picture of 160×120. The error adds up with each new reference.
        let mut camera = Camera::new(&picture([0.0; 2], 0));
        for (t, place) in [[0.3, -0.2], [1.2, 2.0], [4.0, 7.1], [9.4, 6.6]].into_iter().enumerate() {
            camera.follow(&picture(place, 10 * t), false);
            let off = |at: [f32; 2]| (at[0] - place[0]).hypot(at[1] - place[1]);
            assert!(!camera.is_lost && off(camera.at) < 0.25, "{place:?}: {:?}", camera.at);
            // Whole px, which follow from 0.6 px on, along both axes.
            assert!(off(camera.model_at) < 0.25 + 0.6 * std::f32::consts::SQRT_2, "{place:?}: {:?}", camera.model_at);
        }
    }

    #[test]
    fn the_same_picture_is_no_movement() {
        let still = picture([0.0; 2], 0);
        let mut camera = Camera::new(&still);
        for is_fine in [true, false, true] {
            assert_eq!(camera.follow(&still, is_fine), [0.0; 2]);
        }
    }

    #[test]
    fn textured_objects_on_a_plain_floor_do_not_move_the_camera() {
        // Textured objects cover a twentieth of a floor with joints.
        let at = |shift: usize| {
            Frame::gray(Grid::from_fn(320, 240, |x, y| {
                let is_object = (y / 24 % 4 == 0) && (x + 320 - shift) % 64 < 12;
                let joint = if x % 20 == 0 || y % 20 == 0 { 20 } else { 0 };
                if is_object { (30 + (x + 320 - shift) % 64 * 9 + y * 31 % 70) as u8 } else { 200 - joint }
            }))
        };
        let mut camera = Camera::new(&at(0));
        for shift in [1, 2, 3, 4, 5] {
            assert_eq!(camera.follow(&at(shift), false), [0.0; 2], "{shift}");
        }
    }

    #[test]
    fn without_texture_the_camera_counts_as_at_rest() {
        let flat = Frame::gray(Grid::new(160, 120, 90));
        let mut camera = Camera::new(&flat);
        assert_eq!((camera.follow(&flat, false), camera.is_lost), ([0.0, 0.0], false));
    }

    #[test]
    fn every_channel_is_interpolated_as_gray_levels_are() {
        let color = |x: usize, y: usize| [(9 * x + 20 * y) as u8, (200 - 11 * x) as u8, (x * y) as u8];
        let (frame, beyond) = (Frame::rgb(Grid::from_fn(8, 6, color)), Frame::rgb(Grid::new(8, 6, [7, 8, 9])));
        let by = [0.4, -1.3];
        let moved = resampled(&frame, by, &beyond);
        for c in 0..3 {
            let alone = |frame: &Frame| Frame::gray(frame.color().unwrap().map(|color| color[c]));
            let expected = resampled(&alone(&frame), by, &alone(&beyond));
            assert_eq!(&moved.color().unwrap().map(|color| color[c]), expected.luma(), "channel {c}");
        }
    }

    #[test]
    fn a_shifted_grid_is_completed() {
        let grid = Grid::from_fn(3, 2, |x, y| 10 * y + x);
        assert_eq!(shifted(&grid, [1.0, 0.0], |_, _| 99).cells(), [99, 0, 1, 99, 10, 11]);
        assert_eq!(shifted(&grid, [0.0, -1.0], |_, _| 99).cells(), [10, 11, 12, 99, 99, 99]);
    }

    #[test]
    fn a_frame_at_the_displacement_of_a_lost_camera_is_not_aligned() {
        let at = |place: [f32; 2], offset: u8| picture(place, 20).luma().map(|level| level.saturating_add(offset));
        let first = at([0.0; 2], 0);
        for offset in [0, 12] {
            let moved = at([9.0, -14.0], offset);
            assert!(is_aligned([&first, &moved], [9.0, -14.0]), "{offset}: its own displacement");
            assert!(!is_aligned([&first, &moved], [-3.0, 5.0]), "{offset}: an old one");
        }
        let flat = Grid::new(160, 120, 90);
        assert!(is_aligned([&flat, &flat], [3.0, 1.0]), "without texture it does not matter");
    }
}
