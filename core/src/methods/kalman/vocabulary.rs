//! The values of a Kalman filter, and the outcomes of its consistency test, which all trackers that have one share.

use crate::scene::{Decimals, Role, Unit};

/// A gate probability in percent, as it was set.
pub const PROBABILITY: Unit = Unit { name: "%", decimals: Decimals::AtMost(4) };

crate::variables! { pub mod value;
    /// The number of the frame.
    FRAME: "Frame", "t", Unit::WHOLE;
    /// The estimated position.
    POSITION: "Position", r"(x, y)", Unit::PX, Role::Estimate;
    /// The estimated position before the step.
    POSITION_BEFORE: "Position before", r"(x, y)", Unit::PX;
    /// The estimated velocity.
    VELOCITY: "Velocity", r"(u, v)", Unit::SPEED;
    /// The estimated velocity before the step.
    VELOCITY_BEFORE: "Velocity before", r"(u, v)", Unit::SPEED;
    /// The magnitude of the estimated velocity.
    SPEED: "Speed", r"\sqrt{u^2 + v^2}", Unit::SPEED;
    /// The angle by which the velocity turns in a frame, clockwise in the picture where it is positive.
    TURN_RATE: "Turn rate", r"\omega", Unit::new("°/frame", 2);
    /// The standard deviations of the position along x and y: the roots of the first two diagonal entries of P.
    DEVIATIONS: "Standard deviations σ", r"(\sigma_x, \sigma_y)", Unit::PX;
    /// The standard deviation of the position: the root of the mean variance along x and y.
    DEVIATION: "Standard deviation", r"\sigma", Unit::PX;
    /// The standard deviation of the position before the step.
    DEVIATION_BEFORE: "Standard deviation before", r"\sigma", Unit::PX;
    /// The measured position.
    MEASUREMENT: "Measurement", r"\mathbf{z}", Unit::PX, Role::Measured;
    /// The standard deviation of a measured position along each axis: the root of the diagonal of R.
    MEASUREMENT_NOISE: "Measurement noise σ", r"\sqrt{R}", Unit::PX;
    /// The innovation: the difference of the measurement and the predicted measurement.
    INNOVATION: "Innovation", r"\mathbf{\nu}", Unit::PX, Role::Best;
    /// The innovation covariance: the uncertainty of the predicted measurement and that of the measurement together.
    INNOVATION_COVARIANCE: "Innovation covariance", r"\mathbf{S}", Unit::new("px²", 2);
    /// The squared Mahalanobis distance of the innovation, which is the normalised innovation squared (NIS).
    SQUARED_DISTANCE: "NIS", "d^2", Unit::FINE, Role::Measured;
    /// The gating threshold of the squared Mahalanobis distance.
    GATE: "Gate", r"\gamma", Unit::FINE;
    /// The share of the true measurements inside the gate.
    GATE_PROBABILITY: "Gate probability", "", PROBABILITY;
    /// The number of components of a measurement: the degrees of freedom of the χ² distribution of d².
    DIMENSION: "Degrees of freedom", "", Unit::WHOLE;
    /// The entry of the Kalman gain K from the innovation along x to the position along x.
    GAIN: "Kalman gain", "K_{xx}", Unit::RATIO;
    /// The true position.
    TRUTH: "Truth", "", Unit::PX, Role::Truth;
    /// The distance of the estimated position from the true one.
    ERROR: "Error", "", Unit::PX, Role::Error;
    /// The normalised estimation error squared of the position.
    NEES: "NEES", "", Unit::FINE, Role::Error;
    /// The mean NIS of the accepted measurements.
    MEAN_NIS: "Mean NIS (accepted)", "", Unit::FINE;
    /// The lower end of the 95 % band of the mean NIS of a consistent filter.
    BAND_LOW: "Band from", "", Unit::FINE;
    /// The upper end of the 95 % band of the mean NIS of a consistent filter.
    BAND_HIGH: "Band to", "", Unit::FINE;
}

crate::cases! { pub over value;
    NIS_ABOVE: "Mean NIS {mean_nis} is above the 95 % band {band_low}–{band_high}. The covariance is too small (overconfident): raise the \
                process noise Q or the measurement noise R.",
    NIS_BELOW: "Mean NIS {mean_nis} is below the 95 % band {band_low}–{band_high}. The covariance is too large (underconfident): lower the \
                process noise Q or the measurement noise R.",
    NIS_WITHIN: "Mean NIS {mean_nis} is within the 95 % band {band_low}–{band_high}: the innovations agree with S in size, so NIS alone \
                 does not show the bias.",
    CONSISTENT: "Mean NIS {mean_nis} is within the 95 % band {band_low}–{band_high}: the filter is consistent.",
}
