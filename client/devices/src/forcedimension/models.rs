//! Models of the vendor and of the Novint Falcon: axes and rate.

/// Properties of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Model {
    /// Number of measured axes.
    pub motion_dof: u8,
    /// Number of rotational axes with torque.
    pub torque_axes: u8,
    /// Whether the wrist turns the handle; a device without a wrist has the rotation of its base.
    pub has_wrist: bool,
    /// Whether the gripper serves as a button.
    pub has_gripper: bool,
    /// Period of the device's thread, nanoseconds.
    pub period_ns: u64,
}

/// Period at 4 kHz.
const FAST_NS: u64 = 250_000;
/// Period at 1 kHz.
const SLOW_NS: u64 = 1_000_000;

/// Number of the Novint Falcon.
const FALCON: i32 = 60;

/// Returns the properties of the model `kind`, whose parts are a wrist, a wrist with motors, a gripper as the library
/// reports them. A torque needs a model with torque and the library's word for it.
pub fn model(kind: i32, [wrist, active_wrist, gripper]: [bool; 3]) -> Model {
    // Wrist, torque, gripper by the table of the note.
    let [has_wrist, has_torque, has_gripper] = match kind {
        // delta.3, omega.3, sigma.3, lambda.3, Falcon.
        63 | 33 | 206 | 203 | FALCON => [false, false, false],
        // omega.6, lambda.6.
        34 | 36 | 131 | 132 => [true, false, false],
        // omega.7.
        35 | 37 => [true, false, true],
        // sigma.7, lambda.7.
        104 | 105 | 108 | 109 => [true, true, true],
        _ => [wrist, active_wrist, gripper],
    };
    Model {
        motion_dof: 3 + 3 * u8::from(has_wrist) + u8::from(has_gripper),
        torque_axes: if has_torque && active_wrist { 3 } else { 0 },
        has_wrist,
        has_gripper: has_gripper && gripper,
        period_ns: if kind == FALCON { SLOW_NS } else { FAST_NS },
    }
}

/// Name of a model that the library does not name.
pub fn name(kind: i32) -> &'static str {
    match kind {
        63 => "delta.3",
        33 => "omega.3",
        34 | 36 => "omega.6",
        35 | 37 => "omega.7",
        206 => "sigma.3",
        104 | 105 => "sigma.7",
        203 => "lambda.3",
        108 | 109 => "lambda.7",
        131 | 132 => "lambda.6",
        FALCON => "Falcon",
        _ => "Force Dimension device",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torque_needs_the_model_and_the_library() {
        let axes = |kind, parts| {
            let model = model(kind, parts);
            (model.motion_dof, model.torque_axes)
        };
        assert_eq!(axes(63, [false; 3]), (3, 0));
        assert_eq!(axes(34, [true, true, false]), (6, 0));
        assert_eq!(axes(37, [true, false, true]), (7, 0));
        assert_eq!(axes(104, [true; 3]), (7, 3));
        assert_eq!(axes(105, [true, false, true]), (7, 0));
        assert_eq!(axes(91, [true, true, false]), (6, 3));
        assert_eq!(axes(91, [false; 3]), (3, 0));
        assert_eq!(model(60, [false; 3]).period_ns, SLOW_NS);
        assert_eq!(model(34, [true, false, false]).period_ns, FAST_NS);
    }
}
