//! Which numbers of a formula are left out: its results, as far as they can be computed by hand from what is printed.

use motionscope_core::Role;
use motionscope_core::scene::Math;

use super::numbers::{self, Fill, all_numbers, filled_in, has_measured, has_unknown, inked, is_telling, tells};
use super::reach::{Printed, has_sum};
use crate::paint::{UNITS, places};

/// Signs between two sides.
const SIGNS: &str = "=→≈←";
/// Signs behind which a value is compared.
const COMPARED: &str = "≤≥<>";
/// Words of units of more than a word.
const WORDS: [&str; 4] = ["gray", "level", "levels", "of"];
/// Words for numbers of a matrix: what they stand for is worked out first.
const OPERATORS: [&str; 2] = ["det", "tr"];
/// Between a comparison and its verdict.
const VERDICT: &str = ": ";

/// Formulas with their results left out or filled in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exercise {
    /// The formulas, line by line.
    pub lines: Vec<Math>,
    /// What is left out, with the index of its line.
    pub answers: Vec<(usize, String)>,
}

/// Leaves out or fills in the results of `lines` that can be computed from what is `printed`, and those of other readouts, the
/// `known` ones.
pub fn exercise(lines: &[Math], (known, printed): (&[String], &Printed), fill: Fill) -> Exercise {
    let mut exercise = Exercise::default();
    let clauses: Vec<Vec<Clause>> = lines.iter().map(clauses).collect();
    for (index, line) in clauses.iter().enumerate() {
        let is_given = lines[index].plain().starts_with("with ");
        let before: Vec<String> = exercise.answers.iter().map(|(_, answer)| answer.clone()).collect();
        // A result of a line before must be computed there.
        let is_known = |number: &str| tells(number, before.iter().chain(known));
        let writing = Writing { fill, is_known: &is_known };
        let (mut parts, mut has_result, mut is_told) = (Vec::new(), false, false);
        for (number, clause) in line.iter().enumerate() {
            let place = InLines { earlier: &clauses[..index], line, number };
            let value = clause.value().filter(|value| {
                let is_value = !is_given && (number == 0 || clause.has_decimals(value));
                // What stands behind a result follows from it.
                is_value && (has_result || place.is_in_reach(value, printed))
            });
            let (part, answers) = match value {
                _ if is_told => writing.told(&clause.math()),
                Some(value) => {
                    has_result = true;
                    clause.left_out(&value, place.has_operators(), writing)
                }
                None => {
                    let compared = clause.compared(writing);
                    is_told = clause.verdict().is_some();
                    compared
                }
            };
            parts.push(part);
            exercise.answers.extend(answers.into_iter().map(|answer| (index, answer)));
        }
        exercise.lines.push(Math::Row(parts));
    }
    exercise
}

/// The numbers of all values that formulas lead to.
pub fn values(lines: &[Math]) -> Vec<String> {
    let of_clause = |clause: Clause| clause.value().map(|value| clause.numbers_in(&value)).unwrap_or_default();
    lines.iter().flat_map(clauses).flat_map(of_clause).collect()
}

/// A symbol that a formula defines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Defined {
    /// Its name in plain letters.
    pub name: String,
    /// Whether other symbols lead to it, without a sum of terms that are not written out.
    pub is_by_hand: bool,
}

/// The symbols that formulas define: what stands before their first sign.
pub fn defined(lines: &[Math]) -> Vec<Defined> {
    let clauses = lines.iter().flat_map(clauses);
    let symbol = |clause: Clause| {
        let first = clause.0.iter().position(|token| matches!(token, Token::Sign(_)))?;
        let plain: String = clause.0[..first].iter().map(|token| token.math().plain()).collect();
        let plain = plain.trim();
        let name = plain.split_once('(').map_or(plain, |(name, _)| name).trim();
        let by = row(&clause.0[first..]);
        let is_by_hand = has_unknown(&by) && !has_sum(&by);
        (!name.is_empty()).then(|| Defined { name: name.to_owned(), is_by_hand })
    };
    clauses.filter_map(symbol).collect()
}

/// How numbers are written.
#[derive(Clone, Copy)]
struct Writing<'a> {
    fill: Fill,
    /// Whether a number is left out elsewhere.
    is_known: &'a dyn Fn(&str) -> bool,
}

impl Writing<'_> {
    /// What stays, but for numbers that are left out elsewhere.
    fn given(self, math: &Math) -> Math {
        filled_in(math, self.fill, self.is_known)
    }

    /// What tells a verdict.
    fn told(self, math: &Math) -> (Math, Vec<String>) {
        let plain = math.plain();
        (self.fill.word(&plain), vec![plain])
    }
}

/// The place of a clause among the lines.
#[derive(Clone, Copy)]
struct InLines<'a> {
    earlier: &'a [Vec<Clause>],
    line: &'a [Clause],
    number: usize,
}

impl<'a> InLines<'a> {
    /// The sides of the clause, behind those of the one before if it goes on with that.
    fn sides(self) -> Vec<&'a [Token]> {
        let own = self.line[self.number].sides();
        if !own.first().is_some_and(|side| is_bare(side)) {
            return own;
        }
        let before = match self.number {
            0 => self.earlier.last().and_then(|line| line.last()),
            number => self.line.get(number - 1),
        };
        before.map(Clause::sides).unwrap_or_default().into_iter().chain(own.into_iter().skip(1)).collect()
    }

    /// Whether the `value` of the clause can be computed by hand.
    fn is_in_reach(self, value: &Place, printed: &Printed) -> bool {
        // Numbers beside unknowns: a system that leads to the value.
        if self.earlier.iter().flatten().any(Clause::is_system) {
            return true;
        }
        let sides = self.sides();
        // The first side is a name, the last one the value.
        let names_and_value = sides.len().saturating_sub(1);
        let before = sides[..names_and_value].iter().skip(1).rev().find(|side| !is_bare(side));
        let numbers = self.line[self.number].numbers_in(value);
        before.is_some_and(|side| printed.reaches(&row(side), &numbers))
    }

    /// Whether numbers of a matrix stand in its formula, to be worked out first.
    fn has_operators(self) -> bool {
        let plain: String = self.sides().into_iter().map(|side| row(side).plain() + " ").collect();
        plain.split(|letter: char| !letter.is_alphabetic()).any(|word| OPERATORS.contains(&word))
    }
}

/// A part of a line.
#[derive(Clone, Debug, PartialEq)]
enum Token {
    /// A sign between two sides.
    Sign(String),
    /// A sign behind which something is compared.
    Compared(String),
    /// Anything else.
    Part(Math),
}

impl Token {
    fn math(&self) -> Math {
        match self {
            Token::Sign(text) | Token::Compared(text) => Math::text(text.as_str()),
            Token::Part(math) => math.clone(),
        }
    }
}

/// What stands between two commas of a line.
#[derive(Clone, Debug, Default, PartialEq)]
struct Clause(Vec<Token>);

/// The tokens of a clause that are a value.
type Place = std::ops::Range<usize>;

impl Clause {
    fn math(&self) -> Math {
        row(&self.0)
    }

    /// What stands between its signs.
    fn sides(&self) -> Vec<&[Token]> {
        self.0.split(|token| matches!(token, Token::Sign(_))).collect()
    }

    /// The last sign, and the value behind it, if it is one.
    fn sign_and_value(&self) -> Option<(usize, Place)> {
        let sign = self.0.iter().rposition(|token| matches!(token, Token::Sign(_)))?;
        let end = self.0[sign..].iter().position(|token| matches!(token, Token::Compared(_)));
        let place = sign + 1..end.map_or(self.0.len(), |end| sign + end);
        is_value(&self.0[place.clone()]).then_some((sign, place))
    }

    /// Whether it has numbers beside unknowns before a value: a system that is to be solved, not a value that was computed.
    fn is_system(&self) -> bool {
        let Some((sign, _)) = self.sign_and_value() else { return false };
        let left = self.0[..sign].rsplit(|token| matches!(token, Token::Sign(_))).next().unwrap_or_default();
        left.iter().any(|token| has_unknown(&token.math())) && left.iter().any(|token| has_measured(&token.math()))
    }

    /// Where its result stands, if it has one.
    fn value(&self) -> Option<Place> {
        self.sign_and_value().filter(|_| !self.is_system()).map(|(_, place)| place)
    }

    fn numbers_in(&self, place: &Place) -> Vec<String> {
        self.0[place.clone()].iter().flat_map(|token| all_numbers(&token.math())).collect()
    }

    /// Whether a value behind a comma was computed, unlike a constant such as 1.
    fn has_decimals(&self, value: &Place) -> bool {
        let follows_so = matches!(self.0.first(), Some(Token::Part(Math::Text(text, _))) if text == " so");
        follows_so || self.numbers_in(value).iter().any(|number| number.contains('.'))
    }

    /// The clause with its value left out or filled in, the sign that compares it, and the numbers of a matrix if they are to be
    /// `worked_out`; and what all that is.
    fn left_out(&self, value: &Place, worked_out: bool, writing: Writing<'_>) -> (Math, Vec<String>) {
        let (mut parts, mut answers) = (Vec::new(), Vec::new());
        let is_compared = self.0[value.end..].iter().any(|token| !all_numbers(&token.math()).is_empty());
        // A sign before the value compares something else.
        let is_asked = |index: usize| is_compared && index >= value.end;
        for (index, token) in self.0.iter().enumerate() {
            let math = token.math();
            let (part, left_out) = match token {
                Token::Compared(sign) if is_asked(index) => (writing.fill.word(sign), vec![sign.clone()]),
                Token::Part(_) if value.contains(&index) => value_left_out(&math, writing),
                Token::Part(_) if worked_out && index < value.start => {
                    let inked: Vec<String> = inked(&math).into_iter().filter(|number| is_telling(number)).collect();
                    let is_chosen =
                        |number: &str| inked.iter().any(|other| other == number) || (writing.is_known)(number);
                    (filled_in(&math, writing.fill, &is_chosen), inked)
                }
                _ => (writing.given(&math), Vec::new()),
            };
            parts.push(part);
            answers.extend(left_out);
        }
        (Math::Row(parts), answers)
    }

    /// The sign that compares two numbers, of which the left one was measured.
    fn comparison(&self) -> Option<usize> {
        let at = self.0.iter().position(|token| matches!(token, Token::Compared(_)))?;
        let left = self.0[..at].rsplit(|token| matches!(token, Token::Sign(_))).next()?;
        let has_both = left.iter().any(|token| has_measured(&token.math()))
            && self.0[at..].iter().any(|token| !all_numbers(&token.math()).is_empty());
        has_both.then_some(at)
    }

    /// Where the verdict on a comparison begins, if it is told: the token, and the byte in its text.
    fn verdict(&self) -> Option<(usize, usize)> {
        let at = self.comparison()?;
        let begins = |(index, token): (usize, &Token)| match token {
            Token::Part(Math::Text(text, _)) if index > at => Some((index, text.find(VERDICT)? + VERDICT.len())),
            _ => None,
        };
        self.0.iter().enumerate().find_map(begins)
    }

    /// The clause without a result of its own: the sign of a comparison is left out or filled in, or the verdict on it if that is
    /// told.
    fn compared(&self, writing: Writing<'_>) -> (Math, Vec<String>) {
        let Some(at) = self.comparison() else { return (writing.given(&self.math()), Vec::new()) };
        if let Some((index, from)) = self.verdict() {
            let given = writing.given(&row(&self.0[..index]));
            let last = self.0[index].math().plain();
            let (before, first) = last.split_at(from);
            let verdict = first.to_owned() + &row(&self.0[index + 1..]).plain();
            let parts = vec![given, writing.given(&Math::text(before)), writing.fill.word(&verdict)];
            return (Math::Row(parts), vec![verdict]);
        }
        let sign = self.0[at].math().plain();
        let [before, behind] = [&self.0[..at], &self.0[at + 1..]].map(|tokens| writing.given(&row(tokens)));
        (Math::Row(vec![before, writing.fill.word(&sign), behind]), vec![sign])
    }
}

/// A part of a value left out or filled in, and what it is; what stands in parentheses behind it says more of it.
fn value_left_out(math: &Math, writing: Writing<'_>) -> (Math, Vec<String>) {
    let (value, rest) = match math {
        Math::Text(text, role) => {
            let (value, rest) = text.split_at(value_end(text));
            (Math::Text(value.to_owned(), *role), Some(rest).filter(|rest| !rest.is_empty()))
        }
        other => (other.clone(), None),
    };
    let parts = [filled_in(&value, writing.fill, &|_| true)];
    let rest = rest.map(|rest| writing.given(&Math::text(rest)));
    (Math::Row(parts.into_iter().chain(rest).collect()), all_numbers(&value))
}

/// Tokens one after the other.
fn row(tokens: &[Token]) -> Math {
    Math::Row(tokens.iter().map(Token::math).collect())
}

/// Whether a side is empty, or says no more than that something follows.
fn is_bare(side: &[Token]) -> bool {
    matches!(row(side).plain().trim(), "" | "so")
}

/// The clauses of a line, each with the comma behind it.
fn clauses(line: &Math) -> Vec<Clause> {
    let mut parts = Vec::new();
    flatten(line, &mut parts);
    let (mut all, mut clause, mut depth) = (Vec::new(), Clause::default(), 0);
    for part in parts {
        let Math::Text(text, role) = part else {
            clause.0.push(Token::Part(part.clone()));
            continue;
        };
        let mut words = String::new();
        let end = |words: &mut String, clause: &mut Clause, role: Option<Role>| {
            if !words.is_empty() {
                clause.0.push(Token::Part(Math::Text(std::mem::take(words), role)));
            }
        };
        for letter in text.chars() {
            depth += i32::from("([{".contains(letter)) - i32::from(")]}".contains(letter));
            match letter {
                _ if depth > 0 => words.push(letter),
                _ if SIGNS.contains(letter) => {
                    end(&mut words, &mut clause, *role);
                    clause.0.push(Token::Sign(letter.to_string()));
                }
                _ if COMPARED.contains(letter) => {
                    end(&mut words, &mut clause, *role);
                    clause.0.push(Token::Compared(letter.to_string()));
                }
                ',' => {
                    words.push(letter);
                    end(&mut words, &mut clause, *role);
                    all.push(std::mem::take(&mut clause));
                }
                _ => words.push(letter),
            }
        }
        if let Some(number) = words.strip_prefix(" so ").map(str::to_owned) {
            clause.0.extend([Token::Part(Math::text(" so")), Token::Sign(" ".into())]);
            words = number;
        }
        end(&mut words, &mut clause, *role);
    }
    all.push(clause);
    all.retain(|clause| !clause.0.is_empty());
    all
}

fn flatten<'a>(math: &'a Math, parts: &mut Vec<&'a Math>) {
    match math {
        Math::Row(inner) => inner.iter().for_each(|part| flatten(part, parts)),
        other => parts.push(other),
    }
}

/// Whether tokens are one value: a number, a pair of them, a matrix of numbers, each with its unit.
fn is_value(tokens: &[Token]) -> bool {
    let [first, rest @ ..] = tokens else { return false };
    if let Token::Part(Math::Matrix(rows)) = first {
        let is_number = |entry: &Math| matches!(entry, Math::Text(text, _) if places(text).len() == 1);
        return rows.iter().flatten().all(is_number) && rest.iter().all(|token| all_numbers(&token.math()).is_empty());
    }
    let is_text = |token: &Token| matches!(token, Token::Part(Math::Text(..)));
    if !tokens.iter().all(is_text) {
        return false;
    }
    let text: String = tokens.iter().map(|token| token.math().plain()).collect();
    value_end(&text) > 0 && !numbers::of(&text).is_empty()
}

/// The bytes of `text` that are a value with its unit, up to a remark in parentheses; 0 if it does not begin with one.
fn value_end(text: &str) -> usize {
    let found = places(text);
    let Some(first) = found.first() else { return text.len() };
    let is_joint = |joint: &str| joint.chars().all(|c| " (),\u{a0}".contains(c));
    if !is_joint(&text[..first.start]) {
        return 0;
    }
    let is_tuple = text[..first.start].contains('(');
    let mut end = first.end;
    for place in found.iter().skip(1).take_while(|_| is_tuple) {
        if !is_joint(&text[end..place.start]) {
            break;
        }
        end = place.end;
    }
    let rest = &text[end..];
    let (unit, _) = rest.split_once(" (").unwrap_or((rest, ""));
    let is_word = |word: &str| UNITS.contains(&word) || WORDS.contains(&word);
    let of_unit = |word: &str| word.is_empty() || is_word(word) || places(word).len() == 1;
    let is_unit = unit.split([' ', '\u{a0}']).all(|word| of_unit(word.trim_matches([')', ',', '.', ']'])));
    if is_unit { end + unit.len() } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str) -> Math {
        Math::text(text)
    }

    fn answers(lines: &[Math]) -> Vec<String> {
        left_out(lines, Fill::Blank).answers.into_iter().map(|(_, answer)| answer).collect()
    }

    /// The exercise where nothing but the formulas is printed.
    fn left_out(lines: &[Math], fill: Fill) -> Exercise {
        exercise(lines, (&[], &Printed::default()), fill)
    }

    fn plain(lines: &[Math]) -> Vec<String> {
        lines.iter().map(Math::plain).collect()
    }

    #[test]
    fn what_stands_behind_the_last_sign_is_left_out() {
        assert_eq!(answers(&[line("= |228 − 186| + |210 − 195|"), line("= 9741")]), ["9741"]);
        assert_eq!(answers(&[line("y = (60.00, 120.00) + (5.44, 7.73) = (65.44, 127.73) px")]), ["65.44", "127.73"]);
        for unit in UNITS {
            assert_eq!(answers(&[line(&format!("v = 25.00 / 2 = 12.50 {unit}"))]), ["12.50"], "{unit}");
        }
        assert_eq!(answers(&[line("= (log 0.01)/(log 0.59), so 7 (at most 2000)")]), ["7"]);
        assert_eq!(answers(&[line("p = −1.25 + 0.50 = −0.75, q = 0.53")]), ["−0.75", "0.53"]);
        assert!(answers(&[line("with DT = 0, FT = 1")]).is_empty());
    }

    #[test]
    fn what_cannot_be_computed_from_what_is_printed_is_given() {
        assert!(answers(&[line("y = (65.44, 127.73) px")]).is_empty(), "nothing leads to it");
        assert!(answers(&[line("N = 1024, T = 145.36, I = 198.20")]).is_empty());
        let mean = Math::Row(vec![Math::Sum(Box::new(Math::Var("i"))), Math::Var("x")]);
        let sum = Math::Row(vec![Math::Var("y"), line(" = "), mean, line(" = 66.38 px")]);
        assert!(answers(std::slice::from_ref(&sum)).is_empty(), "the terms of the sum are not printed");
        assert_eq!(plain(&left_out(std::slice::from_ref(&sum), Fill::Blank).lines), [sum.plain()]);
        assert_eq!(defined(&[sum]), [Defined { name: "y".into(), is_by_hand: false }]);
        let product = Math::Row(vec![Math::Var("y"), line(" = 2 "), Math::Bold("H")]);
        let of = |line: Math| defined(&[line]).iter().map(|one| one.is_by_hand).collect::<Vec<_>>();
        assert_eq!((of(product), of(line("IoU = 0.92"))), (vec![true], vec![false]), "a value is no definition");
    }

    #[test]
    fn the_sign_of_a_decision_is_left_out() {
        let lines = [line("d = 0.25 + 0.50 = 0.75 ≤ 9.21"), line("with IoU = 0.62 ≥ 0.20, a ≤ b")];
        let exercise = left_out(&lines, Fill::Blank);
        let found: Vec<_> = exercise.answers.iter().map(|(_, answer)| answer.as_str()).collect();
        assert_eq!(found, ["0.75", "≤", "≥"]);
        let shown = plain(&exercise.lines);
        assert!(!shown[0].contains('≤') && shown[0].contains("9.21"), "{shown:?}");
        assert!(!shown[1].contains('≥') && shown[1].ends_with("a ≤ b"), "{shown:?}");
        assert_eq!(plain(&left_out(&lines, Fill::Answer).lines), plain(&lines));
        let between = [line("0 < d = 0.25 + 0.50 = 0.75 ≤ 9.21")];
        assert_eq!(answers(&between), ["0.75", "≤"]);
        let shown = plain(&left_out(&between, Fill::Blank).lines);
        assert!(shown[0].starts_with("0 < d = 0.25"), "a sign before the value is given: {shown:?}");
    }

    #[test]
    fn a_verdict_is_left_out_with_what_follows_from_it() {
        let lines = [line("140.84 < 54.08: false, bit 0")];
        assert_eq!(answers(&lines), ["false,", " bit 0"]);
        let shown = plain(&left_out(&lines, Fill::Blank).lines);
        assert!(shown[0].starts_with("140.84 < 54.08: □") && !shown[0].contains("bit"), "{shown:?}");
        assert_eq!(plain(&left_out(&lines, Fill::Answer).lines), plain(&lines));
    }

    #[test]
    fn determinant_and_trace_are_worked_out_first() {
        let inked = |number| Math::ink(Role::Reference, number);
        let tensor = || Math::Bold("T");
        let symbols = Math::Row(vec![Math::Var("R"), line(" = det "), tensor(), line(" − k tr "), tensor()]);
        let [first, second] = ["318.56", "263.20"].map(inked);
        let numbers = Math::Row(vec![line(" = "), first, line(" − 0.04 · "), second, line(" = 308.03")]);
        assert_eq!(answers(&[symbols.clone(), numbers.clone()]), ["318.56", "263.20", "308.03"]);
        assert_eq!(answers(&[line("R = a − k b"), numbers.clone()]), ["308.03"]);
        let shown = plain(&left_out(&[symbols, numbers], Fill::Blank).lines);
        assert!(shown[1].contains("0.04"), "a parameter is given: {shown:?}");
    }

    #[test]
    fn a_system_is_given_and_its_solution_is_left_out() {
        let system =
            Math::Row(vec![line("1094.55 "), Math::Var("u"), line(" + 130.93 "), Math::Var("v"), line(" = 584.47")]);
        let solution =
            Math::Row(vec![line("("), Math::Var("u"), line(", "), Math::Var("v"), line(") = (0.504,\u{a0}0.255)")]);
        assert_eq!(answers(&[system, solution]), ["0.504", "0.255"]);
    }

    #[test]
    fn a_result_does_not_stand_in_later_lines() {
        let lines = [line("s = 4.10 / 2.00 = 2.05"), line("u = 7.00 − 2.05 = 4.95")];
        let exercise = left_out(&lines, Fill::Blank);
        let shown: String = plain(&exercise.lines).concat();
        assert!(!shown.contains("2.05") && !shown.contains("4.95") && shown.contains("7.00"), "{shown}");
        assert_eq!(plain(&left_out(&lines, Fill::Answer).lines), plain(&lines));
        assert_eq!(values(&lines), ["2.05", "4.95"]);
        let rounded = [line("s = 4.10 / 2.00 = 2.05"), line("u = 7.00 − 2.051 = 4.95")];
        let shown: String = plain(&left_out(&rounded, Fill::Blank).lines).concat();
        assert!(!shown.contains("2.05"), "it is not told with more digits either: {shown}");
    }
}
