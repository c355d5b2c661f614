use motionscope_core::course::examples::{Limit, examples};
use motionscope_core::products::{EPE, PSNR};

use super::*;
use crate::experiment::comparison::all_columns;
use crate::experiment::comparison::tests::{column, row};

#[test]
fn better_is_what_an_example_of_success_claims() {
    let columns = all_columns();
    let mut checked = 0;
    for example in examples().filter(|example| !example.is_failure()) {
        let column = columns.iter().find(|column| column.name == example.measure);
        let Some(better) = column.and_then(|column| column.better) else { continue };
        let claimed = if matches!(example.limit, Limit::AtMost(_)) { Better::Smaller } else { Better::Larger };
        assert_eq!(better, claimed, "{}: {}", example.id, example.measure);
        checked += 1;
    }
    assert!(checked > 20, "{checked}");
}

#[test]
fn the_best_are_those_that_are_shown_alike_and_nothing_undefined_is() {
    let epe = |value: f64| row("diamond", 20.0, &[(&EPE, value)]);
    let best = |values: &[f64]| column("epe_px").best(&values.iter().map(|v| epe(*v)).collect::<Vec<_>>());
    assert_eq!(best(&[0.6342, 0.6338, 0.7]), [true, true, false], "both are shown as 0.634");
    assert_eq!(best(&[0.6342, 0.6338]), [false, false], "the table shows no difference");
    assert_eq!(best(&[f64::NAN, 0.5]), [false, false], "there is nothing to be better than");
    assert_eq!(best(&[f64::NAN, 0.5, 0.4]), [false, false, true]);
    let scores = [30.0, 31.0].map(|value| row("diamond", 20.0, &[(&PSNR, value)]));
    assert_eq!(column("psnr_db").best(&scores), [false, true]);
    let counts = [1.0, 2.0].map(|value| row("diamond", value, &[]));
    assert_eq!(column("frame_kb").best(&counts), [false, false], "neither is better");
    assert_eq!(column("residual_kb").better, Some(Better::Smaller));
    assert_eq!(column("vectors_kb").better, None, "no motion costs no bits");
}

#[test]
fn times_that_the_next_run_may_swap_are_equally_good() {
    let timed = |ms: u64| Row { time: std::time::Duration::from_millis(ms), ..row("diamond", f64::NAN, &[]) };
    let best = |times: &[u64]| column("ms").best(&times.iter().map(|ms| timed(*ms)).collect::<Vec<_>>());
    assert_eq!(best(&[105, 100, 200]), [true, true, false]);
    assert_eq!(best(&[105, 100]), [false, false]);
}

#[test]
fn bars_are_shares_of_the_longest() {
    let rows = [10.0, 40.0].map(|candidates| row("diamond", candidates, &[]));
    assert_eq!(column("candidates_mean").bars(&rows), [Some(0.25), Some(1.0)]);
    assert_eq!(column("candidates_mean").bars(&rows[..1]), [None], "one row has nothing beside it");
    assert_eq!(column("epe_px").bars(&rows), [None, None]);
}
