//! The reader of formulas: a part of LaTeX, with the values of a step in it.
//!
//! `{gain}` stands for the value called so, `{gain:unit}` for the value with its unit, `{flow:2}` for the second component of a vector.
//! A group that is an argument is none: `\\frac{a}{b}` has the letters, `\\frac{{a}}{{b}}` the values.

use super::Math;
use super::case::find;
use super::value::{Number, Value, ValueStyle};
use crate::base::Error;

/// Letters of variables.
const LETTERS: &str = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ\
    αβγδεζηθικλμνξπρστυφχψωΓΔΘΛΞΠΣΦΨΩℓ";

/// Names of Greek letters and of signs that stand for themselves.
const NAMED: &[(&str, &str)] = &[
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("epsilon", "ε"),
    ("zeta", "ζ"),
    ("eta", "η"),
    ("theta", "θ"),
    ("kappa", "κ"),
    ("lambda", "λ"),
    ("mu", "μ"),
    ("nu", "ν"),
    ("xi", "ξ"),
    ("pi", "π"),
    ("rho", "ρ"),
    ("sigma", "σ"),
    ("tau", "τ"),
    ("phi", "φ"),
    ("varphi", "φ"),
    ("chi", "χ"),
    ("psi", "ψ"),
    ("omega", "ω"),
    ("Gamma", "Γ"),
    ("Delta", "Δ"),
    ("Theta", "Θ"),
    ("Lambda", "Λ"),
    ("Sigma", "Σ"),
    ("Phi", "Φ"),
    ("Psi", "Ψ"),
    ("Omega", "Ω"),
    ("ell", "ℓ"),
];

/// Signs without space around them, and functions.
const UPRIGHT: &[(&str, &str)] = &[
    ("nabla", "∇"),
    ("partial", "∂"),
    ("infty", "∞"),
    ("top", "T"),
    ("ldots", "…"),
    ("dots", "…"),
    ("{", "{"),
    ("}", "}"),
    (",", " "),
    (";", " "),
    (" ", " "),
    ("quad", "  "),
    ("qquad", "    "),
    ("min", "min "),
    ("max", "max "),
    ("exp", "exp "),
    ("log", "log "),
    ("ln", "ln "),
    ("prod", "∏"),
    ("det", "det "),
    ("cos", "cos "),
    ("sin", "sin "),
    ("left", ""),
    ("right", ""),
];

/// Signs between two terms.
const BETWEEN: &[(&str, &str)] = &[
    ("cdot", "·"),
    ("circ", "∘"),
    ("times", "×"),
    ("le", "≤"),
    ("leq", "≤"),
    ("ge", "≥"),
    ("geq", "≥"),
    ("ne", "≠"),
    ("neq", "≠"),
    ("approx", "≈"),
    ("pm", "±"),
    ("to", "→"),
    ("gets", "←"),
    ("in", "∈"),
    ("ni", "∋"),
];

/// Reads a formula without values.
///
/// # Errors
/// A sentence with what is unknown or not closed.
pub fn parse(text: &str) -> Result<Math, Error> {
    read(text, None)
}

/// Reads a formula with the `values` that it names.
///
/// # Errors
/// A sentence with what is unknown or not closed, or with the value that is missing.
pub fn read(text: &str, values: Option<&[Value]>) -> Result<Math, Error> {
    let mut reader = Reader { text, at: 0, depth: 0, scripts: 0, values };
    let math = reader.row(&[])?;
    if let Some(next) = reader.peek() {
        return Err(Error::new(format!("the formula {text} has a {next} too many")));
    }
    Ok(math)
}

/// Formulas within formulas; a formula of a lesson has three or four.
const DEEPEST: usize = 32;

struct Reader<'a> {
    text: &'a str,
    at: usize,
    /// Rows around the one that is read.
    depth: usize,
    /// Indices and exponents around it, in which signs have no space around them.
    scripts: usize,
    /// The values that a group can name.
    values: Option<&'a [Value]>,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn take(&mut self) -> Option<char> {
        let next = self.peek()?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn skip(&mut self, what: &str) -> bool {
        let is_there = self.rest().starts_with(what);
        if is_there {
            self.at += what.len();
        }
        is_there
    }

    fn wrong(&self, why: impl std::fmt::Display) -> Error {
        Error::new(format!("the formula {}: {why}", self.text))
    }

    fn deeper(&mut self) -> Result<(), Error> {
        if self.depth == DEEPEST {
            return Err(self.wrong(format!("more than {DEEPEST} formulas within each other")));
        }
        self.depth += 1;
        Ok(())
    }

    /// Terms up to one of `ends`, which is left.
    fn row(&mut self, ends: &[&str]) -> Result<Math, Error> {
        self.deeper()?;
        let mut parts: Vec<Math> = Vec::new();
        loop {
            while self.peek().is_some_and(char::is_whitespace) {
                self.take();
            }
            let Some(next) = self.peek() else { break };
            if ends.iter().any(|end| self.rest().starts_with(end)) || "}&".contains(next) {
                break;
            }
            match next {
                '^' if matches!(parts.last(), Some(Math::Sum(_))) => {
                    return Err(self.wrong("a sum has its range below it: \\sum_{i = 1, \\ldots, n}"));
                }
                '_' | '^' => {
                    self.take();
                    self.scripts += 1;
                    // The space behind a function is none behind an index that is one.
                    let script = match self.argument()? {
                        Math::Text(name, role) => Math::Text(name.trim_end().into(), role),
                        script => script,
                    };
                    self.scripts -= 1;
                    let base = parts.pop().ok_or_else(|| self.wrong(format!("{next} has nothing before it")))?;
                    // The space behind a function stands behind its index.
                    match base {
                        Math::Text(name, _) if name.ends_with(' ') && name.len() > 1 => {
                            let name = Math::text(name.trim_end());
                            parts.extend([scripted(name, next, script), Math::text(" ")]);
                        }
                        base => parts.push(scripted(base, next, script)),
                    }
                }
                '\'' => {
                    self.take();
                    parts.push(Math::text("′"));
                }
                '{' if self.values.is_some() => {
                    let follows_sign = parts.last().is_some_and(is_sign);
                    parts.push(self.value(follows_sign)?);
                }
                _ => {
                    let follows = parts.last().is_some_and(is_term);
                    parts.push(self.atom(follows)?);
                }
            }
        }
        self.depth -= 1;
        Ok(match parts.len() {
            1 => parts.swap_remove(0),
            _ => Math::Row(parts),
        })
    }

    /// The value that a group names, or a component of it: `{flow:2}`, `{flow:2:signed}`.
    fn value(&mut self, follows_sign: bool) -> Result<Math, Error> {
        let named = self.words()?;
        let (name, how) = named.split_once(':').unwrap_or((named, ""));
        let value = self.values.and_then(|values| find(values, name));
        let value = value.ok_or_else(|| self.wrong(format!("there is no value {name}")))?;
        let (component, style) = how.split_at(how.find(|c: char| !c.is_ascii_digit()).unwrap_or(how.len()));
        let style = ValueStyle::called(style.trim_start_matches(':'));
        let style = style.ok_or_else(|| self.wrong(format!("a value is not written {how}")))?;
        let Ok(component) = component.parse() else { return Ok(shown(value, style, follows_sign)) };
        let part =
            value.component(component).ok_or_else(|| self.wrong(format!("{name} has no component {component}")))?;
        Ok(shown(&part, style, follows_sign))
    }

    /// The argument of a command or a script: a group, or one term.
    fn argument(&mut self) -> Result<Math, Error> {
        while self.peek() == Some(' ') {
            self.take();
        }
        if !self.skip("{") {
            self.deeper()?;
            let term = self.atom(false)?;
            self.depth -= 1;
            return Ok(term);
        }
        let inner = self.row(&["}"])?;
        if self.skip("}") { Ok(inner) } else { Err(self.wrong("a } is missing")) }
    }

    /// The words in braces, as they are.
    fn words(&mut self) -> Result<&'a str, Error> {
        let open = self.skip("{");
        let end = self.rest().find('}').filter(|_| open).ok_or_else(|| self.wrong("words in { } are missing"))?;
        let words = &self.rest()[..end];
        self.at += end + 1;
        Ok(words)
    }

    /// One term; `follows` says whether a term stands before it, so that a sign is one between two terms.
    fn atom(&mut self, follows: bool) -> Result<Math, Error> {
        let Some(next) = self.take() else { return Err(self.wrong("something is missing at its end")) };
        let is_apart = follows && self.scripts == 0;
        let between = |sign: &str| Math::text(if is_apart { format!(" {sign} ") } else { sign.to_owned() });
        // A line that goes on with what stands above it begins with one.
        let begins = self.depth == 1 && !follows && self.text[..self.at - next.len_utf8()].trim().is_empty();
        Ok(match next {
            '=' | '<' | '>' | '≤' | '≥' | '≈' | '→' | '←' if begins => Math::text(format!("{next} ")),
            '\\' => return self.command(follows),
            '{' => {
                let inner = self.row(&["}"])?;
                if !self.skip("}") {
                    return Err(self.wrong("a } is missing"));
                }
                inner
            }
            '|' => {
                let inner = self.row(&["|"])?;
                if !self.skip("|") {
                    return Err(self.wrong("a | is missing"));
                }
                Math::abs(inner)
            }
            '-' | '−' => between("−"),
            '+' | '=' | '<' | '>' | '≤' | '≥' | '≈' | '±' | '·' | '×' | '→' | '←' | '≠' | '∈' => {
                between(next.encode_utf8(&mut [0; 4]))
            }
            ',' | ';' => Math::text(format!("{next} ")),
            '0'..='9' => {
                let from = self.at - 1;
                while self.peek().is_some_and(|c| c.is_ascii_digit() || c == '.') {
                    self.take();
                }
                Math::text(&self.text[from..self.at])
            }
            '(' | ')' | '[' | ']' | ':' | '.' | '!' | '/' | '%' | '∇' | '∂' | '∞' | '…' => Math::text(next),
            letter => Math::Var(variable(letter).ok_or_else(|| self.wrong(format!("{letter} is not known")))?),
        })
    }

    /// A command after its backslash.
    fn command(&mut self, follows: bool) -> Result<Math, Error> {
        let letters = self.rest().chars().take_while(char::is_ascii_alphabetic).count();
        let length = if letters > 0 { letters } else { self.peek().map_or(0, char::len_utf8) };
        let name = &self.rest()[..length];
        self.at += length;
        let find =
            |list: &'static [(&str, &'static str)]| list.iter().find(|(known, _)| *known == name).map(|(_, s)| *s);
        if let Some(letter) = find(NAMED) {
            return Ok(Math::Var(letter));
        }
        if let Some(sign) = find(UPRIGHT) {
            return Ok(Math::text(sign));
        }
        if let Some(sign) = find(BETWEEN) {
            let is_apart = follows && self.scripts == 0;
            return Ok(Math::text(if is_apart { format!(" {sign} ") } else { sign.to_owned() }));
        }
        Ok(match name {
            "frac" => Math::over(self.argument()?, self.argument()?),
            "sqrt" => Math::root(self.argument()?),
            "bar" => Math::mean(self.argument()?),
            "hat" => Math::Hat(Box::new(self.argument()?)),
            "text" => Math::text(self.words()?),
            "mathbf" => bold(self.argument()?),
            "sum" => {
                let has_index = self.skip("_");
                Math::Sum(Box::new(if has_index { self.argument()? } else { Math::text("") }))
            }
            "begin" => return self.matrix(),
            _ => return Err(self.wrong(format!("\\{name} is not known"))),
        })
    }

    /// The rows behind `\begin`.
    fn matrix(&mut self) -> Result<Math, Error> {
        let kind = self.words()?;
        if kind != "pmatrix" {
            return Err(self.wrong(format!("there is no {kind} here, only pmatrix")));
        }
        let mut rows = vec![Vec::new()];
        loop {
            let entry = self.row(&["\\\\", "\\end"])?;
            if let Some(row) = rows.last_mut() {
                row.push(entry);
            }
            if self.skip("\\\\") {
                rows.push(Vec::new());
            } else if self.skip("\\end") {
                self.words()?;
                return Ok(Math::Matrix(rows));
            } else if !self.skip("&") {
                return Err(self.wrong("\\end{pmatrix} is missing"));
            }
        }
    }
}

/// Whether `math` ends with a sign behind which a negative number stands in parentheses.
fn is_sign(math: &Math) -> bool {
    matches!(math, Math::Text(text, _) if text.trim_end().ends_with(['+', '−', '·', '×', '/']))
}

/// The letter as the name of a variable.
fn variable(letter: char) -> Option<&'static str> {
    LETTERS.find(letter).map(|at| &LETTERS[at..at + letter.len_utf8()])
}

/// Letters as names of vectors and matrices.
fn bold(math: Math) -> Math {
    match math {
        Math::Var(name) => Math::Bold(name),
        Math::Row(parts) => Math::Row(parts.into_iter().map(bold).collect()),
        other => other,
    }
}

/// `base` with `script` at the place of `mark`; a base with an index takes its exponent outside.
fn scripted(base: Math, mark: char, script: Math) -> Math {
    let base = match base {
        Math::Value(value, ValueStyle::Bare) if value.needs_parentheses() => {
            Math::Value(value, ValueStyle::InParentheses)
        }
        base => base,
    };
    if mark == '_' { Math::indexed(base, script) } else { Math::power(base, script) }
}

/// Whether a sign after `math` stands between two terms.
fn is_term(math: &Math) -> bool {
    match math {
        Math::Text(text, _) => !text.trim().is_empty() && !text.ends_with(|c: char| " ([{,;→←=+−".contains(c)),
        Math::Sum(_) => false,
        _ => true,
    }
}

/// A value in a formula. A number that is negative or has a power stands in parentheses behind a sign.
fn shown(value: &Value, style: ValueStyle, follows_sign: bool) -> Math {
    let Number::Matrix(entries) = &value.number else {
        let is_enclosed = follows_sign && style == ValueStyle::Bare && value.needs_parentheses();
        return Math::Value(Box::new(value.clone()), if is_enclosed { ValueStyle::InParentheses } else { style });
    };
    let entry = |x, y| {
        let number = Number::Real(entries[(x, y)]);
        Math::Value(Box::new(Value { number, ..value.clone() }), ValueStyle::Bare)
    };
    let row = |y| (0..entries.width()).map(|x| entry(x, y)).collect();
    Math::Matrix((0..entries.height()).map(row).collect())
}

impl Math {
    /// The formula in LaTeX, its values as numbers.
    pub fn latex(&self) -> String {
        write(self).trim().to_owned()
    }
}

/// Writes a formula, its values as numbers: the inverse of [`parse`].
fn write(math: &Math) -> String {
    match math {
        Math::Text(text, _) => upright(text),
        Math::Value(value, style) => upright(&style.text(value)),
        Math::Var(name) => letters(name),
        Math::Bold(name) => format!("\\mathbf{{{}}}", letters(name)),
        Math::Row(parts) => {
            let mut row = String::new();
            for part in parts.iter().map(write) {
                // A letter behind a command would be part of its name.
                let is_joined = row.rsplit('\\').next().is_some_and(|end| end.len() < row.len() && is_letters(end));
                if is_joined && part.starts_with(|c: char| c.is_ascii_alphabetic()) {
                    row.push(' ');
                }
                row += &part;
            }
            row
        }
        Math::Sub(base, index) => format!("{}_{{{}}}", grouped(base), write(index)),
        Math::Sup(base, exponent) => format!("{}^{{{}}}", grouped(base), write(exponent)),
        Math::Frac(top, bottom) => format!("\\frac{{{}}}{{{}}}", write(top), write(bottom)),
        Math::Sum(index) if index.plain().is_empty() => "\\sum ".into(),
        Math::Sum(index) => format!("\\sum_{{{}}} ", write(index)),
        Math::Abs(inner) => format!("|{}|", write(inner)),
        Math::Sqrt(inner) => format!("\\sqrt{{{}}}", write(inner)),
        Math::Bar(inner) => format!("\\bar{{{}}}", write(inner)),
        Math::Hat(inner) => format!("\\hat{{{}}}", write(inner)),
        Math::Matrix(rows) => {
            let row = |row: &Vec<Math>| row.iter().map(write).collect::<Vec<_>>().join(" & ");
            format!("\\begin{{pmatrix}} {} \\end{{pmatrix}}", rows.iter().map(row).collect::<Vec<_>>().join(" \\\\ "))
        }
    }
}

fn is_letters(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_alphabetic())
}

/// A base with an index or an exponent: of several terms as a group.
fn grouped(base: &Math) -> String {
    match base {
        Math::Row(_) | Math::Frac(..) => format!("{{{}}}", write(base)),
        _ => write(base),
    }
}

/// The letters of a symbol; Greek ones by their names.
fn letters(name: &str) -> String {
    let letter = |c: char| match NAMED.iter().find(|(_, letter)| letter.chars().eq([c])) {
        Some((name, _)) => format!("\\{name} "),
        None => c.to_string(),
    };
    let all: String = name.chars().map(letter).collect();
    all.trim_end().to_owned()
}

/// Upright text: numbers and signs as they are, words as text.
fn upright(text: &str) -> String {
    let named = |c: char| {
        let of =
            |list: &'static [(&str, &str)]| list.iter().find(|(_, sign)| sign.chars().eq([c])).map(|(name, _)| *name);
        of(BETWEEN).or_else(|| of(UPRIGHT).filter(|name| is_letters(name)))
    };
    let is_sign = |c: char| c.is_ascii_digit() || " .,;()[]+=<>−!/:'\u{a0}\u{202f}".contains(c) || named(c).is_some();
    if !text.chars().all(is_sign) {
        return format!("\\text{{{}}}", text.replace(['{', '}'], ""));
    }
    let sign = |c: char| match c {
        '−' => "-".into(),
        '\u{a0}' => " ".into(),
        '\u{202f}' => "\\,".into(),
        c if " .,;".contains(c) || c.is_ascii_digit() => c.to_string(),
        c => named(c).map_or_else(|| c.to_string(), |name| format!("\\{name} ")),
    };
    text.chars().map(sign).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> String {
        parse(text).map_or_else(|why| why.to_string(), |math| math.plain())
    }

    #[test]
    fn formulas_of_the_course_are_read() {
        assert_eq!(plain("I_x u + I_y v + I_t = 0"), "I_x u + I_y v + I_t = 0");
        assert_eq!(plain(r"\frac{\partial I}{\partial x} = -\lambda"), "(∂I)/(∂x) = −λ");
        assert_eq!(plain(r"E = \sum_{(x,y) \in B} |I - J|^2"), "E = Σ_(x, y) ∈ B |I − J|^2");
        assert_eq!(plain(r"\begin{pmatrix} \sum I_x^2 & 0 \\ 0 & 1 \end{pmatrix} \mathbf{d}"), "[Σ I_x^2, 0; 0, 1]d");
        assert_eq!(plain(r"\hat{\mathbf{x}} = \bar{u} - \sqrt{\alpha^2}"), "x\u{302} = u\u{304} − √(α^2)");
        assert_eq!(plain("I_{t+1}(x + u)"), "I_t+1(x + u)");
        assert_eq!(plain("= -2"), "= −2", "a line that goes on");
        assert_eq!(plain(r"\mathbf{P}^- = \mathbf{F} \mathbf{P} \mathbf{F}^\top"), "P⁻ = FPF^T");
    }

    #[test]
    fn a_formula_that_is_written_is_read_as_it_was() {
        let formulas = [
            "I_x u + I_y v + I_t = 0",
            r"\frac{\partial I}{\partial x} \le -\lambda_1 a",
            r"\hat{\mathbf{x}} = \bar{u} - \sqrt{\alpha^2} \cdot |b|",
            r"\begin{pmatrix} \sum_i I_x^2 & 0 \\ 0 & 1 \end{pmatrix} \mathbf{d} = 3.5 \text{ gray levels}",
            r"(a + b)_{i, j}^{-1} \to \infty",
        ];
        for formula in formulas {
            let math = parse(formula).expect("it is read");
            let written = write(&math);
            assert_eq!(parse(&written).map(|again| again.plain()).ok(), Some(math.plain()), "{written}");
        }
    }

    #[test]
    fn a_value_with_a_sign_or_a_power_of_ten_is_a_base_or_a_term_in_parentheses() {
        crate::variables! {
            /// A response.
            R: "", "R", crate::scene::Unit::RESPONSE;
        }
        let plain = |number: f64| {
            let math = read(r"{r}^2 - {r} = {r}", Some(&[value::R.is(number)]));
            math.map_or_else(|why| why.to_string(), |math| math.plain())
        };
        assert_eq!(plain(-2.0), "(−2.00)^2 − (−2.00) = −2.00");
        assert_eq!(plain(0.00026), "(2.6·10⁻⁴)^2 − (2.6·10⁻⁴) = 2.6·10⁻⁴");
        assert_eq!(plain(2.0), "2.00^2 − 2.00 = 2.00");
        let components = read("{r:1} u {r:2:signed} v", Some(&[value::R.is([1.5, -2.0])])).map(|math| math.plain());
        assert_eq!(components.ok().as_deref(), Some("1.50u − 2.00v"));
        assert!(
            read("{r:3}", Some(&[value::R.is([1.5, -2.0])])).is_err()
                && read("{r:1}", Some(&[value::R.is(1.5)])).is_err()
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert!(plain(r"\fra{1}{2}").contains("\\fra is not known"));
        assert!(plain(r"\frac{1}{2").contains("a } is missing"));
        assert!(plain("|I - J").contains("a | is missing"));
        assert!(plain("_x").contains("nothing before it"));
        assert!(plain(r"\sum_{i=1}^{n} x_i").contains("below it"));
        assert!(plain("u}").contains("too many"));
        assert!(plain(&"{".repeat(100)).contains("within each other"));
        assert!(plain(&"\\sqrt".repeat(100)).contains("within each other"));
        assert!(plain(r"\begin{pmatrix} 1 & 2").contains("is missing"));
    }

    #[test]
    fn every_prefix_of_a_formula_is_read_or_refused() {
        let whole =
            r"\begin{pmatrix} \sum_{i} w_i^2 & \frac{\partial I}{\sqrt{x}} \\ |a| & \hat{\mathbf{x}}' \end{pmatrix}";
        let ends = whole.char_indices().map(|(at, _)| at).chain([whole.len()]);
        let read = ends.filter(|end| parse(&whole[..*end]).is_ok()).count();
        assert_eq!(read, 2, "nothing, and all of it");
    }
}
