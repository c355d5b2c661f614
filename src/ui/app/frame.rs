//! A frame of the window: its panels, and what is drawn over them.

use eframe::egui::{self, Align, CentralPanel, Frame, Label, Layout, Margin, Panel, RichText, TextStyle, Ui};
use eframe::egui_wgpu::RenderState;
use lucide_icons::Icon;

use super::{App, Region, focus, keys};
use crate::ui::commands::{Action, Actions};
use crate::ui::drawing::style;
use crate::ui::panes::{Panes, status, topbar, transport};
use crate::ui::parts::widgets;

/// The key under which is stored how the panes are looked at.
pub(super) const STATES: &str = "panes";

impl App {
    fn panels(&mut self, ui: &mut Ui, gpu: Option<&RenderState>, actions: &mut Actions) {
        let is_lecture = self.mode().is_lecture();
        let bar = |x, y| Frame::new().inner_margin(Margin::symmetric(x, y));
        let top = if is_lecture { 4 } else { 6 };
        let mut regions = Vec::new();
        if self.presentation.is_on {
            // For the class there is nothing but stage, chart and caption.
            self.progress_line(ui);
            self.toasts.show_description(ui, bar(12, 6), self.settings.look.theme);
            CentralPanel::no_frame().show(ui, |ui| self.body(ui, gpu, actions, &mut regions));
            self.panes.regions = regions;
            return;
        }
        let type_pt = TextStyle::Body.resolve(ui.style()).size;
        let rows = transport::rows(ui.ctx().content_rect().size(), type_pt);
        let height = (rows * ui.spacing().interact_size.y * 1.65).round();
        let transport = Panel::bottom("transport").frame(bar(12, 2)).exact_size(height + 4.0);
        if self.presentation.is_embedded {
            let transport = transport.show(ui, |ui| self.embedded_transport(ui, actions));
            regions.push((Region::Transport, transport.response.rect));
            CentralPanel::no_frame().show(ui, |ui| self.body(ui, gpu, actions, &mut regions));
            self.panes.regions = regions;
            return;
        }
        let header = Panel::top("menus").frame(bar(12, top)).show(ui, |ui| self.top_bar(ui, actions));
        regions.push((Region::Header, header.response.rect));
        // An export can be cancelled there.
        if !is_lecture || self.exports.writing.is_some() {
            let status = Panel::bottom("status").frame(bar(16, 2)).show(ui, |ui| self.status(ui, actions));
            regions.push((Region::Status, status.response.rect));
        }
        let transport = transport.show(ui, |ui| self.transport(ui, actions));
        regions.push((Region::Transport, transport.response.rect));
        self.toasts.show_description(ui, bar(12, 6), self.settings.look.theme);
        CentralPanel::no_frame().show(ui, |ui| self.body(ui, gpu, actions, &mut regions));
        self.panes.regions = regions;
    }

    fn top_bar(&self, ui: &mut Ui, actions: &mut Actions) {
        let (frame, id) = (self.run.document.frame(), self.run.document.estimator().info().id);
        // In lockstep the info of the run names the lockstep, so that of the experiment counts.
        let shown = self.run.view.shown.as_deref().filter(|shown| {
            let of = &shown.subject.experiment;
            of.frame == frame && of.estimator.info().id == id
        });
        let input = topbar::Input {
            document: &self.run.document,
            at_frame: shown.map(|shown| shown.frame),
            place: shown.and_then(status::nested_place),
            now: self.now(),
            granularities: self.run.granularities(),
            has_strip: self.has_strip(),
            recent: &self.settings.recent,
        };
        topbar::show(ui, &input, actions);
    }

    /// Whether the line at the top has the parameters that matter most: where they have no place of their own, and neither a lesson nor an
    /// error is read.
    fn has_strip(&self) -> bool {
        let has_error = self.opening.error.is_some() || self.run.refused().is_some();
        self.settings.is_narrow && self.folded().parameters && self.course.lesson.is_none() && !has_error
    }

    fn transport(&self, ui: &mut Ui, actions: &mut Actions) {
        let input = transport::Input {
            shown: self.run.view.shown.as_deref(),
            now: self.now(),
            granularities: self.run.granularities(),
            player: self.run.player,
            has_hint: self.can_remember && !self.presentation.is_embedded && !self.settings.practice.is_over(),
            theme: self.settings.look.theme,
        };
        transport::show(ui, &input, actions);
    }

    /// The transport in a frame of another page, with the way to the whole window at its end.
    fn embedded_transport(&self, ui: &mut Ui, actions: &mut Actions) {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let glyph = widgets::icon(ui, Icon::ExternalLink);
            let whole = ui.add(egui::Button::new(glyph).frame_when_inactive(false));
            whole.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Open in Motionscope"));
            if whole
                .on_hover_text("Open in Motionscope: this step with menus, parameters and explanation, in a new tab.")
                .clicked()
            {
                actions.ask(Action::OpenWhole);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| self.transport(ui, actions));
        });
    }

    fn status(&self, ui: &mut Ui, actions: &mut Actions) {
        let small = TextStyle::Small.resolve(ui.style());
        let dim = ui.visuals().weak_text_color();
        ui.horizontal(|ui| {
            ui.set_min_height(small.size + 8.0);
            if let Some(work) = status::work(&self.run.view) {
                status::progress(ui, &work, actions);
                return;
            }
            if let Some(writing) = &self.exports.writing {
                match writing.work.fraction() {
                    0.0 => drop(ui.spinner()),
                    done => drop(ui.add(egui::ProgressBar::new(done).desired_width(120.0).desired_height(6.0))),
                }
                ui.label(RichText::new("Saving…").small());
                let cancel = ui.add(egui::Button::new(RichText::new("Cancel").small()).small());
                if cancel.on_hover_text("Cancel the export.\nEscape").clicked() {
                    actions.ask(Action::CancelWriting);
                }
            }
            let nothing = || if self.run.document.clip().is_some() { "No run" } else { "No clip is open" }.to_owned();
            let text = self.run.view.shown.as_deref();
            let text = text.map_or_else(nothing, |shown| status::line(shown, self.run.predict.is_on()));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if ui.available_width() > 70.0 * small.size {
                    let keys = status::keys(self.run.granularities());
                    ui.label(RichText::new(keys).small().color(dim));
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(Label::new(RichText::new(text).small().color(dim)).truncate());
                });
            });
        });
    }

    fn body(
        &mut self,
        ui: &mut Ui,
        gpu: Option<&RenderState>,
        actions: &mut Actions,
        regions: &mut Vec<(Region, egui::Rect)>,
    ) {
        self.panes.states.stage.begin_frame();
        let of_step = self.charts();
        let room = self.room(ui.max_rect(), ui.ctx().content_rect().size());
        // In a long run the marks of the frames in between must not lag behind their pictures.
        let is_on_its_way = self.run.view.progress.is_some();
        let calm = self.settings.reduced_motion || self.run.player.is_playing() || is_on_its_way;
        let mut panes = Panes {
            document: &self.run.document,
            view: &self.run.view,
            loading: self.opening.loading.as_ref(),
            error: self.opening.error.as_ref(),
            asks_for_trust: self.opening.asks_for_trust(),
            states: &mut self.panes.states,
            of_step,
            charts: &mut self.settings.charts,
            shares: &mut self.settings.shares,
            animate: !calm && !ui.input(|i| i.pointer.any_down()),
            can_be_closed: self.settings.is_narrow,
            has_no_status: room.mode.is_lecture(),
            flows: !self.settings.reduced_motion,
            is_asked: self.run.predict.open().is_some(),
            asks: self.run.predict.is_on(),
            gpu,
            presented: self.presentation.presented(),
            look: &mut self.settings.look,
            actions,
        };
        // They take from the room of everything, and lie over no picture.
        panes.banners(ui);
        let all = room.in_body(ui.available_rect_before_wrap()).arrange();
        panes.show(ui, &all);
        if let Some(page) = all.page {
            self.lesson_page(ui, page, actions);
        }
        if let Some(question) = all.question {
            self.question_pane(ui, question, actions);
        }
        self.panes.states.stage.end_frame(ui.ctx());
        let told = if all.strip.is_some() { Region::Strip } else { Region::Explanation };
        let single = [
            (Region::Stage, all.stage),
            (told, all.told),
            (Region::Lesson, all.page),
            (Region::Question, all.question),
        ];
        let single = single.into_iter().chain([(Region::Parameters, all.parameters)]);
        regions.extend(single.filter_map(|(region, rect)| Some((region, rect?))));
        regions.extend(all.charts.iter().map(|rect| (Region::Chart, *rect)));
        if all.stage.is_some() {
            regions.extend(self.panes.states.stage.pictures().map(|rect| (Region::Pictures, rect)));
        }
        self.panes.arranged = all;
        // A layer chosen on the stage is shown as soon as it is made.
        self.run.walker.look(&self.settings.look);
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
        let text = "Drop a clip, two pictures, a folder of pictures or a session";
        painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, style::color(chrome.text));
    }
}

impl eframe::App for App {
    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        let now = input.time.unwrap_or_else(|| ctx.input(|last| last.time));
        self.finger.rest(ctx, input, now);
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        let mut actions = Actions::default();
        self.receive();
        self.follow_address();
        self.follow_lesson();
        self.play(&ctx);
        self.measure(&ctx);
        let overlaid = self.dialogs.is_covered();
        if !overlaid && self.dialogs.start.is_none() && !self.presentation.is_blank {
            focus::travel(&ctx, &self.panes.regions);
        }
        keys::take(&ctx, overlaid, &self.now(), &mut actions);
        // The window is cleared in this colour; where the card takes that for a linear one, or there is none, it is filled.
        if frame.wgpu_render_state().is_none_or(|card| card.target_format.is_srgb()) {
            ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
        }
        match self.dialogs.start {
            Some(_) => {
                self.panes.regions = vec![(Region::Start, ui.max_rect())];
                self.start_page(ui, &mut actions);
            }
            None => self.panels(ui, frame.wgpu_render_state(), &mut actions),
        }
        self.presenter_window(&ctx, &mut actions);
        self.overlays(&ctx, &mut actions);
        self.dialogs.previews.settle(&ctx);
        let place = self.panes.place_of_messages(ctx.content_rect());
        self.toasts.show(&ctx, place, self.settings.look.theme);
        focus::ring(&ctx, self.settings.look.theme);
        self.drop_hint(ui);
        self.show_pointer(&ctx);
        self.show_blank(&ctx);
        for action in actions.0 {
            self.act(action);
        }
        let view = self.run.walker.view();
        if view.busy {
            // The window is drawn again when a long job shows its progress, and when it ends.
            ctx.request_repaint_after(if view.stopping { status::SOON } else { status::LATE });
        }
        let interface = self.settings.interface(self.size());
        if self.styled.replace(interface) != Some(interface) {
            style::apply(&ctx, interface);
            ctx.request_repaint();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        // A frame in another page shows the choices of its link, not those of the person.
        if self.presentation.is_embedded {
            return;
        }
        self.note_place();
        // The settings of a page do not become those of the person.
        let look = self.settings.look;
        if let Some(open) = &self.course.lesson {
            self.settings.look = open.without_page(look);
        }
        self.settings.save(storage);
        self.settings.look = look;
        eframe::set_value(storage, STATES, &self.panes.states);
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}
