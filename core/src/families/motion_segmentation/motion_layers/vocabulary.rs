//! The values and cases of motion layers.

use crate::methods::segmentation::explain::value as shared;
use crate::scene::{Role, Unit};
use crate::{cases, variables};

/// A slope of an affine motion.
const SLOPE: Unit = Unit::new("", 4);

variables! { pub(super) mod value;
    /// The number of blocks so far.
    BLOCKS: "Blocks", "", Unit::count("");
    /// The number of blocks with a hypothesis, their affine motion.
    HYPOTHESES: "Hypotheses", "", Unit::count("affine motion"), Role::Measured;
    /// The number of layers.
    LAYERS: "Layers", "", Unit::count("");
    /// The share of the pixels without a layer.
    UNEXPLAINED: "Unexplained", "", Unit::PERCENT, Role::Error;
    /// The first pixel of the block.
    BLOCK: "Block", "", Unit::WHOLE;
    /// The motion of the block in its middle.
    MOTION: "Motion", "", Unit::SPEED, Role::Measured;
    /// The root mean squared residual of an affine motion.
    RESIDUAL: "Residual", "", Unit::SPEED, Role::Error;
    /// The distance of the flow of the inspected pixel from the motion of a layer.
    PIXEL_RESIDUAL: "", "", Unit::SPEED;
    /// The residual of the layer with its motion before.
    RESIDUAL_BEFORE: "Residual before", "", Unit::SPEED;
    /// The largest residual of a hypothesis.
    MAX_RESIDUAL: "Largest residual", "", Unit::SPEED;
    /// The number of clusters of affine motions.
    CLUSTERS: "Clusters", "", Unit::count("cluster"), Role::Result;
    /// The number of the layer.
    LAYER: "Layer", "", Unit::WHOLE;
    /// The number of the layer that is merged with it.
    OTHER: "Layer merged", "", Unit::WHOLE;
    /// The difference of the motions of two layers over their pixels.
    DIFFERENCE: "Difference", "", Unit::SPEED, Role::Measured;
    /// The difference below which layers are merged.
    MERGE_BELOW: "Merge below", "", Unit::SPEED;
    /// The area of a layer that is removed.
    AREA: "Area", "", Unit::new("px", 0), Role::Rejected;
    /// The smallest share of the picture that a layer covers.
    MIN_AREA: "Smallest area", "", Unit::PERCENT;
    /// The number of pixels that change their layer.
    CHANGES: "Changes", "", Unit::count("pixel"), Role::Candidate;
    /// The number of pixels without a layer.
    LEFT: "Without a layer", "", Unit::count("pixel"), Role::Error;
    /// The largest residual with which a pixel belongs to a layer.
    TOLERANCE: "Tolerance", "", Unit::SPEED;
    /// The number of connected pixels that become a layer.
    SPLIT: "Split off", "", Unit::count("connected pixel"), Role::Result;
    /// The number of pixels of the layer.
    PIXELS: "Pixels", "", Unit::count("pixel");
    /// The affine motion of the layer along x.
    U: "u", "u", Unit::SPEED, Role::Result;
    /// The affine motion of the layer along y.
    V: "v", "v", Unit::SPEED, Role::Result;
    /// A component of an affine motion at the origin.
    OFFSET: "", "", Unit::SPEED, Role::Result;
    /// The slope of the motion along x.
    SLOPE_X: "", "", SLOPE, Role::Result;
    /// The slope of the motion along y.
    SLOPE_Y: "", "", SLOPE, Role::Result;
    /// The number of iterations.
    ITERATIONS: "Iterations", "", Unit::count("iteration");
}

cases! { pub(super) over value, shared;
    OPENING: "A rigid surface that moves in front of the camera has, to a good approximation, an affine flow: six parameters for \
              all its pixels. Layers are such affine motions, each with the pixels that it explains.",
    HYPOTHESES: "Affine motions of its blocks are the first hypotheses.",
    FITTED: "Block at {block}: affine motion by least squares, {motion} in its middle, with a residual of {residual}.",
    HYPOTHESIS: "At most {max_residual:bare}: a hypothesis.",
    ACROSS: "Above {max_residual:bare}: the block lies across a motion boundary, where no single affine motion fits, so it is \
             {rejected|rejected}.",
    CLUSTERED: "The {hypotheses} of blocks form {clusters} in the space of their parameters. These are scaled so that the \
                squared distance of two motions is their mean squared difference over the picture.",
    MERGED: "Layers {layer} and {other} differ by {difference} over their pixels, below {merge_below:bare}: one motion explains \
             both, so they are merged.",
    REMOVED: "Layer {layer} has only {area}, less than {min_area} of the picture. So small a support does not determine an \
              affine motion, and the layer is removed.",
    ASSIGNED: "Each pixel goes to the layer of the smallest residual: {changes} change their layer, and {left} have a residual \
               above {tolerance} in all layers.",
    SPLIT: "{split} that no layer explains are split off as layer {layer}: a motion that the blocks or the clusters have missed.",
    EMPTY: "Layer {layer} has no pixels, so its motion stays as it is.",
    REFITTED: "Layer {layer}, fitted to its {pixels}: u = {u:bare}, v = {v:bare} px/frame. Residual {residual}, before \
               {residual_before:bare}.",
    LABELLED: "The layers of frame {frame} no longer change after {iterations}.",
}
