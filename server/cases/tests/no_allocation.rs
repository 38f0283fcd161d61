//! A tick of the whole mouth allocates nothing: counted, with a probe in a pocket and a mirror on the tongue.

#[path = "../../core/tests/counting/mod.rs"]
mod counting;

use counting::calls;
use sulcus_cases::mouth::{hands, mouth};
use sulcus_cases::record;
use sulcus_core::{MAX_TOOLS, NoProbe, State, Workspace, tick};
use sulcus_operator::HandParams;

#[test]
fn ten_thousand_ticks_with_two_hands_in_the_mouth_allocate_nothing() {
    let scene = mouth(1, false, 3);
    let mut touched = [0; MAX_TOOLS];
    let script = Box::new(hands(&scene, 20.0));
    let hand = (HandParams::default(), 7);
    let inputs = record(&scene, script, hand, 10_000, |_, played| {
        for (touched, tool) in touched.iter_mut().zip(&played.output.tools) {
            *touched += u32::from(tool.active > 0);
        }
    });
    assert!(
        touched.iter().all(|&ticks| ticks > 2000),
        "in contact in {touched:?} ticks"
    );
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut read = 0;
    let before = calls();
    for input in &inputs {
        let out = tick(&scene, &mut state, &mut ws, input, &mut NoProbe);
        read += u32::from(out.tools.iter().any(|tool| tool.pocket.is_some()));
    }
    let after = calls();
    assert!(read > 1000, "read a depth in {read} ticks");
    assert_eq!(after - before, 0, "calls of the allocator");
}
