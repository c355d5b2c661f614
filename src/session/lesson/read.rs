//! The reader of lesson files.

use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::run::Cursor;

use super::super::toml_text::Section;
use super::super::{Session, example, read};
use super::{Lesson, Page, words};

/// The line around the header of a page.
pub(super) const FENCE: &str = "+++";

/// The most letters of a title, which has to fit above a page.
const MOST_LETTERS: usize = 200;

/// A title, if it is not too long for one.
fn checked_title(title: &str) -> Result<&str, Error> {
    match title.chars().count() {
        count if count > MOST_LETTERS => {
            Err(Error::new(format!("a title has at most {MOST_LETTERS} letters, and this one has {count}; shorten it")))
        }
        _ => Ok(title),
    }
}

/// Reads the lesson in `text`, whose files are relative to `folder`. A page that is wrong keeps its place and says why.
///
/// # Errors
/// If the text does not begin with a title, or has no page.
pub(super) fn lesson(slug: &str, text: &str, folder: &Path) -> Result<Lesson, Error> {
    let text = text.replace("\r\n", "\n");
    let (head, sources) = split(&text)?;
    let title = head.lines().find_map(|line| line.strip_prefix("# "));
    let title = title.ok_or_else(|| Error::new("it is not a lesson: its first line is not # and a title"))?.trim();
    checked_title(title)?;
    let summary: Vec<_> = head.lines().filter(|line| !line.starts_with('#')).map(str::trim).collect();
    let mut pages: Vec<Page> = Vec::new();
    for source in &sources {
        let before = pages.last().and_then(|page: &Page| page.session.as_ref().ok());
        let page = page(source, before, folder);
        pages.push(page);
    }
    if pages.is_empty() {
        return Err(Error::new(format!("it has no page; a page begins with a header between two lines {FENCE}")));
    }
    Ok(Lesson { slug: slug.into(), title: title.into(), summary: summary.join(" ").trim().into(), pages })
}

/// A page as it is written.
struct Source<'a> {
    /// The header after as many empty lines as stand before it, so that errors name lines of the file.
    header: String,
    words: &'a str,
    /// The lines that header and words begin with.
    begins: usize,
    line: usize,
}

/// The words before the first page, and the pages.
fn split(text: &str) -> Result<(&str, Vec<Source<'_>>), Error> {
    let mut fences = Vec::new();
    let mut at = 0;
    for (index, line) in text.split_inclusive('\n').enumerate() {
        if line.trim_end() == FENCE {
            fences.push((index, at, at + line.len()));
        }
        at += line.len();
    }
    if fences.len() % 2 == 1 {
        let line = fences.last().map_or(1, |(index, ..)| index + 1);
        return Err(Error::new(format!("line {line}: the header that begins here has no {FENCE} at its end")));
    }
    let head = &text[..fences.first().map_or(text.len(), |(_, from, _)| *from)];
    let of = |(i, pair): (usize, &[(usize, usize, usize)])| {
        let [(first, _, from), (last, to, after)] = *pair else { return None };
        let end = fences.get(2 * i + 2).map_or(text.len(), |(_, from, _)| *from);
        let header = "\n".repeat(first + 1) + &text[from..to];
        Some(Source { header, words: &text[after..end], begins: first + 1, line: last + 2 })
    };
    Ok((head, fences.chunks(2).enumerate().filter_map(of).collect()))
}

/// Reads a page; clip, estimator, parameters and frame that its header does not name are those of the page `before`.
fn page(source: &Source<'_>, before: Option<&Session>, folder: &Path) -> Page {
    let mut page = Page {
        title: String::new(),
        notes: String::new(),
        until: None,
        predicts: false,
        words: words::parse(source.words, source.line),
        session: Err(Error::new("it has no header")),
    };
    let read = Section::parse(&source.header).and_then(|mut top| {
        // The title first: a page that is wrong is named as well.
        page.title = top.need("title")?.parsed(|title| checked_title(title).map(str::to_owned))?;
        page.notes = top.take("notes").map_or(Ok(String::new()), |notes| notes.text().map(str::to_owned))?;
        page.until = top.take("until").map(|until| until.parsed(str::parse::<Cursor>)).transpose()?;
        page.predicts = top.take("predict").map_or(Ok(false), |asks| asks.switch())?;
        let base = match top.take("example") {
            Some(example) => Some(example.parsed(example::find)?),
            None => before.cloned(),
        };
        let session = read::keys(&mut top, base, folder)?;
        top.end()?;
        let order = |cursor: Cursor| (cursor.unit, cursor.event);
        let first = session.position.cursor.unwrap_or_default();
        match page.until.filter(|until| order(*until) < order(first)) {
            Some(until) => Err(Error::new(format!("until = \"{until}\" lies before step = \"{first}\""))),
            None => Ok(session),
        }
    });
    // What lacks a key has no line of its own.
    page.session = read.map_err(|why| match why.to_string() {
        text if text.starts_with("line ") => why,
        text => Error::new(format!("line {}: {text}", source.begins)),
    });
    page
}
