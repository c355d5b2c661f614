//! Estimators declare themselves: no estimator, family, granularity or parameter is named in `src/`. Comments name things, too.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use motionscope_core::course::estimators;

/// Files that hold nothing but data about chosen estimators, and what they are for.
const DATA: [(&str, &str); 4] = [
    ("src/cli/examples.rs", "examples in the help"),
    ("src/experiment/course_table.rs", "the course's own table of three searches"),
    ("src/session/lesson/formula.rs", "letters and signs by their names in LaTeX"),
    ("src/experiment/first.rs", "what is opened, or stands beside another, where nothing is named"),
];

/// Words that are names of something else in the file that has them.
const OTHERWISE: [(&str, &str, &str); 53] = [
    ("src/cli/args.rs", "frame", "a flag"),
    ("src/cli/lessons.rs", "clip", "a key of the JSON"),
    ("src/cli/lessons.rs", "step", "a key of the JSON"),
    ("src/cli/list.rs", "clip", "a key of the JSON"),
    ("src/cli/list.rs", "frame", "a key of the JSON"),
    ("src/cli/list.rs", "frames", "a key of the JSON"),
    ("src/cli/list.rs", "source", "a key of the JSON"),
    ("src/cli/list.rs", "stage", "a type in the JSON"),
    ("src/media/sequence.rs", "flow", "the beginning of a file's name"),
    ("src/media/sequence.rs", "mask", "the beginning of a file's name"),
    ("src/media/truth/find.rs", "flow", "a folder of truth"),
    ("src/media/truth/find.rs", "disparity", "a folder"),
    ("src/media/truth/mod.rs", "disparity", "a kind of truth"),
    ("src/media/truth/mod.rs", "flow", "a kind of truth"),
    ("src/media/truth/mot.rs", "frame", "a column of the file"),
    ("src/media/truth/mot.rs", "identity", "a column of the file"),
    ("src/media/video/y4m.rs", "alpha", "a plane of the picture"),
    ("src/paint/charts/stack.rs", "level", "a level of a pyramid"),
    ("src/paint/layer.rs", "confidence", "a layer of colors"),
    ("src/paint/svg.rs", "fill", "an attribute of the format"),
    ("src/paint/wrap.rs", "frame", "a unit"),
    ("src/paint/wrap.rs", "frames", "a unit"),
    ("src/results/disparity.rs", "disparity", "a flag"),
    ("src/results/flow.rs", "flow", "a flag"),
    ("src/results/tracks.rs", "tracks", "a flag"),
    ("src/session/ink.rs", "size", "a key of the session"),
    ("src/session/read.rs", "size", "a key of the session"),
    ("src/session/ink.rs", "points", "a key of the session"),
    ("src/session/ink.rs", "step", "a key of the session"),
    ("src/session/lesson/read.rs", "predict", "a key of the page"),
    ("src/session/link/base.rs", "clip", "a key of the session"),
    ("src/session/link/mod.rs", "clip", "a key of the session"),
    ("src/session/link/mod.rs", "frame", "a key of the session"),
    ("src/session/link/mod.rs", "step", "a key of the session"),
    ("src/session/write.rs", "clip", "a key of the session"),
    ("src/session/read.rs", "clip", "a key of the session"),
    ("src/session/read.rs", "frame", "a key of the session"),
    ("src/session/read.rs", "object", "a key of the session"),
    ("src/session/read.rs", "pixel", "a key of the session"),
    ("src/session/read.rs", "step", "a key of the session"),
    ("src/session/read.rs", "zoom", "a key of the session"),
    ("src/ui/dialogs/compare.rs", "clip", "a granularity"),
    ("src/ui/drawing/arrows.rs", "gamma", "an entry point of a shader"),
    ("src/ui/model/document.rs", "stage", "a change that is undone"),
    ("src/experiment/mod.rs", "flow", "a kind of truth"),
    ("src/media/picture.rs", "hierarchical", "a process of JPEG"),
    ("src/media/truth/mot.rs", "object", "a column of the file"),
    ("src/paint/svg.rs", "round", "a value of the format"),
    ("src/view/motion.rs", "flow", "a kind of truth"),
    ("src/ui/commands/granularities.rs", "run", "the whole run, above all granularities"),
    ("src/ui/commands/granularities.rs", "step", "any granularity"),
    ("src/ui/panes/timeline.rs", "step", "any granularity"),
    ("src/view/panes.rs", "stage", "a pane"),
];

/// The names that the registry declares.
struct Names {
    /// Ids of estimators: not even inside a longer text.
    ids: BTreeSet<String>,
    /// Families, granularities and parameters: many of them are plain words, so only as a whole.
    others: BTreeSet<String>,
}

impl Names {
    fn declared() -> Self {
        let (mut ids, mut others) = (BTreeSet::new(), BTreeSet::new());
        for estimator in estimators() {
            let info = estimator.info();
            ids.insert(info.id.to_owned());
            others.extend([info.name, info.family].map(str::to_owned));
            others.extend(info.granularities.iter().map(|granularity| (*granularity).to_owned()));
            others.extend(estimator.all_values().into_iter().map(|(name, _)| name));
        }
        Self { ids, others }
    }

    /// The name that `literal` holds, if it holds one.
    fn named_in(&self, literal: &str) -> Option<String> {
        if self.others.contains(literal) || self.ids.contains(literal) {
            return Some(literal.to_owned());
        }
        let words = literal.split(|c: char| !c.is_ascii_alphanumeric() && c != '-');
        let found = words.filter(|word| word.contains('-')).find(|word| self.ids.contains(*word));
        found.or_else(|| self.chosen_in(literal)).map(str::to_owned)
    }

    /// An id without a hyphen may be a plain word; it is meant as an id where it is quoted, or where an estimator is chosen.
    fn chosen_in<'a>(&self, literal: &'a str) -> Option<&'a str> {
        let is_end = |c: char| !c.is_ascii_alphanumeric() && c != '-';
        let quoted = literal.split('`').skip(1).step_by(2);
        let behind =
            |begin: &'static str| literal.split(begin).skip(1).filter_map(move |rest| rest.split(is_end).next());
        let chosen = ["--estimator ", "--estimator=", "estimator=", "--beside ", "--beside="].map(behind);
        quoted.chain(chosen.into_iter().flatten()).find(|word| self.ids.contains(*word))
    }
}

/// Every text in quotes with its line, but those of comments and of tests.
fn literals(source: &str) -> Vec<(usize, String)> {
    let code = source.split("#[cfg(test)]").next().unwrap_or(source);
    let mut found = Vec::new();
    let (mut chars, mut line) = (code.chars().peekable(), 1);
    while let Some(c) = chars.next() {
        match c {
            '\n' => line += 1,
            '/' if chars.peek() == Some(&'/') => while chars.next_if(|c| *c != '\n').is_some() {},
            '\'' => {
                // A character, or a lifetime: '"' must not begin a text.
                if chars.next_if_eq(&'\\').is_some() {
                    chars.next();
                } else if chars.next_if_eq(&'"').is_some() {
                    chars.next_if_eq(&'\'');
                }
            }
            '"' => {
                let (begun, mut text) = (line, String::new());
                while let Some(c) = chars.next() {
                    match c {
                        '"' => break,
                        '\\' => text.extend(chars.next()),
                        '\n' => {
                            line += 1;
                            text.push(c);
                        }
                        c => text.push(c),
                    }
                }
                found.push((begun, text));
            }
            _ => {}
        }
    }
    found
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).expect("a folder of sources");
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
}

#[test]
fn the_app_names_no_estimator() {
    let (root, names) = (Path::new(env!("CARGO_MANIFEST_DIR")), Names::declared());
    let mut files = Vec::new();
    sources(&root.join("src"), &mut files);
    files.sort();
    let (mut read, mut wrong, mut excused) = (0, Vec::new(), BTreeSet::new());
    for path in &files {
        let name = path.strip_prefix(root).expect("below the root").to_string_lossy().replace('\\', "/");
        if DATA.iter().any(|(file, _)| *file == name) {
            continue;
        }
        for (line, literal) in literals(&fs::read_to_string(path).expect("a source")) {
            read += 1;
            let Some(named) = names.named_in(&literal) else { continue };
            if let Some(reason) = OTHERWISE.iter().find(|(file, word, _)| *file == name && *word == named) {
                excused.insert(*reason);
            } else {
                wrong.push(format!("{name}:{line}: {literal:?} names {named}"));
            }
        }
    }
    assert!(read > 1500, "only {read} texts were read");
    assert!(wrong.is_empty(), "let the estimator declare what the app needs to know:\n{}", wrong.join("\n"));
    assert_eq!(excused.len(), OTHERWISE.len(), "an excuse is not needed any more: {excused:?}");
    for (file, _) in DATA {
        assert!(root.join(file).is_file(), "{file} is gone");
    }
}

/// The openings of a noun clause that stands for a name.
const OPENINGS: [&str; 6] = ["What ", "Whoever ", "Those of ", "So many ", "As far as ", "Of what "];
/// Phrases in comments that name nothing.
const PHRASES: [&str; 10] = [
    "so many",
    "at hand",
    "worked out",
    "nobody",
    "someone",
    "gives up",
    "on its way",
    "became of",
    "what is left",
    "not wanted any more",
];
/// Folders in which comments have none of these.
const PLAIN: [&str; 4] = ["core/src/families/", "core/src/methods/", "core/src/products/", "core/src/run/"];
/// The number of such comments in all other folders; it only goes down.
const LEFT: usize = 766;

/// Every comment of `source` with its first line: lines that follow each other are one comment.
fn comments(source: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut is_comment = false;
    for (i, line) in source.lines().map(str::trim_start).enumerate() {
        let text = line.trim_start_matches(['/', '!']).trim();
        match found.last_mut().filter(|_| is_comment && line.starts_with("//")) {
            Some((_, comment)) => *comment = format!("{comment} {text}"),
            None if line.starts_with("//") => found.push((i + 1, text.to_owned())),
            None => {}
        }
        is_comment = line.starts_with("//");
    }
    found
}

fn is_plain(comment: &str) -> bool {
    let opens = OPENINGS.iter().any(|opening| comment.starts_with(opening));
    !opens && !PHRASES.iter().any(|phrase| comment.contains(phrase))
}

#[test]
fn comments_name_the_thing() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    ["core/src", "src"].iter().for_each(|folder| sources(&root.join(folder), &mut files));
    let (mut wrong, mut left, mut read) = (Vec::new(), 0, 0);
    for path in &files {
        let name = path.strip_prefix(root).expect("below the root").to_string_lossy().replace('\\', "/");
        let all = comments(&fs::read_to_string(path).expect("a source"));
        read += all.len();
        for (line, comment) in all.into_iter().filter(|(_, comment)| !is_plain(comment)) {
            match PLAIN.iter().any(|folder| name.starts_with(folder)) {
                true => wrong.push(format!("{name}:{line}: {comment}")),
                false => left += 1,
            }
        }
    }
    assert!(read > 10_000, "only {read} comments were read");
    assert!(wrong.is_empty(), "name the thing, or the reason:\n{}", wrong.join("\n"));
    assert_eq!(
        left, LEFT,
        "comments elsewhere that do not name the thing: mend new ones, and lower LEFT for those that are gone"
    );
    let told = ["What it is.", "The threads that are left.", "The pixels at hand.", "The state at its end."];
    assert_eq!(told.map(is_plain), [false, true, false, true]);
    assert_eq!(comments("/// Of\n/// two.\nfn f() {} // no\n// x"), [(1, "Of two.".to_owned()), (4, "x".to_owned())]);
}

#[test]
fn texts_are_read_as_the_compiler_reads_them() {
    let source =
        "let a = \"diamond\"; // \"not\" this\nlet b = '\"'; let c = \"two \\\"words\\\"\";\n#[cfg(test)] \"no\"";
    let found = literals(source);
    assert_eq!(found, [(1, "diamond".to_owned()), (2, "two \"words\"".to_owned())]);
    let names = Names::declared();
    assert_eq!(names.named_in("run CLIP --estimator full-search --x").as_deref(), Some("full-search"));
    assert_eq!(names.named_in("diamond").as_deref(), Some("diamond"));
    for text in
        ["run CLIP --estimator klt", "say estimator=klt here", "choose `klt`, for example", "--beside=klt,harris"]
    {
        assert_eq!(names.named_in(text).as_deref(), Some("klt"), "{text}");
    }
    assert_eq!(names.named_in("the klt of `x`, and a diamond"), None);
    assert_eq!(names.named_in("a full search"), None);
}
