//! The mouse as pointer or pen: what is drawn by hand on the pictures.

use eframe::egui::{
    Align, Color32, CursorIcon, Label, Layout, Painter, RichText, Sense, Stroke, TextStyle, Ui, WidgetInfo, vec2,
};
use lucide_icons::Icon;

use super::{Input, Response, Spot, State};
use crate::paint::{FreehandLine, Ground, PenColor, Placement, Theme, freehand};
use crate::ui::commands::{Command, PenWish};
use crate::ui::drawing::{pen, primitives, style};
use crate::ui::parts::widgets;

/// What the mouse does on the pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hand {
    /// It moves the pictures, and what is pointed at is explained.
    #[default]
    Explore,
    /// It points for the class: nothing changes under it until it is clicked.
    Point,
    /// It draws in this colour.
    Draw(PenColor),
}

/// How the stage is presented to a class.
#[derive(Clone, Copy, Debug, Default)]
pub struct Presenting<'a> {
    /// What the mouse does.
    pub hand: Hand,
    /// What was drawn by hand on the step.
    pub freehand: &'a [FreehandLine],
    /// Whether a change of the ink can be undone.
    pub can_undo_ink: bool,
    /// Whether the part under the pointer is magnified.
    pub has_loupe: bool,
    /// Whether the pictures stand alone, without the line above them.
    pub is_bare: bool,
}

/// Takes what the mouse draws on a picture; gives whether the pen is down on it.
pub fn act(
    ui: &Ui,
    sensed: &eframe::egui::Response,
    spot: &Spot<'_>,
    (input, state): (&Input<'_>, &mut State),
    response: &mut Response,
) -> bool {
    let Hand::Draw(color) = input.presenting.hand else {
        state.line = None;
        return false;
    };
    let on = Ground::Picture(spot.panel.picture());
    if let Some(from) = pen::begun(sensed, state.line.is_some()) {
        if spot.lens.pixel_at(from).is_none() {
            return false;
        }
        let points = vec![spot.lens.to_image(from)];
        state.line = Some(FreehandLine { step: input.cursor, member: spot.member, on, color, points });
    }
    let Some(line) = state.line.as_mut().filter(|line| line.member == spot.member && line.on == on) else {
        return false;
    };
    pen::extend(ui, line, |at| spot.lens.to_screen(at), |at| spot.lens.to_image(at));
    let is_down = ui.input(|i| i.pointer.primary_down());
    if !is_down {
        response.drawn = pen::ended(ui, &mut state.line);
    }
    is_down
}

/// Draws what was drawn by hand on a picture, and what is being drawn.
pub fn paint(painter: &Painter, spot: &Spot<'_>, input: &Input<'_>, state: &State) {
    let lines = input.presenting.freehand.iter().chain(&state.line).filter(|line| line.is_on(spot.panel, spot.member));
    let place = Placement::new(spot.lens.picture_rect().min.into(), spot.lens.scale);
    let primitives = freehand(lines, input.theme(), place);
    if !primitives.is_empty() {
        let painter = painter.with_clip_rect(spot.lens.picture_rect().intersect(spot.lens.pane));
        painter.extend(primitives::shapes(&painter, &primitives));
    }
}

/// The mouse over a picture looks like what it does.
pub fn cursor(
    sensed: eframe::egui::Response,
    (painter, theme): (&Painter, Theme),
    hand: Hand,
) -> eframe::egui::Response {
    match hand {
        Hand::Explore => {
            let cursor = if sensed.dragged() { CursorIcon::Grabbing } else { CursorIcon::Crosshair };
            sensed.on_hover_and_drag_cursor(cursor)
        }
        // The dot of the pointer is drawn over everything.
        Hand::Point => sensed,
        Hand::Draw(color) => {
            pen::dot(&sensed, painter, (theme, color));
            sensed.on_hover_and_drag_cursor(CursorIcon::None)
        }
    }
}

/// The colours of the pen and what else can be done with it, on the line below the pictures.
pub fn tools(ui: &mut Ui, input: &Input<'_>, color: PenColor, response: &mut Response) {
    let size = vec2(ui.available_width(), style::line_height(input.theme()));
    let mut ask = |is_asked: bool, wish: PenWish| response.pen = is_asked.then_some(wish).or(response.pen);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        for other in PenColor::ALL {
            ask(swatch(ui, input.theme(), (other, other == color)), PenWish::Color(other));
        }
        ui.spacing_mut().interact_size.y = size.y;
        let mut button = |is_enabled, icon, name: &str, tip: &str| {
            let button = ui.add_enabled_ui(is_enabled, |ui| widgets::icon_button(ui, icon, name, false)).inner;
            button.on_hover_text(tip).clicked()
        };
        let tip = Command::Undo.with_key("Undo the last change of the ink of this step.");
        let undone = button(input.presenting.can_undo_ink, Icon::Undo2, "Undo ink", &tip);
        ask(undone, PenWish::Undo);
        let tip = Command::ClearInk.with_key("Remove what was drawn on this step.");
        let cleared = button(!input.presenting.freehand.is_empty(), Icon::Eraser, "Clear ink", &tip);
        ask(cleared, PenWish::Clear);
        let done = widgets::icon_button(ui, Icon::Check, "Lay the pen down", false).on_hover_text("Esc");
        ask(done.clicked(), PenWish::Done);
        // Charts are drawn on where they are presented.
        let on = if input.presenting.is_bare { "picture or chart" } else { "the picture" };
        let text = format!("Draw on {on}; the ink stays with this step.");
        ui.add(Label::new(RichText::new(text).text_style(TextStyle::Small)).truncate());
    });
}

/// A button with a colour of the pen; gives whether it is clicked.
fn swatch(ui: &mut Ui, theme: Theme, (color, is_chosen): (PenColor, bool)) -> bool {
    let side = style::line_height(theme);
    let (rect, sensed) = ui.allocate_exact_size(vec2(side, side), Sense::click());
    let name = format!("Pen colour: {}", color.id());
    sensed.widget_info(|| WidgetInfo::selected(eframe::egui::Role::Button, true, is_chosen, &name));
    let chrome = theme.chrome();
    let rim = if is_chosen { Stroke::new(3.0, style::color(chrome.text)) } else { Stroke::new(1.0, Color32::BLACK) };
    let radius = if is_chosen || sensed.hovered() { 0.38 * side } else { 0.3 * side };
    ui.painter().circle(rect.center(), radius, style::color(theme.ink(color.role()).color), rim);
    sensed.on_hover_text(name).clicked()
}
