//! Where the panes lie, worked out anew in each frame from the size of the window, its type and what there is to show.
//!
//! The pictures come first. Everything else, which is words, the formula and a chart, stands in one region beside them or below
//! them, whichever leaves the pictures larger. The region has what the pictures leave it: they keep the share of the window that a class
//! can see, and no more than they can fill. Where the region has no room for formula and chart, one of them has the place of both.
//!
//! [`Room`] becomes an [`Arrangement`], with no state but the shares that the user drags. For each side, and for each way in
//! which the pictures can share the stage (in columns, or one large with small ones in the region of the words), the words get
//! their usual room, or as little less as leaves the pictures their share of the window; space that the pictures cannot fill
//! goes back to the words, and the candidate with the largest pictures wins. Two pictures stay alike unless one alone would be
//! about twice as large. In a lecture, in the projector theme and wherever a window is small for its type, only sentence and
//! formula are shown, in larger type; full screen enlarges the whole interface. A window too small for its type gets smaller
//! type (`zoom_that_fits`). Apart from the number of pictures, nothing depends on the step, so the stage stays where it is. A
//! test lays out every estimator and every page of the lessons, and fails on overlaps, cut words and pictures below their
//! share.

use eframe::egui::{Rect, Vec2, pos2, vec2};
use serde::{Deserialize, Serialize};

/// A pane that can be folded away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    /// Clip, estimator and their parameters.
    Parameters,
    /// The explanation of the step.
    Explanation,
    /// The charts.
    Charts,
}

/// What is folded away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Folded {
    /// The parameters.
    pub parameters: bool,
    /// The explanation; in a lecture, all of it but the sentence and the formula.
    pub explanation: bool,
    /// The charts.
    pub charts: bool,
}

/// How much of the explanation stands beside the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// All of the explanation.
    Working,
    /// The sentence and the formula, in large type.
    Lecture,
    /// The same, with nothing around it but the transport.
    Embedded,
    /// The same, in type for the last row, with nothing around it.
    Presenting,
}

/// Shares of the room that the person drags.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Shares {
    /// Width or height of the words, of what they have by default.
    pub column: f32,
    /// Height or width of the charts, of what they have by default.
    pub charts: f32,
    /// Width of the parameters, of what they have by default.
    pub parameters: f32,
}

/// One of the shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Share {
    /// [`Shares::column`].
    Column,
    /// [`Shares::charts`].
    Charts,
    /// [`Shares::parameters`].
    Parameters,
}

impl Shares {
    /// The value of a share.
    pub fn of(&mut self, share: Share) -> &mut f32 {
        match share {
            Share::Column => &mut self.column,
            Share::Charts => &mut self.charts,
            Share::Parameters => &mut self.parameters,
        }
    }
}

impl Default for Shares {
    fn default() -> Self {
        Self { column: 1.0, charts: 1.0, parameters: 1.0 }
    }
}

/// Least and largest share.
pub const SHARES: std::ops::RangeInclusive<f32> = 0.5..=1.6;

/// Number, size and surroundings of the pictures on the stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pictures {
    /// How many there are.
    pub count: usize,
    /// Width and height of each in pixels.
    pub size: (usize, usize),
    /// Whether they are of several estimators, none of which is larger than another.
    pub is_lockstep: bool,
    /// Height of what stands above each, in points.
    pub header: f32,
    /// Height of the line below all of them, in points.
    pub line: f32,
}

/// The room of the strip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StripRoom {
    /// Whether it is read in the last row: rather shortened than small.
    pub is_presented: bool,
    /// The most height that it can have, in points.
    pub most: f32,
    /// Its type, in points.
    pub type_pt: f32,
    /// Whether its parts stand below each other.
    pub is_column: bool,
    /// Whether a chart has the place of the formula.
    pub is_sentence_alone: bool,
}

/// The page of a lesson.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LessonPage {
    /// Height with all of its words in the width that it had, in points.
    pub height: f32,
    /// Whether it was read, and the run goes on from where it began.
    pub is_read: bool,
}

/// The pane of a question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asking {
    /// Height of all of it in the width that it had, in points.
    pub height: f32,
    /// Whether it waits for its answer, which the explanation would give away.
    pub is_open: bool,
}

/// The room that there is, and what is to stand in it.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Between header and transport.
    pub body: Rect,
    /// Size of the whole window in points.
    pub window: Vec2,
    /// Size of the type in points.
    pub type_pt: f32,
    /// How much of the explanation is shown.
    pub mode: Mode,
    /// What is folded away.
    pub folded: Folded,
    /// The pictures on the stage.
    pub pictures: Pictures,
    /// How many charts the step has.
    pub charts: usize,
    /// Whether any step of the estimator has one.
    pub can_have_charts: bool,
    /// The page of a lesson, if one is open.
    pub page: Option<LessonPage>,
    /// The question about the next result, while results are asked about.
    pub question: Option<Asking>,
    /// Whether a chart takes the place of the stage.
    pub is_enlarged: bool,
    /// Whether the chart is seen where there is no room for both a formula and a chart.
    pub prefers_chart: bool,
    /// Height of the explanation down to the end of its formula, in points.
    pub told: f32,
    /// What the person has dragged.
    pub shares: Shares,
}

/// Where a border can be dragged, and which share it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// The line, with room for the pointer.
    pub rect: Rect,
    /// The share.
    pub of: Share,
    /// Change of the share for a point to the right, and for one down.
    pub per_pt: Vec2,
}

/// Where everything lies.
#[derive(Clone, Debug, Default)]
pub struct Arrangement {
    /// The pictures with the line below them, unless a chart has their place.
    pub stage: Option<Rect>,
    /// Each picture without its header.
    pub panes: Panes,
    /// Charts, one in each rectangle.
    pub charts: Vec<Rect>,
    /// The page of a lesson.
    pub page: Option<Rect>,
    /// The question.
    pub question: Option<Rect>,
    /// The explanation.
    pub told: Option<Rect>,
    /// Whether it is so low and wide that it has two columns.
    pub is_told_wide: bool,
    /// Whether formula and chart share one place, so that one of them is not seen.
    pub alternates: bool,
    /// Whether the window has no tabs, so that keys choose the chart.
    pub is_presented: bool,
    /// The room of sentence and formula, where they alone are told.
    pub strip: Option<StripRoom>,
    /// The parameters.
    pub parameters: Option<Rect>,
    /// Where rooms can be shared out otherwise.
    pub borders: Vec<Border>,
}

impl Arrangement {
    /// Whether the formula has the place of the charts, which its tabs show instead.
    pub fn has_tabs(&self) -> bool {
        self.alternates && self.charts.is_empty() && !self.is_presented
    }
}

/// Where the pictures lie.
#[derive(Clone, Debug, PartialEq)]
pub enum Panes {
    /// All alike.
    Alike(Vec<Rect>),
    /// One of them large, and places for the others in their order; beside them the room of a legend, if there is any.
    Large(Rect, Vec<Rect>, Option<Rect>),
}

impl Default for Panes {
    fn default() -> Self {
        Self::Alike(Vec::new())
    }
}

impl Panes {
    /// The places of pictures the one at `main` of which is the large one, if one is.
    pub fn of(&self, main: usize) -> Vec<Rect> {
        match self {
            Self::Alike(panes) => panes.clone(),
            Self::Large(large, small, _) => {
                let mut all = small.clone();
                all.insert(main.min(small.len()), *large);
                all
            }
        }
    }

    /// The room of a legend beside the small pictures.
    pub fn legend(&self) -> Option<Rect> {
        match self {
            Self::Large(.., legend) => *legend,
            Self::Alike(_) => None,
        }
    }

    /// Whether one of them is larger than the others.
    pub fn has_large(&self) -> bool {
        matches!(self, Self::Large(..))
    }
}

/// Letters across below which the parameters have no place beside pictures and words.
const DOCKED_LETTERS: f32 = 92.0;
/// Width of the parameters, in letters.
const PARAMETERS_LETTERS: f32 = 20.0;
/// Least width in which they can be read.
const LEAST_PARAMETERS: f32 = 16.0;
/// Width from which two charts are seen at once below the pictures, in points.
const TWO_CHARTS: f32 = 1600.0;
/// The least window that everything has room in, in letters across and lines down: a smaller one has smaller type.
const LEAST_LETTERS: Vec2 = vec2(56.0, 30.0);
/// The same without header.
const LEAST_EMBEDDED: Vec2 = vec2(45.5, 28.0);
/// The same without header and transport.
const LEAST_PRESENTED: Vec2 = vec2(45.5, 25.5);
/// The least window that is held upright: its bars have fewer buttons and the timeline a row of its own.
const LEAST_UPRIGHT: Vec2 = vec2(25.0, 44.0);
/// Letters across below which a window that is higher than wide is arranged as upright.
const UPRIGHT_LETTERS: f32 = 36.0;
/// Most of the body that the page of a lesson has above the pictures of an upright window.
const UPRIGHT_PAGE: f32 = 0.34;
/// The least shares of the window's area and height that pictures have there; the height does not count.
const UPRIGHT_LEAST: [f32; 2] = [0.15, f32::INFINITY];
/// Least height in which a chart can be read, and least width, in letters.
const CHART_LETTERS: [f32; 2] = [12.0, 15.0];
/// Least height of the page of a lesson in a column, in letters, and the most of the column: before it was read, and after.
const PAGE_LETTERS: f32 = 7.0;
/// Two pictures stay alike if each has at least this share of the area that one alone would have.
const ALIKE: f32 = 0.55;
/// Most of the body that words have by default, beside the pictures or below them.
const MOST_WORDS: f32 = 0.6;
/// How much wider than high a column is at most.
const COLUMN: f32 = 1.2;
/// Width of a low explanation from which it has two columns, in letters.
const WIDE_LETTERS: f32 = 40.0;
/// Height of the line with the titles of charts, in letters.
const TABS_LETTERS: f32 = 1.9;
/// Least height of a picture beside a large one, in letters.
const SMALL_LETTERS: f32 = 5.0;
/// Least width of a legend beside them, in letters.
const LEGEND_LETTERS: f32 = 9.0;
/// Between two pictures, and between those of several estimators.
const PICTURE_GAP: f32 = 4.0;
const LOCKSTEP_GAP: f32 = 12.0;
/// Around the pictures, in points.
pub const MARGIN: f32 = 2.0;
/// Between two panes.
const GAP: f32 = 1.0;
/// Half the width of a border for the pointer.
const GRIP: f32 = 3.0;

/// Letters across the window, and lines down, below which sentence and formula alone are told.
const WORKING_LETTERS: Vec2 = vec2(84.0, 42.0);

impl Mode {
    /// The mode of a window of `size` in points with type of `type_pt`.
    pub fn of(size: Vec2, type_pt: f32, is_lecture: bool) -> Self {
        let letters = size / type_pt.max(1.0);
        let is_small = letters.x < WORKING_LETTERS.x || letters.y < WORKING_LETTERS.y;
        if is_lecture || is_small { Mode::Lecture } else { Mode::Working }
    }

    /// Whether the sentence and the formula alone are told.
    pub fn is_lecture(self) -> bool {
        self != Self::Working
    }

    /// The type of sentence and formula in a theme whose usual type has `type_pt` points.
    pub fn told_pt(self, type_pt: f32) -> f32 {
        match self {
            Self::Working => type_pt,
            Self::Lecture | Self::Embedded => (1.17 * type_pt).round(),
            Self::Presenting => (1.28 * type_pt).round(),
        }
    }

    /// The most of the column's height that small pictures beside a large one take.
    fn small_share(self) -> f32 {
        if self == Self::Presenting { 0.16 } else { 0.2 }
    }

    /// The most of the column's height that the page of a lesson takes, before and after it was read.
    fn page_share(self, is_read: bool) -> f32 {
        match (self, is_read) {
            (_, true) => 0.36,
            (Self::Presenting, false) => 0.62,
            (_, false) => 0.5,
        }
    }

    /// How much larger the interface is, so that a sentence can be read in the last row.
    pub fn zoom(self) -> f32 {
        if self == Self::Presenting { 1.33 } else { 1.0 }
    }

    /// The least shares that the pictures have: of the window's area, or of its height.
    fn least(self, is_beside_page: bool, way: Way) -> [f32; 2] {
        match self {
            // With the smaller pictures beside it a large one has 40 %.
            _ if is_beside_page => [if way == Way::Large { 0.385 } else { 0.405 }, f32::INFINITY],
            Self::Presenting => [0.56, 0.71],
            _ => [0.46, 0.62],
        }
    }
}

/// Where the words stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Side {
    #[default]
    Beside,
    Below,
}

/// How several pictures share the stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Way {
    /// In so many columns.
    Grid(usize),
    /// One alone; the others stand in the region of the words.
    #[default]
    Large,
}

/// A way to share the body out.
#[derive(Clone, Copy, Debug, Default)]
struct Candidate {
    side: Side,
    way: Way,
    /// Width or height of the words.
    words: f32,
    /// Area of a picture, and of all of those in the stage.
    one: f32,
    all: f32,
    /// Whether the pictures have their share.
    has_share: bool,
}

impl Default for Pictures {
    fn default() -> Self {
        Self { count: 1, size: (4, 3), is_lockstep: false, header: 0.0, line: 0.0 }
    }
}

impl Pictures {
    fn gap(&self) -> f32 {
        if self.is_lockstep { LOCKSTEP_GAP } else { PICTURE_GAP }
    }

    /// Columns and rows.
    fn grid(&self, way: Way) -> [f32; 2] {
        match way {
            Way::Grid(columns) => [columns as f32, self.count.div_ceil(columns.max(1)).max(1) as f32],
            Way::Large => [1.0, 1.0],
        }
    }

    /// Width and height of the margins, headers and gaps of a stage.
    fn around(&self, way: Way) -> Vec2 {
        let [columns, rows] = self.grid(way);
        let gaps = self.gap() * vec2(columns - 1.0, rows - 1.0);
        gaps + vec2(0.0, rows * self.header + self.line) + 2.0 * Vec2::splat(MARGIN)
    }

    /// Size of each picture as it fits into a stage of `room`, in points.
    fn fit(&self, way: Way, room: Vec2) -> Vec2 {
        let [columns, rows] = self.grid(way);
        let size = vec2(self.size.0.max(1) as f32, self.size.1.max(1) as f32);
        let each = ((room - self.around(way)) / vec2(columns, rows)).max(Vec2::ZERO);
        size * (each / size).min_elem()
    }

    /// The stage that pictures of size `fit` fill.
    fn block(&self, way: Way, fit: Vec2) -> Vec2 {
        let [columns, rows] = self.grid(way);
        self.around(way) + fit * vec2(columns, rows)
    }

    /// The ways in which they can share the stage.
    fn ways(&self) -> Vec<Way> {
        match self.count {
            count if self.is_lockstep => (1..=count.max(1)).map(Way::Grid).collect(),
            0 | 1 => vec![Way::Grid(1)],
            2 => vec![Way::Grid(2), Way::Grid(1), Way::Large],
            _ => vec![Way::Large],
        }
    }

    /// The places of all pictures in `area`, shared out so that they are as large as they can be.
    pub fn split(&self, area: Rect) -> Vec<Rect> {
        let size = |way: &Way| self.fit(*way, area.size()).x;
        let ways = (1..=self.count.max(1)).rev().map(Way::Grid);
        let way = ways.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(Way::Grid(1));
        self.panes(way, area)
    }

    /// The places of the pictures in a stage.
    fn panes(&self, way: Way, stage: Rect) -> Vec<Rect> {
        let [columns, rows] = self.grid(way);
        let inside = stage.shrink(MARGIN).with_max_y(stage.max.y - MARGIN - self.line);
        let gaps = self.gap() * vec2(columns - 1.0, rows - 1.0);
        let cell = ((inside.size() - gaps) / vec2(columns, rows)).max(vec2(1.0, self.header + 1.0));
        let count = if way == Way::Large { 1 } else { self.count };
        let corner = |i: usize| vec2((i % columns as usize) as f32, (i / columns as usize) as f32);
        let pane = |i| {
            let at = inside.min + corner(i) * (cell + Vec2::splat(self.gap()));
            Rect::from_min_size(at + vec2(0.0, self.header), cell - vec2(0.0, self.header))
        };
        (0..count).map(pane).collect()
    }
}

impl Room {
    /// Whether the parameters have a place beside pictures and words.
    pub fn has_docked_parameters(&self) -> bool {
        self.mode == Mode::Working && self.window.x >= DOCKED_LETTERS * self.type_pt
    }

    /// The same room in another body.
    #[must_use]
    pub fn in_body(self, body: Rect) -> Self {
        Self { body, ..self }
    }

    fn is_upright(&self) -> bool {
        is_upright(self.window, self.type_pt)
    }

    fn told_pt(&self) -> f32 {
        self.mode.told_pt(self.type_pt)
    }

    fn is_told(&self) -> bool {
        self.mode.is_lecture() || !self.folded.explanation
    }

    /// Whether a step of the run may have a chart in sight.
    fn may_have_charts(&self) -> bool {
        self.can_have_charts && !self.folded.charts
    }

    fn has_charts(&self) -> bool {
        self.charts > 0 && !self.folded.charts
    }

    /// Least and usual width of the words beside the pictures, or height below them, in points; less where it is `tight`.
    fn words(&self, side: Side, tight: bool) -> [f32; 2] {
        let told = self.told_pt();
        match (side, self.mode) {
            (Side::Below, _) if self.is_upright() => [if tight { 8.0 } else { 11.0 } * told, 15.0 * told],
            (Side::Beside, _) if tight => [12.0 * told, 18.0 * told],
            (Side::Below, _) if tight => [4.5 * told, 11.0 * told],
            (Side::Beside, Mode::Working) => [19.0 * told, 26.0 * told],
            (Side::Beside, _) if self.page.is_some() => [14.0 * told, 18.0 * told],
            (Side::Beside, _) => [15.0 * told, 18.0 * told],
            (Side::Below, Mode::Working) => [CHART_LETTERS[0] * self.type_pt, 15.0 * self.type_pt],
            (Side::Below, _) if self.page.is_some() => [6.5 * told, 11.0 * told],
            (Side::Below, _) if self.may_have_charts() => [8.5 * told, 11.0 * told],
            (Side::Below, _) => [6.0 * told, 7.5 * told],
        }
    }

    /// Gives everything its place.
    pub fn arrange(&self) -> Arrangement {
        let mut all = Arrangement { is_presented: self.mode == Mode::Presenting, ..Arrangement::default() };
        let mut body = self.body;
        if !self.folded.parameters && self.has_docked_parameters() {
            body = self.dock(body, &mut all);
        }
        if self.is_enlarged && self.has_charts() {
            self.enlarge(body, &mut all);
        } else {
            self.share(body, &mut all);
        }
        all
    }

    /// Gives the parameters a column at the left.
    fn dock(&self, body: Rect, all: &mut Arrangement) -> Rect {
        let usual = PARAMETERS_LETTERS * self.type_pt;
        let width = (usual * self.shares.parameters).min(0.45 * body.width());
        let (left, right) = split_x(body, width);
        all.parameters = Some(left);
        let per_pt = vec2(1.0 / usual, 0.0);
        all.borders.push(Border { rect: grip(right.min.x, left.y_range()), of: Share::Parameters, per_pt });
        right
    }

    /// A chart has the place of the pictures.
    fn enlarge(&self, body: Rect, all: &mut Arrangement) {
        let hidden = Room { charts: 0, ..*self };
        if !self.is_told() && self.page.is_none() && self.question.is_none() {
            let rest = if self.folded.parameters || all.parameters.is_some() { body } else { self.dock(body, all) };
            all.charts = vec![rest];
            return;
        }
        let is_wide = body.width() > body.height();
        let [_, usual] = self.words(if is_wide { Side::Beside } else { Side::Below }, false);
        let (rest, words) = match is_wide {
            true => split_x(body, body.width() - usual.min(0.45 * body.width()) - GAP),
            false => split_y(body, body.height() - usual.min(0.45 * body.height()) - GAP),
        };
        hidden.tell(words, if is_wide { Side::Beside } else { Side::Below }, all);
        all.charts = vec![rest];
        self.cover(words, all);
    }

    /// Shares `body` out among pictures and words.
    fn share(&self, body: Rect, all: &mut Arrangement) {
        if !self.is_told() && self.page.is_none() && self.question.is_none() && !self.may_have_charts() {
            let rest = if self.folded.parameters || all.parameters.is_some() { body } else { self.dock(body, all) };
            all.stage = Some(rest);
            all.panes = Panes::Alike(self.pictures.split(rest));
            return;
        }
        let has_words = self.folded.parameters || all.parameters.is_some();
        if self.is_upright() && !has_words && (self.page.is_some() || self.question.is_some()) {
            // The parameters stand below the pictures, in place of all words.
            return Room { page: None, question: None, ..*self }.share(body, all);
        }
        if let Some(LessonPage { height, .. }) = self.page.filter(|_| self.is_upright()) {
            // Read first, then seen, within reach of the thumb.
            let least = PAGE_LETTERS * self.type_pt;
            let (page, rest) = split_y(body, within(height, least, UPRIGHT_PAGE * body.height()));
            all.page = Some(page);
            return Room { page: None, ..*self }.share(rest, all);
        }
        let Candidate { side, way, words: usual_words, .. } = self.best(body);
        let extent = if side == Side::Beside { body.width() } else { body.height() };
        let words = within(usual_words * self.shares.column, 0.2 * extent, 0.75 * extent);
        let words = if self.shares.column == 1.0 { usual_words } else { words.round() };
        let is_narrow = side == Side::Below || usual_words * self.shares.column < LEAST_PARAMETERS * self.type_pt;
        if is_narrow && !self.is_upright() && !self.folded.parameters && all.parameters.is_none() {
            // The stage gives way to them: they never lie over a picture.
            let rest = self.dock(body, all);
            return self.share(rest, all);
        }
        let (stage, region, per_pt) = match side {
            Side::Beside => {
                let (stage, region) = split_x(body, body.width() - words - GAP);
                (stage, region, vec2(-1.0, 0.0))
            }
            Side::Below => {
                let (stage, region) = split_y(body, body.height() - words - GAP);
                (stage, region, vec2(0.0, -1.0))
            }
        };
        let rect = match side {
            Side::Beside => grip(region.min.x, region.y_range()),
            Side::Below => level_grip(region.min.y, region.x_range()),
        };
        all.borders.push(Border { rect, of: Share::Column, per_pt: per_pt / usual_words.max(1.0) });
        all.stage = Some(stage);
        let panes = self.pictures.panes(way, stage);
        let rest = match (way, panes.first()) {
            (Way::Large, Some(large)) => {
                let (small, legend, rest) = self.small_pictures(region, side);
                all.panes = Panes::Large(*large, small, legend);
                rest
            }
            _ => {
                all.panes = Panes::Alike(panes);
                region
            }
        };
        self.tell(rest, side, all);
        self.cover(rest, all);
    }

    /// The parameters come over the words where they have no place of their own.
    fn cover(&self, words: Rect, all: &mut Arrangement) {
        if self.folded.parameters || all.parameters.is_some() {
            return;
        }
        all.parameters = Some(words);
        (all.page, all.told, all.question) = (None, None, None);
        all.charts.retain(|chart| !words.contains_rect(*chart));
        all.borders.retain(|border| border.of == Share::Column);
    }

    /// The best way to share out the body; with less room for the words only where the pictures have their share in no other.
    fn best(&self, body: Rect) -> Candidate {
        let roomy = self.best_of(body, false);
        if roomy.has_share { roomy } else { self.best_of(body, true) }
    }

    fn best_of(&self, body: Rect, tight: bool) -> Candidate {
        let mut ways = self.pictures.ways();
        if self.is_upright() && ways.len() > 1 {
            // There the words have no room for a small picture.
            ways.retain(|way| *way != Way::Large);
        }
        let sides = [Side::Beside, Side::Below];
        let all: Vec<Candidate> =
            ways.iter().flat_map(|way| sides.map(|side| self.candidate(body, (side, tight), *way))).collect();
        let better = |a: &&Candidate, b: &&Candidate| a.has_share.cmp(&b.has_share).then(a.all.total_cmp(&b.all));
        let of = |is_large: bool| all.iter().filter(move |one| (one.way == Way::Large) == is_large).max_by(better);
        match (of(false), of(true)) {
            (Some(alike), Some(large)) if large.has_share && (!alike.has_share || alike.one < ALIKE * large.one) => {
                *large
            }
            (alike, large) => alike.or(large).copied().unwrap_or_default(),
        }
    }

    /// The words as large as they are by default, or as little less as the pictures need for their share; what the pictures cannot fill goes
    /// to the words.
    fn candidate(&self, body: Rect, (side, tight): (Side, bool), way: Way) -> Candidate {
        let [least, usual] = self.words(side, tight);
        let extent = if side == Side::Beside { body.width() } else { body.height() };
        let (least, usual) = (least.min(0.45 * extent), usual.min(0.7 * extent));
        let stage = |words: f32| match side {
            Side::Beside => vec2(body.width() - words - GAP, body.height()),
            Side::Below => vec2(body.width(), body.height() - words - GAP),
        };
        let [area, height] = match self.is_upright() {
            true => UPRIGHT_LEAST,
            false => self.mode.least(self.page.is_some(), way),
        };
        let whole = self.window.x * self.window.y;
        let pictures = &self.pictures;
        let has_share = |words: f32| {
            let fit = pictures.fit(way, stage(words));
            let [columns, rows] = pictures.grid(way);
            fit.x * fit.y * columns * rows >= area * whole || rows * fit.y >= height * self.window.y
        };
        const TRIES: usize = 12;
        let tried = (0..=TRIES).map(|i| usual + (least - usual) * i as f32 / TRIES as f32);
        let words = tried.clone().find(|words| has_share(*words)).unwrap_or(least.min(usual));
        let fit = pictures.fit(way, stage(words));
        let block = pictures.block(way, fit);
        let filled = if side == Side::Beside { block.x } else { block.y };
        let left = (extent - filled - GAP).min(MOST_WORDS * extent);
        let words = words.max(left).round();
        let fit = pictures.fit(way, stage(words));
        let [columns, rows] = pictures.grid(way);
        let one = fit.x * fit.y;
        Candidate { side, way, words, one, all: one * columns * rows, has_share: has_share(words) }
    }

    /// The places of the pictures that are not the large one, of a legend beside them, and what is left of the words' region.
    fn small_pictures(&self, region: Rect, side: Side) -> (Vec<Rect>, Option<Rect>, Rect) {
        let Pictures { count, size, header, .. } = self.pictures;
        let count = count.saturating_sub(1).max(1) as f32;
        let aspect = size.0.max(1) as f32 / size.1.max(1) as f32;
        let inside = region.shrink(MARGIN);
        let least = SMALL_LETTERS * self.type_pt;
        let across = (inside.width() - (count - 1.0) * PICTURE_GAP) / count;
        let height = match side {
            Side::Beside => (self.mode.small_share() * inside.height()).max(least).min(across / aspect),
            Side::Below => (inside.height() - header).min(0.4 * across / aspect),
        };
        let each = vec2(height * aspect, height);
        let at = |i: usize| inside.min + vec2(i as f32 * (each.x + PICTURE_GAP), header);
        let small = (0..count as usize).map(|i| Rect::from_min_size(at(i), each)).collect();
        let rest = match side {
            Side::Beside => region.with_min_y(inside.min.y + header + height + MARGIN),
            Side::Below => region.with_min_x(inside.min.x + count * (each.x + PICTURE_GAP) + MARGIN),
        };
        let end = inside.min + vec2(count * (each.x + PICTURE_GAP) + 2.0 * MARGIN, header);
        let legend = Rect::from_min_max(end, pos2(inside.max.x, end.y + height));
        let has_legend = side == Side::Beside && legend.width() >= LEGEND_LETTERS * self.type_pt;
        (small, has_legend.then_some(legend), rest)
    }

    /// Shares the region of the words out among the page, what is told, and the charts.
    fn tell(&self, region: Rect, side: Side, all: &mut Arrangement) {
        // A region that is about as high as it is wide is a column, wherever it lies.
        let side = if region.width() < COLUMN * region.height() { Side::Beside } else { side };
        let rest = match self.page {
            Some(LessonPage { height, is_read }) if self.is_told() || self.has_charts() => {
                let (page, rest) = match side {
                    Side::Beside => {
                        let most = self.mode.page_share(is_read) * region.height();
                        split_y(region, within(height, (PAGE_LETTERS * self.type_pt).min(most), most))
                    }
                    Side::Below => split_x(region, 0.36 * region.width()),
                };
                all.page = Some(page);
                rest
            }
            Some(_) if self.question.is_none() => {
                all.page = Some(region);
                return;
            }
            Some(_) => {
                let (page, rest) = split_y(region, 0.6 * region.height());
                all.page = Some(page);
                rest
            }
            None => region,
        };
        let rest = match self.question {
            // The chart would suggest an answer as well.
            Some(Asking { is_open: true, .. }) => {
                all.question = Some(rest);
                return;
            }
            Some(Asking { height, .. }) => {
                let (rest, question) = split_y(rest, rest.height() - height.min(0.5 * rest.height()) - GAP);
                all.question = Some(question);
                rest
            }
            None => rest,
        };
        match (self.is_told(), self.has_charts()) {
            (true, false) => self.tell_in(rest, (side, rest.height()), all),
            (false, _) => all.charts = columns(rest, self.columns(side)),
            (true, true) => self.tell_and_plot(rest, side, all),
        }
    }

    /// How many charts are seen at once.
    fn columns(&self, side: Side) -> usize {
        let most = if side == Side::Below && self.window.x >= TWO_CHARTS && self.mode == Mode::Working { 2 } else { 1 };
        self.charts.min(most)
    }

    fn tell_and_plot(&self, rest: Rect, side: Side, all: &mut Arrangement) {
        let [chart_height, chart_width] = CHART_LETTERS.map(|letters| letters * self.type_pt);
        let told_least = match side {
            Side::Beside => 9.0 * self.told_pt(),
            Side::Below => 24.0 * self.told_pt(),
        };
        let (extent, chart_least) = match side {
            Side::Beside => (rest.height(), chart_height),
            Side::Below => (rest.width(), chart_width),
        };
        let has_room = extent >= told_least + chart_least;
        // Beside the words of a lesson or a question no formula is cut off by a chart: they take turns.
        let is_shared = self.page.is_some() || self.question.is_some();
        let has_both = has_room
            && match side {
                Side::Beside => !is_shared || extent >= self.told + chart_least + GAP,
                Side::Below => rest.height() >= 0.9 * chart_height,
            };
        all.alternates = !has_both;
        if !has_both && !self.prefers_chart {
            return self.tell_in(rest, (side, rest.height()), all);
        }
        let usual = match (side, has_both) {
            // The formula is seen without scrolling, as long as the chart stays legible.
            (Side::Beside, true) => within(extent - self.told - GAP, chart_least, 0.56 * extent),
            (Side::Beside, false) => 0.6 * extent,
            (Side::Below, _) if self.is_upright() => 0.58 * extent,
            (Side::Below, _) => {
                0.42 * extent * self.columns(side) as f32 / if self.columns(side) > 1 { 1.6 } else { 1.0 }
            }
        };
        let most = if has_both { extent - told_least } else { 0.75 * extent };
        let chart = within(usual * self.shares.charts, 0.8 * chart_least, most.min(0.75 * extent)).min(0.7 * extent);
        let (told, charts, border) = match side {
            Side::Beside => {
                let (told, charts) = split_y(rest, extent - chart - GAP);
                (told, charts, level_grip(charts.min.y, charts.x_range()))
            }
            Side::Below => {
                let (told, charts) = split_x(rest, extent - chart - GAP);
                (told, charts, grip(charts.min.x, charts.y_range()))
            }
        };
        let usual = usual.max(1.0);
        let per_pt = if side == Side::Beside { vec2(0.0, -1.0 / usual) } else { vec2(-1.0 / usual, 0.0) };
        all.borders.push(Border { rect: border, of: Share::Charts, per_pt });
        let most =
            if has_both && side == Side::Beside { (extent - chart_least).max(told.height()) } else { told.height() };
        self.tell_in(told, (side, most), all);
        all.charts = columns(charts, self.columns(side));
    }

    /// Gives the explanation its place, in which sentence and formula have at most `most` points of height.
    fn tell_in(&self, told: Rect, (side, most): (Side, f32), all: &mut Arrangement) {
        all.told = Some(told);
        all.is_told_wide = side == Side::Below && told.width() > WIDE_LETTERS * self.type_pt;
        let is_sentence_alone = all.alternates && self.prefers_chart;
        let has_tabs = all.alternates && !self.prefers_chart && !all.is_presented;
        let most = if has_tabs { most - TABS_LETTERS * self.type_pt } else { most };
        all.strip = (self.mode.is_lecture() && self.folded.explanation).then(|| StripRoom {
            most,
            type_pt: self.told_pt(),
            is_column: side == Side::Beside || told.width() < 28.0 * self.told_pt(),
            is_sentence_alone,
            is_presented: self.mode == Mode::Presenting,
        });
    }
}

/// `rect` without a row of `height` at its bottom, and the row.
pub fn with_row(rect: Rect, height: f32) -> (Rect, Rect) {
    split_y(rect, rect.height() - height - GAP)
}

/// The interface scale that `wanted` is cut down to in a window of `size` in points at scale 1, so that everything has room
/// with type of `type_pt`.
pub fn zoom_that_fits(wanted: f32, size: Vec2, type_pt: f32, mode: Mode) -> f32 {
    let all: &[Vec2] = match mode {
        Mode::Working | Mode::Lecture => &[LEAST_LETTERS, LEAST_UPRIGHT],
        Mode::Embedded => &[LEAST_EMBEDDED, LEAST_UPRIGHT],
        Mode::Presenting => &[LEAST_PRESENTED],
    };
    let most = all.iter().map(|least| (size / (*least * type_pt)).min_elem()).fold(f32::NAN, f32::max);
    // Hundredths, so that nothing flickers while the window is dragged.
    let most = (most * 100.0).floor() / 100.0;
    if most.is_finite() { wanted.min(most.max(0.2)) } else { wanted }
}

/// Whether a window of `size` with type of `type_pt` is upright and narrow, as on a phone.
pub fn is_upright(size: Vec2, type_pt: f32) -> bool {
    size.y > size.x && size.x < UPRIGHT_LETTERS * type_pt
}

/// `value` between `least` and `most`; `least` where there is not even room for that.
fn within(value: f32, least: f32, most: f32) -> f32 {
    value.min(most).max(least)
}

fn grip(x: f32, y: eframe::egui::Rangef) -> Rect {
    Rect::from_x_y_ranges(x - GRIP..=x + GRIP, y)
}

fn level_grip(y: f32, x: eframe::egui::Rangef) -> Rect {
    Rect::from_x_y_ranges(x, y - GRIP..=y + GRIP)
}

fn split_x(rect: Rect, width: f32) -> (Rect, Rect) {
    let at = (rect.min.x + width).round();
    (rect.with_max_x(at), rect.with_min_x(at + GAP))
}

fn split_y(rect: Rect, height: f32) -> (Rect, Rect) {
    let at = (rect.min.y + height).round();
    (rect.with_max_y(at), rect.with_min_y(at + GAP))
}

/// Equal parts beside each other.
fn columns(rect: Rect, count: usize) -> Vec<Rect> {
    let width = (rect.width() + GAP) / count.max(1) as f32;
    let one = |i: usize| {
        let left = (rect.min.x + i as f32 * width).round();
        let right = if i + 1 == count { rect.max.x } else { (rect.min.x + (i + 1) as f32 * width).round() - GAP };
        Rect::from_x_y_ranges(left..=right, rect.y_range())
    };
    (0..count).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room(size: Vec2, type_pt: f32, mode: Mode) -> Room {
        let body = match mode {
            Mode::Presenting => Rect::from_min_size(pos2(0.0, 0.0), size),
            _ => Rect::from_min_max(pos2(0.0, 2.2 * type_pt), pos2(size.x, size.y - 3.4 * type_pt)),
        };
        let pictures = Pictures { header: 1.4 * type_pt, line: 1.9 * type_pt, size: (320, 240), ..Pictures::default() };
        Room {
            body,
            window: size,
            type_pt,
            mode,
            folded: Folded { parameters: true, explanation: mode.is_lecture(), charts: false },
            pictures,
            charts: 2,
            can_have_charts: true,
            page: None,
            question: None,
            is_enlarged: false,
            prefers_chart: false,
            told: 9.0 * type_pt,
            shares: Shares::default(),
        }
    }

    const SIZES: [[f32; 2]; 4] = [[1024.0, 768.0], [1280.0, 720.0], [1920.0, 1080.0], [500.0, 900.0]];

    fn all_rooms() -> Vec<Room> {
        let page = Some(LessonPage { height: 300.0, is_read: false });
        let question = |is_open| Some(Asking { height: 80.0, is_open });
        let mut all = Vec::new();
        for size in SIZES.map(Vec2::from) {
            for (type_pt, mode) in [(14.0, Mode::Working), (21.0, Mode::Lecture), (17.0, Mode::Presenting)] {
                for (count, is_lockstep) in [(1, false), (2, false), (3, false), (3, true)] {
                    for (page, question) in
                        [(None, None), (page, None), (None, question(true)), (page, question(false))]
                    {
                        for fold in 0..32 {
                            let is = |bit: usize| fold & bit > 0;
                            let of = room(size, type_pt, mode);
                            let folded = Folded { parameters: is(1), explanation: is(2), charts: is(4) };
                            let pictures = Pictures { count, is_lockstep, ..of.pictures };
                            let (is_enlarged, prefers_chart) = (is(8), is(16));
                            all.push(Room { folded, pictures, page, question, is_enlarged, prefers_chart, ..of });
                        }
                    }
                }
            }
        }
        all
    }

    #[test]
    fn nothing_lies_over_anything_and_something_is_seen() {
        for room in all_rooms() {
            let all = room.arrange();
            let small = if let Panes::Large(_, small, _) = &all.panes { small.clone() } else { Vec::new() };
            let single = [all.stage, all.page, all.told, all.question, all.parameters];
            let panes: Vec<Rect> =
                single.into_iter().flatten().chain(all.charts.iter().copied()).chain(small).collect();
            assert!(all.stage.is_some() || !all.charts.is_empty(), "{room:?}");
            assert!(room.folded.parameters || all.parameters.is_some(), "{room:?}");
            for (i, pane) in panes.iter().enumerate() {
                assert!(room.body.expand(0.5).contains_rect(*pane), "{pane:?} leaves {room:?}");
                assert!(pane.is_positive(), "{pane:?} of {all:?} in {room:?}");
                let over = panes[..i].iter().find(|other| other.shrink(0.5).intersects(pane.shrink(0.5)));
                assert_eq!(over, None, "{pane:?} of {all:?} in {room:?}");
            }
            let pictures = all.panes.of(0);
            if let Some(stage) = all.stage {
                let inside = |pane: &Rect| stage.contains_rect(*pane) || panes.contains(pane);
                assert_eq!(pictures.len(), room.pictures.count, "{room:?}");
                assert!(pictures.iter().all(inside), "{pictures:?} in {room:?}");
            }
        }
    }

    #[test]
    fn the_large_picture_has_its_place_among_the_others() {
        let rect = |x: f32| Rect::from_min_size(pos2(x, 0.0), vec2(1.0, 1.0));
        let panes = Panes::Large(rect(0.0), vec![rect(1.0), rect(2.0)], None);
        assert_eq!(panes.of(1), [rect(1.0), rect(0.0), rect(2.0)]);
        assert_eq!(panes.of(9), [rect(1.0), rect(2.0), rect(0.0)], "a picture that is not there");
    }

    #[test]
    fn the_stage_stays_however_much_a_step_tells() {
        for size in SIZES.map(Vec2::from) {
            for mode in [Mode::Working, Mode::Lecture, Mode::Presenting] {
                let stage = |told: f32, charts| Room { told, charts, ..room(size, 16.0, mode) }.arrange().stage;
                assert_eq!(stage(0.0, 2), stage(900.0, 0), "{size:?}, {mode:?}");
            }
        }
    }

    #[test]
    fn small_windows_have_smaller_type() {
        let zoom = |size: Vec2, type_pt| zoom_that_fits(1.0, size, type_pt, Mode::Lecture);
        assert_eq!(zoom(vec2(1280.0, 720.0), 21.0), 1.0);
        assert!((0.2..0.4).contains(&zoom(vec2(213.0, 160.0), 14.0)));
        assert_eq!(zoom_that_fits(1.33, vec2(1280.0, 720.0), 21.0, Mode::Presenting), 1.33);
    }

    #[test]
    fn dragging_a_border_makes_room_where_it_leads() {
        let before = Room { folded: Folded::default(), ..room(vec2(1920.0, 1080.0), 14.0, Mode::Working) };
        let arranged = before.arrange();
        assert_eq!(arranged.borders.len(), 3);
        for (i, border) in arranged.borders.iter().enumerate() {
            let mut shares = before.shares;
            *shares.of(border.of) += border.per_pt.x * 40.0 + border.per_pt.y * 40.0;
            let after = Room { shares, ..before }.arrange();
            let moved = after.borders[i].rect.min - border.rect.min;
            assert!((moved.max_elem() - 40.0).abs() < 8.0, "{border:?} moves by {moved:?}");
        }
    }
}
