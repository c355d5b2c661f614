//! The report of a run, as text and as JSON.

use std::time::Duration;

use motionscope_core::base::words::fixed;
use motionscope_core::products::epipolar::Pose;
use motionscope_core::products::model::Matrix3;
use motionscope_core::products::{Assessment, EpipolarField, Figure, ModelField, Output};
use motionscope_core::run::{Cursor, Extent};
use motionscope_core::scene::{Fact, Picture, Readout, Step};
use serde::{Serialize, Serializer};
use serde_json::Map;

use super::list::value;
use super::step::StepReport;
use crate::experiment::pixel::Pixel;
use crate::experiment::{Prepared, TakenRegion};
use crate::view::motion::Check;

/// One run in numbers.
#[derive(Serialize)]
pub struct Report {
    clip: String,
    estimator: &'static str,
    params: Map<String, serde_json::Value>,
    frame: usize,
    /// The frame that the last pair ends with.
    last_frame: usize,
    units: usize,
    events: u64,
    threads: usize,
    ms: Milliseconds,
    /// The files that truth was read from.
    truth_files: Vec<String>,
    #[serde(serialize_with = "figures")]
    metrics: Assessment,
    #[serde(skip_serializing_if = "Option::is_none")]
    model: Option<ModelReport>,
    /// The region that was taken where none was placed.
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<TakenRegion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    consistency: Option<Checked>,
    /// The scores of the causal variant, without later frames.
    #[serde(serialize_with = "live_figures", skip_serializing_if = "Option::is_none")]
    live: Option<Assessment>,
    /// The sentence of the last step, where a model of the motion or one track was estimated or refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    conclusion: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pixel: Option<ExplainedPixel>,
    /// The step that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<StepReport>,
}

/// The explanation of a pixel at a step.
#[derive(Serialize)]
pub struct ExplainedPixel {
    x: u32,
    y: u32,
    /// The picture, if it is not frame t.
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<String>,
    step: String,
    /// The displacement in px per frame, if it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    flow: Option<[f32; 2]>,
    sentence: String,
    facts: Map<String, serde_json::Value>,
}

impl ExplainedPixel {
    /// Creates the explanation of a pixel from `step` at `cursor`, with its `motion` if it is known.
    pub fn new(Pixel { on, x, y }: Pixel, cursor: Cursor, step: &Step, motion: Option<[f32; 2]>) -> Self {
        let facts = step.readouts.iter().filter_map(|r| if let Readout::Facts(facts) = r { Some(facts) } else { None });
        Self {
            x,
            y,
            picture: (on != Picture::CURRENT).then(|| on.to_string()),
            step: cursor.to_string(),
            flow: motion,
            sentence: step.sentence.plain(),
            facts: facts.flatten().map(|fact| (fact.label.into(), fact.value.clone().into())).collect(),
        }
    }

    fn text(&self) -> String {
        let Self { x, y, picture, step, flow, sentence, facts } = self;
        let of = picture.as_ref().map_or_else(String::new, |picture| format!(" of the picture {picture}"));
        let mut text = format!("pixel       ({x}, {y}){of} at step {step}: {sentence}\n");
        if let Some([u, v]) = flow.map(|flow| flow.map(|c| fixed(c.into(), 3))) {
            text += &format!("flow        ({u}, {v}) px\n");
        }
        let width = facts.keys().map(|label| label.chars().count()).max().unwrap_or(0).max(10);
        for (label, value) in facts {
            text += &format!("  {:<width$}  {}\n", label.to_lowercase(), bare(value));
        }
        text
    }
}

/// The evaluation of a run's output.
pub struct Findings {
    /// The assessment of the output.
    pub assessment: Assessment,
    /// The forward–backward check, if requested.
    pub check: Option<Check>,
    /// The assessment of the causal variant, if the estimator uses later frames.
    pub live: Option<Assessment>,
    /// The sentence of the last step, where a model of the motion or one track was estimated or refused.
    pub conclusion: Option<String>,
    /// The explanation of a pixel, if requested.
    pub pixel: Option<ExplainedPixel>,
    /// A step as data, if requested.
    pub step: Option<StepReport>,
}

/// The scores by their keys.
fn figures<S: Serializer>(assessment: &Assessment, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(assessment.scores.iter().map(|score| (score.measure.key, Value::from(score.value))))
}

fn live_figures<S: Serializer>(live: &Option<Assessment>, serializer: S) -> Result<S::Ok, S::Error> {
    match live {
        Some(live) => figures(live, serializer),
        None => serializer.serialize_none(),
    }
}

/// A figure in JSON.
#[derive(Serialize)]
#[serde(untagged)]
enum Value {
    Count(u64),
    Real(f64),
    None,
}

impl From<Figure> for Value {
    fn from(figure: Figure) -> Self {
        match figure {
            Figure::Count(count) => Self::Count(count),
            Figure::Real(value) => Self::Real(value),
            Figure::None | Figure::Undefined => Self::None,
        }
    }
}

/// The result of the forward–backward check.
#[derive(Serialize)]
struct Checked {
    /// Number of inconsistent pixels.
    inconsistent: usize,
    /// Their share of all pixels.
    share: f64,
    /// Share of the inconsistent pixels that are occluded, if the true occlusions are known.
    precision: Option<f64>,
    /// Share of the occluded pixels that are inconsistent.
    recall: Option<f64>,
}

impl Checked {
    fn of(check: Check) -> Self {
        let Check { inconsistent, pixels, agreement } = check;
        Self {
            inconsistent,
            share: inconsistent as f64 / pixels.max(1) as f64,
            precision: agreement.and_then(|agreement| agreement.precision),
            recall: agreement.and_then(|agreement| agreement.recall),
        }
    }
}

/// The geometric model of a run.
#[derive(Serialize)]
struct ModelReport {
    kind: &'static str,
    /// By rows; maps homogeneous pixel positions of frame t to positions, or to epipolar lines, in frame t + 1. Null without an
    /// estimate.
    matrix: Option<Matrix3>,
    inliers: Option<usize>,
    matches: Option<usize>,
    iterations: usize,
    residual_px: Option<f64>,
    /// The pose of the camera, where its focal length is given and fits.
    #[serde(skip_serializing_if = "Option::is_none")]
    camera: Option<CameraReport>,
}

/// The pose of a calibrated camera between both frames.
#[derive(Serialize)]
struct CameraReport {
    /// The essential matrix [t]ₓ R, by rows.
    essential: Matrix3,
    /// The rotation matrix R, by rows.
    rotation: Matrix3,
    /// The direction of the translation t of X′ = R X + t, of length 1.
    translation: [f64; 3],
    /// The direction of the camera's motion −Rᵀt, of length 1, in its own axes of frame t.
    camera_direction: [f64; 3],
    /// Number of inliers in front of both cameras.
    in_front: usize,
    /// Ratio of the second to the first singular value of the essential matrix that follows from the fundamental one.
    singular_ratio: f64,
}

impl CameraReport {
    fn of(pose: &Pose) -> Self {
        let Pose { rotation, translation, in_front, singular_ratio } = *pose;
        let (essential, camera_direction) = (pose.essential(), pose.camera_direction());
        Self { essential, rotation, translation, camera_direction, in_front, singular_ratio }
    }
}

impl ModelReport {
    fn of(output: &Output) -> Option<Self> {
        let plane = output.get().map(|field: &ModelField| {
            let ModelField { model, matrix, iterations, residual_px, support, .. } = *field;
            let [inliers, matches] = [support.map(|of| of.inliers), support.map(|of| of.matches)];
            Self { kind: model.id(), matrix, inliers, matches, iterations, residual_px, camera: None }
        });
        let epipolar = |field: &EpipolarField| {
            let EpipolarField { matrix, iterations, residual_px, support, pose, .. } = *field;
            let [inliers, matches] = [Some(support.inliers), Some(support.matches)];
            let camera = pose.as_ref().map(CameraReport::of);
            Self { kind: "fundamental", matrix, inliers, matches, iterations, residual_px, camera }
        };
        plane.or_else(|| output.get().map(epipolar))
    }
}

/// Time of the estimation without decoding and drawing.
#[derive(Serialize)]
struct Milliseconds {
    median: f64,
    min: f64,
}

/// The threads and times of a run.
pub struct Timing {
    /// Number of threads.
    pub threads: usize,
    /// The time of each repetition; at least one.
    pub times: Vec<Duration>,
}

impl Report {
    /// Creates the report of a run of `prepared`.
    pub fn new(
        Prepared { experiment, clip, .. }: &Prepared,
        output: &Output,
        Findings { assessment: metrics, check, live, conclusion, pixel, step }: Findings,
        extent: Extent,
        timing: Timing,
    ) -> Self {
        let Timing { threads, mut times } = timing;
        times.sort();
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let middle = times.len() / 2;
        let median = if times.len() % 2 == 1 { ms(times[middle]) } else { ms(times[middle - 1] + times[middle]) / 2.0 };
        Self {
            clip: experiment.source.to_string(),
            estimator: experiment.estimator.info().id,
            params: experiment.estimator.all_values().into_iter().map(|(name, v)| (name, value(v))).collect(),
            frame: experiment.frame,
            last_frame: output.last_frame().unwrap_or(experiment.frame + 1),
            units: extent.units,
            events: extent.events,
            threads,
            ms: Milliseconds { median, min: times.first().copied().map_or(0.0, ms) },
            truth_files: clip.truth().map(|truth| truth.names()).unwrap_or_default(),
            metrics,
            model: ModelReport::of(output),
            start: TakenRegion::of(&*experiment.estimator, output),
            consistency: check.map(Checked::of),
            live,
            conclusion,
            pixel,
            step,
        }
    }

    /// Returns the report as text.
    pub fn text(&self) -> String {
        let Self { clip, estimator, params, frame, last_frame, units, events, threads, ms, .. } = self;
        let Self { truth_files, metrics, start, consistency, live, conclusion, pixel, .. } = self;
        let params: Vec<_> = params.iter().map(|(name, value)| format!("{name}={}", bare(value))).collect();
        let mut text = format!("{estimator} on {clip}, frame {frame} to {last_frame}\n");
        text += &format!("parameters  {}\n", params.join(" "));
        text += &format!("work        {units} units, {events} events\n");
        text += &format!("time        {:.3} ms (median), {:.3} ms (minimum), threads: {threads}\n", ms.median, ms.min);
        if !truth_files.is_empty() {
            text += &format!("truth       {}\n", truth_files.join(", "));
        }
        if let Some(start) = start {
            text += &format!("region      {}\n", start.text());
        }
        let width = metrics.facts.iter().map(|fact| fact.label.chars().count()).max().unwrap_or(0).max(10);
        for Fact { label, value, .. } in &metrics.facts {
            text += &format!("{:<width$}  {value}\n", label.to_lowercase());
        }
        if let Some(live) = live {
            text += &format!("live        {}: causal, without hindsight, as on a live camera\n", live.headline);
        }
        if let Some(Checked { inconsistent, share, precision, recall }) = consistency {
            let percent =
                |share: Option<f64>| share.map_or("unknown".into(), |share| format!("{:.1} %", 100.0 * share));
            let (precision, recall) = (percent(*precision), percent(*recall));
            text += &format!(
                "consistency {inconsistent} inconsistent pixels, {:.1} %; as a detector of occlusion: precision {precision}, \
                 recall {recall}\n",
                100.0 * share
            );
        }
        if let Some(conclusion) = conclusion {
            text += &format!("conclusion  {conclusion}\n");
        }
        text + &pixel.as_ref().map(ExplainedPixel::text).unwrap_or_default()
    }
}

/// Returns a JSON value as typed on the command line.
fn bare(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Bool(on) => if *on { "on" } else { "off" }.into(),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
