//! The line at the bottom: where the run stands, in words.

use motionscope_core::Cursor;

use super::commands::{Command, Rungs, key_text};
use super::model::snapshot::{Pointed, Snapshot};
use crate::paint::grouped;
use crate::tile;

/// Where the run stands: `block 35 of 1200 · probe 412 of 1104 · Best so far 812 at (−3, 2) · 38 % of the work`.
pub fn line(shown: &Snapshot) -> String {
    let rungs = shown.info.rungs;
    if shown.cursor == Cursor::default() {
        let unit = rungs.len().checked_sub(2).and_then(|rung| rungs.get(rung)).unwrap_or(&"unit");
        let of = shown.units.map_or_else(String::new, |units| format!("  ·  {} {unit}s to do", grouped(units)));
        return format!("not started{of}");
    }
    let mut parts = Vec::new();
    for (rung, name) in shown.place.iter().zip(rungs) {
        match (*name, rung.of) {
            // A rung of one is no news.
            (_, Some(1)) => {}
            // Levels are called by their number in the pyramid, as everywhere else: the last is the picture itself.
            ("level", Some(of)) => parts.push(format!("level {} of {} to 0", of - 1 - rung.index, of - 1)),
            (name, of) => parts.push(counted(name, rung.index + 1, of)),
        }
    }
    if let Some(name) = rungs.last() {
        parts.push(counted(name, shown.cursor.event, Some(shown.events)));
    }
    // What is told of the pixel pointed at is not where the run stands.
    parts.extend(if shown.pointed.is_none() { best(shown) } else { None });
    if let Some(share) = shown.share() {
        parts.push(format!("{} % of the work", percent(share)));
    }
    parts.extend(shown.pointed.map(explained));
    parts.join("  ·  ")
}

/// Which pixel is explained, and how another one is.
fn explained(Pointed { at: [x, y], is_held }: Pointed) -> String {
    let hint = if is_held { "Esc lets go" } else { "a click holds it" };
    format!("explained: pixel ({x}, {y}), {hint}")
}

/// The keys that matter most: `→ step   Shift+→ block   Space play   ? all keys`.
pub fn keys(rungs: Rungs) -> String {
    let (event, unit) = (rungs.name(rungs.event()), rungs.name(rungs.unit()));
    let named =
        [(Command::Into, event), (Command::Over, unit), (Command::Play, "play"), (Command::Shortcuts, "all keys")];
    let told = named.iter().filter_map(|(command, name)| {
        let key = command.face().keys.first()?;
        Some(format!("{} {name}", key_text(*key)))
    });
    told.collect::<Vec<_>>().join("   ")
}

/// The number that matters most: the best so far or the result.
fn best(shown: &Snapshot) -> Option<String> {
    let fact = tile::best(&shown.step)?;
    Some(format!("{} {}", fact.label.to_lowercase(), fact.value))
}

fn counted(name: &str, index: usize, of: Option<usize>) -> String {
    match of {
        Some(of) => format!("{name} {} of {}", grouped(index), grouped(of)),
        None => format!("{name} {}", grouped(index)),
    }
}

/// A share as whole percent; 100 only at the very end.
fn percent(share: f32) -> u32 {
    if share >= 1.0 { 100 } else { ((share * 100.0) as u32).min(99) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_end_is_all() {
        assert_eq!((percent(0.0), percent(0.999), percent(1.0)), (0, 99, 100));
    }
}
