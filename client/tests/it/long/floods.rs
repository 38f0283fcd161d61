//! Ten million messages of any bytes.

use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_proto::frame::{self, LENGTH_BYTES};
use sulcus_proto::{ClientMessage, PoseDatagram, ServerMessage, WrenchDatagram};
use sulcus_support::long;

/// Decodes `count` messages that differ from valid ones in up to eight bytes and in their length.
fn decode(count: u64, seed: u64) {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let body = |bytes: Vec<u8>| bytes[LENGTH_BYTES..].to_vec();
    let valid = [
        PoseDatagram::default()
            .to_bytes()
            .expect("encodes")
            .to_vec(),
        WrenchDatagram::default()
            .to_bytes()
            .expect("encodes")
            .to_vec(),
        body(frame::encode(&ClientMessage::Start).expect("encodes")),
        body(frame::encode(&ClientMessage::Watch).expect("encodes")),
        body(frame::encode(&ServerMessage::Epoch(7)).expect("encodes")),
        body(frame::encode(&ServerMessage::Status(Default::default())).expect("encodes")),
    ];
    let mut whole = 0u64;
    for _ in 0..count {
        let mut bytes = valid[random.next_u32() as usize % valid.len()].clone();
        for _ in 0..random.next_u32() % 8 {
            let at = random.next_u32() as usize % bytes.len();
            bytes[at] = random.next_u32() as u8;
        }
        if random.next_u32().is_multiple_of(4) {
            bytes.truncate(random.next_u32() as usize % (bytes.len() + 1));
        }
        whole += u64::from(PoseDatagram::from_bytes(&bytes).is_ok());
        whole += u64::from(WrenchDatagram::from_bytes(&bytes).is_ok());
        whole += u64::from(frame::decode::<ClientMessage>(&bytes).is_ok());
        whole += u64::from(frame::decode::<ServerMessage>(&bytes).is_ok());
    }
    assert!(whole > count / 20, "{whole} of {count} decode");
}

#[test]
fn any_bytes_never_panic_and_leave_the_memory_as_it_is() {
    if !long::selected("any-bytes") {
        return;
    }
    decode(10_000_000, 1);
    // Over a connection: three in a millisecond, under the rate at which a client is dropped.
    crate::flood::fuzz(300_000, 2, true);
}
