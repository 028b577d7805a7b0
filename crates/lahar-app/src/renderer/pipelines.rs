//! The pipelines that draw particles, lines and finished pictures.

use eframe::egui_wgpu::wgpu;

use super::Line;

/// Format of a picture's texture.
pub(super) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of a picture's depth.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// All pipelines, made once per window.
pub(super) struct Pipelines {
    pub(super) discs: wgpu::RenderPipeline,
    pub(super) balls: wgpu::RenderPipeline,
    pub(super) lines_over_discs: wgpu::RenderPipeline,
    pub(super) lines_among_balls: wgpu::RenderPipeline,
    pub(super) show: wgpu::RenderPipeline,
    pub(super) view_layout: wgpu::BindGroupLayout,
    pub(super) show_layout: wgpu::BindGroupLayout,
    pub(super) sampler: wgpu::Sampler,
}

impl Pipelines {
    pub(super) fn new(device: &wgpu::Device, window: wgpu::TextureFormat) -> Self {
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("view and particles"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                },
                texels(1),
                texels(2),
            ],
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
        let make = |label, source, fragment, instances, covering| {
            make(
                (device, &view_layout),
                label,
                source,
                fragment,
                instances,
                covering,
            )
        };
        let lines = wgpu::VertexBufferLayout {
            array_stride: size_of::<Line>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Unorm8x4],
        };
        let particle_shader = include_str!("particles.wgsl");
        let line_shader = include_str!("lines.wgsl");
        Self {
            discs: make("discs", particle_shader, "disc", None, Covering::Over),
            balls: make("balls", particle_shader, "ball", None, Covering::Nearest),
            lines_over_discs: make(
                "lines",
                line_shader,
                "line",
                Some(lines.clone()),
                Covering::Over,
            ),
            lines_among_balls: make("lines", line_shader, "line", Some(lines), Covering::Behind),
            show: show_pipeline(device, &show_layout, window),
            view_layout,
            show_layout,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor::default()),
        }
    }
}

/// The layout of a texture that the vertex shader reads texel by texel.
fn texels(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

/// The rule by which shapes cover each other.
#[derive(Clone, Copy)]
enum Covering {
    /// The later shape covers the earlier one, by its opacity.
    Over,
    /// The nearer shape covers the farther one.
    Nearest,
    /// The shape is blended in where nothing is nearer.
    Behind,
}

fn make(
    (device, view_layout): (&wgpu::Device, &wgpu::BindGroupLayout),
    label: &str,
    source: &str,
    fragment: &str,
    instances: Option<wgpu::VertexBufferLayout<'_>>,
    covering: Covering,
) -> wgpu::RenderPipeline {
    let module = shader(device, label, source);
    // The shader makes the triangles of particles.
    let primitive = instances
        .as_ref()
        .map_or_else(Default::default, |_| strip());
    let buffers: Vec<_> = instances.into_iter().map(Some).collect();
    let (blend, depth_write, compare) = match covering {
        Covering::Over => (true, false, wgpu::CompareFunction::Always),
        Covering::Nearest => (false, true, wgpu::CompareFunction::Less),
        Covering::Behind => (true, false, wgpu::CompareFunction::Less),
    };
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &[Some(view_layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &buffers,
        },
        primitive,
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
                format: COLOR,
                blend: blend.then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
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
