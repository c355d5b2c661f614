//! The stage: the two frames and the marks over them.
//!
//! [`show`] is a view: it draws what it is given and tells what the person points at. What is remembered is in
//! [`State`]; textures and shapes are kept there too, so that nothing is made twice.

mod bar;
mod follow;
mod glide;
mod landscape;
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
use motionscope_core::run::{Cursor, Pace};
use motionscope_core::scene::{Focus, Picture, Role, Scene, Step};

pub use lens::{Lens, Zoom};
pub use lockstep::Lockstep;
pub use pen::{Hand, Presenting};
pub use placing::{Gesture, Placing};

use crate::paint::charts::Orbit;
use crate::paint::{self, Backdrop, Face, FreehandLine, Panel, Placement, Shown, Theme, View};
use crate::ui::charts::surface3d::turn;
use crate::ui::commands::PenWish;
use crate::ui::drawing::{primitives, style};
use crate::ui::layout::{self, Panes};
use crate::ui::parts::widgets;
use crate::view::look::{Look, RunState};
use crate::view::motion::AvailableLayers;
use crate::view::tile::{self, Tile};
use follow::Follow;
use glide::Glide;
use landscape::Landscapes;
use marks::Marks;
use pictures::Pictures;
use pulse::Pulse;

/// How far marks may reach beyond their picture, in points.
const BEYOND: f32 = 2.0;
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
    /// What is told of the step, where an estimator is at work.
    pub step: Option<&'a Arc<Step>>,
    /// Whether untested candidates are hidden, as they are while questions are asked.
    pub hides_untested: bool,
    /// Several estimators, if there are.
    pub lockstep: Option<Lockstep<'a>>,
    /// The step that is shown.
    pub cursor: Cursor,
    /// Where the run stands, which decides the view where a look leaves it open.
    pub stands: RunState,
    /// How they look.
    pub look: Look,
    /// From where one looks at what rises from them.
    pub orbit: Orbit,
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
    /// Where the pictures lie.
    pub panes: &'a Panes,
    /// Whether the work is done in frame t + 1, which is the large picture then.
    pub is_search: bool,
}

impl<'a> Input<'a> {
    fn theme(&self) -> Theme {
        self.look.theme
    }

    /// What is told of the step of one of several estimators, or of the only one.
    fn step_of(&self, member: usize) -> Option<&'a Arc<Step>> {
        self.lockstep.and_then(|all| all.tiles.get(member)).map(|tile| &tile.step).or(self.step)
    }

    /// The names and steps of the estimators beside one of several.
    fn beside(&self, member: usize) -> Vec<(&'static str, &'a Arc<Step>)> {
        tile::beside(self.lockstep.map_or(&[][..], |all| all.tiles), member).collect()
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
    /// What rises from the pictures.
    landscapes: Landscapes,
    /// One for each estimator.
    glides: Vec<Glide>,
    pulses: Vec<Pulse>,
    /// Where the pictures lie, and the part of each that is seen.
    area: Option<Rect>,
    seen: Vec<Rect>,
    hovered: Option<Hovered>,
    /// How closely one looks at pictures whose pixels are not those of frame t.
    zooms: Vec<(Picture, Zoom)>,
    /// The pane that was shown last, for zooming without a pointer.
    shown: Option<Lens>,
    /// The picture that was chosen to be the large one, and all that have been on the stage with it.
    large: Option<Picture>,
    panels: Vec<Picture>,
    /// Which of them is the large one.
    large_at: usize,
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

    /// Where each picture is seen, in points of the window.
    pub fn pictures(&self) -> impl Iterator<Item = Rect> {
        self.seen.iter().copied()
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

    /// Which of the pictures is the large one where one is: the one that was chosen, the one that leans back, or the one in which
    /// candidates are tested.
    fn large_of(&self, input: &Input<'_>) -> usize {
        let place = |of: Picture| self.panels.iter().position(|picture| *picture == of);
        let usual = || input.is_search.then(|| place(Picture::NEXT)).flatten();
        let leaned = || self.landscapes.picture().and_then(place);
        self.large.and_then(place).or_else(leaned).or_else(usual).unwrap_or(0)
    }

    /// Lets the large picture be the usual one again.
    pub fn forget_large(&mut self) {
        self.large = None;
    }

    /// Makes the next picture the large one.
    pub fn next_picture(&mut self) {
        self.large = self.panels.get((self.large_at + 1) % self.panels.len().max(1)).copied();
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
    /// The displacement that was clicked in a landscape, in px.
    pub sought: Option<[i32; 2]>,
    /// Whether the first of them is to go on alone.
    pub left: bool,
    /// How the pictures are to look.
    pub look: Look,
    /// From where one looks at what rises from them.
    pub orbit: Orbit,
    /// What was placed on the picture.
    pub placed: Option<Placed>,
    /// What became of placing it.
    pub placing: Gesture,
    /// The line that was drawn by hand.
    pub drawn: Option<FreehandLine>,
    /// What is asked of the pen.
    pub pen: Option<PenWish>,
}

/// What decides which pictures are on the stage.
#[derive(Clone, Copy)]
pub struct OnStage<'a> {
    /// The frames, and what the run has made of them.
    pub pictures: &'a paint::Pictures,
    /// How they are looked at.
    pub look: Look,
    /// Where the run stands.
    pub stands: RunState,
    /// How many estimators share the stage; none if there is one.
    pub tiles: usize,
}

/// What the stage shows of `pictures`, as far as its layout follows from that.
pub fn pictures(input: OnStage<'_>, theme: Theme, line: f32) -> layout::Pictures {
    let OnStage { pictures, look, stands, tiles } = input;
    let view = view_of(look, pictures, stands);
    let is_lockstep = tiles > 0;
    let count = match (is_lockstep, view) {
        (true, _) => tiles,
        (false, View::Blink) => 1,
        (false, view) => view.panels(pictures).len().max(1),
    };
    let header = if is_lockstep { lockstep::header(theme) } else { style::line_height(theme) };
    layout::Pictures { count, size: pictures.pair[0].size(), is_lockstep, header, line }
}

/// Height of the line below the pictures, with tools in rows of `interact_pt` or without any.
pub fn line_height(theme: Theme, tools_pt: Option<f32>) -> f32 {
    tools_pt.map_or(0.0, |height| height + 2.0).max(style::line_height(theme))
}

/// Shows the pictures in their places, and below them in the whole of `ui` what they mean and what can be done with them.
pub fn show(ui: &mut Ui, input: Input<'_>, state: &mut State) -> Response {
    ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
    let mut response = Response { look: input.look, orbit: input.orbit, ..Response::default() };
    let tools_pt = (!input.presenting.is_bare).then_some(ui.spacing().interact_size.y);
    let stage = ui.max_rect().shrink(layout::MARGIN);
    let mut line = stage.with_min_y(stage.max.y - line_height(input.theme(), tools_pt));
    if tools_pt.is_some() {
        let tools = bar::tools(ui, line, &input, state, &mut response);
        line.max.x = tools.min.x - ui.spacing().item_spacing.x;
    }
    let input = Input { look: response.look, ..input };
    // Each of several estimators has its own level.
    let on_level = input.pictures.on_level(input.scene.levels.as_ref(), input.look.level, view(&input));
    let input = Input { pictures: &on_level, ..input };
    state.area = Some(stage.with_max_y(line.min.y));
    panes(ui, &input, state, &mut response);
    legend_line(ui, line, &input, state, &mut response);
    response
}

/// Shows the pictures and their legend alone, without tools, in the whole of `ui`.
pub fn show_plain(ui: &mut Ui, input: &Input<'_>, state: &mut State) {
    let mut response = Response { look: input.look, ..Response::default() };
    let stage = ui.max_rect().shrink(layout::MARGIN);
    let line = stage.with_min_y(stage.max.y - line_height(input.theme(), None));
    state.area = Some(stage.with_max_y(line.min.y));
    panes(ui, input, state, &mut response);
    legend_line(ui, line, input, state, &mut response);
}

/// What stands below the pictures: their legend, or what is being placed or drawn on them.
fn legend_line(ui: &mut Ui, line: Rect, input: &Input<'_>, state: &mut State, response: &mut Response) {
    let ui = &mut widgets::inside(ui, line, egui::Layout::left_to_right(egui::Align::Center));
    let in_legend = match (input.placing, input.presenting.hand) {
        (Some(_), _) => {
            placing::tools(ui, input, response);
            None
        }
        (None, Hand::Draw(color)) => {
            pen::tools(ui, input, color, response);
            None
        }
        (None, _) => bar::line(ui, input, state),
    };
    let in_list = input.panes.legend().and_then(|room| bar::list(ui, room, input, state));
    state.light(ui, in_legend.or(in_list));
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
    /// Its scale where all of it is seen, of that of the picture that the view follows.
    share: f32,
    /// Whether it stands beside a large one.
    is_small: bool,
}

/// Every picture in its place.
fn spots<'a>(ui: &Ui, panels: &[Panel], input: &Input<'a>, state: &mut State) -> Vec<Spot<'a>> {
    let size = input.pictures.pair[0].size();
    let Some(Lockstep { tiles, .. }) = input.lockstep else {
        state.panels = panels.iter().map(|panel| panel.picture()).collect();
        let large = state.large_of(input);
        state.large_at = large;
        let panes = input.panes.of(large);
        let aligned = |panel: &Panel| panel.picture().is_aligned_with(Picture::CURRENT);
        // The view follows the work in the large picture, or else in the first.
        let first = panels.get(large).filter(|panel| input.panes.has_large() && aligned(panel)).map(|_| large);
        let first = first.or(panels.iter().position(aligned)).unwrap_or(0);
        let pane = panes.get(first).copied().unwrap_or(Rect::ZERO);
        let zoom = state.zooms_for(ui, &[input.scene], pane, input).first().copied().unwrap_or_default();
        let spot = |(i, (panel, pane_of)): (usize, (&Panel, Rect))| {
            let size = panel.frames(input.pictures)[0].size();
            let of_large = Lens::new(pane, size, Zoom::Fit).scale;
            let share = if i == first { 1.0 } else { Lens::new(pane_of, size, Zoom::Fit).scale / of_large };
            Spot {
                member: 0,
                panel: *panel,
                lens: Lens::new(pane_of, size, state.zoom_of(panel.picture(), zoom).times(share)),
                scene: input.scene,
                pictures: input.pictures.clone(),
                has_map: i == first || !aligned(panel) && !input.panes.has_large(),
                share,
                is_small: input.panes.has_large() && i != large,
            }
        };
        return panels.iter().zip(panes).enumerate().map(spot).collect();
    };
    let view = view(input);
    let panes = input.panes.of(0);
    let scenes: Vec<&Scene> = tiles.iter().map(|tile| &*tile.scene).collect();
    let zooms = state.zooms_for(ui, &scenes, panes.first().copied().unwrap_or(Rect::ZERO), input);
    let spot = |(member, (tile, pane)): (usize, (&'a Tile, Rect))| Spot {
        member,
        panel: panels.first().copied().unwrap_or(Panel::NEXT),
        lens: Lens::new(pane, size, zooms.get(member).copied().unwrap_or_default()),
        scene: &tile.scene,
        pictures: tile.pictures(input.pictures, input.look.level, view),
        has_map: true,
        share: 1.0,
        is_small: false,
    };
    tiles.iter().zip(panes).enumerate().map(spot).collect()
}

/// The view that the pictures have. What blinks on the stage stands still in a picture.
fn view(input: &Input<'_>) -> View {
    view_of(input.look, input.pictures, input.stands)
}

fn view_of(look: Look, pictures: &paint::Pictures, stands: RunState) -> View {
    let view = look.view_of(pictures, stands);
    if look.view == Some(View::Blink) { View::Blink } else { view }
}

fn panes(ui: &mut Ui, input: &Input<'_>, state: &mut State, response: &mut Response) {
    let time = ui.input(|i| i.time);
    if input.look.view == Some(View::Blink) {
        let rest = BLINK_SECS - time.rem_euclid(BLINK_SECS);
        ui.ctx().request_repaint_after_secs(rest as f32 + 0.005);
    }
    let panels = panels(view(input), input.pictures, time);
    let (mut hovered, mut tips) = (None, Vec::new());
    let spots = spots(ui, &panels, input, state);
    let chrome = input.theme().chrome();
    for spot in spots.iter().filter(|_| chrome.background != chrome.panel) {
        ui.painter().rect_filled(spot.lens.pane, 0.0, style::color(chrome.background));
    }
    let members = spots.last().map_or(1, |spot| spot.member + 1);
    state.glides.resize_with(members, Glide::default);
    state.pulses.resize_with(members, Pulse::default);
    for spot in &spots {
        state.glides[spot.member].follow(spot.scene, input.animate, time);
        state.pulses[spot.member].follow((input.cursor, spot.scene), input.animate, time);
    }
    for spots in spots.chunk_by(|a, b| a.member == b.member) {
        state.landscapes.follow(ui, spots, input);
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
    let aligned = |spot: &&Spot<'_>| !spot.is_small && spot.panel.picture().is_aligned_with(Picture::CURRENT);
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
        if state.landscapes.leans(spot) {
            match input.lockstep {
                Some(all) if sensed.clicked() && all.explained != *member => response.explained = Some(*member),
                _ => response.sought = state.landscapes.clicked(spot, &sensed, input.orbit).or(response.sought),
            }
            turn(ui, &sensed, &mut response.orbit, Orbit::default());
            tips.push(sensed);
            continue;
        }
        let placing = input.placing.and_then(|placing| placing.on(panel.picture()));
        let is_gripped = match &placing {
            Some(placing) => placing::act(ui, &sensed, (lens, placing), state, response),
            None => pen::act(ui, &sensed, spot, (input, state), response),
        };
        if let Some(zoom) = looked(ui, &sensed, lens).filter(|_| !is_gripped) {
            state.set_zoom(panel.picture(), zoom.times(1.0 / spot.share));
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
            // A small one comes forward; nothing moves under it.
            _ if spot.is_small && placing.is_none() && sensed.clicked() => {
                state.large = Some(panel.picture());
                ui.ctx().request_repaint();
            }
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
    state.seen = spots.iter().map(|spot| spot.lens.picture_rect().intersect(spot.lens.pane)).collect();
    for spot in &spots {
        paint(ui, spot, input, state);
    }
    for spots in spots.chunk_by(|a, b| a.member == b.member) {
        if spots.iter().any(|spot| state.landscapes.leans(spot)) {
            continue;
        }
        join(ui, spots, input, state);
    }
    loupe::show(ui, &spots, state.area(), (input, state));
    for (sensed, spot) in tips.into_iter().zip(&spots) {
        pen::cursor(sensed, (&ui.painter_at(spot.lens.pane), input.theme()), input.presenting.hand);
    }
    response.hovered = hovered.map(Hovered::focus);
}

/// Whether particles move on a picture.
fn moves(spot: &Spot<'_>) -> bool {
    spot.panel.shows(Picture::CURRENT) && spot.pictures.streaks.as_ref().is_some_and(|streaks| !streaks.is_empty())
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
    if state.landscapes.leans(spot) {
        landscape::paint(ui, spot, input, state);
        let shown = Shown { panel: spot.panel, share: input.look.blend, gain: 1 };
        return if input.lockstep.is_none() {
            caption(ui.painter(), shown, &spot.lens, input)
        };
    }
    let shown = paint_picture(ui, spot, input, state);
    let Spot { panel, ref lens, ref pictures, .. } = *spot;
    let painter = ui.painter_at(lens.pane);
    follow::paint(&painter, spot, shown.share, state);
    if let Some(layer) =
        pictures.layer.as_ref().filter(|_| panel.is_tinted() && !spot.is_small && !pixels::has_numbers(lens))
    {
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
    let marks = painter.with_clip_rect(lens.picture_rect().intersect(lens.pane).expand(BEYOND));
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
    // They stay on the pictures: between a large one and a small one there are words.
    for spot in spots {
        let painter = ui.painter().with_clip_rect(spot.lens.pane.expand(2.0));
        painter.extend(primitives::shapes(&painter, &paint::links(scene, &look, &sites)));
    }
}

/// The name of a picture, above it; without that of its file where there is no room.
fn caption(painter: &egui::Painter, shown: Shown, lens: &Lens, input: &Input<'_>) {
    let theme = input.theme();
    let font = style::font(Face::Sans, theme.sizes().small);
    let corner = lens.picture_rect().min.max(lens.pane.min).min(lens.pane.center());
    let at = pos2(corner.x, corner.y - style::line_height(theme) / 2.0);
    let dim = style::color(theme.chrome().dim);
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
    use motionscope_core::scene::PictureRole;

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
