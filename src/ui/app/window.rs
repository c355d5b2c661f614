//! The window's state, and a frame of it.

use std::path::PathBuf;
use std::sync::mpsc::Receiver;

use eframe::egui::{self, Align, CentralPanel, Frame, Label, Layout, Margin, Panel, RichText, TextStyle, Ui};
use eframe::egui_wgpu::RenderState;
use motionscope_core::Error;

use crate::experiment::side_by_side::SideBySide;
use crate::ui::app::action::{Action, Actions, Browse};
use crate::ui::app::commands::{Command, Granularities, Now};
use crate::ui::app::keys;
use crate::ui::dialogs::{compare, gallery, open as open_dialog, palette, save as save_dialog, sheet};
use crate::ui::drawing::style;
use crate::ui::model::document::{Document, Owner};
use crate::ui::model::loader::Loading;
use crate::ui::model::player::Player;
use crate::ui::model::settings::Settings;
use crate::ui::model::walker::{View, Walker};
use crate::ui::model::writer::Writing;
use crate::ui::panes::layout::{self, Folded, Pane, Tight};
use crate::ui::panes::{Panes, States};
use crate::ui::panes::{status, topbar, transport};
use crate::ui::parts::toasts::Toasts;
use crate::ui::parts::widgets;

/// The key under which is stored how the panes are looked at.
const STATES: &str = "panes";

/// What lies over the panes.
#[derive(Default)]
pub(super) enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The command palette.
    Palette(palette::State),
    /// Every key.
    Shortcuts,
    /// A path to open.
    Open(open_dialog::State),
    /// Something to write.
    Save(Box<save_dialog::State>),
    /// The samples.
    Samples,
    /// Estimators beside each other.
    Compare(Box<compare::State>),
    /// What the program is.
    About,
}

/// The window.
pub struct App {
    pub(super) settings: Settings,
    pub(super) document: Document,
    pub(super) walker: Walker,
    pub(super) view: View,
    pub(super) player: Player,
    pub(super) loading: Option<Loading>,
    pub(super) error: Option<Error>,
    pub(super) overlay: Overlay,
    pub(super) toasts: Toasts,
    pub(super) states: States,
    pub(super) gallery: gallery::State,
    /// A path that the system's dialog will deliver.
    pub(super) browsing: Option<(Browse, Receiver<Option<PathBuf>>)>,
    /// What is being written.
    pub(super) writing: Option<Writing>,
    /// Who went in lockstep last.
    pub(super) side_by_side: SideBySide,
    /// Where was written last.
    pub(super) folder: Option<PathBuf>,
    /// The interface that egui was told last.
    styled: Option<style::Interface>,
    /// When the run was played on last.
    played: f64,
    pub(super) ctx: egui::Context,
}

impl App {
    /// A window in `ctx` with what was remembered.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(ctx: &egui::Context, storage: Option<&dyn eframe::Storage>) -> std::io::Result<Self> {
        let mut settings = Settings::load(storage);
        settings.leave_end();
        style::install_fonts(ctx);
        style::apply(ctx, settings.interface());
        let repaint = ctx.clone();
        let player = Player::at_speed(settings.speed);
        let states: States = storage.and_then(|storage| eframe::get_value(storage, STATES)).unwrap_or_default();
        Ok(Self {
            styled: Some(settings.interface()),
            settings,
            document: Document::default(),
            walker: Walker::new(move || repaint.request_repaint())?,
            view: View::default(),
            player,
            loading: None,
            error: None,
            overlay: Overlay::None,
            toasts: Toasts::default(),
            states,
            gallery: gallery::State::default(),
            browsing: None,
            writing: None,
            side_by_side: SideBySide::default(),
            folder: None,
            played: 0.0,
            ctx: ctx.clone(),
        })
    }

    /// What is open and how it is set.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// What the walker shows and does.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// What the window remembers.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Share of what is being written that is done, from 0 to 1.
    pub fn written(&self) -> Option<f32> {
        self.writing.as_ref().map(|writing| writing.work.fraction())
    }

    /// The newest message, if one is shown.
    pub fn message(&self) -> Option<&str> {
        self.toasts.last()
    }

    /// What went wrong and was not read yet.
    pub fn error(&self) -> Option<&Error> {
        self.error.as_ref()
    }

    /// Waits until nothing is worked on any more, for tests; what was found is shown in the next frame.
    pub fn wait(&mut self) {
        while self.loading.is_some() || self.writing.is_some() {
            std::thread::sleep(std::time::Duration::from_millis(2));
            self.receive();
        }
        while !self.walker.wait_for(std::time::Duration::from_millis(20)) {
            self.walker.tend();
        }
        self.receive();
    }

    /// Whether everything that was asked for is there and shown.
    pub fn is_settled(&self) -> bool {
        let pictured = match &self.overlay {
            Overlay::Samples => self.gallery.is_complete(),
            Overlay::Compare(state) => state.is_settled(),
            Overlay::Save(state) => state.is_settled(),
            _ => true,
        };
        pictured && self.loading.is_none() && self.writing.is_none() && !self.view.busy && !self.view.checking
    }

    /// What is folded away just now.
    pub fn folded(&self) -> Folded {
        self.settings.folded()
    }

    /// Looks how much room there is, and shares it out anew where that has changed.
    fn measure(&mut self, ctx: &egui::Context) {
        let (room, body_pt) = (ctx.content_rect().size(), self.settings.look.theme.sizes().body);
        let tight = Tight::of(room, body_pt);
        if tight.differs(std::mem::replace(&mut self.settings.tight, tight)) {
            layout::share_out(&mut self.settings.tree, tight, room.x, body_pt);
        }
    }

    /// The names of the ladder's granularities.
    pub(super) fn granularities(&self) -> Granularities {
        Granularities::new(self.document.side_by_side().info(self.document.estimator()).granularities)
    }

    /// Why there is no run of what is set now, if there is none.
    fn refused(&self) -> Option<&Error> {
        self.view.refused.as_ref().or(self.document.refused())
    }

    /// What is the case just now.
    pub(super) fn now(&self) -> Now {
        let shown = self.view.shown.as_deref();
        let last = self.document.last_frame();
        Now {
            has_clip: self.document.clip().is_some(),
            has_run: shown.is_some() && self.refused().is_none(),
            at_start: shown.is_none_or(|shown| shown.cursor == motionscope_core::Cursor::default()),
            at_end: shown.is_some_and(|shown| shown.at_end),
            busy: self.view.busy,
            checking: self.view.checking,
            playing: self.player.is_playing(),
            lecture: self.settings.lecture,
            in_lockstep: !self.document.side_by_side().is_empty(),
            has_stage: !motionscope_core::stage::stages(self.document.estimator()).is_empty(),
            in_stage: self.document.parents().len() > 0,
            is_placing: self.states.stage.placing.is_some(),
            holds_pixel: shown.and_then(|shown| shown.pointed).is_some_and(|pointed| pointed.is_held),
            available: shown.map(|shown| shown.available).unwrap_or_default(),
            can_undo: self.document.can_undo(),
            can_redo: self.document.can_redo(),
            is_tuned: self.document.is_tuned(Owner::Estimator),
            at_first_frame: self.document.frame() == 0,
            at_last_frame: last.is_some_and(|last| self.document.frame() >= last),
        }
    }

    /// Lets the time since the last frame pass for the player.
    fn play(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|i| i.time);
        let seconds = now - std::mem::replace(&mut self.played, now);
        let Some(shown) = self.view.shown.as_deref().filter(|_| self.player.is_playing()) else { return };
        if shown.at_end && !self.view.busy {
            self.player.pause();
            return;
        }
        self.player.pass(seconds);
        if !self.view.busy
            && let Some(to) = self.player.due(shown.cursor, shown.events)
        {
            self.walker.go(to);
        }
        // The walker wakes the window when it is done.
        if !self.view.busy {
            ctx.request_repaint_after_secs(self.player.wait_secs() as f32);
        }
    }

    fn panels(&mut self, ui: &mut Ui, gpu: Option<&RenderState>, actions: &mut Actions) {
        let lecture = self.settings.lecture;
        let fill = ui.visuals().panel_fill;
        let bar = |x, y| Frame::new().fill(fill).inner_margin(Margin::symmetric(x, y));
        if !lecture {
            Panel::top("menus").frame(bar(12, 6)).show(ui, |ui| self.top_bar(ui, actions));
            Panel::bottom("status").frame(bar(16, 4)).show(ui, |ui| self.status(ui, actions));
        }
        let height = (ui.spacing().interact_size.y * 2.0).round();
        let frame = bar(12, 4);
        Panel::bottom("transport").frame(frame).exact_size(height + 8.0).show(ui, |ui| self.transport(ui, actions));
        CentralPanel::no_frame().show(ui, |ui| self.tiles(ui, gpu, actions));
    }

    fn top_bar(&self, ui: &mut Ui, actions: &mut Actions) {
        let (frame, id) = (self.document.frame(), self.document.estimator().info().id);
        let shown =
            self.view.shown.as_deref().filter(|shown| shown.subject.experiment.frame == frame && shown.info.id == id);
        let input = topbar::Input {
            document: &self.document,
            at_frame: shown.map(|shown| shown.frame),
            now: self.now(),
            granularities: self.granularities(),
            folded: self.folded(),
            reduced_motion: self.settings.reduced_motion,
            recent: &self.settings.recent,
            look: self.settings.look,
        };
        topbar::show(ui, &input, actions);
    }

    fn transport(&self, ui: &mut Ui, actions: &mut Actions) {
        let input = transport::Input {
            shown: self.view.shown.as_deref(),
            now: self.now(),
            granularities: self.granularities(),
            player: self.player,
            theme: self.settings.look.theme,
        };
        transport::show(ui, &input, actions);
    }

    fn status(&self, ui: &mut Ui, actions: &mut Actions) {
        let small = TextStyle::Small.resolve(ui.style());
        let dim = ui.visuals().weak_text_color();
        ui.horizontal(|ui| {
            ui.set_min_height(small.size + 8.0);
            if let Some(work) = status::work(&self.view) {
                status::progress(ui, &work, actions);
                return;
            }
            if let Some(writing) = &self.writing {
                match writing.work.fraction() {
                    0.0 => drop(ui.spinner()),
                    done => drop(ui.add(egui::ProgressBar::new(done).desired_width(120.0).desired_height(6.0))),
                }
                ui.label(RichText::new("Writing…").small());
                if ui.add(egui::Button::new(RichText::new("Cancel").small()).small()).clicked() {
                    actions.ask(Action::CancelWriting);
                }
            }
            let nothing = || if self.document.clip().is_some() { "no run" } else { "No clip is open" }.to_owned();
            let text = self.view.shown.as_deref().map_or_else(nothing, status::line);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.available_width() > 70.0 * small.size {
                    let keys = status::keys(self.granularities());
                    ui.label(RichText::new(keys).small().color(dim));
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(Label::new(RichText::new(text).small().color(dim)).truncate());
                });
            });
        });
    }

    fn tiles(&mut self, ui: &mut Ui, gpu: Option<&RenderState>, actions: &mut Actions) {
        let folded = self.folded();
        let offered = self.offered();
        layout::fold(&mut self.settings.tree, folded, |pane| offered.contains(&pane));
        let calm = self.settings.reduced_motion || self.player.is_playing();
        let mut panes = Panes {
            document: &self.document,
            view: &self.view,
            loading: self.loading.as_ref(),
            error: self.error.as_ref(),
            states: &mut self.states,
            stage_alone: layout::stage_alone(&self.settings.tree),
            alone: layout::alone(&self.settings.tree),
            animate: !calm && !ui.input(|i| i.pointer.any_down()),
            lecture: self.settings.lecture,
            flows: !self.settings.reduced_motion,
            gpu,
            look: &mut self.settings.look,
            actions,
        };
        self.settings.tree.ui(&mut panes, ui);
        // What was chosen on the stage is shown as soon as it is made.
        self.walker.look(&self.settings.look);
    }

    /// The charts that the estimator may ever have something for on this clip.
    fn offered(&self) -> Vec<Pane> {
        let charts = self.document.estimator().charts();
        let available = self.view.shown.as_deref().map(|shown| shown.available).unwrap_or_default();
        // Who finds places and no motion has nothing to be compared with the truth.
        let has_errors = available.has_errors() && !self.document.estimator().is_of_single_frames();
        let is_offered = |pane: &Pane| {
            pane.charts().iter().any(|chart| charts.contains(chart)) || *pane == Pane::Histogram && has_errors
        };
        Pane::ALL.into_iter().filter(is_offered).collect()
    }

    fn overlays(&mut self, ctx: &egui::Context, actions: &mut Actions) {
        let theme = self.settings.look.theme;
        let mut overlay = std::mem::take(&mut self.overlay);
        let open = match &mut overlay {
            Overlay::None => false,
            Overlay::Palette(state) => {
                let (now, granularities, recent) = (self.now(), self.granularities(), self.settings.recent.as_slice());
                let (chosen, open) = palette::show(ctx, state, &palette::Input { now, granularities, recent, theme });
                actions.0.extend(chosen);
                open
            }
            Overlay::Shortcuts => sheet::shortcuts(ctx, &self.granularities(), theme),
            Overlay::Open(state) => open_dialog::show(ctx, state, &self.settings.recent, actions),
            Overlay::Save(state) => save_dialog::show(ctx, state, self.granularities(), actions),
            Overlay::Compare(state) => compare::show(ctx, state, &self.document, theme, actions),
            Overlay::Samples => gallery::show(ctx, &mut self.gallery, theme, actions),
            Overlay::About => sheet::about(ctx),
        };
        if open {
            self.overlay = overlay;
        }
    }

    /// Says that what is held over the window can be dropped.
    fn drop_hint(&self, ui: &Ui) {
        if ui.input(|i| i.raw.hovered_files.is_empty()) {
            return;
        }
        let chrome = self.settings.look.theme.chrome();
        let rect = ui.max_rect();
        let painter = ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
        painter.rect_filled(rect, 0.0, style::color(chrome.background.alpha(215)));
        let edge = egui::Stroke::new(2.0, style::color(chrome.accent));
        painter.rect_stroke(rect.shrink(16.0), 12.0, edge, egui::StrokeKind::Inside);
        let font = TextStyle::Heading.resolve(ui.style());
        let text = "Drop a clip, a folder of pictures or a session";
        painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, style::color(chrome.text));
    }

    /// One line over the stage that says how to leave a lecture.
    fn lecture_hint(&self, ui: &Ui, actions: &mut Actions) {
        if !self.settings.lecture {
            return;
        }
        let area = egui::Area::new(egui::Id::unique("lecture")).anchor(egui::Align2::RIGHT_TOP, [-8.0, 6.0]);
        area.show(ui.ctx(), |ui| {
            let face = Command::Lecture.info();
            let button = widgets::icon_button(ui, face.icon, "Leave the lecture", true);
            if button.on_hover_text(Command::Lecture.with_key("Show everything again")).clicked() {
                actions.command(Command::Lecture);
            }
        });
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let mut actions = Actions::default();
        self.receive();
        self.play(&ctx);
        self.measure(&ctx);
        let overlaid = !matches!(self.overlay, Overlay::None);
        keys::take(&ctx, overlaid, &self.now(), &mut actions);
        ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
        self.panels(ui, frame.wgpu_render_state(), &mut actions);
        self.lecture_hint(ui, &mut actions);
        self.overlays(&ctx, &mut actions);
        let bottom = ui.spacing().interact_size.y * 2.0 + 56.0;
        self.toasts.show(&ctx, bottom, self.settings.look.theme);
        self.drop_hint(ui);
        for action in actions.0 {
            self.act(action);
        }
        let view = self.walker.view();
        if view.busy {
            // That it takes long, or ends, is seen even if nobody says so.
            ctx.request_repaint_after(if view.stopping { status::SOON } else { status::LATE });
        }
        let interface = self.settings.interface();
        if self.styled.replace(interface) != Some(interface) {
            style::apply(&ctx, interface);
            ctx.request_repaint();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.note_place();
        self.settings.save(storage);
        eframe::set_value(storage, STATES, &self.states);
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

/// The title of the window.
pub(super) fn title(document: &Document) -> String {
    match document.clip() {
        Some(clip) => format!("{} – Motionscope", clip.info().name),
        None => "Motionscope".into(),
    }
}
