//! What a display receives: nothing hidden, and shapes that follow the tissue.

mod common;
mod frames;
mod hidden;
mod shapes;
