//! The layers of the app: each takes from those before it, never from one above.

#[path = "../core/tests/imports/mod.rs"]
mod imports;

use std::fs;
use std::path::{Path, PathBuf};

use imports::{Imports, Layers};

/// The folders and files of `src` from the ground up.
const LAYERS: &Layers = &[
    &["work"],
    &["files"],
    &["media"],
    &["paint"],
    &["experiment"],
    &["view"],
    &["results"],
    &["session"],
    &["search"],
    &["ui"],
    &["cli"],
];

/// Those whose files and folders take nothing from each other in a circle. No layer has circles of files.
const WITHOUT_CIRCLES: &Layers = &[
    &["work"],
    &["files"],
    &["paint"],
    &["experiment"],
    &["view"],
    &["results"],
    &["session"],
    &["search"],
    &["ui"],
    &["cli"],
];

#[test]
fn no_import_of_the_app_runs_back_up_or_in_a_circle() {
    let imports = Imports::below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    assert!(imports.count() > 800, "only {} imports were read", imports.count());
    let faults = [imports.faults(LAYERS), imports.circles(WITHOUT_CIRCLES)].concat();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The files of `src` that use the disk or other programs without the layer `files`: the command line, and those that start ffmpeg or
/// talk to cameras.
const OF_THE_DESKTOP: [&str; 9] = [
    "files/",
    "cli/",
    "main.rs",
    "media/camera/",
    "media/export/h264/ffmpeg.rs",
    "media/export/h264/watched.rs",
    "media/helper.rs",
    "media/video/ffmpeg.rs",
    "ui/desktop.rs",
];

#[test]
fn files_are_reached_by_one_layer() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&src, &mut files);
    let mut faults = Vec::new();
    for file in files {
        let name = file.strip_prefix(&src).expect("a file of src").to_string_lossy().replace('\\', "/");
        if OF_THE_DESKTOP.iter().any(|desktop| name.starts_with(desktop)) || name.ends_with("tests.rs") {
            continue;
        }
        let text = fs::read_to_string(&file).expect("a text");
        let code = text.lines().take_while(|line| !line.contains("#[cfg(test)]") && !line.contains("#[cfg(all(test"));
        for (number, line) in (1..).zip(code) {
            if let Some(what) = DIRECT.iter().find(|what| line.contains(*what) && !line.trim_start().starts_with("//"))
            {
                faults.push(format!("src/{name}:{number}: {what} instead of crate::files"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Ways around that layer.
const DIRECT: [&str; 11] = [
    "std::fs",
    "std::env",
    "std::process",
    "tempfile::",
    "std::path::absolute",
    ".exists()",
    ".is_file()",
    ".is_dir()",
    ".canonicalize()",
    ".metadata()",
    ".read_dir()",
];

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => collect(&path, files),
            false => files.push(path),
        }
    }
}
