//! Makes the module smaller with `wasm-opt`, where it is installed.

use std::path::Path;
use std::process::Command;

use anyhow::Result;

/// The features that the module uses beyond WebAssembly 1.0, which older versions of `wasm-opt` do not assume.
const FEATURES: [&str; 7] = [
    "--enable-bulk-memory",
    "--enable-multivalue",
    "--enable-mutable-globals",
    "--enable-nontrapping-float-to-int",
    "--enable-reference-types",
    "--enable-sign-ext",
    "--enable-simd",
];

/// Replaces a module by a smaller one; it stays as it is, with a notice, where that is not possible.
pub fn shrink(module: &Path) -> Result<()> {
    let smaller = module.with_extension("opt");
    let output = Command::new("wasm-opt").arg("-O2").args(FEATURES).arg(module).arg("-o").arg(&smaller).output();
    match output {
        Ok(output) if output.status.success() => std::fs::rename(&smaller, module)?,
        Ok(output) => eprintln!(
            "notice: wasm-opt failed, so the page is larger than it could be: {}",
            String::from_utf8_lossy(&output.stderr).lines().next().unwrap_or("it does not say why")
        ),
        Err(_) => eprintln!("notice: the page is not made smaller: wasm-opt is not installed (Debian: `binaryen`)"),
    }
    Ok(())
}
