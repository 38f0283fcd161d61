//! Calibration of HD devices.

use crate::support::hd::fresh;
use crate::support::{rig, wait_until};
use sulcus_standins::Fault;
use sulcus_standins::board::Calibration;
use sulcus_standins::log::Event;
use sulcus_standins::setup::DeviceSetup;

#[test]
fn a_calibration_is_right_after_its_updates() {
    let mut device = DeviceSetup::touch("Left", "L1").with_calibration(Calibration::NeedsUpdate, 3);
    device.calibration.offset = [0.03, 0.0, 0.0];
    let rig = rig(vec![device]);
    let (_one, hd) = fresh(&rig);
    let left = hd.open("Left");
    // SAFETY: a device is current.
    let (check, update) = (
        || unsafe { (hd.check_calibration)() },
        |style| unsafe { (hd.update_calibration)(style) },
    );
    hd.frame(left, [0.0; 3]);
    assert!((hd.doubles::<3>(0x2050)[0] - 30.0).abs() < 0.1);
    update(1);
    assert_eq!(hd.errors(), [(0x101, left)]);
    update(2);
    update(2);
    rig.log().expect("a log");
    assert_eq!(check(), 0x5001);
    update(2);
    assert!(wait_until(|| check() == 0x5000));
    let log = rig.log().expect("a log");
    assert_eq!(log.times(0, |e| *e == Event::Calibrated).len(), 1);
    // The pose jumps to the right place.
    hd.frame(left, [0.0; 3]);
    assert!(hd.doubles::<3>(0x2050)[0].abs() < 0.1);
}

#[test]
fn manual_input_is_the_users() {
    let mut device =
        DeviceSetup::touch("Left", "L1").with_calibration(Calibration::NeedsManualInput, 1);
    device.traits.calibration_style = 4.0;
    let rig = rig(vec![device]);
    let (_one, hd) = fresh(&rig);
    hd.open("Left");
    // SAFETY: a device is current.
    let (check, update) = (
        || unsafe { (hd.check_calibration)() },
        || unsafe { (hd.update_calibration)(4) },
    );
    update();
    rig.log().expect("a log");
    assert_eq!(check(), 0x5002);
    rig.fault(0, Fault::Calibration(Calibration::NeedsUpdate))
        .expect("a fault");
    update();
    rig.log().expect("a log");
    assert_eq!(check(), 0x5001, "the stylus is not in its well");
    rig.fault(0, Fault::Inkwell(true)).expect("a fault");
    update();
    assert!(wait_until(|| check() == 0x5000));
    rig.fault(0, Fault::Calibration(Calibration::NeedsManualInput))
        .expect("a fault");
    assert_eq!(check(), 0x5002);
}
