//! Generates the JavaScript between the module and the browser.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, bail};
use wasm_bindgen_cli_support::Bindgen;

use crate::root;

/// Writes `NAME.js` and `NAME_bg.wasm` for a compiled module into a folder.
pub fn generate(module: &Path, name: &str, folder: &Path) -> Result<()> {
    check_version()?;
    Bindgen::new()
        .input_path(module)
        .out_name(name)
        .web(true)?
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)
        .context("wasm-bindgen cannot process the module")
}

/// Refuses a program that was compiled against another version of wasm-bindgen: the format between both is private.
fn check_version() -> Result<()> {
    let lock: toml::Table = fs::read_to_string(root().join("Cargo.lock"))?.parse()?;
    let packages = lock.get("package").and_then(toml::Value::as_array).context("Cargo.lock lists no packages")?;
    let package =
        packages.iter().find(|package| package.get("name").and_then(toml::Value::as_str) == Some("wasm-bindgen"));
    let of_program = package.and_then(|package| package.get("version")?.as_str());
    let ours = wasm_bindgen_shared::version();
    match of_program {
        Some(version) if version == ours => Ok(()),
        Some(version) => bail!(
            "Cargo.lock has wasm-bindgen {version}, but xtask has {ours}; set wasm-bindgen-cli-support and \
             wasm-bindgen-shared in xtask/Cargo.toml to ={version}"
        ),
        None => bail!("Cargo.lock has no wasm-bindgen"),
    }
}
