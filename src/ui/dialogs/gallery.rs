//! The bundled samples, each with its picture and what it teaches.

use std::sync::mpsc::{Receiver, channel};

use eframe::egui::{
    self, Align, ColorImage, Layout, Rect, RichText, ScrollArea, Sense, Stroke, StrokeKind, TextStyle, TextureHandle,
    TextureOptions, Ui, WidgetInfo, pos2, vec2,
};
use motionscope_core::synth::{SCENES, Sample};

use crate::paint::Theme;
use crate::ui::app::action::{Action, Actions};
use crate::ui::drawing::style;
use crate::ui::parts::widgets;

/// Width and height of a sample's picture in pixels.
const PICTURE_PX: (usize, usize) = (240, 180);

/// The gallery with its pictures, which are made on a thread of their own.
#[derive(Default)]
pub struct State {
    pictures: Vec<Option<TextureHandle>>,
    coming: Option<Receiver<(usize, ColorImage)>>,
}

impl State {
    /// Takes in the pictures that are done; the first call has them made.
    fn update(&mut self, ctx: &egui::Context) {
        let Some(coming) = &self.coming else {
            self.pictures = vec![None; SCENES.len()];
            self.coming = Some(make(ctx.clone()));
            return;
        };
        for (index, image) in coming.try_iter() {
            let name = format!("sample {index}");
            if let Some(picture) = self.pictures.get_mut(index) {
                *picture = Some(ctx.load_texture(name, image, TextureOptions::LINEAR));
            }
        }
    }

    /// Whether every picture is there.
    pub fn is_complete(&self) -> bool {
        !self.pictures.is_empty() && self.pictures.iter().all(Option::is_some)
    }
}

fn make(ctx: egui::Context) -> Receiver<(usize, ColorImage)> {
    let (sender, receiver) = channel();
    let work = move || {
        for (index, sample) in SCENES.iter().enumerate() {
            let Some(image) = picture(sample) else { continue };
            if sender.send((index, image)).is_err() {
                return;
            }
            ctx.request_repaint();
        }
    };
    // Without a thread there are no pictures, only words.
    drop(std::thread::Builder::new().name("sample clips".into()).spawn(work));
    receiver
}

fn picture(sample: &Sample) -> Option<ColorImage> {
    let mut difficulty = sample.difficulty();
    (difficulty.width, difficulty.height) = PICTURE_PX;
    let clip = sample.clip(&difficulty).ok()?;
    let frame = clip.frame(difficulty.frames / 3).ok()?;
    let (width, height) = frame.size();
    let bytes: Vec<u8> = match frame.color() {
        Some(rgb) => rgb.cells().iter().flatten().copied().collect(),
        None => frame.luma().cells().iter().flat_map(|&v| [v; 3]).collect(),
    };
    Some(ColorImage::from_rgb([width, height], &bytes))
}

/// Shows the gallery; gives whether it is still open.
pub fn show(ctx: &egui::Context, state: &mut State, theme: Theme, actions: &mut Actions) -> bool {
    state.update(ctx);
    let size = TextStyle::Body.resolve(&ctx.global_style()).size;
    let screen = ctx.content_rect();
    let mut chosen = false;
    let room = (screen.size() - vec2(120.0, 220.0)).max(vec2(240.0, 160.0));
    let modal = widgets::modal(ctx, "sample clips", vec2(70.0 * size, 60.0 * size)).show(ctx, |ui| {
        ui.set_width((70.0 * size).min(room.x));
        let is_closed = widgets::title(ui, "Samples");
        ui.label(RichText::new("Synthetic clips with exact ground truth. Each shows one effect.").weak());
        ui.add_space(8.0);
        let height = room.y.min(44.0 * size);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            chosen = cards(ui, state, theme, actions) || is_closed;
        });
    });
    !(modal.should_close() || chosen)
}

/// Cards in as many columns as fit; gives whether one was chosen.
fn cards(ui: &mut Ui, state: &State, theme: Theme, actions: &mut Actions) -> bool {
    let size = TextStyle::Body.resolve(ui.style()).size;
    let gap = 12.0;
    ui.set_width(ui.available_width() - 4.0);
    let columns = ((ui.available_width() + gap) / (15.0 * size + gap)).floor().max(1.0);
    let width = ((ui.available_width() + gap) / columns - gap).floor();
    let picture = width * PICTURE_PX.1 as f32 / PICTURE_PX.0 as f32 * 0.72;
    let height = picture + 9.4 * size;
    let mut chosen = false;
    ui.spacing_mut().item_spacing = vec2(gap, gap);
    for (row, samples) in SCENES.chunks(columns as usize).enumerate() {
        ui.horizontal(|ui| {
            for (column, sample) in samples.iter().enumerate() {
                let texture = state.pictures.get(row * columns as usize + column).and_then(Option::as_ref);
                if card(ui, sample, texture, vec2(width, height), picture, theme).clicked() {
                    actions.ask(Action::OpenSample(sample));
                    chosen = true;
                }
            }
        });
    }
    chosen
}

fn card(
    ui: &mut Ui,
    sample: &Sample,
    texture: Option<&TextureHandle>,
    size: egui::Vec2,
    picture: f32,
    theme: Theme,
) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, sample.title));
    let chrome = theme.chrome();
    let lit = response.hovered() || response.has_focus();
    let (fill, edge) = if lit { (chrome.hovered, chrome.accent) } else { (chrome.raised, chrome.line) };
    let top = Rect::from_min_size(rect.min, vec2(rect.width(), picture));
    ui.painter().rect(rect, 8.0, style::color(fill), Stroke::new(1.0, style::color(edge)), StrokeKind::Inside);
    if let Some(texture) = texture {
        // The middle of the picture, cut to the card's shape.
        let cut = (1.0 - picture / rect.width() * PICTURE_PX.0 as f32 / PICTURE_PX.1 as f32) / 2.0;
        let uv = Rect::from_min_max(pos2(0.0, cut.max(0.0)), pos2(1.0, 1.0 - cut.max(0.0)));
        let image = egui::Image::new(texture).uv(uv).corner_radius(egui::CornerRadius { nw: 7, ne: 7, sw: 0, se: 0 });
        image.paint_at(ui, top.shrink(1.0));
    }
    let words = widgets::below(rect, picture).shrink2(vec2(12.0, 10.0));
    let mut ui = widgets::inside(ui, words, Layout::top_down(Align::LEFT));
    ui.spacing_mut().item_spacing.y = 4.0;
    ui.set_clip_rect(ui.clip_rect().intersect(words));
    ui.add(egui::Label::new(RichText::new(sample.title).family(style::bold())).wrap().selectable(false));
    ui.add(egui::Label::new(RichText::new(sample.teaches).small().weak()).wrap().selectable(false));
    response
}
