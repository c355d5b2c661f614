//! Template tracking: a template is aligned with each frame by Lucas and Kanade's method, and updated without drift.

mod charts;
mod explain;
mod template;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Observer, effort};
use crate::data::{Clip, Frame};
use crate::methods::alignment::{Compared, composed, solve};
use crate::methods::region::{LOST, Refusal, RegionModel, Settings, Similarity, WHERE};
use crate::products::model::Matrix3;
use crate::products::{Model as Group, Region, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question, Reply};
use crate::{choices, params, pseudocode};

use template::{Pyramid, Template, farthest, pyramid, region_of, stretch};
use vocabulary::{case, value};

choices! {
    /// Group of the warps of a template.
    pub enum Warp {
        /// Translation: 2 degrees of freedom.
        Translation = "translation" "Translation",
        /// Rotation, translation and scale: 4 degrees of freedom.
        Similarity = "similarity" "Similarity",
        /// Affine map: 6 degrees of freedom. It follows a plane that is seen from changing directions.
        Affine = "affine" "Affine",
    }
}

impl Warp {
    fn group(self) -> Group {
        match self {
            Self::Translation => Group::Translation,
            Self::Similarity => Group::Similarity,
            Self::Affine => Group::Affine,
        }
    }
}

choices! {
    /// Template of the later frames.
    pub enum Update {
        /// The first template in all frames: no drift, but a change of appearance is not followed.
        None = "none" "None",
        /// The warped window of each frame: changes are followed, but the errors of all frames add up to drift.
        EveryFrame = "every-frame" "Every frame",
        /// The warped window of each frame, at the place that the first template confirms: changes are followed without drift.
        Corrected = "drift-corrected" "Drift-corrected",
    }
}

params! {
    /// Template tracker.
    pub struct TemplateTracker {
        /// Region and frames.
        settings: Settings = Settings::default();
        /// Group of the warps. More degrees of freedom follow more changes of pose, but need more texture.
        warp: Warp = Warp::Affine;
        /// Template of the later frames.
        update: Update = Update::Corrected;
        /// Largest motion of a corner by the drift correction. A farther one is no drift: the alignment with the first template has failed,
        /// and neither warp nor template are changed by it.
        max_correction: f32 = 2.0, 0.1..=20.0, "px";
        /// Number of pyramid levels including full resolution, as many as leave 6 px a side of the template. More levels reach larger motion.
        levels: usize = 3, 1..=6;
        /// Maximum number of iterations per level.
        iterations: usize = 30, 1..=200;
        /// Stopping criterion: the iterations of a level end with an increment that moves no corner farther.
        epsilon: f32 = 0.01, 0.001..=1.0, "px";
        /// Correlation of the warped window with its template below which the object is lost: the region stays, and the template is not
        /// updated.
        min_correlation: f32 = 0.7, 0.0..=1.0;
    }
    advanced { "iterations", "epsilon" }
    when {
        "max-correction": |p| p.update == Update::Corrected, "The largest correction has no effect without drift correction.";
    }
}

/// The smallest share of a template inside the frame; below it the object has left.
const LEAST_OVERLAP: f64 = 0.5;
/// The largest factor by which lengths may change from frame to frame, and its inverse the smallest; also that between two directions.
/// Beyond it the alignment has failed, whatever the correlation: a template shrunk to a line correlates well with any edge.
const MOST_STRETCH: f64 = 2.0;

/// The frames of a loss in which that factor widens.
const MOST_WIDENED: usize = 2;

/// The factors by which a warp changes lengths since the last frame that showed the object.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    largest: f64,
    smallest: f64,
    /// The largest allowed factor, and the inverse of the smallest: it grows with the number of frames since then.
    most: f64,
}

impl Stretch {
    fn new([before, after]: [&Matrix3; 2], lost_frames: usize) -> Self {
        let [largest, smallest] = stretch([before, after]);
        Self { largest, smallest, most: MOST_STRETCH.powf(lost_frames.min(MOST_WIDENED) as f64 + 1.0) }
    }

    /// Whether lengths change more than an object does within the frames since then.
    fn is_beyond(&self) -> bool {
        !(self.largest <= self.most && self.smallest >= 1.0 / self.most)
    }

    /// Whether the factors are impossible: an object may grow while it is lost, but does not become a line.
    fn is_collapsed(&self) -> bool {
        self.is_beyond() || self.largest > MOST_STRETCH * self.smallest
    }
}

/// The state carried from frame to frame.
#[derive(Clone)]
pub struct Model {
    /// The template of the first frame.
    first: Arc<Template>,
    /// The template of the next frame.
    template: Arc<Template>,
    /// The extent of the region in the first frame, in px.
    extent: [f32; 2],
    /// The warp from the template, about its middle, to the last frame that showed the object.
    warp: Matrix3,
    /// Number of frames since then, in which the object was lost.
    lost_frames: usize,
}

/// The end of the iterations of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// The increment is small.
    Converged,
    /// All iterations are done.
    Exhausted,
    /// The error has risen.
    Worse,
    /// Too little of the template lies inside the frame.
    Outside,
    /// The pixels inside determine no increment.
    Singular,
}

/// An increment and its effect.
struct Moved {
    parameters: Vec<f64>,
    /// The warp after it.
    after: Matrix3,
    /// Farthest motion of a corner in px.
    px: f64,
}

/// An iteration of an alignment.
pub struct Iteration {
    /// Whether it aligns the first template to correct drift.
    is_correction: bool,
    level: usize,
    /// Its number on the level, from 1.
    number: usize,
    frame: Arc<Pyramid>,
    template: Arc<Template>,
    /// The warp before it.
    before: Matrix3,
    compared: Compared,
    /// The increment; none where the last one is undone or cannot be found.
    moved: Option<Moved>,
    /// Why it is the last one, if it is.
    end: Option<End>,
}

/// The judgement of an alignment.
pub struct Judged {
    frame: Arc<Pyramid>,
    template: Arc<Template>,
    warp: Matrix3,
    /// Correlation of the warped window with the template.
    correlation: f64,
    /// Share of the template inside the frame.
    overlap: f64,
    stretch: Stretch,
    /// Why the object is lost, if it is.
    loss: Option<Cause>,
}

/// The cause of a loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// Too little of the template lies inside the frame.
    Outside,
    /// The warp is collapsed.
    Warp,
    /// The correlation is too small.
    Correlation,
}

/// A drift correction.
pub struct Correction {
    frame: Arc<Pyramid>,
    first: Arc<Template>,
    /// The warp of the template, and the warp of the first template aligned from it.
    warps: [Matrix3; 2],
    /// Largest distance of a corner between both in px.
    px: f64,
    is_accepted: bool,
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The template of the first frame.
    Learned(Arc<Template>),
    /// An iteration.
    Iterated(Arc<Iteration>),
    /// The judgement of the alignment.
    Judged(Arc<Judged>),
    /// The drift correction.
    Corrected(Arc<Correction>),
    /// The template before and after its update.
    Updated([Arc<Template>; 2]),
}

/// The alignment of a template with a frame.
struct Alignment<'a> {
    frame: &'a Arc<Pyramid>,
    template: &'a Arc<Template>,
    is_correction: bool,
}

impl TemplateTracker {
    /// Aligns a template from its coarsest of `levels` levels on; returns its warp.
    fn align(
        &self,
        alignment: &Alignment<'_>,
        (levels, start): (usize, Matrix3),
        observer: &mut impl Observer<Event>,
    ) -> Matrix3 {
        (0..levels).rev().fold(start, |warp, level| self.align_level(alignment, (level, warp), observer))
    }

    /// Iterates on a level.
    fn align_level(
        &self,
        alignment: &Alignment<'_>,
        (level, start): (usize, Matrix3),
        observer: &mut impl Observer<Event>,
    ) -> Matrix3 {
        // The present warp, and the one before with its error.
        let (mut warp, mut last): (Matrix3, Option<(Matrix3, f64)>) = (start, None);
        for number in 1..=self.iterations {
            let iteration = self.iterate(alignment, (level, number), (warp, last.map(|(_, rms)| rms)));
            let (end, rms) = (iteration.end, iteration.compared.rms);
            let next = match (&iteration.moved, last) {
                (Some(moved), _) => moved.after,
                (None, Some((before, _))) if end != Some(End::Singular) => before,
                _ => warp,
            };
            observer.see(|| Event::Iterated(Arc::new(iteration)));
            (warp, last) = (next, Some((warp, rms)));
            if end.is_some() {
                break;
            }
        }
        warp
    }

    /// An iteration on a level, after one with the error `previous`.
    fn iterate(
        &self,
        Alignment { frame, template, is_correction }: &Alignment<'_>,
        (level, number): (usize, usize),
        (before, previous): (Matrix3, Option<f64>),
    ) -> Iteration {
        let of_level = &template.levels[level];
        let (aligner, image) = (of_level.aligner(self.warp.group()), &frame[level]);
        effort::add(of_level.pixels.cells().len());
        let warp = of_level.on_level(&before);
        let compared = aligner.compare(&of_level.hessian, image, &warp);
        let (moved, end) = if compared.overlap < LEAST_OVERLAP {
            (None, Some(End::Outside))
        } else if previous.is_some_and(|previous| compared.rms > previous) {
            (None, Some(End::Worse))
        } else {
            let found = aligner.increment(&compared);
            let after = found.as_ref().and_then(|found| composed(&warp, &found.matrix));
            match found.zip(after) {
                None => (None, Some(End::Singular)),
                Some((found, after)) => {
                    let after = of_level.at_full_resolution(&after);
                    let px = farthest([&before, &after], template.size());
                    let end = if px <= f64::from(self.epsilon) {
                        Some(End::Converged)
                    } else {
                        (number == self.iterations).then_some(End::Exhausted)
                    };
                    (Some(Moved { parameters: found.parameters, after, px }), end)
                }
            }
        };
        let (frame, template) = (Arc::clone(frame), Arc::clone(template));
        Iteration { is_correction: *is_correction, level, number, frame, template, before, compared, moved, end }
    }

    fn judge(&self, (frame, model): (&Arc<Pyramid>, &Model), warp: Matrix3) -> Judged {
        let template = &model.template;
        let (correlation, overlap) = template.levels[0].correlation(&frame[0], &warp);
        let stretch = Stretch::new([&model.warp, &warp], model.lost_frames);
        let loss = match () {
            () if overlap < LEAST_OVERLAP => Some(Cause::Outside),
            () if stretch.is_collapsed() => Some(Cause::Warp),
            () => (correlation < f64::from(self.min_correlation)).then_some(Cause::Correlation),
        };
        let (frame, template) = (Arc::clone(frame), Arc::clone(template));
        Judged { frame, template, warp, correlation, overlap, stretch, loss }
    }

    /// Aligns the first template from `warp` on at full resolution, which drift does not leave.
    fn correct(
        &self,
        (frame, first): (&Arc<Pyramid>, &Arc<Template>),
        warp: Matrix3,
        observer: &mut impl Observer<Event>,
    ) -> Correction {
        let alignment = Alignment { frame, template: first, is_correction: true };
        let corrected = self.align(&alignment, (1, warp), observer);
        let px = farthest([&warp, &corrected], first.size());
        let is_accepted = px <= f64::from(self.max_correction);
        let (frame, first) = (Arc::clone(frame), Arc::clone(first));
        Correction { frame, first, warps: [warp, corrected], px, is_accepted }
    }
}

pseudocode! {
    CHOOSE: "R ← region of the object in the first frame; stop if its texture does not determine the warp",
    LEARN: "T₁, T ← pixels of R; D ← steepest-descent images ∇T · ∂W/∂p, H ← Σ D^T D on each pyramid level",
    EACH_FRAME: "for each later frame t, from the last warp W",
    ALIGN: "  on each level, from the coarsest: repeat W ← W ∘ W(Δp)⁻¹, Δp ← H⁻¹ Σ D^T (I(W(x)) − T(x))",
    JUDGE: "  ρ ← correlation of I(W(x)) with T(x); lost if ρ < min-correlation, W leaves the frame or lengths change more than 2-fold (a frame, or between directions)",
    REALIGN: "  if drift-corrected: W* ← alignment of the first template T₁ in the same way, from W on",
    CORRECT: "    if W* moves no corner farther than max-correction: W ← W*, else T stays",
    UPDATE: "  if update: T(x) ← I(W(x)); D, H ← those of the new T",
    MOVE: "  the region is W(R), unless the object is lost",
}

impl RegionModel for TemplateTracker {
    const INFO: Info = Info {
        id: "template-tracker",
        name: "Template tracker",
        family: "Region tracking",
        summary: "Aligns a template with each frame by Gauss–Newton iterations of its warp, and updates it without drift.",
        source: "I. Matthews, T. Ishikawa and S. Baker, The template update problem, PAMI 26(6), 2004; inverse compositional algorithm: \
                 S. Baker and I. Matthews, Lucas–Kanade 20 years on: a unifying framework, IJCV 56(3), 2004",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        WHERE,
        Question::choice(
            "diverged",
            "How does the next iteration end?",
            &[
                Reply::told(line::ALIGN, case::NOT_CONVERGED, "Another iteration follows"),
                Reply::told(line::ALIGN, case::DIVERGED, "The alignment has diverged"),
                Reply::told(line::ALIGN, case::UNDONE, "The error no longer falls"),
            ],
        ),
        LOST,
    ];
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series, Chart::Matrices];
    const CONTRASTS: Option<&'static str> = Some("update");
    const SIMILARITY: Similarity = Similarity {
        name: "correlation with the template",
        label: "Correlation with the template",
        symbol: "ρ",
        decimals: 3,
        shared_by: "a template that has drifted",
    };
    type Model = Model;
    type Event = Event;

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn refuse(&self, frame: &Frame, region: Region) -> Option<Refusal> {
        let group = self.warp.group();
        let template = Template::first(&pyramid(frame.luma(), 1), region, group);
        let is_regular = solve(&template.levels[0].hessian, &vec![0.0; group.freedom()]).is_some();
        (!is_regular).then(|| (case::SINGULAR_TEMPLATE, vec![value::PARAMETERS.is(group.freedom())]))
    }

    fn begin(&self, frame: &Arc<Frame>, region: Region, observer: &mut impl Observer<Event>) -> (Model, f32) {
        let first = Template::first(&pyramid(frame.luma(), self.levels), region, self.warp.group());
        let first = Arc::new(first);
        observer.see(|| Event::Learned(Arc::clone(&first)));
        let [x, y] = region.center.map(f64::from);
        let warp = [[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]];
        (Model { template: Arc::clone(&first), first, extent: region.size, warp, lost_frames: 0 }, 1.0)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Event>,
    ) -> RegionFrame {
        let frame = &Arc::new(pyramid(frame.luma(), model.first.levels.len()));
        let template = &Arc::clone(&model.template);
        let alignment = Alignment { frame, template, is_correction: false };
        let mut warp = self.align(&alignment, (template.levels.len(), model.warp), observer);
        let judged = Arc::new(self.judge((frame, model), warp));
        observer.see(|| Event::Judged(Arc::clone(&judged)));
        let similarity = judged.correlation as f32;
        if judged.loss.is_some() {
            model.lost_frames += 1;
            return RegionFrame { region, similarity, is_lost: true };
        }
        let mut is_updated = self.update != Update::None;
        if self.update == Update::Corrected {
            let correction = Arc::new(self.correct((frame, &model.first), warp, observer));
            observer.see(|| Event::Corrected(Arc::clone(&correction)));
            is_updated = correction.is_accepted;
            warp = if is_updated { correction.warps[1] } else { warp };
        }
        if is_updated {
            let updated = Arc::new(template.warped(frame, &warp, self.warp.group()));
            observer.see(|| Event::Updated([Arc::clone(template), Arc::clone(&updated)]));
            model.template = updated;
        }
        (model.warp, model.lost_frames) = (warp, 0);
        RegionFrame { region: region_of(&warp, model.extent), similarity, is_lost: false }
    }

    fn need(&self, clip: &Clip) -> Need {
        // The levels of a frame, and at most three templates as large as it, with their derivatives; in a walk more of them.
        let sums = 1e3 * (2 * self.levels * self.iterations) as f64;
        Need::per_pixel(clip, [64.0, 128.0]).and([0.0, sums])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        size_of::<Model>() + model.first.bytes() + model.template.bytes()
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Learned(_) => line::LEARN,
            Event::Iterated(iteration) if iteration.is_correction => line::REALIGN,
            Event::Iterated(_) => line::ALIGN,
            Event::Judged(_) => line::JUDGE,
            Event::Corrected(_) => line::CORRECT,
            Event::Updated(_) => line::UPDATE,
        }
    }
}
