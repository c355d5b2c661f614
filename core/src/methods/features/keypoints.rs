//! The keypoints of a frame as marks.

use std::f32::consts::SQRT_2;

use crate::products::PointField;
use crate::scene::{Picture, Role, Scene, Shape};

/// Draws keypoints with a circle of √2 times their scale, the radius of a blob of that scale, and a radius in the direction of their orientation.
pub fn draw_keypoints(field: &PointField, scene: &mut Scene) {
    for (feature, keypoint) in field.points.iter().zip(&field.keypoints) {
        let Some(scale_px) = keypoint.scale_px else { continue };
        let (center, radius) = (feature.at, SQRT_2 * scale_px);
        scene.draw(
            Picture::CURRENT,
            (Role::Result, "keypoint, radius √2 s, with orientation"),
            Shape::circle(center, radius),
        );
        let Some((sin, cos)) = keypoint.angle_rad.map(f32::sin_cos) else { continue };
        let tip = [center[0] + radius * cos, center[1] + radius * sin];
        scene.mark(Picture::CURRENT, Role::Result, Shape::line(vec![center, tip]));
    }
}
