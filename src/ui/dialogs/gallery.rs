//! The bundled samples, each with its picture and what it teaches.

use eframe::egui::{self, RichText, ScrollArea, TextStyle, Ui, vec2};
use motionscope_core::synth::SCENES;

use crate::paint::Theme;
use crate::ui::commands::{Action, Actions};
use crate::ui::model::previews::{PICTURE_PX, Previews};
use crate::ui::parts::sample_card::{self, Face};
use crate::ui::parts::widgets;

/// How the gallery is drawn.
#[derive(Clone, Copy)]
pub struct Input {
    /// The look.
    pub theme: Theme,
    /// Whether pictures may move.
    pub plays: bool,
}

/// Shows the gallery; gives whether it is still open.
pub fn show(ctx: &egui::Context, previews: &mut Previews, input: Input, actions: &mut Actions) -> bool {
    previews.receive(ctx);
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let mut chosen = false;
    let room = (widgets::room_of_dialog(ctx) - vec2(12.0, 112.0)).max(vec2(240.0, 160.0));
    let modal = widgets::modal(ctx, "sample clips", vec2(70.0 * size, 60.0 * size)).show(ctx, |ui| {
        ui.set_width((70.0 * size).min(room.x));
        let is_closed = widgets::title(ui, "Samples");
        ui.label(RichText::new("Synthetic clips with exact ground truth. Each shows one effect.").weak());
        ui.add_space(8.0);
        let height = room.y.min(44.0 * size);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            chosen = cards(ui, previews, input, actions) || is_closed;
        });
    });
    !(modal.should_close() || chosen)
}

/// Cards in as many columns as fit; gives whether one was chosen.
fn cards(ui: &mut Ui, previews: &mut Previews, Input { theme, plays }: Input, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(ui.style()).size;
    let gap = 12.0;
    ui.set_width(ui.available_width() - 4.0);
    let columns = ((ui.available_width() + gap) / (15.0 * size + gap)).floor().max(1.0);
    let width = ((ui.available_width() + gap) / columns - gap).floor();
    let picture = width * PICTURE_PX.1 as f32 / PICTURE_PX.0 as f32 * 0.72;
    let size = vec2(width, picture + 9.4 * size);
    let face = Face { size, picture, has_words: true, plays, follows_focus: true, theme };
    let numbers: Vec<usize> = (0..SCENES.len()).collect();
    let mut chosen = false;
    ui.spacing_mut().item_spacing = vec2(gap, gap);
    for row in numbers.chunks(columns as usize) {
        ui.horizontal(|ui| {
            for of in row {
                if sample_card::show(ui, *of, previews, face).clicked() {
                    actions.ask(Action::OpenSample(&SCENES[*of]));
                    chosen = true;
                }
            }
        });
    }
    chosen
}
