//! Walks through the search of one block, there and back: what happens at each step, and why.
//!
//! ```text
//! cargo run -p motionscope-core --example walk_a_search [ESTIMATOR]
//! ```

use motionscope_core::base::Error;
use motionscope_core::course::estimator;
use motionscope_core::run::{Cursor, Direction, Move};
use motionscope_core::synth;

fn main() -> Result<(), Error> {
    let id = std::env::args().nth(1).unwrap_or_else(|| "diamond".into());
    let sample = &synth::SCENES[0];
    let clip = synth::make(sample.id, &sample.difficulty())?;
    let search = estimator(&id)?;
    println!("{} on \"{}\", frame 0 → 1\n", search.info().name, sample.title);

    let mut walk = search.walk(&clip, 0)?;
    let event = walk.info().granularities.len() - 1;
    walk.jump(Move::To(Cursor { unit: 34, event: 1 }));
    loop {
        println!("{:>6}  {}", walk.cursor().to_string(), walk.step(None).sentence.plain());
        if walk.cursor().event == walk.events() {
            break;
        }
        walk.jump(Move::Granularity(event, Direction::Forward));
    }

    // Going back is as cheap, and leads through the same states.
    walk.jump(Move::Granularity(event, Direction::Back));
    println!("\nOne step back: {}", walk.step(None).sentence.plain());
    Ok(())
}
