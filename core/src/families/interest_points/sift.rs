//! Lowe's scale-invariant feature transform.

mod explain;
mod space;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Frame};
use crate::methods::features::value as features;
use crate::methods::scale_space::{
    BORDER, CELLS, Descriptor, Extremum, Histogram, Iteration, Peak, Place, Refined, Rejection, ScaleSpace, Shape,
    Thresholds, extrema_of_row, refine,
};
use crate::products::{Feature, Keypoint, Output, PointField, Product, ProductKind, keypoints};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Decimals, Focus, Picture, Question, Reply, Role, Scene, Step, Unit};
use crate::{cases, params, pseudocode, variables};

params! {
    /// Lowe's SIFT keypoints: extrema of differences of Gaussians in position and scale, with orientation and descriptor.
    pub struct Sift {
        /// Smallest absolute interpolated value of the difference of Gaussians, times the number of scales per octave, for gray values from 0 to 1. Higher values keep fewer, clearer blobs.
        contrast_threshold: f32 = 0.04, 0.0..=0.5;
        /// Largest ratio of the principal curvatures. Lower values reject more extrema on edges, where the position along the edge is uncertain.
        edge_threshold: f32 = 10.0, 1.0..=100.0;
        /// Number of scales per octave at which extrema are found.
        scales: usize = 3, 1..=6;
        /// Standard deviation of the first Gaussian image of each octave, in its px.
        sigma: f32 = 1.6, 0.8..=3.0, "px";
        /// Largest number of octaves. Each halves the resolution; the last has at least 12 px per side.
        octaves: usize = 8, 1..=10;
        /// Whether the first octave has twice the resolution of the frame. It finds the smallest blobs, about three quarters of all keypoints.
        double: bool = true;
        /// Largest number of keypoints; those of the largest contrast are kept.
        max_points: usize = 1000, 1..=100_000;
    }
    advanced { "scales", "sigma", "octaves" }
}

/// The stages of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    /// Gaussian images and their differences, one of each per unit.
    Space,
    /// Extrema among 26 neighbours, a row of a difference per unit.
    Extrema,
    /// Refinement, contrast and edge test, an extremum per unit.
    Refinement,
    /// Orientation histogram, a refined extremum per unit.
    Orientation,
    /// Ranking and selection, in one unit.
    Selection,
    /// Descriptor, a keypoint per unit.
    Description,
}

impl Stage {
    const ALL: [Self; 6] =
        [Self::Space, Self::Extrema, Self::Refinement, Self::Orientation, Self::Selection, Self::Description];

    fn next(self) -> Option<Self> {
        Self::ALL.get(self as usize + 1).copied()
    }
}

/// A refined extremum with one of its orientations.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Oriented {
    refined: Refined,
    angle_rad: f32,
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    picture: Arc<Frame>,
    space: ScaleSpace,
    stage: Stage,
    /// The number of the next unit of the stage.
    next: usize,
    extrema: Vec<Extremum>,
    refined: Vec<Refined>,
    /// In the order of `refined`; after the selection those that are kept, in order of decreasing response.
    oriented: Vec<Oriented>,
    /// The descriptors of the first of `oriented`.
    described: Vec<Arc<[f32]>>,
}

/// An event of a unit.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// The Gaussian image with this number in its octave was computed, and its difference from the one before.
    Level(usize),
    /// This row of a difference of Gaussians is searched.
    Row(usize),
    /// An extremum in this column of the row.
    Extremum(usize),
    /// An iteration of the refinement.
    Iteration(Iteration),
    /// The outcome of the refinement.
    Verdict(Result<Refined, Rejection>),
    /// The orientation histogram was computed.
    Histogram,
    /// A peak of it.
    Peak(Peak),
    /// The keypoints are ranked by response, and the strongest are kept.
    Selected,
    /// The histogram of a cell of the descriptor.
    Cell(usize),
    /// The descriptor was normalised.
    Normalised,
    /// Its entries were clamped, and it was normalised again.
    Clamped,
}

/// A row of a difference of Gaussians.
#[derive(Clone, Copy)]
struct Row {
    octave: usize,
    level: usize,
    y: usize,
}

impl Sift {
    fn shape(&self) -> Shape {
        let Self { scales, sigma, octaves, double, .. } = *self;
        Shape { scales, sigma_px: sigma, is_doubled: double, octaves }
    }

    fn thresholds(&self) -> Thresholds {
        Thresholds { contrast: 255.0 * self.contrast_threshold / self.scales as f32, edge: self.edge_threshold }
    }

    /// Smallest absolute value of an extremum, in gray levels: interpolation may raise it to the contrast threshold.
    fn least(&self) -> f32 {
        0.5 * self.thresholds().contrast
    }

    fn levels(&self, state: &State) -> usize {
        let shape = self.shape();
        shape.octaves_of(state.picture.size()) * shape.levels()
    }

    /// The rows in which extrema are sought, octave by octave and level by level.
    fn rows(&self, picture: (usize, usize)) -> impl Iterator<Item = (usize, usize, usize)> {
        let shape = self.shape();
        let rows = move |octave: usize| {
            let height = shape.size_of(octave, picture).1.saturating_sub(2 * BORDER);
            (1..=shape.scales).map(move |level| (octave, level, height))
        };
        (0..shape.octaves_of(picture)).flat_map(rows)
    }

    fn row(&self, picture: (usize, usize), mut index: usize) -> Option<Row> {
        for (octave, level, height) in self.rows(picture) {
            if index < height {
                return Some(Row { octave, level, y: BORDER + index });
            }
            index -= height;
        }
        None
    }

    /// Number of units of a stage, once the stage before it is over.
    fn units_of_stage(&self, state: &State, stage: Stage) -> usize {
        match stage {
            Stage::Space => self.levels(state),
            Stage::Extrema => self.rows(state.picture.size()).map(|(.., height)| height).sum(),
            Stage::Refinement => state.extrema.len(),
            Stage::Orientation => state.refined.len(),
            Stage::Selection => 1,
            Stage::Description => state.oriented.len(),
        }
    }

    fn finish_unit(&self, state: &mut State) -> Progress {
        state.next += 1;
        while state.next >= self.units_of_stage(state, state.stage) {
            let Some(stage) = state.stage.next() else { return Progress::Done };
            (state.stage, state.next) = (stage, 0);
        }
        Progress::More
    }

    fn search(&self, space: &ScaleSpace, row: Row, observer: &mut impl Observer<Event>) -> Vec<Extremum> {
        let Row { octave, level, y } = row;
        observer.see(|| Event::Row(y));
        let mut found = Vec::new();
        extrema_of_row(&space.octaves[octave], (level, y), self.least(), |x| {
            observer.see(|| Event::Extremum(x));
            found.push(Extremum { octave, level, x, y });
        });
        found
    }

    fn refine(&self, space: &ScaleSpace, at: Extremum, observer: &mut impl Observer<Event>) -> Option<Refined> {
        let tell = |iteration| observer.see(|| Event::Iteration(iteration));
        let verdict = refine(&space.octaves[at.octave], at, self.thresholds(), tell);
        observer.see(|| Event::Verdict(verdict));
        verdict.ok()
    }

    fn orient(&self, space: &ScaleSpace, refined: Refined, observer: &mut impl Observer<Event>) -> Vec<Oriented> {
        observer.see(|| Event::Histogram);
        let oriented = |peak: Peak| {
            observer.see(|| Event::Peak(peak));
            Oriented { refined, angle_rad: peak.angle_rad }
        };
        self.histogram(space, &refined).peaks().into_iter().map(oriented).collect()
    }

    fn histogram(&self, space: &ScaleSpace, refined: &Refined) -> Histogram {
        let Extremum { octave, level, x, y } = refined.at;
        Histogram::around(&space.octaves[octave].gaussians[level], (x, y), self.sigma_in_octave(refined))
    }

    /// Standard deviation of a keypoint in px of its octave.
    fn sigma_in_octave(&self, refined: &Refined) -> f32 {
        self.shape().sigma_of(refined.at.level as f32 + refined.offset[2])
    }

    /// The strongest keypoints in order of decreasing response, each once.
    fn select(&self, mut all: Vec<Oriented>) -> Vec<Oriented> {
        let place = |o: &Oriented| (o.refined.at.octave, o.refined.at.level, o.refined.at.y, o.refined.at.x);
        all.sort_by(|a, b| {
            let stronger = b.refined.response.total_cmp(&a.refined.response);
            stronger.then(place(a).cmp(&place(b))).then(a.angle_rad.total_cmp(&b.angle_rad))
        });
        // Neighbouring extrema may be refined to the same one.
        all.dedup_by(|a, b| place(a) == place(b) && a.angle_rad == b.angle_rad);
        all.truncate(self.max_points);
        all
    }

    fn place(&self, Oriented { refined, angle_rad }: &Oriented) -> Place {
        let Extremum { x, y, .. } = refined.at;
        let at = [x as f32 + refined.offset[0], y as f32 + refined.offset[1]];
        Place { at, sigma_px: self.sigma_in_octave(refined), angle_rad: *angle_rad }
    }

    /// The descriptor of a keypoint before normalisation.
    fn gathered(&self, space: &ScaleSpace, oriented: &Oriented) -> Descriptor {
        let Extremum { octave, level, .. } = oriented.refined.at;
        Descriptor::around(&space.octaves[octave].gaussians[level], &self.place(oriented))
    }

    fn describe(&self, space: &ScaleSpace, oriented: &Oriented, observer: &mut impl Observer<Event>) -> Arc<[f32]> {
        (0..CELLS).for_each(|cell| observer.see(|| Event::Cell(cell)));
        observer.see(|| Event::Normalised);
        observer.see(|| Event::Clamped);
        Arc::new(self.gathered(space, oriented).finished().0)
    }

    /// Position in the frame and standard deviation in px.
    fn in_frame(&self, refined: &Refined) -> ([f32; 2], f32) {
        let Extremum { octave, x, y, .. } = refined.at;
        let pixel = self.shape().pixel_px(octave);
        let at = [(x as f32 + refined.offset[0]) * pixel, (y as f32 + refined.offset[1]) * pixel];
        (at, self.sigma_in_octave(refined) * pixel)
    }

    fn keypoint(&self, oriented: &Oriented, descriptor: Option<&Arc<[f32]>>) -> (Feature, Keypoint) {
        let (at, sigma_px) = self.in_frame(&oriented.refined);
        let feature = Feature::found(at);
        let keypoint = Keypoint {
            response: oriented.refined.response,
            scale_px: Some(sigma_px),
            angle_rad: Some(oriented.angle_rad),
            descriptor: descriptor.map(|values| keypoints::Descriptor::Reals(Arc::clone(values))),
        };
        (feature, keypoint)
    }

    fn field(&self, state: &State) -> PointField {
        let kept = if state.stage == Stage::Description { &state.oriented[..] } else { &[] };
        let each = kept.iter().enumerate().map(|(i, oriented)| self.keypoint(oriented, state.described.get(i)));
        let (points, keypoints) = each.unzip();
        PointField { picture: state.picture.size(), points, keypoints }
    }
}

pseudocode! {
    BUILD_SPACE: "for each octave: L ← Gaussian images with σ growing by 2^(1/scales); D ← differences of successive L",
    EACH_PIXEL: "for each pixel of each D but the first and the last of an octave",
    IS_EXTREMUM: "  it is a candidate if none of its 26 neighbours in position and scale is larger (smaller)",
    EACH_CANDIDATE: "for each candidate x = (x, y, s)",
    FIT: "  repeat: d ← −(∂²D/∂x²)⁻¹ ∂D/∂x, the extremum of a quadratic; x ← x + d, rounded; until |d| < ½ in x, y, s",
    UNSTABLE: "  reject it if x leaves the scale space, or still moves after 5 iterations",
    LOW_CONTRAST: "  reject it if |D(x + d)| is below the contrast threshold",
    ON_EDGE: "  reject it if (tr H)² / det H ≥ (r + 1)² / r, r = edge-threshold",
    KEEP: "  else keep it",
    EACH_KEYPOINT: "for each: h ← histogram of the gradient directions around it, in 36 bins",
    ORIENT: "  a keypoint for each peak of h of at least 80 % of the highest",
    SELECT: "keep the strongest, up to max-points",
    EACH_DESCRIPTOR: "for each keypoint: for each of 4 × 4 cells, turned by its orientation",
    FILL_CELL: "    histogram of the gradient directions in 8 bins",
    NORMALISE: "  normalise the 128 entries to length 1",
    CLAMP: "  limit each to 0.2 and normalise again",
}

variables! {
    /// The number of octaves.
    OCTAVES: "Octaves", "", Unit::count("octave");
    /// The number of scales per octave at which extrema are found.
    SCALES: "Scales per octave", "", Unit::count("scale");
    /// The number of Gaussian images per octave: three more than scales.
    IMAGES: "Gaussian images per octave", "", Unit::count("image");
    /// The octave, from 1.
    OCTAVE: "Octave", "", Unit::WHOLE;
    /// The number of the Gaussian image in its octave, from 1.
    IMAGE: "Gaussian image", "", Unit::WHOLE;
    /// The number of the image before it.
    IMAGE_BEFORE: "", "", Unit::WHOLE;
    /// The standard deviation of the image or keypoint in px of the octave.
    SIGMA: "σ in px of the octave", r"\sigma", Unit::PX;
    /// The standard deviation of the image or keypoint in px of the frame.
    SIGMA_IN_FRAME: "σ in px of the frame", "", Unit::PX;
    /// The standard deviation of the Gaussian filter that makes the image from the one before.
    INCREMENT: "", "", Unit::PX;
    /// The radius of the blobs to which the difference of the images responds most, in px of the frame.
    BLOB_RADIUS: "", "", Unit::PX;
    /// The number of the difference of Gaussians in its octave, from 1.
    DIFFERENCE: "Difference of Gaussians", "", Unit::WHOLE;
    /// The number of extrema.
    EXTREMA: "Extrema", "", Unit::count("");
    /// The number of extrema so far.
    EXTREMA_SO_FAR: "Extrema so far", "", Unit::count(""), Role::Candidate;
    /// The smallest absolute value of an extremum: half the contrast threshold.
    LEAST: "", "", Unit::GRAY;
    /// The difference of Gaussians at the pixel.
    D: "", "D", Unit::GRAY;
    /// The difference of Gaussians at the neighbour.
    OTHER_D: "", "", Unit::FINE;
    /// The gradient of D in x, y and scale.
    GRADIENT: "", r"\nabla D", Unit::FINE;
    /// The second derivatives of D in x, y and scale.
    HESSIAN: "", r"\mathbf{H}", Unit::FINE;
    /// The offset of the extremum of the quadratic in x, y and scale.
    STEP: "", r"\mathbf{d}", Unit::FINE, Role::Result;
    /// The offset of the extremum of the quadratic along x and y.
    OFFSET: "", "", Unit::PX;
    /// The offset of the extremum of the quadratic in scales.
    SCALE_OFFSET: "", "", Unit::new("scales", 2);
    /// The absolute value of D, interpolated at the extremum.
    CONTRAST: "|D| at the extremum", "|D|", Unit::GRAY, Role::Result;
    /// The smallest |D| of a keypoint.
    CONTRAST_THRESHOLD: "Contrast threshold", "", Unit::GRAY;
    /// The ratio (tr H)² / det H, which grows with the ratio of the principal curvatures.
    CURVATURE_RATIO: "(tr H)² / det H", r"\frac{(\text{tr }\mathbf{H})^2}{\det \mathbf{H}}", Unit::FINE, Role::Result;
    /// The largest ratio (tr H)² / det H of a keypoint.
    EDGE_LIMIT: "Edge limit (r + 1)² / r", r"\frac{(r + 1)^2}{r}", Unit::FINE;
    /// The largest ratio r of the principal curvatures.
    EDGE_THRESHOLD: "", "r", Unit::WHOLE;
    /// The radius of the window of the orientation histogram, in px of the octave.
    WINDOW_RADIUS: "", "", Unit::new("px", 0);
    /// The standard deviation of the weights of the orientation histogram, in px of the octave.
    WEIGHT_SIGMA: "", r"1.5\,\sigma", Unit::PX;
    /// The height of the peak relative to the highest.
    PEAK_SHARE: "", "", Unit { name: "%", decimals: Decimals::AtMost(1) };
    /// The number of the peak of the histogram, from 1.
    PEAK: "", "", Unit::WHOLE;
    /// The extrema that pass the tests.
    AFTER_TESTS: "After the tests", "", Unit::count("");
    /// The keypoints with their orientations.
    WITH_ORIENTATIONS: "With orientations", "", Unit::count("");
    /// The contrast |D| of the weakest keypoint.
    WEAKEST: "", "", Unit::GRAY;
    /// The largest |D| at an extremum.
    STRONGEST: "", "", Unit::GRAY;
    /// The largest |D| of all differences of Gaussians.
    LARGEST: "", "", Unit::GRAY;
    /// The number of the cell of the descriptor, from 1.
    CELL: "", "", Unit::WHOLE;
    /// The side of a cell in px of the octave.
    CELL_WIDTH: "", "", Unit::PX;
    /// The strongest direction of the cell relative to the orientation.
    DIRECTION: "", "", Unit::DEGREES;
    /// The length of the descriptor.
    LENGTH: "", "", Unit::FINE;
    /// The entries of the descriptor that exceed 0.2.
    LARGE_ENTRIES: "", "", Unit::count("entry");
    /// The smallest standard deviation of a keypoint in px of the frame.
    SMALLEST_SIGMA: "", "", Unit::PX;
    /// The largest standard deviation of a keypoint in px of the frame.
    LARGEST_SIGMA: "", "", Unit::PX;
    /// The median of the standard deviations of the keypoints in px of the frame.
    MEDIAN_SIGMA: "", "", Unit::PX;
}

cases! { over value, features;
    OPENING: "SIFT finds the same points at another scale or rotation: a blob gives an extremum of the difference of \
              Gaussians in position and in scale. First the scale space is built.",
    FIRST: "Octave 1: a Gaussian filter with σ = {increment} raises the blur of the camera, assumed 0.50 px of the frame, to \
            σ = {sigma}.",
    FIRST_DOUBLED: "Octave 1, at twice the resolution of the frame: a Gaussian filter with σ = {increment} raises the blur of \
                    the camera, assumed 0.50 px of the frame, to σ = {sigma}.",
    HALVED: "Octave {octave}: every second pixel of the image with twice the first σ. At half the resolution it has σ = \
             {sigma} again, {sigma_in_frame} of the frame.",
    BLURRED: "Gaussian image {image}: filtering image {image_before} with σ = {increment} gives σ = {sigma}. Their difference \
              responds most to blobs with a radius of about {blob_radius} of the frame.",
    ROW: "Row {row} of octave {octave}, difference {difference} (σ = {sigma_in_frame} of the frame): each pixel with |D| \
          above {least}, half the contrast threshold, is compared with its 26 neighbours in position and scale.",
    MAXIMUM: "{candidate|Pixel} {pixel} has D = {d}: none of its 26 neighbours is larger, a maximum in position and scale, \
              the centre of a dark blob.",
    MINIMUM: "{candidate|Pixel} {pixel} has D = {d}: none of its 26 neighbours is smaller, a minimum in position and scale, \
              the centre of a bright blob.",
    NO_EXTREMUM: "{candidate|Pixel} {pixel} has D = {d}, but its neighbour {neighbour}",
    AT_SMALLER: "at the smaller scale has {other_d}: no extremum.",
    AT_SAME: "at the same scale has {other_d}: no extremum.",
    AT_LARGER: "at the larger scale has {other_d}: no extremum.",
    SINGULAR: "The quadratic through the neighbourhood of {pixel} has a singular Hessian, so it has no extremum.",
    FITTED: "The quadratic through the neighbourhood of {pixel} has its extremum at the offset {offset}, {scale_offset}",
    CONVERGED: ": less than ½ in each direction, so the position is final.",
    REPEATED: ": beyond ½, so it lies nearer to a neighbour, where the fit is repeated.",
    UNSTABLE: "The extremum leaves the scale space or still moves after the last iteration: {rejected|rejected} as unstable.",
    LOW_CONTRAST: "|D| = {contrast} at the extremum is below the contrast threshold {contrast_threshold:bare}: \
                   {rejected|rejected}, noise would move it.",
    SADDLE: "The principal curvatures have opposite signs, so this is a saddle in position: {rejected|rejected}.",
    ON_EDGE: "(tr H)² / det H = {curvature_ratio} reaches (r + 1)² / r = {edge_limit}: one principal curvature is at least \
              {edge_threshold} times the other, an edge. {rejected|Rejected}, its position along the edge is uncertain.",
    KEPT: "Kept at {position} of the frame with σ = {sigma_in_frame}: |D| = {contrast:bare} reaches the contrast threshold \
           {contrast_threshold:bare}, and (tr H)² / det H = {curvature_ratio} is below {edge_limit}, so it is no edge.",
    HISTOGRAM: "Gradient directions within {window_radius} of the octave, weighted by their magnitudes and a Gaussian with \
                1.5 σ = {weight_sigma}, fill 36 bins of 10°. The histogram is smoothed, and its peaks are the orientations.",
    HIGHEST: "Orientation {orientation}, the highest peak, interpolated between bins. The descriptor is turned by it, so that \
              it turns with the picture.",
    FURTHER: "Orientation {orientation}: a peak of {peak_share} of the highest, at least the required 80 %, so keypoint \
              {peak} has the same place and another orientation.",
    SELECTED: "Kept: the {keypoints:bare} of {with_orientations} keypoints with the largest |D| (the maximum number of \
               points); the weakest has |D| = {weakest}.",
    ALL_SELECTED: "All {keypoints:bare} keypoints are kept, in order of decreasing |D|; the weakest has {weakest}.",
    NONE_PASSED: "No extremum passed the tests, so there are no keypoints: |D| is at most {strongest} at the extrema \
                  ({extrema}), the contrast threshold is {contrast_threshold:bare}, and none may lie on an edge. A lower \
                  contrast threshold keeps weaker ones.",
    NO_EXTREMA: "0 pixels exceed all of their 26 neighbours, so there are no keypoints: a blob has an extremum, edges and \
                 ramps have none.",
    NO_CONTRAST: "|D| is at most {largest}, and an extremum needs more than {least:bare}, half the contrast threshold: the \
                  frame has no blobs of enough contrast, so there are no keypoints. A lower contrast threshold finds weaker \
                  ones.",
    CELL: "Cell {cell} of 16, turned by the orientation {orientation} and {cell_width} of the octave wide: gradients relative \
           to the orientation fill 8 bins of 45°. The strongest is {direction}.",
    NORMALISED: "The 128 entries have the length {length}; divided by it they no longer depend on the contrast of the picture.",
    NONE_LARGE: "No entry exceeds 0.2.",
    ONE_LARGE: "1 entry exceeds 0.2 and is limited to it.",
    SOME_LARGE: "{large_entries} exceed 0.2 and are limited to it.",
    CLAMPED: "The limit keeps single large gradients, as at a highlight, from outweighing all others. Normalised again, this \
              is the descriptor.",
    NO_KEYPOINTS: "End of the run without keypoints.",
    END: "End of the run: {keypoints} from {extrema} extrema, σ from {smallest_sigma:bare} to {largest_sigma}, half of them \
          below {median_sigma}.",
    AT_MOST: "The maximum number of points is reached; a larger value admits weaker keypoints.",
    FURTHER_BLOBS: "A lower contrast threshold keeps weaker blobs; a lower edge threshold rejects more extrema on edges.",
}

impl Estimator for Sift {
    const INFO: Info = Info {
        id: "sift",
        name: "SIFT keypoints",
        family: "Interest points",
        summary: "Scale-invariant keypoints: extrema of differences of Gaussians in position and scale, with orientation and descriptor.",
        source: "D. G. Lowe, Distinctive image features from scale-invariant keypoints, International Journal of Computer Vision 60(2), 2004",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "part", "step"],
        frames: 1,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "accepted",
            "What becomes of the next extremum?",
            &[
                Reply::at(line::KEEP, "It is kept"),
                Reply::at(line::LOW_CONTRAST, "Rejected: low contrast"),
                Reply::at(line::ON_EDGE, "Rejected: it lies on an edge"),
                Reply::at(line::UNSTABLE, "Rejected: unstable"),
            ],
        ),
        Question::choice(
            "final",
            "Is the fitted position final?",
            &[
                Reply::told(line::FIT, case::CONVERGED, "Yes: less than ½ away"),
                Reply::told(line::FIT, case::REPEATED, "No: the fit is repeated at a neighbour"),
            ],
        ),
    ];
    const GUARANTEE: Guarantee = Guarantee::SubPixelPlaces { off_centi_px: 25 };
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Tiles, Chart::Stack];
    const PRODUCES: &'static [&'static ProductKind] = &[PointField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State {
            picture: clip.frame(frame)?,
            space: ScaleSpace::default(),
            stage: Stage::Space,
            next: 0,
            extrema: Vec::new(),
            refined: Vec::new(),
            oriented: Vec::new(),
            described: Vec::new(),
        })
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        match state.stage {
            Stage::Space => {
                self.shape().add_level(&mut state.space, state.picture.luma(), &Threads::single());
                observer.see(|| Event::Level(state.next % self.shape().levels()));
            }
            Stage::Extrema => {
                let row = self.row(state.picture.size(), state.next);
                let found = row.map(|row| self.search(&state.space, row, observer));
                state.extrema.extend(found.unwrap_or_default());
            }
            Stage::Refinement => {
                let refined = self.refine(&state.space, state.extrema[state.next], observer);
                state.refined.extend(refined);
            }
            Stage::Orientation => {
                let oriented = self.orient(&state.space, state.refined[state.next], observer);
                state.oriented.extend(oriented);
            }
            Stage::Selection => {
                state.oriented = self.select(std::mem::take(&mut state.oriented));
                observer.see(|| Event::Selected);
            }
            Stage::Description => {
                let described = self.describe(&state.space, &state.oriented[state.next], observer);
                state.described.push(described);
            }
        }
        Ok(self.finish_unit(state))
    }

    fn units(&self, _: &State) -> Option<usize> {
        None
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let granularity = |index, of| Granularity { index, of: Some(of) };
        let units = self.units_of_stage(state, state.stage);
        vec![granularity(0, 1), granularity(state.stage as usize, Stage::ALL.len()), granularity(state.next, units)]
    }

    /// The first image of an octave, the first row of a difference, extrema, and the outcomes of their tests.
    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Level(0) | Event::Row(BORDER) => Some(Role::Window),
            Event::Extremum(_) => Some(Role::Candidate),
            Event::Verdict(Ok(_)) => Some(Role::Best),
            Event::Verdict(Err(_)) => Some(Role::Rejected),
            _ => None,
        }
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(self.field(state))
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.start(clip, frame)?;
        let levels = self.levels(&state);
        for _ in 0..levels {
            clip.wanted()?;
            self.shape().add_level(&mut state.space, state.picture.luma(), threads);
        }
        let (rows, size) = (self.units_of_stage(&state, Stage::Extrema), state.picture.size());
        // An event for each level, and one for the selection.
        tally.add_events(levels as u64 + 1);
        state.extrema = threads
            .map_while(
                rows,
                || clip.wanted(),
                |i| self.row(size, i).map_or_else(Vec::new, |row| self.search(&state.space, row, &mut tally.counter())),
            )?
            .concat();
        let refined =
            threads.map(state.extrema.len(), |i| self.refine(&state.space, state.extrema[i], &mut tally.counter()));
        state.refined = refined.into_iter().flatten().collect();
        let oriented = threads.map_while(
            state.refined.len(),
            || clip.wanted(),
            |i| self.orient(&state.space, state.refined[i], &mut tally.counter()),
        )?;
        state.oriented = self.select(oriented.concat());
        state.described = threads.map_while(
            state.oriented.len(),
            || clip.wanted(),
            |i| self.describe(&state.space, &state.oriented[i], &mut tally.counter()),
        )?;
        (state.stage, state.next) = (Stage::Description, state.described.len());
        tally.add_units(levels + rows + state.extrema.len() + state.refined.len() + 1 + state.described.len());
        Ok(state)
    }
}

impl Footprint<State> for Sift {
    fn need(&self, clip: &Clip) -> Need {
        // Gaussian images and differences of all octaves, and one being filtered.
        let images = (2 * self.shape().levels()) as f64 * 4.0 * 4.0 / 3.0;
        let bytes = images * if self.double { 4.0 } else { 1.0 } + 20.0;
        // A part that is walked again exists twice for a while.
        Need::per_pixel(clip, [bytes, 2.0 * bytes])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let lists =
            size_of_val(&state.extrema[..]) + size_of_val(&state.refined[..]) + size_of_val(&state.oriented[..]);
        // Images and descriptors are shared by the states after them.
        size_of::<State>() + lists + size_of_val(&state.described[..]) + 64 * state.space.octaves.len()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let images = state.space.octaves.iter().flat_map(|octave| octave.gaussians.iter().chain(&octave.differences));
        let images: usize = images.map(|image| size_of_val(image.cells())).sum();
        let descriptors: usize = state.described.iter().map(|values| size_of_val(&values[..])).sum();
        self.state_bytes(state) + images + descriptors
    }
}

impl Pointed<State> for Sift {
    fn takes(&self, picture: Picture) -> bool {
        [Picture::CURRENT, Picture::SMOOTHED, Picture::RESPONSE].contains(&picture)
    }

    /// The unit that describes the keypoint nearest to a position, or finds its extremum before keypoints are known.
    fn unit_at(&self, state: &State, Focus { at, .. }: Focus) -> Option<usize> {
        let far = |refined: &Refined| {
            let ([x, y], _) = self.in_frame(refined);
            (x - at[0]).hypot(y - at[1])
        };
        let before = |stage| {
            let stages = Stage::ALL.into_iter().take_while(move |other| *other < stage);
            stages.map(|stage| self.units_of_stage(state, stage)).sum::<usize>()
        };
        let nearest = |all: &mut dyn Iterator<Item = f32>| all.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        match state.stage {
            Stage::Space | Stage::Extrema => None,
            Stage::Refinement => {
                let unrefined = |at: &Extremum| far(&Refined { at: *at, offset: [0.0; 3], response: 0.0 });
                let (index, _) = nearest(&mut state.extrema.iter().map(unrefined))?;
                Some(before(Stage::Refinement) + index)
            }
            Stage::Orientation | Stage::Selection => {
                let (index, _) = nearest(&mut state.refined.iter().map(far))?;
                Some(before(Stage::Orientation) + index)
            }
            Stage::Description => {
                let (index, _) = nearest(&mut state.oriented.iter().map(|oriented| far(&oriented.refined)))?;
                Some(before(Stage::Description) + index)
            }
        }
    }

    /// While the scale space is built its surroundings are shown in all images; while extrema are sought it is compared with its neighbours.
    fn explained(&self, state: &State, _: Focus) -> Option<Explained> {
        matches!(state.stage, Stage::Space | Stage::Extrema).then_some(Explained::Always)
    }
}
