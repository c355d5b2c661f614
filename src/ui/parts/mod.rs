//! Small parts that the panes share.

pub mod arrows;
pub mod entry_card;
pub mod icon;
pub mod recent;
pub mod sample_card;
pub mod slider;
pub mod toasts;
pub mod widgets;
