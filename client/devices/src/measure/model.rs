//! Model file of a measured device.

use sulcus_haptics::DeviceModel;
use sulcus_haptics::model::{Figure, ModelError, Source};

use super::report::{Measured, StiffnessFigures};

impl Measured {
    /// Returns `before` with all measured figures in place of its own, and with the serial number of the device.
    /// Figures without a measurement stay.
    ///
    /// # Errors
    /// A measured figure is out of the range of a model: field, value, range. A device of 300 Hz is an example.
    pub fn model(&self, before: &DeviceModel) -> Result<DeviceModel, ModelError> {
        let mut model = before.clone();
        model.serial.clone_from(&self.serial);
        if let Some(rate) = self.rate.measured() {
            model.rate_hz = figure(rounded(rate.rate_hz), format!("{} intervals", rate.count));
        }
        if let Some(step) = self.resolution_mm.measured() {
            let text = format!("smallest of {} steps in slow motion", step.count);
            model.resolution_mm = figure(rounded(step.value), text);
        }
        if let Some(friction) = self.friction.measured() {
            let of = friction.friction_n;
            let text = format!(
                "ramps of 0.05 N/s, {} times, spread {:.3} N",
                of.count, of.spread
            );
            model.friction_n = figure(rounded(of.value), text);
        }
        if let Some(steps) = self.steps.measured() {
            let (late, mass) = (steps.latency_ms, steps.mass_g);
            let text = format!(
                "onset of the motion after {} steps of the force, spread {:.2} ms",
                late.count, late.spread
            );
            model.latency_ms = figure(rounded(late.value.max(0.0)), text);
            let text = format!(
                "motion after {} steps of the force, spread {:.1} g",
                mass.count, mass.spread
            );
            model.mass_g = figure(rounded(mass.value), text);
        }
        if let Some((least, grips)) = self.stiffness() {
            let text = format!("virtual floor at 1 kHz, last stable value, {grips}");
            model.stiffness_n_per_mm = figure(rounded(least), text);
        }
        model.validate()?;
        Ok(model)
    }

    /// Least stable stiffness of all grips, N/mm, with the names of the grips.
    fn stiffness(&self) -> Option<(f64, &'static str)> {
        let of = |figures: &StiffnessFigures| figures.stable_n_per_mm;
        match (
            self.light_grip.measured().map(of),
            self.firm_grip.measured().map(of),
        ) {
            (Some(light), Some(firm)) => Some((light.min(firm), "light and firm grip")),
            (Some(light), None) => Some((light, "light grip")),
            (None, Some(firm)) => Some((firm, "firm grip")),
            (None, None) => None,
        }
    }
}

fn figure(value: f64, from: String) -> Figure {
    Figure {
        value,
        source: Source::Measured,
        from,
    }
}

/// `x` with four digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}
