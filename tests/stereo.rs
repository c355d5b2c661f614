//! Stereo as scripts use it: the right view, the calibration and the true disparities of a clip, given and found.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use motionscope::media::export::{self, Pixels};
use motionscope::media::{Open, open};
use motionscope_core::data::{Clip, Viewpoint};
use motionscope_core::synth;
use serde_json::Value;

fn motionscope(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_motionscope"));
    command.current_dir(folder).args(line.split_whitespace()).stdin(Stdio::null());
    command.output().expect("the program starts")
}

fn json(folder: &Path, line: &str) -> Value {
    let output = motionscope(folder, line);
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// The one sentence on standard error of a call that fails.
fn refusal(folder: &Path, line: &str) -> String {
    let output = motionscope(folder, line);
    assert!(!output.status.success(), "{line}");
    let told = String::from_utf8(output.stderr).expect("text");
    assert!(told.starts_with("error: ") && told.lines().count() == 1, "{line}: {told}");
    told
}

const SCENE: &str = "width=160,height=96,frames=2";
const MATCH: &str = "--estimator block-stereo --set disparities=32 --json";

/// The scene of [`SCENE`].
fn scene() -> Clip {
    let scene = synth::scene("still-life").expect("a scene");
    let difficulty = synth::Difficulty { width: 160, height: 96, frames: 2, ..scene.difficulty() };
    scene.clip(&difficulty).expect("a clip")
}

/// Writes frame 0 from a viewpoint as a PNG.
fn put(clip: &Clip, from: Viewpoint, path: &Path) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, export::frame(&clip.frame_from(from, 0).expect("a frame")).expect("a PNG")).expect("written");
}

#[test]
fn a_rendered_pair_opens_with_its_right_view_calibration_and_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    motionscope(here, "synth still-life --out pair --set width=160 --set height=96 --set frames=2");
    let made = scene();
    let read = open(&here.join("pair"), &Open::default()).expect("a clip").clip;
    assert_eq!(read.info().warnings, [""; 0]);
    assert_eq!(read.calibration(), made.calibration());
    for t in 0..2 {
        let right = |clip: &Clip| clip.frame_from(Viewpoint::Right, t).expect("a frame");
        assert_eq!(right(&read), right(&made));
        let truth = |clip: &Clip| clip.truth().expect("a truth").disparity(t).expect("read").expect("known");
        assert_eq!(truth(&read), truth(&made));
    }
    let [from_folder, from_scene] = ["pair", &format!("synth:still-life,{SCENE}")]
        .map(|clip| json(here, &format!("run {clip} {MATCH}"))["metrics"].clone());
    assert_eq!(from_folder, from_scene);
    for key in ["epe_px", "bad1", "bad3_percent", "d1_percent"] {
        assert!(from_folder[key].is_f64(), "{key}: {from_folder}");
    }
    assert!(from_folder["bad3_percent"].as_f64().is_some_and(|percent| percent < 30.0), "{from_folder}");
    let info = json(here, "info pair --json");
    assert_eq!(info["calibration"]["baseline_m"].as_f64(), made.calibration().map(|c| c.baseline_m));
    assert_eq!(info["right"], "right/frame_0000.png");
}

#[test]
fn a_saved_disparity_is_the_truth_that_it_agrees_with() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    for (name, most) in [("d.pfm", 0.0), ("d.png", 0.002)] {
        let run = format!("run synth:still-life,{SCENE} {MATCH}");
        json(here, &format!("{run} --disparity {name}"));
        let again = json(here, &format!("{run} --truth {name}"));
        let error = again["metrics"]["epe_px"].as_f64().expect("an error");
        assert!(error <= most, "{name}: {error}");
        assert_eq!(again["truth_files"][0], name);
    }
    json(here, &format!("run synth:still-life,{SCENE} {MATCH} --disparity d.npy"));
    assert!(fs::read(here.join("d.npy")).is_ok_and(|bytes| bytes.starts_with(b"\x93NUMPY")));
    let refused = refusal(here, "run synth:translation --estimator full-search --disparity d.pfm");
    assert!(refused.contains("--disparity cannot save"), "{refused}");
}

#[test]
fn the_views_of_middlebury_are_one_moment_with_a_scaled_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, clip) = (folder.path(), scene());
    put(&clip, Viewpoint::Left, &here.join("im2.png"));
    put(&clip, Viewpoint::Right, &here.join("im6.png"));
    let truth = clip.truth().expect("a truth").disparity(0).expect("read").expect("known");
    let levels: Vec<u8> = truth.0.cells().iter().map(|d| (4.0 * d).round().clamp(0.0, 255.0) as u8).collect();
    fs::write(here.join("disp2.png"), export::png(160, 96, Pixels::Gray(&levels)).expect("a PNG")).expect("written");
    for path in [".", "im2.png"] {
        let report = json(here, &format!("run {path} {MATCH} --disparity-scale 4"));
        assert_eq!(report["truth_files"], serde_json::json!(["disp2.png (4 gray levels per px)"]), "{path}");
        assert!(report["metrics"]["epe_px"].as_f64().is_some_and(|error| error < 1.5), "{report}");
        let info = json(here, &format!("info {path} --json"));
        assert_eq!((&info["frames"], &info["right"]), (&1.into(), &"im6.png".into()));
        // Metres need a calibration, and say so.
        assert!(info["calibration"].is_null());
        let text = motionscope(here, &format!("run {path} --estimator block-stereo"));
        let text = String::from_utf8_lossy(&text.stdout).into_owned();
        assert!(text.contains("depth") && text.contains("focal length and the baseline"), "{text}");
    }
    // Another size than those of the benchmark may have another scale, which is not guessed.
    let unknown = refusal(here, &format!("run im2.png {MATCH} --truth disp2.png"));
    assert!(unknown.contains("--disparity-scale"), "{unknown}");
    // Another scale is another truth.
    let scaled = json(here, &format!("run im2.png {MATCH} --truth disp2.png --disparity-scale 2"));
    assert_eq!(scaled["truth_files"], serde_json::json!(["disp2.png (2 gray levels per px)"]));
    assert!(scaled["metrics"]["epe_px"].as_f64().is_some_and(|error| error > 3.0), "{scaled}");
    fs::rename(here.join("disp2.png"), here.join("disparity.png")).expect("renamed");
    let unknown = refusal(here, &format!("run im2.png {MATCH} --truth disparity.png"));
    assert!(unknown.contains("--disparity-scale"), "{unknown}");
}

#[test]
fn the_folders_of_kitti_name_the_cameras_from_within_as_well() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, clip) = (folder.path(), scene());
    for (from, name) in [(Viewpoint::Left, "image_0"), (Viewpoint::Right, "image_1")] {
        put(&clip, from, &here.join(name).join("000000.png"));
    }
    let row = |camera: u32, shift: f64| format!("P{camera}: 700 0 80 {shift} 0 700 48 0 0 0 1 0\n");
    let rows = [row(0, 0.0), row(1, -350.0), row(2, 0.0), row(3, -420.0)];
    fs::write(here.join("calib.txt"), rows.concat()).expect("written");
    for (at, path) in [(here, "image_0"), (&here.join("image_0"), ".")] {
        let info = json(at, &format!("info {path} --json"));
        assert_eq!((&info["right"], &info["calibration"]["baseline_m"]), (&"image_1/000000.png".into(), &0.5.into()));
    }
}

#[test]
fn a_right_view_is_given_as_a_file_a_folder_or_a_half() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, clip) = (folder.path(), scene());
    put(&clip, Viewpoint::Left, &here.join("one/a.png"));
    put(&clip, Viewpoint::Right, &here.join("two/b.png"));
    let [left, right] = [Viewpoint::Left, Viewpoint::Right].map(|from| clip.frame_from(from, 0).expect("a frame"));
    let wide = motionscope_core::geometry::Grid::from_fn(320, 96, |x, y| {
        if x < 160 { left.luma()[(x, y)] } else { right.luma()[(x - 160, y)] }
    });
    fs::write(here.join("wide.png"), export::png(320, 96, Pixels::Gray(wide.cells())).expect("a PNG"))
        .expect("written");
    let coverage = |line: &str| {
        let report = json(here, &format!("run {line} {MATCH}"));
        report["metrics"]["disparity_coverage"].as_f64().expect("a share")
    };
    let shares =
        ["one/a.png --right two/b.png", "one/a.png --right two", "wide.png --right side-by-side"].map(coverage);
    assert!(shares[0] > 0.5 && shares[0] == shares[1] && shares[0] == shares[2], "{shares:?}");
    // Typed numbers give metres.
    let calibrated =
        "run one/a.png --right two/b.png --calibration 300,0.12 --estimator block-stereo --table d.csv --json";
    json(here, calibrated);
    assert!(
        fs::read_to_string(here.join("d.csv")).is_ok_and(|csv| csv.starts_with("x_px,y_px,disparity_px,depth_m\n"))
    );
    // A session keeps what was given.
    let text = "motionscope = 1\nclip = \"one/a.png\"\nright = \"two/b.png\"\ncalibration = \"300,0.12\"\nestimator = \"block-stereo\"\n";
    fs::write(here.join("pair.motionscope"), text).expect("written");
    let info = json(here, "info pair.motionscope --json");
    assert_eq!((&info["right"], &info["calibration"]["focal_px"]), (&"two/b.png".into(), &300.0.into()));
    let table = json(here, "compare one/a.png --right two/b.png --estimators block-stereo,semi-global-matching --json");
    assert_eq!(table.as_array().map(Vec::len), Some(2));
}

#[test]
fn what_does_not_fit_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, clip) = (folder.path(), scene());
    put(&clip, Viewpoint::Left, &here.join("a.png"));
    put(&clip, Viewpoint::Right, &here.join("b.png"));
    fs::write(here.join("small.png"), export::png(4, 3, Pixels::Gray(&[9; 12])).expect("a PNG")).expect("written");
    fs::write(here.join("calib.bad"), "nothing").expect("written");
    let stereo = "--estimator block-stereo --json";
    for (line, words) in [
        (format!("run a.png --right small.png {stereo}"), "rectified views have one size"),
        (format!("run a.png --right gone.png {stereo}"), "gone.png"),
        (format!("run a.png --right b.png --calibration calib.bad {stereo}"), "no calibration"),
        (format!("run a.png --right b.png --calibration 0,0.12 {stereo}"), "focal length"),
        (format!("run synth:still-life --right b.png {stereo}"), "views"),
        (format!("run small.png --right side-by-side --estimator block-stereo --disparity-scale 0 {stereo}"), "scale"),
        ("run a.png --right b.png --estimator block-stereo --disparity b.png".to_owned(), "the right view"),
    ] {
        let told = refusal(here, &line);
        assert!(told.contains(words), "{line}: {told}");
    }
    // Swapped views are recognised by the sign.
    let text = motionscope(here, "run b.png --right a.png --estimator block-stereo");
    assert!(String::from_utf8_lossy(&text.stdout).contains("probably swapped"));
    // What is found and does not fit is a warning.
    fs::create_dir(here.join("right")).expect("a folder");
    fs::copy(here.join("small.png"), here.join("right/a.png")).expect("copied");
    let info = json(here, "info a.png --json");
    let warning = info["warnings"][0].as_str().expect("a warning");
    assert!(warning.contains("right view beside the clip is ignored") && warning.contains("4×3"), "{warning}");
}
