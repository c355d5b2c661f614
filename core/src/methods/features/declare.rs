//! The pseudocode, the values and the cases that all corner detectors share.

use crate::scene::{Case, Name, Question, Reply, Role, Step, Unit};
use crate::{cases, variables};

/// The lines that all corner detectors share.
pub(super) mod line {
    crate::line_names!(TAKE_DERIVATIVES, RESPOND, EACH_STRONG, SUPPRESS, EACH_PEAK, DROP_NEAR, KEEP);
}

variables! { pub(crate) mod value;
    /// The inspected pixel.
    PIXEL: "Pixel", r"\mathbf{x}", Unit::WHOLE, Role::Reference;
    /// The entries of the structure tensor: the means of I_x², I_x I_y and I_y² over the window, with weights w of sum 1.
    TENSOR: "Σ w I_x², Σ w I_x I_y, Σ w I_y²", r"\mathbf{T}", Unit::RESPONSE;
    /// The larger eigenvalue of the structure tensor.
    LAMBDA_1: "Eigenvalue λ₁", r"\lambda_1", Unit::RESPONSE;
    /// The smaller eigenvalue of the structure tensor.
    LAMBDA_2: "Eigenvalue λ₂", r"\lambda_2", Unit::RESPONSE;
    /// The corner response.
    RESPONSE: "Response R", "R", Unit::RESPONSE, Role::Result;
    /// Below this eigenvalue, noise alone may be the gradient.
    FLAT_LIMIT: "", "", Unit::RESPONSE;
    /// The smallest response of a corner.
    THRESHOLD: "Threshold", "", Unit::RESPONSE;
    /// The fate of the pixel.
    STATUS: "Status", "", Unit::WHOLE;
    /// The threshold relative to the largest response (quality level).
    QUALITY: "", "", Unit { name: "%", ..Unit::SET };
    /// The largest response of the frame.
    LARGEST_RESPONSE: "", r"R_{\max}", Unit::RESPONSE;
    /// The current row.
    ROW: "Row", "y", Unit::WHOLE;
    /// The number of responses of the row that reach the threshold.
    RESPONSES: "", "", Unit::count("response");
    /// The neighbour that suppresses the pixel.
    NEIGHBOUR: "", "", Unit::WHOLE, Role::Best;
    /// The response of the neighbour or of the corner that rejects the pixel.
    OTHER_RESPONSE: "", "", Unit::RESPONSE;
    /// The number of local maxima.
    LOCAL_MAXIMA: "Local maxima", "", Unit::count("local maximum");
    /// The verb of a count.
    BE: "", "", Unit::WHOLE;
    /// The largest number of points.
    MAX_POINTS: "Maximum number of points", "", Unit::count("");
    /// The smallest distance between two points.
    MIN_DISTANCE: "", "", Unit::new("px", 0);
    /// The corner that rejects a local maximum.
    NEAR_CORNER: "", "", Unit::WHOLE, Role::Result;
    /// The number of corners kept so far.
    KEPT: "Kept so far", "", Unit::count("corner");
    /// The width of the picture.
    WIDTH: "Width", "", Unit::new("px", 0);
    /// The height of the picture.
    HEIGHT: "Height", "", Unit::new("px", 0);
    /// A position in the frame.
    POSITION: "Position", r"\mathbf{x}", Unit::PX, Role::Reference;
    /// The number of the current keypoint, from 1.
    KEYPOINT: "Keypoint", "", Unit::count("");
    /// The number of keypoints.
    KEYPOINTS: "Keypoints", "", Unit::count("keypoint");
    /// The orientation of the keypoint.
    ORIENTATION: "Orientation θ", r"\theta", Unit::new("°", 1), Role::Result;
    /// The largest response of a corner.
    FIRST_RESPONSE: "", "", Unit::RESPONSE;
    /// The smallest response of a corner.
    LAST_RESPONSE: "", "", Unit::RESPONSE;
}

cases! { pub(crate) over value;
    OPENING: "A corner has gradients in two directions, so it can be located and tracked without the aperture problem. The \
              eigenvalues λ₁ ≥ λ₂ of the structure tensor measure this: both large means corner, one large means edge, none \
              means flat.",
    EIGENVALUES: "{reference|Pixel} {pixel}: eigenvalues λ₁ = {lambda_1} and λ₂ = {lambda_2}.",
    FLAT: ": λ₁ is below {flat_limit}, as noise alone can cause: a flat area.",
    EDGE: ": gradients in one direction only, an edge.",
    CORNER: ": gradients in two directions, possibly a corner.",
    HAS_STATUS: "Status: {status}.",
    HAS_NEIGHBOUR: "Status: {status} by {neighbour}.",
    HAS_NEAR: "Status: {status} within {min_distance} of {near_corner}.",
    IS_BEYOND: "Status: {status}, not among the {max_points} strongest.",
    BORDER: "Row {row} is the image border: without all eight neighbours no pixel can be a local maximum.",
    ALL_BELOW: "Row {row}: no response reaches the threshold R = {threshold}, {quality} of the largest response \
                {largest_response}.",
    REACHED: "Row {row}: {responses} {be} at least the threshold R = {threshold}, {quality} of the largest response \
              {largest_response}. Non-maximum suppression follows.",
    MAXIMUM: "{best|Pixel} {pixel}: R = {response} reaches the threshold of {threshold} and no neighbour has a larger \
              response: a local maximum.",
    SUPPRESSED: "{rejected|Pixel} {pixel}: R = {response} reaches the threshold of {threshold}, but neighbour {neighbour}",
    BY_LARGER: "has the larger response {other_response}: suppressed.",
    BY_EQUAL: "has an equal response and comes first: suppressed.",
    NO_MAXIMA: "No response is a local maximum above the threshold, so there are no corners: the frame has no texture, or \
                only edges.",
    RANKED: "{local_maxima} {be} ranked by response. In this order at most {max_points} become corners (the maximum number of \
             points), each at least {min_distance} (the minimum distance) from those kept before.",
    TESTED: "Local maximum {pixel}, R = {response},",
    KEPT_AS: "has no stronger corner within the minimum distance: kept as corner {kept:bare}.",
    IS_NEAR: "is closer than the minimum distance ({min_distance}) to corner {near_corner}, which",
    TO_LARGER: "has the larger response {other_response}: rejected.",
    TO_EQUAL: "has an equal response and comes first: rejected.",
    END: "End of the run: {kept} from {local_maxima}, responses {first_response} to {last_response}.",
    END_WITH_ONE: "End of the run: {kept} from {local_maxima}, response {first_response}.",
    ALL_KEPT: "All local maxima are kept; a lower threshold finds weaker ones.",
    AT_MOST: "The maximum number of points is reached; a larger value keeps weaker ones.",
    APART: "A smaller minimum distance keeps more corners; a lower threshold also finds weaker ones.",
}

/// The fate of a pixel after its response was computed.
pub(crate) struct Status {
    /// The line that decided it.
    pub line: Name,
    /// The status in words.
    pub words: &'static str,
    /// Its sentence.
    pub case: &'static Case,
    /// The pixel that suppresses or rejects it.
    pub by: Option<(usize, usize)>,
}

impl Status {
    /// Tells the outcome for the pixel.
    pub fn say(&self, step: Step) -> Step {
        let put = |step: Step, by| step.put(value::NEIGHBOUR, by).put(value::NEAR_CORNER, by);
        self.by.into_iter().fold(step, put).say(self.case)
    }
}

/// The verb of a count.
pub(crate) fn be(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// The question of all detectors that select local maxima at a minimum distance.
pub(crate) const KEPT: Question = Question::choice(
    "kept",
    "Is the next local maximum kept?",
    &[
        Reply::at(line::KEEP, "Yes"),
        Reply::at(line::DROP_NEAR, "No: a stronger one is closer than the minimum distance"),
    ],
);

/// The questions of all of them.
pub(super) const QUESTIONS: &[Question] = &[
    Question::choice(
        "nature",
        "What does the structure tensor of the next pixel show?",
        &[
            Reply::told(line::RESPOND, case::CORNER, "A corner: gradients in two directions"),
            Reply::told(line::RESPOND, case::EDGE, "An edge: gradients in one direction"),
            Reply::told(line::RESPOND, case::FLAT, "A flat area"),
        ],
    ),
    Question::choice(
        "maximum",
        "Is the next response a local maximum?",
        &[
            Reply::told(line::SUPPRESS, case::SUPPRESSED, "No: suppressed"),
            Reply::told(line::SUPPRESS, case::MAXIMUM, "Yes"),
        ],
    ),
    KEPT,
];

/// The pseudocode of a corner detector; `response` is the line that defines the response R.
macro_rules! corner_pseudocode {
    ($response:literal) => {
        $crate::pseudocode! {
            TAKE_DERIVATIVES: "I_x, I_y ← derivatives of frame t",
            EACH_PIXEL: "for each pixel: T ← Σ w (I_x², I_x I_y; I_x I_y, I_y²) over the window around it, Σ w = 1",
            RESPOND: $response,
            EACH_STRONG: "for each pixel with R ≥ threshold · max R",
            SUPPRESS: "  suppress it unless R is the maximum of its 3×3 neighbourhood",
            EACH_PEAK: "for each local maximum, in order of decreasing R",
            DROP_NEAR: "  reject it if a corner was kept within min-distance",
            KEEP: "  else keep it as a corner, up to max-points",
        }
    };
}
pub(crate) use corner_pseudocode;
