//! The view moves to the work of a step, and from there to that of the next.

use eframe::egui::{self, Painter, Rect, Sense, Ui, vec2};
use motionscope_core::run::Cursor;
use motionscope_core::scene::Scene;

use super::{Input, Lens, Spot, State, Zoom};
use crate::paint::focus::{self, Site};
use crate::paint::{CloseUp, FocusMode, Share, Work, focus_frames, primitive};
use crate::ui::drawing::primitives;

/// How long the view moves, in seconds.
const SECS: f64 = 0.25;

/// What is seen of a picture: the point in the middle, and points per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Framing {
    center: [f32; 2],
    scale: f32,
}

/// The view on its way from one part of a picture to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Transition {
    from: Framing,
    to: Framing,
    began: f64,
}

impl Transition {
    /// What is seen at `time`: magnified evenly, however far it goes.
    fn at(&self, time: f64) -> Framing {
        let left = (1.0 - (time - self.began) / SECS).clamp(0.0, 1.0) as f32;
        let done = 1.0 - left.powi(3);
        let scale = self.from.scale * (self.to.scale / self.from.scale).powf(done);
        // The middle moves as the scale does, so that the part looked at grows out of its place.
        let share = match self.to.scale - self.from.scale {
            off if off.abs() > 1e-3 * self.to.scale => {
                (1.0 / self.from.scale - 1.0 / scale) / (1.0 / self.from.scale - 1.0 / self.to.scale)
            }
            _ => done,
        };
        Framing {
            center: [0, 1].map(|i| self.from.center[i] + (self.to.center[i] - self.from.center[i]) * share),
            scale,
        }
    }

    fn is_moving(&self, time: f64) -> bool {
        self.from != self.to && time < self.began + SECS
    }
}

/// Which step was followed last, and how.
#[derive(Clone, Debug, PartialEq)]
struct Followed {
    cursor: Cursor,
    mode: FocusMode,
    size: (usize, usize),
    pane: egui::Vec2,
    close_ups: Vec<Option<CloseUp>>,
}

/// Where the view is, for each of several estimators.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Follow {
    last: Option<Followed>,
    ways: Vec<Transition>,
    /// Whether the whole picture was chosen by hand.
    is_paused: bool,
    /// Whether something else of the step is seen than before, so that the view is not held under the pointer.
    is_anew: bool,
}

impl Follow {
    /// The whole picture stays until focus is asked for again.
    pub fn pause(&mut self) {
        self.is_paused = true;
    }

    /// The view follows the work again.
    pub fn resume(&mut self) {
        self.is_paused = false;
    }

    /// Whether the whole picture was chosen by hand.
    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// The view goes where the scene has it, even under the pointer: something else of the step is seen.
    pub fn look_anew(&mut self) {
        self.is_anew = true;
    }

    /// Whether a part is shown magnified.
    fn is_close(&self) -> bool {
        !self.is_paused && self.last.as_ref().is_some_and(|last| last.close_ups.iter().any(Option::is_some))
    }

    /// Whether the view moves at `time`.
    fn is_moving(&self, time: f64) -> bool {
        self.ways.iter().any(|way| way.is_moving(time))
    }

    /// Aims at `close_ups` in `pane`, and gives how closely each picture is looked at.
    fn aim(&mut self, next: Followed, animate: bool, time: f64) -> Vec<Zoom> {
        let lens = Lens::new(Rect::from_min_size(egui::Pos2::ZERO, next.pane), next.size, Zoom::Fit);
        let whole = Framing { center: lens.center.into(), scale: lens.scale };
        let framing = |close: &Option<CloseUp>| match close {
            Some(CloseUp { center, times }) => Framing { center: *center, scale: lens.scale * times },
            None => whole,
        };
        let is_same_pane = self.last.as_ref().is_some_and(|last| (last.pane, last.size) == (next.pane, next.size));
        let moves = animate && is_same_pane && self.ways.len() == next.close_ups.len();
        let targets: Vec<Framing> = next.close_ups.iter().map(framing).collect();
        let ways = targets.iter().enumerate().map(|(i, &to)| match self.ways.get(i) {
            Some(way) if is_same_pane && way.to == to => *way,
            Some(way) if moves => Transition { from: way.at(time), to, began: time },
            _ => Transition { from: to, to, began: time },
        });
        self.ways = ways.collect();
        self.last = Some(next);
        let zoom = |way: &Transition| match way.at(time) {
            framing if framing == whole => Zoom::Fit,
            Framing { center, scale } => Zoom::At { center, scale },
        };
        self.ways.iter().map(zoom).collect()
    }
}

impl State {
    /// Looks at the work of what is seen now, although the step stays.
    pub fn look_anew(&mut self) {
        self.follow.look_anew();
    }

    /// Follows the work of each step again.
    pub fn follow_again(&mut self) {
        self.zoom = Zoom::Fit;
        self.zooms.clear();
        self.follow.resume();
    }

    /// Focus on the work, or no longer: what becomes of the mode that is chosen.
    pub fn toggle_focus(&mut self, mode: FocusMode) -> FocusMode {
        let is_by_hand = self.zoom != Zoom::Fit || self.follow.is_paused;
        let is_close = !is_by_hand && self.follow.is_close();
        self.follow_again();
        match mode {
            // On and auto differ in where the work is large: what was close goes, what was not comes.
            FocusMode::Off => FocusMode::Auto,
            mode if is_by_hand => mode,
            _ if is_close => FocusMode::Off,
            _ => FocusMode::On,
        }
    }

    /// How closely the pictures with the marks of `scenes` are looked at, the first of them in `pane`.
    pub(super) fn zooms_for(&mut self, ui: &Ui, scenes: &[&Scene], pane: Rect, input: &Input<'_>) -> Vec<Zoom> {
        let time = ui.input(|i| i.time);
        let mode = input.look.focus;
        if self.follow.last.as_ref().is_some_and(|last| last.mode != mode) {
            // Chosen anew, it counts again.
            self.follow_again();
        }
        let size = input.pictures.pair[0].size();
        let is_by_hand = self.zoom != Zoom::Fit || self.follow.is_paused;
        let last = self.follow.last.take();
        // In another pane there is another room.
        let is_same_pane = |last: &&Followed| (last.pane, last.size) == (pane.size(), size);
        let before = last.as_ref().filter(is_same_pane).map_or(&[][..], |last| &last.close_ups);
        // Under the pointer another pixel is explained: the view must not run after it.
        let is_held = !std::mem::take(&mut self.follow.is_anew)
            && self.hovered.is_some()
            && before.len() == scenes.len()
            && last.as_ref().is_some_and(|last| (last.cursor, last.mode) == (input.cursor, mode));
        let close_ups = if input.placing.is_some() {
            // What is placed may lie anywhere, and must not move away under the mouse.
            vec![None; scenes.len()]
        } else if is_by_hand || is_held {
            before.to_vec()
        } else {
            let works: Vec<_> = scenes.iter().map(|scene| Work::of(scene, size)).collect();
            let fit = Lens::new(pane, size, Zoom::Fit).scale;
            let room = (pane.size() / fit).into();
            let is_same_unit = last.as_ref().is_some_and(|last| last.cursor.unit == input.cursor.unit);
            CloseUp::of(mode, &works, Site { size, room, at_end: input.stands.at_end, before, is_same_unit })
        };
        let next = Followed { cursor: input.cursor, mode, size, pane: pane.size(), close_ups };
        self.follow.last = last;
        if is_by_hand {
            self.follow.last = Some(Followed { close_ups: vec![None; scenes.len()], ..next });
            // From where the person looks, the view goes on when it follows again.
            self.follow.ways.clear();
            return vec![self.zoom; scenes.len()];
        }
        let zooms = self.follow.aim(next, input.animate, time);
        if self.follow.is_moving(time) {
            ui.ctx().request_repaint();
        }
        zooms
    }
}

/// Where the work of the step is on the screen.
pub fn work_rect(spot: &Spot<'_>) -> Option<Rect> {
    let picture = spot.lens.picture;
    let bounds = Work::of(spot.scene, (picture.x as usize, picture.y as usize))?.bounds;
    Some(Rect::from_min_max(spot.lens.to_screen(bounds.min), spot.lens.to_screen(bounds.max)))
}

/// Where the map of the whole picture lies over a picture that is not seen whole.
pub fn map_rect(spot: &Spot<'_>) -> Option<Rect> {
    let Lens { pane, picture, .. } = spot.lens;
    let whole = spot.lens.picture_rect();
    let is_whole = pane.expand(1.0).contains_rect(whole);
    if is_whole || !spot.has_map {
        return None;
    }
    let work = work_rect(spot).map(|work| primitive::Rect { min: work.min.into(), max: work.max.into() });
    let shown = pane.intersect(whole);
    let shown = primitive::Rect { min: shown.min.into(), max: shown.max.into() };
    let map = focus::map_rect(shown, picture.into(), work)?;
    Some(Rect::from_min_max(map.min.into(), map.max.into()))
}

/// What the person does on the map of a picture: a click or a drag moves what is seen there.
pub fn act(ui: &Ui, spot: &Spot<'_>) -> Option<Zoom> {
    let map = map_rect(spot)?;
    let id = ui.scope_id().with(("map", spot.member, spot.panel));
    let sensed = ui.interact(map, id, Sense::click_and_drag()).on_hover_cursor(egui::CursorIcon::PointingHand);
    sensed.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Map of the whole picture"));
    let sensed = sensed.on_hover_text("The whole picture, with the visible part framed. Click to move there.");
    let at = sensed.interact_pointer_pos().filter(|_| sensed.clicked() || sensed.dragged())?;
    let share = (at - map.min) / map.size();
    let center = [share.x * spot.lens.picture.x - 0.5, share.y * spot.lens.picture.y - 0.5];
    Some(Lens { center: center.into(), ..spot.lens }.at_scale(spot.lens.scale))
}

/// Paints the map.
pub fn paint(painter: &Painter, spot: &Spot<'_>, share: Share, state: &mut State) {
    let Some(map) = map_rect(spot) else { return };
    let picture = spot.lens.picture;
    let middle = (picture - vec2(1.0, 1.0)) / 2.0;
    let lens = Lens { pane: map, picture, scale: map.width() / picture.x, center: middle.to_pos2() };
    state.pictures.paint(painter, (spot.panel, share), &lens, &spot.pictures, false);
    let at = |point: egui::Pos2| -> [f32; 2] { lens.to_screen(spot.lens.to_image(point)).into() };
    let seen = primitive::Rect { min: at(spot.lens.pane.min), max: at(spot.lens.pane.max) };
    let whole = primitive::Rect { min: map.min.into(), max: map.max.into() };
    painter.extend(primitives::shapes(painter, &focus_frames(whole, seen)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn followed(center: [f32; 2], times: f32) -> Followed {
        Followed {
            cursor: Cursor::default(),
            mode: FocusMode::Auto,
            size: (320, 240),
            pane: vec2(640.0, 480.0),
            close_ups: vec![Some(CloseUp { center, times })],
        }
    }

    fn center(zoom: &[Zoom]) -> [f32; 2] {
        let [Zoom::At { center, .. }] = zoom else { panic!("{zoom:?}") };
        *center
    }

    #[test]
    fn the_view_moves_smoothly_and_arrives() {
        let mut follow = Follow::default();
        assert_eq!(
            center(&follow.aim(followed([50.0, 60.0], 4.0), true, 0.0)),
            [50.0, 60.0],
            "the first is simply there"
        );
        let start = follow.aim(followed([90.0, 60.0], 4.0), true, 1.0);
        assert_eq!(center(&start), [50.0, 60.0]);
        let half = center(&follow.aim(followed([90.0, 60.0], 4.0), true, 1.0 + SECS / 2.0))[0];
        assert!(half > 60.0 && half < 90.0 && follow.is_moving(1.0 + SECS / 2.0), "{half}");
        assert_eq!(center(&follow.aim(followed([90.0, 60.0], 4.0), true, 1.0 + SECS)), [90.0, 60.0]);
        assert!(!follow.is_moving(1.0 + SECS) && SECS <= 0.25);
    }

    #[test]
    fn with_less_motion_the_view_is_there_at_once() {
        let mut follow = Follow::default();
        follow.aim(followed([50.0, 60.0], 4.0), false, 0.0);
        assert_eq!(center(&follow.aim(followed([90.0, 60.0], 2.0), false, 1.0)), [90.0, 60.0]);
        assert!(!follow.is_moving(1.0));
        let whole = follow.aim(Followed { close_ups: vec![None], ..followed([0.0; 2], 1.0) }, false, 2.0);
        assert_eq!(whole, [Zoom::Fit], "the whole picture fits, whatever becomes of the pane");
    }

    #[test]
    fn the_key_turns_focus_on_and_off_and_ends_what_was_chosen_by_hand() {
        let mut state = State::default();
        state.follow.aim(followed([50.0, 60.0], 4.0), false, 0.0);
        assert_eq!(state.toggle_focus(FocusMode::Auto), FocusMode::Off, "it is close already");
        assert_eq!(state.toggle_focus(FocusMode::Off), FocusMode::Auto, "what was chosen by default comes back");
        state.fit();
        assert!(state.follow.is_paused, "the whole picture was chosen by hand");
        assert_eq!(state.toggle_focus(FocusMode::Auto), FocusMode::Auto);
        assert!(!state.follow.is_paused);
        state.zoom = Zoom::At { center: [3.0, 4.0], scale: 9.0 };
        assert_eq!((state.toggle_focus(FocusMode::On), state.zoom), (FocusMode::On, Zoom::Fit));
    }
}
