//! The layers of the core: each takes from those before it, never from one above.

use std::path::Path;

use crate::imports::{Imports, Layers};

/// The folders of `core/src` from the ground up.
const LAYERS: &Layers = &[
    &["base"],
    &["geometry"],
    &["params"],
    &["data"],
    &["synth"],
    &["scene"],
    &["products"],
    &["run"],
    &["methods"],
    &["families"],
    &["course"],
];

#[test]
fn no_import_of_the_core_runs_back_up_or_in_a_circle() {
    let imports = Imports::below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    assert!(imports.count() > 1500, "only {} imports were read", imports.count());
    let faults = [imports.faults(LAYERS), imports.circles(LAYERS)].concat();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

const TOY: &Layers = &[&["low"], &["left", "right"], &["high"]];

fn faults(files: &[(&str, &str)]) -> Vec<String> {
    let imports = Imports::of(files.iter().copied());
    [imports.faults(TOY), imports.circles(TOY)].concat()
}

#[test]
fn an_arrow_that_runs_back_up_is_found_wherever_it_is_written() {
    let lib = ("lib.rs", "mod low;\nmod high;\npub use high::Tower;\n");
    let high = [("high/mod.rs", "pub mod tower;\npub use tower::Tower;"), ("high/tower.rs", "use crate::low::Stone;")];
    let with = |text: &str| faults(&[&[lib, ("low/mod.rs", text)], &high[..]].concat());
    assert_eq!(with("pub struct Stone;"), Vec::<String>::new());
    for (text, line) in [
        ("use crate::high::Tower;", 1),
        ("// Of a tower.\nuse crate::{\n    high::tower::Tower,\n};", 2),
        // Through the root, which hands it on.
        ("use crate::Tower;", 1),
        ("\nfn of() -> crate::Tower {}", 2),
        ("fn of() {\n    super::high::tower::raise()\n}", 2),
        ("macro_rules! raise { () => { $crate::Tower } }", 1),
    ] {
        let found = with(text);
        assert_eq!(found.len(), 1, "{text}: {found:?}");
        assert!(found[0].starts_with(&format!("low/mod.rs:{line}: low → high (")), "{}", found[0]);
        assert!(found[0].ends_with("runs back up"), "{}", found[0]);
    }
    for text in [
        "#[cfg(test)]\nmod tests {\n    use crate::high::Tower;\n}",
        "// use crate::high::Tower;",
        "const TEXT: &str = \"use crate::high::Tower;\";",
        "use std::high::Tower;",
    ] {
        assert_eq!(with(text), Vec::<String>::new(), "{text}");
    }
}

#[test]
fn rooms_side_by_side_and_circles_are_reported() {
    let side = faults(&[("left.rs", "use crate::right::R;"), ("right.rs", "pub struct R;")]);
    assert_eq!(side, ["left.rs:1: left → right (R) runs to the side"]);
    let circle = [
        ("low/mod.rs", "mod a;\nmod b;\npub use a::A;\npub use b::B;"),
        ("low/a.rs", "use super::B;\npub struct A;"),
        ("low/b.rs", "pub struct B;\nfn of() -> crate::low::A {}"),
    ];
    let told =
        ["low/a.rs:1: low/a → low/b (B) is part of a circle", "low/b.rs:2: low/b → low/a (A) is part of a circle"];
    assert_eq!(faults(&circle), told);
    assert_eq!(faults(&[("attic.rs", "")]), ["attic.rs: belongs to no layer"]);
}

#[test]
fn circles_of_files_inside_a_room_are_reported() {
    let room = [
        ("low/a/mod.rs", "mod x;\nmod y;\nmod z;"),
        ("low/a/x.rs", "use super::y::Y;\npub struct X;"),
        ("low/a/y.rs", "\nuse super::z::Z;\npub struct Y;"),
        ("low/a/z.rs", "pub struct Z;\nfn of() -> super::x::X {}"),
    ];
    let told = [
        "low/a/x.rs:1: low/a/x → low/a/y (Y) is part of a circle",
        "low/a/y.rs:2: low/a/y → low/a/z (Z) is part of a circle",
        "low/a/z.rs:2: low/a/z → low/a/x (X) is part of a circle",
    ];
    assert_eq!(faults(&room), told);
    // A file and those in the folder of its name are one.
    let family = [("low/a.rs", "mod x;\nuse x::X;\npub struct A;"), ("low/a/x.rs", "use super::A;\npub struct X;")];
    assert_eq!(faults(&family), Vec::<String>::new());
}

#[test]
fn a_macro_belongs_to_the_file_that_declares_it() {
    let declared = "#[macro_export]\nmacro_rules! tower {\n    () => {};\n}";
    let found = faults(&[("lib.rs", ""), ("high/plan.rs", declared), ("low/a.rs", "use crate::tower;")]);
    assert_eq!(found, ["low/a.rs:1: low → high (tower) runs back up"]);
}

/// The files below `folder` with what they contain.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(folder).expect("a folder of the core").map(|entry| entry.expect("an entry").path());
    let below = |path: std::path::PathBuf| match path.is_dir() {
        true => sources(&path),
        false => vec![(path.display().to_string(), std::fs::read_to_string(&path).expect("a text"))],
    };
    entries.flat_map(below).collect()
}

#[test]
fn the_core_asks_the_time_in_timelines_only() {
    let all = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let asking: Vec<_> = all
        .iter()
        .filter(|(_, text)| ["Instant", "SystemTime"].iter().any(|clock| text.contains(clock)))
        .map(|(name, _)| name)
        .collect();
    assert!(all.len() > 150 && asking.len() == 1, "{asking:?} of {} files", all.len());
    assert!(Path::new(asking[0]).ends_with("run/timeline.rs"), "{asking:?}");
}
