//! A step as data: its line of pseudocode, its cases, and its values with symbol, unit and definition.

use motionscope_core::base::Error;
use motionscope_core::course::estimator;
use motionscope_core::run::Move;
use motionscope_core::scene::Value;
use motionscope_core::synth;

fn main() -> Result<(), Error> {
    let scene = synth::scene("pillar")?;
    let clip = synth::make(scene.id, &scene.difficulty())?;
    let mut walk = estimator("normal-flow")?.walk(&clip, 0)?;
    walk.jump(Move::To("60.80".parse()?));
    let step = walk.step(None);
    println!("{}: {}", step.line, step.sentence.plain());
    for Value { of, .. } in &step.values {
        let value = step.value(of).map(Value::text).unwrap_or_default();
        println!("{:<16} {value:<28} {}", of.name, of.definition.trim());
    }
    for formula in step.formulas() {
        println!("{}", formula.latex());
    }
    Ok(())
}
