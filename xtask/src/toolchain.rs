//! The compilers that can build for a browser.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, bail};

/// The target of a page.
pub const TARGET: &str = "wasm32-unknown-unknown";

const DEBIAN_CARGO: &str = "/usr/bin/cargo";
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_LINKERS: [&str; 2] = ["/usr/lib/llvm-19/bin/wasm-ld", "/usr/bin/wasm-ld-19"];
const DEBIAN_SOURCE: &str = "lib/rustlib/src/rust/library";

/// A compiler that can build for [`TARGET`].
#[derive(Debug)]
pub enum Toolchain {
    /// The project's own, with the standard library of the target installed.
    Installed,
    /// Debian's, which compiles the standard library from source.
    Debian {
        /// The linker for WebAssembly.
        linker: &'static str,
    },
}

impl Toolchain {
    /// Finds a compiler.
    ///
    /// # Errors
    /// If there is none, with what to install.
    pub fn find() -> Result<Self> {
        if prints_existing_folder("rustc", &["--print", "target-libdir", "--target", TARGET], "")? {
            return Ok(Self::Installed);
        }
        let linker = DEBIAN_LINKERS.into_iter().find(|linker| Path::new(linker).exists());
        let has_source =
            || prints_existing_folder(DEBIAN_RUSTC, &["--print", "sysroot"], DEBIAN_SOURCE).unwrap_or(false);
        match linker {
            Some(linker) if Path::new(DEBIAN_CARGO).exists() && has_source() => Ok(Self::Debian { linker }),
            _ => bail!(
                "no compiler for {TARGET} is installed; run `rustup target add {TARGET}`, or on Debian `apt-get install \
                 rustc-web cargo-web rust-web-src lld-19`"
            ),
        }
    }

    /// The command of cargo that builds, without its arguments for the package.
    pub fn build(&self) -> Command {
        let features = "-C target-feature=+simd128";
        let mut command = match self {
            Self::Installed => {
                let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
                command.env("RUSTFLAGS", features).arg("build");
                command
            }
            Self::Debian { linker } => {
                let mut command = Command::new(DEBIAN_CARGO);
                command.env("RUSTC", DEBIAN_RUSTC).env("RUSTC_BOOTSTRAP", "1");
                command.env("RUSTFLAGS", format!("{features} -C linker={linker}"));
                command.args(["build", "-Z", "build-std=std,panic_abort"]);
                command
            }
        };
        command.args(["--target", TARGET]).env("CARGO_INCREMENTAL", "0");
        command
    }
}

/// Whether the folder that a compiler prints contains `below`.
fn prints_existing_folder(compiler: &str, args: &[&str], below: &str) -> Result<bool> {
    let output = Command::new(compiler).args(args).current_dir(crate::root()).output();
    let output = output.with_context(|| format!("{compiler} could not be started"))?;
    let folder = String::from_utf8_lossy(&output.stdout);
    Ok(output.status.success() && Path::new(folder.trim()).join(below).exists())
}
