//! Links and commands in the documents are valid.

use std::path::{Path, PathBuf};
use std::process::Command;

use motionscope::session::lesson;
use motionscope_core::course::estimators;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The documents with their texts.
fn documents() -> Vec<(PathBuf, String)> {
    let in_docs = std::fs::read_dir(root().join("docs")).expect("the folder of the documents");
    let pages = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "core/README.md"];
    let at_root = pages.map(|name| root().join(name));
    let paths = in_docs.map(|entry| entry.expect("a document").path()).chain(at_root);
    let are_texts = paths.filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    are_texts.map(|path| (path.clone(), std::fs::read_to_string(&path).expect("a text"))).collect()
}

/// The targets of the links and pictures of a text.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    text.split("](").skip(1).filter_map(|rest| rest.split(')').next())
}

#[test]
fn every_relative_link_leads_to_a_file_and_its_heading() {
    let (mut faults, mut count) = (Vec::new(), 0);
    for (path, text) in documents() {
        let is_elsewhere = |target: &&str| target.contains("://") || target.starts_with("lesson:");
        for target in targets(&text).filter(|target| !is_elsewhere(target)) {
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let leads_to = if file.is_empty() { path.clone() } else { path.with_file_name(file) };
            let has_heading = || {
                let slug = |line: &str| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
                let page = std::fs::read_to_string(&leads_to).unwrap_or_default();
                page.lines().any(|line| line.starts_with('#') && slug(line) == heading)
            };
            count += 1;
            if !leads_to.exists() || !heading.is_empty() && !has_heading() {
                faults.push(format!("{}: {target}", path.display()));
            }
        }
    }
    assert!(count > 15, "only {count} links were read");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Paths in ARCHITECTURE begin at the root, at one of the two sources, or in the folder of the window.
#[test]
fn every_file_and_folder_of_the_map_exists() {
    let text = text_of("ARCHITECTURE.md");
    let in_code = text.split('`').skip(1).step_by(2);
    let paths: Vec<_> = in_code.filter(|code| code.ends_with(".rs") || code.ends_with('/')).collect();
    let bases = ["", "core/src", "src", "src/ui"].map(|base| root().join(base));
    let missing: Vec<_> = paths.iter().filter(|path| !bases.iter().any(|base| base.join(path).exists())).collect();
    assert!(paths.len() > 50, "only {} paths were read", paths.len());
    assert!(missing.is_empty(), "{missing:?}");
}

/// The commands of the program that stand in blocks of code, without the remarks behind them.
fn commands(text: &str) -> Vec<String> {
    let in_blocks = text.split("```").skip(1).step_by(2);
    let lines = in_blocks.flat_map(str::lines).filter_map(|line| line.strip_prefix("motionscope "));
    lines.map(|line| line.split("   ").next().unwrap_or_default().trim().to_owned()).collect()
}

#[test]
fn every_command_is_read_by_the_program() {
    let mut count = 0;
    for (path, text) in documents() {
        for command in commands(&text) {
            count += 1;
            // Help is printed in place of the run, once all that stands before it was understood.
            let mut program = Command::new(env!("CARGO_BIN_EXE_motionscope"));
            let told = program.args(command.split_whitespace()).arg("--help").output().expect("the program runs");
            let why = String::from_utf8_lossy(&told.stderr);
            assert!(told.status.success(), "{}: {command}: {why}", path.display());
        }
    }
    assert!(count > 40, "only {count} commands were read");
}

fn text_of(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).expect("a text")
}

#[test]
fn the_newest_changes_are_those_of_the_version() {
    let changes = text_of("CHANGELOG.md");
    let newest = changes.lines().find_map(|line| line.strip_prefix("## ")).expect("a version");
    assert_eq!(newest.split(',').next(), Some(env!("CARGO_PKG_VERSION")));
}

#[test]
fn estimators_and_lessons_are_counted_right() {
    let estimators = estimators().len();
    assert!(text_of("README.md").contains(&format!("{estimators} estimators")), "there are {estimators} estimators");
    assert!(
        text_of("core/README.md").contains(&format!("There are {estimators},")),
        "there are {estimators} estimators"
    );
    let lessons = lesson::all().len();
    assert!(text_of("README.md").contains(&format!("{lessons} lessons")), "there are {lessons} lessons");
}
