//! Formulas in a line of words of a lesson.

use motionscope_core::base::Error;
use motionscope_core::scene::Math;
use motionscope_core::scene::latex::parse;

use crate::paint::THIN;
use crate::paint::charts::prose::{Span, Style};

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
        Math::Value(..) | Math::Frac(..) | Math::Sum(_) | Math::Hat(_) | Math::Matrix(_) => return None,
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
}
