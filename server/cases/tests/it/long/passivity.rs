//! The closed loop over the longest link in every case, and hours at rest.

use sulcus_cases::TABLE;
use sulcus_cases::rest::HOUR;
use sulcus_haptics::PassivityParams;
use sulcus_support::long;

use crate::passivity::{RESTING, linked, stays};

#[test]
fn over_the_longest_link_every_case_is_passive() {
    if !long::selected("every-case-over-the-longest-link") {
        return;
    }
    for case in TABLE.iter().filter(|case| !case.name.ends_with("-rest")) {
        let with = linked(case.name, 5, 0.02, PassivityParams::default());
        assert!(with.passive, "{}: {with:?}", case.name);
        let most = case.bounds.linked_energy;
        assert!(with.energy <= most, "{}: {with:?}", case.name);
    }
}

#[test]
fn an_hour_at_rest_neither_drifts_nor_swings() {
    if !long::selected("hours-at-rest") {
        return;
    }
    std::thread::scope(|scope| {
        let hours = RESTING.map(|name| scope.spawn(move || stays(name, HOUR)));
        for hour in hours {
            hour.join().expect("neither drifts nor swings");
        }
    });
}
