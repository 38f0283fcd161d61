//! Choice of the adapter, and its device.

use std::sync::{Arc, Mutex, PoisonError};

use crate::error::ScreenError;

/// Interface of the graphics driver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// Best of all that the machine has.
    #[default]
    Any,
    /// Vulkan alone.
    Vulkan,
    /// OpenGL alone.
    Gl,
}

impl Backend {
    fn set(self) -> wgpu::Backends {
        match self {
            Self::Any => wgpu::Backends::all(),
            Self::Vulkan => wgpu::Backends::VULKAN,
            Self::Gl => wgpu::Backends::GL,
        }
    }
}

/// Device of an adapter.
#[derive(Clone)]
pub struct Graphics {
    pub(crate) adapter: wgpu::Adapter,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// First error that the driver reported.
    failed: Arc<Mutex<Option<String>>>,
}

impl Graphics {
    /// Device without a display.
    ///
    /// # Errors
    /// No adapter, or no device of it.
    pub fn headless(backend: Backend) -> Result<Self, ScreenError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = backend.set();
        Self::open(wgpu::Instance::new(descriptor), None)
    }

    /// Device for an instance; `surface` is the window that it must serve.
    pub(crate) fn open(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Self, ScreenError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter: false,
            compatible_surface: surface,
            apply_limit_buckets: false,
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|error| ScreenError::NoAdapter(error.to_string()))?;
        let limits = wgpu::Limits::downlevel_defaults().using_resolution(adapter.limits());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("screen"),
            required_limits: limits,
            ..Default::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
                ScreenError::NoDevice {
                    adapter: adapter.get_info().name,
                    why: error.to_string(),
                }
            })?;
        let failed = Arc::new(Mutex::new(None));
        let report = |failed: &Arc<Mutex<Option<String>>>, text: String| {
            let mut first = failed.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert(text);
        };
        let seen = failed.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            report(&seen, error.to_string());
        }));
        let seen = failed.clone();
        device.set_device_lost_callback(move |reason, text| {
            if !matches!(reason, wgpu::DeviceLostReason::Destroyed) {
                report(&seen, format!("device lost: {text}"));
            }
        });
        Ok(Self {
            adapter,
            device,
            queue,
            failed,
        })
    }

    /// Name of the adapter and of its driver, in one line.
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({}, {})", info.name, info.backend, info.driver_info)
    }

    /// Whether the processor itself draws.
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Largest edge of a picture, pixels: a square of this edge fits into a texture, and into the buffer that reads it.
    pub fn largest(&self) -> u32 {
        let limits = self.device.limits();
        let in_buffer = (limits.max_buffer_size / 4).isqrt();
        // Rows in a buffer are padded to whole blocks of pixels.
        let block = u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT / 4);
        let in_buffer = u32::try_from(in_buffer / block * block).unwrap_or(u32::MAX);
        limits.max_texture_dimension_2d.min(in_buffer)
    }

    /// Returns the first error that the driver has reported so far.
    ///
    /// # Errors
    /// The driver has failed; nothing more can be drawn.
    pub fn check(&self) -> Result<(), ScreenError> {
        let failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner);
        match failed.as_ref() {
            Some(text) => Err(ScreenError::Lost(text.clone())),
            None => Ok(()),
        }
    }
}
