//! Drawing by a graphics adapter, hardware or software. Only this folder names `wgpu`.

mod adapter;
mod buffers;
mod draw;
mod drawing;
mod palate;
mod panel;
mod pass;
mod pipelines;
mod read_back;
mod surface;
mod targets;
mod uniforms;

pub use adapter::{Backend, Graphics};
pub use draw::Renderer;
pub use drawing::{Drawing, Mode, Work};
pub use read_back::Image;
pub use surface::{Screen, Target};
