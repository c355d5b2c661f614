//! Identity switches and IDF1 of the multi-object trackers where two objects cross in clutter, over random clips:
//! `cargo run --release -p motionscope-core --example crossings [CLIPS]`, by default 100.

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/common/crossing.rs"]
mod crossing;

use std::error::Error;

use crossing::{SEEDS, crossings};

fn main() -> Result<(), Box<dyn Error>> {
    let clips = std::env::args().nth(1).map_or(Ok(SEEDS), |text| text.parse())?;
    println!("{:58} switches   mean IDF1", format!("{clips} clips"));
    for (id, settings) in [
        ("kalman-tracker", &[][..]),
        ("kalman-tracker", &[("cost", "mahalanobis"), ("recover", "off")]),
        ("joint-probabilistic", &[("false-alarms", "3")]),
        ("multiple-hypothesis", &[("false-alarms", "3"), ("new-tracks", "4"), ("n-scan", "0")]),
        ("multiple-hypothesis", &[("false-alarms", "3")]),
    ] {
        let (switches, idf1) = crossings(id, settings, clips);
        let settings: Vec<String> = settings.iter().map(|(name, value)| format!("{name}={value}")).collect();
        println!("{:58} {switches:8} {:11.3}", format!("{id} {}", settings.join(" ")), idf1 / clips.max(1) as f64);
    }
    Ok(())
}
