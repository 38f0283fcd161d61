//! Gamepads from bytes as the kernel sends them: records of 24 bytes on a system of 64 bits.

use super::*;
use crate::camera::Vector;
use crate::hand::{Board, Hand, HandPose, Hands, Limits, Scales};
use proptest::prelude::*;

/// Axes as the driver `xpad` reports them.
const XPAD: [(u16, [i32; 2]); 6] = [
    (0, [-32768, 32767]),
    (1, [-32768, 32767]),
    (2, [0, 255]),
    (3, [-32768, 32767]),
    (4, [-32768, 32767]),
    (5, [0, 255]),
];

fn pad(axes: &[(u16, [i32; 2])]) -> Pad {
    Pad::new(axes.iter().map(|(number, range)| PadAxis {
        number: *number,
        value: (range[0] + range[1]) / 2 * i32::from(range[0] < 0),
        range: *range,
    }))
}

/// Bytes of a record: seconds and microseconds, kind, number, value.
fn bytes(kind: u16, number: u16, value: i32) -> Vec<u8> {
    let time = [1_764_000_000i64, 250_000].map(i64::to_ne_bytes).concat();
    let rest = [kind.to_ne_bytes(), number.to_ne_bytes()].concat();
    [time, rest, value.to_ne_bytes().to_vec()].concat()
}

/// Events of a stream of bytes.
fn events(pad: &mut Pad, stream: &[u8]) -> Vec<PadEvent> {
    let mut events = Vec::new();
    for record in stream.chunks_exact(24) {
        let word = |at: usize| u16::from_ne_bytes([record[at], record[at + 1]]);
        let value = record[20..24].try_into().map(i32::from_ne_bytes);
        pad.feed(word(16), word(18), value.expect("four bytes"), &mut events);
    }
    events
}

#[test]
fn a_stick_moves_the_tool_after_the_clutch_is_closed() {
    let mut pad = pad(&XPAD);
    let home = HandPose {
        position: Vector::zeros(),
        orientation: crate::hand::pose::Turn::identity(),
    };
    let limits = Limits::around([Vector::zeros()], 90.0);
    let hand = Hand::new(home, Vector::zeros(), limits);
    let mut hands = Hands::new([Some(hand), None], Scales::default());
    let mut board = Board::new();
    let mut after = |stream: &[u8], hands: &mut Hands| {
        for event in events(&mut pad, stream) {
            board.pad(&event, hands);
        }
        for _ in 0..500 {
            hands.advance(1e-3);
        }
        hands.pose(0).expect("a tool").position
    };
    // The stick fully up: negative in the kernel.
    let up = [bytes(3, 1, -32768), bytes(0, 0, 0)].concat();
    assert_eq!(
        after(&up, &mut hands),
        Vector::zeros(),
        "the clutch is open"
    );
    let clutch = [bytes(1, 304, 1), bytes(0, 0, 0)].concat();
    let moved = after(&clutch, &mut hands);
    assert!(
        (moved - Vector::new(0.0, 0.0, 30.0)).norm() < 1e-6,
        "{moved}"
    );
    let rest = [bytes(1, 304, 0), bytes(3, 1, 0), bytes(0, 0, 0)].concat();
    let rested = after(&rest, &mut hands);
    assert_eq!(rested, moved);
    // The right trigger: towards the eye, which is x before the patient.
    let pull = [bytes(3, 5, 255), bytes(0, 0, 0)].concat();
    let nearer = after(&pull, &mut hands) - rested;
    assert!(
        (nearer - Vector::new(30.0, 0.0, 0.0)).norm() < 1e-6,
        "{nearer}"
    );
}

#[test]
fn a_state_is_told_once_and_at_the_end_of_its_group() {
    let mut pad = pad(&XPAD);
    let part = bytes(3, 0, 32767);
    assert_eq!(events(&mut pad, &part), []);
    let [PadEvent::Sticks(sticks)] = events(&mut pad, &bytes(0, 0, 0))[..] else {
        panic!("one state");
    };
    assert_eq!(sticks.left[0], 1.0);
    assert!(sticks.left[1].abs() < 1e-4 && sticks.triggers == [0.0; 2]);
    assert_eq!(events(&mut pad, &bytes(0, 0, 0)), []);
}

#[test]
fn other_layouts_have_their_sticks_and_triggers_too() {
    let after = |axes: &[(u16, [i32; 2])], stream: &[Vec<u8>]| {
        let mut pad = pad(axes);
        let stream = [stream.concat(), bytes(0, 0, 0)].concat();
        match events(&mut pad, &stream).last() {
            Some(PadEvent::Sticks(sticks)) => *sticks,
            other => panic!("{other:?}"),
        }
    };
    // A generic pad: the right stick at 2 and 5, the triggers are buttons.
    let generic = [0, 1, 2, 5].map(|number| (number, [0, 254]));
    let rest = |number| bytes(3, number, 127);
    let middle = [rest(0), rest(1), rest(2), rest(5)].concat();
    let right = after(&generic, &[middle.clone(), bytes(3, 5, 0)]);
    assert_eq!((right.right, right.triggers), ([0.0, 1.0], [0.0; 2]));
    let pulled = after(&generic, &[middle, bytes(1, 312, 1)]);
    assert_eq!((pulled.right, pulled.triggers), ([0.0; 2], [1.0, 0.0]));
    // The kernel's own layout: triggers at 20 (right) and 21 (left).
    let mut kernel = [0, 1, 3, 4].map(|number| (number, [-128, 128])).to_vec();
    kernel.extend([(20, [0, 100]), (21, [0, 100])]);
    let half = after(&kernel, &[bytes(3, 21, 50)]);
    assert_eq!(half.triggers, [0.5, 0.0]);
}

#[test]
fn buttons_have_names_and_repetitions_are_no_presses() {
    let mut pad = pad(&XPAD);
    let held = [bytes(1, 315, 1), bytes(1, 315, 2), bytes(1, 315, 0)].concat();
    let press = |down| PadEvent::Button(PadButton::Start, down);
    assert_eq!(events(&mut pad, &held), [press(true), press(false)]);
    let names = PadButton::names().map(PadButton::of_name);
    assert!(names.iter().all(Option::is_some) && PadButton::of_name("x").is_none());
}

proptest! {
    #[test]
    fn any_events_give_shares_in_range(
        axes in proptest::collection::vec((0u16..80, any::<[i32; 2]>()), 0..12),
        stream in proptest::collection::vec((0u16..6, 0u16..400, any::<i32>()), 0..60),
    ) {
        let mut pad = Pad::new(axes.iter().map(|(number, range)| PadAxis {
            number: *number, value: 0, range: *range,
        }));
        let mut events = Vec::new();
        for (kind, number, value) in stream {
            pad.feed(kind, number, value, &mut events);
        }
        for event in events {
            if let PadEvent::Sticks(sticks) = event {
                let shares = sticks.left.iter().chain(&sticks.right);
                prop_assert!(shares.copied().all(|share| (-1.0..=1.0).contains(&share)));
                prop_assert!(sticks.triggers.iter().all(|share| (0.0..=1.0).contains(share)));
            }
        }
    }
}
