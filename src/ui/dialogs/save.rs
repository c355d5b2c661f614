//! Writing: where to, as what, and how it looks.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::{self, Align, Button, Layout, RichText, TextEdit, TextStyle, Ui, WidgetInfo, vec2};
use motionscope_core::params::{Kind as ParameterKind, Params, Spec, Value};
use motionscope_core::products::ProductKind;
use motionscope_core::run::Cursor;

use super::path::PathField;
use crate::experiment::Prepared;
use crate::experiment::source::Source;
use crate::files::{self, IN_PAGE, download};
use crate::media::export::{AnimationFormat, Inputs, MP4_DESCRIPTION, Timing};
use crate::media::names;
use crate::paint::{Freehand, Theme, grouped};
use crate::results::{self, Export};
use crate::ui::commands::{Action, Actions, Browse, CLIP_FRAME, ClipFormat, Granularities, Order, OutputKind};
use crate::ui::model::background::Background;
use crate::ui::model::snapshot::Snapshot;
use crate::ui::model::writer;
use crate::ui::parts::widgets;
use crate::view::handout::{Options, PerSheet};
use crate::view::look::{CaptionWords, Look};
use crate::view::panes::{Angles, PANES, Pane, STAGE, Selection};
use crate::view::rendering::Format;
use crate::view::steps::{Range, Steps};

/// Scales that can be chosen.
const SCALES: [u32; 4] = [1, 2, 4, 8];

/// Rates of an animation that can be chosen, in steps per second.
const RATES_HZ: [f32; 6] = [1.0, 2.0, 4.0, 8.0, 15.0, 25.0];
/// The container of recordings, whose file is copied as it is.
const Y4M: &str = "y4m";
/// The ending of compressed video.
const MP4: &str = "mp4";
/// Pictures between two steps of an animation that are blended of both.
const BLENDED: u32 = 4;

/// What the dialog writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The step that is shown.
    Picture,
    /// Several steps.
    Steps,
    /// What the run has made so far.
    Result,
    /// The session.
    Session,
    /// The scores of the class.
    Scores,
    /// The frames of the clip.
    Clip,
    /// All pages of the lesson on paper.
    Handout,
    /// The step on paper, to be computed by hand.
    Worksheet,
}

impl Kind {
    fn title(self) -> &'static str {
        match self {
            Kind::Picture => "Export the picture of this step",
            Kind::Steps => "Export several steps",
            Kind::Result => "Export the result so far",
            Kind::Session => "Save the session",
            Kind::Scores => "Save the scores of the class",
            Kind::Clip => "Save the clip",
            Kind::Handout => "Save a handout of the lesson",
            Kind::Worksheet => "Save a worksheet of this step",
        }
    }

    /// What can be chosen, of a run on `subject`; at least one.
    fn choices(self, subject: &Prepared) -> Vec<Choice> {
        let kinds: &[&ProductKind] = subject.experiment.estimator.produces();
        let choice = |ending, doc| Choice { label: label(ending), ending, doc, export: None, animation: None };
        let pictures = [
            choice("png", "PNG, pixels"),
            choice("svg", "SVG, lines that stay sharp"),
            choice("pdf", "PDF, a page with lines and words that stay sharp"),
        ];
        match self {
            Kind::Picture => pictures.into(),
            Kind::Steps => {
                let animations = AnimationFormat::ALL
                    .map(|format| Choice { animation: Some(format), ..choice(format.extension(), format.doc()) });
                pictures.into_iter().chain(animations).collect()
            }
            Kind::Session => vec![choice("motionscope", "Session")],
            Kind::Scores => vec![choice("csv", "CSV, a row for each question")],
            Kind::Clip => {
                let numbered = Choice { label: "Numbered PNG".into(), ..choice("png", "A picture for each frame") };
                let is_copied =
                    subject.clip.info().container == Y4M && matches!(subject.experiment.source, Source::File(_));
                let copied = is_copied.then(|| choice(Y4M, "Uncompressed video in one file, the frames as they came"));
                let video = choice(MP4, MP4_DESCRIPTION);
                copied.into_iter().chain([numbered, video]).collect()
            }
            Kind::Handout | Kind::Worksheet => vec![choice("pdf", "PDF, sheets of paper in A4")],
            Kind::Result => {
                let files = results::formats(kinds).into_iter().map(|(export, format)| Choice {
                    label: label(format.ending),
                    ending: format.ending,
                    doc: format.doc,
                    export: Some(export),
                    animation: None,
                });
                let folders = results::folders(kinds).map(|export| Choice {
                    label: export.name.into(),
                    ending: export.formats[0].ending,
                    doc: export.explained,
                    export: Some(export),
                    animation: None,
                });
                files.chain(folders).collect()
            }
        }
    }
}

/// Something that can be written, and as what.
struct Choice {
    label: String,
    ending: &'static str,
    doc: &'static str,
    /// What writes it, if it is a result.
    export: Option<&'static Export>,
    /// Its format, if it is an animation.
    animation: Option<AnimationFormat>,
}

fn label(ending: &str) -> String {
    if ending == "flo" { ".flo".to_owned() } else { ending.to_uppercase() }
}

/// How the window looks at what is written.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// How pictures look.
    pub look: Look,
    /// From where the things in space are looked at.
    pub angles: Angles,
}

/// The dialog while it is open.
pub struct State {
    kind: Kind,
    /// The file, or the folder for several.
    pub path: PathField,
    choices: Vec<Choice>,
    chosen: usize,
    scale: u32,
    /// How pictures will look: as they do in the window unless something else is chosen here.
    look: Look,
    /// The panes that the estimator may have, and which of them are written.
    panes: Vec<(&'static Pane, bool)>,
    angles: Angles,
    /// Those in which the step has nothing to show.
    absent: Vec<&'static str>,
    from: String,
    to: String,
    granularity: usize,
    timing: Timing,
    /// Pages on a sheet of paper, and whether answers are filled in.
    paper: Options,
    /// All files that the clip is read from.
    inputs: Arc<Inputs>,
    /// The target that was looked up, and what was found there.
    found: Option<(PathBuf, Found)>,
    /// The run whose steps are written.
    subject: Arc<Prepared>,
    /// The range whose pictures are being counted, or were.
    counting: Option<(Range, Background<usize>)>,
}

/// What lies already where something is to be written.
#[derive(Clone)]
struct Found {
    is_there: bool,
    /// Why it must not be written over.
    refused: Option<String>,
}

impl State {
    /// The dialog for `kind`, with a name that says what it is, in `folder`.
    pub fn new(kind: Kind, folder: &Path, stem: &str, shown: &Snapshot, Seen { look, angles }: Seen) -> Self {
        let estimator = &shown.subject.experiment.estimator;
        let offered = PANES.into_iter().filter(|pane| pane.check(&**estimator).is_ok());
        let step = shown.tiles.first().map_or(&shown.step, |tile| &tile.step);
        let absent = PANES.into_iter().filter(|pane| !(pane.is_available)(step)).map(|pane| pane.id).collect();
        let choices = kind.choices(&shown.subject);
        let from = Cursor { unit: shown.cursor.unit, event: 1 };
        // Before the first step the steps of the first unit are meant.
        let to = if shown.cursor < from { Cursor { event: usize::MAX, ..from } } else { shown.cursor };
        // A dark page wastes the ink of a printer, and does not go with the white pages of a document.
        let is_page = matches!(kind, Kind::Picture | Kind::Steps);
        let look = if is_page { Look { theme: Theme::Light, ..look } } else { look };
        let mut state = Self {
            kind,
            path: PathField::default(),
            choices,
            chosen: 0,
            scale: 2,
            look,
            panes: offered.map(|pane| (pane, *pane == STAGE)).collect(),
            angles,
            absent,
            from: from.to_string(),
            to: to.to_string(),
            granularity: Granularities::new(shown.info.granularities).event(),
            timing: Timing::default(),
            paper: Options::default(),
            inputs: Arc::clone(&shown.subject.inputs),
            found: None,
            subject: Arc::clone(&shown.subject),
            counting: None,
        };
        let ending = state.ending();
        let name = match kind {
            Kind::Picture => format!("{stem}_{}.{ending}", shown.cursor),
            Kind::Steps => format!("{stem}_steps"),
            Kind::Result if state.is_folder() => format!("{stem}_{}", state.choices[0].label.to_lowercase()),
            Kind::Result => format!("{stem}_result.{ending}"),
            Kind::Scores => format!("{stem}_scores.{ending}"),
            Kind::Clip if state.is_folder() => stem.to_owned(),
            Kind::Session | Kind::Clip => format!("{stem}.{ending}"),
            Kind::Handout => format!("{stem}_handout.{ending}"),
            Kind::Worksheet => format!("{stem}_{}_worksheet.{ending}", shown.cursor),
        };
        state.path = PathField::new(if IN_PAGE { name } else { folder.join(name).display().to_string() });
        state
    }

    fn explained(&self) -> &'static str {
        match (self.kind, self.choice().export) {
            (_, Some(export)) => export.explained,
            (Kind::Steps, _) if self.choice().animation.is_some() => "One file that plays the steps again and again.",
            (Kind::Steps, _) if IN_PAGE => "One numbered file for each step, in a zip file.",
            (Kind::Steps, _) => "One numbered file for each step, into a folder.",
            (Kind::Scores, _) => "The questions that were answered, with hands, guesses and distances.",
            (Kind::Clip, _) if self.is_folder() && IN_PAGE => {
                "A zip file with a picture for each frame, and with the ground truth if it is known."
            }
            (Kind::Clip, _) if self.is_folder() => {
                "A folder with a picture for each frame, and with the ground truth if it is known."
            }
            (Kind::Clip, _) if self.ending() == MP4 => {
                "H.264 video with loss: gray levels change a little, so results do too. Without ground truth and right view."
            }
            (Kind::Clip, _) => "One file with the frames as they came.",
            (Kind::Session, _) => "A small text file: clip, estimator, parameters, step, view and ink.",
            (Kind::Handout, _) => "All pages of the lesson, words beside pictures, on sheets of A4 paper.",
            (Kind::Worksheet, _) => "The given values of the step, with boxes for its results, on A4 paper.",
            _ if self.selection().panes.is_empty() => {
                "The visible part of the pictures, with the same colours and lines."
            }
            _ => "The panes that are chosen, arranged on one sheet, the stage largest.",
        }
    }

    fn choice(&self) -> &Choice {
        &self.choices[self.chosen]
    }

    fn ending(&self) -> &'static str {
        self.choice().ending
    }

    /// Whether several files are written into a folder.
    fn is_folder(&self) -> bool {
        let is_numbered = self.kind == Kind::Steps && self.choice().animation.is_none();
        let is_numbered = is_numbered || self.kind == Kind::Clip && self.ending() == "png";
        is_numbered || self.choice().export.is_some_and(|export| export.folder.is_some())
    }

    /// Where it is written to: a file has one of the endings of its kind.
    fn target(&self) -> Option<PathBuf> {
        let path = download::target(Path::new(&super::typed::parse(&self.path.text)?));
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        // Pictures of a clip have no file of their own.
        let is_file = |choice: &Choice| self.kind != Kind::Clip || choice.ending != "png";
        let is_known =
            ending.is_some_and(|ending| self.choices.iter().any(|choice| choice.ending == ending && is_file(choice)));
        if is_known || self.is_folder() {
            return Some(path);
        }
        Some(path.into_os_string()).map(|mut path| {
            path.push(".");
            path.push(self.ending());
            path.into()
        })
    }

    /// What is there already: the file itself, or numbered pictures in the folder.
    fn find(&mut self, order: &Order) -> Found {
        let target = &order.path;
        let file = match self.kind {
            Kind::Steps if self.is_folder() => target.join(Steps::file_name(0, self.format())),
            Kind::Clip if self.is_folder() => target.join(format!("{}0000.png", CLIP_FRAME)),
            _ => target.to_owned(),
        };
        // Looking may take a while on a drive far away: once for each name.
        match &self.found {
            Some((path, found)) if *path == file => found.clone(),
            _ => {
                let refused = writer::refuse_losses(order, &self.inputs).err().map(|why| format!("{why}."));
                let prefix = self.choice().export.and_then(|export| export.folder);
                let is_there = prefix.map_or_else(|| files::exists(&file), |prefix| holds_numbered(&file, prefix));
                let found = Found { is_there, refused };
                self.found.insert((file, found)).1.clone()
            }
        }
    }

    /// How many pictures the range comes to, in words; they are counted by a task.
    fn counted(&mut self, ctx: &egui::Context) -> Option<String> {
        let order = self.order().map(|Order { what, scale, look, panes, .. }| (what, scale, look, panes));
        let (range, scale, look, panes) = match order {
            Ok((OutputKind::Steps(range, _) | OutputKind::Animation(range, _), scale, look, panes)) => {
                (range, scale, look, panes)
            }
            _ => {
                self.counting = None;
                return None;
            }
        };
        if self.counting.as_ref().is_none_or(|(counted, _)| *counted != range) {
            let (pixel, freehand) = (None, Freehand::default());
            let steps = Steps { range, scale, look, panes, pixel, must_have_layer: false, freehand, turntable: 1 };
            let (subject, ctx) = (Arc::clone(&self.subject), ctx.clone());
            let work = Background::new(
                "count the steps",
                move || ctx.request_repaint(),
                async move |control| steps.count(&subject, Some(&**control)).await,
            );
            self.counting = Some((range, work));
        }
        let (_, counting) = self.counting.as_ref()?;
        let is_one = self.choice().animation.is_some();
        Some(counting.look(|outcome| match outcome {
            None => "Counting the pictures…".to_owned(),
            Some(Ok(1)) if is_one => "1 step.".to_owned(),
            Some(Ok(count)) if is_one => format!("{} steps.", grouped(*count)),
            Some(Ok(1)) => "Saves 1 file.".to_owned(),
            Some(Ok(count)) => format!("Saves {} files.", grouped(*count)),
            Some(Err(error)) => format!("{error}."),
        }))
    }

    /// Whether the files of the range are counted, for tests.
    pub fn is_settled(&self) -> bool {
        self.counting.as_ref().is_none_or(|(_, counting)| counting.look(|outcome| outcome.is_some()))
    }

    fn format(&self) -> Format {
        self.ending().parse().unwrap_or(Format::Png)
    }

    /// The panes that are written; none for the stage alone.
    fn selection(&self) -> Selection {
        let chosen: Vec<_> = self.panes.iter().filter(|(_, is_chosen)| *is_chosen).map(|(pane, _)| *pane).collect();
        let panes = if chosen.iter().all(|pane| **pane == STAGE) { Vec::new() } else { chosen };
        Selection { panes, angles: self.angles }
    }

    /// What the dialog asks for, or what is wrong with it.
    fn order(&self) -> Result<Order, String> {
        let path = self.target().ok_or(if IN_PAGE { "Enter a file name." } else { "Enter an output path." })?;
        let what = match self.kind {
            Kind::Picture => OutputKind::Picture,
            Kind::Result => OutputKind::Result(self.export(&path).ok_or("Choose a result to save.")?),
            Kind::Session => OutputKind::Session,
            Kind::Scores => OutputKind::Scores,
            Kind::Clip if self.is_folder() => OutputKind::Clip(ClipFormat::Pictures),
            // What was typed may have the ending of the other kind of file.
            Kind::Clip if ends_in(&path, MP4) => OutputKind::Clip(ClipFormat::Video),
            Kind::Clip => OutputKind::Clip(ClipFormat::Copy),
            Kind::Handout => OutputKind::Handout(self.paper),
            Kind::Worksheet => OutputKind::Worksheet { answers: self.paper.answers },
            Kind::Steps => {
                let cursor = |text: &str| text.trim().parse::<Cursor>().map_err(|error| format!("{error}."));
                let (from, to) = (cursor(&self.from)?, cursor(&self.to)?);
                if to < from {
                    return Err("The last step lies before the first.".into());
                }
                let range = Range { from, to, granularity: self.granularity };
                match self.choice().animation {
                    Some(_) => OutputKind::Animation(range, self.timing),
                    None => OutputKind::Steps(range, self.format()),
                }
            }
        };
        Ok(Order { what, path, scale: self.scale, look: self.look, panes: self.selection() })
    }

    /// What writes a result to `path`: what was chosen, unless the ending that was typed is that of another.
    fn export(&self, path: &Path) -> Option<&'static Export> {
        let typed = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let is_typed = |choice: &&Choice| {
            choice.export.is_some_and(|export| export.folder.is_none()) && typed.as_deref() == Some(choice.ending)
        };
        let other = self.choices.iter().find(is_typed).filter(|_| !self.is_folder());
        other.unwrap_or(self.choice()).export
    }

    fn choose(&mut self, index: usize) {
        let was_folder = self.is_folder();
        self.chosen = index;
        let path = Path::new(&self.path.text);
        self.path.text = match (was_folder, self.is_folder()) {
            (_, true) => path.with_extension(""),
            (true, false) | (false, false) => path.with_extension(self.ending()),
        }
        .display()
        .to_string();
    }
}

/// Shows the dialog; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, granularities: Granularities, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let mut done = false;
    let modal = widgets::modal(ctx, "save", vec2(40.0 * size, 30.0 * size)).show(ctx, |ui| {
        ui.set_width((40.0 * size).min(widgets::room_of_dialog(ui.ctx()).x));
        ui.heading(state.kind.title());
        ui.label(RichText::new(state.explained()).weak());
        ui.add_space(8.0);
        options(ui, state, granularities);
        ui.add_space(4.0);
        let entered = path_row(ui, state, actions);
        ui.add_space(12.0);
        done = buttons(ui, state, entered, actions);
    });
    !(modal.should_close() || done)
}

fn line(ui: &mut Ui, label: &str, add: impl FnOnce(&mut Ui)) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.horizontal(|ui| {
        ui.allocate_ui_with_layout(
            vec2(6.0 * size, ui.spacing().interact_size.y),
            Layout::left_to_right(Align::Center),
            |ui| {
                ui.set_min_width(6.0 * size);
                ui.label(RichText::new(label).weak());
            },
        );
        ui.horizontal_wrapped(add);
    });
}

fn options(ui: &mut Ui, state: &mut State, granularities: Granularities) {
    if state.choices.len() > 1 {
        let mut chosen = state.chosen;
        line(ui, "Format", |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for (i, Choice { label, doc, .. }) in state.choices.iter().enumerate() {
                if ui.selectable_label(chosen == i, label).on_hover_text(*doc).clicked() {
                    chosen = i;
                }
            }
        });
        if chosen != state.chosen {
            state.choose(chosen);
            if ui.input(|input| input.pointer.any_released()) && !widgets::is_upright(ui.ctx()) {
                // After a click Enter saves; on a phone a keyboard would come up.
                state.path.focus();
            }
        }
    }
    if state.kind == Kind::Steps {
        range(ui, state, granularities);
    }
    if matches!(state.kind, Kind::Handout | Kind::Worksheet) {
        paper(ui, state);
    }
    if !matches!(state.kind, Kind::Picture | Kind::Steps) {
        return;
    }
    if state.choice().animation.is_some() {
        timing(ui, &mut state.timing);
    }
    if state.ending() == "png" || state.choice().animation.is_some() {
        line(ui, "Scale", |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for scale in SCALES {
                let tip = "Scale: pixels of the file per pixel of the clip.";
                if ui.selectable_label(state.scale == scale, format!("{scale}×")).on_hover_text(tip).clicked() {
                    state.scale = scale;
                }
            }
        });
    }
    choice_of_look(ui, ("Theme", "theme"), &mut state.look);
    if state.ending() == "svg" {
        choice_of_look(ui, ("Words", "svg-text"), &mut state.look);
    }
    panes(ui, state);
    let is_sheet = !state.selection().panes.is_empty();
    caption(ui, state, is_sheet);
    line(ui, "With", |ui| {
        for (index, spec) in Look::entries().iter().enumerate() {
            if let Value::Switch(mut on) = state.look.value(index) {
                let switch = egui::Checkbox::new(&mut on, &spec.label);
                let response = ui.add(switch).on_hover_text(&spec.doc);
                if response.changed() {
                    state.look.set_value(index, Value::Switch(on)).unwrap_or_default();
                }
                ui.add_space(8.0);
            }
        }
    });
}

/// What stands on sheets of paper.
fn paper(ui: &mut Ui, state: &mut State) {
    if state.kind == Kind::Handout {
        line(ui, "Pages", |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for per_sheet in PerSheet::ALL {
                let (chosen, count) = (state.paper.per_sheet == per_sheet, per_sheet.count());
                let tip = format!("Pages of the lesson on each sheet: {count}.");
                if ui.selectable_label(chosen, count.to_string()).on_hover_text(tip).clicked() {
                    state.paper.per_sheet = per_sheet;
                }
            }
            ui.label(RichText::new("on a sheet").weak());
        });
    }
    line(ui, "With", |ui| {
        let tip = "Fill in the answers, for the teacher.";
        ui.checkbox(&mut state.paper.answers, "Answers").on_hover_text(tip);
    });
}

/// The rate of an animation, and whether its steps turn into each other.
fn timing(ui: &mut Ui, timing: &mut Timing) {
    line(ui, "Rate", |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for rate_hz in RATES_HZ {
            if ui.selectable_label(timing.rate_hz == rate_hz, format!("{rate_hz}")).clicked() {
                timing.rate_hz = rate_hz;
            }
        }
        ui.label(RichText::new("steps/s").weak());
    });
    line(ui, "Turn", |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (between, label, tip) in [
            (0, "At once", "Each step replaces the one before it at once."),
            (BLENDED, "Blended", "Each step turns into the next by pictures that are blended of both."),
        ] {
            if ui.selectable_label(timing.between == between, label).on_hover_text(tip).clicked() {
                timing.between = between;
            }
        }
    });
}

/// One of the values of the view option `name`.
fn choice_of_look(ui: &mut Ui, (label, name): (&str, &str), look: &mut Look) {
    let found = Look::entries().iter().enumerate().find(|(_, spec)| spec.name == name);
    let Some((index, Spec { kind: ParameterKind::Choice(choices), .. })) = found else { return };
    line(ui, label, |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for choice in choices {
            let value = Value::Choice(choice.name);
            let is_chosen = look.value(index) == value;
            let name = format!("{label}: {}", choice.label.to_lowercase());
            let button = ui.selectable_label(is_chosen, choice.label).on_hover_text(choice.doc);
            button.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_chosen, &name));
            if button.clicked() {
                look.set_value(index, value).unwrap_or_default();
            }
        }
    });
}

/// The words around the pictures.
fn caption(ui: &mut Ui, state: &mut State, is_sheet: bool) {
    line(ui, "Caption", |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (words, text, tip) in [
            (CaptionWords::Off, "None", "No caption."),
            (CaptionWords::On, "Sentence", "Clip, estimator, parameters, step and its sentence."),
            (CaptionWords::Full, "With formula", "The same with the formula of the step and its numbers."),
        ] {
            let name = format!("Caption: {}", text.to_lowercase());
            let chosen = state.look.caption == words;
            // A sheet has a heading and its own panes anyway.
            let button = ui.add_enabled(!is_sheet, Button::selectable(chosen, text));
            button.widget_info(|| WidgetInfo::selected(egui::Role::Button, !is_sheet, chosen, &name));
            let button =
                button.on_hover_text(tip).on_disabled_hover_text("A sheet has a heading; choose the explanation pane.");
            if button.clicked() {
                state.look.caption = words;
            }
        }
    });
}

/// What stands beside the stage.
fn panes(ui: &mut Ui, state: &mut State) {
    let is_picture = state.kind == Kind::Picture;
    line(ui, "Panes", |ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 2.0);
        for (pane, is_chosen) in &mut state.panes {
            let is_there = !is_picture || !state.absent.contains(&pane.id);
            let label = ui.add_enabled(is_there, Button::selectable(*is_chosen, pane.title));
            let tip = format!("Shows {}, {}.", pane.doc, pane.when);
            if label.on_hover_text(&tip).on_disabled_hover_text(tip).clicked() {
                *is_chosen = !*is_chosen;
            }
        }
    });
}

fn range(ui: &mut Ui, state: &mut State, granularities: Granularities) {
    line(ui, "Steps", |ui| {
        for (text, name) in [(&mut state.from, "First step"), (&mut state.to, "Last step")] {
            let response = ui.add(TextEdit::singleline(text).desired_width(90.0)).accessible_name(name);
            response.on_hover_text(format!("{name}, as UNIT.EVENT, the step of the status line: both count from 1, and 0 is the start. A unit alone is its end."));
        }
        ui.add(egui::Label::new(RichText::new("as UNIT.EVENT").small().weak()).extend());
    });
    line(ui, "Every", |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for granularity in [granularities.event(), granularities.unit()] {
            if ui.selectable_label(state.granularity == granularity, granularities.name(granularity)).clicked() {
                state.granularity = granularity;
            }
        }
        if let Some(counted) = state.counted(ui.ctx()) {
            ui.add_space(8.0);
            ui.label(RichText::new(counted).weak());
        }
    });
}

/// The path and the way to the system's dialog; gives whether Enter was pressed.
fn path_row(ui: &mut Ui, state: &mut State, actions: &mut Actions) -> bool {
    let mut entered = false;
    let several = state.is_folder();
    let label = match (several, IN_PAGE) {
        (true, true) => "Zip file",
        (true, false) => "Folder",
        (false, _) => "File",
    };
    line(ui, label, |ui| {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let width = ui.available_width() - 6.5 * size;
        entered = state.path.show(ui, if IN_PAGE { "File name" } else { "Output path" }, width);
        if !IN_PAGE && ui.button("Browse…").clicked() {
            actions.ask(Action::Browse(if several { Browse::SaveFolder } else { Browse::SaveFile }));
        }
    });
    state.path.show_found(ui);
    entered
}

fn buttons(ui: &mut Ui, state: &mut State, entered: bool, actions: &mut Actions) -> bool {
    let (mut order, mut replaces) = (state.order(), false);
    if let Ok(wanted) = &order {
        let Found { is_there, refused } = state.find(wanted);
        replaces = is_there;
        order = refused.map_or(order, Err);
    }
    let mut done = false;
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let on = ui.visuals().panel_fill;
            let (text, fill) = if replaces {
                ("Replace", ui.visuals().error_fg_color)
            } else {
                ("Save", ui.visuals().hyperlink_color)
            };
            let write = ui.add_enabled(order.is_ok(), Button::new(RichText::new(text).color(on)).fill(fill));
            // Enter in the field does not replace anything; Enter once more, on the button, does.
            if entered && replaces {
                write.request_focus();
            }
            done = ui.button("Cancel").clicked();
            let (message, ink) = match order {
                Ok(order) if write.clicked() || entered && !replaces => {
                    actions.ask(Action::Write(Box::new(order)));
                    done = true;
                    return;
                }
                Ok(order) if replaces => (already(state.is_folder(), &order.path), ui.visuals().text_color()),
                Ok(_) => return,
                Err(why) => (why, ui.visuals().error_fg_color),
            };
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(message).small().color(ink)).wrap());
            });
        });
    });
    done
}

/// Whether the name of a file has this ending.
fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|typed| typed.eq_ignore_ascii_case(ending))
}

/// Says what would be replaced.
fn already(is_folder: bool, path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let name = widgets::elide(&name, 40);
    match is_folder {
        true => format!("There are numbered pictures in {name} already."),
        false => format!("There is a {name} already."),
    }
}

/// Whether there is a file in `folder` whose name begins with `prefix`.
fn holds_numbered(folder: &Path, prefix: &str) -> bool {
    files::entries(folder).any(|path| names::file_name(&path).starts_with(prefix))
}

/// A name for files about a clip called `name`: letters, digits and dashes.
pub fn stem(name: &str) -> String {
    let name = Path::new(name).file_stem().map_or_else(|| name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    let plain: String = name.chars().map(|c| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect();
    let words: Vec<_> = plain.split('-').filter(|word| !word.is_empty()).take(6).collect();
    if words.is_empty() { "motionscope".into() } else { widgets::elide(&words.join("-"), 40) }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{ends_in, stem};

    #[test]
    fn the_ending_of_a_name_is_read_in_any_case() {
        assert!(ends_in(Path::new("a.b/hand.MP4"), "mp4") && !ends_in(Path::new("mp4"), "mp4"));
        assert!(!ends_in(Path::new("hand.mp4.y4m"), "mp4"));
    }

    #[test]
    fn names_of_files_are_plain() {
        assert_eq!(stem("Waves behind a pillar"), "waves-behind-a-pillar");
        assert_eq!(stem("ball_toss.mp4"), "ball-toss");
        assert_eq!(stem("…"), "motionscope");
    }
}
