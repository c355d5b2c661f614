//! Parameters that are placed on the picture: a line, a zone, points in frames.

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
    /// A [`Line`].
    Line,
    /// A rectangle: [`Bounds`].
    Zone,
    /// [`Spots`].
    Spots,
}

impl Figure {
    /// What it is called in scripts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Zone => "zone",
            Self::Spots => "spots",
        }
    }

    /// The allowed values in words.
    pub(super) fn allowed(self) -> &'static str {
        match self {
            Self::Line => "x,y,x,y of two different points in px, or none",
            Self::Zone => "x,y,x,y of two opposite corners in px, or none",
            Self::Spots => "frame:x,y in px for each point, separated by spaces, or none",
        }
    }

    /// What was typed: `120,40,120,200`, `10:131.5,206 11:150,190`, `none`.
    pub(super) fn parse(self, text: &str) -> Option<Placed> {
        let text = text.trim();
        if text.is_empty() || text == NONE {
            return Some(self.none());
        }
        if self == Self::Spots {
            return text.split_whitespace().map(spot).collect::<Option<Spots>>().map(Placed::Spots);
        }
        let [x, y, u, v] = numbers(text)?;
        Some(self.spanned([x, y], [u, v]))
    }

    /// Nothing of this figure.
    pub fn none(self) -> Placed {
        match self {
            Self::Line => Placed::Line(None),
            Self::Zone => Placed::Zone(None),
            Self::Spots => Placed::Spots(Spots::default()),
        }
    }

    /// The figure drawn by dragging from one point to another; none for spots.
    pub fn spanned(self, from: [f32; 2], to: [f32; 2]) -> Placed {
        match self {
            Self::Line => Placed::Line(Some(Line { from, to })),
            Self::Zone => {
                let (min, max) = ([0, 1].map(|i| from[i].min(to[i])), [0, 1].map(|i| from[i].max(to[i])));
                Placed::Zone(Some(Bounds { min, max }))
            }
            Self::Spots => self.none(),
        }
    }
}

/// The value of a parameter that is placed on the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Placed {
    /// A line, if there is one.
    Line(Option<Line>),
    /// A rectangle by its outer edges, if there is one.
    Zone(Option<Bounds>),
    /// Any number of places.
    Spots(Spots),
}

/// How nothing is written.
const NONE: &str = "none";
/// Nothing is placed farther from the first pixel than this, in px.
const REACH_PX: f32 = 100_000.0;
/// A line or a zone is not smaller than this, in px.
const LEAST_PX: f32 = 0.5;
/// No more spots than this.
const MOST_SPOTS: usize = 100_000;

impl Placed {
    /// Its kind of figure.
    pub fn figure(&self) -> Figure {
        match self {
            Self::Line(_) => Figure::Line,
            Self::Zone(_) => Figure::Zone,
            Self::Spots(_) => Figure::Spots,
        }
    }

    /// Whether nothing is placed.
    pub fn is_none(&self) -> bool {
        *self == self.figure().none()
    }

    /// Its size in words: `160 px`, `60 × 90 px`, `12 points`.
    pub fn words(&self) -> String {
        match self {
            Self::Line(Some(line)) => format!("{} px", px(apart(line))),
            Self::Zone(Some(zone)) => {
                let [width, height] = zone.size().map(px);
                format!("{width} × {height} px")
            }
            Self::Spots(Spots(all)) if all.len() == 1 => "1 point".into(),
            Self::Spots(Spots(all)) if !all.is_empty() => format!("{} points", all.len()),
            _ => NONE.into(),
        }
    }

    /// Whether it is valid: near the picture, and not too small to be visible.
    pub(super) fn is_sound(&self) -> bool {
        let is_near = |place: [f32; 2]| place.iter().all(|c| c.abs() <= REACH_PX);
        match self {
            Self::Line(None) | Self::Zone(None) => true,
            Self::Line(Some(line)) => is_near(line.from) && is_near(line.to) && apart(line) >= LEAST_PX,
            Self::Zone(Some(zone)) => {
                is_near(zone.min) && is_near(zone.max) && zone.size().iter().all(|side| *side >= LEAST_PX)
            }
            Self::Spots(Spots(all)) => all.len() <= MOST_SPOTS && all.iter().all(|spot| is_near(spot.at)),
        }
    }

    /// The places by which it can be moved in a frame: ends, corners, the spots of that frame.
    pub fn handles(&self, frame: usize) -> Vec<[f32; 2]> {
        match self {
            Self::Line(line) => line.iter().flat_map(|line| [line.from, line.to]).collect(),
            Self::Zone(zone) => zone.iter().flat_map(corners).collect(),
            Self::Spots(spots) => spots.of_frame(frame).collect(),
        }
    }

    /// The same with handle `index` of a frame at another place.
    #[must_use]
    pub fn moved(&self, frame: usize, index: usize, to: [f32; 2]) -> Self {
        match self {
            Self::Line(Some(line)) if index == 0 => Self::Line(Some(Line { from: to, ..*line })),
            Self::Line(Some(line)) => Self::Line(Some(Line { to, ..*line })),
            // The opposite corner stays.
            Self::Zone(Some(zone)) => Figure::Zone.spanned(corners(zone)[(index + 2) % 4], to),
            Self::Line(None) | Self::Zone(None) => self.clone(),
            Self::Spots(spots) => {
                let mut all = spots.0.to_vec();
                if let Some(i) = spots.place(frame, index) {
                    all[i].at = to;
                }
                Self::Spots(Spots(all.into()))
            }
        }
    }

    /// The same without handle `index` of a frame: a spot is gone, and so is the whole of any other figure.
    #[must_use]
    pub fn without(&self, frame: usize, index: usize) -> Self {
        let Self::Spots(spots) = self else { return self.figure().none() };
        let gone = spots.place(frame, index);
        let rest = spots.0.iter().enumerate().filter(|(i, _)| Some(*i) != gone);
        Self::Spots(Spots(rest.map(|(_, spot)| *spot).collect()))
    }

    /// The same with one more spot; any other figure stays.
    #[must_use]
    pub fn with(&self, spot: Spot) -> Self {
        match self {
            Self::Spots(spots) => Self::Spots(spots.0.iter().copied().chain([spot]).collect()),
            other => other.clone(),
        }
    }
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
        match self {
            Self::Line(Some(Line { from: [x, y], to: [u, v] })) => write!(f, "{x},{y},{u},{v}"),
            Self::Zone(Some(Bounds { min: [x, y], max: [u, v] })) => write!(f, "{x},{y},{u},{v}"),
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
placed!(Option<Line> => Line, Option<Bounds> => Zone, Spots => Spots);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    crate::params! {
        /// Everything that can be placed.
        pub struct All {
            /// A line.
            line: Option<Line> = None;
            /// A zone.
            zone: Option<Bounds> = None;
            /// Places.
            clicks: Spots = Spots::default();
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let mut all = All::default();
        for (name, text, written) in [
            ("line", "1.5, 2, 3,-4.25", "1.5,2,3,-4.25"),
            ("zone", "30,40,10,20", "10,20,30,40"),
            ("clicks", "12:3,4  7:1.5,2 12:5,6", "7:1.5,2 12:3,4 12:5,6"),
        ] {
            assert_eq!(all.get(name).unwrap().to_string(), "none");
            all.set(name, text).unwrap();
            let now = all.get(name).unwrap();
            assert_eq!(now.to_string(), written);
            all.set(name, &now.to_string()).unwrap();
            assert_eq!(all.get(name).unwrap(), now);
        }
        assert_eq!((all.line.unwrap().to, all.zone.unwrap().min), ([3.0, -4.25], [10.0, 20.0]));
        assert_eq!(all.clicks.of_frame(12).collect::<Vec<_>>(), [[3.0, 4.0], [5.0, 6.0]]);
        all.set("line", "none").unwrap();
        assert_eq!(all.line, None);
    }

    #[test]
    fn what_cannot_be_placed_is_refused() {
        let mut all = All::default();
        for (name, text) in [
            ("line", "1,2,3"),
            ("line", "1,2,1,2"),
            ("line", "nan,2,3,4"),
            ("zone", "1,2,1,9"),
            ("zone", "1,2,inf,9"),
            ("zone", "1:2,3"),
            ("clicks", "1,2,3,4"),
            ("clicks", "3:1"),
            ("clicks", "-1:2,3"),
            ("clicks", "1:2,1e9"),
        ] {
            let refusal = all.set(name, text).unwrap_err().to_string();
            assert!(refusal.starts_with(name) && refusal.contains("in px"), "{refusal}");
            assert_eq!(all.get(name).unwrap().to_string(), "none");
        }
    }

    #[test]
    fn handles_move_what_they_belong_to() {
        let line = Figure::Line.spanned([1.0, 2.0], [3.0, 4.0]);
        assert_eq!(line.moved(0, 1, [9.0, 8.0]), Figure::Line.spanned([1.0, 2.0], [9.0, 8.0]));
        let zone = Figure::Zone.spanned([0.0, 0.0], [10.0, 6.0]);
        for (index, corner) in zone.handles(0).into_iter().enumerate() {
            let to = corner.map(|c| c + 1.0);
            let moved = zone.moved(0, index, to);
            assert!(moved.handles(0).contains(&to), "corner {index} of {moved}");
            assert!(moved.handles(0).contains(&zone.handles(0)[(index + 2) % 4]), "the opposite one stays");
        }
        let spot = |frame, x| Spot { frame, at: [x, 0.0] };
        let spots =
            [spot(4, 1.0), spot(2, 5.0), spot(4, 2.0)].into_iter().fold(Figure::Spots.none(), |all, s| all.with(s));
        assert_eq!(spots.to_string(), "2:5,0 4:1,0 4:2,0");
        assert_eq!(spots.moved(4, 1, [7.0, 7.0]).to_string(), "2:5,0 4:1,0 4:7,7");
        assert_eq!(spots.without(4, 0).to_string(), "2:5,0 4:2,0");
        assert_eq!((spots.without(2, 3), line.without(0, 0)), (spots.clone(), Figure::Line.none()));
    }
}
