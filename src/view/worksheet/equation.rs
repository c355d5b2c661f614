//! Which values of a formula are left out: its results, as far as they can be computed by hand from what is printed.

use motionscope_core::scene::{Math, ValueStyle};

use super::numbers::{Fill, all_numbers, filled_in, has_unknown, has_values, inked, is_telling, tells};
use super::reach::{Printed, has_sum};

/// Between two sides.
const SIGNS: [&str; 5] = ["=", "→", "≈", "←", "so"];
/// Between two values that are compared.
const COMPARISONS: [&str; 4] = ["≤", "≥", "<", ">"];
/// Between two terms.
const OPERATORS: [char; 5] = ['+', '−', '·', '×', '/'];
/// Numbers of a matrix that are worked out first.
const FUNCTIONS: [&str; 2] = ["det", "tr"];
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
    let clauses: Vec<Vec<Clause<'_>>> = lines.iter().map(clauses).collect();
    for (index, line) in clauses.iter().enumerate() {
        let is_given = lines[index].plain().starts_with("with ");
        let before: Vec<String> = exercise.answers.iter().map(|(_, answer)| answer.clone()).collect();
        // A result of a line before must be computed there.
        let is_known = |number: &str| tells(number, before.iter().chain(known));
        let writing = Writing { fill, is_known: &is_known };
        let (mut parts, mut has_result, mut is_told) = (Vec::new(), false, false);
        for (number, clause) in line.iter().enumerate() {
            let place = InLines { earlier: &clauses[..index], line, number };
            // A value behind a result follows from it.
            let is_result = |value: &Place| !is_given && (has_result || place.is_in_reach(value, printed));
            let (part, answers) = match clause.value().filter(is_result) {
                _ if is_told => writing.told(&row(&clause.0)),
                Some(value) => {
                    has_result = true;
                    clause.left_out(&value, place.has_functions(), writing)
                }
                None => {
                    is_told = clause.verdict().is_some();
                    clause.compared(writing)
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
    let of_clause = |clause: &Clause<'_>| clause.value().map(|value| clause.numbers_in(&value)).unwrap_or_default();
    lines.iter().flat_map(|line| clauses(line).iter().flat_map(of_clause).collect::<Vec<_>>()).collect()
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
    let symbol = |clause: &Clause<'_>| {
        let first = clause.0.iter().position(|part| is_sign(part))?;
        let plain = row(&clause.0[..first]).plain();
        let name = plain.split('(').next().unwrap_or_default().trim();
        let by = row(&clause.0[first..]);
        let is_by_hand = has_unknown(&by) && !has_sum(&by);
        (!name.is_empty()).then(|| Defined { name: name.to_owned(), is_by_hand })
    };
    lines.iter().flat_map(|line| clauses(line).iter().filter_map(symbol).collect::<Vec<_>>()).collect()
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
struct InLines<'a, 'm> {
    earlier: &'a [Vec<Clause<'m>>],
    line: &'a [Clause<'m>],
    number: usize,
}

impl<'a, 'm> InLines<'a, 'm> {
    /// The sides of the clause, behind those of the one before if it goes on with that.
    fn sides(self) -> Vec<&'a [&'m Math]> {
        let own = self.line[self.number].sides();
        if !own.first().is_some_and(|side| is_blank(side)) {
            return own;
        }
        let before = match self.number {
            0 => self.earlier.last().and_then(|line| line.last()),
            number => self.line.get(number - 1),
        };
        match before {
            Some(before) => before.sides().into_iter().chain(own.into_iter().skip(1)).collect(),
            None => own,
        }
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
        let before = sides[..names_and_value].iter().skip(1).rev().find(|side| !is_blank(side));
        let numbers = self.line[self.number].numbers_in(value);
        before.is_some_and(|side| printed.reaches(&row(side), &numbers))
    }

    /// Whether numbers of a matrix stand in its formula, to be worked out first.
    fn has_functions(self) -> bool {
        let plain: String = self.sides().into_iter().map(|side| row(side).plain() + " ").collect();
        plain.split(|letter: char| !letter.is_alphabetic()).any(|word| FUNCTIONS.contains(&word))
    }
}

/// What stands between two commas of a line.
struct Clause<'m>(Vec<&'m Math>);

/// The parts of a clause that are a value.
type Place = std::ops::Range<usize>;

impl<'m> Clause<'m> {
    /// What stands between its signs.
    fn sides(&self) -> Vec<&[&'m Math]> {
        self.0.split(|part| is_sign(part)).collect()
    }

    /// The last sign, and the value behind it, if it is one.
    fn sign_and_value(&self) -> Option<(usize, Place)> {
        let sign = self.0.iter().rposition(|part| is_sign(part))?;
        let end = self.0[sign..].iter().position(|part| is_comparison(part));
        let place = sign + 1..end.map_or(self.0.len(), |end| sign + end);
        is_value(&self.0[place.clone()]).then_some((sign, place))
    }

    /// Whether it has numbers beside unknowns before a value: a system that is to be solved, not a value that was computed.
    fn is_system(&self) -> bool {
        let Some((sign, _)) = self.sign_and_value() else { return false };
        let left = row(self.0[..sign].rsplit(|part| is_sign(part)).next().unwrap_or_default());
        has_unknown(&left) && has_values(&left)
    }

    /// Where its result stands, if it has one.
    fn value(&self) -> Option<Place> {
        self.sign_and_value().filter(|_| !self.is_system()).map(|(_, place)| place)
    }

    fn numbers_in(&self, place: &Place) -> Vec<String> {
        self.0[place.clone()].iter().flat_map(|part| all_numbers(part)).collect()
    }

    /// The clause with its value left out or filled in, the sign that compares it, and the numbers of a matrix if they are to be
    /// `worked_out`; and what all that is.
    fn left_out(&self, value: &Place, worked_out: bool, writing: Writing<'_>) -> (Math, Vec<String>) {
        let (mut parts, mut answers) = (Vec::new(), Vec::new());
        let is_compared = self.0[value.end..].iter().any(|part| has_values(part));
        for (index, part) in self.0.iter().enumerate() {
            let (part, left_out) = match part {
                // A sign before the value compares something else.
                Math::Text(sign, _) if is_comparison(part) && is_compared && index >= value.end => writing.sign(sign),
                _ if value.contains(&index) => (filled_in(part, writing.fill, &|_| true), all_numbers(part)),
                _ if worked_out && index < value.start => {
                    let inked: Vec<String> = inked(part).into_iter().filter(|number| is_telling(number)).collect();
                    let is_chosen =
                        |number: &str| inked.iter().any(|other| other == number) || (writing.is_known)(number);
                    (filled_in(part, writing.fill, &is_chosen), inked)
                }
                part => (writing.given(part), Vec::new()),
            };
            parts.push(part);
            answers.extend(left_out);
        }
        (Math::Row(parts), answers)
    }

    /// The sign that compares two values.
    fn comparison(&self) -> Option<usize> {
        let at = self.0.iter().position(|part| is_comparison(part))?;
        let left = self.0[..at].rsplit(|part| is_sign(part)).next()?;
        (has_values(&row(left)) && !all_numbers(&row(&self.0[at..])).is_empty()).then_some(at)
    }

    /// Where the verdict on a comparison begins, if it is told.
    fn verdict(&self) -> Option<usize> {
        let at = self.comparison()?;
        let begins = |part: &&Math| matches!(part, Math::Text(text, _) if text.starts_with(VERDICT));
        self.0[at..].iter().position(begins).map(|behind| at + behind)
    }

    /// The clause without a result of its own: the sign of a comparison is left out or filled in, or the verdict on it if that is
    /// told.
    fn compared(&self, writing: Writing<'_>) -> (Math, Vec<String>) {
        let given = |parts: &[&Math]| writing.given(&row(parts));
        if let Some(at) = self.verdict() {
            let told = row(&self.0[at..]).plain();
            let told = told.trim_start_matches(VERDICT);
            let parts = vec![given(&self.0[..at]), Math::text(VERDICT), writing.fill.word(told)];
            return (Math::Row(parts), vec![told.to_owned()]);
        }
        let Some(at) = self.comparison() else { return (given(&self.0), Vec::new()) };
        let (sign, answers) = writing.sign(&self.0[at].plain());
        (Math::Row(vec![given(&self.0[..at]), sign, given(&self.0[at + 1..])]), answers)
    }
}

impl Writing<'_> {
    /// The sign of a comparison, with the space around it.
    fn sign(self, sign: &str) -> (Math, Vec<String>) {
        let bare = sign.trim();
        let parts = vec![Math::text(" "), self.fill.word(bare), Math::text(" ")];
        (Math::Row(parts), vec![bare.to_owned()])
    }
}

/// Parts one after the other.
fn row(parts: &[&Math]) -> Math {
    Math::Row(parts.iter().map(|part| (*part).clone()).collect())
}

fn is_sign(part: &Math) -> bool {
    matches!(part, Math::Text(text, _) if SIGNS.contains(&text.trim_matches([' ', ','])))
}

fn is_comparison(part: &Math) -> bool {
    matches!(part, Math::Text(text, _) if COMPARISONS.contains(&text.trim()))
}

fn is_blank(side: &[&Math]) -> bool {
    row(side).plain().trim().is_empty()
}

/// Whether a side is one value, a pair of them or a matrix of them, each with its unit.
fn is_value(side: &[&Math]) -> bool {
    let begins = side.iter().find(|part| !matches!(part, Math::Text(text, _) if ["", "("].contains(&text.trim())));
    let is_part = |part: &&Math| match part {
        Math::Value(_, style) => !matches!(style, ValueStyle::Signed | ValueStyle::Sum),
        Math::Matrix(rows) => rows.iter().flatten().all(|entry| matches!(entry, Math::Value(..))),
        Math::Text(text, _) => !text.contains(OPERATORS) || text.contains(" ("),
        _ => false,
    };
    begins.is_some_and(|first| has_values(first)) && side.iter().all(is_part)
}

/// The clauses of a line, each with the comma behind it.
fn clauses(line: &Math) -> Vec<Clause<'_>> {
    let mut parts = Vec::new();
    flatten(line, &mut parts);
    let mut depth = 0;
    let ends = |part: &&Math| {
        let Math::Text(text, _) = part else { return false };
        depth += text.matches(['(', '[', '{']).count();
        depth -= text.matches([')', ']', '}']).count().min(depth);
        depth == 0 && text.starts_with(',') && !is_sign(part)
    };
    parts.split_inclusive(ends).map(|clause| Clause(clause.to_vec())).collect()
}

fn flatten<'a>(math: &'a Math, parts: &mut Vec<&'a Math>) {
    match math {
        Math::Row(inner) => inner.iter().for_each(|part| flatten(part, parts)),
        other => parts.push(other),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::formula as line;
    use super::*;

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
    fn the_value_behind_the_last_sign_is_left_out() {
        assert_eq!(answers(&[line("= |{a} - {b}| + 2"), line("= {s}")]), ["5.25"]);
        assert_eq!(answers(&[line("x = {a} + {b} = {x:unit}")]), ["65.44", "127.73"]);
        assert_eq!(answers(&[line(r"= \frac{{a}}{{b}}\text{, so }{s}\text{ (at most 2−3)}")]), ["5.25"]);
        assert_eq!(answers(&[line("s = {a} + {b} = {s}, q = {b}")]), ["5.25", "3.50"], "it follows");
        assert!(answers(&[line(r"\text{with } s = {a} + {b} = {s}")]).is_empty());
        assert!(answers(&[line("s = {a} = {a} + {b}")]).is_empty(), "a sum is no result");
    }

    #[test]
    fn what_cannot_be_computed_from_what_is_printed_is_given() {
        assert!(answers(&[line("x = {x:unit}")]).is_empty(), "nothing leads to it");
        let sum = line(r"s = \sum_i x = {s}");
        assert!(answers(std::slice::from_ref(&sum)).is_empty(), "the terms of the sum are not printed");
        assert_eq!(plain(&left_out(std::slice::from_ref(&sum), Fill::Blank).lines), [sum.plain()]);
        assert_eq!(defined(&[sum]), [Defined { name: "s".into(), is_by_hand: false }]);
        let of = |line: Math| defined(&[line]).iter().map(|one| one.is_by_hand).collect::<Vec<_>>();
        let product = of(line(r"y = 2\,\mathbf{H}"));
        assert_eq!((product, of(line("s = {s}"))), (vec![true], vec![false]), "a value is no definition");
    }

    #[test]
    fn the_sign_of_a_decision_is_left_out() {
        let lines = [line(r"s = {a} + {b} = {s} \le {b}"), line(r"\text{with } {a} \ge {b}, a \le b")];
        let exercise = left_out(&lines, Fill::Blank);
        let found: Vec<_> = exercise.answers.iter().map(|(_, answer)| answer.as_str()).collect();
        assert_eq!(found, ["5.25", "≤", "≥"]);
        let shown = plain(&exercise.lines);
        assert!(!shown[0].contains('≤') && shown[0].ends_with("3.50"), "{shown:?}");
        assert!(!shown[1].contains('≥') && shown[1].ends_with("a ≤ b"), "{shown:?}");
        assert_eq!(plain(&left_out(&lines, Fill::Answer).lines), plain(&lines));
        let between = [line(r"0 < s = {a} + {b} = {s} \le {b}")];
        assert_eq!(answers(&between), ["5.25", "≤"]);
        let shown = plain(&left_out(&between, Fill::Blank).lines);
        assert!(shown[0].starts_with("0 < s = 0.25"), "a sign before the value is given: {shown:?}");
    }

    #[test]
    fn a_verdict_is_left_out_with_what_follows_from_it() {
        let lines = [line(r"{a} < {b}\text{: false}, \text{bit }{s}")];
        assert_eq!(answers(&lines), ["false, ", "bit 5.25"]);
        let shown = plain(&left_out(&lines, Fill::Blank).lines);
        assert!(shown[0].starts_with("0.25 < 3.50: □") && !shown[0].contains("bit"), "{shown:?}");
        assert_eq!(plain(&left_out(&lines, Fill::Answer).lines), plain(&lines));
    }

    #[test]
    fn determinant_and_trace_are_worked_out_first() {
        let symbols = || line(r"s = \det \mathbf{T} - k\,\text{tr }\mathbf{T}");
        let numbers = line(r"= {b} - 0.04 \cdot {b}^2 = {s}");
        assert_eq!(answers(&[symbols(), numbers.clone()]), ["3.50", "3.50", "5.25"]);
        assert_eq!(answers(&[line("s = a - k b"), numbers.clone()]), ["5.25"]);
        let shown = plain(&left_out(&[symbols(), numbers], Fill::Blank).lines);
        assert!(shown[1].contains("0.04"), "a parameter is given: {shown:?}");
    }

    #[test]
    fn a_system_is_given_and_its_solution_is_left_out() {
        assert_eq!(answers(&[line("{a} u + {b} v = {s}"), line("(u, v) = {x}")]), ["65.44", "127.73"]);
    }

    #[test]
    fn a_result_does_not_stand_in_later_lines() {
        let lines = [line("s = {a} + {b} = {s}"), line("u = 7.00 − {s} = {x}")];
        let exercise = left_out(&lines, Fill::Blank);
        let shown: String = plain(&exercise.lines).concat();
        assert!(!shown.contains("5.25") && !shown.contains("65.44") && shown.contains("7.00"), "{shown}");
        assert_eq!(plain(&left_out(&lines, Fill::Answer).lines), plain(&lines));
        assert_eq!(values(&lines), ["5.25", "65.44", "127.73"]);
        let finer = [lines[0].clone(), line("u = 7.00 − {finer} = {x}")];
        let shown: String = plain(&left_out(&finer, Fill::Blank).lines).concat();
        assert!(!shown.contains("5.25"), "it is not told with more digits either: {shown}");
    }
}
