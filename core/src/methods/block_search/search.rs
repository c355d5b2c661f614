//! The trait of block searches, with their pseudocode and their questions.

use super::vocabulary::{case, line};
use super::{Event, HasSettings, Tester};
use crate::base::Observer;
use crate::params::Params;
use crate::run::{Guarantee, Info};
use crate::scene::{Question, Reply, Role};

/// A search for the displacement of one block. Everything else that makes it an [`Estimator`](crate::run::Estimator) is shared.
pub trait BlockSearch: Params + HasSettings + Default + Clone + Send + Sync + 'static {
    /// Its declaration.
    const INFO: Info;
    /// The motion it is guaranteed to find.
    const GUARANTEE: Guarantee = Guarantee::SmoothTranslation { off_px: 0 };

    /// Whether it uses the motion vectors of neighbouring blocks.
    fn predicts(&self) -> bool {
        false
    }

    /// Whether it uses the motion vectors of the two previous pairs of frames, which are then searched first.
    fn predicts_in_time(&self) -> bool {
        false
    }

    /// The sides in px of the square parts whose sums it compares, for all blocks of a pair; none for most searches.
    fn part_sides(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Searches the tester's block. The tested candidate of minimum cost is the result.
    fn search(&self, tester: &mut Tester<impl Observer<Event>>);
}

/// The questions of all searches: about the next candidate, and about the result of the block.
pub(crate) const QUESTIONS: &[Question] = &[
    Question::choice(
        "lower",
        "Does the next candidate lower the minimum of the block?",
        &[
            Reply::told(line::COMPUTE_COST, case::BELOW, "Yes: a new minimum"),
            Reply::told(line::COMPUTE_COST, case::ABOVE, "No"),
            Reply::told(line::COMPUTE_COST, case::EQUAL, "It equals the minimum"),
            Reply::at(line::EXIT_EARLY, "No"),
            Reply::at(line::SKIP_CANDIDATE, "No"),
        ],
    ),
    Question::place("match", "Where is the best match of the block in frame t+1?", line::SET_DISPLACEMENT, Role::Best),
];

/// The pseudocode of a search that tests displacements one by one: its own lines between the shared ones.
macro_rules! search_pseudocode {
    ($($name:ident: $text:literal),* $(,)?) => {
        $crate::pseudocode! {
            EACH_BLOCK: "for each block B of frame t",
            LAY_WINDOW: "  place the search window of ±search range around B in frame t+1",
            $($name: $text,)*
            REFINE_BEST: "  refine best to sub-pixel accuracy (if subpixel is set)",
            SET_DISPLACEMENT: "  motion vector of B ← best",
            TEST: "to test candidate (u, v), if it is new and inside the search window",
            COMPUTE_COST: "  c ← cost of B and the block of frame t+1 displaced by (u, v) [+ λR(u, v)]",
            COMPARE_COST: "  if c < minimum, or c = minimum and (u, v) is shorter than best",
            KEEP_BEST: "    minimum ← c; best ← (u, v)",
        }
    };
}
pub(crate) use search_pseudocode;
