//! Pictures of the window, for the README and for the eye of a reviewer.
//!
//! `UPDATE_SCREENSHOTS=1 cargo test --test screenshots` makes them anew. Without it they are compared with what the
//! window looks like now, tile by tile, so that one wrong digit is seen: drivers smooth edges differently, but in no
//! square of 32 pixels a side may more than a few pixels differ by more than 40 of 255 in any channel. Where no graphics driver is installed there is nothing to compare, unless
//! `REQUIRE_SCREENSHOTS` is set. `SCREENSHOTS=FOLDER` draws every estimator into a folder instead, as large as a lecture hall
//! and a desktop screen have it. A software driver will do (on Debian: mesa-vulkan-drivers).

use std::fs;
use std::io::Cursor as Bytes;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::App as _;
use eframe::egui::{Event, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::wgpu::WgpuTestRenderer;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ImageEncoder as _, Rgb, RgbImage};
use motionscope::paint::{Caption, Figure, FigureOptions, Pictures, Theme, View, export_png};
use motionscope::session::lesson::{self, Address};
use motionscope::ui::app::App;
use motionscope::ui::commands::Command;
use motionscope::ui::{self, Start};
use motionscope_core::course::estimators;
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;
use motionscope_core::run::Guarantee;
use motionscope_core::scene;

/// Most bytes that a picture may have.
const MOST_BYTES: usize = 300_000;
/// How far a channel may be off.
const FAR: u8 = 40;
/// Side of a tile; tiles overlap by half, so that a digit lies whole in one of them.
const TILE: u32 = 32;
/// How many pixels of a tile may be further off.
const MOST_FAR: usize = 5;

/// Windows in which `SCREENSHOTS=FOLDER cargo test --workspace --test screenshots` draws every estimator, and of the first every page
/// of the lessons.
const WINDOWS: [(&str, [f32; 2], Theme, &[Command]); 14] = [
    ("projector-720", [1280.0, 720.0], Theme::Projector, &[]),
    ("dark-720", [1280.0, 720.0], Theme::Dark, &[]),
    ("light-720", [1280.0, 720.0], Theme::Light, &[]),
    ("present-720", [1280.0, 720.0], Theme::Projector, &[Command::Present]),
    ("projector-768", [1024.0, 768.0], Theme::Projector, &[]),
    ("light-1080", [1920.0, 1080.0], Theme::Light, &[]),
    ("projector-1080", [1920.0, 1080.0], Theme::Projector, &[]),
    ("dark-1080", [1920.0, 1080.0], Theme::Dark, &[]),
    ("dark-390", [844.0, 390.0], Theme::Dark, &[]),
    ("compare-720", [1280.0, 720.0], Theme::Projector, &[Command::Compare]),
    ("chooser-720", [1280.0, 720.0], Theme::Projector, &[Command::Estimators]),
    ("chooser-1080", [1920.0, 1080.0], Theme::Light, &[Command::Estimators]),
    ("landscape-720", [1280.0, 720.0], Theme::Projector, &[Command::Landscape]),
    ("landscape-1080", [1920.0, 1080.0], Theme::Light, &[Command::Landscape]),
];

/// What is on a picture.
struct Scene {
    name: &'static str,
    size: Vec2,
    theme: Theme,
    /// A clip or a session by its name, or the lines of a session; the bundled sample if it is empty.
    open: &'static str,
    commands: &'static [Command],
    /// What is typed after the commands.
    types: &'static str,
    /// Whether it shows what moves, so that no two pictures of it are equal.
    is_live: bool,
}

impl Scene {
    const fn new(name: &'static str, open: &'static str, commands: &'static [Command]) -> Self {
        Self { name, size: vec2(1280.0, 720.0), theme: Theme::Projector, open, commands, types: "", is_live: false }
    }
}

/// A search in the middle of a block on the ball.
const FULL_SEARCH: &str = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"full-search\"\nstep = \"164.640\"\n";
const DIAMOND: &str = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"diamond\"\nstep = \"164.14\"\n";
const KALMAN: &str = "motionscope = 1\nclip = \"synth:traffic\"\nestimator = \"kalman-filter\"\nstep = \"9.4\"\n";

/// The end of a block, before the next one.
const BLOCK_END: &str = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"full-search\"\nstep = \"164.0\"\n";
/// A step of a search on which a teacher has drawn.
const DRAWN: &str = "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"diamond\"\nstep = \"164.14\"\n\n[[ink]]\nstep = \"164.14\"\n\
    picture = \"t+1\"\ncolor = \"yellow\"\npoints = \"50,118 58,112 70,112 80,118 84,130 80,142 68,148 56,146 48,136 47,126 51,117\"\n";

const SCENES: [Scene; 13] = [
    Scene::new("start", "", &[Command::StartPage]),
    Scene { theme: Theme::Light, ..Scene::new("lesson", "lesson:sequential-search/3", &[]) },
    Scene::new("question", BLOCK_END, &[Command::Predict, Command::Over]),
    Scene::new("present", DRAWN, &[Command::Present]),
    Scene { is_live: true, ..Scene::new("camera", "", &[Command::Camera]) },
    Scene { theme: Theme::Light, types: "aperture", ..Scene::new("search", "", &[Command::SearchText]) },
    Scene { size: vec2(1280.0, 800.0), theme: Theme::Dark, ..Scene::new("dark", FULL_SEARCH, &[]) },
    Scene { theme: Theme::Light, ..Scene::new("kalman", KALMAN, &[]) },
    Scene {
        size: vec2(1280.0, 800.0),
        theme: Theme::Light,
        ..Scene::new("light", "synth:parallax", &[Command::End, Command::FrameT])
    },
    Scene::new("projector", DIAMOND, &[]),
    Scene {
        size: vec2(800.0, 450.0),
        theme: Theme::Light,
        ..Scene::new("embed", "#lesson:horn-schunck/2&view=embed", &[])
    },
    Scene {
        size: vec2(1280.0, 800.0),
        theme: Theme::Light,
        ..Scene::new(
            "lockstep",
            DIAMOND,
            const { &[Command::Lockstep, INTO, INTO, INTO, INTO, INTO, INTO, INTO, INTO, INTO, INTO] },
        )
    },
    Scene { size: vec2(960.0, 600.0), theme: Theme::Dark, ..Scene::new("samples", "", &[Command::Samples]) },
];
const INTO: Command = Command::Into;

fn picture(scene: &Scene, renderer: WgpuTestRenderer) -> RgbImage {
    let folder = tempfile::tempdir().expect("a folder");
    let session = folder.path().join(format!("{}.motionscope", scene.name));
    let open = match scene.open {
        "" => None,
        lines if lines.starts_with("motionscope =") => {
            fs::write(&session, lines).expect("a session can be written");
            Some(session.into_os_string())
        }
        name => Some(name.into()),
    };
    let start = Start { open };
    let builder = Harness::builder().with_size(scene.size).with_max_steps(80).with_render_cursor(false);
    let mut harness = builder.renderer(renderer).build_eframe(|cc| {
        let mut app = App::new(&cc.egui_ctx, None).expect("a thread");
        ui::begin(&mut app, start);
        if app.is_at_start() {
            app.leave_start();
        }
        app
    });
    settle(&mut harness);
    while harness.state().settings().look.theme != scene.theme {
        harness.state_mut().command(Command::NextTheme);
        settle(&mut harness);
    }
    for command in scene.commands {
        harness.state_mut().command(*command);
        settle(&mut harness);
    }
    if !scene.types.is_empty() {
        harness.event(Event::Text(scene.types.into()));
        settle(&mut harness);
    }
    // What moves takes a while to begin.
    for _ in 0..if scene.is_live { 60 } else { 0 } {
        std::thread::sleep(std::time::Duration::from_millis(50));
        harness.run_steps(1);
    }
    let mut picture = harness.render().expect("the window can be drawn");
    clear(&mut picture, harness.state().clear_color(&harness.ctx.global_style().visuals));
    thin(&picture)
}

/// Puts a colour behind the picture, as the window has it.
fn clear(picture: &mut image::RgbaImage, color: [f32; 4]) {
    for pixel in picture.pixels_mut() {
        let through = 255 - pixel.0[3];
        for (channel, color) in pixel.0.iter_mut().zip(color) {
            *channel = channel.saturating_add((color * f32::from(through)).round() as u8);
        }
    }
}

/// The picture with two bits less where it is no flat area: nobody sees it, and the file is half as large.
fn thin(picture: &image::RgbaImage) -> RgbImage {
    let (width, height) = picture.dimensions();
    RgbImage::from_fn(width, height, |x, y| {
        let pixel = picture.get_pixel(x, y);
        let same = |dx: i32, dy: i32| {
            let (x, y) = (x.saturating_add_signed(dx).min(width - 1), y.saturating_add_signed(dy).min(height - 1));
            picture.get_pixel(x, y) == pixel
        };
        let flat = [(-2, 0), (2, 0), (0, -2), (0, 2)].into_iter().all(|(dx, dy)| same(dx, dy));
        let [r, g, b, _] = pixel.0;
        Rgb(if flat { [r, g, b] } else { [r, g, b].map(|v| v & !3) })
    })
}

fn settle(harness: &mut Harness<'_, App>) {
    for _ in 0..4 {
        harness.state_mut().wait();
        harness.run_steps(3);
    }
    while !harness.state().is_settled() {
        std::thread::sleep(std::time::Duration::from_millis(5));
        harness.run_steps(1);
    }
}

fn encode(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Bytes::new(Vec::new());
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    let (width, height) = picture.dimensions();
    encoder.write_image(picture, width, height, image::ExtendedColorType::Rgb8).expect("a picture can be written");
    bytes.into_inner()
}

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("screenshots").join(format!("{name}.png"))
}

/// The upper left corner of the tile that is furthest off, and how many of its pixels are far off.
fn worst_tile(a: &RgbImage, b: &RgbImage) -> ([u32; 2], usize) {
    assert_eq!(a.dimensions(), b.dimensions(), "the size");
    let is_far = |x: u32, y: u32| {
        let (a, b) = (a.get_pixel(x, y), b.get_pixel(x, y));
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > FAR)
    };
    let starts = |side: u32| (0..side).step_by(TILE as usize / 2);
    let (width, height) = a.dimensions();
    let tiles = starts(height).flat_map(|y| starts(width).map(move |x| [x, y]));
    let count = |[x, y]: [u32; 2]| {
        let columns = x..(x + TILE).min(width);
        (y..(y + TILE).min(height))
            .flat_map(|y| columns.clone().map(move |x| (x, y)))
            .filter(|&(x, y)| is_far(x, y))
            .count()
    };
    tiles.map(|tile| (tile, count(tile))).max_by_key(|(_, count)| *count).expect("a picture has tiles")
}

/// A number in the smallest type.
fn written(number: u32) -> RgbImage {
    let frame = Arc::new(Frame::gray(Grid::new(64, 8, 0)));
    let caption = Some(Caption { details: number.to_string(), ..Caption::default() });
    let options = FigureOptions { view: View::Current, caption, ..FigureOptions::default() };
    let figure = Figure::new(&Pictures::of([frame.clone(), frame]), &scene::Scene::default(), &options);
    image::load_from_memory(&export_png(&figure, 1).expect("a picture")).expect("a PNG file").to_rgb8()
}

#[test]
fn one_wrong_digit_is_seen() {
    let digits: Vec<RgbImage> = (0..10).map(|digit| written(21_504 + 10 * digit)).collect();
    for (i, a) in digits.iter().enumerate() {
        for (j, b) in digits.iter().enumerate() {
            let (_, far) = worst_tile(a, b);
            assert_eq!(far > MOST_FAR, i != j, "{far} pixels between {i} and {j}");
        }
    }
}

/// Draws every estimator in the middle of a unit of its run, and at the end, in every window, and every page of the lessons; of them
/// those whose names contain `ONLY`.
fn everything(folder: &Path) {
    fs::create_dir_all(folder).expect("the folder can be made");
    let only = std::env::var("ONLY").unwrap_or_default();
    let is_wanted = |name: &str| only.split(' ').all(|part| name.contains(part));
    let draw = |name: String, scene: &Scene| {
        fs::write(folder.join(name), encode(&picture(scene, WgpuTestRenderer::new()))).expect("it can be written");
    };
    let sessions = tempfile::tempdir().expect("a folder");
    for estimator in estimators() {
        let id = estimator.info().id;
        let has_objects = matches!(estimator.guarantee(), Guarantee::Objects | Guarantee::Region);
        let clip = match estimator.guarantee() {
            Guarantee::SceneFlow => "synth:drive",
            _ if has_objects => "synth:traffic",
            _ => "synth:pillar",
        };
        for (place, step) in [("middle", "3.9"), ("end", "0.0")] {
            let path = sessions.path().join(format!("{id}-{place}.motionscope"));
            let text = format!("motionscope = 1\nclip = \"{clip}\"\nestimator = \"{id}\"\nstep = \"{step}\"\n");
            fs::write(&path, text).expect("a session can be written");
            // They live as long as the test, as those that are stored do.
            let open: &'static str = String::leak(path.display().to_string());
            for (window, size, theme, commands) in WINDOWS {
                let name = format!("{window}-{id}-{place}.png");
                if is_wanted(&name) {
                    let commands: Vec<Command> =
                        commands.iter().copied().chain((place == "end").then_some(Command::End)).collect();
                    draw(name, &Scene { size: size.into(), theme, ..Scene::new(id, open, Vec::leak(commands)) });
                }
            }
        }
    }
    for of in lesson::all() {
        let address = Address::from(of);
        for page in 0..of.pages.len() {
            let open = Address { page, ..address.clone() }.name().to_string_lossy().into_owned();
            let name = format!("{}.png", open.replace([':', '/'], "-"));
            if is_wanted(&name) {
                draw(name, &Scene::new("lesson", String::leak(open), &[]));
            }
        }
    }
}

#[test]
fn the_window_looks_as_it_did() {
    if let Some(folder) = std::env::var_os("SCREENSHOTS") {
        return everything(Path::new(&folder));
    }
    let update = std::env::var_os("UPDATE_SCREENSHOTS").is_some();
    let required = update || std::env::var_os("REQUIRE_SCREENSHOTS").is_some();
    for scene in &SCENES {
        let Ok(renderer) = std::panic::catch_unwind(WgpuTestRenderer::new) else {
            assert!(!required, "no graphics driver; install one (on Debian: mesa-vulkan-drivers)");
            println!("no graphics driver, so there is nothing to compare");
            return;
        };
        let now = picture(scene, renderer);
        let bytes = encode(&now);
        assert!(bytes.len() < MOST_BYTES, "{} takes {} bytes", scene.name, bytes.len());
        if update {
            fs::write(file(scene.name), &bytes).expect("the picture can be written");
            continue;
        }
        if scene.is_live {
            continue;
        }
        let then = image::open(file(scene.name)).expect("the picture is there").to_rgb8();
        let ([x, y], far) = worst_tile(&now, &then);
        if far > MOST_FAR {
            let seen = std::env::temp_dir().join(format!("motionscope-{}.png", scene.name));
            fs::write(&seen, &bytes).expect("the picture can be written");
            panic!(
                "{} looks different: {far} pixels of the tile at ({x}, {y}); compare {} and, if it is meant to be so, \
                 make them anew with UPDATE_SCREENSHOTS=1",
                scene.name,
                seen.display()
            );
        }
    }
}
