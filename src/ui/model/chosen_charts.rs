//! Which of a step's charts are seen.

use serde::{Deserialize, Serialize};

use crate::view::panes::Pane;

/// Which charts the person looks at, by their ids.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChosenCharts {
    /// One for each place, the first one first.
    places: [Option<String>; 2],
    /// Whether the first takes the place of the stage.
    #[serde(skip)]
    pub is_enlarged: bool,
    /// Whether it is seen where there is no room for both a formula and a chart.
    #[serde(skip)]
    pub is_preferred: bool,
    /// The most width that the tabs of an estimator's steps have needed, with its id and the size of their type.
    #[serde(skip)]
    pub widest: Option<(&'static str, f32, f32)>,
}

impl ChosenCharts {
    /// What stands in `count` places when a step has `all`: what was chosen for it, or the first that stands in no other.
    pub fn seen(&self, all: &[&'static Pane], count: usize) -> Vec<&'static Pane> {
        let wanted = |place: usize| {
            let id = self.places.get(place)?.as_ref()?;
            all.iter().copied().find(|pane| pane.id == id)
        };
        let mut seen: Vec<&'static Pane> = Vec::new();
        for place in 0..count {
            let is_later =
                |pane: &Pane| (place + 1..count).any(|later| wanted(later).is_some_and(|other| other == pane));
            let is_free = |pane: &&'static Pane| !seen.contains(pane);
            let next = wanted(place).filter(is_free);
            let next = next.or_else(|| all.iter().copied().find(|pane| is_free(pane) && !is_later(pane)));
            seen.extend(next);
        }
        seen
    }

    /// Shows `pane` in `place`; what stood there takes the place of `pane`, if that has one.
    pub fn choose(&mut self, place: usize, pane: &'static Pane, seen: &[&'static Pane]) {
        for (i, other) in seen.iter().enumerate() {
            self.places[i] = Some(other.id.to_owned());
        }
        if let (Some(there), Some(here)) = (seen.iter().position(|other| *other == pane), seen.get(place)) {
            self.places[there] = Some(here.id.to_owned());
        }
        if let Some(chosen) = self.places.get_mut(place) {
            *chosen = Some(pane.id.to_owned());
        }
    }

    /// Shows the next of `all` in the first place, or the one before; where formula and chart `alternate`, the formula is one of them.
    pub fn turn(&mut self, all: &[&'static Pane], count: usize, (is_back, alternate): (bool, bool)) {
        let seen = self.seen(all, count);
        let ends = if is_back { [all.first(), all.last()] } else { [all.last(), all.first()] };
        if alternate && !all.is_empty() {
            if !self.is_preferred {
                ends[1].iter().for_each(|first| self.choose(0, first, &seen));
                self.is_preferred = true;
                return;
            }
            if seen.first() == ends[0] {
                self.is_preferred = false;
                return;
            }
        }
        let Some(at) = seen.first().and_then(|first| all.iter().position(|pane| pane == first)) else { return };
        let to = if is_back { at + all.len() - 1 } else { at + 1 } % all.len();
        self.choose(0, all[to], &seen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::panes::{HISTOGRAM, SERIES, SURFACE, SURFACE_3D};

    #[test]
    fn each_chart_is_seen_once() {
        let all: [&'static Pane; 4] = [&SURFACE, &SURFACE_3D, &SERIES, &HISTOGRAM];
        let ids =
            |chosen: &ChosenCharts, count| chosen.seen(&all, count).iter().map(|pane| pane.id).collect::<Vec<_>>();
        let mut chosen = ChosenCharts::default();
        assert_eq!(ids(&chosen, 2), ["surface", "surface-3d"]);
        chosen.choose(1, &SURFACE, &chosen.clone().seen(&all, 2));
        assert_eq!(ids(&chosen, 2), ["surface-3d", "surface"], "they change places");
        chosen.choose(0, &HISTOGRAM, &chosen.clone().seen(&all, 2));
        assert_eq!(ids(&chosen, 2), ["histogram", "surface"]);
        assert_eq!(chosen.seen(&[&SURFACE], 1), [&SURFACE], "what is chosen is not there");
        assert_eq!(chosen.seen(&[&SERIES, &SURFACE], 2), [&SERIES, &SURFACE]);
        assert!(chosen.seen(&[], 2).is_empty());
    }

    #[test]
    fn turning_leads_through_all_and_back() {
        let all: [&'static Pane; 3] = [&SURFACE, &SERIES, &HISTOGRAM];
        let mut chosen = ChosenCharts::default();
        let mut seen = Vec::new();
        for is_back in [false, false, false, true] {
            chosen.turn(&all, 1, (is_back, false));
            seen.push(chosen.seen(&all, 1)[0].id);
        }
        assert_eq!(seen, ["series", "histogram", "surface", "histogram"]);
    }

    #[test]
    fn the_formula_is_one_of_them_where_it_has_the_place_of_the_charts() {
        let all: [&'static Pane; 2] = [&SURFACE, &SERIES];
        let mut chosen = ChosenCharts::default();
        let mut seen = Vec::new();
        for is_back in [false, false, false, true, true, true] {
            chosen.turn(&all, 1, (is_back, true));
            seen.push(if chosen.is_preferred { chosen.seen(&all, 1)[0].id } else { "formula" });
        }
        assert_eq!(seen, ["surface", "series", "formula", "series", "surface", "formula"]);
    }
}
