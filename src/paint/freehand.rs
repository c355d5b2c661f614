//! Freehand ink: lines drawn by hand on a picture or a chart of a step, in the coordinates of that.
//!
//! A [`FreehandLine`] has the coordinates of its [`Ground`], a picture or a chart, and the step and estimator that it belongs
//! to. It becomes primitives like the marks, so pictures, sheets and animations show it. Ink of a chart remembers the
//! viewpoint, section or scroll position in which it was drawn, and is seen in that one alone.

use std::str::FromStr;

use motionscope_core::base::Error;
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Picture, Role};

use super::primitive::{Point, Primitive, Rect, Stroke};
use super::{Panel, Placement, Theme};

/// Width of the pen in points; thicker in the projector theme, as all marks are.
const WIDTH: f32 = 4.0;
/// Length of the pieces of a smooth line in points.
const PIECE: f32 = 3.0;
/// Most pieces between two points that were drawn.
const MOST_PIECES: usize = 32;
/// Share by which the shape of a chart may differ from that which was drawn on: in another one its parts stand elsewhere.
const ANOTHER_SHAPE: f32 = 0.1;
/// Cosine of the turn from which a corner is rounded by a disc: a mitred one would be a spike.
const SHARP: f32 = 0.5;

/// A colour of the pen: that of a role, so that it can be told apart on footage and by the colour-blind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PenColor {
    /// Vermilion, which few marks have.
    #[default]
    Vermilion,
    /// Yellow.
    Yellow,
    /// Sky blue.
    Blue,
    /// Bluish green.
    Green,
}

impl PenColor {
    /// Every colour, in the order of its buttons.
    pub const ALL: [Self; 4] = [Self::Vermilion, Self::Yellow, Self::Blue, Self::Green];

    /// Stable name, for sessions.
    pub fn id(self) -> &'static str {
        match self {
            Self::Vermilion => "vermilion",
            Self::Yellow => "yellow",
            Self::Blue => "blue",
            Self::Green => "green",
        }
    }

    /// The role with its ink.
    pub fn role(self) -> Role {
        match self {
            Self::Vermilion => Role::Error,
            Self::Yellow => Role::Candidate,
            Self::Blue => Role::Reference,
            Self::Green => Role::Best,
        }
    }

    /// The colour after this one, the first after the last.
    #[must_use]
    pub fn next(self) -> Self {
        let after = Self::ALL.into_iter().cycle().skip_while(|color| *color != self).nth(1);
        after.unwrap_or_default()
    }
}

impl FromStr for PenColor {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let all = Self::ALL.map(Self::id).join(", ");
        let refused = || Error::new(format!("the colours of the pen are {all}, not {text}"));
        Self::ALL.into_iter().find(|color| color.id() == text).ok_or_else(refused)
    }
}

/// What was drawn on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// A picture.
    Picture(Picture),
    /// A chart.
    Chart {
        /// The id of its pane.
        pane: &'static str,
        /// Its width and height in points when it was drawn on.
        size: [f32; 2],
        /// Its viewpoint, section or scroll position at the time of drawing, padded with zeros; `None` for the default one.
        view: Option<[f32; Ground::VIEW]>,
    },
}

impl Ground {
    /// The most numbers that the view of a chart has.
    pub const VIEW: usize = 6;
}

impl From<Picture> for Ground {
    fn from(picture: Picture) -> Self {
        Self::Picture(picture)
    }
}

/// A line drawn by hand on a step.
#[derive(Clone, Debug, PartialEq)]
pub struct FreehandLine {
    /// The step on which it was drawn, and on which it is seen.
    pub step: Cursor,
    /// Which of several estimators in lockstep has the picture or the chart; 0 for a single one.
    pub member: usize,
    /// What it lies on.
    pub on: Ground,
    /// Its colour.
    pub color: PenColor,
    /// Its points in px of the picture, or in points from the upper left corner of the chart; at least one.
    pub points: Vec<[f32; 2]>,
}

impl FreehandLine {
    /// The line given up before it was whole: it is on no step, and stays without points until the mouse is let go.
    #[must_use]
    pub fn given_up(self) -> Self {
        Self { step: Cursor::END, points: Vec::new(), ..self }
    }

    /// Whether `panel` of estimator `member` shows it.
    pub fn is_on(&self, panel: Panel, member: usize) -> bool {
        self.member == member && self.picture().is_some_and(|picture| panel.shows(picture))
    }

    /// The picture that it lies on, if it is one.
    pub fn picture(&self) -> Option<Picture> {
        if let Ground::Picture(picture) = self.on { Some(picture) } else { None }
    }

    /// Where it lies on the chart `on` of estimator `member` in `area`; `None` on anything else, and where the chart has another
    /// shape or is seen from elsewhere than when it was drawn on.
    fn on_chart(&self, (on, member): (Ground, usize), area: Rect) -> Option<Placement> {
        let Ground::Chart { pane: own, size, view: seen } = self.on else { return None };
        let Ground::Chart { pane, view, .. } = on else { return None };
        let zooms = [0, 1].map(|i| area.size()[i] / size[i]);
        let is_alike = (zooms[0] / zooms[1] - 1.0).abs() <= ANOTHER_SHAPE;
        let zoom = zooms[0].min(zooms[1]);
        // A placement has the middles of pixels at whole numbers; points of a chart are places.
        let origin = [0, 1].map(|i| area.center()[i] - zoom * (size[i] / 2.0 + 0.5));
        let is_there = own == pane && seen == view && self.member == member;
        (is_there && is_alike).then(|| Placement::new(origin, zoom))
    }

    /// Returns the line without the tremor of the hand: each point but the ends is averaged with its neighbours.
    #[must_use]
    pub fn steadied(mut self) -> Self {
        let mean = |w: &[[f32; 2]]| [0, 1].map(|i| (w[0][i] + 2.0 * w[1][i] + w[2][i]) / 4.0);
        let inner: Vec<_> = self.points.windows(3).map(mean).collect();
        self.points.iter_mut().skip(1).zip(inner).for_each(|(point, steady)| *point = steady);
        self
    }
}

/// The lines drawn by hand in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Freehand {
    /// The lines, in the order of drawing.
    pub lines: Vec<FreehandLine>,
}

impl Freehand {
    /// Returns the lines of `step`.
    pub fn at(&self, step: Cursor) -> Vec<FreehandLine> {
        self.lines.iter().filter(|line| line.step == step).cloned().collect()
    }
}

/// Returns what is painted of `lines` on a picture that lies at `place`.
pub fn freehand<'a>(
    lines: impl IntoIterator<Item = &'a FreehandLine>,
    theme: Theme,
    place: Placement,
) -> Vec<Primitive> {
    lines.into_iter().flat_map(|line| inked(line, theme, place)).collect()
}

/// Returns what is painted of `lines` on the `chart` of one of several estimators in `area`.
pub fn freehand_on_chart<'a>(
    lines: impl IntoIterator<Item = &'a FreehandLine>,
    theme: Theme,
    (chart, area): ((Ground, usize), Rect),
) -> Vec<Primitive> {
    let placed = lines.into_iter().filter_map(|line| Some((line, line.on_chart(chart, area)?)));
    placed.flat_map(|(line, place)| inked(line, theme, place)).collect()
}

/// Returns the width of the pen in `theme`, in points.
pub fn pen_width(theme: Theme) -> f32 {
    WIDTH * theme.ink(Role::Best).halo_width
}

/// A line over its rim.
fn inked(line: &FreehandLine, theme: Theme, place: Placement) -> Vec<Primitive> {
    let (ink, width) = (theme.ink(line.color.role()), pen_width(theme));
    let points = smooth(&line.points.iter().map(|point| place.at(*point)).collect::<Vec<_>>());
    let rim = [(width + 2.0 * ink.halo_width, ink.halo), (width, ink.color)];
    let painted = |(width, color)| {
        let pieces = pieces(&points);
        let ends = pieces.iter().flat_map(|piece| [piece.first(), piece.last()]).flatten();
        let discs = ends.map(|&center| Primitive::Disc { center, radius: width / 2.0, color });
        let stroke = Stroke { width, color, dash: &[] };
        let lines = pieces.iter().filter(|piece| piece.len() > 1);
        let lines = lines.map(|piece| Primitive::Polyline { points: piece.to_vec(), closed: false, stroke });
        lines.chain(discs).collect::<Vec<_>>()
    };
    rim.into_iter().flat_map(painted).collect()
}

/// A smooth curve through `points`, after Catmull and Rom.
fn smooth(points: &[Point]) -> Vec<Point> {
    let at = |i: isize| points[i.clamp(0, points.len() as isize - 1) as usize];
    let mut all: Vec<Point> = points.first().copied().into_iter().collect();
    for i in 0..points.len().saturating_sub(1) as isize {
        let [p, q, r, s] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
        let length = (r[0] - q[0]).hypot(r[1] - q[1]);
        let count = ((length / PIECE).ceil() as usize).clamp(1, MOST_PIECES);
        all.extend((1..=count).map(|k| {
            let t = k as f32 / count as f32;
            let curve = |i: usize| {
                let (slope, bend) = (r[i] - p[i], 2.0 * p[i] - 5.0 * q[i] + 4.0 * r[i] - s[i]);
                let twist = 3.0 * (q[i] - r[i]) + s[i] - p[i];
                q[i] + 0.5 * t * (slope + t * (bend + t * twist))
            };
            [curve(0), curve(1)]
        }));
    }
    all
}

/// The parts of a curve between its sharp corners.
fn pieces(points: &[Point]) -> Vec<&[Point]> {
    if points.is_empty() {
        return Vec::new();
    }
    let cosine = |i: usize| {
        let [a, b, c] = [points[i - 1], points[i], points[i + 1]];
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        let length = u[0].hypot(u[1]) * v[0].hypot(v[1]);
        if length > 0.0 { (u[0] * v[0] + u[1] * v[1]) / length } else { 1.0 }
    };
    let corners = (1..points.len().saturating_sub(1)).filter(|&i| cosine(i) < SHARP);
    let mut ends: Vec<usize> = std::iter::once(0).chain(corners).collect();
    ends.push(points.len().saturating_sub(1));
    ends.windows(2).map(|end| &points[end[0]..=end[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[[f32; 2]]) -> FreehandLine {
        let (step, on) = (Cursor::default(), Picture::CURRENT.into());
        FreehandLine { step, member: 0, on, color: PenColor::Vermilion, points: points.to_vec() }
    }

    #[test]
    fn a_line_passes_through_its_points_wherever_the_picture_lies() {
        let drawn = line(&[[0.0, 0.0], [10.0, 4.0], [20.0, 0.0]]);
        for place in [Placement::new([0.0, 0.0], 1.0), Placement::new([40.0, -7.0], 6.0)] {
            let painted = freehand([&drawn], Theme::Dark, place);
            let reaches = |to: Point| {
                painted.iter().any(|primitive| match primitive {
                    Primitive::Polyline { points, .. } => {
                        points.iter().any(|p| (p[0] - to[0]).hypot(p[1] - to[1]) < 1e-3)
                    }
                    _ => false,
                })
            };
            assert!(drawn.points.iter().all(|point| reaches(place.at(*point))), "{place:?}");
        }
    }

    #[test]
    fn ink_of_a_chart_lies_where_it_was_drawn_while_the_chart_has_its_shape() {
        let of = |pane, view| Ground::Chart { pane, size: [200.0, 100.0], view };
        let dot = FreehandLine { on: of("surface", None), ..line(&[[150.0, 20.0]]) };
        let center = |chart: (Ground, usize), area: Rect| {
            let painted = freehand_on_chart([&dot], Theme::Dark, (chart, area));
            painted.iter().find_map(|primitive| match primitive {
                Primitive::Disc { center, .. } => Some(*center),
                _ => None,
            })
        };
        let here = (of("surface", None), 0);
        assert_eq!(center(here, Rect::new([40.0, 10.0], [200.0, 100.0])), Some([190.0, 30.0]));
        assert_eq!(center(here, Rect::new([0.0; 2], [400.0, 200.0])), Some([300.0, 40.0]), "twice as large");
        assert_eq!(center(here, Rect::new([0.0; 2], [200.0, 200.0])), None, "its parts stand elsewhere");
        let turned = Some([-0.5, 0.68, 1.2, 0.0, 0.0, 0.0]);
        for other in [(of("plane", None), 0), (of("surface", None), 1), (of("surface", turned), 0)] {
            assert_eq!(center(other, Rect::new([0.0; 2], [200.0, 100.0])), None, "{other:?}");
        }
        assert!(!dot.is_on(Panel::CURRENT, 0) && line(&[[1.0; 2]]).is_on(Panel::CURRENT, 0));
    }

    #[test]
    fn a_line_is_wide_enough_for_the_last_row_and_has_a_rim() {
        for theme in Theme::ALL {
            assert!(pen_width(theme) >= 3.0);
            for color in PenColor::ALL {
                let ink = theme.ink(color.role());
                assert!(ink.color.contrast(ink.halo) >= 4.5 && ink.halo_width >= 1.0, "{theme:?} {color:?}");
            }
        }
        assert!(pen_width(Theme::Projector) > pen_width(Theme::Dark));
    }

    #[test]
    fn a_point_is_a_dot_and_a_corner_no_spike() {
        let place = Placement::new([0.0, 0.0], 1.0);
        let dot = freehand([&line(&[[3.0, 3.0]])], Theme::Dark, place);
        assert!(dot.iter().all(|primitive| matches!(primitive, Primitive::Disc { .. })) && dot.len() >= 2);
        assert!(freehand([&line(&[])], Theme::Dark, place).is_empty(), "nothing is no dot");
        let back = freehand([&line(&[[0.0, 0.0], [30.0, 0.0], [0.0, 1.0]])], Theme::Dark, place);
        let width = pen_width(Theme::Dark) + 2.0;
        for primitive in &back {
            if let Primitive::Polyline { points, .. } = primitive {
                assert!(points.iter().all(|p| p[0] <= 30.0 + width), "{points:?}");
                assert!(pieces(points).len() == 1, "a corner within a piece");
            }
        }
    }

    #[test]
    fn a_steady_line_keeps_its_ends() {
        let steady = line(&[[0.0, 0.0], [1.0, 4.0], [2.0, 0.0], [3.0, 0.0]]).steadied();
        assert_eq!(steady.points, [[0.0, 0.0], [1.0, 2.0], [2.0, 1.0], [3.0, 0.0]]);
        assert_eq!(line(&[[1.0, 1.0]]).steadied().points.len(), 1);
    }

    #[test]
    fn colours_follow_each_other_and_are_read_by_their_names() {
        let round = PenColor::ALL.map(PenColor::next);
        assert_eq!(round, [PenColor::Yellow, PenColor::Blue, PenColor::Green, PenColor::Vermilion]);
        assert!(PenColor::ALL.iter().all(|color| color.id().parse() == Ok(*color)));
        assert!(
            "pink".parse::<PenColor>().is_err_and(|why| why.to_string().contains("vermilion, yellow, blue, green"))
        );
    }
}
