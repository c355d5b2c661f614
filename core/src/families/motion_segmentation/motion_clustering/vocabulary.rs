//! The values and cases of motion clustering.

use crate::methods::segmentation::explain::value as shared;
use crate::scene::{Role, Unit};
use crate::{cases, variables};

/// A log-likelihood per pixel.
const LIKELIHOOD_UNIT: Unit = Unit::new("", 4);

variables! { pub(super) mod value;
    /// The number of pixels with a known displacement.
    POINTS: "Points", "", Unit::count("pixel"), Role::Measured;
    /// The number of clusters so far.
    CLUSTERS: "Clusters", "k", Unit::count("");
    /// The displacement that counts as much as a distance of 1 px in the picture.
    POSITION_WEIGHT: "Weight of the position", "s", Unit::RATIO;
    /// The mean silhouettes of 2, 3 and more clusters.
    SILHOUETTES: "Mean silhouettes from k = 2 on", "", Unit::RATIO;
    /// The number of clusters of largest mean silhouette.
    CHOSEN: "Chosen", "k", Unit::count("cluster"), Role::Result;
    /// The mean silhouette of the chosen number of clusters.
    SILHOUETTE: "Silhouette", "", Unit::RATIO;
    /// The number of a seed, mean, component or mode.
    NUMBER: "Number", "j", Unit::WHOLE;
    /// The pixel of a seed.
    SEED_PIXEL: "Pixel of the seed", "", Unit::WHOLE;
    /// The displacement of a seed.
    SEED: "Seed", "", Unit::SPEED, Role::Candidate;
    /// The squared distance of a seed to the nearest earlier one.
    SEED_DISTANCE: "Squared distance", "d^2", Unit::RATIO;
    /// The sum of the squared distances of all pixels to their nearest seeds.
    SUM: "Sum", "", Unit::RATIO;
    /// The number of distinct motions of the flow.
    DISTINCT: "Distinct motions", "", Unit::count("distinct motion"), Role::Result;
    /// The number of pixels of the sample.
    SAMPLE: "Sample", "", Unit::count("pixel");
    /// The number of pixels of the sample at which an ascent starts.
    STARTS: "Starts", "", Unit::count("");
    /// The number of the iteration.
    ITERATION: "Iteration", "", Unit::WHOLE;
    /// The number of pixels that change their cluster or their most likely component.
    CHANGES: "Changes", "", Unit::count("pixel"), Role::Candidate;
    /// The mean squared distance of the pixels to their means.
    WITHIN: "Mean squared distance", "", Unit::RATIO, Role::Error;
    /// A mean before its update.
    MEAN_BEFORE: "Mean before", "", Unit::SPEED, Role::Predicted;
    /// A mean after its update.
    MEAN: "Mean", r"\mu", Unit::SPEED, Role::Result;
    /// The number of pixels of a cluster.
    SIZE: "Pixels", "", Unit::count("pixel");
    /// The log-likelihood per pixel.
    LIKELIHOOD: "Log-likelihood per pixel", "", LIKELIHOOD_UNIT, Role::Measured;
    /// The log-likelihood per pixel after the iteration before.
    LIKELIHOOD_BEFORE: "Before", "", LIKELIHOOD_UNIT;
    /// The rise of the log-likelihood below which the iteration has converged.
    TOLERANCE: "Tolerance", "", LIKELIHOOD_UNIT;
    /// The weight of a component.
    WEIGHT: "Weight", "w", Unit::RATIO, Role::Measured;
    /// The standard deviations of a component along u and v.
    DEVIATIONS: "Standard deviations", "", Unit::SPEED;
    /// The number of pixels of the sample within the bandwidth.
    SUPPORT: "Support", "", Unit::count("pixel");
    /// The radius of the window.
    BANDWIDTH: "Bandwidth", "", Unit::SPEED;
    /// The window before its shift.
    WINDOW_BEFORE: "Window before", "", Unit::SPEED;
    /// The window after its shift.
    WINDOW: "Window", "", Unit::SPEED, Role::Estimate;
    /// The number of modes with enough support.
    KEPT: "Kept", "", Unit::count(""), Role::Result;
    /// The number of modes.
    MODES: "Modes", "", Unit::count("mode");
    /// The share of the sample that a mode needs within the bandwidth.
    LEAST_SUPPORT: "Least support", "", Unit::PERCENT;
    /// The squared distance of the inspected pixel to a mean.
    DISTANCE: "Squared distance", "d^2", Unit::RATIO;
    /// The responsibility of a component for the inspected pixel.
    RESPONSIBILITY: "Responsibility", "r", Unit::RATIO;
}

cases! { pub(super) over value, shared;
    OPENING: "Pixels that move together have similar displacements, so they form a cluster in the plane of displacements. The \
              clustering separates such clusters without looking at the picture.",
    NO_FLOW: "No pixel has a known flow, so there is nothing to segment.",
    POINTS: "{points} are points: its displacement (u, v) in px/frame.",
    POINTS_WITH_POSITION: "{points} are points: its position, weighted by {position_weight}, and its displacement, (s x, s y, u, \
                           v).",
    COMPARED: "The mean silhouette is largest with {chosen}: {silhouette}. A value near 1 means that pixels are much nearer to \
               their own cluster than to the next one. More clusters lower the distances further, but beyond the elbow they only \
               split a motion.",
    NOT_COMPARED: "No second cluster can be compared, since no pixel moves differently or only one cluster is allowed: k = 1.",
    FIRST_SEED: "Seed {number}: pixel {seed_pixel} with the displacement {seed}, drawn from all pixels with equal probability.",
    SEED: "Seed {number}: pixel {seed_pixel} with the displacement {seed}. Its squared distance to the nearest earlier seed is \
           {seed_distance}, of {sum} in all, which is its probability; distant pixels are likely, so the seeds spread over the \
           motions.",
    NO_SEEDS: "Without points there are no seeds, and so no clusters.",
    EXHAUSTED: "All pixels lie on the seeds so far. The flow has only {distinct}, so k is lowered to that.",
    SAMPLED: "Mean shift estimates the density of the displacements from a sample of {sample}. An ascent starts at {starts} of \
              them.",
    FIRST_ITERATION: "Iteration 1: each pixel goes to the nearest mean.",
    ITERATION: "Iteration {iteration}: each pixel goes to the nearest mean.",
    ASSIGNED: "{changes} change their cluster; the mean squared distance is {within}.",
    UNCHANGED: "No change, so the means stay as well: converged to a local minimum.",
    LIMIT: "The limit of iterations is reached.",
    EMPTY: "Mean {number} has no pixels, so it stays where it is.",
    AVERAGED: "Mean {number} moves from {mean_before:bare} to {mean}, the average of its {size}.",
    FIRST_EXPECTED: "Responsibilities divide each pixel among the components. Log-likelihood per pixel: {likelihood}.",
    EXPECTED: "Responsibilities divide each pixel among the components. Log-likelihood per pixel: {likelihood}, before \
               {likelihood_before}; it never falls.",
    RELABELLED: "{changes} change their most likely component.",
    CONVERGED: "The rise is below {tolerance}: converged.",
    MAXIMIZED: "Component {number} now has the weight {weight} and the mean displacement {mean}: averages over all pixels, \
                weighted by responsibility, so that each pixel may count for several components.",
    SHIFTED: "{support} of the sample lie within {bandwidth} of {window_before:bare}. The window moves to their mean \
              {window:bare}, toward higher density.",
    NEW_MODE: "The window stays at {mean:bare}: a new mode of the density, number {number}.",
    KNOWN_MODE: "The window stays at {mean:bare}: within the bandwidth of mode {number}, so it is the same mode.",
    KEPT: "{kept} of {modes} have at least {least_support} of the sample within the bandwidth. Each pixel goes to the nearest of \
           them; smaller modes lie between motions, where the flow is smoothed.",
    LABELLED: "Frame {frame} is segmented:",
    BY_BANDWIDTH: "The number follows from the bandwidth of {bandwidth}: a smaller one separates more motions.",
    SINGLE: "A single cluster was asked for, so no motions are separated.",
    WITHOUT_PIXELS: "A cluster without pixels is no segment.",
    BY_DISPLACEMENT: "Objects of one displacement share a segment wherever they are, and a rotating object falls into several.",
    BY_POSITION: "The position keeps segments compact, and splits what is large in the picture.",
}
