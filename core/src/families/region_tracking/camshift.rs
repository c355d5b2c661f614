//! CamShift: a window moves to the mean of the back-projected hue histogram, and moments give its size and angle.

mod explain;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Observer, effort};
use crate::data::{Clip, Frame};
use crate::geometry::Bounds;
use crate::methods::region::color::{Binning, Bins, Histogram, ellipse_rows, surroundings};
use crate::methods::region::{LOST, RegionModel, Settings, Similarity, WHERE};
use crate::products::{Region, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Name, Question, Reply};
use crate::{choices, params, pseudocode};

use vocabulary::case;

choices! {
    /// Treatment of hues that the surroundings of the object have too.
    pub enum Background {
        /// Each hue counts by its share in the object alone, as Bradski does. The window spreads over a background that has the hue too.
        Ignored = "ignored" "Ignored",
        /// Each hue is multiplied by the share of its pixels, in the object and around it in the first frame, that lie in the object.
        Weighted = "weighted" "Weighted",
    }
}

params! {
    /// CamShift.
    pub struct Camshift {
        /// Region and frames.
        settings: Settings = Settings::default();
        /// Bins of hue; of gray levels in frames without colour.
        bins: usize = 16, 2..=180;
        /// Smallest saturation of a pixel with a hue, 0 to 1. The hue of grayish pixels is noise.
        min_saturation: f32 = 0.2, 0.0..=1.0;
        /// Smallest value (brightness) of a pixel with a hue, 0 to 1. The hue of dark pixels is noise.
        min_value: f32 = 0.1, 0.0..=1.0;
        /// Treatment of hues that the surroundings of the object have too.
        background: Background = Background::Weighted;
        /// Maximum number of shifts of the window from one frame to the next.
        iterations: usize = 10, 1..=100;
        /// Length of a shift below which the iteration has converged.
        epsilon: f32 = 0.5, 0.01..=2.0, "px";
        /// Pixels around the window that count for its new size, so that it can grow.
        margin: usize = 5, 0..=50, "px";
    }
    advanced { "iterations", "epsilon" }
}

/// A window is not smaller than this, in px.
const LEAST_PX: f32 = 4.0;

/// The probabilities of the bins: the back-projection of a pixel is that of its bin.
#[derive(Clone, Debug)]
pub struct Model {
    /// The histogram of the object.
    histogram: Histogram,
    /// The share of each bin relative to the fullest, 0 to 1; with the surroundings weighted if that is chosen.
    projection: Vec<f32>,
    /// The share of the pixels with a hue of the object, in its box and around it, that lie in the object, weighted by
    /// the histogram.
    own: f32,
    /// The search window: the box of the last region.
    window: Bounds,
    /// The ellipse of the first frame, and the mean back-projection in it.
    first: (Region, f32),
}

/// The moments of the back-projection in a window, about its centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Sum of the back-projection.
    pub mass: f64,
    /// Sums of it times x and y.
    pub first: [f64; 2],
    /// Sums of it times x², x y and y².
    pub second: [f64; 3],
}

impl Moments {
    /// The centroid relative to the origin of the moments; none without mass.
    fn centroid(&self) -> Option<[f64; 2]> {
        (self.mass > 0.0).then(|| self.first.map(|sum| sum / self.mass))
    }

    /// The covariance about the centroid in px²: along x², x y and y².
    fn covariance(&self) -> Option<[f64; 3]> {
        let [x, y] = self.centroid()?;
        let [xx, xy, yy] = self.second.map(|sum| sum / self.mass);
        Some([xx - x * x, xy - x * y, yy - y * y])
    }

    /// The ellipse with these moments around `origin`: its axes are four standard deviations long, those of a uniform ellipse.
    fn region(&self, origin: [f32; 2]) -> Option<Region> {
        let ([x, y], [xx, xy, yy]) = (self.centroid()?, self.covariance()?);
        let (mean, half) = ((xx + yy) / 2.0, (xx - yy) / 2.0);
        let apart = half.hypot(xy);
        let axis = |variance: f64| (4.0 * variance.max(0.0).sqrt()) as f32;
        Some(Region {
            center: [origin[0] + x as f32, origin[1] + y as f32],
            size: [axis(mean + apart), axis(mean - apart)].map(|side| side.max(LEAST_PX)),
            angle_rad: (0.5 * xy.atan2(half)) as f32,
        })
    }
}

/// A shift of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Its number, from 1.
    pub iteration: usize,
    /// The window before it.
    pub window: Bounds,
    /// Sum of the back-projection in the window.
    pub mass: f64,
    /// The displacement; none without mass.
    pub by: Option<[f32; 2]>,
}

impl Shift {
    fn length(&self) -> f32 {
        self.by.map_or(0.0, |[u, v]| u.hypot(v))
    }
}

/// The new size and angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resized {
    /// The window of the moments.
    pub window: Bounds,
    /// The moments about its centre.
    pub moments: Moments,
    /// The new region.
    pub region: Region,
    /// The mean back-projection inside it.
    pub similarity: f32,
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The histogram of the object.
    Modelled(Arc<Model>),
    /// The back-projection of a frame in a window.
    Projected(Arc<Frame>, Bounds),
    /// A shift of the window.
    Shifted(Arc<Frame>, Shift),
    /// The new size and angle.
    Resized(Arc<Frame>, Box<Resized>),
}

impl Camshift {
    fn binning(&self, frame: &Frame) -> Binning {
        match frame.color() {
            Some(_) => Binning::Hue(self.bins, [self.min_saturation, self.min_value]),
            None => Binning::Gray(self.bins),
        }
    }

    fn has_converged(&self, shift: &Shift) -> bool {
        shift.length() < self.epsilon
    }

    /// Moves the window until it converges; returns its last place, or nothing if it has no mass.
    fn settled(
        &self,
        (bins, projection): (&mut Bins<'_>, &[f32]),
        frame: &Arc<Frame>,
        mut window: Bounds,
        observer: &mut impl Observer<Event>,
    ) -> Option<Bounds> {
        for iteration in 1..=self.iterations {
            let moments = moments(bins, projection, window);
            let by = moments.centroid().map(|mean| mean.map(|c| c as f32));
            let shift = Shift { iteration, window, mass: moments.mass, by };
            observer.see(|| Event::Shifted(Arc::clone(frame), shift));
            window = window.moved(by?);
            if self.has_converged(&shift) {
                break;
            }
        }
        Some(window)
    }
}

/// The moments of the back-projection in a window, about its centre.
fn moments(bins: &mut Bins<'_>, projection: &[f32], window: Bounds) -> Moments {
    bins.cover(window);
    let [x0, y0] = window.center().map(f64::from);
    let mut sums = Moments::default();
    bins.rows(window, |row, first, y| {
        effort::add(row.len());
        let dx0 = first as f64 - x0;
        // Along a row: sums of p, p x and p x².
        let mut along = [0.0f64; 3];
        for (i, bin) in row.iter().enumerate() {
            let p = f64::from(projection.get(usize::from(*bin)).copied().unwrap_or(0.0));
            let dx = dx0 + i as f64;
            along = [along[0] + p, along[1] + p * dx, along[2] + p * dx * dx];
        }
        let dy = y as f64 - y0;
        sums.mass += along[0];
        sums.first = [sums.first[0] + along[1], sums.first[1] + along[0] * dy];
        let [xx, xy, yy] = sums.second;
        sums.second = [xx + along[2], xy + along[1] * dy, yy + along[0] * dy * dy];
    });
    sums
}

/// The mean back-projection of the pixels in an ellipse.
fn mean_inside(bins: &mut Bins<'_>, projection: &[f32], region: Region) -> f32 {
    bins.cover(region.bounds());
    let (sin, cos) = region.angle_rad.sin_cos();
    let [a, b] = region.size.map(|side| side / 2.0);
    let (mut sum, mut count) = (0.0, 0u32);
    bins.rows(region.bounds(), |row, first, y| {
        let dy = y as f32 - region.center[1];
        for (i, bin) in row.iter().enumerate() {
            let dx = (first + i) as f32 - region.center[0];
            let (u, v) = ((dx * cos + dy * sin) / a, (dy * cos - dx * sin) / b);
            if u * u + v * v <= 1.0 {
                sum += projection.get(usize::from(*bin)).copied().unwrap_or(0.0);
                count += 1;
            }
        }
    });
    if count > 0 { sum / count as f32 } else { 0.0 }
}

pseudocode! {
    CHOOSE: "R ← region of the object in the first frame",
    BUILD_MODEL: "q ← hue histogram of the ellipse in R, if background times the share of each hue in R; divided by its largest bin",
    EACH_FRAME: "for each later frame t, from the last window W",
    PROJECT: "  P(x) ← q of the bin of pixel x: the back-projection",
    SHIFT: "  centre of W ← (M₁₀, M₀₁) / M₀₀ of P in W, until the shift < ε",
    RESIZE: "  size and angle ← second moments of P in W with its margin: axes of 4 σ; W ← box around the ellipse",
    MOVE: "  the region is that ellipse",
}

impl RegionModel for Camshift {
    const INFO: Info = Info {
        id: "camshift",
        name: "CamShift",
        family: "Region tracking",
        summary: "Moves a window to the centroid of the back-projected hue histogram, and takes size and angle from its second moments.",
        source: "G. R. Bradski, Computer vision face tracking for use in a perceptual user interface, Intel Technology Journal Q2, 1998",
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
    const SIMILARITY: Similarity = Similarity {
        name: "mean back-projection",
        label: "Mean back-projection",
        symbol: "mean P",
        decimals: 3,
        shared_by: "a background of like hue",
    };
    type Model = Model;
    type Event = Event;

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn begin(&self, frame: &Arc<Frame>, region: Region, observer: &mut impl Observer<Event>) -> (Model, f32) {
        let binning = self.binning(frame);
        let (mut bins, mut counts) = (Bins::new(frame, binning), vec![0.0; binning.count()]);
        bins.cover(region.bounds());
        // Not the whole box: the corners beside a round object are background, whose hue would spread the window over all of it.
        ellipse_rows(&bins, region, |row, _, _| {
            for bin in row {
                if let Some(count) = counts.get_mut(usize::from(*bin)) {
                    *count += 1.0;
                }
            }
        });
        let around = surroundings(frame, binning, region);
        let own_share = |(count, around): (&f32, &f32)| if *count > 0.0 { count / (count + around) } else { 0.0 };
        let own: Vec<f32> = counts.iter().zip(&around).map(own_share).collect();
        let histogram = Histogram::new(binning, counts);
        let weight = |own: &f32| if self.background == Background::Weighted { *own } else { 1.0 };
        let mut projection: Vec<f32> =
            histogram.shares.iter().zip(&own).map(|(share, own)| share * weight(own)).collect();
        let most = projection.iter().copied().fold(0.0, f32::max);
        projection.iter_mut().for_each(|share| *share = if most > 0.0 { *share / most } else { 0.0 });
        let own = histogram.shares.iter().zip(&own).map(|(share, own)| share * own).sum();
        let similarity = mean_inside(&mut bins, &projection, region);
        let model = Model { histogram, projection, own, window: region.bounds(), first: (region, similarity) };
        observer.see(|| Event::Modelled(Arc::new(model.clone())));
        (model, similarity)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Event>,
    ) -> RegionFrame {
        let mut bins = Bins::new(frame, model.histogram.binning);
        observer.see(|| Event::Projected(Arc::clone(frame), model.window));
        let projection = &model.projection[..];
        let Some(window) = self.settled((&mut bins, projection), frame, model.window, observer) else {
            return RegionFrame { region, similarity: 0.0, is_lost: true };
        };
        let margin = self.margin as f32;
        let wide = Bounds { min: window.min.map(|c| c - margin), max: window.max.map(|c| c + margin) };
        let moments = moments(&mut bins, projection, wide);
        let found = moments.region(wide.center()).unwrap_or(region);
        // Not larger than the picture.
        let (width, height) = frame.size();
        let most = width.max(height) as f32;
        let found = Region { size: found.size.map(|side| side.min(most)), ..found };
        let similarity = mean_inside(&mut bins, projection, found);
        observer.see(|| {
            Event::Resized(Arc::clone(frame), Box::new(Resized { window: wide, moments, region: found, similarity }))
        });
        model.window = found.bounds();
        RegionFrame { region: found, similarity, is_lost: false }
    }

    fn need(&self, clip: &Clip) -> Need {
        // The bins of a frame; in a walk the back-projection shown too.
        Need::per_pixel(clip, [2.0, 8.0])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        size_of::<Model>() + model.histogram.bytes() + size_of_val(&model.projection[..])
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Modelled(_) => line::BUILD_MODEL,
            Event::Projected(..) => line::PROJECT,
            Event::Shifted(..) => line::SHIFT,
            Event::Resized(..) => line::RESIZE,
        }
    }
}
