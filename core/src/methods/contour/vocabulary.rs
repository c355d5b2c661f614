//! The values and the sentences of all contours.

use crate::methods::region::vocabulary::value as region;
use crate::scene::{Role, Unit};
use crate::{cases, variables};

/// An area.
pub(crate) const AREA: Unit = Unit::new("px²", 0);

variables! { pub(crate) mod value;
    /// The width of the window in which edges are found.
    WINDOW_WIDTH: "Width of the window", "", Unit::WHOLE;
    /// The height of the window.
    WINDOW_HEIGHT: "Height of the window", "", Unit::new("px", 0);
    /// The standard deviation of the Gaussian that smooths the frame.
    SIGMA: "Smoothing", r"\sigma", Unit::new("px", 1);
    /// The largest gradient magnitude in the window.
    STEEPEST: "Steepest gradient", "", Unit::new("gray levels/px", 2), Role::Measured;
    /// The number of points of the contour.
    POINTS: "Points", "", Unit::count("");
    /// The number of the iteration in the frame.
    ITERATION: "Iteration", "", Unit::WHOLE;
    /// The mean edge strength along the contour.
    EDGE_STRENGTH: "Mean edge strength", "f", Unit::RATIO, Role::Measured;
    /// The mean edge strength below which the object is lost.
    MIN_EDGE_STRENGTH: "Smallest edge strength", "", Unit::RATIO;
    /// The area inside the contour, negative where it has turned inside out.
    AREA: "Area", "", super::AREA;
    /// The size of that area.
    ENCLOSED: "Enclosed area", "", super::AREA;
    /// The area below which the contour has collapsed.
    LEAST_AREA: "Smallest area", "", super::AREA;
    /// The range of the gray levels in the window.
    GRAY_RANGE: "Range of gray levels", "", Unit::WHOLE;
    /// The smallest range of gray levels with which a contour can be fitted.
    LEAST_GRAY_RANGE: "Smallest range of gray levels", "", Unit::WHOLE;
}

cases! { pub(crate) over value, region;
    EDGES: "{measured|Edge strength f} in a window of {window_width}×{window_height} around the contour: the gradient magnitude after smoothing with \
            σ = {sigma}, as a share of the steepest, {steepest}.",
    WITHOUT_EDGES: "the gray levels in the window around it differ by {gray_range} at most, less than {least_gray_range}, and without an edge no force \
                    acts on the contour.",
    JUDGED: "The contour has a mean edge strength of {edge_strength} and encloses {enclosed}",
    CROSSES: ", but it crosses itself and has no inside: edges inside the object or in the background drew its points past each other.",
    INSIDE_OUT: ", but it has turned inside out.",
    COLLAPSED: ", less than {least_area}: it has collapsed.",
    OFF_EDGES: ". That is below {min_edge_strength}: on average its points do not lie on edges.",
    ACCEPTED: ". That is not below {min_edge_strength}: it lies on edges, and the fit is accepted.",
    LOST_CROSSED: ": the contour crosses itself",
    LOST_INSIDE_OUT: ": the contour has turned inside out",
    LOST_COLLAPSED: ": the contour has collapsed",
    LOST_OFF_EDGES: ": its points do not lie on edges",
    PATTERN: "Where a pattern has stronger edges than the outline, no weight helps; trackers of colours or texture follow patterned objects.",
    FOLLOWED: "The edges held the contour, because they moved less from frame to frame than their force reaches. It knows neither colour nor texture: a \
               stronger edge nearby would attract it.",
    HIDDEN: "The object was hidden in {hidden}, and a contour searches only where it was. A velocity is not predicted.",
    FOLDED: "Edges inside the object or in the background drew the points past each other, so the contour folded.",
    NOT_HELD: "No edge held the contour against its own elasticity, so it collapsed. A smaller α or a balloon pressure keeps it open.",
    SHRUNK: "The contour slipped onto edges inside the object.",
    GROWN: "The contour spread to edges of the background, which are stronger than the outline.",
    REGAINED: "The contour left the object and met it again: it finds only what comes back to it. A velocity is not predicted.",
    BESIDE: "A part of the contour lies on edges that are not the outline.",
    OUTRUN: "The object moved farther between two frames than its edges attract, or other edges were nearer.",
}
