//! The renderer: draws particles and lines with wgpu, within egui's frame.
//!
//! ```text
//!   Picture ──prepare──▶ particles, camera ──▶ own texture with depth ──paint──▶ egui's render pass
//!                         (only what changed)    (only if anything changed)
//! ```
//!
//! A picture has a texture of its own, for two reasons: egui's pass has no depth, and egui draws anew for each movement
//! of the mouse, even if no particle has moved. Without a window there is only the texture: see offscreen.rs.

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

/// The particles of a picture, as the shader takes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sprites {
    /// Position relative to the picture's origin, and distance to the neighbors at rest \[m\].
    pub places: Vec<[f32; 4]>,
    /// Red, green, blue, 255; one color per place.
    pub colors: Vec<[u8; 4]>,
}

/// A straight line, as the shader takes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Line {
    /// Start relative to the picture's origin \[m\].
    pub start: [f32; 3],
    /// Half of the width \[pixels\].
    pub half_width: f32,
    /// End relative to the picture's origin \[m\].
    pub end: [f32; 3],
    /// Red, green, blue, opacity.
    pub color: [u8; 4],
}

/// The camera, as the shaders take it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct View {
    /// The matrix from the scene, relative to the origin, to the camera's axes.
    pub view: M4,
    /// The matrix from the camera's axes to −1..1.
    pub projection: M4,
    /// Width and height of the picture \[pixels\].
    pub pixels: [f32; 2],
    /// Radius of a particle, in parts of its spacing.
    pub radius: f32,
    /// Padding: uniforms come in multiples of 16 bytes.
    pub unused: f32,
}

impl View {
    /// The view of `camera` on a scene that is drawn relative to `origin` \[m\], in a picture of this size in pixels and
    /// this width/height. The `radius` of a particle is in parts of its spacing.
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

/// A picture of one side: everything that is drawn at once.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The number of the picture in the window. Each keeps its textures on the graphics card.
    pub slot: usize,
    /// The particles to draw.
    pub sprites: Arc<Sprites>,
    /// The lines to draw, such as the domain's edges.
    pub lines: Arc<Vec<Line>>,
    /// The camera, for the shaders.
    pub view: View,
    /// True to draw balls with depth, false to draw discs.
    pub solid: bool,
    /// The background color.
    pub background: Color32,
}

impl Picture {
    /// The shape to add to an egui painter. It draws nothing if [`install`] was not called.
    pub fn shape(self, rect: egui::Rect) -> egui::Shape {
        egui_wgpu::Callback::new_paint_callback(rect, self).into()
    }
}

/// Makes the pipelines that draw [`Picture`]s. Call it once per window.
pub fn install(state: &RenderState) {
    let gpu = Gpu {
        pipelines: Pipelines::new(&state.device, state.target_format),
        canvases: vec![],
    };
    state.renderer.write().callback_resources.insert(gpu);
}

/// The objects that stay on the graphics card.
struct Gpu {
    pipelines: Pipelines,
    /// The canvases, by the slots of pictures.
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
