//! The command line as scripts use it: what it prints, writes and refuses.

mod common;

use std::fs;
use std::io::Cursor as Bytes;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use image::codecs::png::PngDecoder;
use image::imageops::crop_imm;
use image::{AnimationDecoder as _, DynamicImage};
use motionscope::experiment::source::Source;
use motionscope::experiment::unplaced;
use motionscope::media::{Open, open};
use motionscope::session::Session;
use motionscope_core::course::{estimator, estimators};
use motionscope_core::params::{Figure, Kind, Spec};
use motionscope_core::run::{Cursor, Move};
use serde_json::Value;

fn motionscope(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    command.current_dir(folder).args(line.split_whitespace()).stdin(Stdio::null());
    command.output().expect("the program starts")
}

fn stdout(folder: &Path, line: &str) -> String {
    let output = motionscope(folder, line);
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&stdout(folder, line)).expect("JSON")
}

/// The one sentence on standard error of a call that fails.
fn refusal(folder: &Path, line: &str) -> String {
    let output = motionscope(folder, line);
    assert!(!output.status.success() && output.stdout.is_empty(), "{line}");
    let told = String::from_utf8(output.stderr).expect("text");
    assert!(told.starts_with("error: ") && told.lines().count() == 1, "{line}: {told}");
    told
}

const SMALL: &str = "synth:translation,width=64,height=48,frames=3";

#[test]
fn list_names_every_estimator_with_its_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let all = json(folder.path(), "list --json");
    let full = all.as_array().unwrap().iter().find(|e| e["id"] == "full-search").expect("full search is there");
    let names: Vec<_> = full["params"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    for name in ["block-size", "search-range", "cost", "border", "order", "early-exit"] {
        assert!(names.contains(&name), "{name}");
    }
    let block = &full["params"][0];
    assert_eq!(
        (&block["range"], &block["default"], &block["unit"]),
        (&serde_json::json!([4, 64]), &16.into(), &"px".into())
    );
    let best = serde_json::json!({ "name": "keep-best", "text": "      minimum ← c; best ← (u, v)" });
    assert!(full["pseudocode"].as_array().unwrap().contains(&best), "{}", full["pseudocode"]);
    let count = |estimator: &Value| estimator["questions"].as_array().map_or(0, Vec::len);
    assert!(all.as_array().unwrap().iter().all(|estimator| count(estimator) > 0), "each has a question");
    let lower = &full["questions"][0];
    assert_eq!((&lower["id"], &lower["asked"]), (&"lower".into(), &"choice".into()));
    assert_eq!(lower["answers"].as_array().map(Vec::len), Some(3), "{lower}");
    let text = stdout(folder.path(), "list");
    assert!(text.contains("full-search") && text.contains("4 to 64 px; default 16"));
}

#[test]
fn a_parameter_without_effect_is_reported_in_the_list_and_where_it_is_set() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let all = json(here, "list --json");
    let flow = all.as_array().unwrap().iter().find(|e| e["id"] == "horn-schunck").expect("it is there");
    let param = |name: &str| flow["params"].as_array().unwrap().iter().find(|p| p["name"] == name).cloned().unwrap();
    assert_eq!((&param("tolerance")["advanced"], &param("alpha")["advanced"]), (&true.into(), &false.into()));
    assert!(param("relaxation")["no_effect"][0].as_str().is_some_and(|why| why.contains("no effect")));
    let told = |set: &str| {
        let output = motionscope(here, &format!("run {SMALL} --estimator horn-schunck --set iterations=2 {set}"));
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let warned = told("--set relaxation=1.5 --set solver=jacobi");
    assert!(warned.starts_with("warning: --set relaxation=1.5: ") && warned.lines().count() == 1, "{warned}");
    assert_eq!(told("--set relaxation=1.5"), "");
}

#[test]
fn a_full_caption_holds_the_formula_and_an_export_says_how_many_files_it_makes() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let size = |caption: &str| {
        let step = "--estimator horn-schunck --set iterations=2 --step 2.1";
        stdout(here, &format!("run {SMALL} {step} {caption} --overlay it.png"));
        image::image_dimensions(here.join("it.png")).unwrap()
    };
    let (plain, full) = (size("--caption"), size("--caption full"));
    assert!(full.0 == plain.0 && full.1 > plain.1, "the formula stands below: {plain:?} {full:?}");
    assert_eq!((size("--caption=full"), size("--caption=on")), (full, plain));
    let output = motionscope(here, &format!("export {SMALL} --estimator full-search --steps 2.1..2.5 --out steps"));
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(told, "5 pictures are saved into steps\n");
    assert_eq!(fs::read_dir(here.join("steps")).unwrap().count(), 5);
}

#[test]
fn lessons_are_listed_and_their_pages_saved_as_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = json(folder.path(), "lessons --json");
    let search = all.as_array().and_then(|all| all.iter().find(|lesson| lesson["id"] == "sequential-search"));
    let pages = search.expect("the lesson")["pages"].as_array().expect("its pages").clone();
    let listed = stdout(folder.path(), "lessons lesson:sequential-search");
    assert!(pages.iter().all(|page| listed.contains(page["title"].as_str().expect("a title"))), "{listed}");
    let own = "# Own\n+++\ntitle = \"One\"\nclip = \"synth:pillar,width=64,height=48\"\nestimator = \"full-search\"\n\
        step = \"3.2\"\n+++\nWords with $u$.\n+++\ntitle = \"Two\"\nstep = \"5.0\"\n+++\nMore.\n";
    fs::write(folder.path().join("own.md"), own).expect("a file");
    let said = stdout(folder.path(), "export own.md --out pages");
    assert!(said.contains("2 pages in pages"), "{said}");
    let page = image::open(folder.path().join("pages/page-01.png")).expect("a picture");
    assert!(page.width() > 1000 && page.height() >= 400, "{}×{}", page.width(), page.height());
    assert_ne!(page, image::open(folder.path().join("pages/page-02.png")).expect("a picture"));
    fs::write(folder.path().join("own.md"), own.replace("full-search", "no-search")).expect("a file");
    assert!(refusal(folder.path(), "export own.md --out pages").contains("page 1 of Own: line 5, estimator"));
    assert!(refusal(folder.path(), "export synth:pillar --estimator diamond --out pages").contains("--steps"));
}

#[test]
fn lessons_and_steps_are_saved_on_paper() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let own = "# Own\n+++\ntitle = \"One\"\nclip = \"synth:pillar,width=64,height=48\"\nestimator = \"full-search\"\n\
        step = \"3.2\"\nuntil = \"3.4\"\n+++\nWords with $u$.\n+++\ntitle = \"Two\"\nstep = \"0\"\n+++\nMore.\n";
    fs::write(here.join("own.md"), own).expect("a file");
    let is_pdf = |name: &str| fs::read(here.join(name)).is_ok_and(|bytes| bytes.starts_with(b"%PDF-"));
    for per_sheet in [1, 2, 4] {
        stdout(here, &format!("export own.md --handout {per_sheet}.pdf --pages-per-sheet {per_sheet} --answers"));
        assert!(is_pdf(&format!("{per_sheet}.pdf")));
    }
    stdout(here, "export own.md#1 --worksheet page.pdf");
    let step = "run synth:pillar,width=64,height=48 --estimator full-search --step 3.4 --worksheet";
    stdout(here, &format!("{step} step.pdf"));
    stdout(here, &format!("{step} answers.pdf --answers"));
    assert!(is_pdf("page.pdf") && is_pdf("step.pdf") && is_pdf("answers.pdf"));
    assert_ne!(fs::read(here.join("step.pdf")).expect("a file"), fs::read(here.join("answers.pdf")).expect("a file"));
    for (line, why) in [
        ("export own.md --handout a.png", "must end in .pdf"),
        ("export own.md --handout no/such/a.pdf", "no such folder"),
        ("export own.md --answers --out pages", "--answers needs"),
        ("export own.md#2 --worksheet a.pdf", "choose a step"),
        ("export own.md --worksheet a.pdf --out pages", "leave out --out"),
        ("export synth:pillar --worksheet a.pdf", "motionscope run CLIP"),
        ("run synth:pillar --estimator full-search --step 1.1 --answers", "--answers needs"),
    ] {
        let told = refusal(here, line);
        assert!(told.contains(why), "{line}: {told}");
    }
    assert!(!here.join("a.pdf").exists() && !here.join("a.png").exists());
}

#[test]
fn whatever_is_typed_is_reported_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let (long, many) = ("x".repeat(5000), "word ".repeat(900));
    let odd = "a\u{1B}[31m\nb\tc\u{202E}";
    for typed in [long.as_str(), &many, odd] {
        let set = format!("block-size={typed}");
        let synth = format!("synth:{typed}");
        for line in [
            vec!["info", typed],
            vec![typed, typed],
            vec!["run", SMALL, "--estimator", typed],
            vec!["run", SMALL, "--estimator", "full-search", "--set", &set],
            vec!["run", SMALL, "--estimator", "full-search", "--step", typed],
            vec!["run", SMALL, "--estimator", "full-search", "--overlay", typed],
            vec!["run", SMALL, "--estimator", "full-search", "--layer", typed],
            vec!["info", SMALL, "--truth", typed],
            vec!["run", &synth, "--estimator", "full-search"],
            vec!["compare", SMALL, "--estimators", typed],
        ] {
            let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
            let output = command.current_dir(folder.path()).args(&line).output().unwrap();
            let error = String::from_utf8(output.stderr).unwrap();
            let error = error.strip_suffix('\n').unwrap_or(&error);
            assert!(!output.status.success() && error.starts_with("error: "), "{error}");
            common::check_sentence(&error["error: ".len()..]);
        }
    }
}

/// An ffprobe that knows no file, as the real one answers then.
#[cfg(unix)]
#[test]
fn our_own_diagnosis_stands_beside_an_ffmpeg_that_has_none() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let tool = folder.path().join("ffprobe");
    fs::write(&tool, "#!/bin/sh\necho '{ \"program_version\": { \"version\": \"7.1\" } }'\nexit 1\n").unwrap();
    fs::set_permissions(&tool, fs::Permissions::from_mode(0o755)).unwrap();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let whole = |name: &str| fs::read(fixtures.join(name)).unwrap();
    let (mp4, avi, vp8) = (whole("h264_bframes.mp4"), whole("mjpeg.avi"), whole("vp8.webm"));
    for (name, bytes, told) in [
        // Its index lies at its end.
        ("cut.mp4", &mp4[..mp4.len() / 2], "its index (the moov box) is missing"),
        ("cut.avi", &avi[..12], "header is missing"),
        ("vp8.webm", &vp8[..], "coded as vp8, which needs ffmpeg, and the ffmpeg of this computer cannot read it"),
        ("odd.bin", b"\x01\x02 this is no video at all", "its format is not known, and the ffmpeg of this computer"),
    ] {
        fs::write(folder.path().join(name), bytes).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
        let command = command.current_dir(folder.path()).args(["info", name]).env("PATH", folder.path());
        let error = String::from_utf8(command.output().unwrap().stderr).unwrap();
        assert!(error.contains(told) && !error.contains("no video;"), "{name}: {error}");
    }
}

#[test]
fn info_has_every_key_that_scripts_read() {
    let folder = tempfile::tempdir().unwrap();
    let info = json(folder.path(), &format!("info {SMALL} --json"));
    let keys: Vec<_> = info.as_object().unwrap().keys().map(String::as_str).collect();
    let expected =
        ["width", "height", "frames", "fps", "seconds", "container", "codec", "truth", "truth_files", "warnings"];
    assert_eq!(keys, expected);
    assert_eq!((&info["width"], &info["height"], &info["frames"]), (&64.into(), &48.into(), &3.into()));
    assert!(stdout(folder.path(), &format!("info {SMALL}")).contains("64×48 px"));
}

#[test]
fn every_layer_of_motion_has_its_own_picture() {
    let folder = tempfile::tempdir().unwrap();
    let run = "run synth:parallax,width=96,height=72,frames=2 --estimator horn-schunck --set iterations=12";
    let mut pictures = Vec::new();
    let looks = [
        "--layer none",
        "--layer wheel",
        "--layer magnitude",
        "--layer error",
        "--layer consistency",
        "--layer-opacity 1",
    ];
    let arrows = ["--arrow-spacing 9", "--arrow-scale 4", "--streaks 0.5", "--streaks 0.6"];
    for (i, look) in looks.into_iter().chain(arrows).enumerate() {
        stdout(folder.path(), &format!("{run} {look} --legend --overlay {i}.png"));
        pictures.push(fs::read(folder.path().join(format!("{i}.png"))).unwrap());
    }
    for (i, one) in pictures.iter().enumerate() {
        assert!(pictures[..i].iter().all(|other| other != one), "picture {i} looks like one before");
    }
    stdout(folder.path(), &format!("{run} --overlay usual.svg"));
    stdout(folder.path(), &format!("{run} --layer wheel --overlay wheel.svg"));
    let svg = |name| fs::read(folder.path().join(name)).unwrap();
    assert!(svg("usual.svg") == svg("wheel.svg"), "a dense field has its colours unless told otherwise");
}

#[test]
fn a_layer_that_cannot_be_is_refused_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |line: &str| refusal(folder.path(), &format!("run {SMALL} --overlay a.png {line}"));
    for (line, reason) in [
        ("--estimator horn-schunck --layer heat", "layer must be none, wheel"),
        ("--estimator horn-schunck --layer error --step 1.1", "the end of the run"),
        ("--estimator horn-schunck --layer confidence", "reports no confidence"),
        ("--estimator harris --layer wheel", "single points"),
        ("--estimator horn-schunck --arrow-spacing 0", "1 to 256 px"),
        ("--estimator horn-schunck --layer-opacity 1.5", "0 to 1 or auto, not 1.5"),
        ("--estimator horn-schunck --arrow-scale 0", "or auto"),
        ("--estimator horn-schunck --streaks 2", "0 to 1 or off, not 2"),
    ] {
        let output = motionscope(folder.path(), &format!("run {SMALL} --overlay a.png {line}"));
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && told.contains(reason), "{line}: {told}");
    }
    assert!(refused("--estimator full-search --beside diamond --layer consistency").contains("single estimator"));
}

#[test]
fn the_check_with_the_reverse_pair_is_reported_in_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "run synth:parallax,width=96,height=72,frames=2 --estimator full-search --set block-size=8 --layer consistency";
    let run = json(folder.path(), &format!("{line} --json"));
    let check = &run["consistency"];
    let failing = check["inconsistent"].as_u64().unwrap();
    assert!(failing > 0 && failing < 96 * 72, "{check}");
    assert!((check["share"].as_f64().unwrap() - failing as f64 / (96.0 * 72.0)).abs() < 1e-9);
    for share in ["precision", "recall"] {
        assert!((0.0..=1.0).contains(&check[share].as_f64().unwrap()), "{check}");
    }
    assert!(stdout(folder.path(), line).contains("inconsistent pixels"));
    let other = json(folder.path(), &format!("{} --json", line.replace("consistency", "wheel")));
    assert!(other.get("consistency").is_none());
    let metrics = &other["metrics"];
    let shares: Vec<_> = ["r0.5", "r1.0", "r2.0"].map(|name| metrics[name].as_f64().unwrap()).to_vec();
    assert!(shares.windows(2).all(|pair| pair[0] >= pair[1]) && metrics["epe_p95_px"].as_f64().is_some());
}

#[test]
fn a_pixel_is_explained_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let run = format!("run {SMALL} --estimator horn-schunck --set iterations=12 --pixel 7,9");
    let pixel = |line: &str| json(folder.path(), &format!("{line} --json"))["pixel"].clone();
    let explained = pixel(&format!("{run} --step 3.1"));
    let keys: Vec<_> = explained.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(keys, ["x", "y", "step", "flow", "sentence", "facts"]);
    assert_eq!((&explained["x"], &explained["y"], &explained["step"]), (&7.into(), &9.into(), &"3.1".into()));
    assert!(explained["sentence"].as_str().unwrap().contains("pixel (3, 4)"), "{explained}");
    assert!(!explained["facts"].as_object().unwrap().is_empty(), "{explained}");
    // At the end the flow is that of the file.
    stdout(folder.path(), &format!("{run} --flow end.flo"));
    let bytes = fs::read(folder.path().join("end.flo")).unwrap();
    let cell = 12 + 8 * (9 * 64 + 7);
    let [u, v] = [0, 4].map(|i| f32::from_le_bytes(bytes[cell + i..][..4].try_into().unwrap()));
    let flow = pixel(&run)["flow"].clone();
    assert_eq!([&flow[0], &flow[1]].map(|c| c.as_f64().unwrap() as f32), [u, v]);
    let text = stdout(folder.path(), &run);
    assert!(text.contains("pixel       (7, 9) at step ") && text.contains("\nflow        ("), "{text}");
    // Blocks are explained where theirs ends, and what is not known yet is not stated.
    let block = format!("run {SMALL} --estimator full-search --pixel 40,20");
    let explained = pixel(&block);
    assert!(explained["step"].as_str().unwrap().starts_with("7."), "{explained}");
    assert!(explained["flow"].is_array(), "{explained}");
    let frame = pixel(&format!("run {SMALL} --estimator running-average --pixel reference:7,9"));
    assert_eq!((&frame["picture"], frame.get("flow")), (&"reference".into(), None));
}

#[test]
fn two_pictures_are_a_clip() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), "synth translation --out clip --set width=64 --set height=48 --set frames=3");
    let mut frames: Vec<_> =
        fs::read_dir(folder.path().join("clip")).unwrap().map(|entry| entry.unwrap().path()).collect();
    frames.retain(|path| path.extension().is_some_and(|extension| extension == "png"));
    frames.sort();
    fs::copy(&frames[0], folder.path().join("one.png")).unwrap();
    fs::copy(&frames[2], folder.path().join("two.png")).unwrap();
    let info = json(folder.path(), "info one.png two.png --json");
    assert_eq!((&info["frames"], &info["container"]), (&2.into(), &"images".into()));
    let run = json(folder.path(), "run one.png two.png --estimator full-search --set block-size=8 --json");
    assert_eq!((&run["clip"], &run["last_frame"]), (&"pair:one.png|two.png".into(), &1.into()));
    // What is read is not overwritten.
    let refused = refusal(folder.path(), "run one.png two.png --estimator full-search --overlay two.png");
    assert!(refused.contains("two.png"), "{refused}");
    fs::write(folder.path().join("text.txt"), "text").unwrap();
    for (line, told) in [
        ("info one.png text.txt", "text.txt"),
        ("info one.png gone.png", "gone.png"),
        ("info one.png .", "folder"),
        ("info one.png synth:pillar", "cannot be one of two pictures"),
    ] {
        let refused = refusal(folder.path(), line);
        assert!(refused.contains(told), "{line}: {refused}");
    }
}

#[test]
fn run_tells_one_object_with_time_and_errors() {
    let folder = tempfile::tempdir().unwrap();
    let line = format!(
        "run {SMALL} --estimator full-search --set block-size=8 --set search-range=7 --frame 1 --repeat 3 --threads 2 --json"
    );
    let run = json(folder.path(), &line);
    let keys: Vec<_> = run.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(
        keys,
        [
            "clip",
            "estimator",
            "params",
            "frame",
            "last_frame",
            "units",
            "events",
            "threads",
            "ms",
            "truth_files",
            "metrics"
        ]
    );
    assert_eq!((&run["estimator"], &run["frame"], &run["threads"]), (&"full-search".into(), &1.into(), &2.into()));
    assert_eq!((&run["params"]["block-size"], &run["params"]["search-range"]), (&8.into(), &7.into()));
    assert_eq!((&run["last_frame"], &run["units"]), (&2.into(), &48.into()));
    assert!(run["ms"]["min"].as_f64().unwrap() <= run["ms"]["median"].as_f64().unwrap());
    let metrics = &run["metrics"];
    // Each candidate is an event; so is each window, each result, and each new best.
    let clip = Source::parse(SMALL).unwrap().open(&Open::default()).unwrap().clip;
    let mut full = estimator("full-search").unwrap();
    full.set("block-size", "8").unwrap();
    full.set("search-range", "7").unwrap();
    let mut walk = full.walk(&clip, 1).unwrap();
    let mut events = 0;
    for unit in 0..48 {
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        events += walk.events();
    }
    assert!(walk.at_end());
    assert_eq!(run["events"], events);
    assert!(events > metrics["candidates"].as_u64().unwrap() as usize + 3 * 48 - 1);
    assert_eq!(metrics["known"], 64 * 48);
    assert!(metrics["epe_px"].as_f64().unwrap() < 2.0 && metrics["psnr_db"].as_f64().unwrap() > 20.0);
}

#[test]
fn what_a_run_leaves_behind_can_be_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    stdout(here, &format!("run {SMALL} --estimator full-search --flow a.flo --table a.csv --overlay a.svg"));
    stdout(here, &format!("run {SMALL} --estimator full-search --flow a.npy --overlay a.png --scale 4"));
    stdout(here, &format!("run {SMALL} --estimator full-search --flow b.png"));
    let rows = fs::read_to_string(here.join("a.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 12);
    assert!(rows.starts_with("x_px,y_px,"));
    assert_eq!(fs::metadata(here.join("a.flo")).unwrap().len(), 12 + 64 * 48 * 8);
    assert!(fs::read_to_string(here.join("a.svg")).unwrap().contains("<svg"));
    let overlay = open(&here.join("a.png"), &Open::default()).unwrap().clip;
    assert_eq!(overlay.size(), (4 * 64, 4 * 48), "a finished run is shown on frame t alone");
    // Its own flow as truth: no error at all.
    let same = json(here, &format!("run {SMALL} --estimator full-search --truth a.flo --json"));
    assert_eq!(same["metrics"]["epe_px"], 0.0);
}

#[test]
fn pipes_carry_one_result() {
    let folder = tempfile::tempdir().unwrap();
    let table = motionscope(folder.path(), &format!("run {SMALL} --estimator full-search --table -"));
    assert!(table.stdout.starts_with(b"x_px,") && String::from_utf8_lossy(&table.stderr).contains("full-search on"));
    let overlay = motionscope(folder.path(), &format!("run {SMALL} --estimator full-search --overlay -"));
    assert!(overlay.stdout.starts_with(b"\x89PNG"));
    assert!(
        refusal(folder.path(), &format!("run {SMALL} --estimator full-search --table - --json")).contains("only one")
    );
}

#[test]
fn the_same_call_gives_the_same_bytes_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for threads in ["1", "2", "3"] {
        let files = format!("--flow {threads}.flo --table {threads}.csv --overlay {threads}.png --step 5.40");
        stdout(here, &format!("run {SMALL} --estimator full-search --threads {threads} {files}"));
    }
    for end in ["flo", "csv", "png"] {
        let read = |threads: &str| fs::read(here.join(format!("{threads}.{end}"))).unwrap();
        assert!(read("1") == read("2") && read("2") == read("3"), "{end}");
    }
}

#[test]
fn steps_are_exported_one_by_one_or_block_by_block() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let count = |folder: &str| fs::read_dir(here.join(folder)).unwrap().count();
    stdout(here, &format!("export {SMALL} --estimator full-search --steps 2.1..2.6 --out steps"));
    stdout(
        here,
        &format!("export {SMALL} --estimator full-search --steps 2..5 --every block --format svg --out blocks"),
    );
    stdout(here, &format!("export {SMALL} --estimator full-search --steps 11..99 --every block --out rest"));
    assert_eq!((count("steps"), count("blocks"), count("rest")), (6, 4, 2));
    assert!(here.join("steps/step_00005.png").exists() && here.join("blocks/step_00003.svg").exists());
}

#[test]
fn a_landscape_turns_in_the_pictures_of_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let export = format!("export {SMALL} --estimator diamond --steps 2.5..2.5 --turntable 4 --out turn");
    assert!(refusal(here, &export).contains("--landscape"));
    stdout(here, &format!("{export} --landscape"));
    let pictures: Vec<_> = (0..4).map(|i| fs::read(here.join(format!("turn/step_{i:05}.png"))).unwrap()).collect();
    assert!((1..4).all(|i| pictures[i] != pictures[0]), "each from another side");
}

#[test]
fn an_animation_shows_the_exported_steps() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let export = format!("export {SMALL} --estimator full-search --steps 2.1..2.6");
    stdout(here, &format!("{export} --legend --out steps"));
    let said = stdout(here, &format!("{export} --legend --animation steps.apng --rate 5"));
    assert_eq!(said, "6 pictures in steps.apng\n");
    let decoder = PngDecoder::new(Bytes::new(fs::read(here.join("steps.apng")).unwrap())).unwrap();
    let frames = decoder.apng().unwrap().into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 6);
    for (index, frame) in frames.iter().enumerate() {
        let picture = image::open(here.join(format!("steps/step_{index:05}.png"))).unwrap().into_rgb8();
        let seen = DynamicImage::ImageRgba8(frame.buffer().clone()).into_rgb8();
        // Where a legend takes fewer lines, the rest is filled up.
        let part = crop_imm(&seen, 0, 0, picture.width(), picture.height()).to_image();
        assert!(part == picture, "picture {index}");
    }
    for (asked, wanted) in [
        ("--animation steps.avi", ".gif, .apng, .webp or .mp4"),
        ("--animation steps.gif --rate 900", "0.1 to 60 steps per second"),
        ("--animation no/steps.gif", "no/steps.gif"),
        ("--animation steps.gif --out steps", "cannot be used with"),
    ] {
        let said = refusal(here, &format!("{export} {asked}"));
        assert!(said.contains(wanted), "{said}");
    }
    let mut names: Vec<_> = fs::read_dir(here).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["steps", "steps.apng"], "what is refused leaves nothing");
}

#[test]
fn without_ffmpeg_an_mp4_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let line = format!("export {SMALL} --estimator full-search --steps 2.1..2.2 --animation steps.mp4");
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    let output = command.current_dir(folder.path()).args(line.split_whitespace()).env("PATH", "").output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && said.contains("install it, or save as .gif, .apng or .webp"), "{said}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A folder with an ffmpeg in it that is a script of the shell, and the clip that `motionscope` with `line` writes by it.
#[cfg(unix)]
fn with_ffmpeg(script: &str, line: &str) -> (tempfile::TempDir, Output) {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().expect("a folder");
    let (here, programs) = (folder.path().join("here"), folder.path().join("programs"));
    [&here, &programs].into_iter().for_each(|folder| fs::create_dir(folder).expect("a folder"));
    let (path, version) = (programs.join("ffmpeg"), "case \"$*\" in *-version*) echo ffmpeg version 4.4; exit;; esac");
    fs::write(&path, format!("#!/bin/sh\n{version}\n{script}\n")).expect("a file");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    let output = command
        .current_dir(here)
        .args(line.split_whitespace())
        .env("PATH", &programs)
        .output()
        .expect("the program starts");
    (folder, output)
}

#[cfg(target_os = "linux")]
#[test]
fn a_clip_is_recorded_from_a_camera() {
    let frames = "printf 'YUV4MPEG2 W2 H2 F30:1 Cmono\\nFRAME\\nabcdFRAME\\nefghFRAME\\nijkl'";
    // An old ffmpeg knows the old name of an option alone.
    let script = format!("case \"$*\" in *-i' '/dev/video9*-vsync*) {frames};; *) exit 1;; esac");
    let line = "camera --device /dev/video9 --seconds 2 --out hand.y4m";
    let (folder, output) = with_ffmpeg(&script, line);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success() && said.starts_with("hand.y4m: 3 frames of 2×2 px in 0.0 s, from /dev/video9"),
        "{said}"
    );
    assert!(said.contains("ended early: /dev/video9: it sends no more frames; plug it in again"), "{said}");
    assert!(said.contains("/dev/video9 sends no frames of 640×480 px."), "{said}");
    let clip = open(&folder.path().join("here/hand.y4m"), &Open::default()).unwrap().clip;
    assert_eq!(clip.frame(2).unwrap().luma().cells(), b"ijkl");

    let (folder, output) = with_ffmpeg("echo '/dev/video9: Permission denied' >&2; exit 1", line);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && said.contains("add your user to the group video"), "{said}");
    assert_eq!(fs::read_dir(folder.path().join("here")).unwrap().count(), 0, "nothing is left");
}

#[test]
fn the_test_picture_needs_no_ffmpeg() {
    let folder = tempfile::tempdir().unwrap();
    let run = |line: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
        command.current_dir(folder.path()).args(line.split_whitespace()).env("PATH", "").output().unwrap()
    };
    let listed = String::from_utf8(run("camera --list").stdout).unwrap();
    assert!(listed.contains("Test picture") && listed.contains("install it (ffmpeg.org)"), "{listed}");
    // The test picture is no substitute that is recorded unasked.
    let refused = run("camera --out u.y4m");
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(!refused.status.success() && said.contains("install it (ffmpeg.org)"), "{said}");
    let output = run("camera --device test --size 64x48 --seconds 0.3 --out t.y4m");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let info = json(folder.path(), "info t.y4m --json");
    assert!(info["width"] == 64 && info["frames"].as_u64().is_some_and(|frames| (4..=9).contains(&frames)), "{info}");
    // A recording is not made again, so it is overwritten only if that is asked for.
    let first = fs::read(folder.path().join("t.y4m")).unwrap();
    let line = "camera --device test --size 65x49 --seconds 0.2 --out t.y4m";
    let said = refusal(folder.path(), line);
    let words = "--out t.y4m would replace an earlier file; choose another name, or add --force to overwrite";
    assert!(said.contains(words) && fs::read(folder.path().join("t.y4m")).unwrap() == first, "{said}");
    let said = stdout(folder.path(), &format!("{line} --force"));
    assert!(said.contains(" frames of 65×49 px in ") && !said.contains("sends no frames"), "{said}");
    let info = json(folder.path(), "info t.y4m --json");
    assert!(info["width"] == 65 && info["height"] == 49, "{info}");
    for (line, why) in [
        ("camera --out t.avi", "must end in .y4m"),
        ("camera --device nope --out u.y4m", "Test picture"),
        ("camera --size 5 --out u.y4m", "640x480"),
        ("camera --seconds 0 --out u.y4m", "0.1 to 600 seconds"),
        ("camera --device test --seconds 0.2 --out no/u.y4m", "no/u.y4m"),
    ] {
        let said = refusal(folder.path(), line);
        assert!(said.contains(why), "{line}: {said}");
    }
}

#[test]
fn a_session_brings_all_that_the_command_line_needs() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = format!(
        "motionscope = 1\nclip = \"{SMALL}\"\nestimator = \"full-search\"\nframe = 1\nstep = \"3.7\"\n\
         [set]\nblock-size = 8\nsearch-range = 4\n[picture]\nview = \"blend\"\nblend = 0.8\ntheme = \"light\"\nlegend = true\n"
    );
    fs::write(here.join("lesson.motionscope"), text).unwrap();
    stdout(here, "run lesson.motionscope --overlay a.png");
    assert_eq!(json(here, "info lesson.motionscope --json"), json(here, &format!("info {SMALL} --json")));
    let flags =
        "--frame 1 --step 3.7 --set block-size=8 --set search-range=4 --view blend --blend 0.8 --theme light --legend";
    stdout(here, &format!("run {SMALL} --estimator full-search {flags} --overlay b.png"));
    assert!(fs::read(here.join("a.png")).unwrap() == fs::read(here.join("b.png")).unwrap());
    let session = Session::load(&here.join("lesson.motionscope")).unwrap();
    session.save(&here.join("again.motionscope")).unwrap();
    stdout(here, "run again.motionscope --overlay c.png");
    assert!(fs::read(here.join("a.png")).unwrap() == fs::read(here.join("c.png")).unwrap());
}

#[test]
fn an_example_is_a_clip_with_its_settings() {
    let folder = tempfile::tempdir().unwrap();
    let ran = json(folder.path(), "run example:full-search/large-motion --json");
    assert_eq!((&ran["estimator"], &ran["params"]["search-range"]), (&"full-search".into(), &8.into()));
    assert!(ran["clip"].as_str().is_some_and(|clip| clip.contains("speed=4")), "{}", ran["clip"]);
    let why = refusal(folder.path(), "run example:full-search/none --json");
    assert!(why.contains("example:full-search/large-motion"), "{why}");
    let listed = stdout(folder.path(), "list full-search");
    assert!(listed.contains("example:full-search/low-texture") && listed.contains("fails, low texture"), "{listed}");
}

#[test]
fn a_session_names_detections_as_the_flag_does() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let rows: String = (1..=4).map(|t| format!("{t},-1,{},30,12,10,1,-1,-1,-1\n", 20 + 3 * t)).collect();
    fs::write(here.join("det.txt"), rows).unwrap();
    let clip = "synth:traffic,width=96,height=72,frames=4";
    let lesson = |detections: &str| {
        let text = format!("motionscope = 1\nclip = \"{clip}\"\n{detections}estimator = \"kalman-tracker\"\n");
        fs::write(here.join("lesson.motionscope"), text).unwrap();
    };
    lesson("detections = \"det.txt\"\n");
    let tracks = |line: &str| {
        stdout(here, &format!("{line} --tracks tracks.txt --force"));
        fs::read_to_string(here.join("tracks.txt")).unwrap()
    };
    let given = tracks(&format!("run {clip} --estimator kalman-tracker --detections det.txt"));
    assert_eq!(tracks("run lesson.motionscope"), given);
    lesson("");
    assert_eq!(tracks("run lesson.motionscope --detections det.txt"), given);
    assert_ne!(tracks("run lesson.motionscope"), given, "the detector of the tracker finds others");
    lesson("detections = \"gone.txt\"\n");
    let told = refusal(here, "run lesson.motionscope");
    assert!(told.contains("gone.txt"), "{told}");
    lesson("detections = 3\n");
    let told = refusal(here, "run lesson.motionscope");
    assert!(told.contains("lesson.motionscope: line 3, detections: a text in quotes is needed, not 3"), "{told}");
    lesson("detections = \"det.txt\"\n");
    let told = refusal(here, "run lesson.motionscope --tracks det.txt");
    assert!(told.contains("--tracks") && told.contains("detections"), "{told}");
}

#[test]
fn a_switch_of_a_session_can_be_taken_back_by_its_flag() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = format!(
        "motionscope = 1\nclip = \"{SMALL}\"\nestimator = \"full-search\"\nstep = \"3.7\"\n[picture]\nlegend = true\n"
    );
    fs::write(here.join("lesson.motionscope"), text).unwrap();
    let paint = |line: &str| {
        stdout(here, &format!("run {line} --overlay it.png"));
        fs::read(here.join("it.png")).unwrap()
    };
    let with = paint("lesson.motionscope");
    assert!(paint("lesson.motionscope --legend") == with);
    assert!(paint(&format!("{SMALL} --estimator full-search --step 3.7 --legend")) == with);
    let without = paint("lesson.motionscope --legend=off");
    assert!(without != with && paint(&format!("{SMALL} --estimator full-search --step 3.7")) == without);
    let help = stdout(here, "run --help");
    for entry in ["--view <NAME>", "--layer-opacity <NUMBER>", "--arrow-spacing <PX>", "--legend[=<on|off>]"] {
        assert!(help.contains(entry), "{entry}: {help}");
    }
    for heading in ["Estimation:", "Clip:", "Picture:", "Output:", "Execution:"] {
        assert!(help.lines().any(|line| line == heading), "{heading} {help}");
    }
}

#[test]
fn the_pixel_that_is_asked_for_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let flow = "--estimator horn-schunck --set iterations=6 --caption";
    let session = |pixel: &str| {
        let text = format!(
            "motionscope = 1\nclip = \"{SMALL}\"\nestimator = \"horn-schunck\"\nstep = \"3.1\"\n{pixel}\n\
             [set]\niterations = 6\n[picture]\ncaption = true\n"
        );
        fs::write(here.join("lesson.motionscope"), text).unwrap();
    };
    let read = |name: &str| fs::read(here.join(name)).unwrap();
    let paint = |line: &str| {
        stdout(here, &format!("{line} --overlay it.png"));
        read("it.png")
    };
    session("pixel = \"7,9\"");
    let asked = paint(&format!("run {SMALL} {flow} --step 3.1 --pixel 7,9"));
    assert!(asked != paint(&format!("run {SMALL} {flow} --step 3.1")), "another pixel is at work");
    assert!(asked == paint("run lesson.motionscope"), "a session keeps its pixel");
    let other = paint("run lesson.motionscope --pixel 50,30");
    assert!(other != asked && other == paint(&format!("run {SMALL} {flow} --step 3.1 --pixel 50,30")));
    stdout(here, &format!("export {SMALL} {flow} --pixel 7,9 --steps 3.1..4.1 --out steps"));
    stdout(here, "export lesson.motionscope --steps 3.1..4.1 --out kept");
    let last = paint(&format!("run {SMALL} {flow} --step 4.1 --pixel 7,9"));
    let files = fs::read_dir(here.join("steps")).unwrap().count() - 1;
    for folder in ["steps", "kept"] {
        let step = |index: usize| read(&format!("{folder}/step_{index:05}.png"));
        assert!(step(0) == asked && step(files) == last, "{folder}");
    }
    // What a session holds is left alone where nothing explains it.
    assert!(
        paint("run lesson.motionscope --estimator full-search")
            == paint(&format!("run {SMALL} --estimator full-search --step 3.1 --caption"))
    );
    session("pixel = \"64,9\"");
    assert!(paint("run lesson.motionscope") == paint(&format!("run {SMALL} {flow} --step 3.1")));
    // Whoever steps from pixel to pixel hears of the next one, unless one is asked for.
    let rows = format!("{SMALL} --estimator normal-flow --caption");
    let text =
        format!("motionscope = 1\nclip = \"{SMALL}\"\nestimator = \"normal-flow\"\nstep = \"20.5\"\npixel = \"7,9\"\n");
    fs::write(here.join("lesson.motionscope"), text).unwrap();
    stdout(here, "export lesson.motionscope --caption --steps 20.5..20.6 --out next");
    stdout(here, &format!("export {rows} --pixel 7,9 --steps 20.5..20.6 --out asked"));
    for (event, index) in [(5, 0), (6, 1)] {
        let [next, asked] = ["next", "asked"].map(|folder| read(&format!("{folder}/step_{index:05}.png")));
        assert!(next == paint(&format!("run {rows} --step 20.{event}")));
        assert!(asked == paint(&format!("run {rows} --step 20.{event} --pixel 7,9")) && asked != next);
    }
}

#[test]
fn a_blend_has_the_share_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let paint = |look: &str| {
        stdout(folder.path(), &format!("run {SMALL} --estimator full-search --step 0 {look} --overlay it.png"));
        fs::read(folder.path().join("it.png")).unwrap()
    };
    assert!(paint("--view blend --blend 0") == paint("--view current"));
    assert!(paint("--view blend --blend 1") == paint("--view next"));
    assert!(paint("--view blend --blend 0.5") == paint("--view blend"));
    assert!(paint("--view blend --blend 0.8") != paint("--view blend"));
}

#[test]
fn a_synthetic_clip_on_disk_is_the_same_clip() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    stdout(here, "synth translation --out clip --set width=64 --set height=48 --set frames=3");
    let info = json(here, "info clip --json");
    assert_eq!((&info["frames"], &info["width"]), (&3.into(), &64.into()));
    assert!(info["truth"].as_array().unwrap().contains(&"flow".into()));
    let metrics = |clip: &str| json(here, &format!("run {clip} --estimator full-search --json"))["metrics"].clone();
    assert_eq!(metrics("clip"), metrics(SMALL));
    assert!(stdout(here, "synth --list").contains("translation"));
}

#[test]
fn what_is_wrong_is_one_sentence_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("empty.mp4"), []).unwrap();
    fs::write(here.join("text.png"), "no picture").unwrap();
    fs::write(here.join("bad.motionscope"), "motionscope = 1").unwrap();
    fs::create_dir(here.join("nothing")).unwrap();
    fs::create_dir(here.join("mine")).unwrap();
    fs::write(here.join("mine/gt.txt"), "by hand").unwrap();
    let run = |clip: &str, more: &str| format!("run {clip} --estimator full-search --overlay out.png {more}");
    let all = || {
        let mut names: Vec<_> = fs::read_dir(here).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = all();
    for (line, told) in [
        (run("gone.mp4", ""), "gone.mp4"),
        (run("empty.mp4", ""), "empty.mp4"),
        (run("text.png", ""), "text.png"),
        (run("nothing", ""), "nothing"),
        (run("bad.motionscope", ""), "bad.motionscope"),
        (run(SMALL, "--frame 2"), "frame 0 to 1"),
        (run(SMALL, "--set block-size=3"), "4 to 64 px"),
        (run(SMALL, "--set serch-range=8"), "there is no parameter serch-range; the nearest is search-range"),
        (run(SMALL, "--set size=8"), "early-exit"),
        (run(SMALL, "--set block-size"), "NAME=VALUE"),
        (run(SMALL, "--step x"), "UNIT.EVENT"),
        (run(SMALL, "--step 13"), "ends at 12"),
        (run(SMALL, "--set block-size=8.5"), "whole number"),
        (run(SMALL, "--view up"), "side-by-side"),
        (run(SMALL, "--view blend --blend 1.5"), "blend must be 0 to 1, not 1.5"),
        (run(SMALL, "--blend 0.8"), "--view blend"),
        (run(SMALL, "--scale 9"), "1..=8"),
        (run(SMALL, "--threads 0"), "1..=256"),
        (run(SMALL, "--truth gone.flo"), "gone.flo"),
        (run(SMALL, "--flow out.txt"), ".flo"),
        (run(SMALL, "--table out.png2"), ".csv"),
        (format!("run {SMALL} --estimator full-search --step 13 --json"), "ends at 12"),
        (run(SMALL, "--flow no/such/folder/out.flo"), "out.flo"),
        (format!("run {SMALL} --estimator no-search"), "the nearest is log-search"),
        (format!("run {SMALL} --estimator nothing-like-it"), "full-search"),
        (run(SMALL, "--beside magic"), "no estimator magic"),
        (run(SMALL, "--beside diamond,kalman-filter"), "Kalman filter on a whole clip"),
        (run(SMALL, "--beside diamond,hexagon,three-step,four-step"), "2 to 4 estimators"),
        (run(SMALL, "--beside hierarchical --set hierarchical.levels=6"), "hierarchical: with 6 levels"),
        (run(SMALL, "--beside diamond --set diamond.block-size=8"), "same block size"),
        (run(SMALL, "--beside diamond --pace slow"), "block, budget"),
        (run(SMALL, "--beside horn-schunck --pace block"), "choose result"),
        (run(SMALL, "--level 1"), "no pyramid"),
        (run(SMALL, "--level top"), "0 to 99 or at-work, not top"),
        (
            format!("run {SMALL} --estimator hierarchical --set levels=2 --level 2 --overlay o.png"),
            "levels 0 to 1, not 2",
        ),
        (run(SMALL, "--pixel 7"), "X,Y"),
        (run(SMALL, "--pixel frame:7,9"), "a picture must be t, t+1"),
        (run(SMALL, "--pixel t+1:7,9"), "cannot explain pixels of the picture t+1"),
        (run(SMALL, "--step 3.7 --pixel 7,9"), "full-search cannot explain pixel (7, 9) at step 3.7"),
        (run(SMALL, "--beside diamond --pixel 7,9"), "cannot explain pixel"),
        (run(SMALL, "--pixel 64,9"), "pixel (64, 9) is outside the picture of 64×48 px"),
        (run(SMALL, "--pixel template:5,5"), "this step does not show the picture template; it shows t and t+1"),
        (
            format!("run {SMALL} --estimator running-average --pixel template:5,5 --overlay o.png"),
            "this step does not show the picture template; it shows t and reference",
        ),
        (
            format!("run {SMALL} --estimator running-average --pixel reference:64,5 --overlay o.png"),
            "pixel (64, 5) is outside the picture of 64×48 px",
        ),
        (
            format!("run {SMALL} --estimator normal-flow --step 3.7 --pixel 7,9 --overlay o.png"),
            "is processed at step 10.8, but this is step 3.7",
        ),
        (
            format!("export {SMALL} --estimator horn-schunck --steps 1..2 --pixel 7,48 --out o"),
            "pixel (7, 48) is outside",
        ),
        (format!("export {SMALL} --estimator normal-flow --steps 3..11 --pixel 7,9 --out o"), "is processed at step"),
        (run(SMALL, "--pace budget"), "--beside"),
        (run(SMALL, "--beside diamond --step 13"), "ends at 12"),
        (format!("run {SMALL} --estimator full-search --beside diamond"), "--overlay"),
        (format!("run {SMALL}"), "--estimator"),
        (format!("export {SMALL} --estimator full-search --steps 5..2 --out o"), "needs A ≤ B"),
        (format!("export {SMALL} --estimator full-search --steps 99..100 --out o"), "ends"),
        ("synth nowhere --out o".into(), "translation"),
        ("synth translation --out mine".into(), "already holds gt.txt"),
        ("frobnicate --hard".into(), "--help"),
    ] {
        let refusal = refusal(here, &line);
        assert!(refusal.contains(told), "{line}: {refusal}");
        assert_eq!(all(), before, "{line} left something behind");
    }
    assert_eq!(fs::read_dir(here.join("mine")).unwrap().count(), 1);
    assert_eq!(fs::read_to_string(here.join("mine/gt.txt")).unwrap(), "by hand");
}

/// macOS and Windows have no such names.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_unicode_open_all_the_same() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    stdout(here, "synth translation --out clip --set width=64 --set height=48 --set frames=3");
    let pictures = here.join(OsStr::from_bytes(b"\xFCbung"));
    fs::create_dir(&pictures).unwrap();
    for t in 0..3 {
        let name = [b"h\xF6he".as_slice(), &[b'0' + t], b".png"].concat();
        fs::copy(here.join(format!("clip/frame_000{t}.png")), pictures.join(OsStr::from_bytes(&name))).unwrap();
    }
    fs::create_dir(pictures.join("flow")).unwrap();
    let flow = pictures.join("flow").join(OsStr::from_bytes(b"h\xF6he0.flo"));
    fs::copy(here.join("clip/flow/frame_0000.flo"), flow).unwrap();
    for clip in [&pictures, &pictures.join(OsStr::from_bytes(b"h\xF6he0.png"))] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
        let run = command.arg("run").arg(clip).args(["--estimator", "full-search", "--frame", "1", "--json"]);
        let run = run.output().expect("the program starts");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let info = Command::new(env!("CARGO_BIN_EXE_motionscope")).arg("info").arg(clip).arg("--json").output();
        let info: Value = serde_json::from_slice(&info.expect("the program starts").stdout).expect("JSON");
        assert_eq!(info["frames"], 3);
        assert_eq!(info["truth"], serde_json::json!(["flow"]));
    }
}

#[test]
fn a_damaged_truth_found_beside_the_clip_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    stdout(here, "synth translation --out clip --set width=64 --set height=48 --set frames=3");
    let truth = here.join("clip/flow/frame_0000.flo");
    let whole = fs::read(&truth).unwrap();
    fs::write(&truth, &whole[..whole.len() / 2]).unwrap();
    let run = motionscope(here, "run clip --estimator full-search --json");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(told.starts_with("warning: ") && told.contains("frame_0000.flo"), "{told}");
    let metrics = &serde_json::from_slice::<Value>(&run.stdout).unwrap()["metrics"];
    assert!(metrics["candidates"].is_u64() && metrics["psnr_db"].is_f64() && metrics["epe_px"].is_null());
    assert!(stdout(here, "run clip --estimator full-search").contains("endpoint error      unknown: "));
    refusal(here, "run clip --estimator full-search --truth clip/flow --json");
    fs::write(here.join("clip/groundtruth.txt"), "abc").unwrap();
    let run = motionscope(here, "run clip --estimator mean-shift --json");
    let told = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.success() && told.contains("warning: ground truth beside the clip is ignored: "), "{told}");
    assert!(told.contains("“abc” is not a number"), "{told}");
}

#[test]
fn a_session_keeps_its_parameters_when_its_own_estimator_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = format!(
        "motionscope = 1\nclip = \"{SMALL}\"\nestimator = \"full-search\"\n[set]\nblock-size = 8\nsearch-range = 4\n"
    );
    fs::write(here.join("lesson.motionscope"), text).unwrap();
    let params = |line: &str| json(here, &format!("run lesson.motionscope {line} --json"))["params"].clone();
    assert_eq!(params("--estimator full-search"), params(""));
    assert_eq!(params("--estimator full-search --set search-range=5")["block-size"], 8);
    assert_eq!(params("--estimator diamond")["block-size"], 16, "another one has its own");
}

#[test]
fn a_dense_flow_is_written_and_assessed_without_what_only_blocks_have() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for id in ["normal-flow", "horn-schunck", "lucas-kanade"] {
        let told = json(here, &format!("run {SMALL} --estimator {id} --flow {id}.flo --table {id}.csv --json"));
        let metrics = &told["metrics"];
        assert!(metrics["candidates"].is_null() && metrics["vector_bits"].is_null(), "{id}: {metrics}");
        assert!(metrics["epe_px"].is_f64() && metrics["residual_bits"].is_f64(), "{id}: {metrics}");
        let known = metrics["known"].as_u64().unwrap() as usize;
        let table = fs::read_to_string(here.join(format!("{id}.csv"))).unwrap();
        assert!(table.starts_with("x_px,y_px,u_px,v_px"), "{id}");
        assert_eq!(table.lines().count() - 1, known, "{id}: a row for each pixel of known motion");
        assert!(!table.contains("NaN"));
        // The file is a truth in its turn: against itself nothing is wrong.
        let again = json(here, &format!("run {SMALL} --estimator {id} --truth {id}.flo --json"));
        assert!(again["metrics"]["epe_px"].as_f64() < Some(1e-6), "{id}");
    }
    let text = stdout(here, &format!("run {SMALL} --estimator horn-schunck --overlay flow.svg --legend"));
    assert!(!text.contains("candidates") && !text.contains("vectors"), "{text}");
    let picture = fs::read_to_string(here.join("flow.svg")).unwrap();
    assert!(picture.contains("full colour at"), "the legend tells what the colours mean");
    assert!(picture.matches("<image").count() >= 2, "the colours lie over the picture");
}

#[test]
fn a_run_ends_with_its_conclusion_where_there_is_no_motion_model() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::create_dir(here.join("flat")).unwrap();
    for i in 0..3 {
        image::GrayImage::from_pixel(96, 64, image::Luma([120])).save(here.join(format!("flat/{i}.png"))).unwrap();
    }
    for (id, why) in [
        ("global-motion", "0 of the needed 4 matches"),
        ("epipolar-geometry", "0 of the needed 7 matches"),
        ("phase-correlation", "unknown"),
        ("image-alignment", "unknown"),
        ("stabilization", "Pairs without a usable motion, which count as at rest: 2 of 2"),
        ("mosaic", "Pairs without a usable motion, which count as at rest: 2 of 2"),
    ] {
        let text = stdout(here, &format!("run flat --estimator {id}"));
        let line = text.lines().find_map(|line| line.strip_prefix("conclusion  "));
        assert!(line.is_some_and(|line| line.contains(why)), "{id}: {text}");
        assert_eq!(json(here, &format!("run flat --estimator {id} --json"))["conclusion"].as_str(), line, "{id}");
    }
    assert!(!stdout(here, &format!("run {SMALL} --estimator horn-schunck")).contains("conclusion"));
}

#[test]
fn features_are_written_and_assessed_without_what_only_fields_have() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (id, status) in [("harris", "found"), ("shi-tomasi", "found"), ("pyramidal-lucas-kanade", "tracked")] {
        let line = format!("run {SMALL} --estimator {id} --set max-points=40");
        let told = json(here, &format!("{line} --table {id}.csv --overlay {id}.png --json"));
        let metrics = &told["metrics"];
        for name in ["psnr_db", "frame_bits", "residual_bits", "vector_bits", "candidates"] {
            assert!(metrics[name].is_null(), "{id} has no {name}: {metrics}");
        }
        let is_tracked = status == "tracked";
        assert!(
            metrics["tracked"].is_u64() == is_tracked && metrics["epe_median_px"].is_f64() == is_tracked,
            "{metrics}"
        );
        let table = fs::read_to_string(here.join(format!("{id}.csv"))).unwrap();
        let columns = if is_tracked { "" } else { ",response" };
        let head = format!("x_px,y_px,u_px,v_px,status,residual{columns}\n");
        assert!(table.starts_with(&head) && table.contains(status), "{table}");
        assert_eq!(
            table.lines().count() as u64 - 1,
            metrics["points"].as_u64().unwrap(),
            "{id}: a row for each feature"
        );
        // What goes nowhere is no flow.
        if !is_tracked {
            assert!(refusal(here, &format!("{line} --flow {id}.flo")).contains("no flow"), "{id}");
            assert!(!here.join(format!("{id}.flo")).exists());
        }
        let text = stdout(here, &line);
        assert!(text.contains("features ") && !text.contains("prediction") && !text.contains("entropy"), "{text}");
        assert_eq!(text.contains("error "), is_tracked, "{text}");
    }
}

#[test]
fn estimators_in_lockstep_are_drawn_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = "[[beside]]\nestimator = \"diamond\"\n[[beside]]\nestimator = \"three-step\"\n";
    let session = format!("motionscope = 1\nclip = \"{SMALL}\"\nestimator = \"full-search\"\nstep = \"5.4\"\n{text}");
    fs::write(here.join("lesson.motionscope"), session).unwrap();
    let run = |what: &str, out: &str| {
        stdout(here, &format!("run {what} --overlay {out}"));
        let picture = image::open(here.join(out)).unwrap();
        (picture.width(), picture.height(), picture.into_rgb8().into_raw())
    };
    let of = |ids: &str, step: &str| format!("{SMALL} --estimator full-search --beside {ids} --step {step}");
    let three = run(&of("diamond,three-step", "5.4"), "three.png");
    assert!(three == run("lesson.motionscope", "session.png"), "a session keeps who stands there");
    assert!(three != run(&of("diamond,three-step", "5.5"), "next.png"), "one candidate more is seen");
    assert!(three != run(&(of("diamond,three-step", "5.4") + " --pace budget"), "budget.png"));
    let [two, four] = ["diamond", "diamond,three-step,hexagon"].map(|ids| run(&of(ids, "5.4"), "more.png"));
    assert!(three.0 >= 3 * 64 && three.1 < 2 * 48 + 100, "in a row: {}×{}", three.0, three.1);
    assert!(four.1 > two.1 + 48 && four.0 == two.0, "two by two: {}×{}", four.0, four.1);
    let steps = stdout(
        here,
        &format!("export {SMALL} --estimator full-search --beside diamond --steps 5..5 --every step --out steps"),
    );
    let last = fs::read_dir(here.join("steps")).unwrap().count();
    assert_eq!(steps.trim(), format!("{last} pictures in steps"));
    let end = run(&of("diamond", "5"), "end.png");
    let written = image::open(here.join(format!("steps/step_{:05}.png", last - 1))).unwrap();
    assert!(written.into_rgb8().into_raw() == end.2, "the last step is the block's end");
}

#[test]
fn flows_in_lockstep_have_a_difference() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let of = |more: &str, out: &str| {
        let flows = "--estimator horn-schunck --beside horn-schunck --set 2.alpha=40 --pace result";
        stdout(here, &format!("run {SMALL} {flows} {more} --overlay {out}"));
        image::open(here.join(out)).unwrap().into_rgb8()
    };
    let [wheel, difference] = [("", "wheel.png"), ("--layer difference", "difference.png")].map(|(m, o)| of(m, o));
    let changed = |from: u32, to: u32| {
        let same = |x: u32| (0..wheel.height()).all(|y| wheel.get_pixel(x, y) == difference.get_pixel(x, y));
        (from..to).filter(|x| !same(*x)).count()
    };
    // The second picture of 64 px stands behind a margin, the first one and a gap.
    assert!(changed(88, 88 + 64) > 30, "the second shows its difference from the first");
    let refused = refusal(here, &format!("run {SMALL} --estimator horn-schunck --layer difference --overlay no.png"));
    assert!(refused.contains("it compares estimators in lockstep"), "{refused}");
}

#[test]
fn quantities_of_a_background_model_are_layers() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let of = |layer: &str| {
        let run = "run synth:traffic --estimator mixture-of-gaussians --step 6 --view current --legend";
        stdout(here, &format!("{run} --layer {layer} --overlay {layer}.png"));
        fs::read(here.join(format!("{layer}.png"))).unwrap()
    };
    let all = ["none", "deviation", "weight", "mode-count"].map(of);
    assert!((0..4).all(|i| all[..i].iter().all(|other| *other != all[i])), "each looks different");
    let refused = refusal(here, "run synth:traffic --estimator median-background --layer weight --overlay no.png");
    assert!(refused.contains("no model with this quantity"), "{refused}");
}

#[test]
fn an_export_that_is_refused_makes_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    refusal(folder.path(), &format!("export {SMALL} --estimator full-search --steps 99..100 --out steps"));
    assert!(!folder.path().join("steps").exists());
}

#[test]
fn glossary_defines_the_terms_of_the_course() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let all = stdout(here, "glossary");
    let chapters = ["Dynamic scene analysis\n", "Estimating motion vectors\n", "Kalman filters\n", "Evaluation\n"];
    let places: Vec<_> = chapters.iter().map(|chapter| all.find(chapter).expect("a chapter")).collect();
    assert!(places.is_sorted(), "{places:?}");
    assert!(all.contains("\n  aperture problem\n      The ambiguity"));
    let one = stdout(here, "glossary structure tensor");
    assert!(one.starts_with("structure tensor  [T]\n  The 2×2 matrix"), "{one}");
    assert!(
        one.contains("\n  Chapter: Differential motion analysis\n  Also: ") && one.contains("second-moment matrix")
    );
    assert!(stdout(here, "glossary sequential search").starts_with("full search\n"));
}

#[test]
fn glossary_answers_scripts_and_slips() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let all = json(here, "glossary --json");
    assert!(all.as_array().unwrap().len() >= 140);
    let keys = ["term", "aliases", "symbol", "definition", "chapter"];
    assert!(all.as_array().unwrap().iter().all(|term| keys.iter().all(|key| term.get(key).is_some())));
    let one = json(here, "glossary SAD --json");
    assert_eq!((&one["term"], &one["symbol"]), (&"sum of absolute differences".into(), &Value::Null));
    assert!(refusal(here, "glossary eigenvalu").contains("the nearest is eigenvalue"));
    assert!(refusal(here, "glossary Kalman").contains("Kalman gain"));
}

#[test]
fn help_has_examples() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["", "list", "glossary", "search", "info", "synth", "run", "compare", "export"] {
        assert!(stdout(folder.path(), &format!("{command} --help")).contains("Examples:"));
    }
}

#[test]
fn a_picture_shows_the_level_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let start = format!("motionscope = 1\nclip = \"{SMALL}\"\nestimator = \"hierarchical\"\nstep = \"1.4\"\n");
    let session = format!("{start}[set]\nblock-size = 8\nlevels = 3\n[picture]\nlevel = 1\n");
    fs::write(here.join("lesson.motionscope"), session).unwrap();
    let run = |level: &str| {
        stdout(here, &format!("run lesson.motionscope {level} --overlay out.png"));
        image::open(here.join("out.png")).unwrap().into_rgb8().into_raw()
    };
    let [picture, one, two] = ["--level 0", "--level 1", "--level 2"].map(run);
    assert!(picture != one && one != two && two != picture);
    assert!(run("") == one, "a session keeps its level");
    assert!(run("--level at-work") == two, "the first units are those of the coarsest level");
    assert!(run("--level 2 --step 0") != run("--level at-work --step 0"), "nothing is at work yet");
}

#[test]
fn a_run_through_several_frames_tells_its_tracks() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "run synth:translation,frames=5,width=160,height=120 --estimator klt --frame 1 --json --table tracks.csv";
    let run = json(folder.path(), line);
    assert_eq!((&run["frame"], &run["last_frame"]), (&1.into(), &4.into()));
    let (all, alive) = (run["metrics"]["points"].as_u64().unwrap(), run["metrics"]["tracked"].as_u64().unwrap());
    assert!(alive > 20 && all >= alive, "{all} tracks, {alive} to the end");
    assert!(run["metrics"]["epe_px"].as_f64().unwrap() < 0.05, "{}", run["metrics"]);
    let table = fs::read_to_string(folder.path().join("tracks.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("track,frame,x_px,y_px,u_px,v_px,status,residual"));
    assert!(lines.clone().all(|line| line.split(',').count() == 8));
    assert_eq!(
        lines.filter(|line| line.split(',').nth(1) == Some("4") && line.contains(",found,")).count() as u64,
        alive
    );
    // The picture shows the pair at hand, not the first one.
    let picture = |step: &str| {
        let name = format!("{step}.png");
        let line = format!("{line} --step {step} --overlay {name}").replace(" --json", "");
        stdout(folder.path(), &line);
        fs::read(folder.path().join(name)).unwrap()
    };
    assert_ne!(picture("1"), picture("200"));
}

/// Two objects that cross, each detected in every frame but the fourth, and their truth.
fn crossing(folder: &Path) {
    let (mut found, mut known) = (String::new(), String::new());
    for t in 1..=12 {
        for (id, x) in [(1, 20 + 6 * t), (2, 140 - 6 * t)] {
            let y = 20 + 40 * (id - 1);
            known += &format!("{t},{id},{x},{y},20,40,1,1,1\n");
            if t != 4 {
                found += &format!("{t},-1,{},{y},20,40,0.9,-1,-1,-1\n", x + t % 2);
            }
        }
    }
    fs::write(folder.join("det.txt"), found).expect("it is written");
    fs::write(folder.join("gt.txt"), known).expect("it is written");
}

#[test]
fn objects_are_tracked_from_detections_alone_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    crossing(folder.path());
    let line =
        "run --detections det.txt --truth gt.txt --estimator kalman-tracker --tracks out.txt --table out.csv --json";
    let told = json(folder.path(), line);
    let metrics = &told["metrics"];
    assert_eq!(
        (&metrics["objects"], &metrics["switches"], &metrics["true_objects"]),
        (&2.into(), &0.into(), &24.into())
    );
    assert!(metrics["mota"].as_f64().unwrap() > 0.95 && metrics["idf1"].as_f64().unwrap() > 0.95, "{metrics}");
    assert!(metrics["epe_px"].is_null() && told["last_frame"] == 11);
    let rows = fs::read_to_string(folder.path().join("out.txt")).unwrap();
    assert!(rows.starts_with("1,1,") && rows.lines().all(|row| row.ends_with(",1,-1,-1,-1")), "{rows}");
    let table = fs::read_to_string(folder.path().join("out.csv")).unwrap();
    assert!(
        table.starts_with("frame,id,x_px,y_px,u_px_per_frame,v_px_per_frame,") && table.contains(",confirmed,"),
        "{table}"
    );
    let text = stdout(folder.path(), "run det.txt --estimator kalman-tracker");
    assert!(text.contains("mota, motp") && text.contains("identity switches  0\n"), "{text}");
    // Without looking back only the frame in which nothing was found is missing: the first frames of a run count at once.
    let share = 2.0 * (12.0 - 1.0) / 24.0;
    assert_eq!((&metrics["recall"], &told["live"]["recall"]), (&1.0.into(), &share.into()), "{told}");
    assert!(text.contains("live        MOTA ") && text.contains("without hindsight"), "{text}");
    let causal = "run det.txt --truth gt.txt --estimator kalman-tracker --set interpolate=off --set backdate=off";
    assert!(!stdout(folder.path(), causal).contains("live "));
    let part = json(folder.path(), "run det.txt --estimator kalman-filter --frames 2..7 --json");
    assert_eq!((&part["frame"], &part["last_frame"], &part["metrics"]["objects"]), (&2.into(), &7.into(), &1.into()));
}

#[test]
fn whoever_finds_nobody_is_scored_and_has_a_table_with_the_same_columns() {
    let folder = tempfile::tempdir().unwrap();
    crossing(folder.path());
    let line = "run det.txt --truth gt.txt --estimator kalman-tracker --set min-score=900 --table out.csv --json";
    let told = json(folder.path(), line);
    assert_eq!((&told["metrics"]["mota"], &told["metrics"]["recall"]), (&0.0.into(), &0.0.into()), "{told}");
    let table = fs::read_to_string(folder.path().join("out.csv")).unwrap();
    assert!(table.starts_with("frame,id,x_px,y_px,u_px_per_frame,"), "{table}");
    // A detector follows nobody.
    let detector = "run synth:traffic,width=160,height=120,frames=6 --estimator frame-difference";
    assert!(json(folder.path(), &format!("{detector} --json"))["metrics"]["mota"].is_null());
    assert!(refusal(folder.path(), &format!("{detector} --tracks t.txt")).contains("choose a tracker"));
    assert!(!folder.path().join("t.txt").exists());
    let long: String = (1..=20_001).map(|t| format!("{t},-1,9,9,9,9,1\n")).collect();
    fs::write(folder.path().join("long.txt"), long).unwrap();
    let told = refusal(folder.path(), "run long.txt --estimator kalman-tracker --frames 0..20000");
    assert!(told.contains("frames") && told.contains("10\u{202f}000") && !told.contains("one pair"), "{told}");
}

#[test]
fn masks_are_written_one_for_each_frame() {
    let folder = tempfile::tempdir().unwrap();
    let clip = "synth:traffic,width=160,height=120,frames=6";
    let line = format!("run {clip} --estimator frame-difference --frames 1..4 --masks masks --table blobs.csv --json");
    let told = json(folder.path(), &line);
    assert_eq!(told["metrics"]["frames"], 4);
    let mut names: Vec<_> = fs::read_dir(folder.path().join("masks"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["mask_0001.png", "mask_0002.png", "mask_0003.png", "mask_0004.png"]);
    let mask = open(&folder.path().join("masks/mask_0003.png"), &Open::default()).unwrap().clip;
    assert_eq!(mask.size(), (160, 120));
    assert!(mask.frame(0).unwrap().luma().cells().iter().all(|gray| [0, 255].contains(gray)));
    let table = fs::read_to_string(folder.path().join("blobs.csv")).unwrap();
    assert!(table.starts_with("frame,x_px,y_px,left_px,"), "{table}");
}

#[test]
fn a_comparison_begins_on_the_pair_whose_truth_is_known() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), "synth translation,width=64,height=48,frames=6 --out clip");
    // As where a benchmark knows one pair alone.
    for t in [0, 1, 2, 4] {
        fs::remove_file(folder.path().join(format!("clip/flow/frame_{t:04}.flo"))).unwrap();
    }
    let run = json(folder.path(), "run clip --estimator full-search --json");
    assert_eq!((&run["frame"], run["metrics"]["epe_px"].is_f64()), (&3.into(), true));
    let error = |line: &str| json(folder.path(), line)[0]["epe_px"].clone();
    assert_eq!(error("compare clip --estimators full-search --json"), run["metrics"]["epe_px"]);
    assert!(error("compare clip --estimators full-search --frame 0 --json").is_null());
}

#[test]
fn frames_that_repeat_the_one_before_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &format!("synth {} --out clip", SMALL.trim_start_matches("synth:")));
    let frame = |t: usize| folder.path().join(format!("clip/frame_{t:04}.png"));
    let repeats = || json(folder.path(), "info clip --json")["repeats"].clone();
    let warned = |line: &str| String::from_utf8(motionscope(folder.path(), line).stderr).unwrap().contains("identical");
    assert_eq!(repeats(), serde_json::json!({ "identical": 0, "compared": 2 }));
    assert!(!warned("run clip --estimator full-search"));
    fs::copy(frame(0), frame(1)).unwrap();
    assert_eq!(repeats(), serde_json::json!({ "identical": 1, "compared": 2 }));
    assert!(warned("run clip --estimator full-search --frame 0"));
    assert!(!warned("run clip --estimator full-search --frame 1"));
}

#[test]
fn a_clip_of_ones_own_asks_for_the_box_of_the_object() {
    let folder = tempfile::tempdir().unwrap();
    stdout(folder.path(), &format!("synth {} --out clip", SMALL.trim_start_matches("synth:")));
    let own = Source::parse(folder.path().join("clip")).unwrap();
    let bundled = Source::parse("synth:translation").unwrap();
    let mut asked = Vec::new();
    for mut estimator in estimators() {
        let clip = own.open(&Open::default()).unwrap().clip;
        let is_zone = |spec: &&Spec| matches!(spec.kind, Kind::Placed(Figure::Zone));
        let zone = estimator.specs().iter().find(is_zone).map(|spec| spec.name.clone());
        let id = estimator.info().id;
        let name = unplaced(&*estimator, (&own, &clip), 0).map(|spec| spec.name.clone());
        assert_eq!(name, zone, "{id}");
        assert!(unplaced(&*estimator, (&bundled, &clip), 0).is_none(), "{id} on a bundled scene");
        let Some(zone) = zone else { continue };
        estimator.set(&zone, "10,10,40,40").unwrap();
        assert!(unplaced(&*estimator, (&own, &clip), 0).is_none(), "{id} with its {zone}");
        if estimator.set("contour", "10,10 40,10 40,40 10,40").is_ok() {
            estimator.set(&zone, "none").unwrap();
            assert!(unplaced(&*estimator, (&own, &clip), 0).is_none(), "{id} with a contour");
        }
        asked.push(id);
    }
    assert!(asked.len() >= 9 && ["camshift", "template-matching"].iter().all(|id| asked.contains(id)), "{asked:?}");
    let warned = |line: &str| String::from_utf8(motionscope(folder.path(), line).stderr).unwrap();
    for (id, name) in [("mean-shift", "region"), ("template-matching", "template")] {
        let said = warned(&format!("run clip --estimator {id} --set frames=2"));
        let asks = format!("give --set {name}=LEFT,TOP,RIGHT,BOTTOM");
        assert!(said.lines().count() == 1 && said.contains(&asks), "{id}: {said}");
        let placed = warned(&format!("run clip --estimator {id} --set frames=2 --set {name}=10,8,40,38"));
        assert!(!placed.contains("LEFT,TOP"), "{id}: {placed}");
        assert!(!warned(&format!("run {SMALL} --estimator {id} --set frames=2")).contains("LEFT,TOP"), "{id}");
    }
    assert!(warned("compare clip --estimators mean-shift").contains("LEFT,TOP,RIGHT,BOTTOM"));
}

#[test]
fn what_is_wrong_with_detections_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    crossing(folder.path());
    // No truth lies beside it there.
    fs::create_dir(folder.path().join("alone")).unwrap();
    fs::copy(folder.path().join("det.txt"), folder.path().join("alone/det.txt")).unwrap();
    fs::write(folder.path().join("bad.txt"), "1,-1,10,10,20,40,0.9\n2,-1,10,10,x,40,0.9\n").unwrap();
    fs::write(folder.path().join("head.txt"), "frame,id,x,y,w,h\n1,-1,10,10,20,40,0.9\n").unwrap();
    for (line, told) in [
        ("run --detections bad.txt --estimator kalman-tracker", "line 2"),
        ("run --detections none.txt --estimator kalman-tracker", "none.txt"),
        ("run --estimator kalman-tracker", "required"),
        ("run det.txt --estimator full-search --frames 0..3", "--frame "),
        ("run det.txt --estimator kalman-tracker --tracks a.png", ".npy"),
        ("run det.txt --estimator trajectory-analysis --set lines=1,2,3", "x,y,x,y"),
        ("run det.txt --estimator full-search --flow a.flo", "no frames"),
        ("run synth:traffic,frames=2 --estimator full-search --tracks a.txt", "makes block vectors"),
        ("run det.txt --estimator kalman-tracker --masks m", "makes objects"),
        ("run alone/det.txt --estimator kalman-tracker --set source=truth", "no true objects"),
        ("run alone/det.txt --estimator kalman-filter --set sensors=two-positions", "no true objects"),
        ("run det.txt --estimator kalman-tracker --frames 5..5", "needs A < B"),
        ("run det.txt --estimator kalman-tracker --frames 5..99", "exceeds the last frame, 11"),
    ] {
        let output = motionscope(folder.path(), line);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && error.contains(told), "{line}: {error}");
    }
    // Names of columns are no damage.
    let named = motionscope(folder.path(), "run --detections head.txt --estimator kalman-tracker");
    assert!(named.status.success(), "{}", String::from_utf8_lossy(&named.stderr));
    assert!(!folder.path().join("a.txt").exists());
}

/// Width and height of a PNG file.
fn png_size(path: &Path) -> [u32; 2] {
    let bytes = fs::read(path).expect("a file");
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes")))
}

#[test]
fn panes_are_arranged_on_a_sheet_and_its_words_stay_words() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let panes = "--panes stage,explanation,surface,surface-3d,series,tiles";
    let line = format!("run {SMALL} --estimator full-search --step 5.40 {panes}");
    stdout(here, &format!("{line} --overlay outlines.svg"));
    let outlines = fs::read_to_string(here.join("outlines.svg")).unwrap();
    assert!(!outlines.contains("<text") && !outlines.contains("font-family"), "outlines need no font");
    stdout(here, &format!("{line} --svg-text live --overlay sheet.svg"));
    let svg = fs::read_to_string(here.join("sheet.svg")).unwrap();
    let words = [
        "Full search · SAD by displacement",
        "Full search · Cost by candidate, SAD",
        "u, px →",
        "v, px ↓",
        "Best so far",
        "Frame t = 0",
        "step 5.40",
    ];
    for words in words {
        assert!(svg.contains(&format!(">{words}</tspan>")), "{words} is missing");
        assert!(outlines.contains(&format!("aria-label=\"{words}\"")), "{words} is missing");
    }
    stdout(here, &format!("{line} --overlay sheet.pdf"));
    let pdf = fs::read(here.join("sheet.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF-") && String::from_utf8_lossy(&pdf).contains("/ToUnicode"));
    let piped = motionscope(here, &format!("{line} --overlay - --format pdf")).stdout;
    assert!(piped == pdf, "the same figure gives the same bytes");
    stdout(here, &format!("{line} --overlay one.png"));
    stdout(here, &format!("{line} --overlay two.png --scale 2"));
    let [one, two] = ["one.png", "two.png"].map(|name| png_size(&here.join(name)));
    assert_eq!(one.map(|side| 2 * side), two);
    assert!(one[0] >= 1280 && one[1] >= 720, "{one:?}");
    let export = format!("export {SMALL} --estimator full-search --steps 5.38..5.40 --panes stage,surface");
    stdout(here, &format!("{export} --out steps --format pdf"));
    for index in 0..3 {
        assert!(fs::read(here.join(format!("steps/step_0000{index}.pdf"))).unwrap().starts_with(b"%PDF-"));
    }
}

#[test]
fn sheets_of_several_steps_have_one_size() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let one = format!("{SMALL} --estimator kalman-filter");
    for (name, line) in [
        ("plain", format!("{one} --steps 0..3 --panes stage,matrices,series")),
        ("told", format!("{one} --steps 0..3 --panes stage,explanation,matrices,series")),
        ("search", format!("{SMALL} --estimator full-search --steps 5.1..5.9 --panes stage,surface,tiles")),
    ] {
        stdout(here, &format!("export {line} --out {name}"));
        let all: Vec<_> = fs::read_dir(here.join(name)).unwrap().map(|entry| entry.unwrap().path()).collect();
        let sizes: Vec<_> = all.iter().map(|path| png_size(path)).collect();
        assert!(sizes.len() > 2 && sizes.iter().all(|size| *size == sizes[0]), "{name}: {sizes:?}");
    }
}

#[test]
fn a_pane_that_is_not_there_is_reported_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let run = format!("run {SMALL} --estimator full-search --overlay a.png --panes");
    let cases = [
        (format!("{run} stage,serie"), "there is no pane serie; there are stage, explanation"),
        (format!("{run} plane"), "full-search never has the pane plane; its panes are stage"),
        (
            format!("{run} stage,surface --step 0"),
            "full-search has no content for the pane surface at this step: it shows the cost",
        ),
        (format!("run {SMALL} --estimator full-search --panes stage"), "add --overlay FILE"),
        (format!("run {SMALL} --estimator full-search --overlay a.txt"), ".png, .svg or .pdf"),
        (format!("run {SMALL} --estimator full-search --overlay a --format tiff"), "png, svg and pdf, not tiff"),
        (
            format!("export {SMALL} --estimator full-search --steps 5..6 --out b --panes matrices"),
            "never has the pane matrices",
        ),
    ];
    for (line, words) in cases {
        let told = refusal(folder.path(), &line);
        assert!(told.contains(words), "{line}: {told}");
    }
    assert!(fs::read_dir(folder.path()).unwrap().next().is_none(), "nothing was written");
}

#[test]
fn words_are_searched_in_all_texts() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = stdout(here, "search kalman gain");
    assert!(text.contains("Glossary") && text.contains("motionscope glossary Kalman gain"), "{text}");
    let all = json(here, "search misprint --json");
    let hits = all.as_array().expect("an array");
    for hit in hits {
        for key in ["kind", "title", "place", "excerpt", "arguments"] {
            assert!(hit[key].as_str().is_some_and(|text| !text.is_empty()), "{key} of {hit}");
        }
    }
    let page = hits.iter().find(|hit| hit["kind"] == "page").expect("a page of a lesson");
    let lesson = stdout(here, &format!("lessons {}", page["arguments"].as_str().unwrap()));
    assert!(lesson.contains(page["title"].as_str().unwrap()));
    assert!(refusal(here, "search xyzzy").contains("nothing has all words of xyzzy; try fewer words"));
    let said = refusal(here, "search kalmann gain");
    assert!(said.contains("nothing has all words of kalmann gain; did you mean Kalman gain?"), "{said}");
    assert_eq!(stdout(here, "search xyzzy --json").trim(), "[]");
}

/// Rows of a MOTChallenge table: two objects in 8 frames, with `more` behind each row.
fn two_objects(first: usize, more: &str) -> String {
    let row = |t: usize, id: i64, x: usize| format!("{},{id},{x},22,20,30{more}\n", first + t);
    (0..8).flat_map(|t| [row(t, 1, 75 + 5 * t), row(t, 2, 135 + 5 * t)]).collect()
}

#[test]
fn what_a_benchmark_leaves_out_is_neither_right_nor_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let ignored: String =
        (1..=8).map(|t| format!("{t},50,300,200,20,50,1,7,1\n{t},51,400,200,20,50,0,1,1\n")).collect();
    fs::write(here.join("gt.txt"), two_objects(1, ",1,1,1") + &ignored).unwrap();
    let detected = (1..=8).map(|t| format!("{t},-1,300,200,20,50,0.9\n{t},-1,400,200,20,50,0.9\n")).collect::<String>();
    fs::write(here.join("det.txt"), two_objects(1, ",0.9").replace(",1,", ",-1,").replace(",2,", ",-1,") + &detected)
        .unwrap();
    let metrics = |truth: &str| {
        json(here, &format!("run --detections det.txt --truth {truth} --estimator kalman-tracker --json"))["metrics"]
            .clone()
    };
    let found = metrics("gt.txt");
    assert_eq!(
        (&found["mota"], &found["precision"], &found["idf1"]),
        (&1.0.into(), &1.0.into(), &1.0.into()),
        "{found}"
    );
    // Without these marks the same tracks are false alarms.
    fs::write(here.join("plain.txt"), two_objects(1, ",1,1,1")).unwrap();
    assert!(metrics("plain.txt")["mota"].as_f64().unwrap() < 0.5);
    // One identity twice in a frame.
    fs::write(here.join("twice.txt"), two_objects(1, ",1,1,1") + "1,2,9,9,20,30,1,1,1\n").unwrap();
    let told = refusal(here, "run --detections det.txt --truth twice.txt --estimator kalman-tracker --json");
    assert!(told.contains("lines 2 and 17") && told.contains("identity 2"), "{told}");
    // A truth of other frames scores nothing, which is no zero.
    fs::write(here.join("late.txt"), two_objects(1001, ",1,1,1")).unwrap();
    let late = motionscope(here, "run --detections det.txt --truth late.txt --estimator kalman-tracker --json");
    assert!(String::from_utf8_lossy(&late.stderr).starts_with("warning: the ground truth has no box"));
    let late: Value = serde_json::from_slice(&late.stdout).expect("JSON");
    assert!(late["metrics"]["mota"].is_null() && late["metrics"]["objects"].is_u64(), "{late}");
}

#[test]
fn text_for_a_terminal_has_no_commands_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let escapes = "\u{1b}]52;c;aGk=\u{7}\u{9b}31m\u{202e}";
    let text = format!(
        "# Title{escapes}\nSummary{escapes}.\n+++\ntitle = \"One\"\nclip = \"synth:pillar\"\nestimator = \"diamond\"\n+++\nWords{escapes}.\n"
    );
    fs::write(here.join("odd.md"), text).unwrap();
    for line in ["lessons odd.md", "lessons odd.md --json", "info odd.md", "run odd.md --json"] {
        let output = motionscope(here, line);
        for stream in [&output.stdout, &output.stderr] {
            let text = String::from_utf8_lossy(stream);
            let is_command = |c: char| c.is_control() && !matches!(c, '\n' | '\t') || c == '\u{202e}';
            assert!(!text.chars().any(is_command), "{line}: {text:?}");
        }
    }
}

#[test]
fn names_that_are_seen_in_the_window_work() {
    let folder = tempfile::tempdir().unwrap();
    let run = |line: &str| json(folder.path(), line)["estimator"].as_str().unwrap().to_owned();
    let settings = "--set block-size=8 --json";
    assert_eq!(run(&format!("run {SMALL} --estimator hierarchical-search {settings}")), "hierarchical");
    assert_eq!(run(&format!("run {SMALL} --estimator Diamond-search {settings}")), "diamond");
    assert!(stdout(folder.path(), "info Marble").contains("frames"));
    assert!(refusal(folder.path(), "info Marbles").contains("Marbles"));
    // In a session it is a file, wherever the program was started.
    fs::write(folder.path().join("a.motionscope"), "motionscope = 1\nclip = \"Marble\"\nestimator = \"diamond\"\n")
        .unwrap();
    assert!(refusal(folder.path(), "run a.motionscope").contains("Marble"));
}

#[test]
fn texts_with_a_mark_of_their_encoding_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let lesson =
        "# Title\nWords.\n+++\ntitle = \"One\"\nclip = \"synth:pillar\"\nestimator = \"diamond\"\n+++\nWords.\n";
    let session = "motionscope = 1\nclip = \"synth:pillar,width=64,height=48,frames=2\"\nestimator = \"diamond\"\n";
    fs::write(here.join("a.md"), format!("\u{feff}{lesson}")).unwrap();
    fs::write(here.join("a.motionscope"), format!("\u{feff}{session}")).unwrap();
    fs::write(
        here.join("det.txt"),
        format!("\u{feff}{}", two_objects(1, ",0.9").replace(",1,", ",-1,").replace(",2,", ",-1,")),
    )
    .unwrap();
    fs::write(here.join("gt.txt"), format!("\u{feff}{}", two_objects(1, ",1,1,1"))).unwrap();
    assert!(stdout(here, "lessons a.md").contains("One"));
    json(here, "run a.motionscope --json");
    let found = json(here, "run --detections det.txt --truth gt.txt --estimator kalman-tracker --json");
    assert_eq!(found["metrics"]["mota"], 1.0);
    fs::write(here.join("wide.md"), [0xFF, 0xFE, b'#', 0]).unwrap();
    assert!(refusal(here, "lessons wide.md").contains("UTF-16"));
}

#[test]
fn the_run_begins_on_the_pair_whose_flow_is_known_as_in_the_window() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    stdout(here, "synth translation --out clip --set width=64 --set height=48 --set frames=5");
    for t in [0, 1, 3] {
        fs::remove_file(here.join(format!("clip/flow/frame_{t:04}.flo"))).unwrap();
    }
    let run = |more: &str| json(here, &format!("run clip --estimator full-search --json {more}"));
    let found = run("");
    assert_eq!(found["frame"], 2);
    assert!(found["metrics"]["epe_px"].is_f64(), "{found}");
    assert_eq!(run("--frame 0")["frame"], 0, "unless another one is asked for");
}

#[test]
fn long_words_and_many_lines_are_read_in_time_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let begun = std::time::Instant::now();
    let keys: String = (0..50_000).map(|i| format!("k{i} = {i}\n")).collect();
    let session = format!("motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"full-search\"\n[set]\n{keys}");
    fs::write(here.join("keys.motionscope"), session).unwrap();
    assert!(refusal(here, "info keys.motionscope").contains("line 5"));
    let title = format!(
        "# {}\n+++\ntitle = \"One\"\nclip = \"synth:pillar\"\nestimator = \"diamond\"\n+++\nWords.\n",
        "a".repeat(20_000)
    );
    fs::write(here.join("title.md"), title).unwrap();
    assert!(refusal(here, "export title.md --handout h.pdf").contains("200 letters"));
    for line in ["glossary", "search"] {
        assert!(refusal(here, &format!("{line} {}", "b".repeat(100_000))).contains("300"));
    }
    // Quadratic readers took minutes.
    assert!(begun.elapsed().as_secs() < 20, "{:?}", begun.elapsed());
}

#[cfg(unix)]
#[test]
fn a_helper_that_floods_is_not_read_without_end() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let helper = here.join("ffprobe");
    fs::write(&helper, "#!/bin/sh\nexec yes '{'\n").unwrap();
    fs::set_permissions(&helper, fs::Permissions::from_mode(0o755)).unwrap();
    fs::write(here.join("clip.xyz"), b"no video at all").unwrap();
    let path = format!("{}:/usr/bin:/bin", here.display());
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    let output = command.current_dir(here).env("PATH", path).args(["info", "clip.xyz"]).output().expect("it starts");
    assert!(!output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr).lines().count(), 1);
}

#[test]
fn json_keeps_what_a_terminal_must_not_see() {
    let folder = tempfile::tempdir().unwrap();
    let title = "a\u{1b}]0;b\u{7}\u{9b}31m\u{7f}\u{202e}c";
    let text =
        format!("# {title}\nS.\n+++\ntitle = \"One\"\nclip = \"synth:pillar\"\nestimator = \"diamond\"\n+++\nW.\n");
    fs::write(folder.path().join("odd.md"), text).unwrap();
    assert_eq!(json(folder.path(), "lessons odd.md --json")["title"], title);
}

#[cfg(unix)]
#[test]
fn a_session_opens_no_pipe_and_no_device() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    assert!(Command::new("mkfifo").arg(here.join("pipe.y4m")).status().expect("mkfifo").success());
    let run = "estimator = \"full-search\"\n";
    for (keys, named) in [
        ("clip = \"pipe.y4m\"\n", "pipe.y4m"),
        ("clip = \"/dev/zero\"\n", "/dev/zero"),
        ("clip = \"synth:pillar\"\ntruth = \"pipe.y4m\"\n", "pipe.y4m"),
        ("clip = \"synth:pillar\"\ncalibration = \"pipe.y4m\"\n", "pipe.y4m"),
        ("clip = \"synth:pillar\"\ndepths = \"/dev/zero\"\n", "/dev/zero"),
    ] {
        fs::write(here.join("odd.motionscope"), format!("motionscope = 1\n{keys}{run}")).unwrap();
        for trust in ["", " --trust"] {
            let told = refusal(here, &format!("run odd.motionscope{trust}"));
            assert!(told.contains(named), "{told}");
        }
        fs::write(here.join("odd.md"), format!("# T\nS.\n+++\ntitle = \"One\"\n{keys}{run}+++\nW.\n")).unwrap();
        let told = refusal(here, "lessons odd.md");
        assert!(told.contains(named), "{told}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_the_limit_of_the_address_space_forbids_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // Two gray pictures of 36 megapixels: Horn–Schunck takes gigabytes for them.
    for (name, level) in [("a.pgm", 7), ("b.pgm", 9)] {
        fs::write(here.join(name), [b"P5\n6000 6000\n255\n".to_vec(), vec![level; 6000 * 6000]].concat()).unwrap();
    }
    let limited = |kilobytes: u32, line: &str| {
        let script = format!("ulimit -v {kilobytes}; exec \"$0\" {line}");
        let mut command = Command::new("sh");
        command.current_dir(here).args(["-c", &script, env!("CARGO_BIN_EXE_motionscope")]);
        command.output().expect("the program starts")
    };
    for (kilobytes, line) in
        [(2_000_000, "run a.pgm b.pgm --estimator horn-schunck --threads 1"), (400_000, "info a.pgm")]
    {
        let output = limited(kilobytes, line);
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line}: {told}");
        assert!(told.contains("of memory") && told.contains("free") && told.lines().count() == 1, "{line}: {told}");
    }
}

#[test]
fn long_settings_are_not_repeated_in_full() {
    let folder = tempfile::tempdir().unwrap();
    let long = format!("lambda={}", "0".repeat(4000));
    for line in [
        format!("run {SMALL} --estimator horn-schunck --set {long}"),
        format!("run {SMALL} --estimator full-search --set {long} --set cost=zncc"),
        format!("compare {SMALL} --estimators full-search,diamond --set {long}"),
        format!("synth pillar --out out --set {long}"),
    ] {
        let output = motionscope(folder.path(), &line);
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(told.lines().all(|line| line.chars().count() < 400), "{told}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_whose_name_is_no_unicode_is_told_so() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    let odd = std::ffi::OsStr::from_bytes(b"b\xff.png");
    let output = command.current_dir(folder.path()).arg("info").arg("a.png").arg(odd).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("UTF-8") && !told.contains('|'), "{told}");
}

#[test]
fn files_outside_of_the_folder_of_a_session_or_lesson_need_trust() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    stdout(here, "synth translation --out other --set width=64 --set height=48 --set frames=2");
    fs::create_dir(here.join("theirs")).unwrap();
    let keys = "clip = \"../other\"\nestimator = \"diamond\"\n";
    fs::write(here.join("theirs/a.motionscope"), format!("motionscope = 1\n{keys}")).unwrap();
    fs::write(here.join("theirs/a.md"), format!("# T\n+++\ntitle = \"One\"\n{keys}+++\nWords.\n")).unwrap();
    for line in
        ["run theirs/a.motionscope", "info theirs/a.motionscope", "run theirs/a.md", "export theirs/a.md --out p"]
    {
        let told = refusal(here, line);
        assert!(told.contains("other") && told.contains("--trust"), "{line}: {told}");
        stdout(here, &format!("{line} --trust"));
    }
    // A copy beside its clip names nothing outside.
    fs::write(here.join("other/a.motionscope"), format!("motionscope = 1\n{}", keys.replace("../other", "."))).unwrap();
    stdout(here, "run other/a.motionscope");
}

#[test]
fn a_link_is_printed_and_runs_again() {
    let folder = tempfile::tempdir().unwrap();
    let run = "run synth:pillar,noise=5 --estimator diamond --step 164.14 --set search-range=8 --view blend --link";
    let link = stdout(folder.path(), run);
    let fragment = "#synth:pillar,noise=5&estimator=diamond&step=164.14&picture.view=blend&set.search-range=8";
    assert_eq!(link, format!("https://motionscope.github.io/motionscope/{fragment}\n"));
    let again = stdout(folder.path(), &format!("run {} --link --link-base http://localhost/a/", link.trim()));
    assert_eq!(again, format!("http://localhost/a/{fragment}\n"));
    let page = stdout(folder.path(), "run #lesson:kalman-filter/3 --step 5.2 --link");
    assert!(page.ends_with("#lesson:kalman-filter/3&step=5.2\n"), "{page}");
    assert!(refusal(folder.path(), &format!("{run} --flow f.flo")).contains("--link computes nothing"));
    assert!(refusal(folder.path(), "run # --json").contains("start page"));

    let wrong = motionscope(folder.path(), &format!("run #{SMALL}&estimator=diamond&set.serch-range=8 --json"));
    let told = String::from_utf8(wrong.stderr).expect("text");
    assert!(wrong.status.success() && told.contains("the nearest is search-range"), "{told}");
    let run: Value = serde_json::from_slice(&wrong.stdout).expect("JSON");
    assert_eq!(run["estimator"]["id"].as_str().or(run["estimator"].as_str()), Some("diamond"), "{run}");
    // A link reports its step as --step does.
    let at = |arguments: &str| {
        let printed = stdout(folder.path(), &format!("run {arguments} --json"));
        serde_json::from_str::<Value>(&printed).expect("JSON")["step"].clone()
    };
    let by_link = at(&format!("#{SMALL}&estimator=diamond&step=3.2"));
    assert_eq!(by_link["step"], "3.2");
    assert_eq!(by_link, at(&format!("{SMALL} --estimator diamond --step 3.2")));
}
