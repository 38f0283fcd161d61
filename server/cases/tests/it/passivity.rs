//! The energy of the closed loop over a link, without and with the passivity controller; a hand at rest.

use sulcus_cases::find;
use sulcus_cases::linked::{FELT, LinkModel, Linked, run_linked_on};
use sulcus_cases::rest::{SETTLED, rest};
use sulcus_haptics::PassivityParams;

/// A case over a link of `delay_ticks` with a share `loss` of lost packets.
pub fn linked(name: &str, delay_ticks: u32, loss: f64, passivity: PassivityParams) -> Linked {
    let case = find(name).expect("in the table");
    let link = LinkModel {
        delay_ticks,
        loss,
        seed: 7,
    };
    // The cases last a third of a second. The ramp after the entry would hide the force whose energy is judged.
    let linked = run_linked_on(case, &link, passivity, |scene| {
        scene.params.ramp_up_ms = 100
    });
    assert!(linked.finite, "{name}: {linked:?}");
    linked
}

/// Cases that put out energy at 5 ms: how much at least without the controller (joules), and how much at most with.
const GENERATORS: [(&str, f64, f64); 5] = [
    ("thin-plate-0.5", 4e-3, 1e-4),
    ("peg-in-hole", 1e-4, 1e-6),
    ("pocket-0.8", 1e-5, 1e-6),
    ("organ-10-k5", 1e-1, 2e-4),
    // The fastest of them: 20 rad/s about a lever of 90 mm.
    ("long-lever", 4e-2, 1e-3),
];

#[test]
fn a_late_wrench_puts_out_energy_and_the_controller_takes_it_out() {
    for (name, least, most) in GENERATORS {
        let without = linked(name, 5, 0.02, PassivityParams::observing());
        let with = linked(name, 5, 0.02, PassivityParams::default());
        println!("{name}: {without:?}\n    {with:?}");
        assert!(without.energy > least, "{name}: {without:?}");
        let felt = without.energy > FELT;
        assert!(!felt || !without.passive, "{name}: {without:?}");
        assert_eq!((without.taken, without.acted), (0.0, 0.0));
        assert!(with.energy < most, "{name}: {with:?}");
        assert!(with.taken > 0.0 && with.acted > 0.0, "{name}: {with:?}");
    }
}

#[test]
fn without_a_link_a_contact_is_passive_and_what_is_felt_is_what_was_computed() {
    for name in ["thin-plate-0.5", "wedge", "tongue-10-k5"] {
        let with = linked(name, 0, 0.0, PassivityParams::default());
        assert!(with.energy < 1e-7, "{name}: {with:?}");
        assert_eq!(with.acted, 0.0, "{name}: {with:?}");
        assert!(with.infidelity() < 0.01, "{name}: {with:?}");
        let late = linked(name, 5, 0.02, PassivityParams::default());
        assert!(late.force_error > with.force_error, "{name}: {late:?}");
    }
}

/// A plate, a pocket, the tongue of springs and the tongue of finite elements.
pub const RESTING: [&str; 4] = ["hour-rest", "pocket-rest", "tongue-rest", "organ-rest"];

/// Asserts that a hand without tremor at rest for `ticks` stays within a micrometre. A run ends early where the whole state repeats.
pub fn stays(name: &str, ticks: u64) {
    let case = find(name).expect("in the table");
    let rest = rest(case, 2.0, ticks, PassivityParams::default());
    println!("{name}: {rest:?}");
    assert!(rest.force > 0.05, "{name}: {rest:?}");
    assert!(
        rest.drift < 1e-6 && rest.excursion < 1e-6,
        "{name}: {rest:?}"
    );
    let whole = rest.period.is_some() || rest.ticks == ticks;
    assert!(whole, "{name}: {rest:?}");
}

/// Ten seconds to settle and a minute of a hand without tremor at rest. The hours are among the long proofs.
const MINUTE: u64 = SETTLED + 60_000;

#[test]
fn a_minute_at_rest_neither_drifts_nor_swings() {
    for name in RESTING {
        stays(name, MINUTE);
    }
}
