//! The lines of an algorithm: each has a name, by which steps say which one they are at.
//!
//! Names and texts stand together in [`pseudocode!`](crate::pseudocode!). A name is a constant, so a misspelt one does not
//! compile and no name is there twice; a law sees every line lit, and every sentence on its own line.

use std::fmt;

/// The name of a line, as scripts know it: `update-state`. Only [`pseudocode!`](crate::pseudocode!) and
/// [`line_names!`](crate::line_names!) make one.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name(&'static str);

impl Name {
    /// A name that a macro has spelled.
    #[doc(hidden)]
    pub const fn new(kebab: &'static [u8]) -> Self {
        Self(name_of(kebab))
    }

    /// The name in kebab case: `update-state`.
    pub const fn as_str(self) -> &'static str {
        self.0
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.0)
    }
}

/// The text of a name that a macro has spelled.
#[doc(hidden)]
pub const fn name_of(kebab: &'static [u8]) -> &'static str {
    match std::str::from_utf8(kebab) {
        Ok(name) => name,
        Err(_) => panic!("a name is made of an identifier"),
    }
}

/// `UPDATE_STATE` as `update-state`.
#[doc(hidden)]
pub const fn kebab<const N: usize>(identifier: &str) -> [u8; N] {
    let (bytes, mut kebab, mut i) = (identifier.as_bytes(), [0; N], 0);
    while i < N {
        kebab[i] = if bytes[i] == b'_' { b'-' } else { bytes[i].to_ascii_lowercase() };
        i += 1;
    }
    kebab
}

/// A line of an algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Its name in steps.
    pub name: Name,
    /// Its text, indented by two spaces for each enclosing loop or condition.
    pub text: &'static str,
}

impl Line {
    /// Number of enclosing loops and conditions.
    pub fn depth(&self) -> usize {
        (self.text.len() - self.text.trim_start().len()) / 2
    }
}

/// The index in `lines` of the line called `name`.
pub fn find(lines: &[Line], name: Name) -> Option<usize> {
    lines.iter().position(|line| line.name == name)
}

/// Whether line `index` is a heading: the head of a loop, condition or procedure, followed by its indented body.
pub fn is_heading(lines: &[Line], index: usize) -> bool {
    lines.get(index + 1).is_some_and(|next| next.depth() > lines[index].depth())
}

/// The headings enclosing line `index`, the innermost first.
pub fn around(lines: &[Line], index: usize) -> impl Iterator<Item = usize> {
    let mut depth = lines.get(index).map_or(0, Line::depth);
    (0..index.min(lines.len())).rev().filter(move |&above| {
        let is_around = lines[above].depth() < depth;
        depth = depth.min(lines[above].depth());
        is_around
    })
}

/// Declares the lines of an algorithm: a module `line` with a [`Name`] for each, and all of them as `line::ALL` for
/// [`Info::pseudocode`](crate::run::Info).
///
/// ```
/// motionscope_core::pseudocode! {
///     EACH_FRAME: "for each frame t",
///     KEEP_BEST: "  best ← match of minimum cost",
/// }
/// assert_eq!(line::KEEP_BEST.as_str(), "keep-best");
/// assert_eq!(line::ALL[1].text, "  best ← match of minimum cost");
/// ```
#[macro_export]
macro_rules! pseudocode {
    ($($name:ident: $text:expr),+ $(,)?) => {
        /// The lines of the algorithm by name.
        mod line {
            $crate::line_names!($($name),+);

            /// All of them, in their order.
            #[allow(dead_code, reason = "a test may need no more than the names")]
            pub const ALL: &[$crate::scene::Line] =
                &[$($crate::scene::Line { name: $name, text: $text }),+];
        }
    };
}

/// Declares names of lines that several algorithms share; a line of the same name in [`pseudocode!`](crate::pseudocode!) is
/// one of them.
#[macro_export]
macro_rules! line_names {
    ($($name:ident),+ $(,)?) => {$(
        #[doc = concat!("The line `", stringify!($name), "`.")]
        pub const $name: $crate::scene::Name =
            $crate::scene::Name::new(&$crate::scene::pseudocode::kebab::<{ stringify!($name).len() }>(stringify!($name)));
    )+};
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::pseudocode! {
        EACH_FRAME: "for each frame t",
        PREDICT: "  predict",
        IS_SEEN: "  if it is seen",
        UPDATE_STATE: "    update",
        SMOOTH: "smooth",
    }

    #[test]
    fn a_line_is_found_by_its_name_and_knows_what_is_around_it() {
        assert_eq!((line::UPDATE_STATE.as_str(), line::EACH_FRAME.to_string()), ("update-state", "each-frame".into()));
        let at = |name| find(line::ALL, name).expect("it is declared");
        let names = |name| around(line::ALL, at(name)).map(|i| line::ALL[i].name).collect::<Vec<_>>();
        assert_eq!(names(line::UPDATE_STATE), [line::IS_SEEN, line::EACH_FRAME]);
        assert_eq!(names(line::PREDICT), [line::EACH_FRAME]);
        assert_eq!(names(line::SMOOTH), []);
        let headings = line::ALL.iter().filter(|line| is_heading(super::tests::line::ALL, at(line.name)));
        assert_eq!(headings.map(|line| line.name).collect::<Vec<_>>(), [line::EACH_FRAME, line::IS_SEEN]);
    }
}
