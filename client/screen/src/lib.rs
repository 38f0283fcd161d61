//! The student's screen: pictures of a session, in a window or in memory.
//!
//! [`Stage`](stage::Stage) holds the meshes of a display scene, [`Moment`](moment::Moment) everything that moves at an
//! instant, [`Camera`](camera::Camera) the view. [`gpu`] draws them by a graphics adapter, hardware or software.
//!
//! Lengths are millimetres, world axes: x anterior, y to the patient's left, z up.

mod blood;
pub mod camera;
mod coarse;
pub mod error;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod lamp;
pub mod material;
pub mod mirror;
pub mod moment;
mod motion;
mod normals;
mod occlusion;
pub mod quality;
pub mod stage;
pub mod views;
