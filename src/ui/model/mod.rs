//! What the window knows and does without drawing: the document, the run on its thread, files in and out.

pub mod background;
pub mod comparing;
pub mod document;
pub mod history;
pub mod loader;
pub mod nested;
pub mod player;
pub mod preview;
pub mod settings;
pub mod snapshot;
pub mod walker;
pub mod writer;
