//! Thin main over the library.

fn main() {}
