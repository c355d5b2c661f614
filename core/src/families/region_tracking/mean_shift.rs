//! Mean shift: an ellipse climbs to the place where its colour histogram is most similar to the object's.

mod explain;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Observer, effort};
use crate::data::{Clip, Frame};
use crate::methods::region::color::{Bins, ColorBins, Histogram, add_kernel, ellipse_rows, surroundings};
use crate::methods::region::{LOST, RegionModel, Settings, Similarity, WHERE};
use crate::products::{Region, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Name, Question, Reply};
use crate::{choices, params, pseudocode};

use vocabulary::case;

choices! {
    /// Treatment of colours that the surroundings of the object have too.
    pub enum Background {
        /// All colours of the object count alike.
        Ignored = "ignored" "Ignored",
        /// Colours of the surroundings in the first frame count less: the background-weighted histogram. It helps where a loose region holds much
        /// of the background, and changes little where the region is the box of the object.
        Weighted = "weighted" "Weighted",
    }
}

params! {
    /// Mean shift.
    pub struct MeanShift {
        /// Region and frames.
        settings: Settings = Settings::default();
        /// Bins of the histograms.
        colors: ColorBins = ColorBins::default();
        /// Treatment of colours that the surroundings of the object have too.
        background: Background = Background::Ignored;
        /// Try an ellipse 10 % smaller and one 10 % larger in each frame, and move a tenth of the way to the best size.
        adapt_scale: bool = true;
        /// Maximum number of shifts from one frame to the next, for each size.
        iterations: usize = 20, 1..=100;
        /// Length of a shift below which the iteration has converged.
        epsilon: f32 = 0.1, 0.01..=2.0, "px";
        /// Bhattacharyya coefficient, as a share of that in the first frame, below which the object is lost: the region stays. 0 for never.
        min_similarity: f32 = 0.4, 0.0..=1.0;
    }
    advanced { "iterations", "epsilon" }
}

/// Change of the size in a trial, as a share.
const SCALE_STEP: f32 = 0.1;
/// The share of the way to the best size by which the size changes.
const SCALE_RATE: f32 = 0.1;
/// An ellipse is not smaller than this, in px.
const LEAST_PX: f32 = 4.0;

/// A shift of the ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Number of the size that is tried: 0 for the present one, 1 for the smaller, 2 for the larger one.
    pub trial: usize,
    /// Number of the shift, from 1.
    pub iteration: usize,
    /// The ellipse before it.
    pub from: Region,
    /// Its centre after it; none without a pixel that has a colour of the object.
    pub to: Option<[f32; 2]>,
    /// Bhattacharyya coefficient before it.
    pub similarity: f32,
    /// Sum of the weights.
    pub weights: f32,
}

impl Shift {
    /// The displacement.
    fn vector(&self) -> [f32; 2] {
        self.to.map_or([0.0; 2], |to| [0, 1].map(|i| to[i] - self.from.center[i]))
    }

    fn length(&self) -> f32 {
        let [u, v] = self.vector();
        u.hypot(v)
    }
}

/// The result of the shifts with one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// The ellipse at the end.
    pub region: Region,
    /// Its Bhattacharyya coefficient, as evaluated last.
    pub similarity: f32,
    /// Whether no pixel had a colour of the object.
    pub is_lost: bool,
}

/// The model of an object: its histogram q, with the colours of the surroundings weighted if that is chosen.
#[derive(Clone, Debug)]
pub struct Model {
    /// The histogram of the object.
    histogram: Arc<Histogram>,
    /// Its Bhattacharyya coefficient in the first frame.
    first: f32,
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The histogram of the object.
    Modelled(Arc<Histogram>),
    /// The histograms of the object and of its surroundings, and that with their colours weighted.
    Weighted(Arc<[Histogram; 3]>),
    /// The weights of the pixels of an ellipse.
    Weighed(Arc<Frame>, Shift),
    /// The shift.
    Shifted(Arc<Frame>, Shift),
    /// The results of all sizes, the number of the best, and the new region.
    Scaled(Box<([Trial; 3], usize, Region)>),
}

/// The search in a frame, with room for its histograms.
struct Search<'a> {
    model: &'a Histogram,
    bins: Bins<'a>,
    candidate: Vec<f32>,
    weights: Vec<f32>,
}

impl<'a> Search<'a> {
    fn new(model: &'a Histogram, frame: &'a Frame) -> Self {
        let empty = vec![0.0; model.binning.count()];
        Self { model, bins: Bins::new(frame, model.binning), candidate: empty.clone(), weights: empty }
    }

    /// Computes the histogram p of an ellipse and the weights √(q/p) of its bins; returns the Bhattacharyya coefficient.
    fn weigh(&mut self, region: Region) -> f32 {
        self.bins.cover(region.bounds());
        self.candidate.fill(0.0);
        let sum = add_kernel(&self.bins, region, &mut self.candidate);
        let norm = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let mut coefficient = 0.0;
        for &bin in &self.model.support {
            let bin = usize::from(bin);
            let (q, p) = (self.model.shares[bin], self.candidate[bin] * norm);
            coefficient += (q * p).sqrt();
            self.weights[bin] = if p > 0.0 { (q / p).sqrt() } else { 0.0 };
        }
        coefficient
    }

    /// The sum of the weights of the pixels of an ellipse, and their weighted mean relative to its centre. The profile of the
    /// Epanechnikov kernel has a constant derivative, so that all pixels inside count alike.
    fn mean(&self, region: Region) -> (f32, Option<[f32; 2]>) {
        effort::add((region.size[0] * region.size[1]) as usize);
        let mut sums = [0.0f32; 3];
        ellipse_rows(&self.bins, region, |row, [first, dy], _| {
            let (mut sum, mut along) = (0.0, 0.0);
            for (i, bin) in row.iter().enumerate() {
                let weight = self.weights[usize::from(*bin)];
                sum += weight;
                along += weight * (first + i as f32);
            }
            sums = [sums[0] + sum, sums[1] + along, sums[2] + sum * dy];
        });
        let [sum, x, y] = sums;
        (sum, (sum > 0.0).then(|| [x / sum, y / sum]))
    }
}

impl MeanShift {
    /// The Bhattacharyya coefficient below which the object is lost.
    fn least(&self, model: &Model) -> f32 {
        self.min_similarity * model.first
    }

    /// Climbs with the present size and, if the scale is adapted, with a smaller and a larger one.
    fn search(
        &self,
        model: &Model,
        (frame, region): (&Arc<Frame>, Region),
        observer: &mut impl Observer<Event>,
    ) -> Trial {
        let mut search = Search::new(&model.histogram, frame);
        let now = self.climb(&mut search, (frame, 0), region, observer);
        if !self.adapt_scale {
            return now;
        }
        let mut climb = |trial, factor| self.climb(&mut search, (frame, trial), region.scaled(factor), observer);
        let trials = [now, climb(1, 1.0 - SCALE_STEP), climb(2, 1.0 + SCALE_STEP)];
        // The present size if none is better.
        let best = (1..3).fold(0, |best, i| if trials[i].similarity > trials[best].similarity { i } else { best });
        let size = [0, 1].map(|i| {
            let most = [frame.size().0, frame.size().1][i] as f32;
            let mixed = region.size[i] + SCALE_RATE * (trials[best].region.size[i] - region.size[i]);
            mixed.clamp(LEAST_PX.min(most), most)
        });
        let region = Region { size, ..trials[best].region };
        observer.see(|| Event::Scaled(Box::new((trials, best, region))));
        Trial { region, ..trials[best] }
    }

    fn has_converged(&self, shift: &Shift) -> bool {
        shift.length() < self.epsilon
    }

    /// Shifts an ellipse until it converges.
    fn climb(
        &self,
        search: &mut Search<'_>,
        (frame, trial): (&Arc<Frame>, usize),
        mut region: Region,
        observer: &mut impl Observer<Event>,
    ) -> Trial {
        let mut similarity = 0.0;
        for iteration in 1..=self.iterations {
            similarity = search.weigh(region);
            let (weights, mean) = search.mean(region);
            let to = mean.map(|mean| [0, 1].map(|i| region.center[i] + mean[i]));
            let shift = Shift { trial, iteration, from: region, to, similarity, weights };
            observer.see(|| Event::Weighed(Arc::clone(frame), shift));
            observer.see(|| Event::Shifted(Arc::clone(frame), shift));
            let Some(center) = to else { return Trial { region, similarity, is_lost: true } };
            region = region.at(center);
            if self.has_converged(&shift) {
                break;
            }
        }
        Trial { region, similarity, is_lost: false }
    }
}

/// The histogram `of` an object with each bin multiplied by min(o*/o, 1), where o is the share of the surroundings and o* the
/// smallest of these above 0.
fn weighted(of: &Histogram, around: &Histogram) -> Histogram {
    let least = around.support.iter().map(|bin| around.shares[usize::from(*bin)]).fold(f32::INFINITY, f32::min);
    let factor = |around: f32| if around > 0.0 { (least / around).min(1.0) } else { 1.0 };
    let shares = of.shares.iter().zip(&around.shares).map(|(share, around)| share * factor(*around)).collect();
    Histogram::new(of.binning, shares)
}

pseudocode! {
    CHOOSE: "R ← region of the object in the first frame",
    BUILD_MODEL: "q ← colour histogram of the ellipse in R, pixels weighted by the kernel k(r) = 1 − r²",
    WEIGHT_BACKGROUND: "if background: q_u ← q_u · min(o* / o_u, 1), o ← histogram of the surroundings",
    EACH_FRAME: "for each later frame t, from the last position y and size h",
    EACH_SIZE: "  for each size h, 0.9 h, 1.1 h: repeat",
    WEIGH: "    p ← histogram of the ellipse at y; w_i ← √(q_u / p_u) for each pixel i of bin u",
    SHIFT: "    y ← Σ w_i x_i / Σ w_i, until the shift < ε",
    CHOOSE_SIZE: "  h ← 0.9 h + 0.1 · the size with the highest ρ = Σ √(p_u q_u)",
    MOVE: "  the region moves to y, unless ρ < min-similarity · ρ of the first frame: lost",
}

impl RegionModel for MeanShift {
    const INFO: Info = Info {
        id: "mean-shift",
        name: "Mean shift",
        family: "Region tracking",
        summary: "Shifts an ellipse to the weighted mean of its pixels until its colour histogram is most like that of the object.",
        source: "D. Comaniciu, V. Ramesh and P. Meer, Kernel-based object tracking, PAMI 25(5), 2003; background-weighted histogram of the \
                 model alone: J. Ning, L. Zhang, D. Zhang and C. Wu, IET Computer Vision 6(1), 2012",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        WHERE,
        Question::choice(
            "converged",
            "Does the next shift end the iterations?",
            &[
                Reply::told(line::SHIFT, case::CONVERGED, "Yes: it is shorter than ε"),
                Reply::told(line::SHIFT, case::NOT_CONVERGED, "No: another shift follows"),
            ],
        ),
        LOST,
    ];
    const CONTRASTS: Option<&'static str> = Some("background");
    const SIMILARITY: Similarity = Similarity {
        name: "Bhattacharyya coefficient",
        label: "Bhattacharyya coefficient",
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
        let own = Histogram::of_ellipse(frame, binning, region);
        observer.see(|| Event::Modelled(Arc::new(own.clone())));
        if self.background == Background::Ignored {
            return (Model { histogram: Arc::new(own), first: 1.0 }, 1.0);
        }
        let around = Histogram::new(binning, surroundings(frame, binning, region));
        let weighted = weighted(&own, &around);
        let similarity = weighted.coefficient(&own.shares);
        observer.see(|| Event::Weighted(Arc::new([own, around, weighted.clone()])));
        (Model { histogram: Arc::new(weighted), first: similarity }, similarity)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Event>,
    ) -> RegionFrame {
        let Trial { region: found, similarity, is_lost } = self.search(model, (frame, region), observer);
        let is_lost = is_lost || similarity < self.least(model);
        RegionFrame { region: if is_lost { region } else { found }, similarity, is_lost }
    }

    fn need(&self, clip: &Clip) -> Need {
        // The bins of a frame; in a walk the weights shown too.
        let histograms = 16.0 * (self.colors.most() as f64);
        Need::per_pixel(clip, [2.0, 8.0]).and([histograms, 4.0 * histograms])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        model.histogram.bytes()
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Modelled(_) => line::BUILD_MODEL,
            Event::Weighted(_) => line::WEIGHT_BACKGROUND,
            Event::Weighed(..) => line::WEIGH,
            Event::Shifted(..) => line::SHIFT,
            Event::Scaled(_) => line::CHOOSE_SIZE,
        }
    }
}
