//! What the program says around the estimators: its window, its help and its lists speak as the field does.
//!
//! Texts of estimators are read by `core/tests/laws/language`, by the same rules.

use motionscope::session::lesson::all;
use motionscope_core::course::estimators;

use super::*;

#[path = "../../core/tests/laws/language/rules.rs"]
mod rules;

/// Words that are typed or are no prose: names of files, options, parameters and their values.
fn is_typed(word: &str) -> bool {
    let word = word.trim_matches(|c: char| "()[]`'\".,;:".contains(c));
    word.starts_with('-') || word.contains(['/', '=', '_', '\\']) || word.starts_with("synth:")
}

/// The text without what is typed.
fn prose(text: &str) -> String {
    text.split_whitespace().filter(|word| !is_typed(word)).collect::<Vec<_>>().join(" ")
}

pub(super) fn check<'a>(texts: impl IntoIterator<Item = (&'a str, String)>) -> usize {
    let (mut faults, mut count) = (Vec::new(), 0);
    for (place, text) in texts {
        count += 1;
        let found = rules::faults(&prose(&text), true).into_iter();
        faults.extend(found.map(|fault| format!("{place}: {fault}: {text}")));
    }
    faults.sort();
    faults.dedup();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    count
}

/// What everything in the window is called, and what it says.
pub(super) fn labels(window: &Window) -> Vec<String> {
    let all = window.harness.root().children_recursive();
    let said = |node: &egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        // What a person typed, or what files are called, is not the program's.
        if node.role() == Role::TextInput { None } else { node.label().or_else(|| node.value()) }
    };
    all.filter_map(|node| said(&node)).collect()
}

/// Lines that a command prints; those of examples are typed.
fn printed(arguments: &[&str]) -> Vec<String> {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_motionscope")).args(arguments).output();
    let output = output.expect("the program runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines().filter(|line| !line.trim_start().starts_with("motionscope ")).map(str::to_owned).collect()
}

#[test]
fn commands_and_options_are_named_as_the_field_does() {
    let granularities = Granularities::new(&["frame", "block", "step"]);
    let commands = Command::ALL.iter().flat_map(|command| [command.text(&granularities), command.tip(&granularities)]);
    let options = Look::entries().iter().map(|spec| spec.doc.to_owned());
    let exports = EXPORTS.iter().map(|export| export.help.to_owned());
    let commands = commands.map(|text| ("command", text));
    let count = check(commands.chain(options.map(|text| ("option", text))).chain(exports.map(|text| ("export", text))));
    assert!(count > 180, "{count} texts");
}

#[test]
fn help_and_lists_speak_as_the_field_does() {
    let mut lines = Vec::new();
    for arguments in [
        &["--help"][..],
        &["list"],
        &["list", "full-search", "horn-schunck", "camshift", "running-average"],
        &["synth", "--list"],
        &["glossary"],
        &["lessons"],
        &["search", "gradient"],
    ] {
        lines.extend(printed(arguments).into_iter().map(|line| ("printed", line)));
    }
    for command in ["list", "glossary", "search", "lessons", "info", "synth", "camera", "run", "export", "compare"] {
        lines.extend(printed(&[command, "--help"]).into_iter().map(|line| ("help", line)));
    }
    let count = check(lines);
    assert!(count > 500, "{count} lines");
}

#[test]
fn lessons_speak_as_the_field_does() {
    let mut said = Vec::new();
    for lesson in all() {
        let titles = lesson.pages.iter().map(|page| page.title.clone());
        said.extend(titles.chain([lesson.title.clone(), lesson.summary.clone()]).map(|text| (&*lesson.slug, text)));
        for page in &lesson.pages {
            let words = page.words.as_ref().expect("words").plain();
            said.extend(words.lines().chain([page.notes.as_str()]).map(|line| (&*lesson.slug, line.to_owned())));
        }
    }
    let count = check(said);
    assert!(count > 200, "{count} texts");
}

#[test]
fn the_window_speaks_as_the_field_does() {
    let mut said = Vec::new();
    for estimator in estimators().iter().step_by(4) {
        let id = estimator.info().id;
        let mut window = objects::window(id, "0.0");
        for key in [Key::PageDown, Key::ArrowRight, Key::End] {
            window.key(key);
            said.extend(labels(&window).into_iter().map(|text| (id, text)));
        }
    }
    let dialogs = [
        Command::Open,
        Command::StartPage,
        Command::Estimators,
        Command::SearchText,
        Command::Samples,
        Command::SaveClip,
        Command::Lessons,
        Command::ExportPicture,
        Command::ExportResult,
        Command::ExportSteps,
        Command::Compare,
        Command::Palette,
        Command::Shortcuts,
        Command::About,
    ];
    for dialog in dialogs {
        let mut window = Window::usual();
        window.command(dialog);
        let texts = labels(&window);
        assert!(!texts.is_empty());
        said.extend(texts.into_iter().map(|text| ("a dialog", text)));
    }
    let count = check(said);
    assert!(count > 1500, "{count} texts");
}
