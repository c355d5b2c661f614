//! Points in space with their motion, as a picture that can be turned.

mod splat;

use std::sync::Arc;

use glam::Vec3;
use motionscope_core::Role;
use motionscope_core::scene::{Cloud, CloudData};

use super::super::primitive::{Anchor, Point, Primitive, Rect};
use super::super::{grouped, legend, number};
use super::canvas::{Canvas, Level, Type, solid};
use super::{ChartStyle, Drawing, Layer, Orbit, Room, Screen};

/// The view from behind and above the cameras.
pub const USUAL: Orbit = Orbit { yaw_rad: -0.35, pitch_rad: 0.42, zoom: 1.8 };
/// Half the length of the depth that is shown, in units of the world.
const HALF: f32 = 1.0;
/// Distance in points within which a click picks a point.
const PICK_PT: f32 = 8.0;

/// A cloud and its viewpoint.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The cloud.
    pub cloud: &'a Cloud,
    /// The estimator that made it.
    pub whose: &'a str,
    /// The viewpoint.
    pub orbit: Orbit,
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
    fn new(data: &CloudData, rect: Rect, orbit: &Orbit) -> Self {
        let metres = (data.depth_m / (2.0 * HALF)).max(1e-6);
        Self { screen: Screen::new(rect, orbit, Room::SURFACE, [0.0; 2]), metres }
    }

    /// The place of a position in m.
    fn place(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        Vec3::new(x, -y, -z) / self.metres + Vec3::new(0.0, 0.3, HALF)
    }

    /// Where a position in m is seen, and its depth; `None` behind the eye.
    fn seen(&self, at: [f32; 3]) -> Option<(Point, f32)> {
        let place = self.place(at);
        let clip = self.screen.clip_from_world * place.extend(1.0);
        (clip.w > 0.05).then(|| self.screen.project(place))
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

/// Lays the cloud out in the whole of `area`.
pub fn draw(shown: Shown<'_>, area: Rect, style: ChartStyle) -> Drawing<Option<World>> {
    let Shown { cloud, whose, orbit } = shown;
    let (small, data) = (style.small(), cloud.data());
    let mut head = Canvas::default();
    let words = super::titled(whose, &points(data), (small, area.size()[0]));
    let middle = (Anchor::Start, Level::Middle);
    head.text([area.min[0], area.min[1] + 0.8 * small], middle, &words, Type::text(style.theme));
    let bottom = legend_rows(&mut head, cloud, area, style);
    let rect = Rect { min: [area.min[0], area.min[1] + 1.6 * small], max: [area.max[0], bottom - 0.3 * small] };
    let world = World::new(data, rect, &orbit);
    let mut canvas = Canvas::default();
    canvas.add(Primitive::Image { pixels: Arc::new(splat::render(data, &world, rect, style)), rect });
    let view = View { world, style };
    view.depth_axis(&mut canvas, data);
    view.cameras(&mut canvas, data);
    view.lines(&mut canvas, data);
    view.marked(&mut canvas, cloud);
    let body = vec![Layer { clip: Some(rect), primitives: canvas.into_primitives() }];
    Drawing { place: Some(world), body, head: head.into_primitives() }
}

/// What the cloud shows, in words.
pub fn summary(cloud: &Cloud) -> String {
    format!("Point cloud of {}", points(cloud.data()))
}

fn points(data: &CloudData) -> String {
    format!("{} points, up to {} m", grouped(data.points.len()), number(data.depth_m.round()))
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
        let stroke = solid(1.0, dim.color);
        if let (Some(from), Some(to)) = (seen(0.0), seen(step * count as f32)) {
            canvas.line(vec![from, to], false, stroke);
        }
        for multiple in 1..=count {
            let Some([x, y]) = seen(step * multiple as f32) else { continue };
            canvas.line(vec![[x, y - 3.0], [x, y + 3.0]], false, stroke);
            let words = format!("{} m", number(step * multiple as f32));
            let mut line = dim.line([x + 4.0, y - 0.5 * dim.size], (Anchor::Start, Level::Middle), &words);
            line.halo = Some(self.style.theme.chrome().panel);
            canvas.add(Primitive::Text(line));
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
            let ink = self.style.theme.ink(*role);
            canvas.disc(center, 6.0, ink.halo);
            canvas.disc(center, 4.5, ink.color);
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
        for orbit in [USUAL, USUAL.turned([200.0, 30.0])] {
            let world = draw(Shown { cloud: &cloud, whose: "", orbit }, area, style()).place.unwrap();
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
        let orbit = Orbit { yaw_rad: 0.0, pitch_rad: 0.0, zoom: 1.0 };
        let rect = Rect::new([0.0; 2], [300.0, 300.0]);
        let world = World::new(cloud.data(), rect, &orbit);
        let pixels = splat::render(cloud.data(), &world, rect, style());
        let count = |color: [u8; 4]| pixels.cells().iter().filter(|pixel| **pixel == color).count();
        assert!(count([255, 0, 0, 255]) > 0, "the nearer");
        let (at, depth) = world.seen([0.0, 0.0, 2.0]).unwrap();
        assert!(depth < world.seen([0.0, 0.0, 9.0]).unwrap().1);
        assert_eq!(pixels[(at[0] as usize, at[1] as usize)], [255, 0, 0, 255]);
    }

    #[test]
    fn depths_have_round_numbers() {
        assert_eq!([3.4, 0.9, 26.0, 1.0].map(round_step), [2.0, 0.5, 20.0, 1.0]);
    }
}
