//! The comparison of estimators: a table, and a plot of a sweep.

use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::style::ScrollStyle;
use eframe::egui::{
    self, Align, Button, ComboBox, Grid, Label, Layout, RichText, ScrollArea, TextEdit, TextStyle, Ui, vec2,
};
use motionscope_core::compare::changed_alike;
use motionscope_core::scene::Series;
use motionscope_core::{AnyEstimator, Error, Info, Threads, estimator, estimators, lockstep};

use super::path::PathField;
use crate::experiment::comparison::{self, Column, Conditions, Repeats, Row};
use crate::experiment::course_table::{self, CourseRow};
use crate::experiment::first;
use crate::experiment::source::Source;
use crate::experiment::sweeps::{self, Limits, Sweep};
use crate::media;
use crate::media::export::{Inputs, Target};
use crate::paint::{ColorMap, Theme};
use crate::ui::app::action::{Action, Actions, Browse};
use crate::ui::app::commands::Command;
use crate::ui::charts::series;
use crate::ui::drawing::chart::Subject;
use crate::ui::drawing::style;
use crate::ui::model::background::Background;
use crate::ui::model::comparing::{Comparing, Plan};
use crate::ui::model::document::Document;
use crate::ui::panes::glossary;
use crate::ui::parts::widgets;
use crate::view::rendering::Format;
use crate::view::sweep_plot;

/// The largest number of estimators in a comparison.
const MOST: usize = *lockstep::MEMBERS.end();
/// Width of the column with the estimators' names, in sizes of its type.
const NAME_LETTERS: f32 = 9.0;
/// Pixels per point of a plot that is saved as a PNG.
const SCALE: u32 = 2;

/// The state of the open dialog.
pub struct State {
    chosen: Vec<&'static str>,
    /// Whether the estimators to choose from are shown; else the results have their room.
    is_choosing: bool,
    sweep: Option<Sweep>,
    /// Index of the plotted column, once one was chosen; else the error, where it is known.
    plotted: Option<usize>,
    /// What is searched for among the estimators.
    wanted: String,
    /// The family whose estimators are offered.
    family: &'static str,
    /// The state of the plot.
    plot: series::State,
    /// The estimators and the sweep of the running comparison.
    begun: Option<(Vec<&'static str>, Option<Sweep>)>,
    comparing: Option<Comparing>,
    /// The error if this selection cannot be compared.
    refused: Option<Error>,
    /// The course's own table, while it is shown.
    course: Option<Background<Vec<CourseRow>>>,
    /// The number of rows of the last layout.
    laid_out: usize,
    /// Where plot or table are saved.
    pub file: PathField,
    /// What was saved last, or why it was not.
    saved: Option<Background<String>>,
}

impl State {
    /// Compares the estimator `id` with the usual ones, or with others of its family.
    pub fn new(id: &'static str) -> Self {
        let estimators = estimators();
        let all: Vec<&'static str> = estimators.iter().map(|estimator| estimator.info().id).collect();
        let mut chosen = vec![id];
        let family = estimators.iter().find(|estimator| estimator.info().id == id).map_or("", |own| own.info().family);
        match estimators.iter().find(|estimator| estimator.info().id == id).filter(|e| !e.tests_candidates()) {
            Some(own) => {
                let kin = estimators.iter().filter(|other| other.info().family == own.info().family);
                chosen.extend(kin.map(|other| other.info().id).filter(|other| *other != id).take(MOST - 2));
            }
            None => chosen.extend(first::BESIDE.into_iter().filter(|other| *other != id)),
        }
        // In the order of the course.
        chosen.sort_by_key(|id| all.iter().position(|other| other == id));
        Self {
            is_choosing: false,
            chosen,
            sweep: None,
            plotted: None,
            wanted: String::new(),
            family,
            plot: series::State::default(),
            begun: None,
            comparing: None,
            refused: None,
            course: None,
            laid_out: 0,
            file: PathField::waiting(file_of(false)),
            saved: None,
        }
    }

    /// Whether no computation is in progress.
    pub fn is_settled(&self) -> bool {
        match &self.course {
            Some(course) => course.look(|course_table| course_table.is_some()),
            None => self.begun.is_some() && self.comparing.as_ref().is_none_or(|comparing| !comparing.is_busy()),
        }
    }
}

/// Shows the comparison; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, document: &Document, theme: Theme, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let screen = ctx.content_rect();
    let width = (78.0 * size).min(screen.width() - 110.0);
    let mut visited = false;
    let modal = widgets::modal(ctx, "compare", vec2(82.0 * size, 60.0 * size)).show(ctx, |ui| {
        ui.set_width(width);
        // As high whatever it shows, so that nothing jumps.
        let tall = (screen.height() - 120.0).min(62.0 * size);
        ui.set_min_height(tall);
        let bottom = ui.cursor().min.y + tall;
        visited |= widgets::title(ui, "Compare estimators");
        let on = match state.course {
            Some(_) => {
                "The course's table of search algorithms, measured on this pair of frames with default parameters."
            }
            None => extent(state),
        };
        ui.label(RichText::new(on).weak());
        if state.course.is_some() {
            ui.label(RichText::new(course_table::named()).weak());
        }
        ui.add_space(8.0);
        subject(ui, state, document);
        let left = |ui: &Ui| (bottom - ui.cursor().min.y).max(120.0);
        if let Some(course) = &state.course {
            let height = left(ui);
            ScrollArea::both().max_height(height).min_scrolled_height(height).show(ui, |ui| measured(ui, course));
            return;
        }
        state.is_choosing |= state.chosen.is_empty();
        if state.is_choosing {
            choice(ui, state);
        } else {
            summary(ui, state);
        }
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            sweep(ui, state, document);
            visited |= step_by_step(ui, state, actions);
        });
        start(ui, state, document);
        ui.add_space(8.0);
        let height = left(ui);
        // Bars that are always there say that the table goes on.
        ui.spacing_mut().scroll = ScrollStyle { bar_width: 8.0, ..ScrollStyle::solid() };
        ScrollArea::both().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            visited |= results(ui, state, (document, theme), actions);
        });
    });
    !(modal.should_close() || visited)
}

/// On what the chosen estimators run.
fn extent(state: &State) -> &'static str {
    let through_clip = chosen(state).iter().filter(|one| one.info().granularities[0] == "clip").count();
    match through_clip {
        0 => "All estimators run on this pair of frames, with the current parameters.",
        count if count == state.chosen.len() => "All estimators run through the clip, with the current parameters.",
        _ => "Estimators of a pair run on these two frames, the others through the clip, with the current parameters.",
    }
}

/// Chooses between a comparison of estimators and the course's table.
fn subject(ui: &mut Ui, state: &mut State, document: &Document) {
    ui.horizontal(|ui| {
        if ui.selectable_label(state.course.is_none(), "Estimators").clicked() {
            state.course = None;
        }
        let tip =
            "Full (in the course: sequential), logarithmic and hierarchical search: each statement of the course is measured on this clip.";
        let label = ui.selectable_label(state.course.is_some(), "The course's table");
        let label = label.on_hover_text(format!("{tip} {}", course_table::key().trim_end()));
        if let (true, None, Some(prepared)) = (label.clicked(), &state.course, document.prepared_alone()) {
            // Two measurements at once would spoil each other's times.
            (state.comparing, state.begun) = (None, None);
            let (clip, frame, ctx) = (prepared.clip, prepared.experiment.frame, ui.ctx().clone());
            state.course = Some(Background::new(
                "measure",
                move || ctx.request_repaint(),
                move |control| {
                    let (clip, threads) = (clip.until(control.stop.clone()), Threads::single());
                    course_table::course_table(
                        &Conditions { clip: &clip, frame, threads: &threads, repeats: Repeats::AsUsual },
                        &control.stop,
                    )
                },
            ));
        }
    });
    ui.add_space(4.0);
}

/// Shows the course's table once it is measured.
fn measured(ui: &mut Ui, course: &Background<Vec<CourseRow>>) {
    course.look(|outcome| match outcome {
        None => drop(ui.spinner()),
        Some(Err(error)) => drop(ui.label(RichText::new(error.to_string()).color(ui.visuals().error_fg_color))),
        Some(Ok(course_table)) => {
            Grid::new("course").striped(true).spacing([16.0, 6.0]).show(ui, |ui| {
                for heading in ["Measured", "Sequential", "Logarithmic", "Hierarchical", "The course"] {
                    ui.label(RichText::new(heading).small().family(style::bold()));
                }
                ui.end_row();
                course_table.iter().for_each(|row| line(ui, row));
            });
        }
    });
}

/// Shows a row: the feature, the three measurements, and whether the statement holds.
fn line(ui: &mut Ui, row: &CourseRow) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.vertical(|ui| {
        ui.set_max_width(15.0 * size);
        let (what, unit) = row.feature.split_once(": ").unwrap_or((&row.feature, ""));
        ui.add(Label::new(RichText::new(what).family(style::bold())).wrap());
        ui.add(Label::new(RichText::new(unit).small().weak()).wrap());
    });
    for cell in &row.measured {
        ui.label(RichText::new(cell).monospace());
    }
    ui.vertical(|ui| {
        // The rest of the dialog's width, which the measurements leave.
        ui.set_max_width((ui.clip_rect().max.x - ui.cursor().min.x - 12.0).clamp(12.0 * size, 24.0 * size));
        let verdict = RichText::new(row.verdict());
        ui.add(Label::new(if row.holds { verdict } else { verdict.family(style::bold()) }).wrap());
        ui.add(Label::new(RichText::new(row.said).small().weak()).wrap());
    });
    ui.end_row();
}

/// Names the chosen estimators, with a button that offers others.
fn summary(ui: &mut Ui, state: &mut State) {
    let named = |id: &&str| estimator(id).ok().map(|one| one.info().name);
    let names: Vec<_> = state.chosen.iter().filter_map(named).collect();
    ui.horizontal(|ui| {
        let tip = "Choose the estimators to compare.";
        state.is_choosing = ui.button("Change…").on_hover_text(tip).clicked();
        ui.add(Label::new(names.join(", ")).truncate());
    });
}

/// Chooses the estimators.
fn choice(ui: &mut Ui, state: &mut State) {
    let all: Vec<&'static Info> = estimators().iter().map(|estimator| estimator.info()).collect();
    let is_full = state.chosen.len() >= MOST;
    let count = RichText::new(format!("{} of {MOST}", state.chosen.len())).small().weak();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        let infos = state.chosen.iter().filter_map(|id| all.iter().find(|info| info.id == *id));
        let clicked: Vec<_> = infos
            .filter(|info| {
                let button = ui.add(Button::selectable(true, info.name));
                button.on_hover_text(format!("{} Click to remove it.", info.summary)).clicked()
            })
            .map(|info| info.id)
            .collect();
        state.chosen.retain(|id| !clicked.contains(id));
        ui.label(count);
        if ui.button("Done").on_hover_text("Give the results the room.").clicked() {
            state.is_choosing = false;
        }
    });
    families(ui, state, &all);
    let wanted = state.wanted.to_lowercase();
    let is_offered = |info: &&&'static Info| {
        let is_found = info.name.to_lowercase().contains(&wanted) || info.id.contains(&wanted);
        !state.chosen.contains(&info.id) && if wanted.is_empty() { info.family == state.family } else { is_found }
    };
    let offered: Vec<_> = all.iter().filter(is_offered).collect();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        if offered.is_empty() {
            ui.label(RichText::new("No other estimator here.").weak());
        }
        for info in offered {
            let button = ui.add_enabled(!is_full, Button::selectable(false, info.name));
            let full = format!("At most {MOST} estimators can be compared; remove one first.");
            if button.on_hover_text(info.summary).on_disabled_hover_text(full).clicked() {
                state.chosen.push(info.id);
            }
        }
    });
}

/// Chooses the family that is offered, or searches in all of them.
fn families(ui: &mut Ui, state: &mut State, all: &[&'static Info]) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        let search = TextEdit::singleline(&mut state.wanted).hint_text("Find an estimator").desired_width(11.0 * size);
        ui.add(search).accessible_name("Find an estimator");
        for family in all.chunk_by(|a, b| a.family == b.family).map(|of_family| of_family[0].family) {
            let is_now = state.family == family && state.wanted.is_empty();
            let tab = ui.add(Button::selectable(is_now, RichText::new(family).small()));
            if tab.clicked() {
                (state.family, state.wanted) = (family, String::new());
            }
        }
    });
}

/// Chooses the sweep and shows the progress of the comparison.
fn sweep(ui: &mut Ui, state: &mut State, document: &Document) {
    let label = ui.label("Sweep");
    let chosen = chosen(state);
    let of_clip = match document.source() {
        Some(Source::Synth { difficulty, .. }) => sweeps::of_sliders(difficulty),
        _ => Vec::new(),
    };
    let title = |sweep: &Option<Sweep>| sweep.as_ref().map_or("none".to_owned(), |sweep| sweep.title.clone());
    let limits = document.prepared_alone().map(|of| Limits::of(&of.clip, of.experiment.frame));
    let all = [("parameters", sweeps::of_estimators(&chosen, limits)), ("sliders of the clip", of_clip)];
    if state.sweep.as_ref().is_some_and(|sweep| all.iter().all(|(_, some)| !some.contains(sweep))) {
        state.sweep = None;
    }
    let combo = ComboBox::from_id_salt("sweep").selected_text(title(&state.sweep)).width(0.0);
    let shown = combo.show_ui(ui, |ui| {
        // A click on the dialog has put it above the list, and it would stay there.
        ui.ctx().move_to_top(ui.layer_id());
        ui.selectable_value(&mut state.sweep, None, title(&None));
        for (of, some) in all.into_iter().filter(|(_, some)| !some.is_empty()) {
            ui.label(RichText::new(of).small().weak());
            for sweep in some {
                let sweep = Some(sweep);
                let label = title(&sweep);
                ui.selectable_value(&mut state.sweep, sweep, label);
            }
        }
    });
    shown.response.labelled_by(label.id);
    if let Some(comparing) = state.comparing.as_ref().filter(|comparing| comparing.is_busy()) {
        ui.spinner();
        let (done, names) = (comparing.rows().len(), &comparing.names);
        let now = names.get(done).map_or_else(String::new, |name| format!(": {name}"));
        ui.label(RichText::new(format!("{} of {}{now}", (done + 1).min(names.len()), names.len())).weak());
    }
    let failure = state.comparing.as_ref().and_then(Comparing::failure).or_else(|| state.refused.clone());
    if let Some(error) = failure {
        ui.add(Label::new(RichText::new(error.to_string()).color(ui.visuals().error_fg_color)).wrap());
    }
}

/// The estimators that are chosen, with their default parameters.
fn chosen(state: &State) -> Vec<Box<dyn AnyEstimator>> {
    estimators().into_iter().filter(|estimator| state.chosen.contains(&estimator.info().id)).collect()
}

/// Shows the button for lockstep; returns whether it was clicked.
fn step_by_step(ui: &mut Ui, state: &State, actions: &mut Actions) -> bool {
    let mut taken = false;
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let chosen = chosen(state);
        let refused = lockstep::check(&chosen.iter().map(|one| &**one).collect::<Vec<_>>()).err();
        let button = ui.add_enabled(refused.is_none(), Button::new(Command::Lockstep.info().text));
        let tip = Command::Lockstep.with_key("Step the estimators through the same frames in lockstep.");
        let reason = refused.map_or_else(String::new, |error| error.to_string());
        taken = button.on_hover_text(tip).on_disabled_hover_text(reason).clicked();
    });
    if taken {
        actions.ask(Action::Lockstep(state.chosen.clone()));
    }
    taken
}

/// Restarts the comparison after a change of the selection.
fn start(ui: &Ui, state: &mut State, document: &Document) {
    let wanted = (state.chosen.clone(), state.sweep.clone());
    if state.begun.as_ref() != Some(&wanted) {
        // The name that nobody has changed fits what there is to save.
        let (table, plot) = (file_of(false), file_of(true));
        if [&table, &plot].contains(&&state.file.text) {
            state.file.text = if wanted.1.is_some() { plot } else { table };
        }
        state.begun = Some(wanted);
        let ctx = ui.ctx().clone();
        (state.comparing, state.refused) = match plan(state, document) {
            Ok(plan) => (plan.map(|plan| Comparing::new(plan, move || ctx.request_repaint())), None),
            Err(error) => (None, Some(error)),
        };
    }
}

/// Returns the chosen estimators with the changed parameters of the open one, where they have the same.
fn plan(state: &State, document: &Document) -> Result<Option<Plan>, Error> {
    let Some(prepared) = document.prepared_alone() else { return Ok(None) };
    let alike =
        chosen(state).into_iter().map(|estimator| changed_alike(document.estimator(), estimator)).collect::<Vec<_>>();
    let rounds = comparison::rounds(
        &prepared.experiment.source,
        &alike,
        state.sweep.as_ref().map(|sweep| sweep.setting.as_str()),
    )?;
    Ok(Some(Plan { prepared, rounds }))
}

/// Shows plot and table; returns whether a block is to be visited.
fn results(ui: &mut Ui, state: &mut State, of: (&Document, Theme), actions: &mut Actions) -> bool {
    let (document, theme) = of;
    let rows = state.comparing.as_ref().map_or_else(Vec::new, Comparing::rows);
    if std::mem::replace(&mut state.laid_out, rows.len()) != rows.len() {
        // The columns are as wide as their rows only in the next frame.
        ui.ctx().request_repaint();
    }
    if state.chosen.is_empty() {
        ui.label(RichText::new("Choose the estimators to compare.").weak());
        return false;
    }
    if rows.iter().any(|row| row.swept.is_some()) {
        let plotted = plotted(&rows, state);
        let series = sweep_plot::series(&rows, &plotted, state.sweep.as_ref().map_or("", |sweep| sweep.axis));
        let size = TextStyle::Body.resolve(ui.style()).size;
        ui.allocate_ui(vec2(ui.available_width().min(64.0 * size), 15.0 * size), |ui| {
            let subject = Subject { step: None, whose: "", theme, colors: ColorMap::default() };
            let input = series::Input { series: &series, subject, logarithmic: sweep_plot::is_wide(&series) };
            series::show(ui, input, &mut state.plot);
        });
        ui.add_space(4.0);
    }
    if !rows.is_empty() {
        export(ui, &rows, state, (document, theme), actions);
        ui.add_space(4.0);
    }
    let shown = match rows.is_empty() {
        true => {
            let truth = document.prepared_alone().is_some_and(|prepared| prepared.clip.truth().is_some());
            comparison::columns_before(&chosen(state), truth)
        }
        false => comparison::columns_of(&rows),
    };
    table(ui, (&rows, &shown), state, actions)
}

/// Copies the table, or saves the plot or the table in a file.
fn export(ui: &mut Ui, rows: &[Arc<Row>], state: &mut State, of: (&Document, Theme), actions: &mut Actions) {
    let is_swept = rows.iter().any(|row| row.swept.is_some());
    let size = TextStyle::Body.resolve(ui.style()).size;
    let mut is_entered = false;
    ui.horizontal(|ui| {
        if ui.button("Copy as CSV").on_hover_text("Copy all rows so far as CSV, for a spreadsheet.").clicked() {
            ui.copy_text(comparison::csv(rows));
        }
        ui.add_space(8.0);
        is_entered = state.file.show(ui, "File of the plot or the table", 24.0 * size);
        if ui.button("Browse…").clicked() {
            actions.ask(Action::Browse(Browse::SaveFile));
        }
        let tip = match is_swept {
            true => "Save the plot as .png, .svg or .pdf, or all rows as .csv: the end of the name decides.",
            false => "Save all rows as .csv. A sweep has a plot as well.",
        };
        is_entered |= ui.button("Save").on_hover_text(tip).clicked();
    });
    state.file.show_found(ui);
    if is_entered {
        let ctx = ui.ctx().clone();
        let saved = encoded(rows, state, of);
        state.saved = Some(Background::new("save", move || ctx.request_repaint(), move |_| saved?.save()));
    }
    if let Some(saved) = &state.saved {
        saved.look(|outcome| match outcome {
            Some(Ok(message)) => drop(ui.label(message.as_str())),
            Some(Err(why)) => {
                drop(ui.label(RichText::new(why.to_string()).color(ui.visuals().error_fg_color)));
            }
            None => {}
        });
    }
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
fn file_of(is_swept: bool) -> String {
    let name = if is_swept { "comparison.svg" } else { "comparison.csv" };
    std::env::current_dir().unwrap_or_default().join(name).display().to_string()
}

/// What the path asks for: the table, or the plot of the column that is shown.
fn encoded(rows: &[Arc<Row>], state: &State, (document, theme): (&Document, Theme)) -> Result<PendingFile, Error> {
    let message = || Error::new("enter a path that ends in .svg, .png, .pdf or .csv");
    let path = super::open::parse(&state.file.text).map(PathBuf::from).ok_or_else(message)?;
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
        if path.exists() {
            return Err(Error::new(format!("{} is there already; choose another name", path.display())));
        }
        media::export::check(&inputs, &[Target::File(&path)])
            .map_err(|conflict| Error::new(format!("{} {}; choose another name", path.display(), conflict.why)))?;
        let bytes = match content {
            Content::Table(table) => table.into_bytes(),
            Content::Plot(series, theme, format) => sweep_plot::encode(&series, theme, format, SCALE)?,
        };
        media::export::save_result(&path, &bytes)?;
        Ok(format!("Saved {}.", path.display()))
    }
}

/// The column that is plotted.
fn plotted(rows: &[Arc<Row>], state: &State) -> Column {
    let columns = comparison::all_columns();
    columns[state.plotted.unwrap_or_else(|| comparison::telling(rows)).min(columns.len() - 1)]
}

/// Shows the columns of the table; returns whether a block is to be visited.
fn table(
    ui: &mut Ui,
    (rows, shown): (&[Arc<Row>], &[(usize, Column)]),
    state: &mut State,
    actions: &mut Actions,
) -> bool {
    let (swept, mut visited) = (rows.first().and_then(|row| row.swept.as_ref()).map(|(name, _)| name.clone()), false);
    let plotted = state.plotted.unwrap_or_else(|| comparison::telling(rows));
    Grid::new("comparison").striped(true).spacing([12.0, 4.0]).show(ui, |ui| {
        let strong = |text: &str| RichText::new(broken(text)).small().family(style::bold());
        ui.label(strong("Estimator"));
        if let Some(name) = &swept {
            ui.label(strong(name));
        }
        for (i, column) in shown {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| match swept {
                Some(_) => {
                    let tip = format!("{} Click to plot it.", column.doc);
                    let heading = ui.selectable_label(plotted == *i, strong(column.heading));
                    if heading.on_hover_ui(|ui| glossary::tooltip(ui, &tip)).clicked() {
                        state.plotted = Some(*i);
                    }
                }
                None => drop(
                    ui.add(Label::new(strong(column.heading)).halign(Align::Max))
                        .on_hover_ui(|ui| glossary::tooltip(ui, column.doc)),
                ),
            });
        }
        ui.end_row();
        for row in rows {
            // Long names wrap, so that the columns with numbers have room.
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.set_width(NAME_LETTERS * TextStyle::Body.resolve(ui.style()).size);
                ui.add(Label::new(row.estimator.info().name).wrap());
            });
            if let Some((_, value)) = &row.swept {
                ui.label(value);
            }
            for (_, column) in shown {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    visited |= cell(ui, column, row, actions);
                });
            }
            ui.end_row();
        }
    });
    visited
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
