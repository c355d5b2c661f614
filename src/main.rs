//! Motionscope: walk through any motion estimator, step by step, forwards and backwards.

use std::process::ExitCode;

fn main() -> ExitCode {
    env_logger::init();
    motionscope::cli::main(std::env::args_os())
}
