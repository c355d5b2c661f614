//! SURF: blobs by the determinant of the Hessian from box filters, described by Haar wavelets.

mod charts;
mod explain;
mod hessian;
mod marks;
mod probe;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Frame};
use crate::methods::features::haar::{self, Blob, SIDE, VALUES};
use crate::methods::features::{Selection, choose, integral::Integral, value as features};
use crate::products::{Descriptor, Feature, Keypoint, Output, PointField, Product, ProductKind, Status};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Question, Reply, Role, Scene, Step, Unit};
use crate::{cases, params, pseudocode, variables};
use hessian::{Filter, LAYERS, Layer, Neighbor, Refined, Three, is_suppressed, scale_of, suppressed_by};

params! {
    /// SURF keypoints: maxima of the determinant of the Hessian over position and scale, with an orientation and a descriptor of 64 values.
    pub struct Surf {
        /// Number of octaves. Each doubles the step of the filter sizes and samples, and finds larger blobs.
        octaves: usize = 4, 1..=5;
        /// Smallest response R of a keypoint. Higher values find fewer blobs, of more contrast.
        threshold: f32 = 25.0, 0.0..=2000.0;
        /// Whether the descriptor stays upright instead of being turned by an orientation (U-SURF): faster, for a camera that does not roll.
        upright: bool = false;
        /// Limits of distance and number.
        selection: Selection = Selection { min_distance: 0, ..Selection::default() };
    }
}

pseudocode! {
    INTEGRAL: "Σ(x, y) ← sum of all pixels above and to the left: the integral image",
    EACH_LAYER: "for each octave, for each of its 4 filter sizes L",
    DERIVE_XX: "  D_xx ← box filter for the second derivative along x, from corners of Σ",
    DERIVE_YY: "  D_yy ← box filter for the second derivative along y",
    DERIVE_XY: "  D_xy ← box filter for the mixed derivative",
    DETERMINANT: "  R ← D_xx D_yy − (0.9 D_xy)²",
    EACH_SAMPLE: "for each sample of the two middle layers of each octave with R > threshold",
    SUPPRESS: "  suppress it unless R exceeds its 26 neighbours in position and scale",
    REFINE: "  refine position and scale by a quadratic function; reject it if that moves it by more than a sample",
    EACH_PEAK: "for each maximum, in order of decreasing R",
    DROP_NEAR: "  reject it if a keypoint was kept within min-distance",
    KEEP: "  else keep it, up to max-points",
    EACH_KEYPOINT: "for each keypoint of scale s",
    WAVELETS: "  d_x, d_y ← responses of Haar wavelets of side 4 s within 6 s of it",
    SECTOR: "  for each direction: sum ← Σ (d_x, d_y) in a sector of 60° from there on",
    ORIENT: "  θ ← the direction of the longest sum, or 0 if upright",
    SUBREGION: "  for each of 4×4 subregions of 5 s, turned by θ: Σ d_x, Σ d_y, Σ |d_x|, Σ |d_y|",
    UNIT_LENGTH: "  scale the 64 values to unit length",
}

variables! {
    /// The columns of the integral image.
    COLUMNS: "", "", Unit::count("");
    /// The rows of the integral image.
    ROWS: "", "", Unit::count("");
    /// The sum of all gray levels of the frame.
    SUM: "Sum of all gray levels", "", Unit::count("");
    /// The octave, from 1.
    OCTAVE: "Octave", "", Unit::WHOLE;
    /// The side of the filter.
    SIDE: "Filter side L", "L", Unit::new("px", 0);
    /// The sides of the filters of the layer below, this layer and the layer above.
    SIDES: "Filter sides L", "", Unit::new("px", 0);
    /// The side of the filter of the layer below.
    SIDE_BELOW: "", "", Unit::new("px", 0);
    /// The side of the filter of the layer above.
    SIDE_ABOVE: "", "", Unit::new("px", 0);
    /// The scale: s = 1.2 L / 9 for a filter of side L.
    SCALE: "Scale s", "s", Unit::SUBPIXEL;
    /// The distance of neighbouring samples.
    SPACING: "Sample spacing", "", Unit::new("px", 0);
    /// The filter at work.
    FILTER: "", "", Unit::WHOLE;
    /// The second derivative along x.
    D_XX: "D_xx", "D_{xx}", Unit::FINE, Role::Reference;
    /// The second derivative along y.
    D_YY: "D_yy", "D_{yy}", Unit::FINE, Role::Reference;
    /// The mixed second derivative.
    D_XY: "D_xy", "D_{xy}", Unit::FINE, Role::Reference;
    /// The integral image at the upper left corner of the first box.
    CORNER_A: "", "A", Unit::WHOLE, Role::Result;
    /// The integral image at the upper right corner of the first box.
    CORNER_B: "", "B", Unit::WHOLE, Role::Result;
    /// The integral image at the lower left corner of the first box.
    CORNER_C: "", "C", Unit::WHOLE, Role::Result;
    /// The integral image at the lower right corner of the first box.
    CORNER_D: "", "D", Unit::WHOLE, Role::Result;
    /// The sum of the first box of the filter.
    BOX_1: "", "S_1", Unit::WHOLE;
    /// The sum of the second box of the filter.
    BOX_2: "", "S_2", Unit::WHOLE;
    /// The sum of the third box of the filter.
    BOX_3: "", "S_3", Unit::WHOLE;
    /// The sum of the fourth box of the filter.
    BOX_4: "", "S_4", Unit::WHOLE;
    /// The weighted sum of the boxes of the filter.
    BOXES: "", "", Unit::WHOLE;
    /// The pixels of the filter.
    AREA: "", "L^2", Unit::WHOLE;
    /// The number of samples of the layer above the threshold.
    SAMPLES: "", "", Unit::count("sample");
    /// The verb of that count.
    EXCEED: "", "", Unit::WHOLE;
    /// The offset of the vertex along x and y in samples.
    OFFSET: "", "", Unit::FINE;
    /// The offset of the vertex in layers.
    LAYER_OFFSET: "", "", Unit::FINE;
    /// The number of maxima over position and scale.
    MAXIMA: "Maxima", "", Unit::count("maximum");
    /// The keypoint that rejects the maximum.
    NEAR_KEYPOINT: "", "", Unit::PX, Role::Result;
    /// The side of the wavelets: 4 s.
    WAVELET_SIDE: "", "", Unit::SUBPIXEL;
    /// The radius of the disc of the wavelets: 6 s.
    WHEEL_RADIUS: "", "", Unit::SUBPIXEL;
    /// The direction in which the sector begins.
    SECTOR_START: "", "", Unit::new("°", 1);
    /// The direction in which the sector ends.
    SECTOR_END: "", "", Unit::new("°", 1);
    /// The length of the sum of the wavelet responses in the sector.
    SECTOR_LENGTH: "", "", Unit::FINE;
    /// The direction in which the sector with the longest sum begins.
    LONGEST_START: "", "", Unit::new("°", 1);
    /// The length of the longest sum.
    LONGEST: "", "", Unit::FINE;
    /// The number of the subregion, from 1.
    SUBREGION: "", "", Unit::WHOLE;
    /// The sum of the wavelet responses d_x in the subregion.
    SUM_X: "", r"\sum d_x", Unit::FINE;
    /// The sum of the wavelet responses d_y in the subregion.
    SUM_Y: "", r"\sum d_y", Unit::FINE;
    /// The sum of |d_x| in the subregion.
    SIZE_X: "", r"\sum |d_x|", Unit::FINE;
    /// The sum of |d_y| in the subregion.
    SIZE_Y: "", r"\sum |d_y|", Unit::FINE;
    /// The length of the descriptor before it is scaled.
    LENGTH: "Length before scaling", "", Unit::FINE;
    /// The keypoints of each octave.
    BY_OCTAVE: "", "", Unit::count("");
}

cases! { over value, features;
    OPENING: "A blob has large second derivatives of one sign in all directions, so the determinant of its Hessian is large. \
              SURF computes the derivatives with box filters: the sum of a box of any size needs four values of an integral \
              image.",
    SUMMED: "The integral image Σ holds the sum of all pixels above and to the left of each of {columns}×{rows} corners. The \
             sum of any box is then D − B − C + A of the values at its corners: three additions, whatever its size.",
    NO_FILTER: "The filter {filter} of side L = {side} (octave {octave}, scale s = {scale}) has no positive response: the \
                picture is flat for it, or smaller than it.",
    NO_DETERMINANT: "The determinant of side L = {side} (octave {octave}, scale s = {scale}) has no positive response: the \
                     picture is flat for it, or smaller than it.",
    ALONG_X: "{reference|Pixel} {pixel}, L = {side}, s = {scale}: D_xx = {d_xx}, the second derivative along x by three boxes \
              with weights 1, −2, 1.",
    ALONG_Y: "{reference|Pixel} {pixel}, L = {side}, s = {scale}: D_yy = {d_yy}, the second derivative along y by three boxes \
              with weights 1, −2, 1.",
    ALONG_BOTH: "{reference|Pixel} {pixel}, L = {side}, s = {scale}: D_xy = {d_xy}, the second derivative along both axes by \
                 four boxes with weights 1, −1, −1, 1.",
    DETERMINANT: "{reference|Pixel} {pixel}, octave {octave}, L = {side}: R = D_xx D_yy − (0.9 D_xy)² = {response}",
    IS_BRIGHT: "is positive, and the second derivatives are negative: a bright blob.",
    IS_DARK: "is positive, and so are the second derivatives: a dark blob.",
    IS_NO_BLOB: "is not positive: the second derivatives differ in sign, or there is an edge.",
    ABOVE_THRESHOLD: "Octave {octave}, L = {side}: {samples} {exceed} the threshold R = {threshold}. Non-maximum suppression \
                      compares each with its 26 neighbours in position and scale.",
    MAXIMUM: "{best|Sample} {pixel}: R = {response} exceeds all 26 neighbours, 8 in its layer and 9 in each of the layers of \
              L = {side_below:bare} and {side_above:bare}: a maximum over position and scale.",
    SUPPRESSED: "{rejected|Sample} {pixel}: R = {response} is above the threshold, but its neighbour {neighbour}",
    OF_LAYER_BELOW: "of the layer below (L = {side_below:bare}) has {other_response}, which is no smaller: suppressed.",
    OF_ITS_LAYER: "of its own layer has {other_response}, which is no smaller: suppressed.",
    OF_LAYER_ABOVE: "of the layer above (L = {side_above:bare}) has {other_response}, which is no smaller: suppressed.",
    NO_VERTEX: "{reference|Maximum} {pixel}: the quadratic function through its neighbours has no vertex, so it is rejected.",
    VERTEX: "{reference|Maximum} {pixel}: the vertex of the quadratic function through its neighbours lies at an offset of \
             {offset} samples and {layer_offset} layers,",
    ACCEPTED: "with R = {response}: accepted.",
    TOO_FAR: "more than one sample away, where the fit is unreliable: {rejected|rejected}.",
    NO_MAXIMA: "0 samples above the threshold are a maximum among their 26 neighbours, so there are no keypoints: the frame \
                has no blobs of these sizes.",
    ALL_BELOW: "The largest response is R = {largest_response}, and a keypoint needs more than the threshold R = {threshold}, \
                so there are no keypoints: the frame has too little contrast. A lower threshold finds weaker ones.",
    RANKED: "{maxima} {be} ranked by response. In this order at most {max_points} become keypoints (the maximum number of \
             points), each at least {min_distance} (the minimum distance) from those kept before.",
    KEPT: "Maximum {position:bare}, R = {response}, scale s = {scale}: kept as keypoint {kept:bare}.",
    NEAR: "Maximum {position:bare}, R = {response}, is closer than the minimum distance ({min_distance}) to keypoint \
           {near_keypoint:bare} with R = {other_response}, which is no smaller: rejected.",
    WAVELETS: "Keypoint {keypoint} at {position:bare}: Haar wavelets of side 4 s = {wavelet_side} respond at 109 samples \
               within 6 s = {wheel_radius}, s = {scale}. They are weighted with a Gaussian of standard deviation 2 s.",
    SECTOR: "Sector from {sector_start} to {sector_end}: the responses in it sum to a vector of length {sector_length},",
    IS_FIRST: "the longest so far.",
    IS_LONGEST: "the longest so far.",
    IS_SHORTER: "shorter than {longest} from {longest_start} on.",
    UPRIGHT: "Keypoint {keypoint} at {position:bare}, s = {scale}: upright, so its orientation is θ = 0.",
    ORIENTED: "The sector from {longest_start} on has the longest sum, {longest}. Its direction is the orientation θ = \
               {orientation}.",
    SUBREGION: "Subregion {subregion} of 16: Σ d_x = {sum_x}, Σ d_y = {sum_y}, Σ |d_x| = {size_x}, Σ |d_y| = {size_y}. A sum \
                much smaller than that of its absolute values means that the gradient changes sign, as in a pattern of \
                stripes.",
    UNIT_LENGTH: "The 64 values have the length {length}. Divided by it, they no longer depend on the contrast.",
    ALL_ZERO: "All 64 values are 0: the neighbourhood is flat and cannot be distinguished from others.",
    END: "End of the run: {keypoints} from {maxima}, responses {first_response} to {last_response}; by octave {by_octave}.",
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    /// Frame t.
    picture: Arc<Frame>,
    integral: Option<Arc<Integral>>,
    /// Number of octaves that there will be.
    octaves: usize,
    /// The layers so far, octave after octave.
    layers: Vec<Arc<Layer>>,
    /// Number of layers searched for maxima.
    searched: usize,
    /// The maxima; once chosen, in order of decreasing response.
    maxima: Arc<Vec<Maximum>>,
    /// The indices of those kept, once they are chosen.
    kept: Option<Arc<[usize]>>,
    /// Orientation and descriptor of the first of those.
    described: Vec<Described>,
}

/// A maximum over position and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maximum {
    octave: usize,
    /// Its layer in the octave.
    layer: usize,
    /// Its sample of the layer.
    sample: (usize, usize),
    refined: Refined,
    /// Refined position and scale.
    blob: Blob,
}

/// Orientation and descriptor of a keypoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Described {
    angle_rad: f32,
    values: Arc<[f32]>,
}

/// An event of a unit.
#[derive(Clone, Debug)]
pub enum Event {
    /// The integral image is computed.
    Summed,
    /// A layer is filtered for D_xx.
    Filtered(Arc<Layer>),
    /// The same for D_yy.
    Down,
    /// The same for D_xy.
    Mixed,
    /// Its determinants are computed.
    Determinant,
    /// The threshold is applied to a layer.
    Thresholded,
    /// A sample above the threshold, and the neighbour that suppresses it, if one does.
    Compared((usize, usize), Option<Neighbor>),
    /// A maximum is refined; `None` where the quadratic function has no vertex.
    Refined((usize, usize), Option<Refined>),
    /// The maxima are ranked.
    Ranked(Arc<Vec<Maximum>>),
    /// The next of them, and the one within min-distance that rejects it, if there is one.
    Peak(usize, Option<usize>),
    /// The wavelets around a keypoint are computed.
    Wavelets,
    /// The sum of the next position of the sector.
    Sector([f32; 2]),
    /// The orientation is assigned.
    Oriented(f32),
    /// The sums of the next subregion.
    Subregion([f32; 4]),
    /// The descriptor is scaled; its length before.
    UnitLength(f32),
}

/// The unit at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// The integral image.
    Integral,
    /// The responses of a layer.
    Layer(usize),
    /// The maxima of a middle layer.
    Search(usize),
    /// The selection of keypoints.
    Choice,
    /// A keypoint.
    Keypoint(usize),
}

/// Middle layers of an octave.
const MIDDLE: usize = LAYERS - 2;

impl State {
    fn part(&self) -> Part {
        match &self.kept {
            Some(_) => Part::Keypoint(self.described.len()),
            None if self.integral.is_none() => Part::Integral,
            None if self.layers.len() < LAYERS * self.octaves => Part::Layer(self.layers.len()),
            None if self.searched < MIDDLE * self.octaves => Part::Search(self.searched),
            None => Part::Choice,
        }
    }

    /// The units before the first keypoint.
    fn units_before(&self) -> usize {
        1 + (LAYERS + MIDDLE) * self.octaves + 1
    }

    fn kept(&self) -> &[usize] {
        self.kept.as_deref().unwrap_or_default()
    }

    /// Returns the maximum that is keypoint `index`.
    fn keypoint(&self, index: usize) -> Option<&Maximum> {
        self.maxima.get(*self.kept().get(index)?)
    }

    /// Returns the layers around middle layer `index`.
    fn three(&self, index: usize) -> Option<Three<'_>> {
        let first = index / MIDDLE * LAYERS + index % MIDDLE;
        match &self.layers.get(first..first + 3)? {
            [below, here, above] => Some([&**below, &**here, &**above]),
            _ => None,
        }
    }

    /// Whether all keypoints are described, if there are any.
    fn is_described(&self) -> bool {
        !self.described.is_empty() && self.described.len() == self.kept().len()
    }

    /// Returns the described keypoints, the strongest first.
    fn features(&self) -> PointField {
        let described =
            || self.kept().iter().zip(&self.described).map(|(index, described)| (&self.maxima[*index], described));
        let feature = |(maximum, _): (&Maximum, &Described)| Feature {
            at: maximum.blob.at,
            displacement: None,
            status: Status::Found,
            residual: None,
        };
        let keypoint = |(maximum, described): (&Maximum, &Described)| Keypoint {
            response: maximum.refined.response,
            scale_px: Some(maximum.blob.scale),
            angle_rad: Some(described.angle_rad),
            descriptor: Some(Descriptor::Reals(Arc::clone(&described.values))),
        };
        PointField {
            picture: self.picture.size(),
            points: described().map(feature).collect(),
            keypoints: described().map(keypoint).collect(),
        }
    }
}

impl Surf {
    fn begin(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let picture = clip.frame(frame)?;
        let octaves = self.octaves_in(picture.size());
        Ok(State {
            picture,
            integral: None,
            octaves,
            layers: Vec::new(),
            searched: 0,
            maxima: Arc::default(),
            kept: None,
            described: Vec::new(),
        })
    }

    /// The number of octaves whose largest filter fits into a picture; at least one.
    fn octaves_in(&self, (width, height): (usize, usize)) -> usize {
        let fits = |octave: &usize| Filter::of(*octave, LAYERS - 1).size <= width.min(height);
        (1..self.octaves).take_while(fits).count() + 1
    }

    /// Finds and refines the maxima of middle layer `index`.
    fn search(&self, state: &State, index: usize, observer: &mut impl Observer<Event>) -> Vec<Maximum> {
        observer.see(|| Event::Thresholded);
        let Some(layers) = state.three(index) else { return Vec::new() };
        let (width, height) = layers[1].responses.size();
        let mut maxima = Vec::new();
        for j in 1..height.saturating_sub(1) {
            let row = layers[1].responses.row(j);
            for i in (1..width.saturating_sub(1)).filter(|i| row[*i] > self.threshold) {
                let sample = (i, j);
                // A neighbour in a layer whose filter does not fit is unknown.
                if !layers[2].fits(sample, state.picture.size()) {
                    continue;
                }
                // The suppressing neighbour is determined only for an observer.
                observer.see(|| Event::Compared(sample, suppressed_by(layers, sample)));
                if is_suppressed(layers, sample) {
                    continue;
                }
                let refined = Refined::of(layers, sample);
                observer.see(|| Event::Refined(sample, refined));
                maxima.extend(refined.filter(Refined::is_near).map(|refined| maximum(layers, index, sample, refined)));
            }
        }
        maxima
    }

    /// Ranks the maxima and selects the strongest with the minimum distance.
    fn choose(&self, state: &mut State, observer: &mut impl Observer<Event>) {
        let mut maxima = state.maxima.to_vec();
        maxima.sort_by(|a, b| b.refined.response.total_cmp(&a.refined.response));
        let maxima = Arc::new(maxima);
        observer.see(|| Event::Ranked(Arc::clone(&maxima)));
        let (width, height) = state.picture.size();
        let nearest = |c: f32, extent: usize| (c.round().max(0.0) as usize).min(extent.saturating_sub(1));
        let place = |[x, y]: [f32; 2]| (nearest(y, height) * width + nearest(x, width)) as u32;
        let places: Vec<u32> = maxima.iter().map(|maximum| place(maximum.blob.at)).collect();
        let (mut next, mut kept) = (0, Vec::new());
        choose(&places, (width, height), self.selection, |_, near| {
            let near = near.and_then(|near| kept.iter().copied().find(|index: &usize| places[*index] == near));
            observer.see(|| Event::Peak(next, near));
            if near.is_none() {
                kept.push(next);
            }
            next += 1;
        });
        (state.maxima, state.kept) = (maxima, Some(kept.into()));
    }

    /// Orients and describes a keypoint.
    fn describe(&self, integral: &Integral, blob: Blob, observer: &mut impl Observer<Event>) -> Described {
        let angle_rad = if self.upright { 0.0 } else { orientation(integral, blob, observer) };
        observer.see(|| Event::Oriented(angle_rad));
        let mut values = Vec::with_capacity(VALUES);
        for k in 0..SIDE * SIDE {
            let sums = haar::subregion(integral, blob, angle_rad, k);
            observer.see(|| Event::Subregion(sums));
            values.extend(sums);
        }
        let (values, length) = haar::normalized(&values);
        observer.see(|| Event::UnitLength(length));
        Described { angle_rad, values: values.into() }
    }

    fn work(&self, state: &mut State, observer: &mut impl Observer<Event>) {
        match (state.part(), state.integral.clone()) {
            (Part::Layer(index), Some(integral)) => {
                let layer = Arc::new(Layer::of(&integral, index / LAYERS, index % LAYERS));
                see_layer(&layer, observer);
                state.layers.push(layer);
            }
            (Part::Search(index), _) => {
                let found = self.search(state, index, observer);
                Arc::make_mut(&mut state.maxima).extend(found);
                state.searched += 1;
            }
            (Part::Choice, _) => self.choose(state, observer),
            (Part::Keypoint(index), Some(integral)) => {
                if let Some(blob) = state.keypoint(index).map(|maximum| maximum.blob) {
                    let described = self.describe(&integral, blob, observer);
                    state.described.push(described);
                }
            }
            (Part::Integral | Part::Layer(_) | Part::Keypoint(_), _) => {
                state.integral = Some(Arc::new(Integral::of(state.picture.luma())));
                observer.see(|| Event::Summed);
            }
        }
    }
}

fn see_layer(layer: &Arc<Layer>, observer: &mut impl Observer<Event>) {
    observer.see(|| Event::Filtered(Arc::clone(layer)));
    observer.see(|| Event::Down);
    observer.see(|| Event::Mixed);
    observer.see(|| Event::Determinant);
}

/// Computes the orientation of a keypoint.
fn orientation(integral: &Integral, blob: Blob, observer: &mut impl Observer<Event>) -> f32 {
    let spokes = haar::wheel(integral, blob);
    observer.see(|| Event::Wavelets);
    let sums = haar::sector_sums(&spokes, |sum| observer.see(|| Event::Sector(sum)));
    haar::dominant(&sums).1
}

/// A refined maximum of middle layer `index`, in px.
fn maximum([below, here, _]: Three<'_>, index: usize, sample: (usize, usize), refined: Refined) -> Maximum {
    let [dx, dy, ds] = refined.offset;
    let (x, y) = here.pixel(sample);
    let step = here.step as f32;
    let size = here.filter.size as f32 + ds * (here.filter.size - below.filter.size) as f32;
    Maximum {
        octave: index / MIDDLE,
        layer: index % MIDDLE + 1,
        sample,
        refined,
        blob: Blob { at: [x as f32 + dx * step, y as f32 + dy * step], scale: scale_of(size) },
    }
}

impl Estimator for Surf {
    const INFO: Info = Info {
        id: "surf",
        name: "SURF keypoints",
        family: "Interest points",
        summary: "Blobs by box filters on an integral image, with an orientation and a descriptor of 64 values from Haar wavelets.",
        source: "H. Bay, A. Ess, T. Tuytelaars and L. Van Gool, Speeded-up robust features (SURF), CVIU 110(3), 2008",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "part", "step"],
        frames: 1,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "maximum",
            "Is the next sample a maximum over position and scale?",
            &[
                Reply::told(line::SUPPRESS, case::MAXIMUM, "Yes"),
                Reply::told(line::SUPPRESS, case::SUPPRESSED, "No: suppressed"),
            ],
        ),
        Question::choice(
            "longest",
            "Does the next sector have the longest sum so far?",
            &[Reply::told(line::SECTOR, case::IS_LONGEST, "Yes"), Reply::told(line::SECTOR, case::IS_SHORTER, "No")],
        ),
    ];
    // Samples of coarse octaves do not move with the picture.
    const GUARANTEE: Guarantee = Guarantee::SubPixelPlaces { off_centi_px: 50 };
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Tiles];
    const PRODUCES: &'static [&'static ProductKind] = &[PointField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.begin(clip, frame)
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        self.work(state, observer);
        let is_done = state.kept.is_some() && state.described.len() == state.kept().len();
        Ok(if is_done { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.kept.as_ref().map(|kept| state.units_before() + kept.len())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let (stage, index, of) = match state.part() {
            Part::Integral => (0, 0, 1),
            Part::Layer(index) => (1, index, LAYERS * state.octaves),
            Part::Search(index) => (2, index, MIDDLE * state.octaves),
            Part::Choice => (3, 0, 1),
            Part::Keypoint(index) => (4, index, state.kept().len()),
        };
        let granularity = |index, of| Granularity { index, of: Some(of) };
        vec![granularity(0, 1), granularity(stage, 5), granularity(index, of)]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Filtered(_) | Event::Wavelets => Some(Role::Window),
            Event::Compared(_, None) => Some(Role::Best),
            Event::Peak(_, None) => Some(Role::Result),
            Event::Compared(_, Some(_)) | Event::Refined(_, None) | Event::Peak(_, Some(_)) => Some(Role::Rejected),
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
        Output::of(state.features())
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.begin(clip, frame)?;
        clip.wanted()?;
        let integral = Arc::new(Integral::of(state.picture.luma()));
        tally.add_events(1);
        state.integral = Some(Arc::clone(&integral));
        let layer = |index| {
            let layer = Arc::new(Layer::of(&integral, index / LAYERS, index % LAYERS));
            see_layer(&layer, &mut tally.counter());
            layer
        };
        state.layers = threads.map_while(LAYERS * state.octaves, || clip.wanted(), layer)?;
        state.searched = MIDDLE * state.octaves;
        let search = |index| self.search(&state, index, &mut tally.counter());
        let maxima = threads.map_while(state.searched, || clip.wanted(), search)?;
        state.maxima = Arc::new(maxima.concat());
        self.choose(&mut state, &mut tally.counter());
        let blobs: Vec<Blob> = state.kept().iter().map(|index| state.maxima[*index].blob).collect();
        tally.add_units(state.units_before() + blobs.len());
        let describe = |i: usize| self.describe(&integral, blobs[i], &mut tally.counter());
        state.described = threads.map_while(blobs.len(), || clip.wanted(), describe)?;
        Ok(state)
    }
}

impl Footprint<State> for Surf {
    fn need(&self, clip: &Clip) -> Need {
        let (width, height) = clip.size();
        let pixels = (width * height) as f64;
        // The layers of all octaves take a third more than those of the first; every eighth sample may be a maximum.
        let maxima = 4.0 / 3.0 * pixels / 8.0 * MIDDLE as f64 * size_of::<Maximum>() as f64;
        let points = (self.selection.max_points as f64).min(pixels / 4.0) * 600.0;
        let buckets = 40.0 * pixels / (self.selection.min_distance.max(2) as f64).powi(2);
        let events = pixels * size_of::<Event>() as f64;
        let run = 30.0 * pixels + 2.0 * maxima + points + buckets;
        Need::per_pixel(clip, [0.0; 2]).and([run, run + maxima + events + 3.0 * points])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let described = state.described.len() * (size_of::<Described>() + VALUES * size_of::<f32>());
        size_of::<State>() + size_of_val(&state.layers[..]) + size_of_val(&state.maxima[..]) + described
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let layers: usize = state.layers.iter().map(|layer| size_of_val(layer.responses.cells())).sum();
        self.state_bytes(state) + layers + state.integral.as_ref().map_or(0, |integral| integral.bytes())
    }
}

impl Pointed<State> for Surf {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        let distance = |index: &usize| {
            let [x, y] = state.maxima[*index].blob.at;
            (x - point[0]).hypot(y - point[1])
        };
        let nearest = state.kept().iter().map(distance).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|(_, distance)| *distance < NEAR).map(|(index, _)| state.units_before() + index)
    }
}

/// A click within this distance selects a keypoint, in px.
const NEAR: f32 = 8.0;
