//! Role of a session's process: it runs a back-end and obeys the commands of its input.

use std::io::{BufRead, Write};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use sulcus_core::{Pose, Quat, Vec3, Wrench};
use sulcus_devices::backends;
use sulcus_haptics::continuous::ContinuousLimit;
use sulcus_haptics::device::{Device, DeviceError, HandInfo, Stop};
use sulcus_haptics::door::{DoorRules, Guard, Wanted};
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::port::{HandEnd, HandPort, door};
use sulcus_haptics::{Limits, Mapping, PassivityParams, SlewLimits};
use sulcus_standins::clock;

use crate::allocations;
use crate::commands::{Answer, Command, Hand, Item, MARK, Opened, PEAK_N, SLEW};

static SAID: Mutex<Vec<u8>> = Mutex::new(Vec::new());

/// Runs the back-end whose name is the argument, up to the end of the input.
pub fn run() {
    let name = std::env::args().nth(1).expect("the name of a back-end");
    tracing_subscriber::fmt()
        .with_ansi(false)
        .with_writer(|| Said)
        .init();
    let mut client = Client::new(name);
    for line in std::io::stdin().lock().lines() {
        let command = serde_json::from_str(&line.expect("a line")).expect("a command");
        let answer = serde_json::to_string(&client.obey(command)).expect("JSON");
        let mut output = std::io::stdout().lock();
        writeln!(output, "\n{MARK}{answer}").expect("output");
        output.flush().expect("output");
    }
}

struct Said;

impl Write for Said {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        SAID.lock()
            .unwrap_or_else(PoisonError::into_inner)
            .extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Force of a hand and presses of its key.
#[derive(Clone, Copy, Default)]
struct Plan {
    force: [f64; 3],
    ripple: f64,
    presses: u32,
}

#[derive(Default)]
struct Orders {
    plans: Mutex<Vec<Plan>>,
    is_silent: AtomicBool,
    is_over: AtomicBool,
}

struct Client {
    backend: String,
    device: Option<Box<dyn Device>>,
    ends: Arc<Mutex<Vec<HandEnd>>>,
    orders: Arc<Orders>,
    stop: Stop,
    run: Option<JoinHandle<Result<(), DeviceError>>>,
    link: Option<JoinHandle<()>>,
}

impl Client {
    fn new(backend: String) -> Self {
        Self {
            backend,
            device: None,
            ends: Arc::default(),
            orders: Arc::default(),
            stop: Stop::new(),
            run: None,
            link: None,
        }
    }

    fn obey(&mut self, command: Command) -> Answer {
        let plan = |at: usize, change: &dyn Fn(&mut Plan)| {
            change(&mut self.orders.plans.lock().expect("plans")[at]);
            Answer::Done
        };
        match command {
            Command::List => Answer::List(self.list()),
            Command::Open(serials) => self.open(&serials),
            Command::Start => self.start(),
            Command::Press(at) => plan(at, &|plan| plan.presses += 1),
            Command::Force(at, force, ripple) => {
                plan(at, &|plan| (plan.force, plan.ripple) = (force, ripple))
            }
            Command::Silence(on) => {
                self.orders.is_silent.store(on, Relaxed);
                Answer::Number(clock::now_ns())
            }
            Command::State => self.state(),
            Command::Watch(name) => Answer::Number(allocations::watch(&[&name]) as u64),
            Command::Counted => Answer::Number(allocations::counted()),
            Command::Said => {
                let said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
                Answer::Said(String::from_utf8_lossy(&said).into_owned())
            }
            Command::Stop => self.end(),
        }
    }

    fn backend(&self) -> Box<dyn sulcus_devices::Backend> {
        let mut all = backends().into_iter();
        all.find(|one| one.name() == self.backend)
            .expect("a back-end")
    }

    fn list(&self) -> Vec<Item> {
        let item = |found: sulcus_devices::Found| Item {
            serial: found.serial,
            model: found.model,
            state: format!("{:?}", found.state),
            dof: [found.motion_dof, found.force_dof],
            message: found.message,
        };
        self.backend().list().into_iter().map(item).collect()
    }

    fn open(&mut self, serials: &[String]) -> Answer {
        match self.backend().open(serials) {
            Err(error) => Answer::Error(error.to_string()),
            Ok(device) => {
                let of = |info: &HandInfo| Opened {
                    serial: info.serial.clone(),
                    model: info.model.clone(),
                    reported: [
                        info.reported.peak_n,
                        info.reported.continuous_n,
                        info.reported.stiffness_n_per_m,
                    ],
                    dof: [info.motion_dof, info.force_axes, info.torque_axes],
                    period_ns: info.period_ns,
                };
                let infos = device.info().iter().map(of).collect();
                self.device = Some(device);
                Answer::Open(infos)
            }
        }
    }

    fn start(&mut self) -> Answer {
        let mut device = self.device.take().expect("an open device");
        (self.stop, self.orders) = (Stop::new(), Arc::default());
        let doors = device.info().iter().map(|info| door(rules(info)));
        let (ports, ends): (Vec<HandPort>, Vec<HandEnd>) = doors.unzip();
        *self.orders.plans.lock().expect("plans") = vec![Plan::default(); ends.len()];
        *self.ends.lock().expect("ends") = ends;
        let stop = self.stop.clone();
        self.run = Some(std::thread::spawn(move || device.run(ports, &stop)));
        let (ends, orders) = (self.ends.clone(), self.orders.clone());
        self.link = Some(std::thread::spawn(move || link(&ends, &orders)));
        Answer::Done
    }

    fn state(&mut self) -> Answer {
        let mut ends = self.ends.lock().expect("ends");
        let of = |end: &mut HandEnd| {
            let sample = end.sample();
            Hand {
                stage: format!("{:?}", sample.stage),
                present: sample.present,
                position: sample.pose.position.map(f64::from),
                orientation: sample.pose.orientation.map(f64::from),
                displayed: sample.displayed.force.into(),
                sequence: sample.sequence,
                trips: sample.counts.trips,
                buttons: end.buttons(),
            }
        };
        Answer::State(ends.iter_mut().map(of).collect())
    }

    fn end(&mut self) -> Answer {
        self.stop.ask();
        let result = self.run.take().map(|run| run.join().expect("no panic"));
        self.orders.is_over.store(true, Relaxed);
        if let Some(link) = self.link.take() {
            link.join().expect("no panic");
        }
        match result {
            Some(Err(error)) => Answer::Error(error.to_string()),
            _ => Answer::Done,
        }
    }
}

/// Orders once per millisecond.
fn link(ends: &Mutex<Vec<HandEnd>>, orders: &Orders) {
    sulcus_standins::clock::make_realtime(40);
    let mut next = clock::now_ns();
    while !orders.is_over.load(Relaxed) {
        next = (next + clock::MS).max(clock::now_ns());
        clock::sleep_until(next);
        if orders.is_silent.load(Relaxed) {
            continue;
        }
        let now = clock::now_ns();
        let wave = (now as f64 * 1e-9 * 3.0 * std::f64::consts::TAU).sin();
        let plans = orders.plans.lock().expect("plans").clone();
        for (end, plan) in ends.lock().expect("ends").iter_mut().zip(plans) {
            end.order(&Wanted {
                wrench: Wrench {
                    force: Vec3::from(plan.force) * (1.0 + plan.ripple * wave),
                    torque: Vec3::zeros(),
                },
                heard_ns: Some(now),
                presses: plan.presses,
                ..Wanted::NOTHING
            });
        }
    }
}

fn rules(info: &HandInfo) -> DoorRules {
    let lasting = |peak| ContinuousLimit {
        lasting: peak,
        peak,
        time_s: 10.0,
    };
    let guard = Guard {
        mapping: Mapping {
            world_from_base: Quat::identity(),
            origin: Vec3::zeros(),
            scale: 1.0,
            gimbal_from_tool: Pose::identity(),
        },
        has_torque: info.torque_axes > 0,
        silence: Silence::DEVICE,
        blend_ns: Guard::blend(
            Duration::from_nanos(info.period_ns),
            Duration::from_millis(1),
        ),
        force: lasting(PEAK_N),
        torque: lasting(0.1),
        clutch: 0,
    };
    let limits = Limits {
        force_n: PEAK_N,
        torque_nm: 0.1,
    };
    let slew = SlewLimits {
        force_n_per_ms: SLEW,
        torque_nm_per_ms: 0.02,
    };
    let passivity = PassivityParams {
        period_s: info.period_ns as f64 * 1e-9,
        ..PassivityParams::observing()
    };
    DoorRules::guarded(limits, slew, passivity, guard)
}
