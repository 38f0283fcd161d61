//! Fuzz target: every decoder on arbitrary bytes.
//!
//! No input may panic. Every decoded message must encode to the same bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sulcus_proto::at_hand::Unpacker;
use sulcus_proto::display::{DisplayFrame, DisplayScene};
use sulcus_proto::{ClientMessage, PoseDatagram, ServerMessage, WrenchDatagram, frame};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(pose) = PoseDatagram::from_bytes(bytes) {
        assert_eq!(pose.to_bytes().expect("encodes"), bytes);
    }
    if let Ok(wrench) = WrenchDatagram::from_bytes(bytes) {
        assert_eq!(wrench.to_bytes().expect("encodes"), bytes);
    }
    if let Ok(frame) = DisplayFrame::from_bytes(bytes) {
        assert_eq!(frame.to_bytes().expect("encodes"), bytes);
    }
    if let Ok(scene) = DisplayScene::from_bytes(bytes) {
        assert_eq!(scene.to_bytes().expect("encodes"), bytes);
    }
    // Rows have several forms in bytes.
    let _ = Unpacker::default().unpack(bytes);
    if let Ok(message) = frame::decode::<ClientMessage>(bytes) {
        assert_eq!(
            &frame::encode(&message).expect("encodes")[frame::LENGTH_BYTES..],
            bytes
        );
    }
    if let Ok(message) = frame::decode::<ServerMessage>(bytes) {
        assert_eq!(
            &frame::encode(&message).expect("encodes")[frame::LENGTH_BYTES..],
            bytes
        );
    }
});
