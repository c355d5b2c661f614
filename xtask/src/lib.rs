//! Builds and serves the page of a browser.

mod bindings;
pub mod page;
mod program;
mod server;
mod shrink;
mod toolchain;

use std::path::{Path, PathBuf};

pub use server::Server;

/// The root of the repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate lies in a folder of the repository")
}

/// The folder into which the page is built unless told otherwise.
pub fn default_folder() -> PathBuf {
    root().join("target/web")
}
