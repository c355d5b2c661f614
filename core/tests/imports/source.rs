//! One file: the names that it uses, and where it says so.

/// A file of a crate as far as imports go.
pub struct Source {
    /// Where it lies below `src`.
    pub path: String,
    /// What it takes and hands on.
    pub uses: Vec<Use>,
    /// Macros that it declares for the crate's root.
    pub macros: Vec<String>,
    /// Whether it is the `mod.rs` of a folder, or the crate's root.
    pub is_face: bool,
}

/// A name that a file uses.
pub struct Use {
    /// As it is written: `["crate", "data", "Clip"]`.
    pub path: Vec<String>,
    /// What it is called from there on.
    pub name: String,
    /// The line, from 1.
    pub line: usize,
    /// Whether it is handed on.
    pub is_public: bool,
}

impl Source {
    /// Reads a file.
    pub fn read(path: &str, text: &str) -> Self {
        let text = without_tests(&without_prose(text));
        let mut uses = Vec::new();
        let mut rest = String::with_capacity(text.len());
        let mut at = 0;
        for (start, end, is_public) in statements(&text) {
            rest.push_str(&text[at..start]);
            rest.extend(text[start..end].chars().filter(|&c| c == '\n'));
            at = end;
            let body = &text[start..end];
            let body = &body[body.find("use ").map_or(0, |i| i + 4)..body.len() - 1];
            let mut leaves = Vec::new();
            expand(body, &[], &mut leaves);
            let line = line_of(&text, start);
            uses.extend(leaves.into_iter().map(|(path, name)| Use { path, name, line, is_public }));
        }
        rest.push_str(&text[at..]);
        for root in ["crate", "super"] {
            uses.extend(inline_paths(&rest, root));
        }
        let is_face = path.ends_with("mod.rs") || !path.contains('/') && path.starts_with("lib");
        Self { path: path.to_owned(), uses, macros: macros(&text), is_face }
    }
}

fn line_of(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Where each `use` begins and ends, and whether what it names is handed on.
fn statements(text: &str) -> Vec<(usize, usize, bool)> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices("use ") {
        let line = text[..at].rfind('\n').map_or(0, |i| i + 1);
        let before = text[line..at].trim();
        let is_public = before.starts_with("pub");
        let is_statement = before.is_empty() || is_public && !before.contains(char::is_whitespace);
        if let Some(length) = text[at..].find(';').filter(|_| is_statement) {
            found.push((line, at + length + 1, is_public));
        }
    }
    found
}

/// The leaves of a `use` tree, each with its name.
fn expand(tree: &str, prefix: &[String], leaves: &mut Vec<(Vec<String>, String)>) {
    let tree = tree.trim();
    if let Some(open) = tree.find('{') {
        let parts = tree[..open].split("::").map(str::trim).filter(|part| !part.is_empty()).map(str::to_owned);
        let prefix: Vec<String> = prefix.iter().cloned().chain(parts).collect();
        let inner = &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())];
        let (mut depth, mut start) = (0, 0);
        for (i, c) in inner.char_indices().chain([(inner.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !inner[start..i].trim().is_empty() {
                        expand(&inner[start..i], &prefix, leaves);
                    }
                    start = i + 1;
                }
                _ => {}
            }
        }
        return;
    }
    let (path, alias) = tree.split_once(" as ").map_or((tree, None), |(path, alias)| (path, Some(alias)));
    let parts = path.split("::").map(|part| part.trim().to_owned());
    let mut path: Vec<String> = prefix.iter().cloned().chain(parts).collect();
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let name = alias.map_or_else(|| path.last().cloned().unwrap_or_default(), |alias| alias.trim().to_owned());
    leaves.push((path, name));
}

/// Paths that are written out where they are used: `crate::base::words::number`.
fn inline_paths(text: &str, root: &str) -> Vec<Use> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices(&format!("{root}::")) {
        let before = text[..at].chars().next_back();
        if before.is_some_and(|c| is_word(c) || c == ':') {
            continue;
        }
        let end = text[at..].find(|c| !is_word(c) && c != ':').map_or(text.len(), |length| at + length);
        let written = text[at..end].split("::").filter(|part| !part.is_empty());
        let path: Vec<String> = written.map(str::to_owned).collect();
        let name = path.last().cloned().unwrap_or_default();
        found.push(Use { path, name, line: line_of(text, at), is_public: false });
    }
    found
}

fn macros(text: &str) -> Vec<String> {
    let declared = text.split("#[macro_export]").skip(1).filter_map(|after| after.split_once("macro_rules!"));
    declared.map(|(_, after)| after.trim_start().chars().take_while(|&c| is_word(c)).collect()).collect()
}

/// The same text with blanks for comments and for what stands in quotes.
fn without_prose(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let chars: Vec<char> = text.chars().collect();
    let mut i = 0;
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    while i < chars.len() {
        let end = match at(i) {
            '/' if at(i + 1) == '/' => (i..chars.len()).find(|&k| at(k) == '\n').unwrap_or(chars.len()),
            '/' if at(i + 1) == '*' => {
                (i + 2..chars.len()).find(|&k| at(k) == '*' && at(k + 1) == '/').map_or(chars.len(), |k| k + 2)
            }
            'r' if (at(i + 1) == '"' || at(i + 1) == '#' && at(i + 2) == '"') && !(i > 0 && is_word(at(i - 1))) => {
                let hashes = usize::from(at(i + 1) == '#');
                let is_end = |k: usize| at(k) == '"' && (hashes == 0 || at(k + 1) == '#');
                (i + 2 + hashes..chars.len()).find(|&k| is_end(k)).map_or(chars.len(), |k| k + 1 + hashes)
            }
            '"' => {
                let mut k = i + 1;
                while k < chars.len() && at(k) != '"' {
                    k += if at(k) == '\\' { 2 } else { 1 };
                }
                (k + 1).min(chars.len())
            }
            '\'' if at(i + 1) == '\\' => (i + 3..chars.len()).find(|&k| at(k) == '\'').map_or(chars.len(), |k| k + 1),
            '\'' if at(i + 2) == '\'' => i + 3,
            c => {
                out.push(c);
                i += 1;
                continue;
            }
        };
        out.extend(chars[i..end].iter().map(|&c| if c == '\n' { '\n' } else { ' ' }));
        i = end;
    }
    out
}

/// The same text with blanks for items that only tests have.
fn without_tests(text: &str) -> String {
    let mut out = text.to_owned();
    while let Some(start) = out.find("#[cfg(test)]") {
        let item = start + "#[cfg(test)]".len();
        let first = out[item..].find([';', '{']).map_or(out.len(), |length| item + length);
        let end = if out[first..].starts_with('{') { closing(&out, first) } else { (first + 1).min(out.len()) };
        let blank: String = out[start..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
        out.replace_range(start..end, &blank);
    }
    out
}

/// Behind the brace that closes the one at `open`.
fn closing(text: &str, open: usize) -> usize {
    let mut depth = 0;
    for (i, c) in text[open..].char_indices() {
        depth += match c {
            '{' => 1,
            '}' => -1,
            _ => 0,
        };
        if depth == 0 {
            return open + i + 1;
        }
    }
    text.len()
}
