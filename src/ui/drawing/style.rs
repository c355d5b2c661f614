//! The look of the chrome: the theme's colours and sizes as egui wants them. A 4-pt grid, one accent.

use std::collections::BTreeMap;
use std::sync::Arc;

use eframe::egui::epaint::Shadow;
use eframe::egui::style::{ScrollStyle, WidgetVisuals};
use eframe::egui::{
    self, Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Stroke, TextStyle, vec2,
};

use crate::paint::{Color, Face, Theme};

/// How large and how lively the window is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interface {
    /// Colours and type.
    pub theme: Theme,
    /// Interface scale on top of the system's.
    pub zoom: f32,
    /// Whether things change at once.
    pub reduced_motion: bool,
}

/// The smallest and the largest interface scale, and the step between two.
pub const ZOOM: (f32, f32, f32) = (0.6, 2.5, 0.1);

/// Height of a line of small type in points.
pub fn line_height(theme: Theme) -> f32 {
    (theme.sizes().small * 1.7).round()
}

/// A colour of the theme as the window wants it.
pub fn color(color: Color) -> Color32 {
    let [r, g, b, a] = color.0;
    Color32::from_rgba_unmultiplied(r, g, b, a)
}

/// A face of the program's type at `size` points.
pub fn font(face: Face, size: f32) -> FontId {
    let family = match face {
        Face::Sans => FontFamily::Proportional,
        Face::Mono => FontFamily::Monospace,
        Face::Bold => bold(),
        Face::Italic => FontFamily::Name("italic".into()),
    };
    FontId::new(size, family)
}

/// The family of semi-bold type.
pub fn bold() -> FontFamily {
    FontFamily::Name("bold".into())
}

/// The family of the icons.
pub fn icons() -> FontFamily {
    FontFamily::Name("icons".into())
}

/// The icons that are used, cut out of the whole font.
pub static ICONS: &[u8] = include_bytes!("../../../assets/fonts/Lucide.ttf");

/// Teaches egui the program's own type and icons.
pub fn install_fonts(ctx: &egui::Context) {
    let mut fonts = FontDefinitions::empty();
    let mut put = |name: &str, bytes: &'static [u8]| {
        fonts.font_data.insert(name.into(), Arc::new(FontData::from_static(bytes)));
    };
    put("sans", Face::Sans.bytes());
    put("bold", Face::Bold.bytes());
    put("italic", Face::Italic.bytes());
    put("mono", Face::Mono.bytes());
    put("icons", ICONS);
    let families = [
        (FontFamily::Proportional, ["sans", "mono", "icons"].as_slice()),
        (FontFamily::Monospace, &["mono", "sans", "icons"]),
        (bold(), &["bold", "sans", "mono", "icons"]),
        (FontFamily::Name("italic".into()), &["italic", "sans", "mono"]),
        (icons(), &["icons", "sans"]),
    ];
    for (family, chain) in families {
        fonts.families.insert(family, chain.iter().map(|name| (*name).to_owned()).collect());
    }
    ctx.set_fonts(fonts);
}

/// Gives the whole window this look.
pub fn apply(ctx: &egui::Context, interface: Interface) {
    let Interface { theme, zoom, reduced_motion } = interface;
    ctx.options_mut(|options| {
        options.zoom_with_keyboard = false;
        options.theme_preference = if theme == Theme::Light { egui::Theme::Light } else { egui::Theme::Dark }.into();
    });
    if (ctx.zoom_factor() - zoom).abs() > 1e-3 {
        ctx.set_zoom_factor(zoom);
    }
    ctx.all_styles_mut(|style| {
        // The program as the README builds it is no place for the toolkit's own notes.
        #[cfg(debug_assertions)]
        {
            style.debug.show_unaligned = false;
        }
        style.text_styles = text_styles(theme);
        style.spacing = spacing(theme);
        style.visuals = visuals(theme);
        style.animation_time = if reduced_motion { 0.0 } else { 0.12 };
        style.interaction.tooltip_delay = 0.4;
        style.interaction.selectable_labels = false;
        style.compact_menu_style = false;
        if reduced_motion {
            style.scroll_animation = egui::style::ScrollAnimation::none();
        }
    });
}

fn text_styles(theme: Theme) -> BTreeMap<TextStyle, FontId> {
    let sizes = theme.sizes();
    [
        (TextStyle::Small, FontId::new(sizes.small, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(sizes.body, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(sizes.body, FontFamily::Proportional)),
        (TextStyle::Heading, FontId::new(sizes.heading, bold())),
        (TextStyle::Monospace, FontId::new(sizes.mono, FontFamily::Monospace)),
    ]
    .into()
}

/// How much larger than in the other themes everything is.
pub fn scale(theme: Theme) -> f32 {
    theme.sizes().body / Theme::Dark.sizes().body
}

fn spacing(theme: Theme) -> egui::style::Spacing {
    let s = scale(theme);
    let row = (26.0 * s).round();
    egui::style::Spacing {
        item_spacing: vec2(8.0, 8.0) * s.sqrt(),
        button_padding: vec2(8.0, 4.0) * s,
        menu_margin: Margin::same(6),
        window_margin: Margin::same(16),
        interact_size: vec2(row, row),
        slider_rail_height: 4.0 * s,
        icon_width: 16.0 * s,
        icon_width_inner: 10.0 * s,
        icon_spacing: 8.0 * s,
        tooltip_width: 320.0 * s,
        menu_width: 320.0 * s,
        menu_spacing: 2.0,
        combo_height: 360.0 * s,
        // Lists that are given more room than usual get it.
        default_area_size: egui::vec2(600.0, 2000.0),
        indent: 16.0 * s,
        scroll: scroll(),
        ..Default::default()
    }
}

/// A thin bar that grows under the pointer, beside what it scrolls: never over the end of a slider.
fn scroll() -> ScrollStyle {
    let bar_width = 8.0;
    ScrollStyle { bar_width, floating_width: 3.0, floating_allocated_width: bar_width + 2.0, ..ScrollStyle::floating() }
}

fn visuals(theme: Theme) -> egui::Visuals {
    let chrome = theme.chrome();
    let mut visuals = if theme == Theme::Light { egui::Visuals::light() } else { egui::Visuals::dark() };
    let (text, dim, line) = (color(chrome.text), color(chrome.dim), color(chrome.line));
    let (raised, hovered, accent) = (color(chrome.raised), color(chrome.hovered), color(chrome.accent));
    let pressed = color(chrome.hovered.mix(chrome.accent, 0.25));
    let widget = |fill: Color32, stroke: Color32, words: Color32| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: Stroke::new(1.0, stroke),
        corner_radius: CornerRadius::same(5),
        fg_stroke: Stroke::new(1.0, words),
        expansion: 0.0,
    };
    let widgets = &mut visuals.widgets;
    widgets.noninteractive = widget(color(chrome.panel), line, text);
    widgets.inactive = widget(raised, raised, text);
    widgets.hovered = widget(hovered, hovered, text);
    widgets.active = widget(pressed, pressed, text);
    widgets.open = widget(hovered, hovered, text);
    visuals.weak_text_color = Some(dim);
    visuals.selection.bg_fill = color(chrome.selection);
    visuals.selection.stroke = Stroke::new(1.0, text);
    visuals.hyperlink_color = accent;
    visuals.panel_fill = color(chrome.panel);
    visuals.window_fill = color(chrome.panel);
    visuals.window_stroke = Stroke::new(1.0, line);
    visuals.faint_bg_color = color(chrome.panel.mix(chrome.raised, 0.5));
    visuals.extreme_bg_color = color(chrome.raised);
    visuals.text_edit_bg_color = Some(color(chrome.background));
    visuals.code_bg_color = raised;
    visuals.warn_fg_color = color(chrome.error);
    visuals.error_fg_color = color(chrome.error);
    let shade = if theme == Theme::Light { 40 } else { 110 };
    let shadow = Shadow { offset: [0, 6], blur: 24, spread: 0, color: Color32::from_black_alpha(shade) };
    (visuals.window_shadow, visuals.popup_shadow) = (shadow, shadow);
    (visuals.window_corner_radius, visuals.menu_corner_radius) = (CornerRadius::same(10), CornerRadius::same(8));
    visuals.slider_trailing_fill = true;
    visuals.handle_shape = egui::style::HandleShape::Circle;
    visuals.indent_has_left_vline = false;
    visuals.interact_cursor = Some(egui::CursorIcon::PointingHand);
    visuals.text_cursor.stroke = Stroke::new(2.0, accent);
    // A blinking cursor would draw the whole window anew twice a second.
    visuals.text_cursor.blink = false;
    visuals.disabled_alpha = 0.4;
    visuals
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::PathBuf;

    use ab_glyph::{Font as _, FontRef};
    use lucide_icons::Icon;

    /// The private characters, which stand for icons, with the names of these.
    fn named() -> impl Iterator<Item = (char, String)> {
        ('\u{e000}'..='\u{f8ff}').filter_map(|c| Icon::try_from(c).ok().map(|icon| (c, format!("{icon:?}"))))
    }

    /// The names of the icons in all source files.
    fn used() -> BTreeSet<String> {
        let (mut folders, mut found) =
            (vec![PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/src"))], BTreeSet::new());
        while let Some(folder) = folders.pop() {
            for path in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                let text = fs::read_to_string(path).unwrap_or_default();
                let names = text.split("Icon::").skip(1).map(|rest| rest.split(|c: char| !c.is_alphanumeric()).next());
                found.extend(names.flatten().map(str::to_owned));
            }
        }
        found
    }

    #[test]
    fn the_font_of_icons_has_all_that_are_used() {
        let (font, used) = (FontRef::try_from_slice(super::ICONS).expect("a font"), used());
        let all: Vec<(char, String)> = named().filter(|(_, name)| used.contains(name)).collect();
        assert!(all.len() > 90, "{} icons are used", all.len());
        let missing: Vec<_> = all.iter().filter(|(c, _)| font.glyph_id(*c).0 == 0).map(|(_, name)| name).collect();
        let codes: Vec<String> = all.iter().map(|(c, _)| format!("{:x}", u32::from(*c))).collect();
        let cut = "pyftsubset lucide.ttf --output-file=assets/fonts/Lucide.ttf --no-hinting --no-glyph-names --layout-features=";
        assert!(missing.is_empty(), "{missing:?} are missing; {cut} --unicodes={}", codes.join(","));
    }
}
