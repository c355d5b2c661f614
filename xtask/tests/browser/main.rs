//! The page in a real browser: Chromium without a window, driven as a person would drive it.
//!
//! `cargo xtask web` builds the page, `cargo test --manifest-path xtask/Cargo.toml --test browser` tests it. With
//! `SCREENSHOTS=folder` pictures of the page are written there.

mod chromium;
mod tab;

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use chromium::Browser;
use serde_json::{Value, json};
use tab::{Shown, Tab};
use xtask::Server;

/// The middle of the button that steps forward, in an upright window of 390×844 points.
const STEP_ON_A_PHONE: [f64; 2] = [268.0, 819.0];

/// The list of estimators in the dialog of the camera, the first one in it, and the button that makes a clip of the last seconds.
const ESTIMATORS: [f64; 2] = [768.0, 99.0];
const FIRST_ESTIMATOR: [f64; 2] = [800.0, 190.0];
const FREEZE: [f64; 2] = [945.0, 656.0];

/// The format in the dialog that exports several steps.
const MP4: [f64; 2] = [782.0, 216.0];

/// The page, served below a path.
fn serve(base: &str) -> Server {
    Server::start(xtask::default_folder(), base, 0).expect("the page is served")
}

/// Opens the page, followed by a link to what it is to show.
fn open(browser: &mut Browser, server: &Server, link: &str) -> Tab {
    let mut tab = Tab::new(browser);
    tab.open(&format!("{}{link}", server.address()));
    tab
}

#[test]
fn the_start_page_appears() {
    let (server, mut browser) = (serve("/"), Browser::with_pixels_per_point(1.0));
    let mut tab = open(&mut browser, &server, "");
    tab.wait("the start page", |shown| shown.is_start() && !shown.is_busy());
    assert_eq!(tab.evaluate("document.getElementById('loading').hidden"), json!(true));
    let began = "const at = (name) => performance.getEntriesByName(name)[0].startTime; at('shown') - at('downloaded')";
    let began = tab.evaluate(&format!("{{ {began} }}")).as_f64().expect("a time");
    println!("start page {began:.0} ms after the download");
    tab.screenshot("start");
    assert!(began < 10_000.0, "{began} ms");
}

#[test]
fn a_clip_opens_by_keyboard_and_its_estimator_steps() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    tab.wait("the start page", |shown| shown.is_start() && !shown.is_busy());
    tab.press("Enter");
    let first = tab.wait("a step", |shown| !shown.text("step").is_empty() && !shown.is_busy());
    println!("opened: {first:?}");
    tab.screenshot("opened");
    let began = std::time::Instant::now();
    for _ in 0..10 {
        let before = tab.settle().text("step").to_owned();
        tab.press("ArrowRight");
        tab.wait("the next step", |shown| shown.text("step") != before && !shown.is_busy());
    }
    println!("ten steps took {:?}", began.elapsed());
    tab.screenshot("stepped");
}

#[test]
fn a_lesson_opens_by_link_and_steps_by_keyboard() {
    let (server, mut browser) = (serve("/"), Browser::with_pixels_per_point(1.0));
    let mut tab = open(&mut browser, &server, "#lesson:kalman-filter/1");
    tab.wait("the page of the lesson", |shown| shown.text("lesson") == "kalman-filter/1" && !shown.is_busy());
    tab.screenshot("lesson");
    let mut steps = Vec::new();
    for _ in 0..10 {
        steps.push(place(&tab.settle()));
        go_on(&mut tab, "ArrowRight");
    }
    for step in steps.iter().rev() {
        go_on(&mut tab, "ArrowLeft");
        assert_eq!(place(&tab.settle()), *step);
    }
}

/// The page of the lesson and the step.
fn place(shown: &Shown) -> [String; 2] {
    ["lesson", "step"].map(|field| shown.text(field).to_owned())
}

/// Presses a key until it leads to another step: before that, it may show more of a page of a lesson.
fn go_on(tab: &mut Tab, key: &str) {
    let before = place(&tab.settle());
    let moves = (0..20).any(|_| {
        tab.press(key);
        std::thread::sleep(Duration::from_millis(500));
        place(&tab.settle()) != before
    });
    assert!(moves, "{key} leads nowhere from {before:?}");
}

#[test]
fn a_link_opens_a_clip_with_an_estimator_and_is_heard() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#synth:pillar&estimator=diamond");
    let shown = tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    assert_eq!(tab.evaluate("document.getElementById('sentence').textContent"), json!(shown.text("sentence")));
    tab.screenshot("diamond");
}

#[test]
fn a_key_fills_the_screen_and_leaves_it() {
    let (server, mut browser) = (serve("/"), Browser::with_pixels_per_point(1.0));
    let mut tab = open(&mut browser, &server, "#synth:pillar&estimator=diamond");
    tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    for fills in [true, false] {
        tab.press("f");
        let wait =
            format!("while (Boolean(document.fullscreenElement) !== {fills}) await new Promise(requestAnimationFrame)");
        tab.evaluate(&format!("(async () => {{ {wait} }})()"));
    }
}

#[test]
fn the_address_of_one_tab_opens_the_same_step_in_another() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut first = open(&mut browser, &server, "#synth:pillar&estimator=diamond&step=164.14&set.search-range=8");
    first.wait("the step of the link", |shown| shown.text("step") == "164.14" && !shown.is_busy());
    first.press("ArrowRight");
    let shown = first.wait("the next step", |shown| shown.text("step") == "164.15" && !shown.is_busy());
    first.evaluate(
        "(async () => { while (!location.hash.includes('164.15')) await new Promise(requestAnimationFrame) })()",
    );
    let address = first.evaluate("location.href");
    let mut second = Tab::new(&mut browser);
    second.open(address.as_str().expect("an address"));
    second.wait("the same step", |other| other.text("sentence") == shown.text("sentence") && !other.is_busy());
}

#[test]
fn the_camera_is_live_and_an_estimator_runs_on_it() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#synth:pillar&estimator=diamond");
    tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    tab.press("R");
    let is_at = |shown: &Shown, frame| shown.live("frame").as_u64().is_some_and(|at| at > frame);
    tab.wait("live frames", |shown| is_at(shown, 5));
    tab.screenshot("camera");
    tab.click(ESTIMATORS);
    let shown = tab.wait("an estimator that keeps up", |shown| shown.live("offered").as_u64() > Some(0));
    let frame = shown.live("frame").as_u64().unwrap_or_default();
    tab.wait("frames while others are measured", |shown| is_at(shown, frame + 1));
    tab.click(FIRST_ESTIMATOR);
    let runs = |shown: &Shown, frame| shown.live("estimator").is_string() && is_at(shown, frame);
    println!("{:?}", tab.wait("a run", |shown| runs(shown, 3)));
    tab.screenshot("camera-estimator");
    tab.click(FREEZE);
    tab.wait("the last seconds as a clip", |shown| {
        shown.text("clip") == "camera-1.y4m" && !shown.text("step").is_empty() && shown.live("frame").is_null()
    });
    tab.screenshot("camera-clip");
}

#[test]
fn a_link_that_names_nothing_says_so() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#lesson:no-such-lesson");
    let shown = tab.wait("a sentence", |shown| !shown.text("error").is_empty() || !shown.text("message").is_empty());
    let words = [shown.text("error"), shown.text("message")].concat();
    assert!(words.contains("no-such-lesson"), "{words}");
}

#[test]
fn an_own_clip_is_searched() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    let clip = xtask::root().join("tests/fixtures/h264_bframes.mp4");
    tab.choose("motionscope-files", &[&clip]);
    tab.wait("the clip", |shown| shown.text("clip").contains("h264_bframes") && !shown.text("step").is_empty());
    tab.settle();
    tab.press("End");
    let end = tab.wait("the end of the search", |shown| !shown.is_busy() && shown.text("sentence").contains("motion"));
    println!("{end:?}");
    tab.screenshot("own-clip");
}

/// The desktop edition with these arguments.
fn desktop(arguments: &[&str]) -> String {
    let program = xtask::root().join("target/debug").join(format!("motionscope{}", std::env::consts::EXE_SUFFIX));
    let output = Command::new(program).args(arguments).output().expect("`cargo build` has built the desktop edition");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// The frames of a video as ffmpeg decodes them, for a desktop that has no decoder of its own for it either.
fn decoded_by_ffmpeg(clip: &Path, folder: &Path) -> String {
    let out = folder.join("decoded.y4m");
    let mut command = Command::new("ffmpeg");
    command.args(["-v", "error", "-y", "-i"]).arg(clip).args(["-vsync", "passthrough", "-strict", "-1"]).arg(&out);
    assert!(command.status().expect("ffmpeg is installed").success());
    out.to_str().expect("a path").to_owned()
}

#[test]
fn video_that_the_browser_decodes_says_the_same_as_on_a_desktop() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let folder = tempfile::tempdir().expect("a folder");
    for (name, frames) in [("vp8.webm", 4), ("vp8_alt_ref.webm", 24), ("av1.mp4", 8), ("av1_10bit.webm", 4)] {
        let clip = xtask::root().join("tests/fixtures").join(name);
        let decoded = decoded_by_ffmpeg(&clip, folder.path());
        let mut tab = open(&mut browser, &server, "");
        tab.choose("motionscope-files", &[&clip]);
        tab.wait("the clip", |shown| shown.text("clip") == name && !shown.text("step").is_empty() && !shown.is_busy());
        for frame in 0..frames - 1 {
            go_on(&mut tab, "ArrowRight");
            let shown = tab.settle();
            let (estimator, step, number) = (shown.text("estimator"), shown.text("step"), frame.to_string());
            let arguments = ["run", &decoded, "--estimator", estimator, "--step", step, "--frame", &number, "--json"];
            let printed: Value = serde_json::from_str(&desktop(&arguments)).expect("JSON");
            assert_eq!(printed["step"]["sentence"], json!(shown.text("sentence")), "{name}, frame {frame}");
            tab.press(".");
            std::thread::sleep(Duration::from_millis(300));
            tab.settle();
        }
        let before = place(&tab.settle());
        tab.press(".");
        std::thread::sleep(Duration::from_millis(300));
        assert_eq!(place(&tab.settle()), before, "{name} has {frames} frames");
    }
}

#[test]
fn video_without_a_decoder_says_what_to_do() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    let refused = |tab: &mut Tab, clip: &Path, words: &[&str]| {
        tab.choose("motionscope-files", &[clip]);
        let shown = tab.wait("a sentence", |shown| words.iter().all(|word| shown.text("error").contains(word)));
        println!("{}", shown.text("error"));
    };
    let fixture = |name: &str| xtask::root().join("tests/fixtures").join(name);
    refused(&mut tab, &fixture("mpeg4.avi"), &["mpeg4", "this browser", "convert the clip to MP4 with H.264"]);
    // A browser may come to decode HEVC.
    let has_hevc = "VideoDecoder.isConfigSupported({ codec: 'hvc1.1.6.L93.B0' }).then((answer) => answer.supported)";
    if tab.evaluate(has_hevc) == json!(false) {
        refused(&mut tab, &fixture("hevc.mp4"), &["hevc", "this browser", "convert the clip to MP4 with H.264"]);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let damaged = folder.path().join("damaged.webm");
    let mut bytes = std::fs::read(fixture("vp8.webm")).expect("a file");
    let middle = bytes.len() / 5;
    bytes[middle..].fill(0xFF);
    std::fs::write(&damaged, bytes).expect("it is written");
    refused(&mut tab, &damaged, &["damaged.webm"]);
}

#[test]
fn a_folder_with_ground_truth_has_its_errors() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let folder = tempfile::tempdir().expect("a folder");
    let clip = folder.path().join("pillar");
    desktop(&["synth", "pillar", "--out", clip.to_str().expect("a path"), "--set", "width=96", "--set", "height=64"]);
    let mut tab = open(&mut browser, &server, "");
    tab.choose("motionscope-folder", &[&clip]);
    tab.wait("the clip", |shown| !shown.text("clip").is_empty() && !shown.text("step").is_empty());
    tab.settle();
    tab.press("End");
    let end = tab.wait("the end", |shown| !shown.is_busy() && shown.text("sentence").contains("All"));
    assert!(end.text("sentence").contains("endpoint error"), "{end:?}");
    tab.screenshot("folder");
}

/// Every number of a step is the same in both editions, whole or not.
#[test]
fn a_step_says_the_same_as_on_a_desktop() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    let steps = [
        ("full-search", "102.540"),
        ("diamond", "35.12"),
        ("hierarchical", "40.6"),
        ("phase-correlation", "1.1"),
        ("horn-schunck", "12.1"),
        ("lucas-kanade", "9.4"),
        ("tv-l1", "3.1"),
        ("harris", "40.1"),
        ("frame-difference", "1.1"),
        ("mean-shift", "2.3"),
    ];
    let mut differing = Vec::new();
    for (estimator, step) in steps {
        let printed = desktop(&["run", "synth:pillar", "--estimator", estimator, "--step", step, "--json"]);
        let printed: Value = serde_json::from_str(&printed).expect("JSON");
        let link = format!("#synth:pillar&estimator={estimator}&step={step}");
        tab.evaluate(&format!("{{ location.hash = '{link}' }}"));
        let is_there = |shown: &tab::Shown| shown.text("estimator") == estimator && shown.text("step") == step;
        let shown = tab.wait("the step", |shown| is_there(shown) && !shown.is_busy());
        let told = &printed["step"]["sentence"];
        if *told != json!(shown.text("sentence")) {
            differing
                .push(format!("{estimator} {step}: {told} on a desktop, {:?} in the page", shown.text("sentence")));
        }
    }
    assert!(differing.is_empty(), "{}", differing.join("\n"));
}

/// Waits for a download with this ending and removes it from its folder; `ask` is called every 300 ms until then.
fn downloaded(tab: &mut Tab, (folder, ending): (&Path, &str), ask: impl Fn(&mut Tab, usize)) -> Vec<u8> {
    for attempt in 0..300 {
        ask(tab, attempt);
        std::thread::sleep(Duration::from_millis(300));
        let files: Vec<_> = std::fs::read_dir(folder).expect("the folder of downloads").flatten().collect();
        if let [file] = files.as_slice()
            && file.path().extension().is_some_and(|found| found == ending)
        {
            let content = std::fs::read(file.path()).expect("its content");
            std::fs::remove_file(file.path()).expect("it is taken away");
            return content;
        }
    }
    tab.screenshot("failure");
    panic!("nothing is downloaded");
}

/// The picture that is exported into a folder: Enter saves it once the dialog is there. A key that comes too early is pressed again.
fn exported(tab: &mut Tab, folder: &Path) -> Vec<u8> {
    downloaded(tab, (folder, "png"), |tab, attempt| match attempt % 10 {
        0 => tab.press_ctrl("e"),
        _ => tab.press("Enter"),
    })
}

/// Frames of a video with their planes Y, U and V, of this size in px.
fn frames(video: &Path, (width, height): (usize, usize)) -> Vec<Vec<u8>> {
    let mut command = Command::new("ffmpeg");
    command.args(["-v", "error", "-i"]).arg(video).args(["-f", "rawvideo", "-pix_fmt", "yuv420p", "pipe:1"]);
    let output = command.output().expect("ffmpeg is installed");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout.chunks(width * height * 3 / 2).map(<[u8]>::to_vec).collect()
}

/// Size and rate of a video as ffprobe prints them, and the names of its colours.
fn probed(video: &Path) -> String {
    let entries = "stream=codec_name,width,height,avg_frame_rate,color_range,color_space";
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-of", "csv=p=0", "-show_entries", entries]).arg(video);
    String::from_utf8(command.output().expect("ffprobe is installed").stdout).expect("text")
}

#[test]
fn an_exported_video_shows_what_that_of_a_desktop_shows() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let folder = tempfile::tempdir().expect("a folder");
    let mut tab = open(&mut browser, &server, "#synth:pillar&estimator=diamond");
    tab.call("Browser.setDownloadBehavior", json!({ "behavior": "allow", "downloadPath": folder.path() }));
    tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    // Once: a second video would be another download.
    let video = downloaded(&mut tab, (folder.path(), "mp4"), |tab, attempt| match attempt {
        0 => tab.press_ctrl("E"),
        6 => tab.click(MP4),
        12 => tab.press("Enter"),
        _ => {}
    });
    let [from_page, from_desktop] = ["page.mp4", "desktop.mp4"].map(|name| folder.path().join(name));
    std::fs::write(&from_page, video).expect("the video");
    let steps = ["export", "synth:pillar", "--estimator", "diamond", "--steps", "1.1..1"];
    let look = ["--theme", "light", "--scale", "2", "--legend", "--rate", "8", "--animation"];
    desktop(&[&steps[..], &look, &[from_desktop.to_str().expect("a path")]].concat());
    assert_eq!(probed(&from_page), probed(&from_desktop));
    assert_eq!(probed(&from_page).trim(), "h264,1360,712,tv,bt709,16/1");
    let [found, wanted] = [&from_page, &from_desktop].map(|video| frames(video, (1360, 712)));
    assert_eq!(found.len(), wanted.len(), "as many pictures");
    for (t, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
        let far: u64 = found.iter().zip(wanted).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let mean = far as f64 / found.len() as f64;
        assert!(mean < 1.5, "frame {t} differs by {mean} on average");
    }
}

#[test]
fn video_without_an_encoder_is_refused_with_what_to_do() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = Tab::new(&mut browser);
    tab.prepare("delete globalThis.VideoEncoder");
    tab.open(&format!("{}#synth:pillar&estimator=diamond", server.address()));
    tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    tab.press_ctrl("E");
    std::thread::sleep(Duration::from_secs(2));
    tab.click(MP4);
    std::thread::sleep(Duration::from_secs(1));
    tab.press("Enter");
    let shown = tab.wait("a sentence", |shown| !shown.text("message").is_empty());
    assert!(shown.text("message").contains("save as .gif"), "{shown:?}");
}

#[test]
fn an_exported_picture_is_that_of_a_desktop() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let folder = tempfile::Builder::new().prefix("downloads").tempdir().expect("a folder");
    let mut tab = open(&mut browser, &server, "");
    tab.call("Browser.setDownloadBehavior", json!({ "behavior": "allow", "downloadPath": folder.path() }));
    let searches = ["full-search", "diamond", "three-step", "hierarchical"];
    let steps = ["1.1", "17.3", "35.7", "60.2", "75.4"];
    let mut differing = Vec::new();
    for (estimator, step) in searches.into_iter().flat_map(|estimator| steps.map(|step| (estimator, step))) {
        let link = format!("#synth:pillar&estimator={estimator}&step={step}");
        tab.evaluate(&format!("{{ location.hash = '{link}' }}"));
        let is_there = |shown: &tab::Shown| shown.text("estimator") == estimator && shown.text("step") == step;
        tab.wait("the step", |shown| is_there(shown) && !shown.is_busy());
        let picture = exported(&mut tab, folder.path());
        let wanted = folder.path().with_extension("png");
        let run = ["run", "synth:pillar", "--estimator", estimator, "--step", step];
        let look = ["--theme", "light", "--scale", "2", "--legend", "--overlay", wanted.to_str().expect("a path")];
        desktop(&[run.as_slice(), &look].concat());
        if std::fs::read(&wanted).expect("the picture") != picture {
            differing.push(format!("{estimator} {step}"));
        }
        std::fs::remove_file(&wanted).expect("it is taken away");
    }
    assert!(differing.is_empty(), "{}", differing.join("\n"));
}

#[test]
fn a_browser_that_stores_nothing_shows_everything() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let full = "throw new DOMException('the quota is exceeded', 'QuotaExceededError')";
    let none =
        "Object.defineProperty(window, 'localStorage', { get() { throw new DOMException('no', 'SecurityError') } })";
    for refusal in [&format!("Storage.prototype.setItem = () => {{ {full} }}"), none] {
        let mut tab = Tab::new(&mut browser);
        tab.prepare(refusal);
        tab.open(&format!("{}#synth:pillar&estimator=diamond", server.address()));
        tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
        // The settings are stored when the page is hidden.
        tab.evaluate("{ dispatchEvent(new Event('beforeunload')) }");
        tab.press("ArrowRight");
        tab.wait("the next step", |shown| shown.text("step").ends_with(".1") && !shown.is_busy());
        let faults = tab.take_faults();
        let is_expected =
            |fault: &String| fault.contains("quota") || fault.contains("SecurityError") || fault.contains("storage");
        assert!(faults.iter().all(is_expected), "{faults:#?}");
    }
}

#[test]
fn a_tab_that_slept_goes_on_with_its_work() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#synth:pillar,width=640,height=480&estimator=horn-schunck");
    tab.wait("the first step", |shown| shown.text("estimator") == "horn-schunck" && !shown.is_busy());
    tab.press("End");
    tab.wait("the run to begin", |shown| shown.is_busy());
    tab.call("Page.setWebLifecycleState", json!({ "state": "frozen" }));
    assert!(tab.shown().is_some_and(|shown| shown.is_busy()), "it was at work");
    std::thread::sleep(Duration::from_secs(2));
    assert!(tab.shown().is_some_and(|shown| shown.is_busy()), "it did not work while it slept");
    tab.call("Page.setWebLifecycleState", json!({ "state": "active" }));
    // A tab that was frozen stays hidden until a person comes back to it from another one.
    let _other = Tab::new(&mut browser);
    tab.call("Page.bringToFront", json!({}));
    tab.wait("the end of the run", |shown| !shown.is_busy() && shown.text("step") != "0");
}

#[test]
fn it_works_below_a_path_and_without_the_server() {
    let (server, mut browser) = (serve("/courses/vision/"), Browser::start());
    let mut tab = open(&mut browser, &server, "");
    tab.evaluate("navigator.serviceWorker.ready.then(() => true)");
    server.stop();
    tab.reload();
    tab.wait("the start page", |shown| shown.is_start());
    tab.screenshot("offline");
}

#[test]
fn a_phone_shows_a_lesson_and_steps_by_touch() {
    let (server, mut browser) = (serve("/"), Browser::with_pixels_per_point(2.0));
    let mut tab = Tab::new(&mut browser);
    tab.resize([390, 844], true);
    tab.open(&format!("{}#lesson:kalman-filter/3", server.address()));
    tab.wait("the page of the lesson", |shown| shown.text("lesson") == "kalman-filter/3" && !shown.is_busy());
    tab.settle();
    tab.screenshot("phone");
    let scrolls =
        "document.scrollingElement.scrollWidth > innerWidth || document.scrollingElement.scrollHeight > innerHeight";
    assert_eq!(tab.evaluate(scrolls), json!(false));
    tab.evaluate("{ location.hash = '#synth:pillar&estimator=diamond&step=35.4' }");
    tab.wait("the step of the link", |shown| shown.text("step") == "35.4" && !shown.is_busy());
    tab.tap(STEP_ON_A_PHONE);
    tab.wait("the next step", |shown| shown.text("step") == "35.5");
}

#[test]
fn memory_does_not_grow_with_the_steps() {
    let (server, mut browser) = (serve("/"), Browser::start());
    let mut tab = open(&mut browser, &server, "#synth:pillar&estimator=diamond");
    tab.wait("diamond search", |shown| shown.text("estimator") == "diamond" && !shown.is_busy());
    let walk = |tab: &mut Tab, count| {
        for _ in 0..count {
            let before = tab.settle().text("step").to_owned();
            tab.press("ArrowRight");
            tab.wait("the next step", |shown| shown.text("step") != before);
        }
        tab.memory()
    };
    let (program, page) = walk(&mut tab, 20);
    let (program_after, page_after) = walk(&mut tab, 200);
    println!("memory after 20 steps {program} and {page} bytes, after 220 {program_after} and {page_after}");
    assert!(program_after < program + (32 << 20), "the program grew from {program} to {program_after} bytes");
    assert!(page_after < page + (8 << 20), "the page grew from {page} to {page_after} bytes");
}

#[test]
fn a_stopped_program_leaves_a_sentence() {
    let panics = "document.getElementById('motionscope').dataset.panic = 'index out of bounds'";
    let traps = "setTimeout(() => { throw new WebAssembly.RuntimeError('unreachable') })";
    let lost =
        "document.getElementById('motionscope').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext()";
    let (server, mut browser) = (serve("/"), Browser::start());
    for (cause, words) in [(panics, "index out of bounds"), (traps, "memory"), (lost, "graphics card")] {
        let mut tab = open(&mut browser, &server, "");
        tab.evaluate(&format!("{{ {cause} }}"));
        let page = tab.wait_for_stop();
        assert!(page.contains(words) && page.contains("Reload"), "{page}");
        tab.screenshot(&format!("stopped-{}", words.replace(' ', "-")));
        tab.take_faults();
    }
}

#[test]
fn a_new_version_is_taken_at_the_next_visit() {
    let (folder, mut browser) = (tempfile::tempdir().expect("a folder"), Browser::start());
    let old = copy_page(folder.path(), |text| text.to_owned());
    let server = Server::start(folder.path().to_owned(), "/", 0).expect("the page is served");
    let mut tab = open(&mut browser, &server, "");
    tab.evaluate("navigator.serviceWorker.ready.then(() => true)");
    let new = "0123456789abcdef";
    copy_page(folder.path(), |text| text.replace(&old, new));
    tab.reload();
    let names = "(await caches.keys()).join()";
    let wait = format!("while (!/^[^,]*{new}$/.test({names})) await new Promise((next) => setTimeout(next, 50))");
    tab.evaluate(&format!("(async () => {{ {wait} }})()"));
    tab.reload();
    assert_eq!(
        tab.evaluate("document.querySelector('script[type=module]').src.includes('0123456789abcdef')"),
        json!(true)
    );
}

/// Writes the files of the page into a folder with their names and texts changed, and returns the hash of the build.
fn copy_page(folder: &Path, change: impl Fn(&str) -> String) -> String {
    let mut hash = String::new();
    for entry in std::fs::read_dir(xtask::default_folder()).expect("the page") {
        let entry = entry.expect("a file");
        let name = entry.file_name().into_string().expect("a name");
        if let Some(stem) = name.strip_prefix("motionscope-").and_then(|rest| rest.strip_suffix(".bin")) {
            stem.clone_into(&mut hash);
        }
        let content = std::fs::read(entry.path()).expect("its content");
        let content = String::from_utf8(content).map_or_else(|error| error.into_bytes(), |text| change(&text).into());
        std::fs::write(folder.join(change(&name)), content).expect("it is written");
    }
    hash
}
