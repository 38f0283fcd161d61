//! Surface of a window.

use std::sync::Arc;

use wgpu::{
    CurrentSurfaceTexture, PresentMode, Surface, SurfaceConfiguration, SurfaceTexture,
    TextureFormat,
};

use super::adapter::Graphics;
use super::draw::Renderer;
use super::drawing::{Drawing, Mode};
use super::targets::view;
use crate::error::ScreenError;
use crate::moment::Moment;
use crate::panel::Primitive;
use crate::quality::Quality;
use crate::stage::Stage;

/// Surface of a window with the drawer of its pictures.
pub struct Screen {
    graphics: Graphics,
    surface: Surface<'static>,
    config: SurfaceConfiguration,
    /// Format that takes sRGB numbers, and one that takes light.
    formats: [TextureFormat; 2],
    renderer: Option<(Renderer, Quality)>,
}

/// Whether a format has eight bits for each of four channels.
fn eight_bits(format: TextureFormat) -> bool {
    matches!(
        format.remove_srgb_suffix(),
        TextureFormat::Rgba8Unorm | TextureFormat::Bgra8Unorm
    )
}

/// Texture of the surface that takes the next picture.
pub struct Target(SurfaceTexture);

impl Screen {
    /// Surface of a window of `size` pixels.
    ///
    /// # Errors
    /// No adapter draws on this window.
    pub fn open(
        display: Box<dyn wgpu::wgt::WgpuHasDisplayHandle>,
        window: Arc<impl wgpu::DisplayAndWindowHandle + 'static>,
        size: [u32; 2],
    ) -> Result<Self, ScreenError> {
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle(display);
        let instance = wgpu::Instance::new(descriptor);
        let surface = instance
            .create_surface(window)
            .map_err(|error| ScreenError::NoDisplay(error.to_string()))?;
        let graphics = Graphics::open(instance, Some(&surface))?;
        let [width, height] = size.map(|n| n.max(16));
        let mut config = surface
            .get_default_config(&graphics.adapter, width, height)
            .ok_or_else(|| {
                ScreenError::NoDisplay("the adapter does not serve the window".into())
            })?;
        let offered = surface.get_capabilities(&graphics.adapter);
        let format = |wanted: bool| {
            let mut all = offered.formats.iter().copied();
            all.find(|format| eight_bits(*format) && format.is_srgb() == wanted)
                .unwrap_or(config.format)
        };
        let formats = [format(false), format(true)];
        config.present_mode = if offered.present_modes.contains(&PresentMode::Mailbox) {
            PresentMode::Mailbox
        } else {
            PresentMode::Fifo
        };
        // A queue of pictures would delay the hand's picture.
        config.desired_maximum_frame_latency = 1;
        surface.configure(&graphics.device, &config);
        Ok(Self {
            graphics,
            surface,
            config,
            formats,
            renderer: None,
        })
    }

    /// Device.
    pub fn graphics(&self) -> &Graphics {
        &self.graphics
    }

    /// Size, pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Takes a new size. A window that is minimised has size 0, which changes nothing.
    pub fn resize(&mut self, size: [u32; 2]) {
        let most = self.graphics.largest();
        if size.iter().all(|n| *n > 0) {
            [self.config.width, self.config.height] = size.map(|n| n.clamp(16, most));
            self.surface.configure(&self.graphics.device, &self.config);
        }
    }

    /// Whether pictures of this level can be drawn at once.
    pub fn is_ready(&self, level: Quality) -> bool {
        self.renderer
            .as_ref()
            .is_some_and(|(_, ready)| *ready == level)
    }

    /// Takes a stage, for pictures of a level.
    pub fn prepare(&mut self, stage: Stage, level: Quality) {
        match &mut self.renderer {
            Some((renderer, ready)) if *ready == level => renderer.replace(stage),
            renderer => {
                // A software adapter pays for coding light as sRGB. Cheap levels do this for each vertex.
                let format = self.formats[usize::from(level.looks().per_pixel)];
                if self.config.format != format {
                    self.config.format = format;
                    self.surface.configure(&self.graphics.device, &self.config);
                }
                let graphics = self.graphics.clone();
                let made = Renderer::with_format(graphics, stage, level, Mode::Beauty, format);
                *renderer = Some((made, level));
            }
        }
    }

    /// Texture for the next picture; `None` if the window shows none now.
    ///
    /// # Errors
    /// The surface is lost.
    pub fn acquire(&mut self) -> Result<Option<Target>, ScreenError> {
        match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture)
            | CurrentSurfaceTexture::Suboptimal(texture) => Ok(Some(Target(texture))),
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => Ok(None),
            CurrentSurfaceTexture::Outdated => {
                self.surface.configure(&self.graphics.device, &self.config);
                Ok(None)
            }
            CurrentSurfaceTexture::Lost | CurrentSurfaceTexture::Validation => Err(
                ScreenError::Lost("the surface of the window is lost".into()),
            ),
        }
    }

    /// Draws an instant with a panel. Without a stage nothing is drawn.
    pub fn draw(
        &mut self,
        drawing: &Drawing,
        moment: &Moment,
        panel: &[Primitive],
        target: &Target,
    ) {
        let size = self.size();
        if let Some((renderer, _)) = &mut self.renderer {
            renderer.draw(drawing, moment, panel, &view(&target.0.texture), size);
        }
    }

    /// Shows the picture.
    pub fn present(&self, target: Target) {
        self.graphics.queue.present(target.0);
    }
}
