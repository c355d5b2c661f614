//! Active contours without edges (Chan and Vese): a level set function divides a window into two regions of different mean.

mod explain;
mod level_set;

use std::sync::Arc;

use crate::base::{Error, Observer, effort};
use crate::data::{Clip, Frame, Mask, PackedMask};
use crate::geometry::{Bounds, Gray, Grid};
use crate::methods::contour::vocabulary::value as shared;
use crate::methods::contour::{LEAST_AREA_PX, Placement, filled};
use crate::methods::region::{LOST, Refusal, RegionModel, Settings, Similarity, WHERE};
use crate::products::{MaskField, Product, ProductKind, Region, RegionField, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question};
use crate::{params, pseudocode};

use explain::{case, value};
use level_set::{Energy, Weights, changed, energy, evolved, largest, means, signed_distance};

params! {
    /// Active contour without edges (Chan–Vese).
    pub struct ChanVese {
        /// Start and frames.
        placement: Placement = Placement::default();
        /// Margin of the window around the object. The window is divided into inside and outside, and the contour cannot leave it in a
        /// frame; a large one holds more clutter.
        margin: usize = 16, 4..=200, "px";
        /// Weight μ of the length of the contour. Large values smooth the contour and ignore small details, such as noise.
        mu: f32 = 0.1, 0.0..=5.0;
        /// Weight ν of the area inside. A positive one shrinks the inside, a negative one lets it grow.
        nu: f32 = 0.0, -1.0..=1.0;
        /// Weight λ₁ of the squared differences from the mean inside.
        lambda_inside: f32 = 1.0, 0.0..=10.0;
        /// Weight λ₂ of the squared differences from the mean outside.
        lambda_outside: f32 = 1.0, 0.0..=10.0;
        /// Time step Δt. The scheme is stable for any; a large one needs fewer iterations.
        time_step: f32 = 200.0, 0.1..=1000.0;
        /// Maximum number of iterations in a frame.
        iterations: usize = 100, 1..=1000;
        /// Contrast |c₁ − c₂| of both means below which the object is lost: object and region stay.
        min_contrast: f32 = 8.0, 0.0..=255.0, "gray levels";
        /// Largest factor by which the area may grow or shrink from one frame to the next; beyond it the object is lost.
        max_growth: f32 = 2.0, 1.0..=20.0;
    }
    advanced { "lambda-inside", "lambda-outside", "time-step" }
}

/// The smallest range of gray levels that two regions divide.
const LEAST_LEVELS: u8 = 8;
/// Iterations without a pixel that changes sides until convergence.
const STILL: usize = 5;

/// The window of a frame.
pub struct Field {
    /// Its first pixel.
    origin: [usize; 2],
    /// Its gray levels, scaled to 0 to 1.
    levels: Grid<f32>,
    /// The gray levels of 0 and of 1.
    range: [u8; 2],
}

impl Field {
    /// The window up to `margin` px around `bounds`.
    fn around(luma: &Gray, bounds: Bounds, margin: usize) -> Self {
        let (margin, extent) = (margin as f32, [luma.width(), luma.height()]);
        let first = [0, 1].map(|i| ((bounds.min[i] - margin).ceil().max(0.0) as usize).min(extent[i] - 1));
        let end =
            [0, 1].map(|i| ((bounds.max[i] + margin).floor().max(0.0) as usize + 1).clamp(first[i] + 1, extent[i]));
        let window = Grid::from_fn(end[0] - first[0], end[1] - first[1], |x, y| luma[(first[0] + x, first[1] + y)]);
        let [low, high] = window.cells().iter().fold([u8::MAX, 0], |[low, high], v| [low.min(*v), high.max(*v)]);
        let scale = 1.0 / f32::from((high - low).max(1));
        Self { origin: first, levels: window.map(|v| f32::from(v - low) * scale), range: [low, high] }
    }

    fn gray(&self, level: f32) -> f32 {
        f32::from(self.range[0]) + level * f32::from(self.range[1] - self.range[0])
    }

    /// The difference of two scaled levels in gray levels.
    fn contrast(&self, [inside, outside]: [f32; 2]) -> f32 {
        (self.gray(inside) - self.gray(outside)).abs()
    }
}

/// An iteration.
pub struct Iteration {
    /// Its number, from 1.
    number: usize,
    field: Arc<Field>,
    /// The means c₁ and c₂ before it, of scaled gray levels.
    means: [f32; 2],
    /// φ before and after it.
    phi: [Arc<Grid<f32>>; 2],
    /// The energy after it.
    energy: Energy,
    /// Number of pixels that changed sides.
    changed: usize,
    /// Whether none has for some iterations.
    is_still: bool,
}

/// Why the object of a frame is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Loss {
    /// Its area is too small.
    Collapsed,
    /// The inside fills the window.
    Full,
    /// Both means are alike.
    Alike,
    /// Its area changed too much from this many px².
    Spread(usize),
}

/// The judgement of the object of a frame.
pub struct Judged {
    field: Arc<Field>,
    phi: Arc<Grid<f32>>,
    /// The largest connected part of the inside.
    object: Mask,
    /// Number of its pixels, and of all inside.
    area: [usize; 2],
    /// Difference of both means in gray levels.
    contrast: f32,
    /// Why the object is lost, if it is.
    loss: Option<Loss>,
}

/// The object of the last frame.
#[derive(Clone)]
pub struct Model {
    object: PackedMask,
    bounds: Bounds,
    area: usize,
    result: RegionFrame,
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The window of the frame, and φ at its start.
    Started(Arc<Field>, Arc<Grid<f32>>),
    /// An iteration.
    Iterated(Arc<Iteration>),
    /// The judgement of the object.
    Judged(Arc<Judged>),
}

impl ChanVese {
    fn weights(&self) -> Weights {
        let lambda = [self.lambda_inside, self.lambda_outside];
        Weights { mu: self.mu, nu: self.nu, lambda, step: self.time_step }
    }

    /// Evolves φ until no pixel changes sides.
    fn evolve(&self, field: &Arc<Field>, start: Arc<Grid<f32>>, observer: &mut impl Observer<Event>) -> Arc<Grid<f32>> {
        let (mut phi, mut still, weights) = (start, 0, self.weights());
        for number in 1..=self.iterations {
            effort::add(phi.cells().len());
            let means = means(&phi, &field.levels);
            let next = Arc::new(evolved(&phi, &field.levels, means, &weights));
            let changed = changed(&phi, &next);
            still = if changed == 0 { still + 1 } else { 0 };
            observer.see(|| {
                let energy = energy(&next, &field.levels, level_set::means(&next, &field.levels), &weights);
                let (field, phi) = (Arc::clone(field), [Arc::clone(&phi), Arc::clone(&next)]);
                Event::Iterated(Arc::new(Iteration {
                    number,
                    field,
                    means,
                    phi,
                    energy,
                    changed,
                    is_still: still == STILL,
                }))
            });
            phi = next;
            if still == STILL {
                break;
            }
        }
        phi
    }

    /// Judges the object of a frame, which had an area of `before` in the last one.
    fn judge(
        &self,
        (field, phi): (&Arc<Field>, &Arc<Grid<f32>>),
        picture: (usize, usize),
        before: Option<usize>,
    ) -> (Judged, Bounds) {
        let all = phi.cells().iter().filter(|phi| **phi >= 0.0).count();
        let none = || (Mask::new(picture.0, picture.1), Bounds { min: [0.0; 2], max: [0.0; 2] }, 0);
        let (object, bounds, area) = largest(phi, field.origin, picture).unwrap_or_else(none);
        let contrast = field.contrast(means(phi, &field.levels));
        let growth = |before: usize| {
            let [a, b] = [area, before].map(|area| area.max(1) as f64);
            (a / b).max(b / a)
        };
        let spread = before.filter(|before| growth(*before) > f64::from(self.max_growth));
        let loss = match spread {
            _ if (area as f64) < LEAST_AREA_PX => Some(Loss::Collapsed),
            _ if all == phi.cells().len() => Some(Loss::Full),
            _ if contrast < self.min_contrast => Some(Loss::Alike),
            spread => spread.map(Loss::Spread),
        };
        let (field, phi) = (Arc::clone(field), Arc::clone(phi));
        (Judged { field, phi, object, area: [area, all], contrast, loss }, bounds)
    }

    /// Finds the object in a frame, from where it was before; `area` is that of the frame before, where there was one.
    fn fit(
        &self,
        (frame, region): (&Frame, Region),
        before: &Mask,
        bounds: Bounds,
        area: Option<usize>,
        observer: &mut impl Observer<Event>,
    ) -> Model {
        let field = Arc::new(Field::around(frame.luma(), bounds, self.margin));
        let [left, top] = field.origin;
        let start = Arc::new(signed_distance(field.levels.size(), |x, y| before.get(left + x, top + y)));
        observer.see(|| Event::Started(Arc::clone(&field), Arc::clone(&start)));
        let phi = self.evolve(&field, start, observer);
        let (judged, found) = self.judge((&field, &phi), frame.size(), area);
        let (is_lost, similarity) = (judged.loss.is_some(), judged.contrast);
        let model = match is_lost {
            true => Model {
                object: PackedMask::new(before),
                bounds,
                area: area.unwrap_or_else(|| before.count()),
                result: RegionFrame { region, similarity, is_lost },
            },
            false => Model {
                object: PackedMask::new(&judged.object),
                bounds: found,
                area: judged.area[0],
                result: RegionFrame { region: found.into(), similarity, is_lost },
            },
        };
        observer.see(|| Event::Judged(Arc::new(judged)));
        model
    }
}

pseudocode! {
    CHOOSE: "object ← inside of the contour in the first frame; stop if the window around it is flat",
    EACH_FRAME: "for each frame t, in a window around the object of frame t − 1",
    START: "  φ ← signed distance to the border of that object, positive inside; u ← gray levels, scaled to 0 to 1",
    EVOLVE: "  repeat: c₁, c₂ ← means of u inside and outside; φ ← φ + Δt δ(φ) (μ div(∇φ / |∇φ|) − ν − λ₁ (u − c₁)² + λ₂ (u − c₂)²)",
    JUDGE: "  object ← largest connected part of φ ≥ 0; lost if |c₁ − c₂| < min-contrast or its area changes by more than max-growth",
    MOVE: "  the mask is the object, the region the box around it, unless the object is lost",
}

impl RegionModel for ChanVese {
    const INFO: Info = Info {
        id: "chan-vese",
        name: "Active contour without edges",
        family: "Region tracking",
        summary: "Divides a window around the object into two regions with different means by a level set function with a short contour.",
        source: "T. F. Chan and L. A. Vese, Active contours without edges, IEEE TIP 10(2), 2001; numerical scheme: P. Getreuer, \
                 Chan–Vese segmentation, IPOL 2, 2012",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        WHERE,
        Question::value("changed", "How many pixels change sides in the next iteration?", line::EVOLVE, value::CHANGED)
            .after_first_unit(),
        LOST,
    ];
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series];
    const SIMILARITY: Similarity = Similarity {
        name: "contrast",
        label: "Contrast",
        symbol: "|c₁ − c₂|",
        decimals: 2,
        shared_by: "any region much brighter or darker than its surroundings",
    };
    const PRODUCES: &'static [&'static ProductKind] = &[RegionField::KIND, MaskField::KIND];
    type Model = Model;
    type Event = Event;

    fn settings(&self) -> &Settings {
        &self.placement.settings
    }

    fn placed(&self, picture: (usize, usize)) -> Result<Option<Bounds>, Error> {
        self.placement.placed(picture)
    }

    fn refuse(&self, frame: &Frame, region: Region) -> Option<Refusal> {
        let [low, high] = Field::around(frame.luma(), region.bounds(), self.margin).range;
        let limits = [shared::GRAY_RANGE.is(high - low), shared::LEAST_GRAY_RANGE.is(LEAST_LEVELS)];
        (high - low < LEAST_LEVELS).then(|| (case::ALIKE, limits.into()))
    }

    fn begin(&self, frame: &Arc<Frame>, region: Region, observer: &mut impl Observer<Event>) -> (Model, f32) {
        let start = filled(&self.placement.start(region), frame.size());
        let model = self.fit((frame, region), &start, region.bounds(), None, observer);
        let similarity = model.result.similarity;
        (model, similarity)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Event>,
    ) -> RegionFrame {
        let before = model.object.unpacked();
        *model = self.fit((frame, region), &before, model.bounds, Some(model.area), observer);
        model.result
    }

    fn fitted(&self, model: &Model) -> Option<RegionFrame> {
        Some(model.result)
    }

    fn mask(&self, model: &Model) -> Option<PackedMask> {
        Some(model.object.clone())
    }

    fn need(&self, clip: &Clip) -> Need {
        // Gray levels, φ and distances of a window, at most the whole picture; in a walk φ of each iteration too.
        Need::per_pixel(clip, [32.0, 64.0 + 4.0 * self.iterations as f64])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        size_of::<Model>() + model.object.bytes()
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Started(..) => line::START,
            Event::Iterated(_) => line::EVOLVE,
            Event::Judged(_) => line::JUDGE,
        }
    }
}
