//! What is seen of motion: the colours over the picture, and arrows or streaklines.

use eframe::egui::{
    self, Align, Button, Layout, Popup, PopupCloseBehavior, RichText, Slider, SliderClamping, Ui, WidgetInfo, vec2,
};
use lucide_icons::Icon;
use motionscope_core::scene;

use super::{Input, Response, State};
use crate::paint::{Face, FlowLayer, Lengthen, Opacity, Tint, TintKey, legend, number};
use crate::ui::app::commands::Command;
use crate::ui::drawing::{ink, primitives};
use crate::ui::parts::widgets;
use crate::view::look::{ARROW_SPACING_PX, Look};

/// Diameter of the wheel among the choices, in points.
const WHEEL: f32 = 88.0;
/// Distances of arrows in px that the slider reaches.
const SLIDER_PX: std::ops::RangeInclusive<u16> = 1..=128;
/// Factors that the slider of the arrows' length reaches.
const SLIDER_TIMES: std::ops::RangeInclusive<f32> = 0.25..=16.0;

/// The button that unfolds the choices.
pub fn button(ui: &mut Ui, input: &Input<'_>, state: &mut State, response: &mut Response) {
    let caret = widgets::icon(ui, Icon::ChevronDown);
    let opener = ui.add(Button::new(("Motion", caret)));
    opener.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, "Motion"));
    if input.checking {
        ui.spinner().on_hover_text("The reverse pair is run for the check (Esc gives it up).");
    }
    let tip = Command::NextLayer.with_key("What is seen of motion: colours, arrows and streaklines.");
    let opener = opener.on_hover_text(tip);
    let popup = Popup::menu(&opener).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    popup.show(|ui| choices(ui, input, state, &mut response.look));
}

fn choices(ui: &mut Ui, input: &Input<'_>, state: &mut State, look: &mut Look) {
    ui.set_width(19.0 * input.theme().sizes().body);
    ui.label(RichText::new("Colours over the picture").small().weak());
    let now = input.offer.chosen(look.layer);
    for layer in FlowLayer::ALL {
        let why = input.offer.why_never(layer);
        let item = ui.add_enabled(why.is_none(), Button::selectable(now == layer, layer.name()).min_size(wide(ui)));
        let is_now = now == layer;
        item.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, why.is_none(), is_now, layer.name()));
        let told = match why {
            Some(why) => format!("{} Not here: {why}.", layer.tip()),
            None if input.offer.awaited(Some(layer)).is_some() => {
                format!("{} It is there at the end of the run.", layer.tip())
            }
            None => layer.tip().into(),
        };
        if item.on_hover_text(&told).on_disabled_hover_text(&told).clicked() {
            look.layer = Some(layer);
        }
    }
    if now != FlowLayer::None {
        opacity(ui, now, look);
    }
    ui.separator();
    ui.horizontal(|ui| {
        ui.label(RichText::new("Motion as").small().weak());
        for (streaks, name, tip) in [
            (false, "Arrows", "Each displacement as an arrow.".to_owned()),
            (
                true,
                "Streaklines",
                Command::Streaks.with_key("Particles carried along by the motion, which leave a trail."),
            ),
        ] {
            let can_be = !streaks || input.offer.has_field();
            let shown = ui.add_enabled(can_be, Button::selectable(look.streaks.is_some() == streaks, name));
            if shown.on_hover_text(&tip).on_disabled_hover_text("Only single points are known to move here.").clicked()
            {
                look.streaks = streaks.then(|| look.streaks.unwrap_or_default());
            }
        }
    });
    spacing(ui, input, look);
    length(ui, state.marks.look(input).lengthen, look);
    if let Some(Tint { key: TintKey::Wheel(longest), .. }) = input.pictures.layer.as_deref() {
        ui.separator();
        wheel(ui, input, *longest);
    }
}

fn wide(ui: &Ui) -> egui::Vec2 {
    vec2(ui.available_width(), 0.0)
}

/// A slider under its name, with the way back to what is chosen by itself.
fn slider(ui: &mut Ui, name: &str, (is_auto, tip): (bool, &str), add: impl FnOnce(&mut Ui) -> egui::Response) -> bool {
    let mut to_auto = false;
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).small().weak()).on_hover_text(tip);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let auto = ui.selectable_label(is_auto, "auto").on_hover_text(format!("{tip} As it suits the picture."));
            auto.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_auto, format!("{name} auto")));
            to_auto = auto.clicked();
        });
    });
    let width = ui.available_width() - ui.spacing().interact_size.x - 3.0 * ui.spacing().item_spacing.x;
    ui.spacing_mut().slider_width = width;
    add(ui).on_hover_text(tip);
    to_auto
}

fn opacity(ui: &mut Ui, layer: FlowLayer, look: &mut Look) {
    let tip = "How far the colours hide the picture under them: at 100 % they stand alone.";
    let mut percent = 100.0 * look.layer_opacity.unwrap_or(layer.usual_opacity()).get();
    let mut moved = false;
    let to_auto = slider(ui, "Opacity", (look.layer_opacity.is_none(), tip), |ui| {
        let slider = Slider::new(&mut percent, 0.0..=100.0).step_by(1.0).max_decimals(0).suffix(" %");
        let response = ui.add(slider).accessible_name("Opacity of the colours in %");
        moved = response.changed();
        response
    });
    if moved {
        look.layer_opacity = Opacity::new(percent / 100.0).ok();
    }
    if to_auto {
        look.layer_opacity = None;
    }
}

fn spacing(ui: &mut Ui, input: &Input<'_>, look: &mut Look) {
    let tip = "From one arrow, or one particle, to the next, in px of the picture.";
    let usual = scene::arrow_spacing(input.pictures.pair[0].size()) as u16;
    let mut px = look.arrow_spacing.unwrap_or(usual);
    let mut moved = false;
    let to_auto = slider(ui, "Spacing", (look.arrow_spacing.is_none(), tip), |ui| {
        let slider = Slider::new(&mut px, SLIDER_PX).logarithmic(true).suffix(" px").clamping(SliderClamping::Never);
        let response = ui.add(slider).accessible_name("Spacing in px");
        moved = response.changed();
        response
    });
    if moved {
        look.arrow_spacing = Some(px.clamp(*ARROW_SPACING_PX.start(), *ARROW_SPACING_PX.end()));
    }
    if to_auto {
        look.arrow_spacing = None;
    }
}

/// How long arrows are: `now`, where nothing is chosen.
fn length(ui: &mut Ui, now: f32, look: &mut Look) {
    let tip = "How many times their length displacements are drawn; the legend says so.";
    let is_auto = look.arrow_scale == Lengthen::Auto;
    let mut times = now;
    let mut moved = false;
    let to_auto = slider(ui, "Length of arrows", (is_auto, tip), |ui| {
        let slider = Slider::new(&mut times, SLIDER_TIMES).logarithmic(true).suffix(" ×").max_decimals(2);
        let response = ui.add(slider).accessible_name("Length of arrows");
        moved = response.changed();
        response
    });
    if moved {
        look.arrow_scale = Lengthen::Times(times);
    }
    if to_auto {
        look.arrow_scale = Lengthen::Auto;
    }
}

/// The wheel, large enough to find a direction in it, with how far its rim is.
fn wheel(ui: &mut Ui, input: &Input<'_>, longest: f32) {
    let (text, dim) = (ink::color(input.theme().chrome().text), ink::color(input.theme().chrome().dim));
    let font = ink::font(Face::Sans, input.theme().sizes().small);
    let line = 1.4 * font.size;
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), WHEEL + 2.0 * line + 8.0), egui::Sense::hover());
    let radius = format!("{} px/frame", number(longest));
    ink::name(&response, || format!("Wheel of colours, {radius} from its middle to its rim"));
    let center = rect.center();
    let painter = ui.painter_at(rect);
    painter.extend(primitives::shapes(&painter, &legend::wheel(center.into(), WHEEL / 2.0)));
    let at = |x: f32, y: f32| center + vec2(x, y) * (WHEEL / 2.0 + 4.0);
    for (place, align, words) in [
        (at(0.0, -1.0), egui::Align2::CENTER_BOTTOM, "up"),
        (at(0.0, 1.0), egui::Align2::CENTER_TOP, "down"),
        (at(-1.0, 0.0), egui::Align2::RIGHT_CENTER, "left"),
    ] {
        painter.text(place, align, words, font.clone(), dim);
    }
    painter.text(at(1.0, 0.0), egui::Align2::LEFT_CENTER, radius, font, text);
}
