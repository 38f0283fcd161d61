use proptest::prelude::*;

use super::super::HandTool;
use super::*;
use crate::datagram::{WirePose, WireWrench};

/// Row of any bits.
fn any_row() -> impl Strategy<Value = HandRow> {
    let tool = (
        any::<(bool, bool, u16, u16)>(),
        any::<[u32; 7]>(),
        any::<(u32, u64)>(),
        any::<[u32; 6]>(),
    );
    let tool = tool.prop_map(
        |((present, stale, age_ticks, buttons), pose, numbers, changed)| {
            let [x, y, z, qw, qx, qy, qz] = pose.map(f32::from_bits);
            HandTool {
                present,
                stale,
                age_ticks,
                buttons,
                pose: WirePose {
                    position: [x, y, z],
                    orientation: [qw, qx, qy, qz],
                },
                sequence: numbers.0,
                device_time_ns: numbers.1,
                changed,
            }
        },
    );
    (any::<(u16, bool, u32, u8)>(), [tool.clone(), tool]).prop_map(|(head, tools)| HandRow {
        skipped: head.0,
        paused: head.1,
        force_limit_n: f32::from_bits(head.2),
        detail: head.3,
        tools,
    })
}

/// Bits of a row: NaN differs from itself.
fn bits(rows: &[HandRow]) -> Vec<Columns> {
    rows.iter().map(of_row).collect()
}

proptest! {
    #[test]
    fn rows_of_any_bits_arrive_as_they_were(
        batches in proptest::collection::vec(proptest::collection::vec(any_row(), 1..8), 1..4),
    ) {
        let (mut packer, mut unpacker) = (Packer::default(), Unpacker::default());
        for rows in &batches {
            let bytes = packer.pack(rows);
            let found = unpacker.unpack(&bytes).expect("a batch");
            prop_assert_eq!(bits(&found), bits(rows));
        }
    }

    #[test]
    fn any_bytes_are_rows_or_an_error_that_changes_nothing(
        bytes in proptest::collection::vec(any::<u8>(), 0..200),
        good in proptest::collection::vec(any_row(), 2),
    ) {
        let (mut packer, mut unpacker) = (Packer::default(), Unpacker::default());
        unpacker.unpack(&packer.pack(&good)).expect("a batch");
        if unpacker.unpack(&bytes).is_err() {
            let found = unpacker.unpack(&packer.pack(&good)).expect("a batch");
            prop_assert_eq!(bits(&found), bits(&good));
        }
    }

    #[test]
    fn a_displayed_wrench_comes_back(displayed in any::<[u32; 6]>(), ticked in any::<[u32; 6]>()) {
        let wrench = |bits: [u32; 6]| {
            let [fx, fy, fz, tx, ty, tz] = bits.map(f32::from_bits);
            WireWrench { force: [fx, fy, fz], torque: [tx, ty, tz] }
        };
        let (displayed, ticked) = (wrench(displayed), wrench(ticked));
        let tool = HandTool { changed: HandTool::change(&displayed, &ticked), ..HandTool::default() };
        let found = tool.displayed(&ticked);
        prop_assert_eq!(HandTool::change(&found, &displayed), [0; 6]);
    }
}

/// Ticks of a moving hand with the noise of a sensor of 2 um and 0.1 mrad on both tools, and jitter of the device's
/// clock of 50 us.
fn moving(k: u32, noise: &mut impl FnMut() -> f32) -> HandRow {
    let t = k as f32 * 1e-3;
    let tool = |at: f32, noise: &mut dyn FnMut() -> f32| HandTool {
        present: true,
        pose: WirePose {
            position: [
                0.03 + at + 2e-3 * (9.0 * t).sin() + 2e-6 * noise(),
                -0.02 + 1e-3 * (14.0 * t).cos() + 2e-6 * noise(),
                0.11 + 1.5e-3 * (6.0 * t).sin() + 2e-6 * noise(),
            ],
            orientation: [
                0.9 + 1e-4 * noise(),
                0.3 + 0.02 * (5.0 * t).sin() + 1e-4 * noise(),
                0.2 + 1e-4 * noise(),
                0.24 + 1e-4 * noise(),
            ],
        },
        sequence: k,
        ..HandTool::default()
    };
    let mut row = HandRow {
        tools: [tool(0.0, noise), tool(0.05, noise)],
        ..HandRow::default()
    };
    let late_ns = (25_000.0 * (1.0 + noise())) as u64;
    for tool in &mut row.tools {
        tool.device_time_ns = 1_000_000 * u64::from(k) + late_ns;
    }
    row
}

#[test]
fn two_noisy_hands_take_at_most_forty_bytes_a_tick() {
    let mut seed = 7u32;
    let mut noise = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    let rows: Vec<HandRow> = (0..5000).map(|k| moving(k, &mut noise)).collect();
    let (mut packer, mut unpacker) = (Packer::default(), Unpacker::default());
    let mut bytes = 0;
    for batch in rows.chunks(5) {
        let packed = packer.pack(batch);
        bytes += packed.len();
        assert_eq!(unpacker.unpack(&packed).expect("a batch"), batch);
    }
    println!("{:.1} bytes a tick", bytes as f64 / rows.len() as f64);
    assert!(bytes <= 40 * rows.len());
}

#[test]
fn a_batch_has_at_least_one_row_and_no_bytes_after_its_last() {
    let mut unpacker = Unpacker::default();
    let empty = Packer::default().pack(&[]);
    assert!(unpacker.unpack(&empty).is_err());
    let mut bytes = Packer::default().pack(&[HandRow::default()]);
    bytes.push(0);
    assert!(unpacker.unpack(&bytes).is_err());
    bytes.truncate(bytes.len() - 2);
    assert!(unpacker.unpack(&bytes).is_err());
}
