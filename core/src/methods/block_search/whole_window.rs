//! The result of full search in a search window, computed only to explain a step.

use super::probe::Probe;
use super::{Displacement, Match, Patch, Window, shorter};
use crate::methods::cost::{self, Sum, windows::Windows};

/// The costs of a whole search window.
pub(super) struct WholeWindow {
    window: Window,
    costs: Vec<f64>,
    /// The global minimum; of several, that of the shortest displacement.
    pub least: Match,
}

impl Probe<'_> {
    /// The costs of all candidates of the block, with the rate term.
    pub(super) fn full_search(&self) -> WholeWindow {
        let (mut patch, mut windows, mut costs, mut sums) =
            (Patch::default(), Windows::default(), Vec::new(), Vec::new());
        let (window, block, kind) = (self.window, self.block(), self.settings.matching.cost);
        patch.take_block(self.pair, block);
        patch.take_area(self.pair, block, window);
        let Patch { block: cut, area } = &patch;
        match kind.sum() {
            Some(Sum::Absolute) => cost::window(cut, area, window.size, &mut sums),
            Some(Sum::Squared) => windows.squared_differences(cut, area, window.size, &mut sums),
            None => kind.window(cut, area, window.size, (&mut windows, &mut costs)),
        }
        if kind.sum().is_some() {
            costs.extend(sums.iter().map(|&sum| kind.of(sum, block)));
        }
        for (index, cost) in costs.iter_mut().enumerate() {
            *cost += self.rate.price(window.displacement(index).map(|c| 4 * c));
        }
        WholeWindow::new(window, costs)
    }
}

impl WholeWindow {
    fn new(window: Window, costs: Vec<f64>) -> Self {
        let all = costs.iter().enumerate().map(|(index, &cost)| Match::whole(window.displacement(index), cost));
        let is_lower =
            |a: &Match, b: &Match| a.cost < b.cost || a.cost == b.cost && shorter(a.displacement, b.displacement);
        let least = all.reduce(|a, b| if is_lower(&b, &a) { b } else { a }).unwrap_or_default();
        Self { window, costs, least }
    }

    /// The cost of a candidate.
    pub fn cost(&self, displacement: Displacement) -> Option<f64> {
        Some(self.costs[self.window.index(displacement)?])
    }

    fn all(&self) -> impl Iterator<Item = Match> {
        self.costs.iter().enumerate().map(|(index, &cost)| Match::whole(self.window.displacement(index), cost))
    }

    /// The candidates that cost as much as `displacement`.
    pub fn ties(&self, displacement: Displacement) -> Vec<Match> {
        let cost = self.cost(displacement);
        self.all().filter(|other| Some(other.cost) == cost && other.displacement != displacement).collect()
    }

    /// The other local minima that cost at most `most`, lowest first: not next to `displacement`, and none next to a lower cost.
    pub fn competing_minima(&self, displacement: Displacement, most: f64) -> Vec<Match> {
        let is_beside = |at: Displacement| [0, 1].iter().all(|&i| (at[i] - displacement[i]).abs() < 2);
        let mut competing_minima: Vec<Match> = self
            .all()
            .filter(|other| other.cost <= most && !is_beside(other.displacement) && self.is_minimum(*other))
            .collect();
        competing_minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        competing_minima
    }

    /// Whether none of the 8 neighbours has a lower cost.
    fn is_minimum(&self, at: Match) -> bool {
        let around = (-1..=1).flat_map(|v| (-1..=1).map(move |u| [u, v]));
        let neighbours = around.map(|[u, v]| [at.displacement[0] + u, at.displacement[1] + v]);
        neighbours.filter_map(|displacement| self.cost(displacement)).all(|cost| cost >= at.cost)
    }
}
