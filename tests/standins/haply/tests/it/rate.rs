//! Rate of messages.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use sulcus_standin_haply::{Options, Service};

use crate::client::Client;

fn both(newtons: f64) -> Value {
    let arm = |id: &str| {
        let force = json!({"vector": {"x": newtons, "y": 0.0, "z": 0.0}});
        json!({"device_id": id, "commands": {"set_cursor_force": force}})
    };
    let grip = |id: &str| json!({"device_id": id, "commands": {"probe_orientation": {}}});
    json!({"inverse3": [arm("049D"), arm("04A1")], "wireless_verse_grip": [grip("61576"), grip("61577")]})
}

#[test]
fn two_arms_at_a_high_rate() {
    let service = Service::start(Options::pair()).unwrap();
    let (mut client, _) = Client::connect(&service);
    client.ask(both(0.0));
    let text = both(0.125).to_string();
    let start = Instant::now();
    let mut replies = 0_u32;
    while start.elapsed() < Duration::from_secs(1) {
        client
            .socket
            .send(tungstenite::Message::text(text.clone()))
            .unwrap();
        assert!(client.text().unwrap().len() > 500);
        replies += 1;
    }
    println!("{replies} replies in 1 s");
    // A quiet core makes well over 4000; the machine of the tests is shared.
    assert!(replies > 300, "{replies} replies in 1 s");
    let log = service.stop().unwrap();
    assert_eq!(log.messages(), replies as usize + 1);
    assert_eq!(log.forces("04A1").len(), replies as usize + 1);
    assert_eq!(log.violations(), vec![]);
}
