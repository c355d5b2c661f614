//! `motionscope compare`, by its program: the same numbers as single runs, in every format.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

const SMALL: &str = "synth:pillar,width=160,height=120,frames=3";

fn motionscope(line: &str) -> Output {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    command.current_dir(folder).args(line.split_whitespace()).output().expect("the program runs")
}

fn stdout(line: &str) -> String {
    let output = motionscope(line);
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn json(line: &str) -> Value {
    serde_json::from_str(&stdout(line)).expect("JSON")
}

#[test]
fn a_row_has_the_numbers_of_a_single_run() {
    let rows = json(&format!("compare {SMALL} --estimators full-search,diamond --set diamond.block-size=8 --json"));
    for (row, run) in [(0, "full-search"), (1, "diamond --set block-size=8")] {
        let (row, run) = (&rows[row], json(&format!("run {SMALL} --estimator {run} --json")));
        let mean = run["metrics"]["candidates"].as_f64().unwrap() / row["blocks"].as_f64().unwrap();
        assert_eq!(row["candidates_mean"], mean);
        assert_eq!(row["psnr_db"], run["metrics"]["psnr_db"]);
        assert_eq!(row["epe_px"], run["metrics"]["epe_px"]);
        assert!(row["ms"].as_f64().unwrap() > 0.0);
    }
    assert_eq!((&rows[0]["missed_percent"], rows[0]["blocks"].as_i64()), (&Value::from(0.0), Some(80)));
    assert_eq!(rows[1]["blocks"], 300);
    let missed = rows[1]["missed"].as_array().unwrap().len() as f64;
    assert_eq!(rows[1]["missed_percent"], 100.0 * missed / 300.0);
}

#[test]
fn a_comparison_is_told_in_a_sentence() {
    let line = format!("compare {SMALL} --estimators diamond,full-search");
    let rows = json(&format!("{line} --json"));
    assert!(rows[1].get("comparison").is_none(), "the exhaustive search is the reference: {rows}");
    assert_eq!(rows[0]["reference"], "full-search");
    let told = rows[0]["comparison"].as_str().unwrap();
    let shown = |row: usize, name: &str| rows[row][name].as_f64().unwrap();
    let ratio = ((10.0 * shown(1, "candidates_mean")).round() / (10.0 * shown(0, "candidates_mean")).round()).round();
    assert!(told.starts_with(&format!("{ratio} × fewer candidates, ")), "{told}: {rows}");
    let epe = |row| (1e3 * shown(row, "epe_px")).round();
    let word = match epe(0).total_cmp(&epe(1)) {
        std::cmp::Ordering::Less => "better",
        std::cmp::Ordering::Greater => "worse",
        std::cmp::Ordering::Equal => "the same EPE",
    };
    let quality = told.split(", ").nth(1).unwrap_or_default();
    assert!(quality.ends_with(word), "{told}: {rows}");
    let missed = rows[0]["missed_percent"].as_f64().unwrap();
    assert_eq!(told.ends_with(" % of the minima missed"), missed > 0.05, "{told}: {rows}");
    let sentence = format!("Diamond search compared with Full search: {told}.");
    assert!(stdout(&line).contains(&sentence) && stdout(&format!("{line} --markdown")).contains(&sentence));
    assert!(!stdout(&format!("compare {SMALL} --estimators diamond")).contains("compared with"), "with what?");
}

#[test]
fn a_sweep_runs_a_parameter_or_a_slider_through_its_values() {
    let candidates = |rows: &Value| -> Vec<f64> {
        rows.as_array().unwrap().iter().map(|row| row["candidates_most"].as_f64().unwrap()).collect()
    };
    let ranges =
        json(&format!("compare {SMALL} --estimators full-search,log-search --sweep search-range=4,8,16 --json"));
    assert_eq!(ranges[2]["search-range"], 8.0);
    let most = candidates(&ranges);
    // Quadratic against logarithmic: the notes' claim.
    assert_eq!([most[0], most[2], most[4]], [81.0, 289.0, 1089.0]);
    assert!(most[5] - most[3] <= 12.0, "{most:?}");

    // One estimator's own parameter leaves the others as they are.
    let one =
        json(&format!("compare {SMALL} --estimators full-search,diamond --sweep diamond.search-range=4,16 --json"));
    let most = candidates(&one);
    assert!(most[0] == 1089.0 && most[2] == 1089.0 && one[3]["diamond.search-range"] == 16.0, "{one}");
    let wrong = motionscope(&format!("compare {SMALL} --estimators full-search --sweep diamond.search-range=4,16"));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("diamond is not compared"));

    let noise = json(&format!("compare {SMALL} --estimators full-search --sweep noise=0,30 --json"));
    let psnr = |i: usize| noise[i]["psnr_db"].as_f64().unwrap();
    assert!(psnr(1) < psnr(0) - 5.0);
}

#[test]
fn a_sweep_is_plotted_in_a_file() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let line = format!("compare {SMALL} --estimators full-search,diamond --sweep search-range=4,8,16,32");
    for name in ["sweep.svg", "sweep.png"] {
        stdout(&format!("{line} --plot {name}"));
    }
    let svg = std::fs::read_to_string(folder.join("sweep.svg")).unwrap();
    // The true motion of the scene is known, so the error is plotted, over the parameter, for each estimator.
    for words in ["EPE px", "Search range", "Full search", "Diamond search"] {
        assert!(svg.to_lowercase().contains(&words.to_lowercase()), "{words}: {svg}");
    }
    assert!(std::fs::read(folder.join("sweep.png")).unwrap().starts_with(b"\x89PNG"));
    stdout(&format!("{line} --plot sweep.svg --column candidates_mean"));
    assert!(std::fs::read_to_string(folder.join("sweep.svg")).unwrap().contains("candidates"));
    for (rest, told) in [
        ("--plot sweep.txt", ".svg"),
        ("--plot sweep.svg --column speed", "no column speed"),
        ("--column ms", "--plot"),
    ] {
        let output = motionscope(&format!("{line} {rest}"));
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && error.contains(told), "{rest}: {error}");
    }
}

#[test]
fn every_format_has_the_same_cells() {
    let line = format!("compare {SMALL} --estimators three-step,hexagon --sweep block-size=8,16");
    let text = stdout(&line);
    let markdown = stdout(&format!("{line} --markdown"));
    let csv = stdout(&format!("{line} --csv -"));
    // Times differ from run to run; the rest does not.
    let without_time = |cells: Vec<String>| -> Vec<String> {
        cells.into_iter().enumerate().filter(|(i, _)| *i != 4).map(|(_, cell)| cell).collect()
    };
    let words = |line: &str| without_time(line.split(' ').filter(|cell| !cell.is_empty()).map(str::to_owned).collect());
    let cells = |line: &str| without_time(line.trim_matches('|').split('|').map(|cell| cell.trim().into()).collect());
    for (text, markdown) in text.lines().zip(markdown.lines().filter(|line| !line.contains("---"))).skip(1).take(4) {
        assert_eq!(words(text), cells(markdown));
    }
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].starts_with("estimator,block_size,candidates_mean,candidates_most,ms,"));
    let columns = lines[0].split(',').count();
    assert!(lines.len() == 5 && lines.iter().all(|line| line.split(',').count() == columns), "{columns} columns");
    assert!(lines[4].starts_with("hexagon,16,"));
}

#[test]
fn what_only_blocks_have_is_absent_for_a_dense_flow() {
    let line = format!("compare {SMALL} --estimators horn-schunck,diamond");
    let rows: Value = serde_json::from_str(&stdout(&format!("{line} --json"))).unwrap();
    for name in ["candidates_mean", "candidates_most", "missed_percent", "vectors_kb"] {
        assert!(rows[0][name].is_null() && rows[1][name].is_f64(), "{name}: {rows}");
    }
    for name in ["ms", "psnr_db", "epe_px", "kept_in_noise_percent", "residual_kb"] {
        assert!(rows[0][name].is_f64() && rows[1][name].is_f64(), "{name}: {rows}");
    }
    assert!(rows[0]["known"].as_f64() > Some(0.0) && rows[0]["points"].is_null(), "{rows}");
    assert!(rows[0].get("blocks").is_none() && rows[1]["blocks"].is_u64());
    let text = stdout(&line);
    let dense = text.lines().find(|row| row.starts_with("horn-schunck")).unwrap();
    assert_eq!(dense.split_whitespace().filter(|cell| *cell == "–").count(), 4, "{dense}");
}

#[test]
fn what_features_do_not_have_is_absent_for_them() {
    let rows: Value =
        serde_json::from_str(&stdout(&format!("compare {SMALL} --estimators pyramidal-lucas-kanade,harris --json")))
            .unwrap();
    for name in
        ["psnr_db", "kept_in_noise_percent", "kept_in_light_percent", "residual_kb", "frame_kb", "missed_percent"]
    {
        assert!(rows[0][name].is_null() && rows[1][name].is_null(), "{name}: {rows}");
    }
    assert!(rows[0]["epe_px"].is_f64() && rows[1]["epe_px"].is_null() && rows[1]["ms"].is_f64());
    let text = stdout(&format!("compare {SMALL} --estimators harris"));
    assert!(!text.contains("perfect"), "{text}");
}

#[test]
fn the_estimator_of_an_example_keeps_its_parameters() {
    const FAILS: &str = "example:kalman-filter/manoeuvre";
    let run = json(&format!("run {FAILS} --json"));
    let rows = json(&format!("compare {FAILS} --estimators kalman-filter,kalman-tracker --json"));
    assert_eq!(rows[0]["idf1"], run["metrics"]["idf1"]);
    assert!(rows[0]["idf1"].as_f64().expect("a score") < 0.7, "it fails there: {}", rows[0]["idf1"]);
}

#[test]
fn what_cannot_be_compared_is_reported() {
    for (more, told) in [
        ("--estimators diamnd", "diamond"),
        ("--estimators diamond --set hexagon.block-size=8", "hexagon is not compared"),
        ("--estimators diamond --set blok=8", "blok"),
        ("--estimators diamond --sweep search-range", "NAME=V1,V2"),
        ("--estimators diamond --sweep search-range=4,99", "1 to 64"),
        ("--estimators diamond --sweep fog=1", "noise"),
        ("--estimators diamond --frame 2", "frame"),
        ("--estimators diamond --json --markdown", "--json"),
    ] {
        let output = motionscope(&format!("compare {SMALL} {more}"));
        let sentence = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && sentence.contains(told), "{more}: {sentence}");
        assert!(sentence.lines().count() == 1 && output.stdout.is_empty(), "{more}: {sentence}");
    }
}

#[test]
fn the_courses_table_is_measured_cell_by_cell() {
    let clip = "synth:pillar,frames=3";
    let course_table = json(&format!("compare {clip} --course --repeat 1 --json"));
    let row = |feature: &str| {
        let mut all = course_table.as_array().unwrap().iter();
        all.find(|row| row["feature"].as_str().unwrap().starts_with(feature)).unwrap()
    };
    assert_eq!(row("complexity")["sequential"], "3.88");
    // A verdict follows from its statements, and these from what is measured beside them.
    for row in course_table.as_array().unwrap() {
        let claims = row["claims"].as_array().unwrap();
        let judged: Vec<bool> = claims.iter().filter_map(|claim| claim["holds"].as_bool()).collect();
        let expected = match judged.iter().filter(|holds| **holds).count() {
            _ if judged.is_empty() => "undecided",
            0 => "does not hold",
            all if all == judged.len() => "holds",
            _ => "holds in part",
        };
        assert_eq!(row["verdict"], expected, "{row}");
        assert!(claims.iter().all(|claim| claim["line"].as_u64().unwrap() > 0 && claim["quote"].is_string()), "{row}");
    }
    let figures = |feature: &str| {
        ["sequential", "logarithmic", "hierarchical"].map(|name| {
            let cell = row(feature)[name].as_str().unwrap();
            cell.split_whitespace().next_back().unwrap().parse::<f64>().unwrap()
        })
    };
    let holds = |feature: &str, words: &str| {
        let claims = row(feature)["claims"].as_array().unwrap();
        let claim = claims.iter().find(|claim| claim["quote"].as_str().unwrap().contains(words));
        claim.unwrap_or_else(|| panic!("{words}"))["holds"].as_bool()
    };
    let pan = figures("large motion: blocks");
    assert_eq!(
        holds("large motion: blocks", "Better than sequential"),
        Some(pan[1] > pan[0] + 5.0 && pan[1] < 90.0),
        "{pan:?}"
    );
    let db = figures("accuracy: PSNR");
    let better = ((db[2] - db[0]).abs() > 0.1).then_some(db[2] > db[0]);
    assert_eq!(holds("accuracy: PSNR", "more accurate"), better, "{db:?}");
    let error = figures("accuracy: mean endpoint error");
    let is_tie = error[2] > 0.95 * error[0] && error[0] > 0.95 * error[2];
    let better = (!is_tie).then_some(error[2] < error[0]);
    assert_eq!(holds("accuracy: mean endpoint error", "improving accuracy"), better, "{error:?}");
    for feature in ["search space", "complexity", "large motion: candidates", "memory"] {
        assert_eq!(row(feature)["verdict"], "holds", "{feature}");
    }
    // It says of which course it is, and which estimators are measured.
    let text = stdout(&format!("compare {clip} --course --repeat 1"));
    for words in ["unit VI, motion analysis", "sequential search is full search", "logarithmic search by quadrants"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(text.contains("(line 631)"), "a statement that does not hold is quoted with its line: {text}");
    // A picture that is too small for any pyramid is refused with what to do.
    let refused = motionscope("compare synth:pillar,width=32,height=32 --course");
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(!refused.status.success() && told.contains("smaller block"), "{told}");
}
