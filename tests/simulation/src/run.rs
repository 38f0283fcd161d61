//! One session in virtual time: a station, a student, and the network between them, with the happenings of a seed.
//!
//! The loops are those of the live programs: the ticks, the recorder and the datagrams of the server, the datagrams and
//! the loop of the device of the client. The network, the control stream, the station between connections and session,
//! and the delays of a slow disk are models. No socket takes part, and no result depends on a thread or a clock.

mod connections;
mod happenings;

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use fastrand::Rng;
use sulcus_connection::carrier::Carrier;
use sulcus_connection::device_loop::DeviceLoop;
use sulcus_connection::link::SteppedLink;
use sulcus_core::Scene;
use sulcus_link::clock::SetClock;
use sulcus_proto::PoseDatagram;
use sulcus_proto::control::EndReason;
use sulcus_proto::limits::IDLE;
use sulcus_relay::{Conditions, Path as Way, Wire};
use sulcus_server::stepped::{SteppedSession, SteppedTick};

use crate::control::{Control, Up};
use crate::faults::{Happening, MS, Part, Schedule, schedule};
use crate::findings::Findings;
use crate::hand::Hands;
use crate::invariants::{Broken, Watch};
use crate::machine;
use crate::replayed::replayed;
use crate::seen::{Facts, Newest, Pass, Seen, Tick, Used};

/// Pause between two attempts of a client to return, nanoseconds.
const RETRY: u64 = 500 * MS;
/// Silence after which an end takes a connection for lost, nanoseconds.
const SILENT: u64 = IDLE.as_nanos() as u64;
/// Number of former datagrams that a stranger repeats from.
const REMEMBERED: usize = 64;
/// Number of entries that the recorder's queue holds: four seconds of ticks, a power of two.
const QUEUE: usize = 4096;

/// Name of a session: seed and number of the station.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Name {
    /// Seed of the class.
    pub seed: u64,
    /// Number of the station, from 0.
    pub station: u32,
}

/// Result of a session.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of the session.
    pub name: Name,
    /// Broken invariants with the virtual time of each, nanoseconds; without the known faults.
    pub broken: Vec<(u64, Broken)>,
    /// First case of each known fault, with its virtual time, nanoseconds.
    pub known: Vec<(u64, Broken)>,
    /// Hash of all events.
    pub hash: [u8; 32],
    /// Hash of the recording's file.
    pub recording: [u8; 32],
    /// Number of ticks.
    pub ticks: u64,
    /// Length in virtual time, nanoseconds.
    pub virtual_ns: u64,
    /// Newest second of events before the first broken invariant, or before the end.
    pub lines: Vec<String>,
}

/// A datagram and its connection.
type Packet = (u32, Arc<[u8]>);

/// Next part that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Due {
    Happening,
    ControlUp,
    ControlDown,
    Lost,
    Returning,
    Up,
    Tick,
    Record,
    Down,
    Pass,
    End,
}

/// Session in virtual time.
pub struct Run {
    name: Name,
    rng: Rng,
    found: Findings,
    /// Virtual time, nanoseconds.
    now_ns: u64,
    length_ns: u64,
    /// Clocks of both machines minus the virtual time, nanoseconds.
    offsets: Offsets,
    clock: Arc<SetClock>,
    schedule: VecDeque<(u64, Happening)>,
    session: SteppedSession,
    link: SteppedLink,
    device: DeviceLoop,
    hands: Hands,
    up: Wire<Packet>,
    down: Wire<Packet>,
    control: Control,
    /// Ends of the cuts of both directions, nanoseconds: up, down.
    cut_until: [u64; 2],
    /// Ends of the stops of the parts, nanoseconds.
    stalled: [u64; 4],
    record_ns: u64,
    /// Connection at the server; `None`: the student is gone.
    at_server: Option<u32>,
    at_client: u32,
    /// Number of the newest connection.
    newest: u32,
    epoch: u32,
    /// Time of the last arrival at each end, nanoseconds: server, client.
    heard: [u64; 2],
    /// Time of the next attempt of the client to return.
    attempt_ns: Option<u64>,
    former: VecDeque<Arc<[u8]>>,
    ticks: u64,
}

/// Clocks of the machines at the virtual time 0, nanoseconds.
#[derive(Clone, Copy, Debug)]
struct Offsets {
    server: u64,
    client: u64,
}

impl Run {
    /// Session of a seed, with its recording in `folder`.
    ///
    /// # Errors
    /// The recording cannot be opened: one sentence.
    pub fn new(name: Name, length_ns: u64, scene: &Scene, folder: &Path) -> Result<Self, String> {
        let mut rng = Rng::with_seed(name.seed.wrapping_mul(1000) + u64::from(name.station));
        let offsets = Offsets {
            server: 10_000_000_000 + rng.u64(0..1_000_000_000),
            client: 70_000_000_000 + rng.u64(0..1_000_000_000),
        };
        let clock = Arc::new(SetClock::new(offsets.server, crate::BEGAN));
        let epoch = 1;
        let session = machine::begin(scene, folder, epoch, clock.clone())?;
        let link = SteppedLink::new(session.hello());
        let device = DeviceLoop::new(&link, offsets.client, u64::MAX, None);
        let device = if rng.bool() {
            device.in_phase()
        } else {
            device
        };
        let facts = facts(&link, scene);
        let schedule: Schedule = schedule(&mut rng, length_ns);
        let (up, down) = (rng.u64(..), rng.u64(..));
        let mut run = Self {
            name,
            found: Findings::new(Watch::new(facts)),
            now_ns: 0,
            length_ns,
            offsets,
            clock,
            schedule: schedule.into(),
            session,
            link,
            device,
            hands: Hands::new(rng.u64(..)),
            up: Wire::new(Way::new(Conditions::default(), up)),
            down: Wire::new(Way::new(Conditions::default(), down)),
            control: Control::new(rng.u64(..)),
            cut_until: [0; 2],
            stalled: [0; 4],
            record_ns: 0,
            at_server: Some(1),
            at_client: 1,
            newest: 1,
            epoch,
            heard: [0; 2],
            attempt_ns: None,
            former: VecDeque::new(),
            ticks: 0,
            rng,
        };
        run.see(Seen::Epoch(epoch));
        Ok(run)
    }

    /// Runs the session to its end, then its replay.
    pub fn finish(mut self, folder: &Path) -> Outcome {
        loop {
            let (at_ns, due) = self.next();
            self.now_ns = self.now_ns.max(at_ns);
            match due {
                Due::Happening => self.happen(),
                Due::ControlUp => self.told_server(),
                Due::ControlDown => self.told_client(),
                Due::Lost => self.lose(),
                Due::Returning => self.attempt(),
                Due::Up => self.arrived_at_server(),
                Due::Tick => self.tick(),
                Due::Record => self.record(),
                Due::Down => self.arrived_at_client(),
                Due::Pass => {
                    if !self.pass() {
                        break;
                    }
                }
                Due::End if self.hands.leaves => {
                    let text = "a hand is not let go at the end of a session".to_owned();
                    self.found.fail(self.now_ns, Broken { number: 13, text });
                    break;
                }
                Due::End => {
                    self.hands.leaves = true;
                    self.length_ns = self.now_ns + 2 * SILENT;
                }
            }
        }
        self.end(folder)
    }

    /// Next part that is due, with its virtual time. Parts at the same time have a fixed order.
    fn next(&self) -> (u64, Due) {
        let after = |at_ns: u64, part: Part| at_ns.max(self.stalled[part as usize]);
        let silent = |end: usize, is_up: bool| is_up.then(|| self.heard[end] + SILENT);
        let lost = [
            silent(0, self.at_server.is_some()),
            silent(1, !self.link.is_returning()),
        ];
        let parts = [
            (self.schedule.front().map(|next| next.0), Due::Happening),
            (self.control.up.next_ns(), Due::ControlUp),
            (self.control.down.next_ns(), Due::ControlDown),
            (lost.into_iter().flatten().min(), Due::Lost),
            (self.attempt_ns, Due::Returning),
            (
                self.up.next_ns().map(|at| after(at, Part::ServerNetwork)),
                Due::Up,
            ),
            (
                Some(after(
                    self.session.next_tick_ns() - self.offsets.server,
                    Part::Ticks,
                )),
                Due::Tick,
            ),
            (Some(after(self.record_ns, Part::Recorder)), Due::Record),
            (self.down.next_ns(), Due::Down),
            (
                Some(after(
                    self.device.next_ns() - self.offsets.client,
                    Part::Device,
                )),
                Due::Pass,
            ),
            (Some(self.length_ns), Due::End),
        ];
        let due = parts.into_iter().filter_map(|(at, due)| Some((at?, due)));
        due.min_by_key(|(at, _)| *at)
            .unwrap_or((self.now_ns, Due::End))
    }

    fn see(&mut self, seen: Seen) {
        self.found.see(self.now_ns, &seen);
    }

    fn say(&mut self, text: String) {
        self.found.log.say(self.now_ns, text);
    }

    fn server_ns(&self) -> u64 {
        self.now_ns + self.offsets.server
    }

    fn client_ns(&self) -> u64 {
        self.now_ns + self.offsets.client
    }

    /// Round trip that QUIC would have measured.
    fn rtt(&mut self) -> Duration {
        self.up.path().conditions().delay + self.down.path().conditions().delay
    }

    fn is_stalled(&self, part: Part) -> bool {
        self.now_ns < self.stalled[part as usize]
    }

    // ---- Datagrams.

    fn arrived_at_server(&mut self) {
        let Some((connection, bytes)) = self.up.receive(self.now_ns) else {
            return;
        };
        if self.at_server == Some(connection) {
            self.heard[0] = self.now_ns;
            self.received(&bytes);
        }
    }

    fn received(&mut self, bytes: &[u8]) {
        self.found.log.add(self.now_ns, "up", bytes);
        let (now_ns, rtt) = (self.server_ns(), self.rtt());
        if self.at_server.is_some() {
            self.session.datagram(bytes, now_ns, rtt);
        }
    }

    fn arrived_at_client(&mut self) {
        let Some((connection, bytes)) = self.down.receive(self.now_ns) else {
            return;
        };
        self.found.log.add(self.now_ns, "down", &bytes);
        if connection == self.at_client {
            self.heard[1] = self.now_ns;
            let (now_ns, rtt) = (self.client_ns(), self.rtt());
            self.link.arrived(&bytes, now_ns, rtt);
        }
    }

    // ---- Loops.

    fn tick(&mut self) {
        self.clock.set_ns(self.server_ns());
        let Some(output) = self.session.tick() else {
            return;
        };
        self.ticks = output.output.tick;
        self.found
            .log
            .add(self.now_ns, "tick", &output.output.hash.to_le_bytes());
        let tick = self.seen_tick(&output);
        self.see(Seen::Tick(Box::new(tick)));
        let now_ns = self.server_ns();
        let connection = self
            .at_server
            .filter(|_| !self.is_stalled(Part::ServerNetwork));
        if let Some(connection) = connection
            && let Some(bytes) = self.session.wrench(now_ns)
        {
            let (length, packet) = (bytes.len(), (connection, Arc::from(bytes)));
            self.down.send(self.now_ns, packet, length);
        }
    }

    fn seen_tick(&self, ticked: &SteppedTick) -> Tick {
        let (input, output) = (&ticked.input, &ticked.output);
        let used = ticked.used.map(|(pose, arrived_ns)| Used {
            epoch: pose.epoch,
            number: u64::from(pose.sequence),
            measured_ns: measured(&pose).saturating_sub(self.offsets.client),
            arrived_ns: arrived_ns - self.offsets.server,
        });
        Tick {
            tick: output.tick,
            skipped: u32::from(input.skipped),
            present: input.tools.map(|tool| tool.present),
            stale: input.tools.map(|tool| tool.stale),
            paused: input.paused,
            force_limit_n: f64::from(input.force_limit_n),
            used,
            sent: std::array::from_fn(|t| output.tools[t].wrench),
        }
    }

    fn record(&mut self) {
        self.clock.set_ns(self.server_ns());
        let recorder = self.session.waiting();
        self.see(Seen::Queues { recorder });
        let wait = self.session.record().unwrap_or(Duration::from_millis(5));
        self.record_ns = self.now_ns + wait.as_nanos() as u64;
    }

    /// Pass of the device's loop; `false` at its end.
    fn pass(&mut self) -> bool {
        if !self.device.goes_on(&self.hands) {
            return false;
        }
        let (before, braked) = (self.device.periods_done(), self.device.braked_periods());
        let now_ns = self.client_ns();
        self.device.pass(&mut self.link, &mut self.hands, now_ns);
        let newest = self.link.latest_wrench().map(|packet| Newest {
            epoch: packet.datagram.epoch,
            tick: packet.datagram.tick,
            arrived_ns: packet.arrived_ns - self.offsets.client,
            force_limit_n: f64::from(packet.datagram.levels.force_limit_n),
            paused: packet.datagram.levels.paused_by_station
                || packet.datagram.levels.paused_by_student,
        });
        let pass = Pass {
            displayed: self.hands.displayed,
            newest,
            braked: self.device.braked_periods() > braked,
            overslept: (self.device.periods_done() - before).saturating_sub(1),
        };
        for wrench in &pass.displayed {
            for x in wrench.force.iter().chain(wrench.torque.iter()) {
                self.found
                    .log
                    .add(self.now_ns, "displayed", &x.to_bits().to_le_bytes());
            }
        }
        self.see(Seen::Pass(Box::new(pass)));
        if let Some(bytes) = self.link.pose_bytes() {
            let (length, bytes) = (bytes.len(), Arc::<[u8]>::from(bytes));
            self.former.push_back(bytes.clone());
            if self.former.len() > REMEMBERED {
                self.former.pop_front();
            }
            self.up.send(self.now_ns, (self.at_client, bytes), length);
        }
        while let Some(message) = self.link.next_message() {
            self.tell_server(self.at_client, Up::Message(message));
        }
        true
    }

    // ---- End.

    fn end(self, folder: &Path) -> Outcome {
        self.clock.set_ns(self.server_ns());
        let Self {
            name,
            mut found,
            now_ns,
            session,
            ticks,
            ..
        } = self;
        let ended = session.finish(EndReason::Stopped);
        found
            .log
            .say(now_ns, format!("finished: {:?}", ended.error));
        let finished = Seen::Finished {
            ticks: ended.summary.ticks,
            skipped: ended.summary.skipped,
            rows_dropped: ended.summary.rows_dropped,
            error: ended.error,
        };
        found.see(now_ns, &finished);
        let recording = match replayed(&folder.join(&ended.file_name)) {
            Ok((seen, hash)) => {
                found.see(now_ns, &seen);
                hash
            }
            Err(text) => {
                found.fail(now_ns, Broken { number: 12, text });
                [0; 32]
            }
        };
        Outcome {
            name,
            hash: found.log.hash(),
            recording,
            ticks,
            virtual_ns: now_ns,
            lines: found.lines(),
            broken: found.broken,
            known: found.known,
        }
    }
}

fn facts(link: &SteppedLink, scene: &Scene) -> Facts {
    let hello = link.hello();
    Facts {
        tools: scene.tools.len(),
        tick_ns: hello.tick_ns,
        max_force_n: f64::from(hello.max_force_n),
        max_torque_nm: f64::from(hello.max_torque_nm),
        max_force_step_n: f64::from(hello.max_force_step_n),
        max_torque_step_nm: f64::from(hello.max_torque_step_nm),
        plan_limit_n: 0.0,
        queue_rows: QUEUE,
    }
}

/// Time of the newest reading of a pose, nanoseconds of the client's clock.
fn measured(pose: &PoseDatagram) -> u64 {
    let times = pose.tools.iter().map(|tool| tool.device_time_ns);
    times.max().unwrap_or(0)
}
