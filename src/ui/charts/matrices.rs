//! Matrices with the numbers of a step, side by side; what the step has changed is lit.

use eframe::egui::{
    self, Align, Color32, Layout, Rect, RichText, Sense, Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use motionscope_core::scene::Matrix;

use crate::paint::{Face, Theme, number};
use crate::ui::drawing::ink;

/// Between two matrices, in letters.
const GAP_LETTERS: f32 = 1.6;
/// Least width of a column, in letters, and what lies between one and what stands in the next.
const COLUMN_LETTERS: f32 = 5.4;
const COLUMN_GAP_LETTERS: f32 = 1.2;
/// Height of a row, in letters.
const ROW_LETTERS: f32 = 1.6;

/// Shows all matrices, as many beside each other as fit, to be scrolled where they do not.
pub fn show(ui: &mut Ui, matrices: &[Matrix], theme: Theme) {
    let small = theme.sizes().small;
    egui::ScrollArea::both().id_salt("matrices").auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(GAP_LETTERS * small, 0.8 * small);
        ui.with_layout(Layout::left_to_right(Align::TOP).with_main_wrap(true), |ui| {
            for matrix in matrices {
                one(ui, matrix, theme);
            }
        });
    });
}

/// Where the parts of a matrix lie within its own rectangle.
struct Place {
    /// Height of the line with its name.
    head: f32,
    /// Room for the names of the columns and rows; none where there are no names.
    columns: f32,
    rows: f32,
    /// Size of an entry.
    cell: egui::Vec2,
}

fn one(ui: &mut Ui, matrix: &Matrix, theme: Theme) {
    let small = theme.sizes().small;
    let (width, height) = matrix.entries.size();
    let long = |text: String| ui.painter().layout_no_wrap(text, ink::font(Face::Sans, small), Color32::WHITE).size().x;
    let longest = |texts: &mut dyn Iterator<Item = String>| texts.map(long).fold(0.0, f32::max);
    let widest = longest(&mut matrix.entries.cells().iter().map(|value| number(*value as f32)));
    let widest = widest.max(longest(&mut matrix.columns.iter().cloned())) + COLUMN_GAP_LETTERS * small;
    let rows = longest(&mut matrix.rows.iter().cloned());
    let place = Place {
        head: 1.9 * small,
        columns: if matrix.columns.is_empty() { 0.0 } else { ROW_LETTERS * small },
        rows: if matrix.rows.is_empty() { 0.0 } else { (rows + small).max(2.2 * small) },
        cell: vec2(widest.max(COLUMN_LETTERS * small), ROW_LETTERS * small),
    };
    let body = vec2(place.rows + place.cell.x * width as f32, place.columns + place.cell.y * height as f32);
    let name = ui.painter().layout_no_wrap(heading(matrix), ink::font(Face::Sans, small), Color32::WHITE);
    let size = vec2(body.x.max(name.size().x + 2.0), place.head + body.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, plain(matrix)));
    let mut child = ui.new_child(UiBuilder::new().max_rect(rect));
    head(&mut child, matrix, theme);
    entries(&child, matrix, rect.min + vec2(place.rows, place.head + place.columns), &place, theme);
}

fn heading(matrix: &Matrix) -> String {
    format!("{}  {}", matrix.symbol, matrix.name)
}

fn head(ui: &mut Ui, matrix: &Matrix, theme: Theme) {
    let chrome = theme.chrome();
    let symbol = ink::color(matrix.role.map_or(chrome.text, |role| theme.word(role)));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.5 * theme.sizes().small;
        ui.label(RichText::new(matrix.symbol).color(symbol).italics().strong());
        ui.label(RichText::new(matrix.name).color(ink::color(chrome.dim)).size(theme.sizes().small));
    });
}

fn entries(ui: &Ui, matrix: &Matrix, origin: egui::Pos2, place: &Place, theme: Theme) {
    let (chrome, small) = (theme.chrome(), theme.sizes().small);
    let (width, height) = matrix.entries.size();
    if width == 0 || height == 0 {
        return;
    }
    let painter = ui.painter();
    let cell = |x: usize, y: usize| Rect::from_min_size(origin + place.cell * vec2(x as f32, y as f32), place.cell);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let rect = cell(x, y);
        if matrix.changed.as_ref().is_some_and(|changed| changed[(x, y)]) {
            painter.rect_filled(rect.shrink(1.0), 3.0, ink::color(chrome.selection));
        }
        let value = matrix.entries[(x, y)];
        // What is nothing steps back, so that the shape of a matrix can be seen.
        let color = if value == 0.0 { chrome.dim } else { chrome.text };
        let at = pos2(rect.max.x - 0.4 * small, rect.center().y);
        let font = ink::font(Face::Sans, small);
        painter.text(at, egui::Align2::RIGHT_CENTER, number(value as f32), font, ink::color(color));
    }
    let dim = |at, anchor, text: &str| {
        painter.text(at, anchor, text, ink::font(Face::Sans, small), ink::color(chrome.dim));
    };
    for (x, name) in matrix.columns.iter().enumerate() {
        let at = cell(x, 0).right_top() + vec2(-0.4 * small, -0.3 * small);
        dim(at, egui::Align2::RIGHT_BOTTOM, name);
    }
    for (y, name) in matrix.rows.iter().enumerate() {
        dim(cell(0, y).left_center() - vec2(0.6 * small, 0.0), egui::Align2::RIGHT_CENTER, name);
    }
    brackets(painter, Rect::from_min_max(origin, cell(width - 1, height - 1).max), ink::color(chrome.dim));
}

fn brackets(painter: &egui::Painter, rect: Rect, color: Color32) {
    let stroke = Stroke::new(1.0, color);
    for (x, inwards) in [(rect.min.x, 4.0), (rect.max.x, -4.0)] {
        let points =
            [pos2(x + inwards, rect.min.y), pos2(x, rect.min.y), pos2(x, rect.max.y), pos2(x + inwards, rect.max.y)];
        painter.line(points.to_vec(), stroke);
    }
}

/// The matrix in words, for a screen reader.
fn plain(matrix: &Matrix) -> String {
    let (width, height) = matrix.entries.size();
    let row = |y| (0..width).map(|x| number(matrix.entries[(x, y)] as f32)).collect::<Vec<_>>().join(", ");
    let rows: Vec<_> = (0..height).map(row).collect();
    format!("{}, {}: {}", matrix.symbol, matrix.name, rows.join("; "))
}
