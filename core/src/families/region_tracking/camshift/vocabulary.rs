//! The values and cases of CamShift.

use crate::methods::region::vocabulary::value as region;
use crate::scene::{Role, Unit};

/// A variance of positions.
const SQUARED_PX: Unit = Unit::new("px²", 1);

crate::variables! { pub(super) mod value;
    /// The share of the pixels with a hue of the object, in its box and around it, that lie in the object.
    OWN: "", "", Unit::WHOLE_PERCENT;
    /// The number of the shift.
    ITERATION: "Shift", "", Unit::WHOLE;
    /// The sum of the back-projection in the window.
    MASS: "Zeroth moment M₀₀", "M_{00}", Unit::new("", 1);
    /// The displacement of the centroid of the back-projection from the middle of the window.
    OFFSET: "", "", Unit::PX, Role::Best;
    /// The centroid of the back-projection in the window.
    CENTROID: "", "(x, y)", Unit::PX, Role::Best;
    /// The length of the shift.
    SHIFT_LENGTH: "", "", Unit::PX;
    /// The length of a shift below which the iteration has converged.
    EPSILON: "", r"\epsilon", Unit::PX;
    /// The largest number of shifts.
    ITERATIONS: "", "", Unit::count("shift");
    /// The width of the margin around the window.
    MARGIN: "", "", Unit::new("px", 0);
    /// The first axis of the ellipse of the moments.
    FIRST_AXIS: "First axis", "", Unit::PX, Role::Best;
    /// The second axis of the ellipse of the moments.
    SECOND_AXIS: "Second axis", "", Unit::PX, Role::Best;
    /// The angle of the first axis.
    AXIS_ANGLE: "Angle", r"\theta", Unit::new("°", 1), Role::Best;
    /// The variance of the back-projection along x.
    VARIANCE_X: "Variance along x", r"\sigma_{xx}", SQUARED_PX;
    /// The variance of the back-projection along y.
    VARIANCE_Y: "Variance along y", r"\sigma_{yy}", SQUARED_PX;
    /// The covariance of the back-projection along x and y.
    COVARIANCE: "Covariance", r"\sigma_{xy}", SQUARED_PX;
    /// The mean back-projection in the ellipse.
    PROJECTION: "", "", Unit::RATIO;
    /// The mean back-projection in the ellipse of the first frame.
    FIRST_PROJECTION: "", "", Unit::RATIO;
    /// The mean back-projection as a share of that in the first frame.
    SHARE: "", "", Unit::WHOLE_PERCENT;
    /// The area of the ellipse as a multiple of that in the first frame.
    TIMES: "", "", Unit::new("", 1);
}

crate::cases! { pub(super) over value, region;
    MODELLED: "The {reference|model q} is the {binning} histogram of the ellipse in the region: {filled} of {bins} bins are filled",
    NO_HUE: ". No pixel is saturated and bright enough to have a hue, so nothing can be found; lower the minimum saturation or value.",
    SCALED: ", and the fullest is scaled to 1.",
    WEIGHTED: ". Each is multiplied by the share of its pixels, in the object and around it, that lie in the object, and the fullest is \
               scaled to 1.",
    FEW_OWN: "Only {own} of the pixels with these hues lie in the object: its surroundings have them too, so the window may spread.",
    PROJECTED: "Back-projection: each pixel takes the value of its bin in the {reference|model q}, 1 for the commonest hue of the object. \
                The search starts in the last window, {width:bare}×{height}.",
    NO_MASS: "The zeroth moment is 0: no pixel of the window has a hue of the object, so the window stays.",
    SHIFTED: "The window has a zeroth moment of {mass}. Its centroid lies {offset} off the middle, a shift of {shift_length}:",
    CONVERGED: "shorter than ε = {epsilon}, converged.",
    EXHAUSTED: "the limit of {iterations} is reached.",
    NOT_CONVERGED: "not shorter than ε = {epsilon}, so the window moves and the moments are computed anew.",
    RESIZED: "The second moments in the window with its margin of {margin} give an ellipse of {first_axis:bare}{best|×}{second_axis} \
              turned by {axis_angle}. Its mean back-projection is {projection}, {first_projection} in the first frame:",
    FILLED_LARGER: "the hues of the object fill an ellipse of {times} times the area of that in the first frame. Unless the object has come \
                    nearer, it holds more than the object.",
    SCATTERED: "most pixels inside have another hue, so the window is spread over scattered pixels.",
    AT_BORDER: "the hue reaches to the border of the window, which will grow further.",
    PARTLY_FILLED: "a part of the ellipse has another hue. The window of the next frame is the box around it.",
    FILLED: "the hues of the object fill the ellipse. The window of the next frame is the box around it.",
    SPREAD: "The mean back-projection is {share} of that in the first frame: the window has spread over scattered pixels and no longer \
             shows where the object is.",
    LARGER: "The ellipse has {times} times the area of the first one: the object has come nearer, or the window has spread over a \
             background of like hue. The hue cannot tell these apart.",
    LOST_MODEL: ": the model has no hue",
    LOST_HUES: ": no pixel of the window has a hue of the object",
    EMPTY_MODEL: "The model is empty, because no pixel of the region is saturated and bright enough to have a hue. Lower the minimum \
                  saturation or value, or place the region on a coloured object.",
    FOLLOWED: "The hue of the object stood out. Every pixel with the hue counts, wherever it is, so on a background of like hue the window \
               would grow over it.",
    REGAINED: "The window left the object and met it again. CamShift predicts no velocity, so it finds only what comes back into the window.",
    GROWN: "The window spread over a background of like hue, because every pixel with the hue counts, wherever it is. Mean shift compares \
            shares of all colours, and a correlation filter knows the pattern.",
    SHRUNK: "The window shrank to the part of the object that has the hues of the model.",
    BESIDE: "The window holds a part of the object only: the moments follow all pixels with its hue, those of the background too.",
    HIDDEN: "The object was hidden in {hidden}, and the window has no velocity that carries it on, unlike the particles of a particle filter.",
    LOST: "Pixels of like hue beside the object, or an occlusion, took the window away, or the object left it between two frames. Fewer \
           colours of the background in the region, a higher minimum saturation, or mean shift with a background-weighted histogram help.",
}
