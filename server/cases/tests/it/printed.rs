//! The method as printed against the coupled one, on the cases that motivate the design: by the same measures, on the same
//! trees, springs and directions. (`examples/printed` prints more of it.)

use sulcus_cases::comparison::{Compared, Method, compare, compare_changed};
use sulcus_cases::{Case, find};
use sulcus_core::tissue::TissueModel;

fn case(name: &str) -> &'static Case {
    find(name).expect("in the table")
}

fn shown(compared: Compared) -> Compared {
    println!("{compared}");
    compared
}

#[test]
fn in_the_narrow_pocket_as_printed_buzzes_and_throws_the_probe_about() {
    println!("{}", Compared::heading());
    let [coupled, printed, unlimited] =
        Method::ALL.map(|method| shown(compare(case("pocket-0.4"), method)));
    let m = &coupled.measures;
    assert!(
        m.buzz <= 3e-3 && m.torque_step <= 1e-3 && m.jump <= 3.5e-4,
        "{coupled:?}"
    );
    assert_eq!((m.exhausted, coupled.ejected), (0, 0), "{coupled:?}");
    for printed in [&printed, &unlimited] {
        let p = &printed.measures;
        assert!(p.buzz > 3e-3 && p.buzz > 30.0 * m.buzz, "{printed:?}");
        // More than ten newton millimetres from one tick to the next.
        assert!(
            p.torque_step > 1e-2 && p.torque_step > 50.0 * m.torque_step,
            "{printed:?}"
        );
        assert!(
            p.jump > 3.5e-4 && p.force_step > 10.0 * m.force_step,
            "{printed:?}"
        );
        // The tissue moves into the tool, and there is no way out that a tick could find.
        assert!(
            p.exhausted > 100 && p.exhausted_residual > 1e-4,
            "{printed:?}"
        );
        assert_eq!(printed.faults, 0);
    }
    // With nothing to hold it, it leaves its place by more than a millimetre in a tick.
    assert!(unlimited.measures.jump > 1e-3, "{unlimited:?}");
}

#[test]
fn on_the_tongue_the_load_as_printed_is_not_the_devices() {
    println!("{}", Compared::heading());
    let name = "tongue-10-k0.5";
    let coupled = shown(compare(case(name), Method::Coupled));
    let printed = shown(compare(case(name), Method::Printed));
    let ratio = |compared: &Compared| compared.load_ratio.expect("forces on both");
    assert!((ratio(&coupled) - 1.0).abs() < 1e-3, "{coupled:?}");
    // One penalty per pair of spheres: it scales with K_p and with the number of pairs, not with what the hand feels.
    assert!(
        printed.pairs > 100 && (ratio(&printed) - 1.0).abs() > 0.2,
        "{printed:?}"
    );
    let stiffer = shown(compare_changed(case(name), Method::Printed, |scene| {
        for object in &mut scene.objects {
            if let TissueModel::PrintedSkeleton(model) = &mut object.tissue {
                // The prototype's 0.1 N/mm.
                model.penalty_n_per_m = 100.0;
                model.damping_n_s_per_m = 35.0;
            }
        }
    }));
    assert!(ratio(&stiffer) > 7.0, "{stiffer:?}");
    // So the hand feels what K_p says of one and the same tongue: twice as much, or a fifth.
    let most = |compared: &Compared| compared.measures.max_raw_force;
    assert!(most(&printed) > 1.5 * most(&coupled), "{printed:?}");
    assert!(most(&stiffer) < 0.5 * most(&coupled), "{stiffer:?}");
    // All three give way: a tongue that stood still would prove nothing.
    for compared in [&coupled, &printed, &stiffer] {
        assert!(compared.measures.indentation > 8e-3, "{compared:?}");
    }
}
