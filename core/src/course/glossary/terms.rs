//! The terms themselves, sorted by name.

use super::Chapter::{
    DifferentialMethods, DynamicScenes, Evaluation, InterestPoints, KalmanFilters, MotionVectors, MovingObjects,
    MultipleObjects, Trajectories,
};
use super::{Chapter, Term};

/// Every term of the course, sorted by name without regard to case.
pub static GLOSSARY: &[Term] = &[
    term(
        Trajectories,
        "active contour",
        &["active contours", "snake", "snakes"],
        "A curve that moves to minimise an energy of its smoothness and of the image gradients under it, used to \
        outline and follow an object.",
    ),
    term(
        DynamicScenes,
        "activity recognition",
        &["human activity recognition", "action recognition"],
        "The classification of human activities in a video from the motion of bodies or from trajectories.",
    ),
    term(
        MotionVectors,
        "adaptive rood pattern search",
        &["adaptive rood", "ARPS", "rood pattern"],
        "A block search that first tests a cross with the length of the predicted motion vector as arm length, and \
        the predictor itself, and then refines with a small cross.",
    ),
    term(
        Evaluation,
        "adjusted Rand index",
        &["ARI", "Rand index"],
        "The share of pairs of pixels that two segmentations both keep together or both separate, corrected for chance: 1 for equal \
        segmentations, about 0 for random ones.",
    ),
    term(
        DynamicScenes,
        "affine model",
        &["affine motion", "affine transformation", "affine warp"],
        "A motion model with six parameters that keeps parallel lines parallel: translation, rotation, scale and \
        shear.",
    ),
    term(
        Evaluation,
        "angular error",
        &["average angular error", "AAE"],
        "The angle between the vectors (u, v, 1) of the estimated and the true flow, which is defined for zero motion \
        too.",
    )
    .symbol("AE"),
    term(
        DifferentialMethods,
        "anisotropic smoothing",
        &["anisotropic diffusion"],
        "Smoothing that follows image edges instead of crossing them, so that flow discontinuities stay sharp.",
    ),
    term(
        DynamicScenes,
        "anomaly detection",
        &[],
        "The detection of motion that differs from the motion learned as normal for a scene.",
    ),
    term(
        DifferentialMethods,
        "aperture problem",
        &[],
        "The ambiguity of motion at a straight edge: a small window shows only the motion perpendicular to the edge, \
        not the motion along it.",
    ),
    term(
        MultipleObjects,
        "assignment problem",
        &["assignment", "assignments", "linear assignment", "optimal assignment"],
        "The choice of pairs of tracks and detections with the lowest total cost, each used at most once.",
    ),
    term(
        KalmanFilters,
        "autocorrelation",
        &["whiteness", "whiteness test"],
        "The correlation of a sequence with itself at a lag; that of the innovations of a consistent filter is zero at \
        all lags but 0.",
    ),
    term(
        Trajectories,
        "back-projection",
        &["back-projected histogram"],
        "The image in which each pixel has the value of its histogram bin in the model of an object, high where the colours of the object are.",
    ),
    term(
        MovingObjects,
        "background model",
        &["background models", "background image"],
        "The description of each pixel without moving objects, for instance by a mean, or by a mean and a variance, \
        with which frames are compared.",
    ),
    term(
        MovingObjects,
        "background subtraction",
        &["background differencing"],
        "The detection of moving objects as the pixels of a frame that differ from a background model.",
    ),
    term(
        Trajectories,
        "balloon force",
        &["balloon pressure", "balloon energy"],
        "A pressure along the normal of an active contour that inflates or deflates it where no edge acts on it.",
    ),
    term(
        InterestPoints,
        "baseline",
        &["stereo baseline"],
        "The distance between the centres of projection of two cameras: a longer one makes depths more accurate, but views more different.",
    )
    .symbol("B"),
    term(
        Trajectories,
        "bending energy",
        &["rigidity"],
        "The part of the energy of an active contour that grows with its curvature and keeps it smooth.",
    ),
    term(
        Trajectories,
        "Bhattacharyya coefficient",
        &[],
        "The similarity of two histograms p and q, the sum of √(p q) over all bins: 1 for equal histograms, 0 for those without a common bin.",
    )
    .symbol("ρ"),
    term(
        MotionVectors,
        "bilinear interpolation",
        &["bilinear"],
        "Interpolation from the four nearest pixels, linear in x and in y.",
    ),
    term(
        MultipleObjects,
        "birth",
        &["track birth", "track initiation"],
        "The start of a new track from a detection that was assigned to no track.",
    ),
    term(
        MovingObjects,
        "blob",
        &["blobs"],
        "A connected component of the foreground mask, taken as the image of one object.",
    ),
    term(
        InterestPoints,
        "blob detector",
        &["blob detection", "Laplacian of Gaussian", "difference of Gaussians"],
        "A detector of bright or dark spots and their scale, as maxima of the Laplacian or the determinant of the \
        Hessian.",
    ),
    term(
        Trajectories,
        "blob tracking",
        &["blob tracker", "region-based tracking"],
        "Tracking of connected foreground regions by associating the blobs of consecutive frames.",
    ),
    term(
        MotionVectors,
        "block",
        &["blocks", "macroblock", "macroblocks"],
        "A square of pixels that is assumed to move by one displacement.",
    ),
    term(
        MotionVectors,
        "block matching",
        &["block-matching", "block matching algorithm", "block search"],
        "Motion estimation that divides frame t into blocks and finds for each the displacement with the lowest cost \
        in frame t + 1.",
    ),
    term(
        MotionVectors,
        "border treatment",
        &["border handling", "replicate border"],
        "The rule for windows and filters that reach beyond the image: stay inside, replicate the border pixels, or \
        mirror the image.",
    ),
    term(MovingObjects, "bounding box", &["bounding boxes"], "The smallest upright rectangle that contains an object."),
    term(
        DifferentialMethods,
        "brightness constancy",
        &["brightness constancy assumption", "brightness constancy equation"],
        "The assumption that a scene point keeps its gray level while it moves: I(x + u, y + v, t + 1) = I(x, y, t).",
    ),
    term(
        MultipleObjects,
        "ByteTrack",
        &[],
        "A tracker that associates detections with high scores first and offers the remaining tracks the detections \
        with low scores.",
    ),
    term(
        DynamicScenes,
        "camera path",
        &["path of the camera"],
        "The motions of the background between consecutive frames, chained from the first frame on.",
    ),
    term(
        MovingObjects,
        "camouflage",
        &[],
        "The failure of detection where an object has the same gray level or colour as the background behind it.",
    ),
    term(
        Trajectories,
        "CAMShift",
        &[],
        "Mean-shift tracking on a colour back-projection, with a window that also adapts its size and orientation.",
    ),
    term(
        MotionVectors,
        "candidate",
        &["candidates", "candidate displacement", "candidate displacements"],
        "A displacement that a search tests by computing its cost.",
    ),
    term(
        Evaluation,
        "causal",
        &["real time", "real-time"],
        "Using only the current and earlier frames, as in real time.",
    ),
    term(
        InterestPoints,
        "census transform",
        &["census strings", "census string", "census"],
        "A string of bits for each pixel that says which pixels of its window are darker, so that neither brightness nor contrast matters.",
    ),
    term(
        DifferentialMethods,
        "central difference",
        &["central differences"],
        "The derivative estimate (f(x + 1) − f(x − 1)) / 2.",
    ),
    term(
        MovingObjects,
        "centroid",
        &["centroids", "centre of mass", "center of mass"],
        "The mean position of the pixels of a region.",
    ),
    term(
        DynamicScenes,
        "change detection",
        &["motion detection"],
        "The decision, pixel by pixel, whether a frame differs from a reference by more than noise explains.",
    ),
    term(
        Trajectories,
        "Chan–Vese model",
        &["Chan–Vese", "Chan and Vese", "active contour without edges", "contour without edges"],
        "A partition of an image into two regions with different means and a short contour between them, which needs \
        no edges.",
    ),
    term(
        KalmanFilters,
        "chi-squared distribution",
        &["χ²", "χ² distribution", "chi-square distribution", "chi-squared"],
        "The distribution of a sum of n squared standard normal variables, from which gates and consistency bands are \
        taken.",
    )
    .symbol("χ²"),
    term(
        MovingObjects,
        "closing",
        &["morphological closing"],
        "A dilation followed by an erosion, which fills gaps and holes narrower than the structuring element.",
    ),
    term(MultipleObjects, "clutter", &["false detection", "false detections"], "Detections that come from no object."),
    term(
        MotionVectors,
        "coarse-to-fine",
        &["coarse to fine", "multi-resolution", "multiresolution", "multiscale"],
        "The strategy of estimating motion at the coarsest level of a pyramid and refining it level by level.",
    ),
    term(
        MultipleObjects,
        "coasting",
        &["coasts", "coasting track", "coasting tracks"],
        "The continuation of a track by prediction alone while no detection is assigned to it.",
    ),
    term(
        Trajectories,
        "colour histogram",
        &["color histogram", "colour histograms", "color histograms"],
        "The numbers of pixels of a region in each colour class, an appearance model that does not depend on shape or \
        rotation.",
    ),
    term(
        MultipleObjects,
        "combined innovation",
        &["combined innovations"],
        "Innovation of several measurements in JPDA, each weighted by the probability of its association with the track.",
    ),
    term(
        DifferentialMethods,
        "combined local–global method",
        &["CLG", "combined local-global", "combined local global"],
        "A variational method that replaces the gradient constraint of a single pixel in Horn–Schunck by the \
        constraints of a Gaussian window, as in Lucas–Kanade.",
    ),
    term(
        Evaluation,
        "complexity",
        &["computational complexity", "time complexity"],
        "The growth of the number of operations with the size of the problem, for full search proportional to (2p + \
        1)² per block.",
    ),
    term(
        DifferentialMethods,
        "condition number",
        &["conditioning", "ill-conditioned", "well-conditioned"],
        "The ratio of the largest to the smallest eigenvalue of a symmetric matrix, which limits how much errors of \
        the data are magnified in the solution.",
    )
    .symbol("κ"),
    term(
        MultipleObjects,
        "confirmed track",
        &["confirmed", "confirmed tracks", "min hits", "confirmation"],
        "A track that was matched in enough frames to be reported.",
    ),
    term(
        MovingObjects,
        "connected component",
        &[
            "connected components",
            "connected component labelling",
            "connected-component labelling",
            "component labelling",
        ],
        "A maximal set of foreground pixels in which every two are joined by a path of neighbouring foreground pixels.",
    ),
    term(
        MovingObjects,
        "connectivity",
        &["4-connectivity", "8-connectivity", "4-connected", "8-connected"],
        "The rule for which pixels are neighbours: the 4 that share an edge or the 8 that share an edge or a corner.",
    ),
    term(
        KalmanFilters,
        "consistency",
        &["filter consistency"],
        "The agreement of the actual errors of a filter with the covariance that it computes, tested by NIS and NEES.",
    ),
    term(
        KalmanFilters,
        "constant acceleration model",
        &["constant acceleration", "CA model"],
        "A motion model with position, velocity and acceleration as state, and random changes of the acceleration as \
        process noise.",
    ),
    term(
        KalmanFilters,
        "constant velocity model",
        &["constant velocity", "CV model", "constant-velocity model"],
        "A motion model with position and velocity as state, and random accelerations as process noise.",
    ),
    term(
        DifferentialMethods,
        "constraint line",
        &["constraint lines"],
        "The line of all flow vectors (u, v) that satisfy the gradient constraint of one pixel; its normal is the \
        image gradient.",
    ),
    term(
        KalmanFilters,
        "control input",
        &[],
        "A known influence on the state, such as a commanded acceleration, that enters the prediction.",
    )
    .symbol("u"),
    term(
        Trajectories,
        "control point",
        &["control points"],
        "A point on an edge of a model, with the normal of its projected edge along which the edge in the picture is searched.",
    ),
    term(
        MotionVectors,
        "convergence",
        &["converge", "converges", "converged"],
        "The state of an iteration in which further steps change the result by less than a tolerance.",
    ),
    term(
        Trajectories,
        "convolutional neural network",
        &["CNN", "CNNs", "convolutional neural networks", "learned method", "learned methods", "deep learning"],
        "A network of learned filters in layers, which detects objects or regresses flow from images after training on \
        labelled examples.",
    ),
    term(
        KalmanFilters,
        "coordinated turn model",
        &["coordinated turn", "turn rate", "CT model"],
        "A motion model for an object that turns at constant speed and constant turn rate.",
    )
    .symbol("ω"),
    term(
        InterestPoints,
        "corner",
        &["corners", "corner point"],
        "A point with a neighbourhood that changes in every direction of shift, so that both eigenvalues of the \
        structure tensor are large.",
    ),
    term(
        InterestPoints,
        "corner response",
        &["Harris response", "corner measure", "corner strength"],
        "The number computed from the structure tensor T that ranks corners, for Harris det T − k (tr T)².",
    )
    .symbol("R"),
    term(
        Trajectories,
        "correlation filter",
        &["correlation filters", "KCF", "MOSSE"],
        "A filter trained on the target so that its response peaks where the target is in the next frame.",
    ),
    term(
        InterestPoints,
        "correspondence",
        &["correspondences", "correspondence problem"],
        "A pair of image points in two frames that show the same scene point.",
    ),
    term(
        MotionVectors,
        "cost",
        &["costs", "matching cost", "cost function"],
        "The number that a search or an assignment minimises, for a block and a candidate a dissimilarity such as the \
        SAD.",
    ),
    term(
        MultipleObjects,
        "cost matrix",
        &["cost matrices", "association matrix"],
        "The matrix of the costs of all pairs of track and detection, with pairs outside the gate forbidden.",
    ),
    term(
        MotionVectors,
        "cost surface",
        &["error surface", "cost surfaces"],
        "The cost as a function of the displacement (u, v) over the search window; its minimum is the motion vector.",
    ),
    term(
        InterestPoints,
        "cost volume",
        &["disparity space image"],
        "The matching costs of all pixels and all disparities, a box over x, y and d, out of which one disparity is chosen for each pixel.",
    )
    .symbol("C(p, d)"),
    term(
        Trajectories,
        "counting line",
        &["counting lines", "virtual line", "virtual lines", "line crossing"],
        "A line drawn in the image at which crossings of trajectories are counted.",
    ),
    term(
        KalmanFilters,
        "covariance matrix",
        &["covariance", "covariances", "error covariance"],
        "The symmetric matrix of the variances of the state's components and of their covariances, drawn as an \
        ellipse.",
    )
    .symbol("P"),
    term(
        InterestPoints,
        "cross-check",
        &["cross check", "mutual nearest neighbours"],
        "The rejection of a match unless both descriptors are the nearest neighbours of each other.",
    ),
    term(
        InterestPoints,
        "cross-power spectrum",
        &["cross-power spectra"],
        "The product of the spectrum of one picture with the complex conjugate of that of another: its phase \
        is the difference of their phases.",
    ),
    term(
        Evaluation,
        "D1",
        &[],
        "The share of pixels with a disparity that is unknown, or wrong by more than 3 px and by more than 5 % of the truth: the measure of stereo of the KITTI benchmark.",
    ),
    term(
        MultipleObjects,
        "data association",
        &["association", "associate", "associates", "associated"],
        "The decision which detection belongs to which track.",
    ),
    term(
        DifferentialMethods,
        "data term",
        &["data terms"],
        "The part of an energy that penalises violations of brightness constancy.",
    )
    .symbol("E_D"),
    term(
        Trajectories,
        "degeneracy",
        &["degenerate weights"],
        "The concentration of nearly all weight on few particles after some updates, measured by the effective sample size and removed by resampling.",
    ),
    term(
        MultipleObjects,
        "deleted track",
        &["deleted", "deletion", "deleted tracks", "max age"],
        "A track that ended because it was not matched for more frames than the maximum age.",
    ),
    term(
        DynamicScenes,
        "depth",
        &["depth map", "depth maps"],
        "The distance of a scene point from the camera along the optical axis.",
    ),
    term(
        InterestPoints,
        "descriptor",
        &["descriptors", "feature descriptor"],
        "A vector that describes the neighbourhood of a keypoint such that corresponding points have close vectors.",
    ),
    term(
        MotionVectors,
        "diamond search",
        &["diamond pattern"],
        "A block search that moves a diamond of nine candidates downhill until its centre is the minimum, and finishes \
        with a small diamond of four.",
    ),
    term(
        MovingObjects,
        "difference image",
        &["difference images", "absolute difference image"],
        "The absolute difference of two frames, or of a frame and the background model, pixel by pixel.",
    ),
    term(
        MovingObjects,
        "dilation",
        &["dilations", "dilate", "dilated"],
        "The morphological operation that sets every pixel under a structuring element placed on a foreground pixel; \
        regions grow.",
    ),
    term(
        InterestPoints,
        "direct linear transformation",
        &["DLT"],
        "A linear least-squares fit of a homography or another projective relation from correspondences, in \
        normalised coordinates.",
    ),
    term(
        DynamicScenes,
        "disocclusion",
        &["disocclusions", "disoccluded", "uncovered background"],
        "The uncovering of background that an object hid in the frame before, so that it has no correspondence in \
        that frame.",
    ),
    term(
        DynamicScenes,
        "disparity",
        &["disparities", "disparity map"],
        "The horizontal displacement of a scene point between the two images of a rectified stereo pair, inversely \
        proportional to its depth.",
    )
    .symbol("d"),
    term(
        MotionVectors,
        "displacement",
        &["displacements"],
        "The change of position of a block, pixel or feature from frame t to frame t + 1, in px to the right (u) and \
        down (v).",
    )
    .symbol("(u, v)"),
    term(
        Trajectories,
        "drift",
        &["drifts", "tracker drift"],
        "The slow departure of a tracker from its target, because small errors of each frame add up.",
    ),
    term(
        Trajectories,
        "drift correction",
        &["drift-corrected"],
        "The alignment of the first template from where the updated one was found, so that errors of the updates do \
        not add up.",
    ),
    term(
        DifferentialMethods,
        "dual variable",
        &["dual variables", "dual update"],
        "The variable p, one vector per pixel with |p| ≤ 1, by which a primal–dual method writes total variation as a \
        maximum over p.",
    )
    .symbol("p"),
    term(Trajectories, "dwell time", &["dwell times"], "The time that an object stays inside a zone."),
    term(
        DynamicScenes,
        "dynamic scene analysis",
        &["dynamic scene", "dynamic scenes"],
        "The interpretation of motion in an image sequence: detection, segmentation, tracking and recognition of \
        moving objects.",
    ),
    term(
        MotionVectors,
        "early termination",
        &[],
        "The end of a block search as soon as the cost of a candidate, such as a predictor, is below a threshold.",
    ),
    term(
        InterestPoints,
        "edge",
        &["edges"],
        "A line along which the gray level changes strongly across and hardly along, so that one eigenvalue of the \
        structure tensor is large and one small.",
    ),
    term(
        Trajectories,
        "edge strength",
        &["edge map", "edge energy"],
        "The gradient magnitude of a smoothed image as a share of the steepest, which attracts an active contour.",
    ),
    term(
        Trajectories,
        "effective sample size",
        &[],
        "The number of particles of equal weight that represent a distribution as well as the weighted ones do, 1 divided by the sum of the squared weights.",
    ),
    term(
        DynamicScenes,
        "egomotion",
        &["ego-motion", "camera motion"],
        "The motion of the camera itself, which makes the whole static scene move in the image.",
    ),
    term(
        DifferentialMethods,
        "eigenvalue",
        &["eigenvalues", "smaller eigenvalue", "larger eigenvalue", "smallest eigenvalue", "minimum eigenvalue"],
        "A factor by which a matrix stretches one of its eigenvectors; the two of the structure tensor measure how \
        much gradient there is in each direction.",
    )
    .symbol("λ₁, λ₂"),
    term(
        DifferentialMethods,
        "eigenvector",
        &["eigenvectors"],
        "A direction that a matrix only stretches; for the structure tensor, the direction of strongest gradient or \
        the one perpendicular to it.",
    ),
    term(
        InterestPoints,
        "eight-point algorithm",
        &["eight-point"],
        "The linear estimation of the fundamental matrix from eight or more matches in normalised coordinates, \
        followed by the constraint of rank 2.",
    ),
    term(
        Trajectories,
        "elastic energy",
        &["elasticity"],
        "The part of the energy of an active contour that grows with the distances of its points and contracts it.",
    ),
    term(
        Evaluation,
        "endpoint error",
        &["end-point error", "EPE", "AEE", "average endpoint error", "mean endpoint error"],
        "The Euclidean distance of the estimated and the true flow vector, in px.",
    ),
    term(
        DifferentialMethods,
        "energy",
        &["energies", "energy functional", "energy function"],
        "The quantity that a variational method minimises: the data term plus the weighted smoothness term, summed \
        over all pixels.",
    )
    .symbol("E"),
    term(
        MotionVectors,
        "entropy",
        &[],
        "The smallest mean number of bits per symbol with which data of a given distribution can be coded, −Σ p log₂ \
        p.",
    )
    .symbol("H"),
    term(
        Trajectories,
        "Epanechnikov kernel",
        &[],
        "The weight 1 − r² of a pixel at distance r from the centre of an ellipse with radius 1, so that pixels near its border count little.",
    ),
    term(
        InterestPoints,
        "epipolar constraint",
        &["epipolar geometry", "epipolar line", "epipolar lines"],
        "The condition x′^T F x = 0: the match x′ of a point x of a static scene lies on its epipolar line F x.",
    )
    .symbol("x′^T F x = 0"),
    term(
        InterestPoints,
        "epipole",
        &["epipoles"],
        "The image of the other camera's centre, in which all epipolar lines meet.",
    ),
    term(
        MovingObjects,
        "erosion",
        &["erosions", "erode", "eroded"],
        "The morphological operation that keeps only the pixels around which the whole structuring element is \
        foreground; regions shrink.",
    ),
    term(
        KalmanFilters,
        "error ellipse",
        &["covariance ellipse", "uncertainty ellipse", "error ellipses"],
        "The ellipse of all positions at the same Mahalanobis distance from the estimate, here drawn for a stated \
        probability.",
    ),
    term(
        Evaluation,
        "error rate",
        &["outlier rate", "bad pixels", "Fl-all"],
        "The share of pixels with an endpoint error above a limit, such as 3 px and 5 % of the true flow in KITTI.",
    ),
    term(
        InterestPoints,
        "essential matrix",
        &[],
        "The fundamental matrix of calibrated cameras, composed of their relative rotation and translation direction.",
    )
    .symbol("E"),
    term(
        DifferentialMethods,
        "Euler–Lagrange equations",
        &["Euler-Lagrange", "Euler–Lagrange equation"],
        "The equations that a minimum of an energy functional satisfies, one for u and one for v at every pixel.",
    ),
    term(
        DynamicScenes,
        "expectation maximisation",
        &["expectation maximization", "expectation step", "maximisation step"],
        "An iteration that fits a mixture by computing responsibilities from the components and components from the \
        responsibilities in turn, and never lowers the likelihood.",
    ),
    term(
        KalmanFilters,
        "extended Kalman filter",
        &["EKF"],
        "A Kalman filter for nonlinear models, which are linearised at the current estimate.",
    ),
    term(
        Trajectories,
        "external energy",
        &["external force", "external forces"],
        "The part of the energy of an active contour that the image gives, low where the contour is to lie.",
    ),
    term(
        Evaluation,
        "failure",
        &["failures"],
        "A frame in which the overlap of a tracked region with the true box falls to 0, after which a tracker would have to be started anew.",
    ),
    term(
        Evaluation,
        "false negative",
        &["false negatives", "missed detection", "missed detections", "FN"],
        "An object or pixel of the ground truth that was not detected.",
    ),
    term(
        Evaluation,
        "false positive",
        &["false positives", "false alarm", "false alarms", "FP"],
        "A detection that matches nothing in the ground truth.",
    ),
    term(
        DifferentialMethods,
        "Farnebäck's method",
        &["Farneback", "Farnebäck", "polynomial expansion"],
        "Dense flow from quadratic polynomials fitted to the neighbourhood of each pixel in both frames and compared \
        by their linear coefficients.",
    ),
    term(
        InterestPoints,
        "FAST detector",
        &["FAST", "features from accelerated segment test"],
        "A corner detector that compares a pixel with a circle of 16 pixels and accepts it if enough contiguous ones \
        are all brighter or all darker.",
    ),
    term(
        DynamicScenes,
        "feathering",
        &["feathered mean", "feathered"],
        "The blending of overlapping pictures with weights that fall to 0 at the border of each, so that seams vanish.",
    ),
    term(
        InterestPoints,
        "feature",
        &["features", "image feature"],
        "A point that can be found again in another frame because its neighbourhood is distinctive.",
    ),
    term(
        Trajectories,
        "feature track",
        &["feature tracks", "point trajectory", "point trajectories", "feature trajectory"],
        "The positions of one feature in consecutive frames.",
    ),
    term(
        Trajectories,
        "feature tracking",
        &["feature-based tracking", "point tracking"],
        "The following of interest points from frame to frame by small displacements of their neighbourhoods.",
    ),
    term(
        DynamicScenes,
        "field of view",
        &[],
        "The part of the scene that the camera sees, as an angle or as the extent of the picture.",
    ),
    term(
        KalmanFilters,
        "filter divergence",
        &["filter diverges"],
        "The growth of a filter's errors far beyond its covariance, usually because the process noise is set too \
        small.",
    ),
    term(
        DifferentialMethods,
        "fixed-point iteration",
        &["fixed-point iterations"],
        "An iteration that computes new values from an equation of the form x = f(x) until they no longer change.",
    ),
    term(
        DifferentialMethods,
        "flow discontinuity",
        &[
            "flow discontinuities",
            "motion boundary",
            "motion boundaries",
            "motion discontinuity",
            "motion discontinuities",
        ],
        "A jump of the flow at the border of two motions, which a quadratic smoothness term blurs and total variation \
        preserves.",
    ),
    term(
        DynamicScenes,
        "focus of expansion",
        &["FOE"],
        "The image point from which all motion vectors point away when the camera moves forward through a static \
        scene.",
    ),
    term(
        MovingObjects,
        "foreground",
        &["foreground mask", "foreground pixel", "foreground pixels", "foreground masks"],
        "The pixels that a detector assigns to moving objects.",
    ),
    term(
        Trajectories,
        "forward–backward check",
        &["forward–backward error", "forward–backward consistency"],
        "The tracking of a point to the next frame and back again; if it does not return to its start within a \
        tolerance, it is rejected.",
    ),
    term(
        MotionVectors,
        "four-step search",
        &[],
        "A block search that moves a 5×5 pattern of nine candidates, 2 px apart, toward the minimum and then refines \
        with a 3×3 pattern.",
    ),
    term(
        InterestPoints,
        "Fourier transform",
        &["Fourier transforms", "fast Fourier transform", "FFT"],
        "The decomposition of a signal into frequencies with magnitude and phase; a correlation becomes a \
        product of spectra.",
    ),
    term(
        Evaluation,
        "fragmentation",
        &["fragmentations"],
        "The number of times that the track of a true object is interrupted and resumed.",
    ),
    term(
        DynamicScenes,
        "frame",
        &["frames"],
        "One image of a sequence; here frame t is matched with frame t + 1, and frames are counted from 0.",
    ),
    term(
        MovingObjects,
        "frame differencing",
        &["frame difference", "temporal differencing"],
        "The detection of motion as pixels with a gray level that changes by more than a threshold between \
        consecutive frames.",
    ),
    term(
        DynamicScenes,
        "frame rate",
        &["frames per second", "fps"],
        "The number of frames per second, which turns a displacement in px per frame into a velocity in px per second.",
    ),
    term(
        MotionVectors,
        "full search",
        &["sequential search", "exhaustive search", "sequential search algorithm"],
        "The test of every displacement in the search window, which always finds its global minimum of the cost.",
    ),
    term(
        InterestPoints,
        "fundamental matrix",
        &[],
        "The 3×3 matrix F of rank 2 that maps a point to its epipolar line in the other image.",
    )
    .symbol("F"),
    term(Evaluation, "F₁ score", &["F1 score", "F-measure", "F₁", "F1"], "The harmonic mean of precision and recall."),
    term(
        KalmanFilters,
        "gate",
        &["gating", "gating threshold", "validation gate", "gates"],
        "The region around the predicted measurement, bounded by a Mahalanobis distance, outside which measurements \
        are rejected.",
    ),
    term(
        MotionVectors,
        "Gaussian filter",
        &["Gaussian smoothing", "Gaussian blur", "presmoothing"],
        "A low-pass filter with weights that follow a Gaussian of standard deviation σ; pyramids and derivatives use \
        it to suppress noise.",
    )
    .symbol("σ"),
    term(
        DifferentialMethods,
        "Gauss–Seidel method",
        &["Gauss-Seidel"],
        "An iterative solver that updates one unknown after the other and uses each new value at once.",
    ),
    term(
        MovingObjects,
        "ghost",
        &["ghosts"],
        "A region marked as foreground without an object, because an object was part of the background model and has \
        left.",
    ),
    term(
        MultipleObjects,
        "global hypothesis",
        &["global hypotheses"],
        "A set of compatible track hypotheses, in which no detection belongs to two, that explains all detections of a cluster; its probability follows from its scores.",
    ),
    term(
        MotionVectors,
        "global minimum",
        &["global minima", "global optimum"],
        "The lowest cost in the whole search window.",
    ),
    term(
        DynamicScenes,
        "global motion",
        &["global motion estimation", "dominant motion"],
        "A single motion model, for instance affine or a homography, for the whole image, usually caused by the \
        camera.",
    ),
    term(
        MultipleObjects,
        "global nearest neighbour",
        &["GNN", "global nearest neighbor"],
        "Data association by the assignment with the lowest total cost of one frame.",
    ),
    term(
        DifferentialMethods,
        "gradient constraint",
        &[
            "gradient constraints",
            "optical flow constraint",
            "optical flow equation",
            "optical flow constraint equation",
            "gradient constraint equation",
        ],
        "The linear equation I_x u + I_y v + I_t = 0 of each pixel, the first-order form of brightness constancy.",
    )
    .symbol("I_x u + I_y v + I_t = 0"),
    term(
        Trajectories,
        "gradient vector flow",
        &["GVF"],
        "An external force for active contours: the gradient of the edge strength diffused into flat parts of the \
        image, so that edges attract from farther.",
    ),
    term(
        DynamicScenes,
        "graph-based segmentation",
        &["graph-based merging", "internal difference"],
        "A segmentation that goes through the edges between neighbouring pixels in ascending order of their differences and merges two \
        regions where the difference across the edge is small against the differences inside both.",
    ),
    term(
        DynamicScenes,
        "gray level",
        &["gray levels", "gray value", "gray values", "intensity", "intensities"],
        "The brightness of a pixel, here from 0 (black) to 255 (white).",
    )
    .symbol("I"),
    term(
        Trajectories,
        "greedy active contour",
        &["greedy contour", "greedy contours", "greedy active contours"],
        "An active contour with points that move one after the other to the pixel of their neighbourhood with the \
        lowest energy.",
    ),
    term(
        MultipleObjects,
        "greedy assignment",
        &["greedy", "nearest neighbour association", "greedy matching"],
        "An assignment that repeatedly takes the cheapest remaining pair, which is fast but need not have the lowest \
        total cost.",
    ),
    term(
        Evaluation,
        "ground truth",
        &["reference flow", "true flow"],
        "The known correct flow, mask or boxes with which results are compared.",
    ),
    term(
        InterestPoints,
        "guided matching",
        &["match by guidance"],
        "Matching that compares a keypoint only with those near its epipolar line or its predicted place, so that the ratio \
        test rejects fewer right matches.",
    ),
    term(
        InterestPoints,
        "Haar wavelet",
        &["Haar wavelets"],
        "A filter of two boxes side by side, one positive and one negative; its response is a difference of means and \
        costs six values of an integral image.",
    ),
    term(
        InterestPoints,
        "half-occlusion",
        &["half-occluded", "half-occlusions"],
        "The part of a scene that one of two views shows and the other does not, beside the edge of a nearer object; it has no match.",
    ),
    term(
        InterestPoints,
        "Hamming distance",
        &["Hamming distances"],
        "The number of bits in which two strings of the same length differ.",
    ),
    term(
        InterestPoints,
        "Hann window",
        &["Hann windows"],
        "A weight that falls from 1 in the middle of a picture to 0 at its border along half a wave of the \
        cosine, so that the periodic continuation has no jumps.",
    ),
    term(
        InterestPoints,
        "Harris detector",
        &["Harris corner detector", "Harris", "Harris corner", "Harris corners"],
        "A corner detector that takes local maxima of det T − k (tr T)² of the structure tensor T, which needs no \
        eigenvalues.",
    ),
    term(
        Trajectories,
        "heading",
        &["headings", "direction of motion"],
        "The direction of a velocity as an angle from the x axis (right) towards the y axis (down), as all angles on a picture: 90° is down.",
    ),
    term(
        InterestPoints,
        "Hessian",
        &["Hessian matrix", "Hessians"],
        "The matrix of the second derivatives of a function; in a least-squares problem approximated by the \
        products of first derivatives (Gauss–Newton).",
    ),
    term(
        InterestPoints,
        "Hessian determinant",
        &["determinant of the Hessian"],
        "The product of the second derivatives along both axes minus the square of the mixed one, which is large and \
        positive at blobs.",
    ),
    term(
        MotionVectors,
        "hexagon search",
        &["hexagonal search", "hexagon-based search"],
        "A block search that moves a hexagon of seven candidates downhill, with three new ones per move, and finishes \
        with four neighbours.",
    ),
    term(
        MotionVectors,
        "hierarchical search",
        &["pyramid search", "multi-resolution search", "hierarchical block matching"],
        "Block matching on a pyramid: a search where the image is small, then refinement of the doubled motion \
        vectors level by level.",
    ),
    term(Trajectories, "histogram", &["histograms"], "The numbers of values that fall into each of a set of bins."),
    term(
        DynamicScenes,
        "homography",
        &["homographies", "perspective transformation"],
        "A projective mapping with eight parameters between two images of a plane, or between two images of a camera \
        that only rotates.",
    )
    .symbol("H"),
    term(
        DifferentialMethods,
        "Horn–Schunck method",
        &["Horn-Schunck", "Horn and Schunck", "Horn–Schunck optical flow"],
        "A global method that finds the flow with the least sum of squared violations of the gradient constraint and \
        α² times squared flow gradients.",
    ),
    term(
        Evaluation,
        "HOTA",
        &["higher order tracking accuracy", "DetA", "AssA"],
        "Higher order tracking accuracy: the geometric mean of detection accuracy and association accuracy, averaged \
        over localisation thresholds.",
    ),
    term(
        MultipleObjects,
        "Hungarian algorithm",
        &["Hungarian method", "Kuhn–Munkres algorithm"],
        "The algorithm that solves the assignment problem exactly in cubic time.",
    ),
    term(
        InterestPoints,
        "hypothesis",
        &["hypotheses"],
        "A model computed from a random sample, to be tested against all matches.",
    ),
    term(
        MultipleObjects,
        "hypothesis tree",
        &["hypothesis trees", "tree of hypotheses", "track tree", "track trees"],
        "The tree of track hypotheses of one object: a branch for each detection in the gate and for a missed one, frame by frame.",
    ),
    term(
        MovingObjects,
        "hysteresis thresholding",
        &["hysteresis"],
        "Thresholding with two thresholds: pixels above the low one are kept only if they are connected to pixels \
        above the high one.",
    ),
    term(
        Evaluation,
        "identity switch",
        &["identity switches", "ID switch", "ID switches", "IDSW"],
        "A change of the track that covers a true object from one identity to another.",
    ),
    term(
        Evaluation,
        "IDF1",
        &["identity F₁", "ID F1"],
        "The F₁ score of identities: the share of frames in which tracks and true objects agree under the best \
        one-to-one pairing of whole tracks.",
    ),
    term(
        DynamicScenes,
        "illumination change",
        &[
            "illumination changes",
            "change of illumination",
            "changes of illumination",
            "lighting change",
            "lighting changes",
        ],
        "A change of brightness that is not caused by motion, which violates brightness constancy.",
    ),
    term(
        InterestPoints,
        "image alignment",
        &["image registration"],
        "The estimation of the warp that brings one whole picture into agreement with another, from their \
        gray levels.",
    ),
    term(
        DifferentialMethods,
        "image gradient",
        &["image gradients", "gradient", "gradients", "spatial gradient", "spatial derivatives"],
        "The vector of the spatial derivatives of the gray level, which points to the steepest increase and is \
        perpendicular to edges.",
    )
    .symbol("∇I"),
    term(
        DynamicScenes,
        "image noise",
        &["sensor noise", "Gaussian noise", "additive noise"],
        "Random variation of the gray levels from frame to frame that is not in the scene, described by its standard \
        deviation σ.",
    )
    .symbol("σ"),
    term(
        MotionVectors,
        "image pyramid",
        &["pyramid", "pyramids", "image pyramids", "Gaussian pyramid"],
        "A stack of images, each a smoothed copy of the one below at half its width and height; large motion becomes \
        small at the top.",
    ),
    term(
        DifferentialMethods,
        "image warping",
        &["warping", "warp", "warps", "warped", "backward warping"],
        "The resampling of frame t + 1 at positions displaced by the current flow, toward frame t, so that only an \
        increment remains to be estimated.",
    ),
    term(
        Trajectories,
        "impoverishment",
        &["sample impoverishment", "impoverished", "impoverished cloud"],
        "The loss of diversity when resampling leaves copies of few distinct particles, until the process noise spreads them again.",
    ),
    term(
        DifferentialMethods,
        "increment",
        &["increments", "flow increment"],
        "The correction of the current displacement that one linearised step computes.",
    )
    .symbol("(du, dv)"),
    term(
        KalmanFilters,
        "initialisation",
        &["initialization", "initial state"],
        "The choice of the first values of a filter, tracker or iteration, such as the first state and its \
        covariance.",
    ),
    term(
        InterestPoints,
        "inlier",
        &["inliers"],
        "A correspondence that agrees with a motion model within a tolerance.",
    ),
    term(
        KalmanFilters,
        "innovation",
        &["innovations"],
        "The difference of the measurement and the predicted measurement, ν = z − H x⁻.",
    )
    .symbol("ν"),
    term(
        KalmanFilters,
        "innovation covariance",
        &[],
        "The covariance S = H P⁻ H^T + R of the innovation: uncertainty of the prediction plus measurement noise.",
    )
    .symbol("S"),
    term(
        InterestPoints,
        "integral image",
        &["integral images", "summed-area table", "box filter", "box filters"],
        "A picture that holds at each corner the sum of all pixels above and to the left, so that the sum of any box needs \
        four of its values.",
    ),
    term(
        DifferentialMethods,
        "integration window",
        &["integration windows"],
        "The neighbourhood with gradient constraints that are solved together, often with weights that fall off from \
        its centre.",
    ),
    term(
        InterestPoints,
        "intensity centroid",
        &["intensity centroids"],
        "The mean position of a patch weighted by gray level; its direction from the centre serves as orientation of a \
        keypoint.",
    ),
    term(
        KalmanFilters,
        "interacting multiple model",
        &["IMM", "interacting modes", "mode probability", "mode probabilities"],
        "Several Kalman filters with a motion model each, the modes: in every frame their estimates are mixed by the \
        probabilities of the modes, which the likelihoods of the measurement update.",
    ),
    term(
        InterestPoints,
        "interest point",
        &["interest points", "keypoint", "keypoints", "feature point", "feature points"],
        "A distinctive, repeatable point such as a corner or blob at which motion can be measured reliably.",
    ),
    term(
        Trajectories,
        "internal energy",
        &["internal force", "internal forces"],
        "The part of the energy of an active contour that its own shape gives: elasticity and rigidity.",
    ),
    term(
        MotionVectors,
        "interpolation",
        &["interpolate", "interpolated", "interpolates"],
        "The estimation of gray levels between pixels from the surrounding pixels.",
    ),
    term(
        Evaluation,
        "intersection over union",
        &["IoU", "Jaccard index", "mean overlap", "overlap with the true box"],
        "The area that two regions share divided by the area that they cover together, from 0 to 1.",
    ),
    term(
        InterestPoints,
        "inverse compositional algorithm",
        &["inverse compositional"],
        "An image alignment that applies the increment to the picture at rest and composes its inverse with \
        the warp, so that derivatives and Hessian are computed only once.",
    ),
    term(
        Evaluation,
        "IoU threshold",
        &["IoU thresholds"],
        "The smallest intersection over union at which a detection counts as matching.",
    ),
    term(
        DifferentialMethods,
        "iteration",
        &["iterations"],
        "One repetition of an update step of a method that approaches its solution gradually.",
    ),
    term(
        DifferentialMethods,
        "Jacobi method",
        &["Jacobi", "Jacobi iteration"],
        "An iterative solver that computes all new values from the values of the iteration before.",
    ),
    term(
        DynamicScenes,
        "jitter",
        &["camera shake"],
        "Fast changes of a path from frame to frame, measured by its second differences.",
    ),
    term(
        MultipleObjects,
        "joint event",
        &["joint events", "feasible joint event", "feasible joint events"],
        "An assignment of all detections of a cluster of tracks to their origins, in which no detection and no track is used twice.",
    ),
    term(
        KalmanFilters,
        "Joseph form",
        &[],
        "The covariance update (I − KH) P (I − KH)^T + K R K^T, which stays symmetric and positive definite under \
        rounding.",
    ),
    term(
        MultipleObjects,
        "JPDA",
        &["joint probabilistic data association"],
        "Joint probabilistic data association: updates each track with all detections in its gate, weighted by the \
        probability of each association.",
    ),
    term(
        DynamicScenes,
        "k-means",
        &["k-means clustering", "k-means++"],
        "A clustering that assigns each point to the nearest of k averages and moves each average to its points, in turn, \
        until nothing changes.",
    ),
    term(
        KalmanFilters,
        "Kalman filter",
        &["Kalman filters", "Kalman filtering"],
        "A recursive estimator that alternates the prediction of a state by a linear motion model with its update by \
        noisy measurements, and is optimal for Gaussian noise.",
    ),
    term(
        KalmanFilters,
        "Kalman gain",
        &["gain matrix"],
        "The matrix K = P⁻ H^T S⁻¹ that weighs the innovation in the update: large when the prediction is less certain \
        than the measurement.",
    )
    .symbol("K"),
    term(
        KalmanFilters,
        "Kalman smoother",
        &["Rauch–Tung–Striebel smoother", "RTS smoother", "smoothing with hindsight"],
        "A backward pass over a filtered track that improves every estimate with the later measurements.",
    ),
    term(
        Trajectories,
        "KLT tracker",
        &["KLT", "Kanade–Lucas–Tomasi"],
        "The Kanade–Lucas–Tomasi tracker: selects corners by the smaller eigenvalue, tracks them by pyramidal \
        Lucas–Kanade and deletes those that no longer match.",
    ),
    term(
        DifferentialMethods,
        "Laplacian",
        &[],
        "The sum of the second derivatives in x and y, which compares a value with the mean of its neighbourhood.",
    )
    .symbol("Δ"),
    term(
        MotionVectors,
        "large displacement",
        &["large displacements", "large motion", "large motions", "fast motion"],
        "A displacement longer than the search range or than the structures that move, for which local methods need a \
        pyramid.",
    ),
    term(
        MovingObjects,
        "learning rate",
        &["learning rates", "adaptation rate"],
        "The weight α of the newest frame in a background model; a larger rate adapts faster and absorbs slow objects \
        sooner.",
    )
    .symbol("α"),
    term(
        DifferentialMethods,
        "least squares",
        &["least-squares", "weighted least squares", "method of least squares"],
        "The solution of more equations than unknowns that minimises the sum of the squared residuals.",
    ),
    term(
        InterestPoints,
        "left–right check",
        &["left–right consistency"],
        "The test that a match found from the left view is found from the right view as well; it rejects half-occluded pixels and many mismatches.",
    ),
    term(
        Trajectories,
        "level set function",
        &["level set", "level sets", "level set method"],
        "A function on the image that is positive inside a contour, negative outside and zero on it, so that the \
        contour can split and merge as the function changes.",
    )
    .symbol("φ"),
    term(
        DifferentialMethods,
        "linearisation",
        &["linearization", "linearised", "linearized", "Taylor expansion"],
        "The replacement of the gray level by its first-order Taylor expansion around the current displacement, valid \
        for small increments.",
    ),
    term(
        InterestPoints,
        "LO-RANSAC",
        &[],
        "RANSAC that fits each new best model to its inliers before the next sample.",
    ),
    term(
        MotionVectors,
        "local minimum",
        &["local minima", "local optimum"],
        "A displacement with a lower cost than its neighbours that need not be the global minimum, and in which fast \
        searches can stop.",
    ),
    term(
        DynamicScenes,
        "log-likelihood",
        &["log-likelihoods"],
        "The logarithm of the probability density that a model gives to the data; the larger, the better the model fits.",
    ),
    term(
        MotionVectors,
        "logarithmic search",
        &["two-dimensional logarithmic search", "2-D logarithmic search", "log search", "logarithmic search algorithm"],
        "A fast search that moves a pattern toward the lowest cost and halves its step, so that the number of \
        candidates grows with the logarithm of the search range.",
    ),
    term(
        DifferentialMethods,
        "Lucas–Kanade method",
        &["Lucas-Kanade", "Lucas and Kanade"],
        "A local method that assumes one displacement for a window around each pixel and solves the gradient \
        constraints there by least squares.",
    ),
    term(
        DynamicScenes,
        "luma",
        &[],
        "The weighted sum of red, green and blue that represents the brightness of a pixel; the estimators use it as \
        gray level.",
    ),
    term(
        MotionVectors,
        "macroblock partition",
        &[],
        "The division of a macroblock into smaller blocks, each with its own motion vector.",
    ),
    term(
        KalmanFilters,
        "Mahalanobis distance",
        &["squared Mahalanobis distance"],
        "The distance of a measurement from its prediction in units of the standard deviation in its direction, d² = \
        ν^T S⁻¹ ν.",
    )
    .symbol("d"),
    term(
        KalmanFilters,
        "manoeuvre",
        &["maneuver", "maneuvers", "manoeuvres", "maneuvering"],
        "A change of velocity that the motion model does not predict.",
    ),
    term(
        InterestPoints,
        "match",
        &["matches", "feature matching", "feature match"],
        "A pair of features, blocks or objects that are taken as corresponding.",
    ),
    term(
        MotionVectors,
        "mean absolute error",
        &["MAE", "MAD", "mean absolute difference", "mean absolute differences"],
        "The SAD divided by the number of pixels, in gray levels.",
    ),
    term(
        Trajectories,
        "mean shift",
        &["mean-shift", "mean-shift tracking", "mean shift tracking"],
        "An iteration that moves a window to the weighted mean of the samples inside it, until it rests on a local \
        maximum of their density.",
    ),
    term(
        MotionVectors,
        "mean squared error",
        &["MSE", "mean square error"],
        "The SSD divided by the number of pixels.",
    ),
    term(
        KalmanFilters,
        "measurement",
        &["measurements", "observation", "observations"],
        "A noisy observation of part of the state, for instance a detected position.",
    )
    .symbol("z"),
    term(
        KalmanFilters,
        "measurement matrix",
        &["observation matrix"],
        "The matrix H that maps the state to the measurement that it predicts.",
    )
    .symbol("H"),
    term(
        KalmanFilters,
        "measurement noise",
        &["measurement noise covariance"],
        "The random error of the measurements, with covariance R; larger values make the filter follow its prediction.",
    )
    .symbol("R"),
    term(
        MotionVectors,
        "median",
        &["median filter", "median filtering", "medians"],
        "The middle of the sorted values, which single outliers cannot shift far.",
    ),
    term(
        MultipleObjects,
        "merge",
        &["merges", "merged"],
        "The event that the blobs of two objects become one, so that one detection stands for both.",
    ),
    term(
        MovingObjects,
        "mixture of Gaussians",
        &["MOG", "GMM", "Gaussian mixture model", "Gaussian mixture"],
        "A background model that describes each pixel by several weighted Gaussians, so that flickering or swaying \
        backgrounds have more than one mode.",
    ),
    term(
        Trajectories,
        "model-based tracking",
        &[],
        "Tracking that fits a known model of an object's shape or appearance to every frame.",
    ),
    term(
        InterestPoints,
        "mosaic",
        &["mosaics", "panorama"],
        "Frames registered by their global motion in the coordinates of one of them.",
    ),
    term(
        Evaluation,
        "MOTA",
        &["multiple object tracking accuracy"],
        "Multiple object tracking accuracy: 1 minus the ratio of misses, false positives and identity switches to the \
        true objects.",
    ),
    term(
        DynamicScenes,
        "motion blur",
        &["blurred by motion"],
        "The smearing of moving objects along their path during the exposure of a frame.",
    ),
    term(
        MotionVectors,
        "motion compensation",
        &["motion-compensated", "motion-compensated prediction", "motion compensated prediction"],
        "The prediction of a frame from another frame by displacing its blocks or pixels by their motion vectors.",
    ),
    term(
        MotionVectors,
        "motion estimation",
        &[],
        "The computation of displacements between frames, per block, per feature or per pixel.",
    ),
    term(
        DynamicScenes,
        "motion field",
        &["true motion field"],
        "The projection of the three-dimensional velocities of scene points onto the image plane, which optical flow \
        can only approximate.",
    ),
    term(
        DynamicScenes,
        "motion layer",
        &["motion layers"],
        "A part of the picture with one parametric motion, which need not be connected and may be covered by others.",
    ),
    term(
        DynamicScenes,
        "motion model",
        &["motion models"],
        "An equation with a few parameters that describes how positions change, in the image (translation, affine) or \
        over time (constant velocity).",
    ),
    term(
        DynamicScenes,
        "motion segmentation",
        &["segmentation of motion"],
        "The partition of an image into regions that each move according to one motion model.",
    ),
    term(
        MotionVectors,
        "motion vector",
        &["motion vectors"],
        "The displacement of a block with the lowest cost, written (u, v) with u to the right and v down.",
    )
    .symbol("(u, v)"),
    term(
        Evaluation,
        "MOTP",
        &["multiple object tracking precision"],
        "Multiple object tracking precision: the mean overlap of matched objects with their true boxes.",
    ),
    term(
        MovingObjects,
        "moving camera compensation",
        &["camera motion compensation", "global motion compensation"],
        "The alignment of frames by the global motion before they are compared, so that a moving camera does not make \
        everything foreground.",
    ),
    term(
        InterestPoints,
        "MSAC",
        &[],
        "RANSAC with a score that sums the squared errors of inliers, so that better inliers count more.",
    ),
    term(
        MultipleObjects,
        "multi-hypothesis tracking",
        &["MHT", "multiple hypothesis tracking"],
        "Data association that keeps several hypotheses over several frames and decides when later detections have \
        made one of them clearly best.",
    ),
    term(
        MultipleObjects,
        "multi-object tracking",
        &["MOT", "multiple object tracking"],
        "The estimation of the trajectories of several objects with their identities.",
    ),
    term(
        MultipleObjects,
        "Murty's algorithm",
        &["k best assignments"],
        "The enumeration of assignments in the order of their costs, by excluding one pair after the other of those already found.",
    ),
    term(
        MultipleObjects,
        "N-scan pruning",
        &["N-scan"],
        "The deletion of all hypotheses that explain the frame N frames before otherwise than the leading one, which decides that frame.",
    ),
    term(
        KalmanFilters,
        "NEES",
        &["normalized estimation error squared", "normalised estimation error squared"],
        "Normalised estimation error squared: the squared error of the state in units of its covariance, for a \
        consistent filter n on average for n components.",
    ),
    term(
        DifferentialMethods,
        "neighbourhood mean",
        &["neighborhood mean", "local average", "neighborhood average", "neighbourhood average"],
        "The weighted mean of the flow at the pixels around, from which Horn–Schunck updates a pixel.",
    )
    .symbol("ū"),
    term(
        MotionVectors,
        "new three-step search",
        &[],
        "A three-step search that also tests the eight neighbours of zero displacement, so that small motion ends it \
        early.",
    ),
    term(
        KalmanFilters,
        "NIS",
        &["normalized innovation squared", "normalised innovation squared"],
        "Normalised innovation squared: ν^T S⁻¹ ν, which for a consistent filter follows a χ² distribution and needs \
        no ground truth.",
    ),
    term(
        Evaluation,
        "non-causal",
        &["offline", "with hindsight"],
        "Using later frames as well, as a smoother does with hindsight.",
    ),
    term(
        InterestPoints,
        "non-maximum suppression",
        &["NMS", "nonmaximum suppression", "non-maxima suppression"],
        "The removal of all responses that are not the largest in their neighbourhood, so that each corner is reported \
        once.",
    ),
    term(
        DynamicScenes,
        "non-rigid motion",
        &["non-rigid", "deformation", "deformations"],
        "Motion in which the distances between the points of an object change, as in cloth, faces or walking people.",
    ),
    term(
        DifferentialMethods,
        "normal equations",
        &["normal equation"],
        "The linear system T d = b of a least-squares problem; for Lucas–Kanade T is the structure tensor of the \
        window.",
    )
    .symbol("T d = b"),
    term(
        DifferentialMethods,
        "normal flow",
        &[],
        "The component of the flow along the image gradient, −I_t / |∇I|, which is all that one pixel determines.",
    )
    .symbol("u_n"),
    term(
        MotionVectors,
        "normalised cross-correlation",
        &["NCC", "ZNCC", "normalized cross-correlation", "cross-correlation"],
        "The correlation of two windows after the mean is removed and the contrast normalised; it is 1 for windows \
        that differ only in gain and offset.",
    ),
    term(
        Trajectories,
        "object detection",
        &["object detector", "detector", "detectors", "detection", "detections"],
        "The localisation of objects in one frame by a detector, as boxes, often with a class and a score.",
    ),
    term(
        DynamicScenes,
        "occlusion",
        &["occlusions", "occluded"],
        "The covering of a scene point by a surface nearer to the camera, so that it is visible in one frame and has \
        no correspondence in the other.",
    ),
    term(
        InterestPoints,
        "octave",
        &["octaves"],
        "A doubling of scale: the Gaussian images of a scale space between one resolution and half of it.",
    ),
    term(
        MovingObjects,
        "opening",
        &["morphological opening"],
        "An erosion followed by a dilation, which removes regions narrower than the structuring element.",
    ),
    term(
        DifferentialMethods,
        "optical flow",
        &["flow", "flow field", "flow fields", "dense flow", "apparent motion", "flow vector", "flow vectors"],
        "The apparent motion of brightness patterns between two frames, as a vector (u, v) for every pixel.",
    )
    .symbol("(u, v)"),
    term(
        Trajectories,
        "optical flow network",
        &["RAFT", "FlowNet", "PWC-Net"],
        "A neural network trained to estimate flow, which matches learned features through a cost volume and refines \
        the flow iteratively.",
    ),
    term(
        InterestPoints,
        "ORB",
        &["BRIEF"],
        "A fast binary feature: FAST corners with orientation, described by BRIEF bits and compared by Hamming \
        distance.",
    ),
    term(
        InterestPoints,
        "orientation histogram",
        &["orientation histograms"],
        "A histogram of the gradient directions around a keypoint, as angles from the x axis (right) towards the y axis (down); its peaks are \
        the orientations of the keypoint.",
    ),
    term(
        MovingObjects,
        "Otsu's method",
        &["Otsu", "Otsu threshold"],
        "The choice of the threshold that separates a histogram into two classes with the largest variance between \
        them.",
    ),
    term(
        InterestPoints,
        "outlier",
        &["outliers"],
        "A measurement or correspondence that does not follow the model and must not influence its estimate.",
    ),
    term(
        MotionVectors,
        "parabola fit",
        &["parabolic interpolation", "parabolic fit"],
        "Sub-pixel refinement by a parabola through the cost at the minimum and at its two neighbours in each \
        direction.",
    ),
    term(
        MotionVectors,
        "partial distortion elimination",
        &["early exit", "partial distance elimination"],
        "The end of the summation of a cost as soon as the partial sum exceeds the minimum so far, which rejects the candidate.",
    ),
    term(
        Trajectories,
        "particle filter",
        &["particle filters", "condensation algorithm"],
        "A recursive Bayesian filter that represents the distribution of the state by weighted samples, for motion \
        that is not linear or noise that is not Gaussian.",
    ),
    term(
        InterestPoints,
        "path cost",
        &["path costs"],
        "The lowest cost with which a path through the picture arrives at a pixel with a disparity: matching costs plus penalties for changes of the disparity.",
    )
    .symbol("L(p, d)"),
    term(
        MotionVectors,
        "peak signal-to-noise ratio",
        &["PSNR", "peak signal to noise ratio"],
        "The ratio of the squared maximum gray level to the mean squared error, 10 log₁₀(255² / MSE), in dB; higher is \
        better.",
    ),
    term(
        Trajectories,
        "peak-to-sidelobe ratio",
        &["PSR"],
        "The height of a correlation peak above the mean of the response around it, in standard deviations of that; low under occlusion.",
    ),
    term(
        DifferentialMethods,
        "penalty function",
        &["robust penalty", "penalizer", "penaliser", "robust penalty function"],
        "A function that weighs errors: quadratic for Gaussian noise, while robust ones grow more slowly so that \
        outliers count less.",
    )
    .symbol("ρ"),
    term(
        InterestPoints,
        "phase correlation",
        &[],
        "The inverse Fourier transform of the phase of the cross-power spectrum, which has its peak at the \
        translation between two pictures.",
    ),
    term(
        DynamicScenes,
        "point cloud",
        &[],
        "A set of points in space, here one for each pixel of known depth, with the colour of the picture.",
    ),
    term(
        Trajectories,
        "pose",
        &["poses"],
        "The rotation and translation of a rigid object relative to the camera: six parameters.",
    ),
    term(Evaluation, "precision", &[], "The share of detections that are correct.").symbol("TP / (TP + FP)"),
    term(
        Evaluation,
        "precision plot",
        &["precision curve"],
        "The share of frames in which the centre of a tracked region lies within a distance of the true one, over distances; a tracker is scored by its value at 20 px.",
    ),
    term(KalmanFilters, "predicted measurement", &[], "The measurement H x that the predicted state implies.")
        .symbol("H x"),
    term(
        KalmanFilters,
        "prediction",
        &["predicted state", "prediction step", "predict step"],
        "The estimate of a quantity before it is observed; a Kalman filter moves the state forward by the motion model \
        and enlarges its covariance by the process noise.",
    )
    .symbol("x⁻ = F x"),
    term(
        MotionVectors,
        "prediction residual",
        &["residual", "residuals", "residual image"],
        "The difference of data and their prediction; for a frame, of its gray levels and its motion-compensated \
        prediction, which a video encoder transmits.",
    ),
    term(
        MotionVectors,
        "predictive search",
        &["enhanced predictive zonal search", "EPZS", "predictive zonal search"],
        "A block search that starts from the motion vectors of neighbouring blocks and of the previous pair of \
        frames, and stops early if one of them matches well.",
    ),
    term(
        MotionVectors,
        "predictor",
        &["predictors", "motion vector prediction", "median predictor"],
        "A motion vector predicted from neighbouring blocks, often their median, which is tested first or from which \
        the difference is coded.",
    ),
    term(
        DifferentialMethods,
        "primal–dual method",
        &["primal-dual", "Chambolle's algorithm"],
        "An algorithm that solves a minimisation with total variation by alternating updates of the flow and of its \
        dual variable.",
    ),
    term(
        KalmanFilters,
        "process noise",
        &["process noise covariance", "system noise"],
        "The random part of the motion that the model leaves out, with covariance Q; larger values make the filter \
        follow its measurements.",
    )
    .symbol("Q"),
    term(
        MotionVectors,
        "pyramid level",
        &["pyramid levels", "coarsest level", "finest level", "finer level", "coarser level"],
        "One image of a pyramid; level 0 is the original, and each level halves width and height.",
    ),
    term(
        DifferentialMethods,
        "pyramidal Lucas–Kanade",
        &[],
        "Lucas–Kanade from the coarsest level of a pyramid to the finest, with several iterations per level, for \
        displacements larger than the window.",
    ),
    term(
        MotionVectors,
        "quadrant search",
        &[],
        "The course's logarithmic search, which tests the corners and the centre of each quadrant of the search \
        window, keeps the best quadrant and divides it again.",
    ),
    term(
        Evaluation,
        "random seed",
        &["seed", "seeds"],
        "The number that starts a random generator; the same seed gives the same noise.",
    ),
    term(
        InterestPoints,
        "RANSAC",
        &["random sample consensus"],
        "Random sample consensus: fits a model to minimal random samples and keeps the one with the most inliers.",
    ),
    term(
        MotionVectors,
        "rate–distortion cost",
        &["rate-distortion", "Lagrangian cost"],
        "The distortion of a block plus λ times the bits of its motion vector, so that a vector with many bits is \
        chosen only if it lowers the distortion enough.",
    )
    .symbol("D + λR"),
    term(
        InterestPoints,
        "ratio test",
        &["Lowe's ratio test"],
        "The rejection of a match if its nearest descriptor is not clearly closer than the second nearest.",
    ),
    term(
        Trajectories,
        "re-identification",
        &["Re-ID", "appearance model"],
        "The recognition of an object as one seen before by its appearance.",
    ),
    term(Evaluation, "recall", &["detection rate"], "The share of the true objects or pixels that were detected.")
        .symbol("TP / (TP + FN)"),
    term(
        DynamicScenes,
        "rectification",
        &["rectified"],
        "The warping of a stereo pair so that corresponding points lie in the same row.",
    ),
    term(
        Trajectories,
        "recurrent neural network",
        &["RNN", "LSTM", "recurrent neural networks"],
        "A network with memory that processes a sequence step by step, used to predict trajectories.",
    ),
    term(
        DynamicScenes,
        "region growing",
        &["growing region", "growing regions"],
        "A segmentation that starts from a pixel and adds neighbouring pixels as long as they are near the mean of the region.",
    ),
    term(
        DifferentialMethods,
        "regularisation",
        &["regularization", "regularizer", "regulariser", "regularised", "regularized"],
        "The addition of a smoothness term that makes an underdetermined problem solvable and fills in flow where the \
        data term gives no constraint.",
    ),
    term(
        DifferentialMethods,
        "regularisation weight",
        &["regularization weight", "smoothness weight", "regularization parameter", "regularisation parameter"],
        "The factor α that weighs smoothness against data; a larger α gives a smoother flow.",
    )
    .symbol("α"),
    term(
        InterestPoints,
        "repeatability",
        &["repeatable"],
        "The share of keypoints of one frame that are detected again at the corresponding positions of another.",
    ),
    term(
        DynamicScenes,
        "reprojection error",
        &["reprojection errors"],
        "The distance in px between the place where a point is measured and the place where a model projects it; in stereo, with the difference of the disparities.",
    ),
    term(
        Trajectories,
        "resampling of particles",
        &["systematic resampling", "multinomial resampling"],
        "The drawing of particles in proportion to their weights, which duplicates heavy ones and removes light ones, against degeneracy.",
    ),
    term(
        DynamicScenes,
        "responsibility",
        &["responsibilities"],
        "The probability that a component of a mixture has generated a point; those of all components sum to 1.",
    ),
    term(
        DynamicScenes,
        "rigid motion",
        &["rigid-body motion", "rigid"],
        "Motion by rotation and translation only, which preserves the distances between the points of an object.",
    ),
    term(
        Evaluation,
        "robustness",
        &["robust"],
        "The property of a method that noise, outliers or illumination changes have little influence on its result.",
    ),
    term(
        Evaluation,
        "root mean square error",
        &["RMSE", "RMS", "root mean squared error", "root mean square"],
        "The square root of the mean squared error, in the unit of the quantity itself.",
    ),
    term(
        MovingObjects,
        "running average",
        &["exponential moving average", "running mean"],
        "A background model B ← (1 − α) B + α I that follows the frames exponentially.",
    ),
    term(
        InterestPoints,
        "Sampson distance",
        &["Sampson error"],
        "A first-order approximation of the distance of a match from the nearest pair of points that satisfies the \
        epipolar constraint.",
    ),
    term(
        InterestPoints,
        "scale invariance",
        &["scale-invariant"],
        "The property of features to be found again when an object comes nearer or the camera zooms.",
    ),
    term(
        InterestPoints,
        "scale space",
        &["Gaussian scale space"],
        "An image at all scales: a stack of Gaussian images with increasing standard deviation.",
    ),
    term(
        DynamicScenes,
        "scene flow",
        &[],
        "The three-dimensional motion of every visible scene point, computed from stereo or depth together with \
        optical flow.",
    ),
    term(
        DifferentialMethods,
        "Scharr operator",
        &["Scharr", "Scharr filter"],
        "A 3×3 derivative filter like Sobel's with weights 3, 10, 3, chosen so that the gradient direction is nearly \
        independent of the edge's angle.",
    ),
    term(
        MotionVectors,
        "search pattern",
        &["search patterns"],
        "The arrangement of candidates that a fast search tests around its current centre.",
    ),
    term(
        MotionVectors,
        "search range",
        &["search ranges"],
        "The largest horizontal and vertical displacement that is tested, in px.",
    )
    .symbol("p"),
    term(
        MotionVectors,
        "search window",
        &["search windows"],
        "The set of all displacements within the search range, (2p + 1)² candidates for a range of ±p.",
    ),
    term(
        InterestPoints,
        "segment test",
        &["accelerated segment test", "high-speed test"],
        "The test of FAST: whether enough contiguous pixels of a circle are all brighter or all darker than its centre by \
        a threshold.",
    ),
    term(
        InterestPoints,
        "semi-global matching",
        &["SGM", "semi-global method"],
        "Stereo matching that minimises costs with smoothness penalties along paths from several directions and adds them up before it chooses.",
    ),
    term(
        KalmanFilters,
        "sensor fusion",
        &["data fusion"],
        "The combination of measurements of several sensors, each weighted by its covariance.",
    ),
    term(
        Evaluation,
        "SF",
        &["scene flow outliers"],
        "The share of pixels at which one of both disparities or the flow is wrong by more than 3 px and by more than 5 % of the truth, or is unknown: the measure of scene flow of the KITTI benchmark.",
    ),
    term(
        MovingObjects,
        "shadow",
        &["shadows", "cast shadow", "shadow detection"],
        "A region that a cast shadow darkens without changing its colour much, and that background subtraction \
        mistakes for an object.",
    ),
    term(
        InterestPoints,
        "Shi–Tomasi detector",
        &["Shi-Tomasi", "good features to track"],
        "A corner detector that takes local maxima of the smaller eigenvalue of the structure tensor, the condition \
        under which Lucas–Kanade is well posed.",
    ),
    term(
        InterestPoints,
        "SIFT",
        &["scale-invariant feature transform"],
        "Scale-invariant feature transform: extrema of differences of Gaussians with a descriptor of 128 \
        gradient-orientation bins.",
    ),
    term(
        DynamicScenes,
        "silhouette",
        &["silhouettes", "mean silhouette"],
        "A measure of how much nearer a point is to its own cluster than to the next one, from −1 to 1; its mean is used to \
        choose the number of clusters.",
    ),
    term(
        DifferentialMethods,
        "smoothness term",
        &["smoothness constraint", "smoothness assumption", "smoothness"],
        "The part of an energy that penalises differences between the flow of neighbouring pixels.",
    )
    .symbol("E_S"),
    term(
        DifferentialMethods,
        "Sobel operator",
        &["Sobel", "Sobel filter"],
        "A 3×3 derivative filter: a central difference in one direction, smoothed with weights 1, 2, 1 in the other.",
    ),
    term(
        MultipleObjects,
        "SORT",
        &["simple online and realtime tracking"],
        "Simple online and realtime tracking: Kalman filters for boxes and the Hungarian algorithm on their IoU.",
    ),
    term(
        MotionVectors,
        "speed-up",
        &["speedup"],
        "The ratio of the candidates, or of the time, of full search to those of a faster search.",
    ),
    term(
        MultipleObjects,
        "split",
        &["splits"],
        "The event that one blob separates into several, because objects part or the mask has a gap.",
    ),
    term(
        KalmanFilters,
        "state",
        &["state vector"],
        "The vector of the quantities that a filter estimates, such as position and velocity.",
    )
    .symbol("x"),
    term(
        Trajectories,
        "state hypothesis",
        &["state hypotheses"],
        "One possible state of the object, such as its position, velocity and scale, that a particle stands for; its weight says how well the image fits it.",
    ),
    term(
        KalmanFilters,
        "steady state",
        &["steady-state"],
        "The condition in which gain and covariance no longer change from frame to frame.",
    ),
    term(
        InterestPoints,
        "steepest-descent images",
        &["steepest-descent image"],
        "The derivatives of the gray levels of a picture with respect to each parameter of a warp, one \
        picture for each parameter.",
    ),
    term(
        DynamicScenes,
        "stereo vision",
        &["stereo", "stereo matching", "stereo pair"],
        "The recovery of depth from two or more views of a scene by matching points and triangulating them.",
    ),
    term(
        DifferentialMethods,
        "stopping criterion",
        &["stopping criteria"],
        "The condition that ends an iteration: a change smaller than a tolerance, or a maximum number of iterations.",
    )
    .symbol("ε"),
    term(
        DynamicScenes,
        "structure from motion",
        &["SfM"],
        "The joint recovery of camera motion and three-dimensional structure from point correspondences in several \
        frames.",
    ),
    term(
        DifferentialMethods,
        "structure tensor",
        &["structure tensors", "second-moment matrix", "second moment matrix", "gradient matrix"],
        "The 2×2 matrix of the products I_x², I_x I_y and I_y² averaged over a window; its eigenvalues tell flat \
        regions, edges and corners apart.",
    )
    .symbol("T"),
    term(
        MovingObjects,
        "structuring element",
        &["structuring elements"],
        "The small shape, here a square, with which morphological operations probe a mask.",
    ),
    term(
        MotionVectors,
        "sub-pixel accuracy",
        &["sub-pixel", "subpixel", "sub-pixel refinement", "half-pixel", "quarter-pixel"],
        "Displacements finer than one px, found by interpolation of the image or of the cost.",
    ),
    term(
        Evaluation,
        "success plot",
        &["success curve"],
        "The share of frames in which the overlap with the true box exceeds a threshold, over thresholds from 0 to 1; its area is a score of a tracker.",
    ),
    term(
        MotionVectors,
        "successive elimination",
        &["successive elimination algorithm", "multilevel successive elimination", "SEA"],
        "Full search that skips a candidate where a lower bound of its cost, from sums of gray levels over parts of the block, \
        exceeds the minimum so far.",
    ),
    term(
        DifferentialMethods,
        "successive over-relaxation",
        &["SOR", "overrelaxation", "over-relaxation", "relaxation factor"],
        "A Gauss–Seidel iteration with each step extrapolated by a factor ω, 1 < ω < 2, to converge faster.",
    )
    .symbol("ω"),
    term(
        MotionVectors,
        "sum of absolute differences",
        &["SAD", "sum of absolute difference"],
        "The sum of the absolute gray-level differences of a block and a candidate.",
    ),
    term(
        MotionVectors,
        "sum of absolute transformed differences",
        &["SATD", "Hadamard transform"],
        "The sum of the absolute Hadamard coefficients of the difference block, which approximates the bits that the \
        residual needs.",
    ),
    term(
        MotionVectors,
        "sum of squared differences",
        &["SSD", "sum of squared difference", "sum of squared errors"],
        "The sum of the squared gray-level differences of a block and a candidate, which weighs single large \
        differences more than the SAD does.",
    ),
    term(
        InterestPoints,
        "SURF",
        &["speeded-up robust features"],
        "Speeded-up robust features: a faster relative of SIFT that uses box filters on integral images.",
    ),
    term(
        Evaluation,
        "synthetic sequence",
        &["synthetic clip", "synthetic clips", "synthetic sequences"],
        "A rendered clip with known true motion at every pixel.",
    ),
    term(
        Trajectories,
        "template matching",
        &["template"],
        "The search for the position in a frame at which a stored patch has the lowest cost or the highest \
        correlation.",
    ),
    term(
        Trajectories,
        "template tracker",
        &["template trackers", "template tracking"],
        "A tracker that aligns a stored patch with each frame by the iterations of Lucas and Kanade.",
    ),
    term(
        Trajectories,
        "template update",
        &[],
        "The replacement of the stored appearance of a target by its current one, which follows changes but lets \
        errors accumulate.",
    ),
    term(
        DynamicScenes,
        "temporal aliasing",
        &["wagon-wheel effect"],
        "The apparent motion that differs from the true one when a periodic pattern moves by more than half its \
        period between frames, as in the wagon-wheel effect.",
    ),
    term(
        DifferentialMethods,
        "temporal derivative",
        &["temporal gradient", "temporal derivatives"],
        "The change of the gray level of a pixel from one frame to the next.",
    )
    .symbol("I_t"),
    term(
        MultipleObjects,
        "tentative track",
        &["tentative", "tentative tracks"],
        "A new track that is not reported until it was matched in enough frames.",
    ),
    term(
        DifferentialMethods,
        "texture",
        &["textured", "textureless", "untextured"],
        "Variation of the gray levels inside a region; without texture no method can measure motion there.",
    ),
    term(
        MotionVectors,
        "three-step search",
        &[],
        "A block search that tests nine candidates, moves to the best one, and halves the spacing, three times for a \
        range of ±7 px.",
    ),
    term(
        MovingObjects,
        "threshold",
        &["thresholds", "thresholding", "thresholded"],
        "The value with which a quantity is compared to decide between two classes.",
    ),
    term(
        DifferentialMethods,
        "thresholding step",
        &["soft thresholding"],
        "The closed-form step of TV-L1 that moves the flow of a pixel toward its constraint by at most λθ|∇I|.",
    ),
    term(
        DifferentialMethods,
        "total variation",
        &["TV"],
        "The integral of the gradient magnitude of a function, a smoothness term that allows jumps.",
    ),
    term(
        MultipleObjects,
        "track",
        &["tracks", "track management"],
        "The estimated state of one object over time, with its identity and status.",
    ),
    term(
        MultipleObjects,
        "track hypothesis",
        &["track hypotheses"],
        "One sequence of detections and misses that may be an object, with a score that is its log-likelihood ratio to false detections.",
    ),
    term(
        Trajectories,
        "trajectory",
        &["trajectories", "trajectory detection"],
        "The sequence of positions of an object over time.",
    ),
    term(
        KalmanFilters,
        "transition matrix",
        &["state transition matrix", "transition model"],
        "The matrix F that maps the state of one frame to the predicted state of the next.",
    )
    .symbol("F"),
    term(
        DynamicScenes,
        "translation",
        &["translations", "translational motion"],
        "Motion in which every point has the same displacement.",
    ),
    term(
        DynamicScenes,
        "triangulation",
        &["triangulated"],
        "The computation of the position of a point in space from its places in two views: with disparity d, focal length f and baseline B its depth is f B / d.",
    ),
    term(
        Evaluation,
        "true positive",
        &["true positives", "TP"],
        "A detection that matches an object or pixel of the ground truth.",
    ),
    term(
        DifferentialMethods,
        "TV-L1 method",
        &["TV-L1", "TV-L1 optical flow"],
        "A variational method with an absolute-value data term and total variation as its smoothness term, robust to \
        outliers and sharp at motion boundaries.",
    ),
    term(
        MovingObjects,
        "two-pass labelling",
        &["two-pass algorithm", "union-find"],
        "Component labelling that gives provisional labels in one raster scan, records which are equivalent, and \
        replaces them in a second scan.",
    ),
    term(
        MotionVectors,
        "unimodal error surface assumption",
        &["unimodal", "unimodal error surface"],
        "The assumption behind fast searches that the cost grows with the distance from the global minimum.",
    ),
    term(
        InterestPoints,
        "uniqueness",
        &["uniqueness ratio", "uniqueness test"],
        "The share by which the second-best cost of a match must exceed the best one; small where texture is missing or repeats.",
    ),
    term(
        KalmanFilters,
        "unscented Kalman filter",
        &["UKF", "sigma point", "sigma points"],
        "A Kalman filter for nonlinear models that propagates a few chosen points, the sigma points, instead of \
        linearising.",
    ),
    term(
        KalmanFilters,
        "unscented transform",
        &["unscented transformation"],
        "The moments of a random quantity after a nonlinear function, computed from sigma points that the function moves, without its derivative.",
    ),
    term(
        KalmanFilters,
        "update",
        &["update step", "measurement update", "correction step"],
        "The correction of an estimate by new data; a Kalman filter adds the gain times the innovation to the \
        predicted state and reduces its covariance.",
    )
    .symbol("x = x⁻ + K ν"),
    term(
        MultipleObjects,
        "validation matrix",
        &["validation matrices"],
        "The matrix of tracks and detections that is not zero where the detection lies in the gate of the track.",
    ),
    term(
        MovingObjects,
        "variance",
        &["standard deviation", "variances", "standard deviations"],
        "The mean squared deviation from the mean; its square root is the standard deviation σ.",
    )
    .symbol("σ²"),
    term(
        DifferentialMethods,
        "variational method",
        &["variational methods", "variational", "global method"],
        "A method that defines the flow as the minimum of an energy functional over the whole image.",
    ),
    term(
        MotionVectors,
        "video compression",
        &["video coding", "MPEG", "H.264"],
        "The coding of a video by motion vectors and prediction residuals instead of whole frames.",
    ),
    term(
        DynamicScenes,
        "visual odometry",
        &[],
        "The estimation of a camera's path from the motion of features in its images.",
    ),
    term(
        Trajectories,
        "wireframe model",
        &["wireframe models", "wireframe"],
        "A model of a rigid object by its edges in space.",
    ),
    term(
        MotionVectors,
        "zero-mean sum of absolute differences",
        &["ZSAD", "zero-mean SAD"],
        "The SAD after the mean of each window is removed, which ignores a constant change of brightness.",
    ),
    term(
        Trajectories,
        "zone",
        &["zones", "region of interest"],
        "A region of the image for which entries, exits and dwell times are measured.",
    ),
];

const fn term(
    chapter: Chapter,
    name: &'static str,
    aliases: &'static [&'static str],
    definition: &'static str,
) -> Term {
    Term { name, aliases, symbol: None, definition, chapter }
}

impl Term {
    const fn symbol(mut self, symbol: &'static str) -> Self {
        self.symbol = Some(symbol);
        self
    }
}
