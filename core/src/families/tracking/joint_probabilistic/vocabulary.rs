//! The values that explain joint probabilistic data association, and its cases.

use crate::methods::multi_object::vocabulary::value as shared;
use crate::scene::{Role, Unit};

crate::variables! { pub(super) mod value;
    /// The number of feasible joint events of the cluster.
    JOINT_EVENTS: "Joint events", "", Unit::count("feasible joint event");
    /// The largest number of joint events of a cluster.
    MAX_EVENTS: "Maximum number of joint events", "", Unit::count("");
    /// The probability of the joint event.
    PROBABILITY: "Probability", r"P(\theta)", Unit::RATIO, Role::Best;
    /// The probability that the detection is the track's.
    WEIGHT: "Association probability", r"\beta", Unit::RATIO, Role::Best;
    /// The probability that none of the detections is the track's.
    MISSED_WEIGHT: "Not detected β₀", r"\beta_0", Unit::RATIO;
    /// The number of detections in the gate of the track.
    IN_GATE: "Detections in the gate", "", Unit::count("detection"), Role::Measured;
    /// The detection that is reported as the track's own.
    OWN_DETECTION: "Own detection", "", Unit::WHOLE, Role::Measured;
    /// The probability that the detection belongs to one of the tracks.
    SHARE: "Share of the tracks", r"\sum \beta", Unit::RATIO;
    /// The probabilities of the first detections.
    WEIGHTS: "Association probabilities", r"\beta_j", Unit::RATIO;
    /// The innovations of the first detections, in px, a column for each.
    INNOVATIONS: "Innovations", r"\mathbf{\nu}_j", Unit::PX, Role::Measured;
    /// The combined innovation, in px.
    INNOVATION: "Combined innovation", r"\mathbf{\nu}", Unit::PX, Role::Measured;
    /// The number of frames in which two objects were neighbours.
    NEIGHBOUR_FRAMES: "Frames with neighbours", "", Unit::count("frame");
    /// The mean distance of neighbouring objects.
    TRUE_DISTANCE: "Distance of neighbours", "", Unit::PX, Role::Truth;
    /// The mean distance of the tracks of neighbouring objects.
    TRACK_DISTANCE: "Distance of their tracks", "", Unit::PX, Role::Estimate;
}

crate::cases! { pub(super) over value, shared;
    OPENING: "No assignment is made: each track is updated with all {measured|detections} in its gate, weighted by the probability \
              that each is its own. Within a joint event no detection is used twice; β sums over the events, so a detection between \
              two tracks still updates both.",
    PREDICTED: "Prediction of {tracks}: the predicted covariance decides how many detections the gate contains.",
    VALIDATED: "Validation matrix: {gated:bare} of {pairs} inside the gate, d² ≤ {gate} (χ², 2 dof, {gate_probability}).",
    CLUSTERED: "Tracks with a common detection form a cluster, because their associations exclude each other: {clusters}.",
    ENUMERATED: "{cluster_tracks} and {cluster_detections} have {joint_events}: in each, a detection has one origin and a track at most \
                 one detection.",
    MOST_PROBABLE: "The most probable one, {best|P(θ) =} {probability}:",
    EXHAUSTED: "The cluster is too large to rank all of its events: some may be missing.",
    LEFT_OUT: "The maximum number of joint events, {max_events}, leaves out less probable ones.",
    WEIGHED: "β of a track and a detection is the sum of P(θ) over the joint events with that pair.",
    LARGEST: "The largest is {best|β =} {weight} of track {track} and detection {detection}. The probability that track {track} is not \
              detected is β₀ = {missed_weight}.",
    UPDATED: "{estimate|Track} {track}: combined innovation of {in_gate}, most of all detection {detection} (β = {weight}), moves the \
              position from {position_before:bare} to {position}, its standard deviation from {deviation_before:bare} to {deviation}.",
    PART_FOR_NONE: "The part β₀ for no detection keeps its covariance larger than a certain update would.",
    SPREAD: "Their spread adds to its covariance, because only one of them can be right.",
    OTHER_COUNTS: "Detection {detection} counts for another track, and detection {own_detection} for this one.",
    ALL_COUNT_ELSEWHERE: "Its detections count for other tracks.",
    COASTS: "{predicted|Track} {track} coasts: β₀ = {missed_weight} ≥ 0.5, so more probably none of the detections is its own. {missed}",
    BEGUN: "{reference|Track} {track} starts: its detection belongs to the known tracks with Σ β = {share} < 0.5.",
    COALESCENCE: "Coalescence: neighbouring objects were {true_distance} apart on average over {neighbour_frames}, and their tracks \
                  {track_distance}. Both tracks were updated with the same detections; multiple hypotheses assign each detection to one \
                  track.",
    NO_COALESCENCE: "No coalescence: neighbouring objects were {true_distance} apart on average over {neighbour_frames}, and their \
                     tracks {track_distance}. Soft association did not draw them together.",
}
