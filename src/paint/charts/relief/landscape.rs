//! A surface as a landscape that rises out of the picture on which it stands.
//!
//! The picture is the ground of the world in which the surface lies. As long as it is flat, the camera sees it exactly where it
//! is placed; leaned back, the camera stands where one looks from on the surface in its chart.
//!
//! Mesh, axes, pins and the renderer of the graphics card are those of the chart.

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec3};
use motionscope_core::geometry::Grid;
use motionscope_core::scene::{self, Footing, Readout, Role, Step, Surface};

use super::super::super::marks::Placement;
use super::super::super::primitive::{Arrow, Arrows, Line, Point, Primitive, Rect, Trails};
use super::super::super::{ColorMap, Theme};
use super::super::canvas::{Canvas, middle, solid};
use super::super::heat_map::any_cost;
use super::super::{ChartStyle, Orbit, Screen};
use super::mesh::{self, Bench};
use super::{polygons, stand};

const FIELD_OF_VIEW_RAD: f32 = 0.5;
/// How far the surface reaches from the middle of the ground, with what stands on it and its numbers.
const REACH: f32 = 1.5;
/// What the camera looks at once the picture is leaned back: above the ground, in the middle of what rises from it.
const TARGET: Vec3 = Vec3::new(0.0, 0.25, 0.0);
/// At this distance from the middle the leaned picture begins to fade, and at that one it is gone.
const FADES: [f32; 2] = [3.0, 11.0];
/// How much of the picture is left where the surface stands on it: numbers are read on it.
const DIMMED: f32 = 0.6;
/// The least height of a landscape: what is quite flat cannot be turned back into a place.
const LEAST_RISE: f32 = 1e-4;
/// How much steeper than on its chart one looks down on a surface: the picture under it is to be seen as well.
const STEEPER_RAD: f32 = 0.22;
/// The height from which a candidate falls on the surface, whose highest cost is at 1.
const DROP: f32 = 1.2;
/// Side of the triangles of the ground in its middle, and how much longer each is than the one before it.
const FINEST: f32 = 0.25;
const GROWTH: f32 = 1.16;
/// Where the eye sees anything, as shares of its distance from the target.
const SEEN: [f32; 2] = [0.05, 40.0];

/// The readout of a step that can rise out of a picture.
pub fn standing(step: &Step) -> Option<&Readout> {
    step.readouts.iter().find(|readout| readout.footing().is_some())
}

/// The surface that rises out of a picture at a step, with the best candidates of the searches `beside` it on the same terrain.
pub fn risen<'a>(step: &Step, beside: impl Iterator<Item = (&'static str, &'a Step)>) -> Option<Surface> {
    let mut surface = standing(step)?.landscape()?;
    let others = beside.filter_map(|(name, step)| Some((name, standing(step)?.landscape()?)));
    let best = others.filter_map(|(name, other)| Some((name, Role::Best, on_same_terrain(&surface, &other)?)));
    let best: Vec<_> = best.collect();
    surface.named.extend(best);
    Some(surface)
}

/// The best of another search so far, where it searches the terrain of `surface`.
fn on_same_terrain(surface: &Surface, other: &Surface) -> Option<[f32; 2]> {
    let place = |of: &Surface| of.footing.as_ref().map(|footing| (footing.on, footing.at, footing.px));
    let is_same = surface.title == other.title && place(surface) == place(other);
    other.best.filter(|_| is_same).map(|best| best.map(|c| c as f32))
}

/// How far a picture is leaned back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lean {
    /// From 0, flat, to 1.
    pub amount: f32,
    /// From where one looks once it is leaned back.
    pub orbit: Orbit,
}

/// A surface on its picture, and the camera over both.
#[derive(Clone, Copy, Debug)]
pub struct Landscape<'a> {
    surface: &'a Surface,
    footing: &'a Footing,
    bench: Bench,
    /// Where the picture lies while it is flat.
    flat: Placement,
    /// The camera.
    pub screen: Screen,
    /// Where it stands.
    pub eye: Vec3,
    /// How far everything has risen, from 0 to 1.
    pub rise: f32,
}

/// A corner of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where it is seen, in points.
    pub at: Point,
    /// What it shows, in px of the picture, whose pixel centres lie at integers.
    pub pixel: [f32; 2],
    /// How opaque it is, from 0 to 1.
    pub opacity: f32,
}

impl<'a> Landscape<'a> {
    /// The landscape of `surface` in `pane`, on a picture that lies at `flat` before it is leaned back.
    pub fn new(
        (surface, footing): (&'a Surface, &'a Footing),
        (flat, pane): (Placement, Rect),
        Lean { amount, orbit }: Lean,
    ) -> Self {
        let amount = amount.clamp(0.0, 1.0);
        let rise = amount * amount * (3.0 - 2.0 * amount);
        let nowhere = Screen { rect: pane, clip_from_world: Mat4::IDENTITY };
        let bench = Bench::new(surface);
        let mut all = Self { surface, footing, bench, flat, screen: nowhere, eye: Vec3::Y, rise };
        all.look_from(orbit);
        all
    }

    /// Places the camera: straight above the middle of the pane, or where `orbit` has it, or between.
    fn look_from(&mut self, orbit: Orbit) {
        use std::f32::consts::{FRAC_PI_2, TAU};
        let pane = self.screen.rect;
        let [width, height] = pane.size().map(|side| side.max(1.0));
        let (aspect, slope) = ((width / height).clamp(0.05, 20.0), (FIELD_OF_VIEW_RAD / 2.0).tan());
        let between = |from: f32, to: f32| from + (to - from) * self.rise;
        let points_of_unit = self.flat.zoom / self.unit();
        let above = self.ground(self.flat.pixel(middle(&pane)));
        let distance = [height / 2.0 / points_of_unit / slope, REACH / slope / aspect.min(1.0) / orbit.zoom];
        let distance = between(distance[0].ln(), distance[1].ln()).exp();
        let target = above.lerp(TARGET, self.rise);
        // The shorter way round.
        let yaw = between(0.0, orbit.yaw_rad - TAU * (orbit.yaw_rad / TAU).round());
        let (sin_yaw, cos_yaw) = yaw.sin_cos();
        let (sin_pitch, cos_pitch) = between(FRAC_PI_2, (orbit.pitch_rad + STEEPER_RAD).min(FRAC_PI_2)).sin_cos();
        self.eye = target + distance * Vec3::new(cos_pitch * sin_yaw, sin_pitch, cos_pitch * cos_yaw);
        let up = Vec3::new(-sin_pitch * sin_yaw, cos_pitch, -sin_pitch * cos_yaw);
        let [near, far] = SEEN.map(|share| share * distance);
        let seen = perspective(FIELD_OF_VIEW_RAD, aspect, near, far) * look_at_mat4(self.eye, target, up);
        let heights = Mat4::from_scale(Vec3::new(1.0, self.rise.max(LEAST_RISE), 1.0));
        self.screen.clip_from_world = seen * heights;
    }

    /// The length of a px of the picture in the world.
    fn unit(&self) -> f32 {
        let [from, to] = [0.0, 1.0].map(|u| self.bench.place([u, 0.0], self.bench.bottom).x);
        (to - from) / self.footing.px
    }

    /// Where a point of the picture lies in the world.
    fn ground(&self, pixel: [f32; 2]) -> Vec3 {
        let displacement = [0, 1].map(|i| (pixel[i] - self.footing.at[i]) / self.footing.px);
        self.bench.place(displacement, self.bench.bottom)
    }

    /// Where a place of the world is seen, if it lies before the eye.
    fn project(&self, place: Vec3) -> Option<Point> {
        let clip = self.screen.clip_from_world * place.extend(1.0);
        (clip.w > 0.0 && clip.z > 0.0).then(|| self.screen.project(place).0)
    }

    /// Where the cost at a displacement is seen.
    pub fn seen(&self, displacement: [i32; 2]) -> Option<Point> {
        let cost = any_cost(self.surface, displacement)?;
        self.project(self.bench.place(displacement.map(|c| c as f32), cost))
    }

    /// Where the ball is after a share of the last move of an iteration.
    pub fn rolling(&self, share: f32) -> Option<Point> {
        let [.., from, to] = self.surface.trail[..] else { return None };
        let at = [0, 1].map(|i| from[i] + (to[i] - from[i]) * share);
        self.project(self.bench.place(at, self.surface.interpolated(at)?))
    }

    /// Where the candidate under test is on its way down to its cost, of which it has fallen a share.
    pub fn falling(&self, share: f32) -> Option<Point> {
        let pins = mesh::pins(self.surface, &self.bench);
        let pin = pins.into_iter().find(|pin| pin.role == Role::Candidate && pin.name.is_empty())?;
        let foot = self.bench.place(pin.at, pin.cost);
        let height = DROP + (foot.y - DROP) * share * share;
        self.project(Vec3 { y: height, ..foot })
    }

    /// Whether its costs were worked out by events that one can go to.
    pub fn has_events(&self) -> bool {
        self.surface.events.cells().iter().any(Option::is_some)
    }

    /// The displacement whose cost is seen next to `at`, no further from it than `reach` points; one that was tested, if there is any.
    pub fn displacement_at(&self, at: Point, reach: f32) -> Option<[i32; 2]> {
        let [width, height] = self.bench.size;
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let near = |cell: [usize; 2]| {
            let displacement = [0, 1].map(|i| self.bench.origin[i] + cell[i] as i32);
            let [x, y] = self.seen(displacement)?;
            let far = (x - at[0]).hypot(y - at[1]);
            let is_untested = self.surface.events.get(cell[0], cell[1]).is_none_or(Option::is_none);
            (far <= reach).then_some(((is_untested, far), displacement))
        };
        let nearer = |a: &(bool, f32), b: &(bool, f32)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
        cells.filter_map(near).min_by(|a, b| nearer(&a.0, &b.0)).map(|(_, displacement)| displacement)
    }

    /// A picture of `size` pixels on the ground, as triangles of corners.
    pub fn picture(&self, size: (usize, usize)) -> (Vec<Corner>, Vec<[usize; 3]>) {
        let [from, to] = [[-0.5; 2], [size.0 as f32 - 0.5, size.1 as f32 - 0.5]].map(|corner| self.ground(corner));
        let (columns, rows) = (lines([from.x, to.x]), lines([from.z, to.z]));
        let mut corners = Vec::with_capacity(columns.len() * rows.len());
        let mut seen = Vec::with_capacity(columns.len() * rows.len());
        for (&z, &x) in rows.iter().flat_map(|z| columns.iter().map(move |x| (z, x))) {
            seen.push(self.project(Vec3::new(x, 0.0, z)).map(|at| {
                corners.push(Corner { at, pixel: self.pixel([x, z]), opacity: self.opacity(x.hypot(z)) });
                corners.len() - 1
            }));
        }
        let mut triangles = Vec::new();
        for (row, column) in (1..rows.len()).flat_map(|row| (1..columns.len()).map(move |column| (row, column))) {
            let corner = |left: usize, up: usize| seen[(row - up) * columns.len() + column - left];
            let [a, b, c, d] = [corner(1, 1), corner(0, 1), corner(0, 0), corner(1, 0)];
            let triangle = |[a, b, c]: [Option<usize>; 3]| Some([a?, b?, c?]);
            triangles.extend([[a, b, c], [a, c, d]].into_iter().filter_map(triangle));
        }
        (corners, triangles)
    }

    /// The pane as pixels, `density` of them for a point: the picture of these `pixels` on the ground.
    pub fn pictured(&self, pixels: &Grid<[u8; 4]>, density: f32) -> Grid<[u8; 4]> {
        let rect = self.screen.rect;
        let [width, height] = rect.size().map(|side| (side * density).round().max(1.0) as usize);
        let world_from_clip = self.screen.clip_from_world.inverse();
        // Where the line of sight through a point of the pane meets the ground.
        let met = |[x, y]: [f32; 2]| {
            let clip = [2.0 * x / width as f32 - 1.0, 1.0 - 2.0 * y / height as f32];
            let [near, far] = [0.0, 1.0].map(|z| world_from_clip.project_point3(Vec3::new(clip[0], clip[1], z)));
            let share = near.y / (near.y - far.y);
            (near.y > far.y && (0.0..=1.0).contains(&share)).then(|| near.lerp(far, share))
        };
        let sample = |at: [f32; 2]| {
            let place = met(at)?;
            let [x, y] = self.pixel([place.x, place.z]).map(f32::round);
            let color = pixels.get((x >= 0.0).then_some(x as usize)?, (y >= 0.0).then_some(y as usize)?)?;
            Some((*color, self.opacity(place.x.hypot(place.z))))
        };
        Grid::from_fn(width, height, |x, y| {
            let at = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
            let mut sum = [0.0; 4];
            for (color, opacity) in at.iter().filter_map(|[dx, dy]| sample([x as f32 + dx, y as f32 + dy])) {
                let weight = opacity * f32::from(color[3]) / 255.0;
                (0..3).for_each(|i| sum[i] += weight * f32::from(color[i]));
                sum[3] += weight;
            }
            let [r, g, b] = [0, 1, 2].map(|i| (sum[i] / sum[3].max(1e-6)).round() as u8);
            [r, g, b, (255.0 * sum[3] / at.len() as f32).round() as u8]
        })
    }

    /// The point of the picture at a place of the ground.
    fn pixel(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        let (zero, unit) = (self.ground([0.0; 2]), self.unit());
        [(x - zero.x) / unit, (z - zero.z) / unit]
    }

    /// How opaque the ground is at a distance from its middle.
    fn opacity(&self, distance: f32) -> f32 {
        let far = ((distance - FADES[0]) / (FADES[1] - FADES[0])).clamp(0.0, 1.0);
        (1.0 - far * self.rise) * (1.0 - (1.0 - DIMMED) * self.rise)
    }

    /// What lies on the flat picture, as it lies on the ground; pictures are left out.
    pub fn laid(&self, primitives: Vec<Primitive>) -> Vec<Primitive> {
        primitives.into_iter().filter_map(|primitive| self.laid_one(primitive)).collect()
    }

    fn laid_one(&self, primitive: Primitive) -> Option<Primitive> {
        let to = |point: Point| self.project(self.ground(self.flat.pixel(point)));
        let along = |points: &[Point]| points.iter().map(|point| to(*point)).collect::<Option<Vec<_>>>();
        Some(match primitive {
            Primitive::Polygon { points, color } => Primitive::Polygon { points: along(&points)?, color },
            Primitive::Polyline { points, closed, stroke } => {
                Primitive::Polyline { points: along(&points)?, closed, stroke }
            }
            Primitive::Disc { center, radius, color } => Primitive::Disc { center: to(center)?, radius, color },
            Primitive::Text(line) => Primitive::Text(Line { at: to(line.at)?, ..line }),
            Primitive::Trails(Trails { lines, pen }) => {
                let laid = |(points, strength): (Vec<Point>, f32)| Some((along(&points)?, strength));
                Primitive::Trails(Trails { lines: lines.into_iter().filter_map(laid).collect(), pen })
            }
            Primitive::Arrows(arrows) => {
                let ends = |Arrow { from, to: tip, .. }: Arrow| Some(scene::Arrow { from: to(from)?, to: to(tip)? });
                Primitive::Arrows(Arrows::of(arrows.iter().filter_map(ends).collect(), arrows.pen))
            }
            Primitive::Image { .. } => return None,
        })
    }

    /// What stands behind the surface, and before it; nothing while it rises.
    pub fn stand(&self, theme: Theme) -> [Vec<Primitive>; 2] {
        if self.rise < 1.0 {
            return [Vec::new(), Vec::new()];
        }
        let [mut behind, before] = stand(self.surface, (self.screen, self.eye), false, theme);
        for post in self.posts() {
            behind.line(post.to_vec(), false, solid(1.0, theme.chrome().dim));
        }
        [behind, before].map(Canvas::into_primitives)
    }

    /// Where the corners of the surface stand on the ground.
    fn posts(&self) -> impl Iterator<Item = [Point; 2]> {
        let [right, bottom] = self.bench.size.map(|side| side.saturating_sub(1));
        [[0, 0], [right, 0], [right, bottom], [0, bottom]].into_iter().filter_map(|cell| {
            let cost = self.surface.cost(cell[0], cell[1])?;
            let foot = |cost| self.project(self.bench.place(self.bench.displacement(cell), cost));
            Some([foot(self.bench.bottom)?, foot(cost)?])
        })
    }

    /// The surface itself.
    pub fn polygons(&self, (theme, colors, density): (Theme, ColorMap, f32)) -> Vec<Primitive> {
        polygons(self.surface, (&self.screen, self.eye), ChartStyle { theme, colors, density })
    }
}

/// Places between two, closer to each other about 0.
fn lines([from, to]: [f32; 2]) -> Vec<f32> {
    let outwards = |end: f32| {
        let lengths = std::iter::successors(Some(FINEST), |length| Some(length * GROWTH));
        let places = lengths.scan(0.0, |at, length| {
            *at += length;
            Some(*at)
        });
        places.take_while(move |at| *at < end.abs()).map(move |at| at.copysign(end))
    };
    let inner = [from, to].into_iter().flat_map(outwards).chain([0.0]).filter(|at| *at > from && *at < to);
    let mut all: Vec<f32> = inner.chain([from, to]).collect();
    all.sort_by(f32::total_cmp);
    all
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Picture;

    use super::*;

    const PANE: Rect = Rect { min: [20.0, 10.0], max: [660.0, 490.0] };

    fn surface() -> Surface {
        let values = Grid::from_fn(17, 17, |x, y| ((x as f32 - 10.0).powi(2) + (y as f32 - 5.0).powi(2)) * 7.0);
        let footing = Some(Footing::new(Picture::NEXT, [52.5, 41.5]).enlarged(2.0));
        Surface { footing, best: Some([2, -3]), ..Surface::new("SAD", [-8, -8], values, Grid::new(17, 17, Some(1))) }
    }

    fn landscape(surface: &Surface, amount: f32) -> Landscape<'_> {
        let footing = surface.footing.as_ref().expect("a footing");
        let flat = Placement::new([-30.0, -60.0], 4.0);
        Landscape::new((surface, footing), (flat, PANE), Lean { amount, orbit: Orbit::default() })
    }

    #[test]
    fn a_flat_landscape_lies_exactly_on_its_picture() {
        let surface = surface();
        let flat = landscape(&surface, 0.0);
        let (corners, triangles) = flat.picture((160, 120));
        assert!(!triangles.is_empty());
        for corner in &corners {
            let there = flat.flat.at(corner.pixel);
            let off = (corner.at[0] - there[0]).hypot(corner.at[1] - there[1]);
            assert!(off < 0.05 && corner.opacity == 1.0, "{corner:?} instead of {there:?}");
        }
        // The cost at (2, −3) of a level of half the size stands 4 px right of its block's centre, and 6 px above it.
        let seen = flat.project(flat.bench.place([2.0, -3.0], 0.0)).expect("seen");
        let pixel = flat.flat.pixel(seen);
        let at = surface.footing.as_ref().expect("a footing").at;
        assert_eq!(at, [105.5, 83.5]);
        assert!((0..2).all(|i| (pixel[i] - at[i] - [4.0, -6.0][i]).abs() < 0.05), "{pixel:?}");
    }

    #[test]
    fn a_leaned_picture_is_seen_under_what_rises_from_it() {
        let surface = surface();
        let leaned = landscape(&surface, 1.0);
        let [foot, top] = [0.0, 400.0].map(|cost| leaned.project(leaned.bench.place([-6.0, 4.0], cost)).expect("seen"));
        assert!(top[1] < foot[1] - 5.0, "{top:?} over {foot:?}");
        for cell in [[-8.0, -8.0], [8.0, -8.0], [8.0, 8.0], [-8.0, 8.0], [2.0, -3.0]] {
            let at = leaned.project(leaned.bench.place(cell, 0.0)).expect("seen");
            assert!((0..2).all(|i| PANE.min[i] < at[i] && at[i] < PANE.max[i]), "{cell:?} at {at:?}");
        }
        let (corners, triangles) = leaned.picture((160, 120));
        assert!(triangles.iter().flatten().all(|index| *index < corners.len()));
        let [near, far] = [[105.5, 83.5], [-0.5, -0.5]].map(|pixel| {
            let next = |a: &&Corner, b: &&Corner| {
                let far = |c: &Corner| (c.pixel[0] - pixel[0]).hypot(c.pixel[1] - pixel[1]);
                far(a).total_cmp(&far(b))
            };
            corners.iter().min_by(next).expect("corners").opacity
        });
        assert!(near > far, "it fades: {near} {far}");
    }

    #[test]
    fn a_flat_ground_has_the_pixels_of_its_picture() {
        let (surface, pixels) = (surface(), Grid::from_fn(160, 120, |x, y| [x as u8, y as u8, 9, 255]));
        let flat = landscape(&surface, 0.0);
        let ground = flat.pictured(&pixels, 1.0);
        assert_eq!(ground.size(), (640, 480));
        for pixel in [[20, 30], [100, 60], [150, 110]] {
            let [x, y] = flat.flat.at(pixel.map(|c| c as f32));
            let seen = ground[((x - PANE.min[0]) as usize, (y - PANE.min[1]) as usize)];
            assert_eq!(seen, [pixel[0] as u8, pixel[1] as u8, 9, 255]);
        }
        assert_eq!(ground[(639, 240)][3], 0, "beyond the picture there is nothing");
        let leaned = landscape(&surface, 1.0).pictured(&pixels, 0.5);
        assert_eq!(leaned.size(), (320, 240));
    }

    #[test]
    fn a_ball_rolls_over_the_surface_along_the_last_move() {
        let surface = Surface { trail: vec![[-8.0, -8.0], [-4.0, -1.0], [2.0, -3.0]], ..surface() };
        let leaned = landscape(&surface, 1.0);
        for (share, at) in [(0.0, [-4.0, -1.0]), (0.5, [-1.0, -2.0]), (1.0, [2.0, -3.0])] {
            let cost = surface.interpolated(at).expect("inside");
            let on_surface = leaned.project(leaned.bench.place(at, cost)).expect("seen");
            assert_eq!(leaned.rolling(share), Some(on_surface), "after {share} of its way");
        }
        let of = |trail: Vec<[f32; 2]>| Surface { trail, ..surface.clone() };
        assert_eq!(landscape(&of(vec![[2.0, -3.0]]), 1.0).rolling(0.5), None, "it has not moved yet");
        assert_eq!(landscape(&of(vec![[2.0, -3.0], [20.0, 0.0]]), 1.0).rolling(1.0), None, "beyond the surface");
    }

    #[test]
    fn a_displacement_is_found_where_it_is_seen() {
        let surface = surface();
        for amount in [0.0, 0.4, 1.0] {
            let landscape = landscape(&surface, amount);
            for displacement in [[2, -3], [-8, -8], [5, 7]] {
                let at = landscape.seen(displacement).expect("seen");
                assert_eq!(landscape.displacement_at(at, 3.0), Some(displacement), "{amount}");
            }
            assert_eq!(landscape.displacement_at([-500.0, 0.0], 3.0), None);
        }
    }
}
