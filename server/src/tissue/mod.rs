//! Tissue models against finite elements: what is judged, how, and what is fitted.

#[cfg_attr(
    not(test),
    expect(dead_code, reason = "the command `report` is not wired to it yet")
)]
pub(crate) mod against_fem;
pub(crate) mod cases;
pub(crate) mod fit;
pub(crate) mod judge;
pub(crate) mod loaded;
pub(crate) mod loads;
pub(crate) mod organ;
pub(crate) mod printed;
mod pushed;
