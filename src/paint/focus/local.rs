//! The part of a search window in which a search has tested.
//!
//! A fast search tests a few displacements near the block: in a view of the whole window its candidates would lie upon each other.

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Picture, Role, Scene, Shape};

use super::{Rect, around, bounds_at_work};

/// Displacements in px on each side of the block that are shown: few steps, so that the view seldom changes.
const REACHES: [f32; 2] = [5.0, 9.0];

/// How far from the first displacement is shown where a search has gone as far as `reach` px in a window of `size` displacements;
/// `None` where that is no small part of the window.
fn reach_shown(reach: f32, size: [f32; 2]) -> Option<f32> {
    let is_small = |half: &f32| reach < *half && 3.0 * (2.0 * half + 1.0) <= 2.0 * size[0].min(size[1]);
    REACHES.into_iter().find(is_small)
}

/// The reference block with the displacements that are tested and the next ones, where that is a small part of the search window.
///
/// The window itself is shown for a search that begins in a corner of it, and before the first test.
pub fn tested_part(scene: &Scene) -> Option<Rect> {
    let [block, window] = block_and_window(scene)?;
    let tested = costs(scene).and_then(|(origin, costs)| tested_bounds(origin, costs))?;
    let center = [0, 1].map(|i| (block.min[i] + block.max[i]) / 2.0);
    let displaced = |bounds: Rect| [0, 1].map(|i| (center[i] - bounds.min[i]).max(bounds.max[i] - center[i]));
    let candidates = scene.marks.iter().filter(|mark| mark.on == Picture::NEXT && mark.role != Role::Window);
    let reach = candidates.filter_map(|mark| match &mark.shape {
        Shape::Points(points) => around(points.iter().copied()).map(displaced),
        // A candidate is as large as the block.
        Shape::Rect { .. } => bounds_at_work(mark).map(|at| [0, 1].map(|i| (at.min[i] - block.min[i]).abs())),
        _ => None,
    });
    let reach = reach.chain([displaced(tested)]).flatten().fold(0.0, f32::max);
    let displacements = [0, 1].map(|i| (window.max[i] - window.min[i]) - (block.max[i] - block.min[i]) + 1.0);
    reach_shown(reach, displacements).map(|half| block.grown(half))
}

/// The reference block of a search that has tested nothing yet.
pub fn untested_block(scene: &Scene) -> Option<Rect> {
    let [block, _] = block_and_window(scene)?;
    costs(scene).is_none().then_some(block)
}

/// The block of frame t and its search window in frame t + 1, where a step has both.
fn block_and_window(scene: &Scene) -> Option<[Rect; 2]> {
    let rect = |on: Picture, role: Role| {
        scene.marks.iter().filter(|mark| (mark.on, mark.role) == (on, role)).find_map(|mark| match mark.shape {
            Shape::Rect { min, max } => Some(Rect::between(min, max)),
            _ => None,
        })
    };
    // A window that both frames have is no search window.
    let window = rect(Picture::NEXT, Role::Window).filter(|_| rect(Picture::CURRENT, Role::Window).is_none())?;
    Some([rect(Picture::CURRENT, Role::Reference)?, window])
}

/// The costs by displacement that are drawn over frame t + 1.
fn costs(scene: &Scene) -> Option<([f32; 2], &Grid<f32>)> {
    scene.marks.iter().find_map(|mark| match &mark.shape {
        Shape::Heat { origin, values } if mark.on == Picture::NEXT => Some((*origin, values)),
        _ => None,
    })
}

/// The middles of the first and last cell with a cost; `None` without one and for a raster, whose first cost is in the corner.
fn tested_bounds(origin: [f32; 2], costs: &Grid<f32>) -> Option<Rect> {
    let (width, height) = costs.size();
    if costs.get(0, 0).is_none_or(|corner| corner.is_finite()) {
        return None;
    }
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let tested = places.filter(|place| costs[*place].is_finite());
    around(tested.map(|(x, y)| [origin[0] + x as f32, origin[1] + y as f32]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of 16×16 px at (100, 80) with a window of ±`range` px and these tested displacements.
    fn search(range: i32, tested: &[[i32; 2]]) -> Scene {
        let mut scene = Scene::default();
        let side = (2 * range + 1) as usize;
        let has_cost = |x: usize, y: usize| tested.contains(&[x as i32 - range, y as i32 - range]);
        let values = Grid::from_fn(side, side, |x, y| if has_cost(x, y) { 7.0 } else { f32::NAN });
        let origin = [107.5 - range as f32, 87.5 - range as f32];
        scene.mark(Picture::CURRENT, Role::Reference, Shape::pixels(100, 80, 16, 16));
        if !tested.is_empty() {
            scene.mark(Picture::NEXT, Role::Candidate, Shape::Heat { origin, values });
        }
        let (corner, reach) = ([100 - range, 80 - range], 16 + 2 * range as usize);
        scene.mark(Picture::NEXT, Role::Window, Shape::pixels(corner[0], corner[1], reach, reach));
        scene
    }

    fn reach_of(scene: &Scene) -> Option<f32> {
        tested_part(scene).map(|part| 99.5 - part.min[0])
    }

    #[test]
    fn the_part_grows_in_steps_with_what_is_tested() {
        assert_eq!(reach_of(&search(16, &[[0, 0], [0, -2]])), Some(5.0));
        assert_eq!(reach_of(&search(16, &[[0, 0], [-6, 0]])), Some(9.0));
        assert_eq!(reach_of(&search(16, &[[0, 0], [0, 10]])), None, "the window");
        assert_eq!(reach_of(&search(7, &[[0, 0], [0, -2]])), None, "a small window is shown whole");
        assert_eq!(reach_of(&search(16, &[[-16, -16], [0, 0]])), None, "a raster begins in a corner");
        assert_eq!(reach_of(&search(16, &[])), None);
    }

    #[test]
    fn next_candidates_and_the_candidate_under_test_are_part_of_it() {
        let mut next = search(16, &[[0, 0]]);
        next.mark(Picture::NEXT, Role::Predicted, Shape::Points(vec![[107.5, 80.5]]));
        assert_eq!(reach_of(&next), Some(9.0), "7 px above");
        let mut candidate = search(16, &[[0, 0]]);
        candidate.mark(Picture::NEXT, Role::Candidate, Shape::pixels(106, 80, 16, 16));
        assert_eq!(reach_of(&candidate), Some(9.0), "6 px to the right");
    }

    #[test]
    fn before_the_first_test_the_block_alone_must_be_seen() {
        assert_eq!(untested_block(&search(16, &[])), Some(Rect::new([99.5, 79.5], [16.0; 2])));
        assert_eq!(untested_block(&search(16, &[[0, 0]])), None);
        let mut both = search(16, &[]);
        both.mark(Picture::CURRENT, Role::Window, Shape::pixels(96, 76, 24, 24));
        assert_eq!(untested_block(&both), None, "frame t has the window too");
    }
}
