//! Small pictures whose pixels are numbers: the same pixel is lit in all of them, and they are looked at closely.

use eframe::egui::{self, Color32, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, vec2};
use motionscope_core::scene::Tile;

use crate::paint::Face;
use crate::paint::charts::tiles::{Closeness, Places, Tiles, caption, description, draw, places};
use crate::ui::drawing::chart::{Chart, Subject, rect_from, rect_of};
use crate::ui::drawing::{ink, style};

/// The tiles of a step.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The tiles, left to right.
    pub tiles: &'a [Tile],
    /// Whether the pixel that is explained lies in their middle.
    pub is_centered: bool,
    /// Whose they are, and how they look.
    pub subject: Subject<'a>,
}

/// How the tiles are looked at.
#[derive(Default)]
pub struct State {
    chart: Chart<Places, (bool, Closeness)>,
    /// Whether those that there is no room for are seen closely enough to read their numbers.
    is_close: bool,
    /// A tile, and the pixel of it that is to come to the middle.
    aim: Option<(usize, [usize; 2])>,
    /// The pixel, and the size of the tiles that it is lit in: others show something else there.
    hovered: Option<([usize; 2], (usize, usize))>,
}

/// What the person did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// The pixel under the pointer, from the tiles' upper left corner.
    pub hovered: Option<[usize; 2]>,
    /// Whether a click shows them closer, or whole again.
    pub can_be_closer: bool,
}

impl State {
    /// What a click does.
    fn hint(&self) -> &'static str {
        if self.is_close { " Click to show the whole tiles." } else { " Click to magnify." }
    }
}

/// Shows the tiles with their numbers, to be scrolled where they do not fit, and the pixel pointed at below them.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { tiles, subject, .. } = input;
    let small = subject.theme.sizes().small;
    let line = (1.7 * small).round();
    let mut response = Response::default();
    let room = (ui.available_height() - line - ui.spacing().item_spacing.y).max(2.0 * line);
    let scroll = egui::ScrollArea::both().id_salt("tiles").auto_shrink(false).max_height(room);
    scroll.show(ui, |ui| response = side_by_side(ui, input, state));
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), line), Sense::hover());
    let hint = if response.can_be_closer { state.hint() } else { "" };
    let words = format!("{}{hint}", description(tiles, state.hovered));
    let (font, color) = (style::font(Face::Sans, small), style::color(subject.theme.chrome().dim));
    ink::line(ui.painter(), rect.left_center(), ink::Words { text: &words, font, color }, rect.width());
    response
}

fn side_by_side(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    let Input { tiles, is_centered, subject } = input;
    // They are laid out from the origin on, and shown wherever they are scrolled to.
    let area = Rect::from_min_size(Pos2::ZERO, ui.available_rect_before_wrap().size());
    let style = subject.style(ui.painter());
    let data = |closeness| Tiles { tiles, is_centered, closeness };
    let cell = |closeness| places(data(closeness), rect_of(area), style).cell;
    let can_be_closer = cell(Closeness::Readable) > cell(Closeness::Whole);
    let is_whole = can_be_closer && !state.is_close;
    let closeness = if is_whole { Closeness::Whole } else { Closeness::Readable };
    let painter = ui.painter().clone();
    let places = state.chart.lay_out(&painter, (subject, tiles), (area, (is_centered, closeness)), |area, style| {
        draw(data(closeness), area, style)
    });
    let (rect, whole) = ui.allocate_exact_size(places.size.into(), Sense::hover());
    ink::name(&whole, || description(tiles, state.hovered));
    let by = rect.min.to_vec2();
    state.chart.moved(ui.painter(), by);
    let mut hovered = None;
    for (i, tile) in tiles.iter().enumerate() {
        let square = |pixel| rect_from(places.square(i, pixel)).translate(by);
        let sense = if can_be_closer { Sense::click() } else { Sense::hover() };
        let sensed = ui.interact(rect_from(places.tiles[i]).translate(by), ui.scope_id().with(("tile", i)), sense);
        sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, caption(tile)));
        if let Some(at) = sensed.hover_pos() {
            let pixel = places.pixel(i, (at - by).into(), tile);
            hovered = pixel.map(|pixel| (pixel, tile.values.size()));
        }
        if sensed.clicked() {
            (state.is_close, state.aim) = (!state.is_close, hovered.map(|(pixel, _)| (i, pixel)));
            ui.ctx().request_repaint();
        } else if let Some((_, pixel)) = state.aim.filter(|(aimed, _)| *aimed == i && state.is_close) {
            ui.scroll_to_rect(square(pixel), Some(egui::Align::Center));
            state.aim = None;
            ui.ctx().request_repaint();
        }
        if let Some((pixel, _)) = state.hovered.filter(|(_, size)| *size == tile.values.size()) {
            let lit = square(pixel);
            ui.painter().rect_stroke(lit, 0.0, Stroke::new(4.0, Color32::BLACK), StrokeKind::Outside);
            ui.painter().rect_stroke(lit, 0.0, Stroke::new(2.0, Color32::WHITE), StrokeKind::Outside);
        }
    }
    state.hovered = hovered;
    Response { hovered: hovered.map(|(pixel, _)| pixel), can_be_closer }
}
