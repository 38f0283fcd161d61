//! Turning in pockets wider than the shipped one, whose trees no program brings along.

use sulcus_support::long;

use crate::pocket::calm::turning_is_calm;

#[test]
fn turning_in_wider_pockets_is_calm() {
    if long::selected("turning-in-wider-pockets") {
        turning_is_calm(&["0.5", "0.65", "0.8"]);
    }
}
