//! The cost surface as triangles in space.

use glam::Vec3;
use motionscope_core::scene::{Role, Surface};

use super::super::super::{Color, ColorMap, Theme, number};
use super::super::heat_map::{Shades, any_cost};

/// How far costs that the search did not work out go over into gray, and this gray.
const FAINT: f32 = 0.7;
const FAINT_INTO: Color = Color([128, 128, 128, 255]);
/// How high the figures of single cells lie over their cost.
const RAISED: f32 = 0.006;
/// Height of the largest cost over the ground, whose longer side is 2.
const HEIGHT: f32 = 1.0;
/// Height of the pin at the best, unless its cost is higher.
const BEST_PIN: f32 = 0.86 * HEIGHT;
/// How high the pin of a place with a name stands over its cost.
const NAMED_PIN: f32 = 0.3 * HEIGHT;

/// A corner of a triangle, as the graphics card reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Where it is.
    pub place: [f32; 3],
    /// Across the surface; it may point to either side.
    pub normal: [f32; 3],
    /// Red, green, blue, opaque.
    pub color: [u8; 4],
    /// Column and row of the surface, whole at its vertices; halves elsewhere, where no lines are drawn.
    pub grid: [f32; 2],
}

/// Triangles, three indices each.
#[derive(Clone, Debug, Default)]
pub struct Relief {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Which corners belong together.
    pub indices: Vec<u32>,
}

/// Where displacements and costs are in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bench {
    /// Displacement of the first cell.
    pub origin: [i32; 2],
    /// Columns and rows.
    pub size: [usize; 2],
    /// The cost of the ground: 0, or less where a similarity is below it.
    pub bottom: f32,
    /// The largest cost so far.
    pub top: f32,
}

impl Bench {
    /// The bench of a surface.
    pub fn new(surface: &Surface) -> Self {
        let (width, height) = surface.values.size();
        let top = surface.range().map_or(1.0, |[_, high]| surface.scale.map_or(high, |scale| scale[1].max(high)));
        let others = || surface.faint().flat_map(|costs| costs.cells()).copied().filter(|cost| cost.is_finite());
        let top = others().fold(top, f32::max);
        let top = if top > 0.0 { top } else { 1.0 };
        let bottom = others().fold(surface.range().map_or(0.0, |[low, _]| low.min(0.0)), f32::min);
        Self { origin: surface.origin, size: [width, height], bottom, top }
    }

    /// Half the ground's extent along u and v.
    pub fn half(&self) -> [f32; 2] {
        let spans = self.size.map(|n| n.saturating_sub(1).max(1) as f32);
        spans.map(|span| span / spans[0].max(spans[1]))
    }

    /// The displacement of a column and row.
    pub fn displacement(&self, at: [usize; 2]) -> [f32; 2] {
        [0, 1].map(|i| self.origin[i] as f32 + at[i] as f32)
    }

    /// The place of a cost at a displacement.
    pub fn place(&self, [u, v]: [f32; 2], cost: f32) -> Vec3 {
        let half = self.half();
        let along = |c: f32, i: usize| {
            let span = self.size[i].saturating_sub(1).max(1) as f32;
            ((c - self.origin[i] as f32) / span * 2.0 - 1.0) * half[i]
        };
        Vec3::new(along(u, 0), self.height(cost), along(v, 1))
    }

    /// How high a cost stands.
    pub fn height(&self, cost: f32) -> f32 {
        (cost - self.bottom) / (self.top - self.bottom) * HEIGHT
    }
}

/// The triangles of `surface` in colours of its costs, with its pins.
pub fn relief(surface: &Surface, colors: ColorMap, theme: Theme) -> Relief {
    let mut relief = Relief::default();
    let bench = Bench::new(surface);
    relief.sheet(&grid(surface, colors));
    pins(surface, &bench).into_iter().for_each(|pin| relief.pin(&bench, pin, theme));
    relief
}

/// A displacement that is pinned on a surface.
pub struct Pin {
    /// What the displacement is.
    pub role: Role,
    /// Its name; where it has none, its cost is written at the pin.
    pub name: &'static str,
    /// The displacement in px.
    pub at: [f32; 2],
    /// Its cost.
    pub cost: f32,
    /// The height of the needle.
    pub top: f32,
}

/// The pins of a surface, at the displacements of known cost; the best one may lie between pixels. None reaches over the axis of costs,
/// and the best ends below the others, so that their numbers stand above each other where both are at one displacement.
pub fn pins(surface: &Surface, bench: &Bench) -> Vec<Pin> {
    let whole = |at: [i32; 2]| any_cost(surface, at).map(|cost| (at.map(|c| c as f32), cost));
    let between = surface.optimum_between().map(|found| (found.at, found.value));
    let best = between.or_else(|| whole(surface.best?));
    let probe = surface.probe.and_then(whole);
    let missed = surface.missed().and_then(|(at, _)| whole(at));
    let all = [(Role::Best, best, BEST_PIN), (Role::Candidate, probe, HEIGHT), (Role::Error, missed, HEIGHT)];
    let all = all.into_iter().filter_map(|(role, found, top)| Some((role, "", found?, top)));
    let named = surface.named.iter().filter_map(|&(name, role, at)| {
        let cost = surface.interpolated(at)?;
        Some((role, name, (at, cost), bench.height(cost) + NAMED_PIN))
    });
    let pin = |(role, name, (at, cost), top): (Role, &'static str, ([f32; 2], f32), f32)| Pin {
        role,
        name,
        at,
        cost,
        top: top.max(bench.height(cost)),
    };
    all.chain(named).map(pin).collect()
}

impl Pin {
    /// Its label.
    pub fn words(&self) -> String {
        if self.name.is_empty() { number(self.cost) } else { self.name.to_owned() }
    }
}

/// Radii of the needle and of the ball of a pin.
pub fn pin_radii(role: Role, theme: Theme) -> [f32; 2] {
    let thick = theme.ink(role).width / 2.0;
    [0.007 * thick, 0.03 * thick.sqrt()]
}

/// The corners of a surface: a place for each displacement whose cost is known.
pub struct Corners {
    bench: Bench,
    size: [usize; 2],
    all: Vec<Option<Vertex>>,
    /// The columns and rows that lie as figures on the surface.
    raised: Vec<[usize; 2]>,
}

/// The corners of `surface` in colors of its costs.
pub fn grid(surface: &Surface, colors: ColorMap) -> Corners {
    let (bench, shades) = (Bench::new(surface), Shades::of(surface, colors));
    let [width, height] = bench.size;
    let corner = |x: usize, y: usize| {
        let cost = surface.cost(x, y)?;
        let is_tested = surface.values.get(x, y).is_some_and(|cost| cost.is_finite());
        let color = shades.at(cost);
        Some(Vertex {
            place: bench.place(bench.displacement([x, y]), cost).into(),
            normal: normal(surface, &bench, x, y).into(),
            color: if is_tested { color } else { color.mix(FAINT_INTO, FAINT) }.0,
            grid: [x as f32, y as f32],
        })
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| corner(x, y)).collect();
    // On a faint surface the tested cells lie as small figures.
    let raised = surface.faint().next().map_or(Vec::new(), |_| {
        surface.path().into_iter().map(|at| [0, 1].map(|i| (at[i] - surface.origin[i]) as usize)).collect()
    });
    Corners { bench, size: [width, height], all, raised }
}

impl Corners {
    /// The corner in a column and row.
    pub fn vertex(&self, [x, y]: [usize; 2]) -> Option<&Vertex> {
        let [width, height] = self.size;
        if x < width && y < height { self.all[y * width + x].as_ref() } else { None }
    }

    /// The corners of the cell whose first column and row these are, clockwise, if all are known.
    pub fn cell(&self, [x, y]: [usize; 2]) -> Option<[Vertex; 4]> {
        let at = |x, y| self.vertex([x, y]).copied();
        Some([at(x, y)?, at(x + 1, y)?, at(x + 1, y + 1)?, at(x, y + 1)?])
    }

    /// The cells of which all corners are known, row by row.
    pub fn cells(&self) -> Vec<[usize; 2]> {
        let [width, height] = self.size.map(|n| n.saturating_sub(1));
        let all = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        all.filter(|at| self.cell(*at).is_some()).collect()
    }

    /// What is known without known neighbors all round, as small figures.
    pub fn figures(&self) -> Vec<[Vertex; 4]> {
        let [width, height] = self.size;
        let mut covered = vec![false; width * height];
        for [x, y] in self.cells() {
            for (x, y) in [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)] {
                covered[y * width + x] = true;
            }
        }
        let alone = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        let alone = alone.filter(|[x, y]| !covered[y * width + x]).chain(self.raised.iter().copied());
        alone.filter_map(|at| Some(self.figure(at, *self.vertex(at)?))).collect()
    }

    fn figure(&self, at: [usize; 2], middle: Vertex) -> [Vertex; 4] {
        let [u, v] = self.bench.displacement(at);
        [[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]].map(|[du, dv]| {
            let place = self.bench.place([u + du, v + dv], self.bench.bottom) + Vec3::Y * (middle.place[1] + RAISED);
            Vertex { place: place.into(), normal: [0.0, 1.0, 0.0], grid: [0.5, 0.5], ..middle }
        })
    }
}

impl Vertex {
    /// What lies between the corners of a cell, a share from the first along columns and along rows.
    pub fn between([a, b, c, d]: &[Vertex; 4], [s, t]: [f32; 2]) -> Self {
        let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
        let mix = |of: &dyn Fn(&Vertex) -> f32| {
            [a, b, c, d].iter().zip(weights).map(|(corner, weight)| of(corner) * weight).sum::<f32>()
        };
        Self {
            place: [0, 1, 2].map(|i| mix(&|v| v.place[i])),
            normal: [0, 1, 2].map(|i| mix(&|v| v.normal[i])),
            color: [0, 1, 2, 3].map(|i| mix(&|v| f32::from(v.color[i])).round() as u8),
            grid: [0, 1].map(|i| mix(&|v| v.grid[i])),
        }
    }
}

impl Relief {
    fn sheet(&mut self, grid: &Corners) {
        let [width, height] = grid.size;
        let mut index = vec![u32::MAX; width * height];
        for [x, y] in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
            if let Some(vertex) = grid.vertex([x, y]) {
                index[y * width + x] = self.vertices.len() as u32;
                self.vertices.push(*vertex);
            }
        }
        for [x, y] in grid.cells() {
            let [a, b, c, d] = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| index[y * width + x]);
            self.indices.extend([a, b, c, a, c, d]);
        }
        for figure in grid.figures() {
            let first = self.vertices.len() as u32;
            self.vertices.extend(figure);
            self.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
        }
    }

    /// A needle that can be seen above the surface, and a ball on the surface.
    fn pin(&mut self, bench: &Bench, Pin { role, at, cost, top, .. }: Pin, theme: Theme) {
        let color = theme.stroke(role).0;
        let foot = bench.place(at, cost);
        let [needle, ball] = pin_radii(role, theme);
        self.needle(foot, top, needle, color);
        self.ball(foot, ball, color);
    }

    fn needle(&mut self, foot: Vec3, top: f32, radius: f32, color: [u8; 4]) {
        let first = self.vertices.len() as u32;
        for i in 0..6 {
            let (sin, cos) = (i as f32 / 6.0 * std::f32::consts::TAU).sin_cos();
            let out = Vec3::new(cos, 0.0, sin);
            for y in [0.0, top] {
                let place = Vec3::new(foot.x, y, foot.z) + out * radius;
                self.vertices.push(Vertex { place: place.into(), normal: out.into(), color, grid: [0.5, 0.5] });
            }
            let (a, b) = (2 * i, 2 * ((i + 1) % 6));
            self.indices.extend([a, b, a + 1, b, b + 1, a + 1].map(|i| first + i));
        }
    }

    fn ball(&mut self, center: Vec3, radius: f32, color: [u8; 4]) {
        const RINGS: u32 = 9;
        const SIDES: u32 = 16;
        let first = self.vertices.len() as u32;
        for ring in 0..=RINGS {
            let (out, up) = (ring as f32 / RINGS as f32 * std::f32::consts::PI).sin_cos();
            for side in 0..SIDES {
                let (sin, cos) = (side as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
                let normal = Vec3::new(out * cos, up, out * sin);
                let place = (center + normal * radius).into();
                self.vertices.push(Vertex { place, normal: normal.into(), color, grid: [0.5, 0.5] });
                if ring < RINGS {
                    let at = |ring: u32, side: u32| first + ring * SIDES + side % SIDES;
                    let (a, b) = (at(ring, side), at(ring, side + 1));
                    let (c, d) = (at(ring + 1, side), at(ring + 1, side + 1));
                    self.indices.extend([a, b, c, b, d, c]);
                }
            }
        }
    }
}

/// Across the surface, from the neighbours that are known.
fn normal(surface: &Surface, bench: &Bench, x: usize, y: usize) -> Vec3 {
    let height = |x: Option<usize>, y: Option<usize>| surface.cost(x?, y?).map(|cost| bench.height(cost));
    let slope = |before: Option<f32>, after: Option<f32>, step: f32| {
        let here = height(Some(x), Some(y));
        match (before.or(here), after.or(here)) {
            (Some(a), Some(b)) => (b - a) / (step * if before.is_some() && after.is_some() { 2.0 } else { 1.0 }),
            _ => 0.0,
        }
    };
    let step = 2.0 / bench.size.map(|n| n.saturating_sub(1).max(1)).into_iter().max().unwrap_or(1) as f32;
    let along_u = slope(height(x.checked_sub(1), Some(y)), height(Some(x + 1), Some(y)), step);
    let along_v = slope(height(Some(x), y.checked_sub(1)), height(Some(x), Some(y + 1)), step);
    Vec3::new(-along_u, 1.0, -along_v).normalize()
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;
    use motionscope_core::scene::BetweenPixels;

    use super::*;

    fn surface(known: impl Fn(usize, usize) -> bool) -> Surface {
        let cost = |x: usize, y: usize| if known(x, y) { (x * x + y) as f32 } else { f32::NAN };
        let values = Grid::from_fn(9, 5, cost);
        Surface { best: Some([-4, -2]), ..Surface::new("SAD", [-4, -2], values, Grid::new(9, 5, None)) }
    }

    fn triangles(surface: &Surface) -> usize {
        relief(surface, ColorMap::Viridis, Theme::Dark).indices.len() / 3
    }

    #[test]
    fn every_quad_that_is_known_is_there_and_no_other() {
        let whole = Surface { best: None, ..surface(|_, _| true) };
        assert_eq!(triangles(&whole), 2 * 8 * 4);
        let holed = Surface { best: None, ..surface(|x, y| (x, y) != (4, 2)) };
        assert_eq!(triangles(&holed), 2 * (8 * 4 - 4));
        let row = Surface { best: None, ..surface(|_, y| y == 0) };
        assert_eq!(triangles(&row), 2 * 9, "a single row is shown as figures");
        assert_eq!(triangles(&Surface { best: None, ..surface(|_, _| false) }), 0);
    }

    #[test]
    fn the_bench_spans_the_ground_and_the_height() {
        let surface = surface(|_, _| true);
        let bench = Bench::new(&surface);
        assert_eq!(bench.place([-4.0, -2.0], 0.0), Vec3::new(-1.0, 0.0, -0.5));
        assert_eq!(bench.place([4.0, 2.0], bench.top), Vec3::new(1.0, 1.0, 0.5));
        // A correlation has values below 0: the lowest one lies on the ground, and none below it.
        let similar = Surface { is_similarity: true, values: surface.values.map(|value| value - 10.0), ..surface };
        let bench = Bench::new(&similar);
        assert_eq!((bench.height(-10.0), bench.height(bench.top)), (0.0, HEIGHT));
    }

    #[test]
    fn a_relief_is_sound() {
        let relief = relief(&surface(|x, y| x + y > 2 || x == 0), ColorMap::Turbo, Theme::Projector);
        assert!(relief.indices.iter().all(|&i| (i as usize) < relief.vertices.len()));
        assert!(
            relief
                .vertices
                .iter()
                .all(|v| Vec3::from(v.place).is_finite() && (Vec3::from(v.normal).length() - 1.0).abs() < 1e-3)
        );
    }

    #[test]
    fn pins_end_where_the_axis_of_costs_does() {
        let surface = surface(|_, _| true);
        let bench = Bench::new(&surface);
        let probed = Surface { probe: Some([4, 2]), ..surface };
        let tops: Vec<f32> = pins(&probed, &bench).into_iter().map(|pin| pin.top).collect();
        assert_eq!(tops, [BEST_PIN, bench.height(bench.top)]);
        // The best of a similarity is its largest value, and its pin does not end inside the surface.
        let similar = Surface { best: Some([4, 2]), is_similarity: true, ..probed };
        assert!(pins(&similar, &bench).iter().all(|pin| pin.top == HEIGHT));
        // A better displacement between pixels takes the pin of the best.
        let finer = Surface { between: vec![BetweenPixels { at: [1.5, 0.5], value: 1e6 }], ..similar.clone() };
        let best = pins(&finer, &bench).into_iter().find(|pin| pin.role == Role::Best);
        assert_eq!(best.map(|pin| (pin.at, pin.cost)), Some(([1.5, 0.5], 1e6)));
        let relief = relief(&similar, ColorMap::Viridis, Theme::Dark);
        let highest = relief.vertices.iter().map(|v| v.place[1]).fold(0.0, f32::max);
        let ball =
            [Role::Best, Role::Candidate].map(|role| pin_radii(role, Theme::Dark)[1]).into_iter().fold(0.0, f32::max);
        assert!(highest <= HEIGHT + ball + 1e-4, "only the ball on the surface lies over it: {highest}");
    }

    #[test]
    fn a_slope_is_lit_from_its_side() {
        let surface = surface(|_, _| true);
        let bench = Bench::new(&surface);
        let across = normal(&surface, &bench, 4, 2);
        assert!(across.x < 0.0 && across.y > 0.0, "the cost rises along u: {across}");
    }
}
