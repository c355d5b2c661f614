//! The bar at the top: menus, what is open, and the few buttons that are always wanted.

use eframe::egui::{self, Align, Button, Layout, MenuBar, RichText, TextStyle, Ui};
use lucide_icons::Icon;

use crate::paint::Theme;
use crate::ui::commands::{Actions, Command, Granularities, Menu, Situation};
use crate::ui::drawing::style;
use crate::ui::model::document::Document;
use crate::ui::panes::{parameters, transport};
use crate::ui::parts::{recent, widgets};

/// What the bar shows.
pub struct Input<'a> {
    /// What is open.
    pub document: &'a Document,
    /// The first frame of the pair that the run stands on, if one does.
    pub at_frame: Option<usize>,
    /// The parts of the run that it stands in, if the timeline does not say it.
    pub place: Option<String>,
    /// What can be done just now.
    pub now: Situation,
    /// The names of the ladder.
    pub granularities: Granularities,
    /// Whether the parameters that matter most stand in the bar.
    pub has_strip: bool,
    /// Clips that were open lately.
    pub recent: &'a [std::path::PathBuf],
}

/// Letters that the name of the clip has at least.
const CLIP_LETTERS: f32 = 5.0;

/// Width per point of type size below which the menus share one button.
const ROOMY: f32 = 70.0;

/// Draws the bar.
pub fn show(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let size = TextStyle::Body.resolve(ui.style()).size;
    let roomy = ui.available_width() / size > ROOMY;
    let is_upright = widgets::is_upright(ui.ctx());
    MenuBar::new().ui(ui, |ui| {
        brand(ui, input.now.look.theme, roomy && !input.has_strip);
        if roomy {
            for menu in Menu::ALL {
                ui.menu_button(menu.name(), |ui| items(ui, menu, input, actions));
            }
        } else {
            let glyph = widgets::icon(ui, Icon::Menu);
            let button = ui.menu_button(glyph, |ui| {
                for menu in Menu::ALL {
                    ui.menu_button(menu.name(), |ui| items(ui, menu, input, actions));
                }
            });
            let button = button.response.on_hover_text("Menu");
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Menu"));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            match is_upright {
                true => upright(ui, input, actions),
                false => right(ui, input, roomy, actions),
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| title(ui, input, actions));
        });
    });
}

fn brand(ui: &mut Ui, theme: Theme, roomy: bool) {
    let accent = style::color(theme.chrome().accent);
    if roomy {
        ui.label(widgets::icon(ui, Icon::ScanEye).color(accent));
        ui.label(RichText::new("Motionscope").family(style::bold()));
        ui.add_space(8.0);
    }
}

/// What is open: the clip, the pair of frames and the estimator, each with the way to another one. What there is no room for
/// is cut short: first the clip, then the way through the stages.
fn title(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    let Some(clip) = input.document.clip() else { return };
    let size = TextStyle::Body.resolve(ui.style()).size;
    ui.spacing_mut().item_spacing.x = 4.0;
    let info = input.document.estimator().info();
    let beside = input.document.side_by_side().beside.len();
    let estimator = if beside == 0 {
        info.name.to_owned()
    } else {
        format!("{} and {beside} {}", info.name, if beside == 1 { "other" } else { "others" })
    };
    let frame = input.at_frame.unwrap_or(input.document.frame());
    let is_single = input.document.estimator().is_of_single_frames();
    let frames = if is_single { format!("frame {frame}") } else { format!("frames {frame} → {}", frame + 1) };
    let width = |ui: &Ui, text: &str| {
        let font = TextStyle::Button.resolve(ui.style());
        ui.painter().layout_no_wrap(text.into(), font, egui::Color32::PLACEHOLDER).size().x
    };
    let padding = 2.0 * ui.spacing().button_padding.x + ui.spacing().item_spacing.x;
    let parents: Vec<&str> = input.document.parents().map(|parent| parent.name).collect();
    let most = ui.available_width() - CLIP_LETTERS * 0.6 * size - 1.4 * size - 2.0 * padding;
    let is_whole = width(ui, &estimator) <= most;
    let estimator =
        if is_whole { estimator } else { widgets::elide(&estimator, (most / (0.6 * size)).max(8.0) as usize) };
    let mut room = ui.available_width() - width(ui, &estimator) - 1.4 * size - 2.0 * padding;
    let crumb = |name: &str| format!("{name} ›");
    let whole: f32 = parents.iter().map(|name| width(ui, &crumb(name)) + padding).sum();
    let least = 8.0 * 0.6 * size;
    let has_whole_path = room - whole > least;
    room -= if has_whole_path {
        whole
    } else if parents.is_empty() {
        0.0
    } else {
        width(ui, &crumb("…")) + padding
    };
    let has_frames = parents.is_empty() && room - width(ui, &frames) > 2.0 * least;
    room -= if has_frames { width(ui, &frames) + 2.0 * ui.spacing().item_spacing.x + 8.0 } else { 0.0 };
    let name = widgets::elide(&clip.info().name, (room / (0.6 * size)).max(3.0) as usize);
    let clip = ui.menu_button(RichText::new(name).family(style::bold()), |ui| {
        for command in [Command::Open, Command::Samples, Command::Lessons] {
            item(ui, command, input, actions);
        }
        if !input.recent.is_empty() {
            ui.separator();
            recent::recents(ui, input.recent, actions);
        }
    });
    clip.response.on_hover_text(crate::ui::panes::clip_card::facts(input.document));
    let dim = ui.visuals().weak_text_color();
    if has_frames {
        ui.add_space(4.0);
        ui.label(RichText::new(frames).color(dim));
        ui.add_space(4.0);
    }
    let shown = if has_whole_path { &parents[..] } else { &parents[parents.len().saturating_sub(1)..] };
    for parent in shown {
        let text = crumb(if has_whole_path { parent } else { "…" });
        let crumb = ui.add(Button::new(RichText::new(text).color(dim)).frame_when_inactive(false));
        let tip = format!("Return to {parent}.");
        if crumb.on_hover_text(Command::OutOfStage.with_key(&tip)).clicked() {
            actions.command(Command::OutOfStage);
        }
    }
    let chooser = Button::new((estimator.as_str(), widgets::icon(ui, Icon::ChevronDown).color(dim)));
    let chooser = ui.add(chooser.frame_when_inactive(false));
    chooser.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &estimator));
    if chooser.on_hover_text(Command::Estimators.with_key(info.summary)).clicked() {
        actions.command(Command::Estimators);
    }
    if let Some(place) = input.place.as_ref().filter(|place| width(ui, place) + padding < ui.available_width()) {
        ui.label(RichText::new(place).color(dim));
    }
    if input.has_strip {
        let (document, theme) = (input.document, input.now.look.theme);
        let of = parameters::Input { document, placing: None, can_be_closed: false, theme };
        parameters::strip(ui, of, actions);
    }
}

/// The two buttons of a narrow bar; everything else is in the menu.
fn upright(ui: &mut Ui, input: &Input, actions: &mut Actions) {
    for command in [Command::ShowParameters, Command::Palette] {
        button(ui, command, input, actions);
    }
}

fn right(ui: &mut Ui, input: &Input, roomy: bool, actions: &mut Actions) {
    ui.spacing_mut().item_spacing.x = 2.0;
    if roomy {
        button(ui, Command::FullScreen, input, actions);
    }
    button(ui, Command::Lecture, input, actions);
    theme(ui, input.now.look.theme, actions);
    for command in [Command::ShowExplanation, Command::ShowCharts, Command::ShowParameters] {
        button(ui, command, input, actions);
    }
    ui.add_space(4.0);
    if !roomy {
        button(ui, Command::Palette, input, actions);
        return;
    }
    let dim = ui.visuals().weak_text_color();
    let words = RichText::new("Find").color(dim);
    let search = Button::new((widgets::icon(ui, Icon::Search).color(dim), words))
        .right_text(RichText::new(Command::Palette.key()).small().color(dim));
    let search = search.fill(style::color(input.now.look.theme.chrome().raised));
    let response = ui.add(search.min_size(egui::vec2(11.0 * TextStyle::Body.resolve(ui.style()).size, 0.0)));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Find a command"));
    if transport::tooltip(response, Command::Palette, &input.granularities).clicked() {
        actions.command(Command::Palette);
    }
    ui.add_space(8.0);
}

fn button(ui: &mut Ui, command: Command, input: &Input, actions: &mut Actions) {
    // What is on is bright, what is folded away is dim: a bar at rest is quiet.
    let dim = command.is_on(&input.now) == Some(false);
    let text = command.text(&input.granularities);
    let response = ui.scope(|ui| {
        if dim {
            ui.visuals_mut().widgets.inactive.fg_stroke.color = ui.visuals().weak_text_color();
        }
        ui.add_enabled_ui(command.enabled(&input.now), |ui| {
            widgets::icon_button(ui, command.entry().icon, &text, false)
        })
        .inner
    });
    let response = response.inner;
    if transport::tooltip(response, command, &input.granularities).clicked() {
        actions.command(command);
    }
}

fn theme(ui: &mut Ui, now: Theme, actions: &mut Actions) {
    let glyph = match now {
        Theme::Dark => Icon::Moon,
        Theme::Light => Icon::Sun,
        Theme::Projector => Icon::Projector,
    };
    let response = widgets::icon_button(ui, glyph, &format!("Theme: {}", now.name()), false);
    let response = response.on_hover_text(Command::NextTheme.with_key("Dark, light, or projector"));
    egui::Popup::menu(&response).show(|ui| {
        for (theme, command) in [
            (Theme::Dark, Command::DarkTheme),
            (Theme::Light, Command::LightTheme),
            (Theme::Projector, Command::ProjectorTheme),
        ] {
            if ui.selectable_label(theme == now, theme.name()).on_hover_text(command.entry().tip).clicked() {
                actions.command(command);
            }
        }
    });
}

fn items(ui: &mut Ui, menu: Menu, input: &Input, actions: &mut Actions) {
    ui.set_min_width(16.0 * TextStyle::Body.resolve(ui.style()).size);
    // Large type in a small window: what does not fit is scrolled to.
    let most = ui.ctx().content_rect().height() - 3.0 * ui.spacing().interact_size.y;
    egui::ScrollArea::vertical().max_height(most).show(ui, |ui| all_items(ui, menu, input, actions));
}

fn all_items(ui: &mut Ui, menu: Menu, input: &Input, actions: &mut Actions) {
    let listed = |command: &Command| command.entry().menu == menu && command.is_listed(&input.granularities);
    let mut commands: Vec<Command> = Command::ALL.iter().copied().filter(listed).collect();
    // What lies in one submenu stands together, where its first command does.
    let all = commands.clone();
    let section = |command: &Command| command.entry().section;
    let submenu = |command: &Command| command.entry().submenu;
    let first = |command: &Command| {
        let is_with = |other: &Command| section(other) == section(command) && submenu(other) == submenu(command);
        let of_submenu = submenu(command).and_then(|_| all.iter().position(is_with));
        of_submenu.or_else(|| all.iter().position(|other| other == command))
    };
    commands.sort_by_key(|command| (all.iter().position(|other| section(other) == section(command)), first(command)));
    for (index, group) in commands.chunk_by(|a, b| section(a) == section(b)).enumerate() {
        if index > 0 {
            ui.separator();
        }
        for together in group.chunk_by(|a, b| submenu(a).is_some() && submenu(a) == submenu(b)) {
            match submenu(&together[0]) {
                Some(within) => {
                    let (name, glyph) = within.info();
                    let icon = widgets::icon(ui, glyph).color(ui.visuals().weak_text_color());
                    ui.menu_button((icon, name), |ui| {
                        together.iter().for_each(|command| item(ui, *command, input, actions));
                    });
                }
                None => item(ui, together[0], input, actions),
            }
            if together[0] == Command::Samples && !input.recent.is_empty() {
                ui.menu_button((widgets::icon(ui, Icon::History), "Recent"), |ui| {
                    recent::recents(ui, input.recent, actions);
                });
            }
        }
    }
}

fn item(ui: &mut Ui, command: Command, input: &Input, actions: &mut Actions) {
    let face = command.entry();
    let glyph = match command.is_on(&input.now) {
        Some(true) => Icon::Check,
        _ => face.icon,
    };
    let dim = ui.visuals().weak_text_color();
    let (text, enabled) = (command.text(&input.granularities), command.enabled(&input.now));
    let button = Button::new((widgets::icon(ui, glyph).color(dim), text.as_str())).shortcut_text(command.key());
    let response = ui.add_enabled(enabled, button);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::MenuItem, enabled, &text));
    if response.on_hover_text(command.tip(&input.granularities)).clicked() {
        actions.command(command);
        ui.close();
    }
}
