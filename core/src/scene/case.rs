//! The cases that a step can be, each with its sentence as a template over named values.

use super::value::{Value, Variable, is_same_name};
use super::{Name, Role};

/// A case of a step: what happened, as one or more sentences over values. Made with [`cases!`](crate::cases!).
///
/// In its text `{length}` stands for a value with its unit, `{length:bare}` for the number alone, and `{best|best match}` for
/// words in the colour of a role.
#[derive(Debug, PartialEq)]
pub struct Case {
    /// Its name among the cases of the estimator.
    pub name: Name,
    /// The template of its sentences.
    pub text: &'static str,
}

/// A part of a template.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part<'t> {
    /// Words, in the colour of a role if they have one.
    Words(&'t str, Option<Role>),
    /// The value of this name, alone or with its unit.
    Value {
        /// Its name.
        name: &'t str,
        /// Whether its unit is left out.
        is_bare: bool,
    },
}

/// The parts of a template.
pub(super) fn parts(template: &str) -> impl Iterator<Item = Part<'_>> {
    let mut rest = template;
    std::iter::from_fn(move || {
        let inner = match rest.split_once('{') {
            _ if rest.is_empty() => return None,
            None => return Some(Part::Words(std::mem::take(&mut rest), None)),
            Some(("", inner)) => inner,
            Some((words, _)) => {
                rest = &rest[words.len()..];
                return Some(Part::Words(words, None));
            }
        };
        let (inner, after) = inner.split_once('}').unwrap_or((inner, ""));
        rest = after;
        Some(match (inner.split_once('|'), inner.split_once(':')) {
            (Some((role, words)), _) => Part::Words(words, Role::called(role)),
            (None, Some((name, _))) => Part::Value { name, is_bare: true },
            (None, None) => Part::Value { name: inner, is_bare: false },
        })
    })
}

/// The last value of a name.
pub(super) fn find<'v>(values: &'v [Value], name: &str) -> Option<&'v Value> {
    values.iter().rev().find(|value| value.of.is_called(name))
}

/// Fails to compile where a template names a value that none of `known` declares, or an unknown role.
#[doc(hidden)]
pub const fn check(template: &str, known: &[&[&Variable]]) {
    let text = template.as_bytes();
    let mut i = 0;
    while i < text.len() {
        if text[i] == b'{' {
            let (from, mut to) = (i + 1, i + 1);
            while to < text.len() && text[to] != b'}' && text[to] != b'|' && text[to] != b':' {
                to += 1;
            }
            assert!(to < text.len(), "a brace is not closed in a template");
            let name = text.split_at(to).0.split_at(from).1;
            let is_known = if text[to] == b'|' { is_role(name) } else { is_declared(name, known) };
            if text[to] == b':' {
                let rest = text.split_at(to + 1).1;
                assert!(
                    rest.len() > 4 && is_same_name(rest.split_at(4).0, b"bare") && rest[4] == b'}',
                    "a value of a sentence is written whole or bare"
                );
            }
            assert!(is_known, "a template names a value or a role that is not declared");
            i = to;
        }
        i += 1;
    }
}

/// The values of texts that name none.
#[doc(hidden)]
pub mod no_values {
    /// None.
    pub const ALL: &[&super::Variable] = &[];
}

const fn is_declared(name: &[u8], known: &[&[&Variable]]) -> bool {
    let mut group = 0;
    while group < known.len() {
        let mut i = 0;
        while i < known[group].len() {
            if is_same_name(known[group][i].name.as_bytes(), name) {
                return true;
            }
            i += 1;
        }
        group += 1;
    }
    false
}

const fn is_role(name: &[u8]) -> bool {
    let mut i = 0;
    while i < Role::ALL.len() {
        if is_same_name(Role::ALL[i].id().as_bytes(), name) {
            return true;
        }
        i += 1;
    }
    false
}

/// Declares the cases of a step: a module `case` with a [`Case`] for each. The modules behind `over` are those of
/// [`variables!`](crate::variables!) whose values the texts may name; another name does not compile.
///
/// ```
/// use motionscope_core::scene::{Name, Step, Unit};
/// motionscope_core::variables! {
///     /// The length of the increment.
///     LENGTH: "Length", r"|\mathbf{d}|", Unit::SUBPIXEL;
/// }
/// motionscope_core::cases! { over value;
///     CONVERGED: "The increment of {length} is shorter than the tolerance: {result|converged}.",
/// }
/// motionscope_core::line_names!(ITERATE);
///
/// # fn main() {
/// let step = Step::at(ITERATE).put(value::LENGTH, 0.0123).say(case::CONVERGED);
/// assert_eq!(step.sentence.plain(), "The increment of 0.012 px is shorter than the tolerance: converged.");
/// # }
/// ```
#[macro_export]
macro_rules! cases {
    ($vis:vis over $($values:path),+; $($name:ident: $text:expr),+ $(,)?) => {
        /// The cases of a step by name.
        $vis mod case {
            $(
                #[doc = concat!("The case `", stringify!($name), "`.")]
                pub const $name: &$crate::scene::Case = &$crate::scene::Case {
                    name: $crate::scene::Name::new(
                        &$crate::scene::pseudocode::kebab::<{ stringify!($name).len() }>(stringify!($name)),
                    ),
                    text: $text,
                };
            )+
        }
        const _: () = {
            const KNOWN: &[&[&$crate::scene::Variable]] = &[$({
                use $values as known;
                known::ALL
            }),+];
            $($crate::scene::check_template($text, KNOWN);)+
        };
    };
    ($vis:vis $($name:ident: $text:expr),+ $(,)?) => {
        $crate::cases!($vis over $crate::scene::no_values; $($name: $text),+);
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_template_is_words_values_and_coloured_words() {
        let all: Vec<_> = parts("At {place}: {cost:bare} in the {window|search window}.").collect();
        let words = |words| Part::Words(words, None);
        let expected = [
            words("At "),
            Part::Value { name: "place", is_bare: false },
            words(": "),
            Part::Value { name: "cost", is_bare: true },
            words(" in the "),
            Part::Words("search window", Some(Role::Window)),
            words("."),
        ];
        assert_eq!(all, expected);
        assert_eq!(parts("").count(), 0);
    }
}
