//! The data files in `core/assets`, which are part of the program.

use serde::Deserialize;

use crate::base::Error;

/// A file: a list of terms or of examples.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File<T> {
    #[serde(rename = "term", alias = "example")]
    entries: Vec<T>,
}

/// Reads the entries of the file `name` from its `text`; they borrow their own texts from it.
///
/// # Errors
/// One sentence with the file, the line and the reason.
pub(super) fn read<T: Deserialize<'static>>(name: &str, text: &'static str) -> Result<Vec<T>, Error> {
    let about = |error: toml::de::Error| {
        let start = error.span().map_or(0, |span| span.start);
        let line = 1 + text[..start].matches('\n').count();
        Error::new(format!("core/assets/{name}, line {line}: {}", error.message()))
    };
    toml::from_str(text).map(|file: File<T>| file.entries).map_err(about)
}

#[cfg(test)]
mod tests;
