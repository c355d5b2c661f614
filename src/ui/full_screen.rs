//! Full screen: of the window on a desktop, of the page in a browser.

use eframe::egui::Context;

/// Whether all of the screen is used.
pub fn is_on(ctx: &Context) -> bool {
    platform::is_on(ctx)
}

/// Uses all of the screen, or leaves it to other programs again. A browser allows it only after a key, a click or a tap.
pub fn set(ctx: &Context, is_on: bool) {
    platform::set(ctx, is_on);
}

#[cfg(not(target_arch = "wasm32"))]
mod platform {
    use eframe::egui::{Context, ViewportCommand};

    pub fn is_on(ctx: &Context) -> bool {
        ctx.input(|input| input.viewport().fullscreen.unwrap_or(false))
    }

    pub fn set(ctx: &Context, is_on: bool) {
        ctx.send_viewport_cmd(ViewportCommand::Fullscreen(is_on));
    }
}

#[cfg(target_arch = "wasm32")]
mod platform {
    use eframe::egui::Context;

    fn document() -> Option<web_sys::Document> {
        web_sys::window()?.document()
    }

    pub fn is_on(_: &Context) -> bool {
        document().is_some_and(|document| document.fullscreen_element().is_some())
    }

    pub fn set(_: &Context, is_on: bool) {
        let Some(document) = document() else { return };
        match document.document_element().filter(|_| is_on) {
            // Without a recent key or click the browser refuses, and the page stays as it is.
            Some(page) => _ = page.request_fullscreen(),
            None if document.fullscreen_element().is_some() => document.exit_fullscreen(),
            None => {}
        }
    }
}
