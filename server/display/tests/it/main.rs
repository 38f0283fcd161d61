//! Tests of the display: nothing hidden is sent, and shapes follow the tissue.

mod common;
mod frames;
mod hidden;
mod shapes;
