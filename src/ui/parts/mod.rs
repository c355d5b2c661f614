//! Small parts that the panes share.

pub mod icon;
pub mod slider;
pub mod toasts;
pub mod widgets;
