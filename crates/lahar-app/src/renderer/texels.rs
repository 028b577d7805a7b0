//! Particles on the graphics card: two textures that the vertex shader reads, rows of [`WIDTH`] particles.
//!
//! A texture, because GL and WebGL2 have no storage buffers in vertex shaders; and not one instance a
//! particle, because drivers that draw with the processor take instances one by one, which was measured
//! to cost them most of their time.

use eframe::egui_wgpu::wgpu;

use super::Sprites;
use super::pipelines::Pipelines;

/// Particles in a row; particles.wgsl has the same number.
const WIDTH: u32 = 2048;

/// Two textures and the camera, bound.
pub(super) struct Texels {
    places: wgpu::Texture,
    colors: wgpu::Texture,
    pub(super) group: wgpu::BindGroup,
    /// Particles in it.
    pub(super) count: u32,
}

impl Texels {
    /// How many particles textures of this device take.
    pub(super) fn most(device: &wgpu::Device) -> usize {
        WIDTH as usize * device.limits().max_texture_dimension_2d as usize
    }

    /// Room for `particles` of them, or as many as a texture of this device takes.
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
            // Powers of two: emitters need not have new textures each frame.
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

    fn room(&self) -> usize {
        WIDTH as usize * self.places.height() as usize
    }

    /// Whether so many particles need larger textures, and there are any.
    pub(super) fn is_too_small(&self, device: &wgpu::Device, particles: usize) -> bool {
        particles > self.room() && self.places.height() < device.limits().max_texture_dimension_2d
    }

    /// Takes in the particles, as many as there is room for.
    pub(super) fn fill(&mut self, queue: &wgpu::Queue, sprites: &Sprites) {
        let count = sprites.places.len().min(self.room());
        self.count = count as u32;
        write(queue, &self.places, &sprites.places[..count]);
        write(queue, &self.colors, &sprites.colors[..count]);
    }
}

/// Whole rows, then what is left.
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
