//! The values and cases of an iteration of a variational method.

use crate::methods::differential::explain::value as differential;
use crate::scene::{Role, Unit};
use crate::{cases, variables};

variables! { pub mod value;
    /// The number of the warp on its level.
    WARP: "", "", Unit::WHOLE;
    /// The number of warps per level.
    WARPS: "", "", Unit::WHOLE;
    /// The flow of the pixel before the iteration.
    FLOW_BEFORE: "Flow before", r"(u_\text{old}, v_\text{old})", Unit::SUBPIXEL, Role::Best;
    /// The flow of the pixel after the iteration.
    FLOW_AFTER: "", "(u, v)", Unit::SUBPIXEL, Role::Result;
    /// The flow of the pixel after the iteration, in px of level 0.
    FULL_RESOLUTION_FLOW: "At full resolution", "", Unit::SUBPIXEL, Role::Result;
    /// The weighted mean of the flow of the eight neighbours.
    NEIGHBOURHOOD_MEAN: "", r"(\bar{u}, \bar{v})", Unit::SUBPIXEL, Role::Predicted;
    /// The flow with the least energy while the neighbours stay, before any over-relaxation.
    UPDATE: "", r"(u_\text{GS}, v_\text{GS})", Unit::SUBPIXEL, Role::Result;
    /// The relaxation factor of SOR.
    RELAXATION: "", r"\omega", Unit::FINE;
    /// The squared regularisation weight.
    ALPHA_SQUARED: "", r"\alpha^2", Unit::FINE;
    /// The data term of the energy, per pixel.
    DATA_TERM: "Energy per pixel", "", Unit::FINE;
    /// The smoothness term of the energy, per pixel.
    SMOOTHNESS_TERM: "", "", Unit::FINE;
    /// The mean change below which the iterations of a warp end.
    TOLERANCE: "", "", Unit::new("px", 4);
    /// The kind of the formula at the end of the run.
    FORMULA: "", "", Unit::WHOLE;
}

cases! { pub over value, differential;
    UPSAMPLED: "The flow of the coarser level is upsampled to this level, and its vectors are scaled by the same factor.",
    MEDIANS: "A 3×3 median filter on u and v removes outliers, so that they do not enter the next linearisation.",
    WARP: "Level {level} ({width:bare}×{height}), warp {warp} of {warps}:",
    ZERO_FLOW: "the flow is still 0, so the derivatives are taken from both frames without warping.",
    WARPED: "frame t+1 is warped toward frame t by the current flow (u₀, v₀), and brightness constancy is linearised again. I_t is now \
             the residual that the current flow leaves.",
    MEAN: "Neighbourhood mean at {reference|pixel} {pixel}: {neighbourhood_mean}.",
    NEWEST_MEAN: "Neighbourhood mean of the newest values at {reference|pixel} {pixel}: {neighbourhood_mean}.",
    WEIGHTS: "It minimises the smoothness term: the four nearest neighbours weigh 1/6 each, the diagonal ones 1/12, and the image border \
              is replicated.",
    EXTRAPOLATED: "SOR extrapolates the Gauss–Seidel update by ω = {relaxation}: {reference|pixel} {pixel} goes from {flow_before:bare} \
                   beyond {update:bare} to {flow_after}. Smooth errors, which single updates hardly reduce, vanish in fewer iterations.",
    NOT_EXTRAPOLATED: "There is nothing to extrapolate for SOR: {reference|pixel} {pixel} has the Gauss–Seidel update {flow_after}.",
    ENERGY: "data term {data_term}, smoothness term {smoothness_term}",
    CONVERGED: "The mean change of {mean_change} is below the tolerance of {tolerance}: converged.",
    NEXT_ITERATION: "The mean change of {mean_change} is not below the tolerance of {tolerance}: next iteration.",
    LAST_ITERATION: "Mean change of iteration {iterations}, the last of this warp: {mean_change}.",
    NOT_CONVERGED: "Not converged: the last iteration still changed the flow by {mean_change} on average.",
    MORE_ITERATIONS: "More iterations carry it on from the gradients into areas without any.",
    FORMULA: "The formula is the {formula} of {reference|pixel} {pixel}.",
}
