//! The relief rendered by the graphics card into a texture of its own, which egui then shows as a picture.

use std::sync::Arc;

use eframe::egui::TextureId;
use eframe::egui::mutex::RwLock;
use eframe::egui_wgpu::{RenderState, Renderer};
use eframe::wgpu::{self, util::DeviceExt as _};

use crate::paint::charts::relief::mesh::{Relief, Vertex};

/// What egui shows: gamma-encoded, premultiplied.
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const SAMPLES: u32 = 4;

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
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: Arc<RwLock<Renderer>>,
    pipeline: wgpu::RenderPipeline,
    view: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    mesh: Option<(u64, Mesh)>,
    target: Option<Target>,
    /// What the picture shows.
    shown: Option<(u64, View)>,
}

struct Mesh {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

struct Target {
    size: [u32; 2],
    id: TextureId,
    color: wgpu::TextureView,
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Drop for Gpu {
    fn drop(&mut self) {
        if let Some(target) = &self.target {
            self.renderer.write().free_texture(&target.id);
        }
    }
}

impl Gpu {
    /// Prepares the card of the window.
    pub fn new(state: &RenderState) -> Self {
        let device = state.device.clone();
        let pipeline = pipeline(&device);
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("relief view"),
            size: size_of::<View>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("relief view"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() }],
        });
        let (queue, renderer) = (state.queue.clone(), state.renderer.clone());
        Self { device, queue, renderer, pipeline, view, bind_group, mesh: None, target: None, shown: None }
    }

    /// The picture of `job`; rendered only if it is not the one that is there.
    pub fn render(&mut self, job: &Job<'_>) -> Option<TextureId> {
        let largest = self.device.limits().max_texture_dimension_2d;
        let size = job.size.map(|c| c.clamp(1, largest));
        if self.target.as_ref().is_none_or(|target| target.size != size) {
            self.target = Some(self.new_target(size));
            self.shown = None;
        }
        let (relief, key) = job.relief;
        if self.mesh.as_ref().is_none_or(|(known, _)| *known != key) {
            self.mesh = Some((key, Mesh::new(&self.device, relief)));
        }
        if self.shown != Some((key, job.view)) {
            self.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&job.view));
            self.draw();
            self.shown = Some((key, job.view));
        }
        self.target.as_ref().map(|target| target.id)
    }

    fn new_target(&self, size: [u32; 2]) -> Target {
        let texture = |format, sample_count, usage| {
            let texture = self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("relief"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let color = texture(COLOR, 1, wgpu::TextureUsages::TEXTURE_BINDING);
        let samples = texture(COLOR, SAMPLES, wgpu::TextureUsages::empty());
        let depth = texture(DEPTH, SAMPLES, wgpu::TextureUsages::empty());
        let mut renderer = self.renderer.write();
        let filter = wgpu::FilterMode::Linear;
        let id = match &self.target {
            Some(old) => {
                renderer.update_egui_texture_from_wgpu_texture(&self.device, &color, filter, old.id);
                old.id
            }
            None => renderer.register_native_texture(&self.device, &color, filter),
        };
        Target { size, id, color, samples, depth }
    }

    fn draw(&self) {
        let (Some(target), Some((_, mesh))) = (&self.target, &self.mesh) else { return };
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("relief"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &target.samples,
                    resolve_target: Some(&target.color),
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Discard,
                    },
                    depth_slice: None,
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &target.depth,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                    stencil_ops: None,
                }),
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            if mesh.count > 0 {
                pass.set_pipeline(&self.pipeline);
                pass.set_bind_group(0, &self.bind_group, &[]);
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.count, 0, 0..1);
            }
        }
        self.queue.submit([encoder.finish()]);
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
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
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
