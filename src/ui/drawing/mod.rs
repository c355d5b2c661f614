//! How the window draws: the theme's colors and type, primitives as shapes, arrows on the graphics card.

pub mod arrows;
pub mod chart;
pub mod ink;
pub mod offscreen;
pub mod pen;
pub mod primitives;
pub mod style;
