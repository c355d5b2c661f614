//! The window: a stage, the numbers behind it, and a ladder to walk on.

pub mod axis;
pub mod ink;
pub mod math;
pub mod primitives;
pub mod stage;
pub mod why;
