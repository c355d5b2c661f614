//! The camera: live, frozen, recorded, saved, and when it fails.

use std::future::ready;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use eframe::egui::{ViewportCommand, ViewportEvent, ViewportId};
use motionscope::media::camera::{CameraFeed, Cameras, Device, Format, OpenedFeed, Size, is_unsaved};
use motionscope::work::Boxed;
use motionscope_core::base::{Error, Stop};

use super::*;

/// A camera without a camera: a square that moves over a ramp, a frame each few milliseconds.
struct Fake {
    /// Frames until it is unplugged.
    frames: usize,
    /// Why it cannot be opened, if it cannot.
    refused: Option<Error>,
    /// Why there are no cameras.
    trouble: Option<Error>,
    /// Feeds that are open.
    open: Arc<AtomicUsize>,
    /// The most feeds that were open at a time.
    most: Arc<AtomicUsize>,
    /// The time that a feed takes to close.
    closing: Duration,
}

impl Default for Fake {
    fn default() -> Self {
        let (open, most) = (Arc::default(), Arc::default());
        Self { frames: usize::MAX, refused: None, trouble: None, open, most, closing: Duration::ZERO }
    }
}

impl Cameras for Fake {
    fn list(&self) -> Boxed<'_, (Vec<Device>, Option<Error>)> {
        let webcam = Device::Camera { name: "HD Webcam".into(), address: "/dev/video0".into() };
        Box::pin(ready(match &self.trouble {
            Some(error) => (vec![Device::TestPicture], Some(error.clone())),
            None => (vec![webcam, Device::TestPicture], None),
        }))
    }

    fn open<'a>(&'a self, _: &'a Device, _: Size, _: &'a Stop) -> Boxed<'a, OpenedFeed> {
        Box::pin(async {
            if let Some(error) = &self.refused {
                return Err(error.clone());
            }
            self.most.fetch_max(self.open.fetch_add(1, Ordering::Relaxed) + 1, Ordering::Relaxed);
            let (left, open) = (self.frames, Arc::clone(&self.open));
            Ok(Box::new(Moving { left, at: 0, open, closing: self.closing }) as Box<dyn CameraFeed>)
        })
    }
}

struct Moving {
    left: usize,
    at: usize,
    open: Arc<AtomicUsize>,
    closing: Duration,
}

impl Drop for Moving {
    fn drop(&mut self) {
        thread::sleep(self.closing);
        self.open.fetch_sub(1, Ordering::Relaxed);
    }
}

impl CameraFeed for Moving {
    fn begin<'a>(&'a mut self, _: &'a Stop) -> Boxed<'a, Result<Format, Error>> {
        Box::pin(ready(Format::parse(b"YUV4MPEG2 W96 H64 F30:1 Ip Cmono")))
    }

    fn next<'a>(&'a mut self, stop: &'a Stop) -> Boxed<'a, Result<Option<Vec<u8>>, Error>> {
        Box::pin(async { self.frame(stop) })
    }
}

impl Moving {
    fn frame(&mut self, stop: &Stop) -> Result<Option<Vec<u8>>, Error> {
        thread::sleep(Duration::from_millis(15));
        stop.check()?;
        self.left = self.left.checked_sub(1).ok_or_else(|| Error::new("HD Webcam: it is not there; plug it in"))?;
        self.at += 1;
        let inside = |x: usize, y: usize| (20..36).contains(&y) && (self.at % 60..self.at % 60 + 16).contains(&x);
        let level = |i: usize| if inside(i % 96, i / 96) { 200 + (i * 7 % 40) as u8 } else { (i % 96 + i / 96) as u8 };
        Ok(Some((0..96 * 64).map(level).collect()))
    }
}

impl Window {
    /// Draws until `is` is the case.
    fn until(&mut self, what: &str, is: impl Fn(&Window) -> bool) {
        let begun = Instant::now();
        loop {
            self.harness.run_steps(1);
            if is(self) {
                return;
            }
            let said: Vec<_> =
                self.harness.query_all_by_role(Role::Label).filter_map(|node| node.accesskit_node().value()).collect();
            assert!(begun.elapsed() < Duration::from_secs(60), "{what}: {said:?}");
            thread::sleep(Duration::from_millis(5));
        }
    }

    fn says(&self, words: &str) -> bool {
        self.harness.query_all_by_label_contains(words).next().is_some()
    }

    fn is_live(&self) -> bool {
        self.app().live().is_some_and(|live| live.seen.is_some())
    }

    fn press_button(&mut self, label: &str) {
        let has = |window: &Window| window.harness.query_all_by_label_contains(label).next().is_some();
        self.until(label, has);
        self.harness.query_all_by_label_contains(label).next().expect("it is there").click_accesskit();
        self.harness.run_steps(2);
    }

    /// Chooses in a list of the dialog.
    fn choose(&mut self, list: &str, entry: &str) {
        // A dialog that has just opened may still move under the pointer, and a long list hides its end.
        self.harness.get_by_role_and_label(Role::ComboBox, list).click_accesskit();
        self.until(entry, |window| window.harness.query_by_role_and_label(Role::Button, entry).is_some());
        self.harness.get_by_role_and_label(Role::Button, entry).click_accesskit();
        self.harness.run_steps(3);
    }
}

/// The window with the camera open.
fn live(fake: Fake) -> (Window, Arc<AtomicUsize>) {
    let (mut window, open) = (Window::usual(), Arc::clone(&fake.open));
    window.harness.state_mut().use_cameras(Arc::new(fake));
    window.harness.state_mut().command(Command::Camera);
    window.harness.run_steps(2);
    (window, open)
}

/// Asks the window to close, as its system does; gives whether it stays.
fn holds_quit(window: &mut Window) -> bool {
    let viewports = &mut window.harness.input_mut().viewports;
    viewports.entry(ViewportId::ROOT).or_default().events.push(ViewportEvent::Close);
    window.harness.run_steps(1);
    let root = window.harness.output().viewport_output.get(&ViewportId::ROOT);
    let stays = root.is_some_and(|root| root.commands.contains(&ViewportCommand::CancelClose));
    // The request is over in the next frame.
    window.harness.run_steps(1);
    stays
}

fn path_of_clip(window: &Window) -> std::path::PathBuf {
    match window.app().document().source() {
        Some(Source::File(path)) => path.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_last_seconds_are_frozen_with_the_estimator_that_ran_on_them() {
    let (mut window, open) = live(Fake::default());
    window.until("a frame comes", Window::is_live);
    window.choose("Estimator", "Diamond search");
    let has_vectors = |window: &Window| {
        window.app().live().and_then(|live| live.seen).is_some_and(|seen| !seen.scene.marks.is_empty())
    };
    window.until("it runs", has_vectors);
    window.until("its rate is told", |window| window.says("Diamond search: "));
    assert!(window.says("dropped"));
    window.harness.key_press(Key::Space);
    window.until("the clip is open", |window| {
        window.app().document().clip().is_some_and(|c| c.info().container == "y4m")
    });
    window.settle();
    assert_eq!(open.load(Ordering::Relaxed), 0, "the camera is off");
    let document = window.app().document();
    assert_eq!((document.estimator().info().id, document.clip().expect("a clip").size()), ("diamond", (96, 64)));
    assert!(document.clip().and_then(|clip| clip.info().frames).is_some_and(|frames| frames > 3));
    assert!(window.says("not saved yet"));
    window.key(Key::ArrowRight);
    assert!(window.cursor().event > 0, "it is stepped through");

    // It is there again after another clip.
    window.harness.state_mut().open("synth:translation");
    window.settle();
    assert!(window.app().document().clip().is_some_and(|clip| clip.info().container == "synthetic"));
    window.harness.state_mut().command(Command::Camera);
    window.press_button("Last recording");
    window.settle();
    window.key(Key::ArrowRight);

    // Nothing may refer to it before it is saved.
    let path = path_of_clip(&window);
    assert!(is_unsaved(&path) && window.app().settings().recent.iter().all(|recent| *recent != path));
    window.command(Command::SaveSession);
    assert!(window.app().message().is_some_and(|said| said.contains("Save the clip first (Ctrl+Shift+S)")));
    assert!(window.says("This recording is not saved yet"));
    let folder = tempfile::tempdir().expect("a folder");
    let saved = folder.path().join("hand.y4m");
    window.command(Command::FocusNever);
    window.key(Key::Num2);
    window.key(Key::W);
    let middle = window.harness.get_by_label_contains("Stage: ").rect().center();
    window.harness.hover_at(middle);
    window.harness.run_steps(1);
    window.drag(middle, middle + vec2(20.0, 10.0));
    window.key(Key::W);
    assert_eq!(window.app().ink().len(), 1);
    let cursor = window.cursor();
    window.command(Command::SaveClip);
    files::write_to(&mut window, &saved);
    window.settle();
    assert_eq!(fs::read(&saved).expect("the clip"), fs::read(&path).expect("the recording"));
    assert_eq!((path_of_clip(&window), window.cursor()), (saved, cursor), "it goes on where it was");
    assert!(!window.says("not saved yet"), "that is over");
    assert_eq!(window.app().ink().len(), 1, "the ink stays");
    window.command(Command::SaveSession);
    let session = folder.path().join("hand.motionscope");
    files::write_to(&mut window, &session);
    assert!(Session::load(&session).is_ok(), "{:?}", window.app().message());
    drop(window);
    assert!(!path.exists() && path.parent().is_some_and(|folder| !folder.exists()), "nothing is left of the recording");
}

#[test]
fn a_recording_takes_its_time_and_opens_with_the_present_estimator() {
    let (mut window, _) = live(Fake::default());
    window.until("a frame comes", Window::is_live);
    // Long enough to be seen on a busy computer.
    window.choose("Duration", "2 s");
    window.press_button("Countdown of 3 s");
    let begun = Instant::now();
    window.press_button("Record 2 s");
    window.until("it says so", |window| window.says("Recording: "));
    for list in ["Camera", "Size", "Duration"] {
        let node = window.harness.get_by_role_and_label(Role::ComboBox, list);
        assert!(node.accesskit_node().is_disabled(), "{list} can be changed while it records");
    }
    // The key freezes no recording either.
    window.harness.key_press(Key::Space);
    window.until("the clip is open", |window| {
        window.app().document().clip().is_some_and(|c| c.info().container == "y4m")
    });
    assert!(begun.elapsed() > Duration::from_secs(2));
    window.settle();
    assert_eq!(window.app().document().estimator().info().id, "full-search");
    let fps = window.app().document().clip().and_then(|clip| clip.info().fps).expect("a rate");
    assert!((20.0..80.0).contains(&fps), "{fps} frames/s were measured");
    let frames = window.app().document().clip().and_then(|clip| clip.info().frames).expect("a number");
    assert!((frames as f64) < 2.0 * fps + 0.6, "{frames} frames in 2 s of {fps} frames/s");
    // As pictures it is a clip as well.
    let folder = tempfile::tempdir().expect("a folder");
    window.command(Command::SaveClip);
    window.click_role(Role::Button, "Numbered PNG");
    files::write_to(&mut window, &folder.path().join("frames"));
    window.settle();
    assert_eq!(path_of_clip(&window), folder.path().join("frames"));
}

#[test]
fn a_countdown_precedes_a_recording_and_escape_cancels_either() {
    let (mut window, _) = live(Fake::default());
    window.until("a frame comes", Window::is_live);
    window.choose("Duration", "10 s");
    window.harness.key_press(Key::R);
    window.until("it counts", |window| window.says("Recording begins in 3 s"));
    let size = window.harness.get_by_role_and_label(Role::ComboBox, "Size");
    assert!(size.accesskit_node().is_disabled(), "the size can be changed while it counts");
    window.harness.key_press(Key::Escape);
    window.until("it is cancelled", |window| window.says("Record 10 s"));
    assert!(window.is_live() && !window.says("Recording begins"), "the dialog stays");

    let begun = Instant::now();
    window.press_button("Record 10 s");
    window.until("it counts down", |window| window.says("Recording begins in 1 s"));
    window.until("it records", |window| window.says("Recording: "));
    assert!(begun.elapsed() >= Duration::from_secs(3), "{:?}", begun.elapsed());
    window.harness.key_press(Key::Escape);
    window.until("the recording is given up", |window| window.says("Record 10 s"));
    assert!(window.is_live() && !window.says("Opening the recording"), "nothing of it is kept");

    assert!(window.app().settings().camera.has_countdown);
    window.press_button("Countdown of 3 s");
    assert!(!window.app().settings().camera.has_countdown);
    window.press_button("Record 10 s");
    window.until("it records at once", |window| window.says("Recording: "));
    assert!(!window.says("Recording begins"));
}

#[test]
fn the_list_of_estimators_has_room_for_those_that_are_measured_while_it_is_open() {
    let (mut window, _) = live(Fake::default());
    window.until("a frame comes", Window::is_live);
    window.harness.get_by_role_and_label(Role::ComboBox, "Estimator").click_accesskit();
    let entry = "Diamond search";
    window.until(entry, |window| window.harness.query_by_role_and_label(Role::Button, entry).is_some());
    // By the pointer, which reaches only what is in sight.
    window.harness.get_by_role_and_label(Role::Button, entry).click();
    window.harness.run_steps(3);
    assert_eq!(window.app().settings().camera.estimator.as_deref(), Some("diamond"));
}

#[test]
fn what_was_chosen_for_the_camera_is_chosen_the_next_time() {
    let (mut window, open) = live(Fake::default());
    window.until("a frame comes", Window::is_live);
    window.choose("Size", "320×240 px");
    window.until("it is open again", Window::is_live);
    window.choose("Duration", "5 s");
    window.choose("Estimator", "Diamond search");
    window.until("it runs", |window| window.says("Diamond search: "));
    // A list that is open closes first.
    for _ in 0..2 {
        window.harness.key_press(Key::Escape);
        window.harness.run_steps(3);
    }
    window.until("the camera is off", |window| window.app().live().is_none() && open.load(Ordering::Relaxed) == 0);
    window.harness.state_mut().command(Command::Camera);
    window.until("it runs again", |window| window.says("Diamond search: "));
    assert!(window.says("Record 5 s"));
    assert_eq!(window.app().settings().camera.size, Size::new(320, 240));
    window.choose("Estimator", "none");
    // The list stays open, and names it.
    window.until("it runs no more", |window| !window.says("Diamond search: "));
    assert_eq!(window.app().settings().camera.estimator, None);
}

#[test]
fn a_camera_that_is_unplugged_leaves_what_came() {
    let (mut window, _) = live(Fake { frames: 12, ..Fake::default() });
    window.until("it is told", |window| window.says("HD Webcam: it is not there; plug it in."));
    assert!(window.says("The last seconds can still be frozen."));
    window.harness.key_press(Key::R);
    for _ in 0..10 {
        window.harness.run_steps(1);
        thread::sleep(Duration::from_millis(20));
    }
    assert!(!window.says("record again"), "there is nothing to record any more");
    window.press_button("Freeze the last 3 s");
    window.until("the clip is open", |window| {
        window.app().document().clip().is_some_and(|c| c.info().container == "y4m")
    });
    window.settle();
    assert_eq!(window.app().document().clip().and_then(|clip| clip.info().frames), Some(12));
    assert!(window.says("The camera has ended: HD Webcam: it is not there"));
}

#[test]
fn a_recording_is_saved_as_compressed_video_too() {
    let (mut window, _) = live(Fake { frames: 12, ..Fake::default() });
    window.until("it is told", |window| window.says("The last seconds can still be frozen."));
    window.press_button("Freeze the last 3 s");
    window.until("the clip is open", |window| {
        window.app().document().clip().is_some_and(|c| c.info().container == "y4m")
    });
    window.settle();
    let (folder, recorded) = (tempfile::tempdir().expect("a folder"), path_of_clip(&window));
    window.command(Command::SaveClip);
    window.click_role(Role::Button, "MP4");
    assert!(window.says("H.264 video with loss"));
    // The ending of pictures is none of a video.
    fs::write(folder.path().join("hand.png.mp4"), "mine").expect("a file");
    let typed = folder.path().join("hand.png").display().to_string();
    window.harness.get_by_label("Output path").set_text_value_accesskit(&typed);
    window.settle();
    assert!(window.says("There is a hand.png.mp4 already."));
    let video = folder.path().join("hand.mp4");
    files::write_to(&mut window, &video);
    window.settle();
    let said = window.app().message().unwrap_or_default().to_owned();
    assert_eq!(path_of_clip(&window), recorded, "the recording stays open as it came: {said}");
    if !video.exists() {
        // Where ffmpeg is missing or encodes no H.264, that is told, and nothing is left.
        assert!(said.contains("save as numbered PNG") && window.says("not saved yet"), "{said}");
        return;
    }
    let clip = Source::File(video.clone()).open(&Open::default()).expect("a clip").clip;
    assert_eq!((clip.info().codec.as_str(), clip.info().frames), ("h264", Some(12)), "{said}");
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 2, "nothing temporary is left");

    // It is a copy: the recording is not saved without loss.
    assert!(window.says("12 frames, saved only with loss, as hand.mp4") && !window.says("not saved yet"));
    window.command(Command::SaveSession);
    assert!(window.says("This recording is saved only with loss, as hand.mp4"));
    assert!(holds_quit(&mut window));
    let asked = window.app().message().unwrap_or_default().to_owned();
    assert!(asked.contains("saved only with loss, as hand.mp4: quitting deletes its frames as they came"), "{asked}");

    // A message may lie over the dialog.
    let saved = folder.path().join("hand.y4m");
    window.command(Command::SaveClip);
    window.harness.get_by_label("Output path").set_text_value_accesskit(&saved.display().to_string());
    window.settle();
    window.harness.get_by_role_and_label(Role::Button, "Save").click_accesskit();
    window.settle();
    assert_eq!(fs::read(&saved).expect("the clip"), fs::read(&recorded).expect("the recording"));
    assert_eq!(path_of_clip(&window), saved);
    assert!(!holds_quit(&mut window), "nothing is lost any more: {:?}", window.app().message());
}

#[test]
fn quitting_asks_as_long_as_a_recording_is_not_saved() {
    let (mut window, _) = live(Fake { frames: 12, ..Fake::default() });
    assert!(!holds_quit(&mut window), "nothing was recorded");
    window.until("it is told", |window| window.says("The last seconds can still be frozen."));
    window.press_button("Freeze the last 3 s");
    window.until("the clip is open", |window| {
        window.app().document().clip().is_some_and(|c| c.info().container == "y4m")
    });
    window.settle();
    assert!(holds_quit(&mut window));
    let asked = window.app().message().unwrap_or_default().to_owned();
    assert!(asked.starts_with("The recording camera-1 is not saved") && asked.contains("Ctrl+Shift+S"), "{asked}");
    assert!(!holds_quit(&mut window), "it is asked once");
    // It is kept while another clip is open.
    window.harness.state_mut().open("synth:translation");
    window.settle();
    assert!(holds_quit(&mut window));
    let asked = window.app().message().unwrap_or_default().to_owned();
    assert!(asked.contains("Last recording in the camera dialog (Ctrl+R)"), "{asked}");
}

#[test]
fn a_camera_that_does_not_open_says_why() {
    let busy = Error::new("HD Webcam: another program uses it; close that program, then choose the camera again");
    let (mut window, _) = live(Fake { refused: Some(busy), ..Fake::default() });
    window.until("it is told", |window| window.says("HD Webcam: another program uses it; close that program"));
    window.press_button("Try again");
    window.until("it is told again", |window| window.says("another program uses it"));
    let missing = Error::new("cameras need ffmpeg, which is not installed; install it (ffmpeg.org)");
    let (mut window, _) = live(Fake { trouble: Some(missing), ..Fake::default() });
    window.until("what to install is told", |window| window.says("Cameras need ffmpeg, which is not installed;"));
}

#[test]
fn closing_the_dialog_switches_the_camera_off() {
    let (mut window, open) = live(Fake::default());
    window.until("a frame comes", Window::is_live);
    assert_eq!(open.load(Ordering::Relaxed), 1);
    window.choose("Size", "320×240 px");
    window.until("it is open again", Window::is_live);
    assert_eq!(open.load(Ordering::Relaxed), 1, "it is not open twice");
    // A list that is open closes first.
    for _ in 0..2 {
        window.harness.key_press(Key::Escape);
        window.harness.run_steps(3);
    }
    window.until("the camera is off", |window| window.app().live().is_none() && open.load(Ordering::Relaxed) == 0);
}

#[test]
fn a_camera_is_opened_only_when_all_earlier_ones_have_closed() {
    let fake = Fake { closing: Duration::from_secs(3), ..Fake::default() };
    let most = Arc::clone(&fake.most);
    let (mut window, open) = live(fake);
    window.until("a frame comes", Window::is_live);
    // The second camera is closed while it waits for the first, with the dialog.
    window.choose("Size", "320×240 px");
    for _ in 0..2 {
        window.harness.key_press(Key::Escape);
        window.harness.run_steps(3);
    }
    window.until("the dialog is closed", |window| window.app().live().is_none());
    window.harness.state_mut().command(Command::Camera);
    window.until("the third is open", Window::is_live);
    assert_eq!((open.load(Ordering::Relaxed), most.load(Ordering::Relaxed)), (1, 1), "one at a time");
}

#[test]
fn another_size_than_chosen_is_reported() {
    let (mut window, _) = live(Fake::default());
    window.until("the size is there", |window| window.says("96×64 px, asked for 640×480"));
    window.choose("Size", "320×240 px");
    window.choose("Estimator", "Diamond search");
    window.until("it runs", |window| window.says("Diamond search: "));
    window.until("the size is there", |window| window.says("96×64 px, asked for 320×240"));
}

#[test]
fn the_dialog_fits_the_lecture_hall() {
    for (theme, size) in [(Command::ProjectorTheme, vec2(1280.0, 720.0)), (Command::LightTheme, vec2(800.0, 560.0))] {
        let mut window = Window::new(size);
        window.command(theme);
        window.harness.state_mut().use_cameras(Arc::new(Fake::default()));
        window.harness.state_mut().command(Command::Camera);
        window.until("a frame comes", Window::is_live);
        window.choose("Estimator", "Diamond search");
        window.until("its rate is told", |window| window.says("Diamond search: "));
        window.lies_inside(size, "camera");
        language::check(language::labels(&window).into_iter().map(|text| ("camera", text)));
        let pictures = window.harness.query_all_by_label_contains("Stage: Frame t =").map(|node| node.rect().height());
        let largest = pictures.fold(0.0, f32::max);
        assert!(largest > 0.4 * size.y / window.harness.ctx.zoom_factor(), "{largest}");
    }
}
