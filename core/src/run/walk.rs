//! Walking through a run in both directions, whatever is run.

use super::{Cursor, Explained, Granularity, Info};
use crate::base::Error;
use crate::products::Output;
use crate::scene::{Focus, Name, Picture, Role, Scene, Step};

/// A direction in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Towards the start.
    Back,
    /// Towards the end.
    Forward,
}

/// A move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// To this cursor, or the nearest existing one: `event` beyond the unit's last means its end.
    To(Cursor),
    /// To the next or previous stop of a granularity of [`Info::granularities`]: an event for the innermost, the end of a
    /// unit for the one before it, the end of a level or of the whole run for those further out.
    Granularity(usize, Direction),
    /// To the end of the run.
    End,
}

/// A run that can be walked through in both directions: a type-erased [`Timeline`](crate::run::Timeline).
///
/// A move is requested with [`Walk::go`] and performed by [`Walk::work`], which returns when the time slice of the caller is over. Until
/// it is finished, everything shows the old cursor.
pub trait Walk: Send {
    /// The declaration of the estimator.
    fn info(&self) -> &'static Info;
    /// Whether its field has a confidence at the end of the run.
    fn tells_confidence(&self) -> bool {
        false
    }
    /// The frame that the run started on.
    fn frame(&self) -> usize;
    /// The first frame of the current unit's pair.
    fn at_frame(&self) -> usize {
        self.frame()
    }
    /// The position of the run.
    fn cursor(&self) -> Cursor;
    /// Number of events in the current unit.
    fn events(&self) -> usize;
    /// Number of units, if that is known by now.
    fn units(&self) -> Option<usize>;
    /// Number of units performed since the start of the walk; those performed again on the way to a step count again.
    fn advanced(&self) -> usize;
    /// Whether the cursor is at the end of the run.
    fn at_end(&self) -> bool;
    /// The position of the current unit on each granularity but the innermost.
    fn place(&self) -> Vec<Granularity>;
    /// Requests a move; it replaces an unfinished one.
    fn go(&mut self, to: Move);
    /// Works on the move while `more` returns true; returns whether it is finished.
    fn work(&mut self, more: &mut dyn FnMut() -> bool) -> bool;
    /// Units done and units needed by the unfinished move, if known.
    fn progress(&self) -> Option<(usize, usize)>;
    /// The error that ended the run early, if one did.
    fn failure(&self) -> Option<&Error>;
    /// Marked events of the current unit: their numbers and roles.
    fn landmarks(&self) -> Vec<(usize, Role)>;
    /// Whether nothing happens at the event before the cursor, so that stepping passes over it.
    fn is_idle(&self) -> bool {
        false
    }
    /// The unit with its result at `focus`.
    fn unit_at(&self, focus: Focus) -> Option<usize>;
    /// The first step at which the pixel at `focus` can be explained by itself, if there is one.
    fn explained(&self, _focus: Focus) -> Option<Explained> {
        None
    }
    /// The identity of the object at `focus`, where a click selects an object rather than a pixel.
    fn object_at(&self, _focus: Focus) -> Option<u32> {
        None
    }
    /// Where a selected object is at the cursor, or was last; `None` before it is there.
    fn place_of(&self, _object: u32) -> Option<[f32; 2]> {
        None
    }
    /// Whether pixels of `picture` can be pointed at.
    fn takes(&self, picture: Picture) -> bool {
        picture == Picture::CURRENT
    }
    /// The named stages of the events of the current unit, where the estimator names them.
    fn stages(&self) -> Vec<Name> {
        Vec::new()
    }
    /// The explanation at the cursor; `focus` is the pixel pointed at.
    fn step(&self, focus: Option<Focus>) -> Step;
    /// The explanation one event earlier, if that belongs to the same unit: it shows what has changed since.
    fn step_before(&self, _focus: Option<Focus>) -> Option<Step> {
        None
    }
    /// The scene at the cursor.
    fn scene(&self, focus: Option<Focus>) -> Scene;
    /// The products at the cursor, of all finished units.
    fn output(&self) -> Output;
    /// The products at the cursor as known in real time, if the parameters use later frames.
    fn causal(&self) -> Option<Output> {
        None
    }
    /// The numbers of the events of the current unit that test a candidate.
    fn evaluations(&self) -> Vec<usize>;
    /// Candidates that were tested up to the cursor.
    fn evaluated(&self) -> u64;
    /// The units that lead to the result of block `block`, the last of which finds it.
    fn way_to(&self, block: usize) -> Vec<usize>;

    /// The runs side by side, the leading one first; empty for a single run.
    fn beside(&self, _focus: Option<Focus>) -> Vec<Beside> {
        Vec::new()
    }

    /// Goes there and returns when it is done.
    fn jump(&mut self, to: Move) {
        self.jump_while(to, &|| true);
    }

    /// Goes there while `is_wanted`; returns whether it arrived. A move that is abandoned leaves the cursor where it was.
    fn jump_while(&mut self, to: Move, is_wanted: &dyn Fn() -> bool) -> bool {
        self.go(to);
        while is_wanted() {
            if self.work(&mut || is_wanted()) {
                return true;
            }
        }
        false
    }
}

/// One of the estimators side by side, at its position.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// The declaration of the estimator.
    pub info: &'static Info,
    /// Its name, distinct from the others, in full and short.
    pub names: [String; 2],
    /// The position of its own run.
    pub cursor: Cursor,
    /// Its step there. Readouts that refer to events of a single run refer to candidates of the current block here.
    pub step: Step,
    /// Its scene there.
    pub scene: Scene,
    /// Its products there.
    pub output: Output,
    /// The candidates that it tested, where these are counted.
    pub candidates: Option<CandidateCount>,
    /// Whether it waits for the others: it has finished this stop, or the run.
    pub is_done: bool,
}

/// The candidates that a block search has tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CandidateCount {
    /// For the current block.
    pub here: usize,
    /// Number of the unit that it is at, of those that lead to the block, from 1, and their total: several for coarse-to-fine searches.
    pub leg: (usize, usize),
    /// In the whole run so far.
    pub in_all: u64,
}
