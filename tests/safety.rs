//! What a run promises about files: nothing that it reads is written over, and nothing that it wrote is taken for truth.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

/// The program in `folder` with the words of `line`; it is given some time to end.
fn motionscope(folder: &Path, line: &str) -> Output {
    let words: Vec<_> = line.split_whitespace().collect();
    finish(folder, Command::new(env!("CARGO_BIN_EXE_motionscope")).args(words), line)
}

fn finish(folder: &Path, command: &mut Command, line: &str) -> Output {
    let command = command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let begun = Instant::now();
    while child.try_wait().expect("it can be waited for").is_none() {
        if begun.elapsed() > Duration::from_secs(60) {
            child.kill().expect("it can be ended");
            panic!("{line}: no end after a minute");
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.wait_with_output().expect("it has ended")
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
    let told = String::from_utf8(output.stderr).expect("text");
    assert!(!output.status.success() && output.stdout.is_empty(), "{line} is not refused: {told}");
    assert!(told.starts_with("error: ") && told.lines().count() == 1 && told.len() < 300, "{line}: {told}");
    told
}

const SMALL: &str = "synth:translation,width=64,height=48,frames=3";
/// The same as a folder `clip`.
const ON_DISK: &str = "synth translation --set width=64 --set height=48 --set frames=3 --out clip";

fn flo(width: u32, height: u32) -> Vec<u8> {
    let head = [width.to_le_bytes(), height.to_le_bytes()].concat();
    [b"PIEH".to_vec(), head, vec![0; (width * height * 8) as usize]].concat()
}

fn put(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, bytes).expect("a file");
}

/// Rows of two objects in four frames, detected or known.
fn rows(is_known: bool) -> String {
    let row = |t: i32, id: i32| {
        let known = if is_known { id } else { -1 };
        format!("{t},{known},{},{},20,40,1,-1,-1,-1\n", 10 + 6 * t, 20 + 60 * id)
    };
    (1..=4).flat_map(|t| [row(t, 1), row(t, 2)]).collect()
}

/// Every kind of input, in one folder.
fn inputs(here: &Path) {
    stdout(here, ON_DISK);
    let gray = [[9_u8; 64 * 48], [99; 64 * 48]].map(|pixels| [b"FRAME\n".to_vec(), pixels.to_vec()].concat()).concat();
    put(here, "ball.y4m", [b"YUV4MPEG2 W64 H48 Cmono\n".to_vec(), gray].concat());
    for name in ["pair/frame10.png", "pair/frame11.png", "mot/img1/000001.png", "mot/img1/000002.png", "cat.png"] {
        image::GrayImage::from_pixel(64, 48, image::Luma([7])).save(put_folder(here, name)).expect("a picture");
    }
    image::GrayImage::from_pixel(64, 48, image::Luma([0])).save(put_folder(here, "pair/occ_10.png")).expect("a mask");
    for name in ["pair/flow10.flo", "known/flow/frame_0000.flo", "given.flo"] {
        put(here, name, flo(64, 48));
    }
    for (name, is_known) in [
        ("mot/gt/gt.txt", true),
        ("mot/det/det.txt", false),
        ("alone/det.txt", false),
        ("alone/gt.txt", true),
        ("known/gt.txt", true),
        ("clip/gt.txt", true),
        ("found.txt", false),
        ("known.txt", true),
    ] {
        put(here, name, rows(is_known));
    }
    let session = "motionscope = 1\nclip = \"ball.y4m\"\ntruth = \"given.flo\"\nestimator = \"full-search\"\n";
    put(here, "lesson.motionscope", session);
}

fn put_folder(here: &Path, name: &str) -> PathBuf {
    put(here, name, "");
    here.join(name)
}

/// What names a task, which of the files that it reads is in danger, and what that is called.
const INPUTS: [(&str, &str, &str); 22] = [
    ("ball.y4m", "ball.y4m", "the clip"),
    ("cat.png", "cat.png", "a frame"),
    ("clip", "clip/frame_0000.png", "a frame"),
    ("clip", "clip/frame_0002.png", "a frame"),
    ("clip/frame_0001.png", "clip/frame_0002.png", "a frame"),
    ("clip/frame_%04d.png", "clip/frame_0001.png", "a frame"),
    ("clip", "clip/flow/frame_0001.flo", "truth"),
    ("clip", "clip/gt.txt", "truth"),
    ("pair/frame10.png", "pair/flow10.flo", "truth"),
    ("pair/frame10.png", "pair/occ_10.png", "truth"),
    ("mot/img1", "mot/gt/gt.txt", "truth"),
    ("mot/img1", "mot/det/det.txt", "the detections"),
    ("alone/det.txt", "alone/det.txt", "the detections"),
    ("alone/det.txt", "alone/gt.txt", "truth"),
    ("ball.y4m --truth given.flo", "given.flo", "truth"),
    ("ball.y4m --truth known.txt", "known.txt", "truth"),
    ("ball.y4m --truth known", "known/flow/frame_0000.flo", "truth"),
    ("ball.y4m --truth known", "known/gt.txt", "truth"),
    ("synth:translation,width=64,height=48 --truth given.flo", "given.flo", "truth"),
    ("lesson.motionscope", "lesson.motionscope", "the session"),
    ("lesson.motionscope", "ball.y4m", "the clip"),
    ("lesson.motionscope", "given.flo", "truth"),
];

/// Every flag that writes: the command, the flag, what is given to it, and the file that this writes first.
const OUTPUTS: [(&str, &str, &str, &str); 7] = [
    ("run", "--overlay", "out.png", "out.png"),
    ("run", "--flow", "out.flo", "out.flo"),
    ("run", "--table", "out.csv", "out.csv"),
    ("run", "--tracks", "out.txt", "out.txt"),
    ("run", "--masks", "masks", "masks/mask_0000.png"),
    ("export", "--steps 0..1 --out", "steps", "steps/step_00000.png"),
    ("compare", "--csv", "out.csv", "out.csv"),
];

fn line(command: &str, task: &str, rest: &str) -> String {
    let estimator = if command == "compare" { "--estimators full-search" } else { "--estimator full-search" };
    format!("{command} {task} {estimator} {rest}")
}

#[cfg(unix)]
#[test]
fn no_output_is_written_over_any_input() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    inputs(here);
    let known = ["run ball.y4m --detections found.txt", "run --detections found.txt"].map(|task| (task, "found.txt"));
    for (command, flag, value, written) in OUTPUTS {
        let mut cases: Vec<_> = INPUTS.map(|(task, input, what)| (task.to_owned(), input, what)).to_vec();
        if command != "compare" {
            cases.extend(known.map(|(task, input)| (task.replace("run ", ""), input, "the detections")));
        }
        for (task, input, what) in cases {
            let before = fs::read(here.join(input)).unwrap();
            for is_hard in [false, true] {
                fs::create_dir_all(here.join(written).parent().unwrap()).unwrap();
                fs::remove_file(here.join(written)).ok();
                let link = if is_hard { fs::hard_link } else { std::os::unix::fs::symlink };
                link(here.join(input), here.join(written)).unwrap();
                let told = refusal(here, &line(command, &task, &format!("{flag} {value}")));
                let flag = flag.split(' ').next_back().unwrap();
                let says = |word: &str| told.contains(word);
                assert!(says(flag) && says(value) && says(what) && says("--force"), "{command} {task} {flag}: {told}");
                assert!(fs::read(here.join(input)).unwrap() == before, "{command} {task} {flag}");
            }
            fs::remove_file(here.join(written)).unwrap();
        }
    }
}

#[test]
fn inputs_are_refused_by_their_own_names() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    inputs(here);
    for (command, task, output, told) in [
        ("run", "alone/det.txt", "--tracks alone/det.txt", "the detections"),
        ("run", "--detections found.txt", "--tracks ./found.txt", "the detections"),
        ("run", "clip", "--overlay clip/frame_0001.png", "a frame of the clip"),
        ("run", "clip", "--overlay clip/flow/../frame_0001.png", "a frame of the clip"),
        ("run", "pair/frame10.png", "--flow pair/flow10.flo", "truth of the clip"),
        ("run", "alone/det.txt", "--tracks alone/gt.txt", "truth of the clip"),
        ("run", "clip", "--masks clip", "mix its pictures with the frames"),
        ("run", "clip/frame_0001.png", "--masks clip/flow/..", "mix its pictures with the frames"),
        ("export", "clip", "--steps 0..1 --out clip", "mix its pictures with the frames"),
        ("export", "cat.png", "--steps 0..1 --out .", "mix its pictures with the frames"),
        ("run", "clip", "--overlay clip/frame_0003.png", "become a frame"),
        ("run", "clip/frame_%04d.png", "--flow clip/frame_0009.png", "become a frame"),
        ("run", "pair/frame10.png", "--overlay pair/frame12.png", "become a frame"),
        ("run", "clip", "--masks ball.y4m", "a file, not a folder"),
    ] {
        let refused = refusal(here, &line(command, task, output));
        assert!(refused.contains(told), "{command} {task} {output}: {refused}");
    }
    // Beside them there is room.
    for output in ["--overlay clip/it.svg", "--overlay clip/step_7.png", "--flow clip/flow.npy", "--table clip/a.csv"] {
        stdout(here, &line("run", "clip", output));
        stdout(here, &line("run", "clip", output));
    }
    stdout(here, &line("export", "ball.y4m", "--steps 0..1 --every block --out ."));
}

#[test]
fn who_means_it_may_write_over_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    inputs(here);
    let tracker = "run alone/det.txt --estimator kalman-tracker --tracks alone/det.txt";
    assert!(refusal(here, tracker).contains("--force"));
    assert_eq!(fs::read_to_string(here.join("alone/det.txt")).unwrap(), rows(false));
    stdout(here, &format!("{tracker} --force"));
    assert_ne!(fs::read_to_string(here.join("alone/det.txt")).unwrap(), rows(false));
    stdout(here, &line("export", "clip", "--steps 0..1 --every block --out clip --force"));
    stdout(here, &line("run", "pair/frame10.png", "--flow pair/flow10.flo --force"));
    // It has become a result, and is no truth any more.
    let info = json(here, "info pair/frame10.png --json");
    assert_eq!(info["truth"], serde_json::json!(["occlusion"]), "{info}");
    assert!(info["warnings"].to_string().contains("flow10.flo is a result that Motionscope wrote"), "{info}");
}

#[test]
fn two_results_have_two_names() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::create_dir(here.join("masks")).unwrap();
    for outputs in [
        "--overlay a.png --flow a.png",
        "--overlay a.png --flow ./a.png",
        "--overlay a.png --flow masks/../a.png",
        "--table a.csv --tracks a.csv",
        "--table a.csv --tracks a.csv --force",
        "--masks masks --overlay masks/mask_0000.png",
        "--masks new.png --overlay new.png",
    ] {
        let told = refusal(here, &format!("run {SMALL} --estimator full-search {outputs}"));
        let flags: Vec<_> = outputs.split(' ').filter(|word| word.starts_with("--") && *word != "--force").collect();
        assert!(flags.iter().all(|flag| told.contains(flag)) && told.contains("same file"), "{outputs}: {told}");
        assert_eq!((fs::read_dir(here).unwrap().count(), fs::read_dir(here.join("masks")).unwrap().count()), (1, 0));
    }
    #[cfg(unix)]
    {
        let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, here.join(name)).unwrap();
        put(here, "a.csv", "");
        link("a.csv", "b.csv");
        let told = refusal(here, &format!("run {SMALL} --estimator full-search --table a.csv --tracks b.csv"));
        assert!(told.contains("same file"), "{told}");
        // Nothing is lost where nothing is kept.
        link("/dev/null", "none.csv");
        link("/dev/null", "none.flo");
        stdout(here, &format!("run {SMALL} --estimator full-search --table none.csv --flow none.flo"));
    }
}

#[test]
fn own_results_are_never_truth() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    stdout(here, ON_DISK);
    // The frames alone, nothing known of them.
    for name in ["clip/flow", "clip/occ"] {
        fs::remove_dir_all(here.join(name)).ok();
    }
    fs::remove_file(here.join("clip/gt.txt")).ok();
    let run = |rest: &str| stdout(here, &format!("run clip --estimator diamond {rest}"));
    let result = |name: &&str| _ = run(&format!("--flow {name}"));
    ["clip/result_1.flo", "clip/frame-0000_vectors.flo", "clip/frame_0000.flo", "clip.flo"].iter().for_each(result);
    let known = || json(here, "info clip --json");
    assert_eq!((&known()["truth"], &known()["warnings"]), (&serde_json::json!([]), &serde_json::json!([])));
    // By the names and in the places of truth they are told apart.
    for name in ["clip/flow", "clip/occ"] {
        fs::create_dir(here.join(name)).unwrap();
    }
    let names = ["clip/flow0000.flo", "clip/flow_1.flo", "clip/flow/frame_0000.flo", "clip/flow/frame_0001.png"];
    names.iter().for_each(result);
    run("--view current --overlay clip/occ/frame_0000.png");
    stdout(here, "run clip --estimator frame-difference --frames 0..2 --masks clip/occ");
    put(here, "rows/det.txt", rows(false));
    stdout(here, "run rows/det.txt --estimator kalman-tracker --tracks clip/gt.txt");
    let info = known();
    assert_eq!((&info["truth"], &info["truth_files"]), (&serde_json::json!([]), &serde_json::json!([])), "{info}");
    assert!(info["warnings"].to_string().contains("results that Motionscope wrote"), "{info}");
    let told = run("");
    assert!(told.contains("unknown: no true flow") && !told.contains("truth "), "{told}");
    // Who points to one means it.
    assert_eq!(json(here, "run clip --estimator diamond --truth clip.flo --json")["metrics"]["epe_px"], 0.0);
}

#[test]
fn truth_is_named_wherever_errors_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    inputs(here);
    let info = json(here, "info clip --json");
    let (kinds, files) = (info["truth"].as_array().unwrap(), info["truth_files"].as_array().unwrap());
    assert_eq!((kinds.len(), &files[0]), (files.len(), &"flow/frame_0000.flo and 1 other file".into()), "{info}");
    assert!(stdout(here, "info clip").contains("flow (flow/frame_0000.flo and 1 other file)"));
    let told = stdout(here, "run pair/frame10.png --estimator full-search");
    assert!(told.contains("truth       flow10.flo, occ_10.png\n") && told.contains("mean endpoint error"), "{told}");
    let run = json(here, "run pair/frame10.png --estimator full-search --json");
    assert_eq!(run["truth_files"], serde_json::json!(["flow10.flo", "occ_10.png"]));
    let run = json(here, "run ball.y4m --truth known --estimator full-search --json");
    assert_eq!(run["truth_files"], serde_json::json!(["flow/frame_0000.flo", "gt.txt"]));
    let computed = json(here, &format!("run {SMALL} --estimator full-search --json"));
    assert_eq!(computed["truth_files"], serde_json::json!([]));
    let compared = motionscope(here, "compare pair/frame10.png --estimators full-search,diamond --json");
    assert!(String::from_utf8_lossy(&compared.stderr).contains("truth: flow10.flo"));
}

#[test]
fn a_layer_that_steps_lack_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let export = |estimator: &str, rest: &str| format!("export {SMALL} --estimator {estimator} {rest} --out steps");
    for (estimator, rest, why) in [
        ("full-search", "--steps 2.1..2.4 --layer error", "the end of the run"),
        ("full-search", "--steps 2..5 --every block --layer confidence", "reports no confidence"),
        ("harris", "--steps 2..5 --layer wheel", "single points"),
    ] {
        let told = refusal(here, &export(estimator, rest));
        assert!(told.contains("none of these steps has the layer") && told.contains(why), "{rest}: {told}");
        assert!(!here.join("steps").exists(), "{rest}");
    }
    let told = stdout(here, &export("full-search", "--steps 10..99 --every block --layer error"));
    assert_eq!(
        told.trim(),
        "3 pictures in steps, 2 of them without the layer error: it needs the complete flow field, at the end of the run"
    );
    let told = stdout(here, &export("full-search", "--steps 10..99 --every block --layer wheel"));
    assert_eq!(told.trim(), "3 pictures in steps");
    let told = stdout(here, &export("full-search", "--steps 10..99 --every block --layer none"));
    assert_eq!(told.trim(), "3 pictures in steps");
}

#[cfg(unix)]
mod special {
    use super::*;

    #[test]
    fn devices_and_virtual_files_are_refused_by_type() {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        inputs(here);
        let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, here.join(name)).unwrap();
        for name in ["zero.motionscope", "zero.txt", "zero.png", "zero.mp4", "zero.flo"] {
            link("/dev/zero", name);
        }
        let mut cases = vec!["info /dev/zero", "info /dev/tty", "run --detections zero.txt --estimator kalman-tracker"];
        cases.extend([
            "info zero.motionscope",
            "info zero.txt",
            "info zero.png",
            "info zero.mp4",
            "info clip --truth zero.flo",
        ]);
        cases.push("run clip --estimator full-search --truth zero.txt");
        cases.push("run ball.y4m --detections zero.txt --estimator kalman-tracker");
        for line in cases {
            let told = refusal(here, line);
            assert!(told.contains("it is a device"), "{line}: {told}");
        }
        if cfg!(target_os = "linux") {
            link("/proc/self/mem", "memory.y4m");
            for line in ["info /proc/self/mem", "info /proc/kmsg", "info memory.y4m", "info clip --truth /proc/cpuinfo"]
            {
                let told = refusal(here, line);
                assert!(told.contains("a virtual file of the operating system"), "{line}: {told}");
            }
        }
    }

    /// The program by a shell, which makes pipes of `<( )`.
    fn shell(here: &Path, line: &str) -> Output {
        let line = line.replace("motionscope", env!("CARGO_BIN_EXE_motionscope"));
        finish(here, Command::new("bash").args(["-c", &line]), &line)
    }

    #[test]
    fn a_pipe_works_where_it_is_read_once_and_else_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        inputs(here);
        let has_bash = Command::new("bash").arg("--version").output().is_ok_and(|output| output.status.success());
        if !has_bash {
            return;
        }
        for line in [
            "motionscope info <(cat ball.y4m)",
            "motionscope run <(cat ball.y4m) --estimator full-search --truth given.flo",
            "motionscope run ball.y4m --estimator kalman-tracker --detections <(cat found.txt)",
            "motionscope run alone/det.txt --estimator kalman-tracker --truth <(cat known.txt)",
            "mkfifo it.y4m && (cat ball.y4m > it.y4m &) ; motionscope info it.y4m",
        ] {
            let output = shell(here, line);
            assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        }
        for (line, why) in [
            ("motionscope info <(cat cat.png)", "pictures cannot come from a pipe"),
            ("mkfifo f1.png && (cat cat.png > f1.png &) ; motionscope info f1.png", "pictures cannot come from a pipe"),
            (
                "motionscope run ball.y4m --estimator full-search --truth <(cat given.flo)",
                "a flow cannot come from a pipe",
            ),
            ("mkfifo t.flo && motionscope run ball.y4m --estimator full-search --truth t.flo", "read more than once"),
            ("motionscope run --estimator kalman-tracker --detections <(cat found.txt)", "read more than once"),
        ] {
            let output = shell(here, line);
            let told = String::from_utf8_lossy(&output.stderr);
            assert!(!output.status.success() && told.contains(why), "{line}: {told}");
        }
    }
}
