//! A figure: what one exported picture consists of.

mod framing;

use std::sync::Arc;

use framing::{cut, has_part, is_link_seen, is_seen, magnified, pane_size, pane_sizes};
use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Mark, Math, Picture, Scene, Sentence, Shape, Surface};

use super::charts::explanation::{Density, equation};
use super::charts::relief::{Landscape, Lean};
use super::charts::{Orbit, Type, shortened};
use super::focus::{self, FocusMode, Work};
use super::freehand::{FreehandLine, freehand};
use super::legend::{self, Bar, line_height};
use super::links::{LinkSite, links};
use super::primitive::{Anchor, Layer, Line, Point, Primitive, Rect, Run, Stroke};
use super::reduced::reduced;
use super::wrap::{brevity, inked, wrap};
use super::{
    Backdrop, Color, Face, FlowLayer, Look, Panel, Pictures, Placement, Share, Shown, Style, Theme, TypeSizes, View,
    dimmed, fonts, marks,
};

/// Space around everything.
const MARGIN: f32 = 16.0;
/// Space between things that belong together.
const GAP: f32 = 8.0;
/// How far marks may reach beyond a picture where there is room, so that a frame at its edge stays whole.
const BEYOND: f32 = 4.0;
/// Words are given at least this many times their size to run in.
const LEAST_WIDTH: f32 = 20.0;

/// What a figure shows and how.
#[derive(Clone, Debug, Default)]
pub struct FigureOptions {
    /// How the pair is looked at.
    pub view: View,
    /// The share of frame t + 1 in a blend.
    pub share: Share,
    /// Colours and sizes, and how displacements are drawn.
    pub style: Style,
    /// The moment at which streaklines are seen, a share of a particle's life.
    pub phase: f32,
    /// Points per pixel of the clip; 0 counts as 1. Lines and words do not grow with it.
    pub zoom: f32,
    /// Pixels per point that it will be painted with, at which marks find room; 0 counts as 1.
    pub scale: u32,
    /// Whether the part at work is magnified.
    pub focus: FocusMode,
    /// The part of the pictures that is shown instead, in px of frame t, where one was chosen by hand.
    pub section: Option<Rect>,
    /// Whether the run is at its end, where the whole is shown unless focus is chosen.
    pub at_end: bool,
    /// How the picture under a layer of colours is shown.
    pub backdrop: Backdrop,
    /// Number of frame t, for the titles.
    pub frame: Option<usize>,
    /// From where one looks at pictures that are leaned back, where they are.
    pub leaned: Option<Orbit>,
    /// Whether what the marks mean stands below.
    pub legend: bool,
    /// Whether titles stand above the pictures, even where nothing else stands around them.
    pub titles: bool,
    /// What heat shows, for the legend: `SAD`.
    pub heat: String,
    /// Words above and below the pictures.
    pub caption: Option<Caption>,
    /// What was drawn by hand on the step.
    pub freehand: Arc<[FreehandLine]>,
}

/// Words around the pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Caption {
    /// The estimator: `Full search`.
    pub title: String,
    /// Its parameters: `block 16 px · range 16 px · SAD`.
    pub details: String,
    /// Where in the run: `step 35.412`.
    pub place: String,
    /// Why the last event happened.
    pub sentence: Sentence,
    /// The formula of the step, a line of it each; none unless it is asked for.
    pub formula: Vec<Math>,
}

/// The pictures of a figure as they stand: how many beside each other, and how large all of them are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Pictures in a row, at most.
    pub columns: usize,
    /// Width of the widest row and height of all rows in px of the pictures, without what stands between them.
    pub size: [f32; 2],
}

impl Extent {
    /// The extent of `parts` as `view` shows them: a step may have pictures that are larger than the frames.
    pub fn of(parts: &[Part<'_>], view: View) -> Self {
        Self::seen(parts, view, None)
    }

    /// The same where `section` of the pictures was chosen by hand: along one side of its picture a part takes less room.
    pub fn seen(parts: &[Part<'_>], view: View, section: Option<Rect>) -> Self {
        let panels = |part: &Part<'_>| view.panels(&part.pictures);
        let in_a_row = parts.first().map_or(1, |part| panels(part).len());
        let sizes = pane_sizes(parts, panels, section);
        // Four stand in a square.
        let columns = match (parts.len(), in_a_row) {
            (1, 4) => 2,
            (4, _) => 2 * in_a_row,
            _ => sizes.len(),
        };
        let columns = columns.max(1);
        let rows = || sizes.chunks(columns);
        let width = rows().map(|row| row.iter().map(|size| size[0]).sum::<f32>()).fold(0.0, f32::max);
        let height = rows().map(|row| row.iter().map(|size| size[1]).fold(0.0, f32::max)).sum::<f32>();
        Self { columns, size: [width, height] }
    }
}

/// What one estimator shows on a figure.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// The frames, and what was made of them.
    pub pictures: Pictures,
    /// The marks.
    pub scene: &'a Scene,
    /// The surface that rises out of a picture where that is leaned back.
    pub rises: Option<Surface>,
    /// Where there are several: the estimator's name, whether it waits for the others, and what it has come to, the
    /// first that there is room for being told.
    pub heading: Option<(&'a [String; 2], bool, &'a [Sentence])>,
}

/// Everything of one exported picture, laid out in points.
///
/// Without legend and caption it is the panels alone: one panel has exactly the clip's pixels, times the zoom.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Width and height, whole numbers.
    pub size: [f32; 2],
    /// Behind everything.
    pub background: Color,
    /// Back to front.
    pub layers: Vec<Layer>,
    /// The panels and where their pictures lie.
    pub panels: Vec<(Panel, Placement)>,
    /// One line that says what it is, for those who cannot see it.
    pub description: String,
}

impl Figure {
    /// Lays out `scene` over `pictures`.
    pub fn new(pictures: &Pictures, scene: &Scene, options: &FigureOptions) -> Self {
        Self::of(&[Part { pictures: pictures.clone(), scene, rises: None, heading: None }], scene, options)
    }

    /// Lays out `parts`, two or three in a row and four in a square; `scene` has the marks of all.
    pub fn of(parts: &[Part<'_>], scene: &Scene, options: &FigureOptions) -> Self {
        let look = Look::new(scene, options.style);
        let look = Look { density: options.scale.max(1) as f32, ..look };
        let is_framed = options.legend || options.titles || options.caption.is_some() || parts.len() > 1;
        let mut layout = Layout {
            options,
            look,
            sizes: options.style.theme.sizes(),
            margin: if is_framed { MARGIN } else { 0.0 },
            width: 0.0,
            y: if is_framed { MARGIN } else { 0.0 },
            words: Vec::new(),
            pictures: Vec::new(),
            panels: Vec::new(),
            times: 1.0,
        };
        layout.lay_out(parts, scene, is_framed);
        let description = description(options, parts);
        let Layout { margin, width, y, words, mut pictures, panels, .. } = layout;
        pictures.push(Layer { clip: None, primitives: words });
        Self {
            size: [width + 2.0 * margin, y + margin],
            background: if is_framed {
                options.style.theme.chrome().panel
            } else {
                options.style.theme.chrome().background
            },
            layers: pictures,
            panels,
            description,
        }
    }
}

fn description(options: &FigureOptions, parts: &[Part<'_>]) -> String {
    let Some(Part { pictures, .. }) = parts.first() else { return String::new() };
    let shown = options.view.panels(pictures).into_iter().map(|panel| Shown { panel, share: options.share, gain: 1 });
    let titles: Vec<_> = shown.map(|shown| pictures.title(shown, options.frame, true)).collect();
    let tiles = parts.iter().filter_map(|part| part.heading).map(|([name, _], _, words)| {
        let words = words.first().map_or_else(String::new, Sentence::plain);
        format!("{name}: {words}")
    });
    let pictures = std::iter::once(titles.join(" and ")).chain(tiles).collect::<Vec<_>>().join(". ");
    match &options.caption {
        None => pictures,
        Some(caption) => {
            let said = [&caption.title, &caption.details, &caption.place, &pictures, &caption.sentence.plain()];
            said.into_iter().filter(|part| !part.is_empty()).cloned().collect::<Vec<_>>().join(". ")
        }
    }
}

/// A figure on its way, from the top down.
struct Layout<'a> {
    options: &'a FigureOptions,
    look: Look,
    sizes: TypeSizes,
    margin: f32,
    /// Width between the margins.
    width: f32,
    /// Where the next thing goes.
    y: f32,
    words: Vec<Primitive>,
    pictures: Vec<Layer>,
    panels: Vec<(Panel, Placement)>,
    /// How many times as large as in the whole picture the part at work is shown.
    times: f32,
}

impl Layout<'_> {
    /// Points per pixel of the clip.
    fn zoom(&self) -> f32 {
        if self.options.zoom > 0.0 { self.options.zoom } else { 1.0 }
    }

    fn lay_out(&mut self, parts: &[Part<'_>], scene: &Scene, is_framed: bool) {
        let zoom = self.zoom();
        let panels_of = |part: &Part<'_>| self.options.view.panels(&part.pictures);
        let in_a_row = parts.first().map_or(1, |part| panels_of(part).len());
        let magnified = magnified(parts, self.options);
        let pictures: Vec<_> = parts
            .iter()
            .zip(&magnified)
            .flat_map(|(part, magnified)| panels_of(part).into_iter().map(move |panel| (part, panel, *magnified)))
            .map(|(part, panel, magnified)| (part, panel, magnified.filter(|_| has_part(panel))))
            .map(|(part, panel, magnified)| (part, panel, magnified, self.pixels(part, panel)))
            .collect();
        let Extent { columns, size: [across, _] } = Extent::seen(parts, self.options.view, self.options.section);
        let total = across * zoom + GAP * (columns - 1) as f32;
        self.width = if is_framed { on_grid(total.max(LEAST_WIDTH * self.sizes.body)) } else { total };
        if let Some(caption) = &self.options.caption {
            self.header(caption);
        }
        let column = pictures.first().map_or(0.0, |(part, panel, of, _)| pane_size(part, *panel, *of)[0] * zoom);
        let said = parts.iter().filter_map(|part| part.heading).map(|(.., words)| words);
        let way = brevity(said, |words| fonts::width(&words.plain(), Face::Sans, self.sizes.small) <= column);
        self.times = magnified.iter().flatten().map(|of| of.close_up.times).fold(1.0, f32::max);
        let (mut x, mut top, mut bottom) = (self.margin, self.y, self.y);
        let mut sites = Vec::new();
        for (index, (part, panel, magnified, (pixels, gain))) in pictures.into_iter().enumerate() {
            if index > 0 && index % columns == 0 {
                (x, top) = (self.margin, on_grid(bottom) + GAP);
            }
            self.y = top;
            let size = pane_size(part, panel, magnified).map(|side| side * zoom);
            if is_framed {
                let shown = Shown { panel, share: self.options.share, gain };
                match part.heading {
                    Some((names, waits, words)) => {
                        let room = size[0] - if waits { 3.0 * self.sizes.body } else { 0.0 };
                        let fits = |name: &&String| fonts::width(name, Face::Bold, self.sizes.body) <= room;
                        let face = Type { face: Face::Bold, size: self.sizes.body, color: Color::BLACK };
                        let name = names.iter().find(fits).cloned();
                        let name = name.unwrap_or_else(|| shortened(&names[1], face, room));
                        self.heading((&name, waits), words.get(way).or(words.last()), x);
                    }
                    None => self.title(shown, &part.pictures, (x, size[0])),
                }
                self.y += 4.0;
            }
            let rect = Rect::new([x, self.y], size);
            let is_first = index % in_a_row.max(1) == 0;
            let placement = match magnified {
                Some(magnified) => magnified.placement(rect, zoom),
                None => Placement::new(rect.min, zoom),
            };
            let pixels = Arc::new(pixels);
            let is_flat = self.panel((panel, placement), rect, &pixels, part);
            if is_flat {
                self.freehand((panel, placement), index / in_a_row.max(1), rect);
                sites.push(LinkSite { panel, place: placement, pane: rect });
            }
            if magnified.is_some() && is_first && is_flat {
                self.map((rect, placement), &pixels, Work::of(part.scene, part.pictures.pair[0].size()));
            }
            x += size[0] + GAP;
            bottom = bottom.max(self.y + size[1]);
        }
        for (part, sites) in parts.iter().zip(sites.chunks(in_a_row.max(1))) {
            let primitives = links(part.scene, &self.look, sites);
            self.pictures.extend((!primitives.is_empty()).then_some(Layer { clip: None, primitives }));
        }
        self.y = if is_framed { on_grid(bottom) } else { bottom };
        if let Some(caption) = self.options.caption.as_ref().filter(|caption| !caption.sentence.is_empty()) {
            self.y += GAP;
            self.paragraph(&inked(&caption.sentence, self.options.style.theme), self.sizes.body);
        }
        if let Some(formula) = self.options.caption.as_ref().map(|caption| &caption.formula) {
            self.formula(formula);
        }
        if self.options.legend {
            self.legend(parts, scene);
        }
    }

    /// The pixels of a panel, dimmed where a layer of colours is to be read over them.
    fn pixels(&self, part: &Part<'_>, panel: Panel) -> (Grid<[u8; 4]>, u16) {
        let (pixels, gain) = panel.pixels(&part.pictures, self.options.share);
        let is_dimmed = self.options.backdrop == Backdrop::Dimmed && has_colors(panel, &part.pictures, part.scene);
        (if is_dimmed { dimmed(&pixels) } else { pixels }, gain)
    }

    /// The formula of the step below its sentence, no wider than the pictures.
    fn formula(&mut self, lines: &[Math]) {
        if lines.is_empty() {
            return;
        }
        self.y += GAP;
        let theme = self.options.style.theme;
        let block = equation(lines, (self.width, Density::close(theme)), theme);
        let at = [self.margin, self.y];
        self.words.extend(block.primitives.into_iter().map(|primitive| primitive.moved(at)));
        self.y += block.size[1];
    }

    /// What stands above a picture that begins at `x`; without the name of its file where that is too long.
    fn title(&mut self, shown: Shown, pictures: &Pictures, (x, width): (f32, f32)) {
        let has_next_to_it = matches!(shown.panel, Panel::Of(picture) if picture != Picture::NEXT);
        let room = if has_next_to_it { width } else { self.margin + self.width - x };
        let titles = [true, false].map(|is_whole| pictures.title(shown, self.options.frame, is_whole));
        let [whole, short] = &titles;
        let title = if fonts::width(whole, Face::Sans, self.sizes.small) <= room { whole } else { short };
        self.line(vec![Run::new(title, self.options.style.theme.chrome().dim)], self.sizes.small, x);
    }

    /// The estimator's name above its picture that begins at `x`, whether it waits, and below what it has come to.
    fn heading(&mut self, (name, waits): (&str, bool), words: Option<&Sentence>, x: f32) {
        let chrome = self.options.style.theme.chrome();
        let (body, small) = (self.sizes.body, self.sizes.small);
        if waits {
            let runs = vec![Run::new("done", chrome.dim)];
            let at = [x + fonts::width(name, Face::Bold, body) + GAP, baseline(self.y, body)];
            self.words.push(Primitive::Text(Line { at, anchor: Anchor::Start, size: small, runs, halo: None }));
        }
        self.line(vec![Run::new(name, chrome.text).face(Face::Bold)], body, x);
        if let Some(words) = words {
            self.line(inked(words, self.options.style.theme), small, x);
        }
    }

    fn panel(&mut self, at: (Panel, Placement), rect: Rect, pixels: &Arc<Grid<[u8; 4]>>, part: &Part<'_>) -> bool {
        let (panel, placement) = at;
        if let Some(layer) = self.landscape(at, rect, pixels, part) {
            self.pictures.push(layer);
            self.panels.push(at);
            return false;
        }
        let Pictures { layer, streaks, .. } = &part.pictures;
        // What is smaller than on the sheet's own pixels is reduced, so that none of it is skipped.
        let factor = (1.0 / (placement.zoom * self.look.density)).floor().max(1.0) as usize;
        let fine = |pixels: &Arc<Grid<[u8; 4]>>| match factor {
            1 => pixels.clone(),
            factor => Arc::new(reduced(pixels, factor).into_owned()),
        };
        let image = |pixels: &Arc<Grid<[u8; 4]>>| match placement.seen {
            Some(seen) => cut(pixels, placement, seen),
            None => Primitive::Image { pixels: fine(pixels), rect },
        };
        let mut primitives = vec![image(pixels)];
        let of_frame_t = panel.shows(Picture::CURRENT);
        if let Some(layer) = layer.as_ref().filter(|_| panel.is_tinted()) {
            primitives.push(image(&layer.pixels));
        }
        primitives.extend(marks::resolve(
            shown(panel, part.scene),
            &self.look,
            Placement { room: Some(rect), ..placement },
        ));
        if let Some(streaks) = streaks.as_ref().filter(|_| of_frame_t) {
            primitives.push(marks::streaks(&streaks.at(self.options.phase), self.look.theme, placement));
        }
        let beyond = if self.margin > 0.0 && placement.seen.is_none() { BEYOND } else { 0.0 };
        let is_arrow = |primitive: &Primitive| matches!(primitive, Primitive::Arrows(_) | Primitive::Trails(_));
        for chunk in primitives.chunk_by(|a, b| is_arrow(a) == is_arrow(b)) {
            // Arrows end with the picture.
            let clip = if chunk.iter().any(is_arrow) { rect } else { rect.grown(beyond) };
            self.pictures.push(Layer { clip: Some(clip), primitives: chunk.to_vec() });
        }
        self.panels.push(at);
        true
    }

    /// A panel that is leaned back, with what rises from it.
    fn landscape(
        &self,
        (panel, flat): (Panel, Placement),
        rect: Rect,
        pixels: &Grid<[u8; 4]>,
        part: &Part<'_>,
    ) -> Option<Layer> {
        let orbit = self.options.leaned?;
        let surface = part.rises.as_ref()?;
        let footing = surface.footing.as_ref().filter(|footing| panel.shows(footing.on))?;
        let landscape = Landscape::new((surface, footing), (flat, rect), Lean { amount: 1.0, orbit });
        let (theme, density) = (self.look.theme, self.look.density);
        let ([left, top], [right, bottom]) = (rect.min, rect.max);
        let points = vec![[left, top], [right, top], [right, bottom], [left, bottom]];
        let mut primitives = vec![Primitive::Polygon { points, color: theme.chrome().background }];
        primitives.push(Primitive::Image { pixels: Arc::new(landscape.pictured(pixels, density)), rect });
        let marks = shown(panel, part.scene).filter(|mark| !mark.shape.is_layer());
        primitives.extend(landscape.laid(marks::resolve(marks, &self.look, flat)));
        let [behind, before] = landscape.stand(theme);
        primitives.extend(behind);
        primitives.extend(landscape.polygons((theme, self.look.colors, density)));
        primitives.extend(before);
        Some(Layer { clip: Some(rect), primitives })
    }

    /// What was drawn by hand on a panel of estimator `member`; it ends with the picture.
    fn freehand(&mut self, (panel, placement): (Panel, Placement), member: usize, rect: Rect) {
        let lines = self.options.freehand.iter().filter(|line| line.is_on(panel, member));
        let primitives = freehand(lines, self.look.theme, placement);
        self.pictures.extend((!primitives.is_empty()).then_some(Layer { clip: Some(rect), primitives }));
    }

    /// The whole picture as a small map in a corner of what is magnified, with a frame around what is seen.
    fn map(&mut self, (pane, placement): (Rect, Placement), pixels: &Arc<Grid<[u8; 4]>>, work: Option<Work>) {
        let picture = [pixels.width() as f32, pixels.height() as f32];
        let work =
            work.map(|Work { bounds, .. }| Rect { min: placement.at(bounds.min), max: placement.at(bounds.max) });
        let Some(rect) = focus::map_rect(pane, picture, work) else { return };
        let scale = rect.size()[0] / picture[0];
        let factor = (1.0 / (scale * self.look.density)).floor().max(1.0) as usize;
        let image = Primitive::Image { pixels: Arc::new(reduced(pixels, factor).into_owned()), rect };
        let at = |point: Point| [0, 1].map(|i| rect.min[i] + (point[i] - placement.origin[i]) / placement.zoom * scale);
        let seen = Rect { min: at(pane.min), max: at(pane.max) };
        let primitives = [vec![image], focus_frames(rect, seen)].concat();
        self.pictures.push(Layer { clip: Some(rect.grown(2.0)), primitives });
    }

    fn header(&mut self, caption: &Caption) {
        let place = ([self.margin, self.y], self.width);
        let (primitives, height) = heading(caption, place, self.options.style.theme);
        self.words.extend(primitives);
        self.y += height;
    }

    fn legend(&mut self, parts: &[Part<'_>], scene: &Scene) {
        let panels: Vec<_> = parts.iter().flat_map(|part| self.options.view.panels(&part.pictures)).collect();
        let marks = scene.marks.iter().filter(|mark| panels.iter().any(|panel| panel.shows(mark.on)));
        // A close-up of the work has all of its marks; a part chosen by hand may have none of them.
        let is_chosen = self.options.section.is_some();
        let marks = marks.filter(|mark| !is_chosen || is_seen(mark, &self.panels, &self.look));
        let links = scene.links.iter().filter(|link| !is_chosen || is_link_seen(link, &self.panels));
        let told = Scene { legend: scene.legend.clone(), links: links.copied().collect(), ..Scene::default() };
        let mut entries = legend::entries(&told, marks.clone(), &self.look, self.zoom() * self.times);
        let heat = self.look.heat.filter(|_| has_heat(marks));
        let heat = heat.map(|range| Bar::heat(&self.options.heat, range, self.look.colors));
        // Several have one scale.
        let layer = parts.iter().find_map(|part| part.pictures.layer.as_ref());
        let layer = layer.filter(|_| panels.iter().any(|panel| panel.is_tinted()));
        let (signs, bar) = layer.map(|layer| layer.legend()).unwrap_or_default();
        let awaited = parts.iter().find_map(|part| part.pictures.awaited);
        let awaited = awaited.filter(|_| panels.iter().any(|panel| panel.is_tinted()));
        entries.splice(0..0, signs.into_iter().chain(awaited.map(FlowLayer::awaited)));
        let bars: Vec<_> = heat.into_iter().chain(bar).collect();
        let place = ([self.margin, self.y + 2.0 * GAP], self.width);
        let (primitives, height) = legend::strip(&entries, &bars, self.look.theme, place);
        if height > 0.0 {
            let points = vec![[self.margin, self.y + GAP + 0.5], [self.margin + self.width, self.y + GAP + 0.5]];
            let stroke = Stroke { width: 1.0, color: self.options.style.theme.chrome().line, dash: &[] };
            self.words.push(Primitive::Polyline { points, closed: false, stroke });
            self.words.extend(primitives);
            self.y += 2.0 * GAP + height;
        }
    }

    fn paragraph(&mut self, runs: &[Run], size: f32) {
        for runs in wrap(runs, size, self.width) {
            self.line(runs, size, self.margin);
        }
    }

    fn line(&mut self, runs: Vec<Run>, size: f32, x: f32) {
        let at = [x, baseline(self.y, size)];
        self.words.push(Primitive::Text(Line { at, anchor: Anchor::Start, size, runs, halo: None }));
        self.y += line_height(size);
    }
}

/// The frame of a map of the whole picture, and that of what is seen of it.
pub fn focus_frames(map: Rect, seen: Rect) -> Vec<Primitive> {
    let line = |rect: Rect, width: f32, color: Color| {
        let stroke = Stroke { width, color, dash: &[] };
        Primitive::Polyline { points: rect.corners(), closed: true, stroke }
    };
    // What is seen stays within the map, however small it is.
    let least = 2.0;
    let min = [0, 1].map(|i| seen.min[i].max(map.min[i]).min(map.max[i] - least));
    let max = [0, 1].map(|i| seen.max[i].min(map.max[i]).max(min[i] + least));
    let seen = Rect { min, max };
    vec![
        line(map.grown(0.5), 3.0, Color::BLACK),
        line(map.grown(0.5), 1.0, Color::WHITE),
        line(seen, 4.0, Color::BLACK),
        line(seen, 2.0, Color::WHITE),
    ]
}

/// Title and, if it fits on the line, the place in the run, and the parameters below, from a place on in so much width; gives
/// their height as well.
pub fn heading(caption: &Caption, ([x, y], width): (Point, f32), theme: Theme) -> (Vec<Primitive>, f32) {
    let (chrome, TypeSizes { heading, small, .. }) = (theme.chrome(), theme.sizes());
    let mut primitives = Vec::new();
    // On the line of a type whose size comes third.
    let mut line = |[x, y, of]: [f32; 3], anchor: Anchor, size: f32, runs: Vec<Run>| {
        let at = [x, baseline(y, of)];
        primitives.push(Primitive::Text(Line { at, anchor, size, runs, halo: None }));
    };
    let title = fonts::width(&caption.title, Face::Bold, heading);
    let place = fonts::width(&caption.place, Face::Sans, small);
    let fits = title + 2.0 * GAP + place <= width;
    if fits && !caption.place.is_empty() {
        line([x + width, y, heading], Anchor::End, small, vec![Run::new(&caption.place, chrome.dim)]);
    }
    line([x, y, heading], Anchor::Start, heading, vec![Run::new(&caption.title, chrome.text).face(Face::Bold)]);
    let mut down = y + line_height(heading);
    let mut below = caption.details.clone();
    if !fits {
        below = format!("{below} · {}", caption.place);
    }
    for runs in wrap(&[Run::new(below, chrome.dim)], small, width) {
        line([x, down, small], Anchor::Start, small, runs);
        down += line_height(small);
    }
    (primitives, down + GAP - y)
}

/// A sentence in lines of so many points, from the origin on, and their height.
pub fn paragraph(sentence: &Sentence, width: f32, theme: Theme) -> (Vec<Primitive>, f32) {
    let size = theme.sizes().body;
    let lines = wrap(&inked(sentence, theme), size, width).into_iter().enumerate().map(|(i, runs)| {
        let at = [0.0, baseline(i as f32 * line_height(size), size)];
        Primitive::Text(Line { at, anchor: Anchor::Start, size, runs, halo: None })
    });
    let lines: Vec<_> = lines.collect();
    let height = lines.len() as f32 * line_height(size);
    (lines, height)
}

/// The next multiple of 4 points.
fn on_grid(v: f32) -> f32 {
    (v / 4.0).ceil() * 4.0
}

fn shown(panel: Panel, scene: &Scene) -> impl Iterator<Item = &Mark> {
    scene.marks.iter().filter(move |mark| panel.shows(mark.on))
}

/// Whether colours to be read off a scale cover a panel: a layer of motion, or numbers of all pixels.
pub fn has_colors(panel: Panel, pictures: &Pictures, scene: &Scene) -> bool {
    let size = panel.frames(pictures)[0].size();
    let covers = |mark: &Mark| matches!(&mark.shape, Shape::Heat { values, .. } if values.size() == size);
    (panel.is_tinted() && pictures.layer.is_some()) || shown(panel, scene).any(covers)
}

fn has_heat<'a>(mut marks: impl Iterator<Item = &'a Mark>) -> bool {
    marks.any(|mark| matches!(mark.shape, Shape::Heat { .. }))
}

/// The baseline of a line of type whose box begins at `y`.
fn baseline(y: f32, size: f32) -> f32 {
    (y + line_height(size) / 2.0 + size * 0.365).round()
}
