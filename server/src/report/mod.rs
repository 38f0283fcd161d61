//! What this program measures of itself.

pub(crate) mod paper;
