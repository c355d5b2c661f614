//! The course's table of sequential, logarithmic and hierarchical search: its statements as printed, each beside a measurement.

use motionscope_core::base::{Error, Stop};
use motionscope_core::course::compare::{BlockFigures, Disturbance, LIGHT, NOISE_SIGMA, disturbed, kept_in_pan};
use motionscope_core::course::estimator;
use motionscope_core::data::Flow;
use motionscope_core::products::{EPE, PSNR, metrics};
use motionscope_core::run::AnyEstimator;
use serde_json::{Value, json};

use crate::experiment::comparison::{ComparedEstimator, Conditions, Row, columns, markdown_table, run_on};
use crate::experiment::whole;

/// The three searches, in the order of the course's table.
const IDS: [&str; 3] = ["full-search", "quadrant-search", "hierarchical"];
/// The names by which the course calls them.
const NAMES: [&str; 3] = ["sequential", "logarithmic", "hierarchical"];
/// Search ranges in px over which candidates and time are compared: the default, and a large window.
const RANGES: [&str; 2] = ["16", "32"];
/// Side of a block in px, the default of all three.
const BLOCK: usize = 16;
/// The camera pan of the large-motion rows in px, and the search range used for it.
const PAN: (usize, &str) = (48, "64");
/// The camera pan of the small-motion row in px.
const SMALL_PAN_PX: usize = 2;
/// Frame rate that counts as real time, in Hz.
const REAL_TIME_HZ: f64 = 25.0;
/// Largest share of missed minima in % that counts as very accurate.
const HARDLY_PERCENT: f64 = 5.0;
/// Share of blocks found, in %, from which a search counts as accurate.
const ACCURATE_PERCENT: f64 = 90.0;
/// Mean endpoint error in px up to which a search counts as accurate.
const ACCURATE_PX: f64 = 1.0;
/// Share found, in %, below which no search counts as robust.
const HALF_PERCENT: f64 = 50.0;
/// Difference of two shares, in percentage points, from which they count as different.
const DIFFERENT_POINTS: f64 = 5.0;
/// Difference in dB from which two predictions count as different.
const DIFFERENT_DB: f64 = 0.1;
/// Ratio of two errors below which the first counts as smaller.
const DIFFERENT_ERROR: f64 = 0.95;
/// Ratio of candidates above which a search counts as inefficient.
const INEFFICIENT: f64 = 10.0;
/// Growth of time from the small to the large window above which a search counts as slow for large windows.
const EXPENSIVE: f64 = 1.5;

/// A statement of the course notes as printed.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The words of the notes. In its table the notes break them over several lines.
    pub quote: &'static str,
    /// The line of the notes on which the statement, or its row of the table, begins.
    pub line: usize,
    /// Whether the measurement confirms it on this clip; `None` where nothing measured here can tell.
    pub holds: Option<bool>,
}

/// How many of the statements of a row are confirmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All of them.
    Holds,
    /// Some, but not all.
    InPart,
    /// None.
    DoesNotHold,
    /// The measurements decide none of them: figures hardly differ, or there is nothing to measure.
    Undecided,
}

impl Verdict {
    /// The verdict as shown.
    pub fn text(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::InPart => "holds in part",
            Self::DoesNotHold => "does not hold",
            Self::Undecided => "undecided",
        }
    }
}

/// One row of the course's table.
pub struct CourseRow {
    /// The feature that is compared, with its unit.
    pub feature: String,
    /// The statements of the course on it.
    pub claims: Vec<Claim>,
    /// The measured values of the three searches.
    pub measured: [String; 3],
}

/// A statement, and whether it is confirmed, if that can be told.
fn claim(line: usize, quote: &'static str, holds: impl Into<Option<bool>>) -> Claim {
    Claim { quote, line, holds: holds.into() }
}

/// Whether a possibility ("can", "may") is confirmed. One clip without an instance does not refute it.
fn possible(is_seen: bool) -> Option<bool> {
    is_seen.then_some(true)
}

/// Returns the three searches with the same settings.
fn three(set: &[(&str, &str)]) -> Result<[Box<dyn AnyEstimator>; 3], Error> {
    let one = |id: &str| {
        let mut search = estimator(id)?;
        set.iter().try_for_each(|(name, value)| search.set(name, value))?;
        Ok::<_, Error>(search)
    };
    let [a, b, c] = IDS.map(one);
    Ok([a?, b?, c?])
}

/// Applies `f` to each of three values, one after the other.
async fn each<A, B>(all: &[A; 3], f: impl AsyncFn(&A) -> Result<B, Error>) -> Result<[B; 3], Error> {
    let [a, b, c] = all;
    Ok([f(a).await?, f(b).await?, f(c).await?])
}

/// Measures the course's table in `conditions`, until `stop` cancels it.
///
/// # Errors
/// If one of them cannot run there.
pub async fn course_table(conditions: &Conditions<'_>, stop: &Stop) -> Result<Vec<CourseRow>, Error> {
    let rows = async |range| {
        each(&three(&[("search-range", range)])?, async |search| {
            stop.check()?;
            Row::of(&ComparedEstimator { estimator: search.boxed_clone(), swept: None }, conditions).await
        })
        .await
    };
    let (small, large) = (rows(RANGES[0]).await?, rows(RANGES[1]).await?);
    let mut table =
        vec![search_space(&small), complexity(&small, &large), speed(&small), large_windows(&small, &large)];
    table.extend(accuracy(&small));
    table.extend(large_motion(conditions, stop).await?);
    table.push(small_motion(conditions, stop).await?);
    table.push(memory(&small));
    table.push(real_time(&small, conditions)?);
    for disturbance in [Disturbance::Noise, Disturbance::Light] {
        table.push(robustness(&small, disturbance, conditions, stop).await?);
    }
    table.push(applications());
    Ok(table)
}

fn shown(values: [f64; 3], digits: usize) -> [String; 3] {
    values.map(|value| if value.is_nan() { "unknown".into() } else { format!("{value:.digits$}") })
}

fn milliseconds(rows: &[Row; 3]) -> [f64; 3] {
    rows.each_ref().map(|row| row.time.as_secs_f64() * 1e3)
}

/// A figure of the blocks of each search; each of them is a block search.
fn of_blocks(rows: &[Row; 3], figure: impl Fn(&BlockFigures) -> f64) -> [f64; 3] {
    rows.each_ref().map(|row| row.figures.blocks.as_ref().map_or(f64::NAN, &figure))
}

fn search_space(rows: &[Row; 3]) -> CourseRow {
    let candidates = of_blocks(rows, |blocks| blocks.candidates_mean);
    let [sequential, logarithmic, hierarchical] = candidates;
    CourseRow {
        feature: format!("search space: candidates per block, search range ±{} px", RANGES[0]),
        claims: vec![
            claim(880, "No reduction in search space.", sequential >= logarithmic.max(hierarchical)),
            claim(
                878,
                "Reduces the search space logarithmically by dividing it into smaller regions.",
                logarithmic < sequential,
            ),
            claim(
                875,
                "Reduces the search complexity by using progressively smaller search windows at higher resolutions.",
                hierarchical < sequential,
            ),
        ],
        measured: shown(candidates, 1),
    }
}

/// The growth of the largest number of candidates per block with the search range.
fn complexity(small: &[Row; 3], large: &[Row; 3]) -> CourseRow {
    let [before, after] = [small, large].map(|rows| of_blocks(rows, |blocks| blocks.candidates_most.into()));
    // A window twice as wide and high has four times the candidates; halving it takes a round more, of 8 new points at most.
    let is_quadratic = after[0] > 3.0 * before[0];
    let is_logarithmic = after[1] <= before[1] + 8.0;
    CourseRow {
        feature: format!(
            "complexity: growth factor of the largest number of candidates from ±{} to ±{} px",
            RANGES[0], RANGES[1]
        ),
        claims: vec![
            claim(910, "High, O(N^2) for a search window of size N×N", is_quadratic),
            claim(910, "Lower than sequential search, O(log N) for halving search space.", is_logarithmic),
            claim(
                907,
                "More complex due to pyramid construction, but efficient for large images or significant motions.",
                after[2] > after[1] && after[2] < after[0],
            ),
        ],
        measured: shown([0, 1, 2].map(|i| after[i] / before[i].max(1.0)), 2),
    }
}

fn speed(rows: &[Row; 3]) -> CourseRow {
    let ms = milliseconds(rows);
    CourseRow {
        feature: format!("speed: time per frame in ms, search range ±{} px", RANGES[0]),
        claims: vec![
            claim(890, "Faster than sequential search due to reduced search space.", ms[1] < ms[0]),
            claim(980, "requires more memory and computation due to the pyramid construction", ms[2] > ms[0]),
            claim(
                887,
                "Efficient for large motions and high-resolution images, but slower than logarithmic search due to multiple passes.",
                ms[2] > ms[1],
            ),
        ],
        measured: shown(ms, 2),
    }
}

fn large_windows(small: &[Row; 3], large: &[Row; 3]) -> CourseRow {
    let [before, after] = [small, large].map(milliseconds);
    let is_expensive = |i: usize| after[i] > EXPENSIVE * before[i];
    CourseRow {
        feature: format!("large windows: time per frame in ms, search range ±{} → ±{} px", RANGES[0], RANGES[1]),
        claims: vec![
            claim(891, "Slow, especially for large windows.", is_expensive(0)),
            claim(650, "Still Computationally Expensive for Large Search Windows", is_expensive(1)),
        ],
        measured: [0, 1, 2].map(|i| format!("{:.2} → {:.2}", before[i], after[i])),
    }
}

/// The rows on accuracy: missed minima, the prediction, and the true motion where it is known.
fn accuracy(rows: &[Row; 3]) -> Vec<CourseRow> {
    let missed = of_blocks(rows, |blocks| blocks.missed_share().map_or(f64::NAN, |share| 100.0 * share));
    let errors = rows.each_ref().map(|row| row.assessment.value(&EPE));
    let is_accurate = |i: usize| errors[i].map(|error| error <= ACCURATE_PX);
    let avoids_minima = missed[2] <= HARDLY_PERCENT && missed[2] <= missed[1];
    // Without any error it is infinite.
    let db = rows.each_ref().map(|row| row.assessment.value(&PSNR).unwrap_or(f64::INFINITY));
    let more_accurate = |holds: Option<bool>| {
        vec![
            claim(693, "reduces computational complexity while improving accuracy", holds),
            claim(980, "It is more accurate and robust", holds),
        ]
    };
    let mut all = vec![
        CourseRow {
            feature: "accuracy: blocks in % with a missed global minimum".into(),
            claims: vec![
                claim(900, "High accuracy, but computationally expensive.", is_accurate(0)),
                claim(
                    897,
                    "Can miss the global minimum due to narrowing down search space.",
                    possible(missed[1] > 0.0),
                ),
                claim(
                    897,
                    "Very accurate, avoids local minima by refining estimates across resolutions.",
                    avoids_minima && is_accurate(2) != Some(false),
                ),
            ],
            measured: shown(missed, 1),
        },
        CourseRow {
            feature: "accuracy: PSNR of the prediction in dB".into(),
            claims: more_accurate(((db[2] - db[0]).abs() > DIFFERENT_DB).then_some(db[2] > db[0])),
            measured: db.map(|db| if db.is_finite() { format!("{db:.2}") } else { "perfect".into() }),
        },
    ];
    if let [Some(sequential), Some(logarithmic), Some(hierarchical)] = errors {
        all.push(CourseRow {
            feature: "accuracy: mean endpoint error in px against the true motion".into(),
            claims: more_accurate(match hierarchical < sequential {
                // Neither is more accurate where they hardly differ.
                true => possible(hierarchical < DIFFERENT_ERROR * sequential),
                false => (sequential < DIFFERENT_ERROR * hierarchical).then_some(false),
            }),
            measured: shown([sequential, logarithmic, hierarchical], 3),
        });
    }
    all
}

/// The share of blocks found under a long camera pan, and the candidates needed.
async fn large_motion(conditions: &Conditions<'_>, stop: &Stop) -> Result<[CourseRow; 2], Error> {
    let (clip, frame) = (conditions.clip, conditions.frame);
    let (width, height) = clip.pair(frame)?[0].size();
    let pan_px = PAN.0.min(width / 4);
    let mut searches = three(&[("search-range", PAN.1)])?;
    // As many levels as leave a block of what the pan leaves, four at most.
    let levels = (2..4).take_while(|level| (width - pan_px).min(height) >> level >= BLOCK).count() + 2;
    searches[2].set("levels", &levels.to_string())?;
    let found = each(&searches, async |search| {
        stop.check()?;
        kept_in_pan(&**search, (clip, frame), pan_px, &run_on(conditions.threads)).await
    })
    .await?;
    let shares = found.map(|(share, _)| 100.0 * share);
    let candidates = found.map(|(_, candidates)| candidates);
    let under = format!("under a camera pan of {pan_px} px; search range ±{} px, {levels} levels", PAN.1);
    Ok([
        CourseRow {
            feature: format!("large motion: blocks in % found {under}"),
            claims: vec![
                claim(
                    631,
                    "can handle larger motions better than sequential search",
                    shares[1] > shares[0] + DIFFERENT_POINTS,
                ),
                claim(
                    917,
                    "Better than sequential search but still struggles with large motions.",
                    shares[1] > shares[0] + DIFFERENT_POINTS && shares[1] < ACCURATE_PERCENT,
                ),
                claim(
                    920,
                    "Excellent at handling large displacements by starting from coarse estimates.",
                    // Blocks that look like others are found by no search: full search is the measure.
                    shares[2] >= HALF_PERCENT && shares[2] >= shares[0] - DIFFERENT_POINTS,
                ),
            ],
            measured: shown(shares, 1),
        },
        CourseRow {
            feature: format!("large motion: candidates per block {under}"),
            claims: vec![claim(
                921,
                "Less efficient for large displacements.",
                candidates[0] > INEFFICIENT * candidates[2],
            )],
            measured: shown(candidates, 0),
        },
    ])
}

/// The share of blocks found under a short camera pan, and the candidates needed.
async fn small_motion(conditions: &Conditions<'_>, stop: &Stop) -> Result<CourseRow, Error> {
    let found = each(&three(&[])?, async |search| {
        stop.check()?;
        let pair = (conditions.clip, conditions.frame);
        kept_in_pan(&**search, pair, SMALL_PAN_PX, &run_on(conditions.threads)).await
    })
    .await?;
    let [(sequential, _), (_, logarithmic), (_, hierarchical)] = found;
    Ok(CourseRow {
        feature: format!(
            "small motion: blocks in % found under a camera pan of {SMALL_PAN_PX} px, and candidates per block"
        ),
        claims: vec![
            claim(
                487,
                "When motion between consecutive frames is small, this method works well and provides accurate motion vector estimates.",
                100.0 * sequential >= ACCURATE_PERCENT,
            ),
            claim(
                805,
                "it can be less efficient for cases where the motion between consecutive frames is small",
                possible(hierarchical > logarithmic),
            ),
        ],
        measured: found.map(|(share, candidates)| format!("{:.1} % with {candidates:.0}", 100.0 * share)),
    })
}

fn memory(rows: &[Row; 3]) -> CourseRow {
    let kilobytes = rows.each_ref().map(|row| row.figures.memory_bytes as f64 / 1e3);
    let is_low = |i: usize| kilobytes[i] < kilobytes[2];
    CourseRow {
        feature: "memory: kB without the frames".into(),
        claims: vec![
            claim(927, "Low memory usage, only requires storing the current frame and search window.", is_low(0)),
            claim(927, "Low memory usage, works on the current frame and search window.", is_low(1)),
            claim(
                927,
                "Higher memory usage due to the image pyramid and multiple resolution levels.",
                is_low(0) && is_low(1),
            ),
        ],
        measured: shown(kilobytes, 1),
    }
}

fn real_time(rows: &[Row; 3], conditions: &Conditions<'_>) -> Result<CourseRow, Error> {
    let hertz = milliseconds(rows).map(|ms| 1e3 / ms);
    let (width, height) = conditions.clip.pair(conditions.frame)?[0].size();
    Ok(CourseRow {
        feature: format!(
            "real time: frames per second at {width}×{height} px, search range ±{} px, {REAL_TIME_HZ:.0} wanted",
            RANGES[0]
        ),
        claims: vec![
            claim(940, "Not ideal for real-time processing due to high computational cost.", hertz[0] < REAL_TIME_HZ),
            claim(
                937,
                "Can be suitable for real-time processing with small search windows.",
                possible(hertz[1] >= REAL_TIME_HZ),
            ),
            claim(
                937,
                "Suitable for high-resolution, large motion estimation but may not be real-time due to pyramid construction.",
                possible(hertz[2] < REAL_TIME_HZ),
            ),
        ],
        measured: shown(hertz, 0),
    })
}

/// How the searches bear a disturbance: by the true motion where it is known, else by the displacements that stay.
async fn robustness(
    rows: &[Row; 3],
    disturbance: Disturbance,
    conditions: &Conditions<'_>,
    stop: &Stop,
) -> Result<CourseRow, Error> {
    let Conditions { clip, frame, threads, .. } = *conditions;
    let truth = match clip.truth() {
        Some(truth) => truth.flow(frame)?,
        None => None,
    };
    let right = |flow: Option<Flow>, truth: &Flow| -> Result<f64, Error> {
        let error = flow.map(|flow| metrics::flow_error(&flow, truth)).transpose()?.flatten();
        Ok(error.map_or(f64::NAN, |error| 100.0 * (1.0 - error.beyond[1])))
    };
    let (name, condition) = match disturbance {
        Disturbance::Noise => ("noise", format!("Gaussian noise of σ = {NOISE_SIGMA} gray levels")),
        Disturbance::Light => ("light", format!("a change of I to {} I + {} in frame t + 1", LIGHT.0, LIGHT.1)),
    };
    let has_truth = truth.is_some();
    let (what, calm, shaken) = match truth {
        Some(truth) => {
            let shares = each(&three(&[])?, async |search| {
                stop.check()?;
                let (calm, _) = whole::output(&**search, (clip, frame), threads).await?;
                let disturbed = disturbed(clip, frame, disturbance)?;
                let (shaken, _) = whole::output(&**search, (&disturbed, 0), threads).await?;
                Ok([right(calm.flow(), &truth)?, right(shaken.flow(), &truth)?])
            })
            .await?;
            let what = format!("pixels in % within 1 px of the true motion, without → with {condition}");
            (what, shares.map(|[calm, _]| calm), shares.map(|[_, shaken]| shaken))
        }
        None => {
            let kept = rows.each_ref().map(|row| match disturbance {
                Disturbance::Noise => row.figures.kept_in_noise,
                Disturbance::Light => row.figures.kept_in_light,
            });
            let what = format!("blocks in % with a displacement that changes by at most 1 px under {condition}");
            (what, [100.0; 3], kept.map(|share| share.map_or(f64::NAN, |share| 100.0 * share)))
        }
    };
    let [before, after] = [calm, shaken].map(|shares| shown(shares, 1));
    Ok(CourseRow {
        feature: format!("{name}: {what}"),
        claims: robustness_claims(calm, shaken),
        measured: [0, 1, 2].map(|i| if has_truth { format!("{} → {}", before[i], after[i]) } else { after[i].clone() }),
    })
}

/// The statements on robustness, by the shares in % that are right without and with the disturbance.
fn robustness_claims(calm: [f64; 3], shaken: [f64; 3]) -> Vec<Claim> {
    let known = |holds: Option<bool>| holds.filter(|_| calm.iter().chain(&shaken).all(|share| !share.is_nan()));
    let is_sensitive = |i: usize| calm[i] - shaken[i] > DIFFERENT_POINTS;
    // A search that finds next to nothing has nothing to lose.
    let is_robust = shaken[2] >= HALF_PERCENT && !is_sensitive(2);
    vec![
        claim(
            947,
            "Sensitive to noise and illumination changes due to exhaustive search.",
            known(Some(is_sensitive(0))),
        ),
        claim(
            947,
            "Can be more robust than sequential search, but still sensitive to large differences.",
            known(possible(shaken[1] > shaken[0] + DIFFERENT_POINTS && is_sensitive(1))),
        ),
        claim(
            947,
            "Robust to noise and illumination changes due to the multi-resolution approach.",
            known(Some(is_robust)),
        ),
    ]
}

/// Typical applications are a judgement, not a measurement.
fn applications() -> CourseRow {
    let said = |quote| Claim { quote, line: 957, holds: None };
    CourseRow {
        feature: "typical applications".into(),
        claims: vec![
            said("Simple motion estimation, video analysis with small motions."),
            said("Video compression, real-time object tracking with moderate motions."),
            said(
                "Video compression, object tracking, optical flow estimation, 3D reconstruction in high-resolution scenarios.",
            ),
        ],
        measured: ["small motions", "moderate motions", "large motions"].map(str::to_owned),
    }
}

impl CourseRow {
    /// Returns how many of the statements hold.
    pub fn verdict(&self) -> Verdict {
        let judged: Vec<bool> = self.claims.iter().filter_map(|claim| claim.holds).collect();
        match judged.iter().filter(|holds| **holds).count() {
            _ if judged.is_empty() => Verdict::Undecided,
            0 => Verdict::DoesNotHold,
            all if all == judged.len() => Verdict::Holds,
            _ => Verdict::InPart,
        }
    }
}

impl Claim {
    /// The statement as printed, with its line.
    pub fn quoted(&self) -> String {
        format!("“{}” (line {})", self.quote, self.line)
    }
}

/// Returns the headings and cells of the table.
fn cells(course_table: &[CourseRow]) -> Vec<Vec<String>> {
    let heading =
        ["measured"].iter().chain(&NAMES).chain(&["the course's statements"]).map(|&name| name.to_owned()).collect();
    let line = |row: &CourseRow| {
        let mut line = vec![row.feature.clone()];
        line.extend(row.measured.iter().cloned());
        line.push(row.verdict().text().to_owned());
        line
    };
    std::iter::once(heading).chain(course_table.iter().map(line)).collect()
}

/// Returns the table as text, followed by the statements of the course that do not hold.
pub fn text(course_table: &[CourseRow]) -> String {
    let refuted = |row: &CourseRow| {
        let claims = row.claims.iter().filter(|claim| claim.holds == Some(false));
        claims.map(|claim| format!("{}. Not so: {}.\n", row.feature, claim.quoted())).collect::<String>()
    };
    let fails: String = course_table.iter().map(refuted).collect();
    format!("{}\n{fails}\n{}", columns(&cells(course_table)), key())
}

/// Returns the course, and the estimators that its names stand for.
pub fn named() -> String {
    let name = |id: &str| estimator(id).map_or_else(|_| id.to_owned(), |found| found.info().name.to_lowercase());
    let [sequential, logarithmic, hierarchical] = IDS.map(name);
    format!(
        "Course: computer vision, unit VI, motion analysis. Its sequential search is {sequential}; logarithmic: {logarithmic}; \
         hierarchical: {hierarchical}."
    )
}

/// Returns the conditions under which the table was measured.
pub fn key() -> String {
    format!(
        "{} Default parameters except where stated. The noise is added to both frames. Shares differ from \
         {DIFFERENT_POINTS:.0} points on, errors from {:.0} %, predictions from {DIFFERENT_DB} dB.\n",
        named(),
        100.0 * (1.0 - DIFFERENT_ERROR)
    )
}

/// Returns the table as Markdown, with the statements of the course.
pub fn markdown(course_table: &[CourseRow]) -> String {
    let mut lines = cells(course_table);
    let quotes = |row: &CourseRow| row.claims.iter().map(Claim::quoted).collect::<Vec<_>>().join("; ");
    let statements = std::iter::once("the statements".to_owned()).chain(course_table.iter().map(quotes));
    for (line, said) in lines.iter_mut().zip(statements) {
        line.push(said);
    }
    markdown_table(&lines)
}

/// Returns the table as JSON: one object per row.
pub fn json(course_table: &[CourseRow]) -> Value {
    let claim = |claim: &Claim| json!({ "quote": claim.quote, "line": claim.line, "holds": claim.holds });
    let object = |row: &CourseRow| {
        let [sequential, logarithmic, hierarchical] = &row.measured;
        json!({
            "feature": row.feature, "sequential": sequential, "logarithmic": logarithmic, "hierarchical": hierarchical,
            "verdict": row.verdict().text(), "claims": row.claims.iter().map(claim).collect::<Vec<_>>(),
        })
    };
    course_table.iter().map(object).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdicts(calm: [f64; 3], shaken: [f64; 3]) -> Vec<Option<bool>> {
        robustness_claims(calm, shaken).iter().map(|claim| claim.holds).collect()
    }

    #[test]
    fn a_point_is_no_difference_and_half_of_the_vectors_lost_is_not_robust() {
        let [yes, no, not_seen] = [Some(true), Some(false), None];
        assert_eq!(verdicts([100.0; 3], [30.8, 31.8, 50.8]), [yes, not_seen, no]);
        assert_eq!(verdicts([100.0; 3], [6.0, 8.7, 11.3]), [yes, not_seen, no]);
        assert_eq!(verdicts([98.0, 90.0, 97.0], [60.0, 75.0, 96.0]), [yes, yes, yes]);
        // A search that finds next to nothing cannot lose it, which does not make it robust.
        assert_eq!(verdicts([98.0, 40.0, 10.0], [90.0, 38.0, 8.0]), [yes, not_seen, no]);
        // As many are right with noise as without it, although these are few.
        assert_eq!(verdicts([98.0, 40.0, 97.0], [96.0, 38.0, 96.0]), [no, not_seen, yes]);
        assert_eq!(verdicts([98.0, f64::NAN, 97.0], [90.0, 38.0, 96.0]), [None; 3], "unknown is not 0");
    }

    #[test]
    fn the_verdict_counts_statements() {
        let row = |holds: &[Option<bool>]| CourseRow {
            feature: String::new(),
            claims: holds.iter().map(|&holds| Claim { quote: "", line: 1, holds }).collect(),
            measured: [const { String::new() }; 3],
        };
        let verdict = |holds: &[Option<bool>]| row(holds).verdict();
        assert_eq!(verdict(&[Some(true), Some(true)]), Verdict::Holds);
        assert_eq!(verdict(&[Some(true), Some(false), None]), Verdict::InPart);
        assert_eq!(verdict(&[Some(false)]), Verdict::DoesNotHold);
        assert_eq!(verdict(&[None]), Verdict::Undecided);
    }
}
