//! Long proof: a minute, with more than 10^5 frames at each rate together.

use crate::compared;

#[test]
fn two_devices_feel_each_its_own_force_in_the_whole_mouth_for_a_minute() {
    if sulcus_support::long::selected("two-devices") {
        compared(60);
    }
}
