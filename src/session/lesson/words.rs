//! The words of a page: Markdown with formulas.

use motionscope_core::base::Error;
use motionscope_core::scene::latex;
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

use super::formula;
use crate::paint::charts::prose::{Part, Prose, Span, Style};

/// Reads the words of a page. `line` is the line of the file that they begin with.
///
/// # Errors
/// A sentence with the line of what a page cannot show or a formula that cannot be read.
pub fn parse(text: &str, line: usize) -> Result<Prose, Error> {
    let mut reader = Reader::default();
    let (mut line, mut from) = (line, 0);
    for (event, at) in Parser::new_ext(text, Options::ENABLE_MATH).into_offset_iter() {
        // The end of a part begins where the part does.
        let lines = text.get(from..at.start).map_or(0, |passed| passed.matches('\n').count());
        (line, from) = (line + lines, from.max(at.start));
        reader.take(event).map_err(|why| Error::new(format!("line {line}: {why}")))?;
    }
    reader.end_words();
    Ok(Prose(reader.parts))
}

#[derive(Default)]
struct Reader {
    parts: Vec<Part>,
    /// The words since the last part.
    words: Vec<Span>,
    strong: usize,
    emphasis: usize,
    link: Option<String>,
    /// The next number of each list that is open; none of a list with dots.
    lists: Vec<Option<u64>>,
    /// The mark of the item that begins, with its number if it has one.
    item: Option<Option<u64>>,
}

impl Reader {
    fn take(&mut self, event: Event<'_>) -> Result<(), Error> {
        match event {
            Event::Text(text) | Event::Code(text) => self.push(&text),
            Event::SoftBreak | Event::HardBreak => self.push(" "),
            Event::InlineMath(text) => {
                let link = self.link.clone();
                self.words.extend(formula::inline(&text)?.into_iter().map(|span| Span { link: link.clone(), ..span }));
            }
            Event::DisplayMath(text) => {
                self.end_words();
                self.parts.push(Part::Formula(latex::parse(text.trim())?));
            }
            Event::Start(tag) => self.start(tag)?,
            Event::End(tag) => self.end(tag),
            _ => return Err(cannot("HTML, footnotes and rules")),
        }
        Ok(())
    }

    fn start(&mut self, tag: Tag<'_>) -> Result<(), Error> {
        match tag {
            Tag::Paragraph => {}
            Tag::Item => {
                self.end_words();
                self.item = self.lists.last().copied();
                if let Some(Some(next)) = self.lists.last_mut() {
                    *next += 1;
                }
            }
            Tag::Strong => self.strong += 1,
            Tag::Emphasis => self.emphasis += 1,
            Tag::Link { dest_url, .. } => self.link = Some(dest_url.into_string()),
            Tag::List(first) => {
                self.end_words();
                self.lists.push(first);
            }
            Tag::Image { .. } => return Err(cannot("pictures")),
            Tag::Heading { .. } => return Err(cannot("headings")),
            _ => return Err(cannot("tables, quotations and code")),
        }
        Ok(())
    }

    fn end(&mut self, tag: TagEnd) {
        match tag {
            TagEnd::Strong => self.strong -= 1,
            TagEnd::Emphasis => self.emphasis -= 1,
            TagEnd::Link => self.link = None,
            TagEnd::Paragraph | TagEnd::Item => self.end_words(),
            TagEnd::List(_) => drop(self.lists.pop()),
            _ => {}
        }
    }

    fn push(&mut self, text: &str) {
        let style = match (self.strong, self.emphasis) {
            (0, 0) => Style::Plain,
            (0, _) => Style::Emphasis,
            _ => Style::Strong,
        };
        match self.words.last_mut() {
            Some(last) if last.style == style && last.link == self.link => last.text.push_str(text),
            _ => self.words.push(Span { text: text.to_owned(), style, link: self.link.clone() }),
        }
    }

    /// What was read since the last part becomes one.
    fn end_words(&mut self) {
        let words = std::mem::take(&mut self.words);
        if words.iter().all(|span| span.text.trim().is_empty()) {
            return;
        }
        self.parts.push(match self.item.take() {
            Some(number) => Part::Item(number, words),
            None => Part::Paragraph(words),
        });
    }
}

fn cannot(what: &str) -> Error {
    Error::new(format!("a page of a lesson shows no {what}; use paragraphs, lists, formulas and links"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Prose {
        parse(text, 1).unwrap_or_else(|why| panic!("{why}"))
    }

    #[test]
    fn paragraphs_lists_and_formulas_are_parts() {
        let prose = read("The **cost** of $u$:\n\n$$\nE = |I - J|\n$$\n\n1. test,\n2. *keep* the minimum.\n");
        assert_eq!(prose.plain(), "The cost of u:\nE = |I − J|\n1. test,\n2. keep the minimum.");
        let two = read("1. a\n\n   b\n2. c\n");
        assert_eq!(two.plain(), "1. a\nb\n2. c", "a second paragraph of an item has no number");
        let Part::Paragraph(spans) = &prose.0[0] else { panic!("{:?}", prose.0[0]) };
        let styles: Vec<_> = spans.iter().map(|span| (span.text.as_str(), span.style)).collect();
        let expected = [
            ("The ", Style::Plain),
            ("cost", Style::Strong),
            (" of ", Style::Plain),
            ("u", Style::Emphasis),
            (":", Style::Plain),
        ];
        assert_eq!(styles, expected);
    }

    #[test]
    fn a_link_keeps_its_target_and_lines_of_a_paragraph_are_joined() {
        let prose = read("See\n[the next lesson](lesson:horn-schunck).");
        assert_eq!(prose.plain(), "See the next lesson.");
        assert_eq!(prose.links().collect::<Vec<_>>(), ["lesson:horn-schunck"]);
    }

    #[test]
    fn what_a_page_cannot_show_is_refused_with_its_line() {
        let why = |text: &str| parse(text, 10).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(why("one\n\n# two").starts_with("line 12: ") && why("# one").contains("headings"));
        assert!(why("a\n\nb $\\fra$").starts_with("line 12: the formula \\fra"), "{}", why("a\n\nb $\\fra$"));
        assert!(why("![x](y.png)").contains("pictures"));
        assert!(why("<b>x</b>").contains("HTML"));
        assert!(why("    code").contains("code"));
    }
}
