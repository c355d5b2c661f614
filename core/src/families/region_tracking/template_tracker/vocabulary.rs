//! The values and cases of the template tracker.

use crate::methods::region::vocabulary::value as region;
use crate::scene::{Role, Unit};

crate::variables! { pub(super) mod value;
    /// The number of parameters of the warp.
    PARAMETERS: "", "", Unit::count("parameter");
    /// The number of pyramid levels.
    LEVELS: "", "", Unit::count("pyramid level");
    /// The width of the template.
    TEMPLATE_WIDTH: "", "", Unit::new("px", 0), Role::Reference;
    /// The height of the template.
    TEMPLATE_HEIGHT: "", "", Unit::new("px", 0), Role::Reference;
    /// The width and the height of the template.
    TEMPLATE: "Template", "", Unit::new("px", 0), Role::Reference;
    /// The level of the pyramid; 0 is full resolution.
    LEVEL: "Level", "", Unit::WHOLE;
    /// The number of the iteration on its level.
    ITERATION: "Iteration", "", Unit::WHOLE;
    /// The largest number of iterations on a level.
    ITERATIONS: "", "", Unit::count("iteration");
    /// The root mean square difference of the template and the warped frame.
    RMS: "Error (RMS)", "", Unit::GRAY, Role::Error;
    /// The farthest motion of a corner by the increment.
    CORNER_MOTION: "Largest corner motion", "", Unit::SUBPIXEL, Role::Estimate;
    /// The farthest motion of a corner with which the iterations have converged.
    EPSILON: "", r"\epsilon", Unit::SUBPIXEL;
    /// The share of the template inside the frame.
    INSIDE: "Template inside the frame", "", Unit::PERCENT;
    /// The smallest share of the template inside the frame.
    MIN_INSIDE: "", "", Unit::PERCENT;
    /// The correlation of the warped window with the template.
    CORRELATION: "Correlation with the template", r"\rho", Unit::RATIO, Role::Measured;
    /// The correlation below which the object is lost.
    MIN_CORRELATION: "", "", Unit::RATIO;
    /// The smallest factor by which the warp changes lengths.
    SMALLEST: "", "", Unit::RATIO, Role::Error;
    /// The largest factor by which the warp changes lengths.
    LARGEST: "", "", Unit::RATIO, Role::Error;
    /// The smallest factor that an object may have.
    MIN_STRETCH: "", "", Unit::RATIO;
    /// The largest factor that an object may have.
    MAX_STRETCH: "", "", Unit::RATIO;
    /// The largest ratio of the factors of two directions.
    MAX_RATIO: "", "", Unit::RATIO;
    /// The farthest motion of a corner by the drift correction.
    DRIFT: "Drift", "", Unit::SUBPIXEL, Role::Error;
    /// The largest motion of a corner that is a drift.
    MAX_DRIFT: "", "", Unit::PX;
    /// The first frame of the loss.
    LOSS_FRAME: "", "", Unit::WHOLE;
    /// The share of the object that was visible there.
    VISIBLE: "", "", Unit::PERCENT;
    /// The motion of the object to that frame.
    LOSS_MOTION: "", "", Unit::PX;
}

crate::cases! { pub(super) over value, region;
    SINGULAR_TEMPLATE: "the Hessian of its pixels is singular, so their texture does not determine {parameters} of the warp.",
    SIZE: "{template_width:bare}×{template_height}",
    LEARNED: "{reference|The template T₁} of {template_width:bare}{reference|×}{template_height} on {levels}, with the steepest-descent \
              images of its {parameters}. They belong to the template, so they are computed once for all iterations. The Hessian is \
              invertible: the texture determines the warp.",
    UPDATED: "The warped window becomes the template of the next frame. It follows changes of appearance, but it keeps the error of the \
              warp too: over many frames, errors add up to drift.",
    UPDATED_CORRECTED: "The window at the corrected warp becomes the template of the next frame: changes of appearance are followed without \
                        drift.",
    CORRECTING: "Drift correction, iteration {iteration}: under the warp, the first template T₁ and frame t have an RMS difference of {rms}.",
    COMPARED: "Iteration {iteration} on level {level}: warping frame t toward the template leaves an RMS difference of {rms}.",
    NOT_CONVERGED: "Solving H Δp = b moves a corner by {corner_motion}, more than ε = {epsilon}: another iteration.",
    CONVERGED: "Solving H Δp = b moves the corners by at most {corner_motion} ≤ ε = {epsilon}: converged.",
    EXHAUSTED: "Solving H Δp = b still moves a corner by {corner_motion}, but this is the maximum of {iterations}.",
    UNDONE: "The error no longer falls: {rejected|the last update is undone}.",
    DIVERGED: "Only {inside} of the template lies inside the frame, less than {min_inside}: the alignment has {rejected|diverged}.",
    SINGULAR: "The pixels inside have a {rejected|singular Hessian}: they determine no increment.",
    OUTSIDE: "Only {inside} of the template lies inside the frame, less than {min_inside}: the object has left it.",
    STRETCHED: "Since the last frame with the object, the warp changes lengths by factors between {smallest} and {largest},",
    BEYOND: "beyond {min_stretch} to {max_stretch}",
    UNEQUAL: "which differ by more than a factor of {max_ratio}",
    FAILED: ": the alignment has failed, with ρ = {correlation}. The warp is discarded.",
    CORRELATED: "The warped window has a correlation with its template of {measured|ρ} = {correlation},",
    REJECTED: "below {min_correlation}: this is not the object, or not all of it. The warp is discarded, and the template stays.",
    ACCEPTED: "not below {min_correlation}: the alignment is accepted.",
    REALIGNED: "From the warp of the template, the alignment with the first template T₁ moves the corners by at most {drift},",
    CORRECTED: "not more than {max_drift}. This is the drift of the frame, and it is removed.",
    NOT_CORRECTED: "more than {max_drift}: it has failed, since drift is slow. Warp and template stay as they are.",
    LOST_OUTSIDE: ": too little of the template lies inside the frame",
    LOST_WARP: ": the alignment has failed, since its warp changes a length too much",
    LOST_CORRELATION: ": the correlation is too low",
    FOLLOWED: "The first template fits the object in all frames, so nothing drifts. A change of its appearance would not be followed.",
    FOLLOWED_UPDATED: "Each frame gave the next template, so changes of appearance were followed. The errors of all frames add up to drift, \
                       which the correlation with the present template does not show.",
    FOLLOWED_CORRECTED: "The template followed changes of appearance, and the first one took out the drift wherever both agreed.",
    DRIFTED: "No frame had a low correlation, because the template of each was the window of the last: the errors added up to drift. The \
              drift correction removes it.",
    MISFITTED: "No frame had a low correlation: the warp fitted a part of the object or its surroundings. A smaller group of warps, or a \
                higher minimum correlation, keeps the template from that.",
    UNKNOWN_CAUSE: "Without the true box at the start of the loss its cause is not known: cover, a motion farther than the iterations \
                    converge and a change of appearance all lower the correlation.",
    LEAVING: "The loss begins in frame {loss_frame}, where {visible} of the object was still in the picture: it was leaving.",
    COVERED: "The loss begins in frame {loss_frame}, where {visible} of the object was visible: it was covered. No velocity is predicted, \
              so the template searches where the object was last seen.",
    FAR: "The loss begins in frame {loss_frame}, where the object was in full view but had moved by {loss_motion}: farther than the \
          iterations converge. Mean shift or a particle filter with more process noise reaches farther.",
    CHANGED: "The loss begins in frame {loss_frame}, where nothing covered the object and it had moved by only {loss_motion}: a rotation, a \
              change of light, blur or another change of its appearance lowered the correlation. A colour histogram, as in mean shift, \
              changes less.",
}
