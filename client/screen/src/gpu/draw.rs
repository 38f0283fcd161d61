//! The passes of a picture: shadows, reflections, the scene.

use wgpu::{
    BindGroup, Buffer, BufferUsages, RenderPass, Texture, TextureFormat, TextureUsages, TextureView,
};

use super::adapter::Graphics;
use super::buffers::{Buffers, List, empty};
use super::drawing::{Drawing, Mode, Work};
use super::palate;
use super::panel::PanelDrawer;
use super::pass::{Blocks, begin, constants, entry, offset};
use super::pipelines::{Layouts, Pipelines};
use super::read_back::{self, Image};
use super::targets::{REFLECTION, Reflection, Targets, shadow_map, texture, view};
use super::uniforms::{GlassBlock, PartBlock, PassBlock, STRIDE, columns, window};
use crate::camera::{Matrix, PassCamera};
use crate::error::ScreenError;
use crate::mirror::{Disc, Window, reflected};
use crate::moment::Moment;
use crate::panel::Primitive;
use crate::plan::{self, Alike, Plan, world};
use crate::quality::{Looks, Quality};
use crate::stage::{MM, Owner, Stage};

/// Number of lists of corners: of the picture, of each reflection, of the shadows.
const LISTS: usize = 2 + GLASSES;
/// Largest number of glasses: a mirror in each hand.
const GLASSES: usize = sulcus_proto::TOOLS;
/// Share of light that a front-surface mirror reflects: rhodium, 70 to 75 %.
const REFLECTED: f32 = 0.74;
/// Light of a glass without a reflection; the shader has the same.
const BLIND: [f64; 3] = [0.16, 0.17, 0.18];
/// Corners of the fan of a glass; the shader counts the same sides.
const FAN: u32 = 3 * 64;
/// Background, linear light: the dark of a room beside the lamp's patch.
const DARK: wgpu::Color = wgpu::Color {
    r: 0.010,
    g: 0.008,
    b: 0.0085,
    a: 1.0,
};

/// Background of a reflection, linear light: cheek and throat in dim light behind the upper jaw. Chosen.
const THROAT: wgpu::Color = wgpu::Color {
    r: 0.060,
    g: 0.027,
    b: 0.024,
    a: 1.0,
};

/// The same where the upper jaw is left out: its mean colour.
const PALATE: wgpu::Color = wgpu::Color {
    r: 0.150,
    g: 0.055,
    b: 0.042,
    a: 1.0,
};

/// Reflection of one glass in one picture.
struct Seen {
    pass: PassCamera,
    window: Window,
    /// Number of the texture.
    texture: usize,
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
    /// Textures of each glass, by size.
    reflections: [[Reflection; REFLECTION.len()]; GLASSES],
    targets: Option<Targets>,
    passes: Buffer,
    parts: Buffer,
    glasses: Buffer,
    /// Group of the lit passes, and of the shadow pass without the map that it draws.
    pass_groups: [BindGroup; 2],
    part_group: BindGroup,
    glass_groups: [[BindGroup; REFLECTION.len()]; GLASSES],
    /// Lists of corners: of the picture, of each reflection, of the shadows.
    lists: [List; LISTS],
    panel: PanelDrawer,
    /// Whether pictures are lit, not flat.
    is_lit: bool,
    /// Whether the shaders code light as sRGB, not the target.
    is_coded: bool,
    /// Texture of pictures that nobody reads.
    unread: Option<Texture>,
    /// Work of the last picture.
    work: Work,
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
        let is_coded = mode == Mode::Beauty && !format.is_srgb();
        let device = &graphics.device;
        let buffers = Buffers::new(device, &graphics.queue, &stage);
        let layouts = Layouts::new(device);
        let pipelines = Pipelines::new(device, &layouts, format, &looks, mode == Mode::Identity);
        let shadows = shadow_map(device, looks.shadow);
        let reflections =
            [(); GLASSES].map(|()| REFLECTION.map(|edge| Reflection::new(device, format, edge)));
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
            std::array::from_fn(|size| {
                let picture = &reflections[k][size].picture;
                group(&layouts.glass, &glasses, Some((picture, &smooth)))
            })
        });
        let lists = std::array::from_fn(|_| List::new(device, &stage));
        let panel = PanelDrawer::new(device, format);
        Self {
            panel,
            is_lit: mode == Mode::Beauty,
            is_coded,
            unread: None,
            work: Work::default(),
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
            lists,
            buffers,
            stage,
            graphics,
        }
    }

    /// Drawer of pictures in memory.
    pub fn new(graphics: Graphics, stage: Stage, quality: Quality, mode: Mode) -> Self {
        let format = match mode {
            Mode::Beauty if quality.looks().per_pixel => TextureFormat::Rgba8UnormSrgb,
            _ => TextureFormat::Rgba8Unorm,
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
        self.lists = std::array::from_fn(|_| List::new(device, &stage));
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

    /// Draws an instant as a window does, and waits until it is drawn. Nobody reads the picture.
    ///
    /// # Errors
    /// The driver fails.
    pub fn unread(
        &mut self,
        drawing: &Drawing,
        moment: &Moment,
        size: [u32; 2],
    ) -> Result<(), ScreenError> {
        let is_there = |made: &Texture| [made.width(), made.height()] == size;
        let target = match self.unread.take().filter(is_there) {
            Some(target) => target,
            None => {
                let usage = TextureUsages::RENDER_ATTACHMENT;
                texture(&self.graphics.device, "unread", self.format, size, 1, usage)
            }
        };
        self.draw(drawing, moment, &[], &view(&target), size);
        self.unread = Some(target);
        let waited = self
            .graphics
            .device
            .poll(wgpu::PollType::wait_indefinitely());
        waited.map_err(|error| ScreenError::Lost(error.to_string()))?;
        self.graphics.check()
    }

    /// Work of the last picture.
    pub fn work(&self) -> Work {
        self.work
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
        let lamp = drawing.lamp.shadows();
        self.plan(LISTS - 1, moment, &lamp, None, self.looks.shadow > 0);
        for (k, seen) in seen.iter().enumerate() {
            let clip = seen.as_ref().map(|seen| seen.pass.matrix());
            self.plan(
                1 + k,
                moment,
                &clip.unwrap_or_default(),
                Some(k),
                clip.is_some(),
            );
        }
        self.plan(0, moment, &main.matrix(), None, true);
        self.work = self.lists.iter().fold(Work::default(), List::add);
        let behind = match &self.pipelines.palate {
            Some(_) => THROAT,
            None if self.is_lit => PALATE,
            None => DARK,
        };
        let [dark, behind] = [DARK, behind].map(|c| self.coded(c));
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = self.graphics.device.create_command_encoder(&descriptor);
        if self.looks.shadow > 0 {
            let mut pass = begin(&mut encoder, None, &self.shadows, dark);
            pass.set_pipeline(&self.pipelines.shadow);
            self.meshes(&mut pass, LISTS - 1, &[true, false]);
        }
        for (k, seen) in seen.iter().enumerate() {
            let Some(seen) = seen else { continue };
            let reflection = &self.reflections[k][seen.texture];
            let mut pass = begin(
                &mut encoder,
                Some((&reflection.picture, None)),
                &reflection.depth,
                behind,
            );
            let [w, h] = seen.used.map(|n| n as f32);
            pass.set_viewport(0.0, 0.0, w, h, 0.0, 1.0);
            pass.set_pipeline(&self.pipelines.reflected[usize::from(seen.pass.turns)]);
            self.meshes(&mut pass, 1 + k, &[true, false]);
            if let Some(pipeline) = &self.pipelines.palate {
                pass.set_pipeline(pipeline);
                pass.draw(0..palate::CORNERS, 0..1);
                self.work.draws += 1;
                self.work.triangles += palate::CORNERS as usize / 3;
            }
        }
        if let Some(targets) = &self.targets {
            let colour = match &targets.samples {
                Some(samples) => (samples, Some(target)),
                None => (target, None),
            };
            let mut pass = begin(&mut encoder, Some(colour), &targets.depth, dark);
            let meshes = &self.pipelines.meshes[usize::from(main.turns)];
            pass.set_pipeline(meshes);
            self.meshes(&mut pass, 0, &[true]);
            // Glass hides what lies behind, as tools do.
            let is_dull = drawing.fog > 0.0 || drawing.scratches > 0.0;
            pass.set_pipeline(&self.pipelines.glass[usize::from(is_dull)]);
            for (k, glass) in self.stage.glasses.iter().enumerate().take(GLASSES) {
                if glass.is_some() && moment.tools[k].held {
                    let texture = seen[k].as_ref().map_or(0, |seen| seen.texture);
                    pass.set_bind_group(0, &self.glass_groups[k][texture], &[offset(k)]);
                    pass.draw(0..FAN, 0..1);
                    self.work.draws += 1;
                    self.work.triangles += FAN as usize / 3;
                }
            }
            pass.set_pipeline(meshes);
            self.meshes(&mut pass, 0, &[false]);
        }
        if !panel.is_empty() {
            self.panel
                .draw(&self.graphics, &mut encoder, panel, target, size);
        }
        self.graphics.queue.submit([encoder.finish()]);
    }

    /// Number of the target for an amount of light.
    fn number(&self, light: f64) -> f64 {
        if self.is_coded {
            1.055 * light.powf(1.0 / 2.4) - 0.055
        } else {
            light
        }
    }

    /// Background in the numbers of the target.
    fn coded(&self, light: wgpu::Color) -> wgpu::Color {
        let [r, g, b] = [light.r, light.g, light.b].map(|light| self.number(light));
        wgpu::Color {
            r,
            g,
            b,
            a: light.a,
        }
    }

    /// Share of a reflection's numbers that clean glass shows, and the numbers of glass without a reflection.
    fn clean(&self, is_seen: bool) -> [f32; 4] {
        if is_seen {
            let share = if self.is_coded {
                REFLECTED.powf(1.0 / 2.2)
            } else {
                REFLECTED
            };
            return [share, 0.0, 0.0, 0.0];
        }
        let [r, g, b] = BLIND.map(|light| self.number(light) as f32);
        [0.0, r, g, b]
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
            let texels = |half: f64, pixels: u32| {
                (half * f64::from(pixels) / f64::from(self.looks.texel)).round() as u32
            };
            let [.., most] = REFLECTION;
            let used = [0, 1].map(|k| texels(window.half[k], size[k]).clamp(1, most));
            let edge = used[0].max(used[1]);
            Some(Seen {
                pass,
                window,
                texture: REFLECTION.iter().position(|size| edge <= *size)?,
                used,
            })
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
        let block =
            |camera: &PassCamera| PassBlock::new(camera, &drawing.lamp, &self.looks, self.is_coded);
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
            let share = |seen: &Seen| {
                seen.used
                    .map(|n| n as f32 / REFLECTION[seen.texture] as f32)
            };
            let [u, v] = seen.as_ref().map_or([0.0; 2], share);
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
                used: [u, v, f32::from(u8::from(self.is_coded)), 0.0],
                clean: self.clean(seen.is_some()),
            };
            glasses.put(k, &block);
        }
        let all = [
            (&self.passes, passes),
            (&self.parts, parts),
            (&self.glasses, glasses),
        ];
        for (buffer, blocks) in all
            .into_iter()
            .filter(|(_, blocks)| !blocks.bytes().is_empty())
        {
            queue.write_buffer(buffer, 0, blocks.bytes());
        }
    }

    /// Plans a pass with the list `number`.
    fn plan(
        &mut self,
        number: usize,
        moment: &Moment,
        clip: &Matrix,
        without: Option<usize>,
        is_needed: bool,
    ) {
        let alike = match (self.is_lit, self.looks.per_pixel) {
            (false, _) => Alike::Nothing,
            (true, true) => Alike::Material,
            // Light for each vertex takes the material from the vertex.
            (true, false) => Alike::Objects,
        };
        let pass = plan::Pass {
            moment,
            clip,
            without,
            alike,
        };
        let plan = if is_needed {
            plan::plan(&self.stage, &pass)
        } else {
            Plan::default()
        };
        self.lists[number].set(&self.graphics.queue, &self.stage, plan);
    }

    /// Draws the tools of a list (`true`) and its objects (`false`).
    fn meshes(&self, pass: &mut RenderPass<'_>, number: usize, kinds: &[bool]) {
        // The last list is that of the shadows: its own group has no shadow map.
        let (group, block) = if number == LISTS - 1 {
            (1, 0)
        } else {
            (0, number)
        };
        let list = &self.lists[number];
        pass.set_bind_group(0, &self.pass_groups[group], &[offset(block)]);
        pass.set_vertex_buffer(0, self.buffers.still.slice(..));
        pass.set_vertex_buffer(1, self.buffers.moving.slice(..));
        pass.set_index_buffer(list.corners.slice(..), wgpu::IndexFormat::Uint32);
        for draw in list
            .plan
            .draws
            .iter()
            .filter(|draw| kinds.contains(&draw.is_tool))
        {
            pass.set_bind_group(1, &self.part_group, &[offset(draw.part)]);
            pass.draw_indexed(draw.corners.clone(), 0, 0..1);
        }
    }
}
