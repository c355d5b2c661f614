//! Leaves the reason in the page when the window cannot go on; the page shows it and offers to reload.

use std::cell::RefCell;

use wasm_bindgen::JsValue;
use web_sys::HtmlCanvasElement;

/// The attributes of the canvas with the message of a panic, and with the reason why nothing can be drawn.
const PANIC: &str = "data-panic";
const REFUSED: &str = "data-refused";

thread_local! {
    /// The canvas, for the hook: a hook may be called on any thread, a canvas only on its own.
    static DRAWN_ON: RefCell<Option<HtmlCanvasElement>> = const { RefCell::new(None) };
}

/// Has the message of a panic written at the canvas.
pub fn install(canvas: HtmlCanvasElement) {
    DRAWN_ON.set(Some(canvas));
    std::panic::set_hook(Box::new(|panic| {
        DRAWN_ON.with_borrow(|canvas| canvas.as_ref()?.set_attribute(PANIC, &panic.to_string()).ok());
    }));
}

/// Says that the browser cannot draw the window.
pub fn refuse(canvas: &HtmlCanvasElement, error: &JsValue) {
    let reason = error.as_string().unwrap_or_else(|| format!("{error:?}"));
    canvas.set_attribute(REFUSED, &reason).ok();
}
