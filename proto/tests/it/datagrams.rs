//! Tests of datagrams: fixed sizes, exact round trips, strict refusals, no panic on any bytes.

use proptest::prelude::*;
use sulcus_proto::datagram::{Echo, Plane, ToolPose, ToolWrench, WirePose, WireWrench};
use sulcus_proto::{CodecError, PROTOCOL_VERSION, PoseDatagram, WrenchDatagram, limits};

#[test]
fn sizes_are_fixed_and_small() {
    assert_eq!(PoseDatagram::BYTES, 136);
    assert_eq!(WrenchDatagram::BYTES, 273);
    assert_eq!(
        PoseDatagram::default().to_bytes().expect("encodes").len(),
        PoseDatagram::BYTES
    );
    assert_eq!(
        WrenchDatagram::default().to_bytes().expect("encodes").len(),
        WrenchDatagram::BYTES
    );
    // A send buffer holds four datagrams, four milliseconds at 1 kHz.
    assert_eq!(limits::POSE_SEND_BUFFER, 672);
    assert_eq!(limits::WRENCH_SEND_BUFFER, 1220);
}

#[test]
fn the_layout_is_the_published_one() {
    let mut pose = PoseDatagram {
        epoch: 0x0403_0201,
        sequence: 5,
        device_time_ns: 6,
        last_tick: 7,
        ..Default::default()
    };
    pose.tools[0] = ToolPose {
        present: true,
        buttons: 0x0908,
        ..Default::default()
    };
    let bytes = pose.to_bytes().expect("encodes");
    assert_eq!(
        bytes[..10],
        [PROTOCOL_VERSION, PoseDatagram::KIND, 1, 2, 3, 4, 5, 0, 0, 0]
    );
    assert_eq!((bytes[10], bytes[18]), (6, 7));
    assert_eq!(bytes[26..29], [1, 8, 9]);
    assert_eq!(bytes[41..45], 1f32.to_le_bytes());
}

#[test]
fn what_is_not_exactly_so_is_refused() {
    let pose = PoseDatagram::default().to_bytes().expect("encodes");
    let wrench = WrenchDatagram::default().to_bytes().expect("encodes");
    let (length, expected) = (PoseDatagram::BYTES, PoseDatagram::BYTES);
    assert_eq!(
        PoseDatagram::from_bytes(&[]),
        Err(CodecError::Length { found: 0, expected })
    );
    assert_eq!(
        PoseDatagram::from_bytes(&pose[..length - 1]),
        Err(CodecError::Length {
            found: length - 1,
            expected
        })
    );
    assert!(matches!(
        PoseDatagram::from_bytes(&wrench),
        Err(CodecError::Kind {
            found: 2,
            expected: 1
        })
    ));
    let mut other = pose;
    other[0] = 9;
    assert_eq!(
        PoseDatagram::from_bytes(&other),
        Err(CodecError::Version { found: 9 })
    );
    // The flag `present` must be 0 or 1.
    let mut flag = pose;
    flag[26] = 2;
    assert!(matches!(
        PoseDatagram::from_bytes(&flag),
        Err(CodecError::Malformed(_))
    ));
}

#[test]
fn a_wrench_that_could_hurt_is_refused_on_both_sides() {
    let mut bad = WrenchDatagram::default();
    bad.tools[1].wrench.torque[2] = f32::NAN;
    assert_eq!(bad.to_bytes(), Err(CodecError::NotFinite("a wrench")));
    let mut bytes = WrenchDatagram::default().to_bytes().expect("encodes");
    // The first force component of the first tool follows prefix, epoch, sequence, tick and echo.
    bytes[35..39].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert_eq!(
        WrenchDatagram::from_bytes(&bytes),
        Err(CodecError::NotFinite("a wrench"))
    );
}

#[test]
fn planes_and_echo_have_one_form() {
    let mut five = WrenchDatagram::default();
    five.tools[0].plane_count = 5;
    assert!(matches!(five.to_bytes(), Err(CodecError::NotCanonical(_))));
    let mut unused = WrenchDatagram::default();
    unused.tools[0].planes[3].offset = -0.0;
    assert!(matches!(
        unused.to_bytes(),
        Err(CodecError::NotCanonical(_))
    ));
    let echo = Echo {
        valid: false,
        sequence: 1,
        ..Default::default()
    };
    assert!(matches!(
        WrenchDatagram {
            echo,
            ..Default::default()
        }
        .to_bytes(),
        Err(CodecError::NotCanonical(_))
    ));
}

fn finite() -> impl Strategy<Value = f32> {
    prop::num::f32::NORMAL | prop::num::f32::ZERO | prop::num::f32::SUBNORMAL
}

fn wrench() -> impl Strategy<Value = WireWrench> {
    (
        prop::array::uniform3(finite()),
        prop::array::uniform3(finite()),
    )
        .prop_map(|(force, torque)| WireWrench { force, torque })
}

fn pose() -> impl Strategy<Value = WirePose> {
    (
        prop::array::uniform3(finite()),
        prop::array::uniform4(finite()),
    )
        .prop_map(|(position, orientation)| WirePose {
            position,
            orientation,
        })
}

prop_compose! {
    fn tool_wrench()(
        wrench in wrench(), graphic in pose(), status in any::<u16>(),
        used in prop::collection::vec(prop::array::uniform4(finite()), 0..=4),
    ) -> ToolWrench {
        let mut slot = ToolWrench { wrench, graphic, status, plane_count: used.len() as u8, ..Default::default() };
        for (plane, [x, y, z, offset]) in slot.planes.iter_mut().zip(used) {
            *plane = Plane { normal: [x, y, z], offset };
        }
        slot
    }
}

proptest! {
    #[test]
    fn any_bytes_are_a_datagram_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = PoseDatagram::from_bytes(&bytes);
        let _ = WrenchDatagram::from_bytes(&bytes);
    }

    /// Property for bytes with a valid prefix and length: decoded datagrams encode to the same bits, NaN included.
    #[test]
    fn what_decodes_was_canonical(
        mut pose in prop::collection::vec(any::<u8>(), PoseDatagram::BYTES),
        mut wrench in prop::collection::vec(any::<u8>(), WrenchDatagram::BYTES),
        present in any::<[bool; 2]>(),
    ) {
        pose[..2].copy_from_slice(&[PROTOCOL_VERSION, PoseDatagram::KIND]);
        (pose[26], pose[81]) = (present[0].into(), present[1].into());
        let decoded = PoseDatagram::from_bytes(&pose).expect("flags are valid");
        prop_assert_eq!(decoded.to_bytes().expect("encodes").to_vec(), pose);
        wrench[..2].copy_from_slice(&[PROTOCOL_VERSION, WrenchDatagram::KIND]);
        if let Ok(decoded) = WrenchDatagram::from_bytes(&wrench) {
            prop_assert_eq!(decoded.to_bytes().expect("encodes").to_vec(), wrench);
        }
    }

    #[test]
    fn wrenches_survive(
        epoch in any::<u32>(), sequence in any::<u32>(), tick in any::<u64>(),
        echo in (any::<u32>(), any::<u64>(), any::<u32>()),
        tools in prop::array::uniform2(tool_wrench()),
    ) {
        let echo = Echo { valid: true, sequence: echo.0, device_time_ns: echo.1, hold_us: echo.2 };
        let sent = WrenchDatagram { epoch, sequence, tick, echo, tools };
        prop_assert_eq!(WrenchDatagram::from_bytes(&sent.to_bytes().expect("encodes")), Ok(sent));
    }

    #[test]
    fn poses_survive(
        numbers in (any::<u32>(), any::<u32>(), any::<u64>(), any::<u64>()),
        slots in prop::array::uniform2((any::<bool>(), any::<u16>(), pose(), wrench())),
    ) {
        let (epoch, sequence, device_time_ns, last_tick) = numbers;
        let tools = slots.map(|(present, buttons, pose, displayed)| ToolPose { present, buttons, pose, displayed });
        let sent = PoseDatagram { epoch, sequence, device_time_ns, last_tick, tools };
        prop_assert_eq!(PoseDatagram::from_bytes(&sent.to_bytes().expect("encodes")), Ok(sent));
    }
}
