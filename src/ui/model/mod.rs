//! The model of the window: the document, the run on its thread, opening and saving.

pub mod background;
pub mod comparing;
pub mod document;
pub mod history;
pub mod lesson;
pub mod loader;
pub mod nested;
pub mod paper;
pub mod player;
pub mod preview;
pub mod settings;
pub mod snapshot;
pub mod walker;
pub mod writer;
