//! The panes, where they lie at first, and which of them are folded away.

use eframe::egui;
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
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
}

impl Pane {
    /// Every pane.
    pub const ALL: [Pane; 7] =
        [Pane::Stage, Pane::Parameters, Pane::Why, Pane::Surface, Pane::Surface3d, Pane::Plot, Pane::Numbers];

    /// Its name.
    pub fn title(self) -> &'static str {
        match self {
            Pane::Stage => "Stage",
            Pane::Parameters => "Parameters",
            Pane::Why => "Why",
            Pane::Surface => "Cost surface",
            Pane::Surface3d => "3-D",
            Pane::Plot => "Plot",
            Pane::Numbers => "Numbers",
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
    pub lecture: bool,
}

impl Folded {
    /// Whether `pane` can be seen.
    pub fn shows(self, pane: Pane) -> bool {
        match pane {
            Pane::Stage => true,
            Pane::Why => self.lecture || !self.why,
            Pane::Parameters => !self.lecture && !self.parameters,
            Pane::Surface | Pane::Surface3d | Pane::Plot | Pane::Numbers => !self.lecture && !self.charts,
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
    let flat = tabs(&[Pane::Surface, Pane::Numbers]);
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

/// Shows and hides panes as `folded` says.
pub fn fold(tree: &mut Tree<Pane>, folded: Folded) {
    for pane in Pane::ALL {
        if let Some(tile) = tree.tiles.find_pane(&pane) {
            tree.set_visible(tile, folded.shows(pane));
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
        fold(&mut tree, folded);
        let seen = |pane: &Pane| tree.tiles.find_pane(pane).is_some_and(|tile| tree.is_visible(tile));
        assert_eq!(Pane::ALL.into_iter().filter(seen).collect::<Vec<_>>(), [Pane::Stage, Pane::Why]);
    }
}
