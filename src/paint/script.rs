//! Subscripts, superscripts and means in a line of text, as in `I_x`, `F^T` and `v̄`.

/// How a part of a line of text stands to its baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Script {
    /// On it.
    Baseline,
    /// Smaller and lower.
    Sub,
    /// Smaller and higher.
    Super,
    /// Over the letter before, without a width of its own.
    Over,
}

/// The mark of a mean behind its letter. No face of the program has it: a macron is drawn over the letter.
pub const MEAN: char = '\u{304}';
const MACRON: &str = "¯";

/// Most letters and digits of a subscript.
const MOST_LETTERS: usize = 6;

impl Script {
    /// Size of its type, as a share of the line's.
    pub fn share(self) -> f32 {
        if matches!(self, Script::Sub | Script::Super) { 0.74 } else { 1.0 }
    }

    /// How far it stands above the baseline, in sizes of the line's type.
    pub fn rise(self) -> f32 {
        match self {
            Script::Baseline | Script::Over => 0.0,
            Script::Sub => -0.18,
            Script::Super => 0.36,
        }
    }
}

/// The parts of `text`, without the marks of its scripts: `_` between one letter or bracket and up to six letters or digits, `^` before a T
/// (transposed), and [`MEAN`]. All else is as it is written, names of files and of columns among it.
pub fn parts(text: &str) -> Vec<(&str, Script)> {
    let (mut parts, mut from) = (Vec::new(), 0);
    for (mark, c) in text.char_indices().filter(|(_, c)| ['_', '^', MEAN].contains(c)) {
        if c == MEAN {
            parts.extend([(&text[from..mark], Script::Baseline), (MACRON, Script::Over)]);
            from = mark + MEAN.len_utf8();
            continue;
        }
        let script = if c == '_' { Script::Sub } else { Script::Super };
        let after = &text[mark + 1..];
        let length = match script {
            Script::Super if mark > from && after.starts_with('T') => 1,
            Script::Sub if is_symbol(&text[..mark]) => index_length(after),
            _ => 0,
        };
        if length > 0 {
            parts.push((&text[from..mark], Script::Baseline));
            from = mark + 1 + length;
            parts.push((&text[mark + 1..from], script));
        }
    }
    parts.push((&text[from..], Script::Baseline));
    parts.retain(|(words, _)| !words.is_empty());
    parts
}

/// Whether `before` ends with a letter that stands alone, or with a bracket.
fn is_symbol(before: &str) -> bool {
    let mut letters = before.chars().rev().filter(|c| *c != MEAN);
    // A factor may stand before it: `2a_xy`, `λd_0`.
    let is_alone = |before: Option<char>| before.is_none_or(|c| !c.is_ascii_alphabetic() && !"_-./\\".contains(c));
    match letters.next() {
        Some(')' | '|') => true,
        last => last.is_some_and(char::is_alphabetic) && is_alone(letters.next()),
    }
}

/// Length in bytes of the index at the start of `after`; 0 if there is none.
fn index_length(after: &str) -> usize {
    let is_of_index = |c: char| c.is_alphabetic() || c.is_ascii_digit();
    let end = after.find(|c| !is_of_index(c)).unwrap_or(after.len());
    let mut rest = after[end..].chars();
    let is_end = match rest.next() {
        Some('.') => rest.next().is_none_or(|c| !c.is_alphanumeric()),
        // A power of the symbol with its index.
        Some('²' | '³') => true,
        // An index of several terms, as in `I_t+1`, is left as it is written.
        next => next.is_none_or(|c| !c.is_alphanumeric() && !"_-/\\+".contains(c)),
    };
    if is_end && after[..end].chars().count() <= MOST_LETTERS { end } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts with their scripts as ₍ ₎ and ⁽ ⁾.
    fn marked(text: &str) -> String {
        let part = |(words, script): (&str, Script)| match script {
            Script::Baseline => words.to_owned(),
            Script::Sub => format!("₍{words}₎"),
            Script::Super => format!("⁽{words}⁾"),
            Script::Over => format!("⁻{words}⁻"),
        };
        parts(text).into_iter().map(part).collect()
    }

    #[test]
    fn symbols_have_their_indices_and_names_stay_as_they_are() {
        for (text, shown) in [
            ("I_x u + I_y v + I_t = 0.", "I₍x₎ u + I₍y₎ v + I₍t₎ = 0."),
            ("R ← D_xx D_yy − (0.9 D_xy)²", "R ← D₍xx₎ D₍yy₎ − (0.9 D₍xy₎)²"),
            ("2a_xy + λd_0", "2a₍xy₎ + λd₍0₎"),
            ("(u_GS, v_GS) − u_0", "(u₍GS₎, v₍GS₎) − u₍0₎"),
            ("|∇(G_σ * I)|_max, E_edge", "|∇(G₍σ₎ * I)|₍max₎, E₍edge₎"),
            ("Σ w I_x², |d_x|", "Σ w I₍x₎², |d₍x₎|"),
            ("the derivative I_t.", "the derivative I₍t₎."),
            ("x′^T F x = 0", "x′⁽T⁾ F x = 0"),
            ("Σ w A^TΔb", "Σ w A⁽T⁾Δb"),
            ("(ū, v\u{304}) − ∇I", "(ū, v⁻¯⁻) − ∇I"),
        ] {
            assert_eq!(marked(text), shown);
        }
        for text in
            ["frame_10.png", "a_x.png", "clips/a_x", "shift_px", "im_a_x", "det_x2", "2^n", "I_t+1", "_x", "^T", ""]
        {
            assert_eq!(marked(text), text);
        }
    }
}
