//! Drawings of lines, nodes and words in a plane of their own: trees, rings.

use super::Role;

/// A drawing in coordinates of its own: x to the right, y down, from 0 to its size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagram {
    /// Title: `Tree of hypotheses`.
    pub title: &'static str,
    /// Width and height.
    pub size: [f32; 2],
    /// Whether both axes have one scale, as a circle needs.
    pub is_isotropic: bool,
    /// The lines, back to front, below nodes and words.
    pub lines: Vec<DiagramLine>,
    /// The nodes, back to front.
    pub nodes: Vec<Node>,
    /// The words.
    pub words: Vec<Words>,
    /// What it shows in one line, for readers without the picture.
    pub summary: String,
}

/// A line of a [`Diagram`].
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramLine {
    /// Its role.
    pub role: Role,
    /// Its width in points.
    pub width: f32,
    /// Whether it steps back, as what was rejected.
    pub is_faded: bool,
    /// Its corners.
    pub points: Vec<[f32; 2]>,
}

/// A node of a [`Diagram`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Its role.
    pub role: Role,
    /// Whether it steps back.
    pub is_faded: bool,
    /// Its centre.
    pub at: [f32; 2],
    /// Its radius in points.
    pub radius: f32,
}

/// Words of a [`Diagram`].
#[derive(Clone, Debug, PartialEq)]
pub struct Words {
    /// The words.
    pub text: String,
    /// Their role; none for the colour of dim text.
    pub role: Option<Role>,
    /// The middle of their height, and their start, middle or end as `side` is 1, 0 or −1.
    pub at: [f32; 2],
    /// The side of their place on which they stand: 1 to the right, 0 centred, −1 to the left.
    pub side: i8,
}
