//! Motionscope's window and command line over `motionscope-core`.

#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
pub mod experiment;
pub mod files;
pub mod media;
pub mod paint;
pub mod results;
pub mod search;
pub mod session;
pub mod ui;
pub mod view;
pub mod work;
