//! Sessions as they are written and read.

use std::fs;

use motionscope_core::course::{estimator, estimators};
use motionscope_core::params::{Kind, Params, Spot, Value};
use motionscope_core::run::{Cursor, Pace};
use motionscope_core::scene::Picture;

use super::write::{relative, slashed};
use super::*;
use crate::experiment::pixel::Held;
use crate::experiment::side_by_side::SideBySide;
use crate::media::{GivenCalibration, RightView};
use crate::paint::{
    Backdrop, ColorMap, FlowLayer, FocusMode, Freehand, FreehandLine, Ground, Lengthen, LevelShown, Opacity, PenColor,
    Phase, Share, SvgText, Theme, View,
};
use crate::view::look::{CaptionWords, Look};

/// Four lines, one of them on another picture and two on charts of the second estimator in lockstep.
fn ink() -> Freehand {
    let (step, color) = (Cursor { unit: 35, event: 412 }, PenColor::default());
    let dot = FreehandLine { step, member: 0, on: Picture::CURRENT.into(), color, points: vec![[120.5, 33.0]] };
    let points = vec![[-0.25, 3.0], [4.75, 6.01]];
    let next = FreehandLine { member: 1, on: Picture::NEXT.into(), color: PenColor::Blue, points, ..dot.clone() };
    let on = Ground::Chart { pane: "surface", size: [412.5, 300.0], view: None };
    let chart = FreehandLine { member: 1, on, points: vec![[20.0, 31.25]], ..dot.clone() };
    let on = Ground::Chart { pane: "surface-3d", size: [410.0, 300.0], view: Some([-0.5, 0.75, 1.5, 0.0, 0.0, 0.0]) };
    let turned = FreehandLine { on, ..chart.clone() };
    Freehand { lines: vec![dot, next, chart, turned] }
}

pub(super) fn session(source: Source) -> Session {
    let mut estimator = estimator("full-search").unwrap();
    estimator.set("block-size", "8").unwrap();
    estimator.set("early-exit", "on").unwrap();
    let mut side_by_side = SideBySide::of(&*estimator, &["diamond", "hierarchical"], Pace::Budget).unwrap();
    side_by_side.set(&mut *estimator, "hierarchical.levels=4").unwrap();
    let look = Look {
        view: Some(View::Blend),
        level: LevelShown::Number(2),
        blend: Share::new(0.8).unwrap(),
        theme: Theme::Projector,
        legend: true,
        ..Look::default()
    };
    let sight = Some(VisiblePart { center: [10.5, 3.0], zoom: 4.0, size: Some([96.3, 72.0]) });
    let held = Some(Held { pixel: "303,202".parse().expect("a pixel"), object: None });
    let position = Position { cursor: Some(Cursor { unit: 35, event: 412 }), held };
    let experiment = Experiment { side_by_side, frame: 12, ..Experiment::new(source, estimator) };
    Session { experiment, position, look: look.into(), sight, freehand: ink() }
}

#[test]
fn what_was_saved_opens_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let clip = folder.path().join("clips").join("a.mp4");
    let path = folder.path().join("lessons").join("one.motionscope");
    fs::create_dir(path.parent().unwrap()).unwrap();
    for source in [Source::File(clip), Source::parse("synth:pillar,noise=5").unwrap()] {
        let saved = session(source.clone());
        saved.save(&path).unwrap();
        let read = Session::load(&path).unwrap();
        if let (Source::File(read), Source::File(_)) = (&read.experiment.source, &source) {
            assert!(fs::read_to_string(&path).unwrap().contains("clip = \"../clips/a.mp4\""));
            assert_eq!(*read, path.parent().unwrap().join("../clips/a.mp4"));
        }
        let experiment = Experiment { source, ..read.experiment };
        assert!(Session { experiment, ..read } == saved);
    }
}

#[test]
fn wrong_ink_is_reported_with_its_line_and_its_key() {
    let text = session(Source::parse("synth:pillar").unwrap()).text(Path::new(".")).unwrap();
    assert!(text.contains("points = \"-0.25,3 4.75,6.01\""), "{text}");
    for (right, wrong, said) in [
        ("points = \"120.5,33\"", "points = \"120.5;33\"", "X,Y in px"),
        ("points = \"120.5,33\"", "points = \"120.5,NaN\"", "X,Y in px"),
        ("points = \"120.5,33\"", "points = \" \"", "at least one point"),
        ("points = \"120.5,33\"\n", "", "has no key points"),
        ("color = \"blue\"", "color = \"pink\"", "vermilion, yellow, blue, green"),
        ("estimator = 2\ncolor", "estimator = 4\ncolor", "from 1 to 3"),
        ("estimator = 2\ncolor", "estimator = 0\ncolor", "from 1 to 3"),
        ("picture = \"t+1\"", "picture = \"frame\"", "t+1, t-1"),
        ("chart = \"surface\"", "chart = \"shape\"", "there is no pane shape"),
        ("chart = \"surface\"", "chart = \"stage\"", "chart: stage is no chart; the charts are surface, "),
        ("chart = \"surface\"", "chart = \"explanation\"", "ink.chart: explanation is no chart"),
        ("chart = \"surface\"", "picture = \"t+1\"\nchart = \"surface\"", "ink.picture: a line lies on a picture or"),
        ("view = [-0.5, ", "view = [nan, ", "ink.view: the view of a chart has finite numbers"),
        ("view = [-0.5, ", "view = [", "ink.view: a list of 6 numbers is needed"),
        ("size = [412.5, 300.0]", "size = [0, 300]", "width and height of a chart"),
        ("size = [412.5, 300.0]\n", "", "has no key size"),
        ("color = \"blue\"", "colour = \"blue\"", "there is no key colour; the nearest is color"),
    ] {
        assert!(text.contains(right), "{right}: {text}");
        let message = Session::parse(&text.replace(right, wrong), Path::new(".")).err().map(|error| error.to_string());
        let is_told = |message: &String| message.contains(said) && message.contains("line ");
        assert!(message.as_ref().is_some_and(is_told), "{wrong}: {message:?}");
    }
}

#[test]
fn both_pictures_of_a_pair_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["a.png", "b.png"].map(|name| folder.path().join("clips").join(name));
    let path = folder.path().join("one.motionscope");
    session(Source::Pair(files.clone())).save(&path).unwrap();
    assert!(fs::read_to_string(&path).unwrap().contains("clip = \"pair:clips/a.png|clips/b.png\""));
    assert!(Session::load(&path).unwrap().experiment.source == Source::Pair(files));
}

#[test]
fn paths_are_reported_from_where_the_session_is() {
    let top = tempfile::tempdir().unwrap();
    let here = top.path().join("here");
    fs::create_dir_all(here.join("deep")).unwrap();
    let clip = here.join("a.mp4");
    fs::write(&clip, []).unwrap();
    for (folder, message) in [
        (here.clone(), "a.mp4"),
        (here.join("deep"), "../a.mp4"),
        (here.join("deep").join(".."), "a.mp4"),
        (here.join("deep").join("..").join(".."), "here/a.mp4"),
    ] {
        assert_eq!(slashed(&relative(&clip, &folder)).unwrap(), message, "{}", folder.display());
    }
    assert_eq!(folder_of(Path::new("one.motionscope")), Path::new("."));
}

#[test]
fn a_pixel_is_named_only_where_one_is_held() {
    let saved = session(Source::parse("synth:pillar").unwrap());
    let names = |session: &Session| session.text(Path::new(".")).unwrap().contains("\npixel = \"303,202\"\n");
    assert!(names(&saved));
    let free = Session { position: Position { held: None, ..saved.position }, ..saved };
    let text = free.text(Path::new(".")).unwrap();
    assert!(!text.contains("\npixel"), "{text}");
    assert_eq!(Session::parse(&text, Path::new(".")).unwrap().position.held, None);
}

#[test]
fn an_object_is_held_beside_its_pixel() {
    let saved = session(Source::parse("synth:pillar").unwrap());
    let held = saved.position.held.map(|held| Held { object: Some(7), ..held });
    let selected = Session { position: Position { held, ..saved.position }, ..saved };
    let text = selected.text(Path::new(".")).unwrap();
    assert!(text.contains("\npixel = \"303,202\"\nobject = 7\n"), "{text}");
    assert_eq!(Session::parse(&text, Path::new(".")).unwrap().position.held, held);
    for (wrong, said) in [("object = -1", "object"), ("object = 9999999999", "no such identity")] {
        let message = Session::parse(&text.replace("object = 7", wrong), Path::new(".")).err().map(|e| e.to_string());
        assert!(message.as_ref().is_some_and(|message| message.contains(said)), "{wrong}: {message:?}");
    }
    let alone = text.replace("pixel = \"303,202\"\n", "");
    let message = Session::parse(&alone, Path::new(".")).err().map(|error| error.to_string());
    assert!(message.as_ref().is_some_and(|message| message.contains("pixel, which is missing")), "{message:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn what_cannot_be_written_down_is_reported() {
    use std::os::unix::ffi::OsStrExt;
    let clip = Path::new(std::ffi::OsStr::from_bytes(b"caf\xE9.mp4"));
    let given = |given: Given| {
        let mut saved = session(Source::parse("synth:pillar").unwrap());
        saved.experiment.given = given;
        saved
    };
    let truth = given(Given { truth: Some(clip.into()), ..Given::default() });
    let detections = given(Given { detections: Some(clip.into()), ..Given::default() });
    for session in [session(Source::parse(clip).unwrap()), truth, detections] {
        let message = session.text(Path::new(".")).unwrap_err().to_string();
        assert!(message.contains("caf\u{FFFD}.mp4") && message.contains("rename"), "{message}");
    }
}

#[test]
fn what_a_session_does_not_say_is_left_as_it_is() {
    let start = "motionscope = 1\nclip = \"a.mp4\"\nestimator = \"full-search\"\n[picture]\n";
    let look = |picture: &str| Session::parse(&format!("{start}{picture}"), Path::new("")).unwrap().look;
    let usual = Look {
        view: Some(View::Blink),
        level: LevelShown::Number(1),
        focus: FocusMode::On,
        blend: Share::new(0.2).unwrap(),
        theme: Theme::Projector,
        colors: ColorMap::Turbo,
        layer: Some(FlowLayer::Magnitude),
        layer_opacity: Opacity::new(0.3).ok(),
        color_scale: Some(4.0),
        backdrop: Backdrop::Plain,
        arrow_spacing: Some(24),
        arrow_scale: Lengthen::Times(4.0),
        streaks: Some(Phase::default()),
        landscape: true,
        legend: true,
        caption: CaptionWords::On,
        svg_text: SvgText::Live,
    };
    assert_eq!(look("").over(usual), usual);
    assert_eq!(look("arrows = \"auto\"").over(usual), Look { arrow_scale: Lengthen::Auto, ..usual });
    assert_eq!(look("layer = \"auto\"\nstreaks = \"off\"").over(usual), Look { layer: None, streaks: None, ..usual });
    assert_eq!(look("legend = false\ntheme = \"light\"").over(usual).theme, Theme::Light);
    assert_eq!(look("arrows = 2").over(usual).arrow_scale, Lengthen::Times(2.0));
    let motion = look("layer = \"error\"\nlayer-opacity = 1\narrow-spacing = 9\nstreaks = 0.25").over(usual);
    let wanted = (Some(FlowLayer::Error), Some(9), Phase::new(0.25).ok());
    assert_eq!((motion.layer, motion.arrow_spacing, motion.streaks), wanted);
    assert_eq!(motion.layer_opacity, Opacity::new(1.0).ok());
    assert_eq!(look("level = 2").over(usual).level, LevelShown::Number(2));
    assert_eq!(look("level = \"at-work\"").over(usual).level, LevelShown::AtWork);
    let wrong = Session::parse(&format!("{start}level = \"top\""), Path::new("")).err().unwrap();
    assert!(wrong.to_string().contains("0 to 99 or at-work"), "{wrong}");
}

#[test]
fn a_sight_that_cannot_be_is_left_out() {
    let start = "motionscope = 1\nclip = \"a.mp4\"\nestimator = \"full-search\"\n[sight]\n";
    for (sight, is_kept) in [
        ("center = [1, 2]\nzoom = 4", true),
        ("center = [1, 2]\nzoom = 4\nsize = [20, 15]", true),
        ("center = [1, 2]\nzoom = 4\nsize = [0, 15]", false),
        ("center = [1, 2]\nzoom = 4\nsize = [nan, 15]", false),
        ("center = [nan, 2]\nzoom = 4", false),
        ("center = [1, 2]\nzoom = inf", false),
    ] {
        let read = Session::parse(&format!("{start}{sight}"), Path::new("")).unwrap();
        assert_eq!(read.sight.is_some(), is_kept, "{sight}");
    }
}

#[test]
fn what_is_no_session_is_reported_in_a_sentence() {
    let parse = |text: &str| Session::parse(text, Path::new("")).err().map(|e| e.to_string()).unwrap_or_default();
    let start = "motionscope = 1\nclip = \"a.mp4\"\n";
    for (text, message) in [
        ("\u{0}PNG", "no Motionscope session"),
        ("clip = 3", "no Motionscope session"),
        ("motionscope = 2\nclip = \"a\"\nestimator = \"full-search\"", "its format version is 2"),
        ("motionscope = 0\nfilm = \"a\"", "its format version is 0"),
        (&format!("{start}estimator = \"magic\""), "full-search"),
        (&format!("{start}estimator = \"full-search\"\nstep = \"x\""), "UNIT.EVENT"),
        (&format!("{start}estimator = \"full-search\"\npixel = \"303\""), "X,Y"),
        (&format!("{start}estimator = \"full-search\"\n[[beside]]\nestimator = \"magic\""), "no estimator magic"),
        (&format!("{start}estimator = \"full-search\"\n[[beside]]\nestimator = \"kalman-filter\""), "on a whole clip"),
        (&format!("{start}estimator = \"full-search\"\npace = \"slow\""), "block, budget"),
        (&format!("{start}estimator = \"full-search\"\n[set]\nblock-size = 400"), "4 to 64 px"),
        (&format!("{start}estimator = \"full-search\"\n[picture]\nview = \"up\""), "side-by-side"),
        (&format!("{start}estimator = \"full-search\"\n[picture]\nblend = 1.5"), "0 to 1, not 1.5"),
        (&format!("{start}estimator = \"full-search\"\n[picture]\narrows = 1e38"), "0.01 to 100 or auto"),
        (&format!("{start}estimator = \"full-search\"\n[picture]\narrows = nan"), "0.01 to 100 or auto"),
        (&format!("{start}estimator = \"full-search\"\n[picture]\narrows = \"long\""), "or auto"),
    ] {
        assert!(parse(text).contains(message), "{text}: {}", parse(text));
    }
}

#[test]
fn line_and_key_are_reported_in_words() {
    let start = "motionscope = 1\nclip = \"a.mp4\"\nestimator = \"full-search\"\n";
    for (text, message) in [
        ("frame = \"x\"", "line 4, frame: a whole number is needed, not the text \"x\""),
        ("frame = -1", "line 4, frame: a whole number from 0 on is needed, not -1"),
        ("frame = 99999999999999999999", "line 4, frame: a whole number is needed, not 99999999999999999999"),
        ("frame = ", "line 4 is not written as key = value"),
        ("frame = 1\nframe = 2", "line 5 has a key that is there already"),
        ("step = 35.412", "line 4, step: a text in quotes is needed, not 35.412"),
        ("step = \"x\"", "line 4, step: a step is written UNIT.EVENT"),
        ("frmae = 3", "line 4: there is no key frmae; the nearest is frame"),
        ("clip.a = 3", "line 4 is not written as key = value"),
        ("\n[set]\n\nblock-size = 400", "line 7, set.block-size: "),
        ("[set]\nblock-size = [4]", "line 5, set.block-size: a single value is needed, not a list"),
        ("[set]\nblok = 4", "line 5, set.blok: "),
        ("set = 3", "line 4, set: a section is needed, not 3"),
        ("[picture]\nlevel = true", "line 5, picture.level: a number or a text in quotes is needed, not true"),
        ("[picture]\narrows = []", "line 5, picture.arrows: a number or a text in quotes is needed, not a list"),
        ("[picture]\nlegend = \"yes\"", "line 5, picture.legend: true or false is needed, not the text \"yes\""),
        ("[picture]\nstreaks = {}", "line 5, picture.streaks: a number or a text in quotes is needed, not a section"),
        ("[picture]\nblend = \"half\"", "line 5, picture.blend: a number is needed, not the text \"half\""),
        ("[picture]\nview = 3", "line 5, picture.view: a text in quotes is needed, not 3"),
        ("truth = 3", "line 4, truth: a text in quotes is needed, not 3"),
        (
            "disparity-scale = 0",
            "line 4, disparity-scale: the scale of a disparity is a positive number of gray levels per px, not 0",
        ),
        ("disparity-scale = -4", "line 4, disparity-scale: the scale of a disparity is a positive number"),
        ("disparity-scale = inf", "line 4, disparity-scale: the scale of a disparity is a positive number"),
        ("disparity-scale = nan", "line 4, disparity-scale: the scale of a disparity is a positive number"),
        ("detections = 3", "line 4, detections: a text in quotes is needed, not 3"),
        ("detections = []", "line 4, detections: a text in quotes is needed, not a list"),
        ("[picture]\nlooks = 1", "line 5: there is no key looks; there are view, level"),
        ("[sight]\ncenter = [1, 2, 3]\nzoom = 1", "line 5, sight.center: a list of 2 numbers is needed, not a list"),
        ("[sight]\ncenter = [1, 2]", "line 4: sight has no key zoom; add it"),
        ("[sight]\ncenter = [1, 2]\nzoom = 1\nsize = 3", "line 7, sight.size: a list of 2 numbers is needed, not 3"),
        ("beside = 1", "line 4, beside: a list of sections is needed, not 1"),
        ("[[beside]]\nset = {}", "line 4: beside has no key estimator; add it"),
        ("[[beside]]\nestimator = \"diamond\"\nset = { block-size = 400 }", "line 6, beside.set.block-size: "),
        ("[[beside]]\nestimator = \"magic\"", "line 5, beside.estimator: there is no estimator magic"),
    ] {
        let whole = format!("{start}{text}\n");
        let found = Session::parse(&whole, Path::new("")).err().map(|e| e.to_string()).unwrap_or_default();
        assert!(found.starts_with(message), "{text}: {found}");
        assert!(!found.contains("variant") && !found.contains("expected"), "{found}");
    }
    let lacks = Session::parse("motionscope = 1\nestimator = \"full-search\"", Path::new("")).err().unwrap();
    assert_eq!(lacks.to_string(), "it has no key clip; add a line clip = …");
}

#[test]
fn what_is_given_by_hand_is_named_from_where_the_session_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lessons/one.motionscope");
    fs::create_dir(path.parent().unwrap()).unwrap();
    let beside = |name: &str| Some(folder.path().join(name));
    let mut saved = session(Source::parse("synth:pillar").unwrap());
    let given = Given { truth: beside("gt.txt"), detections: beside("lessons/det.txt"), ..Given::default() };
    let right = Some(RightView::File(folder.path().join("right.mp4")));
    let calibration = Some(GivenCalibration::File(folder.path().join("calib.txt")));
    let depths = beside("depth");
    let contrast = "0..4095".parse().ok();
    saved.experiment.given =
        Given { right, calibration, disparity_scale: Some(4.0), depths, depth_scale: Some(1000.0), contrast, ..given };
    saved.save(&path).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("truth = \"../gt.txt\"\ndetections = \"det.txt\"\n"), "{text}");
    let of_views = "right = \"../right.mp4\"\ncalibration = \"../calib.txt\"\ndisparity-scale = 4.0\n";
    assert!(text.contains(of_views), "{text}");
    assert!(text.contains("depths = \"../depth\"\ndepth-scale = 1000.0\ncontrast = \"0..4095\"\n"), "{text}");
    let read = Session::load(&path).unwrap().experiment.given;
    let at = |name: &str| folder.path().join("lessons").join(name);
    let right = Some(RightView::File(at("../right.mp4")));
    let calibration = Some(GivenCalibration::File(at("../calib.txt")));
    let (truth, detections) = (Some(at("../gt.txt")), Some(at("det.txt")));
    let (depths, depth_scale) = (Some(at("../depth")), Some(1000.0));
    let disparity_scale = Some(4.0);
    assert_eq!(read, Given { truth, detections, right, calibration, disparity_scale, depths, depth_scale, contrast });
    // What the command line gives counts more, each by itself.
    let named =
        Named::find(path.as_os_str(), Given { detections: Some("mine.txt".into()), ..Given::default() }).unwrap();
    assert_eq!(named.given, Given { detections: Some("mine.txt".into()), ..read });
    // What is no file is not looked for beside the session.
    let typed = Given {
        right: Some(RightView::SideBySide),
        calibration: Some(GivenCalibration::of(Path::new("721.5,0.54"))),
        ..Given::default()
    };
    saved.experiment.given = typed.clone();
    saved.save(&path).unwrap();
    assert_eq!(Session::load(&path).unwrap().experiment.given, typed);
}

/// A value for `kind` that is in range, chosen by `dice`.
fn in_range(kind: &Kind, dice: u64) -> Value {
    match kind {
        Kind::Int { min, max } => Value::Int(min + (dice % (*max - *min + 1) as u64) as i64),
        Kind::Real { min, max } => Value::Real(min + (max - min) * ((dice % 1001) as f64 / 1000.0)),
        Kind::Switch => Value::Switch(dice.is_multiple_of(2)),
        Kind::Choice(all) => Value::Choice(all[dice as usize % all.len()].name),
        Kind::Placed(figure) if dice.is_multiple_of(3) => Value::Placed(figure.none()),
        Kind::Placed(figure) => {
            let at = |shift: u32| [(dice >> shift) % 97, (dice >> (shift + 7)) % 89].map(|c| c as f32 + 0.25);
            Value::Placed(figure.spanned(at(0), at(17).map(|c| c + 100.0)).with(Spot { frame: 1, at: at(5) }))
        }
        Kind::Stage(kind) => {
            let ids = kind.ids();
            let mut stage = kind.parse(ids[dice as usize % ids.len()]).unwrap();
            vary(stage.part_mut(), dice.rotate_left(9));
            Value::Stage(stage)
        }
        Kind::Optional { word, .. } if dice.is_multiple_of(3) => Value::Choice(word),
        Kind::Optional { of, .. } => in_range(of, dice),
    }
}

/// Sets every parameter to a value chosen by `dice`.
pub(super) fn vary<P: Params + ?Sized>(params: &mut P, dice: u64) {
    for (i, spec) in params.specs().iter().enumerate() {
        // SplitMix64's mixing: each parameter has its own number.
        let mixed = (dice ^ i as u64).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        params.set_value(i, in_range(&spec.kind, mixed ^ mixed >> 29)).unwrap();
    }
}

#[test]
fn every_estimator_with_any_parameters_comes_back() {
    let mut stages = 0;
    for dice in 0..20 {
        for mut estimator in estimators() {
            vary(&mut *estimator, dice);
            let (id, values) = (estimator.info().id, estimator.all_values());
            stages += values.iter().filter(|(name, _)| name.contains('.')).count();
            let mut look = Look::default();
            vary(&mut look, dice);
            let mut experiment = Experiment::new(Source::parse("synth:pillar").unwrap(), estimator);
            experiment.frame = dice as usize;
            let saved = Session {
                experiment,
                position: Position::default(),
                look: look.into(),
                sight: None,
                freehand: Freehand::default(),
            };
            let text = saved.text(Path::new(".")).unwrap();
            let read = Session::parse(&text, Path::new(".")).unwrap_or_else(|error| panic!("{id}: {error}\n{text}"));
            assert_eq!(read.experiment.estimator.all_values(), values, "{id}");
            assert!(read == saved, "{id}: {text}");
        }
    }
    assert!(stages > 500, "{stages} parameters of stages");
}

#[test]
fn those_beside_it_keep_the_parameters_of_their_stages() {
    for leader in estimators() {
        for (i, other) in estimators().into_iter().enumerate() {
            let Ok(mut side_by_side) = SideBySide::of(&*leader, &[other.info().id], Pace::Block) else { continue };
            let mut varied = other.boxed_clone();
            vary(&mut *varied, i as u64);
            for index in (0..varied.specs().len()).step_by(2) {
                side_by_side.beside[0].set_value(index, varied.value(index)).unwrap();
            }
            let mut saved = session(Source::parse("synth:pillar").unwrap());
            saved.experiment = Experiment { estimator: leader.boxed_clone(), side_by_side, ..saved.experiment };
            let read = Session::parse(&saved.text(Path::new(".")).unwrap(), Path::new(".")).unwrap();
            assert!(read == saved, "{} beside {}", other.info().id, leader.info().id);
        }
    }
}

#[test]
fn a_session_written_by_hand_opens_as_it_says() {
    let text = "motionscope = 1\nclip = \"a.mp4\"\ntruth = \"t.flo\"\nestimator = \"full-search\"\nframe = 3\nstep = \"30.2\"\n\
                [set]\nblock-size = 8\n[picture]\nview = \"blend\"\nlevel = \"at-work\"\nblend = 0.8\ntheme = \"light\"\n\
                colors = \"turbo\"\nlayer = \"error\"\nlayer-opacity = 0.5\narrows = 2.5\narrow-spacing = 16\nstreaks = 0.25\n\
                legend = false\ncaption = true\n";
    let Session { experiment, position, look, sight, freehand } = Session::parse(text, Path::new("there")).unwrap();
    assert_eq!(experiment.given, Given { truth: Some("there/t.flo".into()), ..Given::default() });
    assert_eq!((experiment.frame, experiment.estimator.get("block-size")), (3, Ok(Value::Int(8))));
    assert_eq!(position, Position { cursor: Some(Cursor { unit: 29, event: 2 }), held: None });
    let expected = Look {
        view: Some(View::Blend),
        level: LevelShown::AtWork,
        focus: FocusMode::Auto,
        blend: Share::new(0.8).unwrap(),
        theme: Theme::Light,
        colors: ColorMap::Turbo,
        layer: Some(FlowLayer::Error),
        layer_opacity: Opacity::new(0.5).ok(),
        color_scale: None,
        backdrop: Backdrop::Dimmed,
        arrow_spacing: Some(16),
        arrow_scale: Lengthen::Times(2.5),
        streaks: Phase::new(0.25).ok(),
        landscape: false,
        legend: false,
        caption: CaptionWords::On,
        svg_text: SvgText::Outlines,
    };
    assert_eq!(look.over(Look::default()), expected);
    assert_eq!((sight, freehand), (None, Freehand::default()));
}
