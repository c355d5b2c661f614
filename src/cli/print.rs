//! The only place that prints: names and words of files reach a terminal without the characters that it would obey.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use motionscope_core::base::{Error, is_command, printable};
use serde::Serialize;

/// Writes `text` to standard output; a closed pipe is no error.
///
/// # Errors
/// If it cannot be written.
pub fn say(text: &str) -> Result<(), Error> {
    write_out(&printable(text))
}

/// Writes JSON to standard output. Characters that a terminal would obey can stand only in its strings and are escaped there, so the
/// values stay the same.
///
/// # Errors
/// If it cannot be written.
pub fn say_json(json: &str) -> Result<(), Error> {
    write_out(&escaped(json))
}

/// Writes one of several lines of JSON to standard output; returns whether it is still read.
///
/// # Errors
/// If it cannot be written.
pub fn say_line(json: &str) -> Result<bool, Error> {
    match writeln!(io::stdout().lock(), "{}", escaped(json)) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(unwritable(&error)),
    }
}

/// Returns `value` as one line of JSON.
///
/// # Errors
/// If it cannot be written as JSON.
pub fn to_json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(|error| Error::new(format!("the result cannot be written as JSON: {error}")))
}

/// Writes a warning or a note to standard error.
pub fn remark(text: &str) {
    eprintln!("{}", printable(text));
}

/// Writes several lines to standard error, beside a result on standard output.
pub fn say_beside(text: &str) {
    eprint!("{}", printable(text));
}

fn escaped(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        if is_command(c) {
            // All of them have four hexadecimal digits. Writing into a string never fails.
            write!(escaped, "\\u{:04x}", u32::from(c)).unwrap_or_default();
        } else {
            escaped.push(c);
        }
    }
    escaped
}

fn write_out(text: &str) -> Result<(), Error> {
    let end = if text.ends_with('\n') { "" } else { "\n" };
    match write!(io::stdout().lock(), "{text}{end}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(unwritable(&error)),
        _ => Ok(()),
    }
}

fn unwritable(error: &io::Error) -> Error {
    Error::new(format!("standard output cannot be written: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_keeps_its_values_without_a_character_that_a_terminal_obeys() {
        let value = serde_json::json!({ "title": "a\u{9b}31m\u{7f}\u{202e}b\u{1b}]0;c\u{7}\n\tü" });
        for json in [value.to_string(), format!("{value:#}")] {
            let escaped = escaped(&json);
            assert!(!escaped.contains(is_command), "{escaped:?}");
            assert_eq!(serde_json::from_str::<serde_json::Value>(&escaped).unwrap(), value);
        }
    }
}
