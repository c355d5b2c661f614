//! The pictures of the scale space: Gaussian images and their differences on the stage, in detail and as a stack.

use std::sync::Arc;

use super::{BORDER, Sift, State};
use crate::base::Threads;
use crate::base::words::gray;
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::scale_space::Octave;
use crate::run::Seen;
use crate::scene::{Canvas, Floor, Level, Levels, Measured, Picture, Role, Scene, Shape, Stack, Tile};

/// The names of the Gaussian images of an octave and of their differences.
const IMAGES: [&str; 9] = ["G₁", "G₂", "G₃", "G₄", "G₅", "G₆", "G₇", "G₈", "G₉"];
const DIFFERENCES: [&str; 8] = ["D₁", "D₂", "D₃", "D₄", "D₅", "D₆", "D₇", "D₈"];

/// Width and height of the part of an octave shown in detail, in its px: about ten times the largest σ, so that blurring is seen. Even, so
/// that no pixel is in the middle.
const DETAIL_PX: [usize; 2] = [48, 36];

/// A part of an octave in its px: the first pixel and the size.
struct Detail {
    first: [usize; 2],
    size: [usize; 2],
}

impl Detail {
    /// The part around a pixel, moved to lie inside `image`.
    fn around([x, y]: [usize; 2], image: &Grid<f32>) -> Self {
        let extents = [image.width(), image.height()];
        let size = [0, 1].map(|i| DETAIL_PX[i].min(extents[i] / 2 * 2).max(1));
        let first = [x, y].map(|c| c as isize);
        let first =
            [0, 1].map(|i| (first[i] - size[i] as isize / 2).clamp(0, (extents[i] - size[i]) as isize) as usize);
        Self { first, size }
    }

    fn of(&self, image: &Grid<f32>) -> Grid<f32> {
        let [x, y] = self.first;
        // To a tenth of a gray level, as numbers are read.
        Grid::from_fn(self.size[0], self.size[1], |i, j| (image[(x + i, y + j)] * 10.0).round() / 10.0)
    }
}

impl Sift {
    /// The last Gaussian image so far and its difference from the one before, in place of the frame.
    pub(super) fn draw_space(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        let index = state.space.octaves.len().saturating_sub(1);
        let Some((octave, image)) = last_of(state) else {
            scene.pictures = vec![Canvas::of_clip(Picture::CURRENT)];
            return;
        };
        let (level, size, pixel_px) = (octave.gaussians.len() - 1, state.picture.size(), self.shape().pixel_px(index));
        let measured = measured(image, pixel_px, (IMAGES[level], self.name_of(index, level)));
        let blurred = Arc::clone(image);
        let make = move || Frame::gray(at_frame(&blurred, pixel_px, size, |value| value));
        scene.pictures = vec![Canvas::made(Picture::SMOOTHED, make).of(measured)];
        if level > 0 {
            self.show_difference(state, (index, level - 1), scene);
        }
        let detail = self.detail(seen, state);
        let corner = |px: [usize; 2]| px.map(|c| (c as f32 - 0.5) * pixel_px);
        if let Some(Detail { first, size }) = detail {
            let (min, max) = (corner(first), corner([0, 1].map(|i| first[i] + size[i])));
            for Canvas { picture, .. } in scene.pictures.clone() {
                scene.mark(picture, Role::Window, Shape::Rect { min, max });
            }
            scene.legend(Role::Window, "detail under Pixels");
        }
        scene.is_overview = true;
    }

    /// The name of a Gaussian image with its σ in px of the frame.
    fn name_of(&self, octave: usize, level: usize) -> String {
        let shape = self.shape();
        format!("{}, σ = {} px", IMAGES[level], gray(shape.sigma_of(level as f32) * shape.pixel_px(octave)))
    }

    /// Shows a difference of Gaussians with its name and its scale of grays; of an octave and with a number in it.
    pub(super) fn show_difference(&self, state: &State, (octave, level): (usize, usize), scene: &mut Scene) {
        let image = state.space.octaves.get(octave).and_then(|octave| octave.differences.get(level));
        let Some(image) = image.map(Arc::clone) else { return };
        let (pixel_px, size) = (self.shape().pixel_px(octave), state.picture.size());
        let most = scale_of(&image);
        let [name, to, from] = [DIFFERENCES[level], IMAGES[level + 1], IMAGES[level]];
        let title = format!("{name} = {to} − {from}, white ≥ {}", gray(most));
        let measured = measured(&image, pixel_px, (name, title));
        let make = move || Frame::gray(at_frame(&image, pixel_px, size, |value| 127.5 + 127.5 * value / most));
        scene.pictures.push(Canvas::made(Picture::RESPONSE, make).of(measured));
    }

    /// The part of the current octave around the pixel pointed at, else around the largest absolute value of its first difference.
    fn detail(&self, seen: &Seen<Self>, state: &State) -> Option<Detail> {
        let (octave, image) = last_of(state)?;
        let pixel_px = self.shape().pixel_px(state.space.octaves.len() - 1);
        let center = match (seen.point(), octave.differences.first()) {
            (Some(point), _) => point.map(|c| (c / pixel_px).round().max(0.0) as usize),
            (None, Some(difference)) => strongest(difference),
            (None, None) => {
                // The difference that comes next, so that the part stays where it is.
                let mut space = state.space.clone();
                self.shape().add_level(&mut space, state.picture.luma(), &Threads::single());
                strongest(space.octaves.last()?.differences.first()?)
            }
        };
        Some(Detail::around(center, image))
    }

    /// A part of the Gaussian images of the current octave and of their differences so far: a difference of 0 is middle
    /// gray, on one scale for all.
    pub(super) fn octave_tiles(&self, seen: &Seen<Self>) -> Vec<Tile> {
        let state = seen.after.unwrap_or(seen.before);
        let Some(((octave, _), detail)) = last_of(state).zip(self.detail(seen, state)) else { return Vec::new() };
        let [images, differences] =
            [&octave.gaussians, &octave.differences].map(|all| all.iter().map(|image| detail.of(image)));
        let (images, differences): (Vec<_>, Vec<_>) = (images.collect(), differences.collect());
        let most = differences.iter().flat_map(|image| image.cells()).fold(1.0f32, |most, v| most.max(v.abs()));
        // The grays of the sharpest: the others have a smaller range.
        let sharpest = images.first().map_or([0.0, 255.0], range_of);
        let images = IMAGES.into_iter().zip(images).map(|(label, image)| Tile::new(label, image, sharpest));
        let differences =
            DIFFERENCES.into_iter().zip(differences).map(|(label, image)| Tile::new(label, image, [-most, most]));
        images.chain(differences).collect()
    }

    /// The Gaussian images of the octave at work so far.
    pub(super) fn stack(&self, state: &State) -> Option<Stack> {
        let ((octave, _), index) = (last_of(state)?, state.space.octaves.len() - 1);
        let level = |(level, image): (usize, &Arc<Grid<f32>>)| {
            let frame = Arc::new(Frame::gray(image.map(|value| value.round().clamp(0.0, 255.0) as u8)));
            Level::new([Arc::clone(&frame), frame]).named(self.name_of(index, level))
        };
        let all: Vec<Level> = octave.gaussians.iter().enumerate().map(level).collect();
        let floors = vec![Floor::default(); all.len()];
        let at_work = all.len() - 1;
        Some(Stack { levels: Levels { all: all.into(), at_work }, floors })
    }
}

/// The current octave, with its last Gaussian image.
fn last_of(state: &State) -> Option<(&Octave, &Arc<Grid<f32>>)> {
    let octave = state.space.octaves.last()?;
    octave.gaussians.last().map(|image| (octave, image))
}

/// The pixel with the largest absolute value at which an extremum may lie; the first of several.
fn strongest(difference: &Grid<f32>) -> [usize; 2] {
    let (width, height) = difference.size();
    let inside = |extent: usize| BORDER.min(extent / 2)..extent.saturating_sub(BORDER).max(extent / 2 + 1);
    let places = inside(height).flat_map(|y| inside(width).map(move |x| (x, y)));
    let largest = |best: Option<((usize, usize), f32)>, place: (usize, usize)| {
        let value = difference[place].abs();
        best.filter(|(_, most)| *most >= value).or(Some((place, value)))
    };
    places.fold(None, largest).map_or([0; 2], |((x, y), _)| [x, y])
}

/// An absolute value that nearly all pixels stay below, so that a few large ones do not leave the rest gray.
fn scale_of(difference: &Grid<f32>) -> f32 {
    /// 1 of 200 pixels exceeds it.
    const BEYOND: usize = 200;
    /// As many pixels, spread evenly, are enough for a share.
    const SAMPLES: usize = 40_000;
    let step = difference.cells().len().div_ceil(SAMPLES).max(1);
    let mut values: Vec<f32> = difference.cells().iter().step_by(step).map(|v| v.abs()).collect();
    let index = values.len().saturating_sub(1 + values.len() / BEYOND);
    values.select_nth_unstable_by(index, f32::total_cmp).1.max(1.0)
}

fn range_of(image: &Grid<f32>) -> [f32; 2] {
    let ends = |pick: fn(f32, f32) -> f32| image.cells().iter().copied().fold(image[(0, 0)], pick);
    let [low, high] = [ends(f32::min), ends(f32::max)];
    [low, high.max(low + 1.0)]
}

/// The values of an image of an octave at the pixels of the frame, with symbol and title.
fn measured(image: &Arc<Grid<f32>>, pixel_px: f32, (symbol, title): (&str, String)) -> Measured {
    let image = Arc::clone(image);
    Measured::new(symbol, title, move |at| sample(&image, pixel_px, at))
}

/// An image of an octave at the resolution of the frame, in the grays that `shade` gives its values.
fn at_frame(image: &Grid<f32>, pixel_px: f32, (width, height): (usize, usize), shade: impl Fn(f32) -> f32) -> Grid<u8> {
    Grid::from_fn(width, height, |x, y| shade(sample(image, pixel_px, [x, y])).round().clamp(0.0, 255.0) as u8)
}

/// The value of an image of an octave at a pixel of the frame.
fn sample(image: &Grid<f32>, pixel_px: f32, [x, y]: [usize; 2]) -> f32 {
    image.sample(x as f32 / pixel_px, y as f32 / pixel_px)
}
