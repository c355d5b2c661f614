//! A plane of two quantities: the boundaries of a decision, the names of its regions, and what is decided.

use motionscope_core::scene::Regions;

use super::super::primitive::{Anchor, Point, Primitive, Rect};
use super::super::{Face, Theme, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type, shortened, solid};
use super::{ChartStyle, Drawing, titled};

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The regions and the points in them.
    pub regions: &'a Regions,
    /// The estimator whose they are.
    pub whose: &'a str,
}

/// Where the plane lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// Inside the axes.
    pub rect: Rect,
    axes: [Axis; 2],
}

impl Square {
    fn new(regions: &Regions, area: Rect, small: f32) -> Self {
        let min = [area.min[0] + 5.0 * small, area.min[1] + 1.9 * small];
        let room = [area.max[0] - small - min[0], area.max[1] - 2.9 * small - min[1]];
        let side = room[0].min(room[1]).max(8.0);
        let left = min[0] + ((room[0] - side) / 2.0).max(0.0);
        let rect = Rect::new([left.round(), min[1].round()], [side; 2]);
        let values = [0.0, regions.reach];
        let across = Axis::new(values, [rect.min[0], rect.max[0]]);
        Self { rect, axes: [across, Axis::new(values, [rect.max[1], rect.min[1]])] }
    }

    /// Where a pair of values stands.
    pub fn at(&self, values: [f32; 2]) -> Point {
        [0, 1].map(|i| self.axes[i].place(values[i]))
    }

    /// The values that stand at a place inside the axes.
    pub fn values(&self, at: Point) -> Option<[f32; 2]> {
        let inside = (0..2).all(|i| (self.rect.min[i]..=self.rect.max[i]).contains(&at[i]));
        inside.then(|| [0, 1].map(|i| self.axes[i].value(at[i])))
    }
}

/// Lays the plane out as large as it fits into `area`.
pub fn draw(data: Shown<'_>, area: Rect, style: ChartStyle) -> Drawing<Square> {
    let (regions, theme) = (data.regions, style.theme);
    let square = Square::new(regions, area, style.small());
    let mut canvas = Canvas::default();
    axes(&mut canvas, &square, regions, theme);
    let text = Type::text(theme);
    canvas.inside(square.rect, |canvas| {
        boundaries(canvas, &square, regions, theme);
        for (name, at) in &regions.names {
            canvas.text(square.at(*at), (Anchor::Middle, Level::Middle), name, Type::dim(theme));
        }
        for (_, role, values) in &regions.points {
            let at = square.at(*values);
            canvas.disc(at, 5.5, theme.chrome().panel);
            canvas.disc(at, 4.5, theme.ink(*role).color);
        }
    });
    for (name, role, values) in &regions.points {
        let [x, y] = square.at(*values);
        let is_left = x + 9.0 + text.width(name) > square.rect.max[0];
        let (anchor, x) = if is_left { (Anchor::End, x - 9.0) } else { (Anchor::Start, x + 9.0) };
        let y = y.clamp(square.rect.min[1] + 0.7 * text.size, square.rect.max[1] - 0.7 * text.size);
        canvas.text([x, y], (anchor, Level::Middle), name, text.color(theme.word(*role)));
    }
    Drawing { place: square, body: canvas.into_layers(), head: head(data, area, None, style) }
}

/// The boundaries, with their names above their right ends as far as these do not stand on each other.
fn boundaries(canvas: &mut Canvas, square: &Square, regions: &Regions, theme: Theme) {
    let text = Type::text(theme);
    let mut named: Vec<f32> = Vec::new();
    for (name, role, points) in &regions.boundaries {
        let line: Vec<Point> = points.iter().map(|values| square.at(*values)).collect();
        if let Some([x, y]) =
            line.last().copied().filter(|[_, y]| named.iter().all(|n| (n - y).abs() > 1.3 * text.size))
        {
            named.push(y);
            let at = [x.min(square.rect.max[0]) - 4.0, y - 3.0];
            canvas.text(at, (Anchor::End, Level::Bottom), name, text.color(theme.word(*role)));
        }
        canvas.line(line, false, solid(2.0, theme.ink(*role).color));
    }
}

/// What stands above the plane: what it shows, or the values that are pointed at.
pub fn head(data: Shown<'_>, area: Rect, pointed: Option<[f32; 2]>, style: ChartStyle) -> Vec<Primitive> {
    let Shown { regions, whose } = data;
    let (text, width) = (Type::text(style.theme), area.size()[0]);
    let words = match pointed {
        Some([x, y]) => format!("{} {}, {} {}", regions.labels[0], number(x), regions.labels[1], number(y)),
        None => titled(whose, regions.title, (text.size, width)),
    };
    let mut canvas = Canvas::default();
    let at = [area.min[0], area.min[1] + 0.8 * text.size];
    canvas.text(at, (Anchor::Start, Level::Middle), &shortened(&words, text, width), text);
    canvas.into_primitives()
}

/// The plane in words, in one line.
pub fn summary(regions: &Regions) -> String {
    let [x, y] = regions.labels;
    let told = |(name, _, [a, b]): &(String, _, [f32; 2])| format!("{name}: {x} {}, {y} {}", number(*a), number(*b));
    let points: Vec<_> = regions.points.iter().map(told).collect();
    let names: Vec<_> = regions.names.iter().map(|(name, _)| *name).collect();
    format!("{}: {}; regions {}", regions.title, points.join("; "), names.join(", "))
}

fn axes(canvas: &mut Canvas, square: &Square, regions: &Regions, theme: Theme) {
    let (chrome, dim) = (theme.chrome(), Type::dim(theme));
    let name = Type::text(theme).face(Face::Italic);
    let Rect { min: [left, top], max: [right, bottom] } = square.rect;
    canvas.across([left, right], bottom, chrome.dim);
    canvas.down(left, [top, bottom], chrome.dim);
    for tick in square.axes[0].ticks(5.0 * dim.size, 0.0) {
        let [x, y] = square.at([tick; 2]);
        canvas.down(x, [bottom, bottom + 4.0], chrome.dim);
        canvas.text([x, bottom + 6.0], (Anchor::Middle, Level::Top), &number(tick), dim);
        if tick > 0.0 {
            canvas.across([left - 4.0, left], y, chrome.dim);
            canvas.text([left - 6.0, y], (Anchor::End, Level::Middle), &number(tick), dim);
        }
    }
    let below = bottom + 6.0 + 1.25 * dim.size;
    canvas.text([right, below], (Anchor::End, Level::Top), regions.labels[0], name);
    canvas.text([left - 6.0, bottom - 0.2 * dim.size], (Anchor::End, Level::Bottom), regions.labels[1], name);
}

#[cfg(test)]
mod tests {
    use motionscope_core::Role;

    use super::super::super::ColorMap;
    use super::super::{flat, texts};
    use super::*;

    fn regions() -> Regions {
        Regions {
            title: "Eigenvalues",
            labels: ["λ₁", "λ₂"],
            reach: 10.0,
            boundaries: vec![("R = threshold", Role::Result, vec![[2.0, 10.0], [2.0, 2.0], [10.0, 2.0]])],
            names: vec![("corner", [7.0, 7.0]), ("edge", [7.0, 1.0])],
            points: vec![("(3, 4)".into(), Role::Reference, [8.0, 1.5])],
        }
    }

    #[test]
    fn names_and_points_stand_at_their_values() {
        let all = regions();
        let style = ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 };
        let data = Shown { regions: &all, whose: "Harris" };
        let drawing = draw(data, Rect::new([0.0; 2], [400.0, 320.0]), style);
        let square = drawing.place;
        assert_eq!(square.at([0.0; 2]), [square.rect.min[0], square.rect.max[1]], "the origin is below on the left");
        let [x, y] = square.values(square.at([7.0, 1.0])).expect("inside");
        assert!((x - 7.0).abs() < 1e-3 && (y - 1.0).abs() < 1e-3);
        assert_eq!(square.values([0.0; 2]), None);
        let primitives = flat(drawing);
        let corner = square.at([2.0, 2.0]);
        let has =
            |primitive: &Primitive| matches!(primitive, Primitive::Polyline { points, .. } if points.contains(&corner));
        assert!(primitives.iter().any(has), "the boundary");
        let words = texts(&primitives);
        for label in ["R = threshold", "corner", "edge", "(3, 4)", "λ₁", "λ₂", "Harris · Eigenvalues", "10"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
        assert_eq!(summary(&all), "Eigenvalues: (3, 4): λ₁ 8, λ₂ 1.500; regions corner, edge");
    }
}
