//! Where the panes lie, worked out anew in each frame from the size of the window, its type and what there is to show.
//!
//! In the working layout the stage stands in the middle, with the explanation right of it and the charts below it or below the
//! explanation, whichever leaves them room. In a lecture hall, and wherever the window is small for its type, stage and chart
//! stand beside each other over a strip with the sentence and its formula; everything else comes as a drawer over the edge.

use eframe::egui::{Rect, Vec2, pos2, vec2};
use serde::{Deserialize, Serialize};

use super::explanation::StripRoom;

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
    /// The explanation; in a lecture, the drawer with all of it.
    pub explanation: bool,
    /// The charts.
    pub charts: bool,
}

/// How the panes are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// All panes beside each other.
    Working,
    /// Stage and chart over a strip, the rest in drawers.
    Lecture,
}

/// Shares of the room that the person drags.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Shares {
    /// Width of the column with the explanation, of what it has by default.
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

/// The room that there is, and what is to stand in it.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Between header and transport.
    pub body: Rect,
    /// Size of the whole window in points.
    pub window: Vec2,
    /// Size of the type in points.
    pub type_pt: f32,
    /// How the panes are arranged.
    pub mode: Mode,
    /// What is folded away.
    pub folded: Folded,
    /// How many charts the step has.
    pub charts: usize,
    /// How many estimators share the stage.
    pub tiles: usize,
    /// Whether the page of a lesson stands beside the panes.
    pub is_beside_page: bool,
    /// Whether a chart takes the place of the stage.
    pub is_enlarged: bool,
    /// The most height that the strip has needed so far, in points.
    pub strip: f32,
    /// Height of the explanation down to the end of its formula, in points.
    pub explanation: f32,
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
    /// The pictures, unless a chart has their place.
    pub stage: Option<Rect>,
    /// Charts, one in each rectangle.
    pub charts: Vec<Rect>,
    /// All of the explanation.
    pub explanation: Option<Rect>,
    /// Sentence and formula alone.
    pub strip: Option<Rect>,
    /// What is kept for the strip, whatever the step tells.
    pub strip_room: StripRoom,
    /// The parameters.
    pub parameters: Option<Rect>,
    /// Panes that lie over others, at the edge.
    pub drawers: Vec<Rect>,
    /// Where rooms can be shared out otherwise.
    pub borders: Vec<Border>,
}

/// Letters across the window, and lines down, below which its panes do not fit beside each other.
const WORKING_LETTERS: Vec2 = vec2(84.0, 42.0);
/// Letters across below which the parameters are a drawer.
const DOCKED_LETTERS: f32 = 100.0;
/// Lines down from which charts stand below the stage.
const BELOW_LINES: f32 = 88.0;
/// Width from which two charts are seen at once, in points.
const TWO_CHARTS: f32 = 1600.0;
/// The least window that everything has room in, in letters across and lines down: a smaller one has smaller type.
pub const LEAST_LETTERS: Vec2 = vec2(56.0, 30.0);
/// Share of the window's height that stage and chart have in a lecture at least, unless the window is very low.
const LECTURE_SHARE: f32 = 0.552;
/// Height that is kept for the strip, in sizes of its type: five lines. It is never less than this share of the body.
const STRIP_LETTERS: f32 = 7.2;
const STRIP_SHARE: f32 = 0.22;
/// Share of the stage's height that the strip may take over what is kept for it, where its longest text is not whole otherwise:
/// two lines, and little enough that the pictures stay about where they are.
const STRIP_GROWTH: f32 = 0.1;
/// How much wider than high the body is at least where the strip stands beside an enlarged chart, and the strip's share of the
/// width there: the chart keeps its share of the window.
const WIDE: f32 = 1.4;
const STRIP_COLUMN: f32 = 0.32;
/// Share of the chart beside the stage, and where this many estimators share the stage.
const CHART_SHARE: f32 = 0.42;
const CHART_BESIDE_TILES: f32 = 0.3;
/// The same where the page of a lesson leaves both less room: a chart that is half as large cannot be read.
const CHART_BESIDE_PAGE: f32 = 0.5;
const MANY_TILES: usize = 3;
/// Between two panes.
const GAP: f32 = 1.0;
/// Half the width of a border for the pointer.
const GRIP: f32 = 3.0;

impl Mode {
    /// How the panes of a window of `size` lie, in points, with type of `type_pt`.
    pub fn of(size: Vec2, type_pt: f32, is_lecture: bool) -> Self {
        let letters = size / type_pt.max(1.0);
        let is_small = letters.x < WORKING_LETTERS.x || letters.y < WORKING_LETTERS.y;
        if is_lecture || is_small { Mode::Lecture } else { Mode::Working }
    }
}

impl Room {
    /// Whether the parameters have a place beside the stage, and do not lie over it.
    pub fn has_docked_parameters(&self) -> bool {
        self.mode == Mode::Working && self.window.x >= DOCKED_LETTERS * self.type_pt
    }

    /// How many charts are seen at once.
    fn columns(&self) -> usize {
        let most = if self.window.x >= TWO_CHARTS && self.is_below() { 2 } else { 1 };
        if self.folded.charts { 0 } else { self.charts.min(most) }
    }

    /// Whether charts stand below the stage.
    fn is_below(&self) -> bool {
        self.mode == Mode::Working && self.body.height() >= BELOW_LINES * self.type_pt
    }

    /// Gives everything its place.
    pub fn arrange(&self) -> Arrangement {
        match self.mode {
            Mode::Working => self.working(),
            Mode::Lecture => self.lecture(),
        }
    }

    fn working(&self) -> Arrangement {
        let mut all = Arrangement::default();
        let mut rest = self.body;
        if !self.folded.parameters && self.has_docked_parameters() {
            let width = (20.0 * self.type_pt * self.shares.parameters).min(0.25 * rest.width());
            let (left, right) = split_x(rest, width);
            all.parameters = Some(left);
            all.borders.push(Border {
                rect: grip(right.min.x, left.y_range()),
                of: Share::Parameters,
                per_pt: vec2(1.0 / (20.0 * self.type_pt), 0.0),
            });
            rest = right;
        }
        let has_charts = self.columns() > 0;
        let is_below = self.is_below();
        if !self.folded.explanation || has_charts && !is_below {
            let usual = within(0.26 * self.window.x, 23.0 * self.type_pt, 36.0 * self.type_pt);
            let width = within(usual * self.shares.column, 18.0 * self.type_pt, 0.45 * self.window.x);
            let (left, right) = split_x(rest, rest.width() - width - GAP);
            all.borders.push(Border {
                rect: grip(right.min.x, right.y_range()),
                of: Share::Column,
                per_pt: vec2(-1.0 / usual, 0.0),
            });
            rest = left;
            self.column(right, has_charts && !is_below, &mut all);
        }
        if has_charts && is_below {
            let usual = (0.28 * rest.height()).max(15.0 * self.type_pt);
            let height = within(usual * self.shares.charts, 12.0 * self.type_pt, 0.6 * rest.height());
            let (upper, lower) = split_y(rest, rest.height() - height - GAP);
            all.borders.push(Border {
                rect: Rect::from_x_y_ranges(lower.x_range(), lower.min.y - GRIP..=lower.min.y + GRIP),
                of: Share::Charts,
                per_pt: vec2(0.0, -1.0 / usual),
            });
            rest = upper;
            all.charts = columns(lower, self.columns());
        }
        if !self.folded.parameters && !self.has_docked_parameters() {
            self.drawer(Drawer::Parameters, &mut all);
        }
        self.stage(rest, &mut all);
        all
    }

    /// Explanation and chart above each other.
    fn column(&self, column: Rect, has_chart: bool, all: &mut Arrangement) {
        match (self.folded.explanation, has_chart) {
            (true, _) => all.charts = vec![column],
            (false, false) => all.explanation = Some(column),
            (false, true) => {
                // The formula is seen without scrolling, as long as the chart stays legible.
                let left = column.height() - self.explanation;
                let usual = within(left, 0.34 * column.height(), 0.48 * column.height());
                let height = within(usual * self.shares.charts, 0.25 * column.height(), 0.7 * column.height());
                let (upper, lower) = split_y(column, column.height() - height - GAP);
                all.explanation = Some(upper);
                all.charts = vec![lower];
                all.borders.push(Border {
                    rect: Rect::from_x_y_ranges(lower.x_range(), lower.min.y - GRIP..=lower.min.y + GRIP),
                    of: Share::Charts,
                    per_pt: vec2(0.0, -1.0 / usual),
                });
            }
        }
    }

    fn lecture(&self) -> Arrangement {
        let mut all = Arrangement::default();
        let mut rest = self.with_strip(&mut all);
        if self.columns() > 0 {
            let is_tall = rest.height() > 0.9 * rest.width();
            let extent = if is_tall { rest.height() } else { rest.width() };
            let share = match () {
                () if self.tiles >= MANY_TILES => CHART_BESIDE_TILES,
                () if self.is_beside_page => CHART_BESIDE_PAGE,
                () => CHART_SHARE,
            };
            let usual = share * extent;
            let length = within(usual * self.shares.charts, 0.25 * extent, 0.6 * extent);
            let (first, second) = if is_tall {
                split_y(rest, rest.height() - length - GAP)
            } else {
                split_x(rest, rest.width() - length - GAP)
            };
            let (rect, per_pt) = match is_tall {
                true => (
                    Rect::from_x_y_ranges(second.x_range(), second.min.y - GRIP..=second.min.y + GRIP),
                    vec2(0.0, -1.0 / usual),
                ),
                false => (grip(second.min.x, second.y_range()), vec2(-1.0 / usual, 0.0)),
            };
            all.borders.push(Border { rect, of: Share::Charts, per_pt });
            all.charts = vec![second];
            rest = first;
        }
        if !self.folded.parameters {
            self.drawer(Drawer::Parameters, &mut all);
        }
        if !self.folded.explanation {
            self.drawer(Drawer::Explanation, &mut all);
        }
        self.stage(rest, &mut all);
        all
    }

    /// Gives the strip its place, and returns the rest: beside a chart that takes the place of the stage, because most charts are
    /// about as high as they are wide, and else below stage and chart.
    fn with_strip(&self, all: &mut Arrangement) -> Rect {
        let is_wide = self.body.width() > WIDE * self.body.height();
        if self.is_enlarged && self.columns() > 0 && is_wide {
            let (rest, strip) = split_x(self.body, (1.0 - STRIP_COLUMN) * self.body.width());
            all.strip = Some(strip);
            all.strip_room = StripRoom { kept: strip.height(), is_column: true };
            return rest;
        }
        let [kept, most] = self.strip_heights();
        let (rest, strip) = split_y(self.body, self.body.height() - within(self.strip, kept, most) - GAP);
        all.strip = Some(strip);
        all.strip_room = StripRoom { kept, is_column: false };
        rest
    }

    /// Height that is kept for the strip, and the most that it may have: they follow from the window and not from the step, so
    /// that the stage stays as it is from step to step.
    fn strip_heights(&self) -> [f32; 2] {
        let height = self.body.height();
        // Stage and chart keep their share of the window.
        let most = (height - LECTURE_SHARE * self.window.y - GAP).min(0.36 * height).max(0.3 * height).floor();
        let kept = (STRIP_LETTERS * self.type_pt).max(STRIP_SHARE * height).min(most).floor();
        [kept, (kept + STRIP_GROWTH * (height - kept)).min(most).floor()]
    }

    /// Gives the rest to the stage, or to the chart that takes its place.
    fn stage(&self, rest: Rect, all: &mut Arrangement) {
        if self.is_enlarged && !all.charts.is_empty() {
            // What the charts had is the stage's place as well: the chart has both.
            let first = all.charts[0];
            let is_beside = self.mode == Mode::Lecture || self.is_below();
            let whole = all.charts.iter().fold(rest, |sum, rect| sum.union(*rect));
            all.charts = vec![if is_beside || all.explanation.is_none() { whole } else { rest }];
            if !is_beside && let Some(explanation) = &mut all.explanation {
                *explanation = explanation.union(first);
            }
            // The border of the place that the charts have left goes with it.
            all.borders
                .retain(|border| border.of != Share::Charts && !all.charts[0].contains_rect(border.rect.shrink(GRIP)));
        } else {
            all.stage = Some(rest);
        }
    }

    fn drawer(&self, drawer: Drawer, all: &mut Arrangement) {
        let width = (24.0 * self.type_pt).min(0.46 * self.body.width());
        let at = |min: f32| Rect::from_min_size(pos2(min, self.body.min.y), vec2(width, self.body.height()));
        let rect = match (drawer, all.strip.filter(|_| !all.strip_room.is_column)) {
            (Drawer::Parameters, _) => at(self.body.min.x),
            // Sentence and formula stay in sight.
            (Drawer::Explanation, Some(strip)) => at(self.body.max.x - width).with_max_y(strip.min.y - GAP),
            (Drawer::Explanation, None) => at(self.body.max.x - width),
        };
        match drawer {
            Drawer::Parameters => all.parameters = Some(rect),
            Drawer::Explanation => all.explanation = Some(rect),
        }
        all.drawers.push(rect);
    }
}

/// What comes over an edge.
#[derive(Clone, Copy)]
enum Drawer {
    /// From the left.
    Parameters,
    /// From the right.
    Explanation,
}

/// The interface scale that `wanted` is cut down to in a window of `size` in points at scale 1, so that everything has room
/// with type of `type_pt`.
pub fn zoom_that_fits(wanted: f32, size: Vec2, type_pt: f32) -> f32 {
    let most = (size / (LEAST_LETTERS * type_pt)).min_elem();
    // Hundredths, so that nothing flickers while the window is dragged.
    let most = (most * 100.0).floor() / 100.0;
    if most.is_finite() { wanted.min(most.max(0.2)) } else { wanted }
}

/// `value` between `least` and `most`; `least` where there is not even room for that.
fn within(value: f32, least: f32, most: f32) -> f32 {
    value.min(most).max(least)
}

fn grip(x: f32, y: eframe::egui::Rangef) -> Rect {
    Rect::from_x_y_ranges(x - GRIP..=x + GRIP, y)
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
    use eframe::egui::Pos2;

    /// A window as it is with header and transport of usual heights.
    fn room(size: Vec2, type_pt: f32, is_lecture: bool) -> Room {
        let body = Rect::from_min_max(pos2(0.0, 2.6 * type_pt), (size - vec2(0.0, 3.6 * type_pt)).to_pos2());
        Room {
            body,
            window: size,
            type_pt,
            mode: Mode::of(size, type_pt, is_lecture),
            folded: Folded { parameters: true, ..Folded::default() },
            charts: 3,
            tiles: 0,
            is_beside_page: false,
            is_enlarged: false,
            strip: 6.0 * type_pt,
            explanation: 0.0,
            shares: Shares::default(),
        }
    }

    fn all_rooms() -> Vec<Room> {
        let sizes = [[1024.0, 640.0], [1280.0, 720.0], [1920.0, 1080.0], [2560.0, 1440.0]];
        let mut all = Vec::new();
        for size in sizes.map(Vec2::from) {
            for (type_pt, is_lecture) in [(14.0, false), (14.0, true), (21.0, true)] {
                for charts in 0..4 {
                    for fold in 0..8 {
                        let folded =
                            Folded { parameters: fold & 1 > 0, explanation: fold & 2 > 0, charts: fold & 4 > 0 };
                        for is_enlarged in [false, true] {
                            let zoom = zoom_that_fits(1.0, size, type_pt);
                            all.push(Room { folded, charts, is_enlarged, ..room(size / zoom, type_pt, is_lecture) });
                        }
                    }
                }
            }
        }
        all
    }

    #[test]
    fn nothing_lies_over_anything_but_drawers() {
        for room in all_rooms() {
            let all = room.arrange();
            let panes = [all.stage, all.explanation, all.strip, all.parameters];
            let panes: Vec<Rect> = panes.into_iter().flatten().chain(all.charts.iter().copied()).collect();
            let covered: f32 = panes.iter().filter(|pane| !all.drawers.contains(pane)).map(|pane| pane.area()).sum();
            assert!(covered > 0.97 * room.body.area(), "{all:?} leaves room in {room:?}");
            for (i, pane) in panes.iter().enumerate() {
                assert!(room.body.expand(0.5).contains_rect(*pane), "{pane:?} leaves {room:?}");
                assert!(pane.width() > 8.0 * room.type_pt, "{pane:?} in {room:?}");
                assert!(pane.height() >= 2.9 * room.type_pt, "{pane:?} in {room:?}");
                for other in panes[..i].iter().filter(|_| !all.drawers.contains(pane)) {
                    let is_over = !all.drawers.contains(other) && other.shrink(0.5).intersects(*pane);
                    assert!(!is_over, "{pane:?} and {other:?} in {room:?}");
                }
            }
        }
    }

    #[test]
    fn the_stage_has_most_of_the_window() {
        for size in [vec2(1280.0, 720.0), vec2(1920.0, 1080.0)] {
            let share = |room: Room| {
                let all = room.arrange();
                let stage = all.stage.map_or(0.0, |rect| rect.area());
                [stage, stage + all.charts.iter().map(|rect| rect.area()).sum::<f32>()]
                    .map(|area| area / size.x / size.y)
            };
            let shares = share(Room { folded: Folded::default(), ..room(size, 14.0, false) });
            assert!(shares[0] > 0.44, "{shares:?} of {size:?}");
            for type_pt in [14.0, 21.0] {
                let lecture = share(room(size, type_pt, true));
                assert!(lecture[1] > 0.6, "{lecture:?} of {size:?}");
            }
        }
    }

    #[test]
    fn the_stage_of_a_lecture_keeps_its_height_however_much_a_step_tells() {
        for size in [vec2(1024.0, 640.0), vec2(1280.0, 720.0), vec2(1920.0, 1080.0), vec2(2560.0, 1440.0)] {
            for type_pt in [14.0, 21.0] {
                let lecture = room(size, type_pt, true);
                let height = |lines: f32| {
                    let all = Room { strip: 1.3 * type_pt * lines, ..lecture }.arrange();
                    all.stage.map_or(0.0, |stage| stage.height())
                };
                let heights = [0.0, 3.0, 5.0, 7.0, 20.0].map(height);
                assert_eq!(heights[0], heights[2], "five lines always have room in {size:?} at {type_pt}");
                assert!(heights[4] >= 0.89 * heights[0], "{heights:?} in {size:?} at {type_pt}");
            }
        }
    }

    #[test]
    fn small_windows_have_smaller_type() {
        assert_eq!(zoom_that_fits(1.0, vec2(1280.0, 720.0), 21.0), 1.0);
        let zoom = zoom_that_fits(1.0, vec2(213.0, 160.0), 14.0);
        assert!(vec2(213.0, 160.0).x / zoom >= LEAST_LETTERS.x * 14.0 && zoom > 0.2, "{zoom}");
    }

    #[test]
    fn dragging_a_border_makes_room_where_it_leads() {
        let before = room(vec2(1920.0, 1080.0), 14.0, false);
        for border in before.arrange().borders {
            let mut shares = before.shares;
            *shares.of(border.of) += border.per_pt.x * 40.0 + border.per_pt.y * 40.0;
            let after = Room { shares, ..before }.arrange();
            let at = |all: &[Border]| all.iter().map(|b| b.rect.min).collect::<Vec<Pos2>>();
            let moved =
                at(&after.borders).iter().zip(at(&before.arrange().borders)).any(|(a, b)| (*a - b).max_elem() > 20.0);
            assert!(moved, "{border:?}");
        }
    }
}
