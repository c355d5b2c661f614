//! Sentences in which values and words carry the colours of roles.

use super::Role;
use super::case::{Case, Part, find, parts};
use super::value::{Value, Variable};

/// The sentences of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sentence {
    /// The cases that they tell, in their order.
    pub cases: Vec<&'static Case>,
    pieces: Vec<Piece>,
}

/// A part of a sentence.
#[derive(Clone, Debug, PartialEq)]
enum Piece {
    /// Words, in the colour of a role if they have one.
    Words(String, Option<Role>),
    /// A value, alone or with its unit.
    Value {
        /// The value.
        value: Box<Value>,
        /// Whether its unit is left out.
        is_bare: bool,
    },
}

impl Piece {
    fn text(&self) -> String {
        match self {
            Piece::Words(words, _) => words.clone(),
            Piece::Value { value, is_bare: true } => value.bare(),
            Piece::Value { value, is_bare: false } => value.text(),
        }
    }

    fn role(&self) -> Option<Role> {
        match self {
            Piece::Words(_, role) => *role,
            Piece::Value { value, .. } => value.role,
        }
    }
}

impl Sentence {
    /// The sentence in other words, with the same cases and values.
    #[must_use]
    pub fn in_words(mut self, mut translate: impl FnMut(&str) -> String) -> Self {
        for piece in &mut self.pieces {
            if let Piece::Words(words, _) = piece {
                *words = translate(words);
            }
        }
        self
    }

    /// Adds plain words.
    #[must_use]
    pub fn text(mut self, words: impl Into<String>) -> Self {
        self.pieces.push(Piece::Words(words.into(), None));
        self
    }

    /// Adds words that carry a role's colour.
    #[must_use]
    pub fn ink(mut self, role: Role, words: impl Into<String>) -> Self {
        self.pieces.push(Piece::Words(words.into(), Some(role)));
        self
    }

    /// Adds the sentence of a case with `values`, set apart by a space. A value that is missing leaves its name in braces, which a law
    /// looks for.
    #[must_use]
    pub fn say(mut self, case: &'static Case, values: &[Value]) -> Self {
        let is_apart = self.pieces.last().is_some_and(|last| !last.text().ends_with(' '));
        if is_apart && !case.text.starts_with([' ', ',', ';', '.', ':']) {
            self.pieces.push(Piece::Words(" ".into(), None));
        }
        self.pieces.extend(parts(case.text).map(|part| match part {
            Part::Words(words, role) => Piece::Words(words.into(), role),
            Part::Value { name, is_bare } => match find(values, name) {
                Some(value) => Piece::Value { value: Box::new(value.clone()), is_bare },
                None => Piece::Words(format!("{{{name}}}"), None),
            },
        }));
        self.cases.push(case);
        self
    }

    /// Adds another sentence as it is.
    #[must_use]
    pub fn then(mut self, other: Sentence) -> Self {
        self.cases.extend(other.cases);
        self.pieces.extend(other.pieces);
        self
    }

    /// How many sentences it has.
    pub fn count(&self) -> usize {
        self.ends().len()
    }

    /// Its first `count` sentences, followed by “…” where there are more.
    #[must_use]
    pub fn first(&self, count: usize) -> Self {
        let Some(&(last, end)) = self.ends().get(count.saturating_sub(1)).filter(|_| count < self.count()) else {
            return self.clone();
        };
        let mut pieces = self.pieces[..=last].to_vec();
        if let Some(Piece::Words(words, _)) = pieces.last_mut() {
            words.truncate(end);
        }
        pieces.push(Piece::Words(" …".into(), None));
        Self { cases: self.cases.clone(), pieces }
    }

    /// Where its sentences end: the piece, and the byte behind the full stop.
    fn ends(&self) -> Vec<(usize, usize)> {
        let mut ends = Vec::new();
        for (i, piece) in self.pieces.iter().enumerate() {
            let Piece::Words(words, _) = piece else { continue };
            let is_last = i + 1 == self.pieces.len();
            let at_end = words.ends_with('.').then_some(words.len());
            ends.extend(words.match_indices(". ").map(|(at, _)| (i, at + 1)));
            ends.extend(at_end.filter(|_| is_last || self.pieces[i + 1].text().starts_with(' ')).map(|end| (i, end)));
        }
        ends
    }

    /// Whether it says nothing.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// Its words, each with the role whose colour it carries.
    pub fn words(&self) -> impl DoubleEndedIterator<Item = (String, Option<Role>)> + '_ {
        self.pieces.iter().map(|piece| (piece.text(), piece.role()))
    }

    /// The variables of its words: `None` of words that are no value.
    pub fn variables(&self) -> impl DoubleEndedIterator<Item = Option<&'static Variable>> + '_ {
        self.pieces.iter().map(|piece| match piece {
            Piece::Words(..) => None,
            Piece::Value { value, .. } => Some(value.of),
        })
    }

    /// The roles of its words, each once, in their order.
    pub fn roles(&self) -> Vec<Role> {
        let mut roles = Vec::new();
        for role in self.pieces.iter().filter_map(Piece::role) {
            if !roles.contains(&role) {
                roles.push(role);
            }
        }
        roles
    }

    /// The sentence without colours, with plain spaces.
    pub fn plain(&self) -> String {
        self.words().map(|(words, _)| words.replace('\u{a0}', " ")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_sentence_is_cut_between_sentences() {
        let said = Sentence::default()
            .text("The cost is ")
            .ink(Role::Best, "3.5")
            .text(". It is low. ")
            .text("So it is kept.");
        assert_eq!(said.count(), 3);
        assert_eq!(
            [1, 2].map(|count| said.first(count).plain()),
            ["The cost is 3.5. …", "The cost is 3.5. It is low. …"]
        );
        assert_eq!([3, 4].map(|count| said.first(count)), [said.clone(), said]);
    }
}
