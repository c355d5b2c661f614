//! The landscapes, tiles and marks of the template tracker.

use super::template::{Pyramid, outline};
use super::{End, Event, Iteration, Judged, LEAST_OVERLAP, Template, TemplateTracker};
use crate::geometry::{Bounds, Grid, Sampling, polygon};
use crate::methods::alignment::explain::{compared, errors};
use crate::methods::region::At;
use crate::products::model::{Matrix3, inverse, mapped};
use crate::scene::{Picture, PlaneCost, Role, Scene, Series, Shape, Surface, Tile};

/// The landscapes of a template reach this far to each side, in px of the level.
const REACH_PX: f32 = 6.0;

impl TemplateTracker {
    /// The RMS difference where the warp of an iteration is shifted, with the path of the iterations of its level.
    pub(super) fn valley(&self, at: &At<'_, Self>, iteration: &Iteration) -> Surface {
        let (level, image) = (&iteration.template.levels[iteration.level], &iteration.frame[iteration.level]);
        let aligner = level.aligner(self.warp.group());
        let error = |warp: &Matrix3| {
            let compared = aligner.compare(&level.hessian, image, &level.on_level(warp));
            (compared.rms, compared.overlap)
        };
        let before = at.events.iter().filter_map(|event| match event {
            Event::Iterated(other) if other.is_part_of(iteration) => Some(position(&other.before)),
            _ => None,
        });
        let mut path: Vec<_> = before.collect();
        let undone = path.len().checked_sub(2).filter(|_| iteration.end == Some(End::Worse)).map(|last| path[last]);
        path.extend(iteration.moved.as_ref().map(|moved| position(&moved.after)).or(undone));
        let first = path.first().copied().unwrap_or_else(|| position(&iteration.before));
        let reach = REACH_PX * (1u32 << iteration.level) as f32;
        let names = ("RMS difference", "gray levels");
        shifted(names, &iteration.before, first, reach, level.pixels.cells().len(), error).with_trail(path)
    }

    /// The correlation where the warp of an alignment is shifted, with the contour below which the object is lost.
    pub(super) fn correlations(&self, judged: &Judged) -> Surface {
        let level = &judged.template.levels[0];
        let (place, each) = (position(&judged.warp), level.pixels.cells().len());
        let correlation = |warp: &Matrix3| level.correlation(&judged.frame[0], warp);
        let surface = shifted(("ρ", ""), &judged.warp, place, REACH_PX, each, correlation);
        Surface { is_similarity: true, best: Some([0; 2]), contour: Some(self.min_correlation), ..surface }
    }
}

impl Iteration {
    /// Whether it belongs to the same level of the same alignment.
    fn is_part_of(&self, other: &Self) -> bool {
        (self.is_correction, self.level) == (other.is_correction, other.level)
    }
}

/// The position to which a warp maps the middle of the template, in px of the picture.
fn position(warp: &Matrix3) -> [f32; 2] {
    [warp[0][2] as f32, warp[1][2] as f32]
}

/// A value of a template of `each` pixels under a warp that is shifted: the middle of the template lies up to `reach` px from
/// `center`. `value` gives it with the share inside the frame; it is missing where that is too small.
fn shifted(
    names: (&'static str, &'static str),
    warp: &Matrix3,
    center: [f32; 2],
    reach: f32,
    each: usize,
    value: impl Fn(&Matrix3) -> (f64, f64),
) -> Surface {
    let from = position(warp);
    let at = |place: [f32; 2]| {
        let mut warp = *warp;
        (0..2).for_each(|i| warp[i][2] += f64::from(place[i] - from[i]));
        let (value, overlap) = value(&warp);
        if overlap < LEAST_OVERLAP { f32::NAN } else { value as f32 }
    };
    Surface::sampled_over_picture(names, (Picture::CURRENT, center, reach), PlaneCost::cells(each), at)
}

/// A template on a level of the frame, the warped window, and their difference.
pub fn tiles(
    label: &'static str,
    (frame, template): (&Pyramid, &Template),
    (level, warp): (usize, &Matrix3),
) -> Vec<Tile> {
    let of_level = &template.levels[level];
    compared(label, [&of_level.pixels, &frame[level]], &of_level.on_level(warp))
}

pub fn template_tile(label: &'static str, template: &Template) -> Tile {
    Tile::gray(label, template.levels[0].pixels.clone()).with_role(Role::Reference)
}

/// The errors of all iterations of the frame so far.
pub fn errors_of(at: &At<'_, TemplateTracker>) -> Option<Series> {
    let of = |(i, event): (usize, &&Event)| match event {
        Event::Iterated(iteration) => Some((i + 1, iteration.clone())),
        _ => None,
    };
    let all: Vec<_> = at.events.iter().enumerate().filter_map(of).collect();
    let section = |iteration: &Iteration| match iteration.is_correction {
        true => "drift correction".to_owned(),
        false => format!("level {}", iteration.level),
    };
    let series = errors(all.iter().map(|(_, iteration)| (section(iteration), iteration.compared.rms)))?;
    Some(Series { events: all.iter().map(|(event, _)| *event).collect(), ..series })
}

/// Draws the outline of a template under a warp.
pub fn path(scene: &mut Scene, (role, meaning): (Role, &'static str), (warp, size): (&Matrix3, (usize, usize))) {
    scene.draw(Picture::CURRENT, (role, meaning), Shape::outline(outline(warp, size)));
}

/// Draws the absolute difference of frame and warped template.
pub fn heat(scene: &mut Scene, (frame, template): (&Pyramid, &Template), (level, warp): (usize, &Matrix3)) {
    let (of_level, image, (width, height)) = (&template.levels[level], &frame[level], frame[0].size());
    let Some(back) = inverse(&of_level.on_level(warp)) else { return };
    let corners: Vec<_> = outline(warp, template.size()).into_iter().map(|at| at.map(f64::from)).collect();
    let Some(Bounds { min, max }) = polygon::bounds(&corners) else { return };
    let first = min.map(|c| c.ceil().max(0.0) as usize);
    let end = [0, 1].map(|i| ((max[i].floor() + 1.0).max(0.0) as usize).min([width, height][i]));
    if (0..2).any(|i| first[i] >= end[i]) {
        return;
    }
    let scale = f64::from(1u32 << level);
    let values = Grid::from_fn(end[0] - first[0], end[1] - first[1], |x, y| {
        let at = [(first[0] + x) as f64 / scale, (first[1] + y) as f64 / scale];
        let Some([u, v]) = mapped(&back, at) else { return f32::NAN };
        let [x, y] = at.map(|c| c as f32);
        (Sampling::Bilinear.sample_inside(&of_level.pixels, u as f32, v as f32) - image.sample(x, y)).abs()
    });
    scene.draw(
        Picture::CURRENT,
        (Role::Error, "absolute difference after warping"),
        Shape::Heat { origin: first.map(|c| c as f32), values },
    );
    scene.heat = Some("gray levels");
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::data::Frame;
    use crate::methods::region::RegionModel as _;
    use crate::products::Region;

    /// A texture of waves, shifted.
    fn frame([dx, dy]: [f32; 2]) -> Arc<Frame> {
        let wave = |x: usize, y: usize| {
            let (x, y) = (x as f32 - dx, y as f32 - dy);
            (128.0 + 50.0 * (x / 5.0).sin() * (y / 6.0).cos() + 40.0 * ((x + 2.0 * y) / 9.0).sin()) as u8
        };
        Arc::new(Frame::gray(Grid::from_fn(90, 80, wave)))
    }

    #[test]
    fn the_landscapes_have_the_values_of_the_alignment() {
        let tracker = TemplateTracker::default();
        let region = Region { center: [44.0, 40.0], size: [31.0, 25.0], angle_rad: 0.0 };
        let (mut model, _) = tracker.begin(&frame([0.0; 2]), region, &mut ());
        let (before, mut events) = (model.clone(), Vec::<Event>::new());
        tracker.follow(&mut model, &frame([2.3, -1.4]), region, &mut events);
        let (mut levels, mut judged) = (0, 0);
        for (i, event) in events.iter().enumerate() {
            let all = events[..=i].iter().collect();
            let at = At { model: Some(&before), region, events: all, event, pose: None, poses: Box::new(|_| None) };
            match event {
                Event::Iterated(iteration) => {
                    let surface = tracker.valley(&at, iteration);
                    assert_eq!(surface.trail.len(), iteration.number + 1);
                    // The first warp of a level stands in the middle of a cell.
                    if iteration.number == 1 {
                        assert_eq!(surface.interpolated(surface.trail[0]), Some(iteration.compared.rms as f32));
                        levels += 1;
                    }
                    let [from, to] = [surface.trail[0], surface.trail[iteration.number]];
                    let is_far = (to[0] - from[0]).hypot(to[1] - from[1]) > 1.0;
                    let [high, low] = [from, to].map(|at| surface.interpolated(at));
                    assert!(!is_far || iteration.end.is_none() || low < high, "{high:?} to {low:?}");
                }
                Event::Judged(alignment) => {
                    let surface = tracker.correlations(alignment);
                    assert_eq!(surface.interpolated([0.0; 2]), Some(alignment.correlation as f32));
                    assert_eq!(surface.optimum().map(|(_, at)| at), Some(vec![[0; 2]]));
                    judged += 1;
                }
                _ => {}
            }
        }
        assert!(levels > 2 && judged == 1, "{levels} levels, {judged} judged");
    }
}
