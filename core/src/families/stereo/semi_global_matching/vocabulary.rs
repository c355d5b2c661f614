//! The values and cases of semi-global matching.

use crate::methods::stereo::{WHOLE_PX, value as shared};
use crate::scene::{Role, Unit};
use crate::{cases, variables};

variables! { pub(super) mod value;
    /// The number of bits of a census string.
    BITS: "Census string", "", Unit::new("bits", 0);
    /// The lowest Hamming distance of the census strings.
    LEAST_DISTANCE: "Least Hamming distance", "", Unit::new("bits", 0), Role::Best;
    /// The side from which a path reaches the pixel.
    DIRECTION: "Direction", r"r", Unit::WHOLE;
    /// The penalty for a change of the disparity by 1 px.
    P1: "Penalty P1", "P_1", Unit::WHOLE;
    /// The penalty for a larger change of the disparity.
    P2: "Penalty P2", "P_2", Unit::WHOLE;
    /// The lowest matching cost of the pixel.
    MATCHING_COST: "Matching cost", "", Unit::WHOLE;
    /// The disparity of the lowest matching cost.
    MATCHING_BEST: "Its disparity", "", WHOLE_PX;
    /// The lowest path cost of the pixel.
    PATH_COST: "Path cost", "", Unit::WHOLE, Role::Best;
    /// The disparity of the lowest path cost.
    PATH_BEST: "Disparity of the path cost", "", WHOLE_PX, Role::Best;
    /// The disparity of the lowest path cost of the pixel before on the path.
    ARRIVAL: "Arrival", "", WHOLE_PX;
    /// The matching cost at the disparity of the lowest path cost.
    COST_HERE: "", "", Unit::WHOLE;
    /// The path cost of the pixel before at the same disparity.
    SAME: "", "", Unit::WHOLE;
    /// The lower of its path costs at the neighbouring disparities.
    BESIDE: "", "", Unit::WHOLE;
    /// The lowest of its path costs.
    LEAST_BEFORE: "", "m", Unit::WHOLE;
    /// The number of directions of paths.
    PATHS: "Paths", "", Unit::count("path cost");
}

cases! { pub(super) over value, shared;
    OPENING: "The cost of a single pixel is ambiguous; sums of costs along paths through the picture make neighbours agree.",
    COST: "{reference|Pixel} {pixel}: the census strings of the pixel and its match differ least, in {least_distance:bare} of \
           {bits} at d = {best:bare}. The window of 9×7 px is small, so the cost has many minima of nearly the same depth.",
    PATH_BEGINS: "{reference|Pixel} {pixel}, path {direction}: the path begins here, so the path cost is the matching cost.",
    PATH_ARRIVES: "{reference|Pixel} {pixel}, path {direction}: the path arrives with its minimum at d = {arrival:bare}, and \
                   changes of the disparity are penalised.",
    PATH_MINIMA: "The minimum of the matching cost is at d = {matching_best:bare}, that of the path cost at d = \
                  {path_best:bare}.",
    LOWEST_SUM: "{reference|Pixel} {pixel}: the sum of its {paths} is lowest, {minimum} at d = {best:bare}",
    AMBIGUOUS: ". Its rival, {rival_cost} at d = {rival:bare}, is less than {uniqueness} higher, so the match is ambiguous and \
                the pixel gets no disparity yet.",
    UNIQUE: ", and no rival comes near it: the disparity is unique.",
    BOTH_VIEWS: "{reference|Pixel} {pixel}: from the left view d = {best:bare}, from its match in the {second} d = {back:bare}.",
    CONFIRMED: "The left–right check confirms the disparity.",
    REJECTED: "The left–right check rejects the disparity.",
    OCCLUDED_OR_MISMATCHED: "The pixel is half-occluded, hidden from the other view, or mismatched.",
    KEPT: "{reference|Pixel} {pixel} passed all tests, so its disparity stays.",
    FILL_OCCLUDED: "{reference|Pixel} {pixel}: no pixel of the other view is matched with it, as where it is half-occluded. Then \
                    the background continues there, so it takes the second lowest of the nearest disparities in 8 directions,",
    FILL_AMBIGUOUS: "{reference|Pixel} {pixel}: its match is ambiguous. It takes the median of the nearest disparities in 8 \
                     directions,",
    FILL_WRONG: "{reference|Pixel} {pixel}: its match is wrong, as another pixel takes the same place. It takes the median of \
                 the nearest disparities in 8 directions,",
    FILLED: "{disparity}.",
    FILL_NONE: "of which there are none.",
}
