//! Sound of contact: which touch is heard, and its samples. No module of this folder plays a sound.
//!
//! A touch is heard when a tool that touched nothing meets an object. Its loudness follows the speed before the touch.

mod ear;
mod ears;
mod strike;
mod surface;

pub use ears::Ears;
pub use strike::RATE;
