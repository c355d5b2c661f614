//! What the marks mean: each role in its real shape, and the colours of heat.

use std::sync::Arc;

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Mark, Role, Scene, Shape};

use super::flow_color::{flow_color, hatch, veil};
use super::primitive::{Anchor, Arrows, Line, Pen, Point, Primitive, Rect, Run, Stroke};
use super::wrap::wrap;
use super::{Color, ColorMap, Face, Ink, Look, Theme, fonts, marks, mask, number};

/// Width and height of a swatch.
pub const SWATCH: [f32; 2] = [28.0, 16.0];
const BAR: [f32; 2] = [128.0, 8.0];
/// Width of a bar that has little room, at least.
const SHORTEST_BAR: f32 = 48.0;
const GAP: f32 = 8.0;
/// Length of the arrow in a swatch in points, by which the scale of the others is told.
const ARROW: f32 = 24.0;
/// Diameter of the wheel in the legend of a figure.
const WHEEL: f32 = 96.0;

/// One line of a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The role.
    pub role: Role,
    /// What it looks like on the stage.
    pub sample: Sample,
    /// The colours of some of its objects, where each has its own instead of the role's.
    pub own: Vec<Color>,
    /// What it means here.
    pub meaning: String,
}

/// Most objects whose colours the legend shows.
const MOST_OWN: usize = 3;
/// Pixels of a segmented picture that are sampled for its labels, roughly.
const SAMPLED_LABELS: usize = 4096;

/// What a role looks like on the stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sample {
    /// A rectangle.
    Frame,
    /// An ellipse.
    Ellipse,
    /// An arrow.
    Arrow,
    /// A point.
    Point,
    /// A line.
    Line,
    /// The wheel of colours.
    Wheel,
    /// Pixels within a contour.
    Mask,
    /// Pixels that are covered.
    Area,
    /// Stripes.
    Hatch,
    /// Dots: what is not there yet.
    Awaited,
}

/// A bar of colours between two numbers; without the second, a single number that needs none.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// What stands at its ends: `SAD 0`, `4 px`.
    pub ends: [String; 2],
    /// Its colours, from left to right.
    pub colors: ColorMap,
}

impl Bar {
    /// The bar of heat called `label`.
    pub fn heat(label: &str, range: [f32; 2], colors: ColorMap) -> Self {
        let [low, high] = range.map(number);
        let low = format!("{label} {low}").trim_start().to_owned();
        let high = if colors == ColorMap::Diverging { format!("{high} (gray: 0)") } else { high };
        Self { ends: [low, if range[0] == range[1] { String::new() } else { high }], colors }
    }

    /// The same in words.
    pub fn plain(&self) -> String {
        match &self.ends {
            [low, high] if high.is_empty() => format!("colour for {low}"),
            [low, high] => format!("colours for {low} to {high}"),
        }
    }
}

impl Sample {
    fn of(shape: &Shape) -> Option<Self> {
        match shape {
            Shape::Rect { .. } => Some(Sample::Frame),
            Shape::Ellipse { .. } => Some(Sample::Ellipse),
            Shape::Arrows(_) | Shape::Flow { .. } => Some(Sample::Arrow),
            Shape::Points(_) => Some(Sample::Point),
            Shape::Path { .. } => Some(Sample::Line),
            Shape::Mask(_) => Some(Sample::Mask),
            Shape::Labels(_) => Some(Sample::Area),
            Shape::Text { .. } | Shape::Heat { .. } => None,
        }
    }
}

/// What the legend of `scene` tells about the roles of `marks` and of its links, and how displacements are drawn at `zoom` points per pixel.
pub fn entries<'a>(scene: &Scene, marks: impl Iterator<Item = &'a Mark> + Clone, look: &Look, zoom: f32) -> Vec<Entry> {
    let entry = |&(role, meaning): &(Role, &'static str)| {
        let sample = sample(scene, marks.clone(), role)?;
        if let Some(frames) = look.streak_frames.filter(|_| role == Role::Result && sample == Sample::Arrow) {
            let meaning = format!("where particles would go in {frames} frames of this motion");
            return Some(Entry { role, sample: Sample::Line, own: Vec::new(), meaning });
        }
        let long = match look.lengthen {
            _ if sample != Sample::Arrow || !marks::is_lengthened(role) => String::new(),
            times => format!("{} (this arrow: {} px)", drawn(times), measure(ARROW / (times * zoom))),
        };
        let is_thinned = marks.clone().any(|mark| match &mark.shape {
            Shape::Arrows(arrows) => mark.role == role && marks::is_thinned(arrows, zoom * look.density, look.spacing),
            _ => false,
        });
        let thinned = match look.spacing.filter(|_| is_thinned) {
            Some(px) => format!(", one about every {} px drawn", number(px)),
            None if is_thinned => ", not all drawn at this size".into(),
            None => String::new(),
        };
        let own = own_colors(marks.clone(), (role, sample));
        Some(Entry { role, sample, own, meaning: format!("{meaning}{long}{thinned}") })
    };
    scene.legend.iter().filter_map(entry).collect()
}

/// What a role looks like among the `marks` and links of `scene`; `None` if it is not there.
pub fn sample<'a>(scene: &Scene, marks: impl Iterator<Item = &'a Mark>, role: Role) -> Option<Sample> {
    let of_mark = marks.filter(|mark| mark.role == role).filter_map(|mark| Sample::of(&mark.shape)).min();
    of_mark.or_else(|| scene.links.iter().any(|link| link.role == role).then_some(Sample::Line))
}

/// The colours of the first objects whose marks of a role look like the sample, where they have their own.
fn own_colors<'a>(marks: impl Iterator<Item = &'a Mark> + Clone, (role, sample): (Role, Sample)) -> Vec<Color> {
    let mut own = Vec::new();
    let has_regions = marks.clone().any(|mark| matches!(mark.shape, Shape::Labels(_)));
    let of_sample = marks.filter(|mark| mark.role == role && Sample::of(&mark.shape) == Some(sample));
    let colors = of_sample.flat_map(|mark| match &mark.shape {
        Shape::Labels(labels) => some_labels(labels).into_iter().map(marks::own_color).collect(),
        _ => mark.of.map(|identity| marks::color_of(identity, has_regions)).into_iter().collect::<Vec<_>>(),
    });
    for color in colors {
        if !own.contains(&color) {
            own.push(color);
        }
        if own.len() == MOST_OWN {
            break;
        }
    }
    own
}

/// Some of the labels of a picture, each once.
fn some_labels(labels: &Grid<u32>) -> Vec<u32> {
    let cells = labels.cells();
    let mut some: Vec<u32> = Vec::new();
    for label in cells.iter().step_by(cells.len() / SAMPLED_LABELS + 1).filter(|label| **label > 0) {
        if !some.contains(label) {
            some.push(*label);
        }
        if some.len() == MOST_OWN {
            break;
        }
    }
    some
}

/// How many times their length displacements are drawn, where that is another.
fn drawn(times: f32) -> String {
    match times {
        1.0 => String::new(),
        0.5 => ", drawn at half length".to_owned(),
        times => format!(", drawn ×{times}"),
    }
}

/// A length in px with two digits that count.
fn measure(px: f32) -> String {
    match px {
        px if !px.is_finite() => "–".into(),
        px if px < 1.0 => format!("{px:.2}"),
        px if px < 10.0 => format!("{px:.1}").trim_end_matches(".0").to_owned(),
        px => format!("{px:.0}"),
    }
}

/// `sample` in the ink of `role`, [`SWATCH`] large, with its upper left corner at `min`.
///
/// On a panel the rim is left out where the colour stands off by itself.
pub fn swatch(role: Role, sample: Sample, theme: Theme, min: Point) -> Vec<Primitive> {
    inked(theme.ink(role), sample, theme, Rect::new(min, SWATCH))
}

/// The same in the colours of objects beside each other, or in that of the role if there are none.
pub fn swatch_of(own: &[Color], (role, sample): (Role, Sample), theme: Theme, min: Point) -> Vec<Primitive> {
    if own.is_empty() {
        return swatch(role, sample, theme, min);
    }
    // An arrow is a measure of length: it stays whole.
    let own = if sample == Sample::Arrow { &own[..1] } else { own };
    let width = SWATCH[0] / own.len() as f32;
    let part = |(i, color): (usize, &Color)| {
        let rect = Rect::new([min[0] + i as f32 * width, min[1]], [width, SWATCH[1]]);
        inked(Ink { color: *color, ..theme.ink(role) }, sample, theme, rect)
    };
    own.iter().enumerate().flat_map(part).collect()
}

fn inked(mut ink: Ink, sample: Sample, theme: Theme, rect: Rect) -> Vec<Primitive> {
    if ink.color.contrast(theme.chrome().panel) >= 3.0 {
        ink.halo_width = 0.0;
    }
    let inner = rect.grown(-(ink.width / 2.0 + ink.halo_width));
    let ([x0, y0], [x1, y1]) = (inner.min, inner.max);
    let middle = (y0 + y1) / 2.0;
    let mut out = Vec::new();
    match sample {
        Sample::Frame => marks::line(&mut out, &ink, inner.corners(), true),
        Sample::Line => marks::line(&mut out, &ink, vec![[rect.min[0], middle], [rect.max[0], middle]], false),
        Sample::Point => marks::point(&mut out, &ink, [(x0 + x1) / 2.0, middle]),
        Sample::Ellipse => {
            let radii = [(x1 - x0) / 2.0, (y1 - y0) / 2.0];
            marks::line(&mut out, &ink, marks::ellipse([x0 + radii[0], middle], radii, 0.0), true);
        }
        Sample::Area => {
            let points = inner.corners();
            out.push(Primitive::Polygon { points: points.clone(), color: ink.color.alpha(mask::HEAT_ALPHA) });
            // White on white is seen by its edge.
            if ink.halo_width > 0.0 {
                out.push(Primitive::Polyline {
                    points,
                    closed: true,
                    stroke: Stroke { width: 1.0, color: theme.chrome().dim, dash: &[] },
                });
            }
        }
        Sample::Hatch => {
            let stripe = |i: usize, color: Color| {
                let x = rect.min[0] + 4.0 * i as f32;
                let points =
                    vec![[x, rect.max[1]], [x + 4.0, rect.max[1]], [x + 8.0, rect.min[1]], [x + 4.0, rect.min[1]]];
                Primitive::Polygon { points, color }
            };
            let [light, dark] = hatch();
            out.extend((0..6).map(|i| stripe(i, if i % 2 == 0 { light } else { dark })));
        }
        Sample::Awaited => {
            let middle_x = (rect.min[0] + rect.max[0]) / 2.0;
            let dot = |x| Primitive::Disc { center: [x, middle], radius: 2.0, color: theme.chrome().dim };
            out.extend([-8.0, 0.0, 8.0].map(|x| dot(middle_x + x)));
        }
        Sample::Mask => {
            out.extend(hatching(&inner, &ink));
            marks::line(&mut out, &Ink { dash: &[], ..ink }, inner.corners(), true);
        }
        Sample::Wheel => out.extend(wheel([(rect.min[0] + rect.max[0]) / 2.0, middle], SWATCH[1] / 2.0)),
        Sample::Arrow => {
            let Ink { color, halo, halo_width, .. } = ink;
            let width = ink.width.min(theme.ink(Role::Result).width);
            let (from, to) = ([rect.max[0] - ARROW, middle], [rect.max[0], middle]);
            out.push(Primitive::Arrows(Arrows::one(from, to, Pen { width, color, halo, halo_width })));
        }
    }
    out
}

/// The stripes of a mask in a swatch.
fn hatching(Rect { min: [left, top], max: [right, bottom] }: &Rect, ink: &Ink) -> Vec<Primitive> {
    let (high, stroke) = (bottom - top, Stroke { width: 1.0, color: ink.color, dash: &[] });
    let count = ((right - left - high) / mask::HATCH_PT) as usize;
    let stripe = |i: usize| {
        let x = left + i as f32 * mask::HATCH_PT;
        Primitive::Polyline { points: vec![[x, *bottom], [x + high, *top]], closed: false, stroke }
    };
    (0..=count).map(stripe).collect()
}

/// What lies under the wheel, as a dimmed picture under the colours of motion.
const GROUND: Color = Color([60, 60, 60, 255]);

/// The wheel of colours in rings, clear in the middle: where a colour lies there, its displacement leads.
pub fn wheel(center: Point, radius: f32) -> Vec<Primitive> {
    const SLICES: usize = 48;
    // As fine as it is large.
    let rings = ((radius / 4.0) as usize).clamp(3, 12);
    let at = |slice: usize, share: f32| {
        let (sin, cos) = (slice as f32 / SLICES as f32 * std::f32::consts::TAU).sin_cos();
        [center[0] + cos * share * radius, center[1] + sin * share * radius]
    };
    let cell = |ring: usize, slice: usize| {
        let (inner, outer) = (ring as f32 / rings as f32, (ring + 1) as f32 / rings as f32);
        let points = vec![at(slice, inner), at(slice, outer), at(slice + 1, outer), at(slice + 1, inner)];
        let angle = (slice as f32 + 0.5) / SLICES as f32 * std::f32::consts::TAU;
        // As over a dimmed picture, where little motion is hardly any colour.
        let color = GROUND.mix(flow_color([angle.cos() * outer, angle.sin() * outer], 1.0), veil(outer));
        Primitive::Polygon { points, color }
    };
    (0..rings)
        .flat_map(|ring| (0..SLICES).map(move |slice| (ring, slice)))
        .map(|(ring, slice)| cell(ring, slice))
        .collect()
}

/// The same as pixels, without the seams of its cells.
fn wheel_image(rect: Rect) -> Primitive {
    let side = (4.0 * rect.size()[0]) as usize;
    let half = side as f32 / 2.0;
    let color = |x: usize, y: usize| {
        let uv = [x, y].map(|c| (c as f32 + 0.5) / half - 1.0);
        let length = uv[0].hypot(uv[1]);
        let color = GROUND.mix(flow_color(uv, 1.0f32.max(length)), veil(length));
        // The rim is soft over a pixel.
        color.alpha((255.0 * ((1.0 - length) * half + 0.5).clamp(0.0, 1.0)) as u8).0
    };
    Primitive::Image { pixels: Arc::new(Grid::from_fn(side, side, color)), rect }
}

/// A point in the ink of `role` at `at`.
pub fn point(role: Role, theme: Theme, at: Point) -> Vec<Primitive> {
    let mut out = Vec::new();
    marks::point(&mut out, &theme.ink(role), at);
    out
}

/// The colours from small to large, left to right.
pub fn color_bar(colors: ColorMap, rect: Rect) -> Primitive {
    let cells = (rect.size()[0].round() as usize).clamp(2, 512);
    let pixels = Grid::from_fn(cells, 1, |x, _| colors.at(x as f32 / (cells - 1) as f32).0);
    Primitive::Image { pixels: Arc::new(pixels), rect }
}

/// The legend, laid out in lines of at most `width` from `min` down, and its height.
pub(super) fn strip(
    entries: &[Entry],
    bars: &[Bar],
    theme: Theme,
    (min, width): (Point, f32),
) -> (Vec<Primitive>, f32) {
    let size = theme.sizes().small;
    let mut strip = Strip { theme, min, width, at: min, height: line_height(size), size, out: Vec::new() };
    let (wheels, signs): (Vec<_>, Vec<_>) = entries.iter().partition(|entry| entry.sample == Sample::Wheel);
    signs.into_iter().for_each(|entry| strip.entry(entry));
    bars.iter().for_each(|bar| strip.bar(bar));
    // Last, on a line of its own: large enough to find a direction in it.
    wheels.into_iter().for_each(|entry| strip.wheel(entry));
    let height = if strip.out.is_empty() { 0.0 } else { strip.at[1] + strip.height - min[1] };
    (strip.out, height)
}

/// Height of a line of type, on the grid of 4 points.
pub(super) fn line_height(size: f32) -> f32 {
    (size * 1.4 / 4.0).ceil() * 4.0
}

struct Strip {
    theme: Theme,
    min: Point,
    width: f32,
    at: Point,
    height: f32,
    size: f32,
    out: Vec<Primitive>,
}

impl Strip {
    /// Room for an item this wide: on this line, else on the next.
    fn place(&mut self, width: f32) -> Point {
        if self.at[0] > self.min[0] && self.at[0] + width > self.min[0] + self.width {
            self.at = [self.min[0], self.at[1] + self.height + 4.0];
        }
        let at = self.at;
        self.at[0] = ((at[0] + width) / 4.0).ceil() * 4.0 + 2.0 * GAP;
        at
    }

    fn words(&mut self, text: &str, [x, y]: Point) {
        let color = self.theme.chrome().text;
        // Capitals and digits of Inter are 0.73 em high: this centres them on the line.
        let baseline = (y + self.height / 2.0 + self.size * 0.365).round();
        let runs = vec![Run::new(text, color)];
        let line = Line { at: [x, baseline], anchor: Anchor::Start, size: self.size, runs, halo: None };
        self.out.push(Primitive::Text(line));
    }

    fn entry(&mut self, entry: &Entry) {
        let [wide, high] = SWATCH;
        let width = wide + GAP + fonts::width(&entry.meaning, Face::Sans, self.size);
        let [x, y] = self.place(width.min(self.width));
        let at = [x, y + (self.height - high) / 2.0];
        let swatch = swatch_of(&entry.own, (entry.role, entry.sample), self.theme, at);
        self.out.extend(swatch);
        if width <= self.width {
            return self.words(&entry.meaning, [x + wide + GAP, y]);
        }
        // Wider than the figure: on as many lines as it takes.
        let runs = [Run::new(&entry.meaning, self.theme.chrome().text)];
        let lines = wrap(&runs, self.size, (self.width - wide - GAP).max(wide));
        for (i, runs) in lines.iter().enumerate() {
            self.at[1] = y + i as f32 * self.height;
            let text: String = runs.iter().map(|run| run.text.as_str()).collect();
            self.words(text.trim_end(), [x + wide + GAP, self.at[1]]);
        }
    }

    fn wheel(&mut self, entry: &Entry) {
        if !self.out.is_empty() {
            self.at = [self.min[0], self.at[1] + self.height + 4.0];
        }
        let [x, y] = self.at;
        self.out.push(wheel_image(Rect::new([x, y], [WHEEL; 2])));
        let (color, room) = (self.theme.chrome().text, (self.width - WHEEL - GAP).max(GAP));
        let parts = entry.meaning.split_inclusive(", ").map(|part| vec![Run::new(part.trim_end(), color)]);
        let lines: Vec<_> = parts.flat_map(|runs| wrap(&runs, self.size, room)).collect();
        let top = y + (WHEEL - self.height * lines.len() as f32) / 2.0;
        for (i, runs) in lines.into_iter().enumerate() {
            let baseline = (top + self.height * (i as f32 + 0.5) + self.size * 0.365).round();
            let at = [x + WHEEL + GAP, baseline];
            self.out.push(Primitive::Text(Line { at, anchor: Anchor::Start, size: self.size, runs, halo: None }));
        }
        self.at = [self.min[0], y + WHEEL - self.height];
    }

    fn bar(&mut self, bar: &Bar) {
        let [low, high] = &bar.ends;
        let [left, right] = [low, high].map(|words| fonts::width(words, Face::Sans, self.size));
        if high.is_empty() {
            let at = self.place(left);
            return self.words(low, at);
        }
        let room = self.width - left - right - 2.0 * GAP;
        if room < SHORTEST_BAR
            && let Some((label, low)) = low.rsplit_once(' ')
        {
            // On a line of its own; the numbers stay beside the bar.
            let at = self.place(fonts::width(label, Face::Sans, self.size));
            self.words(label, at);
            return self.bar(&Bar { ends: [low.to_owned(), high.clone()], ..*bar });
        }
        let long = room.clamp(SHORTEST_BAR, BAR[0]).floor();
        let [x, y] = self.place(left + long + right + 2.0 * GAP);
        self.words(low, [x, y]);
        let min = [(x + left + GAP).round(), y + (self.height - BAR[1]) / 2.0];
        let rect = Rect::new(min, [long, BAR[1]]);
        self.out.push(color_bar(bar.colors, rect));
        let stroke = Stroke { width: 1.0, color: self.theme.chrome().line, dash: &[] };
        self.out.push(Primitive::Polyline { points: rect.grown(0.5).corners(), closed: true, stroke });
        self.words(high, [min[0] + long + GAP, y]);
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::{Link, Picture};

    use super::*;

    #[test]
    fn lines_between_pictures_have_a_meaning_too() {
        let mut scene = Scene::default();
        scene.legend(Role::Best, "correct match");
        scene.legend(Role::Error, "wrong match");
        let ends = [(Picture::CURRENT, [1.0; 2]), (Picture::NEXT, [2.0; 2])];
        scene.links.push(Link { role: Role::Best, ends });
        let look = Look::new(&scene, marks::Style::default());
        let found = entries(&scene, scene.marks.iter(), &look, 1.0);
        let (sample, meaning) = (Sample::Line, "correct match".to_owned());
        assert_eq!(found, [Entry { role: Role::Best, sample, own: Vec::new(), meaning }]);
    }

    #[test]
    fn objects_with_colours_of_their_own_show_them_in_the_legend() {
        let mut scene = Scene::default();
        let labels = Grid::from_fn(40, 30, |x, _| [0, 2, 5][x / 15]);
        scene.mark(Picture::CURRENT, Role::Best, Shape::Labels(Arc::new(labels)));
        scene.legend(Role::Best, "segments, one colour each");
        let point = |x: f32| Shape::Points(vec![[x, 2.0]]);
        scene.mark_of(2, Picture::CURRENT, Role::Result, point(1.0));
        scene.legend(Role::Result, "mean displacement of a segment");
        let found = |scene: &Scene| {
            let look = Look::new(scene, marks::Style::default());
            entries(scene, scene.marks.iter(), &look, 1.0).into_iter().map(|entry| entry.own).collect::<Vec<_>>()
        };
        let [second, fifth] = [2, 5].map(marks::own_color);
        assert_eq!(found(&scene), [vec![second, fifth], vec![Color::WHITE]], "white on the regions");
        scene.marks.remove(0);
        (3..9).for_each(|of| scene.mark_of(of, Picture::CURRENT, Role::Result, point(of as f32)));
        assert_eq!(found(&scene), [[2, 3, 4].map(marks::own_color)], "as many as can be told apart");
        let swatch = swatch_of(&found(&scene)[0], (Role::Result, Sample::Point), Theme::Dark, [0.0; 2]);
        let discs =
            swatch.iter().filter_map(|p| if let Primitive::Disc { color, .. } = p { Some(*color) } else { None });
        assert!(discs.collect::<Vec<_>>().ends_with(&[marks::own_color(4)]));
    }

    #[test]
    fn the_numbers_of_a_bar_have_room() {
        let bar = Bar::heat("fourth root of |R|, with its sign", [-19.87, 10.83], ColorMap::Viridis);
        let laid = |width: f32| strip(&[], std::slice::from_ref(&bar), Theme::Dark, ([16.0; 2], width));
        let heights = [240.0, 300.0, 364.0, 900.0].map(|width| {
            let (primitives, height) = laid(width);
            let end = |primitive: &Primitive| match primitive {
                // Bounds of words hold room for letters that lean out.
                Primitive::Text(line) => line.at[0] + line.width(),
                other => other.bounds().max[0],
            };
            let end = primitives.iter().map(end).fold(0.0, f32::max);
            assert!(end <= 16.0 + width, "{end} in {width}");
            height
        });
        assert!(heights[0] > heights[3], "the label has a line of its own where there is little room");
    }

    #[test]
    fn a_long_meaning_is_wrapped_to_the_width_of_the_figure() {
        let meaning = "displacements found, drawn ×2 (this arrow: 12 px), one about every 16 px drawn".to_owned();
        let entry = Entry { role: Role::Result, sample: Sample::Arrow, own: Vec::new(), meaning };
        let (primitives, height) = strip(&[entry.clone(), entry], &[], Theme::Dark, ([0.0; 2], 240.0));
        let lines = primitives.iter().filter_map(|p| if let Primitive::Text(line) = p { Some(line) } else { None });
        let lines: Vec<_> = lines.collect();
        assert!(lines.len() >= 6 && lines.iter().all(|line| line.at[0] + line.width() <= 240.0), "{lines:?}");
        assert!(lines.windows(2).all(|pair| pair[0].at[1] < pair[1].at[1]) && lines[5].at[1] < height);
    }

    #[test]
    fn every_swatch_stays_in_its_box() {
        let samples = [
            Sample::Frame,
            Sample::Ellipse,
            Sample::Arrow,
            Sample::Point,
            Sample::Line,
            Sample::Wheel,
            Sample::Mask,
            Sample::Area,
            Sample::Hatch,
            Sample::Awaited,
        ];
        for theme in Theme::ALL {
            for role in Role::ALL {
                for sample in samples {
                    let primitives = swatch(role, sample, theme, [8.0, 8.0]);
                    assert!(!primitives.is_empty());
                    let room = Rect::new([8.0, 8.0], SWATCH).grown(4.0);
                    let inside = |p: &Point| (0..2).all(|i| p[i] >= room.min[i] && p[i] <= room.max[i]);
                    let points = primitives.iter().flat_map(|primitive| match primitive {
                        Primitive::Polygon { points, .. } | Primitive::Polyline { points, .. } => points.clone(),
                        Primitive::Arrows(arrows) => arrows.iter().flat_map(|arrow| [arrow.from, arrow.to]).collect(),
                        other => other.bounds().grown(-1.0).corners(),
                    });
                    assert!(points.into_iter().all(|p| inside(&p)), "{theme:?} {role:?} {sample:?}");
                }
            }
        }
    }
}
