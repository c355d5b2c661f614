//! Running words with formulas: the page of a lesson.

use std::ops::Range;

use motionscope_core::scene::Math;

use super::super::primitive::{Anchor, Primitive, Rect, Run};
use super::super::{Face, Theme};
use super::canvas::{Canvas, Level, Type};
use super::explanation::{Block, Density, equation, rects, words};

/// Between two parts, in sizes of the type.
const GAP: f32 = 0.6;
/// Between two items of a list.
const ITEM_GAP: f32 = 0.25;
/// How far an item is set in.
const INDENT: f32 = 1.1;

/// Words with formulas, part below part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prose(pub Vec<Part>);

/// A part of a text.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// A paragraph.
    Paragraph(Vec<Span>),
    /// An item of a list, with its number if the list is numbered.
    Item(Option<u64>, Vec<Span>),
    /// A displayed formula.
    Formula(Math),
}

/// How words are set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Upright.
    #[default]
    Plain,
    /// Bold.
    Strong,
    /// Italic: a stressed word, a variable.
    Emphasis,
}

/// Words in one style.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Span {
    /// The words.
    pub text: String,
    /// Their style.
    pub style: Style,
    /// Where a click on them leads.
    pub link: Option<String>,
}

impl Prose {
    /// The words without styles, a part a line; formulas on one line.
    pub fn plain(&self) -> String {
        let of = |spans: &[Span]| spans.iter().map(|span| span.text.replace('\u{a0}', " ")).collect::<String>();
        let part = |part: &Part| match part {
            Part::Paragraph(spans) | Part::Item(None, spans) => of(spans),
            Part::Item(Some(number), spans) => format!("{number}. {}", of(spans)),
            Part::Formula(math) => math.plain(),
        };
        self.0.iter().map(part).collect::<Vec<_>>().join("\n")
    }

    /// The targets of all links, in the order of the text.
    pub fn links(&self) -> impl Iterator<Item = &str> {
        let spans = self.0.iter().flat_map(|part| match part {
            Part::Paragraph(spans) | Part::Item(_, spans) => spans.as_slice(),
            Part::Formula(_) => &[],
        });
        spans.filter_map(|span| span.link.as_deref())
    }
}

/// A text as it is laid out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Words, formulas, and the terms and symbols among them.
    pub block: Block,
    /// Where each link stands, and where it leads; one that is broken over two lines is there twice.
    pub links: Vec<(Rect, String)>,
}

impl Page {
    fn put(&mut self, other: Page, gap: f32) {
        let down = if self.block.size[1] > 0.0 { self.block.size[1] + gap } else { 0.0 };
        self.links.extend(other.links.into_iter().map(|(rect, to)| (rect.moved([0.0, down]), to)));
        self.block.put_below(other.block, gap);
    }
}

/// Lays `prose` out from the origin on, `width` points wide, in type of `size_pt`.
pub fn lay_out(prose: &Prose, width: f32, size_pt: f32, theme: Theme) -> Page {
    let density = Density { words: size_pt, math: 1.1 * size_pt, ..Density::close(theme) };
    let mut page = Page::default();
    let mut was_item = false;
    for part in &prose.0 {
        let is_item = matches!(part, Part::Item(..));
        let gap = if was_item && is_item { ITEM_GAP } else { GAP } * size_pt;
        was_item = is_item;
        page.put(one(part, width, density, theme), gap);
    }
    page
}

fn one(part: &Part, width: f32, density: Density, theme: Theme) -> Page {
    match part {
        Part::Paragraph(spans) => paragraph(spans, width, density, theme),
        Part::Item(number, spans) => item(*number, spans, (width, density), theme),
        Part::Formula(math) => {
            let left = 0.8 * density.words;
            let formula = equation(std::slice::from_ref(math), (width - left, density), theme);
            let size = [formula.size[0] + left, formula.size[1]];
            Page { block: Block { size, ..formula.moved([left, 0.0]) }, links: Vec::new() }
        }
    }
}

/// The runs of `spans`, and the bytes of each link in the whole text.
fn runs(spans: &[Span], theme: Theme) -> (Vec<Run>, Vec<(Range<usize>, String)>) {
    let chrome = theme.chrome();
    let (mut runs, mut links, mut at) = (Vec::new(), Vec::new(), 0);
    for Span { text, style, link } in spans {
        let face = match style {
            Style::Plain => Face::Sans,
            Style::Strong => Face::Bold,
            Style::Emphasis => Face::Italic,
        };
        let end = at + text.len();
        let run = match link {
            Some(to) => {
                links.push((at..end, to.clone()));
                Run::new(text, chrome.accent).underlined(chrome.accent)
            }
            None => Run::new(text, chrome.text),
        };
        runs.push(run.face(face));
        at = end;
    }
    (runs, links)
}

fn paragraph(spans: &[Span], width: f32, density: Density, theme: Theme) -> Page {
    let (runs, links) = runs(spans, theme);
    let (mut block, all) = words(&runs, width, density);
    let of = |(bytes, to): (Range<usize>, String)| rects(&all, &bytes).into_iter().map(move |rect| (rect, to.clone()));
    let links: Vec<_> = links.into_iter().flat_map(of).collect();
    // What is clicked is not defined as well.
    block.terms.retain(|(term, _)| links.iter().all(|(link, _)| !link.meets(term)));
    Page { block, links }
}

/// A paragraph behind a dot or a number.
fn item(number: Option<u64>, spans: &[Span], (width, density): (f32, Density), theme: Theme) -> Page {
    let indent = INDENT * density.words;
    let Page { block, links } = paragraph(spans, width - indent, density, theme);
    let mut canvas = Canvas::default();
    let style = Type { size: density.words, ..Type::dim(theme) };
    let line = (density.leading * density.words).round();
    let mark = number.map_or_else(|| "•".to_owned(), |number| format!("{number}."));
    canvas.text([0.0, line / 2.0], (Anchor::Start, Level::Middle), &mark, style);
    let mut block = block.moved([indent, 0.0]);
    let marks: Vec<Primitive> = canvas.into_primitives();
    block.primitives.splice(0..0, marks);
    block.size[0] += indent;
    Page { block, links: links.into_iter().map(|(rect, to)| (rect.moved([indent, 0.0]), to)).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(text: &str, link: Option<&str>) -> Span {
        Span { text: text.into(), link: link.map(Into::into), ..Span::default() }
    }

    fn prose() -> Prose {
        let words = vec![
            span("The structure tensor sums gradients. Read ", None),
            span("Lucas and Kanade on this", Some("lesson:lucas-kanade")),
            span(" next.", None),
        ];
        let item = |words| Part::Item(None, vec![span(words, None)]);
        Prose(vec![Part::Paragraph(words), item("first"), item("second"), Part::Formula(Math::squared(Math::Var("u")))])
    }

    #[test]
    fn a_link_stands_on_each_of_its_lines_and_terms_are_defined() {
        let page = lay_out(&prose(), 260.0, 16.0, Theme::Projector);
        let lines: Vec<f32> = page.links.iter().map(|(rect, _)| rect.min[1]).collect();
        assert!(lines.len() > 1 && lines.is_sorted_by(|a, b| a < b), "{lines:?}");
        assert!(page.links.iter().all(|(_, to)| to == "lesson:lucas-kanade"));
        let names: Vec<_> = page.block.terms.iter().map(|(_, term)| term.name).collect();
        assert_eq!(names, ["structure tensor", "image gradient"]);
        assert!(page.block.size[0] <= 260.0);
    }

    #[test]
    fn parts_stand_below_each_other_and_are_read_in_their_order() {
        let page = lay_out(&prose(), 400.0, 16.0, Theme::Dark);
        let tops: Vec<f32> = page.block.lines.iter().map(|(rect, _)| rect.min[1]).collect();
        assert!(tops.len() == 4 && tops.is_sorted_by(|a, b| a < b), "{tops:?}");
        assert_eq!(
            prose().plain(),
            "The structure tensor sums gradients. Read Lucas and Kanade on this next.\nfirst\nsecond\nu^2"
        );
        assert_eq!(prose().links().collect::<Vec<_>>(), ["lesson:lucas-kanade"]);
    }
}
