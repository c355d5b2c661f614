//! The surface as polygons, from back to front.

use glam::{Vec3, Vec4};
use motionscope_core::scene::Surface;

use super::super::super::Color;
use super::super::super::primitive::{Point, Primitive};
use super::super::canvas::solid;
use super::super::{ChartStyle, Screen};
use super::mesh::{self, Bench, Pin, Vertex};
use super::{LINES, light, line_width};

/// Largest side of a polygon in points: smaller, and shades go over into each other.
const FINE: f32 = 9.0;
/// Most polygons along the side of a cell.
const MOST_PARTS: usize = 4;
/// Polygons from which on cells are not divided further.
const MOST: usize = 6000;
/// How far polygons reach over their edges, in points: where two only meet, a thin gap would be seen.
const OVERLAP: f32 = 0.4;

/// Something to paint at a depth.
struct Item {
    /// From 0 near to 1 far.
    depth: f32,
    /// Column and row of the fine grid, if it is a part of a cell.
    at: Option<[usize; 2]>,
    primitives: Vec<Primitive>,
    /// The corners, clockwise from that with the smallest column and row.
    corners: [Point; 4],
}

/// The polygons of `surface` as they are seen, and its pins.
pub fn polygons(surface: &Surface, (screen, eye): (&Screen, Vec3), style: ChartStyle) -> Vec<Primitive> {
    let sheet = Sheet { screen, eye, style };
    let grid = mesh::grid(surface, style.colors);
    let cells = grid.cells();
    let parts = sheet.parts(&grid, &cells);
    let mut items: Vec<Item> = Vec::new();
    for &at in &cells {
        let Some(corners) = grid.cell(at) else { continue };
        for part in (0..parts).flat_map(|j| (0..parts).map(move |i| [i, j])) {
            items.push(sheet.part(&corners, (at, parts), part));
        }
    }
    items.extend(grid.figures().iter().map(|corners| sheet.item(corners, None)));
    items.extend(pins(surface, &sheet));
    items.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    sheet.painted(items, parts)
}

/// How a surface is seen.
struct Sheet<'a> {
    screen: &'a Screen,
    eye: Vec3,
    style: ChartStyle,
}

impl Sheet<'_> {
    /// Into how many parts cells are divided along each side.
    fn parts(&self, grid: &mesh::Corners, cells: &[[usize; 2]]) -> usize {
        let seen = |at| grid.vertex(at).map(|vertex| self.screen.project(vertex.place.into()).0);
        let long = |[x, y]: [usize; 2]| Some(distance(seen([x, y])?, seen([x + 1, y + 1])?));
        let total: f32 = cells.iter().filter_map(|cell| long(*cell)).sum();
        let wanted = (total / cells.len().max(1) as f32 / FINE).ceil() as usize;
        let room = ((MOST / cells.len().max(1)) as f32).sqrt() as usize;
        wanted.min(room).clamp(1, MOST_PARTS)
    }

    /// Part `(i, j)` of the cell in column x and row y, which is divided into so many along each side.
    fn part(&self, cell: &[Vertex; 4], ([x, y], parts): ([usize; 2], usize), [i, j]: [usize; 2]) -> Item {
        let share = |k: usize| k as f32 / parts as f32;
        let corner = |di: usize, dj: usize| Vertex::between(cell, [share(i + di), share(j + dj)]);
        let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        self.item(&corners, Some([x * parts + i, y * parts + j]))
    }

    fn item(&self, corners: &[Vertex; 4], at: Option<[usize; 2]>) -> Item {
        let seen = corners.each_ref().map(|corner| self.screen.project(corner.place.into()));
        let places = seen.map(|(place, _)| place);
        let depth = seen.iter().map(|(_, depth)| depth).sum::<f32>() / 4.0;
        let primitives = filled(places, self.shade(corners));
        Item { depth, at, primitives, corners: places }
    }

    /// The color of a part, lit as by the shader of the graphics card.
    fn shade(&self, corners: &[Vertex; 4]) -> Color {
        let mean = |of: fn(&Vertex) -> Vec3| corners.iter().map(of).sum::<Vec3>() / 4.0;
        let (place, normal) = (mean(|v| v.place.into()), mean(|v| v.normal.into()).normalize());
        let color = corners.iter().map(|v| Vec4::from(v.color.map(f32::from))).sum::<Vec4>() / 4.0;
        let to_eye = (self.eye - place).normalize();
        let normal = if normal.dot(to_eye) < 0.0 { -normal } else { normal };
        let diffuse = normal.dot(light()).max(0.0);
        let glance = normal.dot((light() + to_eye).normalize()).max(0.0).powf(40.0);
        let lit = |c: f32| (c * (0.58 + 0.46 * diffuse) + 255.0 * 0.10 * glance).clamp(0.0, 255.0).round() as u8;
        Color([lit(color.x), lit(color.y), lit(color.z), 255])
    }

    /// All items, each with the lines along columns and rows that nothing nearer will draw.
    fn painted(&self, items: Vec<Item>, parts: usize) -> Vec<Primitive> {
        let ranks: std::collections::BTreeMap<[usize; 2], usize> =
            items.iter().enumerate().filter_map(|(rank, item)| Some((item.at?, rank))).collect();
        let mut out = Vec::new();
        for (rank, item) in items.into_iter().enumerate() {
            out.extend(item.primitives);
            let Some([x, y]) = item.at else { continue };
            let [a, b, c, d] = item.corners;
            let neighbors = [
                (x % parts == 0, x.checked_sub(1).map(|x| [x, y]), [d, a]),
                ((x + 1) % parts == 0, Some([x + 1, y]), [b, c]),
                (y % parts == 0, y.checked_sub(1).map(|y| [x, y]), [a, b]),
                ((y + 1) % parts == 0, Some([x, y + 1]), [c, d]),
            ];
            let color = self.line_color(item.corners, parts);
            for (is_line, neighbor, ends) in neighbors {
                let is_nearer = neighbor.and_then(|at| ranks.get(&at)).is_some_and(|other| *other > rank);
                if let Some(color) = color.filter(|_| is_line && !is_nearer) {
                    let stroke = solid(line_width(self.style.theme), color);
                    out.push(Primitive::Polyline { points: ends.to_vec(), closed: false, stroke });
                }
            }
        }
        out
    }

    /// The color of the lines around a part; lines that come too close together fade.
    fn line_color(&self, [a, b, c, d]: [Point; 4], parts: usize) -> Option<Color> {
        let side = |ends: [(Point, Point); 2]| ends.iter().map(|(p, q)| distance(*p, *q)).sum::<f32>() / 2.0;
        let shorter = side([(a, b), (d, c)]).min(side([(a, d), (b, c)])) * parts as f32;
        let per_point = 1.0 / shorter.max(1e-3);
        let crowded = (1.6 - 6.0 * per_point / self.style.density.max(1.0)).clamp(0.0, 1.0);
        let alpha = (255.0 * LINES * crowded) as u8;
        (alpha > 0).then_some(Color::BLACK.alpha(alpha))
    }
}

fn distance(a: Point, b: Point) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A quadrilateral a little larger than its corners, as one convex polygon or as two.
fn filled(corners: [Point; 4], color: Color) -> Vec<Primitive> {
    let turn = |i: usize| {
        let [a, b, c] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    let turns = [0, 1, 2, 3].map(turn);
    let is_convex = turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0);
    let [a, b, c, d] = corners;
    let pieces = if is_convex { vec![vec![a, b, c, d]] } else { vec![vec![a, b, c], vec![a, c, d]] };
    pieces.into_iter().map(|points| Primitive::Polygon { points: grown(points), color }).collect()
}

fn grown(points: Vec<Point>) -> Vec<Point> {
    let count = points.len() as f32;
    let center = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f32>() / count);
    let out = |p: Point| {
        let way = [p[0] - center[0], p[1] - center[1]];
        let share = OVERLAP / way[0].hypot(way[1]).max(OVERLAP);
        [p[0] + way[0] * share, p[1] + way[1] * share]
    };
    points.into_iter().map(out).collect()
}

/// Pieces of a needle, so that each is hidden by what stands before it.
const PIECES: usize = 24;

/// A needle at the best and one at the probe, with a ball where they meet the surface.
fn pins(surface: &Surface, sheet: &Sheet<'_>) -> Vec<Item> {
    let bench = Bench::new(surface);
    let theme = sheet.style.theme;
    let all = mesh::pins(surface, &bench).into_iter().map(|Pin { role, at, cost, top, .. }| {
        (theme.stroke(role), bench.place(at, cost), top, mesh::pin_radii(role, theme))
    });
    let item = |depth: f32, primitive: Primitive| Item {
        depth,
        at: None,
        primitives: vec![primitive],
        corners: [[0.0; 2]; 4],
    };
    let mut items = Vec::new();
    for (color, foot, top, [needle, ball]) in all {
        let scale = |place: Vec3, radius: f32| {
            // Across the view, so that it is not made shorter.
            let across = (sheet.eye - place).cross(Vec3::Y).normalize() * radius;
            distance(sheet.screen.project(place + across).0, sheet.screen.project(place).0)
        };
        for i in 0..PIECES {
            let [low, high] = [i, i + 1].map(|i| Vec3 { y: top * i as f32 / PIECES as f32, ..foot });
            let ([from, to], depth) =
                ([low, high].map(|end| sheet.screen.project(end).0), sheet.screen.project((low + high) / 2.0).1);
            let stroke = solid(2.0 * scale(low, needle), dimmed(color));
            items.push(item(depth, Primitive::Polyline { points: vec![from, to], closed: false, stroke }));
        }
        let nearest = foot + (sheet.eye - foot).normalize() * ball;
        let center = sheet.screen.project(foot).0;
        items.push(item(
            sheet.screen.project(nearest).1,
            Primitive::Disc { center, radius: scale(foot, ball), color: dimmed(color) },
        ));
    }
    items
}

/// As bright as a round thing is in the light on average.
fn dimmed(color: Color) -> Color {
    color.mix(Color::BLACK, 0.12)
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;

    use super::super::super::super::primitive::Rect;
    use super::super::super::super::{ColorMap, Theme};
    use super::super::super::{Orbit, Room};
    use super::*;

    fn seen(known: impl Fn(usize, usize) -> bool, orbit: Orbit) -> Vec<Primitive> {
        let values = Grid::from_fn(5, 5, |x, y| if known(x, y) { (x + y) as f32 } else { f32::NAN });
        let events = Grid::new(5, 5, None);
        let surface = Surface::new("SAD", [-2, -2], values, events);
        let style = ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 };
        let screen = Screen::new(Rect::new([0.0; 2], [300.0, 200.0]), &orbit, Room::SURFACE, [0.0; 2]);
        polygons(&surface, (&screen, orbit.eye()), style)
    }

    fn middles(primitives: &[Primitive]) -> Vec<Point> {
        let middle = |primitive: &Primitive| match primitive {
            Primitive::Polygon { points, .. } => {
                Some([0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f32>() / points.len() as f32))
            }
            _ => None,
        };
        primitives.iter().filter_map(middle).collect()
    }

    #[test]
    fn rows_further_from_the_eye_are_painted_first() {
        let all = middles(&seen(|_, _| true, Orbit { yaw_rad: 0.0, ..Orbit::default() }));
        assert!(all.len() >= 16);
        assert!(all[0][1] < all[all.len() - 1][1], "the far row is higher up on the sheet");
    }

    #[test]
    fn what_is_not_known_leaves_a_hole_and_every_line_is_drawn_once() {
        let whole = seen(|_, _| true, Orbit::default());
        let holed = seen(|x, y| (x, y) != (2, 2), Orbit::default());
        let polygons = |all: &[Primitive]| middles(all).len();
        assert_eq!(polygons(&holed), polygons(&whole) * 12 / 16, "four of sixteen cells have that corner");
        let lines = whole.iter().filter(|p| matches!(p, Primitive::Polyline { .. })).count();
        let parts = ((polygons(&whole) / 16) as f32).sqrt() as usize;
        assert_eq!(lines, 2 * 5 * 4 * parts, "five lines of four cells each way");
    }
}
