//! The energy of the closed loop over a link, without and with the passivity controller; a hand at rest for an hour.

use sulcus_cases::find;
use sulcus_cases::linked::{LinkModel, Linked, run_linked};
use sulcus_cases::rest::{HOUR, rest};
use sulcus_operator::PassivityParams;

fn linked(name: &str, delay_ticks: u32, loss: f64, passivity: PassivityParams) -> Linked {
    let case = find(name).expect("in the table");
    let link = LinkModel {
        delay_ticks,
        loss,
        seed: 7,
    };
    let linked = run_linked(case, &link, passivity);
    assert!(linked.finite, "{name}: {linked:?}");
    linked
}

/// Cases that put out energy at 5 ms: how much at least without the controller (joules), and what share of that at most with.
const GENERATORS: [(&str, f64, f64); 3] = [
    ("thin-plate-0.5", 4e-3, 0.5),
    ("peg-in-hole", 1e-4, 0.05),
    ("pocket-0.8", 1e-5, 0.05),
];

#[test]
fn a_late_wrench_puts_out_energy_and_the_controller_takes_it_out() {
    for (name, least, share) in GENERATORS {
        let without = linked(name, 5, 0.02, PassivityParams::observing());
        let with = linked(name, 5, 0.02, PassivityParams::default());
        println!("{name}: {without:?}\n    {with:?}");
        assert!(without.energy > least, "{name}: {without:?}");
        assert_eq!((without.taken, without.acted), (0.0, 0.0));
        assert!(with.energy < share * without.energy, "{name}: {with:?}");
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

#[test]
fn a_hand_at_rest_neither_drifts_nor_swings() {
    // On the plate an hour, for all repeats. In the pocket the rounding of poses to f32 goes round for longer than that: ten
    // minutes of it are run.
    for (name, ticks) in [("thin-plate-0.02", HOUR), ("pocket-rest", HOUR / 6)] {
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
}
