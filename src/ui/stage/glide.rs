//! A step's motion: rectangles that moved glide to their new place, and nothing else moves.

use std::sync::Arc;

use motionscope_core::scene::{Mark, Picture, Role, Scene, Shape};

/// How long a step moves, in seconds.
const SECS: f64 = 0.16;

/// Rectangles on their way from one scene to the next.
#[derive(Clone, Default)]
pub struct Glide {
    scene: Option<Arc<Scene>>,
    began: f64,
    moves: Vec<Move>,
}

/// A rectangle of the scene that moves, by its place among the marks.
#[derive(Clone, Debug, PartialEq)]
struct Move {
    index: usize,
    from: [[f32; 2]; 2],
    to: [[f32; 2]; 2],
}

impl Glide {
    /// Starts a move when `scene` is a new one.
    pub fn follow(&mut self, scene: &Arc<Scene>, animate: bool, time: f64) {
        if self.scene.as_ref().is_some_and(|old| Arc::ptr_eq(old, scene)) {
            return;
        }
        let shown = self.shown(time);
        self.moves = if animate { moves(&shown, scene) } else { Vec::new() };
        self.scene = Some(scene.clone());
        self.began = time;
    }

    /// Whether anything moves at `time`.
    pub fn is_moving(&self, time: f64) -> bool {
        !self.moves.is_empty() && time < self.began + SECS
    }

    /// The marks on their way at `time`, by their place in the scene.
    pub fn marks(&self, time: f64) -> Vec<(usize, Mark)> {
        let Some(scene) = self.scene.as_ref().filter(|_| self.is_moving(time)) else { return Vec::new() };
        let left = (1.0 - (time - self.began) / SECS).clamp(0.0, 1.0) as f32;
        let done = 1.0 - left.powi(3);
        let between = |m: &Move, corner: usize| {
            std::array::from_fn(|i| m.from[corner][i] + (m.to[corner][i] - m.from[corner][i]) * done)
        };
        let at = |m: &Move| {
            let mark = scene.marks.get(m.index)?;
            let shape = Shape::Rect { min: between(m, 0), max: between(m, 1) };
            Some((m.index, Mark { shape, ..mark.clone() }))
        };
        self.moves.iter().filter_map(at).collect()
    }

    /// Where every rectangle is seen at `time`.
    fn shown(&self, time: f64) -> Vec<(Picture, Role, [[f32; 2]; 2])> {
        let Some(scene) = &self.scene else { return Vec::new() };
        let moving = self.marks(time);
        let seen = |(i, mark): (usize, &Mark)| {
            let mark = moving.iter().find(|(index, _)| *index == i).map_or(mark, |(_, mark)| mark);
            rect(mark).map(|rect| (mark.on, mark.role, rect))
        };
        scene.marks.iter().enumerate().filter_map(seen).collect()
    }
}

fn rect(mark: &Mark) -> Option<[[f32; 2]; 2]> {
    match mark.shape {
        Shape::Rect { min, max } => Some([min, max]),
        _ => None,
    }
}

/// The rectangles of `scene` that are the only one of their role on their picture, now and before, and moved.
fn moves(before: &[(Picture, Role, [[f32; 2]; 2])], scene: &Scene) -> Vec<Move> {
    let count = |on: Picture, role: Role| {
        scene.marks.iter().filter(|mark| mark.on == on && mark.role == role && rect(mark).is_some()).count()
    };
    let moved = |(index, mark): (usize, &Mark)| {
        let to = rect(mark)?;
        let mut old = before.iter().filter(|(on, role, _)| *on == mark.on && *role == mark.role);
        let (_, _, from) = *old.next()?;
        let alone = old.next().is_none() && count(mark.on, mark.role) == 1;
        (alone && from != to).then_some(Move { index, from, to })
    };
    scene.marks.iter().enumerate().filter_map(moved).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(x: i32) -> Arc<Scene> {
        let mut scene = Scene::default();
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(8, 8, 4, 4));
        scene.mark(Picture::NEXT, Role::Candidate, Shape::pixels(x, 0, 4, 4));
        Arc::new(scene)
    }

    fn left(glide: &Glide, time: f64) -> Option<f32> {
        glide.marks(time).first().and_then(|(_, mark)| rect(mark)).map(|[min, _]| min[0])
    }

    #[test]
    fn what_moved_glides_and_arrives() {
        let mut glide = Glide::default();
        glide.follow(&scene(0), true, 0.0);
        assert!(!glide.is_moving(0.0), "the first scene is simply there");
        glide.follow(&scene(10), true, 1.0);
        assert_eq!(glide.marks(1.0).len(), 1, "the block did not move");
        assert_eq!(left(&glide, 1.0), Some(-0.5));
        let half = left(&glide, 1.0 + SECS / 2.0).expect("on its way");
        assert!(half > 4.5 && half < 9.5, "{half}");
        assert!(!glide.is_moving(1.0 + SECS) && glide.marks(1.0 + SECS).is_empty());
    }

    #[test]
    fn a_new_step_starts_from_what_is_seen() {
        let mut glide = Glide::default();
        glide.follow(&scene(0), true, 0.0);
        glide.follow(&scene(10), true, 1.0);
        let half = left(&glide, 1.0 + SECS / 2.0);
        glide.follow(&scene(20), true, 1.0 + SECS / 2.0);
        assert_eq!(left(&glide, 1.0 + SECS / 2.0), half);
        glide.follow(&scene(0), false, 2.0);
        assert!(!glide.is_moving(2.0), "scrubbing is still");
    }
}
