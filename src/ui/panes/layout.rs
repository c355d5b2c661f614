//! The panes, where they lie at first, and which of them are folded away.

use eframe::egui;
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use motionscope_core::scene::Chart;
use serde::{Deserialize, Serialize};

/// A pane of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Pane {
    /// The pictures and the marks over them.
    Stage,
    /// Clip, estimator and their parameters.
    Parameters,
    /// Why the last event happened.
    Why,
    /// The cost surface as a heat map.
    Surface,
    /// The cost surface in three dimensions.
    Surface3d,
    /// Quantities over steps.
    Plot,
    /// Small pictures with their numbers.
    Numbers,
    /// How often each displacement was found.
    Histogram,
}

impl Pane {
    /// Every pane.
    pub const ALL: [Pane; 8] = [
        Pane::Stage,
        Pane::Parameters,
        Pane::Why,
        Pane::Surface,
        Pane::Surface3d,
        Pane::Plot,
        Pane::Numbers,
        Pane::Histogram,
    ];

    /// Whether it is one of those below the stage.
    pub fn is_chart(self) -> bool {
        !matches!(self, Pane::Stage | Pane::Parameters | Pane::Why)
    }

    /// What stands in it: what steps tell, as far as they do.
    pub fn charts(self) -> &'static [Chart] {
        match self {
            Pane::Stage | Pane::Parameters | Pane::Why => &[],
            Pane::Surface => &[Chart::Surface, Chart::Plane],
            Pane::Surface3d => &[Chart::Surface, Chart::Stack],
            Pane::Plot => &[Chart::Series],
            Pane::Numbers => &[Chart::Tiles, Chart::Matrices],
            Pane::Histogram => &[Chart::Histogram],
        }
    }

    /// Its name.
    pub fn title(self) -> &'static str {
        match self {
            Pane::Stage => "Stage",
            Pane::Parameters => "Parameters",
            Pane::Why => "Explanation",
            Pane::Surface => "Cost surface",
            Pane::Surface3d => "3-D",
            Pane::Plot => "Plot",
            Pane::Numbers => "Numbers",
            Pane::Histogram => "Histogram",
        }
    }
}

/// What is folded away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Folded {
    /// The parameters.
    pub parameters: bool,
    /// The explanation.
    pub why: bool,
    /// The panes below the stage.
    pub charts: bool,
    /// All but stage and explanation.
    #[serde(skip)]
    pub lecture: bool,
}

/// Widths of the window, in letters of its type, below which parameters wait until they are asked for.
const WIDE_LETTERS: f32 = 90.0;
/// Heights below which the charts do.
const HIGH_LETTERS: f32 = 46.0;
/// Width of the explanation where there is little room: a formula fits.
const WHY_LETTERS: f32 = 22.5;

/// Where the window is small for its type: a small screen, or a projector's large letters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Tight {
    /// Too narrow for three panes beside each other.
    pub width: bool,
    /// Too low for two above each other.
    pub height: bool,
    /// Size of the type in whole points.
    type_pt: u32,
}

impl Tight {
    /// Whether the panes' widths are to be shared out anew after `before`.
    pub fn differs(self, before: Self) -> bool {
        self.width != before.width || self.width && self.type_pt != before.type_pt
    }

    /// What a window of `size` is with type of `body_pt`.
    pub fn of(size: egui::Vec2, body_pt: f32) -> Self {
        let letters = size / body_pt.max(1.0);
        Self { width: letters.x < WIDE_LETTERS, height: letters.y < HIGH_LETTERS, type_pt: body_pt.round() as u32 }
    }
}

/// Gives the explanation the width that formulas need in a window of `width_pt`, or its usual share if that is roomy.
pub fn share_out(tree: &mut Tree<Pane>, tight: Tight, width_pt: f32, body_pt: f32) {
    let usual = 0.25;
    let needed = if tight.width { (WHY_LETTERS * body_pt / width_pt.max(1.0)).clamp(usual, 0.42) } else { usual };
    let Some(root) = tree.root() else { return };
    let why = tree.tiles.find_pane(&Pane::Why).and_then(|pane| tree.tiles.parent_of(pane));
    let Some(Tile::Container(Container::Linear(row))) = tree.tiles.get_mut(root) else { return };
    let others: f32 = row.children.iter().filter(|tile| Some(**tile) != why).map(|tile| row.shares[*tile]).sum();
    let Some(why) = why.filter(|why| row.children.contains(why)) else { return };
    let seen = if tight.width { others - row.children.first().map_or(0.0, |first| row.shares[*first]) } else { others };
    row.shares.set_share(why, needed / (1.0 - needed) * seen);
}

impl Folded {
    /// Whether `pane` can be seen.
    pub fn shows(self, pane: Pane) -> bool {
        match pane {
            Pane::Stage => true,
            Pane::Why => self.lecture || !self.why,
            Pane::Parameters => !self.lecture && !self.parameters,
            _ => !self.lecture && !self.charts,
        }
    }
}

/// Panes where they lie at first: parameters left, explanation right, stage in the middle over the charts.
pub fn tree() -> Tree<Pane> {
    let mut tiles = Tiles::default();
    let mut tabs = |panes: &[Pane]| {
        let panes = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
        tiles.insert_tab_tile(panes)
    };
    let (stage, parameters, why) = (tabs(&[Pane::Stage]), tabs(&[Pane::Parameters]), tabs(&[Pane::Why]));
    let flat = tabs(&[Pane::Surface, Pane::Numbers, Pane::Histogram]);
    let deep = tabs(&[Pane::Surface3d, Pane::Plot]);
    let charts = tiles.insert_container(Linear::new_binary(LinearDir::Horizontal, [flat, deep], 0.5));
    let middle = tiles.insert_container(Linear::new_binary(LinearDir::Vertical, [stage, charts], 0.62));
    let mut row = Linear::new(LinearDir::Horizontal, vec![parameters, middle, why]);
    for (tile, share) in [(parameters, 0.19), (middle, 0.56), (why, 0.25)] {
        row.shares.set_share(tile, share);
    }
    let root = tiles.insert_container(row);
    Tree::new(egui::Id::unique("panes"), root, tiles)
}

/// Shows and hides panes as `folded` says, and of the charts only those that are `offered`.
pub fn fold(tree: &mut Tree<Pane>, folded: Folded, offered: impl Fn(Pane) -> bool) {
    for pane in Pane::ALL {
        if let Some(tile) = tree.tiles.find_pane(&pane) {
            tree.set_visible(tile, folded.shows(pane) && (!pane.is_chart() || offered(pane)));
        }
    }
}

/// Whether every pane is in the tree: a layout of an older version may lack one.
pub fn is_complete(tree: &Tree<Pane>) -> bool {
    tree.root().is_some() && Pane::ALL.iter().all(|pane| tree.tiles.find_pane(pane).is_some())
}

/// Whether `tile` shares its tabs with no other.
fn is_alone(tree: &Tree<Pane>, tile: TileId) -> bool {
    let parent = tree.tiles.parent_of(tile).and_then(|parent| tree.tiles.get_container(parent));
    parent.is_none_or(|parent| parent.num_children() < 2)
}

/// Panes that share their tabs with no other: their title is a heading, not a choice.
pub fn alone(tree: &Tree<Pane>) -> Vec<TileId> {
    let panes = Pane::ALL.iter().filter_map(|pane| tree.tiles.find_pane(pane));
    panes.filter(|tile| is_alone(tree, *tile)).collect()
}

/// The tile that holds nothing but the stage: it needs no tab.
pub fn stage_alone(tree: &Tree<Pane>) -> Option<TileId> {
    let stage = tree.tiles.find_pane(&Pane::Stage)?;
    let parent = tree.tiles.parent_of(stage)?;
    let is_tabs = matches!(tree.tiles.get(parent), Some(Tile::Container(Container::Tabs(_))));
    (is_tabs && is_alone(tree, stage)).then_some(parent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_layout_is_complete_and_remembered() {
        let mut tree = tree();
        assert!(is_complete(&tree) && stage_alone(&tree).is_some());
        let text = serde_json::to_string(&tree).unwrap();
        let back: Tree<Pane> = serde_json::from_str(&text).unwrap();
        assert!(is_complete(&back));
        let stage = tree.tiles.find_pane(&Pane::Stage).unwrap();
        tree.remove_recursively(stage);
        assert!(!is_complete(&tree));
    }

    #[test]
    fn a_lecture_hides_all_but_stage_and_explanation() {
        let mut tree = tree();
        let folded = Folded { lecture: true, why: true, ..Folded::default() };
        fold(&mut tree, folded, |_| true);
        let seen = |pane: &Pane| tree.tiles.find_pane(pane).is_some_and(|tile| tree.is_visible(tile));
        assert_eq!(Pane::ALL.into_iter().filter(seen).collect::<Vec<_>>(), [Pane::Stage, Pane::Why]);
    }
}
