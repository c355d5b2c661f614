//! What is seen of motion: the colours over the picture, and arrows or streaklines.

use std::ops::RangeInclusive;

use eframe::egui::{
    self, Align, Button, Layout, Popup, PopupCloseBehavior, RichText, ScrollArea, Slider, SliderClamping, Ui,
    WidgetInfo, pos2, vec2,
};
use lucide_icons::Icon;
use motionscope_core::params::{Kind, Params, Spec, Value};
use motionscope_core::scene;

use super::{Input, Response, Spot, State, follow};
use crate::paint::{Backdrop, Color, Face, FlowLayer, Theme, Tint, TintKey, legend, number};
use crate::ui::commands::Command;
use crate::ui::drawing::{ink, primitives, style};
use crate::ui::parts::widgets;
use crate::view::look::Look;

/// Diameter of the wheel among the choices, in points.
const WHEEL: f32 = 88.0;
/// Diameter of the wheel over a picture, in points.
const CORNER_WHEEL: f32 = 72.0;
/// Between a picture and the wheel beside it, in points.
const BESIDE: f32 = 4.0;
/// How much more may move under the wheel than in another corner before it goes there.
const STAYS: f32 = 0.15;
/// Sides of a picture that has room for a wheel, in wheels.
const ROOM: f32 = 2.5;

/// The button that unfolds the choices.
pub fn button(ui: &mut Ui, input: &Input<'_>, state: &mut State, response: &mut Response) {
    let caret = widgets::icon(ui, Icon::ChevronDown);
    let opener = ui.add(Button::new(("Motion", caret)));
    opener.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, "Motion"));
    if input.checking {
        ui.spinner().on_hover_text("Running the reverse pair for the forward–backward check (Esc cancels).");
    }
    let tip = Command::NextLayer.with_key("Colours, arrows and streaklines that show the motion.");
    let opener = opener.on_hover_text(tip);
    let popup = Popup::menu(&opener).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    popup.show(|ui| {
        // In a low window the choices are scrolled, and the last of them stays in reach.
        let room = ui.content_rect().height() - 2.0 * ui.spacing().interact_size.y;
        ScrollArea::vertical().max_height(room).show(ui, |ui| choices(ui, input, state, &mut response.look));
    });
}

fn choices(ui: &mut Ui, input: &Input<'_>, state: &mut State, look: &mut Look) {
    ui.set_width(19.0 * input.theme().sizes().body);
    ui.label(RichText::new("Colours over the picture").small().weak());
    let now = input.available.chosen(look.layer);
    for layer in FlowLayer::ALL.into_iter().filter(|layer| input.available.offers(*layer)) {
        let why = input.available.why_never(layer);
        let item = ui.add_enabled(why.is_none(), Button::selectable(now == layer, layer.name()).min_size(wide(ui)));
        let is_now = now == layer;
        item.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, why.is_none(), is_now, layer.name()));
        let message = match why {
            Some(why) => format!("{} Unavailable: {why}.", layer.tip()),
            None if input.available.awaited(Some(layer)).is_some() => {
                format!("{} Available at the end of the run.", layer.tip())
            }
            None => layer.tip().into(),
        };
        if item.on_hover_text(&message).on_disabled_hover_text(&message).clicked() {
            look.layer = Some(layer);
        }
    }
    if now != FlowLayer::None {
        let percent =
            Shown { factor: 100.0, suffix: " %", name: "Opacity of the colours in %", ..Shown::new("Opacity") };
        let usual = f64::from(now.usual_opacity().get());
        slider(ui, Entry { name: "layer-opacity", usual, reach: 0.0..=1.0, shown: percent }, look);
        if now.quantity().is_none() {
            let px = Shown {
                suffix: " px",
                name: "End of the scale in px",
                is_logarithmic: true,
                decimals: 2,
                ..Shown::new("Scale")
            };
            let usual = input.pictures.layer.as_deref().map_or(1.0, |layer| f64::from(layer.end()));
            slider(ui, Entry { name: "color-scale", usual, reach: 0.1..=64.0, shown: px }, look);
        }
        let mut is_dimmed = look.backdrop == Backdrop::Dimmed;
        if ui.checkbox(&mut is_dimmed, "Dim the picture").on_hover_text(Backdrop::Dimmed.tip()).changed() {
            look.backdrop = if is_dimmed { Backdrop::Dimmed } else { Backdrop::Plain };
        }
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
            let can_be = !streaks || input.available.has_field();
            let shown = ui.add_enabled(can_be, Button::selectable(look.streaks.is_some() == streaks, name));
            if shown
                .on_hover_text(&tip)
                .on_disabled_hover_text("This estimator tracks single points; there is no dense flow to draw.")
                .clicked()
            {
                look.streaks = streaks.then(|| look.streaks.unwrap_or_default());
            }
        }
    });
    let px = Shown { suffix: " px", name: "Spacing in px", is_logarithmic: true, ..Shown::new("Spacing") };
    let usual = scene::arrow_spacing(input.pictures.pair[0].size()) as f64;
    slider(ui, Entry { name: "arrow-spacing", usual, reach: 1.0..=128.0, shown: px }, look);
    let times = Shown { suffix: " ×", is_logarithmic: true, decimals: 2, ..Shown::new("Length of arrows") };
    let usual = f64::from(state.marks.look(input).lengthen);
    slider(ui, Entry { name: "arrow-scale", usual, reach: 0.25..=16.0, shown: times }, look);
    if let Some(Tint { key: TintKey::Wheel(longest), .. }) = input.pictures.layer.as_deref() {
        ui.separator();
        wheel(ui, input, *longest);
    }
}

fn wide(ui: &Ui) -> egui::Vec2 {
    vec2(ui.available_width(), 0.0)
}

/// An entry of the look that may be left open.
struct Entry {
    name: &'static str,
    /// What it comes to where it is left open.
    usual: f64,
    /// What the slider reaches; more may be typed.
    reach: RangeInclusive<f64>,
    shown: Shown,
}

/// How the slider of an entry looks.
struct Shown {
    label: &'static str,
    /// Its name for a screen reader.
    name: &'static str,
    /// What the number is multiplied by to be shown.
    factor: f64,
    suffix: &'static str,
    decimals: usize,
    is_logarithmic: bool,
}

impl Shown {
    fn new(label: &'static str) -> Self {
        Self { label, name: label, factor: 1.0, suffix: "", decimals: 0, is_logarithmic: false }
    }
}

/// A slider under its name, with the way back to what is chosen by itself.
fn slider(ui: &mut Ui, entry: Entry, look: &mut Look) {
    let Entry { name, usual, reach, shown } = entry;
    let Some((spec, Kind::Optional { of, word })) = spec(name).map(|spec| (spec, &spec.kind)) else { return };
    let now = match look.get(name) {
        Ok(Value::Real(value)) => Some(value),
        Ok(Value::Int(value)) => Some(value as f64),
        _ => None,
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(shown.label).small().weak()).on_hover_text(&spec.doc);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let auto = ui.selectable_label(now.is_none(), *word).on_hover_text(&spec.doc);
            let label = || format!("{} {word}", shown.label);
            auto.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, now.is_none(), label()));
            if auto.clicked() {
                look.set(name, word).unwrap_or_default();
            }
        });
    });
    let width = ui.available_width() - ui.spacing().interact_size.x - 3.0 * ui.spacing().item_spacing.x;
    ui.spacing_mut().slider_width = width;
    let mut value = now.unwrap_or(usual) * shown.factor;
    let range = reach.start() * shown.factor..=reach.end() * shown.factor;
    let slider = Slider::new(&mut value, range).logarithmic(shown.is_logarithmic).suffix(shown.suffix);
    let slider = slider.max_decimals(shown.decimals).clamping(SliderClamping::Never);
    let slider = if shown.is_logarithmic { slider } else { slider.step_by(1.0) };
    if ui.add(slider).accessible_name(shown.name).on_hover_text(&spec.doc).changed() {
        let value = value / shown.factor;
        let wanted = match **of {
            Kind::Int { min, max } => Value::Int((value.round() as i64).clamp(min, max)),
            Kind::Real { min, max } => Value::Real(value.clamp(min, max)),
            _ => return,
        };
        look.set(name, &wanted.to_string()).unwrap_or_default();
    }
}

/// The declaration of the entry called `name`.
fn spec(name: &str) -> Option<&'static Spec> {
    Look::entries().iter().find(|spec| spec.name == name)
}

/// The wheel beside the picture that has its colours, or else in the corner of it where least moves, with how far its rim is.
/// It stays in the `corner` where it was while little moves there.
pub fn corner_wheel(painter: &egui::Painter, spot: &Spot<'_>, layer: &Tint, (theme, corner): (Theme, &mut usize)) {
    let TintKey::Wheel(longest) = layer.key else { return };
    let (picture, pane) = (spot.lens.picture_rect(), spot.lens.pane);
    let seen = picture.intersect(pane);
    if seen.size().min_elem() < ROOM * CORNER_WHEEL {
        return;
    }
    let font = style::font(Face::Sans, theme.sizes().small);
    let words = painter.layout_no_wrap(format!("{} px", number(longest)), font, style::color(Color::WHITE));
    let size = vec2(CORNER_WHEEL.max(words.size().x), CORNER_WHEEL + words.size().y) + vec2(12.0, 10.0);
    let at = |min: egui::Pos2| egui::Rect::from_min_size(min, size);
    let beside = [pos2(seen.min.x, seen.max.y + BESIDE), pos2(seen.max.x + BESIDE, seen.min.y)].map(at);
    let rect = beside.into_iter().find(|rect| pane.contains_rect(*rect)).unwrap_or_else(|| {
        let taken = [follow::map_rect(spot), follow::work_rect(spot)];
        let (right, low) = (seen.max.x - size.x, seen.max.y - size.y);
        let corners = [pos2(seen.min.x, low), seen.min, pos2(right, seen.min.y), pos2(right, low)].map(at);
        let is_taken = |rect: &egui::Rect| taken.iter().flatten().any(|other| other.intersects(*rect));
        let covered = corners.map(|rect| if is_taken(&rect) { f32::INFINITY } else { moving(spot, layer, rect) });
        let least = covered.iter().copied().fold(f32::INFINITY, f32::min);
        if covered[*corner % 4] > least + STAYS {
            *corner = covered.iter().position(|share| *share == least).unwrap_or(0);
        }
        corners[*corner % 4]
    });
    painter.rect_filled(rect, 6.0, egui::Color32::from_black_alpha(150));
    let center = pos2(rect.center().x, rect.min.y + 5.0 + CORNER_WHEEL / 2.0);
    painter.extend(primitives::shapes(painter, &legend::wheel(center.into(), CORNER_WHEEL / 2.0)));
    let below = pos2(rect.center().x - words.size().x / 2.0, center.y + CORNER_WHEEL / 2.0 + 2.0);
    painter.galley(below, words, style::color(Color::WHITE));
}

/// How much of what lies under `rect` has the colours of motion, from 0 to 1, by a few of its pixels.
fn moving(spot: &Spot<'_>, layer: &Tint, rect: egui::Rect) -> f32 {
    const STEPS: usize = 8;
    let (picture, (width, height)) = (spot.lens.picture_rect(), layer.pixels.size());
    let alpha = |i: usize| {
        let share = vec2((i % STEPS) as f32 + 0.5, (i / STEPS) as f32 + 0.5) / STEPS as f32;
        let [x, y] = <[f32; 2]>::from((rect.min + share * rect.size() - picture.min) / picture.size());
        let (x, y) = ((x * width as f32).max(0.0) as usize, (y * height as f32).max(0.0) as usize);
        layer.pixels.get(x, y).map_or(0.0, |color| f32::from(color[3]) / 255.0)
    };
    (0..STEPS * STEPS).map(alpha).sum::<f32>() / (STEPS * STEPS) as f32
}

/// The wheel, large enough to find a direction in it, with how far its rim is.
fn wheel(ui: &mut Ui, input: &Input<'_>, longest: f32) {
    let (text, dim) = (style::color(input.theme().chrome().text), style::color(input.theme().chrome().dim));
    let font = style::font(Face::Sans, input.theme().sizes().small);
    let line = 1.4 * font.size;
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), WHEEL + 2.0 * line + 8.0), egui::Sense::hover());
    let radius = format!("{} px/frame", number(longest));
    ink::name(&response, || format!("Flow colour wheel, radius {radius}"));
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
