//! Pipes of the live view: exact round trips, strict refusals, no panic on any bytes.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;
use sulcus_proto::CodecError;
use sulcus_proto::live::{
    HEAD, Hand, Hands, InPocket, Kind, PipeError, ViewerFile, content, head, read, write,
};

fn hands() -> Hands {
    let mut hands = Hands {
        tick: 7,
        ..Hands::default()
    };
    hands.tools[1] = Hand {
        held: true,
        force_n: [0.1, -0.2, 0.3],
        pocket: Some(InPocket {
            tooth: 36,
            site: 5,
            depth_mm: 4.5,
            true_depth_mm: 5.0,
            floor_n: 0.2,
            zone: 1,
        }),
        ..Hand::default()
    };
    hands
}

#[test]
fn messages_come_back_one_by_one_and_the_end_is_no_error() {
    let mut pipe = Vec::new();
    write(&mut pipe, Kind::Scene, b"scene").unwrap();
    write(&mut pipe, Kind::Hands, &hands().to_bytes().unwrap()).unwrap();
    let mut pipe = pipe.as_slice();
    assert_eq!(
        read(&mut pipe).unwrap(),
        Some((Kind::Scene, b"scene".to_vec()))
    );
    let (kind, bytes) = read(&mut pipe).unwrap().unwrap();
    assert_eq!(
        (kind, Hands::from_bytes(&bytes)),
        (Kind::Hands, Ok(hands()))
    );
    assert_eq!(read(&mut pipe).unwrap(), None);
}

#[test]
fn a_cut_message_an_unknown_kind_and_a_long_one_are_refused() {
    let mut pipe = Vec::new();
    write(&mut pipe, Kind::Further, b"0123456789").unwrap();
    for cut in [2, HEAD, HEAD + 9] {
        assert!(
            matches!(read(&mut &pipe[..cut]), Err(PipeError::Io(_))),
            "{cut}"
        );
    }
    assert!(matches!(
        content([0, 0, 0, 0, 0x77]),
        Err(CodecError::Kind { found: 0x77, .. })
    ));
    let limit = Kind::Further.limit();
    assert!(head(Kind::Further, limit).is_ok());
    assert_eq!(
        head(Kind::Further, limit + 1),
        Err(CodecError::TooLong {
            found: limit + 1,
            limit
        })
    );
    let mut long = head(Kind::Further, limit).unwrap();
    long[3] = 0xff;
    assert!(matches!(content(long), Err(CodecError::TooLong { .. })));
}

#[test]
fn a_state_that_is_not_finite_and_a_file_with_a_path_are_refused() {
    let mut wrong = hands();
    wrong.tools[1].force_n[2] = f32::NAN;
    assert_eq!(
        wrong.to_bytes(),
        Err(CodecError::NotFinite("a number of a hand"))
    );
    let mut wrong = hands();
    wrong.tools[1].pocket.as_mut().unwrap().site = 6;
    assert!(matches!(wrong.to_bytes(), Err(CodecError::NotCanonical(_))));
    let file = |name: &str| ViewerFile {
        version: "0.36.3".into(),
        name: name.into(),
        gzip: vec![1, 2],
    };
    let bytes = file("re_viewer.js").to_bytes().unwrap();
    assert_eq!(ViewerFile::from_bytes(&bytes), Ok(file("re_viewer.js")));
    for name in ["", "../x", "a/b", "a b"] {
        assert!(file(name).to_bytes().is_err(), "{name}");
    }
}

proptest! {
    #[test]
    fn no_bytes_make_a_reader_fail_otherwise_than_by_an_error(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let mut pipe = bytes.as_slice();
        while let Ok(Some((kind, body))) = read(&mut pipe) {
            prop_assert!(body.len() <= kind.limit());
        }
        if let Ok(hands) = Hands::from_bytes(&bytes) {
            prop_assert_eq!(hands.to_bytes().unwrap(), bytes.clone());
        }
        if let Ok(file) = ViewerFile::from_bytes(&bytes) {
            prop_assert_eq!(file.to_bytes().unwrap(), bytes);
        }
    }
}
