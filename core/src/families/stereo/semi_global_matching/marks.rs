//! The marks of semi-global matching, and its cut through the volume of costs as a picture.

use std::sync::Arc;

use super::charts::SLICE;
use super::shown::Shown;
use super::{SemiGlobalMatching, Stage};
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::stereo::{BITS, draw_map, draw_match, smallest};
use crate::run::Seen;
use crate::scene::{Canvas, Picture, Role, Scene, Shape};

impl SemiGlobalMatching {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        scene.pictures = seen.before.fixed.views.canvases();
        let meaning = if state.kept.is_empty() { "disparity of least cost so far, in px" } else { "disparity in px" };
        draw_map(scene, state.map(), self.settings.disparities, meaning);
        let Some(shown) = self.shown(seen) else { return };
        let (x, y) = shown.pixel;
        let slice = self.slice(&shown);
        scene.pictures.push(Canvas::made(SLICE, move || Frame::gray(Grid::clone(&slice))).along(y));
        let index = y * seen.before.fixed.views.size().0 + x;
        let kept = state.kept.get(index);
        let best = match &state.sums[..] {
            [] => smallest(&self.single_costs(&shown)).at as f32,
            _ => smallest(&shown.sums(self)).at as f32,
        };
        let is_kept = kept.is_none_or(|kept| kept.disparity.is_finite());
        let at = kept.map(|kept| kept.disparity).filter(|d| d.is_finite()).unwrap_or(best);
        draw_match(scene, &self.pair(&shown), at, is_kept);
        let column = vec![[x as f32, -0.5], [x as f32, self.last(x) as f32 + 0.5]];
        scene.mark(SLICE, Role::Window, Shape::line(column));
        scene.draw(SLICE, (Role::Best, "match"), Shape::Points(vec![[x as f32, best]]));
        if let Stage::Path(direction) = shown.stage {
            let from = shown.path(self, direction).from;
            let points = vec![[from.0 as f32, from.1 as f32], [x as f32, y as f32]];
            scene.draw(Picture::CURRENT, (Role::Predicted, "path to the pixel"), Shape::line(points));
        }
    }

    /// The cut through the volume along the row of the pixel: x to the right, d down, low costs bright.
    fn slice(&self, shown: &Shown) -> Arc<Grid<u8>> {
        let (values, paths) = self.row(shown);
        let most = BITS.max(paths * (BITS + u32::from(self.penalties()[1])) / 2);
        Arc::new(values.map(|value| 255 - (255 * (*value).min(most) / most) as u8))
    }
}
