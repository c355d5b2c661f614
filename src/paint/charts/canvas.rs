//! Shapes and words put down one after the other.

use super::super::primitive::{Anchor, Line, Point, Primitive, Rect, Run, Stroke};
use super::super::{Color, Face, Layer, Theme, fonts};

/// Heights of a line of type above and below its baseline, in sizes of the type.
const ASCENT: f32 = 0.96;
const DESCENT: f32 = 0.25;
/// Half the height of a capital letter.
const HALF_CAPITAL: f32 = 0.365;

/// Which height of a line of text lies at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Its upper edge.
    Top,
    /// The middle of its capital letters.
    Middle,
    /// Its lower edge.
    Bottom,
}

/// How words are set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Type {
    /// Face.
    pub face: Face,
    /// Size in points.
    pub size: f32,
    /// Color.
    pub color: Color,
}

impl Type {
    /// The type around charts in the color of the text.
    pub fn text(theme: Theme) -> Self {
        Self { face: Face::Sans, size: theme.sizes().small, color: theme.chrome().text }
    }

    /// The same, stepping back.
    pub fn dim(theme: Theme) -> Self {
        Self { color: theme.chrome().dim, ..Self::text(theme) }
    }

    /// The same in another face.
    #[must_use]
    pub fn face(self, face: Face) -> Self {
        Self { face, ..self }
    }

    /// The same in another color.
    #[must_use]
    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// Width of `words` in points.
    pub fn width(&self, words: &str) -> f32 {
        fonts::width(words, self.face, self.size)
    }

    /// One line of `words`, as primitive.
    pub fn line(&self, at: Point, (anchor, level): (Anchor, Level), words: &str) -> Line {
        let down = match level {
            Level::Top => ASCENT * self.size,
            Level::Middle => HALF_CAPITAL * self.size,
            Level::Bottom => -DESCENT * self.size,
        };
        let runs = vec![Run::new(words, self.color).face(self.face)];
        Line { at: [at[0], (at[1] + down).round()], anchor, size: self.size, runs, halo: None }
    }
}

/// The first of several wordings, from long to short, that is at most `width` wide, or else the last of them, [`shortened`].
pub fn fitting(wordings: &[String], style: Type, width: f32) -> String {
    let fits = |words: &&String| style.width(words) <= width;
    let found = wordings.iter().find(fits).or(wordings.last());
    found.map_or_else(String::new, |words| shortened(words, style, width))
}

/// `words`, cut short with … where they are wider than `width` points.
pub fn shortened(words: &str, style: Type, width: f32) -> String {
    if style.width(words) <= width {
        return words.to_owned();
    }
    let ends: Vec<usize> = words.char_indices().map(|(at, _)| at).collect();
    let cut = |end: usize| format!("{}…", words[..end].trim_end());
    // More letters are never narrower, so the last one that fits can be searched for.
    let fitting = ends.partition_point(|end| style.width(&cut(*end)) <= width);
    fitting.checked_sub(1).map_or_else(String::new, |last| cut(ends[last]))
}

/// Dashes and gaps of a threshold.
pub(super) const THRESHOLD: &[f32] = &[5.0, 3.0];

/// Layers that are being painted.
#[derive(Debug, Default)]
pub struct Canvas(Vec<Layer>);

impl Canvas {
    /// Adds a primitive on top.
    pub fn add(&mut self, primitive: Primitive) {
        match self.0.last_mut() {
            Some(layer) if layer.clip.is_none() => layer.primitives.push(primitive),
            _ => self.0.push(Layer { clip: None, primitives: vec![primitive] }),
        }
    }

    /// Adds primitives on top.
    pub fn extend(&mut self, primitives: impl IntoIterator<Item = Primitive>) {
        primitives.into_iter().for_each(|primitive| self.add(primitive));
    }

    /// Adds what `paint` paints, seen only inside `clip`.
    pub fn inside(&mut self, clip: Rect, paint: impl FnOnce(&mut Canvas)) {
        let mut inner = Canvas::default();
        paint(&mut inner);
        let primitives = inner.0.into_iter().flat_map(|layer| layer.primitives).collect();
        self.0.push(Layer { clip: Some(clip), primitives });
    }

    /// A filled rectangle.
    pub fn fill(&mut self, rect: Rect, color: Color) {
        self.add(Primitive::Polygon { points: rect.corners(), color });
    }

    /// The outline of a rectangle.
    pub fn frame(&mut self, rect: Rect, width: f32, color: Color) {
        self.line(rect.corners(), true, solid(width, color));
    }

    /// A line of `width` along points.
    pub fn line(&mut self, points: Vec<Point>, closed: bool, stroke: Stroke) {
        self.add(Primitive::Polyline { points, closed, stroke });
    }

    /// A line one point thick from left to right, sharp on any screen.
    pub fn across(&mut self, [x0, x1]: [f32; 2], y: f32, color: Color) {
        let y = y.floor() + 0.5;
        self.line(vec![[x0, y], [x1, y]], false, solid(1.0, color));
    }

    /// A line one point thick from top to bottom, sharp on any screen.
    pub fn down(&mut self, x: f32, [y0, y1]: [f32; 2], color: Color) {
        let x = x.floor() + 0.5;
        self.line(vec![[x, y0], [x, y1]], false, solid(1.0, color));
    }

    /// A filled disc.
    pub fn disc(&mut self, center: Point, radius: f32, color: Color) {
        self.add(Primitive::Disc { center, radius, color });
    }

    /// One line of words; gives what it covers.
    pub fn text(&mut self, at: Point, place: (Anchor, Level), words: &str, style: Type) -> Rect {
        let line = style.line(at, place, words);
        let rect = covered(&line);
        if !words.is_empty() {
            self.add(Primitive::Text(line));
        }
        rect
    }

    /// What was painted, back to front.
    pub fn into_layers(self) -> Vec<Layer> {
        self.0
    }

    /// What was painted without any clip.
    pub fn into_primitives(self) -> Vec<Primitive> {
        self.0.into_iter().flat_map(|layer| layer.primitives).collect()
    }
}

/// What a line of text covers.
pub fn covered(line: &Line) -> Rect {
    let [x, y] = line.start();
    Rect::new([x, y - ASCENT * line.size], [line.width(), (ASCENT + DESCENT) * line.size])
}

/// A stroke without dashes.
pub fn solid(width: f32, color: Color) -> Stroke {
    Stroke { width, color, dash: &[] }
}

/// From the middle.
pub fn around(center: Point, [width, height]: [f32; 2]) -> Rect {
    Rect::new([center[0] - width / 2.0, center[1] - height / 2.0], [width, height])
}

/// The middle of a rectangle.
pub fn middle(rect: &Rect) -> Point {
    [0, 1].map(|i| (rect.min[i] + rect.max[i]) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_are_too_long_are_cut_short() {
        let style = Type::text(Theme::Dark);
        assert_eq!(shortened("short", style, 200.0), "short");
        let cut = shortened("a sentence that has no room", style, 80.0);
        assert!(cut.ends_with('…') && style.width(&cut) <= 80.0, "{cut}");
        assert_eq!(shortened("nothing", style, 1.0), "");
    }

    #[test]
    fn as_many_letters_stay_as_fit() {
        let style = Type::text(Theme::Dark);
        let words = "Größe of a step: two words, ";
        for width in (0..200).map(|width| width as f32) {
            let cuts = (0..words.chars().count()).rev().map(|count| {
                let kept: String = words.chars().take(count).collect();
                format!("{}…", kept.trim_end())
            });
            let plain = if style.width(words) <= width { Some(words.to_owned()) } else { None };
            let plain = plain.or_else(|| cuts.into_iter().find(|cut| style.width(cut) <= width)).unwrap_or_default();
            assert_eq!(shortened(words, style, width), plain, "{width}");
        }
        // One letter less at a time took half a minute.
        let begun = web_time::Instant::now();
        assert!(shortened(&"a".repeat(20_000), style, 500.0).ends_with("a…"));
        assert!(begun.elapsed().as_secs() < 10, "{:?}", begun.elapsed());
    }

    #[test]
    fn what_is_inside_a_clip_stays_between_what_is_around_it() {
        let mut canvas = Canvas::default();
        let rect = Rect::new([0.0; 2], [10.0; 2]);
        canvas.fill(rect, Color::BLACK);
        canvas.inside(rect, |inner| inner.fill(rect.grown(5.0), Color::WHITE));
        canvas.fill(rect, Color::BLACK);
        let clips: Vec<_> = canvas.into_layers().iter().map(|layer| layer.clip).collect();
        assert_eq!(clips, [None, Some(rect), None]);
    }
}
