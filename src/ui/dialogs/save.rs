//! Writing: where to, as what, and how it looks.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::{self, Align, Button, Layout, RichText, TextEdit, TextStyle, Ui, vec2};
use motionscope_core::Cursor;

use crate::media::export::{self, Inputs};
use crate::shot::{Format, Look, Steps};
use crate::ui::action::{Action, Actions, Browse};
use crate::ui::commands::Rungs;
use crate::ui::model::snapshot::Snapshot;
use crate::ui::model::writer::{self, Order, What};
use crate::ui::parts::widgets;

/// Scales that can be chosen.
const SCALES: [u32; 4] = [1, 2, 4, 8];

/// What the dialog writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The step that is shown.
    Picture,
    /// Several steps.
    Steps,
    /// The vectors.
    Vectors,
    /// The objects, or what was detected.
    Objects,
    /// The mask of each frame.
    Masks,
    /// The session.
    Session,
}

impl Kind {
    fn title(self) -> &'static str {
        match self {
            Kind::Picture => "Export the picture of this step",
            Kind::Steps => "Export pictures of several steps",
            Kind::Vectors => "Export the vectors found so far",
            Kind::Objects => "Export the objects found so far",
            Kind::Masks => "Export the masks found so far",
            Kind::Session => "Save the session",
        }
    }

    fn explained(self) -> &'static str {
        match self {
            Kind::Picture => "What the stage shows, whole, with the same colours and lines.",
            Kind::Steps => "One numbered file for each step, into a folder.",
            Kind::Vectors => "As a table, or as a field with one vector for each pixel.",
            Kind::Objects => "Where each object was in each frame, as a table, as MOTChallenge rows or as an array.",
            Kind::Masks => "One picture for each frame, white where something was found, into a folder.",
            Kind::Session => "A small text file: clip, estimator, parameters, step and view.",
        }
    }

    /// Whether several files are written into a folder.
    fn is_folder(self) -> bool {
        matches!(self, Kind::Steps | Kind::Masks)
    }

    /// The endings that can be chosen, and what they are.
    fn endings(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Kind::Picture | Kind::Steps => &[("png", "PNG, pixels"), ("svg", "SVG, lines that stay sharp")],
            Kind::Vectors => &[
                ("csv", "CSV, a row for each block"),
                ("npy", "NPY, an array for NumPy"),
                ("flo", "Middlebury .flo"),
                ("png", "KITTI 16-bit PNG"),
            ],
            Kind::Objects => &[
                ("csv", "CSV, a row for each object in each frame"),
                ("txt", "MOTChallenge rows, for scores by other programs"),
                ("npy", "NPY, an array for NumPy"),
            ],
            Kind::Masks => &[("png", "PNG, pixels")],
            Kind::Session => &[("motionscope", "Session")],
        }
    }
}

/// The dialog while it is open.
pub struct State {
    kind: Kind,
    /// The file, or the folder for several.
    pub path: String,
    ending: &'static str,
    scale: u32,
    legend: bool,
    caption: bool,
    from: String,
    to: String,
    rung: usize,
    /// The first frame of the run.
    first: usize,
    focused: bool,
    /// All files that the clip is read from.
    inputs: Arc<Inputs>,
    /// The target that was looked up, and what was found there.
    found: Option<(PathBuf, Found)>,
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
    pub fn new(kind: Kind, folder: &Path, stem: &str, shown: &Snapshot, look: Look) -> Self {
        let ending = kind.endings()[0].0;
        let from = Cursor { unit: shown.cursor.unit, event: 1 };
        // Before the first step the steps of the first unit are meant.
        let to = if shown.cursor < from { Cursor { event: usize::MAX, ..from } } else { shown.cursor };
        let name = match kind {
            Kind::Picture => format!("{stem}_{}.{ending}", shown.cursor),
            Kind::Steps => format!("{stem}_steps"),
            Kind::Vectors => format!("{stem}_vectors.{ending}"),
            Kind::Objects => format!("{stem}_objects.{ending}"),
            Kind::Masks => format!("{stem}_masks"),
            Kind::Session => format!("{stem}.{ending}"),
        };
        Self {
            kind,
            path: folder.join(name).display().to_string(),
            ending,
            scale: 2,
            legend: look.legend,
            caption: look.caption,
            from: from.to_string(),
            to: to.to_string(),
            rung: Rungs::new(shown.info.rungs).event(),
            first: shown.subject.frame,
            focused: false,
            inputs: Arc::clone(&shown.subject.inputs),
            found: None,
        }
    }

    /// Where it is written to: a file has one of the endings of its kind.
    fn target(&self) -> Option<PathBuf> {
        let path = PathBuf::from(super::open::parse(&self.path)?);
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let is_known = ending.is_some_and(|ending| self.kind.endings().iter().any(|(known, _)| *known == ending));
        if is_known || self.kind.is_folder() {
            return Some(path);
        }
        Some(path.into_os_string()).map(|mut path| {
            path.push(".");
            path.push(self.ending);
            path.into()
        })
    }

    /// What is there already: the file itself, or numbered pictures in the folder.
    fn find(&mut self, order: &Order) -> Found {
        let target = &order.path;
        let file = match self.kind {
            Kind::Steps => target.join(Steps::file_name(0, self.format())),
            Kind::Masks => target.join(export::mask_name(self.first)),
            _ => target.to_owned(),
        };
        // Looking may take a while on a drive far away: once for each name.
        match &self.found {
            Some((path, found)) if *path == file => found.clone(),
            _ => {
                let refused = writer::refuse_losses(order, &self.inputs).err().map(|why| format!("{why}."));
                let found = Found { is_there: file.exists(), refused };
                self.found.insert((file, found)).1.clone()
            }
        }
    }

    fn format(&self) -> Format {
        if self.ending == "svg" { Format::Svg } else { Format::Png }
    }

    /// What the dialog asks for, or what is wrong with it.
    fn order(&self, look: Look) -> Result<Order, String> {
        let path = self.target().ok_or("Type where to write it.")?;
        let what = match self.kind {
            Kind::Picture => What::Picture,
            Kind::Vectors | Kind::Objects => What::Vectors,
            Kind::Masks => What::Masks,
            Kind::Session => What::Session,
            Kind::Steps => {
                let cursor = |text: &str| text.trim().parse::<Cursor>().map_err(|error| format!("{error}."));
                let (from, to) = (cursor(&self.from)?, cursor(&self.to)?);
                if to < from {
                    return Err("The last step lies before the first.".into());
                }
                What::Steps { from, to, rung: self.rung, format: self.format() }
            }
        };
        let look = Look { legend: self.legend, caption: self.caption, ..look };
        Ok(Order { what, path, scale: self.scale, look })
    }

    fn set_ending(&mut self, ending: &'static str) {
        self.ending = ending;
        if !self.kind.is_folder() {
            self.path = Path::new(&self.path).with_extension(ending).display().to_string();
        }
    }
}

/// Shows the dialog; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, rungs: Rungs, look: Look, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let mut done = false;
    let modal = widgets::modal(ctx, "save", vec2(40.0 * size, 30.0 * size)).show(ctx, |ui| {
        ui.set_width((40.0 * size).min(ui.ctx().content_rect().width() - 48.0));
        ui.heading(state.kind.title());
        ui.label(RichText::new(state.kind.explained()).weak());
        ui.add_space(8.0);
        options(ui, state, rungs);
        ui.add_space(4.0);
        let entered = path_row(ui, state, actions);
        ui.add_space(12.0);
        done = buttons(ui, state, look, entered, actions);
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
        add(ui);
    });
}

fn options(ui: &mut Ui, state: &mut State, rungs: Rungs) {
    let endings = state.kind.endings();
    if endings.len() > 1 {
        line(ui, "Format", |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for (ending, doc) in endings {
                let name = if *ending == "flo" { ".flo".to_owned() } else { ending.to_uppercase() };
                if ui.selectable_label(state.ending == *ending, name).on_hover_text(*doc).clicked() {
                    state.set_ending(ending);
                }
            }
        });
    }
    if state.kind == Kind::Steps {
        range(ui, state, rungs);
    }
    if !matches!(state.kind, Kind::Picture | Kind::Steps) {
        return;
    }
    if state.ending == "png" {
        line(ui, "Scale", |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for scale in SCALES {
                let tip = "Pixels of the file for each pixel of the clip.";
                if ui.selectable_label(state.scale == scale, format!("{scale}×")).on_hover_text(tip).clicked() {
                    state.scale = scale;
                }
            }
        });
    }
    line(ui, "With", |ui| {
        ui.checkbox(&mut state.legend, "Legend").on_hover_text("What the marks mean, below the pictures.");
        ui.add_space(8.0);
        ui.checkbox(&mut state.caption, "Caption").on_hover_text("Estimator, parameters and the sentence of the step.");
    });
}

fn range(ui: &mut Ui, state: &mut State, rungs: Rungs) {
    line(ui, "Steps", |ui| {
        for (text, name) in [(&mut state.from, "First step"), (&mut state.to, "Last step")] {
            let response = ui.add(TextEdit::singleline(text).desired_width(90.0)).accessible_name(name);
            response.on_hover_text(format!("{name}, as UNIT.EVENT; a unit alone is its end."));
        }
        ui.label(RichText::new("as UNIT.EVENT").small().weak());
    });
    line(ui, "Every", |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for rung in [rungs.event(), rungs.unit()] {
            if ui.selectable_label(state.rung == rung, rungs.name(rung)).clicked() {
                state.rung = rung;
            }
        }
    });
}

/// The path and the way to the system's dialog; gives whether Enter was pressed.
fn path_row(ui: &mut Ui, state: &mut State, actions: &mut Actions) -> bool {
    let mut entered = false;
    let several = state.kind.is_folder();
    line(ui, if several { "Folder" } else { "File" }, |ui| {
        let size = TextStyle::Body.resolve(ui.style()).size;
        let field = TextEdit::singleline(&mut state.path).desired_width(ui.available_width() - 6.5 * size);
        let response = ui.add(field).accessible_name("Where to write it");
        if !std::mem::replace(&mut state.focused, true) {
            response.request_focus();
        }
        entered = response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        if ui.button("Browse…").clicked() {
            actions.ask(Action::Browse(if several { Browse::SaveFolder } else { Browse::SaveFile }));
        }
    });
    entered
}

fn buttons(ui: &mut Ui, state: &mut State, look: Look, entered: bool, actions: &mut Actions) -> bool {
    let (mut order, mut replaces) = (state.order(look), false);
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
                ("Write", ui.visuals().hyperlink_color)
            };
            let write = ui.add_enabled(order.is_ok(), Button::new(RichText::new(text).color(on)).fill(fill));
            // Enter in the field does not replace anything; Enter once more, on the button, does.
            if entered && replaces {
                write.request_focus();
            }
            done = ui.button("Cancel").clicked();
            let (told, ink) = match order {
                Ok(order) if write.clicked() || entered && !replaces => {
                    actions.ask(Action::Write(Box::new(order)));
                    done = true;
                    return;
                }
                Ok(order) if replaces => (already(state.kind, &order.path), ui.visuals().text_color()),
                Ok(_) => return,
                Err(why) => (why, ui.visuals().error_fg_color),
            };
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(told).small().color(ink)).wrap());
            });
        });
    });
    done
}

/// Says what would be replaced.
fn already(kind: Kind, path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let name = widgets::elide(&name, 40);
    match kind {
        Kind::Steps | Kind::Masks => format!("There are numbered pictures in {name} already."),
        _ => format!("There is a {name} already."),
    }
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
    use super::stem;

    #[test]
    fn names_of_files_are_plain() {
        assert_eq!(stem("Waves behind a pillar"), "waves-behind-a-pillar");
        assert_eq!(stem("ball_toss.mp4"), "ball-toss");
        assert_eq!(stem("…"), "motionscope");
    }
}
