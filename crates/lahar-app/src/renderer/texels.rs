//! Particles on the graphics card: two textures that the vertex shader reads, with rows of [`WIDTH`] particles.
//!
//! They are textures because GL and WebGL2 have no storage buffers in vertex shaders. They are not instances because
//! drivers that draw with the processor take instances one by one, which was measured to cost most of their time.

use eframe::egui_wgpu::wgpu;

use super::Sprites;
use super::pipelines::Pipelines;

/// Number of particles in a row; particles.wgsl has the same number.
const WIDTH: u32 = 2048;

/// The textures of places and colors, and their bind group with the camera.
pub(super) struct Texels {
    places: wgpu::Texture,
    colors: wgpu::Texture,
    pub(super) group: wgpu::BindGroup,
    /// Number of particles in the textures.
    pub(super) count: u32,
}

impl Texels {
    /// The largest number of particles that textures of this device hold.
    pub(super) fn max_particles(device: &wgpu::Device) -> usize {
        WIDTH as usize * device.limits().max_texture_dimension_2d as usize
    }

    /// Makes textures for this number of particles, or for as many as the device allows.
    pub(super) fn new(
        device: &wgpu::Device,
        pipelines: &Pipelines,
        view: &wgpu::Buffer,
        particles: usize,
    ) -> Self {
        let most = device.limits().max_texture_dimension_2d;
        let rows = u32::try_from(particles.div_ceil(WIDTH as usize)).unwrap_or(most);
        let size = wgpu::Extent3d {
            width: WIDTH,
            // Powers of two, so that emitters need not have new textures in each frame.
            height: rows.clamp(1, most).next_power_of_two().min(most),
            depth_or_array_layers: 1,
        };
        let texture = |label, format| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            })
        };
        let places = texture("places", wgpu::TextureFormat::Rgba32Float);
        let colors = texture("colors", wgpu::TextureFormat::Rgba8Unorm);
        let read =
            |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view and particles"),
            layout: &pipelines.view_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: view.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&read(&places)),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(&read(&colors)),
                },
            ],
        });
        Self {
            places,
            colors,
            group,
            count: 0,
        }
    }

    fn capacity(&self) -> usize {
        WIDTH as usize * self.places.height() as usize
    }

    /// True if this number of particles needs larger textures, and the device has larger ones.
    pub(super) fn is_too_small(&self, device: &wgpu::Device, particles: usize) -> bool {
        particles > self.capacity()
            && self.places.height() < device.limits().max_texture_dimension_2d
    }

    /// Writes the particles into the textures, as many as fit.
    pub(super) fn fill(&mut self, queue: &wgpu::Queue, sprites: &Sprites) {
        let count = sprites.places.len().min(self.capacity());
        self.count = count as u32;
        write(queue, &self.places, &sprites.places[..count]);
        write(queue, &self.colors, &sprites.colors[..count]);
    }
}

/// Writes whole rows, then the rest.
fn write<T: bytemuck::Pod>(queue: &wgpu::Queue, texture: &wgpu::Texture, texels: &[T]) {
    let width = WIDTH as usize;
    let whole = texels.len() / width * width;
    for (first, part) in [(0, &texels[..whole]), (whole, &texels[whole..])] {
        if part.is_empty() {
            continue;
        }
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: 0,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: (first / width) as u32,
                    z: 0,
                },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(part),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((width * size_of::<T>()) as u32),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: part.len().min(width) as u32,
                height: part.len().div_ceil(width) as u32,
                depth_or_array_layers: 1,
            },
        );
    }
}
