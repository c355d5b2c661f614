//! Phase correlation: the translation between two frames as the peak of the inverse transform of their phase difference.

mod charts;
mod doubt;
mod explain;
mod spectrum;
mod unexplained;
mod vocabulary;

use std::sync::Arc;

use rustfft::num_complex::Complex;

use crate::base::{Error, Observer};
use crate::data::{Clip, Flow, Frame};
use crate::geometry::{Gray, Grid};
use crate::methods::differential::truth;
use crate::products::model::IDENTITY;
use crate::products::{Model, ModelField, Output, Product, ProductKind};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen};
use crate::scene::{Chart, Question, Reply, Scene, Step};
use crate::{choices, params, pseudocode};
use doubt::Doubt;
use spectrum::{Direction, hann, mean};
use vocabulary::{case, value};

choices! {
    /// Sub-pixel position of the peak.
    pub enum Subpixel {
        /// Whole px.
        None = "none" "Off",
        /// Ratio of the larger neighbour to its sum with the peak, as a downsampled translation leaves it (Foroosh et al. 2002).
        Ratio = "ratio" "Ratio of neighbours",
        /// Vertex of the parabola through the peak and its neighbours.
        Parabola = "parabola" "Parabola",
    }
}

params! {
    /// Phase correlation.
    pub struct PhaseCorrelation {
        /// Multiply both frames by a Hann window, which fades to 0 at the border. Without it, the jump from one border to the opposite
        /// one shows as a peak at zero displacement, also of frames that have nothing in common.
        hann: bool = true;
        /// Sub-pixel position of the peak, along x and y.
        subpixel: Subpixel = Subpixel::Ratio;
        /// Smallest ratio of a frequency's cross power to that of rounding to whole gray levels. Frequencies below it are left out,
        /// because their phase is noise.
        min_snr: f32 = 10.0, 0.0..=1000.0;
    }
    advanced { "min-snr" }
}

/// A picture of complex numbers.
type Spectrum = Grid<Complex<f64>>;

/// The constant part of a run.
struct Fixed {
    pair: [Arc<Frame>; 2],
    truth: Option<Arc<Flow>>,
    /// Mean gray level of each frame.
    means: [f64; 2],
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// Number of completed stages.
    done: usize,
    /// The windowed frames, then their spectra.
    spectra: [Option<Arc<Spectrum>>; 2],
    /// The cross-power spectrum, then the phase correlation.
    cross: Option<Arc<Spectrum>>,
    /// Number of frequencies that are not left out.
    kept: usize,
    /// The largest ratio of a frequency's cross power to that of rounding.
    highest_snr: f64,
    /// The smallest accepted peak, in standard deviations of the correlation.
    least_sigmas: f64,
    peak: Option<(usize, usize)>,
    second: Option<(usize, usize)>,
    /// Evidence in the pictures against the highest peak.
    doubt: Option<Doubt>,
    /// Sub-pixel part of the displacement.
    fraction: [f64; 2],
}

/// A stage of the computation, one for each unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A frame, 0 or 1, without its mean, under the window.
    Window(usize),
    /// The transforms of its rows.
    Rows(usize),
    /// The transforms of the columns of these.
    Columns(usize),
    /// The product of one spectrum with the conjugate of the other.
    Cross,
    /// Its phase alone.
    Normalize,
    /// The inverse transforms of the columns, and of the rows.
    InverseColumns,
    /// The inverse transforms of the rows.
    InverseRows,
    /// The highest value.
    Peak,
    /// The next peak.
    Second,
    /// The sub-pixel position along x (0) or y (1).
    Subpixel(usize),
    /// The translation.
    Result,
}

/// All stages in their order.
const STAGES: [Stage; 15] = [
    Stage::Window(0),
    Stage::Window(1),
    Stage::Rows(0),
    Stage::Columns(0),
    Stage::Rows(1),
    Stage::Columns(1),
    Stage::Cross,
    Stage::Normalize,
    Stage::InverseColumns,
    Stage::InverseRows,
    Stage::Peak,
    Stage::Second,
    Stage::Subpixel(0),
    Stage::Subpixel(1),
    Stage::Result,
];

/// A stage with its result.
#[derive(Clone)]
pub struct Event {
    stage: Stage,
    state: Arc<State>,
}

impl State {
    fn size(&self) -> (usize, usize) {
        self.fixed.pair[0].size()
    }

    /// The displacement of a place of the correlation: beyond half the picture it is negative.
    fn wrapped(&self, (x, y): (usize, usize)) -> [i32; 2] {
        let (width, height) = self.size();
        let signed = |c: usize, extent: usize| if 2 * c > extent { c as i32 - extent as i32 } else { c as i32 };
        [signed(x, width), signed(y, height)]
    }

    fn height_at(&self, [u, v]: [i32; 2]) -> f64 {
        let (width, height) = self.size();
        let place = (u.rem_euclid(width as i32) as usize, v.rem_euclid(height as i32) as usize);
        self.cross.as_ref().map_or(0.0, |cross| cross[place].re)
    }

    /// The standard deviation of the correlation over all displacements, by Parseval's theorem, if not all of it is the peak.
    fn sigma(&self) -> f64 {
        1.0 / (self.kept.max(1) as f64).sqrt()
    }

    /// The height of the peak in standard deviations of the correlation.
    fn sigmas(&self) -> Option<f64> {
        Some(self.height_at(self.wrapped(self.peak?)) / self.sigma())
    }

    /// Whether the peak exceeds the peaks of unrelated frames.
    fn is_significant(&self) -> bool {
        self.sigmas().is_some_and(|sigmas| sigmas >= self.least_sigmas)
    }

    /// Whether the peak is the translation: significant, and not contradicted by the pictures.
    fn is_accepted(&self) -> bool {
        self.is_significant() && !self.doubt.is_some_and(|doubt| doubt.is_refuting())
    }

    /// The translation so far, in px.
    fn translation(&self) -> [f64; 2] {
        let whole = self.peak.map_or([0, 0], |peak| self.wrapped(peak));
        [0, 1].map(|i| f64::from(whole[i]) + self.fraction[i])
    }

    fn model(&self) -> ModelField {
        let [u, v] = self.translation();
        let mut matrix = IDENTITY;
        (matrix[0][2], matrix[1][2]) = (u, v);
        ModelField {
            picture: self.size(),
            model: Model::Translation,
            matrix: self.is_accepted().then_some(matrix),
            iterations: 0,
            residual_px: None,
            support: None,
        }
    }
}

impl PhaseCorrelation {
    /// The frame without its mean, under the window.
    fn windowed(&self, luma: &Gray, mean: f64) -> Spectrum {
        let (across, down) = (self.weights(luma.width()), self.weights(luma.height()));
        Grid::from_fn(luma.width(), luma.height(), |x, y| {
            Complex::new((f64::from(luma[(x, y)]) - mean) * across[x] * down[y], 0.0)
        })
    }

    fn weights(&self, extent: usize) -> Vec<f64> {
        if self.hann { hann(extent) } else { vec![1.0; extent] }
    }

    /// The cross power of rounding to whole gray levels.
    fn of_rounding(&self, (width, height): (usize, usize)) -> f64 {
        /// The variance of a rounding error, in gray levels².
        const VARIANCE: f64 = 1.0 / 12.0;
        let power = |extent| self.weights(extent).into_iter().map(|weight| weight * weight).sum::<f64>();
        VARIANCE * power(width) * power(height)
    }

    /// The smallest accepted peak in standard deviations of the correlation: higher than the highest of `kept` random phases in 99 % of all
    /// pairs, by the tail of the normal distribution, ½ exp(−z²/2).
    fn least_sigmas(&self, kept: usize) -> f64 {
        /// Share of the pairs.
        const FALSE_ALARMS: f64 = 0.01;
        /// The Hann window correlates neighbouring frequencies, which raises the correlation near displacement 0 by
        /// this factor.
        const OF_HANN: f64 = 1.65;
        /// A peak of this height is significant whatever the number of frequencies.
        const MOST: f64 = 0.9;
        let count = kept.max(1) as f64;
        let highest = (2.0 * (0.5 * count / FALSE_ALARMS).ln()).sqrt();
        (if self.hann { OF_HANN * highest } else { highest }).min(MOST * count.sqrt())
    }

    fn perform(&self, state: &mut State, stage: Stage) {
        let size = state.size();
        let whole = |of: &Option<Arc<Spectrum>>| {
            of.clone().unwrap_or_else(|| Arc::new(Grid::new(size.0, size.1, Complex::default())))
        };
        match stage {
            Stage::Window(i) => {
                let windowed = self.windowed(state.fixed.pair[i].luma(), state.fixed.means[i]);
                state.spectra[i] = Some(Arc::new(windowed));
            }
            Stage::Rows(i) => {
                state.spectra[i] = Some(Arc::new(spectrum::rows(&whole(&state.spectra[i]), Direction::Forward)))
            }
            Stage::Columns(i) => {
                state.spectra[i] = Some(Arc::new(spectrum::columns(&whole(&state.spectra[i]), Direction::Forward)));
            }
            Stage::Cross => {
                let [first, second] = state.spectra.each_ref().map(whole);
                state.cross =
                    Some(Arc::new(Grid::from_fn(size.0, size.1, |x, y| second[(x, y)] * first[(x, y)].conj())));
            }
            Stage::Normalize => {
                let (cross, of_rounding) = (whole(&state.cross), self.of_rounding(size));
                // A frequency with less is left out.
                let noise = f64::from(self.min_snr) * of_rounding;
                let highest = cross.cells().iter().map(|value| value.norm()).fold(0.0, f64::max);
                state.highest_snr = highest / of_rounding.max(f64::MIN_POSITIVE);
                let is_kept = |value: &Complex<f64>| value.norm() > noise.max(f64::MIN_POSITIVE);
                state.kept = cross.cells().iter().filter(|value| is_kept(value)).count();
                state.least_sigmas = self.least_sigmas(state.kept);
                let phase =
                    |value: &Complex<f64>| if is_kept(value) { value / value.norm() } else { Complex::default() };
                state.cross = Some(Arc::new(cross.map(phase)));
                state.spectra = [None, None];
            }
            Stage::InverseColumns => {
                state.cross = Some(Arc::new(spectrum::columns(&whole(&state.cross), Direction::Inverse)))
            }
            Stage::InverseRows => {
                // By the frequencies that are kept: an exact translation has a peak of 1.
                let scale = 1.0 / state.kept.max(1) as f64;
                let correlation = spectrum::rows(&whole(&state.cross), Direction::Inverse).map(|value| value * scale);
                state.cross = Some(Arc::new(correlation));
            }
            Stage::Peak => state.peak = spectrum::peak(&whole(&state.cross), None).filter(|_| state.kept > 0),
            Stage::Second => {
                state.second = state.peak.and_then(|peak| spectrum::peak(&whole(&state.cross), Some(peak)));
                state.doubt = Doubt::of(state);
            }
            Stage::Subpixel(i) => state.fraction[i] = self.fraction(state, i),
            Stage::Result => {}
        }
    }

    /// The heights of the correlation beside the peak, along x (0) or y (1), and at it.
    fn around(state: &State, axis: usize) -> Option<[f64; 3]> {
        let at = state.wrapped(state.peak?);
        let size = [state.size().0, state.size().1];
        let beside = |step: i32| {
            let mut at = at;
            at[axis] += step;
            state.height_at(at)
        };
        (size[axis] > 2).then(|| [-1, 0, 1].map(beside))
    }

    /// The sub-pixel part of the peak along an axis.
    fn fraction(&self, state: &State, axis: usize) -> f64 {
        let Some([before, at, after]) = Self::around(state, axis) else { return 0.0 };
        match self.subpixel {
            Subpixel::None => 0.0,
            Subpixel::Ratio => {
                let (side, sign) = larger_side([before, after]);
                if side > 0.0 { (sign * side / (side + at)).clamp(-0.5, 0.5) } else { 0.0 }
            }
            Subpixel::Parabola => {
                let curvature = before - 2.0 * at + after;
                if curvature < 0.0 { ((before - after) / (2.0 * curvature)).clamp(-0.5, 0.5) } else { 0.0 }
            }
        }
    }
}

/// The larger neighbour of a peak and its side. The window adds the same to both sides, which is subtracted.
fn larger_side([before, after]: [f64; 2]) -> (f64, f64) {
    if after > before { (after - before.max(0.0), 1.0) } else { (before - after.max(0.0), -1.0) }
}

pseudocode! {
    WINDOW: "g₁, g₂ ← (frames t, t+1 − their means) · Hann window",
    TRANSFORM_ROWS: "G₁, G₂ ← Fourier transforms of g₁, g₂: of all rows,",
    TRANSFORM_COLUMNS: "  then of all columns",
    MULTIPLY: "C ← G₂ · conjugate of G₁",
    NORMALISE: "R ← C / |C|, 0 where |C| is noise",
    INVERT_COLUMNS: "r ← inverse Fourier transform of R: of all columns,",
    INVERT_ROWS: "  then of all rows",
    TAKE_PEAK: "d ← place of the highest r, unknown below the noise of r; beyond half the picture it is negative",
    COMPARE_SECOND: "compare r(d), and the residual at d, with the next peaks",
    REFINE_X: "d_x ← d_x + sub-pixel offset from the neighbours along x",
    REFINE_Y: "d_y ← d_y + sub-pixel offset from the neighbours along y",
    TAKE_RESULT: "every pixel moves by d",
}

impl Estimator for PhaseCorrelation {
    const INFO: Info = Info {
        id: "phase-correlation",
        name: "Phase correlation",
        family: "Correspondence",
        summary: "The translation between two frames as the peak of the inverse Fourier transform of their phase difference.",
        source: "C. D. Kuglin and D. C. Hines, The phase correlation image alignment method, IEEE Conf. Cybernetics and Society, \
                 1975; sub-pixel: H. Foroosh, J. B. Zerubia and M. Berthod, Extension of phase correlation to subpixel \
                 registration, IEEE Trans. Image Processing 11(3), 2002",
        pseudocode: line::ALL,
        granularities: &["pair", "stage", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "distinct",
            "Is the peak distinct?",
            &[
                Reply::told(line::COMPARE_SECOND, case::IS_DISTINCT, "Yes"),
                Reply::told(line::COMPARE_SECOND, case::AMBIGUOUS, "No: another is nearly as high"),
            ],
        ),
        Question::value("peak", "How high is the highest peak?", line::TAKE_PEAK, value::PEAK_HEIGHT),
    ];
    const GUARANTEE: Guarantee = Guarantee::Better;
    const CHARTS: &'static [Chart] = &[Chart::Surface, Chart::Tiles, Chart::Matrices];
    const PRODUCES: &'static [&'static ProductKind] = &[ModelField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let pair = clip.pair(frame)?;
        let means = pair.each_ref().map(|frame| mean(frame.luma()));
        let fixed = Fixed { pair, truth: truth(clip, frame), means };
        Ok(State {
            fixed: Arc::new(fixed),
            done: 0,
            spectra: [None, None],
            cross: None,
            kept: 0,
            highest_snr: 0.0,
            least_sigmas: 0.0,
            peak: None,
            second: None,
            doubt: None,
            fraction: [0.0; 2],
        })
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let stage = STAGES[state.done];
        self.perform(state, stage);
        state.done += 1;
        observer.see(|| Event { stage, state: Arc::new(state.clone()) });
        Ok(if state.done == STAGES.len() { Progress::Done } else { Progress::More })
    }

    fn units(&self, _: &State) -> Option<usize> {
        Some(STAGES.len())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.done, of: Some(STAGES.len()) }]
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(state.model())
    }
}

impl Footprint<State> for PhaseCorrelation {
    fn need(&self, clip: &Clip) -> Need {
        // Three pictures of complex numbers, and a fourth while one is computed; checkpoints keep their own.
        Need::per_pixel(clip, [16.0 * 5.0, 16.0 * 12.0])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let pictures = state.spectra.iter().flatten().count() + usize::from(state.cross.is_some());
        let (width, height) = state.size();
        size_of::<State>() + pictures * width * height * size_of::<Complex<f64>>()
    }
}
