//! The folder of the page: the program, packed, and the files of `web/`, which name it.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use flate2::{Compression, write::GzEncoder};

use crate::{bindings, program, root, shrink};

/// The profiles of the root `Cargo.toml` for the page, and for one that is as small as possible.
const PROFILE: &str = "page";
const SMALL: &str = "published";

/// The file by which a folder is recognised as one that this command wrote.
const MARK: &str = "service-worker.js";

/// The files of `web/` whose names change with each build, so that a browser may keep them for good.
const HASHED: [&str; 1] = ["start.js"];

/// A file of the page: its name, relative to the folder, and its content.
struct File {
    name: String,
    content: Vec<u8>,
}

/// How the page is built.
#[derive(Debug, Default)]
pub struct Options {
    /// A profile of the root `Cargo.toml`, if not the usual one.
    pub profile: Option<String>,
    /// Whether the program is as small as possible, which takes many minutes.
    pub shrink: bool,
}

/// Builds the page into a folder, in place of an older one there.
///
/// # Errors
/// If the program cannot be compiled, or the folder holds other files or cannot be written.
pub fn build(out: &Path, options: &Options) -> Result<()> {
    let is_free = fs::read_dir(out).map_or(true, |mut files| files.next().is_none()) || out.join(MARK).exists();
    ensure!(is_free, "{} holds other files; name an empty folder with --out", out.display());
    let usual = if options.shrink { SMALL } else { PROFILE };
    let module = program::compile(options.profile.as_deref().unwrap_or(usual))?;
    let work = root().join("target/xtask/page");
    clear(&work)?;
    bindings::generate(&module, "motionscope", &work)?;
    let module = work.join("motionscope_bg.wasm");
    if options.shrink {
        shrink::shrink(&module)?;
    }
    let program = fs::read(&module)?;
    let packed = pack(&program)?;
    println!("The program has {}, {} as downloaded.", megabytes(&program), megabytes(&packed));
    fs::remove_file(module)?;
    let mut files = read_folder(&work)?;
    files.push(File { name: "motionscope.bin".into(), content: packed });
    files.extend(read_folder(&root().join("web"))?);
    clear(out)?;
    for file in finish(files) {
        let path = out.join(&file.name);
        fs::create_dir_all(path.parent().unwrap_or(out))?;
        fs::write(&path, file.content).with_context(|| format!("{} cannot be written", path.display()))?;
    }
    println!("The page is in {}.", out.display());
    Ok(())
}

/// An empty folder in place of what was there.
fn clear(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder)?;
    }
    fs::create_dir_all(folder).with_context(|| format!("{} cannot be created", folder.display()))
}

/// Packs the program, because many servers of files send it as it is. The page unpacks it while it arrives.
fn pack(program: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(program)?;
    Ok(encoder.finish()?)
}

fn megabytes(content: &[u8]) -> String {
    format!("{:.2} MB", content.len() as f64 / 1e6)
}

/// All files below a folder, in the order of their names.
fn read_folder(folder: &Path) -> Result<Vec<File>> {
    let (mut folders, mut paths) = (vec![folder.to_owned()], Vec::new());
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next)? {
            let path = entry?.path();
            if path.is_dir() { folders.push(path) } else { paths.push(path) }
        }
    }
    paths.sort();
    paths.iter().map(|path| Ok(File { name: name_below(folder, path)?, content: fs::read(path)? })).collect()
}

fn name_below(folder: &Path, path: &Path) -> Result<String> {
    let parts: PathBuf = path.strip_prefix(folder)?.into();
    let parts = parts.iter().map(|part| part.to_str().context("the name of a file is not in Unicode"));
    Ok(parts.collect::<Result<Vec<_>>>()?.join("/"))
}

/// Gives the files the names under which they are served, and fills in what the files of `web/` say about the build.
fn finish(files: Vec<File>) -> Vec<File> {
    let hash = hash(&files);
    let size = files.iter().find(|file| file.name == "motionscope.bin").map_or(0, |file| file.content.len());
    let names: Vec<_> = files.iter().map(|file| served_name(&file.name, &hash)).collect();
    let cached: Vec<_> = names.iter().filter(|name| **name != MARK && **name != "index.html").collect();
    let cached = format!("{cached:?}");
    let fill = |content: Vec<u8>| match String::from_utf8(content) {
        Ok(text) => {
            let text = text.replace("@hash@", &hash).replace("@files@", &cached);
            text.replace("@packed@", &size.to_string()).into_bytes()
        }
        Err(other) => other.into_bytes(),
    };
    files.into_iter().zip(names).map(|(file, name)| File { name, content: fill(file.content) }).collect()
}

fn served_name(name: &str, hash: &str) -> String {
    match name.rsplit_once('.') {
        Some((stem @ "motionscope", ending)) => format!("{stem}-{hash}.{ending}"),
        Some((stem, ending)) if HASHED.contains(&name) => format!("{stem}-{hash}.{ending}"),
        _ => name.to_owned(),
    }
}

/// The FNV-1a hash of names and contents, as 16 digits.
fn hash(files: &[File]) -> String {
    let bytes = files.iter().flat_map(|file| file.name.bytes().chain(file.content.iter().copied()));
    let hash =
        bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    format!("{hash:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(program: &[u8]) -> Vec<(String, String)> {
        let file = |name: &str, content: &[u8]| File { name: name.into(), content: content.into() };
        let page = file("index.html", b"start-@hash@.js loads @packed@ bytes");
        let files = vec![page, file("motionscope.bin", program), file("start.js", b""), file(MARK, b"@files@")];
        finish(files).into_iter().map(|file| (file.name, String::from_utf8(file.content).expect("text"))).collect()
    }

    #[test]
    fn names_change_with_the_program_and_stand_in_the_page() {
        let [old, new] = [built(b"old"), built(b"newer")];
        assert_ne!(old[1].0, new[1].0);
        assert_eq!(old[0].0, "index.html");
        assert_eq!(old[0].1, format!("{} loads 3 bytes", old[2].0));
        assert_eq!(old[3].1, format!("[{:?}, {:?}]", old[1].0, old[2].0));
    }
}
