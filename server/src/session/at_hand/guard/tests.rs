//! Attempts of a patched client, and honest clients on poor paths.

use super::*;
use crate::session::levels::Level;
use sulcus_core::ToolInput;

const TICK_NS: u64 = 1_000_000;
const RTT: Duration = Duration::from_millis(40);

/// Seeded noise, 0 to 1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }
}

/// Sends the newest tick every 5 ms over a path, for `seconds`. `tick_of` gives the tick at a time, and `delay_ms` the
/// delay of a packet, `None` for a lost one. Returns the breach and its time, milliseconds.
fn send(
    guard: &mut Guard,
    seconds: u64,
    tick_of: impl Fn(u64) -> u64,
    mut delay_ms: impl FnMut(u64) -> Option<f64>,
) -> Option<(u64, Breach)> {
    let mut arrivals: Vec<(u64, u64)> = (1..seconds * 200)
        .filter_map(|k| {
            let ms = 5 * k;
            let at_ns = ms * 1_000_000 + (delay_ms(ms)? * 1e6) as u64;
            Some((7_000_000_000 + at_ns, tick_of(ms)))
        })
        .collect();
    arrivals.sort_unstable();
    arrivals.iter().find_map(|(now_ns, tick)| {
        let found = guard.packet(*now_ns, *tick, RTT).err()?;
        Some((now_ns / 1_000_000 - 7000, found))
    })
}

fn guard() -> Guard {
    Guard::new(TICK_NS, 0, 7_000_000_000)
}

#[test]
fn honest_ticks_pass_on_poor_paths_for_an_hour() {
    let mut noise = Noise(3);
    // Jitter of 30 ms, 5 % loss that a stream repairs after a round trip, stalls of half a second, a clock off by 200
    // parts in a million.
    for ppm in [-200i64, 200] {
        let tick_of = |ms: u64| (ms as i64 + ms as i64 * ppm / 1_000_000) as u64;
        let delay = |ms: u64| {
            let repaired = if noise.next() < 0.05 { 60.0 } else { 0.0 };
            let stalled = if ms % 20_000 < 500 {
                (500 - ms % 20_000) as f64
            } else {
                0.0
            };
            Some(20.0 + 30.0 * noise.next() + repaired + stalled)
        };
        assert_eq!(send(&mut guard(), 3600, tick_of, delay), None, "{ppm}");
    }
}

#[test]
fn ticks_go_on_in_an_outage_and_pass_after_it() {
    let outage = |ms: u64| (!(5000..25_000).contains(&ms)).then_some(20.0);
    assert_eq!(send(&mut guard(), 60, |ms| ms, outage), None);
    // The stream brings the rows of the outage afterwards, while newer ticks come at once.
    let late = |ms: u64| {
        Some(if (5000..25_000).contains(&ms) {
            (25_000 - ms) as f64
        } else {
            20.0
        })
    };
    assert_eq!(send(&mut guard(), 60, |ms| ms, late), None);
}

/// A machine that starts many programs carries the first packets late, and later ones in time.
#[test]
fn a_busy_begin_makes_no_lead_of_later_ticks() {
    let delay = |ms: u64| Some(if ms < 1500 { 90.0 } else { 0.5 });
    assert_eq!(send(&mut guard(), 20, |ms| ms, delay), None);
}

#[test]
fn slow_motion_is_found_within_two_seconds_of_its_begin() {
    for speed_percent in [50, 80, 90] {
        let tick_of = |ms: u64| ms.min(5000) + ms.saturating_sub(5000) * speed_percent / 100;
        let found = send(&mut guard(), 20, tick_of, |_| Some(20.0)).expect("found");
        assert!(
            (5000..7000).contains(&found.0),
            "{speed_percent} %: {found:?}"
        );
        assert!(
            found.1.why.contains("behind the station's clock"),
            "{}",
            found.1
        );
    }
}

#[test]
fn slow_motion_from_the_begin_is_found_within_two_seconds_of_the_first_second() {
    let found = send(&mut guard(), 20, |ms| ms * 9 / 10, |_| Some(20.0)).expect("found");
    assert!(found.0 < 3000, "{found:?}");
}

#[test]
fn outages_of_ones_own_buy_few_seconds() {
    // Silence for 150 ms of each 400, at half the speed.
    let silent = |ms: u64| (ms % 400 >= 150).then_some(20.0);
    let found = send(&mut guard(), 60, |ms| ms - ms / 2, silent).expect("found");
    let behind = found.0 - found.1.tick;
    assert!(behind < 5000, "{behind} ms behind, {found:?}");
}

/// A client could stand still in a gap, catch up, and then use the excuse of the gap for slow motion.
#[test]
fn an_excuse_ends_when_the_ticks_have_caught_up() {
    let mut guard = guard();
    assert_eq!(send(&mut guard, 5, |ms| ms, |_| Some(20.0)), None);
    let at = |ms: u64| 7_000_000_000 + (ms + 20) * 1_000_000;
    guard.returned();
    for ms in (15_000..20_000).step_by(5) {
        assert_eq!(guard.packet(at(ms), ms, RTT), Ok(()), "{ms}");
    }
    let found = (20_000..23_000u64).step_by(5).find(|ms| {
        let tick = 20_000 + (ms - 20_000) * 9 / 10;
        guard.packet(at(*ms), tick, RTT).is_err()
    });
    assert!(found.is_some_and(|ms| ms < 22_000), "{found:?}");
}

/// A return over a new connection while the old one lives is no gap.
#[test]
fn a_return_without_a_silence_excuses_nothing() {
    let mut guard = guard();
    let at = |ms: u64| 7_000_000_000 + (ms + 20) * 1_000_000;
    let found = (5..60_000u64).step_by(5).find(|ms| {
        if ms % 900 == 0 {
            guard.returned();
        }
        guard.packet(at(*ms), ms / 2, RTT).is_err()
    });
    assert!(found.is_some_and(|ms| ms < 2000), "{found:?}");
}

#[test]
fn a_short_sleep_that_keeps_the_connection_is_excused() {
    let mut guard = guard();
    let at = |ms: u64| 7_000_000_000 + (ms + 20) * 1_000_000;
    for ms in (5..120_000u64).step_by(5) {
        // Twice for 2.5 s, with the ticks.
        let slept = [10_000, 100_000].map(|from| ms.saturating_sub(from).min(2500));
        let asleep = slept.iter().any(|slept| (1..2500).contains(slept));
        let tick = ms - slept.iter().sum::<u64>();
        if !asleep {
            assert_eq!(guard.packet(at(ms), tick, RTT), Ok(()), "{ms}");
        }
    }
}

/// Each gap excuses its own silence alone.
#[test]
fn returns_in_a_row_are_judged_between_their_gaps() {
    let mut guard = guard();
    let at = |ms: u64| 7_000_000_000 + (ms + 20) * 1_000_000;
    let found = (5..60_000u64).step_by(5).find(|ms| {
        if ms % 900 == 0 {
            guard.returned();
        }
        ms % 900 > 150 && guard.packet(at(*ms), ms / 2, RTT).is_err()
    });
    assert!(found.is_some_and(|ms| ms < 4000), "{found:?}");
}

fn named(tick: u64) -> LastTick {
    LastTick { tick, hash: 7 }
}

#[test]
fn rows_that_are_handed_in_after_the_motion_have_no_lag() {
    let handed_in = |is_named: bool| {
        let mut guard = guard();
        let live = send(&mut guard, 8, |ms| ms, |_| Some(10.0));
        assert_eq!(live, None);
        if is_named {
            guard
                .last(15_005_000_000, named(7995))
                .expect("the last tick");
        }
        // A thin uplink brings ticks 3000 to 7995 in the ten seconds after the motion.
        let mut late = (0..1000).map(|k| (15_010 + 10 * k, 3000 + 5 * k));
        late.find_map(|(ms, tick)| guard.packet(ms * 1_000_000, tick, RTT).err())
    };
    assert_eq!(handed_in(true), None);
    let why = handed_in(false).expect("a breach").why;
    assert!(why.contains("behind the station's clock"), "{why}");
}

#[test]
fn a_last_tick_is_the_last_one() {
    let mut guard = guard();
    assert_eq!(send(&mut guard, 2, |ms| ms, |_| Some(10.0)), None);
    let now_ns = 9_010_000_000;
    let refused =
        |guard: &mut Guard, tick| guard.last(now_ns, named(tick)).expect_err("refused").why;
    assert!(refused(&mut guard, 1000).contains("expected at least 1995"));
    assert!(refused(&mut guard, 9000).contains("ahead"));
    guard.last(now_ns, named(1998)).expect("the last tick");
    guard.last(now_ns, named(1998)).expect("the same again");
    assert!(refused(&mut guard, 2000).contains("expected 1998"));
    let other = LastTick {
        tick: 1998,
        hash: 8,
    };
    guard.last(now_ns, other).expect_err("another hash");
    assert_eq!(guard.newest_named(), 1998);
    assert_eq!(
        guard.handing_in(now_ns + 3_000_000_000),
        Duration::from_secs(3)
    );
    guard.packet(now_ns, 1998, RTT).expect("the last tick");
    let why = guard.packet(now_ns, 1999, RTT).expect_err("later").why;
    assert!(why.contains("comes after the last one, 1998"), "{why}");
    // Also inside of a batch.
    let row = late(&mut guard, 1999, 10, 0.0).expect_err("later").why;
    assert!(row.contains("comes after the last one, 1998"), "{row}");
    // The inputs were fixed at the end of the motion.
    guard.state(1998, 7).expect("the hash");
    guard.state(1997, 8).expect("another tick");
    guard.state(1998, 8).expect_err("other inputs");
}

#[test]
fn a_tick_of_any_64_bits_is_ahead_and_moves_nothing() {
    for tick in [u64::MAX, u64::MAX - 1000, 1 << 63, (1 << 63) - 1, 1 << 40] {
        let mut guard = guard();
        send(&mut guard, 2, |ms| ms, |_| Some(20.0));
        let newest = guard.newest();
        let found = guard.packet(9_100_000_000, tick, RTT);
        assert!(found.expect_err("ahead").why.contains("ahead"), "{tick}");
        assert_eq!(guard.newest(), newest);
    }
}

#[test]
fn ticks_ahead_of_the_clock_are_found() {
    let jump = |ms: u64| if ms < 3000 { ms } else { ms + 45 };
    let found = send(&mut guard(), 10, jump, |_| Some(20.0)).expect("found");
    assert!(found.0 < 3100 && found.1.why.contains("ahead"), "{found:?}");
    let fast = |ms: u64| ms + ms / 100;
    assert!(send(&mut guard(), 10, fast, |_| Some(20.0)).is_some());
}

#[test]
fn a_return_excuses_the_lag_of_a_sleep_and_no_more() {
    let mut guard = guard();
    assert_eq!(send(&mut guard, 5, |ms| ms, |_| Some(20.0)), None);
    // The laptop slept for 60 s, and its ticks with it.
    let back_ns = 7_000_000_000 + 65_000_000_000;
    guard.returned();
    let mut go_on = |from_ms: u64, to_ms: u64, percent: u64| {
        (from_ms / 5..to_ms / 5).find_map(|k| {
            let ms = 5 * k;
            let tick = 5000 + from_ms + (ms - from_ms) * percent / 100;
            guard.packet(back_ns + ms * 1_000_000, tick, RTT).err()
        })
    };
    assert_eq!(go_on(0, 10_000, 100), None);
    assert!(go_on(10_000, 13_000, 90).is_some());
}

/// Levels of the station's side.
fn paused(paused: bool) -> InForce {
    InForce {
        station: Level {
            paused,
            force_limit_n: 0.0,
        },
        ..InForce::default()
    }
}

/// Checks a row at its tick, which obeys `commands` commands with the levels `told`.
fn row(
    guard: &mut Guard,
    tick: u64,
    commands: u64,
    told: &InForce,
    input: &TickInput,
) -> Result<(), Breach> {
    let arrived_ns = 7_000_000_000 + (tick + 20) * 1_000_000;
    guard.row(
        (tick, arrived_ns),
        input,
        (commands, told),
        [None; MAX_TOOLS],
    )
}

#[test]
fn a_command_is_due_after_three_seconds_of_packets() {
    let at = |ms: u64| 7_000_000_000 + (ms + 20) * 1_000_000;
    let mut guard = guard();
    send(&mut guard, 3, |ms| ms, |_| Some(20.0));
    guard.told(1);
    let idle = TickInput::IDLE;
    for ms in (3000..5900).step_by(5) {
        guard.packet(at(ms), ms, RTT).expect("on time");
        assert_eq!(
            row(&mut guard, ms, 0, &paused(false), &idle),
            Ok(()),
            "{ms}"
        );
    }
    // An outage gives no time to obey, and takes none away.
    for ms in (8900..9200).step_by(5) {
        guard.packet(at(ms), ms, RTT).expect("on time");
    }
    let due = guard.newest() + 1;
    let breach = row(&mut guard, due, 0, &paused(false), &idle).expect_err("not obeyed");
    assert!(breach.why.contains("command 1"), "{breach}");
    assert_eq!(row(&mut guard, due, 2, &paused(false), &idle), Ok(()));
    // Rows of ticks before may still come.
    assert_eq!(row(&mut guard, 8800, 0, &paused(false), &idle), Ok(()));
}

/// An instructor who resumes and pauses again: rows on their way obey the command between.
#[test]
fn a_row_obeys_the_command_that_it_names_also_when_newer_ones_are_on_their_way() {
    let mut guard = guard();
    send(&mut guard, 3, |ms| ms, |_| Some(20.0));
    for command in 1..=3 {
        guard.told(command);
    }
    let input = |paused| TickInput {
        paused,
        ..TickInput::IDLE
    };
    for (commands, told, given, fits) in [
        (1, true, true, true),
        (1, true, false, false),
        (2, false, false, true),
        // The student's own pause.
        (2, false, true, true),
        (3, true, false, false),
    ] {
        let found = row(&mut guard, 2990, commands, &paused(told), &input(given));
        assert_eq!(found.is_ok(), fits, "{commands}, {given}: {found:?}");
    }
}

#[test]
fn a_force_limit_holds_at_the_hand() {
    let mut guard = guard();
    send(&mut guard, 3, |ms| ms, |_| Some(20.0));
    let limited = InForce {
        plan_limit_n: 1.5,
        ..InForce::default()
    };
    for (given, fits) in [
        (1.5, true),
        (0.5, true),
        (0.0, false),
        (2.0, false),
        (f32::NAN, false),
        (-1.0, false),
    ] {
        let input = TickInput {
            force_limit_n: given,
            ..TickInput::IDLE
        };
        let found = row(&mut guard, 2990, 0, &limited, &input);
        assert_eq!(found.is_ok(), fits, "{given}: {found:?}");
    }
}

#[test]
fn another_level_of_detail_is_found() {
    let input = TickInput {
        detail: 1,
        ..TickInput::IDLE
    };
    assert!(row(&mut guard(), 1, 0, &paused(false), &input).is_err());
}

/// Input of a hand at a height, with a pose of `age_ticks`.
fn held(height: f32, age_ticks: u16) -> TickInput {
    let mut input = TickInput::IDLE;
    input.tools[0] = ToolInput {
        present: true,
        age_ticks,
        ..ToolInput::ABSENT
    };
    input.tools[0].pose.position[2] = height;
    input
}

#[test]
fn a_forged_age_is_found_by_the_time_of_the_reading() {
    let mut guard = guard();
    send(&mut guard, 3, |ms| ms, |_| Some(20.0));
    let read = |guard: &mut Guard, tick: u64, age: u16, ms: u64| {
        let at = (tick, 7_000_000_000 + tick * TICK_NS);
        let times = [Some(99_000_000_000 + ms * TICK_NS), None];
        guard.row(at, &held(0.1, age), (0, &paused(false)), times)
    };
    for tick in 200..1000 {
        // A device of 250 Hz.
        let age = tick % 4;
        let found = read(&mut guard, tick, age as u16, tick - age);
        assert_eq!(found, Ok(()), "{tick}");
    }
    let forged = read(&mut guard, 1000, 200, 1000);
    assert!(forged.expect_err("forged").why.contains("age"));
    let back = read(&mut guard, 1001, 0, 990);
    assert!(back.expect_err("back").why.contains("go back in time"));
}

/// Guard after three seconds of packets, and with live poses of the ticks from 3000 to 4000 if they are sent.
fn with_live(sent: bool) -> Guard {
    let mut guard = guard();
    send(&mut guard, 3, |ms| ms, |_| Some(20.0));
    for tick in (3000..4000).step_by(20).filter(|_| sent) {
        let at = 7_000_000_000 + (tick + 20) * 1_000_000;
        guard.packet(at, tick, RTT).expect("on time");
        guard.live(at, tick, &held(tick as f32, 0));
    }
    guard
}

/// Checks the row of a tick that arrives `late_ms` after its time.
fn late(guard: &mut Guard, tick: u64, late_ms: u64, height: f32) -> Result<(), Breach> {
    let at = (tick, 7_000_000_000 + (tick + 20 + late_ms) * 1_000_000);
    guard.row(at, &held(height, 0), (0, &paused(false)), [None; MAX_TOOLS])
}

#[test]
fn a_row_is_that_of_its_live_pose() {
    let mut guard = with_live(true);
    for tick in 3000..3500 {
        assert_eq!(late(&mut guard, tick, 10, tick as f32), Ok(()));
    }
    let changed = late(&mut guard, 3500, 10, 99.0).expect_err("changed");
    assert!(changed.why.contains("live pose"), "{changed}");
}

#[test]
fn late_rows_are_bound_by_live_poses_in_time_or_refused() {
    for (sent, late_ms, fits) in [
        (true, 600_000, true),
        (false, 900, true),
        (false, 1500, false),
    ] {
        let found = late(&mut with_live(sent), 3500, late_ms, 3500.0);
        assert_eq!(found.is_ok(), fits, "{sent}, {late_ms} ms: {found:?}");
    }
    // Live poses that come together with the late rows bind nothing.
    let mut guard = with_live(false);
    for tick in (3000..4000).step_by(20) {
        let at = 7_000_000_000 + (tick + 60_000) * 1_000_000;
        guard.live(at, tick, &held(tick as f32, 0));
    }
    assert!(late(&mut guard, 3500, 60_000, 3500.0).is_err());
}

#[test]
fn rows_of_an_outage_may_come_late() {
    let mut guard = with_live(false);
    let at = |ms: u64| 7_000_000_000 + (ms + 20) * 1_000_000;
    guard.returned();
    for ms in (13_000..14_000).step_by(5) {
        guard.packet(at(ms), ms, RTT).expect("on time");
    }
    for tick in 2995..13_500 {
        assert_eq!(late(&mut guard, tick, 14_000 - tick, 0.0), Ok(()), "{tick}");
    }
}

#[test]
fn the_last_part_of_a_second_needs_live_poses_in_proportion() {
    // Last tick, number of sent live poses for each that arrived, and whether a row that comes a minute late is
    // accepted.
    for (last, arrived, fits) in [
        (3020, 0, true),
        (3200, 0, false),
        (3200, 5, true),
        (3500, 4, true),
        (3500, 9, false),
        (3999, 5, true),
        (3999, 6, false),
    ] {
        let mut guard = with_live(false);
        for tick in (3000..=last).step_by(20) {
            let at = 7_000_000_000 + (tick + 20) * 1_000_000;
            guard.packet(at, tick, RTT).expect("on time");
            if arrived > 0 && tick % (20 * arrived) == 0 {
                guard.live(at, tick, &held(tick as f32, 0));
            }
        }
        let at = 7_000_000_000 + (last + 40) * 1_000_000;
        guard.last(at, named(last)).expect("the last tick");
        let found = late(&mut guard, last, 60_000, last as f32);
        assert_eq!(found.is_ok(), fits, "{last}, 1 in {arrived}: {found:?}");
    }
}
