//! RAPiD: a rigid wireframe model is refitted to the edges along the normals of its projection.

mod account;
mod explain;
mod fit;
mod vocabulary;
mod wireframe;

use std::sync::Arc;

use crate::base::Observer;
use crate::data::{Clip, Frame, Pose};
use crate::methods::region::{LOST, Refusal, RegionModel, Settings, Similarity, WHERE};
use crate::products::{Region, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Chart, Name, Question};
use crate::{choices, params, pseudocode};

use account::Past;
use fit::{Equations, Motion, Sought, View, equations, matched, solution};
use vocabulary::{case, value};
pub use wireframe::Solid;
use wireframe::{Camera, Wireframe};

choices! {
    /// Pose at which the search of a frame starts.
    pub enum Prediction {
        /// The pose of the last frame: the motion between frames must stay within the search range.
        None = "none" "None",
        /// The last pose moved by the last motion: constant velocity.
        ConstantVelocity = "constant-velocity" "Constant velocity",
    }
}

choices! {
    /// Weights of the edges.
    pub enum Weighting {
        /// All edges count alike: an edge of something else pulls with its whole distance.
        Equal = "equal" "Equal",
        /// An edge counts less, the farther it lies from the common solution: 1/(c + |r|).
        Robust = "robust" "Robust",
    }
}

params! {
    /// RAPiD tracker.
    pub struct Rapid {
        /// Region and frames.
        settings: Settings = Settings::default();
        /// Shape of the model.
        solid: Solid = Solid::Box;
        /// Width of the model along its X axis.
        model_width: f32 = 0.48, 0.01..=100.0, "m";
        /// Height of the model along its Y axis, downwards.
        model_height: f32 = 0.32, 0.01..=100.0, "m";
        /// Depth of the model along its Z axis, away from the camera.
        model_depth: f32 = 0.36, 0.01..=100.0, "m";
        /// Initial rotation about the vertical axis of the model: positive angles show its right side.
        turn: f32 = 30.0, -180.0..=180.0, "°";
        /// Initial tilt towards the camera: positive angles show its top.
        tilt: f32 = 20.0, -89.0..=89.0, "°";
        /// Horizontal field of view of the camera. It gives the focal length in px; the principal point is the middle of the picture.
        field_of_view: f32 = 56.14, 5.0..=150.0, "°";
        /// Pose at which the search of a frame starts.
        pose_prediction: Prediction = Prediction::ConstantVelocity;
        /// Weights of the edges.
        weighting: Weighting = Weighting::Robust;
        /// Distance of the control points on the projected edges.
        spacing: f32 = 6.0, 1.0..=50.0, "px";
        /// Largest distance of an edge from its control point, along the normal on both sides. The nearest edge is taken.
        search_range: usize = 8, 1..=40, "px";
        /// Gradient along the normal below which there is no edge.
        min_gradient: f32 = 6.0, 0.5..=100.0, "levels/px";
        /// Maximum number of iterations in a frame; the original method has one.
        iterations: usize = 8, 1..=50;
        /// Stopping criterion: the iterations of a frame end with a motion that moves no control point farther.
        epsilon: f32 = 0.02, 0.001..=1.0, "px";
        /// Share of control points with an edge below which the object is lost: the pose stays.
        min_share: f32 = 0.5, 0.0..=1.0;
        /// Median distance of the edges from the refitted model above which the object is lost, because they fit no common pose. The search goes
        /// on from that pose all the same, which may be right again in the next frame.
        max_residual: f32 = 0.6, 0.05..=40.0, "px";
    }
    advanced { "iterations", "epsilon", "spacing" }
}

/// The state carried from frame to frame.
#[derive(Clone)]
pub struct Model {
    view: View,
    /// The motion to the pose of the last frame from that of the one before.
    motion: Motion,
    /// The result of the last frame.
    result: RegionFrame,
    /// The judgements of all frames.
    past: Arc<Vec<Past>>,
}

/// The end of the iterations of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    /// The motion is small.
    Converged,
    /// All iterations are done.
    Exhausted,
    /// The edges determine no pose in front of the camera.
    Undetermined,
}

/// An iteration.
pub struct Iteration {
    /// Its number in the frame, from 1.
    number: usize,
    /// The model before it.
    view: View,
    sought: Vec<Sought>,
    equations: Equations,
    /// The six parameters of the motion, the pose after it, and the farthest motion of a control point in px; none where there is no
    /// solution.
    moved: Option<(Motion, Pose, f64)>,
    end: Option<End>,
}

/// The judgement of the pose.
pub struct Judged {
    view: View,
    sought: Vec<Sought>,
    /// Share of the control points with an edge.
    share: f64,
    /// Median distance of the edges from them in px.
    residual_px: f64,
    /// Covariance of rotation vector and translation, row by row in rad and m.
    covariance: Option<Vec<f64>>,
    /// Why the object is lost, if it is.
    loss: Option<Cause>,
}

/// The cause of a loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// The edges determine no pose.
    Undetermined,
    /// Too few control points have an edge.
    Edges,
    /// A part of the model lies behind the camera.
    Behind,
    /// The edges are too far from the model.
    Fit,
}

impl Judged {
    /// Whether the next search starts from the pose.
    fn is_kept(&self) -> bool {
        self.loss.is_none_or(|cause| cause == Cause::Fit)
    }
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event {
    /// The model at its first pose.
    Placed(View),
    /// The prediction from a pose.
    Predicted([View; 2]),
    /// An iteration.
    Iterated(Arc<Iteration>),
    /// The judgement of the pose.
    Judged(Arc<Judged>),
}

impl Event {
    /// The model before an iteration, or at the end of the step.
    fn view(&self) -> &View {
        match self {
            Self::Placed(view) | Self::Predicted([_, view]) => view,
            Self::Iterated(iteration) => &iteration.view,
            Self::Judged(judged) => &judged.view,
        }
    }
}

impl Rapid {
    /// The model that fills a region of a picture of this size at the initial rotation.
    fn placed_in(&self, region: Region, picture: (usize, usize)) -> View {
        let [turn, tilt] = [self.turn, self.tilt].map(|angle| f64::from(angle).to_radians().sin_cos());
        let (wireframe, camera) = (Wireframe::of(self), Camera::new(picture, self.field_of_view));
        let pose = wireframe.placed(&camera, Pose::tilted(turn, tilt, [0.0; 3]), region);
        View { wireframe: Arc::new(wireframe), camera, picture, pose }
    }

    /// The control points of a model with their edges.
    fn edges_of(&self, frame: &Frame, view: &View) -> Vec<Sought> {
        let controls = view.wireframe.controls(&view.camera, (&view.pose, self.spacing), view.picture);
        self.sought(frame, (&view.sight(), controls))
    }

    /// Refines the pose of a model in a frame.
    fn refine(&self, frame: &Frame, start: View, observer: &mut impl Observer<Event>) -> View {
        let mut view = start;
        for number in 1..=self.iterations {
            let iteration = self.iterate(frame, &view, number);
            let (moved, end) = (iteration.moved, iteration.end);
            observer.see(|| Event::Iterated(Arc::new(iteration)));
            if let Some((_, pose, _)) = moved {
                view = view.at(pose);
            }
            if end.is_some() {
                break;
            }
        }
        view
    }

    fn iterate(&self, frame: &Frame, view: &View, number: usize) -> Iteration {
        let sought = self.edges_of(frame, view);
        let equations = equations(&sought, &view.sight());
        let moved = solution(&equations).and_then(|parameters| {
            let motion = fit::motion_of(&parameters);
            let pose = view.pose.after(motion);
            view.wireframe.bounds(&view.camera, &pose)?;
            Some((motion, pose, fit::farthest(&sought, &view.camera, [&view.pose, &pose])))
        });
        let end = match moved {
            None => Some(End::Undetermined),
            Some((.., px)) if px <= f64::from(self.epsilon) => Some(End::Converged),
            Some(_) => (number == self.iterations).then_some(End::Exhausted),
        };
        Iteration { number, view: view.clone(), sought, equations, moved, end }
    }

    /// Judges a pose by the edges at it.
    fn judge(&self, frame: &Frame, view: &View) -> Judged {
        let sought = self.edges_of(frame, view);
        let share = matched(&sought) as f64 / sought.len().max(1) as f64;
        let covariance = fit::covariance(&sought, &view.sight());
        let residual_px = fit::median_distance(&sought);
        let loss = match &covariance {
            None => Some(Cause::Undetermined),
            Some(_) if share < f64::from(self.min_share) => Some(Cause::Edges),
            Some(_) if view.bounds().is_none() => Some(Cause::Behind),
            Some(_) => (residual_px > f64::from(self.max_residual)).then_some(Cause::Fit),
        };
        Judged { view: view.clone(), sought, share, residual_px, covariance, loss }
    }

    /// Judges the pose that a frame gives, where the last one had `region`.
    fn result(
        &self,
        (frame, region): (&Frame, Region),
        view: &View,
        observer: &mut impl Observer<Event>,
    ) -> (RegionFrame, Arc<Judged>) {
        let judged = Arc::new(self.judge(frame, view));
        observer.see(|| Event::Judged(Arc::clone(&judged)));
        let bounds = view.bounds().filter(|_| judged.loss.is_none());
        let (similarity, is_lost) = (judged.share as f32, judged.loss.is_some());
        let result = RegionFrame { region: bounds.map_or(region, Region::from), similarity, is_lost };
        (result, judged)
    }
}

pseudocode! {
    CHOOSE: "R ← region of the object in the first frame; stop if fewer than 6 control points have an edge",
    PLACE: "pose (R, T) ← turn, tilt, and the translation at which the model fills the region",
    EACH_FRAME: "for each frame t",
    PREDICT: "  if the pose is predicted: (R, T) ← (R, T) moved by the last motion",
    REFINE: "  repeat: l_i ← distance of the nearest edge along the normal of control point i; (θ, Δ) ← (Σ w_i c_i c_i^T + λ a a^T)⁻¹ Σ w_i c_i l_i, \
             with w_i = 1 unless the weights are robust, and λ = 0 unless a rotation about an axis a is held",
    JUDGE: "  P ← σ² (Σ w_i c_i c_i^T + λ a a^T)⁻¹ without the held rotation; lost if the share of control points with an edge < min-share, \
            or the median of |l_i| > max-residual",
    MOVE: "  the region is the rectangle around the projection, unless the object is lost",
}

impl RegionModel for Rapid {
    const INFO: Info = Info {
        id: "rapid",
        name: "RAPiD",
        family: "Region tracking",
        summary: "Tracks the pose of a rigid wireframe model by the edges along the normals of its projection.",
        source: "C. Harris and C. Stennett, RAPiD: a video rate object tracker, BMVC 1990; robust weights: T. Drummond and R. Cipolla, \
                 Real-time visual tracking of complex structures, PAMI 24(7), 2002",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[WHERE, LOST];
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Matrices];
    const CONTRASTS: Option<&'static str> = Some("pose-prediction");
    const SIMILARITY: Similarity = Similarity {
        name: "share of matched control points",
        label: "Share of matched control points",
        symbol: "s",
        decimals: 3,
        shared_by: "a wrong pose near edges of something else",
    };
    type Model = Model;
    type Event = Event;

    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn refuse(&self, frame: &Frame, region: Region) -> Option<Refusal> {
        let view = self.placed_in(region, frame.size());
        let sought = self.edges_of(frame, &view);
        let (found, all) = (value::MATCHED.is(matched(&sought)), value::CONTROL_POINTS.is(sought.len()));
        let numbers = [found, all, value::SEARCH_RANGE.is(self.search_range)];
        let motion = solution(&equations(&sought, &view.sight()));
        motion.is_none().then(|| (case::REFUSED, numbers.into()))
    }

    fn begin(&self, frame: &Arc<Frame>, region: Region, observer: &mut impl Observer<Event>) -> (Model, f32) {
        let placed = self.placed_in(region, frame.size());
        observer.see(|| Event::Placed(placed.clone()));
        let refined = self.refine(frame, placed.clone(), observer);
        let (result, judged) = self.result((frame, region), &refined, observer);
        let view = if judged.is_kept() { refined } else { placed };
        let past = Arc::new(vec![Past::from(&*judged)]);
        (Model { view, motion: Motion::default(), result, past }, result.similarity)
    }

    fn fitted(&self, model: &Model) -> Option<RegionFrame> {
        Some(model.result)
    }

    fn follow(
        &self,
        model: &mut Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Event>,
    ) -> RegionFrame {
        let before = model.view.pose;
        let mut start = model.view.clone();
        if self.pose_prediction == Prediction::ConstantVelocity {
            start = start.at(before.after(model.motion));
            observer.see(|| Event::Predicted([model.view.clone(), start.clone()]));
        }
        let view = self.refine(frame, start, observer);
        let judged;
        (model.result, judged) = self.result((frame, region), &view, observer);
        Arc::make_mut(&mut model.past).push(Past::from(&*judged));
        if judged.is_kept() {
            model.motion = before.motion_to(&view.pose);
            model.view = view;
        } else {
            model.motion = Motion::default();
        }
        model.result
    }

    fn need(&self, clip: &Clip) -> Need {
        // Control points on edges that cross the picture, each with its equation; in a walk those of all iterations.
        let (width, height) = clip.size();
        let points = 72.0 * (width + height) as f64 / f64::from(self.spacing);
        let each = size_of::<Sought>() as f64;
        Need::per_pixel(clip, [1.0, 1.0]).and([2.0 * each * points, (self.iterations + 1) as f64 * each * points])
    }

    fn model_bytes(&self, model: &Model) -> usize {
        size_of::<Model>() + size_of::<Wireframe>() + size_of_val(&model.past[..])
    }

    fn line(&self, event: &Event) -> Name {
        match event {
            Event::Placed(_) => line::PLACE,
            Event::Predicted(_) => line::PREDICT,
            Event::Iterated(_) => line::REFINE,
            Event::Judged(_) => line::JUDGE,
        }
    }
}
