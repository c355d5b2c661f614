//! The particle filter: hypotheses of position, velocity and scale, weighted by the likelihood of their colours.

mod charts;
mod cloud;
mod explain;
mod likelihood;
mod vocabulary;
mod wheel;

use std::sync::Arc;

use crate::base::Observer;
use crate::data::{Clip, Frame};
use crate::methods::region::color::{Bins, ColorBins, Histogram};
use crate::methods::region::{RegionModel, Settings, Similarity, WHERE};
use crate::products::{Region, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question, Reply};
use crate::{choices, params, pseudocode};

use cloud::{Draw, Estimate, Particle};
use likelihood::{Likelihood, Pattern};
use vocabulary::case;

choices! {
    /// The drawing of particles in proportion to their weights.
    pub enum Resampling {
        /// One random number for all: N equally spaced pointers on the wheel. A particle gets N w copies, rounded up or down.
        Systematic = "systematic" "Systematic",
        /// A random number for each: N independent spins of the wheel. The numbers of copies vary more.
        Multinomial = "multinomial" "Multinomial",
    }
}

params! {
    /// Particle filter.
    pub struct ParticleFilter {
        /// Region and frames.
        settings: Settings = Settings::default();
        /// Number of particles N.
        particles: usize = 300, 10..=10_000;
        /// Standard deviation of the acceleration along each axis. It spreads the particles from frame to frame.
        process_noise: f32 = 2.0, 0.0..=30.0, "px/frame²";
        /// Standard deviation of the change of scale.
        scale_noise: f32 = 1.0, 0.0..=10.0, "%/frame";
        /// Bins of the histograms.
        colors: ColorBins = ColorBins { bins: 8, ..ColorBins::default() };
        /// Factor λ of the likelihood exp(−λ (1 − ρ)). Large values let few particles survive, small ones many that fit badly.
        lambda: f32 = 20.0, 1.0..=200.0;
        /// Pixels of the ellipse of a particle that its histogram counts, denser in the middle as the Epanechnikov kernel weighs.
        samples: usize = 64, 16..=255;
        /// Drawing of the particles of the next frame.
        resampling: Resampling = Resampling::Systematic;
        /// Share of N below which the effective sample size triggers resampling: 1 for every frame, 0 for never.
        resample_below: f32 = 0.5, 0.0..=1.0;
        /// Random seed. The same seed gives the same particles.
        seed: u32 = 1, 0..=9999;
    }
    advanced { "samples", "seed" }
    when {
        "resampling": |p| p.resample_below > 0.0, "Resampling has no effect if it is never triggered.";
    }
}

/// Initial standard deviation of the positions as a share of the size of the object.
const SPREAD: f32 = 0.1;

/// The model: the histogram of the object, and the particles.
#[derive(Clone)]
pub struct Model {
    histogram: Arc<Histogram>,
    likelihood: Arc<Likelihood>,
    /// The size of a particle of scale 1.
    size: [f32; 2],
    particles: Arc<Vec<Particle>>,
    /// The effective sample size of each later frame.
    effective: Arc<Vec<f32>>,
}

/// Particles with new weights.
#[derive(Clone, Debug)]
pub struct Weighed {
    /// The particles.
    pub particles: Arc<Vec<Particle>>,
    /// Their Bhattacharyya coefficients.
    pub coefficients: Arc<Vec<f32>>,
    /// Number of particles outside the picture, with weight 0.
    pub outside: usize,
    /// Whether any weight was above 0; otherwise all were set to 1/N.
    pub is_weighted: bool,
}

/// A resampling.
#[derive(Clone, Debug)]
pub struct Resampled {
    /// The particles before it.
    pub before: Arc<Vec<Particle>>,
    /// Number of copies of each of them.
    pub copies: Vec<u32>,
    /// The pointers on the cumulative weights, as shares of their sum.
    pub pointers: Vec<f32>,
    /// The particles after it.
    pub after: Arc<Vec<Particle>>,
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The histogram of the object.
    Modelled(Arc<Histogram>),
    /// The first particles.
    Scattered(Arc<Vec<Particle>>),
    /// The particles moved by the motion model.
    Predicted(Arc<Vec<Particle>>),
    /// The particles weighted by their likelihood.
    Weighed(Weighed),
    /// The estimate from particles of this size.
    Estimated(Arc<Vec<Particle>>, Box<Estimate>),
    /// The effective sample size.
    Counted(Arc<Vec<Particle>>, f32),
    /// The particles drawn anew.
    Resampled(Arc<Resampled>),
}

impl ParticleFilter {
    /// The effective sample size below which particles are resampled.
    fn least_effective(&self, particles: &[Particle]) -> f32 {
        self.resample_below * particles.len() as f32
    }

    fn draw_of(&self, step: usize) -> Draw {
        Draw { seed: u64::from(self.seed), step: step as u64 }
    }

    fn region(size: [f32; 2], particle: &Particle) -> Region {
        Region { center: particle.at, size, angle_rad: 0.0 }.scaled(particle.scale)
    }

    /// Multiplies the weights by the likelihoods and normalises them. Without any weight above 0 all become equal.
    fn weigh(&self, model: &Model, frame: &Frame, mut particles: Vec<Particle>) -> Weighed {
        let mut bins = Bins::new(frame, model.histogram.binning);
        let (width, height) = frame.size();
        let is_inside = |at: [f32; 2]| {
            let inside = |c: f32, extent: usize| (-0.5..extent as f32 - 0.5).contains(&c);
            inside(at[0], width) && inside(at[1], height)
        };
        let inside: Vec<usize> = (0..particles.len()).filter(|i| is_inside(particles[*i].at)).collect();
        let region = |i: usize| Self::region(model.size, &particles[i]);
        let bounds = cloud::bounds(inside.iter().map(|i| region(*i).bounds()));
        bounds.into_iter().for_each(|bounds| bins.cover(bounds));
        let mut meter = model.likelihood.meter(&bins);
        let mut coefficients = vec![f32::NEG_INFINITY; particles.len()];
        for pair in inside.chunks(2) {
            // The last one of an odd number is paired with itself.
            let both = [pair[0], pair[pair.len() - 1]];
            let found = meter.coefficients(both.map(region));
            both.into_iter().zip(found).for_each(|(i, coefficient)| coefficients[i] = coefficient);
        }
        let outside = particles.len() - inside.len();
        // Relative to the best one: normalisation cancels the common factor, and no large λ makes all of them underflow to 0.
        let best = coefficients.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        for (particle, coefficient) in particles.iter_mut().zip(&coefficients) {
            let is_inside = coefficient.is_finite();
            particle.weight *= if is_inside { (-self.lambda * (best - coefficient)).exp() } else { 0.0 };
        }
        let is_weighted = cloud::normalize(&mut particles);
        Weighed { particles: Arc::new(particles), coefficients: Arc::new(coefficients), outside, is_weighted }
    }
}

pseudocode! {
    CHOOSE: "R ← region of the object in the first frame",
    BUILD_MODEL: "q ← colour histogram of the ellipse in R",
    SCATTER: "N particles (x, v, s) ← around the centre of R, with v = 0, s = 1 and weight 1/N",
    EACH_FRAME: "for each later frame t",
    PREDICT: "  predict: a ~ N(0, σ²); x ← x + v + a/2, v ← v + a; s ← s · (1 + noise)",
    WEIGH: "  weigh: w ← w · exp(−λ (1 − ρ(p, q))), p ← histogram at (x, s); normalise to Σ w = 1",
    ESTIMATE: "  estimate ← Σ w x, covariance ← Σ w (x − estimate)²",
    COUNT: "  N_eff ← 1 / Σ w²",
    RESAMPLE: "  if N_eff < resample-below · N: draw N particles in proportion to w; w ← 1/N",
    MOVE: "  the region moves to the estimate",
}

impl RegionModel for ParticleFilter {
    const INFO: Info = Info {
        id: "particle-filter",
        name: "Particle filter",
        family: "Region tracking",
        summary: "Keeps many weighted hypotheses of position, velocity and scale: predicts them, weighs them by their colours, and resamples.",
        source: "M. Isard and A. Blake, Condensation, conditional density propagation for visual tracking, IJCV 29(1), 1998; colour \
                 likelihood: P. Pérez, C. Hue, J. Vermaak and M. Gangnet, ECCV 2002; resampling: M. S. Arulampalam, S. Maskell, \
                 N. Gordon and T. Clapp, IEEE Trans. Signal Processing 50(2), 2002",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        WHERE,
        Question::choice(
            "resampled",
            "Are the particles drawn anew?",
            &[
                Reply::told(line::COUNT, case::DEGENERATE, "Yes: too few of them carry the weight"),
                Reply::told(line::COUNT, case::KEPT, "No: the weights are even enough"),
            ],
        ),
    ];
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Diagram];
    const CONTRASTS: Option<&'static str> = Some("resampling");
    const SIMILARITY: Similarity = Similarity {
        name: "weighted mean Bhattacharyya coefficient",
        label: "Weighted mean Bhattacharyya coefficient",
        symbol: "ρ",
        decimals: 3,
        shared_by: "a background of like colours",
    };
    type Model = Model;
    type Event = Event;

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn begin(&self, frame: &Arc<Frame>, region: Region, observer: &mut impl Observer<Event>) -> (Model, f32) {
        let binning = self.colors.of(frame);
        let histogram = Arc::new(Histogram::of_ellipse(frame, binning, region));
        observer.see(|| Event::Modelled(Arc::clone(&histogram)));
        let particles = Arc::new(cloud::scatter(self.draw_of(0), self.particles, region, SPREAD));
        observer.see(|| Event::Scattered(Arc::clone(&particles)));
        let likelihood = Arc::new(Likelihood::new(&histogram, Pattern::new(self.samples)));
        let model = Model { histogram, likelihood, size: region.size, particles, effective: Arc::default() };
        (model, 1.0)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Event>,
    ) -> RegionFrame {
        let step = model.effective.len() + 1;
        let draw = self.draw_of(step);
        let noise = cloud::Noise { acceleration: self.process_noise, scale: self.scale_noise / 100.0 };
        let mut particles = model.particles.to_vec();
        cloud::predict(draw, noise, &mut particles);
        observer.see(|| Event::Predicted(Arc::new(particles.clone())));
        let weighed = self.weigh(model, frame, particles);
        let particles = Arc::clone(&weighed.particles);
        let estimate = Estimate::of(&particles, &weighed.coefficients);
        let effective = cloud::effective(&particles);
        Arc::make_mut(&mut model.effective).push(effective);
        let is_lost = !weighed.is_weighted;
        observer.see(|| Event::Weighed(weighed));
        observer.see(|| Event::Estimated(Arc::clone(&particles), Box::new(estimate)));
        observer.see(|| Event::Counted(Arc::clone(&particles), effective));
        model.particles = Arc::clone(&particles);
        if effective < self.least_effective(&particles) {
            let copies = cloud::copies(draw, self.resampling, &particles);
            model.particles = Arc::new(cloud::copied(&particles, &copies));
            observer.see(|| {
                let after = Arc::clone(&model.particles);
                let pointers =
                    cloud::pointers(draw, self.resampling, particles.len()).map(|share| share as f32).collect();
                Event::Resampled(Arc::new(Resampled { before: particles, copies, pointers, after }))
            });
        }
        if is_lost {
            return RegionFrame { region, similarity: 0.0, is_lost: true };
        }
        let size = model.size.map(|side| side * estimate.scale);
        RegionFrame {
            region: Region { center: estimate.at, size, ..region },
            similarity: estimate.coefficient,
            is_lost: false,
        }
    }

    fn need(&self, clip: &Clip) -> Need {
        // The bins of a frame, and particles; in a walk those of each event.
        let particles = (self.particles * size_of::<Particle>()) as f64;
        let histograms = 16.0 * (self.colors.most() as f64);
        Need::per_pixel(clip, [2.0, 4.0]).and([4.0 * particles + histograms, 16.0 * particles + 4.0 * histograms])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        size_of::<Model>() + size_of_val(&model.particles[..]) + size_of_val(&model.effective[..])
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Modelled(_) => line::BUILD_MODEL,
            Event::Scattered(_) => line::SCATTER,
            Event::Predicted(_) => line::PREDICT,
            Event::Weighed(_) => line::WEIGH,
            Event::Estimated(..) => line::ESTIMATE,
            Event::Counted(..) => line::COUNT,
            Event::Resampled(_) => line::RESAMPLE,
        }
    }
}
