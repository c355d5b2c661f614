//! The best rows of a column, and its bars.

use std::borrow::Borrow;

use motionscope_core::products::Better;

use super::{Column, Row};

/// Two times with a smaller ratio differ by no more than from one run to the next.
pub const SAME_TIME: f64 = 1.15;

impl Column {
    /// Returns for each row whether its number, as shown, is the best of the column, or as good. None is best if all are alike.
    pub fn best<R: Borrow<Row>>(&self, rows: &[R]) -> Vec<bool> {
        let shown: Vec<_> = rows.iter().map(|row| self.shown(row.borrow())).collect();
        let all = || shown.iter().copied().flatten();
        let best = match self.better {
            Some(Better::Smaller) => all().fold(f64::INFINITY, f64::min),
            Some(Better::Larger) => all().fold(f64::NEG_INFINITY, f64::max),
            None => return vec![false; rows.len()],
        };
        let is_best = |value: f64| value == best || self.is_time && value < SAME_TIME * best;
        let are_alike = all().all(is_best);
        shown.iter().map(|shown| !are_alike && shown.is_some_and(is_best)).collect()
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
mod tests;
