//! A picture that the graphics card renders into a texture of its own, which egui then shows.

use std::sync::Arc;

use eframe::egui::TextureId;
use eframe::egui::mutex::RwLock;
use eframe::egui_wgpu::{RenderState, Renderer};
use eframe::wgpu;

/// What egui shows: gamma-encoded, premultiplied.
pub const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// The depth of each sample.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Samples of a pixel.
pub const SAMPLES: u32 = 4;

/// The picture, and all that is needed to make it anew.
pub struct Offscreen {
    /// The card.
    pub device: wgpu::Device,
    /// Its work.
    pub queue: wgpu::Queue,
    renderer: Arc<RwLock<Renderer>>,
    target: Option<Target>,
}

struct Target {
    size: [u32; 2],
    id: TextureId,
    color: wgpu::TextureView,
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Drop for Offscreen {
    fn drop(&mut self) {
        if let Some(target) = &self.target {
            self.renderer.write().free_texture(&target.id);
        }
    }
}

impl Offscreen {
    /// A picture on the card of the window.
    pub fn new(state: &RenderState) -> Self {
        let (device, queue) = (state.device.clone(), state.queue.clone());
        Self { device, queue, renderer: state.renderer.clone(), target: None }
    }

    /// Makes the picture `size` pixels; returns whether it has to be painted anew.
    pub fn resize(&mut self, size: [u32; 2]) -> bool {
        let largest = self.device.limits().max_texture_dimension_2d;
        let size = size.map(|c| c.clamp(1, largest));
        let is_new = self.target.as_ref().is_none_or(|target| target.size != size);
        if is_new {
            self.target = Some(self.new_target(size));
        }
        is_new
    }

    /// The picture, once it has a size.
    pub fn id(&self) -> Option<TextureId> {
        self.target.as_ref().map(|target| target.id)
    }

    /// A uniform buffer of this many bytes, as the only binding of `pipeline`.
    pub fn uniform(&self, pipeline: &wgpu::RenderPipeline, bytes: usize) -> (wgpu::Buffer, wgpu::BindGroup) {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: bytes as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
        });
        (buffer, bind_group)
    }

    fn new_target(&self, size: [u32; 2]) -> Target {
        let texture = |format, sample_count, usage| {
            let texture = self.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("offscreen"),
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

    /// Clears the picture and has `paint` paint it.
    pub fn paint(&self, paint: impl FnOnce(&mut wgpu::RenderPass<'_>)) {
        let Some(target) = &self.target else { return };
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("offscreen"),
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
        paint(&mut pass);
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }
}

/// The fixed parts of a pipeline that paints into an [`Offscreen`]: depths are compared, and the nearest is seen.
pub fn depth_stencil() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Less),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}
