//! `cargo xtask web` builds the page of a browser, `cargo xtask serve` serves it on this machine.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context as _, Result, bail};
use xtask::{Server, page};

const USAGE: &str = "usage: cargo xtask web [--out FOLDER] [--profile PROFILE] [--shrink]
       cargo xtask serve [FOLDER] [--port PORT]";

fn main() -> ExitCode {
    match run(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut args: impl Iterator<Item = String>) -> Result<()> {
    match args.next().as_deref() {
        Some("web") => web(args),
        Some("serve") => serve(args),
        _ => bail!("{USAGE}"),
    }
}

fn web(mut args: impl Iterator<Item = String>) -> Result<()> {
    let (mut out, mut options) = (xtask::default_folder(), page::Options::default());
    while let Some(flag) = args.next() {
        match flag.as_str() {
            "--shrink" => options.shrink = true,
            "--out" => out = PathBuf::from(args.next().context(USAGE)?),
            "--profile" => options.profile = Some(args.next().context(USAGE)?),
            _ => bail!("{USAGE}"),
        }
    }
    page::build(&out, &options)
}

fn serve(mut args: impl Iterator<Item = String>) -> Result<()> {
    let (mut folder, mut port) = (xtask::default_folder(), 8080);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--port" => port = args.next().context(USAGE)?.parse()?,
            name if !name.starts_with('-') => folder = PathBuf::from(name),
            _ => bail!("{USAGE}"),
        }
    }
    let server = Server::start(folder, "/", port)?;
    println!("Motionscope is at {}; Ctrl+C ends it.", server.address());
    server.wait();
    Ok(())
}
