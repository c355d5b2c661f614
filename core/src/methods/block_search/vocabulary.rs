//! The values that explain a block search, and the cases that all searches share.

use crate::scene::{Decimals, Role, Unit};

/// A displacement without its unit, as it stands in a sentence.
const PLACE: Unit = Unit { name: "", ..Unit::DISPLACEMENT };
/// A length in whole px.
const WHOLE_PX: Unit = Unit::new("px", 0);

/// The pseudocode lines that all searches have, and those of searches that reject or skip candidates early.
pub(crate) mod line {
    crate::line_names!(
        EACH_BLOCK,
        LAY_WINDOW,
        REFINE_BEST,
        SET_DISPLACEMENT,
        COMPUTE_COST,
        KEEP_BEST,
        EXIT_EARLY,
        SKIP_CANDIDATE
    );
}

crate::variables! { pub(crate) mod value;
    /// The level of the pyramid; the picture itself is level 0.
    LEVEL: "Level", "", Unit::WHOLE;
    /// The coarsest level of the pyramid.
    COARSEST: "Coarsest level", "", Unit::WHOLE;
    /// The number of blocks.
    BLOCKS: "", "", Unit::count("block");
    /// The number of the block, from 1.
    BLOCK: "Block", "", Unit::WHOLE, Role::Reference;
    /// The upper left corner of the block in frame t.
    CORNER: "", "", Unit::WHOLE;
    /// The width of the block, or of the level.
    WIDTH: "", "", Unit::WHOLE;
    /// The height of the block, or of the level.
    HEIGHT: "", "", Unit::WHOLE;
    /// The largest displacement along each axis.
    RANGE: "", "", WHOLE_PX;
    /// The number of columns of the search window.
    COLUMNS: "", "", Unit::WHOLE;
    /// The number of rows of the search window.
    ROWS: "", "", Unit::WHOLE;
    /// The number of candidates in the search window.
    CANDIDATES: "", "", Unit::count("candidate");
    /// The number of candidates tested.
    TESTED: "", "", Unit::count("tested candidate");
    /// The number of candidates tested at whole pixels.
    WHOLE_TESTED: "Tested", "", Unit::count("candidate");
    /// The number of candidates tested between pixels.
    BETWEEN: "", "", Unit::WHOLE;
    /// The number of candidates skipped by a lower bound.
    SKIPPED: "Skipped", "", Unit::count("candidate");
    /// The share of the candidates of the search window that were skipped.
    SHARE_SKIPPED: "", "", Unit::PERCENT;
    /// The name of the cost.
    LABEL: "", "", Unit::WHOLE;
    /// The name of the cost as it stands before a number.
    MEASURE: "", "", Unit::WHOLE;
    /// The displacement under test.
    CANDIDATE: "Candidate", "(u, v)", Unit::DISPLACEMENT, Role::Candidate;
    /// The cost of the candidate.
    COST: "", "c", Unit::WHOLE, Role::Candidate;
    /// A lower bound of the cost of the candidate.
    LOWER_BOUND: "", "", Unit::WHOLE, Role::Candidate;
    /// The lowest cost so far.
    MINIMUM: "", r"c_{\min}", Unit::WHOLE, Role::Best;
    /// The displacement with the lowest cost so far.
    BEST: "Best so far", "", Unit::DISPLACEMENT, Role::Best;
    /// The motion vector of the block.
    DISPLACEMENT: "Displacement", "(u, v)", Unit::DISPLACEMENT, Role::Result;
    /// The best displacement before this one.
    BEFORE: "", "", PLACE;
    /// The lowest cost before.
    COST_BEFORE: "", "", Unit::WHOLE;
    /// The whole displacement that a parabola has moved.
    TESTED_AT: "", "", PLACE;
    /// The number of rows summed for the candidate.
    ROWS_SUMMED: "", "", Unit::WHOLE;
    /// The number of rows summed for all candidates tested.
    SUMMED: "", "", Unit::WHOLE;
    /// The number of rows of all candidates tested.
    ALL_ROWS: "", "", Unit::WHOLE;
    /// The share of the rows that were summed.
    SHARE_SUMMED: "", "", Unit::WHOLE_PERCENT;
    /// The displacement of the global minimum.
    LEAST: "", "", PLACE;
    /// The global minimum of the cost in the search window.
    LEAST_COST: "", "", Unit::WHOLE;
    /// The displacements that cost as much as the match.
    TIES: "", "", PLACE;
    /// Other local minima that cost about as much as the match.
    OTHER_MINIMA: "", "", Unit::WHOLE;
    /// The mean difference per pixel, for squares the root mean square.
    MEAN_DIFFERENCE: "", "", Unit::GRAY;
    /// The median of the true flow over the block.
    TRUE_MOTION: "", "", Unit::DISPLACEMENT;
    /// The distance of the motion vector from the true motion.
    ENDPOINT_ERROR: "", "", Unit::PX;
    /// The whole displacement nearest to the true motion.
    TRUE_CANDIDATE: "", "", PLACE;
    /// The cost of the true displacement.
    TRUE_COST: "", "", Unit::WHOLE;
    /// The share of the block that is occluded in frame t+1.
    OCCLUDED: "", "", Unit::WHOLE_PERCENT;
    /// The peak signal-to-noise ratio of the motion-compensated prediction.
    PSNR: "", "", Unit::new("dB", 2);
    /// The peak signal-to-noise ratio of the prediction with zero motion vectors.
    PSNR_AT_ZERO: "", "", Unit::new("dB", 2);
    /// The number of candidates in the search windows of all blocks.
    ALL_CANDIDATES: "", "", Unit::count("candidate");
    /// The number of candidates skipped in all blocks.
    ALL_SKIPPED: "", "", Unit::WHOLE;
    /// The share of all candidates that were skipped.
    ALL_SHARE_SKIPPED: "", "", Unit::PERCENT;
    /// The number of the block with the highest cost.
    WORST_BLOCK: "", "", Unit::WHOLE;
    /// The cost of that block.
    WORST_COST: "", "", Unit::WHOLE;
    /// The number of candidates of a pattern.
    ASKED: "", "", Unit::WHOLE;
    /// The number of candidates of a pattern that are tested now.
    NEW: "", "", Unit::WHOLE;
    /// The axis of a parabola.
    AXIS: "", "", Unit::WHOLE;
    /// The cost one pixel before the best displacement.
    COST_LEFT: "", "", Unit::WHOLE;
    /// The cost at the best displacement.
    COST_AT: "", "", Unit::WHOLE;
    /// The cost one pixel behind the best displacement.
    COST_RIGHT: "", "", Unit::WHOLE;
    /// The best whole displacement along the axis.
    WHOLE: "", "", Unit::WHOLE;
    /// The minimum of the parabola, from the best whole displacement.
    OFFSET: "", "", Unit::PX;
    /// The displacement of the minimum of the parabola along the axis.
    FITTED: "", "", Unit::PX, Role::Best;
    /// The number of parts of a block; their sums give a lower bound.
    PARTS: "", "", Unit::WHOLE;
    /// The side of these parts.
    SIDE: "", "", Unit::WHOLE;
    /// The number of pixels of a part.
    PART_PIXELS: "", "n", Unit::WHOLE;
    /// The displacement along x.
    U: "", "u", PLACE;
    /// The displacement along y.
    V: "", "v", PLACE;
    /// The first pixel or part of the block.
    BLOCK_FIRST: "", "", Unit::WHOLE, Role::Reference;
    /// The first pixel or part of the candidate.
    CANDIDATE_FIRST: "", "", Unit::WHOLE, Role::Candidate;
    /// The second pixel or part of the block.
    BLOCK_SECOND: "", "", Unit::WHOLE, Role::Reference;
    /// The second pixel or part of the candidate.
    CANDIDATE_SECOND: "", "", Unit::WHOLE, Role::Candidate;
    /// The last pixel or part of the block.
    BLOCK_LAST: "", "", Unit::WHOLE, Role::Reference;
    /// The last pixel or part of the candidate.
    CANDIDATE_LAST: "", "", Unit::WHOLE, Role::Candidate;
    /// The pixel pointed at.
    POINTED: "", "", Unit::WHOLE;
    /// The gray level of that pixel in the block.
    BLOCK_POINTED: "", "", Unit::WHOLE, Role::Reference;
    /// That pixel of the candidate.
    CANDIDATE_POINTED: "", "", Unit::WHOLE, Role::Candidate;
    /// The term of that pixel in the sum.
    TERM: "", "", Unit::WHOLE;
    /// The sum of the terms of all parts, by which a skipped candidate is bounded.
    BOUND_SUM: "", "", Unit::WHOLE;
    /// The mean of the block.
    BLOCK_MEAN: "", "", Unit::FINE, Role::Reference;
    /// The mean of the candidate.
    CANDIDATE_MEAN: "", "", Unit::FINE, Role::Candidate;
    /// The variance of the block.
    BLOCK_VARIANCE: "", "", Unit::WHOLE, Role::Reference;
    /// The variance of the candidate.
    CANDIDATE_VARIANCE: "", "", Unit::WHOLE, Role::Candidate;
    /// The covariance of block and candidate.
    COVARIANCE: "", "", Unit::WHOLE;
    /// The first coefficients of the Hadamard transform of the difference.
    COEFFICIENTS: "", "", Unit::WHOLE;
    /// The sum of the squared differences.
    SQUARES: "", "", Unit::WHOLE;
    /// The number of pixels of the block.
    PIXELS: "", "N", Unit::WHOLE;
    /// The cost without the rate term.
    DISTORTION: "", "", Unit::WHOLE;
    /// The cost of a bit.
    LAMBDA: "", r"\lambda", Unit::SET;
    /// The bits of the difference from the predictor.
    BITS: "", "R", Unit::new("bits", 0);
    /// The displacement predicted from neighbouring blocks.
    PREDICTOR: "", "", PLACE, Role::Predicted;
    /// The cost at which the search decides.
    THRESHOLD: "", "", Unit::WHOLE;
    /// The centre of the pattern.
    CENTER: "", "", PLACE;
    /// The pattern of candidates.
    PATTERN: "", "", Unit::WHOLE;
    /// The number of candidates of the pattern, its centre included.
    PATTERN_SIZE: "", "", Unit::count("candidate");
    /// The distance of the candidates of the pattern from its centre.
    STEP: "", "", WHOLE_PX;
    /// The part of the search range that no step has covered yet.
    REST: "", "", WHOLE_PX;
    /// The number of the square, from 1.
    SQUARE: "", "", Unit::WHOLE;
    /// The largest number of squares.
    MOST_SQUARES: "", "", Unit::WHOLE;
    /// The upper left corner of the part of the search window that is left.
    FROM: "", "", PLACE;
    /// The lower right corner of the remaining window.
    TO: "", "", PLACE;
    /// The side of the quadrant.
    QUADRANT: "", "", WHOLE_PX;
    /// The side at which the search stops.
    MIN_WINDOW: "", "", WHOLE_PX;
    /// The decrease of the minimum in this iteration.
    DECREASE: "", "", Unit::PERCENT;
    /// The decrease below which the search stops.
    MIN_DECREASE: "", "", Unit { name: "%", decimals: Decimals::AtMost(4) };
    /// The motion vectors of the neighbouring blocks.
    NEIGHBOURS: "", "", PLACE;
    /// The lowest cost of a neighbouring block.
    NEIGHBOUR_COST: "", "", Unit::WHOLE;
    /// The threshold before it was adapted.
    FIXED_THRESHOLD: "", "", Unit::WHOLE;
    /// The motion vector of the block in the previous pair of frames.
    COLLOCATED: "", "", PLACE;
    /// The collocated vector, extrapolated by its last change.
    ACCELERATED: "", "", PLACE;
    /// Twice the motion vector of the nearest block on the coarser level.
    DOUBLED: "", "", PLACE;
    /// The largest correction of the doubled vectors.
    REFINEMENT_RANGE: "", "", WHOLE_PX;
    /// The motion vector in px of the picture.
    ON_PICTURE: "", "", Unit::DISPLACEMENT, Role::Result;
}

crate::cases! { pub(crate) over value;
    OPENING: "Frame t has {blocks} of {width}×{height} px. Each is matched in frame t+1.",
    LEVEL_OPENING: "Level {level} of frame t has {blocks} of {width}×{height} px. Each is matched in frame t+1.",
    WINDOW: "{reference|Block} {block}: {width}×{height} px at {corner} in frame t. Its {window|search window} of ±{range} in \
             frame t+1",
    CUT: ", cut at the picture border,",
    WINDOW_HOLDS: " holds {columns}×{rows} = {candidates}.",
    BLOCK_OF: "{block} of {blocks:bare}, at {corner}",
    TESTED_OF: "{whole_tested:bare} of {candidates:bare}",
    TESTED_WITH_BETWEEN: "{whole_tested:bare} of {candidates:bare}, {between} between pixels",
    SKIPPED_OF: "{skipped:bare} of {candidates}, {share_skipped}",
    CANDIDATE_COST: "{candidate}, {measure} {cost}",
    CANDIDATE_BOUND: "{candidate}, {label} ≥ {lower_bound}",
    BEST_COST: "{best}, {measure} {minimum}",
    DISPLACEMENT_COST: "{displacement}, {measure} {minimum}",
    FITTED_COST: "{displacement}, {measure} {minimum} at {tested_at}",
    COST_KNOWN: "Its cost is known already, or it lies outside the search window.",
    BOTH_KNOWN: "Both costs are known already, or outside the search window.",
    ALL_KNOWN: "All {asked} costs are known already, or outside the search window.",
    ONE_IS_NEW: "{new} of these {asked} is tested now;",
    SOME_ARE_NEW: "{new} of these {asked} are tested now;",
    ONE_KNOWN: "the cost of the other is known already, or it lies outside the search window.",
    OTHERS_KNOWN: "the costs of the others are known already, or they lie outside the search window.",
    FIRST: "Candidate {candidate:bare}: {measure} {cost}, the first cost of this block.",
    BELOW: "Candidate {candidate:bare}: {measure} {cost} is below the minimum so far, {minimum} at {best:bare}.",
    EQUAL: "Candidate {candidate:bare}: {measure} {cost} equals the minimum so far, {minimum} at {best:bare}.",
    KEPT_AS_SHORTER: "The earlier displacement is shorter, so it is kept.",
    KEPT_AS_FIRST: "The earlier displacement is equally short and comes first in raster order, so it is kept.",
    ABOVE: "Candidate {candidate:bare}: {measure} {cost} exceeds the minimum so far, {minimum} at {best:bare}: rejected.",
    EARLY_EXIT: "Candidate {candidate:bare}: {label} ≥ {lower_bound} after {rows_summed} of {height} rows exceeds the minimum so \
                 far, {minimum} at {best:bare}. Early exit: rejected.",
    SKIPPED_BY_WHOLE: "Candidate {candidate:bare}: {label} cannot be below {lower_bound}, by the sums of both blocks. The \
                       minimum so far is {minimum} at {best:bare}: skipped.",
    SKIPPED_BY_PARTS: "Candidate {candidate:bare}: {label} cannot be below {lower_bound}, by the sums of {parts} parts of \
                       {side}×{side} px. The minimum so far is {minimum} at {best:bare}: skipped.",
    NEW_AS_FIRST: "{measure} {minimum} at {best:bare} is the minimum so far, as the first candidate of this block.",
    NEW_AS_SHORTER: "{measure} {minimum} at {best:bare} equals the minimum so far at {before}, and the displacement is shorter: \
                     new minimum.",
    NEW_AS_EARLIER: "{measure} {minimum} at {best:bare} equals the minimum so far at {before}, and the displacement is equally \
                     short and comes first in raster order: new minimum.",
    NEW_AS_LOWER: "{measure} {minimum} at {best:bare} is below {cost_before} at {before}: new minimum.",
    HALF_PIXELS: "Sub-pixel refinement: the 8 half-pixel positions around {center} are tested on the interpolated frame.",
    QUARTER_PIXELS: "Sub-pixel refinement: the 8 quarter-pixel positions around {center} are tested on the interpolated frame.",
    FOR_PARABOLAS: "The parabolas need the costs of the 4 neighbours of {center}.",
    PARABOLA: "Along {axis} the parabola through {cost_left}, {cost_at} and {cost_right} has its minimum at {offset} from the \
               best match.",
    NO_MINIMUM: "Along {axis} the three costs are equal, so the parabola has no minimum.",
    NO_PARABOLA: "Along {axis} a neighbour lies outside the search window, so no parabola is fitted.",
    FOUND: "{reference|Block} {block}: motion vector {displacement}. {measure} {minimum}",
    FITTED: " at {tested_at}",
    MINIMUM_OF: " is the minimum of {tested}",
    SOME_BETWEEN: ", {between} between pixels",
    FULL_SEARCH: " (full search: {candidates:bare})",
    END: ".",
    SUMMED: "Early exit: {summed} of {all_rows} rows summed, {share_summed}.",
    SKIPPED: "Skipped by lower bounds: {skipped:bare} of {candidates}, {share_skipped}.",
    MISSED: "Full search finds {measure} {least_cost} at {least}: the global minimum is missed.",
    MISSED_BY_REFINEMENT: "The global minimum, {measure} {least_cost} at {least}, was not tested: refinement stays near the \
                           motion vectors of the coarser level.",
    LED_ELSEWHERE: "The coarser level led elsewhere, and an error of a coarser level stays. Smaller blocks or fewer levels avoid \
                    it.",
    MAY_HAVE_LED_ELSEWHERE: "The coarser level may have led elsewhere; smaller blocks or fewer levels would tell.",
    ALL_ALIKE: "All candidates cost the same: without texture the match is arbitrary, and the shortest displacement is taken.",
    TIE_BESIDE: "The cost is the same at the neighbouring {ties}.",
    TIE_BETWEEN: "The cost is the same at the neighbouring {ties}: the displacement may lie in between. Sub-pixel refinement \
                  resolves it.",
    TIE: "The cost is the same at {ties}",
    MINIMA_BESIDE_WHOLE: "Its whole displacement is the global minimum, but nearly the same cost is reached at other minima: \
                          {other_minima}",
    MINIMA: "It is the global minimum, but nearly the same cost is reached at other minima: {other_minima}",
    LOWER_MINIMA: "The search window has other minima, which cost less or nearly the same: {other_minima}",
    AMBIGUOUS: ": repeating texture, an edge or a flat area makes the match ambiguous. A larger block may resolve it.",
    AT_LIMIT: "It lies at the limit of the search range of ±{range}: a larger range may lower the cost.",
    EXACT: "The match is exact.",
    EXACT_BUT_OFFSET: "The match is exact up to an offset.",
    EXACT_BUT_GAIN: "The match is exact up to a gain and an offset.",
    MEAN_DIFFERENCE: "Mean absolute difference: {mean_difference}",
    ROOT_MEAN_SQUARE: "Root-mean-square difference: {mean_difference}",
    POOR: ", a poor match.",
    POSSIBLE_CAUSES: "Possible causes: occlusion, a change of brightness, or motion other than translation.",
    LOCAL_MINIMUM: "It may be a local minimum, since candidates were left out.",
    BESIDE_GLOBAL: "It lies at or beside the global minimum over all whole displacements of the search window. Between pixels \
                    only positions around that minimum were tested.",
    GLOBAL_MINIMUM: "It is the global minimum of the search window.",
    TRUTH: "True motion: {true_motion}; endpoint error {endpoint_error}.",
    BEYOND_RANGE: "The true motion lies beyond the search range of ±{range}, so it is no candidate: a larger range would contain \
                   it.",
    OUTSIDE_PICTURE: "Displaced by the true motion, the block leaves the picture: it is no candidate.",
    TRUE_DISPLACEMENT: "The true displacement",
    ROUNDED: ", rounded to {true_candidate},",
    NOT_TESTED: " costs less, {measure} {true_cost}, but was not tested.",
    COSTS_THE_SAME: " costs the same.",
    COSTS_MORE: " costs more, {measure} {true_cost}.",
    OCCLUDED: " costs more, {measure} {true_cost}; {occluded} of the block is occluded in frame t+1.",
    CONCLUSION: "All {blocks} are matched: PSNR of the motion-compensated prediction {psnr}, with zero motion vectors \
                 {psnr_at_zero}.",
    SKIPPED_IN_ALL: "Skipped by lower bounds in all blocks: {all_skipped} of {all_candidates}, {all_share_skipped}.",
    WORST: "Worst match: block {worst_block}, {measure} {worst_cost}.",
}
