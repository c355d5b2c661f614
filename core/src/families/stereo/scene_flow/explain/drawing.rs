//! The drawing of scene flow: maps on the pictures, a pixel in all four of them, the inliers of a sample.

use std::sync::Arc;

use super::super::{Depths, Event, Part, SceneFlow, Source};
use super::{Shown, length};
use crate::geometry::Grid;
use crate::methods::scene_flow::{Draw, Ego};
use crate::products::SceneFlowField;
use crate::run::Seen;
use crate::scene::{Arrow, Canvas, Link, Picture, Role, Scene, Shape, Viewpoint};

/// The right view of frame t + 1.
const RIGHT_NEXT: Picture = Picture { viewpoint: Viewpoint::Right, ..Picture::NEXT };

impl SceneFlow {
    pub(in super::super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        let is_stereo = seen.before.fixed.depths == Depths::Stereo;
        let Some(event) = seen.events.last() else {
            scene.pictures = pictures(is_stereo);
            return;
        };
        let shown = self.shown(seen);
        let map = |scene: &mut Scene, values: Grid<f32>, on: Picture, meaning: &'static str, unit: &'static str| {
            scene.draw(on, (Role::Result, meaning), Shape::heat(values));
            scene.heat = Some(unit);
        };
        match event {
            Event::Whole(Part::Disparity) => {
                scene.pictures = views(is_stereo, Picture::CURRENT, Picture::RIGHT);
                map(scene, shown.field.disparity.0.clone(), Picture::CURRENT, "disparity in px", "disparity (px)");
            }
            Event::Whole(Part::NextDisparity) => {
                let values = state.next.as_ref().map(|next| next.0.clone());
                let on = if self.source == Source::Truth { Picture::CURRENT } else { Picture::NEXT };
                scene.pictures = views(is_stereo, on, RIGHT_NEXT);
                if let Some(values) = values {
                    map(scene, values, on, "disparity in frame t+1, in px", "disparity (px)");
                }
                return;
            }
            Event::Whole(_) => {
                scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::of_clip(Picture::NEXT)];
                scene.draw(
                    Picture::CURRENT,
                    (Role::Result, "flow to frame t+1"),
                    Shape::Flow { origin: [0.0; 2], values: shown.field.flow.0.clone() },
                );
            }
            Event::Row(Part::Positions, y) => {
                // A pixel pointed at is shown in all four pictures.
                scene.pictures = pictures(is_stereo && seen.point().is_some());
                let is_done = |pixel: (usize, usize)| seen.after.is_some() || pixel.1 <= *y as usize;
                let field = &shown.field;
                let depth = |pixel| field.position(pixel).map(|at| at[2]).filter(|_| is_done(pixel));
                if field.calibration.is_some() {
                    map(scene, field.grid(depth), Picture::CURRENT, "depth in m", "depth (m)");
                    // A distant background leaves room for differences nearby.
                    scene.heat_scale = field.typical_depth_m().map(|depth| [0.0, 2.0 * depth as f32]);
                }
            }
            Event::Row(..) | Event::Opened(_) => {
                scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::of_clip(Picture::NEXT)];
                draw_own(scene, &shown.field, if let Event::Row(_, y) = event { *y as usize } else { usize::MAX });
                if seen.after.is_some() && seen.point().is_none() {
                    scene.is_overview = true;
                    return;
                }
            }
            Event::Draw(draw) => {
                scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::of_clip(Picture::NEXT)];
                self.draw_sample(scene, seen, draw);
                return;
            }
            Event::NoEgo => {
                scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::of_clip(Picture::NEXT)];
                return;
            }
        }
        draw_pixel(scene, &shown);
    }

    /// The points of the sample, and which of all agree with its motion.
    fn draw_sample(&self, scene: &mut Scene, seen: &Seen<Self>, draw: &Draw) {
        let field = self.field(seen.before);
        let (Some(rig), points) = (field.calibration, self.ego_points(&field)) else { return };
        let pose = if draw.sample.is_some() { draw.fit } else { draw.best }.map(|fit| fit.pose);
        let ego = Ego::new(&rig, &points, &self.ego);
        let inliers = pose.map(|pose| ego.inliers(&pose)).unwrap_or_default();
        let (mut agreeing, mut others) = (Vec::new(), Vec::new());
        for (index, point) in points.iter().enumerate() {
            let (from, to) = (point.pixel.map(|c| c as f32), point.next_pixel().map(|c| c as f32));
            let part = if inliers.binary_search(&index).is_ok() { &mut agreeing } else { &mut others };
            part.push(Arrow { from, to });
        }
        scene.draw(Picture::CURRENT, (Role::Rejected, "outlier"), Shape::Arrows(others));
        scene.draw(Picture::CURRENT, (Role::Best, "inlier, with its flow"), Shape::Arrows(agreeing));
        let sample: Vec<_> = draw.sample.into_iter().flatten().filter_map(|index| points.get(index as usize)).collect();
        for point in sample {
            let [from, to] = [point.pixel, point.next_pixel()].map(|at| at.map(|c| c as f32));
            let ring = |center| Shape::circle(center, 5.0);
            scene.mark(Picture::CURRENT, Role::Reference, ring(from));
            scene.mark(Picture::NEXT, Role::Reference, ring(to));
            scene.links.push(Link { role: Role::Reference, ends: [(Picture::CURRENT, from), (Picture::NEXT, to)] });
            scene.legend(Role::Reference, "point of the sample");
        }
        scene.is_overview = true;
    }
}

fn pictures(is_stereo: bool) -> Vec<Canvas> {
    let all: &[Picture] = match is_stereo {
        true => &[Picture::CURRENT, Picture::RIGHT, Picture::NEXT, RIGHT_NEXT],
        false => &[Picture::CURRENT, Picture::NEXT],
    };
    all.iter().copied().map(Canvas::of_clip).collect()
}

/// A view, and if there are two the other one.
fn views(is_stereo: bool, left: Picture, right: Picture) -> Vec<Canvas> {
    [left].into_iter().chain(is_stereo.then_some(right)).map(Canvas::of_clip).collect()
}

/// Marks the pixel in each of the pictures that are shown.
fn draw_pixel(scene: &mut Scene, shown: &Shown) {
    let (x, y) = (shown.pixel.0 as f32, shown.pixel.1 as f32);
    let ring = |center| Shape::circle(center, 4.0);
    let mut places = vec![(Picture::CURRENT, Role::Reference, [x, y])];
    let disparity = shown.field.disparity.at(shown.pixel.0, shown.pixel.1);
    places.extend(disparity.map(|d| (Picture::RIGHT, Role::Best, [x - d, y])));
    if let Some([u, v]) = shown.field.flow.at(shown.pixel.0, shown.pixel.1) {
        let to = [x + u, y + v];
        places.push((Picture::NEXT, Role::Measured, to));
        let next = shown.field.next_disparity.at(shown.pixel.0, shown.pixel.1);
        places.extend(next.map(|d| (RIGHT_NEXT, Role::Measured, [to[0] - d, to[1]])));
    }
    let is_there = |scene: &Scene, picture: Picture| scene.pictures.iter().any(|canvas| canvas.picture == picture);
    for (picture, role, at) in places {
        if is_there(scene, picture) {
            scene.mark(picture, role, ring(at));
            let meaning = match role {
                Role::Reference => "pixel",
                Role::Best => "its match in the right view",
                _ => "its place in frame t+1",
            };
            scene.legend(role, meaning);
        }
    }
}

/// The length of the remaining motion, and the pixels with a motion of their own.
fn draw_own(scene: &mut Scene, field: &SceneFlowField, last_row: usize) {
    let Some(ego) = field.ego else { return };
    if let Some(moving) = &field.moving {
        scene.draw(Picture::CURRENT, (Role::Result, "motion of its own"), Shape::Mask(Arc::clone(moving)));
        return;
    }
    let is_done = |pixel: &(usize, usize)| pixel.1 <= last_row;
    let remaining = |pixel| {
        let motion = Some(pixel).filter(is_done).and_then(|pixel| field.motion(pixel))?;
        Some(length(motion.own(&ego.pose)))
    };
    scene.draw(
        Picture::CURRENT,
        (Role::Error, "length of the remaining motion in m"),
        Shape::heat(field.grid(remaining)),
    );
    scene.heat = Some("remaining motion (m)");
    scene.heat_scale = Some([0.0, 0.5]);
}
