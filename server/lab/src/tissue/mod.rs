//! Tissue models against finite elements: what is judged, how, and what is fitted.

pub(crate) mod against_fem;
pub(crate) mod cases;
pub(crate) mod fit;
pub(crate) mod judge;
pub(crate) mod loaded;
pub(crate) mod loads;
pub(crate) mod organ;
pub(crate) mod printed;
mod pushed;
