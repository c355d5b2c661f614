//! Opening a clip: a typed path, the system's dialog beside it, and what was open lately.

use std::ffi::OsString;
use std::path::PathBuf;

use eframe::egui::{self, RichText, TextStyle, Ui, vec2};
use lucide_icons::Icon;
use motionscope_core::base::Error;
use motionscope_core::base::words::capital;

use super::path::PathField;
use super::typed::parse;
use crate::files::IN_PAGE;
use crate::ui::commands::{Action, Actions, Browse, Command};
use crate::ui::parts::{recent, widgets};

/// What a dialog opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Purpose {
    /// A clip or a session, or the truth of the open clip.
    #[default]
    Clip,
    /// The right view of the open clip.
    RightView,
}

/// The dialog while it is open.
#[derive(Default)]
pub struct State {
    purpose: Purpose,
    path: PathField,
    /// The path that is being opened; the dialog stays until that is done.
    opening: Option<OsString>,
    /// Why the last one was not opened.
    error: Option<String>,
}

impl State {
    /// The dialog with something typed in it already.
    pub fn asking(path: impl Into<String>) -> Self {
        Self { path: PathField::new(path), ..Self::default() }
    }

    /// The dialog for the right view of the open clip.
    pub fn of_right_view() -> Self {
        Self { purpose: Purpose::RightView, ..Self::default() }
    }

    /// Whether the dialog waits for a path to be opened.
    pub fn is_opening(&self) -> bool {
        self.opening.is_some()
    }

    /// Tells why a path was not opened, and gives the field the keyboard again, with its text.
    pub fn refuse(&mut self, why: &Error) {
        (self.opening, self.error) = (None, Some(capital(&why.to_string()) + "."));
        self.path.focus();
    }

    fn open(&mut self, path: OsString, actions: &mut Actions) {
        (self.opening, self.error) = (Some(path.clone()), None);
        actions.ask(match self.purpose {
            Purpose::Clip => Action::Open(path),
            Purpose::RightView => Action::OpenRightView(path),
        });
    }
}

/// Shows the dialog; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, recent: &[PathBuf], actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let mut done = false;
    let modal = widgets::modal(ctx, "open", vec2(40.0 * size, 30.0 * size)).show(ctx, |ui| {
        ui.set_width((40.0 * size).min(ui.ctx().content_rect().width() - 48.0));
        let is_clip = state.purpose == Purpose::Clip;
        done |= widgets::title(ui, if is_clip { "Open" } else { "Open right view" });
        let text = match state.purpose {
            Purpose::Clip => {
                "A video, a picture of a numbered sequence, a folder of pictures, detections (det.txt) or a session; \
                 or what belongs to the open clip: its detections, or its ground truth (gt.txt, a flow, a disparity)."
            }
            Purpose::RightView => {
                "The right view of the open clip: a picture, a folder of pictures or a video of the same size; or side-by-side, if each \
                 frame shows both views. A calib.txt beside the clip is read for depths in metres."
            }
        };
        ui.label(RichText::new(text).weak());
        ui.add_space(8.0);
        if IN_PAGE {
            ui.label("Drop files or a folder on the page, or choose them here. They stay on this computer.");
        } else {
            path_row(ui, state, actions);
        }
        outcome(ui, state, actions);
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            let [file, folder] = match state.purpose {
                Purpose::Clip => [Browse::File, Browse::Folder],
                Purpose::RightView => [Browse::RightFile, Browse::RightFolder],
            };
            for (glyph, text, wanted) in
                [(Icon::FileVideo, "Browse files…", file), (Icon::Folder, "Browse folders…", folder)]
            {
                if ui.button((widgets::icon(ui, glyph), text)).clicked() {
                    actions.ask(Action::Browse(wanted));
                    done = true;
                }
            }
            if is_clip && ui.button((widgets::icon(ui, Command::Samples.entry().icon), "Samples…")).clicked() {
                actions.command(Command::Samples);
                done = true;
            }
        });
        if is_clip && !recent.is_empty() {
            ui.add_space(12.0);
            widgets::heading(ui, "Recent");
            if let Some(path) = recent::chosen_of(ui, recent) {
                state.open(path.into(), actions);
            }
        }
    });
    !(modal.should_close() || done)
}

/// The field and the button beside it.
fn path_row(ui: &mut Ui, state: &mut State, actions: &mut Actions) {
    ui.horizontal(|ui| {
        first_line_only(ui);
        let button = ui.spacing().interact_size.x + 32.0;
        let width = ui.available_width() - button - 8.0;
        let entered = state.path.show(ui, "Path of the clip", width);
        let wanted = parse(&state.path.text).filter(|_| !state.is_opening());
        let clicked = ui.add_enabled(wanted.is_some(), egui::Button::new("Open")).clicked();
        if let Some(path) = wanted.filter(|_| entered || clicked) {
            state.open(path, actions);
        }
    });
    state.path.show_found(ui);
}

/// That a path is being opened, or why it was not.
fn outcome(ui: &mut Ui, state: &mut State, actions: &mut Actions) {
    if let Some(path) = &state.opening {
        let name = widgets::elide(&path.to_string_lossy(), 56);
        let cancelled = ui.horizontal(|ui| {
            ui.spinner();
            ui.label(RichText::new(format!("Opening {name}…")).weak());
            ui.button("Cancel").clicked()
        });
        if cancelled.inner {
            actions.ask(Action::CancelOpening);
            state.opening = None;
            state.path.focus();
        }
    }
    if let Some(error) = &state.error {
        ui.horizontal_wrapped(|ui| {
            ui.label(widgets::icon(ui, Icon::TriangleAlert).color(ui.visuals().error_fg_color));
            ui.label(RichText::new(error).color(ui.visuals().error_fg_color));
        });
    }
}

/// The field has one line, and would make one path of several.
fn first_line_only(ui: &Ui) {
    ui.input_mut(|input| {
        for event in &mut input.events {
            if let egui::Event::Paste(text) = event
                && text.trim().lines().nth(1).is_some()
                && let Some(path) = parse(text)
            {
                *text = path.to_string_lossy().into_owned();
            }
        }
    });
}
