//! Motionscope: walk through any motion estimator, step by step, forwards and backwards.

// On Windows this stays a program of the console, also in a release. As one of the windows subsystem it would have no
// console to print to, and a shell would not wait for it, so that `motionscope list` and every error would be lost. The
// price is a console behind the window when it is started by a double click.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    env_logger::init();
    let _run = motionscope::files::temporary::begin(eframe::storage_dir("motionscope"));
    motionscope::cli::main(std::env::args_os())
}

#[cfg(target_arch = "wasm32")]
fn main() {
    motionscope::ui::run_in_page();
}
