//! The window in a page of a browser.

mod address;
mod keys;

use wasm_bindgen::JsCast as _;

use super::{Start, app, begin};

/// The id of the canvas on which the page has the window drawn.
const CANVAS: &str = "motionscope";

/// Has the window drawn on the canvas of the page, for as long as the page is open.
pub fn run_in_page() {
    wasm_bindgen_futures::spawn_local(async {
        let Some(window) = web_sys::window() else { return };
        let canvas = window.document().and_then(|document| document.get_element_by_id(CANVAS));
        let Some(canvas) = canvas.and_then(|canvas| canvas.dyn_into::<web_sys::HtmlCanvasElement>().ok()) else {
            return;
        };
        keys::take(&window);
        let bar = address::LocationBar::new(window);
        let create = move |cc: &eframe::CreationContext<'_>| {
            let mut app = app::App::new(&cc.egui_ctx, cc.storage)?;
            let start = Start { open: bar.link() };
            app.follow_in(Box::new(bar));
            begin(&mut app, start);
            Ok(Box::new(app) as Box<dyn eframe::App>)
        };
        let started = eframe::WebRunner::new().start(canvas, eframe::WebOptions::default(), Box::new(create)).await;
        if let Err(error) = started {
            web_sys::console::error_1(&error);
        }
    });
}
