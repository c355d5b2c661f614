//! Parameters that are placed on the picture: lines, a zone or several, a closed contour, points in frames.
//!
//! They are parsed, checked and moved here; in the window `ui/stage/placing.rs` handles the mouse.

use std::fmt;
use std::sync::Arc;

use super::{Kind, Parameter, Value};
use crate::base::words::px;
use crate::geometry::Bounds;

/// A line from one place of the picture to another, in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where it begins.
    pub from: [f32; 2],
    /// Where it ends.
    pub to: [f32; 2],
}

/// Any number of lines or rectangles, in the order in which they were placed.
#[derive(Clone, Debug, PartialEq)]
pub struct Several<T>(Arc<[T]>);

/// Any number of lines.
pub type Lines = Several<Line>;
/// Any number of rectangles by their outer edges, in px.
pub type Zones = Several<Bounds>;

impl<T> Several<T> {
    /// All of them.
    pub fn all(&self) -> &[T] {
        &self.0
    }
}

impl<T> Default for Several<T> {
    fn default() -> Self {
        Self(Arc::new([]))
    }
}

impl<T> FromIterator<T> for Several<T> {
    fn from_iter<I: IntoIterator<Item = T>>(all: I) -> Self {
        Self(all.into_iter().collect())
    }
}

impl<T: Copy> Several<T> {
    /// The same with one more.
    fn with(&self, next: T) -> Self {
        self.0.iter().copied().chain([next]).collect()
    }

    /// The same without number `index`.
    fn without(&self, index: usize) -> Self {
        self.0.iter().enumerate().filter(|(i, _)| *i != index).map(|(_, one)| *one).collect()
    }

    /// The same with `change` made to number `index`.
    fn changed(&self, index: usize, change: impl Fn(T) -> T) -> Self {
        self.0.iter().enumerate().map(|(i, one)| if i == index { change(*one) } else { *one }).collect()
    }
}

/// The corners of a closed polygon in px, the last joined to the first; none where no contour is placed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contour(Arc<[[f32; 2]]>);

impl FromIterator<[f32; 2]> for Contour {
    fn from_iter<I: IntoIterator<Item = [f32; 2]>>(corners: I) -> Self {
        Self(corners.into_iter().collect())
    }
}

impl Contour {
    /// Its corners in their order.
    pub fn corners(&self) -> &[[f32; 2]] {
        &self.0
    }

    /// The ellipse inside the rectangle between two opposite corners, as a polygon.
    fn ellipse(from: [f32; 2], to: [f32; 2]) -> Self {
        let (zone, turn) = (between(from, to), std::f32::consts::TAU / ELLIPSE_CORNERS as f32);
        let corner = |i: usize| {
            let (sin, cos) = (i as f32 * turn).sin_cos();
            let at = [0, 1].map(|k| zone.center()[k] + [cos, sin][k] * zone.size()[k] / 2.0);
            at.map(|c| (10.0 * c).round() / 10.0)
        };
        (0..ELLIPSE_CORNERS).map(corner).collect()
    }

    /// The same with one more corner, on the edge that is nearest to it.
    fn with(&self, at: [f32; 2]) -> Self {
        let (corners, count) = (self.corners(), self.0.len());
        let far = |i: &usize| apart_from(at, [corners[*i], corners[(*i + 1) % count]]);
        let Some(edge) = (0..count).min_by(|a, b| far(a).total_cmp(&far(b))) else { return self.clone() };
        corners[..=edge].iter().chain([&at]).chain(&corners[edge + 1..]).copied().collect()
    }

    /// The same without corner `index`; nothing if fewer than [`LEAST_CORNERS`] would be left.
    fn without(&self, index: usize) -> Self {
        let rest = self.0.iter().enumerate().filter(|(i, _)| *i != index);
        let rest: Self = rest.map(|(_, at)| *at).collect();
        if rest.0.len() < LEAST_CORNERS { Self::default() } else { rest }
    }
}

/// The distance of a place from a segment in px.
fn apart_from(at: [f32; 2], [from, to]: [[f32; 2]; 2]) -> f32 {
    let [along, way] = [at, to].map(|end| [0, 1].map(|i| end[i] - from[i]));
    let square = way[0] * way[0] + way[1] * way[1];
    let part = if square > 0.0 { ((along[0] * way[0] + along[1] * way[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (along[0] - part * way[0]).hypot(along[1] - part * way[1])
}

/// A place in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The frame of the clip, from 0.
    pub frame: usize,
    /// The place in px.
    pub at: [f32; 2],
}

/// Any number of places, by frame; those of one frame in the order in which they were placed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spots(Arc<[Spot]>);

impl Spots {
    /// All of them.
    pub fn all(&self) -> &[Spot] {
        &self.0
    }

    /// The places in a frame.
    pub fn of_frame(&self, frame: usize) -> impl Iterator<Item = [f32; 2]> {
        self.0.iter().filter(move |spot| spot.frame == frame).map(|spot| spot.at)
    }

    /// Where spot `index` of a frame is among all.
    fn place(&self, frame: usize, index: usize) -> Option<usize> {
        let of_frame = self.0.iter().enumerate().filter(|(_, spot)| spot.frame == frame);
        of_frame.map(|(i, _)| i).nth(index)
    }
}

impl FromIterator<Spot> for Spots {
    fn from_iter<I: IntoIterator<Item = Spot>>(spots: I) -> Self {
        let mut all: Vec<Spot> = spots.into_iter().collect();
        all.sort_by_key(|spot| spot.frame);
        Self(all.into())
    }
}

/// What a parameter that is placed on the picture looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// [`Lines`].
    Lines,
    /// A rectangle: [`Bounds`].
    Zone,
    /// Rectangles: [`Zones`].
    Zones,
    /// [`Contour`].
    Contour,
    /// [`Spots`].
    Spots,
}

impl Figure {
    /// What it is called in scripts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lines => "lines",
            Self::Zone => "zone",
            Self::Zones => "zones",
            Self::Contour => "contour",
            Self::Spots => "spots",
        }
    }

    /// Whether a click adds a point to it.
    pub fn grows_by_clicks(self) -> bool {
        matches!(self, Self::Contour | Self::Spots)
    }

    /// The allowed values in words.
    pub(super) fn allowed(self) -> &'static str {
        match self {
            Self::Lines => "x,y,x,y of two different points in px for each line, separated by spaces, or none",
            Self::Zone => "x,y,x,y of two opposite corners in px, or none",
            Self::Zones => "x,y,x,y of two opposite corners in px for each zone, separated by spaces, or none",
            Self::Contour => {
                "x,y in px for each of at least 4 corners of a closed polygon, separated by spaces, or none"
            }
            Self::Spots => "frame:x,y in px for each point, separated by spaces, or none",
        }
    }

    /// What was typed: `120,40,120,200`, `120,40,120,200 10,90,60,90`, `40,30 90,30 90,80 40,80`, `10:131.5,206 11:150,190`, `none`.
    pub(super) fn parse(self, text: &str) -> Option<Placed> {
        let text = text.trim();
        if text.is_empty() || text == NONE {
            return Some(self.none());
        }
        if self == Self::Spots {
            return text.split_whitespace().map(spot).collect::<Option<Spots>>().map(Placed::Spots);
        }
        // A space after a comma does not separate.
        let joined = text.split(',').map(str::trim).collect::<Vec<_>>().join(",");
        if self == Self::Contour {
            return joined.split_whitespace().map(numbers).collect::<Option<Contour>>().map(Placed::Contour);
        }
        if matches!(self, Self::Lines | Self::Zones) {
            return joined.split_whitespace().try_fold(self.none(), |all, one| {
                let [x, y, u, v] = numbers(one)?;
                Some(all.extended([x, y], [u, v]))
            });
        }
        let [x, y, u, v] = numbers(text)?;
        Some(self.spanned([x, y], [u, v]))
    }

    /// Nothing of this figure.
    pub fn none(self) -> Placed {
        match self {
            Self::Lines => Placed::Lines(Lines::default()),
            Self::Zone => Placed::Zone(None),
            Self::Zones => Placed::Zones(Zones::default()),
            Self::Contour => Placed::Contour(Contour::default()),
            Self::Spots => Placed::Spots(Spots::default()),
        }
    }

    /// The figure drawn by dragging from one point to another; none for spots.
    pub fn spanned(self, from: [f32; 2], to: [f32; 2]) -> Placed {
        match self {
            Self::Zone => Placed::Zone(Some(between(from, to))),
            Self::Contour => Placed::Contour(Contour::ellipse(from, to)),
            Self::Lines | Self::Zones => self.none().extended(from, to),
            Self::Spots => self.none(),
        }
    }
}

/// The value of a parameter that is placed on the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Placed {
    /// Any number of lines.
    Lines(Lines),
    /// A rectangle by its outer edges, if there is one.
    Zone(Option<Bounds>),
    /// Any number of rectangles by their outer edges.
    Zones(Zones),
    /// A closed polygon by its corners, if there is one.
    Contour(Contour),
    /// Any number of places.
    Spots(Spots),
}

/// How nothing is written.
const NONE: &str = "none";
/// Nothing is placed farther from the first pixel than this, in px.
const REACH_PX: f32 = 100_000.0;
/// A line or a zone is not smaller than this, in px.
const LEAST_PX: f32 = 0.5;
/// No more lines or zones than this.
const MOST_FIGURES: usize = 100;
/// A contour has at least this number of corners.
const LEAST_CORNERS: usize = 4;
/// No more corners of a contour than this.
const MOST_CORNERS: usize = 1000;
/// Corners of a contour that is drawn as an ellipse.
const ELLIPSE_CORNERS: usize = 16;
/// No more spots than this.
const MOST_SPOTS: usize = 100_000;

impl Placed {
    /// Its kind of figure.
    pub fn figure(&self) -> Figure {
        match self {
            Self::Lines(_) => Figure::Lines,
            Self::Zone(_) => Figure::Zone,
            Self::Zones(_) => Figure::Zones,
            Self::Contour(_) => Figure::Contour,
            Self::Spots(_) => Figure::Spots,
        }
    }

    /// Whether nothing is placed.
    pub fn is_none(&self) -> bool {
        *self == self.figure().none()
    }

    /// Its size in words: `160 px`, `2 lines`, `60 × 90 px`, `12 points`.
    pub fn words(&self) -> String {
        match self {
            Self::Lines(Several(all)) if !all.is_empty() => match &all[..] {
                [line] => format!("{} px", px(apart(line))),
                lines => format!("{} lines", lines.len()),
            },
            Self::Zone(Some(zone)) => size(zone),
            Self::Zones(Several(all)) if !all.is_empty() => match &all[..] {
                [zone] => size(zone),
                zones => format!("{} zones", zones.len()),
            },
            Self::Contour(Contour(all)) if !all.is_empty() => format!("{} corners", all.len()),
            Self::Spots(Spots(all)) if all.len() == 1 => "1 point".into(),
            Self::Spots(Spots(all)) if !all.is_empty() => format!("{} points", all.len()),
            _ => NONE.into(),
        }
    }

    /// The size of a rectangle that is too small to be visible, in words.
    pub(super) fn too_small(&self) -> Option<String> {
        let Self::Zone(Some(zone)) = self else { return None };
        zone.size().iter().any(|side| *side < LEAST_PX).then(|| size(zone))
    }

    /// Whether it is valid: near the picture, and not too small to be visible.
    pub(super) fn is_sound(&self) -> bool {
        let is_near = |place: [f32; 2]| place.iter().all(|c| c.abs() <= REACH_PX);
        let is_line = |line: &Line| is_near(line.from) && is_near(line.to) && apart(line) >= LEAST_PX;
        let is_zone =
            |zone: &Bounds| is_near(zone.min) && is_near(zone.max) && zone.size().iter().all(|side| *side >= LEAST_PX);
        match self {
            Self::Lines(Several(all)) => all.len() <= MOST_FIGURES && all.iter().all(is_line),
            Self::Zone(zone) => zone.iter().all(is_zone),
            Self::Zones(Several(all)) => all.len() <= MOST_FIGURES && all.iter().all(is_zone),
            Self::Contour(Contour(all)) => {
                let is_counted = all.is_empty() || (LEAST_CORNERS..=MOST_CORNERS).contains(&all.len());
                is_counted && all.iter().all(|at| is_near(*at))
            }
            Self::Spots(Spots(all)) => all.len() <= MOST_SPOTS && all.iter().all(|spot| is_near(spot.at)),
        }
    }

    /// The places by which it can be moved in a frame: ends, corners, the spots of that frame.
    pub fn handles(&self, frame: usize) -> Vec<[f32; 2]> {
        match self {
            Self::Lines(Several(all)) => all.iter().flat_map(|line| [line.from, line.to]).collect(),
            Self::Zone(zone) => zone.iter().flat_map(corners).collect(),
            Self::Zones(Several(all)) => all.iter().flat_map(corners).collect(),
            Self::Contour(contour) => contour.corners().to_vec(),
            Self::Spots(spots) => spots.of_frame(frame).collect(),
        }
    }

    /// The same with handle `index` of a frame at another place.
    #[must_use]
    pub fn moved(&self, frame: usize, index: usize, to: [f32; 2]) -> Self {
        match self {
            Self::Lines(lines) => Self::Lines(lines.changed(index / 2, |line| match index % 2 {
                0 => Line { from: to, ..line },
                _ => Line { to, ..line },
            })),
            // The opposite corner stays.
            Self::Zone(zone) => Self::Zone(zone.map(|zone| between(corners(&zone)[(index + 2) % 4], to))),
            Self::Zones(zones) => {
                Self::Zones(zones.changed(index / 4, |zone| between(corners(&zone)[(index + 2) % 4], to)))
            }
            Self::Contour(Contour(all)) => {
                let corner = |(i, at): (usize, &[f32; 2])| if i == index { to } else { *at };
                Self::Contour(all.iter().enumerate().map(corner).collect())
            }
            Self::Spots(spots) => {
                let mut all = spots.0.to_vec();
                if let Some(i) = spots.place(frame, index) {
                    all[i].at = to;
                }
                Self::Spots(Spots(all.into()))
            }
        }
    }

    /// The same without handle `index` of a frame: a spot or a corner of a contour is gone, and so is the whole of any other figure with
    /// this handle.
    #[must_use]
    pub fn without(&self, frame: usize, index: usize) -> Self {
        let spots = match self {
            Self::Spots(spots) => spots,
            Self::Lines(lines) => return Self::Lines(lines.without(index / 2)),
            Self::Zones(zones) => return Self::Zones(zones.without(index / 4)),
            Self::Contour(contour) => return Self::Contour(contour.without(index)),
            Self::Zone(_) => return self.figure().none(),
        };
        let gone = spots.place(frame, index);
        let rest = spots.0.iter().enumerate().filter(|(i, _)| Some(*i) != gone);
        Self::Spots(Spots(rest.map(|(_, spot)| *spot).collect()))
    }

    /// The same with what is drawn by dragging from one point to another: one more line or zone, and another one where there is only one.
    #[must_use]
    pub fn extended(&self, from: [f32; 2], to: [f32; 2]) -> Self {
        match self {
            Self::Lines(lines) => Self::Lines(lines.with(Line { from, to })),
            Self::Zones(zones) => Self::Zones(zones.with(between(from, to))),
            Self::Zone(_) | Self::Contour(_) | Self::Spots(_) => self.figure().spanned(from, to),
        }
    }

    /// The same with one more spot, or corner of a contour; any other figure stays.
    #[must_use]
    pub fn with(&self, spot: Spot) -> Self {
        match self {
            Self::Spots(spots) => Self::Spots(spots.0.iter().copied().chain([spot]).collect()),
            Self::Contour(contour) => Self::Contour(contour.with(spot.at)),
            other => other.clone(),
        }
    }
}

/// The rectangle between two opposite corners.
fn between(from: [f32; 2], to: [f32; 2]) -> Bounds {
    Bounds { min: [0, 1].map(|i| from[i].min(to[i])), max: [0, 1].map(|i| from[i].max(to[i])) }
}

/// The size of a rectangle in words.
fn size(zone: &Bounds) -> String {
    let [width, height] = zone.size().map(px);
    format!("{width} × {height} px")
}

/// How long a line is, in px.
fn apart(Line { from, to }: &Line) -> f32 {
    (to[0] - from[0]).hypot(to[1] - from[1])
}

/// The corners of a rectangle, each beside the next.
fn corners(zone: &Bounds) -> [[f32; 2]; 4] {
    let Bounds { min, max } = *zone;
    [min, [max[0], min[1]], max, [min[0], max[1]]]
}

fn numbers<const N: usize>(text: &str) -> Option<[f32; N]> {
    let all: Option<Vec<f32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    all?.try_into().ok()
}

fn spot(text: &str) -> Option<Spot> {
    let (frame, at) = text.split_once(':')?;
    Some(Spot { frame: frame.parse().ok()?, at: numbers(at)? })
}

impl fmt::Display for Placed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut write_all = |all: &mut dyn Iterator<Item = [[f32; 2]; 2]>| {
            all.enumerate()
                .try_for_each(|(i, [[x, y], [u, v]])| write!(f, "{}{x},{y},{u},{v}", if i == 0 { "" } else { " " }))
        };
        match self {
            Self::Lines(Several(all)) if !all.is_empty() => write_all(&mut all.iter().map(|line| [line.from, line.to])),
            Self::Zone(Some(zone)) => write_all(&mut [[zone.min, zone.max]].into_iter()),
            Self::Zones(Several(all)) if !all.is_empty() => write_all(&mut all.iter().map(|zone| [zone.min, zone.max])),
            Self::Contour(Contour(all)) if !all.is_empty() => {
                all.iter().enumerate().try_for_each(|(i, [x, y])| write!(f, "{}{x},{y}", if i == 0 { "" } else { " " }))
            }
            Self::Spots(Spots(all)) if !all.is_empty() => {
                for (i, Spot { frame, at: [x, y] }) in all.iter().enumerate() {
                    write!(f, "{}{frame}:{x},{y}", if i == 0 { "" } else { " " })?;
                }
                Ok(())
            }
            _ => f.write_str(NONE),
        }
    }
}

macro_rules! placed {
    ($($t:ty => $figure:ident),*) => {$(
        impl Parameter for $t {
            type Range = ();
            fn kind((): ()) -> Kind {
                Kind::Placed(Figure::$figure)
            }
            fn to_value(&self) -> Value {
                Value::Placed(Placed::$figure(self.clone()))
            }
            fn from_value(value: Value) -> Option<Self> {
                if let Value::Placed(Placed::$figure(placed)) = value { Some(placed) } else { None }
            }
        }
    )*};
}
placed!(Lines => Lines, Option<Bounds> => Zone, Zones => Zones, Contour => Contour, Spots => Spots);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    crate::params! {
        /// Everything that can be placed.
        pub struct All {
            /// Lines.
            lines: Lines = Lines::default();
            /// A zone.
            zone: Option<Bounds> = None;
            /// Zones.
            zones: Zones = Zones::default();
            /// A contour.
            contour: Contour = Contour::default();
            /// Places.
            clicks: Spots = Spots::default();
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let mut all = All::default();
        for (name, text, written) in [
            ("lines", "1.5, 2, 3,-4.25", "1.5,2,3,-4.25"),
            ("lines", " 1,2 , 3,4  5,6,7,-8", "1,2,3,4 5,6,7,-8"),
            ("zones", "30,40,10,20 1,2,3,4", "10,20,30,40 1,2,3,4"),
            ("zone", "30,40,10,20", "10,20,30,40"),
            ("contour", "1,2 3.5, 4  5,6 -7,8", "1,2 3.5,4 5,6 -7,8"),
            ("clicks", "12:3,4  7:1.5,2 12:5,6", "7:1.5,2 12:3,4 12:5,6"),
        ] {
            all.set(name, "none").unwrap();
            assert_eq!(all.get(name).unwrap().to_string(), "none");
            all.set(name, text).unwrap();
            let now = all.get(name).unwrap();
            assert_eq!(now.to_string(), written);
            all.set(name, &now.to_string()).unwrap();
            assert_eq!(all.get(name).unwrap(), now);
        }
        assert_eq!((all.lines.all()[1].to, all.zone.unwrap().min), ([7.0, -8.0], [10.0, 20.0]));
        assert_eq!(all.clicks.of_frame(12).collect::<Vec<_>>(), [[3.0, 4.0], [5.0, 6.0]]);
        all.set("lines", "none").unwrap();
        assert_eq!(all.lines.all(), []);
    }

    #[test]
    fn what_cannot_be_placed_is_refused() {
        let mut all = All::default();
        for (name, text) in [
            ("lines", "1,2,3"),
            ("lines", "1,2,1,2"),
            ("lines", "1,2,3,4 5,6,5,6"),
            ("lines", "1,2,3,4 5,6,7"),
            ("lines", "nan,2,3,4"),
            ("zones", "1,2,3,4 1,2,1,9"),
            ("zone", "1,2,inf,9"),
            ("zone", "1:2,3"),
            ("contour", "1,2 3,4 5,6"),
            ("contour", "1,2 3,4 5,6 7"),
            ("contour", "1,2 3,4 5,6 1e9,8"),
            ("clicks", "1,2,3,4"),
            ("clicks", "3:1"),
            ("clicks", "-1:2,3"),
            ("clicks", "1:2,1e9"),
        ] {
            let refusal = all.set(name, text).unwrap_err().to_string();
            assert!(refusal.starts_with(name) && refusal.contains("in px"), "{refusal}");
            assert_eq!(all.get(name).unwrap().to_string(), "none");
        }
        let flat = all.set("zone", "1,2,1,9").unwrap_err().to_string();
        assert_eq!(flat, "zone has 0 × 7 px: its corners must differ in x and in y");
    }

    #[test]
    fn handles_move_what_they_belong_to() {
        let line = Figure::Lines.spanned([1.0, 2.0], [3.0, 4.0]);
        assert_eq!(line.moved(0, 1, [9.0, 8.0]), Figure::Lines.spanned([1.0, 2.0], [9.0, 8.0]));
        let lines = line.extended([5.0, 6.0], [7.0, 8.0]);
        assert_eq!((lines.to_string(), lines.words()), ("1,2,3,4 5,6,7,8".into(), "2 lines".into()));
        assert_eq!(lines.moved(0, 2, [0.0, 0.0]).to_string(), "1,2,3,4 0,0,7,8");
        assert_eq!((lines.without(0, 3), lines.without(0, 0).to_string()), (line.clone(), "5,6,7,8".into()));
        let zones = Figure::Zones.spanned([0.0, 0.0], [4.0, 4.0]).extended([9.0, 9.0], [6.0, 7.0]);
        assert_eq!((zones.to_string(), zones.handles(0).len()), ("0,0,4,4 6,7,9,9".into(), 8));
        assert_eq!(zones.moved(0, 6, [12.0, 10.0]).to_string(), "0,0,4,4 6,7,12,10");
        assert_eq!(zones.without(0, 1).to_string(), "6,7,9,9");
        let zone = Figure::Zone.spanned([0.0, 0.0], [10.0, 6.0]);
        for (index, corner) in zone.handles(0).into_iter().enumerate() {
            let to = corner.map(|c| c + 1.0);
            let moved = zone.moved(0, index, to);
            assert!(moved.handles(0).contains(&to), "corner {index} of {moved}");
            assert!(moved.handles(0).contains(&zone.handles(0)[(index + 2) % 4]), "the opposite one stays");
        }
        let contour = Figure::Contour.spanned([0.0, 0.0], [20.0, 10.0]);
        assert_eq!(
            (contour.handles(0)[0], contour.handles(0)[4], contour.words()),
            ([20.0, 5.0], [10.0, 10.0], "16 corners".into())
        );
        let more = contour.with(Spot { frame: 3, at: [10.0, 12.0] });
        assert_eq!(more.handles(0).iter().position(|at| *at == [10.0, 12.0]), Some(4), "on one of the nearest edges");
        assert_eq!((more.without(0, 4), more.moved(0, 4, [9.0, 9.0]).handles(0)[4]), (contour.clone(), [9.0, 9.0]));
        let few = (0..12).fold(contour.clone(), |few, _| few.without(0, 0));
        assert_eq!((few.handles(0).len(), few.without(0, 0)), (4, Figure::Contour.none()));
        assert_eq!(Figure::Contour.none().with(Spot { frame: 0, at: [1.0; 2] }), Figure::Contour.none());
        let spot = |frame, x| Spot { frame, at: [x, 0.0] };
        let spots =
            [spot(4, 1.0), spot(2, 5.0), spot(4, 2.0)].into_iter().fold(Figure::Spots.none(), |all, s| all.with(s));
        assert_eq!(spots.to_string(), "2:5,0 4:1,0 4:2,0");
        assert_eq!(spots.moved(4, 1, [7.0, 7.0]).to_string(), "2:5,0 4:1,0 4:7,7");
        assert_eq!(spots.without(4, 0).to_string(), "2:5,0 4:2,0");
        assert_eq!((spots.without(2, 3), line.without(0, 0)), (spots.clone(), Figure::Lines.none()));
    }
}
