//! The keys of a session as texts, each with its section before it: `set.block-size`.

use std::collections::BTreeMap;
use std::path::Path;

use motionscope_core::base::Error;
use toml::Value;

use crate::session::toml_text::Section;
use crate::session::{Session, read, write};

/// Keys and values.
pub(super) type Keys = BTreeMap<String, String>;

/// The key of the estimators in lockstep.
const BESIDE: &str = "beside";
/// The section of the parameters.
const SET: &str = "set";
/// The section of the lines drawn by hand, which are not part of a link.
const INK: &str = "ink";

/// Returns the keys of `session` that a new run of its estimator on its clip does not have.
///
/// # Errors
/// If it cannot be written.
pub(super) fn of(session: &Session) -> Result<Keys, Error> {
    let mut keys = Keys::new();
    for (name, value) in write::differing(session, &Path::to_owned)? {
        match value {
            Value::Array(all) if name == BESIDE => lockstep(&all, &mut keys),
            _ if name == INK => {}
            Value::Table(section) => {
                keys.extend(section.iter().map(|(key, value)| (format!("{name}.{key}"), text(value))));
            }
            value => drop(keys.insert(name, text(&value))),
        }
    }
    Ok(keys)
}

/// Adds the estimators in lockstep, which are numbered from 2 on.
fn lockstep(all: &[Value], keys: &mut Keys) {
    let ids: Vec<String> = all.iter().filter_map(|one| one.get("estimator")).map(text).collect();
    keys.insert(BESIDE.into(), ids.join(","));
    for (number, one) in (2..).zip(all) {
        let own = one.get(SET).and_then(Value::as_table).into_iter().flatten();
        keys.extend(own.map(|(name, value)| (format!("{SET}.{number}.{name}"), text(value))));
    }
}

/// A value without quotes and brackets.
fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(all) => all.iter().map(text).collect::<Vec<_>>().join(","),
        Value::Float(number) => number.to_string(),
        other => other.to_string(),
    }
}

/// A key of a link that cannot be read, and why.
pub(super) struct Fault {
    /// The key, unless none of them alone is wrong.
    pub key: Option<String>,
    /// The reason.
    pub why: Error,
}

/// Reads the session with these keys.
///
/// # Errors
/// The first key that is wrong.
pub(super) fn session(keys: &Keys) -> Result<Session, Fault> {
    let lines: Vec<String> = keys.iter().map(|(key, value)| format!("{} = {}\n", dotted(key), quoted(value))).collect();
    let text = lines.concat();
    let read = Section::parse_texts(&text).and_then(|mut top| {
        let session = read::keys(&mut top, None, Path::new(""))?;
        top.end().map(|()| session)
    });
    read.map_err(|why| {
        let why = why.to_string();
        let (number, rest) = why.strip_prefix("line ").and_then(|why| why.split_once([',', ':'])).unwrap_or_default();
        let key = number.parse().ok().and_then(|line: usize| keys.keys().nth(line.checked_sub(1)?).cloned());
        Fault { why: Error::new(if key.is_some() { rest.trim().to_owned() } else { why }), key }
    })
}

/// A key as TOML has it: in its section, with all that stands behind the first dot as its name.
fn dotted(key: &str) -> String {
    match key.split_once('.') {
        Some((section, name)) => format!("{}.{}", quoted(section), quoted(name)),
        None => quoted(key),
    }
}

/// A text in quotes, in one line.
fn quoted(text: &str) -> String {
    let escaped = |letter: char| match letter {
        '"' | '\\' => format!("\\{letter}"),
        letter if letter.is_control() => format!("\\u{:04X}", u32::from(letter)),
        letter => letter.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}
