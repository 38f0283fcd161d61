//! kill -9 of the server at twenty random moments.

use sulcus_support::long;

use crate::kills::kill;

#[test]
fn after_each_of_twenty_kills_the_recording_recovers_and_replays() {
    if long::selected("twenty-kills") {
        kill(0..20);
    }
}
