//! Which numbers of a formula are its results: what stands behind the last equals sign, if it is a value.

use motionscope_core::Role;
use motionscope_core::scene::Math;

use super::numbers::{self, Fill, filled_in, is_telling};
use crate::paint::UNITS;

/// Signs between two sides.
const SIGNS: &str = "=→≈←";
/// Signs behind which a value is compared.
const COMPARED: &str = "≤≥<>";
/// Words of units of more than a word.
const WORDS: [&str; 4] = ["gray", "level", "levels", "of"];

/// Formulas with their results left out or filled in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exercise {
    /// The formulas, line by line.
    pub lines: Vec<Math>,
    /// What is left out, with the index of its line.
    pub answers: Vec<(usize, String)>,
}

/// Leaves out or fills in the results of `lines`, and those of other readouts, the `known` ones.
pub fn exercise(lines: &[Math], known: &[String], fill: Fill) -> Exercise {
    let mut exercise = Exercise::default();
    let clauses: Vec<Vec<Clause>> = lines.iter().map(clauses).collect();
    let has_values = clauses.iter().flatten().any(|clause| clause.value().is_some());
    for (index, line) in clauses.iter().enumerate() {
        let is_given = lines[index].plain().starts_with("with ");
        let before: Vec<String> = exercise.answers.iter().map(|(_, answer)| answer.clone()).collect();
        // A result of a line before must be computed there.
        let is_known = |number: &str| is_telling(number) && before.iter().chain(known).any(|other| other == number);
        let mut parts = Vec::new();
        for (number, clause) in line.iter().enumerate() {
            let value = clause.value().filter(|value| !is_given && (number == 0 || clause.has_decimals(value)));
            let (part, answers) = match value {
                Some(value) => clause.left_out(value, fill, &is_known),
                None if has_values => (filled_in(&clause.math(), fill, &is_known), Vec::new()),
                None => clause.without_factors(fill),
            };
            parts.push(part);
            exercise.answers.extend(answers.into_iter().map(|answer| (index, answer)));
        }
        exercise.lines.push(Math::Row(parts));
    }
    exercise
}

/// The symbols that formulas define: what stands before their first sign, in plain letters.
pub fn defined(lines: &[Math]) -> Vec<String> {
    let clauses = lines.iter().flat_map(clauses);
    let symbol = |clause: Clause| {
        let first = clause.0.iter().position(|token| matches!(token, Token::Sign(_)))?;
        let plain: String = clause.0[..first].iter().map(|token| token.math().plain()).collect();
        let plain = plain.trim();
        let name = plain.split_once('(').map_or(plain, |(name, _)| name).trim();
        (!name.is_empty()).then(|| name.to_owned())
    };
    clauses.filter_map(symbol).collect()
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
        Math::Row(self.0.iter().map(Token::math).collect())
    }

    /// Where its result stands, if it has one.
    fn value(&self) -> Option<Place> {
        let is_sign = |token: &Token| matches!(token, Token::Sign(_));
        let sign = self.0.iter().rposition(is_sign)?;
        let end = self.0[sign..].iter().position(|token| matches!(token, Token::Compared(_)));
        let place = sign + 1..end.map_or(self.0.len(), |end| sign + end);
        let from = self.0[..sign].iter().rposition(is_sign).map_or(0, |sign| sign + 1);
        let (left, value) = (&self.0[from..sign], &self.0[place.clone()]);
        // Numbers beside unknowns: a system that is to be solved, not a value that was computed.
        let is_system = left.iter().any(|token| has_unknown(&token.math())) && left.iter().any(has_numbers);
        (!is_system && is_value(value)).then_some(place)
    }

    /// Whether a value behind a comma was computed, unlike a constant such as 1.
    fn has_decimals(&self, value: &Place) -> bool {
        let follows_so = matches!(self.0.first(), Some(Token::Part(Math::Text(text, _))) if text == " so");
        follows_so || self.0[value.clone()].iter().flat_map(numbers_of).any(|number| number.contains('.'))
    }

    /// The clause with its value left out or filled in, and what that is.
    fn left_out(&self, value: Place, fill: Fill, is_known: &dyn Fn(&str) -> bool) -> (Math, Vec<String>) {
        let (mut parts, mut answers) = (Vec::new(), Vec::new());
        for (index, token) in self.0.iter().enumerate() {
            if !value.contains(&index) {
                parts.push(filled_in(&token.math(), fill, is_known));
                continue;
            }
            // What stands in parentheses behind a value says more of it.
            let math = token.math();
            let (value, rest) = match &math {
                Math::Text(text, role) => {
                    let (value, rest) = text.split_at(value_end(text));
                    (Math::Text(value.to_owned(), *role), Some(rest.to_owned()).filter(|rest| !rest.is_empty()))
                }
                other => (other.clone(), None),
            };
            answers.extend(all_numbers(&value));
            parts.push(filled_in(&value, fill, &|_| true));
            parts.extend(rest.map(|rest| filled_in(&Math::text(rest), fill, is_known)));
        }
        (Math::Row(parts), answers)
    }

    /// The clause with the decimal factors of its right side left out or filled in, and what they are.
    fn without_factors(&self, fill: Fill) -> (Math, Vec<String>) {
        let is_sign = |token: &Token| matches!(token, Token::Sign(_));
        let sign = self.0.iter().position(is_sign).unwrap_or(self.0.len());
        let (mut parts, mut answers) = (Vec::new(), Vec::new());
        for (index, token) in self.0.iter().enumerate() {
            match token {
                Token::Part(part @ Math::Text(text, _)) if index > sign => {
                    let is_factor = |number: &str| number.contains('.') && is_telling(number);
                    answers.extend(numbers::of(text).into_iter().filter(|number| is_factor(number)));
                    parts.push(filled_in(part, fill, &is_factor));
                }
                other => parts.push(other.math()),
            }
        }
        (Math::Row(parts), answers)
    }
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
        let is_number = |entry: &Math| matches!(entry, Math::Text(text, _) if numbers::places(text).len() == 1);
        return rows.iter().flatten().all(is_number) && rest.iter().all(|token| numbers_of(token).is_empty());
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
    let places = numbers::places(text);
    let Some(first) = places.first() else { return text.len() };
    let is_joint = |joint: &str| joint.chars().all(|c| " (),\u{a0}".contains(c));
    if !is_joint(&text[..first.start]) {
        return 0;
    }
    let is_tuple = text[..first.start].contains('(');
    let mut end = first.end;
    for place in places.iter().skip(1).take_while(|_| is_tuple) {
        if !is_joint(&text[end..place.start]) {
            break;
        }
        end = place.end;
    }
    let rest = &text[end..];
    let (unit, _) = rest.split_once(" (").unwrap_or((rest, ""));
    let is_word = |word: &str| UNITS.contains(&word) || WORDS.contains(&word);
    let of_unit = |word: &str| word.is_empty() || is_word(word) || numbers::places(word).len() == 1;
    let is_unit = unit.split([' ', '\u{a0}']).all(|word| of_unit(word.trim_matches([')', ',', '.', ']'])));
    if is_unit { end + unit.len() } else { 0 }
}

/// The numbers of a formula, those of indices and exponents apart.
fn all_numbers(math: &Math) -> Vec<String> {
    match math {
        Math::Text(text, _) => numbers::of(text),
        Math::Row(parts) => parts.iter().flat_map(all_numbers).collect(),
        Math::Matrix(rows) => rows.iter().flatten().flat_map(all_numbers).collect(),
        Math::Frac(top, bottom) => [all_numbers(top), all_numbers(bottom)].concat(),
        Math::Abs(inner) | Math::Sqrt(inner) | Math::Sub(inner, _) | Math::Sup(inner, _) => all_numbers(inner),
        Math::Var(_) | Math::Bold(_) | Math::Sum(_) | Math::Bar(_) | Math::Hat(_) => Vec::new(),
    }
}

fn numbers_of(token: &Token) -> Vec<String> {
    all_numbers(&token.math())
}

/// Whether a token has a number that was measured or computed.
fn has_numbers(token: &Token) -> bool {
    numbers_of(token).iter().any(|number| number.contains('.') || number.chars().count() > 1)
}

/// Whether a formula has a symbol.
fn has_unknown(math: &Math) -> bool {
    match math {
        Math::Var(_) | Math::Bold(_) | Math::Bar(_) | Math::Hat(_) => true,
        Math::Text(..) | Math::Sum(_) => false,
        Math::Row(parts) => parts.iter().any(has_unknown),
        Math::Matrix(rows) => rows.iter().flatten().any(has_unknown),
        Math::Frac(top, bottom) => has_unknown(top) || has_unknown(bottom),
        Math::Sub(inner, _) | Math::Sup(inner, _) | Math::Abs(inner) | Math::Sqrt(inner) => has_unknown(inner),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str) -> Math {
        Math::text(text)
    }

    fn answers(lines: &[Math]) -> Vec<String> {
        exercise(lines, &[], Fill::Blank).answers.into_iter().map(|(_, answer)| answer).collect()
    }

    #[test]
    fn what_stands_behind_the_last_sign_is_left_out() {
        assert_eq!(answers(&[line("= |228 − 186| + |210 − 195|"), line("= 9741")]), ["9741"]);
        assert_eq!(answers(&[line("d = 0.25 + 0.50 = 0.75 ≤ 9.21")]), ["0.75"]);
        assert_eq!(answers(&[line("y = (65.44, 127.73) px")]), ["65.44", "127.73"]);
        for unit in UNITS {
            assert_eq!(answers(&[line(&format!("v = 12.50 {unit}"))]), ["12.50"], "{unit}");
        }
        assert_eq!(answers(&[line("= (log 0.01)/(log 0.59), so 7 (at most 2000)")]), ["7"]);
        assert!(answers(&[line("with DT = 0, FT = 1")]).is_empty());
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
        let exercise = exercise(&lines, &[], Fill::Blank);
        let plain: String = exercise.lines.iter().map(Math::plain).collect();
        assert!(!plain.contains("2.05") && !plain.contains("4.95") && plain.contains("7.00"), "{plain}");
        let solved = super::exercise(&lines, &[], Fill::Answer);
        assert_eq!(solved.lines.iter().map(Math::plain).collect::<Vec<_>>(), lines.map(|line| line.plain()));
    }

    #[test]
    fn factors_are_left_out_where_there_is_no_value() {
        let line = Math::Row(vec![Math::Var("u"), line(" = 0.40 + 0.0003 "), Math::Var("x")]);
        assert_eq!(answers(std::slice::from_ref(&line)), ["0.40", "0.0003"]);
        assert_eq!(defined(&[line]), ["u"]);
    }
}
