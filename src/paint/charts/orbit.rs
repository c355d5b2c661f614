//! A camera that turns about the middle of the ground.

use glam::camera::rh::{proj::directx::perspective, view::look_at_mat4};
use glam::{Mat4, Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::super::primitive::{Point, Rect};
use super::canvas::middle;

const FIELD_OF_VIEW_RAD: f32 = 0.5;
const DISTANCE: f32 = 5.6;
const ZOOM: (f32, f32) = (0.4, 6.0);
/// What the camera looks at: above the ground, in the middle of what stands on it.
const TARGET: Vec3 = Vec3::new(0.0, 0.4, 0.0);

/// From where one looks. x is u, z is v, y is the cost; the ground reaches from −1 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// About the vertical, 0 with v coming towards the eye.
    pub yaw_rad: f32,
    /// Above the ground.
    pub pitch_rad: f32,
    /// 1 shows everything as large as it fits.
    pub zoom: f32,
}

impl Default for Orbit {
    fn default() -> Self {
        Self { yaw_rad: -0.5, pitch_rad: 0.68, zoom: 1.0 }
    }
}

/// The room that the world takes, whichever way it is turned.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// How far the ground reaches from its middle.
    pub ground: f32,
    /// How high the highest is, and how far that reaches from the middle.
    pub top: [f32; 2],
}

impl Room {
    /// That of a surface. Pins at its very corners are rare: they may reach into the margin.
    pub const SURFACE: Self = Self { ground: std::f32::consts::SQRT_2, top: [1.3, 0.8] };
}

impl Orbit {
    /// After a drag by `delta` points.
    #[must_use]
    pub fn turned(self, delta: [f32; 2]) -> Self {
        let yaw_rad = (self.yaw_rad - 0.008 * delta[0]).rem_euclid(std::f32::consts::TAU);
        let pitch_rad = (self.pitch_rad + 0.008 * delta[1]).clamp(0.06, 1.5);
        Self { yaw_rad, pitch_rad, ..self }
    }

    /// After coming nearer by `factor`.
    #[must_use]
    pub fn nearer(self, factor: f32) -> Self {
        Self { zoom: (self.zoom * factor).clamp(ZOOM.0, ZOOM.1), ..self }
    }

    /// Where the eye is.
    pub fn eye(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        TARGET + DISTANCE * Vec3::new(cos_pitch * sin_yaw, sin_pitch, cos_pitch * cos_yaw)
    }

    /// Clip space from the world, for a picture of `size` points with a `margin` left and right, above and below.
    ///
    /// At zoom 1 the `room` fills the picture, and its size does not change while it turns.
    pub fn clip_from_world(&self, room: Room, size: [f32; 2], margin: [f32; 2]) -> Mat4 {
        let (size, margin) = (Vec2::from(size).max(Vec2::splat(1.0)), Vec2::from(margin));
        let aspect = (size.x / size.y).clamp(0.05, 20.0);
        let projection = perspective(FIELD_OF_VIEW_RAD, aspect, 0.1, 100.0);
        let seen = projection * look_at_mat4(self.eye(), TARGET, Vec3::Y);
        let (low, high) = extent(&seen, room);
        let free = ((size - 2.0 * margin) / size).max(Vec2::splat(0.3)) * 2.0;
        let scale = self.zoom * (free.x / (high.x - low.x)).min(free.y / (high.y - low.y));
        let middle = (low + high) / 2.0;
        let place = Mat4::from_translation(Vec3::new(-middle.x * scale, -middle.y * scale, 0.0));
        place * Mat4::from_scale(Vec3::new(scale, scale, 1.0)) * seen
    }
}

/// The part of the picture that `room` takes.
fn extent(seen: &Mat4, room: Room) -> (Vec2, Vec2) {
    let Room { ground, top: [top, reach] } = room;
    let rim = (0..24).flat_map(|i| {
        let (sin, cos) = (i as f32 / 24.0 * std::f32::consts::TAU).sin_cos();
        [Vec3::new(ground * cos, 0.0, ground * sin), Vec3::new(reach * cos, top, reach * sin)]
    });
    let (low, high) = (Vec2::MAX, Vec2::MIN);
    rim.map(|place| seen.project_point3(place).truncate())
        .fold((low, high), |(low, high), at| (low.min(at), high.max(at)))
}

/// The camera over a part of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// The part of the sheet, in points.
    pub rect: Rect,
    /// Clip space from the world.
    pub clip_from_world: Mat4,
}

impl Screen {
    /// The world as seen from `orbit` in `rect` with a `margin` around it for words.
    pub fn new(rect: Rect, orbit: &Orbit, room: Room, margin: [f32; 2]) -> Self {
        Self { rect, clip_from_world: orbit.clip_from_world(room, rect.size(), margin) }
    }

    /// Where a place of the world is seen, and its depth from 0 near to 1 far.
    pub fn project(&self, place: Vec3) -> (Point, f32) {
        let clip = self.clip_from_world.project_point3(place);
        let (center, half) = (middle(&self.rect), self.rect.size().map(|side| side / 2.0));
        ([center[0] + clip.x * half[0], center[1] - clip.y * half[1]], clip.z)
    }

    /// The same camera over a `part` of its rectangle.
    pub fn cut(&self, part: Rect) -> Self {
        let [center, middle] = [&self.rect, &part].map(middle);
        let [whole, size] = [self.rect.size(), part.size()];
        let [x, y] = [0, 1].map(|i| 2.0 * (center[i] - middle[i]) / whole[i]);
        let closer = Mat4::from_scale(Vec3::new(whole[0] / size[0], whole[1] / size[1], 1.0));
        let moved = Mat4::from_translation(Vec3::new(x, -y, 0.0));
        Self { rect: part, clip_from_world: closer * moved * self.clip_from_world }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn screen(orbit: &Orbit) -> Screen {
        Screen::new(Rect::new([40.0, 10.0], [600.0, 400.0]), orbit, Room::SURFACE, [0.0; 2])
    }

    #[test]
    fn the_world_is_seen_the_right_way_round() {
        let front = Orbit { yaw_rad: 0.0, ..Orbit::default() };
        let screen = screen(&front);
        let at = |x, y, z| screen.project(Vec3::new(x, y, z));
        assert!(at(1.0, 0.0, 0.0).0[0] > at(-1.0, 0.0, 0.0).0[0], "u to the right");
        assert!(at(0.0, 1.0, 0.0).0[1] < at(0.0, 0.0, 0.0).0[1], "cost upwards");
        assert!(at(0.0, 0.0, 1.0).0[1] > at(0.0, 0.0, -1.0).0[1], "v towards the eye");
        assert!(at(0.0, 0.0, 1.0).1 < at(0.0, 0.0, -1.0).1, "and nearer");
        assert!((at(0.0, 0.4, 0.0).0[0] - middle(&screen.rect)[0]).abs() < 1e-2);
    }

    #[test]
    fn a_part_of_a_screen_shows_everything_where_the_whole_does() {
        let whole = screen(&Orbit::default());
        let part = whole.cut(Rect::new([90.0, 130.0], [320.0, 128.0]));
        for place in [[-1.0, 0.0, -1.0], [1.0, 0.5, 1.0], [0.3, 1.0, -0.2]] {
            let [(a, depth), (b, other)] = [whole, part].map(|screen| screen.project(place.into()));
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-2 && (depth - other).abs() < 1e-5, "{a:?} {b:?}");
        }
    }

    #[test]
    fn everything_is_in_the_picture_from_every_side() {
        for size in [[900.0, 300.0], [400.0, 400.0], [260.0, 420.0]] {
            for i in 0..12 {
                let orbit = Orbit { yaw_rad: i as f32 * 0.53, ..Orbit::default() };
                let rect = Rect::new([0.0; 2], size);
                let screen = Screen::new(rect, &orbit, Room::SURFACE, [0.0; 2]);
                for corner in [[-1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.5, 1.3, -0.5]] {
                    let (at, depth) = screen.project(corner.into());
                    let inside = (0..2).all(|i| (-1.0..=size[i] + 1.0).contains(&at[i]));
                    assert!(inside && (0.0..1.0).contains(&depth), "{size:?} {orbit:?}: {at:?}");
                }
            }
        }
    }

    #[test]
    fn turning_stays_above_the_ground_and_zooming_in_bounds() {
        let orbit = Orbit::default().turned([1e5, -1e5]).nearer(1e6);
        assert!(orbit.eye().y > 0.0 && orbit.zoom == ZOOM.1);
        assert_eq!(Orbit::default().nearer(1e-6).zoom, ZOOM.0);
    }
}
