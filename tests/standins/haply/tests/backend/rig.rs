//! Service, opened device, its thread, and a loop that drives the other ends of the doors.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use sulcus_core::Vec3;
use sulcus_devices::Backend;
use sulcus_devices::haply::Haply;
use sulcus_haptics::Stage;
use sulcus_haptics::device::{DeviceError, HandInfo, Stop};
use sulcus_haptics::port::{Sample, door};
use sulcus_standin_haply::{Options, Service, now_ns};

use crate::capture;
use crate::doors::{link, rules};

/// Largest force of the rules, newtons.
pub const PEAK_N: f64 = 3.0;
/// Largest change of the rules, newtons per millisecond.
pub const SLEW: f64 = 0.2;

static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Force of a hand at a time of the clock in seconds, world axes.
pub type Plan = Box<dyn Fn(usize, f64) -> Vec3 + Send>;

/// What the loop has seen of one hand.
#[derive(Clone, Debug)]
pub struct Seen {
    pub sample: Sample,
    /// Stages in their order, with the time of each beginning.
    pub stages: Vec<(u64, Stage)>,
    pub buttons: u16,
    /// Poses with their times, if they are recorded.
    pub poses: Vec<Sample>,
}

/// What the loop and the test share.
#[derive(Debug, Default)]
pub struct Shared {
    pub end: AtomicBool,
    /// No orders while true.
    pub silent: AtomicBool,
    /// A key is pressed whenever a hand waits.
    pub presses: AtomicBool,
    pub records: AtomicBool,
    pub ordered_ns: AtomicU64,
    pub seen: Mutex<Vec<Seen>>,
}

/// Running device.
pub struct Rig {
    pub service: Service,
    pub infos: Vec<HandInfo>,
    stop: Stop,
    shared: Arc<Shared>,
    device: Option<JoinHandle<Result<(), DeviceError>>>,
    link: Option<JoinHandle<()>>,
    _alone: MutexGuard<'static, ()>,
}

/// Waits for the other tests, and forgets their sentences.
pub fn alone() -> MutexGuard<'static, ()> {
    let alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    capture::clear();
    alone
}

/// Starts a service with the events 19 ports above.
pub fn service(options: &Options) -> Service {
    let begin = 12_000 + (now_ns() / 1_000_000 % 7_000) as u16;
    let started = (0..200).find_map(|attempt| {
        let port = begin + attempt * 23;
        Service::start(Options {
            port: Some(port),
            events_port: Some(port + 19),
            ..options.clone()
        })
        .ok()
    });
    started.expect("two free ports")
}

pub fn backend(service: &Service) -> Haply {
    Haply::at(format!("127.0.0.1:{}", service.port()))
}

pub fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.into()).collect()
}

impl Rig {
    /// Opens the arms and starts the threads. The plan holds while a hand has its force; it gets no force before.
    pub fn start(options: &Options, arms: &[&str], plan: Plan) -> Self {
        let alone = alone();
        let service = service(options);
        let mut device = backend(&service).open(&names(arms)).unwrap();
        let infos = device.info().to_vec();
        let (ports, ends): (Vec<_>, Vec<_>) = infos.iter().map(|info| door(rules(info))).unzip();
        let shared = Arc::new(Shared::default());
        shared.presses.store(true, Ordering::Release);
        let nothing = Seen {
            sample: Sample::NOTHING,
            stages: Vec::new(),
            buttons: 0,
            poses: Vec::new(),
        };
        *shared.seen.lock().unwrap() = vec![nothing; infos.len()];
        let stop = Stop::new();
        let (asked, owned) = (stop.clone(), shared.clone());
        Self {
            service,
            infos,
            stop,
            shared,
            device: Some(thread::spawn(move || device.run(ports, &asked))),
            link: Some(thread::spawn(move || link(&owned, ends, &plan))),
            _alone: alone,
        }
    }

    /// What the loop has seen of a hand.
    pub fn seen(&self, hand: usize) -> Seen {
        self.shared.seen.lock().unwrap()[hand].clone()
    }

    pub fn stage(&self, hand: usize) -> Stage {
        self.shared.seen.lock().unwrap()[hand].sample.stage
    }

    /// Waits until every hand has its whole force.
    pub fn wait_live(&self) {
        for hand in 0..self.infos.len() {
            self.wait("whole force", || self.stage(hand) == Stage::Live);
        }
    }

    /// Waits up to 10 s.
    pub fn wait(&self, what: &str, is: impl Fn() -> bool) {
        let begin = Instant::now();
        while !is() {
            assert!(
                begin.elapsed() < Duration::from_secs(10),
                "no {what}: {:?} {:?}",
                self.seen(0).stages,
                capture::warnings()
            );
            thread::sleep(Duration::from_millis(1));
        }
    }

    pub fn sleep(&self, ms: u64) {
        thread::sleep(Duration::from_millis(ms));
    }

    /// Ends or begins the orders. Returns the time of the newest order.
    pub fn silence(&self, on: bool) -> u64 {
        self.shared.silent.store(on, Ordering::Release);
        self.sleep(5);
        self.shared.ordered_ns.load(Ordering::Acquire)
    }

    /// Ends or begins the presses of the key.
    pub fn press(&self, on: bool) {
        self.shared.presses.store(on, Ordering::Release);
    }

    /// Records every pose.
    pub fn record(&self) {
        self.shared.records.store(true, Ordering::Release);
    }

    /// Stages of a hand since `t_ns`.
    pub fn stages_since(&self, hand: usize, t_ns: u64) -> Vec<Stage> {
        let stages = self.seen(hand).stages;
        stages
            .into_iter()
            .filter(|(at, _)| *at >= t_ns)
            .map(|(_, stage)| stage)
            .collect()
    }

    pub fn ask_stop(&self) {
        self.stop.ask();
    }

    /// Ends the run, and returns its result.
    pub fn end(&mut self) -> Result<(), DeviceError> {
        self.stop.ask();
        let result = self
            .device
            .take()
            .map_or(Ok(()), |device| device.join().unwrap());
        self.shared.end.store(true, Ordering::Release);
        if let Some(link) = self.link.take() {
            link.join().unwrap();
        }
        result
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        let _ = self.end();
    }
}
