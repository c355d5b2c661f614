//! What estimators say is the language of the field.

use crate::walks::ALL;

/// Writes what every estimator says into the folder `PRINT_TEXTS`, a file for each, for whoever reads it as an editor.
#[test]
fn every_estimator_says_something_at_each_place() {
    for (estimator, seen) in ALL.iter() {
        let id = estimator.info().id;
        let count = |place| seen.texts.iter().filter(|(other, _)| *other == place).count();
        assert!(count("sentence") > 2 && count("legend") > 0 && count("parameter") > 0, "{id} says too little");
        if let Some(folder) = std::env::var_os("PRINT_TEXTS") {
            let lines: Vec<String> = seen.texts.iter().map(|(place, text)| format!("{place:<11} | {text}\n")).collect();
            let path = std::path::Path::new(&folder).join(format!("{id}.txt"));
            std::fs::write(path, lines.concat()).expect("a folder that can be written");
        }
    }
}
