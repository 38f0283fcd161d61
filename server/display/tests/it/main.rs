//! Tests of the display: nothing hidden is sent, and shapes follow the tissue.

mod common;
mod frames;
mod glass;
mod hidden;
mod seen;
mod shapes;
mod teeth;
mod tools;
