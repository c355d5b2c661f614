//! The correlation filter MOSSE: trained to respond with a peak at the object, and updated in every frame.

mod appearance;
mod explain;
mod lanes;
mod perturbation;
mod transform;
mod vocabulary;

use std::sync::Arc;

use rustfft::num_complex::Complex;

use crate::base::{LANES, Observer, effort};
use crate::data::{Clip, Frame};
use crate::geometry::{Border, Gray, Grid};
use crate::methods::region::{LOST, Refusal, RegionModel, Settings, Similarity, WHERE};
use crate::products::{Region, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question, Reply};
use crate::{params, pseudocode};

use appearance::{Appearance, Evidence};
use lanes::Lanes;
use transform::{Spectrum, Transform, hann};
use vocabulary::{case, value};

params! {
    /// Correlation filter (MOSSE).
    pub struct CorrelationFilter {
        /// Region and frames.
        settings: Settings = Settings::default();
        /// Side of the window of the filter, as a multiple of that of the region. The window function fades the border of the window, so at a
        /// scale of 1 it fades the object itself. A larger one reaches larger displacements and has more sidelobes for the peak to stand out
        /// from, but learns more of the background.
        window_scale: f32 = 2.5, 1.0..=4.0;
        /// Standard deviation of the Gaussian that the filter is to answer with.
        sigma: f32 = 2.0, 0.5..=10.0, "px";
        /// Share η of the newest frame in the filter. Large values follow changes of appearance, and drift more.
        learning_rate: f32 = 0.125, 0.0..=1.0;
        /// Peak-to-sidelobe ratio below which the object is lost: the region stays, and the filter is not updated. 0 for no losses at all.
        min_psr: f32 = 7.0, 0.0..=50.0;
        /// Number of turned and scaled copies of the first window that the filter is learned from.
        perturbations: usize = 8, 0..=64;
        /// Largest rotation of these copies. The filter does not recognise an object that turns farther than this between two frames; large
        /// rotations blur its pattern.
        rotation: f32 = 45.0, 0.0..=180.0, "°";
        /// Random seed of these copies. The same seed gives the same copies.
        seed: u32 = 1, 0..=9999;
    }
    advanced { "sigma", "seed" }
    when {
        "rotation": |p| p.perturbations > 0, "Rotation has no effect without perturbations.";
        "seed": |p| p.perturbations > 0, "The seed has no effect without perturbations.";
    }
}

/// The longest side of a window in px.
const MOST_PX: f32 = 512.0;
/// The shortest side of a window in px.
const LEAST_PX: f32 = 8.0;
/// The smallest standard deviation of a window with texture, in gray levels.
const LEAST_DEVIATION: f64 = 1.0;
/// Sidelobes are farther from the peak than this, in px.
const SIDELOBE_PX: usize = 5;
/// Regularisation of the filter: the least energy of a frequency, as a share of the mean.
const REGULARIZATION: f32 = 1e-3;

/// Number of gray levels.
const LEVELS: usize = 256;

/// The constant data of the filter.
pub struct Fixed {
    transform: Transform,
    /// The window function along x and y.
    hann: [Vec<f32>; 2],
    /// log(1 + gray level).
    logarithms: [f64; LEVELS],
    /// The spectrum of the Gaussian.
    target: Spectrum,
}

/// The filter H* = A / B.
#[derive(Clone)]
pub struct Model {
    fixed: Arc<Fixed>,
    /// Numerator Σ G F*.
    numerator: Arc<Spectrum>,
    /// Denominator Σ F F*.
    energy: Arc<Vec<Lanes>>,
    /// The region of the first frame.
    first: Arc<Appearance>,
}

/// The response of a frame.
pub struct Response {
    /// The first pixel of the window.
    pub origin: [i32; 2],
    /// The window: logarithm, without its mean, of norm 1, under the window function.
    pub patch: Grid<f32>,
    /// The response at each displacement, with 0 in the middle.
    pub values: Grid<f32>,
    /// The place of its highest value.
    pub peak: (usize, usize),
    /// The sub-pixel displacement in px.
    pub displacement: [f32; 2],
    /// The peak-to-sidelobe ratio.
    pub psr: f32,
    /// Mean and standard deviation of the sidelobes.
    pub sidelobes: [f32; 2],
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The filter of the first frame, and the window that it was learned from.
    Learned(Arc<Grid<f32>>, Model),
    /// The window of a frame.
    Cut(Arc<Response>),
    /// Its response.
    Responded(Arc<Response>),
    /// The peak.
    Found(Arc<Response>),
    /// The peak-to-sidelobe ratio, and where the peak stands out the region there.
    Judged(Arc<Response>, Option<Evidence>),
    /// The updated filter.
    Updated(Arc<Response>, Model),
}

impl Model {
    fn size(&self) -> (usize, usize) {
        self.fixed.transform.size()
    }

    /// The conjugate filter H* at each frequency.
    fn filter(&self) -> Spectrum {
        let least = REGULARIZATION * self.fixed.transform.mean(&self.energy) + f32::MIN_POSITIVE;
        let least = Lanes::all(least);
        self.numerator.iter().zip(&self.energy[..]).map(|(a, b)| a / (*b + least)).collect()
    }

    /// Adds the spectrum of a window with a weight.
    fn add(&mut self, spectrum: &Spectrum, keep: f32, add: f32) {
        let [keep, add] = [keep, add].map(Lanes::all);
        let target = &self.fixed.target;
        let numerator = Arc::make_mut(&mut self.numerator);
        for ((a, f), g) in numerator.iter_mut().zip(spectrum).zip(target) {
            *a = *a * keep + g * f.conj() * add;
        }
        for (b, f) in Arc::make_mut(&mut self.energy).iter_mut().zip(spectrum) {
            *b = *b * keep + f.norm_sqr() * add;
        }
    }

    /// The first pixel of the window around a centre.
    fn origin(&self, center: [f32; 2]) -> [i32; 2] {
        origin(center, self.size())
    }

    /// A window of gray levels, prepared for the filter: for each level the logarithm without the mean of all pixels, of norm 1;
    /// then under the window function.
    fn prepared(&self, levels: &Gray) -> Grid<f32> {
        let (width, height) = self.size();
        let Fixed { logarithms, hann: [across, down], .. } = &*self.fixed;
        effort::add(width * height);
        let counts = counts(levels);
        let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
            counts.iter().zip(logarithms).map(|(count, log)| f64::from(*count) * of(*log)).sum()
        };
        let mean = sum(&|log| log) / (width * height) as f64;
        let norm = sum(&|log| (log - mean) * (log - mean)).sqrt();
        let scale = if norm > 0.0 { 1.0 / norm } else { 0.0 };
        let values = logarithms.map(|log| ((log - mean) * scale) as f32);
        let mut patch = Grid::new(width, height, 0.0);
        for (y, down) in down.iter().enumerate().take(height) {
            let cells = patch.row_mut(y).iter_mut().zip(levels.row(y));
            cells.zip(across).for_each(|((v, level), across)| *v = values[usize::from(*level)] * down * across);
        }
        patch
    }

    /// The window of a frame.
    fn window(&self, luma: &Gray, origin: [i32; 2]) -> Grid<f32> {
        self.prepared(&levels(luma, origin, self.size()))
    }

    fn spectrum(&self, patch: &Grid<f32>) -> Spectrum {
        self.fixed.transform.forward(patch.cells())
    }

    /// The response of the filter to a frame, for an object that was at `center`.
    fn response(&self, luma: &Gray, center: [f32; 2]) -> Response {
        let origin = self.origin(center);
        let patch = self.window(luma, origin);
        let mut product = self.spectrum(&patch);
        product.iter_mut().zip(self.filter()).for_each(|(f, h)| *f = *f * h);
        let (width, height) = self.size();
        let mut values = Grid::new(width, height, 0.0);
        values.cells_mut().copy_from_slice(&self.fixed.transform.inverse(product));
        let peak = highest(&values);
        let [mean, deviation] = sidelobes(&values, peak);
        let psr = if deviation > 0.0 { (values[peak] - mean) / deviation } else { 0.0 };
        let displacement = displacement(&values, peak);
        Response { origin, patch, values, peak, displacement, psr, sidelobes: [mean, deviation] }
    }
}

/// The first pixel of a window of this size around a centre.
fn origin(center: [f32; 2], (width, height): (usize, usize)) -> [i32; 2] {
    [center[0].round() as i32 - width as i32 / 2, center[1].round() as i32 - height as i32 / 2]
}

/// The gray levels of the window of a frame, which is repeated beyond its border.
fn levels(luma: &Gray, [left, top]: [i32; 2], (width, height): (usize, usize)) -> Gray {
    let columns = left as isize..left as isize + width as isize;
    let is_inside = columns.start >= 0 && columns.end as usize <= luma.width();
    let mut levels = Grid::new(width, height, 0);
    for y in 0..height {
        let source = luma.row(Border::Replicate.index(top as isize + y as isize, luma.height()));
        let target = levels.row_mut(y);
        match is_inside {
            true => target.copy_from_slice(&source[columns.start as usize..][..width]),
            false => {
                let at = |x| source[Border::Replicate.index(x, source.len())];
                target.iter_mut().zip(columns.clone()).for_each(|(level, x)| *level = at(x));
            }
        }
    }
    levels
}

/// The number of pixels of each gray level.
fn counts(levels: &Gray) -> [u32; LEVELS] {
    // In turn, because equal neighbours would wait for each other.
    let mut turns = [[0; LEVELS]; 4];
    for levels in levels.cells().chunks(turns.len()) {
        levels.iter().zip(&mut turns).for_each(|(level, counts)| counts[usize::from(*level)] += 1);
    }
    std::array::from_fn(|level| turns.iter().map(|counts| counts[level]).sum())
}

/// The place of the highest value, the first of equals.
fn highest(values: &Grid<f32>) -> (usize, usize) {
    let higher = |a: f32, b: f32| if b > a { b } else { a };
    let (groups, rest) = values.cells().as_chunks::<LANES>();
    let mut lanes = [f32::NEG_INFINITY; LANES];
    groups.iter().for_each(|group| lanes.iter_mut().zip(group).for_each(|(most, v)| *most = higher(*most, *v)));
    let most = lanes.iter().chain(rest).copied().fold(f32::NEG_INFINITY, higher);
    let best = values.cells().iter().position(|v| *v == most).unwrap_or(0);
    (best % values.width(), best / values.width())
}

/// The sums of values and of their squares.
fn sums(values: &[f32]) -> [f32; 2] {
    let (groups, rest) = values.as_chunks::<LANES>();
    let [mut sum, mut squares] = [[0.0; LANES]; 2];
    for group in groups {
        for ((sum, square), v) in sum.iter_mut().zip(&mut squares).zip(group) {
            *sum += v;
            *square += v * v;
        }
    }
    let rest = [rest.iter().sum(), rest.iter().map(|v| v * v).sum::<f32>()];
    [sum.iter().sum::<f32>() + rest[0], squares.iter().sum::<f32>() + rest[1]]
}

/// The mean and the standard deviation of the values outside an 11×11 window around the peak.
fn sidelobes(values: &Grid<f32>, (px, py): (usize, usize)) -> [f32; 2] {
    let (width, height) = values.size();
    let (mut sum, mut squares, mut count) = (0.0f64, 0.0f64, 0usize);
    let mut add = |cells: &[f32]| {
        let [own, own_squares] = sums(cells);
        (sum, squares, count) = (sum + f64::from(own), squares + f64::from(own_squares), count + cells.len());
    };
    for y in 0..height {
        let row = values.row(y);
        if y.abs_diff(py) > SIDELOBE_PX {
            add(row);
        } else {
            add(&row[..px.saturating_sub(SIDELOBE_PX)]);
            add(&row[(px + SIDELOBE_PX + 1).min(width)..]);
        }
    }
    if count == 0 {
        return [0.0; 2];
    }
    let mean = sum / count as f64;
    [mean as f32, (squares / count as f64 - mean * mean).max(0.0).sqrt() as f32]
}

/// The displacement of the peak from the middle, with the vertices of parabolas along x and y.
fn displacement(values: &Grid<f32>, (x, y): (usize, usize)) -> [f32; 2] {
    let (width, height) = values.size();
    let vertex = |around: Option<[f32; 3]>| {
        let Some([before, at, after]) = around else { return 0.0 };
        let curvature = before - 2.0 * at + after;
        if curvature < 0.0 { ((before - after) / (2.0 * curvature)).clamp(-0.5, 0.5) } else { 0.0 }
    };
    let along_x = (x > 0 && x + 1 < width).then(|| [values[(x - 1, y)], values[(x, y)], values[(x + 1, y)]]);
    let along_y = (y > 0 && y + 1 < height).then(|| [values[(x, y - 1)], values[(x, y)], values[(x, y + 1)]]);
    [x as f32 - (width / 2) as f32 + vertex(along_x), y as f32 - (height / 2) as f32 + vertex(along_y)]
}

impl CorrelationFilter {
    /// Whether the region shows its surroundings, if losses are detected at all.
    fn is_gone(&self, evidence: &Evidence) -> bool {
        self.min_psr > 0.0 && evidence.is_gone()
    }

    /// Width and height of the window for a region.
    fn window_of(&self, region: Region) -> (usize, usize) {
        let [width, height] =
            region.size.map(|side| (side * self.window_scale).round().clamp(LEAST_PX, MOST_PX) as usize);
        (width, height)
    }

    fn fixed(&self, (width, height): (usize, usize)) -> Fixed {
        let transform = Transform::new((width, height));
        let middle = [width / 2, height / 2];
        let gaussian = |i: usize| {
            let [dx, dy] = [(i % width) as f32 - middle[0] as f32, (i / width) as f32 - middle[1] as f32];
            (-(dx * dx + dy * dy) / (2.0 * self.sigma * self.sigma)).exp()
        };
        let target = transform.forward(&(0..width * height).map(gaussian).collect::<Vec<_>>());
        Fixed {
            transform,
            hann: [hann(width), hann(height)],
            logarithms: std::array::from_fn(|level| (1.0 + level as f64).ln()),
            target,
        }
    }
}

/// The standard deviation of the gray levels of a window, weighted by the window function.
fn deviation(levels: &Gray) -> f64 {
    let [across, down] = [hann(levels.width()), hann(levels.height())];
    let mut sums = [0.0; 3];
    for (y, down) in down.iter().enumerate() {
        for (level, across) in levels.row(y).iter().zip(&across) {
            let (weight, level) = (f64::from(across * down), f64::from(*level));
            sums = [sums[0] + weight, sums[1] + weight * level, sums[2] + weight * level * level];
        }
    }
    let [sum, levels, squares] = sums;
    let mean = levels / sum.max(f64::MIN_POSITIVE);
    (squares / sum.max(f64::MIN_POSITIVE) - mean * mean).max(0.0).sqrt()
}

pseudocode! {
    CHOOSE: "R ← region of the object in the first frame; stop if its window has no texture",
    LEARN: "H* ← Σ G F* / Σ F F*, F ← transforms of the window and of its perturbations, G ← that of a Gaussian",
    EACH_FRAME: "for each later frame t",
    CUT: "  f ← log of the window at the last position, mean 0, norm 1, times the Hann window; F ← its transform",
    RESPOND: "  g ← inverse transform of F H*: the response",
    TAKE_PEAK: "  d ← place of the highest g, with a parabola along x and y",
    JUDGE: "  PSR ← (peak − mean of the sidelobes) / their standard deviation; lost if PSR < min-psr, or if the region holds its surroundings",
    UPDATE: "  A ← η G F* + (1 − η) A, B ← η F F* + (1 − η) B at the new position; H* ← A / B",
    MOVE: "  the region moves by d, unless the object is lost",
}

impl RegionModel for CorrelationFilter {
    const INFO: Info = Info {
        id: "correlation-filter",
        name: "Correlation filter",
        family: "Region tracking",
        summary: "Learns a filter that answers with a Gaussian peak at the object, correlates each frame with it by Fourier transforms, and updates it.",
        source: "D. S. Bolme, J. R. Beveridge, B. A. Draper and Y. M. Lui, Visual object tracking using adaptive correlation filters, CVPR 2010",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        WHERE,
        Question::choice(
            "accepted",
            "Does the peak stand out from the sidelobes?",
            &[Reply::told(line::JUDGE, case::HIGH_PSR, "Yes"), Reply::told(line::JUDGE, case::LOW_PSR, "No: lost")],
        ),
        LOST,
    ];
    const CHARTS: &'static [Chart] = &[Chart::Surface, Chart::Tiles, Chart::Series];
    const SIMILARITY: Similarity = Similarity {
        name: "peak-to-sidelobe ratio",
        label: "Peak-to-sidelobe ratio",
        symbol: "PSR",
        decimals: 2,
        shared_by: "another object of like texture",
    };
    type Model = Model;
    type Event = Event;

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn refuse(&self, frame: &Frame, region: Region) -> Option<Refusal> {
        let size = self.window_of(region);
        let deviation = deviation(&levels(frame.luma(), origin(region.center, size), size));
        let size = [value::WIDTH.is(size.0), value::HEIGHT.is(size.1)];
        let deviations = [value::DEVIATION.is(deviation), value::LEAST_DEVIATION.is(LEAST_DEVIATION)];
        (deviation < LEAST_DEVIATION).then(|| (case::REFUSED, [size, deviations].concat()))
    }

    fn begin(&self, frame: &Arc<Frame>, region: Region, observer: &mut impl Observer<Event>) -> (Model, f32) {
        let (luma, size) = (frame.luma(), self.window_of(region));
        let fixed = self.fixed(size);
        let count = fixed.transform.length();
        let mut model = Model {
            fixed: Arc::new(fixed),
            numerator: Arc::new(vec![Complex::default(); count]),
            energy: Arc::new(vec![Lanes::default(); count]),
            first: Arc::new(Appearance::of(luma, region, size)),
        };
        let own = model.window(luma, model.origin(region.center));
        model.add(&model.spectrum(&own), 1.0, 1.0);
        for index in 0..self.perturbations {
            let patch = self.perturbed(&model, luma, region.center, index);
            model.add(&model.spectrum(&patch), 1.0, 1.0);
        }
        // A mean, like the running average of later frames.
        let share = Lanes::all(1.0 / (self.perturbations + 1) as f32);
        Arc::make_mut(&mut model.numerator).iter_mut().for_each(|a| *a = *a * share);
        Arc::make_mut(&mut model.energy).iter_mut().for_each(|b| *b = *b * share);
        observer.see(|| Event::Learned(Arc::new(own), model.clone()));
        let psr = model.response(luma, region.center).psr;
        (model, psr)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Event>,
    ) -> RegionFrame {
        let response = Arc::new(model.response(frame.luma(), region.center));
        observer.see(|| Event::Cut(Arc::clone(&response)));
        observer.see(|| Event::Responded(Arc::clone(&response)));
        observer.see(|| Event::Found(Arc::clone(&response)));
        let center = [0, 1].map(|i| {
            // The filter answers to the whole pixel that the window is around.
            let moved = region.center[i].round() + response.displacement[i];
            moved.clamp(-0.5, [frame.size().0, frame.size().1][i] as f32 - 0.5)
        });
        let evidence = (response.psr >= self.min_psr).then(|| model.first.compare(frame.luma(), center, model.size()));
        observer.see(|| Event::Judged(Arc::clone(&response), evidence));
        let similarity = response.psr;
        if evidence.is_none_or(|evidence| self.is_gone(&evidence)) {
            return RegionFrame { region, similarity, is_lost: true };
        }
        let patch = model.window(frame.luma(), model.origin(center));
        model.add(&model.spectrum(&patch), 1.0 - self.learning_rate, self.learning_rate);
        observer.see(|| Event::Updated(Arc::clone(&response), model.clone()));
        RegionFrame { region: region.at(center), similarity, is_lost: false }
    }

    fn need(&self, clip: &Clip) -> Need {
        // Spectra of a window; in a walk those of each event.
        let (width, height) = clip.size();
        let region = self.settings.region.map_or([width as f32, height as f32], |zone| zone.size());
        let side = |i: usize| f64::from((region[i] * self.window_scale).clamp(LEAST_PX, MOST_PX));
        let pixels = side(0) * side(1);
        Need::default().and([80.0 * pixels, 240.0 * pixels]).and([8e6; 2])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        size_of::<Model>() + size_of_val(&model.numerator[..]) + size_of_val(&model.energy[..])
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Learned(..) => line::LEARN,
            Event::Cut(_) => line::CUT,
            Event::Responded(_) => line::RESPOND,
            Event::Found(_) => line::TAKE_PEAK,
            Event::Judged(..) => line::JUDGE,
            Event::Updated(..) => line::UPDATE,
        }
    }
}
