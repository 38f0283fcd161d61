//! The student's screen: pictures of a session, in a window or in memory.
//!
//! - [`stage::Stage`] holds the meshes of a display scene, [`moment::Moment`] everything that moves at an instant,
//!   [`camera::Camera`] the view. The module `gpu` draws them by a graphics adapter, hardware or software.
//! - [`first`] finds the steps of a first lesson.
//! - [`panel`] lays out gauges and texts, [`readings`] takes findings by keys and pedals, [`trainer`] is a lesson in
//!   reading the bands of a probe. [`hand`] moves the tools without a force device. These modules draw nothing and know
//!   no window.
//!
//! Lengths are millimetres, world axes: x anterior, y to the patient's left, z up.

mod ball;
mod blood;
pub mod camera;
pub mod depth;
pub mod error;
pub mod eye;
pub mod first;
#[cfg(feature = "window")]
pub mod ghost;
#[cfg(all(feature = "window", target_os = "linux"))]
mod gone;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod hand;
pub mod handed;
pub mod head;
#[cfg(feature = "window")]
mod input;
pub mod lamp;
pub mod material;
pub mod mirror;
pub mod moment;
mod motion;
mod normals;
mod occlusion;
mod order;
pub mod panel;
mod plan;
pub mod pointer;
pub mod quality;
pub mod readings;
pub mod show;
pub mod sound;
pub mod stage;
pub mod strings;
pub mod text;
mod thinned;
pub mod times;
pub mod trainer;
pub mod views;
#[cfg(feature = "window")]
pub mod window;
