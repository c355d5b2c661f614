//! Steps as data on the command line: `--step` and `--steps` with `--json`, as `assets/step.schema.json` describes them.

use std::io::{BufRead as _, BufReader};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

const CLIP: &str = "synth:pillar,width=96,height=64";

fn motionscope(line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    command.args(line.split(' '));
    command
}

fn output(line: &str) -> Output {
    motionscope(line).output().expect("the program starts")
}

fn lines(line: &str) -> Vec<Value> {
    let output = output(line);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// What of `value` contradicts `schema`: types, required and unknown properties, enumerations.
fn faults(schema: &Value, value: &Value, path: &str) -> Vec<String> {
    let is_of = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "null" => value.is_null(),
        other => panic!("the schema has a type {other}"),
    };
    let names: Vec<&str> = match &schema["type"] {
        Value::String(name) => vec![name],
        Value::Array(names) => names.iter().filter_map(Value::as_str).collect(),
        _ => panic!("{path} has no type in the schema"),
    };
    let mut faults = Vec::new();
    if !names.into_iter().any(is_of) {
        faults.push(format!("{path} is {value}"));
    }
    if let Value::Array(all) = &schema["enum"]
        && !all.contains(value)
    {
        faults.push(format!("{path} is {value}, not one of the enumeration"));
    }
    for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
        if value.get(name).is_none() {
            faults.push(format!("{path} lacks {name}"));
        }
    }
    for (name, inner) in value.as_object().into_iter().flatten() {
        match (schema["properties"].get(name), &schema["additionalProperties"]) {
            (Some(schema), _) => faults.extend(self::faults(schema, inner, &format!("{path}.{name}"))),
            (None, schema) if schema.is_object() => {
                faults.extend(self::faults(schema, inner, &format!("{path}.{name}")))
            }
            _ => faults.push(format!("{path} has an unknown {name}")),
        }
    }
    for (i, inner) in value.as_array().into_iter().flatten().enumerate() {
        if schema["items"].is_object() {
            faults.extend(self::faults(&schema["items"], inner, &format!("{path}[{i}]")));
        }
    }
    faults
}

#[test]
fn steps_are_data_as_the_schema_describes_them() {
    let schema: Value = serde_json::from_str(include_str!("../assets/step.schema.json")).expect("a schema");
    let estimators =
        ["normal-flow", "full-search", "horn-schunck", "kalman-filter", "mean-shift", "motion-clustering", "fast"];
    for estimator in estimators {
        let steps = lines(&format!("run {CLIP} --estimator {estimator} --steps 0..2.3 --json"));
        assert!(steps.len() > 2, "{estimator}: {} steps", steps.len());
        for step in &steps {
            assert_eq!(faults(&schema, step, estimator), Vec::<String>::new());
        }
    }
}

#[test]
fn the_step_of_a_run_is_one_of_its_steps() {
    let run = &lines(&format!("run {CLIP} --estimator normal-flow --step 20.30 --json"))[0];
    let steps = lines(&format!("run {CLIP} --estimator normal-flow --steps 20.29..20.31 --json"));
    let cursors: Vec<_> = steps.iter().map(|step| step["step"].as_str().expect("a cursor")).collect();
    assert_eq!(cursors, ["20.29", "20.30", "20.31"]);
    assert_eq!(run["step"], steps[1]);
    let gradient = run["step"]["values"].as_array().expect("values").iter().find(|value| value["name"] == "gradient");
    let gradient = gradient.expect("the gradient is a value");
    let shown: f64 =
        gradient["text"].as_str().and_then(|text| text.split(' ').next()).expect("text").parse().expect("a number");
    assert!((gradient["value"].as_f64().expect("a number") - shown).abs() <= 0.005, "{gradient}");
}

#[test]
fn steps_beyond_the_run_are_refused_in_one_sentence() {
    let cases = [
        ("--steps 70..71 --json", "there is no step 70"),
        ("--steps 20.300..20.301 --json", "that unit ends at 20.96"),
        ("--steps 3..2 --json", "needs A ≤ B"),
        ("--steps 1..2", "--json"),
    ];
    for (line, says) in cases {
        let output = output(&format!("run {CLIP} --estimator normal-flow {line}"));
        let why = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && why.contains(says), "{line}: {why}");
        assert!(output.stdout.is_empty(), "{line}");
    }
}

#[test]
fn a_reader_may_stop_after_the_first_step() {
    let mut run = motionscope(&format!("run {CLIP} --estimator normal-flow --steps 0..end --json"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut first = String::new();
    BufReader::new(run.stdout.take().expect("a pipe")).read_line(&mut first).expect("a line");
    let ended = run.wait_with_output().expect("it ends");
    assert!(ended.status.success() && ended.stderr.is_empty(), "{}", String::from_utf8_lossy(&ended.stderr));
    assert!(first.contains("\"step\":\"0\""), "{first}");
}
