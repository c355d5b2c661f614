//! The decision of a step: the question of the estimator that it answers, with answers to tick.

use motionscope_core::scene::{Answer, Asked, Question, Scene, Shown, Step};

/// A question with its answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// The question.
    pub text: String,
    /// The answers to choose from.
    pub choices: Vec<&'static str>,
    /// The index of the right one.
    pub right: usize,
}

impl Decision {
    /// The first of the `questions` asked in a `unit` that has answers to choose from and is answered by this `step` of it.
    pub fn of(questions: &[Question], (step, unit): (&Step, usize)) -> Option<Self> {
        // A choice depends on the step alone.
        let scene = Scene::default();
        let shown = Shown { step, scene: &scene };
        let is_choice = |question: &&Question| matches!(question.asked, Asked::Choice(_)) && question.is_asked_in(unit);
        let decided = |question: &Question| match question.answer(shown, shown)? {
            Answer::Choice(right) => Some(Self { text: of_this(question.text), choices: question.choices(), right }),
            Answer::Place { .. } | Answer::Number { .. } => None,
        };
        questions.iter().filter(is_choice).find_map(decided)
    }

    /// Whether a text has a word that only the right answer has.
    pub fn is_told_by(&self, text: &str) -> bool {
        let words = |text: &str| words_of(text).collect::<Vec<_>>();
        let others = self.choices.iter().enumerate().filter(|(index, _)| *index != self.right);
        let known: Vec<String> = others.flat_map(|(_, choice)| words(choice)).chain(words(&self.text)).collect();
        let told = words(text);
        words_of(self.choices[self.right]).any(|word| !known.contains(&word) && told.contains(&word))
    }
}

/// The words of a text that tell something, without the ends of plurals and of verbs.
fn words_of(text: &str) -> impl Iterator<Item = String> {
    /// Letters of a word that tells something.
    const LEAST: usize = 4;
    /// Longer words that tell nothing.
    const COMMON: [&str; 9] = ["another", "enough", "from", "other", "than", "that", "there", "this", "with"];
    let words = text.split(|letter: char| !letter.is_alphabetic()).map(str::to_lowercase);
    let telling = words.filter(|word| word.chars().count() >= LEAST && !COMMON.contains(&&**word));
    telling.map(|word| word.trim_end_matches('s').trim_end_matches("ed").to_owned())
}

/// A question about the next step as one about the step on the sheet.
fn of_this(text: &str) -> String {
    text.replace("the next ", "this ")
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::{Name, Reply, Unit};

    use super::*;

    motionscope_core::pseudocode! {
        TEST: "test a candidate",
        KEEP: "keep the best",
    }

    motionscope_core::variables! {
        /// The cost of the candidate.
        COST: "Cost", "c", Unit::WHOLE;
    }

    const REPLIES: &[Reply] =
        &[Reply::above(line::TEST, (value::COST, 8.0), "No"), Reply::at(line::TEST, "Yes: it is lower")];

    #[test]
    fn a_text_tells_the_decision_with_a_word_that_only_the_right_answer_has() {
        let choices = vec!["Yes: the lines intersect well", "No: an edge, its lines are nearly parallel"];
        let decision = Decision { text: "Does this window determine its flow?".into(), choices, right: 1 };
        assert!(decision.is_told_by("An edge determines one component.") && decision.is_told_by("Edges are none."));
        let telling_nothing = ["No window is an island: its lines.", "How well do the lines intersect?", "Yes and no."];
        assert!(!telling_nothing.iter().any(|text| decision.is_told_by(text)));
        let choices = vec!["No: rejected", "Yes: there is another shift"];
        let decided = |right| Decision { text: "Is it kept?".into(), choices: choices.clone(), right };
        assert!(decided(0).is_told_by("The gate rejects it."), "another form of the word");
        assert!(!decided(1).is_told_by("There is no other way."), "words that tell nothing");
    }

    #[test]
    fn a_choice_that_the_step_answers_is_asked_about_this_step() {
        let questions = [
            Question::value("cost", "Which cost has the next candidate?", line::TEST, value::COST),
            Question::choice("lower", "Does the next candidate lower the minimum?", REPLIES),
        ];
        let decision = |questions: &[Question], line: Name, unit| {
            Decision::of(questions, (&Step::at(line).put(value::COST, 9), unit))
        };
        let asked = decision(&questions, line::TEST, 0).expect("a decision");
        assert_eq!(asked.text, "Does this candidate lower the minimum?");
        assert_eq!((asked.choices[asked.right], asked.choices.len()), ("No", 2));
        assert_eq!(decision(&questions, line::KEEP, 0), None);
        assert_eq!(decision(&questions[..1], line::TEST, 0), None, "a number is no choice");
        let later = questions.map(Question::after_first_unit);
        assert_eq!(decision(&later, line::TEST, 0), None, "the answer is always the same there");
        assert!(decision(&later, line::TEST, 1).is_some());
    }
}
