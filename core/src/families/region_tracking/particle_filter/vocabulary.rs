//! The values and the cases of the particle filter.

use crate::methods::region::vocabulary::value as region;
use crate::scene::{Decimals, Role, Unit};

crate::variables! { pub(super) mod value;
    /// The number of particles.
    PARTICLES: "Particles", "N", Unit::count("particle"), Role::Predicted;
    /// The standard deviations of the positions of the particles along x and y.
    DEVIATIONS: "Standard deviations", "", Unit::PX;
    /// The standard deviation of the random acceleration.
    PROCESS_NOISE: "Process noise", r"\sigma", Unit::new("px/frame²", 2);
    /// The number of particles outside the picture, which have weight 0.
    OUTSIDE: "Particles outside the picture", "", Unit::WHOLE;
    /// The weight of each of N particles of equal weight.
    EQUAL_WEIGHT: "Equal weight", "1/N", Unit::new("", 4);
    /// The Bhattacharyya coefficient of the best particle.
    BEST: "Best coefficient", r"\rho", Unit::RATIO, Role::Best;
    /// The Bhattacharyya coefficient of the worst particle inside the picture.
    WORST: "Worst coefficient", r"\rho", Unit::RATIO;
    /// The factor of the likelihood.
    LAMBDA: "Lambda", r"\lambda", Unit::new("", 1);
    /// The likelihood of the best particle as a multiple of that of the worst.
    LIKELIHOOD_RATIO: "Likelihood ratio", "", Unit { name: "", decimals: Decimals::WholeOrPower };
    /// The weighted mean of the positions.
    ESTIMATE: "Estimate", "", Unit::PX, Role::Estimate;
    /// The weighted mean of the velocities.
    VELOCITY: "Velocity", r"\mathbf{v}", Unit::SPEED;
    /// The weighted mean of the scales, relative to the first frame.
    SCALE: "Scale", "s", Unit::RATIO;
    /// The share of the particles inside the ellipse, if they are normally distributed.
    CONFIDENCE: "Confidence", "", Unit::WHOLE_PERCENT;
    /// The weight of the heavier part of the cloud.
    HEAVY: "Weight of the heavier part", "", Unit::RATIO;
    /// The centre of the heavier part of the cloud.
    HEAVY_CENTER: "Centre of the heavier part", "", Unit::PX;
    /// The weight of the lighter part of the cloud.
    LIGHT: "Weight of the lighter part", "", Unit::RATIO;
    /// The centre of the lighter part of the cloud.
    LIGHT_CENTER: "Centre of the lighter part", "", Unit::PX;
    /// The number of particles of equal weight that the weights are worth.
    EFFECTIVE: "Effective sample size", r"N_{\text{eff}}", Unit::new("", 1), Role::Measured;
    /// The effective sample size below which the particles are drawn anew.
    LIMIT: "Limit of resampling", "", Unit::new("", 1);
    /// The number of particles with a copy.
    DISTINCT: "Distinct particles", "", Unit::WHOLE, Role::Best;
    /// The number of copies of the particle with the most.
    MOST_COPIES: "Most copies", "", Unit::count("copy");
}

crate::cases! { pub(super) over value, region;
    MODELLED: "The {reference|model q} is the {binning} histogram of the ellipse, weighted by the Epanechnikov kernel: {filled} of {bins} \
               bins are filled.",
    SCATTERED: "{particles} around the centre of the region, standard deviations {deviations}. Each is a hypothesis of position, velocity \
                and scale.",
    PREDICTED: "Prediction: each particle moves with its velocity and a random acceleration of standard deviation {process_noise}. \
                {predicted|The standard deviations of the cloud are now} {deviations}.",
    NO_WEIGHT: "{outside} of {particles} lie outside the picture, and none inside has a weight above 0. The weights are set to 1/N = \
                {equal_weight}, and the estimate is not used: the object is lost.",
    WEIGHED: "Each weight is multiplied by the likelihood exp(−λ (1 − ρ)): ρ is {best} for the best and {worst} for the worst particle",
    SOME_OUTSIDE: ", and {outside} outside the picture have weight 0",
    LIKELIHOOD_RATIO: ". With λ = {lambda} the best counts {likelihood_ratio} times as much as the worst.",
    ESTIMATED: "The weighted mean of the particles is {estimate}, standard deviations {deviations}; velocity {velocity}, scale {scale}. \
                The ellipse holds {confidence} if the particles are normally distributed.",
    TWO_PARTS: "The cloud has two parts, of the weights {heavy} around {heavy_center} and {light} around {light_center}; the mean lies \
                between them.",
    COUNTED: "The weights are worth {effective} {measured|particles of equal weight}, the effective sample size, of {particles:bare}:",
    DEGENERATE: "below {limit}, so the particles are drawn anew (degeneracy).",
    KEPT: "not below {limit}, so the particles and their weights are kept.",
    SYSTEMATIC: "Systematic resampling: an arc of the wheel is as long as the weight of its particle (light neighbours share one), and \
                 each equally spaced pointer copies the particle on its arc.",
    MULTINOMIAL: "Multinomial resampling: an arc of the wheel is as long as the weight of its particle (light neighbours share one), and \
                  each random pointer copies the particle on its arc.",
    SURVIVORS: "{distinct} {best|distinct particles of} {particles:bare} {best|survive}, the heaviest with {most_copies}.",
    IMPOVERISHED: "So few distinct ones are an impoverishment of the cloud; the process noise has to spread it again.",
    EQUAL_WEIGHTS: "All have equal weights now.",
    WEIGHTLESS: ": no particle has a weight above 0",
    ALL_OUTSIDE: "All particles lie outside the picture, where none has a weight, and nothing brings them back. Only a new start finds an \
                  object that enters again.",
    FOLLOWED_HIDDEN: "The object was hidden in {hidden}: the velocity carried the particles on, and those on other places survived until \
                      it could be seen again. More particles make that likelier.",
    FOLLOWED: "Resampling multiplied the particles on the object, and the process noise spread them enough to follow it. More particles \
               or less process noise make the estimate steadier.",
    REGAINED: "The estimate left the object, and particles that were near it won later: other hypotheses had survived. A Kalman filter \
               keeps one only.",
    RESIZED: "The scale of the particles drifted from that of the object, because the histogram changes little with the size. A smaller \
              scale noise keeps it nearer.",
    BESIDE: "The mean of the cloud lies beside the object, because other places have colours of the model too, or none has them while the \
             object is hidden. A larger λ lets fewer particles on other places survive.",
    LOST: "No particle was near the object any more, or others had larger weights. More process noise spreads the particles farther \
           between frames, which fast motion needs; with it more particles are needed, too.",
}
