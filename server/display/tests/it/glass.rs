//! The glass of a mirror.

use sulcus_core::Vec3;
use sulcus_display::Display;
use sulcus_scene::anatomy::patient::{Patient, ToothChart};

use crate::common::compiled;

#[test]
fn the_glass_is_the_disc_of_the_mirror_without_its_rim() {
    let mut patient = Patient::healthy("one");
    patient.teeth = vec![ToothChart::healthy(37)];
    let scene = compiled(&patient, &[37]);
    let display = Display::new(&scene).expect("a display");
    let [probe, mirror] = &display.scene().tools[..] else {
        panic!("two tools")
    };
    assert_eq!(probe.glass, None);
    let glass = mirror.glass.expect("a glass");
    let at = |v: [f32; 3]| Vec3::from(v.map(f64::from));
    // A No. 4 mirror: 22 mm with a steel rim of 0.6 mm; 45 degrees to the handle, which is z.
    assert!((glass.radius - 10.4e-3).abs() < 0.01e-3, "{glass:?}");
    let normal = at(glass.normal);
    assert!((normal.norm() - 1.0).abs() < 1e-6);
    assert!((normal.z - 0.5f64.sqrt()).abs() < 1e-3, "{glass:?}");
    assert!(normal.dot(&at(mirror.tip_axis)).abs() < 1e-6);
    // The tip is a point of the disc's edge, half the thickness behind the glass.
    let tip = at(mirror.tip) - at(glass.centre);
    assert!((tip.norm() - 11e-3).abs() < 0.2e-3, "{tip:?}");
}
