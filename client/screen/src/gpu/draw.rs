//! The passes of a picture: shadows, reflections, the scene.

use nalgebra::Matrix4;
use wgpu::{
    BindGroup, Buffer, BufferUsages, RenderPass, TextureFormat, TextureUsages, TextureView,
};

use super::adapter::Graphics;
use super::buffers::{Buffers, empty};
use super::panel::PanelDrawer;
use super::pipelines::{Layouts, Pipelines};
use super::read_back::{self, Image};
use super::targets::{REFLECTION, Reflection, Targets, shadow_map, texture, view};
use super::uniforms::{GlassBlock, PartBlock, PassBlock, STRIDE, columns, window};
use crate::camera::{Camera, Matrix, PassCamera};
use crate::error::ScreenError;
use crate::lamp::Lamp;
use crate::mirror::{Disc, Window, reflected};
use crate::moment::Moment;
use crate::panel::Primitive;
use crate::quality::{Looks, Quality};
use crate::stage::{MM, Owner, Stage};

/// Largest number of glasses: a mirror in each hand.
const GLASSES: usize = sulcus_proto::TOOLS;
/// Share of light that a front-surface mirror reflects: rhodium, 70 to 75 %.
const REFLECTED: f32 = 0.74;
/// Corners of the fan of a glass; the shader counts the same sides.
const FAN: u32 = 3 * 64;
/// Background, linear light: the dark of a room beside the lamp's patch.
const DARK: wgpu::Color = wgpu::Color {
    r: 0.010,
    g: 0.008,
    b: 0.0085,
    a: 1.0,
};

/// Background of a reflection, linear light: the dim room behind the operator.
const ROOM: wgpu::Color = wgpu::Color {
    r: 0.075,
    g: 0.078,
    b: 0.082,
    a: 1.0,
};

/// Kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Lit picture.
    Beauty,
    /// Flat colour for each part, without light: [`Renderer::identity`] has the colours.
    Identity,
}

/// View of one picture.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    /// Camera.
    pub camera: Camera,
    /// Lamp.
    pub lamp: Lamp,
    /// Fog on the glass of a mirror, 0 to 1.
    pub fog: f32,
    /// Scratches of the glass, 0 to 1.
    pub scratches: f32,
}

impl Drawing {
    /// View through a camera with the lamp beside its eye and a clean glass.
    pub fn through(camera: Camera) -> Self {
        Self {
            lamp: Lamp::beside(&camera),
            camera,
            fog: 0.0,
            scratches: 0.0,
        }
    }
}

/// Reflection of one glass in one picture.
struct Seen {
    pass: PassCamera,
    window: Window,
    /// Texels used along both edges.
    used: [u32; 2],
}

/// Drawer of a stage.
pub struct Renderer {
    graphics: Graphics,
    stage: Stage,
    buffers: Buffers,
    format: TextureFormat,
    looks: Looks,
    layouts: Layouts,
    pipelines: Pipelines,
    shadows: TextureView,
    reflections: [Reflection; GLASSES],
    targets: Option<Targets>,
    passes: Buffer,
    parts: Buffer,
    glasses: Buffer,
    /// Group of the lit passes, and of the shadow pass without the map that it draws.
    pass_groups: [BindGroup; 2],
    part_group: BindGroup,
    glass_groups: [BindGroup; GLASSES],
    panel: PanelDrawer,
    /// Background of a reflection.
    behind: wgpu::Color,
    /// Whether pictures are lit, not flat.
    is_lit: bool,
}

impl Renderer {
    /// Drawer of lit pictures for a surface of this format, or of identity pictures. All pipelines are built here.
    pub(crate) fn with_format(
        graphics: Graphics,
        stage: Stage,
        quality: Quality,
        mode: Mode,
        format: TextureFormat,
    ) -> Self {
        let mut looks = quality.looks();
        if mode == Mode::Identity {
            (looks.samples, looks.shadow) = (1, 0);
        }
        let device = &graphics.device;
        let buffers = Buffers::new(device, &graphics.queue, &stage);
        let layouts = Layouts::new(device);
        let pipelines = Pipelines::new(device, &layouts, format, &looks, mode == Mode::Identity);
        let shadows = shadow_map(device, looks.shadow);
        let reflections = [(); GLASSES].map(|()| Reflection::new(device, format));
        let block = |label, count: usize| {
            empty(device, label, BufferUsages::UNIFORM, STRIDE * count as u64)
        };
        let passes = block("passes", 1 + GLASSES);
        let parts = block("parts", stage.parts.len());
        let glasses = block("glasses", GLASSES);
        let compared = device.create_sampler(&wgpu::SamplerDescriptor {
            compare: Some(wgpu::CompareFunction::Less),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let smooth = device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let group = |layout, buffer, map: Option<(&TextureView, &wgpu::Sampler)>| {
            let mut entries = vec![entry(0, constants(buffer))];
            if let Some((map, sampler)) = map {
                entries.push(entry(1, wgpu::BindingResource::TextureView(map)));
                entries.push(entry(2, wgpu::BindingResource::Sampler(sampler)));
            }
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout,
                entries: &entries,
            })
        };
        let none = shadow_map(device, 1);
        let pass_groups =
            [&shadows, &none].map(|map| group(&layouts.pass, &passes, Some((map, &compared))));
        let part_group = group(&layouts.part, &parts, None);
        let glass_groups = std::array::from_fn(|k| {
            let picture = &reflections[k].picture;
            group(&layouts.glass, &glasses, Some((picture, &smooth)))
        });
        let panel = PanelDrawer::new(device, format);
        Self {
            panel,
            is_lit: mode == Mode::Beauty,
            behind: if mode == Mode::Identity { DARK } else { ROOM },
            format,
            looks,
            layouts,
            pipelines,
            shadows,
            reflections,
            targets: None,
            passes,
            parts,
            glasses,
            pass_groups,
            part_group,
            glass_groups,
            buffers,
            stage,
            graphics,
        }
    }

    /// Drawer of pictures in memory.
    pub fn new(graphics: Graphics, stage: Stage, quality: Quality, mode: Mode) -> Self {
        let format = match mode {
            Mode::Beauty => TextureFormat::Rgba8UnormSrgb,
            Mode::Identity => TextureFormat::Rgba8Unorm,
        };
        Self::with_format(graphics, stage, quality, mode, format)
    }

    /// Device.
    pub fn graphics(&self) -> &Graphics {
        &self.graphics
    }

    /// Stage that is drawn.
    pub fn stage(&self) -> &Stage {
        &self.stage
    }

    /// Replaces the stage: a coarser one, or that of a new scene.
    pub fn replace(&mut self, stage: Stage) {
        let device = &self.graphics.device;
        self.buffers = Buffers::new(device, &self.graphics.queue, &stage);
        let size = STRIDE * stage.parts.len() as u64;
        self.parts = empty(device, "parts", BufferUsages::UNIFORM, size);
        self.part_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layouts.part,
            entries: &[entry(0, constants(&self.parts))],
        });
        self.stage = stage;
    }

    /// Colour of a part in an identity picture.
    pub fn identity(owner: Owner) -> [u8; 4] {
        match owner {
            Owner::Object(k) => [(k & 0xff) as u8, (k >> 8) as u8, 1, 255],
            Owner::Tool(k) => [k, 0, 2, 255],
        }
    }

    /// Draws an instant into a picture of `size` pixels in memory.
    ///
    /// # Errors
    /// The size is out of range, or the driver fails.
    pub fn picture(
        &mut self,
        drawing: &Drawing,
        moment: &Moment,
        size: [u32; 2],
    ) -> Result<Image, ScreenError> {
        self.with_panel(drawing, moment, &[], size)
    }

    /// The same with a panel over the picture.
    ///
    /// # Errors
    /// The size is out of range, or the driver fails.
    pub fn with_panel(
        &mut self,
        drawing: &Drawing,
        moment: &Moment,
        panel: &[Primitive],
        size: [u32; 2],
    ) -> Result<Image, ScreenError> {
        let most = self.graphics.largest();
        let [width, height] = size;
        if size.iter().any(|n| !(16..=most).contains(n)) {
            return Err(ScreenError::Size {
                width,
                height,
                most,
            });
        }
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let target = texture(
            &self.graphics.device,
            "picture",
            self.format,
            size,
            1,
            usage,
        );
        self.draw(drawing, moment, panel, &view(&target), size);
        read_back::read(&self.graphics, &target)
    }

    /// Draws an instant into a texture of `size` pixels.
    pub(crate) fn draw(
        &mut self,
        drawing: &Drawing,
        moment: &Moment,
        panel: &[Primitive],
        target: &TextureView,
        size: [u32; 2],
    ) {
        let changed = self.stage.follow(moment);
        self.buffers
            .update(&self.graphics.queue, &self.stage.moving, &changed);
        if self
            .targets
            .as_ref()
            .is_none_or(|targets| targets.size != size)
        {
            let (device, samples) = (&self.graphics.device, self.looks.samples);
            self.targets = Some(Targets::new(device, self.format, size, samples));
        }
        let main = drawing.camera.pass();
        let seen = self.seen(&main, moment, size);
        self.write(drawing, moment, &main, &seen);
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = self.graphics.device.create_command_encoder(&descriptor);
        if self.looks.shadow > 0 {
            let mut pass = begin(&mut encoder, None, &self.shadows, DARK);
            pass.set_pipeline(&self.pipelines.shadow);
            self.meshes(&mut pass, 1, 0, moment, None, &drawing.lamp.shadows());
        }
        for (k, seen) in seen.iter().enumerate() {
            let Some(seen) = seen else { continue };
            let reflection = &self.reflections[k];
            let mut pass = begin(
                &mut encoder,
                Some((&reflection.picture, None)),
                &reflection.depth,
                self.behind,
            );
            let [w, h] = seen.used.map(|n| n as f32);
            pass.set_viewport(0.0, 0.0, w, h, 0.0, 1.0);
            pass.set_pipeline(&self.pipelines.reflected[usize::from(seen.pass.turns)]);
            self.meshes(&mut pass, 0, 1 + k, moment, Some(k), &seen.pass.matrix());
        }
        if let Some(targets) = &self.targets {
            let colour = match &targets.samples {
                Some(samples) => (samples, Some(target)),
                None => (target, None),
            };
            let mut pass = begin(&mut encoder, Some(colour), &targets.depth, DARK);
            pass.set_pipeline(&self.pipelines.meshes[usize::from(main.turns)]);
            self.meshes(&mut pass, 0, 0, moment, None, &main.matrix());
            pass.set_pipeline(&self.pipelines.glass);
            for (k, glass) in self.stage.glasses.iter().enumerate().take(GLASSES) {
                if glass.is_some() && moment.tools[k].held {
                    pass.set_bind_group(0, &self.glass_groups[k], &[offset(k)]);
                    pass.draw(0..FAN, 0..1);
                }
            }
        }
        if !panel.is_empty() {
            self.panel
                .draw(&self.graphics, &mut encoder, panel, target, size);
        }
        self.graphics.queue.submit([encoder.finish()]);
    }

    /// Reflections that the picture shows, by tool.
    fn seen(&self, main: &PassCamera, moment: &Moment, size: [u32; 2]) -> [Option<Seen>; GLASSES] {
        std::array::from_fn(|k| {
            let glass = self.stage.glasses.get(k).copied().flatten()?;
            let tool = moment.tools[k];
            let world = |v: [f32; 3]| tool.orientation * nalgebra::Vector3::from(v);
            let disc = Disc {
                centre: (world(glass.centre) * MM + tool.position).cast::<f64>(),
                normal: world(glass.normal).cast::<f64>(),
                radius: f64::from(glass.radius * MM),
            };
            let (pass, window) = reflected(main, &disc, size).filter(|_| tool.held)?;
            let pixels = |half: f64, pixels: u32| (half * f64::from(pixels)).round() as u32;
            let used = [0, 1].map(|k| pixels(window.half[k], size[k]).clamp(1, REFLECTION));
            Some(Seen { pass, window, used })
        })
    }

    /// Writes the constants of all passes, parts and glasses.
    fn write(
        &self,
        drawing: &Drawing,
        moment: &Moment,
        main: &PassCamera,
        seen: &[Option<Seen>; GLASSES],
    ) {
        let queue = &self.graphics.queue;
        let block = |camera: &PassCamera| PassBlock::new(camera, &drawing.lamp, &self.looks);
        // Each write is a copy of its own for the adapter: all blocks of a kind go together.
        let mut passes = Blocks::default();
        passes.put(0, &block(main));
        let mut parts = Blocks::default();
        for (k, part) in self.stage.parts.iter().enumerate() {
            let world = world(part.owner, moment);
            let identity = Self::identity(part.owner).map(|c| f32::from(c) / 255.0);
            let block = PartBlock::new(&world, part.material, identity);
            parts.put(k, &block);
        }
        let mut glasses = Blocks::default();
        for (k, seen) in seen.iter().enumerate() {
            if let Some(seen) = seen {
                passes.put(1 + k, &block(&seen.pass));
            }
            let Some(Some(glass)) = self.stage.glasses.get(k) else {
                continue;
            };
            let [nx, ny, nz] = glass.normal;
            let [cx, cy, cz] = glass.centre.map(|x| x * MM);
            let used = seen.as_ref().map_or([0; 2], |seen| seen.used);
            let [u, v] = used.map(|n| n as f32 / REFLECTION as f32);
            let block = GlassBlock {
                camera: columns(&main.matrix()),
                world: moment.tools[k].matrix().into(),
                window: seen
                    .as_ref()
                    .map_or([0.0, 0.0, 1.0, 1.0], |seen| window(&seen.window)),
                centre: [cx, cy, cz, glass.radius * MM],
                normal: [nx, ny, nz, REFLECTED],
                looks: [
                    drawing.fog,
                    drawing.scratches,
                    f32::from(u8::from(seen.is_some())),
                    0.0,
                ],
                used: [u, v, 0.0, 0.0],
            };
            glasses.put(k, &block);
        }
        let all = [
            (&self.passes, passes),
            (&self.parts, parts),
            (&self.glasses, glasses),
        ];
        for (buffer, blocks) in all.into_iter().filter(|(_, blocks)| !blocks.0.is_empty()) {
            queue.write_buffer(buffer, 0, &blocks.0);
        }
    }

    /// Draws all parts within the clip space `clip` but the tool `without`. Tools that no hand holds are not drawn.
    fn meshes(
        &self,
        pass: &mut RenderPass<'_>,
        group: usize,
        block: usize,
        moment: &Moment,
        without: Option<usize>,
        clip: &Matrix,
    ) {
        pass.set_bind_group(0, &self.pass_groups[group], &[offset(block)]);
        pass.set_vertex_buffer(0, self.buffers.still.slice(..));
        pass.set_vertex_buffer(1, self.buffers.moving.slice(..));
        pass.set_index_buffer(self.buffers.corners.slice(..), wgpu::IndexFormat::Uint32);
        // Draw of several parts: number of its first part, and its corners.
        let mut together: Option<(usize, std::ops::Range<u32>)> = None;
        let parts = self.stage.parts.iter().zip(&self.stage.balls);
        for (k, (part, ball)) in parts.enumerate() {
            let is_drawn = match part.owner {
                Owner::Object(_) => true,
                Owner::Tool(tool) => {
                    let tool = usize::from(tool);
                    moment.tools[tool].held && without != Some(tool)
                }
            };
            let is_seen = || ball.is_seen(&world(part.owner, moment), clip);
            if is_drawn && !part.corners.is_empty() && is_seen() {
                let own = part.corners.start as u32..part.corners.end as u32;
                match &mut together {
                    Some((first, corners))
                        if corners.end == own.start && self.is_alike(*first, k) =>
                    {
                        corners.end = own.end;
                    }
                    together => {
                        if let Some((first, corners)) = together.replace((k, own)) {
                            pass.set_bind_group(1, &self.part_group, &[offset(first)]);
                            pass.draw_indexed(corners, 0, 0..1);
                        }
                    }
                }
            }
        }
        if let Some((first, corners)) = together {
            pass.set_bind_group(1, &self.part_group, &[offset(first)]);
            pass.draw_indexed(corners, 0, 0..1);
        }
    }

    /// Whether two parts have the same constants: objects of one material in a lit picture.
    fn is_alike(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.stage.parts[a], &self.stage.parts[b]);
        let are_objects = [a, b]
            .iter()
            .all(|part| matches!(part.owner, Owner::Object(_)));
        self.is_lit && are_objects && a.material == b.material
    }
}

/// World from the axes of a part.
fn world(owner: Owner, moment: &Moment) -> Matrix4<f32> {
    match owner {
        Owner::Object(_) => Matrix4::identity(),
        Owner::Tool(tool) => moment.tools[usize::from(tool)].matrix(),
    }
}

/// Blocks of constants, one every [`STRIDE`] bytes.
#[derive(Default)]
struct Blocks(Vec<u8>);

impl Blocks {
    fn put<T: bytemuck::Pod>(&mut self, number: usize, block: &T) {
        let bytes = bytemuck::bytes_of(block);
        let begin = STRIDE as usize * number;
        self.0.resize(begin + STRIDE as usize, 0);
        self.0[begin..begin + bytes.len()].copy_from_slice(bytes);
    }
}

fn offset(block: usize) -> u32 {
    (STRIDE * block as u64) as u32
}

fn entry(binding: u32, resource: wgpu::BindingResource<'_>) -> wgpu::BindGroupEntry<'_> {
    wgpu::BindGroupEntry { binding, resource }
}

/// Block of a buffer of blocks; the offset is given with each use.
fn constants(buffer: &Buffer) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: 0,
        size: std::num::NonZeroU64::new(STRIDE),
    })
}

/// Begins a pass that clears its targets: colour with an optional resolve target, and depth.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    colour: Option<(&TextureView, Option<&TextureView>)>,
    depth: &TextureView,
    clear: wgpu::Color,
) -> RenderPass<'e> {
    let colour = colour.map(|(view, resolve_target)| {
        Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(clear),
                store: wgpu::StoreOp::Store,
            },
        })
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: None,
        color_attachments: colour.as_slice(),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(1.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
