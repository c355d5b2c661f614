//! Marks in image pixels: x right, y down.

use std::sync::Arc;

use super::{Canvas, Layer, Levels, Picture, Role};
use crate::data::Mask;
use crate::geometry::Grid;

/// A mark's geometry in image pixels: x right, y down, pixel centres at integers.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// An axis-parallel rectangle by its outer edges.
    Rect {
        /// Left and top edge.
        min: [f32; 2],
        /// Right and bottom edge.
        max: [f32; 2],
    },
    /// Displacements; painters may scale them by one factor, stated in the legend.
    Arrows(Vec<Arrow>),
    /// An ellipse; `angle_rad` turns the first axis from x towards y.
    Ellipse {
        /// Centre.
        center: [f32; 2],
        /// Half axes.
        radii: [f32; 2],
        /// Angle of the first axis in radians.
        angle_rad: f32,
    },
    /// A polyline, or a polygon if closed.
    Path {
        /// Corners.
        points: Vec<[f32; 2]>,
        /// Whether the last corner joins the first.
        closed: bool,
    },
    /// Small crosses or dots.
    Points(Vec<[f32; 2]>),
    /// A short label with its lower left corner at a place.
    Text {
        /// Lower left corner.
        at: [f32; 2],
        /// The label.
        text: String,
    },
    /// A grid of values, one per pixel, painted half-transparent in the colour map; NaN stays clear.
    Heat {
        /// Pixel of the grid's first cell.
        origin: [f32; 2],
        /// The values.
        values: Grid<f32>,
    },
    /// A displacement `[u, v]` in px for every pixel, NaN where unknown: painters draw a subset as arrows, and
    /// all as colours over the picture.
    Flow {
        /// Pixel of the grid's first cell.
        origin: [f32; 2],
        /// The displacements.
        values: Grid<[f32; 2]>,
    },
    /// Pixels that belong to something, painted half-transparent in the colour of the role.
    Mask(Arc<Mask>),
    /// Which region each pixel belongs to, painted half-transparent in a colour for each; 0 stays clear.
    Labels(Arc<Grid<u32>>),
}

impl Shape {
    /// The rectangle around `width × height` whole pixels whose first is `(x, y)`.
    pub fn pixels(x: i32, y: i32, width: usize, height: usize) -> Self {
        let min = [x as f32 - 0.5, y as f32 - 0.5];
        Shape::Rect { min, max: [min[0] + width as f32, min[1] + height as f32] }
    }

    /// An open line through these points.
    pub fn line(points: Vec<[f32; 2]>) -> Self {
        Shape::Path { points, closed: false }
    }

    /// A closed line through these points.
    pub fn outline(points: Vec<[f32; 2]>) -> Self {
        Shape::Path { points, closed: true }
    }

    /// A circle with its radius in px.
    pub fn circle(center: [f32; 2], radius: f32) -> Self {
        Shape::Ellipse { center, radii: [radius; 2], angle_rad: 0.0 }
    }

    /// Values of all pixels of the picture; NaN where there is none.
    pub fn heat(values: Grid<f32>) -> Self {
        Shape::Heat { origin: [0.0; 2], values }
    }

    /// Whether it can be drawn: every number of its geometry is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            // There may be many, and they are asked often.
            Shape::Arrows(arrows) => {
                arrows.iter().all(|arrow| arrow.from.iter().chain(&arrow.to).all(|c| c.is_finite()))
            }
            other => other.coordinates().iter().all(|c| c.is_finite()),
        }
    }

    /// Whether it is a layer of colours, one for each pixel, below all lines.
    pub fn is_layer(&self) -> bool {
        matches!(self, Shape::Heat { .. } | Shape::Mask(_) | Shape::Labels(_))
    }

    /// As [`Scene::same`].
    fn same(&self, other: &Shape) -> bool {
        let bits =
            |a: &[f32], b: &[f32]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
        match (self, other) {
            (Shape::Heat { origin, values }, Shape::Heat { origin: place, values: others }) => {
                origin == place && values.size() == others.size() && bits(values.cells(), others.cells())
            }
            (Shape::Flow { origin, values }, Shape::Flow { origin: place, values: others }) => {
                let [cells, others_cells] = [values, others].map(|grid| grid.cells().as_flattened());
                origin == place && values.size() == others.size() && bits(cells, others_cells)
            }
            _ => self == other,
        }
    }

    /// The same on a picture `factor` times as wide and high. A pixel becomes `factor` × `factor` of them.
    #[must_use]
    pub fn enlarged(self, factor: usize) -> Self {
        let times = |c: f32| c * factor as f32;
        let place = |point: [f32; 2]| point.map(times);
        // The outer edge of the first pixel is enlarged, not its middle.
        let first = |origin: [f32; 2]| origin.map(|c| times(c - 0.5) + 0.5);
        match self {
            Shape::Rect { min, max } => Shape::Rect { min: place(min), max: place(max) },
            Shape::Arrows(arrows) => {
                Shape::Arrows(arrows.into_iter().map(|a| Arrow { from: place(a.from), to: place(a.to) }).collect())
            }
            Shape::Ellipse { center, radii, angle_rad } => {
                Shape::Ellipse { center: place(center), radii: place(radii), angle_rad }
            }
            Shape::Path { points, closed } => Shape::Path { points: points.into_iter().map(place).collect(), closed },
            Shape::Points(points) => Shape::Points(points.into_iter().map(place).collect()),
            Shape::Text { at, text } => Shape::Text { at: place(at), text },
            Shape::Heat { origin, values } => {
                let (width, height) = values.size();
                let values = Grid::from_fn(width * factor, height * factor, |x, y| values[(x / factor, y / factor)]);
                Shape::Heat { origin: first(origin), values }
            }
            Shape::Flow { origin, values } => {
                let (width, height) = values.size();
                let values =
                    Grid::from_fn(width * factor, height * factor, |x, y| values[(x / factor, y / factor)].map(times));
                Shape::Flow { origin: first(origin), values }
            }
            Shape::Mask(mask) => {
                let (width, height) = mask.size();
                let is_set = |x: usize, y: usize| mask.get(x / factor, y / factor);
                Shape::Mask(Arc::new(Mask::from_fn(width * factor, height * factor, is_set)))
            }
            Shape::Labels(labels) => {
                let (width, height) = labels.size();
                let label = |x: usize, y: usize| labels[(x / factor, y / factor)];
                Shape::Labels(Arc::new(Grid::from_fn(width * factor, height * factor, label)))
            }
        }
    }

    /// Every number of the shape that must be finite for it to be drawn.
    pub fn coordinates(&self) -> Vec<f32> {
        match self {
            Shape::Rect { min, max } => [*min, *max].concat(),
            Shape::Arrows(arrows) => arrows.iter().flat_map(|a| [a.from[0], a.from[1], a.to[0], a.to[1]]).collect(),
            Shape::Ellipse { center, radii, angle_rad } => {
                center.iter().chain(radii).copied().chain([*angle_rad]).collect()
            }
            Shape::Path { points, .. } | Shape::Points(points) => points.concat(),
            Shape::Text { at, .. } => at.to_vec(),
            Shape::Heat { origin, .. } | Shape::Flow { origin, .. } => origin.to_vec(),
            Shape::Mask(_) | Shape::Labels(_) => Vec::new(),
        }
    }
}

/// A displacement by its start and end in image pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Start; painters draw a dot there.
    pub from: [f32; 2],
    /// End.
    pub to: [f32; 2],
}

/// Default number of arrows along the longer side of a picture, approximately.
const ARROWS: usize = 36;

/// Default distance between arrows of a dense field in px, for a picture of this size.
pub fn arrow_spacing((width, height): (usize, usize)) -> usize {
    (width.max(height) / ARROWS).max(5)
}

/// One mark of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The picture that it lies on.
    pub on: Picture,
    /// Its role.
    pub role: Role,
    /// The identity of its object, if objects are distinguished: each has a colour of its own instead of the role's.
    pub of: Option<u32>,
    /// Where it is.
    pub shape: Shape,
}

/// A line from a point of one picture to a point of another, such as a match.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Its role.
    pub role: Role,
    /// The pictures and the points on them.
    pub ends: [(Picture, [f32; 2]); 2],
}

/// All marks over a pair of pictures, back to front, with their legend.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Marks, back to front.
    pub marks: Vec<Mark>,
    /// Lines between pictures, back to front, over all marks. Where one picture alone is shown, the displacement is drawn there.
    pub links: Vec<Link>,
    /// The meaning of each role in this scene.
    pub legend: Vec<(Role, &'static str)>,
    /// The pyramid of the step, if any: its pictures can be shown below the marks.
    pub levels: Option<Levels>,
    /// The pictures of the step, up to four, if not frames t and t + 1.
    pub pictures: Vec<Canvas>,
    /// The quantities of a model that can be shown over frame t.
    pub layers: Vec<Layer>,
    /// The name of the values of a heat map, if no surface gives it: `λ`.
    pub heat: Option<&'static str>,
    /// The values at both ends of the colours of a heat map, if they are known before all of it is; else its own.
    pub heat_scale: Option<[f32; 2]>,
    /// Whether the step sums up the whole picture, so that no part of it is magnified.
    pub is_overview: bool,
    /// The outer edges, min and max, of the pixels of frame t that the step is about, if its marks do not tell.
    pub work: Option<[[f32; 2]; 2]>,
    /// The roles that the sentence of the step speaks of: a mark that is the only one of its role stays in sight.
    pub spoken: Vec<Role>,
}

impl Scene {
    /// Whether both look the same; NaN equals NaN.
    pub fn same(&self, other: &Scene) -> bool {
        let same = |(a, b): (&Mark, &Mark)| a.on == b.on && a.role == b.role && a.of == b.of && a.shape.same(&b.shape);
        self.legend == other.legend
            && self.levels == other.levels
            && self.pictures == other.pictures
            && self.layers == other.layers
            && self.heat == other.heat
            && self.heat_scale == other.heat_scale
            && self.links == other.links
            && self.is_overview == other.is_overview
            && self.work == other.work
            && self.spoken == other.spoken
            && self.marks.len() == other.marks.len()
            && self.marks.iter().zip(&other.marks).all(same)
    }

    /// Adds a mark on top of the others.
    pub fn mark(&mut self, on: Picture, role: Role, shape: Shape) {
        self.marks.push(Mark { on, role, of: None, shape });
    }

    /// Adds a mark, with the meaning of its role to the legend.
    pub fn draw(&mut self, on: Picture, (role, meaning): (Role, &'static str), shape: Shape) {
        self.mark(on, role, shape);
        self.legend(role, meaning);
    }

    /// Adds a mark that belongs to object `id`, which has a colour of its own, on top of the others.
    pub fn mark_of(&mut self, id: u32, on: Picture, role: Role, shape: Shape) {
        self.marks.push(Mark { on, role, of: Some(id), shape });
    }

    /// Adds the marks and the legend of `other`, a scene on a picture `factor` times smaller.
    pub fn add_enlarged(&mut self, other: Scene, factor: usize) {
        let Scene { marks, legend, heat_scale, is_overview, work, .. } = other;
        self.is_overview |= is_overview;
        self.work = self.work.or(work.map(|edges| edges.map(|edge| edge.map(|c| c * factor as f32))));
        // One scale for all that is drawn together.
        self.heat_scale = match (self.heat_scale, heat_scale) {
            (Some([low, high]), Some([lower, higher])) => Some([low.min(lower), high.max(higher)]),
            (scale, other) => scale.or(other),
        };
        self.marks.extend(marks.into_iter().map(|mark| Mark { shape: mark.shape.enlarged(factor), ..mark }));
        legend.into_iter().for_each(|(role, meaning)| self.legend(role, meaning));
    }

    /// Adds the meaning of `role` to the legend, once.
    pub fn legend(&mut self, role: Role, meaning: &'static str) {
        if !self.legend.iter().any(|(r, _)| *r == role) {
            self.legend.push((role, meaning));
        }
    }
}
