//! The course's table of sequential, logarithmic and hierarchical search, measured cell by cell.

use motionscope_core::compare::{LIGHT, NOISE_SIGMA, kept_in_pan};
use motionscope_core::products::PSNR;
use motionscope_core::{AnyEstimator, BlockField, Error, Stop, estimator};
use serde_json::{Value, json};

use crate::experiment::comparison::{ComparedEstimator, Conditions, Row, columns, markdown_table};

/// The three searches, in the order of the course's table.
const IDS: [&str; 3] = ["full-search", "quadrant-search", "hierarchical"];
/// The names by which the course calls them.
const NAMES: [&str; 3] = ["sequential", "logarithmic", "hierarchical"];
/// Search ranges in px over which the growth of the candidates is measured.
const RANGES: [&str; 2] = ["16", "32"];
/// Side of a block in px, the default of all three.
const BLOCK: usize = 16;
/// The camera pan of the large-motion row in px, and the search range used for it.
const PAN: (usize, &str) = (48, "64");
/// Frame rate that counts as real time, in Hz.
const REAL_TIME_HZ: f64 = 25.0;
/// Largest share of missed minima in % that counts as very accurate.
const HARDLY_PERCENT: f64 = 5.0;
/// Ratio of candidates above which a search counts as inefficient.
const INEFFICIENT: f64 = 10.0;

/// One row of the course's table.
pub struct CourseRow {
    /// The feature that is compared, with its unit.
    pub feature: String,
    /// The statement of the course.
    pub said: &'static str,
    /// The measured values of the three searches.
    pub measured: [String; 3],
    /// Whether the measurement confirms the statement on this clip.
    pub holds: bool,
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

/// Applies `f` to each of three values.
fn each<A, B>(all: &[A; 3], f: impl Fn(&A) -> Result<B, Error>) -> Result<[B; 3], Error> {
    let [a, b, c] = all.each_ref().map(f);
    Ok([a?, b?, c?])
}

/// Measures the course's table in `conditions`, until `stop` cancels it.
///
/// # Errors
/// If one of them cannot run there.
pub fn course_table(conditions: &Conditions<'_>, stop: &Stop) -> Result<Vec<CourseRow>, Error> {
    let rows = each(&three(&[])?, |search| {
        stop.check()?;
        Row::of(&ComparedEstimator { estimator: search.boxed_clone(), swept: None }, conditions)
    })?;
    let mut course_table = of_one_window(&rows);
    course_table.insert(1, growth(conditions, stop)?);
    course_table.splice(5..5, large_motion(conditions, stop)?);
    Ok(course_table)
}

/// Returns the rows that need one run of each search.
fn of_one_window(rows: &[Row; 3]) -> Vec<CourseRow> {
    let all = |of: &dyn Fn(&Row) -> f64| rows.each_ref().map(of);
    let shown = |values: [f64; 3], digits: usize| values.map(|value| format!("{value:.digits$}"));
    // Each of them is a block search.
    let blocks = |row: &Row| row.figures.blocks.clone();
    let candidates = all(&|row| blocks(row).map_or(0.0, |blocks| blocks.candidates_mean));
    let ms = all(&|row| row.time.as_secs_f64() * 1e3);
    let missed = all(&|row| 100.0 * blocks(row).and_then(|blocks| blocks.missed_share()).unwrap_or(0.0));
    // Without any error it is infinite.
    let db = all(&|row| row.assessment.value(&PSNR).unwrap_or(f64::INFINITY));
    let kilobytes = all(&|row| row.figures.memory_bytes as f64 / 1e3);
    let percent = |share: Option<f64>| 100.0 * share.unwrap_or(0.0);
    let [noise, light] =
        [all(&|row| percent(row.figures.kept_in_noise)), all(&|row| percent(row.figures.kept_in_light))];
    let rising = |values: [f64; 3]| values[0] < values[1] && values[1] <= values[2];
    let hertz = ms.map(|ms| 1e3 / ms);
    vec![
        CourseRow {
            feature: "search space: candidates per block, search range ±16 px".into(),
            said: "sequential search tests every candidate, the other two reduce the search space",
            holds: candidates[1] < candidates[0] && candidates[2] < candidates[0],
            measured: shown(candidates, 1),
        },
        CourseRow {
            feature: "speed: time per frame in ms".into(),
            said: "sequential search is slow, logarithmic search fastest, hierarchical search between them",
            holds: ms[1] < ms[2] && ms[2] < ms[0],
            measured: shown(ms, 2),
        },
        CourseRow {
            feature: "accuracy: blocks in % with a missed global minimum".into(),
            said: "sequential search misses none, logarithmic search may, hierarchical search hardly does",
            holds: missed[0] == 0.0 && missed[2] <= missed[1] && missed[2] <= HARDLY_PERCENT,
            measured: shown(missed, 1),
        },
        CourseRow {
            feature: "accuracy: PSNR of the prediction in dB".into(),
            said: "sequential search predicts best",
            holds: db[0] >= db[1] && db[0] >= db[2],
            measured: db.map(|db| if db.is_finite() { format!("{db:.2}") } else { "perfect".into() }),
        },
        CourseRow {
            feature: "memory: kB without the frames".into(),
            said: "little for sequential and logarithmic search, more for the pyramid",
            holds: kilobytes[2] > kilobytes[0] && kilobytes[2] > kilobytes[1],
            measured: shown(kilobytes, 1),
        },
        CourseRow {
            feature: format!(
                "noise: blocks in % with a displacement that changes by at most 1 px under Gaussian noise of σ = {NOISE_SIGMA} gray levels"
            ),
            said: "sequential search is sensitive, logarithmic search less so, hierarchical search robust",
            holds: rising(noise),
            measured: shown(noise, 1),
        },
        CourseRow {
            feature: format!(
                "light: blocks in % with a displacement that changes by at most 1 px when I becomes {} I + {} in frame t + 1",
                LIGHT.0, LIGHT.1
            ),
            said: "sequential search is sensitive, logarithmic search less so, hierarchical search robust",
            holds: rising(light),
            measured: shown(light, 1),
        },
        CourseRow {
            feature: "real time: frames per second".into(),
            said: "sequential search: no; logarithmic search: yes; hierarchical search: perhaps not",
            holds: hertz[0] < REAL_TIME_HZ && hertz[1] >= REAL_TIME_HZ,
            measured: shown(hertz, 0),
        },
    ]
}

/// Measures how the largest number of candidates per block grows with the search range.
fn growth(conditions: &Conditions<'_>, stop: &Stop) -> Result<CourseRow, Error> {
    let most = |search: &dyn AnyEstimator| {
        stop.check()?;
        let output = search.run(conditions.clip, conditions.frame, conditions.threads)?;
        let vectors = output.get::<BlockField>().map(|field| field.vectors.as_slice()).unwrap_or_default();
        Ok::<_, Error>(vectors.iter().flatten().map(|vector| vector.candidates).max().unwrap_or(0))
    };
    let mut counts = [[0; 2]; 3];
    for (i, range) in RANGES.iter().enumerate() {
        for (search, counts) in three(&[("search-range", range)])?.iter().zip(&mut counts) {
            counts[i] = most(&**search)?;
        }
    }
    let [sequential, logarithmic, hierarchical] = counts.map(|[before, after]| (before, after));
    // A window twice as wide and high has four times the candidates; halving it takes a round more, of 8 new points at most.
    let is_quadratic = sequential.1 > 3 * sequential.0;
    let is_logarithmic = logarithmic.1 <= logarithmic.0 + 8;
    let is_between = (logarithmic.1..=sequential.1).contains(&hierarchical.1);
    Ok(CourseRow {
        feature: "complexity: growth factor of the largest number of candidates from ±16 to ±32 px".into(),
        said: "O(N²) for sequential search, O(log N) for logarithmic search, between them for the pyramid",
        holds: is_quadratic && is_logarithmic && is_between,
        measured: counts.map(|[before, after]| format!("{:.2}", f64::from(after) / f64::from(before.max(1)))),
    })
}

/// Measures the share of blocks found under a long camera pan, and the candidates needed.
fn large_motion(conditions: &Conditions<'_>, stop: &Stop) -> Result<[CourseRow; 2], Error> {
    let (clip, frame) = (conditions.clip, conditions.frame);
    let (width, height) = clip.pair(frame)?[0].size();
    let pan_px = PAN.0.min(width / 4);
    let mut searches = three(&[("search-range", PAN.1)])?;
    // As many levels as leave a block of what the pan leaves, four at most.
    let levels = (2..4).take_while(|level| (width - pan_px).min(height) >> level >= BLOCK).count() + 2;
    searches[2].set("levels", &levels.to_string())?;
    let found = each(&searches, |search| {
        stop.check()?;
        kept_in_pan(&**search, (clip, frame), pan_px, conditions.threads)
    })?;
    let [(sequential, many), (logarithmic, _), (hierarchical, few)] = found;
    let under = format!("under a camera pan of {pan_px} px; search range ±{} px, {levels} levels", PAN.1);
    Ok([
        CourseRow {
            feature: format!("large motion: blocks in % found {under}"),
            said: "logarithmic search struggles, hierarchical search is excellent",
            holds: logarithmic < 0.9 * sequential && hierarchical > 0.9 * sequential,
            measured: found.map(|(share, _)| format!("{:.1}", 100.0 * share)),
        },
        CourseRow {
            feature: format!("large motion: candidates per block {under}"),
            said: "sequential search is inefficient",
            holds: many > INEFFICIENT * few,
            measured: found.map(|(_, candidates)| format!("{candidates:.0}")),
        },
    ])
}

impl CourseRow {
    /// Returns whether the statement holds, as shown.
    pub fn verdict(&self) -> &'static str {
        if self.holds { "holds" } else { "does not hold here" }
    }
}

/// Returns the headings and cells of the table.
fn cells(course_table: &[CourseRow]) -> Vec<Vec<String>> {
    let heading =
        ["measured"].iter().chain(&NAMES).chain(&["the course's statement"]).map(|&name| name.to_owned()).collect();
    let line = |row: &CourseRow| {
        let mut line = vec![row.feature.clone()];
        line.extend(row.measured.iter().cloned());
        line.push(row.verdict().to_owned());
        line
    };
    std::iter::once(heading).chain(course_table.iter().map(line)).collect()
}

/// Returns the table as text, followed by the statements of the course that do not hold.
pub fn text(course_table: &[CourseRow]) -> String {
    let fails: String = course_table
        .iter()
        .filter(|c| !c.holds)
        .map(|c| format!("{}. The course says: {}.\n", c.feature, c.said))
        .collect();
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
    format!("{} Default parameters except where stated. The noise is added to both frames.\n", named())
}

/// Returns the table as Markdown, with the statements of the course.
pub fn markdown(course_table: &[CourseRow]) -> String {
    let mut lines = cells(course_table);
    for (line, said) in
        lines.iter_mut().zip(std::iter::once("the statement").chain(course_table.iter().map(|c| c.said)))
    {
        line.push(said.to_owned());
    }
    markdown_table(&lines)
}

/// Returns the table as JSON: one object per row.
pub fn json(course_table: &[CourseRow]) -> Value {
    let object = |row: &CourseRow| {
        let [sequential, logarithmic, hierarchical] = &row.measured;
        json!({
            "feature": row.feature, "sequential": sequential, "logarithmic": logarithmic,
            "hierarchical": hierarchical, "course": row.said, "holds": row.holds,
        })
    };
    course_table.iter().map(object).collect()
}
