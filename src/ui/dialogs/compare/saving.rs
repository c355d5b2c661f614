//! The table or the plot of a comparison as a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::{Label, RichText, TextStyle, Ui};
use motionscope_core::base::Error;
use motionscope_core::scene::Series;

use super::{State, plotted};
use crate::experiment::comparison::{self, Row};
use crate::files::{self, IN_PAGE, download};
use crate::media;
use crate::media::export::{Inputs, Target};
use crate::paint::Theme;
use crate::ui::commands::{Action, Actions, Browse};
use crate::ui::dialogs::typed;
use crate::ui::model::background::Background;
use crate::ui::model::document::Document;
use crate::view::rendering::Format;
use crate::view::sweep_plot;

/// Pixels per point of a plot that is saved as a PNG.
const SCALE: u32 = 2;
/// Width of the field for the path, in sizes of its type.
const FIELD_LETTERS: f32 = 15.0;

/// Shows the ways to copy the table, or to save the plot or the table in a file, and what became of them.
pub fn footer(ui: &mut Ui, rows: &[Arc<Row>], state: &mut State, of: (&Document, Theme), actions: &mut Actions) {
    if rows.is_empty() {
        return;
    }
    let is_entered = buttons(ui, rows, state, actions);
    if is_entered {
        let ctx = ui.ctx().clone();
        let saved = encoded(rows, state, of);
        state.saved = Some(Background::new("save", move || ctx.request_repaint(), async move |_| saved?.save()));
    }
    outcome(ui, state);
}

/// Shows the buttons; returns whether to save.
fn buttons(ui: &mut Ui, rows: &[Arc<Row>], state: &mut State, actions: &mut Actions) -> bool {
    let is_swept = rows.iter().any(|row| row.swept.is_some());
    let size = TextStyle::Body.resolve(ui.style()).size;
    if ui.button("Copy as CSV").on_hover_text("Copy all rows so far as CSV, for a spreadsheet.").clicked() {
        ui.copy_text(comparison::csv(rows));
    }
    let buttons_letters = if IN_PAGE { 5.0 } else { 11.0 };
    let left = ui.available_width() - buttons_letters * size;
    let width = left.clamp(4.0 * size, FIELD_LETTERS * size);
    let mut is_entered = state.file.show(ui, "File of the plot or the table", width);
    if !IN_PAGE && ui.button("Browse…").clicked() {
        actions.ask(Action::Browse(Browse::SaveFile));
    }
    let tip = match is_swept {
        true => "Save the plot as .png, .svg or .pdf, or all rows as .csv: the end of the name decides.",
        false => "Save all rows as .csv. A sweep has a plot as well.",
    };
    is_entered |= ui.button("Save").on_hover_text(tip).clicked();
    is_entered
}

/// Says in the rest of the line what was saved, or why not, and which names complete the path.
fn outcome(ui: &mut Ui, state: &State) {
    let line = |ui: &mut Ui, text: RichText| drop(ui.add(Label::new(text).truncate()));
    if !state.file.found().is_empty() {
        return line(ui, RichText::new(state.file.found()).small().weak());
    }
    let Some(saved) = &state.saved else { return };
    saved.look(|outcome| match outcome {
        Some(Ok(message)) => line(ui, RichText::new(message)),
        Some(Err(why)) => line(ui, RichText::new(why.to_string()).color(ui.visuals().error_fg_color)),
        None => {}
    });
}

/// A plot or a table on its way to a file.
struct PendingFile {
    path: PathBuf,
    inputs: Arc<Inputs>,
    content: Content,
}

/// What is written.
enum Content {
    /// Rows as text.
    Table(String),
    /// A plot.
    Plot(Box<Series>, Theme, Format),
}

/// The first name for a table, or for the plot of a sweep.
pub fn file_of(is_swept: bool) -> String {
    let name = if is_swept { "comparison.svg" } else { "comparison.csv" };
    if IN_PAGE { name.into() } else { files::current_dir().join(name).display().to_string() }
}

/// What the path asks for: the table, or the plot of the column that is shown.
fn encoded(rows: &[Arc<Row>], state: &State, (document, theme): (&Document, Theme)) -> Result<PendingFile, Error> {
    let message = || Error::new("enter a path that ends in .svg, .png, .pdf or .csv");
    let path = typed::parse(&state.file.text).map(|path| download::target(Path::new(&path))).ok_or_else(message)?;
    let inputs = document.prepared_alone().map(|prepared| prepared.inputs).unwrap_or_default();
    let is_table = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    let content = if is_table {
        Content::Table(comparison::csv(rows))
    } else if rows.iter().any(|row| row.swept.is_some()) {
        let plotted = plotted(rows, state);
        let axis = state.sweep.as_ref().map_or("", |sweep| sweep.axis);
        Content::Plot(Box::new(sweep_plot::series(rows, &plotted, axis)), theme, Format::of(&path)?)
    } else {
        return Err(Error::new("only a sweep has a plot; choose one under Sweep, or save the table as .csv"));
    };
    Ok(PendingFile { path, inputs, content })
}

impl PendingFile {
    /// Writes the file, if there is none yet; gives what was written.
    fn save(self) -> Result<String, Error> {
        let Self { path, inputs, content } = self;
        if files::exists(&path) {
            return Err(Error::new(format!("{} is there already; choose another name", path.display())));
        }
        media::export::check(&inputs, &[Target::File(&path)])
            .map_err(|conflict| Error::new(format!("{} {}; choose another name", path.display(), conflict.why)))?;
        let bytes = match content {
            Content::Table(table) => table.into_bytes(),
            Content::Plot(series, theme, format) => sweep_plot::encode(&series, theme, format, SCALE)?,
        };
        download::hand_over(&path, media::export::save_result(&path, &bytes))?;
        Ok(format!("Saved {}.", files::label(&path)))
    }
}
