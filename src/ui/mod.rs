//! The window: a stage, the numbers behind it, and a ladder to walk on.

pub mod app;
pub mod charts;
pub mod commands;
#[cfg(not(target_arch = "wasm32"))]
mod desktop;
pub mod dialogs;
pub mod drawing;
pub mod full_screen;
pub mod layout;
pub mod model;
#[cfg(target_arch = "wasm32")]
mod page;
pub mod panes;
pub mod parts;
pub mod stage;

use std::ffi::OsString;

#[cfg(not(target_arch = "wasm32"))]
pub use desktop::run;
#[cfg(target_arch = "wasm32")]
pub use page::run_in_page;

/// What the window opens with.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// A clip, a session or `synth:` and a scene; the start page if there is none.
    pub open: Option<OsString>,
}

/// Opens what the window is to show first.
pub fn begin(app: &mut app::App, start: Start) {
    match start.open {
        Some(name) => app.open(&name),
        None => app.begin_fresh(),
    }
}
