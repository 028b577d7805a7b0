//! A canvas: the particles, the lines and the texture of one picture on the graphics card.

use std::sync::Arc;

use eframe::egui::Color32;
use eframe::egui_wgpu::wgpu;

use super::pipelines::{COLOR, DEPTH, Pipelines};
use super::texels::Texels;
use super::{Picture, View};

/// The buffers that one picture is drawn from, and the texture that it is drawn onto.
pub(super) struct Canvas {
    view: wgpu::Buffer,
    sprites: Texels,
    lines: LineBuffer,
    target: Option<Target>,
    drawn: Option<Picture>,
}

/// The texture of a picture, with its depth.
struct Target {
    size: [u32; 2],
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    shown: wgpu::BindGroup,
}

impl Canvas {
    pub(super) fn new(device: &wgpu::Device, pipelines: &Pipelines) -> Self {
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<View>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            sprites: Texels::new(device, pipelines, &view, 0),
            view,
            lines: LineBuffer::default(),
            target: None,
            drawn: None,
        }
    }

    /// Draws the finished picture onto the window.
    pub(super) fn show(&self, pass: &mut wgpu::RenderPass<'static>, pipelines: &Pipelines) {
        if let Some(target) = &self.target {
            pass.set_pipeline(&pipelines.show);
            pass.set_bind_group(0, &target.shown, &[]);
            pass.draw(0..4, 0..1);
        }
    }

    /// The texture with the picture; `None` before the first picture.
    pub(super) fn texture(&self) -> Option<&wgpu::Texture> {
        self.target.as_ref().map(|target| target.color.texture())
    }

    /// Draws the picture onto its texture, with `samples` × `samples` texels per pixel, unless it is there already.
    pub(super) fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &Pipelines,
        (picture, samples): (&Picture, u32),
    ) {
        let size = picture.view.pixels.map(|p| (p as u32).max(1) * samples);
        let drawn = self.drawn.take();
        let same_sprites =
            (drawn.as_ref()).is_some_and(|d| Arc::ptr_eq(&d.sprites, &picture.sprites));
        let same_lines = (drawn.as_ref()).is_some_and(|d| Arc::ptr_eq(&d.lines, &picture.lines));
        let same_rest = drawn.as_ref().is_some_and(|d| {
            d.view == picture.view && d.solid == picture.solid && d.background == picture.background
        });
        self.drawn = Some(picture.clone());
        if same_sprites && same_lines && same_rest {
            return;
        }
        if !same_sprites {
            let count = picture.sprites.places.len();
            if self.sprites.is_too_small(device, count) {
                self.sprites = Texels::new(device, pipelines, &self.view, count);
            }
            self.sprites.fill(queue, &picture.sprites);
        }
        if !same_lines {
            let bytes = bytemuck::cast_slice(&picture.lines);
            self.lines.fill(device, queue, bytes);
        }
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&picture.view));
        if self
            .target
            .as_ref()
            .is_none_or(|target| target.size != size)
        {
            self.target = Some(make_target(device, pipelines, size));
        }
        let Some(target) = &self.target else { return };

        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("particles"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(clear_color(picture.background)),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &target.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.sprites.group, &[]);
        pass.set_pipeline(if picture.solid {
            &pipelines.balls
        } else {
            &pipelines.discs
        });
        // Each particle is two triangles.
        pass.draw(0..6 * self.sprites.count, 0..1);
        if let Some(lines) = &self.lines.buffer {
            pass.set_pipeline(if picture.solid {
                &pipelines.lines_among_balls
            } else {
                &pipelines.lines_over_discs
            });
            pass.set_vertex_buffer(0, lines.slice(..));
            pass.draw(0..4, 0..picture.lines.len() as u32);
        }
    }
}

fn make_target(device: &wgpu::Device, pipelines: &Pipelines, size: [u32; 2]) -> Target {
    let texture = |label, format, usage| {
        device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
            .create_view(&wgpu::TextureViewDescriptor::default())
    };
    let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
    let color = texture(
        "picture",
        COLOR,
        attachment | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
    );
    let shown = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("show"),
        layout: &pipelines.show_layout,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&color),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::Sampler(&pipelines.sampler),
            },
        ],
    });
    Target {
        size,
        depth: texture("depth", DEPTH, attachment),
        color,
        shown,
    }
}

fn clear_color(color: Color32) -> wgpu::Color {
    let [r, g, b, a] = color.to_array().map(|c| f64::from(c) / 255.0);
    wgpu::Color { r, g, b, a }
}

/// The vertex buffer of the lines. It is replaced by a larger one when it gets too small.
#[derive(Default)]
struct LineBuffer {
    buffer: Option<wgpu::Buffer>,
}

impl LineBuffer {
    fn fill(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) {
        let needed = bytes.len() as u64;
        if needed == 0 {
            return;
        }
        if self.buffer.as_ref().is_none_or(|b| b.size() < needed) {
            self.buffer = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("lines"),
                size: needed.next_multiple_of(4096),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.buffer {
            queue.write_buffer(buffer, 0, bytes);
        }
    }
}
