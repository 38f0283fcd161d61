//! Clients in processes of their own, which tests kill.

use crate::support::hd::{NONE, fresh};
use crate::support::{dhd, rig, rig_of, wait_until};
use std::io::{BufRead, BufReader};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use sulcus_standins::board::Mode;
use sulcus_standins::log::{Closed, Event};
use sulcus_standins::setup::{DeviceSetup, Setup};
use sulcus_standins::{Fault, Rig, library};

const LONG: Duration = Duration::from_secs(10);
const LIMIT: u64 = 50_000_000;

/// A client of a rig, killed at the end of its test.
struct Client(Child);

impl Client {
    /// Starts a client and returns it with its first line.
    fn start(rig: &Rig, family: &str, seconds: &str) -> (Self, String) {
        let (name, value) = rig.environment();
        let path = library(&format!("standin_{family}")).expect("built");
        let mut child = Command::new(env!("CARGO_BIN_EXE_standin-client"))
            .arg(family)
            .arg(path)
            .args(["1.5", seconds])
            .env(name, value)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the client starts");
        let output = child.stdout.take().expect("a pipe");
        let client = Self(child);
        let mut line = String::new();
        BufReader::new(output).read_line(&mut line).expect("a line");
        (client, line.trim().to_owned())
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_watchdog_cuts_the_motors_after_a_client_was_killed() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (mut client, line) = Client::start(&rig, "hd", "60");
    assert_eq!(line, "running");
    assert!(wait_until(
        || rig.snapshot(0).expect("a state").force == [1.5, 0.0, 0.0]
    ));
    let killed = sulcus_standins::clock::now_ns();
    client.0.kill().expect("killed");
    let (log, cut) = rig
        .wait_log(LONG, |log| {
            log.death(0).is_some() && log.output_at(0, u64::MAX).0 == [0.0; 3]
        })
        .expect("a log");
    assert!(cut);
    assert!(!log.watchdogs(0).is_empty());
    let silent = log.last_command_to_zero(0).expect("zero");
    assert!(silent < LIMIT, "{silent} ns");
    let last = log.commands(0).last().expect("a command").0;
    assert!(last < killed + LIMIT);
    assert_eq!(log.output_at(0, u64::MAX), ([0.0; 3], [0.0; 3]));
    assert_eq!(log.flaws(rig.setup()), Vec::<String>::new());
    // The next owner needs the device to be plugged in again.
    let (_one, hd) = fresh(&rig);
    assert_eq!(hd.open("Left"), NONE);
    assert_eq!(hd.errors(), [(0x303, NONE)]);
    let (_, line) = Client::start(&rig, "hd", "1");
    assert_eq!(line, format!("refused {} {} {}", 0x303, -0x303, NONE));
    rig.fault(0, Fault::Unplug).expect("a fault");
    rig.fault(0, Fault::Replug).expect("a fault");
    assert_ne!(hd.open("Left"), NONE);
}

#[test]
fn a_client_that_ends_in_order_leaves_nothing_behind() {
    let rig = rig(vec![DeviceSetup::touch("Left", "L1")]);
    let (mut client, line) = Client::start(&rig, "hd", "0.05");
    assert_eq!(line, "running");
    assert!(client.0.wait().expect("ended").success());
    let log = rig.log().expect("a log");
    let way = |way| {
        log.times(0, |e| matches!(e, Event::Close { way: w, .. } if *w == way))
            .len()
    };
    assert_eq!((way(Closed::Call), way(Closed::Died)), (1, 0));
    assert!(log.last_command_to_zero(0).expect("zero") < LIMIT);
    let (_one, hd) = fresh(&rig);
    assert_ne!(hd.open("Left"), NONE);
}

#[test]
fn a_device_has_one_process() {
    let rig = rig(vec![
        DeviceSetup::touch("Left", "L1"),
        DeviceSetup::omega6(1234),
    ]);
    let (_first, line) = Client::start(&rig, "hd", "60");
    assert_eq!(line, "running");
    let (_one, hd) = fresh(&rig);
    assert_eq!(hd.open("Left"), NONE);
    assert_eq!(hd.errors().len(), 1);
    let (mut second, line) = Client::start(&rig, "dhd", "60");
    assert_eq!(line, "running");
    let (_two, dhd) = dhd::fresh(&rig);
    // SAFETY: the functions accept any number.
    unsafe {
        assert_eq!(((dhd.count)(), (dhd.available)()), (1, 0));
        assert_eq!(((dhd.open_id)(0), (dhd.error)()), (-1, 20));
        second.0.kill().expect("killed");
        assert!(wait_until(|| (dhd.available)() == 1));
        assert!(wait_until(
            || rig.snapshot(1).expect("a state").mode == Mode::Brake
        ));
        assert_eq!(
            (dhd.open_id)(0),
            0,
            "a killed owner does not lock a DHD device"
        );
    }
    let log = rig.log().expect("a log");
    assert!(!log.watchdogs(1).is_empty());
    assert!(log.last_command_to_zero(1).expect("zero") < LIMIT);
}

#[test]
fn closing_may_crash_the_process() {
    let mut setup = Setup::new(vec![DeviceSetup::touch("Left", "L1")]);
    setup.driver.crash_on_disable = true;
    let rig = rig_of(setup);
    let (mut client, line) = Client::start(&rig, "hd", "0.05");
    assert_eq!(line, "running");
    let status = client.0.wait().expect("ended");
    assert_eq!(status.signal(), Some(11));
    let log = rig.log().expect("a log");
    assert_eq!(log.output_at(0, u64::MAX), ([0.0; 3], [0.0; 3]));
}
