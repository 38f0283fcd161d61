//! Pictures by a graphics adapter, judged by rays, pixels and stored files. Without an adapter these tests are skipped.
#![cfg(feature = "gpu")]

mod bands;
mod beauty;
mod blood;
mod caster;
mod common;
mod errors;
mod identity;
mod mirror;
mod moving;
mod scene;
mod shapes;
mod stored;
mod threads;
