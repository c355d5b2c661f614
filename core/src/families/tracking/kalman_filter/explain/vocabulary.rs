//! The values of a Kalman filter on one object, and the cases of its steps.

use crate::methods::kalman::vocabulary::value as shared;
use crate::scene::{Role, Unit};
use crate::{cases, variables};

variables! { pub(in super::super) mod value;
    /// The origin of a measurement.
    ORIGIN: "", "", Unit::WHOLE;
    /// The true object that is measured.
    MEASURED_OBJECT: "", "", Unit::WHOLE;
    /// The true object of the track.
    TRACKED_OBJECT: "", "", Unit::WHOLE;
    /// The number of detections of the frame.
    DETECTIONS: "", "", Unit::count("detection"), Role::Measured;
    /// The number of the object that was chosen.
    OBJECT: "", "", Unit::WHOLE;
    /// The initial standard deviation of each velocity component.
    INITIAL_SPEED: "", "", Unit::SPEED;
    /// The number of missed frames in a row.
    MISSED: "", "", Unit::count("missed frame");
    /// The largest number of missed frames in a row before the track is deleted.
    MAX_AGE: "", "", Unit::count("frame");
    /// The number of measurements in a row outside the gate.
    REJECTIONS: "", "", Unit::count("rejection");
    /// The distance from the filtered position to the smoothed one.
    SHIFT: "", "", Unit::PX;
    /// The first frame of the track that is filtered again.
    FIRST_FRAME: "", "", Unit::WHOLE;
    /// The frame in which the divergence shows.
    DIVERGED_FRAME: "", "", Unit::WHOLE;
    /// A motion model.
    MODEL: "", "", Unit::WHOLE;
    /// The number of measurements inside the gate of that model.
    ACCEPTED: "", "", Unit::WHOLE;
    /// The number of measurements that the gate of that model tests.
    GATED: "", "", Unit::count("measurement");
    /// The first frame from which the track is restarted.
    RESTART_FRAME: "", "", Unit::WHOLE;
    /// The motion model with which the track is restarted.
    RESTART_MODEL: "", "", Unit::WHOLE, Role::Result;
    /// The number of measurements inside the gate of the restarted track.
    RESTART_ACCEPTED: "", "", Unit::WHOLE;
    /// The number of measurements that the gate of the restarted track tests.
    RESTART_GATED: "", "", Unit::WHOLE;
    /// The number of measurements that the gate tests in the run.
    TESTED: "", "", Unit::count("measurement");
    /// The number of measurements that the gate rejects in the run.
    REJECTED: "", "", Unit::WHOLE;
    /// The share of the measurements that the gate rejects in the run.
    SHARE_REJECTED: "", "", Unit::WHOLE_PERCENT;
    /// The mean innovation of the accepted measurements.
    BIAS: "", r"\bar{\nu}", Unit::PX;
    /// The root mean square distance of the filtered positions from the true ones.
    RMSE_FILTERED: "RMS error, filtered", "", Unit::PX;
    /// The root mean square distance of the smoothed positions from the true ones.
    RMSE_SMOOTHED: "RMS error, smoothed", "", Unit::PX;
    /// The root mean square distance of the accepted measurements from the true positions.
    RMSE_MEASURED: "RMS error, accepted measurements", "", Unit::PX;
    /// The root mean square distance of the filtered positions from the true ones in the frames of accepted measurements.
    RMSE_THERE: "RMS error, filtered in these frames", "", Unit::PX;
    /// The position along x.
    X: "", "x", Unit::PX, Role::Estimate;
    /// The position along x before the step.
    X_BEFORE: "", "x", Unit::PX;
    /// The velocity along x.
    U: "", "u", Unit::SPEED;
    /// The acceleration along x.
    A_X: "", "a_x", Unit::new("px/frame²", 2);
    /// The innovation along x.
    NU_X: "", r"\nu_x", Unit::PX, Role::Best;
    /// The number of sigma points.
    SIGMA_POINTS: "", "", Unit::count("sigma point"), Role::Candidate;
    /// The dimension of the state.
    STATE_DIMENSION: "", "n", Unit::WHOLE;
    /// The largest distance of a sigma point from the mean.
    REACH: "", "", Unit::PX;
    /// The squared distance of the sigma points from the mean, in columns of the Cholesky factor: n + κ.
    SQUARED_SCALE: "", "c^2", Unit::WHOLE;
    /// The prior knowledge of the distribution: 2 is the best for a normal one.
    BETA: "β", r"\beta", Unit::WHOLE;
    /// The weight of the sigma point at the mean in the mean.
    CENTER_WEIGHT: "w₀ of the mean", "w_0", Unit::RATIO;
    /// The weight of the sigma point at the mean in the covariance.
    CENTER_SPREAD: "w₀ of the covariance", r"w_0^{(c)}", Unit::RATIO;
    /// The weight of each other sigma point.
    PAIR_WEIGHT: "wᵢ", "w_i", Unit::RATIO;
    /// The distance of the mean of the moved sigma points from the moved mean.
    CURVATURE: "", "", Unit::PX;
    /// The number of frames with an estimate.
    FRAMES: "", "", Unit::count("frame");
    /// The number of frames in which the coordinated turn is the more probable mode.
    TURNING: "", "", Unit::WHOLE;
    /// The probability that the object changes its mode.
    SWITCH: "", "p_{12}", Unit::RATIO;
    /// The probability of constant velocity.
    VELOCITY_PROBABILITY: "Probability of velocity", r"\mu_1", Unit::RATIO, Role::Reference;
    /// The probability of the coordinated turn.
    TURN_PROBABILITY: "Probability of turn", r"\mu_2", Unit::RATIO, Role::Candidate;
    /// The predicted probability of constant velocity.
    PREDICTED_VELOCITY: "", r"\mu_1^-", Unit::RATIO;
    /// The predicted probability of the coordinated turn.
    PREDICTED_TURN: "", r"\mu_2^-", Unit::RATIO;
    /// The share of constant velocity in its own mixed estimate.
    VELOCITY_KEPT: "", r"\mu_{11}", Unit::RATIO;
    /// The share of the turn in the mixed estimate of constant velocity.
    VELOCITY_MIXED: "", r"\mu_{21}", Unit::RATIO;
    /// The share of the turn in its own mixed estimate.
    TURN_KEPT: "", r"\mu_{22}", Unit::RATIO;
    /// The share of constant velocity in the mixed estimate of the turn.
    TURN_MIXED: "", r"\mu_{12}", Unit::RATIO, Role::Candidate;
    /// The position along x by constant velocity.
    VELOCITY_X: "", "x_1", Unit::PX, Role::Reference;
    /// The position along x by the coordinated turn.
    TURN_X: "", "x_2", Unit::PX, Role::Candidate;
    /// The position by constant velocity.
    VELOCITY_POSITION: "By constant velocity", r"\mathbf{x}_1", Unit::PX, Role::Reference;
    /// The position by the coordinated turn.
    TURN_POSITION: "By the coordinated turn", r"\mathbf{x}_2", Unit::PX, Role::Candidate;
    /// The Kalman gain of constant velocity along x.
    VELOCITY_GAIN: "", r"\mathbf{K}_1", Unit::RATIO;
    /// The Kalman gain of the coordinated turn along x.
    TURN_GAIN: "", r"\mathbf{K}_2", Unit::RATIO;
    /// The natural logarithm of the likelihood of the measurement under constant velocity.
    VELOCITY_LIKELIHOOD: "", r"\ln \Lambda_1", Unit::FINE;
    /// The natural logarithm of the likelihood of the measurement under the coordinated turn.
    TURN_LIKELIHOOD: "", r"\ln \Lambda_2", Unit::FINE;
    /// The log-likelihood of one model minus that of the other.
    LIKELIHOOD_RATIO: "", r"\ln \Lambda_2 - \ln \Lambda_1", Unit::FINE;
    /// The probability of the more likely mode.
    BETTER: "", "", Unit::RATIO;
    /// The probability of the more likely mode before the measurement.
    BETTER_BEFORE: "", "", Unit::RATIO;
}

cases! { pub(in super::super) over value, shared;
    OPENING: "The Kalman filter estimates the state x (position, velocity) and its covariance P. In each frame it {predicted|predicts} \
              both, gates the {measured|measurement} and {estimate|updates} both by a measurement within the gate.",
    NIS_AND_GATE: "{squared_distance}, gate {gate}",
    MEAN_AND_BAND: "{mean_nis}, 95 % band {band_low}–{band_high}",
    // The prediction.
    PREDICTED: "Prediction for frame {frame}: {position}.",
    BY_VELOCITY: "Process noise Q and the uncertain velocity",
    BY_ACCELERATION: "Process noise Q and the uncertain velocity and acceleration",
    BY_TURN: "Process noise Q and the uncertain velocity and turn rate",
    SPREAD: "increase the standard deviation of the position from {deviation_before:bare} to {deviation}.",
    BENT: "The mean of the moved sigma points lies {curvature} from f(x): the curvature of the turn, which a Jacobian omits. A, the \
           linear regression of f(x) on x over the sigma points, takes the place of the Jacobian F in the smoother only.",
    SIGMA_POINTS: "{sigma_points} have the mean x and the covariance P: x itself, and a pair about it for each column of the Cholesky \
                   factor of P, in position up to {reach} away. Each will be moved by the turn itself, so no derivative is needed. In \
                   the covariance, x weighs β = {beta} more than in the mean, as is best for a normal distribution.",
    NOT_DEFINITE: "P is not positive definite, so sigma points cannot be drawn: the Jacobian predicts this frame.",
    MIXED: "Mixing: {reference|constant velocity} begins the frame with {velocity_kept} of its own estimate and {velocity_mixed} of that \
            of the turn, {candidate|the coordinated turn} with {turn_kept} of its own and {turn_mixed} of the other. A switch has a \
            probability of {switch}, so the predicted mode probabilities are {predicted_velocity} and {predicted_turn}. Without mixing, \
            the mode that did not fit would keep the errors of its past.",
    // The measurement.
    MEASURED: "{measured|Measurement:} {measurement} ({origin})",
    MEASURED_OBJECT: "{measured|Measurement:} {measurement} ({origin}, of object {measured_object})",
    MEASURED_OTHER: "{measured|Measurement:} {measurement} ({origin}, of object {measured_object}; the tracked object is {tracked_object})",
    SECOND: "{measured|Second sensor:} {measurement}",
    NOISE: ", measurement noise σ = {measurement_noise}.",
    FIRST_HIDDEN: "Frame {frame} is in the simulated occlusion of the first sensor.",
    HIDDEN: "Frame {frame} is in the simulated occlusion: no measurement.",
    DETECTED: "{detections} in frame {frame}",
    NONE_TRACKED: ", none of them of the tracked object.",
    NONE_CLICKED: ", none of them at a clicked position. The track starts at the clicked object.",
    NONE_CHOSEN: ". The track starts in a later frame, with the object that moves most consistently.",
    NO_DETECTIONS: "No detections in frame {frame}.",
    BEGUN: "The first measurement starts a track at {position}. Its velocity is unknown, so it starts at 0 with a standard deviation of \
            {initial_speed} (parameter Initial speed).",
    ONLY_ONE: "Object {object} was chosen, but only one was detected; the last one is tracked.",
    ONLY_SOME: "Object {object} was chosen, but only {detections:bare} were detected; the last one is tracked.",
    // The gate.
    DISTANCE: "Squared Mahalanobis distance of the innovation: {measured|d² = }{squared_distance}.",
    SECOND_DISTANCE: "Squared Mahalanobis distance of the second sensor's innovation: {measured|d² = }{squared_distance}.",
    ACCEPTED: "It is within the {gate_probability} gate {gate} (χ², {dimension} dof): accepted.",
    REJECTED: "It exceeds the {gate_probability} gate {gate} (χ², {dimension} dof): {error|rejected}.",
    CLICKED: "It exceeds the {gate_probability} gate {gate} (χ², {dimension} dof), but a clicked position is accepted without the gate.",
    CLICKS_OUTSIDE: "{rejections:bare} in a row lie outside it: the motion model does not fit.",
    // The update.
    UPDATED: "Update with Kalman gain {gain} along x: position {position_before:bare}{estimate| → }{position}, velocity \
              {velocity_before:bare} → {velocity}. The standard deviation of the position falls from {deviation_before:bare} to \
              {deviation}.",
    TURN_RATE: "The turn rate is ω = {turn_rate}.",
    MODES_UPDATED: "Each mode is updated by its own gain: {reference|constant velocity} with {velocity_gain} along x to \
                    {velocity_position:bare}, {candidate|the coordinated turn} with {turn_gain} along x to {turn_position}. The gain is \
                    larger where the model is less certain of its prediction.",
    LIKELIHOODS: "Log-likelihood of the measurement: {velocity_likelihood} for {reference|constant velocity} and {turn_likelihood} for \
                  {candidate|the coordinated turn}.",
    EQUALLY_LIKELY: "It is equally likely under both, so the mode probabilities stay at {velocity_probability} and {turn_probability}.",
    VELOCITY_LIKELIER: "It is more likely under constant velocity,",
    TURN_LIKELIER: "It is more likely under the coordinated turn,",
    STAYS: "so that probability stays at {better}.",
    RISES: "so that probability rises: {better_before} → {better}.",
    WEIGHED: "The estimate is the mean of both modes with these weights, {position}.",
    // No accepted measurement.
    NO_TRACK: "No track after the deletion, and no measurement in frame {frame} to start one.",
    NOT_THE_ONE: "No track yet: the only detection does not belong",
    NOT_ONE: "No track yet: none of the {detections} belongs",
    CLICK_IT: "to the object that moves most consistently. To track another object, choose Place beside the parameter Clicks and click on \
               the object.",
    NOT_STARTED: "No track has started yet: none of {detections} in frame {frame} was chosen.",
    NO_MEASUREMENT_YET: "No measurement up to frame {frame}: no track has started yet.",
    UNMEASURED: "No measurement: the track coasts at the prediction {position}.",
    ONE_REJECTED: "The measurement is rejected, so the track coasts at the prediction {position}.",
    ALL_REJECTED: "All measurements are rejected, so the track coasts at the prediction {position}.",
    ONE_MISSED: "{missed} (maximum age {max_age:bare}).",
    MISSED: "{missed} in a row (maximum age {max_age:bare}).",
    REJECTIONS: "{rejections} in a row",
    OF_OTHERS: ", all of other objects: the tracked object is not detected (occluded or out of the picture), and the gate is right.",
    OF_IT: ", all of the object: the motion model does not fit.",
    OF_UNKNOWN: ". The object may be occluded and the nearest detection another object's; then the gate is right to reject it. If the \
                 rejected measurements are of the object, the motion model does not fit.",
    TOO_OLD: "No accepted measurement for more than {max_age} (the maximum age):",
    OUTSIDE: "The prediction {position} is far outside the picture:",
    DELETED: "the track is deleted. The next measurement starts another.",
    // A restart.
    DIVERGED: "{error|The filter has diverged}: since frame {first_frame}, {model} accepts {accepted} of {gated}. Filtered again",
    TRIAL: ", {model} accepts {accepted} of {gated}",
    NO_TRIAL: ", no other motion model keeps the track",
    RESTARTED: ". The track is restarted with {restart_model}, which accepts {restart_accepted} of {restart_gated}: {position}.",
    STARTED_ANEW: ". It started with something else: from frame {restart_frame} the most consistent motion is tracked with {restart_model}, which \
                   accepts {restart_accepted} of {restart_gated}: {position}.",
    NOT_RESTARTED: ". No model accepts the rejected ones, so the track goes on as it is.",
    // Smoothing.
    SMOOTHED: "Smoothing frame {frame} with the later measurements moves the estimate by {shift} to {position}. The standard deviation of \
               the position changes from {deviation_before:bare} to {deviation}.",
    KEPT: "Frame {frame} is the last of its track: without later measurements, the smoothed estimate is the filtered one.",
    NOTHING_TO_SMOOTH: "Frame {frame} has no estimate to smooth.",
    // The end of a run.
    HAD_DIVERGED: "The filter had diverged in frame {diverged_frame}: {model} accepts {accepted} of {gated}.",
    WAS_RESTARTED: "The track was restarted from frame {restart_frame} with {restart_model} (parameter Motion), which accepts {restart_accepted} of \
                    {restart_gated}.",
    TURNS: "The coordinated turn was the more probable mode in {turning} of {frames}. Whether two modes were worth it, the RMS error of \
            one motion model alone shows.",
    BENDS: "The sigma points moved the predicted mean by up to {curvature},",
    BENDS_LITTLE: "little beside the measurement noise: an extended filter does as well here.",
    BENDS_MUCH: "which is not little beside the measurement noise: an extended filter is biased by it.",
    GATE_REJECTED: "The gate rejected {rejected} of {tested}.",
    UNTESTED: "No measurement was accepted, so the innovations do not show whether the covariance is right.",
    BIASED: "The innovations are biased by {bias}: the motion model does not fit.",
    MANY_REJECTED: "With {share_rejected} rejected, the NIS of the rest does not test the filter.",
    GATE_IS_RIGHT: "All rejected measurements are of other objects: the gate was right.",
    HAS_DIVERGED: "They are of the object, so the filter has diverged: the motion model does not fit.",
    MAY_HAVE_DIVERGED: "If the rejected measurements are of the object, the filter has diverged: the motion model does not fit.",
    // The remedy.
    FILTERED_AGAIN: "Filtered again from frame {first_frame}",
    UNEXPLAINED: ", so no other motion model explains them: raise the process noise, or choose another detector.",
    BESIDE_PATH: "The measurements lie beside the predicted path: choose the coordinated turn, or constant acceleration for a thrown \
                  object.",
    ALONG_AND_BESIDE: "The measurements lie neither clearly along the predicted path nor clearly beside it: compare the motion models, or \
                       raise the process noise.",
    ALONG_PATH: "The measurements lie along the predicted path: choose the motion model of constant acceleration, or raise the process \
                 noise.",
    NEITHER_MODE: "Neither mode does: raise the process noise or the turn noise, or choose another motion model.",
    ANOTHER_MODEL: "Raise the process noise, or choose another motion model.",
}
