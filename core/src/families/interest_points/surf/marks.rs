//! The marks of SURF.

use super::hessian::{Layer, Weighted};
use super::probe::{Described, Filtered, Probe, Searched};
use super::{Event, Maximum, State, Surf};
use crate::geometry::Grid;
use crate::methods::features::draw_keypoints;
use crate::methods::features::haar::{Blob, SECTOR_RAD, SIDE, WHEEL_REACH, dominant, sector_start, subregion_corners};
use crate::methods::features::integral::PixelBox;
use crate::run::Seen;
use crate::scene::{Picture, Role, Scene, Shape};

impl Surf {
    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.before;
        if let Some(done) = seen.after.filter(|after| after.is_described()) {
            return draw_keypoints(&done.features(), scene);
        }
        match self.probe(seen) {
            None => {}
            Some(Probe::Integral) => {
                let (width, height) = state.picture.size();
                draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
                scene.legend(Role::Window, "summed area");
            }
            Some(Probe::Filter(of)) => draw_filter(state, &of, scene),
            Some(Probe::Search(of)) => draw_search(seen, &of, scene),
            Some(Probe::Choice(maxima)) => draw_choice(seen, maxima, scene),
            Some(Probe::Keypoint(of)) => draw_keypoint(seen, &of, scene),
        }
    }
}

fn draw_box(scene: &mut Scene, PixelBox { min, max }: PixelBox, role: Role) {
    let size = [max[0] - min[0], max[1] - min[1]].map(|side| side as usize);
    scene.mark(Picture::CURRENT, role, Shape::pixels(min[0], min[1], size[0], size[1]));
}

/// Draws the boxes of a filter, the corners of the first, and in the end the responses of the layer.
fn draw_filter(state: &State, of: &Filtered<'_>, scene: &mut Scene) {
    if of.part >= 3 {
        draw_responses(state, of.layer, scene);
    }
    let Some(sample) = of.sample else {
        let (width, height) = state.picture.size();
        draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
        scene.legend(Role::Window, "filtered picture");
        return;
    };
    let at = of.layer.pixel(sample);
    let side = of.layer.filter.size;
    let half = side as i32 / 2;
    scene.draw(
        Picture::CURRENT,
        (Role::Window, "filter of side L"),
        Shape::pixels(at.0 as i32 - half, at.1 as i32 - half, side, side),
    );
    if let Some(boxes) = of.layer.filter.boxes(at).get(of.part) {
        for (of_box, weight) in boxes {
            let (role, meaning) = match weight {
                1.. => (Role::Best, "box of weight 1"),
                -1 => (Role::Error, "box of weight −1"),
                _ => (Role::Error, "box of weight −2"),
            };
            draw_box(scene, *of_box, role);
            scene.legend(role, meaning);
        }
        draw_corners(boxes, scene);
    }
    scene.draw(Picture::CURRENT, (Role::Reference, "inspected pixel"), Shape::pixels(at.0 as i32, at.1 as i32, 1, 1));
}

/// Draws the corners of the first box, at which the integral image is read.
fn draw_corners(boxes: &[Weighted], scene: &mut Scene) {
    let Some((PixelBox { min, max }, _)) = boxes.first() else { return };
    let edge = |c: i32| c as f32 - 0.5;
    let corners =
        [[min[0], min[1]], [max[0], min[1]], [min[0], max[1]], [max[0], max[1]]].map(|corner| corner.map(edge));
    scene.draw(Picture::CURRENT, (Role::Result, "corners read for the first box"), Shape::Points(corners.to_vec()));
    for (at, name) in corners.into_iter().zip(["A", "B", "C", "D"]) {
        scene.mark(Picture::CURRENT, Role::Result, Shape::Text { at, text: name.into() });
    }
}

fn draw_responses(state: &State, layer: &Layer, scene: &mut Scene) {
    let (width, height) = state.picture.size();
    let value = |x: usize, y: usize| {
        let response = layer.responses[(x / layer.step, y / layer.step)];
        if response > 0.0 { response.sqrt() } else { f32::NAN }
    };
    let values = Grid::from_fn(width, height, value);
    if values.cells().iter().any(|value| value.is_finite()) {
        scene.mark(Picture::CURRENT, Role::Candidate, Shape::heat(values));
        scene.heat = Some("√R");
    }
}

/// The circle of a blob: its radius is that of a disc with the largest response at its scale.
fn circle(Blob { at, scale }: Blob) -> Shape {
    Shape::circle(at, scale * std::f32::consts::SQRT_2)
}

fn draw_search(seen: &Seen<Surf>, of: &Searched<'_>, scene: &mut Scene) {
    let [_, here, _] = of.layers;
    draw_responses(seen.before, here, scene);
    let at = |sample: (usize, usize)| {
        let (x, y) = here.pixel(sample);
        [x as f32, y as f32]
    };
    let samples = |is_maximum: bool| {
        let compared = seen.events.iter().filter_map(move |event| match event {
            Event::Compared(sample, by) if by.is_none() == is_maximum => Some(*sample),
            _ => None,
        });
        compared.map(at).collect::<Vec<_>>()
    };
    for (role, meaning, points) in [
        (Role::Rejected, "suppressed (non-maximum)", samples(false)),
        (Role::Best, "maximum over position and scale", samples(true)),
    ] {
        if !points.is_empty() {
            scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(points));
        }
    }
    let (width, height) = seen.before.picture.size();
    let side = here.filter.size;
    match of.sample {
        Some(sample) => {
            let (x, y) = here.pixel(sample);
            let half = side as i32 / 2;
            scene.draw(
                Picture::CURRENT,
                (Role::Window, "filter of side L"),
                Shape::pixels(x as i32 - half, y as i32 - half, side, side),
            );
        }
        None => {
            draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
            scene.legend(Role::Window, "searched picture");
        }
    }
}

fn draw_choice(seen: &Seen<Surf>, maxima: &[Maximum], scene: &mut Scene) {
    let mut is_kept = vec![None; maxima.len()];
    for event in seen.events {
        if let Event::Peak(index, near) = event {
            is_kept[*index] = Some(near.is_none());
        }
    }
    let of_status = |status: Option<bool>| {
        let all = maxima.iter().zip(&is_kept).filter(move |(_, other)| **other == status);
        all.map(|(maximum, _)| maximum.blob)
    };
    // Circles of all maxima would hide the kept ones.
    for (status, role, meaning) in [
        (None, Role::Candidate, "maximum, not yet tested"),
        (Some(false), Role::Rejected, "rejected by the minimum distance"),
    ] {
        let points: Vec<_> = of_status(status).map(|blob| blob.at).collect();
        if !points.is_empty() {
            scene.draw(Picture::CURRENT, (role, meaning), Shape::Points(points));
        }
    }
    for blob in of_status(Some(true)) {
        scene.draw(Picture::CURRENT, (Role::Result, "keypoint, radius √2 s"), circle(blob));
    }
    if let Some(Event::Peak(index, _)) = seen.events.last() {
        scene.draw(Picture::CURRENT, (Role::Reference, "maximum of this step"), circle(maxima[*index].blob));
    }
    if maxima.is_empty() {
        let (width, height) = seen.before.picture.size();
        draw_box(scene, PixelBox::new([0, 0], [width as i32, height as i32]), Role::Window);
        scene.legend(Role::Window, "searched picture");
    }
}

fn draw_keypoint(seen: &Seen<Surf>, of: &Described<'_>, scene: &mut Scene) {
    let (state, blob) = (seen.before, of.maximum.blob);
    let others: Vec<_> =
        (0..of.index).filter_map(|index| state.keypoint(index)).map(|maximum| maximum.blob.at).collect();
    if !others.is_empty() {
        scene.draw(Picture::CURRENT, (Role::Best, "described keypoint"), Shape::Points(others));
    }
    scene.draw(Picture::CURRENT, (Role::Reference, "keypoint, radius √2 s"), circle(blob));
    match of.angle_rad {
        None => draw_wheel(of, scene),
        Some(angle_rad) => {
            draw_subregions(of, angle_rad, scene);
            let reach = 10.0 * blob.scale;
            let tip = [blob.at[0] + reach * angle_rad.cos(), blob.at[1] + reach * angle_rad.sin()];
            scene.draw(Picture::CURRENT, (Role::Result, "orientation"), Shape::line(vec![blob.at, tip]));
        }
    }
}

/// Draws the disc of the wavelets and the present sector with its sum.
fn draw_wheel(of: &Described<'_>, scene: &mut Scene) {
    let Blob { at: [x, y], scale } = of.maximum.blob;
    let radius = WHEEL_REACH as f32 * scale;
    scene.draw(Picture::CURRENT, (Role::Window, "samples within 6 s"), Shape::circle([x, y], radius));
    let Some(k) = of.sums.len().checked_sub(1) else { return };
    let on_circle = |angle_rad: f32| [x + radius * angle_rad.cos(), y + radius * angle_rad.sin()];
    let arc = (0..=12).map(|i| on_circle(sector_start(k) + SECTOR_RAD * i as f32 / 12.0));
    let points = [[x, y]].into_iter().chain(arc).collect();
    scene.draw(Picture::CURRENT, (Role::Candidate, "sector of 60°"), Shape::outline(points));
    let longest = of.sums.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f32::max);
    if longest > 0.0 {
        let tip = |[dx, dy]: [f32; 2]| [x + radius * dx / longest, y + radius * dy / longest];
        let best = of.sums[dominant(&of.sums).0];
        for (role, meaning, sum) in
            [(Role::Measured, "sum of the sector", of.sums[k]), (Role::Estimate, "longest sum", best)]
        {
            scene.draw(Picture::CURRENT, (role, meaning), Shape::line(vec![[x, y], tip(sum)]));
        }
    }
}

/// Draws the subregions of the descriptor with their sums.
fn draw_subregions(of: &Described<'_>, angle_rad: f32, scene: &mut Scene) {
    let blob = of.maximum.blob;
    let longest = of.subregions.iter().map(|[x, y, ..]| x.hypot(*y)).fold(0.0, f32::max);
    let (sin, cos) = angle_rad.sin_cos();
    let corners: Vec<_> = (0..SIDE * SIDE).flat_map(|k| subregion_corners(blob, angle_rad, k)).collect();
    let ends = |pick: fn(f32, f32) -> f32, start: f32| [0, 1].map(|i| corners.iter().map(|at| at[i]).fold(start, pick));
    scene.work = Some([ends(f32::min, f32::INFINITY), ends(f32::max, f32::NEG_INFINITY)]);
    for k in 0..SIDE * SIDE {
        let points = subregion_corners(blob, angle_rad, k);
        let middle = [0, 1].map(|axis| (points[0][axis] + points[2][axis]) / 2.0);
        let is_current = of.subregions.len() == k + 1 && of.length.is_none();
        let role = if is_current { Role::Candidate } else { Role::Window };
        scene.mark(Picture::CURRENT, role, Shape::outline(points));
        let Some([dx, dy, ..]) = of.subregions.get(k).filter(|_| longest > 0.0) else { continue };
        let [u, v] = [dx, dy].map(|sum| sum * 2.5 * blob.scale / longest);
        let tip = [middle[0] + cos * u - sin * v, middle[1] + sin * u + cos * v];
        scene.draw(
            Picture::CURRENT,
            (Role::Measured, "sums Σ dx, Σ dy of a subregion"),
            Shape::line(vec![middle, tip]),
        );
    }
    scene.legend(Role::Window, "subregions of 5 s");
}
