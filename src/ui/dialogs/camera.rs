//! The camera: a live picture, an estimator that runs on it, and recordings of it as clips.

mod bar;
mod countdown;

use std::path::PathBuf;
use std::sync::Arc;

use countdown::Countdown;
use eframe::egui::{
    self, Align, ComboBox, Key, Label, Layout, Modifiers, Rect, RichText, TextStyle, Ui, UiBuilder, vec2,
};
use lucide_icons::Icon;
use motionscope_core::base::words::capital;
use motionscope_core::base::{Error, Stop};
use motionscope_core::course::estimator;
use motionscope_core::run::{Cursor, Info};
use web_time::{Duration, Instant};

use crate::media::camera::{Camera, Cameras, Closing, Device, Kept, Shot, Size, keep};
use crate::paint::charts::Orbit;
use crate::ui::commands::{Action, Actions};
use crate::ui::layout::Panes;
use crate::ui::model::background::Background;
use crate::ui::model::document::Document;
use crate::ui::model::live::{Live, LiveView, live_look};
use crate::ui::model::settings::{CameraChoices, Settings};
use crate::ui::parts::widgets;
use crate::ui::stage;
use crate::view::look::Look;

/// Durations that can be chosen, in seconds.
const SECONDS: [u32; 5] = [1, 2, 3, 5, 10];
/// The time that is remembered beyond the chosen one, so that no frame of it is lost.
const MARGIN: Duration = Duration::from_secs(1);

/// The dialog while it is open.
pub struct State {
    cameras: Arc<dyn Cameras>,
    listing: Option<Background<(Vec<Device>, Option<Error>)>>,
    devices: Vec<Device>,
    /// Why there are no cameras among them.
    trouble: Option<Error>,
    device: usize,
    /// What is remembered of what was chosen here.
    choices: CameraChoices,
    live: Option<Result<Live, Error>>,
    /// The cameras that have not ended, of this dialog and of earlier ones: each may take a while to close.
    closing: Closing,
    /// The estimator that runs on the camera.
    estimator: Option<&'static str>,
    /// The countdown before a recording.
    countdown: Option<Countdown>,
    keeping: Option<Background<Kept>>,
    /// Why the last recording was not kept.
    refused: Option<Error>,
    /// The name of the next recording.
    name: String,
    /// The recording before, if there is one.
    last: Option<PathBuf>,
    stage: stage::State,
}

impl State {
    /// The dialog for `cameras` with what was chosen before; those in `closing` may not have ended yet. A recording will be called
    /// `name`, and `last` is the one before.
    pub fn new(
        (cameras, closing): (Arc<dyn Cameras>, Closing),
        (name, last): (String, Option<PathBuf>),
        choices: CameraChoices,
        ctx: &egui::Context,
    ) -> Self {
        let size = Some(choices.size).filter(|size| Size::USUAL.contains(size)).unwrap_or_default();
        let seconds = Some(choices.seconds).filter(|seconds| SECONDS.contains(seconds));
        let seconds = seconds.unwrap_or_else(|| CameraChoices::default().seconds);
        let mut state = Self {
            cameras,
            listing: None,
            devices: Vec::new(),
            trouble: None,
            device: 0,
            choices: CameraChoices { size, seconds, ..choices },
            live: None,
            closing,
            estimator: None,
            countdown: None,
            keeping: None,
            refused: None,
            name,
            last,
            stage: stage::State::default(),
        };
        state.list(ctx);
        state
    }

    /// The state of the live picture, for tests.
    pub fn view(&self) -> Option<LiveView> {
        self.live().map(Live::view)
    }

    fn live(&self) -> Option<&Live> {
        self.live.as_ref().and_then(|live| live.as_ref().ok())
    }

    /// Switches the camera off.
    fn close(&mut self) {
        (self.live, self.countdown) = (None, None);
    }

    /// Lists the cameras anew.
    fn list(&mut self, ctx: &egui::Context) {
        self.close();
        let (cameras, ctx) = (Arc::clone(&self.cameras), ctx.clone());
        let work = async move |_: &Arc<_>| Ok(cameras.list().await);
        self.listing = Some(Background::new("list the cameras", move || ctx.request_repaint(), work));
    }

    /// Opens the chosen camera, with the estimator that was chosen last.
    fn open(&mut self, ctx: &egui::Context, document: &Document) {
        self.close();
        self.refused = None;
        let Some(device) = self.devices.get(self.device).cloned() else { return };
        let (cameras, size) = (Arc::clone(&self.cameras), self.choices.size);
        let open = async move |stop: &Stop| cameras.open(&device, size, stop).await;
        let camera = Camera::open_after(&self.closing, open, || {});
        let (repaint, remembered) = (ctx.clone(), self.time() + MARGIN);
        self.live = Some(camera.and_then(|camera| {
            camera.remember(remembered);
            Live::new(camera, move || repaint.request_repaint())
        }));
        let chosen = self.choices.estimator.as_deref().and_then(|id| estimator(id).ok());
        self.choose(chosen.map(|chosen| chosen.info().id), document);
    }

    /// The time that is recorded.
    fn time(&self) -> Duration {
        Duration::from_secs(self.choices.seconds.into())
    }

    /// The length of the recording so far, if one is being made.
    fn recorded(&self) -> Option<Duration> {
        self.live()?.camera().recorded()
    }

    /// Whether a recording is about to begin, being made or kept, so that its camera, size and duration stay.
    fn is_busy(&self) -> bool {
        self.keeping.is_some() || self.can_cancel()
    }

    /// Whether there is a countdown or a recording to cancel.
    fn can_cancel(&self) -> bool {
        self.countdown.is_some() || self.recorded().is_some()
    }

    fn has_frames(&self) -> bool {
        self.view().is_some_and(|view| view.seen.is_some())
    }

    /// Whether a recording can begin, or the present one can end.
    fn can_record(&self) -> bool {
        let is_on = self.live().is_some_and(|live| live.camera().ended().is_none());
        is_on && self.has_frames() && self.keeping.is_none()
    }

    /// Whether the last seconds can become a clip.
    fn can_freeze(&self) -> bool {
        self.has_frames() && !self.is_busy()
    }

    /// Receives the list of cameras, once it is there.
    fn receive_list(&mut self, ctx: &egui::Context, document: &Document) {
        let Some(outcome) = self.listing.as_ref().and_then(Background::take) else { return };
        let (devices, trouble) = outcome.unwrap_or_else(|error| (vec![Device::TestPicture], Some(error)));
        let chosen = devices.iter().position(|device| Some(device.name()) == self.choices.device.as_deref());
        self.device = chosen.unwrap_or(0);
        (self.devices, self.trouble, self.listing) = (devices, trouble, None);
        self.open(ctx, document);
    }

    /// Receives the results of tasks; returns whether a recording is opened.
    fn tend(&mut self, ctx: &egui::Context, document: &Document, actions: &mut Actions) -> bool {
        self.receive_list(ctx, document);
        self.count_down(ctx);
        if let Some(live) = self.live() {
            // An estimator that has failed can be chosen again.
            let has_failed = live.has_failed();
            if live.camera().has_recording() {
                let shots = live.camera().take_recording();
                self.keep(shots, ctx);
            }
            self.estimator = self.estimator.filter(|_| !has_failed);
        }
        match self.keeping.as_ref().and_then(Background::take) {
            Some(Ok(kept)) => {
                let ended = self.live().and_then(|live| live.camera().ended());
                actions.ask(Action::OpenRecording(Arc::new(kept), self.estimator, ended));
                return true;
            }
            Some(Err(error)) => (self.keeping, self.refused) = (None, Some(error)),
            None => {}
        }
        false
    }

    /// Makes a clip of `shots`.
    fn keep(&mut self, shots: Vec<Shot>, ctx: &egui::Context) {
        self.refused = None;
        let Some(format) = self.live().and_then(|live| live.camera().format()) else { return };
        let (name, ctx) = (self.name.clone(), ctx.clone());
        let work = async move |_: &Arc<_>| keep(&format, &shots, &name);
        self.keeping = Some(Background::new("keep the recording", move || ctx.request_repaint(), work));
    }

    /// Begins the countdown or the recording, or ends either before its time.
    fn record(&mut self, ctx: &egui::Context) {
        let Some(live) = self.live().filter(|_| self.can_record()) else { return };
        if live.camera().recorded().is_some() {
            let shots = live.camera().take_recording();
            self.keep(shots, ctx);
        } else if self.countdown.take().is_some() {
            // It was cancelled.
        } else if self.choices.has_countdown {
            (self.countdown, self.refused) = (Some(Countdown::from(Instant::now())), None);
        } else {
            self.begin_recording();
        }
    }

    fn begin_recording(&mut self) {
        if let Some(live) = self.live() {
            live.camera().begin_recording(self.time());
        }
        self.refused = None;
    }

    /// Begins the recording once the countdown is over; without a camera there is none.
    fn count_down(&mut self, ctx: &egui::Context) {
        let Some(countdown) = &self.countdown else { return };
        countdown.tend(ctx);
        let is_over = countdown.number(Instant::now()).is_none();
        if is_over || !self.can_record() {
            self.countdown = None;
        }
        if is_over && self.can_record() {
            self.begin_recording();
        }
    }

    /// Gives up the countdown, or the recording with its frames.
    fn cancel(&mut self) {
        self.countdown = None;
        if let Some(live) = self.live() {
            drop(live.camera().take_recording());
        }
    }

    /// Makes a clip of the last seconds.
    fn freeze(&mut self, ctx: &egui::Context) {
        let Some(live) = self.live().filter(|_| self.can_freeze()) else { return };
        let shots = live.camera().last(self.time());
        self.keep(shots, ctx);
    }

    /// Has the estimator `id` run on the camera, with the parameters that it has in `document`.
    fn choose(&mut self, id: Option<&'static str>, document: &Document) {
        (self.estimator, self.stage) = (id, stage::State::default());
        let now = document.estimator();
        let chosen = |id| {
            if now.info().id == id { Some(now.boxed_clone()) } else { estimator(id).ok() }
        };
        if let Some(live) = self.live() {
            live.choose(id.and_then(chosen));
        }
    }
}

/// Shows the dialog; gives whether it is still open.
pub fn show(
    ctx: &egui::Context,
    state: &mut State,
    (document, settings): (&Document, &mut Settings),
    actions: &mut Actions,
) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let screen = ctx.content_rect();
    let is_kept = state.tend(ctx, document, actions);
    let (mut keys, mut is_closed) = (Keys::default(), false);
    let modal = widgets::modal(ctx, "live camera", vec2(72.0 * size, 56.0 * size)).show(ctx, |ui| {
        // Before a button in focus takes them.
        keys = Keys::take(ui, state);
        ui.set_width((72.0 * size).min(widgets::room_of_dialog(ctx).x));
        let tall = (screen.height() - 104.0).min(56.0 * size);
        let bottom = ui.cursor().min.y + tall;
        is_closed = title(ui, state);
        choices(ui, state, document);
        ui.add_space(4.0);
        let row = ui.spacing().interact_size.y + 12.0;
        let height = (bottom - row - ui.cursor().min.y).max(120.0);
        let (_, rect) = ui.allocate_space(vec2(ui.available_width(), height));
        picture(&mut widgets::inside(ui, rect, Layout::top_down(Align::Min)), state, (document, &settings.look));
        if let Some(countdown) = &state.countdown {
            countdown.paint(ui, state.stage.area());
        }
        ui.add_space(4.0);
        is_closed |= bar::show(ui, state, &mut keys, actions);
    });
    if keys.records {
        state.record(ctx);
    }
    if keys.freezes {
        state.freeze(ctx);
    }
    if keys.cancels {
        state.cancel();
    }
    settings.camera.clone_from(&state.choices);
    !(modal.should_close() || is_closed || is_kept)
}

/// The commands of keys and buttons.
#[derive(Default)]
struct Keys {
    records: bool,
    freezes: bool,
    cancels: bool,
}

impl Keys {
    fn take(ui: &Ui, state: &State) -> Self {
        let can_cancel = state.can_cancel();
        ui.input_mut(|input| Self {
            records: input.consume_key(Modifiers::NONE, Key::R),
            freezes: input.consume_key(Modifiers::NONE, Key::Space),
            // Otherwise it closes the dialog.
            cancels: can_cancel && input.consume_key(Modifiers::NONE, Key::Escape),
        })
    }
}

/// A list under its name.
fn list<R>(ui: &mut Ui, name: &str, shown: &str, add: impl FnOnce(&mut Ui) -> R) {
    let label = ui.label(RichText::new(name).weak());
    let combo = ComboBox::from_id_salt(name).selected_text(widgets::elide(shown, 28)).width(0.0).height(longest(ui));
    let combo = combo.show_ui(ui, |ui| {
        // A click on the dialog has put it above the list, and it would stay there.
        ui.ctx().move_to_top(ui.layer_id());
        add(ui);
    });
    combo.response.labelled_by(label.id);
    ui.add_space(8.0);
}

/// Height of the longest list.
fn longest(ui: &Ui) -> f32 {
    0.6 * ui.ctx().content_rect().height()
}

/// The camera, the size and duration of its recordings, and the estimator.
fn choices(ui: &mut Ui, state: &mut State, document: &Document) {
    let (device, before, id) = (state.device, state.choices.clone(), state.estimator);
    let (ctx, is_busy) = (ui.ctx().clone(), state.is_busy());
    let (mut lists_anew, mut chosen) = (false, id);
    ui.horizontal_wrapped(|ui| {
        if is_busy {
            ui.disable();
        }
        let name = state.devices.get(state.device).map_or("…", Device::name).to_owned();
        list(ui, "Camera", &name, |ui| {
            for (index, device) in state.devices.iter().enumerate() {
                ui.selectable_value(&mut state.device, index, device.name());
            }
            lists_anew = ui.button("List again").clicked();
        });
        list(ui, "Size", &size_text(before.size), |ui| {
            for size in Size::USUAL {
                ui.selectable_value(&mut state.choices.size, size, size_text(size));
            }
        });
        list(ui, "Duration", &format!("{} s", before.seconds), |ui| {
            for seconds in SECONDS {
                ui.selectable_value(&mut state.choices.seconds, seconds, format!("{seconds} s"));
            }
        });
        let view = state.view().unwrap_or_default();
        let name = id.and_then(|id| estimator(id).ok()).map_or("none", |one| one.info().name);
        list(ui, "Estimator", name, |ui| {
            // Only once the list is seen: it takes a while.
            if let Some(Ok(live)) = &mut state.live {
                live.measure();
            }
            estimators(ui, &view, &mut chosen);
        });
    });
    if is_busy {
        // A list that was open when the recording began changes nothing.
        (state.device, state.choices) = (device, before);
        return;
    }
    if chosen != id {
        state.choices.estimator = chosen.map(str::to_owned);
        state.choose(chosen, document);
    }
    if lists_anew {
        return state.list(&ctx);
    }
    if device != state.device {
        state.choices.device = state.devices.get(state.device).map(|device| device.name().to_owned());
    }
    if (device, before.size) != (state.device, state.choices.size) {
        state.open(&ctx, document);
    }
    if before.seconds != state.choices.seconds
        && let Some(live) = state.live()
    {
        live.camera().remember(state.time() + MARGIN);
    }
}

/// The estimators that keep up with the camera, by family.
fn estimators(ui: &mut Ui, view: &LiveView, chosen: &mut Option<&'static str>) {
    if !view.is_measured {
        // A list that is open does not grow: it has from the beginning the room for what will be in it.
        ui.set_min_height(longest(ui));
    }
    ui.selectable_value(chosen, None, "none");
    let mut family = "";
    for (Info { id, name, family: of, .. }, time) in view.offered.iter().map(|(info, time)| (*info, time)) {
        if family != *of {
            family = of;
            ui.label(RichText::new(*of).small().weak());
        }
        let tip = format!("Takes {} per frame.", milliseconds(*time));
        ui.selectable_value(chosen, Some(*id), *name).on_hover_text(tip);
    }
    if !view.is_measured {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label(RichText::new("Measuring which estimators keep up…").weak());
        });
    }
}

fn milliseconds(time: Duration) -> String {
    format!("{:.1} ms", time.as_secs_f64() * 1000.0)
}

fn size_text(Size { width, height }: Size) -> String {
    format!("{width}×{height} px")
}

/// The title with a note beside it; returns whether the button that closes the dialog was clicked.
fn title(ui: &mut Ui, state: &State) -> bool {
    ui.horizontal(|ui| {
        ui.heading("Camera");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let is_closed = widgets::icon_button(ui, Icon::X, "Close", false).clicked();
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| note(ui, state));
            is_closed
        })
        .inner
    })
    .inner
}

/// Why there is no camera, or why a recording was not kept.
fn note(ui: &mut Ui, state: &State) {
    let none = || "No camera is connected. The test picture stands in for one.".to_owned();
    let told = match (&state.refused, &state.trouble) {
        (Some(error), _) | (None, Some(error)) => Some(format!("{}.", capital(&error.to_string()))),
        (None, None) => (state.listing.is_none() && state.devices.len() == 1).then(none),
    };
    if let Some(told) = told {
        let color = if state.refused.is_some() { ui.visuals().error_fg_color } else { ui.visuals().weak_text_color() };
        ui.add_space(8.0);
        ui.add(Label::new(RichText::new(told).color(color)).wrap());
    }
}

/// The live picture, or why there is none.
fn picture(ui: &mut Ui, state: &mut State, (document, look): (&Document, &Look)) {
    let view = state.view().unwrap_or_default();
    let ended = match &state.live {
        Some(Ok(live)) => live.camera().ended(),
        Some(Err(error)) => Some(error.clone()),
        None => None,
    };
    let Some(seen) = &view.seen else {
        return empty(ui, state, document, ended.as_ref());
    };
    let look = live_look(look);
    if let Some(live) = state.live() {
        live.look(&look);
    }
    let theme = look.theme;
    let of = stage::OnStage { pictures: &seen.pictures, look, stands: seen.stands, tiles: 0 };
    let pictures = stage::pictures(of, theme, stage::line_height(theme, None));
    let panes = &Panes::Alike(pictures.split(ui.max_rect()));
    let input = stage::Input {
        panes,
        is_search: false,
        pictures: &seen.pictures,
        frame: seen.frame,
        scene: &seen.scene,
        step: None,
        lockstep: None,
        cursor: Cursor { unit: seen.frame, event: 1 },
        stands: seen.stands,
        look,
        orbit: Orbit::default(),
        heat: seen.scene.heat.unwrap_or_default(),
        available: &seen.available,
        checking: false,
        gpu: None,
        placing: None,
        animate: false,
        flows: false,
        hides_untested: false,
        presenting: stage::Presenting::default(),
    };
    stage::show_plain(ui, &input, &mut state.stage);
}

/// The text in place of the picture: the camera is being opened, or why there is none.
fn empty(ui: &mut Ui, state: &mut State, document: &Document, error: Option<&Error>) {
    let room = ui.available_rect_before_wrap();
    let words = match error {
        Some(error) => format!("{}.", capital(&error.to_string())),
        None if state.listing.is_some() => "Looking for cameras…".to_owned(),
        None => format!("Opening {}…", state.devices.get(state.device).map_or("the camera", Device::name)),
    };
    let middle = Rect::from_center_size(room.center(), vec2(room.width().min(640.0), 120.0));
    let mut ui = ui.new_child(UiBuilder::new().max_rect(middle).layout(Layout::top_down(Align::Center)));
    if error.is_none() {
        ui.spinner();
    }
    ui.add(Label::new(words).wrap());
    if error.is_some() {
        ui.add_space(8.0);
        if ui.button((widgets::icon(&ui, Icon::RotateCcw), "Try again")).clicked() {
            let ctx = ui.ctx().clone();
            state.open(&ctx, document);
        }
    }
}
