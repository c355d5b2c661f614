//! Files given to a page, up to the window: what is opened of them, what is missing, and what is forgotten.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::vec2;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use motionscope::experiment::Position;
use motionscope::experiment::source::Source;
use motionscope::files;
use motionscope::files::given::{self, Arrival, GivenFile};
use motionscope::media::export;
use motionscope::paint::Freehand;
use motionscope::session::Session;
use motionscope::ui::app::App;
use motionscope::ui::{self, Start};
use motionscope::view::look::Look;
use motionscope::work;
use motionscope_core::synth;

/// The window of a page, and the waiting for its work.
struct Page(Harness<'static, App>);

impl Page {
    fn open() -> Self {
        let build = |cc: &mut eframe::CreationContext<'static>| {
            let mut app = App::new(&cc.egui_ctx, None).expect("a thread");
            ui::begin(&mut app, Start::default());
            app
        };
        let builder = Harness::builder().with_size(vec2(1280.0, 720.0)).with_step_dt(1.0 / 60.0).with_max_steps(80);
        let mut page = Self(builder.build_eframe(build));
        page.settle();
        page
    }

    fn settle(&mut self) {
        let begun = Instant::now();
        for _ in 0..3 {
            self.0.run_steps(1);
            self.0.state_mut().wait();
            while self.0.try_run().is_err() {
                assert!(begun.elapsed() < Duration::from_secs(60), "it does not come to rest");
            }
        }
    }

    fn give(&mut self, files: impl IntoIterator<Item = (String, Vec<u8>)>) {
        let files = files.into_iter().map(|(name, bytes)| GivenFile { name, bytes: bytes.into() }).collect();
        given::arrive(Arrival { files: Ok(files), is_chosen: false });
        self.settle();
    }

    /// The path of the open clip.
    fn path(&self) -> PathBuf {
        match self.0.state().document().source() {
            Some(Source::File(path)) => path.clone(),
            other => panic!("no file is open: {other:?}"),
        }
    }
}

/// A folder called `name` with the frames and the truth of a scene, and the same as a video.
fn clip(name: &str) -> (Vec<(String, Vec<u8>)>, Vec<u8>) {
    let mut difficulty = synth::SCENES[0].difficulty();
    (difficulty.frames, difficulty.width, difficulty.height) = (3, 96, 64);
    let clip = synth::SCENES[0].clip(&difficulty).expect("a clip in a folder");
    let folder = tempfile::tempdir().expect("a clip in a folder");
    work::finish(export::clip(&clip, folder.path(), None)).expect("a clip in a folder");
    let mut files = Vec::new();
    for path in [folder.path().to_owned(), folder.path().join("flow")].iter().flat_map(|folder| files::entries(folder))
    {
        if path.is_file() {
            let inner =
                path.strip_prefix(folder.path()).expect("a clip in a folder").to_str().expect("a clip in a folder");
            files.push((format!("{name}/{inner}"), files::read(&path).expect("a clip in a folder")));
        }
    }
    let frames = (0..3).flat_map(|t| {
        [b"FRAME\n".to_vec(), clip.frame(t).expect("a clip in a folder").luma().cells().to_vec()].concat()
    });
    let video = b"YUV4MPEG2 W96 H64 F25:1 Cmono\n".iter().copied().chain(frames).collect();
    (files, video)
}

#[test]
fn a_clip_is_given_saved_in_a_session_and_given_again() {
    let mut page = Page::open();
    let (folder, video) = clip("frames");

    page.give(folder);
    let first = page.path();
    assert_eq!((first.starts_with("/given"), first.file_name().unwrap().to_str()), (true, Some("frames")));
    let opened = page.0.state().document().clip().expect("a clip").clone();
    assert_eq!(opened.info().frames, Some(3));
    assert!(opened.truth().is_some_and(|truth| truth.kinds().contains(&"flow")), "the truth is found beside it");

    page.give([("gt.txt".into(), b"1,1,10,20.5,30,40,1,1,0.9\n".to_vec()), ("a.y4m".into(), video.clone())]);
    let second = page.path();
    assert!(second.ends_with("a.y4m") && !files::exists(&first), "what is open no more is forgotten");

    // Saved as a download, a session names the clip as it was given.
    let experiment = page.0.state().document().experiment().clone();
    let saved = Path::new("/saved/a.motionscope");
    files::create_dir_all(Path::new("/saved")).unwrap();
    let position = Position { cursor: None, held: None };
    let (look, freehand) = (Look::default().into(), Freehand::default());
    Session { experiment, position, look, sight: None, freehand }.save(saved).unwrap();
    let text = files::read_to_string(saved).unwrap();
    assert!(text.contains("clip = \"a.y4m\""), "{text}");

    // Given alone, it asks for the clip; with the clip it opens.
    let session = [("a.motionscope".to_owned(), text.into_bytes())];
    page.give(session);
    assert_eq!(page.path(), second, "nothing else is open yet");
    assert!(page.0.query_all_by_label_contains("a.y4m: ").next().is_some(), "the missing file is named");
    page.give([("deep/a.y4m".into(), video)]);
    let third = page.path();
    assert!(third.ends_with("deep/a.y4m") && third != second);

    // A file that cannot be opened is reported, and the clip stays.
    page.give([("odd.bin".into(), vec![0xFF; 999])]);
    assert_eq!(page.path(), third);
}
