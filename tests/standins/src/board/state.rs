//! What a device box shows to its driver, and the properties of its model.

use super::Words;
use serde::{Deserialize, Serialize};

/// Family of a device: the vendor's library that drives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Family {
    /// OpenHaptics HDAPI.
    Hd,
    /// Force Dimension SDK.
    Dhd,
}

/// State of a device's calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Calibration {
    /// Positions are right.
    Ok,
    /// The driver must update the calibration: HD 0x5001.
    NeedsUpdate,
    /// The user must act first: HD 0x5002.
    NeedsManualInput,
}

/// Mode of a Force Dimension controller. An HD device stays in `Force`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Not calibrated since power-on.
    Reset,
    /// Calibrated, motors off.
    Idle,
    /// Motors follow the commands.
    Force,
    /// Motors short-circuited: electromagnetic viscosity.
    Brake,
}

/// Why a Force Dimension controller took the force off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OffCause {
    /// The force is not off.
    None,
    /// The user pressed the FORCE button.
    Button,
    /// The handle was too fast.
    Velocity,
    /// No command came in time.
    Watchdog,
    /// A call of the driver took the force off.
    Software,
    /// The connection to the host was lost.
    UsbLost,
    /// The dead man's switch opened.
    DeadMan,
}

/// State of one device box, as its driver reads it. Unit m, m/s, rad, N, N m.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Time of the state, monotonic clock, ns.
    pub stamp: u64,
    /// Measured position after quantisation in m.
    pub position: [f64; 3],
    /// Measured rotation, rows first.
    pub rotation: [[f64; 3]; 3],
    /// Velocity over a window of 20 ms in m/s.
    pub velocity: [f64; 3],
    /// Angular velocity in rad/s.
    pub angular: [f64; 3],
    /// Joint angles of the arm in rad, of a simple model.
    pub joints: [f64; 3],
    /// Angles of the gimbal or wrist joints in rad.
    pub gimbal: [f64; 3],
    /// Encoder counts: three of the arm, three of the gimbal.
    pub encoders: [i64; 6],
    /// Buttons, one bit each.
    pub buttons: u64,
    /// 1 while the stylus is in its well.
    pub inkwell: u64,
    /// 0 calibrated, 1 needs an update, 2 needs manual input.
    pub calibration: u64,
    /// 1 while the motors are too warm.
    pub warm: u64,
    /// Temperature of the motors, 0 to 1.
    pub temperature: f64,
    /// Mode: 0 reset, 1 idle, 2 force, 3 brake.
    pub mode: u64,
    /// Cause of force off, 0 to 6.
    pub cause: u64,
    /// 1 while gravity compensation is on.
    pub gravity: u64,
    /// Force commands in the last 200 ms as a rate in kHz.
    pub rate: f64,
    /// 1 while the force's FORCE button is lit.
    pub lit: u64,
    /// Steps of 1 ms that the velocity window holds.
    pub window: u64,
}

// SAFETY: `repr(C)`, fields of f64, u64 and i64 alone, 45 words.
unsafe impl Words for State {}

/// Properties of a device's model. Booleans are 0 or 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Traits {
    /// Reach of the handle in m: least x, y, z, then largest x, y, z.
    pub reach: [f64; 6],
    /// Part of the reach in which forces are right, in m.
    pub workspace: [f64; 6],
    /// Height of the table below the origin in m.
    pub tabletop: f64,
    /// Degrees of freedom that the device measures.
    pub input_dof: f64,
    /// Degrees of freedom that the motors drive.
    pub output_dof: f64,
    /// Largest force in N.
    pub max_force: f64,
    /// Largest force for a long time in N.
    pub continuous_force: f64,
    /// Largest torque in N m.
    pub max_torque: f64,
    /// Largest torque for a long time in N m.
    pub continuous_torque: f64,
    /// Largest stiffness in N/m.
    pub max_stiffness: f64,
    /// Largest damping in N s/m.
    pub max_damping: f64,
    /// Rate of the driver's force ramp in N/s.
    pub ramp: f64,
    /// Speed limit of the driver in m/s.
    pub speed_limit: f64,
    /// HD calibration styles: 1 encoder reset, 2 automatic, 4 inkwell.
    pub calibration_style: f64,
    /// Deviation of the HD transform's rotation part from an orthonormal matrix.
    pub shear: f64,
    /// Force Dimension system type.
    pub system_type: f64,
    /// 1 for a left-handed device.
    pub left: f64,
    /// 1 for a device with a wrist.
    pub wrist: f64,
    /// 1 for a wrist with motors.
    pub active_wrist: f64,
    /// 1 for a device with a gripper.
    pub gripper: f64,
    /// 1 for a gripper with a motor.
    pub active_gripper: f64,
    /// Time guard of the Force Dimension driver in us.
    pub time_guard: f64,
    /// Time that `drdAutoInit` takes in ms.
    pub auto_init: f64,
    /// 1: a force command outside of mode force is error 19; 0: the driver drops it without a word.
    pub strict: f64,
}

// SAFETY: `repr(C)`, fields of f64 alone, 34 words.
unsafe impl Words for Traits {}
