//! What a run tells of itself, for a person and for a script.

use std::time::Duration;

use motionscope_core::scene::Fact;
use motionscope_core::{Error, Extent, Output};
use serde::Serialize;
use serde_json::Map;

use super::list::value;
use super::task::Task;
use crate::motion::Check;
use crate::quality::{AgainstTruth, Quality, TrackScores, Ways};

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
    metrics: Quality,
    #[serde(skip_serializing_if = "Option::is_none")]
    consistency: Option<Checked>,
    /// The scores of the tracker where it may not look back in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<TrackScores>,
}

/// The check with the reverse pair in numbers.
#[derive(Serialize)]
struct Checked {
    /// Pixels that fail it.
    inconsistent: usize,
    /// Their share of all.
    share: f64,
    /// Share of them that are truly hidden, where that is known.
    precision: Option<f64>,
    /// Share of the truly hidden that are among them.
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

/// Time of the estimation alone: no decoding, no drawing.
#[derive(Serialize)]
struct Milliseconds {
    median: f64,
    min: f64,
}

/// How a run went.
pub struct Timing {
    /// Threads that it ran on.
    pub threads: usize,
    /// The time of each repetition; at least one.
    pub times: Vec<Duration>,
}

impl Report {
    /// What `task` led to, in numbers.
    pub fn new(
        task: &Task,
        output: &Output,
        (metrics, check, live): (Quality, Option<Check>, Option<TrackScores>),
        extent: Extent,
        timing: Timing,
    ) -> Self {
        let Timing { threads, mut times } = timing;
        times.sort();
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let middle = times.len() / 2;
        let median = if times.len() % 2 == 1 { ms(times[middle]) } else { ms(times[middle - 1] + times[middle]) / 2.0 };
        Self {
            clip: task.name.clone(),
            estimator: task.estimator.info().id,
            params: task.estimator.values().into_iter().map(|(name, v)| (name.into(), value(v))).collect(),
            frame: task.frame,
            last_frame: match output {
                Output::Tracks(tracks) => tracks.last,
                Output::Objects(field) => field.first + field.frames.len().saturating_sub(1),
                _ => task.frame + 1,
            },
            units: extent.units,
            events: extent.events,
            threads,
            ms: Milliseconds { median, min: times.first().copied().map_or(0.0, ms) },
            truth_files: task.clip.truth().map(|truth| truth.names()).unwrap_or_default(),
            metrics,
            consistency: check.map(Checked::of),
            live,
        }
    }

    /// The same for a person.
    pub fn text(&self) -> String {
        let Self { clip, estimator, params, frame, last_frame, units, events, threads, ms, .. } = self;
        let Self { truth_files, metrics, consistency, live, .. } = self;
        let params: Vec<_> = params.iter().map(|(name, value)| format!("{name}={}", bare(value))).collect();
        let mut text = format!("{estimator} on {clip}, frame {frame} to {last_frame}\n");
        text += &format!("parameters  {}\n", params.join(" "));
        let candidates = metrics.candidates.map_or_else(String::new, |count| format!(", {count} candidates"));
        text += &format!("work        {units} units, {events} events{candidates}\n");
        text += &format!("time        {:.3} ms (median), {:.3} ms (least), threads: {threads}\n", ms.median, ms.min);
        if !truth_files.is_empty() {
            text += &format!("truth       {}\n", truth_files.join(", "));
        }
        if let Some(features) = metrics.features {
            text += &format!("features    {}\n", features.text());
        }
        if let Some(objects) = metrics.objects {
            text += &format!("objects     {}\n", objects.text());
            for Fact { label, value, .. } in objects.ways.iter().flat_map(Ways::facts) {
                text += &format!("{:<12}{value}\n", label.to_lowercase());
            }
            if let Some(TrackScores { mota, motp, idf1, hota, switches, precision, recall, true_objects }) =
                objects.scores
            {
                text += &format!(
                    "scores      MOTA {mota:.3}, MOTP {motp:.3}, IDF1 {idf1:.3}, HOTA {hota:.3}, {switches} switches\n\
                     found       precision {:.1} %, recall {:.1} % of {true_objects} true objects, at IoU 0.5\n",
                    100.0 * precision,
                    100.0 * recall
                );
            }
            if let Some(TrackScores { mota, motp, idf1, hota, switches, .. }) = live {
                text += &format!(
                    "live        MOTA {mota:.3}, MOTP {motp:.3}, IDF1 {idf1:.3}, HOTA {hota:.3}, {switches} switches, with bridge and \
                     backdate off: without looking back in time\n"
                );
            }
        }
        if let Some(prediction) = metrics.prediction {
            let sent = if prediction.vector_bits.is_some() { "residual + vectors" } else { "residual" };
            text += &format!("prediction  {}\n", prediction.psnr());
            text += &format!("entropy     {} ({sent})\n", prediction.coding());
        }
        text += &match &metrics.truth {
            Some(AgainstTruth { epe_px, epe_median_px, epe_p95_px, r0_5, r1_0, r2_0, aae_deg, known, coverage }) => {
                let what = if metrics.features.is_some() { "displacements" } else { "pixels" };
                let share = coverage.map_or_else(String::new, |share| format!(", {:.0} % of them", 100.0 * share));
                let [r0_5, r1_0, r2_0] = [r0_5, r1_0, r2_0].map(|share| 100.0 * share);
                format!(
                    "error       {epe_px:.3} px endpoint (median {epe_median_px:.3}, 95 % below {epe_p95_px:.3}), \
                     {aae_deg:.2}° angular, over {known} {what} of known motion{share}\n\
                     beyond      {r0_5:.1} % by more than 0.5 px, {r1_0:.1} % by 1 px, {r2_0:.1} % by 2 px\n"
                )
            }
            // Nothing was said of motion.
            None if metrics.objects.is_some() => String::new(),
            None if metrics.features.is_some_and(|features| features.tracked.is_none()) => String::new(),
            None if metrics.truth_error.is_some() => "error       unknown: the true flow cannot be read\n".into(),
            None => "error       unknown: there is no true flow for this frame\n".into(),
        };
        if let Some(Checked { inconsistent, share, precision, recall }) = consistency {
            let percent =
                |share: Option<f64>| share.map_or("unknown".into(), |share| format!("{:.1} %", 100.0 * share));
            let (precision, recall) = (percent(*precision), percent(*recall));
            text += &format!(
                "consistency {inconsistent} pixels fail the check, {:.1} %; of those truly hidden: precision {precision}, recall \
                 {recall}\n",
                100.0 * share
            );
        }
        text
    }
}

/// A JSON value as a person would type it.
fn bare(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Bool(on) => if *on { "on" } else { "off" }.into(),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// `value` as one line of JSON.
///
/// # Errors
/// If it cannot be told as JSON.
pub fn to_json(value: &impl Serialize) -> Result<String, Error> {
    serde_json::to_string(value).map_err(|error| Error::new(format!("the result cannot be told as JSON: {error}")))
}
