//! How good an estimate is, for the command line and for the window.

use std::collections::BTreeSet;
use std::sync::Arc;

use motionscope_core::metrics::{self, FlowError};
use motionscope_core::objects::score::{self, Scores};
use motionscope_core::objects::trajectory::Trajectory;
use motionscope_core::scene::{Distribution, Fact};
use motionscope_core::{
    BlockField, Clip, Coding, Error, Flow, Gray, Grid, Life, ObjectField, ObjectFrame, Output, PointField, Status,
    TrackField, Truth,
};
use serde::Serialize;

use crate::paint::grouped;

/// An estimate in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// Candidates that were tested, where there are such.
    pub candidates: Option<u64>,
    /// What the motion-compensated prediction of frame t is worth, where there is one.
    #[serde(flatten)]
    pub prediction: Option<Prediction>,
    /// What became of the features, where there are such.
    #[serde(flatten)]
    pub features: Option<Features>,
    /// What was found of objects, where there are such.
    #[serde(flatten)]
    pub objects: Option<Objects>,
    /// Errors against the true flow, where it is known.
    #[serde(flatten)]
    pub truth: Option<AgainstTruth>,
    /// How these errors are distributed.
    #[serde(skip)]
    pub errors: Option<Distribution>,
    /// Why they are not known, where there is a truth that cannot be read.
    #[serde(skip)]
    pub truth_error: Option<Error>,
}

/// A motion-compensated prediction in numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Prediction {
    /// Peak signal-to-noise ratio in dB; `None` if it is perfect.
    pub psnr_db: Option<f64>,
    /// Bits of the frame sent anew, by zero-order entropy.
    pub frame_bits: f64,
    /// Bits of the residual that the prediction leaves.
    pub residual_bits: f64,
    /// Bits of the displacements of blocks.
    pub vector_bits: Option<f64>,
}

/// How many features there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Features {
    /// All of them; of a run through several frames, all tracks.
    pub points: usize,
    /// Those that were tracked, if any were to be; of tracks, those that were not lost.
    pub tracked: Option<usize>,
}

impl Features {
    fn of(field: &PointField) -> Self {
        let points = field.points.len();
        let is_tracked = field.count(|status| status == Status::Found) < points;
        Self { points, tracked: is_tracked.then(|| field.count(|status| status == Status::Tracked)) }
    }

    fn of_tracks(field: &TrackField) -> Self {
        let alive = field.tracks.iter().filter(|track| track.is_alive()).count();
        Self { points: field.tracks.len(), tracked: Some(alive) }
    }

    /// The same in words: `500, tracked 478`.
    pub fn text(&self) -> String {
        let tracked = self.tracked.map_or_else(String::new, |tracked| format!(", tracked {}", grouped(tracked)));
        format!("{}{tracked}", grouped(self.points))
    }
}

/// What was found of objects.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Objects {
    /// Frames that were looked at.
    pub frames: usize,
    /// Detections, counted in each frame.
    pub detections: usize,
    /// Objects that were believed in, each counted once.
    pub objects: usize,
    /// What their ways tell, where these were looked at.
    #[serde(flatten)]
    pub ways: Option<Ways>,
    /// How good the tracks are, where the true ones are known.
    #[serde(flatten)]
    pub scores: Option<TrackScores>,
}

/// What the ways of objects tell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ways {
    /// How often one went over the line to its right.
    pub crossed_right: usize,
    /// The same to its left.
    pub crossed_left: usize,
    /// Objects that were in the zone.
    pub in_zone: usize,
    /// Frames that they were there on average.
    pub dwell_frames: Option<f64>,
    /// Objects that went where the others do not.
    pub unusual: usize,
}

impl Ways {
    fn of(field: &ObjectField) -> Option<Self> {
        let all = &field.trajectories;
        let crossed = |to_right: bool| {
            all.iter().flat_map(|of| &of.crossings).filter(|crossing| crossing.is_forward == to_right).count()
        };
        let stays: Vec<usize> = all.iter().map(|of| of.dwell_frames()).filter(|frames| *frames > 0).collect();
        let is_unusual = |of: &&Arc<Trajectory>| of.sightings.iter().any(|seen| seen.unusual.is_some());
        (!all.is_empty()).then(|| Self {
            crossed_right: crossed(true),
            crossed_left: crossed(false),
            in_zone: stays.len(),
            dwell_frames: (!stays.is_empty()).then(|| stays.iter().sum::<usize>() as f64 / stays.len() as f64),
            unusual: all.iter().filter(is_unusual).count(),
        })
    }

    /// The same for a person, as far as there is something.
    pub fn facts(&self) -> Vec<Fact> {
        let Self { crossed_right, crossed_left, in_zone, dwell_frames, unusual } = *self;
        let mut facts = Vec::new();
        if crossed_right + crossed_left > 0 {
            let value = format!("{} to its right, {} to its left", grouped(crossed_right), grouped(crossed_left));
            facts.push(Fact::new("Over line", value, None));
        }
        if let Some(frames) = dwell_frames {
            let objects = if in_zone == 1 { "object" } else { "objects" };
            facts.push(Fact::new("In zone", format!("{} {objects}, {frames:.1} frames each", grouped(in_zone)), None));
        }
        if unusual > 0 {
            facts.push(Fact::new("Unusual", format!("{} by direction", grouped(unusual)), None));
        }
        facts
    }
}

/// Tracks beside the true ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackScores {
    /// Multiple object tracking accuracy.
    pub mota: f64,
    /// Multiple object tracking precision, as mean intersection over union.
    pub motp: f64,
    /// F₁ of identities.
    pub idf1: f64,
    /// Higher order tracking accuracy.
    pub hota: f64,
    /// Changes of identity.
    pub switches: usize,
    /// Share of what was told that is true.
    pub precision: f64,
    /// Share of the true objects that were found.
    pub recall: f64,
    /// True objects, counted in each frame.
    pub true_objects: usize,
}

impl Objects {
    fn of(field: &ObjectField, truth: Option<&dyn Truth>) -> Result<Self, Error> {
        let confirmed = |frame: &Arc<ObjectFrame>| {
            let believed = frame.objects.iter().filter(|object| object.life == Life::Confirmed);
            believed.map(|object| object.id).collect::<Vec<_>>()
        };
        let ids: BTreeSet<u32> = field.frames.iter().flat_map(confirmed).collect();
        let scores = truth.map(|truth| score::scores(field, truth)).transpose()?.flatten();
        Ok(Self {
            frames: field.frames.len(),
            detections: field.frames.iter().map(|frame| frame.detections.len()).sum(),
            objects: ids.len(),
            ways: Ways::of(field),
            scores: scores.map(TrackScores::of),
        })
    }

    /// The same in words.
    pub fn text(&self) -> String {
        let [objects, detections, frames] = [self.objects, self.detections, self.frames].map(grouped);
        format!("{objects}, from {detections} detections in {frames} frames")
    }
}

impl TrackScores {
    fn of(scores: Scores) -> Self {
        let Scores { truths, switches, mota, motp, idf1, precision, recall, hota, .. } = scores;
        Self { mota, motp, idf1, hota, switches, precision, recall, true_objects: truths }
    }
}

/// Errors over the pixels whose true motion is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AgainstTruth {
    /// Mean endpoint error in px.
    pub epe_px: f64,
    /// Median endpoint error in px.
    pub epe_median_px: f64,
    /// The endpoint error in px that 95 % of the pixels do not exceed.
    pub epe_p95_px: f64,
    /// Share of the pixels whose endpoint error exceeds 0.5 px, as the Middlebury benchmark tells it.
    #[serde(rename = "r0.5")]
    pub r0_5: f64,
    /// The same for 1 px.
    #[serde(rename = "r1.0")]
    pub r1_0: f64,
    /// The same for 2 px.
    #[serde(rename = "r2.0")]
    pub r2_0: f64,
    /// Mean angular error in degrees.
    pub aae_deg: f64,
    /// Pixels compared: those whose motion is known and was found.
    pub known: usize,
    /// Their share of all whose motion is known, of fields.
    pub coverage: Option<f64>,
}

impl AgainstTruth {
    fn of(clip: &Clip, frame: usize, output: &Output) -> Result<Option<(Self, Distribution)>, Error> {
        let Some(truth) = clip.truth() else { return Ok(None) };
        let (flow, truth) = match output {
            Output::Objects(_) => return Ok(None),
            Output::Tracks(field) => displacements(field, &**truth)?,
            _ => match truth.flow(frame)? {
                Some(truth) => (output.flow(), truth),
                None => return Ok(None),
            },
        };
        let Some(error) = metrics::flow_error(&flow, &truth)? else { return Ok(None) };
        let distribution = metrics::distribution(&metrics::endpoint_errors(&flow, &truth)?, &error);
        let FlowError { epe_px, epe_median_px, epe_p95_px, beyond: [r0_5, r1_0, r2_0], aae_deg, known } = error;
        let all = truth.0.cells().iter().filter(|uv| uv.iter().all(|c| c.is_finite())).count();
        let is_field = matches!(output, Output::Blocks(_) | Output::Dense(_));
        let coverage = is_field.then(|| known as f64 / all.max(1) as f64);
        let against = Self { epe_px, epe_median_px, epe_p95_px, r0_5, r1_0, r2_0, aae_deg, known, coverage };
        Ok(Some((against, distribution)))
    }
}

/// What was found of all displacements of tracks whose truth is known, and that truth, in a row.
fn displacements(field: &TrackField, truth: &dyn Truth) -> Result<(Flow, Arc<Flow>), Error> {
    let mut both = Vec::new();
    for frame in field.frames() {
        let Some(truth) = truth.flow(frame)? else { continue };
        let known = field.at(frame).points.into_iter().filter_map(|point| {
            let [x, y] = point.at.map(|c| c.round() as usize);
            let place = truth.0.get(x, y).map(|_| (x, y))?;
            Some((point.displacement?, truth.at(place.0, place.1)?))
        });
        both.extend(known);
    }
    // A grid has at least one cell.
    both.push((Flow::UNKNOWN, Flow::UNKNOWN));
    let [found, known] =
        [0, 1].map(|i| Flow(Grid::from_fn(both.len(), 1, |x, _| if i == 0 { both[x].0 } else { both[x].1 })));
    Ok((found, Arc::new(known)))
}

impl Prediction {
    fn of(output: &Output, frame: &Gray, picture: &Gray) -> Result<Self, Error> {
        let psnr = metrics::psnr_db(picture, frame)?;
        let Coding { frame_bits, residual_bits, vector_bits } = Coding::of(output, frame, picture)?;
        Ok(Self { psnr_db: psnr.is_finite().then_some(psnr), frame_bits, residual_bits, vector_bits })
    }

    /// How near it comes, in words.
    pub fn psnr(&self) -> String {
        self.psnr_db.map_or("perfect".into(), |psnr| format!("{psnr:.2} dB PSNR"))
    }

    /// What motion saves, in words: `8.1 + 0.4 kB instead of 40.2`; without the vectors where nobody would send them.
    pub fn coding(&self) -> String {
        let kilobytes = |bits: f64| format!("{:.1}", bits / 8000.0);
        let vectors = self.vector_bits.map_or_else(String::new, |bits| format!(" + {}", kilobytes(bits)));
        format!("{}{vectors} kB instead of {}", kilobytes(self.residual_bits), kilobytes(self.frame_bits))
    }
}

impl Quality {
    /// The quality of `output` for frame `frame` of `clip`.
    ///
    /// A truth that cannot be read is told in [`Quality::truth_error`]; all else is known without it.
    ///
    /// # Errors
    /// If a frame cannot be read.
    pub fn of(clip: &Clip, frame: usize, output: &Output) -> Result<Self, Error> {
        let [current, next] = clip.pair_or_last(frame)?;
        let objects = output.objects().map(|field| Objects::of(field, clip.truth().map(|truth| &**truth)));
        let prediction = output.prediction(next.luma());
        let prediction = prediction.map(|picture| Prediction::of(output, current.luma(), &picture)).transpose()?;
        let (against, truth_error) = match AgainstTruth::of(clip, frame, output) {
            Ok(against) => (against, None),
            Err(error) => (None, Some(error)),
        };
        let (truth, errors) = against.unzip();
        Ok(Self {
            candidates: output.blocks().map(BlockField::candidates),
            prediction,
            features: output.points().map(Features::of).or(output.tracks().map(Features::of_tracks)),
            objects: objects.transpose()?,
            truth,
            errors,
            truth_error,
        })
    }

    /// The same for a person.
    pub fn facts(&self) -> Vec<Fact> {
        let fact = |label, value| Fact { label, value, role: None };
        let mut facts = Vec::new();
        facts.extend(self.candidates.map(|count| fact("Candidates", grouped(count as usize))));
        facts.extend(self.features.map(|features| fact("Features", features.text())));
        if let Some(objects) = self.objects {
            facts.push(fact("Objects", objects.text()));
            facts.extend(objects.ways.iter().flat_map(Ways::facts));
            if let Some(TrackScores { mota, idf1, hota, switches, precision, recall, .. }) = objects.scores {
                facts.push(fact("MOTA", format!("{mota:.3}")));
                facts.push(fact("IDF1", format!("{idf1:.3}")));
                facts.push(fact("HOTA", format!("{hota:.3}")));
                facts.push(fact("Switches", grouped(switches)));
                facts.push(fact("Precision, recall", format!("{:.1} %, {:.1} %", 100.0 * precision, 100.0 * recall)));
            }
        }
        if let Some(prediction) = self.prediction {
            let sent = if prediction.vector_bits.is_some() { "Residual + vectors" } else { "Residual" };
            facts.extend([fact("Prediction", prediction.psnr()), fact(sent, prediction.coding())]);
        }
        if let Some(truth) = self.truth {
            facts.push(fact("Mean endpoint error", format!("{:.3} px", truth.epe_px)));
            // A few that are far off say little of single points.
            facts.extend(self.features.map(|_| fact("Median error", format!("{:.3} px", truth.epe_median_px))));
            facts.push(fact("Mean angular error", format!("{:.2}°", truth.aae_deg)));
            facts.push(fact(
                "Errors of",
                match (self.features, truth.coverage) {
                    (None, Some(coverage)) => {
                        format!("{} pixels, {:.0} % of those of known motion", grouped(truth.known), 100.0 * coverage)
                    }
                    _ => format!("{} displacements", grouped(truth.known)),
                },
            ));
        }
        if let Some(error) = &self.truth_error {
            facts.push(fact("Truth", error.to_string()));
        }
        facts
    }
}
