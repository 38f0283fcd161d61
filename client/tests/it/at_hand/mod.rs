//! Ticks at the hand: through poor networks, over outages, under commands, and by clients that break the rules.
#![allow(clippy::unwrap_used)]

mod delays;
mod wall;

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common::{Station, pose, rows_and_events, scene};
use sulcus_connection::at_hand::{HandTicker, Out, TickPlace, Ticked, coupled};
use sulcus_connection::link::{Link, LinkConfig, now_ns};
use sulcus_core::{MAX_TOOLS, RawPose, ToolInput};
use sulcus_proto::at_hand::MOST_ROWS;
use sulcus_proto::control::{Command, EndReason, Goodbye};
use sulcus_proto::datagram::{ToolPose, WireLevels};
use sulcus_relay::{Conditions, Network, Relay};
use sulcus_sessions::{Recording, ReplayOptions, Row, replay};

/// A hand that goes down onto the plate and presses, with ticks of its own.
struct Hand {
    link: Link,
    ticker: HandTicker,
    /// Begin of the motion, by [`now_ns`].
    began_ns: u64,
    /// Number of passes so far.
    passes: u64,
    /// Whether a row could not be queued.
    refused: bool,
}

/// Configuration of a client that wishes to tick at the hand.
fn wishing(station: &Station) -> LinkConfig {
    LinkConfig {
        tick: TickPlace::Hand,
        scene_hash: *blake3::hash(&scene().to_bytes().unwrap()).as_bytes(),
        ..station.config()
    }
}

impl Hand {
    fn at(config: LinkConfig) -> Self {
        let link = Link::connect(config).unwrap();
        let hello = link.hello();
        assert!(link.ticks_at_hand(), "{:?}", hello.plan);
        let ticker = HandTicker::new(coupled(&Arc::new(scene()), hello).unwrap()).logged(200_000);
        link.start();
        let mut this = Self {
            link,
            ticker,
            began_ns: 0,
            passes: 0,
            refused: false,
        };
        let patience = Instant::now() + Duration::from_secs(30);
        while this.link.latest_wrench().is_none() {
            assert!(Instant::now() < patience, "{:?}", this.link.stats());
            std::thread::sleep(Duration::from_millis(1));
        }
        this.began_ns = now_ns();
        this
    }

    /// Height of the ball at a time, metres: down within a second, then up and down in the contact.
    fn height(ms: u64) -> f64 {
        let down = (0.012 - 1.1e-5 * ms as f64).max(0.001);
        let wave = (ms % 500) as f64 / 250.0 - 1.0;
        down + 2e-4 * wave.abs()
    }

    /// Performs `ms` milliseconds in real time. `change` may change levels and tick before they leave.
    fn go(&mut self, ms: u64, mut change: impl FnMut(&mut Pass)) {
        let end = self.passes + ms;
        while self.passes < end {
            let due_ns = self.began_ns + (self.passes + 1) * 1_000_000;
            let now = now_ns();
            if now < due_ns {
                std::thread::sleep(Duration::from_nanos(due_ns - now));
            }
            let late = now_ns().saturating_sub(due_ns) / 1_000_000;
            self.passes += 1 + late;
            let told = self
                .link
                .latest_wrench()
                .map(|packet| packet.datagram.levels);
            let mut pass = Pass {
                levels: told.unwrap_or_default(),
                skipped: late,
                forged: None,
            };
            change(&mut pass);
            self.tick(Self::height(self.passes), pass);
        }
    }

    /// Computes and sends the tick of a pass with the ball at a height, metres.
    fn tick(&mut self, height: f64, pass: Pass) {
        let mut packet = pose(height);
        packet.tools[0].sequence = self.passes as u32;
        packet.tools[0].device_time_ns = self.began_ns + self.passes * 1_000_000;
        let tools = tools(&packet.tools);
        let mut out = self
            .ticker
            .pass(&tools, &packet.tools, pass.levels, pass.skipped);
        packet.tick = out.tick;
        if let Some(forged) = pass.forged {
            forged(&mut out, &mut packet.tools);
        }
        self.refused |= !self.link.send_row(out);
        if out.tick.is_multiple_of(LIVE_EVERY) {
            self.link.send_pose(&packet);
        }
    }

    /// Waits for the time of a pass, and performs it with the ball at a height, metres. Passes before it are skipped.
    fn step(&mut self, number: u64, height: f64) {
        let skipped = number.saturating_sub(self.passes);
        self.passes = number + 1;
        sulcus_link::clock::sleep_until(self.began_ns + self.passes * 1_000_000);
        let told = self
            .link
            .latest_wrench()
            .map(|packet| packet.datagram.levels);
        let pass = Pass {
            levels: told.unwrap_or_default(),
            skipped,
            forged: None,
        };
        self.tick(height, pass);
    }

    fn end(self) -> (Goodbye, Vec<Ticked>) {
        assert!(!self.refused);
        let log = self.ticker.log().to_vec();
        (self.link.finish_with_text().unwrap(), log)
    }
}

/// Path to a station with a round trip.
fn far_away(station: &Station, rtt: Duration) -> Relay {
    let relay = Relay::to(station.server().local_addr()).unwrap();
    let path = Conditions {
        delay: rtt / 2,
        ..Conditions::default()
    };
    relay.change([path, path]).unwrap();
    relay
}

/// Number of ticks from one live pose to the next.
const LIVE_EVERY: u64 = 20;

/// Words of the breach of ticks that run too fast.
const AHEAD: &str = "ahead of the station's clock";

/// Changes of a pass.
struct Pass {
    levels: WireLevels,
    skipped: u64,
    forged: Option<fn(&mut Out, &mut [ToolPose; MAX_TOOLS])>,
}

fn tools(readings: &[ToolPose; MAX_TOOLS]) -> [ToolInput; MAX_TOOLS] {
    readings.map(|reading| ToolInput {
        pose: RawPose {
            position: reading.pose.position,
            orientation: reading.pose.orientation,
        },
        present: reading.present,
        ..ToolInput::ABSENT
    })
}

/// The recording of an ended session replays identically, and its ticks are those of the hand. Returns its rows.
fn is_whole(station: &Station, goodbye: &Goodbye, log: &[Ticked]) -> Vec<Row> {
    let summary = &goodbye.summary;
    assert_eq!(summary.end, EndReason::Stopped, "{goodbye:?}");
    assert!(summary.complete, "{summary:?}");
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
    let (rows, events) = rows_and_events(&recording);
    assert!(events.iter().any(|event| event.kind == "ticks_at_hand"));
    let recorded: Vec<_> = rows.iter().map(|row| (row.tick, row.hash)).collect();
    let felt: Vec<_> = log.iter().map(|tick| (tick.tick, tick.hash)).collect();
    assert_eq!(recorded.len(), felt.len());
    assert!(recorded == felt, "other ticks were recorded than felt");
    for (row, ticked) in rows.iter().zip(log) {
        let wrench = &ticked.wrench[0];
        let felt = wrench
            .force
            .iter()
            .chain(&wrench.torque)
            .map(|x| x.to_bits());
        assert!(
            felt.eq(row.wrench[0].iter().map(|x| x.to_bits())),
            "{}",
            row.tick
        );
    }
    assert!(rows.iter().any(|row| row.wrench[0][2] > 0.1), "no contact");
    rows
}

#[test]
fn through_poor_networks_the_hand_feels_the_ticks_that_are_recorded_bit_for_bit() {
    for network in [
        Network::Campus,
        Network::WifiBad,
        Network::Lte,
        Network::Geo,
    ] {
        let station = Station::new();
        let relay = Relay::through(network, station.server().local_addr(), 7).unwrap();
        let mut hand = Hand::at(LinkConfig {
            server: relay.address(),
            ..wishing(&station)
        });
        hand.go(3000, |_| ());
        let stats = hand.link.stats();
        assert!(stats.bytes_per_tick < 40.0, "{network}: {stats:?}");
        let (goodbye, log) = hand.end();
        let rows = is_whole(&station, &goodbye, &log);
        // The record of the hand has every reading, whatever the network loses.
        let samples = rows.iter().filter(|row| row.device[0].is_some()).count();
        assert_eq!(samples, rows.len(), "{network}");
    }
}

/// The hand goes on in an outage of `ms` that ends its connection, and hands its ticks in after it.
fn outage(ms: u64) {
    let station = Station::new();
    let relay = Relay::to(station.server().local_addr()).unwrap();
    let mut hand = Hand::at(LinkConfig {
        server: relay.address(),
        ..wishing(&station)
    });
    hand.go(1500, |_| ());
    relay.cut(true);
    hand.go(ms, |_| ());
    let stats = hand.link.stats();
    assert!(stats.ticks_behind > ms - 1000, "{stats:?}");
    relay.cut(false);
    let handed_in = (0..1200).any(|_| {
        hand.go(100, |_| ());
        let stats = hand.link.stats();
        stats.returns > 0 && stats.ticks_behind < 1000
    });
    assert!(handed_in, "{:?}", hand.link.stats());
    let (goodbye, log) = hand.end();
    let rows = is_whole(&station, &goodbye, &log);
    let skipped: u64 = rows.iter().map(|row| u64::from(row.input.skipped)).sum();
    assert_eq!(rows.len() as u64 + skipped, log.last().unwrap().tick);
}

#[test]
fn the_hand_goes_on_in_an_outage_that_ends_its_connection_and_hands_its_ticks_in_afterwards() {
    outage(5000);
}

#[test]
fn on_an_uplink_that_is_too_thin_the_rest_is_handed_in_after_the_motion() {
    let station = Station::new();
    let relay = Relay::to(station.server().local_addr()).unwrap();
    let thin = Conditions {
        delay: Duration::from_millis(10),
        rate: Some(150_000),
        queue: Duration::from_millis(200),
        ..Conditions::default()
    };
    relay.change([thin, Conditions::default()]).unwrap();
    let mut hand = Hand::at(LinkConfig {
        server: relay.address(),
        ..wishing(&station)
    });
    hand.go(8000, |_| ());
    let behind = hand.link.stats().ticks_behind;
    assert!(behind > 1500, "{behind}");
    let (goodbye, log) = hand.end();
    is_whole(&station, &goodbye, &log);
}

#[test]
fn a_pause_and_a_limit_of_the_station_are_inputs_of_the_next_ticks_at_the_hand() {
    let station = Station::new();
    let mut hand = Hand::at(wishing(&station));
    hand.go(1500, |_| ());
    station.server().command(Command::Pause);
    hand.go(500, |_| ());
    station.server().command(Command::ForceLimit(0.1));
    station.server().command(Command::Resume);
    hand.go(1500, |_| ());
    let (goodbye, log) = hand.end();
    let rows = is_whole(&station, &goodbye, &log);
    let paused = rows.iter().filter(|row| row.input.paused).count();
    assert!(paused > 0);
    let last = rows.last().unwrap();
    assert_eq!(last.input.force_limit_n, 0.1);
    assert!(last.wrench[0][2] <= 0.1);
    // The log names the tick that obeyed.
    let recording = Recording::open(&station.recording(&goodbye.summary.recording)).unwrap();
    let (_, events) = rows_and_events(&recording);
    let event = events.iter().find(|event| event.kind == "paused").unwrap();
    let first = rows.iter().find(|row| row.input.paused).unwrap();
    assert_eq!(event.tick, first.tick);
}

/// Performs a session whose client may break a rule in any pass. Returns the server's words and the first tick with a
/// break.
fn broken(station: &Station, mut change: impl FnMut(u64, &mut Pass) -> bool) -> (Goodbye, u64) {
    let mut hand = Hand::at(wishing(station));
    let (mut passes, mut first) = (0, None);
    for _ in 0..1000 {
        let tick = hand.ticker.tick();
        let mut breaks = false;
        hand.go(10, |pass| {
            passes += 1;
            breaks |= change(passes, pass);
        });
        first = first.or(breaks.then_some(tick));
        if !hand.link.is_open() {
            break;
        }
    }
    assert!(!hand.link.is_open(), "the session goes on");
    (hand.link.finish_with_text().unwrap(), first.unwrap())
}

#[test]
fn what_a_patched_client_tries_is_found_and_named() {
    type Try = (&'static str, fn(u64, &mut Pass) -> bool);
    let attempts: [Try; 6] = [
        ("the state has the hash", |k, pass| {
            // A changed bit of the state changes every later hash.
            let breaks = k >= 1500;
            if breaks {
                pass.forged = Some(|out, _| out.hash ^= 1 << 17);
            }
            breaks
        }),
        ("the state has the hash", |k, pass| {
            // One bit of an input, on its way. A tick with a live pose would be found by that pose.
            let breaks = k >= 1500;
            if breaks {
                pass.forged = Some(|out, _| {
                    let x = &mut out.row.tools[0].pose.position[0];
                    let change = u32::from(!out.tick.is_multiple_of(LIVE_EVERY));
                    *x = f32::from_bits(x.to_bits() ^ change);
                });
            }
            breaks
        }),
        ("the level of detail", |k, pass| {
            let breaks = k >= 1500;
            if breaks {
                pass.forged = Some(|out, _| out.row.detail = 1);
            }
            breaks
        }),
        ("a command that it was not told", |k, pass| {
            let breaks = k >= 1500;
            if breaks {
                pass.levels.commands = 77;
            }
            breaks
        }),
        ("the age of the pose", |k, pass| {
            let breaks = k >= 1500;
            if breaks {
                pass.forged = Some(|out, _| out.row.tools[0].age_ticks = 900);
            }
            breaks
        }),
        (AHEAD, |k, pass| {
            let breaks = k >= 1500;
            if breaks {
                pass.skipped += 1;
            }
            breaks
        }),
    ];
    for (cause, attempt) in attempts {
        let station = Station::new();
        let (goodbye, first) = broken(&station, attempt);
        let summary = &goodbye.summary;
        assert_eq!(summary.end, EndReason::Diverged, "{cause}: {goodbye:?}");
        assert!(goodbye.text.contains(cause), "{cause}: {}", goodbye.text);
        assert!(!summary.complete);
        let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
        let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
        assert!(report.identical && !report.gradable, "{cause}: {report:?}");
        let reason = report.reason.unwrap();
        assert!(reason.contains(cause), "{cause}: {reason}");
        if cause == AHEAD {
            // The time to gain depends on the start of the hand. The lead does not: each batch is checked, and brings
            // at most two ticks a row.
            let words = goodbye.text.split(|c: char| !c.is_ascii_digit());
            let numbers: Vec<u64> = words.filter_map(|word| word.parse().ok()).collect();
            let [.., lead, most] = numbers[..] else {
                panic!("{}", goodbye.text);
            };
            let batch = 2 * MOST_ROWS as u64;
            assert!(most < lead && lead <= most + batch, "{}", goodbye.text);
        } else {
            // The first batch with a break ends the session, and ten passes may come before the first break.
            let (rows, _) = rows_and_events(&recording);
            let after = rows.iter().filter(|row| row.tick > first).count();
            assert!(
                after <= 10 + MOST_ROWS,
                "{cause}: {after} ticks after {first}"
            );
        }
    }
}

#[test]
fn a_pause_that_the_hand_does_not_obey_ends_the_session() {
    let station = Station::new();
    let mut hand = Hand::at(wishing(&station));
    hand.go(1500, |_| ());
    station.server().command(Command::Pause);
    for _ in 0..300 {
        hand.go(10, |pass| pass.levels.paused_by_station = false);
        if !hand.link.is_open() {
            break;
        }
    }
    let goodbye = hand.link.finish_with_text().unwrap();
    assert_eq!(goodbye.summary.end, EndReason::Diverged);
    assert!(
        goodbye.text.contains("does not obey the pause"),
        "{}",
        goodbye.text
    );
}

#[test]
fn a_server_says_why_it_keeps_the_ticks() {
    let kept = Station::planned(|plan| plan.tick_at_hand = false);
    let other = Station::new();
    for (config, said) in [
        (wishing(&kept), "the plan keeps the ticks"),
        (
            LinkConfig {
                scene_hash: [3; 32],
                ..wishing(&other)
            },
            "another compiled scene",
        ),
    ] {
        let link = Link::connect(config).unwrap();
        assert!(!link.ticks_at_hand());
        let remark = &link.hello().plan.tick_remark;
        assert!(remark.contains(said), "{remark}");
    }
    // Without a wish there is nothing to say.
    let near = LinkConfig {
        tick: TickPlace::Auto,
        ..wishing(&other)
    };
    let link = Link::connect(near).unwrap();
    assert_eq!(link.hello().plan.tick_remark, "");
}

#[test]
fn far_away_a_client_ticks_at_the_hand_by_its_own_choice() {
    let station = Station::new();
    let relay = far_away(&station, Duration::from_millis(20));
    let config = LinkConfig {
        server: relay.address(),
        tick: TickPlace::Auto,
        ..wishing(&station)
    };
    assert!(Link::connect(config).unwrap().ticks_at_hand());
}

#[test]
fn a_program_that_starts_anew_cannot_take_over_ticks_of_another() {
    let station = Station::new();
    let mut hand = Hand::at(wishing(&station));
    hand.go(300, |_| ());
    drop(hand.link);
    let patience = Instant::now() + Duration::from_secs(20);
    // The server may learn of the end of the connection after the next one.
    let refused = loop {
        let refused = Link::connect(wishing(&station)).err().unwrap().to_string();
        if !refused.contains("in use by another client") {
            break refused;
        }
        assert!(Instant::now() < patience);
    };
    assert!(refused.contains("a program that is gone"), "{refused}");
    while Link::connect(wishing(&station)).is_err() {
        assert!(Instant::now() < patience);
        std::thread::sleep(Duration::from_millis(50));
    }
}
