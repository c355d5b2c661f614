//! Labelled numbers of a worksheet: which are left out with what is asked for elsewhere, and which would tell it.

use motionscope_core::scene::{Fact, Math, Role};

use super::numbers::{self, Fill, filled, tells};
use super::vector::Vector;
use crate::paint::places;

/// Between the numbers of a value and words that judge them.
const VERDICT: &str = ": ";
/// Letters of a word at least: what is shorter names a number, as in d = 12.
const LEAST_WORD: usize = 3;

/// What is asked for elsewhere on a sheet, and what was known before.
#[derive(Clone, Copy)]
pub struct Elsewhere<'a> {
    /// The numbers that are left out.
    pub numbers: &'a [String],
    /// The labelled numbers of the step before.
    pub before: &'a [Fact],
    /// Whether something is decided.
    pub is_decided: bool,
    /// Whether a candidate is tested.
    pub is_test: bool,
}

/// Labelled numbers as lines, and what is left out of them.
type Lines = (Vec<Math>, Vec<String>);

impl Elsewhere<'_> {
    /// The labelled numbers without those that would tell what is asked for; what is asked for is left out or filled in.
    pub fn facts(self, facts: &[Fact], fill: Fill) -> Lines {
        let asked = facts.iter().filter(|fact| self.asks(&fact.value));
        let vectors: Vec<Vector<'_>> = asked.filter_map(|fact| Vector::of(&fact.value)).collect();
        // What was said of another pixel, block or track is not known of this one.
        let before = if item(facts) == item(self.before) { self.before } else { &[] };
        let (mut lines, mut answers) = (Vec::new(), Vec::new());
        for (index, fact) in facts.iter().enumerate() {
            let is_length = vectors.iter().any(|vector| vector.has_length(&fact.value));
            let is_told = is_length || self.asks(&fact.value);
            let judges = index >= item(facts).len() && is_verdict(fact, before);
            if fill == Fill::Blank && self.is_hidden(fact, is_told, judges) {
                continue;
            }
            let is_whole = is_length || self.is_asked(&fact.value) || fact.role == Some(Role::Result) && is_told;
            let chosen = |number: &str| is_whole || tells(number, self.numbers);
            let (line, left_out) = self.line(fact, &chosen, fill);
            lines.push(line);
            answers.extend(left_out);
        }
        (lines, answers)
    }

    /// A labelled number with the numbers that are `chosen` and the verdict on a decision left out or filled in.
    fn line(self, fact: &Fact, chosen: &dyn Fn(&str) -> bool, fill: Fill) -> (Math, Vec<String>) {
        let (value, verdict) = split(&fact.value);
        let verdict = verdict.filter(|_| self.is_decided);
        let value: &str = if verdict.is_some() { value } else { &fact.value };
        let mut parts = vec![Math::text(format!("{}: ", fact.label)), filled(value, None, fill, chosen)];
        let mut answers: Vec<String> = numbers::of(value).into_iter().filter(|number| chosen(number)).collect();
        if let Some(verdict) = verdict {
            parts.extend([Math::text(VERDICT), fill.word(verdict)]);
            answers.push(verdict.to_owned());
        }
        (Math::Row(parts), answers)
    }

    /// Whether a whole value is asked for: one that is nothing but a result tells it, however few its digits.
    fn is_asked(self, value: &str) -> bool {
        self.numbers.iter().any(|number| number == value)
    }

    /// Whether a value or a number in it is asked for.
    fn asks(self, value: &str) -> bool {
        self.is_asked(value) || numbers::of(value).iter().any(|number| tells(number, self.numbers))
    }

    /// Whether a labelled number would tell what is asked for, whether it `is_told` itself or `judges` with its words.
    fn is_hidden(self, fact: &Fact, is_told: bool, judges: bool) -> bool {
        match fact.role {
            // What is compared with the truth would tell the result.
            Some(Role::Truth | Role::Error) => true,
            // A result that cannot be computed could tell one that is asked for.
            Some(Role::Result) => !is_told,
            // The best one so far tells whether the candidate is that.
            Some(Role::Best) if self.is_test && self.is_decided => true,
            _ => judges && self.is_decided,
        }
    }
}

/// What labelled numbers are about: the first one, and whole numbers behind it.
fn item(facts: &[Fact]) -> &[Fact] {
    let is_whole = |fact: &&Fact| fact.value.chars().all(|c| c.is_ascii_digit());
    let count = 1 + facts.iter().skip(1).take_while(is_whole).count();
    &facts[..count.min(facts.len())]
}

/// Whether the words of a labelled number tell what was decided: words before its first number are new, or others stood behind it
/// `before`.
fn is_verdict(fact: &Fact, before: &[Fact]) -> bool {
    let is_other = |earlier: &Fact| words_of(&earlier.value) != words_of(&fact.value);
    let mut earlier = before.iter().filter(|earlier| earlier.label == fact.label);
    match begins_with_words(&fact.value) {
        true => earlier.all(is_other),
        false => earlier.any(|earlier| !begins_with_words(&earlier.value) && is_other(earlier)),
    }
}

/// The words of a value before its verdict, numbers apart, each in the singular.
fn words_of(value: &str) -> Vec<String> {
    let (value, _) = split(value);
    let mut rest = value.to_owned();
    for place in places(value).into_iter().rev() {
        rest.replace_range(place, " ");
    }
    let words = rest.split_whitespace().map(|word| word.trim_matches(|c: char| !c.is_alphabetic()));
    words.map(|word| word.trim_end_matches('s').to_owned()).filter(|word| !word.is_empty()).collect()
}

/// Whether a value has words before its first number, or no number.
fn begins_with_words(value: &str) -> bool {
    let is_word = |word: &str| word.chars().count() >= LEAST_WORD;
    places(value).first().is_none_or(|place| value[..place.start].split(|c: char| !c.is_alphabetic()).any(is_word))
}

/// The numbers of a value, and the words behind them that judge them, if there are any.
fn split(value: &str) -> (&str, Option<&str>) {
    match value.rsplit_once(VERDICT) {
        Some((given, words)) if !numbers::of(given).is_empty() && numbers::of(words).is_empty() => (given, Some(words)),
        _ => (value, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts(all: &[(&'static str, &str)]) -> Vec<Fact> {
        all.iter().map(|(label, value)| Fact::new(label, *value, None)).collect()
    }

    /// The lines that are printed where these `numbers` are asked for, or something is decided.
    fn printed((now, before): (&[Fact], &[Fact]), asked: &[&str], is_decided: bool, fill: Fill) -> String {
        let numbers: Vec<String> = asked.iter().map(|number| (*number).to_owned()).collect();
        let elsewhere = Elsewhere { numbers: &numbers, before, is_decided, is_test: false };
        elsewhere.facts(now, fill).0.iter().map(|line| line.plain() + "\n").collect()
    }

    #[test]
    fn words_that_are_new_tell_the_decision() {
        let now = facts(&[
            ("Pixel", "(158, 143)"),
            ("Threshold", "5546.09"),
            ("Model", "constant velocity"),
            ("Status", "local maximum, rejected within 7 px of (153, 146)"),
            ("NIS", "1.02, gate 9.21"),
            ("From the other view", "d = 12"),
        ]);
        let waiting = facts(&[
            ("Pixel", "(158, 143)"),
            ("Model", "constant velocity"),
            ("Status", "local maximum, stands 7 px beside (9, 9)"),
            ("NIS", "3.40, gate 9.21"),
        ]);
        let told = |before: &[Fact], fill| printed((&now, before), &[], true, fill);
        let shown = told(&waiting, Fill::Blank);
        assert!(!shown.contains("Status") && !shown.contains("rejected"), "{shown}");
        for given in ["constant velocity", "5546.09", "gate 9.21"] {
            assert!(shown.contains(given), "{given}: {shown}");
        }
        let mut of_another = now.clone();
        of_another[0].value = "(20, 40)".into();
        let shown = told(&of_another, Fill::Blank);
        assert!(!shown.contains("Status"), "it was said of another pixel: {shown}");
        assert!(shown.contains("gate 9.21") && shown.contains("d = 12") && shown.contains("(158, 143)"), "{shown}");
        assert!(told(&waiting, Fill::Answer).contains("rejected within 7 px of (153, 146)"));
        assert!(printed((&now, &waiting), &[], false, Fill::Blank).contains("Status"), "nothing is decided");
    }

    #[test]
    fn the_words_of_another_track_of_the_frame_are_not_known_of_this_one() {
        let of_track = |track| facts(&[("Frame", "4"), ("Track", track), ("Status", "tentative"), ("Hits", "2")]);
        let shown = |before| printed((&of_track("1"), &of_track(before)), &[], true, Fill::Blank);
        assert!(shown("1").contains("tentative") && !shown("2").contains("tentative"));
        assert!(shown("2").contains("Frame: 4") && shown("2").contains("Hits: 2"));
    }

    #[test]
    fn words_between_numbers_tell_the_decision_unless_only_their_numbers_changed() {
        let before = facts(&[("Track", "3"), ("Seen", "1 frame"), ("Spread", "2.10 px, near 4.00")]);
        let now = facts(&[("Track", "3"), ("Seen", "2 frames"), ("Spread", "6.20 px, far from 4.00")]);
        let shown = printed((&now, &before), &[], true, Fill::Blank);
        assert!(shown.contains("2 frames") && !shown.contains("far"), "{shown}");
    }

    #[test]
    fn what_is_asked_for_is_not_printed_as_a_length_or_rounded() {
        let now = facts(&[
            ("Velocity", "(9.30,\u{a0}0.46) px/frame"),
            ("Speed", "9.31 px/frame"),
            ("Gain", "0.82"),
            ("Frame", "3"),
            ("σ", "(1.81, 1.81) px"),
        ]);
        let asked = ["9.30", "0.46", "0.817"];
        let shown = printed((&now, &[]), &asked, false, Fill::Blank);
        for told in ["9.30", "0.46", "9.31", "0.82"] {
            assert!(!shown.contains(told), "{told} is told: {shown}");
        }
        assert!(shown.contains("Speed: ") && shown.contains("px/frame") && shown.contains("(1.81, 1.81)"), "{shown}");
        let solved = printed((&now, &[]), &asked, false, Fill::Answer);
        assert!(solved.contains("Speed: 9.31 px/frame") && solved.contains("Gain: 0.82"), "{solved}");
        let given = printed((&now, &[]), &["4.50"], false, Fill::Blank);
        assert!(given.contains("9.31 px/frame"), "the velocity is given: {given}");
    }
}
