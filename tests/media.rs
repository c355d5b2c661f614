//! Clips of every kind, whole and damaged, through the one door.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use motionscope::files;
use motionscope::files::given::{self, GivenFile};
use motionscope::media::{Open, OpenedClip, Progress, export, open};
use motionscope::work;
use motionscope_core::base::Error;
use motionscope_core::data::{Clip, Frame};
use proptest::prelude::*;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

/// By our own decoders alone, so that every computer gives the same answers.
fn ours() -> Open {
    Open { ffmpeg: false, ..Open::default() }
}

fn own(name: &str) -> Clip {
    open(&fixture(name), &ours()).expect("the fixture opens").clip
}

fn refusal(path: &Path) -> String {
    open(path, &ours()).expect_err("it must be refused").to_string()
}

#[test]
fn facts_of_every_fixture() {
    let cases = [
        ("h264_bframes.mp4", "mp4 h264", (64, 48), 12, 25.0, ""),
        ("h264_baseline.mp4", "mp4 h264", (64, 48), 10, 25.0, ""),
        ("h264_open_gop.mp4", "mp4 h264", (64, 48), 16, 25.0, ""),
        ("h264_fragmented.mp4", "mp4 h264", (64, 48), 12, 25.0, ""),
        ("h264_interlaced.mp4", "mp4 h264", (64, 48), 8, 25.0, "interlaced"),
        ("h264_10bit.mp4", "mp4 h264", (64, 48), 6, 25.0, "10 bits"),
        ("h264_422.mp4", "mp4 h264", (64, 48), 6, 25.0, ""),
        ("h264_gray.mp4", "mp4 h264", (64, 48), 4, 25.0, ""),
        ("h264_cropped.mp4", "mp4 h264", (50, 38), 4, 25.0, ""),
        ("h264_vfr.mp4", "mp4 h264", (64, 48), 8, 17.5, "varies from 12.500 to 25.000"),
        ("h264_rotated.mov", "mov h264", (48, 64), 12, 25.0, ""),
        ("h264_edited.mp4", "mp4 h264", (64, 48), 9, 25.0, ""),
        ("h264.mkv", "matroska h264", (64, 48), 10, 25.0, ""),
        ("vp9.webm", "webm vp9", (64, 48), 12, 25.0, ""),
        ("vp9_alt_ref.webm", "webm vp9", (64, 48), 20, 25.0, ""),
        ("vp9_10bit.webm", "webm vp9", (64, 48), 4, 25.0, "10 bits"),
        ("vp9_odd.webm", "webm vp9", (37, 21), 4, 25.0, "28:37"),
        ("vp9.mp4", "mp4 vp9", (64, 48), 6, 25.0, ""),
        ("mjpeg.avi", "avi mjpeg", (64, 48), 4, 25.0, ""),
        ("mjpeg_422.avi", "avi mjpeg", (64, 48), 3, 25.0, ""),
    ];
    for (name, kind, size, frames, fps, warning) in cases {
        let clip = own(name);
        let info = clip.info();
        assert_eq!(format!("{} {}", info.container, info.codec), kind, "{name}");
        assert_eq!((clip.size(), info.frames), (size, Some(frames)), "{name}");
        assert!((info.fps.unwrap() - fps).abs() < 0.01, "{name}: {:?}", info.fps);
        match warning {
            "" => assert!(info.warnings.is_empty(), "{name}: {:?}", info.warnings),
            _ => assert!(info.warnings.len() == 1 && info.warnings[0].contains(warning), "{name}: {:?}", info.warnings),
        }
        assert!((0..frames).all(|t| clip.frame(t).unwrap().size() == size), "{name}");
        assert!(clip.frame(frames).is_err(), "{name}");
    }
}

#[test]
fn colours_are_right() {
    // ffmpeg's 8-bit RGB of the same pixels, which may round otherwise by a little.
    let cases = [
        ("h264_full_709.mp4", [(5, 5), (30, 20), (60, 40)]),
        ("h264_bframes.mp4", [(5, 5), (30, 20), (60, 40)]),
        ("vp9_444.webm", [(5, 5), (30, 20), (60, 40)]),
    ];
    let table = fs::read_to_string(fixture("colors.txt")).unwrap();
    for (name, places) in cases {
        let frame = own(name).frame(0).unwrap();
        let line = table.lines().find_map(|line| line.strip_prefix(name)).unwrap();
        let known: Vec<i32> = line.split_whitespace().map(|v| v.parse().unwrap()).collect();
        for ((x, y), known) in places.into_iter().zip(known.chunks(3)) {
            let ours = frame.color().unwrap()[(x, y)].map(i32::from);
            let far = ours.iter().zip(known).map(|(a, b)| (a - b).abs()).max().unwrap();
            assert!(far <= 3, "{name} at {x}, {y}: {ours:?} is not {known:?}");
        }
    }
}

#[test]
fn a_rotated_clip_stands_upright() {
    let (stored, shown) = (own("h264_bframes.mp4"), own("h264_rotated.mov"));
    for t in 0..12 {
        let (stored, shown) = (stored.frame(t).unwrap(), shown.frame(t).unwrap());
        // A quarter turn against the clock, as ffmpeg shows it.
        assert!((0..48).all(|x| (0..64).all(|y| shown.luma()[(x, y)] == stored.luma()[(63 - y, x)])), "frame {t}");
    }
}

#[test]
fn an_edit_leaves_out_what_it_says() {
    let (whole, edited) = (own("h264_bframes.mp4"), own("h264_edited.mp4"));
    for t in 0..9 {
        assert_eq!(edited.frame(t).unwrap(), whole.frame(t + 3).unwrap());
    }
}

#[test]
fn frames_on_the_way_are_at_hand() {
    // A key frame every five.
    let clip = own("h264_baseline.mp4");
    clip.frame(8).unwrap();
    let at_hand: Vec<_> = (0..10).filter(|&t| clip.cached(t).is_some()).collect();
    assert_eq!(at_hand, [5, 6, 7, 8]);
}

#[test]
fn a_false_name_is_reported_and_the_clip_opens() {
    let folder = tempfile::tempdir().unwrap();
    for (name, false_name, words) in [
        ("vp9.webm", "clip.mp4", "named .mp4 but holds Matroska or WebM"),
        ("h264_baseline.mp4", "clip.avi", "named .avi but holds MP4"),
        ("mjpeg.avi", "clip.png", "named .png but holds AVI"),
    ] {
        let path = folder.path().join(false_name);
        fs::copy(fixture(name), &path).unwrap();
        let clip = open(&path, &ours()).unwrap().clip;
        assert!(clip.info().warnings[0].contains(words), "{:?}", clip.info().warnings);
        assert!(clip.frame(1).is_ok());
    }
}

#[test]
fn what_cannot_be_opened_says_why_and_what_to_do() {
    let cases = [
        ("encrypted.mp4", ["encrypted", "unprotected copy"]),
        ("sound.m4a", ["sound but no video", "open"]),
        ("vp8.webm", ["vp8", "ffmpeg"]),
        ("mpeg4.avi", ["mpeg4", "ffmpeg"]),
        ("h264_444.mp4", ["4:4:4", "ffmpeg"]),
        ("missing.mp4", ["no such file", "path"]),
    ];
    for (name, words) in cases {
        let told = refusal(&fixture(name));
        assert!(told.contains(name) && words.iter().all(|word| told.contains(word)), "{told}");
    }
    let folder = tempfile::tempdir().unwrap();
    for (bytes, words) in [
        (b"".as_slice(), ["empty", "copy"]),
        (b"\x01\x02 this is no video at all", ["format is not known", "convert"]),
        (b"Dear student, this is no video at all.", ["it is text", "open a video"]),
        (b"1,1,10,20,30,40,1,1,1\n", ["MOTChallenge", "--truth"]),
        (b"\0\0\0\x08ftyp", ["index", "copy"]),
        (b"\0\0\0\x08ftyp\0\0\0\x08moov", ["no video track", "open"]),
        (b"\x1A\x45\xDF\xA3\x80\x18\x53\x80\x67\x80", ["no video track", "open"]),
        (b"RIFF\xFF\xFF\xFF\xFFAVI ", ["header is missing", "copy"]),
    ] {
        let path = folder.path().join("clip.bin");
        fs::write(&path, bytes).unwrap();
        let told = refusal(&path);
        assert!(told.contains("clip.bin") && words.iter().all(|word| told.contains(word)), "{told}");
    }
}

#[test]
fn other_codecs_open_by_ffmpeg_or_say_so() {
    for (name, frames) in [("vp8.webm", 4), ("mpeg4.avi", 6), ("mpeg4.mp4", 60), ("h264_444.mp4", 3)] {
        match open(&fixture(name), &Open::default()) {
            Ok(OpenedClip { clip, .. }) => {
                assert_eq!((clip.size(), clip.info().frames), ((64, 48), Some(frames)), "{name}");
                assert!(clip.info().warnings[0].contains("ffmpeg"));
                let forwards: Vec<_> = (0..frames).map(|t| clip.frame(t).unwrap()).collect();
                let small = open(&fixture(name), &Open { cache_bytes: 0, ..Open::default() }).unwrap().clip;
                assert!((0..frames).rev().all(|t| small.frame(t).unwrap() == forwards[t]), "{name}");
            }
            Err(error) => assert!(error.to_string().contains("install ffmpeg"), "{error}"),
        }
    }
}

#[test]
fn no_video_is_made_of_text() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (1..3000).map(|t| format!("{t},1,10,20,30,40,1,1,1\n")).collect();
    // Colours and shades of gray for an old terminal, which are not UTF-8.
    let shades = [b"\x1B[1;31m\xB0\xB1\xB2\xDB\xDB\xDB\xDB\xDB\xDB\xDB\r\n".repeat(2000), vec![0x1A]].concat();
    for (name, bytes) in [("gt.txt", rows.as_bytes()), ("big.nfo", rows.as_bytes()), ("art.ans", &shades)] {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let told = open(&path, &Open::default()).expect_err("it is no clip").to_string();
        assert!(told.contains(name) && ["--truth", "convert"].iter().any(|word| told.contains(word)), "{told}");
    }
}

struct Impatient(AtomicUsize);

impl Progress for Impatient {
    fn report(&self, fraction: f32) {
        assert!((0.0..=1.0).contains(&fraction));
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) > 0
    }
}

#[test]
fn opening_can_be_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.y4m");
    let frames = b"FRAME\n\x10".repeat(5000);
    fs::write(&path, [b"YUV4MPEG2 W1 H1 Cmono\n".as_slice(), &frames].concat()).unwrap();
    let progress = Arc::new(Impatient(AtomicUsize::new(0)));
    let options = Open { progress: Some(progress.clone()), ..ours() };
    assert!(open(&path, &options).unwrap_err().to_string().contains("cancelled"));
    assert_eq!(progress.0.load(Ordering::Relaxed), 1);
    assert_eq!(open(&path, &ours()).unwrap().clip.info().frames, Some(5000));
}

const WHOLE: [&str; 16] = [
    "h264_bframes.mp4",
    "h264_baseline.mp4",
    "h264_fragmented.mp4",
    "h264_interlaced.mp4",
    "h264_10bit.mp4",
    "h264_422.mp4",
    "h264_rotated.mov",
    "h264_edited.mp4",
    "h264.mkv",
    "vp9.webm",
    "vp9_alt_ref.webm",
    "vp9_10bit.webm",
    "vp9_444.webm",
    "vp9.mp4",
    "mjpeg.avi",
    "mjpeg_422.avi",
];

/// Opens `bytes` and asks for every frame; what fails must say where.
fn survive(bytes: &[u8]) -> Result<usize, Error> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("damaged.clip");
    fs::write(&path, bytes).expect("written");
    let opened = open(&path, &ours());
    let OpenedClip { clip, .. } =
        opened.inspect_err(|error| assert!(error.to_string().contains("damaged.clip"), "{error}"))?;
    let frames = clip.info().frames.expect("counted");
    let shown = |&t: &usize| match clip.frame(t) {
        Ok(frame) => frame.size() == clip.size(),
        Err(error) => {
            assert!(error.to_string().contains(&format!("frame {t} of damaged.clip")), "{error}");
            false
        }
    };
    Ok((0..frames.min(100)).filter(shown).count())
}

#[test]
fn a_picture_with_a_hole_is_not_passed_off_as_whole() {
    let whole = fs::read(fixture("h264_bframes.mp4")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flipped.mp4");
    let mut told = 0;
    for at in (whole.len() / 4..whole.len()).step_by(97) {
        let mut bytes = whole.clone();
        bytes[at..(at + 40).min(whole.len())].iter_mut().for_each(|byte| *byte ^= 0x5A);
        fs::write(&path, &bytes).unwrap();
        let Ok(OpenedClip { clip, .. }) = open(&path, &ours()) else { continue };
        for index in 0..clip.info().frames.unwrap_or(0) {
            match clip.frame(index) {
                Ok(frame) => assert!(!is_green_somewhere(&frame), "frame {index}, flipped at {at}"),
                Err(error) => told += usize::from(error.to_string().contains("missing")),
            }
        }
    }
    assert!(told > 0, "no flip leaves a hole");
}

/// Whether a whole macroblock has the one green that means that nothing was decoded.
fn is_green_somewhere(frame: &Frame) -> bool {
    let rgb = frame.color().expect("colours");
    let green = |x: usize, y: usize| {
        let [r, g, b] = rgb[(x, y)];
        r == 0 && g >= 100 && b == 0
    };
    let corners = |x: usize, y: usize| (0..16).all(|d| green(x + d, y + d) && green(x + 15 - d, y + d));
    (0..rgb.height() / 16).any(|y| (0..rgb.width() / 16).any(|x| corners(16 * x, 16 * y)))
}

#[test]
fn a_cut_file_keeps_the_frames_before_the_cut() {
    for name in ["h264_fragmented.mp4", "h264.mkv", "vp9.webm", "mjpeg.avi"] {
        let bytes = fs::read(fixture(name)).unwrap();
        let whole = survive(&bytes).unwrap();
        let part = survive(&bytes[..bytes.len() * 8 / 10]).unwrap();
        assert!(part > 0 && part < whole, "{name}: {part} of {whole}");
    }
}

#[test]
fn matroska_that_is_cut_anywhere_keeps_what_is_whole_or_says_so() {
    for name in ["vp9.webm", "h264.mkv"] {
        let bytes = fs::read(fixture(name)).unwrap();
        let mut found = 0;
        // Headers byte by byte.
        for cut in (4..700).chain((700..=bytes.len()).step_by(29)) {
            match survive(&bytes[..cut]) {
                Ok(shown) => {
                    assert!(shown >= found.max(1), "{name} cut at {cut}: {shown} frames");
                    found = shown;
                }
                Err(error) => {
                    let told = error.to_string();
                    assert!(found == 0 && told.contains("cut off") && told.contains("copy"), "{cut}: {told}");
                }
            }
        }
        assert_eq!(found, own(name).info().frames.unwrap(), "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(250))]

    #[test]
    fn damage_never_panics(
        which in 0..WHOLE.len(),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        head in any::<bool>(),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = fs::read(fixture(WHOLE[which])).unwrap();
        // Headers are short and easily missed.
        let reach = if head { bytes.len().min(900) } else { bytes.len() };
        for (at, value) in flips {
            bytes[at.index(reach)] ^= value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = survive(&bytes);
    }
}

/// All files below `folder`, as they are given to a page.
fn given_files(folder: &Path, around: &str) -> Vec<GivenFile> {
    let entries = fs::read_dir(folder).expect("a file").map(|entry| entry.expect("a file").path());
    let files = entries.flat_map(|path| {
        let name = format!("{around}{}", path.file_name().expect("a file").to_str().expect("a file"));
        match path.is_dir() {
            true => given_files(&path, &format!("{name}/")),
            false => vec![GivenFile { name, bytes: fs::read(&path).expect("a file").into() }],
        }
    });
    files.collect()
}

/// All that is known of the clip at `path`: its facts, its frames and their truth, or why it is not opened.
fn everything(path: &Path) -> String {
    let clip = match open(path, &ours()) {
        Ok(opened) => opened.clip,
        Err(error) => return error.to_string().replace(&path.display().to_string(), &files::label(path).to_string()),
    };
    let digest = |value: String| export::hash(value.as_bytes());
    let mut known = vec![format!("{:?} {:?}", clip.info(), clip.calibration())];
    for t in 0..clip.info().frames.unwrap_or(2) {
        known.push(format!("{:x}", digest(format!("{:?}", clip.frame(t).map(|frame| frame.luma().clone())))));
        if let Some(truth) = clip.truth() {
            let fields = format!("{:?} {:?}", truth.flow(t), truth.occlusion(t));
            let objects = format!("{:?} {:?} {:?}", truth.objects(t), truth.foreground(t), truth.disparity(t));
            known.push(format!("{:x} {:x}", digest(fields), digest(objects)));
        }
    }
    known.join("\n")
}

#[test]
fn memory_gives_the_same_clips_as_the_disk() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let given = given::take(given_files(&folder, "")).unwrap();
    let entries = files::entries(&given).collect::<Vec<_>>();
    assert!(entries.len() > 20);
    for path in entries {
        let name = path.file_name().unwrap().to_str().unwrap();
        let (found, wanted) = (everything(&path), everything(&folder.join(name)));
        assert_eq!(found, wanted.replace(&folder.join(name).display().to_string(), name), "{name}");
    }
}

#[test]
fn pictures_in_memory_come_with_their_ground_truth_and_their_right_view() {
    let folder = tempfile::tempdir().unwrap();
    for scene in motionscope_core::synth::SCENES {
        let mut difficulty = scene.difficulty();
        (difficulty.frames, difficulty.width, difficulty.height) = (3, 96, 64);
        let Ok(clip) = scene.clip(&difficulty) else { continue };
        work::finish(export::clip(&clip, &folder.path().join(scene.id), None)).unwrap();
    }
    let given = given::take(given_files(folder.path(), "")).unwrap();
    let mut kinds = std::collections::BTreeSet::new();
    for path in files::entries(&given) {
        let on_disk = folder.path().join(path.file_name().unwrap());
        assert_eq!(everything(&path), everything(&on_disk), "{}", path.display());
        let clip = open(&path, &ours()).unwrap().clip;
        kinds.extend(clip.truth().iter().flat_map(|truth| truth.kinds()));
        kinds.extend(clip.right().map(|_| "right view"));
    }
    assert!(["flow", "occlusion", "right view"].iter().all(|kind| kinds.contains(kind)), "{kinds:?}");
}

#[test]
fn a_clip_is_saved_to_memory_as_to_the_disk() {
    let clip = own("h264_gray.mp4");
    let (disk, memory) = (tempfile::tempdir().unwrap(), Path::new("/saved/clip"));
    files::create_dir_all(memory).unwrap();
    // A second time over the first.
    for _ in 0..2 {
        work::finish(export::clip(&clip, disk.path(), None)).unwrap();
        work::finish(export::clip(&clip, memory, None)).unwrap();
    }
    let names = |folder: &Path| -> Vec<_> {
        let names = files::entries(folder).map(|path| path.file_name().unwrap().to_owned());
        names.collect::<std::collections::BTreeSet<_>>().into_iter().collect()
    };
    assert_eq!(names(memory), names(disk.path()), "and nothing unfinished");
    for name in names(memory) {
        assert_eq!(files::read(&memory.join(&name)).unwrap(), fs::read(disk.path().join(&name)).unwrap(), "{name:?}");
    }
    let copied = Path::new("/saved/copy.mp4");
    work::finish(export::copy(&fixture("h264_gray.mp4"), copied)).unwrap();
    assert_eq!(everything(copied).replace("copy.mp4", "h264_gray.mp4"), everything(&fixture("h264_gray.mp4")));
    assert!(export::save(Path::new("/saved/no/a.png"), b"x").unwrap_err().to_string().contains("there is no folder"));
}
