//! Every key on one page, and what the program is.

use eframe::egui::style::ScrollStyle;
use eframe::egui::{self, Grid, Label, RichText, ScrollArea, TextStyle, Ui, vec2};

use crate::paint::Theme;
use crate::ui::commands::{Command, Granularities, Menu, PANE_KEY, key_text};
use crate::ui::drawing::style;
use crate::ui::parts::widgets;

/// Between keys and names, in points.
const GAP: f32 = 16.0;

/// Shows the shortcut sheet; gives whether it is still open.
pub fn shortcuts(ctx: &egui::Context, granularities: &Granularities, theme: Theme) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let screen = ctx.content_rect();
    let modal = widgets::modal(ctx, "shortcuts", vec2(62.0 * size, 70.0 * size)).show(ctx, |ui| {
        ui.set_width((62.0 * size).min(widgets::room_of_dialog(ctx).x));
        let is_closed = widgets::title(ui, "Keyboard shortcuts");
        ui.add_space(8.0);
        let height = (screen.height() - 190.0).max(120.0);
        // A bar that is always there says that the page goes on.
        ui.spacing_mut().scroll = ScrollStyle { bar_width: 8.0, ..ScrollStyle::solid() };
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            ui.columns(2, |columns| {
                let (left, right) = columns.split_at_mut(1);
                column(&mut left[0], &[Menu::Walk, Menu::Export, Menu::Help], granularities, theme);
                column(&mut right[0], &[Menu::File, Menu::Edit, Menu::View], granularities, theme);
            });
        });
        ui.add_space(8.0);
        let pane = PANE_KEY.name();
        let ways =
            format!("Tab goes to the next control, {pane} to the next pane, with Shift back. Esc closes this page.");
        ui.label(RichText::new(ways).small().weak());
        is_closed
    });
    !(modal.should_close() || modal.inner)
}

/// Groups below each other; their keys and names stand in line.
fn column(ui: &mut Ui, menus: &[Menu], granularities: &Granularities, theme: Theme) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    for &menu in menus {
        widgets::heading(ui, menu.name());
        ui.add_space(2.0);
        group(ui, menu, granularities, (theme, 9.0 * size));
        ui.add_space(14.0);
    }
}

/// The keys of a menu, in a column of a given width, and what they do.
fn group(ui: &mut Ui, menu: Menu, granularities: &Granularities, (theme, keys): (Theme, f32)) {
    // Long names wrap before they reach the next column of groups.
    let names = ui.available_width() - keys - 2.0 * GAP;
    Grid::new(menu.name()).num_columns(2).spacing([GAP, 4.0]).min_col_width(keys).show(ui, |ui| {
        let here =
            Command::ALL.iter().filter(|command| command.entry().menu == menu && command.is_listed(granularities));
        for (command, keys) in
            here.map(|command| (command, command.keys(granularities))).filter(|(_, keys)| !keys.is_empty())
        {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                for key in keys.iter().take(2) {
                    widgets::key_cap(ui, &key_text(*key), theme);
                }
            });
            ui.scope(|ui| {
                ui.set_max_width(names);
                let name = ui.add(Label::new(command.text(granularities)).wrap());
                name.on_hover_text(command.tip(granularities));
            });
            ui.end_row();
        }
    });
}

/// Shows what the program is; gives whether it is still open.
pub fn about(ctx: &egui::Context) -> bool {
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let modal = widgets::modal(ctx, "about", vec2(30.0 * size, 20.0 * size)).show(ctx, |ui| {
        ui.set_width(30.0 * size);
        ui.label(RichText::new("Motionscope").family(style::bold()).size(1.6 * size));
        ui.label(RichText::new(concat!("Version ", env!("CARGO_PKG_VERSION"))).weak());
        ui.add_space(8.0);
        ui.label(
            "Step through the motion estimators of a computer-vision course, forwards and backwards, on your own clip.",
        );
        ui.add_space(8.0);
        ui.label(
            RichText::new("Fonts: Inter and JetBrains Mono (OFL). Icons: Lucide (ISC). Colours: Okabe and Ito.").weak(),
        );
        ui.add_space(12.0);
        ui.button("Close").clicked()
    });
    !(modal.should_close() || modal.inner)
}
