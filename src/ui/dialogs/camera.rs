//! The camera: a live picture, an estimator that runs on it, and recordings of it as clips.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use eframe::egui::{
    self, Align, Button, ComboBox, Key, Label, Layout, Modifiers, Rect, RichText, TextStyle, Ui, UiBuilder, vec2,
};
use lucide_icons::Icon;
use motionscope_core::{Cursor, Error, Info, capital, estimator};

use crate::media::camera::{Camera, Cameras, Device, Kept, Shot, Size, keep};
use crate::ui::app::action::{Action, Actions};
use crate::ui::model::background::Background;
use crate::ui::model::document::Document;
use crate::ui::model::live::{Live, LiveView, live_look};
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
    size: Size,
    seconds: u32,
    live: Option<Result<Live, Error>>,
    /// The estimator that runs on the camera.
    estimator: Option<&'static str>,
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
    /// The dialog for `cameras`; a recording will be called `name`, and `last` is the one before.
    pub fn new(cameras: Arc<dyn Cameras>, name: String, last: Option<PathBuf>, ctx: &egui::Context) -> Self {
        let mut state = Self {
            cameras,
            listing: None,
            devices: Vec::new(),
            trouble: None,
            device: 0,
            size: Size::default(),
            seconds: 3,
            live: None,
            estimator: None,
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

    /// Lists the cameras anew.
    fn list(&mut self, ctx: &egui::Context) {
        self.live = None;
        let (cameras, ctx) = (Arc::clone(&self.cameras), ctx.clone());
        let work = move |_: &Arc<_>| Ok(cameras.list());
        self.listing = Some(Background::new("list the cameras", move || ctx.request_repaint(), work));
    }

    /// Opens the chosen camera.
    fn open(&mut self, ctx: &egui::Context) {
        // One camera is not opened twice.
        (self.live, self.refused) = (None, None);
        let Some(device) = self.devices.get(self.device).cloned() else { return };
        let (cameras, size) = (Arc::clone(&self.cameras), self.size);
        let camera = Camera::open(move |stop| cameras.open(&device, size, stop), || {});
        let repaint = ctx.clone();
        self.live = Some(camera.and_then(|camera| {
            camera.remember(Duration::from_secs(self.seconds.into()) + MARGIN);
            Live::new(camera, move || repaint.request_repaint())
        }));
        self.estimator = None;
    }

    /// The time that is recorded.
    fn time(&self) -> Duration {
        Duration::from_secs(self.seconds.into())
    }

    /// The length of the recording so far, if one is being made.
    fn recorded(&self) -> Option<Duration> {
        self.live()?.camera().recorded()
    }

    /// Whether a recording is being made or kept, so that its camera, size and duration stay.
    fn is_busy(&self) -> bool {
        self.keeping.is_some() || self.recorded().is_some()
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
    fn receive_list(&mut self, ctx: &egui::Context) {
        let Some(outcome) = self.listing.as_ref().and_then(Background::take) else { return };
        let (devices, trouble) = outcome.unwrap_or_else(|error| (vec![Device::TestPicture], Some(error)));
        (self.devices, self.trouble, self.device, self.listing) = (devices, trouble, 0, None);
        self.open(ctx);
    }

    /// Receives the results of other threads; returns whether a recording is opened.
    fn tend(&mut self, ctx: &egui::Context, actions: &mut Actions) -> bool {
        self.receive_list(ctx);
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
        let work = move |_: &Arc<_>| keep(&format, &shots, &name);
        self.keeping = Some(Background::new("keep the recording", move || ctx.request_repaint(), work));
    }

    /// Begins a recording, or ends it before its time.
    fn record(&mut self, ctx: &egui::Context) {
        let Some(live) = self.live().filter(|_| self.can_record()) else { return };
        match live.camera().recorded() {
            Some(_) => {
                let shots = live.camera().take_recording();
                self.keep(shots, ctx);
            }
            None => {
                live.camera().begin_recording(self.time());
                self.refused = None;
            }
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
    (document, look): (&Document, &Look),
    actions: &mut Actions,
) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let screen = ctx.content_rect();
    let is_kept = state.tend(ctx, actions);
    let (mut keys, mut is_closed) = (Keys::default(), false);
    let modal = widgets::modal(ctx, "live camera", vec2(72.0 * size, 56.0 * size)).show(ctx, |ui| {
        // Before a button in focus takes them.
        keys = Keys::take(ui);
        ui.set_width((72.0 * size).min(screen.width() - 104.0));
        let tall = (screen.height() - 104.0).min(56.0 * size);
        let bottom = ui.cursor().min.y + tall;
        is_closed = title(ui, state);
        choices(ui, state, document);
        ui.add_space(4.0);
        let row = ui.spacing().interact_size.y + 12.0;
        let height = (bottom - row - ui.cursor().min.y).max(120.0);
        let (_, rect) = ui.allocate_space(vec2(ui.available_width(), height));
        ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| picture(ui, state, look));
        ui.add_space(4.0);
        is_closed |= buttons(ui, state, &mut keys, actions);
    });
    if keys.records {
        state.record(ctx);
    }
    if keys.freezes {
        state.freeze(ctx);
    }
    !(modal.should_close() || is_closed || is_kept)
}

/// The commands of keys and buttons.
#[derive(Default)]
struct Keys {
    records: bool,
    freezes: bool,
}

impl Keys {
    fn take(ui: &Ui) -> Self {
        ui.input_mut(|input| Self {
            records: input.consume_key(Modifiers::NONE, Key::R),
            freezes: input.consume_key(Modifiers::NONE, Key::Space),
        })
    }
}

/// A list under its name.
fn list<R>(ui: &mut Ui, name: &str, shown: &str, add: impl FnOnce(&mut Ui) -> R) {
    let label = ui.label(RichText::new(name).weak());
    let height = 0.6 * ui.ctx().content_rect().height();
    let combo = ComboBox::from_id_salt(name).selected_text(widgets::elide(shown, 28)).width(0.0).height(height);
    let combo = combo.show_ui(ui, |ui| {
        // A click on the dialog has put it above the list, and it would stay there.
        ui.ctx().move_to_top(ui.layer_id());
        add(ui);
    });
    combo.response.labelled_by(label.id);
    ui.add_space(8.0);
}

/// The camera, the size and duration of its recordings, and the estimator.
fn choices(ui: &mut Ui, state: &mut State, document: &Document) {
    let (device, size, seconds, id) = (state.device, state.size, state.seconds, state.estimator);
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
        list(ui, "Size", &size_text(size), |ui| {
            for size in Size::USUAL {
                ui.selectable_value(&mut state.size, size, size_text(size));
            }
        });
        list(ui, "Duration", &format!("{seconds} s"), |ui| {
            for seconds in SECONDS {
                ui.selectable_value(&mut state.seconds, seconds, format!("{seconds} s"));
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
        (state.device, state.size, state.seconds) = (device, size, seconds);
        return;
    }
    if chosen != id {
        state.choose(chosen, document);
    }
    if lists_anew {
        return state.list(&ctx);
    }
    if (device, size) != (state.device, state.size) {
        state.open(&ctx);
    }
    if seconds != state.seconds
        && let Some(live) = state.live()
    {
        live.camera().remember(state.time() + MARGIN);
    }
}

/// The estimators that keep up with the camera, by family.
fn estimators(ui: &mut Ui, view: &LiveView, chosen: &mut Option<&'static str>) {
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
fn picture(ui: &mut Ui, state: &mut State, look: &Look) {
    let view = state.view().unwrap_or_default();
    let ended = match &state.live {
        Some(Ok(live)) => live.camera().ended(),
        Some(Err(error)) => Some(error.clone()),
        None => None,
    };
    let Some(seen) = &view.seen else {
        return empty(ui, state, ended.as_ref());
    };
    let look = live_look(look);
    if let Some(live) = state.live() {
        live.look(&look);
    }
    let input = stage::Input {
        pictures: &seen.pictures,
        frame: seen.frame,
        scene: &seen.scene,
        lockstep: None,
        cursor: Cursor { unit: seen.frame, event: 1 },
        stands: seen.stands,
        look,
        heat: seen.scene.heat.unwrap_or_default(),
        available: &seen.available,
        checking: false,
        gpu: None,
        placing: None,
        animate: false,
        flows: false,
        presenting: stage::Presenting::default(),
    };
    stage::show_plain(ui, &input, &mut state.stage);
}

/// The text in place of the picture: the camera is being opened, or why there is none.
fn empty(ui: &mut Ui, state: &mut State, error: Option<&Error>) {
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
            state.open(&ctx);
        }
    }
}

/// The state of the camera, and the buttons that make recordings; returns whether the last recording is opened.
fn buttons(ui: &mut Ui, state: &State, keys: &mut Keys, actions: &mut Actions) -> bool {
    let mut reopens = false;
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let is_recording = state.recorded().is_some();
            let (text, tip) = if is_recording {
                ("Stop recording".to_owned(), "Stop recording and open the frames so far.\nR")
            } else {
                (format!("Record {} s", state.seconds), "Record the next seconds, and open them as a clip.\nR")
            };
            let fill = if is_recording { ui.visuals().error_fg_color } else { ui.visuals().hyperlink_color };
            let button = Button::new(RichText::new(text).color(ui.visuals().panel_fill)).fill(fill);
            keys.records |= ui.add_enabled(state.can_record(), button).on_hover_text(tip).clicked();
            let text = format!("Freeze the last {} s", state.seconds);
            let tip = "Open the last seconds as a clip, with this estimator.\nSpace";
            let freeze = ui.add_enabled(state.can_freeze(), Button::new(text));
            keys.freezes |= freeze.on_hover_text(tip).clicked();
            if let Some(last) = &state.last
                && ui.button("Last recording").on_hover_text("Open the last recording again.").clicked()
            {
                actions.ask(Action::Open(last.into()));
                reopens = true;
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                if state.keeping.is_some() {
                    ui.spinner();
                }
                ui.add(Label::new(RichText::new(told(state)).weak()).truncate());
            });
        });
    });
    reopens
}

/// The state of the camera and the estimator, in numbers.
fn told(state: &State) -> String {
    let (Some(live), Some(view)) = (state.live(), state.view()) else { return String::new() };
    if state.keeping.is_some() {
        return "Opening the recording…".into();
    }
    if let Some(recorded) = state.recorded() {
        return format!("Recording: {:.1} s of {} s", recorded.as_secs_f64(), state.seconds);
    }
    if let Some(error) = live.camera().ended().filter(|_| view.seen.is_some()) {
        return format!("{}. The last seconds can still be frozen.", capital(&error.to_string()));
    }
    if let Some(error) = view.error {
        return format!("{}.", capital(&error.to_string()));
    }
    let rate = |rate: Option<f64>| rate.map_or_else(String::new, |rate| format!("{rate:.0} frames/s"));
    match state.estimator.and_then(|id| estimator(id).ok()) {
        Some(one) if view.rate.is_some() => format!(
            "{}: {}, {} frames dropped; camera: {}",
            one.info().name,
            rate(view.rate),
            view.dropped,
            rate(live.camera().rate())
        ),
        Some(one) => format!("Starting {}…", one.info().name),
        None => rate(live.camera().rate()),
    }
}
