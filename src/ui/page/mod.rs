//! The window in a page of a browser.

mod address;
mod announcer;
mod failure;
mod keys;

use eframe::egui::{Context, RawInput, Ui, Visuals};
use motionscope_core::base::heap;
use wasm_bindgen::JsCast as _;
use web_sys::HtmlCanvasElement;

use super::{Start, app, begin};
use crate::files;
use address::LocationBar;
use announcer::Announcer;

/// The id of the canvas on which the page has the window drawn.
const CANVAS: &str = "motionscope";

/// The memory that a run may count on: a page has 4 GiB at most, for everything.
const MOST_BYTES: u64 = 1 << 30;

/// Has the window drawn on the canvas of the page, for as long as the page is open.
pub fn run_in_page() {
    let Some(window) = web_sys::window() else { return };
    let canvas = window.document().and_then(|document| document.get_element_by_id(CANVAS));
    let Some(canvas) = canvas.and_then(|canvas| canvas.dyn_into::<HtmlCanvasElement>().ok()) else { return };
    failure::install(canvas.clone());
    heap::measure_with(|| Some(MOST_BYTES));
    keys::take(&window);
    wasm_bindgen_futures::spawn_local(run_on(canvas, LocationBar::new(window)));
}

async fn run_on(canvas: HtmlCanvasElement, bar: LocationBar) {
    let announcer = Announcer::new(canvas.clone());
    let create = move |cc: &eframe::CreationContext<'_>| {
        let mut app = app::App::new(&cc.egui_ctx, cc.storage)?;
        let ctx = cc.egui_ctx.clone();
        files::page::listen(move || ctx.request_repaint()).map_err(|_| "the page takes no files")?;
        let start = Start { open: bar.link() };
        app.follow_in(Box::new(bar));
        begin(&mut app, start);
        Ok(Box::new(Page { app, announcer }) as Box<dyn eframe::App>)
    };
    let options = eframe::WebOptions::default();
    if let Err(error) = eframe::WebRunner::new().start(canvas.clone(), options, Box::new(create)).await {
        failure::refuse(&canvas, &error);
    }
}

/// The window, with a summary in the page.
struct Page {
    app: app::App,
    announcer: Announcer,
}

impl eframe::App for Page {
    fn raw_input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        self.app.raw_input_hook(ctx, input);
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        self.app.ui(ui, frame);
        self.announcer.announce(self.app.summary());
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.app.save(storage);
    }

    fn persist_egui_memory(&self) -> bool {
        self.app.persist_egui_memory()
    }

    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        self.app.clear_color(visuals)
    }
}
