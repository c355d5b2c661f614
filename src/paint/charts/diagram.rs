//! A drawing of lines, nodes and words in a plane of its own: a tree, a ring.

use motionscope_core::scene::{Diagram, Role};

use super::super::primitive::{Anchor, Point, Primitive, Rect};
use super::super::{Color, Theme};
use super::canvas::{Canvas, Level, Type, shortened, solid};
use super::{ChartStyle, Drawing, titled};

/// How much of its colour a mark that steps back keeps.
const FADED: f32 = 0.35;

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The drawing.
    pub diagram: &'a Diagram,
    /// The estimator whose it is.
    pub whose: &'a str,
}

/// Where the drawing lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Its edges.
    pub rect: Rect,
    size: [f32; 2],
}

impl Sheet {
    fn new(diagram: &Diagram, area: Rect, dim: Type) -> Self {
        let small = dim.size;
        let min = [area.min[0] + small, area.min[1] + 1.9 * small];
        let room = [area.max[0] - small - min[0], area.max[1] - small - min[1]].map(|side| side.max(8.0));
        let size = diagram.size.map(|side| side.max(f32::MIN_POSITIVE));
        let scales = [0, 1].map(|i| room[i] / size[i]);
        let least = scales[0].min(scales[1]);
        let used = if diagram.is_isotropic { size.map(|side| side * least) } else { room };
        Self { rect: Rect::new([0, 1].map(|i| min[i] + (room[i] - used[i]) / 2.0), used), size }
    }

    /// Where a place of the drawing stands.
    pub fn at(&self, place: Point) -> Point {
        let extent = self.rect.size();
        [0, 1].map(|i| self.rect.min[i] + place[i] / self.size[i] * extent[i])
    }
}

/// The colour of a mark.
fn ink(theme: Theme, role: Role, is_faded: bool) -> Color {
    let color = theme.stroke(role);
    if is_faded { theme.chrome().panel.mix(color, FADED) } else { color }
}

/// Lays the drawing out as large as it fits into `area`.
pub fn draw(data: Shown<'_>, area: Rect, style: ChartStyle) -> Drawing<Sheet> {
    let (diagram, theme) = (data.diagram, style.theme);
    let dim = Type::dim(theme);
    let sheet = Sheet::new(diagram, area, dim);
    let mut canvas = Canvas::default();
    for line in &diagram.lines {
        let points = line.points.iter().map(|place| sheet.at(*place)).collect();
        canvas.line(points, false, solid(line.width, ink(theme, line.role, line.is_faded)));
    }
    for node in &diagram.nodes {
        canvas.disc(sheet.at(node.at), node.radius + 1.0, theme.chrome().panel);
        canvas.disc(sheet.at(node.at), node.radius, ink(theme, node.role, node.is_faded));
    }
    for words in &diagram.words {
        let anchor = match words.side {
            0 => Anchor::Middle,
            1.. => Anchor::Start,
            _ => Anchor::End,
        };
        let color = words.role.map_or(dim.color, |role| theme.word(role));
        let at = sheet.at(words.at);
        // To the right they end at the latest where the area does.
        let shown = if words.side > 0 { shortened(&words.text, dim, area.max[0] - at[0]) } else { words.text.clone() };
        canvas.text(at, (anchor, Level::Middle), &shown, dim.color(color));
    }
    Drawing { place: sheet, body: canvas.into_layers(), head: head(data, area, style) }
}

/// What stands above the drawing.
fn head(data: Shown<'_>, area: Rect, style: ChartStyle) -> Vec<Primitive> {
    let (text, width) = (Type::text(style.theme), area.size()[0]);
    let words = titled(data.whose, data.diagram.title, (text.size, width));
    let mut canvas = Canvas::default();
    let at = [area.min[0], area.min[1] + 0.8 * text.size];
    canvas.text(at, (Anchor::Start, Level::Middle), &shortened(&words, text, width), text);
    canvas.into_primitives()
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::{DiagramLine, Node, Words};

    use super::super::super::ColorMap;
    use super::super::{flat, texts};
    use super::*;

    #[test]
    fn lines_nodes_and_words_stand_at_their_places() {
        let line = DiagramLine { role: Role::Best, width: 2.0, is_faded: false, points: vec![[0.0, 0.0], [10.0, 5.0]] };
        let diagram = Diagram {
            title: "Tree of hypotheses",
            size: [10.0, 5.0],
            lines: vec![line.clone(), DiagramLine { role: Role::Rejected, is_faded: true, ..line }],
            nodes: vec![Node { role: Role::Best, is_faded: false, at: [10.0, 5.0], radius: 4.0 }],
            words: vec![Words { text: "0.75".into(), role: Some(Role::Best), at: [5.0, 2.5], side: 0 }],
            ..Diagram::default()
        };
        let style = ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 };
        let draw_in = |diagram: &Diagram| {
            let shown = Shown { diagram, whose: "MHT" };
            draw(shown, Rect::new([0.0; 2], [400.0, 320.0]), style)
        };
        let drawing = draw_in(&diagram);
        let sheet = drawing.place;
        assert_eq!([sheet.at([0.0; 2]), sheet.at([10.0, 5.0])], [sheet.rect.min, sheet.rect.max]);
        let primitives = flat(drawing);
        let colors: Vec<Color> = primitives
            .iter()
            .filter_map(|primitive| match primitive {
                Primitive::Polyline { points, stroke, .. } if points[1] == sheet.rect.max => Some(stroke.color),
                _ => None,
            })
            .collect();
        assert_eq!(colors[0], Theme::Dark.stroke(Role::Best));
        assert_ne!(colors[1], Theme::Dark.stroke(Role::Rejected), "it steps back");
        let words = texts(&primitives);
        assert!(["0.75", "MHT · Tree of hypotheses"].iter().all(|word| words.iter().any(|other| other == word)));
        let [width, height] = draw_in(&Diagram { is_isotropic: true, ..diagram }).place.rect.size();
        assert!((width - 2.0 * height).abs() < 1e-3, "{width}×{height}");
    }
}
