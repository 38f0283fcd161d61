//! Motion of a tool as signals: low-pass filter, spectrum, smoothness of free moves, series for plots.

pub(crate) mod fft;
pub(crate) mod lowpass;
pub(crate) mod moves;
pub(crate) mod series;
pub(crate) mod sparc;
