//! Upper limit of the coupling stiffness that a haptic device can display.
//!
//! A spring computed once a period and displayed with delay returns more energy than it took, and the hand feels a
//! buzz. The device's own damping dissipates that energy while `K < b / (T/2 + t_d)`:
//! - `b`: damping of the device,
//! - `T`: period of the loop,
//! - `t_d`: delay of the loop.
//!
//! Without delay this is the bound of Colgate and Schenkel (J. Robotic Systems 14:37, 1997). With delay it is the
//! small-gain form in Hulin et al. (IEEE TCST 22:1, 2014). Translation and rotation are checked separately.
//!
//! Measured in a pocket of 3 mm at 1 kHz: 2 and 5 N/mm are quiet. The stiffness of 10 N/mm buzzes by 0.14 N, that of 20
//! N/mm by 0.21 N.

use std::fmt;

use crate::{Scene, Tool};

/// Damping of the haptic device in translation, N s/m: that of the simulated device.
///
/// Largest dampings in CHAI3D, N s/m, at 1 kHz for the Touch:
/// - Touch 4, Premium 5, Inverse3 6,
/// - devices with parallel arms 20 to 30.
pub const DEVICE_DAMPING: f64 = 4.0;

/// Damping of the haptic device in rotation, N m s/rad: that of the simulated device.
///
/// Largest dampings in CHAI3D, N m s/rad: 0.004 for a Premium 6DOF and 0.07 for a sigma.7.
pub const DEVICE_SPIN_DAMPING: f64 = 0.01;

/// Delay of the loop that the check of a scene assumes, seconds: a datagram to the station and back over a wired link.
///
/// Source: median of 0.18 ms measured with quinn, both ends on one machine.
pub const LINK_DELAY: f64 = 2e-4;

/// Returns the stiffness limit, N/m or N m/rad, of a coupling computed every `period` seconds and displayed `delay`
/// seconds later. `damping` is that of the device, N s/m or N m s/rad. At or above the limit the device cannot display
/// the coupling.
pub fn limit(damping: f64, period: f64, delay: f64) -> f64 {
    damping / (0.5 * period + delay)
}

/// Coupling of a tool, in translation or rotation, that is too stiff for a haptic device.
#[derive(Clone, Debug, PartialEq)]
pub struct TooStiff {
    /// Name of the tool.
    pub tool: String,
    /// Whether the coupling is that in rotation; otherwise in translation.
    pub turns: bool,
    /// Stiffness found, N/m or N m/rad.
    pub found: f64,
    /// Limit that the stiffness must stay under, in the same unit.
    pub limit: f64,
    /// Period of the loop, seconds.
    pub period: f64,
}

impl fmt::Display for TooStiff {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (key, factor, unit, damping, of_damping) = if self.turns {
            let damping = DEVICE_SPIN_DAMPING;
            (
                "stiffness_nmm_per_rad",
                1e3,
                "N mm/rad",
                damping,
                "N m s/rad",
            )
        } else {
            ("stiffness_n_per_mm", 1e-3, "N/mm", DEVICE_DAMPING, "N s/m")
        };
        write!(
            f,
            "`{key}` of tool `{}` is {} {unit}, expected under {} {unit}: a device cannot display a stiffer coupling, \
             by K < b / (T/2 + t_d) with device damping b = {damping} {of_damping}, period T = {} ms and delay t_d = {} ms",
            self.tool,
            Short(self.found * factor),
            Short(self.limit * factor),
            Short(self.period * 1e3),
            Short(LINK_DELAY * 1e3),
        )
    }
}

/// Positive number, displayed with three significant digits, or with three decimals below 1.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = match self.0 {
            x if x >= 100.0 => 0,
            x if x >= 10.0 => 1,
            x if x >= 1.0 => 2,
            _ => 3,
        };
        let text = format!("{:.digits$}", self.0);
        if digits == 0 {
            return f.write_str(&text);
        }
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// Returns the couplings of a scene that are too stiff at the scene's rate and [`LINK_DELAY`]. The order is that of the
/// tools.
pub fn too_stiff(scene: &Scene) -> Vec<TooStiff> {
    let tools = scene.tools.iter();
    tools.flat_map(|tool| of(tool, scene.tick_s())).collect()
}

/// Returns the couplings of one tool, translation first, that are too stiff for a loop of `period` (seconds).
fn of(tool: &Tool, period: f64) -> Vec<TooStiff> {
    let couplings = [
        (false, tool.stiffness_n_per_m, DEVICE_DAMPING),
        (true, tool.stiffness_nm_per_rad, DEVICE_SPIN_DAMPING),
    ];
    let mut all = Vec::new();
    for (turns, found, damping) in couplings {
        let limit = limit(damping, period, LINK_DELAY);
        if found >= limit {
            all.push(TooStiff {
                tool: tool.name.clone(),
                turns,
                found,
                limit,
                period,
            });
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::tick::tests::rod_tool;

    fn with(stiffness: f64, turning: f64, rate_hz: f64) -> Vec<TooStiff> {
        let tool = Tool {
            name: "probe".into(),
            stiffness_n_per_m: stiffness,
            stiffness_nm_per_rad: turning,
            ..rod_tool(Vec3::zeros())
        };
        of(&tool, 1.0 / rate_hz)
    }

    #[test]
    fn the_limit_follows_from_damping_period_and_delay() {
        assert_eq!(limit(4.0, 1e-3, LINK_DELAY), 4.0 / 7e-4);
        // A networked loop of 3 ms needs 1.75 N s/m for 500 N/m.
        assert_eq!(limit(1.75, 1e-3, 3e-3), 500.0);
        assert_eq!(limit(4.0, 1e-3, 0.0), 8000.0);
        for (stiffness, rate_hz, is_too_stiff) in [
            (500.0, 250.0, false),
            (2_000.0, 1e3, false),
            (5_000.0, 1e3, false),
            (5_800.0, 1e3, true),
            (10_000.0, 1e3, true),
            (20_000.0, 1e3, true),
            (10_000.0, 4e3, false),
            (5_000.0, 250.0, true),
        ] {
            let found = with(stiffness, 0.5, rate_hz);
            assert_eq!(!found.is_empty(), is_too_stiff, "{stiffness} {rate_hz}");
        }
        assert_eq!(with(500.0, 3.0, 1e3), []);
    }

    #[test]
    fn the_message_has_every_number() {
        let said = with(10_000.0, 20.0, 1e3);
        let said: Vec<String> = said.iter().map(TooStiff::to_string).collect();
        assert_eq!(
            said,
            [
                "`stiffness_n_per_mm` of tool `probe` is 10 N/mm, expected under 5.71 N/mm: a device cannot display a stiffer coupling, by K < b / (T/2 + t_d) with device damping b = 4 N s/m, period T = 1 ms and delay t_d = 0.2 ms",
                "`stiffness_nmm_per_rad` of tool `probe` is 20000 N mm/rad, expected under 14286 N mm/rad: a device cannot display a stiffer coupling, by K < b / (T/2 + t_d) with device damping b = 0.01 N m s/rad, period T = 1 ms and delay t_d = 0.2 ms",
            ]
        );
    }
}
