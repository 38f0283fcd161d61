//! Random sequences of everything at once, judged after each call.

use sulcus_haptics::port::door;
use sulcus_haptics::{Trip, Wanted};

use crate::dice::Dice;
use crate::faults::{Clock, Hand, Link};
use crate::judge::{Call, Judge, Seen};
use crate::world::World;

/// Calls of a calm start, which lets the force of most sequences rise before the faults begin.
const CALM: u64 = 300;

/// Runs the sequence of `seed`, and returns what the judge has seen.
///
/// # Panics
/// The contract is broken.
pub fn run(seed: u64) -> Seen {
    let mut dice = Dice::new(seed);
    let world = World::random(&mut dice);
    let (mut port, mut end) = door(world.rules.clone());
    let mut judge = Judge::new(world.terms);
    // Newest order in the mailbox.
    let mut given = Wanted::NOTHING;
    let (mut clock, mut link, mut hand) =
        (Clock::new(&mut dice), Link::new(), Hand::new(&mut dice));
    let calm_calls = if dice.chance(0.7) { CALM } else { 0 };
    let wild_ms = dice.pick(&[30, 60, 100, 100, 200, 700]);
    let wild_calls = (wild_ms * 1_000_000 / world.period_ns).min(1_600);
    // The calm start uses the longest period.
    let slow = World {
        period_ns: 2_000_000,
        ..world.clone()
    };
    for call in 0..calm_calls + wild_calls {
        let calm = call < calm_calls;
        let before_ns = clock.true_ns;
        let now_ns = clock.advance(&mut dice, if calm { &slow } else { &world }, calm);
        if !calm && dice.chance(0.001) {
            link.order.presses += 1;
        }
        link.run(
            &mut dice,
            &world,
            (clock.true_ns, now_ns),
            calm,
            &mut |order: &Wanted| {
                end.order(order);
                given = *order;
            },
        );
        let seconds = (clock.true_ns - before_ns) as f64 * 1e-9;
        let pose = hand.step(&mut dice, seconds, calm);
        let buttons = hand.press(&mut dice, calm);
        let driver_trip = !calm && dice.chance(0.0002);
        if driver_trip {
            port.trip(Trip::Driver);
        }
        let pose = pose.as_ref().map_err(|why| *why);
        let answer = port.exchange(now_ns, pose, buttons);
        let call_of = Call {
            now_ns,
            pose,
            buttons,
            order: &given,
            driver_trip,
        };
        if let Err(broken) = judge.call(&call_of, &answer) {
            panic!(
                "seed {seed}, call {call} (calm until {calm_calls}): {broken}\n{call_of:?}\n{answer:?}\n{:?}\n{:?}",
                world.terms,
                port.stage()
            );
        }
        let sample = end.sample();
        assert!(
            sample.displayed.force.iter().all(|x| x.is_finite()),
            "seed {seed}: sample"
        );
        assert!(
            (0.0..=1.0).contains(&sample.gate),
            "seed {seed}: gate {}",
            sample.gate
        );
    }
    judge.seen
}

/// Sum of what the judge has seen.
pub fn add(all: &mut Seen, one: &Seen) {
    all.calls += one.calls;
    all.starts += one.starts;
    all.strong += one.strong;
    all.rising += one.rising;
    all.silenced += one.silenced;
    all.stopped += one.stopped;
    all.left += one.left;
    all.hot += one.hot;
    all.most_heat = all.most_heat.max(one.most_heat);
    all.most_heat_ever = all.most_heat_ever.max(one.most_heat_ever);
}

/// Asserts that the judge had something to judge.
pub fn is_worth(seen: &Seen, sequences: u64) {
    for (name, number) in [
        ("starts", seen.starts),
        ("strong", seen.strong),
        ("rising", seen.rising),
        ("silenced", seen.silenced),
        ("stopped", seen.stopped),
        ("left", seen.left),
        ("hot", seen.hot),
    ] {
        assert!(
            number >= sequences / 50,
            "{name}: {number} of {sequences} sequences"
        );
    }
}

#[test]
fn whatever_server_link_device_and_operator_do_the_contract_holds() {
    const SEQUENCES: u64 = 300;
    let mut all = Seen::default();
    for seed in 0..SEQUENCES {
        add(&mut all, &run(seed));
    }
    println!("{SEQUENCES} sequences: {all:?}");
    assert!(all.calls > 150_000, "{} calls", all.calls);
    is_worth(&all, SEQUENCES);
}
