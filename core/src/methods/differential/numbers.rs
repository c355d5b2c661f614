//! The decimals of quantities of optical flow.

/// The decimals of a length in px.
pub const PX_DECIMALS: usize = 3;

/// The decimals of a difference in gray levels.
pub const GRAY_DECIMALS: usize = 2;
