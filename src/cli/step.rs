//! A step as data: `--json` with `--step`, and `--steps A..B --json`, one object a line. `assets/step.schema.json` describes it.

use motionscope_core::base::Error;
use motionscope_core::run::{Cursor, Direction, Move, Walk};
use motionscope_core::scene::{Decimals, Fact, Math, Number, Role, Step, Value};
use serde::Serialize;
use serde_json::json;

use super::print::{say_line, to_json};
use crate::experiment::Prepared;

/// A step in JSON.
#[derive(Serialize)]
pub struct StepReport {
    step: String,
    line: LineReport,
    /// The names of the cases that the step tells.
    cases: Vec<&'static str>,
    sentence: String,
    formulas: Vec<FormulaReport>,
    values: Vec<serde_json::Value>,
    facts: Vec<FactReport>,
}

/// A line of pseudocode.
#[derive(Serialize)]
struct LineReport {
    name: &'static str,
    text: &'static str,
}

/// A fact of the panel; several objects may have facts of one label.
#[derive(Serialize)]
struct FactReport {
    label: &'static str,
    value: String,
    /// The identity of the object that it belongs to.
    #[serde(skip_serializing_if = "Option::is_none")]
    of: Option<u32>,
}

/// A formula.
#[derive(Serialize)]
struct FormulaReport {
    latex: String,
    text: String,
}

impl StepReport {
    /// The report of the step at which `walk` stands.
    pub fn of(walk: &dyn Walk) -> Self {
        let (step, info) = (walk.step(None), walk.info());
        let text = info.line(step.line).map_or("", |line| info.pseudocode[line].text.trim());
        let formula = |math: &Math| FormulaReport { latex: math.latex(), text: math.plain() };
        let fact = |fact: &Fact| FactReport { label: fact.label, value: fact.value.clone(), of: fact.of };
        Self {
            step: walk.cursor().to_string(),
            line: LineReport { name: step.line.as_str(), text },
            cases: step.sentence.cases.iter().map(|case| case.name.as_str()).collect(),
            sentence: step.sentence.plain(),
            formulas: step.formulas().iter().map(formula).collect(),
            values: values(&step),
            facts: step.facts().iter().map(fact).collect(),
        }
    }
}

/// The values of a step in their order; a variable of several objects has one for each.
fn values(step: &Step) -> Vec<serde_json::Value> {
    let is_new = |(i, value): &(usize, &Value)| !step.values[..*i].contains(value);
    step.values.iter().enumerate().filter(is_new).map(|(_, value)| of_value(value)).collect()
}

fn of_value(value: &Value) -> serde_json::Value {
    let decimals = match value.unit.decimals {
        _ if matches!(value.number, Number::Word(_)) => None,
        Decimals::Fixed(decimals) | Decimals::Signed(decimals) => Some(decimals),
        Decimals::Count => Some(0),
        Decimals::WholeOr(_) | Decimals::AtMost(_) | Decimals::OrPower(_) | Decimals::WholeOrPower => None,
    };
    json!({
        "name": value.of.name.replace('-', "_"),
        "label": value.of.label,
        "symbol": value.of.symbol,
        "value": number(&value.number),
        "text": value.text(),
        "unit": value.unit.name,
        "decimals": decimals,
        "role": value.role.map(Role::id),
        "definition": value.of.definition.trim(),
    })
}

/// A number at full precision; null where it is undefined or infinite.
fn number(of: &Number) -> serde_json::Value {
    match of {
        Number::Real(number) if number.fract() == 0.0 && number.abs() < 2f64.powi(53) => (*number as i64).into(),
        Number::Real(number) => (*number).into(),
        Number::Vector(all) => all.iter().map(|number| self::number(&Number::Real(*number))).collect(),
        Number::Matrix(entries) => {
            let row = |y: usize| (0..entries.width()).map(|x| number(&Number::Real(entries[(x, y)]))).collect();
            (0..entries.height()).map(row).collect::<Vec<serde_json::Value>>().into()
        }
        Number::Word(word) => word.as_str().into(),
        Number::List(all) => all.iter().map(number).collect(),
    }
}

/// Prints the steps of a run from `first` to `last`, one object a line, until standard output is closed.
///
/// # Errors
/// If the run ends before `first`, fails, or standard output cannot be written.
pub fn print_steps(prepared: &Prepared, (first, last): (Cursor, Cursor)) -> Result<(), Error> {
    let mut walk = prepared.experiment.estimator.walk(&prepared.clip, prepared.experiment.frame)?;
    walk.jump(Move::To(first));
    if walk.cursor().unit < first.unit || walk.cursor().event < first.event && first.event != usize::MAX {
        let (end, unit) = (walk.cursor(), first.unit);
        return Err(match walk.failure() {
            Some(why) => why.clone(),
            None if end.unit < unit => Error::new(format!("there is no step {first}: the run ends at {end}")),
            None => Error::new(format!("there is no step {first}: that unit ends at {end}")),
        });
    }
    let finest = walk.info().granularities.len() - 1;
    loop {
        if !say_line(&to_json(&StepReport::of(&*walk))?)? || walk.cursor() >= last || walk.at_end() {
            return Ok(());
        }
        let before = walk.cursor();
        walk.jump(Move::Granularity(finest, Direction::Forward));
        match walk.failure() {
            Some(why) => return Err(why.clone()),
            None if walk.cursor() == before || walk.cursor() > last => return Ok(()),
            None => {}
        }
    }
}
