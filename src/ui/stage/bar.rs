//! Around the pictures: what to look at, what the marks mean, and the numbers of the pixel pointed at.

use eframe::egui::{self, Align, Align2, Layout, Pos2, Rect, Sense, Slider, Ui, WidgetInfo, pos2, vec2};
use lucide_icons::Icon;
use motionscope_core::base::words::fixed;
use motionscope_core::data::Frame;
use motionscope_core::scene::{Measured, Picture, Role, Shape};

use super::{Hovered, Input, Response, State, levels, lockstep, motion, pixels};
use crate::paint::legend::{self, Entry, Sample};
use crate::paint::{Face, FlowLayer, Look as SceneLook, Primitive, Share, Theme, View, number};
use crate::ui::drawing::{ink, primitives, style};
use crate::ui::parts::widgets;
use crate::view::look::Look;

/// Width of the line, in letters, from which it tells the zoom or what estimators in lockstep have in common.
const ROOMY_LETTERS: f32 = 42.0;

/// Shows the choice of view and layers at the right end of `line`; returns its rectangle.
pub fn tools(ui: &mut Ui, line: Rect, input: &Input<'_>, state: &mut State, response: &mut Response) -> Rect {
    let ui = &mut widgets::inside(ui, line, Layout::right_to_left(Align::Center));
    ui.spacing_mut().item_spacing.x = 4.0;
    more(ui, input, state, response);
    motion::button(ui, input, state, response);
    let is_roomy = line.width() > ROOMY_LETTERS * input.theme().sizes().body;
    if let Some(lockstep) = input.lockstep.filter(|_| is_roomy) {
        lockstep::choice(ui, &lockstep, response);
    } else if is_roomy {
        let percent = state.shown.map_or(100.0, |lens| lens.scale * ui.pixels_per_point() * 100.0);
        ui.weak(format!("{percent:.0} %"))
            .on_hover_text("Zoom. Turn the wheel or pinch over the picture; drag to move it.");
    }
    levels::choice(ui, input, &mut response.look.level);
    choice(ui, input, &mut response.look);
    if response.look.view == Some(View::Blend) {
        let mut share = response.look.blend.get();
        let slider = Slider::new(&mut share, 0.0..=1.0).step_by(0.01).show_value(false);
        let name = "Share of frame t+1 in the blend";
        ui.add(slider).on_hover_text(name).accessible_name(name);
        response.look.blend = Share::new(share).unwrap_or_default();
    }
    ui.min_rect()
}

/// The menu of less common tools.
fn more(ui: &mut Ui, input: &Input<'_>, state: &mut State, response: &mut Response) {
    let button = widgets::icon_button(ui, Icon::Ellipsis, "More of the stage", false);
    egui::Popup::menu(&button).show(|ui| {
        let pixels_per_point = ui.pixels_per_point();
        if ui.button("Fit picture").on_hover_text("Show the whole picture.").clicked() {
            state.fit();
        }
        if ui.button("Actual size").on_hover_text("One pixel of the picture to one pixel of the screen.").clicked() {
            state.one_to_one(pixels_per_point);
        }
        let is_shown = response.look.legend;
        if ui.selectable_label(is_shown, "Legend").on_hover_text("Show the legend of the marks.").clicked() {
            response.look.legend = !is_shown;
        }
        if let Some(lockstep) = &input.lockstep {
            ui.separator();
            lockstep::items(ui, lockstep, response);
        }
    });
}

/// The views in a list; those of the end only where it is reached.
fn choice(ui: &mut Ui, input: &Input<'_>, look: &mut Look) {
    let (now, at_end) = (super::view(input), input.pictures.prediction.is_some());
    // Each of several estimators has one picture.
    let can_be =
        |view: View| (at_end || !view.is_of_the_end()) && (view != View::SideBySide || input.lockstep.is_none());
    let list = egui::ComboBox::from_id_salt("view").selected_text(name(now, input));
    let shown = list.show_ui(ui, |ui| {
        for view in View::ALL {
            ui.add_enabled_ui(can_be(view), |ui| {
                let response = ui.selectable_label(now == view, name(view, input));
                if response.on_hover_text(view.tip()).on_disabled_hover_text(view.tip()).clicked() {
                    look.view = Some(view);
                }
            });
        }
    });
    shown.response.accessible_name("Pictures");
}

/// The longest name of a picture that is named beside another, in characters.
const LONGEST: usize = 10;

/// The name of a view: a step may have other pictures than both frames.
fn name(view: View, input: &Input<'_>) -> String {
    let pictures = &input.scene.pictures;
    if view == View::Current && input.pictures.are_filtered() {
        return pictures.first().map_or_else(String::new, |canvas| canvas.picture.title(None));
    }
    if view != View::SideBySide || pictures.len() < 2 {
        return view.name().to_owned();
    }
    let names: Vec<_> = pictures.iter().map(|canvas| canvas.picture.title(None)).collect();
    match &names[..] {
        [first, second] if second.chars().count() <= LONGEST => format!("{first} and {}", second.to_lowercase()),
        [_, _] => "Both pictures".to_owned(),
        _ => "All pictures".to_owned(),
    }
}

/// Shows the line below the pictures, the pixel under the pointer in numbers or what the marks mean; gives the role whose entry of the
/// legend is pointed at.
pub fn line(ui: &mut Ui, input: &Input<'_>, state: &mut State) -> Option<Role> {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), style::line_height(input.theme())), Sense::hover());
    if let Some(hovered) = state.hovered {
        readout(ui, input, hovered, (rect, &response));
        return None;
    }
    if !input.look.legend || input.panes.legend().is_some() {
        return None;
    }
    let look = state.marks.look(input);
    let items = legend_items(input, &look, ui, state);
    ink::name(&response, || format!("Legend: {}", items.plain()));
    let shown = items.fitting(ui, rect.size());
    shown.paint(ui, rect);
    let lit = response.hover_pos().and_then(|at| shown.pointed(at, rect));
    if let Some((_, place)) = lit {
        let line = egui::Stroke::new(2.0, style::color(input.theme().chrome().accent));
        ui.painter().hline(place.x_range(), place.max.y - 1.0, line);
    }
    lit.map(|(role, _)| role).or(folded(ui, &items, &shown, rect))
}

/// Shows the legend in `room`, below each other if all have room like that; gives the role whose entry is pointed at.
pub fn list(ui: &mut Ui, room: Rect, input: &Input<'_>, state: &mut State) -> Option<Role> {
    if !input.look.legend {
        return None;
    }
    let look = state.marks.look(input);
    let mut items = legend_items(input, &look, ui, state);
    items.is_list = true;
    let response = ui.interact(room, ui.scope_id().with("legend"), Sense::hover());
    ink::name(&response, || format!("Legend: {}", items.plain()));
    let shown = items.fitting(ui, room.size());
    shown.paint(ui, room);
    let lit = response.hover_pos().and_then(|at| shown.pointed(at, room)).map(|(role, _)| role);
    lit.or(folded(ui, &items, &shown, room))
}

/// The number of entries of which none is `shown` in `rect`: all entries are listed where it is pointed at, and after a click until the
/// next one. Returns the role of the entry in that list that is pointed at.
fn folded(ui: &Ui, items: &Items, shown: &Items, rect: Rect) -> Option<Role> {
    if shown.hidden == 0 {
        return None;
    }
    let place = shown.place_of_more(rect, text_width(ui, "+88", items.theme));
    let button = ui.interact(place, ui.scope_id().with("folded legend"), Sense::click());
    let button = button.on_hover_cursor(egui::CursorIcon::PointingHand);
    let words = || format!("{} more in the legend", shown.hidden);
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, words()));
    match egui::Popup::menu(&button).show(|ui| items.list(ui)) {
        Some(list) => list.inner,
        None => {
            button.on_hover_ui(|ui| _ = items.list(ui));
            None
        }
    }
}

/// What stands in the legend, and how wide each item is.
#[derive(Clone)]
struct Items {
    entries: Vec<(Entry, f32)>,
    bars: Vec<(legend::Bar, f32)>,
    theme: Theme,
    /// How many there was no room for.
    hidden: usize,
    /// Whether each has a line of its own.
    is_list: bool,
}

const BAR: egui::Vec2 = vec2(96.0, 8.0);
const GAP: f32 = 8.0;

fn bar_width(bar: &legend::Bar, width_of: impl Fn(&str) -> f32) -> f32 {
    let [low, high] = bar.ends.each_ref().map(|words| width_of(words));
    if bar.ends[1].is_empty() { low } else { low + high + BAR.x + 2.0 * GAP }
}

/// What is drawn in the pictures that are shown.
fn legend_items(input: &Input<'_>, look: &SceneLook, ui: &Ui, state: &State) -> Items {
    let panels = super::view(input).panels(input.pictures);
    let shown = input.scene.marks.iter().filter(|mark| panels.iter().any(|panel| panel.shows(mark.on)));
    let zoom = state.shown.map_or(1.0, |lens| lens.scale);
    let has_numbers = state.shown.is_some_and(|lens| pixels::has_numbers(&lens));
    let has_heat = !has_numbers && shown.clone().any(|mark| matches!(mark.shape, Shape::Heat { .. }));
    let width = |text: &str| text_width(ui, text, input.theme());
    let tiles = input.lockstep.map_or(&[][..], |all| all.tiles);
    // Several have one scale.
    let layer = input.pictures.layer.as_ref().or_else(|| tiles.iter().find_map(|tile| tile.layer.as_ref()));
    let is_tinted = !has_numbers && panels.iter().any(|panel| panel.is_tinted());
    let (signs, bar) = layer.filter(|_| is_tinted).map(|layer| layer.legend()).unwrap_or_default();
    let awaited = input.pictures.awaited.filter(|_| is_tinted).map(FlowLayer::awaited);
    let entries =
        signs.into_iter().chain(awaited).chain(legend::entries(input.scene, shown, look, zoom)).map(|entry| {
            let width = ink::SWATCH.x + GAP + width(&entry.meaning);
            (entry, width)
        });
    let heat = look.heat.filter(|_| has_heat).map(|range| legend::Bar::heat(input.heat, range, look.colors));
    let bars = heat.into_iter().chain(bar).map(|bar| {
        let width = bar_width(&bar, width);
        (bar, width)
    });
    Items { entries: entries.collect(), bars: bars.collect(), theme: input.theme(), hidden: 0, is_list: false }
}

fn text_width(ui: &Ui, text: &str, theme: Theme) -> f32 {
    let font = style::font(Face::Sans, theme.sizes().small);
    ui.painter().layout_no_wrap(text.into(), font, egui::Color32::PLACEHOLDER).size().x
}

impl Items {
    /// Where each item goes within `width`, and the number of lines.
    fn layout(&self, width: f32) -> (Vec<Pos2>, usize) {
        let (mut at, mut line, height) = (0.0, 0usize, style::line_height(self.theme));
        let place = |item: f32| {
            if at > 0.0 && (self.is_list || at + item > width) {
                (at, line) = (0.0, line + 1);
            }
            let place = pos2(at, line as f32 * height);
            at += item + 2.0 * GAP;
            place
        };
        let places = self.widths().map(place).collect();
        (places, line + 1)
    }

    /// Those that fit in `room`, the colour scales before all, and how many are left; a list flows in lines where it has no room.
    fn fitting(&self, ui: &Ui, room: egui::Vec2) -> Items {
        let more = text_width(ui, "+88", self.theme) + 2.0 * GAP;
        let lines = ((room.y / style::line_height(self.theme)) as usize).max(1);
        let (widest, total) = self.column();
        if self.is_list && total <= lines && widest <= room.x {
            return self.clone();
        }
        let mut shown = Items { entries: Vec::new(), bars: Vec::new(), hidden: total, is_list: false, ..self.clone() };
        for bar in &self.bars {
            shown.bars.push(bar.clone());
            if shown.fits(room.x, lines, more) { shown.hidden -= 1 } else { drop(shown.bars.pop()) }
        }
        for entry in &self.entries {
            shown.entries.push(entry.clone());
            if shown.fits(room.x, lines, more) { shown.hidden -= 1 } else { drop(shown.entries.pop()) }
        }
        shown
    }

    /// Whether all have room, the last of which is one of `hidden`, and `more` beside them unless it is the only one.
    fn fits(&self, width: f32, lines: usize, more: f32) -> bool {
        let (places, count) = self.layout(width);
        let last = (count - 1) as f32 * style::line_height(self.theme);
        places.iter().zip(self.widths()).all(|(place, item)| {
            let is_beside = place.y == last && count == lines && self.hidden > 1;
            place.x + item <= width - if is_beside { more } else { 0.0 }
        }) && count <= lines
    }

    /// Where the number of those that are left stands, of this `width`: behind the others in the last line of `rect`.
    fn place_of_more(&self, rect: Rect, width: f32) -> Rect {
        let height = style::line_height(self.theme);
        let lines = ((rect.height() / height) as usize).max(1);
        let (places, count) = self.layout(rect.width());
        let y = count.min(lines - 1) as f32 * height;
        let ends = places.iter().zip(self.widths()).filter(|(place, _)| place.y == y);
        let left = ends.map(|(place, item)| place.x + item + 2.0 * GAP).fold(0.0, f32::max).min(rect.width() - width);
        Rect::from_min_size(rect.min + vec2(left.max(0.0), y), vec2(width, height))
    }

    fn widths(&self) -> impl Iterator<Item = f32> {
        self.entries.iter().map(|(_, width)| *width).chain(self.bars.iter().map(|(_, width)| *width))
    }

    /// Width of the widest, and how many lines there are with one in each.
    fn column(&self) -> (f32, usize) {
        (self.widths().fold(0.0, f32::max), self.entries.len() + self.bars.len())
    }

    /// Shows all below each other, and returns the role of the one that is pointed at.
    fn list(&self, ui: &mut Ui) -> Option<Role> {
        let (width, lines) = self.column();
        let size = vec2(width, lines as f32 * style::line_height(self.theme));
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        self.paint(ui, rect);
        response.hover_pos().and_then(|at| self.pointed(at, rect)).map(|(role, _)| role)
    }

    fn plain(&self) -> String {
        let words = self.entries.iter().map(|(entry, _)| entry.meaning.clone());
        words.chain(self.bars.iter().map(|(bar, _)| bar.plain())).collect::<Vec<_>>().join(", ")
    }

    /// The role of the entry at a place in `rect`, and where the entry stands, unless it tells of a layer of colours.
    fn pointed(&self, at: Pos2, rect: Rect) -> Option<(Role, Rect)> {
        let height = style::line_height(self.theme);
        let (places, _) = self.layout(rect.width());
        let rects = places.iter().zip(&self.entries).map(|(place, (entry, width))| {
            (entry, Rect::from_min_size(rect.min + place.to_vec2(), vec2(*width, height)))
        });
        let is_mark = |entry: &Entry| !matches!(entry.sample, Sample::Wheel | Sample::Hatch | Sample::Awaited);
        let mut pointed = rects.filter(|(entry, rect)| is_mark(entry) && rect.contains(at));
        pointed.next().map(|(entry, rect)| (entry.role, rect))
    }

    fn paint(&self, ui: &Ui, rect: Rect) {
        let places = self.layout(rect.width()).0;
        let height = style::line_height(self.theme);
        let text = style::color(self.theme.chrome().text);
        let font = style::font(Face::Sans, self.theme.sizes().small);
        let painter = ui.painter();
        let word = |at: Pos2, words: &str| {
            painter.text(at + vec2(0.0, height / 2.0), Align2::LEFT_CENTER, words, font.clone(), text).width()
        };
        for ((entry, _), place) in self.entries.iter().zip(&places) {
            let at = rect.min + place.to_vec2();
            let swatch = at + vec2(0.0, ((height - ink::SWATCH.y) / 2.0).round());
            let primitives = legend::swatch_of(&entry.own, (entry.role, entry.sample), self.theme, swatch.into());
            painter.extend(primitives::shapes(painter, &primitives));
            word(at + vec2(ink::SWATCH.x + GAP, 0.0), &entry.meaning);
        }
        for ((bar, _), place) in self.bars.iter().zip(&places[self.entries.len()..]) {
            let ([low, high], mut at) = (&bar.ends, rect.min + place.to_vec2());
            at.x += word(at, low) + GAP;
            if high.is_empty() {
                continue;
            }
            let colors = Rect::from_min_size(at + vec2(0.0, ((height - BAR.y) / 2.0).round()), BAR);
            if let Primitive::Image { pixels, .. } =
                legend::color_bar(bar.colors, crate::paint::primitive::Rect::new(colors.min.into(), BAR.into()))
            {
                painter.add(primitives::gradient(colors, pixels.row(0)));
            }
            word(pos2(colors.max.x + GAP, at.y), high);
        }
        if self.hidden > 0 {
            let dim = style::color(self.theme.chrome().dim);
            let place = self.place_of_more(rect, text_width(ui, "+88", self.theme));
            painter.text(place.left_center(), Align2::LEFT_CENTER, format!("+{}", self.hidden), font.clone(), dim);
        }
    }
}

/// The pixel pointed at, in numbers.
fn readout(ui: &Ui, input: &Input<'_>, hovered: Hovered, (rect, response): (Rect, &egui::Response)) {
    let chrome = input.theme().chrome();
    let (text, dim) = (style::color(chrome.text), style::color(chrome.dim));
    let size = input.theme().sizes().small;
    let font = style::font(Face::Sans, size);
    let painter = ui.painter_at(rect);
    let columns = columns(&compared(input, hovered.on), hovered.pixel);
    ink::name(response, || columns.iter().map(|c| format!("{} {}", c.label, c.value)).collect::<Vec<_>>().join(", "));
    let mut at = rect.left_center();
    for column in &columns {
        let label = painter.layout_no_wrap(column.label.clone(), font.clone(), dim);
        let value = painter.layout_no_wrap(column.value.clone(), font.clone(), text);
        let room = value.size().x.max(column.digits * 0.65 * size);
        let right = at.x + label.size().x + 0.5 * size + room;
        let end = right + if column.color.is_some() { 1.3 * size } else { 0.0 };
        if end > rect.max.x {
            break;
        }
        painter.galley(at - vec2(0.0, label.size().y / 2.0), label, dim);
        painter.galley(pos2(right - value.size().x, at.y - value.size().y / 2.0), value, text);
        if let Some(color) = column.color {
            let patch = Rect::from_center_size(pos2(right + 0.8 * size, at.y), vec2(0.9 * size, 0.9 * size));
            pixels::patch(&painter, patch, color);
        }
        at.x = end + 1.4 * size;
    }
}

struct Column {
    label: String,
    value: String,
    /// Room for this many digits, so that nothing jumps.
    digits: f32,
    color: Option<[u8; 3]>,
}

/// A picture with the pixel pointed at.
struct Probed<'a> {
    picture: Picture,
    frame: &'a Frame,
    measured: Option<&'a Measured>,
}

/// The pictures whose pixels lie where those of `on` do: those that are seen, or frames t and t + 1.
fn compared<'a>(input: &Input<'a>, on: Picture) -> Vec<Probed<'a>> {
    let pictures = input.pictures;
    let panels = super::view(input).panels(pictures);
    let seen: Vec<_> = panels.iter().map(|panel| panel.picture()).filter(|other| other.is_aligned_with(on)).collect();
    let pair = [Picture::CURRENT, Picture::NEXT];
    let all = if seen.len() < 2 && pair.contains(&on) { pair.to_vec() } else { seen };
    let probed = |picture| Probed { picture, frame: pictures.frame_of(picture), measured: pictures.measured(picture) };
    all.into_iter().map(probed).collect()
}

fn columns(pictures: &[Probed<'_>], pixel: [usize; 2]) -> Vec<Column> {
    let [x, y] = pixel;
    let column =
        |label: &str, value: String, digits| Column { label: label.replace('-', "−"), value, digits, color: None };
    let mut columns = vec![column("x", x.to_string(), 4.0), column("y", y.to_string(), 4.0)];
    let mut grays = Vec::new();
    for Probed { picture, frame, measured } in pictures {
        if let Some(measured) = measured {
            columns.push(column(&measured.symbol, fixed(measured.at(pixel).into(), 2), 7.0));
            continue;
        }
        let gray = pixels::gray_at(frame.luma(), pixel);
        grays.extend(gray.parse::<i32>());
        columns.push(Column { color: pixels::rgb_at(frame, pixel), ..column(&picture.to_string(), gray, 3.0) });
    }
    if let [a, b] = grays[..] {
        columns.push(column("change", number((b - a) as f32), 4.0));
    }
    for Probed { picture, frame, .. } in pictures {
        if let Some([r, g, b]) = pixels::rgb_at(frame, pixel) {
            columns.push(column(&format!("RGB {picture}"), format!("{r} {g} {b}"), 10.0));
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::ColorMap;
    use motionscope_core::geometry::Grid;

    #[test]
    fn a_pixel_is_reported_in_both_frames() {
        let gray = Frame::gray(Grid::from_fn(4, 4, |x, y| (10 * y + x) as u8));
        let rgb = Frame::rgb(Grid::new(4, 4, [30, 30, 30]));
        let probed = [
            Probed { picture: Picture::CURRENT, frame: &gray, measured: None },
            Probed { picture: Picture::NEXT, frame: &rgb, measured: None },
        ];
        assert_eq!(told(&probed), ["x 3", "y 2", "t 23", "t+1 30", "change 7", "RGB t+1 30 30 30"]);
    }

    #[test]
    fn a_filtered_picture_is_reported_with_its_values() {
        let frame = Frame::gray(Grid::new(4, 4, 90));
        let [smoothed, response] =
            [("G₂", 90.26), ("D₁", -3.25)].map(|(symbol, value)| Measured::new(symbol, "a title", move |_| value));
        let probed = [
            Probed { picture: Picture::SMOOTHED, frame: &frame, measured: Some(&smoothed) },
            Probed { picture: Picture::RESPONSE, frame: &frame, measured: Some(&response) },
        ];
        assert_eq!(told(&probed), ["x 3", "y 2", "G₂ 90.26", "D₁ −3.25"]);
    }

    /// Lays out a legend of three short entries, a long one and a colour scale in this many letters and lines; returns the numbers of its
    /// entries, its scales and those that are left.
    fn fitted(is_list: bool, letters: f32, lines: f32) -> (Vec<usize>, usize, usize) {
        let mut fitted = None;
        let ctx = egui::Context::default();
        let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let theme = Theme::Dark;
            let letter = text_width(ui, "+88", theme) / 3.0;
            let entry = |(i, letters): (usize, f32)| {
                let role = [Role::Candidate, Role::Window, Role::Reference, Role::Truth][i];
                (Entry { role, sample: Sample::Line, own: Vec::new(), meaning: "entry".into() }, letters * letter)
            };
            let entries: Vec<_> = [10.0, 10.0, 40.0, 10.0].into_iter().enumerate().map(entry).collect();
            let bar = legend::Bar::heat("cost", [0.0, 9.0], ColorMap::Viridis);
            let items = Items { entries, bars: vec![(bar, 10.0 * letter)], theme, hidden: 0, is_list };
            let room = vec2(letters * letter, lines * style::line_height(theme) + 1.0);
            let shown = items.fitting(ui, room);
            let (places, count) = shown.layout(room.x);
            assert!(count as f32 <= lines.max(1.0), "{count} lines");
            assert_eq!(places.len(), shown.entries.len() + shown.bars.len());
            let roles = items.entries.iter().map(|(entry, _)| entry.role);
            let is_shown = |role: &Role| shown.entries.iter().any(|(entry, _)| entry.role == *role);
            let numbers = roles.enumerate().filter(|(_, role)| is_shown(role)).map(|(i, _)| i).collect();
            fitted = Some((numbers, shown.bars.len(), shown.hidden));
        });
        output.textures_delta.clear();
        fitted.expect("a frame")
    }

    #[test]
    fn a_legend_flows_and_counts_what_it_leaves_out() {
        assert_eq!(fitted(false, 200.0, 1.0), (vec![0, 1, 2, 3], 1, 0), "all in one line");
        assert_eq!(fitted(false, 66.0, 2.0), (vec![0, 1, 2, 3], 1, 0), "all in two");
        assert_eq!(fitted(false, 66.0, 1.0), (vec![0, 1, 3], 1, 1), "the scale comes first, and the long one is left");
        assert_eq!(fitted(false, 4.0, 1.0), (vec![], 0, 5), "no room for any");
    }

    #[test]
    fn a_list_flows_where_it_has_no_line_for_each() {
        assert_eq!(fitted(true, 66.0, 5.0), (vec![0, 1, 2, 3], 1, 0));
        assert_eq!(fitted(true, 66.0, 2.0), (vec![0, 1, 2, 3], 1, 0));
        assert_eq!(fitted(true, 30.0, 5.0), (vec![0, 1, 3], 1, 1), "the long one is wider than the room");
    }

    fn told(probed: &[Probed<'_>]) -> Vec<String> {
        columns(probed, [3, 2]).into_iter().map(|c| format!("{} {}", c.label, c.value)).collect()
    }
}
