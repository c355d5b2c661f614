//! The numbers in the words of a lesson are those of its runs.

use std::collections::BTreeSet;

use motionscope::experiment::Prepared;
use motionscope::experiment::pixel::{Chosen, Held};
use motionscope::session::lesson::Page;
use motionscope_core::course::estimator;
use motionscope_core::products::{Assessment, Output, Reference};
use motionscope_core::run::{Direction, Move, Walk};
use motionscope_core::scene::{Fact, Step};

use super::*;

/// A number as it is written.
struct Written {
    text: String,
    value: f64,
    decimals: usize,
    is_negative: bool,
    /// A bracket follows: it may be the year of a reference.
    ends_bracket: bool,
}

impl Written {
    /// The numbers of a text, from left to right.
    fn all(text: &str) -> Vec<Self> {
        let chars: Vec<char> = text.chars().filter(|c| *c != '\u{202f}').collect();
        let is_digit = |i: usize| chars.get(i).is_some_and(char::is_ascii_digit);
        let is_point = |i: usize| i > 0 && chars.get(i) == Some(&'.') && is_digit(i - 1) && is_digit(i + 1);
        let is_inside = |i: usize| is_digit(i) || is_point(i);
        let starts = (0..chars.len()).filter(|&i| is_inside(i) && (i == 0 || !is_inside(i - 1)));
        let number = |from: usize| {
            let to = (from..chars.len()).find(|&i| !is_inside(i)).unwrap_or(chars.len());
            let digits: String = chars[from..to].iter().collect();
            let is_negative = from > 0 && matches!(chars[from - 1], '−' | '-');
            Some(Self {
                text: format!("{}{digits}", if is_negative { "−" } else { "" }),
                value: digits.parse().ok()?,
                decimals: digits.split_once('.').map_or(0, |(_, decimals)| decimals.len()),
                is_negative,
                ends_bracket: chars.get(to) == Some(&')'),
            })
        };
        starts.filter_map(number).collect()
    }

    fn digits(&self) -> usize {
        self.text.chars().filter(char::is_ascii_digit).count()
    }

    /// Whether it comes from a run: it has decimals or three digits, and is no year of a reference.
    fn is_measured(&self) -> bool {
        let is_year = self.ends_bracket && self.decimals == 0 && (1900.0..2100.0).contains(&self.value);
        (self.decimals > 0 || self.digits() > 2) && !is_year
    }

    /// Whether it is `told`, or that rounded, if three digits of it are left.
    fn is(&self, told: &Self) -> bool {
        let half = |decimals: usize| 0.5 / 10f64.powi(decimals as i32);
        let off = (self.value - told.value).abs();
        let is_rounded = self.digits() > 2
            && told.decimals > self.decimals
            && off <= half(self.decimals) + half(told.decimals) + 1e-9;
        let is_same = off < 1e-9 && told.decimals >= self.decimals;
        (is_same || is_rounded) && (told.is_negative || !self.is_negative)
    }
}

#[test]
fn numbers_are_compared_as_they_are_rounded() {
    let read = |text: &str| Written::all(text).into_iter().map(|number| number.text).collect::<Vec<_>>();
    assert_eq!(read("60\u{202f}346 px, (−0.50, 7). In 1.2"), ["60346", "−0.50", "7", "1.2"]);
    let is = |written: &str, told: &str| Written::all(written)[0].is(&Written::all(told)[0]);
    assert!(is("6.14", "6.135") && is("0.6", "0.600") && is("2901", "2901.12") && is("0.5", "−0.5"));
    assert!(!is("6.14", "6.146") && !is("0.6", "0.58") && !is("0.50", "0.5") && !is("637", "638"));
    assert!(!is("−0.5", "0.5"), "the sign counts");
    let measured = |text: &str| Written::all(text).iter().filter(|number| number.is_measured()).count();
    assert_eq!(measured("Kalman (1960) took 12 steps of 0.5 s and 225 tests"), 2);
}

/// Where numbers of a page stand that are not of its own steps and run.
enum Elsewhere {
    /// On another page.
    Page(&'static str, usize),
    /// At another step of its run.
    Step(&'static str),
    /// At the end of the run of another estimator on its clip.
    Of(&'static str),
    /// They follow from others.
    Follow,
}

/// Numbers in the words of a page that are not of its own steps and run.
const ELSEWHERE: &[(&str, usize, &[&str], Elsewhere)] = &[
    // 33 times 33 candidates.
    ("hierarchical-search", 1, &["1089"], Elsewhere::Page("sequential-search", 8)),
    ("hierarchical-search", 6, &["126", "24.68", "−12.15"], Elsewhere::Page("hierarchical-search", 7)),
    ("gradient-constraint", 1, &["0.5", "0.25"], Elsewhere::Page("gradient-constraint", 2)),
    ("gradient-constraint", 4, &["170", "110"], Elsewhere::Page("gradient-constraint", 5)),
    // 12 px on level 3.
    ("lucas-kanade", 7, &["1.5"], Elsewhere::Follow),
    // The motion of the scene.
    ("horn-schunck", 3, &["0.6", "0.3"], Elsewhere::Follow),
    ("horn-schunck", 5, &["0.6", "0.3"], Elsewhere::Follow),
    ("horn-schunck", 5, &["300", "0.548", "0.266"], Elsewhere::Step("300.3")),
    ("interest-points", 1, &["100", "120"], Elsewhere::Page("interest-points", 2)),
    ("interest-points", 8, &["128"], Elsewhere::Page("interest-points", 7)),
    ("background-subtraction", 7, &["8855"], Elsewhere::Page("background-subtraction", 6)),
    // From (1.98, 0.99) to (1.96, 0.96) px.
    ("motion-segmentation", 3, &["0.04"], Elsewhere::Follow),
    ("stereo-and-scene-flow", 3, &["37.2"], Elsewhere::Of("semi-global-matching")),
    // 8.82 m.
    ("stereo-and-scene-flow", 6, &["8.8"], Elsewhere::Follow),
    // 0.306 m and, in truth, 0.314 m, in cm.
    ("stereo-and-scene-flow", 7, &["30.6", "31.4"], Elsewhere::Follow),
    // 1.17 % on the page before, and 4.35 %.
    ("stereo-and-scene-flow", 9, &["1.2", "4.4"], Elsewhere::Follow),
];

/// The run of a page.
struct Run {
    prepared: Prepared,
    held: Option<Held>,
    walk: Box<dyn Walk>,
}

impl Run {
    /// That of a page, at the step that the page shows.
    fn of(page: &Page) -> Self {
        let Session { experiment, position, .. } = page.session.clone().expect("a page without faults");
        let prepared = Prepared::open(experiment, Open::default()).expect("a clip");
        let mut walk = prepared.experiment.walk(&prepared.clip).expect("a run");
        walk.jump(Move::To(position.cursor.unwrap_or_default()));
        Self { prepared, held: position.held, walk }
    }

    /// What it says where it stands.
    fn said(&self) -> String {
        let (walk, clip) = (&*self.walk, &self.prepared.clip);
        let at = self.held.and_then(|held| Chosen::Held(held).here(walk, clip).ok().flatten());
        let beside = walk.beside(at).into_iter().map(|member| member.step);
        [walk.step(at)].into_iter().chain(beside).map(|step| said(&step)).collect()
    }

    /// What it says up to the last step of its page, and what the page sets.
    fn said_on(&mut self, page: &Page) -> String {
        let Prepared { experiment, clip, .. } = &self.prepared;
        let (width, height) = clip.size();
        let all = experiment.side_by_side.all(&*experiment.estimator);
        let values = all.iter().flat_map(|of| of.values()).map(|(name, value)| format!("{name} {value}\n"));
        let lines = all.iter().flat_map(|of| of.info().pseudocode).map(|line| format!("{}\n", line.text));
        let pixel = self.held.map(|held| format!("{}\n", held.pixel));
        let mut text: String = values.chain(lines).chain(pixel).collect();
        text += &format!("{}\n{width}×{height}\n{}", experiment.source, self.said());
        let event = self.walk.info().granularities.len() - 1;
        while page.until.is_some_and(|until| self.walk.cursor() < until) && !self.walk.at_end() {
            self.walk.jump(Move::Granularity(event, Direction::Forward));
            text += &self.said();
        }
        text
    }

    /// What it says at its end, with the quality of the results.
    fn said_at_end(&mut self) -> String {
        self.walk.jump(Move::End);
        let reference = Reference { clip: &self.prepared.clip, frame: self.walk.frame() };
        let assessed = |output: &Output| {
            let Assessment { facts, headline, conclusion, .. } = output.assess(&reference).unwrap_or_default();
            format!("{}{headline}\n{conclusion}\n", listed(&facts))
        };
        let mut text = format!("{}{}\n", self.said(), self.walk.evaluated());
        let beside = self.walk.beside(None);
        for member in &beside {
            text += &assessed(&member.output);
            text += &member.candidates.as_ref().map_or_else(String::new, |count| format!("{}\n", count.in_all));
        }
        if beside.is_empty() {
            text += &assessed(&self.walk.output());
        }
        text
    }
}

/// The words and numbers of a step.
fn said(step: &Step) -> String {
    let readouts = step.readouts.iter().map(|readout| match readout {
        Readout::Facts(facts) => listed(facts),
        Readout::Equation(lines) => lines.iter().map(|line| format!("{}\n", line.plain())).collect(),
        _ => String::new(),
    });
    [format!("{}\n", step.sentence.plain())].into_iter().chain(readouts).collect()
}

fn listed(facts: &[Fact]) -> String {
    facts.iter().map(|fact| format!("{} {}\n", fact.label, fact.value)).collect()
}

/// The page of a lesson, counted from 1.
fn page_of(slug: &str, number: usize) -> &'static Page {
    let lesson = all().iter().find(|lesson| lesson.slug == slug).expect("a lesson");
    &lesson.pages[number - 1]
}

/// Takes away the numbers that a text has; what tells it is asked only where there are some.
fn strike(numbers: &mut Vec<Written>, tell: impl FnOnce() -> String) {
    if !numbers.is_empty() {
        let told = Written::all(&tell());
        numbers.retain(|number| !told.iter().any(|of| number.is(of)));
    }
}

/// What is said where numbers of `page` stand.
fn said_elsewhere(page: &Page, at: &Elsewhere) -> Option<String> {
    Some(match at {
        Elsewhere::Follow => return None,
        Elsewhere::Page(slug, number) => {
            let other = page_of(slug, *number);
            let mut run = Run::of(other);
            run.said_on(other) + &run.said_at_end()
        }
        Elsewhere::Step(cursor) => {
            let mut run = Run::of(page);
            run.walk.jump(Move::To(cursor.parse().expect("a step")));
            run.said()
        }
        Elsewhere::Of(id) => {
            let mut page = page.clone();
            let session = page.session.as_mut().expect("a page without faults");
            session.experiment.estimator = estimator(id).expect("an estimator");
            Run::of(&page).said_at_end()
        }
    })
}

#[test]
fn the_numbers_of_a_page_are_those_of_its_run() {
    let mut faults = Vec::new();
    let numbered = |lesson: &'static Lesson| (1..).zip(&lesson.pages).map(move |(number, page)| (lesson, number, page));
    for (lesson, number, page) in all().iter().flat_map(numbered) {
        let words = page.words.as_ref().expect("words").plain();
        let mut numbers = Written::all(&words);
        numbers.retain(Written::is_measured);
        let elsewhere = ELSEWHERE.iter().filter(|(slug, of, ..)| (*slug, *of) == (lesson.slug.as_str(), number));
        for (.., listed, at) in elsewhere {
            let (mut listed_here, others): (Vec<_>, Vec<_>) =
                numbers.into_iter().partition(|number| listed.contains(&number.text.as_str()));
            let there: BTreeSet<&str> = listed_here.iter().map(|number| number.text.as_str()).collect();
            let expected: BTreeSet<&str> = listed.iter().copied().collect();
            assert_eq!(there, expected, "{}, page {number}: the words have them", lesson.slug);
            if let Some(said) = said_elsewhere(page, at) {
                strike(&mut listed_here, || said);
                faults.extend(listed_here.iter().map(|of| format!("{}, page {number}: {}", lesson.slug, of.text)));
            }
            numbers = others;
        }
        if numbers.is_empty() {
            continue;
        }
        let mut run = Run::of(page);
        strike(&mut numbers, || run.said_on(page));
        strike(&mut numbers, || run.said_at_end());
        faults.extend(numbers.iter().map(|of| format!("{}, page {number}: {}", lesson.slug, of.text)));
    }
    assert!(faults.is_empty(), "{} numbers stand in no step:\n{}", faults.len(), faults.join("\n"));
}
