//! The scenes, one file each, in the order in which a course would show them.
//!
//! A scene is drawn for a picture of 320×240 and shown larger or smaller in any other; what lies farther out is there too.

mod balloon;
mod barber_pole;
mod blurred_swing;
mod crossing_stars;
mod drive;
mod fast_ball;
mod fast_flight;
mod flag;
mod flat_wall;
mod flicker;
mod formation;
mod hand_held;
mod leaves;
mod parallax;
mod passing_bus;
mod pillar;
mod rigid_layers;
mod spin_zoom;
mod spinning_sign;
mod stereo_traps;
mod still_life;
mod sub_pixel;
mod traffic;
mod translation;
mod tunnel;
mod turning_box;
mod turntable;
mod wallpaper;
mod wrong_way;

use super::Sample;

/// All scenes.
pub const SCENES: &[Sample] = &[
    translation::SAMPLE,
    sub_pixel::SAMPLE,
    pillar::SAMPLE,
    parallax::SAMPLE,
    spin_zoom::SAMPLE,
    fast_ball::SAMPLE,
    barber_pole::SAMPLE,
    wallpaper::SAMPLE,
    flat_wall::SAMPLE,
    flicker::SAMPLE,
    crossing_stars::SAMPLE,
    formation::SAMPLE,
    traffic::SAMPLE,
    hand_held::SAMPLE,
    passing_bus::SAMPLE,
    flag::SAMPLE,
    balloon::SAMPLE,
    tunnel::SAMPLE,
    leaves::SAMPLE,
    rigid_layers::SAMPLE,
    turntable::SAMPLE,
    still_life::SAMPLE,
    stereo_traps::SAMPLE,
    drive::SAMPLE,
    turning_box::SAMPLE,
    spinning_sign::SAMPLE,
    blurred_swing::SAMPLE,
    fast_flight::SAMPLE,
    wrong_way::SAMPLE,
];
