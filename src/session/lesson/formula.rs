//! Formulas of lessons: a part of LaTeX, read as [`Math`], or as words where a formula stands in a line.

use motionscope_core::Error;
use motionscope_core::scene::Math;

use crate::paint::THIN;
use crate::paint::charts::prose::{Span, Style};

/// Letters of variables; each is two bytes at most.
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
    ("det", "det "),
    ("cos", "cos "),
    ("sin", "sin "),
    ("left", ""),
    ("right", ""),
];

/// Signs between two terms.
const BETWEEN: &[(&str, &str)] = &[
    ("cdot", "·"),
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
];

/// Reads a formula.
///
/// # Errors
/// A sentence with what is unknown or not closed.
pub fn parse(text: &str) -> Result<Math, Error> {
    let mut reader = Reader { text, at: 0, depth: 0, scripts: 0 };
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
                    let script = self.argument()?;
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

    /// What stands behind a command or a script: a group, or one term.
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
        Ok(match next {
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

    /// What stands behind a backslash.
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

/// A formula in a line of words: its letters italic, nothing in it broken.
///
/// # Errors
/// If it has what cannot stand in a line, as a fraction or an index of several terms.
pub fn inline(text: &str) -> Result<Vec<Span>, Error> {
    let mut spans: Vec<Span> = Vec::new();
    let is_set = flatten(&parse(text)?, &mut spans).is_some();
    if !is_set {
        return Err(Error::new(format!("the formula {text} does not fit into a line; set it apart as $$…$$")));
    }
    for index in 0..spans.len() {
        let follows = spans.get(index + 1).is_some_and(|next| next.text.starts_with(char::is_alphanumeric));
        let span = &mut spans[index];
        span.text = span.text.replace(' ', "\u{a0}");
        // Without a space the letter behind an index would be part of it.
        if follows && (span.text.contains('_') || span.text.contains('^')) {
            span.text.push(THIN);
        }
    }
    Ok(spans)
}

/// Adds `math` to `spans`; nothing where a line cannot show it.
fn flatten(math: &Math, spans: &mut Vec<Span>) -> Option<()> {
    let push = |spans: &mut Vec<Span>, text: String, style| spans.push(Span { text, style, link: None });
    match math {
        Math::Text(text, _) => push(spans, text.clone(), Style::Plain),
        Math::Var(name) => push(spans, (*name).to_owned(), Style::Emphasis),
        Math::Bold(name) => push(spans, (*name).to_owned(), Style::Strong),
        Math::Row(parts) => parts.iter().try_for_each(|part| flatten(part, spans))?,
        Math::Sub(base, index) => {
            flatten(base, spans)?;
            spans.last_mut()?.text.push_str(&below(index)?);
        }
        Math::Sup(base, exponent) => {
            flatten(base, spans)?;
            spans.last_mut()?.text.push_str(&above(exponent)?);
        }
        Math::Bar(inner) => {
            if !matches!(inner.as_ref(), Math::Var(_) | Math::Bold(_)) {
                return None;
            }
            flatten(inner, spans)?;
            spans.last_mut()?.text.push('\u{304}');
        }
        Math::Abs(inner) => {
            push(spans, "|".into(), Style::Plain);
            flatten(inner, spans)?;
            push(spans, "|".into(), Style::Plain);
        }
        Math::Sqrt(inner) => {
            let is_letter = matches!(inner.as_ref(), Math::Var(_));
            push(spans, if is_letter { "√".into() } else { "√(".into() }, Style::Plain);
            flatten(inner, spans)?;
            push(spans, if is_letter { String::new() } else { ")".into() }, Style::Plain);
        }
        Math::Frac(..) | Math::Sum(_) | Math::Hat(_) | Math::Matrix(_) => return None,
    }
    Some(())
}

/// An index as a line shows it: digits below, one or two lower-case letters behind `_`.
fn below(index: &Math) -> Option<String> {
    let plain = index.plain();
    if plain.chars().all(|c| c.is_ascii_digit()) {
        return Some(plain.chars().filter_map(|c| "₀₁₂₃₄₅₆₇₈₉".chars().nth(c as usize - '0' as usize)).collect());
    }
    let is_short = plain.len() <= 2 && plain.chars().all(|c| c.is_ascii_lowercase());
    is_short.then(|| format!("_{plain}"))
}

/// An exponent as a line shows it.
fn above(exponent: &Math) -> Option<String> {
    match exponent.plain().as_str() {
        "T" => Some("^T".to_owned()),
        "2" => Some("²".to_owned()),
        "3" => Some("³".to_owned()),
        "−1" => Some("⁻¹".to_owned()),
        "n" => Some("ⁿ".to_owned()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> String {
        parse(text).map_or_else(|why| why.to_string(), |math| math.plain())
    }

    #[test]
    fn formulas_of_the_course_are_read() {
        assert_eq!(plain("I_x u + I_y v + I_t = 0"), "I_xu + I_yv + I_t = 0");
        assert_eq!(plain(r"\frac{\partial I}{\partial x} = -\lambda"), "(∂I)/(∂x) = −λ");
        assert_eq!(plain(r"E = \sum_{(x,y) \in B} |I - J|^2"), "E = Σ_(x, y) ∈ B |I − J|^2");
        assert_eq!(plain(r"\begin{pmatrix} \sum I_x^2 & 0 \\ 0 & 1 \end{pmatrix} \mathbf{d}"), "[Σ I_x^2, 0; 0, 1]d");
        assert_eq!(plain(r"\hat{\mathbf{x}} = \bar{u} - \sqrt{\alpha^2}"), "x\u{302} = u\u{304} − √(α^2)");
        assert_eq!(plain("I_{t+1}(x + u)"), "I_t+1(x + u)");
        assert_eq!(plain(r"\mathbf{P}^- = \mathbf{F} \mathbf{P} \mathbf{F}^\top"), "P^− = FPF^T");
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
    fn a_short_formula_stands_in_a_line() {
        let spans = inline(r"I_x u = -\lambda_1 \bar{u}^2").unwrap_or_default();
        let text: String = spans.iter().map(|span| span.text.as_str()).collect();
        assert_eq!(text, "I_x\u{202f}u\u{a0}=\u{a0}−λ₁u\u{304}²");
        assert!(spans.iter().any(|span| span.text == "I_x\u{202f}" && span.style == Style::Emphasis));
        let log: String = inline(r"\log_2 n").unwrap_or_default().iter().map(|span| span.text.as_str()).collect();
        assert_eq!(log, "log₂\u{a0}n");
        for long in [r"\frac{1}{2}", "x_{t+1}", r"\hat{x}"] {
            assert!(inline(long).is_err_and(|why| why.to_string().contains("$$")), "{long}");
        }
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
