//! A comparison in sentences: what each method costs and how good it is beside the reference, by the numbers of the table.

use std::borrow::Borrow;

use motionscope_core::base::words::{capital, fixed, grouped};
use motionscope_core::products::Better;

use super::best::SAME_TIME;
use super::{Column, From, Row, all_columns};
use crate::experiment::first;

/// Ratios from here on are whole numbers.
const WHOLE_RATIO: f64 = 9.95;
/// A difference of lengths below this share of the larger one is called slight.
const SLIGHT: f64 = 0.01;
/// Units at the end of a heading, and how a difference in them is said.
const UNITS: [(&str, &str); 7] =
    [("px", " px"), ("dB", " dB"), ("m", " m"), ("°", "°"), ("kB", " kB"), ("ms", " ms"), ("%", " percentage points")];

/// Returns the row that the others are compared with: the exhaustive search, or else the first.
pub fn reference<R: Borrow<Row>>(rows: &[R]) -> usize {
    rows.iter().position(|row| row.borrow().id() == first::EXHAUSTIVE).unwrap_or(0)
}

/// Returns what `row` costs and how good it is beside `reference`: `46 × fewer candidates, EPE 0.14 px worse, 9.5 % of the minima missed`.
pub fn against(row: &Row, reference: &Row) -> String {
    let parts = [cost(row, reference), quality(row, reference), missed(row, reference)];
    let parts: Vec<_> = parts.into_iter().flatten().collect();
    if parts.is_empty() { "no number in common".to_owned() } else { parts.join(", ") }
}

/// Returns the comparison in sentences: one for each row but the reference, or what is best in a sweep.
pub fn sentences<R: Borrow<Row>>(rows: &[R]) -> Vec<String> {
    if rows.iter().any(|row| row.borrow().swept.is_some()) {
        return vec![best_run(rows)];
    }
    let Some(of) = rows.get(reference(rows)).map(Borrow::borrow) else { return Vec::new() };
    let others = rows.iter().map(Borrow::borrow).filter(|row: &&Row| !std::ptr::eq(*row, of));
    let name = |row: &Row| row.estimator.info().name;
    let alike = against(of, of);
    let told = others.map(|row| (row, against(row, of))).filter(|(_, told)| *told != alike);
    let sentences: Vec<_> =
        told.map(|(row, told)| format!("{} compared with {}: {told}.", name(row), name(of))).collect();
    match sentences.is_empty() && rows.len() > 1 {
        true => vec!["No difference between these runs.".to_owned()],
        false => sentences,
    }
}

/// The cost: candidates where both have tested some, or else the time.
fn cost(row: &Row, reference: &Row) -> Option<String> {
    let both = |name: &str| {
        let column = all_columns().into_iter().find(|column| column.name == name)?;
        Some((column.shown(row)?, column.shown(reference)?)).filter(|(own, other)| own.min(*other) > 0.0)
    };
    if let Some((own, other)) = both("candidates_mean") {
        return Some(match ratio(own, other) {
            _ if own == other => "as many candidates".to_owned(),
            None => "about as many candidates".to_owned(),
            Some(ratio) if own < other => format!("{ratio} × fewer candidates"),
            Some(ratio) => format!("{ratio} × as many candidates"),
        });
    }
    let (own, other) = both("ms")?;
    Some(match ratio(own, other) {
        Some(ratio) if own.max(other) >= SAME_TIME * own.min(other) => {
            format!("{ratio} × {}", if own < other { "faster" } else { "slower" })
        }
        _ => "about as fast".to_owned(),
    })
}

/// The ratio of the larger number to the smaller one as shown; `None` if it is shown as 1.
fn ratio(a: f64, b: f64) -> Option<String> {
    let ratio = a.max(b) / a.min(b);
    let text = if ratio < WHOLE_RATIO { fixed(ratio, 1) } else { grouped(ratio.round() as usize) };
    Some(text).filter(|text| text != "1.0")
}

/// The quality, by the first column that both have: against ground truth, if possible. Where that hardly tells them apart, also by the
/// next column that does.
fn quality(row: &Row, reference: &Row) -> Option<String> {
    let known = |column: &Column| [row, reference].map(|of| column.shown(of));
    let is_known = |column: &Column| known(column).iter().any(Option::is_some);
    let may_be_of_both = |column: &Column| [row, reference].iter().all(|of| column.may_be_of(&*of.estimator));
    // Where the truth is known, a number that both could have and only one has is reported.
    let is_first = |column: &Column| {
        is_known(column) && (!known(column).contains(&None) || column.is_against_truth() && may_be_of_both(column))
    };
    let mut columns = measured();
    let (column, better) = columns.find(|(column, _)| is_first(column))?;
    let (name, _) = name_and_unit(column.heading);
    let (own, other) = match known(&column) {
        [Some(own), Some(other)] => (own, other),
        [Some(_), None] => return Some(format!("{} has no {name}", reference.estimator.info().name)),
        [None, _] => return Some(format!("no {name}")),
    };
    let said = difference((&column, better), own, other) + &elsewhere(&column, row, reference);
    if !is_slight(&column, own, other) {
        return Some(said);
    }
    let next = columns.find_map(|(column, better)| match known(&column) {
        [Some(own), Some(other)] if !is_slight(&column, own, other) => Some(difference((&column, better), own, other)),
        _ => None,
    });
    Some(said + &next.map_or_else(String::new, |next| format!(", {next}")))
}

/// Whether two numbers of a column are the same, or two lengths nearly so.
fn is_slight(column: &Column, own: f64, other: f64) -> bool {
    let is_length = ["px", "m"].contains(&name_and_unit(column.heading).1.trim());
    own == other || is_length && (own - other).abs() < SLIGHT * own.abs().max(other.abs())
}

/// How much better or worse a number is.
fn difference((column, better): (&Column, Better), own: f64, other: f64) -> String {
    let (name, unit) = name_and_unit(column.heading);
    if own == other {
        return format!("the same {name}");
    }
    let verdict = if (own < other) == (better == Better::Smaller) { "better" } else { "worse" };
    let slight = if is_slight(column, own, other) { " (less than 1 %)" } else { "" };
    format!("{name} {}{unit} {verdict}{slight}", fixed((own - other).abs(), column.digits))
}

/// The share of the global minima that a block search misses, where the reference misses another one.
fn missed(row: &Row, reference: &Row) -> Option<String> {
    let column = all_columns().into_iter().find(|column| column.name == "missed_percent")?;
    let (own, other) = (column.shown(row)?, column.shown(reference)?);
    let instead = if other > 0.0 { format!(" instead of {}", column.text(reference)) } else { String::new() };
    (own != other).then(|| format!("{}{instead} % of the minima missed", column.text(row)))
}

/// The columns of measures in which a number can be better, those against ground truth first.
fn measured() -> impl Iterator<Item = (Column, Better)> {
    let mut columns = all_columns();
    columns.sort_by_key(|column| !column.is_against_truth());
    let is_measure = |column: &Column| matches!(column.from, From::Assessment(..));
    columns.into_iter().filter(is_measure).filter_map(|column| Some((column, column.better?)))
}

/// That the errors are those of other pixels, where they are.
fn elsewhere(column: &Column, row: &Row, reference: &Row) -> String {
    let pixels = all_columns().into_iter().find(|column| column.name == "known");
    let Some(pixels) = pixels.filter(|_| column.name == "epe_px") else { return String::new() };
    match (pixels.value(row), pixels.value(reference)) {
        (Some(own), Some(other)) if own != other => {
            format!(" at {} instead of {} pixels", pixels.text(row), pixels.text(reference))
        }
        _ => String::new(),
    }
}

/// Divides a heading into the name of the quantity and its unit.
fn name_and_unit(heading: &str) -> (&str, &'static str) {
    let found = heading.rsplit_once(' ').and_then(|(name, last)| {
        let (_, unit) = UNITS.iter().find(|(unit, _)| *unit == last)?;
        Some((name, *unit))
    });
    found.unwrap_or((heading, ""))
}

/// The best run of a sweep.
fn best_run<R: Borrow<Row>>(rows: &[R]) -> String {
    let known = |column: &Column| rows.iter().filter(|row| column.shown((*row).borrow()).is_some()).count();
    let Some((column, _)) = measured().find(|(column, _)| known(column) > 1) else {
        return "No score or error is known of two of these runs.".to_owned();
    };
    let (name, unit) = name_and_unit(column.heading);
    let unknown = match rows.len() - known(&column) {
        0 => String::new(),
        1 => format!(" 1 run has no {name}."),
        count => format!(" {count} runs have no {name}."),
    };
    let best = column.best(rows);
    let mut winners = rows.iter().map(Borrow::borrow).zip(&best).filter(|(_, is_best)| **is_best).map(|(row, _)| row);
    let Some(first) = winners.next() else {
        return format!("{}: no difference between these runs.{unknown}", capital(name));
    };
    let at = first.swept.as_ref().map_or_else(String::new, |(name, value)| format!(" with {name} {value}"));
    let others = match winners.count() {
        0 => String::new(),
        1 => ", and 1 other run".to_owned(),
        count => format!(", and {count} other runs"),
    };
    let value = match unit.trim() {
        "percentage points" => format!("{} %", column.text(first)),
        _ => format!("{}{unit}", column.text(first)),
    };
    format!("Best {name}: {value}, {}{at}{others}.{unknown}", first.estimator.info().name)
}

#[cfg(test)]
mod tests {
    use motionscope_core::products::{EPE, PSNR};

    use super::*;
    use crate::experiment::comparison::tests::row;

    #[test]
    fn a_sentence_is_true_of_the_numbers_shown() {
        let full = row("full-search", 969.24, &[(&EPE, 0.6349)]);
        let diamond = row("diamond", 20.94, &[(&EPE, 0.7749)]);
        assert_eq!(against(&diamond, &full), "46 × fewer candidates, EPE 0.140 px worse");
        assert_eq!(against(&full, &diamond), "46 × as many candidates, EPE 0.140 px better");
        assert_eq!(
            sentences(&[&diamond, &full]),
            ["Diamond search compared with Full search: 46 × fewer candidates, EPE 0.140 px worse."]
        );
        let alike = row("diamond", 969.21, &[(&EPE, 0.6351)]);
        assert_eq!(against(&alike, &full), "as many candidates, the same EPE");
        assert_eq!(sentences(&[&alike, &full]), ["No difference between these runs."]);
        assert_eq!(sentences(&[&alike, &full, &diamond]).len(), 1, "those that differ are told, and no others");
        let unscored = row("full-search", 969.24, &[]);
        assert_eq!(against(&row("diamond", 950.0, &[]), &unscored), "about as many candidates");
        assert_eq!(against(&row("diamond", 400.0, &[]), &unscored), "2.4 × fewer candidates");
    }

    #[test]
    fn where_no_candidates_are_counted_the_time_is_compared() {
        let timed = |id, ms: u64| Row { time: std::time::Duration::from_millis(ms), ..row(id, f64::NAN, &[]) };
        let against = |own, other| against(&timed("lucas-kanade", own), &timed("horn-schunck", other));
        assert_eq!(against(10, 30), "3.0 × faster");
        assert_eq!(against(200, 10), "20 × slower");
        assert_eq!(against(105, 100), "about as fast", "the next run may differ as much");
    }

    #[test]
    fn the_reference_is_the_exhaustive_search_or_the_first() {
        let [full, diamond, hexagon] = ["full-search", "diamond", "hexagon"].map(|id| row(id, 5.0, &[]));
        assert_eq!(reference(&[&diamond, &full]), 1);
        assert_eq!(reference(&[&hexagon, &diamond]), 0);
        assert!(sentences(&[&full]).is_empty(), "one alone is compared with nothing");
        assert!(sentences::<&Row>(&[]).is_empty());
    }

    #[test]
    fn the_truth_decides_before_other_measures_and_a_share_differs_by_points() {
        let [a, b] = [30.0, 31.5].map(|psnr| row("diamond", 5.0, &[(&PSNR, psnr), (&EPE, 1.0)]));
        assert_eq!(quality(&a, &b).as_deref(), Some("the same EPE, PSNR 1.50 dB worse"));
        let [a, b] = [30.0, 31.5].map(|psnr| row("diamond", 5.0, &[(&PSNR, psnr), (&EPE, psnr)]));
        assert_eq!(quality(&a, &b).as_deref(), Some("EPE 1.500 px better"), "the truth tells them apart");
        let [a, b] = [30.0, 31.5].map(|psnr| row("diamond", 5.0, &[(&PSNR, psnr)]));
        assert_eq!(quality(&a, &b).as_deref(), Some("PSNR 1.50 dB worse"));
        let [near, far] = [0.634, 0.637].map(|epe| row("diamond", 5.0, &[(&EPE, epe)]));
        assert_eq!(quality(&near, &far).as_deref(), Some("EPE 0.003 px better (less than 1 %)"));
        assert_eq!(name_and_unit("bad 3 %"), ("bad 3", " percentage points"));
        assert_eq!(name_and_unit("mask F₁"), ("mask F₁", ""));
    }

    #[test]
    fn a_search_is_told_with_the_minima_that_it_misses() {
        let missing = |missed: usize, epe: f64| {
            let mut row = row("diamond", 5.0, &[(&EPE, epe)]);
            let blocks = row.figures.blocks.as_mut().expect("blocks");
            blocks.missed = Some((0..missed).collect());
            row
        };
        let full = missing(0, 0.634);
        let one = missing(1, 0.534);
        assert_eq!(
            against(&one, &full),
            "as many candidates, EPE 0.100 px better, 25.0 % of the minima missed",
            "of one of 4 blocks"
        );
        assert!(against(&missing(2, 0.6), &one).ends_with(", 50.0 instead of 25.0 % of the minima missed"));
        assert!(against(&missing(0, 0.7), &full).ends_with("worse"), "neither misses any");
    }

    #[test]
    fn a_number_that_only_one_has_is_not_passed_over() {
        let [known, unknown] = [0.5, f64::NAN].map(|epe| row("diamond", 5.0, &[(&PSNR, 30.0), (&EPE, epe)]));
        assert_eq!(quality(&unknown, &known).as_deref(), Some("no EPE"));
        assert_eq!(quality(&known, &unknown).as_deref(), Some("Diamond search has no EPE"));
    }

    #[test]
    fn a_sweep_has_a_best_run_or_none() {
        let swept = |value: &str, epe| Row {
            swept: Some(("block".into(), value.into())),
            ..row("diamond", 5.0, &[(&EPE, epe)])
        };
        let runs = [swept("8", 0.5), swept("16", 0.3), swept("32", 0.3)];
        assert_eq!(sentences(&runs), ["Best EPE: 0.300 px, Diamond search with block 16, and 1 other run."]);
        assert_eq!(sentences(&runs[1..]), ["EPE: no difference between these runs."]);
        let unscored = || Row { swept: Some(("block".into(), "8".into())), ..row("diamond", 5.0, &[]) };
        let some = [swept("8", 0.5), swept("16", 0.3), unscored()];
        assert_eq!(sentences(&some), ["Best EPE: 0.300 px, Diamond search with block 16. 1 run has no EPE."]);
        assert_eq!(sentences(&[unscored()]), ["No score or error is known of two of these runs."]);
    }
}
