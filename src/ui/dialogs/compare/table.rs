//! The table of a comparison: a row for each estimator, or for each of them at each swept value.

use std::sync::Arc;

use eframe::egui::{self, Align, Label, Layout, RichText, ScrollArea, TextStyle, Ui, WidgetText, vec2};
use egui_extras::{Column as Width, TableBuilder, TableRow};

use super::State;
use crate::experiment::comparison::{self, Column, Row};
use crate::ui::app::action::{Action, Actions};
use crate::ui::drawing::style;
use crate::ui::panes::glossary;

/// Width of the column with the estimators' names, in sizes of its type.
const NAME_LETTERS: f32 = 11.0;
/// Empty points above and below the text of a row.
const ROW_PADDING: f32 = 6.0;
/// Height of the bar for scrolling sideways, in points.
const BAR: f32 = 12.0;
/// Empty points between two columns.
const GAP: f32 = 14.0;
/// The rows beside the heading that are always in sight.
const LEAST_ROWS: usize = 5;

/// The content of the table.
pub struct Content {
    /// The rows so far.
    pub rows: Vec<Arc<Row>>,
    /// The columns, with their indices among all columns.
    pub columns: Vec<(usize, Column)>,
    /// The columns that have the same number in all rows and are named below the table.
    pub alike: Vec<Column>,
}

/// The sizes of the table in points.
pub struct Sizes {
    names: f32,
    /// Of the swept value, where there is one, and of the numbers.
    columns: Vec<f32>,
    heading: f32,
    rows: Vec<f32>,
}

impl Content {
    /// The swept parameter.
    pub fn swept(&self) -> Option<&str> {
        self.rows.first().and_then(|row| row.swept.as_ref()).map(|(name, _)| name.as_str())
    }

    /// Measures the table with the type of `ui`.
    pub fn sizes(&self, ui: &Ui) -> Sizes {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let text = |text: RichText, wrap: f32| {
            let text = WidgetText::from(text);
            text.into_galley(ui, Some(egui::TextWrapMode::Wrap), wrap, TextStyle::Body).size()
        };
        let heading = |name: &str| text(strong(name), f32::INFINITY);
        let number = |shown: String| text(RichText::new(shown).monospace(), f32::INFINITY).x;
        let width = |column: &Column| {
            let widest = self.rows.iter().map(|row| number(column.text(row))).fold(0.0, f32::max);
            // A heading that can be clicked has a frame.
            let frame = if self.swept().is_some() { 2.0 * ui.spacing().button_padding.x } else { 0.0 };
            widest.max(heading(column.heading).x + frame)
        };
        let name = |row: &Arc<Row>| text(RichText::new(row.estimator.info().name), NAME_LETTERS * size);
        let names = self.rows.iter().map(|row| name(row).x).fold(heading("Estimator").x, f32::max);
        let value = |row: &Arc<Row>| row.swept.as_ref().map_or(0.0, |(_, value)| number(value.clone()));
        let swept = self.swept().map(|name| self.rows.iter().map(value).fold(heading(name).x, f32::max));
        let shown = self.columns.iter().map(|(_, column)| heading(column.heading).y);
        Sizes {
            names: names.ceil(),
            columns: swept
                .into_iter()
                .chain(self.columns.iter().map(|(_, column)| width(column)))
                .map(f32::ceil)
                .collect(),
            heading: shown.fold(heading("Estimator").y, f32::max) + 2.0 * ROW_PADDING,
            rows: self.rows.iter().map(|row| name(row).y + 2.0 * ROW_PADDING).collect(),
        }
    }
}

impl Sizes {
    /// The height that the heading and the first rows need, with the bar for scrolling.
    pub fn least(&self) -> f32 {
        self.heading + self.rows.iter().take(LEAST_ROWS).sum::<f32>() + BAR
    }
}

/// Shows the table in `height` points; returns whether a block is to be visited. The heading stays in sight when the rows are scrolled.
pub fn show(
    ui: &mut Ui,
    (content, sizes): (&Content, &Sizes),
    height: f32,
    state: &mut State,
    actions: &mut Actions,
) -> bool {
    let mut visited = false;
    ScrollArea::horizontal().max_height(height).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(GAP, 0.0);
        let numbers = Layout::right_to_left(Align::Center);
        let table = TableBuilder::new(ui).striped(true).auto_shrink([true, true]).cell_layout(numbers);
        let table = table.max_scroll_height(height - sizes.heading - BAR).min_scrolled_height(0.0);
        // A cell that is clipped would have its heading on one line.
        let widths = std::iter::once(&sizes.names).chain(&sizes.columns);
        let table = widths.fold(table, |table, width| table.column(Width::exact(*width).clip(false)));
        table.header(sizes.heading, |mut row| headings(&mut row, content, state)).body(|mut body| {
            for (row, height) in content.rows.iter().zip(&sizes.rows) {
                body.row(*height, |mut cells| visited |= line(&mut cells, row, &content.columns, actions));
            }
        });
    });
    visited
}

/// Shows the headings; a click on one plots its column over the swept values.
fn headings(row: &mut TableRow<'_, '_>, content: &Content, state: &mut State) {
    row.col(|ui| drop(ui.with_layout(Layout::left_to_right(Align::Center), |ui| ui.label(strong("Estimator")))));
    if let Some(name) = content.swept() {
        row.col(|ui| drop(ui.label(strong(name))));
    }
    let plotted = state.plotted.unwrap_or_else(|| comparison::telling(&content.rows));
    for (i, column) in &content.columns {
        row.col(|ui| match content.swept() {
            Some(_) => {
                let tip = format!("{} Click to plot it.", column.doc);
                let heading = ui.selectable_label(plotted == *i, strong(column.heading));
                if heading.on_hover_ui(|ui| glossary::tooltip(ui, &tip)).clicked() {
                    state.plotted = Some(*i);
                }
            }
            None => {
                let heading = ui.add(Label::new(strong(column.heading)).halign(Align::Max));
                heading.on_hover_ui(|ui| glossary::tooltip(ui, column.doc));
            }
        });
    }
}

/// Shows a row; returns whether a block is to be visited.
fn line(cells: &mut TableRow<'_, '_>, row: &Arc<Row>, columns: &[(usize, Column)], actions: &mut Actions) -> bool {
    cells.col(|ui| {
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            // Long names wrap, so that the columns with numbers have room.
            ui.add(Label::new(row.estimator.info().name).wrap());
        });
    });
    if let Some((_, value)) = &row.swept {
        cells.col(|ui| drop(ui.label(RichText::new(value).monospace())));
    }
    let mut visited = false;
    for (_, column) in columns {
        cells.col(|ui| visited |= cell(ui, column, row, actions));
    }
    visited
}

/// Shows a number; the share of missed minima links to the first such block.
fn cell(ui: &mut Ui, column: &Column, row: &Arc<Row>, actions: &mut Actions) -> bool {
    let text = RichText::new(column.text(row)).monospace();
    // Where the clip itself was swept, the block is missed in another clip.
    let is_here = row.swept.as_ref().is_none_or(|(name, _)| row.estimator.get(name).is_ok());
    let missed = row.figures.blocks.as_ref().and_then(|blocks| blocks.missed.as_ref()?.first());
    let Some(first) = missed.filter(|_| is_here && column.name == "missed_percent") else {
        ui.label(text);
        return false;
    };
    let tip = format!("Go to block {}, the first with a missed global minimum.", first + 1);
    let clicked = ui.link(text).on_hover_text(tip).clicked();
    if clicked {
        actions.ask(Action::Visit(Arc::clone(row)));
    }
    clicked
}

/// Names the numbers that are the same in all rows.
pub fn alike(ui: &mut Ui, content: &Content) {
    let Some(row) = content.rows.first().filter(|_| !content.alike.is_empty()) else { return };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.label(RichText::new("The same in all rows: ").small().weak());
        for (i, column) in content.alike.iter().enumerate() {
            let end = if i + 1 < content.alike.len() { "; " } else { "." };
            let text = format!("{} {}{end}", column.heading, column.text(row));
            let label = ui.label(RichText::new(text).small().weak());
            label.on_hover_ui(|ui| glossary::tooltip(ui, column.doc));
        }
    });
}

/// A heading in bold type.
fn strong(heading: &str) -> RichText {
    RichText::new(broken(heading)).small().family(style::bold())
}

/// A heading on two lines where that makes it narrower: broken at the space nearest to its middle.
fn broken(heading: &str) -> String {
    let middle = heading.len() / 2;
    let spaces = heading.match_indices(' ').map(|(at, _)| at);
    match spaces.min_by_key(|at| at.abs_diff(middle)) {
        Some(at) => format!("{}\n{}", &heading[..at], &heading[at + 1..]),
        None => heading.to_owned(),
    }
}
