//! Draws pictures without a window: onto a texture that is read back.

use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui_wgpu::{WgpuSetupCreateNew, wgpu};
use lahar_io::image;

use super::Picture;
use super::canvas::Canvas;
use super::pipelines::{COLOR, Pipelines};
use super::texels::Texels;
use crate::adapter;

/// Bytes of a pixel in [`COLOR`].
const PIXEL: usize = 4;

/// A graphics adapter that draws one picture after the other.
pub(crate) struct Offscreen {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipelines: Pipelines,
    canvas: Canvas,
    /// Texels per pixel along each axis.
    samples: u32,
    fault: Fault,
}

/// The first error of the device, which reports errors from threads of its own.
#[derive(Clone, Default)]
struct Fault(Arc<Mutex<Option<String>>>);

impl Fault {
    fn note(&self, what: String) {
        let mut fault = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        fault.get_or_insert(what);
    }

    fn check(&self) -> Result<(), String> {
        let fault = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        fault.clone().map_or(Ok(()), Err)
    }
}

/// Finds an adapter that can draw without a display, software included, and its name.
///
/// # Errors
/// There is none. The message names the backends that were looked for.
fn find_adapter() -> Result<(wgpu::Adapter, String), String> {
    let setup = WgpuSetupCreateNew::without_display_handle();
    let wanted = setup.instance_descriptor;
    let options = wgpu::RequestAdapterOptions {
        power_preference: setup.power_preference,
        ..wgpu::RequestAdapterOptions::default()
    };
    let find = |backends| {
        let instance = adapter::instance(&wanted, backends);
        pollster::block_on(instance.request_adapter(&options)).ok()
    };
    // GL is asked last, where there is nothing better.
    let gl = wgpu::Backends::GL;
    let adapter = (find(wanted.backends - gl))
        .or_else(|| find(wanted.backends & gl))
        .ok_or_else(|| adapter::none_found(wanted.backends))?;
    let info = adapter.get_info();
    let name = format!("{} ({})", info.name, info.backend);
    Ok((adapter, name))
}

impl Offscreen {
    /// Opens the best adapter and returns its name. Pictures may be as large as `size` \[pixels\]. Each pixel is the mean
    /// of `samples` × `samples` points, or of fewer if the adapter's textures are too small for them.
    ///
    /// # Errors
    /// There is no adapter, or it gives no device.
    pub(crate) fn new(size: [u32; 2], samples: u32) -> Result<(Self, String), String> {
        let (adapter, name) = find_adapter()?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("pictures"),
            // Pictures may be large, and particles many: everything the adapter offers is asked for.
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        }))
        .map_err(|error| format!("{name}: {error}"))?;
        let fault = Fault::default();
        let on_error = fault.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            on_error.note(error.to_string());
        }));
        let on_loss = fault.clone();
        device.set_device_lost_callback(move |reason, what| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                on_loss.note(format!("the device was lost: {what}"));
            }
        });
        let room = device.limits().max_texture_dimension_2d / size[0].max(size[1]).max(1);
        let pipelines = Pipelines::new(&device, COLOR);
        let offscreen = Self {
            canvas: Canvas::new(&device, &pipelines),
            device,
            queue,
            pipelines,
            samples: samples.min(room).max(1),
            fault,
        };
        offscreen.fault.check()?;
        Ok((offscreen, name))
    }

    /// Draws a picture and waits for it.
    ///
    /// # Errors
    /// The picture is too large for the adapter, or drawing failed. After a failure nothing can be drawn any more.
    pub(crate) fn draw(&mut self, picture: &Picture) -> Result<image::Picture, String> {
        let samples = self.samples;
        let [width, height] = picture.view.pixels.map(|side| (side as u32).max(1));
        let limits = self.device.limits();
        let row = (width as usize * samples as usize * PIXEL)
            .next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let bytes = row as u64 * u64::from(height) * u64::from(samples);
        let most = limits.max_texture_dimension_2d / samples;
        if width > most || height > most || bytes > limits.max_buffer_size {
            return Err(format!(
                "pictures of {width}x{height} pixels are too large for the adapter ({most} a side, {} MB in all)",
                limits.max_buffer_size >> 20,
            ));
        }
        let particles = picture.sprites.places.len();
        let room = Texels::max_particles(&self.device);
        if particles > room {
            return Err(format!(
                "{particles} particles are too many for the adapter, which draws {room} at most"
            ));
        }

        let mut encoder = (self.device).create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("picture"),
        });
        self.canvas.draw(
            &self.device,
            &self.queue,
            &mut encoder,
            &self.pipelines,
            (picture, samples),
        );
        let read = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        self.fault.check()?;
        if let Some(texture) = self.canvas.texture() {
            encoder.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &read,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(row as u32),
                        rows_per_image: None,
                    },
                },
                texture.size(),
            );
        }
        self.queue.submit([encoder.finish()]);
        let on_error = self.fault.clone();
        read.map_async(wgpu::MapMode::Read, .., move |mapped| {
            if let Err(error) = mapped {
                on_error.note(format!("the picture cannot be read back: {error}"));
            }
        });
        (self.device.poll(wgpu::PollType::wait_indefinitely())).map_err(|e| e.to_string())?;
        self.fault.check()?;
        let texels = read.get_mapped_range(..).map_err(|e| e.to_string())?;
        Ok(image::Picture {
            width,
            height,
            rgb: mean_of_samples(&texels, row, samples as usize, width as usize),
        })
    }
}

/// The pixels of a picture, each the mean of `samples` × `samples` texels. A row of texels takes `row` bytes, of which
/// those beyond `width` pixels are padding.
fn mean_of_samples(texels: &[u8], row: usize, samples: usize, width: usize) -> Vec<u8> {
    let count = (samples * samples) as u32;
    let mut rgb = Vec::with_capacity(3 * width * (texels.len() / (row * samples)));
    let mut sums = vec![[0_u32; 3]; width];
    for rows in texels.chunks_exact(row * samples) {
        sums.fill([0; 3]);
        for row in rows.chunks_exact(row) {
            for (sum, pixel) in sums.iter_mut().zip(row.chunks_exact(samples * PIXEL)) {
                for texel in pixel.chunks_exact(PIXEL) {
                    for (sum, part) in sum.iter_mut().zip(texel) {
                        *sum += u32::from(*part);
                    }
                }
            }
        }
        let rounded = |sum: &u32| ((sum + count / 2) / count) as u8;
        rgb.extend(sums.iter().flatten().map(rounded));
    }
    rgb
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_the_mean_of_their_samples() {
        // Two pixels of 2 × 2 texels, and padding at the end of rows.
        let row = |texels: [u8; 4]| {
            let mut row: Vec<u8> = texels.iter().flat_map(|&t| [t, 2 * t, 0, 255]).collect();
            row.extend([9; 16]);
            row
        };
        let texels = [row([10, 20, 100, 101]), row([30, 40, 100, 101])].concat();
        let rgb = mean_of_samples(&texels, 32, 2, 2);
        assert_eq!(rgb, [25, 50, 0, 101, 201, 0]);
    }
}
