//! The method as printed in the narrow pocket, which is what the coupled one was made for.

use sulcus_cases::comparison::{Compared, Method, compare};
use sulcus_support::long;

use crate::printed::{case, shown};

#[test]
fn in_the_narrow_pocket_as_printed_buzzes_and_throws_the_probe_about() {
    if !long::selected("printed-in-the-narrow-pocket") {
        return;
    }
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
