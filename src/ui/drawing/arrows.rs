//! Arrows as the window draws them: a mesh for a few, instances on the graphics card for thousands.

use std::sync::Arc;

use eframe::egui::{Color32, Mesh, PaintCallbackInfo, Rect, Shape};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use eframe::wgpu::{self, util::DeviceExt as _};
use motionscope_core::scene;

use crate::paint::primitive::{self, Arrows, Pen, Point, form};
use crate::ui::drawing::style;

/// From this many on, arrows are drawn by the graphics card itself.
const INSTANCED: usize = 256;
/// Above this many in a mesh, they are drawn more simply.
const MANY: usize = 3000;

/// What arrows are drawn on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Nothing is drawn outside.
    pub clip: Rect,
    /// How fine the screen is: edges are as soft as it wants them.
    pub pixels_per_point: f32,
}

/// Arrows that were made ready to be drawn, to be drawn again.
#[derive(Clone)]
pub enum Drawn {
    /// A mesh: it is good for one place and one zoom.
    Mesh(Arrows, Sheet, Shape),
    /// On the graphics card, in image pixels: good for every place, zoom and pen.
    Field(Arc<Field>),
}

impl Drawn {
    /// Makes `arrows` ready.
    pub fn new(arrows: &Arrows, sheet: Sheet, gpu: Option<&RenderState>) -> Self {
        match gpu.filter(|_| arrows.ends.len() >= INSTANCED) {
            Some(gpu) => Self::Field(Arc::new(Field::new(arrows.ends.clone(), gpu))),
            None => Self::Mesh(arrows.clone(), sheet, Shape::mesh(mesh(arrows, sheet))),
        }
    }

    /// Whether [`Drawn::shape`] can be asked for `arrows` on `sheet`, in a window with a card or without.
    pub fn serves(&self, arrows: &Arrows, sheet: Sheet, has_card: bool) -> bool {
        match self {
            Self::Mesh(known, on, _) => known == arrows && *on == sheet,
            Self::Field(field) => has_card && field.ends == arrows.ends,
        }
    }

    /// The shape of `arrows`.
    pub fn shape(&self, arrows: &Arrows, sheet: Sheet) -> Shape {
        match self {
            Self::Mesh(_, _, shape) => shape.clone(),
            Self::Field(field) => {
                let painted = Painted { field: field.clone(), look: FieldLook::of(arrows) };
                Shape::Callback(Callback::new_paint_callback(sheet.clip, painted))
            }
        }
    }
}

/// Arrows on the graphics card.
pub struct Field {
    ends: Arc<[scene::Arrow]>,
    instances: wgpu::Buffer,
    view: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
}

/// How a field lies and looks, as the graphics card reads it.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct FieldLook {
    /// Where the first image pixel lies, points per pixel, and how many times their length displacements are drawn.
    place: [f32; 4],
    /// Widths of shaft and rim, and nothing.
    widths: [f32; 4],
    color: [f32; 4],
    halo: [f32; 4],
}

impl FieldLook {
    fn of(arrows: &Arrows) -> Self {
        let Arrows { origin: [x, y], zoom, lengthen, pen: Pen { width, color, halo, halo_width }, .. } = *arrows;
        let [color, halo] = [color, halo].map(|color| color.0.map(|c| f32::from(c) / 255.0));
        Self { place: [x, y, zoom, lengthen], widths: [width, halo_width, 0.0, 0.0], color, halo }
    }
}

/// A field as it is painted in one frame.
struct Painted {
    field: Arc<Field>,
    look: FieldLook,
}

/// What all fields of a window share.
struct Pipeline(wgpu::RenderPipeline);

impl Field {
    fn new(ends: Arc<[scene::Arrow]>, gpu: &RenderState) -> Self {
        let resources = &mut gpu.renderer.write().callback_resources;
        let Pipeline(pipeline) = resources.entry().or_insert_with(|| Pipeline::new(gpu));
        let instances: Vec<[f32; 4]> =
            ends.iter().map(|arrow| [arrow.from[0], arrow.from[1], arrow.to[0], arrow.to[1]]).collect();
        let instances = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("arrows"),
            contents: bytemuck::cast_slice(&instances),
            usage: wgpu::BufferUsages::VERTEX,
        });
        let view = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view of the arrows"),
            size: (size_of::<[f32; 4]>() + size_of::<FieldLook>()) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view of the arrows"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() }],
        });
        Self { ends, instances, view, bind_group }
    }
}

impl CallbackTrait for Painted {
    fn prepare(
        &self,
        _: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let scale = screen.pixels_per_point;
        let [width, height] = screen.size_in_pixels.map(|c| c as f32 / scale);
        queue.write_buffer(&self.field.view, 0, bytemuck::bytes_of(&[width, height, scale, 0.0]));
        queue.write_buffer(&self.field.view, size_of::<[f32; 4]>() as u64, bytemuck::bytes_of(&self.look));
        Vec::new()
    }

    fn paint(&self, info: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, resources: &CallbackResources) {
        let Some(Pipeline(pipeline)) = resources.get() else { return };
        let [width, height] = info.screen_size_px.map(|c| c as f32);
        pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.field.bind_group, &[]);
        pass.set_vertex_buffer(0, self.field.instances.slice(..));
        pass.draw(0..6, 0..self.field.ends.len() as u32);
    }
}

/// The shader, told the form of arrows.
fn shader() -> String {
    let constants = [
        ("DOT", form::DOT),
        ("REACH", form::REACH),
        ("HEAD", form::HEAD),
        ("HEAD_SHARE", form::HEAD_SHARE),
        ("BARB", form::BARB),
        ("SHAFT", form::SHAFT),
        ("SHAFT_SHARE", form::SHAFT_SHARE),
        ("TAPER", form::TAPER),
        ("TIP", form::TIP),
    ];
    let declared = constants.map(|(name, value)| format!("const {name}: f32 = {value:?};\n"));
    declared.concat() + include_str!("arrows.wgsl")
}

impl Pipeline {
    fn new(gpu: &RenderState) -> Self {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("arrows"),
            source: wgpu::ShaderSource::Wgsl(shader().into()),
        });
        let entry_point = if gpu.target_format.is_srgb() { "linear" } else { "gamma" };
        let target = wgpu::ColorTargetState {
            format: gpu.target_format,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        };
        Self(device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("arrows"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<[f32; 4]>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x4],
                })],
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            },
            primitive: wgpu::PrimitiveState::default(),
            // As the window's own pass: without a depth buffer, one sample.
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry_point),
                targets: &[Some(target)],
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            }),
            multiview_mask: None,
            cache: None,
        }))
    }
}

/// All arrows that can be seen on `sheet` in one mesh, the edges softened over a pixel.
fn mesh(arrows: &Arrows, sheet: Sheet) -> Mesh {
    let mut mesh = Mesh::default();
    let feather = 1.0 / sheet.pixels_per_point;
    let seen = primitive::Rect { min: sheet.clip.min.into(), max: sheet.clip.max.into() };
    let seen: Vec<_> = arrows.iter().filter(|arrow| arrow.bounds().meets(&seen)).collect();
    let plain = seen.len() > MANY;
    mesh.reserve_vertices(seen.len() * if plain { 38 } else { 76 });
    let Pen { color, halo, halo_width, .. } = arrows.pen;
    let (color, halo) = (style::color(color), style::color(halo));
    for arrow in seen {
        // Small arrows by the thousand: their rim needs no soft edge, their dot fewer corners.
        let corners = if plain { 6 } else { 14 };
        let soft = if plain { 0.0 } else { feather };
        for (grow, color, soft) in [(halo_width, halo, soft), (0.0, color, feather)] {
            let inner = arrow.outline(grow - soft / 2.0);
            let outer = arrow.outline(grow + soft / 2.0);
            if let (Some(inner), Some(outer)) = (inner, outer) {
                fan(&mut mesh, arrow.hub(), &inner, (soft > 0.0).then_some(&outer), color);
            }
            let radius = arrow.dot() + grow;
            let ring = |radius: f32| circle(arrow.from, radius, corners);
            let outer = ring(radius + soft / 2.0);
            fan(&mut mesh, arrow.from, &ring((radius - soft / 2.0).max(0.1)), (soft > 0.0).then_some(&outer), color);
        }
    }
    mesh
}

fn circle(center: Point, radius: f32, corners: usize) -> Vec<Point> {
    let corner = |i: usize| {
        let (sin, cos) = (i as f32 / corners as f32 * std::f32::consts::TAU).sin_cos();
        [center[0] + radius * cos, center[1] + radius * sin]
    };
    (0..corners).map(corner).collect()
}

/// Fills the outline `inner` from `hub`, and fades out to `outer`.
fn fan<'a>(mesh: &mut Mesh, hub: Point, inner: &[Point], outer: Option<impl AsRef<[Point]> + 'a>, color: Color32) {
    let n = inner.len() as u32;
    let first = mesh.vertices.len() as u32;
    mesh.colored_vertex(hub.into(), color);
    inner.iter().for_each(|&point| mesh.colored_vertex(point.into(), color));
    for i in 0..n {
        mesh.add_triangle(first, first + 1 + i, first + 1 + (i + 1) % n);
    }
    let Some(outer) = outer else { return };
    outer.as_ref().iter().for_each(|&point| mesh.colored_vertex(point.into(), Color32::TRANSPARENT));
    for i in 0..n {
        let (a, b) = (first + 1 + i, first + 1 + (i + 1) % n);
        mesh.add_triangle(a, a + n, b + n);
        mesh.add_triangle(a, b + n, b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Color;
    use eframe::egui::{CentralPanel, Ui, pos2, vec2};
    use egui_kittest::{Harness, wgpu::WgpuTestRenderer};

    const PEN: Pen = Pen { width: 2.0, color: Color::WHITE, halo: Color::BLACK, halo_width: 1.0 };

    fn arrows(to: Point, count: usize) -> Arrows {
        let Arrows { ends, .. } = Arrows::one([10.0, 10.0], to, PEN);
        Arrows { ends: vec![ends[0]; count].into(), ..Arrows::one([10.0, 10.0], to, PEN) }
    }

    fn sheet() -> Sheet {
        Sheet { clip: Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 600.0)), pixels_per_point: 1.0 }
    }

    #[test]
    fn a_mesh_of_arrows_is_sound_and_stays_near_them() {
        for count in [1, MANY + 1] {
            let mesh = super::mesh(&arrows([50.0, 30.0], count), sheet());
            assert!(mesh.is_valid() && !mesh.is_empty());
            let bounds = Rect::from_min_max(pos2(10.0, 10.0), pos2(50.0, 30.0)).expand(8.0);
            assert!(bounds.contains_rect(mesh.calc_bounds()), "{:?}", mesh.calc_bounds());
        }
    }

    #[test]
    fn an_arrow_without_motion_is_a_dot_and_one_out_of_sight_is_nothing() {
        let still = arrows([10.0, 10.0], 1);
        let mesh = super::mesh(&still, sheet());
        assert!(mesh.calc_bounds().width() < 10.0 && !mesh.is_empty());
        assert!(super::mesh(&Arrows { origin: [900.0, 0.0], ..still }, sheet()).is_empty());
    }

    #[test]
    fn arrows_by_the_thousand_stay_light() {
        assert!(mesh(&arrows([18.0, 12.0], 8160), sheet()).vertices.len() < 8160 * 50);
    }

    /// Arrows of all lengths and directions on gray, as a mesh or on the card.
    struct Specimen {
        arrows: Arrows,
        on_card: bool,
    }

    impl eframe::App for Specimen {
        fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
            CentralPanel::no_frame().show(ui, |ui| {
                let sheet = Sheet { clip: ui.max_rect(), pixels_per_point: ui.pixels_per_point() };
                ui.painter().rect_filled(sheet.clip, 0.0, Color32::from_gray(110));
                let card = frame.wgpu_render_state().filter(|_| self.on_card);
                assert_eq!(card.is_some(), self.on_card, "the renderer has a card");
                let drawn = Drawn::new(&self.arrows, sheet, card);
                assert_eq!(matches!(drawn, Drawn::Field(_)), self.on_card);
                let closer = Arrows { zoom: 7.0, origin: [-90.0, 4.0], ..self.arrows.clone() };
                assert_eq!(drawn.serves(&closer, sheet, self.on_card), self.on_card, "looking closer uploads nothing");
                let others = Arrows { ends: self.arrows.ends[1..].into(), ..closer };
                assert!(!drawn.serves(&others, sheet, self.on_card) && drawn.serves(&self.arrows, sheet, self.on_card));
                ui.painter().add(drawn.shape(&self.arrows, sheet));
            });
        }
    }

    /// Places 20 px apart, each with a longer displacement than the one before.
    fn specimen(zoom: f32, width: f32) -> Arrows {
        let ends = (0..280).map(|i| {
            let from = [(i % 20) as f32 * 20.0 + 10.0, (i / 20) as f32 * 20.0 + 10.0];
            let (sin, cos) = (i as f32 * 0.7).sin_cos();
            let length = i as f32 / 14.0;
            scene::Arrow { from, to: [from[0] + cos * length, from[1] + sin * length] }
        });
        let color = Color::hex(0xe6_9f00);
        let pen = Pen { width, color, halo_width: width / 2.0, ..PEN };
        Arrows { ends: ends.collect(), origin: [3.5, 2.25], zoom, lengthen: 0.9, pen }
    }

    #[test]
    fn a_mesh_and_the_card_draw_the_same_arrows() {
        for (zoom, width) in [(2.0, 2.0), (2.0, 5.0), (1.2, 0.8)] {
            let mut pictures = Vec::new();
            for on_card in [false, true] {
                let Ok(renderer) = std::panic::catch_unwind(WgpuTestRenderer::new) else {
                    assert!(std::env::var_os("REQUIRE_SCREENSHOTS").is_none(), "no graphics driver");
                    println!("no graphics driver, so there is nothing to compare");
                    return;
                };
                let arrows = specimen(zoom, width);
                let builder = Harness::builder().with_size(vec2(820.0, 580.0)).renderer(renderer);
                let mut harness = builder.build_eframe(|_| Specimen { arrows, on_card });
                harness.run_steps(2);
                pictures.push(harness.render().expect("a picture"));
            }
            let off = |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| {
                a.0.iter().zip(b.0).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0)
            };
            let offs: Vec<u8> = pictures[0].pixels().zip(pictures[1].pixels()).map(off).collect();
            let drawn = pictures[0].pixels().filter(|pixel| pixel.0 != [110, 110, 110, 255]).count();
            let far = offs.iter().filter(|off| **off >= 64).count();
            // Of what is finer than a pixel, each can only cover its share.
            let most = if width < 1.0 { drawn / 15 } else { drawn / 10_000 };
            assert!(drawn > 9000 && far <= most, "zoom {zoom}, width {width}: {far} of {drawn} pixels differ");
        }
    }
}
