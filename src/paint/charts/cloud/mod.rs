//! Points in space with their motion, as a picture that can be turned.

mod splat;

use splat::SIDE;
pub use splat::{SIDES_PT, color};

use std::sync::Arc;

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec3};
use motionscope_core::base::words::fixed;
use motionscope_core::scene::{Cloud, CloudData, Role};
use serde::{Deserialize, Serialize};

use super::super::primitive::{Anchor, Point, Primitive, Rect};
use super::super::{grouped, legend, number};
use super::canvas::{Canvas, Level, Type, covered, solid};
use super::{ChartStyle, Drawing, Layer, Screen};

/// Half the length of the depth that is shown, in units of the world.
const HALF: f32 = 1.0;
/// Vertical field of view.
const FIELD_OF_VIEW_RAD: f32 = 0.75;
/// Nearest and farthest the eye may be from its target; nearer, the target moves on with it.
const DISTANCES: [f32; 2] = [0.2, 8.0];
/// Depths of clip space, and the least distance along the view at which a point is seen.
const NEAR: f32 = 0.01;
const FAR: f32 = 50.0;
/// Distance in points within which a click picks a point.
const PICK_PT: f32 = 8.0;

/// The eye: it turns about a target, which moves when the eye flies on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Viewpoint {
    /// About the vertical, 0 behind the cameras.
    pub yaw_rad: f32,
    /// Above the ground.
    pub pitch_rad: f32,
    /// Distance from the target in units of the world.
    pub distance: f32,
    /// The target in units of the world.
    pub target: [f32; 3],
}

impl Default for Viewpoint {
    /// Behind and above the cameras.
    fn default() -> Self {
        Self { yaw_rad: -0.35, pitch_rad: 0.36, distance: 1.8, target: [0.0, 0.1, 0.1] }
    }
}

impl Viewpoint {
    /// After a drag by `delta` points.
    #[must_use]
    pub fn turned(self, delta: [f32; 2]) -> Self {
        let yaw_rad = (self.yaw_rad - 0.008 * delta[0]).rem_euclid(std::f32::consts::TAU);
        let pitch_rad = (self.pitch_rad + 0.008 * delta[1]).clamp(-0.4, 1.5);
        Self { yaw_rad, pitch_rad, ..self }
    }

    /// After coming nearer by `factor`; at the least distance the eye flies on with its target.
    #[must_use]
    pub fn nearer(self, factor: f32) -> Self {
        let wanted = self.distance / factor.max(1e-3);
        let distance = wanted.clamp(DISTANCES[0], DISTANCES[1]);
        let beyond = (distance - wanted).max(0.0);
        let target = Vec3::from(self.target) - beyond * self.backwards();
        Self { distance, target: target.into(), ..self }.bounded()
    }

    /// After the ground was dragged by `delta` points: sideways, and along the view.
    #[must_use]
    pub fn moved(self, delta: [f32; 2]) -> Self {
        let (sin, cos) = self.yaw_rad.sin_cos();
        let (right, forwards) = (Vec3::new(cos, 0.0, -sin), Vec3::new(-sin, 0.0, -cos));
        let step = 0.002 * self.distance;
        let target = Vec3::from(self.target) - step * delta[0] * right + step * delta[1] * forwards;
        Self { target: target.into(), ..self }.bounded()
    }

    fn bounded(self) -> Self {
        Self { target: self.target.map(|c| c.clamp(-3.0, 3.0)), ..self }
    }

    /// The direction from the target to the eye.
    fn backwards(&self) -> Vec3 {
        let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) = (self.yaw_rad.sin_cos(), self.pitch_rad.sin_cos());
        Vec3::new(cos_pitch * sin_yaw, sin_pitch, cos_pitch * cos_yaw)
    }

    /// Clip space from the world, for a picture of `size` points.
    fn clip_from_world(&self, size: [f32; 2]) -> Mat4 {
        let target = Vec3::from(self.target);
        let aspect = (size[0] / size[1].max(1.0)).clamp(0.05, 20.0);
        let projection = perspective(FIELD_OF_VIEW_RAD, aspect, NEAR, FAR);
        projection * look_at_mat4(target + self.distance * self.backwards(), target, Vec3::Y)
    }
}

/// A cloud and its viewpoint.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The cloud.
    pub cloud: &'a Cloud,
    /// The estimator that made it.
    pub whose: &'a str,
    /// The viewpoint.
    pub viewpoint: Viewpoint,
}

/// The world of a cloud: x to the right, y up, the cameras in front and the depth away from the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    screen: Screen,
    /// Metres of a unit.
    metres: f32,
}

impl World {
    /// The world of `data` in a part of the sheet.
    fn new(data: &CloudData, rect: Rect, viewpoint: &Viewpoint) -> Self {
        let metres = (data.depth_m / (2.0 * HALF)).max(1e-6);
        let clip_from_world = viewpoint.clip_from_world(rect.size());
        Self { screen: Screen { rect, clip_from_world }, metres }
    }

    /// The place of a position in m.
    pub fn place(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        Vec3::new(x, -y, -z) / self.metres + Vec3::new(0.0, 0.0, HALF)
    }

    /// The part of the sheet that shows it, and clip space from the world.
    pub fn screen(&self) -> &Screen {
        &self.screen
    }

    /// Points of the sheet for a unit of the world at distance 1.
    pub fn magnification(&self) -> f32 {
        self.screen.clip_from_world.row(1).truncate().length() * self.screen.rect.size()[1] / 2.0
    }

    /// The side of a point in units of the world.
    pub fn side(&self, depth_m: f32) -> f32 {
        SIDE * depth_m / self.metres
    }

    /// Where a position in m is seen, and its depth; `None` behind the eye.
    fn seen(&self, at: [f32; 3]) -> Option<(Point, f32)> {
        let place = self.place(at);
        let clip = self.screen.clip_from_world * place.extend(1.0);
        (clip.w > NEAR).then(|| self.screen.project(place))
    }

    /// The pixel of the point of a cloud that is seen at a place, the nearest to the eye of those close to it.
    pub fn pick(&self, data: &CloudData, at: Point) -> Option<[u16; 2]> {
        let near = data.points.iter().filter_map(|point| {
            let (seen, depth) = self.seen(point.at)?;
            let distance = (seen[0] - at[0]).hypot(seen[1] - at[1]);
            (distance < PICK_PT).then_some((depth + 0.001 * distance, point.pixel))
        });
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, pixel)| pixel)
    }
}

/// The cloud without its points: what stands around them, and above them.
#[derive(Clone, Debug, PartialEq)]
pub struct Around {
    /// The world.
    pub world: World,
    /// Axis, cameras and displacements, seen inside the world's part of the sheet.
    pub above: Vec<Primitive>,
    /// Title and legend.
    pub head: Vec<Primitive>,
}

/// Lays out all but the points in the whole of `area`.
pub fn around(shown: Shown<'_>, area: Rect, style: ChartStyle) -> Around {
    let Shown { cloud, whose, viewpoint } = shown;
    let (small, data) = (style.small(), cloud.data());
    let mut head = Canvas::default();
    let words = super::titled(whose, &points(data), (small, area.size()[0]));
    let middle = (Anchor::Start, Level::Middle);
    head.text([area.min[0], area.min[1] + 0.8 * small], middle, &words, Type::text(style.theme));
    let bottom = legend_rows(&mut head, cloud, area, style);
    let rect = Rect { min: [area.min[0], area.min[1] + 1.6 * small], max: [area.max[0], bottom - 0.3 * small] };
    let world = World::new(data, rect, &viewpoint);
    let mut canvas = Canvas::default();
    let view = View { world, style };
    view.depth_axis(&mut canvas, data);
    view.cameras(&mut canvas, data);
    view.lines(&mut canvas, data);
    view.marked(&mut canvas, cloud);
    Around { world, above: canvas.into_primitives(), head: head.into_primitives() }
}

/// Lays the cloud out in the whole of `area`.
pub fn draw(shown: Shown<'_>, area: Rect, style: ChartStyle) -> Drawing<Option<World>> {
    let Around { world, above, head } = around(shown, area, style);
    let rect = world.screen.rect;
    let pixels = Arc::new(splat::render(shown.cloud.data(), &world, rect, style));
    let primitives = [Primitive::Image { pixels, rect }].into_iter().chain(above).collect();
    Drawing { place: Some(world), body: vec![Layer { clip: Some(rect), primitives }], head }
}

/// What the cloud shows, in words.
pub fn summary(cloud: &Cloud) -> String {
    format!("Point cloud of {}", points(cloud.data()))
}

fn points(data: &CloudData) -> String {
    format!("{} points, up to {} m", grouped(data.points.len()), fixed(data.depth_m.into(), 1))
}

/// The legend below the cloud, in rows; gives where it begins.
fn legend_rows(canvas: &mut Canvas, cloud: &Cloud, area: Rect, style: ChartStyle) -> f32 {
    let (small, text) = (style.small(), Type::text(style.theme));
    let (swatch, gap, line) = (1.1 * small, 1.2 * small, 1.4 * small);
    let width = |words: &str| swatch + text.width(words) + gap;
    let mut rows: Vec<Vec<(Role, &str)>> = vec![Vec::new()];
    let mut used = 0.0;
    for &(role, words) in &cloud.legend {
        if used + width(words) > area.size()[0] + gap && used > 0.0 {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += width(words);
        if let Some(row) = rows.last_mut() {
            row.push((role, words));
        }
    }
    let top = area.max[1] - line * rows.len() as f32;
    for (number, row) in rows.iter().enumerate() {
        let y = top + line * (number as f32 + 0.5);
        let mut x = area.min[0];
        for (role, words) in row {
            canvas.extend(legend::point(*role, style.theme, [x + 0.4 * small, y]));
            canvas.text([x + swatch, y], (Anchor::Start, Level::Middle), words, text);
            x += width(words);
        }
    }
    top
}

struct View {
    world: World,
    style: ChartStyle,
}

impl View {
    /// A line between two positions in m, in the ink of a role.
    fn line(&self, canvas: &mut Canvas, ends: [[f32; 3]; 2], role: Role, most: f32) {
        let [Some((from, _)), Some((to, _))] = ends.map(|end| self.world.seen(end)) else { return };
        let ink = self.style.theme.ink(role);
        let width = ink.width.min(most);
        canvas.line(vec![from, to], false, solid(width + 1.0, ink.halo));
        canvas.line(vec![from, to], false, solid(width, ink.color));
    }

    /// The optical axis with its depths.
    fn depth_axis(&self, canvas: &mut Canvas, data: &CloudData) {
        let dim = Type::dim(self.style.theme);
        let step = round_step(data.depth_m / 3.0);
        let seen = |z: f32| self.world.seen([0.0, 0.0, z]).map(|(at, _)| at);
        let count = (data.depth_m / step).floor() as usize;
        let (stroke, part) = (solid(1.0, dim.color), self.world.screen.rect);
        if let (Some(from), Some(to)) = (seen(0.0), seen(step * count as f32)) {
            canvas.line(vec![from, to], false, stroke);
        }
        let mut last: Option<Rect> = None;
        for multiple in 1..=count {
            let Some([x, y]) = seen(step * multiple as f32) else { continue };
            canvas.line(vec![[x, y - 3.0], [x, y + 3.0]], false, stroke);
            let words = format!("{} m", number(step * multiple as f32));
            let line = dim.line([x + 4.0, y - 0.5 * dim.size], (Anchor::Start, Level::Middle), &words);
            let rect = covered(&line);
            // Far depths lie close to each other.
            if last.is_none_or(|last| !last.meets(&rect)) && part.contains(rect.min) && part.contains(rect.max) {
                canvas.fill(rect, self.style.theme.chrome().panel.alpha(170));
                canvas.add(Primitive::Text(line));
                last = Some(rect);
            }
        }
    }

    fn cameras(&self, canvas: &mut Canvas, data: &CloudData) {
        for camera in &data.cameras {
            let [eye, corners @ ..] = camera.corners;
            for i in 0..4 {
                self.line(canvas, [eye, corners[i]], camera.role, 1.2);
                self.line(canvas, [corners[i], corners[(i + 1) % 4]], camera.role, 1.2);
            }
        }
    }

    fn lines(&self, canvas: &mut Canvas, data: &CloudData) {
        for line in &data.lines {
            self.line(canvas, line.ends, line.role, 1.4);
        }
    }

    /// The points that the step is about, as rings.
    fn marked(&self, canvas: &mut Canvas, cloud: &Cloud) {
        if let [(_, from), (role, to)] = cloud.marked[..] {
            self.line(canvas, [from, to], role, 2.0);
        }
        for (role, at) in &cloud.marked {
            let Some((center, _)) = self.world.seen(*at) else { continue };
            canvas.extend(legend::point(*role, self.style.theme, center));
        }
    }
}

/// The nearest of 1, 2 and 5 times a power of ten below `about`.
fn round_step(about: f32) -> f32 {
    let power = 10f32.powf(about.max(1e-6).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|factor| factor * power).find(|step| *step <= about).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::CloudPoint;

    use super::super::super::{ColorMap, Theme};
    use super::*;

    fn cloud() -> Cloud {
        let point = |x: f32, z: f32, pixel| CloudPoint { at: [x, 0.0, z], color: [200, 40, 40], role: None, pixel };
        Cloud::new("Point cloud", move || CloudData {
            points: vec![point(0.0, 5.0, [1, 2]), point(0.0, 9.0, [3, 4]), point(2.0, 9.0, [5, 6])],
            depth_m: 10.0,
            ..CloudData::default()
        })
    }

    fn style() -> ChartStyle {
        ChartStyle { theme: Theme::Dark, colors: ColorMap::Viridis, density: 1.0 }
    }

    #[test]
    fn a_click_picks_the_point_that_is_seen_there() {
        let (cloud, area) = (cloud(), Rect::new([20.0, 10.0], [500.0, 400.0]));
        for viewpoint in [Viewpoint::default(), Viewpoint::default().turned([200.0, 30.0])] {
            let world = draw(Shown { cloud: &cloud, whose: "", viewpoint }, area, style()).place.unwrap();
            for point in &cloud.data().points {
                let (at, _) = world.seen(point.at).unwrap();
                assert!(area.contains(at));
                assert_eq!(world.pick(cloud.data(), at), Some(point.pixel));
            }
            assert_eq!(world.pick(cloud.data(), area.min), None);
        }
    }

    #[test]
    fn points_are_seen_in_their_colours_the_nearer_before_the_farther() {
        let behind = |x: f32, z: f32, color| CloudPoint { at: [x, 0.0, z], color, role: None, pixel: [0; 2] };
        let cloud = Cloud::new("", move || CloudData {
            points: vec![behind(0.0, 2.0, [255, 0, 0]), behind(0.0, 9.0, [0, 0, 255])],
            depth_m: 10.0,
            ..CloudData::default()
        });
        // Along the optical axis both lie at one place.
        let viewpoint = Viewpoint { yaw_rad: 0.0, pitch_rad: 0.0, distance: 3.0, target: [0.0; 3] };
        let rect = Rect::new([0.0; 2], [300.0, 300.0]);
        let world = World::new(cloud.data(), rect, &viewpoint);
        let pixels = splat::render(cloud.data(), &world, rect, style());
        let count = |color: [u8; 4]| pixels.cells().iter().filter(|pixel| **pixel == color).count();
        assert!(count([255, 0, 0, 255]) > 0, "the nearer");
        let (at, depth) = world.seen([0.0, 0.0, 2.0]).unwrap();
        assert!(depth < world.seen([0.0, 0.0, 9.0]).unwrap().1);
        assert_eq!(pixels[(at[0] as usize, at[1] as usize)], [255, 0, 0, 255]);
    }

    #[test]
    fn the_eye_flies_on_where_it_cannot_come_nearer() {
        let start = Viewpoint { yaw_rad: 0.0, pitch_rad: 0.0, distance: 2.0, target: [0.0; 3] };
        let near = start.nearer(4.0);
        assert_eq!((near.distance, near.target), (0.5, [0.0; 3]));
        let through = near.nearer(10.0);
        assert!(through.distance == DISTANCES[0] && (through.target[2] + 0.15).abs() < 1e-6, "{through:?}");
        // Along the street, away from the eye, and to the side.
        let along = start.moved([0.0, 100.0]);
        assert!(along.target[2] < 0.0 && along.target[0] == 0.0);
        assert!(start.moved([100.0, 0.0]).target[0] < 0.0);
        assert!(start.nearer(1e-9).distance == DISTANCES[1] && start.nearer(f32::MAX).target[2] >= -3.0);
    }

    #[test]
    fn depths_have_round_numbers() {
        assert_eq!([3.4, 0.9, 26.0, 1.0].map(round_step), [2.0, 0.5, 20.0, 1.0]);
    }
}
