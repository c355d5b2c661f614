//! Layers, front to back, and the visible part of each.

use super::Setting;
use super::difficulty::Difficulty;
use super::maths::{cos, floor};
use super::motion::{Affine, Motion, grown};
use super::path::Path;
use super::random::{lattice, part};
use super::shape::{Point, Shape, length};
use super::texture::{Rgb, Spot, mix, smooth};

/// The colour of a layer at a spot.
pub type Paint = Box<dyn Fn(Spot) -> Rgb + Send + Sync>;

/// One painted surface of a scene.
pub struct Layer {
    shape: Shape,
    motion: Motion,
    paint: Paint,
    plain: Rgb,
    object: Option<u32>,
}

impl Layer {
    /// A layer of `shape` that moves by `motion`. `plain` is its colour where all texture is gone.
    pub fn new(shape: Shape, motion: Motion, plain: Rgb, paint: impl Fn(Spot) -> Rgb + Send + Sync + 'static) -> Self {
        Self { shape, motion, paint: Box::new(paint), plain, object: None }
    }

    /// The same layer as an object to be tracked.
    pub fn object(mut self, id: u32) -> Self {
        self.object = Some(id);
        self
    }

    /// The same layer, which comes in again from the other side once it has left the picture; it must have an end, and
    /// neither grow nor bend.
    pub fn round(mut self, setting: &Setting) -> Self {
        let radius = self.shape.outline().into_iter().map(length).fold(0.0, f64::max);
        // A frame before it goes over and a frame after it is out of sight too, so no truth tells of the leap.
        self.motion.lap = Some(self.motion.lap_around(MIDDLE, setting.reach + radius, setting.speed));
        self
    }
}

/// A layer at one moment.
struct Placed<'a> {
    layer: &'a Layer,
    time: f64,
    to_layer: Affine,
    to_picture: Affine,
    /// Width of a picture's pixel in the layer's coordinates.
    pixel: f64,
    /// Left, top, right and bottom edge in the picture; infinite if the layer has no end.
    bounds: [f64; 4],
}

impl<'a> Placed<'a> {
    fn new(layer: &'a Layer, camera: &Affine, time: f64) -> Self {
        let to_picture = layer.motion.pose(time).then(camera);
        let to_layer = to_picture.inverse();
        let pixel = to_layer.area().sqrt();
        let mut placed = Self { layer, time, to_layer, to_picture, pixel, bounds: [0.0; 4] };
        placed.bounds = placed.extent();
        placed
    }

    fn extent(&self) -> [f64; 4] {
        let outline = self.layer.shape.outline();
        if outline.is_empty() {
            return [f64::NEG_INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY];
        }
        let none = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        outline
            .iter()
            .map(|&rest| self.forward(rest))
            .fold(none, |[left, top, right, bottom], [x, y]| [left.min(x), top.min(y), right.max(x), bottom.max(y)])
    }

    /// The position in the picture of the layer's point `rest`.
    fn forward(&self, rest: Point) -> Point {
        let bent = self.layer.motion.wave.map_or(rest, |wave| wave.forward(rest, self.time));
        self.to_picture.apply(bent)
    }

    /// The point of the layer at `p` in the picture.
    fn back(&self, p: Point) -> Point {
        let bent = self.to_layer.apply(p);
        self.layer.motion.wave.map_or(bent, |wave| wave.back(bent, self.time))
    }

    fn may_reach(&self, [x, y]: Point) -> bool {
        let [left, top, right, bottom] = self.bounds;
        x > left - 2.0 && x < right + 2.0 && y > top - 2.0 && y < bottom + 2.0
    }

    fn covers(&self, p: Point) -> bool {
        self.may_reach(p) && self.layer.shape.inside(self.back(p)) >= 0.0
    }
}

/// An object at one moment: its bounding box in the picture, and its visibility.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// Its number.
    pub id: u32,
    /// Left, top, right and bottom edge in px.
    pub bounds: [f64; 4],
    /// Share of its pixels that are in the picture and not hidden.
    pub visible: f64,
}

/// A scene's layers, seen by a camera.
pub struct Stage {
    layers: Vec<Layer>,
    difficulty: Difficulty,
    path: Path,
}

impl Stage {
    /// Layers from front to back, the last of which must fill the picture.
    pub fn new(layers: Vec<Layer>, difficulty: Difficulty) -> Self {
        Self { layers, difficulty, path: Path::REST }
    }

    /// The same, seen by a camera that moves along `path`.
    pub fn seen_along(self, path: Path) -> Self {
        Self { path, ..self }
    }

    /// Whether the scene has objects.
    pub fn has_objects(&self) -> bool {
        self.layers.iter().any(|layer| layer.object.is_some())
    }

    /// Everything in its place at frame `t`, which need not be whole.
    pub fn at(&self, t: f64) -> Moment<'_> {
        let d = &self.difficulty;
        let time = t * f64::from(d.speed);
        let camera = camera((d, t), &self.path.pose(time));
        let layers = self.layers.iter().map(|layer| Placed::new(layer, &camera, time)).collect();
        Moment { layers, difficulty: d }
    }
}

/// The scene's middle, in its own units; a scene is drawn for a picture of 320×240.
const MIDDLE: Point = [159.5, 119.5];

/// Pixels of the picture per unit of the scene.
pub fn scale(d: &Difficulty) -> f64 {
    (d.width as f64 / 320.0).min(d.height as f64 / 240.0)
}

/// Largest visible distance from the scene's centre in its units, for any rotation and zoom of the camera.
pub fn reach(d: &Difficulty) -> f64 {
    /// The edge of a layer is soft.
    const MARGIN_PX: f64 = 2.0;
    let least = if d.scale_change < 0.0 { 0.5 } else { 1.0 };
    (length([d.width as f64, d.height as f64]) / 2.0 + MARGIN_PX) / (scale(d) * least)
}

/// The map from the scene to the picture at frame `t`, given the pose of the camera.
fn camera((d, t): (&Difficulty, f64), pose: &Affine) -> Affine {
    let zoom = scale(d) * grown(f64::from(d.scale_change) / 100.0, t);
    let centre = [(d.width - 1) as f64 / 2.0, (d.height - 1) as f64 / 2.0];
    let turns = f64::from(d.rotation) / 360.0 * t;
    let about_middle = Affine::similarity(0.0, 1.0, MIDDLE.map(|c| -c)).then(pose);
    about_middle.then(&Affine::similarity(turns, zoom, centre))
}

/// A scene at one moment.
pub struct Moment<'a> {
    layers: Vec<Placed<'a>>,
    difficulty: &'a Difficulty,
}

impl Moment<'_> {
    /// The colour that the pixel at `p` sees.
    pub fn color(&self, p: Point) -> Rgb {
        let mut color = [0.0; 3];
        let mut left = 1.0;
        for (index, placed) in self.layers.iter().enumerate().filter(|(_, placed)| placed.may_reach(p)) {
            let [x, y] = placed.back(p);
            let spot = Spot { x, y, pixel: placed.pixel };
            let cover = left * spot.cover(placed.layer.shape.inside([x, y]));
            if cover > 0.0 {
                let own = self.surface(index, spot);
                color = std::array::from_fn(|c| color[c] + cover * own[c]);
                left -= cover;
            }
            if left <= 0.0 {
                break;
            }
        }
        color
    }

    /// The colour of a layer at a spot, with the clutter on the rearmost one.
    fn surface(&self, index: usize, spot: Spot) -> Rgb {
        let layer = self.layers[index].layer;
        let own = painted(layer.plain, &layer.paint, spot, self.difficulty);
        if self.difficulty.clutter > 0.0 && index + 1 == self.layers.len() { self.cluttered(own, spot) } else { own }
    }

    /// The colour of the background with patches of the objects' colours and texture.
    fn cluttered(&self, own: Rgb, spot: Spot) -> Rgb {
        /// Side of a patch in units of the scene.
        const SIDE: f64 = 20.0;
        let d = self.difficulty;
        let cell = [spot.x, spot.y].map(|c| floor(c / SIDE));
        let patch = lattice(d.seed.wrapping_add(900), cell[0], cell[1]);
        let count = self.layers.iter().filter(|placed| placed.layer.object.is_some()).count();
        if part(patch, 0) >= f64::from(d.clutter) / 100.0 || count == 0 {
            return own;
        }
        let number = ((part(patch, 1) * count as f64) as usize).min(count - 1);
        let object = self.layers.iter().filter(|placed| placed.layer.object.is_some()).nth(number);
        let Some(Placed { layer, .. }) = object else { return own };
        // About the middle of the object, where all objects have their surface.
        let [x, y] = [spot.x - f64::from(cell[0]) * SIDE, spot.y - f64::from(cell[1]) * SIDE];
        let inside = x.min(SIDE - x).min(y.min(SIDE - y));
        let place = Spot { x: x - SIDE / 2.0, y: y - SIDE / 2.0, ..spot };
        mix(own, painted(layer.plain, &layer.paint, place, d), spot.cover(inside))
    }

    /// Number of the foremost layer whose outline holds `p`.
    pub fn foremost(&self, p: Point) -> Option<usize> {
        self.layers.iter().position(|placed| placed.covers(p))
    }

    /// Whether layer `index` is an object.
    pub fn is_object(&self, index: usize) -> bool {
        self.layers.get(index).is_some_and(|placed| placed.layer.object.is_some())
    }

    /// Where the point of layer `index` that is at `p` now will be at the moment `next`.
    pub fn carry(&self, index: usize, p: Point, next: &Self) -> Option<Point> {
        let (now, then) = (self.layers.get(index)?, next.layers.get(index)?);
        Some(then.forward(now.back(p)))
    }

    /// The map of the rearmost layer from now to the moment `next`; `None` if it bends.
    pub fn background(&self, next: &Self) -> Option<Affine> {
        let (now, then) = (self.layers.last()?, next.layers.last()?);
        now.layer.motion.wave.is_none().then(|| now.to_layer.then(&then.to_picture))
    }

    /// Whether a layer in front of layer `index` covers `p`.
    pub fn hides(&self, index: usize, p: Point) -> bool {
        self.layers.iter().take(index).any(|placed| placed.covers(p))
    }

    /// Whether `p` is nearer to a pixel of the picture than to any outside.
    pub fn in_picture(&self, [x, y]: Point) -> bool {
        let d = self.difficulty;
        x >= -0.5 && y >= -0.5 && x < d.width as f64 - 0.5 && y < d.height as f64 - 0.5
    }

    /// The objects whose edges are at least partly in the picture, in the order of their numbers.
    pub fn sightings(&self) -> Vec<TrackPoint> {
        let objects = self.layers.iter().enumerate();
        let mut seen: Vec<_> = objects.filter_map(|(i, p)| Some(self.sighting(i, p, p.layer.object?))).collect();
        seen.retain(|s| self.meets_picture(s.bounds));
        seen.sort_by_key(|s| s.id);
        seen
    }

    fn meets_picture(&self, [left, top, right, bottom]: [f64; 4]) -> bool {
        let d = self.difficulty;
        right >= -0.5 && bottom >= -0.5 && left < d.width as f64 - 0.5 && top < d.height as f64 - 0.5
    }

    fn sighting(&self, index: usize, placed: &Placed, id: u32) -> TrackPoint {
        let (mut all, mut visible) = (0u32, 0u32);
        let [left, top, right, bottom] = placed.bounds;
        for y in top.ceil() as i64..=bottom.floor() as i64 {
            for x in left.ceil() as i64..=right.floor() as i64 {
                let p = [x as f64, y as f64];
                if placed.covers(p) {
                    all += 1;
                    visible += u32::from(self.in_picture(p) && !self.hides(index, p));
                }
            }
        }
        TrackPoint { id, bounds: placed.bounds, visible: f64::from(visible) / f64::from(all.max(1)) }
    }
}

/// The colour of a surface at a spot, with as much of its texture as the sliders leave.
pub fn painted(plain: Rgb, paint: &Paint, spot: Spot, d: &Difficulty) -> Rgb {
    let contrast = 1.0 - d.low_texture / 100.0;
    let mut color = plain;
    if contrast > 0.0 {
        color = mix(plain, paint(spot), contrast);
    }
    if d.repeating_texture > 0.0 {
        color = mix(color, wallpaper(plain, spot, d, contrast), d.repeating_texture / 100.0);
    }
    color
}

/// The pattern that the repeating texture brings: light and dark spots on a lattice.
fn wallpaper(plain: Rgb, spot: Spot, d: &Difficulty, contrast: f32) -> Rgb {
    let period = f64::from(d.period) / scale(d);
    let seen = smooth((period / spot.pixel * 0.5 - 1.0) as f32);
    let height = (cos(spot.x / period) + cos(spot.y / period)) as f32 * 0.2 * seen * contrast;
    plain.map(|c| (c + 50.0) * (1.0 + height) - 50.0)
}
