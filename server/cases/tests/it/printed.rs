//! The method as printed against the coupled one, on the cases that motivate the design: by the same measures, on the same
//! trees, springs and directions. (`examples/printed` prints more of it.)

use sulcus_cases::comparison::{Compared, Method, compare, compare_changed};
use sulcus_cases::{Case, find};
use sulcus_core::tissue::TissueModel;

pub fn case(name: &str) -> &'static Case {
    find(name).expect("in the table")
}

pub fn shown(compared: Compared) -> Compared {
    println!("{compared}");
    compared
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
