//! Sequences without faults: nothing is broken, whatever hands, orders and network do.

use super::*;

#[test]
fn a_session_without_faults_breaks_nothing() {
    let session = session(Faulty::default());
    assert_breaks(&session.events, &[]);
    // The model is no session without force: it reaches the limits.
    let felt = |from: usize| pass(&mut session.events.clone(), from).displayed[0].force.z;
    assert!((felt(session.full) - 3.3).abs() < 1e-9);
    assert!((felt(session.limited[1]) - 1.0).abs() < 1e-9);
    assert_eq!(
        (
            felt(session.paused),
            felt(session.silent),
            felt(session.aged)
        ),
        (0.0, 0.0, 0.0)
    );
}

/// Random numbers of a seed: xorshift of 64 bits.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Whether an event of a probability of one in `n` happens.
    fn one_in(&mut self, n: u64) -> bool {
        self.next().is_multiple_of(n)
    }
}

/// Draws a turn: orders, loss in bursts, delay, skipped ticks, overslept passes, lost connections.
fn draw(random: &mut Random, bursts: &mut [u64; 4]) -> Turn {
    for burst in bursts.iter_mut() {
        *burst = burst.saturating_sub(1);
        if random.one_in(400) {
            *burst = random.next() % 150;
        }
    }
    let mut turn = Turn {
        is_lost: random.one_in(2000),
        is_back: random.one_in(150),
        is_skipped: bursts[0] > 130 || random.one_in(50),
        is_overslept: bursts[1] > 130 || random.one_in(50),
        loses_pose: bursts[2] > 0 || random.one_in(20),
        loses_wrench: bursts[3] > 0 || random.one_in(20),
        delay_ns: random.next() % (4 * MS),
        ..Turn::default()
    };
    if random.one_in(200) {
        let side = if random.one_in(2) {
            Side::Station
        } else {
            Side::Student
        };
        let limit = [0.0, 0.5, 1.0, 2.5, 10.0][random.next() as usize % 5];
        let commands = [
            Command::Pause,
            Command::Resume,
            Command::Resume,
            Command::ForceLimit(limit),
        ];
        turn.orders
            .push((side, commands[random.next() as usize % 4]));
    }
    turn
}

#[test]
fn no_sequence_without_faults_breaks_anything() {
    for seed in 1..=200 {
        let mut random = Random(u64::wrapping_mul(seed, 0x9E37_79B9_7F4A_7C15));
        let mut bursts = [0; 4];
        let mut play = Play::new(Faulty::default());
        play.calm(if seed % 2 == 0 { 600 } else { 0 });
        for _ in 0..2000 {
            let turn = draw(&mut random, &mut bursts);
            play.turn(&turn);
        }
        // The last gap has an end.
        play.turn(&Turn {
            is_back: true,
            ..Turn::default()
        });
        play.end();
        let mut watch = Watch::new(facts());
        for (at_ns, seen) in &play.events {
            let broken = watch.see(*at_ns, seen);
            assert!(
                broken.is_empty(),
                "seed {seed} at {at_ns} ns: {broken:?}, {seen:?}"
            );
        }
    }
}

#[test]
fn orders_before_the_session_hold_in_it() {
    let mut play = Play::new(Faulty::default());
    play.calm(100);
    let mut events = vec![(
        0,
        Seen::Ordered(Side::Station, Command::ForceLimit(f32::NAN)),
    )];
    events.append(&mut play.events);
    assert_breaks(&events, &[]);
    events[0].1 = Seen::Ordered(Side::Station, Command::Pause);
    // The ticks obey no pause, and their force stands longer than the ramp.
    assert_breaks(&events, &[10]);
}
