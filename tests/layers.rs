//! The layers of the app: each takes from those before it, never from one above.

#[path = "../core/tests/imports/mod.rs"]
mod imports;

use std::path::Path;

use imports::{Imports, Layers};

/// The folders and files of `src` from the ground up.
const LAYERS: &Layers = &[
    &["work"],
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
const WITHOUT_CIRCLES: &Layers =
    &[&["work"], &["paint"], &["experiment"], &["view"], &["results"], &["session"], &["search"], &["ui"], &["cli"]];

#[test]
fn no_import_of_the_app_runs_back_up_or_in_a_circle() {
    let imports = Imports::below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    assert!(imports.count() > 800, "only {} imports were read", imports.count());
    let faults = [imports.faults(LAYERS), imports.circles(WITHOUT_CIRCLES)].concat();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
