//! What the window opens and writes.

use std::ffi::OsStr;

use image::AnimationDecoder as _;

use super::*;

#[test]
fn the_step_is_exported_as_it_is_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    window.press(Modifiers::COMMAND, Key::E);
    window.click_role(Role::Button, "Theme: dark");
    let file = folder.path().join("step.png");
    write_to(&mut window, &file);
    let message = window.app().message().unwrap_or_default().to_owned();
    assert!(message.contains("Saved"), "{message}");
    let session = folder.path().join("step.motionscope");
    window.press(Modifiers::COMMAND, Key::S);
    write_to(&mut window, &session);
    let line = folder.path().join("line.png");
    paint(&session, 2, &line);
    assert!(fs::read(&file).expect("a picture") == fs::read(&line).expect("a picture"), "the pictures differ");
    let picture = image::open(&file).expect("a picture").to_rgb8();
    assert!(picture.width() >= 2 * 2 * 320 && picture.height() > 2 * 240, "{:?}", picture.dimensions());

    window.command(Command::ExportResult);
    let table = folder.path().join("vectors.csv");
    write_to(&mut window, &table);
    let text = fs::read_to_string(&table).expect("a table");
    assert_eq!(text.lines().count(), window.cursor().unit + 1, "a row for each finished block under the names");

    window.command(Command::ExportPicture);
    write_to(&mut window, &folder.path().join("no/such/folder/step.png"));
    let message = window.app().message().unwrap_or_default().to_owned();
    assert!(message.contains("Not saved"), "{message}");
    // The folder that was wrong is not offered again.
    window.command(Command::ExportPicture);
    let offered = window.harness.query_all_by_role(Role::TextInput).find_map(|node| node.accesskit_node().value());
    assert!(offered.is_some_and(|path| !path.contains("no/such")), "the last good folder is offered");
}

#[test]
fn a_page_is_light_and_its_words_are_outlines_unless_something_else_is_chosen() {
    let folder = tempfile::tempdir().expect("a folder");
    for command in [Command::DarkTheme, Command::ProjectorTheme] {
        let mut window = Window::usual();
        window.command(command);
        let own = window.app().settings().look.theme;
        let mut export = |name: &str, choices: &[&str]| {
            let file = folder.path().join(name);
            window.command(Command::ExportPicture);
            choices.iter().for_each(|choice| window.click_role(Role::Button, choice));
            write_to(&mut window, &file);
            assert_eq!(window.app().settings().look.theme, own, "the window keeps its theme");
            fs::read(&file).expect("a picture")
        };
        let mut corner = |choices: &[&str]| {
            let picture = export("page.png", &[&["Caption: sentence"][..], choices].concat());
            image::load_from_memory(&picture).expect("a picture").to_rgb8().get_pixel(0, 0).0
        };
        let panel = |theme: Theme| theme.chrome().panel.0[..3].to_vec();
        assert_eq!(corner(&[]).to_vec(), panel(Theme::Light));
        assert_eq!(corner(&[&*format!("Theme: {}", own.id())]).to_vec(), panel(own));
        let has_text = |svg: Vec<u8>| String::from_utf8_lossy(&svg).contains("<text");
        assert!(!has_text(export("page.svg", &["SVG", "Caption: sentence"])));
        assert!(has_text(export("page.svg", &["SVG", "Caption: sentence", "Words: live text"])));
    }
}

#[test]
fn a_range_of_steps_is_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    window.command(Command::ExportSteps);
    let unit = window.cursor().unit;
    let step = |event| Cursor { unit, event }.to_string();
    window.harness.get_by_label("First step").set_text_value_accesskit(&step(10));
    window.harness.get_by_label("Last step").set_text_value_accesskit(&step(13));
    window.settle();
    let granularity = window.shown().info.granularities[2];
    window.click_role(Role::Button, granularity);
    window.click_role(Role::Button, "1×");
    write_to(&mut window, folder.path());
    let mut files: Vec<_> =
        fs::read_dir(folder.path()).expect("the folder").map(|file| file.expect("a file").path()).collect();
    files.sort();
    let names: Vec<_> = (0..4).map(|index| folder.path().join(format!("step_0000{index}.png"))).collect();
    assert_eq!(files, names, "{:?}", window.app().message());
    // Each is the picture of its step.
    for (event, file) in (10..).zip(&files) {
        window.harness.get_by_label(&format!("Timeline, {granularity}s")).set_value_accesskit(event as f64);
        window.settle();
        assert_eq!(window.cursor(), Cursor { unit, event });
        window.command(Command::ExportPicture);
        window.click_role(Role::Button, "1×");
        let alone = folder.path().join("alone.png");
        write_to(&mut window, &alone);
        assert!(fs::read(file).expect("a picture") == fs::read(&alone).expect("a picture"), "step {event}");
    }
}

#[test]
fn a_range_of_steps_is_animated() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    window.command(Command::ExportSteps);
    let unit = window.cursor().unit;
    let step = |event| Cursor { unit, event }.to_string();
    window.harness.get_by_label("First step").set_text_value_accesskit(&step(10));
    window.harness.get_by_label("Last step").set_text_value_accesskit(&step(13));
    window.settle();
    assert!(window.harness.query_by_label("Rate").is_none(), "pictures have none");
    for label in ["GIF", "4", "1×", "Blended"] {
        window.click_role(Role::Button, label);
    }
    assert!(window.harness.query_by_label("4 steps.").is_some());
    let file = folder.path().join("steps.gif");
    write_to(&mut window, &file);
    let said = window.app().message().map(str::to_owned);
    assert!(said.as_ref().is_some_and(|said| said.starts_with("Saved 4 pictures as")), "{said:?}");
    let bytes = std::io::BufReader::new(fs::File::open(&file).expect("the file"));
    let frames = image::codecs::gif::GifDecoder::new(bytes).expect("a GIF").into_frames();
    let delays: Vec<u32> = frames.map(|frame| frame.expect("a picture").delay().numer_denom_ms().0).collect();
    assert_eq!(delays.len(), 3 * 5 + 1, "four pictures lead from each step to the next");
    assert_eq!(delays[..6], [130, 30, 30, 30, 30, 130], "half of a quarter of a second, in hundredths");
}

pub(super) fn write_to(window: &mut Window, path: &Path) {
    window.harness.get_by_label("Output path").set_text_value_accesskit(&path.display().to_string());
    window.settle();
    let exists = path.is_file();
    window.click_role(Role::Button, if exists { "Replace" } else { "Save" });
}

#[test]
fn enter_saves_after_a_click_on_a_format() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    window.command(Command::ExportPicture);
    window
        .harness
        .get_by_label("Output path")
        .set_text_value_accesskit(&folder.path().join("a.png").display().to_string());
    window.settle();
    let svg = window.harness.get_by_role_and_label(Role::Button, "SVG").rect().center();
    window.click_at(svg);
    window.key(Key::Enter);
    assert!(folder.path().join("a.svg").exists(), "{:?}", window.app().message());
}

#[test]
fn nothing_is_replaced_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lesson.motionscope");
    fs::write(&file, "mine").expect("a file");
    let mut window = Window::usual();
    window.command(Command::SaveSession);
    // The ending may be left away, and names the same file.
    let typed = folder.path().join("lesson").display().to_string();
    window.harness.get_by_label("Output path").set_text_value_accesskit(&typed);
    window.settle();
    assert!(window.harness.query_by_role_and_label(Role::Button, "Save").is_none());
    assert!(window.harness.query_by_label("There is a lesson.motionscope already.").is_some());
    window.key(Key::Enter);
    assert_eq!(fs::read_to_string(&file).expect("the file"), "mine");
    window.key(Key::Enter);
    assert!(Session::load(&file).is_ok(), "the button in focus is pressed: {:?}", window.app().message());

    window.command(Command::ExportSteps);
    window.harness.get_by_label("Output path").set_text_value_accesskit(&folder.path().display().to_string());
    window.settle();
    assert!(window.harness.query_by_role_and_label(Role::Button, "Save").is_some(), "a folder alone is no harm");
    fs::write(folder.path().join("step_00000.png"), "mine").expect("a file");
    window.key(Key::Escape);
    window.command(Command::ExportSteps);
    window.harness.get_by_label("Output path").set_text_value_accesskit(&folder.path().display().to_string());
    window.settle();
    assert!(window.harness.query_by_role_and_label(Role::Button, "Replace").is_some());
}

#[test]
fn what_the_clip_is_read_from_is_not_written_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let clip = folder.path().join("clip");
    let words = ["synth", "translation", "--set", "width=64", "--set", "height=48", "--set", "frames=3", "--out"];
    let words = ["motionscope"].into_iter().chain(words).map(OsStr::new).chain([clip.as_os_str()]);
    command_line(&words.collect::<Vec<_>>());
    let lesson = folder.path().join("lesson.motionscope");
    fs::write(&lesson, "motionscope = 1\nclip = \"clip\"\nestimator = \"full-search\"\n").expect("a session");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(lesson.clone().into()) });
    assert!(
        window.harness.query_by_label_contains("from flow/frame_0000.flo and 1 other file").is_some(),
        "truth is named"
    );
    let refused = |window: &mut Window, command: Command, path: &Path, why: &str| {
        window.command(command);
        window.harness.get_by_label("Output path").set_text_value_accesskit(&path.display().to_string());
        window.settle();
        assert!(window.harness.query_by_label_contains(why).is_some(), "{} is not refused", path.display());
        window.key(Key::Enter);
        window.key(Key::Enter);
        assert!(window.harness.query_by_label("Output path").is_some(), "it has been written");
        window.key(Key::Escape);
    };
    let (picture, flow) = (clip.join("frame_0001.png"), clip.join("flow/frame_0000.flo"));
    let before = [&picture, &flow, &lesson].map(|path| fs::read(path).expect("a file"));
    refused(&mut window, Command::ExportPicture, &picture, "would replace a frame of the clip; choose another name");
    refused(&mut window, Command::ExportPicture, &clip.join("frame_0003.png"), "would become a frame of the clip");
    refused(&mut window, Command::ExportResult, &flow, "would replace the ground truth of the clip");
    refused(&mut window, Command::ExportSteps, &clip, "would mix its pictures with the frames of the clip");
    #[cfg(unix)]
    {
        let link = folder.path().join("link.png");
        std::os::unix::fs::symlink(&lesson, &link).expect("a link");
        refused(&mut window, Command::ExportPicture, &link, "would replace lesson.motionscope, the session");
    }
    // The writer itself refuses as well, whoever asks it.
    let order = Order {
        what: OutputKind::Result(EXPORTS[0]),
        path: flow.clone(),
        scale: 1,
        look: Look::default(),
        panes: Selection::default(),
    };
    window.harness.state_mut().write(order);
    window.settle();
    assert!(
        window.app().message().is_some_and(|message| message.contains("would replace the ground truth of the clip"))
    );
    assert!(before == [&picture, &flow, &lesson].map(|path| fs::read(path).expect("a file")));
    // The session is there to be saved again.
    window.command(Command::SaveSession);
    write_to(&mut window, &lesson);
    assert!(fs::read(&lesson).expect("the session") != before[2], "{:?}", window.app().message());
}

#[test]
fn a_session_typed_without_its_ending_reopens() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    window.command(Command::SaveSession);
    write_to(&mut window, &folder.path().join("lesson.2"));
    let file = folder.path().join("lesson.2.motionscope");
    assert!(Session::load(&file).is_ok(), "{:?}", window.app().message());
    window.command(Command::ExportResult);
    write_to(&mut window, &folder.path().join("vectors"));
    assert!(fs::read_to_string(folder.path().join("vectors.csv")).expect("a table").starts_with("x_px"));
}

#[test]
fn steps_can_be_written_from_the_start_of_a_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    window.key(Key::Home);
    window.command(Command::ExportSteps);
    window.click_role(Role::Button, "block");
    write_to(&mut window, &folder.path().join("steps"));
    assert!(folder.path().join("steps/step_00000.png").exists(), "{:?}", window.app().message());
}

#[test]
fn a_session_reopens_exactly() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lesson.motionscope");
    let mut window = Window::usual();
    window.click("Order: Spiral");
    window.harness.get_by_role_and_label(Role::Slider, "Noise").set_value_accesskit(5.0);
    window.settle();
    window.key(Key::T);
    window.key(Key::ArrowRight);
    window.key(Key::Num5);
    window.key(Key::Plus);
    window.click("More of the stage");
    window.click("Legend");
    window.key(Key::Escape);
    for command in [Command::TurboColors, Command::FourfoldArrows] {
        window.command(command);
    }
    window.press(Modifiers::COMMAND, Key::S);
    write_to(&mut window, &file);
    let before = window.sentence();
    let stage = window.harness.get_by_label_contains("Stage: ").rect();
    let looks = |window: &Window| {
        let zoom = window.harness.query_all_by_label_contains(" %").filter_map(|node| node.accesskit_node().value());
        let title = window.harness.get_by_label_contains("Stage: ").accesskit_node().label();
        let legend = window.harness.query_by_label_contains("Legend: ").is_some();
        (title, zoom.collect::<Vec<_>>(), legend)
    };

    let again = Window::with(vec2(1280.0, 720.0), Start { open: Some(file.clone().into()) });
    assert!(again.sentence() == before, "the session does not show the same step");
    assert_eq!(looks(&again), looks(&window));
    assert!(!looks(&again).2, "the legend is folded");
    let (mine, theirs) = (Session::load(&file).expect("a session"), folder.path().join("again.motionscope"));
    let mut again = again;
    again.press(Modifiers::COMMAND, Key::S);
    write_to(&mut again, &theirs);
    let mut theirs = Session::load(&theirs).expect("a session");
    let [own, other] = [mine.sight, theirs.sight].map(|sight| sight.expect("a part that is seen"));
    assert_eq!((own.center, own.zoom), (other.center, other.zoom));
    // The size is that of the stage, which has another shape beside other charts.
    assert!(own.size.is_some() && other.size.is_some());
    theirs.sight = mine.sight;
    assert!(theirs == mine, "the session that is saved again is the same");
    assert!(mine.sight.is_some_and(|sight| stage.is_positive() && sight.zoom > 1.0));
    assert_eq!(again.app().settings().look.theme, window.app().settings().look.theme);
    assert_eq!(again.app().settings().recent.len(), 1);
}

#[test]
fn a_session_keeps_truth_and_look_and_the_command_line_paints_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let (first, second) = (folder.path().join("first.motionscope"), folder.path().join("second.motionscope"));
    fs::write(folder.path().join("truth.flo"), still_truth(320, 240)).expect("the truth");
    let text = "motionscope = 1\nclip = \"synth:pillar\"\ntruth = \"truth.flo\"\nestimator = \"full-search\"\n\
                step = \"30.200\"\n[picture]\nview = \"blend\"\nlevel = 1\nblend = 0.8\ntheme = \"light\"\ncolors = \"turbo\"\narrows = 2.5\n\
                legend = false\ncaption = true\n";
    fs::write(&first, text).expect("the session");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(first.clone().into()) });
    window.press(Modifiers::COMMAND, Key::S);
    write_to(&mut window, &second);
    let (before, after) = (Session::load(&first).expect("read"), Session::load(&second).expect("written"));
    assert_eq!(after.look.over(Look::default()), before.look.over(Look::default()));
    let truth = after.experiment.given.truth.and_then(|truth| truth.canonicalize().ok());
    assert_eq!(truth, folder.path().join("truth.flo").canonicalize().ok());
    assert_eq!((after.position, after.experiment.frame), (before.position, before.experiment.frame));

    window.command(Command::ExportPicture);
    let (mine, theirs) = (folder.path().join("window.png"), folder.path().join("line.png"));
    window.click_role(Role::Button, "1×");
    write_to(&mut window, &mine);
    paint(&second, 1, &theirs);
    assert!(fs::read(mine).expect("a picture") == fs::read(theirs).expect("a picture"), "the pictures differ");
}

#[test]
fn a_part_chosen_by_hand_is_exported_in_the_window_and_from_its_session() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = Window::usual();
    let export = |window: &mut Window, name: &str| {
        let file = folder.path().join(name);
        window.command(Command::ExportPicture);
        window.click_role(Role::Button, "Theme: dark");
        window.click_role(Role::Button, "1×");
        write_to(window, &file);
        fs::read(file).expect("a picture")
    };
    let followed = export(&mut window, "followed.png");
    window.command(Command::ZoomIn);
    window.command(Command::ZoomIn);
    let part = export(&mut window, "part.png");
    assert!(part != followed, "the close-up of the step stands in place of the part that is seen");
    let [session, line] = ["part.motionscope", "line.png"].map(|name| folder.path().join(name));
    window.command(Command::SaveSession);
    write_to(&mut window, &session);
    let sight = Session::load(&session).expect("a session").sight.expect("a part");
    assert!(sight.size.is_some_and(|[width, height]| width < 320.0 && height < 240.0), "{sight:?}");
    paint(&session, 1, &line);
    assert!(fs::read(line).expect("a picture") == part, "the pictures differ");
    window.command(Command::Fit);
    let whole = export(&mut window, "whole.png");
    assert!(whole != followed && whole != part, "the whole picture was chosen");
    window.command(Command::FocusNever);
    assert!(export(&mut window, "never.png") == whole);
}

#[test]
fn a_part_chosen_by_hand_keeps_its_width_and_height_in_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let [first, second, file] =
        ["first.motionscope", "second.motionscope", "part.png"].map(|name| folder.path().join(name));
    let text = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"full-search\"\nstep = \"30.200\"\n[picture]\n\
                view = \"current\"\nlegend = false\n";
    fs::write(&first, text).expect("the session");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(first.into()) });
    (0..2).for_each(|_| window.command(Command::ZoomIn));
    let pane = window.harness.get_by_label_contains("Stage: ").rect().size();
    window.command(Command::SaveSession);
    write_to(&mut window, &second);
    let sight = Session::load(&second).expect("a session").sight.expect("a part");
    let (width, height) = window.shown().pictures.pair[0].size();
    let picture = [width as f32, height as f32];
    // What of the picture lies in its pane on the stage, in px.
    let seen = [(0, pane.x), (1, pane.y)].map(|(i, side)| {
        let half = side / sight.zoom / 2.0;
        (sight.center[i] + half).min(picture[i] - 0.5) - (sight.center[i] - half).max(-0.5)
    });
    let is_other_shape = (seen[0] / seen[1] - picture[0] / picture[1]).abs() > 0.05;
    assert!(is_other_shape && seen[0] < picture[0], "{seen:?} has the shape of the picture");
    window.command(Command::ExportPicture);
    window.click_role(Role::Button, "1×");
    write_to(&mut window, &file);
    let (width, height) = image::image_dimensions(&file).expect("a picture");
    let sides = [width as f32, height as f32];
    let times = (picture[0] / seen[0]).min(picture[1] / seen[1]);
    let off = [0, 1].map(|i| (sides[i] / times - seen[i]).abs());
    assert!(off[0].max(off[1]) <= 0.5, "{sides:?} shows other than {seen:?} px, ×{times}");
}

/// The picture that the command line makes of a session.
pub(super) fn paint(session: &Path, scale: u32, file: &Path) {
    let scale = scale.to_string();
    let words = ["motionscope".as_ref(), "run".as_ref(), session.as_os_str(), "--scale".as_ref(), scale.as_ref()];
    command_line(&[&words[..], &["--overlay".as_ref(), file.as_os_str()]].concat());
}

/// Has the command line do what `words` say.
pub(super) fn command_line(words: &[&OsStr]) {
    let code = motionscope::cli::main(words.iter().map(OsString::from));
    assert_eq!(format!("{code:?}"), format!("{:?}", std::process::ExitCode::SUCCESS));
}

/// A flow file that says that nothing moves.
fn still_truth(width: u32, height: u32) -> Vec<u8> {
    let head = [width.to_le_bytes(), height.to_le_bytes()].concat();
    [b"PIEH".to_vec(), head, vec![0; (width * height * 8) as usize]].concat()
}

#[test]
fn a_session_leaves_alone_what_it_does_not_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("short.motionscope");
    let text = "motionscope = 1\nclip = \"synth:pillar,frames=3\"\nestimator = \"full-search\"\nframe = 9\n";
    fs::write(&file, text).expect("the session");
    let mut window = Window::usual();
    for command in [Command::LightTheme, Command::TurboColors, Command::DoubleArrows, Command::Blend] {
        window.command(command);
    }
    window.harness.state_mut().open(file.as_os_str());
    window.settle();
    let settings = window.app().settings();
    assert_eq!((settings.look.theme, settings.look.colors), (Theme::Light, ColorMap::Turbo));
    assert_eq!(settings.look.arrow_scale, Lengthen::Times(2.0));
    assert_eq!(settings.look.view, Some(View::SideBySide), "which pictures are seen belongs to what was open before");
    assert_eq!(window.cursor(), Cursor::default(), "it begins at the start");
    assert_eq!(window.shown().subject.experiment.frame, 1);
    let message = window.app().message().unwrap_or_default();
    assert!(message.contains("frame 9") && message.contains("frame 1"), "{message}");
}

#[test]
fn a_session_without_a_step_goes_on_where_its_run_was_left() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("one.motionscope");
    let text = "motionscope = 1\nclip = \"synth:translation,frames=4\"\nestimator = \"full-search\"\n";
    let mut window = Window::usual();
    let mut open = |more: &str| {
        fs::write(&file, format!("{text}{more}")).expect("the session");
        window.harness.state_mut().open(file.as_os_str());
        window.settle();
        let opened = window.cursor();
        window.press(Modifiers::SHIFT, Key::ArrowRight);
        window.key(Key::ArrowRight);
        let left = window.cursor();
        window.harness.state_mut().open("synth:rotation,frames=3");
        window.settle();
        (opened, left)
    };
    let (opened, left) = open("");
    assert_eq!((opened, left), (Cursor::default(), Cursor { unit: 1, event: 1 }));
    assert_eq!(open("").0, left, "the same run");
    assert_eq!(open("[set]\nsearch-range = 3\n").0, Cursor::default(), "another run has other steps");
    open("");
    let beside = "[[beside]]\nestimator = \"diamond\"\nset = {}\n";
    assert_eq!(open(beside).0, Cursor::default(), "so has a lockstep");
    assert_eq!(open("step = \"2.3\"\n").0, Cursor { unit: 1, event: 3 }, "a step that is named goes before");
}

#[test]
fn a_truth_that_cannot_be_read_is_reported_beside_the_quality() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("clip");
    let words = ["motionscope", "synth", "translation", "--set", "width=64", "--set", "height=48", "--set", "frames=3"];
    let words = words.map(OsString::from).into_iter().chain(["--out".into(), out.clone().into_os_string()]);
    motionscope::cli::main(words);
    let truth = out.join("flow/frame_0000.flo");
    let whole = fs::read(&truth).expect("the truth");
    fs::write(&truth, &whole[..whole.len() / 2]).expect("half of it");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(out.into_os_string()) });
    window.key(Key::End);
    for label in ["Candidates: ", "Prediction: ", "Endpoint error: unknown"] {
        assert!(window.harness.query_all_by_label_contains(label).next().is_some(), "{label} is not told");
    }
}

#[test]
fn several_pasted_lines_are_one_path() {
    let folder = tempfile::tempdir().expect("a folder");
    for index in 0..2u8 {
        let picture = image::GrayImage::from_pixel(64, 48, image::Luma([index]));
        picture.save(folder.path().join(format!("frame {index}.png"))).expect("a picture");
    }
    let url = format!("file://{}/frame%200.png", folder.path().display());
    let mut window = Window::usual();
    window.press(Modifiers::COMMAND, Key::O);
    window.harness.event(Event::Paste(format!("{url}\n{url}\n")));
    window.settle();
    window.key(Key::Enter);
    assert_eq!(window.app().document().clip().map(|clip| clip.size()), Some((64, 48)), "{:?}", window.app().error());
}

#[test]
fn a_bad_file_is_reported_and_the_picture_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("broken.png");
    fs::write(&file, b"\x89PNG\r\n\x1a\nthis is no picture").expect("a file");
    let mut window = Window::usual();
    let before = window.sentence();
    for name in [file.display().to_string(), folder.path().join("gone.mp4").display().to_string()] {
        window.harness.state_mut().open(&name);
        window.settle();
        let error = window.app().error().expect("an error").to_string();
        let last = Path::new(&name).file_name().expect("a name").to_string_lossy().into_owned();
        assert!(error.contains(&last), "{error}");
        assert!(window.harness.query_by_role(Role::Alert).is_some(), "the error is on the stage");
        assert!(window.sentence() == before);
    }
    window.click("Dismiss error");
    assert!(window.app().error().is_none());
    window.key(Key::ArrowRight);
    assert_ne!(window.sentence(), before, "it goes on");
}

#[test]
fn a_path_is_typed_and_pasted() {
    let folder = tempfile::tempdir().expect("a folder");
    for index in 0..3u8 {
        let picture = image::GrayImage::from_fn(64, 48, |x, y| image::Luma([(x * 3 + y * 5) as u8 ^ index]));
        picture.save(folder.path().join(format!("frame_{index}.png"))).expect("a picture");
    }
    let path = folder.path().display().to_string();
    let mut window = Window::usual();
    window.press(Modifiers::COMMAND, Key::O);
    window.harness.get_by_label("Path of the clip").set_text_value_accesskit(&path);
    window.settle();
    window.click_role(Role::Button, "Open");
    assert_eq!(window.app().document().clip().map(|clip| clip.size()), Some((64, 48)));
    assert_eq!(window.cursor().event, window.shown().events, "a clip of one's own begins with a whole block");

    let mut window = Window::usual();
    window.harness.event(Event::Paste(format!("\"{path}\"\n")));
    window.settle();
    assert_eq!(window.app().document().clip().map(|clip| clip.size()), Some((64, 48)));
}

#[test]
fn detections_open_with_a_tracker_and_truth_beside_the_clip_that_is_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let row = |t: usize, id: i32| format!("{},{id},{},40,20,30,1,-1,-1,-1\n", t + 1, 20 + 3 * t);
    let rows = |id: i32| (0..8).map(|t| row(t, id)).collect::<String>();
    let [det, truth] = ["det.txt", "known.txt"].map(|name| folder.path().join(name));
    fs::write(&det, rows(-1)).expect("it is written");
    fs::write(&truth, rows(1)).expect("it is written");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(det.into()) });
    assert_eq!(window.app().document().estimator().info().id, "kalman-tracker", "there are no pictures to be searched");
    window.key(Key::End);
    let is_scored = |window: &Window| window.harness.query_all_by_label_contains("MOTA").next().is_some();
    assert!(!is_scored(&window));
    window.harness.state_mut().open(&truth);
    window.settle();
    window.key(Key::End);
    assert_eq!(window.app().document().experiment().given.truth.as_ref(), Some(&truth));
    assert!(is_scored(&window), "tracks are scored");
    let recent = &window.app().settings().recent;
    assert!(!recent.contains(&truth), "a truth is no clip");
}

#[test]
fn detections_opened_over_pictures_are_those_of_the_clip() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    fs::create_dir(&frames).expect("a folder");
    for t in 0..4 {
        image::GrayImage::from_pixel(160, 120, image::Luma([40]))
            .save(frames.join(format!("{t:02}.png")))
            .expect("a frame");
    }
    let det = folder.path().join("found.txt");
    let rows: String = (0..4).map(|t| format!("{},-1,{},40,20,30,1,-1,-1,-1\n", t + 1, 20 + 3 * t)).collect();
    fs::write(&det, rows).expect("it is written");
    let mut window = Window::with(vec2(1440.0, 900.0), Start { open: Some(frames.clone().into()) });
    window.harness.state_mut().open(&det);
    window.settle();
    let document = window.app().document();
    assert_eq!(document.experiment().given.detections.as_ref(), Some(&det));
    assert!(document.clip().is_some_and(|clip| !clip.is_blank() && clip.detections(2).map(<[_]>::len) == Some(1)));
    assert!(window.harness.query_by_label_contains("gives the detections of the open clip").is_some());
    assert!(!window.app().settings().recent.contains(&det), "they are no clip");
}

#[test]
fn a_session_keeps_detections_given_by_hand() {
    let folder = tempfile::tempdir().expect("a folder");
    let [first, second] = ["first.motionscope", "second.motionscope"].map(|name| folder.path().join(name));
    let rows: String = (1..=4).map(|t| format!("{t},-1,{},30,12,10,1,-1,-1,-1\n", 20 + 3 * t)).collect();
    fs::write(folder.path().join("det.txt"), rows).expect("the detections");
    let clip = "synth:traffic,width=96,height=72,frames=4";
    let text = format!(
        "motionscope = 1\nclip = \"{clip}\"\ndetections = \"det.txt\"\nestimator = \"kalman-tracker\"\nstep = \"3\"\n"
    );
    fs::write(&first, text).expect("the session");
    let mut window = Window::with(vec2(1400.0, 2600.0), Start { open: Some(first.clone().into()) });
    let detected = |window: &Window, t| {
        let clip = &window.shown().subject.clip;
        clip.detections(t).map(|found| found.iter().map(|one| one.bounds.min[0]).collect::<Vec<_>>())
    };
    let before = detected(&window, 2);
    assert!(before.as_ref().is_some_and(|found| found.len() == 1), "{before:?}");
    // They stay when the clip is made anew.
    window.harness.get_by_role_and_label(Role::Slider, "Noise").set_value_accesskit(3.0);
    window.settle();
    assert_eq!(detected(&window, 2), before);
    window.press(Modifiers::COMMAND, Key::S);
    write_to(&mut window, &second);
    let given = Session::load(&second).expect("a session").experiment.given;
    assert_eq!(given.detections, Some(folder.path().join("det.txt")));
    assert!(fs::read_to_string(&second).expect("text").contains("\ndetections = \"det.txt\"\n"));
    // Nothing is written over them.
    window.command(Command::ExportResult);
    let det = folder.path().join("det.txt");
    window.harness.get_by_label("Output path").set_text_value_accesskit(&det.display().to_string());
    window.settle();
    assert!(window.harness.query_by_label_contains("would replace the detections").is_some());
}

#[test]
fn objects_and_masks_are_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = Start { open: Some("synth:traffic,width=160,height=120,frames=4".into()) };
    let mut window = Window::with(vec2(1440.0, 900.0), start);
    let choose = |window: &mut Window, name: &str| {
        let now = window.app().document().estimator().info().name;
        window.click(&format!("Estimator: {now}"));
        window.click(name);
        window.key(Key::End);
    };
    choose(&mut window, "Kalman tracker");
    window.command(Command::ExportResult);
    let tracks = folder.path().join("tracks.txt");
    write_to(&mut window, &tracks);
    let rows = fs::read_to_string(&tracks).expect("it is written");
    assert!(rows.starts_with("1,") && rows.lines().all(|row| row.ends_with(",1,-1,-1,-1")), "{rows}");
    window.command(Command::ExportResult);
    assert!(window.harness.query_by_label("Masks").is_none(), "a tracker makes no masks");
    window.key(Key::Escape);
    choose(&mut window, "Frame difference");
    window.command(Command::ExportResult);
    window.click_role(Role::Button, "Masks");
    let masks = folder.path().join("masks");
    write_to(&mut window, &masks);
    assert!(masks.join("mask_0003.png").exists() && window.app().message().is_some_and(|m| m.contains("4 files")));
}

#[test]
fn what_is_wrong_with_a_clip_is_not_reported_for_the_next_one() {
    let folders = [0; 3].map(|_| tempfile::tempdir().expect("a folder"));
    let [damaged, single, good] = &folders;
    let picture = |folder: &tempfile::TempDir, index: u32| {
        let picture = image::GrayImage::from_fn(64, 48, |x, y| image::Luma([(x * 3 + y * 5 + index) as u8]));
        picture.save(folder.path().join(format!("frame_{index}.png"))).expect("a picture");
    };
    (0..4).for_each(|index| picture(damaged, index));
    (0..3).for_each(|index| picture(good, index));
    picture(single, 0);
    let third = damaged.path().join("frame_2.png");
    let bytes = fs::read(&third).expect("a picture");
    fs::write(&third, &bytes[..bytes.len() / 2]).expect("half of it");

    let mut window = Window::usual();
    window.click("Estimator: Full search");
    window.click("Frame difference");
    for (folder, told) in [(damaged, "frame_2.png"), (single, "two")] {
        window.harness.state_mut().open(folder.path());
        window.settle();
        window.key(Key::End);
        let alert = window.harness.get_by_role(Role::Alert).accesskit_node().label().unwrap_or_default();
        assert!(alert.contains(told) || folder.path() == single.path(), "{alert}");
        // Not even in the first frame that shows the next clip.
        window.harness.state_mut().open(good.path());
        let begun = Instant::now();
        loop {
            window.harness.step();
            let open = window.app().document().clip().is_some_and(|clip| clip.info().frames == Some(3));
            assert!(!open || window.harness.query_by_role(Role::Alert).is_none(), "{alert} is stale");
            if open && !window.app().view().busy {
                break;
            }
            assert!(begun.elapsed() < Duration::from_secs(20), "it does not open");
        }
        window.settle();
    }
}

#[test]
fn what_comes_from_elsewhere_asks_before_it_opens_files_outside_its_folder() {
    let place = tempfile::tempdir().expect("a folder");
    let [theirs, other] = ["theirs", "other"].map(|name| place.path().join(name));
    fs::create_dir(&theirs).expect("a folder");
    let source = motionscope::experiment::source::Source::parse("synth:translation,width=64,height=48,frames=3");
    let clip = source.and_then(|source| source.open(&Default::default())).expect("a clip").clip;
    motionscope::work::finish(motionscope::media::export::clip(&clip, &other, None)).expect("a clip in a folder");
    let keys = "clip = \"../other\"\nestimator = \"diamond\"\n";
    for (name, text) in [
        ("a.motionscope", format!("motionscope = 1\n{keys}")),
        ("a.md", format!("# Theirs\n+++\ntitle = \"One\"\n{keys}+++\nWords.\n")),
    ] {
        let file = theirs.join(name);
        fs::write(&file, text).expect("a file");
        let mut window = Window::with(vec2(1280.0, 720.0), Start { open: Some(file.clone().into()) });
        assert!(window.app().view().shown.is_none(), "{name} is open");
        assert!(window.harness.query_by_label_contains("outside of its own folder").is_some(), "{name}");
        window.click_role(Role::Button, "Open these files");
        let source = window.shown().subject.experiment.source.to_string();
        assert!(source.ends_with("other"), "{name}: {source}");
        // It is not asked twice.
        let again = Window::with(vec2(1280.0, 720.0), Start { open: Some(file.into()) });
        assert!(again.app().view().shown.is_some(), "{name}");
    }
}
