//! Quantities over steps: one below the other where there is room, else the one that is chosen.

use eframe::egui::{Color32, ComboBox, RichText, TextStyle, Ui, vec2};
use motionscope_core::scene::{Series, Step};

use crate::ui::charts::series;
use crate::ui::drawing::chart::Subject;
use crate::view::panes::all_series;

/// Lines of small type below which a plot cannot be read.
const LINES: f32 = 12.0;
/// Between the titles to choose from, in points.
const GAP: f32 = 2.0;

/// Which one is seen where there is no room for all, and all as they are shown.
#[derive(Default)]
pub struct State {
    chosen: Option<&'static str>,
    plots: Vec<series::State>,
}

/// Shows all quantities of `step` that have values; gives the event that was clicked.
pub fn show(ui: &mut Ui, step: &Step, subject: Subject<'_>, state: &mut State) -> Option<usize> {
    let all: Vec<&Series> = all_series(step).collect();
    state.plots.resize_with(all.len(), Default::default);
    let small = subject.theme.sizes().small;
    if all.len() < 2 || ui.available_height() >= LINES * small * all.len() as f32 {
        return below_each_other(ui, &all, subject, &mut state.plots);
    }
    // By its title: another quantity may have got its first value meanwhile.
    let chosen = all.iter().position(|series| state.chosen == Some(series.title)).unwrap_or(0);
    let title = |i: usize| RichText::new(all[i].title).small();
    let mut choose = |ui: &mut Ui, i: usize| {
        if ui.selectable_label(i == chosen, title(i)).clicked() {
            state.chosen = Some(all[i].title);
        }
    };
    // As a list where they have no room beside each other: two rows of buttons would take that of the plot.
    if row_width(ui, &all) <= ui.available_width() {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            (0..all.len()).for_each(|i| choose(ui, i));
        });
    } else {
        let list = ComboBox::from_id_salt("plots").selected_text(title(chosen)).width(ui.available_width());
        let list = list.show_ui(ui, |ui| (0..all.len()).for_each(|i| choose(ui, i)));
        list.response.accessible_name("Quantity");
    }
    below_each_other(ui, &all[chosen..=chosen], subject, &mut state.plots[chosen..=chosen])
}

/// The width of the titles of `all` as buttons in a row.
fn row_width(ui: &Ui, all: &[&Series]) -> f32 {
    let font = TextStyle::Small.resolve(ui.style());
    let words = |series: &&Series| {
        ui.painter().layout_no_wrap(series.title.into(), font.clone(), Color32::PLACEHOLDER).size().x
    };
    let each = 2.0 * ui.spacing().button_padding.x + GAP;
    all.iter().map(|series| words(series) + each).sum()
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
