//! The relief rendered by the graphics card into a texture of its own, which egui then shows as a picture.

use eframe::egui::TextureId;
use eframe::egui_wgpu::RenderState;
use eframe::wgpu::{self, util::DeviceExt as _};

use crate::paint::charts::relief::mesh::{Relief, Vertex};
use crate::ui::drawing::offscreen::{COLOR, Offscreen, SAMPLES, depth_stencil};

/// What the shader reads once per picture; the layout of `View` in `relief.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct View {
    /// Clip space from the world, column by column.
    pub clip_from_world: [f32; 16],
    /// Towards the light, and nothing.
    pub light: [f32; 4],
    /// The eye, and nothing.
    pub eye: [f32; 4],
    /// Colour and strength of the lines.
    pub line: [f32; 4],
    /// Width of the lines in pixels, and nothing.
    pub line_width: [f32; 4],
}

/// What is rendered.
pub struct Job<'a> {
    /// The triangles, and a number that changes when they do.
    pub relief: (&'a Relief, u64),
    /// The view.
    pub view: View,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
}

/// A picture on the graphics card and all that is needed to make it anew.
pub struct Gpu {
    offscreen: Offscreen,
    pipeline: wgpu::RenderPipeline,
    view: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    mesh: Option<(u64, Mesh)>,
    /// What the picture shows.
    shown: Option<(u64, View)>,
}

struct Mesh {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

impl Gpu {
    /// Prepares the card of the window.
    pub fn new(state: &RenderState) -> Self {
        let offscreen = Offscreen::new(state);
        let pipeline = pipeline(&offscreen.device);
        let (view, bind_group) = offscreen.uniform(&pipeline, size_of::<View>());
        Self { offscreen, pipeline, view, bind_group, mesh: None, shown: None }
    }

    /// The picture of `job`; rendered only if it is not the one that is there.
    pub fn render(&mut self, job: &Job<'_>) -> Option<TextureId> {
        if self.offscreen.resize(job.size) {
            self.shown = None;
        }
        let (relief, key) = job.relief;
        if self.mesh.as_ref().is_none_or(|(known, _)| *known != key) {
            self.mesh = Some((key, Mesh::new(&self.offscreen.device, relief)));
        }
        if self.shown != Some((key, job.view)) {
            self.offscreen.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&job.view));
            self.draw();
            self.shown = Some((key, job.view));
        }
        self.offscreen.id()
    }

    fn draw(&self) {
        let Some((_, mesh)) = &self.mesh else { return };
        self.offscreen.paint(|pass| {
            if mesh.count > 0 {
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &self.bind_group, &[]);
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.count, 0, 0..1);
            }
        });
    }
}

impl Mesh {
    fn new(device: &wgpu::Device, relief: &Relief) -> Self {
        let buffer = |contents: &[u8], usage| {
            // A buffer of no bytes is not allowed.
            let contents = if contents.is_empty() { &[0; 4] } else { contents };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("relief"), contents, usage })
        };
        Self {
            vertices: buffer(bytemuck::cast_slice(&relief.vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(bytemuck::cast_slice(&relief.indices), wgpu::BufferUsages::INDEX),
            count: relief.indices.len() as u32,
        }
    }
}

fn pipeline(device: &wgpu::Device) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("relief.wgsl"));
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32x2];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("relief"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Vertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &attributes,
            })],
            compilation_options: wgpu::PipelineCompilationOptions::default(),
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(depth_stencil()),
        multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("shade"),
            targets: &[Some(COLOR.into())],
            compilation_options: wgpu::PipelineCompilationOptions::default(),
        }),
        multiview_mask: None,
        cache: None,
    })
}
