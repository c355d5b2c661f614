//! A plane of two quantities: the boundaries of a decision, the names of its regions, and what is decided.

use motionscope_core::scene::Regions;

use super::super::primitive::{Anchor, Point, Primitive, Rect};
use super::super::{Face, Theme, labels, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type, shortened, solid};
use super::labels::Labels;
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
    fn new(regions: &Regions, area: Rect, dim: Type) -> Self {
        let small = dim.size;
        // Room for the numbers beside the axis.
        let beside = (dim.width(&number(regions.reach)) + 8.0).max(5.0 * small);
        let min = [area.min[0] + beside, area.min[1] + 1.9 * small];
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
    let square = Square::new(regions, area, Type::dim(theme));
    let mut canvas = Canvas::default();
    axes(&mut canvas, &square, regions, theme);
    canvas.inside(square.rect, |canvas| {
        for (_, role, points) in &regions.boundaries {
            let line = points.iter().map(|values| square.at(*values)).collect();
            canvas.line(line, false, solid(2.0, theme.stroke(*role)));
        }
        for (_, role, values) in &regions.points {
            let at = square.at(*values);
            canvas.disc(at, 5.5, theme.chrome().panel);
            canvas.disc(at, 4.5, theme.stroke(*role));
        }
    });
    names(&mut canvas, &square, regions, theme);
    Drawing { place: square, body: canvas.into_layers(), head: head(data, area, None, style) }
}

/// The names of points, boundaries and regions, each at the first of its places that is free; those of boundaries and regions
/// are left out where none is.
fn names(canvas: &mut Canvas, square: &Square, regions: &Regions, theme: Theme) {
    let (text, dim) = (Type::text(theme), Type::dim(theme));
    let mut labels = Labels::new(square.rect);
    let dots = regions.points.iter().map(|(.., values)| square.at(*values));
    dots.for_each(|at| labels.keep_off(Rect::centered(at, [12.0; 2])));
    let boundaries = regions.boundaries.iter().map(|(.., points)| points.iter().map(|values| square.at(*values)));
    boundaries.for_each(|points| labels.keep_off_line(points.collect()));
    for (name, role, values) in &regions.points {
        let [x, y] = square.at(*values);
        let size = [text.width(name), 1.2 * text.size];
        let (across, down) = (9.0 + size[0] / 2.0, 9.0 + size[1] / 2.0);
        let places = [[x + across, y], [x - across, y], [x, y - down], [x, y + down]];
        let at = labels.place(size, &places).unwrap_or_else(|| {
            labels.keep_off(Rect::centered(places[0], size));
            places[0]
        });
        canvas.text(at, (Anchor::Middle, Level::Middle), name, text.color(theme.word(*role)));
    }
    for (name, role, points) in &regions.boundaries {
        let Some([x, y]) = points.last().map(|values| square.at(*values)) else { continue };
        let size = [text.width(name), 1.2 * text.size];
        let (x, down) = (x - 4.0 - size[0] / 2.0, 3.0 + size[1] / 2.0);
        if let Some(at) = labels.place(size, &[[x, y - down], [x, y + down]]) {
            canvas.text(at, (Anchor::Middle, Level::Middle), name, text.color(theme.word(*role)));
        }
    }
    for (name, values) in &regions.names {
        let [x, y] = square.at(*values);
        let size = [dim.width(name), 1.2 * dim.size];
        let places = [0.0, 1.3, -1.3, 2.6, -2.6].map(|lines| [x, y + lines * dim.size]);
        if let Some(at) = labels.place(size, &places) {
            canvas.text(at, (Anchor::Middle, Level::Middle), name, dim);
        }
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
    let description =
        |(name, _, [a, b]): &(String, _, [f32; 2])| format!("{name}: {x} {}, {y} {}", number(*a), number(*b));
    let points: Vec<_> = regions.points.iter().map(description).collect();
    let names: Vec<_> = regions.names.iter().map(|(name, _)| *name).collect();
    format!("{}: {}; regions {}", regions.title, points.join("; "), names.join(", "))
}

fn axes(canvas: &mut Canvas, square: &Square, regions: &Regions, theme: Theme) {
    let (chrome, dim) = (theme.chrome(), Type::dim(theme));
    let name = Type::text(theme).face(Face::Italic);
    let Rect { min: [left, top], max: [right, bottom] } = square.rect;
    canvas.across([left, right], bottom, chrome.dim);
    canvas.down(left, [top, bottom], chrome.dim);
    let ticks = square.axes[0].ticks(5.0 * dim.size, 0.0);
    for (&tick, words) in ticks.iter().zip(labels(&ticks)) {
        let [x, y] = square.at([tick; 2]);
        canvas.down(x, [bottom, bottom + 4.0], chrome.dim);
        canvas.text([x, bottom + 6.0], (Anchor::Middle, Level::Top), &words, dim);
        if tick > 0.0 {
            canvas.across([left - 4.0, left], y, chrome.dim);
            canvas.text([left - 6.0, y], (Anchor::End, Level::Middle), &words, dim);
        }
    }
    let below = bottom + 6.0 + 1.25 * dim.size;
    canvas.text([right, below], (Anchor::End, Level::Top), regions.labels[0], name);
    canvas.text([left - 6.0, bottom - 0.2 * dim.size], (Anchor::End, Level::Bottom), regions.labels[1], name);
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Role;

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
        assert_eq!(summary(&all), "Eigenvalues: (3, 4): λ₁ 8, λ₂ 1.50; regions corner, edge");
    }
}
