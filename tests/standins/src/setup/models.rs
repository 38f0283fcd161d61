//! Device models. The numbers follow the table of section 6 of the device notes; its secondary figures are guesses.

use super::{CalibrationSetup, DeviceSetup, Hand};
use crate::board::{Family, Traits};
use crate::pose::Pose;

/// A cuboid about the origin with these edges in m: least, then largest coordinates.
fn cuboid(x: f64, y: f64, z: f64) -> [f64; 6] {
    [-x / 2.0, -y / 2.0, -z / 2.0, x / 2.0, y / 2.0, z / 2.0]
}

fn traits() -> Traits {
    Traits {
        reach: cuboid(0.43, 0.35, 0.17),
        workspace: cuboid(0.16, 0.12, 0.07),
        tabletop: 0.11,
        input_dof: 6.0,
        output_dof: 3.0,
        max_force: 3.3,
        continuous_force: 0.88,
        max_torque: 0.0,
        continuous_torque: 0.0,
        max_stiffness: 500.0,
        max_damping: 3.0,
        ramp: 10.0,
        speed_limit: 5.0,
        calibration_style: 2.0,
        shear: 1e-3,
        system_type: 0.0,
        left: 0.0,
        wrist: 1.0,
        active_wrist: 0.0,
        gripper: 0.0,
        active_gripper: 0.0,
        time_guard: 250.0,
        auto_init: 100.0,
        strict: 0.0,
    }
}

fn device(family: Family, name: &str, model: &str, serial: &str, traits: Traits) -> DeviceSetup {
    DeviceSetup {
        family,
        name: name.into(),
        model: model.into(),
        serial: serial.into(),
        vendor: if family == Family::Hd {
            "3D Systems"
        } else {
            "Force Dimension"
        }
        .into(),
        firmware: "192".into(),
        driver_version: "2024.9.19".into(),
        traits,
        watchdog_ms: 20.0,
        latency_us: 0.0,
        step: 55e-6,
        angle_step: 1e-3,
        damping: 0.5,
        friction: 0.26,
        mass: 0.045,
        weight: 0.0,
        brake: 20.0,
        heat_budget: 60.0,
        speed_trip: 0.0,
        calibration: CalibrationSetup::default(),
        lit: true,
        open_error: 0,
        hand: Hand::rest(Pose::default()),
    }
}

impl DeviceSetup {
    /// A Touch: six sensed degrees of freedom, three with force.
    pub fn touch(name: &str, serial: &str) -> Self {
        device(Family::Hd, name, "Touch", serial, traits())
    }

    /// A Touch X.
    pub fn touch_x(name: &str, serial: &str) -> Self {
        let traits = Traits {
            reach: cuboid(0.355, 0.228, 0.18),
            workspace: cuboid(0.16, 0.12, 0.12),
            max_force: 7.9,
            continuous_force: 1.75,
            max_stiffness: 1860.0,
            max_damping: 5.0,
            ..traits()
        };
        Self {
            step: 23e-6,
            friction: 0.06,
            ..device(Family::Hd, name, "Touch X", serial, traits)
        }
    }

    /// A Premium 1.5 with torque.
    pub fn premium(name: &str, serial: &str) -> Self {
        let traits = Traits {
            reach: cuboid(0.45, 0.35, 0.25),
            workspace: cuboid(0.381, 0.267, 0.191),
            output_dof: 6.0,
            max_force: 8.5,
            continuous_force: 1.4,
            max_torque: 0.188,
            continuous_torque: 0.048,
            max_stiffness: 3500.0,
            calibration_style: 1.0,
            active_wrist: 1.0,
            ..traits()
        };
        Self {
            step: 30e-6,
            friction: 0.04,
            mass: 0.09,
            ..device(Family::Hd, name, "Premium 6DOF 1.5", serial, traits)
        }
    }

    /// An omega.6 with a passive wrist.
    pub fn omega6(serial: u16) -> Self {
        let traits = Traits {
            reach: cuboid(0.18, 0.18, 0.13),
            workspace: cuboid(0.16, 0.16, 0.11),
            max_force: 12.0,
            continuous_force: 12.0,
            max_stiffness: 14_500.0,
            system_type: 34.0,
            shear: 0.0,
            ..traits()
        };
        Self {
            step: 10e-6,
            friction: 0.05,
            mass: 0.2,
            weight: 0.2,
            ..device(
                Family::Dhd,
                "omega.6",
                "omega.6",
                &serial.to_string(),
                traits,
            )
        }
    }

    /// A sigma.7 with an active wrist and gripper.
    pub fn sigma7(serial: u16) -> Self {
        let traits = Traits {
            reach: cuboid(0.21, 0.21, 0.15),
            workspace: cuboid(0.19, 0.19, 0.13),
            input_dof: 7.0,
            output_dof: 7.0,
            max_force: 20.0,
            continuous_force: 20.0,
            max_torque: 0.4,
            continuous_torque: 0.4,
            max_stiffness: 4000.0,
            system_type: 104.0,
            active_wrist: 1.0,
            gripper: 1.0,
            active_gripper: 1.0,
            shear: 0.0,
            ..traits()
        };
        Self {
            step: 1.5e-6,
            friction: 0.05,
            mass: 0.3,
            weight: 0.3,
            ..device(
                Family::Dhd,
                "sigma.7",
                "sigma.7",
                &serial.to_string(),
                traits,
            )
        }
    }

    /// A Novint Falcon through the Force Dimension library: three degrees of freedom.
    pub fn falcon(serial: u16) -> Self {
        let traits = Traits {
            reach: cuboid(0.11, 0.11, 0.11),
            workspace: cuboid(0.102, 0.102, 0.102),
            input_dof: 3.0,
            max_force: 8.9,
            continuous_force: 8.9,
            max_stiffness: 3000.0,
            system_type: 60.0,
            wrist: 0.0,
            shear: 0.0,
            ..traits()
        };
        Self {
            step: 60e-6,
            friction: 0.1,
            mass: 0.15,
            weight: 0.15,
            ..device(Family::Dhd, "Falcon", "Falcon", &serial.to_string(), traits)
        }
    }
}
