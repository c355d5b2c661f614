//! The window on a desktop.

use motionscope_core::base::Error;

use super::{Start, app, begin, parts};
use crate::experiment::first;

/// Opens the window and returns when it is closed. The links that it copies lead to `link_base`, if that is given, from now on.
///
/// # Errors
/// A sentence that says what to do where no window can be opened.
pub fn run(start: Start, link_base: Option<String>) -> Result<(), Error> {
    let viewport = eframe::egui::ViewportBuilder::default()
        .with_title("Motionscope")
        .with_app_id("motionscope")
        .with_icon(parts::icon::icon())
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([720.0, 480.0])
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let create = move |cc: &eframe::CreationContext<'_>| {
        let mut app = app::App::new(&cc.egui_ctx, cc.storage)?;
        link_base.into_iter().for_each(|base| app.lead_links_to(base));
        begin(&mut app, start);
        Ok(Box::new(app) as Box<dyn eframe::App>)
    };
    eframe::run_native("Motionscope", options, Box::new(create)).map_err(|error| explain(&error))
}

/// Why no window could be opened, and what to do.
fn explain(error: &eframe::Error) -> Error {
    let example = first::EXAMPLE;
    let instead =
        format!("pictures need no window; try `motionscope run CLIP --estimator {example} --overlay FILE.png`");
    Error::new(match error {
        eframe::Error::WinitEventLoop(_) | eframe::Error::Winit(_) => format!(
            "no window can be opened here; start Motionscope on a desktop, or set DISPLAY or WAYLAND_DISPLAY to one; \
             {instead}"
        ),
        eframe::Error::Wgpu(_) => format!(
            "no graphics driver can draw the window ({error}); install a Vulkan or OpenGL driver (on Debian: \
             mesa-vulkan-drivers); {instead}"
        ),
        other => format!("the window could not be opened ({other}); {instead}"),
    })
}
