//! Points as squares, rendered by the graphics card.

use eframe::egui::TextureId;
use eframe::egui_wgpu::RenderState;
use eframe::wgpu::{self, util::DeviceExt as _};

use crate::ui::drawing::offscreen::{COLOR, Offscreen, SAMPLES, depth_stencil};

/// What the shader reads once per picture; the layout of `View` in `points.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct View {
    /// Clip space from the world, column by column.
    pub clip_from_world: [f32; 16],
    /// Width and height of the picture in pixels.
    pub size: [f32; 2],
    /// Pixels for a unit of the world at distance 1.
    pub magnification: f32,
    /// Nothing.
    pub unused: f32,
    /// Smallest and largest side of a point in pixels.
    pub sides: [f32; 2],
    /// Nothing.
    pub padding: [f32; 2],
}

/// A point.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Point {
    /// Its place in the world.
    pub place: [f32; 3],
    /// Its side in units of the world.
    pub side: f32,
    /// Its colour.
    pub color: [u8; 4],
}

/// What is rendered.
pub struct Job {
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
    points: Option<(wgpu::Buffer, u32)>,
    /// What the picture shows.
    shown: Option<View>,
}

impl Gpu {
    /// Prepares the card of the window.
    pub fn new(state: &RenderState) -> Self {
        let offscreen = Offscreen::new(state);
        let pipeline = pipeline(&offscreen.device);
        let (view, bind_group) = offscreen.uniform(&pipeline, size_of::<View>());
        Self { offscreen, pipeline, view, bind_group, points: None, shown: None }
    }

    /// Has other points on the card.
    pub fn set_points(&mut self, points: &[Point]) {
        let contents: &[u8] = bytemuck::cast_slice(points);
        let label = Some("point cloud");
        let usage = wgpu::BufferUsages::VERTEX;
        let buffer =
            || self.offscreen.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label, contents, usage });
        // A buffer of no bytes is not allowed.
        self.points = (!points.is_empty()).then(|| (buffer(), points.len() as u32));
        self.shown = None;
    }

    /// The picture of `job`; rendered only if it is not the one that is there.
    pub fn render(&mut self, job: &Job) -> Option<TextureId> {
        let is_new = self.offscreen.resize(job.size);
        if is_new || self.shown != Some(job.view) {
            self.offscreen.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&job.view));
            self.offscreen.paint(|pass| {
                if let Some((points, count)) = &self.points {
                    pass.set_pipeline(&self.pipeline);
                    pass.set_bind_group(0, &self.bind_group, &[]);
                    pass.set_vertex_buffer(0, points.slice(..));
                    pass.draw(0..4, 0..*count);
                }
            });
            self.shown = Some(job.view);
        }
        self.offscreen.id()
    }
}

fn pipeline(device: &wgpu::Device) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("points.wgsl"));
    let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Unorm8x4];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("point cloud"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Point>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &attributes,
            })],
            compilation_options: wgpu::PipelineCompilationOptions::default(),
        },
        primitive: wgpu::PrimitiveState { topology: wgpu::PrimitiveTopology::TriangleStrip, ..Default::default() },
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
