//! The stage: the two frames and the marks over them.
//!
//! [`show`] is a view: it draws what it is given and tells what the person points at. What is remembered is in
//! [`State`]; textures and shapes are kept there too, so that nothing is made twice.

mod bar;
mod follow;
mod glide;
mod lens;
mod levels;
mod lockstep;
mod loupe;
mod marks;
mod motion;
mod pen;
mod pictures;
mod pixels;
mod placing;
mod pulse;

use std::sync::Arc;

use eframe::egui::{self, Rect, Sense, Ui, Vec2, pos2, vec2};
use eframe::egui_wgpu::RenderState;
use motionscope_core::params::Placed;
use motionscope_core::scene::{Focus, Picture};
use motionscope_core::{Cursor, Pace, Role, Scene};

pub use lens::{Lens, Zoom};
pub use lockstep::Lockstep;
pub use pen::{Hand, PenWish, Presenting};
pub use placing::{Gesture, Placing};

use crate::paint::{self, Backdrop, Face, FreehandLine, Panel, Placement, Shown, Theme, View};
use crate::ui::drawing::{ink, primitives};
use crate::view::look::{Look, RunState};
use crate::view::motion::AvailableLayers;
use crate::view::tile::Tile;
use follow::Follow;
use glide::Glide;
use marks::Marks;
use pictures::Pictures;
use pulse::Pulse;

/// Between two pictures, in points.
const GAP: f32 = 4.0;
/// How far marks may reach beyond their picture, in points.
const BEYOND: f32 = 3.0;
/// How long a particle of a streakline lives, in seconds.
const LIFE_SECS: f64 = 3.2;
/// Between two pictures of moving particles, in seconds: half as often as a screen shows one.
const FLOW_SECS: f32 = 1.0 / 30.0;
/// How long each picture is seen when they blink, in seconds.
const BLINK_SECS: f64 = 0.6;

/// What the stage shows.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The frames, and at the end what the run has made of them.
    pub pictures: &'a paint::Pictures,
    /// The number of frame t.
    pub frame: usize,
    /// The marks; of several estimators those of all.
    pub scene: &'a Arc<Scene>,
    /// Several estimators, if there are.
    pub lockstep: Option<Lockstep<'a>>,
    /// The step that is shown.
    pub cursor: Cursor,
    /// Where the run stands, which decides the view where a look leaves it open.
    pub stands: RunState,
    /// How they look.
    pub look: Look,
    /// What the colours of heat stand for, for the legend: `SAD`.
    pub heat: &'a str,
    /// Which layers tell of motion.
    pub available: &'a AvailableLayers,
    /// Whether the reverse pair is being run.
    pub checking: bool,
    /// The window's graphics card, if it has one.
    pub gpu: Option<&'a RenderState>,
    /// What is being placed on the picture, if anything is.
    pub placing: Option<&'a Placing>,
    /// Whether what moved since the last step glides to its new place.
    pub animate: bool,
    /// Whether particles move.
    pub flows: bool,
    /// How it is presented.
    pub presenting: Presenting<'a>,
}

impl Input<'_> {
    fn theme(&self) -> Theme {
        self.look.theme
    }
}

/// What the stage remembers.
#[derive(Clone, Default)]
pub struct State {
    /// Where and how closely one looks, where that was chosen by hand; else the view follows the work.
    pub zoom: Zoom,
    /// The parameter of the estimator that is being placed on the picture.
    pub placing: Option<usize>,
    grip: Option<placing::Grip>,
    pictures: Pictures,
    marks: Marks,
    /// One for each estimator.
    glides: Vec<Glide>,
    pulses: Vec<Pulse>,
    /// Where the pictures lie.
    area: Option<Rect>,
    hovered: Option<Hovered>,
    /// How closely one looks at pictures whose pixels are not those of frame t.
    zooms: Vec<(Picture, Zoom)>,
    /// The pane that was shown last, for zooming without a pointer.
    shown: Option<Lens>,
    follow: Follow,
    /// The corner of a picture in which the wheel of colours lies.
    wheel_corner: usize,
    /// The marks under the magnifying glass.
    loupe: Marks,
    /// The line that is being drawn by hand.
    line: Option<FreehandLine>,
    /// The role of the words under the pointer: of the last frame, and of the current one.
    words: [Option<Role>; 2],
}

impl State {
    /// Begins a frame: what was pointed at in the last one is pointed out on the stage.
    pub fn begin_frame(&mut self) {
        let [seen, found] = &mut self.words;
        *seen = found.take();
    }

    /// Points out the marks of a role, whose words are pointed at.
    pub fn point_out(&mut self, role: Option<Role>) {
        let [_, found] = &mut self.words;
        *found = found.or(role);
    }

    /// Ends a frame, and asks for another one where other marks are to be pointed out.
    pub fn end_frame(&self, ctx: &egui::Context) {
        let [seen, found] = self.words;
        if seen != found {
            ctx.request_repaint();
        }
    }

    /// Lights the marks of the role that is pointed at in the legend, or else in words. They were painted before that was known.
    fn light(&mut self, ui: &Ui, in_legend: Option<Role>) {
        let [in_words, _] = self.words;
        let lit = in_legend.or(in_words);
        if std::mem::replace(&mut self.marks.lit, lit) != lit {
            ui.ctx().request_repaint();
        }
    }

    /// The role whose marks alone are shown, because its entry of the legend or its words are pointed at.
    pub fn lit(&self) -> Option<Role> {
        self.marks.lit
    }

    /// One image pixel to one pixel of the screen.
    pub fn one_to_one(&mut self, pixels_per_point: f32) {
        if let Some(lens) = self.shown {
            self.zoom = lens.at_scale(1.0 / pixels_per_point);
        }
    }

    /// The picture `factor` times as large; the pixel pointed at stays where it is, or else the point `at_hand`.
    pub fn magnify(&mut self, factor: f32, at_hand: Option<[f32; 2]>) {
        if let Some(lens) = self.shown {
            let held =
                self.hovered.map(Hovered::point).or(at_hand).filter(|&point| lens.pane.contains(lens.to_screen(point)));
            self.zoom = lens.zoomed(held.map_or(lens.pane.center(), |point| lens.to_screen(point)), factor);
        }
    }

    /// Where the pictures lie, in points of the window.
    pub fn area(&self) -> Rect {
        self.area.unwrap_or(Rect::ZERO)
    }

    /// The whole picture, until focus is asked for again.
    pub fn fit(&mut self) {
        self.zoom = Zoom::Fit;
        self.zooms.clear();
        self.follow.pause();
    }

    /// How closely one looks at `picture`: all whose pixels are those of frame t are looked at alike, as `aligned` says.
    fn zoom_of(&self, picture: Picture, aligned: Zoom) -> Zoom {
        if picture.is_aligned_with(Picture::CURRENT) {
            return aligned;
        }
        self.zooms.iter().find(|(other, _)| other.is_aligned_with(picture)).map_or(Zoom::Fit, |(_, zoom)| *zoom)
    }

    fn set_zoom(&mut self, picture: Picture, zoom: Zoom) {
        if picture.is_aligned_with(Picture::CURRENT) {
            self.zoom = zoom;
            return;
        }
        self.zooms.retain(|(other, _)| !other.is_aligned_with(picture));
        self.zooms.push((picture, zoom));
    }
}

/// The pixel under the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Hovered {
    on: Picture,
    pixel: [usize; 2],
}

impl Hovered {
    fn point(self) -> [f32; 2] {
        self.pixel.map(|c| c as f32)
    }

    fn focus(self) -> Focus {
        Focus::on(self.on, self.point())
    }
}

/// What the person did on the stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// The pixel that was clicked.
    pub clicked: Option<Focus>,
    /// The pixel under the pointer.
    pub hovered: Option<Focus>,
    /// The estimator that is to be explained.
    pub explained: Option<usize>,
    /// What estimators in lockstep are to have in common.
    pub paced: Option<Pace>,
    /// Whether the first of them is to go on alone.
    pub left: bool,
    /// How the pictures are to look.
    pub look: Look,
    /// What was placed on the picture.
    pub placed: Option<Placed>,
    /// What became of placing it.
    pub placing: Gesture,
    /// The line that was drawn by hand.
    pub drawn: Option<FreehandLine>,
    /// What is asked of the pen.
    pub pen: Option<PenWish>,
}

/// Shows the stage in the whole of `ui`.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
    let mut response = Response { look: input.look, ..Response::default() };
    if !input.presenting.is_bare {
        bar::tools(ui, &input, state, &mut response);
    }
    let input = Input { look: response.look, ..input };
    // Each of several estimators has its own level.
    let on_level = input.pictures.on_level(input.scene.levels.as_ref(), input.look.level, view(&input));
    let input = Input { pictures: &on_level, ..input };
    pictures_above_line(ui, &input, state, &mut response);
    let in_legend = match (input.placing, input.presenting.hand) {
        (Some(_), _) => {
            placing::tools(ui, &input, &mut response);
            None
        }
        (None, Hand::Draw(color)) => {
            pen::tools(ui, &input, color, &mut response);
            None
        }
        (None, _) => bar::line(ui, &input, state),
    };
    state.light(ui, in_legend);
    response
}

/// Shows the pictures and their legend alone, without tools, in the whole of `ui`.
pub fn show_plain(ui: &mut Ui, input: &Input<'_>, state: &mut State) {
    ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
    pictures_above_line(ui, input, state, &mut Response::default());
    let in_legend = bar::line(ui, input, state);
    state.light(ui, in_legend);
}

/// Shows the pictures, with room for a line below them.
fn pictures_above_line(ui: &mut Ui, input: &Input<'_>, state: &mut State, response: &mut Response) {
    let below = bar::line_height(input.theme()) + ui.spacing().item_spacing.y;
    let room = vec2(ui.available_width(), (ui.available_height() - below).max(40.0));
    let (area, _) = ui.allocate_exact_size(room, Sense::hover());
    state.area = Some(area);
    panes(ui, area, input, state, response);
}

/// The pictures on the stage just now.
fn panels(view: View, pictures: &paint::Pictures, time: f64) -> Vec<Panel> {
    let all = view.panels(pictures);
    if view != View::Blink {
        return all;
    }
    let turn = (time / BLINK_SECS) as usize % all.len().max(1);
    all.into_iter().skip(turn).take(1).collect()
}

/// What one picture on the stage shows.
struct Spot<'a> {
    /// Which of several estimators.
    member: usize,
    panel: Panel,
    lens: Lens,
    scene: &'a Arc<Scene>,
    pictures: paint::Pictures,
    /// Whether the map of the whole picture lies over it where it is not seen whole: over one of those that are looked at alike.
    has_map: bool,
}

/// Every picture in its place.
fn spots<'a>(ui: &Ui, area: Rect, panels: &[Panel], input: &Input<'a>, state: &mut State) -> Vec<Spot<'a>> {
    let size = input.pictures.pair[0].size();
    let Some(Lockstep { tiles, .. }) = input.lockstep else {
        let panes = split(area, panels.len(), size, bar::line_height(input.theme()));
        let aligned = |panel: &Panel| panel.picture().is_aligned_with(Picture::CURRENT);
        let first = panels.iter().position(aligned).unwrap_or(0);
        let pane = panes.get(first).copied().unwrap_or(area);
        let zoom = state.zooms_for(ui, &[input.scene], pane, input).first().copied().unwrap_or_default();
        let spot = |(i, (panel, pane)): (usize, (&Panel, Rect))| Spot {
            member: 0,
            panel: *panel,
            lens: Lens::new(pane, panel.frames(input.pictures)[0].size(), state.zoom_of(panel.picture(), zoom)),
            scene: input.scene,
            pictures: input.pictures.clone(),
            has_map: i == first || !aligned(panel),
        };
        return panels.iter().zip(panes).enumerate().map(spot).collect();
    };
    let view = view(input);
    let panes = lockstep::split(area, tiles.len(), size, lockstep::header(input.theme()));
    let scenes: Vec<&Scene> = tiles.iter().map(|tile| &*tile.scene).collect();
    let zooms = state.zooms_for(ui, &scenes, panes.first().copied().unwrap_or(area), input);
    let spot = |(member, (tile, pane)): (usize, (&'a Tile, Rect))| Spot {
        member,
        panel: panels.first().copied().unwrap_or(Panel::NEXT),
        lens: Lens::new(pane, size, zooms.get(member).copied().unwrap_or_default()),
        scene: &tile.scene,
        pictures: tile.pictures(input.pictures, input.look.level, view),
        has_map: true,
    };
    tiles.iter().zip(panes).enumerate().map(spot).collect()
}

/// The view that the pictures have. What blinks on the stage stands still in a picture.
fn view(input: &Input<'_>) -> View {
    let view = input.look.view_of(input.pictures, input.stands);
    if input.look.view == Some(View::Blink) { View::Blink } else { view }
}

fn panes(ui: &mut Ui, area: Rect, input: &Input<'_>, state: &mut State, response: &mut Response) {
    let time = ui.input(|i| i.time);
    if input.look.view == Some(View::Blink) {
        let rest = BLINK_SECS - time.rem_euclid(BLINK_SECS);
        ui.ctx().request_repaint_after_secs(rest as f32 + 0.005);
    }
    let panels = panels(view(input), input.pictures, time);
    ui.painter().rect_filled(area, 0.0, ink::color(input.theme().chrome().background));
    let (mut hovered, mut tips) = (None, Vec::new());
    let spots = spots(ui, area, &panels, input, state);
    let members = spots.last().map_or(1, |spot| spot.member + 1);
    state.glides.resize_with(members, Glide::default);
    state.pulses.resize_with(members, Pulse::default);
    for spot in &spots {
        state.glides[spot.member].follow(spot.scene, input.animate, time);
        state.pulses[spot.member].follow((input.cursor, spot.scene), input.animate, time);
    }
    if state.pulses.iter().any(|pulse| pulse.is_lit(time)) {
        ui.ctx().request_repaint_after_secs(pulse::FRAME_SECS);
    }
    if state.glides.iter().any(|glide| glide.is_moving(time)) {
        ui.ctx().request_repaint();
    }
    if input.flows && spots.iter().any(moves) {
        ui.ctx().request_repaint_after_secs(FLOW_SECS);
    }
    let aligned = |spot: &&Spot<'_>| spot.panel.picture().is_aligned_with(Picture::CURRENT);
    let shown = spots.iter().rev().find(aligned).or(spots.last()).map(|spot| spot.lens);
    if state.shown != shown {
        // The scale is told above the pictures, which were placed only now.
        state.shown = shown;
        ui.ctx().request_repaint();
    }
    for spot in &spots {
        let Spot { member, panel, lens, pictures, .. } = spot;
        lockstep::heading(ui, input, *member, lens, response);
        let pane = lens.pane;
        let id = ui.scope_id().with(("pane", *member, *panel));
        let sensed = ui.interact(pane, id, Sense::click_and_drag());
        sensed.widget_info(|| {
            let shown = Shown { panel: *panel, share: input.look.blend, gain: 1 };
            let title = pictures.title(shown, Some(input.frame), true);
            let of = input.lockstep.and_then(|all| all.tiles.get(*member));
            let of = of.map_or_else(String::new, |tile| format!(", {}", tile.names[0]));
            egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Stage: {title}{of}"))
        });
        let placing = input.placing.and_then(|placing| placing.on(panel.picture()));
        let is_gripped = match &placing {
            Some(placing) => placing::act(ui, &sensed, (lens, placing), state, response),
            None => pen::act(ui, &sensed, spot, (input, state), response),
        };
        if let Some(zoom) = looked(ui, &sensed, lens).filter(|_| !is_gripped) {
            state.set_zoom(panel.picture(), zoom);
            ui.ctx().request_repaint();
        }
        // Above the picture: what happens on the map is no click for a pixel.
        if let Some(zoom) = follow::act(ui, spot) {
            state.set_zoom(panel.picture(), zoom);
            ui.ctx().request_repaint();
        }
        if let Some(at) = sensed.hover_pos().filter(|_| input.presenting.hand == Hand::Explore) {
            hovered = lens.pixel_at(at).map(|pixel| Hovered { on: panel.picture(), pixel });
        }
        match input.lockstep {
            _ if matches!(input.presenting.hand, Hand::Draw(_)) => {}
            // The first click on another estimator is for its explanation; nothing moves under it.
            Some(all) if sensed.clicked() && all.explained != *member => response.explained = Some(*member),
            _ if placing.is_none() && sensed.clicked() => {
                let clicked = sensed.interact_pointer_pos().and_then(|at| lens.pixel_at(at));
                let clicked = clicked.map(|pixel| Hovered { on: panel.picture(), pixel });
                response.clicked = clicked.map(Hovered::focus);
            }
            _ => {}
        }
        tips.push(sensed);
    }
    state.hovered = hovered;
    for spot in &spots {
        paint(ui, spot, input, state);
    }
    for spots in spots.chunk_by(|a, b| a.member == b.member) {
        join(ui, spots, input, state);
    }
    loupe::show(ui, &spots, area, (input, state));
    for (sensed, spot) in tips.into_iter().zip(&spots) {
        pen::cursor(sensed, (&ui.painter_at(spot.lens.pane), input.theme()), input.presenting.hand);
    }
    response.hovered = hovered.map(Hovered::focus);
}

/// Whether particles move on a picture.
fn moves(spot: &Spot<'_>) -> bool {
    spot.panel.shows(Picture::CURRENT) && spot.pictures.streaks.as_ref().is_some_and(|streaks| !streaks.is_empty())
}

/// Divides `area` among `count` pictures of `size` with a `header` above each: side by side, or stacked where that
/// shows them much larger; four also in a square.
fn split(area: Rect, count: usize, size: (usize, usize), header: f32) -> Vec<Rect> {
    let head = vec2(0.0, header);
    let fit = |pane: Vec2| ((pane - head) / vec2(size.0 as f32, size.1 as f32)).min_elem();
    let n = count.max(1) as f32;
    let total = GAP * (n - 1.0);
    let beside = vec2((area.width() - total) / n, area.height());
    let stacked = vec2(area.width(), (area.height() - total) / n);
    let (pane, step) = if fit(stacked) > 1.3 * fit(beside) {
        (stacked, vec2(0.0, stacked.y + GAP))
    } else {
        (beside, vec2(beside.x + GAP, 0.0))
    };
    if count == 4 {
        let half = (area.size() - Vec2::splat(GAP)) / 2.0;
        if fit(half) > fit(pane) {
            let picture = (half - head).max(Vec2::splat(1.0));
            let corner = |i: usize| vec2((i % 2) as f32 * (half.x + GAP), (i / 2) as f32 * (half.y + GAP));
            return (0..count).map(|i| Rect::from_min_size(area.min + head + corner(i), picture)).collect();
        }
    }
    let picture = (pane - head).max(Vec2::splat(1.0));
    (0..count).map(|i| Rect::from_min_size(area.min + head + step * i as f32, picture)).collect()
}

/// The new zoom, if the person turned the wheel, pinched or dragged.
fn looked(ui: &Ui, sensed: &egui::Response, lens: &Lens) -> Option<Zoom> {
    if sensed.dragged() && sensed.drag_delta() != Vec2::ZERO {
        return Some(lens.panned(sensed.drag_delta()));
    }
    let cursor = sensed.hover_pos()?;
    let (wheel, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
    let factor = pinch * (wheel / 240.0).exp();
    (factor != 1.0).then(|| lens.zoomed(cursor, factor))
}

/// Draws a picture with everything over it and around it.
fn paint(ui: &Ui, spot: &Spot<'_>, input: &Input<'_>, state: &mut State) {
    let shown = paint_picture(ui, spot, input, state);
    let Spot { panel, ref lens, ref pictures, .. } = *spot;
    let painter = ui.painter_at(lens.pane);
    follow::paint(&painter, spot, shown.share, state);
    if let Some(layer) = pictures.layer.as_ref().filter(|_| panel.is_tinted() && !pixels::has_numbers(lens)) {
        motion::corner_wheel(&painter, spot, layer, (input.theme(), &mut state.wheel_corner));
    }
    if input.lockstep.is_none() {
        caption(ui.painter(), shown, lens, input);
    }
}

/// Draws a picture with its marks and its ink; gives how it is shown.
fn paint_picture(ui: &Ui, spot: &Spot<'_>, input: &Input<'_>, state: &mut State) -> Shown {
    let Spot { member, panel, ref lens, scene, ref pictures, .. } = *spot;
    let painter = ui.painter_at(lens.pane);
    let share = input.look.blend;
    let is_dimmed = input.look.backdrop == Backdrop::Dimmed
        && !pixels::has_numbers(lens)
        && paint::has_colors(panel, pictures, scene);
    let gain = state.pictures.paint(&painter, (panel, share), lens, pictures, is_dimmed);
    let shown = Shown { panel, share, gain };
    let of_frame_t = panel.shows(Picture::CURRENT);
    // Where numbers stand in the pixels, a layer of colours would hide them.
    if let Some(layer) = pictures.layer.as_ref().filter(|_| panel.is_tinted() && !pixels::has_numbers(lens)) {
        state.pictures.colors(&painter, layer, lens);
    }
    pixels::grid(&painter, lens);
    let on_panel = || scene.marks.iter().filter(|mark| panel.shows(mark.on));
    pixels::numbers(&painter, shown, lens, pictures, on_panel());
    let time = ui.input(|i| i.time);
    let moving = state.glides[member].marks(time);
    // A frame at the edge of the picture stays whole, all else ends with the picture.
    let marks = painter.with_clip_rect(lens.picture_rect().expand(BEYOND).intersect(lens.pane));
    state.pulses[member].paint(&marks, (panel, lens), input.theme(), time);
    state.marks.paint(&marks, ((member, panel), lens), scene, input, &moving);
    let scene_look = state.marks.look(input);
    pixels::costs(&marks, on_panel(), lens, &scene_look);
    if let Some(streaks) = pictures.streaks.as_ref().filter(|_| of_frame_t) {
        let phase = if input.flows { (time / LIFE_SECS).rem_euclid(1.0) as f32 } else { 0.0 };
        let place = Placement::new(lens.picture_rect().min.into(), lens.scale);
        let trails = paint::streaks(&streaks.at(phase), input.theme(), place);
        marks.extend(primitives::shapes(&marks, &[trails]));
    }
    if let Some(hovered) = state.hovered.filter(|hovered| hovered.on.is_aligned_with(panel.picture())) {
        pixels::cross_hair(&painter, lens, hovered.pixel);
    }
    if let Some(placing) = input.placing.and_then(|placing| placing.on(panel.picture())) {
        placing::paint(&painter, lens, &placing, input.theme());
    }
    pen::paint(&painter, spot, input, state);
    shown
}

/// Draws the lines between the pictures of an estimator.
fn join(ui: &Ui, spots: &[Spot<'_>], input: &Input<'_>, state: &mut State) {
    let Some(scene) = spots.first().map(|spot| spot.scene).filter(|scene| !scene.links.is_empty()) else { return };
    let look = state.marks.look(input);
    let site = |spot: &Spot<'_>| {
        let seen = spot.lens.picture_rect().intersect(spot.lens.pane);
        let pane = paint::primitive::Rect { min: seen.min.into(), max: seen.max.into() };
        let place = Placement::new(spot.lens.picture_rect().min.into(), spot.lens.scale);
        paint::LinkSite { panel: spot.panel, place, pane }
    };
    let sites: Vec<_> = spots.iter().map(site).collect();
    let painter = ui.painter();
    painter.extend(primitives::shapes(painter, &paint::links(scene, &look, &sites)));
}

/// The name of a picture, above it; without that of its file where there is no room.
fn caption(painter: &egui::Painter, shown: Shown, lens: &Lens, input: &Input<'_>) {
    let theme = input.theme();
    let font = ink::font(Face::Sans, theme.sizes().small);
    let corner = lens.picture_rect().min.max(lens.pane.min).min(lens.pane.center());
    let at = pos2(corner.x, corner.y - bar::line_height(theme) / 2.0);
    let dim = ink::color(theme.chrome().dim);
    let lay_out = |is_whole| {
        let title = input.pictures.title(shown, Some(input.frame), is_whole);
        painter.layout_no_wrap(title, font.clone(), dim)
    };
    let whole = lay_out(true);
    let fits = at.x + whole.size().x <= lens.pane.max.x;
    let title = if fits { whole } else { lay_out(false) };
    painter.galley(at - vec2(0.0, title.size().y / 2.0), title, dim);
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Pos2;
    use motionscope_core::scene::PictureRole;

    #[test]
    fn two_pictures_share_the_stage_without_overlap() {
        for area in [vec2(1200.0, 500.0), vec2(400.0, 900.0), vec2(9.0, 6.0)] {
            let area = Rect::from_min_size(pos2(10.0, 20.0), area);
            let panes = split(area, 2, (584, 388), 20.0);
            assert!(panes[0].min == area.min + vec2(0.0, 20.0) && !panes[0].intersects(panes[1]));
        }
        let wide = Rect::from_min_size(Pos2::ZERO, vec2(1200.0, 500.0));
        let tall = Rect::from_min_size(Pos2::ZERO, vec2(500.0, 900.0));
        let same_row = |area| split(area, 2, (584, 388), 20.0).windows(2).all(|w| w[0].min.y == w[1].min.y);
        assert!(same_row(wide) && !same_row(tall));
    }

    #[test]
    fn up_to_four_pictures_lie_in_the_stage_apart() {
        for (area, count) in [(vec2(900.0, 700.0), 3), (vec2(900.0, 700.0), 4), (vec2(1600.0, 200.0), 4)] {
            let area = Rect::from_min_size(pos2(10.0, 20.0), area);
            let panes = split(area, count, (320, 240), 20.0);
            assert!(panes.len() == count && panes.iter().all(|pane| area.contains_rect(*pane)), "{panes:?}");
            let apart = |(i, a): (usize, &Rect)| panes.iter().skip(i + 1).all(|b| !a.intersects(*b));
            assert!(panes.iter().enumerate().all(apart), "{panes:?}");
        }
    }

    #[test]
    fn pictures_of_other_pixels_are_zoomed_by_themselves() {
        let (mut state, near) = (State::default(), Zoom::At { center: [3.0, 4.0], scale: 9.0 });
        let template = Picture { role: PictureRole::Template, ..Picture::CURRENT };
        state.set_zoom(Picture::REFERENCE, near);
        assert_eq!(
            [Picture::CURRENT, Picture::NEXT, template].map(|p| state.zoom_of(p, state.zoom)),
            [near, near, Zoom::Fit]
        );
        state.set_zoom(template, Zoom::At { center: [1.0, 1.0], scale: 2.0 });
        assert_eq!(state.zoom_of(Picture::CURRENT, state.zoom), near);
        state.fit();
        assert_eq!([Picture::NEXT, template].map(|p| state.zoom_of(p, state.zoom)), [Zoom::Fit; 2]);
    }
}
