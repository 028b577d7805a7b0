//! Draws particles and lines with wgpu, within egui's frame.
//!
//! ```text
//!   Picture ──prepare──▶ instances, camera ──▶ own texture with depth ──paint──▶ egui's render pass
//!                         (only what changed)    (only if anything changed)
//! ```
//!
//! A picture has a texture of its own, because egui's pass has no depth and is drawn anew for every
//! movement of the mouse, when no particle has moved. Without a window there is only the texture: offscreen.rs.

mod canvas;
mod offscreen;
mod pipelines;
mod texels;

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use eframe::egui::{self, Color32};
use eframe::egui_wgpu::{
    self, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor, wgpu,
};

use crate::camera::{Camera, M4, V3};
use canvas::Canvas;
pub(crate) use offscreen::Offscreen;
use pipelines::Pipelines;

/// Particles as the shader takes them, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sprites {
    /// Position less the picture's origin, and distance to the neighbors at rest \[m\].
    pub places: Vec<[f32; 4]>,
    /// Red, green, blue, 255; as many as places.
    pub colors: Vec<[u8; 4]>,
}

/// A straight line as the shader takes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Line {
    /// Less the picture's origin \[m\].
    pub start: [f32; 3],
    /// In pixels.
    pub half_width: f32,
    /// Less the picture's origin \[m\].
    pub end: [f32; 3],
    /// Red, green, blue, opacity.
    pub color: [u8; 4],
}

/// What the camera tells the shaders.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct View {
    /// World, less the origin, to the camera's axes.
    pub view: M4,
    /// The camera's axes to −1..1.
    pub projection: M4,
    /// Size of the picture.
    pub pixels: [f32; 2],
    /// Radius of a particle, in parts of its spacing.
    pub radius: f32,
    /// Uniforms come in multiples of 16 bytes.
    pub unused: f32,
}

impl View {
    /// What `camera` sees of a scene drawn less `origin` \[m\], on so many pixels that show `aspect` =
    /// width/height; `radius` of a particle in parts of its spacing.
    pub(crate) fn new(
        camera: &Camera,
        origin: V3,
        aspect: f64,
        pixels: [f32; 2],
        radius: f32,
    ) -> Self {
        Self {
            view: camera.view(origin),
            projection: camera.projection(aspect),
            pixels,
            radius,
            unused: 0.0,
        }
    }
}

/// All that is drawn at once.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Which of the pictures in the window it is; each keeps its place on the graphics card.
    pub slot: usize,
    /// The particles.
    pub sprites: Arc<Sprites>,
    /// Lines, such as the domain's edges.
    pub lines: Arc<Vec<Line>>,
    /// The camera.
    pub view: View,
    /// Balls with depth, not discs.
    pub solid: bool,
    /// Behind everything.
    pub background: Color32,
}

impl Picture {
    /// Something to add to an egui painter. Draws nothing where [`install`] was not called.
    pub fn shape(self, rect: egui::Rect) -> egui::Shape {
        egui_wgpu::Callback::new_paint_callback(rect, self).into()
    }
}

/// Makes what [`Picture`]s need to be drawn, once a window.
pub fn install(state: &RenderState) {
    let gpu = Gpu {
        pipelines: Pipelines::new(&state.device, state.target_format),
        canvases: vec![],
    };
    state.renderer.write().callback_resources.insert(gpu);
}

/// What stays on the graphics card.
struct Gpu {
    pipelines: Pipelines,
    /// By the slots of pictures.
    canvases: Vec<Canvas>,
}

impl CallbackTrait for Picture {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(Gpu {
            pipelines,
            canvases,
        }) = resources.get_mut()
        {
            while canvases.len() <= self.slot {
                canvases.push(Canvas::new(device, pipelines));
            }
            canvases[self.slot].draw(device, queue, encoder, pipelines, (self, 1));
        }
        vec![]
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(gpu) = resources.get::<Gpu>()
            && let Some(canvas) = gpu.canvases.get(self.slot)
        {
            canvas.show(pass, &gpu.pipelines);
        }
    }
}
