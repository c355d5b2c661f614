//! Reads what the files of a crate take from each other, and holds that to the layers that were declared.
//!
//! A crate's layers are the folders and files beside its `lib.rs`. Test code is not read, and neither are the roots
//! `lib.rs` and `main.rs`, which stand above all layers.

mod source;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use source::{Source, Use};

/// A module's place in its crate: `["data", "clip"]` is `data/clip.rs`; the crate's root has none.
type Module = Vec<String>;

/// Layers from the ground up. Those of one row stand side by side, and take nothing from each other.
pub type Layers = [&'static [&'static str]];

/// All that the files of a crate take from each other.
pub struct Imports {
    sources: BTreeMap<Module, Source>,
    /// Macros that the crate's root has, by the file that declares them.
    macros: BTreeMap<String, Module>,
}

/// What one file takes from another.
struct Arrow {
    /// The file and line that say so.
    at: String,
    from: Module,
    to: Module,
    name: String,
}

impl Imports {
    /// Of all files below `folder`, the crate's `src`.
    pub fn below(folder: &Path) -> Self {
        let mut files = Vec::new();
        collect(folder, folder, &mut files);
        Self::of(files.iter().map(|(path, text)| (path.as_str(), text.as_str())))
    }

    /// Of files with these paths below `src`, and their texts.
    pub fn of<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let sources: BTreeMap<_, _> =
            files.into_iter().map(|(path, text)| (module_of(path), Source::read(path, text))).collect();
        let macros = sources
            .iter()
            .flat_map(|(module, source)| source.macros.iter().map(move |name| (name.clone(), module.clone())))
            .collect();
        Self { sources, macros }
    }

    /// What breaks the layers: files in none, and imports that run back up or to the side. A line for each, with file and line.
    pub fn faults(&self, layers: &Layers) -> Vec<String> {
        let place = |layer: &str| layers.iter().position(|row| row.contains(&layer));
        let mut faults: Vec<String> = self
            .sources
            .iter()
            .filter(|(module, _)| module.first().is_some_and(|layer| place(layer).is_none()))
            .map(|(_, source)| format!("{}: belongs to no layer", source.path))
            .collect();
        let arrows = self.arrows();
        for arrow in &arrows {
            let (Some(from), Some(to)) = (arrow.from.first(), arrow.to.first()) else { continue };
            let (Some(low), Some(high)) = (place(from), place(to)) else { continue };
            let told = format!("{}: {from} → {to} ({})", arrow.at, arrow.name);
            if high > low {
                faults.push(format!("{told} runs back up"));
            } else if high == low && from != to {
                faults.push(format!("{told} runs to the side"));
            }
        }
        faults
    }

    /// The circles among files, and among the rooms of these layers: their files and folders. A line for each import that closes
    /// one. A file and the folder of its own name are one: they may take from each other.
    pub fn circles(&self, layers: &Layers) -> Vec<String> {
        let mut arrows = self.arrows();
        // Between layers an import that closes a circle runs back up.
        arrows.retain(|arrow| arrow.from[0] == arrow.to[0]);
        let is_inside = |a: &Module, b: &Module| a.starts_with(b) || b.starts_with(a);
        let files = arrows.iter().filter(|arrow| !is_inside(&arrow.from, &arrow.to));
        let files = files.map(|arrow| (arrow.from.join("/"), arrow.to.join("/"), arrow));
        let room = |module: &Module| (module.len() > 1).then(|| module[..2].join("/"));
        let rooms = arrows.iter().filter(|arrow| layers.iter().any(|row| row.contains(&arrow.from[0].as_str())));
        let rooms = rooms.filter_map(|arrow| Some((room(&arrow.from)?, room(&arrow.to)?, arrow)));
        let faults: BTreeSet<String> = circles(files).into_iter().chain(circles(rooms)).collect();
        faults.into_iter().collect()
    }

    /// How many imports there are from file to file.
    pub fn count(&self) -> usize {
        self.arrows().len()
    }

    fn arrows(&self) -> Vec<Arrow> {
        let mut arrows = Vec::new();
        for (module, source) in &self.sources {
            // A face that only hands a name on takes nothing for itself.
            let own = source.uses.iter().filter(|used| !(used.is_public && source.is_face));
            for Use { path, line, .. } in own {
                let Some(to) = self.definition(module, path, 0) else { continue };
                if to == *module || to.is_empty() || module.is_empty() {
                    continue;
                }
                let name = path.last().cloned().unwrap_or_default();
                arrows.push(Arrow { at: format!("{}:{line}", source.path), from: module.clone(), to, name });
            }
        }
        arrows
    }

    /// The module that defines what `module` calls `path`; none where that is of another crate.
    fn definition(&self, module: &[String], path: &[String], depth: usize) -> Option<Module> {
        const DEEPEST: usize = 8;
        let (first, rest) = path.split_first()?;
        let child = || [module, std::slice::from_ref(first)].concat();
        let absolute = match first.as_str() {
            "crate" => rest.to_vec(),
            "self" => [module, rest].concat(),
            "super" => {
                let up = path.iter().take_while(|part| *part == "super").count();
                [&module[..module.len().checked_sub(up)?], &path[up..]].concat()
            }
            _ if self.sources.contains_key(&child()) => [module, path].concat(),
            _ => return None,
        };
        let known = (0..=absolute.len()).rev().find(|&length| self.sources.contains_key(&absolute[..length]))?;
        let (found, rest) = absolute.split_at(known);
        let Some(name) = rest.first() else { return Some(found.to_vec()) };
        if found.is_empty()
            && let Some(declared) = self.macros.get(name)
        {
            return Some(declared.clone());
        }
        let handed_on = self.sources[found].uses.iter().find(|used| used.is_public && used.name == *name);
        match handed_on.filter(|_| depth < DEEPEST) {
            Some(used) => self
                .definition(found, &[&used.path[..], &rest[1..]].concat(), depth + 1)
                .or_else(|| Some(found.to_vec())),
            None => Some(found.to_vec()),
        }
    }
}

/// The arrows that are part of a circle, as sentences.
fn circles<'a>(arrows: impl Iterator<Item = (String, String, &'a Arrow)>) -> Vec<String> {
    let mut edges: BTreeMap<String, BTreeMap<String, &Arrow>> = BTreeMap::new();
    for (from, to, arrow) in arrows.filter(|(from, to, _)| from != to) {
        edges.entry(from).or_default().entry(to).or_insert(arrow);
    }
    let reached = |start: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![start]);
        while let Some(at) = open.pop() {
            open.extend(edges.get(at).into_iter().flat_map(BTreeMap::keys).filter(|to| seen.insert((*to).clone())));
        }
        seen
    };
    let in_circles: BTreeSet<&String> = edges.keys().filter(|start| reached(start).contains(*start)).collect();
    let mut faults = Vec::new();
    for from in &in_circles {
        for (to, arrow) in edges.get(*from).into_iter().flatten() {
            if in_circles.contains(to) && reached(to).contains(*from) {
                faults.push(format!("{}: {from} → {to} ({}) is part of a circle", arrow.at, arrow.name));
            }
        }
    }
    faults
}

fn module_of(path: &str) -> Module {
    let mut parts: Module = path.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
    if parts.last().is_some_and(|last| last == "mod")
        || parts.len() == 1 && ["lib", "main"].contains(&parts[0].as_str())
    {
        parts.pop();
    }
    parts
}

fn collect(root: &Path, folder: &Path, files: &mut Vec<(String, String)>) {
    for entry in std::fs::read_dir(folder).expect("the sources are there") {
        let path = entry.expect("a file").path();
        if path.is_dir() {
            collect(root, &path, files);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let below = path.strip_prefix(root).expect("it lies below").components();
            let name: Vec<_> = below.map(|part| part.as_os_str().to_string_lossy()).collect();
            // The binary's root has the library's place.
            if name != ["main.rs"] {
                files.push((name.join("/"), std::fs::read_to_string(&path).expect("text")));
            }
        }
    }
}
