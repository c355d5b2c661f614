//! What a step has changed on the pictures is lit for a moment.

use std::sync::Arc;

use eframe::egui::{Painter, Pos2, Shape as EguiShape, Stroke};
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Arrow, Picture, Scene, Shape};

use super::Lens;
use crate::paint::{Panel, Theme};
use crate::ui::drawing::style;

/// How long a change is lit, in seconds.
const SECS: f64 = 0.7;
/// How often it is drawn anew, in seconds.
pub const FRAME_SECS: f32 = 1.0 / 30.0;
/// Most lines and points that are lit: where more are new, everything is, and nothing stands out.
const MOST: usize = 40;
/// Width of the light at its beginning and at its end, in points.
const WIDTHS: [f32; 2] = [14.0, 6.0];
/// Strength of the light at its beginning.
const STRENGTH: f32 = 0.7;
/// Corners by which an ellipse is drawn.
const CORNERS: u16 = 48;

/// The changes of the last step.
#[derive(Clone, Default)]
pub struct Pulse {
    shown: Option<(Cursor, Arc<Scene>)>,
    began: f64,
    changed: Vec<Outline>,
}

/// A line, or a point, on a picture.
#[derive(Clone, Debug, PartialEq)]
struct Outline {
    on: Picture,
    points: Vec<[f32; 2]>,
    is_closed: bool,
}

impl Pulse {
    /// Starts to light what differs from the scene before, when `scene` is that of a neighbouring step. Another pixel that is
    /// explained is no change.
    pub fn follow(&mut self, (cursor, scene): (Cursor, &Arc<Scene>), animate: bool, time: f64) {
        if self.shown.as_ref().is_some_and(|(at, old)| *at == cursor && Arc::ptr_eq(old, scene)) {
            return;
        }
        let before = self.shown.replace((cursor, Arc::clone(scene)));
        let is_next = |at: &Cursor| *at != cursor && at.unit.abs_diff(cursor.unit) <= 1;
        let before = before.filter(|(at, _)| animate && is_next(at));
        (self.changed, self.began) = (before.map_or_else(Vec::new, |(_, before)| changes(&before, scene)), time);
    }

    /// Whether anything is lit at `time`.
    pub fn is_lit(&self, time: f64) -> bool {
        !self.changed.is_empty() && time < self.began + SECS
    }

    /// Paints the light on a picture, below its marks.
    pub fn paint(&self, painter: &Painter, (panel, lens): (Panel, &Lens), theme: Theme, time: f64) {
        if !self.is_lit(time) {
            return;
        }
        let left = (1.0 - (time - self.began) / SECS).clamp(0.0, 1.0) as f32;
        let width = WIDTHS[1] + (WIDTHS[0] - WIDTHS[1]) * left;
        let color = style::color(theme.chrome().accent).gamma_multiply(STRENGTH * left);
        for outline in self.changed.iter().filter(|outline| panel.shows(outline.on)) {
            let mut points: Vec<Pos2> = outline.points.iter().map(|point| lens.to_screen(*point)).collect();
            painter.add(match (&points[..], outline.is_closed) {
                ([point], _) => EguiShape::circle_filled(*point, width, color),
                (_, true) => EguiShape::closed_line(std::mem::take(&mut points), Stroke::new(width, color)),
                (_, false) => EguiShape::line(std::mem::take(&mut points), Stroke::new(width, color)),
            });
        }
    }
}

/// The lines and points of `now` that `before` has not; none where there are too many to stand out.
fn changes(before: &Scene, now: &Scene) -> Vec<Outline> {
    let mut changed = Vec::new();
    for mark in now.marks.iter().filter(|mark| has_lines(&mark.shape)) {
        let mut like = before.marks.iter().filter(|old| (old.on, old.role, old.of) == (mark.on, mark.role, mark.of));
        if like.clone().any(|old| old.shape == mark.shape) {
            continue;
        }
        let line = |points: Vec<[f32; 2]>, is_closed| Outline { on: mark.on, points, is_closed };
        match &mark.shape {
            Shape::Rect { min: [left, top], max: [right, bottom] } => {
                let corners = vec![[*left, *top], [*right, *top], [*right, *bottom], [*left, *bottom]];
                changed.push(line(corners, true));
            }
            Shape::Ellipse { center, radii, angle_rad } => {
                changed.push(line(ellipse(*center, *radii, *angle_rad), true));
            }
            Shape::Path { points, closed } => changed.push(line(points.clone(), *closed)),
            Shape::Points(points) => {
                let old = like.find_map(|old| if let Shape::Points(old) = &old.shape { Some(&old[..]) } else { None });
                let new = beyond(points, old.unwrap_or_default());
                changed.extend(new.iter().take(MOST + 1).map(|point| line(vec![*point], false)));
            }
            Shape::Arrows(arrows) => {
                let old = like.find_map(|old| if let Shape::Arrows(old) = &old.shape { Some(&old[..]) } else { None });
                let new = beyond(arrows, old.unwrap_or_default());
                changed.extend(new.iter().take(MOST + 1).map(|Arrow { from, to }| line(vec![*from, *to], false)));
            }
            Shape::Text { .. } | Shape::Heat { .. } | Shape::Flow { .. } | Shape::Mask(_) | Shape::Labels(_) => {}
        }
        if changed.len() > MOST {
            return Vec::new();
        }
    }
    changed
}

/// Whether a shape is made of lines or points. Colours of all pixels are not even compared.
fn has_lines(shape: &Shape) -> bool {
    !shape.is_layer() && !matches!(shape, Shape::Flow { .. } | Shape::Text { .. })
}

/// What is left of `now` without its beginning and its end in common with `before`.
fn beyond<'a, T: PartialEq>(now: &'a [T], before: &[T]) -> &'a [T] {
    let start = now.iter().zip(before).take_while(|(now, old)| now == old).count();
    let (now, before) = (&now[start..], &before[start..]);
    let end = now.iter().rev().zip(before.iter().rev()).take_while(|(now, old)| now == old).count();
    &now[..now.len() - end]
}

fn ellipse([x, y]: [f32; 2], [long, short]: [f32; 2], angle_rad: f32) -> Vec<[f32; 2]> {
    let (sin, cos) = angle_rad.sin_cos();
    let corner = |i: u16| {
        let (b, a) = (f32::from(i) / f32::from(CORNERS) * std::f32::consts::TAU).sin_cos();
        [x + long * a * cos - short * b * sin, y + long * a * sin + short * b * cos]
    };
    (0..CORNERS).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::Role;

    use super::*;

    fn at(event: usize) -> Cursor {
        Cursor { unit: 3, event }
    }

    fn scene(candidate: i32, points: &[[f32; 2]]) -> Arc<Scene> {
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(8, 8, 4, 4));
        scene.mark(Picture::NEXT, Role::Candidate, Shape::pixels(candidate, 0, 4, 4));
        scene.mark(Picture::CURRENT, Role::Result, Shape::Points(points.to_vec()));
        Arc::new(scene)
    }

    #[test]
    fn what_is_new_is_lit_for_a_moment() {
        let mut pulse = Pulse::default();
        pulse.follow((at(1), &scene(0, &[[1.0, 2.0]])), true, 0.0);
        assert!(!pulse.is_lit(0.0), "the first scene is simply there");
        pulse.follow((at(2), &scene(5, &[[1.0, 2.0], [3.0, 4.0]])), true, 1.0);
        assert!(pulse.is_lit(1.0 + SECS / 2.0) && !pulse.is_lit(1.0 + SECS));
        let [candidate, point] = &pulse.changed[..] else { panic!("{:?}", pulse.changed) };
        assert!(candidate.on == Picture::NEXT && candidate.is_closed);
        assert_eq!(point.points, [[3.0, 4.0]], "the point that was there before is not new");
        pulse.follow((at(2), &scene(9, &[])), true, 1.1);
        assert!(!pulse.is_lit(1.2), "another pixel is explained, at the same step");
        pulse.follow((Cursor { unit: 9, event: 1 }, &scene(5, &[])), true, 2.0);
        assert!(!pulse.is_lit(2.0), "the step is elsewhere in the run");
    }

    #[test]
    fn nothing_is_lit_where_everything_is_new_or_steps_run_on() {
        let many = |from: usize| (0..MOST + 1).map(|i| [(from + i) as f32, 0.0]).collect::<Vec<_>>();
        let mut pulse = Pulse::default();
        pulse.follow((at(1), &scene(0, &many(0))), true, 0.0);
        pulse.follow((at(2), &scene(5, &many(500))), true, 1.0);
        assert!(!pulse.is_lit(1.0), "{:?}", pulse.changed.len());
        pulse.follow((at(3), &scene(6, &many(500))), false, 2.0);
        assert!(!pulse.is_lit(2.0), "while the run plays");
    }
}
