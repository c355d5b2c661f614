//! The plane of displacements: what pixels allow, as lines, a cost as colors, and displacements as points.

use std::sync::Arc;

use motionscope_core::base::words::fixed;
use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Constraint, Plane, PlaneCost, Role, Spread};

use super::super::primitive::{Anchor, Point, Primitive, Rect, Run};
use super::super::{Color, Face, Ink, Theme, labels as tick_labels, legend, marks, number, region_color};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type, fitting, shortened, solid};
use super::labels::{self, Labels};
use super::{ChartStyle, Drawing, titled};

/// How near one can come: what a plane shows at first is at most so many times as wide.
const NEAREST: f32 = 256.0;
/// How far one can go away.
const FARTHEST: f32 = 16.0;
/// How many times farther than the points the first view reaches at most, to include a line.
const FOR_LINE: f32 = 4.0;
/// Side of the arrow at the edge towards a line beyond it, in points.
const ARROW: f32 = 9.0;
/// Of so few lines each is looked at by itself.
const FEW: usize = 2;
/// Letters beside the plane for the names of its points, if there is room for them.
const NAMES: f32 = 13.0;
/// The same where a name and its place share a line.
const SHORT_NAMES: f32 = 18.0;
/// Height of such a line, and of the scale of costs, in sizes of the type.
const LINE: f32 = 1.7;
const SCALE: f32 = 4.0;
/// How much larger the plane is at least where its names stand below it.
const BELOW: f32 = 1.15;

/// What is shown.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The lines and points.
    pub plane: &'a Plane,
    /// The estimator whose they are.
    pub whose: &'a str,
    /// Which part of the plane is seen; all of it unless one came nearer.
    pub window: Option<Window>,
    /// Whether the points are named beside the plane however much room it has.
    pub has_names_beside: bool,
}

/// A part of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The displacement in its middle.
    pub center: [f32; 2],
    /// How far it reaches from there on both axes.
    pub reach: f32,
}

impl Window {
    /// All that `plane` shows at first: all points, and of few lines each that does not lie much farther away.
    pub fn whole(plane: &Plane) -> Self {
        let mut reaches = std::iter::successors(Some(plane.reach), |reach| Some(2.0 * reach));
        let all = |reach: f32| plane.lines.iter().all(|line| seen_from(line, plane.center).within(reach).is_some());
        let found = reaches.find(|reach| *reach > FOR_LINE * plane.reach || all(*reach));
        let reach = found.filter(|reach| plane.lines.len() <= FEW && *reach <= FOR_LINE * plane.reach);
        Self { center: plane.center, reach: reach.unwrap_or(plane.reach) }
    }

    /// After coming nearer by `factor` to the displacement `at`, which stays where it is.
    #[must_use]
    pub fn nearer(self, at: [f32; 2], factor: f32, plane: &Plane) -> Self {
        let reach = (self.reach / factor).clamp(plane.reach / NEAREST, plane.reach * FARTHEST);
        let share = reach / self.reach;
        Self { center: [0, 1].map(|i| at[i] + (self.center[i] - at[i]) * share), reach }
    }

    /// After going `by` further along both axes, not beyond what can be seen from afar.
    #[must_use]
    pub fn moved(self, by: [f32; 2], plane: &Plane) -> Self {
        let most = plane.reach * FARTHEST;
        let along = |i: usize| plane.center[i] + (self.center[i] + by[i] - plane.center[i]).clamp(-most, most);
        Self { center: [0, 1].map(along), ..self }
    }
}

/// Where the plane lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// Inside the axes.
    pub rect: Rect,
    /// Of u and of v, which runs down as in the picture.
    axes: [Axis; 2],
    window: Window,
    /// Whether the names of the axes share the rows of what stands above and of the numbers below.
    is_tight: bool,
    /// Whether the points and the ellipse carry their names.
    is_direct: bool,
    /// Whether their names stand below the plane.
    has_names_below: bool,
}

/// What is named around a plane.
#[derive(Clone, Copy)]
struct Named {
    /// Whether the points and the ellipse carry their names.
    is_direct: bool,
    /// How many other points.
    points: usize,
    /// Whether there is another ellipse, and a scale of costs.
    has_ellipse: bool,
    has_scale: bool,
}

impl Named {
    fn of(plane: &Plane, is_direct: bool) -> Self {
        let points = if is_direct { 0 } else { plane.points.len() };
        Self { is_direct, points, has_ellipse: !is_direct && plane.ellipse.is_some(), has_scale: plane.cost.is_some() }
    }

    /// Whether anything has to stand beside the plane or below it.
    fn is_any(self) -> bool {
        self.points > 0 || self.has_ellipse || self.has_scale
    }

    /// Height of the names below the plane, a point a line, in sizes of their type.
    fn letters_below(self) -> f32 {
        LINE * (self.points + usize::from(self.has_ellipse)) as f32 + if self.has_scale { SCALE } else { 0.0 }
    }
}

impl Square {
    fn new(area: Rect, window: Window, (small, named): (f32, Named)) -> Self {
        // Room for the title, the numbers at the axes and the names of the points.
        let is_tight = super::is_tight(area, small);
        let beside = if is_tight { 1.7 } else { 3.2 } * small;
        let min = [area.min[0] + 4.0 * small, area.min[1] + beside];
        let room = [area.max[0] - small - min[0], area.max[1] - beside - min[1]];
        let beside = |names: f32, least: f32| (room[0] - names * small).max(least * room[0]).min(room[1]).max(8.0);
        let side = if named.is_any() { beside(NAMES, 0.6) } else { beside(0.0, 1.0) };
        // Rather a smaller plane than displacements without their decimals.
        let (names, side) = match is_short(named.points, side, small) {
            true => (SHORT_NAMES, beside(SHORT_NAMES, 0.45)),
            false => (if named.is_any() { NAMES } else { 0.0 }, side),
        };
        // Where the area is narrow, the plane is larger over its names.
        let below = room[0].min(room[1] - named.letters_below() * small);
        let has_names_below = !is_tight && below > BELOW * side;
        let (names, side) = if has_names_below { (0.0, below) } else { (names, side) };
        let left = min[0] + ((room[0] - names * small - side) / 2.0).max(0.0);
        let rect = Rect::new([left.round(), min[1].round()], [side; 2]);
        let axis = |i: usize| {
            let values = [window.center[i] - window.reach, window.center[i] + window.reach];
            Axis::new(values, [rect.min[i], rect.max[i]])
        };
        Self { rect, axes: [axis(0), axis(1)], window, is_tight, is_direct: named.is_direct, has_names_below }
    }

    /// Where a displacement stands.
    pub fn at(&self, uv: [f32; 2]) -> Point {
        [0, 1].map(|i| self.axes[i].place(uv[i]))
    }

    /// The displacement that stands at a place inside the axes.
    pub fn displacement(&self, at: Point) -> Option<[f32; 2]> {
        let inside = (0..2).all(|i| (self.rect.min[i]..=self.rect.max[i]).contains(&at[i]));
        inside.then(|| [0, 1].map(|i| self.axes[i].value(at[i])))
    }

    /// How many displacements of 1 lie in a point.
    pub fn per_point(&self) -> f32 {
        2.0 * self.window.reach / self.rect.size()[0]
    }

    /// Where the name of the second axis begins.
    fn name_left(&self, name: Type) -> f32 {
        self.rect.min[0] - 6.0 - 0.5 * name.width("v, px ↓")
    }

    /// Where what stands above begins.
    fn head_left(&self, area: Rect, (unit, theme): (&str, Theme)) -> f32 {
        let name = Type::text(theme).face(Face::Italic);
        let after = self.name_left(name) + name.width(&format!("v, {unit} ↓")) + 0.8 * name.size;
        if self.is_tight { after } else { area.min[0] }
    }

    /// The part of a line that is seen.
    fn part(&self, line: &Constraint) -> Option<[Point; 2]> {
        let Window { center: [u, v], reach } = self.window;
        let ends = seen_from(line, [u, v]).within(reach)?;
        Some(ends.map(|end| self.at([end[0] + u, end[1] + v])))
    }
}

/// The line in displacements counted from `center`.
fn seen_from(line: &Constraint, [u, v]: [f32; 2]) -> Constraint {
    let [a, b, c] = line.factors;
    Constraint { factors: [a, b, c + a * u + b * v], ..*line }
}

/// Lays the plane out as large as it fits into `area`.
pub fn draw(data: Shown<'_>, area: Rect, style: ChartStyle) -> Drawing<Square> {
    let Shown { plane, window, .. } = data;
    let (theme, small) = (style.theme, style.small());
    let named = Named::of(plane, !data.has_names_beside && has_room(plane, area, Type::text(theme)));
    let square = Square::new(area, window.unwrap_or(Window::whole(plane)), (small, named));
    let mut canvas = Canvas::default();
    canvas.inside(square.rect, |canvas| costs(canvas, &square, plane, style));
    axes(&mut canvas, (&square, area.max[0]), (plane, window.is_some() || plane.center != [0.0; 2]), theme);
    for line in &plane.lines {
        if let Some(ends) = square.part(line) {
            let alpha = (255.0 * (0.25 + 0.75 * line.weight)) as u8;
            canvas.line(ends.to_vec(), false, solid(1.0 + line.weight, theme.stroke(line.role).alpha(alpha)));
        }
    }
    let beyond = plane.lines.iter().filter(|line| plane.lines.len() <= FEW && square.part(line).is_none());
    beyond.for_each(|line| towards(&mut canvas, &square, line, theme));
    let ellipse = plane.ellipse.as_ref().map(|ellipse| spread(&square, ellipse, theme));
    canvas.inside(square.rect, |canvas| {
        canvas.extend(ellipse);
        groups(canvas, &square, plane, theme);
        path(canvas, &square, plane, theme);
    });
    names(&mut canvas, &square, area, (plane, style));
    Drawing { place: square, body: canvas.into_layers(), head: head(data, &square, area, None, style) }
}

/// What stands above the plane: what it shows, or the displacement that is pointed at.
pub fn head(
    data: Shown<'_>,
    square: &Square,
    area: Rect,
    pointed: Option<[f32; 2]>,
    style: ChartStyle,
) -> Vec<Primitive> {
    let Shown { plane, whose, .. } = data;
    let (text, left) = (Type::text(style.theme), square.head_left(area, (&plane.unit, style.theme)));
    let width = area.max[0] - left;
    let words = match pointed {
        Some([u, v]) => {
            let at = format!("({}, {}) {}", number(u), number(v), plane.unit);
            match (&plane.cost, plane.cost_at([u, v])) {
                (Some(of), Some(cost)) => format!("{at}: {} {}", number(cost), of.unit),
                (Some(of), None) => format!("{at}: {} not defined", of.name),
                (None, _) => at,
            }
        }
        None => {
            let has_gaps = plane.cost.as_ref().is_some_and(PlaneCost::has_gaps);
            let gaps = has_gaps.then(|| "blank where the window leaves the picture".to_owned());
            let more = beyond(plane, square).or(gaps).map_or_else(String::new, |what| format!(", {what}"));
            titled(whose, &format!("{}{more}", plane.title), (text.size, width))
        }
    };
    // Rather where the lines are than what is shown.
    let brief = beyond(plane, square).filter(|_| pointed.is_none());
    let wordings: Vec<String> = std::iter::once(words).chain(brief).collect();
    let mut canvas = Canvas::default();
    let at = [left, area.min[1] + 0.8 * text.size];
    canvas.text(at, (Anchor::Start, Level::Middle), &fitting(&wordings, text, width), text);
    canvas.into_primitives()
}

/// The costs as cells of colors under all else. Roots are shown, so that the valley around the minimum is seen.
fn costs(canvas: &mut Canvas, square: &Square, plane: &Plane, style: ChartStyle) {
    let Some((cost, [low, high])) = plane.cost.as_ref().and_then(|cost| Some((cost, cost.range()?))) else { return };
    let shade = |cost: f32| {
        let share = ((cost - low) / (high - low).max(f32::MIN_POSITIVE)).sqrt();
        style.colors.at(share)
    };
    let pixels = cost.values.map(|cost| if cost.is_finite() { shade(*cost).0 } else { [0; 4] });
    let [min, max] = [-1.0, 1.0].map(|side| square.at(plane.center.map(|c| c + side * plane.reach)));
    canvas.add(Primitive::Image { pixels: Arc::new(pixels), rect: Rect { min, max } });
}

/// The displacements of groups, as dots in the colour of each.
fn groups(canvas: &mut Canvas, square: &Square, plane: &Plane, theme: Theme) {
    for (group, uv) in &plane.groups {
        let at = square.at(*uv);
        if square.displacement(at).is_some() {
            let own = Color(region_color(*group)).alpha(255);
            canvas.disc(at, 2.0, if *group == 0 { theme.chrome().line } else { own });
        }
    }
}

/// The colours of the named points. Several of one role are the means of the groups in their order, from group 1 on: each has the
/// colour of its group, if that has a displacement. A point that is the only one of its role has none of its own.
fn own_colors(plane: &Plane) -> Vec<Option<Color>> {
    let points = &plane.points;
    let color = |index: usize| {
        let is_peer = |other: &usize| points[*other].1 == points[index].1;
        let has_peers = (0..points.len()).filter(is_peer).count() > 1;
        let group = 1 + (0..index).filter(is_peer).count() as u32;
        let is_there = plane.groups.iter().any(|(own, _)| *own == group);
        (has_peers && is_there).then(|| Color(region_color(group)).alpha(255))
    };
    (0..points.len()).map(color).collect()
}

/// A named point: in a colour of its own with a rim that sets it off from the dots of its group, or else as its role looks.
fn point((role, own): (Role, Option<Color>), theme: Theme, at: Point) -> Vec<Primitive> {
    let Some(color) = own else { return legend::point(role, theme, at) };
    let mut out = Vec::new();
    marks::point(&mut out, &Ink { color, halo: theme.chrome().text, ..theme.ink(role) }, at);
    out
}

/// The estimates of an iteration, joined in their order.
fn path(canvas: &mut Canvas, square: &Square, plane: &Plane, theme: Theme) {
    if plane.path.len() < 2 {
        return;
    }
    let places: Vec<_> = plane.path.iter().map(|at| square.at(*at)).collect();
    let ink = theme.ink(Role::Estimate).color;
    for (width, color) in [(4.5, Color::BLACK.alpha(150)), (2.0, ink)] {
        canvas.line(places.clone(), false, solid(width, color));
    }
    for place in places {
        canvas.disc(place, 4.0, Color::BLACK.alpha(150));
        canvas.disc(place, 3.0, ink);
    }
}

/// The distance of a line from the zero displacement.
fn distance(line: &Constraint) -> f32 {
    let [a, b, c] = line.factors;
    c.abs() / a.hypot(b)
}

/// Where the lines lie that are not seen, in words; nothing if enough are.
fn beyond(plane: &Plane, square: &Square) -> Option<String> {
    let outside: Vec<f32> = plane.lines.iter().filter(|line| square.part(line).is_none()).map(distance).collect();
    let nearest = outside.iter().copied().reduce(f32::min)?;
    let far = format!("{} {} from the origin", number(nearest), plane.unit);
    match (outside.len(), plane.lines.len()) {
        (1, 1) => Some(format!("constraint line {far}, outside")),
        (out, all) if out == all => Some(format!("all {all} constraint lines outside, the nearest {far}")),
        (_, all) if all <= FEW => Some(format!("a constraint line {far}, outside")),
        // Of many it is enough that most are seen.
        (out, all) if 2 * out > all => Some(format!("{out} of {all} constraint lines outside")),
        _ => None,
    }
}

/// An arrow at the edge towards the nearest point of a line that lies beyond it.
fn towards(canvas: &mut Canvas, square: &Square, line: &Constraint, theme: Theme) {
    let [a, b, c] = line.factors;
    let Window { center, reach } = square.window;
    // From the middle of what is seen to the line.
    let off = -(a * center[0] + b * center[1] + c) / (a * a + b * b);
    let way = [a * off, b * off];
    let most = way[0].abs().max(way[1].abs());
    if most <= 0.0 || !most.is_finite() {
        return;
    }
    let tip = square.at([0, 1].map(|i| center[i] + way[i] / most * reach));
    let length = way[0].hypot(way[1]);
    let [x, y] = way.map(|c| c / length * ARROW);
    let foot = |side: f32| [tip[0] - x - 0.6 * side * y, tip[1] - y + 0.6 * side * x];
    canvas.add(Primitive::Polygon { points: vec![tip, foot(1.0), foot(-1.0)], color: theme.stroke(line.role) });
}

fn axes(canvas: &mut Canvas, (square, edge): (&Square, f32), (plane, is_near): (&Plane, bool), theme: Theme) {
    let (chrome, dim) = (theme.chrome(), Type::dim(theme));
    let small = dim.size;
    let Rect { min: [left, top], max: [right, bottom] } = square.rect;
    canvas.frame(square.rect.grown(0.5), 1.0, chrome.line);
    let ticks = |axis: &Axis, spacing: f32| if is_near { axis.ticks(spacing, 0.0) } else { halves(axis, spacing) };
    let across = ticks(&square.axes[0], 3.6 * small);
    for (&u, words) in across.iter().zip(tick_labels(&across)) {
        let x = square.axes[0].place(u);
        canvas.down(x, [top, bottom], chrome.line);
        canvas.text([x, bottom + 4.0], (Anchor::Middle, Level::Top), &words, dim);
    }
    let down = ticks(&square.axes[1], 2.0 * small);
    for (&v, words) in down.iter().zip(tick_labels(&down)) {
        let y = square.axes[1].place(v);
        canvas.across([left, right], y, chrome.line);
        canvas.text([left - 6.0, y], (Anchor::End, Level::Middle), &words, dim);
    }
    let name = Type::text(theme).face(Face::Italic);
    // The first axis goes to the right, the second down, as in the picture.
    let words = format!("u, {} →", plane.unit);
    if square.is_tight {
        let x = right + 1.4 * small;
        // The other axis has the unit as well.
        let words = if x + name.width(&words) <= edge { words } else { "u →".to_owned() };
        canvas.text([x, bottom + 4.0], (Anchor::Start, Level::Top), &words, name);
    } else {
        canvas.text([right, bottom + 4.0 + 1.25 * small], (Anchor::End, Level::Top), &words, name);
    }
    let x = square.name_left(name);
    canvas.text([x, top - 0.4 * small], (Anchor::Start, Level::Bottom), &format!("v, {} ↓", plane.unit), name);
}

/// Ticks at halves, quarters and so on of what an axis reaches, at least `spacing` points apart: how far a plane reaches
/// goes by powers of two.
fn halves(axis: &Axis, spacing: f32) -> Vec<f32> {
    let reach = axis.values[1];
    let apart = |step: f32| (axis.place(step) - axis.place(0.0)).abs();
    let steps = std::iter::successors(Some(reach), |step| Some(step / 2.0));
    let step = steps.take(4).take_while(|step| apart(*step) >= spacing).last().unwrap_or(reach);
    let count = (reach / step).round() as i32;
    (-count..=count).map(|i| i as f32 * step).collect()
}

/// How far a rounded place may lie from its point, as a share of the reach of the plane.
const ROUNDED: f32 = 0.03;

/// The ellipse of a standard deviation: unlike the lines and points of a plane.
const SPREAD: Role = Role::Predicted;

fn spread(square: &Square, spread: &Spread, theme: Theme) -> Primitive {
    // One px is as long across as down.
    let radii = spread.radii.map(|r| r / square.per_point());
    let points = marks::ellipse(square.at(spread.center), radii, spread.angle_rad);
    Primitive::Polyline { points, closed: true, stroke: solid(theme.ink(SPREAD).width, theme.stroke(SPREAD)) }
}

/// Whether the plane is so small that the name of a point and its place share a line.
fn is_short(points: usize, side: f32, small: f32) -> bool {
    3.2 * small * points as f32 > side
}

/// Share of the plane that names of points may cover.
const COVERED: f32 = 0.2;
/// Widest name of a point, as a share of the plane's width.
const WIDEST: f32 = 0.75;
/// From a point to its name, and to a name that needs a line to it, in points.
const REACH: f32 = 8.0;
const FAR: f32 = 16.0;

/// What the ellipse is called.
const SPREAD_NAME: &str = "one standard deviation";

/// Whether the points of `plane` and its ellipse can carry their names in `area`.
fn has_room(plane: &Plane, area: Rect, style: Type) -> bool {
    let side = (area.size()[0] - 5.0 * style.size).min(area.size()[1] - 6.4 * style.size).max(1.0);
    let place = |uv: &[f32; 2]| 0.5 * style.size + style.width(&place_within(*uv, (style, f32::INFINITY), plane.reach));
    let points = plane.points.iter().map(|(name, _, uv)| style.width(name) + place(uv));
    let widths: Vec<f32> = points.chain(plane.ellipse.iter().map(|_| style.width(SPREAD_NAME))).collect();
    let covered = widths.iter().sum::<f32>() * 1.2 * style.size;
    widths.iter().all(|width| *width <= WIDEST * side) && covered <= COVERED * side * side
}

/// The names of points and ellipse where these stand, each point's with its displacement; a line leads to one that is far away.
fn direct_names(canvas: &mut Canvas, square: &Square, (plane, theme): (&Plane, Theme)) {
    let (text, dim) = (Type::text(theme), Type::dim(theme));
    let mut room = Labels::new(square.rect);
    let seen: Vec<_> =
        plane.points.iter().zip(own_colors(plane)).map(|(point, own)| (point, square.at(point.2), own)).collect();
    let seen: Vec<_> = seen.into_iter().filter(|(_, at, _)| square.displacement(*at).is_some()).collect();
    seen.iter().for_each(|(_, at, _)| room.keep_off(Rect::centered(*at, [2.0 * REACH - 2.0; 2])));
    room.keep_off_line(plane.path.iter().map(|uv| square.at(*uv)).collect());
    if plane.lines.len() <= FEW {
        plane.lines.iter().filter_map(|line| square.part(line)).for_each(|ends| room.keep_off_line(ends.to_vec()));
    }
    let mut write = |at: Point, reach: f32, runs: Vec<Run>| {
        let size = labels::size(&runs, text.size);
        let Some(center) = room.place_anyway(size, &labels::around(at, reach, size)) else { return };
        let foot = [0, 1].map(|i| at[i].clamp(center[i] - size[i] / 2.0, center[i] + size[i] / 2.0));
        if (foot[0] - at[0]).hypot(foot[1] - at[1]) > reach + FAR - REACH {
            canvas.line(vec![at, foot], false, solid(1.0, theme.chrome().dim));
        }
        labels::write(canvas, center, runs, (text, theme.chrome().panel));
    };
    for ((name, role, uv), at, own) in &seen {
        let color = own.map_or(theme.word(*role), |own| own.legible_on(theme.chrome().panel, 4.5));
        let place = place_within(*uv, (dim, f32::INFINITY), square.window.reach);
        write(*at, REACH, vec![Run::new(format!("{name} "), color), Run::new(place, dim.color)]);
    }
    if let Some(spread) = &plane.ellipse {
        let reach = spread.radii[0].min(spread.radii[1]) / square.per_point() + 2.0;
        write(square.at(spread.center), reach, vec![Run::new(SPREAD_NAME, theme.word(SPREAD))]);
    }
}

/// The points, and beside the plane what each is called unless they carry their names.
fn names(canvas: &mut Canvas, square: &Square, area: Rect, (plane, style): (&Plane, ChartStyle)) {
    let theme = style.theme;
    let (text, dim) = (Type::text(theme), Type::dim(theme));
    let small = text.size;
    let Rect { min: [left, top], max: [right, bottom] } = square.rect;
    let is_below = square.has_names_below;
    let mut at = if is_below { [left, bottom + 3.2 * small] } else { [right + small, top] };
    let is_short =
        is_below || is_short(plane.points.len() + usize::from(plane.ellipse.is_some()), square.rect.size()[1], small);
    for ((name, role, uv), own) in plane.points.iter().zip(own_colors(plane)) {
        if square.displacement(square.at(*uv)).is_some() {
            canvas.extend(point((*role, own), theme, square.at(*uv)));
        }
        if square.is_direct {
            continue;
        }
        canvas.extend(point((*role, own), theme, at.map(|c| c + small / 2.0)));
        let left = at[0] + 1.8 * small;
        let room = area.max[0] - left;
        let place_at = (Anchor::Start, Level::Middle);
        let y = at[1] + small / 2.0;
        let end = canvas.text([left, y], place_at, &shortened(name, text, room), text).max[0];
        let (x, y) = if is_short { (end + 0.6 * small, y) } else { (left, y + 1.4 * small) };
        canvas.text([x, y], place_at, &place_within(*uv, (dim, area.max[0] - x), square.window.reach), dim);
        at[1] += if is_short { LINE } else { 3.2 } * small;
    }
    if square.is_direct {
        direct_names(canvas, square, (plane, theme));
    } else if plane.ellipse.is_some() {
        let ([x, y], radii) = (at.map(|c| c + small / 2.0), [0.6 * small, 0.35 * small]);
        canvas.line(marks::ellipse([x, y], radii, 0.0), true, solid(theme.ink(SPREAD).width, theme.stroke(SPREAD)));
        let left = at[0] + 1.8 * small;
        let words = shortened(SPREAD_NAME, text, area.max[0] - left);
        canvas.text([left, y], (Anchor::Start, Level::Middle), &words, text);
        at[1] += LINE * small;
    }
    let end = if is_below { area.max[1] } else { bottom };
    let below = Rect::new(at, [area.max[0] - at[0], end - at[1]]);
    scale(canvas, below, (plane, style));
}

/// A displacement as `(3.830, 0.750)`, to a thousandth as in sentences, or with fewer decimals where that is wider than `width` points; nothing
/// where so few would put it elsewhere in a plane that reaches so far.
fn place_within([u, v]: [f32; 2], (style, width): (Type, f32), reach: f32) -> String {
    let whole = format!("({}, {})", fixed(u.into(), 3), fixed(v.into(), 3));
    let is_exact = |decimals: usize| 0.5 * 10f32.powi(-(decimals as i32)) <= ROUNDED * reach;
    let coarse = |decimals: usize| {
        let unit = 10f32.powi(decimals as i32);
        // Adding 0 takes the sign from a zero.
        let rounded = |c: f32| format!("{:.decimals$}", (c * unit).round() / unit + 0.0).replace('-', "−");
        format!("({}, {})", rounded(u), rounded(v))
    };
    let rounded = [2, 1, 0].into_iter().filter(|decimals| is_exact(*decimals)).map(coarse);
    let fitting = std::iter::once(whole).chain(rounded).find(|words| style.width(words) <= width);
    fitting.unwrap_or_default()
}

/// The scale of the colors of a cost, as much of it as has room.
fn scale(canvas: &mut Canvas, area: Rect, (plane, style): (&Plane, ChartStyle)) {
    let Some((cost, [low, high])) = plane.cost.as_ref().and_then(|cost| Some((cost, cost.range()?))) else { return };
    let dim = Type::dim(style.theme);
    let (small, [left, top], room) = (dim.size, area.min, area.size()[0]);
    let bar = Rect::new([left, top + 0.2 * small], [room.min(10.0 * small), 0.6 * small]);
    let rows = [format!("{} to {}", number(low), number(high)), cost.unit.to_owned()];
    let fits = |row: usize| bar.max[1] + (1.6 + 1.4 * row as f32) * small <= area.max[1];
    if !fits(0) {
        return;
    }
    let shades = Grid::from_fn(128, 1, |x, _| style.colors.at((x as f32 / 127.0).sqrt()).0);
    canvas.add(Primitive::Image { pixels: Arc::new(shades), rect: bar });
    let place = (Anchor::Start, Level::Top);
    for (row, words) in rows.iter().enumerate().filter(|(row, _)| fits(*row)) {
        let y = bar.max[1] + (0.4 + 1.4 * row as f32) * small;
        canvas.text([left, y], place, &shortened(words, dim, room), dim);
    }
}

/// What the plane shows, for those who cannot see it.
pub fn summary(plane: &Plane) -> String {
    let points = plane.points.iter().map(|(name, _, [u, v])| format!("{name} at ({}, {})", number(*u), number(*v)));
    let lines = match plane.lines.len() {
        0 => "no lines".to_owned(),
        1 => "one line".to_owned(),
        count => format!("{count} lines"),
    };
    let nearest = plane.lines.iter().map(distance).reduce(f32::min);
    let lines = match nearest.filter(|_| plane.lines.len() == 1) {
        Some(nearest) => format!("{lines}, {} {} from the origin", number(nearest), plane.unit),
        None => lines,
    };
    let spread = plane.ellipse.as_ref().map(|spread| {
        let [long, short] = spread.radii.map(number);
        format!("one standard deviation {long} by {short} {}", plane.unit)
    });
    let cost = plane.cost.as_ref().and_then(|cost| {
        let [low, high] = cost.range()?.map(number);
        Some(format!("{} from {low} to {high} {}", cost.name, cost.unit))
    });
    let path = (plane.path.len() > 1).then(|| format!("a path of {} estimates", plane.path.len()));
    let groups = (!plane.groups.is_empty()).then(|| {
        let names: std::collections::BTreeSet<u32> = plane.groups.iter().map(|(group, _)| *group).collect();
        format!("{} displacements in {} groups", plane.groups.len(), names.len())
    });
    let rest = points.chain(spread).chain(cost).chain(path).chain(groups);
    [format!("{}: {lines}", plane.title)].into_iter().chain(rest).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::super::super::ColorMap;
    use super::super::{flat, texts};
    use super::*;

    fn plane() -> Plane {
        let line = Constraint { factors: [1.0, 0.0, -1.0], weight: 1.0, role: Role::Candidate };
        let points = vec![("normal flow", Role::Result, [1.0, -0.25])];
        let (title, lines) = ("Gradient constraint", vec![line]);
        let (center, path) = ([0.0; 2], Vec::new());
        Plane {
            title,
            unit: "px".into(),
            center,
            reach: 2.0,
            cost: None,
            groups: Vec::new(),
            lines,
            path,
            points,
            ellipse: None,
        }
    }

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    #[test]
    fn names_stand_beside_the_plane_where_that_is_asked_for() {
        let plane = plane();
        let named = |has_names_beside| {
            let data = Shown { plane: &plane, whose: "", window: None, has_names_beside };
            draw(data, Rect::new([0.0; 2], [560.0, 300.0]), style()).place.is_direct
        };
        assert_eq!([false, true].map(named), [true, false]);
    }

    #[test]
    fn the_plane_is_reported_in_words() {
        assert_eq!(
            summary(&plane()),
            "Gradient constraint: one line, 1 px from the origin, normal flow at (1, −0.250)"
        );
        let spread = Spread { center: [1.0, 0.0], radii: [0.5, 0.25], angle_rad: 0.0 };
        let description = summary(&Plane { ellipse: Some(spread), ..plane() });
        assert!(description.ends_with("one standard deviation 0.500 by 0.250 px"), "{description}");
    }

    #[test]
    fn the_line_stands_where_it_allows_displacements_and_the_axes_have_units() {
        let plane = plane();
        let data = Shown { plane: &plane, whose: "Normal flow", window: None, has_names_beside: false };
        let drawing = draw(data, Rect::new([0.0; 2], [400.0, 300.0]), style());
        let square = drawing.place;
        let primitives = flat(drawing);
        let ends = [[1.0, -2.0], [1.0, 2.0]].map(|uv| square.at(uv));
        let is_line = |points: &Vec<Point>| points.len() == 2 && ends.iter().all(|end| points.contains(end));
        assert!(primitives.iter().any(|p| matches!(p, Primitive::Polyline { points, .. } if is_line(points))));
        let words = texts(&primitives);
        for label in ["u, px →", "v, px ↓", "−2", "2", "Normal flow · Gradient constraint"] {
            assert!(words.iter().any(|word| word == label), "{label} is missing in {words:?}");
        }
    }

    #[test]
    fn few_points_carry_their_names_and_leave_the_plane_all_the_room() {
        let points = vec![("normal flow", Role::Result, [1.0, -0.25]), ("true flow", Role::Truth, [1.02, -0.2])];
        let few = Plane { points, ..plane() };
        let area = Rect::new([0.0; 2], [420.0, 400.0]);
        let drawn = |plane: &Plane, area: Rect| {
            draw(Shown { plane, whose: "", window: None, has_names_beside: false }, area, style())
        };
        let drawing = drawn(&few, area);
        let square = drawing.place;
        assert!(square.is_direct && square.rect.size()[0] > 0.75 * area.size()[0], "{:?}", square.rect);
        let names: Vec<_> = flat(drawing)
            .into_iter()
            .filter_map(|p| if let Primitive::Text(line) = p { Some(line) } else { None })
            .filter(|line| line.halo.is_some())
            .map(|line| (line.runs[0].text.clone() + &line.runs[1].text, super::super::canvas::covered(&line)))
            .collect();
        let [(first, a), (second, b)] = &names[..] else { panic!("{names:?}") };
        assert_eq!([first.as_str(), second], ["normal flow (1.000, −0.250)", "true flow (1.020, −0.200)"]);
        assert!(
            !a.grown(-2.0).meets(&b.grown(-2.0)) && [a, b].iter().all(|name| square.rect.grown(3.0).contains(name.min))
        );
        assert!(!drawn(&few, Rect::new([0.0; 2], [420.0, 200.0])).place.is_direct, "a small one has them beside it");
        let many = (0..12).map(|i| ("a further mean", Role::Result, [0.1 * i as f32, 0.0])).collect();
        assert!(!drawn(&Plane { points: many, ..plane() }, area).place.is_direct);
    }

    #[test]
    fn a_cost_with_gaps_says_why() {
        let cost = |known: fn(f32) -> bool| {
            let cost = |[u, v]: [f32; 2]| if known(u) { u * u + v * v } else { f32::NAN };
            let cost = PlaneCost::sampled(("mean squared difference", ""), ([0.0; 2], 2.0), 225, cost);
            Plane { cost: Some(cost), ..plane() }
        };
        let head = |plane: &Plane| {
            let data = Shown { plane, whose: "", window: None, has_names_beside: false };
            texts(&draw(data, Rect::new([0.0; 2], [640.0, 400.0]), style()).head).concat()
        };
        assert_eq!(head(&cost(|u| u > 0.0)), "Gradient constraint, blank where the window leaves the picture");
        assert_eq!(head(&cost(|_| true)), "Gradient constraint");
    }

    fn with_line_at(distance: f32) -> Plane {
        let line = Constraint { factors: [0.6, 0.8, -distance], weight: 1.0, role: Role::Candidate };
        Plane { lines: vec![line], ..plane() }
    }

    #[test]
    fn a_plane_contains_its_constraint_line_or_says_where_it_is() {
        let area = Rect::new([0.0; 2], [640.0, 400.0]);
        let drawn = |plane: &Plane| {
            let drawing =
                draw(Shown { plane, whose: "Normal flow", window: None, has_names_beside: false }, area, style());
            (drawing.place, texts(&drawing.head).concat(), flat(drawing))
        };
        for at in [0.5, 2.9, 7.5, -7.5] {
            let plane = with_line_at(at);
            let (square, head, _) = drawn(&plane);
            let ends = square.part(&plane.lines[0]).expect("the line is seen");
            assert!(
                ends.iter().all(|end| square.displacement(*end).is_some()
                    || square.rect.grown(0.1).meets(&Rect::new(*end, [0.01; 2])))
            );
            assert!(head.ends_with("Gradient constraint"), "the axes have the unit: {head}");
        }
        let plane = with_line_at(12.0);
        let (square, head, primitives) = drawn(&plane);
        assert_eq!(square.window.reach, 2.0, "it is too far to be shown with what the points show");
        assert_eq!(head, "Normal flow · Gradient constraint, constraint line 12 px from the origin, outside");
        let data = Shown { plane: &plane, whose: "", window: None, has_names_beside: false };
        let narrow = texts(&draw(data, Rect::new([0.0; 2], [330.0, 300.0]), style()).head).concat();
        assert_eq!(
            narrow, "constraint line 12 px from the origin, outside",
            "where the line is, and not a part of the title"
        );
        let tip = primitives.iter().find_map(|primitive| match primitive {
            Primitive::Polygon { points, .. } if points.len() == 3 => Some(points[0]),
            _ => None,
        });
        let [x, y] = tip.expect("an arrow at the edge");
        assert!(
            (y - square.rect.max[1]).abs() < 0.1 && x > square.rect.min[0] + 0.8 * square.rect.size()[0],
            "{x} {y}"
        );
        // Coming nearer to another place says so as well.
        let near = Window { center: [0.0; 2], reach: 0.25 };
        let data = Shown { plane: &with_line_at(1.0), whose: "", window: Some(near), has_names_beside: false };
        let words = texts(&draw(data, area, style()).head).concat();
        assert_eq!(words, "Gradient constraint, constraint line 1 px from the origin, outside");
    }

    #[test]
    fn a_cost_has_its_colors_its_scale_and_its_value_where_it_is_pointed_at() {
        let center = [6.5, -3.0];
        let of = |at: [f32; 2]| (at[0] - 6.5).powi(2) + (at[1] + 3.0).powi(2);
        let cost = PlaneCost::sampled(("cost", "gray levels²"), (center, 2.0), 1000, of);
        let plane = Plane { center, cost: Some(cost), lines: Vec::new(), path: vec![[5.0, -3.0], center], ..plane() };
        let data = Shown { plane: &plane, whose: "", window: None, has_names_beside: false };
        let area = Rect::new([0.0; 2], [640.0, 400.0]);
        let drawing = draw(data, area, style());
        let square = drawing.place;
        let description = texts(&head(data, &square, area, Some(center), style())).concat();
        assert_eq!(description, "(6.50, −3) px: 0 gray levels²");
        assert_eq!(plane.cost_at([6.5, -5.5]), None, "it ends where the plane ends");
        let primitives = flat(drawing);
        let images = primitives.iter().filter(|primitive| matches!(primitive, Primitive::Image { .. })).count();
        assert_eq!(images, 2, "the costs and their scale");
        let places = [[5.0, -3.0], center].map(|at| square.at(at));
        let is_path =
            |primitive: &&Primitive| matches!(primitive, Primitive::Polyline { points, .. } if *points == places);
        assert_eq!(primitives.iter().filter(is_path).count(), 2, "with its dark edge");
        assert!(texts(&primitives).contains(&"gray levels²".to_owned()));
        assert!(summary(&plane).contains("a path of 2 estimates"), "{}", summary(&plane));
    }

    #[test]
    fn means_of_clusters_have_the_colours_of_their_groups() {
        let groups = vec![(1, [-1.0, 0.0]), (1, [-1.2, 0.1]), (2, [-0.9, 0.1]), (2, [1.0, 0.5]), (2, [1.1, 0.4])];
        let points = vec![
            ("mean 1", Role::Result, [-1.1, 0.0]),
            ("mean 2", Role::Result, [1.0, 0.4]),
            ("inspected pixel", Role::Reference, [1.0, 0.5]),
        ];
        let plane = Plane { groups, points, lines: Vec::new(), ..plane() };
        let [first, second] = [1, 2].map(|group| Some(Color(region_color(group)).alpha(255)));
        assert_eq!(own_colors(&plane), [first, second, None]);
        let data = Shown { plane: &plane, whose: "Motion clustering", window: None, has_names_beside: false };
        let drawing = draw(data, Rect::new([0.0; 2], [640.0, 400.0]), style());
        let square = drawing.place;
        let colors = flat(drawing).into_iter().filter_map(|primitive| match primitive {
            Primitive::Disc { center, color, .. } if center == square.at([-1.1, 0.0]) => Some(color),
            _ => None,
        });
        assert_eq!(colors.last(), first, "above its rim");
        let seeds = Plane { groups: plane.groups.iter().map(|(_, uv)| (0, *uv)).collect(), ..plane };
        assert_eq!(own_colors(&seeds), [None; 3], "before the assignment there is no group");
    }

    #[test]
    fn each_mean_has_another_colour_however_large_its_group_is() {
        let few = (0..10).map(|i| (1, [0.01 * i as f32, 0.0]));
        // A third of the large group is nearer to the mean of the small one.
        let many = (0..1000).map(|i| (2, [if i % 3 == 0 { 0.2 } else { 0.8 }, 0.001 * i as f32]));
        let means = vec![("mean 1", Role::Result, [0.045, 0.0]), ("mean 2", Role::Result, [0.6, 0.5])];
        let both = Plane { groups: few.chain(many).collect(), points: means, ..plane() };
        let [first, second, third] = [1, 2, 3].map(|group| Some(Color(region_color(group)).alpha(255)));
        assert_eq!(own_colors(&both), [first, second]);
        let groups = vec![(1, [0.0; 2]), (3, [2.0, 0.0])];
        let points = ["mean 1", "mean 2", "mean 3"].map(|name| (name, Role::Result, [0.0; 2])).to_vec();
        let gap = Plane { groups, points, ..plane() };
        assert_eq!(own_colors(&gap), [first, None, third], "a group without displacements has no dots");
    }

    #[test]
    fn coming_nearer_keeps_the_displacement_under_the_pointer() {
        let plane = plane();
        let area = Rect::new([0.0; 2], [400.0, 300.0]);
        let at = [1.0, -0.25];
        let near = Window::whole(&plane).nearer(at, 8.0, &plane);
        let named = Named::of(&plane, has_room(&plane, area, Type::text(Theme::Dark)));
        let squares = [Window::whole(&plane), near].map(|window| Square::new(area, window, (12.0, named)));
        let places = squares.map(|square| square.at(at));
        assert!((0..2).all(|i| (places[0][i] - places[1][i]).abs() < 1e-2), "{places:?}");
        assert_eq!(near.reach, 0.25);
        assert_eq!(near.nearer(at, 1e9, &plane).reach, 2.0 / NEAREST);
        // The line through u = 1 is cut at the edges of what is seen.
        let part = squares[1].part(&plane.lines[0]).expect("it passes through");
        assert!((part[0][1] - part[1][1]).abs() > squares[1].rect.size()[1] - 0.1);
    }

    #[test]
    fn even_a_small_plane_has_more_than_its_middle_to_go_by() {
        let ticks = |side: f32, reach: f32| halves(&Axis::new([-reach, reach], [0.0, side]), 40.0);
        assert_eq!(ticks(90.0, 8.0), [-8.0, 0.0, 8.0]);
        assert_eq!(ticks(200.0, 1.0), [-1.0, -0.5, 0.0, 0.5, 1.0]);
    }
}
