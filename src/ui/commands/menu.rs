//! The menus of the window, and those within them.

use lucide_icons::Icon;

/// A menu of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Clips and sessions.
    File,
    /// Parameters.
    Edit,
    /// Themes, zoom, layers and panes.
    View,
    /// Moves through the run.
    Walk,
    /// Pictures and results as files.
    Export,
    /// The palette, shortcuts and version.
    Help,
}

impl Menu {
    /// Every menu, from left to right.
    pub const ALL: [Menu; 6] = [Menu::File, Menu::Edit, Menu::View, Menu::Walk, Menu::Export, Menu::Help];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Menu::File => "File",
            Menu::Edit => "Edit",
            Menu::View => "View",
            Menu::Walk => "Walk",
            Menu::Export => "Export",
            Menu::Help => "Help",
        }
    }
}

/// A menu within a menu.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submenu {
    /// Which pictures the stage shows.
    Pictures,
    /// Zoom.
    Zoom,
    /// The themes.
    Theme,
    /// Color maps for costs.
    Colours,
    /// Flow colors and streaklines.
    Motion,
    /// The scale of arrows.
    ArrowLength,
    /// The interface scale.
    InterfaceSize,
    /// The panes around the stage.
    Panes,
    /// What is shown to a class.
    Present,
}

impl Submenu {
    /// Its name and its icon.
    pub fn info(self) -> (&'static str, Icon) {
        match self {
            Submenu::Pictures => ("Pictures", Icon::Images),
            Submenu::Zoom => ("Zoom", Icon::ZoomIn),
            Submenu::Theme => ("Theme", Icon::Contrast),
            Submenu::Colours => ("Colours", Icon::Palette),
            Submenu::Motion => ("Motion", Icon::Wind),
            Submenu::ArrowLength => ("Arrow length", Icon::MoveUpRight),
            Submenu::InterfaceSize => ("Interface size", Icon::CaseSensitive),
            Submenu::Panes => ("Panes", Icon::LayoutDashboard),
            Submenu::Present => ("Present", Icon::Presentation),
        }
    }
}
