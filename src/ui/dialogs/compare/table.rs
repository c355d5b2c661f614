//! The table of a comparison: a row for each estimator, or for each of them at each swept value.

use std::sync::Arc;

use eframe::egui::{self, Align, Label, Layout, Rect, RichText, ScrollArea, TextStyle, Ui, WidgetText, pos2, vec2};
use egui_extras::{Column as Width, TableBuilder, TableRow};

use super::State;
use crate::experiment::comparison::{self, Column, Row};
use crate::paint::Theme;
use crate::ui::commands::{Action, Actions};
use crate::ui::drawing::style;
use crate::ui::panes::glossary;

/// Width of the column with the estimators' names, in sizes of its type.
const NAME_LETTERS: f32 = 11.0;
/// Empty points above and below the text of a row.
const ROW_PADDING: f32 = 6.0;
/// Height of the bar for scrolling sideways, in points.
const BAR: f32 = 12.0;
/// Empty points between two columns, and where there is little room.
const GAP: f32 = 14.0;
const NARROW_GAP: f32 = 9.0;
/// Height of the bar of a number, in points.
const NUMBER_BAR: f32 = 4.0;
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
    /// Whether all rows are there.
    pub is_whole: bool,
}

/// What a number is among those of its column.
#[derive(Clone, Copy, Default)]
struct Rank {
    is_best: bool,
    /// Length of its bar, as a share of the column's width.
    bar: Option<f64>,
}

/// The sizes of the table in points.
pub struct Sizes {
    /// Lines of a heading.
    lines: usize,
    /// Between two columns.
    gap: f32,
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

    /// The ranks of the numbers, by columns and rows.
    fn ranks(&self) -> Vec<Vec<Rank>> {
        let of = |(_, column): &(usize, Column)| {
            let best = if self.is_whole { column.best(&self.rows) } else { vec![false; self.rows.len()] };
            best.into_iter().zip(column.bars(&self.rows)).map(|(is_best, bar)| Rank { is_best, bar }).collect()
        };
        self.columns.iter().map(of).collect()
    }

    /// Measures the table with the type of `ui`: with high headings where it is too wide otherwise.
    pub fn sizes(&self, ui: &Ui) -> Sizes {
        let usual = self.sizes_with(ui, (2, GAP));
        if usual.width() <= ui.available_width() { usual } else { self.sizes_with(ui, (3, NARROW_GAP)) }
    }

    fn sizes_with(&self, ui: &Ui, (lines, gap): (usize, f32)) -> Sizes {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let text = |text: RichText, wrap: f32| {
            let text = WidgetText::from(text);
            text.into_galley(ui, Some(egui::TextWrapMode::Wrap), wrap, TextStyle::Body).size()
        };
        let heading = |name: &str| text(strong(name, lines), f32::INFINITY);
        // Any of them may be the best.
        let number = |shown: String| {
            let [plain, best] = [false, true].map(|is_best| text(digits(&shown, is_best), f32::INFINITY).x);
            plain.max(best)
        };
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
            lines,
            gap,
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
    /// Width of all columns.
    fn width(&self) -> f32 {
        self.names + self.columns.iter().map(|width| width + self.gap).sum::<f32>()
    }

    /// Width of the first columns that fit whole into `room`: what is scrolled to is not cut.
    fn whole_columns(&self, room: f32) -> f32 {
        let mut end = self.names;
        let ends = self.columns.iter().map(|width| {
            end += self.gap + width;
            end
        });
        // The bar for scrolling through the rows lies beside them.
        ends.filter(|end| *end <= room).last().map_or(room, |end| room.min(end + BAR))
    }

    /// Height of the first rows that fit whole into `room`.
    fn whole_rows(&self, room: f32) -> f32 {
        let mut end = 0.0;
        let ends = self.rows.iter().map(|height| {
            end += height;
            end
        });
        ends.filter(|end| *end <= room).last().unwrap_or(room)
    }

    /// The height of all rows with the heading.
    pub fn whole(&self) -> f32 {
        self.heading + self.rows.iter().sum::<f32>() + BAR
    }

    /// The height that the heading and the first rows need, with the bar for scrolling.
    pub fn least(&self) -> f32 {
        self.heading + self.rows.iter().take(LEAST_ROWS).sum::<f32>() + BAR
    }
}

/// Shows the table in `height` points; returns whether a block is to be visited. The heading stays in sight when the rows are scrolled.
pub fn show(
    ui: &mut Ui,
    (content, sizes, theme): (&Content, &Sizes, Theme),
    height: f32,
    state: &mut State,
    actions: &mut Actions,
) -> bool {
    let mut visited = false;
    let width = sizes.whole_columns(ui.available_width());
    ScrollArea::horizontal().max_width(width).max_height(height).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(sizes.gap, 0.0);
        let ranks = content.ranks();
        let numbers = Layout::right_to_left(Align::Center);
        let table = TableBuilder::new(ui).striped(true).auto_shrink([true, true]).cell_layout(numbers);
        let table = table.max_scroll_height(sizes.whole_rows(height - sizes.heading - BAR)).min_scrolled_height(0.0);
        // A cell that is clipped would have its heading on one line.
        let widths = std::iter::once(&sizes.names).chain(&sizes.columns);
        let table = widths.fold(table, |table, width| table.column(Width::exact(*width).clip(false)));
        table.header(sizes.heading, |mut row| headings(&mut row, (content, sizes.lines), state)).body(|mut body| {
            for (i, (row, height)) in content.rows.iter().zip(&sizes.rows).enumerate() {
                let ranks = ranks.iter().map(|column| column[i]);
                let columns = content.columns.iter().map(|(_, column)| column).zip(ranks);
                body.row(*height, |mut cells| visited |= line(&mut cells, row, columns, (theme, actions)));
            }
        });
    });
    visited
}

/// Shows the headings; a click on one plots its column over the swept values.
fn headings(row: &mut TableRow<'_, '_>, (content, lines): (&Content, usize), state: &mut State) {
    row.col(|ui| drop(ui.with_layout(Layout::left_to_right(Align::Center), |ui| ui.label(strong("Estimator", lines)))));
    if let Some(name) = content.swept() {
        row.col(|ui| drop(ui.label(strong(name, lines))));
    }
    let plotted = state.plotted.unwrap_or_else(|| comparison::telling(&content.rows));
    for (i, column) in &content.columns {
        row.col(|ui| match content.swept() {
            Some(_) => {
                let tip = format!("{} Click to plot it.", column.doc);
                let heading = ui.selectable_label(plotted == *i, strong(column.heading, lines));
                if heading.on_hover_ui(|ui| glossary::tooltip(ui, &tip)).clicked() {
                    state.plotted = Some(*i);
                }
            }
            None => {
                let heading = ui.add(Label::new(strong(column.heading, lines)).halign(Align::Max));
                heading.on_hover_ui(|ui| glossary::tooltip(ui, column.doc));
            }
        });
    }
}

/// Shows a row; returns whether a block is to be visited.
fn line<'a>(
    cells: &mut TableRow<'_, '_>,
    row: &Arc<Row>,
    columns: impl Iterator<Item = (&'a Column, Rank)>,
    (theme, actions): (Theme, &mut Actions),
) -> bool {
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
    for (column, rank) in columns {
        cells.col(|ui| {
            bar(ui, rank, theme);
            visited |= cell(ui, (column, rank.is_best), row, actions);
        });
    }
    visited
}

/// Shows how large a number is beside the others of its column.
fn bar(ui: &Ui, rank: Rank, theme: Theme) {
    let Some(share) = rank.bar else { return };
    let (cell, chrome) = (ui.max_rect(), theme.chrome());
    let size = vec2(share as f32 * cell.width(), NUMBER_BAR);
    let color = if rank.is_best { chrome.accent } else { chrome.dim.mix(chrome.panel, 0.5) };
    let bar = Rect::from_min_size(pos2(cell.min.x, cell.max.y - NUMBER_BAR), size);
    ui.painter().rect_filled(bar, 1.0, style::color(color));
}

/// Shows a number, the best of a column in bold; the share of missed minima links to the first such block.
fn cell(ui: &mut Ui, (column, is_best): (&Column, bool), row: &Arc<Row>, actions: &mut Actions) -> bool {
    let text = digits(&column.text(row), is_best);
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

/// A number, in bold type if it is the best of its column.
fn digits(text: &str, is_best: bool) -> RichText {
    let text = RichText::new(text);
    if is_best { text.family(style::bold()) } else { text.monospace() }
}

/// A heading in bold type, on so many lines at most.
fn strong(heading: &str, lines: usize) -> RichText {
    RichText::new(broken(heading, lines)).small().family(style::bold())
}

/// A heading on at most so many lines, as narrow as that makes it.
fn broken(heading: &str, lines: usize) -> String {
    let wrapped = |most: usize| {
        let mut all: Vec<String> = Vec::new();
        for word in heading.split(' ') {
            match all.last_mut() {
                Some(line) if line.chars().count() + 1 + word.chars().count() <= most => *line += &format!(" {word}"),
                _ => all.push(word.to_owned()),
            }
        }
        all
    };
    let fitting = (1..=heading.len()).map(wrapped).find(|all| all.len() <= lines);
    fitting.map_or_else(|| heading.to_owned(), |all| all.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::broken;

    #[test]
    fn a_heading_is_as_narrow_as_its_lines_allow() {
        assert_eq!(broken("EPE px", 2), "EPE\npx");
        assert_eq!(broken("stable under brightness change %", 2), "stable under\nbrightness change %");
        assert_eq!(broken("stable under brightness change %", 3), "stable under\nbrightness\nchange %");
        assert_eq!(broken("candidates", 3), "candidates");
    }
}
