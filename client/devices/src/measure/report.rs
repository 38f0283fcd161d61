//! Report of a measurement.

use serde::Serialize;

/// Figure with its spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Value {
    /// Median of the single values.
    pub value: f64,
    /// Standard deviation of the single values.
    pub spread: f64,
    /// Number of single values.
    pub count: usize,
}

impl Value {
    /// Figure of `all` single values; `None` without a value.
    pub fn of(all: &[f64]) -> Option<Self> {
        let value = quantile(all, 0.5)?;
        let count = all.len();
        let mean = all.iter().sum::<f64>() / count as f64;
        let square: f64 = all.iter().map(|x| (x - mean) * (x - mean)).sum();
        let spread = (square / count.saturating_sub(1).max(1) as f64).sqrt();
        Some(Self {
            value,
            spread,
            count,
        })
    }
}

/// Quantile `share` (0 to 1) of `all`; `None` without a value.
pub(super) fn quantile(all: &[f64], share: f64) -> Option<f64> {
    let mut sorted = all.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let at = share * last as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    Some(sorted[low] + (sorted[high] - sorted[low]) * (at - low as f64))
}

/// Result of a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome<T> {
    /// Measured.
    Measured(T),
    /// Not measured: the reason.
    NotMeasured(String),
}

impl<T> Outcome<T> {
    /// The result of a stage that did not begin.
    pub fn nothing() -> Self {
        Self::NotMeasured("the stage was left out".into())
    }

    /// The result, if there is one.
    pub fn measured(&self) -> Option<&T> {
        match self {
            Self::Measured(result) => Some(result),
            Self::NotMeasured(_) => None,
        }
    }
}

/// Rate and jitter of the device's thread, and noise of the pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RateFigures {
    /// Rate, Hz.
    pub rate_hz: f64,
    /// Interval between two periods, microseconds: median.
    pub interval_p50_us: f64,
    /// Interval that 99 % of the intervals do not exceed, microseconds.
    pub interval_p99_us: f64,
    /// Longest interval, microseconds.
    ///
    /// The loop reads one sample per millisecond. For a faster device, the whole delay between two read samples counts
    /// for one of the periods between them.
    pub interval_most_us: f64,
    /// Number of intervals.
    pub count: usize,
    /// Range of the position of the held handle at rest, along its worst axis, mm.
    pub noise_mm: f64,
}

/// Friction of the free handle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrictionFigures {
    /// Friction of all axes, N. Once the mass is known, the force that moved the handle by one step of the position
    /// does not count.
    pub friction_n: Value,
    /// Friction along each axis: right, up, towards the person, N.
    pub axes_n: [Value; 3],
    /// Force that holds the handle without friction, along each axis, N: gravity, springs, error of the zero.
    pub bias_n: [Value; 3],
}

/// Results of steps of the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepFigures {
    /// Time from the door's force to the motion, ms: onset of the motion by a fit.
    pub latency_ms: Value,
    /// Latency that 99 % of the steps do not exceed, ms.
    pub latency_p99_ms: f64,
    /// Time from the door's force to the first change of the pose beyond noise, ms. The handle needs a part of it to
    /// move by one step of the position.
    pub first_motion_ms: Value,
    /// Value of [`StepFigures::first_motion_ms`] that 99 % of the steps do not exceed, ms.
    pub first_motion_p99_ms: f64,
    /// Apparent mass of all axes, g.
    pub mass_g: Value,
    /// Apparent mass along each axis: right, up, towards the person, g.
    pub axes_g: [Value; 3],
    /// Drag of the free handle, N s/m.
    pub drag_n_s_per_m: Value,
}

/// Largest stable stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StiffnessFigures {
    /// Last stable stiffness, N/mm.
    pub stable_n_per_mm: f64,
    /// First unstable stiffness, N/mm; absent if the ramp reached its end.
    pub unstable_n_per_mm: Option<f64>,
    /// Force above 20 Hz at the last stable stiffness, root mean square, N.
    pub rms_n: f64,
    /// Number of stable values of the ramp.
    pub count: usize,
}

/// Reading of the scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ScalePoint {
    /// Force asked for, downwards, N.
    pub asked_n: f64,
    /// Force on the scale less that at zero, N.
    pub found_n: f64,
    /// Difference of both, N.
    pub error_n: f64,
}

/// Report of the measurement of one device.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Name of the model.
    pub name: String,
    /// Library that drives the device.
    pub library: String,
    /// Serial number.
    pub serial: String,
    /// Rate and jitter.
    pub rate: Outcome<RateFigures>,
    /// Smallest step of the position, mm.
    pub resolution_mm: Outcome<Value>,
    /// Friction.
    pub friction: Outcome<FrictionFigures>,
    /// Latency, mass and drag.
    pub steps: Outcome<StepFigures>,
    /// Largest stable stiffness in a light grip. The loop of the measurement adds up to one period of 1 ms.
    pub light_grip: Outcome<StiffnessFigures>,
    /// Largest stable stiffness in a firm grip.
    pub firm_grip: Outcome<StiffnessFigures>,
    /// Static force on a scale.
    pub scale: Outcome<Vec<ScalePoint>>,
}
