//! Which of two numbers of a column is better, and the best rows of a column.

use std::borrow::Borrow;

use super::{Column, Row};

/// Which of two different numbers is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// The smaller one: costs and errors.
    Smaller,
    /// The larger one: scores.
    Larger,
}

/// Costs and errors. Columns that are in neither list count something, or trade one quality for another.
const SMALLER: [&str; 24] = [
    "candidates_mean",
    "candidates_most",
    "ms",
    "memory_kb",
    "missed_percent",
    "epe_px",
    "residual_kb",
    "center_error_px",
    "failures",
    "switches",
    "empty_percent",
    "motion_error_px",
    "drift_px",
    "residual_jitter_px",
    "scene_flow_epe_m",
    "scene_flow_median_percent",
    "sf_percent",
    "ego_translation_error_m",
    "ego_rotation_error_deg",
    "bad1_percent",
    "bad3_percent",
    "d1_percent",
    "bad3_with_partner_percent",
    "bad3_measured_percent",
];

/// Scores.
const LARGER: [&str; 16] = [
    "psnr_db",
    "mean_overlap",
    "success_auc",
    "precision_20_px",
    "match_precision",
    "repeatability",
    "mota",
    "idf1",
    "hota",
    "own_motion_f1",
    "adjusted_rand_index",
    "mask_f1",
    "mask_precision",
    "mask_recall",
    "kept_in_noise_percent",
    "kept_in_light_percent",
];

impl Column {
    /// Returns which of two numbers is better; `None` where neither is.
    pub fn better(&self) -> Option<Better> {
        let of = |names: &[&str], better| names.contains(&self.name).then_some(better);
        of(&SMALLER, Better::Smaller).or_else(|| of(&LARGER, Better::Larger))
    }

    /// Returns for each row whether its number, as shown, is the best of the column. No row is where all are alike.
    pub fn best<R: Borrow<Row>>(&self, rows: &[R]) -> Vec<bool> {
        let shown: Vec<_> = rows.iter().map(|row| self.shown(row.borrow())).collect();
        let all = || shown.iter().copied().flatten();
        let [least, most] = [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)];
        let best = match self.better() {
            Some(Better::Smaller) => least,
            Some(Better::Larger) => most,
            None => return vec![false; rows.len()],
        };
        shown.into_iter().map(|shown| least < most && shown == Some(best)).collect()
    }

    /// Returns the length of the bar of each row, as a share of the longest; none where a number is negative or all are 0.
    pub fn bars<R: Borrow<Row>>(&self, rows: &[R]) -> Vec<Option<f64>> {
        let values: Vec<_> = rows.iter().map(|row| self.value(row.borrow())).collect();
        let most = values.iter().copied().flatten().fold(0.0, f64::max);
        let has_bars = rows.len() > 1 && most > 0.0 && values.iter().flatten().all(|value| *value >= 0.0);
        values.into_iter().map(|value| value.filter(|_| has_bars).map(|value| value / most)).collect()
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::examples::{Limit, examples};
    use motionscope_core::products::{EPE, PSNR};

    use super::*;
    use crate::experiment::comparison::all_columns;
    use crate::experiment::comparison::tests::{column, row};

    #[test]
    fn the_lists_name_columns_and_each_once() {
        let all: Vec<_> = all_columns().iter().map(|column| column.name).collect();
        let named: Vec<_> = SMALLER.iter().chain(&LARGER).collect();
        for (i, name) in named.iter().enumerate() {
            assert!(all.contains(name) && !named[..i].contains(name), "{name}");
        }
    }

    #[test]
    fn better_is_what_an_example_of_success_claims() {
        let columns = all_columns();
        let mut checked = 0;
        for example in examples().filter(|example| !example.is_failure()) {
            let (measure, limit) = example.claim;
            let column = columns.iter().find(|column| column.name == measure);
            let Some(better) = column.and_then(Column::better) else { continue };
            let claimed = if matches!(limit, Limit::AtMost(_)) { Better::Smaller } else { Better::Larger };
            assert_eq!(better, claimed, "{}: {measure}", example.id);
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
    }

    #[test]
    fn bars_are_shares_of_the_longest() {
        let rows = [10.0, 40.0].map(|candidates| row("diamond", candidates, &[]));
        assert_eq!(column("candidates_mean").bars(&rows), [Some(0.25), Some(1.0)]);
        assert_eq!(column("candidates_mean").bars(&rows[..1]), [None], "one row has nothing beside it");
        assert_eq!(column("epe_px").bars(&rows), [None, None]);
    }
}
