//! Plan of a measurement: what is measured, and the limits of every force.

use serde::Serialize;
use sulcus_core::math::fmin;
use sulcus_core::{Params, Pose, Quat, Vec3};
use sulcus_haptics::continuous::{ContinuousLimit, MOTOR_TIME_S};
use sulcus_haptics::device::HandInfo;
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::{DeviceModel, DoorRules, Guard, Limits, Mapping, PassivityParams, SlewLimits};

/// Largest force outside of the stage with the scale, newtons.
pub const MOST_N: f64 = 1.0;
/// Largest force of the stage with the scale, newtons.
pub const MOST_SCALE_N: f64 = 2.0;
/// Period of the loop that calls `Measurement::step`, nanoseconds.
pub const LOOP_NS: u64 = 1_000_000;

/// Stage of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Rate and jitter of the device's thread, and noise of the pose at rest.
    Rate,
    /// Smallest step of the position.
    Resolution,
    /// Friction of the free handle.
    Friction,
    /// Latency, apparent mass and drag, from steps of the force.
    Steps,
    /// Largest stable stiffness in a light grip.
    LightGrip,
    /// Largest stable stiffness in a firm grip.
    FirmGrip,
    /// Static force on a scale.
    Scale,
}

impl Part {
    /// All stages in their order. Later stages use the results of earlier ones.
    pub const ALL: [Self; 7] = [
        Self::Rate,
        Self::Resolution,
        Self::Friction,
        Self::Steps,
        Self::LightGrip,
        Self::FirmGrip,
        Self::Scale,
    ];

    /// Name for display.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rate => "rate and noise",
            Self::Resolution => "resolution",
            Self::Friction => "friction",
            Self::Steps => "latency and mass",
            Self::LightGrip => "stiffness, light grip",
            Self::FirmGrip => "stiffness, firm grip",
            Self::Scale => "force on a scale",
        }
    }
}

/// Plan of the measurement of one device.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Model of the device before the measurement.
    pub model: DeviceModel,
    /// Serial number of the device.
    pub serial: String,
    /// Period of the device's thread, nanoseconds.
    pub period_ns: u64,
    /// Force at which the device may stay, newtons: the smaller value of model and driver.
    pub continuous_n: f64,
    /// Stages, in the order of [`Part::ALL`].
    pub parts: Vec<Part>,
    /// Number of places at which the friction of each axis is measured, at least 1.
    pub places: usize,
    /// Number of steps of the force, at least 10.
    pub steps: usize,
    /// Stiffness at which the ramp ends, N/m.
    pub most_stiffness: f64,
}

impl Plan {
    /// Plan of all stages for the device of `info` with the model `model`.
    pub fn new(info: &HandInfo, model: &DeviceModel) -> Self {
        let reported = info.reported.continuous_n.unwrap_or(f64::INFINITY);
        Self {
            model: model.clone(),
            serial: info.serial.clone(),
            period_ns: info.period_ns,
            continuous_n: fmin(model.continuous_force_n.value, reported),
            parts: Part::ALL.to_vec(),
            places: 3,
            steps: 24,
            // Twice the model's figure: a figure of a data sheet may be too low, and a ramp must end.
            most_stiffness: 2e3 * model.stiffness_n_per_mm.value,
        }
    }

    /// Largest force outside of the stage with the scale, newtons.
    pub fn most_n(&self) -> f64 {
        fmin(MOST_N, self.continuous_n)
    }

    /// Forces of the stage with the scale, newtons, rising.
    pub fn scale_n(&self) -> Vec<f64> {
        let most = fmin(MOST_SCALE_N, self.continuous_n);
        let mut forces: Vec<f64> = [0.5, 1.0, 2.0].iter().map(|&n| fmin(n, most)).collect();
        forces.dedup();
        forces
    }

    /// Change of the force that the door lets pass, newtons per second.
    pub fn slew_n_per_s(&self) -> f64 {
        Params::default().max_force_step * 1e3
    }

    /// Rules of the door for a measurement. World axes are base axes, and the tool is the handle. The passivity
    /// controller only observes: its damping would count as the device's.
    pub fn rules(&self) -> DoorRules {
        let limits = Limits {
            force_n: fmin(MOST_SCALE_N, self.continuous_n),
            torque_nm: 0.0,
        };
        let passivity = PassivityParams {
            period_s: self.period_ns as f64 * 1e-9,
            ..PassivityParams::observing()
        };
        let force = ContinuousLimit {
            lasting: self.continuous_n,
            peak: self.continuous_n,
            time_s: MOTOR_TIME_S,
        };
        let guard = Guard {
            mapping: Mapping {
                world_from_base: Quat::identity(),
                origin: Vec3::zeros(),
                scale: 1.0,
                gimbal_from_tool: Pose::identity(),
            },
            has_torque: false,
            silence: Silence::DEVICE,
            blend_ns: 0,
            force,
            torque: self.model.torque_limit(),
            clutch: 0,
        };
        DoorRules::guarded(
            limits,
            SlewLimits::from(&Params::default()),
            passivity,
            guard,
        )
    }
}
