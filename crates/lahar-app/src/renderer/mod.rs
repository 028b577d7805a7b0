//! Draws particles and lines with wgpu, within egui's frame.
//!
//! ```text
//!   Picture ──prepare──▶ instances, camera ──▶ own texture with depth ──paint──▶ egui's render pass
//!                         (only what changed)    (only if anything changed)
//! ```
//!
//! The picture has a texture of its own, because egui's pass has no depth and is drawn anew for every
//! movement of the mouse, when no particle has moved.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use eframe::egui::{self, Color32};
use eframe::egui_wgpu::{
    self, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor, wgpu,
};

use crate::camera::M4;

/// A particle as the shader takes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Sprite {
    /// Less the picture's origin \[m\].
    pub position: [f32; 3],
    /// Distance to its neighbours at rest \[m\].
    pub spacing: f32,
    /// Red, green, blue, 255.
    pub colour: [u8; 4],
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
    pub colour: [u8; 4],
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

/// All that is drawn at once.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The particles.
    pub sprites: Arc<Vec<Sprite>>,
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

/// Makes pipelines and buffers, once a window, for [`Picture`]s to find.
pub fn install(state: &RenderState) {
    let gpu = Gpu::new(&state.device, state.target_format);
    state.renderer.write().callback_resources.insert(gpu);
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
        if let Some(gpu) = resources.get_mut::<Gpu>() {
            gpu.draw(device, queue, encoder, self);
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
            && let Some(target) = &gpu.target
        {
            pass.set_pipeline(&gpu.show);
            pass.set_bind_group(0, &target.shown, &[]);
            pass.draw(0..4, 0..1);
        }
    }
}

const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What stays on the graphics card.
struct Gpu {
    discs: wgpu::RenderPipeline,
    balls: wgpu::RenderPipeline,
    lines_over_discs: wgpu::RenderPipeline,
    lines_among_balls: wgpu::RenderPipeline,
    show: wgpu::RenderPipeline,
    show_layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    view: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    sprite_buffer: Growing,
    line_buffer: Growing,
    target: Option<Target>,
    drawn: Option<Picture>,
}

/// The picture's texture.
struct Target {
    size: [u32; 2],
    colour: wgpu::TextureView,
    depth: wgpu::TextureView,
    shown: wgpu::BindGroup,
}

impl Gpu {
    fn new(device: &wgpu::Device, window: wgpu::TextureFormat) -> Self {
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<View>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("view"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let view_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view"),
            layout: &view_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: view.as_entire_binding(),
            }],
        });
        let show_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("show"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let pipelines = Pipelines {
            device,
            view_layout: &view_layout,
        };
        let sprites = wgpu::VertexBufferLayout {
            array_stride: size_of::<Sprite>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Unorm8x4],
        };
        let lines = wgpu::VertexBufferLayout {
            array_stride: size_of::<Line>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Unorm8x4],
        };
        let particle_shader = include_str!("particles.wgsl");
        let line_shader = include_str!("lines.wgsl");
        Self {
            discs: pipelines.make(
                "discs",
                particle_shader,
                "disc",
                sprites.clone(),
                Order::Over,
            ),
            balls: pipelines.make("balls", particle_shader, "ball", sprites, Order::Nearest),
            lines_over_discs: pipelines.make(
                "lines",
                line_shader,
                "line",
                lines.clone(),
                Order::Over,
            ),
            lines_among_balls: pipelines.make("lines", line_shader, "line", lines, Order::Behind),
            show: show_pipeline(device, &show_layout, window),
            show_layout,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor::default()),
            view,
            view_group,
            sprite_buffer: Growing::new("sprites"),
            line_buffer: Growing::new("lines"),
            target: None,
            drawn: None,
        }
    }

    /// Draws the picture onto its texture, if it is not there already.
    fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Picture,
    ) {
        let size = picture.view.pixels.map(|p| (p as u32).max(1));
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
            let bytes = bytemuck::cast_slice(&picture.sprites);
            self.sprite_buffer.fill(device, queue, bytes);
        }
        if !same_lines {
            let bytes = bytemuck::cast_slice(&picture.lines);
            self.line_buffer.fill(device, queue, bytes);
        }
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&picture.view));
        if self
            .target
            .as_ref()
            .is_none_or(|target| target.size != size)
        {
            self.target = Some(self.make_target(device, size));
        }
        let Some(target) = &self.target else { return };

        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("particles"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.colour,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(clear_colour(picture.background)),
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
        pass.set_bind_group(0, &self.view_group, &[]);
        if let Some(sprites) = &self.sprite_buffer.buffer {
            pass.set_pipeline(if picture.solid {
                &self.balls
            } else {
                &self.discs
            });
            pass.set_vertex_buffer(0, sprites.slice(..));
            pass.draw(0..4, 0..picture.sprites.len() as u32);
        }
        if let Some(lines) = &self.line_buffer.buffer {
            pass.set_pipeline(if picture.solid {
                &self.lines_among_balls
            } else {
                &self.lines_over_discs
            });
            pass.set_vertex_buffer(0, lines.slice(..));
            pass.draw(0..4, 0..picture.lines.len() as u32);
        }
    }

    fn make_target(&self, device: &wgpu::Device, size: [u32; 2]) -> Target {
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
        let colour = texture(
            "picture",
            COLOUR,
            attachment | wgpu::TextureUsages::TEXTURE_BINDING,
        );
        let shown = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("show"),
            layout: &self.show_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&colour),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&self.sampler),
                },
            ],
        });
        Target {
            size,
            depth: texture("depth", DEPTH, attachment),
            colour,
            shown,
        }
    }
}

fn clear_colour(colour: Color32) -> wgpu::Color {
    let [r, g, b, a] = colour.to_array().map(|c| f64::from(c) / 255.0);
    wgpu::Color { r, g, b, a }
}

/// A buffer that is made anew when it gets too small.
struct Growing {
    label: &'static str,
    buffer: Option<wgpu::Buffer>,
}

impl Growing {
    fn new(label: &'static str) -> Self {
        Self {
            label,
            buffer: None,
        }
    }

    fn fill(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) {
        let needed = bytes.len() as u64;
        if needed == 0 {
            return;
        }
        if self.buffer.as_ref().is_none_or(|b| b.size() < needed) {
            self.buffer = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
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

/// Who covers whom.
#[derive(Clone, Copy)]
enum Order {
    /// The later one, by its opacity.
    Over,
    /// The nearer one.
    Nearest,
    /// Blended, where nothing is nearer.
    Behind,
}

struct Pipelines<'a> {
    device: &'a wgpu::Device,
    view_layout: &'a wgpu::BindGroupLayout,
}

impl Pipelines<'_> {
    fn make(
        &self,
        label: &str,
        source: &str,
        fragment: &str,
        instances: wgpu::VertexBufferLayout<'_>,
        order: Order,
    ) -> wgpu::RenderPipeline {
        let module = shader(self.device, label, source);
        let (blend, depth_write, compare) = match order {
            Order::Over => (true, false, wgpu::CompareFunction::Always),
            Order::Nearest => (false, true, wgpu::CompareFunction::Less),
            Order::Behind => (true, false, wgpu::CompareFunction::Less),
        };
        let layout = self
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &[Some(self.view_layout)],
                immediate_size: 0,
            });
        self.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("corner"),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &[Some(instances)],
                },
                primitive: strip(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(depth_write),
                    depth_compare: Some(compare),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: COLOUR,
                        blend: blend.then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
    }
}

fn show_pipeline(
    device: &wgpu::Device,
    group: &wgpu::BindGroupLayout,
    window: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let module = shader(device, "show", include_str!("show.wgsl"));
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("show"),
        bind_group_layouts: &[Some(group)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("show"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: strip(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(if window.is_srgb() {
                "to_linear"
            } else {
                "as_is"
            }),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(window.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn strip() -> wgpu::PrimitiveState {
    wgpu::PrimitiveState {
        topology: wgpu::PrimitiveTopology::TriangleStrip,
        ..wgpu::PrimitiveState::default()
    }
}

fn shader(device: &wgpu::Device, label: &str, source: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}
