//! Quantities over steps: one below the other where there is room, else the one that is chosen.

use eframe::egui::{RichText, Ui, vec2};
use motionscope_core::scene::{Readout, Series};

use crate::ui::charts::series;
use crate::ui::drawing::chart::Subject;

/// Lines of small type below which a plot cannot be read.
const LINES: f32 = 12.0;

/// Which one is seen where there is no room for all, and all as they are shown.
#[derive(Default)]
pub struct State {
    chosen: usize,
    plots: Vec<series::State>,
}

/// Shows all quantities of `readouts` that go over steps; gives the event that was clicked.
pub fn show(ui: &mut Ui, readouts: &[Readout], subject: Subject<'_>, state: &mut State) -> Option<usize> {
    let all = readouts.iter().filter_map(|readout| match readout {
        Readout::Series(series) => Some(series),
        _ => None,
    });
    let all: Vec<&Series> = all.collect();
    state.plots.resize_with(all.len(), Default::default);
    let small = subject.theme.sizes().small;
    if all.len() < 2 || ui.available_height() >= LINES * small * all.len() as f32 {
        return below_each_other(ui, &all, subject, &mut state.plots);
    }
    state.chosen = state.chosen.min(all.len() - 1);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (i, series) in all.iter().enumerate() {
            ui.selectable_value(&mut state.chosen, i, RichText::new(series.title).small());
        }
    });
    let chosen = state.chosen..=state.chosen;
    below_each_other(ui, &all[chosen.clone()], subject, &mut state.plots[chosen])
}

fn below_each_other(ui: &mut Ui, all: &[&Series], subject: Subject<'_>, plots: &mut [series::State]) -> Option<usize> {
    let (count, gap) = (all.len().max(1) as f32, ui.spacing().item_spacing.y);
    let size = vec2(ui.available_width(), (ui.available_height() - gap * (count - 1.0)) / count);
    let mut clicked = None;
    for (series, plot) in all.iter().zip(plots) {
        let input = series::Input { series, subject, logarithmic: series.is_logarithmic };
        let show = |ui: &mut Ui| ui.allocate_ui(size, |ui| series::show(ui, input, plot).clicked);
        clicked = clicked.or(ui.push_id(series.title, show).inner.inner);
    }
    clicked
}
