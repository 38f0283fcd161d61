//! Rules for ticks at the hand, checked on the server's clock. The guard itself reads no clock.
//!
//! The device's ticks may not be ahead of the server's clock, nor fall behind it except in outages that the server saw.
//! Rows may come late only after such an outage, or if live poses had bound them in time. A command of the station is
//! obeyed exactly, within [`OBEYED`] of packets. The level of detail is that of the plan. A client that breaks a rule
//! could give its hand more time or less force than others have.

mod live;

use std::collections::VecDeque;
use std::fmt;
use std::time::Duration;

use sulcus_core::{MAX_TOOLS, TickInput};
use sulcus_proto::control::LastTick;

use crate::session::levels::InForce;
use live::LivePoses;

/// Largest lead of the ticks over the server's clock since the start of the session.
const AHEAD: Duration = Duration::from_millis(20);
/// Largest lag of the ticks behind the server's clock beyond the delay of the path.
const BEHIND: Duration = Duration::from_millis(100);
/// Largest widening of that lag by a longer round trip.
const LONGER: Duration = Duration::from_millis(500);
/// Time with packets after which a command of the station must be input of the ticks. A connection without answers is
/// lost by then.
const OBEYED: Duration = Duration::from_secs(3);
/// Number of commands that are remembered as due.
const DUE: usize = 64;
/// Silence from which on an outage counts.
const OUTAGE: Duration = Duration::from_millis(100);
/// Largest sum of lags that outages without a lost connection excuse: more than the silence that loses a connection.
const EXCUSED: Duration = Duration::from_secs(4);
/// Share of the time by which that sum recovers.
const RECOVERS: i64 = 100;
/// Time after a return in which the ticks catch up and no lag is judged.
const SETTLES: Duration = Duration::from_secs(1);
/// Least time between two such times.
const RARELY: Duration = Duration::from_secs(10);
/// Windows of the least delay; the lag is the least of both.
const WINDOW: Duration = Duration::from_millis(250);
/// Time from the first tick in which no lag is judged.
const BEGIN: Duration = Duration::from_secs(1);
/// Difference between the speeds of two clocks, parts in a million: the kernel corrects up to 500.
const DRIFT_PPM: i64 = 500;
/// Largest difference between the time of a device's reading and its tick, beyond the age of the reading. A device that
/// is silent for 50 ms counts as gone.
const READING: Duration = Duration::from_millis(100);
/// Lag of a row from which on it must be bound by live poses, or come after an outage.
const LATE: Duration = Duration::from_secs(1);

/// Rule that the ticks at the hand broke.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Breach {
    /// Newest tick.
    pub tick: u64,
    /// Cause, as the second half of a sentence.
    pub why: String,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at tick {}: {}", self.tick, self.why)
    }
}

/// Checks of a session's ticks at the hand. All times are nanoseconds of the server's monotonic clock.
#[derive(Debug)]
pub(crate) struct Guard {
    tick_ns: i64,
    detail: u8,
    /// Start of the session, before the hand's first tick.
    started_ns: i64,
    /// Newest tick of which the server knows, from a row or a live pose.
    newest: u64,
    /// Time of the newest packet; `None` before the first one.
    packet_ns: Option<i64>,
    /// Time of the first packet.
    began_ns: i64,
    /// Least delay: arrival minus tick, on an unknown zero, and the round trip at that time.
    least_ns: i64,
    rtt_ns: i64,
    /// Least delays of the present and the previous window, and begin of the present one.
    windows: [i64; 2],
    window_ns: i64,
    /// Lag that outages excuse, and the recovering sum of those without a lost connection.
    excuse_ns: i64,
    excused_ns: i64,
    /// End of the newest outage.
    outage_ns: i64,
    /// Whether the next packet is the first one of a connection that is back.
    returned: bool,
    /// End of the time in which the ticks catch up after a return.
    settles_ns: i64,
    /// Last tick of the ended motion, and the time at which it was named.
    last: Option<(LastTick, u64)>,
    /// Sum of the time with packets.
    heard_ns: i64,
    /// Commands that the hand was told, with [`Guard::heard_ns`] at that time; oldest first.
    told: VecDeque<(u64, i64)>,
    /// Newest number of them.
    commands: u64,
    /// Commands that are due, each with the newest tick at that time; oldest first.
    due: VecDeque<(u64, u64)>,
    /// Time and number of the device's newest reading, and its time minus that of its tick.
    readings: [Option<Reading>; MAX_TOOLS],
    live: LivePoses,
}

/// Newest reading of a device.
#[derive(Clone, Copy, Debug)]
struct Reading {
    time_ns: u64,
    usual_ns: i64,
}

impl Guard {
    /// Guard of a session with ticks of `tick_ns` and a level of detail, which starts at `started_ns`.
    pub fn new(tick_ns: u64, detail: u8, started_ns: u64) -> Self {
        Self {
            tick_ns: tick_ns as i64,
            detail,
            started_ns: started_ns as i64,
            newest: 0,
            packet_ns: None,
            began_ns: 0,
            least_ns: 0,
            rtt_ns: 0,
            windows: [i64::MAX; 2],
            window_ns: 0,
            excuse_ns: 0,
            excused_ns: 0,
            outage_ns: 0,
            returned: false,
            settles_ns: i64::MIN / 2,
            last: None,
            heard_ns: 0,
            told: VecDeque::new(),
            commands: 0,
            due: VecDeque::new(),
            readings: [None; MAX_TOOLS],
            live: LivePoses::new(tick_ns),
        }
    }

    /// Newest tick of which the server knows.
    pub fn newest(&self) -> u64 {
        self.newest
    }

    /// Newest tick whose row must come: that of a live pose, or the last one.
    pub fn newest_named(&self) -> u64 {
        let last = self.last.map_or(0, |(last, _)| last.tick);
        self.live.newest().max(last)
    }

    /// Time since the end of the motion; zero before it.
    pub fn handing_in(&self, now_ns: u64) -> Duration {
        let since = self
            .last
            .map(|(_, since_ns)| now_ns.saturating_sub(since_ns));
        Duration::from_nanos(since.unwrap_or(0))
    }

    /// A connection is back after a gap, which the server saw.
    pub fn returned(&mut self) {
        self.returned = self.packet_ns.is_some();
    }

    /// Checks that `tick` is not ahead of the clock.
    ///
    /// # Errors
    /// The tick is ahead.
    pub fn lead(&self, now_ns: u64, tick: u64) -> Result<(), Breach> {
        let since_ns = now_ns as i64 - self.started_ns;
        let allowed_ns = ns(AHEAD) + since_ns / 1_000_000 * DRIFT_PPM;
        // A tick of any 64 bits must not wrap.
        let lead_ns = i128::from(tick) * i128::from(self.tick_ns) - i128::from(since_ns);
        if lead_ns > i128::from(allowed_ns) {
            return Err(Breach {
                tick: self.newest,
                why: format!(
                    "the ticks are {} ms ahead of the station's clock, expected at most {}",
                    lead_ns / 1_000_000,
                    allowed_ns / 1_000_000
                ),
            });
        }
        Ok(())
    }

    /// The motion has ended with `tick`. The rows that follow have no lag, because no newer tick exists.
    ///
    /// # Errors
    /// The tick is ahead, is older than a former tick, or contradicts an earlier end.
    pub fn last(&mut self, now_ns: u64, last: LastTick) -> Result<(), Breach> {
        self.lead(now_ns, last.tick)?;
        if let Some((named, _)) = self.last {
            if named != last {
                return Err(self.breach(format!(
                    "{} was named as the last tick, expected {} with the same hash",
                    last.tick, named.tick
                )));
            }
            return Ok(());
        }
        if last.tick < self.newest {
            return Err(self.breach(format!(
                "{} was named as the last tick, expected at least {}",
                last.tick, self.newest
            )));
        }
        self.last = Some((last, now_ns));
        self.live.last(last.tick);
        Ok(())
    }

    /// Takes the state hash after a computed tick.
    ///
    /// # Errors
    /// The tick is the last one, and has another hash than at the end of the motion.
    pub fn state(&self, tick: u64, hash: u64) -> Result<(), Breach> {
        match self.last {
            Some((last, _)) if last.tick == tick && last.hash != hash => Err(Breach {
                tick,
                why: format!(
                    "the state after the last tick has the hash {hash:016x}, and had {:016x} at the end of the motion",
                    last.hash
                ),
            }),
            _ => Ok(()),
        }
    }

    /// Takes the arrival of a packet that names `tick`, on a path with the round trip `rtt`.
    ///
    /// # Errors
    /// The ticks are ahead of the server's clock, or behind it without an outage. Or the motion had ended before this
    /// tick.
    pub fn packet(&mut self, now_ns: u64, tick: u64, rtt: Duration) -> Result<(), Breach> {
        self.lead(now_ns, tick)?;
        self.is_in_time(tick)?;
        let (now_ns, rtt_ns) = (now_ns as i64, rtt.as_nanos() as i64);
        let delay_ns = self.delay(now_ns, tick);
        let Some(before_ns) = self.packet_ns.replace(now_ns) else {
            (self.began_ns, self.window_ns) = (now_ns, now_ns);
            (self.least_ns, self.rtt_ns) = (delay_ns, rtt_ns);
            self.windows = [delay_ns, i64::MAX];
            self.newest = tick;
            return Ok(());
        };
        let silence_ns = now_ns.saturating_sub(before_ns);
        self.outage(now_ns, silence_ns);
        self.newest = self.newest.max(tick);
        self.hear(silence_ns.min(ns(OUTAGE)));
        // The clocks drift apart, in either direction.
        let drift_ns = silence_ns.min(ns(OUTAGE)) * DRIFT_PPM / 1_000_000;
        if now_ns - self.window_ns >= ns(WINDOW) {
            self.windows = [i64::MAX, self.windows[0]];
            self.window_ns = now_ns;
        }
        self.windows[0] = self.windows[0].min(delay_ns);
        let recent_ns = self.windows[0].min(self.windows[1]);
        if delay_ns < self.least_ns {
            // A faster path, a faster clock, or a machine that is less busy than at the begin.
            (self.least_ns, self.rtt_ns) = (delay_ns, rtt_ns);
        } else {
            self.least_ns += (recent_ns - self.least_ns).clamp(0, drift_ns);
        }
        let is_judged = now_ns - self.began_ns >= ns(BEGIN) && now_ns >= self.settles_ns;
        if !is_judged || self.last.is_some() {
            return Ok(());
        }
        let lag_ns = recent_ns - self.least_ns;
        let longer_ns = (rtt_ns - self.rtt_ns).clamp(0, ns(LONGER));
        let allowed_ns = ns(BEHIND) + longer_ns + self.excuse_ns;
        if lag_ns > allowed_ns {
            return Err(self.breach(format!(
                "the ticks are {} ms behind the station's clock without an outage, expected at most {}",
                lag_ns / 1_000_000,
                allowed_ns / 1_000_000
            )));
        }
        // Ticks that have caught up need no excuse any more.
        if now_ns - self.outage_ns > ns(SETTLES) {
            self.excuse_ns = self.excuse_ns.min(lag_ns.max(0));
        }
        Ok(())
    }

    /// Checks that a tick is not after the last one.
    fn is_in_time(&self, tick: u64) -> Result<(), Breach> {
        match self.last {
            Some((last, _)) if tick > last.tick => Err(Breach {
                tick: self.newest,
                why: format!("tick {tick} comes after the last one, {}", last.tick),
            }),
            _ => Ok(()),
        }
    }

    /// Takes a silence before the present packet.
    fn outage(&mut self, now_ns: i64, silence_ns: i64) {
        self.excused_ns -= (silence_ns / RECOVERS).min(self.excused_ns);
        let returned = std::mem::take(&mut self.returned);
        if silence_ns <= ns(OUTAGE) {
            return;
        }
        self.outage_ns = now_ns;
        let excused_ns = if returned {
            // Returns in a row must not keep the lag from being judged.
            if now_ns - self.settles_ns > ns(RARELY) {
                self.settles_ns = now_ns + ns(SETTLES);
            }
            silence_ns
        } else {
            let excused_ns = silence_ns.min(ns(EXCUSED) - self.excused_ns).max(0);
            self.excused_ns += excused_ns;
            excused_ns
        };
        self.excuse_ns = self.excuse_ns.saturating_add(excused_ns);
        // A silence after the motion has no ticks.
        if self.last.is_none() {
            let last = self.tick_at(now_ns);
            self.live.outage(self.newest, last);
        }
    }

    /// Adds time with packets, and makes commands due.
    fn hear(&mut self, heard_ns: i64) {
        self.heard_ns += heard_ns;
        let heard_ns = self.heard_ns;
        let is_due = |told: &mut (u64, i64)| heard_ns - told.1 >= ns(OBEYED);
        while let Some((number, _)) = self.told.pop_front_if(is_due) {
            if self.due.len() == DUE {
                self.due.pop_front();
            }
            self.due.push_back((number, self.newest));
        }
    }

    /// Takes the number of the commands in a packet to the hand.
    pub fn told(&mut self, commands: u64) {
        if commands > self.commands {
            self.commands = commands;
            self.told.push_back((commands, self.heard_ns));
        }
    }

    /// Takes a live pose, which arrives at `now_ns`, of a tick whose row comes later. A late one, and one that is not
    /// newer than all before, are ignored.
    pub fn live(&mut self, now_ns: u64, tick: u64, input: &TickInput) {
        if !self.is_late(now_ns, tick) {
            self.live.take(tick, input);
        }
    }

    /// Whether a tick arrives so late that its input could be chosen with hindsight.
    fn is_late(&self, now_ns: u64, tick: u64) -> bool {
        let late_ns = self.delay(now_ns as i64, tick) - self.least_ns;
        late_ns > ns(LATE).saturating_add(self.excuse_ns)
    }

    /// Checks the input of a tick that obeys `commands` commands with the levels `told`, and the times of the readings
    /// behind it: for each present tool nanoseconds of the device's clock. The row arrived at `arrived_ns`.
    ///
    /// # Errors
    /// The input disobeys a command, or has another level of detail than the plan. It differs from the live pose of its
    /// tick, or comes late without a reason. Or it has an age that its time contradicts.
    pub fn row(
        &mut self,
        (tick, arrived_ns): (u64, u64),
        input: &TickInput,
        (commands, told): (u64, &InForce),
        times_ns: [Option<u64>; MAX_TOOLS],
    ) -> Result<(), Breach> {
        self.is_in_time(tick)?;
        let breach = |why: String| Err(Breach { tick, why });
        if input.detail != self.detail {
            return breach(format!(
                "the level of detail is {}, expected {}",
                input.detail, self.detail
            ));
        }
        let mut due = self.due.iter().filter(|(_, since)| tick > *since);
        if let Some((number, _)) = due.find(|(number, _)| *number > commands) {
            return breach(format!(
                "the hand does not obey command {number} of the station after {} s",
                OBEYED.as_secs()
            ));
        }
        if told.station.paused && !input.paused {
            return breach("the hand does not obey the pause of the station".to_owned());
        }
        let (most, given) = (told.force_limit_n(), input.force_limit_n);
        if most > 0.0 && !(given > 0.0 && given <= most) {
            return breach(format!(
                "the hand has the force limit {given} N, expected at most {most} N"
            ));
        }
        let is_late = self.is_late(arrived_ns, tick);
        if let Err(why) = self.live.row(tick, input, is_late) {
            return breach(why);
        }
        for (slot, (tool, time_ns)) in input.tools.iter().zip(times_ns).enumerate() {
            let Some(time_ns) = time_ns.filter(|_| tool.present) else {
                continue;
            };
            let measured = i128::from(tick) - i128::from(tool.age_ticks);
            let apart = i128::from(time_ns) - measured * i128::from(self.tick_ns);
            let apart_ns = i64::try_from(apart).unwrap_or(i64::MAX);
            let reading = self.readings[slot].get_or_insert(Reading {
                time_ns,
                usual_ns: apart_ns,
            });
            if time_ns < reading.time_ns {
                return breach(format!("the readings of tool {slot} go back in time"));
            }
            reading.time_ns = time_ns;
            let off_ns = apart_ns.saturating_sub(reading.usual_ns);
            if off_ns.saturating_abs() > ns(READING) {
                return breach(format!(
                    "the age of the pose of tool {slot} is {} ticks, which the time of its reading contradicts by {} ms",
                    tool.age_ticks,
                    off_ns / 1_000_000
                ));
            }
            let drift_ns = self.tick_ns * DRIFT_PPM / 1_000_000;
            reading.usual_ns += off_ns.clamp(-drift_ns, drift_ns);
        }
        Ok(())
    }

    /// Arrival of a tick minus its time, on an unknown zero.
    fn delay(&self, now_ns: i64, tick: u64) -> i64 {
        let tick_ns =
            i64::try_from(i128::from(tick) * i128::from(self.tick_ns)).unwrap_or(i64::MAX);
        now_ns.saturating_sub(tick_ns)
    }

    /// Tick whose least delay ends at `now_ns`.
    fn tick_at(&self, now_ns: i64) -> u64 {
        ((now_ns - self.least_ns) / self.tick_ns).max(0) as u64
    }

    fn breach(&self, why: String) -> Breach {
        Breach {
            tick: self.newest,
            why,
        }
    }
}

fn ns(time: Duration) -> i64 {
    time.as_nanos() as i64
}

#[cfg(test)]
mod tests;
