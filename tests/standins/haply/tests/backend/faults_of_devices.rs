//! Faults of devices in use.

use sulcus_haptics::{Stage, Trip, Unready};
use sulcus_standin_haply::{Fault, Motion, SafetyCause};

use crate::faults::{ABSENT, ARM, GRIP, NO_POSE, id, judge, leads_to, start};

const UNCALIBRATED: Stage = Stage::Unready(Unready::Uncalibrated);
const REFUSED: Stage = Stage::Tripped(Trip::Driver);

#[test]
fn unplugged_devices_return() {
    for device in [ARM, GRIP] {
        let [gone, back] = [
            Fault::Disconnect { device: id(device) },
            Fault::Reconnect { device: id(device) },
        ];
        leads_to(gone, Some(back), ABSENT, 0);
    }
}

#[test]
fn sleep_calibration_and_power_have_their_stage() {
    leads_to(
        Fault::Sleep { device: id(GRIP) },
        Some(Fault::Wake { device: id(GRIP) }),
        NO_POSE,
        0,
    );
    leads_to(
        Fault::CalibrationLost { device: id(ARM) },
        Some(Fault::Calibrated { device: id(ARM) }),
        UNCALIBRATED,
        0,
    );
    leads_to(
        Fault::PowerOff { device: id(ARM) },
        Some(Fault::PowerOn { device: id(ARM) }),
        REFUSED,
        0,
    );
}

#[test]
fn safety_events_take_the_force_away() {
    let safety = |cause| Fault::Safety {
        device: id(ARM),
        cause,
    };
    leads_to(
        safety(SafetyCause::EbrakeTriggered),
        Some(safety(SafetyCause::EbrakeReleased)),
        REFUSED,
        1,
    );
    leads_to(safety(SafetyCause::StallDetected), None, REFUSED, 1);
    leads_to(safety(SafetyCause::FodStageChanged), None, REFUSED, 1);
    leads_to(safety(SafetyCause::StabilityCeiling), None, REFUSED, 1);
}

#[test]
fn a_jump_of_the_hand_needs_a_button() {
    let mut rig = start();
    rig.press(false);
    let jump = Motion::Jump {
        from: [0.0, 0.1, 0.1],
        to: [0.03, 0.1, 0.1],
        after_ms: 5.0,
    };
    rig.service.set_hand(ARM, jump).unwrap();
    rig.wait("jump", || {
        // A period of more than 2 ms on a busy machine makes a fast motion of the jump.
        matches!(rig.stage(0), Stage::Tripped(Trip::Jump | Trip::Speed))
    });
    assert_eq!(rig.end(), Ok(()));
    judge(&rig.service.log().unwrap(), &"jump");
}
