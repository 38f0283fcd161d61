//! Whole mouths, probed by the good operator.

use sulcus_support::long;

use crate::tour::every_floor_is_reached;

#[test]
fn a_good_operator_reaches_every_floor_of_a_whole_mouth_and_is_never_inside_a_tooth() {
    if !long::selected("whole-mouths") {
        return;
    }
    std::thread::scope(|scope| {
        let runs = [5, 7].map(|seed| scope.spawn(move || every_floor_is_reached(seed, &[])));
        for run in runs {
            run.join().expect("every floor is reached");
        }
    });
}
