//! Several estimators in lockstep: which of them, and leaving it.

use motionscope_core::base::Error;
use motionscope_core::course::compare::changed_alike;
use motionscope_core::course::estimator;
use motionscope_core::run::{AnyEstimator, Cursor};

use super::App;
use crate::experiment::comparison::Row;
use crate::experiment::side_by_side::{Companion, SideBySide};
use crate::ui::model::snapshot::Place;

impl App {
    /// Starts the estimators `ids` in lockstep, led by the chosen one if it is among them, else by the first.
    pub(super) fn lockstep(&mut self, ids: &[&str]) {
        let now = self.run.document.estimator();
        let pace = self.run.document.side_by_side().pace;
        let leader = ids.iter().find(|id| **id == now.info().id).or(ids.first());
        let side_by_side = || {
            let leader = changed_alike(now, estimator(leader.copied().unwrap_or_default())?);
            let others: Vec<_> = ids.iter().filter(|id| **id != leader.info().id).collect();
            let side_by_side = SideBySide::of(&*leader, &others, pace)?;
            Ok::<_, Error>((leader, side_by_side))
        };
        match side_by_side() {
            Ok((leader, side_by_side)) => self.set_lockstep(leader, side_by_side),
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Toggles between one estimator and lockstep with those used last.
    pub(super) fn toggle_lockstep(&mut self) {
        let leader = self.run.document.estimator().boxed_clone();
        if !self.run.document.side_by_side().is_empty() {
            self.run.last_lockstep = self.run.document.side_by_side().clone();
            return self.set_lockstep(leader, SideBySide::default());
        }
        let mut side_by_side = self.run.last_lockstep.clone();
        // Those that were there last, if they can go with it.
        let id = leader.info().id;
        side_by_side.beside.retain(|companion| companion.estimator.info().id != id);
        let is_possible = !side_by_side.is_empty() && side_by_side.check(&*leader).is_ok();
        if is_possible {
            side_by_side.follow(&*leader);
            side_by_side.suit(&*leader);
        } else {
            side_by_side = SideBySide::usual(&*leader);
        }
        self.set_lockstep(leader, side_by_side);
    }

    /// Adds the estimator `id` to the lockstep.
    pub(super) fn add_beside(&mut self, id: &str) {
        let leader = self.run.document.estimator().boxed_clone();
        let mut side_by_side = self.run.document.side_by_side().clone();
        let added = estimator(id).and_then(|added| {
            side_by_side.beside.push(Companion::new(added, &*leader));
            side_by_side.check(&*leader)
        });
        match added {
            Ok(()) => {
                side_by_side.suit(&*leader);
                self.set_lockstep(leader, side_by_side);
            }
            Err(error) => self.toasts.fail(error.to_string()),
        }
    }

    /// Takes an estimator out of the lockstep.
    pub(super) fn remove_beside(&mut self, index: usize) {
        let leader = self.run.document.estimator().boxed_clone();
        let mut side_by_side = self.run.document.side_by_side().clone();
        if index < side_by_side.beside.len() {
            side_by_side.beside.remove(index);
            side_by_side.suit(&*leader);
            self.set_lockstep(leader, side_by_side);
        }
    }

    /// Continues `leader` in lockstep with others, or alone, from its position.
    pub(super) fn set_lockstep(&mut self, leader: Box<dyn AnyEstimator>, side_by_side: SideBySide) {
        self.run.document.set_lockstep(leader, side_by_side);
        self.panes.states.explained = 0;
        self.restart();
    }

    /// Goes to the first block whose global minimum an estimator missed, with that estimator.
    pub(super) fn visit(&mut self, row: &Row) {
        if !self.run.document.side_by_side().is_empty() {
            self.run.last_lockstep = self.run.document.side_by_side().clone();
        }
        self.run.document.set_lockstep(row.estimator.boxed_clone(), SideBySide::default());
        self.panes.states.explained = 0;
        let unit = row.figures.first_missed_unit().unwrap_or(0);
        let place = Place { cursor: Cursor { unit, event: usize::MAX }, ..Place::default() };
        let job = self.run.document.job_at(place);
        self.start(job);
    }
}
