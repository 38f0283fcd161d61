//! Heat of the motors: a model from the force, as the vendors' drivers have it.

/// Heat of a device's motors.
#[derive(Default)]
pub struct Heat {
    /// Heat in s, from 0 to the budget.
    pub value: f64,
    /// True from the full budget until the heat fell to half of it.
    pub warm: bool,
}

impl Heat {
    /// Heat after `dt` s at `force` N. Returns true when the motors got too warm or cool again.
    pub fn step(&mut self, force: f64, continuous: f64, budget: f64, dt: f64) -> bool {
        let load = force / continuous.max(1e-9);
        self.value = (self.value + dt * (load * load - 1.0)).clamp(0.0, budget);
        let before = self.warm;
        if self.value >= budget {
            self.warm = true;
        } else if self.value <= budget / 2.0 {
            self.warm = false;
        }
        self.warm != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_the_continuous_force_fills_the_budget_in_a_third_of_its_time() {
        let mut heat = Heat::default();
        let steps = (0..100_000)
            .take_while(|_| !heat.step(2.0, 1.0, 3.0, 1e-3) || !heat.warm)
            .count();
        assert!((990..1010).contains(&steps), "{steps} ms");
        let cool = (0..100_000)
            .take_while(|_| !heat.step(0.0, 1.0, 3.0, 1e-3))
            .count();
        assert!((1490..1510).contains(&cool), "{cool} ms");
    }
}
