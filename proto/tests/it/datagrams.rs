//! Tests of datagrams: fixed sizes, exact round trips, strict refusals, no panic on any bytes.

use proptest::prelude::*;
use sulcus_proto::datagram::{Echo, ToolPose, ToolWrench, WireLevels, WirePose, WireWrench};
use sulcus_proto::reception::Reception;
use sulcus_proto::{CodecError, PROTOCOL_VERSION, PoseDatagram, WrenchDatagram, limits};

#[test]
fn sizes_are_fixed_and_small() {
    assert_eq!(PoseDatagram::BYTES, 163);
    assert_eq!(WrenchDatagram::BYTES, 181);
    assert_eq!(
        PoseDatagram::default().to_bytes().expect("encodes").len(),
        PoseDatagram::BYTES
    );
    assert_eq!(
        WrenchDatagram::default().to_bytes().expect("encodes").len(),
        WrenchDatagram::BYTES
    );
    // A send buffer holds four datagrams, four milliseconds at 1 kHz.
    assert_eq!(limits::POSE_SEND_BUFFER, 780);
    assert_eq!(limits::WRENCH_SEND_BUFFER, 852);
}

#[test]
fn the_layout_is_the_published_one() {
    let mut pose = PoseDatagram {
        epoch: 0x0403_0201,
        sequence: 5,
        ..Default::default()
    };
    pose.tools[0] = ToolPose {
        present: true,
        buttons: 0x0908,
        sequence: 6,
        device_time_ns: 7,
        period_us: 8,
        ..Default::default()
    };
    let bytes = pose.to_bytes().expect("encodes");
    assert_eq!(
        bytes[..10],
        [PROTOCOL_VERSION, PoseDatagram::KIND, 1, 2, 3, 4, 5, 0, 0, 0]
    );
    assert_eq!(bytes[10..13], [1, 8, 9]);
    assert_eq!((bytes[13], bytes[17], bytes[25]), (6, 7, 8));
    assert_eq!(bytes[41..45], 1f32.to_le_bytes());
    let levels = WireLevels {
        paused_by_station: true,
        paused_by_student: false,
        force_limit_n: 1.0,
        commands: 0x0b0a,
    };
    let wrench = WrenchDatagram {
        tick: 9,
        levels,
        ..Default::default()
    };
    let bytes = wrench.to_bytes().expect("encodes");
    assert_eq!((bytes[1], bytes[10]), (WrenchDatagram::KIND, 9));
    assert_eq!(bytes[18..20], [1, 0]);
    assert_eq!(bytes[20..24], 1f32.to_le_bytes());
    assert_eq!(bytes[24..28], [0x0a, 0x0b, 0, 0]);
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
    flag[10] = 2;
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
    // The first force component of the first tool follows prefix, epoch, sequence, tick and levels.
    bytes[28..32].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert_eq!(
        WrenchDatagram::from_bytes(&bytes),
        Err(CodecError::NotFinite("a wrench"))
    );
}

#[test]
fn echo_and_levels_have_one_form() {
    let mut echo = WrenchDatagram::default();
    echo.tools[1].echo.sequence = 1;
    assert!(matches!(echo.to_bytes(), Err(CodecError::NotCanonical(_))));
    let mut levels = WrenchDatagram::default();
    levels.levels.force_limit_n = -1.0;
    assert!(matches!(
        levels.to_bytes(),
        Err(CodecError::NotCanonical(_))
    ));
    levels.levels.force_limit_n = f32::NAN;
    assert_eq!(
        levels.to_bytes(),
        Err(CodecError::NotFinite("the force limit"))
    );
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

fn echo() -> impl Strategy<Value = Echo> {
    any::<Option<(u32, u64, u32, u32)>>().prop_map(|some| {
        some.map_or_else(
            Echo::default,
            |(sequence, device_time_ns, hold_us, wait_us)| Echo {
                valid: true,
                sequence,
                device_time_ns,
                hold_us,
                wait_us,
            },
        )
    })
}

prop_compose! {
    fn tool_wrench()(
        wrench in wrench(), graphic in pose(), status in any::<u16>(), echo in echo(),
    ) -> ToolWrench {
        ToolWrench { wrench, graphic, status, echo }
    }
}

prop_compose! {
    fn tool_pose()(
        present in any::<bool>(), numbers in any::<(u16, u32, u64, u32)>(), pose in pose(),
        displayed in wrench(),
    ) -> ToolPose {
        let (buttons, sequence, device_time_ns, period_us) = numbers;
        ToolPose { present, buttons, sequence, device_time_ns, period_us, pose, displayed }
    }
}

prop_compose! {
    fn reception()(lost in any::<u8>(), queue_100us in any::<u16>()) -> Reception {
        Reception { lost, queue_100us }
    }
}

prop_compose! {
    fn levels()(paused in any::<[bool; 2]>(), force_limit_n in 0f32..50.0, commands in any::<u32>()) -> WireLevels {
        WireLevels { paused_by_station: paused[0], paused_by_student: paused[1], force_limit_n, commands }
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
        (pose[10], pose[81]) = (present[0].into(), present[1].into());
        let decoded = PoseDatagram::from_bytes(&pose).expect("flags are valid");
        prop_assert_eq!(decoded.to_bytes().expect("encodes").to_vec(), pose);
        wrench[..2].copy_from_slice(&[PROTOCOL_VERSION, WrenchDatagram::KIND]);
        if let Ok(decoded) = WrenchDatagram::from_bytes(&wrench) {
            prop_assert_eq!(decoded.to_bytes().expect("encodes").to_vec(), wrench);
        }
    }

    #[test]
    fn wrenches_survive(
        epoch in any::<u32>(), sequence in any::<u32>(), tick in any::<u64>(), levels in levels(),
        tools in prop::array::uniform2(tool_wrench()), reception in reception(),
    ) {
        let sent = WrenchDatagram { epoch, sequence, tick, levels, tools, reception };
        prop_assert_eq!(WrenchDatagram::from_bytes(&sent.to_bytes().expect("encodes")), Ok(sent));
    }

    #[test]
    fn poses_survive(
        epoch in any::<u32>(), sequence in any::<u32>(), tools in prop::array::uniform2(tool_pose()),
        reception in reception(),
    ) {
        let sent = PoseDatagram { epoch, sequence, tools, reception, tick: u64::from(epoch) << 7 };
        prop_assert_eq!(PoseDatagram::from_bytes(&sent.to_bytes().expect("encodes")), Ok(sent));
    }
}
