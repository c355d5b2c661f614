//! The line at the bottom: where the run stands, in words, or how far the work is.

use std::time::Duration;

use eframe::egui::{Button, ProgressBar, RichText, Ui};
use motionscope_core::run::{Cursor, FRAME, Granularity, LEVEL, ROW};
use motionscope_core::scene::{Focus, Picture};

use crate::paint::grouped;
use crate::ui::commands::{Actions, Command, Granularities, key_text};
use crate::ui::model::snapshot::{Pointed, Snapshot};
use crate::ui::model::walker::{Phase, View};
use crate::view::tile;

/// Work that takes longer is told of.
pub const LATE: Duration = Duration::from_millis(250);
/// How soon it is looked whether work that is to stop has done so.
pub const SOON: Duration = Duration::from_millis(30);

/// Work that takes a while.
pub struct Work {
    /// What is done.
    pub what: String,
    /// The share of it that is done, from 0 to 1, if that is known.
    pub share: Option<f32>,
}

/// What is being worked on, if that takes a while.
pub fn work(view: &View) -> Option<Work> {
    let is_late = view.busy_for.is_some_and(|time| time > LATE);
    let share = |(done, of): (usize, usize)| Some(done as f32 / of.max(1) as f32);
    let counted = |(done, of): (usize, usize)| format!("{} of {}", grouped(done), grouped(of));
    match (view.progress, view.reading.filter(|_| is_late)) {
        _ if !view.busy => None,
        _ if view.stopping && is_late => Some(Work { what: "Stopping…".into(), share: None }),
        (_, Some(frames)) => Some(Work { what: format!("Reading frame {}", counted(frames)), share: share(frames) }),
        (Some(units), _) => Some(Work { what: counted(units), share: share(units) }),
        (None, None) if !is_late => None,
        (None, None) => {
            let what = match view.phase {
                Phase::Starting => "Starting the run…",
                Phase::Running => "Running…",
                Phase::Measuring => "Measuring the result…",
            };
            let secs = view.busy_for.map_or(0, |time| time.as_secs());
            Some(Work { what: if secs == 0 { what.into() } else { format!("{what} {secs} s") }, share: None })
        }
    }
}

/// Shows how far `work` is, with a button that stops it.
pub fn progress(ui: &mut Ui, work: &Work, actions: &mut Actions) {
    match work.share {
        Some(share) => drop(ui.add(ProgressBar::new(share).desired_width(120.0).desired_height(6.0))),
        None => drop(ui.spinner()),
    }
    ui.label(RichText::new(&work.what).small());
    let stop = format!("{} ({})", Command::Stop.entry().text, Command::Stop.key());
    if ui.add(Button::new(RichText::new(stop).small()).small()).clicked() {
        actions.command(Command::Stop);
    }
}

/// Where the run stands: `block 35 of 1200 · candidate 412 of 1104 · best so far 812 at (−3, 2) · 38 % done · step 35.412`. While
/// results are `asked` about, it is not told how many steps are left in the unit.
pub fn line(shown: &Snapshot, asked: bool) -> String {
    let granularities = shown.info.granularities;
    if shown.cursor == Cursor::default() {
        let unit = granularities
            .len()
            .checked_sub(2)
            .and_then(|granularity| granularities.get(granularity))
            .unwrap_or(&"unit");
        let of = shown.units.map_or_else(String::new, |units| format!("  ·  {} {unit}s to do", grouped(units)));
        return format!("not started{of}");
    }
    let mut parts: Vec<String> = place(shown, true).into_iter().map(|(_, words)| words).collect();
    let total = total((shown.cursor.event, shown.events), asked);
    if let Some(name) = granularities.last() {
        parts.push(counted(name, shown.cursor.event, total));
    }
    // What explains the pixel pointed at is not where the run stands.
    parts.extend(if shown.pointed.is_none() { best(shown) } else { None });
    if let Some(share) = shown.share().filter(|_| total.is_some()) {
        parts.push(format!("{} % done", percent(share)));
    }
    parts.extend(shown.pointed.map(explained));
    // As sessions and the command line write it: units and events from 1.
    parts.push(format!("step {}", shown.cursor));
    parts.join("  ·  ")
}

/// The number of steps of a unit, where it may be told: while results are `asked` about, only at its end.
pub fn total((seen, all): (usize, usize), asked: bool) -> Option<usize> {
    (!asked || seen >= all).then_some(all)
}

/// The parts of the run that it stands in, from the largest on, each with its name: `level 3 (3 is the coarsest)`, `warp 2 of 3`; without
/// `totals` `level 3`, `warp 2`.
fn place(shown: &Snapshot, totals: bool) -> Vec<(&'static str, String)> {
    let all = shown.place.iter().zip(shown.info.granularities);
    let part = |(granularity, name): (&Granularity, &&'static str)| match (*name, granularity.of) {
        // A granularity of one is no news.
        (_, Some(1)) => None,
        // Levels are called by their number in the pyramid, as everywhere else: the last is the picture itself.
        (LEVEL, Some(of)) => {
            let coarsest = if totals { format!(" ({} is the coarsest)", of - 1) } else { String::new() };
            Some((LEVEL, format!("level {}{coarsest}", of - 1 - granularity.index)))
        }
        // A row is called by its coordinate, as in sentences.
        (ROW, Some(of)) if totals => Some((ROW, format!("{} of {} rows", grouped(granularity.index + 1), grouped(of)))),
        (ROW, _) => Some((ROW, counted(ROW, granularity.index, None))),
        // Counted, where all others are named by their number in the clip.
        (FRAME, Some(of)) if totals => {
            Some((FRAME, format!("{} of {} frames", grouped(granularity.index + 1), grouped(of))))
        }
        (name, of) => Some((name, counted(name, granularity.index + 1, of.filter(|_| totals)))),
    };
    all.filter_map(part).collect()
}

/// The same in short, `level 3, warp 2, iteration 5`, where the timeline does not say it: for runs whose units are parts of larger
/// ones. Frames are named by their number in the clip, beside it.
pub fn nested_place(shown: &Snapshot) -> Option<String> {
    let parts = place(shown, false);
    let is_nested = parts.len() > 1 && shown.cursor != Cursor::default() && !shown.at_end;
    Some(without_frames(parts)).filter(|parts| is_nested && !parts.is_empty())
}

/// The parts of the run that a step belongs to, in short: `level 1, block 15`, or `pass 1, frame 9`, with the number of the frame in the
/// clip.
pub fn unit(shown: &Snapshot) -> Option<String> {
    let parts = place(shown, false).into_iter();
    let named = parts.map(|(name, words)| if name == FRAME { counted(FRAME, shown.frame, None) } else { words });
    let parts = named.collect::<Vec<_>>().join(", ");
    (!parts.is_empty()).then_some(parts)
}

fn without_frames(parts: Vec<(&'static str, String)>) -> String {
    let parts = parts.into_iter().filter(|(name, _)| *name != FRAME).map(|(_, words)| words);
    parts.collect::<Vec<_>>().join(", ")
}

/// Which pixel is explained, and how another one is.
fn explained(Pointed { at: Focus { on, at: [x, y], object }, is_held }: Pointed) -> String {
    if let Some(object) = object {
        return format!("explained: track {object}, Esc unpins it");
    }
    let hint = if is_held { "Esc unpins it" } else { "click to pin it" };
    let of = if on == Picture::CURRENT { String::new() } else { format!(" of {}", on.title(None).to_lowercase()) };
    format!("explained: pixel ({x}, {y}){of}, {hint}")
}

/// The keys that matter most: `→ step   Shift+→ block   Space play   ? all keys`.
pub fn keys(granularities: Granularities) -> String {
    let (event, unit) = (granularities.name(granularities.event()), granularities.name(granularities.unit()));
    let named =
        [(Command::Into, event), (Command::Over, unit), (Command::Play, "play"), (Command::Shortcuts, "all keys")];
    let keys = named.iter().filter_map(|(command, name)| {
        let key = command.entry().keys.first()?;
        Some(format!("{} {name}", key_text(*key)))
    });
    keys.collect::<Vec<_>>().join("   ")
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
    fn how_many_steps_are_left_is_not_told_while_results_are_asked_about() {
        assert_eq!([total((2, 5), false), total((2, 5), true), total((5, 5), true)], [Some(5), None, Some(5)]);
        assert_eq!(counted("step", 2, total((2, 5), true)), "step 2");
    }

    #[test]
    fn only_the_end_is_all() {
        assert_eq!((percent(0.0), percent(0.999), percent(1.0)), (0, 99, 100));
    }

    #[test]
    fn work_is_reported_when_it_takes_a_while() {
        let message = |view: View| work(&view).map(|work| work.what);
        let busy = |time| View { busy: true, busy_for: Some(time), ..View::default() };
        let (short, long) = (busy(LATE / 2), busy(2 * LATE));
        assert_eq!((message(View::default()), message(short.clone())), (None, None));
        assert_eq!(message(long.clone()).as_deref(), Some("Starting the run…"));
        assert_eq!(message(busy(Duration::from_millis(12_900))).as_deref(), Some("Starting the run… 12 s"));
        assert_eq!(message(View { phase: Phase::Measuring, ..long.clone() }).as_deref(), Some("Measuring the result…"));
        let units = View { progress: Some((3, 20)), ..short };
        assert_eq!(message(units).as_deref(), Some("3 of 20"));
        let reading = View { reading: Some((7, 20_000)), ..long };
        assert_eq!(
            message(reading.clone()).as_deref(),
            Some(format!("Reading frame 7 of {}", grouped(20_000)).as_str())
        );
        assert_eq!(message(View { stopping: true, ..reading.clone() }).as_deref(), Some("Stopping…"));
        assert_eq!(message(View { busy: false, ..reading }), None);
    }
}
