//! The values that explain multiple hypothesis tracking, and its cases.

use crate::methods::multi_object::vocabulary::value as shared;
use crate::scene::{Role, Unit};

crate::variables! { pub(super) mod value;
    /// The number of clusters before the frame.
    CLUSTERS_BEFORE: "Clusters before", "", Unit::count("cluster");
    /// The number of clusters formed by a merge.
    MERGED: "Merged clusters", "", Unit::WHOLE;
    /// The number of hypotheses of all clusters.
    HYPOTHESES: "Hypotheses", "", Unit::count("hypothesis");
    /// The number of hypotheses of all clusters before the frame.
    HYPOTHESES_BEFORE: "Hypotheses before", "", Unit::count("hypothesis");
    /// The number of hypotheses of the cluster that branch.
    PARENTS: "Branching hypotheses", "", Unit::count("hypothesis");
    /// The number of branches of the cluster.
    BRANCHES: "Branches", "", Unit::count("branch"), Role::Candidate;
    /// The number of branches behind the two most probable ones.
    MORE: "Further branches", "", Unit::count("");
    /// The largest number of hypotheses of a cluster.
    MAX_HYPOTHESES: "Maximum number of hypotheses", "k", Unit::WHOLE;
    /// The smallest probability of a hypothesis, as a share of that of the leading one.
    MIN_RATIO: "Minimum ratio", "", Unit::RATIO;
    /// The probability of the most probable branch.
    PROBABILITY: "Probability", "P", Unit::RATIO, Role::Best;
    /// The probability of the second branch.
    NEXT_PROBABILITY: "Second branch", "", Unit::RATIO, Role::Candidate;
    /// The frame that is decided.
    DECIDED_FRAME: "Decided frame", "t - N", Unit::WHOLE;
    /// The number of frames after which a frame is decided.
    LATER_FRAMES: "Later frames", "N", Unit::count("later frame");
    /// The number of hypotheses that the decision deletes.
    DELETED: "Deleted", "", Unit::count("hypothesis"), Role::Rejected;
    /// The number of clusters with deleted hypotheses.
    PRUNED_CLUSTERS: "Pruned clusters", "", Unit::count("cluster");
    /// The sum of the probabilities of the deleted hypotheses.
    DELETED_PROBABILITY: "Deleted probability", "", Unit::RATIO;
    /// The product of the probabilities of the leading hypotheses of all clusters.
    LEADING_PROBABILITY: "Leading probability", "P", Unit::RATIO, Role::Best;
    /// The probability of the second global hypothesis.
    SECOND_PROBABILITY: "Second probability", "", Unit::RATIO, Role::Reference;
    /// The last frame that the second hypothesis explains otherwise.
    SECOND_FRAME: "Frame of the difference", "", Unit::WHOLE;
    /// The frame that decides between both.
    DECIDING_FRAME: "Deciding frame", "", Unit::WHOLE;
    /// The earlier frame of a revised detection.
    REVISED_FRAME: "Revised frame", "", Unit::WHOLE;
    /// The number of detections of earlier frames with another origin than before.
    REVISED: "Revised detections", "", Unit::count("detection");
    /// The number of tracks with a detection.
    DETECTED_TRACKS: "Detected tracks", r"\text{DT}", Unit::count("track");
    /// The number of tracks without a detection.
    MISSED_TRACKS: "Missed tracks", r"\text{missed}", Unit::count("track");
    /// The number of new tracks.
    NEW_TRACKS: "New tracks", r"\text{NT}", Unit::count("track");
    /// The logarithm of the detection probability.
    LN_DETECTED: "", r"\ln P_D", Unit::RATIO;
    /// The logarithm of the probability that a track has no detection in its gate.
    LN_MISSED: "", r"\ln (1 - P_D P_G)", Unit::RATIO;
    /// The logarithm of the density of false alarms.
    LN_FALSE: "", r"\ln \beta_{\text{FT}}", Unit::RATIO;
    /// The logarithm of the density of new tracks.
    LN_NEW: "", r"\ln \beta_{\text{NT}}", Unit::RATIO;
    /// The logarithm of the probability of the hypothesis that branches.
    LN_PARENT: "", r"\ln P_{\text{parent}}", Unit::RATIO;
    /// The sum of the logarithms of the likelihoods of the innovations.
    LN_INNOVATIONS: "", r"\sum \ln N(\nu; 0, S)", Unit::RATIO;
    /// The sum of the logarithms of the likelihood ratios of the sizes.
    LN_SIZES: "", r"\sum \ln L_{\text{size}}", Unit::RATIO;
    /// The logarithm of the weight of the branch.
    LN_WEIGHT: "", r"\ln (c P)", Unit::RATIO;
    /// The logarithm of the sum of the weights of all branches.
    LN_SUM: "", r"\ln c", Unit::RATIO;
    /// The logarithm of the probability of the branch.
    LN_PROBABILITY: "", r"\ln P", Unit::RATIO;
}

crate::cases! { pub(super) over value, shared;
    OPENING: "A hypothesis explains the origin of every detection. In each frame hypotheses branch, because a {measured|detection} may \
              come from a track, a new track, or be a false alarm. Later frames decide which branch survives.",
    PREDICTED: "Prediction of {tracks} in all hypotheses. Hypotheses that explain the past of a track alike share it, so it is \
                predicted once.",
    CLUSTERED: "Tracks with a common detection compete and form a cluster: {clusters}, {merged} merged in this frame. Clusters are \
                independent, so their hypotheses do not multiply.",
    IN_NO_GATE: "{cluster_detections} in no gate.",
    NONE_IN_GATES: "Track {track} has no detection in its gates.",
    IN_GATES: "Track {track} has {cluster_detections} in its gates.",
    COMPETE: "{cluster_tracks} compete for {cluster_detections}.",
    MOST_PROBABLE: "Most probable, {best|P =} {probability}:",
    NEXT: "Next, {candidate|P =} {next_probability}:",
    NONE_TO_EXPLAIN: "no detection to explain in frame {frame}",
    NO_OTHER_ABOVE: "No other explanation has at least {min_ratio} times its probability.",
    NO_OTHER: "There is no other explanation.",
    MORE: "Further, less probable branches: {more}.",
    MORE_ABOVE: "Further branches with at least {min_ratio} times the highest probability: {more}.",
    EXHAUSTED: "The cluster is too large to rank all of its branches: some may be missing.",
    LEFT_OUT: "The maximum number of hypotheses, {max_hypotheses}, leaves out less probable ones.",
    ALIKE: "Frame {decided_frame} is decided after {later_frames}: all hypotheses explain it alike.",
    PRUNED: "Frame {decided_frame} is decided after {later_frames} as the leading hypothesis explains it. N-scan pruning deletes {deleted} \
             with another explanation in {pruned_clusters}, with a probability of {deleted_probability} in all.",
    LED: "{best|Leading hypothesis} of {hypotheses} in {clusters}, P = {leading_probability} as the product over clusters:",
    NO_SECOND: "There is no second one: all frames are decided.",
    SECOND: "The {reference|second}, P = {second_probability},",
    EXPLAINS_OTHERS: "explains other detections.",
    SAYS: "says of frame {second_frame} that",
    LEADING_SAYS: "where the leading one says",
    DECIDES: ". Frame {deciding_frame} decides.",
    REVISED: "Deferred decision: in frame {revised_frame},",
    DETECTION_WAS: "detection {detection} was",
    AND_IS: "and is",
    REWRITTEN: "now. The detections since then have made another hypothesis the most probable, and the frames not decided yet are \
                rewritten.",
    MORE_REVISED: "{revised} of earlier frames in all have another origin now.",
}
