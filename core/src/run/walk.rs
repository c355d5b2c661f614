//! Walking through a run in both directions, whatever is run.

use super::{Cursor, Explained, Granularity, Info};
use crate::base::Error;
use crate::products::Output;
use crate::scene::{Focus, Picture, Role, Scene, Step};

/// A direction in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Towards the start.
    Back,
    /// Towards the end.
    Forward,
}

/// Where to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// To this cursor, or the nearest there is: `event` beyond the unit's last means its end.
    To(Cursor),
    /// To the next or previous stop of a granularity of [`Info::granularities`]: an event for the innermost, the end of a
    /// unit for the one before it, the end of a level or of the whole run for those further out.
    Granularity(usize, Direction),
    /// To the end of the run.
    End,
}

/// A run that can be walked through in both directions: a [`Timeline`](crate::run::Timeline) of which only the declaration matters.
///
/// A move is asked for with [`Walk::go`] and done by [`Walk::work`], which returns when the caller says
/// that its slice of time is over. Until it is finished everything shows the old cursor.
pub trait Walk: Send {
    /// What there is to say about the estimator.
    fn info(&self) -> &'static Info;
    /// Whether the end of the run tells how far its field is trusted.
    fn tells_confidence(&self) -> bool {
        false
    }
    /// The frame that the run started on.
    fn frame(&self) -> usize;
    /// The first frame of the pair that the unit at hand works on.
    fn at_frame(&self) -> usize {
        self.frame()
    }
    /// Where the run stands.
    fn cursor(&self) -> Cursor;
    /// Number of events in the unit at hand.
    fn events(&self) -> usize;
    /// Number of units, if that is known by now.
    fn units(&self) -> Option<usize>;
    /// Whether the cursor is at the end of the run.
    fn at_end(&self) -> bool;
    /// Where the unit at hand stands on each granularity but the innermost.
    fn place(&self) -> Vec<Granularity>;
    /// Asks for a move; it replaces one that is not finished.
    fn go(&mut self, to: Move);
    /// Works on the move while `more` says so; gives whether it is finished.
    fn work(&mut self, more: &mut dyn FnMut() -> bool) -> bool;
    /// Units done of those that the unfinished move needs, where that can be told.
    fn progress(&self) -> Option<(usize, usize)>;
    /// The error that ended the run early, if one did.
    fn failure(&self) -> Option<&Error>;
    /// Events of the unit at hand worth a mark: how many were seen by then, and their role.
    fn landmarks(&self) -> Vec<(usize, Role)>;
    /// The unit whose result lies at `focus`.
    fn unit_at(&self, focus: Focus) -> Option<usize>;
    /// From when on the pixel at `focus` can be explained by itself, if it can.
    fn explained(&self, _focus: Focus) -> Option<Explained> {
        None
    }
    /// Whether pixels of `picture` can be pointed at.
    fn takes(&self, picture: Picture) -> bool {
        picture == Picture::CURRENT
    }
    /// What the cursor tells; `focus` is the pixel that the person points at.
    fn step(&self, focus: Option<Focus>) -> Step;
    /// What the cursor shows.
    fn scene(&self, focus: Option<Focus>) -> Scene;
    /// What the run amounts to at the cursor: all units whose events were all seen.
    fn output(&self) -> Output;
    /// Events of the unit at hand at which a candidate was tested: how many were seen by then.
    fn evaluations(&self) -> Vec<usize>;
    /// Candidates that were tested up to the cursor.
    fn evaluated(&self) -> u64;
    /// The units that lead to the result of block `block`, the last one being that which finds it.
    fn way_to(&self, block: usize) -> Vec<usize>;

    /// The runs that stand side by side, the first leading; none where there is but one.
    fn beside(&self, _focus: Option<Focus>) -> Vec<Beside> {
        Vec::new()
    }

    /// Goes there and returns when it is done.
    fn jump(&mut self, to: Move) {
        self.go(to);
        while !self.work(&mut || true) {}
    }
}

/// One of the estimators that stand beside each other, where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// What there is to say about the estimator.
    pub info: &'static Info,
    /// Where its own run stands.
    pub cursor: Cursor,
    /// What it tells there; its readouts name the candidates of the block at hand where alone they name its events.
    pub step: Step,
    /// What it shows there.
    pub scene: Scene,
    /// What its run amounts to there.
    pub output: Output,
    /// Candidates that it tested for the block at hand.
    pub candidates: usize,
    /// Which of the units that lead to the block it is at, from 1, and how many there are: more than one where levels
    /// are gone through.
    pub leg: (usize, usize),
    /// Candidates that its run has tested in all, to get there.
    pub candidates_in_all: u64,
    /// Whether nothing is left to do for it: for this block, or in all where the budget counts.
    pub is_done: bool,
}
