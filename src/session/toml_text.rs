//! TOML that is read key by key, so that an error names its line and its key. In a link each value is a text, which is
//! read as whatever is asked for.

use std::borrow::Cow;
use std::sync::Arc;

use motionscope_core::base::{Error, words};
use motionscope_core::params::Kind;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table of the text. Keys are taken out of it one after the other; what is left is not known.
pub struct Section<'a> {
    /// What its keys begin with: `picture.`.
    path: String,
    /// Where it begins.
    line: usize,
    entries: Vec<(String, Entry<'a>)>,
    known: Vec<&'static str>,
}

/// A value and where it stands.
pub struct Entry<'a> {
    lines: Arc<Lines>,
    line: usize,
    key: String,
    value: DeValue<'a>,
}

impl<'a> Section<'a> {
    /// The whole of `text`.
    ///
    /// # Errors
    /// A sentence that names the line if it is no TOML.
    pub fn parse(text: &'a str) -> Result<Self, Error> {
        Self::of(text, Lines::of(text))
    }

    /// The whole of `text`, in which numbers, switches and lists are texts too.
    ///
    /// # Errors
    /// A sentence that names the line if it is no TOML.
    pub fn parse_texts(text: &'a str) -> Result<Self, Error> {
        Self::of(text, Lines { are_texts: true, ..Lines::of(text) })
    }

    fn of(text: &'a str, lines: Lines) -> Result<Self, Error> {
        let lines = Arc::new(lines);
        let table = DeTable::parse(text).map_err(|error| unreadable(text, &lines, &error))?;
        Ok(Self::new(&lines, (String::new(), 1), table.into_inner()))
    }

    fn new(lines: &Arc<Lines>, (path, line): (String, usize), table: DeTable<'a>) -> Self {
        let entry = |(name, value): (Spanned<Cow<'a, str>>, Spanned<DeValue<'a>>)| {
            let line = lines.at(name.span().start);
            let key = format!("{path}{}", name.get_ref());
            (name.into_inner().into_owned(), Entry { lines: Arc::clone(lines), line, key, value: value.into_inner() })
        };
        let entries = table.into_iter().map(entry).collect();
        Self { entries, line, known: Vec::new(), path }
    }

    /// A section without keys.
    pub fn empty() -> Self {
        Self { path: String::new(), line: 1, entries: Vec::new(), known: Vec::new() }
    }

    /// The value of a key, if it is there.
    pub fn take(&mut self, key: &'static str) -> Option<Entry<'a>> {
        self.known.push(key);
        let place = self.entries.iter().position(|(name, _)| name == key)?;
        Some(self.entries.swap_remove(place).1)
    }

    /// The value of a key that must be there.
    ///
    /// # Errors
    /// If it is not.
    pub fn need(&mut self, key: &'static str) -> Result<Entry<'a>, Error> {
        // The error is made first: the key is taken out of what it tells of.
        let lacks = self.lacks(key);
        self.take(key).ok_or(lacks)
    }

    /// What is said where a key is missing.
    pub fn lacks(&self, key: &'static str) -> Error {
        match self.path.trim_end_matches('.') {
            "" => Error::new(format!("it has no key {key}; add a line {key} = …")),
            path => Error::new(format!("line {}: {path} has no key {key}; add it", self.line)),
        }
    }

    /// All keys with their values, whatever they are called, in the order of the text.
    pub fn all(self) -> Vec<(String, Entry<'a>)> {
        let mut entries = self.entries;
        entries.sort_by_key(|(_, entry)| entry.line);
        entries
    }

    /// Nothing more is to be taken.
    ///
    /// # Errors
    /// If there is a key that was not asked for.
    pub fn end(self) -> Result<(), Error> {
        match self.entries.iter().min_by_key(|(_, entry)| entry.line) {
            None => Ok(()),
            Some((name, entry)) => {
                let why = words::there_is_no("key", &Error::short_name(name), &self.known);
                Err(Error::new(format!("line {}: {why}", entry.line)))
            }
        }
    }
}

impl<'a> Entry<'a> {
    /// What is wrong with the value, with its line and key.
    pub fn wrong(&self, why: impl std::fmt::Display) -> Error {
        Error::new(format!("line {}, {}: {why}", self.line, Error::short_name(&self.key)))
    }

    fn is_no(&self, what: &str) -> Error {
        let found = match &self.value {
            DeValue::String(text) => format!("the text \"{}\"", Error::short_name(text)),
            DeValue::Integer(number) => format!("{number}"),
            DeValue::Float(number) => format!("{number}"),
            DeValue::Boolean(value) => format!("{value}"),
            DeValue::Datetime(_) => "a date".into(),
            DeValue::Array(_) => "a list".into(),
            DeValue::Table(_) => "a section".into(),
        };
        self.wrong(format!("{what} is needed, not {found}"))
    }

    /// A text.
    ///
    /// # Errors
    /// If it is something else.
    pub fn text(&self) -> Result<&str, Error> {
        self.value.as_str().ok_or_else(|| self.is_no("a text in quotes"))
    }

    /// A text, read as something.
    ///
    /// # Errors
    /// If it is none, or cannot be read so.
    pub fn parsed<T>(&self, parse: impl FnOnce(&str) -> Result<T, Error>) -> Result<T, Error> {
        parse(self.text()?).map_err(|why| self.wrong(why))
    }

    /// A whole number.
    ///
    /// # Errors
    /// If it is something else.
    pub fn whole(&self) -> Result<i64, Error> {
        let number = match self.as_text() {
            Some(text) => text.parse().ok(),
            None => {
                self.value.as_integer().and_then(|number| i64::from_str_radix(number.as_str(), number.radix()).ok())
            }
        };
        number.ok_or_else(|| self.is_no("a whole number"))
    }

    /// A number that counts something.
    ///
    /// # Errors
    /// If it is something else, or negative.
    pub fn count(&self) -> Result<usize, Error> {
        usize::try_from(self.whole()?).map_err(|_| self.is_no("a whole number from 0 on"))
    }

    /// A number.
    ///
    /// # Errors
    /// If it is something else.
    pub fn number(&self) -> Result<f32, Error> {
        self.as_number().ok_or_else(|| self.is_no("a number"))
    }

    /// The text that stands for a value of another kind, if all values are texts.
    fn as_text(&self) -> Option<&str> {
        self.value.as_str().filter(|_| self.lines.are_texts)
    }

    fn as_number(&self) -> Option<f32> {
        self.as_text().map_or_else(|| number(&self.value), |text| text.parse().ok())
    }

    /// Yes or no.
    ///
    /// # Errors
    /// If it is something else.
    pub fn switch(&self) -> Result<bool, Error> {
        let value = match self.as_text() {
            Some("true" | "on") => Some(true),
            Some("false" | "off") => Some(false),
            _ => self.value.as_bool(),
        };
        value.ok_or_else(|| self.is_no("true or false"))
    }

    /// A number or a text: whichever it is.
    ///
    /// # Errors
    /// If it is something else.
    pub fn number_or_text(&self) -> Result<Result<f32, &str>, Error> {
        match (self.as_number(), self.value.as_str()) {
            (Some(number), _) => Ok(Ok(number)),
            (None, Some(text)) => Ok(Err(text)),
            _ => Err(self.is_no("a number or a text in quotes")),
        }
    }

    /// Exactly this many numbers.
    ///
    /// # Errors
    /// If it is something else.
    pub fn numbers<const N: usize>(&self) -> Result<[f32; N], Error> {
        let all: Option<Vec<f32>> = match self.as_text() {
            Some(text) => text.split(',').map(|number| number.parse().ok()).collect(),
            None => self.value.as_array().and_then(|all| all.iter().map(|value| number(value.get_ref())).collect()),
        };
        let all = all.and_then(|all| <[f32; N]>::try_from(all).ok());
        all.ok_or_else(|| self.is_no(&format!("a list of {N} numbers")))
    }

    /// The value as a person would type it on the command line.
    ///
    /// # Errors
    /// If it is a list or a section.
    pub fn plain(&self) -> Result<String, Error> {
        match &self.value {
            DeValue::String(text) => Ok(text.clone().into_owned()),
            DeValue::Boolean(value) => Ok(value.to_string()),
            DeValue::Integer(_) => self.whole().map(|number| number.to_string()),
            DeValue::Float(number) => Ok(number.as_str().to_owned()),
            _ => Err(self.is_no("a single value")),
        }
    }

    /// What a parameter of this kind may be, as a person would type it on the command line.
    ///
    /// # Errors
    /// If it is something else.
    pub fn value_of(&self, kind: &Kind) -> Result<String, Error> {
        match kind {
            Kind::Int { .. } => drop(self.whole()?),
            Kind::Real { .. } => drop(self.number()?),
            Kind::Switch => drop(self.switch()?),
            // What has more choices than on and off by now was written as a switch before.
            Kind::Choice(all) if all.iter().any(|choice| choice.name == "on") && self.value.as_bool().is_some() => {
                return self.switch().map(|on| if on { "on" } else { "off" }.to_owned());
            }
            Kind::Choice(_) | Kind::Placed(_) | Kind::Stage(_) => drop(self.text()?),
            Kind::Optional { of, .. } => match &**of {
                Kind::Int { .. } | Kind::Real { .. } => drop(self.number_or_text()?),
                _ if self.value.as_str().is_some() => {}
                of => drop(self.value_of(of)?),
            },
        }
        self.plain()
    }

    /// A section with keys of its own.
    ///
    /// # Errors
    /// If it is something else.
    pub fn section(self) -> Result<Section<'a>, Error> {
        match self.value {
            DeValue::Table(table) => Ok(Section::new(&self.lines, (format!("{}.", self.key), self.line), table)),
            _ => Err(self.is_no("a section")),
        }
    }

    /// Several sections.
    ///
    /// # Errors
    /// If it is something else.
    pub fn sections(self) -> Result<Vec<Section<'a>>, Error> {
        let DeValue::Array(all) = self.value else { return Err(self.is_no("a list of sections")) };
        let entry = |value: Spanned<DeValue<'a>>| {
            let line = self.lines.at(value.span().start);
            Entry { lines: Arc::clone(&self.lines), line, key: self.key.clone(), value: value.into_inner() }.section()
        };
        all.into_iter().map(entry).collect()
    }
}

fn number(value: &DeValue<'_>) -> Option<f32> {
    match value {
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok().map(|n| n as f32),
        DeValue::Float(number) => number.as_str().parse().ok(),
        _ => None,
    }
}

/// The lines of a text, and how its values are written.
struct Lines {
    /// Where each line ends, found once.
    ends: Vec<usize>,
    /// Whether all values are texts, whatever they stand for.
    are_texts: bool,
}

impl Lines {
    fn of(text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
        Self { ends, are_texts: false }
    }

    /// The line of the byte `at`, counted from 1.
    fn at(&self, at: usize) -> usize {
        1 + self.ends.partition_point(|end| *end < at)
    }

    /// The first line with which `text` becomes too deep for the parser, which does not say where that is.
    fn first_too_deep(&self, text: &str) -> usize {
        let is_fine = |end: &usize| !DeTable::parse(&text[..*end]).is_err_and(|error| is_too_deep(&error));
        1 + self.ends.partition_point(is_fine)
    }
}

/// Whether the parser refused a text for its sections in sections.
fn is_too_deep(error: &toml::de::Error) -> bool {
    error.message().contains("recurs")
}

/// Why `text` is no TOML.
fn unreadable(text: &str, lines: &Lines, error: &toml::de::Error) -> Error {
    if is_too_deep(error) {
        let line = lines.first_too_deep(text);
        return Error::new(format!("line {line} has too many sections in one another; a key has one dot at most"));
    }
    let line = lines.at(error.span().map_or(0, |span| span.start));
    if error.message().contains("duplicate key") {
        return Error::new(format!("line {line} has a key that is there already; leave one of them out"));
    }
    Error::new(format!("line {line} is not written as key = value, with texts in quotes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_from_one_and_end_behind_their_last_byte() {
        let text = "a = 1\n\nb = 2\nc = 3";
        let lines = Lines::of(text);
        let plain = |at: usize| 1 + text[..at].matches('\n').count();
        assert!((0..=text.len()).all(|at| lines.at(at) == plain(at)));
    }

    #[test]
    fn keys_in_too_many_sections_are_refused_with_their_line() {
        let deep = vec!["a"; 100_000].join(".");
        for text in [format!("b = 1\n\n{deep} = 1\nc = 2\n"), format!("b = 1\n\nc = {}", "[".repeat(100_000))] {
            let why = Section::parse(&text).map(drop).expect_err("no session is so deep").to_string();
            assert!(why.starts_with("line 3 has too many sections"), "{why}");
        }
    }
}
