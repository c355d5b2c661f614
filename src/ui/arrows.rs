//! Arrows as the window draws them: a mesh for a few, instances on the graphics card for thousands.

use eframe::egui::{Color32, Mesh, PaintCallbackInfo, Rect, Shape};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use eframe::wgpu::{self, util::DeviceExt as _};

use super::ink;
use crate::paint::primitive::{Arrow, Point};

/// From this many on, arrows are drawn by the graphics card itself.
const INSTANCED: usize = 256;
/// Above this many in a mesh, they are drawn more simply.
const MANY: usize = 3000;

/// `arrows` in `clip`, with edges as soft as a screen of `pixels_per_point` wants them.
pub fn shape(arrows: &[Arrow], clip: Rect, pixels_per_point: f32, gpu: Option<&RenderState>) -> Shape {
    match gpu.filter(|_| arrows.len() >= INSTANCED) {
        Some(gpu) => Shape::Callback(Callback::new_paint_callback(clip, Field::new(arrows, gpu))),
        None => Shape::mesh(mesh(arrows, 1.0 / pixels_per_point)),
    }
}

/// One arrow, as the graphics card reads it.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Instance {
    ends: [f32; 4],
    widths: [f32; 2],
    color: [u8; 4],
    halo: [u8; 4],
}

/// Arrows on the graphics card.
struct Field {
    instances: wgpu::Buffer,
    count: u32,
}

/// What all fields of a window share.
struct Pen {
    pipeline: wgpu::RenderPipeline,
    screen: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
}

impl Field {
    fn new(arrows: &[Arrow], gpu: &RenderState) -> Self {
        let resources = &mut gpu.renderer.write().callback_resources;
        if !resources.contains::<Pen>() {
            resources.insert(Pen::new(gpu));
        }
        let instance = |arrow: &Arrow| Instance {
            ends: [arrow.from[0], arrow.from[1], arrow.to[0], arrow.to[1]],
            widths: [arrow.width, arrow.halo_width],
            color: arrow.color.0,
            halo: arrow.halo.0,
        };
        let instances: Vec<Instance> = arrows.iter().map(instance).collect();
        let buffer = wgpu::util::BufferInitDescriptor {
            label: Some("arrows"),
            contents: bytemuck::cast_slice(&instances),
            usage: wgpu::BufferUsages::VERTEX,
        };
        Self { instances: gpu.device.create_buffer_init(&buffer), count: arrows.len() as u32 }
    }
}

impl CallbackTrait for Field {
    fn prepare(
        &self,
        _: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(pen) = resources.get::<Pen>() {
            let scale = screen.pixels_per_point;
            let [width, height] = screen.size_in_pixels.map(|c| c as f32 / scale);
            queue.write_buffer(&pen.screen, 0, bytemuck::bytes_of(&[width, height, scale, 0.0]));
        }
        Vec::new()
    }

    fn paint(&self, info: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, resources: &CallbackResources) {
        let Some(pen) = resources.get::<Pen>() else { return };
        let [width, height] = info.screen_size_px.map(|c| c as f32);
        pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
        pass.set_pipeline(&pen.pipeline);
        pass.set_bind_group(0, &pen.bind_group, &[]);
        pass.set_vertex_buffer(0, self.instances.slice(..));
        pass.draw(0..6, 0..self.count);
    }
}

impl Pen {
    fn new(gpu: &RenderState) -> Self {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::include_wgsl!("arrows.wgsl"));
        let attributes = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x2, 2 => Unorm8x4, 3 => Unorm8x4];
        let entry_point = if gpu.target_format.is_srgb() { "linear" } else { "gamma" };
        let target = wgpu::ColorTargetState {
            format: gpu.target_format,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("arrows"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<Instance>() as u64,
                    step_mode: wgpu::VertexStepMode::Instance,
                    attributes: &attributes,
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
        });
        let screen = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("screen"),
            size: size_of::<[f32; 4]>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("screen"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: screen.as_entire_binding() }],
        });
        Self { pipeline, screen, bind_group }
    }
}

/// All arrows in one mesh, the edges softened over `feather` points.
fn mesh(arrows: &[Arrow], feather: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let plain = arrows.len() > MANY;
    mesh.reserve_vertices(arrows.len() * if plain { 38 } else { 76 });
    for arrow in arrows {
        let (halo, color) = (ink::color(arrow.halo), ink::color(arrow.color));
        // Small arrows by the thousand: their rim needs no soft edge, their dot fewer corners.
        let corners = if plain { 6 } else { 14 };
        let soft = if plain { 0.0 } else { feather };
        for (grow, color, soft) in [(arrow.halo_width, halo, soft), (0.0, color, feather)] {
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
    use eframe::egui::pos2;

    fn arrow(to: Point) -> Arrow {
        Arrow { from: [10.0, 10.0], to, width: 2.0, color: Color::WHITE, halo: Color::BLACK, halo_width: 1.0 }
    }

    #[test]
    fn a_mesh_of_arrows_is_sound_and_stays_near_them() {
        for count in [1, MANY + 1] {
            let arrows = vec![arrow([50.0, 30.0]); count];
            let mesh = super::mesh(&arrows, 1.0);
            assert!(mesh.is_valid() && !mesh.is_empty());
            let bounds = Rect::from_min_max(pos2(10.0, 10.0), pos2(50.0, 30.0)).expand(8.0);
            assert!(bounds.contains_rect(mesh.calc_bounds()), "{:?}", mesh.calc_bounds());
        }
    }

    #[test]
    fn an_arrow_without_motion_is_a_dot() {
        let mesh = super::mesh(&[arrow([10.0, 10.0])], 1.0);
        assert!(mesh.calc_bounds().width() < 10.0 && !mesh.is_empty());
    }

    #[test]
    fn arrows_by_the_thousand_stay_light() {
        let arrows = vec![arrow([18.0, 12.0]); 8160];
        assert!(mesh(&arrows, 1.0).vertices.len() < 8160 * 50);
    }
}
