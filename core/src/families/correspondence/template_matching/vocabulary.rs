//! The values that explain template matching, and its cases.

use crate::scene::{Role, Unit};

/// A length in whole px.
const WHOLE_PX: Unit = Unit::new("px", 0);

crate::variables! { pub(super) mod value;
    /// The largest number of frames of the run.
    FRAMES: "", "", Unit::count("frame");
    /// The first pixel of the template.
    TEMPLATE: "Template", "", Unit::WHOLE, Role::Reference;
    /// The width of the template.
    WIDTH: "", "", Unit::WHOLE;
    /// The height of the template.
    HEIGHT: "", "", Unit::WHOLE;
    /// The frame that the template was cut from.
    FRAME: "", "", Unit::WHOLE;
    /// The second frame of the pair, in which the template is searched.
    NEXT_FRAME: "", "t + 1", Unit::WHOLE;
    /// The standard deviation of the gray levels of the template.
    DEVIATION: "Standard deviation", r"\sigma_T", Unit::GRAY;
    /// The smallest standard deviation of a template with texture.
    LEAST_DEVIATION: "", "", Unit::GRAY;
    /// The smaller eigenvalue of the structure tensor of the template.
    EIGENVALUE: "Smaller eigenvalue λ₂", r"\lambda_2", Unit::FINE;
    /// The width of the rectangle that was placed on the picture.
    PLACED_WIDTH: "", "", Unit::WHOLE;
    /// The height of the rectangle that was placed on the picture.
    PLACED_HEIGHT: "", "", Unit::WHOLE;
    /// The number of columns of the search area.
    COLUMNS: "", "", Unit::WHOLE, Role::Window;
    /// The number of rows of the search area.
    ROWS: "", "", Unit::WHOLE, Role::Window;
    /// The number of rows that are scored.
    ROW: "", "", Unit::WHOLE;
    /// The number of places of the search area.
    PLACES: "", "", Unit::WHOLE;
    /// The number of places that are scored.
    SCORED: "Places", "", Unit::WHOLE;
    /// The largest displacement along each axis.
    RANGE: "", "", WHOLE_PX;
    /// The number of products that direct sums take.
    PRODUCTS: "", "", Unit::WHOLE;
    /// The name of the score.
    MEASURE: "", "", Unit::WHOLE;
    /// The displacement under test.
    CANDIDATE: "Candidate", "", Unit::DISPLACEMENT, Role::Candidate;
    /// The score of the place with its numbers: the candidate, or the peak.
    SCORE: "", "s", Unit::WHOLE;
    /// The displacement with the best score so far.
    BEST: "Best so far", "", Unit::DISPLACEMENT, Role::Best;
    /// The best score so far.
    BEST_SCORE: "", "", Unit::WHOLE, Role::Best;
    /// The best score before the candidate.
    SCORE_BEFORE: "", "", Unit::WHOLE;
    /// The displacement with the best score of all places.
    PEAK: "Best", "", Unit::DISPLACEMENT, Role::Best;
    /// The displacement of the second-best peak.
    SECOND: "Second peak", "", Unit::DISPLACEMENT, Role::Rejected;
    /// The score of the second-best peak.
    SECOND_SCORE: "", "", Unit::WHOLE, Role::Rejected;
    /// The ratio of the best peak to the second.
    RATIO: "Peak ratio", "", Unit::FINE;
    /// The ratio from which on the best peak is distinct.
    DISTINCT: "", "", Unit::FINE;
    /// The zero-mean normalised cross-correlation of the template and the window at the peak.
    ZNCC: "ZNCC at the peak", "", Unit::RATIO;
    /// The smallest ZNCC of a match.
    MIN_ZNCC: "", "", Unit::RATIO;
    /// The vertices of the parabolas along x and y, from the peak.
    VERTEX: "", "", Unit::SUBPIXEL, Role::Best;
    /// The sub-pixel displacement of the template from its whole position.
    DISPLACEMENT: "Displacement", "", Unit::SUBPIXEL, Role::Result;
    /// The displacement of the tracked point from its sub-pixel position.
    TRACK_DISPLACEMENT: "", "", Unit::SUBPIXEL, Role::Result;
    /// The position of the tracked point in frame t+1.
    POSITION: "", "", Unit::SUBPIXEL;
    /// The frame of the first template.
    FIRST_FRAME: "", "", Unit::WHOLE;
    /// The position at which the first template fits best, from the match.
    OFFSET: "", "", Unit::SUBPIXEL, Role::Error;
    /// The distance of the match from the position at which the first template fits best.
    DRIFT: "", "", Unit::SUBPIXEL;
    /// The largest drift along x and y that is measured.
    DRIFT_LIMIT: "", "", WHOLE_PX;
    /// The number of templates that followed the first.
    UPDATES: "", "", Unit::count("update");
    /// The number of pairs through which the template was tracked.
    TRACKED: "", "", Unit::WHOLE;
    /// The number of pairs of the run.
    PAIRS: "", "", Unit::count("pair");
    /// The lowest ZNCC of all matches.
    LOWEST_ZNCC: "", "", Unit::RATIO;
    /// The frame of the lowest ZNCC.
    LOWEST_FRAME: "", "", Unit::WHOLE;
    /// The number of pairs with a peak at the limit of the search area.
    PAIRS_AT_LIMIT: "", "", Unit::count("pair");
    /// The distance of the tracked point from its true position.
    POSITION_ERROR: "", "", Unit::SUBPIXEL;
    /// The number of pixels of the template.
    PIXELS: "", "N", Unit::WHOLE;
    /// The mean absolute difference of template and window.
    MEAN_DIFFERENCE: "", "", Unit::GRAY;
    /// The sum of the squared gray levels of the template.
    TEMPLATE_SQUARES: "", "", Unit::WHOLE;
    /// The sum of the squared gray levels of the window.
    WINDOW_SQUARES: "", "", Unit::WHOLE;
    /// The sum of the products of the gray levels of template and window.
    PRODUCT: "", "", Unit::WHOLE;
    /// The mean of the template.
    TEMPLATE_MEAN: "", r"\bar{T}", Unit::GRAY;
    /// The mean of the window.
    WINDOW_MEAN: "", r"\bar{I}", Unit::GRAY;
    /// The standard deviation of the window.
    WINDOW_SIGMA: "", r"\sigma_I", Unit::GRAY;
    /// The covariance of template and window.
    COVARIANCE: "", "", Unit::SQUARED_GRAY;
    /// The name of the cost that is minimised.
    COST_NAME: "", "", Unit::WHOLE;
    /// The cost one pixel before the peak.
    COST_BEFORE: "", "", Unit::WHOLE;
    /// The cost at the peak.
    COST_AT: "", "", Unit::WHOLE;
    /// The cost one pixel behind the peak.
    COST_BEHIND: "", "", Unit::WHOLE;
    /// The vertex of the parabola along an axis, from the peak.
    FRACTION: "", "", Unit::SUBPIXEL, Role::Best;
}

crate::cases! { pub(super) over value;
    OPENING: "Template matching slides a template over a search area of each next frame and scores every window with {measure}, \
              through at most {frames}.",
    CLIPPED: "The rectangle of {placed_width}×{placed_height} px reaches outside the picture, so the template is clipped to \
              {width}×{height} px.",
    TEMPLATE_OF: "{reference|Template} of {width}×{height} px at {template} in frame {frame},",
    TEXTURED: "chosen automatically: the smaller eigenvalue λ₂ = {eigenvalue} of its structure tensor is the largest of all blocks \
               near the middle, so it differs from its surroundings in all directions.",
    WITHOUT_TEXTURE: "chosen automatically: the picture has no texture near its middle.",
    WITHOUT_CORNERS: "chosen automatically: the picture has no block with texture in all directions near its middle.",
    BEST_BLOCK: "The structure tensor of the best block there has the smaller eigenvalue λ₂ = {eigenvalue}.",
    PLACED: "cut from the first frame of the run at the place given.",
    FLAT: "Its standard deviation of {deviation} is below {least_deviation:bare}: without texture every window fits alike, and the \
           run ends. Place the template on an object with corners.",
    SIZE_AT: "{width}×{height} px at {template}",
    SCORED_OF: "{scored} of {places}",
    CANDIDATE_SCORE: "{candidate}, {measure} {score}",
    BEST_SCORE: "{best}, {measure} {best_score}",
    PEAK_SCORE: "{peak}, {measure} {score}",
    SECOND_SCORE: "{second}, {measure} {second_score}",
    AREA: "In frame {next_frame} the template is tried at {columns} × {rows} {window|places} up to {range} from its position \
           {template}, where it stays inside the frame.",
    DIRECT: "Direct sums take {products} products.",
    FOURIER: "Direct sums would take {products} products; products of spectra, by the fast Fourier transform, give the same scores \
              with less effort.",
    CANDIDATE: "Displacement {candidate}: {measure} {score},",
    FIRST: "the first place and so the best so far.",
    ABOVE: "above",
    BELOW: "below",
    NEW_BEST: "the best so far, {score_before}: {best|the new best}.",
    NOT_ABOVE: "not above",
    NOT_BELOW: "not below",
    NOT_BEST: "the best so far, {best_score} at {best}.",
    ROW_ENDS: "The row ends: {row} of {rows} rows are scored.",
    HIGHEST: "The highest",
    LOWEST: "The lowest",
    PEAK: "score of all {places} places is {measure} {score} at displacement {peak}.",
    AT_LIMIT: "It lies at the limit of the search area, and a better one may lie beyond: a larger search range shows it.",
    NO_PARABOLA: "The peak lies at the border of the search area along x and y, so no parabola fits: the position stays whole.",
    REFINED: "Parabolas through the peak and its neighbours have their vertices at {vertex} from it: the displacement is \
              {displacement}.",
    NO_SECOND: "There is no second peak: the score falls from the best place to all sides, so the match is distinct.",
    SECOND: "Second-best peak: {measure} {second_score} at {second}.",
    AMBIGUOUS: "Its ratio to the best, {ratio}, is below {distinct}: the match is ambiguous, as on texture that repeats. A larger \
                template would help.",
    IS_DISTINCT: "The best peak is {ratio} times as good, at least {distinct}: the match is distinct.",
    ALONE_POSITIVE: "No positive correlation stands beside the best, so the match is distinct.",
    BOTH_EXACT: "Both costs are 0, so their ratio is undefined: two places fit exactly, and the match is ambiguous, as on texture \
                 that repeats.",
    ALONE_EXACT: "The best fits exactly, with a cost of 0, so the match is distinct.",
    LOST: "ZNCC at the peak: {zncc}, below the minimum of {min_zncc}. The template is {rejected|lost}: it is occluded, has left the \
           search area, or has changed.",
    ACCEPTED: "ZNCC at the peak: {zncc}, not below the minimum of {min_zncc}. The template moves by {track_displacement} to \
               {position:bare}.",
    DRIFTED: "The template of frame {first_frame} fits best at an offset of {offset} from there: a drift of {drift} after {updates}.",
    DRIFTED_FAR: "The template of frame {first_frame} fits best at an offset of {offset} from there, at the border of its search of \
                  ±{drift_limit}: after {updates} the drift is at least {drift_limit}, or the first template fits nowhere near.",
    UPDATED: "The window at the match becomes the template of frame {next_frame}. It follows changes of appearance, but the error of \
              this match stays in it.",
    CONCLUSION: "End of the run: tracked through {tracked} of {pairs}, lowest ZNCC {lowest_zncc} in frame {lowest_frame}.",
    LIMITED: "Warning: in {pairs_at_limit} the peak lies at the limit of the search area (±{range}), so the true displacement may \
              be larger.",
    FINAL_ERROR: "The final distance from the true position is {position_error}.",
    FINAL_DRIFT: "The final drift from the first template is {drift}.",
    FINAL_DRIFT_FAR: "The final drift from the first template is at least {drift_limit}.",
    ADVISE_LOST: "A larger search range helps if the motion is large, updates if the appearance changes.",
    ADVISE_LOST_UPDATED: "A larger search range helps if the motion is large; an occluded template cannot be kept.",
    ADVISE_FIXED: "A fixed template does not drift; updates would let it follow changes of appearance.",
    ADVISE_UPDATED: "A fixed template would not drift if the appearance stays the same.",
}
