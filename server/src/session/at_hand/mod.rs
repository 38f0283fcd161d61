//! Session with ticks at the hand: the thread that computes the hand's ticks again, from their exact inputs.
//!
//! These ticks are the session: they are recorded, seen and graded. The hand's state hash after each batch must be that
//! of this thread. The thread has no grid of its own, and after an outage it computes several times faster than real
//! time.

mod guard;
mod told;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use sulcus_core::{
    MAX_TOOLS, NoProbe, RawPose, Scene, State, TickInput, ToolInput, Workspace, tick,
};
use sulcus_link::Bell;
use sulcus_link::clock::{monotonic_ns, thread_cpu_ns, unix_ns};
use sulcus_proto::PoseDatagram;
use sulcus_proto::at_hand::{HandRow, Unpacker};
use sulcus_proto::control::{Event, InputBatch, LastTick};
use sulcus_proto::datagram::{WireLevels, WireWrench};
use sulcus_sessions::record::sample::DeviceSample;
use sulcus_sessions::{Occurrence, Row};
use tokio::sync::mpsc;

use crate::outlets::recording::{FromNetwork, Ticked};
use crate::session::handoff::{Flags, Progress, Provoked};
use crate::session::levels::{InForce, Level, Levels};
use crate::session::metrics::{Metrics, TickTimes};
use crate::session::queue::{Queue, Rings};
pub(crate) use guard::Breach;
use guard::Guard;
use told::Told;

/// Number of events of the client that wait for their ticks.
const EVENTS: usize = 4096;
/// Number of batches that wait for the thread. A full channel holds back the client's stream.
const WAITING: usize = 256;
/// Number of entries that a tick and its shapes take in the recorder's queue at most.
const ENTRIES: usize = 4;
/// Wait for room in the recorder's queue.
const PAUSE: Duration = Duration::from_millis(2);

/// Message to the thread.
#[derive(Debug)]
pub(crate) enum ToTicks {
    /// Batch of inputs, and its arrival, nanoseconds of the server's monotonic clock.
    Batch(InputBatch, u64),
    /// The session ends: see [`Flags::stop`].
    Stop,
}

/// Ends of a session with ticks at the hand, for the connections of its student.
#[derive(Debug)]
pub(crate) struct HandPort {
    to_ticks: mpsc::Sender<ToTicks>,
    shared: Arc<Shared>,
}

/// State that the connections and the thread share.
#[derive(Debug)]
struct Shared {
    guard: Mutex<Guard>,
    /// Events of the client that wait for their ticks.
    events: Mutex<Vec<Event>>,
    /// Number of batches.
    batches: AtomicU64,
    /// First breach of a rule.
    breach: Mutex<Option<Breach>>,
    /// Number of tools of the scene.
    tools: usize,
    /// Levels that were told to the hand.
    told: Mutex<Told>,
    flags: Arc<Flags>,
    progress: Arc<Progress>,
    bell: Bell,
}

impl Shared {
    fn events(&self) -> MutexGuard<'_, Vec<Event>> {
        self.events.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn told(&self) -> MutexGuard<'_, Told> {
        self.told.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn guard(&self) -> MutexGuard<'_, Guard> {
        self.guard.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn first_breach(&self) -> Option<Breach> {
        let breach = self.breach.lock().unwrap_or_else(PoisonError::into_inner);
        breach.clone()
    }

    /// Keeps the first breach, and wakes the station, which ends the session.
    fn check(&self, result: Result<(), Breach>) {
        if let Err(breach) = result {
            let mut first = self.breach.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert(breach);
            Flags::raise(&self.flags.diverged);
            self.bell.ring();
        }
    }
}

impl HandPort {
    /// Passes a batch to the thread. Waits while [`WAITING`] messages wait. `false`: the thread has ended.
    pub async fn batch(&self, batch: InputBatch, rtt: Duration) -> bool {
        let now_ns = monotonic_ns();
        let packet = self.shared.guard().packet(now_ns, batch.first_tick, rtt);
        self.shared.check(packet);
        self.shared.batches.fetch_add(1, Ordering::Relaxed);
        let batch = ToTicks::Batch(batch, now_ns);
        self.to_ticks.send(batch).await.is_ok()
    }

    /// Ends the session: the stream of inputs has something else.
    pub fn invalid(&self, why: &str) {
        let tick = self.shared.progress.tick.load(Ordering::Relaxed);
        self.shared.check(Err(Breach {
            tick,
            why: why.to_owned(),
        }));
    }

    /// Number of batches so far.
    pub fn batches(&self) -> u64 {
        self.shared.batches.load(Ordering::Relaxed)
    }

    /// Passes an event of the client to the thread, for the recorder: after the tick that it names. `false`: too many
    /// events wait.
    pub fn event(&self, event: Event) -> bool {
        let mut events = self.shared.events();
        let has_room = events.len() < EVENTS;
        if has_room {
            events.push(event);
        }
        has_room
    }

    /// Takes the newest pose of the hand, whose row comes later.
    pub fn live(&self, datagram: &PoseDatagram, rtt: Duration) {
        if datagram.tick == 0 {
            return self.invalid("a live pose names no tick");
        }
        let mut input = TickInput::IDLE;
        for (tool, sent) in input
            .tools
            .iter_mut()
            .zip(&datagram.tools)
            .take(self.shared.tools)
        {
            tool.present = sent.present;
            tool.pose = RawPose {
                position: sent.pose.position,
                orientation: sent.pose.orientation,
            };
        }
        let now_ns = monotonic_ns();
        let mut guard = self.shared.guard();
        let packet = guard.packet(now_ns, datagram.tick, rtt);
        if packet.is_ok() {
            guard.live(now_ns, datagram.tick, &input);
        }
        drop(guard);
        self.shared.check(packet);
    }

    /// The motion has ended with this tick. The rows up to it may follow.
    pub fn last(&self, last: LastTick) {
        let last = self.shared.guard().last(monotonic_ns(), last);
        self.shared.check(last);
    }

    /// Time since the end of the motion; zero before it.
    pub fn handing_in(&self) -> Duration {
        self.shared.guard().handing_in(monotonic_ns())
    }

    /// The student is back after a lost connection.
    pub fn returned(&self) {
        self.shared.guard().returned();
    }

    /// Levels that leave for the hand now, with the newest tick that the station has computed. `None`: a command is
    /// being counted just now.
    pub fn levels(&self, levels: &Levels) -> Option<(u64, WireLevels)> {
        // The number before the levels: a command that arrives in between is told, and counted by the next packet.
        let commands = levels.commands();
        let in_force = levels.in_force();
        let of_station = InForce {
            // The student's own levels are no rule for the hand.
            student: Level::default(),
            ..in_force
        };
        if !self.shared.told().take(commands, of_station) {
            return None;
        }
        self.shared.guard().told(commands);
        let levels = in_force.on_the_wire(commands);
        Some((self.shared.progress.tick.load(Ordering::Relaxed), levels))
    }

    /// Newest tick of which the station knows. The recorded part may be behind.
    pub fn newest(&self) -> u64 {
        self.shared.guard().newest()
    }

    /// Cause of a divergence, after the end of the thread. If the client has stopped the session, all its ticks must be
    /// there.
    pub fn breach(&self, stopped: bool) -> Option<Breach> {
        let (named, tick) = (
            self.shared.guard().newest_named(),
            self.shared.progress.tick.load(Ordering::Relaxed),
        );
        if stopped && named > tick {
            let why = format!("the inputs of ticks up to {named} are missing");
            self.shared.check(Err(Breach { tick, why }));
        }
        self.shared.first_breach()
    }

    /// Wakes the thread for its end.
    pub fn stop(&self) {
        // A full channel wakes the thread as well.
        let _ = self.to_ticks.try_send(ToTicks::Stop);
    }
}

/// Data of the thread.
pub(crate) struct HandTicks {
    pub scene: Arc<Scene>,
    pub levels: Levels,
    /// Level of detail of the plan.
    pub detail: u8,
    pub bell: Bell,
    pub flags: Arc<Flags>,
    pub progress: Arc<Progress>,
    /// Channel to the recorder.
    pub to_recorder: SyncSender<FromNetwork>,
}

/// Reports the end of the thread to the station, even after a panic.
struct Leaving(Arc<Flags>, Bell);

impl Drop for Leaving {
    fn drop(&mut self) {
        Flags::raise(&self.0.simulation_over);
        self.1.ring();
    }
}

impl HandTicks {
    /// Loop of the ticks, before its thread, and its ends for the connections.
    pub fn with_port(self, rings: Rings) -> (HandLoop, HandPort) {
        let (to_ticks, inbox) = mpsc::channel(WAITING);
        let shared = Arc::new(Shared {
            guard: Mutex::new(Guard::new(
                self.scene.params.tick_ns(),
                self.detail,
                monotonic_ns(),
            )),
            events: Mutex::default(),
            batches: AtomicU64::new(0),
            breach: Mutex::new(None),
            tools: self.scene.tools.len(),
            told: Mutex::default(),
            flags: self.flags.clone(),
            progress: self.progress.clone(),
            bell: self.bell.clone(),
        });
        let port = HandPort {
            to_ticks,
            shared: shared.clone(),
        };
        let ticks = HandLoop {
            inbox,
            state: State::new(&self.scene),
            workspace: Workspace::new(&self.scene),
            queue: Queue::new(rings, &self.scene.params),
            unpacker: Unpacker::default(),
            ticked: [WireWrench::default(); MAX_TOOLS],
            began_unix_ns: 0,
            in_force: InForce::default(),
            metrics: Metrics::new(),
            of: self,
            shared,
        };
        (ticks, port)
    }
}

/// Loop of the ticks at the hand.
pub(crate) struct HandLoop {
    of: HandTicks,
    inbox: mpsc::Receiver<ToTicks>,
    shared: Arc<Shared>,
    state: State,
    workspace: Workspace,
    queue: Queue,
    unpacker: Unpacker,
    /// Wrenches of the tick before, as on the wire.
    ticked: [WireWrench; MAX_TOOLS],
    /// Time of tick 0, nanoseconds since 1970.
    began_unix_ns: u64,
    /// Levels that the ticks obey.
    in_force: InForce,
    metrics: Metrics,
}

impl HandLoop {
    /// Starts the thread. It ends after [`HandPort::stop`], when it has computed the batches that wait.
    pub fn spawn(self) -> std::io::Result<JoinHandle<Metrics>> {
        std::thread::Builder::new()
            .name("sulcus-hand".into())
            .spawn(move || self.run())
    }

    fn run(mut self) -> Metrics {
        let _leaving = Leaving(self.of.flags.clone(), self.of.bell.clone());
        self.tell(Occurrence::ticks_at_hand());
        while let Some(message) = self.inbox.blocking_recv() {
            if Flags::is_up(&self.of.flags.stop) {
                // Batches that wait now are computed, later ones are not.
                self.inbox.close();
            }
            if let ToTicks::Batch(batch, arrived_ns) = message {
                self.batch(&batch, arrived_ns);
            }
            self.pass_events(self.state.tick);
        }
        // The client's last words, also about ticks that never came.
        self.pass_events(u64::MAX);
        self.metrics
    }

    /// Computes the ticks of a batch, unless they were computed before. After a breach no tick is computed.
    fn batch(&mut self, batch: &InputBatch, arrived_ns: u64) {
        self.of.flags.provoke(Provoked::Simulation);
        if batch.first_tick <= self.state.tick || Flags::is_up(&self.of.flags.diverged) {
            return;
        }
        let rows = match self.unpacker.unpack(&batch.rows) {
            Ok(rows) => rows,
            Err(error) => return self.breach(format!("the batch of inputs is invalid: {error}")),
        };
        let first = rows.first().map_or(0, |row| row.skipped);
        let expected = self.state.tick + 1 + u64::from(first);
        if batch.first_tick != expected {
            let why = format!(
                "the batch begins at tick {}, expected {expected}",
                batch.first_tick
            );
            return self.breach(why);
        }
        if self.began_unix_ns == 0 {
            self.began_unix_ns =
                unix_ns().saturating_sub(expected * self.of.scene.params.tick_ns());
        }
        let Some((commands, in_force)) = self.shared.told().at(batch.commands) else {
            return self.breach("the hand obeys a command that it was not told".to_owned());
        };
        self.in_force = InForce {
            // The student's own levels are the hand's.
            student: self.of.levels.in_force().student,
            ..in_force
        };
        let progress = self.of.progress.clone();
        if progress.commands.load(Ordering::Relaxed) != commands {
            progress.since.store(batch.first_tick, Ordering::Relaxed);
            progress.commands.store(commands, Ordering::Release);
        }
        for row in &rows {
            if let Err(breach) = self.row(row, arrived_ns, (commands, &in_force)) {
                return self.shared.check(Err(breach));
            }
        }
        let lead = self.shared.guard().lead(arrived_ns, self.state.tick);
        self.shared.check(lead);
        if batch.hash != self.state.hash {
            let why = format!(
                "the state has the hash {:016x} at the hand and {:016x} at the station: another processor, compiler or \
                 build, or a changed bit",
                batch.hash, self.state.hash
            );
            self.breach(why);
        }
        let last = self.shared.guard().state(self.state.tick, self.state.hash);
        self.shared.check(last);
        progress.tick.store(self.state.tick, Ordering::Relaxed);
        self.of.bell.ring();
    }

    /// Computes one tick and queues it for the recorder.
    fn row(
        &mut self,
        row: &HandRow,
        arrived_ns: u64,
        obeyed: (u64, &InForce),
    ) -> Result<(), Breach> {
        let scene = self.of.scene.clone();
        let mut input = TickInput {
            paused: row.paused,
            force_limit_n: row.force_limit_n,
            skipped: row.skipped,
            detail: row.detail,
            ..TickInput::IDLE
        };
        for (tool, sent) in input
            .tools
            .iter_mut()
            .zip(&row.tools)
            .take(scene.tools.len())
        {
            *tool = ToolInput {
                pose: RawPose {
                    position: sent.pose.position,
                    orientation: sent.pose.orientation,
                },
                present: sent.present,
                stale: sent.stale,
                age_ticks: sent.age_ticks,
                buttons: sent.buttons,
            };
        }
        let number = self.state.tick + 1 + u64::from(row.skipped);
        let times = row
            .tools
            .map(|tool| tool.present.then_some(tool.device_time_ns));
        let of = (number, arrived_ns);
        self.shared.guard().row(of, &input, obeyed, times)?;
        while self.queue.room() < ENTRIES {
            // The recorder waits for the disk. A recorder that has ended has raised its flag.
            if Flags::is_up(&self.of.flags.record_failed) {
                return Ok(());
            }
            std::thread::sleep(PAUSE);
        }
        let (wall, cpu) = (monotonic_ns(), thread_cpu_ns());
        let output = tick(
            &scene,
            &mut self.state,
            &mut self.workspace,
            &input,
            &mut NoProbe,
        );
        let cpu_ns = thread_cpu_ns().saturating_sub(cpu);
        let device = std::array::from_fn(|slot| {
            let sent = &row.tools[slot];
            let WireWrench {
                force: [fx, fy, fz],
                torque: [tx, ty, tz],
            } = sent.displayed(&self.ticked[slot]);
            input.tools[slot].present.then_some(DeviceSample {
                sequence: sent.sequence,
                device_time_ns: sent.device_time_ns,
                age_us: u32::from(sent.age_ticks) * (scene.params.tick_ns() / 1000) as u32,
                displayed: [fx, fy, fz, tx, ty, tz],
            })
        });
        let unix_ns = self.began_unix_ns + output.tick * scene.params.tick_ns();
        let row = Row::new(unix_ns, &input, &output).with_device(device);
        self.ticked = row.wrench.map(|[fx, fy, fz, tx, ty, tz]| WireWrench {
            force: [fx, fy, fz],
            torque: [tx, ty, tz],
        });
        let ticked = Ticked {
            row,
            output,
            cpu_ns: u32::try_from(cpu_ns).unwrap_or(u32::MAX),
            in_force: self.in_force,
            gone: false,
        };
        self.metrics.skipped += u64::from(input.skipped);
        let times = TickTimes {
            wake_ns: 0,
            cpu_ns,
            wall_ns: monotonic_ns().saturating_sub(wall),
        };
        self.metrics.tick(times, &output);
        self.queue
            .tick(ticked, &self.state, &self.workspace, &mut self.metrics);
        Ok(())
    }

    /// Passes the events on whose ticks are recorded.
    fn pass_events(&self, tick: u64) {
        let mut waiting = self.shared.events();
        let due: Vec<Event> = waiting.extract_if(.., |event| event.tick <= tick).collect();
        drop(waiting);
        for event in due {
            self.send(FromNetwork::Event(event));
        }
    }

    fn breach(&self, why: String) {
        let tick = self.state.tick;
        self.shared.check(Err(Breach { tick, why }));
    }

    fn tell(&self, occurrence: Occurrence) {
        self.send(FromNetwork::Occurrence(Box::new(occurrence)));
    }

    fn send(&self, message: FromNetwork) {
        // A recorder that has ended has raised its flag. This thread has no deadline: a full channel may hold it.
        let _ = self.to_recorder().send(message);
    }

    fn to_recorder(&self) -> &SyncSender<FromNetwork> {
        &self.of.to_recorder
    }
}
