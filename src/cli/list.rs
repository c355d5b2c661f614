//! The lists of estimators with their parameters, and of synthetic scenes with their sliders.

use motionscope_core::base::Error;
use motionscope_core::course::examples::{self, Cause, Example};
use motionscope_core::course::{estimator, estimators};
use motionscope_core::params::{Kind, Params, Spec, Value};
use motionscope_core::run::AnyEstimator;
use motionscope_core::scene::pseudocode::Line;
use motionscope_core::scene::{Asked, Question};
use motionscope_core::synth::{Difficulty, SCENES};
use serde_json::{Map, json};

/// Returns the estimators with these ids, or all of them.
///
/// # Errors
/// If there is no estimator with an id.
pub fn chosen(ids: &[String]) -> Result<Vec<Box<dyn AnyEstimator>>, Error> {
    if ids.is_empty() { Ok(estimators()) } else { ids.iter().map(|id| estimator(id)).collect() }
}

/// Returns a list of estimators as text.
pub fn text(all: &[Box<dyn AnyEstimator>], has_pseudocode: bool) -> String {
    let mut text = String::new();
    for estimator in all {
        let info = estimator.info();
        text += &format!("{}  ({})\n  {}\n  Source: {}\n", info.id, info.family, info.summary, info.source);
        text += &format!("  Steps: {}\n\n", info.granularities.join(" › "));
        text += &parameters(estimator.specs());
        if has_pseudocode {
            text += "\n";
            info.pseudocode.iter().for_each(|line| text += &format!("    {}\n", line.text));
            text += "\n";
            estimator.questions().iter().for_each(|question| text += &question_text(question));
            text += "\n";
            examples::of(info.id).for_each(|example| text += &example_text(info.id, example));
        }
    }
    text
}

/// Returns a question with its answers.
fn question_text(question: &Question) -> String {
    let asked = match question.asked {
        Asked::Place { .. } => "a place".to_owned(),
        Asked::Choice(_) => question.choices().join(" | "),
        Asked::Value { .. } => match &*question.unit() {
            "" => "a number".to_owned(),
            unit => format!("a number of {unit}"),
        },
    };
    format!("  {}\n    {asked}\n", question.text)
}

/// Returns an example with the name under which it is opened.
fn example_text(id: &str, example: &Example) -> String {
    let Example { title, cause, says, .. } = example;
    let cause = cause.map_or_else(|| "works".to_owned(), |cause| format!("fails, {}", cause.name()));
    format!("  {}  {title} ({cause})\n    {says}\n", crate::session::example::name(id, example))
}

fn parameters(specs: &[Spec]) -> String {
    let width = specs.iter().map(|spec| spec.name.len()).max().unwrap_or(0);
    let line = |spec: &Spec| {
        let Spec { name, doc, default, .. } = spec;
        let advanced = if spec.advanced { "; advanced" } else { "" };
        let idle: String = spec.idle.iter().map(|why| format!("  {:width$}  {why}\n", "")).collect();
        format!("  {name:width$}  {doc}\n  {:width$}  {}; default {default}{advanced}\n{idle}", "", spec.allowed())
    };
    specs.iter().map(line).collect()
}

/// Returns the list of synthetic scenes as text.
pub fn scenes() -> String {
    let width = SCENES.iter().map(|scene| scene.id.len()).max().unwrap_or(0);
    let scenes = SCENES.iter().map(|scene| format!("{:width$}  {}\n", scene.id, scene.teaches)).collect::<String>();
    format!(
        "{scenes}\nSliders, set by NAME=VALUE; a scene has defaults of its own for some:\n\n{}",
        parameters(Difficulty::default().specs())
    )
}

/// Returns a list of estimators as JSON.
pub fn json(all: &[Box<dyn AnyEstimator>]) -> String {
    let all: Vec<_> = all
        .iter()
        .map(|estimator| {
            let info = estimator.info();
            json!({
                "id": info.id,
                "name": info.name,
                "family": info.family,
                "summary": info.summary,
                "source": info.source,
                "pseudocode": info.pseudocode.iter().map(line).collect::<Vec<_>>(),
                "granularities": info.granularities,
                "frames": info.frames,
                "produces": estimator.produces().iter().map(|kind| kind.id).collect::<Vec<_>>(),
                "questions": estimator.questions().iter().map(question_json).collect::<Vec<_>>(),
                "examples": examples::of(info.id).map(example_json).collect::<Vec<_>>(),
                "params": estimator.specs().iter().map(spec).collect::<Vec<_>>(),
            })
        })
        .collect();
    format!("{:#}", json!(all))
}

fn example_json(example: &Example) -> serde_json::Value {
    let set = |settings: &examples::Settings| settings.iter().copied().collect::<std::collections::BTreeMap<_, _>>();
    let instead = example.instead.as_ref().map(|other| json!({ "estimator": other.id, "set": set(&other.settings) }));
    json!({
        "id": example.id,
        "title": example.title,
        "cause": example.cause.map(Cause::name),
        "clip": format!("synth:{}", example.clip),
        "frame": example.frame,
        "set": set(&example.settings),
        "says": example.says,
        "instead": instead,
    })
}

fn question_json(question: &Question) -> serde_json::Value {
    let (asked, unit) = match question.asked {
        Asked::Place { .. } => ("place", "px".into()),
        Asked::Choice(_) => ("choice", String::new()),
        Asked::Value { .. } => ("number", question.unit()),
    };
    json!({ "id": question.id, "text": question.text, "asked": asked, "answers": question.choices(), "unit": unit })
}

fn line(line: &Line) -> serde_json::Value {
    json!({ "name": line.name.as_str(), "text": line.text })
}

fn spec(spec: &Spec) -> serde_json::Value {
    let mut described = Map::new();
    described.insert("name".into(), json!(spec.name));
    described.insert("label".into(), json!(spec.label));
    described.insert("doc".into(), json!(spec.doc));
    described.insert("unit".into(), json!(spec.unit));
    described.insert("default".into(), value(spec.default.clone()));
    described.insert("advanced".into(), json!(spec.advanced));
    // Why it has no effect with some values of other parameters; nothing where it always has one.
    described.insert("no_effect".into(), json!(spec.idle));
    let (of, word) = match &spec.kind {
        Kind::Optional { of, word } => (&**of, Some(*word)),
        of => (of, None),
    };
    let (kind, range) = match of {
        Kind::Int { min, max } => ("int", json!([min, max])),
        Kind::Real { min, max } => ("real", json!([min, max])),
        Kind::Switch => ("switch", json!([false, true])),
        Kind::Choice(all) => ("choice", all.iter().map(|choice| choice.name).collect()),
        Kind::Placed(figure) => (figure.name(), json!(spec.allowed())),
        Kind::Stage(kind) => ("stage", json!(kind.ids())),
        Kind::Optional { .. } => ("optional", json!(spec.allowed())),
    };
    described.insert("type".into(), json!(kind));
    let name = match of {
        Kind::Int { .. } | Kind::Real { .. } => "range",
        Kind::Switch | Kind::Choice(_) | Kind::Stage(_) => "choices",
        Kind::Placed(_) | Kind::Optional { .. } => "form",
    };
    described.insert(name.into(), range);
    if let Some(word) = word {
        described.insert("or".into(), json!(word));
    }
    if let Kind::Stage(kind) = &spec.kind {
        described.insert("product".into(), json!(kind.product));
    }
    described.into()
}

/// Returns a value as JSON.
pub fn value(value: Value) -> serde_json::Value {
    match value {
        Value::Int(v) => json!(v),
        Value::Real(v) => json!(v),
        Value::Switch(v) => json!(v),
        Value::Choice(v) => json!(v),
        Value::Placed(v) => json!(v.to_string()),
        Value::Stage(v) => json!(v.id()),
    }
}
