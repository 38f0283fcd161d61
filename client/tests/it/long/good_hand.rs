//! The good operator's loads on the floor, over many hands.

use sulcus_support::long;

use crate::good_hand::reads_lightly;

#[test]
fn ten_good_hands_probe_lightly() {
    if long::selected("light-hands") {
        std::thread::scope(|scope| {
            scope.spawn(|| reads_lightly("probing", 3, 2..=10));
            scope.spawn(|| reads_lightly("bimanual", 9, 1..=3));
        });
    }
}
