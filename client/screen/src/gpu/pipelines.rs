//! Pipelines: which shader draws which vertices into which format.

use wgpu::{BindGroupLayout, Device, FrontFace, RenderPipeline, ShaderModule, TextureFormat};

use super::palate;
use super::targets::DEPTH;
use crate::quality::Looks;
use crate::stage::{Moving, Still};

/// Layouts of the bind groups.
pub(super) struct Layouts {
    /// Pass, shadow map and its sampler.
    pub pass: BindGroupLayout,
    /// Part.
    pub part: BindGroupLayout,
    /// Glass, picture of the reflection and its sampler.
    pub glass: BindGroupLayout,
}

/// Pipelines of one mode.
pub(super) struct Pipelines {
    /// Meshes, for triangles that run counterclockwise and clockwise in the picture, with the picture's samples.
    pub meshes: [RenderPipeline; 2],
    /// The same for a reflection, which has one sample.
    pub reflected: [RenderPipeline; 2],
    /// Upper jaw of a reflection; `None` for pictures without light, and for levels that save time.
    pub palate: Option<RenderPipeline>,
    /// Glass: clean, and with fog or scratches.
    pub glass: [RenderPipeline; 2],
    /// Depth of the shadow map.
    pub shadow: RenderPipeline,
}

impl Layouts {
    pub fn new(device: &Device) -> Self {
        use wgpu::{BindingType, SamplerBindingType, TextureSampleType};
        let texture = |sample_type| BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let depth = texture(TextureSampleType::Depth);
        let colour = texture(TextureSampleType::Float { filterable: true });
        let sampler = |kind| BindingType::Sampler(kind);
        Self {
            pass: layout(
                device,
                "pass",
                &[block(), depth, sampler(SamplerBindingType::Comparison)],
            ),
            part: layout(device, "part", &[block()]),
            glass: layout(
                device,
                "glass",
                &[block(), colour, sampler(SamplerBindingType::Filtering)],
            ),
        }
    }
}

/// Block of constants at a dynamic offset.
fn block() -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: true,
        min_binding_size: None,
    }
}

fn layout(device: &Device, label: &str, types: &[wgpu::BindingType]) -> BindGroupLayout {
    let entries: Vec<wgpu::BindGroupLayoutEntry> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: *ty,
            count: None,
        })
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    })
}

/// Shaders of a pipeline, and the state that differs between pipelines.
pub(super) struct Recipe<'a> {
    pub label: &'a str,
    pub module: &'a ShaderModule,
    pub vertex: &'a str,
    /// Entry of the fragment shader with the target; `None` for depth alone.
    pub fragment: Option<(&'a str, wgpu::ColorTargetState)>,
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub layouts: &'a [Option<&'a BindGroupLayout>],
    pub front: FrontFace,
    pub cull: Option<wgpu::Face>,
    pub samples: u32,
    /// Whether depth is tested and written.
    pub depth: bool,
}

impl Recipe<'_> {
    pub fn pipeline(&self, device: &Device) -> RenderPipeline {
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: self.layouts,
            immediate_size: 0,
        });
        let targets = self
            .fragment
            .as_ref()
            .map(|(_, target)| [Some(target.clone())]);
        let fragment = self.fragment.as_ref().zip(targets.as_ref());
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(self.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState {
                front_face: self.front,
                cull_mode: self.cull,
                ..Default::default()
            },
            depth_stencil: self.depth.then(|| wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: self.samples,
                ..Default::default()
            },
            fragment: fragment.map(|((entry, _), targets)| wgpu::FragmentState {
                module: self.module,
                entry_point: Some(*entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Pipelines {
    /// Pipelines for lit pictures, or for identity pictures of flat colours.
    pub fn new(
        device: &Device,
        layouts: &Layouts,
        format: TextureFormat,
        looks: &Looks,
        identity: bool,
    ) -> Self {
        let scene = shader(device, "scene", include_str!("scene.wgsl"));
        let glass = shader(device, "glass", include_str!("glass.wgsl"));
        let (vertex, fragment) = match (identity, looks.per_pixel) {
            (true, _) => ("identity_vertex", "identity_pixel"),
            (false, true) => ("vertex_for_pixels", "lit_pixel"),
            (false, false) => ("lit_vertex", "flat_pixel"),
        };
        let target = wgpu::ColorTargetState {
            format,
            blend: None,
            write_mask: wgpu::ColorWrites::ALL,
        };
        let meshes = |front, samples| {
            Recipe {
                label: "meshes",
                module: &scene,
                vertex,
                fragment: Some((fragment, target.clone())),
                buffers: &[Some(still()), Some(moving())],
                layouts: &[Some(&layouts.pass), Some(&layouts.part)],
                front,
                cull: Some(wgpu::Face::Back),
                samples,
                depth: true,
            }
            .pipeline(device)
        };
        let fronts = [FrontFace::Ccw, FrontFace::Cw];
        Self {
            meshes: fronts.map(|front| meshes(front, looks.samples)),
            reflected: fronts.map(|front| meshes(front, 1)),
            palate: (!identity && looks.per_pixel)
                .then(|| palate::pipeline(device, layouts, &target)),
            glass: ["clean", "pixel"].map(|entry| {
                Recipe {
                    label: "glass",
                    module: &glass,
                    vertex: "vertex",
                    fragment: Some((if identity { "identity" } else { entry }, target.clone())),
                    buffers: &[],
                    layouts: &[Some(&layouts.glass)],
                    front: FrontFace::Ccw,
                    cull: None,
                    samples: looks.samples,
                    depth: true,
                }
                .pipeline(device)
            }),
            shadow: Recipe {
                label: "shadow",
                module: &scene,
                vertex: "shadow_vertex",
                fragment: None,
                buffers: &[Some(still()), Some(moving())],
                // The shadow map is drawn without itself: its own group has the map of one texel.
                layouts: &[Some(&layouts.pass), Some(&layouts.part)],
                front: FrontFace::Ccw,
                cull: Some(wgpu::Face::Back),
                samples: 1,
                depth: true,
            }
            .pipeline(device),
        }
    }
}

pub(super) fn shader(device: &Device, label: &str, source: &str) -> ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

fn still() -> wgpu::VertexBufferLayout<'static> {
    const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
        wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4, 2 => Unorm8x4];
    wgpu::VertexBufferLayout {
        array_stride: size_of::<Still>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &ATTRIBUTES,
    }
}

fn moving() -> wgpu::VertexBufferLayout<'static> {
    const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
        wgpu::vertex_attr_array![3 => Float32x3, 4 => Float32x3, 5 => Float32];
    wgpu::VertexBufferLayout {
        array_stride: size_of::<Moving>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &ATTRIBUTES,
    }
}
