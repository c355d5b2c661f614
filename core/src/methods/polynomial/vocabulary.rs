//! The values and cases of an iteration of Farnebäck's method.

use crate::methods::differential::explain::{GRADIENT_UNIT, value as differential};
use crate::scene::{Role, Unit};
use crate::{cases, variables};

/// A number of the normal equations.
const COEFFICIENT: Unit = Unit::new("(gray levels per px²)²", 4);

variables! { pub mod value;
    /// The displacement before the iteration.
    PRIOR: "Prior displacement", r"\mathbf{d}_0", Unit::SUBPIXEL, Role::Best;
    /// The displacement after the iteration.
    DISPLACEMENT: "Displacement", r"\mathbf{d}", Unit::SUBPIXEL, Role::Result;
    /// The change of the displacement in the iteration.
    INCREMENT: "", r"\mathbf{d} - \mathbf{d}_0", Unit::SUBPIXEL;
    /// The true displacement of the pixel.
    TRUE_DISPLACEMENT: "True displacement", "", Unit::SUBPIXEL, Role::Truth;
    /// The prior displacement, rounded to whole px.
    ROUNDED_PRIOR: "", "(m, n)", Unit::new("px", 0);
    /// The coefficients of 1, x, y, x², x y and y² of the polynomial of the pixel in frame t.
    FIT_1: "", "(c, b_x, b_y, a_{xx}, 2 a_{xy}, a_{yy})_1", Unit::FINE, Role::Reference;
    /// The same coefficients of the polynomial at the prior displacement in frame t+1.
    FIT_2: "", "(c, b_x, b_y, a_{xx}, 2 a_{xy}, a_{yy})_2", Unit::FINE, Role::Candidate;
    /// The linear term of the polynomial of the pixel in frame t: its gradient.
    B_1: "", r"\mathbf{b}_1", GRADIENT_UNIT, Role::Reference;
    /// The linear term of the polynomial at the prior displacement in frame t+1.
    B_2: "", r"\mathbf{b}_2", GRADIENT_UNIT, Role::Candidate;
    /// The entries a_xx, a_xy and a_yy of the mean of both quadratic terms.
    A: "", "(a_{xx}, a_{xy}, a_{yy})", Unit::new("gray levels per px²", 2), Role::Reference;
    /// The right-hand side of the displacement equations.
    DELTA_B: "", r"\Delta \mathbf{b}", GRADIENT_UNIT, Role::Candidate;
    /// The larger eigenvalue of the mean of A^TA over the window.
    LAMBDA_1: "", r"\lambda_1", COEFFICIENT;
    /// The smaller eigenvalue of the mean of A^TA over the window.
    LAMBDA_2: "", r"\lambda_2", COEFFICIENT;
    /// The weight of the prior displacement.
    DAMPING: "", r"\lambda", COEFFICIENT;
    /// The entries xx, xy and yy of the damped normal matrix of the window.
    NORMAL_MATRIX: "", r"\sum w \mathbf{A}^\top \mathbf{A} + \lambda \mathbf{I}", COEFFICIENT, Role::Reference;
    /// The right-hand side of the damped normal equations.
    RIGHT_SIDE: "", r"\sum w \mathbf{A}^\top \Delta \mathbf{b} + \lambda \mathbf{d}_0", Unit::new("gray levels²/px³", 4), Role::Candidate;
    /// The root mean squared residual of the displacement equations of the window.
    RESIDUAL: "RMS residual of A d − Δb", "", GRADIENT_UNIT;
}

cases! { pub over value, differential;
    EXPANDED: "Level {level} ({width:bare}×{height}): polynomial expansion fits x · A x + b · x + c to the Gaussian-weighted neighbourhood of \
               every pixel in both frames. At {reference|pixel} {pixel} the gradient is b₁ = {b_1}.",
    PRIOR: "Prior displacement of {reference|pixel} {pixel}: {prior}.",
    PAIRED: "Rounded to whole px, it selects the polynomial {rounded_prior} away in frame t+1.",
    OUTSIDE: "It leads out of frame t+1, so there is no second polynomial.",
    COMPARED: "A shift by d changes the gradient from b₁ to b₂ = b₁ − 2 A d. At {reference|pixel} {pixel} this gives the two equations \
               A d = Δb = {delta_b:bare}.",
    NO_EQUATION: "Without a second polynomial, {reference|pixel} {pixel} has no displacement equation and does not enter any window.",
    AVERAGED: "Where the image curves in one direction only, A is singular. Mean of A^TA over the window of {reference|pixel} {pixel}: \
               eigenvalues {lambda_1:bare} and {lambda_2:bare} against the damping λ = {damping:bare},",
    DETERMINED: "so the window determines both components.",
    DAMPED: "so the damping keeps the weakly determined component at its prior value.",
    SOLVED: "Damped least squares over the window of {reference|pixel} {pixel} gives (u, v) = {displacement}, an increment of {increment}. \
             RMS residual of A d − Δb: {residual}.",
}
