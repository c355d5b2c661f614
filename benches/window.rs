//! How long the window takes for a frame over a dense flow, and for a page of a lesson: `cargo bench --bench window`.
//!
//! Horn-Schunck at 1920×1080 at its end, colours of the wheel and arrows over frame t: laying everything out and making
//! triangles of it, which is what a frame costs before the graphics card has it, while the picture is zoomed; and while the
//! pointer moves over all panes at twice as many pixels, with an arrow every 16 px, 8160 in all. Pages of two lessons in turn: from the name
//! of the page to its words, and to its step.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use eframe::egui::{
    Context, Event, FullOutput, Modifiers, MouseWheelSource, MouseWheelUnit, Pos2, TexturesDelta, TouchPhase, vec2,
};
use eframe::egui_wgpu::{RenderState, RendererOptions, ScreenDescriptor};
use eframe::wgpu;
use egui_kittest::wgpu::{create_render_state, default_wgpu_setup};
use egui_kittest::{Harness, TestRenderer};
use image::RgbaImage;
use motionscope::ui::app::App;
use motionscope::ui::{self, Start};

/// Pages with different clips and estimators.
const PAGES: [&str; 2] = ["lesson:sequential-search/2", "lesson:horn-schunck/3"];

/// A window that opens this clip, session or page, at a scale of the display.
fn opened(start: Start, pixels_per_point: f32) -> Harness<'static, App> {
    let build = move |cc: &mut eframe::CreationContext<'static>| {
        let mut app = App::new(&cc.egui_ctx, None).expect("a thread");
        ui::begin(&mut app, start);
        app
    };
    let builder = Harness::builder().with_size(vec2(1920.0, 1080.0));
    builder.with_pixels_per_point(pixels_per_point).build_eframe(build)
}

/// A window on the end of a run with this look, drawn until it is there.
fn window(picture: &str, pixels_per_point: f32) -> Harness<'static, App> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dense.motionscope");
    let clip = "synth:pillar,width=1920,height=1080,frames=2";
    let lines = format!(
        "motionscope = 1\nclip = \"{clip}\"\nestimator = \"horn-schunck\"\nstep = \"end\"\n[set]\niterations = \"5\"\n\
         {picture}"
    );
    std::fs::write(&path, lines).expect("it is written");
    let mut window = opened(Start { open: Some(path.into()) }, pixels_per_point);
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(120)
        && !window.state().view().shown.as_deref().is_some_and(|s| s.at_end)
    {
        window.state_mut().wait();
        window.run_steps(2);
    }
    window.run_steps(10);
    drop(folder);
    window
}

/// Turns the wheel by `points` at a place, and draws the window.
fn zoom(window: &mut Harness<'static, App>, at: Pos2, points: f32) {
    window.hover_at(at);
    let (unit, source, delta) = (MouseWheelUnit::Point, MouseWheelSource::Wheel, vec2(0.0, points));
    let (phase, modifiers) = (TouchPhase::Move, Modifiers::NONE);
    window.event(Event::MouseWheel { unit, source, delta, phase, modifiers });
    window.step();
}

fn frame(c: &mut Criterion) {
    let is_there = |window: &Harness<'static, App>| {
        let shown = window.state().view().shown.as_deref();
        shown.is_some_and(|shown| shown.at_end && shown.pictures.layer.is_some())
    };
    let mut pointed = window("[picture]\narrow-spacing = 16\n", 2.0);
    assert!(is_there(&pointed));
    let mut x = 0.0;
    c.bench_function("a frame of the window over 8160 arrows, 1080p at 2×, while the pointer moves", |b| {
        b.iter(|| {
            x = (x + 97.0) % 1900.0;
            pointed.hover_at(Pos2::new(x, 400.0));
            pointed.step();
            let shapes = pointed.output().shapes.clone();
            black_box(pointed.ctx.tessellate(shapes, 2.0).len())
        });
    });
    drop(pointed);
    let mut window = window("", 1.0);
    assert!(is_there(&window));
    let mut way = 1.0;
    c.bench_function("a frame of the window over a dense flow, 1080p, while it is zoomed", |b| {
        b.iter(|| {
            way = -way;
            zoom(&mut window, Pos2::new(900.0, 400.0), 30.0 * way);
            let shapes = window.output().shapes.clone();
            black_box(window.ctx.tessellate(shapes, 1.0).len())
        });
    });
}

fn page(c: &mut Criterion) {
    let mut window = opened(Start { open: Some(PAGES[1].into()) }, 1.0);
    let parts = [("the words of a page of a lesson", false), ("the step of a page of a lesson", true)];
    for (name, is_waited_for) in parts {
        let mut pages = PAGES.into_iter().cycle();
        c.bench_function(name, |b| {
            b.iter_custom(|count| {
                let open = |page: &str| {
                    // The step of the page before is not counted.
                    window.state_mut().wait();
                    window.run_steps(1);
                    let begun = Instant::now();
                    window.state_mut().open(page);
                    if is_waited_for {
                        window.state_mut().wait();
                    }
                    window.run_steps(1);
                    begun.elapsed()
                };
                pages.by_ref().take(count as usize).map(open).sum::<Duration>()
            });
        });
    }
}

/// Draws as the window does, with the driver's own filters, and waits until it is drawn; unlike a test it reads no picture back.
struct Screen(RenderState);

impl Screen {
    fn new() -> Self {
        Self(create_render_state(default_wgpu_setup(), RendererOptions::default()))
    }
}

impl TestRenderer for Screen {
    fn setup_eframe(&self, cc: &mut eframe::CreationContext<'_>, frame: &mut eframe::Frame) {
        cc.wgpu_render_state = Some(self.0.clone());
        frame.wgpu_render_state = Some(self.0.clone());
    }

    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let RenderState { device, queue, renderer, .. } = &self.0;
        let mut renderer = renderer.write();
        for (id, images) in delta.set.drain() {
            images.iter().for_each(|image| renderer.update_texture(device, queue, id, image));
        }
        delta.free.drain().for_each(|id| renderer.free_texture(&id));
    }

    fn render(&mut self, ctx: &Context, output: &FullOutput) -> Result<RgbaImage, String> {
        let RenderState { device, queue, renderer, target_format, .. } = &self.0;
        let (mut renderer, pixels_per_point) = (renderer.write(), ctx.pixels_per_point());
        let [width, height] = <[f32; 2]>::from(ctx.content_rect().size() * pixels_per_point).map(|side| side as u32);
        let screen = ScreenDescriptor { pixels_per_point, size_in_pixels: [width, height] };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: *target_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let jobs = ctx.tessellate(output.shapes.clone(), pixels_per_point);
        let before = renderer.update_buffers(device, queue, &mut encoder, &jobs, &screen);
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store };
        let target = wgpu::RenderPassColorAttachment { view: &view, resolve_target: None, ops, depth_slice: None };
        let pass = wgpu::RenderPassDescriptor { color_attachments: &[Some(target)], ..Default::default() };
        renderer.render(&mut encoder.begin_render_pass(&pass).forget_lifetime(), &jobs, &screen);
        queue.submit(before.into_iter().chain([encoder.finish()]));
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| error.to_string())?;
        Ok(RgbaImage::new(width, height))
    }
}

/// A landscape of 33×33 costs at 1280×720 that is zoomed, and the flat picture of the same step: laid out and made triangles of, and
/// drawn by whatever driver there is.
fn landscape(c: &mut Criterion) {
    for (name, is_leaned) in [("a flat picture", false), ("a landscape", true)] {
        drawn(c, name, is_leaned);
    }
}

fn drawn(c: &mut Criterion, name: &str, is_leaned: bool) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("leaned.motionscope");
    let lines =
        "motionscope = 1\nclip = \"synth:pillar\"\nestimator = \"full-search\"\nstep = \"100.800\"\n[picture]\n";
    std::fs::write(&path, format!("{lines}theme = \"projector\"\nlandscape = {is_leaned}\n")).expect("it is written");
    let build = |cc: &mut eframe::CreationContext<'static>| {
        let mut app = App::new(&cc.egui_ctx, None).expect("a thread");
        ui::begin(&mut app, Start { open: Some(path.into()) });
        app
    };
    let mut window = Harness::builder().with_size(vec2(1280.0, 720.0)).renderer(Screen::new()).build_eframe(build);
    for _ in 0..5 {
        window.state_mut().wait();
        window.run_steps(60);
    }
    assert_eq!(window.state().settings().look.landscape, is_leaned);
    let mut way = 1.0;
    let mut turn = move |window: &mut Harness<'static, App>| {
        way = -way;
        zoom(window, Pos2::new(400.0, 350.0), 30.0 * way);
    };
    c.bench_function(&format!("a frame of {name}, 720p, while it is zoomed"), |b| {
        b.iter(|| {
            turn(&mut window);
            let shapes = window.output().shapes.clone();
            black_box(window.ctx.tessellate(shapes, 1.0).len())
        });
    });
    c.bench_function(&format!("a frame of {name}, 720p, drawn"), |b| {
        b.iter(|| {
            turn(&mut window);
            black_box(window.render().expect("a driver").width())
        });
    });
}

criterion_group!(benches, frame, page, landscape);
criterion_main!(benches);
