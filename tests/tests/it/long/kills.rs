//! kill -9 of the server at twenty random moments.

use sulcus_support::long;

use crate::kills::kill;

#[test]
fn twenty_kills_lose_at_most_a_fifth_of_a_second_each() {
    if long::selected("twenty-kills") {
        kill(0..20);
    }
}
