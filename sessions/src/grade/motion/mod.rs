//! Motion of a hand as signals: filter, spectrum, smoothness, and the measures made of them.

pub(crate) mod fft;
pub(crate) mod lowpass;
pub(crate) mod moves;
pub(crate) mod series;
pub(crate) mod sparc;
