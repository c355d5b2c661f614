//! The explanation of one step.
//!
//! `Estimator::step` puts the values of a step, names its line of pseudocode and its case, and adds formulas:
//! `Step::at(line).fact(value::COST, c).say(case::BELOW).formula(r"c = {cost}")`. Sentence and formula keep the values that
//! they show, so a tooltip has the definition, the JSON of a step has full precision, a question asks for a value or a case, a
//! worksheet leaves values out, and the change from one step to the next is the set of values that differ. A template that
//! names an undeclared value does not compile. A law replaces the words of every template by others, and all of this still
//! works.

use super::value::{Number, Value, Variable};
use super::{Case, Fact, Math, Name, Readout, Sentence, latex};

/// The explanation of a step: the pseudocode line, its values, and what is said, written and drawn with them.
///
/// It is built from its line on: values are put first, then the cases and formulas that name them. What builds it is not inlined: it is
/// called at a thousand places, none of which is in a loop.
///
/// ```
/// use motionscope_core::scene::{Role, Step, Unit};
/// motionscope_core::variables! {
///     /// The cost of the candidate.
///     COST: "Cost", "c", Unit::WHOLE, Role::Candidate;
///     /// The lowest cost before.
///     LOWEST: "Lowest cost", r"c_{\min}", Unit::WHOLE, Role::Best;
/// }
/// motionscope_core::cases! { over value;
///     BELOW: "A cost of {cost} is below {lowest}.",
/// }
/// motionscope_core::line_names!(TEST);
///
/// # fn main() {
/// let step = Step::at(TEST).fact(value::COST, 12).put(value::LOWEST, 15).say(case::BELOW);
/// let step = step.formula(r"c = {cost} < {lowest} = c_{\min}");
/// assert_eq!(step.sentence.plain(), "A cost of 12 is below 15.");
/// assert_eq!(step.formulas()[0].plain(), "c = 12 < 15 = c_min");
/// assert!(step.is(case::BELOW));
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The current line of [`crate::run::Info::pseudocode`].
    pub line: Name,
    /// The named values, in the order in which they were put.
    pub values: Vec<Value>,
    /// What happened and why, in one or two sentences.
    pub sentence: Sentence,
    /// The contents of the panels.
    pub readouts: Vec<Readout>,
}

impl Step {
    /// A step at a line, without a word.
    pub fn at(line: Name) -> Self {
        Self { line, values: Vec::new(), sentence: Sentence::default(), readouts: Vec::new() }
    }

    /// The last value of a variable.
    pub fn value(&self, of: &Variable) -> Option<&Value> {
        self.values.iter().rev().find(|value| value.of == of)
    }

    /// Whether the value of a variable stands in the sentence, in a formula or among the facts.
    pub fn shows(&self, of: &Variable) -> bool {
        let mut in_formulas = self.formulas().iter().flat_map(Math::values);
        self.sentence.variables().flatten().any(|told| told == of)
            || in_formulas.any(|(value, _)| value.of == of)
            || self.facts().iter().any(|fact| fact.label == of.label)
    }

    /// The number of a variable; NaN where it has none.
    pub fn real(&self, of: &Variable) -> f64 {
        match self.value(of).map(|value| &value.number) {
            Some(Number::Real(number)) => *number,
            _ => f64::NAN,
        }
    }

    /// Adds a value.
    #[must_use]
    pub fn put(self, variable: &'static Variable, number: impl Into<Number>) -> Self {
        self.put_value(variable.is(number))
    }

    /// Adds a value whose unit or role depends on the step.
    #[must_use]
    #[inline(never)]
    pub fn put_value(mut self, value: Value) -> Self {
        self.values.push(value);
        self
    }

    /// Adds a value that stands among the facts, too.
    #[must_use]
    pub fn fact(self, variable: &'static Variable, number: impl Into<Number>) -> Self {
        self.fact_of(variable.is(number))
    }

    /// Adds a value that stands among the facts, too, and whose unit or role depends on the step.
    #[must_use]
    #[inline(never)]
    pub fn fact_of(mut self, value: Value) -> Self {
        self.push_fact(Fact::of_value(&value));
        self.put_value(value)
    }

    /// Adds a value whose fact tells other values with it: `(3, −2) px, SAD 812`.
    #[must_use]
    #[inline(never)]
    pub fn fact_as(self, value: Value, case: &'static Case) -> Self {
        let (label, role) = (value.of.label, value.role);
        let mut step = self.put_value(value);
        let told = Sentence::default().say(case, &step.values);
        let text: String = told.words().map(|(words, _)| words).collect();
        step.push_fact(Fact::new(label, text, role));
        step
    }

    /// Adds a value that stands among the facts, too, where it is known.
    #[must_use]
    pub fn fact_if(self, variable: &'static Variable, number: Option<impl Into<Number>>) -> Self {
        match number {
            Some(number) => self.fact(variable, number),
            None => self,
        }
    }

    /// Says a case where a condition holds, with the values so far.
    #[must_use]
    pub fn say_if(self, holds: bool, case: &'static Case) -> Self {
        if holds { self.say(case) } else { self }
    }

    /// Says a case, with the values so far.
    #[must_use]
    #[inline(never)]
    pub fn say(mut self, case: &'static Case) -> Self {
        self.sentence = self.sentence.say(case, &self.values);
        self
    }

    /// Writes a formula in LaTeX, with the values so far. What cannot be read stands as it is, which a law looks for.
    #[must_use]
    pub fn formula(self, template: impl AsRef<str>) -> Self {
        self.formula_of(template.as_ref())
    }

    #[inline(never)]
    fn formula_of(mut self, template: &str) -> Self {
        let math = latex::read(template, Some(&self.values)).unwrap_or_else(|_| Math::text(template));
        self.push_formula(math);
        self
    }

    /// Adds a sentence that was put together elsewhere.
    #[must_use]
    pub fn tell(mut self, sentence: Sentence) -> Self {
        self.sentence = self.sentence.then(sentence);
        self
    }

    /// Adds the content of a panel.
    #[must_use]
    #[inline(never)]
    pub fn show(mut self, readout: Readout) -> Self {
        self.readouts.push(readout);
        self
    }

    /// Adds the contents of panels.
    #[must_use]
    pub fn show_all(mut self, readouts: impl IntoIterator<Item = Readout>) -> Self {
        self.readouts.extend(readouts);
        self
    }

    /// Whether it tells a case.
    pub fn is(&self, case: &Case) -> bool {
        self.sentence.cases.iter().any(|told| **told == *case)
    }

    /// The facts among the readouts.
    pub fn facts(&self) -> &[Fact] {
        let facts =
            self.readouts.iter().find_map(|of| if let Readout::Facts(facts) = of { Some(&facts[..]) } else { None });
        facts.unwrap_or_default()
    }

    /// The formulas among the readouts.
    pub fn formulas(&self) -> &[Math] {
        let all =
            self.readouts.iter().find_map(|of| if let Readout::Equation(all) = of { Some(&all[..]) } else { None });
        all.unwrap_or_default()
    }

    /// Facts stand first.
    fn push_fact(&mut self, fact: Fact) {
        let facts =
            self.readouts.iter_mut().find_map(|of| if let Readout::Facts(facts) = of { Some(facts) } else { None });
        match facts {
            Some(facts) => facts.push(fact),
            None => self.readouts.insert(0, Readout::Facts(vec![fact])),
        }
    }

    /// Formulas stand first, behind the facts.
    fn push_formula(&mut self, formula: Math) {
        let behind_facts = usize::from(matches!(self.readouts.first(), Some(Readout::Facts(_))));
        let all =
            self.readouts.iter_mut().find_map(|of| if let Readout::Equation(all) = of { Some(all) } else { None });
        match all {
            Some(all) => all.push(formula),
            None => self.readouts.insert(behind_facts, Readout::Equation(vec![formula])),
        }
    }
}
