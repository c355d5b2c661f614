//! Compiles the program for a browser.

use std::path::PathBuf;

use anyhow::{Context as _, Result, bail};

use crate::root;
use crate::toolchain::{TARGET, Toolchain};

/// Compiles with a profile of the root `Cargo.toml`, and returns the path of the module.
pub fn compile(profile: &str) -> Result<PathBuf> {
    let mut command = Toolchain::find()?.build();
    command
        .args(["--locked", "--bin", "motionscope", "--profile", profile])
        .arg("--target-dir")
        .arg(root().join("target"));
    let status = command.current_dir(root()).status().context("cargo could not be started")?;
    if !status.success() {
        bail!("the program does not compile for a browser; cargo says why above");
    }
    let folder = if profile == "dev" { "debug" } else { profile };
    Ok(root().join("target").join(TARGET).join(folder).join("motionscope.wasm"))
}
