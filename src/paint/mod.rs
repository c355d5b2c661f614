//! One scene, painters that agree: what is exported is what was shown.
//!
//! [`resolve`] turns a scene's marks into [`Primitive`]s in points: filled polygons, strokes, circles, arrows,
//! words and pictures. Every painter walks that one list: the window's stage, [`export_png`], [`export_svg`] and
//! [`export_pdf`].
//! A [`Figure`] is what one exported picture consists of. Nothing here needs a window or a GPU.
//!
//! `paint` maps roles to inks by theme and marks to primitives.

pub mod charts;
mod color;
mod color_map;
mod figure;
mod flow_color;
pub mod focus;
pub mod fonts;
mod freehand;
mod layer;
pub mod legend;
mod links;
mod marks;
mod mask;
mod number;
mod panel;
mod pdf;
mod png;
pub mod primitive;
mod raster;
mod reduced;
pub mod script;
mod svg;
mod theme;
mod wrap;

pub use color::Color;
pub use color_map::ColorMap;
pub use figure::{Caption, Extent, Figure, FigureOptions, Part, focus_frames, has_colors, heading, paragraph};
pub use flow_color::flow_color;
pub use focus::{CloseUp, FocusMode, Work};
pub use fonts::Face;
pub use freehand::{Freehand, FreehandLine, Ground, PenColor, freehand, freehand_on_chart, pen_width};
pub use layer::{Backdrop, FlowLayer, LayerStyle, Opacity, Scalars, Tint, TintKey, dimmed};
pub use links::{LinkSite, links};
pub use marks::{ArrowStyle, Lengthen, Look, Placement, Style, ellipse, is_lengthened, region_color, resolve, streaks};
pub use number::{THIN, grouped, labels, number, places};
pub use panel::{LevelShown, Panel, Phase, Pictures, Share, Shown, View};
pub use pdf::{Placed, Sheet, export_pdf, export_sheets};
pub use png::{export_png, pixels};
pub use primitive::{Layer, Primitive};
pub use reduced::reduced;
pub use svg::{SvgText, export_svg};
pub use theme::{Chrome, Ink, PointShape, Theme, TypeSizes};
pub use wrap::{UNITS, brevity, inked, wrap};
