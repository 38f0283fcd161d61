//! A door without a guard is the clamp, the watchdog and the display of the loop, bit for bit.

use sulcus_core::math::exp_rotation;
use sulcus_core::{Pose, Wrench};
use sulcus_haptics::{
    Display, Door, DoorRules, Limits, SlewLimits, Stage, Wanted, Watchdog, gated,
};

use crate::dice::Dice;
use crate::world::odd;

/// Bits of a wrench; every NaN and every sign of zero counts.
fn bits(wrench: &Wrench) -> [u64; 6] {
    let (f, t) = (wrench.force, wrench.torque);
    [f.x, f.y, f.z, t.x, t.y, t.z].map(f64::to_bits)
}

fn compare(seed: u64) {
    let mut dice = Dice::new(seed);
    let limits = Limits {
        force_n: dice.scaled(0.1, 40.0),
        torque_nm: dice.scaled(0.01, 1.0),
    };
    let slew = SlewLimits {
        force_n_per_ms: dice.scaled(0.01, 10.0),
        torque_nm_per_ms: dice.scaled(1e-3, 0.5),
    };
    let period_ns = dice.pick(&[250_000, 500_000, 1_000_000, 2_000_000]);
    let rules = DoorRules::in_step(limits, slew, period_ns as f64 * 1e-9);
    let mut door = Door::new(rules.clone());
    let (mut watchdog, mut display) = (Watchdog::new(), Display::new(rules.passivity, slew));
    let (mut now_ns, mut wanted) = (dice.pick(&[0, 7, 1 << 50]), Wanted::NOTHING);
    let mut pose = Pose::identity();
    let mut strong = 0;
    for period in 0..1500 {
        now_ns += match dice.below(200) {
            0 => dice.scaled(1e6, 3e8) as u64,
            1 => 0,
            _ => period_ns,
        };
        if period < 600 || dice.chance(0.9) {
            wanted.heard_ns = Some(now_ns - dice.below(period_ns).min(now_ns));
            wanted.wrench = Wrench {
                force: dice.vector(limits.force_n),
                torque: dice.vector(limits.torque_nm),
            };
            if dice.chance(0.02) {
                wanted.wrench.force = odd(&mut dice, wanted.wrench.force);
            }
        }
        wanted.leaving = dice.chance(0.01);
        pose.position += dice.vector(3e-4);
        pose.orientation = exp_rotation(&dice.vector(0.01)) * pose.orientation;
        let shown = if dice.chance(0.01) { None } else { Some(&pose) };
        let periods = 1 + dice.below(3);

        door.moved(shown, periods);
        door.order(&wanted);
        let by_door = door.pass(now_ns);

        display.moved(shown, periods);
        if let Some(at_ns) = wanted.heard_ns {
            watchdog.heard(at_ns);
        }
        let gate = watchdog.gate(now_ns);
        let by_hand = if wanted.leaving {
            display.next(&Wrench::ZERO, 0.0)
        } else {
            display.next(&gated(&wanted.wrench, gate, &limits), gate)
        };

        assert_eq!(
            bits(&by_door),
            bits(&by_hand),
            "seed {seed}, period {period}"
        );
        assert_eq!(
            bits(&door.displayed_in_world()),
            bits(&by_hand),
            "seed {seed}"
        );
        assert_eq!(
            door.gate().to_bits(),
            gate.to_bits(),
            "seed {seed}, period {period}"
        );
        assert_eq!(
            (door.energy(), door.stage()),
            (display.energy(), Stage::Live)
        );
        strong += u64::from(by_hand.force.norm() > 0.3 * limits.force_n);
    }
    assert!(
        strong > 50 || slew.force_n_per_ms < limits.force_n,
        "seed {seed}: {strong}"
    );
}

#[test]
fn a_door_without_a_guard_is_bit_for_bit_clamp_watchdog_and_display() {
    (0..40).for_each(compare);
}
